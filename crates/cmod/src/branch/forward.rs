//! Courses of γ(ω) compatible with the lines, from the first line to the last.
//!
//! A course begins at every root of a few well-determined lines near the start. It is weighted by
//! the probability density of each next line, given the lines before it. After a gap so long that
//! the phase is lost, a course branches into the roots of the next well-determined line. Courses of
//! negligible weight are dropped, and courses that have converged are merged.

use std::f64::consts::{LN_2, PI};

use num_complex::Complex64;

use super::anchor::Anchors;
use super::path::{Passage, Sight, State, WANDER};
use crate::median::median;

/// Maximum number of half waves in the range of phases in which courses begin; more cannot be
/// distinguished and would fill the memory.
const MOST_BEGINNINGS: f64 = 2e5;

/// Standard deviation of the phase \[rad\] above which a course branches into the roots of a line.
const LOST_PHASE: f64 = 0.7;
/// Distance of the farthest root into which a course branches, in standard deviations.
const REACH: f64 = 3.0;
/// Minimum distance of the roots of a well-determined line from the point where two of them meet,
/// in standard deviations of Ψ.
const WELL_DETERMINED: f64 = 6.0;
/// Initial standard deviation of the phase \[rad\] of a course that begins at a root; neighbouring
/// roots are farther away.
const INITIAL_SPREAD: f64 = 0.3;
/// Standard deviation of dγ/dω divided by γ/ω. The quotient differs from 1 only by dispersion; the
/// part of the dispersion given by causality is included separately: the phase velocity rises with
/// frequency where there is damping, dk/dω = (k - 2α/π)/ω for a constant loss factor.
const DISPERSION: f64 = 0.05;
/// Maximum relative standard deviation of the wave speed of a new course.
const MOST_SPREAD: f64 = 0.5;
/// Number of lines at which courses begin: more than one, because one may be an outlier.
const BEGINNINGS: usize = 3;
/// Minimum ratio of the frequencies of successive lines that are tried in the search for the first
/// line at which courses begin.
const SEARCH_RATIO: f64 = 1.02;
/// Log weight, relative to the best course, below which a course is dropped.
const NEGLIGIBLE: f64 = -23.0;
/// Maximum number of courses.
const MOST_COURSES: usize = 2048;
/// Maximum number of courses up to which pairs of courses are compared for merging.
const MOST_MERGED: usize = 64;
/// Distance below which courses are merged, in standard deviations of γ and dγ/dω.
const TOGETHER: f64 = 0.5;

/// Line of any record; the lines are in order of frequency.
#[derive(Clone, Copy)]
pub(super) struct LineAt<'a> {
    pub(super) omega: f64,
    /// True if nothing was observed. The courses pass such a line without an update, and their
    /// expectation at the line is stored.
    pub(super) missing: bool,
    pub(super) sight: Sight<'a>,
}

/// Course up to the present line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    pub(super) state: State,
    pub(super) log_weight: f64,
    /// Index of the [`Passage`] of the last line of the course.
    pub(super) last: Option<usize>,
}

/// Courses at the last line, with their history.
#[derive(Default)]
pub(super) struct Courses {
    /// Courses, best first, with normalised log weights.
    pub(super) alive: Vec<Course>,
    pub(super) passages: Vec<Passage>,
    /// True if at least one line determined its roots.
    pub(super) determined: bool,
    /// Probability of the courses that were dropped because of their number.
    pub(super) crowded_out: f64,
    scratch: Vec<Course>,
    roots: Vec<Complex64>,
    misfits: Vec<f64>,
}

impl Course {
    /// Returns the log weight, reduced if the course is now impossible: a growing wave, damping
    /// above the wave number (E' < 0), or a decreasing wave number.
    fn standing(&self) -> f64 {
        let State {
            gamma,
            slope,
            variance,
            slope_variance,
            ..
        } = self.state;
        let spread = (0.5 * variance).sqrt();
        let below = |value: f64, spread: f64| {
            let deviation = (value / spread).clamp(-8.0, 0.0);
            if deviation < 0.0 {
                -0.5 * deviation * deviation
            } else {
                0.0
            }
        };
        self.log_weight
            + below(gamma.re, spread)
            + below(gamma.im - gamma.re, 2.0 * spread)
            + below(slope.im, (0.5 * slope_variance).sqrt())
    }
}

