//! Rows of the tables of a sheet: frequency or time, modulus, its error, and temperature.

use std::f64::consts::TAU;

use num_complex::Complex64;
use serde::Deserialize;

use super::FitSheet;
use super::errors::{self, ErrorsSheet};
use super::steps::StepsSheet;
use super::table_file::TableFile;
use super::units::{UnitsSheet, Wanted};
use crate::digits::{hertz, short};
use crate::input;
use crate::job::JobContext;
use crate::outcome::InputFile;
use crate::records::{self, Selector};
use crate::sheet::{Duration, Exact, Temperature, plausible};
use crate::{Outcome, RodlabError};
use cmod::estimate::ComplexCovariance;
use cmod::rheology::TransientTest;

/// Files of the same layout. Each is a table with one row for each temperature and frequency, or
/// temperature and time.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableSheet {
    /// Names or patterns (`sweep/T*.txt`), relative to the sheet, of one file with all
    /// temperatures, or of several files.
    pub files: Vec<String>,
    /// Column of the frequency, by name or by number from 1.
    pub frequency: Option<Selector>,
    /// Column of the angular frequency, stated instead of the frequency.
    pub angular_frequency: Option<Selector>,
    /// Column of the time since the beginning of the loading, for relaxation and creep.
    pub time: Option<Selector>,
    /// Duration of the linear ramp of the load before it was held, such as `"0.5 s"`; by default 0,
    /// a step. Rows up to the end of the ramp are left out.
    pub ramp: Option<Exact<Duration>>,
    /// Times used, such as `(from: "1 s", to: "1000 s")`; by default all after the ramp.
    pub times: Option<TimesSheet>,
    /// Columns of the modulus.
    pub modulus: ModulusColumns,
    /// Units that the file does not contain.
    #[serde(default)]
    pub units: UnitsSheet,
    /// Temperature of the rows.
    pub temperature: TemperatureSheet,
    /// Standard errors of the moduli, independent from row to row; by default the errors are
    /// computed from the scatter about the fit.
    pub errors: Option<ErrorsSheet>,
}

/// A range of times.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimesSheet {
    /// First time, such as `"1 s"`.
    pub from: Exact<Duration>,
    /// Last time, such as `"1000 s"`.
    pub to: Exact<Duration>,
}

/// Columns of a modulus.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ModulusColumns {
    /// Storage and loss modulus.
    Parts {
        /// Column of E'.
        storage: Selector,
        /// Column of E''.
        loss: Selector,
    },
    /// Storage modulus and loss factor tan δ.
    StorageAndLossFactor {
        /// Column of E'.
        storage: Selector,
        /// Column of tan δ.
        loss_factor: Selector,
    },
    /// Absolute value and phase.
    MagnitudeAndPhase {
        /// Column of |E|.
        magnitude: Selector,
        /// Column of δ.
        phase: Selector,
    },
    /// Relaxation: stress divided by the held strain, over time.
    Relaxation {
        /// Column of E(t).
        modulus: Selector,
    },
    /// Creep compliance: strain divided by the held stress, over time.
    Creep {
        /// Column of J(t).
        compliance: Selector,
    },
    /// Creep modulus: the held stress divided by the strain, over time.
    CreepModulus {
        /// Column of 1/J(t).
        modulus: Selector,
    },
}

/// Column of a modulus with its quantity and its field.
type ModulusColumn<'a> = (&'a Selector, Wanted, &'static str);

impl ModulusColumns {
    /// Returns the column of the real part, and the other column, if there is one.
    fn both(&self) -> (ModulusColumn<'_>, Option<ModulusColumn<'_>>) {
        let modulus = |column, field| (column, Wanted::Modulus, field);
        match self {
            Self::Parts { storage, loss } => {
                (modulus(storage, "storage"), Some(modulus(loss, "loss")))
            }
            Self::StorageAndLossFactor {
                storage,
                loss_factor,
            } => {
                let factor = (loss_factor, Wanted::Number, "loss_factor");
                (modulus(storage, "storage"), Some(factor))
            }
            Self::MagnitudeAndPhase { magnitude, phase } => {
                let phase = (phase, Wanted::Phase, "phase");
                (modulus(magnitude, "magnitude"), Some(phase))
            }
            Self::Relaxation { modulus: column } | Self::CreepModulus { modulus: column } => {
                (modulus(column, "modulus"), None)
            }
            Self::Creep { compliance } => ((compliance, Wanted::Compliance, "compliance"), None),
        }
    }

