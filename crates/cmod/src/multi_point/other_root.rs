//! Choice between two roots of a line that explain the gauges equally well.
//!
//! With two gauges and a free end, or with three gauges, γ of a line is a root of g(γ) = Ψ, where Ψ
//! is a ratio of measured values. Near g' = 0 there are two roots near each other: the minima of
//! the misfit V at both are equal, and the iteration may converge to either of them. Only the
//! neighbouring lines can distinguish the roots, because γ/ω is a smooth function of frequency. The
//! *course* near a line is a parabola for γ/ω, fitted to the lines within a quarter wave on either
//! side; its value at the line is the expected γ/ω.
//!
//! The farther apart the roots of a line are, the more reliable is the choice. The lines are
//! therefore decided in the order of decreasing distance, and every decided line contributes to the
//! courses at the lines that are decided after it.

use std::f64::consts::FRAC_PI_2;

use num_complex::Complex64;

use super::projection::Objective;
use crate::branch::{BranchDoubt, LEAST_CONFIDENCE};

/// Standard deviation of the course of γ due to common errors of the gauges, which distort the
/// course, relative to γ. It adds to the error due to the scatter of the lines about the course.
const COURSE_ERROR: f64 = 2e-3;
/// Minimum number of lines that determine a course: two more than a parabola has coefficients.
const FEWEST_LINES: usize = 5;
/// Number of coefficients of the course.
const COEFFICIENTS: u8 = 3;
/// Misfit without noise, relative to the power of the line, below which two roots explain the line
/// equally well.
const MISFIT_WITHOUT_NOISE: f64 = 1e-12;

/// Root of a line with its misfit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Root {
    pub(super) gamma: Complex64,
    /// Misfit V.
    pub(super) misfit: f64,
    /// Inverse d^H d of the variance of γ.
    pub(super) information: f64,
}

impl Root {
    pub(super) fn at(gamma: Complex64, objective: &Objective) -> Self {
        Self {
            gamma,
            misfit: objective.misfit,
            information: objective.information,
        }
    }
}

/// Line with the root that the iteration found and the other root, if there is one.
#[derive(Debug, Clone, Copy)]
pub(super) struct LineOnCourse {
    /// ω, or ω - iσ if damping was added.
    pub(super) omega: Complex64,
    pub(super) root: Root,
    /// Other root near the first, if there is one.
    pub(super) other: Option<Root>,
    /// False if the root is doubtful, so that it must not affect other lines.
    pub(super) is_reliable: bool,
    /// Variance of one value: 1, or 0 without noise.
    pub(super) variance: f64,
    /// Sum of the squares of the values.
    pub(super) power: f64,
    pub(super) degrees_of_freedom: usize,
}

impl LineOnCourse {
    /// Returns the factor by which a `misfit` exceeds the noise, at least 1.
    fn excess(&self, misfit: f64) -> f64 {
        if self.variance > 0.0 && self.degrees_of_freedom > 0 {
            (2.0 * misfit / self.degrees_of_freedom as f64).max(1.0)
        } else {
            1.0
        }
    }

    fn weight(&self) -> f64 {
        self.omega.norm_sqr() * self.root.information / self.excess(self.root.misfit)
    }

    /// Returns the distance between the two roots, 0 if there is no other root.
    fn separation(&self) -> f64 {
        self.other
            .map_or(0.0, |other| (other.gamma - self.root.gamma).norm())
    }
}

/// Decision about a line with two roots.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decision {
    /// Place of the line in the list.
    pub(super) place: usize,
    /// True if the other root replaces the root that was found.
    pub(super) is_other: bool,
    /// Doubt if the course does not distinguish the roots with sufficient confidence.
    pub(super) doubt: Option<BranchDoubt>,
}

