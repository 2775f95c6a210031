//! Error of a reconstructed force from blows with a measured force.

use std::ops::Range;

use num_complex::Complex64;

use super::mean_blow;
use crate::error::{check_enough, check_length};
use crate::{ForceError, ForceHistory, ImpulseError, fourier};

/// Fraction of the largest force below which samples give the force-independent part of the error.
const WITHOUT_FORCE: f64 = 0.05;

/// A blow whose force is both measured and reconstructed.
#[derive(Debug, Clone, Copy)]
pub struct CalibrationBlow<'a> {
    /// Force reconstructed from the response, with a frequency response to which the blow has not
    /// contributed.
    pub reconstructed: &'a ForceHistory,
    /// Measured force at the same times \[N\]; `(n_samples)`.
    pub measured: &'a [f64],
    /// Standard errors of the reconstructed force \[N\], if known; `(n_samples)`.
    pub standard_error: Option<&'a [f64]>,
}

/// The scatter between blows, $`\sigma^2(t) = a^2 + b^2F^2(t)`$.
///
/// The variance of an averaged frequency response treats the errors of its lines as independent.
/// Differences between blows, such as those of position and direction, change all lines together
/// and dominate the error unless the blows are alike. Blows with a measured force reveal this: each
/// is reconstructed with the frequency response of the others, and its difference from the measured
/// force is the error itself.
///
/// # Validity
///
/// The evaluated blow must be like the calibration blows. Errors within one blow are correlated, so
/// that the number of degrees of freedom is the number of blows minus one, and bands use Student's
/// distribution. The correlation of the error over time is not known from so few blows; draws treat
/// the samples as independent, so that a simultaneous band is somewhat too wide.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CalibrationScatter {
    /// Error a \[N\]: root mean square error where the force is nearly zero.
    pub without_force: f64,
    /// Error b proportional to the force, relative to it.
    pub relative: f64,
    /// Root mean square of the relative errors of the impulses.
    pub relative_impulse: f64,
    /// Mean square of the ratio of the errors to the stated standard errors: 1 if noise is the only
    /// cause. `None` if no errors were stated.
    pub over_stated: Option<f64>,
    /// Number of blows.
    pub n_blows: usize,
}

