//! The paper's own way: the stick force on lines (Ödeen 1993, paper E, eq. 2), and how sure it is.

use impulse::{
    ContactEnd, EndError, EndVerdict, ForceBand, ForceError, ImpactForce, MonteCarlo, StickForce,
    StickProblem, StickUncertainty, ZeroLine, separate,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;

use super::bodies::FaceBody;
use super::impact::{ContactSheet, ImpactSheet};
use crate::outcome::{Column, Quantity, Setting, Table};
use crate::sheet::{Frequency, Ratio, Exact};
use crate::{Outcome, RodlabError};

/// Part of the peak below which the force counts as ringing of the band limit, not as separation.
const THRESHOLD: f64 = 0.01;

const DRAWS: usize = 400;
/// Of the band that holds the whole history: a quantile of the largest deviation.
const DRAWS_OF_BAND: usize = 1000;
const SEED: u64 = 1;
const LEVEL: f64 = 0.95;

/// A band of lines.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Highest frequency, as `"10 kHz"`.
    pub up_to: Exact<Frequency>,
    /// Samples of the force over the period, as 2048. Not stated where a body was measured, whose lines they are then.
    #[serde(default)]
    pub samples: Option<usize>,
    /// Where a raised cosine begins that takes the spectrum to zero at the highest frequency; by default none does.
    #[serde(default)]
    pub roll_off_from: Option<Exact<Frequency>>,
}

/// How the errors of velocity and mobilities are followed to the force.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct UncertaintySheet {
    /// Number of draws; by default 400.
    pub draws: Option<usize>,
    /// Seed of the draws; by default 1.
    pub seed: Option<u64>,
    /// Level of the bands; by default 95 %.
    pub level: Option<Exact<Ratio>>,
}

/// The stick force with what it is worth.
pub(super) struct OnLines {
    pub(super) stick: StickForce,
    pub(super) bands: Option<Bands>,
}

/// Errors of a stick force and of the impact force.
pub(super) struct Bands {
    pub(super) level: f64,
    pub(super) error: ForceError,
    pub(super) pointwise: ForceBand,
    pub(super) simultaneous: ForceBand,
    /// Until the faces part.
    pub(super) impact: ImpactForce,
    pub(super) end: Option<EndError>,
    pub(super) draws: MonteCarlo,
    /// Of the impact force, by draws.
    pub(super) contact: ForceBand,
}

/// The stick force if the sheet wants it, or a body was measured.
pub(super) fn on_lines(
    sheet: &ImpactSheet,
    bodies: [&FaceBody; 2],
    outcome: &mut Outcome,
) -> Result<Option<OnLines>, RodlabError> {
    let Some((step_hz, n_lines)) = grid(sheet, bodies)? else {
        return Ok(None);
    };
    let refused = |error| RodlabError::step("problem.lines", error);
    let first = bodies[0].lines(step_hz, n_lines, "problem.first")?;
    let second = bodies[1].lines(step_hz, n_lines, "problem.second")?;
    let masses = bodies.map(FaceBody::mass);
    let inverse: f64 = masses.iter().flatten().map(|(mass, _)| 1.0 / mass).sum();
    let effective = 1.0 / inverse;
    let problem = StickProblem {
        first: &first,
        second: &second,
        frequency_step_hz: step_hz,
        impact_velocity: sheet.velocity.with_uncertainty().value,
        zero_line: if inverse > 0.0 {
            ZeroLine::EffectiveMass(effective)
        } else {
            ZeroLine::SquareWave
        },
        roll_off_from_hz: sheet
            .lines
            .as_ref()
            .and_then(|lines| lines.roll_off_from.as_ref())
            .map(Exact::si),
    };
    let stick = problem.solve().map_err(refused)?;
    if let impulse::Settlement::Unsettled { relative_level } = stick.settlement {
        outcome.warnings.push(format!(
            "The stick force on lines has not died out within its period: {relative_level:.2e} of the peak is left, and has come round."
        ));
    }
    let uncertainty = StickUncertainty {
        first_variance: bodies[0].variance(n_lines),
        second_variance: bodies[1].variance(n_lines),
        first_scale: bodies[0].scale(),
        second_scale: bodies[1].scale(),
        impact_velocity: sheet.velocity.with_uncertainty().uncertainty(),
        // dM = M^2 ((dM1/M1^2)^2 + (dM2/M2^2)^2)^(1/2)
        effective_mass: if inverse > 0.0 {
            let parts = masses.iter().flatten();
            let square: f64 = parts
                .map(|(mass, error)| (error / mass.powi(2)).powi(2))
                .sum();
            effective.powi(2) * square.sqrt()
        } else {
            0.0
        },
    };
    let anything = uncertainty.first_variance.is_some()
        || uncertainty.second_variance.is_some()
        || [
            uncertainty.first_scale,
            uncertainty.second_scale,
            uncertainty.impact_velocity,
            uncertainty.effective_mass,
        ]
        .iter()
        .any(|error| *error > 0.0);
    let bands = if anything && matches!(sheet.contact, ContactSheet::Rigid) {
        Some(bands(sheet, &problem, &uncertainty, &stick, outcome)?)
    } else {
        None
    };
    Ok(Some(OnLines { stick, bands }))
}

