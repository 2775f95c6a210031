//! Raw data of a segment: numbers channel by channel, in rows with all channels, or in the buffers
//! of a DAQmx device.

use std::borrow::Cow;

use super::bytes::Bytes;
use super::malformed;
use super::objects::{Objects, RawIndex, Scaler};
use super::segment::Segment;
use super::value::{Sample, Timestamp};
use crate::LabioError;
use crate::format::number_type::NumberType;

/// A run of numbers of one channel in a chunk.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    object: usize,
    /// Type of the numbers; `None` for texts.
    sample: Option<Sample>,
    n_bytes: usize,
}

/// The numbers of a DAQmx buffer.
#[derive(Debug, Clone)]
pub(super) struct Buffer {
    width: usize,
    n_rows: usize,
    scalers: Vec<(usize, Scaler)>,
}

/// Layout of the raw data of a segment; it applies to all segments up to the next metadata.
#[derive(Debug)]
pub(super) enum Layout {
    Runs(Vec<Run>),
    Rows {
        width: usize,
        samples: Vec<(usize, usize, Sample)>,
    },
    Buffers(Vec<Buffer>),
}

impl Default for Layout {
    fn default() -> Self {
        Self::Runs(Vec::new())
    }
}

impl Layout {
    /// Returns the layout of `segment` for the objects that have data in it.
    pub(super) fn of(segment: &Segment<'_>, objects: &Objects) -> Result<Self, LabioError> {
        let indexed: Vec<(usize, &RawIndex)> = objects
            .with_data
            .iter()
            .filter_map(|&slot| Some((slot, objects.all.get(slot)?.index.as_ref()?)))
            .collect();
        let refused = |slot: usize, found: String, expected: &str| {
            let place = objects
                .all
                .get(slot)
                .map_or(segment.raw.place(), |object| object.index_place);
            malformed(place, "raw data index", found, expected)
        };
        let n_daqmx = indexed
            .iter()
            .filter(|(_, index)| matches!(index, RawIndex::Daqmx { .. }))
            .count();
        if n_daqmx > 0 {
            return Self::buffers(&indexed, &refused);
        }
        let mut runs = Vec::with_capacity(indexed.len());
        let mut rows = Vec::new();
        let mut width = 0_usize;
        let mut n_rows = None;
        for (object, index) in indexed {
            let (sample, n_bytes) = match index {
                RawIndex::Numbers { sample, n } => {
                    if segment.contains.interleaved() && *n_rows.get_or_insert(*n) != *n {
                        return Err(refused(
                            object,
                            format!("{n} values"),
                            "as many as for the previous channel, interleaved with it",
                        ));
                    }
                    rows.push((object, width, *sample));
                    width += sample.size();
                    (Some(*sample), n.checked_mul(sample.size() as u64))
                }
                RawIndex::Text { n_bytes } => (None, Some(*n_bytes)),
                RawIndex::Daqmx { .. } => (None, None),
            };
            let n_bytes = n_bytes
                .and_then(|n| usize::try_from(n).ok())
                .ok_or_else(|| {
                    refused(
                        object,
                        "more bytes than can be counted".to_owned(),
                        "a smaller number of values",
                    )
                })?;
            if sample.is_none() && segment.contains.interleaved() {
                return Err(refused(
                    object,
                    "texts".to_owned(),
                    "numbers, since the data are interleaved",
                ));
            }
            if n_bytes > 0 {
                runs.push(Run {
                    object,
                    sample,
                    n_bytes,
                });
            }
        }
        if segment.contains.interleaved() {
            return Ok(Self::Rows {
                width,
                samples: rows,
            });
        }
        Ok(Self::Runs(runs))
    }

