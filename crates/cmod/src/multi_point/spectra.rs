//! Measured spectra of the gauges, and one line of these spectra, scaled to equal noise at all
//! gauges.

use num_complex::Complex64;

use crate::error::{CmodError, check_finite, check_frequencies, check_positive};
use crate::estimate::Refusal;

/// Uniform part of a rod with gauges on it (Ödeen 1993, paper B, figure 1). Structures attached to
/// the rod need not be known, provided that no force acts on the rod between the gauges.
#[derive(Debug, Clone, PartialEq)]
pub struct GaugedRod {
    /// Positions x of the gauges \[m\], increasing.
    pub positions: Vec<f64>,
    /// Diameter D \[m\], for the condition λ > 5D.
    pub diameter: f64,
    /// Density ρ [kg/m³].
    pub density: f64,
}

impl GaugedRod {
    /// Returns the distance between the outermost gauges \[m\].
    #[must_use]
    pub fn aperture(&self) -> f64 {
        match (self.positions.first(), self.positions.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// Returns the smallest distance between two gauges \[m\].
    #[must_use]
    pub fn least_distance(&self) -> f64 {
        self.distances().fold(f64::INFINITY, f64::min)
    }

    /// Returns the distances between neighbouring gauges \[m\].
    pub(super) fn distances(&self) -> impl Iterator<Item = f64> {
        let positions = &self.positions;
        positions
            .iter()
            .zip(positions.iter().skip(1))
            .map(|(x, y)| y - x)
    }

    /// Returns the length of rod that has this `mass`, m/(ρA) \[m\].
    pub(super) fn length_of(&self, mass: f64) -> f64 {
        mass / (self.density * std::f64::consts::FRAC_PI_4 * self.diameter * self.diameter)
    }

    pub(super) fn check(&self) -> Result<(), CmodError> {
        check_positive("diameter [m]", self.diameter)?;
        check_positive("density [kg/m^3]", self.density)?;
        check_positions(&self.positions)
    }
}

/// Accepts three or more finite and increasing positions.
pub(super) fn check_positions(positions: &[f64]) -> Result<(), CmodError> {
    if positions.len() < 3 {
        return Err(CmodError::GaugeCount {
            found: positions.len(),
            expected: "3 or more",
        });
    }
    let mut previous = None;
    for (gauge, &position) in positions.iter().enumerate() {
        check_finite("position of a gauge [m]", position)?;
        if let Some(previous) = previous
            && position <= previous
        {
            return Err(CmodError::PositionOrder {
                gauge,
                position,
                previous,
            });
        }
        previous = Some(position);
    }
    if let (Some(first), Some(last)) = (positions.first(), positions.last()) {
        check_positive("distance of the outermost gauges [m]", last - first)?;
    }
    Ok(())
}

/// Fourier transforms of the gauge signals in one or several tests, and their noise.
///
/// | field | shape |
/// |---|---|
/// | `frequency_hz` | `(n_lines)`, increasing |
/// | `tests` | `(n_tests)(n_gauges)(n_lines)` |
/// | `noise` | `(n_gauges)(n_lines)` |
///
/// Tests are not averaged: every hit has its own waves, and the propagation coefficient is common
/// to all tests.
#[derive(Debug, Clone, Copy)]
pub struct GaugeSpectra<'a> {
    /// Frequencies \[Hz\].
    pub frequency_hz: &'a [f64],
    /// Spectra of strain, displacement, velocity or acceleration, in the same unit for all gauges.
    pub tests: &'a [&'a [Vec<Complex64>]],
    /// Root mean square |δ| of the error of one spectrum in one test, real and imaginary part
    /// together, in the unit of the spectra. 0 at all gauges means data without noise.
    pub noise: &'a [Vec<f64>],
}

impl GaugeSpectra<'_> {
    pub(crate) fn check(&self, n_gauges: usize) -> Result<(), CmodError> {
        check_frequencies(self.frequency_hz)?;
        let expected = self.frequency_hz.len();
        if self.tests.is_empty() {
            return Err(CmodError::NoTests);
        }
        for (test, spectra) in self.tests.iter().enumerate() {
            if spectra.len() != n_gauges {
                return Err(CmodError::SpectraOfTest {
                    test,
                    found: spectra.len(),
                    expected: n_gauges,
                });
            }
            for (gauge, spectrum) in spectra.iter().enumerate() {
                if spectrum.len() != expected {
                    return Err(CmodError::SpectrumLength {
                        test,
                        gauge,
                        found: spectrum.len(),
                        expected,
                    });
                }
            }
        }
        if self.noise.len() != n_gauges {
            return Err(CmodError::GaugeCount {
                found: self.noise.len(),
                expected: "noise of one gauge per position",
            });
        }
        for (gauge, noise) in self.noise.iter().enumerate() {
            crate::error::check_length("noise of a gauge", noise.len(), expected)?;
            if let Some((line, &noise)) = noise.iter().enumerate().find(|(_, s)| **s < 0.0) {
                return Err(CmodError::NegativeNoise { gauge, line, noise });
            }
        }
        Ok(())
    }
}