impl CalibrationScatter {
    /// Estimates the scatter of `blows` over the samples `window`, which must contain the force of
    /// all of them.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::TooShort`] for fewer than three blows, or if no blow has samples in the
    /// window with or without force; [`ImpulseError::LengthMismatch`]; [`ImpulseError::NonFinite`]
    /// for a measured force.
    pub fn of(blows: &[CalibrationBlow<'_>], window: Range<usize>) -> Result<Self, ImpulseError> {
        check_enough("set of calibration blows", blows.len(), 3)?;
        let (mut quiet, mut n_quiet) = (0.0, 0_usize);
        let (mut loud, mut n_loud, mut force_squares) = (0.0, 0_usize, 0.0);
        let (mut impulses, mut over_stated, mut n_stated) = (0.0, 0.0, 0_usize);
        for blow in blows {
            let found = blow.reconstructed.force();
            check_length("measured force", blow.measured.len(), found.len())?;
            crate::error::check_samples("measured force", blow.measured)?;
            let sum = |samples: &[f64]| -> f64 {
                samples
                    .get(window.start..window.end.min(samples.len()))
                    .unwrap_or_default()
                    .iter()
                    .sum()
            };
            impulses += (sum(found) / sum(blow.measured) - 1.0).powi(2);
            let stated = blow.standard_error.unwrap_or_default().iter();
            let stated = stated.zip(found.iter().zip(blow.measured));
            for (error, (found, measured)) in stated.skip(window.start).take(window.len()) {
                if *error > 0.0 {
                    over_stated += ((found - measured) / error).powi(2);
                    n_stated += 1;
                }
            }
            let limit = WITHOUT_FORCE * blow.reconstructed.peak().force;
            let samples = found.iter().zip(blow.measured);
            for (found, measured) in samples.skip(window.start).take(window.len()) {
                let square = (found - measured).powi(2);
                if found.abs() < limit {
                    quiet += square;
                    n_quiet += 1;
                } else {
                    loud += square;
                    n_loud += 1;
                    force_squares += found * found;
                }
            }
        }
        for (what, found) in [
            ("window of calibration blows without force", n_quiet),
            ("window of calibration blows with force", n_loud),
        ] {
            check_enough(what, found, 1)?;
        }
        let additive = quiet / n_quiet as f64;
        // an error during the force that is smaller than the error without force is due to the
        // scatter of the estimate
        let with_force = (loud - additive * n_loud as f64).max(0.0);
        let scatter = Self {
            without_force: additive.sqrt(),
            relative: (with_force / force_squares).sqrt(),
            relative_impulse: (impulses / blows.len() as f64).sqrt(),
            over_stated: (n_stated > 0).then(|| over_stated / n_stated as f64),
            n_blows: blows.len(),
        };
        if scatter.without_force.is_finite() && scatter.relative.is_finite() {
            Ok(scatter)
        } else {
            Err(ImpulseError::OutOfRange {
                what: "scatter of the calibration blows",
            })
        }
    }

    /// Returns the error of `history`, reconstructed like the blows, over the samples `window`: the
    /// error `known` from noise and the shape of the blow and, where that is smaller than the
    /// scatter, an independent error that makes up the difference. Without a known error, the error
    /// is zero outside the window.
    #[must_use]
    pub fn error(
        &self,
        history: &ForceHistory,
        window: Range<usize>,
        known: Option<&ForceError>,
    ) -> ForceError {
        let force = history.force();
        // the part of the window within the record
        let first = window.start.min(force.len());
        let window = first..window.end.clamp(first, force.len());
        let inside = force.get(window.clone()).unwrap_or_default();
        let none = ForceError::none(force.len());
        let known = known.unwrap_or(&none);
        let errors = inside
            .iter()
            .zip(known.standard_error().iter().skip(first))
            .map(|(f, known)| {
                let scatter = self.without_force.hypot(self.relative * f);
                (scatter.powi(2) - known.powi(2)).max(0.0).sqrt()
            });
        let errors = errors.collect();
        known
            .clone()
            .with_independent(window.start, errors)
            .with_degrees_of_freedom(self.n_blows as f64 - 1.0)
    }
}

/// Number of lines on either side over which the noise between blows is averaged.
const NEIGHBOURS: usize = 8;

/// Errors of the response to one blow and of the average frequency response, line by line, from the
/// scatter between calibration blows.
///
/// For $`n`$ blows with the spectra $`\hat F_{ik} = \sum_m F_{im} e^{-2\pi ikm/N}`$
///
/// ```math
/// \mathrm E|\delta\hat x_k|^2 = \mathrm{var}\,\bar H_k \sum_i |\hat F_{ik}|^2,
/// ```
///
/// with the left side averaged over 17 lines: with few blows the scatter of one line is known only
/// to a factor of two, and its use as a weight would favour lines of underestimated scatter.
/// Changes of position and direction of the blow change the response on each line in proportion to
/// its size.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CalibrationLines {
    /// Noise of the response to one blow, for
    /// [`ResponseNoise::Lines`](crate::ResponseNoise::Lines); NaN where the variance is not known.
    pub noise: Vec<f64>,
    /// Variance of the average frequency response, for
    /// [`Sensor::with_variance`](crate::Sensor::with_variance).
    pub variance: Vec<f64>,
    /// Mean power of the forces \[N²\], for
    /// [`Reconstruction::like_blows`](crate::Reconstruction::like_blows).
    pub power: Vec<f64>,
    /// Mean spectrum of the forces \[N\], the common part of the blows. Each force is moved to the
    /// time and scaled to the size of the hardest blow, and stretched to the mean duration.
    pub mean_blow: Vec<Complex64>,
    /// Spectra of the differences of these forces from the mean \[N\].
    pub differences: Vec<Vec<Complex64>>,
}