    /// Returns the values of both columns, obtained with `read`; zeros if there is no second
    /// column.
    pub(super) fn values(
        &self,
        read: impl Fn(ModulusColumn<'_>) -> Result<Vec<f64>, RodlabError>,
    ) -> Result<Vec<(f64, f64)>, RodlabError> {
        let (first, second) = self.both();
        let first = read(first)?;
        let second = second.map_or_else(|| Ok(vec![0.0; first.len()]), read)?;
        Ok(first.into_iter().zip(second).collect())
    }

    /// Kind of test for moduli over time; `None` for moduli over frequency.
    pub(super) fn test(&self) -> Option<TransientTest> {
        match self {
            Self::Parts { .. }
            | Self::StorageAndLossFactor { .. }
            | Self::MagnitudeAndPhase { .. } => None,
            Self::Relaxation { .. } => Some(TransientTest::Relaxation),
            Self::Creep { .. } | Self::CreepModulus { .. } => Some(TransientTest::Creep),
        }
    }
}

/// Temperature of the rows of a table.
#[derive(Debug, Clone, Deserialize)]
pub enum TemperatureSheet {
    /// A column of measured temperatures.
    Column(Selector),
    /// One temperature for all rows, such as `"23 degC"`.
    Stated(Exact<Temperature>),
}

/// One row of a table.
#[derive(Debug, Clone)]
pub(super) struct Row {
    /// Index of the file among the inputs, and path of the file with the line of the row.
    pub(super) file: usize,
    pub(super) place: String,
    /// Frequency, or 1/(2πt) for a row over time.
    pub(super) frequency_hz: f64,
    /// Test of a row over time, and the duration of its ramp \[s\].
    pub(super) over_time: Option<(TransientTest, f64)>,
    /// Complex modulus, or E(t) or 1/J(t) \[Pa\].
    pub(super) modulus: Complex64,
    pub(super) covariance: ComplexCovariance,
    pub(super) temperature: f64,
    /// Number of the column that groups the rows into steps, if the sheet names such a column; it
    /// is equal for all rows of a step.
    pub(super) key: Option<f64>,
}

impl Row {
    /// Time of a row over time \[s\].
    pub(super) fn time(&self) -> Option<f64> {
        self.over_time.map(|_| (TAU * self.frequency_hz).recip())
    }