/// Decides between the two roots of each line that has two, and replaces `root` where the other
/// root was chosen. `distance` is the distance over which waves are counted \[m\]. A line with too
/// few neighbours keeps its root.
pub(super) fn decide(lines: &mut [LineOnCourse], distance: f64) -> Vec<Decision> {
    let mut open: Vec<(usize, f64)> = lines
        .iter()
        .enumerate()
        .filter(|(_, line)| line.other.is_some())
        .map(|(place, line)| (place, line.separation()))
        .collect();
    open.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut is_decided: Vec<bool> = lines
        .iter()
        .map(|line| line.other.is_none() && line.is_reliable)
        .collect();
    let mut decisions = Vec::with_capacity(open.len());
    for (place, _) in open {
        let Some(line) = lines.get(place).copied() else {
            continue;
        };
        let course = Course::at(&line, lines, &is_decided, distance);
        let decision = course.and_then(|course| course.choose(place, &line, distance));
        let is_doubtful = decision.is_some_and(|decision| decision.doubt.is_some());
        if let (Some(line), Some(is_decided)) = (lines.get_mut(place), is_decided.get_mut(place)) {
            if decision.is_some_and(|decision| decision.is_other)
                && let Some(other) = line.other
            {
                line.root = other;
            }
            *is_decided = line.is_reliable && !is_doubtful;
        }
        decisions.extend(decision);
    }
    decisions
}

/// Value of γ expected on a line from the lines around it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Course {
    gamma: Complex64,
    variance: f64,
}

impl Course {
    /// Fits γ/ω of the decided lines within a quarter wave; returns `None` if they are too few.
    fn at(
        line: &LineOnCourse,
        lines: &[LineOnCourse],
        is_decided: &[bool],
        distance: f64,
    ) -> Option<Self> {
        let reach = FRAC_PI_2 / (distance * (line.root.gamma / line.omega).im);
        let away = |other: &LineOnCourse| (other.omega.re - line.omega.re) / reach;
        let first = lines.partition_point(|other| away(other) < -1.0);
        let end = lines.partition_point(|other| away(other) <= 1.0);
        let around = lines.get(first..end)?.iter().zip(is_decided.get(first..)?);
        let around: Vec<&LineOnCourse> = around
            .filter(|(_, is_decided)| **is_decided)
            .map(|(other, _)| other)
            .collect();
        if around.len() < FEWEST_LINES {
            return None;
        }
        let weights: Vec<f64> = around.iter().map(|other| other.weight()).collect();
        let mut rest: Vec<Complex64> = around
            .iter()
            .map(|other| other.root.gamma / other.omega)
            .collect();
        // orthonormal polynomials, with their values at the line itself
        let mut basis: Vec<(Vec<f64>, f64)> = Vec::with_capacity(COEFFICIENTS.into());
        let (mut slowness, mut variance) = (Complex64::ZERO, 0.0);
        for power in 0..COEFFICIENTS {
            let mut values: Vec<f64> = around
                .iter()
                .map(|other| away(other).powi(power.into()))
                .collect();
            let mut here = if power == 0 { 1.0 } else { 0.0 };
            for (earlier, earlier_here) in &basis {
                let part = product(&weights, earlier, &values);
                for (value, earlier) in values.iter_mut().zip(earlier) {
                    *value -= part * earlier;
                }
                here -= part * earlier_here;
            }
            let scale = product(&weights, &values, &values).sqrt().recip();
            values.iter_mut().for_each(|value| *value *= scale);
            here *= scale;
            let terms = weights.iter().zip(&values).zip(&rest);
            let part: Complex64 = terms.map(|((w, value), rest)| w * value * rest).sum();
            for (rest, value) in rest.iter_mut().zip(&values) {
                *rest -= part * value;
            }
            slowness += part * here;
            variance += here * here;
            basis.push((values, here));
        }
        let terms = weights.iter().zip(&rest);
        let square: f64 = terms.map(|(w, rest)| w * rest.norm_sqr()).sum();
        let scatter = square / (around.len() - basis.len()) as f64;
        let course = Self {
            gamma: slowness * line.omega,
            variance: variance * scatter.max(line.variance) * line.omega.norm_sqr(),
        };
        (course.gamma.is_finite() && course.variance.is_finite()).then_some(course)
    }

