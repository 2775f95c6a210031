//! Self-calibration, the estimation of common errors from the lines: gain ratio and delay of two
//! sensors, sensitivities and positions of gauges.
//!
//! A common error distorts the modulus in a way prescribed by its source: an error of the ratio of
//! two sensitivities makes E oscillate with every half wave in the rod, and a delay does the same a
//! quarter of a period later. The modulus of a material cannot oscillate like this. It is smooth
//! and causal,
//!
//! ```text
//! E(ω) = a + bω² + cω i + Σ_k e_k iωτ_k/(1 + iωτ_k) ,
//! ```
//!
//! with fixed relaxation times τ_k a factor of 1.5 apart, from a thousand times below the band to a
//! thousand times above, and real coefficients of any sign; bω² represents lateral inertia. The
//! prior of the coefficients is that no term is larger in the band than about ten times the
//! modulus. With the stated uncertainties as priors of the sizes ξ of the errors (in standard
//! uncertainties), coefficients and sizes follow from weighted least squares,
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
//! with J the whitened shifts without the part that a smooth modulus can represent, and s² the mean
//! square of the residual, if it exceeds the noise. Errors that the record does not determine keep
//! their stated uncertainty. The remaining errors are correlated; they are stated as independent
//! errors, the columns of the Cholesky factor of P: the error of a source includes the correlated
//! part of the sources after it.
//!
//! # Added damping
//! Where damping σ was [added](crate::MultiPoint::with_added_damping) to records that end while the
//! rod rings, the lines are those of s = σ + iω, which replaces iω in the smooth modulus. The same
//! modulus continues each line to the axis,
//!
//! ```text
//! E(iω) = E(s) + [E_smooth(iω) - E_smooth(s)] ,
//! ```
//!
//! with the error of the difference from the posterior covariance of the coefficients.
//!
//! Theory: `docs/theory/self-calibration.md`.

pub(crate) mod continuation;
mod line;
mod posterior;
mod smooth;
pub(crate) mod vectors;

pub use continuation::lines_per_independent_line;
pub(crate) use line::{LinearisedLine, Misfit, shift_of, sources_of};

use num_complex::Complex64;

use crate::error::CmodError;
use crate::estimate::{ErrorSource, ModulusEstimate, ModulusLine, Refusal, SystematicShift};
use posterior::Posterior;
use smooth::Smoothing;
use vectors::length;

/// Maximum number of rounds of correction and estimate.
const MOST_ROUNDS: usize = 12;
/// Maximum number of selections of the lines that are used.
const MOST_SELECTIONS: usize = 4;
/// Sizes of a delay or of a ratio of sensitivities from which the lines are solved again where a
/// start from 0 is not informative.
const OTHER_STARTS: [f64; 4] = [-1.0, 1.0, -2.0, 2.0];
/// Mean square of the residual, relative to the noise, up to which it counts as noise.
const EXPLAINED: f64 = 1.5;
/// Maximum change of the sizes, in standard errors, for convergence.
const SETTLED: f64 = 0.02;
/// Maximum change after the last selection of lines; above it there is no result.
const NEARLY_SETTLED: f64 = 0.3;
/// Maximum number of lines that are used, evenly spaced.
const MOST_LINES: usize = 1000;
/// Standard deviation of the largest contribution of a term of the smooth modulus in the band,
/// relative to the largest modulus there.
const LARGEST_TERM: f64 = 10.0;
/// Maximum random error of a line that is used, relative to the modulus: with a larger error, the
/// modulus is not linear in the ratio.
const LARGEST_ERROR: f64 = 0.03;

/// Estimate whose common errors were determined from its own lines, as far as possible.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SelfCalibration {
    estimate: ModulusEstimate,
    sources: Vec<CalibratedSource>,
    /// Number of informative lines, before the choice of [`MOST_LINES`].
    lines: usize,
    mean_square: f64,
}

/// Calibration of one source.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CalibratedSource {
    /// Source of the error.
    pub source: ErrorSource,
    /// Size of the error, in stated standard uncertainties.
    pub size: f64,
    /// Standard error of the size; 1 if the record does not determine it.
    pub standard_error: f64,
}

impl CalibratedSource {
    /// Returns the size with its standard error as the lines alone determine them, without the
    /// stated uncertainty; `None` if they do not.
    #[must_use]
    pub fn by_lines_alone(&self) -> Option<(f64, f64)> {
        let told = 1.0 - self.standard_error * self.standard_error;
        (told > f64::EPSILON).then(|| (self.size / told, self.standard_error / told.sqrt()))
    }

    /// Returns the size divided by its standard deviation over records whose error is as stated:
    /// beyond about ±3 the record contradicts the stated uncertainty.
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
    /// Returns the estimate without the errors found, with the remaining errors as its common
    /// errors.
    #[must_use]
    pub fn estimate(&self) -> &ModulusEstimate {
        &self.estimate
    }

