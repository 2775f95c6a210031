//! Paper B as typed values.

use super::error::FixtureError;
use super::transcribed_table;

/// Bar and tests of paper B, in SI.
#[derive(Debug, Clone, Copy)]
pub struct PaperB {
    pub length: f64,
    pub diameter: f64,
    pub density: f64,
    /// Lowest frequency with results, in Hz.
    pub lowest_hz: f64,
    pub highest_hz: f64,
    /// λ/D at the highest frequency, as estimated in the paper.
    pub wavelength_over_diameter: f64,
    /// Number of tests in the averages.
    pub averaged: f64,
}

pub fn load() -> Result<PaperB, FixtureError> {
    let constants = transcribed_table("paper_b_constants.ron")?;
    let constant = |name| constants.number(name, "value");
    Ok(PaperB {
        length: constant("bar_length")?,
        diameter: constant("bar_diameter")?,
        density: constant("bar_density")?,
        lowest_hz: constant("frequency_lowest")?,
        highest_hz: constant("frequency_highest")?,
        wavelength_over_diameter: constant("shortest_wavelength_over_diameter")?,
        averaged: constant("averaged_tests")?,
    })
}
