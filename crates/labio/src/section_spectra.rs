//! Spectra of several channels, hit by hit, with the noise of each channel.
//!
//! Theory: `docs/theory/one-shot.md`.

use num_complex::Complex64;

use crate::error::too_few_averages;
use crate::ratio::{DegreesOfFreedom, keep};
use crate::{
    AddedDamping, AveragedSpectra, LabioError, Record, RestNoise, SensorError, SpectrumAverager,
    Window, from_rest,
};

/// Spectra of channels at several sections, for every hit, with their noise.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SectionSpectra {
    /// Frequencies \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Spectra of the channels in each hit, `(n_hits, n_channels, n_lines)`, with phases relative
    /// to that of the first channel; this reference is common to all channels of a hit.
    pub tests: Vec<Vec<Vec<Complex64>>>,
    /// Root-mean-square noise of the lines of each channel, `(n_channels, n_lines)`.
    pub noise: Vec<Vec<f64>>,
    /// Damping added to all channels before the transform.
    pub added_damping: Option<AddedDamping>,
    /// Errors of each sensor, which all lines share.
    pub sensors: Vec<SensorError>,
    /// Noise at rest, one per channel.
    rest: Vec<RestNoise>,
}

impl SectionSpectra {
    /// Returns the spectra of `channels` in `hits`, with the noise found from their first
    /// `n_silent` samples. With `added_damping`, the hits start at the end of their silence and are
    /// damped ([`damping_of_ringing`](crate::damping_of_ringing)).
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewAverages`] without a hit or without a channel; the errors of
    /// [`RestNoise::before`], [`from_rest`] and [`AveragedSpectra::of`].
    pub fn of_hits(
        hits: &[&Record],
        channels: &[&str],
        n_silent: usize,
        added_damping: Option<AddedDamping>,
    ) -> Result<Self, LabioError> {
        let (Some(hit), Some(first)) = (hits.first(), channels.first()) else {
            return too_few_averages("the spectra of sections", hits.len().min(channels.len()), 1);
        };
        let mut frequency_hz = Vec::new();
        let mut duration = 0.0;
        let mut tests = Vec::with_capacity(hits.len());
        for hit in hits {
            let (transformed, spectra) = match added_damping {
                None => (
                    hit.duration(),
                    AveragedSpectra::of([*hit], Window::Rectangular)?,
                ),
                Some(window) => {
                    let cut = from_rest(hit, n_silent)?;
                    let averager = SpectrumAverager::for_records_like(&cut, Window::Rectangular)?;
                    let mut averager = averager.with_exponential_window(window)?;
                    averager.add(&cut)?;
                    (cut.duration(), averager.spectra()?)
                }
            };
            let energy = spectra.auto(first)?;
            let mut test = Vec::with_capacity(channels.len());
            for channel in channels {
                let mut lines = spectra.cross(first, channel)?;
                for (line, energy) in lines.iter_mut().zip(&energy) {
                    *line /= energy.sqrt();
                }
                test.push(lines);
            }
            tests.push(test);
            frequency_hz = spectra.frequency_hz().to_vec();
            duration = transformed;
        }
        let silence = n_silent as f64 / hit.sampling_rate_hz();
        let mut noise = Vec::with_capacity(channels.len());
        let mut rests = Vec::with_capacity(channels.len());
        for channel in channels {
            let rest = RestNoise::before(hits, channel, n_silent)?;
            let at = |f: &f64| match added_damping {
                None => rest.amplitude_at(*f, duration),
                Some(window) => rest.damped_amplitude_at(*f, window, duration, silence),
            };
            noise.push(frequency_hz.iter().map(at).collect());
            rests.push(rest);
        }
        let sensors = channels.iter().map(|channel| hit.sensor_error(channel));
        Ok(Self {
            frequency_hz,
            tests,
            noise,
            added_damping,
            sensors: sensors.collect::<Result<_, _>>()?,
            rest: rests,
        })
    }

    /// Degrees of freedom of the noise of a channel. They are the same for all channels, because
    /// the silence is equally long in each of them.
    #[must_use]
    pub fn noise_freedom(&self) -> DegreesOfFreedom {
        let (first, last) = (self.frequency_hz.first(), self.frequency_hz.last());
        let width = first.zip(last).map_or(0.0, |(first, last)| last - first);
        let (line, of_band) = self.rest.first().map_or((0.0, 0.0), |rest| {
            (
                rest.line_degrees_of_freedom(),
                rest.degrees_of_freedom(width),
            )
        });
        let own = of_band / self.frequency_hz.len().max(1) as f64;
        DegreesOfFreedom {
            line,
            own: own.min(line),
        }
    }

    /// Damping added to the hits \[1/s\].
    #[must_use]
    pub fn decay_rate(&self) -> f64 {
        self.added_damping.map_or(0.0, |window| window.decay_rate())
    }

    /// Keeps the lines `from..to`.
    pub fn keep(&mut self, from: usize, to: usize) {
        keep(&mut self.frequency_hz, from, to);
        for spectrum in self.tests.iter_mut().flatten() {
            keep(spectrum, from, to);
        }
        for noise in &mut self.noise {
            keep(noise, from, to);
        }
    }
}
