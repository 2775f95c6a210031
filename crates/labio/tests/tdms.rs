//! TDMS files put together byte by byte from the description of the format.

use testbed::measured;

use labio::format::tdms::{EMPTY_CHANNEL, FIRST_TIME, GROUP, TEXT_CHANNEL, Tdms};
use labio::format::{self, Reader, Strictness};
use labio::{Contents, LabioError, SeriesKind};
use proptest::prelude::*;

use crate::series::{defects, even, property as property_of, refusals, values};

const METADATA: u32 = 2;
const NEW_LIST: u32 = 4;
const RAW: u32 = 8;
const INTERLEAVED: u32 = 32;
const BIG_ENDIAN: u32 = 64;
const DAQMX: u32 = 128;
/// Metadata with a list of objects of their own, and raw data.
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

/// Every byte written out: a group `g` with a channel `a` of two 32-bit integers and one property.
#[test]
fn a_file_in_full() {
    let bytes = b"TDSm\x0e\x00\x00\x00\x69\x12\x00\x00\
        \x58\x00\x00\x00\x00\x00\x00\x00\x50\x00\x00\x00\x00\x00\x00\x00\
        \x02\x00\x00\x00\
        \x04\x00\x00\x00/'g'\xff\xff\xff\xff\x00\x00\x00\x00\
        \x08\x00\x00\x00/'g'/'a'\
        \x14\x00\x00\x00\x03\x00\x00\x00\x01\x00\x00\x00\x02\x00\x00\x00\x00\x00\x00\x00\
        \x01\x00\x00\x00\
        \x0b\x00\x00\x00unit_string\x20\x00\x00\x00\x01\x00\x00\x00N\
        \xff\xff\xff\xff\x02\x00\x00\x00";
    let contents = format::read_bytes(bytes).unwrap();
    assert_eq!(contents.format, "tdms");
    let [series] = contents.series.as_slice() else {
        panic!("expected one channel");
    };
    assert_eq!(series.name, "a");
    assert_eq!(series.ordinate_axis.unit_text, "N");
    assert_eq!(values(series), [-1.0, 2.0]);
    assert_eq!(series.kind, SeriesKind::General);
    assert_eq!(
        series.properties,
        [(GROUP, "g"), ("unit_string", "N")].map(|(k, v)| (k.to_owned(), v.to_owned()))
    );
}

