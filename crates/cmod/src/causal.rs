//! Causal estimate: the relaxing material nearest to all lines of a measurement at once.
//!
//! A modulus determined separately for each line does not use the fact that all lines belong to one
//! material. The modulus of a material whose stress relaxes, such as a polymer, is
//!
//! ```text
//! E(s) = E∞ + ∫ H(τ) sτ/(1 + sτ) d(ln τ) ,    E∞, H >= 0 ,    s = iω ,
//! ```
//!
//! These moduli form a convex cone. [`CausalEstimate`] is the point of this cone that is nearest to
//! the measured values in units of their errors. The common errors are free parameters within their
//! uncertainties:
//!
//! ```text
//! min Σ|Ψ_j - (1 + Σ_s ξ_s r_sj) Ψ(γ_j)|²/σ_j² + ½ Σ ξ_s² ,    γ_j = iω_j √(ρ/E(iω_j)) ,
//! ```
//!
//! where Ψ(γ) stands for the ratio, or the gauge spectra, of a rod with the propagation coefficient
//! γ. The unknown is the material, not the modulus of a line. Where Ψ does not depend on γ to first
//! order, for example at the resonances of a rod, the line itself contributes little, and the other
//! lines determine the modulus.
//!
//! # Method
//! Ψ is linearised about the current material, and the linear problem is solved by non-negative
//! least squares on a fine grid of relaxation times, from two decades above the band to two decades
//! below. Both steps are repeated until the material no longer changes. The common errors of the
//! measured quantities are subtracted from these quantities; the errors of the specimen enter to
//! first order.
//!
//! # Errors
//! The projection is not a linear function of the values: the values determine which relaxation
//! times are occupied, and no modulus becomes negative. The covariance is computed from projections
//! of random draws of the noise and of the common errors about the estimated material. Its random
//! part is correlated from line to line, so a causal estimate is not a
//! [`ModulusEstimate`](crate::ModulusEstimate); [`CausalEstimate::covariance_between`] returns the
//! covariance between two frequencies.
//!
//! The distance between the lines and the material shows whether the data agree with causality.
//! [`checks::kramers_kronig`](crate::checks::kramers_kronig) tests the same for moduli of single
//! lines.
//!
//! # Limits
//! Waves that are not one-dimensional, a nonlinear material or two temperatures in one measurement
//! are not described by such a modulus; the estimate then contradicts the lines. There is no
//! estimate outside the band of the lines, because there the cone hardly bounds the modulus.
//!
//! Reference: Collet, Gary & Lundberg, *J. Appl. Mech.* **80** (2013) 011018, for the conditions
//! that causality and thermodynamics impose on discrete data.
//!
//! Theory: `docs/theory/causal-estimate.md`.

mod draws;
mod experiment;
mod projection;

pub(crate) use experiment::of_experiment;

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::modulus::GeneralisedMaxwell;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::error::{CmodError, check_enough_readings, check_that};
use crate::estimate::ErrorSource;
use crate::rheology::{ModulusData, PredictedModulus, VarianceScatter};
use crate::self_calibration::CalibratedSource;
use crate::vectors::subtract;
use draws::Draws;
use projection::{Projection, Value, Whitened};

/// Minimum number of lines for an estimate.
const FEWEST_LINES: usize = 3;

/// Relaxing material nearest to all lines of a measurement, with the errors of its modulus.
#[derive(Debug, Clone)]
#[must_use]
pub struct CausalEstimate {
    nearest: Projection,
    draws: Draws,
    lines: Vec<CausalLine>,
    sources: Vec<CalibratedSource>,
    scatter: VarianceScatter,
    rounds: u32,
    is_at_rest: bool,
}

/// Line of the data, with its distance from the causal estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CausalLine {
    /// Position of the line in the arrays given to the method, from 0.
    pub index: usize,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Distance between the estimate and the measured value, after subtraction of the common errors
    /// found, in standard errors of the line. It is the root mean square of the real and the
    /// imaginary part, and 1 for noise alone.
    pub distance: f64,
}

