//! Calibration of samples that are read block by block.

use ndarray::Array2;

use crate::error::check_count;
use crate::stream::read_next;
use crate::{BlockSource, Channel, LabioError, SensorChain, channel};

/// A source whose channels are converted, block by block, to the quantities that their sensors
/// measure.
///
/// # Examples
///
/// ```no_run
/// use labio::format::wav::Blocks;
/// use labio::{CalibratedBlocks, Channel, Quantity, Rating, SensorChain};
///
/// # fn main() -> Result<(), labio::LabioError> {
/// let hammer = SensorChain::of_sensitivity(Rating::new(2.3, "mV/N")?)?;
/// let channels = [Channel::new("hammer", Quantity::Voltage)?];
/// let volts = Blocks::open("hits.wav", &channels, &[10.0])?;
/// let newtons = CalibratedBlocks::new(volts, vec![("hammer".to_owned(), hammer)])?;
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct CalibratedBlocks<S> {
    source: S,
    channels: Vec<Channel>,
    /// Row index and chain of each converted channel.
    chains: Vec<(usize, SensorChain)>,
}

impl<S: BlockSource> CalibratedBlocks<S> {
    /// Returns `source` with a chain for each named channel; the others are unchanged. Time skews
    /// are not corrected.
    ///
    /// # Errors
    ///
    /// - [`LabioError::UnknownChannel`]: a name is not in the source.
    /// - [`LabioError::DuplicateChannel`]: a name has two chains.
    /// - [`LabioError::UnitMismatch`]: a chain does not fit its channel.
    pub fn new(source: S, chains: Vec<(String, SensorChain)>) -> Result<Self, LabioError> {
        let mut channels = source.channels().to_vec();
        let mut rows: Vec<(usize, SensorChain)> = Vec::new();
        for (name, chain) in chains {
            let (row, recorded) = channel::find(source.channels(), &name)?;
            if rows.iter().any(|(other, _)| *other == row) {
                return Err(LabioError::DuplicateChannel {
                    name,
                    first: row,
                    second: row,
                });
            }
            let felt = Channel::new(name, chain.quantity_from(recorded.quantity())?)?;
            if let Some(slot) = channels.get_mut(row) {
                *slot = felt;
            }
            rows.push((row, chain));
        }
        Ok(Self {
            source,
            channels,
            chains: rows,
        })
    }
}

impl<S: BlockSource> BlockSource for CalibratedBlocks<S> {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn sampling_rate_hz(&self) -> f64 {
        self.source.sampling_rate_hz()
    }

    fn n_samples(&self) -> Option<u64> {
        self.source.n_samples()
    }

    fn read_block(&mut self, block: &mut Array2<f64>) -> Result<usize, LabioError> {
        check_count(
            "rows of a block of samples",
            block.nrows(),
            self.channels.len(),
        )?;
        let n = read_next(&mut self.source, block)?;
        for (row, chain) in &self.chains {
            let mut samples = block.row_mut(*row);
            for sample in samples.iter_mut().take(n) {
                *sample = chain.si_from(*sample);
            }
        }
        Ok(n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::tests::Played;
    use crate::{Quantity, Rating};
    use ndarray::array;

    #[test]
    fn named_channels_are_calibrated_and_the_others_pass() {
        let channels = ["force", "trigger"].map(|n| Channel::new(n, Quantity::Voltage).unwrap());
        let chain = |unit| {
            let sensitivity = Rating::new(0.5, unit).unwrap();
            SensorChain::of_sensitivity(sensitivity).unwrap()
        };
        // three samples, one per block
        let ramp = array![[0.0, 1.0, 2.0], [0.0, 1.0, 2.0]];
        let source = || Played::new(&channels, ramp.clone(), 1);
        let named = |unit| vec![("force".to_owned(), chain(unit))];
        let mut newtons = CalibratedBlocks::new(source(), named("V/N")).unwrap();
        assert_eq!(newtons.channels()[0].quantity(), Quantity::Force);
        assert_eq!(newtons.n_samples(), Some(3));
        let mut block = Array2::zeros((2, 4));
        let mut seen = Vec::new();
        while newtons.read_block(&mut block).unwrap() > 0 {
            seen.push((block[[0, 0]], block[[1, 0]]));
        }
        // volts divided by 0.5 V/N: exact
        assert_eq!(seen, [(0.0, 0.0), (2.0, 1.0), (4.0, 2.0)]);
        assert!(CalibratedBlocks::new(source(), named("pC/N")).is_err());
        let twice = [named("V/N"), named("V/N")].concat();
        assert!(matches!(
            CalibratedBlocks::new(source(), twice),
            Err(LabioError::DuplicateChannel { .. })
        ));
    }
}
