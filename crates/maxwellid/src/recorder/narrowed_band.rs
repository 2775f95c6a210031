//! Sensitivity of an estimate to the upper part of the band of its recorder.
//!
//! The bias of a nonlinear law due to a filter, see [`RecorderCheck`](super::RecorderCheck), grows
//! as the band narrows. Here both histories pass a further zero-phase low-pass filter, at [`KEPT`]
//! of the cut-off, and the law is fitted to them again. If this filter removes only noise, the two
//! estimates differ only by chance. If the estimate on the whole band is efficient, the variance of
//! the difference is the difference of the variances (Hausman, *Econometrica* **46** (1978) 1251):
//!
//! ```text
//! z = (θ_n - θ) / √(σ_n² - σ²)
//! ```
//!
//! # Validity
//! σ_n² - σ² is replaced by [`LEAST_SHARE`]² σ² if it is smaller, so that a difference within the
//! error of the estimate itself raises no alarm. A parameter whose error on the narrower band
//! exceeds [`IDENTIFIED_BELOW`] is omitted. The test does not detect the loss above the cut-off,
//! only the loss between [`KEPT`] of the cut-off and the cut-off. Half of the band would be too
//! narrow: for a pulse rounded by 30 us the exponent of a Norton rod then falls by three standard
//! errors, although the whole band contains all of the signal.
//!
//! Theory: `docs/theory/identification.md#bias-due-to-the-recorders-filter`.

use rodwave::band_limited::SampledHistory;
use statrs::distribution::{ContinuousCDF, Normal};

use super::USUAL_RATIO;
use crate::error::MaxwellidError;
use crate::fit::{Course, Fit};
use crate::identifiability::{IDENTIFIED_BELOW, Noise};
use crate::identification::Identification;
use crate::model::RodModel;
use crate::noise::{HistoryNoise, TestNoise};
use crate::parallel::map_in_order;
use crate::test::{RodTest, RodTestData};

/// Fraction of the recorder's cut-off kept by the narrower band.
pub const KEPT: f64 = 0.7;

/// Probability of a false alarm over all parameters of all compared laws.
pub const LEVEL: f64 = 0.01;

/// Smallest standard error of a difference, in standard errors of the estimate.
pub const LEAST_SHARE: f64 = 1.0;

/// Edge of the stop band of the filter divided by its cut-off, where its gain is a half.
const STOP: f64 = 1.28;

/// Comparison of an estimate on the narrower band with that on the whole band.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct NarrowedBand {
    /// Name of the model.
    pub model: String,
    /// Lowest cut-off of the narrower bands \[Hz\].
    pub cutoff_hz: f64,
    /// Differences of the parameters determined by the narrower band.
    pub differences: Vec<BandDifference>,
}

/// A parameter on the narrower band and on the whole band, in the coordinate of the fit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct BandDifference {
    /// Name of the parameter.
    pub parameter: String,
    /// θ_n - θ.
    pub difference: f64,
    /// Standard error of θ.
    pub full_error: f64,
    /// Standard error of θ_n.
    pub narrow_error: f64,
}

impl BandDifference {
    /// Difference divided by its standard error.
    #[must_use]
    pub fn z(&self) -> f64 {
        let variance = self.narrow_error.powi(2) - self.full_error.powi(2);
        self.difference / variance.sqrt().max(LEAST_SHARE * self.full_error)
    }
}

impl NarrowedBand {
    /// The parameter that differs most.
    #[must_use]
    pub fn worst(&self) -> Option<&BandDifference> {
        let mut sorted: Vec<_> = self.differences.iter().collect();
        sorted.sort_by(|a, b| a.z().abs().total_cmp(&b.z().abs()));
        sorted.pop()
    }

    /// Probability that chance causes a difference this large in any of the parameters
    /// (Bonferroni); 1 if the narrower band determines none.
    #[must_use]
    pub fn p_value(&self) -> f64 {
        let z = self.worst().map_or(0.0, |worst| worst.z().abs());
        (2.0 * Normal::standard().sf(z) * self.differences.len() as f64).min(1.0)
    }

