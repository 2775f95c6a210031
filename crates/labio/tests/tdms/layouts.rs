//! Segments, and the layout of raw data in them.

use labio::format::tdms::{EMPTY_CHANNEL, TEXT_CHANNEL};

use super::*;

#[test]
fn segments_build_on_those_before() {
    let a = |raw_index: &[u8]| object("/'g'/'a'", raw_index, &[]);
    let b = |raw_index: &[u8]| object("/'g'/'b'", raw_index, &[]);
    let file = [
        segment(USUAL, &[a(&numbers(2, 1))], &i16s(&[1])),
        // no metadata: the same channel again
        segment(RAW, &[], &i16s(&[2])),
        // one more channel, after the existing one
        segment(METADATA | RAW, &[b(&numbers(2, 2))], &i16s(&[3, 10, 11])),
        // both channels as before, with more samples of the first
        segment(METADATA | RAW, &[a(&numbers(2, 2))], &i16s(&[4, 5, 12, 13])),
        // the first channel without data
        segment(METADATA | RAW, &[a(&NO_DATA)], &i16s(&[14, 15])),
        // a new list of both channels, with the raw data index of the segment before
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
    // type, buffer and offset in bits, a format of one byte, and the scale
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
