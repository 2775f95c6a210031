//! Bias due to a recorder: check of the bandwidth of an excitation for nonlinear rods.
//!
//! Both histories pass the low-pass filter of their recorder. A linear rod commutes with this
//! filter: driven by the filtered excitation it gives the filtered response. A nonlinear rod does
//! not, because the dissipation of a front depends on its full stress, which the filter reduces.
//! From recorded excitations the exponent of a Norton rod of κ = 2.1 is estimated as 1.3 to 1.8,
//! without a conspicuous residual; with a sampling rate of 204.8 kHz and 2 % of noise E is still
//! 0.6 % low, four standard errors. The record does not contain the lost part, but it shows whether
//! the spectrum of the signal is above that of the noise just below the cut-off f_c:
//!
//! ```text
//! R = Σ P(f) / Σ P_noise(f) - 1 ,    0.6 f_c <= f <= f_c
//! ```
//!
//! with P the periodogram of the excitation, continued by its mirror image, and P_noise that of its
//! noise. If R is above three of its standard errors √(2/n), with n frequency lines, or above 1, no
//! parameter of a nonlinear law is reliable.
//!
//! # Validity
//! The noise must be stated ([`RodTest::with_noise`] and similar methods). A signal below a third
//! of the noise is not detected, and may still bias E by a standard error: [`NarrowedBand`] tests
//! the estimate itself. The default cut-off is the usual one of recorders, the sampling rate
//! divided by 2.56.
//!
//! Where the filter is known, [`RodTest::with_recorder`] makes it part of the model, and the check
//! is unnecessary.
//!
//! Theory: `docs/theory/identification.md#bias-due-to-the-recorders-filter`.

mod contact;
mod filter;
mod front;
mod later_fronts;
mod narrowed_band;
mod unfiltered;

pub use filter::RecorderFilter;
pub use narrowed_band::{BandDifference, KEPT, LEAST_SHARE, LEVEL, NarrowedBand};
pub use unfiltered::{LONGEST_RECORD, UnfilteredExcitation};

pub(crate) use unfiltered::Drive;

use crate::error::MaxwellidError;
use crate::test::RodTest;
use crate::whitening::mirrored_spectrum;

/// Usual ratio of the sampling rate of a recorder to its cut-off.
pub const USUAL_RATIO: f64 = 2.56;

/// Lower end of the band in which the power is summed, as a fraction of the cut-off.
pub const FROM: f64 = 0.6;

/// Check of a recorder by the spectrum of an excitation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RecorderCheck {
    /// Name of the test.
    pub test: String,
    /// Cut-off of the recorder \[Hz\].
    pub cutoff_hz: f64,
    /// True if the cut-off is assumed from the sampling rate.
    pub is_assumed: bool,
    /// Power of the signal divided by that of the noise, from 0.6 of the cut-off to the cut-off;
    /// infinite without noise.
    pub signal_to_noise: f64,
    /// Standard error of `signal_to_noise` for a record that contains only noise.
    pub standard_error: f64,
}

impl RecorderCheck {
    /// Checks the excitation of one test for a recorder of cut-off `cutoff_hz` \[Hz\], `None` if
    /// not known.
    ///
    /// # Errors
    /// [`MaxwellidError::NoiseUnknown`] without stated noise; [`MaxwellidError::Setting`] for a
    /// cut-off that is not above 0 and at most half of the sampling rate.
    pub fn of(test: &RodTest, cutoff_hz: Option<f64>) -> Result<Self, MaxwellidError> {
        let rate = test.sampling_rate_hz;
        if let Some(value) = cutoff_hz
            && !(value > 0.0 && value <= 0.5 * rate)
        {
            return Err(MaxwellidError::Setting {
                setting: "cut-off of the recorder [Hz]",
                value,
                expected: "above 0 and at most half of the sampling rate",
            });
        }
        let noise = test.noise().ok_or_else(|| MaxwellidError::NoiseUnknown {
            test: test.name().to_owned(),
        })?;
        let cutoff = cutoff_hz.unwrap_or(rate / USUAL_RATIO);
        let lines = mirrored_spectrum(&test.excitation_samples, &noise.excitation);
        let spacing = 0.5 * rate / (lines.len().saturating_sub(1).max(1)) as f64;
        let (mut of_record, mut of_noise, mut count) = (0.0, 0.0, 0.0_f64);
        for (line, (power, expected)) in lines.iter().enumerate() {
            let frequency = line as f64 * spacing;
            if (FROM * cutoff..=cutoff).contains(&frequency) {
                of_record += power;
                of_noise += expected;
                count += 1.0;
            }
        }
        Ok(Self {
            test: test.name().to_owned(),
            cutoff_hz: cutoff,
            is_assumed: cutoff_hz.is_none(),
            // each line of the noise is the square of a normally distributed number, with a
            // relative variance of 2
            standard_error: (2.0 / count).sqrt(),
            signal_to_noise: if of_noise > 0.0 {
                of_record / of_noise - 1.0
            } else {
                f64::INFINITY
            },
        })
    }

