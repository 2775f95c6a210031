//! Benchmarks of reading and writing records of the size of one hit, and of streaming long records.
//!
//! Lower bounds of the times are measured as well. For text, numbers are parsed or printed one by
//! one with the standard library; for binary formats, the bytes are copied.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    clippy::indexing_slicing,
    reason = "a benchmark fails by a panic; the macro of criterion documents nothing"
)]

use std::fmt::Write as _;
use std::hint::black_box;
use std::io::Cursor;

use criterion::{Criterion, criterion_group, criterion_main};
use labio::format::csv::Csv;
use labio::format::lvm::Lvm;
use labio::format::npz::Npz;
use labio::format::wav::{Blocks, Wav, WavEncoding, WavWriter};
use labio::format::{Reader, Strictness, Writer, npy};
use labio::{
    Abscissa, BlockSource, Channel, Contents, Ordinate, Quantity, Series, SeriesAxis, SeriesKind,
};
use ndarray::Array2;

const RATE_HZ: f64 = 51_200.0;

/// One second of two channels, whose samples have all digits of a double.
fn hit() -> Contents {
    let axis = |label: &str, unit_text: &str| SeriesAxis {
        label: label.to_owned(),
        unit_text: unit_text.to_owned(),
        unit: None,
    };
    let channel = |name: &str, unit: &str, frequency: f64| Series {
        name: name.to_owned(),
        kind: SeriesKind::TimeResponse,
        abscissa: Abscissa::Even {
            start: 0.0,
            step: 1.0 / RATE_HZ,
        },
        ordinate: Ordinate::Real(
            (0..51_200)
                .map(|n| 0.9 * (f64::from(n) * frequency).sin())
                .collect(),
        ),
        abscissa_axis: axis("Time", "s"),
        ordinate_axis: axis("", unit),
        properties: Vec::new(),
    };
    let mut contents = Contents::of_format("computed");
    contents.series = vec![channel("force", "N", 0.1), channel("end A", "m/s^2", 0.37)];
    contents
}

fn written(writer: &dyn Writer, contents: &Contents) -> Vec<u8> {
    let mut bytes = Vec::new();
    writer.write(contents, &mut bytes).unwrap();
    bytes
}

/// Text of a LabVIEW file with these contents, in six decimals.
fn lvm(contents: &Contents) -> String {
    let mut text = "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tNo\nX_Columns\tOne\n***End_of_Header***\t\n\nChannels\t2\nSamples\t51200\t51200\nX0\t0\t0\nDelta_X\t1.953125E-5\t1.953125E-5\n***End_of_Header***\nX_Value\tforce\tend A\tComment\n".to_owned();
    let Ordinate::Real(force) = &contents.series[0].ordinate else {
        return text;
    };
    let Ordinate::Real(response) = &contents.series[1].ordinate else {
        return text;
    };
    for (n, (force, response)) in force.iter().zip(response).enumerate() {
        writeln!(text, "{:.6}\t{force:.6}\t{response:.6}", n as f64 / RATE_HZ).unwrap();
    }
    text
}

fn one_hit(criterion: &mut Criterion) {
    let contents = hit();
    let mut group = criterion.benchmark_group("2 channels x 51200");
    let cases: [(&dyn Reader, Vec<u8>); 4] = [
        (&Lvm, lvm(&contents).into_bytes()),
        (&Csv, written(&Csv, &contents)),
        (&Wav, written(&Wav, &contents)),
        (&Npz, written(&Npz, &contents)),
    ];
    for (reader, bytes) in &cases {
        group.bench_function(format!("read {}", reader.name()), |bencher| {
            bencher.iter(|| reader.read(bytes, Strictness::Strict).unwrap());
        });
    }
    for (reader, bytes) in &cases[..2] {
        let numbers = numbers(bytes);
        group.bench_function(format!("numbers of {} alone", reader.name()), |bencher| {
            bencher.iter(|| -> f64 {
                let numbers = black_box(&numbers).iter();
                numbers.map(|number| number.parse::<f64>().unwrap()).sum()
            });
        });
    }
    let (_, npz) = &cases[3];
    group.bench_function("copy of npz", |bencher| {
        bencher.iter(|| black_box(npz).clone());
    });
    let writers: [&dyn Writer; 3] = [&Csv, &Wav, &Npz];
    for writer in writers {
        group.bench_function(format!("write {}", writer.name()), |bencher| {
            bencher.iter(|| written(writer, &contents));
        });
    }
}

/// Returns those fields of a text that are numbers.
fn numbers(bytes: &[u8]) -> Vec<&str> {
    let text = std::str::from_utf8(bytes).unwrap();
    let fields = text.split([',', '\t', '\n', ' ']);
    let numbers: Vec<&str> = fields
        .filter(|field| field.parse::<f64>().is_ok())
        .collect();
    assert!(numbers.len() >= 3 * 51_200);
    numbers
}

fn streams(criterion: &mut Criterion) {
    const N: usize = 1 << 20;
    let channels = [Channel::new("force", Quantity::Force).unwrap()];
    let samples: Vec<f64> = (0..N).map(|n| 0.9 * (n as f64 * 0.1).sin()).collect();
    let mut contents = hit();
    contents.series.truncate(1);
    contents.series[0].ordinate = Ordinate::Real(samples.clone());
    let mut array =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': (1, {N}), }}\n").into_bytes();
    let length = u16::try_from(array.len()).unwrap().to_le_bytes();
    array.splice(0..0, b"\x93NUMPY\x01\x00".iter().copied().chain(length));
    array.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
    let mut block = Array2::zeros((1, 8192));
    let mut group = criterion.benchmark_group("stream of 2^20 in blocks of 8192");
    for encoding in [WavEncoding::Pcm24, WavEncoding::Float64] {
        let bytes = written(&WavWriter { encoding }, &contents);
        group.bench_function(format!("wav, {}", encoding.name()), |bencher| {
            bencher.iter(|| {
                let mut source =
                    Blocks::new(Cursor::new(bytes.as_slice()), &channels, &[1.0]).unwrap();
                while source.read_block(&mut block).unwrap() > 0 {}
            });
        });
    }
    group.bench_function("npy", |bencher| {
        bencher.iter(|| {
            let source = Cursor::new(array.as_slice());
            let mut source = npy::Blocks::without_times(source, &channels, RATE_HZ).unwrap();
            while source.read_block(&mut block).unwrap() > 0 {}
        });
    });
}

criterion_group!(benches, one_hit, streams);
criterion_main!(benches);
