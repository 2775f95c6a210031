//! The ratio of two channels of one hit, with its error from the noise at rest.

use super::{DegreesOfFreedom, ResponseRatio};
use crate::{AveragedSpectra, LabioError, RestNoise};

/// Ratio of energy to noise energy of the denominator below which the error of the ratio cannot be
/// computed to first order; the variance is then infinite.
const LEAST_ENERGY: f64 = 10.0;

/// A channel with its noise at rest, which the spectra contain for `duration` \[s\]: the duration
/// of the record, or that of the pulse that was cut out of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct ChannelAtRest<'a> {
    /// Name of the channel.
    pub(super) channel: &'a str,
    /// Noise of the channel before the impact.
    pub(super) noise: &'a RestNoise,
    /// Duration of the noise in the spectra \[s\].
    pub(super) duration: f64,
}

/// Returns the ratio of `numerator` to `denominator` in the `spectra` of one hit.
pub(super) fn ratio(
    spectra: &AveragedSpectra,
    numerator: ChannelAtRest<'_>,
    denominator: ChannelAtRest<'_>,
) -> Result<ResponseRatio, LabioError> {
    let frequency_hz = spectra.frequency_hz().to_vec();
    let cross = spectra.cross(denominator.channel, numerator.channel)?;
    let energy = spectra.auto(denominator.channel)?;
    let mut values = Vec::with_capacity(cross.len());
    let mut variance = Vec::with_capacity(cross.len());
    for ((f, cross), energy) in frequency_hz.iter().zip(&cross).zip(&energy) {
        let value = cross / energy;
        let noise = |of: &ChannelAtRest<'_>| of.noise.amplitude_at(*f, of.duration).powi(2);
        let below = noise(&denominator);
        values.push(value);
        variance.push(if *energy < LEAST_ENERGY * below {
            f64::INFINITY
        } else {
            (noise(&numerator) + value.norm_sqr() * below) / energy
        });
    }
    let noises = [numerator.noise, denominator.noise];
    let fewest =
        |of: &dyn Fn(&RestNoise) -> f64| noises.map(of).into_iter().fold(f64::INFINITY, f64::min);
    let line = fewest(&RestNoise::line_degrees_of_freedom);
    let bandwidth = frequency_hz.last().copied().unwrap_or(0.0);
    let of_band = fewest(&|noise| noise.degrees_of_freedom(bandwidth));
    let own = (of_band / frequency_hz.len().max(1) as f64).min(line);
    Ok(ResponseRatio {
        freedom: Some(vec![DegreesOfFreedom { line, own }; values.len()]),
        ..ResponseRatio::from_variance(frequency_hz, values, variance)?
    })
}
