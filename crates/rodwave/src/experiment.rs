//! Virtual experiments: simulated records of the instruments of a test.
//!
//! Theory: `docs/theory/virtual-experiments.md`.

pub mod displacement_pair;
pub mod end_accelerations;
pub mod impact_of_two_bodies;
pub mod strains_in_a_frame;

use self::displacement_pair::DisplacementPair;
use crate::band_limited::{Recorder, SampledHistory};
use crate::error::{RodwaveError, check_steps};
use crate::impact::{ImpactBalance, ImpactTest};
use crate::inelastic::InelasticLaw;

/// Recording settings of a test of paper D.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Acquisition {
    /// Low-pass filter and sampler of both channels.
    pub recorder: Recorder,
    /// Number of samples before the impact; they should cover at least [`Recorder::reach`].
    pub samples_before: usize,
    /// Number of samples from the impact on.
    pub samples_after: usize,
    /// Range of the displacement transducers \[m\]; a section that has moved further is out of
    /// range.
    pub transducer_range: f64,
}

/// Two sampled velocity histories of a struck rod.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct VelocityRecord {
    /// Sampling rate \[Hz\].
    pub sampling_rate_hz: f64,
    /// Velocity v_e of the section near the struck end [m/s].
    pub excitation: Vec<f64>,
    /// Velocity v_r of the free end [m/s].
    pub response: Vec<f64>,
    /// The excitation before sampling: band-limited, at eight times the sampling rate. A second
    /// solver can be driven by it, without the interpolation between the samples.
    pub excitation_before_sampling: SampledHistory,
    /// Time \[s\], from the first sample, until which both displacements are within the range of
    /// the transducers.
    pub in_range_until: f64,
    /// Balances of momentum and energy of the impact.
    pub balance: ImpactBalance,
}

/// Points per sample of the excitation before sampling.
const FINER: usize = 8;

impl<L: InelasticLaw> ImpactTest<L> {
    /// Runs the test with cells of the rod no longer than `cell` \[m\] and records it.
    ///
    /// The velocities are recorded directly. Time 0 of the record is its first sample,
    /// `samples_before` before the impact.
    ///
    /// # Errors
    /// The errors of [`ImpactTest::run`]; [`RodwaveError::NonPhysical`] for a recorder or range
    /// that is not positive.
    pub fn record(
        &self,
        acquisition: &Acquisition,
        cell: f64,
    ) -> Result<VelocityRecord, RodwaveError> {
        let Acquisition {
            recorder,
            samples_before,
            samples_after,
            transducer_range,
        } = *acquisition;
        for (quantity, value) in [
            ("sampling rate [Hz]", recorder.rate_hz),
            ("cut-off frequency [Hz]", recorder.cutoff_hz),
            ("transducer range [m]", transducer_range),
        ] {
            crate::error::check_positive(quantity, value)?;
        }
        let interval = 1.0 / recorder.rate_hz;
        let Some(count @ 1..) = samples_before.checked_add(samples_after) else {
            return Err(RodwaveError::TooFewSamples {
                history: "the record",
                found: 0,
                expected: 1,
            });
        };
        check_steps(FINER as f64 * count as f64)?;
        let duration = samples_after as f64 * interval + recorder.reach();
        let history = self.run(cell, duration)?;
        // entry k of a velocity history of the chain is at the time (k + 1/2) `step`
        let filtered = |velocity: &[f64], time: f64| {
            recorder.filtered(velocity, history.step, time - 0.5 * history.step)
        };
        let time_of = |k: usize| k as f64 * interval - samples_before as f64 * interval;
        let sampled = |velocity: &[f64]| -> Vec<f64> {
            (0..count).map(|k| filtered(velocity, time_of(k))).collect()
        };
        let fine: Vec<f64> = (0..=(count - 1) * FINER)
            .map(|k| {
                let time = k as f64 * interval / FINER as f64 - samples_before as f64 * interval;
                filtered(&history.section_velocity, time)
            })
            .collect();
        Ok(VelocityRecord {
            sampling_rate_hz: recorder.rate_hz,
            excitation: sampled(&history.section_velocity),
            response: sampled(&history.free_end_velocity),
            excitation_before_sampling: SampledHistory::new(
                &fine,
                recorder.rate_hz * FINER as f64,
            )?,
            in_range_until: samples_before as f64 * interval
                + DisplacementPair::of(&history).in_range_until(transducer_range),
            balance: history.balance,
        })
    }
}
