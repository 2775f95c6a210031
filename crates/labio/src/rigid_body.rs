//! Low-frequency lines of a free body, computed from its weighed mass.
//!
//! Theory: `docs/theory/spectra.md#conversion-and-checks-of-responses`.
#![allow(
    clippy::indexing_slicing,
    reason = "`to_kind` refuses a response whose lists are not of one length, and all indices are below that length"
)]

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::error::{check_enough_samples, check_positive, non_physical};
use crate::{FrequencyResponse, LabioError, LineValidity, ResponseKind};

/// Fewest lines for a fit of three numbers and the standard error of the fit.
const FEWEST_LINES: usize = 4;

/// The weighed mass of a free body.
///
/// Below its first resonance a free body moves as a whole: its accelerance at the struck point, in
/// the direction of the axis through its centre of mass, is $`1/M`$ at 0 Hz, its mobility
/// $`1/(i\omega M)`$. In that range accelerometers and force transducers are least accurate, and
/// the weighing is most accurate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidBody {
    mass: f64,
    standard_error: f64,
}

/// The frequency band in which a body is measured well and is still nearly rigid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidBand {
    /// Lines below this frequency \[Hz\] are replaced.
    pub from_hz: f64,
    /// Lines from `from_hz` up to this frequency \[Hz\] give the elastic term, the first deviation
    /// from a rigid body.
    pub to_hz: f64,
}

/// A response with completed low lines, and the mass found from the lines above them.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct CompletedResponse {
    /// The response, of its original kind. Completed lines are valid, with NaN for coherence; the
    /// random error of their magnitude follows from the errors of the mass and the elastic term,
    /// and is an upper bound for the error of the phase.
    pub response: FrequencyResponse,
    /// Provenance: lines before this one are computed; this line and all later ones are measured.
    pub first_measured: usize,
    /// $`e`$ \[s²\] of the accelerance $`(1 + e s^2)/M`$, fitted in the band; negative $`e s^2`$
    /// means that the response approaches an antiresonance, which a free body has before its first
    /// resonance.
    pub elastic_term: f64,
    /// The mass \[kg\] found from the lines in the band, fitted together with terms in $`s^2`$ and
    /// $`s^4`$. A large difference from the weighed mass indicates a wrong sensitivity or a body
    /// that is not free.
    pub apparent_mass: f64,
    /// Standard error of the apparent mass \[kg\], from the scatter of the lines.
    pub apparent_mass_standard_error: f64,
}

impl RigidBody {
    /// Creates a body of `mass` \[kg\] with the `standard_error` \[kg\] of the weighing.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the mass is not positive or its error is negative.
    pub fn new(mass: f64, standard_error: f64) -> Result<Self, LabioError> {
        check_positive("mass [kg]", mass)?;
        if !(standard_error.is_finite() && standard_error >= 0.0) {
            return non_physical(
                "standard error of the mass [kg]",
                standard_error,
                "a finite value, not negative",
            );
        }
        Ok(Self {
            mass,
            standard_error,
        })
    }

    /// Replaces the lines of `response` below `band.from_hz` by those of the body,
    ///
    /// ```math
    /// \frac{\hat a}{\hat f} = \frac{1 + e s^2}{M}, \qquad s = \sigma + i\omega,
    /// ```
    ///
    /// with e found from the lines in the band by least squares (weighted by their variances, if
    /// any). The neglected terms are of order $`s^4`$: the band must end well below the first
    /// antiresonance. At the struck end of a free rod of length L and wave speed c,
    /// $`e = L^2/(3c^2)`$ and the next term is $`-(\omega L/c)^4/45`$.
    ///
    /// The response may be of any of the six kinds. The line at 0 Hz of a mobility or a receptance
    /// is infinite and stays flagged [`LineValidity::NotDefined`]; that of an accelerance is 1/M.
    ///
    /// # Errors
    ///
    /// The errors of [`FrequencyResponse::to_kind`]; [`LabioError::NonPhysical`] if the band is
    /// empty; [`LabioError::TooFewSamples`] if the band has fewer than four lines with information.
    pub fn complete(
        &self,
        response: &FrequencyResponse,
        band: RigidBand,
    ) -> Result<CompletedResponse, LabioError> {
        check_positive(
            "start of the band of a nearly rigid body [Hz]",
            band.from_hz,
        )?;
        if !(band.to_hz.is_finite() && band.to_hz > band.from_hz) {
            return non_physical(
                "end of the band of a nearly rigid body [Hz]",
                band.to_hz,
                "a finite frequency above its start",
            );
        }
        let kind = response.kind()?;
        let mut accelerance = response.to_kind(ResponseKind::Accelerance)?;
        let fit = self.fit(&accelerance, band)?;
        let first_measured = accelerance
            .frequency_hz
            .partition_point(|f| *f < band.from_hz);
        for line in 0..first_measured {
            let s2 = accelerance.laplace_variable(line).powi(2);
            let value = (1.0 + fit.elastic_term * s2) / self.mass;
            let relative = self.standard_error / self.mass;
            let magnitude =
                relative.hypot((fit.elastic_error * s2).norm() / (value * self.mass).norm());
            accelerance.values[line] = value;
            accelerance.validity[line] = LineValidity::Valid;
            if let Some(coherence) = &mut accelerance.coherence {
                coherence[line] = f64::NAN;
            }
            if let Some(variance) = &mut accelerance.variance {
                // only the real factor has an error, but a variance covers two components
                variance[line] = 2.0 * value.norm_sqr() * magnitude * magnitude;
            }
            if let Some(freedom) = &mut accelerance.degrees_of_freedom {
                freedom[line] = f64::INFINITY;
            }
            // these lines do not depend on sensors
            let of_sensors = [
                &mut accelerance.noise_bias,
                &mut accelerance.possible_bias,
                &mut accelerance.common_error,
            ];
            for lines in of_sensors.into_iter().flatten() {
                lines[line] = 0.0;
            }
        }
        let mut completed = accelerance.to_kind(kind)?;
        // measured lines are returned unchanged, without conversion and back
        let values = completed.values.iter_mut().zip(&response.values);
        for (slot, value) in values.skip(first_measured) {
            *slot = *value;
        }
        if let (Some(to), Some(from)) = (&mut completed.variance, &response.variance) {
            for (slot, variance) in to.iter_mut().zip(from).skip(first_measured) {
                *slot = *variance;
            }
        }
        Ok(CompletedResponse {
            response: completed,
            first_measured,
            elastic_term: fit.elastic_term,
            apparent_mass: fit.apparent_mass,
            apparent_mass_standard_error: fit.apparent_mass_error,
        })
    }

