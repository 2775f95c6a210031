//! Mistakes in the sensors, such as a reversed or interchanged channel, that would explain why few
//! lines are valid.

use cmod::ModulusEstimate;
use labio::ResponseRatio;
use num_complex::Complex64;

use super::measured::{Measured, Spectra};
use super::reasons::{lines, n_suitable};
use super::{MethodSheet, ModulusSheet, estimate};

/// Least factor by which the correction of a mistake must raise the number of known lines for the
/// mistake to be reported.
const MORE: usize = 3;
/// Least number of known lines after the correction of a mistake.
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

/// Returns a sentence about a mistake in the sensors of a two-point measurement. Its correction
/// would make E' known on three times as many lines, and on at least a quarter of those with a
/// suitable wavelength. Returns `None` if there is no such mistake.
pub(super) fn sensors(
    sheet: &ModulusSheet,
    measured: &Measured,
    spectra: &Spectra,
    found: &ModulusEstimate,
) -> Option<String> {
    let (MethodSheet::TwoPoint { .. }, Spectra::Ratio(ratio)) = (&sheet.method, spectra) else {
        return None;
    };
    let n_found = known(found);
    if 2 * n_found >= n_suitable(found) {
        return None;
    }
    for mistake in &MISTAKES {
        let corrected = Spectra::Ratio(without(mistake, ratio));
        // if the corrected ratio gives no estimate, this mistake does not explain the lines
        let Ok(would_be) = estimate::plain(sheet, measured, &corrected) else {
            continue;
        };
        let n_known = known(&would_be);
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

/// Returns the number of lines with a known E'.
fn known(estimate: &ModulusEstimate) -> usize {
    let lines = estimate.lines().iter();
    lines
        .filter(|line| line.validity.storage_modulus_is_valid())
        .count()
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
