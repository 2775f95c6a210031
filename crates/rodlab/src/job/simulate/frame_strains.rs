//! Test of paper B: strains at sections of a rod that is a member of a structure.

use labio::Quantity;
use rodwave::chain::{LaplaceVariable, Termination};
use rodwave::element::Circle;
use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember};
use serde::Deserialize;

use super::blows::{BlowsSheet, Recorded};
use super::instrument::{History, InstrumentSheet, Sensed};
use super::truth::{self, Truth};
use super::{Evaluation, Made, Request, StruckRod, analytic};
use crate::job::JobContext;
use crate::sheet::{AddedMass, Coordinate, Exact, Length, SpecificImpedance, Stiffness};
use crate::{InStep, RodlabError};

const FIELD: &str = "experiment: StrainsInFrame";
/// Relative difference below which distances between gauges count as equal.
const EQUIDISTANT: f64 = 1e-9;

/// A rod between two structures, with strain gauges.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrainsInFrameSheet {
    /// Name of the material.
    pub material: String,
    /// Length, such as `"800 mm"`.
    pub length: Exact<Length>,
    /// Diameter, such as `"16 mm"`.
    pub diameter: Exact<Length>,
    /// Positions of the gauges from the struck end, in order.
    pub gauges: Vec<Exact<Coordinate>>,
    /// Support of the struck end, in addition to the hammer; none by default.
    #[serde(default)]
    pub struck_end: SupportSheet,
    /// Support of the other end; none by default.
    #[serde(default)]
    pub other_end: SupportSheet,
    /// The hammer hits on the struck end.
    pub blows: BlowsSheet,
}

/// A spring to the ground, a dashpot to the ground and a mass, in parallel; each is optional.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SupportSheet {
    /// Spring, such as `"70 N/m"`.
    pub stiffness: Option<Exact<Stiffness>>,
    /// Dashpot, such as `"0.02 kg/s"`.
    pub resistance: Option<Exact<SpecificImpedance>>,
    /// Mass, such as `"15 gram"`.
    pub mass: Option<Exact<AddedMass>>,
}

impl SupportSheet {
    /// Returns true if there is no support.
    pub(super) fn is_absent(&self) -> bool {
        self.stiffness.is_none() && self.resistance.is_none() && self.mass.is_none()
    }

    /// Returns the support; `None` if there is none.
    fn support(&self) -> Option<EndSupport> {
        (!self.is_absent()).then(|| EndSupport {
            stiffness: self.stiffness.as_ref().map_or(0.0, Exact::si),
            resistance: self.resistance.as_ref().map_or(0.0, Exact::si),
            mass: self.mass.as_ref().map_or(0.0, Exact::si),
        })
    }
}

fn name(gauge: usize) -> String {
    format!("gauge {}", gauge + 1)
}

impl StrainsInFrameSheet {
    pub(super) fn make(
        &self,
        request: &Request<'_>,
        instrument: &InstrumentSheet,
        context: &JobContext<'_>,
    ) -> Result<Made, RodlabError> {
        self.blows
            .check(&format!("{FIELD}.blows"), instrument, self.gauges.len())?;
        if self.gauges.len() < 2 {
            return Err(RodlabError::request(
                format!("{FIELD}.gauges"),
                format!("{} gauges", self.gauges.len()),
                "three or more, or two before a free end",
            ));
        }
        let medium = analytic(request, &self.material, &format!("{FIELD}.material"))?;
        let positions: Vec<f64> = self.gauges.iter().map(Exact::si).collect();
        let section = Circle::of_diameter(self.diameter.si()).in_step(FIELD)?;
        let right: Termination<LaplaceVariable> = self
            .other_end
            .support()
            .map_or(Termination::Free, EndSupport::analytic_termination);
        let length = self.length.si();
        let mut member =
            FrameMember::analytic(&medium, section, length, &positions, right).in_step(FIELD)?;
        if let Some(support) = self.struck_end.support() {
            member = member
                .with_analytic_left_structure(support.analytic_termination())
                .in_step(FIELD)?;
        }
        let pulse = self.blows.pulse(&format!("{FIELD}.blows"))?;
        let synthesis = instrument.synthesis(FIELD)?;
        context.has_read_all(&[], &[])?;

        context.progress.begins("hits", self.blows.hits);
        let exact = member
            .record(&Excitation::Force(pulse.as_ref()), &synthesis)
            .in_step(FIELD)?;
        let history = History {
            generator: exact.generator.to_owned(),
            begins: exact.start,
            step: exact.interval,
            channels: exact
                .strains
                .into_iter()
                .enumerate()
                .map(|(gauge, values)| Sensed::new(name(gauge), Quantity::Strain, values))
                .collect(),
        };
        let recorded = self.blows.record(&history, instrument, request, context)?;
        let mut truth = Truth::default();
        truth.add("length", length, "m");
        truth.add("diameter", self.diameter.si(), "m");
        truth.add("density", medium.density(), "kg/m3");
        for (gauge, position) in positions.iter().enumerate() {
            truth.add(format!("position of {}", name(gauge)), *position, "m");
        }
        let band = instrument.passes_up_to_hz();
        Ok(Made {
            truth,
            tables: vec![truth::modulus(&medium, 0.01 * band, band)],
            figures: Vec::new(),
            in_words: format!(
                "{} on a rod of {} by {} between two structures, strains at {} sections",
                self.blows.in_words(),
                self.length,
                self.diameter,
                positions.len()
            ),
            evaluations: vec![self.evaluation(request, &recorded, instrument, medium.density())],
            recorded: Some(recorded),
        })
    }

    fn is_equidistant(&self) -> bool {
        let [first, middle, last] = self.gauges.as_slice() else {
            return false;
        };
        let distances = [middle.si() - first.si(), last.si() - middle.si()];
        (distances[0] - distances[1]).abs() <= EQUIDISTANT * distances[0].abs()
    }

    fn evaluation(
        &self,
        request: &Request<'_>,
        recorded: &Recorded,
        instrument: &InstrumentSheet,
        density: f64,
    ) -> Evaluation {
        let method = if self.is_equidistant() {
            "ThreePoint"
        } else {
            "MultiPoint"
        };
        let gauges: String = self
            .gauges
            .iter()
            .enumerate()
            .map(|(gauge, at)| format!("\n        (channel: {:?}, at: \"{at}\"),", name(gauge)))
            .collect();
        let rod = StruckRod {
            length: self.length.to_string(),
            diameter: &self.diameter,
            density,
            density_error: String::new(),
            more: "",
            of_channel: String::new(),
            method: &format!("{method}(gauges: [{gauges}\n    ])"),
            silence: "the noise of the gauges is determined here; the filter reaches ahead of the impact",
        };
        rod.evaluation(request, recorded, instrument)
    }
}
