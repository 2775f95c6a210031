//! Mean shape of the forces of blows.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use num_complex::Complex64;

use crate::fourier;
use crate::interpolation::at_place;

/// Number of points per sample: linear interpolation between them has an error of 1/2000 of the
/// curvature per sample.
const FINER: usize = 16;

/// Share of the largest value above which samples belong to a blow.
const OF_BLOW: f64 = 0.02;

/// Gauss-Newton steps that align a blow with another.
const STEPS: usize = 12;

/// Returns the mean of these spectra over records of `n_samples` samples, and the spectra of the
/// differences of the blows from it. Each blow is moved to the time and scaled to the size of the
/// blow with the greatest energy, and stretched to the geometric mean of the durations: without the
/// stretch, a mean of blows of several durations would be blunter than any of them.
pub(super) fn of(
    spectra: &[Vec<Complex64>],
    n_samples: usize,
) -> (Vec<Complex64>, Vec<Vec<Complex64>>) {
    let energy =
        |spectrum: &[Complex64]| -> f64 { spectrum.iter().map(|line| line.norm_sqr()).sum() };
    let hardest = spectra
        .iter()
        .max_by(|a, b| energy(a).total_cmp(&energy(b)))
        .map_or(&[][..], Vec::as_slice);
    let reference = MeanBlow::of(hardest, n_samples);
    let blows: Vec<MeanBlow> = spectra
        .iter()
        .map(|spectrum| MeanBlow::of(spectrum, n_samples))
        .collect();
    let aligned: Vec<Alignment> = blows.iter().map(|blow| blow.aligned(&reference)).collect();
    let count = blows.len() as f64;
    let middle = aligned.iter().map(|one| one.ln_stretch).sum::<f64>() / count;
    let alike: Vec<Vec<f64>> = blows
        .iter()
        .zip(&aligned)
        .map(|(blow, one)| {
            let stretch = (one.ln_stretch - middle).exp();
            let own = blow.samples((0, n_samples), one.peak, stretch);
            own.into_iter().map(|f| one.size * f).collect()
        })
        .collect();
    let mut mean = vec![0.0; n_samples];
    for own in &alike {
        let pairs = mean.iter_mut().zip(own);
        pairs.for_each(|(sum, value)| *sum += value / count);
    }
    let differences = alike.iter().map(|own| {
        let pairs = own.iter().zip(&mean);
        fourier::to_spectrum(&pairs.map(|(f, mean)| f - mean).collect::<Vec<_>>())
    });
    let differences = differences.collect();
    (fourier::to_spectrum(&mean), differences)
}

/// Factor, place of the largest value, and stretch that make a blow most similar to another.
struct Alignment {
    size: f64,
    peak: f64,
    ln_stretch: f64,
}

/// Samples kept on either side, in addition to a blow and to its own length on either side: filters
/// of recorders ring for fewer samples.
const BESIDE: usize = 64;

/// A blow, interpolated between its samples; zero far from it.
pub(super) struct MeanBlow {
    /// Interpolated points of the kept samples, from sample `first` of the record on.
    fine: Vec<f64>,
    first: usize,
    n_samples: usize,
    /// Samples before and after the largest value that belong to the blow.
    reach: (usize, usize),
    /// Point of the largest value.
    top: usize,
}

#[allow(
    clippy::indexing_slicing,
    reason = "places in the period are taken modulo it"
)]
impl MeanBlow {
    pub(super) fn of(spectrum: &[Complex64], n_samples: usize) -> Self {
        let samples = fourier::to_samples(spectrum, n_samples);
        let largest = (0..n_samples)
            .max_by(|a, b| samples[*a].total_cmp(&samples[*b]))
            .unwrap_or(0);
        let reach = |place: &dyn Fn(usize) -> usize| {
            let limit = OF_BLOW * samples[largest];
            (1..n_samples / 2)
                .take_while(|n| samples[place(*n)] > limit)
                .count()
        };
        let before = reach(&|n| (largest + n_samples - n) % n_samples);
        let after = reach(&|n| (largest + n) % n_samples);
        let whole = 3 * (before + after) + 2 * BESIDE;
        let (ahead, length) = if whole < n_samples {
            (2 * before + after + BESIDE, whole)
        } else {
            (n_samples / 2, n_samples)
        };
        let first = (largest + n_samples - ahead) % n_samples.max(1);
        let mut blow = Self {
            fine: vec![0.0; FINER * length],
            first,
            n_samples,
            reach: (before, after),
            top: 0,
        };
        blow.fine = blow.interpolated(&samples);
        blow.top = (0..blow.fine.len())
            .max_by(|a, b| blow.fine[*a].total_cmp(&blow.fine[*b]))
            .unwrap_or(0);
        blow
    }

