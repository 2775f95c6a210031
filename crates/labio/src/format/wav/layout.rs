//! The chunks of a WAVE file, read without its samples.

use std::io::{Read, Seek, SeekFrom};

use super::{FORMAT, WavEncoding};
use crate::error::{self, not_read, truncated};
use crate::format::{Strictness, text};
use crate::{LabioError, Place};

/// Greatest length of a text chunk that is read.
const LONGEST_TEXT: u64 = 1 << 20;

/// End of the sub-format identifier of plain waves, after the two bytes of the format tag.
const SUBFORMAT: [u8; 14] = [
    0x00, 0x00, 0x00, 0x00, 0x10, 0x00, 0x80, 0x00, 0x00, 0xaa, 0x00, 0x38, 0x9b, 0x71,
];

/// Length stated for a chunk whose writer did not set it.
const OPEN: u32 = u32::MAX;

/// Layout of the file and format of its samples.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) encoding: WavEncoding,
    pub(super) n_channels: u16,
    pub(super) sampling_rate_hz: u32,
    /// Offset of the first byte of the samples.
    pub(super) data_start: u64,
    /// Number of existing sample bytes, a multiple of the bytes per frame.
    pub(super) data_length: u64,
    pub(super) properties: Vec<(String, String)>,
}

/// Representation, channels and rate.
struct Sound {
    encoding: WavEncoding,
    n_channels: u16,
    sampling_rate_hz: u32,
}

impl Layout {
    /// Returns the number of bytes of a frame: one sample of every channel.
    pub(super) fn frame_bytes(&self) -> usize {
        usize::from(self.n_channels) * usize::from(self.encoding.bytes())
    }

    pub(super) fn read(
        source: &mut (impl Read + Seek),
        strictness: Strictness,
        defects: &mut Vec<LabioError>,
    ) -> Result<Self, LabioError> {
        let mut defect = |error| strictness.pass_over(error, defects);
        let mut chunks = Chunks::new(source)?;
        chunks.check_end(&mut defect)?;
        let (mut sound, mut data) = (None, None);
        let mut properties = Vec::new();
        while let Some(chunk) = chunks.next()? {
            let there = chunk.length.min(chunks.end.saturating_sub(chunk.start));
            match &chunk.id {
                b"fmt " if sound.is_none() => sound = Some(read_fmt(&mut chunks, &chunk)?),
                b"data" if data.is_none() => {
                    let Some(sound) = &sound else {
                        return Err(malformed(
                            chunk.start - 8,
                            "chunk",
                            "`data`",
                            "`fmt ` before it",
                        ));
                    };
                    if there < chunk.length {
                        defect(truncated(FORMAT, chunk.length - there))?;
                    }
                    let frame = u64::from(sound.n_channels) * u64::from(sound.encoding.bytes());
                    let torn = there % frame;
                    if torn > 0 {
                        let expected = format!("a multiple of the {frame} bytes of a frame");
                        defect(malformed(
                            chunk.start - 4,
                            "length of the samples",
                            &format!("{there} bytes"),
                            &expected,
                        ))?;
                    }
                    data = Some((chunk.start, there - torn));
                }
                b"LIST" if there == chunk.length && there <= LONGEST_TEXT => {
                    info(&chunks.body(&chunk, there)?, &mut properties);
                }
                b"bext" if there == chunk.length && there >= 346 => {
                    bext(&chunks.body(&chunk, 346)?, &mut properties);
                }
                b"fact" | b"ds64" | b"JUNK" | b"PAD " | b"FLLR" => {}
                other => {
                    let key = format!("chunk {}", String::from_utf8_lossy(other));
                    properties.push((key, format!("{} bytes, skipped", chunk.length)));
                }
            }
        }
        if chunks.torn_header {
            defect(malformed(
                chunks.end,
                "chunk",
                "the end of the file",
                "its name and length",
            ))?;
        }
        let absent = |id: &str| malformed(chunks.end, "chunk", "the end of the file", id);
        let sound = sound.ok_or_else(|| absent("`fmt `"))?;
        let (data_start, data_length) = data.ok_or_else(|| absent("`data`"))?;
        Ok(Self {
            encoding: sound.encoding,
            n_channels: sound.n_channels,
            sampling_rate_hz: sound.sampling_rate_hz,
            data_start,
            data_length,
            properties,
        })
    }
}

fn malformed(byte: u64, field: &str, found: &str, expected: &str) -> LabioError {
    error::malformed(FORMAT, Place::Byte(byte), field, found, expected)
}

struct Chunk {
    id: [u8; 4],
    /// Offset of the first byte of the body.
    start: u64,
    /// Announced length of the body in bytes.
    length: u64,
}

