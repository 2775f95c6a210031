//! Writing of WAVE files.

use std::io::Write;

use super::{FORMAT, Wav, WavEncoding, channels_comment, default_channels};
use crate::error::{not_representable, not_written};
use crate::format::Writer;
use crate::{Abscissa, Contents, LabioError, Ordinate, Series, SeriesKind};

/// A writer of WAVE files with a chosen encoding.
///
/// The series must be time histories that start at 0 s, of the same length and of the same rate,
/// which must be a whole number of Hz. For PCM, they must be in fractions of full scale. A sample
/// beyond full scale is an error: nothing is clipped. Files beyond 4 GiB become RF64. Labels of
/// axes are not kept.
///
/// # Examples
///
/// ```
/// use labio::format::wav::{Wav, WavEncoding, WavWriter};
/// use labio::format::{Reader, Strictness, Writer};
/// # use labio::{Abscissa, Contents, Ordinate, Series, SeriesAxis, SeriesKind};
///
/// # fn main() -> Result<(), labio::LabioError> {
/// # let mut contents = Contents::of_format("computed");
/// # contents.series.push(Series {
/// #     name: "hammer".to_owned(), kind: SeriesKind::TimeResponse,
/// #     abscissa: Abscissa::Even { start: 0.0, step: 1.0 / 8000.0 },
/// #     ordinate: Ordinate::Real(vec![0.0, 0.5, -0.25]),
/// #     abscissa_axis: SeriesAxis { unit_text: "s".to_owned(), ..Default::default() },
/// #     ordinate_axis: SeriesAxis::default(), properties: Vec::new(),
/// # });
/// let mut bytes = Vec::new();
/// WavWriter { encoding: WavEncoding::Pcm24 }.write(&contents, &mut bytes)?;
/// let back = Wav.read(&bytes, Strictness::Strict)?;
/// assert_eq!(back.series[0].name, "hammer");
/// assert_eq!(back.series[0].ordinate, contents.series[0].ordinate);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WavWriter {
    /// Representation of the samples.
    pub encoding: WavEncoding,
}

impl Writer for WavWriter {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn write(&self, contents: &Contents, output: &mut dyn Write) -> Result<(), LabioError> {
        write(self.encoding, contents, output)
    }
}

impl Writer for Wav {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn write(&self, contents: &Contents, output: &mut dyn Write) -> Result<(), LabioError> {
        let encoding = contents
            .properties
            .iter()
            .find(|(key, _)| key == "encoding")
            .and_then(|(_, name)| WavEncoding::of_name(name))
            .unwrap_or(WavEncoding::Float64);
        write(encoding, contents, output)
    }
}

fn cannot_hold(what: impl Into<String>) -> LabioError {
    not_representable(FORMAT, what.into())
}

/// Contents that have been checked to be representable in the format.
struct Checked<'a> {
    samples: Vec<&'a [f64]>,
    n_frames: usize,
    sampling_rate_hz: u32,
    info: Vec<u8>,
}

fn write(
    encoding: WavEncoding,
    contents: &Contents,
    output: &mut dyn Write,
) -> Result<(), LabioError> {
    let checked = check(encoding, contents)?;
    let header = header(encoding, &checked)?;
    let mut put = |bytes: &[u8]| output.write_all(bytes).map_err(not_written);
    put(&header)?;
    // a few thousand frames at a time, so that a slow output is not called for every sample
    let mut buffer = Vec::new();
    let mut written = 0;
    for frame in 0..checked.n_frames {
        for channel in &checked.samples {
            #[allow(
                clippy::indexing_slicing,
                reason = "`check` refuses channels of different lengths"
            )]
            encode(encoding, channel[frame], &mut buffer);
        }
        if buffer.len() >= 1 << 16 {
            written += buffer.len();
            put(&buffer)?;
            buffer.clear();
        }
    }
    if !(written + buffer.len()).is_multiple_of(2) {
        buffer.push(0);
    }
    put(&buffer)?;
    put(&checked.info)
}

