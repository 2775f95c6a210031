//! Modulus at the resonances of a rod with one free end (Norris and Young; cited by Ödeen 1993,
//! paper A, as the origin of eq. 1).
//!
//! A rod is driven at one end and free at the other, and the accelerations of both ends are
//! compared at the frequencies at which they are a quarter of a period out of phase:
//!
//! ```text
//! Ψ = â₁/â₂ = cosh γL + μ γL sinh γL ,    Re Ψ(f_n) = 0 ,    n = 1, 2, ...
//! ```
//!
//! Without end mass kL = (n - ½)π and sinh αL = |Ψ|, so only a frequency and an amplitude must be
//! determined. With a mass the equation is solved for γ as in the two-point method.
//!
//! The crossings of Re Ψ are numbered by [`crate::branch`] and determined from a polynomial of
//! third degree through the lines within 0.3 rad in kL of the crossing. The polynomial averages the
//! noise of these lines; the truncation error of the polynomial, less than 5e-5/n of E, is the
//! model error of the method. Unlike the two-point method, this method gives no result between the
//! resonances.
//!
//! Theory: `docs/theory/neighbouring-methods.md#resonances`.

mod local_polynomial;

use std::f64::consts::{FRAC_PI_2, PI};

use num_complex::Complex64;

use crate::error::{CmodError, check_positive};
use crate::estimate::{Acceptance, Method, ModulusEstimate, Refusal, Termination, VarianceFreedom};
use crate::free_end::{EndSection, FreeEnd, RodWithFreeEnd};
use crate::multi_point::Quantity;
use crate::section_ratio::{
    self, MeasuredRatio, RatioAbout, RatioLines, RatioMethod, Root, Settings,
};
use crate::validity::Violation;
use local_polynomial::LocalPolynomial;

/// Distance from a resonance, in rad of kL, within which lines are used.
const HALF_WIDTH: f64 = 0.3;
/// Number of steps in which the end mass is increased.
const MASS_STEPS: u32 = 10;
/// Minimum number of lines: four for the coefficients, and three more to average the noise.
const FEWEST_LINES: usize = 7;

/// Method for the modulus at the resonances of a rod that is driven at one end.
///
/// ```
/// use cmod::{Resonances, RodWithFreeEnd};
/// use num_complex::Complex64;
///
/// // a rod of 0.8 m with c = 1700 m/s and a loss factor of 0.1
/// let frequency_hz: Vec<f64> = (1..=400).map(|j| 10.0 * f64::from(j)).collect();
/// let gamma = |f: f64| Complex64::new(0.05, 1.0) * (2.0 * std::f64::consts::PI * f / 1700.0);
/// let ratio: Vec<Complex64> = frequency_hz.iter().map(|&f| (0.8 * gamma(f)).cosh()).collect();
/// let rod = RodWithFreeEnd { diameter: 0.0106, density: 903.0, end_mass: 0.0 };
/// let estimate = Resonances::new(rod, 0.8)?.estimate(&frequency_hz, &ratio, &[1e-6; 400])?;
/// let resonances: Vec<f64> = estimate.valid().map(|line| line.frequency_hz).collect();
/// assert_eq!(resonances.len(), 4);
/// assert!((resonances[1] - 3.0 * 1700.0 / (4.0 * 0.8)).abs() < 0.1);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonances {
    rod: RodWithFreeEnd,
    length: f64,
    settings: Settings,
}

setters! { Resonances: uncertainty, limits }

impl Resonances {
    /// Creates the method for a rod of this `length` L \[m\].
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for impossible values of the rod, and unless the length is finite
    /// and above 0.
    pub fn new(rod: RodWithFreeEnd, length: f64) -> Result<Self, CmodError> {
        rod.check()?;
        check_positive("length [m]", length)?;
        Ok(Self {
            rod,
            length,
            settings: Settings::default(),
        })
    }

    estimate! {
        /// Returns the complex modulus at the resonances within the band, from the
        /// `acceleration_ratio` Ψ = â₁/â₂ of the driven to the free end and its `variance` E|δΨ|²,
        /// at the increasing frequencies `frequency_hz` \[Hz\].
        ///
        /// Each resonance is a line of the result, at the frequency of the resonance and with the
        /// index of the measured line that follows it. At least seven measured lines must be within
        /// 0.3 rad of the resonance in kL; otherwise the resonance is refused as
        /// [`Refusal::FewLinesAtResonance`]. The error of the polynomial at the resonance, from the
        /// variances of its lines, is propagated as in the two-point method:
        ///
        /// ```text
        /// E|δE|² = |2E/(γL f'(γL))|² E|δΨ|²
        /// ```
        ///
        /// # Errors
        /// [`CmodError::NoLines`], [`CmodError::LengthMismatch`], [`CmodError::Frequency`],
        /// [`CmodError::FrequencyOrder`], [`CmodError::NegativeVariance`].
        acceleration_ratio
    }

