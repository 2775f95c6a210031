//! Self-calibration: estimation of common errors from the lines, such as the gain ratio and the
//! delay of two sensors, or the sensitivities and positions of gauges.
//!
//! A common error distorts the modulus in a way that depends on its source. An error of the ratio
//! of two sensitivities makes E oscillate with every half wave in the rod; a delay causes the same
//! oscillation, shifted by a quarter of a period. The modulus of a material cannot oscillate like
//! this. It is smooth and causal,
//!
//! ```text
//! E(ω) = a + bω² + cω i + Σ_k e_k iωτ_k/(1 + iωτ_k) ,
//! ```
//!
//! with fixed relaxation times τ_k, a factor of 1.5 apart, from a thousand times below the band to
//! a thousand times above, and real coefficients of any sign. The term bω² represents lateral
//! inertia. The prior of the coefficients is that no term in the band is larger than about ten
//! times the modulus. The stated uncertainties are the priors of the sizes ξ of the errors, in
//! standard uncertainties. Coefficients and sizes follow from weighted least squares,
//!
//! ```text
//! Σ|E_j - Σ_s ξ_s g_sj - E(ω_j)|²/σ_j² + ½ Σ ξ_s² + ½ Σ (coefficients/10|E|)² → min ,
//! ```
//!
//! where g_s is the [shift](crate::estimate::SystematicShift) of the lines due to a source. E_j and
//! g_s are linearised about the smooth modulus of the previous round, not about the noisy lines.
//! Errors of the measured quantities are removed from these quantities, and the lines are solved
//! again; errors of the specimen are removed from the modulus to first order. The remaining errors
//! have the posterior covariance,
//!
//! ```text
//! P = (I + JᵀJ/s²)⁻¹ ,
//! ```
//!
//! where J contains the whitened shifts without the part that a smooth modulus can represent, and
//! s² is the mean square of the residual relative to the noise, or 1 if that is larger. Errors that
//! the record does not determine keep their stated uncertainty. The remaining errors are
//! correlated. They are stated as independent errors, the columns of the Cholesky factor of P; the
//! error of a source therefore includes the correlated part of the errors of the sources after it.
//!
//! # Added damping
//! If damping σ was [added](crate::MultiPoint::with_added_damping) to records that end while the
//! rod still vibrates, the lines are at s = σ + iω, and s replaces iω in the smooth modulus. The
//! smooth modulus continues each line to the axis,
//!
//! ```text
//! E(iω) = E(s) + [E_smooth(iω) - E_smooth(s)] ,
//! ```
//!
//! and the error of the difference follows from the posterior covariance of the coefficients.
//!
//! Theory: `docs/theory/self-calibration.md`.

pub(crate) mod continuation;
mod line;
mod posterior;
mod smooth;

pub use continuation::{lines_per_independent_line, stride_of_independent_lines};
pub(crate) use line::{LinearisedLine, Misfit, shift_of, sources_of};

use num_complex::Complex64;

use crate::error::CmodError;
use crate::estimate::{ErrorSource, ModulusEstimate, ModulusLine, Refusal, SystematicShift};
use crate::vectors::length;
use posterior::Posterior;
use smooth::Smoothing;

/// Maximum number of rounds; each round consists of a correction and a new estimate.
const MOST_ROUNDS: usize = 12;
/// Maximum number of times that the lines to be used are selected.
const MOST_SELECTIONS: usize = 4;
/// Sizes of a delay or of a ratio of sensitivities from which the lines are solved again if the
/// start from 0 leaves too few informative lines.
const OTHER_STARTS: [f64; 4] = [-1.0, 1.0, -2.0, 2.0];
/// Mean square of the residual, relative to the noise, up to which it counts as noise.
const EXPLAINED: f64 = 1.5;
/// Maximum change of the sizes, in standard errors, for convergence.
const SETTLED: f64 = 0.02;
/// Maximum change after the last selection of lines; above this change there is no result.
const NEARLY_SETTLED: f64 = 0.3;
/// Maximum number of lines that are used, evenly spaced.
const MOST_LINES: usize = 1000;
/// Prior standard deviation of the largest contribution that a term of the smooth modulus makes in
/// the band, relative to the largest modulus in the band.
const LARGEST_TERM: f64 = 10.0;
/// Maximum random error of a line that is used, relative to the modulus. With a larger error, the
/// modulus is not a linear function of the ratio.
const LARGEST_ERROR: f64 = 0.03;

