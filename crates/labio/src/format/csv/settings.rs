//! Settings that instruments write above or beside their samples: sampling interval, start, and the
//! names and units of channels.
//!
//! | maker | interval | start | unit of time | names | units |
//! |---|---|---|---|---|---|
//! | Tektronix, Siglent | `Sample Interval` | | `Horizontal Units` | `Source` | `Vertical Units` |
//! | GW Instek | `Sampling Period` | | `Horizontal Units` | `Source` | `Vertical Units` |
//! | Keysight Infiniium | `XInc` | `XOrg` | `XUnits` | | `YUnits` |
//! | Yokogawa | `HResolution` | `HOffset` | `HUnit` | `TraceName` | `VUnit` |
//! | Hioki | | | `HORZ_UNITS` | `SIGNAL` | `VERT_UNITS` |
//!
//! Rigol writes interval and start to the right of the names: the columns `Start` and `Increment`
//! of the first two rows, or `t0 = -1e-3, tInc = 1e-6` in the first row.

use std::borrow::Cow;

use super::abscissa_name::{INDEX_NAMES, called, is_time, names_abscissa};
use crate::format::text::{self, DecimalMark};
use crate::{Dimension, Unit};

/// Settings found in a header.
#[derive(Debug, Default)]
pub(super) struct Settings {
    /// Sampling interval, and its unit if one follows it.
    step: Option<(f64, Option<String>)>,
    start: Option<f64>,
    time_unit: Option<String>,
    names: Vec<String>,
    units: Vec<String>,
    /// True if the instrument writes names and units as settings, so that there is no row of names
    /// above the numbers.
    replace_names: bool,
    /// Positions of start and interval in the row below the names.
    below: Option<(usize, usize)>,
    /// True if the samples are integers of the converter, which do not have the stated units.
    are_counts: bool,
}

/// Times of the samples of a table without a column of times.
#[derive(Debug, Clone)]
pub(super) struct Clock {
    pub(super) start: f64,
    pub(super) step: f64,
    pub(super) unit: String,
}

