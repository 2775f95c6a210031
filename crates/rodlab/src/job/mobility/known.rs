//! Mobility of the bare face from a response. The impedance head is removed, low-frequency lines
//! are completed, and every line is judged.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use impulse::ImpedanceHead;
use labio::{Coherence, FrequencyResponse, LineValidity, MergedResponse, Passivity, ResponseKind};
use num_complex::Complex64;

use super::MobilitySheet;
use super::source::Raw;
use crate::bodies::face::ComputedBody;
use crate::digits::hertz;
use crate::outcome::Quantity;
use crate::responses::{cut, in_words, judged_lines, line_spacing_hz};
use crate::{InStep, Outcome, RodlabError};

/// Probability that chance alone marks at least one line of a passive body as generating energy.
const LEVEL: f64 = 0.01;

/// Maximum number of runs of neighbouring invalid lines that a log lists one by one.
const LONGEST_LOG: usize = 40;

/// The mobility and the data of every line.
pub(super) struct Known {
    pub(super) mobility: FrequencyResponse,
    /// The objection to each line; `None` for a valid line.
    pub(super) objections: Vec<Option<String>>,
    /// Coherence of every test.
    pub(super) coherences: Vec<Vec<f64>>,
    /// Weight of the second hammer on every line, and the difference between the responses of the
    /// two hammers divided by its standard error.
    pub(super) merged: Option<(Vec<f64>, Vec<f64>)>,
    /// Number of the first line that was not replaced.
    pub(super) first_measured: usize,
    /// Largest relative standard uncertainty that is common to all lines.
    pub(super) calibration: f64,
    /// Standard uncertainty of the delay between the channels \[s\].
    pub(super) delay: f64,
    pub(super) body: Option<ComputedBody>,
    pub(super) is_computed: bool,
    pub(super) origin: String,
}

impl Known {
    pub(super) fn is_valid(&self, line: usize) -> bool {
        self.objections.get(line).is_some_and(Option::is_none)
    }
}

pub(super) fn prepare(
    raw: Raw,
    sheet: &MobilitySheet,
    outcome: &mut Outcome,
) -> Result<Known, RodlabError> {
    let mut response = raw.response;
    if let Some(up_to) = &sheet.up_to {
        cut(&mut response, up_to, "up_to")?;
    }
    let n_lines = response.values.len();
    let mut objections: Vec<Option<String>> = vec![None; n_lines];
    judge_coherence(
        &response,
        &raw.coherences,
        raw.merged.as_ref(),
        &mut objections,
    )?;
    if let Some(mass) = &sheet.head_mass {
        let mass = mass.with_uncertainty();
        let bare = without_head(&response, mass.value)?;
        if let Some(error) = mass.standard_uncertainty {
            let heavier = without_head(&response, mass.value + error)?;
            outcome.quantities.push(effect_of_head(&bare, &heavier));
        }
        response = bare;
    }
    let mut first_measured = 0;
    if let Some(completion) = &sheet.complete {
        (response, first_measured) = completion.complete(&response, &sheet.support, "complete")?;
        for objection in objections.iter_mut().take(first_measured) {
            *objection = None;
        }
        let remark = format!("{first_measured} lines replaced by those of the weighed mass");
        outcome.accept(format!("lines below {}", completion.below), [remark]);
    }
    let mobility = response
        .to_kind(ResponseKind::Mobility)
        .in_step("the mobility")?;
    for (objection, validity) in objections.iter_mut().zip(&mobility.validity) {
        if *validity != LineValidity::Valid {
            *objection = Some(in_words(*validity).to_owned());
        }
    }
    judge_passivity(&mobility, &mut objections)?;
    log(&mobility, &objections, outcome);
    if let Some(window) = mobility.added_damping {
        outcome.warn(format!(
            "With the exponential window, the lines are values of the mobility at a distance of {:.4} 1/s from the frequency axis: they are not screened, and no force can be computed from them.",
            window.decay_rate()
        ));
    }
    Ok(Known {
        objections,
        coherences: raw
            .coherences
            .into_iter()
            .map(|coherence| {
                let mut values = coherence.values;
                values.truncate(n_lines);
                values
            })
            .collect(),
        merged: raw.merged.map(|merged| {
            let mut shares = merged.shares.row(1).to_vec();
            let mut discrepancy = merged.discrepancy;
            shares.truncate(n_lines);
            discrepancy.truncate(n_lines);
            (shares, discrepancy)
        }),
        first_measured,
        delay: raw.delay,
        calibration: mobility
            .common_error
            .iter()
            .flatten()
            .copied()
            .filter(|error| error.is_finite())
            .fold(0.0, f64::max),
        is_computed: raw.body.is_some(),
        body: raw.body,
        origin: raw.origin,
        mobility,
    })
}

