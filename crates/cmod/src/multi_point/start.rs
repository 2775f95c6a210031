//! Starting value of the wave number: one wave speed for all first lines together.
//!
//! On a single line V(γ) has many minima. However, only one wave speed, which is nearly constant
//! over the first wavelengths, explains many lines at once. The speeds are compared over the first
//! lines, over which the number of wavelengths between the outermost gauges grows by one. The best
//! speeds are compared again on more lines.

use num_complex::Complex64;

use super::MOST_NOISE;
use super::projection::Projection;
use super::spectra::{GaugeSpectra, WhiteLine};
use crate::branch::wave_speed::{
    Start, TOO_CLOSE, Tried, about, few_lines, mean_of_better, minima, try_speeds,
};
use crate::branch::{BranchDoubt, FASTEST_WAVE, SLOWEST_WAVE};
use crate::complex_frequency::ComplexFrequency;

/// Ratio of neighbouring speeds: at one wavelength between the outermost gauges the phase then
/// differs by a third of a radian.
const SPEED_RATIO: f64 = 1.055;
/// Number of lines compared at each speed, first at all speeds (`LINES`), then at the best speeds
/// (`MORE_LINES`).
const LINES: usize = 16;
const MORE_LINES: usize = 64;
/// Number of minima over the speed that are compared on [`MORE_LINES`].
const FINALISTS: usize = 8;
/// Misfit allowed because one speed and one damping are used for all lines, relative to the root
/// mean square of the gauges.
const MODEL_ERROR: f64 = 0.02;
/// Logarithm of the ratio above which two speeds are distinct.
const DISTINCT: f64 = 0.3;

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
    let mut search = Search {
        line: WhiteLine::for_spectra(spectra, projection.n_gauges()),
        added_damping,
        projection,
        spectra,
        usable,
        aperture,
        misfits: Vec::with_capacity(MORE_LINES),
    };
    let range = guess.map_or((SLOWEST_WAVE, FASTEST_WAVE), about);
    let tried = try_speeds(range, SPEED_RATIO, |slowness| search.score(slowness, LINES));
    let mut scores: Vec<Tried> = minima(&tried).copied().collect();
    scores.sort_by(|a, b| a.score.total_cmp(&b.score));
    scores.truncate(FINALISTS);
    for tried in &mut scores {
        tried.score = search.score(tried.slowness, MORE_LINES);
    }
    let best_of = |a: &&Tried, b: &&Tried| a.score.total_cmp(&b.score);
    let chosen = scores.iter().min_by(best_of)?;
    let few = few_lines(usable.len()).filter(|_| guess.is_none());
    let doubt = few.or_else(|| {
        let rivals = scores.iter();
        rivals
            .filter(|tried| (tried.speed / chosen.speed).ln().abs() > DISTINCT)
            .min_by(best_of)
            .filter(|rival| rival.score < chosen.score + TOO_CLOSE)
            .map(|rival| BranchDoubt::SeveralSpeeds {
                chosen: chosen.speed,
                other: rival.speed,
            })
    });
    chosen.score.is_finite().then_some(Start {
        slowness: chosen.slowness,
        doubt,
    })
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
        mean_of_better(&mut self.misfits)
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
