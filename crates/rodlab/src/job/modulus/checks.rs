//! Checks that need no reference values, and their explanations in words.

use std::f64::consts::PI;

use cmod::ModulusLine;
use cmod::checks::{
    Arrivals, Channel, Check, CheckOutcome, CheckVerdict, FreeEndNull, USUAL_LEVEL,
    kramers_kronig_on, passivity,
};
use num_complex::Complex64;
use serde::Deserialize;

use super::measured::Spectra;
use super::method::{MethodSheet, rod};
use super::{Found, SourceSheet, checked_band, estimate};
use crate::digits::{hertz, significant};
use crate::outcome::{CHECK, Quantity};
use crate::sheet::{Exact, Frequency, Ratio};
use crate::{Outcome, RodlabError};

/// Factor on the speed of the wave front, as a margin for neglected effects. The assumed front is
/// faster than every phase velocity of the band: by the dispersion due to the loss factor up to the
/// Nyquist frequency, and by this factor.
const FRONT: f64 = 1.02;

/// Maximum number of lines used in the check of Kramers and Kronig.
const MOST_LINES: usize = 1000;

/// Minimum number of valid lines for the check of Kramers and Kronig.
const FEWEST_CHECKED: usize = 3;

/// Warning about a loss factor that no check tests.
const UNCHECKED_LOSS: &str = "Fewer than three lines or modes are valid, so no check tests whether the loss is that of the material: energy that \
     leaves through supports, cables or sensors counts as loss of the material. Measure more modes, or repeat the test with the supports elsewhere.";

/// Suffix of the name of the quantity of a check.
const SUFFIX: &str = ", p-value";

/// Selection of the checks.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChecksSheet {
    /// Probability of a false alarm of each check; `"1 %"` by default.
    pub level: Option<Exact<Ratio>>,
    /// Checks left out, such as `[KramersKronig]`.
    pub without: Vec<CheckSheet>,
    /// Frequency up to which the filter of the recorder suppresses aliases, such as `"20 kHz"`; by
    /// default half the Nyquist frequency. If the sheet states no band, the checks use no lines
    /// above it.
    pub alias_free_to: Option<Exact<Frequency>>,
}

/// A check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum CheckSheet {
    /// Passivity: E'' is nowhere below 0.
    Passivity,
    /// Kramers-Kronig check: E' and E'' belong to one relaxing material.
    KramersKronig,
    /// Free end: no force acts there except the inertia of the mass on it.
    FreeEndNull,
    /// Arrivals: nothing arrives before the fastest wave, and the first wave has the same sign in
    /// both channels.
    Arrivals,
}

impl ChecksSheet {
    /// Returns the default level of the checks, as text.
    pub(super) fn usual_level() -> String {
        format!("{} %", 100.0 * USUAL_LEVEL)
    }

    /// Returns the probability of a false alarm of each check.
    pub(super) fn level(&self) -> Result<f64, RodlabError> {
        let level = self.level.as_ref().map_or(USUAL_LEVEL, Exact::si);
        if level < 1.0 {
            Ok(level)
        } else {
            Err(RodlabError::request(
                "checks.level",
                level.to_string(),
                "a probability between 0 and 1",
            ))
        }
    }

    fn has(&self, check: CheckSheet) -> bool {
        !self.without.contains(&check)
    }
}

pub(super) fn check(outcome: &mut Outcome, found: &Found<'_>) -> Result<(), RodlabError> {
    let checks = &found.sheet.checks;
    let level = checks.level()?;
    let looked_at = checked_band::lines(outcome, found)?;
    let found = &Found {
        estimate: looked_at.as_ref().unwrap_or(found.estimate),
        ..*found
    };
    if checks.has(CheckSheet::Passivity) {
        say(
            outcome,
            found,
            Check::Passivity,
            passivity(found.estimate, level),
        );
    }
    if checks.has(CheckSheet::KramersKronig) {
        let made = kramers_kronig_on(
            found.estimate,
            MOST_LINES,
            lines_per_independent_line(found),
            level,
        );
        say(outcome, found, Check::KramersKronig, made);
        if (1..FEWEST_CHECKED).contains(&found.estimate.valid().count()) {
            outcome.warn(UNCHECKED_LOSS);
        }
    }
    if checks.has(CheckSheet::FreeEndNull) {
        free_end_null(outcome, found, level);
    }
    if checks.has(CheckSheet::Arrivals) {
        arrivals(outcome, found, level);
    }
    Ok(())
}

