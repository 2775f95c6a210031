//! Lines of a response as a table, and its overall results as quantities.

use super::estimate::Estimated;
use super::scope::Band;
use super::words::{name_of, unit_of};
use crate::digits::{hertz, short};
use crate::median::upper_median;
use crate::outcome::{Quantity, Rows, Table, capital};
use crate::responses::with_errors;
use crate::universal::DECAY_RATE;

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// Returns the table of the lines in the band.
#[allow(
    clippy::indexing_slicing,
    reason = "`line` is the index of a line; the lists of response, tests and objections have one element per line"
)]
pub(super) fn table(
    estimated: &Estimated,
    output: &str,
    input: &str,
    file: &str,
    band: Band,
) -> Table {
    let response = &estimated.response;
    let lines: Vec<usize> = (0..response.values.len())
        .filter(|line| band.holds(response.frequency_hz[*line]))
        .collect();
    let (name, unit) = (name_of(response), unit_of(response));
    let values = &response.values;
    let title = format!("Frequency response of {output} over {input}");
    let mut rows = Rows::of(&lines, format!("response_{file}"), title)
        .number("frequency", "Hz", |line| response.frequency_hz[*line])
        .number(format!("real part of {name}"), &unit, |line| {
            values[*line].re
        })
        .number(format!("imaginary part of {name}"), &unit, |line| {
            values[*line].im
        })
        .number(format!("magnitude of {name}"), &unit, |line| {
            values[*line].norm()
        })
        .number("phase", "deg", |line| values[*line].arg() * DEGREES);
    let several = estimated.coherences.len() > 1;
    for (coherence, hammer) in estimated.coherences.iter().zip(["first", "second"]) {
        let name = match (several, &estimated.multiple) {
            (true, _) => format!("coherence, {hammer} hammer"),
            (false, None) => "coherence".to_owned(),
            (false, Some(_)) => "partial coherence".to_owned(),
        };
        rows = rows.number(name, "", |line| coherence.values[*line]);
    }
    if let Some(multiple) = &estimated.multiple {
        rows = rows.number("multiple coherence", "", |line| multiple[*line]);
    }
    if let Some(errors) = response.random_error() {
        rows = rows
            .number("random error of the magnitude", "%", |line| {
                100.0 * errors[*line].magnitude
            })
            .number("random error of the phase", "deg", |line| {
                DEGREES * errors[*line].phase
            });
    }
    rows.table = with_errors(rows.table, response, lines.iter().copied());
    if let Some(leakage) = &estimated.leakage {
        let name = format!("systematic error {}", estimated.cause);
        rows = rows.number(name, "%", |line| 100.0 * leakage[*line]);
    }
    if let Some(damping) = response.added_damping {
        rows = rows.number(DECAY_RATE, "1/s", |_| damping.decay_rate());
    }
    if let Some(merged) = &estimated.merged {
        rows = rows
            .number("share of the first hammer", "", |line| {
                merged.shares[(0, *line)]
            })
            .number("discrepancy of the hammers", "", |line| {
                merged.discrepancy[*line]
            });
    }
    let completed = estimated.completed.as_ref().map_or(0, |c| c.first_measured);
    let verdict = |line: &usize| match estimated.objections[*line] {
        Some(objection) => objection.to_owned(),
        None if *line < completed => "of the weighed mass".to_owned(),
        None => "valid".to_owned(),
    };
    let is_valid = |line: &usize| estimated.objections[*line].is_none();
    rows.validity(is_valid, verdict).table
}

/// Overall results from the valid lines of the band.
#[derive(Debug)]
pub(super) struct Merit {
    pub(super) quantities: Vec<Quantity>,
    pub(super) sentence: String,
    pub(super) n_lines: usize,
    pub(super) n_valid: usize,
    /// Number of lines that are coherent, whether or not their magnitude exceeds the noise.
    pub(super) n_coherent: usize,
}