    fn buffers(
        indexed: &[(usize, &RawIndex)],
        refused: &dyn Fn(usize, String, &str) -> LabioError,
    ) -> Result<Self, LabioError> {
        let mut buffers: Vec<Buffer> = Vec::new();
        for &(object, index) in indexed {
            let RawIndex::Daqmx { n, scalers, widths } = index else {
                return Err(refused(
                    object,
                    "plain numbers".to_owned(),
                    "DAQmx data, like the other channels of the segment",
                ));
            };
            if buffers.is_empty() {
                buffers.extend(widths.iter().map(|&width| Buffer {
                    width,
                    n_rows: 0,
                    scalers: Vec::new(),
                }));
            }
            if !buffers
                .iter()
                .map(|buffer| buffer.width)
                .eq(widths.iter().copied())
            {
                return Err(refused(
                    object,
                    format!("buffers with rows of {widths:?} bytes"),
                    "those of the previous channel",
                ));
            }
            let n_rows = usize::try_from(*n).unwrap_or(usize::MAX);
            for scaler in scalers {
                let Some(buffer) = buffers.get_mut(scaler.buffer) else {
                    continue; // was checked when the index was read
                };
                if !buffer.scalers.is_empty() && buffer.n_rows != n_rows {
                    return Err(refused(
                        object,
                        format!("{n} values"),
                        "as many as for the previous channel from the same buffer",
                    ));
                }
                buffer.n_rows = n_rows;
                buffer.scalers.push((object, scaler.clone()));
                if buffer.scalers.len() > 8 * buffer.width {
                    return Err(refused(
                        object,
                        format!("{} numbers in a row", buffer.scalers.len()),
                        "at most one for each bit of the row",
                    ));
                }
            }
        }
        Ok(Self::Buffers(buffers))
    }

    /// Number of bytes per chunk.
    fn chunk(&self) -> Option<usize> {
        let add = |sum: usize, size: Option<usize>| sum.checked_add(size?);
        match self {
            Self::Runs(runs) => runs.iter().map(|run| Some(run.n_bytes)).try_fold(0, add),
            Self::Rows { width, .. } => Some(*width),
            Self::Buffers(buffers) => {
                let mut sizes = buffers.iter().map(|b| b.width.checked_mul(b.n_rows));
                sizes.try_fold(0, add)
            }
        }
    }

    /// Reads the raw data of `segment`, whole chunks and a partial last one, into the objects.
    ///
    /// # Errors
    ///
    /// [`LabioError::Malformed`] if the last chunk is partial, or if there are data that belong to
    /// no object; the objects then contain the data read so far.
    pub(super) fn read(
        &self,
        segment: &Segment<'_>,
        objects: &mut Objects,
    ) -> Result<(), LabioError> {
        let mut raw = segment.raw;
        let n_bytes = raw.len();
        if n_bytes == 0 {
            return Ok(());
        }
        let chunk = self.chunk();
        let broken = |expected: String| {
            malformed(
                segment.raw.place(),
                "raw data",
                format!("{n_bytes} bytes"),
                expected,
            )
        };
        if chunk == Some(0) {
            return Err(broken("none, since no channel has values here".to_owned()));
        }
        if let Self::Rows { width, samples } = self {
            let rows = raw.take(n_bytes - n_bytes % width, "raw data")?;
            for &(object, offset, sample) in samples {
                let column = Column {
                    rows,
                    offset,
                    width: *width,
                    big_endian: raw.is_big_endian(),
                };
                append(objects, object, sample, column)?;
            }
        } else {
            while raw.len() > 0 {
                self.read_chunk(&mut raw, objects)?;
            }
        }
        match chunk {
            Some(chunk) if n_bytes.is_multiple_of(chunk) => Ok(()),
            Some(chunk) => {
                let why = if segment.open {
                    "; the recording was cut off"
                } else {
                    ""
                };
                Err(broken(format!("whole chunks of {chunk} bytes{why}")))
            }
            None => Err(broken(
                "a chunk of more bytes than can be counted".to_owned(),
            )),
        }
    }

    /// Reads one chunk, or its leading part if the bytes end early.
    fn read_chunk(&self, raw: &mut Bytes<'_>, objects: &mut Objects) -> Result<(), LabioError> {
        let big_endian = raw.is_big_endian();
        match self {
            Self::Runs(runs) => {
                for run in runs {
                    let rows = raw.take(run.n_bytes.min(raw.len()), "raw data")?;
                    if let Some(sample) = run.sample {
                        let column = Column {
                            rows,
                            offset: 0,
                            width: sample.size(),
                            big_endian,
                        };
                        append(objects, run.object, sample, column)?;
                    } else if let Some(object) = objects.all.get_mut(run.object) {
                        object.numbers.has_text = true;
                    }
                }
            }
            Self::Rows { .. } => {}
            Self::Buffers(buffers) => {
                for buffer in buffers {
                    let n_bytes = buffer.width.saturating_mul(buffer.n_rows);
                    let rows = raw.take(n_bytes.min(raw.len()), "raw data")?;
                    for (object, scaler) in &buffer.scalers {
                        let column = Column {
                            rows,
                            offset: scaler.byte,
                            width: buffer.width,
                            big_endian,
                        };
                        append_scaler(objects, *object, scaler, column);
                    }
                }
            }
        }
        Ok(())
    }
}

