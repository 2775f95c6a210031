//! WAVE files: bytes put together by hand from the definition, an independent library, round trips
//! and streams.

use std::io::Cursor;

use labio::format::wav::{Blocks, Wav, WavEncoding, WavWriter};
use labio::format::{Reader, Strictness};
use labio::{BlockSource, Channel, Contents, LabioError, Ordinate, Quantity, Series, SeriesKind};
use ndarray::Array2;
use proptest::prelude::*;

use crate::series::{axis, bare, bits, contents_of, defects, even, pair, real, refusals, written};

fn chunk(id: &[u8; 4], body: &[u8]) -> Vec<u8> {
    let mut bytes = id.to_vec();
    bytes.extend(u32::try_from(body.len()).unwrap().to_le_bytes());
    bytes.extend(body);
    if body.len() % 2 == 1 {
        bytes.push(0);
    }
    bytes
}

fn fmt(tag: u16, n_channels: u16, rate: u32, bits: u16) -> Vec<u8> {
    let frame = n_channels * (bits / 8);
    let mut body = tag.to_le_bytes().to_vec();
    body.extend(n_channels.to_le_bytes());
    body.extend(rate.to_le_bytes());
    body.extend((rate * u32::from(frame)).to_le_bytes());
    body.extend(frame.to_le_bytes());
    body.extend(bits.to_le_bytes());
    body
}

fn riff(chunks: &[Vec<u8>]) -> Vec<u8> {
    let body = chunks.concat();
    let mut bytes = b"RIFF".to_vec();
    bytes.extend(u32::try_from(body.len() + 4).unwrap().to_le_bytes());
    bytes.extend(b"WAVE");
    bytes.extend(body);
    bytes
}

/// Two channels of three samples in 16 bits.
fn pcm16() -> Vec<u8> {
    let samples: [i16; 6] = [0, -32768, 16384, 32767, -1, 8192];
    let data: Vec<u8> = samples.iter().flat_map(|s| s.to_le_bytes()).collect();
    riff(&[chunk(b"fmt ", &fmt(1, 2, 48000, 16)), chunk(b"data", &data)])
}

fn read(bytes: &[u8]) -> Result<Contents, LabioError> {
    Wav.read(bytes, Strictness::Strict)
}

#[test]
fn integers_become_fractions_of_full_scale() {
    let contents = read(&pcm16()).unwrap();
    assert_eq!(real(&contents, 0), [0.0, 0.5, -1.0 / 32768.0]);
    assert_eq!(real(&contents, 1), [-1.0, 32767.0 / 32768.0, 0.25]);
    let step = 1.0 / 48000.0;
    assert_eq!(contents.series[1].abscissa, even(0.0, step));
    assert_eq!(contents.series[1].name, "channel 2");
    assert_eq!(contents.properties, [pair("encoding", "PCM 16 bits")]);

    // 24 bits in an extensible header, with another chunk and a text before the samples
    let mut extensible = fmt(0xfffe, 1, 44100, 24);
    extensible.extend([22, 0, 24, 0, 4, 0, 0, 0]);
    extensible.extend([
        1, 0, 0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71,
    ]);
    let bytes = riff(&[
        chunk(b"fmt ", &extensible),
        chunk(b"cue ", &[0; 5]),
        chunk(b"LIST", b"INFOINAM\x05\0\0\0test\0\0"),
        chunk(b"data", &[0xff, 0xff, 0x7f, 0x00, 0x00, 0x80, 0x01, 0, 0]),
    ]);
    let contents = read(&bytes).unwrap();
    let last = 1.0 / 8_388_608.0;
    assert_eq!(real(&contents, 0), [1.0 - last, -1.0, last]);
    assert_eq!(
        contents.properties[1],
        pair("chunk cue ", "5 bytes, skipped")
    );
    assert_eq!(contents.properties[2], pair("INAM", "test"));

    // a padding byte follows an odd number of unsigned 8-bit samples
    let bytes = riff(&[
        chunk(b"fmt ", &fmt(1, 1, 8000, 8)),
        chunk(b"data", &[0, 128, 255]),
    ]);
    assert_eq!(real(&read(&bytes).unwrap(), 0), [-1.0, 0.0, 127.0 / 128.0]);
}

/// Two samples of 64 bits in a file whose header allows more than 4 GiB.
fn rf64(id: &[u8; 4]) -> Vec<u8> {
    let mut bytes = id.to_vec();
    bytes.extend([0xff; 4]);
    bytes.extend(b"WAVEds64");
    bytes.extend(28_u32.to_le_bytes());
    bytes.extend(88_u64.to_le_bytes()); // 4 + 36 + 24 + 8 + 16
    bytes.extend(16_u64.to_le_bytes());
    bytes.extend(2_u64.to_le_bytes());
    bytes.extend(0_u32.to_le_bytes());
    bytes.extend(chunk(b"fmt ", &fmt(3, 1, 51200, 64)));
    bytes.extend(b"data\xff\xff\xff\xff");
    bytes.extend(std::f64::consts::PI.to_le_bytes());
    bytes.extend((-1e300_f64).to_le_bytes());
    bytes
}

