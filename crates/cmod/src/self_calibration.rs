//! Common errors found from the lines themselves: gain ratio and delay of two sensors, sensitivities and positions of gauges.
//!
//! A common error distorts the modulus in a way that its source prescribes: an error of the ratio of two sensitivities makes E
//! swing with every half wave in the rod, a delay does so a quarter of a swing later. The modulus of a material cannot do that. It is smooth
//! and causal,
//!
//! ```text
//! E(ω) = a + bω² + cω i + Σ_k e_k iωτ_k/(1 + iωτ_k) ,
//! ```
//!
//! with fixed relaxation times τ_k a factor 1.5 apart, from a thousand times below the band to a thousand times above, and real coefficients of any sign; bω² stands for
//! lateral inertia. No term is larger in the band than ten times the modulus or so, which is the prior of the coefficients. With the stated uncertainties as priors of the
//! sizes ξ of the errors (in standard uncertainties), both follow from weighted least squares,
//!
//! ```text
//! Σ|E_j - Σ_s ξ_s g_sj - E(ω_j)|²/σ_j² + ½ Σ ξ_s² + ½ Σ (coefficients/10|E|)² → min ,
//! ```
//!
//! where g_s is the [shift](crate::estimate::SystematicShift) of the lines by a source. E_j and g_s are linearised about the smooth modulus of the round before, not about the noisy
//! lines. Errors of what was measured are taken out of it, and the lines are solved again; those of the specimen are taken out of the modulus to first order. What is left of each error is its posterior covariance,
//!
//! ```text
//! P = (I + JᵀJ/s²)⁻¹ ,
//! ```
//!
//! with J the whitened shifts without what a smooth modulus can follow, and s² the mean square of what is left unexplained, if that is
//! more than noise explains. What the record says nothing of keeps its stated uncertainty. The errors that are left are correlated; they are stated as independent
//! ones, the columns of Cholesky's factor of P: that of a source comes with what goes along with it in the sources after it.
//!
//! Theory: `docs/theory/self-calibration.md`.

use std::f64::consts::TAU;

use faer::{Mat, Side};
use num_complex::Complex64;

use crate::error::CmodError;
use crate::estimate::{ErrorSource, ModulusEstimate, ModulusLine, SystematicShift};
use crate::validity::Acceptance;

/// Rounds of correction and estimate.
const MOST_ROUNDS: usize = 12;
/// Choices of the lines that take part.
const MOST_SELECTIONS: usize = 4;
/// Sizes of a delay from which the lines are solved again where from 0 they tell nothing.
const OTHER_STARTS: [f64; 4] = [-1.0, 1.0, -2.0, 2.0];
/// The sizes have settled where none moves by more of its standard error.
const SETTLED: f64 = 0.02;
/// Lines that take part at most, evenly chosen.
const MOST_LINES: usize = 1000;
/// A line takes part if its random error is at most this part of the modulus: with more it is not linear in the ratio.
const LARGEST_ERROR: f64 = 0.03;
/// Quotient of neighbouring relaxation times. Coefficients of any sign on a grid of 2.5 leave 1e-4 of a loss that rises by powers of ten, which
/// makes a bias of many standard errors in quiet records; on this grid what they leave is below every noise.
const GRID: f64 = 1.5;
/// The grid goes so far beyond the band.
const BEYOND: f64 = 1000.0;
/// Standard deviation of the largest contribution of a term in the band, by the largest modulus there.
const LARGEST_TERM: f64 = 10.0;
/// Twice the lines must be at least so many times the unknowns.
const FEWEST_PER_UNKNOWN: f64 = 3.0;

/// An estimate whose common errors were found from its own lines, as far as these tell.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SelfCalibration {
    estimate: ModulusEstimate,
    sources: Vec<CalibratedSource>,
    /// Number of lines that tell them, but for the stride.
    lines: usize,
    /// Mean square of what is left, by that of the random errors; 1 if noise is all there is.
    pub mean_square: f64,
}

/// What was found of one source.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CalibratedSource {
    /// The source.
    pub source: ErrorSource,
    /// Size of its error, in stated standard uncertainties.
    pub size: f64,
    /// Standard error of the size; 1 if the record tells nothing.
    pub standard_error: f64,
}

impl CalibratedSource {
    /// The size by its standard deviation over records whose error is as stated: beyond ±3 or so the record contradicts what was stated.
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
    /// The estimate without the errors that were found, with what is left of them as its common errors.
    #[must_use]
    pub fn estimate(&self) -> &ModulusEstimate {
        &self.estimate
    }

