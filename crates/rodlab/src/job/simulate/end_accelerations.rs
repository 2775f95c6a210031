//! Test of paper A: accelerations of both ends of a rod that is struck at one end.

use std::f64::consts::PI;

use labio::Quantity;
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::{EndAccelerationTest, Specimen};
use serde::Deserialize;

use super::blows::{BlowsSheet, Recorded};
use super::instrument::{History, InstrumentSheet, Sensed};
use super::truth::{self, Truth};
use super::{Evaluation, Made, Request, StruckRod, analytic};
use crate::digits::short;
use crate::job::JobContext;
use crate::sheet::{AddedMass, Duration, Exact, Length, Ratio, plausible};
use crate::{InStep, RodlabError};

const STRUCK: &str = "struck end";
const FREE: &str = "free end";
const FIELD: &str = "experiment: EndAccelerations";

/// A rod with accelerometers on both ends.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndAccelerationsSheet {
    /// Name of the material.
    pub material: String,
    /// Length, such as `"799 mm"`.
    pub length: Exact<Length>,
    /// Diameter, such as `"15.8 mm"`.
    pub diameter: Exact<Length>,
    /// Mass of each accelerometer, such as `"2.9 gram"`; none by default.
    pub accelerometer_mass: Option<Exact<AddedMass>>,
    /// The hammer hits on the struck end.
    pub blows: BlowsSheet,
    /// Standard uncertainties that the evaluating sheet states; none by default. The virtual rod and
    /// its sensors have no such errors.
    #[serde(default)]
    pub stated_errors: StatedErrorsSheet,
}

/// Standard uncertainties in the sheet that evaluates a virtual test.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StatedErrorsSheet {
    /// Standard uncertainty of the length, such as `"0.3 mm"`.
    pub length: Option<Exact<Length>>,
    /// Relative standard uncertainty of the density, such as `"0.1 %"`.
    pub density: Option<Exact<Ratio>>,
    /// Relative standard uncertainty of the gain of each channel.
    pub gain: Option<Exact<Ratio>>,
    /// Standard uncertainty of the delay of each channel, such as `"1 us"`.
    pub time_skew: Option<Exact<Duration>>,
}

impl StatedErrorsSheet {
    fn of_length(&self) -> String {
        let error = self.length.as_ref();
        error.map_or_else(String::new, |error| format!(" ± {error}"))
    }

    fn of_density(&self) -> String {
        let error = self.density.as_ref();
        error.map_or_else(String::new, |error| format!(" ± {} %", percent(error)))
    }

    fn of_channel(&self) -> String {
        let mut fields = String::new();
        if let Some(error) = &self.gain {
            fields += &format!(", gain: \"1 ± {} %\"", percent(error));
        }
        if let Some(error) = &self.time_skew {
            fields += &format!(", time_skew: \"0 us ± {error}\"");
        }
        fields
    }
}

fn percent(error: &Exact<Ratio>) -> String {
    short(100.0 * error.si())
}

impl EndAccelerationsSheet {
    pub(super) fn make(
        &self,
        request: &Request<'_>,
        instrument: &InstrumentSheet,
        context: &JobContext<'_>,
    ) -> Result<Made, RodlabError> {
        self.blows.check(&format!("{FIELD}.blows"), instrument, 2)?;
        let medium = analytic(request, &self.material, &format!("{FIELD}.material"))?;
        let mass = self.accelerometer_mass.as_ref().map_or(0.0, Exact::si);
        if let Some(stated) = &self.accelerometer_mass {
            let section = 0.25 * PI * self.diameter.si().powi(2);
            let specimen = medium.density() * section * self.length.si();
            let field = format!("{FIELD}.accelerometer_mass");
            plausible::end_mass(stated, mass, specimen, field)?;
        }
        let specimen = Specimen {
            section: Circle::of_diameter(self.diameter.si())
                .in_step(FIELD)?
                .into(),
            length: self.length.si(),
            accelerometer_mass: mass,
        };
        let pulse = self.blows.pulse(&format!("{FIELD}.blows"))?;
        let synthesis = instrument.synthesis(FIELD)?;
        let test = EndAccelerationTest::analytic(&medium, &specimen).in_step(FIELD)?;
        context.has_read_all(&[], &[])?;

        context.progress.begins("hits", self.blows.hits);
        let exact = test.record(pulse.as_ref(), &synthesis).in_step(FIELD)?;
        let history = History {
            generator: exact.generator.to_owned(),
            begins: exact.start,
            step: exact.interval,
            channels: vec![
                Sensed::new(STRUCK, Quantity::Acceleration, exact.impacted_end),
                Sensed::new(FREE, Quantity::Acceleration, exact.free_end),
            ],
        };
        let recorded = self.blows.record(&history, instrument, request, context)?;
        let mut truth = Truth::default();
        truth.add("length", self.length.si(), "m");
        truth.add("diameter", self.diameter.si(), "m");
        truth.add("density", medium.density(), "kg/m3");
        truth.add("accelerometer mass", mass, "kg");
        let band = instrument.passes_up_to_hz();
        Ok(Made {
            truth,
            tables: vec![truth::modulus(&medium, 0.01 * band, band)],
            figures: Vec::new(),
            in_words: format!(
                "{} on a rod of {} by {}, accelerations of both ends",
                self.blows.in_words(),
                self.length,
                self.diameter
            ),
            evaluations: vec![self.evaluation(request, &recorded, instrument, medium.density())],
            recorded: Some(recorded),
        })
    }

    fn evaluation(
        &self,
        request: &Request<'_>,
        recorded: &Recorded,
        instrument: &InstrumentSheet,
        density: f64,
    ) -> Evaluation {
        let mass = self
            .accelerometer_mass
            .as_ref()
            .map(|mass| format!("\n        accelerometer_mass: \"{mass}\","))
            .unwrap_or_default();
        let rod = StruckRod {
            length: format!("{}{}", self.length, self.stated_errors.of_length()),
            diameter: &self.diameter,
            density,
            density_error: self.stated_errors.of_density(),
            more: &mass,
            of_channel: self.stated_errors.of_channel(),
            method: &format!(r#"TwoPoint(impacted_end: "{STRUCK}", free_end: "{FREE}")"#),
            silence: "the filter reaches ahead of the impact",
        };
        rod.evaluation(request, recorded, instrument)
    }
}