/// Returns the number of lines divided by the number of lines with independent noise; it is above 1
/// for padded pulses and damped records.
pub(super) fn lines_per_independent_line(found: &Found<'_>) -> f64 {
    let spectra = found.measured.spectra.as_ref();
    spectra.map_or(1.0, Spectra::lines_per_independent_line)
}

/// Checks the gauges against the free end, if the sheet states one.
#[allow(
    clippy::indexing_slicing,
    reason = "`index` of a line of the estimate is its index in these spectra"
)]
fn free_end_null(outcome: &mut Outcome, found: &Found<'_>, level: f64) {
    let (
        MethodSheet::MultiPoint {
            gauges,
            free_end_at: Some(free_end),
            ..
        },
        Some(Spectra::Gauges(spectra)),
    ) = (&found.sheet.method, &found.measured.spectra)
    else {
        return;
    };
    // with two gauges, the method itself assumes the free end
    if gauges.len() == 2 {
        return;
    }
    // the propagation coefficient at real frequencies does not apply to damped spectra
    if spectra.added_damping.is_some() {
        let name = format!("{CHECK}{}", Check::FreeEndNull);
        let reason = "not made: the spectra are those of damped records";
        outcome.reject(name, reason);
        return;
    }
    let distances = gauges
        .iter()
        .map(|gauge| (free_end.with_uncertainty().value - gauge.at.with_uncertainty().value).abs());
    let mut gamma = vec![Complex64::new(f64::NAN, 0.0); spectra.frequency_hz.len()];
    for line in found.estimate.valid() {
        gamma[line.index] = line.propagation_coefficient;
    }
    let quantity = rod::gauge_quantity(&found.measured.quantities, gauges);
    let rod = rod::rod_with_free_end(found.sheet);
    let uncertainty = rod::gauge_uncertainty(found.sheet, gauges, spectra);
    let made = FreeEndNull::new(rod, distances.collect(), quantity)
        .and_then(|check| check.with_uncertainty(uncertainty))
        .and_then(|check| check.with_noise_freedom(rod::noise_freedom(spectra)?))
        .and_then(|check| {
            estimate::with_gauge_spectra(spectra, |spectra| check.check(spectra, &gamma, level))
        });
    say(outcome, found, Check::FreeEndNull, made);
}

/// Checks the arrivals in the first accepted hit, if the motions of both ends were measured.
fn arrivals(outcome: &mut Outcome, found: &Found<'_>, level: f64) {
    let MethodSheet::TwoPoint {
        impacted_end,
        free_end,
        ..
    } = &found.sheet.method
    else {
        return;
    };
    let Some(first) = &found.measured.first_hit else {
        return;
    };
    let hit = &first.record;
    let valid: Vec<&ModulusLine> = found.estimate.valid().collect();
    let (Some(last), Ok(near), Ok(far)) = (
        valid.last(),
        hit.channel(impacted_end),
        hit.channel(free_end),
    ) else {
        return;
    };
    let (near, far) = (near.to_vec(), far.to_vec());
    let channels = vec![
        Channel {
            samples: &near,
            distance: 0.0,
        },
        Channel {
            samples: &far,
            distance: found.distance,
        },
    ];
    let rate = hit.sampling_rate_hz();
    let fastest = valid
        .iter()
        .map(|line| line.phase_velocity)
        .fold(0.0, f64::max);
    // for a constant loss factor, the relative growth of c is tan δ/π for each e-fold of the
    // frequency
    let growth = (0.5 * rate / last.frequency_hz).powf(last.loss_factor.max(0.0) / PI);
    let arrivals = match Arrivals::new(channels, rate.recip(), first.silent) {
        Ok(arrivals) => arrivals,
        Err(error) => return say(outcome, found, Check::Causality, Err(error)),
    };
    let causality = arrivals.causality(FRONT * fastest * growth, level);
    say(outcome, found, Check::Causality, causality);
    // the first wave is identified by the time from the silence to the impact, which only a trigger
    // determines
    if let Some(trigger) = first.trigger {
        let waiting = trigger.saturating_sub(first.silent) as f64 / rate;
        let passage = found.distance / fastest;
        let polarity = arrivals.polarity(fastest, waiting + 0.5 * passage, level);
        say(outcome, found, Check::Polarity, polarity);
    }
}

