//! Mistakes in the sensors: a wrong unit, or a reversed or interchanged channel that would explain
//! why few lines are valid.

use cmod::ModulusEstimate;
use labio::ResponseRatio;
use num_complex::Complex64;

use super::measured::{Measured, Spectra};
use super::reasons::{known, lines, n_suitable};
use super::{MethodSheet, ModulusSheet, estimate};
use crate::digits::significant;
use crate::median::upper_median;

/// Smallest factor by which the correction of a mistake must raise the number of known lines for
/// the mistake to be reported.
const MORE: usize = 3;
/// Minimum number of known lines after the correction of a mistake.
const FEWEST: usize = 10;

/// A mistake, with its remedy and the correction of a measured ratio r.
struct Mistake {
    is: &'static str,
    remedy: &'static str,
    /// Function that returns the corrected ratio r' and |dr'/dr|.
    corrected: fn(Complex64) -> (Complex64, f64),
}

const MISTAKES: [Mistake; 3] = [
    Mistake {
        is: "one of the two sensors pointed the other way",
        remedy: "state `inverted` for its channel",
        corrected: |ratio| (-ratio, 1.0),
    },
    Mistake {
        is: "the channels of the two ends were interchanged",
        remedy: "interchange `impacted_end` and `free_end`",
        corrected: |ratio| (1.0 / ratio, 1.0 / ratio.norm_sqr()),
    },
    Mistake {
        is: "the channels of the two ends were interchanged and one of the sensors pointed the other way",
        remedy: "interchange `impacted_end` and `free_end`, and state `inverted` for one channel",
        corrected: |ratio| (-1.0 / ratio, 1.0 / ratio.norm_sqr()),
    },
];

/// Number of the lowest lines from which a wrong unit is recognised.
const LOWEST: usize = 5;
/// Highest frequency of the first line at which a wrong unit is recognised, as a multiple of the
/// line spacing. A rod that is at rest at the end of the record moves almost as a rigid body at
/// these frequencies.
const HIGHEST_FIRST: f64 = 10.0;
/// Largest relative error of the lines from which a wrong unit is recognised.
const MOST_ERROR: f64 = 0.2;
/// Factors between units that are easily confused, each with its description.
const FACTORS: [(f64, &str); 2] = [
    (9.80665, "9.81 (g instead of m/s2) or 10 (a gain)"),
    (1000.0, "1000"),
];

/// Returns a sentence about a unit that is wrong by one of [`FACTORS`]: both ends of a rigid body
/// have the same motion, and a rod is hardly deformed on the lowest lines.
fn wrong_unit(impacted: &str, free: &str, ratio: &ResponseRatio) -> Option<String> {
    let [first, second, ..] = ratio.frequency_hz.as_slice() else {
        return None;
    };
    if *first > HIGHEST_FIRST * (second - first) {
        return None;
    }
    let lines = ratio.values.iter().zip(&ratio.variance).take(LOWEST);
    let is_rigid = |(value, variance): &(&Complex64, &f64)| {
        let is_known = variance.sqrt() < MOST_ERROR * value.norm();
        is_known && value.re.abs() > 0.9 * value.norm()
    };
    let sizes: Vec<f64> = lines
        .filter(is_rigid)
        .map(|(value, _)| value.norm())
        .collect();
    if sizes.len() < LOWEST {
        return None;
    }
    let size = upper_median(sizes)?;
    // the struck end of an elastic rod moves less than the free end below the first resonance
    let is_factor = |factor: f64| (0.8..1.1).contains(&(size / factor));
    let (_, factor) = FACTORS
        .iter()
        .find(|(factor, _)| is_factor(*factor) || is_factor(1.0 / factor))?;
    Some(format!(
        "On the lowest lines, on which a rod moves as a rigid body, `{impacted}` moves {} times as much as `{free}`: the unit or the sensitivity of \
         one of them is probably wrong by a factor of {factor}.",
        significant(size, 2)
    ))
}

/// Returns a sentence about a mistake in the sensors of a two-point measurement: a wrong unit, or a
/// mistake whose correction would make E' known on three times as many lines, and on at least a
/// quarter of those with a suitable wavelength. Returns `None` if there is no such mistake.
pub(super) fn sensors(
    sheet: &ModulusSheet,
    measured: &Measured,
    spectra: &Spectra,
    found: &ModulusEstimate,
) -> Option<String> {
    let (
        MethodSheet::TwoPoint {
            impacted_end,
            free_end,
            ..
        },
        Spectra::Ratio(ratio),
    ) = (&sheet.method, spectra)
    else {
        return None;
    };
    let wrong = wrong_unit(impacted_end, free_end, ratio);
    if wrong.is_some() {
        return wrong;
    }
    let n_found = known(found).len();
    if 2 * n_found >= n_suitable(found) {
        return None;
    }
    for mistake in &MISTAKES {
        let corrected = Spectra::Ratio(without(mistake, ratio));
        // if the corrected ratio gives no estimate, this mistake does not explain the lines
        let Ok(would_be) = estimate::plain(sheet, measured, &corrected) else {
            continue;
        };
        let n_known = known(&would_be).len();
        if n_known >= FEWEST.max(MORE * n_found) && 4 * n_known >= n_suitable(&would_be) {
            return Some(format!(
                "E' would be known on {} instead of {n_found} if {}: {}.",
                lines(n_known),
                mistake.is,
                mistake.remedy
            ));
        }
    }
    None
}

fn without(mistake: &Mistake, ratio: &ResponseRatio) -> ResponseRatio {
    let mut corrected = ratio.clone();
    for (value, variance) in corrected.values.iter_mut().zip(&mut corrected.variance) {
        let (without, slope) = (mistake.corrected)(*value);
        *value = without;
        *variance *= slope * slope;
    }
    corrected
}