/// Distance and number of the lines.
fn grid(sheet: &ImpactSheet, bodies: [&FaceBody; 2]) -> Result<Option<(f64, usize)>, RodlabError> {
    let mut measured = bodies.iter().filter_map(|body| body.measured());
    let field = "problem.lines.samples";
    let Some(first) = measured.next() else {
        let Some(lines) = &sheet.lines else {
            return Ok(None);
        };
        let samples = match lines.samples {
            Some(samples) if samples >= 4 && samples.is_multiple_of(2) => samples,
            other => {
                return Err(RodlabError::request(
                    field,
                    other.map_or("not stated".to_owned(), |n| n.to_string()),
                    "an even number from 4 on, as 2048",
                ));
            }
        };
        let n_lines = samples / 2 + 1;
        return Ok(Some((lines.up_to.si() / (n_lines - 1) as f64, n_lines)));
    };
    if let Some(samples) = sheet.lines.as_ref().and_then(|lines| lines.samples) {
        return Err(RodlabError::request(
            field,
            samples.to_string(),
            "no statement: the lines are those of the measured body",
        ));
    }
    let step_hz = first.frequency_step_hz();
    let mut n_lines = first.mobility().len();
    if let Some(second) = measured.next() {
        n_lines = n_lines.min(second.mobility().len());
    }
    if let Some(lines) = &sheet.lines {
        let limit = lines.up_to.si() / step_hz + 1e-6;
        n_lines = (0..n_lines)
            .take_while(|line| *line as f64 <= limit)
            .count();
    }
    Ok(Some((step_hz, n_lines)))
}

fn bands(
    sheet: &ImpactSheet,
    problem: &StickProblem<'_>,
    uncertainty: &StickUncertainty<'_>,
    stick: &StickForce,
    outcome: &mut Outcome,
) -> Result<Bands, RodlabError> {
    let chosen = sheet.uncertainty.clone().unwrap_or_default();
    let draws = chosen.draws.unwrap_or(DRAWS);
    let seed = chosen.seed.unwrap_or(SEED);
    let level = chosen.level.as_ref().map_or(LEVEL, Exact::si);
    let mut say = |name: &str, value: String, by_default: bool| {
        outcome.settings.push(Setting {
            name: format!("problem.uncertainty.{name}"),
            value,
            by_default,
        });
    };
    say("draws", draws.to_string(), chosen.draws.is_none());
    say("seed", seed.to_string(), chosen.seed.is_none());
    say("level", level.to_string(), chosen.level.is_none());
    let refused = |error| RodlabError::step("problem.uncertainty", error);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let history = &stick.history;
    let error = problem.error(uncertainty).map_err(refused)?;
    let threshold = THRESHOLD * history.peak().force.abs();
    let impact = separate(history, threshold).map_err(refused)?;
    let drawn = uncertainty
        .monte_carlo(problem, threshold, draws, &mut random)
        .map_err(refused)?;
    let whole = 0..history.force().len();
    Ok(Bands {
        level,
        pointwise: error.pointwise(history, level).map_err(refused)?,
        simultaneous: error
            .simultaneous(history, level, whole, DRAWS_OF_BAND, &mut random)
            .map_err(refused)?,
        end: error.contact_end(history, &impact),
        contact: drawn.contact_band(level).map_err(refused)?,
        draws: drawn,
        impact,
        error,
    })
}

