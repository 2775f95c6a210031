//! Files in other formats: content kept to the last bit, and a report of lost content.

use std::fs;
use std::path::Path;

use labio::format::{self, npz::Npz};
use labio::{Abscissa, Contents, Ordinate, Series, SeriesAxis, SeriesKind, Unit};
use num_complex::Complex64;
use proptest::prelude::*;
use rodlab::convert::{Conversion, ConvertOptions, convert};

use crate::records::series;
use crate::runs::{Folder, Refused, Words};

fn history(name: &str, unit: &str, values: Vec<f64>) -> Series {
    let mut one = series(name, unit, 1.0 / 51_200.0, &values);
    one.abscissa_axis.label = "Time".to_owned();
    one
}

fn two_channels(force: Vec<f64>, acceleration: Vec<f64>) -> Contents {
    let mut contents = Contents::of_format("test");
    contents.series = vec![
        history("hammer", "N", force),
        history("end A", "m/s^2", acceleration),
    ];
    contents
}

fn source(folder: &Path, contents: &Contents) -> std::path::PathBuf {
    let path = folder.join("source.npz");
    format::write(&path, contents, &Npz).unwrap();
    path
}

/// Returns a copy of the data sets; `Contents` cannot be cloned because its defects cannot.
fn same_series(contents: &Contents) -> Contents {
    let mut copy = Contents::of_format(contents.format);
    copy.series.clone_from(&contents.series);
    copy
}

const LOSSLESS: ConvertOptions = ConvertOptions {
    tolerant: false,
    lossless: true,
    binary: true,
    force: false,
    rate_hz: None,
};

/// A MATLAB file keeps numbers, names, kinds and axes to the last bit; properties of series are
/// reported as lost.
#[test]
fn a_matlab_file_holds_numbers_names_and_axes() {
    let folder = Folder::new();
    let mut contents = two_channels(vec![0.1, -0.0, 1e-300], vec![1.0, 2.0, f64::MAX]);
    contents.series[1].name = "end A (left)".to_owned();
    contents.series[1].ordinate_axis.label = "Acceleration".to_owned();
    contents.series[1].properties = vec![("serial".to_owned(), "12345".to_owned())];
    let target = folder.file("hits.mat");
    let options = ConvertOptions::default();
    let done = convert(&source(folder.path(), &contents), &target, options).unwrap();
    assert_eq!(
        done.lost,
        ["the property `serial` of `end A (left)`, `12345`"]
    );
    let back = format::read(&target).unwrap();
    for (one, other) in contents.series.iter().zip(&back.series) {
        assert_eq!(one.name, other.name);
        assert_eq!(one.kind, other.kind);
        assert_eq!(one.ordinate, other.ordinate);
        assert_eq!(one.abscissa, other.abscissa);
        assert_eq!(one.ordinate_axis, other.ordinate_axis);
        assert_eq!(one.abscissa_axis, other.abscissa_axis);
    }
    // the conversion of the MATLAB file to a table loses nothing
    let table = folder.file("hits.csv");
    let done = convert(&target, &table, options).unwrap();
    assert!(done.lost.is_empty(), "{:?}", done.lost);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn values_names_and_units_survive_every_format_that_holds_them(
        force in prop::collection::vec(-1e9..1e9_f64, 2..40),
        scale in 1e-200..1e200_f64,
    ) {
        let folder = Folder::new();
        let acceleration: Vec<f64> = force.iter().map(|f| scale * f).collect();
        let contents = two_channels(force, acceleration);
        let mut path = source(folder.path(), &contents);
        // a binary universal file keeps 8 digits of the step and is therefore tested last
        for (number, ending) in ["csv", "npz", "csv"].into_iter().enumerate() {
            let next = folder.file(format!("{number}.{ending}"));
            convert(&path, &next, LOSSLESS).unwrap();
            path = next;
        }
        let back = format::read(&path).unwrap();
        for (one, other) in contents.series.iter().zip(&back.series) {
            prop_assert_eq!(&one.ordinate, &other.ordinate);
            prop_assert_eq!(&one.name, &other.name);
            prop_assert_eq!(&one.ordinate_axis.unit_text, &other.ordinate_axis.unit_text);
            prop_assert_eq!(&one.abscissa, &other.abscissa);
        }
        let universal = folder.file("last.uff");
        convert(&path, &universal, ConvertOptions { binary: true, ..ConvertOptions::default() }).unwrap();
        let back = format::read(&universal).unwrap();
        for (one, other) in contents.series.iter().zip(&back.series) {
            prop_assert_eq!(&one.ordinate, &other.ordinate);
        }
    }
}