fn say(
    outcome: &mut Outcome,
    found: &Found<'_>,
    check: Check,
    made: Result<CheckOutcome, cmod::CmodError>,
) {
    let name = format!("{CHECK}{check}");
    match made {
        Ok(made) => {
            let verdict = match made.verdict {
                CheckVerdict::Passed => "passed".to_owned(),
                CheckVerdict::Failed => format!("failed at the level {}", made.level),
                _ => "undecided".to_owned(),
            };
            let check = Quantity::of(format!("{name}{SUFFIX}"), "", made.p_value, verdict);
            let holds = made.verdict != CheckVerdict::Failed;
            outcome.quantities.push(check.valid_if(holds));
            if made.has_failed() {
                outcome.doubt(in_words(&made, found));
            }
        }
        Err(error) => {
            let reason = format!("not made: {error}");
            outcome.reject(name, reason);
        }
    }
}

/// Returns a failed check and its possible causes in words.
fn in_words(made: &CheckOutcome, found: &Found<'_>) -> String {
    let at = made
        .worst
        .and_then(|index| {
            let lines = found.estimate.lines();
            lines.iter().find(|line| line.index == index)
        })
        .map(|line| format!(", worst at {}", hertz(line.frequency_hz)))
        .filter(|_| {
            matches!(
                made.check,
                Check::Passivity | Check::KramersKronig | Check::FreeEndNull
            )
        })
        .unwrap_or_default();
    let cause = match made.check {
        Check::Passivity => {
            "E'' is below 0 by more than its errors allow: the ends may be interchanged, or a channel may be delayed or inverted"
        }
        Check::KramersKronig => {
            "E' and E'' do not belong to one relaxing material: the sampling rate, a mass on an end, or a gain, delay or sign of a channel is \
             not as stated, the record ends before the rod is at rest, a support or a sensor resonates, lateral inertia is not corrected, \
             errors are stated too small, or an offset, drift or hum disturbs the lowest lines (raise `band.from`)"
        }
        Check::FreeEndNull => {
            "the gauges do not indicate a free end: a gauge may be elsewhere than stated, wired the other way round or wrongly calibrated, \
             or the rod bends or is held"
        }
        Check::Causality => {
            "something arrives before the fastest wave can: a channel may be early, or a filter responds ahead of its input"
        }
        Check::Polarity => {
            "the first wave has opposite signs in the channels: one of the sensors points the other way"
        }
        _ => "a condition that any material satisfies is not met",
    };
    format!(
        "the {} check fails{at}: {cause} ({}){}",
        made.check,
        if made.p_value < 1e-6 {
            "p below 1e-6".to_owned()
        } else {
            format!("p = {}", significant(made.p_value, 2))
        },
        against_delay(made.check, found)
    )
}

/// Returns the remedy if a delay between the channels of the sheet may be the cause of a failed
/// check; empty otherwise.
fn against_delay(check: Check, found: &Found<'_>) -> &'static str {
    let is_of_hits = matches!(found.sheet.source, SourceSheet::Hits { .. });
    if !is_of_hits || found.sheet.method.channels().len() < 2 {
        return "";
    }
    match check {
        Check::Passivity | Check::KramersKronig => {
            "; state a possible delay as `time_skew` of the channel, such as \"0 us ± 5 us\": the lines then determine it if they can"
        }
        Check::Causality => {
            "; if the signal of a channel is early, state `time_skew` of the channel, such as \"20 us ± 1 us\""
        }
        _ => "",
    }
}
