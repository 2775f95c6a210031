//! Names and units of columns for other programs: `storage_modulus_pa` for "E'" in GPa.
//!
//! A column is declared once, by its words and its unit, as they appear in reports and figures.
//! CSV, JSON and Python use the name that is derived here: the words in lower case with `_` between
//! them, and the unit. Their numbers are in units without a prefix (Pa, not GPa); `%`, `deg` and
//! `degC` are kept.

/// Units with a prefix, each with the unit without prefix and the factor to it.
const PREFIXED: [(&str, &str, f64); 18] = [
    ("kHz", "Hz", 1e3),
    ("MHz", "Hz", 1e6),
    ("kPa", "Pa", 1e3),
    ("MPa", "Pa", 1e6),
    ("GPa", "Pa", 1e9),
    ("GPa^2", "Pa^2", 1e18),
    ("us", "s", 1e-6),
    ("ms", "s", 1e-3),
    ("um", "m", 1e-6),
    ("mm", "m", 1e-3),
    ("mm/s", "m/s", 1e-3),
    ("km/s", "m/s", 1e3),
    ("kN", "N", 1e3),
    ("mN", "N", 1e-3),
    ("kN/m", "N/m", 1e3),
    ("MN/m", "N/m", 1e6),
    ("kJ", "J", 1e3),
    ("mJ", "J", 1e-3),
];

/// Words that are left out of a name.
const ARTICLES: [&str; 2] = ["of", "the"];

/// Returns the unit of a column for other programs, and the factor from `unit` to it.
pub(super) fn unit_without_prefix(unit: &str) -> (&str, f64) {
    PREFIXED
        .iter()
        .find(|(prefixed, ..)| *prefixed == unit)
        .map_or((unit, 1.0), |(_, plain, factor)| (*plain, *factor))
}

/// Returns the name of the column `words` in `unit`, which has no prefix.
pub(super) fn name_of(words: &str, unit: &str) -> String {
    let mut plain = words.to_owned();
    for symbol in ["E", "G", "K"] {
        plain = plain
            .replace(&format!("{symbol}''"), " loss modulus ")
            .replace(&format!("{symbol}'"), " storage modulus ");
    }
    let plain = plain.to_lowercase();
    let mut parts: Vec<&str> = plain
        .split(|c: char| !c.is_alphanumeric())
        .filter(|part| !part.is_empty() && !ARTICLES.contains(part))
        .collect();
    // a name must begin with a letter: `95 % half width` becomes `half_width_95`
    let numbers = parts
        .iter()
        .take_while(|part| part.starts_with(|c: char| c.is_numeric()))
        .count();
    if numbers < parts.len() {
        parts.rotate_left(numbers);
    }
    let unit = unit
        .replace('%', "percent")
        .replace('/', " per ")
        .to_lowercase();
    let unit: Vec<String> = unit
        .replace("1 per ", " per ")
        .split(|c: char| !(c.is_alphanumeric() || c == '^'))
        .filter(|part| !part.is_empty())
        .map(|part| part.replace('^', ""))
        .collect();
    let units = unit.iter().map(String::as_str);
    let name = parts.into_iter().chain(units).collect::<Vec<_>>().join("_");
    if name.starts_with(|c: char| c.is_alphabetic()) {
        name
    } else {
        format!("column_{name}")
    }
}

#[cfg(test)]
mod tests {
    use labio::Unit;

    use super::*;

    #[test]
    fn a_name_has_the_words_and_the_unit() {
        let names = "
            frequency; Hz; frequency_hz
            E'; Pa; storage_modulus_pa
            G'; Pa; storage_modulus_pa
            residual of K'' by |K|; percent; residual_loss_modulus_by_k_percent
            standard error of E'; Pa; standard_error_storage_modulus_pa
            standard error of the loss factor;; standard_error_loss_factor
            covariance of E' and E''; Pa^2; covariance_storage_modulus_and_loss_modulus_pa2
            bound of the lateral inertia left in E'; Pa; bound_lateral_inertia_left_in_storage_modulus_pa
            95 % half width of the stress; Pa; half_width_stress_95_pa
            expanded uncertainty (95 %), of the loss factor;; expanded_uncertainty_95_loss_factor
            real part; m/(N s); real_part_m_per_n_s
            impulse response; 1/kg; impulse_response_per_kg
            wave number; rad/m; wave_number_rad_per_m
            magnitude of end A; m/s^2; magnitude_end_a_m_per_s2
            temperature; degC; temperature_degc
            standard error of the magnitude; %; standard_error_magnitude_percent
            95;; column_95
            ;; column_
        ";
        for line in names.trim().lines() {
            let mut parts = line.split(';').map(str::trim);
            let mut next = || parts.next().unwrap();
            let (words, unit) = (next(), next());
            assert_eq!(name_of(words, unit), next(), "{line}");
        }
    }

    #[test]
    fn prefixes_are_those_of_the_units() {
        for (prefixed, plain, factor) in PREFIXED {
            let (from, to) = (Unit::parse(prefixed).unwrap(), Unit::parse(plain).unwrap());
            assert_eq!(from.dimension(), to.dimension());
            let ratio = from.to_si(1.0) / to.to_si(1.0) / factor;
            // tolerance: a few rounding errors
            assert!((ratio - 1.0).abs() < 1e-14, "{prefixed}: {ratio}");
        }
    }
}