impl Settings {
    /// Stores the settings in the cells of a header line. Returns true for a row of names that also
    /// has interval and start, and for the row below it: neither is a key with its values.
    pub(super) fn read(&mut self, cells: &[Cow<'_, str>]) -> bool {
        let cut: Vec<Cow<'_, str>>;
        let cells = match cells {
            // the numbers of a single column do not show which separator the header lines have
            [line] => {
                let parts = line.split([',', ';', '\t']);
                cut = parts.map(|part| Cow::Borrowed(bare(part))).collect();
                cut.as_slice()
            }
            cells => cells,
        };
        if self.read_behind_names(cells) {
            return true;
        }
        let Some((first, rest)) = cells.split_first() else {
            return false;
        };
        let (key, beside) = first.split_once(':').unwrap_or((first, ""));
        let values = || {
            let cells = std::iter::once(beside).chain(rest.iter().map(AsRef::as_ref));
            cells.flat_map(str::split_whitespace)
        };
        let texts = || values().map(of_channel).filter(|text| !text.is_empty());
        let number = || text::real(values().next()?, DecimalMark::Point).filter(|x| x.is_finite());
        match key {
            "Sample Interval" | "Sampling Period" | "XInc" | "HResolution"
                if self.step.is_none() =>
            {
                let step = number().filter(|step| *step > 0.0);
                let unit = values().nth(1).filter(|unit| of_time(unit).is_some());
                self.step = step.map(|step| (step, unit.map(str::to_owned)));
            }
            "XOrg" | "HOffset" => self.start = self.start.or_else(number),
            "Horizontal Units" | "XUnits" | "HUnit" | "HORZ_UNITS" => {
                self.replace_names |= key == "HUnit";
                let unit = values().next().map(seconds);
                self.time_unit = unit
                    .filter(|unit| of_time(unit).is_some())
                    .map(str::to_owned);
            }
            "Source" | "TraceName" | "SIGNAL" => self.names = texts().map(str::to_owned).collect(),
            "Vertical Units" | "YUnits" | "VUnit" | "VERT_UNITS" => {
                self.units = texts().map(str::to_owned).collect();
            }
            // GW Instek: 25 counts per division of the screen
            "Mode" => self.are_counts |= values().eq(["Fast"]),
            _ => {}
        }
        false
    }

    /// Takes interval and start as Rigol writes them; true if there are any in `cells`.
    fn read_behind_names(&mut self, cells: &[Cow<'_, str>]) -> bool {
        let number = |text: &str| text::real(text, DecimalMark::Point).filter(|x| x.is_finite());
        let texts = |n: usize| cells.iter().take(n).map(|cell| cell.clone().into_owned());
        if let Some((start_at, step_at)) = self.below.take() {
            let value = |at: usize| cells.get(at).and_then(|cell| number(cell));
            let (Some(start), Some(step)) = (value(start_at), value(step_at)) else {
                return false;
            };
            self.units = texts(start_at).collect();
            // `X` in the row above, `Sequence` in this one: the number of the sample
            if let (Some(name), Some(unit)) = (self.names.first_mut(), self.units.first_mut()) {
                *name = std::mem::take(unit);
            }
            self.take_clock(start, step);
            return true;
        }
        let at = |name: &str| cells.iter().position(|cell| cell == name);
        if let (Some(start_at), Some(step_at)) = (at("Start"), at("Increment")) {
            self.names = texts(start_at).collect();
            self.below = Some((start_at, step_at));
            return true;
        }
        let assigned = |name: &str| {
            let mut found = cells.iter().enumerate();
            found.find_map(|(at, cell)| {
                let value = cell.strip_prefix(name)?.trim_start().strip_prefix('=')?;
                Some((at, number(value)?))
            })
        };
        if let (Some((at, start)), Some((_, step))) = (assigned("t0"), assigned("tInc")) {
            self.names = texts(at).collect();
            self.take_clock(start, step);
            return true;
        }
        false
    }

    fn take_clock(&mut self, start: f64, step: f64) {
        self.start = Some(start);
        self.step = Some((step, None)).filter(|_| step > 0.0);
        self.time_unit = Some("s".to_owned());
        self.replace_names = true;
    }

    /// Returns the sampling interval in `unit`; if the interval or `unit` is not a unit of time,
    /// the number is returned as stated.
    pub(super) fn step_in(&self, unit: &str) -> Option<f64> {
        let (step, own) = self.step.as_ref()?;
        let units = own.as_deref().and_then(of_time).zip(of_time(unit));
        Some(match units {
            Some((own, unit)) if !own.is_same_as(&unit) => step * own.scale() / unit.scale(),
            _ => *step,
        })
    }

    fn time_unit(&self) -> Option<&str> {
        let of_step = || self.step.as_ref()?.1.as_deref();
        self.time_unit.as_deref().or_else(of_step)
    }

    /// Returns the times of the samples, if interval and unit are stated. A start that is not
    /// stated is 0.
    pub(super) fn clock(&self) -> Option<Clock> {
        let unit = self.time_unit()?;
        Some(Clock {
            start: self.start.unwrap_or(0.0),
            step: self.step_in(unit)?,
            unit: unit.to_owned(),
        })
    }

    pub(super) fn replace_names(&self) -> bool {
        self.replace_names
    }

    /// Returns names and units of the `n` columns of a table without a row of names: the channels,
    /// or times and channels; `None` if `n` fits neither, or if no unit of time is stated.
    pub(super) fn columns(&self, n: usize) -> Option<Vec<(String, String)>> {
        let time = self.time_unit()?.to_owned();
        let n_channels = self.names.len().max(self.units.len()).max(1);
        let mut columns = Vec::with_capacity(n);
        if n == n_channels + 1 {
            columns.push((String::new(), time));
        } else if n != n_channels {
            return None;
        }
        for at in 0..n_channels {
            let of = |list: &[String]| list.get(at).cloned().unwrap_or_default();
            let unit = if self.are_counts {
                String::new()
            } else {
                of(&self.units)
            };
            columns.push((of(&self.names), unit));
        }
        Some(columns)
    }

    /// Adds stated names and units to columns that have none.
    pub(super) fn complete(&self, columns: &mut [(String, String)]) {
        let is_single = columns.len() == 1;
        let mut channels = Vec::with_capacity(columns.len());
        for column in columns {
            let (name, unit) = &mut *column;
            if is_time(name, unit) {
                if let (true, Some(time)) = (unit.is_empty(), self.time_unit()) {
                    time.clone_into(unit);
                }
            } else if !names_abscissa(name) && !called(name, &INDEX_NAMES) {
                channels.push(column);
            }
        }
        let n = channels.len();
        let are_unnamed = is_single || channels.iter().all(|(name, _)| name.is_empty());
        let have_no_units = channels.iter().all(|(_, unit)| unit.is_empty());
        let names = (are_unnamed && self.names.len() == n).then_some(&self.names);
        let units =
            (have_no_units && self.units.len() == n && !self.are_counts).then_some(&self.units);
        for (at, (name, unit)) in channels.into_iter().enumerate() {
            if let Some(stated) = names.and_then(|names| names.get(at)) {
                name.clone_from(stated);
            }
            if let Some(stated) = units.and_then(|units| units.get(at)) {
                unit.clone_from(stated);
            }
        }
    }
}

/// Removes blanks and quotes around a cell.
fn bare(cell: &str) -> &str {
    cell.trim().trim_matches('"').trim()
}

/// Returns the text after the channel in `CH1:V`.
fn of_channel(text: &str) -> &str {
    text.rsplit_once(':').map_or(text, |(_, own)| own)
}

/// Returns the unit, if it is one of time.
fn of_time(unit: &str) -> Option<Unit> {
    text::known_unit(unit).filter(|unit| unit.dimension() == Dimension::TIME)
}

/// Returns `s` for the capital `S` that some oscilloscopes write, which is the symbol of the
/// siemens.
pub(super) fn seconds(unit: &str) -> &str {
    if unit == "S" { "s" } else { unit }
}
