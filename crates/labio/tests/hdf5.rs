//! HDF5 files of other software: MATLAB 7.3, h5py, netCDF-4.

use labio::format::hdf5::{Hdf5, read_within};
use labio::format::{MemoryLimit, Reader, Strictness};
use labio::{Abscissa, Contents, LabioError, Ordinate, Series};

use crate::series::pair;

// fixtures/reference/hdf5/make.py
pub(crate) const MATLAB: &[u8] = include_bytes!("../../../fixtures/reference/hdf5/matlab.mat");
const RECORDER: &[u8] = include_bytes!("../../../fixtures/reference/hdf5/recorder.h5");
const SHOTS: &[u8] = include_bytes!("../../../fixtures/reference/hdf5/shots.nc");
const MISSING: &[u8] = include_bytes!("../../../fixtures/reference/hdf5/missing.nc");
const VALUES: &str = include_str!("../../../fixtures/reference/hdf5/values.csv");

/// Intact files.
pub(crate) fn whole() -> [Vec<u8>; 3] {
    [MATLAB, RECORDER, SHOTS].map(<[u8]>::to_vec)
}

fn read(bytes: &[u8]) -> Contents {
    Hdf5.read(bytes, Strictness::Strict).unwrap()
}

fn series<'a>(contents: &'a Contents, name: &str) -> &'a Series {
    let found = contents.series.iter().find(|one| one.name == name);
    found.unwrap_or_else(|| panic!("there is no `{name}`"))
}

fn property<'a>(contents: &'a Contents, key: &str) -> &'a str {
    let found = contents.properties.iter().find(|(one, _)| one == key);
    found.map_or_else(|| panic!("there is no `{key}`"), |(_, value)| value)
}

#[test]
fn all_numbers_are_those_of_the_makers_readers_to_the_bit() {
    let files = [
        ("matlab.mat", MATLAB),
        ("recorder.h5", RECORDER),
        ("shots.nc", SHOTS),
    ];
    for (file, bytes) in files {
        let contents = read(bytes);
        let rows = VALUES.lines().skip(1).filter(|row| row.starts_with(file));
        let mut seen = 0;
        for row in rows {
            let mut cells = row.splitn(3, ',').skip(1);
            // a subscript contains commas, which the table replaces by semicolons
            let name = cells.next().unwrap().replace(';', ",");
            let expected: Vec<u64> = cells
                .next()
                .unwrap()
                .split(' ')
                .map(|bits| u64::from_str_radix(bits, 16).unwrap())
                .collect();
            let found: Vec<u64> = match &series(&contents, &name).ordinate {
                Ordinate::Real(values) => values.iter().map(|value| value.to_bits()).collect(),
                Ordinate::Complex(values) => values
                    .iter()
                    .flat_map(|value| [value.re.to_bits(), value.im.to_bits()])
                    .collect(),
            };
            assert_eq!(found, expected, "{file} {name}");
            seen += 1;
        }
        assert_eq!(seen, contents.series.len(), "{file}");
    }
}

#[test]
fn coordinates_units_and_texts_come_with_the_series() {
    let recorder = read(RECORDER);
    let strain = series(&recorder, "shot 1/strain");
    assert_eq!(
        strain.abscissa,
        Abscissa::Even {
            start: 0.25,
            step: 1.0 / 51200.0
        }
    );
    assert_eq!(
        (
            strain.abscissa_axis.label.as_str(),
            strain.abscissa_axis.unit_text.as_str()
        ),
        ("time", "s")
    );
    assert_eq!(
        (
            strain.ordinate_axis.label.as_str(),
            strain.ordinate_axis.unit_text.as_str()
        ),
        ("gauge 1", "um/m")
    );
    assert!(strain.ordinate_axis.unit.is_some());
    assert_eq!(strain.properties, [pair("serial", "4711")]);
    assert_eq!(
        series(&recorder, "shot 1/both[1, :]").abscissa,
        strain.abscissa
    );
    assert_eq!(
        series(&recorder, "shot 1/tall[:, 0]").abscissa,
        Abscissa::Even {
            start: 0.0,
            step: 1.0
        }
    );
    for (key, value) in [
        ("operator", "Ödeen"),
        ("gain", "2.5"),
        ("shot 1/velocity_m_per_s", "3.5"),
        ("shot 1/length", "0.402"),
        ("shot 1/specimen", "nylon 66"),
    ] {
        assert_eq!(property(&recorder, key), value);
    }

    let shots = read(SHOTS);
    // times in single precision: a step of 0.02 ms is even within the rounding of the times
    let force = series(&shots, "force[0, :]");
    assert!(
        matches!(force.abscissa, Abscissa::Even { start: 0.0, step } if (step - 0.02).abs() < 1e-9)
    );
    assert_eq!(
        (
            force.abscissa_axis.unit_text.as_str(),
            force.ordinate_axis.unit_text.as_str()
        ),
        ("ms", "N")
    );
    let temperature = series(&shots, "profile/temperature");
    assert_eq!(
        temperature.abscissa,
        Abscissa::Uneven(vec![0.0, 0.1, 0.3, 0.7])
    );

    let matlab = read(MATLAB);
    for (key, value) in [
        ("fs", "51200"),
        ("operator", "Ödeen"),
        ("empty", "empty, 0x3 double"),
        ("rod.length", "2"),
        ("rod.material.name", "POM"),
        ("mixed{2}", "text"),
    ] {
        assert_eq!(property(&matlab, key), value);
    }
    // complex series are spectra, so `fs` does not give them times
    assert_eq!(
        series(&matlab, "force").abscissa,
        Abscissa::Even {
            start: 0.0,
            step: 1.0
        }
    );
    assert_eq!(
        series(&matlab, "counts").properties,
        [pair("class", "int16")]
    );
    assert_eq!(
        series(&matlab, "flags").properties,
        [pair("class", "logical")]
    );
}

#[test]
fn what_is_missing_damaged_or_too_large_is_refused_with_its_name() {
    let of = |bytes: &[u8]| {
        Hdf5.read(bytes, Strictness::Strict)
            .unwrap_err()
            .to_string()
    };
    let missing = of(MISSING);
    assert!(
        missing.contains("`force`")
            && missing.contains("is 9969209968386869")
            && missing.contains("at sample 3, the value of missing samples"),
        "{missing}"
    );
    let tolerant = Hdf5.read(MISSING, Strictness::Tolerant).unwrap();
    assert_eq!((tolerant.series.len(), tolerant.defects.len()), (0, 1));
    let limit = MemoryLimit::new(2000);
    let large = read_within(RECORDER, Strictness::Tolerant, limit).unwrap_err();
    assert!(matches!(large, LabioError::MemoryLimit { .. }), "{large}");
    // every shorter file is rejected or has the same contents as the whole file
    let whole = read(RECORDER);
    for length in (0..RECORDER.len()).step_by(97) {
        match Hdf5.read(&RECORDER[..length], Strictness::Strict) {
            Ok(contents) => assert_eq!(contents.series, whole.series, "{length}"),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
}
