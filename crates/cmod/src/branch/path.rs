//! One course of γ(ω) through the lines: prediction, update and smoothing.
//!
//! The state consists of γ and dγ/dω. dγ/dω varies by [`WANDER`] of its size per e-fold of
//! frequency; this is the only assumption about the material. Errors are assumed circular: equal in
//! α and k and uncorrelated, so that one real 2 × 2 covariance matrix serves both. The filter is a
//! Kalman filter linearised at the prediction, with the second order of Ψ as additional noise. At a
//! multiple of π, where Ψ' = 0, a line then has no weight and cannot mislead the filter.

use num_complex::Complex64;

use super::observation::PhaseObservation;

/// Standard deviation of the relative change of dγ/dω per e-fold of frequency. A loss factor tan δ
/// changes dk/dω by about 0.3 tan δ, and lateral inertia changes it by 0.2 where the wavelength is
/// five diameters.
pub(super) const WANDER: f64 = 0.15;

/// Value of |δΨ|²/E|δΨ|² above which a line counts as an outlier; noise alone exceeds it once in
/// 8000 lines.
pub(super) const BAD_LINE: f64 = 9.0;

/// Probability that a line is independent of γ (`STRAY`), and the squared range of Ψ in which such
/// a line lies, divided by 1 + |Ψ|² (`STRAY_VARIANCE`).
const STRAY: f64 = 0.01;
const STRAY_VARIANCE: f64 = 4.0;

/// State γ and dγ/dω of a course, with its covariance matrix: E|δγ|², the covariance of γ and
/// dγ/dω, and the variance of dγ/dω.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub(super) gamma: Complex64,
    pub(super) slope: Complex64,
    pub(super) variance: f64,
    pub(super) covariance: f64,
    pub(super) slope_variance: f64,
}

/// Measured line, as the input of the filter.
#[derive(Clone, Copy)]
pub(super) struct Sight<'a> {
    pub(super) observation: &'a dyn PhaseObservation,
    pub(super) length: f64,
    pub(super) observed: Complex64,
    pub(super) variance: f64,
}

/// Data of one filter step, as needed for smoothing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passage {
    /// Index of the passage of the previous line in the list of all passages.
    pub(super) before: Option<usize>,
    /// Predicted γ, its variance and its covariance with the slope.
    gamma: Complex64,
    variance: f64,
    covariance: f64,
    /// Fraction of the misfit assigned to γ, and the corresponding factor for the slope.
    gain: f64,
    slope_gain: f64,
    /// Information of the line on γ, and the gradient of half its chi-square.
    information: f64,
    gradient: Complex64,
    /// |misfit|² divided by its expectation; `None` for a skipped line.
    pub(super) chi_square: Option<f64>,
}

impl Sight<'_> {
    /// Returns the probability density of an outlier, times its probability and π.
    pub(super) fn stray_density(&self) -> f64 {
        STRAY / (STRAY_VARIANCE * (1.0 + self.observed.norm_sqr()))
    }
}

impl State {
    /// Predicts the state at a frequency higher or, with a negative `step`, lower than `omega`.
    pub(super) fn predict(&mut self, omega: f64, step: f64) {
        let way = step.abs();
        // the lower end of the step, where an e-fold of frequency is shortest; a step from 0 counts
        // as one e-fold
        let from = omega.min(omega + step).max(way);
        let rate = WANDER * WANDER * self.slope.norm_sqr() / from;
        self.gamma += self.slope * step;
        self.variance += step * (2.0 * self.covariance + step * self.slope_variance)
            + rate * way * way * way / 3.0;
        self.covariance += step * self.slope_variance + 0.5 * rate * step * way;
        self.slope_variance += rate * way;
    }

