//! Results for a force from a response: bands, numbers and sentences.

use impulse::{
    CalibrationScatter, ChoiceVerdict, ExclusionReason, ForceBand, ForceError, RandomErrorOfForce,
    ReconstructedForce, ResponseEnd,
};

use super::response_band;
use super::response_problem::{Noise, Problem};
use super::response_solve::window;
use crate::digits::{significant, with_unit};
use crate::outcome::{Quantity, finite};
use crate::{InStep, Outcome, RodlabError};

const DRAWS: usize = 1000;

/// Largest weighted residual per degree of freedom attributed to noise alone.
const CHI_SQUARE: f64 = 1.5;

/// Fraction of the response that may remain unexplained whatever the noise is, because of sampling
/// and because values are stored with eight digits.
const LEAST_RESIDUAL: f64 = 2e-3;

/// Largest ratio of the mean square error of reconstructed calibration hits to the stated mean
/// square error that is attributed to chance.
const BY_CHANCE: f64 = 1.5;

/// Root mean square difference between the force and the measured force, as a fraction of the peak,
/// above which they contradict each other if less than `INSIDE` of the measured force is in the
/// band.
const CONTRADICTS: f64 = 0.05;
const INSIDE: f64 = 0.9;

/// Fraction of the peak below which the bias due to a regularisation is not reported.
const AS_NONE: f64 = 1e-4;

/// Error estimates of the force.
pub(super) struct Bands {
    pub(super) level: f64,
    pub(super) random: Option<Random>,
    /// Standard error of the impulse due to noise \[N s\].
    impulse: Option<f64>,
    /// Scatter of calibration hits that were reconstructed from each other.
    scatter: Option<CalibrationScatter>,
}

/// Random error of the force: from noise, or from the scatter of calibration hits if noise does not
/// explain this scatter.
pub(super) struct Random {
    pub(super) error: ForceError,
    pub(super) pointwise: ForceBand,
    pub(super) simultaneous: ForceBand,
}

impl Bands {
    /// Returns the scatter of calibration hits, if the stated random error does not explain it.
    fn beyond_noise(&self) -> Option<CalibrationScatter> {
        self.scatter.filter(is_beyond_noise)
    }
}

fn is_beyond_noise(scatter: &CalibrationScatter) -> bool {
    scatter
        .over_stated
        .is_none_or(|over_stated| over_stated > BY_CHANCE)
}

pub(super) fn bands(
    problem: &Problem<'_>,
    solved: &ReconstructedForce,
    scatter: Option<CalibrationScatter>,
    outcome: &mut Outcome,
) -> Result<Bands, RodlabError> {
    let chosen = &problem.sheet.uncertainty;
    let (draws, level, mut random) = chosen.settled(DRAWS, outcome);
    let history = &solved.history;
    let window = window(problem);
    let by_noise = solved.error.known();
    let impulse = by_noise.map(|error| {
        let sums = (0..draws).map(|_| {
            let draw = error.draw(&mut random);
            let inside = draw.iter().skip(window.start).take(window.len());
            history.time_step() * inside.sum::<f64>()
        });
        let square: f64 = sums.map(|sum| sum * sum).sum();
        (square / draws as f64).sqrt()
    });
    let error = match scatter.filter(is_beyond_noise) {
        Some(scatter) => Some(scatter.error(history, window.clone(), by_noise)),
        None => by_noise.cloned(),
    };
    let band = |band: ForceBand| {
        if problem.sheet.non_negative {
            band.compressive()
        } else {
            band
        }
    };
    let random = error
        .map(|error| {
            Ok::<_, RodlabError>(Random {
                pointwise: band(
                    error
                        .pointwise(history, level)
                        .in_step("problem.uncertainty")?,
                ),
                simultaneous: band(
                    error
                        .simultaneous(history, level, window, draws, &mut random)
                        .in_step("problem.uncertainty")?,
                ),
                error,
            })
        })
        .transpose()?;
    Ok(Bands {
        level,
        random,
        impulse,
        scatter,
    })
}

