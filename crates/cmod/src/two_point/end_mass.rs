//! Characteristic equation of a specimen with a mass at its free end, and three methods of
//! solution.

use num_complex::Complex64;

use crate::estimate::Termination;

/// Maximum number of Newton steps.
pub const MOST_NEWTON_STEPS: u32 = 50;

/// Maximum number of Newton steps at an intermediate mass ratio.
const NEWTON_STEPS_EACH: u32 = 5;

/// Limit of |f f''|/|f'|² up to which Newton's iteration converges to the nearest root. If f'' were
/// constant, the limit would be one half (Kantorovich); the margin allows for the change of f''
/// over the step.
const SURE_CONVERGENCE: f64 = 0.2;

/// Limit of |f f''|/|f'|² (Kantorovich) below which the root for an intermediate mass ratio is
/// accurate enough for the next step.
const NEAR_ENOUGH: f64 = 1e-4;

/// Smallest step in the mass ratio, as a fraction of the mass ratio.
const SMALLEST_PART: f64 = 1.0 / 1024.0;

/// Relative size of a Newton step below which the next step would be below rounding, because
/// convergence is quadratic.
const SMALLEST_STEP: f64 = 1e-12;

/// Characteristic equation f(γL) = cosh γL + μ γL sinh γL - Ψ = 0 (Ödeen 1993, paper A, eq. 1) at
/// one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndMassEquation {
    /// Ratio μ = m/(ρAL) of the mass of the accelerometer to the mass of the specimen.
    pub mass_ratio: f64,
    /// Ratio Ψ = â₁/â₂ of the impacted end to the free end.
    pub acceleration_ratio: Complex64,
}

/// Root of the characteristic equation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EndMassRoot {
    /// Root γL; not finite if the iteration diverged.
    pub gamma_length: Complex64,
    /// Termination of the iteration.
    pub termination: Termination,
    /// Number of steps in the mass ratio: more than one where another root is near.
    pub steps: u32,
    /// Mass ratio at which the continuation came so near to a double root that it may have left its
    /// branch; `None` if this did not happen.
    pub lost_at: Option<f64>,
}

impl EndMassRoot {
    pub(super) fn in_closed_form(gamma_length: Complex64) -> Self {
        Self {
            gamma_length,
            termination: Termination::ClosedForm,
            steps: 0,
            lost_at: None,
        }
    }
}

/// Derivatives of f at one γL.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slopes {
    /// First derivative f'(x), which is also dΨ/dx.
    pub(super) first: Complex64,
    /// Second derivative f''(x).
    pub(super) second: Complex64,
    /// Derivative ∂f/∂μ = x sinh x.
    pub(super) by_mass_ratio: Complex64,
}

/// Hyperbolic functions of one γL, from which f and its derivatives at any mass ratio follow
/// without further evaluations.
#[derive(Clone, Copy)]
struct Hyperbolic {
    x: Complex64,
    cosh: Complex64,
    sinh: Complex64,
}

/// Derivatives of a root with respect to the mass ratio, to second order.
struct Way {
    start: Complex64,
    velocity: Complex64,
    half_acceleration: Complex64,
}

impl Way {
    fn after(&self, step: f64) -> Complex64 {
        self.start + step * (self.velocity + step * self.half_acceleration)
    }

    /// Returns true if the second order of the step is at most half of the first order. In longer
    /// steps, the parabola may lead to any root, and its end may be near a wrong root.
    fn bends_little(&self, step: f64) -> bool {
        4.0 * step * step * self.half_acceleration.norm_sqr() <= self.velocity.norm_sqr()
    }
}

impl Hyperbolic {
    /// Computes the functions from one exponential, one sine and one cosine. The exponential minus
    /// 1 is used, so that a small α keeps its digits.
    fn of(x: Complex64) -> Self {
        let less_one = x.re.exp_m1();
        let exponential = less_one + 1.0;
        let sinh = 0.5 * (less_one + less_one / exponential);
        let cosh = 0.5 * (exponential + exponential.recip());
        let (sine, cosine) = x.im.sin_cos();
        Self {
            x,
            cosh: Complex64::new(cosh * cosine, sinh * sine),
            sinh: Complex64::new(sinh * cosine, cosh * sine),
        }
    }

    fn by_mass_ratio(&self) -> Complex64 {
        self.x * self.sinh
    }

    fn value(&self, equation: &EndMassEquation, mass_ratio: f64) -> Complex64 {
        self.cosh + mass_ratio * self.by_mass_ratio() - equation.acceleration_ratio
    }

    fn first(&self, mass_ratio: f64) -> Complex64 {
        self.sinh + mass_ratio * (self.sinh + self.x * self.cosh)
    }

    fn second(&self, mass_ratio: f64) -> Complex64 {
        self.cosh + mass_ratio * (2.0 * self.cosh + self.x * self.sinh)
    }

