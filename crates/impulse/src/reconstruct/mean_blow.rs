//! Mean shape of the forces of blows.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::fourier;

/// Number of points per sample: linear interpolation between them has an error of 1/2000 of the curvature per sample.
const FINER: usize = 16;

/// Mean of these spectra over records of `n_samples` samples, each moved to the time of the one with the greatest energy.
pub(super) fn of(spectra: &[Vec<Complex64>], n_samples: usize) -> Vec<Complex64> {
    let energy =
        |spectrum: &[Complex64]| -> f64 { spectrum.iter().map(|line| line.norm_sqr()).sum() };
    let hardest = spectra
        .iter()
        .max_by(|a, b| energy(a).total_cmp(&energy(b)))
        .map_or(&[][..], Vec::as_slice);
    let mut sum = vec![Complex64::ZERO; hardest.len()];
    for spectrum in spectra {
        let later = delay(hardest, spectrum, n_samples);
        for (sum, line) in sum.iter_mut().zip(delayed(spectrum, -later, n_samples)) {
            *sum += line / spectra.len() as f64;
        }
    }
    sum
}

/// Delay of `other` after `reference` in fractional samples: vertex of the parabola through the largest values of their correlation.
#[allow(
    clippy::indexing_slicing,
    reason = "places in the period are taken modulo it"
)]
fn delay(reference: &[Complex64], other: &[Complex64], n_samples: usize) -> f64 {
    let pairs = reference.iter().zip(other);
    let lines: Vec<Complex64> = pairs.map(|(a, b)| a.conj() * b).collect();
    let correlation = fourier::to_samples(&lines, n_samples);
    let best = (0..n_samples)
        .max_by(|a, b| correlation[*a].total_cmp(&correlation[*b]))
        .unwrap_or(0);
    let [before, at, after] =
        [n_samples - 1, 0, 1].map(|step| correlation[(best + step) % n_samples]);
    let bend = before - 2.0 * at + after;
    let part = if bend < 0.0 {
        0.5 * (before - after) / bend
    } else {
        0.0
    };
    let whole = if 2 * best > n_samples {
        best as f64 - n_samples as f64
    } else {
        best as f64
    };
    whole + part
}

/// Delays a spectrum over `n_samples` samples by `samples`.
fn delayed(
    spectrum: &[Complex64],
    samples: f64,
    n_samples: usize,
) -> impl Iterator<Item = Complex64> {
    spectrum.iter().enumerate().map(move |(line, value)| {
        value * Complex64::cis(-TAU * line as f64 * samples / n_samples as f64)
    })
}

/// The mean blow, interpolated between its samples.
pub(super) struct MeanBlow {
    fine: Vec<f64>,
    n_samples: usize,
    /// Position of the largest value.
    peak: f64,
}

#[allow(
    clippy::indexing_slicing,
    reason = "places in the period are taken modulo it"
)]
impl MeanBlow {
    pub(super) fn of(mean: &[Complex64], n_samples: usize) -> Self {
        let mut fine = fourier::to_samples(mean, FINER * n_samples);
        let scale = 1.0 / n_samples as f64;
        fine.iter_mut().for_each(|f| *f *= scale);
        let peak = (0..fine.len())
            .max_by(|a, b| fine[*a].total_cmp(&fine[*b]))
            .unwrap_or(0);
        Self {
            peak: peak as f64 / FINER as f64,
            fine,
            n_samples,
        }
    }

    /// Samples of the blow from `first` on, delayed by `later` samples.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place in the period is not negative and far below 2^52"
    )]
    pub(super) fn samples(&self, first: usize, length: usize, later: f64) -> Vec<f64> {
        let n_fine = self.fine.len();
        (first..first + length)
            .map(|n| {
                let place = (n as f64 - later).rem_euclid(self.n_samples as f64) * FINER as f64;
                let whole = place.floor();
                let index = whole as usize % n_fine;
                let part = place - whole;
                (1.0 - part) * self.fine[index] + part * self.fine[(index + 1) % n_fine]
            })
            .collect()
    }

    /// Position of the largest value.
    pub(super) fn peak(&self) -> f64 {
        self.peak
    }
}
