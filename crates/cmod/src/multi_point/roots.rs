//! Roots of the equation of each line, that is, its propagation coefficients γ: each root with its
//! errors, another root near it, and the choice between the two.

use std::f64::consts::FRAC_PI_4;

use num_complex::Complex64;

use super::MOST_NOISE;
use super::fit::LineFit;
use super::follow::Expectation;
use super::line::SolvedLine;
use super::other_root::{LineOnCourse, Root, decide};
use super::projection::{Details, Minimum, Projection, TestWaves};
use super::spectra::{GaugeSpectra, WhiteLine};
use super::waves::LineOfWaves;
use crate::branch::BranchDoubt;
use crate::complex_frequency::ComplexFrequency;
use crate::estimate::{Refusal, Termination, VarianceFreedom};
use crate::validity::Violation;

/// Maximum distance of two roots of a line from the expected root, in radians over the distance
/// over which waves are counted. Farther roots are excluded by the tracking of the wave number
/// alone.
const NEAR: f64 = FRAC_PI_4;

/// Solution of a line at one of its roots.
pub(super) struct SolvedRoot {
    pub(super) line: SolvedLine,
    pub(super) fit: LineFit,
    pub(super) freedom: Option<VarianceFreedom>,
    pub(super) waves: Vec<TestWaves>,
    /// Termination of the iteration that found another root near this root, if there is one.
    other: Option<Termination>,
}

/// Search for the propagation coefficient γ of every line, in the order of frequency.
pub(super) struct RootSearch {
    pub(super) projection: Projection,
    /// Line that is being solved.
    pub(super) white: WhiteLine,
    pub(super) expectation: Expectation,
    /// Doubt about the wave speed of the first lines.
    pub(super) doubt: Option<BranchDoubt>,
    /// Added damping σ [1/s].
    pub(super) added_damping: f64,
    /// Degrees of freedom of chi-square, and the limit of chi-square.
    pub(super) degrees_of_freedom: usize,
    pub(super) most_misfit: f64,
    pub(super) noise_freedom: Option<VarianceFreedom>,
    /// True if the influence of each gauge on γ is needed.
    pub(super) needs_influence: bool,
}

impl RootSearch {
    /// Solves the line of this index and frequency \[Hz\] from the value expected from the previous
    /// lines, and looks for another root near the root found.
    pub(super) fn solve(
        &mut self,
        spectra: &GaugeSpectra<'_>,
        (index, frequency_hz): (usize, f64),
    ) -> Result<(SolvedRoot, LineOnCourse), Refusal> {
        self.white.load(spectra, index)?;
        let frequency = ComplexFrequency::new(frequency_hz, self.added_damping);
        let omega = frequency.omega();
        let expected = self.expectation.gamma(omega);
        let minimum = self.projection.minimise(expected, &self.white);
        let mut minimum = minimum.ok_or(Refusal::Undetermined)?;
        // γ and -γ describe the same pair of waves.
        if minimum.gamma.im < 0.0 {
            minimum.gamma = -minimum.gamma;
            minimum.evaluated_at = None;
        }
        let gamma = minimum.gamma;
        let doubt = self.expectation.doubt(omega, gamma);
        let (mut solved, details) =
            self.at_root((index, frequency), minimum, self.doubt.or(doubt))?;
        let is_reliable =
            minimum.termination.was_successful() && !doubt.is_some_and(|d| d.is_ambiguous());
        let mut course = LineOnCourse {
            omega,
            root: Root::at(gamma, &details.objective),
            other: None,
            is_reliable,
            variance: self.white.variance,
            power: self.white.power,
            degrees_of_freedom: self.degrees_of_freedom,
        };
        if is_reliable {
            if let Some((other, termination)) = self.other_root(expected, gamma, &details) {
                solved.other = Some(termination);
                course.other = Some(other);
            }
            // A line that two waves do not explain must not affect the following lines.
            let excess = solved
                .fit
                .chi_square
                .map_or(1.0, |chi| (chi / self.degrees_of_freedom as f64).max(1.0));
            let information = details.objective.information / excess;
            self.expectation.update(omega, gamma, information);
        }
        Ok((solved, course))
    }