/// Returns the response without the mass between the gauge and the face.
#[allow(
    clippy::indexing_slicing,
    reason = "`to_kind` refuses a response whose lists are not of one length; those of the face have the lines of its values"
)]
fn without_head(response: &FrequencyResponse, mass: f64) -> Result<FrequencyResponse, RodlabError> {
    let mut accelerance = response
        .to_kind(ResponseKind::Accelerance)
        .in_step("head_mass")?;
    let spacing_hz = line_spacing_hz(&accelerance)?;
    let head = ImpedanceHead::new(mass).in_step("head_mass")?;
    // lines without information are kept as they are
    let known: Vec<bool> = accelerance
        .validity
        .iter()
        .map(|validity| *validity == LineValidity::Valid)
        .collect();
    let values: Vec<Complex64> = accelerance
        .values
        .iter()
        .zip(&known)
        .map(|(value, known)| if *known { *value } else { Complex64::ZERO })
        .collect();
    let variance: Vec<f64> = match &accelerance.variance {
        Some(variance) => variance
            .iter()
            .zip(&known)
            .map(|(value, known)| if *known { *value } else { 0.0 })
            .collect(),
        None => vec![0.0; values.len()],
    };
    let face = head
        .face_mobility(&values, &variance, spacing_hz)
        .in_step("head_mass")?;
    for line in 0..values.len() {
        if line == 0 {
            // the mobility is not defined at 0 Hz, and the accelerance there can only be computed
            // from the mass
            accelerance.validity[0] = LineValidity::NotDefined;
            accelerance.values[0] = Complex64::new(f64::NAN, f64::NAN);
            if let Some(variance) = &mut accelerance.variance {
                variance[0] = f64::NAN;
            }
        } else if known[line] {
            let omega = TAU * spacing_hz * line as f64;
            accelerance.values[line] = face.mobility[line] * Complex64::new(0.0, omega);
            if let Some(variance) = &mut accelerance.variance {
                variance[line] = face.variance[line] * omega * omega;
            }
        }
    }
    Ok(accelerance)
}

/// Returns the effect on the lines of one standard uncertainty of the mass of the head.
fn effect_of_head(bare: &FrequencyResponse, heavier: &FrequencyResponse) -> Quantity {
    let lines = bare.values.iter().zip(&heavier.values);
    let largest = lines
        .map(|(bare, heavier)| ((heavier - bare) / bare).norm())
        .filter(|change| change.is_finite())
        .fold(0.0, f64::max);
    Quantity::of(
        "largest change by the uncertainty of the head mass",
        "%",
        100.0 * largest,
        "common to all lines and not included in their errors",
    )
}

fn judge_coherence(
    response: &FrequencyResponse,
    coherences: &[Coherence],
    merged: Option<&MergedResponse>,
    objections: &mut [Option<String>],
) -> Result<(), RodlabError> {
    if coherences.is_empty() {
        return Ok(());
    }
    let judged = judged_lines(response, coherences, merged)?;
    let lines = objections.iter_mut().zip(&response.validity).zip(judged);
    for ((objection, validity), line) in lines {
        if *validity != LineValidity::Valid {
            continue;
        }
        if !line.is_coherent {
            *objection = Some("coherence no higher than by chance".to_owned());
        } else if line.is_biased {
            *objection = Some("bias by noise at rest larger than the random error".to_owned());
        }
    }
    Ok(())
}

fn judge_passivity(
    mobility: &FrequencyResponse,
    objections: &mut [Option<String>],
) -> Result<(), RodlabError> {
    if mobility.variance.is_none() {
        return Ok(());
    }
    let report = mobility
        .passivity(LEVEL / mobility.values.len() as f64)
        .in_step("the passivity")?;
    for (objection, verdict) in objections.iter_mut().zip(&report.lines) {
        if *verdict == Passivity::Active && objection.is_none() {
            *objection = Some("generates energy".to_owned());
        }
    }
    Ok(())
}

/// Logs the runs of neighbouring lines with the same objection; if there are more than
/// [`LONGEST_LOG`] runs, the number of lines for each objection.
#[allow(
    clippy::indexing_slicing,
    reason = "a run begins and ends with lines of the mobility, each of which has a frequency"
)]
fn log(mobility: &FrequencyResponse, objections: &[Option<String>], outcome: &mut Outcome) {
    let frequency = &mobility.frequency_hz;
    let mut runs: Vec<(usize, usize, &str)> = Vec::new();
    for (line, objection) in objections.iter().enumerate() {
        let Some(reason) = objection else { continue };
        match runs.last_mut() {
            Some((_, end, last)) if *end == line && *last == reason => *end = line + 1,
            _ => runs.push((line, line + 1, reason)),
        }
    }
    if runs.len() <= LONGEST_LOG {
        for (from, to, reason) in runs {
            let (first, last) = (hertz(frequency[from]), hertz(frequency[to - 1]));
            let lines = match to - from {
                1 => format!("line at {first}"),
                count => format!("{count} lines from {first} to {last}"),
            };
            outcome.reject(lines, reason);
        }
        return;
    }
    let mut counts: BTreeMap<&str, (usize, f64, f64)> = BTreeMap::new();
    for (from, to, reason) in runs {
        let count = counts.entry(reason).or_insert((0, frequency[from], 0.0));
        count.0 += to - from;
        count.2 = frequency[to - 1];
    }
    for (reason, (count, first, last)) in counts {
        let (first, last) = (hertz(first), hertz(last));
        outcome.reject(format!("{count} lines between {first} and {last}"), reason);
    }
}
