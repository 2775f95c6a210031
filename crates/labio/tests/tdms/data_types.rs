//! Types of properties and of raw data, and the order of their bytes.

use labio::SeriesKind;
use labio::format::tdms::{FIRST_TIME, GROUP};

use super::*;
use crate::series::property as property_of;

const BIG_ENDIAN: u32 = 64;

/// A file with every byte written out: a group `g` with a channel `a` of two 32-bit integers and
/// one property.
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

/// Values that do not occur in the files of npTDMS: the upper half of 64 bits, and a truth value
/// other than 1.
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
