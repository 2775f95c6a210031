//! Moduli over time: relaxation after a step or a ramp of strain, and creep after a step or a ramp
//! of stress.
//!
//! A strain that rises in proportion to time up to ε₀ at t₁, and is then held, requires the stress
//! E(t) ε₀. A stress that rises in the same way up to σ₀, and is then held, causes the strain J(t)
//! σ₀, with
//!
//! ```text
//! E(t) = (1/2πi) ∫ e^{st} E(s)/s h(st₁) ds ,    J(t) = (1/2πi) ∫ e^{st} 1/(s E(s)) h(st₁) ds ,
//! h(y) = (1 - e^{-y})/y
//! ```
//!
//! Therefore every law that can be evaluated at complex s can also be evaluated over time, with its
//! derivatives. The integrals are computed by the midpoint rule on the cotangent contour of
//! Trefethen, Weideman & Schmelzer (*BIT* **46** (2006) 653), z = st = N (0.5017 θ cot 0.6407θ -
//! 0.6122 + 0.2645 iθ), whose error is 3.9^{-N}.
//!
//! A line over time has ω = 1/t, so the shift a_T of a temperature moves the line in the same way
//! as a frequency.

use std::f64::consts::PI;
use std::sync::LazyLock;

use num_complex::Complex64;

/// Number N of points of the contour; half of the points are the conjugates of the other half.
const POINTS: u32 = 24;
/// Largest fraction of the time taken by the ramp for which one contour suffices. Above this
/// fraction, e^{-st₁} grows too much on the contour, and the ramp is computed as the difference of
/// two ramps without end.
const SHORT_RAMP: f64 = 0.25;

/// Quantity that a line of data contains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Reading {
    /// Modulus E(iω) at an angular frequency.
    Oscillation,
    /// Relaxation modulus E(t) at t = 1/ω.
    Relaxation {
        /// Duration of the ramp of strain as a fraction of the time t.
        ramp: f64,
    },
    /// Creep modulus 1/J(t) at t = 1/ω.
    Creep {
        /// Duration of the ramp of stress as a fraction of the time t.
        ramp: f64,
    },
}

impl Reading {
    /// Returns the duration of the ramp as a fraction of the time t; 0 without a ramp.
    pub(super) fn ramp(&self) -> f64 {
        match self {
            Self::Oscillation => 0.0,
            Self::Relaxation { ramp } | Self::Creep { ramp } => *ramp,
        }
    }

    /// Returns true if both are the same quantity; the ramps may differ.
    pub(super) fn is_like(&self, other: Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(&other)
    }

    /// Returns the quantity that is linear in the springs of a law: relaxation in place of creep.
    pub(super) fn as_linear(self) -> Self {
        match self {
            Self::Creep { ramp } => Self::Relaxation { ramp },
            own => own,
        }
    }

    /// Returns true for a modulus over time.
    pub(super) fn is_real(&self) -> bool {
        !matches!(self, Self::Oscillation)
    }
}

/// Lines at which a law is evaluated.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lines<'a> {
    omega: &'a [f64],
    readings: &'a [Reading],
}

impl<'a> Lines<'a> {
    /// Creates lines from angular frequencies [rad/s], or inverse times [1/s], with the quantity of
    /// each.
    pub(super) fn new(omega: &'a [f64], readings: &'a [Reading]) -> Self {
        Self { omega, readings }
    }

    /// Creates lines over frequency from angular frequencies [rad/s].
    #[cfg(test)]
    pub(super) fn oscillating(omega: &'a [f64]) -> Self {
        let readings = &[];
        Self { omega, readings }
    }

    pub(super) fn len(self) -> usize {
        self.omega.len()
    }

    pub(super) fn iter(self) -> impl Iterator<Item = (f64, Reading)> + 'a {
        let readings = self.readings.iter().copied();
        let readings = readings.chain(std::iter::repeat(Reading::Oscillation));
        self.omega.iter().copied().zip(readings)
    }
}

/// Points z of the contour in the upper half plane, with 2 e^z z'(θ)/(iN): the factor 2 accounts
/// for the conjugate points.
static CONTOUR: LazyLock<Vec<(Complex64, Complex64)>> = LazyLock::new(|| {
    let n = f64::from(POINTS);
    let at = |k: u32| {
        let theta = f64::from(2 * k - 1) * PI / n;
        let (sin, cos) = (0.6407 * theta).sin_cos();
        let cot = cos / sin;
        let z = n * Complex64::new(0.5017 * theta * cot - 0.6122, 0.2645 * theta);
        let slope = 0.5017 * (cot - 0.6407 * theta / (sin * sin));
        let slope = n * Complex64::new(slope, 0.2645);
        (z, 2.0 * z.exp() * slope / Complex64::new(0.0, n))
    };
    (1..=POINTS / 2).map(at).collect()
});

