//! Modulus from the ratio of two quantities of a rod, each of which is a known function of γ times
//! a common amplitude.
//!
//! If the boundary condition on one side of the sections is known, or if the waves in the two
//! directions have been separated, only one complex amplitude per line is unknown. It cancels in
//! the ratio of two measurements:
//!
//! ```text
//! Ψ = q̂₁/q̂₂ = f₁(γ)/f₂(γ) = g(γ)
//! ```
//!
//! where f₁ and f₂ are entire functions of γ. Methods such as [`FreeEnd`](crate::FreeEnd) and
//! [`OneGauge`](crate::OneGauge) differ only in f₁ and f₂. On each line Newton's iteration solves
//! f₁ - Ψf₂ = 0, starting at the γ/ω expected from the previous lines, and the first lines start
//! from one wave speed that explains all of them. The quantity that is followed from line to line
//! is γ itself, not the phase of Ψ, and lines with little information on γ have little weight.
//!
//! # Errors of the result
//! An error δΨ changes γ by δγ = δΨ/g'(γ), and the modulus by δE = -2E δγ/γ. With a circular error
//! of variance E|δΨ|² these errors are also circular. The second-order error of E is the fraction
//! ½|g''/g'² + 3/(γg')| σ of the first-order error, with σ² = E|δΨ|². A line is marked if this
//! fraction exceeds a tenth, as it does near a multiple of half a wave between two sections. The
//! systematic part of the error is due to the uncertainties of the rod and its sections,
//! [`SectionUncertainty`], and of the sensors, [`RatioError`].
//!
//! Theory: `docs/theory/neighbouring-methods.md#common-equation`.

mod calibration;
mod expectation;
pub(crate) mod ratio_error;
mod settings;
mod spectra;
mod start;

pub use ratio_error::RatioError;
pub use settings::SectionUncertainty;
pub(crate) use settings::{Changed, Settings};
pub use spectra::{RatioLines, RatioOfSpectra};

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use num_complex::Complex64;
use rodwave::numerics::Jet;

use crate::branch::{BranchDoubt, ResolvedRoot, resolve_lines};
use crate::complex_frequency::ComplexFrequency;
use crate::error::CmodError;
use crate::estimate::{
    Acceptance, ComplexCovariance, Method, ModulusEstimate, Refusal, Solution, SystematicShift,
    Termination, VarianceFreedom,
};
use crate::validity::{Violation, conditions};
use expectation::Expectation;
use rodwave::medium::modulus_from_propagation;

/// Maximum number of Newton steps.
const MOST_STEPS: u32 = 50;
/// Relative size of a Newton step below which the next step would be below rounding.
const SMALLEST_STEP: f64 = 1e-12;
/// Phase differences between the expected root and other starting points, which are tried if the
/// first iteration diverges or ends a quarter wave or more from the expected root.
const OTHER_STARTS: [f64; 4] = [-0.25 * PI, 0.25 * PI, -0.5 * PI, 0.5 * PI];

/// Equation g(γ) = f₁/f₂ of one arrangement of sections.
pub(crate) trait SectionRatio: Sized {
    const METHOD: Method;

    /// Returns f₁ and f₂ with their first two derivatives with respect to γ; common factors are
    /// omitted.
    fn jets(&self, gamma: Complex64, omega: f64) -> [Jet; 2];

    /// Returns the distance \[m\] over which half waves are counted. It is also the length L of
    /// condition (ii).
    fn distance(&self) -> f64;

    /// Returns the properties of the rod on which the ratio does not depend.
    fn rod(&self) -> RodOfRatio;

    /// Returns the settings: guess of the wave speed, uncertainties and limits.
    fn settings(&self) -> &Settings;

    /// Returns changed copies of the method: each uncertain quantity of the ratio is increased once
    /// and decreased once.
    fn changed(&self) -> Vec<Changed<Self>>;