    /// Returns another root near the root `gamma`, if there is one.
    fn other_root(
        &mut self,
        expected: Complex64,
        gamma: Complex64,
        details: &Details,
    ) -> Option<(Root, Termination)> {
        let mirrored = details.mirrored(gamma);
        let distance = self.expectation.distance();
        let is_near =
            |gamma: Complex64| (gamma - expected).norm() * distance < NEAR && gamma.im > 0.0;
        // the iteration may also return to the first root
        let is_distinct =
            |found: Complex64| (found - gamma).norm() > 0.25 * (mirrored - gamma).norm();
        if !is_near(mirrored) {
            return None;
        }
        let other = self.projection.minimise(mirrored, &self.white)?;
        let is_other =
            other.termination.was_successful() && is_near(other.gamma) && is_distinct(other.gamma);
        if !is_other {
            return None;
        }
        let objective = self.projection.evaluate(other.gamma, &self.white)?;
        Some((Root::at(other.gamma, &objective), other.termination))
    }

    /// Chooses between the two roots of each line that has two, by the lines before and after it. A
    /// line whose neighbours do not distinguish the roots is marked as doubtful.
    pub(super) fn choose(
        &mut self,
        spectra: &GaugeSpectra<'_>,
        roots: &mut [SolvedRoot],
        courses: &mut [LineOnCourse],
    ) {
        for decision in decide(courses, self.expectation.distance()) {
            let place = decision.place;
            let (Some(root), Some(course)) = (roots.get_mut(place), courses.get(place)) else {
                continue;
            };
            let line = &root.line;
            if decision.is_other && self.white.load(spectra, line.index).is_ok() {
                let minimum = Minimum {
                    gamma: course.root.gamma,
                    evaluated_at: None,
                    termination: root.other.unwrap_or(line.termination),
                };
                let other = self.at_root((line.index, line.frequency), minimum, self.doubt);
                if let Ok((other, _)) = other {
                    *root = other;
                }
            }
            let violations = &mut root.line.violations;
            let is_doubted = violations
                .iter()
                .any(|of| matches!(of, Violation::BranchAmbiguous(_)));
            if let Some(doubt) = decision.doubt.filter(|_| !is_doubted) {
                violations.insert(0, Violation::BranchAmbiguous(doubt));
            }
        }
    }

    /// Returns the line with its errors and its waves at a root.
    fn at_root(
        &mut self,
        (index, frequency): (usize, ComplexFrequency),
        Minimum {
            gamma,
            evaluated_at,
            termination,
        }: Minimum,
        doubt: Option<BranchDoubt>,
    ) -> Result<(SolvedRoot, Details), Refusal> {
        let (projection, white) = (&mut self.projection, &self.white);
        let (details, waves) = projection
            .details(gamma, evaluated_at, white)
            .ok_or(Refusal::Undetermined)?;
        let degrees_of_freedom = self.degrees_of_freedom;
        let chi_square = (white.variance > 0.0 && degrees_of_freedom > 0)
            .then_some(2.0 * details.objective.misfit);
        let influence = if self.needs_influence {
            projection
                .influence(gamma, white)
                .ok_or(Refusal::Undetermined)?
        } else {
            Vec::new()
        };
        let variance = white.variance / details.objective.information;
        let freedom = self.noise_freedom.map(|freedom| {
            let shares = projection.shares(gamma, white);
            shares.map_or(freedom, |shares| freedom.of_sum(shares.into_iter()))
        });
        let mut violations = Vec::new();
        violations.extend(doubt.map(Violation::BranchAmbiguous));
        if let Some(chi_square) = chi_square
            && chi_square > self.most_misfit
        {
            violations.push(Violation::Misfit {
                chi_square,
                degrees_of_freedom,
                limit: self.most_misfit,
            });
        }
        let noise_to_signal = white.noise_to_signal();
        if noise_to_signal > MOST_NOISE {
            violations.push(Violation::SignalTooWeak {
                noise_to_signal,
                limit: MOST_NOISE,
            });
        }
        let line = SolvedLine {
            index,
            frequency,
            gamma,
            variance,
            influence,
            curvature: details.curvature,
            amplification: (white.mean_power() / details.objective.information).sqrt(),
            closed_form: None,
            termination,
            violations,
        };
        let (forward, backward, shared) = details.waves_covariance;
        let fit = LineFit {
            propagation_variance: variance,
            chi_square,
            degrees_of_freedom,
            second_order: details.curvature * variance.sqrt(),
            waves: LineOfWaves {
                frequency,
                gamma,
                gamma_variance: variance,
                covariance: (
                    white.variance * forward,
                    white.variance * backward,
                    white.variance * shared,
                ),
            },
        };
        let solved = SolvedRoot {
            line,
            fit,
            freedom,
            waves,
            other: None,
        };
        Ok((solved, details))
    }
}