/// Estimate whose common errors were determined from its own lines, to the extent that the lines
/// determine them.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SelfCalibration {
    pub(crate) estimate: ModulusEstimate,
    sources: Vec<CalibratedSource>,
    /// Number of informative lines, before at most [`MOST_LINES`] of them are chosen.
    lines: usize,
    mean_square: f64,
}

/// Calibration of one source.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CalibratedSource {
    /// Source of the error.
    pub source: ErrorSource,
    /// Estimated size of the error, in units of the stated standard uncertainty.
    pub size: f64,
    /// Standard error of the size in the same unit; 1 if the record does not determine it.
    pub standard_error: f64,
}

impl CalibratedSource {
    /// Returns the size and its standard error from the lines alone, without the stated
    /// uncertainty; `None` if the lines do not determine the size.
    #[must_use]
    pub fn by_lines_alone(&self) -> Option<(f64, f64)> {
        let told = 1.0 - self.standard_error * self.standard_error;
        (told > f64::EPSILON).then(|| (self.size / told, self.standard_error / told.sqrt()))
    }

    /// Returns the size divided by the standard deviation that it has over records if the stated
    /// uncertainty is right. Beyond about ±3 the record contradicts the stated uncertainty.
    #[must_use]
    pub fn discrepancy(&self) -> f64 {
        let told = 1.0 - self.standard_error * self.standard_error;
        if told > f64::EPSILON {
            self.size / told.sqrt()
        } else {
            0.0
        }
    }
}

impl SelfCalibration {
    /// Returns the estimate after removal of the errors that were found; its common errors are the
    /// remaining errors.
    #[must_use]
    pub fn estimate(&self) -> &ModulusEstimate {
        &self.estimate
    }

    /// Returns the mean square of the residual from a smooth modulus and the errors, relative to
    /// the noise: 1 for noise alone. If it is larger than 1, the standard errors of the sizes are
    /// larger by its square root.
    #[must_use]
    pub fn mean_square(&self) -> f64 {
        self.mean_square
    }

    /// Returns true if at least half of the lines are informative, and the mean square of their
    /// residual is at most [`EXPLAINED`] times the noise.
    fn explains_all(&self) -> bool {
        2 * self.lines >= self.estimate.lines().len() && self.mean_square <= EXPLAINED
    }

    /// Returns the rank among results from other starting points: the number of informative lines,
    /// divided by the mean square of the residual if the residual exceeds the noise.
    fn rank(&self) -> f64 {
        self.lines as f64 / self.mean_square.max(1.0)
    }

    /// Returns the calibration of every source; the sources of the measured quantities precede
    /// those of the specimen.
    #[must_use]
    pub fn sources(&self) -> &[CalibratedSource] {
        &self.sources
    }
}

/// Measured data with their sources of error, from which a modulus can be estimated.
pub(crate) trait Experiment {
    /// Returns the damping σ that was added to the records \[1/s\]: the modulus is then on the
    /// lines s = σ + iω.
    fn added_damping(&self) -> f64;

    /// Returns the estimate from the measured data after removal of errors of the sizes `removed`.
    fn estimate(&self, removed: &[f64]) -> Result<ModulusEstimate, CmodError>;

    /// Linearises one `line` about a rod with the propagation coefficient `gamma`, to first order
    /// in the difference between the measured values and the values of this rod. Returns `None` if
    /// the values of the rod are not finite.
    fn linearised(
        &self,
        line: &ModulusLine,
        gamma: Complex64,
        removed: &[f64],
    ) -> Option<LinearisedLine>;
}