#[test]
fn properties_of_every_type_are_told() {
    let time = [
        &(1_u64 << 63).to_le_bytes()[..],
        &3_669_315_043_i64.to_le_bytes(),
    ]
    .concat();
    let file = object(
        "/",
        &NO_DATA,
        &[
            property("i8", 1, &(-8_i8).to_le_bytes()),
            property("i16", 2, &(-16_i16).to_le_bytes()),
            property("i32", 3, &(-32_i32).to_le_bytes()),
            property("i64", 4, &i64::MIN.to_le_bytes()),
            property("u8", 5, &[255]),
            property("u16", 6, &u16::MAX.to_le_bytes()),
            property("u32", 7, &u32::MAX.to_le_bytes()),
            property("u64", 8, &u64::MAX.to_le_bytes()),
            property("f32", 9, &0.5_f32.to_le_bytes()),
            property("f64", 10, &0.1_f64.to_le_bytes()),
            property("f64 with unit", 0x1a, &0.1_f64.to_le_bytes()),
            word("text", "\u{b5}m/m"),
            property("true", 0x21, &[1]),
            property("time", 0x44, &time),
            property("complex", 0x10_000d, &f64s(&[1.0, -2.0])),
        ],
    );
    let group = object("/'g'", &NO_DATA, &[word("operator", "me")]);
    let contents = strict(&segment(METADATA | NEW_LIST, &[file, group], &[])).unwrap();
    let told: String = contents
        .properties
        .iter()
        .map(|(key, value)| format!("{key} `{value}`\n"))
        .collect();
    insta::assert_snapshot!(told, @r"
    i8 `-8`
    i16 `-16`
    i32 `-32`
    i64 `-9223372036854775808`
    u8 `255`
    u16 `65535`
    u32 `4294967295`
    u64 `18446744073709551615`
    f32 `0.5`
    f64 `0.1`
    f64 with unit `0.1`
    text `µm/m`
    true `true`
    time `2020-04-09T22:10:43.500000000Z`
    complex `1.0 -2.0`
    g/operator `me`
    ");
}

#[test]
fn times_count_from_the_first() {
    let times = [
        (3_669_315_043_i64, 1_u64 << 63),
        (3_669_315_044, 0),
        (3_669_315_043, 0),
    ];
    let raw = times
        .map(|(s, f)| [f.to_le_bytes(), s.to_le_bytes()].concat())
        .concat();
    let objects = [object("/'g'/'t'", &numbers(0x44, 3), &[])];
    let contents = strict(&segment(USUAL, &objects, &raw)).unwrap();
    assert_eq!(values(&contents.series[0]), [0.0, 0.5, -0.5]);
    let first = property_of(&contents.series[0].properties, FIRST_TIME);
    assert_eq!(first, Some("2020-04-09T22:10:43.500000000Z"));
}

/// Beyond what the files of npTDMS hold: the upper half of 64 bits, and a truth value that is no 1.
#[test]
fn the_ends_of_types_become_doubles() {
    let wide: Vec<u8> = [1_u64 << 63, 2].map(u64::to_le_bytes).concat();
    for (code, raw, expected) in [
        (8, wide, [2_f64.powi(63), 2.0]),
        (0x21, vec![0, 7], [0.0, 1.0]),
    ] {
        let file = segment(USUAL, &[object("/'g'/'a'", &numbers(code, 2), &[])], &raw);
        assert_eq!(all_values(&file), named(&[("a", &expected)]), "type {code}");
    }
}

#[test]
fn big_endian_files() {
    let be =
        |numbers: &[u32]| -> Vec<u8> { numbers.iter().flat_map(|n| n.to_be_bytes()).collect() };
    let be_text = |text: &str| {
        [
            be(&[u32::try_from(text.len()).unwrap()]),
            text.as_bytes().to_vec(),
        ]
        .concat()
    };
    let metadata = [
        be(&[1]),
        be_text("/'g'/'a'"),
        be(&[20, 10, 1]),
        2_u64.to_be_bytes().to_vec(),
        be(&[2]),
        be_text("wf_increment"),
        be(&[10]),
        0.5_f64.to_be_bytes().to_vec(),
        be_text("time"),
        be(&[0x44]),
        3_669_315_043_i64.to_be_bytes().to_vec(),
        (1_u64 << 63).to_be_bytes().to_vec(),
    ]
    .concat();
    let raw = [0.1_f64.to_be_bytes(), (-0.2_f64).to_be_bytes()].concat();
    let file = [
        b"TDSm",
        &u32s(&[USUAL | BIG_ENDIAN])[..],
        &be(&[4713]),
        &((metadata.len() + raw.len()) as u64).to_be_bytes(),
        &(metadata.len() as u64).to_be_bytes(),
        &metadata,
        &raw,
    ]
    .concat();
    let contents = strict(&file).unwrap();
    let series = &contents.series[0];
    assert_eq!(values(series), [0.1, -0.2]);
    assert_eq!(series.abscissa, even(0.0, 0.5));
    assert_eq!(series.properties[2].1, "2020-04-09T22:10:43.500000000Z");
}

#[test]
fn segments_build_on_those_before() {
    let a = |raw_index: &[u8]| object("/'g'/'a'", raw_index, &[]);
    let b = |raw_index: &[u8]| object("/'g'/'b'", raw_index, &[]);
    let file = [
        segment(USUAL, &[a(&numbers(2, 1))], &i16s(&[1])),
        // nothing new at all
        segment(RAW, &[], &i16s(&[2])),
        // one channel more, behind the one there is
        segment(METADATA | RAW, &[b(&numbers(2, 2))], &i16s(&[3, 10, 11])),
        // both as before, and more of the first
        segment(METADATA | RAW, &[a(&numbers(2, 2))], &i16s(&[4, 5, 12, 13])),
        // the first without data
        segment(METADATA | RAW, &[a(&NO_DATA)], &i16s(&[14, 15])),
        // a new list, in which the index of long ago still holds
        segment(
            USUAL,
            &[b(&AS_BEFORE), a(&AS_BEFORE)],
            &i16s(&[16, 17, 6, 7]),
        ),
        // metadata alone
        segment(
            METADATA | NEW_LIST,
            &[object("/'g'", &NO_DATA, &[word("state", "done")])],
            &[],
        ),
    ];
    let expected = named(&[
        ("a", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]),
        ("b", &[10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0]),
    ]);
    assert_eq!(all_values(&file.concat()), expected);
}