/// An iteration over the chunks.
struct Chunks<'a, R> {
    source: &'a mut R,
    next: u64,
    /// The end of the file, or the end announced by the first header if that comes earlier.
    end: u64,
    file_length: u64,
    announced_end: Option<u64>,
    /// Length of the samples as stated before all chunks, in a file beyond 4 GiB.
    long_data: Option<u64>,
    torn_header: bool,
}

impl<'a, R: Read + Seek> Chunks<'a, R> {
    fn new(source: &'a mut R) -> Result<Self, LabioError> {
        let file_length = source.seek(SeekFrom::End(0)).map_err(not_read)?;
        let mut chunks = Self {
            source,
            next: 12,
            end: file_length,
            file_length,
            announced_end: None,
            long_data: None,
            torn_header: false,
        };
        let start = chunks.bytes::<12>(0)?;
        let [a, b, c, d, e, f, g, h, w, x, y, z] = start;
        let (id, length) = ([a, b, c, d], u32::from_le_bytes([e, f, g, h]));
        if [w, x, y, z] != *b"WAVE" || !matches!(&id, b"RIFF" | b"RF64" | b"BW64") {
            return Err(malformed(
                0,
                "first twelve bytes",
                &text::quoted(&String::from_utf8_lossy(&start)),
                "`RIFF`, `RF64` or `BW64` and `WAVE`, little-endian",
            ));
        }
        let mut riff_length = u64::from(length);
        if id != *b"RIFF" {
            let head = chunks.bytes::<8>(12)?;
            let [.., p, q, r, s] = head;
            if !head.starts_with(b"ds64") || u32::from_le_bytes([p, q, r, s]) < 28 {
                return Err(malformed(
                    12,
                    "chunk",
                    &text::quoted(&String::from_utf8_lossy(&head)),
                    "`ds64` of at least 28 bytes",
                ));
            }
            let riff = u64::from_le_bytes(chunks.bytes::<8>(20)?);
            if length == OPEN {
                riff_length = riff;
            }
            chunks.long_data = Some(u64::from_le_bytes(chunks.bytes::<8>(28)?));
        }
        chunks.announced_end = Some(riff_length.saturating_add(8));
        Ok(chunks)
    }

    /// Compares the length of the file with the length announced.
    fn check_end(
        &mut self,
        defect: &mut dyn FnMut(LabioError) -> Result<(), LabioError>,
    ) -> Result<(), LabioError> {
        let announced = self.announced_end.unwrap_or(self.file_length);
        let extra = self.file_length.saturating_sub(announced);
        if announced > self.file_length {
            defect(truncated(FORMAT, announced - self.file_length))?;
        } else if extra > 1 {
            // one byte may pad the file to an even length
            defect(LabioError::TrailingBytes {
                format: FORMAT,
                extra_bytes: usize::try_from(extra).unwrap_or(usize::MAX),
            })?;
        } else {
            self.end = announced;
        }
        Ok(())
    }

    fn bytes<const N: usize>(&mut self, at: u64) -> Result<[u8; N], LabioError> {
        let missing = (at + N as u64).saturating_sub(self.file_length);
        if missing > 0 {
            return Err(truncated(FORMAT, missing));
        }
        let mut bytes = [0; N];
        self.source.seek(SeekFrom::Start(at)).map_err(not_read)?;
        self.source.read_exact(&mut bytes).map_err(not_read)?;
        Ok(bytes)
    }

    /// Reads the first `length` bytes of the body; the caller ensures that they exist and are few.
    fn body(&mut self, chunk: &Chunk, length: u64) -> Result<Vec<u8>, LabioError> {
        let mut bytes = Vec::new();
        self.source
            .seek(SeekFrom::Start(chunk.start))
            .map_err(not_read)?;
        self.source
            .by_ref()
            .take(length)
            .read_to_end(&mut bytes)
            .map_err(not_read)?;
        Ok(bytes)
    }

    fn next(&mut self) -> Result<Option<Chunk>, LabioError> {
        let at = self.next;
        if self.end.saturating_sub(at) < 8 {
            self.torn_header = self.end > at;
            return Ok(None);
        }
        let [a, b, c, d, e, f, g, h] = self.bytes::<8>(at)?;
        let (id, length) = ([a, b, c, d], u32::from_le_bytes([e, f, g, h]));
        let length = match (length, &id, self.long_data) {
            (OPEN, b"data", Some(long)) => long,
            _ => u64::from(length),
        };
        let start = at + 8;
        // bodies are padded to an even length
        self.next = start.saturating_add(length).saturating_add(length & 1);
        Ok(Some(Chunk { id, start, length }))
    }
}

