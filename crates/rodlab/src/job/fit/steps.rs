//! Steps of a sweep. A step contains the rows of one temperature.

use std::collections::BTreeMap;

use cmod::rheology::ErrorScale;
use num_complex::Complex64;
use serde::Deserialize;

use super::FitSheet;
use super::columns::Row;
use crate::digits::{short, significant};
use crate::records::Selector;
use crate::sheet::{Exact, Language, Temperature};
use crate::{Outcome, RodlabError};

/// Default of the largest difference between neighbouring temperatures within a step \[K\].
const WITHIN: f64 = 1.0;
/// Largest temperature range of a step that is found by [`StepsSheet::Within`], as a multiple of
/// the difference stated there.
const MOST_SPREAD: f64 = 3.0;
/// Minimum number of frequencies of a step.
const FEWEST: usize = 3;
/// Relative difference up to which two frequencies are the same.
const SAME_FREQUENCY: f64 = 1e-9;

/// Excess of the chi-square of repeated rows, in standard deviations, from which their scatter
/// contradicts their stated errors.
const DIFFERENT: f64 = 3.5;

/// Rows that belong to one step of temperature.
#[derive(Debug, Clone, Deserialize)]
pub enum StepsSheet {
    /// Rows whose sorted temperatures follow each other within this difference, such as `"1 K"`.
    Within(Exact<Temperature>),
    /// Rows with equal numbers in this column, such as the set temperature or the number of the
    /// step.
    Column(Selector),
    /// Rows of one file.
    ByFile,
}

/// Rows of one temperature, in the order of their frequencies.
#[derive(Debug, Clone)]
pub(super) struct Step {
    /// Mean temperature of the rows \[K\].
    pub(super) temperature: f64,
    /// Lowest and highest temperature \[K\].
    pub(super) range: (f64, f64),
    pub(super) rows: Vec<Row>,
}

impl Step {
    fn of(mut rows: Vec<Row>) -> Self {
        let count = rows.len() as f64;
        let temperature = rows.iter().map(|row| row.temperature).sum::<f64>() / count;
        let fold = |start: f64, pick: fn(f64, f64) -> f64| {
            rows.iter().map(|row| row.temperature).fold(start, pick)
        };
        let range = (
            fold(f64::INFINITY, f64::min),
            fold(f64::NEG_INFINITY, f64::max),
        );
        rows.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        Self {
            // the mean of equal temperatures may differ from them by rounding
            temperature: if range.0 >= range.1 {
                range.0
            } else {
                temperature
            },
            range,
            rows,
        }
    }

    /// Returns the rows of each test. One group has all rows over frequency; rows over time are
    /// grouped by kind of test and ramp.
    pub(super) fn by_test(&self) -> Vec<Vec<Row>> {
        let mut parts: Vec<Vec<Row>> = Vec::new();
        for row in &self.rows {
            let is_own = |part: &&mut Vec<Row>| {
                part.first()
                    .is_some_and(|first| first.over_time == row.over_time)
            };
            match parts.iter_mut().find(is_own) {
                Some(part) => part.push(row.clone()),
                None => parts.push(vec![row.clone()]),
            }
        }
        parts
    }

    /// Temperature of the step in °C.
    pub(super) fn in_words(&self) -> String {
        celsius(self.temperature)
    }

    /// Largest absolute value of the moduli \[Pa\].
    pub(super) fn largest(&self) -> f64 {
        self.rows
            .iter()
            .map(|row| row.modulus.norm())
            .fold(0.0, f64::max)
    }
}

/// Returns a temperature \[K\] as text in °C.
pub(super) fn celsius(kelvin: f64) -> String {
    format!("{} \u{b0}C", short(to_celsius(kelvin)))
}

/// Returns a temperature \[K\] in °C, without the rounding error of the subtraction.
pub(super) fn to_celsius(kelvin: f64) -> f64 {
    ((kelvin - 273.15) * 1e9).round() / 1e9
}

