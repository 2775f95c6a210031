//! Laws, master curve, shift laws and material cards from tables of a complex modulus, such as DMA
//! results, and from tables of relaxation or creep over time.
//!
//! The rows of all tables are sorted into steps of one temperature each. If there is one step, laws
//! of the modulus are fitted to its rows. Several steps are shifted to one master curve by
//! `cmod::rheology::MasterCurve`; the laws of Williams, Landel and Ferry and of Arrhenius are
//! fitted to the shifts, and laws of the modulus to the rows at reduced frequencies, including the
//! errors of the shifts.

mod columns;
mod errors;
mod figures;
mod master;
mod nomogram;
mod outcome;
mod result_table;
mod shifted;
mod steps;
mod table_file;
mod tables;
mod units;

pub use columns::{ModulusColumns, TableSheet, TemperatureSheet, TimesSheet};
pub use errors::ErrorsSheet;
pub use master::{StatedShift, StatedShiftsSheet, VerticalSheet};
pub use steps::StepsSheet;
pub use units::UnitsSheet;

use cmod::causal::CausalEstimate;
use cmod::rheology::{ErrorScale, MasterCurve, ModulusData, PolarScatter, ShiftLaws};
use num_complex::Complex64;
use rodfigure::Axis;
use serde::Deserialize;

use super::About;
use super::JobContext;
use crate::draw::NEEDS_ERRORS;
use crate::laws::causal::{self, Shown};
use crate::laws::{self, Drawn, LawsSheet, Lines, MOST_LINES, WHITE};
use crate::outcome::Setting;
use crate::records::expect_different_files;
use crate::sheet::{BandSheet, Density, Exact, Ratio, Stated, Temperature, plausible};
use crate::{InStep, Outcome, RodlabError};
use shifted::{Curve, Shifted};
use steps::Step;

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitSheet {
    /// Title of the test.
    pub title: String,
    /// Persons, place, date and object of the test.
    #[serde(default)]
    pub about: About,
    /// Tables of moduli.
    pub tables: Vec<TableSheet>,
    /// Loading, which determines the name of the modulus; by default `Tension`.
    pub kind: Option<LoadingSheet>,
    /// Grouping of the rows into steps of one temperature; by default `Within("1 K")`.
    pub steps: Option<StepsSheet>,
    /// Reference temperature of the master curve, such as `"20 degC"`; the nearest step is used. It
    /// must be stated if there are several temperatures.
    pub reference_temperature: Option<Exact<Temperature>>,
    /// Shifts that connect temperatures whose curves do not overlap; none by default.
    pub stated_shifts: Option<StatedShiftsSheet>,
    /// Factors of the modulus at each temperature; by default estimated if the data require them.
    pub vertical_shifts: Option<VerticalSheet>,
    /// Measured frequencies used, such as `(from: "0.1 Hz", to: "50 Hz")`; by default all.
    pub band: Option<BandSheet>,
    /// Standard uncertainty of the scale of all moduli, such as `"2 %"`, due to the force, the
    /// displacement and the dimensions of the specimen. None by default.
    pub scale_uncertainty: Option<Exact<Ratio>>,
    /// Standard uncertainty of the temperature of each step, such as `"0.5 K"`, independent between
    /// steps. It enters the errors of the shifts and, through the reference step, the errors of the
    /// master curve. None by default.
    pub temperature_uncertainty: Option<Exact<Temperature>>,
    /// Density of the material, such as `"1150 kg/m3 ± 2 kg/m3"`; needed for cards and for use as a
    /// material in later sheets.
    pub density: Option<Stated<Density>>,
    /// Laws fitted to the modulus or to the master curve, and cards; none by default.
    pub laws: Option<LawsSheet>,
    /// Computes the causal estimate, that is the relaxing material nearest to all rows together,
    /// with its errors, and checks whether the rows agree with it; off by default.
    #[serde(default)]
    pub causal: bool,
    /// Accepts moduli above 1500 GPa, which are otherwise refused because their unit is probably
    /// wrong.
    #[serde(default)]
    pub unusual: bool,
    /// Number of Monte Carlo draws, such as 1000, of the rows and of every quantity stated with ±;
    /// they check the linear errors.
    pub monte_carlo: Option<usize>,
}