    /// Returns true if a parameter changes by more than chance permits; with `laws` compared laws a
    /// false alarm has probability [`LEVEL`].
    #[must_use]
    pub fn is_sensitive(&self, laws: usize) -> bool {
        self.p_value() * (laws as f64) < LEVEL
    }
}

/// Formats the comparison with its numbers.
impl std::fmt::Display for NarrowedBand {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Some(worst) = self.worst() else {
            return write!(
                f,
                "{}: the band up to {:.1} kHz determines none of its parameters",
                self.model,
                1e-3 * self.cutoff_hz
            );
        };
        write!(
            f,
            "{}: with both histories low-passed at {:.1} kHz, {KEPT} of the cut-off of the recorder, the {} changes by {:.1} of its standard errors, {:.1} times the scatter of such changes by noise \
             (probability of a larger change: {:.2})",
            self.model,
            1e-3 * self.cutoff_hz,
            worst.parameter.trim_start_matches("ln_").replace('_', " "),
            worst.difference / worst.full_error,
            worst.z().abs(),
            self.p_value()
        )
    }
}

impl<M: RodModel + Clone> Fit<M> {
    /// Fits the model to `tests` on [`KEPT`] of their band, starting from `found`, and compares the
    /// estimates. `cutoffs_hz` are the cut-offs of the recorders of the tests \[Hz\], `None` for a
    /// recorder that is part of the model or whose cut-off is not known. If the recorder is part of
    /// the model, the further filter becomes part of it too.
    ///
    /// # Errors
    /// The errors of [`Fit::to`]; [`MaxwellidError::NoiseUnknown`] without stated noise;
    /// [`MaxwellidError::Decomposition`] where the errors of either fit cannot be found.
    pub fn on_narrowed_band(
        &self,
        found: &Identification<M>,
        tests: &[RodTest],
        cutoffs_hz: &[Option<f64>],
    ) -> Result<NarrowedBand, MaxwellidError> {
        let cutoffs: Vec<f64> = tests
            .iter()
            .enumerate()
            .map(|(index, test)| {
                let usual = test.sampling_rate_hz / USUAL_RATIO;
                let of_model = test.unfiltered_excitation();
                let of_model = of_model.map(|unfiltered| unfiltered.filter().cutoff_hz());
                let stated = cutoffs_hz.get(index).copied().flatten().or(of_model);
                KEPT * stated.unwrap_or(usual).min(usual)
            })
            .collect();
        let pairs: Vec<(&RodTest, &f64)> = tests.iter().zip(&cutoffs).collect();
        let narrow = map_in_order(&pairs, |(test, cutoff)| low_passed(test, **cutoff));
        let narrow = narrow.into_iter().collect::<Result<Vec<_>, _>>()?;
        let fit = self.clone().with_cell(found.cell());
        fit.check_all(&narrow)?;
        let narrowed = fit.lowest_from(&narrow, found.parameters(), Course::default())?;
        let narrowed = fit.concluded(narrowed);
        let errors = |of: &Identification<M>| {
            of.identifiability(Noise::Stated)
                .map(|judged| judged.coordinate_errors)
                .ok_or(MaxwellidError::Decomposition {
                    iteration: of.iterations(),
                })
        };
        let names = found.model().parameter_names();
        let values = narrowed.parameters().iter().zip(found.parameters());
        let errors = errors(&narrowed)?.into_iter().zip(errors(found)?);
        let differences = names
            .iter()
            .zip(values)
            .zip(errors)
            .map(
                |((name, (other, full)), (narrow_error, full_error))| BandDifference {
                    parameter: (*name).to_owned(),
                    difference: other - full,
                    full_error,
                    narrow_error,
                },
            )
            .filter(|difference| difference.narrow_error < IDENTIFIED_BELOW)
            .collect();
        Ok(NarrowedBand {
            model: found.model().name().to_owned(),
            cutoff_hz: cutoffs.into_iter().fold(f64::INFINITY, f64::min),
            differences,
        })
    }
}