impl CalibrationLines {
    /// Computes the lines from the `forces` \[N\] of blows whose average frequency response has
    /// this `variance`.
    ///
    /// | array | shape | unit |
    /// |---|---|---|
    /// | variance | `(n_lines)`, of the average, NaN where it is not known | square of response over force |
    /// | force | `(n_samples)` each | N |
    ///
    /// # Errors
    ///
    /// [`ImpulseError::TooShort`] for fewer than two blows; [`ImpulseError::LengthMismatch`];
    /// [`ImpulseError::NonFinite`] for a force.
    pub fn of(variance: &[f64], forces: &[&[f64]]) -> Result<Self, ImpulseError> {
        let n_blows = forces.len();
        check_enough("set of calibration blows", n_blows, 2)?;
        let mut energy = vec![0.0; variance.len()];
        let mut spectra = Vec::with_capacity(forces.len());
        for force in forces {
            check_length(
                "variance of the frequency response",
                variance.len(),
                force.len() / 2 + 1,
            )?;
            crate::error::check_samples("force of a calibration blow", force)?;
            let spectrum = fourier::to_spectrum(force);
            for (sum, line) in energy.iter_mut().zip(&spectrum) {
                *sum += line.norm_sqr();
            }
            spectra.push(spectrum);
        }
        let n_blows = n_blows as f64;
        let lines = variance.iter().zip(&energy);
        let single: Vec<f64> = lines.map(|(v, energy)| v * energy).collect();
        let noise: Vec<f64> = (0..single.len())
            .map(|line| {
                let first = line.saturating_sub(NEIGHBOURS);
                let about = single
                    .iter()
                    .skip(first)
                    .take(line + NEIGHBOURS + 1 - first);
                let known = about.filter(|noise| noise.is_finite());
                let (n, sum) = known.fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v));
                if single.get(line).is_some_and(|noise| noise.is_finite()) {
                    sum / n
                } else {
                    f64::NAN
                }
            })
            .collect();
        let n_samples = forces.first().map_or(0, |force| force.len());
        let (mean_blow, differences) = mean_blow::of(&spectra, n_samples);
        Ok(Self {
            mean_blow,
            differences,
            variance: noise.iter().zip(&energy).map(|(v, e)| v / e).collect(),
            power: energy.iter().map(|energy| energy / n_blows).collect(),
            noise,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r22_the_noise_of_lines_is_the_scatter_of_single_blows() {
        // unit impulses have the same power 1 on all lines; four blows, and a variance of the
        // average of 0.5
        let force: &[f64] = &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let lines = CalibrationLines::of(&[0.5; 5], &[force; 4]).unwrap();
        for ((noise, variance), power) in lines.noise.iter().zip(&lines.variance).zip(&lines.power)
        {
            // noise 4 · 0.5, variance a quarter of it, power 1
            assert!((noise - 2.0).abs() < 1e-12, "{noise}");
            assert!((variance - 0.5).abs() < 1e-12, "{variance}");
            assert!((power - 1.0).abs() < 1e-12, "{power}");
        }
        // the noise is the mean over the known lines, and NaN on an unknown line
        let lines = CalibrationLines::of(&[0.2, 0.4, f64::NAN, 0.6, 0.8], &[force; 4]).unwrap();
        assert!((lines.noise[0] - 2.0).abs() < 1e-12 && lines.noise[2].is_nan());
        assert!(CalibrationLines::of(&[0.5; 5], &[force; 1]).is_err());
        assert!(CalibrationLines::of(&[0.5; 4], &[force; 2]).is_err());
    }

    #[test]
    fn the_two_parts_of_a_known_scatter_come_back() {
        // errors of 2 N everywhere and of 3 % of the force, of alternating sign, so that nothing is
        // random
        let force: Vec<f64> = (0..60).map(|n| if n < 20 { 0.0 } else { 500.0 }).collect();
        let blows: Vec<(ForceHistory, Vec<f64>)> = [1.0, -1.0, 1.0, -1.0]
            .into_iter()
            .map(|sign| {
                let measured = force.iter().enumerate().map(|(n, f)| {
                    let size = 2.0_f64.hypot(0.03 * f);
                    f + if n % 2 == 0 {
                        sign * size
                    } else {
                        -sign * size
                    }
                });
                let history = ForceHistory::new(0.0, 1e-3, force.clone()).unwrap();
                (history, measured.collect())
            })
            .collect();
        let blows: Vec<CalibrationBlow<'_>> = blows
            .iter()
            .map(|(reconstructed, measured)| CalibrationBlow {
                reconstructed,
                measured,
                standard_error: None,
            })
            .collect();
        let scatter = CalibrationScatter::of(&blows, 10..50).unwrap();
        assert!((scatter.without_force - 2.0).abs() < 1e-12);
        assert!((scatter.relative - 0.03).abs() < 1e-12);
        let error = scatter.error(blows[0].reconstructed, 10..50, None);
        assert!((error.standard_error()[15] - 2.0).abs() < 1e-12);
        assert!((error.standard_error()[30] - 2.0_f64.hypot(15.0)).abs() < 1e-12);
        assert!(error.standard_error()[5].abs() < f64::MIN_POSITIVE);
        // Student's factor for three degrees of freedom
        let band = error.pointwise(blows[0].reconstructed, 0.95).unwrap();
        assert!((band.factor - 3.182_446).abs() < 1e-5);
        assert!(CalibrationScatter::of(&blows[..2], 10..50).is_err());
        assert!(CalibrationScatter::of(&blows, 0..10).is_err());
    }
}