#[test]
fn long_files_hold_their_lengths_elsewhere() {
    for id in [b"RF64", b"BW64"] {
        let bytes = rf64(id);
        assert!(Wav.recognises(&bytes));
        let contents = read(&bytes).unwrap();
        assert_eq!(real(&contents, 0), [std::f64::consts::PI, -1e300]);
    }
}

fn history(name: &str, samples: Vec<f64>) -> Series {
    Series {
        name: name.to_owned(),
        kind: SeriesKind::TimeResponse,
        abscissa: even(0.0, 1.0 / 51200.0),
        abscissa_axis: axis("Time", "s"),
        ..bare(name, Ordinate::Real(samples))
    }
}

fn write(encoding: WavEncoding, contents: &Contents) -> Result<Vec<u8>, LabioError> {
    written(&WavWriter { encoding }, contents)
}

#[test]
fn an_independent_library_reads_what_is_written() {
    let samples = vec![0.0, 0.5, -1.0, 0.999];
    let given = contents_of(vec![history("channel 1", samples.clone())]);
    for (encoding, full) in [
        (WavEncoding::Pcm16, 32768.0),
        (WavEncoding::Pcm24, 8_388_608.0),
    ] {
        let bytes = write(encoding, &given).unwrap();
        let mut reader = hound::WavReader::new(bytes.as_slice()).unwrap();
        assert_eq!(reader.spec().sample_rate, 51200);
        let levels: Vec<i32> = reader.samples().map(Result::unwrap).collect();
        let expected: Vec<i32> = samples
            .iter()
            .map(|s: &f64| (s * full).round() as i32)
            .collect();
        assert_eq!(levels, expected);
    }
    let bytes = write(WavEncoding::Float32, &given).unwrap();
    let mut reader = hound::WavReader::new(bytes.as_slice()).unwrap();
    let values: Vec<f32> = reader.samples().map(Result::unwrap).collect();
    assert_eq!(values, [0.0, 0.5, -1.0, 0.999]);
}

#[test]
fn names_and_units_survive() {
    let mut given = contents_of(vec![
        history("hammer", vec![0.5]),
        history("end A [mid]", vec![1.5]),
    ]);
    given.series[0].ordinate_axis.unit_text = "N".to_owned();
    given.series[1].ordinate_axis.unit_text = "m/s^2".to_owned();
    let back = read(&write(WavEncoding::Float64, &given).unwrap()).unwrap();
    assert_eq!(back.series[0].name, "hammer");
    assert_eq!(back.series[0].ordinate_axis.unit_text, "N");
    assert_eq!(back.series[1].name, "end A [mid]");
}