/// Loading of the specimen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
pub enum LoadingSheet {
    /// Tension or compression of a bar; gives Young's modulus.
    #[default]
    Tension,
    /// Bending of a beam; gives Young's modulus.
    Bending,
    /// Shear or torsion; gives the shear modulus.
    Shear,
    /// Change of volume; gives the bulk modulus.
    Bulk,
}

impl LoadingSheet {
    fn symbol(self) -> &'static str {
        match self {
            Self::Tension | Self::Bending => "E",
            Self::Shear => "G",
            Self::Bulk => "K",
        }
    }

    fn modulus(self) -> &'static str {
        match self {
            Self::Tension => "Young's modulus, from tension",
            Self::Bending => "Young's modulus, from bending",
            Self::Shear => "shear modulus",
            Self::Bulk => "bulk modulus",
        }
    }
}

/// Results from which tables, figures and sentences are made.
struct Found<'a> {
    sheet: &'a FitSheet,
    steps: &'a [Step],
    error_scale: ErrorScale,
    /// Unit of moduli in tables and figures, with its value in Pa.
    pascal: (&'static str, f64),
    sweep: Option<Sweep>,
}

/// Largest accepted standard uncertainty of a temperature \[K\]; a larger number is probably the
/// temperature itself.
const MOST_UNCERTAIN: f64 = 20.0;

/// Master curve of several temperatures.
struct Sweep {
    curve: MasterCurve,
    shift_laws: Result<ShiftLaws, cmod::CmodError>,
    /// Shift laws with errors from the scatter of the shifts, if the WLF law does not fit the
    /// shifts within the errors of the shifts.
    by_scatter: Option<ShiftLaws>,
    /// Moduli over reduced frequency.
    reduced: ModulusData,
}

impl Found<'_> {
    fn symbol(&self) -> &'static str {
        self.sheet.kind.unwrap_or_default().symbol()
    }

    /// Returns true if moduli over frequency are among the rows.
    fn has_frequencies(&self) -> bool {
        let mut rows = self.steps.iter().flat_map(|step| &step.rows);
        rows.any(|row| row.over_time.is_none())
    }

    /// Returns true if moduli over time are among the rows.
    fn has_times(&self) -> bool {
        let mut rows = self.steps.iter().flat_map(|step| &step.rows);
        rows.any(|row| row.over_time.is_some())
    }

    fn reference(&self) -> Option<f64> {
        Some(self.sweep.as_ref()?.curve.reference_temperature)
    }
}