pub(super) fn tell(
    problem: &Problem<'_>,
    solved: &ReconstructedForce,
    bands: &Bands,
    outcome: &mut Outcome,
) {
    let history = &solved.history;
    let peak = history.interpolated_peak();
    let at = history.index_near(peak.time);
    let standard = |error: &ForceError| at.and_then(|at| error.standard_error().get(at).copied());
    let by_profile = solved
        .peak_interval
        .map(|interval| 0.5 * (interval.standard[1] - interval.standard[0]));
    let stated = bands
        .random
        .as_ref()
        .and_then(|known| standard(&known.error));
    let beyond_noise = bands.beyond_noise();
    // the scatter between hits contains the error due to noise, so the larger of the two is used
    let error = match (by_profile, stated) {
        (Some(a), Some(b)) if beyond_noise.is_some() => Some(a.max(b)),
        (a, b) => a.or(b),
    };
    let impulse_error = match (bands.impulse, beyond_noise, solved.impulse) {
        (Some(known), Some(scatter), Some(impulse)) => {
            Some(known.max(scatter.relative_impulse * impulse.abs()))
        }
        (known, _, impulse) => known.filter(|_| impulse.is_some()),
    };
    let impulse = match solved.impulse {
        Some(impulse) => format!("an impulse of {}", with_unit(impulse, impulse_error, "N s")),
        None => "an unknown impulse: the band does not contain 0 Hz, and the time in which the force acts is not stated".to_owned(),
    };
    let unknown = match error {
        Some(_) => "",
        None => ", with an unknown error",
    };
    let band = problem.sheet.band.as_ref();
    let band = band.filter(|_| problem.acting.is_none());
    let in_band = band.map_or_else(String::new, |band| {
        format!(" between {} and {}", band.from, band.to)
    });
    outcome.say(format!(
        "The peak force{in_band} is {}{unknown} at {:.4} ms from the start of the record, with {impulse}.",
        with_unit(peak.force, error, "N"),
        1e3 * peak.time,
    ));
    if let Some(lost) = problem.lost_in_band
        && lost * peak.force > error.unwrap_or(0.0)
    {
        outcome.doubt(format!(
            "the force has no part outside the band; in this band the peaks of the calibration hits are {:.0} % too low, and the peak of the force may be as well: state `acting`, or a wider band",
            100.0 * lost
        ));
    }
    if error.is_some_and(|error| peak.force < 3.0 * error) {
        outcome.warn("The peak is below three standard errors: there may be no force at all.");
    }
    let acting = window(problem);
    let inside = history.force().iter().skip(acting.start);
    let inside = inside.take(acting.len());
    let tension = inside.fold(0.0, |most: f64, force| most.max(-force));
    if tension > peak.force {
        outcome.doubt(format!(
            "the largest force is a tension of {} N: the response or the force of the calibration has the wrong sign",
            significant(tension, 3)
        ));
    }
    let difference = Difference::of(problem, solved, bands);
    if let Some(difference) = &difference {
        compared(difference, solved, bands.level, outcome);
    }
    warnings(problem, solved, outcome);
    response_band::warn_of_end(problem, solved, outcome);
    quantities(
        problem,
        solved,
        (bands, difference.as_ref()),
        (error, impulse_error),
        outcome,
    );
    log(solved, outcome);
}

/// Difference between the force and the measured force.
struct Difference {
    /// Root mean square while the force acts \[N\].
    root_mean_square: f64,
    /// Fraction of the measured force inside the band of the whole history.
    inside: Option<f64>,
}

impl Difference {
    fn of(problem: &Problem<'_>, solved: &ReconstructedForce, bands: &Bands) -> Option<Self> {
        let measured = &problem.in_band(problem.measured.as_ref()?);
        let inside = window(problem);
        let pairs = solved.history.force().iter().zip(measured);
        let pairs = pairs.skip(inside.start).take(inside.len());
        let square: f64 = pairs
            .map(|(force, measured)| (force - measured).powi(2))
            .sum();
        let known = bands.random.as_ref();
        Some(Self {
            root_mean_square: (square / inside.len() as f64).sqrt(),
            inside: known.map(|known| known.simultaneous.part_inside(measured, inside)),
        })
    }
}