#[test]
fn what_does_not_fit_is_refused_before_the_first_byte() {
    let good = || history("a", vec![0.25, -0.5]);
    let with = |change: fn(&mut Series)| {
        let mut series = good();
        change(&mut series);
        contents_of(vec![good(), series])
    };
    let mut described = contents_of(vec![good()]);
    described.properties.push(pair("Operator", "me"));
    let as_float = |given: &Contents| write(WavEncoding::Float64, given);
    let alone = |samples| contents_of(vec![history("a", samples)]);
    let at = |start, step| {
        let abscissa = even(start, step);
        contents_of(vec![Series { abscissa, ..good() }])
    };
    let refusals = [
        write(WavEncoding::Pcm16, &alone(vec![0.0, 1.0])),
        write(WavEncoding::Pcm24, &alone(vec![f64::NAN])),
        write(WavEncoding::Float32, &alone(vec![1e39])),
        as_float(&contents_of(Vec::new())),
        as_float(&described),
        as_float(&with(|s| s.name = "x; y".to_owned())),
        as_float(&with(|s| s.ordinate = Ordinate::Real(vec![1.0]))),
        as_float(&with(|s| s.ordinate = Ordinate::Complex(Vec::new()))),
        as_float(&with(|s| s.kind = SeriesKind::Coherence)),
        as_float(&with(|s| s.abscissa_axis.unit_text = "ms".to_owned())),
        as_float(&with(|s| {
            s.properties.push(pair("block", "1"));
        })),
        as_float(&at(0.0, 0.3)),
        as_float(&at(1.0, 0.5)),
    ]
    .map(|result| result.unwrap_err().to_string())
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    wav cannot hold sample 1 of `a`, 1, as PCM 16 bits
    wav cannot hold sample 0 of `a`, NaN, as PCM 24 bits
    wav cannot hold sample 0 of `a`, 1000000000000000000000000000000000000000, as floating point 32 bits
    wav cannot hold contents without a series
    wav cannot hold the property `Operator`; remove it to write the samples alone
    wav cannot hold names or units with `; `, ` [`, `]` or a zero byte in them
    wav cannot hold `a`, whose times differ from those of `a`
    wav cannot hold `a`, whose times differ from those of `a`
    wav cannot hold `a`, which is not a history
    wav cannot hold `a`, whose abscissa is not in s
    wav cannot hold the property `block` of `a`; remove it to write the samples alone
    wav cannot hold a time step of 0.3 s; only the reciprocal of a whole number of Hz
    wav cannot hold a start at 1 s; only at 0
    ");
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let whole = pcm16();
    let edit = |at: usize, bytes: &[u8]| {
        let mut edited = whole.clone();
        edited[at..at + bytes.len()].copy_from_slice(bytes);
        edited
    };
    let mut longer = whole.clone();
    longer.extend([0; 7]);
    let mut riff_only = whole.clone();
    riff_only[4..8].copy_from_slice(&20_u32.to_le_bytes());
    let mut huge = rf64(b"RF64");
    huge[28..36].copy_from_slice(&u64::MAX.to_le_bytes());
    let wrong = [
        Vec::new(),
        b"RIFF".to_vec(),
        edit(0, b"RIFX"),
        edit(8, b"AVI "),
        whole[..30].to_vec(),
        whole[..whole.len() - 5].to_vec(),
        longer,
        riff_only,
        edit(12, b"fmtx"),
        edit(16, &8_u32.to_le_bytes()),
        edit(20, &85_u16.to_le_bytes()),
        edit(20, &0xfffe_u16.to_le_bytes()),
        edit(22, &0_u16.to_le_bytes()),
        edit(24, &0_u32.to_le_bytes()),
        edit(32, &5_u16.to_le_bytes()),
        edit(34, &12_u16.to_le_bytes()),
        edit(36, b"date"),
        edit(40, &11_u32.to_le_bytes()),
        edit(40, &u32::MAX.to_le_bytes()),
        huge,
    ]
    .map(|bytes| read(&bytes));
    insta::assert_snapshot!(refusals(wrong), @r"
    the wav data end 12 bytes too early
    the wav data end 8 bytes too early
    wav, byte 0: first twelve bytes is `RIFX0\u{0}\u{0}\u{0}WAVE`, expected `RIFF`, `RF64` or `BW64` and `WAVE`, little-endian
    wav, byte 0: first twelve bytes is `RIFF0\u{0}\u{0}\u{0}AVI `, expected `RIFF`, `RF64` or `BW64` and `WAVE`, little-endian
    the wav data end 26 bytes too early
    the wav data end 5 bytes too early
    7 bytes follow the wav data
    28 bytes follow the wav data
    wav, byte 36: chunk is `data`, expected `fmt ` before it
    wav, byte 16: length of `fmt ` is 8 bytes, expected at least 16
    wav, byte 20: format is tag 85 with 16 bits, expected PCM (1) of 8, 16, 24 or 32 bits or floating point (3) of 32 or 64
    wav, byte 16: length of `fmt ` is 16 bytes, expected 40 for an extensible format
    wav, byte 22: number of channels is 0, expected at least 1
    wav, byte 24: sampling rate [Hz] is 0, expected at least 1
    wav, byte 32: bytes of a frame is 5, expected 4, the size of 2 samples
    wav, byte 20: format is tag 1 with 12 bits, expected PCM (1) of 8, 16, 24 or 32 bits or floating point (3) of 32 or 64
    wav, byte 56: chunk is the end of the file, expected `data`
    wav, byte 40: length of the samples is 11 bytes, expected a multiple of the 4 bytes of a frame
    the wav data end 4294967283 bytes too early
    the wav data end 18446744073709551599 bytes too early
    ");
}

#[test]
fn a_tolerant_reading_returns_the_frames_that_are_there() {
    let whole = pcm16();
    let contents = Wav
        .read(&whole[..whole.len() - 5], Strictness::Tolerant)
        .unwrap();
    assert_eq!(real(&contents, 1), [-1.0]);
    insta::assert_snapshot!(defects(&contents), @r"
    the wav data end 5 bytes too early
    the wav data end 5 bytes too early
    wav, byte 40: length of the samples is 7 bytes, expected a multiple of the 4 bytes of a frame
    ");
}

#[test]
fn a_stream_delivers_the_same_samples_in_si() {
    let channels = [
        Channel::new("hammer", Quantity::Force).unwrap(),
        Channel::new("end A", Quantity::Acceleration).unwrap(),
    ];
    let n = 40_000; // more than is read at once
    let samples = |c: i32| {
        (0..n)
            .map(|i| f64::from((i * (7 + c)) % 1000) / 1024.0)
            .collect::<Vec<_>>()
    };
    let given = contents_of(vec![
        history("channel 1", samples(0)),
        history("channel 2", samples(1)),
    ]);
    for encoding in [WavEncoding::Pcm24, WavEncoding::Float64] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.wav");
        std::fs::write(&path, write(encoding, &given).unwrap()).unwrap();
        let mut blocks = Blocks::open(&path, &channels, &[200.0, 4.0]).unwrap();
        assert_eq!(blocks.n_samples(), Some(40_000));
        assert_eq!(blocks.sampling_rate_hz(), 51200.0);
        let mut block = Array2::zeros((2, 3001));
        let mut streamed: [Vec<f64>; 2] = Default::default();
        loop {
            let n = blocks.read_block(&mut block).unwrap();
            for (channel, row) in streamed.iter_mut().zip(block.rows()) {
                channel.extend(row.iter().take(n));
            }
            if n < 3001 {
                assert_eq!(blocks.read_block(&mut block).unwrap(), 0);
                break;
            }
        }
        for (channel, (c, scale)) in streamed.iter().zip([(0, 200.0), (1, 4.0)]) {
            let expected: Vec<f64> = samples(c).iter().map(|s| s * scale).collect();
            assert_eq!(channel, &expected);
        }
        let error = blocks.read_block(&mut Array2::zeros((1, 5))).unwrap_err();
        assert_eq!(
            error.to_string(),
            "rows of the block, one per channel: found 1, expected 2"
        );
    }
    let mut spoiled = given;
    spoiled.series[1].ordinate = Ordinate::Real(
        (0..n)
            .map(|i| if i == 39_000 { f64::NAN } else { 0.0 })
            .collect(),
    );
    let bytes = Cursor::new(write(WavEncoding::Float32, &spoiled).unwrap());
    let mut blocks = Blocks::new(bytes, &channels, &[1.0, 1.0]).unwrap();
    let mut block = Array2::zeros((2, 38_500));
    assert_eq!(blocks.read_block(&mut block).unwrap(), 38_500);
    assert_eq!(
        blocks.read_block(&mut block).unwrap_err().to_string(),
        "sample 39000 of channel `end A` is NaN, expected a finite value"
    );
    let bytes = Cursor::new(pcm16());
    let error = Blocks::new(bytes.clone(), &channels[..1], &[1.0]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "channels for those of the file: found 1, expected 2"
    );
    let error = Blocks::new(bytes, &channels, &[1.0, -1.0]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "full scale [SI unit of the channel] is -1, expected a finite value above 0"
    );
}

pub(crate) fn whole() -> [Vec<u8>; 2] {
    [pcm16(), rf64(b"RF64")]
}

proptest! {
    #[test]
    fn floating_point_round_trips_to_the_bit(
        rows in (1..4_usize, 0..40_usize).prop_flat_map(|(c, n)| {
            proptest::collection::vec(proptest::collection::vec(any::<f64>(), n), c)
        }),
    ) {
        let given = contents_of(rows.iter().enumerate().map(|(c, s)| history(&format!("r{c}"), s.clone())).collect());
        let bytes = write(WavEncoding::Float64, &given).unwrap();
        let back = read(&bytes).unwrap();
        for (c, row) in rows.iter().enumerate() {
            prop_assert_eq!(bits(real(&back, c)), bits(row));
            prop_assert_eq!(&back.series[c].name, &given.series[c].name);
        }
        prop_assert_eq!(written(&Wav, &back).unwrap(), bytes);
    }

    /// Integers of every width are read back unchanged.
    #[test]
    fn integers_round_trip(levels in proptest::collection::vec(any::<i32>(), 1..40), which in 0..4_usize) {
        let (encoding, bits) = [
            (WavEncoding::Pcm8, 8), (WavEncoding::Pcm16, 16), (WavEncoding::Pcm24, 24), (WavEncoding::Pcm32, 32),
        ][which];
        let samples: Vec<f64> = levels
            .iter()
            .map(|&level| f64::from(level >> (32 - bits)) / 2.0_f64.powi(bits - 1))
            .collect();
        let given = contents_of(vec![history("channel 1", samples.clone())]);
        let bytes = write(encoding, &given).unwrap();
        let back = read(&bytes).unwrap();
        prop_assert_eq!(real(&back, 0), &samples[..]);
        prop_assert_eq!(written(&Wav, &back).unwrap(), bytes);
    }

}