    /// Interpolates the kept samples of a record, with [`FINER`] points per sample.
    fn interpolated(&self, samples: &[f64]) -> Vec<f64> {
        let length = self.fine.len() / FINER;
        let kept: Vec<f64> = (self.first..self.first + length)
            .map(|n| samples[n % self.n_samples] / (self.n_samples * length) as f64)
            .collect();
        fourier::to_samples(&fourier::to_spectrum(&kept), FINER * length)
    }

    /// Interpolates the `spectrum` of the difference of a calibration blow from this blow, on the
    /// same time axis.
    pub(super) fn difference(&self, spectrum: &[Complex64]) -> Self {
        let samples = fourier::to_samples(spectrum, self.n_samples);
        Self {
            fine: self.interpolated(&samples),
            ..*self
        }
    }

    /// Returns the derivatives of the blow m, with its largest value 1 at time 0, with respect to
    /// the exponent p of $`m^{1+p}`$, and to the skewness q of $`m(t + q\,t^2/T)`$ with half the
    /// duration T.
    pub(super) fn deformations(&self) -> [Self; 2] {
        let (before, after) = self.reach;
        let of = |value: &dyn Fn(usize) -> f64| Self {
            fine: (0..self.fine.len()).map(value).collect(),
            ..*self
        };
        let largest = self.fine[self.top];
        let exponent = |at: usize| {
            let part = self.fine[at] / largest;
            // for forces that are rounded to zero or ring below it, the limit at zero is taken
            if part > 0.0 {
                self.fine[at] * part.ln()
            } else {
                0.0
            }
        };
        let span = (self.top.saturating_sub(before * FINER) + 1)..self.top + after * FINER;
        let half = 0.5 * ((before + after) * FINER) as f64;
        let skewness = |at: usize| {
            if !span.contains(&at) || at + 1 >= self.fine.len() {
                return 0.0;
            }
            let slope = 0.5 * (self.fine[at + 1] - self.fine[at - 1]);
            let from_top = at as f64 - self.top as f64;
            slope * from_top * from_top / half
        };
        [of(&exponent), of(&skewness)]
    }

    /// Returns the samples from `first` on of the blow with its largest value at sample `peak`,
    /// `stretch` times as long.
    pub(super) fn samples(
        &self,
        (first, length): (usize, usize),
        peak: f64,
        stretch: f64,
    ) -> Vec<f64> {
        let kept = self.fine.len() as f64;
        (first..first + length)
            .map(|n| {
                let from_first = self.peak() - self.first as f64 + (n as f64 - peak) / stretch;
                let place = from_first.rem_euclid(self.n_samples as f64) * FINER as f64;
                if place + 1.0 >= kept {
                    return 0.0;
                }
                at_place(&self.fine, place)
            })
            .collect()
    }

    /// Returns the position of the largest value in samples.
    fn peak(&self) -> f64 {
        self.first as f64 + self.top as f64 / FINER as f64
    }

    /// Returns the first sample and the number of samples of the blow with half its length on
    /// either side.
    fn extent(&self) -> (usize, usize) {
        let (before, after) = self.reach;
        let half = (before + after) / 2 + 1;
        let beside = (self.top / FINER).saturating_sub(before + half);
        (self.first + beside, before + after + 2 * half + 1)
    }

    /// Aligns with `other`, by least squares over place, stretch and size.
    fn aligned(&self, other: &Self) -> Alignment {
        let extent = other.extent();
        let target = other.samples(extent, other.peak(), 1.0);
        let (mut at, mut size) = ([other.peak(), 0.0], 1.0);
        for _ in 0..STEPS {
            let of = |[peak, stretch]: [f64; 2]| self.samples(extent, peak, stretch.exp());
            let by = |index: usize, step: f64| -> Vec<f64> {
                let moved = |step: f64| {
                    let mut moved = at;
                    moved[index] += step;
                    of(moved)
                };
                let (ahead, behind) = (moved(step), moved(-step));
                let pairs = ahead.iter().zip(&behind);
                pairs.map(|(a, b)| (a - b) / (2.0 * step)).collect()
            };
            // the size enters linearly, and the solution gives it directly: derivatives are those
            // of the blow at size 1
            let columns = [of(at), by(0, 0.25), by(1, 0.02)];
            let sum = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
            let matrix = Mat::from_fn(3, 3, |i, j| sum(&columns[i], &columns[j]));
            let side = Mat::from_fn(3, 1, |i, _| sum(&columns[i], &target));
            let Ok(factor) = matrix.llt(Side::Lower) else {
                break;
            };
            let step = factor.solve(&side);
            if step[(0, 0)].is_nan() || step[(0, 0)] <= 0.0 {
                break;
            }
            size = step[(0, 0)];
            at[0] += (step[(1, 0)] / size).clamp(-1.0, 1.0);
            at[1] += (step[(2, 0)] / size).clamp(-0.1, 0.1);
        }
        let [peak, ln_stretch] = at;
        Alignment {
            size,
            peak,
            ln_stretch,
        }
    }
}
