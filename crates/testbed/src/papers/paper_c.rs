//! Paper C as typed values.

use std::f64::consts::TAU;

use cmod::CmodError;
use cmod::recovery::{LoadHistory, LoadSegment, ThreeElementParameters};

use super::error::FixtureError;
use super::transcribed_table;

/// Tests and parameters of paper C, with the errata applied, in SI.
#[derive(Debug, Clone)]
pub struct PaperC {
    /// Table 1.
    pub tests: Vec<Load>,
    /// `E_1` of the spring in series
    pub series_modulus: f64,
    /// `E_2`
    pub parallel_modulus: f64,
    /// B in Pa^(-m-1)/s
    pub coefficient: f64,
    /// m
    pub exponent: f64,
    /// Frequency at which every modulus was measured, in Hz.
    pub frequency_hz: f64,
    /// Loss factor of the virgin material in Tests 1 to 5.
    pub virgin_loss_factor: f64,
    /// Loss factor of the virgin material in Test 6.
    pub virgin_loss_factor_of_test_6: f64,
    /// Frequency of the periodic load, in Hz.
    pub load_frequency_hz: f64,
}

/// Row of Table 1.
#[derive(Debug, Clone)]
pub struct Load {
    pub test: String,
    /// `σ_a` in Pa
    pub mean_stress: f64,
    /// `σ_c` in Pa, for the test with periodic load
    pub stress_amplitude: Option<f64>,
    /// `t_a` in s
    pub duration: f64,
}

impl PaperC {
    pub fn parameters(&self) -> ThreeElementParameters {
        ThreeElementParameters {
            series_modulus: self.series_modulus,
            parallel_modulus: self.parallel_modulus,
            coefficient: self.coefficient,
            exponent: self.exponent,
        }
    }

    pub fn omega(&self) -> f64 {
        TAU * self.frequency_hz
    }

    pub fn load_history(&self, load: &Load) -> Result<LoadHistory, CmodError> {
        Ok(match load.stress_amplitude {
            None => LoadHistory::creep(load.mean_stress, load.duration)?,
            Some(amplitude) => LoadHistory::new(vec![LoadSegment::Periodic {
                mean: load.mean_stress,
                amplitude,
                frequency_hz: self.load_frequency_hz,
                duration: load.duration,
            }])?,
        })
    }

    /// Returns the loss factor to which the changes of a test refer.
    pub fn virgin_loss_factor_of(&self, load: &Load) -> f64 {
        match load.stress_amplitude {
            None => self.virgin_loss_factor,
            Some(_) => self.virgin_loss_factor_of_test_6,
        }
    }
}

pub fn load() -> Result<PaperC, FixtureError> {
    let constants = transcribed_table("paper_c_constants.ron")?;
    let constant = |name| constants.number(name, "value");
    let table = transcribed_table("paper_c_table_1.ron")?;
    let tests = table
        .rows
        .iter()
        .map(|row| {
            let value = |column| table.number(&row.label, column);
            Ok(Load {
                test: row.label.clone(),
                mean_stress: value("mean_stress")?,
                stress_amplitude: row
                    .values
                    .get("stress_amplitude")
                    .map(|value| value.value.to_f64()),
                duration: value("load_duration")?,
            })
        })
        .collect::<Result<_, FixtureError>>()?;
    Ok(PaperC {
        tests,
        series_modulus: constant("E_1")?,
        parallel_modulus: constant("E_2")?,
        coefficient: constant("B")?,
        exponent: constant("m")?,
        frequency_hz: constant("frequency")?,
        virgin_loss_factor: constant("tan_delta_0")?,
        virgin_loss_factor_of_test_6: constant("test_6_tan_delta_0")?,
        load_frequency_hz: constant("test_6_load_frequency")?,
    })
}