/// Sorts `rows` into steps of increasing temperature.
pub(super) fn of(
    sheet: &FitSheet,
    rows: Vec<Row>,
    scale: ErrorScale,
    language: Language,
    outcome: &mut Outcome,
) -> Result<Vec<Step>, RodlabError> {
    let within = match &sheet.steps {
        Some(StepsSheet::Within(difference)) => {
            if !difference.to_string().trim_end().ends_with('K') {
                return Err(RodlabError::request(
                    format!("steps.{}", language.name_of("Within")),
                    format!("`{difference}`"),
                    "a difference of temperatures in K, such as \"1 K\"",
                ));
            }
            difference.si()
        }
        _ => WITHIN,
    };
    let groups = match &sheet.steps {
        Some(StepsSheet::ByFile) => keyed(rows, |row| row.file as u64),
        Some(StepsSheet::Column(_)) => keyed(rows, |row| order_of(row.key.unwrap_or(0.0))),
        Some(StepsSheet::Within(_)) | None => near(rows, within),
    };
    let mut steps: Vec<Step> = groups.into_iter().map(Step::of).collect();
    steps.sort_by(|a, b| a.temperature.total_cmp(&b.temperature));
    average(&mut steps, scale, outcome);
    let is_near = matches!(sheet.steps, None | Some(StepsSheet::Within(_)));
    let mut widest: Option<&Step> = None;
    for step in &steps {
        let spread = step.range.1 - step.range.0;
        if is_near && spread > MOST_SPREAD * within {
            return Err(RodlabError::request(
                "steps",
                format!(
                    "without a gap of more than {} K from {} to {}",
                    short(within),
                    celsius(step.range.0),
                    celsius(step.range.1)
                ),
                format!("steps of temperature: state {}", choices(language)),
            ));
        }
        if spread > within && widest.is_none_or(|other| spread > other.range.1 - other.range.0) {
            widest = Some(step);
        }
        check(step)?;
    }
    for pair in steps.windows(2) {
        if let [a, b] = pair
            && a.temperature >= b.temperature
        {
            return Err(RodlabError::request(
                "steps",
                format!(
                    "two steps at {}, from {} and {}",
                    a.in_words(),
                    a.rows.first().map_or("", |row| &row.place),
                    b.rows.first().map_or("", |row| &row.place)
                ),
                "one step for each temperature",
            ));
        }
    }
    if let Some(step) = widest {
        outcome.warn(format!(
            "The temperatures of a step differ by up to {} K, from {} to {} around {}: the mean of a step is used, and the errors \
             do not include the drift.",
            short(step.range.1 - step.range.0),
            celsius(step.range.0),
            celsius(step.range.1),
            step.in_words()
        ));
    }
    Ok(steps)
}

/// Describes the other choices for `steps`, in the language of the sheet.
fn choices(language: Language) -> &'static str {
    match language {
        Language::Ron => "`steps: Column(...)`, `steps: ByFile`, or a smaller `steps: Within(...)`",
        Language::Toml | Language::Json => {
            "`steps.column`, `steps` as \"by_file\", or a smaller `steps.within`"
        }
    }
}

/// Returns a key that is equal for equal numbers.
fn order_of(key: f64) -> u64 {
    // adding 0 turns -0 into 0
    (key + 0.0).to_bits()
}

fn keyed(rows: Vec<Row>, key: impl Fn(&Row) -> u64) -> Vec<Vec<Row>> {
    let mut groups: BTreeMap<u64, Vec<Row>> = BTreeMap::new();
    for row in rows {
        groups.entry(key(&row)).or_default().push(row);
    }
    groups.into_values().collect()
}