/// Appends the numbers at `offset` of each row of `width` bytes to those of the object.
fn append(
    objects: &mut Objects,
    object: usize,
    sample: Sample,
    column: Column<'_>,
) -> Result<(), LabioError> {
    let Some(object) = objects.all.get_mut(object) else {
        return Ok(()); // every slot was pushed when its object was read
    };
    let numbers = &mut object.numbers;
    let (complex, time) = (sample.n_numbers() == 2, sample == Sample::Timestamp);
    if !numbers.values.is_empty()
        && (complex != numbers.complex || time != numbers.first_time.is_some())
    {
        let expected = "real, complex or times, as in the previous segments";
        return Err(malformed(
            object.index_place,
            "data type of raw data",
            match sample {
                Sample::Number(kind) => format!("{kind:?}"),
                other => format!("{other:?}"),
            },
            expected,
        ));
    }
    numbers.complex = complex;
    numbers.has_opaque |= matches!(sample, Sample::Opaque(_));
    numbers
        .values
        .reserve(column.rows.len() / column.width.max(1) * sample.n_numbers());
    let first_time = &mut numbers.first_time;
    column.decode(sample, &mut numbers.values, first_time);
    Ok(())
}

fn append_scaler(objects: &mut Objects, object: usize, scaler: &Scaler, column: Column<'_>) {
    let Some(object) = objects.all.get_mut(object) else {
        return; // every slot was pushed when its object was read
    };
    let numbers = &mut object.numbers;
    let mut first_time = numbers.first_time;
    let values = numbers.of_scale(scaler.scale);
    match scaler.bit {
        Some(bit) => {
            let bytes = column.gathered(1);
            values.extend(bytes.iter().map(|byte| f64::from(byte >> bit & 1)));
        }
        None => column.decode(scaler.sample, values, &mut first_time),
    }
    numbers.first_time = first_time;
}

/// A part of each of several rows of bytes.
#[derive(Clone, Copy)]
struct Column<'a> {
    rows: &'a [u8],
    /// First byte within a row.
    offset: usize,
    /// Number of bytes of a row.
    width: usize,
    big_endian: bool,
}

impl<'a> Column<'a> {
    /// Returns the `n` bytes at `offset` of each whole row.
    fn gathered(self, n: usize) -> Cow<'a, [u8]> {
        let width = self.width.max(1);
        let (rows, _) = self.rows.split_at(self.rows.len() / width * width);
        if self.width == n {
            return Cow::Borrowed(rows);
        }
        let part = |row: &'a [u8]| row.get(self.offset..self.offset.checked_add(n)?);
        let parts = rows.chunks_exact(width).filter_map(part);
        Cow::Owned(parts.flatten().copied().collect())
    }

    /// Appends the numbers at `offset` of each whole row as doubles: exactly, except for 64-bit
    /// integers, which are rounded to 53 bits.
    fn decode(self, sample: Sample, values: &mut Vec<f64>, first_time: &mut Option<Timestamp>) {
        let (bytes, big_endian) = (self.gathered(sample.size()), self.big_endian);
        match sample {
            Sample::Number(kind) => kind.append(&bytes, big_endian, values),
            Sample::Complex32 => NumberType::F32.append(&bytes, big_endian, values),
            Sample::Complex64 => NumberType::F64.append(&bytes, big_endian, values),
            Sample::Boolean => {
                values.extend(bytes.iter().map(|&byte| f64::from(u8::from(byte != 0))));
            }
            Sample::Timestamp => {
                let mut bytes = Bytes::new(&bytes, 0, big_endian);
                while let Ok(time) = Timestamp::read(&mut bytes, "time") {
                    values.push(time.since(*first_time.get_or_insert(time)));
                }
            }
            Sample::Opaque(_) => {}
        }
    }
}
