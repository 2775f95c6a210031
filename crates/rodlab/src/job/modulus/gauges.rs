//! Spectra of gauges, hit by hit, with the noise of each.

use cmod::CmodError;
use cmod::estimate::VarianceFreedom;
use labio::{AveragedSpectra, Record, RestNoise, Window};
use num_complex::Complex64;

use super::method::GaugeSheet;
use crate::RodlabError;

/// What the methods of several gauges take.
pub(super) struct Gauges {
    pub(super) frequency_hz: Vec<f64>,
    /// Of each hit, of each gauge.
    pub(super) tests: Vec<Vec<Vec<Complex64>>>,
    /// Of each gauge.
    pub(super) noise: Vec<Vec<f64>>,
    /// What the noise was read from, a gauge each.
    rest: Vec<RestNoise>,
}

impl Gauges {
    /// Degrees of freedom of the noise of one gauge: the silence is as long for all.
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
}

/// The phase of each line is counted from that of the first gauge: of one hit it is common to all gauges, and no method asks for it.
pub(super) fn of_hits(
    hits: &[&Record],
    gauges: &[GaugeSheet],
    silent: Option<usize>,
) -> Result<Gauges, RodlabError> {
    let Some(silent) = silent else {
        return Err(RodlabError::request(
            "source.silent",
            "missing",
            "how long each hit's record is silent before the blow: the weights of the gauges are from their noise there",
        ));
    };
    let transforming = |error| RodlabError::step("the spectra of a hit", error);
    let mut frequency_hz = Vec::new();
    let mut duration = 0.0;
    let mut tests = Vec::with_capacity(hits.len());
    for hit in hits {
        let spectra = AveragedSpectra::of([*hit], Window::Rectangular).map_err(transforming)?;
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
        let at = |f: &f64| rest.amplitude_at(*f, duration);
        noise.push(frequency_hz.iter().map(at).collect());
        rests.push(rest);
    }
    Ok(Gauges {
        frequency_hz,
        tests,
        noise,
        rest: rests,
    })
}
