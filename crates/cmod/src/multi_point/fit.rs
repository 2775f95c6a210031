//! Fit of two waves to each line: the result of a method for gauges, and its goodness of fit.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::projection::TestWaves;
use super::waves::{LineOfWaves, Quantity, WavesAtSection, waves_at};
use crate::error::CmodError;
use crate::estimate::{ModulusEstimate, ModulusLine, VarianceFreedom};

/// Result of [`MultiPoint`](super::MultiPoint).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MultiPointEstimate {
    pub(super) modulus: ModulusEstimate,
    pub(super) fits: Vec<LineFit>,
    pub(super) waves: Vec<Vec<TestWaves>>,
    /// Position of the first gauge \[m\], and its distance from the last gauge or the free end
    /// \[m\].
    pub(super) first: f64,
    pub(super) aperture: f64,
    pub(super) quantity: Quantity,
}

impl MultiPointEstimate {
    /// Returns the modulus per line.
    #[must_use]
    pub fn modulus(&self) -> &ModulusEstimate {
        &self.modulus
    }

    /// Returns the goodness of fit of each of the [lines](ModulusEstimate::lines) of the modulus,
    /// in their order.
    #[must_use]
    pub fn fits(&self) -> &[LineFit] {
        &self.fits
    }

    /// Returns the waves of `quantity` at `section` x \[m\], on the line `line` of
    /// [`ModulusEstimate::lines`] in test `test`, both from 0; `None` if there is no such line
    /// or test.
    ///
    /// The section may be outside the range of the gauges, provided that the rod is uniform up to
    /// the section.
    #[must_use]
    pub fn waves(
        &self,
        line: usize,
        test: usize,
        section: f64,
        quantity: Quantity,
    ) -> Option<WavesAtSection> {
        let fit = self.fits.get(line)?;
        let test = self.waves.get(line)?.get(test)?;
        let way = section - self.first;
        Some(waves_at(
            &fit.waves,
            test,
            way,
            self.aperture - way,
            self.quantity,
            quantity,
        ))
    }

    /// Replaces the modulus by the `continued` one, and removes the fits and waves of the lines
    /// without a continued modulus.
    pub(super) fn continue_to(&mut self, continued: ModulusEstimate) {
        let is_kept = |line: &ModulusLine| {
            let lines = continued.lines();
            let place = lines.binary_search_by_key(&line.index, |kept| kept.index);
            place.is_ok()
        };
        let kept: Vec<bool> = self.modulus.lines().iter().map(is_kept).collect();
        let mut of_fits = kept.iter();
        self.fits.retain(|_| of_fits.next() == Some(&true));
        let mut of_waves = kept.iter();
        self.waves.retain(|_| of_waves.next() == Some(&true));
        self.modulus = continued;
    }
}

/// Goodness of fit of two waves on a line.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct LineFit {
    /// Variance E|δγ|² [1/m²]. Half of it is due to α and half to k, which are uncorrelated.
    pub propagation_variance: f64,
    /// Twice the sum of squares of the residuals divided by the noise, which has the chi-square
    /// distribution; `None` if the noise is 0 or the gauges have no redundancy.
    pub chi_square: Option<f64>,
    /// Degrees of freedom of chi-square: 2(M(n - 2) - 1) for M tests with n gauges, where a free
    /// end that is used counts as a gauge.
    pub degrees_of_freedom: usize,
    /// Ratio of the second-order error of γ to its standard error.
    pub second_order: f64,
    pub(super) waves: LineOfWaves,
}

/// Returns the limit of chi-square that noise alone exceeds on one line in a thousand. If the noise
/// has finite degrees of freedom, the limit follows from the distribution of F.
pub(super) fn most_misfit(
    degrees_of_freedom: usize,
    noise_freedom: Option<VarianceFreedom>,
) -> Result<f64, CmodError> {
    let Some(noise) = noise_freedom.filter(|_| degrees_of_freedom > 0) else {
        return Ok(chi_square_limit(degrees_of_freedom));
    };
    let n = degrees_of_freedom as f64;
    let law = FisherSnedecor::new(n, noise.line).map_err(|_| CmodError::NonPhysical {
        quantity: "degrees of freedom of a variance",
        value: noise.line,
        expected: "a finite value above 0",
    })?;
    Ok(n * law.inverse_cdf(0.999))
}

/// Returns the value of chi-square that noise alone exceeds on one line in a thousand, by the
/// cube-root approximation of Wilson and Hilferty. It is up to 2.4 % too high at 2 degrees of
/// freedom, and less at more degrees of freedom.
fn chi_square_limit(degrees_of_freedom: usize) -> f64 {
    const NORMAL_QUANTILE: f64 = 3.0902;
    let n = degrees_of_freedom as f64;
    let spread = 2.0 / (9.0 * n);
    n * (1.0 - spread + NORMAL_QUANTILE * spread.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of 99.9 % from tables of the chi-square distribution; for 2 degrees of freedom the
    /// quantile is 2 ln 1000.
    #[test]
    fn one_line_in_a_thousand_exceeds_the_limit() {
        for (degrees_of_freedom, quantile) in [
            (2, 13.816),
            (4, 18.467),
            (10, 29.588),
            (40, 73.402),
            (100, 149.449),
        ] {
            let limit = chi_square_limit(degrees_of_freedom);
            assert!(
                (-1e-3..0.024).contains(&(limit / quantile - 1.0)),
                "{limit} for {quantile}"
            );
        }
    }
}
