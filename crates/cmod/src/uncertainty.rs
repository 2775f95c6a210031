//! Uncertainty of a line: random errors, systematic errors that are common to all lines, and the
//! total.

mod coverage;

use std::f64::consts::TAU;
use std::fmt;
use std::ops::Add;

use num_complex::Complex64;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use crate::error::CmodError;

pub(crate) use coverage::PROBABILITY_WITHIN;
pub use coverage::coverage_factor;

/// Covariance of the real and the imaginary part of a complex quantity, in the square of the unit
/// of the quantity.
///
/// ```
/// use cmod::estimate::ComplexCovariance;
/// use num_complex::Complex64;
///
/// // multiplication by a complex factor does not give an error a preferred phase
/// let covariance = ComplexCovariance::circular(2.0).through(Complex64::new(0.0, 3.0));
/// assert_eq!(covariance, ComplexCovariance { real: 9.0, imaginary: 9.0, mixed: 0.0 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ComplexCovariance {
    /// Variance of the real part.
    pub real: f64,
    /// Variance of the imaginary part.
    pub imaginary: f64,
    /// Covariance of the real and the imaginary part.
    pub mixed: f64,
}

impl ComplexCovariance {
    /// Returns the covariance of an error δz without preferred phase with E|δz|² = `mean_square`.
    /// Each part has half of it, and the parts are uncorrelated.
    #[must_use]
    pub fn circular(mean_square: f64) -> Self {
        Self {
            real: 0.5 * mean_square,
            imaginary: 0.5 * mean_square,
            mixed: 0.0,
        }
    }

    /// Returns the covariance of an error δz = `shift` · ξ with one real ξ of variance 1. The real
    /// and the imaginary part are fully correlated.
    #[must_use]
    pub fn of_shift(shift: Complex64) -> Self {
        Self {
            real: shift.re * shift.re,
            imaginary: shift.im * shift.im,
            mixed: shift.re * shift.im,
        }
    }

    /// Returns the covariance from independent standard errors of the two parts.
    #[must_use]
    pub fn of_parts(real: f64, imaginary: f64) -> Self {
        Self::of_shift(real.into()) + Self::of_shift(Complex64::new(0.0, imaginary))
    }

    /// Returns the covariance of `value` z from independent errors of |z|, relative, and of its
    /// phase \[rad\]: δz = z (δ|z|/|z| + i δφ), to first order.
    #[must_use]
    pub fn of_magnitude_and_phase(value: Complex64, magnitude: f64, phase: f64) -> Self {
        Self::of_shift(magnitude * value) + Self::of_shift(Complex64::new(0.0, phase) * value)
    }

    /// Returns the covariance of a `modulus` E from independent standard errors of E' and of the
    /// loss factor η: with E = E' (1 + iη), δE = (E/E') δE' + iE' δη. It is NaN for E' = 0.
    #[must_use]
    pub fn of_loss_factor(modulus: Complex64, storage: f64, loss_factor: f64) -> Self {
        Self::of_shift(storage * modulus / modulus.re)
            + Self::of_shift(Complex64::new(0.0, modulus.re * loss_factor))
    }

    /// Returns the covariance of w = f(z) with the complex `derivative` dw/dz, to first order.
    #[must_use]
    pub fn through(self, derivative: Complex64) -> Self {
        let Complex64 { re: a, im: b } = derivative;
        let Self {
            real,
            imaginary,
            mixed,
        } = self;
        Self {
            real: a * a * real + b * b * imaginary - 2.0 * a * b * mixed,
            imaginary: b * b * real + a * a * imaginary + 2.0 * a * b * mixed,
            mixed: a * b * (real - imaginary) + (a * a - b * b) * mixed,
        }
    }

    /// Returns E|δz|², of both parts together.
    #[must_use]
    pub fn mean_square(&self) -> f64 {
        self.real + self.imaginary
    }

