//! Check of passivity: a material dissipates energy, E'' >= 0.

use super::{
    Check, CheckOutcome, CheckVerdict, check_level, normal_tail_below, of_the_least,
    student_tail_below,
};
use crate::error::CmodError;
use crate::estimate::ModulusEstimate;

/// Checks that E'' of an `estimate` is nowhere below 0 by more than its random errors allow.
/// `level` is the largest probability of a false alarm.
///
/// The relative loss l = E''/|E| with its random error σ is tested twice, each time at half of the
/// level: the mean of l is tested by Σ(l/σ²)/√Σ(1/σ²), and single lines by the smallest l/σ of all
/// lines. The statistic is the more extreme of the two, in standard errors below 0. If the
/// variances are estimated, l/σ of a line follows Student's distribution, and the sum is divided by
/// √Σ(l²/σ⁴) instead, because errors of either sign are equally likely whatever the estimates are.
/// The uncertainty of the specimen is not part of the noise, so that a wrong position that makes
/// E'' negative is detected.
///
/// Lines of negative damping are included, although they are not valid; lines with a doubtful
/// branch are not. The p-value is valid for a material without losses; for a material with losses a
/// false alarm is rarer.
///
/// # Errors
/// [`CmodError::NonPhysical`] for the level, [`CmodError::NoLines`] if no line can be checked,
/// [`CmodError::NoNoise`] if a standard error is 0.
pub fn passivity(estimate: &ModulusEstimate, level: f64) -> Result<CheckOutcome, CmodError> {
    let level = check_level(level)?;
    let (mut sum, mut square, mut count) = (0.0, 0.0, 0_usize);
    let mut least = (f64::INFINITY, 0.0, None);
    for line in estimate.telling() {
        let size = line.modulus.norm();
        let error = line.random_error().loss_modulus / size;
        if error <= 0.0 {
            return Err(CmodError::NoNoise {
                what: "standard error of E'' at line",
                index: line.index,
            });
        }
        let value = line.modulus.im / size;
        sum += value / (error * error);
        count += 1;
        let z = value / error;
        let freedom = line.uncertainty.degrees_of_freedom;
        let weight = 1.0 / (error * error);
        square += freedom.map_or(weight, |_| weight * z * z);
        let tail = student_tail_below(z, freedom);
        // far in the tail the p-values of two lines may both underflow to 0
        if (tail, z) < (least.0, least.1) {
            least = (tail, z, Some(line.index));
        }
    }
    if count == 0 {
        return Err(CmodError::NoLines);
    }
    let whole = sum / square.sqrt();
    let p_whole = normal_tail_below(whole);
    let p_single = of_the_least(least.0, count);
    let p_value = of_the_least(p_whole.min(p_single), 2);
    let by_line = p_single < p_whole;
    let statistic = if by_line { -least.1 } else { -whole };
    let outcome = CheckOutcome::judged(Check::Passivity, (statistic, 0.0), p_value, level);
    let lost = outcome.verdict == CheckVerdict::Passed && whole.abs() < 1.0;
    // Losses below the noise are neither positive nor negative.
    Ok(outcome.undecided_if(lost).at(least.2))
}
