//! Monte Carlo computation in addition to the linear errors of a result (JCGM 101).
//!
//! Each draw runs the job itself, with a sheet in which every quantity with ± is drawn within its
//! uncertainty, and with data to which random errors are added once more. The scatter of each
//! number over the draws is compared with its stated standard error, which is linear in the errors.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rayon::prelude::*;

use super::{Job, JobContext, Sheet, Silent};
use crate::digits::{short, significant};
use crate::draw::Draw;
use crate::outcome::{CHECK, Column, ERROR_OF, Quantity, Rows, Table};
use crate::sheet::{self, plausible};
use crate::{Outcome, RodlabError};

/// Smallest number of draws; the scatter of fewer draws is not meaningful.
const LEAST: usize = 20;
/// Largest number of draws.
const MOST: f64 = 1e6;
/// Seed of the draws.
const SEED: u64 = 1;
/// Number of draws that are computed in parallel before their results are summed in the order of
/// the draws.
const BATCH: usize = 64;
/// Relative difference of two standard errors up to which they count as equal.
const DIFFERENCE: f64 = 0.1;
/// Smallest scatter that is compared, in stated standard errors. If a number scatters less, its
/// error is not due to a drawn quantity, but for example to the time step of a march.
const MOVED: f64 = 0.01;
/// Number of standard errors of the scatter by which a difference must exceed [`DIFFERENCE`].
const CERTAIN: f64 = 3.0;

/// A number of a result that has a standard error.
#[derive(Debug, Clone, Copy)]
struct Number<'a> {
    place: Place,
    name: &'a str,
    unit: &'a str,
    value: f64,
    standard_error: f64,
    /// True if the number is valid; differences of invalid numbers are ignored.
    used: bool,
}

#[derive(Debug, Clone, Copy)]
enum Place {
    Quantity(usize),
    Cell {
        table: usize,
        column: usize,
        row: usize,
    },
}

/// Mean and scatter of a number over the draws that have it.
#[derive(Debug, Clone, Copy, Default)]
struct Scatter {
    draws: u32,
    mean: f64,
    squares: f64,
}

impl Scatter {
    fn add(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        self.draws += 1;
        let off = value - self.mean;
        self.mean += off / f64::from(self.draws);
        self.squares += off * (value - self.mean);
    }

    fn deviation(&self) -> f64 {
        (self.squares / f64::from(self.draws.saturating_sub(1))).sqrt()
    }

    /// Ratio of the scatter to the stated standard error, if both are known.
    fn ratio(&self, number: &Number<'_>) -> Option<f64> {
        let ratio = self.deviation() / number.standard_error;
        (self.draws as usize >= LEAST && ratio >= MOVED && ratio.is_finite()).then_some(ratio)
    }

    /// Returns true if the scatter differs from the stated standard error by more than chance
    /// explains.
    fn differs(&self, number: &Number<'_>) -> bool {
        let chance = CERTAIN / (2.0 * f64::from(self.draws)).sqrt();
        let differs = |ratio: f64| (ratio - 1.0).abs() > DIFFERENCE + chance;
        self.ratio(number).is_some_and(differs)
    }
}

/// Draws `sheet` and its data, and adds the comparison of the draws with the standard errors to
/// `outcome`.
pub(super) fn judge(
    outcome: &mut Outcome,
    sheet: &Sheet,
    context: &JobContext<'_>,
    n_draws: usize,
) -> Result<(), RodlabError> {
    plausible::at_most(n_draws as f64, MOST, "draws", "monte_carlo")?;
    if n_draws < LEAST {
        return Err(RodlabError::request(
            "monte_carlo",
            n_draws.to_string(),
            format!("at least {LEAST} draws: the scatter of fewer is not meaningful"),
        ));
    }
    context.progress.begins("Monte Carlo", n_draws);
    let base: &Outcome = outcome;
    let numbers = numbers(base);
    let mut scatters = vec![Scatter::default(); numbers.len()];
    let mut failed: Vec<RodlabError> = Vec::new();
    let draws: Vec<usize> = (0..n_draws).collect();
    for batch in draws.chunks(BATCH) {
        context.check_cancelled()?;
        let values: Vec<Result<Vec<f64>, RodlabError>> = batch
            .par_iter()
            .map(|draw| {
                let drawn = drawn(sheet, context, base, *draw)?;
                context.progress.one_more();
                Ok(numbers
                    .iter()
                    .map(|number| number.place.found(base, &drawn).unwrap_or(f64::NAN))
                    .collect())
            })
            .collect();
        for values in values {
            match values {
                Ok(values) => {
                    for (scatter, value) in scatters.iter_mut().zip(values) {
                        scatter.add(value);
                    }
                }
                Err(RodlabError::Interrupted) => return Err(RodlabError::Interrupted),
                Err(error) => failed.push(error),
            }
        }
    }
    if let Some(first) = failed.first()
        && 2 * failed.len() > n_draws
    {
        return Err(RodlabError::request(
            "monte_carlo",
            format!(
                "{} of {n_draws} draws without a result, the first because {first}",
                failed.len()
            ),
            "uncertainties within which the sheet and the data still give a result",
        ));
    }
    let judged = Judged {
        numbers,
        scatters,
        n_draws,
        failed: failed.len(),
    };
    let table = judged.quantities();
    let columns = judged.columns(base);
    let (summary, warnings) = judged.in_words();
    for (at, before, column) in columns {
        if let Some(table) = outcome.tables.get_mut(at) {
            table.columns.insert(before, column);
        }
    }
    outcome.tables.extend(table);
    outcome.say(summary);
    outcome.warnings.extend(warnings);
    Ok(())
}

