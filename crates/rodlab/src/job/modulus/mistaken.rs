//! Mistakes of the sensors that would explain why hardly any line is valid.

use cmod::ModulusEstimate;
use labio::ResponseRatio;
use num_complex::Complex64;

use super::measured::{Measured, Spectra};
use super::reasons::{lines, n_suitable};
use super::{MethodSheet, ModulusSheet, estimate};

/// Factor by which a mistake has to raise the number of known lines to be named.
const MORE: usize = 3;
/// Fewest lines that have to be known without the mistake.
const FEWEST: usize = 10;

/// A mistake, and what it makes of a measured ratio r.
struct Mistake {
    is: &'static str,
    remedy: &'static str,
    /// The ratio without the mistake and |dr'/dr|.
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

/// Returns a sentence on the mistake of the sensors without which three times as many lines of a
/// two-point measurement, and at least a quarter of them, would be known; `None` if there is none.
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
        // a ratio that has no estimate does not explain the lines
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

/// Number of lines with a known E'.
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
