//! Prony series that replace laws of other kinds, for time-domain solvers with fractional
//! materials.

use std::f64::consts::{LN_10, PI};

use num_complex::Complex64;

use super::{
    ConstantQ, FractionalZener, GeneralisedMaxwell, HavriliakNegami, LaplaceModulus, MaxwellBranch,
    SpringPot,
};
use crate::RodwaveError;
use crate::error::{check_finite, check_positive, check_that};

/// Purely relaxing law: analytic everywhere except on the negative real axis, where it has a cut.
///
/// # Requirements
/// `at_s` at s = -x + 0i, x > 0, is the value on the upper side of the cut, and its imaginary part
/// is not negative there. The law is then a sum of Maxwell models, one for each rate x (Stieltjes):
///
/// ```text
/// E(s) = E(0) + ∫ H(x) s/(s + x) dx/x ,    H(x) = Im E(-x + i0)/π >= 0
/// ```
pub trait CutPlaneModulus: LaplaceModulus {
    /// Relaxation spectrum H(x) \[Pa\] at the `rate` x = 1/τ [1/s], per unit of ln x.
    fn relaxation_spectrum(&self, rate: f64) -> f64 {
        self.at_s(Complex64::new(-rate, 0.0)).im / PI
    }
}

impl CutPlaneModulus for SpringPot {}
impl CutPlaneModulus for ConstantQ {}
impl CutPlaneModulus for FractionalZener {}
impl CutPlaneModulus for HavriliakNegami {}

/// Band of angular frequencies [rad/s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OmegaBand {
    /// Lower end, above 0.
    pub from: f64,
    /// Upper end, above `from`.
    pub to: f64,
}

/// A Prony series that approximates another law over a band, with its error.
///
/// ```
/// use rodwave::modulus::{ConstantQ, OmegaBand, PronyStandIn};
///
/// let polypropylene = ConstantQ::new(2.6e9, 0.07, 6283.0)?;
/// let band = OmegaBand { from: 200.0, to: 200e3 };
/// let stand_in = PronyStandIn::new(&polypropylene, band, 2.0)?;
/// // twelve branches reproduce the law to 1e-4 over the three decades
/// assert_eq!(stand_in.law().branches().len(), 12);
/// assert!(stand_in.greatest_error() < 1e-4);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PronyStandIn {
    law: GeneralisedMaxwell,
    band: OmegaBand,
    greatest_error: f64,
}

/// Decades of rates with individual branches beyond either end of the band.
const MARGIN_DECADES: f64 = 1.0;

/// Decades of rates beyond the margin that are combined into one branch on either side; rates
/// beyond these have an effect below 1e-8.
const TAIL_DECADES: f64 = 8.0;

/// Largest number of branches, including those of the tails. The error is computed at eight times
/// as many frequencies, which takes a time proportional to the square of the number.
const MOST_BRANCHES: f64 = 2e3;

