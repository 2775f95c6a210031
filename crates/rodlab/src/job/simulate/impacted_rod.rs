//! Test of paper D: a rod with an inelastic law, struck by a projectile at one or several
//! velocities.

mod evaluation;
mod sections;

use labio::Quantity;
use rodwave::InelasticRod;
use rodwave::impact::{ImpactHistory, ImpactTest, Striker};
use rodwave::inelastic::InelasticLaw;
use rodwave::lumped;
use serde::Deserialize;

use super::blows::{Recorded, peaks};
use super::inelastic_law::{InelasticLawSheet, with_law};
use super::instrument::{History, InstrumentSheet, Sensed};
use super::truth::Truth;
use super::{Made, Request};
use crate::job::JobContext;
use crate::outcome::Rows;
use crate::sheet::{Density, Exact, Length, Pressure, Ratio, Velocity, plausible};
use crate::{InStep, RodlabError};

const FIELD: &str = "experiment: ImpactedRod";
const NEAR: &str = "near end";
const FREE: &str = "free end";
/// Default number of cells per wavelength of the shortest wave that the recorder passes. The error
/// of the chain is then a few thousandths of the amplitude of the wave front.
const CELLS_PER_WAVE: f64 = 100.0;

/// Largest product of the numbers of cells and steps in all tests of a sheet; it limits the
/// computing time to some minutes.
const MOST_CELL_STEPS: f64 = 4e9;

/// A rod struck by a projectile.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImpactedRodSheet {
    /// Length of the rod, such as `"402 mm"`.
    pub length: Exact<Length>,
    /// Diameter, such as `"16 mm"`.
    pub diameter: Exact<Length>,
    /// Density, such as `"912 kg/m3"`.
    pub density: Exact<Density>,
    /// Young's modulus, such as `"2.6 GPa"`.
    pub modulus: Exact<Pressure>,
    /// Law of the inelastic strain rate.
    pub law: InelasticLawSheet,
    /// Fraction of the modulus that belongs to a spring in parallel with the branch of the law,
    /// such as `"0.5"`, as in a standard solid. None by default.
    pub spring: Option<Exact<Ratio>>,
    /// Distance of the section near the struck end from the free end, such as `"394 mm"`.
    pub section_distance: Exact<Length>,
    /// The projectile.
    pub striker: StrikerSheet,
    /// Velocities of the projectile, such as `["3 m/s", "10 m/s"]`, with one test for each.
    pub velocities: Vec<Exact<Velocity>>,
    /// Quantity measured by the sensors; by default velocities.
    #[serde(default)]
    pub sensors: SensorsSheet,
    /// Longest cell of the chain, such as `"1 mm"`; by default a hundredth of the shortest
    /// wavelength that the recorder passes.
    pub cell: Option<Exact<Length>>,
    /// Confirms a wave speed outside the range of solids.
    #[serde(default)]
    pub unusual: bool,
}

/// A cylindrical elastic projectile.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrikerSheet {
    /// Length, such as `"30 mm"`.
    pub length: Exact<Length>,
    /// Diameter, such as `"15.8 mm"`.
    pub diameter: Exact<Length>,
    /// Density, such as `"2700 kg/m3"`.
    pub density: Exact<Density>,
    /// Young's modulus, such as `"69 GPa"`.
    pub modulus: Exact<Pressure>,
}

impl StrikerSheet {
    /// Returns the projectile with a velocity \[m/s\].
    pub(in crate::job) fn at(&self, velocity: f64) -> Striker {
        Striker {
            length: self.length.si(),
            diameter: self.diameter.si(),
            density: self.density.si(),
            modulus: self.modulus.si(),
            velocity,
        }
    }
}

/// Quantity measured at the two sections.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum SensorsSheet {
    /// Velocities.
    #[default]
    Velocity,
    /// Displacements; values beyond the range are clipped to it.
    Displacement {
        /// Range of the transducers, such as `"20 mm"`.
        range: Exact<Length>,
    },
}

/// Tests at all velocities with one law.
struct Struck<'a, L> {
    sheet: &'a ImpactedRodSheet,
    rod: InelasticRod<L>,
    cell: f64,
    duration: f64,
}

impl<L: InelasticLaw> Struck<'_, L> {
    fn test(&self, velocity: f64, section_distance: f64) -> ImpactTest<L> {
        ImpactTest {
            striker: self.sheet.striker.at(velocity),
            rod: self.rod.clone(),
            diameter: self.sheet.diameter.si(),
            section_distance,
        }
    }

    fn run(&self, velocity: f64, section_distance: f64) -> Result<ImpactHistory, RodlabError> {
        self.test(velocity, section_distance)
            .run(self.cell, self.duration)
            .in_step(FIELD)
    }
}

impl ImpactedRodSheet {
    pub(super) fn make(
        &self,
        request: &Request<'_>,
        instrument: &InstrumentSheet,
        context: &JobContext<'_>,
    ) -> Result<Made, RodlabError> {
        self.check()?;
        with_law!(self, |law| self.with(law, request, instrument, context))
    }

    fn check(&self) -> Result<(), RodlabError> {
        RodlabError::refuse_empty(
            &self.velocities,
            format!("{FIELD}.velocities"),
            "at least one velocity",
        )?;
        if self.section_distance.si() > self.length.si() {
            return Err(RodlabError::request(
                format!("{FIELD}.section_distance"),
                self.section_distance.to_string(),
                format!("at most the length of the rod, {}", self.length),
            ));
        }
        Ok(())
    }

