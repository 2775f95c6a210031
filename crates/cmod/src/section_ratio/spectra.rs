//! Ratio of two measured spectra and its variance.

use num_complex::Complex64;

use super::RatioError;
use crate::error::{CmodError, check_frequencies, check_length};
use crate::estimate::VarianceFreedom;

/// Measured ratio Ψ of two spectra at increasing frequencies, with its variance and the accuracy of
/// the variance. All arrays have one entry per line.
#[derive(Debug, Clone, Copy)]
pub struct RatioLines<'a> {
    /// Frequencies \[Hz\].
    pub frequency_hz: &'a [f64],
    /// Ratio Ψ.
    pub ratio: &'a [Complex64],
    /// Variance E|δΨ|², of real and imaginary part together, for an error without preferred phase;
    /// 0 means data without noise.
    pub variance: &'a [f64],
    /// Degrees of freedom of the variances; `None` if the variances are known.
    pub freedom: Option<&'a [VarianceFreedom]>,
    /// Ordinary coherence, if available. It is used only by [`TwoPoint`](crate::TwoPoint), for its
    /// [limit](crate::validity::AcceptanceLimits::coherence).
    pub coherence: Option<&'a [f64]>,
    /// Common errors of the ratio, each with one entry per line; empty for exact sensors.
    pub common: &'a [RatioError],
    /// Ratio of the number of lines to the number of lines with independent noise. It is 1, or more
    /// if short pulses are part of long records.
    pub lines_per_independent_line: f64,
}

impl<'a> RatioLines<'a> {
    /// Creates a ratio with a known variance.
    #[must_use]
    pub fn of_known_variance(
        frequency_hz: &'a [f64],
        ratio: &'a [Complex64],
        variance: &'a [f64],
    ) -> Self {
        Self {
            frequency_hz,
            ratio,
            variance,
            freedom: None,
            coherence: None,
            common: &[],
            lines_per_independent_line: 1.0,
        }
    }

    /// Refuses arrays whose lengths do not match; `name` is the name of the ratio.
    pub(crate) fn check(&self, name: &'static str) -> Result<(), CmodError> {
        check_frequencies(self.frequency_hz)?;
        let count = self.frequency_hz.len();
        check_length(name, self.ratio.len(), count)?;
        check_length("variance", self.variance.len(), count)?;
        if let Some((index, &variance)) = self.variance.iter().enumerate().find(|(_, v)| **v < 0.0)
        {
            return Err(CmodError::NegativeVariance { index, variance });
        }
        if let Some(freedom) = self.freedom {
            check_length("degrees of freedom", freedom.len(), count)?;
            for freedom in freedom {
                freedom.check()?;
            }
        }
        if let Some(coherence) = self.coherence {
            check_length("coherence", coherence.len(), count)?;
        }
        for error in self.common {
            check_length("common error of the ratio", error.relative().len(), count)?;
        }
        Ok(())
    }

    /// Returns the degrees of freedom of the variance of one line.
    pub(crate) fn freedom_of(&self, index: usize) -> Option<VarianceFreedom> {
        self.freedom.and_then(|freedom| freedom.get(index).copied())
    }
}

/// Ratio Ψ = q̂₁/q̂₂ with its variance, from the spectra of one test or several.
///
/// Several tests are combined by least squares, with the second spectrum as the input:
///
/// ```text
/// Ψ = Σ q̂₁ q̂₂* / Σ|q̂₂|² ,    E|δΨ|² = (σ₁² + |Ψ|² σ₂²) / Σ|q̂₂|²
/// ```
///
/// The variance is of first order in the noise, which is circular and independent between the two
/// spectra. Noise in q̂₂ of M tests lowers Ψ by the factor 1/(1 + Mσ₂²/Σ|q̂₂|²). Use the larger of
/// the two signals as the denominator.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RatioOfSpectra {
    /// Ratio Ψ; NaN at a line without signal in the denominator.
    pub ratio: Vec<Complex64>,
    /// Variance E|δΨ|², of real and imaginary part together.
    pub variance: Vec<f64>,
}