fn read_fmt<R: Read + Seek>(
    chunks: &mut Chunks<'_, R>,
    chunk: &Chunk,
) -> Result<Sound, LabioError> {
    if chunk.length < 16 {
        return Err(malformed(
            chunk.start - 4,
            "length of `fmt `",
            &format!("{} bytes", chunk.length),
            "at least 16",
        ));
    }
    let [t0, t1, c0, c1, r0, r1, r2, r3, _, _, _, _, f0, f1, b0, b1] =
        chunks.bytes::<16>(chunk.start)?;
    let mut tag = u16::from_le_bytes([t0, t1]);
    let n_channels = u16::from_le_bytes([c0, c1]);
    let sampling_rate_hz = u32::from_le_bytes([r0, r1, r2, r3]);
    let frame_bytes = u16::from_le_bytes([f0, f1]);
    let bits = u16::from_le_bytes([b0, b1]);
    if tag == 0xfffe {
        if chunk.length < 40 {
            return Err(malformed(
                chunk.start - 4,
                "length of `fmt `",
                &format!("{} bytes", chunk.length),
                "40 for an extensible format",
            ));
        }
        let [s0, s1, rest @ ..] = chunks.bytes::<16>(chunk.start + 24)?;
        if rest != SUBFORMAT {
            return Err(malformed(
                chunk.start + 24,
                "sub-format",
                &format!("{rest:02x?}"),
                "the identifier of a plain wave",
            ));
        }
        tag = u16::from_le_bytes([s0, s1]);
    }
    let encoding = match (tag, bits) {
        (1, 8) => WavEncoding::Pcm8,
        (1, 16) => WavEncoding::Pcm16,
        (1, 24) => WavEncoding::Pcm24,
        (1, 32) => WavEncoding::Pcm32,
        (3, 32) => WavEncoding::Float32,
        (3, 64) => WavEncoding::Float64,
        _ => {
            return Err(malformed(
                chunk.start,
                "format",
                &format!("tag {tag} with {bits} bits"),
                "PCM (1) of 8, 16, 24 or 32 bits or floating point (3) of 32 or 64",
            ));
        }
    };
    if n_channels == 0 {
        return Err(malformed(
            chunk.start + 2,
            "number of channels",
            "0",
            "at least 1",
        ));
    }
    if sampling_rate_hz == 0 {
        return Err(malformed(
            chunk.start + 4,
            "sampling rate [Hz]",
            "0",
            "at least 1",
        ));
    }
    let expected = u32::from(n_channels) * u32::from(encoding.bytes());
    if u32::from(frame_bytes) != expected {
        return Err(malformed(
            chunk.start + 12,
            "bytes of a frame",
            &frame_bytes.to_string(),
            &format!("{expected}, the size of {n_channels} samples"),
        ));
    }
    Ok(Sound {
        encoding,
        n_channels,
        sampling_rate_hz,
    })
}

/// Reads the texts of a list of type `INFO`, each named by four letters.
fn info(body: &[u8], properties: &mut Vec<(String, String)>) {
    let Some(mut rest) = body.strip_prefix(b"INFO") else {
        return;
    };
    while let Some(([a, b, c, d, e, f, g, h], after)) = rest.split_first_chunk::<8>() {
        let length = usize::try_from(u32::from_le_bytes([*e, *f, *g, *h])).unwrap_or(usize::MAX);
        let Some(text) = after.get(..length) else {
            return;
        };
        let key = String::from_utf8_lossy(&[*a, *b, *c, *d]).into_owned();
        properties.push((key, zero_ended(text)));
        rest = after.get(length + (length & 1)..).unwrap_or(&[]);
    }
}

/// Reads the texts of the broadcast extension, which are at fixed offsets.
fn bext(body: &[u8], properties: &mut Vec<(String, String)>) {
    let fields = [
        ("description", 0..256),
        ("originator", 256..288),
        ("originator reference", 288..320),
        ("origination date", 320..330),
        ("origination time", 330..338),
    ];
    for (key, range) in fields {
        let text = zero_ended(body.get(range).unwrap_or(&[]));
        if !text.is_empty() {
            properties.push((key.to_owned(), text));
        }
    }
}

fn zero_ended(bytes: &[u8]) -> String {
    let text = bytes.split(|&byte| byte == 0).next().unwrap_or(&[]);
    match std::str::from_utf8(text) {
        Ok(text) => text.to_owned(),
        Err(_) => text.iter().copied().map(char::from).collect(),
    }
}
