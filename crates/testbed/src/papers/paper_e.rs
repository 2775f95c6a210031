//! Paper E as typed values.

pub mod bodies;
pub mod hammer_tests;

use super::error::FixtureError;
use super::transcribed_table;

/// Bodies, materials, hammers and tests of paper E, with the errata applied, in SI.
#[derive(Debug, Clone)]
pub struct PaperE {
    pub cone_length: f64,
    /// Diameters at the ends A and B of the cone.
    pub cone_diameter: [f64; 2],
    /// Length of each of the four sections of the compound cylinder.
    pub section_length: f64,
    pub cylinder_diameter: f64,
    pub rod_length: f64,
    pub rod_diameter: f64,
    pub pendulum_length: f64,
    pub light_hammer: Hammer,
    pub heavy_hammer: Hammer,
    /// Number of tests with each hammer.
    pub averaged: f64,
    /// Sample period of the tests for impulse responses.
    pub sample_period: f64,
    pub samples: f64,
    /// Eq. 7: coefficient and exponent of α, and then of k.
    pub nylon: [f64; 4],
    pub nylon_density: f64,
    pub aluminium_modulus: f64,
    pub aluminium_density: f64,
    pub steel_modulus: f64,
    pub steel_density: f64,
    /// Highest frequency of the predicted impulse responses, in Hz.
    pub predicted_highest_hz: f64,
    pub predicted_samples: f64,
    /// Distance of the strain gauges from the impacted end of the rod.
    pub gauge_distance: f64,
    pub strain_sample_period: f64,
    /// Cases TCA, TCB, CCA, CCB.
    pub cases: Vec<Case>,
}

impl PaperE {
    /// Returns the spacing of the lines, in Hz.
    pub fn frequency_step_hz(&self) -> f64 {
        1.0 / (self.samples * self.sample_period)
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a transcribed whole number, 4096"
    )]
    pub fn n_samples(&self) -> usize {
        self.samples as usize
    }

    /// Returns the number of spectral lines used: "only the low-frequency halves of the spectra
    /// were used" (Ödeen 1993, paper E).
    pub fn n_lines(&self) -> usize {
        self.n_samples() / 4 + 1
    }
}

/// Steel cylinder on a pendulum.
#[derive(Debug, Clone, Copy)]
pub struct Hammer {
    pub length: f64,
    pub diameter: f64,
}

/// Values that differ between the four faces.
#[derive(Debug, Clone)]
pub struct Case {
    pub name: String,
    /// Impact velocity V in m/s.
    pub impact_velocity: f64,
    /// Swing angles in rad.
    pub light_swing: f64,
    pub heavy_swing: f64,
}

pub fn load() -> Result<PaperE, FixtureError> {
    let constants = transcribed_table("paper_e_constants.ron")?;
    let constant = |name| constants.number(name, "value");
    let table = transcribed_table("paper_e_cases.ron")?;
    let cases = table
        .rows
        .iter()
        .map(|row| {
            let value = |column| table.number(&row.label, column);
            Ok(Case {
                name: row.label.clone(),
                impact_velocity: value("impact_velocity")?,
                light_swing: value("swing_angle_light_hammer")?,
                heavy_swing: value("swing_angle_heavy_hammer")?,
            })
        })
        .collect::<Result<_, FixtureError>>()?;
    Ok(PaperE {
        cone_length: constant("cone_length")?,
        cone_diameter: [constant("cone_diameter_a")?, constant("cone_diameter_b")?],
        section_length: constant("cylinder_section_length")?,
        cylinder_diameter: constant("cylinder_diameter")?,
        rod_length: constant("rod_length")?,
        rod_diameter: constant("rod_diameter")?,
        pendulum_length: constant("pendulum_length")?,
        light_hammer: Hammer {
            length: constant("light_hammer_length")?,
            diameter: constant("light_hammer_diameter")?,
        },
        heavy_hammer: Hammer {
            length: constant("heavy_hammer_length")?,
            diameter: constant("heavy_hammer_diameter")?,
        },
        averaged: constant("averaged_tests_per_hammer")?,
        sample_period: constant("mobility_sample_period")?,
        samples: constant("mobility_samples")?,
        nylon: [
            constant("nylon_alpha_coefficient")?,
            constant("nylon_alpha_exponent")?,
            constant("nylon_k_coefficient")?,
            constant("nylon_k_exponent")?,
        ],
        nylon_density: constant("nylon_density")?,
        aluminium_modulus: constant("aluminium_modulus")?,
        aluminium_density: constant("aluminium_density")?,
        steel_modulus: constant("steel_modulus")?,
        steel_density: constant("steel_density")?,
        predicted_highest_hz: constant("predicted_frequency_highest")?,
        predicted_samples: constant("predicted_samples")?,
        gauge_distance: constant("strain_gauge_distance")?,
        strain_sample_period: constant("strain_sample_period")?,
        cases,
    })
}
