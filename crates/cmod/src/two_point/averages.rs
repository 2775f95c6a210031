//! Acceleration ratio and its variance from averaged spectra.
//!
//! In paper A, section 3, Ψ is the averaged cross-spectrum of both ends divided by the averaged
//! auto-spectrum of the free end. This is the least-squares slope of â₁ on â₂ over n hits, an H₁
//! estimate with the free end as input. The residual of â₁ has the mean square (1 - γ²) G₁₁, where
//! γ² is the ordinary coherence, and n - 1 complex degrees of freedom. Its variance is n(1 - γ²)
//! G₁₁/(n - 1), and the variance of the slope, a mean over n hits, is
//!
//! ```text
//! E|δΨ|² = (1 - γ²) G₁₁ / ((n - 1) G₂₂) = |Ψ|² (1 - γ²) / ((n - 1) γ²)
//! ```
//!
//! With n instead of n - 1, as often written, the variance would be right only for many averages:
//! for ten hits it would be a tenth too small. The variance is estimated with 2(n - 1) real
//! degrees of freedom. It scatters from line to line by the fraction 1/(n - 1)^½, and an error
//! divided by the square root of the variance is distributed as Student's t. Neighbouring lines can
//! share their information on the noise; see [`crate::estimate::VarianceFreedom`].
//!
//! # Bias
//! Noise of relative power a in â₂ lowers Ψ by the factor 1/(1 + a). Since γ² <= 1/(1 + a), the
//! bias is at most the fraction 1 - γ² of Ψ. Relative to the standard error of the real or
//! imaginary part, it is at most [2(n - 1) γ² (1 - γ²)]^½: for ten hits at γ² = 0.9994, this is a
//! tenth of the standard error. Averaging does not remove the bias. The default error limits keep
//! the bias small. If they are relaxed, a limit on the
//! [coherence](crate::validity::AcceptanceLimits::coherence) is needed.

use num_complex::Complex64;

use crate::error::{CmodError, check_length};

/// Excess of a coherence over 1 that is attributed to rounding.
const ROUNDING: f64 = 1e-12;

/// Ratio of the accelerations of the ends from spectra averaged over several hits, at increasing
/// frequencies. All arrays have one entry per line.
#[derive(Debug, Clone, Copy)]
pub struct AveragedRatio<'a> {
    /// Frequencies \[Hz\].
    pub frequency_hz: &'a [f64],
    /// Ratio Ψ of the impacted end to the free end, as H₁ = G₂₁/G₂₂ with G₂₁ the mean of â₁ â₂*.
    pub acceleration_ratio: &'a [Complex64],
    /// Ordinary coherence γ² of the two accelerations; NaN where there is no coherence, in which
    /// case the line is refused.
    pub coherence: &'a [f64],
    /// Number n of averages. For overlapping segments, state the effective number.
    pub averages: f64,
}

/// Returns E|δΨ|² of every line, of real and imaginary part together, from the ordinary `coherence`
/// γ² and the number of `averages` n: |Ψ|² (1 - γ²)/((n - 1) γ²). The result is infinite where γ²
/// is 0 or NaN; such a line is refused later.
///
/// ```
/// use cmod::two_point::variance_from_coherence;
/// use num_complex::Complex64;
///
/// let variance = variance_from_coherence(&[Complex64::new(0.0, 2.0)], &[0.999], 10.0)?;
/// assert!((variance[0] / (4.0 * 0.001 / (9.0 * 0.999)) - 1.0).abs() < 1e-12);
/// assert!(variance_from_coherence(&[Complex64::ONE], &[0.999], 1.0).is_err());
/// # Ok::<(), cmod::CmodError>(())
/// ```
///
/// # Errors
/// [`CmodError::TooFewAverages`] for fewer than 2 averages, because the coherence of one average is
/// always 1; [`CmodError::Coherence`] for a coherence outside the range from 0 to 1;
/// [`CmodError::LengthMismatch`].
pub fn variance_from_coherence(
    acceleration_ratio: &[Complex64],
    coherence: &[f64],
    averages: f64,
) -> Result<Vec<f64>, CmodError> {
    check_length("coherence", coherence.len(), acceleration_ratio.len())?;
    if !(averages.is_finite() && averages >= 2.0) {
        return Err(CmodError::TooFewAverages { found: averages });
    }
    let of_line = |(index, (ratio, &coherence)): (usize, (&Complex64, &f64))| {
        if coherence.is_nan() {
            return Ok(f64::INFINITY);
        }
        if !(0.0..=1.0 + ROUNDING).contains(&coherence) {
            return Err(CmodError::Coherence { index, coherence });
        }
        let incoherent = 1.0 - coherence;
        let incoherent = if incoherent < 0.0 { 0.0 } else { incoherent };
        if coherence == 0.0 {
            return Ok(f64::INFINITY);
        }
        if incoherent == 0.0 {
            return Ok(0.0); // also if the square of the ratio overflows
        }
        Ok(ratio.norm_sqr() * incoherent / ((averages - 1.0) * coherence))
    };
    let lines = acceleration_ratio.iter().zip(coherence).enumerate();
    lines.map(of_line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_coherences_and_too_few_averages_are_refused() {
        let ratio = [Complex64::ONE; 2];
        let text = |coherence: &[f64], averages: f64| {
            variance_from_coherence(&ratio, coherence, averages)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            text(&[0.9, 0.9], 1.0),
            "1 averages, expected at least 2: the coherence of a single average is always 1"
        );
        assert!(text(&[0.9, 0.9], f64::NAN).starts_with("NaN averages"));
        assert_eq!(
            text(&[0.9, 1.01], 10.0),
            "coherence of line 1 is 1.01, expected a value from 0 to 1"
        );
        assert_eq!(
            text(&[0.9], 10.0),
            "coherence has 1 lines, expected 2, one per frequency"
        );
        // a line without coherence is not an error
        let variance = variance_from_coherence(&ratio, &[f64::NAN, 0.0], 10.0).unwrap();
        assert!(variance.iter().all(|variance| variance.is_infinite()));
        let variance = variance_from_coherence(&ratio, &[1.0 + 1e-15, 1.0], 10.0).unwrap();
        assert_eq!(variance, [0.0, 0.0]);
    }
}