impl PronyStandIn {
    /// Applies the trapezoidal rule over ln x with `branches_a_decade` nodes, and adds a spring
    /// that makes E' exact at the middle of `band`.
    ///
    /// The integrand has its nearest pole at s = -x, π/2 from the real axis of ln x, so the error
    /// of the rule is 2π H exp(-π²/h), where h is the step of ln x. For a loss factor of 0.07, the
    /// error is 5e-5 of the modulus with two branches per decade and 2e-7 with three. At either
    /// end, one branch combines the part of the spectrum that is more than a decade outside the
    /// band.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless 0 < from < to and the number of branches per decade is
    /// finite and at least 1/2; also if the spectrum of `law` is nowhere positive or the spring
    /// would be negative.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the number of branches is limited before the casts"
    )]
    pub fn new(
        law: &impl CutPlaneModulus,
        band: OmegaBand,
        branches_a_decade: f64,
    ) -> Result<Self, RodwaveError> {
        check_positive("lower end of the band [rad/s]", band.from)?;
        check_that(
            band.to.is_finite() && band.to > band.from,
            "upper end of the band [rad/s]",
            band.to,
            "a finite value above the lower end",
        )?;
        check_that(
            branches_a_decade.is_finite() && branches_a_decade >= 0.5,
            "branches per decade",
            branches_a_decade,
            "a finite value of 0.5 or more",
        )?;
        let decades = (band.to / band.from).log10() + 2.0 * MARGIN_DECADES;
        let count = (decades * branches_a_decade).round().max(1.0);
        let reach = (TAIL_DECADES * branches_a_decade).ceil();
        check_that(
            count + reach <= MOST_BRANCHES,
            "number of branches over the band and its tails",
            count + reach,
            "at most 2000",
        )?;
        let step = decades * LN_10 / count;
        let count = count as i32;
        let lowest = band.from.ln() - MARGIN_DECADES * LN_10;
        let node = |j: i32| {
            let rate = (lowest + (f64::from(j) + 0.5) * step).exp();
            (rate, step * law.relaxation_spectrum(rate))
        };
        // sums of H x^p over the nodes of one tail: with s/(s + x) expanded for rates far above or
        // far below |s|, one branch that matches two of these sums has an error of third order
        let tail = |nodes: &mut dyn Iterator<Item = i32>, first: i32, second: i32| {
            let (mut one, mut two) = (0.0, 0.0);
            for (rate, modulus) in nodes.map(node) {
                one += modulus * rate.powi(first);
                two += modulus * rate.powi(second);
            }
            (one, two)
        };
        let reach = (TAIL_DECADES * LN_10 / step).ceil() as i32;
        // rates below the band: s/(s + x) = 1 - x/s + x²/s²; the 1 belongs to the spring
        let (slow, slower) = tail(&mut (-reach..0), 1, 2);
        // rates above the band: s/(s + x) = s/x - s²/x²
        let (fast, faster) = tail(&mut (count..count + reach), -1, -2);
        let branches: Vec<MaxwellBranch> = std::iter::once((slower / slow, slow * slow / slower))
            .chain((0..count).map(node))
            .chain(std::iter::once((fast / faster, fast * fast / faster)))
            // where the spectrum underflows at an end, no branch is needed
            .filter(|(rate, modulus)| rate.is_finite() && *modulus > 0.0)
            .map(|(rate, modulus)| MaxwellBranch {
                modulus,
                relaxation_time: 1.0 / rate,
            })
            .collect();
        let middle = (band.from * band.to).sqrt();
        let wanted = law.try_at_s(Complex64::new(0.0, middle))?.re;
        let of_branches: f64 = branches
            .iter()
            .map(|branch| {
                let phase = middle * branch.relaxation_time;
                branch.modulus * phase * phase / (1.0 + phase * phase)
            })
            .sum();
        let spring = wanted - of_branches;
        check_that(
            spring >= 0.0,
            "spring modulus left by the branches in the middle of the band [Pa]",
            spring,
            "0 or more; use more branches per decade",
        )?;
        let stand_in = GeneralisedMaxwell::new(spring, branches)?;
        let points = 8 * count;
        let greatest_error = (0..=points)
            .map(|j| {
                let omega =
                    band.from * (band.to / band.from).powf(f64::from(j) / f64::from(points));
                let s = Complex64::new(0.0, omega);
                (stand_in.at_s(s) / law.at_s(s) - 1.0).norm()
            })
            // `f64::max` would drop a NaN
            .fold(
                0.0,
                |greatest, error| {
                    if error <= greatest { greatest } else { error }
                },
            );
        check_finite("greatest relative error of the stand-in", greatest_error)?;
        Ok(Self {
            law: stand_in,
            band,
            greatest_error,
        })
    }

    /// The series.
    #[must_use]
    pub fn law(&self) -> &GeneralisedMaxwell {
        &self.law
    }

    /// The band in which the series approximates the other law.
    #[must_use]
    pub fn band(&self) -> OmegaBand {
        self.band
    }

    /// Greatest |E_series/E - 1| in the band, computed at eight points per branch.
    #[must_use]
    pub fn greatest_error(&self) -> f64 {
        self.greatest_error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::modulus::ComplexModulus;

    const BAND: OmegaBand = OmegaBand {
        from: 300.0,
        to: 3e5,
    };

    /// Compares the spectrum of a power law with its closed form, E₀ ω₀^{-a} x^a sin(πa)/π.
    #[test]
    fn spectrum_of_a_power_law_is_the_known_one() {
        let exponent = 0.3;
        let law = SpringPot::new(2e9, exponent, 1e3).unwrap();
        for rate in [1.0_f64, 1e3, 1e7] {
            let exact = 2e9 * (rate / 1e3).powf(exponent) * (PI * exponent).sin() / PI;
            assert!((law.relaxation_spectrum(rate) / exact - 1.0).abs() < 1e-13);
        }
    }

    /// Checks that, over many decades, the branches add up to E₁ - E₀, the integral of the
    /// spectrum.
    #[test]
    fn branches_of_a_fractional_zener_law_add_up_to_what_relaxes() {
        let law = FractionalZener::new(1e9, 3e9, 1e-4, 0.6).unwrap();
        let wide = OmegaBand {
            from: 1e-10,
            to: 1e18,
        };
        let series = PronyStandIn::new(&law, wide, 3.0).unwrap();
        let sum: f64 = series.law().branches().iter().map(|b| b.modulus).sum();
        // tolerance: the trapezoidal rule with three branches per decade changes the sum by 1.2e-7;
        // the rates more than 14 decades from 1/τ contribute about 10^{-0.6 × 14} = 4e-9
        assert!((sum / 2e9 - 1.0).abs() < 1e-6, "{sum:e}");
        assert!((series.law().equilibrium_modulus() / 1e9 - 1.0).abs() < 1e-6);
        // tolerance: the error is below 2π H exp(-π²/h), with H at most 0.3 of E here
        assert!(series.greatest_error() < 1e-5);
    }

    #[test]
    fn the_error_is_that_of_the_trapezoidal_rule() {
        let law = ConstantQ::new(2.6e9, 0.1, 6e3).unwrap();
        let error = |n| PronyStandIn::new(&law, BAND, n).unwrap().greatest_error();
        let (one, two) = (error(1.0), error(2.0));
        // relative error 2π H exp(-π²/h) with H = 0.0634 of the modulus; the number of branches is
        // rounded, and the branches that combine the ends add some error
        let predicted = |h: f64| 2.0 * PI * 0.0634 * (-PI * PI / h).exp();
        assert!((one / predicted(LN_10) - 1.0).abs() < 0.3, "{one:e}");
        assert!((two / predicted(0.5 * LN_10) - 1.0).abs() < 0.3, "{two:e}");
        for omega in [BAND.from, 3e4, BAND.to] {
            let series = PronyStandIn::new(&law, BAND, 2.0).unwrap();
            let modulus = series.law().at(omega);
            assert!((modulus.im / modulus.re / 0.1 - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn bands_and_densities_without_meaning_are_refused() {
        let law = ConstantQ::new(2.6e9, 0.1, 6e3).unwrap();
        let refused = |from, to, n| {
            PronyStandIn::new(&law, OmegaBand { from, to }, n)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            refused(0.0, 1.0, 2.0),
            "lower end of the band [rad/s] is 0, expected a finite value above 0"
        );
        assert_eq!(
            refused(2.0, 1.0, 2.0),
            "upper end of the band [rad/s] is 1, expected a finite value above the lower end"
        );
        assert_eq!(
            refused(1.0, 2.0, f64::NAN),
            "branches per decade is NaN, expected a finite value of 0.5 or more"
        );
    }
}
