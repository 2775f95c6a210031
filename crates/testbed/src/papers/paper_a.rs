//! Paper A as typed values.

use cmod::Specimen;
use rodwave::RodwaveError;
use rodwave::modulus::ConstantQ;

use super::error::FixtureError;
use super::transcribed_table;

/// Specimens, rig and tests of paper A, with the errata applied, in SI.
#[derive(Debug, Clone)]
pub struct PaperA {
    pub accelerometer_mass: f64,
    pub pendulum_length: f64,
    /// Number of tests in the averages.
    pub averaged: f64,
    /// Swing angles in rad: of the linearity test, of all reported tests, and where the response is
    /// nonlinear.
    pub swing_angles: [f64; 3],
    /// Lowest temperature of the oven, in K.
    pub lowest_temperature: f64,
    pub highest_temperature: f64,
    pub temperature_step: f64,
    pub frequency_of_figure_6: f64,
    /// Highest frequency with results, in Hz.
    pub highest_hz: f64,
    /// Mass ratio below which the results by series and by iteration did not differ significantly.
    pub mass_ratio_highest: f64,
    /// Table 2.
    pub tests: Vec<Test>,
    /// Table 1, as reconstructed.
    pub branches: Vec<Turn>,
}

/// Row of Table 2 (Ödeen 1993, paper A, Table 2).
#[derive(Debug, Clone)]
pub struct Test {
    pub name: String,
    pub material: String,
    pub diameter: f64,
    pub length: f64,
    pub density: f64,
}

/// Row of Table 1 (Ödeen 1993, paper A, Table 1), for one quarter turn of kL.
#[derive(Debug, Clone)]
pub struct Turn {
    pub interval: String,
    pub sin_phase: String,
    pub cos_phase: String,
    pub quarter_turn: f64,
    pub s: f64,
    pub n: f64,
}

/// Polypropylene at room temperature and polyamide 6: modulus in Pa, loss factor, and the angular
/// frequency to which the modulus applies. The modulus of polyamide 6 is that of (Ödeen 1993, paper
/// E, eq. 7) at 3 kHz.
pub const POLYPROPYLENE: (f64, f64, f64) = (2.6e9, 0.07, 1e4);
pub const POLYAMIDE: (f64, f64, f64) = (2.5935e9, 0.0936, 1.885e4);

impl Test {
    /// Returns the law of the virtual specimen.
    pub fn law(&self) -> Result<ConstantQ, RodwaveError> {
        let (modulus, loss_factor, omega) = match self.material.as_str() {
            "Polyamide 6" => POLYAMIDE,
            _ => POLYPROPYLENE,
        };
        ConstantQ::new(modulus, loss_factor, omega)
    }

    pub fn specimen(&self, paper: &PaperA) -> Specimen {
        Specimen {
            length: self.length,
            diameter: self.diameter,
            density: self.density,
            accelerometer_mass: paper.accelerometer_mass,
        }
    }
}

pub fn load() -> Result<PaperA, FixtureError> {
    let constants = transcribed_table("paper_a_constants.ron")?;
    let constant = |name| constants.number(name, "value");
    let table_1 = transcribed_table("paper_a_table_1_branches.ron")?;
    let table_2 = transcribed_table("paper_a_table_2.ron")?;
    let branches = table_1
        .rows
        .iter()
        .map(|row| {
            let value = |column| table_1.number(&row.label, column);
            let text = |name: &str| row.text.get(name).cloned().unwrap_or_default();
            Ok(Turn {
                interval: row.label.clone(),
                sin_phase: text("sin_phase"),
                cos_phase: text("cos_phase"),
                quarter_turn: value("quarter_turn")?,
                s: value("s")?,
                n: value("n")?,
            })
        })
        .collect::<Result<_, FixtureError>>()?;
    let tests = table_2
        .rows
        .iter()
        .map(|row| {
            let value = |column| table_2.number(&row.label, column);
            Ok(Test {
                name: row.label.clone(),
                material: row.text.get("material").cloned().unwrap_or_default(),
                diameter: value("diameter")?,
                length: value("length")?,
                density: value("density")?,
            })
        })
        .collect::<Result<_, FixtureError>>()?;
    Ok(PaperA {
        accelerometer_mass: constant("accelerometer_mass")?,
        pendulum_length: constant("pendulum_length")?,
        averaged: constant("averaged_tests")?,
        swing_angles: [
            constant("swing_angle_of_linearity_test")?,
            constant("swing_angle")?,
            constant("swing_angle_of_nonlinear_response")?,
        ],
        lowest_temperature: constant("oven_temperature_lowest")?,
        highest_temperature: constant("oven_temperature_highest")?,
        temperature_step: constant("oven_temperature_step")?,
        frequency_of_figure_6: constant("frequency_of_figure_6")?,
        highest_hz: constant("frequency_highest")?,
        mass_ratio_highest: constant("mass_ratio_highest")?,
        tests,
        branches,
    })
}
