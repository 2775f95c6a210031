//! Records of the gauges of a shot.

use super::bar::HopkinsonBar;
use crate::ImpulseError;
use crate::error::{check_enough, check_length, check_positive, check_samples};

/// Strains of all gauges, sampled together.
#[derive(Debug, Clone, PartialEq)]
pub struct HopkinsonRecord {
    /// Sampling rate \[Hz\].
    pub rate_hz: f64,
    /// Strain, positive in tension, of each gauge of the incident bar, then of the transmitted
    /// one; `(n_gauges, n_samples)` each.
    pub gauges: [Vec<Vec<f64>>; 2],
    /// Number of samples before any pulse.
    pub silent: usize,
}

impl HopkinsonRecord {
    pub(super) fn check(&self, bars: &[HopkinsonBar; 2]) -> Result<usize, ImpulseError> {
        check_positive("sampling rate [Hz]", self.rate_hz)?;
        let mut n_samples = None;
        for (gauges, bar) in self.gauges.iter().zip(bars) {
            check_length("list of records of a bar", gauges.len(), bar.gauges.len())?;
            for samples in gauges {
                check_samples("record of a gauge", samples)?;
                let expected = *n_samples.get_or_insert(samples.len());
                check_length("record of a gauge", samples.len(), expected)?;
            }
        }
        let n_samples = n_samples.unwrap_or(0);
        check_enough(
            "record of a gauge",
            n_samples,
            self.silent.saturating_add(1),
        )?;
        Ok(n_samples)
    }
}
