//! Samples of a long array, block by block.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use ndarray::Array2;

use super::header::{Element, Header};
use super::{FORMAT, check_step, two_axes};
use crate::error::{
    check_count, check_enough_samples, check_positive, non_finite_sample, not_read, truncated,
};
use crate::format::opened;
use crate::{BlockSource, Channel, LabioError};

/// Number of bytes read at once.
const BUFFER_BYTES: usize = 1 << 16;

/// Greatest length of a header that is accepted; the header of an array of two axes has less than
/// 200 bytes.
const HEADER_BYTES: u64 = 1 << 16;

/// Rows of an array of `f64`, read block by block in memory that does not grow with the file.
///
/// The array is little-endian, in C order and of shape `(n_rows, n_samples)`, so that each row is
/// contiguous in the file; a block is read from each of the rows in turn.
///
/// # Examples
///
/// ```no_run
/// use labio::format::npy::Blocks;
/// use labio::{BlockSource, Channel, Quantity};
/// use ndarray::Array2;
///
/// # fn main() -> Result<(), labio::LabioError> {
/// let channels = [
///     Channel::new("force", Quantity::Force)?,
///     Channel::new("acceleration", Quantity::Acceleration)?,
/// ];
/// let mut night = Blocks::open("night.npy", &channels)?;
/// let mut block = Array2::zeros((2, 8192));
/// while night.read_block(&mut block)? > 0 {
///     // use the samples
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Blocks<R> {
    source: R,
    channels: Vec<Channel>,
    clock: Clock,
    /// Offset of the first byte of the numbers.
    data_start: u64,
    n_samples: u64,
    next: u64,
    buffer: Vec<u8>,
}

/// Source of the sampling rate.
#[derive(Debug)]
enum Clock {
    /// The row of times, whose steps are checked as they are read.
    Times { step: f64, previous: Option<f64> },
    /// The rate that the caller states; every row is a channel.
    Given { sampling_rate_hz: f64 },
}

/// Converts a count from the file to `usize`; a count beyond the largest `usize` becomes the
/// largest.
fn count(number: u64) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}

impl Clock {
    /// Number of rows of the file that contain the times.
    fn rows(&self) -> u64 {
        match self {
            Self::Times { .. } => 1,
            Self::Given { .. } => 0,
        }
    }
}

impl Blocks<File> {
    /// Opens the array in the file at `path`, whose first row contains the times; see
    /// [`Blocks::new`].
    ///
    /// # Errors
    ///
    /// [`LabioError::InFile`] with the path and, as its source, the error of [`Blocks::new`] or of
    /// opening the file.
    pub fn open(path: impl AsRef<Path>, channels: &[Channel]) -> Result<Self, LabioError> {
        opened(path.as_ref(), |file| Self::new(file, channels))
    }
}

impl<R: Read + Seek> Blocks<R> {
    /// Opens `source`, whose first row contains the times \[s\] and whose other rows are named by
    /// `channels`.
    ///
    /// The sampling rate is the number of steps divided by the time between first and last sample;
    /// every step is compared with the mean step when its block is read.
    ///
    /// # Errors
    ///
    /// [`LabioError`] if the array is of another kind, if its file is longer or shorter than the
    /// header states, if the number of channels differs from the number of rows after the first, or
    /// if the times do not increase.
    pub fn new(source: R, channels: &[Channel]) -> Result<Self, LabioError> {
        let clock = Clock::Times {
            step: f64::NAN,
            previous: None,
        };
        let mut blocks = Self::with_clock(source, channels, clock)?;
        check_enough_samples("the row of times", count(blocks.n_samples), 2)?;
        let first = blocks.number(0)?;
        let last = blocks.number(blocks.n_samples - 1)?;
        let step = check_positive(
            "mean time step [s]",
            (last - first) / (blocks.n_samples - 1) as f64,
        )?;
        // a step may be so small that its reciprocal overflows
        check_positive("sampling rate [Hz]", step.recip())?;
        blocks.clock = Clock::Times {
            step,
            previous: None,
        };
        Ok(blocks)
    }

    /// Opens `source`, whose rows are named by `channels` and sampled at `sampling_rate_hz` \[Hz\].
    ///
    /// # Errors
    ///
    /// The errors of [`Blocks::new`]; [`LabioError::NonPhysical`] if the rate is not positive.
    pub fn without_times(
        source: R,
        channels: &[Channel],
        sampling_rate_hz: f64,
    ) -> Result<Self, LabioError> {
        check_positive("sampling rate [Hz]", sampling_rate_hz)?;
        Self::with_clock(source, channels, Clock::Given { sampling_rate_hz })
    }

