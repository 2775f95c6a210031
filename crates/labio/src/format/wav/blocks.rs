//! Samples of a WAVE file, block by block.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use ndarray::Array2;

use super::FORMAT;
use super::layout::Layout;
use crate::error::{check_count, check_positive, non_finite_sample, not_read, truncated};
use crate::format::{Strictness, opened};
use crate::{BlockSource, Channel, LabioError};

/// Number of bytes read at once: large enough to make the cost of system calls negligible, small
/// enough for the cache.
const BUFFER_BYTES: usize = 1 << 16;

/// Samples of a WAVE file in SI units, read block by block in memory that does not grow with the
/// file.
///
/// # Examples
///
/// ```no_run
/// use labio::format::wav::Blocks;
/// use labio::{BlockSource, Channel, Quantity};
/// use ndarray::Array2;
///
/// # fn main() -> Result<(), labio::LabioError> {
/// let channels = [Channel::new("end A", Quantity::Acceleration)?];
/// // full scale of the recorder stands for 500 m/s^2
/// let mut record = Blocks::open("night.wav", &channels, &[500.0])?;
/// let mut block = Array2::zeros((1, 8192));
/// let mut peak = 0.0_f64;
/// loop {
///     let n = record.read_block(&mut block)?;
///     if n == 0 {
///         break;
///     }
///     peak = block.row(0).iter().take(n).fold(peak, |peak, x| peak.max(x.abs()));
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Blocks<R> {
    source: R,
    layout: Layout,
    channels: Vec<Channel>,
    full_scale: Vec<f64>,
    frames_left: u64,
    buffer: Vec<u8>,
}

impl Blocks<File> {
    /// Opens the file at `path`; otherwise like [`Blocks::new`].
    ///
    /// # Errors
    ///
    /// [`LabioError::InFile`] with the path and, as its source, the error of [`Blocks::new`] or of
    /// opening the file.
    pub fn open(
        path: impl AsRef<Path>,
        channels: &[Channel],
        full_scale: &[f64],
    ) -> Result<Self, LabioError> {
        opened(path.as_ref(), |file| Self::new(file, channels, full_scale))
    }
}

impl<R: Read + Seek> Blocks<R> {
    /// Opens `source`, whose channels are named by `channels`; for each channel, `full_scale` is
    /// the value of a sample of 1 in the SI unit.
    ///
    /// # Errors
    ///
    /// [`LabioError`] if a strict reading rejects the file, or if there is not exactly one channel
    /// and one positive full scale for every channel of the file.
    pub fn new(
        mut source: R,
        channels: &[Channel],
        full_scale: &[f64],
    ) -> Result<Self, LabioError> {
        let layout = Layout::read(&mut source, Strictness::Strict, &mut Vec::new())?;
        let n_channels = usize::from(layout.n_channels);
        for (what, found) in [
            ("channels for those of the file", channels.len()),
            ("full scales for the channels of the file", full_scale.len()),
        ] {
            check_count(what, found, n_channels)?;
        }
        for &scale in full_scale {
            check_positive("full scale [SI unit of the channel]", scale)?;
        }
        crate::channel::check_distinct(channels)?;
        source
            .seek(SeekFrom::Start(layout.data_start))
            .map_err(not_read)?;
        let frame = layout.frame_bytes();
        Ok(Self {
            source,
            frames_left: layout.data_length / frame as u64,
            channels: channels.to_vec(),
            full_scale: full_scale.to_vec(),
            buffer: vec![0; frame * (BUFFER_BYTES / frame).max(1)],
            layout,
        })
    }
}

impl<R: Read + Seek> BlockSource for Blocks<R> {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn sampling_rate_hz(&self) -> f64 {
        f64::from(self.layout.sampling_rate_hz)
    }

    fn n_samples(&self) -> Option<u64> {
        Some(self.layout.data_length / self.layout.frame_bytes() as u64)
    }

    fn read_block(&mut self, block: &mut Array2<f64>) -> Result<usize, LabioError> {
        let n_channels = self.channels.len();
        let n_rows = block.nrows();
        check_count("rows of the block, one per channel", n_rows, n_channels)?;
        let frame = self.layout.frame_bytes();
        let wanted = usize::try_from(self.frames_left)
            .unwrap_or(usize::MAX)
            .min(block.ncols());
        let mut done = 0;
        while done < wanted {
            let frames = (wanted - done).min(self.buffer.len() / frame);
            let Some(bytes) = self.buffer.get_mut(..frames * frame) else {
                break;
            };
            self.source.read_exact(bytes).map_err(|source| {
                if source.kind() == std::io::ErrorKind::UnexpectedEof {
                    truncated(FORMAT, self.frames_left.saturating_mul(frame as u64))
                } else {
                    LabioError::Read { source }
                }
            })?;
            let (mut row, mut column) = (0, done);
            let (scales, mut unread) = (&self.full_scale, None);
            self.layout.encoding.decode(bytes, |_, value| {
                if !value.is_finite() && unread.is_none() {
                    unread = Some((row, column, value));
                }
                if let (Some(place), Some(scale)) = (block.get_mut((row, column)), scales.get(row))
                {
                    *place = value * scale;
                }
                row += 1;
                if row == n_channels {
                    row = 0;
                    column += 1;
                }
            });
            if let Some((row, column, value)) = unread {
                let read = self.n_samples().unwrap_or(0) - self.frames_left;
                let first = usize::try_from(read).unwrap_or(usize::MAX) - done;
                return non_finite_sample(
                    self.channels
                        .get(row)
                        .map_or(String::new(), |channel| channel.name().to_owned()),
                    first.saturating_add(column),
                    value,
                );
            }
            done += frames;
            self.frames_left -= frames as u64;
        }
        Ok(done)
    }
}
