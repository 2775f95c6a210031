//! Error of an averaged ratio from a converter whose step exceeds the noise of the channel.
//!
//! Rounding errors are independent noise if the noise before the converter exceeds a third of its
//! step. With less noise, they are harmonics of the decaying motion, the same in every hit; the
//! scatter between hits does not show them, and more hits do not reduce them. They are estimated by
//! rounding the samples again, to twice the step: the ratio changes by the difference of two
//! rounding errors, of which the new one is twice as large and arises in an earlier part of the
//! decay.

use num_complex::Complex64;

use crate::quantization::step_above_noise;
use crate::{AveragedSpectra, LabioError, Record, Window, channel};

/// Number of first samples that are treated as rest if the silence of the hits is not known.
const FEWEST_AT_REST: usize = 16;
/// Number of lines on each side over which the squared change is averaged.
const NEIGHBOURS: usize = 5;
/// Squared change divided by the squared error: the squared error with twice the step is four times
/// as large, and the two errors are independent.
const CHANGE_OVER_ERROR: f64 = 5.0;

/// Sums over the hits at one line.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    change: Complex64,
    squares: f64,
    energy: f64,
}

/// Returns E|δΨ|² of every line due to the part of the rounding error that all hits share; `None`
/// unless the step exceeds the noise before the impact in at least two hits.
pub(super) fn shared_variance(
    hits: &[&Record],
    n_silent: Option<usize>,
    ratio: &[Complex64],
    [numerator, denominator]: [&str; 2],
) -> Result<Option<Vec<f64>>, LabioError> {
    let n_rest = n_silent.unwrap_or(FEWEST_AT_REST);
    let mut pairs = Vec::with_capacity(hits.len());
    for hit in hits {
        if let Some(rounded) = coarser(hit, n_rest, [numerator, denominator])? {
            pairs.push((*hit, rounded));
        }
    }
    if pairs.len() < 2 {
        return Ok(None);
    }
    let n_hits = pairs.len() as f64;
    let mut sums = vec![Sums::default(); ratio.len()];
    for (hit, rounded) in &pairs {
        // residual of one hit about the mean ratio
        let rest_of = |hit: &Record| -> Result<_, LabioError> {
            let spectra = AveragedSpectra::of([hit], Window::Rectangular)?;
            let below = spectra.auto(denominator)?;
            let cross = spectra.cross(denominator, numerator)?.into_iter();
            let rest = cross.zip(ratio).zip(&below).map(|((x, r), a)| x - r * a);
            Ok((rest.collect::<Vec<_>>(), below))
        };
        let ((fine, energy), (coarse, _)) = (rest_of(hit)?, rest_of(rounded)?);
        let lines = coarse.iter().zip(&fine).zip(energy);
        for (sums, ((coarse, fine), energy)) in sums.iter_mut().zip(lines) {
            let change = coarse - fine;
            sums.change += change;
            sums.squares += change.norm_sqr();
            sums.energy += energy;
        }
    }
    let shared = sums.iter().map(|of| {
        // part of the mean change that the scatter between the hits does not explain
        let mean = of.change.norm_sqr();
        let scatter = (of.squares - mean / n_hits).max(0.0) * n_hits / (n_hits - 1.0);
        (mean - scatter) / (of.energy * of.energy)
    });
    let shared: Vec<f64> = shared.collect();
    let mean_about = |line: usize| {
        let near = line.saturating_sub(NEIGHBOURS)..(line + NEIGHBOURS + 1).min(shared.len());
        let n_near = near.len() as f64;
        let near = near.filter_map(|line| shared.get(line).filter(|value| value.is_finite()));
        near.sum::<f64>().max(0.0) / (CHANGE_OVER_ERROR * n_near)
    };
    Ok(Some((0..shared.len()).map(mean_about).collect()))
}

/// Returns the record with the channels called `names` rounded to twice the step of their
/// converters, where the step exceeds the noise of the first `n_rest` samples; `None` if it does so
/// in neither channel.
fn coarser(hit: &Record, n_rest: usize, names: [&str; 2]) -> Result<Option<Record>, LabioError> {
    let mut coarse = None;
    for name in names {
        let (index, _) = channel::find(hit.channels(), name)?;
        let row = hit.channel(name)?;
        let (Some(step), Some(&level)) = (step_above_noise(row, n_rest), row.first()) else {
            continue;
        };
        let samples = coarse.get_or_insert_with(|| hit.samples().to_owned());
        for sample in samples.row_mut(index) {
            let steps = ((*sample - level) / step).round();
            *sample = level + 2.0 * step * (steps / 2.0).round_ties_even();
        }
    }
    let record = coarse.map(|samples| {
        Record::new(
            samples,
            hit.sampling_rate_hz(),
            hit.start_time(),
            hit.channels().to_vec(),
            hit.provenance().clone(),
        )
    });
    record.transpose()
}
