//! Settings of a virtual test, stated in the sheet or taken by default.

use super::blows::BlowsSheet;
use super::hopkinson_bars::HopkinsonBarsSheet;
use super::impacted_rod::{ImpactedRodSheet, SensorsSheet, StrikerSheet};
use super::{ExperimentSheet, SimulateSheet, USUAL_OUTPUT, USUAL_SEED};
use crate::outcome::Setting;
use crate::sheet::Exact;

/// A list of settings, with the names of the sheet.
struct Listed(Vec<Setting>);

impl Listed {
    fn say(&mut self, name: &str, value: impl ToString) {
        self.put(name, value.to_string(), false);
    }

    fn put(&mut self, name: &str, value: String, by_default: bool) {
        self.0.push(Setting {
            name: name.to_owned(),
            value,
            by_default,
        });
    }

    fn either<K>(&mut self, name: &str, stated: Option<&Exact<K>>, otherwise: &str) {
        let value = stated.map_or_else(|| otherwise.to_owned(), Exact::to_string);
        self.put(name, value, stated.is_none());
    }

    fn blows(&mut self, blows: &BlowsSheet) {
        self.say("experiment.blows.hits", blows.hits);
        self.say("experiment.blows.peak", &blows.peak);
        self.say("experiment.blows.duration", &blows.duration);
        let shape = format!("{:?}", blows.shape);
        self.put(
            "experiment.blows.shape",
            shape,
            blows.shape == super::ShapeSheet::default(),
        );
        self.either("experiment.blows.scatter", blows.scatter.as_ref(), "5 %");
    }

    fn impacted_rod(&mut self, test: &ImpactedRodSheet) {
        self.say("experiment.length", &test.length);
        self.say("experiment.diameter", &test.diameter);
        self.say("experiment.density", &test.density);
        self.say("experiment.modulus", &test.modulus);
        self.say("experiment.law", format!("{:?}", test.law));
        self.either("experiment.spring", test.spring.as_ref(), "none");
        self.say("experiment.section_distance", &test.section_distance);
        self.striker(&test.striker);
        let velocities: Vec<String> = test.velocities.iter().map(ToString::to_string).collect();
        self.say("experiment.velocities", velocities.join(", "));
        match &test.sensors {
            SensorsSheet::Velocity => {
                self.put("experiment.sensors", "velocities".to_owned(), true);
            }
            SensorsSheet::Displacement { range } => {
                self.say("experiment.sensors", format!("displacements up to {range}"));
            }
        }
        let usual = "a hundredth of the shortest wave that the recorder passes";
        self.either("experiment.cell", test.cell.as_ref(), usual);
    }

    fn striker(&mut self, striker: &StrikerSheet) {
        self.say(
            "experiment.striker",
            format!(
                "{} by {}, {}, {}",
                striker.length, striker.diameter, striker.density, striker.modulus
            ),
        );
    }

    fn hopkinson_bars(&mut self, test: &HopkinsonBarsSheet) {
        self.striker(&test.striker);
        self.say("experiment.velocity", &test.velocity);
        for (side, bar) in [
            ("incident", &test.incident),
            ("transmitted", &test.transmitted),
        ] {
            let gauges: Vec<String> = bar.gauges.iter().map(ToString::to_string).collect();
            self.say(
                &format!("experiment.{side}"),
                format!(
                    "{}, {} by {}, gauges at {}",
                    bar.material,
                    bar.length,
                    bar.diameter,
                    gauges.join(", ")
                ),
            );
        }
        let specimen = &test.specimen;
        self.say(
            "experiment.specimen",
            format!(
                "{} by {}, {}, {}, {:?}",
                specimen.length,
                specimen.diameter,
                specimen.density,
                specimen.modulus,
                specimen.law
            ),
        );
        let hardening = specimen.hardening.as_ref();
        self.either("experiment.specimen.hardening", hardening, "none");
    }

    fn experiment(&mut self, experiment: &ExperimentSheet) {
        match experiment {
            ExperimentSheet::EndAccelerations(test) => {
                self.say("experiment", "EndAccelerations");
                self.say("experiment.material", &test.material);
                self.say("experiment.length", &test.length);
                self.say("experiment.diameter", &test.diameter);
                let mass = test.accelerometer_mass.as_ref();
                self.either("experiment.accelerometer_mass", mass, "none");
                self.blows(&test.blows);
            }
            ExperimentSheet::StrainsInFrame(test) => {
                self.say("experiment", "StrainsInFrame");
                self.say("experiment.material", &test.material);
                self.say("experiment.length", &test.length);
                self.say("experiment.diameter", &test.diameter);
                let gauges: Vec<String> = test.gauges.iter().map(ToString::to_string).collect();
                self.say("experiment.gauges", gauges.join(", "));
                for (end, support) in [
                    ("struck_end", &test.struck_end),
                    ("other_end", &test.other_end),
                ] {
                    let place = format!("experiment.{end}");
                    self.put(&place, support.in_words(), support.is_absent());
                }
                self.blows(&test.blows);
            }
            ExperimentSheet::CreepRecovery(test) => {
                self.say("experiment", "CreepRecovery");
                self.say("experiment.series_modulus", &test.series_modulus);
                self.say("experiment.parallel_modulus", &test.parallel_modulus);
                self.say("experiment.exponent", &test.exponent);
                self.say("experiment.coefficient", test.coefficient);
                self.say("experiment.virgin_loss_factor", &test.virgin_loss_factor);
                self.say("experiment.frequency", &test.frequency);
                self.say("experiment.error", &test.error);
            }
            ExperimentSheet::ImpactedRod(test) => {
                self.say("experiment", "ImpactedRod");
                self.impacted_rod(test);
            }
            ExperimentSheet::HammerOnBody(test) => {
                self.say("experiment", "HammerOnBody");
                self.blows(&test.blows);
            }
            ExperimentSheet::HopkinsonBars(test) => {
                self.say("experiment", "HopkinsonBars");
                self.hopkinson_bars(test);
            }
        }
    }
}

pub(super) fn of(sheet: &SimulateSheet) -> Vec<Setting> {
    let mut listed = Listed(Vec::new());
    listed.experiment(&sheet.experiment);
    let output = sheet.output.as_deref();
    let name = output.unwrap_or(USUAL_OUTPUT).to_owned();
    listed.put("output", name, output.is_none());
    let seed = sheet.seed.unwrap_or(USUAL_SEED);
    listed.put("seed", seed.to_string(), sheet.seed.is_none());
    if let Some(instrument) = &sheet.instrument {
        listed.0.extend(instrument.settings());
    }
    listed.0
}
