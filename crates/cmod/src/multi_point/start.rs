//! Starting value of the wave number: one wave speed for all first lines together.
//!
//! On a single line V(γ) has many minima. However, only one wave speed, which is nearly constant
//! over the first wavelengths, explains many lines at once. From a series of speeds, the search
//! chooses the speed that minimises the misfit, averaged over the first lines, over which the
//! number of wavelengths between the outermost gauges grows by one. The logarithm of the misfit is averaged without the worst third of
//! the lines, to exclude outliers. The best speeds are compared again on more lines.

use num_complex::Complex64;

use super::MOST_NOISE;
use super::projection::Projection;
use super::spectra::{GaugeSpectra, WhiteLine};
use crate::branch::BranchDoubt;
use crate::complex_frequency::ComplexFrequency;

/// Speeds tried without a guess [m/s], from soft rubber to beyond any solid in a rod.
const SLOWEST: f64 = 20.0;
const FASTEST: f64 = 20e3;
/// Factor from a guess to either end of the searched range.
const GUESS_FACTOR: f64 = 1.5;
/// Ratio of neighbouring speeds: at one wavelength between the outermost gauges the phase then
/// differs by a third of a radian.
const SPEED_RATIO: f64 = 1.055;
/// Values of α/k tried: loss factors of about 0, 0.12 and 0.4.
const DAMPING: [f64; 3] = [0.0, 0.06, 0.2];
/// Number of lines compared at each speed, first at all speeds (`LINES`), then at the best speeds
/// (`MORE_LINES`).
const LINES: usize = 16;
const MORE_LINES: usize = 64;
/// Number of minima over the speed that are compared on [`MORE_LINES`].
const FINALISTS: usize = 8;
/// Minimum number of lines for distinguishing speeds without a guess.
const FEWEST_LINES: usize = 8;
/// Misfit allowed because one speed and one damping are used for all lines, relative to the root
/// mean square of the gauges.
const MODEL_ERROR: f64 = 0.02;
/// Logarithm of the ratio above which two speeds are distinct.
const DISTINCT: f64 = 0.3;
/// Difference of mean log misfits below which the data do not distinguish two speeds.
const TOO_CLOSE: f64 = 0.1;

/// Slowness γ/ω of the first lines [s/m], and the doubt about it.
pub(super) struct Start {
    pub(super) slowness: Complex64,
    pub(super) doubt: Option<BranchDoubt>,
}

/// Finds the wave speed by comparing speeds over the lines with the indices `usable`; `None` if
/// there is no line.
pub(super) fn wave_speed(
    projection: &mut Projection,
    spectra: &GaugeSpectra<'_>,
    usable: &[usize],
    aperture: f64,
    guess: Option<f64>,
    added_damping: f64,
) -> Option<Start> {
    let (slowest, fastest) = guess.map_or((SLOWEST, FASTEST), |speed| {
        (speed / GUESS_FACTOR, speed * GUESS_FACTOR)
    });
    let mut search = Search {
        line: WhiteLine::for_spectra(spectra, projection.n_gauges()),
        added_damping,
        projection,
        spectra,
        usable,
        aperture,
        misfits: Vec::with_capacity(MORE_LINES),
    };
    let mut speed = slowest;
    let mut tried = Vec::new();
    while speed <= fastest {
        let mut best = (f64::INFINITY, speed, Complex64::ZERO);
        for damping in DAMPING {
            let slowness = Complex64::new(damping, 1.0) / speed;
            let score = search.score(slowness, LINES);
            if score < best.0 {
                best = (score, speed, slowness);
            }
        }
        tried.push(best);
        let next = speed * SPEED_RATIO;
        // for a guess at the limits of the range of `f64` the speed stops growing, or overflows
        if next <= speed || next == f64::INFINITY {
            break;
        }
        speed = next;
    }
    let mut scores = minima(&tried);
    scores.sort_by(|a, b| a.0.total_cmp(&b.0));
    scores.truncate(FINALISTS);
    for (score, _, slowness) in &mut scores {
        *score = search.score(*slowness, MORE_LINES);
    }
    let chosen = scores.iter().min_by(|a, b| a.0.total_cmp(&b.0)).copied()?;
    let rival = scores
        .iter()
        .filter(|(_, speed, _)| (speed / chosen.1).ln().abs() > DISTINCT)
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let doubt = if guess.is_none() && usable.len() < FEWEST_LINES {
        Some(BranchDoubt::FewLines {
            found: usable.len(),
            expected: FEWEST_LINES,
        })
    } else {
        rival
            .filter(|(score, _, _)| *score < chosen.0 + TOO_CLOSE)
            .map(|(_, other, _)| BranchDoubt::SeveralSpeeds {
                chosen: chosen.1,
                other: *other,
            })
    };
    chosen.0.is_finite().then_some(Start {
        slowness: chosen.2,
        doubt,
    })
}

/// Score, speed [m/s] and slowness [s/m] of a tried speed.
type Tried = (f64, f64, Complex64);

