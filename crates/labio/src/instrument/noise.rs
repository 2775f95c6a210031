//! Gaussian noise with a given spectrum.

use num_complex::Complex64;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::LabioError;
use crate::dft;
use crate::error::{check_enough_samples, check_not_negative, check_positive, non_physical};

/// One-sided power spectral density of noise \[unit²/Hz\], in the unit of the channel at the stage
/// where the noise is added.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseSpectrum(Shape);

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    White {
        density: f64,
    },
    PowerLaw {
        density: f64,
        at_hz: f64,
        exponent: f64,
        flat_below_hz: f64,
    },
    Table(Vec<[f64; 2]>),
}

impl NoiseSpectrum {
    /// Creates a spectrum of constant density.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the density is negative or not finite.
    pub fn white(density: f64) -> Result<Self, LabioError> {
        check_not_negative("noise density [unit^2/Hz]", density)?;
        Ok(Self(Shape::White { density }))
    }

    /// Creates a spectrum $`S(f) = S_0\,(f/f_0)^{-a}`$ from `flat_below_hz` on, constant below it;
    /// $`a = 1`$ is the flicker noise of transistors.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the density is negative, a frequency is not positive or the
    /// exponent is outside -4..4.
    pub fn power_law(
        density: f64,
        at_hz: f64,
        exponent: f64,
        flat_below_hz: f64,
    ) -> Result<Self, LabioError> {
        check_not_negative("noise density [unit^2/Hz]", density)?;
        check_positive("reference frequency of the noise [Hz]", at_hz)?;
        check_positive("lower corner of the noise [Hz]", flat_below_hz)?;
        if !(-4.0..=4.0).contains(&exponent) {
            return non_physical("exponent of the noise", exponent, "a value from -4 to 4");
        }
        Ok(Self(Shape::PowerLaw {
            density,
            at_hz,
            exponent,
            flat_below_hz,
        }))
    }

    /// Creates a spectrum from densities at frequencies, `[frequency_hz, density]`, joined by power
    /// laws and constant below the first and above the last.
    ///
    /// # Errors
    ///
    /// - [`LabioError::TooFewSamples`]: there is no row.
    /// - [`LabioError::NonPhysical`]: a frequency or a density is not positive, or frequencies do
    ///   not increase.
    pub fn table(rows: &[[f64; 2]]) -> Result<Self, LabioError> {
        check_enough_samples("the table of noise densities", rows.len(), 1)?;
        let mut last = 0.0;
        for [frequency_hz, density] in rows {
            check_positive("tabulated noise density [unit^2/Hz]", *density)?;
            check_positive("tabulated frequency of noise [Hz]", *frequency_hz)?;
            if *frequency_hz <= last {
                return non_physical(
                    "tabulated frequency of noise [Hz]",
                    *frequency_hz,
                    "a value above the previous one",
                );
            }
            last = *frequency_hz;
        }
        Ok(Self(Shape::Table(rows.to_vec())))
    }

    /// Returns the density at a frequency \[unit²/Hz\].
    #[must_use]
    pub fn density(&self, frequency_hz: f64) -> f64 {
        match &self.0 {
            Shape::White { density } => *density,
            Shape::PowerLaw {
                density,
                at_hz,
                exponent,
                flat_below_hz,
            } => density * (frequency_hz.max(*flat_below_hz) / at_hz).powf(-exponent),
            Shape::Table(rows) => interpolated(rows, frequency_hz),
        }
    }

    /// Draws `n` samples at `rate_hz`.
    ///
    /// The lines of a transform of at least twice the length are drawn as complex Gaussian numbers
    /// with $`\mathrm E|X_k|^2 = S(f_k) f_s N/2`$; at most half of the resulting history is used,
    /// so that its end is independent of its beginning.
    pub(super) fn draw<R: Rng + ?Sized>(&self, n: usize, rate_hz: f64, rng: &mut R) -> Vec<f64> {
        let n_total = (2 * n).next_power_of_two();
        let mut lines = vec![Complex64::ZERO; n_total / 2 + 1];
        let mut gauss = || -> f64 { StandardNormal.sample(rng) };
        let last = lines.len().saturating_sub(1);
        for (k, line) in lines.iter_mut().enumerate() {
            let frequency_hz = k as f64 * rate_hz / n_total as f64;
            let power = self.density(frequency_hz) * rate_hz * n_total as f64 / 2.0;
            *line = if k == 0 || k == last {
                Complex64::new(power.sqrt() * gauss(), 0.0)
            } else {
                (power / 2.0).sqrt() * Complex64::new(gauss(), gauss())
            };
        }
        let mut history = dft::inverse(&lines, n_total);
        history.truncate(n);
        history
    }

    pub(super) fn name(&self) -> String {
        match &self.0 {
            Shape::White { density } => format!("white noise of {density:e} unit^2/Hz"),
            Shape::PowerLaw {
                density,
                at_hz,
                exponent,
                flat_below_hz,
            } => format!(
                "noise of {density:e} unit^2/Hz at {at_hz} Hz falling with the power {exponent} from {flat_below_hz} Hz"
            ),
            Shape::Table(rows) => format!("noise of {} tabulated densities", rows.len()),
        }
    }
}

fn interpolated(rows: &[[f64; 2]], frequency_hz: f64) -> f64 {
    let above = rows.partition_point(|[f, _]| *f <= frequency_hz);
    let below = above.checked_sub(1).and_then(|index| rows.get(index));
    match (below, rows.get(above)) {
        (Some([f0, s0]), Some([f1, s1])) => {
            let part = (frequency_hz / f0).ln() / (f1 / f0).ln();
            s0 * (s1 / s0).powf(part)
        }
        (Some([_, density]), None) | (None, Some([_, density])) => *density,
        (None, None) => 0.0, // a table is never empty
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_are_power_laws_between_rows() {
        let table = NoiseSpectrum::table(&[[10.0, 4.0], [1000.0, 0.04]]).unwrap();
        // two decades of density over two decades of frequency: 1/f
        for (f, expected) in [
            (1.0, 4.0),
            (10.0, 4.0),
            (100.0, 0.4),
            (1000.0, 0.04),
            (1e5, 0.04),
        ] {
            assert!((table.density(f) / expected - 1.0).abs() < 1e-14, "{f}");
        }
        let pink = NoiseSpectrum::power_law(4.0, 10.0, 1.0, 2.0).unwrap();
        assert!((pink.density(100.0) / 0.4 - 1.0).abs() < 1e-14);
        assert!((pink.density(0.0) / 20.0 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn impossible_spectra_are_refused() {
        assert!(NoiseSpectrum::white(-1.0).is_err());
        assert!(NoiseSpectrum::table(&[]).is_err());
        assert!(NoiseSpectrum::table(&[[2.0, 1.0], [2.0, 1.0]]).is_err());
        assert!(NoiseSpectrum::table(&[[0.0, 1.0]]).is_err());
        assert!(NoiseSpectrum::power_law(1.0, 1.0, 5.0, 1.0).is_err());
    }
}