fn check(encoding: WavEncoding, contents: &Contents) -> Result<Checked<'_>, LabioError> {
    let Some(first) = contents.series.first() else {
        return Err(cannot_hold("contents without a series"));
    };
    let mut texts = Vec::new();
    for (key, value) in &contents.properties {
        let of_info = key.len() == 4
            && key.starts_with('I')
            && key
                .bytes()
                .all(|b| b.is_ascii_uppercase() || b.is_ascii_digit());
        if of_info && !value.contains('\0') {
            texts.push((key.as_str(), value.clone()));
        } else if key != "encoding" {
            return Err(cannot_hold(format!(
                "the property `{key}`; remove it to write the samples alone"
            )));
        }
    }
    let sampling_rate_hz = rate(first)?;
    let mut samples = Vec::new();
    for series in &contents.series {
        samples.push(check_series(encoding, series, first)?);
    }
    let names: Vec<(String, String)> = contents
        .series
        .iter()
        .map(|s| (s.name.clone(), s.ordinate_axis.unit_text.clone()))
        .collect();
    if names != default_channels(names.len()) {
        let comment = channels_comment(&names)
            .filter(|comment| !comment.contains('\0'))
            .ok_or_else(|| {
                cannot_hold("names or units with `; `, ` [`, `]` or a zero byte in them")
            })?;
        texts.push(("ICMT", comment));
    }
    Ok(Checked {
        samples,
        n_frames: first.ordinate.len(),
        sampling_rate_hz,
        info: info(&texts)?,
    })
}

fn check_series<'a>(
    encoding: WavEncoding,
    series: &'a Series,
    first: &Series,
) -> Result<&'a [f64], LabioError> {
    let name = &series.name;
    if series.kind != SeriesKind::TimeResponse {
        return Err(cannot_hold(format!("`{name}`, which is not a history")));
    }
    if series.abscissa_axis.unit_text != "s" {
        return Err(cannot_hold(format!("`{name}`, whose abscissa is not in s")));
    }
    if series.abscissa != first.abscissa || series.ordinate.len() != first.ordinate.len() {
        return Err(cannot_hold(format!(
            "`{name}`, whose times differ from those of `{}`",
            first.name
        )));
    }
    if let Some((key, _)) = series.properties.first() {
        return Err(cannot_hold(format!(
            "the property `{key}` of `{name}`; remove it to write the samples alone"
        )));
    }
    let Ordinate::Real(samples) = &series.ordinate else {
        return Err(cannot_hold(format!("the complex numbers of `{name}`")));
    };
    if let Some((index, sample)) = samples
        .iter()
        .enumerate()
        .find(|(_, sample)| !fits(encoding, **sample))
    {
        return Err(cannot_hold(format!(
            "sample {index} of `{name}`, {sample}, as {}",
            encoding.name()
        )));
    }
    Ok(samples)
}

/// Returns the rate if it is a whole number of Hz and gives exactly the step.
fn rate(series: &Series) -> Result<u32, LabioError> {
    let Abscissa::Even { start, step } = series.abscissa else {
        return Err(cannot_hold("uneven times"));
    };
    if start != 0.0 {
        return Err(cannot_hold(format!("a start at {start} s; only at 0")));
    }
    let rate = (1.0 / step).round();
    if !(rate >= 1.0 && rate <= f64::from(u32::MAX) && (1.0 / rate).to_bits() == step.to_bits()) {
        return Err(cannot_hold(format!(
            "a time step of {step} s; only the reciprocal of a whole number of Hz"
        )));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole and within the range of the type, as just checked"
    )]
    Ok(rate as u32)
}

/// Largest magnitude that an integer encoding can represent.
fn full_scale(encoding: WavEncoding) -> f64 {
    2.0_f64.powi(8 * i32::from(encoding.bytes()) - 1)
}

fn fits(encoding: WavEncoding, sample: f64) -> bool {
    match encoding {
        WavEncoding::Float64 => true,
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the rounding to single precision was requested, and its overflow is checked"
        )]
        WavEncoding::Float32 => (sample as f32).is_finite() || !sample.is_finite(),
        _ => {
            let full = full_scale(encoding);
            let level = (sample * full).round();
            level >= -full && level < full
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "every sample has been found to fit"
)]
fn encode(encoding: WavEncoding, sample: f64, to: &mut Vec<u8>) {
    let level = || (sample * full_scale(encoding)).round() as i32;
    match encoding {
        WavEncoding::Float64 => to.extend(sample.to_le_bytes()),
        WavEncoding::Float32 => to.extend((sample as f32).to_le_bytes()),
        WavEncoding::Pcm8 => to.push((level() + 128) as u8),
        WavEncoding::Pcm16 => to.extend((level() as i16).to_le_bytes()),
        WavEncoding::Pcm24 => {
            let [a, b, c, _] = level().to_le_bytes();
            to.extend([a, b, c]);
        }
        WavEncoding::Pcm32 => to.extend(level().to_le_bytes()),
    }
}