/// Computes the outcome of one draw.
fn drawn(
    sheet: &Sheet,
    context: &JobContext<'_>,
    base: &Outcome,
    draw: usize,
) -> Result<Outcome, RodlabError> {
    let random = |stream: usize| {
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        random.set_stream(stream as u64);
        random
    };
    let job: Job = sheet::drawn_as(&sheet.path, &sheet.text, random(2 * draw))?;
    let context = JobContext {
        draw: Some(Draw::new(random(2 * draw + 1), base.drawn_laws.clone())),
        ..JobContext::of(sheet, &Silent, context.interrupted)
    };
    job.run(&context)
}

/// Returns all numbers with a standard error.
fn numbers(outcome: &Outcome) -> Vec<Number<'_>> {
    let mut numbers = Vec::new();
    for (index, quantity) in outcome.quantities.iter().enumerate() {
        if let (Some(value), Some(standard_error)) = (quantity.value, quantity.standard_error)
            && !quantity.name.starts_with(CHECK)
        {
            numbers.push(Number {
                place: Place::Quantity(index),
                name: &quantity.name,
                unit: &quantity.unit,
                value,
                standard_error,
                used: quantity.valid,
            });
        }
    }
    for (at, table) in outcome.tables.iter().enumerate() {
        let valid = table.valid();
        for of in uncertain(table) {
            for (row, (value, error)) in of.values.iter().zip(of.errors).enumerate() {
                if value.is_finite() && *error > 0.0 {
                    numbers.push(Number {
                        place: Place::Cell {
                            table: at,
                            column: of.column,
                            row,
                        },
                        name: of.name,
                        unit: &table.name,
                        value: *value,
                        standard_error: *error,
                        used: valid.is_none_or(|valid| valid.get(row).is_some_and(|valid| *valid)),
                    });
                }
            }
        }
    }
    numbers
}

/// Column of a table for which there is a column of standard errors.
struct Uncertain<'a> {
    name: &'a str,
    unit: &'a str,
    column: usize,
    values: &'a [f64],
    error_column: usize,
    errors: &'a [f64],
}

fn uncertain(table: &Table) -> impl Iterator<Item = Uncertain<'_>> {
    let all = table.columns.iter().enumerate();
    all.filter_map(move |(column, own)| {
        let mut others = table.columns.iter();
        let error_column = others.position(|other| other.is_error_of(own))?;
        Some(Uncertain {
            name: &own.name,
            unit: &own.unit,
            column,
            values: own.known_numbers()?,
            error_column,
            errors: table.columns.get(error_column)?.known_numbers()?,
        })
    })
}

impl Place {
    /// Returns the number in the outcome `drawn`, whose quantities and rows may differ from those
    /// of `base`; `None` if `drawn` does not contain the number.
    fn found(self, base: &Outcome, drawn: &Outcome) -> Option<f64> {
        match self {
            Self::Quantity(index) => {
                let name = &base.quantities.get(index)?.name;
                let same = |quantity: &&Quantity| quantity.name == *name;
                let guess = drawn.quantities.get(index).filter(same);
                guess.or_else(|| drawn.quantities.iter().find(same))?.value
            }
            Self::Cell { table, column, row } => {
                let known = base.tables.get(table)?;
                let guess = drawn.tables.get(table);
                let same = |table: &&Table| table.name == known.name;
                let other = guess
                    .filter(same)
                    .or_else(|| drawn.tables.iter().find(same))?;
                let at = cell(known, 0, row)?;
                // rows are found by their first column, because a line without a result in the draw
                // shifts the rows after it
                let row = (0..=row)
                    .rev()
                    .take_while(|row| cell(other, 0, *row).is_none_or(|other| other >= at))
                    .find(|row| cell(other, 0, *row).is_some_and(|other| other <= at))?;
                cell(other, column, row)
            }
        }
    }
}

fn cell(table: &Table, column: usize, row: usize) -> Option<f64> {
    let numbers = table.columns.get(column)?.known_numbers()?;
    numbers.get(row).copied()
}

