//! Tables written by this program, which have column names such as `storage_modulus_pa`.

use std::borrow::Cow;

use crate::outcome::LogEntry;

/// Endings of column names, and the units that they denote.
const UNITS: [(&str, &str); 12] = [
    ("_rad_per_s", "rad/s"),
    ("_per_pa", "1/Pa"),
    ("_per_mpa", "1/MPa"),
    ("_hz", "Hz"),
    ("_khz", "kHz"),
    ("_gpa", "GPa"),
    ("_mpa", "MPa"),
    ("_kpa", "kPa"),
    ("_pa", "Pa"),
    ("_degc", "degC"),
    ("_deg", "deg"),
    ("_s", "s"),
];

/// Column that states whether a row may be used.
const VALID: &str = "valid";

/// Returns a table of this program in the form of other tables: units in brackets, no columns of
/// text, and empty lines in place of invalid rows, whose number is logged for the file `path`.
/// Other tables are returned unchanged.
pub(super) fn as_numbers<'a>(
    bytes: &'a [u8],
    path: &str,
    log: &mut Vec<LogEntry>,
) -> Cow<'a, [u8]> {
    numbers(bytes, path, log).map_or(Cow::Borrowed(bytes), |text| Cow::Owned(text.into_bytes()))
}

fn numbers(bytes: &[u8], path: &str, log: &mut Vec<LogEntry>) -> Option<String> {
    let mut reader = csv::Reader::from_reader(bytes);
    let names = reader.headers().ok()?.clone();
    if names.len() < 2 || !names.iter().all(is_snake_case) {
        return None;
    }
    let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().ok()?;
    let of_numbers: Vec<usize> = (0..names.len())
        .filter(|at| {
            let mut cells = rows.iter().filter_map(|row| row.get(*at));
            cells.any(|cell| cell.trim().parse::<f64>().is_ok())
        })
        .collect();
    let valid = names.iter().position(|name| name == VALID);
    let header = of_numbers
        .iter()
        .filter_map(|at| names.get(*at))
        .map(|name| {
            let unit = UNITS.iter().find(|(ending, _)| name.ends_with(ending));
            unit.map_or_else(|| name.to_owned(), |(_, unit)| format!("{name} ({unit})"))
        });
    let mut text = header.collect::<Vec<_>>().join(",") + "\n";
    let mut line = 1;
    let mut n_left_out = 0;
    for row in &rows {
        // every row stays on its line of the file, so that messages name the right line
        let at = row.position().map_or(line + 1, csv::Position::line);
        while line + 1 < at {
            text.push('\n');
            line += 1;
        }
        line += 1;
        let is_left_out = valid.and_then(|at| row.get(at)) == Some("false");
        n_left_out += usize::from(is_left_out);
        if !is_left_out {
            let cells = of_numbers.iter().map(|at| row.get(*at).unwrap_or(""));
            text += &cells.collect::<Vec<_>>().join(",");
        }
        text.push('\n');
    }
    if n_left_out > 0 {
        log.push(LogEntry::rejected(
            format!("{path}: {n_left_out} of {} rows", rows.len()),
            format!("`{VALID}` is false"),
        ));
    }
    Some(text)
}

fn is_snake_case(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_lowercase())
        && name
            .chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_of_results_loses_its_text_and_its_invalid_rows() {
        let file = b"frequency_hz,loss_factor,storage_modulus_pa,valid,reasons\n\
            1,0.1,2e9,true,\n2,0.2,3e9,false,\"short, and wrong\"\n4,,5e9,true,\n";
        let mut log = Vec::new();
        let table = as_numbers(file, "modulus.csv", &mut log);
        assert_eq!(
            std::str::from_utf8(&table).unwrap(),
            "frequency_hz (Hz),loss_factor,storage_modulus_pa (Pa)\n1,0.1,2e9\n\n4,,5e9\n"
        );
        assert_eq!(log.len(), 1);
        assert_eq!(log[0].what, "modulus.csv: 1 of 3 rows");
    }

    #[test]
    fn other_tables_stay_as_they_are() {
        for file in ["f,E'\nHz,Pa\n1,2\n", "1,2\n3,4\n", "f;E\n1,5;2\n"] {
            let mut log = Vec::new();
            let table = as_numbers(file.as_bytes(), "a.csv", &mut log);
            assert!(matches!(table, Cow::Borrowed(_)), "{file}");
        }
    }
}