/// Returns a list of texts, or nothing if there are none.
fn info(texts: &[(&str, String)]) -> Result<Vec<u8>, LabioError> {
    if texts.is_empty() {
        return Ok(Vec::new());
    }
    let too_long = |_| cannot_hold("a text of more than 4 GiB");
    let mut body = b"INFO".to_vec();
    for (key, text) in texts {
        body.extend(key.bytes());
        body.extend(
            u32::try_from(text.len() + 1)
                .map_err(too_long)?
                .to_le_bytes(),
        );
        body.extend(text.bytes());
        body.push(0);
        if !body.len().is_multiple_of(2) {
            body.push(0);
        }
    }
    let mut list = b"LIST".to_vec();
    list.extend(u32::try_from(body.len()).map_err(too_long)?.to_le_bytes());
    list.extend(body);
    Ok(list)
}

/// Returns the bytes before the samples.
fn header(encoding: WavEncoding, checked: &Checked<'_>) -> Result<Vec<u8>, LabioError> {
    let n_channels = u16::try_from(checked.samples.len())
        .map_err(|_| cannot_hold(format!("{} channels", checked.samples.len())))?;
    let frame_bytes = n_channels
        .checked_mul(encoding.bytes())
        .ok_or_else(|| cannot_hold(format!("{n_channels} channels of {}", encoding.name())))?;
    let data_length = checked.n_frames as u64 * u64::from(frame_bytes);
    let float = matches!(encoding, WavEncoding::Float32 | WavEncoding::Float64);
    let mut format = Vec::new();
    format.extend(u16::to_le_bytes(if float { 3 } else { 1 }));
    format.extend(n_channels.to_le_bytes());
    format.extend(checked.sampling_rate_hz.to_le_bytes());
    // bytes per second, for players; the largest value if the true one does not fit
    let bytes_a_second = u64::from(checked.sampling_rate_hz) * u64::from(frame_bytes);
    format.extend(
        u32::try_from(bytes_a_second)
            .unwrap_or(u32::MAX)
            .to_le_bytes(),
    );
    format.extend(frame_bytes.to_le_bytes());
    format.extend((8 * encoding.bytes()).to_le_bytes());
    if float {
        format.extend([0, 0]); // no extension
    }
    let mut chunks = Vec::new();
    let mut chunk = |id: &[u8; 4], body: &[u8]| {
        chunks.extend(id);
        chunks.extend(u32::try_from(body.len()).unwrap_or(u32::MAX).to_le_bytes());
        chunks.extend(body);
    };
    chunk(b"fmt ", &format);
    if float {
        let frames = u32::try_from(checked.n_frames).unwrap_or(u32::MAX);
        chunk(b"fact", &frames.to_le_bytes());
    }
    let padded = data_length + data_length % 2;
    let riff_length = 4 + chunks.len() as u64 + 8 + padded + checked.info.len() as u64;
    let mut header = Vec::new();
    match (u32::try_from(riff_length), u32::try_from(data_length)) {
        (Ok(riff), Ok(data)) => {
            header.extend(b"RIFF");
            header.extend(riff.to_le_bytes());
            header.extend(b"WAVE");
            header.extend(chunks);
            header.extend(b"data");
            header.extend(data.to_le_bytes());
        }
        _ => {
            header.extend(b"RF64");
            header.extend(u32::MAX.to_le_bytes());
            header.extend(b"WAVEds64");
            header.extend(28_u32.to_le_bytes());
            header.extend((riff_length + 36).to_le_bytes());
            header.extend(data_length.to_le_bytes());
            header.extend((checked.n_frames as u64).to_le_bytes());
            header.extend(0_u32.to_le_bytes()); // no other chunks beyond 4 GiB
            header.extend(chunks);
            header.extend(b"data");
            header.extend(u32::MAX.to_le_bytes());
        }
    }
    Ok(header)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_four_gib_the_lengths_stand_in_their_own_chunk() {
        // the samples of one channel are used for all channels: the header needs only their number
        let one = [0.0; 1];
        let checked = Checked {
            samples: vec![&one; 100],
            n_frames: 20_000_000,
            sampling_rate_hz: 51_200,
            info: Vec::new(),
        };
        let header = header(WavEncoding::Float64, &checked).unwrap();
        assert!(header.starts_with(b"RF64\xff\xff\xff\xffWAVEds64\x1c\0\0\0"));
        let data_length = 16_000_000_000_u64;
        assert_eq!(header[28..36], data_length.to_le_bytes());
        let riff_length = header.len() as u64 - 8 + data_length;
        assert_eq!(header[20..28], riff_length.to_le_bytes());
        assert!(header.ends_with(b"data\xff\xff\xff\xff"));
    }
}
