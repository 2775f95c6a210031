//! Records and streams from samples with names and quantities.

use labio::{BlockSource, Channel, LabioError, Provenance, Quantity, Record};
use ndarray::Array2;

pub(crate) fn record_of(
    samples: Array2<f64>,
    rate_hz: f64,
    channels: &[(&str, Quantity)],
) -> Record {
    let channels = channels.iter();
    let channels = channels.map(|(name, quantity)| Channel::new(*name, *quantity).unwrap());
    let from = Provenance::computed("test");
    Record::new(samples, rate_hz, 0.0, channels.collect(), from).unwrap()
}

/// Samples that are read in blocks of at most `at_most`.
pub(crate) struct InBlocks {
    channels: Vec<Channel>,
    rate_hz: f64,
    samples: Array2<f64>,
    at_most: usize,
    at: usize,
}

impl InBlocks {
    pub(crate) fn new(
        channels: &[Channel],
        rate_hz: f64,
        samples: Array2<f64>,
        at_most: usize,
    ) -> Self {
        Self {
            channels: channels.to_vec(),
            rate_hz,
            samples,
            at_most,
            at: 0,
        }
    }
}

impl BlockSource for InBlocks {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn sampling_rate_hz(&self) -> f64 {
        self.rate_hz
    }

    fn n_samples(&self) -> Option<u64> {
        None
    }

    fn read_block(&mut self, block: &mut Array2<f64>) -> Result<usize, LabioError> {
        let left = self.samples.ncols() - self.at;
        let n = left.min(self.at_most).min(block.ncols());
        for k in 0..n {
            block
                .column_mut(k)
                .assign(&self.samples.column(self.at + k));
        }
        self.at += n;
        Ok(n)
    }
}