fn lost(folder: &Path, contents: &Contents, name: &str) -> Conversion {
    let path = source(folder, contents);
    convert(&path, &folder.join(name), ConvertOptions::default()).unwrap()
}

#[test]
fn what_a_format_has_no_place_for_is_listed() {
    let folder = Folder::new();
    let mut contents = two_channels(vec![0.0, 1.0 / 3.0, 2.0], vec![1.0, 2.0, 3.0]);
    contents.properties = vec![("operator".to_owned(), "N. N.".to_owned())];
    contents.series[1].properties = vec![("serial".to_owned(), "12345".to_owned())];
    let mut said = String::new();
    for name in ["bare.npy", "table.csv", "text.uff", "sound.wav"] {
        let conversion = lost(folder.path(), &contents, name);
        said += &conversion.to_text(Path::new("source.npz"), Path::new(name));
    }
    insta::assert_snapshot!(said, @r"
    source.npz (npz) -> bare.npy (npy): 2 data sets, 176 bytes
    lost:
      the property `operator` of the file, `N. N.`
      the name of `hammer`
      the kind of `hammer`: TimeResponse became General
      the label of the abscissa of `hammer`, `Time`
      the unit of the abscissa of `hammer`, `s`
      the unit of the values of `hammer`, `N`
      the abscissa of `hammer`: start 0 and step 0.00001953125 became start 0 and step 1
      the name of `end A`
      the kind of `end A`: TimeResponse became General
      the label of the abscissa of `end A`, `Time`
      the unit of the abscissa of `end A`, `s`
      the unit of the values of `end A`, `m/s^2`
      the abscissa of `end A`: start 0 and step 0.00001953125 became start 0 and step 1
      the property `serial` of `end A`, `12345`
    source.npz (npz) -> table.csv (csv): 2 data sets, 193 bytes
    source.npz (npz) -> text.uff (uff58): 2 data sets, 1820 bytes
    lost:
      the property `operator` of the file, `N. N.`
      digits of the values of `hammer`: up to 1e-13 of a value
      the property `serial` of `end A`, `12345`
    source.npz (npz) -> sound.wav (wav): 2 data sets, 162 bytes
    lost:
      the property `operator` of the file, `N. N.`
      the property `serial` of `end A`, `12345`
    ");
    // the values are kept
    let back = format::read(folder.file("bare.npy")).unwrap();
    assert_eq!(back.series[0].ordinate, contents.series[0].ordinate);
    let back = format::read(folder.file("sound.wav")).unwrap();
    assert_eq!(back.series[1].ordinate, contents.series[1].ordinate);
    assert_eq!(back.series[1].name, "end A");
}

#[test]
fn a_response_is_converted_with_its_complex_values() {
    let folder = Folder::new();
    let mut contents = Contents::of_format("test");
    let mut response = history("end A", "m/s^2", Vec::new());
    response.kind = SeriesKind::FrequencyResponse;
    response.abscissa = Abscissa::Even {
        start: 0.0,
        step: 0.5,
    };
    response.abscissa_axis = SeriesAxis {
        label: "Frequency".to_owned(),
        unit_text: "Hz".to_owned(),
        unit: Unit::parse("Hz").ok(),
    };
    response.ordinate = Ordinate::Complex(vec![
        Complex64::new(1.0, -0.1),
        Complex64::new(1.0 / 3.0, 1e-12),
    ]);
    contents.series = vec![response];
    for name in ["response.csv", "response.uff"] {
        let options = ConvertOptions {
            binary: true,
            ..ConvertOptions::default()
        };
        let path = source(folder.path(), &contents);
        let conversion = convert(&path, &folder.file(name), options).unwrap();
        assert!(conversion.lost.is_empty(), "{:?}", conversion.lost);
        let back = format::read(folder.file(name)).unwrap();
        assert_eq!(back.series[0].ordinate, contents.series[0].ordinate);
        assert_eq!(back.series[0].kind, SeriesKind::FrequencyResponse);
    }
}

#[test]
fn what_cannot_be_held_is_refused_and_nothing_is_written() {
    let folder = Folder::new();
    let contents = two_channels(vec![0.0, 1.0, 2.0], vec![1.0, 2.0, 3.0]);
    let path = source(folder.path(), &contents);
    let refused = |contents: &Contents, name: &str, options| {
        let path = source(folder.path(), contents);
        let target = folder.file(name);
        let error = convert(&path, &target, options).refused();
        assert!(!target.exists());
        error.replace(&folder.path().display().to_string(), "FOLDER")
    };
    let mut other_times = same_series(&contents);
    other_times.series[1].abscissa = Abscissa::Even {
        start: 0.0,
        step: 1e-3,
    };
    let mut odd_rate = same_series(&contents);
    for series in &mut odd_rate.series {
        series.abscissa = Abscissa::Even {
            start: 0.0,
            step: 0.000977,
        };
    }
    let said = [
        refused(&other_times, "two.csv", ConvertOptions::default()),
        refused(&odd_rate, "odd.wav", ConvertOptions::default()),
        refused(&contents, "bare.npy", LOSSLESS),
        refused(&contents, "table.xlsx", ConvertOptions::default()),
        refused(&contents, "table", ConvertOptions::default()),
    ];
    insta::assert_snapshot!(said.join("\n"), @r"
    converting to csv: csv cannot hold `hammer` and `end A` in one table: they have different abscissae
    converting to wav: wav cannot hold a time step of 0.000977 s; only the reciprocal of a whole number of Hz
    the conversion of FOLDER/source.npz to npy is not without loss (the name of `hammer`; the kind of `hammer`: TimeResponse became General; the label of the abscissa of `hammer`, `Time`; the unit of the abscissa of `hammer`, `s`; the unit of the values of `hammer`, `N`; the abscissa of `hammer`: start 0 and step 0.00001953125 became start 0 and step 1; the name of `end A`; the kind of `end A`: TimeResponse became General; the label of the abscissa of `end A`, `Time`; the unit of the abscissa of `end A`, `s`; the unit of the values of `end A`, `m/s^2`; the abscissa of `end A`: start 0 and step 0.00001953125 became start 0 and step 1), expected another format, or no --lossless
    the extension of the output is `xlsx`, expected one of csv, mat, npy, npz, txt, uff, unv, uf, wav
    the extension of the output is ``, expected one of csv, mat, npy, npz, txt, uff, unv, uf, wav
    ");
    let onto_itself = convert(&path, &path, ConvertOptions::default()).refused();
    assert!(
        onto_itself.ends_with("which is the input, expected another file"),
        "{onto_itself}"
    );
    let missing = convert(
        &folder.file("no.csv"),
        &folder.file("x.csv"),
        ConvertOptions::default(),
    );
    missing.refused().must_begin("cannot read ");
}

#[test]
fn a_sampling_rate_is_stated_if_the_file_does_not_state_it() {
    let folder = Folder::new();
    let contents = two_channels(vec![0.0, 1.0, 2.0], vec![1.0, 2.0, 3.0]);
    let timed = source(folder.path(), &contents);
    let bare = folder.file("bare.npy");
    convert(&timed, &bare, ConvertOptions::default()).unwrap();
    let wav = folder.file("hits.wav");
    let said = convert(&bare, &wav, ConvertOptions::default()).refused();
    said.must_say("is not stated in the file, expected `--rate`");
    let at = |rate_hz| ConvertOptions {
        rate_hz: Some(rate_hz),
        force: true,
        ..ConvertOptions::default()
    };
    // 51.2 kHz is the rate of `two_channels`
    for name in ["hits.wav", "hits.csv"] {
        let path = folder.file(name);
        convert(&bare, &path, at(51_200.0)).unwrap();
        let back = format::read(&path).unwrap();
        assert_eq!(
            back.series[1].abscissa, contents.series[1].abscissa,
            "{name}"
        );
        assert_eq!(back.series[1].abscissa_axis.unit_text, "s", "{name}");
        assert_eq!(
            back.series[1].ordinate, contents.series[1].ordinate,
            "{name}"
        );
    }
    convert(&timed, &wav, at(51_200.0)).unwrap();
    let said = convert(&timed, &wav, at(48_000.0)).refused();
    said.must_begin("`--rate` is 48000 Hz, expected 51200 Hz, as stated in ");
    said.must_say("or no `--rate`");
}

#[test]
fn r19_a_file_that_is_there_is_replaced_only_by_force_and_the_input_never() {
    let folder = Folder::new();
    let contents = two_channels(vec![0.0, 1.0, 2.0], vec![1.0, 2.0, 3.0]);
    let path = source(folder.path(), &contents);
    let before = fs::read(&path).unwrap();
    let target = folder.file("recording.csv");
    fs::write(&target, "a recording of another day").unwrap();
    let said = convert(&path, &target, ConvertOptions::default()).refused();
    assert!(
        said.ends_with("which exists already, expected a new file, or --force to replace it"),
        "{said}"
    );
    assert_eq!(fs::read(&target).unwrap(), b"a recording of another day");
    let force = ConvertOptions {
        force: true,
        ..ConvertOptions::default()
    };
    convert(&path, &target, force).unwrap();
    let back = format::read(&target).unwrap();
    assert_eq!(back.series[0].ordinate, contents.series[0].ordinate);
    // the input is never replaced, by whatever name it is called
    let mut names = vec![path.clone(), folder.file("./source.npz")];
    #[cfg(unix)]
    {
        let link = folder.file("link.npz");
        std::os::unix::fs::symlink("source.npz", &link).unwrap();
        names.push(link);
    }
    for name in names {
        let said = convert(&path, &name, force).refused();
        said.must_say("which is the input");
    }
    assert_eq!(fs::read(&path).unwrap(), before);
}

#[test]
fn a_damaged_file_is_converted_only_when_asked_to() {
    let folder = Folder::new();
    let path = folder.file("cut.csv");
    fs::write(&path, "Time (s),a (N)\n0,0\n1,2\n2,3\n3,3\nstopped\n").unwrap();
    let target = folder.file("whole.uff");
    assert!(convert(&path, &target, ConvertOptions::default()).is_err());
    assert!(!target.exists());
    let tolerant = ConvertOptions {
        tolerant: true,
        ..ConvertOptions::default()
    };
    let conversion = convert(&path, &target, tolerant).unwrap();
    assert_eq!(conversion.not_read.len(), 1);
    assert_eq!(format::read(&target).unwrap().series[0].ordinate.len(), 4);
}

/// In other formats, a frequency response of a universal file keeps the unit of its denominator.
/// Hits are stored in an archive even if their names are equal or not allowed there.
#[test]
fn units_of_ratios_and_hits_with_equal_names_are_kept() {
    let folder = Folder::new();
    let mut contents = two_channels(vec![1.0, 2.0], vec![3.0, 4.0]);
    contents.series.truncate(1);
    let response = &mut contents.series[0];
    response.kind = SeriesKind::FrequencyResponse;
    response.ordinate = Ordinate::Complex(vec![Complex64::new(1.0, 2.0); 2]);
    response.ordinate_axis.unit_text = "m/s2".to_owned();
    response.properties = vec![("uff58.denominator_unit".to_owned(), "N".to_owned())];
    let universal = folder.file("response.uff");
    let writer = format::uff58::Uff58Writer::default();
    format::write(&universal, &contents, &writer).unwrap();
    let accelerance = Unit::parse("m/s2/N").unwrap();
    for ending in ["csv", "mat", "npz"] {
        let target = folder.file(format!("response.{ending}"));
        let _ = convert(&universal, &target, ConvertOptions::default()).unwrap();
        let back = format::read(&target).unwrap();
        let unit = back.series[0].ordinate_axis.unit.as_ref().unwrap();
        assert!(unit.is_same_as(&accelerance), "{ending}: {unit:?}");
    }

    let mut hits = two_channels(vec![1.0, 2.0], vec![3.0, 4.0]);
    hits.series[1].name = "hammer".to_owned();
    hits.series.push(history("run/a", "N", vec![5.0, 6.0]));
    let universal = folder.file("hits.uff");
    format::write(&universal, &hits, &writer).unwrap();
    let target = folder.file("hits.npz");
    let said = convert(&universal, &target, ConvertOptions::default()).unwrap();
    let back = format::read(&target).unwrap();
    let names: Vec<&str> = back.series.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(names, ["hammer", "hammer 2", "run_a"]);
    let lost = said.lost.join("; ");
    assert!(lost.contains("the name of `run/a`"), "{lost}");
}