    /// Returns the root of g(γ) = Ψ that is nearest to `expected`, if there is a closed form.
    fn closed_form(&self, _ratio: Complex64, _expected: Complex64) -> Option<Complex64> {
        None
    }
}

/// Method that determines the modulus from one measured ratio Ψ = g(γ) per line.
pub trait RatioMethod {
    /// Returns the complex modulus from a ratio with its variance and common errors.
    ///
    /// # Errors
    /// The errors of the method that implements the trait.
    fn estimate_ratio(&self, lines: &RatioLines<'_>) -> Result<ModulusEstimate, CmodError>;

    /// Returns true if the method gives a modulus at every line, and false if it gives moduli only
    /// at frequencies that it selects, such as resonances.
    fn has_all_lines(&self) -> bool;

    /// Returns Ψ of a rod with the propagation coefficient `gamma`, and its derivatives; `None` if
    /// a value is not finite, and for a method that does not have all lines.
    fn ratio_about(&self, frequency_hz: f64, gamma: Complex64) -> Option<RatioAbout>;

    /// Returns the method with the mass on the free end reduced by `size` of its standard
    /// uncertainties. Returns `None` if the mass has no uncertainty, or the reduced mass would be
    /// negative.
    fn without_error_of_mass(&self, _size: f64) -> Option<Box<dyn RatioMethod + '_>> {
        None
    }
}

/// Ratio and its derivatives at one γ.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RatioAbout {
    /// Ratio Ψ = g(γ).
    pub ratio: Complex64,
    /// Derivative dγ/dΨ [1/m].
    pub by_ratio: Complex64,
    /// Modulus E = -ρω²/γ² \[Pa\].
    pub modulus: Complex64,
    /// Shifts due to the uncertainties of the rod and its sections.
    pub shifts: Vec<SystematicShift>,
}

impl RatioAbout {
    pub(crate) fn finite(self) -> Option<Self> {
        let numbers = [self.ratio, self.by_ratio, self.modulus];
        numbers
            .iter()
            .all(|number| number.is_finite())
            .then_some(self)
    }
}

impl<T: SectionRatio> RatioMethod for T {
    fn estimate_ratio(&self, lines: &RatioLines<'_>) -> Result<ModulusEstimate, CmodError> {
        let settings = self.settings();
        let mut estimate = ModulusEstimate::empty(Self::METHOD, settings.limits);
        let measured = usable(lines, "ratio", &mut estimate)?;
        let Some(start) = start::wave_speed(self, &measured, settings) else {
            for line in &measured {
                estimate.add(line.index, line.frequency_hz, Err(Refusal::Undetermined));
            }
            return Ok(estimate);
        };
        let first = measured.first().map_or(0.0, MeasuredRatio::omega);
        let mut expectation =
            Expectation::new(start.slowness, self.distance(), first).with_delay(settings.delay);
        for line in &measured {
            let acceptance = Acceptance::of_line(settings.limits, line.freedom)?;
            let solved = solve(self, line, &mut expectation, start.doubt);
            let judged = solved.and_then(|solution| solution.into_line(&acceptance));
            estimate.add(line.index, line.frequency_hz, judged);
        }
        Ok(estimate)
    }

    fn has_all_lines(&self) -> bool {
        true
    }

    fn ratio_about(&self, frequency_hz: f64, gamma: Complex64) -> Option<RatioAbout> {
        let omega = TAU * frequency_hz;
        let RodOfRatio { density, .. } = self.rod();
        let modulus = modulus_from_propagation(gamma, omega, density).ok()?;
        let ratio = slope(self, gamma, omega);
        let relative_density = self.settings().uncertainty.density / density;
        RatioAbout {
            ratio: ratio.value,
            by_ratio: ratio.first.inv(),
            modulus,
            shifts: settings::shifts(self, (gamma, modulus), omega, relative_density),
        }
        .finite()
    }
}

