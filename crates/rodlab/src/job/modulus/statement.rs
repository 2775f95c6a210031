//! Results as quantities and sentences.

use cmod::ModulusLine;
use cmod::estimate::ErrorSource;

use super::checks::lines_per_independent_line;
use super::reasons::{Reasons, known, lines, n_suitable};
use super::{Found, MethodSheet};
use crate::Outcome;
use crate::digits::{hertz, percent, to_error};
use crate::outcome::Quantity;

/// Largest distance of a line from a requested frequency at which the line is still used, as a
/// fraction of the frequency.
const NEAR: f64 = 0.02;

/// Largest number of valid lines for which the result can be in doubt because all of them may have
/// a wrong number of waves.
const FEW: usize = 3;

/// Number of lines with a doubtful number of waves, per valid line, from which on at most [`FEW`]
/// valid lines put the result in doubt.
const UNCOUNTED: usize = 20;

pub(super) fn state(outcome: &mut Outcome, found: &Found<'_>, reasons: &Reasons) {
    let all = found.estimate.lines();
    let valid: Vec<&ModulusLine> = found.estimate.valid().collect();
    let (Some(first), Some(last)) = (valid.first(), valid.last()) else {
        if storage_modulus_alone(outcome, found, reasons) {
            return;
        }
        let why = if all.is_empty() {
            found
                .estimate
                .refused()
                .first()
                .map_or("there is none".to_owned(), |line| line.reason.to_string())
        } else {
            reasons.commonest(3)
        };
        let reason = format!(
            "none of {} is valid: {why}",
            lines(all.len() + found.estimate.refused().len())
        );
        outcome.deny("There is no modulus", reason);
        outcome.summary.extend(reasons.advice_in_words());
        at_frequencies(outcome, found, &[]);
        return;
    };
    let named = at_frequencies(outcome, found, &decades(first, last));
    let best = middle_of(&named, first, last).or_else(|| middle_of(&valid, first, last));
    if let Some(line) = best {
        outcome.lead(answer(line, first, last, &valid, all.len()));
    }
    let noise = if lines_per_independent_line(found) > 1.0 {
        "correlated between neighbouring lines"
    } else {
        "independent from line to line"
    };
    outcome.summary.insert(
        1,
        format!(
            "Found by {}. Errors are one standard error. Random errors are due to noise and {noise}. Common errors are shared by all lines{}.",
            found.sheet.method.words(),
            best.map_or_else(String::new, by_sources),
        ),
    );
    if valid.len() < all.len() {
        let others = match all.len() - valid.len() {
            1 => "The other line is".to_owned(),
            others => format!("The other {others} lines are"),
        };
        outcome.say(format!(
            "{others} not valid; a line can have several reasons: {}.",
            reasons.commonest(3)
        ));
        outcome.summary.extend(reasons.advice_in_words());
    }
    if let Some(doubt) = few_counted(valid.len(), reasons.n_uncounted()) {
        outcome.doubt(doubt);
    }
    warn(outcome, found, &valid);
}

/// Returns the doubt about `n_valid` lines if they are very few compared with the lines on which
/// the number of waves is in doubt.
fn few_counted(n_valid: usize, n_uncounted: usize) -> Option<String> {
    let are_few = n_valid <= FEW && n_uncounted >= UNCOUNTED * n_valid;
    are_few.then(|| {
        let are = if n_valid == 1 { "is" } else { "are" };
        format!(
            "the number of waves is in doubt on {}, and only {} {are} valid: a disturbance of the low lines, such as mains hum or a zero shift, may lead to a wrong number of waves; begin `band` above the disturbed lines",
            lines(n_uncounted),
            lines(n_valid)
        )
    })
}

/// Returns the line nearest to the middle of the band from `first` to `last`, on a logarithmic
/// axis.
fn middle_of<'a>(
    lines: &[&'a ModulusLine],
    first: &ModulusLine,
    last: &ModulusLine,
) -> Option<&'a ModulusLine> {
    let middle = (first.frequency_hz * last.frequency_hz).sqrt();
    let distance = |line: &ModulusLine| (line.frequency_hz / middle).ln().abs();
    let lines = lines.iter().copied();
    lines.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// States E' on lines on which only the error of the loss factor exceeds its limit, if no line is