    fn with_clock(mut source: R, channels: &[Channel], clock: Clock) -> Result<Self, LabioError> {
        let length = source.seek(SeekFrom::End(0)).map_err(not_read)?;
        source.seek(SeekFrom::Start(0)).map_err(not_read)?;
        let mut head = Vec::new();
        source
            .by_ref()
            .take(HEADER_BYTES)
            .read_to_end(&mut head)
            .map_err(not_read)?;
        let header = Header::read(&head, FORMAT, "")?;
        if header.element != Element::F64 || header.fortran_order {
            let order = if header.fortran_order { "Fortran" } else { "C" };
            return Err(LabioError::WrongElement {
                format: FORMAT,
                found: format!("'{}' in {order} order", header.element),
                expected: "'<f8' in C order",
            });
        }
        let [n_rows, n_samples] = two_axes(&header.shape)?;
        let announced = header
            .data_length()
            .and_then(|data| u64::try_from(data.checked_add(header.data_start)?).ok())
            .unwrap_or(u64::MAX);
        if announced > length {
            return Err(truncated(FORMAT, announced - length));
        }
        if announced < length {
            return Err(LabioError::TrailingBytes {
                format: FORMAT,
                extra_bytes: count(length - announced),
            });
        }
        let rows = count(clock.rows());
        let what = "rows of the array, one per channel and, if there are times, one for them";
        check_count(what, n_rows, channels.len() + rows)?;
        crate::channel::check_distinct(channels)?;
        Ok(Self {
            source,
            channels: channels.to_vec(),
            clock,
            data_start: header.data_start as u64,
            n_samples: n_samples as u64,
            next: 0,
            buffer: vec![0; BUFFER_BYTES],
        })
    }

    /// Reads the number at `index` of the array.
    fn number(&mut self, index: u64) -> Result<f64, LabioError> {
        let mut value = 0.0;
        self.run(index, 1, |_, number| {
            value = number;
            Ok(())
        })?;
        Ok(value)
    }

    /// Reads `count` numbers from `index` on.
    fn run(
        &mut self,
        index: u64,
        count: usize,
        mut put: impl FnMut(usize, f64) -> Result<(), LabioError>,
    ) -> Result<(), LabioError> {
        self.source
            .seek(SeekFrom::Start(self.data_start + 8 * index))
            .map_err(not_read)?;
        let mut done = 0;
        while done < count {
            let bytes = (count - done).saturating_mul(8).min(BUFFER_BYTES);
            let Some(buffer) = self.buffer.get_mut(..bytes) else {
                break;
            };
            self.source.read_exact(buffer).map_err(not_read)?;
            for &number in buffer.as_chunks::<8>().0 {
                put(done, f64::from_le_bytes(number))?;
                done += 1;
            }
        }
        Ok(())
    }

    /// Compares the steps of the next `count` times with the mean step.
    fn check_times(&mut self, n: usize) -> Result<(), LabioError> {
        let Clock::Times { step, mut previous } = self.clock else {
            return Ok(());
        };
        let from = self.next;
        self.run(from, n, |at, time| {
            if let Some(previous) = previous {
                let index = count(from).saturating_add(at).saturating_sub(1);
                check_step(index, time - previous, step)?;
            }
            previous = Some(time);
            Ok(())
        })?;
        self.clock = Clock::Times { step, previous };
        Ok(())
    }
}

impl<R: Read + Seek> BlockSource for Blocks<R> {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn sampling_rate_hz(&self) -> f64 {
        match self.clock {
            Clock::Times { step, .. } => 1.0 / step,
            Clock::Given { sampling_rate_hz } => sampling_rate_hz,
        }
    }

    fn n_samples(&self) -> Option<u64> {
        Some(self.n_samples)
    }

    fn read_block(&mut self, block: &mut Array2<f64>) -> Result<usize, LabioError> {
        let what = "rows of the block, one per channel";
        check_count(what, block.nrows(), self.channels.len())?;
        let n = count(self.n_samples - self.next).min(block.ncols());
        self.check_times(n)?;
        let (from, before) = (self.next, self.clock.rows());
        for (row, mut samples) in block.rows_mut().into_iter().enumerate() {
            let mut unread = None;
            let mut places = samples.iter_mut();
            self.run(
                (row as u64 + before) * self.n_samples + from,
                n,
                |at, value| {
                    if !value.is_finite() && unread.is_none() {
                        unread = Some((at, value));
                    }
                    if let Some(place) = places.next() {
                        *place = value;
                    }
                    Ok(())
                },
            )?;
            if let Some((at, value)) = unread {
                return non_finite_sample(
                    self.channels
                        .get(row)
                        .map_or(String::new(), |c| c.name().to_owned()),
                    count(from).saturating_add(at),
                    value,
                );
            }
        }
        self.next += n as u64;
        Ok(n)
    }
}
