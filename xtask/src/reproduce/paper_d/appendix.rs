//! Table A1: the check of the parameter identification in the paper, by two methods.
//!
//! (a) The method of the paper: output of the direct problem as input of the identification,
//! without noise, units as printed. This tests only the optimiser. (b) A method without the inverse
//! crime: data of the lumped chain, without noise, with time units read as ms, which makes damping
//! significant; and an additional row in which m is significant.

use maxwellid::{Noise, Scale, Verdict};
use rodwave::digits::{percent, significant};
use serde::Serialize;

use super::super::Error;
use super::identify::{
    Outcome, Parameter, Settings, identify, influences, modulus_of, stated, value_of,
};
use super::virtual_test::{self, Conditions, NOISE_OF_TABLE_5, Rig, cell_for};
use testbed::papers::paper_d::{AppendixRow, LawParameters, ModelKind, PaperD, UnitReading};

/// Longest cell of the inversion, in m.
const CELL: f64 = 1e-3;
/// Number of cells of the chain per shortest wavelength of the record.
const CELLS_PER_WAVE: f64 = 90.0;
/// Distance of the section of excitation from the struck end in m, as in Table 2; the appendix does
/// not state the length of the rod.
const TAPE: f64 = 0.008;

/// Line of a table: a parameter of a model, with its input and identified values.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Line {
    pub(crate) parameter: Parameter,
    pub(crate) input: f64,
    /// Rms change of the response due to a change of the input by ten per cent, as a fraction of
    /// V0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) influence_of_ten_per_cent: Option<f64>,
    /// Output over input, minus one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) relative_error: Option<f64>,
    /// Verdict for the same data when the noise of the recorder is stated.
    pub(crate) verdict_with_noise: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) printed_input: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) printed_output: Option<String>,
    /// Relative error printed in the paper.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) printed_relative_error: Option<f64>,
}

/// Rows of the table for one model, computed by one method.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    pub(crate) model: &'static str,
    pub(crate) reading: &'static str,
    pub(crate) data: &'static str,
    pub(crate) lines: Vec<Line>,
    pub(crate) converged: bool,
    pub(crate) iterations: usize,
    /// δ for data of another solver; `None` for a round trip, whose δ is rounding and is in
    /// `at_rounding`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) relative_error: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) at_rounding: Option<f64>,
}

/// Method of computing a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    RoundTrip,
    Independent,
    /// Additional row: as [`Way::Independent`], but with m = 12 MPa.
    ActivationActs,
}

/// Row that is to be computed.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    way: Way,
    row: AppendixRow,
    input: LawParameters,
}

pub(crate) fn jobs(paper: &PaperD) -> Vec<Job> {
    let of = |way, reading| {
        paper.appendix(reading).iter().map(move |row| Job {
            way,
            row: row.clone(),
            input: row.input,
        })
    };
    let mut jobs: Vec<Job> = of(Way::RoundTrip, UnitReading::Literal)
        .chain(of(Way::Independent, UnitReading::Milliseconds))
        .collect();
    let own = jobs.iter().rev().find_map(|job| match job.input {
        LawParameters::MaxwellGurevichRabinovich {
            modulus, viscosity, ..
        } => Some(Job {
            way: Way::ActivationActs,
            row: job.row.clone(),
            input: LawParameters::MaxwellGurevichRabinovich {
                modulus,
                viscosity,
                activation_stress: 12e6,
            },
        }),
        _ => None,
    });
    jobs.extend(own);
    jobs
}

pub(crate) fn run(job: &Job, rig: &Rig) -> Result<Row, Error> {
    let Job { way, row, input } = job;
    let round_trip = *way == Way::RoundTrip;
    let conditions = Conditions {
        name: format!("Table A1, {}", row.model.symbol()),
        density: row.density,
        diameter: row.diameter,
        rod_length: row.section_distance + TAPE,
        section_distance: row.section_distance,
        transducer_range: 0.020,
        // the rubber of M_3 needs twice the time of the plastics for the same number of reflections
        samples_after: if row.model == ModelKind::MaxwellGurevichRabinovich {
            256
        } else {
            128
        },
        cell: cell_for(modulus_of(*input), row.density, CELLS_PER_WAVE),
    };
    let test = if round_trip {
        rig.round_trip(&conditions, *input, CELL)?
    } else {
        rig.driven(&conditions, *input, &mut virtual_test::Noise::none())?
    };
    let influences = influences(*input, std::slice::from_ref(&test), CELL)?;
    let outcome = identify(
        row.model,
        &[test],
        Settings {
            cell: Some(CELL),
            round_trip,
            noise: Noise::FromResidual,
            recorder_noise: NOISE_OF_TABLE_5,
        },
        None,
    )?;
    Ok(Row {
        model: row.model.symbol(),
        reading: match way {
            Way::RoundTrip => UnitReading::Literal.description(),
            Way::Independent => UnitReading::Milliseconds.description(),
            Way::ActivationActs => {
                "additional row: milliseconds, with m = 12 MPa, where m has an effect"
            }
        },
        data: if round_trip {
            "virtual, noise-free, made by the solver that inverts it (as in the paper's appendix)"
        } else {
            "virtual, noise-free, made by a lumped chain that shares nothing with the inversion"
        },
        lines: lines(job, &outcome, &influences)?,
        converged: outcome.converged,
        iterations: outcome.iterations,
        relative_error: (!round_trip).then_some(outcome.relative_error),
        at_rounding: round_trip.then_some(outcome.relative_error),
    })
}

/// Returns the parameters in the order of the paper, followed by the rate at 10 MPa if there is
/// one.
fn lines(job: &Job, outcome: &Outcome, influences: &[(&str, f64)]) -> Result<Vec<Line>, Error> {
    let truth = stated(job.input)?;
    let mut lines = Vec::new();
    let printed = job.row.model.parameters();
    let others = outcome
        .parameters
        .iter()
        .map(|p| p.symbol)
        .filter(|symbol| !printed.contains(symbol));
    for symbol in printed.iter().copied().chain(others) {
        let (Some(parameter), Some(input)) = (
            outcome.parameters.iter().find(|p| p.symbol == symbol),
            value_of(&truth, symbol),
        ) else {
            continue;
        };
        let print = job
            .row
            .parameters
            .iter()
            .find(|p| p.parameter == symbol && job.way != Way::ActivationActs);
        lines.push(Line {
            input,
            influence_of_ten_per_cent: value_of(influences, symbol),
            relative_error: parameter.value.map(|value| value / input - 1.0),
            verdict_with_noise: outcome
                .verdict_with_noise
                .iter()
                .find(|(name, _)| *name == symbol)
                .map_or(Verdict::NotIdentifiable, |(_, verdict)| *verdict)
                .to_string(),
            printed_input: print.map(|p| p.input.printed.clone()),
            printed_output: print.map(|p| p.output.printed.clone()),
            printed_relative_error: print.map(|p| p.relative_error.value),
            parameter: parameter.clone(),
        });
    }
    Ok(lines)
}

/// Writes a standard error in its scale: in per cent for a ratio, or as the difference of an
/// exponent.
pub(crate) fn standard_error(parameter: &Parameter) -> String {
    match (parameter.standard_error, parameter.scale) {
        (None, _) => "-".into(),
        (Some(error), Scale::Ratio) if error < 1e-7 => "< 1e-5 %".into(),
        (Some(error), Scale::Ratio) => percent(error),
        (Some(error), Scale::Difference) if error < 1e-7 => "< 1e-7".into(),
        (Some(error), Scale::Difference) => significant(error, 2),
    }
}