/// Returns groups of rows whose sorted temperatures follow each other within the difference
/// `within`.
fn near(mut rows: Vec<Row>, within: f64) -> Vec<Vec<Row>> {
    rows.sort_by(|a, b| a.temperature.total_cmp(&b.temperature));
    let mut groups: Vec<Vec<Row>> = Vec::new();
    let mut before = f64::NEG_INFINITY;
    for row in rows {
        let temperature = row.temperature;
        match groups.last_mut() {
            Some(group) if temperature - before <= within => group.push(row),
            _ => groups.push(vec![row]),
        }
        before = temperature;
    }
    groups
}

/// Averages the rows of a file that repeat a frequency at one temperature, and compares the scatter
/// of these rows with their stated errors. Rows that agree in every digit are one measurement that
/// is stored several times: only the first row is used.
fn average(steps: &mut [Step], scale: ErrorScale, outcome: &mut Outcome) {
    let (mut repeated, mut averaged, mut squares) = (0, 0, 0.0);
    let mut copies: Vec<(String, String)> = Vec::new();
    for step in steps {
        let is_same = |a: &Row, b: &Row| {
            a.over_time.is_none()
                && b.over_time.is_none()
                && a.file == b.file
                && (a.temperature - b.temperature).abs() <= WITHIN
                && b.frequency_hz <= a.frequency_hz * (1.0 + SAME_FREQUENCY)
        };
        let mut rows = Vec::with_capacity(step.rows.len());
        for same in step.rows.chunk_by(is_same) {
            let mut different: Vec<&Row> = Vec::with_capacity(same.len());
            for row in same {
                match different.iter().find(|other| is_copy(other, row)) {
                    Some(original) => copies.push((row.place.clone(), original.place.clone())),
                    None => different.push(row),
                }
            }
            let same = different;
            let Some((&first, others)) = same.split_first() else {
                continue;
            };
            let mut row = first.clone();
            if let Some(last) = others.last() {
                let count = same.len() as f64;
                row.modulus = same.iter().map(|row| row.modulus).sum::<Complex64>() / count;
                let sum = others.iter().map(|row| row.covariance);
                let sum = sum.fold(row.covariance, |a, b| a + b);
                row.covariance = sum.through(Complex64::from(1.0 / count));
                row.temperature = same.iter().map(|row| row.temperature).sum::<f64>() / count;
                row.place = format!("{} to {}", first.place, last.place);
                squares += same
                    .iter()
                    .map(|one| deviation(one, row.modulus))
                    .sum::<f64>();
                repeated += same.len();
                averaged += 1;
            }
            rows.push(row);
        }
        step.rows = rows;
    }
    if let Some((copy, original)) = copies.first() {
        outcome.warn(format!(
            "{} row(s) agree in every digit with another row of the same frequency and temperature, first {copy} with {original}: they are \
             left out, because storing a measurement twice does not reduce its error.",
            copies.len()
        ));
    }
    if averaged == 0 {
        return;
    }
    outcome.say(format!(
        "{repeated} rows that repeat a frequency at the same temperature were averaged to {averaged}."
    ));
    // each modulus has two parts
    let freedom = 2.0 * (repeated - averaged) as f64;
    // the mean of chi-square plus three and a half standard deviations
    let most = freedom + DIFFERENT * (2.0 * freedom).sqrt();
    if scale == ErrorScale::Stated && squares > most {
        outcome.doubt(format!(
            "rows that repeat a frequency differ by {} times their stated errors: they are not repeated measurements of the same state, or the errors are too small",
            significant((squares / freedom).sqrt(), 2)
        ));
    }
}

/// Returns true if two rows agree in every digit.
fn is_copy(a: &Row, b: &Row) -> bool {
    let bits = |row: &Row| [row.temperature, row.modulus.re, row.modulus.im].map(f64::to_bits);
    bits(a) == bits(b)
}

/// Returns the square of the deviation of a row from `mean`, weighted by the inverse of the
/// covariance of the row.
fn deviation(row: &Row, mean: Complex64) -> f64 {
    let away = row.modulus - mean;
    let c = row.covariance;
    let determinant = c.real * c.imaginary - c.mixed * c.mixed;
    let sum = away.re * away.re * c.imaginary + away.im * away.im * c.real;
    (sum - 2.0 * away.re * away.im * c.mixed) / determinant
}