    /// Returns the method for the ratio of the accelerations of the two ends. The distance of the
    /// free end, 0, has no uncertainty.
    fn equation(&self, rod: RodWithFreeEnd) -> Result<FreeEnd, CmodError> {
        let [first, second] = [self.length, 0.0].map(|distance| EndSection {
            distance,
            quantity: Quantity::Acceleration,
        });
        FreeEnd::new(rod, first, second)?.with_uncertainty(self.settings.uncertainty)
    }

    /// Solves for the root, starting from the closed form without end mass and increasing the mass
    /// in [`MASS_STEPS`] steps.
    fn root(&self, crossing: &Crossing, resonance: &MeasuredRatio<'_>) -> Option<Root> {
        let sign = if crossing.order.is_multiple_of(2) {
            -1.0
        } else {
            1.0
        };
        let free_end = Complex64::new((sign * resonance.ratio.im).asinh(), crossing.phase());
        let mut root = Root {
            gamma: free_end / self.length,
            termination: Termination::ClosedForm,
        };
        let steps = if self.rod.end_mass > 0.0 {
            MASS_STEPS
        } else {
            0
        };
        for step in 1..=steps {
            let end_mass = self.rod.end_mass * f64::from(step) / f64::from(MASS_STEPS);
            let lighter = self
                .equation(RodWithFreeEnd {
                    end_mass,
                    ..self.rod
                })
                .ok()?;
            root = section_ratio::root(&lighter, resonance, root.gamma)?;
        }
        Some(root)
    }

    /// Returns all zeros of Re Ψ within the band, numbered by the branch of the closed form, where
    /// cosh αL cos kL = 0.
    fn crossings(&self, measured: &[MeasuredRatio<'_>]) -> Result<Vec<Crossing>, CmodError> {
        let mass_ratio = self.rod.length_of_end_mass() / self.length;
        let roots = section_ratio::branches(measured, self.length, mass_ratio)?;
        let mut found = Vec::new();
        for order in 1.. {
            let phase = (f64::from(order) - 0.5) * PI;
            if !roots.iter().any(|root| root.gamma_length.im > phase) {
                break;
            }
            let near = || {
                let lines = measured.iter().zip(&roots);
                lines.filter(|(_, root)| (root.gamma_length.im - phase).abs() < FRAC_PI_2)
            };
            // Noise moves single lines to the wrong side of the crossing. The crossing is placed
            // such that the number of lines before it equals the number of lines whose phase is
            // below the phase of the crossing.
            let below = near()
                .filter(|(_, root)| root.gamma_length.im < phase)
                .count();
            if below == 0 || below == near().count() {
                continue;
            }
            let (before, after) = (near().nth(below - 1), near().nth(below));
            let (Some((before, root)), Some((after, _))) = (before, after) else {
                continue;
            };
            found.push(Crossing {
                order,
                frequency_hz: 0.5 * (before.frequency_hz + after.frequency_hz),
                index: after.index,
                doubt: root.ambiguity().map(Violation::BranchAmbiguous),
            });
        }
        Ok(found)
    }
}

impl RatioMethod for Resonances {
    /// Returns the modulus at the resonances. The errors of each resonance have the degrees of
    /// freedom of the variances from which they are computed.
    fn estimate_ratio(&self, lines: &RatioLines<'_>) -> Result<ModulusEstimate, CmodError> {
        let limits = self.settings.limits;
        let mut estimate = ModulusEstimate::empty(Method("resonances"), limits);
        // lines that cannot be evaluated are omitted and not reported as refused, because they are
        // not resonances
        let measured = section_ratio::usable(lines, "ratio", &mut estimate.clone())?;
        let equation = self.equation(self.rod)?;
        for crossing in self.crossings(&measured)? {
            let at_resonance = crossing.read(&measured);
            let freedom = at_resonance.as_ref().ok().and_then(|one| one.freedom);
            let acceptance = Acceptance::of_line(limits, freedom)?;
            let line = at_resonance.and_then(|resonance| {
                let root = self.root(&crossing, &resonance).ok_or(Refusal::NoRoot)?;
                let doubts = crossing.doubt.into_iter().collect();
                section_ratio::solved(&equation, &resonance, root, doubts)?.into_line(&acceptance)
            });
            estimate.add(crossing.index, crossing.frequency_hz, line);
        }
        Ok(estimate)
    }

    fn has_all_lines(&self) -> bool {
        false
    }

    /// Returns `None`: a few resonances do not determine the ratio at the frequencies between them.
    fn ratio_about(&self, _frequency_hz: f64, _gamma: Complex64) -> Option<RatioAbout> {
        None
    }
}

/// Approximate zero of Re Ψ.
struct Crossing {
    /// Number n of the resonance, from 1.
    order: u32,
    frequency_hz: f64,
    /// Index of the measured line that follows the zero.
    index: usize,
    doubt: Option<Violation>,
}

impl Crossing {
    /// Returns kL without end mass, (n - ½)π.
    fn phase(&self) -> f64 {
        (f64::from(self.order) - 0.5) * PI
    }