    /// Returns the mean square of the residual from a smooth modulus and the errors, relative to
    /// the noise: 1 for noise alone. Where it is larger, the standard errors of the sizes are
    /// larger by its square root.
    #[must_use]
    pub fn mean_square(&self) -> f64 {
        self.mean_square
    }

    /// Returns true if at least half of the lines are informative, and their residual is little
    /// more than noise.
    fn explains_all(&self) -> bool {
        2 * self.lines >= self.estimate.lines().len() && self.mean_square <= EXPLAINED
    }

    /// Returns the rank among results from other starts: the number of lines, less where the
    /// residual exceeds noise.
    fn rank(&self) -> f64 {
        self.lines as f64 / self.mean_square.max(1.0)
    }

    /// Returns the calibration of every source: those of the measured quantities before those of
    /// the specimen.
    #[must_use]
    pub fn sources(&self) -> &[CalibratedSource] {
        &self.sources
    }
}

/// Measured data, with the errors of their sources.
pub(crate) trait Experiment {
    /// Returns the damping σ that was added to the records \[1/s\]: the modulus is that on the
    /// lines s = σ + iω.
    fn added_damping(&self) -> f64;

    /// Returns the estimate from the measured data after removal of errors of the sizes `removed`.
    fn estimate(&self, removed: &[f64]) -> Result<ModulusEstimate, CmodError>;

    /// Linearises one `line` about a rod with the propagation coefficient `gamma`: to first order
    /// in the difference between the measured values and those of that rod. `None` where these
    /// values are not finite.
    fn linearised(
        &self,
        line: &ModulusLine,
        gamma: Complex64,
        removed: &[f64],
    ) -> Option<LinearisedLine>;
}

/// Solves for the errors of the `measured` sources, which the experiment removes from the measured
/// data, and of all others of the estimate.
///
/// With a large delay, or with a wrong ratio at the resonances of a rod of low loss, few lines can be
/// distinguished from other branches and from their neighbours. Where fewer than half of the lines
/// are informative, or their residual exceeds noise, the sizes of [`OTHER_STARTS`] are tried as well,
/// and the result of the highest rank is returned.
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

/// Solves for the errors from the sizes `removed`.
fn found_from(
    mut removed: Vec<f64>,
    measured: &[ErrorSource],
    experiment: &impl Experiment,
) -> Result<Option<SelfCalibration>, CmodError> {
    // of the lines used, by their index
    let mut smooth_before: Vec<(usize, Complex64)> = Vec::new();
    for selection in 1.. {
        let estimate = match experiment.estimate(&removed) {
            Ok(estimate) => estimate,
            // without the errors found so far the record is no longer valid
            Err(_) if selection > 1 => return Ok(None),
            Err(error) => return Err(error),
        };
        // a line that has no value about a smooth modulus contains no information
        let about = |line: &ModulusLine, gamma, removed: &[f64]| {
            let linearised = experiment.linearised(line, gamma, removed)?;
            let is_finite = linearised.modulus.is_finite() && linearised.variance > 0.0;
            is_finite.then_some(linearised)
        };
        let mut lines = taking_part(&estimate);
        let mut linearised: Vec<LinearisedLine> = Vec::with_capacity(lines.len());
        if smooth_before.is_empty() {
            // about the noisy lines, with their errors
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

/// Returns the values of lines with their indices.
fn of_lines(lines: &[&ModulusLine], values: &[Complex64]) -> Vec<(usize, Complex64)> {
    let indices = lines.iter().map(|line| line.index);
    indices.zip(values.iter().copied()).collect()
}

/// Returns the value of the line nearest to the line of this `index`.
pub(crate) fn nearest<T: Copy>(lines: &[(usize, T)], index: usize) -> Option<T> {
    let after = lines.partition_point(|(other, _)| *other < index);
    let around = lines.get(after.saturating_sub(1)..(after + 1).min(lines.len()))?;
    let next = around.iter().min_by_key(|(other, _)| other.abs_diff(index));
    next.map(|(_, value)| *value)
}

/// Returns the informative lines. Lines whose gauges contradict each other are included: errors of
/// the gauges may be the reason.
pub(crate) fn telling(estimate: &ModulusEstimate) -> impl Iterator<Item = &ModulusLine> {
    estimate.telling_but_for_misfit().filter(|line| {
        let error = line.uncertainty.random.modulus.mean_square().sqrt();
        error > 0.0 && error <= LARGEST_ERROR * line.modulus.norm()
    })
}

/// Returns about [`MOST_LINES`] of these lines at most, chosen by their index among all lines: a
/// line that becomes informative does not change the choice of the others.
fn taking_part(estimate: &ModulusEstimate) -> Vec<&ModulusLine> {
    let stride = telling(estimate).count().div_ceil(MOST_LINES).max(1);
    let chosen = telling(estimate).filter(|line| line.index % stride == 0);
    chosen.collect()
}

/// Returns the calibration with the `estimate`, from which errors of the sizes `removed` were
/// removed before, corrected for the rest of the errors found.
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