/// Properties of a rod that affect the modulus and its validity, but not the ratios.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RodOfRatio {
    /// Diameter D \[m\].
    pub(crate) diameter: f64,
    /// Density ρ [kg/m³].
    pub(crate) density: f64,
}

/// Line that can be evaluated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasuredRatio<'a> {
    pub(crate) index: usize,
    pub(crate) frequency_hz: f64,
    pub(crate) ratio: Complex64,
    /// Variance E|δΨ|².
    pub(crate) variance: f64,
    /// Degrees of freedom of the variance, if the variance is an estimate.
    pub(crate) freedom: Option<VarianceFreedom>,
    pub(crate) coherence: Option<f64>,
    /// Errors of the ratios of all lines; the entry of this line is at `index`.
    pub(crate) common: &'a [RatioError],
}

impl MeasuredRatio<'_> {
    pub(crate) fn omega(&self) -> f64 {
        TAU * self.frequency_hz
    }

    /// Returns E|δΨ|² due to noise and sensor errors; it is used to count waves.
    pub(crate) fn whole_variance(&self) -> f64 {
        self.variance + ratio_error::variance(self.common, self.index, self.ratio)
    }
}

/// Returns the branch of each ratio of the accelerations of the two ends of a rod, with a mass of
/// `mass_ratio` times the mass of the rod on the free end. Without lines the list is empty. Waves
/// are counted where neither noise nor sensor errors prevent this.
pub(crate) fn branches(
    measured: &[MeasuredRatio<'_>],
    length: f64,
    mass_ratio: f64,
) -> Result<Vec<ResolvedRoot>, CmodError> {
    let line = |line: &MeasuredRatio<'_>| (line.frequency_hz, line.ratio, line.whole_variance());
    resolve_lines(length, mass_ratio, measured.iter().map(line))
}

/// Returns the lines that can be evaluated, and adds the other lines to the `estimate` as refused;
/// `name` is the name of the ratio.
pub(crate) fn usable<'a>(
    lines: &RatioLines<'a>,
    name: &'static str,
    estimate: &mut ModulusEstimate,
) -> Result<Vec<MeasuredRatio<'a>>, CmodError> {
    lines.check(name)?;
    let mut measured = Vec::with_capacity(lines.ratio.len());
    let values = lines.frequency_hz.iter().zip(lines.ratio);
    for (index, ((&frequency_hz, &ratio), &variance)) in values.zip(lines.variance).enumerate() {
        if frequency_hz == 0.0 {
            estimate.add(index, frequency_hz, Err(Refusal::ZeroFrequency));
        } else if !(ratio.is_finite() && variance.is_finite()) {
            estimate.add(index, frequency_hz, Err(Refusal::NotFinite));
        } else {
            measured.push(MeasuredRatio {
                index,
                frequency_hz,
                ratio,
                variance,
                freedom: lines.freedom_of(index),
                coherence: lines.coherence.and_then(|of| of.get(index).copied()),
                common: lines.common,
            });
        }
    }
    Ok(measured)
}

fn solve(
    equation: &impl SectionRatio,
    measured: &MeasuredRatio<'_>,
    expectation: &mut Expectation,
    start: Option<BranchDoubt>,
) -> Result<Solution, Refusal> {
    let omega = measured.omega();
    let expected = expectation.gamma(omega);
    let root = root(equation, measured, expected).ok_or(Refusal::NoRoot)?;
    let doubt = expectation.doubt(omega, root.gamma);
    let slope = slope(equation, root.gamma, omega);
    // If there is no noise, the variance is set to a small fraction of |Ψ|², whose size is
    // unimportant. The second term prevents a node in the numerator from having more weight than
    // its neighbours.
    let variance = if measured.variance > 0.0 {
        measured.variance
    } else {
        1e-6 * (measured.ratio.norm_sqr() + (slope.first / equation.distance()).norm_sqr())
    };
    if root.termination.was_successful() && doubt.is_none() {
        let information = slope.first.norm_sqr() / variance;
        expectation.update(omega, root.gamma, information);
    }
    let doubts = start.or(doubt).map(Violation::BranchAmbiguous);
    solved(equation, measured, root, doubts.into_iter().collect())
}