impl RatioOfSpectra {
    /// Computes the ratio from two spectra `(n_tests)(n_lines)` and the root mean square |δ| of the
    /// noise `(n_lines)` of each, of real and imaginary part together, in the unit of the spectrum.
    ///
    /// # Errors
    /// [`CmodError::NoTests`]; [`CmodError::TestCount`];
    /// [`CmodError::SpectrumLength`]; [`CmodError::LengthMismatch`] and
    /// [`CmodError::NegativeNoise`] for the noise.
    pub fn new(
        numerator: &[&[Complex64]],
        denominator: &[&[Complex64]],
        numerator_noise: &[f64],
        denominator_noise: &[f64],
    ) -> Result<Self, CmodError> {
        let first = denominator.first().ok_or(CmodError::NoTests)?;
        if numerator.len() != denominator.len() {
            return Err(CmodError::TestCount {
                found: numerator.len(),
                expected: denominator.len(),
            });
        }
        let n_lines = first.len();
        for (gauge, spectra) in [numerator, denominator].into_iter().enumerate() {
            let wrong = spectra
                .iter()
                .enumerate()
                .find(|(_, spectrum)| spectrum.len() != n_lines);
            if let Some((test, spectrum)) = wrong {
                return Err(CmodError::SpectrumLength {
                    test,
                    gauge,
                    found: spectrum.len(),
                    expected: n_lines,
                });
            }
        }
        for (gauge, noise) in [numerator_noise, denominator_noise].into_iter().enumerate() {
            check_length("noise of a spectrum", noise.len(), n_lines)?;
            if let Some((line, &noise)) = noise.iter().enumerate().find(|(_, s)| **s < 0.0) {
                return Err(CmodError::NegativeNoise { gauge, line, noise });
            }
        }
        let (mut ratio, mut variance) = (Vec::with_capacity(n_lines), Vec::with_capacity(n_lines));
        for (line, (noise, denominator_noise)) in
            numerator_noise.iter().zip(denominator_noise).enumerate()
        {
            #[allow(
                clippy::indexing_slicing,
                reason = "all spectra have as many lines as the noise"
            )]
            let at = |spectrum: &&[Complex64]| spectrum[line];
            let pairs = || numerator.iter().map(at).zip(denominator.iter().map(at));
            let cross: Complex64 = pairs().map(|(n, d)| n * d.conj()).sum();
            let auto: f64 = pairs().map(|(_, d)| d.norm_sqr()).sum();
            let psi = cross / auto;
            ratio.push(psi);
            let noises = noise * noise + psi.norm_sqr() * denominator_noise * denominator_noise;
            variance.push(noises / auto);
        }
        Ok(Self { ratio, variance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_are_weighted_by_the_power_of_the_denominator() {
        let psi = Complex64::new(0.3, -0.4);
        let d = [Complex64::new(1.0, 2.0), Complex64::new(-3.0, 0.5)];
        let n = d.map(|d| psi * d);
        let pair = RatioOfSpectra::new(&[&n[..1], &n[1..]], &[&d[..1], &d[1..]], &[0.2], &[0.1]);
        let pair = pair.unwrap();
        // tolerance: a few rounding errors of numbers of the order of 1
        assert!((pair.ratio[0] - psi).norm() < 1e-15);
        assert!((pair.variance[0] - (0.04 + 0.25 * 0.01) / 14.25).abs() < 1e-16);
    }

    #[test]
    fn spectra_that_do_not_fit_are_refused() {
        let one = [Complex64::ONE; 2];
        let text = |n: &[&[Complex64]], d: &[&[Complex64]], s: &[f64]| {
            RatioOfSpectra::new(n, d, s, &[0.1; 2])
                .unwrap_err()
                .to_string()
        };
        assert_eq!(text(&[], &[], &[]), "no test to evaluate");
        assert_eq!(
            text(&[&one], &[&one, &one], &[0.1; 2]),
            "numerator has 1 tests, expected 2, as many as the denominator"
        );
        assert_eq!(
            text(&[&one[..1]], &[&one], &[0.1; 2]),
            "spectrum of gauge 0 in test 0 has 1 lines, expected 2, one per frequency"
        );
        assert_eq!(
            text(&[&one], &[&one], &[0.1, -0.1]),
            "noise of gauge 0 at line 1 is -0.1, expected 0 or above"
        );
        // a line without signal is no error: the method refuses it
        let silent = RatioOfSpectra::new(&[&one], &[&[Complex64::ZERO; 2]], &[0.1; 2], &[0.1; 2]);
        assert!(!silent.unwrap().ratio[0].is_finite());
    }
}