/// valid. Returns false if there are fewer of these lines than half of the lines with a suitable
/// wavelength: with a reversed sensor, E' may be within its limits on some lines by chance.
fn storage_modulus_alone(outcome: &mut Outcome, found: &Found<'_>, reasons: &Reasons) -> bool {
    let all = found.estimate.lines();
    let known = known(found.estimate);
    let (Some(first), Some(last)) = (known.first(), known.last()) else {
        return false;
    };
    if 2 * known.len() < n_suitable(found.estimate) {
        return false;
    }
    at_frequencies(outcome, found, &decades(first, last));
    let Some(line) = middle_of(&known, first, last) else {
        return false;
    };
    let (scale, unit) = unit_of(line.modulus.re);
    let modulus = scale * line.modulus.re;
    let relative = line.standard_error.storage_modulus / line.modulus.re;
    outcome.lead(format!(
        "E' = {} {unit} ± {} at {}; it is known on {} of {} from {} to {}. The loss factor is known on none of them: at {} it is {} ± {}, and {}.",
        to_error(modulus, modulus * relative),
        percent(relative),
        hertz(line.frequency_hz),
        known.len(),
        lines(all.len()),
        hertz(first.frequency_hz),
        hertz(last.frequency_hz),
        hertz(line.frequency_hz),
        to_error(line.loss_factor, line.standard_error.loss_factor),
        percent((line.standard_error.loss_factor / line.loss_factor).abs()),
        line.validity,
    ));
    outcome.summary.insert(1, format!(
        "Found by {}. Errors are one standard error. A loss factor counts as known if five of its standard errors are within `limits.loss_factor`.",
        found.sheet.method.words()
    ));
    outcome.summary.extend(reasons.advice_in_words());
    if found.sheet.laws.is_some() {
        outcome.warn("No law is fitted, because the loss factor is known on no line.");
    }
    warn(outcome, found, &known);
    true
}

fn answer(
    line: &ModulusLine,
    first: &ModulusLine,
    last: &ModulusLine,
    valid: &[&ModulusLine],
    all: usize,
) -> String {
    let (random, common) = (line.random_error(), line.systematic_error());
    let (scale, unit) = unit_of(line.modulus.re);
    let modulus = scale * line.modulus.re;
    let parts = |value: f64, random: f64, common: f64| {
        let random = percent(random / value.abs());
        if common > 0.0 {
            format!(
                "± {random} random ± {} common",
                percent(common / value.abs())
            )
        } else {
            format!("± {random} random")
        }
    };
    format!(
        "E' = {} {unit} {} and loss factor {} {} at {}; {} of {} valid from {} to {}.",
        to_error(
            modulus,
            modulus * line.standard_error.storage_modulus / line.modulus.re
        ),
        parts(
            line.modulus.re,
            random.storage_modulus,
            common.storage_modulus
        ),
        to_error(line.loss_factor, line.standard_error.loss_factor),
        parts(line.loss_factor, random.loss_factor, common.loss_factor),
        hertz(line.frequency_hz),
        valid.len(),
        if all == 1 {
            "1 line is".to_owned()
        } else {
            format!("{all} lines are")
        },
        hertz(first.frequency_hz),
        hertz(last.frequency_hz),
    )
}

/// Returns the common errors of E' on one line, the largest first, such as `; they are due to
/// density (1.0 %), length (0.12 %)`.
fn by_sources(line: &ModulusLine) -> String {
    let mut sources: Vec<(String, f64)> = line
        .uncertainty
        .systematic
        .iter()
        // lateral inertia is a bound and is stated separately
        .filter(|shift| shift.source != ErrorSource::LateralInertia)
        .map(|shift| {
            let part = (shift.modulus.re / line.modulus.re).abs();
            (shift.source.to_string(), part)
        })
        .collect();
    sources.sort_by(|a, b| b.1.total_cmp(&a.1));
    if sources.is_empty() {
        return ", but no source of such errors is stated".to_owned();
    }
    let words: Vec<String> = sources
        .iter()
        .map(|(source, part)| format!("{source} ({})", percent(*part)))
        .collect();
    format!("; they are due to {}", words.join(", "))
}