/// Returns g(γ) with its derivatives.
fn slope(equation: &impl SectionRatio, gamma: Complex64, omega: f64) -> Jet {
    let [first, second] = equation.jets(gamma, omega);
    first / second
}

/// Returns the result of a line for its root, with the errors.
pub(crate) fn solved(
    equation: &impl SectionRatio,
    measured: &MeasuredRatio<'_>,
    root: Root,
    violations: Vec<Violation>,
) -> Result<Solution, Refusal> {
    let (gamma, omega) = (root.gamma, measured.omega());
    let RodOfRatio { diameter, density } = equation.rod();
    let modulus = modulus_from_propagation(gamma, omega, density).map_err(|_| Refusal::NoRoot)?;
    let ratio = slope(equation, gamma, omega);
    let by_ratio = ratio.first.inv();
    let distance = equation.distance();
    let mut all = conditions(gamma, diameter, distance);
    all.extend(violations);
    let relative_density = equation.settings().uncertainty.density / density;
    let mut systematic = settings::shifts(equation, (gamma, modulus), omega, relative_density);
    systematic.extend(ratio_error::shifts(
        measured.common,
        measured.index,
        (gamma, modulus),
        (measured.ratio, by_ratio),
    ));
    let bend = 0.5 * (ratio.second * by_ratio * by_ratio + 3.0 * by_ratio / gamma).norm();
    Ok(Solution {
        index: measured.index,
        frequency: ComplexFrequency::on_axis(measured.frequency_hz),
        gamma,
        density,
        diameter,
        random: ComplexCovariance::circular(measured.variance * by_ratio.norm_sqr()),
        systematic,
        error_amplification: 2.0 * (by_ratio * measured.ratio / gamma).norm(),
        second_order: bend * measured.variance.sqrt(),
        distance,
        closed_form: None,
        termination: root.termination,
        violations: all,
    })
}

/// Root γ of f₁ - Ψf₂ = 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Root {
    pub(crate) gamma: Complex64,
    pub(crate) termination: Termination,
}

/// Returns the root nearest to the expected root.
pub(crate) fn root(
    equation: &impl SectionRatio,
    measured: &MeasuredRatio<'_>,
    expected: Complex64,
) -> Option<Root> {
    if let Some(gamma) = equation.closed_form(measured.ratio, expected) {
        return (gamma.is_finite() && gamma != Complex64::ZERO).then_some(Root {
            gamma,
            termination: Termination::ClosedForm,
        });
    }
    let distance = equation.distance();
    let away = |root: &Root| (root.gamma - expected).norm() * distance;
    let better = |a: Option<Root>, b: Option<Root>| {
        let rank = |root: &Root| (!root.termination.was_successful(), away(root));
        match (a, b) {
            (Some(a), Some(b)) => {
                let (first, second) = (rank(&a), rank(&b));
                let order = first.0.cmp(&second.0).then(first.1.total_cmp(&second.1));
                Some(if order.is_le() { a } else { b })
            }
            (a, b) => a.or(b),
        }
    };
    // Near g' = 0 there is a second root near the first, and the iteration may have converged to
    // either of them.
    let with_beside = |root: Root| {
        let [upper, lower] = equation.jets(root.gamma, measured.omega());
        let ratio = upper / lower;
        let beside = root.gamma - 2.0 * ratio.first / ratio.second;
        let is_near = (beside - expected).norm() * distance < FRAC_PI_2;
        let other = is_near
            .then(|| newton(equation, measured, beside))
            .flatten();
        better(Some(root), other)
    };
    let first = newton(equation, measured, expected).and_then(with_beside);
    if first.is_some_and(|root| root.termination.was_successful() && away(&root) < FRAC_PI_2) {
        return first;
    }
    OTHER_STARTS
        .iter()
        .map(|phase| expected + Complex64::new(0.0, phase / distance))
        .map(|start| newton(equation, measured, start).and_then(with_beside))
        .fold(first, better)
}