impl OnLines {
    /// Standard error of the force at `time`, where it is known.
    pub(super) fn error_at(&self, time: f64) -> Option<f64> {
        let index = self.stick.history.index_near(time)?;
        let bands = self.bands.as_ref()?;
        bands.error.standard_error().get(index).copied()
    }

    /// The largest standard error on the samples next to `time`: the first sample of a jump holds the middle of it, and half its error.
    pub(super) fn error_near(&self, time: f64) -> Option<f64> {
        let step = self.stick.history.time_step();
        [-step, 0.0, step]
            .iter()
            .filter_map(|away| self.error_at(time + away))
            .reduce(f64::max)
    }

    pub(super) fn quantities(&self) -> Vec<Quantity> {
        let peak = self.stick.history.peak();
        let mut found = vec![Quantity {
            name: "peak of the stick force on lines".to_owned(),
            unit: "N".to_owned(),
            value: Some(peak.force),
            standard_error: self.error_at(peak.time),
            valid: matches!(self.stick.settlement, impulse::Settlement::Settled),
            verdict: match self.stick.settlement {
                impulse::Settlement::Settled => "the force has died out within its period",
                _ => "the force has not died out within its period",
            }
            .to_owned(),
        }];
        let Some(bands) = &self.bands else {
            return found;
        };
        let end = match bands.impact.end {
            ContactEnd::Separated { time } => Some(time),
            _ => None,
        };
        let verdict = match bands.end.map(|end| end.verdict) {
            None => "the faces do not part".to_owned(),
            Some(EndVerdict::Linear) => {
                "the force is straight within two standard errors of it".to_owned()
            }
            Some(EndVerdict::Curved { deviation }) => format!(
                "the force bends by {deviation:.1} standard errors near it: see the limits by draws"
            ),
            Some(EndVerdict::MayEndEarlier { time, probability }) => format!(
                "the faces may have parted at {:.4} ms already, with a probability of {probability:.3}",
                1e3 * time
            ),
            Some(_) => "not known".to_owned(),
        };
        found.push(Quantity {
            name: "end of the first contact on lines".to_owned(),
            unit: "ms".to_owned(),
            value: end.map(|time| 1e3 * time),
            standard_error: bands.end.map(|end| 1e3 * end.standard_error),
            valid: matches!(bands.end.map(|end| end.verdict), Some(EndVerdict::Linear)),
            verdict,
        });
        let ends = &bands.draws.contact_ends;
        for (name, part) in [
            ("lower", 0.5 - 0.5 * bands.level),
            ("upper", 0.5 + 0.5 * bands.level),
        ] {
            let below = ends
                .iter()
                .enumerate()
                .find(|(index, _)| (*index + 1) as f64 >= part * ends.len() as f64);
            found.push(Quantity {
                name: format!("{name} limit of the end of the first contact"),
                unit: "ms".to_owned(),
                value: below.map(|(_, time)| 1e3 * time),
                standard_error: None,
                valid: below.is_some() && bands.draws.without_end == 0,
                verdict: format!(
                    "of {} draws, {} of which do not part",
                    ends.len() + bands.draws.without_end,
                    bands.draws.without_end
                ),
            });
        }
        found
    }

    pub(super) fn table(&self) -> Table {
        let history = &self.stick.history;
        let time = (0..history.force().len())
            .map(|n| history.time_at(n))
            .collect();
        let mut columns = vec![
            Column::numbers("time", "s", time),
            Column::numbers("stick force", "N", history.force().to_vec()),
        ];
        if let Some(bands) = &self.bands {
            let limits = |name: &str, band: &ForceBand| {
                [
                    Column::numbers(format!("{name}, lower"), "N", band.lower.clone()),
                    Column::numbers(format!("{name}, upper"), "N", band.upper.clone()),
                ]
            };
            let errors = bands.error.standard_error().to_vec();
            columns.push(Column::numbers("standard error", "N", errors));
            columns.extend(limits("pointwise band", &bands.pointwise));
            columns.extend(limits("band of the whole history", &bands.simultaneous));
            columns.push(Column::numbers(
                "force until the faces part",
                "N",
                bands.impact.history.force().to_vec(),
            ));
            columns.extend(limits("band by draws", &bands.contact));
        }
        Table {
            name: "stick_force".to_owned(),
            title: "Stick force on lines".to_owned(),
            columns,
        }
    }
}