/// Returns the factor from Pa to GPa or MPa, as suits a modulus of this size \[Pa\], and the unit.
pub(super) fn unit_of(modulus: f64) -> (f64, &'static str) {
    if modulus.abs() >= 0.1e9 {
        (1e-9, "GPa")
    } else {
        (1e-6, "MPa")
    }
}

/// Returns the frequencies 1, 2 and 5 of each decade of the valid band \[Hz\].
fn decades(first: &ModulusLine, last: &ModulusLine) -> Vec<f64> {
    let mut wanted = Vec::new();
    let mut decade = 1.0;
    while decade <= last.frequency_hz {
        for step in [1.0, 2.0, 5.0] {
            let f = step * decade;
            if f >= first.frequency_hz && f <= last.frequency_hz {
                wanted.push(f);
            }
        }
        decade *= 10.0;
    }
    wanted
}

/// Adds the quantities at the frequencies of the sheet or, by default, at the `usual` frequencies
/// \[Hz\]. Returns the valid lines among them.
fn at_frequencies<'a>(
    outcome: &mut Outcome,
    found: &Found<'a>,
    usual: &[f64],
) -> Vec<&'a ModulusLine> {
    let asked = found.sheet.report_at.as_ref();
    let wanted: Vec<f64> = asked.map_or_else(
        || usual.to_vec(),
        |texts| texts.iter().map(crate::sheet::Exact::si).collect(),
    );
    let mut valid = Vec::new();
    for f in wanted {
        let distance = |line: &&ModulusLine| (line.frequency_hz - f).abs();
        let line = found
            .estimate
            .lines()
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .filter(|line| distance(line) <= NEAR * f);
        match line {
            Some(line) => {
                if line.validity.is_valid() {
                    valid.push(line);
                }
                if asked.is_none() && !line.validity.storage_modulus_is_valid() {
                    // a default frequency is left out if E' is not known on its line
                    continue;
                }
                of_line(outcome, line);
            }
            None => {
                if asked.is_some() {
                    let name = format!("storage modulus at {}", hertz(f));
                    let verdict = "no line within 2 % of this frequency";
                    let quantity = Quantity::of(name, "GPa", None::<f64>, verdict);
                    outcome.quantities.push(quantity);
                }
            }
        }
    }
    valid
}

fn of_line(outcome: &mut Outcome, line: &ModulusLine) {
    let at = hertz(line.frequency_hz);
    let error = &line.standard_error;
    let (scale, unit) = unit_of(line.modulus.re);
    let (complex, real) = (
        line.validity.is_valid(),
        line.validity.storage_modulus_is_valid(),
    );
    for (name, unit, value, error, valid) in [
        (
            "storage modulus",
            unit,
            scale * line.modulus.re,
            scale * error.storage_modulus,
            real,
        ),
        (
            "loss modulus",
            unit,
            scale * line.modulus.im,
            scale * error.loss_modulus,
            complex,
        ),
        (
            "loss factor",
            "",
            line.loss_factor,
            error.loss_factor,
            complex,
        ),
        (
            "phase velocity",
            "m/s",
            line.phase_velocity,
            error.phase_velocity,
            real,
        ),
    ] {
        let verdict = match valid {
            true => "valid".to_owned(),
            false => line.validity.to_string(),
        };
        let quantity = Quantity::of(format!("{name} at {at}"), unit, value, verdict);
        outcome
            .quantities
            .push(quantity.with_error(error).valid_if(valid));
    }
}

