//! Files of other software, and files of ours written and read again.

use labio::format::csv::Csv;
use labio::format::mat5::Mat5;
use labio::format::npz::Npz;
use labio::format::uff58::{ByteOrder, Encoding, Precision, Uff58, Uff58Writer};
use labio::format::wav::{Wav, WavEncoding, WavWriter};
use labio::format::{Reader, Strictness, Writer};
use labio::{Abscissa, Contents, Ordinate, Series, SeriesAxis, SeriesKind, Unit};
use num_complex::Complex64;

use testbed::claim::{Claim, Claims, Fallible, Found};
use testbed::difference::largest;
use testbed::hold;

const NPZ: &[u8] = include_bytes!("../../../../fixtures/reference/npz/savez.npz");
const PLAIN: &[u8] = include_bytes!("../../../../fixtures/reference/mat5/plain.mat");
const PACKED: &[u8] = include_bytes!("../../../../fixtures/reference/mat5/packed.mat");

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    other_software(&mut report);
    round_trips(&mut report);
    hold!(report);
}

fn values(contents: &Contents, name: &str) -> Fallible<Vec<Complex64>> {
    let series = contents.series.iter().find(|series| series.name == name);
    match series.map(|series| &series.ordinate) {
        Some(Ordinate::Real(values)) => Ok(values.iter().map(|&value| value.into()).collect()),
        Some(Ordinate::Complex(values)) => Ok(values.clone()),
        None => Err(format!("no series {name}").into()),
    }
}

/// Number of values that are not those expected.
fn wrong(found: &[Complex64], expected: &[Complex64]) -> f64 {
    let pairs = found.iter().zip(expected);
    let unlike = pairs.filter(|(f, e)| (*f - *e).norm() > 0.0).count();
    unlike as f64 + (found.len() as f64 - expected.len() as f64).abs()
}

