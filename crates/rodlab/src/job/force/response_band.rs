//! Effect of the end of a band on a force from a response.

use impulse::ReconstructedForce;
use rodwave::fourier::RealFourier;

use super::response_problem::Problem;
use crate::Outcome;
use crate::digits::significant;
use crate::sheet::BandSheet;

/// Fraction of the largest spectral amplitude that may be left at the end of the band. In virtual
/// impacts on rods, with 9 % left the peak was too low by up to 7 standard errors in half of the
/// records; with 5 % left it was not too low in any record.
const LEFT: f64 = 0.07;

/// Part of the band, at its end, over which the amplitude is averaged.
const END: f64 = 0.1;

/// Verdict on a peak in a stated band.
pub(super) fn named(problem: &Problem<'_>, of_error: &str) -> String {
    match &problem.sheet.band {
        Some(_) => format!("peak of the force in the band; {of_error}"),
        None => of_error.to_owned(),
    }
}

/// Warns if the spectrum of the force has not fallen at the end of the stated band: the part above
/// the band is missing, and the errors do not contain it.
pub(super) fn warn_of_end(
    problem: &Problem<'_>,
    solved: &ReconstructedForce,
    outcome: &mut Outcome,
) {
    let Some(band) = &problem.sheet.band else {
        return;
    };
    let left = left_at_end(solved.history.force(), problem.sampling_rate_hz, band);
    if let Some(left) = left.filter(|left| *left > LEFT) {
        outcome.warn(format!(
            "The force still has {} % of its largest spectral amplitude at the end of the band, {}: its part above the band is not in the result, and its peak may be too low by several standard errors. Extend `band`.",
            significant(100.0 * left, 2),
            band.to
        ));
    }
}

/// Returns the mean spectral amplitude of `force` over the last tenth of the band, relative to the
/// largest in the band; `None` for a band without lines.
fn left_at_end(force: &[f64], sampling_rate_hz: f64, band: &BandSheet) -> Option<f64> {
    let (from, to) = (band.from.si(), band.to.si());
    let mut transform = RealFourier::new(force.len());
    transform.samples().copy_from_slice(force);
    let spacing = sampling_rate_hz / force.len() as f64;
    let lines = transform.forward().iter().enumerate();
    let lines = lines.map(|(line, value)| (line as f64 * spacing, value.norm()));
    let (mut largest, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    for (frequency, amplitude) in lines.filter(|(f, _)| (from..=to).contains(f)) {
        largest = largest.max(amplitude);
        if frequency >= to - END * (to - from) {
            sum += amplitude;
            count += 1.0;
        }
    }
    (count > 0.0 && largest > 0.0).then(|| sum / count / largest)
}