    /// Returns dx/dμ and d²x/dμ² of the root x at `mass_ratio`, from f(x, μ) = Ψ.
    fn way(&self, mass_ratio: f64) -> Way {
        let first = self.first(mass_ratio);
        let velocity = -self.by_mass_ratio() / first;
        let mixed = self.sinh + self.x * self.cosh;
        let bend = self.second(mass_ratio) * velocity + 2.0 * mixed;
        Way {
            start: self.x,
            velocity,
            half_acceleration: -0.5 * velocity * bend / first,
        }
    }

    /// Returns true if |f f''|/|f'|² is at most `limit`; false if it is NaN.
    fn is_near_root(&self, equation: &EndMassEquation, mass_ratio: f64, limit: f64) -> bool {
        let first = self.first(mass_ratio).norm_sqr();
        let second = self.second(mass_ratio).norm_sqr();
        self.value(equation, mass_ratio).norm_sqr() * second <= (limit * first).powi(2)
    }

    /// Returns the size of f that rounding alone can cause.
    fn rounding(&self, equation: &EndMassEquation) -> f64 {
        let size = |z: Complex64| z.re.abs() + z.im.abs();
        4.0 * f64::EPSILON
            * (size(self.cosh)
                + equation.mass_ratio * size(self.by_mass_ratio())
                + size(equation.acceleration_ratio))
    }
}

/// Coefficients of the series γL = x₀ + x₁μ + x₂μ² + x₃μ³ + ... (paper A, eqs. 6-7, times L).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassSeries {
    /// Coefficient x₀ = γ₀L, the root for μ = 0.
    pub zeroth: Complex64,
    /// Coefficient x₁ = -x₀.
    pub first: Complex64,
    /// Coefficient x₂ = x₀ [1 + ½ x₀ coth x₀].
    pub second: Complex64,
    /// Coefficient x₃ = -x₀ [1 + (3/2) x₀ coth x₀ + (1/3) x₀²].
    pub third: Complex64,
}

impl EndMassEquation {
    /// Returns f(γL).
    #[must_use]
    pub fn value(&self, gamma_length: Complex64) -> Complex64 {
        Hyperbolic::of(gamma_length).value(self, self.mass_ratio)
    }

    /// Returns f'(γL) = sinh γL + μ (sinh γL + γL cosh γL), which is also dΨ/d(γL).
    #[must_use]
    pub fn derivative(&self, gamma_length: Complex64) -> Complex64 {
        Hyperbolic::of(gamma_length).first(self.mass_ratio)
    }

    /// Returns f''(γL) = cosh γL + μ (2 cosh γL + γL sinh γL).
    #[must_use]
    pub fn second_derivative(&self, gamma_length: Complex64) -> Complex64 {
        Hyperbolic::of(gamma_length).second(self.mass_ratio)
    }

    pub(super) fn slopes(&self, gamma_length: Complex64) -> Slopes {
        let at = Hyperbolic::of(gamma_length);
        Slopes {
            first: at.first(self.mass_ratio),
            second: at.second(self.mass_ratio),
            by_mass_ratio: at.by_mass_ratio(),
        }
    }

    /// Runs Newton's iteration from `start`, as printed (paper A, eq. 5).
    ///
    /// At low losses the start γ₀L, which differs from the root by μγ₀L, may be beyond a zero of
    /// f', and the iteration then converges to the root of another branch.
    #[must_use]
    pub fn newton(&self, start: Complex64) -> EndMassRoot {
        self.newton_after(start, 0)
    }

    fn newton_after(&self, start: Complex64, already: u32) -> EndMassRoot {
        let ended = |at: &Hyperbolic, termination: fn(u32, f64) -> Termination, iterations| {
            let residual = at.value(self, self.mass_ratio).norm();
            EndMassRoot {
                gamma_length: at.x,
                termination: termination(iterations, residual),
                steps: 1,
                lost_at: None,
            }
        };
        let converged = |iterations, residual| Termination::Converged {
            iterations,
            residual,
        };
        let lost = |iterations, residual| Termination::LostPatience {
            iterations,
            residual,
        };
        let mut at = Hyperbolic::of(start);
        for iterations in already..already + MOST_NEWTON_STEPS {
            let value = at.value(self, self.mass_ratio);
            if value.norm_sqr() <= at.rounding(self).powi(2) {
                return ended(&at, converged, iterations);
            }
            let step = value / at.first(self.mass_ratio);
            at = Hyperbolic::of(at.x - step);
            if step.norm_sqr() <= SMALLEST_STEP * SMALLEST_STEP * at.x.norm_sqr() {
                return ended(&at, converged, iterations + 1);
            }
            if !at.x.is_finite() {
                break;
            }
        }
        ended(&at, lost, already + MOST_NEWTON_STEPS)
    }