/// Weight of the condition at a free end relative to the largest weight of a gauge. With this
/// weight the condition has 1e-6 of the variance of that gauge instead of 0, and the rounding error
/// grows to 1e-13.
const WEIGHT_OF_FREE_END: f64 = 1e3;

/// Line of all tests, divided by the noise of each gauge.
pub(super) struct WhiteLine {
    /// Values (n_tests · n_gauges), gauge by gauge for the first test, then for the next test.
    pub(super) values: Vec<Complex64>,
    /// Reciprocal of the noise of each gauge; 1 without noise.
    pub(super) weights: Vec<f64>,
    /// Variance of one value: 1, or 0 without noise.
    pub(super) variance: f64,
    /// Sum of the squares of the values.
    pub(super) power: f64,
    /// True if the last row is the free end, where the strain is 0.
    pub(super) has_free_end: bool,
}

impl WhiteLine {
    /// Creates the line of known `values`, already multiplied by the `weights` of the gauges.
    pub(super) fn of_values(values: Vec<Complex64>, weights: Vec<f64>) -> Self {
        Self {
            power: values.iter().map(Complex64::norm_sqr).sum(),
            values,
            weights,
            variance: 1.0,
            has_free_end: false,
        }
    }

    /// Creates a line for `n_rows` rows: one row per gauge, and one more row if the last row is a
    /// free end.
    pub(super) fn for_spectra(spectra: &GaugeSpectra<'_>, n_rows: usize) -> Self {
        Self {
            has_free_end: n_rows > spectra.noise.len(),
            values: Vec::with_capacity(spectra.tests.len() * n_rows),
            weights: Vec::with_capacity(n_rows),
            variance: 1.0,
            power: 0.0,
        }
    }

    pub(super) fn n_tests(&self) -> usize {
        self.values.len() / self.weights.len().max(1)
    }

    pub(super) fn mean_power(&self) -> f64 {
        let rows = self.weights.len().max(1);
        let gauges = rows - usize::from(self.has_free_end);
        self.power / (self.values.len() / rows * gauges) as f64
    }

    /// Returns the ratio of noise to signal, as root mean squares over all gauges.
    pub(super) fn noise_to_signal(&self) -> f64 {
        (self.variance / self.mean_power()).sqrt()
    }

    pub(super) fn load(&mut self, spectra: &GaugeSpectra<'_>, index: usize) -> Result<(), Refusal> {
        if spectra.frequency_hz.get(index) == Some(&0.0) {
            return Err(Refusal::ZeroFrequency);
        }
        let noises = || spectra.noise.iter().filter_map(|noise| noise.get(index));
        if noises().any(|noise| !noise.is_finite()) {
            return Err(Refusal::SpectrumNotFinite);
        }
        let silent = noises().filter(|noise| **noise == 0.0).count();
        self.variance = if silent == 0 { 1.0 } else { 0.0 };
        self.weights.clear();
        if silent == 0 {
            self.weights.extend(noises().map(|noise| noise.recip()));
        } else if silent == spectra.noise.len() {
            self.weights.resize(silent, 1.0);
        } else {
            return Err(Refusal::NoiseOfSomeGauges);
        }
        if self.has_free_end {
            let largest = self.weights.iter().copied().fold(0.0, f64::max);
            self.weights.push(WEIGHT_OF_FREE_END * largest);
        }
        self.values.clear();
        self.power = 0.0;
        for test in spectra.tests {
            for (spectrum, weight) in test.iter().zip(&self.weights) {
                #[allow(
                    clippy::indexing_slicing,
                    reason = "`GaugeSpectra::check` has refused spectra of another length"
                )]
                let value = spectrum[index] * weight;
                self.power += value.norm_sqr();
                self.values.push(value);
            }
            if self.has_free_end {
                self.values.push(Complex64::ZERO);
            }
        }
        if !self.power.is_finite() {
            return Err(Refusal::SpectrumNotFinite);
        }
        if self.power == 0.0 {
            return Err(Refusal::Undetermined);
        }
        Ok(())
    }
}