    /// Returns true if the signal in this band exceeds three standard errors or the power of the
    /// noise.
    #[must_use]
    pub fn is_biased(&self) -> bool {
        self.signal_to_noise > (3.0 * self.standard_error).min(1.0)
    }
}

/// Formats the result and the advice in one sentence.
impl std::fmt::Display for RecorderCheck {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let cutoff = 1e-3 * self.cutoff_hz;
        let origin = if self.is_assumed {
            format!(
                "cut-off not stated, assumed {cutoff:.1} kHz, the sampling rate divided by {USUAL_RATIO}"
            )
        } else {
            format!("cut-off {cutoff:.1} kHz")
        };
        let test = &self.test;
        if self.is_biased() {
            write!(
                f,
                "test `{test}`: above {FROM} of the cut-off of its recorder the excitation itself, without its noise, has {:.1} times the power of the noise ({origin}). \
                 The filter biases all parameters of nonlinear laws: state the filter, or use a softer impact or a faster recorder",
                self.signal_to_noise
            )
        } else {
            write!(
                f,
                "test `{test}`: above {FROM} of the cut-off of its recorder the excitation has no significant part ({origin})"
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use testbed::noise::Noise;

    use super::*;
    use crate::test::{Provenance, RodTestData};

    const RATE: f64 = 51_200.0;

    /// A front that rises as the integral of a normal density of `width` \[s\], with 0.8 % of
    /// noise.
    fn front(width: f64, seed: u64) -> RodTest {
        let mut noise = Noise::seeded(seed);
        let mut history = |delay: f64| -> Vec<f64> {
            (0..160)
                .map(|k| {
                    let t = (f64::from(k) - 64.0) / RATE - delay;
                    let rise = 0.5 * statrs::function::erf::erfc(-t / (width * 2.0_f64.sqrt()));
                    10.0 * rise * (-t.max(0.0) / 1e-3).exp() + 0.08 * noise.normal()
                })
                .collect()
        };
        RodTest::new(RodTestData {
            name: "front".into(),
            length: 0.4,
            density: 1000.0,
            impact_velocity: 10.0,
            sampling_rate_hz: RATE,
            excitation: history(0.0),
            response: history(2.5e-4),
            provenance: Provenance::Measured,
        })
        .unwrap()
        .with_noise(0.08, 0.08)
        .unwrap()
    }

    /// Checks a steep and a smooth front: the spectrum falls by exp(-(2π f σ)²/2), which at 12 kHz
    /// is 0.8 for σ = 8 us and 1e-5 for 64 us.
    #[test]
    fn r02_a_sharp_front_is_biased_and_a_smooth_one_is_not() {
        for seed in 0..20 {
            let sharp = RecorderCheck::of(&front(8e-6, seed), None).unwrap();
            assert!(sharp.is_biased(), "{sharp}");
            assert!(
                sharp.is_assumed && sharp.to_string().contains("20.0 kHz"),
                "{sharp}"
            );
            let smooth = RecorderCheck::of(&front(64e-6, seed), Some(17_900.0)).unwrap();
            assert!(!smooth.is_biased(), "{smooth}");
            // twenty tests of about forty lines each
            assert!(smooth.signal_to_noise.abs() < 0.8, "{smooth}");
        }
    }

    #[test]
    fn r02_a_cut_off_beyond_half_of_the_rate_is_refused() {
        for cutoff in [0.0, -1.0, f64::NAN, 26e3] {
            assert!(matches!(
                RecorderCheck::of(&front(64e-6, 1), Some(cutoff)),
                Err(MaxwellidError::Setting { .. })
            ));
        }
    }
}
