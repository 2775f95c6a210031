//! Exact theory of an infinitely long cylinder, after Pochhammer and Chree: its first longitudinal
//! branch.

use num_complex::Complex64;

use crate::RodwaveError;
use crate::numerics::Jet;

use super::frequency_equation::{FrequencyEquation, Variable};
use super::theory::{CorrectedModulus, FirstBranch, RodTheory, Root, RoundRod, Scale};

/// Limit of |B| or |K| below which B/K = 1 - ½ν²K is exact to rounding: the next term of the series
/// is below 0.1 K².
const SERIES_END: f64 = 1e-8;

/// Value of √|K| or √|B| at which Newton's iteration starts from Love's theory: λ = 6D, where
/// Love's error is 0.1 per cent.
const FIRST_POINT: f64 = 0.5;

/// Largest step in √|K| or √|B|, so that no oscillation of the Bessel functions is missed.
const LARGEST_STEP: f64 = 0.5;

/// Smallest step, relative to the path; a branch that needs a smaller step cannot be separated in
/// double precision.
const SMALLEST_STEP: f64 = 1e-10;

/// Number of steps, successful or not, after which the search along the path ends: at about
/// ka = 85.
const MOST_STEPS: usize = 5000;

/// Largest step as a fraction of the clearance to other branches at the start of the step; at the
/// end of the step, twice this fraction is allowed.
const REACH: f64 = 0.2;

/// Largest correction of the prediction by Newton's iteration as a fraction of the clearance.
const CORRECTION_REACH: f64 = 0.1;

/// Relative tolerance of the K that a modulus gives on the first branch, compared with the K from
/// which the modulus was found. The K of other branches differ by far more.
const CLOSURE: f64 = 1e-6;

/// Largest number of Newton steps at one point. Within `CORRECTION_REACH` three or four suffice.
const MOST_NEWTON_STEPS: usize = 8;

/// Theory of Pochhammer and Chree, first longitudinal branch.
///
/// ```text
/// (2p/a)(q² + k²) J₁(pa) J₁(qa) - (q² - k²)² J₀(pa) J₁(qa) - 4k²pq J₁(pa) J₀(qa) = 0
/// p² = ρω²/(λ+2μ) - k² ,    q² = ρω²/μ - k² ,    k² = -γ²
/// ```
///
/// For long waves B/K = 1 - ½ν²K + O(K²) with B = ρω²a²/E, K = -γ²a²; for short waves in an elastic
/// rod the phase velocity is that of Rayleigh's surface wave.
///
/// # Method
/// The equation has infinitely many roots. The first branch begins as K = B and is *followed* from
/// there: ω is increased to its final value from a point where Love's theory is accurate, with E
/// constant. In the inverse direction, γ is increased with ω constant. Each step is predicted along
/// the tangent, corrected by Newton's iteration, and limited to a fraction of the distance to the
/// neighbouring branch. It then cannot jump to that branch where the two are close. The distance is
/// estimated by 2|f'/f''| in B and in K. For λ down to about 6D, one step suffices.
///
/// A modulus found from γ must give γ again on the first branch; otherwise the result is
/// [`FirstBranch::Left`].
///
/// # Validity
/// The theory is valid for λ from infinity to D/27 and for any loss. For ν = 0 the first branch is
/// elementary theory, which crosses the second branch at ka = 1.841; for small ν > 0 the two
/// branches veer apart there, and the loss of a nearly elastic modulus determines the course of the
/// first branch. If the course cannot be determined, the result is [`FirstBranch::Left`]. The same
/// applies beyond ka = 85, λ = D/27, where the path is too long.
///
/// The roots are branches of one analytic function. For short waves and high losses, two moduli may
/// have the same γ, each on its first branch; [`RodTheory::modulus`] then returns the one that is
/// reached when γ is scaled up from 0 to its value. This occurs for ν = -0.23, E''/E' = 0.52, λ =
/// 1.2D; for ν >= 0, λ > 2D and E''/E' <= 1 it was never found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PochhammerChree {
    scale: Scale,
    poisson_ratio: f64,
}

impl PochhammerChree {
    /// Creates a round rod.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless density and diameter are above 0 and -1 < ν <= 0.5.
    pub fn new(rod: RoundRod) -> Result<Self, RodwaveError> {
        let rod = rod.checked()?;
        Ok(Self {
            scale: rod.scale(),
            poisson_ratio: rod.poisson_ratio,
        })
    }
}

impl RodTheory for PochhammerChree {
    fn propagation_coefficient(
        &self,
        modulus: Complex64,
        omega: f64,
    ) -> Result<FirstBranch<Complex64>, RodwaveError> {
        self.scale.propagation_coefficient(modulus, omega, |bar| {
            Way {
                sought: Sought::Wave,
                poisson_ratio: self.poisson_ratio,
                end: bar,
            }
            .follow()
            .map(|root| root.value)
        })
    }

    fn modulus(
        &self,
        propagation_coefficient: Complex64,
        omega: f64,
    ) -> Result<FirstBranch<CorrectedModulus>, RodwaveError> {
        self.scale.modulus(propagation_coefficient, omega, |wave| {
            let outcome = Way {
                sought: Sought::Bar,
                poisson_ratio: self.poisson_ratio,
                end: wave,
            }
            .follow();
            let FirstBranch::Found(root) = outcome else {
                return outcome;
            };
            let back = Way {
                sought: Sought::Wave,
                poisson_ratio: self.poisson_ratio,
                end: root.value,
            };
            match back.follow() {
                FirstBranch::Found(back) if is_close(back.value, wave) => outcome,
                _ => FirstBranch::Left { reached: 1.0 },
            }
        })
    }
}