/// Returns h(y) = (1 - e^{-y})/y.
fn mean_of_ramp(y: Complex64) -> Complex64 {
    if y.norm_sqr() < 1e-4 {
        // the next term, y⁵/720, is at most 1.4e-13
        1.0 - y / 2.0 * (1.0 - y / 3.0 * (1.0 - y / 4.0 * (1.0 - y / 5.0)))
    } else {
        (1.0 - (-y).exp()) / y
    }
}

/// Calls `with` for the points z and weights c of `Re Σ c Y(z/t)`, the response at t of a law Y to
/// a load that rises during the fraction `ramp` of t.
fn points(ramp: f64, mut with: impl FnMut(Complex64, Complex64)) {
    if ramp <= SHORT_RAMP {
        for (z, c) in CONTOUR.iter() {
            with(*z, c / z * mean_of_ramp(ramp * z));
        }
        return;
    }
    // a ramp without end, minus a ramp without end that begins when the first ramp should end
    let rest = 1.0 - ramp;
    for (z, c) in CONTOUR.iter() {
        let c = c / (z * z) / ramp;
        with(*z, c);
        with(z / rest, -rest * c);
    }
}

/// Returns the response of a law at one line; `None` if there is no law.
///
/// `at_s` returns E(s) and writes its derivatives with respect to the parameters; the derivatives
/// of the response are written to `gradient`. `scratch` has the length of `gradient`.
pub(super) fn respond(
    (omega, reading): (f64, Reading),
    gradient: &mut [Complex64],
    scratch: &mut [Complex64],
    mut at_s: impl FnMut(Complex64, &mut [Complex64]) -> Option<Complex64>,
) -> Option<Complex64> {
    let (ramp, creeps) = match reading {
        Reading::Oscillation => return at_s(Complex64::new(0.0, omega), gradient),
        Reading::Relaxation { ramp } => (ramp, false),
        Reading::Creep { ramp } => (ramp, true),
    };
    gradient.fill(Complex64::ZERO);
    let mut sum = 0.0;
    let mut is_law = true;
    points(ramp, |z, c| {
        let Some(modulus) = at_s(omega * z, scratch) else {
            is_law = false;
            return;
        };
        let by_modulus = if creeps {
            sum += (c / modulus).re;
            -c / (modulus * modulus)
        } else {
            sum += (c * modulus).re;
            c
        };
        for (total, own) in gradient.iter_mut().zip(&*scratch) {
            total.re += (by_modulus * own).re;
        }
    });
    if creeps {
        // the reciprocal of the compliance
        let square = sum * sum;
        for entry in gradient.iter_mut() {
            *entry = -*entry / square;
        }
        sum = sum.recip();
    }
    is_law.then(|| sum.into())
}

/// Returns the fraction of the modulus of a branch that remains under a constant strain, and the
/// derivative of this fraction with respect to ln τ. The time is `x` relaxation times, and the
/// strain rose during the fraction `ramp` of this time.
pub(super) fn left_of_branch(x: f64, ramp: f64) -> (f64, f64) {
    // at larger x the fraction is 0, and infinity times 0 would be NaN
    let x = x.min(1e4);
    if ramp <= 0.0 {
        let left = (-x).exp();
        return (left, x * left);
    }
    let y = ramp * x;
    let held = (ramp * x - x).exp();
    // h and its derivative with respect to ln y
    let mean = if y > 0.0 { -(-y).exp_m1() / y } else { 1.0 };
    let by_log = if y < 1e-3 {
        // the next term is y³/8
        -y / 2.0 + y * y / 3.0
    } else {
        (-y).exp() - mean
    };
    (held * mean, held * ((x - y) * mean - by_log))
}

#[cfg(test)]
mod tests {
    use rodwave::modulus::{
        DifferentiableModulus, FractionalMaxwell, FractionalZener, GeneralisedMaxwell,
        LaplaceModulus, MaxwellBranch, SpringPot, TimeDomainModulus, Zener,
    };

    use super::*;

    fn response(law: &dyn LaplaceModulus, time: f64, reading: Reading) -> f64 {
        let at_s = |s, _: &mut [Complex64]| Some(law.at_s(s));
        let found = respond((time.recip(), reading), &mut [], &mut [], at_s);
        found.unwrap().re
    }

