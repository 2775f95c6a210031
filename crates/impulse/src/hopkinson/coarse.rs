//! The record at the sampling rate that its band needs, for the computation of errors.

use super::curves::Curves;
use super::noise::QuietNoise;
use super::plan::Plan;
use super::record::HopkinsonRecord;
use crate::interpolation::at_place;

/// Samples per period at the last line of the band.
const PER_PERIOD: f64 = 4.0;
/// Fewest samples of a result.
const FEWEST: usize = 64;

/// A record whose samples are means of several samples, with its plan. Histories in the band keep
/// their amplitude to 10 % at the last line of the band, which suffices for errors, and the cost
/// falls in proportion to the number of samples.
pub(super) struct Coarse {
    pub(super) plan: Plan,
    pub(super) record: HopkinsonRecord,
    by: usize,
    /// Samples of the fine record that the result covers.
    fine: std::ops::Range<usize>,
}

impl Coarse {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of samples, above 0"
    )]
    pub(super) fn of(record: &HopkinsonRecord, plan: &Plan) -> Self {
        let allowed = plan.rate_hz / (PER_PERIOD * plan.last_hz());
        let by = (allowed as usize)
            .min(plan.result.len() / FEWEST)
            .min(record.silent)
            .max(1);
        let mean = |samples: &Vec<f64>| -> Vec<f64> {
            let several = samples.chunks_exact(by);
            several
                .map(|all| all.iter().sum::<f64>() / by as f64)
                .collect()
        };
        Self {
            plan: plan.coarser(by),
            record: HopkinsonRecord {
                rate_hz: record.rate_hz / by as f64,
                gauges: record
                    .gauges
                    .each_ref()
                    .map(|gauges| gauges.iter().map(mean).collect()),
                silent: record.silent / by,
            },
            by,
            fine: plan.result.clone(),
        }
    }

    /// Returns the noise of the samples of the coarse record.
    pub(super) fn noises(&self, noises: &[Vec<QuietNoise>; 2]) -> [Vec<QuietNoise>; 2] {
        noises
            .each_ref()
            .map(|gauges| gauges.iter().map(|noise| noise.coarser(self.by)).collect())
    }

    /// Interpolates histories from the coarse samples to all samples of the result.
    pub(super) fn refined(&self, curves: &Curves) -> Curves {
        let middle = 0.5 * (self.by - 1) as f64;
        let first = self.plan.result.start as f64;
        let refined = curves.0.iter().map(|curve| {
            let of_sample = |sample: usize| {
                let place = (sample as f64 - middle) / self.by as f64 - first;
                at_place(curve, place.max(0.0))
            };
            self.fine.clone().map(of_sample).collect()
        });
        Curves(refined.collect())
    }
}