    /// Returns the variance of a real function of z with the derivatives `by_real` and
    /// `by_imaginary`, to first order. The result is clamped at 0, because rounding can make it
    /// negative if the covariance is singular.
    #[must_use]
    pub fn variance_of(&self, by_real: f64, by_imaginary: f64) -> f64 {
        let variance = by_real * by_real * self.real
            + by_imaginary * by_imaginary * self.imaginary
            + 2.0 * by_real * by_imaginary * self.mixed;
        if variance < 0.0 { 0.0 } else { variance }
    }

    /// Draws an error with this covariance from the normal distribution, in the unit of the
    /// quantity; 0 if the covariance is not finite.
    pub fn draw(self, random: &mut impl Rng) -> Complex64 {
        let Self {
            real,
            imaginary,
            mixed,
        } = self;
        let mut normal = || -> f64 { random.sample(StandardNormal) };
        let (first, second) = (normal(), normal());
        if !(real + imaginary + mixed).is_finite() {
            return Complex64::ZERO;
        }
        let slope = if real > 0.0 { mixed / real } else { 0.0 };
        let along = first * real.sqrt();
        let across = second * (imaginary - slope * mixed).max(0.0).sqrt();
        Complex64::new(along, slope * along + across)
    }

    /// Returns the correlation of the real and the imaginary part, from -1 to 1; 0 if one of the
    /// parts is exact.
    #[must_use]
    pub fn correlation(&self) -> f64 {
        let size = (self.real * self.imaginary).sqrt();
        if size > 0.0 { self.mixed / size } else { 0.0 }
    }
}

/// Covariance of the sum of independent errors.
impl Add for ComplexCovariance {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            real: self.real + other.real,
            imaginary: self.imaginary + other.imaginary,
            mixed: self.mixed + other.mixed,
        }
    }
}

/// Source of a common error: a quantity that is known only within an uncertainty, with the same
/// error on all lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum ErrorSource {
    /// Length of the specimen.
    Length,
    /// Diameter of the specimen.
    Diameter,
    /// Density of the specimen.
    Density,
    /// Mass of the accelerometer at the free end.
    AccelerometerMass,
    /// Distance of a section; the sections are counted from 0 in the order of the method.
    Section(usize),
    /// Position of a gauge; the gauges are counted from 0.
    GaugePosition(usize),
    /// Ratio of the sensitivities of two sensors.
    GainRatio,
    /// Delay of one channel relative to the other.
    Delay,
    /// Sensitivity of a gauge; the gauges are counted from 0.
    GaugeFactor(usize),
    /// Delay of the channel of a gauge; the gauges are counted from 0.
    GaugeDelay(usize),
    /// Position of a free end whose condition is used.
    FreeEnd,
    /// Change of the modulus with temperature, if the modulus was converted to another temperature.
    Temperature,
    /// Poisson's ratio, if lateral inertia has been removed.
    PoissonRatio,
    /// Lateral inertia that remains in the modulus because of the theory of the waves. With
    /// one-dimensional theory all of it remains.
    LateralInertia,
    /// Scale of the modulus, due to the force, the displacement and the dimensions of the specimen
    /// in an instrument that measures moduli.
    ModulusScale,
    /// Joint error of the shifts and factors of a master curve; their independent combinations are
    /// counted from 0.
    MasterCurve(usize),
    /// Choice between the vertical factors 1 and T/Tᵣ of a master curve.
    VerticalFactors,
}

/// In the text, sections and gauges are numbered from 1.
impl fmt::Display for ErrorSource {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (words, index) = match self {
            Self::Section(index) => ("distance of section", Some(index)),
            Self::GaugePosition(index) => ("position of gauge", Some(index)),
            Self::GaugeFactor(index) => ("sensitivity of gauge", Some(index)),
            Self::GaugeDelay(index) => ("delay of gauge", Some(index)),
            Self::MasterCurve(index) => ("shifts of the master curve, part", Some(index)),
            Self::VerticalFactors => ("choice of the vertical factors", None),
            Self::ModulusScale => ("scale of the modulus", None),
            Self::FreeEnd => ("position of the free end", None),
            Self::GainRatio => ("ratio of the sensitivities", None),
            Self::Delay => ("delay between the channels", None),
            Self::Temperature => ("change with temperature", None),
            Self::PoissonRatio => ("Poisson's ratio", None),
            Self::LateralInertia => ("uncorrected lateral inertia", None),
            Self::Length => ("length", None),
            Self::Diameter => ("diameter", None),
            Self::Density => ("density", None),
            Self::AccelerometerMass => ("accelerometer mass", None),
        };
        formatter.write_str(words)?;
        index.map_or(Ok(()), |index| write!(formatter, " {}", index + 1))
    }
}

