//! Weights of moduli without stated errors, from the scatters of |E| and of the phase.

use num_complex::Complex64;

/// Largest factor by which the ratio of the scatters may differ from the ratio of the errors used
/// for the two to count as equal. With 169 rows the ratio of the scatters is known to 8 %.
const EQUAL: f64 = 1.2;
/// Maximum number of fits.
const MOST_FITS: u32 = 4;
/// Largest ratio of the errors of |E| and of the phase, or its inverse.
const MOST_UNEQUAL: f64 = 10.0;

/// Standard errors of complex moduli in polar form, the same on all lines: the relative error of
/// |E|, and the error of the phase \[rad\]. The covariance of a modulus is
/// [`ComplexCovariance::of_magnitude_and_phase`](crate::estimate::ComplexCovariance::of_magnitude_and_phase).
///
/// If the size of the errors is unknown, it follows from the residual
/// ([`ErrorScale::FromResidual`](super::ErrorScale::FromResidual)), and only the ratio of the two
/// errors affects a fit. [`Self::fitted`] finds this ratio.
///
/// ```
/// use cmod::num_complex::Complex64;
/// use cmod::rheology::PolarScatter;
///
/// // moduli scatter by 3 % in |E| and by 1 % in the phase about a weighted mean
/// let moduli: Vec<Complex64> = (0..100)
///     .map(|n: i32| {
///         let sign = |k: i32| if n % (2 * k) < k { 1.0 } else { -1.0 };
///         Complex64::new(0.03 * sign(1), 0.1 + 0.01 * sign(2)).exp()
///     })
///     .collect();
/// let mean = Complex64::new(0.0, 0.1).exp();
/// let about = |_: &PolarScatter| PolarScatter::about(moduli.iter().map(|modulus| (*modulus, mean)));
/// let weights = PolarScatter::fitted(0.01, |weights| Ok::<_, cmod::CmodError>(weights), about)?;
/// assert!((weights.magnitude / weights.phase - 3.0).abs() < 1e-9);
/// assert!((weights.magnitude * weights.phase - 1e-4).abs() < 1e-15);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolarScatter {
    /// Relative standard error of |E|.
    pub magnitude: f64,
    /// Standard error of the phase \[rad\].
    pub phase: f64,
}

impl PolarScatter {
    /// Creates equal errors of this `size` of |E|, relative, and of the phase \[rad\].
    #[must_use]
    pub fn equal(size: f64) -> Self {
        Self {
            magnitude: size,
            phase: size,
        }
    }

    /// Returns the scatter of pairs of a measured and a fitted modulus, the root mean squares of
    /// the real and the imaginary part of ln(E/E_fit); `None` without pairs.
    pub fn about(pairs: impl Iterator<Item = (Complex64, Complex64)>) -> Option<Self> {
        let (mut magnitude, mut phase, mut count) = (0.0, 0.0, 0.0);
        for (measured, fitted) in pairs {
            let difference = (measured / fitted).ln();
            magnitude += difference.re * difference.re;
            phase += difference.im * difference.im;
            count += 1.0;
        }
        (count > 0.0).then(|| Self {
            magnitude: (magnitude / count).sqrt(),
            phase: (phase / count).sqrt(),
        })
    }

    /// Returns the result of `fit`, whose argument is the pair of errors with which the moduli are
    /// weighted: first [equal errors](Self::equal) of this `size`, then errors whose ratio is that
    /// of the scatters about the previous result, `scatter_about`, and whose geometric mean is
    /// `size`. The ratio is limited to the range from 1/10 to 10. The fits end if the ratio changes
    /// by less than a factor of 1.2, if the scatter is unknown, or after four fits.
    ///
    /// # Errors
    /// The error of `fit`.
    pub fn fitted<T, E>(
        size: f64,
        mut fit: impl FnMut(Self) -> Result<T, E>,
        scatter_about: impl Fn(&T) -> Option<Self>,
    ) -> Result<T, E> {
        let mut weights = Self::equal(size);
        let mut fitted = fit(weights)?;
        for _ in 1..MOST_FITS {
            let scatter = scatter_about(&fitted);
            match scatter.and_then(|scatter| scatter.unlike(weights, size)) {
                Some(better) => weights = better,
                None => break,
            }
            fitted = fit(weights)?;
        }
        Ok(fitted)
    }

    /// Returns errors of this `size` whose ratio is that of the scatters; `None` if this ratio
    /// counts as equal to the ratio of the errors `used` before, or is not a number.
    fn unlike(self, used: Self, size: f64) -> Option<Self> {
        let ratio = |of: Self| (of.magnitude / of.phase).clamp(MOST_UNEQUAL.recip(), MOST_UNEQUAL);
        let (own, before) = (ratio(self), ratio(used));
        let is_unlike = own > EQUAL * before || before > EQUAL * own;
        is_unlike.then(|| Self {
            magnitude: size * own.sqrt(),
            phase: size / own.sqrt(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Scatters of the last of a series of fits, and the number of fits.
    fn fitted(scatters: &[(f64, f64)]) -> (PolarScatter, usize) {
        let mut fits = 0;
        let weights = PolarScatter::fitted(
            0.01,
            |weights| {
                fits += 1;
                Ok::<_, crate::CmodError>((weights, fits))
            },
            |(_, fits)| {
                let (magnitude, phase) = *scatters.get(fits - 1)?;
                Some(PolarScatter { magnitude, phase })
            },
        );
        (weights.unwrap().0, fits)
    }

    #[test]
    fn fits_end_where_the_ratio_settles() {
        let equal = PolarScatter::equal(0.01);
        // the errors remain equal without scatters, with nearly equal scatters, and with a ratio
        // that is not a number
        for scatters in [&[][..], &[(0.05, 0.049)][..], &[(0.0, 0.0)][..]] {
            assert_eq!(fitted(scatters), (equal, 1));
        }
        // the second ratio, 4.4, counts as equal to the first, 4
        let (weights, fits) = fitted(&[(0.04, 0.01), (0.044, 0.01)]);
        assert_eq!(fits, 2);
        assert!((weights.magnitude - 0.02).abs() < 1e-15 && (weights.phase - 0.005).abs() < 1e-15);
        // a ratio beyond 10 counts as 10, and the fits end even if the ratio does not converge
        let (weights, fits) = fitted(&[(1.0, 1e-9), (1e-9, 1.0), (1.0, 0.0), (0.0, 1.0)]);
        assert_eq!(fits, 4);
        assert!((weights.magnitude / weights.phase - 10.0).abs() < 1e-12);
    }

    #[test]
    fn the_scatter_is_that_of_the_logarithm() {
        let fitted = Complex64::new(3.0, 4.0);
        let measured = [
            fitted * 0.1_f64.exp(),
            fitted * Complex64::new(0.0, -0.2).exp(),
        ];
        let found = PolarScatter::about(measured.into_iter().map(|e| (e, fitted))).unwrap();
        assert!((found.magnitude - 0.1 / 2.0_f64.sqrt()).abs() < 1e-15);
        assert!((found.phase - 0.2 / 2.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(PolarScatter::about(std::iter::empty()), None);
    }
}