/// Returns the tried speeds at which the score is finite and has a minimum.
fn minima(tried: &[Tried]) -> Vec<Tried> {
    let score = |index: Option<usize>| index.and_then(|i| tried.get(i)).map(|t| t.0);
    let is_minimum = |(index, this): &(usize, &Tried)| {
        let lower = |other: Option<f64>| other.is_none_or(|other| this.0 <= other);
        this.0.is_finite() && lower(score(index.checked_sub(1))) && lower(score(Some(index + 1)))
    };
    let found = tried.iter().enumerate().filter(is_minimum);
    found.map(|(_, this)| *this).collect()
}

/// Data for judging a speed.
struct Search<'a> {
    projection: &'a mut Projection,
    spectra: &'a GaugeSpectra<'a>,
    usable: &'a [usize],
    aperture: f64,
    line: WhiteLine,
    added_damping: f64,
    misfits: Vec<f64>,
}

impl Search<'_> {
    /// Returns the mean logarithm of the misfit at one slowness, relative to the noise and
    /// [`MODEL_ERROR`], over the better two thirds of at most `count` lines.
    fn score(&mut self, slowness: Complex64, count: usize) -> f64 {
        let frequencies = self.spectra.frequency_hz;
        let frequency = |index: &usize| frequencies.get(*index).copied().unwrap_or(0.0);
        let lowest = self.usable.first().map_or(0.0, frequency);
        let highest = lowest + 1.0 / (slowness.im * self.aperture);
        let below = self
            .usable
            .partition_point(|index| frequency(index) <= highest);
        let within = self
            .usable
            .get(..below.max(LINES / 2).min(self.usable.len()))
            .unwrap_or_default();
        let stride = within.len().div_ceil(count).max(1);
        self.misfits.clear();
        for index in within.iter().rev().step_by(stride) {
            // pure noise is compatible with any speed
            if self.line.load(self.spectra, *index).is_err()
                || self.line.noise_to_signal() > MOST_NOISE
            {
                continue;
            }
            let gamma =
                slowness * ComplexFrequency::new(frequency(index), self.added_damping).omega();
            let Some(misfit) = self.projection.misfit(gamma, &self.line) else {
                return f64::INFINITY;
            };
            let line = &self.line;
            let freedom = (line.n_tests() * (line.weights.len() - 2)) as f64;
            let expected = line.variance + MODEL_ERROR * MODEL_ERROR * line.mean_power();
            self.misfits.push((misfit / freedom / expected).ln_1p());
        }
        self.misfits.sort_by(f64::total_cmp);
        let kept = (2 * self.misfits.len()).div_ceil(3);
        let better = self.misfits.get(..kept).unwrap_or_default();
        if better.is_empty() {
            f64::INFINITY
        } else {
            better.iter().sum::<f64>() / kept as f64
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const POSITIONS: [f64; 3] = [0.0, 0.08, 0.2];
    const SPEED: f64 = 1234.0;

    fn start_of((first_hz, step_hz): (f64, f64), n_lines: u32) -> Start {
        let frequency_hz: Vec<f64> = (0..n_lines)
            .map(|j| first_hz + step_hz * f64::from(j))
            .collect();
        let spectrum = |x: &f64| {
            let value = |f: &f64| {
                let gamma = Complex64::new(0.03, 1.0) * (TAU * f / SPEED);
                (-gamma * x).exp() - 0.6 * (gamma * (x - 0.5)).exp()
            };
            frequency_hz.iter().map(value).collect()
        };
        let test: Vec<Vec<Complex64>> = POSITIONS.iter().map(spectrum).collect();
        let usable: Vec<usize> = (0..frequency_hz.len()).collect();
        wave_speed(
            &mut Projection::new(&POSITIONS),
            &GaugeSpectra {
                frequency_hz: &frequency_hz,
                tests: &[&test],
                noise: &vec![vec![1e-3; frequency_hz.len()]; 3],
            },
            &usable,
            0.2,
            None,
            0.0,
        )
        .unwrap()
    }

    /// The phase over 0.2 m at the first line is 0.02 to 4 rad. With lines 1 Hz apart, any number
    /// of speeds explains a few neighbouring lines.
    #[test]
    fn the_speed_is_found_wherever_the_lines_begin_and_however_close_they_are() {
        for first_hz in [20.0, 500.0, 725.0, 1000.0, 4000.0] {
            for (step_hz, n_lines) in [(20.0, 300), (10.0, 600), (1.0, 6000)] {
                let start = start_of((first_hz, step_hz), n_lines);
                let case = format!("from {first_hz} Hz, {step_hz} Hz apart");
                assert!(start.doubt.is_none(), "{case}: {:?}", start.doubt);
                let speed = start.slowness.im.recip();
                assert!((speed / SPEED - 1.0).abs() < 0.06, "{case}: {speed}");
            }
        }
    }

    #[test]
    fn few_lines_are_not_trusted() {
        let doubt = start_of((1000.0, 20.0), 5).doubt.unwrap();
        assert!(doubt.is_ambiguous());
        assert_eq!(
            doubt.to_string(),
            "5 lines are too few to find the wave speed, expected 8 or a guess of the wave speed"
        );
    }
}
