//! Search for the one wave speed that explains the first lines together.
//!
//! The mean logarithm of the misfit is compared at a series of speeds, each with several values of
//! the damping. The worst third of the lines is left out of the mean, to exclude outliers.

use num_complex::Complex64;

use super::BranchDoubt;

/// Factor from a guess to either end of the searched range.
const GUESS_FACTOR: f64 = 1.5;
/// Values of α/k tried: loss factors of about 0, 0.12 and 0.4.
const DAMPING: [f64; 3] = [0.0, 0.06, 0.2];
/// Minimum number of lines for distinguishing speeds without a guess.
const FEWEST_LINES: usize = 8;
/// Difference of mean log misfits below which the data do not distinguish two speeds.
pub(crate) const TOO_CLOSE: f64 = 0.1;

/// Slowness γ/ω of the first lines [s/m], and the doubt about it.
pub(crate) struct Start {
    pub(crate) slowness: Complex64,
    pub(crate) doubt: Option<BranchDoubt>,
}

/// Tried speed with its best damping.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tried {
    /// Mean logarithm of the misfit.
    pub(crate) score: f64,
    /// Speed [m/s].
    pub(crate) speed: f64,
    /// Slowness γ/ω [s/m].
    pub(crate) slowness: Complex64,
}

/// Returns the range of speeds about a guess.
pub(crate) fn about(guess: f64) -> (f64, f64) {
    (guess / GUESS_FACTOR, guess * GUESS_FACTOR)
}

/// Tries the speeds of a range, each by the factor `ratio` above the previous speed; `score_of`
/// returns the score of a slowness.
pub(crate) fn try_speeds(
    (slowest, fastest): (f64, f64),
    ratio: f64,
    mut score_of: impl FnMut(Complex64) -> f64,
) -> Vec<Tried> {
    let mut tried = Vec::new();
    let mut speed = slowest;
    while speed <= fastest {
        let mut best = Tried {
            score: f64::INFINITY,
            speed,
            slowness: Complex64::ZERO,
        };
        for damping in DAMPING {
            let slowness = Complex64::new(damping, 1.0) / speed;
            let score = score_of(slowness);
            if score < best.score {
                (best.score, best.slowness) = (score, slowness);
            }
        }
        tried.push(best);
        let next = speed * ratio;
        // for a guess at the limits of the range of `f64` the speed stops growing, or overflows
        if next <= speed || next == f64::INFINITY {
            break;
        }
        speed = next;
    }
    tried
}

/// Returns the tried speeds at which the score is finite and has a minimum.
pub(crate) fn minima(tried: &[Tried]) -> impl Iterator<Item = &Tried> {
    let score = move |index: Option<usize>| index.and_then(|i| tried.get(i)).map(|t| t.score);
    let is_minimum = move |(index, this): &(usize, &Tried)| {
        let lower = |other: Option<f64>| other.is_none_or(|other| this.score <= other);
        let (before, after) = (score(index.checked_sub(1)), score(Some(index + 1)));
        this.score.is_finite() && lower(before) && lower(after)
    };
    let found = tried.iter().enumerate().filter(is_minimum);
    found.map(|(_, this)| this)
}

/// Returns the mean over the better two thirds of the `misfits`; infinite if there are none.
pub(crate) fn mean_of_better(misfits: &mut [f64]) -> f64 {
    misfits.sort_by(f64::total_cmp);
    let kept = (2 * misfits.len()).div_ceil(3);
    let better = misfits.get(..kept).unwrap_or_default();
    if better.is_empty() {
        f64::INFINITY
    } else {
        better.iter().sum::<f64>() / kept as f64
    }
}

/// Returns the doubt about a speed that was found without a guess from `n_lines` lines.
pub(crate) fn few_lines(n_lines: usize) -> Option<BranchDoubt> {
    (n_lines < FEWEST_LINES).then_some(BranchDoubt::FewLines {
        found: n_lines,
        expected: FEWEST_LINES,
    })
}