/// Reports the comparison of the force with the measured force.
fn compared(
    difference: &Difference,
    solved: &ReconstructedForce,
    level: f64,
    outcome: &mut Outcome,
) {
    let by = significant(difference.root_mean_square, 3);
    let inside = difference.inside.map(|inside| 100.0 * inside);
    let of_band = inside.map_or_else(String::new, |inside| {
        format!(
            "; {inside:.0} % of the measured force is inside the {:.0} % band of the whole history",
            100.0 * level
        )
    });
    outcome.say(format!(
        "The force differs from the measured force by {by} N while it acts (root mean square){of_band}."
    ));
    let is_large = difference.root_mean_square > CONTRADICTS * solved.history.peak().force.abs();
    if is_large && inside.is_none_or(|inside| inside < 100.0 * INSIDE) {
        outcome.doubt(format!(
            "the force differs from the measured force by {by} N (root mean square): one of the sensors, the path or the synchronisation is wrong"
        ));
    }
}

fn warnings(problem: &Problem<'_>, solved: &ReconstructedForce, outcome: &mut Outcome) {
    if let ResponseEnd::CutOff { relative_level } = solved.response_end {
        outcome.warn(format!(
            "The response has not died out when the record ends: {:.1} % of the peak remains, and the part cut off appears as a force throughout the record: {}.",
            100.0 * relative_level,
            problem.sheet.path.remedy_of_ringing()
        ));
    }
    if let Some(chi_square) = solved.reduced_chi_square
        && chi_square > CHI_SQUARE
    {
        outcome.doubt(format!(
            "the mean square residual of the response is {chi_square:.2} times the mean square of the noise: the noise is underestimated, or the frequency response belongs to another body"
        ));
    }
    if let RandomErrorOfForce::Estimated {
        standard_deviation, ..
    } = &solved.error
        && let Some(rest) = problem.rest
        && *standard_deviation > CHI_SQUARE * rest
        && solved.relative_residual > LEAST_RESIDUAL
    {
        outcome.doubt(format!(
            "the force leaves a residual of {:.2e} {}, although the response scatters by only {rest:.2e} {} before the force acts: the frequency response belongs to another body",
            standard_deviation, problem.first.unit, problem.first.unit
        ));
    }
    if let Some(parameter) = &solved.parameter {
        let least = AS_NONE * solved.history.peak().force;
        let mut biases = solved.regularisation_bias.iter();
        match parameter.verdict {
            ChoiceVerdict::AtEnd if biases.all(|bias| bias.abs() < least) => outcome.warn(
                "The data require no regularisation, and the chosen one has practically no effect.",
            ),
            ChoiceVerdict::AtEnd => outcome.warn(
                "The parameter of the regularisation is at the upper end of its range: the data require the strongest regularisation.",
            ),
            ChoiceVerdict::NoCorner => outcome.warn(
                "No parameter of the regularisation has a finite score: the weakest regularisation was used.",
            ),
            _ => {}
        }
    }
    if solved.silent_components > 0 {
        outcome.warn(format!(
            "{} components of the force do not appear in the response at all and were left at zero.",
            solved.silent_components
        ));
    }
}

