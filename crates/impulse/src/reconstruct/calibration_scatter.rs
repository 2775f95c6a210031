//! What blows of which the force was measured say about the error of a reconstructed one.

use std::ops::Range;

use crate::{ForceError, ForceHistory, ImpulseError, fourier};

/// Samples below this part of the largest force tell the part of the error that is there without force.
const WITHOUT_FORCE: f64 = 0.05;

/// A blow of which the force is known twice.
#[derive(Debug, Clone, Copy)]
pub struct CalibrationBlow<'a> {
    /// Reconstructed from its response, by a frequency response to which it has not contributed.
    pub reconstructed: &'a ForceHistory,
    /// As measured, at the same times \[N\]; `(n_samples)`.
    pub measured: &'a [f64],
}

/// The scatter between blows, $`\sigma^2(t) = a^2 + b^2F^2(t)`$.
///
/// The variance of an averaged frequency response takes the errors of its lines as independent of each other. What differs from blow to
/// blow, as the place and direction of the hit, moves all lines together, and where few blows are alike it is most of the error.
/// Blows with a measured force show it: each is reconstructed from the others, and what it misses is the error itself.
///
/// # Validity
///
/// The blow in question is like the others. Errors within one blow go together, so that the number of degrees of freedom is that of the
/// blows less one, and bands are Student's. How the error of the next blow hangs together over time is not known from so
/// few; draws of it take the samples as independent, and only pointwise bands are meant.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CalibrationScatter {
    /// a \[N\]: root mean square error where there is hardly any force.
    pub without_force: f64,
    /// b: the error that comes with the force, relative to it.
    pub relative: f64,
    /// Number of blows.
    pub n_blows: usize,
}

