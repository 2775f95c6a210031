//! The characteristic equation of a specimen with a mass at its free end, and three ways to solve it.

use num_complex::Complex64;

use crate::estimate::Termination;

/// Number of steps in the mass ratio, from 0 to its value, of the continuation.
pub const CONTINUATION_STEPS: u32 = 20;

/// Newton steps at each mass ratio of the continuation.
pub const NEWTON_STEPS_EACH: u32 = 4;

/// Newton steps after which the iteration is ended.
pub const MOST_NEWTON_STEPS: u32 = 50;

/// Relative size of a Newton step below which the next one would be lost in rounding: convergence is quadratic.
const SMALLEST_STEP: f64 = 1e-12;

/// f(γL) = cosh γL + μ γL sinh γL - Ψ = 0 (Ödeen 1993, paper A, eq. 1) at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndMassEquation {
    /// μ = m/(ρAL), mass of the accelerometer by mass of the specimen.
    pub mass_ratio: f64,
    /// Ψ = â₁/â₂, impacted end by free end.
    pub acceleration_ratio: Complex64,
}

/// A root of the characteristic equation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EndMassRoot {
    /// γL; not finite if the iteration ran away.
    pub gamma_length: Complex64,
    /// How the iteration ended.
    pub termination: Termination,
}

/// Coefficients of γL = x₀ + x₁μ + x₂μ² + x₃μ³ + ... (paper A, eqs. 6-7, times L).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassSeries {
    /// x₀ = γ₀L, the root for μ = 0.
    pub zeroth: Complex64,
    /// x₁ = -x₀.
    pub first: Complex64,
    /// x₂ = x₀ [1 + ½ x₀ coth x₀].
    pub second: Complex64,
    /// x₃ = -x₀ [1 + (3/2) x₀ coth x₀ + (1/3) x₀²].
    pub third: Complex64,
}

impl EndMassEquation {
    /// f(γL).
    #[must_use]
    pub fn value(&self, gamma_length: Complex64) -> Complex64 {
        gamma_length.cosh() + self.mass_ratio * gamma_length * gamma_length.sinh()
            - self.acceleration_ratio
    }

    /// f'(γL) = sinh γL + μ (sinh γL + γL cosh γL), which is also dΨ/d(γL).
    #[must_use]
    pub fn derivative(&self, gamma_length: Complex64) -> Complex64 {
        let sinh = gamma_length.sinh();
        sinh + self.mass_ratio * (sinh + gamma_length * gamma_length.cosh())
    }

    /// The size of f(γL) that rounding alone can give.
    fn rounding(&self, gamma_length: Complex64) -> f64 {
        4.0 * f64::EPSILON
            * (gamma_length.cosh().norm()
                + self.mass_ratio * (gamma_length * gamma_length.sinh()).norm()
                + self.acceleration_ratio.norm())
    }

    /// Newton's iteration from `start`, as printed (paper A, eq. 5).
    ///
    /// At low losses the start γ₀L, which is off by μγ₀L, may lie beyond a zero of f', and the iteration converges to the
    /// root of another branch.
    #[must_use]
    pub fn newton(&self, start: Complex64) -> EndMassRoot {
        self.newton_after(start, 0)
    }

    fn newton_after(&self, start: Complex64, already: u32) -> EndMassRoot {
        let mut gamma_length = start;
        for iterations in already..already + MOST_NEWTON_STEPS {
            let value = self.value(gamma_length);
            let step = value / self.derivative(gamma_length);
            let at_rounding = value.norm() <= self.rounding(gamma_length);
            if !at_rounding {
                gamma_length -= step;
            }
            if at_rounding || step.norm() <= SMALLEST_STEP * gamma_length.norm() {
                return EndMassRoot {
                    gamma_length,
                    termination: Termination::Converged {
                        iterations: iterations + u32::from(!at_rounding),
                        residual: self.value(gamma_length).norm(),
                    },
                };
            }
            if !gamma_length.is_finite() {
                break;
            }
        }
        EndMassRoot {
            gamma_length,
            termination: Termination::LostPatience {
                iterations: already + MOST_NEWTON_STEPS,
                residual: self.value(gamma_length).norm(),
            },
        }
    }

    /// Continuation in the mass ratio from the root `free_end` of μ = 0: [`CONTINUATION_STEPS`] steps, at each
    /// [`NEWTON_STEPS_EACH`] Newton steps, at the last as many as it takes.
    ///
    /// The mass is put on little by little, and the root follows on its branch: a step moves it by |γL| μ/20 only.
    #[must_use]
    pub fn continuation(&self, free_end: Complex64) -> EndMassRoot {
        if self.mass_ratio == 0.0 {
            return EndMassRoot {
                gamma_length: free_end,
                termination: Termination::ClosedForm,
            };
        }
        let mut gamma_length = free_end;
        for step in 1..CONTINUATION_STEPS {
            let lighter = Self {
                mass_ratio: self.mass_ratio * f64::from(step) / f64::from(CONTINUATION_STEPS),
                ..*self
            };
            for _ in 0..NEWTON_STEPS_EACH {
                gamma_length -= lighter.value(gamma_length) / lighter.derivative(gamma_length);
            }
        }
        self.newton_after(gamma_length, (CONTINUATION_STEPS - 1) * NEWTON_STEPS_EACH)
    }
}

