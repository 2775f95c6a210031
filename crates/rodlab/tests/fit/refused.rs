//! Wrong tables and sheets, with the message for each.

use crate::runs::{Folder, Words, with_causes};

/// A table with three frequencies at two temperatures.
const TABLE: &str = "f,E',E'',T,Set\nHz,MPa,MPa,degC,-\n1,1000,100,20,0\n10,1100,110,20.1,0\n100,1200,120,20.2,0\n1,900,100,30,1\n10,1000,110,30,1\n100,1100,120,30,1\n";
const SHEET: &str = r#"Fit(
    title: "wrong",
    tables: [(files: ["t.csv"], frequency: "f", modulus: Parts(storage: "E'", loss: "E''"), temperature: Column("T"))],
    reference_temperature: "20 degC",
)"#;

fn said(table: &str, sheet: &str) -> String {
    let folder = Folder::new();
    folder.write("t.csv", table);
    let error = folder.run(sheet).expect_err(sheet);
    with_causes(&error).replace(&folder.path().display().to_string(), "FOLDER")
}

#[test]
fn wrong_tables_are_refused_with_file_line_and_expectation() {
    let of = |from: &str, to: &str| {
        assert!(TABLE.contains(from), "{from}");
        said(&TABLE.replacen(from, to, 1), SHEET)
    };
    let all = [
        of("10,1100,110", "10,NaN,110"),
        of("10,1100,110", "10,,110"),
        of("10,1100,110", "10,high,110"),
        of("10,1100,110", "10,-1100,110"),
        of("10,1100,110", "0,1100,110"),
        of("10,1100,110", "1,1100,110"),
        of("10,1100,110", "Temperature reached"),
        of("20.1", "-300"),
        of("MPa,MPa", "mm,MPa"),
        of("Hz", "rad/s"),
        of("Hz", "furlong"),
        of("Hz,MPa,MPa,degC,-\n", ""),
        of("1,900,100,30,1\n", ""),
        said("", SHEET),
        said("Dear all\n", SHEET),
        said(
            &(0..40).fold("f,E',E'',T\nHz,MPa,MPa,degC\n".to_owned(), |text, k| {
                format!("{text}{},1000,100,{}\n", k + 1, 20.0 + 0.5 * f64::from(k))
            }),
            SHEET,
        ),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn wrong_sheets_are_refused_where_they_are_wrong() {
    let of = |from: &str, to: &str| {
        assert!(SHEET.contains(from), "{from}");
        said(TABLE, &SHEET.replacen(from, to, 1))
    };
    let with = |field: &str| of("Column(\"T\")", &format!("Column(\"T\"), {field}"));
    let before = |field: &str| of("tables: [(", &format!("{field}, tables: [("));
    let all = [
        of("reference_temperature: \"20 degC\",", ""),
        of("\"E''\"", "\"G''\""),
        of("frequency: \"f\"", "frequency: 7"),
        of("frequency: \"f\"", "angular_frequency: \"f\""),
        of("frequency: \"f\",", ""),
        of("Column(\"T\")", "Column(\"Set\")"),
        with(r#"units: (modulus: "GPa")"#),
        with(r#"units: (modulus: "mm")"#),
        with(r#"errors: MagnitudeAndPhase(magnitude: "1 %", phase: "1 %")"#),
        with(r#"errors: Columns(Parts(storage: "Set", loss: "E''"))"#),
        before(r#"steps: Within("1 degC")"#),
        before(r#"steps: Within("0.05 K")"#),
        before("steps: ByFile"),
        before(r#"band: (from: "1 kHz", to: "2 kHz")"#),
        of("tables: [(", "tables: [], x: [("),
        of("t.csv", "absent.csv"),
        before("laws: (laws: [])"),
        before("laws: (laws: [PowerLaw])"),
        before(
            r#"laws: (laws: [GeneralisedMaxwell], cards: (name: "a", poisson_ratio: "0.3", programs: [Abaqus]))"#,
        ),
        before(
            r#"kind: Shear, density: "1200 kg/m3", laws: (laws: [GeneralisedMaxwell], cards: (name: "a", poisson_ratio: "0.3", programs: [Abaqus]))"#,
        ),
        before(r#"stated_shifts: Wlf(c1: 10, c2: 20, at: "100 degC")"#),
        before(r#"stated_shifts: Table([(at: "20 degC", log10_shift: 0)])"#),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

/// A last line without data is left out with a warning; the same line between others is refused.
#[test]
fn a_last_line_that_is_none_is_left_out_and_said() {
    let folder = Folder::new();
    folder.write("t.csv", format!("{TABLE}]22[Freq0.1-100_"));
    let outcome = folder.run(SHEET).unwrap();
    let warning = "The rows of t.csv are followed by text that is not a row of numbers and was ignored: csv, line 9: row is `]22[Freq0.1-100_`, \
                   expected a row of 5 numbers.";
    assert!(
        outcome.warnings.iter().any(|w| w == warning),
        "{:?}",
        outcome.warnings
    );
    assert!(
        outcome
            .log
            .iter()
            .any(|entry| !entry.accepted && entry.what == "t.csv")
    );
}

/// A table of a relaxation test at one temperature.
const OVER_TIME: &str = "t,E,f\ns,MPa,Hz\n-1,0,1\n0,0,2\n1,1000,3\n2,900,4\n3,850,5\n4,820,6\n";
const HELD: &str = r#"Fit(title: "wrong", tables: [(files: ["t.csv"], time: "t", modulus: Relaxation(modulus: "E"), temperature: Stated("20 degC"))])"#;

#[test]
fn wrong_tests_over_time_are_refused() {
    let sheet = |from: &str, to: &str| {
        assert!(HELD.contains(from), "{from}");
        said(OVER_TIME, &HELD.replacen(from, to, 1))
    };
    let table = |from: &str, to: &str| {
        assert!(OVER_TIME.contains(from), "{from}");
        said(&OVER_TIME.replacen(from, to, 1), HELD)
    };
    let parts = r#"modulus: Parts(storage: "E", loss: "E")"#;
    let relaxation = r#"modulus: Relaxation(modulus: "E")"#;
    let all = [
        sheet(r#"time: "t", "#, ""),
        sheet(r#"time: "t""#, r#"frequency: "f""#),
        sheet(r#"time: "t""#, r#"time: "t", frequency: "f""#),
        sheet(r#"time: "t""#, r#"time: "E""#),
        sheet(relaxation, parts),
        sheet(
            &format!(r#"time: "t", {relaxation}"#),
            &format!(r#"frequency: "f", ramp: "1 s", {parts}"#),
        ),
        sheet(relaxation, r#"modulus: Creep(compliance: "E")"#),
        sheet(relaxation, &format!(r#"ramp: "10 s", {relaxation}"#)),
        sheet(relaxation, &format!(r#"ramp: "-1 s", {relaxation}"#)),
        sheet(
            relaxation,
            &format!(r#"ramp: "0.5 s ± 0.1 s", {relaxation}"#),
        ),
        sheet(
            relaxation,
            &format!(r#"times: (from: "2 s", to: "1 s"), {relaxation}"#),
        ),
        sheet(
            "temperature",
            r#"errors: Parts(storage: "1 %", loss: "1 %"), temperature"#,
        ),
        sheet(
            "temperature",
            r#"errors: Columns(Parts(storage: "E", loss: "E")), temperature"#,
        ),
        sheet(r#"title: "wrong""#, r#"title: "wrong", causal: true"#),
        sheet(
            r#"title: "wrong""#,
            r#"title: "wrong", band: (from: "1 Hz", to: "2 Hz")"#,
        ),
        table("2,900", "2,-900"),
        table("2,900", "1,900"),
        table("2,900", "NaN,900"),
        table("s,MPa,Hz", "s,1/MPa,Hz"),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

/// Of three values at each frequency the mean is fitted; a scatter of many stated errors puts the
/// result in doubt.
#[test]
fn repeated_readings_are_averaged_and_compared_with_their_errors() {
    let sheet = SHEET.replace(
        "temperature: Column",
        "errors: Parts(storage: \"1 %\", loss: \"1 %\"), temperature: Column",
    );
    let folder = Folder::new();
    for (scatter, verdict) in [(5, "Answered"), (200, "InDoubt")] {
        let mut table = "f,E',E'',T\nHz,MPa,MPa,degC\n".to_owned();
        for frequency in [1, 10, 100] {
            for reading in [-scatter, 0, scatter] {
                table += &format!("{frequency},{},100,20\n", 1000 + reading);
            }
        }
        folder.write("t.csv", table);
        let outcome = folder.run(&sheet).unwrap();
        let said = outcome.summary.join("\n");
        said.must_say("9 rows that repeat a frequency");
        format!("{:?}", outcome.verdict).must_begin(verdict);
        let data = crate::runs::table(&outcome, "data");
        assert_eq!(data.columns[0].cells.len(), 3);
    }
}

/// Two copies of each row count as one row.
#[test]
fn rows_that_are_stored_twice_count_once() {
    let folder = Folder::new();
    let rows = "1,1000,100,20\n10,1100,110,20\n100,1200,120,20\n";
    let table = format!("f,E',E'',T\nHz,MPa,MPa,degC\n{rows}{rows}");
    folder.write("t.csv", table);
    let outcome = folder.run(SHEET).unwrap();
    outcome.warnings.join("\n").must_say_all(&[
        "3 row(s) agree in every digit with another row",
        "first t.csv, line 6 with t.csv, line 3",
    ]);
    assert!(!outcome.summary.join("\n").contains("were averaged"));
}

#[test]
fn a_modulus_above_that_of_diamond_is_refused_unless_the_sheet_confirms_it() {
    let table = TABLE
        .replace("Hz,MPa,MPa", "Hz,GPa,GPa")
        .replace(",1000,", ",2000,");
    let table = table.replace(",1200,", ",1300,").replace(",900,", ",950,");
    let message = said(&table, SHEET);
    message.must_say("t.csv, line 3) is a modulus of 2000 GPa, expected at most 1500 GPa");
    let folder = Folder::new();
    folder.write("t.csv", table);
    let sheet = SHEET.replace(
        "reference_temperature",
        "unusual: true, reference_temperature",
    );
    assert!(folder.run(&sheet).is_ok());
}