    fn laws() -> Vec<Box<dyn TimeDomainModulus>> {
        let branches = [(1e9, 1e-2), (0.5e9, 1.0), (2e9, 30.0)];
        let branches = branches.map(|(modulus, relaxation_time)| MaxwellBranch {
            modulus,
            relaxation_time,
        });
        vec![
            Box::new(Zener::new(1e6, 2e9, 0.1).unwrap()),
            Box::new(FractionalZener::new(1e7, 2e9, 3.0, 0.35).unwrap()),
            Box::new(FractionalMaxwell::new(2e9, 3.0, 0.6).unwrap()),
            Box::new(SpringPot::new(2e9, 0.4, 7.0).unwrap()),
            Box::new(GeneralisedMaxwell::new(0.2e9, branches.to_vec()).unwrap()),
            Box::new(GeneralisedMaxwell::new(0.0, branches.to_vec()).unwrap()),
        ]
    }

    /// Computes the mean of `f` over the ramp, from t - t₁ to t, by the tanh-sinh rule, because
    /// some laws are infinite at 0.
    fn mean_over_ramp(time: f64, ramp: f64, f: impl Fn(f64) -> f64) -> f64 {
        let h = 1.0 / 64.0;
        (-256..=256)
            .map(|k| h * f64::from(k))
            .map(|u| {
                let inner = 0.5 * PI * u.sinh();
                // distance from the start of the ramp, without cancellation
                let share = (1.0 + (-2.0 * inner).exp()).recip();
                let weight = 0.25 * PI * u.cosh() / inner.cosh().powi(2);
                weight * h * f(time * (1.0 - ramp) + time * ramp * share)
            })
            .sum()
    }

    #[test]
    fn responses_to_a_step_are_the_closed_forms() {
        for (index, law) in laws().iter().enumerate() {
            for decade in -4..=4 {
                let time = 10f64.powi(decade);
                let exact = law.relaxation_modulus(time).unwrap();
                let found = response(law.as_ref(), time, Reading::Relaxation { ramp: 0.0 });
                // tolerance: 3.9^-24 = 7e-15 and rounding, relative to the modulus before
                // relaxation
                let scale = law.at(1.0 / time).norm();
                assert!(
                    (found - exact).abs() < 1e-12 * scale,
                    "{index} {time}: {found} {exact}"
                );
                let exact = law.creep_compliance(time).unwrap().recip();
                let found = response(law.as_ref(), time, Reading::Creep { ramp: 0.0 });
                // tolerance: the closed form of the softest solid is the difference of two numbers
                // that are 2000 times as large
                assert!(
                    (found / exact - 1.0).abs() < 1e-11,
                    "{index} {time}: {found} {exact}"
                );
            }
        }
    }

    #[test]
    fn responses_to_a_ramp_are_the_means_over_it() {
        for (index, law) in laws().iter().enumerate() {
            for ramp in [1e-6, 1e-2, 0.2, 0.3, 0.7, 0.99] {
                for time in [0.03, 1.0, 40.0] {
                    let relaxation = |t: f64| law.relaxation_modulus(t).unwrap();
                    let exact = mean_over_ramp(time, ramp, relaxation);
                    let found = response(law.as_ref(), time, Reading::Relaxation { ramp });
                    // tolerance: subtracting two ramps amplifies the error by a factor of four at
                    // most; a long ramp ends where the law is steep, and the rule for the mean then
                    // has an error of some 1e-11
                    let scale = exact.abs() + law.at(1.0 / time).norm();
                    assert!(
                        (found - exact).abs() < 1e-10 * scale,
                        "{index} {ramp} {time}: {found} {exact}"
                    );
                    let creep = |t: f64| law.creep_compliance(t).unwrap();
                    let exact = mean_over_ramp(time, ramp, creep).recip();
                    let found = response(law.as_ref(), time, Reading::Creep { ramp });
                    assert!(
                        (found / exact - 1.0).abs() < 1e-10,
                        "{index} {ramp} {time}: {found} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_is_left_of_a_branch_is_its_response() {
        let branch = [MaxwellBranch {
            modulus: 1.0,
            relaxation_time: 1.0,
        }];
        let law = GeneralisedMaxwell::new(0.0, branch.to_vec()).unwrap();
        for ramp in [0.0, 1e-9, 1e-3, 0.2, 0.9] {
            for time in [1e-5, 0.03, 1.0, 7.0] {
                let (left, slope) = left_of_branch(time, ramp);
                let reading = Reading::Relaxation { ramp };
                let exact = response(&law, time, reading);
                assert!((left - exact).abs() < 1e-11, "{ramp} {time} {left} {exact}");
                let mut gradient = [Complex64::ZERO; 2];
                let at_s = |s, row: &mut [Complex64]| law.gradient_at_s(s, row).ok();
                let scratch = &mut [Complex64::ZERO; 2];
                respond((time.recip(), reading), &mut gradient, scratch, at_s);
                // tolerance: the series for a short ramp has an error of 5e-10
                let error = (slope - gradient[1].re).abs();
                assert!(error < 1e-9, "{ramp} {time} {slope} {}", gradient[1].re);
                assert!((left - gradient[0].re).abs() < 1e-11);
            }
        }
    }
}
