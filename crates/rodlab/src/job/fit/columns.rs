//! Rows of the tables of a sheet: frequency, modulus, its error, and temperature.

use std::f64::consts::TAU;

use num_complex::Complex64;
use serde::Deserialize;

use super::FitSheet;
use super::errors::{self, ErrorsSheet};
use super::steps::StepsSheet;
use super::table_file::TableFile;
use super::units::{UnitsSheet, Wanted};
use crate::RodlabError;
use crate::digits::short;
use crate::input;
use crate::job::JobContext;
use crate::outcome::{InputFile, LogEntry};
use crate::records::{self, Selector};
use crate::sheet::{Exact, Temperature};
use cmod::estimate::ComplexCovariance;

/// Files of one layout, each a table with one row for each frequency and temperature.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableSheet {
    /// Names or patterns (`sweep/T*.txt`), relative to the sheet: one file with all temperatures,
    /// or several.
    pub files: Vec<String>,
    /// Column of the frequency, by name or by number from 1.
    #[serde(default)]
    pub frequency: Option<Selector>,
    /// Column of the angular frequency instead.
    #[serde(default)]
    pub angular_frequency: Option<Selector>,
    /// Columns of the modulus.
    pub modulus: ModulusColumns,
    /// Units that the file does not contain.
    #[serde(default)]
    pub units: UnitsSheet,
    /// Temperature of the rows.
    pub temperature: TemperatureSheet,
    /// Standard errors of the moduli, independent from row to row; without them the scatter about
    /// the fit gives the errors.
    #[serde(default)]
    pub errors: Option<ErrorsSheet>,
}

/// Columns of a complex modulus.
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
}

/// Temperature of the rows of a table.
#[derive(Debug, Clone, Deserialize)]
pub enum TemperatureSheet {
    /// A column of measured temperatures.
    Column(Selector),
    /// One temperature of all rows, such as `"23 degC"`.
    Stated(Exact<Temperature>),
}

/// A row.
#[derive(Debug, Clone)]
pub(super) struct Row {
    /// Index of the file among the inputs, and its path with the line.
    pub(super) file: usize,
    pub(super) place: String,
    pub(super) frequency_hz: f64,
    pub(super) modulus: Complex64,
    pub(super) covariance: ComplexCovariance,
    pub(super) temperature: f64,
    /// Number that is equal for all rows of a step, if the sheet names a column for it.
    pub(super) key: Option<f64>,
}

/// All rows and files.
pub(super) struct Read {
    pub(super) rows: Vec<Row>,
    pub(super) inputs: Vec<InputFile>,
    pub(super) warnings: Vec<String>,
    pub(super) log: Vec<LogEntry>,
}

pub(super) fn read(sheet: &FitSheet, context: &JobContext<'_>) -> Result<Read, RodlabError> {
    let mut read = Read {
        rows: Vec::new(),
        inputs: Vec::new(),
        warnings: Vec::new(),
        log: Vec::new(),
    };
    for (index, table) in sheet.tables.iter().enumerate() {
        let field = format!("tables[{index}]");
        let mut beyond = Vec::new();
        for found in records::matched_by(&table.files, context.folder, &format!("{field}.files"))? {
            context.check_cancelled()?;
            let bytes = input::read(&found.path)?;
            let file = TableFile::of(&bytes, found.shown, &field)?;
            let rows = rows(sheet, table, &file, read.inputs.len())?;
            read.rows.extend(rows);
            beyond.extend(file.beyond.map(|line| (file.path, line)));
            read.warnings.extend(file.warnings);
            read.log.extend(file.log);
            read.inputs.push(InputFile {
                pattern: Some(found.pattern),
                ..file.input
            });
        }
        if let Some((path, line)) = beyond.first() {
            read.warnings.push(format!(
                "Behind the rows of {} there is more that is no row of numbers, left out: {line}.",
                if beyond.len() == 1 {
                    path.clone()
                } else {
                    format!("{} files, such as {path},", beyond.len())
                }
            ));
        }
    }
    if read.rows.is_empty() {
        let found = sheet.band.as_ref().map_or_else(
            || "without rows".to_owned(),
            |band| format!("without rows from {} to {}", band.from, band.to),
        );
        return Err(RodlabError::request("tables", found, "rows of moduli"));
    }
    Ok(read)
}

