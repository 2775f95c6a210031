//! The ratio of two channels of one hit, with its error from the noise at rest.
//!
//! Theory: `docs/theory/one-shot.md`.

use num_complex::Complex64;

use super::{AveragedSpectra, RestNoise};
use crate::LabioError;

/// A denominator whose energy is less than so many times that of its noise has no ratio with an
/// error to first order.
const LEAST_ENERGY: f64 = 10.0;

/// A channel with its noise at rest, which the spectra have for `duration` \[s\]: that of the
/// record, or of the pulse that was cut out of it.
#[derive(Debug, Clone, Copy)]
pub struct ChannelAtRest<'a> {
    /// Name of the channel.
    pub channel: &'a str,
    /// Its noise before the blow.
    pub noise: &'a RestNoise,
    /// So long it is in the spectra \[s\].
    pub duration: f64,
}

/// The ratio of two channels of one hit; all arrays have one entry per line.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ShotRatio {
    /// Frequencies \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Numerator by denominator.
    pub values: Vec<Complex64>,
    /// E|δr|², of real and imaginary part together; infinite where the denominator hardly exceeds
    /// its noise.
    pub variance: Vec<f64>,
    /// Degrees of freedom of the variance of one line.
    pub line_degrees_of_freedom: f64,
    /// Their share for one line of all of them.
    pub own_degrees_of_freedom: f64,
}

impl ShotRatio {
    /// The ratio of `numerator` by `denominator` in the `spectra` of one hit, with
    ///
    /// ```math
    /// \mathrm{E}|\delta r|^2 = \frac{S_y + |r|^2S_x}{|x|^2},
    /// ```
    ///
    /// S being the energies of the noise that the silence before the blow promises. A coherence of
    /// one hit is 1 and says nothing.
    ///
    /// # Validity
    ///
    /// Noise that is stationary and independent of the signal: not that of a converter which hardly
    /// moves at rest, nor of a disturbance that comes with the blow.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] for spectra of more than one hit,
    /// [`LabioError::UnknownChannel`].
    ///
    /// # Examples
    ///
    /// ```
    /// use labio::{AveragedSpectra, Channel, ChannelAtRest, Provenance, Quantity, Record, RestNoise, ShotRatio, Window};
    /// use ndarray::Array2;
    ///
    /// # fn main() -> Result<(), labio::LabioError> {
    /// // a half sine and twice that, after a silence of alternating least digits
    /// let samples = Array2::from_shape_fn((2, 256), |(channel, n)| {
    ///     let t = n as f64 - 128.0;
    ///     let pulse = if (0.0..16.0).contains(&t) { (std::f64::consts::PI * t / 16.0).sin() } else { 0.0 };
    ///     (1 + channel) as f64 * pulse + 1e-3 * if n * (n + channel) % 3 == 0 { 1.0 } else { -0.5 }
    /// });
    /// let channels = vec![Channel::new("near", Quantity::Strain)?, Channel::new("far", Quantity::Strain)?];
    /// let hit = Record::new(samples, 1e5, 0.0, channels, Provenance::computed("example"))?;
    /// let spectra = AveragedSpectra::of([&hit], Window::Rectangular)?;
    /// let noise = ["near", "far"].map(|channel| RestNoise::before(&[&hit], channel, 128));
    /// let [near, far] = noise;
    /// let (near, far) = (near?, far?);
    /// let at_rest = |channel, noise| ChannelAtRest { channel, noise, duration: hit.duration() };
    /// let ratio = ShotRatio::of(&spectra, at_rest("far", &far), at_rest("near", &near))?;
    /// assert!((ratio.values[5] - 2.0).norm() < 0.01 && ratio.variance[5] < 1e-4);
    /// # Ok(())
    /// # }
    /// ```
    pub fn of(
        spectra: &AveragedSpectra,
        numerator: ChannelAtRest<'_>,
        denominator: ChannelAtRest<'_>,
    ) -> Result<Self, LabioError> {
        if spectra.n_averages() != 1 {
            return Err(LabioError::CountMismatch {
                what: "hits behind the ratio of one shot",
                found: spectra.n_averages(),
                expected: 1,
            });
        }
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
        let fewest = |of: &dyn Fn(&RestNoise) -> f64| {
            noises.map(of).into_iter().fold(f64::INFINITY, f64::min)
        };
        let line = fewest(&RestNoise::line_degrees_of_freedom);
        let bandwidth = frequency_hz.last().copied().unwrap_or(0.0);
        let of_band = fewest(&|noise| noise.degrees_of_freedom(bandwidth));
        let own = (of_band / frequency_hz.len().max(1) as f64).min(line);
        Ok(Self {
            frequency_hz,
            values,
            variance,
            line_degrees_of_freedom: line,
            own_degrees_of_freedom: own,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, Provenance, Quantity, Record, Window};
    use ndarray::Array2;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Of 300 shots with noise on both channels the mean of |δr|² by what is stated is 1.
    #[test]
    fn the_silence_tells_the_error_of_one_ratio() {
        let mut random = ChaCha8Rng::seed_from_u64(19);
        let lines = [3, 10, 30];
        let mut sums = [0.0; 3];
        for _ in 0..300 {
            let samples = Array2::from_shape_fn((2, 1024), |(channel, n)| {
                let t = n as f64 - 512.0;
                let pulse = if (0.0..12.0).contains(&t) {
                    1.0 - (t / 6.0 - 1.0).powi(2)
                } else {
                    0.0
                };
                (1.0 + channel as f64) * pulse + 0.02 * (random.random::<f64>() - 0.5)
            });
            let channels = vec![
                Channel::new("x", Quantity::Strain).unwrap(),
                Channel::new("y", Quantity::Strain).unwrap(),
            ];
            let hit =
                Record::new(samples, 1e4, 0.0, channels, Provenance::computed("test")).unwrap();
            let spectra = AveragedSpectra::of([&hit], Window::Rectangular).unwrap();
            let [x, y] = ["x", "y"].map(|name| RestNoise::before(&[&hit], name, 500).unwrap());
            let at_rest = |channel, noise| ChannelAtRest {
                channel,
                noise,
                duration: hit.duration(),
            };
            let ratio = ShotRatio::of(&spectra, at_rest("y", &y), at_rest("x", &x)).unwrap();
            for (sum, line) in sums.iter_mut().zip(lines) {
                *sum += (ratio.values[line] - 2.0).norm_sqr() / ratio.variance[line] / 300.0;
            }
        }
        for mean in sums {
            // 300 exponentially distributed squares: 6 %, and 2 % of a silence of 15 segments;
            // three of them
            assert!((mean - 1.0).abs() < 0.2, "{mean}");
        }
    }

    #[test]
    fn several_hits_have_a_coherence() {
        let samples = Array2::from_shape_fn((2, 64), |(_, n)| (n as f64).sin());
        let channels = vec![
            Channel::new("x", Quantity::Strain).unwrap(),
            Channel::new("y", Quantity::Strain).unwrap(),
        ];
        let hit = Record::new(samples, 1e4, 0.0, channels, Provenance::computed("test")).unwrap();
        let spectra = AveragedSpectra::of([&hit, &hit], Window::Rectangular).unwrap();
        let noise = RestNoise::before(&[&hit], "x", 32).unwrap();
        let x = ChannelAtRest {
            channel: "x",
            noise: &noise,
            duration: 1.0,
        };
        assert!(matches!(
            ShotRatio::of(&spectra, x, x),
            Err(LabioError::CountMismatch { found: 2, .. })
        ));
    }
}