    /// Returns the frequency at which Re Ψ = 0, with Ψ and its variance at this frequency, from a
    /// polynomial through the surrounding lines.
    fn read<'a>(&self, measured: &[MeasuredRatio<'a>]) -> Result<MeasuredRatio<'a>, Refusal> {
        let half_width = self.frequency_hz * HALF_WIDTH / self.phase();
        let within =
            |line: &&MeasuredRatio<'_>| (line.frequency_hz - self.frequency_hz).abs() <= half_width;
        let points: Vec<_> = measured.iter().filter(within).collect();
        if points.len() < FEWEST_LINES {
            return Err(Refusal::FewLinesAtResonance {
                found: points.len(),
                expected: FEWEST_LINES,
            });
        }
        // The weights are equal if there is no noise, and also if the variances are estimates,
        // because the weight of a line must not be random.
        let is_known = points
            .iter()
            .all(|line| line.variance > 0.0 && line.freedom.is_none());
        let weighted: Vec<_> = points
            .iter()
            .map(|line| {
                let abscissa = (line.frequency_hz - self.frequency_hz) / half_width;
                let weight = if is_known { line.variance.recip() } else { 1.0 };
                (abscissa, line.ratio, weight)
            })
            .collect();
        let polynomial = LocalPolynomial::through(weighted.iter().copied());
        let polynomial = polynomial.ok_or(Refusal::NoRoot)?;
        let abscissa = polynomial.zero_of_real_part().ok_or(Refusal::NoRoot)?;
        let (ratio, _) = polynomial.at(abscissa);
        let parts: Vec<f64> = points
            .iter()
            .zip(&weighted)
            .map(|(line, (at, _, weight))| {
                polynomial.influence(abscissa, *at, *weight).powi(2) * line.variance
            })
            .collect();
        Ok(MeasuredRatio {
            index: self.index,
            frequency_hz: self.frequency_hz + half_width * abscissa,
            ratio: Complex64::new(0.0, ratio.im),
            variance: parts.iter().sum(),
            freedom: freedom_of_sum(&points, &parts),
            coherence: None,
            common: points.first().map_or(&[], |line| line.common),
        })
    }
}

/// Returns the degrees of freedom of the sum of `parts` of the variance, one per point.
/// Neighbouring lines that share an estimate contribute only their own degrees of freedom, but the
/// sum has at least the degrees of freedom of a single line.
fn freedom_of_sum(points: &[&MeasuredRatio<'_>], parts: &[f64]) -> Option<VarianceFreedom> {
    let (mut squares, mut least) = (0.0, f64::INFINITY);
    for (point, part) in points.iter().zip(parts) {
        let freedom = point.freedom?;
        squares += part * part / freedom.own;
        least = least.min(freedom.line);
    }
    let sum: f64 = parts.iter().sum();
    let own = sum * sum / squares;
    // if all parts are 0 there is no noise
    let own = if own.is_finite() { own } else { least };
    Some(VarianceFreedom {
        line: own.max(least),
        own,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_rods_are_refused() {
        let rod = RodWithFreeEnd {
            diameter: 0.01,
            density: 900.0,
            end_mass: -1.0,
        };
        assert_eq!(
            Resonances::new(rod, 0.8).unwrap_err().to_string(),
            "mass on the free end [kg] is -1, expected a finite value, 0 or above"
        );
        let rod = RodWithFreeEnd {
            end_mass: 0.0,
            ..rod
        };
        assert_eq!(
            Resonances::new(rod, 0.0).unwrap_err().to_string(),
            "length [m] is 0, expected a finite value above 0"
        );
    }

    /// Resonances whose lines are too far apart for the polynomial are refused one by one, each
    /// with its frequency.
    #[test]
    fn coarse_lines_are_refused() {
        let rod = RodWithFreeEnd {
            diameter: 0.0106,
            density: 903.0,
            end_mass: 0.0,
        };
        let frequency_hz: Vec<f64> = (1..=40).map(|j| 100.0 * f64::from(j)).collect();
        let gamma = |f: f64| Complex64::new(0.05, 1.0) * (2.0 * PI * f / 1700.0);
        let ratio: Vec<_> = frequency_hz
            .iter()
            .map(|&f| (0.8 * gamma(f)).cosh())
            .collect();
        let method = Resonances::new(rod, 0.8).unwrap();
        let estimate = method.estimate(&frequency_hz, &ratio, &[1e-6; 40]).unwrap();
        assert!(estimate.lines().is_empty());
        assert_eq!(estimate.refused().len(), 4);
        assert!((estimate.refused()[0].frequency_hz - 531.25).abs() < 50.0);
    }
}