    /// Updates the state with a line; returns the data for smoothing and the probability density of
    /// the line, times π.
    pub(super) fn update(&mut self, sight: &Sight<'_>, before: Option<usize>) -> (Passage, f64) {
        let [value, slope, curvature] = sight.observation.expand(self.gamma * sight.length);
        let phase_variance = self.variance * sight.length * sight.length;
        // E|δx²/2|² = (E|δx|²)²/2 for a circular δx
        let bend = 0.5 * curvature.norm_sqr() * phase_variance * phase_variance;
        let (passage, density) = self.absorb(
            sight.observed - value,
            slope * sight.length,
            sight.variance + bend,
            before,
        );
        (passage, (1.0 - STRAY) * density + sight.stray_density())
    }

    /// Updates the state with a line whose ratio is linearised at one of its roots.
    pub(super) fn update_at(
        &mut self,
        root: Complex64,
        sight: &Sight<'_>,
        before: Option<usize>,
    ) -> (Passage, f64) {
        let [_, slope, _] = sight.observation.expand(root);
        let misfit = slope * (root - self.gamma * sight.length);
        let (passage, density) = self.absorb(misfit, slope * sight.length, sight.variance, before);
        (passage, (1.0 - STRAY) * density)
    }

    /// Passes a line without information.
    pub(super) fn skip(&mut self, before: Option<usize>) -> Passage {
        Passage {
            before,
            gamma: self.gamma,
            variance: self.variance,
            covariance: self.covariance,
            gain: 0.0,
            slope_gain: 0.0,
            information: 0.0,
            gradient: Complex64::ZERO,
            chi_square: None,
        }
    }

    /// Performs one step of the filter; the returned density is the probability density of the
    /// misfit, times π.
    fn absorb(
        &mut self,
        misfit: Complex64,
        sensitivity: Complex64,
        noise: f64,
        before: Option<usize>,
    ) -> (Passage, f64) {
        let power = sensitivity.norm_sqr();
        let expected = power * self.variance + noise;
        let chi_square = misfit.norm_sqr() / expected;
        let density = (-chi_square).exp() / expected;
        // The variance of an outlier is increased so that its misfit is exactly at the limit.
        let expected = expected * (chi_square / BAD_LINE).max(1.0);
        let information = power / expected;
        let gradient = sensitivity.conj() * misfit / expected;
        let passage = Passage {
            before,
            gamma: self.gamma,
            variance: self.variance,
            covariance: self.covariance,
            gain: self.variance * information,
            slope_gain: self.covariance * information,
            information,
            gradient,
            chi_square: Some(chi_square),
        };
        self.gamma += self.variance * gradient;
        self.slope += self.covariance * gradient;
        self.slope_variance -= self.covariance * passage.slope_gain;
        self.covariance -= self.covariance * passage.gain;
        self.variance -= self.variance * passage.gain;
        (passage, density)
    }
}

/// Sums of the backward recursion of Bryson and Frazier: gradient and curvature of the chi-square
/// of all later lines with respect to γ and dγ/dω at the present line.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Backward {
    gradient: [Complex64; 2],
    curvature: [f64; 3],
}

/// Smoothed γ of a line, given all lines, and its variance E|δγ|².
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Smoothed {
    pub(super) gamma: Complex64,
    pub(super) variance: f64,
}

impl Backward {
    /// Passes a line downwards in frequency.
    pub(super) fn pass(&mut self, line: &Passage) -> Smoothed {
        let keep = 1.0 - line.gain;
        let [g, s] = self.gradient;
        let [gg, gs, ss] = self.curvature;
        let mixed = keep * gs - line.slope_gain * ss;
        let gradient = keep * g - line.slope_gain * s - line.gradient;
        let curvature =
            line.information + keep * (keep * gg - line.slope_gain * gs) - line.slope_gain * mixed;
        self.gradient = [gradient, s];
        self.curvature = [curvature, mixed, ss];
        Smoothed {
            gamma: line.gamma - line.variance * gradient - line.covariance * s,
            variance: line.variance
                - line.variance * (line.variance * curvature + 2.0 * line.covariance * mixed)
                - line.covariance * line.covariance * ss,
        }
    }