    /// Checks that the number of cells times steps is not too large; a wave takes at least one step
    /// per cell.
    fn check_extent<L>(&self, struck: &Struck<'_, L>, wave_speed: f64) -> Result<(), RodlabError> {
        for (number, velocity) in self.velocities.iter().enumerate() {
            if velocity.si().abs() >= wave_speed {
                return Err(RodlabError::request(
                    format!("{FIELD}.velocities[{number}]"),
                    velocity.to_string(),
                    format!("less than the wave speed of the rod, {wave_speed:.4} m/s"),
                ));
            }
        }
        let cells = self.length.si() / struck.cell;
        let steps = struck.duration * wave_speed / struck.cell;
        let all = self.velocities.len() as f64 * cells * steps;
        plausible::at_most(
            all,
            MOST_CELL_STEPS,
            "cells times steps of all velocities",
            FIELD,
        )
    }

    fn with<L: InelasticLaw>(
        &self,
        law: L,
        request: &Request<'_>,
        instrument: &InstrumentSheet,
        context: &JobContext<'_>,
    ) -> Result<Made, RodlabError> {
        let (length, density) = (self.length.si(), self.density.si());
        let mut rod = InelasticRod::new(length, density, self.modulus.si(), law).in_step(FIELD)?;
        if let Some(share) = &self.spring {
            rod = rod
                .with_spring(share.si())
                .in_step(format!("{FIELD}.spring"))?;
        }
        let wave_speed = rod.wave_speed();
        plausible::wave_speed(wave_speed, self.unusual, FIELD)?;
        let shortest_wave = wave_speed / instrument.cutoff_hz();
        let struck = Struck {
            sheet: self,
            cell: self
                .cell
                .as_ref()
                .map_or(shortest_wave / CELLS_PER_WAVE, Exact::si),
            rod,
            duration: instrument.duration(),
        };
        self.check_extent(&struck, wave_speed)?;
        context.has_read_all(&[], &[])?;

        let steps = self.velocities.len() + sections::COUNT;
        context.progress.begins("impacts", steps);
        let mut recorded = Recorded::by(lumped::GENERATOR);
        let mut levels = Vec::new();
        let mut balances = Vec::new();
        for (number, velocity) in self.velocities.iter().enumerate() {
            let history = struck.run(velocity.si(), self.section_distance.si())?;
            balances.push((velocity.si(), history.balance));
            let sampled = instrument.sampled(&self.sensed(&history))?;
            let peaks = peaks(&sampled);
            levels.push(
                sampled
                    .channels()
                    .iter()
                    .zip(&peaks)
                    .map(|(channel, peak)| instrument.noise_level(channel, *peak))
                    .collect::<Result<Vec<_>, _>>()?,
            );
            let random = &mut request.random(number + 1);
            let taken = instrument.recorded(&sampled, &peaks, random)?;
            let name = request.naming.file(number + 1, self.velocities.len());
            recorded.take(
                taken,
                &request.naming,
                name,
                format!("struck at {velocity}"),
            )?;
            context.progress.one_more();
            context.check_cancelled()?;
        }
        let figure = sections::figure(&struck, context)?;
        let mut truth = Truth::default();
        truth.add("Young's modulus", self.modulus.si(), "Pa");
        if let Some(share) = &self.spring {
            truth.add("share of the spring in the modulus", share.si(), "");
        }
        for (name, value, unit) in self.law.in_numbers() {
            truth.add(name, value, unit);
        }
        truth.add("density", density, "kg/m3");
        truth.add(
            "distance of the section from the free end",
            self.section_distance.si(),
            "m",
        );
        let title = "Momentum and energy at the end of the record";
        let balance = Rows::of(&balances, "balances", title)
            .number("impact velocity", "m/s", |(velocity, _)| *velocity)
            .number("energy of the striker before", "J", |(_, balance)| {
                balance.energy_before
            })
            .number("energy at the end", "J", |(_, balance)| {
                balance.energy_after
            })
            .number("energy dissipated", "J", |(_, balance)| {
                balance.energy_dissipated
            })
            .number("relative loss of momentum", "", |(_, balance)| {
                balance.momentum_residual
            })
            .table;
        let velocities: Vec<String> = self.velocities.iter().map(ToString::to_string).collect();
        Ok(Made {
            truth,
            tables: vec![balance],
            figures: vec![figure],
            in_words: format!(
                "A rod of {} by {}, struck at {}, two sections",
                self.length,
                self.diameter,
                velocities.join(", ")
            ),
            evaluations: vec![evaluation::sheet(
                self, request, &recorded, &levels, instrument,
            )?],
            recorded: Some(recorded),
        })
    }

    /// Returns the quantities that the sensors measure in an impact.
    fn sensed(&self, history: &ImpactHistory) -> History {
        let step = history.step;
        let (quantity, begins, range) = match &self.sensors {
            // the velocities of the chain are at half steps
            SensorsSheet::Velocity => (Quantity::Velocity, 0.5 * step, f64::INFINITY),
            SensorsSheet::Displacement { range } => (Quantity::Displacement, step, range.si()),
        };
        let felt = |velocity: &[f64]| -> Vec<f64> {
            if quantity == Quantity::Velocity {
                return velocity.to_vec();
            }
            let mut displacement = 0.0;
            let steps = velocity.iter().map(|v| {
                displacement += v * step;
                f64::clamp(displacement, -range, range)
            });
            steps.collect()
        };
        let channel = |name: &str, velocity: &[f64]| Sensed::new(name, quantity, felt(velocity));
        History {
            generator: lumped::GENERATOR.to_owned(),
            begins,
            step,
            channels: vec![
                channel(NEAR, &history.section_velocity),
                channel(FREE, &history.free_end_velocity),
            ],
        }
    }
}