/// Runs Newton's iteration; returns `None` if it diverges to infinity or to γ = 0, where there is
/// no modulus.
///
/// f₁ - Ψf₂ has no poles, but if f₁ and f₂ vanish together, as for sections on a grid, it has a
/// root that does not depend on Ψ. If the iteration converges to this root, it is repeated on the
/// form f₁/f₂ - Ψ, which has no such root.
fn newton(
    equation: &impl SectionRatio,
    measured: &MeasuredRatio<'_>,
    start: Complex64,
) -> Option<Root> {
    iterate(equation, measured, start, Form::Entire)
        .filter(|root| is_root_of_ratio(equation, measured, root.gamma))
        .or_else(|| {
            iterate(equation, measured, start, Form::Quotient)
                .filter(|root| is_root_of_ratio(equation, measured, root.gamma))
        })
}

/// Returns true unless f₁ and f₂ vanish together at `gamma`, where g(γ) is 0/0.
fn is_root_of_ratio(
    equation: &impl SectionRatio,
    measured: &MeasuredRatio<'_>,
    gamma: Complex64,
) -> bool {
    let [first, second] = equation.jets(gamma, measured.omega());
    let size = (first.first.norm() + measured.ratio.norm() * second.first.norm()) * gamma.norm();
    let values = first.value.norm() + measured.ratio.norm() * second.value.norm();
    values > 1e-9 * size
}

/// Form of the equation that Newton's iteration solves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// f₁ - Ψf₂ = 0.
    Entire,
    /// f₁/f₂ - Ψ = 0.
    Quotient,
}

fn iterate(
    equation: &impl SectionRatio,
    measured: &MeasuredRatio<'_>,
    start: Complex64,
    form: Form,
) -> Option<Root> {
    let omega = measured.omega();
    let mut gamma = start;
    let mut residual = f64::INFINITY;
    for iterations in 1..=MOST_STEPS {
        let [first, second] = equation.jets(gamma, omega);
        let value = first.value - measured.ratio * second.value;
        let size = first.value.norm() + (measured.ratio * second.value).norm();
        let ratio = match form {
            Form::Entire => measured.ratio,
            Form::Quotient => first.value / second.value,
        };
        let step = value / (first.first - ratio * second.first);
        residual = value.norm() / size;
        if residual > 4.0 * f64::EPSILON {
            gamma -= step;
        }
        if !gamma.is_finite() || gamma == Complex64::ZERO {
            return None;
        }
        if residual <= 4.0 * f64::EPSILON || step.norm() <= SMALLEST_STEP * gamma.norm() {
            let [first, second] = equation.jets(gamma, omega);
            let (upper, lower) = (first.value, measured.ratio * second.value);
            let residual = (upper - lower).norm() / (upper.norm() + lower.norm());
            // If γ and -γ are both roots, the root of the forward wave is chosen.
            return Some(Root {
                gamma: if gamma.im < 0.0 && is_even(equation, gamma, omega) {
                    -gamma
                } else {
                    gamma
                },
                termination: Termination::Converged {
                    iterations,
                    residual,
                },
            });
        }
    }
    Some(Root {
        gamma,
        termination: Termination::LostPatience {
            iterations: MOST_STEPS,
            residual,
        },
    })
}

/// Returns true if g(-γ) = g(γ), except for rounding.
fn is_even(equation: &impl SectionRatio, gamma: Complex64, omega: f64) -> bool {
    let [a, b] = equation.jets(gamma, omega);
    let [c, d] = equation.jets(-gamma, omega);
    let (left, right) = (a.value * d.value, b.value * c.value);
    (left - right).norm() <= 1e-9 * (left.norm() + right.norm())
}
