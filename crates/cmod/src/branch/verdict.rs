//! Conversion of the courses of γ(ω) to results per line: the root of each line and its confidence.
//!
//! Of the many roots of a line, the right one is the one nearest to the true γℓ. The smoothed γℓ of
//! a course is normally distributed with a known variance. The probability that it is nearer to a
//! root than to the next root is therefore given by the error function, and is averaged over the
//! courses with their weights.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use num_complex::Complex64;
use statrs::function::erf::erfc;

use super::doubt::BranchDoubt;
use super::forward::{Courses, LineAt};
use super::path::{BAD_LINE, Backward, Smoothed};
use super::tracked::{SpeedHypothesis, TrackedLine};

/// Number of courses compared on every line.
const RIVALS: usize = 8;
/// Log weight below which a course is not compared.
const NO_RIVAL: f64 = -16.0;
/// Distance \[rad\] below which two roots count as one: where kL > π, the values of k of two such
/// roots differ by less than 0.2 %.
pub(super) const ONE_ROOT: f64 = 0.005;
/// Mean over [`NEIGHBOURHOOD`] lines of |misfit|² divided by its expectation, above which the
/// misfit is not due to noise.
const ERRATIC: f64 = 6.0;
const NEIGHBOURHOOD: f64 = 8.0;
/// Value of |misfit|² divided by its expectation, above which a single line is an outlier; noise
/// exceeds this limit once in 10⁷ lines.
const STRANGE: f64 = 16.0;
const SURPRISE: f64 = 4.0;
/// Confidence below which a branch counts as doubtful.
pub const LEAST_CONFIDENCE: f64 = 0.9999;
/// Number of standard errors beyond which a probability is 1 to all digits.
const SURE: f64 = 8.3;
/// Number of standard errors below 0 beyond which a damping counts as negative.
const SURELY_NEGATIVE: f64 = 4.0;

/// Smoothed courses of significant weight, from which the results per line are computed.
pub(super) struct Verdict {
    /// Probability and smoothed γ of every course, the most probable first.
    courses: Vec<(f64, Vec<Smoothed>)>,
    /// Misfit of every line relative to the first course.
    misfits: Vec<Misfit>,
    determined: bool,
    crowded_out: f64,
}

/// Misfits of a line and of the lines around it, relative to the first course.
#[derive(Debug, Clone, Copy)]
struct Misfit {
    /// Mean over the neighbouring lines; infinite after a long erratic stretch.
    around: f64,
    /// |misfit|² from the prediction by the previous lines, divided by its expectation; `None`
    /// without a prediction.
    own: Option<f64>,
}

