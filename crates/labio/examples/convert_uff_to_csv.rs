//! Converts every data set of a universal file to a column of a text table.
//!
//! ```text
//! cargo run --package labio --example convert_uff_to_csv -- measurement.uff [table.csv]
//! ```
//!
//! The program writes `table.csv` or, if no table is named, the name of the universal file with
//! `.csv` appended. If no universal file is named, the program first writes one that contains the
//! ring-down of a rod's end as text and as 58b. If only a part of a file can be read, the program
//! converts that part and reports the rest.
#![allow(
    clippy::print_stdout,
    reason = "an example prints its results to the standard output"
)]

use std::error::Error;
use std::path::PathBuf;

use labio::format::uff58::{ByteOrder, Encoding, Precision, Uff58Writer};
use labio::format::{self, Strictness, csv::Csv};
use labio::{Abscissa, Contents, Ordinate, Series, SeriesAxis, SeriesKind, Unit};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let source = match arguments.next() {
        Some(path) => path,
        None => ring_down()?,
    };
    let table = arguments.next().unwrap_or_else(|| {
        let mut name = source.clone().into_os_string();
        name.push(".csv");
        name.into()
    });

    let contents = format::read_with(&source, Strictness::Tolerant)?;
    println!(
        "{}: {}, {} series",
        source.display(),
        contents.format,
        contents.series.len()
    );
    for (key, value) in &contents.properties {
        println!("  {key}: {value}");
    }
    for series in &contents.series {
        println!(
            "  {:?} `{}`, {} values [{}]",
            series.kind,
            series.name,
            series.ordinate.len(),
            series.ordinate_axis.unit_text
        );
    }
    for defect in &contents.defects {
        println!("  not read: {defect}");
    }
    if contents.series.is_empty() {
        println!("nothing to write");
        return Ok(());
    }
    format::write(&table, &contents, &Csv)?;
    println!("written: {}", table.display());
    Ok(())
}

/// A universal file with two histories: acceleration and force at 51.2 kHz.
fn ring_down() -> Result<PathBuf, Box<dyn Error>> {
    let rate_hz = 51_200.0;
    let time = |sample: usize| sample as f64 / rate_hz;
    let acceleration =
        |sample| 250.0 * f64::exp(-400.0 * time(sample)) * f64::sin(18_000.0 * time(sample));
    let force = |sample| {
        if time(sample) < 2e-4 {
            900.0 * f64::sin(15_708.0 * time(sample))
        } else {
            0.0
        }
    };
    let mut contents = Contents::of_format("computed");
    contents.series = vec![
        history(
            "end A",
            "Acceleration",
            "m/s^2",
            rate_hz,
            (0..512).map(acceleration).collect(),
        )?,
        history(
            "hammer",
            "Force",
            "N",
            rate_hz,
            (0..512).map(force).collect(),
        )?,
    ];
    let folder = PathBuf::from("target/examples");
    std::fs::create_dir_all(&folder)?;
    for (name, encoding) in [
        ("ring_down.uff", Encoding::Ascii),
        (
            "ring_down_58b.uff",
            Encoding::Binary(ByteOrder::LittleEndian),
        ),
    ] {
        let writer = Uff58Writer {
            encoding,
            precision: Precision::Double,
        };
        format::write(folder.join(name), &contents, &writer)?;
    }
    Ok(folder.join("ring_down.uff"))
}

fn history(
    name: &str,
    label: &str,
    unit: &str,
    rate_hz: f64,
    values: Vec<f64>,
) -> Result<Series, Box<dyn Error>> {
    let axis = |label: &str, unit: &str| -> Result<SeriesAxis, Box<dyn Error>> {
        Ok(SeriesAxis {
            label: label.to_owned(),
            unit_text: unit.to_owned(),
            unit: Some(Unit::parse(unit)?),
        })
    };
    Ok(Series {
        name: name.to_owned(),
        kind: SeriesKind::TimeResponse,
        abscissa: Abscissa::Even {
            start: 0.0,
            step: 1.0 / rate_hz,
        },
        ordinate: Ordinate::Real(values),
        abscissa_axis: axis("Time", "s")?,
        ordinate_axis: axis(label, unit)?,
        properties: Vec::new(),
    })
}
