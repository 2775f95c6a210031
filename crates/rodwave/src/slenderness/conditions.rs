//! Conditions (i) and (ii) of paper A: a wave that is long compared with the diameter but not with
//! the length.

use crate::RodwaveError;
use crate::error::check_positive;

/// Shortest wavelength in diameters by condition (i). The error of one-dimensional theory in E' is
/// then less than 5 per cent (Ödeen 1993, paper A, section 4, after Pritz).
pub const LEAST_WAVELENGTH_IN_DIAMETERS: f64 = 5.0;

/// Longest wavelength in lengths of the specimen by condition (ii). Longer waves move both ends
/// almost equally, and only the small difference contains information (paper A, section 4).
pub const GREATEST_WAVELENGTH_IN_LENGTHS: f64 = 5.0;

/// Wavelength in a specimen, relative to its diameter and its length.
///
/// ```
/// use rodwave::slenderness::Slenderness;
///
/// // Specimen of polypropylene of paper A: 15.8 mm in diameter, 799 mm long
/// let slenderness = Slenderness::of_wave_number(40.0, 0.0158, 0.799)?;
/// assert!(slenderness.is_long_against_diameter() && slenderness.is_short_against_length());
/// assert!((slenderness.wavelength_in_diameters() - 9.9).abs() < 0.1);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slenderness {
    wavelength: f64,
    diameter: f64,
    length: f64,
}

impl Slenderness {
    /// Creates the slenderness for a wave of `wave_number` k = Im γ [rad/m] in a specimen of
    /// `diameter` D \[m\] and `length` L \[m\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all three, and λ = 2π/k, are finite and above 0.
    pub fn of_wave_number(
        wave_number: f64,
        diameter: f64,
        length: f64,
    ) -> Result<Self, RodwaveError> {
        let wave_number = check_positive("wave number [rad/m]", wave_number)?;
        let slenderness = Self {
            wavelength: check_positive("wavelength [m]", std::f64::consts::TAU / wave_number)?,
            diameter: check_positive("diameter [m]", diameter)?,
            length: check_positive("length [m]", length)?,
        };
        check_positive(
            "wavelength over diameter",
            slenderness.wavelength_in_diameters(),
        )?;
        check_positive(
            "wavelength over length",
            slenderness.wavelength_in_lengths(),
        )?;
        Ok(slenderness)
    }

    /// Wavelength λ = 2π/k \[m\].
    #[must_use]
    pub fn wavelength(&self) -> f64 {
        self.wavelength
    }

    /// Wavelength in diameters, λ/D.
    #[must_use]
    pub fn wavelength_in_diameters(&self) -> f64 {
        self.wavelength / self.diameter
    }

    /// Wavelength in lengths, λ/L.
    #[must_use]
    pub fn wavelength_in_lengths(&self) -> f64 {
        self.wavelength / self.length
    }

    /// Returns true if condition (i), λ > 5D, is met: the rod is slender for this wave. The error
    /// of one-dimensional theory depends on Poisson's ratio; see
    /// [`elementary_theory_error`](super::elementary_theory_error).
    #[must_use]
    pub fn is_long_against_diameter(&self) -> bool {
        self.wavelength_in_diameters() > LEAST_WAVELENGTH_IN_DIAMETERS
    }

    /// Returns true if condition (ii), λ < 5L, is met: the motions of the two ends differ enough.
    #[must_use]
    pub fn is_short_against_length(&self) -> bool {
        self.wavelength_in_lengths() < GREATEST_WAVELENGTH_IN_LENGTHS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that a wavelength at a limit does not meet the condition, as printed: λ "should
    /// exceed" 5D and "be less than" 5L.
    #[test]
    fn conditions_are_strict() {
        let wave_number = std::f64::consts::TAU / 0.5;
        let at = Slenderness::of_wave_number(wave_number, 0.1, 0.1).unwrap();
        assert!(!at.is_long_against_diameter() && !at.is_short_against_length());
        let within = Slenderness::of_wave_number(wave_number, 0.0999, 0.1001).unwrap();
        assert!(within.is_long_against_diameter() && within.is_short_against_length());
    }

    #[test]
    fn wave_without_length_is_refused() {
        for wave_number in [0.0, -1.0, f64::NAN, 1e-310] {
            assert!(Slenderness::of_wave_number(wave_number, 0.1, 1.0).is_err());
        }
    }
}