pub(crate) fn run(sheet: &FitSheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    let mut outcome = Outcome::of("fit", sheet.title.as_str());
    check(sheet)?;
    outcome.settings = sheet.defaults();
    context.progress.begins("reading", 0);
    let rows = columns::read(sheet, context, &mut outcome)?;
    expect_different_files(&outcome.inputs)?;
    let error_scale = errors::scale(sheet);
    let all = steps::of(sheet, rows, error_scale, context.language, &mut outcome)?;
    errors::judge_losses(&mut outcome, &all);
    errors::judge_rises(&mut outcome, &all)?;
    if all.len() > 1 && sheet.reference_temperature.is_none() {
        return Err(RodlabError::request(
            "reference_temperature",
            "missing",
            format!(
                "the reference of the master curve of {} temperatures from {} to {}",
                all.len(),
                all.first().map_or_else(String::new, Step::in_words),
                all.last().map_or_else(String::new, Step::in_words),
            ),
        ));
    }
    context.has_read_all(&outcome.inputs, &outcome.warnings)?;

    let most = sheet.laws.as_ref().and_then(|laws| laws.most_lines);
    let mut steps = steps::thinned(all, most.unwrap_or(MOST_LINES), &mut outcome);
    if let Some(draw) = &context.draw {
        errors::draw(sheet, &mut steps, draw);
    }
    context
        .progress
        .begins("shifting the temperatures", steps.len());
    let fit = |weights| Shifted::of(sheet, &steps, error_scale, weights);
    let shifted = if error_scale == ErrorScale::Stated {
        fit(PolarScatter::equal(errors::ASSUMED))?
    } else {
        PolarScatter::fitted(errors::ASSUMED, fit, Shifted::scatter)?
    };
    let largest = steps.iter().map(Step::largest).fold(0.0, f64::max);
    let mut found = Found {
        sheet,
        steps: &steps,
        error_scale,
        pascal: if largest >= 0.1e9 {
            ("GPa", 1e9)
        } else {
            ("MPa", 1e6)
        },
        sweep: None,
    };
    outcome::errors_in_words(&mut outcome, &shifted);
    let single = match shifted.curve {
        Curve::Single(data) => Some(data),
        Curve::Several(Ok(sweep)) => {
            found.sweep = Some(*sweep);
            None
        }
        Curve::Several(Err(error)) => {
            let reason = format!("there is no master curve: {error}");
            outcome.lead(format!("No master curve can be fitted: {error}."));
            outcome.refuse(reason);
            outcome.tables.push(tables::data(&found));
            outcome.figures.extend(figures::measured(&found));
            return Ok(outcome);
        }
    };
    context.check_cancelled()?;
    outcome::state(&mut outcome, &found)?;
    outcome.tables.push(tables::data(&found));
    outcome.tables.extend(tables::of_sweep(&found)?);
    outcome.figures.extend(figures::figures(&found)?);
    context.check_cancelled()?;
    let reduced = found.sweep.as_ref().map(|sweep| &sweep.reduced);
    let data = reduced.or(single.as_ref());
    if let Some(data) = data.filter(|_| sheet.causal) {
        context.progress.begins("finding the causal modulus", 0);
        let estimate = CausalEstimate::new(data);
        let estimate = estimate.in_step("tables");
        causal::state(&mut outcome, &shown(&found, data), estimate)?;
        context.check_cancelled()?;
    }
    let mut comparison = None;
    if let Some(asked) = &sheet.laws
        && let Some(data) = data
    {
        context.progress.begins("fitting laws", asked.laws.len());
        let lines = lines(&found, data);
        comparison = laws::fit(&mut outcome, &lines, asked, context)?;
        outcome::of_laws(&mut outcome, &found, comparison.as_ref());
    }
    if let Some(sweep) = &found.sweep {
        outcome::of_factors(&mut outcome, &sweep.curve, comparison.as_ref());
    }
    Ok(outcome)
}

impl FitSheet {
    /// Returns the defaults of optional fields.
    fn defaults(&self) -> Vec<Setting> {
        let errors = |at: usize| {
            Setting::by_default(
                format!("tables[{at}].errors"),
                "not stated: from the scatter of |E| and of the phase about the fit, the same fraction of |E| in all rows",
            )
        };
        let mut defaults: Vec<Setting> = (0..self.tables.len()).map(errors).collect();
        for (name, value) in [
            ("kind", LoadingSheet::Tension.modulus()),
            ("steps", "consecutive temperatures within 1 K of each other"),
            (
                "stated_shifts",
                "none: temperatures are connected by their overlap alone",
            ),
            (
                "vertical_shifts",
                "1 or, if the curves prefer it, T/T_r of rubber elasticity; estimated if they contradict both",
            ),
            ("band", "all frequencies"),
            ("scale_uncertainty", "not stated"),
            ("temperature_uncertainty", "not stated"),
        ] {
            defaults.push(Setting::by_default(name, value));
        }
        defaults.extend(self.laws.iter().flat_map(LawsSheet::defaults));
        defaults
    }
}