/// Filters both histories by a zero-phase low-pass that passes half of the amplitude at `cutoff`
/// [Hz], and decimates them.
#[allow(
    clippy::indexing_slicing,
    reason = "kept samples end half of the filter before the record does"
)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cut-off is above 0 and below 0.28 of the sampling rate, and sample counts are far below 2^52"
)]
fn low_passed(test: &RodTest, cutoff: f64) -> Result<RodTest, MaxwellidError> {
    let noise = test.noise().ok_or_else(|| MaxwellidError::NoiseUnknown {
        test: test.name().to_owned(),
    })?;
    let share = cutoff / test.sampling_rate_hz;
    let keep = ((0.5 / (STOP * share)).floor() as usize).max(1);
    let taps = taps(share);
    let reach = taps.len() / 2;
    let count = test.excitation_samples.len();
    let kept = count.saturating_sub(reach).div_ceil(keep);
    let filtered = |samples: &[f64]| -> Vec<f64> {
        (0..kept)
            .map(|k| {
                let at = k * keep + reach;
                let terms = taps.iter().enumerate();
                // the rod is at rest before the record
                terms
                    .filter_map(|(j, h)| Some(h * samples.get(at.checked_sub(j)?)?))
                    .sum()
            })
            .collect()
    };
    let of_history = |noise: &HistoryNoise| HistoryNoise::Coloured {
        autocovariance: covariance_through(noise, &taps, keep, kept),
    };
    let narrow = RodTest::new(RodTestData {
        name: test.name.clone(),
        length: test.length,
        density: test.density,
        impact_velocity: test.impact_velocity,
        sampling_rate_hz: test.sampling_rate_hz / keep as f64,
        excitation: filtered(&test.excitation_samples),
        response: filtered(&test.response),
        provenance: test.provenance.clone(),
    })?
    .with_history_noise(TestNoise {
        excitation: of_history(&noise.excitation),
        response: of_history(&noise.response),
    })?;
    let narrow = match test.unfiltered_excitation() {
        // the filter of the recorder followed by this one
        Some(unfiltered) => {
            let seen = unfiltered.observations();
            let seen = seen.map(|seen| seen.followed_by(&taps, keep));
            narrow.seen_through(unfiltered.filter(), seen)?
        }
        None => narrow,
    };
    // the window still ends at the requested end or at a clipped sample
    let window = (test.window.saturating_sub(1) / keep + 1)
        .min(kept.saturating_sub(SampledHistory::HALF_WIDTH));
    Ok(RodTest {
        window,
        common_errors: test.common_errors.clone(),
        ..narrow
    })
}

/// Weights of a windowed sinc (Hamming): gain 1 at frequency 0, a half at the fraction `share` of
/// the sampling rate, and less than 0.3 % above [`STOP`] times this frequency.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share is at least 1e-9 or so; some hundred taps"
)]
fn taps(share: f64) -> Vec<f64> {
    // the width of the transition band is 3.3 times the sampling rate over the number of taps
    let reach = (0.5 * 3.3 / (2.0 * (STOP - 1.0) * share)).ceil() as usize;
    let raw: Vec<f64> = (0..=2 * reach)
        .map(|j| {
            let x = j as f64 - reach as f64;
            let phase = std::f64::consts::TAU * share * x;
            let sinc = if j == reach { 1.0 } else { phase.sin() / phase };
            sinc * (0.54 + 0.46 * (std::f64::consts::PI * x / (reach as f64 + 1.0)).cos())
        })
        .collect();
    let sum: f64 = raw.iter().sum();
    raw.into_iter().map(|h| h / sum).collect()
}

