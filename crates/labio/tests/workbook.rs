//! Workbooks of Excel: exact numbers, names and units, several worksheets, cells that are not
//! numbers, and files that are cut off or hostile. The workbooks are written here as the XML that
//! the standard (ECMA-376) describes.

use std::io::{Cursor, Write};

use labio::LabioError;
use labio::format::workbook::Xlsx;
use labio::format::{self, Reader, Strictness};
use zip::write::SimpleFileOptions;

use crate::series::{bits, even, real};

const XML: &str = r#"<?xml version="1.0" encoding="UTF-8" standalone="yes"?>"#;

/// A workbook of worksheets, each a name with its rows in XML.
fn workbook(worksheets: &[(&str, &str)]) -> Vec<u8> {
    let numbered = || (1..).zip(worksheets);
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let relations = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let package = "http://schemas.openxmlformats.org/package/2006";
    let sheets: String = numbered()
        .map(|(k, (name, _))| format!(r#"<sheet name="{name}" sheetId="{k}" r:id="rId{k}"/>"#))
        .collect();
    let targets: String = numbered()
        .map(|(k, _)| {
            format!(r#"<Relationship Id="rId{k}" Type="{relations}/worksheet" Target="worksheets/sheet{k}.xml"/>"#)
        })
        .collect();
    let mut parts = vec![
        (
            "[Content_Types].xml".to_owned(),
            format!(
                r#"<Types xmlns="{package}/content-types"><Default Extension="xml" ContentType="application/xml"/></Types>"#
            ),
        ),
        (
            "_rels/.rels".to_owned(),
            format!(
                r#"<Relationships xmlns="{package}/relationships"><Relationship Id="rId1" Type="{relations}/officeDocument" Target="xl/workbook.xml"/></Relationships>"#
            ),
        ),
        (
            "xl/workbook.xml".to_owned(),
            format!(
                r#"<workbook xmlns="{main}" xmlns:r="{relations}"><sheets>{sheets}</sheets></workbook>"#
            ),
        ),
        (
            "xl/_rels/workbook.xml.rels".to_owned(),
            format!(r#"<Relationships xmlns="{package}/relationships">{targets}</Relationships>"#),
        ),
        (
            "xl/styles.xml".to_owned(),
            // the second style is a date
            format!(
                r#"<styleSheet xmlns="{main}"><cellXfs count="2"><xf numFmtId="0"/><xf numFmtId="14"/></cellXfs></styleSheet>"#
            ),
        ),
    ];
    for (k, (_, rows)) in numbered() {
        parts.push((
            format!("xl/worksheets/sheet{k}.xml"),
            format!(r#"<worksheet xmlns="{main}"><sheetData>{rows}</sheetData></worksheet>"#),
        ));
    }
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in parts {
        archive
            .start_file(name, SimpleFileOptions::default())
            .unwrap();
        write!(archive, "{XML}{text}").unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// A row with texts or numbers from column B on.
fn row(number: usize, cells: &[&str]) -> String {
    let cells: String = cells
        .iter()
        .zip('B'..)
        .map(|(cell, column)| match cell.parse::<f64>() {
            Ok(_) => format!(r#"<c r="{column}{number}"><v>{cell}</v></c>"#),
            Err(_) => {
                format!(r#"<c r="{column}{number}" t="inlineStr"><is><t>{cell}</t></is></c>"#)
            }
        })
        .collect();
    format!(r#"<row r="{number}">{cells}</row>"#)
}

/// A title, an empty row, names, units, and numbers that need all of their digits.
fn table(values: &[f64]) -> String {
    let mut rows =
        row(1, &["Bar, shot 3"]) + &row(3, &["Time", "Force"]) + &row(4, &["(ms)", "(kN)"]);
    for (k, value) in values.iter().enumerate() {
        rows += &row(
            5 + k,
            &[&format!("{}", k as f64 * 0.25), &format!("{value:e}")],
        );
    }
    rows
}

const VALUES: [f64; 5] = [
    0.1,
    -1.0 / 3.0,
    2.5e-308,
    1.797_693_134_862_315_7e308,
    5e-324,
];

#[test]
fn numbers_are_read_to_the_bit_with_names_and_units() {
    let bytes = workbook(&[
        ("shot", &table(&VALUES)),
        ("notes", &row(1, &["no numbers"])),
    ]);
    let contents = format::read_bytes(&bytes).unwrap();
    assert_eq!((contents.format, contents.series.len()), ("xlsx", 1));
    let series = &contents.series[0];
    assert_eq!(
        (
            series.name.as_str(),
            series.ordinate_axis.unit_text.as_str()
        ),
        ("Force", "kN")
    );
    assert_eq!(series.abscissa, even(0.0, 0.25));
    assert_eq!(series.abscissa_axis.unit_text, "ms");
    assert_eq!(bits(real(&contents, 0)), bits(&VALUES));
    let has = |value: &str| contents.properties.iter().any(|(_, own)| own == value);
    assert!(has("notes"), "{:?}", contents.properties);
    // a stated rate that agrees with the times
    let at_rate = format::read_bytes_at(&bytes, 4000.0).unwrap();
    assert_eq!(at_rate.series[0].abscissa, series.abscissa);
}

#[test]
fn worksheets_name_their_series() {
    let bytes = workbook(&[("slow", &table(&VALUES)), ("fast", &table(&VALUES[..3]))]);
    let contents = format::read_bytes(&bytes).unwrap();
    let names: Vec<&str> = contents.series.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["slow/Force", "fast/Force"]);
    assert_eq!(real(&contents, 1).len(), 3);
}

#[test]
fn a_date_and_an_error_are_no_numbers() {
    for cell in [
        r#"<c r="C7" s="1"><v>45000</v></c>"#,
        r#"<c r="C7" t="e"><v>#DIV/0!</v></c>"#,
    ] {
        let number = r#"<c r="C7"><v>2.5e-308</v></c>"#;
        let rows = table(&VALUES);
        assert!(rows.contains(number));
        let bytes = workbook(&[("shot", &rows.replace(number, cell))]);
        let error = format::read_bytes(&bytes).unwrap_err().to_string();
        assert!(
            error.starts_with("xlsx, line 7") && error.contains("worksheet `shot`"),
            "{error}"
        );
        let tolerant = Xlsx.read(&bytes, Strictness::Tolerant).unwrap();
        assert!(real(&tolerant, 0)[2].is_nan() && tolerant.defects.len() == 1);
    }
}

/// A formula without a value, as openpyxl writes it, is an error: its column must not be lost.
#[test]
fn a_formula_without_its_value_is_refused_at_its_place() {
    let number = r#"<c r="C7"><v>2.5e-308</v></c>"#;
    let formula = r#"<c r="C7"><f>B7*2</f><v/></c>"#;
    let bytes = workbook(&[("shot", &table(&VALUES).replace(number, formula))]);
    let error = format::read_bytes(&bytes).unwrap_err().to_string();
    assert_eq!(
        error,
        "xlsx, line 7, column 3: worksheet `shot`: cell is a formula without its value, expected a workbook saved by a program that computes its formulas"
    );
}

/// Dates in place of times leave no row of numbers; the message names the first of them.
#[test]
fn a_column_of_dates_is_refused_with_its_first_date() {
    let rows: String = (1..5)
        .map(|k| {
            format!(r#"<row r="{k}"><c r="A{k}" t="inlineStr"><is><t>2026-11-21 12:0{k}</t></is></c><c r="B{k}"><v>1.5</v></c></row>"#)
        })
        .collect();
    let error = format::read_bytes(&workbook(&[("shot", &rows)])).unwrap_err();
    assert_eq!(
        error.to_string(),
        "xlsx, line 1, column 1: worksheet `shot`: cell is `2026-11-21 12:01`, expected a number"
    );
}

#[test]
fn what_holds_no_numbers_or_is_another_archive_is_refused() {
    let bytes = workbook(&[("notes", &row(1, &["no numbers"]))]);
    assert!(matches!(
        format::read_bytes(&bytes),
        Err(LabioError::NoData { format: "xlsx" })
    ));
    // two cells in opposite corners of a worksheet do not take the memory of all cells between them
    let far = r#"<row r="1"><c r="A1"><v>1</v></c></row><row r="1048576"><c r="XFD1048576"><v>2</v></c></row>"#;
    let _ = format::read_bytes(&workbook(&[("far", far)]));
    // a list that announces more texts than it can contain is rejected before memory is reserved
    let mut archive = zip::ZipWriter::new_append(Cursor::new(workbook(&[("shot", "")]))).unwrap();
    archive
        .start_file("xl/sharedStrings.xml", SimpleFileOptions::default())
        .unwrap();
    write!(
        archive,
        r#"{XML}<sst uniqueCount="1000000000000"><si><t>a</t></si></sst>"#
    )
    .unwrap();
    let announcing = archive.finish().unwrap().into_inner();
    let error = format::read_bytes(&announcing).unwrap_err().to_string();
    assert!(error.contains("sharedStrings"), "{error}");
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    archive
        .start_file("[Content_Types].xml", SimpleFileOptions::default())
        .unwrap();
    let document = archive.finish().unwrap().into_inner();
    assert!(format::read_bytes(&document).is_err());
}

/// Files cut off after every byte, and with every byte changed, give an error or numbers, but no
/// panic.
#[test]
fn broken_workbooks_are_refused() {
    let bytes = workbook(&[("shot", &table(&VALUES))]);
    for end in 0..bytes.len() {
        assert!(
            Xlsx.read(&bytes[..end], Strictness::Strict).is_err(),
            "{end}"
        );
    }
    for at in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[at] ^= 0x5a;
        let _ = Xlsx.read(&changed, Strictness::Tolerant);
    }
}
