//! Screening, which checks whether the mobility can be that of a passive and causal body, and
//! impulse response.

use std::sync::Arc;

use impulse::{ImpactBody, Kernel, Quadrature, Screening, ScreeningFlag, TimeGrid};
use labio::{FrequencyResponse, LineValidity};

use super::MobilitySheet;
use super::known::Known;
use crate::digits::{hertz, short};
use crate::outcome::{Quantity, Table, finite};
use crate::responses::{SupportSheet, line_spacing_hz, measured_body, stretch_with_signal};
use crate::sheet::ValueWithUncertainty;
use crate::{InStep, Outcome, RodlabError};

/// Minimum number of lines for screening.
const FEWEST_SCREENED: usize = 64;

/// Results of the screening.
#[derive(Default)]
pub(super) struct Screened {
    pub(super) impulse_response: Option<ImpulseResponse>,
}

/// Velocity of the face after a unit impulse.
pub(super) struct ImpulseResponse {
    pub(super) time: Vec<f64>,
    /// Mean over each step \[1/kg\]; the first step, which includes the immediate response, is left
    /// out.
    pub(super) values: Vec<f64>,
    /// Final value for a free body, 1/M \[1/kg\].
    pub(super) rigid: Option<f64>,
}

impl ImpulseResponse {
    pub(super) fn table(&self) -> Table {
        let title = "Velocity of the face after a unit impulse";
        Table::new("impulse_response", title)
            .numbers("time", "s", &self.time)
            .numbers("impulse response", "1/kg", &self.values)
    }
}

pub(super) fn screen(
    known: &Known,
    sheet: &MobilitySheet,
    outcome: &mut Outcome,
) -> Result<Screened, RodlabError> {
    let mobility = &known.mobility;
    if mobility.added_damping.is_some() {
        return Ok(Screened::default());
    }
    let holes = mobility.invalid_lines().filter(|line| *line > 0).count();
    if holes > 0 {
        outcome.warn(format!(
            "{holes} lines above 0 Hz carry no information: the mobility is not screened, and has no impulse response."
        ));
        return Ok(Screened::default());
    }
    let body: Arc<dyn ImpactBody + Send + Sync> = if let Some(computed) = &known.body {
        computed.impact_body()?
    } else {
        let missing = mobility.validity.first() != Some(&LineValidity::Valid);
        if missing && matches!(sheet.support, SupportSheet::AsMeasured) {
            outcome.warn(
                "The support of the body is not stated (`support`), and no line at 0 Hz indicates it: the mobility is not screened, and has no impulse response.",
            );
            return Ok(Screened::default());
        }
        let measured = |mobility: &FrequencyResponse| {
            let front = sheet.front_impedance.as_ref();
            let front = front.map(|impedance| ValueWithUncertainty {
                value: impedance.si(),
                standard_uncertainty: None,
            });
            measured_body(mobility, &sheet.support, front, "the mobility")?
                .with_first_measured(known.first_measured)
                .with_delay_error(known.delay)
                .in_step("the mobility")
        };
        let body = measured(mobility)?;
        let screening = match with_signal(known, sheet, outcome) {
            Some(lines) => measured(&lines)?.screen(),
            None => body.screen(),
        };
        let failed = tell(&screening, outcome);
        outcome.doubt_all(failed);
        Arc::new(body)
    };
    Ok(Screened {
        impulse_response: impulse_response(&*body, known, outcome),
    })
}

/// Returns the lines that are screened if the mobility is from hits and the sheet states no upper
/// frequency: the lines with a signal, up to half the Nyquist frequency, below which no alias is
/// expected. Their range is entered in `outcome`. Returns `None` if all lines are screened.
fn with_signal(
    known: &Known,
    sheet: &MobilitySheet,
    outcome: &mut Outcome,
) -> Option<FrequencyResponse> {
    if sheet.up_to.is_some() || known.coherences.is_empty() {
        return None;
    }
    let n_lines = known.mobility.values.len();
    let above_chance = (0..n_lines).map(|line| known.is_valid(line));
    let (_, last) = stretch_with_signal(above_chance)?;
    let n_screened = (last + 1).min(n_lines.div_ceil(2));
    // fewer lines do not allow a conclusion, so all lines are screened
    if n_screened == n_lines || n_screened < FEWEST_SCREENED {
        return None;
    }
    let mut lines = known.mobility.clone();
    lines.truncate(n_screened);
    let highest = lines.frequency_hz.last().copied().unwrap_or(f64::NAN);
    outcome.by_default(
        "lines that are screened",
        format!(
            "up to {}, the last line with a coherence above that of chance, but at most half the Nyquist frequency; state `up_to` for another limit",
            hertz(highest)
        ),
    );
    Some(lines)
}

