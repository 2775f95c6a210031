//! Counts of the reasons for invalid lines.

use std::collections::BTreeMap;

use cmod::ModulusLine;
use cmod::estimate::{ErrorSource, ModulusEstimate};
use cmod::validity::Violation;

use crate::digits::hertz;
use crate::outcome::LogEntry;

/// Maximum number of frequency ranges listed for one reason.
const STRETCHES_NAMED: usize = 4;

/// Reason for a line on which the number of waves is in doubt.
const UNCOUNTED: &str = "number of waves in doubt";

/// Reasons for a line with a large random error.
const OF_MODULUS: &str = "error of E' above its limit";
const OF_LOSS_FACTOR: &str = "error of the loss factor above its limit";

/// The reasons of all lines.
pub(super) struct Reasons {
    /// Short reasons for each line of the estimate; empty for a valid line.
    pub(super) of_line: Vec<Vec<&'static str>>,
    counts: Vec<(&'static str, usize)>,
    /// Clauses about windows that cut off a part of a pulse.
    cut_pulses: Vec<String>,
}

pub(super) fn of(estimate: &ModulusEstimate, cut_pulses: &[String]) -> Reasons {
    let mut of_line = Vec::with_capacity(estimate.lines().len());
    let mut counts: BTreeMap<&'static str, usize> = BTreeMap::new();
    for line in estimate.lines() {
        let mut reasons: Vec<&'static str> = line
            .validity
            .violations()
            .iter()
            .map(in_few_words)
            .collect();
        reasons.sort_unstable();
        reasons.dedup();
        for reason in &reasons {
            *counts.entry(reason).or_default() += 1;
        }
        of_line.push(reasons);
    }
    let mut counts: Vec<(&'static str, usize)> = counts.into_iter().collect();
    counts.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    Reasons {
        of_line,
        counts,
        cut_pulses: cut_pulses.to_vec(),
    }
}

/// Returns a violation in words, without its numbers.
fn in_few_words(violation: &Violation) -> &'static str {
    match violation {
        Violation::WavelengthTooShort { .. } => "wavelength below five diameters",
        Violation::WavelengthTooLong { .. } => "wavelength above five lengths",
        Violation::DampingNotPositive { .. } => "damping coefficient not positive",
        Violation::WaveNumberNotPositive { .. } => "wave number not positive",
        Violation::BranchAmbiguous(_) => UNCOUNTED,
        Violation::NotConverged { .. } => "iteration did not converge",
        Violation::RootNotFollowed { .. } => "root lost where two roots meet",
        Violation::SeriesTruncated { .. } => "series in the mass ratio not accurate enough",
        Violation::NearSingular { .. } => "too near a singular frequency for this noise",
        Violation::ErrorTooLarge { quantity: "E'", .. } => OF_MODULUS,
        Violation::ErrorTooLarge { .. } | Violation::LossWithinNoise { .. } => OF_LOSS_FACTOR,
        Violation::LateralInertiaTooLarge { quantity: "E'", .. } => {
            "lateral inertia not corrected: error of E' above its limit"
        }
        Violation::LateralInertiaTooLarge { .. } => {
            "lateral inertia not corrected: error of the loss factor above its limit"
        }
        Violation::CommonErrorTooLarge { largest, .. } => by_source(*largest),
        Violation::ErrorAmplified { .. } => "errors amplified above the limit",
        Violation::CoherenceTooLow { .. } => "coherence below its limit",
        Violation::NodeAtMiddleGauge { .. } => "node at the middle gauge",
        Violation::SignalTooWeak { .. } => "signal of the gauges hardly above their noise",
        Violation::Misfit { .. } => "two waves do not explain the gauges",
        _ => "another condition",
    }
}

/// Returns the remedy for a reason of [`in_few_words`]; `None` if there is no general remedy.
fn advice(reason: &str) -> Option<&'static str> {
    Some(match reason {
        UNCOUNTED => {
            "the wave speed, stated as `wave_speed` if the method has this field, or a band that begins above hum and offsets"
        }
        "wavelength below five diameters" => "a thinner rod reaches higher frequencies",
        "wavelength above five lengths" => "a longer rod reaches lower frequencies",
        OF_MODULUS | OF_LOSS_FACTOR => {
            "more hits, sensors with less noise, or a longer rod for the low frequencies"
        }
        "too near a singular frequency for this noise" | "errors amplified above the limit" => {
            "a rod of another length, with resonances at other frequencies"
        }
        "coherence below its limit" => {
            "hits with more energy at these frequencies (a harder tip for the high ones), and a check of cables and mounting"
        }
        _ if reason.starts_with("lateral inertia not corrected") => {
            "state Poisson's ratio in `lateral_inertia`, so that lateral inertia is corrected"
        }
        _ if reason.starts_with("common error of E'") => {
            "measure again the quantity that contributes most to the common error"
        }
        _ => return None,
    })
}

/// Returns the reason for a common error above its limit, with the source that contributes most.
fn by_source(largest: ErrorSource) -> &'static str {
    match largest {
        ErrorSource::Length => "common error of E' above its limit, mostly due to the length",
        ErrorSource::Diameter => "common error of E' above its limit, mostly due to the diameter",
        ErrorSource::Density => "common error of E' above its limit, mostly due to the density",
        ErrorSource::AccelerometerMass => {
            "common error of E' above its limit, mostly due to the mass of the accelerometer"
        }
        ErrorSource::Section(_) => {
            "common error of E' above its limit, mostly due to the distance of a section"
        }
        ErrorSource::PoissonRatio => {
            "common error of E' above its limit, mostly due to Poisson's ratio"
        }
        ErrorSource::LateralInertia => {
            "common error of E' above its limit, mostly due to uncorrected lateral inertia"
        }
        _ => "common error of E' above its limit",
    }
}