impl LineAt<'_> {
    /// Returns the distance of a root from the point where it meets another root, relative to
    /// [`WELL_DETERMINED`] standard deviations of the noise; above 1, noise cannot exchange the two
    /// roots. The distance in Ψ is |Ψ'|²/(2|Ψ''|), limited to |Ψ'|, the change of Ψ per radian.
    fn determination_at(&self, root: Complex64) -> f64 {
        let [_, slope, curvature] = self.sight.observation.expand(root);
        let noise = WELL_DETERMINED * self.sight.variance.sqrt();
        let power = slope.norm_sqr();
        let distance = power / (2.0 * curvature.norm()).max(power.sqrt());
        distance / noise
    }

    /// Returns `determination_at` for the root with the lowest phase; 0 without a root.
    fn determination(&self) -> f64 {
        let mut first: Option<Complex64> = None;
        self.sight
            .observation
            .visit_roots(self.sight.observed, 0.0..PI, &mut |root| {
                if first.is_none_or(|first| root.im < first.im) {
                    first = Some(root);
                }
            });
        first.map_or(0.0, |root| self.determination_at(root))
    }
}

impl Courses {
    /// Follows all courses through the `lines`, of which there is at least one.
    pub(super) fn follow(&mut self, lines: &[LineAt<'_>], anchors: &Anchors<'_>) {
        self.alive.clear();
        self.passages.clear();
        self.passages.reserve(2 * lines.len());
        self.crowded_out = 0.0;
        self.begin(lines, anchors);
        let mut before_omega = None;
        let mut next_anchor = 0;
        for line in lines {
            let omega = line.omega;
            if let Some(before) = before_omega {
                next_anchor = self.weigh_anchors(anchors, next_anchor, before, omega);
                for course in &mut self.alive {
                    course.state.predict(before, omega - before);
                }
            }
            before_omega = Some(omega);
            self.pass(line);
            if self.alive.len() > 1 {
                self.give_up();
            }
        }
        if let Some(before) = before_omega {
            self.weigh_anchors(anchors, next_anchor, before, f64::INFINITY);
        }
        self.normalise();
    }

    /// Updates all courses with one line.
    fn pass(&mut self, line: &LineAt<'_>) {
        let sight = &line.sight;
        if line.missing {
            for course in &mut self.alive {
                let passage = course.state.skip(course.last);
                course.last = Some(self.passages.len());
                self.passages.push(passage);
            }
            return;
        }
        let scale = sight.length * sight.length;
        let limit = LOST_PHASE * LOST_PHASE / scale;
        if self
            .alive
            .iter()
            .all(|course| course.state.variance <= limit)
        {
            let compared = self.alive.len() > 1;
            for course in &mut self.alive {
                let (passage, density) = course.state.update(sight, course.last);
                if compared {
                    course.log_weight += density.ln();
                }
                course.last = Some(self.passages.len());
                self.passages.push(passage);
            }
            return;
        }
        self.scratch.clear();
        for course in &self.alive {
            let mut keep = |mut state: State, take: &dyn Fn(&mut State) -> (Passage, f64)| {
                let (passage, density) = take(&mut state);
                self.scratch.push(Course {
                    state,
                    log_weight: course.log_weight + density.ln(),
                    last: Some(self.passages.len()),
                });
                self.passages.push(passage);
            };
            if course.state.variance <= limit {
                keep(course.state, &|state| state.update(sight, course.last));
                continue;
            }
            let expected = course.state.gamma * sight.length;
            let reach = REACH * (course.state.variance * scale).sqrt();
            let phases = (expected.im - reach).max(0.0)..(expected.im + reach).max(0.0);
            self.roots.clear();
            // one root per half turn: a line with more roots than the maximum number of courses
            // does not distinguish them
            if reach.is_nan() || 2.0 * reach > PI * MOST_COURSES as f64 {
                keep(course.state, &|state| {
                    (state.skip(course.last), sight.stray_density())
                });
                continue;
            }
            sight
                .observation
                .visit_roots(sight.observed, phases, &mut |root| {
                    if (root - expected).norm_sqr() <= reach * reach
                        && line.determination_at(root) > 1.0
                    {
                        self.roots.push(root);
                    }
                });
            for root in &self.roots {
                keep(course.state, &|state| {
                    state.update_at(*root, sight, course.last)
                });
            }
            keep(course.state, &|state| {
                (state.skip(course.last), sight.stray_density())
            });
        }
        std::mem::swap(&mut self.alive, &mut self.scratch);
    }

    /// Starts courses at the first lines that determine their roots, or, if there is no such line,
    /// at the line with the highest `determination`.
    fn begin(&mut self, lines: &[LineAt<'_>], anchors: &Anchors<'_>) {
        let Some(first) = lines.first() else {
            return;
        };
        let usable = || lines.iter().filter(|line| !line.missing);
        // The transit time is assumed to be below half the length of the record to which the
        // closest lines belong: a wave number that advances by more than half a wave per line
        // cannot be distinguished from one that does not.
        let closest = usable()
            .zip(usable().skip(1))
            .map(|(a, b)| b.omega - a.omega)
            .filter(|step| *step > 0.0)
            .fold(f64::INFINITY, f64::min);
        let mut count = 0;
        let mut from = 0.0;
        let mut clearest: Option<(f64, &LineAt<'_>)> = None;
        for line in lines {
            if count == BEGINNINGS {
                break;
            }
            if line.missing || line.omega < from {
                continue;
            }
            let determination = line.determination();
            if determination >= 1.0 {
                self.begin_at(line, first.omega, PI / closest, anchors);
                count += 1;
            } else if count == 0 {
                from = line.omega * SEARCH_RATIO;
                if clearest.is_none_or(|(best, _)| determination > best) {
                    clearest = Some((determination, line));
                }
            }
        }
        self.determined = count > 0;
        if !self.determined
            && let Some((_, line)) = clearest
        {
            self.begin_at(line, first.omega, PI / closest, anchors);
        }
    }

    /// Adds courses from all roots of one line, extrapolated back to `first_omega`.
    fn begin_at(
        &mut self,
        line: &LineAt<'_>,
        first_omega: f64,
        greatest_transit: f64,
        anchors: &Anchors<'_>,
    ) {
        let LineAt { omega, sight, .. } = line;
        let length = sight.length;
        let highest = omega * greatest_transit.min(length / anchors.slowest);
        let lowest = omega * length / anchors.fastest;
        if (highest - lowest).is_nan() || highest - lowest > MOST_BEGINNINGS * PI {
            return; // no course: the lines remain undetermined
        }
        let down = (omega / first_omega).ln();
        let alive = &mut self.alive;
        sight
            .observation
            .visit_roots(sight.observed, lowest..highest, &mut |root| {
                let slowness = root / (length * omega);
                // from this line down to the first line the phase velocity decreases by causality,
                // and changes randomly
                let first = slowness + Complex64::new(0.0, 2.0 / PI * slowness.re.max(0.0) * down);
                let by_dispersion = DISPERSION * DISPERSION;
                let by_wander = WANDER * WANDER * down / 3.0;
                let relative = INITIAL_SPREAD * INITIAL_SPREAD / root.norm_sqr()
                    + (by_dispersion + by_wander) * down * down;
                let variance = first.norm_sqr() * relative.min(MOST_SPREAD * MOST_SPREAD);
                let state = State {
                    gamma: first * first_omega,
                    slope: first - Complex64::new(0.0, 2.0 / PI * first.re),
                    variance: variance * first_omega * first_omega,
                    covariance: variance * first_omega,
                    slope_variance: variance + by_dispersion * first.norm_sqr(),
                };
                // all decades of wave speed are equally probable
                let prior = anchors.log_prior_of_speed(first.im.recip()) - root.im.ln();
                alive.push(Course {
                    state,
                    log_weight: prior,
                    last: None,
                });
            });
    }

    /// Weights the courses by the known wave numbers between two frequencies; returns the next
    /// anchor.
    fn weigh_anchors(
        &mut self,
        anchors: &Anchors<'_>,
        next: usize,
        before: f64,
        omega: f64,
    ) -> usize {
        let mut next = next;
        while let Some(anchor) = anchors
            .known
            .get(next)
            .filter(|anchor| anchor.omega < omega)
        {
            for course in &mut self.alive {
                let mut state = course.state;
                state.predict(before, anchor.omega - before);
                course.log_weight += anchor.log_likelihood(&state);
            }
            next += 1;
        }
        next
    }

    fn give_up(&mut self) {
        let best = self
            .alive
            .iter()
            .map(Course::standing)
            .fold(f64::NEG_INFINITY, f64::max);
        self.alive
            .retain(|course| course.standing() >= best + NEGLIGIBLE);
        if self.alive.len() > 1 && self.alive.len() <= MOST_MERGED {
            self.merge();
        }
        if self.alive.len() > MOST_COURSES {
            self.alive
                .sort_by(|a, b| b.standing().total_cmp(&a.standing()));
            let weight = |course: &Course| (course.standing() - best).exp();
            let (kept, lost) = self.alive.split_at(MOST_COURSES);
            let lost: f64 = lost.iter().map(weight).sum();
            let kept: f64 = kept.iter().map(weight).sum();
            self.crowded_out += lost / (lost + kept);
            self.alive.truncate(MOST_COURSES);
        }
    }

    /// Merges courses that have converged; the history of the one with the larger weight is kept.
    fn merge(&mut self) {
        let mut this = 0;
        while this < self.alive.len() {
            let mut other = this + 1;
            while let (Some(a), Some(b)) = (self.alive.get(this), self.alive.get(other)) {
                let near = TOGETHER * TOGETHER;
                let together = (a.state.gamma - b.state.gamma).norm_sqr()
                    < near * a.state.variance.min(b.state.variance)
                    && (a.state.slope - b.state.slope).norm_sqr()
                        < near * a.state.slope_variance.min(b.state.slope_variance);
                if together {
                    let both = log_sum(a.log_weight, b.log_weight);
                    let (a, b) = (*a, *b);
                    let kept = if a.log_weight >= b.log_weight { a } else { b };
                    if let Some(course) = self.alive.get_mut(this) {
                        *course = Course {
                            log_weight: both,
                            ..kept
                        };
                    }
                    self.alive.swap_remove(other);
                } else {
                    other += 1;
                }
            }
            this += 1;
        }
    }

    /// Returns the number of lines on the best course, and the variance of their noise divided by
    /// the assumed one: the median of |misfit|² divided by its expectation, and by ln 2, the value
    /// of this median for normal noise. The median is insensitive to outliers.
    pub(super) fn excess(&mut self) -> (usize, f64) {
        self.misfits.clear();
        let mut passage = self.alive.first().and_then(|course| course.last);
        while let Some(this) = passage.and_then(|index| self.passages.get(index)) {
            self.misfits.extend(this.chi_square);
            passage = this.before;
        }
        let median = median(&mut self.misfits);
        (
            self.misfits.len(),
            median.map_or(1.0, |median| median / LN_2),
        )
    }

    fn normalise(&mut self) {
        for course in &mut self.alive {
            course.log_weight = course.standing();
        }
        self.alive
            .sort_by(|a, b| b.log_weight.total_cmp(&a.log_weight));
        let best = self.alive.first().map_or(0.0, |course| course.log_weight);
        let sum: f64 = self
            .alive
            .iter()
            .map(|course| (course.log_weight - best).exp())
            .sum();
        for course in &mut self.alive {
            course.log_weight -= best + sum.ln();
        }
    }
}

/// Returns ln(e^a + e^b).
fn log_sum(a: f64, b: f64) -> f64 {
    let (larger, smaller) = if a >= b { (a, b) } else { (b, a) };
    larger + (smaller - larger).exp().ln_1p()
}

#[cfg(test)]
pub(super) mod tests;
