//! Traces of oscilloscopes, compared with the values that readers of the manufacturers and others
//! give.

use labio::Abscissa;
use labio::format::oscilloscope::{LeCroy, TektronixIsf, TektronixWfm};
use labio::format::{self, Reader, Strictness};

use crate::series::{bits, real, refusals, values};

// fixtures/reference/oscilloscope/make.py
macro_rules! files {
    ($($name:literal)*) => {
        [$(($name, include_bytes!(concat!("../../../fixtures/reference/oscilloscope/", $name)))),*]
    };
}
pub(crate) const FILES: [(&str, &[u8]); 11] = files!(
    "three.wfm" "frames.wfm" "three_bytes.wfm" "two.wfm" "one.wfm" "two_bytes.isf" "one_byte.isf"
    "little.trc" "big.trc" "bytes.trc" "sequence.trc"
);
const VALUES: &str = include_str!("../../../fixtures/reference/oscilloscope/values.csv");

/// Intact files for each reader.
pub(crate) fn whole() -> Vec<(&'static dyn Reader, Vec<u8>)> {
    FILES
        .iter()
        .map(|(name, file)| (reader_of(name), file.to_vec()))
        .collect()
}

fn reader_of(name: &str) -> &'static dyn Reader {
    match name.rsplit('.').next() {
        Some("wfm") => &TektronixWfm,
        Some("isf") => &TektronixIsf,
        _ => &LeCroy,
    }
}

fn file(name: &str) -> &'static [u8] {
    FILES.iter().find(|(one, _)| *one == name).unwrap().1
}

#[test]
fn all_samples_are_those_of_the_other_readers_to_the_bit() {
    let mut seen = 0;
    for row in VALUES.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let [name, trace, start, step, numbers] = cells[..] else {
            panic!("{row}");
        };
        let contents = format::read_bytes(file(name)).unwrap();
        assert_eq!(contents.format, reader_of(name).name());
        let series = contents
            .series
            .iter()
            .find(|one| one.name == trace)
            .unwrap();
        let expected: Vec<u64> = numbers
            .split(' ')
            .map(|number| u64::from_str_radix(number, 16).unwrap())
            .collect();
        assert_eq!(bits(values(series)), expected, "{name} {trace}");
        let Abscissa::Even { start: t, step: dt } = series.abscissa else {
            panic!("{name}");
        };
        let near =
            |a: f64, b: &str| (a - b.parse::<f64>().unwrap()).abs() < 1e-15 * a.abs().max(1e-9);
        assert!(
            near(t, start) && near(dt, step),
            "{name} {t} {start} {dt} {step}"
        );
        assert_eq!(series.abscissa_axis.unit_text, "s");
        assert_eq!(series.ordinate_axis.unit_text, "V");
        seen += 1;
    }
    assert_eq!(seen, 15);
    let one_byte = &format::read_bytes(file("one_byte.isf")).unwrap().series[0];
    assert_eq!(one_byte.name, "Ch2; a");
    assert_eq!(one_byte.ordinate_axis.unit_text, "A");
    // one_byte.isf contains the upper bytes of the counts in two_bytes.isf, in steps of 2 mA
    let two_bytes = format::read_bytes(file("two_bytes.isf")).unwrap();
    for (a, v) in values(one_byte).iter().zip(real(&two_bytes, 0)) {
        let count = (v - 0.25) / 1.5625e-4 - 12.0;
        assert!((a - 2e-3 * (count / 256.0).floor()).abs() < 1e-12);
    }
}

#[test]
fn what_is_no_trace_over_time_is_refused_by_name() {
    let with = |name: &str, at: usize, bytes: &[u8]| {
        let mut spoilt = file(name).to_vec();
        spoilt[at..at + bytes.len()].copy_from_slice(bytes);
        reader_of(name).read(&spoilt, Strictness::Strict)
    };
    let lead = 11;
    let text = |from: &str, to: &str| {
        let file = String::from_utf8_lossy(file("two_bytes.isf")).replace(from, to);
        TektronixIsf.read(file.as_bytes(), Strictness::Strict)
    };
    insta::assert_snapshot!(refusals([
        with("little.trc", lead + 316, &[2, 0]),
        with("little.trc", lead + 32, &[7, 0]),
        with("little.trc", lead + 156, &[0; 4]),
        with("little.trc", lead + 60, &[0xff; 4]),
        with("three.wfm", 0xf0, &[9]),
        with("three.wfm", 0xf4, &[2]),
        text("PT_FMT Y", "PT_FMT ENV"),
        text("XINCR 4.0000E-7", "XINCR much"),
        text("YMULT 1.5625E-4;", ""),
        text("BYT_NR 2", "BYT_NR 3"),
    ]));
}

#[test]
fn a_file_that_was_cut_is_refused_or_returned_as_far_as_it_goes() {
    for (name, file) in FILES {
        let reader = reader_of(name);
        // a file of version 3 has texts after the samples
        let end = if name.ends_with("wfm") {
            let place = [file[0x10], file[0x11], file[0x12], file[0x13]];
            40 + match file[0] {
                0x0f => u32::from_le_bytes(place) as usize,
                _ => u32::from_be_bytes(place) as usize,
            }
        } else {
            file.len() - 9
        };
        assert!(
            reader.read(&file[..end], Strictness::Strict).is_err(),
            "{name}"
        );
        let whole = reader.read(file, Strictness::Strict).unwrap();
        let left = reader.read(&file[..end], Strictness::Tolerant).unwrap();
        assert_eq!(left.defects.len(), 1, "{name}");
        let n = |contents: &labio::Contents| -> usize {
            contents.series.iter().map(|one| one.ordinate.len()).sum()
        };
        assert!(n(&left) > 0 && n(&left) < n(&whole), "{name}");
    }
}