/// Numbers of a result with their scatter over the draws.
struct Judged<'a> {
    numbers: Vec<Number<'a>>,
    scatters: Vec<Scatter>,
    n_draws: usize,
    failed: usize,
}

impl<'a> Judged<'a> {
    fn all(&self) -> impl Iterator<Item = (&Number<'a>, &Scatter)> {
        self.numbers.iter().zip(&self.scatters)
    }

    /// Returns the table of the single numbers.
    fn quantities(&self) -> Option<Table> {
        let rows: Vec<_> = self
            .all()
            .filter(|(number, scatter)| {
                matches!(number.place, Place::Quantity(_)) && scatter.draws > 0
            })
            .collect();
        if rows.is_empty() {
            return None;
        }
        let rows = Rows::of(&rows, "monte_carlo", "Standard errors by Monte Carlo")
            .word("quantity", |(number, _)| number.name)
            .word("unit", |(number, _)| number.unit)
            .number("value", "", |(number, _)| number.value)
            .number("standard error", "", |(number, _)| number.standard_error)
            .number("Monte Carlo standard error", "", |(_, scatter)| {
                scatter.deviation()
            })
            .number("Monte Carlo mean", "", |(_, scatter)| scatter.mean)
            .number("draws", "", |(_, scatter)| f64::from(scatter.draws))
            .validity(
                |(number, scatter)| !scatter.differs(number),
                |(number, scatter)| standing(number, scatter),
            );
        Some(rows.table)
    }

    /// Returns the new columns for the tables of `base`: the index of the table, the place in the
    /// table, and the column. The columns of a table are in descending order of their places, so
    /// that inserting one does not move the next.
    fn columns(&self, base: &Outcome) -> Vec<(usize, usize, Column)> {
        let mut columns = Vec::new();
        for (at, table) in base.tables.iter().enumerate() {
            for of in uncertain(table) {
                let mut cells = vec![f64::NAN; of.values.len()];
                for (number, scatter) in self.all() {
                    if let Place::Cell { table, column, row } = number.place
                        && (table, column) == (at, of.column)
                        && let Some(cell) = cells.get_mut(row)
                    {
                        *cell = scatter.deviation();
                    }
                }
                let name = format!("Monte Carlo {ERROR_OF}{}", of.name);
                let column = Column::numbers(name, of.unit, cells);
                columns.push((at, of.error_column + 1, column));
            }
        }
        columns.sort_by_key(|(table, place, _)| (*table, std::cmp::Reverse(*place)));
        columns
    }

    /// Returns the sentence for the summary, and the warnings.
    fn in_words(&self) -> (String, Vec<String>) {
        let used = || {
            self.all()
                .filter(|(number, scatter)| number.used && scatter.ratio(number).is_some())
        };
        let total = used().count();
        let different: Vec<_> = used()
            .filter(|(number, scatter)| scatter.differs(number))
            .collect();
        let mut warnings = Vec::new();
        if self.failed > 0 {
            warnings.push(format!(
                "{} of {} draws have no result and do not count.",
                self.failed, self.n_draws
            ));
        }
        let worst = different.iter().max_by(|a, b| {
            let off = |(number, scatter): &(&Number<'_>, &Scatter)| {
                scatter.ratio(number).unwrap_or(1.0).ln().abs()
            };
            off(a).total_cmp(&off(b))
        });
        if let Some((number, scatter)) = worst {
            warnings.push(format!(
                "The linear errors are not valid everywhere: {} of {total} differ from the scatter of the draws by more than {} %. The largest difference is that of {}: {}.",
                different.len(),
                short(100.0 * DIFFERENCE),
                number.in_words(),
                standing(number, scatter)
            ));
        }
        let agree = total - different.len();
        let told = if total == 0 {
            "no valid number has both a standard error and draws".to_owned()
        } else {
            format!(
                "the standard errors of {agree} of {total} valid numbers agree with the scatter within {} %",
                short(100.0 * DIFFERENCE)
            )
        };
        let summary = format!(
            "By Monte Carlo, {} draws of the noise and of every quantity stated with ±: {told}.",
            self.n_draws
        );
        (summary, warnings)
    }
}

impl Number<'_> {
    fn in_words(&self) -> String {
        match self.place {
            Place::Quantity(_) => self.name.to_owned(),
            Place::Cell { row, .. } => {
                format!(
                    "{} in row {} of the table `{}`",
                    self.name,
                    row + 1,
                    self.unit
                )
            }
        }
    }
}

fn standing(number: &Number<'_>, scatter: &Scatter) -> String {
    match scatter.ratio(number) {
        None if (scatter.draws as usize) < LEAST => {
            format!(
                "not compared: only {} draws have this number",
                scatter.draws
            )
        }
        None => "not compared: its error depends on nothing that is drawn".to_owned(),
        Some(ratio) => format!(
            "the draws scatter by {} standard errors",
            significant(ratio, 3)
        ),
    }
}
