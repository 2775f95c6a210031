//! Files that are invalid, cut off or damaged.

use super::*;
use crate::series::{defects, refusals};

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
        one(&numbers(2, 2), &scale("Thermistor"), &two),
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
    tdms, byte 12: offset of the next segment is 255, expected at most 61, the number of bytes to the end of the file
    tdms, byte 20: offset of the raw data is 255, expected at most 61, the number of bytes in the segment
    tdms, byte 85: path of an object is cut after 0 bytes, expected 4 bytes
    tdms, byte 85: path of an object is cut after 0 bytes, expected 4 bytes
    tdms, byte 36: path of an object is cut after 49 bytes, expected 4294967295 bytes
    tdms, byte 32: path of an object is `/'g'x'a'`, expected `/`, `/'group'` or `/'group'/'channel'`
    tdms, byte 12: offset of the next segment is 61, expected at most 60, the number of bytes to the end of the file
    tdms, byte 89: tag of the lead-in is "\x00\x00\x00\x00", expected "TDSm"
    tdms, byte 44: data type of raw data is extended precision, expected numbers of at most 64 bits
    tdms, byte 44: data type of raw data is 0x4f, expected a type whose size is known
    tdms, byte 68: raw data is 4 bytes, expected whole chunks of 6 bytes
    tdms, byte 68: raw data is 4 bytes, expected none, since no channel has values here
    tdms, byte 44: raw data index is more bytes than can be counted, expected a smaller number of values
    tdms, byte 44: raw data index is the same as before, expected an index in this segment or an earlier one, for `/'g'/'a'`
    tdms, byte 44: raw data index is 0x1369, expected its length (20, or 28 for texts), 0, 0x1269, 0x126a or 0xffffffff
    tdms, byte 52: array dimension is 2, expected 1
    tdms, byte 73: property `x` is of type 0x1b, expected an integer, a real or complex number, a Boolean value, a text or a time
    tdms, byte 99: property `NI_Scale[0]_Scale_Type` for g/a is Thermistor, expected Linear, Polynomial, Table, Add, Subtract, Strain, RTD or Thermocouple, the scales that are known
    tdms, byte 68: property `NI_Scale[0]_Linear_Slope` for g/a is missing, expected a number
    tdms, byte 68: property `NI_Scale[4294967294]_Scale_Type` for g/a is missing, expected a kind of scale, or a DAQmx scaler of that number
    tdms, byte 139: property `NI_Scale[0]_Linear_Input_Source` for g/a is 0, expected an earlier scale, or 0xffffffff for the raw numbers
    tdms, byte 68: DAQmx scaler is byte 3 of buffer 0, 2 bytes long, expected a position within one of the buffers, whose rows are [4] bytes wide
    tdms, byte 68: DAQmx scaler is byte 0 of buffer 1, 2 bytes long, expected a position within one of the buffers, whose rows are [4] bytes wide
    tdms, byte 68: data type of a DAQmx scaler is 77, expected 0 to 9
    tdms, byte 44: raw data index is 9 numbers in a row, expected at most one for each bit of the row
    tdms, byte 80: raw data index is 2 values, expected as many as for the previous channel, interleaved with it
    tdms, byte 133: data type of raw data is Complex64, expected real, complex or times, as in the previous segments
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
    // the length of a segment that was being written when the recording was cut off
    file[12..20].fill(0xff);
    let error = strict(&file).unwrap_err().to_string();
    assert!(error.contains("the recording was cut off"), "{error}");
    let contents = Tdms.read(&file, Strictness::Tolerant).unwrap();
    assert_eq!(contents.defects.len(), 1);
    let found: Vec<&[f64]> = contents.series.iter().map(values).collect();
    assert_eq!(found, [&[1.0, 2.0, 3.0, 4.0][..], &[0.1]]);
    // if the last chunk is whole, there is no defect
    file.truncate(file.len() - 4);
    assert_eq!(
        all_values(&file),
        named(&[("a", &[1.0, 2.0]), ("b", &[0.1])])
    );
    // the same applies to interleaved rows
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
        word("NI_Scale[0]_Scale_Type", "Thermistor"),
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
    tdms, byte 221: tag of the lead-in is "\x00\x00\x00\x00", expected "TDSm"
    tdms, byte 171: property `NI_Scale[0]_Scale_Type` for g/b is Thermistor, expected Linear, Polynomial, Table, Add, Subtract, Strain, RTD or Thermocouple, the scales that are known
    "#);
}
