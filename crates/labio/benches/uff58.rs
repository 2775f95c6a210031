//! Benchmark of universal files of 32 769 complex lines (the response of 65 536 samples), in
//! memory: text of 13 digits, text of 6 digits and 58b. The lower bound of the times is that of
//! printing or parsing the same numbers one by one with the standard library.
#![allow(missing_docs, reason = "criterion makes a public function")]
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "a benchmark that cannot run may panic"
)]

use std::fmt::Write as _;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use labio::format::uff58::{ByteOrder, Encoding, Precision, Uff58, Uff58Writer};
use labio::format::{Reader, Strictness, Writer};
use labio::{Abscissa, Contents, Ordinate, Series, SeriesAxis, SeriesKind};
use num_complex::Complex64;

const N_LINES: usize = 32_769;

/// Receptance \[m/N\] of one mode, whose values are between 1e-10 and 1e-6 and have all digits of a
/// double.
fn receptance() -> Contents {
    let lines = (0..N_LINES).map(|line| {
        let ratio = line as f64 / 5000.3;
        1e-7 / Complex64::new(1.0 - ratio * ratio, 0.02 * ratio)
    });
    let mut contents = Contents::of_format("computed");
    contents.series.push(Series {
        name: "end A".to_owned(),
        kind: SeriesKind::FrequencyResponse,
        abscissa: Abscissa::Even {
            start: 0.0,
            step: 0.5,
        },
        ordinate: Ordinate::Complex(lines.collect()),
        abscissa_axis: SeriesAxis::default(),
        ordinate_axis: SeriesAxis::default(),
        properties: Vec::new(),
    });
    contents
}

fn universal_files(criterion: &mut Criterion) {
    let contents = receptance();
    let cases = [
        ("text, double", Encoding::Ascii, Precision::Double),
        ("text, single", Encoding::Ascii, Precision::Single),
        (
            "58b, double",
            Encoding::Binary(ByteOrder::LittleEndian),
            Precision::Double,
        ),
    ];
    let Ordinate::Complex(lines) = &contents.series[0].ordinate else {
        return;
    };
    let numbers: Vec<f64> = lines.iter().flat_map(|line| [line.re, line.im]).collect();
    let printed: Vec<String> = numbers.iter().map(|x| format!("{x:.12e}")).collect();
    criterion.bench_function("numbers of 32769 complex lines, printed", |bencher| {
        bencher.iter(|| {
            let mut text = String::new();
            for number in black_box(&numbers) {
                write!(text, "{number:.12e}").unwrap();
            }
            text
        });
    });
    criterion.bench_function("numbers of 32769 complex lines, parsed", |bencher| {
        bencher.iter(|| -> f64 {
            let printed = black_box(&printed).iter();
            printed.map(|text| text.parse::<f64>().unwrap()).sum()
        });
    });
    for (name, encoding, precision) in cases {
        let writer = Uff58Writer {
            encoding,
            precision,
        };
        let mut file = Vec::new();
        writer.write(&contents, &mut file).unwrap();
        criterion.bench_function(&format!("write 32769 complex lines, {name}"), |bencher| {
            bencher.iter(|| {
                let mut output = Vec::new();
                writer.write(black_box(&contents), &mut output).unwrap();
                output
            });
        });
        criterion.bench_function(&format!("read 32769 complex lines, {name}"), |bencher| {
            bencher.iter(|| Uff58.read(black_box(&file), Strictness::Strict).unwrap());
        });
    }
}

criterion_group!(benches, universal_files);
criterion_main!(benches);