/// Returns the impulse response over half a period of the lines, with two steps per period of the
/// highest line.
fn impulse_response(
    body: &dyn ImpactBody,
    known: &Known,
    outcome: &mut Outcome,
) -> Option<ImpulseResponse> {
    let n_lines = known.mobility.values.len();
    let period = 1.0 / line_spacing_hz(&known.mobility).ok()?; // else its body was refused
    let grid = TimeGrid {
        time_step: period / (2 * (n_lines - 1)) as f64,
        n_steps: n_lines - 1,
    };
    let kernel = match Kernel::of(body, grid, Quadrature::CellAverages) {
        Ok(kernel) => kernel,
        // a mobility is valid without an impulse response; for example, a law that is known only at
        // real frequencies may have no limit at 0 Hz
        Err(error) => {
            let why = std::error::Error::source(&error)
                .map_or_else(String::new, |source| format!(": {source}"));
            outcome.warn(format!("There is no impulse response: {error}{why}."));
            return None;
        }
    };
    let weights = kernel.weights();
    if known.body.is_none() {
        // the level ahead of the impulse is a check of causality; if the body rings longer than the
        // period, the level is due to the part of the response that wraps around
        let level = kernel.acausal() / weights.first().map_or(1.0, |w| w.abs());
        outcome.quantities.push(Quantity::of(
            "level of the impulse response ahead of the impulse",
            "",
            Some(level).filter(|level| level.is_finite()),
            "root mean square, relative to the response in the first step",
        ));
    }
    Some(ImpulseResponse {
        time: (1..weights.len())
            .map(|step| step as f64 * grid.time_step)
            .collect(),
        values: weights
            .iter()
            .skip(1)
            .map(|weight| weight / grid.time_step)
            .collect(),
        rigid: body.free_mass().map(|mass| 1.0 / mass),
    })
}

/// Reports the screening of a measured body as quantities, followed by a sentence and warnings.
/// Returns one clause for each failed check: a response before the force, generated energy, and a
/// mass different from the weighed mass.
pub(crate) fn tell(screening: &Screening, outcome: &mut Outcome) -> Vec<String> {
    let flags = screening.flags();
    let against = |is_it: &dyn Fn(&ScreeningFlag) -> bool| {
        let flag = flags.iter().find(|flag| is_it(flag));
        flag.map(ToString::to_string)
    };
    let mut add = |name: &str, unit: &str, value: f64, error: Option<f64>, flag: Option<String>| {
        let verdict = flag.as_deref().unwrap_or("no objection");
        let quantity = Quantity::of(name, unit, finite(value), verdict);
        let quantity = quantity.with_error(error.and_then(finite));
        outcome.quantities.push(quantity.valid_if(flag.is_none()));
    };
    let causality = &screening.causality;
    add(
        "energy ahead of the impulse",
        "",
        causality.acausal_part,
        None,
        against(&|flag| matches!(flag, ScreeningFlag::Acausal { .. })),
    );
    add(
        "lines that make energy",
        "",
        screening.passivity.active_lines as f64,
        None,
        against(&|flag| matches!(flag, ScreeningFlag::Active { .. })),
    );
    let early = |at: usize| screening.passivity.seen_delays.get(at).copied().flatten();
    let mut seen = [early(0), early(1)];
    if let Some(delay) = &screening.delay {
        add(
            "delay of the motion by the nearly rigid lines",
            "us",
            1e6 * delay.delay,
            Some(1e6 * delay.standard_error),
            against(&|flag| matches!(flag, ScreeningFlag::Delayed { .. })),
        );
        let least = delay.least_seen();
        seen = seen.map(|seen| Some(seen.map_or(least, |seen| seen.min(least))));
    }
    for (name, seen) in [
        ("motion too early that would have been seen", seen[0]),
        ("motion too late that would have been seen", seen[1]),
    ] {
        if let Some(seen) = seen {
            add(name, "us", 1e6 * seen, None, None);
        }
    }
    let with_scale = |value: f64, error: f64| Some(error.hypot(screening.scale_error * value));
    if let Some(mass) = &screening.mass {
        add(
            "mass by the low lines",
            "kg",
            mass.apparent,
            with_scale(mass.apparent, mass.standard_error),
            against(&|flag| {
                matches!(
                    flag,
                    ScreeningFlag::MassContradicted { .. } | ScreeningFlag::NotFree { .. }
                )
            }),
        );
    }
    if let Some(front) = &screening.front {
        add(
            "front impedance by the mean over resonance spacings",
            "kg/s",
            front.apparent,
            with_scale(front.apparent, front.standard_error),
            against(&|flag| {
                matches!(
                    flag,
                    ScreeningFlag::FrontContradicted { .. }
                        | ScreeningFlag::FrontNotPositive { .. }
                )
            }),
        );
    }
    if flags.is_empty() {
        let microseconds = |seen: f64| format!("{} us", short(1e6 * seen));
        let delays = match seen {
            [None, None] => "no delay between force and motion would have been seen".to_owned(),
            [Some(early), Some(late)] => format!(
                "a motion {} too early or {} too late would have been seen",
                microseconds(early),
                microseconds(late)
            ),
            [Some(early), None] => format!(
                "a motion {} too early would have been seen, but not a motion too late",
                microseconds(early)
            ),
            [None, Some(late)] => format!(
                "a motion {} too late would have been seen, but not a motion too early",
                microseconds(late)
            ),
        };
        outcome.say(format!(
            "The screening found no objection: the body does not generate energy, its motion begins and ends as it should, and {delays}."
        ));
    }
    let fails = |flag: &ScreeningFlag| {
        matches!(
            flag,
            ScreeningFlag::Acausal { .. }
                | ScreeningFlag::Active { .. }
                | ScreeningFlag::Delayed { .. }
                | ScreeningFlag::MassContradicted { .. }
                | ScreeningFlag::NotFree { .. }
        )
    };
    let (failed, warnings): (Vec<ScreeningFlag>, Vec<ScreeningFlag>) =
        flags.into_iter().partition(fails);
    let warnings = warnings.iter().map(|flag| format!("Screening: {flag}."));
    outcome.warnings.extend(warnings);
    failed
        .iter()
        .map(|flag| format!("screening: {flag}"))
        .collect()
}