    /// Chooses the root with the larger probability, which follows from the misfit of the root and
    /// from its distance from the course.
    fn choose(&self, place: usize, line: &LineOnCourse, distance: f64) -> Option<Decision> {
        let other = line.other?;
        let excess = line.excess(line.root.misfit.min(other.misfit));
        let unit = if line.variance > 0.0 {
            excess
        } else {
            MISFIT_WITHOUT_NOISE * line.power
        };
        let of_course = self.variance + (COURSE_ERROR * self.gamma.norm()).powi(2);
        let cost = |root: &Root| {
            let variance = of_course + line.variance * excess / root.information;
            root.misfit / unit + (root.gamma - self.gamma).norm_sqr() / variance
        };
        let more = cost(&other) - cost(&line.root);
        let is_other = more < 0.0;
        let confidence = (1.0 + (-more.abs()).exp()).recip();
        let rejected = if is_other { line.root } else { other };
        Some(Decision {
            place,
            is_other,
            doubt: (confidence < LEAST_CONFIDENCE).then_some(BranchDoubt::OtherRoot {
                confidence,
                least: LEAST_CONFIDENCE,
                other: rejected.gamma.im * distance,
            }),
        })
    }
}

fn product(weights: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let terms = weights.iter().zip(a.iter().zip(b));
    terms.map(|(w, (a, b))| w * a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DISTANCE: f64 = 0.5;

    /// Returns γ of a material whose wave speed grows with frequency.
    fn gamma(omega: f64) -> Complex64 {
        Complex64::new(0.06, 1.0) * (omega / 1400.0 * (omega / 1e4).powf(-0.04))
    }

    /// Returns lines 600 rad/s apart. In the middle of them, at 15e3 rad/s, two roots meet; the
    /// root of each line within 1500 rad/s is interchanged with the other if `is_wrong`.
    fn lines(gap: Complex64, is_wrong: bool) -> Vec<LineOnCourse> {
        let middle = gamma(15e3) + 0.5 * gap;
        let line = |j: u32| {
            let omega = 600.0 * f64::from(j);
            let gamma = gamma(omega);
            let other = 2.0 * middle - gamma;
            // near a double root the information is that of the ratio times |g'|²
            let root = |gamma: Complex64| Root {
                gamma,
                misfit: 0.3,
                information: 2e4 * (gamma - middle).norm_sqr(),
            };
            let is_near = (omega - 15e3).abs() < 1500.0;
            let (found, rest) = if is_near && is_wrong {
                (other, gamma)
            } else {
                (gamma, other)
            };
            LineOnCourse {
                omega: omega.into(),
                root: root(found),
                other: is_near.then(|| root(rest)),
                is_reliable: true,
                variance: 1.0,
                power: 1e8,
                degrees_of_freedom: 2,
            }
        };
        (10..45).map(line).collect()
    }

    /// A wrong root to which the iteration converged is replaced, and a right root is kept.
    #[test]
    fn the_root_on_the_course_is_chosen() {
        for is_wrong in [false, true] {
            let mut lines = lines(Complex64::new(0.3, 0.2), is_wrong);
            let decisions = decide(&mut lines, DISTANCE);
            assert_eq!(decisions.len(), 5);
            for decision in decisions {
                assert_eq!(decision.is_other, is_wrong, "{decision:?}");
                assert_eq!(decision.doubt, None);
            }
            for line in lines {
                assert_eq!(line.root.gamma, gamma(line.omega.re));
            }
        }
    }

    /// Two roots that are nearer to each other than the error of the course are doubtful.
    #[test]
    fn roots_that_the_course_does_not_distinguish_are_doubtful() {
        let mut lines = lines(Complex64::new(0.02, 0.02), false);
        let decisions = decide(&mut lines, DISTANCE);
        let doubts: Vec<_> = decisions.iter().filter(|of| of.doubt.is_some()).collect();
        assert_eq!(doubts.len(), 1, "{decisions:?}");
        let doubtful = lines.get(doubts[0].place).unwrap();
        assert!((doubtful.omega.re - 15e3).abs() < 1.0);
    }

    /// Lines that all have two roots: no decided lines are left to which a parabola could be fitted,
    /// and no line is changed.
    #[test]
    fn few_neighbours_decide_nothing() {
        let lines = lines(Complex64::new(0.3, 0.2), true);
        let middle = lines
            .iter()
            .position(|line| (line.omega.re - 15e3).abs() < 1.0)
            .unwrap();
        let mut few = lines[middle - 2..=middle + 2].to_vec();
        assert!(decide(&mut few, DISTANCE).is_empty());
    }
}