/// Error of a line if one source is wrong by its standard uncertainty. The error of a source is the
/// same on all lines. Therefore the errors of the real parts of lines i and j have the covariance
/// Re δEᵢ Re δEⱼ, and the other parts have covariances of the same form.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SystematicShift {
    /// Uncertain quantity.
    pub source: ErrorSource,
    /// Shift δE of the modulus \[Pa\].
    pub modulus: Complex64,
    /// Shift δγ of the propagation coefficient [1/m].
    pub propagation_coefficient: Complex64,
}

/// Standard deviation about 0 of a one-sided error that is uniformly distributed from 0 to its
/// bound, as a fraction of the bound: 1/√3. An error equal to the bound is 1.73 standard
/// deviations.
const OF_BOUND: f64 = 0.577_350_269_189_625_8;

impl SystematicShift {
    /// Returns the shift due to lateral inertia, which makes a modulus too small by at most `bound`
    /// \[Pa\].
    pub(crate) fn of_lateral_inertia(bound: Complex64) -> Self {
        Self::new(
            ErrorSource::LateralInertia,
            bound * OF_BOUND,
            Complex64::ZERO,
        )
    }

    pub(crate) fn new(
        source: ErrorSource,
        modulus: Complex64,
        propagation_coefficient: Complex64,
    ) -> Self {
        Self {
            source,
            modulus,
            propagation_coefficient,
        }
    }
}

/// Covariances of the modulus and of the propagation coefficient, both due to the same errors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LineCovariance {
    /// Covariance of E' and E'' \[Pa²\].
    pub modulus: ComplexCovariance,
    /// Covariance of α and k [1/m²].
    pub propagation_coefficient: ComplexCovariance,
}

/// Uncertainty of one line, separated by cause.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Uncertainty {
    /// Covariance due to the noise of the measured quantities, which is independent from line to
    /// line.
    pub random: LineCovariance,
    /// Common errors, one per source, of the specimen and of the theory of its waves. Each of them
    /// is fully correlated between lines, and independent of the other sources.
    pub systematic: Vec<SystematicShift>,
    /// Degrees of freedom of the estimated variance of the noise; `None` if the variance is known.
    pub degrees_of_freedom: Option<f64>,
    /// Contribution of the line to the degrees of freedom of all lines, less than
    /// `degrees_of_freedom` if neighbouring lines share an estimate, see
    /// [`VarianceFreedom`](crate::estimate::VarianceFreedom); `None` if the variance is known.
    pub own_degrees_of_freedom: Option<f64>,
}

impl Uncertainty {
    /// Returns the covariance of one line due to all common errors that have a standard
    /// uncertainty. Lateral inertia that was not removed is not included: it has a
    /// [bound](Self::lateral_inertia_bound) of known sign, which is stated next to the standard
    /// errors.
    #[must_use]
    pub fn systematic_covariance(&self) -> LineCovariance {
        let none = LineCovariance::default();
        self.systematic
            .iter()
            .filter(|shift| shift.source != ErrorSource::LateralInertia)
            .fold(none, |sum, shift| LineCovariance {
                modulus: sum.modulus + ComplexCovariance::of_shift(shift.modulus),
                propagation_coefficient: sum.propagation_coefficient
                    + ComplexCovariance::of_shift(shift.propagation_coefficient),
            })
    }

