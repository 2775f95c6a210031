//! The ratio of one shot, with its errors from the silence before it.

use cmod::estimate::VarianceFreedom;
use labio::{AveragedSpectra, ChannelAtRest, Record, RestNoise, ShotRatio, Window};

use super::Ratio;
use crate::RodlabError;

/// One shot, and the record whose spectra are divided: the shot itself, or pulses cut out of it.
pub(in crate::job::modulus) struct Shot<'a> {
    pub(in crate::job::modulus) hit: &'a Record,
    /// Silent samples at its beginning.
    pub(in crate::job::modulus) silent: usize,
    pub(in crate::job::modulus) record: &'a Record,
}

/// A channel of the record, and that of the shot with the same noise.
pub(in crate::job::modulus) struct ShotChannel<'a> {
    pub(in crate::job::modulus) name: &'a str,
    pub(in crate::job::modulus) at_rest: &'a str,
    /// Duration of the noise in the record \[s\].
    pub(in crate::job::modulus) duration: f64,
}

impl Shot<'_> {
    pub(in crate::job::modulus) fn ratio(
        &self,
        numerator: &ShotChannel<'_>,
        denominator: &ShotChannel<'_>,
        lines_per_independent_line: f64,
    ) -> Result<Ratio, RodlabError> {
        let step = |error| RodlabError::step("the ratio of one hit", error);
        let noise = |of: &ShotChannel<'_>| {
            RestNoise::before(&[self.hit], of.at_rest, self.silent)
                .map_err(|error| RodlabError::step("source.silent", error))
        };
        let (above, below) = (noise(numerator)?, noise(denominator)?);
        let spectra = AveragedSpectra::of([self.record], Window::Rectangular).map_err(step)?;
        fn at_rest<'a>(of: &ShotChannel<'a>, noise: &'a RestNoise) -> ChannelAtRest<'a> {
            ChannelAtRest {
                channel: of.name,
                noise,
                duration: of.duration,
            }
        }
        let found = ShotRatio::of(
            &spectra,
            at_rest(numerator, &above),
            at_rest(denominator, &below),
        )
        .map_err(step)?;
        let freedom =
            VarianceFreedom::new(found.line_degrees_of_freedom, found.own_degrees_of_freedom)
                .map_err(|error| RodlabError::step("the ratio of one hit", error))?;
        Ok(Ratio {
            freedom: Some(vec![freedom; found.values.len()]),
            frequency_hz: found.frequency_hz,
            values: found.values,
            variance: found.variance,
            coherence: None,
            averages: None,
            lines_per_independent_line,
            delay: None,
        })
    }
}
