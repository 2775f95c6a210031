//! Measured or computed mobility of an impact face (Ödeen 1993, paper E, section 3.1), with its
//! screening and impulse response.

mod figures;
mod known;
pub(super) mod screening;
mod source;
mod tables;
mod universal;

use serde::Deserialize;

use self::known::Known;
pub use self::source::SourceSheet;
use super::{About, JobContext};
use crate::bodies::material_sheet::Materials;
use crate::digits::{hertz, short};
use crate::median::upper_median;
use crate::outcome::{Quantity, Setting};
use crate::responses::{CompletionSheet, SupportSheet};
use crate::sheet::{AddedMass, Exact, Frequency, NotFollowed, SpecificImpedance, Stated};
use crate::{Outcome, RodlabError};

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MobilitySheet {
    /// Title of the test.
    pub title: String,
    /// Free texts for the report.
    #[serde(default)]
    pub about: About,
    /// Materials of a computed body, by name.
    #[serde(default)]
    pub materials: Materials,
    /// Source of the mobility.
    pub source: SourceSheet,
    /// Mass between the force gauge of an impedance head and the face, including the screw, such as
    /// `"12.5 gram ± 0.1 gram"`.
    pub head_mass: Option<Stated<AddedMass>>,
    /// Upper frequency of the lines used, such as `"10 kHz"`; by default all lines.
    pub up_to: Option<Exact<Frequency>>,
    /// Support of the body; by default the support that the line at 0 Hz indicates.
    #[serde(default)]
    pub support: SupportSheet,
    /// Replacement of low-frequency lines of a free body by its weighed mass; by default the lines
    /// stay as measured.
    pub complete: Option<CompletionSheet>,
    /// Characteristic impedance of the material at the face, such as `"3.2e3 kg/s"`; it determines
    /// the response before any echo returns.
    pub front_impedance: Option<NotFollowed<SpecificImpedance>>,
}

pub(crate) fn run(sheet: &MobilitySheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    let mut outcome = Outcome::of("mobility", sheet.title.as_str());
    let read = source::read(sheet, context, &mut outcome)?;
    outcome.settings.extend(defaults());
    context.has_read_all(&outcome.inputs, &outcome.warnings)?;

    context.progress.begins("mobility", 0);
    let Some(raw) = source::raw(&read, sheet, context, &mut outcome)? else {
        return Ok(outcome);
    };
    let known = known::prepare(raw, sheet, &mut outcome)?;
    context.check_cancelled()?;
    let screened = screening::screen(&known, sheet, &mut outcome)?;
    answer(&known, &mut outcome);
    outcome.tables.push(tables::mobility(&known));
    outcome.figures.push(figures::bode(&known, sheet));
    outcome.figures.push(figures::nyquist(&known));
    if let Some(response) = &screened.impulse_response {
        outcome.tables.push(response.table());
        outcome.figures.push(figures::impulse_response(response));
    }
    outcome
        .attachments
        .push(universal::attachment(&known, &sheet.title)?);
    Ok(outcome)
}

/// Returns the defaults of optional fields, except those of the source.
fn defaults() -> [Setting; 5] {
    [
        Setting::by_default("head_mass", "none"),
        Setting::by_default("up_to", "all lines"),
        Setting::by_default("support", SupportSheet::AsMeasured.in_words()),
        Setting::by_default("complete", "lines stay as measured"),
        Setting::by_default("front_impedance", "not stated"),
    ]
}

/// Reports the number of valid lines and their accuracy.
#[allow(
    clippy::indexing_slicing,
    reason = "the indices are those of lines of the mobility, which has a frequency and an error for each"
)]
fn answer(known: &Known, outcome: &mut Outcome) {
    let above_zero = || (1..known.mobility.values.len()).filter(|line| known.is_valid(*line));
    let n_valid = above_zero().count();
    let n_lines = known.mobility.values.len() - 1;
    let ends = above_zero().next().zip(above_zero().next_back());
    let Some((first, last)) = ends else {
        let reason = known.objections.iter().skip(1).flatten().next();
        outcome.refuse(format!(
            "none of the {n_lines} lines of the mobility is reliable: {}",
            reason.map_or("no line above 0 Hz", String::as_str)
        ));
        outcome.say("No line of the mobility is reliable.");
        return;
    };
    let frequency = &known.mobility.frequency_hz;
    let random = known.mobility.random_error().unwrap_or_default();
    let errors = above_zero().filter_map(|line| random.get(line));
    let median = upper_median(errors.map(|error| error.magnitude));
    let error = match median {
        Some(median) => format!(", with a median standard error of {:.2} %", 100.0 * median),
        None if known.is_computed => String::new(),
        None => ", with unknown errors".to_owned(),
    };
    outcome.say(format!(
        "The mobility is known on {n_valid} of {n_lines} lines from {} to {}{error}{}.",
        hertz(frequency[first]),
        hertz(frequency[last]),
        known.origin,
    ));
    let mut add = |name: &str, unit: &str, value: Option<f64>, verdict: &str| {
        outcome
            .quantities
            .push(Quantity::of(name, unit, value, verdict));
    };
    add("lines that are valid", "", Some(n_valid as f64), "counted");
    add(
        "median standard error of the magnitude",
        "%",
        median.map(|median| 100.0 * median),
        if median.is_some() {
            "random error of the lines, from the scatter of the hits"
        } else {
            "no scatter is known"
        },
    );
    if known.calibration > 0.0 {
        add(
            "standard uncertainty of the scale",
            "%",
            Some(100.0 * known.calibration),
            "due to the sensors, the same on all lines and not included in their errors",
        );
        outcome.summary.push(format!(
            "In addition, all lines share a standard uncertainty of {:.2} % due to the sensors.",
            100.0 * known.calibration
        ));
    }
    if known.delay > 0.0 {
        add(
            "standard uncertainty of the delay",
            "us",
            Some(1e6 * known.delay),
            "due to the channels, the same on all lines and not included in their errors",
        );
        outcome.summary.push(format!(
            "In addition, all lines share a standard uncertainty of {} us of the delay between the channels, {} deg at {:.4} kHz: state it as `delay_uncertainty` of the measured body.",
            short(1e6 * known.delay),
            short(360.0 * known.delay * frequency[last]),
            1e-3 * frequency[last],
        ));
    }
}