    /// Returns the largest error \[Pa\] by which lateral inertia that was not removed can make the
    /// modulus too small; 0 if all of it was removed. The shift of [`ErrorSource::LateralInertia`]
    /// is 1/√3 of the bound, which is the standard deviation of an error that is uniformly
    /// distributed from 0 to this bound.
    #[must_use]
    pub fn lateral_inertia_bound(&self) -> Complex64 {
        self.systematic
            .iter()
            .filter(|shift| shift.source == ErrorSource::LateralInertia)
            .map(|shift| shift.modulus / OF_BOUND)
            .sum()
    }

    /// Returns the covariance of one line due to all sources.
    #[must_use]
    pub fn total_covariance(&self) -> LineCovariance {
        let systematic = self.systematic_covariance();
        LineCovariance {
            modulus: self.random.modulus + systematic.modulus,
            propagation_coefficient: self.random.propagation_coefficient
                + systematic.propagation_coefficient,
        }
    }

    /// Returns the factor k for which |error| <= kσ with this `probability`, for the random part.
    /// It is taken from Student's distribution if the variance was estimated from few averages,
    /// otherwise from the normal distribution.
    ///
    /// ```
    /// # use cmod::estimate::coverage_factor;
    /// assert!((coverage_factor(0.95, None)? - 1.960).abs() < 1e-3);
    /// // ten averages: 2 (10 - 1) degrees of freedom
    /// assert!((coverage_factor(0.95, Some(18.0))? - 2.101).abs() < 1e-3);
    /// # Ok::<(), cmod::CmodError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`coverage_factor`].
    pub fn coverage_factor(&self, probability: f64) -> Result<f64, CmodError> {
        coverage_factor(probability, self.degrees_of_freedom)
    }
}

/// Standard errors of one line, to first order.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct StandardError {
    /// Standard error of E' \[Pa\].
    pub storage_modulus: f64,
    /// Standard error of E'' \[Pa\].
    pub loss_modulus: f64,
    /// Standard error of E''/E'.
    pub loss_factor: f64,
    /// Standard error of α [1/m].
    pub damping_coefficient: f64,
    /// Standard error of k [rad/m].
    pub wave_number: f64,
    /// Standard error of ω/k [m/s].
    pub phase_velocity: f64,
}

impl StandardError {
    /// Returns the standard errors of a line with the `modulus` E \[Pa\] and
    /// `propagation_coefficient` γ [1/m] at `frequency_hz`, from the `covariance` of both.
    ///
    /// ```text
    /// d(E''/E') = (dE'' - (E''/E') dE')/E' ,    d(ω/k) = -ω dk/k²
    /// ```
    ///
    /// For a circular error of E the error of the loss factor is |E| σ/E'².
    #[must_use]
    pub fn of(
        modulus: Complex64,
        propagation_coefficient: Complex64,
        frequency_hz: f64,
        covariance: &LineCovariance,
    ) -> Self {
        let by_storage = -modulus.im / (modulus.re * modulus.re);
        let wave_number = covariance.propagation_coefficient.imaginary.sqrt();
        let k = propagation_coefficient.im;
        Self {
            storage_modulus: covariance.modulus.real.sqrt(),
            loss_modulus: covariance.modulus.imaginary.sqrt(),
            loss_factor: covariance
                .modulus
                .variance_of(by_storage, modulus.re.recip())
                .sqrt(),
            damping_coefficient: covariance.propagation_coefficient.real.sqrt(),
            wave_number,
            phase_velocity: TAU * frequency_hz * wave_number / (k * k),
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        [
            self.storage_modulus,
            self.loss_modulus,
            self.loss_factor,
            self.damping_coefficient,
            self.wave_number,
            self.phase_velocity,
        ]
        .iter()
        .all(|error| error.is_finite())
    }

    fn of_modulus(&self) -> Complex64 {
        Complex64::new(self.storage_modulus, self.loss_modulus)
    }
}

/// Writes the errors of E' and E'' in the form of a complex modulus, `E'+E''i`, in Pa.
impl fmt::Display for StandardError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.of_modulus(), formatter)
    }
}