/// Solves for the errors of the `measured` sources, which the experiment removes from the measured
/// data, and of all other sources of the estimate.
///
/// With a large delay, or with a wrong ratio at the resonances of a rod of low loss, the branch is
/// certain on few lines. If fewer than half of the lines are informative, or if their residual
/// exceeds the noise, the sizes of [`OTHER_STARTS`] are also tried, and the result of the highest
/// rank is returned.
pub(crate) fn found(
    measured: &[ErrorSource],
    experiment: &impl Experiment,
) -> Result<Option<SelfCalibration>, CmodError> {
    if measured.is_empty() {
        return Ok(None);
    }
    let at_rest = vec![0.0; measured.len()];
    let mut best = found_from(at_rest.clone(), measured, experiment)?;
    for kind in [ErrorSource::Delay, ErrorSource::GainRatio] {
        if best.as_ref().is_some_and(SelfCalibration::explains_all) {
            break;
        }
        let Some(place) = measured.iter().position(|source| *source == kind) else {
            continue;
        };
        for start in OTHER_STARTS {
            let mut removed = at_rest.clone();
            if let Some(size) = removed.get_mut(place) {
                *size = start;
            }
            let other = found_from(removed, measured, experiment)?;
            let rank = |found: &Option<SelfCalibration>| found.as_ref().map(SelfCalibration::rank);
            if rank(&other) > rank(&best) {
                best = other;
            }
        }
    }
    Ok(best)
}

/// Solves for the errors, starting from the sizes `removed`.
fn found_from(
    mut removed: Vec<f64>,
    measured: &[ErrorSource],
    experiment: &impl Experiment,
) -> Result<Option<SelfCalibration>, CmodError> {
    // smooth modulus of the lines used in the previous round, by their index
    let mut smooth_before: Vec<(usize, Complex64)> = Vec::new();
    for selection in 1.. {
        let estimate = match experiment.estimate(&removed) {
            Ok(estimate) => estimate,
            // removal of the errors found so far has made the record invalid
            Err(_) if selection > 1 => return Ok(None),
            Err(error) => return Err(error),
        };
        // a line that cannot be linearised about the smooth modulus contains no information
        let about = |line: &ModulusLine, gamma, removed: &[f64]| {
            let linearised = experiment.linearised(line, gamma, removed)?;
            let is_finite = linearised.modulus.is_finite() && linearised.variance > 0.0;
            is_finite.then_some(linearised)
        };
        let mut lines = taking_part(&estimate);
        let mut linearised: Vec<LinearisedLine> = Vec::with_capacity(lines.len());
        if smooth_before.is_empty() {
            // the first linearisation is about the noisy lines, including their errors
            lines.retain(|line| {
                let line = about(line, line.propagation_coefficient, &removed);
                line.map(|line| linearised.push(line)).is_some()
            });
            let Some(smoothing) = Smoothing::of(
                &lines,
                &linearised,
                experiment.added_damping(),
                LARGEST_TERM,
            ) else {
                return Ok(None);
            };
            let moduli = linearised.drain(..).map(|line| line.modulus);
            let smooth = smoothing.smooth(&smoothing.whitened(moduli));
            smooth_before = of_lines(&lines, &smooth);
        }
        lines.retain(|line| {
            let smooth = nearest(&smooth_before, line.index);
            let line = smooth.and_then(|modulus| about(line, gamma_of(line, modulus), &removed));
            line.map(|line| linearised.push(line)).is_some()
        });
        let before = removed.clone();
        let mut found = None;
        for _ in 0..MOST_ROUNDS {
            let posterior = Posterior::of(
                &lines,
                &linearised,
                measured,
                &removed,
                experiment.added_damping(),
            );
            let Some(posterior) = posterior else {
                return Ok(None);
            };
            let moved = posterior.distance(&removed);
            smooth_before = of_lines(&lines, &posterior.smooth);
            removed.clone_from_slice(posterior.sizes.get(..measured.len()).unwrap_or_default());
            linearised.clear();
            let mut smooth = posterior.smooth.iter();
            lines.retain(|line| {
                let next = smooth
                    .next()
                    .and_then(|modulus| about(line, gamma_of(line, *modulus), &removed));
                next.map(|line| linearised.push(line)).is_some()
            });
            found = Some(posterior);
            if moved <= SETTLED {
                break;
            }
        }
        let Some(found) = found else {
            return Ok(None);
        };
        let moved = found.distance(&before);
        if moved <= SETTLED || (selection == MOST_SELECTIONS && moved <= NEARLY_SETTLED) {
            let estimate = experiment.estimate(&removed)?;
            return calibration(&found, &estimate, &removed).map(Some);
        }
        if selection == MOST_SELECTIONS {
            break;
        }
    }
    Ok(None)
}

