//! Errors of a measured ratio that are the same in every hit: errors of the sensitivities, and of
//! the delay between the channels.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::error::{CmodError, check_frequencies, check_not_negative};
use crate::estimate::{ErrorSource, SystematicShift};

/// Error δΨ/Ψ of a measured ratio at every line, due to one source that is wrong by its standard
/// uncertainty. Averaging over hits does not reduce this error.
#[derive(Debug, Clone, PartialEq)]
pub struct RatioError {
    source: ErrorSource,
    relative: Vec<Complex64>,
}

impl RatioError {
    /// Creates the error of a ratio of sensitivities with the relative `standard_uncertainty` u:
    /// δΨ/Ψ = u on all lines.
    ///
    /// # Errors
    /// [`CmodError`] for invalid frequencies, and [`CmodError::NonPhysical`] unless the uncertainty
    /// is finite and not negative.
    pub fn of_gain_ratio(
        frequency_hz: &[f64],
        standard_uncertainty: f64,
    ) -> Result<Self, CmodError> {
        check_frequencies(frequency_hz)?;
        let relative = check_not_negative(
            "relative uncertainty of the gain ratio",
            standard_uncertainty,
        )?;
        Ok(Self {
            source: ErrorSource::GainRatio,
            relative: vec![relative.into(); frequency_hz.len()],
        })
    }

    /// Creates the error of a delay of the numerator relative to the denominator, with the
    /// `standard_uncertainty` u \[s\] of the delay: δΨ/Ψ = -iωu.
    ///
    /// # Errors
    /// The errors of [`RatioError::of_gain_ratio`].
    pub fn of_delay(frequency_hz: &[f64], standard_uncertainty: f64) -> Result<Self, CmodError> {
        check_frequencies(frequency_hz)?;
        let delay = check_not_negative("uncertainty of the delay [s]", standard_uncertainty)?;
        Ok(Self {
            source: ErrorSource::Delay,
            relative: frequency_hz
                .iter()
                .map(|f| Complex64::new(0.0, -TAU * f * delay))
                .collect(),
        })
    }

    /// Returns the source of the error.
    #[must_use]
    pub fn source(&self) -> ErrorSource {
        self.source
    }

    /// Returns δΨ/Ψ, one entry per line.
    #[must_use]
    pub fn relative(&self) -> &[Complex64] {
        &self.relative
    }

    /// Removes an error of `size` standard uncertainties from the `ratio`.
    pub(crate) fn removed(&self, ratio: &mut [Complex64], size: f64) {
        for (ratio, relative) in ratio.iter_mut().zip(&self.relative) {
            *ratio *= (-size * relative).exp();
        }
    }
}

/// Returns E|δΨ|² of a `ratio` at line `index` due to all `errors`.
pub(crate) fn variance(errors: &[RatioError], index: usize, ratio: Complex64) -> f64 {
    let relative = errors.iter().filter_map(|error| error.relative.get(index));
    relative.map(|relative| (ratio * relative).norm_sqr()).sum()
}

/// Returns the shifts of γ and E of line `index` due to the errors of Ψ, computed from dγ/dΨ.
pub(crate) fn shifts(
    errors: &[RatioError],
    index: usize,
    (gamma, modulus): (Complex64, Complex64),
    (ratio, by_ratio): (Complex64, Complex64),
) -> impl Iterator<Item = SystematicShift> {
    errors
        .iter()
        .filter_map(move |error| Some((error.source, error.relative.get(index)?)))
        .filter(|(_, relative)| **relative != Complex64::ZERO)
        .map(move |(source, relative)| {
            let of_gamma = by_ratio * ratio * relative;
            SystematicShift::new(source, -2.0 * modulus * of_gamma / gamma, of_gamma)
        })
}
