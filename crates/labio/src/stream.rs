//! Samples that come block by block, so that a long record needs no memory of its length.

use ndarray::Array2;

use crate::{Channel, LabioError};

/// A source of simultaneously sampled channels that is read from beginning to end.
pub trait BlockSource {
    /// The channels, in the order of the rows of a block.
    fn channels(&self) -> &[Channel];

    /// Sampling rate \[Hz\].
    fn sampling_rate_hz(&self) -> f64;

    /// Number of samples of every channel, if the source knows it.
    fn n_samples(&self) -> Option<u64>;

    /// Fills the first columns of `block`, shape `(n_channels, any)`, with the next samples in SI units and returns how
    /// many; fewer than the block has columns only at the end of the source, 0 after it.
    ///
    /// # Errors
    ///
    /// [`LabioError`] if the block has another number of rows than there are channels, or the bytes are not as they should
    /// be.
    fn read_block(&mut self, block: &mut Array2<f64>) -> Result<usize, LabioError>;
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