fn warn(outcome: &mut Outcome, found: &Found<'_>, valid: &[&ModulusLine]) {
    let specimen = &found.sheet.specimen;
    if specimen
        .density
        .with_uncertainty()
        .standard_uncertainty
        .is_none()
    {
        outcome.warn(
            "The density is stated without an uncertainty: its relative error is in every modulus, but the errors do not include it.",
        );
    }
    if let (MethodSheet::TwoPoint { .. }, None, Some(mass)) = (
        &found.sheet.method,
        &specimen.accelerometer_mass,
        specimen.mass(),
    ) {
        // effect of a mass of 1 g at the resonances, to first order in the ratio of the masses
        let error = 2e-3 / mass;
        let effect = if error < 0.3 {
            format!("is {} too small", percent(error))
        } else {
            "is only a fraction of the true value".to_owned()
        };
        outcome.warn(format!(
            "No `accelerometer_mass` is stated, and none is taken into account: with a sensor of 1 g on the free end E' {effect}. \
             State \"0 g\" if there is none."
        ));
    }
    if let Some(length) = found.sheet.method.length_without_uncertainty(specimen) {
        outcome.warn(format!(
            "{length} is stated without an uncertainty: the errors do not include it. A length or distance that is wrong by 1 % makes E' wrong by 2 %."
        ));
    }
    if let Some(corrected) = found.corrected {
        let relative = |line: &ModulusLine| {
            let position = found
                .estimate
                .lines()
                .iter()
                .position(|other| other.index == line.index)?;
            let correction = corrected.corrections().get(position)?;
            Some((
                line.frequency_hz,
                line.modulus.re / correction.apparent_modulus.re - 1.0,
            ))
        };
        let stated = found.sheet.lateral_inertia.as_ref();
        let ratio = stated.map(|asked| &asked.poisson_ratio);
        if let Some(ratio) = ratio.filter(|ratio| ratio.with_uncertainty().value > 0.0)
            && let Some((f, most)) = valid.last().and_then(|line| relative(line))
        {
            outcome.say(format!(
                "E' was corrected for lateral inertia, which raises it by {} at {}.",
                percent(most),
                hertz(f)
            ));
            if ratio.with_uncertainty().standard_uncertainty.is_none() {
                // the correction is proportional to the square of Poisson's ratio
                outcome.warn(format!(
                    "Poisson's ratio is stated without an uncertainty: if it is wrong by 0.01, E' is wrong by {} at {}, which the errors do not include.",
                    percent(most * 0.02 / ratio.with_uncertainty().value),
                    hertz(f)
                ));
            }
        }
    } else if let Some(line) = valid.last() {
        let bound = line.lateral_inertia_bound().storage_modulus / line.modulus.re.abs();
        outcome.warn(format!(
            "E' was not corrected for lateral inertia, because no Poisson's ratio is stated. For any ratio up to 0.5, E' is too small by at most {} at {}; \
             this bound is stated in addition to the errors and is included when lines are judged valid. State Poisson's ratio in `lateral_inertia` to correct for it.",
            percent(bound),
            hertz(line.frequency_hz)
        ));
    }
    let is_larger = |line: &&ModulusLine| {
        line.systematic_error().storage_modulus > line.random_error().storage_modulus
    };
    let larger = valid.iter().filter(|line| is_larger(line)).count();
    if larger > valid.len() / 2 {
        let lines = if valid.len() == 1 {
            "the only valid line".to_owned()
        } else if larger == valid.len() {
            format!("all {larger} valid lines")
        } else {
            format!("{larger} of {} valid lines", valid.len())
        };
        outcome.warn(format!(
            "On {lines} the common error of E' is larger than the random one: it shifts all lines alike, and more \
             hits do not reduce it."
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests that a few valid lines among many lines with a doubtful number of waves put the result
    /// in doubt. The numbers 1 and 1243 are from a record of a rod of 2.4 GPa, in which mains hum
    /// left one of 1244 lines valid, with a modulus of 0.6 MPa.
    #[test]
    fn a_line_beside_many_that_are_not_counted_is_in_doubt() {
        assert_eq!(
            few_counted(1, 1243).unwrap(),
            "the number of waves is in doubt on 1243 lines, and only 1 line is valid: a disturbance of the low lines, such as mains hum or a zero shift, may lead to a wrong number of waves; begin `band` above the disturbed lines"
        );
        for right in [(1, 0), (1, 19), (3, 59), (4, 4000)] {
            assert_eq!(few_counted(right.0, right.1), None, "{right:?}");
        }
    }
}