#[test]
fn fragments_of_one_sample_come_together() {
    let n = 20_000_i16;
    let mut file = segment(
        USUAL,
        &[object("/'g'/'a'", &numbers(2, 1), &[])],
        &i16s(&[0]),
    );
    for sample in 1..n {
        file.extend(segment(RAW, &[], &i16s(&[sample])));
    }
    let expected: Vec<f64> = (0..n).map(f64::from).collect();
    assert_eq!(all_values(&file), named(&[("a", &expected)]));
}

#[test]
fn channels_of_text_and_channels_without_data_are_named() {
    let texts = [u32s(&[3, 8]), b"onethree2".to_vec()].concat();
    let text_index = [
        u32s(&[28, 0x20, 1]),
        2_u64.to_le_bytes().to_vec(),
        (texts.len() as u64).to_le_bytes().to_vec(),
    ]
    .concat();
    let objects = [
        object("/'g'/'words'", &text_index, &[]),
        object("/'g'/'a'", &numbers(5, 1), &[]),
        object("/'g'/'none'", &NO_DATA, &[]),
    ];
    let contents = strict(&segment(USUAL, &objects, &[texts, vec![9]].concat())).unwrap();
    assert_eq!(
        contents.series.iter().map(values).collect::<Vec<_>>(),
        [[9.0]]
    );
    let expected = [(TEXT_CHANNEL, "g/words"), (EMPTY_CHANNEL, "g/none")]
        .map(|(k, v)| (k.to_owned(), v.to_owned()));
    assert_eq!(contents.properties, expected);
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

#[test]
fn daqmx_rows_hold_numbers_of_several_types() {
    let objects = [
        object("/'g'/'i8'", &daqmx(2, &[[1, 0, 0, 0]], &[7]), &[]),
        object("/'g'/'u16'", &daqmx(2, &[[2, 0, 1, 0]], &[7]), &[]),
        object("/'g'/'i32'", &daqmx(2, &[[5, 0, 3, 0]], &[7]), &[]),
    ];
    let row = |a: u8, b: u16, c: i32| [&[a][..], &b.to_le_bytes(), &c.to_le_bytes()].concat();
    let raw = [row(0xff, 0xffff, -1), row(2, 3, 4)].concat();
    let expected = named(&[
        ("i8", &[-1.0, 2.0]),
        ("u16", &[65_535.0, 3.0]),
        ("i32", &[-1.0, 4.0]),
    ]);
    // the flag for DAQmx data is sometimes missing
    for contains in [USUAL, USUAL | DAQMX, USUAL | DAQMX | INTERLEAVED] {
        assert_eq!(all_values(&segment(contains, &objects, &raw)), expected);
    }
}

#[test]
fn daqmx_buffers_follow_each_other_in_a_chunk() {
    let widths = [4, 2];
    let objects = [
        object("/'g'/'a'", &daqmx(2, &[[3, 0, 0, 0]], &widths), &[]),
        object("/'g'/'b'", &daqmx(2, &[[3, 0, 2, 0]], &widths), &[]),
        object("/'g'/'c'", &daqmx(1, &[[3, 1, 0, 0]], &widths), &[]),
    ];
    let raw = i16s(&[1, 11, 2, 12, 21, 3, 13, 4, 14, 22]);
    let expected = named(&[
        ("a", &[1.0, 2.0, 3.0, 4.0]),
        ("b", &[11.0, 12.0, 13.0, 14.0]),
        ("c", &[21.0, 22.0]),
    ]);
    assert_eq!(
        all_values(&segment(USUAL | DAQMX, &objects, &raw)),
        expected
    );
}

#[test]
fn daqmx_digital_lines_are_bits() {
    // type, buffer and offset in bits, then a format of one byte, then the scale
    let line = |bit: u32| {
        [
            u32s(&[0x126a, u32::MAX, 1]),
            4_u64.to_le_bytes().to_vec(),
            u32s(&[1, 0, 0, bit]),
            vec![0],
            u32s(&[0, 1, 4]),
        ]
        .concat()
    };
    let objects = [
        object("/'g'/'line 8'", &line(8), &[]),
        object("/'g'/'line 9'", &line(9), &[]),
    ];
    let raw = [0_u8, 1, 2, 3]
        .iter()
        .flat_map(|bits| [0, *bits, 0, 0])
        .collect::<Vec<_>>();
    let expected = named(&[
        ("line 8", &[0.0, 1.0, 0.0, 1.0]),
        ("line 9", &[0.0, 0.0, 1.0, 1.0]),
    ]);
    assert_eq!(
        all_values(&segment(USUAL | DAQMX, &objects, &raw)),
        expected
    );
}

fn scaled(raw_index: &[u8], properties: &[Vec<u8>], raw: &[u8]) -> Result<Vec<f64>, String> {
    let contains = if raw_index.starts_with(&[0x69, 0x12]) {
        USUAL | DAQMX
    } else {
        USUAL
    };
    let contents = strict(&segment(
        contains,
        &[object("/'g'/'a'", raw_index, properties)],
        raw,
    ));
    contents
        .map(|contents| values(&contents.series[0]).to_vec())
        .map_err(|error| error.to_string())
}

#[test]
fn scales_make_quantities_of_numbers() {
    let raw = i16s(&[1, 2, 3]);
    let linear = |scale: u32, slope: f64, intercept: f64, source: Option<u32>| {
        let mut properties = vec![
            word(&format!("NI_Scale[{scale}]_Scale_Type"), "Linear"),
            real(&format!("NI_Scale[{scale}]_Linear_Slope"), slope),
            real(&format!("NI_Scale[{scale}]_Linear_Y_Intercept"), intercept),
        ];
        properties.extend(
            source.map(|source| index(&format!("NI_Scale[{scale}]_Linear_Input_Source"), source)),
        );
        properties
    };
    let of = |n: u32, parts: &[Vec<Vec<u8>>]| {
        [vec![index("NI_Number_Of_Scales", n)], parts.concat()].concat()
    };

    let of_integers = |properties: &[Vec<u8>]| scaled(&numbers(2, 3), properties, &raw).unwrap();
    let once = of(1, &[linear(0, 2.0, 10.0, None)]);
    assert_eq!(of_integers(&once), [12.0, 14.0, 16.0]);

    let coefficients = |size: Option<u32>| {
        let mut properties = vec![word("NI_Scale[0]_Scale_Type", "Polynomial")];
        properties.extend(
            [10.0, 1.0, 2.0, 3.0]
                .iter()
                .zip(0..)
                .map(|(c, i)| real(&format!("NI_Scale[0]_Polynomial_Coefficients[{i}]"), *c)),
        );
        properties.extend(size.map(|n| index("NI_Scale[0]_Polynomial_Coefficients_Size", n)));
        properties
    };
    for (size, expected) in [
        (None, [16.0, 44.0, 112.0]),
        (Some(4), [16.0, 44.0, 112.0]),
        (Some(3), [13.0, 20.0, 31.0]),
        (Some(0), [0.0; 3]),
    ] {
        assert_eq!(of_integers(&of(1, &[coefficients(size)])), expected);
    }

    // in order, and with the raw numbers as everybody's input
    for (source, expected) in [(1, [21.0, 27.0, 33.0]), (u32::MAX, [6.0, 9.0, 12.0])] {
        let chain = [
            linear(0, 1.0, 1.0, Some(u32::MAX)),
            linear(1, 2.0, 2.0, Some(0)),
            linear(2, 3.0, 3.0, Some(source)),
        ];
        assert_eq!(of_integers(&of(3, &chain)), expected);
    }

    let done = [once, vec![word("NI_Scaling_Status", "scaled")]].concat();
    assert_eq!(of_integers(&done), [1.0, 2.0, 3.0]);
}

#[test]
fn tables_are_read_from_the_values_called_scaled() {
    let table = |name: &str, values: &[f64]| {
        let mut properties = vec![index(
            &format!("NI_Scale[0]_Table_{name}_Size"),
            u32::try_from(values.len()).unwrap(),
        )];
        properties.extend(
            values
                .iter()
                .zip(0..)
                .map(|(v, i)| real(&format!("NI_Scale[0]_Table_{name}[{i}]"), *v)),
        );
        properties
    };
    let of = |from: &[f64], to: &[f64]| {
        let kind = vec![
            index("NI_Number_Of_Scales", 1),
            word("NI_Scale[0]_Scale_Type", "Table"),
        ];
        [
            kind,
            table("Scaled_Values", from),
            table("Pre_Scaled_Values", to),
        ]
        .concat()
    };
    let raw = f64s(&[0.5, 1.0, 1.5, 2.5, 3.0, 3.5]);
    let through = |from: &[f64], to: &[f64]| scaled(&numbers(10, 6), &of(from, to), &raw);
    let expected = [2.0, 2.0, 3.0, 6.0, 8.0, 8.0];
    assert_eq!(
        through(&[1.0, 2.0, 3.0], &[2.0, 4.0, 8.0]).unwrap(),
        expected
    );
    assert_eq!(
        through(&[3.0, 2.0, 1.0], &[8.0, 4.0, 2.0]).unwrap(),
        expected
    );
    assert!(through(&[1.0, 3.0, 2.0], &[2.0, 4.0, 8.0]).is_err());
    assert!(through(&[1.0, 3.0], &[2.0]).is_err());
}

#[test]
fn two_scalers_of_a_channel_are_added_or_subtracted() {
    let raw_index = daqmx(3, &[[5, 0, 0, 0], [4, 0, 4, 1]], &[8]);
    let raw = u32s(&[1, 2, 2, 4, 3, 6]);
    for (kind, expected) in [("Add", [3.0, 6.0, 9.0]), ("Subtract", [1.0, 2.0, 3.0])] {
        let properties = [
            index("NI_Number_Of_Scales", 3),
            word("NI_Scale[2]_Scale_Type", kind),
            index(&format!("NI_Scale[2]_{kind}_Left_Operand_Input_Source"), 0),
            index(&format!("NI_Scale[2]_{kind}_Right_Operand_Input_Source"), 1),
        ];
        assert_eq!(scaled(&raw_index, &properties, &raw).unwrap(), expected);
    }
    // one scale, which is the scaler itself
    let one = daqmx(3, &[[5, 0, 0, 0]], &[4]);
    assert_eq!(
        scaled(&one, &[index("NI_Number_Of_Scales", 1)], &u32s(&[7, 8, 9])).unwrap(),
        [7.0, 8.0, 9.0]
    );
    assert!(
        scaled(&raw_index, &[], &raw)
            .unwrap_err()
            .contains("2 of them and no scale")
    );
}

#[test]
fn scales_of_the_group_and_of_the_file_hold_for_their_channels() {
    let scale = |slope: f64| {
        [
            index("NI_Number_Of_Scales", 1),
            word("NI_Scale[0]_Scale_Type", "Linear"),
            real("NI_Scale[0]_Linear_Slope", slope),
            real("NI_Scale[0]_Linear_Y_Intercept", 0.0),
        ]
    };
    let objects = [
        object("/", &NO_DATA, &scale(2.0)),
        object("/'g'", &NO_DATA, &scale(3.0)),
        object("/'g'/'a'", &numbers(2, 1), &[]),
        object("/'h'/'b'", &numbers(2, 1), &[]),
        object("/'g'/'c'", &numbers(2, 1), &scale(5.0)),
    ];
    let expected = named(&[("a", &[3.0]), ("b", &[2.0]), ("c", &[5.0])]);
    assert_eq!(
        all_values(&segment(USUAL, &objects, &i16s(&[1, 1, 1]))),
        expected
    );
}

#[test]
fn what_is_wrong_is_named_with_its_byte() {
    let good = segment(
        USUAL,
        &[object("/'g'/'a'", &numbers(2, 2), &[real("x", 1.0)])],
        &i16s(&[1, 2]),
    );
    let patched = |at: usize, bytes: &[u8]| {
        let mut file = good.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    let one = |raw_index: &[u8], properties: &[Vec<u8>], raw: &[u8]| {
        segment(USUAL, &[object("/'g'/'a'", raw_index, properties)], raw)
    };
    let scale = |kind: &str| {
        [
            index("NI_Number_Of_Scales", 1),
            word("NI_Scale[0]_Scale_Type", kind),
        ]
    };
    let two = i16s(&[1, 2]);
    let no_input = [
        &scale("Linear")[..],
        &[
            index("NI_Scale[0]_Linear_Input_Source", 0),
            word("wf_increment", "1 ms"),
        ],
    ]
    .concat();
    let unlike = [
        object("/'g'/'a'", &numbers(2, 1), &[]),
        object("/'g'/'b'", &numbers(2, 2), &[]),
    ];
    #[rustfmt::skip]
    let cases = [
        Vec::new(),
        good[..20].to_vec(),
        patched(0, b"TDSx"),
        patched(8, &[0x70]),
        patched(12, &[0xff]),
        patched(20, &[0xff]),
        patched(28, &[2]),
        patched(28, &[0xff; 4]),
        patched(32, &[0xff; 4]),
        patched(40, b"x"),
        good[..good.len() - 1].to_vec(),
        [&good[..], b"\0\0\0\0\0\0"].concat(),
        one(&numbers(11, 1), &[], &[0; 16]),
        one(&numbers(0x4f, 1), &[], &[0; 16]),
        one(&numbers(2, 3), &[], &two),
        one(&numbers(2, 0), &[], &two),
        one(&numbers(10, u64::MAX), &[], &two),
        one(&AS_BEFORE, &[], &two),
        one(&u32s(&[0x1369, 2, 1, 2, 0]), &[], &two),
        one(&u32s(&[20, 2, 2, 2, 0]), &[], &two),
        one(&numbers(2, 2), &[property("x", 0x1b, &[0; 16])], &two),
        one(&numbers(2, 2), &scale("Thermocouple"), &two),
        one(&numbers(2, 2), &scale("Linear"), &two),
        one(&numbers(2, 2), &[index("NI_Number_Of_Scales", u32::MAX)], &two),
        one(&numbers(2, 2), &no_input, &two),
        one(&daqmx(1, &[[3, 0, 3, 0]], &[4]), &[], &[0; 4]),
        one(&daqmx(1, &[[3, 1, 0, 0]], &[4]), &[], &[0; 4]),
        one(&daqmx(1, &[[77, 0, 0, 0]], &[4]), &[], &[0; 4]),
        one(&daqmx(1, &[[1, 0, 0, 0]; 9], &[1]), &[], &[0; 4]),
        segment(USUAL | INTERLEAVED, &unlike, &two),
        [good.clone(), one(&numbers(0x10_000d, 1), &[], &[0; 16])].concat(),
    ];
    insta::assert_snapshot!(refusals(cases.iter().map(|bytes| strict(bytes))), @r#"
    tdms, byte 0: tag of the lead-in is "", expected "TDSm"
    tdms, byte 20: offset of the raw data is cut after 0 bytes, expected 8 bytes
    tdms, byte 0: tag of the lead-in is "TDSx", expected "TDSm"
    tdms, byte 8: version is 4720, expected 4712 or 4713
    tdms, byte 12: offset of the next segment is 255, expected at most 61, the bytes to the end of the file
    tdms, byte 20: offset of the raw data is 255, expected at most 61, the bytes of the segment
    tdms, byte 85: path of an object is cut after 0 bytes, expected 4 bytes
    tdms, byte 85: path of an object is cut after 0 bytes, expected 4 bytes
    tdms, byte 36: path of an object is cut after 49 bytes, expected 4294967295 bytes
    tdms, byte 32: path of an object is `/'g'x'a'`, expected `/`, `/'group'` or `/'group'/'channel'`
    tdms, byte 12: offset of the next segment is 61, expected at most 60, the bytes to the end of the file
    tdms, byte 89: tag of the lead-in is "\x00\x00\x00\x00", expected "TDSm"
    tdms, byte 44: data type of raw data is extended precision, expected numbers of at most 64 bits
    tdms, byte 44: data type of raw data is 0x4f, expected a type whose size is known
    tdms, byte 68: raw data is 4 bytes, expected whole chunks of 6 bytes
    tdms, byte 68: raw data is 4 bytes, expected none, since no channel has values here
    tdms, byte 44: raw data index is more bytes than can be counted, expected a number of values that can be
    tdms, byte 44: raw data index is the same as before, expected an index in this segment or before, for `/'g'/'a'`
    tdms, byte 44: raw data index is 0x1369, expected its length (20, or 28 for texts), 0, 0x1269, 0x126a or 0xffffffff
    tdms, byte 52: array dimension is 2, expected 1
    tdms, byte 73: property `x` is of type 0x1b, expected an integer, a real or complex number, a truth value, a text or a time
    tdms, byte 99: property `NI_Scale[0]_Scale_Type` for g/a is Thermocouple, expected Linear, Polynomial, Table, Add or Subtract, the scales that are known
    tdms, byte 68: property `NI_Scale[0]_Linear_Slope` for g/a is missing, expected a number
    tdms, byte 68: property `NI_Scale[4294967294]_Scale_Type` for g/a is missing, expected a kind of scale, or a DAQmx scaler of that number
    tdms, byte 139: property `NI_Scale[0]_Linear_Input_Source` for g/a is 0, expected a scale before, or 0xffffffff for the raw numbers
    tdms, byte 68: DAQmx scaler is byte 3 of buffer 0, 2 bytes long, expected to be within one of the buffers, whose rows are [4] bytes wide
    tdms, byte 68: DAQmx scaler is byte 0 of buffer 1, 2 bytes long, expected to be within one of the buffers, whose rows are [4] bytes wide
    tdms, byte 68: data type of a DAQmx scaler is 77, expected 0 to 9
    tdms, byte 44: raw data index is 9 numbers in a row, expected at most one for each bit of the row
    tdms, byte 80: raw data index is 2 values, expected as many as of the channel before, interleaved with it
    tdms, byte 133: data type of raw data is Complex64, expected real, complex or times, as in the segments before
    "#);
}

#[test]
fn a_recording_that_was_cut_off_gives_what_is_there() {
    let objects = [
        object("/'g'/'a'", &numbers(2, 2), &[]),
        object("/'g'/'b'", &numbers(10, 1), &[]),
    ];
    let mut file = segment(
        USUAL,
        &objects,
        &[i16s(&[1, 2]), f64s(&[0.1]), i16s(&[3, 4])].concat(),
    );
    // the length of a segment that was never finished
    file[12..20].fill(0xff);
    let error = strict(&file).unwrap_err().to_string();
    assert!(error.contains("the recording was cut off"), "{error}");
    let contents = Tdms.read(&file, Strictness::Tolerant).unwrap();
    assert_eq!(contents.defects.len(), 1);
    let found: Vec<&[f64]> = contents.series.iter().map(values).collect();
    assert_eq!(found, [&[1.0, 2.0, 3.0, 4.0][..], &[0.1]]);
    // whole chunks are no defect even then
    file.truncate(file.len() - 4);
    assert_eq!(
        all_values(&file),
        named(&[("a", &[1.0, 2.0]), ("b", &[0.1])])
    );
    // nor are rows
    let mut rows = segment(USUAL | INTERLEAVED, &objects[..1], &i16s(&[1, 2, 3]));
    rows[12..20].fill(0xff);
    assert_eq!(all_values(&rows), named(&[("a", &[1.0, 2.0, 3.0])]));
}

#[test]
fn tolerantly_read_segments_before_a_broken_one_remain() {
    let good = segment(
        USUAL,
        &[object("/'g'/'a'", &numbers(2, 2), &[])],
        &i16s(&[1, 2]),
    );
    let scale = [
        index("NI_Number_Of_Scales", 1),
        word("NI_Scale[0]_Scale_Type", "RTD"),
    ];
    let other = segment(
        METADATA | RAW,
        &[object("/'g'/'b'", &numbers(2, 1), &scale)],
        &i16s(&[3, 4, 5]),
    );
    let file = [&good[..], &other, b"\0\0\0\0"].concat();
    let contents = Tdms.read(&file, Strictness::Tolerant).unwrap();
    assert_eq!(
        contents
            .series
            .iter()
            .map(|series| series.name.as_str())
            .collect::<Vec<_>>(),
        ["a"]
    );
    assert_eq!(values(&contents.series[0]), [1.0, 2.0, 3.0, 4.0]);
    insta::assert_snapshot!(defects(&contents), @r#"
    tdms, byte 214: tag of the lead-in is "\x00\x00\x00\x00", expected "TDSm"
    tdms, byte 171: property `NI_Scale[0]_Scale_Type` for g/b is RTD, expected Linear, Polynomial, Table, Add or Subtract, the scales that are known
    "#);
}

/// Sums and ends of the channels are those that npTDMS 1.13 reads.
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
        // 18 000 additions of numbers below 0.1 in another order
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
    // one rounding more, since the unit is a ratio
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

fn any_file() -> impl Strategy<Value = Vec<u8>> {
    let daqmx_index = daqmx(2, &[[3, 0, 0, 0], [3, 0, 2, 1]], &[4]);
    let scale = vec![
        index("NI_Number_Of_Scales", 3),
        word("NI_Scale[2]_Scale_Type", "Add"),
        index("NI_Scale[2]_Add_Left_Operand_Input_Source", 0),
        index("NI_Scale[2]_Add_Right_Operand_Input_Source", 1),
    ];
    let plain = [
        object("/'g'/'a'", &numbers(2, 2), &[real("wf_increment", 0.5)]),
        object("/'g'/'b'", &numbers(10, 2), &[]),
    ];
    let raw = [i16s(&[1, 2]), f64s(&[0.1, 0.2])].concat();
    let segments = prop::sample::select(vec![
        segment(USUAL, &plain, &raw),
        segment(USUAL | INTERLEAVED, &plain, &raw),
        segment(
            METADATA | RAW,
            &[object("/'g'/'b'", &AS_BEFORE, &[word("x", "y")])],
            &raw,
        ),
        segment(RAW, &[], &raw),
        segment(
            USUAL | DAQMX,
            &[object("/'g'/'d'", &daqmx_index, &scale)],
            &i16s(&[1, 2, 3, 4]),
        ),
    ]);
    prop::collection::vec(segments, 1..5).prop_map(|segments| segments.concat())
}

proptest! {
    #[test]
    fn spoilt_files_are_read_or_refused(
        file in any_file(),
        spoils in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut file = file;
        for (place, byte) in spoils {
            let place = place.index(file.len());
            file[place] = byte;
        }
        let tolerant = Tdms.read(&file, Strictness::Tolerant);
        if let (Ok(strict), Ok(tolerant)) = (strict(&file), &tolerant) {
            prop_assert_eq!(strict.series.len(), tolerant.series.len());
            prop_assert!(tolerant.defects.is_empty());
        }
        file.truncate(cut.index(file.len()));
        let _ = Tdms.read(&file, Strictness::Tolerant);
    }
}
