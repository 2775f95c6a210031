//! Samples that are read block by block, so that the memory needed does not grow with the record.

use ndarray::Array2;

use crate::error::{check_count, count_mismatch};
use crate::{Channel, LabioError};

/// A source of simultaneously sampled channels that is read from start to end.
pub trait BlockSource {
    /// The channels, in the order of the rows of a block.
    fn channels(&self) -> &[Channel];

    /// Sampling rate \[Hz\].
    fn sampling_rate_hz(&self) -> f64;

    /// Number of samples per channel, if known.
    fn n_samples(&self) -> Option<u64>;

    /// Fills the first columns of `block`, shape `(n_channels, any)`, with the next samples in SI
    /// units and returns the number of samples; it is less than the number of columns only at the
    /// end of the source, and 0 after the end.
    ///
    /// # Errors
    ///
    /// [`LabioError`] if the number of rows of the block differs from the number of channels, or if
    /// the bytes are invalid.
    fn read_block(&mut self, block: &mut Array2<f64>) -> Result<usize, LabioError>;
}

/// Lets `source` fill `block`; rejects more samples than the block can contain, and a
/// block with another number of rows.
pub(crate) fn read_next<S: BlockSource + ?Sized>(
    source: &mut S,
    block: &mut Array2<f64>,
) -> Result<usize, LabioError> {
    let n_channels = block.nrows();
    let n = source.read_block(block)?;
    if n > block.ncols() {
        return count_mismatch("samples read into a block, at most", n, block.ncols());
    }
    check_count("rows of a block of samples", block.nrows(), n_channels)?;
    Ok(n)
}

impl<S: BlockSource + ?Sized> BlockSource for Box<S> {
    fn channels(&self) -> &[Channel] {
        (**self).channels()
    }

    fn sampling_rate_hz(&self) -> f64 {
        (**self).sampling_rate_hz()
    }

    fn n_samples(&self) -> Option<u64> {
        (**self).n_samples()
    }

    fn read_block(&mut self, block: &mut Array2<f64>) -> Result<usize, LabioError> {
        (**self).read_block(block)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::hits::{Criteria, Extent, Trigger, find_hits_in_blocks};
    use crate::{CalibratedBlocks, Provenance, Quantity, Rating, SensorChain, Welch};

    /// Samples that are passed on in blocks of at most `at_most`.
    pub(crate) struct Played {
        channels: Vec<Channel>,
        samples: Array2<f64>,
        at_most: usize,
        at: usize,
    }

    impl Played {
        pub(crate) fn new(channels: &[Channel], samples: Array2<f64>, at_most: usize) -> Self {
            Self {
                channels: channels.to_vec(),
                samples,
                at_most,
                at: 0,
            }
        }
    }

    impl BlockSource for Played {
        fn channels(&self) -> &[Channel] {
            &self.channels
        }

        fn sampling_rate_hz(&self) -> f64 {
            100.0
        }

        fn n_samples(&self) -> Option<u64> {
            Some(self.samples.ncols() as u64)
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

    /// A faulty source that claims to have filled the block, and replaces it by one of `shape`.
    struct Careless {
        channels: Vec<Channel>,
        shape: (usize, usize),
        said: usize,
    }

    impl BlockSource for Careless {
        fn channels(&self) -> &[Channel] {
            &self.channels
        }

        fn sampling_rate_hz(&self) -> f64 {
            1000.0
        }

        fn n_samples(&self) -> Option<u64> {
            None
        }

        fn read_block(&mut self, block: &mut Array2<f64>) -> Result<usize, LabioError> {
            *block = Array2::zeros(self.shape);
            Ok(self.said)
        }
    }

    #[test]
    fn a_source_that_does_not_fill_its_block_is_refused() {
        let channels = ["a", "b"].map(|name| Channel::new(name, Quantity::Voltage).unwrap());
        let trigger = Trigger::new("a", 1.0, Extent::Samples(16)).unwrap();
        let sensitivity = Rating::new(0.5, "V/N").unwrap();
        let chain = SensorChain::of_sensitivity(sensitivity).unwrap();
        for (shape, said, expected) in [
            ((1, 9), 9, "rows of a block of samples: found 1, expected 2"),
            (
                (2, 9),
                10,
                "samples read into a block, at most: found 10, expected 9",
            ),
        ] {
            let source = || Careless {
                channels: channels.to_vec(),
                shape,
                said,
            };
            let provenance = Provenance::computed("nothing");
            let criteria = Criteria::default();
            let chains = vec![("b".to_owned(), chain.clone())];
            let mut calibrated = CalibratedBlocks::new(source(), chains).unwrap();
            let mut block = Array2::zeros((2, 16));
            let refusals = [
                Welch::new(8)
                    .unwrap()
                    .spectra_of_stream(&mut source())
                    .map(|_| ()),
                find_hits_in_blocks(&mut source(), &provenance, &trigger, &criteria).map(|_| ()),
                calibrated.read_block(&mut block).map(|_| ()),
            ];
            for refusal in refusals {
                assert_eq!(refusal.unwrap_err().to_string(), expected);
            }
        }
    }
}