    fn fit(&self, accelerance: &FrequencyResponse, band: RigidBand) -> Result<Fit, LabioError> {
        // fits A M - 1 = e s² for this body, and A M = a + b s² + c s⁴ for its apparent mass; s² is
        // divided by `scale` to keep the sums near 1
        let highest_hz = accelerance.frequency_hz.last().copied().unwrap_or(0.0);
        let scale = (TAU * band.to_hz.min(highest_hz)).powi(2);
        let in_band: Vec<usize> = (0..accelerance.values.len())
            .filter(|line| {
                (band.from_hz..=band.to_hz).contains(&accelerance.frequency_hz[*line])
                    && accelerance.validity[*line] == LineValidity::Valid
            })
            .collect();
        // weights relative to the line with the smallest variance; all weights are 1 if a line has
        // zero variance
        let variance = |line: usize| accelerance.variance.as_ref().map_or(0.0, |v| v[line]);
        let least = in_band
            .iter()
            .map(|line| variance(*line))
            .fold(f64::INFINITY, f64::min);
        let weight = |line: usize| {
            if least > 0.0 {
                least / variance(line)
            } else {
                1.0
            }
        };
        let lines: Vec<(Complex64, Complex64, f64)> = in_band
            .iter()
            .map(|line| {
                let s2 = accelerance.laplace_variable(*line).powi(2) / scale;
                (s2, accelerance.values[*line] * self.mass, weight(*line))
            })
            .collect();
        check_enough_samples("the band of a nearly rigid body", lines.len(), FEWEST_LINES)?;
        let [mut w, mut wx, mut wxx, mut wxr] = [0.0; 4];
        for (s2, ratio, weight) in &lines {
            w += weight;
            wx += weight * s2.re;
            wxx += weight * s2.norm_sqr();
            wxr += weight * (s2.conj() * (ratio - 1.0)).re;
        }
        let elastic = wxr / wxx;
        let determinant = w * wxx - wx * wx;
        // least-squares constant and slope of a function of the lines over s²
        let straight = |of: &dyn Fn(&(Complex64, Complex64, f64)) -> Complex64| {
            let (mut wy, mut wxy) = (0.0, 0.0);
            for line in &lines {
                let (s2, _, weight) = line;
                wy += weight * of(line).re;
                wxy += weight * (s2.conj() * of(line)).re;
            }
            let constant = (wxx * wy - wx * wxy) / determinant;
            (constant, (w * wxy - wx * wy) / determinant)
        };
        let (a, b) = straight(&|(_, ratio, _)| *ratio);
        // divisor: two real equations per line, less the fitted numbers
        let mean_square = |of: &dyn Fn(&Complex64, &Complex64) -> Complex64, n_fitted: f64| {
            let squares = lines
                .iter()
                .map(|(s2, ratio, weight)| weight * of(s2, ratio).norm_sqr());
            squares.sum::<f64>() / (2.0 * lines.len() as f64 - n_fitted)
        };
        // fits the third term as c times the part of s⁴ that is orthogonal to 1 and s², so that a
        // and b do not change
        let (constant, slope) = straight(&|(s2, ..)| s2 * s2);
        let curved = |s2: &Complex64| s2 * s2 - constant - slope * s2;
        let (mut along, mut square) = (0.0, 0.0);
        for (s2, ratio, weight) in &lines {
            along += weight * (curved(s2).conj() * (ratio - a - b * s2)).re;
            square += weight * curved(s2).norm_sqr();
        }
        let c = along / square;
        let noise = mean_square(&|s2, ratio| ratio - a - b * s2 - c * curved(s2), 3.0);
        let at_zero = a - c * constant;
        let error = (noise * (wxx / determinant + constant * constant / square)).sqrt();
        let of_elastic = mean_square(&|s2, ratio| ratio - 1.0 - elastic * s2, 1.0);
        Ok(Fit {
            elastic_term: elastic / scale,
            elastic_error: (of_elastic / wxx).sqrt() / scale,
            apparent_mass: self.mass / at_zero,
            apparent_mass_error: self.mass * error / (at_zero * at_zero),
        })
    }
}

struct Fit {
    elastic_term: f64,
    elastic_error: f64,
    apparent_mass: f64,
    apparent_mass_error: f64,
}