/// Writes the errors like [`Display`](fmt::Display), but with exponents.
impl fmt::LowerExp for StandardError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::LowerExp::fmt(&self.of_modulus(), formatter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the propagated covariance of two independent shifts with the covariance of the
    /// central differences of a complex function for these shifts.
    #[test]
    fn covariances_go_through_a_complex_derivative() {
        let function = |z: Complex64| z.exp() / z;
        let at = Complex64::new(0.8, -1.3);
        let derivative = function(at) * (1.0 - at.inv());
        let (first, second) = (Complex64::new(3e-6, 1e-6), Complex64::new(-2e-6, 5e-6));
        let before = ComplexCovariance::of_shift(first) + ComplexCovariance::of_shift(second);
        let after = before.through(derivative);
        let moved = |shift: Complex64| 0.5 * (function(at + shift) - function(at - shift));
        let expected =
            ComplexCovariance::of_shift(moved(first)) + ComplexCovariance::of_shift(moved(second));
        for (found, expected) in [
            (after.real, expected.real),
            (after.imaginary, expected.imaginary),
            (after.mixed, expected.mixed),
        ] {
            // Differences of 5e-6 have rounding errors of 1e-16/5e-6 = 2e-11.
            assert!((found - expected).abs() < 1e-9 * after.mean_square());
        }
        assert!(after.correlation().abs() < 1.0);
    }

    /// Compares with central differences of E' (1 + iη) and of |E| e^{iφ}.
    #[test]
    fn errors_of_loss_factor_magnitude_and_phase_are_gradients() {
        let modulus = Complex64::new(2.0, 0.3);
        let (storage, eta) = (modulus.re, modulus.im / modulus.re);
        let by_eta =
            |de: f64, deta: f64| Complex64::new(storage + de, (storage + de) * (eta + deta));
        let polar = |dm: f64, dp: f64| {
            Complex64::from_polar(modulus.norm() * (1.0 + dm), modulus.arg() + dp)
        };
        let covariance = |of: &dyn Fn(f64, f64) -> Complex64, first: f64, second: f64| {
            ComplexCovariance::of_shift(0.5 * (of(first, 0.0) - of(-first, 0.0)))
                + ComplexCovariance::of_shift(0.5 * (of(0.0, second) - of(0.0, -second)))
        };
        for (found, expected) in [
            (
                ComplexCovariance::of_loss_factor(modulus, 1e-3, 2e-3),
                covariance(&by_eta, 1e-3, 2e-3),
            ),
            (
                ComplexCovariance::of_magnitude_and_phase(modulus, 1e-3, 2e-3),
                covariance(&polar, 1e-3, 2e-3),
            ),
        ] {
            // the central differences omit terms of third order, 1e-6 of the error
            let tolerance = 1e-5 * expected.mean_square();
            assert!((found.real - expected.real).abs() < tolerance);
            assert!((found.imaginary - expected.imaginary).abs() < tolerance);
            assert!((found.mixed - expected.mixed).abs() < tolerance);
        }
    }

    #[test]
    fn drawn_errors_have_the_covariance() {
        use rand::SeedableRng;

        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let first = ComplexCovariance::of_shift(Complex64::new(2.0, -1.0));
        let n = 40_000;
        for covariance in [
            first + ComplexCovariance::circular(2.0),
            first,
            ComplexCovariance::of_shift(Complex64::I),
        ] {
            let draws = (0..n).map(|_| covariance.draw(&mut random));
            let sum = draws.fold(ComplexCovariance::default(), |sum, error| {
                sum + ComplexCovariance::of_shift(error)
            });
            for (sum, expected) in [
                (sum.real, covariance.real),
                (sum.imaginary, covariance.imaginary),
                (sum.mixed, covariance.mixed),
            ] {
                // the mean of 40 000 squares has a relative standard error of 0.7 %; the tolerance
                // is four times as large
                let error = sum / f64::from(n) - expected;
                assert!(error.abs() < 0.03 * covariance.mean_square(), "{error}");
            }
        }
        let unknown = ComplexCovariance::circular(f64::INFINITY);
        assert_eq!(unknown.draw(&mut random), Complex64::ZERO);
    }
}