fn rows(
    sheet: &FitSheet,
    table: &TableSheet,
    file: &TableFile,
    index: usize,
) -> Result<Vec<Row>, RodlabError> {
    let units = &table.units;
    let (field, frequencies) = match (&table.frequency, &table.angular_frequency) {
        (Some(column), None) => {
            let field = "frequency";
            (field, file.values(column, Wanted::Frequency, units, field)?)
        }
        (None, Some(column)) => {
            let field = "angular_frequency";
            let omega = file.values(column, Wanted::AngularFrequency, units, field)?;
            (field, omega.iter().map(|omega| omega / TAU).collect())
        }
        (both, _) => {
            let found = if both.is_some() {
                "beside `angular_frequency`"
            } else {
                "missing"
            };
            return Err(RodlabError::request(
                file.place("frequency"),
                found,
                "the column of either the frequency or the angular frequency",
            ));
        }
    };
    let modulus = moduli(table, file)?;
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
        if *frequency_hz <= 0.0 {
            return refused(field, format!("{frequency_hz} Hz"), "a frequency above 0");
        }
        if temperature <= 0.0 {
            return refused(
                "temperature",
                format!("{} K", short(temperature)),
                "a temperature above 0 K",
            );
        }
        let is_in_band = sheet
            .band
            .as_ref()
            .is_none_or(|band| band.from.si() <= *frequency_hz && *frequency_hz <= band.to.si());
        if !is_in_band {
            continue;
        }
        let line = file.lines().get(row).copied().unwrap_or(0);
        rows.push(Row {
            file: index,
            place: format!("{}, line {line}", file.path),
            frequency_hz: *frequency_hz,
            modulus,
            covariance,
            temperature,
            key: keys.as_ref().and_then(|keys| keys.get(row).copied()),
        });
    }
    Ok(rows)
}

/// Complex moduli \[Pa\], with storage moduli above 0.
fn moduli(table: &TableSheet, file: &TableFile) -> Result<Vec<Complex64>, RodlabError> {
    let units = &table.units;
    let read = |column: &Selector, wanted: Wanted, field: &str| {
        file.values(column, wanted, units, &format!("modulus.{field}"))
    };
    let (field, moduli): (&str, Vec<Complex64>) = match &table.modulus {
        ModulusColumns::Parts { storage, loss } => {
            let storage = read(storage, Wanted::Modulus, "storage")?;
            let loss = read(loss, Wanted::Modulus, "loss")?;
            let parts = storage.iter().zip(&loss);
            (
                "storage",
                parts.map(|(re, im)| Complex64::new(*re, *im)).collect(),
            )
        }
        ModulusColumns::StorageAndLossFactor {
            storage,
            loss_factor,
        } => {
            let storage = read(storage, Wanted::Modulus, "storage")?;
            let factor = read(loss_factor, Wanted::Number, "loss_factor")?;
            let parts = storage.iter().zip(&factor);
            (
                "storage",
                parts
                    .map(|(re, tan)| Complex64::new(*re, re * tan))
                    .collect(),
            )
        }
        ModulusColumns::MagnitudeAndPhase { magnitude, phase } => {
            let magnitude = read(magnitude, Wanted::Modulus, "magnitude")?;
            let phase = read(phase, Wanted::Phase, "phase")?;
            let parts = magnitude.iter().zip(&phase);
            (
                "magnitude",
                parts
                    .map(|(r, delta)| Complex64::from_polar(*r, *delta))
                    .collect(),
            )
        }
    };
    let wrong = moduli
        .iter()
        .position(|modulus| modulus.re.is_nan() || modulus.re <= 0.0);
    if let Some((row, modulus)) = wrong.and_then(|row| Some((row, moduli.get(row)?))) {
        return Err(RodlabError::request(
            file.place_of(&format!("modulus.{field}"), row),
            format!("a storage modulus of {} Pa", short(modulus.re)),
            "a storage modulus above 0",
        ));
    }
    Ok(moduli)
}