    /// Follows the root from `free_end`, the root for μ = 0, by continuation in the mass ratio.
    ///
    /// The mass is increased in steps, and the root is followed on its branch. A step follows the
    /// parabola given by dx/dμ and d²x/dμ². The length of a step is limited by two conditions: its
    /// second order is at most half of its first order, and Newton's iteration surely finds the
    /// root, |f f''| <= |f'|²/5, from the end and from the middle of the step. In between, the
    /// parabola is nearer to the roots, so all these roots belong to one branch. Usually one step
    /// suffices; more steps are needed for many waves, and where two roots come near each other.
    /// Where two roots meet within 1/1024 of the mass, the root counts as
    /// [lost](EndMassRoot::lost_at).
    #[must_use]
    pub fn continuation(&self, free_end: Complex64) -> EndMassRoot {
        if self.mass_ratio == 0.0 {
            return EndMassRoot::in_closed_form(free_end);
        }
        let mut at = Hyperbolic::of(free_end);
        let mut reached = 0.0;
        let mut iterations = 0;
        let mut steps = 0;
        let mut lost_at = None;
        loop {
            steps += 1;
            let way = at.way(reached);
            let mut step = self.mass_ratio - reached;
            let mut end = Hyperbolic::of(way.after(step));
            loop {
                let middle = Hyperbolic::of(way.after(0.5 * step));
                if way.bends_little(step)
                    && end.is_near_root(self, reached + step, SURE_CONVERGENCE)
                    && middle.is_near_root(self, reached + 0.5 * step, SURE_CONVERGENCE)
                {
                    break;
                }
                if step <= SMALLEST_PART * self.mass_ratio {
                    lost_at = lost_at.or(Some(reached));
                    break;
                }
                step *= 0.5;
                end = middle;
            }
            at = end;
            reached += step;
            // the steps halve the remainder, so the last step ends at the mass ratio itself except
            // for rounding
            if self.mass_ratio - reached <= f64::EPSILON * self.mass_ratio {
                return EndMassRoot {
                    steps,
                    lost_at,
                    ..self.newton_after(at.x, iterations)
                };
            }
            for _ in 0..NEWTON_STEPS_EACH {
                if at.is_near_root(self, reached, NEAR_ENOUGH) {
                    break;
                }
                at = Hyperbolic::of(at.x - at.value(self, reached) / at.first(reached));
                iterations += 1;
            }
        }
    }
}

impl EndMassEquation {
    /// Continues from the root `free_end` for μ = 0. If the result differs from the root `tracked`
    /// along the lines, the tracked root is returned, because on a noisy line the path from μ = 0
    /// can pass on the wrong side of a point where two roots meet.
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
    /// Returns the coefficients for the root `free_end` γ₀L of a specimen without end mass (paper
    /// A, eq. 7).
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

    /// Returns γL from the first two terms.
    #[must_use]
    pub fn two_terms(&self, mass_ratio: f64) -> Complex64 {
        self.zeroth + self.first * mass_ratio
    }

    /// Returns γL from the first four terms.
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

    /// Compares equation 7 with finite differences of exact roots with respect to μ, by five-point
    /// central formulas at μ = 0 (Ödeen 1993, paper A, eqs. 6 and 7).
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
            // The terms of the series grow like (|x| / |sinh x|)^n; with this h their ratio is 1e-2
            // or less.
            let h = 1e-2 * free_end.sinh().norm() / (1.0 + free_end.norm()).powi(2);
            let [b, a, o, c, d] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|j| root(j * h));
            let first = (b - d + 8.0 * (c - a)) / (12.0 * h);
            let second = (16.0 * (a + c) - 30.0 * o - b - d) / (12.0 * h * h) / 2.0;
            let third = (d - b - 2.0 * (c - a)) / (2.0 * h * h * h) / 6.0;
            let series = MassSeries::about(free_end);
            // tolerance: the truncation errors are 1e-8, 1e-8 and 1e-4; the rounding errors are
            // 1e-14 divided by h, h² and h³
            assert!((first - series.first).norm() < 1e-7 * series.first.norm());
            assert!((second - series.second).norm() < 1e-5 * series.second.norm());
            assert!((third - series.third).norm() < 1e-2 * series.third.norm());
        }
    }

    /// The branch is followed even with heavy accelerometers, up to a mass equal to the mass of the
    /// specimen.
    #[test]
    fn continuation_follows_its_branch() {
        for mass_ratio in [0.0, 0.04, 0.2, 1.0] {
            for exact in roots() {
                let mut equation = EndMassEquation {
                    mass_ratio,
                    acceleration_ratio: Complex64::ZERO,
                };
                equation.acceleration_ratio = equation.value(exact);
                // the start is the root for μ = 0 that is connected with the exact root; it is
                // found by removing the mass in steps
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
                // tolerance: rounding divided by |f'| >= 0.05
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