    /// Moves to the previous line, at a frequency lower by `step`.
    pub(super) fn step_down(&mut self, step: f64) {
        let [g, s] = self.gradient;
        let [gg, gs, ss] = self.curvature;
        self.gradient = [g, s + step * g];
        self.curvature = [gg, gs + step * gg, ss + step * (2.0 * gs + step * gg)];
    }
}

#[cfg(test)]
mod tests {
    use faer::linalg::solvers::Solve as _;
    use faer::{Mat, Side};

    use super::*;
    use crate::branch::observation::FreeEnd;

    /// Observation Ψ = x, for which the filter is exact and identical to least squares.
    struct Linear;

    impl PhaseObservation for Linear {
        fn expand(&self, x: Complex64) -> [Complex64; 3] {
            [x, Complex64::ONE, Complex64::ZERO]
        }

        fn visit_roots(
            &self,
            observed: Complex64,
            _phases: std::ops::Range<f64>,
            visit: &mut dyn FnMut(Complex64),
        ) {
            visit(observed);
        }
    }

    /// Compares forward and backward recursion with the normal equations of all lines together,
    /// which are solved by elimination.
    ///
    /// The unknowns are γ and its slope on every line. The prediction couples neighbouring lines
    /// with the inverse of the process covariance. The rate of this covariance is taken from the
    /// filter, where it depends on the slope found so far.
    #[test]
    fn smoothing_is_least_squares_over_all_lines() {
        const N: usize = 6;
        let omega: [f64; N] = [10.0, 11.0, 13.0, 13.5, 16.0, 20.0];
        let observed: [f64; N] = [1.02, 1.09, 1.33, 1.31, 1.66, 1.95];
        let noise = 1e-3;
        let start = State {
            gamma: Complex64::new(1.0, 0.3),
            slope: Complex64::new(0.1, 0.0),
            variance: 0.04,
            covariance: 1e-3,
            slope_variance: 4e-4,
        };
        let mut normal = vec![vec![0.0; 2 * N]; 2 * N];
        let mut right = [0.0; 2 * N];
        let mut add = |rows: &[(usize, f64)], value: f64, weight: f64| {
            for (i, a) in rows {
                right[*i] += weight * a * value;
                for (j, b) in rows {
                    normal[*i][*j] += weight * a * b;
                }
            }
        };
        // prior: inverse of its covariance, by its Cholesky factor
        let l11 = start.variance.sqrt();
        let l21 = start.covariance / l11;
        let l22 = (start.slope_variance - l21 * l21).sqrt();
        add(&[(0, 1.0 / l11)], start.gamma.re / l11, 1.0);
        add(
            &[(0, -l21 / (l11 * l22)), (1, 1.0 / l22)],
            (start.slope.re - l21 / l11 * start.gamma.re) / l22,
            1.0,
        );
        let mut state = start;
        let mut passages = Vec::new();
        for index in 0..N {
            if index > 0 {
                let step = omega[index] - omega[index - 1];
                let rate = WANDER * WANDER * state.slope.norm_sqr() / omega[index - 1].max(step);
                let (q11, q12, q22) = (
                    rate * step.powi(3) / 3.0,
                    rate * step * step / 2.0,
                    rate * step,
                );
                let (m11, m21) = (q11.sqrt(), q12 / q11.sqrt());
                let m22 = (q22 - m21 * m21).sqrt();
                let (i, j) = (2 * index - 2, 2 * index);
                let gamma = [(j, 1.0), (i, -1.0), (i + 1, -step)];
                let slope = [(j + 1, 1.0), (i + 1, -1.0)];
                add(&gamma.map(|(k, a)| (k, a / m11)), 0.0, 1.0);
                let mut mixed = Vec::new();
                mixed.extend(slope.map(|(k, a)| (k, a / m22)));
                mixed.extend(gamma.map(|(k, a)| (k, -a * m21 / (m11 * m22))));
                add(&mixed, 0.0, 1.0);
                state.predict(omega[index - 1], step);
            }
            add(&[(2 * index, 1.0)], observed[index], 1.0 / noise);
            let sight = Sight {
                observation: &Linear,
                length: 1.0,
                observed: Complex64::new(observed[index], 0.3),
                variance: noise,
            };
            passages.push(state.update(&sight, None).0);
        }
        let mut backward = Backward::default();
        let mut smoothed = Vec::new();
        for index in (0..N).rev() {
            smoothed.push(backward.pass(&passages[index]));
            if index > 0 {
                backward.step_down(omega[index] - omega[index - 1]);
            }
        }
        smoothed.reverse();
        let factor = Mat::from_fn(2 * N, 2 * N, |i, j| normal[i][j]).llt(Side::Lower);
        let covariance = factor.unwrap().solve(Mat::<f64>::identity(2 * N, 2 * N));
        for (index, smoothed) in smoothed.iter().enumerate() {
            let row = 2 * index;
            let solution: f64 = (0..2 * N).map(|k| covariance[(row, k)] * right[k]).sum();
            // The tolerances allow for rounding: the weights of the process noise are 1e6 times
            // those of the lines.
            assert!((smoothed.gamma.re - solution).abs() < 1e-8);
            assert!((smoothed.variance / covariance[(row, row)] - 1.0).abs() < 1e-6);
        }
    }

