//! Continuation of the modulus from the lines s = σ + iω of records with added damping to the
//! frequency axis.

use num_complex::Complex64;

use super::line::LinearisedLine;
use super::smooth::Smoothing;
use super::taking_part;
use crate::complex_frequency::ComplexFrequency;
use crate::error::CmodError;
use crate::estimate::{ComplexCovariance, ModulusEstimate, ModulusLine, Refusal};
use crate::validity::{Validity, conditions};
use crate::vectors::dot;

/// Prior standard deviation of the largest contribution that a term makes in the band, relative to
/// the largest modulus in the band. For a passive material every term is positive, and none exceeds
/// the modulus.
const LARGEST_TERM: f64 = 0.3;

/// Minimum number of lines that determine the variation of the modulus.
const FEWEST_LINES: usize = 8;

/// Returns the ratio of the number of lines to the number of lines with independent noise, if
/// `added_damping` σ \[1/s\] correlates neighbouring lines. For stationary noise it is
///
/// ```text
/// Σ|ρ|² = ∫ df/(1 + (πf/σ)²)/Δf = σ/Δf .
/// ```
#[must_use]
pub fn lines_per_independent_line(frequency_hz: &[f64], added_damping: f64) -> f64 {
    match (frequency_hz.first(), frequency_hz.last()) {
        (Some(first), Some(last)) if last > first => {
            let spacing = (last - first) / (frequency_hz.len() - 1) as f64;
            (added_damping / spacing).max(1.0)
        }
        _ => 1.0,
    }
}

/// Returns the step between lines with which at most `most` of `count` lines are used, and lines
/// with correlated noise are skipped; `lines_per_independent_line` is the result of
/// [`lines_per_independent_line`].
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number of lines of at least 1, and the cast saturates"
)]
pub fn stride_of_independent_lines(
    count: usize,
    most: usize,
    lines_per_independent_line: f64,
) -> usize {
    let independent = lines_per_independent_line.max(1.0).ceil() as usize;
    count.div_ceil(most.max(1)).max(independent)
}

/// Returns the modulus on the axis, E(iω) = E(s) + [E_smooth(iω) - E_smooth(s)], from an `estimate`
/// on the lines s. If there are too few lines for a smooth modulus, all lines are refused.
pub(crate) fn on_axis(
    estimate: &ModulusEstimate,
    added_damping: f64,
    diameter: f64,
    length: f64,
) -> Result<ModulusEstimate, CmodError> {
    let all: Vec<f64> = estimate
        .lines()
        .iter()
        .map(|line| line.frequency_hz)
        .collect();
    let alike = lines_per_independent_line(&all, added_damping);
    let lines = taking_part(estimate);
    let about: Vec<LinearisedLine> = lines
        .iter()
        .map(|line| LinearisedLine {
            modulus: line.modulus,
            variance: alike * line.uncertainty.random.modulus.mean_square(),
            shifts: Vec::new(),
            misfit: None,
        })
        .collect();
    let smoothing = Smoothing::of(&lines, &about, added_damping, LARGEST_TERM);
    let smoothing = smoothing.filter(|_| lines.len() >= FEWEST_LINES);
    let continuation = smoothing.map(|smoothing| {
        let moduli = smoothing.whitened(lines.iter().map(|line| line.modulus));
        let rest = smoothing.rest_of(&moduli);
        let freedom = 2.0 * lines.len() as f64 - smoothing.parameters;
        Continuation {
            parts: smoothing.parts(&moduli),
            // the weights are reduced because the noise is correlated
            mean_square: (alike * dot(&rest, &rest) / freedom.max(1.0)).max(1.0),
            smoothing,
            added_damping,
        }
    });
    estimate.revised(Refusal::NotContinued, |line, acceptance| {
        let mut line = continuation.as_ref()?.on_axis(line)?;
        let mut violations = conditions(line.propagation_coefficient, diameter, length);
        violations.extend_from_slice(line.validity.violations());
        line.validity = Validity::from_violations(violations);
        line.revised(acceptance, |_| true)
    })
}

/// Smooth modulus through the lines s.
struct Continuation {
    smoothing: Smoothing,
    parts: Vec<f64>,
    mean_square: f64,
    added_damping: f64,
}

impl Continuation {
    fn on_axis(&self, line: &ModulusLine) -> Option<ModulusLine> {
        let frequency = ComplexFrequency::new(line.frequency_hz, self.added_damping);
        let axis = Complex64::new(0.0, frequency.laplace().im);
        let along = self.smoothing.difference(frequency.laplace(), axis);
        let step: Complex64 = along.iter().zip(&self.parts).map(|(d, c)| d * c).sum();
        let of_step = along
            .iter()
            .map(|d| ComplexCovariance::of_shift(d * self.mean_square.sqrt()))
            .fold(ComplexCovariance::default(), |sum, own| sum + own);
        let modulus = line.modulus + step;
        // from E = ρs²/γ² follows the factor on γ
        let turn = (axis / frequency.laplace()) * (line.modulus / modulus).sqrt();
        let gamma = line.propagation_coefficient * turn;
        if !(modulus.is_finite() && gamma.is_finite() && gamma != Complex64::ZERO) {
            return None;
        }
        let mut continued = line.clone();
        continued.modulus = modulus;
        continued.propagation_coefficient = gamma;
        let uncertainty = &mut continued.uncertainty;
        let random = &mut uncertainty.random;
        random.modulus = random.modulus + of_step;
        random.propagation_coefficient =
            random.propagation_coefficient.through(turn) + of_step.through(-0.5 * gamma / modulus);
        for shift in &mut uncertainty.systematic {
            shift.propagation_coefficient *= turn;
        }
        Some(continued)
    }
}