/// Returns γ of a `modulus` at the frequency of a line, E = -ρω²/γ².
pub(crate) fn gamma_of(line: &ModulusLine, modulus: Complex64) -> Complex64 {
    line.propagation_coefficient * (line.modulus / modulus).sqrt()
}

/// Returns the `values` of the `lines` together with the indices of the lines.
fn of_lines(lines: &[&ModulusLine], values: &[Complex64]) -> Vec<(usize, Complex64)> {
    let indices = lines.iter().map(|line| line.index);
    indices.zip(values.iter().copied()).collect()
}

pub(crate) fn nearest<T: Copy>(lines: &[(usize, T)], index: usize) -> Option<T> {
    let after = lines.partition_point(|(other, _)| *other < index);
    let around = lines.get(after.saturating_sub(1)..(after + 1).min(lines.len()))?;
    let next = around.iter().min_by_key(|(other, _)| other.abs_diff(index));
    next.map(|(_, value)| *value)
}

/// Returns the informative lines. Lines whose gauges contradict each other are included, because
/// errors of the gauges may be the reason.
pub(crate) fn telling(estimate: &ModulusEstimate) -> impl Iterator<Item = &ModulusLine> {
    estimate.telling_but_for_misfit().filter(|line| {
        let error = line.uncertainty.random.modulus.mean_square().sqrt();
        error > 0.0 && error <= LARGEST_ERROR * line.modulus.norm()
    })
}

/// Returns at most about [`MOST_LINES`] of the informative lines. They are chosen by their index
/// among all lines, so that a line that becomes informative does not change the choice of the other
/// lines.
fn taking_part(estimate: &ModulusEstimate) -> Vec<&ModulusLine> {
    let stride = telling(estimate).count().div_ceil(MOST_LINES).max(1);
    let chosen = telling(estimate).filter(|line| line.index % stride == 0);
    chosen.collect()
}

/// Returns the calibration with a corrected `estimate`. Errors of the sizes `removed` have already
/// been removed from the estimate; the rest of the errors found is removed here.
fn calibration(
    found: &Posterior,
    estimate: &ModulusEstimate,
    removed: &[f64],
) -> Result<SelfCalibration, CmodError> {
    let without = estimate.revised(Refusal::Undetermined, |line, acceptance| {
        without_errors(found, line, removed).revised(acceptance, |_| true)
    })?;
    let sources = found.sources.iter().zip(&found.sizes).zip(&found.factor);
    Ok(SelfCalibration {
        estimate: without,
        sources: sources
            .map(|((source, size), row)| CalibratedSource {
                source: *source,
                size: *size,
                standard_error: length(row),
            })
            .collect(),
        lines: telling(estimate).count(),
        mean_square: found.mean_square,
    })
}

fn without_errors(found: &Posterior, line: &ModulusLine, removed: &[f64]) -> ModulusLine {
    let shifts: Vec<SystematicShift> = found
        .sources
        .iter()
        .map(|source| shift_of(&line.uncertainty.systematic, *source))
        .collect();
    let mut calibrated = line.clone();
    let before = removed.iter().copied().chain(std::iter::repeat(0.0));
    for ((shift, size), before) in shifts.iter().zip(&found.sizes).zip(before) {
        calibrated.modulus -= (size - before) * shift.modulus;
        calibrated.propagation_coefficient -= (size - before) * shift.propagation_coefficient;
    }
    let systematic = &mut calibrated.uncertainty.systematic;
    systematic.retain(|shift| !found.sources.contains(&shift.source));
    for (column, source) in found.sources.iter().enumerate() {
        let sum = |part: fn(&SystematicShift) -> Complex64| -> Complex64 {
            let rows = found.factor.iter().zip(&shifts);
            rows.map(|(row, shift)| row.get(column).copied().unwrap_or(0.0) * part(shift))
                .sum()
        };
        let modulus = sum(|shift| shift.modulus);
        let propagation_coefficient = sum(|shift| shift.propagation_coefficient);
        systematic.push(SystematicShift::new(
            *source,
            modulus,
            propagation_coefficient,
        ));
    }
    calibrated
}
