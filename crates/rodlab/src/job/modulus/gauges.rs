//! Spectra of gauges, hit by hit, with the noise of each.

use cmod::CmodError;
use cmod::estimate::VarianceFreedom;
use labio::{
    AddedDamping, AveragedSpectra, Record, RestNoise, SpectrumAverager, Window, damping_of_ringing,
    from_rest,
};
use num_complex::Complex64;

use super::method::GaugeSheet;
use crate::RodlabError;
use crate::job::frf::ExponentialWindowSheet;

/// Data for the methods of several gauges.
pub(super) struct Gauges {
    pub(super) frequency_hz: Vec<f64>,
    /// Spectra of each hit and gauge.
    pub(super) tests: Vec<Vec<Vec<Complex64>>>,
    /// Noise of each gauge.
    pub(super) noise: Vec<Vec<f64>>,
    /// Noise at rest, one per gauge.
    rest: Vec<RestNoise>,
    /// Damping of hits that end while the rod rings.
    pub(super) added_damping: Option<AddedDamping>,
}

impl Gauges {
    /// Degrees of freedom of the noise of one gauge: the silence has the same length for all.
    pub(super) fn noise_freedom(&self) -> Result<VarianceFreedom, CmodError> {
        let (first, last) = (self.frequency_hz.first(), self.frequency_hz.last());
        let width = first.zip(last).map_or(0.0, |(first, last)| last - first);
        let Some(rest) = self.rest.first() else {
            return Err(CmodError::NoTests);
        };
        let line = rest.line_degrees_of_freedom();
        let own = rest.degrees_of_freedom(width) / self.frequency_hz.len() as f64;
        VarianceFreedom::new(line, own.min(line))
    }

    /// Damping added to the hits [1/s].
    pub(super) fn decay_rate(&self) -> f64 {
        self.added_damping.map_or(0.0, |window| window.decay_rate())
    }
}

/// Damping added to hits before their transform.
pub(super) enum Damping {
    None,
    /// Stated in the sheet.
    Window(ExponentialWindowSheet),
    /// Damping needed by hits that end while the rod rings, for lines from this frequency on
    /// \[Hz\].
    OfRinging {
        lowest_hz: f64,
    },
}

/// Spectra with phases relative to that of the first gauge: in one hit it is common to all gauges,
/// and no method needs it.
pub(super) fn of_hits(
    hits: &[&Record],
    gauges: &[GaugeSheet],
    silent: Option<usize>,
    damping: &Damping,
) -> Result<Gauges, RodlabError> {
    let Some(silent) = silent else {
        return Err(RodlabError::request(
            "source.silent",
            "missing",
            "how long each hit's record is silent before the blow: the weights of the gauges are from their noise there",
        ));
    };
    let transforming = |error| RodlabError::step("the spectra of a hit", error);
    let channels: Vec<&str> = gauges.iter().map(|gauge| gauge.channel.as_str()).collect();
    let added_damping = match damping {
        Damping::None => Ok(None),
        Damping::Window(window) => {
            let cut = hits.first().map_or(0.0, |hit| {
                (hit.n_samples().saturating_sub(silent)) as f64 / hit.sampling_rate_hz()
            });
            window.over(cut).map(Some)
        }
        Damping::OfRinging { lowest_hz } => damping_of_ringing(hits, &channels, silent, *lowest_hz),
    }
    .map_err(|error| RodlabError::step("source.exponential_window", error))?;
    let mut frequency_hz = Vec::new();
    let mut duration = 0.0;
    let mut tests = Vec::with_capacity(hits.len());
    for hit in hits {
        let cut;
        let (hit, spectra) = match added_damping {
            None => (*hit, AveragedSpectra::of([*hit], Window::Rectangular)),
            Some(window) => {
                cut = from_rest(hit, silent).map_err(transforming)?;
                let mut averager = SpectrumAverager::for_records_like(&cut, Window::Rectangular)
                    .and_then(|averager| averager.with_exponential_window(window))
                    .map_err(transforming)?;
                averager.add(&cut).map_err(transforming)?;
                (&cut, averager.spectra())
            }
        };
        let spectra = spectra.map_err(transforming)?;
        let first = gauges.first().map_or("", |gauge| gauge.channel.as_str());
        let energy = spectra.auto(first).map_err(transforming)?;
        let mut test = Vec::with_capacity(gauges.len());
        for gauge in gauges {
            let mut lines = spectra.cross(first, &gauge.channel).map_err(transforming)?;
            for (line, energy) in lines.iter_mut().zip(&energy) {
                *line /= energy.sqrt();
            }
            test.push(lines);
        }
        tests.push(test);
        frequency_hz = spectra.frequency_hz().to_vec();
        duration = hit.duration();
    }
    let mut noise = Vec::with_capacity(gauges.len());
    let mut rests = Vec::with_capacity(gauges.len());
    for gauge in gauges {
        let rest = RestNoise::before(hits, &gauge.channel, silent)
            .map_err(|error| RodlabError::step("source.silent", error))?;
        let rate = hits.first().map_or(f64::NAN, |hit| hit.sampling_rate_hz());
        let at = |f: &f64| match added_damping {
            None => rest.amplitude_at(*f, duration),
            Some(window) => rest.damped_amplitude_at(*f, window, duration, silent as f64 / rate),
        };
        noise.push(frequency_hz.iter().map(at).collect());
        rests.push(rest);
    }
    Ok(Gauges {
        frequency_hz,
        tests,
        noise,
        rest: rests,
        added_damping,
    })
}