impl CausalEstimate {
    /// Projects `data`, whose random errors are independent from line to line, onto the cone.
    ///
    /// ```
    /// use cmod::causal::CausalEstimate;
    /// use cmod::rheology::{ModulusData, ModulusPoint};
    /// use num_complex::Complex64;
    /// use rodwave::modulus::{ComplexModulus, Zener};
    ///
    /// let material = Zener::new(1.0e9, 2.0e9, 1e-4)?;
    /// let points: Vec<ModulusPoint> = (1..=100)
    ///     .map(|j| {
    ///         let frequency_hz = 50.0 * f64::from(j);
    ///         let noise = 2e7 * Complex64::from_polar(1.0, 2.4 * f64::from(j * j)); // stands for noise
    ///         let modulus = material.at(std::f64::consts::TAU * frequency_hz) + noise;
    ///         ModulusPoint::circular(frequency_hz, modulus, 2e7 / 2_f64.sqrt())
    ///     })
    ///     .collect();
    /// let causal = CausalEstimate::new(&ModulusData::new(&points)?)?;
    /// let found = causal.at(1.5e3)?;
    /// let error = found.covariance[0][0].sqrt();
    /// assert!((found.modulus - material.at(std::f64::consts::TAU * 1.5e3)).re.abs() < 3.0 * error);
    /// // the standard error of E' of a single line is 1.4e7 Pa
    /// assert!(error < 3e6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CmodError::TooFewReadings`] for fewer than three points; [`CmodError::MustOscillate`] for
    /// moduli over time; [`CmodError::NoCausalEstimate`] if numbers overflow.
    pub fn new(data: &ModulusData) -> Result<Self, CmodError> {
        if data.has_times() {
            return Err(CmodError::MustOscillate {
                what: "a causal estimate",
            });
        }
        let values: Vec<Value> = data
            .omega()
            .iter()
            .zip(data.modulus())
            .zip(data.whitening_rows())
            .map(|((omega, modulus), whitening)| Value {
                place: Complex64::new(0.0, *omega),
                modulus: *modulus,
                whitening,
            })
            .collect();
        check_enough_readings(values.len(), FEWEST_LINES)?;
        let errors = data.common_errors();
        let shifts: Vec<Vec<Complex64>> = errors.iter().map(|error| error.shift.clone()).collect();
        let values = Whitened::new(&values, &shifts, &[]);
        let nearest = values.project().ok_or(CmodError::NoCausalEstimate)?;
        let lines = data.omega().iter().map(|omega| omega / TAU).enumerate();
        Self::judged(
            nearest,
            &values,
            lines,
            errors.iter().map(|error| error.source),
            data.scatter(),
        )
    }

    fn judged(
        nearest: Projection,
        values: &Whitened<'_>,
        lines: impl Iterator<Item = (usize, f64)>,
        sources: impl Iterator<Item = ErrorSource>,
        scatter: VarianceScatter,
    ) -> Result<Self, CmodError> {
        let draws = Draws::about(&nearest, values).ok_or(CmodError::NoCausalEstimate)?;
        let distance = |[a, b]: &[f64; 2]| (0.5 * (a * a + b * b)).sqrt();
        let lines = lines
            .zip(&nearest.residuals)
            .map(|((index, frequency_hz), residual)| CausalLine {
                index,
                frequency_hz,
                distance: distance(residual),
            })
            .collect();
        let sizes = nearest.sizes.iter().zip(&draws.errors_of_sizes);
        let sources = sources
            .zip(sizes)
            .map(|(source, (size, standard_error))| CalibratedSource {
                source,
                size: *size,
                standard_error: *standard_error,
            })
            .collect();
        Ok(Self {
            nearest,
            draws,
            lines,
            sources,
            scatter,
            rounds: 0,
            is_at_rest: true,
        })
    }

    /// Returns the modulus at a frequency within the band, with its total and its random
    /// covariance.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for a frequency outside the [band](Self::band_hz).
    pub fn at(&self, frequency_hz: f64) -> Result<PredictedModulus, CmodError> {
        let place = self.place(frequency_hz)?;
        let changes = self.draws.random_changes(place);
        let shifts = self.draws.common_changes(place);
        let random = self.with_scatter(products(&changes, &changes));
        Ok(PredictedModulus {
            modulus: self.nearest.material.at(place),
            covariance: sum(random, products(&shifts, &shifts)),
            random_covariance: random,
            within_band: true,
        })
    }

    /// Returns the covariance \[Pa²\] of (E', E'') at the first frequency, by rows, with (E', E'')
    /// at the second frequency, from all sources of error.
    ///
    /// # Errors
    /// The errors of [`at`](Self::at).
    pub fn covariance_between(
        &self,
        first_hz: f64,
        second_hz: f64,
    ) -> Result<[[f64; 2]; 2], CmodError> {
        let places = [self.place(first_hz)?, self.place(second_hz)?];
        let [first, second] = places.map(|place| self.draws.random_changes(place));
        let [a, b] = places.map(|place| self.draws.common_changes(place));
        Ok(sum(
            self.with_scatter(products(&first, &second)),
            products(&a, &b),
        ))
    }

    /// Returns a random covariance, enlarged if the variances of the lines are estimates.
    fn with_scatter(&self, covariance: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        covariance.map(|row| row.map(|entry| self.scatter.of_covariance * entry))
    }