/// Variable of a file, its name as a series, its numbers.
type Variable = (&'static str, &'static [&'static str], &'static [f64]);

fn other_software(report: &mut Claims) {
    let exact = |what: String, source| Claim::new(what, source).expects(0.0, "values that differ");
    let numpy: [Variable; 5] = [
        ("force, 64 bits", &["force"], &[0.5, -1.25, 3.0]),
        (
            "counts, integers of 16 bits",
            &["counts"],
            &[1.0, -2.0, 300.0],
        ),
        (
            "big, 32 bits with the highest byte first",
            &["big"],
            &[1.5, 2.5],
        ),
        (
            "pair, two rows stored column by column",
            &["pair[0, :]", "pair[1, :]"],
            &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        ),
        (
            "tall, two columns of bytes",
            &["tall[:, 0]", "tall[:, 1]"],
            &[1.0, 3.0, 5.0, 2.0, 4.0, 6.0],
        ),
    ];
    let matlab: [Variable; 7] = [
        ("force, 64 bits", &["force"], &[0.5, -1.25, 3.0, 1e300]),
        (
            "counts, integers of 16 bits",
            &["counts"],
            &[1.0, -2.0, 300.0],
        ),
        ("single, 32 bits", &["single"], &[1.5, 2.5]),
        (
            "large, integers of 64 bits",
            &["large"],
            &[1_099_511_627_776.0, -4_503_599_627_370_496.0],
        ),
        ("flags, logical", &["flags"], &[1.0, 0.0, 1.0]),
        (
            "cube of three dimensions",
            &[
                "cube(:,1,1)",
                "cube(:,2,1)",
                "cube(:,3,1)",
                "cube(:,1,2)",
                "cube(:,2,2)",
                "cube(:,3,2)",
            ],
            &[0.0, 6.0, 2.0, 8.0, 4.0, 10.0, 1.0, 7.0, 3.0, 9.0, 5.0, 11.0],
        ),
        (
            "density in a structure in a structure",
            &["rod.material.density"],
            &[1410.0, 1420.0],
        ),
    ];
    let all = |bytes: &[u8], reader: &dyn Reader, (_, names, expected): &Variable| -> Found {
        let contents = reader.read(bytes, Strictness::Strict)?;
        let mut found = Vec::new();
        for name in *names {
            found.extend(values(&contents, name)?);
        }
        let expected: Vec<Complex64> = expected.iter().map(|&value| value.into()).collect();
        Ok(wrong(&found, &expected))
    };
    for variable in &numpy {
        report.check(
            exact(
                format!("archive of NumPy: {}", variable.0),
                "NumPy, fixtures/reference/npz",
            ),
            || all(NPZ, &Npz, variable),
        );
    }
    report.check(
        exact(
            "archive of NumPy: transfer, complex of 32 bits".to_owned(),
            "NumPy, fixtures/reference/npz",
        ),
        || {
            let expected = [Complex64::new(1.0, 2.0), Complex64::new(-3.0, -0.5)];
            Ok(wrong(
                &values(&Npz.read(NPZ, Strictness::Strict)?, "transfer")?,
                &expected,
            ))
        },
    );
    for variable in &matlab {
        report.check(
            exact(
                format!("MATLAB file of SciPy: {}", variable.0),
                "SciPy, fixtures/reference/mat5",
            ),
            || all(PLAIN, &Mat5, variable),
        );
    }
    report.check(
        exact(
            "MATLAB file of SciPy: transfer, complex".to_owned(),
            "SciPy, fixtures/reference/mat5",
        ),
        || {
            let expected =
                [(1.0, 2.0), (-3.0, -0.5), (0.0, 1e-7)].map(|(re, im)| Complex64::new(re, im));
            Ok(wrong(
                &values(&Mat5.read(PLAIN, Strictness::Strict)?, "transfer")?,
                &expected,
            ))
        },
    );
    report.check(
        exact(
            "MATLAB file of SciPy: compressed against plain".to_owned(),
            "SciPy, fixtures/reference/mat5",
        ),
        || {
            let plain = Mat5.read(PLAIN, Strictness::Strict)?;
            let packed = Mat5.read(PACKED, Strictness::Strict)?;
            let mut unlike = (plain.series.len() as f64 - packed.series.len() as f64).abs();
            for series in &plain.series {
                let there = values(&plain, &series.name)?;
                unlike += wrong(&values(&packed, &series.name)?, &there);
            }
            Ok(unlike)
        },
    );
}

/// Two histories with names and units, whose values have no short decimal form and lie within ±0.9.
fn histories() -> Contents {
    let mut contents = Contents::of_format("computed");
    for (name, unit, factor) in [("hammer", "N", 0.1), ("end A", "m/s^2", 0.37)] {
        let axis = |label: &str, unit: &str| SeriesAxis {
            label: label.to_owned(),
            unit_text: unit.to_owned(),
            unit: Unit::parse(unit).ok(),
        };
        contents.series.push(Series {
            name: name.to_owned(),
            kind: SeriesKind::TimeResponse,
            abscissa: Abscissa::Even {
                start: 0.0,
                step: 1.0 / 48_000.0,
            },
            ordinate: Ordinate::Real(
                (0..500)
                    .map(|k| 0.9 * (factor * f64::from(k)).sin())
                    .collect(),
            ),
            abscissa_axis: axis("Time", "s"),
            ordinate_axis: axis("", unit),
            properties: Vec::new(),
        });
    }
    contents
}

fn real(series: &Series) -> Fallible<&[f64]> {
    match &series.ordinate {
        Ordinate::Real(values) => Ok(values),
        Ordinate::Complex(_) => Err("complex numbers".into()),
    }
}

/// Largest change of a value of [`histories`] that a file makes.
fn change(writer: &dyn Writer, reader: &dyn Reader) -> Found {
    let there = histories();
    let mut bytes = Vec::new();
    writer.write(&there, &mut bytes)?;
    let back = reader.read(&bytes, Strictness::Strict)?;
    if back.series.len() != there.series.len() {
        return Err(format!("{} series came back", back.series.len()).into());
    }
    let mut changes = Vec::new();
    for (there, back) in there.series.iter().zip(&back.series) {
        let (there, back) = (real(there)?, real(back)?);
        changes.push(there.len() as f64 - back.len() as f64);
        changes.extend(there.iter().zip(back).map(|(a, b)| a - b));
    }
    Ok(largest(changes))
}

fn round_trips(report: &mut Claims) {
    const SOURCE: &str = "what was written";
    let universal = |encoding, precision| Uff58Writer {
        encoding,
        precision,
    };
    let binary = Encoding::Binary(ByteOrder::BigEndian);
    type Face<'a> = (&'a dyn Writer, &'a dyn Reader);
    let text_double = universal(Encoding::Ascii, Precision::Double);
    let text_single = universal(Encoding::Ascii, Precision::Single);
    let binary_double = universal(binary, Precision::Double);
    let binary_single = universal(binary, Precision::Single);
    let wav = |encoding| WavWriter { encoding };
    let (pcm16, pcm24) = (wav(WavEncoding::Pcm16), wav(WavEncoding::Pcm24));
    let float = wav(WavEncoding::Float64);
    let cases: [(&str, Face<'_>, f64, &str); 9] = [
        (
            "table in text",
            (&Csv, &Csv),
            0.0,
            "shortest digits that read back exactly",
        ),
        (
            "archive of arrays",
            (&Npz, &Npz),
            0.0,
            "binary numbers of 64 bits",
        ),
        (
            "universal file, binary, double",
            (&binary_double, &Uff58),
            0.0,
            "binary numbers of 64 bits",
        ),
        (
            "universal file, binary, single",
            (&binary_single, &Uff58),
            3e-8,
            "half a unit of 24 bits",
        ),
        (
            "universal file, text, double",
            (&text_double, &Uff58),
            5.1e-14,
            "half a unit of 13 digits below 1, and a rounding",
        ),
        (
            "universal file, text, single",
            (&text_single, &Uff58),
            5e-7,
            "half a unit of 6 digits below 1",
        ),
        (
            "sound file of 64 bits",
            (&float, &Wav),
            0.0,
            "binary numbers of 64 bits",
        ),
        (
            "sound file of 24 bits",
            (&pcm24, &Wav),
            1.0 / 8_388_608.0,
            "a step, at full scale",
        ),
        (
            "sound file of 16 bits",
            (&pcm16, &Wav),
            1.0 / 32_768.0,
            "a step, at full scale",
        ),
    ];
    for (name, (writer, reader), tolerance, why) in cases {
        report.check(
            Claim::new(
                format!("{name} written and read: largest change of 1000 values"),
                SOURCE,
            )
            .within(tolerance, why),
            || change(writer, reader),
        );
    }
}
