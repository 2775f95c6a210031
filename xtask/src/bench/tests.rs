//! Consistency of the tables. A row without a measurement is rejected.

use super::measured::{Benchmark, Machine, Measured, Program};
use super::result::results;
use super::*;

const ROWS: &str = r#"(sections: [(title: "marches", rows: [
    (what: "march", of: Rate("march/Maxwell"), unit: MillionsASecond, target: AtLeast(100.0), because: "one is enough",
     baseline: Bench("march/elastic")),
    (what: "with derivatives", of: Multiple("march/Maxwell", "march/elastic"), unit: Multiple, target: AtMost(1.5), because: "x"),
    (what: "help", of: Process("rodlab --help"), unit: Milliseconds, target: AtMost(20.0), because: "at once",
     baseline: Recorded(value: 100.0, by: "another")),
    (what: "memory", of: Memory("rodlab --help"), unit: Megabytes, target: AtMost(10.0), because: "x"),
    (what: "beside the machine", of: Time("march/Maxwell"), unit: Milliseconds, target: OfBound(1.25), because: "x",
     bound: Some((of: Time("march/elastic"), is: "no law")), missed: "the law is not free"),
])], growth: [
    (what: "march", with: "laws", from: (Time("march/elastic"), 1), to: (Time("march/Maxwell"), 4), at_most: 0.6),
])"#;

fn measured() -> Measured {
    let benchmark = |id: &str, median: f64| Benchmark {
        program: "rodwave/direct_problem".into(),
        id: id.into(),
        median,
        least: 0.9 * median,
        deviation: 0.01 * median,
        elements: Some(1_000_000),
    };
    Measured {
        machine: Machine::default(),
        benchmarks: vec![
            benchmark("march/elastic", 2e-3),
            benchmark("march/Maxwell", 4e-3),
        ],
        programs: vec![Program {
            name: "rodlab --help".into(),
            runs: 3,
            median: 2e-3,
            least: 1.9e-3,
            greatest: 2.3e-3,
            peak_memory: Some(5_000 * 1024),
        }],
        instructions: measured::Instructions::default(),
        instructions_in_gate: measured::Instructions::default(),
        before: vec![measured::Before {
            what: "march".into(),
            ours: 200.0,
        }],
    }
}

fn targets(text: &str) -> Outcome<Targets> {
    Targets::parse(Path::new("performance.ron"), text)
}

#[test]
fn what_is_missed_without_a_reason_is_refused_by_name() {
    let path = Path::new("performance.ron");
    let said = |text: &str| reasons(&targets(text).unwrap(), &measured(), path).err();
    let error = said(ROWS).unwrap().to_string();
    assert!(
        error.starts_with("performance.ron, row `with derivatives`: missed"),
        "{error}"
    );
    let met = ROWS.replace("AtMost(1.5)", "AtMost(2.5)");
    assert!(said(&met).is_none());
    let steep = met.replace("at_most: 0.6", "at_most: 0.4");
    assert!(said(&steep).unwrap().to_string().contains("row `march`"));
    let explained = steep.replace("at_most: 0.4", "at_most: 0.4, because: \"caches\"");
    assert!(said(&explained).is_none());
    let silent = met.replace("the law is not free", "");
    assert!(
        said(&silent)
            .unwrap()
            .to_string()
            .contains("row `beside the machine`")
    );
}

#[test]
fn a_row_without_a_measurement_is_refused_by_name() {
    let mut measured = measured();
    measured.benchmarks.pop();
    let error = results(&targets(ROWS).unwrap(), &measured)
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "3 rows have no measurement:\n  march (Rate(\"march/Maxwell\"))\n  with derivatives (Multiple(\"march/Maxwell\", \
         \"march/elastic\"))\n  beside the machine (Time(\"march/Maxwell\"))"
    );
}

#[test]
fn rows_that_cannot_be_are_refused() {
    let message = |from: &str, to: &str| {
        assert!(ROWS.contains(from));
        targets(&ROWS.replacen(from, to, 1))
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        message("unit: Milliseconds", "unit: Megabytes"),
        "performance.ron, row `help`: Process(\"rodlab --help\") is not measured in MB"
    );
    assert_eq!(
        message("AtLeast(100.0)", "AtLeast(-1.0)"),
        "performance.ron, row `march`: the target is -1, expected a finite number above 0"
    );
    assert_eq!(
        message(
            "bound: Some((of: Time(\"march/elastic\"), is: \"no law\"))",
            "bound: None"
        ),
        "performance.ron, row `beside the machine`: the target is a multiple of a bound, but the row has no bound"
    );
    assert_eq!(
        message(
            "(Time(\"march/Maxwell\"), 4)",
            "(Time(\"march/Maxwell\"), 1)"
        ),
        "performance.ron, row `march`: sizes 1 and 1, expected increasing sizes"
    );
    assert_eq!(
        message("because: \"at once\"", "because: \"\""),
        "performance.ron, row `help`: the target has no reason"
    );
    assert!(
        message("because: \"at once\"", "becuase: \"at once\"")
            .contains("performance.ron, line 5, column ")
    );
    let text = ROWS.replacen(
        "Process(\"rodlab --help\")",
        "Process(\"rodlab --halp\")",
        1,
    );
    let error = known_programs(&targets(&text).unwrap(), Path::new("performance.ron")).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("there is no program `rodlab --halp`"),
        "{error}"
    );
}

#[test]
fn a_long_record_keeps_its_header_and_its_first_samples() {
    let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
    let mut file = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    file.extend(format!("{text:<117}\n").bytes());
    file.extend((1..=6).flat_map(|n| f64::from(n).to_le_bytes()));
    let long = program::continued(&file, 5).unwrap();
    assert_eq!(long.len(), 128 + 2 * 5 * 8);
    assert!(String::from_utf8_lossy(&long[10..128]).contains("'shape': (2, 5), }"));
    assert_eq!(long[128..152], file[128..152]);
    assert_eq!(long[168..192], file[152..]);
    assert!(program::continued(&file[..170], 5).is_none());
}