/// Refuses a step in which two rows of a test have the same frequency or time, or which has fewer
/// than three rows.
fn check(step: &Step) -> Result<(), RodlabError> {
    for pair in step.rows.windows(2) {
        if let [a, b] = pair
            && a.over_time == b.over_time
            && b.frequency_hz <= a.frequency_hz * (1.0 + SAME_FREQUENCY)
        {
            return Err(RodlabError::request(
                format!("tables, at {}", step.in_words()),
                format!("two rows at {} ({} and {})", a.abscissa(), a.place, b.place),
                "each frequency or time once per step (one file may repeat a frequency): evaluate repeated tests in separate sheets",
            ));
        }
    }
    if step.rows.len() < FEWEST {
        return Err(RodlabError::request(
            format!("tables, at {}", step.in_words()),
            format!(
                "{} row(s), the first of {}",
                step.rows.len(),
                step.rows.first().map_or("", |row| &row.place)
            ),
            format!("at least {FEWEST} frequencies or times for each temperature"),
        ));
    }
    Ok(())
}

/// Reduces the number of rows to about `most`. Rows over frequency are kept at a constant interval
/// (every second, third, …), rows over time at even intervals of the logarithm of time. Each test
/// keeps at least three rows.
pub(super) fn thinned(steps: Vec<Step>, most: usize, outcome: &mut Outcome) -> Vec<Step> {
    let all: usize = steps.iter().map(|step| step.rows.len()).sum();
    let stride = all.div_ceil(most.max(1)).max(1);
    if stride == 1 {
        return steps;
    }
    let has_times = steps
        .iter()
        .any(|step| step.rows.iter().any(|row| row.over_time.is_some()));
    let thinned = |step: Step| {
        let mut rows: Vec<Row> = Vec::new();
        for of_test in step.by_test() {
            // at least three rows of each test, because fewer rows do not define a curve
            let most = of_test.len().div_ceil(stride).max(FEWEST);
            if of_test.iter().any(|row| row.over_time.is_some()) {
                rows.extend(evenly_in_logarithm(of_test, most));
            } else {
                let own = stride.min((of_test.len() - 1) / 2).max(1);
                rows.extend(of_test.into_iter().step_by(own));
            }
        }
        rows.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        Step { rows, ..step }
    };
    let steps: Vec<Step> = steps.into_iter().map(thinned).collect();
    let used: usize = steps.iter().map(|step| step.rows.len()).sum();
    let evenly = if has_times {
        "rows over time evenly spaced in the logarithm of time"
    } else {
        "evenly chosen at each temperature"
    };
    outcome.say(format!(
        "{used} of {all} rows were fitted, {evenly} (`laws.most_lines`)."
    ));
    steps
}

/// Returns the first row in each of `most` - 1 equal intervals of the logarithm of time, and the
/// last row.
fn evenly_in_logarithm(rows: Vec<Row>, most: usize) -> Vec<Row> {
    if rows.len() <= most {
        return rows;
    }
    let ends = rows.first().zip(rows.last());
    let Some((first, last)) = ends.map(|(first, last)| (first.frequency_hz, last.frequency_hz))
    else {
        return rows;
    };
    let intervals = (most.max(2) - 1) as f64;
    let mut before = f64::NEG_INFINITY;
    rows.into_iter()
        .filter(|row| {
            let share = (row.frequency_hz / first).ln() / (last / first).ln();
            let own = (share * intervals).floor();
            let is_new = own > before;
            before = before.max(own);
            is_new
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_named_as_in_the_sheet() {
        assert!(choices(Language::Ron).contains("`steps: ByFile`"));
        assert!(choices(Language::Toml).contains("`steps.column`"));
    }
}