    /// The estimate alone.
    #[must_use]
    pub fn into_estimate(self) -> ModulusEstimate {
        self.estimate
    }

    /// What was found of every source: those of what was measured before those of the specimen.
    #[must_use]
    pub fn sources(&self) -> &[CalibratedSource] {
        &self.sources
    }
}

/// What was measured, with the errors of its sources.
pub(crate) trait Experiment {
    /// The estimate from what was measured, without errors of the sizes `removed`.
    fn estimate(&self, removed: &[f64]) -> Result<ModulusEstimate, CmodError>;

    /// The same of one `line` about a rod with the propagation coefficient `gamma`: to first order in the difference of what was
    /// measured and what that rod would give. `None` where that has no value.
    fn linearised(
        &self,
        line: &ModulusLine,
        gamma: Complex64,
        removed: &[f64],
    ) -> Option<LinearisedLine>;
}

/// A line about a smooth modulus. Its derivatives know nothing of the noise, which those at the modulus of the line itself do: where the data tell
/// little of a source, that correlation would be taken for its error.
pub(crate) struct LinearisedLine {
    pub(crate) modulus: Complex64,
    /// E|δE|² \[Pa²\].
    pub(crate) variance: f64,
    pub(crate) shifts: Vec<SystematicShift>,
    /// What is left unexplained by any modulus, where more was measured than that needs.
    pub(crate) misfit: Option<Misfit>,
}

/// Least squares of what no modulus explains, in units of the noise, by errors of the measured sources.
#[derive(Debug, Clone, Default)]
pub(crate) struct Misfit {
    /// Products of the derivatives with each other, by rows.
    pub(crate) normal: Vec<f64>,
    /// Products of the derivatives with what is left.
    pub(crate) gradient: Vec<f64>,
    /// Sum of squares of what is left.
    pub(crate) square: f64,
    pub(crate) degrees_of_freedom: f64,
}

impl Misfit {
    /// Sum over the lines, of which errors of the sizes `removed` were taken out, with these errors in it.
    fn of(lines: &[LinearisedLine], removed: &[f64]) -> Self {
        let n = removed.len();
        let mut sum = Self {
            normal: vec![0.0; n * n],
            gradient: vec![0.0; n],
            ..Self::default()
        };
        for misfit in lines.iter().filter_map(|line| line.misfit.as_ref()) {
            subtract(&mut sum.normal, -1.0, &misfit.normal);
            subtract(&mut sum.gradient, -1.0, &misfit.gradient);
            sum.square += misfit.square;
            sum.degrees_of_freedom += misfit.degrees_of_freedom;
        }
        let before = sum
            .normal
            .chunks_exact(n.max(1))
            .map(|row| dot(row, removed));
        let before: Vec<f64> = before.collect();
        sum.square += 2.0 * dot(&sum.gradient, removed) + dot(&before, removed);
        subtract(&mut sum.gradient, -1.0, &before);
        sum
    }

    /// Sum of squares that is left with errors of these `sizes` taken out.
    fn left(&self, sizes: &[f64]) -> f64 {
        let rows = self.normal.chunks_exact(self.gradient.len().max(1));
        let quadratic: f64 = rows
            .zip(sizes)
            .map(|(row, size)| size * dot(row, sizes))
            .sum();
        (self.square - 2.0 * dot(&self.gradient, sizes) + quadratic).max(0.0)
    }
}

/// Solves for the errors of the `measured` sources, which the experiment takes out of what was measured, and of all others of the
/// estimate.
///
/// A large delay leaves few lines that can be told apart from their branches and neighbours. Where less than half of them take part, the delays
/// of [`OTHER_STARTS`] are tried as well, and that is taken from which most lines take part.
pub(crate) fn found(
    measured: &[ErrorSource],
    experiment: &impl Experiment,
) -> Result<Option<SelfCalibration>, CmodError> {
    if measured.is_empty() {
        return Ok(None);
    }
    let at_rest = vec![0.0; measured.len()];
    let mut best = found_from(at_rest.clone(), measured, experiment)?;
    let is_delay = |source: &ErrorSource| matches!(source, ErrorSource::Delay);
    let tells_all = |found: &SelfCalibration| 2 * found.lines >= found.estimate.lines().len();
    if best.as_ref().is_none_or(|found| !tells_all(found))
        && let Some(delay) = measured.iter().position(is_delay)
    {
        for start in OTHER_STARTS {
            let mut removed = at_rest.clone();
            if let Some(size) = removed.get_mut(delay) {
                *size = start;
            }
            let other = found_from(removed, measured, experiment)?;
            let lines = |found: &Option<SelfCalibration>| found.as_ref().map(|found| found.lines);
            if lines(&other) > lines(&best) {
                best = other;
            }
        }
    }
    Ok(best)
}