    /// Frequency or time of the row.
    pub(super) fn abscissa(&self) -> String {
        let seconds = |time| format!("{} s", short(time));
        self.time()
            .map_or_else(|| hertz(self.frequency_hz), seconds)
    }
}

/// Returns all rows, and enters the files from which they were read in `outcome`.
pub(super) fn read(
    sheet: &FitSheet,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<Vec<Row>, RodlabError> {
    let mut all = Vec::new();
    for (index, table) in sheet.tables.iter().enumerate() {
        let field = format!("tables[{index}]");
        let mut beyond = Vec::new();
        for found in records::matched_by(&table.files, context.folder, &format!("{field}.files"))? {
            context.check_cancelled()?;
            let bytes = input::read(&found.path)?;
            let file = TableFile::of(&bytes, found.shown, &field)?;
            let rows = rows(sheet, table, &file, outcome.inputs.len())?;
            let growing = file.lines().len() - rows.len();
            if table.time.is_some() && growing > 0 {
                let reason = "before the load was held, or outside `times`";
                outcome.reject(file.path.as_str(), format!("{growing} row(s) {reason}"));
            }
            all.extend(rows);
            beyond.extend(file.beyond.map(|line| (file.path, line)));
            outcome.warnings.extend(file.warnings);
            outcome.log.extend(file.log);
            outcome.inputs.push(InputFile {
                pattern: Some(found.pattern),
                ..file.input
            });
        }
        if let Some((path, line)) = beyond.first() {
            outcome.warn(format!(
                "The rows of {} are followed by text that is not a row of numbers and was ignored: {line}.",
                if beyond.len() == 1 {
                    path.clone()
                } else {
                    format!("{} files, such as {path},", beyond.len())
                }
            ));
        }
    }
    if all.is_empty() {
        let has_times = sheet.tables.iter().any(|table| table.time.is_some());
        let found = sheet.band.as_ref().map_or_else(
            || {
                if has_times {
                    "without rows at the times after the load was held"
                } else {
                    "without rows"
                }
                .to_owned()
            },
            |band| format!("without rows from {} to {}", band.from, band.to),
        );
        return Err(RodlabError::request("tables", found, "rows of moduli"));
    }
    Ok(all)
}

fn rows(
    sheet: &FitSheet,
    table: &TableSheet,
    file: &TableFile,
    index: usize,
) -> Result<Vec<Row>, RodlabError> {
    let units = &table.units;
    let (field, frequencies) = abscissae(table, file)?;
    let ramp = table.ramp.as_ref().map_or(0.0, Exact::si);
    let over_time = table.modulus.test().map(|test| (test, ramp));
    let (of_modulus, modulus) = moduli(table, file)?;
    let covariance = errors::covariances(table, file, &modulus)?;
    let temperature = match &table.temperature {
        TemperatureSheet::Column(column) => {
            file.values(column, Wanted::Temperature, units, "temperature")?
        }
        TemperatureSheet::Stated(temperature) => vec![temperature.si(); frequencies.len()],
    };
    let keys = match &sheet.steps {
        Some(StepsSheet::Column(column)) => Some(file.keys(column, "steps")?),
        _ => None,
    };
    let mut rows = Vec::with_capacity(frequencies.len());
    let values = frequencies
        .iter()
        .zip(modulus)
        .zip(covariance)
        .zip(temperature);
    for (row, (((frequency_hz, modulus), covariance), temperature)) in values.enumerate() {
        let refused = |field: &str, found: String, expected: &str| {
            Err(RodlabError::request(
                file.place_of(field, row),
                found,
                expected,
            ))
        };
        if over_time.is_some() {
            // a time of 0 or below has no equivalent frequency
            let time = (TAU * frequency_hz).recip();
            let within = |times: &TimesSheet| times.from.si() <= time && time <= times.to.si();
            let is_held = time > ramp && time.is_finite();
            if !is_held || !table.times.as_ref().is_none_or(within) {
                continue;
            }
        } else if *frequency_hz <= 0.0 {
            return refused(field, format!("{frequency_hz} Hz"), "a frequency above 0");
        }
        if !(modulus.re > 0.0 && modulus.re.is_finite()) {
            let field = format!("modulus.{of_modulus}");
            let (found, expected) = match of_modulus {
                "compliance" => (
                    format!("a compliance of {} 1/Pa", short(modulus.re.recip())),
                    "a compliance above 0",
                ),
                "modulus" => (
                    format!("a modulus of {} Pa", short(modulus.re)),
                    "a modulus above 0",
                ),
                _ => (
                    format!("a storage modulus of {} Pa", short(modulus.re)),
                    "a storage modulus above 0",
                ),
            };
            return refused(&field, found, expected);
        }
        plausible::storage_modulus(modulus.re, sheet.unusual, || {
            file.place_of(&format!("modulus.{of_modulus}"), row)
        })?;
        if temperature <= 0.0 {
            return refused(
                "temperature",
                format!("{} K", short(temperature)),
                "a temperature above 0 K",
            );
        }
        let is_in_band = over_time.is_some()
            || sheet.band.as_ref().is_none_or(|band| {
                band.from.si() <= *frequency_hz && *frequency_hz <= band.to.si()
            });
        if !is_in_band {
            continue;
        }
        let line = file.lines().get(row).copied().unwrap_or(0);
        rows.push(Row {
            file: index,
            place: format!("{}, line {line}", file.path),
            frequency_hz: *frequency_hz,
            over_time,
            modulus,
            covariance,
            temperature,
            key: keys.as_ref().and_then(|keys| keys.get(row).copied()),
        });
    }
    Ok(rows)
}

/// Returns the frequency \[Hz\] of each row, or 1/(2πt) for a row over time, and the field of the
/// sheet that states the column.
fn abscissae(
    table: &TableSheet,
    file: &TableFile,
) -> Result<(&'static str, Vec<f64>), RodlabError> {
    let units = &table.units;
    let refused = |field: &str, found: &str, expected: &str| {
        Err(RodlabError::request(file.place(field), found, expected))
    };
    let is_over_time = table.modulus.test().is_some();
    let held = [
        table.time.is_some(),
        table.ramp.is_some(),
        table.times.is_some(),
    ];
    let held = ["time", "ramp", "times"].into_iter().zip(held);
    if !is_over_time && let Some((field, _)) = held.into_iter().find(|(_, stated)| *stated) {
        return refused(
            field,
            "stated for a modulus over frequency",
            "a modulus over time: `relaxation`, `creep` or `creep_modulus` (in RON `Relaxation`, `Creep` or `CreepModulus`)",
        );
    }
    match (&table.frequency, &table.angular_frequency, &table.time) {
        (Some(column), None, None) if !is_over_time => {
            let field = "frequency";
            Ok((field, file.values(column, Wanted::Frequency, units, field)?))
        }
        (None, Some(column), None) if !is_over_time => {
            let field = "angular_frequency";
            let omega = file.values(column, Wanted::AngularFrequency, units, field)?;
            Ok((field, omega.iter().map(|omega| omega / TAU).collect()))
        }
        (None, None, Some(column)) => {
            let field = "time";
            let times = file.values(column, Wanted::Time, units, field)?;
            Ok((
                field,
                times.iter().map(|time| (TAU * time).recip()).collect(),
            ))
        }
        (frequency, omega, _) if is_over_time => {
            let found = if frequency.is_some() || omega.is_some() {
                "a frequency, for a modulus over time"
            } else {
                "missing"
            };
            refused(
                "time",
                found,
                "the column of the time from the start of the load",
            )
        }
        (both, ..) => {
            let found = if both.is_some() {
                "stated together with `angular_frequency`"
            } else {
                "missing"
            };
            let expected = "the column of either the frequency or the angular frequency";
            refused("frequency", found, expected)
        }
    }
}

/// Returns the complex modulus of each row, or the modulus over time as a real number \[Pa\], and
/// the field of the sheet that states the first column.
fn moduli(
    table: &TableSheet,
    file: &TableFile,
) -> Result<(&'static str, Vec<Complex64>), RodlabError> {
    let columns = &table.modulus;
    let values = columns.values(|(column, wanted, field)| {
        file.values(column, wanted, &table.units, &format!("modulus.{field}"))
    })?;
    let of: fn((f64, f64)) -> Complex64 = match columns {
        ModulusColumns::Parts { .. }
        | ModulusColumns::Relaxation { .. }
        | ModulusColumns::CreepModulus { .. } => |(re, im)| Complex64::new(re, im),
        ModulusColumns::StorageAndLossFactor { .. } => |(re, tan)| Complex64::new(re, re * tan),
        ModulusColumns::MagnitudeAndPhase { .. } => |(r, delta)| Complex64::from_polar(r, delta),
        ModulusColumns::Creep { .. } => |(j, _)| Complex64::from(j.recip()),
    };
    let ((.., field), _) = columns.both();
    Ok((field, values.into_iter().map(of).collect()))
}