impl Verdict {
    pub(super) fn of(courses: &Courses, lines: &[LineAt<'_>]) -> Self {
        let rivals = courses
            .alive
            .iter()
            .take(RIVALS)
            .take_while(|course| course.log_weight > NO_RIVAL);
        let mut chi_square = vec![None; lines.len()];
        let mut smoothed = Vec::with_capacity(RIVALS);
        for (rank, course) in rivals.enumerate() {
            let mut row = vec![Smoothed::default(); lines.len()];
            let mut backward = Backward::default();
            let mut passage = course.last;
            for (index, line) in lines.iter().enumerate().rev() {
                let Some(this) = passage.and_then(|index| courses.passages.get(index)) else {
                    break;
                };
                if let (Some(entry), Some(chi)) = (row.get_mut(index), chi_square.get_mut(index)) {
                    *entry = backward.pass(this);
                    if rank == 0 {
                        *chi = this.chi_square.map(|chi| chi.min(BAD_LINE));
                    }
                }
                passage = this.before;
                if let Some(before) = index.checked_sub(1).and_then(|index| lines.get(index)) {
                    backward.step_down(line.omega - before.omega);
                }
            }
            smoothed.push((course.log_weight.exp(), row));
        }
        let misfit = smoothed
            .first()
            .map(|(_, best)| local_misfit(&chi_square, best, lines))
            .unwrap_or_default();
        let misfits = misfit.into_iter().zip(chi_square);
        Self {
            courses: smoothed,
            misfits: misfits
                .map(|(around, own)| Misfit { around, own })
                .collect(),
            determined: courses.determined,
            crowded_out: courses.crowded_out,
        }
    }

    pub(super) fn hypotheses(&self, lines: &[LineAt<'_>]) -> Vec<SpeedHypothesis> {
        let Some(first) = lines.first() else {
            return Vec::new();
        };
        let at_first = |(probability, course): &(f64, Vec<Smoothed>)| {
            let smoothed = course.first()?;
            Some(SpeedHypothesis {
                wave_speed: first.omega / smoothed.gamma.im,
                probability: *probability,
            })
        };
        self.courses.iter().filter_map(at_first).collect()
    }

    /// Returns the root of a line, its confidence and the main doubt.
    pub(super) fn line(&self, index: usize, line: &LineAt<'_>) -> TrackedLine {
        // without a course, or without a misfit of the line, the line is undetermined
        let found = self.phase(0, index, line).zip(self.misfits.get(index));
        let Some((best, misfit)) = found else {
            return TrackedLine {
                root: None,
                expected: Complex64::ZERO,
                expected_error: f64::INFINITY,
                confidence: 0.0,
                doubt: Some(BranchDoubt::Undetermined),
            };
        };
        let mut tracked = TrackedLine {
            root: None,
            expected: best.mean,
            expected_error: best.spread,
            confidence: 0.0,
            doubt: None,
        };
        let roots = if line.missing {
            None
        } else {
            best.nearest_roots(line)
        };
        let Some([root, other]) = roots else {
            return tracked;
        };
        tracked.root = Some(root);
        let mut disagreeing = (0.0, None);
        for (rank, (probability, _)) in self.courses.iter().enumerate() {
            let Some(phase) = self.phase(rank, index, line) else {
                continue;
            };
            let agrees = if rank == 0 {
                phase.probability_of_first(root, other)
            } else {
                phase.probability_of(root, line)
            };
            tracked.confidence += probability * agrees;
            if agrees < 0.5 {
                disagreeing.0 += probability;
                disagreeing.1 = disagreeing.1.or(Some(phase.mean.im));
            }
        }
        tracked.confidence *= 1.0 - self.crowded_out.min(1.0);
        tracked.doubt = self.doubt(
            misfit,
            line,
            &best,
            &mut tracked.confidence,
            (root, other),
            disagreeing,
        );
        tracked
    }

    fn doubt(
        &self,
        misfit: &Misfit,
        line: &LineAt<'_>,
        best: &Phase,
        confidence: &mut f64,
        (root, other): (Complex64, Complex64),
        (disagreeing, rival): (f64, Option<f64>),
    ) -> Option<BranchDoubt> {
        if !self.determined {
            *confidence = 0.0;
            return Some(BranchDoubt::Undetermined);
        }
        if misfit.around > ERRATIC {
            *confidence = 0.0;
            return Some(BranchDoubt::Erratic {
                chi_square: misfit.around,
                limit: ERRATIC,
            });
        }
        if best.raw.re < -SURELY_NEGATIVE * best.spread {
            *confidence = 0.0;
            return Some(BranchDoubt::Turned {
                damping_length: best.raw.re,
                deviations: -best.raw.re / best.spread,
            });
        }
        if is_strange(misfit, line, best) {
            *confidence = 0.0;
            return Some(BranchDoubt::Leap {
                expected: best.mean.im,
                found: root.im,
            });
        }
        let unsure = *confidence < LEAST_CONFIDENCE;
        if unsure && let Some(rival) = rival.filter(|_| disagreeing > 0.5 * (1.0 - *confidence)) {
            let speed = |phase: f64| line.omega * line.sight.length / phase;
            return Some(BranchDoubt::SeveralSpeeds {
                chosen: speed(best.mean.im),
                other: speed(rival),
            });
        }
        if unsure && (root - other).norm() > ONE_ROOT {
            return Some(BranchDoubt::OtherRoot {
                confidence: *confidence,
                least: LEAST_CONFIDENCE,
                other: other.im,
            });
        }
        (root.re < 0.0).then_some(BranchDoubt::NegativeDamping {
            damping_length: root.re,
        })
    }

    fn phase(&self, rank: usize, index: usize, line: &LineAt<'_>) -> Option<Phase> {
        let (_, course) = self.courses.get(rank)?;
        let smoothed = course.get(index)?;
        Some(Phase::of(smoothed, line.sight.length))
    }
}

/// Returns true if a single line is an outlier; false where the filter found no large misfit.
fn is_strange(misfit: &Misfit, line: &LineAt<'_>, best: &Phase) -> bool {
    if misfit.own.is_none_or(|chi_square| chi_square < SURPRISE) {
        return false;
    }
    let [value, slope, curvature] = line.sight.observation.expand(best.raw);
    let phase_variance = 2.0 * best.spread * best.spread;
    let expected = line.sight.variance
        + slope.norm_sqr() * phase_variance
        + 0.5 * curvature.norm_sqr() * phase_variance * phase_variance;
    (line.sight.observed - value).norm_sqr() > STRANGE * expected
}

/// Distribution of γℓ of a course at a line: a normal distribution, truncated where the damping is
/// negative.
struct Phase {
    /// Mean without truncation.
    raw: Complex64,
    /// Standard deviation of the real part and of the imaginary part, without truncation.
    spread: f64,
    mean: Complex64,
    /// Variance of the real part.
    damping_variance: f64,
}

impl Phase {
    fn of(smoothed: &Smoothed, length: f64) -> Self {
        let raw = smoothed.gamma * length;
        let spread = (0.5 * smoothed.variance.max(0.0)).sqrt() * length;
        let deviation = raw.re / spread;
        let (damping, damping_variance) = if deviation > 6.0 || spread == 0.0 {
            (raw.re, spread * spread)
        } else {
            cut_below_zero(raw.re, spread)
        };
        Self {
            raw,
            spread,
            mean: Complex64::new(damping, raw.im),
            damping_variance,
        }
    }

    fn nearest_roots(&self, line: &LineAt<'_>) -> Option<[Complex64; 2]> {
        line.sight
            .observation
            .nearest_roots(line.sight.observed, self.mean)
    }

    /// Returns the probability that γℓ is nearer to `root` than to `other`.
    fn probability_of_first(&self, root: Complex64, other: Complex64) -> f64 {
        let between = root - other;
        let ahead = ((self.mean - 0.5 * (root + other)) * between.conj()).re;
        let variance = between.re * between.re * self.damping_variance
            + between.im * between.im * self.spread * self.spread;
        if ahead > 0.0 && ahead * ahead >= SURE * SURE * variance {
            1.0
        } else if variance > 0.0 {
            0.5 * erfc(-ahead / variance.sqrt() * FRAC_1_SQRT_2)
        } else {
            0.5
        }
    }

    /// Returns the probability that γℓ is nearest to `root`; 0 for a root farther away than the two
    /// nearest roots.
    fn probability_of(&self, root: Complex64, line: &LineAt<'_>) -> f64 {
        let same = |other: Complex64| (other - root).norm() < ONE_ROOT;
        match self.nearest_roots(line) {
            Some([first, second]) if same(first) => self.probability_of_first(first, second),
            Some([first, second]) if same(second) => 1.0 - self.probability_of_first(first, second),
            _ => 0.0,
        }
    }
}

/// Returns mean and variance of a normal variable under the condition that it is positive.
fn cut_below_zero(mean: f64, spread: f64) -> (f64, f64) {
    let a = -mean / spread;
    let tail = 0.5 * erfc(a * FRAC_1_SQRT_2);
    // beyond eight standard errors Mills' ratio is computed by its asymptotic expansion; farther
    // out the tail underflows
    let hazard = if a > 8.0 {
        a + 1.0 / a
    } else {
        (-0.5 * a * a).exp() / (2.0 * PI).sqrt() / tail
    };
    let variance = (1.0 + a * hazard - hazard * hazard).max(0.0);
    (mean + spread * hazard, spread * spread * variance)
}

/// Returns, for each line, the larger of the mean misfits over the lines before and after it;
/// infinite after a stretch of more than half a wave in which the mean exceeds [`ERRATIC`], because
/// the count of waves is then lost.
fn local_misfit(chi_square: &[Option<f64>], best: &[Smoothed], lines: &[LineAt<'_>]) -> Vec<f64> {
    let share = 1.0 / NEIGHBOURHOOD;
    let running = |mean: &mut f64, chi_square: &Option<f64>| {
        if let Some(chi_square) = chi_square {
            *mean += share * (chi_square - *mean);
        }
        Some(*mean)
    };
    let mut misfit: Vec<f64> = chi_square.iter().scan(1.0, running).collect();
    let backward = chi_square.iter().rev().scan(1.0, running);
    for (misfit, backward) in misfit.iter_mut().rev().zip(backward) {
        *misfit = misfit.max(backward);
    }
    let mut began: Option<f64> = None;
    let mut lost = false;
    for ((misfit, smoothed), line) in misfit.iter_mut().zip(best).zip(lines) {
        let phase = smoothed.gamma.im * line.sight.length;
        if *misfit > ERRATIC {
            lost |= phase - *began.get_or_insert(phase) > PI;
        } else {
            began = None;
        }
        if lost {
            *misfit = f64::INFINITY;
        }
    }
    misfit
}

#[cfg(test)]
mod tests;