/// Refuses settings that are wrong whatever the data are.
fn check(sheet: &FitSheet) -> Result<(), RodlabError> {
    RodlabError::refuse_empty(&sheet.tables, "tables", "at least one table")?;
    let stated = sheet
        .tables
        .iter()
        .filter(|table| table.errors.is_some())
        .count();
    if stated > 0 && stated < sheet.tables.len() {
        return Err(RodlabError::request(
            "tables.errors",
            format!("stated for {stated} of {} tables", sheet.tables.len()),
            "errors for all tables or for none: the fit weights all lines by them",
        ));
    }
    let over_time = || sheet.tables.iter().map(|table| table.modulus.test());
    if sheet.band.is_some() && over_time().all(|test| test.is_some()) {
        return Err(RodlabError::request(
            "band",
            "stated, with moduli over time only",
            "`times` of the tables",
        ));
    }
    if sheet.causal && over_time().any(|test| test.is_some()) {
        return Err(RodlabError::request(
            "causal",
            "requested, with moduli over time",
            "moduli over frequency only",
        ));
    }
    if sheet.monte_carlo.is_some() && stated == 0 {
        return Err(RodlabError::request(
            "monte_carlo",
            "requested, with errors from the scatter about the fit",
            NEEDS_ERRORS,
        ));
    }
    if let Some(stated) = &sheet.temperature_uncertainty {
        if !(stated.si() > 0.0 && stated.si() <= MOST_UNCERTAIN) {
            return Err(RodlabError::request(
                "temperature_uncertainty",
                stated.to_string(),
                "a difference of temperature above 0 and up to 20 K, such as \"0.5 K\"",
            ));
        }
        if sheet.monte_carlo.is_some() {
            return Err(RodlabError::request(
                "monte_carlo",
                "requested together with `temperature_uncertainty`",
                "only one of the two: errors of the temperatures are not drawn",
            ));
        }
    }
    let Some(laws) = &sheet.laws else {
        return Ok(());
    };
    laws.check()?;
    laws.kinds(sheet.density.as_ref().map(Stated::nominal))?;
    if let Some(density) = &sheet.density {
        plausible::density(density, "density")?;
    }
    if laws.cards.is_some() {
        if sheet.density.is_none() {
            return Err(RodlabError::request(
                "density",
                "missing",
                "the density of the material, which a card contains",
            ));
        }
        let kind = sheet.kind.unwrap_or_default();
        if matches!(kind, LoadingSheet::Shear | LoadingSheet::Bulk) {
            return Err(RodlabError::request(
                "laws.cards",
                format!("requested, for the {}", kind.modulus()),
                "a `kind` of `tension` or `bending` (in RON `Tension` or `Bending`): cards are built from Young's modulus and Poisson's ratio",
            ));
        }
    }
    Ok(())
}

/// Returns the rows in the form used by the report of the causal estimate.
fn shown<'a>(found: &Found<'a>, data: &ModulusData) -> Shown<'a> {
    let Lines {
        points,
        drawn,
        error_scale,
        ..
    } = lines(found, data);
    Shown {
        symbol: found.symbol(),
        frequency: if found.reference().is_some() {
            "reduced frequency"
        } else {
            "frequency"
        },
        points,
        drawn,
        pascal: found.pascal,
        level: (error_scale == ErrorScale::Stated).then_some(WHITE),
    }
}

/// Returns the rows to which laws are fitted: over frequency for a single temperature, over reduced
/// frequency for several temperatures.
fn lines<'a>(found: &Found<'_>, data: &'a ModulusData) -> Lines<'a> {
    let points: Vec<(f64, Complex64)> = data
        .omega()
        .iter()
        .map(|omega| omega / std::f64::consts::TAU)
        .zip(data.modulus().iter().copied())
        .collect();
    let symbol = found.symbol();
    let (unit, pascal) = found.pascal;
    let (frequency, temperature) = match (found.reference(), found.steps.first()) {
        (Some(reference), _) => (
            "reduced frequency",
            Some(format!(
                "master curve of {} temperatures at {}",
                found
                    .sweep
                    .as_ref()
                    .map_or(0, |sweep| sweep.curve.shifts.len()),
                steps::celsius(reference)
            )),
        ),
        (None, Some(step)) => ("frequency", Some(step.in_words())),
        (None, None) => ("frequency", None),
    };
    Lines {
        data,
        error_scale: found.error_scale,
        // with several temperatures, the fit of the master curve is tested instead
        chance: found.sweep.is_none().then_some(master::CHANCE),
        series_profiles: found.sweep.is_none(),
        density: found.sheet.density.as_ref().map(Stated::with_uncertainty),
        is_youngs: matches!(
            found.sheet.kind.unwrap_or_default(),
            LoadingSheet::Tension | LoadingSheet::Bending
        ),
        temperature,
        drawn: Drawn {
            frequency: (Axis::logarithmic(frequency, "Hz"), 1.0),
            storage: (
                Axis::logarithmic(format!("{symbol}'"), unit),
                pascal.recip(),
            ),
            caption: format!("The {} lines that were fitted are drawn.", points.len()),
        },
        points,
    }
}