impl CalibrationScatter {
    /// The scatter of `blows` over the samples `window`, which holds the force of all of them.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::TooShort`] below three blows, or if no blow has samples in the window with or without force;
    /// [`ImpulseError::LengthMismatch`]; [`ImpulseError::NonFinite`] for a measured force.
    pub fn of(blows: &[CalibrationBlow<'_>], window: Range<usize>) -> Result<Self, ImpulseError> {
        if blows.len() < 3 {
            return Err(ImpulseError::TooShort {
                what: "set of calibration blows",
                found: blows.len(),
                expected: 3,
            });
        }
        let (mut quiet, mut n_quiet) = (0.0, 0_usize);
        let (mut loud, mut n_loud, mut force_squares) = (0.0, 0_usize, 0.0);
        for blow in blows {
            let found = blow.reconstructed.force();
            if found.len() != blow.measured.len() {
                return Err(ImpulseError::LengthMismatch {
                    what: "measured force",
                    found: blow.measured.len(),
                    expected: found.len(),
                });
            }
            crate::error::check_samples("measured force", blow.measured)?;
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
            if found == 0 {
                return Err(ImpulseError::TooShort {
                    what,
                    found,
                    expected: 1,
                });
            }
        }
        let additive = quiet / n_quiet as f64;
        // an error with force below the one without is scatter of the estimate
        let with_force = (loud - additive * n_loud as f64).max(0.0);
        let scatter = Self {
            without_force: additive.sqrt(),
            relative: (with_force / force_squares).sqrt(),
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

    /// The error of `history`, reconstructed as the blows were, over the samples `window`; outside it is nothing.
    #[must_use]
    pub fn error(&self, history: &ForceHistory, window: Range<usize>) -> ForceError {
        let force = history.force();
        // what of the window lies in the record
        let first = window.start.min(force.len());
        let window = first..window.end.clamp(first, force.len());
        let inside = force.get(window.clone()).unwrap_or_default();
        let errors = inside
            .iter()
            .map(|f| self.without_force.hypot(self.relative * f));
        ForceError::none(force.len())
            .with_independent(window.start, errors.collect())
            .with_degrees_of_freedom(self.n_blows as f64 - 1.0)
    }
}

/// Noise $`\mathrm E|\delta\hat x_k|^2`$ of the lines of the response to one blow, by the scatter between the `forces` \[N\] of calibration blows whose average
/// frequency response has this `variance`: with $`n`$ blows
///
/// ```math
/// \mathrm E|\delta\hat x_k|^2 = \frac{n^2}{n-1}\,\mathrm{var}\,\bar H_k\;\overline{|\hat F_k|^2}, \qquad \hat F_k = \sum_m F_m e^{-2\pi ikm/N} .
/// ```
///
/// Place and direction of a blow change the response itself, line by line and in proportion to it. As [`ResponseNoise::Lines`](crate::ResponseNoise::Lines) it keeps
/// lines that differ from blow to blow, and those that the average knows badly, from ruling a force on a support.
///
/// | array | shape | unit |
/// |---|---|---|
/// | variance | `(n_lines)`, of the average, NaN where it is not known | square of response over force |
/// | force | `(n_samples)` each | N |
///
/// # Errors
///
/// [`ImpulseError::TooShort`] below two blows; [`ImpulseError::LengthMismatch`]; [`ImpulseError::NonFinite`] for a force.
pub fn noise_between_blows(variance: &[f64], forces: &[&[f64]]) -> Result<Vec<f64>, ImpulseError> {
    let n_blows = forces.len();
    if n_blows < 2 {
        return Err(ImpulseError::TooShort {
            what: "set of calibration blows",
            found: n_blows,
            expected: 2,
        });
    }
    let mut power = vec![0.0; variance.len()];
    for force in forces {
        if force.len() / 2 + 1 != variance.len() {
            return Err(ImpulseError::LengthMismatch {
                what: "variance of the frequency response",
                found: variance.len(),
                expected: force.len() / 2 + 1,
            });
        }
        crate::error::check_samples("force of a calibration blow", force)?;
        for (sum, line) in power.iter_mut().zip(fourier::to_spectrum(force)) {
            *sum += line.norm_sqr();
        }
    }
    // mean of the power, and the variance of one blow from that of the average
    let n_blows = n_blows as f64;
    let of_one = n_blows / (n_blows - 1.0);
    let lines = variance.iter().zip(power);
    Ok(lines
        .map(|(variance, power)| of_one * variance * power)
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r22_the_noise_of_lines_is_the_scatter_of_single_blows() {
        // unit impulses have the same power 1 on all lines; four blows, and a variance of the average of 0.5
        let force: &[f64] = &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let noise = noise_between_blows(&[0.5; 5], &[force; 4]).unwrap();
        for line in noise {
            // 16/3 · 0.5
            assert!((line - 8.0 / 3.0).abs() < 1e-12, "{line}");
        }
        assert!(noise_between_blows(&[0.5; 5], &[force; 1]).is_err());
        assert!(noise_between_blows(&[0.5; 4], &[force; 2]).is_err());
    }

    #[test]
    fn the_two_parts_of_a_known_scatter_come_back() {
        // errors of 2 N everywhere and of 3 % of the force, of alternating sign, so that there is no chance in it
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
            })
            .collect();
        let scatter = CalibrationScatter::of(&blows, 10..50).unwrap();
        assert!((scatter.without_force - 2.0).abs() < 1e-12);
        assert!((scatter.relative - 0.03).abs() < 1e-12);
        let error = scatter.error(blows[0].reconstructed, 10..50);
        assert!((error.standard_error()[15] - 2.0).abs() < 1e-12);
        assert!((error.standard_error()[30] - 2.0_f64.hypot(15.0)).abs() < 1e-12);
        assert!(error.standard_error()[5].abs() < f64::MIN_POSITIVE);
        // three degrees of freedom
        let band = error.pointwise(blows[0].reconstructed, 0.95).unwrap();
        assert!((band.factor - 3.182_446).abs() < 1e-5);
        assert!(CalibrationScatter::of(&blows[..2], 10..50).is_err());
        assert!(CalibrationScatter::of(&blows, 0..10).is_err());
    }
}
