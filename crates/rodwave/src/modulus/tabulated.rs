//! Modulus given at discrete frequencies.

use num_complex::Complex64;

use super::monotone_cubic::MonotoneCubic;
use super::{ComplexModulus, check_modulus};
use crate::RodwaveError;
use crate::error::{check_length, check_not_negative, check_positive, check_that};

/// Storage and loss modulus at the lines of a measurement, interpolated monotonically in ln ω.
///
/// A table is undefined outside its band, where [`lookup`](Self::lookup) returns an error. It is
/// therefore not a [`ComplexModulus`], which has a value at every frequency; the caller can convert
/// it to one by [`held`](Self::held). For ω < 0 the modulus is the complex conjugate.
///
/// Many lines are needed where E'' is curved. For a Zener material with its loss peak at 0.5 kHz,
/// on lines evenly spaced from 0.5 to 10 kHz, the error of E'' between the lines is up to 12 % of
/// its maximum with 5 lines, 7 % with 10, 2.6 % with 20 and 0.8 % with 40 (for a peak within the
/// band, 18, 4, 0.5 and 0.07 %). The error of E' is less than 1.1 %, and the error of a constant
/// loss less than 0.02 %. [`interpolation_error`](Self::interpolation_error) estimates this error.
///
/// Interpolated values are causal only to the accuracy of the interpolation, and a table is not a
/// [`LaplaceModulus`](super::LaplaceModulus). A table has no parameters.
///
/// ```
/// use num_complex::Complex64;
/// use rodwave::modulus::{ComplexModulus, Tabulated};
///
/// let omega = [1e3, 1e4, 1e5];
/// let modulus = [(2.4e9, 1.6e8), (2.6e9, 1.5e8), (2.8e9, 1.5e8)].map(|(re, im)| Complex64::new(re, im));
/// let table = Tabulated::new(&omega, &modulus)?;
/// assert_eq!(table.lookup(1e4)?, modulus[1]);
/// assert!(table.lookup(2e5).is_err());
/// assert_eq!(table.held().at(2e5), modulus[2]);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulated {
    first: Line,
    last: Line,
    storage: MonotoneCubic,
    loss: MonotoneCubic,
}

/// Ratio of the estimated error to the difference between two interpolations of the same lines. It
/// is above 1 because both may be wrong in the same way.
const CAUTION: f64 = 3.0;

/// A line of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    omega: f64,
    modulus: Complex64,
}

impl Tabulated {
    /// Creates a table of the complex `modulus` \[Pa\] at increasing `omega` > 0 [rad/s], with two
    /// lines or more.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] if the lengths differ, [`RodwaveError::TooFewSamples`]
    /// below two lines, or [`RodwaveError::NonPhysical`] unless all frequencies are finite, above 0
    /// and increasing, E' is finite and above 0, and E'' is finite and not negative. Noise can make
    /// a measured E'' negative: the caller must smooth or remove such a line.
    pub fn new(omega: &[f64], modulus: &[Complex64]) -> Result<Self, RodwaveError> {
        check_length("table of moduli", modulus.len(), omega.len())?;
        let ([first_omega, .., last_omega], [first, .., last]) = (omega, modulus) else {
            return Err(RodwaveError::TooFewSamples {
                history: "table of moduli",
                found: omega.len(),
                expected: 2,
            });
        };
        let line = |omega: &f64, modulus: &Complex64| Line {
            omega: *omega,
            modulus: *modulus,
        };
        let (first, last) = (line(first_omega, first), line(last_omega, last));
        let mut below = 0.0;
        for (&omega, modulus) in omega.iter().zip(modulus) {
            check_positive("angular frequency of a line [rad/s]", omega)?;
            check_that(
                omega > below,
                "angular frequency of a line [rad/s]",
                omega,
                "more than that of the previous line",
            )?;
            below = omega;
            check_positive("storage modulus of a line [Pa]", modulus.re)?;
            check_not_negative("loss modulus of a line [Pa]", modulus.im)?;
        }
        let log_omega: Vec<f64> = omega.iter().map(|omega| omega.ln()).collect();
        let storage: Vec<f64> = modulus.iter().map(|modulus| modulus.re).collect();
        let loss: Vec<f64> = modulus.iter().map(|modulus| modulus.im).collect();
        Ok(Self {
            first,
            last,
            storage: MonotoneCubic::through(&log_omega, &storage),
            loss: MonotoneCubic::through(&log_omega, &loss),
        })
    }

