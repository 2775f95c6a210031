//! WAVE files: PCM of 8, 16, 24 and 32 bits, floating point of 32 and 64 bits, in RIFF or, beyond 4
//! GiB, RF64 and BW64.
//!
//! # Scaling
//!
//! Integer samples are divided by the largest magnitude $`2^{b-1}`$ of their $`b`$ bits, so that
//! full scale is ±1 and the largest positive sample is one step below 1; 8-bit samples are offset
//! by 128 first. Floating-point samples are not scaled. The file does not contain the SI value of
//! ±1: it must be passed to [`Blocks`], and a [`Series`] stays in fractions of full scale. The
//! property `encoding` of the contents names the representation.
//!
//! # Names and units
//!
//! WAVE has no fields for names and units. The channels are called `channel 1`, `channel 2`, ...;
//! the writer puts other names, and units, into the comment of the file (`ICMT`), from which the
//! reader restores them.
//!
//! # Strictness
//!
//! A file with missing bytes, or with bytes after those that the headers announce, is rejected. A
//! tolerant reading reports a defect and returns the existing samples.

mod blocks;
mod layout;
mod write;

use std::io::Cursor;

use crate::format::{Reader, Strictness, text};
use crate::{Abscissa, Contents, LabioError, Ordinate, Series, SeriesKind};

pub use blocks::Blocks;
pub use write::WavWriter;

use layout::Layout;

const FORMAT: &str = "wav";

/// Start of the comment that contains names and units.
const CHANNELS_COMMENT: &str = "channels: ";

/// WAVE files. As a [`Writer`](crate::format::Writer) it keeps the encoding of contents that were
/// read from a WAVE file, and uses 64-bit floating point for other contents; [`WavWriter`] sets the
/// encoding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wav;

/// Representation of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum WavEncoding {
    /// Unsigned integers of 8 bits.
    Pcm8,
    /// Integers of 16 bits.
    Pcm16,
    /// Integers of 24 bits.
    Pcm24,
    /// Integers of 32 bits.
    Pcm32,
    /// Floating point of 32 bits.
    Float32,
    /// Floating point of 64 bits.
    Float64,
}

impl WavEncoding {
    const ALL: [Self; 6] = [
        Self::Pcm8,
        Self::Pcm16,
        Self::Pcm24,
        Self::Pcm32,
        Self::Float32,
        Self::Float64,
    ];

    /// Name used in the property `encoding`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pcm8 => "PCM 8 bits",
            Self::Pcm16 => "PCM 16 bits",
            Self::Pcm24 => "PCM 24 bits",
            Self::Pcm32 => "PCM 32 bits",
            Self::Float32 => "floating point 32 bits",
            Self::Float64 => "floating point 64 bits",
        }
    }

    fn of_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|encoding| encoding.name() == name)
    }

    fn bytes(self) -> u16 {
        match self {
            Self::Pcm8 => 1,
            Self::Pcm16 => 2,
            Self::Pcm24 => 3,
            Self::Pcm32 | Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }

    /// Decodes consecutive samples. `put` receives the index of each sample and its value in
    /// fractions of full scale.
    fn decode(self, bytes: &[u8], put: impl FnMut(usize, f64)) {
        fn each<const N: usize>(
            bytes: &[u8],
            value: impl Fn([u8; N]) -> f64,
            mut put: impl FnMut(usize, f64),
        ) {
            for (index, &sample) in bytes.as_chunks::<N>().0.iter().enumerate() {
                put(index, value(sample));
            }
        }
        match self {
            Self::Pcm8 => each(bytes, |[byte]| (f64::from(byte) - 128.0) / 128.0, put),
            Self::Pcm16 => each(bytes, |b| f64::from(i16::from_le_bytes(b)) / 32_768.0, put),
            Self::Pcm24 => each(
                bytes,
                // the three bytes are the upper ones of four, so that the sign bit is in place
                |[a, b, c]| f64::from(i32::from_le_bytes([0, a, b, c])) / 2_147_483_648.0,
                put,
            ),
            Self::Pcm32 => each(
                bytes,
                |b| f64::from(i32::from_le_bytes(b)) / 2_147_483_648.0,
                put,
            ),
            Self::Float32 => each(bytes, |b| f64::from(f32::from_le_bytes(b)), put),
            Self::Float64 => each(bytes, f64::from_le_bytes, put),
        }
    }
}

impl Reader for Wav {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn recognises(&self, head: &[u8]) -> bool {
        matches!(
            head.first_chunk::<4>(),
            Some(b"RIFF" | b"RF64" | b"BW64" | b"RIFX")
        ) && head.get(8..12) == Some(b"WAVE")
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        let mut contents = Contents::of_format(FORMAT);
        let layout = Layout::read(&mut Cursor::new(bytes), strictness, &mut contents.defects)?;
        let n_channels = usize::from(layout.n_channels);
        let data = usize::try_from(layout.data_start)
            .ok()
            .zip(usize::try_from(layout.data_length).ok())
            .and_then(|(start, length)| bytes.get(start..start.checked_add(length)?))
            .unwrap_or(&[]);
        let n_frames = data.len() / layout.frame_bytes().max(1);
        let mut samples = vec![Vec::with_capacity(n_frames); n_channels];
        layout.encoding.decode(data, |index, value| {
            if let Some(channel) = samples.get_mut(index % n_channels) {
                channel.push(value);
            }
        });
        let encoding = layout.encoding.name().to_owned();
        contents.properties.push(("encoding".to_owned(), encoding));
        let mut names = None;
        for (key, value) in layout.properties {
            match value.strip_prefix(CHANNELS_COMMENT).map(parse_channels) {
                Some(kept) if key == "ICMT" && kept.len() == n_channels => names = Some(kept),
                _ => contents.properties.push((key, value)),
            }
        }
        let names = names.unwrap_or_else(|| default_channels(n_channels));
        let step = 1.0 / f64::from(layout.sampling_rate_hz);
        contents.series = names
            .into_iter()
            .zip(samples)
            .map(|((name, unit), samples)| Series {
                name,
                kind: SeriesKind::TimeResponse,
                abscissa: Abscissa::Even { start: 0.0, step },
                ordinate: Ordinate::Real(samples),
                abscissa_axis: text::axis("Time", "s"),
                ordinate_axis: text::axis("", unit),
                properties: Vec::new(),
            })
            .collect();
        Ok(contents)
    }
}

/// Returns the default names, without units.
fn default_channels(n_channels: usize) -> Vec<(String, String)> {
    (1..=n_channels)
        .map(|number| (format!("channel {number}"), String::new()))
        .collect()
}

/// Reads names and units from the comment: `hammer [N]; end A [m/s^2]`.
fn parse_channels(comment: &str) -> Vec<(String, String)> {
    comment
        .split("; ")
        .map(|channel| match channel.rsplit_once(" [") {
            Some((name, unit)) if unit.ends_with(']') => {
                (name.to_owned(), unit.trim_end_matches(']').to_owned())
            }
            _ => (channel.to_owned(), String::new()),
        })
        .collect()
}

/// Returns the comment that contains `channels`, if it can represent them.
fn channels_comment(channels: &[(String, String)]) -> Option<String> {
    let texts: Vec<String> = channels
        .iter()
        .map(|(name, unit)| match unit.as_str() {
            "" => name.clone(),
            unit => format!("{name} [{unit}]"),
        })
        .collect();
    let comment = texts.join("; ");
    (parse_channels(&comment) == channels).then(|| format!("{CHANNELS_COMMENT}{comment}"))
}
