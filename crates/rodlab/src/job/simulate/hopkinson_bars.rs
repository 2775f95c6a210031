//! Shot on split Hopkinson bars: striker, incident bar, specimen and transmitted bar, in contact.

mod evaluation;

use std::f64::consts::PI;

use labio::Quantity;
use rodwave::RodwaveError;
use rodwave::inelastic::Elastic;
use rodwave::line::{self, Body, Gauge, Line, LineHistory, Segment};
use rodwave::modulus::GeneralisedMaxwell;
use serde::Deserialize;

use super::blows::{Recorded, peaks};
use super::impacted_rod::StrikerSheet;
use super::inelastic_law::{InelasticLawSheet, with_law};
use super::instrument::{History, InstrumentSheet, Sensed};
use super::truth::Truth;
use super::{Made, Request};
use crate::job::JobContext;
use crate::outcome::{Rows, Table};
use crate::sheet::{Coordinate, Density, Exact, Length, Pressure, Velocity, plausible};
use crate::{InStep, RodlabError};

const FIELD: &str = "experiment: HopkinsonBars";
/// Largest product of the numbers of cells and steps; it limits the computing time to some minutes.
const MOST_CELL_STEPS: f64 = 4e9;
/// Largest relative change of a wave speed that the grid may cause by rounding.
const SPEED_TOLERANCE: f64 = 2e-4;
/// Distance from the ends of the bars \[m\] of the sections that represent the faces of the
/// specimen.
const INSIDE: f64 = 1e-6;
/// Indices of the bars among the bodies.
const INCIDENT: usize = 1;
const TRANSMITTED: usize = 3;

/// A shot with a striker, and a specimen between two bars; the bodies separate where they would
/// pull on each other.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HopkinsonBarsSheet {
    /// The striker.
    pub striker: StrikerSheet,
    /// Velocity of the striker, such as `"12 m/s"`.
    pub velocity: Exact<Velocity>,
    /// The bar that is struck.
    pub incident: VirtualBarSheet,
    /// The other bar.
    pub transmitted: VirtualBarSheet,
    /// The specimen.
    pub specimen: VirtualSpecimenSheet,
}

/// A bar with strain gauges.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VirtualBarSheet {
    /// Name of the material, whose law is `Elastic`, `Maxwell`, `Zener` or `Prony`.
    pub material: String,
    /// Diameter, such as `"20 mm"`.
    pub diameter: Exact<Length>,
    /// Length, such as `"1800 mm"`.
    pub length: Exact<Length>,
    /// Distances of one or two gauges from the specimen.
    pub gauges: Vec<Exact<Coordinate>>,
}

/// A cylindrical specimen: a spring in series with a law, and a hardening spring in parallel with
/// both.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VirtualSpecimenSheet {
    /// Length, such as `"6 mm"`.
    pub length: Exact<Length>,
    /// Diameter, such as `"14 mm"`.
    pub diameter: Exact<Length>,
    /// Density.
    pub density: Exact<Density>,
    /// Young's modulus in series with the law.
    pub modulus: Exact<Pressure>,
    /// Law of the inelastic strain rate; a power law with a high exponent acts like a yield stress.
    pub law: InelasticLawSheet,
    /// Modulus of the parallel spring; none by default.
    pub hardening: Option<Exact<Pressure>>,
}

/// A bar with its material in numbers.
struct Bar<'a> {
    sheet: &'a VirtualBarSheet,
    density: f64,
    law: GeneralisedMaxwell,
}

fn area(diameter: f64) -> f64 {
    0.25 * PI * diameter * diameter
}

impl Bar<'_> {
    fn segment(&self) -> Result<Segment, RodwaveError> {
        let area = area(self.sheet.diameter.si());
        Segment::prony(self.sheet.length.si(), area, self.density, &self.law)
    }
}

impl VirtualBarSheet {
    fn bar(&self, request: &Request<'_>, side: &str) -> Result<Bar<'_>, RodlabError> {
        let field = format!("{FIELD}.{side}");
        if !(1..=2).contains(&self.gauges.len()) {
            return Err(RodlabError::request(
                format!("{field}.gauges"),
                format!("{} gauges", self.gauges.len()),
                "one or two",
            ));
        }
        for (at, gauge) in self.gauges.iter().enumerate() {
            if !(gauge.si() > 0.0 && gauge.si() < self.length.si()) {
                return Err(RodlabError::request(
                    format!("{field}.gauges[{at}]"),
                    gauge.to_string(),
                    format!(
                        "above 0 and less than the length of the bar, {}",
                        self.length
                    ),
                ));
            }
        }
        let (density, law) = request.prony(&self.material, &format!("{field}.material"))?;
        Ok(Bar {
            sheet: self,
            density,
            law,
        })
    }
}

impl VirtualSpecimenSheet {
    fn segment(&self) -> Result<Segment, RodlabError> {
        let (length, area) = (self.length.si(), area(self.diameter.si()));
        let plain = Segment::new(length, area, self.density.si()).in_step(FIELD)?;
        let modulus = self.modulus.si();
        let segment = with_law!(self, |law| plain.with_branch(modulus, law)).in_step(FIELD)?;
        match &self.hardening {
            None => Ok(segment),
            Some(hardening) => segment.with_branch(hardening.si(), Elastic).in_step(FIELD),
        }
    }
}

fn channels(side: &str, bar: &VirtualBarSheet) -> Vec<String> {
    match bar.gauges.len() {
        1 => vec![side.to_owned()],
        count => (1..=count).map(|n| format!("{side} {n}")).collect(),
    }
}

impl HopkinsonBarsSheet {
    pub(super) fn make(
        &self,
        request: &Request<'_>,
        instrument: &InstrumentSheet,
        context: &JobContext<'_>,
    ) -> Result<Made, RodlabError> {
        let bars = [
            self.incident.bar(request, "incident")?,
            self.transmitted.bar(request, "transmitted")?,
        ];
        let line = self.line(&bars, self.specimen.segment()?).in_step(FIELD)?;
        let step = instrument.fine_step();
        let duration = instrument.duration();
        let transits: f64 = line.segments().map(Segment::transit_time).sum();
        let extent = transits / step * (duration / step);
        plausible::at_most(extent, MOST_CELL_STEPS, "cells times steps", FIELD)?;
        context.has_read_all(&[], &[])?;

        context.progress.begins("shot", 1);
        let history = line.run(step, duration, &self.gauges()).in_step(FIELD)?;
        let sampled = instrument.sampled(&self.sensed(&history))?;
        let peaks = peaks(&sampled);
        let taken = instrument.recorded(&sampled, &peaks, &mut request.random(0))?;
        let mut recorded = Recorded::by(line::GENERATOR);
        let name = request.naming.file(1, 1);
        let what = format!("a striker at {}", self.velocity);
        recorded.take(taken, &request.naming, name, what)?;
        context.progress.one_more();

        let mut truth = Truth::default();
        let ledger = &history.ledger;
        truth.add("energy of the striker", ledger.initial_energy, "J");
        truth.add("energy dissipated", ledger.dissipated, "J");
        Ok(Made {
            truth,
            tables: vec![self.stress_and_strain(&history, instrument)],
            figures: Vec::new(),
            in_words: format!(
                "A specimen of {} by {} between bars, a striker of {} at {}",
                self.specimen.length, self.specimen.diameter, self.striker.length, self.velocity
            ),
            evaluations: vec![evaluation::sheet(
                self, &bars, request, &recorded, instrument,
            )],
            recorded: Some(recorded),
        })
    }