impl EndMassEquation {
    /// The same, and if it ends elsewhere than at the root that was `tracked` along the lines, the tracked root: on a noisy line
    /// the way from μ = 0 can pass a point where two roots meet on the wrong side.
    pub(super) fn continuation_checked(
        &self,
        free_end: Complex64,
        tracked: Option<Complex64>,
    ) -> EndMassRoot {
        const SAME_ROOT: f64 = 1e-6;
        let root = self.continuation(free_end);
        match tracked {
            Some(tracked)
                if (root.gamma_length - tracked).norm() > SAME_ROOT * (1.0 + tracked.norm()) =>
            {
                self.newton(tracked)
            }
            _ => root,
        }
    }
}

impl MassSeries {
    /// The coefficients for the root `free_end` γ₀L of a specimen without end mass (paper A, eq. 7).
    #[must_use]
    pub fn about(free_end: Complex64) -> Self {
        let x = free_end;
        let x_coth = x * x.cosh() / x.sinh();
        Self {
            zeroth: x,
            first: -x,
            second: x * (1.0 + 0.5 * x_coth),
            third: -x * (1.0 + 1.5 * x_coth + x * x / 3.0),
        }
    }

    /// γL by the first two terms.
    #[must_use]
    pub fn two_terms(&self, mass_ratio: f64) -> Complex64 {
        self.zeroth + self.first * mass_ratio
    }

    /// γL by the first four terms.
    #[must_use]
    pub fn four_terms(&self, mass_ratio: f64) -> Complex64 {
        self.zeroth
            + mass_ratio * (self.first + mass_ratio * (self.second + mass_ratio * self.third))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roots() -> impl Iterator<Item = Complex64> {
        (0..40).map(|j| Complex64::new(0.05 + 0.03 * f64::from(j % 7), 0.4 + 0.37 * f64::from(j)))
    }

    #[test]
    fn derivative_is_that_of_the_value() {
        let equation = EndMassEquation {
            mass_ratio: 0.17,
            acceleration_ratio: Complex64::new(0.3, -2.0),
        };
        for x in roots() {
            let h = 1e-5;
            let difference = (equation.value(x + h) - equation.value(x - h)) / (2.0 * h);
            // Truncation |x| h²/6, rounding 1e-15/h: both below 1e-9.
            assert!((difference - equation.derivative(x)).norm() < 1e-9);
        }
    }

    /// Equation 7 against differences of exact roots in μ: five-point central formulas at μ = 0.
    #[test]
    fn series_has_the_derivatives_of_the_exact_root() {
        for free_end in roots() {
            let root = |mass_ratio: f64| {
                let equation = EndMassEquation {
                    mass_ratio,
                    acceleration_ratio: free_end.cosh(),
                };
                let root = equation.newton(free_end);
                assert!(root.termination.was_successful());
                root.gamma_length
            };
            // The terms of the series grow as (|x| / |sinh x|)^n: h keeps their ratio at 1e-2 or less.
            let h = 1e-2 * free_end.sinh().norm() / (1.0 + free_end.norm()).powi(2);
            let [b, a, o, c, d] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|j| root(j * h));
            let first = (b - d + 8.0 * (c - a)) / (12.0 * h);
            let second = (16.0 * (a + c) - 30.0 * o - b - d) / (12.0 * h * h) / 2.0;
            let third = (d - b - 2.0 * (c - a)) / (2.0 * h * h * h) / 6.0;
            let series = MassSeries::about(free_end);
            // Truncation 1e-8, 1e-8 and 1e-4; rounding of the roots 1e-14 over h, h² and h³.
            assert!((first - series.first).norm() < 1e-7 * series.first.norm());
            assert!((second - series.second).norm() < 1e-5 * series.second.norm());
            assert!((third - series.third).norm() < 1e-2 * series.third.norm());
        }
    }

    /// Heavy accelerometers too: as much as the specimen itself.
    #[test]
    fn continuation_follows_its_branch() {
        for mass_ratio in [0.0, 0.04, 0.2, 1.0] {
            for exact in roots() {
                let mut equation = EndMassEquation {
                    mass_ratio,
                    acceleration_ratio: Complex64::ZERO,
                };
                equation.acceleration_ratio = equation.value(exact);
                // the start: the root for μ = 0 that is connected with the exact one, found by taking the mass off
                let mut free_end = exact;
                for step in (0..400).rev() {
                    let lighter = EndMassEquation {
                        mass_ratio: mass_ratio * f64::from(step) / 400.0,
                        ..equation
                    };
                    free_end = lighter.newton(free_end).gamma_length;
                }
                let root = equation.continuation(free_end);
                assert!(root.termination.was_successful());
                // Rounding through |f'| >= 0.05.
                assert!((root.gamma_length - exact).norm() < 1e-12 * (1.0 + exact.norm()));
            }
        }
    }

    #[test]
    fn an_iteration_that_cannot_settle_says_so() {
        // f' = 0 at the start: the first step is infinite
        let equation = EndMassEquation {
            mass_ratio: 0.1,
            acceleration_ratio: Complex64::new(2.0, 1.0),
        };
        let root = equation.newton(Complex64::ZERO);
        assert!(!root.termination.was_successful());
        assert!(!root.gamma_length.is_finite());
    }
}
