//! A frequency response from hits.

use labio::{
    AddedDamping, AveragedSpectra, Estimator, ForceWindow, Quantity, Record, SpectrumAverager,
    Window,
};
use serde::Deserialize;

use crate::hits::{FoundHits, HitsSheet, expect_independent, expect_noise};
use crate::job::Surroundings;
use crate::outcome::Setting;
use crate::records::{Records, expect_quantity};
use crate::sheet::{Exact, Ratio, Time};
use crate::{Outcome, RodlabError};

/// Hits with a force and a response.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HitsSource {
    /// The files, and what their channels are.
    pub records: Records,
    /// Which hits of the records are averaged.
    #[serde(default)]
    pub hits: HitsSheet,
    /// Channel of the force, as `"hammer"`.
    pub force: String,
    /// Channel of the response, as `"face"`.
    pub response: String,
    /// How the response is formed of the averaged spectra; by default `H1`, for noise on the response.
    #[serde(default)]
    pub estimator: Option<EstimatorSheet>,
    /// Lets the force through while the hammer touches, and nothing else.
    #[serde(default)]
    pub force_window: Option<ForceWindowSheet>,
    /// Exponential window on both channels, by its weight at the end of a hit, as `"1 %"`.
    #[serde(default)]
    pub exponential_window: Option<Exact<Ratio>>,
}

/// How a response is formed of averaged spectra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum EstimatorSheet {
    /// Cross-spectrum over the auto-spectrum of the force.
    #[default]
    H1,
    /// Auto-spectrum of the response over the cross-spectrum.
    H2,
    /// Geometric mean of the two.
    Hv,
}

impl EstimatorSheet {
    /// As `labio` calls it.
    #[must_use]
    pub fn estimator(self) -> Estimator {
        match self {
            Self::H1 => Estimator::H1,
            Self::H2 => Estimator::H2,
            Self::Hv => Estimator::Hv,
        }
    }
}

/// A window on the force: 1 from `start` to `end`, falling to 0 over `taper` on either side. Times count from the first sample of the hit.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceWindowSheet {
    /// Begin of the flat part, as `"8 ms"`.
    pub start: Exact<Time>,
    /// End of the flat part, as `"14 ms"`.
    pub end: Exact<Time>,
    /// Length of either edge, as `"1 ms"`.
    pub taper: Exact<Time>,
}

impl HitsSource {
    /// Reads the files, finds the hits and judges them; `outcome` is told of files, settings, warnings and every decision.
    ///
    /// # Errors
    ///
    /// [`RodlabError`] with the place below `field`: files, channels, and a response that is no motion.
    pub fn read(
        &self,
        around: &Surroundings<'_>,
        field: &str,
        outcome: &mut Outcome,
    ) -> Result<FoundHits, RodlabError> {
        let loaded = self
            .records
            .load(around.folder, &format!("{field}.records"))?;
        if let Some(first) = loaded.records.first() {
            let record = &first.record;
            expect_quantity(
                record,
                &self.force,
                Quantity::Force,
                &format!("{field}.force"),
            )?;
            let known = record.channels().iter().find(|c| c.name() == self.response);
            let place = format!("{field}.response");
            match known.map(labio::Channel::quantity) {
                Some(Quantity::Acceleration | Quantity::Velocity | Quantity::Displacement) => {}
                Some(other) => {
                    return Err(RodlabError::request(
                        place,
                        format!("`{}`, a channel of {}", self.response, other.name()),
                        "a channel of acceleration, velocity or displacement",
                    ));
                }
                // names the channels there are
                None => {
                    expect_quantity(record, &self.response, Quantity::Acceleration, &place)?;
                }
            }
        }
        outcome.inputs.extend(loaded.inputs);
        outcome.settings.extend(loaded.settings);
        outcome.warnings.extend(loaded.warnings);
        outcome.log.extend(loaded.left_out);
        let found = self
            .hits
            .find(loaded.records, &self.force, &format!("{field}.hits"))?;
        outcome.settings.extend(found.settings().iter().cloned());
        outcome.settings.extend(self.settings(field));
        outcome.log.extend(found.log());
        for doubt in expect_independent(&[&found], &[&self.force, &self.response])? {
            outcome.doubt(doubt);
        }
        Ok(found)
    }

    fn settings(&self, field: &str) -> Vec<Setting> {
        let say = |name: &str, value: String, by_default: bool| Setting {
            name: format!("{field}.{name}"),
            value,
            by_default,
        };
        vec![
            say("force", self.force.clone(), false),
            say("response", self.response.clone(), false),
            say(
                "estimator",
                format!("{:?}", self.estimator.unwrap_or_default()),
                self.estimator.is_none(),
            ),
            say(
                "force_window",
                self.force_window
                    .as_ref()
                    .map_or("none".to_owned(), |window| {
                        format!(
                            "{} to {}, edges of {}",
                            window.start, window.end, window.taper
                        )
                    }),
                self.force_window.is_none(),
            ),
            say(
                "exponential_window",
                self.exponential_window
                    .as_ref()
                    .map_or("none".to_owned(), |weight| format!("{weight} at the end")),
                self.exponential_window.is_none(),
            ),
        ]
    }

    /// The averaged spectra of `hits`, of which there is at least one.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] with what `labio` says of hits and windows; [`RodlabError::NoNoise`] for several hits without noise.
    pub fn spectra<'a>(
        &self,
        hits: impl IntoIterator<Item = &'a Record>,
        around: &Surroundings<'_>,
        field: &str,
    ) -> Result<AveragedSpectra, RodlabError> {
        let averaging = |error| RodlabError::step(format!("{field}, averaging hits"), error);
        let mut hits = hits.into_iter().peekable();
        let Some(first) = hits.peek() else {
            return AveragedSpectra::of([], Window::Rectangular).map_err(averaging);
        };
        let duration = first.duration();
        let mut averager =
            SpectrumAverager::for_records_like(first, Window::Rectangular).map_err(averaging)?;
        if let Some(window) = &self.force_window {
            let place = |error| RodlabError::step(format!("{field}.force_window"), error);
            let gate = ForceWindow::new(window.start.si(), window.end.si(), window.taper.si())
                .map_err(place)?;
            averager = averager
                .with_force_window(&self.force, gate)
                .map_err(place)?;
        }
        if let Some(weight) = &self.exponential_window {
            let place = |error| RodlabError::step(format!("{field}.exponential_window"), error);
            let damping = AddedDamping::to_end_weight(weight.si(), duration).map_err(place)?;
            averager = averager.with_exponential_window(damping).map_err(place)?;
        }
        for hit in hits {
            around.go_on()?;
            averager.add(hit).map_err(averaging)?;
        }
        let spectra = averager.spectra().map_err(averaging)?;
        expect_noise(&spectra, (&self.force, &self.response), field)?;
        Ok(spectra)
    }

    /// Relative standard uncertainty that the sensor chains of `hit` give to the whole response.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Step`] for a channel that is not there.
    pub fn calibration(&self, hit: &Record, field: &str) -> Result<f64, RodlabError> {
        let mut calibration: f64 = 0.0;
        for channel in [&self.force, &self.response] {
            let chain = hit
                .chain(channel)
                .map_err(|error| RodlabError::step(field, error))?;
            calibration =
                calibration.hypot(chain.map_or(0.0, labio::SensorChain::relative_uncertainty));
        }
        Ok(calibration)
    }
}
