//! TDMS files put together byte by byte from the description of the format.

mod data_types;
mod layouts;
mod scales;
mod wrong_files;

use testbed::measured;

use labio::format::tdms::Tdms;
use labio::format::{self, Reader, Strictness};
use labio::{Contents, LabioError};

use crate::series::{even, values};

const METADATA: u32 = 2;
const NEW_LIST: u32 = 4;
const RAW: u32 = 8;
const INTERLEAVED: u32 = 32;
const DAQMX: u32 = 128;
/// Flags of a segment with metadata, a new list of objects and raw data.
pub(crate) const USUAL: u32 = METADATA | NEW_LIST | RAW;

const NO_DATA: [u8; 4] = [0xff; 4];
const AS_BEFORE: [u8; 4] = [0; 4];

fn u32s(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

fn text(text: &str) -> Vec<u8> {
    [
        &u32s(&[u32::try_from(text.len()).unwrap()]),
        text.as_bytes(),
    ]
    .concat()
}

fn property(name: &str, code: u32, value: &[u8]) -> Vec<u8> {
    [&text(name), &u32s(&[code]), value].concat()
}

fn real(name: &str, value: f64) -> Vec<u8> {
    property(name, 10, &value.to_le_bytes())
}

fn index(name: &str, value: u32) -> Vec<u8> {
    property(name, 7, &value.to_le_bytes())
}

fn word(name: &str, value: &str) -> Vec<u8> {
    property(name, 0x20, &text(value))
}

/// The raw data index of `n` numbers of a type.
fn numbers(code: u32, n: u64) -> Vec<u8> {
    [u32s(&[20, code, 1]), n.to_le_bytes().to_vec()].concat()
}

fn object(path: &str, raw_index: &[u8], properties: &[Vec<u8>]) -> Vec<u8> {
    [
        &text(path),
        raw_index,
        &u32s(&[u32::try_from(properties.len()).unwrap()]),
        &properties.concat(),
    ]
    .concat()
}

pub(crate) fn segment(contains: u32, objects: &[Vec<u8>], raw: &[u8]) -> Vec<u8> {
    let metadata = match contains & METADATA {
        0 => Vec::new(),
        _ => [
            u32s(&[u32::try_from(objects.len()).unwrap()]),
            objects.concat(),
        ]
        .concat(),
    };
    [
        b"TDSm",
        &u32s(&[contains, 4713])[..],
        &((metadata.len() + raw.len()) as u64).to_le_bytes(),
        &(metadata.len() as u64).to_le_bytes(),
        &metadata,
        raw,
    ]
    .concat()
}

fn f64s(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn i16s(values: &[i16]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn strict(bytes: &[u8]) -> Result<Contents, LabioError> {
    Tdms.read(bytes, Strictness::Strict)
}

fn all_values(bytes: &[u8]) -> Vec<(String, Vec<f64>)> {
    let contents = strict(bytes).unwrap();
    contents
        .series
        .iter()
        .map(|series| (series.name.clone(), values(series).to_vec()))
        .collect()
}

fn named(names: &[(&str, &[f64])]) -> Vec<(String, Vec<f64>)> {
    names
        .iter()
        .map(|(name, values)| ((*name).to_owned(), values.to_vec()))
        .collect()
}

/// Scalers of a DAQmx channel: type, buffer, byte offset, scale.
fn daqmx(n: u64, scalers: &[[u32; 4]], widths: &[u32]) -> Vec<u8> {
    let mut bytes = [u32s(&[0x1269, u32::MAX, 1]), n.to_le_bytes().to_vec()].concat();
    bytes.extend(u32s(&[u32::try_from(scalers.len()).unwrap()]));
    for [code, buffer, offset, scale] in scalers {
        bytes.extend(u32s(&[*code, *buffer, *offset, 0, *scale]));
    }
    bytes.extend(u32s(&[u32::try_from(widths.len()).unwrap()]));
    bytes.extend(u32s(widths));
    bytes
}

/// The sums and the end values of the channels are those that npTDMS 1.13 reads.
#[test]
fn measured_files_are_read_or_refused() {
    let Some(folder) = measured::folder() else {
        return;
    };
    let folder = folder.join("tdms");
    let contents = format::read(folder.join("good_tdms_1.tdms")).unwrap();
    #[rustfmt::skip]
    let expected = [
        ("TP_ACC_LAT19_315deg_X", 0.005218853_f32, 0.0014306154_f32, 7.373898870684975),
        ("TP_ACC_LAT19_315deg_Y", 0.0048928126, 0.00018609561, -4.715664234111898),
        ("TW_ACC_LAT27_031deg_X", -0.00033172182, 0.0011353748, -5.891273570840738),
        ("TW_ACC_LAT27_031deg_Y", -0.006033103, -0.0039238436, -5.7903339178895585),
        ("TW_ACC_LAT41_031deg_X", 0.00128198, -0.0003390131, -6.920935905831811),
        ("TW_ACC_LAT41_031deg_Y", -0.0030724166, -0.008176065, -0.12353036662388561),
        ("TW_ACC_LAT69_031deg_X", 0.0022804043, -0.0070577376, 1.6839116462640789),
        ("TW_ACC_LAT69_031deg_Y", -0.0015025164, -0.0020502566, -1.2139204440039322),
    ];
    assert_eq!(contents.series.len(), expected.len());
    for (series, (name, first, last, sum)) in contents.series.iter().zip(expected) {
        let samples = values(series);
        assert_eq!((series.name.as_str(), samples.len()), (name, 18_000));
        assert_eq!(
            (samples[0], samples[17_999]),
            (f64::from(first), f64::from(last))
        );
        // tolerance: 18 000 additions of numbers below 0.1 in another order
        assert!((samples.iter().sum::<f64>() - sum).abs() < 1e-11, "{name}");
        assert_eq!(series.ordinate_axis.unit_text, "g");
        assert_eq!(series.abscissa, even(0.0, 1.0 / 30.0));
    }
    let together = format::read_records(folder.join("good_tdms_1.tdms")).unwrap();
    assert!(together.left_out.is_empty());
    let [record] = together.records.as_slice() else {
        panic!("expected one record");
    };
    assert_eq!((record.channels().len(), record.n_samples()), (8, 18_000));
    let first = record.channel("TP_ACC_LAT19_315deg_X").unwrap()[0];
    let expected_first = f64::from(0.005218853_f32) * 9.80665;
    // tolerance: one more rounding error, because the unit is a ratio
    assert!((first - expected_first).abs() <= f64::EPSILON * expected_first);

    let faulty = folder.join("faulty_tdms_01.tdms");
    let LabioError::InFile { source, .. } = format::read(&faulty).unwrap_err() else {
        panic!("expected the file to be named");
    };
    let expected = r#"tdms, byte 21123: tag of the lead-in is "\x00\x00\x00\x00", expected "TDSm""#;
    assert_eq!(source.to_string(), expected);
    let rest = format::read_with(&faulty, Strictness::Tolerant).unwrap();
    assert_eq!(rest.series.len(), 4);
    assert_eq!(rest.defects.len(), 1);
}