fn is_close(a: Complex64, b: Complex64) -> bool {
    (a - b).norm() <= CLOSURE * b.norm()
}

/// Unknown variable: B or K.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sought {
    Bar,
    Wave,
}

/// Path of the given variable from 0 to its end at t = 1, as t² `end`.
#[derive(Debug, Clone, Copy)]
struct Way {
    sought: Sought,
    poisson_ratio: f64,
    end: Complex64,
}

/// Distance to the second root of a function that begins as f'δ + ½f''δ².
fn clearance(jet: &Jet) -> f64 {
    2.0 * (jet.first / jet.second).norm()
}

/// A point on the branch.
#[derive(Debug, Clone, Copy)]
struct Point {
    given: Complex64,
    root: Complex64,
    /// Derivative d(root)/d(given) along the branch.
    tangent: Complex64,
    /// Derivative ∂(root)/∂ν.
    by_poisson_ratio: Complex64,
    /// Estimated distance to another branch at constant `given`.
    root_clearance: f64,
    /// Estimated distance to another branch at constant `root`; where another branch crosses, this
    /// is the smaller distance.
    given_clearance: f64,
}

impl Point {
    /// Returns the larger of the changes of the root and of the given variable, each relative to
    /// its clearance.
    fn reach(&self, root_change: Complex64, given_change: Complex64) -> f64 {
        let along_root = root_change.norm() / self.root_clearance;
        along_root.max(given_change.norm() / self.given_clearance)
    }
}

impl Way {
    fn follow(&self) -> FirstBranch<Root> {
        let size = self.end.norm();
        if size < SERIES_END || self.poisson_ratio == 0.0 {
            return FirstBranch::Found(self.long_wave_root());
        }
        let full = size.sqrt();
        let largest_step = LARGEST_STEP / full;
        let mut t = (FIRST_POINT / full).min(1.0);
        let given = self.end * t * t;
        let Some(mut point) = self.newton(given, self.love(given)) else {
            return FirstBranch::Left { reached: 0.0 };
        };
        let mut step = largest_step;
        for _ in 0..MOST_STEPS {
            if t >= 1.0 {
                return FirstBranch::Found(Root {
                    value: point.root,
                    by_poisson_ratio: point.by_poisson_ratio,
                });
            }
            if step < SMALLEST_STEP {
                break;
            }
            let next_t = (t + step).min(1.0);
            match self.advance(&point, self.end * next_t * next_t) {
                Some(next) => {
                    (t, point) = (next_t, next);
                    step = (2.0 * step).min(largest_step);
                }
                None => step *= 0.5,
            }
        }
        FirstBranch::Left { reached: t }
    }

    /// Advances one step along the branch; `None` if the step is too long to be safe.
    fn advance(&self, from: &Point, given: Complex64) -> Option<Point> {
        let given_change = given - from.given;
        let root_change = from.tangent * given_change;
        if from.reach(root_change, given_change) > REACH {
            return None;
        }
        let predicted = from.root + root_change;
        let next = self.newton(given, predicted)?;
        let correction = (next.root - predicted).norm();
        let is_safe = next.reach(root_change, given_change) <= 2.0 * REACH
            && correction <= CORRECTION_REACH * from.root_clearance.min(next.root_clearance);
        is_safe.then_some(next)
    }

    /// Newton's iteration for the root at one value of the given variable.
    fn newton(&self, given: Complex64, start: Complex64) -> Option<Point> {
        let (unknown, known) = match self.sought {
            Sought::Bar => (Variable::Bar, Variable::Wave),
            Sought::Wave => (Variable::Wave, Variable::Bar),
        };
        let mut root = start;
        let mut settled = false;
        for _ in 0..MOST_NEWTON_STEPS {
            let equation = match self.sought {
                Sought::Bar => FrequencyEquation::at(root, given, self.poisson_ratio),
                Sought::Wave => FrequencyEquation::at(given, root, self.poisson_ratio),
            }?;
            let jet = equation.along(unknown);
            let root_clearance = clearance(&jet);
            if settled {
                let by_given = equation.along(known);
                return Some(Point {
                    given,
                    root,
                    tangent: -by_given.first / jet.first,
                    by_poisson_ratio: -equation.along(Variable::PoissonRatio).first / jet.first,
                    root_clearance,
                    given_clearance: clearance(&by_given),
                });
            }
            let correction = jet.value / jet.first;
            if !(correction.re.is_finite() && correction.im.is_finite()) {
                return None;
            }
            root -= correction;
            // The remaining error is the squared correction over the clearance, which is below
            // rounding.
            settled = correction.norm() <= 1e-9 * root_clearance.min(root.norm());
        }
        None
    }

    /// Computes the root by Love's theory.
    fn love(&self, given: Complex64) -> Complex64 {
        let inertia = 0.5 * self.poisson_ratio.powi(2) * given;
        match self.sought {
            Sought::Bar => given / (1.0 + inertia),
            Sought::Wave => given / (1.0 - inertia),
        }
    }

    /// Computes the root to first order: elementary theory and Love's correction. The root is exact
    /// for ν = 0.
    fn long_wave_root(&self) -> Root {
        let sign = match self.sought {
            Sought::Bar => -1.0,
            Sought::Wave => 1.0,
        };
        Root {
            value: self.love(self.end),
            by_poisson_ratio: sign * self.poisson_ratio * self.end * self.end,
        }
    }
}