/// Returns the overall results of a response in the band.
#[allow(
    clippy::indexing_slicing,
    reason = "`line` is the index of a line; the lists of response, tests and objections have one element per line"
)]
pub(super) fn merit(estimated: &Estimated, output: &str, input: &str, band: Band) -> Merit {
    let response = &estimated.response;
    // with several inputs, the name of the input distinguishes the quantities
    let label = &match estimated.multiple {
        None => output.to_owned(),
        Some(_) => format!("{output} over {input}"),
    };
    let in_band: Vec<usize> = (0..response.values.len())
        .filter(|line| band.holds(response.frequency_hz[*line]))
        .collect();
    let valid: Vec<usize> = in_band
        .iter()
        .copied()
        .filter(|line| estimated.is_valid(*line))
        .collect();
    let (n_valid, n_lines) = (valid.len(), in_band.len());
    let share = (n_lines > 0).then(|| 100.0 * n_valid as f64 / n_lines as f64);
    let of_lines = format!("{n_valid} of {n_lines} lines of the band");
    let share = Quantity::of(format!("valid lines, {label}"), "%", share, of_lines);
    let mut quantities = vec![share.valid_if(true)];
    for (coherence, hammer) in estimated.coherences.iter().zip(["first", "second"]) {
        let name = if estimated.coherences.len() > 1 {
            format!("lowest coherence, {label}, {hammer} hammer")
        } else {
            format!("lowest coherence, {label}")
        };
        let errors = coherence.random_error();
        let lowest = in_band
            .iter()
            .copied()
            .filter(|line| coherence.values[*line].is_finite())
            .min_by(|a, b| coherence.values[*a].total_cmp(&coherence.values[*b]));
        let verdict = lowest.map_or_else(
            || "no line has a coherence".to_owned(),
            |line| format!("at {}", hertz(coherence.frequency_hz[line])),
        );
        let value = lowest.map(|line| coherence.values[line]);
        quantities.push(
            Quantity::of(name, "", value, verdict)
                .with_error(lowest.map(|line| errors[line]))
                .valid_if(lowest.is_some_and(|line| estimated.is_valid(line))),
        );
    }
    let mut of_errors = "a single hit has no coherence and gives no random error".to_owned();
    if let Some(errors) = response.random_error() {
        let mut by_error: Vec<usize> = valid
            .iter()
            .copied()
            .filter(|line| errors[*line].magnitude.is_finite())
            .collect();
        by_error.sort_by(|a, b| errors[*a].magnitude.total_cmp(&errors[*b].magnitude));
        let percent = |line: usize| 100.0 * errors[line].magnitude;
        let median = by_error.get(by_error.len() / 2).map(|line| percent(*line));
        let largest = by_error.last().copied();
        quantities.push(Quantity::of(
            format!("median random error, {label}"),
            "%",
            median,
            "of the magnitude on the valid lines of the band",
        ));
        let at = |line: usize| hertz(response.frequency_hz[line]);
        let verdict = largest.map_or_else(
            || "no line of the band is valid".to_owned(),
            |line| format!("of the magnitude, at {}", at(line)),
        );
        let name = format!("largest random error, {label}");
        quantities.push(Quantity::of(name, "%", largest.map(percent), verdict));
        if let (Some(median), Some(line)) = (median, largest) {
            of_errors = format!(
                "the random error of a line is {} % in the median and up to {} %, at {}",
                short(median),
                short(percent(line)),
                at(line)
            );
        }
    }
    if let Some((leakage, _)) = estimated.median_leakage() {
        quantities.push(Quantity::of(
            format!("median error {}, {label}", estimated.cause),
            "%",
            100.0 * leakage,
            "systematic, of the complex line, in addition to the random error",
        ));
    }
    let calibration = (estimated.calibration > 0.0).then_some(100.0 * estimated.calibration);
    quantities.push(Quantity::of(
        format!("uncertainty of the calibration, {label}"),
        "%",
        calibration,
        match calibration {
            Some(_) => "common to all lines, from the stated uncertainties of the sensors",
            None => "the sheet states no uncertainty of the sensors",
        },
    ));
    quantities.extend(of_two_hammers(estimated, output, &valid));
    quantities.extend(of_the_mass(estimated, label));
    let calibration = calibration.map_or_else(String::new, |percent| {
        let percent = short(percent);
        format!("; the calibration adds {percent} %, common to all lines")
    });
    let leakage = estimated
        .largest_leakage(&valid)
        .map_or_else(String::new, |(line, leakage)| {
            format!(
                "; a systematic error {} is up to {} %, at {}",
                estimated.cause,
                short(100.0 * leakage),
                hertz(response.frequency_hz[line])
            )
        });
    let sentence = format!(
        "{} of `{output}` over `{input}` between {} and {}: {of_errors}{leakage}{calibration}.",
        capital(&name_of(response)),
        hertz(band.from_hz),
        hertz(band.to_hz),
    );
    Merit {
        quantities,
        sentence,
        n_lines,
        n_valid,
        n_coherent: in_band
            .iter()
            .filter(|line| estimated.is_coherent(**line))
            .count(),
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "`valid` are lines of the response, each of which has a discrepancy"
)]
fn of_two_hammers(estimated: &Estimated, output: &str, valid: &[usize]) -> Option<Quantity> {
    let discrepancy = &estimated.merged.as_ref()?.discrepancy;
    let values = valid.iter().map(|line| discrepancy[*line]);
    let median = upper_median(values.filter(|value| value.is_finite()));
    Some(Quantity::of(
        format!("median discrepancy of the hammers, {output}"),
        "",
        median,
        "0.7 if they differ by chance only",
    ))
}

fn of_the_mass(estimated: &Estimated, output: &str) -> Option<Quantity> {
    let completed = estimated.completed.as_ref()?;
    let mass = completed.apparent_mass;
    let verdict = "from the lines of the fitted band, to be compared with the weighed mass";
    let quantity = Quantity::of(format!("apparent mass, {output}"), "kg", mass, verdict)
        .with_error(completed.apparent_mass_standard_error)
        .valid_if(mass.is_finite());
    Some(quantity)
}