/// The same from errors of the sizes `removed`.
fn found_from(
    mut removed: Vec<f64>,
    measured: &[ErrorSource],
    experiment: &impl Experiment,
) -> Result<Option<SelfCalibration>, CmodError> {
    // of the lines that took part, by their index
    let mut smooth_before: Vec<(usize, Complex64)> = Vec::new();
    for selection in 1.. {
        let estimate = match experiment.estimate(&removed) {
            Ok(estimate) => estimate,
            // what the errors found so far leave is no record any more
            Err(_) if selection > 1 => return Ok(None),
            Err(error) => return Err(error),
        };
        // a line that has no value about a smooth modulus tells nothing
        let about = |line: &ModulusLine, gamma, removed: &[f64]| {
            let linearised = experiment.linearised(line, gamma, removed)?;
            let is_finite = linearised.modulus.is_finite() && linearised.variance > 0.0;
            is_finite.then_some(linearised)
        };
        let mut lines = taking_part(&estimate);
        let mut linearised: Vec<LinearisedLine> = Vec::with_capacity(lines.len());
        if smooth_before.is_empty() {
            // about the noisy lines, with the errors that are in them
            lines.retain(|line| {
                let line = about(line, line.propagation_coefficient, &removed);
                line.map(|line| linearised.push(line)).is_some()
            });
            let Some(smoothing) = Smoothing::of(&lines, &linearised) else {
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
            let Some(posterior) = Posterior::of(&lines, &linearised, measured, &removed) else {
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
        if found.distance(&before) <= SETTLED || selection == MOST_SELECTIONS {
            let estimate = experiment.estimate(&removed)?;
            return found.into_calibration(&estimate, &removed).map(Some);
        }
    }
    Ok(None)
}

/// γ of a `modulus` on the frequency of a line, E = -ρω²/γ².
fn gamma_of(line: &ModulusLine, modulus: Complex64) -> Complex64 {
    line.propagation_coefficient * (line.modulus / modulus).sqrt()
}

/// Values of lines with the indices of these.
fn of_lines(lines: &[&ModulusLine], values: &[Complex64]) -> Vec<(usize, Complex64)> {
    let indices = lines.iter().map(|line| line.index);
    indices.zip(values.iter().copied()).collect()
}

/// The modulus of the line next to the one of this `index`.
fn nearest(smooth: &[(usize, Complex64)], index: usize) -> Option<Complex64> {
    let after = smooth.partition_point(|(other, _)| *other < index);
    let around = smooth.get(after.saturating_sub(1)..(after + 1).min(smooth.len()))?;
    let next = around.iter().min_by_key(|(other, _)| other.abs_diff(index));
    next.map(|(_, modulus)| *modulus)
}

/// The lines that say something of the material. Lines whose gauges contradict each other are among them: errors of the gauges may be why.
fn telling(estimate: &ModulusEstimate) -> impl Iterator<Item = &ModulusLine> {
    estimate.telling_but_for_misfit().filter(|line| {
        let error = line.uncertainty.random.modulus.mean_square().sqrt();
        error > 0.0 && error <= LARGEST_ERROR * line.modulus.norm()
    })
}

/// No more of these than are needed.
fn taking_part(estimate: &ModulusEstimate) -> Vec<&ModulusLine> {
    let stride = telling(estimate).count().div_ceil(MOST_LINES).max(1);
    telling(estimate).step_by(stride).collect()
}

/// Sizes of the errors and what is left of them.
struct Posterior {
    sources: Vec<ErrorSource>,
    sizes: Vec<f64>,
    /// Cholesky's factor of their covariance, by rows.
    factor: Vec<Vec<f64>>,
    mean_square: f64,
    /// The smooth modulus of each line.
    smooth: Vec<Complex64>,
}

impl Posterior {
    /// From `lines` about a smooth modulus, whose `measured` sources have had errors of the sizes `removed` taken out. `None` if the
    /// lines are too few.
    fn of(
        lines: &[&ModulusLine],
        about: &[LinearisedLine],
        measured: &[ErrorSource],
        removed: &[f64],
    ) -> Option<Self> {
        let sources = sources_of(about, measured);
        let smoothing = Smoothing::of(lines, about)?;
        let rows = 2 * lines.len();
        let freedom = rows as f64 - smoothing.parameters;
        let unknowns = smoothing.parameters + sources.len() as f64;
        if (rows as f64) < FEWEST_PER_UNKNOWN * unknowns {
            return None;
        }
        // the modulus with all errors in it, to first order
        let with_errors = smoothing.whitened(about.iter().map(|line| {
            let back = measured.iter().zip(removed);
            line.modulus
                + back
                    .map(|(source, size)| shift_of(&line.shifts, *source).modulus * *size)
                    .sum::<Complex64>()
        }));
        let shifts: Vec<Vec<f64>> = sources
            .iter()
            .map(|source| {
                let of_source = |line: &LinearisedLine| shift_of(&line.shifts, *source).modulus;
                smoothing.whitened(about.iter().map(of_source))
            })
            .collect();
        let target = smoothing.rest_of(&with_errors);
        let columns: Vec<Vec<f64>> = shifts
            .iter()
            .map(|shift| smoothing.rest_of(shift))
            .collect();

        let misfit = Misfit::of(about, removed);
        let (sizes, _) = ridge(&columns, &target, &misfit, 1.0)?;
        let left = without(&target, &columns, &sizes);
        let mean_square = (dot(&left, &left) + dot(&sizes, &sizes) + misfit.left(&sizes))
            / (freedom + misfit.degrees_of_freedom);
        let (sizes, covariance) = ridge(&columns, &target, &misfit, mean_square.max(1.0))?;
        let smooth = smoothing.smooth(&without(&with_errors, &shifts, &sizes));
        let factor = covariance.llt(Side::Lower).ok()?;
        let factor = factor.L();
        let n = sources.len();
        Some(Self {
            sources,
            sizes,
            factor: (0..n)
                .map(|i| (0..n).map(|j| factor[(i, j)]).collect())
                .collect(),
            mean_square,
            smooth,
        })
    }

    /// By how many of its standard errors a size differs at most from those of `others`.
    fn distance(&self, others: &[f64]) -> f64 {
        others
            .iter()
            .zip(&self.sizes)
            .zip(&self.factor)
            .map(|((other, own), row)| (own - other).abs() / length(row))
            .fold(0.0, f64::max)
    }

    /// The `estimate`, which has errors of the sizes `removed` taken out, without what is left to take out.
    fn into_calibration(
        self,
        estimate: &ModulusEstimate,
        removed: &[f64],
    ) -> Result<SelfCalibration, CmodError> {
        let mut acceptance = Acceptance::new(*estimate.limits(), None)?;
        let mut lines = Vec::with_capacity(estimate.lines().len());
        for line in estimate.lines() {
            let degrees_of_freedom = line.uncertainty.degrees_of_freedom;
            if acceptance.degrees_of_freedom() != degrees_of_freedom {
                acceptance = Acceptance::new(*estimate.limits(), degrees_of_freedom)?;
            }
            lines.extend(self.line(line, removed).revised(&acceptance, |_| true));
        }
        let sources = self.sources.iter().zip(&self.sizes).zip(&self.factor);
        Ok(SelfCalibration {
            estimate: estimate.with_lines(lines),
            sources: sources
                .map(|((source, size), row)| CalibratedSource {
                    source: *source,
                    size: *size,
                    standard_error: length(row),
                })
                .collect(),
            lines: telling(estimate).count(),
            mean_square: self.mean_square,
        })
    }

    fn line(&self, line: &ModulusLine, removed: &[f64]) -> ModulusLine {
        let shifts: Vec<SystematicShift> = self
            .sources
            .iter()
            .map(|source| shift_of(&line.uncertainty.systematic, *source))
            .collect();
        let mut calibrated = line.clone();
        let before = removed.iter().copied().chain(std::iter::repeat(0.0));
        for ((shift, size), before) in shifts.iter().zip(&self.sizes).zip(before) {
            calibrated.modulus -= (size - before) * shift.modulus;
            calibrated.propagation_coefficient -= (size - before) * shift.propagation_coefficient;
        }
        let systematic = &mut calibrated.uncertainty.systematic;
        systematic.retain(|shift| !self.sources.contains(&shift.source));
        for (column, source) in self.sources.iter().enumerate() {
            let sum = |part: fn(&SystematicShift) -> Complex64| -> Complex64 {
                let rows = self.factor.iter().zip(&shifts);
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
}

/// The sources of all lines that have a standard uncertainty, those that were `measured` first.
fn sources_of(lines: &[LinearisedLine], measured: &[ErrorSource]) -> Vec<ErrorSource> {
    let mut sources = measured.to_vec();
    for shift in lines.iter().flat_map(|line| &line.shifts) {
        if shift.source != ErrorSource::LateralInertia && !sources.contains(&shift.source) {
            sources.push(shift.source);
        }
    }
    sources
}

/// The part of the `shifts` of a line by `source`; 0 where it does not depend on it.
fn shift_of(shifts: &[SystematicShift], source: ErrorSource) -> SystematicShift {
    let mut sum = SystematicShift::new(source, Complex64::ZERO, Complex64::ZERO);
    for shift in shifts {
        if shift.source == source {
            sum.modulus += shift.modulus;
            sum.propagation_coefficient += shift.propagation_coefficient;
        }
    }
    sum
}

/// Least squares of a smooth modulus through lines, in units of their noise.
struct Smoothing {
    weights: Vec<f64>,
    /// Orthonormal directions of all smooth moduli, over the lines and the priors of the coefficients.
    basis: Vec<Vec<f64>>,
    /// Number of parameters that the lines determine.
    parameters: f64,
}

impl Smoothing {
    /// `None` without lines, or where a value is not finite.
    fn of(lines: &[&ModulusLine], about: &[LinearisedLine]) -> Option<Self> {
        let weight = |line: &LinearisedLine| (2.0 / line.variance).sqrt();
        let weights: Vec<f64> = about.iter().map(weight).collect();
        let columns: Vec<Vec<f64>> = SmoothModulus::on(lines)?
            .terms(lines)
            .into_iter()
            .map(|term| whitened(&weights, term.into_iter()))
            .collect();
        let rows = 2 * lines.len();
        let basis = basis(&columns, rows)?;
        // of the directions in the rows of the lines; the rest is of the priors
        let of_lines =
            |direction: &Vec<f64>| direction.iter().take(rows).map(|x| x * x).sum::<f64>();
        Some(Self {
            weights,
            parameters: basis.iter().map(of_lines).sum(),
            basis,
        })
    }

    /// Values of the lines by their noise, real and imaginary parts in turn, and 0 for the priors.
    fn whitened(&self, values: impl Iterator<Item = Complex64>) -> Vec<f64> {
        let mut values = whitened(&self.weights, values);
        values.resize(values.len() + self.basis.len(), 0.0);
        values
    }

    /// What no smooth modulus follows of whitened `values`.
    fn rest_of(&self, values: &[f64]) -> Vec<f64> {
        let mut rest = values.to_vec();
        for direction in &self.basis {
            let part = dot(direction, &rest);
            subtract(&mut rest, part, direction);
        }
        rest
    }

    /// The smooth modulus of each line nearest to whitened `values`.
    fn smooth(&self, values: &[f64]) -> Vec<Complex64> {
        let mut smooth = values.to_vec();
        subtract(&mut smooth, 1.0, &self.rest_of(values));
        let lines = smooth.chunks_exact(2).zip(&self.weights);
        lines
            .map(|(parts, w)| match parts {
                [re, im] => Complex64::new(re / w, im / w),
                _ => Complex64::ZERO,
            })
            .collect()
    }
}

fn whitened(weights: &[f64], values: impl Iterator<Item = Complex64>) -> Vec<f64> {
    let whitened = weights.iter().zip(values).map(|(w, value)| w * value);
    whitened.flat_map(|value| [value.re, value.im]).collect()
}

/// Functions of frequency whose sums any smooth and causal modulus in a band is.
struct SmoothModulus {
    relaxation_times: Vec<f64>,
    highest: f64,
}

impl SmoothModulus {
    /// `None` without lines.
    fn on(lines: &[&ModulusLine]) -> Option<Self> {
        let lowest = TAU * lines.first()?.frequency_hz;
        let highest = TAU * lines.last()?.frequency_hz;
        let shortest = (BEYOND * highest).recip();
        let longest = BEYOND / lowest;
        let relaxation_times = std::iter::successors(Some(shortest), |tau| Some(GRID * tau));
        Some(Self {
            relaxation_times: relaxation_times.take_while(|tau| *tau <= longest).collect(),
            highest,
        })
    }

    /// Each function on the `lines`, as large as its coefficient may be expected at most.
    fn terms(&self, lines: &[&ModulusLine]) -> Vec<Vec<Complex64>> {
        let on_lines = |function: &dyn Fn(f64) -> Complex64| -> Vec<Complex64> {
            let values = lines.iter().map(|line| function(TAU * line.frequency_hz));
            let mut values: Vec<Complex64> = values.collect();
            let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
            let modulus = largest(&mut lines.iter().map(|line| line.modulus.norm()));
            let scale =
                LARGEST_TERM * modulus / largest(&mut values.iter().map(|value| value.norm()));
            for value in &mut values {
                *value *= scale;
            }
            values
        };
        let relative = |omega: f64| omega / self.highest;
        let mut terms = vec![
            on_lines(&|_| Complex64::ONE),
            on_lines(&|omega| Complex64::new(0.0, relative(omega))),
            on_lines(&|omega| Complex64::new(relative(omega).powi(2), 0.0)),
        ];
        terms.extend(self.relaxation_times.iter().map(|tau| {
            on_lines(&|omega| {
                let phase = Complex64::new(0.0, omega * tau);
                phase / (1.0 + phase)
            })
        }));
        terms
    }
}

/// Orthonormal directions that span the `columns` of so many `rows` on top of a unit matrix, which is the prior of their coefficients. `None` if an
/// entry is not finite.
fn basis(columns: &[Vec<f64>], rows: usize) -> Option<Vec<Vec<f64>>> {
    let entry = |i: usize, j: usize| -> f64 {
        match i.checked_sub(rows) {
            Some(own) => f64::from(u8::from(own == j)),
            None => columns
                .get(j)
                .and_then(|column| column.get(i))
                .copied()
                .unwrap_or(0.0),
        }
    };
    let all = rows + columns.len();
    let vectors = Mat::from_fn(all, columns.len(), entry)
        .qr()
        .compute_thin_Q();
    let directions: Vec<Vec<f64>> = (0..columns.len())
        .map(|k| (0..all).map(|i| vectors[(i, k)]).collect())
        .collect();
    directions
        .iter()
        .flatten()
        .all(|x| x.is_finite())
        .then_some(directions)
}

/// min (|b - Jξ|² + that of the `misfit`)/s² + |ξ|² and the covariance of ξ, (I + JᵀJ/s²)⁻¹. `None` if a value is not finite.
fn ridge(
    columns: &[Vec<f64>],
    target: &[f64],
    misfit: &Misfit,
    mean_square: f64,
) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = columns.len();
    let measured = misfit.gradient.len();
    let product = |i: usize, j: usize| -> f64 {
        let pair = columns.get(i).zip(columns.get(j));
        let of_lines = pair.map_or(0.0, |(a, b)| dot(a, b));
        let of_misfit = if j < measured {
            misfit.normal.get(i * measured + j).copied().unwrap_or(0.0)
        } else {
            0.0
        };
        (of_lines + of_misfit) / mean_square + f64::from(u8::from(i == j))
    };
    let normal = Mat::from_fn(n, n, product);
    let right = Mat::from_fn(n, n + 1, |i, j| {
        if j < n {
            f64::from(u8::from(i == j))
        } else {
            let of_lines = columns.get(i).map_or(0.0, |column| dot(column, target));
            let of_misfit = misfit.gradient.get(i).copied().unwrap_or(0.0);
            (of_lines + of_misfit) / mean_square
        }
    });
    use faer::linalg::solvers::Solve as _;
    let solved = normal.llt(Side::Lower).ok()?.solve(right);
    let sizes: Vec<f64> = (0..n).map(|i| solved[(i, n)]).collect();
    // rounding leaves the inverse unsymmetric in its last digits
    let covariance = Mat::from_fn(n, n, |i, j| 0.5 * (solved[(i, j)] + solved[(j, i)]));
    sizes
        .iter()
        .all(|size| size.is_finite())
        .then_some((sizes, covariance))
}

/// `values` - Σ sizes · columns.
fn without(values: &[f64], columns: &[Vec<f64>], sizes: &[f64]) -> Vec<f64> {
    let mut left = values.to_vec();
    for (size, column) in sizes.iter().zip(columns) {
        subtract(&mut left, *size, column);
    }
    left
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn length(values: &[f64]) -> f64 {
    dot(values, values).sqrt()
}

fn subtract(values: &mut [f64], factor: f64, other: &[f64]) {
    for (value, other) in values.iter_mut().zip(other) {
        *value -= factor * other;
    }
}
