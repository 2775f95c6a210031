//! Faulty tables, and texts that are not tables.

use super::*;

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let wrong = [
        "",
        "\n \n",
        "nothing but words\n",
        "0,914\n0,537\n",
        "t,F\n0,1\n1,oops\n2,3\n",
        "t,F\n0,1\n1,2,3\n2,3\n",
        "t,F\n0,1\n1,\n2,3\n",
        "t,F\n0,1\n,2\n2,3\n",
        "t,F\n0,1\nNaN,2\n2,3\n",
        "t,F\n0,1\n1,2\n2,3\n]1[JAL03-01\n",
        "t,F,\n0,1,\n1,2,\n2,3,4\n",
        "t,F\n0,1\n1+1j,1\n2,1\n",
        "# abscissa = even, start 0.0, step 0.5\nt,F\n0.0,1\n0.6,2\n",
    ]
    .map(read);
    insta::assert_snapshot!(refusals(wrong), @r"
    the csv file contains no data
    the csv file contains no data
    csv, line 1: table is not found, expected rows of numbers within the first 1000 lines
    csv, line 1: comma is either a separator or a decimal mark, expected names above the numbers, such as `time,force`, if commas separate the columns, or decimal points if they do not; a program can state `separator` and `decimal_mark` of a `CsvDialect`
    csv, line 3, column 2: cell is `oops`, expected a number
    csv, line 4: row is `2,3`, expected a row of 3 numbers
    csv, line 4, column 2: cell is a number below an empty cell, expected no empty cell above it in the column
    csv, line 4, column 1: cell is a number below an empty cell, expected no empty cell above it in the column
    csv, line 3, column 1: abscissa is `NaN`, expected a finite number
    csv, line 5: row is `]1[JAL03-01`, expected a row of 2 numbers
    csv, line 4: row is `2,3,4`, expected a row of 2 numbers
    csv, line 3, column 1: abscissa is `1+1j`, expected a real number
    csv, line 3, column 1: abscissa is a value other than that of start and step in row 2, expected the abscissa stated in the header
    ");
}

#[test]
fn a_tolerant_reading_lists_what_it_passed_over() {
    let text = "t,F,a\n0,1,5\n1,oops,6\n2,,7\n3,4,8\nend of file\n";
    let contents = Csv.read(text.as_bytes(), Strictness::Tolerant).unwrap();
    let force = real(&contents, 0);
    assert_eq!((force[0], force[3]), (1.0, 4.0));
    assert!(force[1].is_nan() && force[2].is_nan());
    assert_eq!(real(&contents, 1), [5.0, 6.0, 7.0, 8.0]);
    insta::assert_snapshot!(defects(&contents), @r"
    csv, line 3, column 2: cell is `oops`, expected a number
    csv, line 5, column 2: cell is a number below an empty cell, expected no empty cell above it in the column
    csv, line 6: row is `end of file`, expected a row of 3 numbers
    ");
    // the number of listed defects is limited
    let junk = format!("t,F\n0,1\n1,2\n{}", "junk\n".repeat(5000));
    let contents = Csv.read(junk.as_bytes(), Strictness::Tolerant).unwrap();
    assert_eq!(contents.defects.len(), 101);
    assert!(
        contents.defects[100]
            .to_string()
            .contains("4900 further defects")
    );
}

#[test]
fn only_tables_are_recognised() {
    for text in ["t,F\n0,1\n1,2\n", "0.5\n0.6\n", "\u{feff}f;H\n0,1;2\n"] {
        assert!(Csv.recognises(text.as_bytes()), "{text}");
    }
    let wave = b"RIFF\x24\0\0\0WAVEfmt 1,2\n1,2\n";
    let lvm = b"LabVIEW Measurement\t\n1\t2\n1\t2\n";
    for bytes in [
        &wave[..],
        lvm,
        b"",
        b"some text\nof 3 words\n",
        b"\x93NUMPY\x01\0 1,2\n3,4\n",
    ] {
        assert!(!Csv.recognises(bytes));
    }
    // the first bytes of a file, which end within a row or within a UTF-16 character
    let long: String = std::iter::once("t,F\n".to_owned())
        .chain((0..2000).map(|i| format!("{i},{i}.5\n")))
        .collect();
    assert!(Csv.recognises(&long.as_bytes()[..4096]));
    let wide: Vec<u8> = std::iter::once(0xfeff)
        .chain(long.encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    assert!(Csv.recognises(&wide[..4096]));
    assert_eq!(real(&read(&wide).unwrap(), 0).len(), 2000);
}

/// A decimal comma between two integers must not split a column into two.
#[test]
fn one_name_above_decimal_commas_names_one_column() {
    for text in [
        "Kraft\n1,50\n2,25\n-3,75\n",
        "Kraft\n[N]\n1,50\n2,25\n",
        "Zeit,Kraft\n0,1,2,5\n0,2,-3,5\n",
    ] {
        let said = read(text).unwrap_err().to_string();
        assert!(
            said.contains("comma is either a separator or a decimal mark"),
            "{text}: {said}"
        );
    }
    let contents = read("time,force\n1,50\n2,25\n3,75\n").unwrap();
    assert_eq!(real(&contents, 0), [50.0, 25.0, 75.0]);
}

/// Files with a cell in every row that is not a number: the message names the first of these cells.
#[test]
fn text_in_every_row_is_named() {
    let said = |rows: [&str; 3]| {
        let text = format!("time,force,state\n{}\n", rows.join("\n"));
        labio::format::read_bytes(text.as_bytes())
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        said(["0.0,1.5,ok", "0.1,2.5,ok", "0.2,3.5,ok"]),
        "csv, line 2, column 3: cell is `ok`, expected a number"
    );
    assert_eq!(
        said([
            "2026-11-21 12:00:00,1,2",
            "2026-11-21 12:00:01,2,3",
            "2026-11-21 12:00:02,3,4"
        ]),
        "csv, line 2, column 1: cell is `2026-11-21 12:00:00`, expected a number"
    );
    assert_eq!(
        said(["0,\"1,234.5\",1", "1,\"2,234.5\",1", "2,\"3,234.5\",1"]),
        "csv, line 2, column 2: cell is `1,234.5`, expected a number"
    );
}

/// Two columns of times with different steps: the channels after the second have another rate.
#[test]
fn a_second_column_of_other_times_is_refused() {
    let text = |step: f64, unit: &str| {
        let rows: String = (0..5)
            .map(|k| {
                format!(
                    "{:.1},{k},{:.3},1\n",
                    0.1 * f64::from(k),
                    step * f64::from(k)
                )
            })
            .collect();
        format!("time [s],F [N],time 2 [{unit}],a [g]\n{rows}")
    };
    let said = read(text(0.05, "s")).unwrap_err().to_string();
    assert!(
        said.starts_with("csv, line 2, column 3: step of the times is 5e-2 s, expected 1e-1 s"),
        "{said}"
    );
    assert_eq!(read(text(100.0, "ms")).unwrap().series.len(), 3);
    // segments of an oscilloscope side by side: the second begins 13 ms after the first
    let rows = (0..5).map(|k| format!("{k}e-6,1,{}e-6,2\n", 13_000 + k));
    let segments = format!(
        "time [s],F [N],time 2 [s],a [g]\n{}",
        rows.collect::<String>()
    );
    let said = read(segments).unwrap_err().to_string();
    assert!(
        said.starts_with("csv, line 2, column 3: start of the times is 1.3e-2 s, expected 0e0 s"),
        "{said}"
    );
}