/// Autocovariance of filtered noise of which every `keep`-th sample is kept, up to `lags`.
fn covariance_through(noise: &HistoryNoise, taps: &[f64], keep: usize, lags: usize) -> Vec<f64> {
    let of_taps: Vec<f64> = (0..taps.len())
        .map(|lag| {
            taps.iter()
                .zip(taps.iter().skip(lag))
                .map(|(a, b)| a * b)
                .sum()
        })
        .collect();
    (0..lags)
        .map(|k| {
            let at = k * keep;
            let terms = of_taps.iter().enumerate();
            terms
                .map(|(m, h)| {
                    let below = h * noise.autocovariance(at.abs_diff(m));
                    if m == 0 {
                        below
                    } else {
                        below + h * noise.autocovariance(at + m)
                    }
                })
                .sum()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// |Σ h_j e^{-iωj}| of a filter that is even about its middle.
    fn gain(taps: &[f64], frequency: f64) -> f64 {
        let middle = 0.5 * (taps.len() as f64 - 1.0);
        let terms = taps.iter().enumerate();
        terms
            .map(|(j, h)| h * (std::f64::consts::TAU * frequency * (j as f64 - middle)).cos())
            .sum()
    }

    #[test]
    fn r02_the_filter_passes_its_band_and_no_more() {
        for share in [0.07, 0.2, 0.7 / 2.56] {
            let taps = taps(share);
            assert!((gain(&taps, 0.0) - 1.0).abs() < 1e-12);
            // tolerance: the gain at the cut-off is a half only for a window that is narrow
            // compared with the band
            assert!((gain(&taps, share) - 0.5).abs() < 5e-3, "{share}");
            // tolerance: the side lobes of a Hamming window are at -53 dB, and add up to twice this
            // at the edge of the pass band
            for k in 0..200 {
                let beyond = STOP * share + (0.5 - STOP * share) * f64::from(k) / 200.0;
                assert!(gain(&taps, beyond).abs() < 3e-3, "{share} {beyond}");
                let within = (2.0 - STOP) * share * f64::from(k) / 200.0;
                assert!((gain(&taps, within) - 1.0).abs() < 6e-3, "{share} {within}");
            }
        }
    }

    /// Compares the autocovariance after the filter with the transform of |gain|² times the
    /// spectral density of the noise, by the trapezoidal rule over a period, which is exact for a
    /// trigonometric polynomial.
    #[test]
    fn r02_noise_behind_the_filter_is_that_of_its_spectrum() {
        let noise = HistoryNoise::Coloured {
            autocovariance: vec![2.0, -0.7, 0.1],
        };
        let taps = taps(0.1);
        let density = |f: f64| {
            let wave = |lag: f64| (std::f64::consts::TAU * f * lag).cos();
            2.0 - 1.4 * wave(1.0) + 0.2 * wave(2.0)
        };
        let found = covariance_through(&noise, &taps, 3, 8);
        for (k, found) in found.iter().enumerate() {
            let lines = 1000;
            let expected: f64 = (0..lines)
                .map(|j| f64::from(j) / f64::from(lines))
                .map(|f| {
                    let turn = (std::f64::consts::TAU * f * 3.0 * k as f64).cos();
                    gain(&taps, f).powi(2) * density(f) * turn / f64::from(lines)
                })
                .sum();
            assert!((found - expected).abs() < 1e-12, "{k}: {found} {expected}");
        }
    }

    #[test]
    fn r02_differences_are_judged_by_their_own_error() {
        let band = |difference: f64, full_error: f64, narrow_error: f64| NarrowedBand {
            model: "law".into(),
            cutoff_hz: 1e4,
            differences: vec![
                BandDifference {
                    parameter: "exponent".into(),
                    difference,
                    full_error,
                    narrow_error,
                },
                BandDifference {
                    parameter: "ln_modulus".into(),
                    difference: 0.0,
                    full_error,
                    narrow_error,
                },
            ],
        };
        // errors of 0.03 and 0.05 give a standard error of 0.04 of the difference; with two
        // parameters a level of 0.01 leaves each a probability of 0.005, outside ±2.807
        assert!((band(0.04, 0.03, 0.05).differences[0].z() - 1.0).abs() < 1e-12);
        assert!(band(-0.04 * 2.82, 0.03, 0.05).is_sensitive(1));
        assert!(!band(-0.04 * 2.80, 0.03, 0.05).is_sensitive(1));
        assert!(!band(-0.04 * 2.82, 0.03, 0.05).is_sensitive(2));
        // equal errors: the standard error of the difference is that of the estimate
        assert!((band(0.03, 0.03, 0.03).differences[0].z() - 1.0).abs() < 1e-12);
        let said = band(-0.4, 0.03, 0.05).to_string();
        assert!(
            said.contains("10.0 kHz") && said.contains("exponent"),
            "{said}"
        );
    }
}