impl Reasons {
    /// Returns the number of lines on which the number of waves is in doubt.
    pub(super) fn n_uncounted(&self) -> usize {
        let mut counts = self.counts.iter();
        counts
            .find(|(reason, _)| *reason == UNCOUNTED)
            .map_or(0, |(_, count)| *count)
    }

    /// Returns the most frequent reasons, such as `error of E' above its limit (312 lines), ...`.
    pub(super) fn commonest(&self, most: usize) -> String {
        let named: Vec<String> = self
            .counts
            .iter()
            .take(most)
            .map(|(reason, count)| format!("{reason} ({})", lines(*count)))
            .collect();
        named.join(", ")
    }

    /// Returns a sentence with the remedy for the most frequent reason; `None` if there is no
    /// general remedy. If a window cuts off a part of a pulse, wider windows are advised, because
    /// more hits reduce only the errors due to noise.
    pub(super) fn advice_in_words(&self) -> Option<String> {
        let (reason, _) = self.counts.first()?;
        if matches!(*reason, OF_MODULUS | OF_LOSS_FACTOR) && !self.cut_pulses.is_empty() {
            return Some(format!(
                "For more valid lines: windows that contain the whole pulses, or pulses further apart (a gauge elsewhere, a shorter impact); {}, and what is cut off is part of the errors.",
                self.cut_pulses.join(", and ")
            ));
        }
        Some(format!("For more valid lines: {}.", advice(reason)?))
    }

    /// Returns the log entries: one for the valid lines, one for each reason why other lines are
    /// not valid, and one for each reason why lines have no modulus.
    pub(super) fn log(&self, estimate: &ModulusEstimate) -> Vec<LogEntry> {
        let all = estimate.lines();
        let frequencies = |keep: &dyn Fn(&[&'static str]) -> bool| -> Vec<Option<f64>> {
            let lines = all.iter().zip(&self.of_line);
            lines
                .map(|(line, reasons)| keep(reasons).then_some(line.frequency_hz))
                .collect()
        };
        let valid = frequencies(&|reasons| reasons.is_empty());
        let mut log = vec![LogEntry {
            what: format!(
                "{} of {} are valid: {}",
                valid.iter().flatten().count(),
                lines(all.len()),
                stretches(&valid)
            ),
            accepted: valid.iter().any(Option::is_some),
            reasons: Vec::new(),
        }];
        for (reason, count) in &self.counts {
            let with = frequencies(&|reasons| reasons.contains(reason));
            log.push(LogEntry::rejected(
                format!("{}: {}", lines(*count), stretches(&with)),
                reason,
            ));
        }
        let mut refused: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for line in estimate.refused() {
            refused
                .entry(line.reason.to_string())
                .or_default()
                .push(line.frequency_hz);
        }
        for (reason, at) in refused {
            let end = |end: Option<&f64>| hertz(end.copied().unwrap_or(f64::NAN));
            let (first, last) = (end(at.first()), end(at.last()));
            let lines = format!("{} without a modulus: {first} to {last}", lines(at.len()));
            log.push(LogEntry::rejected(lines, reason));
        }
        log
    }
}

/// Returns the number of lines whose waves are neither too long nor too short for the specimen.
pub(super) fn n_suitable(estimate: &ModulusEstimate) -> usize {
    let is_of_wavelength = |violation: &Violation| {
        matches!(
            violation,
            Violation::WavelengthTooLong { .. } | Violation::WavelengthTooShort { .. }
        )
    };
    let lines = estimate.lines().iter();
    lines
        .filter(|line| !line.validity.violations().iter().any(is_of_wavelength))
        .count()
}

pub(super) fn known(estimate: &ModulusEstimate) -> Vec<&ModulusLine> {
    let lines = estimate.lines().iter();
    lines
        .filter(|line| line.validity.storage_modulus_is_valid())
        .collect()
}

pub(super) fn lines(count: usize) -> String {
    match count {
        1 => "1 line".to_owned(),
        count => format!("{count} lines"),
    }
}

/// Returns the longest ranges of neighbouring lines in words, in the order of frequency; `None`
/// stands for a line that is not included.
fn stretches(lines: &[Option<f64>]) -> String {
    let mut found: Vec<(usize, f64, f64)> = Vec::new();
    let mut open = false;
    for line in lines {
        match line {
            Some(f) if open => {
                if let Some(last) = found.last_mut() {
                    *last = (last.0 + 1, last.1, *f);
                }
            }
            Some(f) => found.push((1, *f, *f)),
            None => {}
        }
        open = line.is_some();
    }
    if found.is_empty() {
        return "nowhere".to_owned();
    }
    let count = found.len();
    found.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
    found.truncate(STRETCHES_NAMED);
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut words: Vec<String> = found
        .iter()
        .map(|(length, from, to)| {
            if *length == 1 {
                hertz(*from)
            } else {
                format!("{} to {}", hertz(*from), hertz(*to))
            }
        })
        .collect();
    if count > STRETCHES_NAMED {
        words.push(match count - STRETCHES_NAMED {
            1 => "1 shorter stretch".to_owned(),
            others => format!("{others} shorter ranges"),
        });
    }
    words.join(", ")
}