    fn line(&self, bars: &[Bar<'_>; 2], specimen: Segment) -> Result<Line, RodwaveError> {
        let striker = &self.striker;
        let striker = Segment::elastic(
            striker.length.si(),
            area(striker.diameter.si()),
            striker.density.si(),
            striker.modulus.si(),
        )?;
        let [incident, transmitted] = bars;
        Line::new([
            Body::new([striker])?.moving_at(self.velocity.si())?,
            Body::new([incident.segment()?])?,
            Body::new([specimen])?,
            Body::new([transmitted.segment()?])?,
        ])?
        .with_speed_tolerance(SPEED_TOLERANCE)
    }

    /// Returns the gauges of both bars, followed by the two faces of the specimen.
    fn gauges(&self) -> Vec<Gauge> {
        let length = self.incident.length.si();
        let near = self.incident.gauges.iter().map(|gauge| Gauge {
            body: INCIDENT,
            position: length - gauge.si(),
        });
        let far = self.transmitted.gauges.iter().map(|gauge| Gauge {
            body: TRANSMITTED,
            position: gauge.si(),
        });
        let faces = [(INCIDENT, length - INSIDE), (TRANSMITTED, INSIDE)];
        let faces = faces.map(|(body, position)| Gauge { body, position });
        near.chain(far).chain(faces).collect()
    }

    fn sensed(&self, history: &LineHistory) -> History {
        let names = channels("incident", &self.incident)
            .into_iter()
            .chain(channels("transmitted", &self.transmitted));
        let sections = names.zip(&history.gauges);
        History {
            generator: line::GENERATOR.to_owned(),
            begins: 0.0,
            step: history.grid.time_step,
            channels: sections
                .map(|(name, section)| Sensed::new(name, Quantity::Strain, section.strain.clone()))
                .collect(),
        }
    }

    /// Returns engineering stress and strain of the specimen at the times of the recorder's
    /// samples, without the effect of the recorder.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "places in a history of some million steps"
    )]
    fn stress_and_strain(&self, history: &LineHistory, instrument: &InstrumentSheet) -> Table {
        let step = history.grid.time_step;
        let n_gauges = self.incident.gauges.len() + self.transmitted.gauges.len();
        let face = |at: usize| history.gauges.get(n_gauges + at);
        let velocity = |at: usize| face(at).map_or(&[][..], |face| face.velocity.as_slice());
        let force = |at: usize, bar: &VirtualBarSheet| -> Vec<f64> {
            let stress = face(at).map_or(&[][..], |face| face.stress.as_slice());
            let area = area(bar.diameter.si());
            stress.iter().map(|stress| -area * stress).collect()
        };
        let forces = [force(0, &self.incident), force(1, &self.transmitted)];
        let (own, length) = (area(self.specimen.diameter.si()), self.specimen.length.si());
        let mut strain = 0.0;
        let mut all = Vec::with_capacity(forces[0].len());
        let both = forces[0].iter().zip(&forces[1]);
        for ((f1, f2), (v1, v2)) in both.zip(velocity(0).iter().zip(velocity(1))) {
            let rate = (v1 - v2) / length;
            strain += step * rate;
            all.push([0.5 * (f1 + f2) / own, strain, rate]);
        }
        let interval = 1.0 / instrument.sampling_rate.si();
        let rows: Vec<(f64, [f64; 3])> = (0..)
            .map_while(|sample| {
                let at = (f64::from(sample) * interval / step).round() as usize;
                Some((at as f64 * step + instrument.before(), *all.get(at)?))
            })
            .collect();
        let title = "Stress and strain of the virtual specimen";
        Rows::of(&rows, "true-stress-strain", title)
            .number("time", "us", |(time, _)| 1e6 * time)
            .number("strain", "", |(_, [_, strain, _])| *strain)
            .number("stress", "MPa", |(_, [stress, ..])| 1e-6 * stress)
            .number("strain rate", "1/s", |(_, [.., rate])| *rate)
            .table
    }
}