fn quantities(
    problem: &Problem<'_>,
    solved: &ReconstructedForce,
    (bands, difference): (&Bands, Option<&Difference>),
    (peak_error, impulse_error): (Option<f64>, Option<f64>),
    outcome: &mut Outcome,
) {
    let history = &solved.history;
    let peak = history.interpolated_peak();
    let mut add =
        |name: &str, unit: &str, value: Option<f64>, error: Option<f64>, verdict: &str| {
            let quantity = Quantity::of(name, unit, value.and_then(finite), verdict);
            outcome.quantities.push(quantity.with_error(error));
        };
    let of_error = match (&solved.error, bands.beyond_noise()) {
        (_, Some(_)) => "error from calibration hits, which scatter by more than the noise",
        (RandomErrorOfForce::Stated(_), None) if bands.scatter.is_some() => {
            "error from the noise, which explains the scatter of calibration hits"
        }
        (RandomErrorOfForce::Stated(_), None) => "error from the stated noise",
        (RandomErrorOfForce::Estimated { .. }, None) => "error from the residual",
        _ => "the error is not known: the force reproduces the response to the last digit",
    };
    let of_peak = response_band::named(problem, of_error);
    add("peak force", "N", Some(peak.force), peak_error, &of_peak);
    if let Some(interval) = solved.peak_interval {
        let verdict = "95 % profile interval, without tension";
        let [low, high] = interval.wide;
        add("peak force, lower end", "N", Some(low), None, verdict);
        add("peak force, upper end", "N", Some(high), None, verdict);
    }
    add(
        "time of the peak",
        "ms",
        Some(1e3 * peak.time),
        None,
        "from the first sample of the record",
    );
    add(
        "impulse",
        "N s",
        solved.impulse,
        impulse_error,
        if solved.impulse.is_some() {
            of_error
        } else {
            "not known: the band does not contain 0 Hz, and `acting` is not stated"
        },
    );
    let at = history.index_near(peak.time);
    let bias = at.and_then(|at| solved.regularisation_bias.get(at).copied());
    add(
        "change of the peak by the regularisation",
        "N",
        bias,
        None,
        "an estimate, included in the error",
    );
    if let Some(parameter) = &solved.parameter {
        add(
            "parameter of the regularisation",
            "",
            Some(parameter.value),
            None,
            match parameter.verdict {
                ChoiceVerdict::Given => "given",
                ChoiceVerdict::Found => "found inside its range",
                ChoiceVerdict::AtEnd => "at the end of its range",
                ChoiceVerdict::NotReached => "not reached",
                _ => "no corner: the weakest",
            },
        );
    }
    if let RandomErrorOfForce::Estimated {
        standard_deviation, ..
    } = &solved.error
    {
        add(
            "noise of the response",
            problem.first.unit,
            Some(*standard_deviation),
            None,
            "estimated from the residual",
        );
    } else if let Noise::White(noise) = problem.first.noise {
        add(
            "noise of the response",
            problem.first.unit,
            Some(noise),
            None,
            "stated, or from the rest before the impact",
        );
    }
    let chi_square = solved.reduced_chi_square;
    add(
        "weighted residual per degree of freedom",
        "",
        chi_square,
        None,
        match chi_square {
            None => "not known: the noise is not stated, or there are no degrees of freedom",
            Some(value) if value > CHI_SQUARE => "more than expected from the noise",
            Some(_) => "as expected from the noise",
        },
    );
    add(
        "relative residual",
        "",
        Some(solved.relative_residual),
        None,
        "the part of the response that the force does not explain",
    );
    if let Some(scatter) = &bands.scatter {
        let verdict = format!(
            "from {} hits reconstructed from each other",
            scatter.n_blows
        );
        add(
            "scatter between hits without force",
            "N",
            Some(scatter.without_force),
            None,
            &verdict,
        );
        add(
            "scatter between hits with the force",
            "%",
            Some(100.0 * scatter.relative),
            None,
            &verdict,
        );
    }
    if let Some(difference) = difference {
        add(
            "root mean square difference from the measured force",
            "N",
            Some(difference.root_mean_square),
            None,
            "while the force acts",
        );
        if let Some(inside) = difference.inside {
            add(
                "part of the measured force inside the band of the whole history",
                "%",
                Some(100.0 * inside),
                None,
                "while the force acts",
            );
        }
    }
}

/// Adds the unused lines to the log, one entry for each reason.
fn log(solved: &ReconstructedForce, outcome: &mut Outcome) {
    for reason in [
        ExclusionReason::LeftOut,
        ExclusionReason::OutsideBand,
        ExclusionReason::NotResolved,
        ExclusionReason::VanishingResponse,
    ] {
        let lines: Vec<f64> = solved
            .excluded
            .iter()
            .filter(|line| line.reason == reason)
            .map(|line| line.frequency_hz)
            .collect();
        let (Some(first), Some(last)) = (lines.first(), lines.last()) else {
            continue;
        };
        let words = match reason {
            ExclusionReason::LeftOut => "the frequency response, or its error, is not known there",
            ExclusionReason::OutsideBand => "outside the band",
            ExclusionReason::NotResolved => "the frequency response is no larger than its errors",
            _ => "the frequency response is zero there",
        };
        let lines = match lines.len() {
            1 => format!("line at {first:.6} Hz"),
            count => format!("{count} lines between {first:.6} Hz and {last:.6} Hz"),
        };
        outcome.reject(lines, words);
    }
}