    /// Returns a state that is not at a root, and a line whose Ψ has the second derivative of a
    /// cosine.
    fn uncertain() -> (State, Sight<'static>) {
        let state = State {
            gamma: Complex64::new(0.1, 0.9),
            slope: Complex64::new(0.0, 1e-3),
            variance: 0.004,
            covariance: 1e-6,
            slope_variance: 1e-9,
        };
        let sight = Sight {
            observation: &FreeEnd,
            length: 2.0,
            observed: Complex64::new(-0.1, 0.3),
            variance: 0.01,
        };
        (state, sight)
    }

    #[test]
    fn a_line_is_as_probable_as_its_misfit_or_as_a_stray_one() {
        let (state, sight) = uncertain();
        let [value, slope, curvature] = FreeEnd.expand(state.gamma * 2.0);
        // E|δx|² is 0.016; the second order adds half of its square times |Ψ''|²
        let expected = slope.norm_sqr() * 0.016 + 0.01 + 0.5 * curvature.norm_sqr() * 0.016 * 0.016;
        let chi_square = (sight.observed - value).norm_sqr() / expected;
        let stray = 0.01 / (4.0 * (1.0 + 0.1));
        let mut updated = state;
        let (passage, density) = updated.update(&sight, None);
        assert!((passage.chi_square.unwrap() / chi_square - 1.0).abs() < 1e-12);
        let by_hand = 0.99 * (-chi_square).exp() / expected + stray;
        assert!(
            (density / by_hand - 1.0).abs() < 1e-12,
            "{density} {by_hand}"
        );
        assert!((sight.stray_density() / stray - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_line_at_a_root_is_linear_there() {
        let (state, sight) = uncertain();
        let mut root = None;
        FreeEnd.visit_roots(sight.observed, 0.0..3.0, &mut |found| root = Some(found));
        let root = root.unwrap();
        let [_, slope, _] = FreeEnd.expand(root);
        // variance of the misfit Ψ' δx: the error of γ, as a variance of Ψ, and the noise
        let expected = slope.norm_sqr() * 4.0 * 0.004 + 0.01;
        let misfit = slope * (root - 2.0 * state.gamma);
        let chi_square = misfit.norm_sqr() / expected;
        let mut updated = state;
        let (passage, density) = updated.update_at(root, &sight, None);
        assert!((passage.chi_square.unwrap() / chi_square - 1.0).abs() < 1e-12);
        let by_hand = 0.99 * (-chi_square).exp() / expected;
        assert!((density / by_hand - 1.0).abs() < 1e-12);
        // γ moves towards the root by the fraction of the misfit assigned to γ
        let moved = state.variance * (slope * 2.0).conj() * misfit / expected;
        assert!((updated.gamma - state.gamma - moved).norm() < 1e-12);
    }
}