    /// Returns true if the magnitude of `omega` [rad/s] is in the band of the table, including its
    /// ends.
    #[must_use]
    pub fn covers(&self, omega: f64) -> bool {
        (self.first.omega..=self.last.omega).contains(&omega.abs())
    }

    /// Returns the complex modulus \[Pa\] at `omega` [rad/s], of either sign.
    ///
    /// # Errors
    /// [`RodwaveError::OutsideTable`] outside the table, which includes ω = 0.
    pub fn lookup(&self, omega: f64) -> Result<Complex64, RodwaveError> {
        if self.covers(omega) {
            check_modulus(self.interpolate(omega, MonotoneCubic::value))
        } else {
            Err(RodwaveError::OutsideTable {
                quantity: "magnitude of the angular frequency [rad/s]",
                value: omega.abs(),
                lower: self.first.omega,
                upper: self.last.omega,
            })
        }
    }

    /// Estimated errors of interpolated E' (real part) and E'' (imaginary part) \[Pa\] at `omega`
    /// [rad/s], of either sign. The estimate is constant in each interval between lines. `None`
    /// outside the table and for fewer than four lines.
    ///
    /// The estimate is three times the largest difference in the interval from the cubic through
    /// the four nearest lines. For laws of Zener, fractional Zener, power-law and constant-loss
    /// type on 5 to 40 lines, evenly spaced in ω or in ln ω, the estimate is at least the error at
    /// 95 % of the frequencies, and at most 20 times the error in the median. Errors of the lines
    /// themselves are not included. A maximum of E'' between two lines affects the estimate only
    /// through its flanks.
    #[must_use]
    pub fn interpolation_error(&self, omega: f64) -> Option<Complex64> {
        if !self.covers(omega) {
            return None;
        }
        let log_omega = omega.abs().ln();
        let of = |part: &MonotoneCubic| Some(CAUTION * part.difference_of_cubics(log_omega)?);
        Some(Complex64::new(of(&self.storage)?, of(&self.loss)?))
    }

    /// Continues the table by its first and its last line: below and above the band, E' and E'' are
    /// constant; E(0) = E' of the first line.
    ///
    /// A constant loss with a constant stiffness is not causal. Check the effect of the
    /// continuation on a result, for example by applying [`covers`](Self::covers) to the
    /// frequencies that carry the energy.
    #[must_use]
    pub fn held(self) -> HeldTable {
        HeldTable { table: self }
    }

    fn interpolate(&self, omega: f64, face: impl Fn(&MonotoneCubic, f64) -> f64) -> Complex64 {
        let log_omega = omega.abs().ln();
        let value = Complex64::new(face(&self.storage, log_omega), face(&self.loss, log_omega));
        conjugate_below_zero(value, omega)
    }
}

/// A [`Tabulated`] modulus, continued by the values at its ends; created by [`Tabulated::held`].
#[derive(Debug, Clone, PartialEq)]
pub struct HeldTable {
    table: Tabulated,
}

impl HeldTable {
    /// The table without its continuation.
    #[must_use]
    pub fn table(&self) -> &Tabulated {
        &self.table
    }
}

impl ComplexModulus for HeldTable {
    fn at(&self, omega: f64) -> Complex64 {
        let Tabulated { first, last, .. } = &self.table;
        if omega == 0.0 {
            Complex64::from(first.modulus.re)
        } else if omega.abs() < first.omega {
            conjugate_below_zero(first.modulus, omega)
        } else if omega.abs() > last.omega {
            conjugate_below_zero(last.modulus, omega)
        } else {
            self.table.interpolate(omega, MonotoneCubic::value)
        }
    }

    fn slope(&self, omega: f64) -> Complex64 {
        if self.table.covers(omega) {
            self.table.interpolate(omega, MonotoneCubic::slope)
        } else {
            Complex64::ZERO
        }
    }
}

/// Converts the value for |ω| to the value for ω.
fn conjugate_below_zero(value: Complex64, omega: f64) -> Complex64 {
    if omega < 0.0 { value.conj() } else { value }
}