    fn place(&self, frequency_hz: f64) -> Result<Complex64, CmodError> {
        let [lowest, highest] = self.band_hz();
        let is_within = (lowest..=highest).contains(&frequency_hz);
        let quantity = "frequency of a causal estimate [Hz]";
        let expected = "a frequency between its lowest and its highest line";
        check_that(is_within, quantity, frequency_hz, expected)?;
        Ok(Complex64::new(0.0, TAU * frequency_hz))
    }

    /// Returns the frequencies \[Hz\] of the first and the last line.
    #[must_use]
    pub fn band_hz(&self) -> [f64; 2] {
        let of = |line: Option<&CausalLine>| line.map_or(0.0, |line| line.frequency_hz);
        [of(self.lines.first()), of(self.lines.last())]
    }

    /// Returns the material as a generalised Maxwell model. Its branches only represent the modulus
    /// in the band; they are not the relaxations of the material, and no errors are stated for
    /// them.
    ///
    /// # Errors
    /// [`CmodError::NoCausalEstimate`] for a material without stiffness.
    pub fn series(&self) -> Result<GeneralisedMaxwell, CmodError> {
        let material = &self.nearest.material;
        GeneralisedMaxwell::new(material.equilibrium, material.branches.clone())
            .map_err(|_| CmodError::NoCausalEstimate)
    }

    /// Returns the lines, in order of frequency.
    #[must_use]
    pub fn lines(&self) -> &[CausalLine] {
        &self.lines
    }

    /// Returns the size of each common error found from the lines, with its standard error. The
    /// common part of the covariance of [`at`](Self::at) is due to the errors that remain after
    /// this correction.
    #[must_use]
    pub fn sources(&self) -> &[CalibratedSource] {
        &self.sources
    }

    /// Returns χ²: the sum of squares of the residuals of all lines and of the sizes of the common
    /// errors.
    #[must_use]
    pub fn chi_squared(&self) -> f64 {
        self.nearest.chi_squared
    }

    /// Returns the mean of χ² over draws of the stated errors about the material: twice the number
    /// of lines, reduced because the estimated material adapts to the noise of the lines.
    #[must_use]
    pub fn degrees_of_freedom(&self) -> f64 {
        self.draws.degrees_of_freedom
    }

    /// Returns the root mean square distance of the lines from the material, in standard errors of
    /// the lines: 1 or slightly less for noise alone.
    #[must_use]
    pub fn distance(&self) -> f64 {
        (self.chi_squared() / (2.0 * self.lines.len() as f64)).sqrt()
    }

    /// Returns the probability of a contradiction at least as large, under the assumption that a
    /// relaxing material was measured and the stated errors are right. The contradiction is
    /// measured by χ² and by each of the [sizes](Self::sources) of the common errors, because χ² of
    /// many lines hides a single large size. A small probability means that data and causality
    /// disagree.
    #[must_use]
    pub fn p_value(&self) -> f64 {
        let dispersion = self.scatter.of_chi_squared;
        let tail =
            |square: f64, freedom: f64| ChiSquared::new(freedom).map_or(1.0, |of| of.sf(square));
        let of_sum = tail(
            self.chi_squared() / dispersion,
            self.degrees_of_freedom() / dispersion,
        );
        let of_sources = self.sources.iter();
        let least = of_sources
            .map(|source| tail(source.discrepancy().powi(2), 1.0) * self.sources.len() as f64)
            .fold(1.0, f64::min);
        if self.sources.is_empty() {
            return of_sum;
        }
        (2.0 * of_sum.min(least)).min(1.0)
    }

    /// Returns true if the iteration has converged: the last linearisation changed the moduli of
    /// all lines together, as the root of the sum of squares, by less than about a thirtieth of a
    /// standard error.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.is_at_rest
    }

    /// Returns the number of linearisations about the material; 0 for an estimate from moduli alone
    /// ([`new`](Self::new)).
    #[must_use]
    pub fn rounds(&self) -> u32 {
        self.rounds
    }
}

/// Returns the sums of the products of the real and imaginary parts of `first` (rows) with those of
/// `second` (columns).
fn products(first: &[Complex64], second: &[Complex64]) -> [[f64; 2]; 2] {
    let mut sum = [[0.0; 2]; 2];
    for (a, b) in first.iter().zip(second) {
        for (row, a) in sum.iter_mut().zip([a.re, a.im]) {
            subtract(row, -a, &[b.re, b.im]);
        }
    }
    sum
}

fn sum(mut first: [[f64; 2]; 2], second: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    for (row, own) in first.iter_mut().zip(&second) {
        subtract(row, -1.0, own);
    }
    first
}
