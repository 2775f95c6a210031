//! Test of paper E, first half: the acceleration of an impact face that is struck with a hammer.

use impulse::Domain;
use labio::Quantity;
use num_complex::Complex64;
use serde::Deserialize;

use super::blows::BlowsSheet;
use super::instrument::{History, InstrumentSheet, Sensed};
use super::truth::Truth;
use super::{Evaluation, Made, Request};
use crate::bodies::face::{BodySheet, ComputedBody};
use crate::bodies::replacement::{Replacement, WithoutUncertainty};
use crate::job::JobContext;
use crate::outcome::Table;
use crate::{InStep, RodlabError};

const FIELD: &str = "experiment: HammerOnBody";
const HAMMER: &str = "hammer";
const FACE: &str = "face";
const GENERATOR: &str = "hammer on a body: chain recursion, damped Fourier transform";
/// Number of lines in the table of the true mobility.
const LINES: usize = 200;

/// A body struck with a hammer.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HammerOnBodySheet {
    /// The body, from its impact face on.
    pub body: BodySheet,
    /// The hammer hits on the face.
    pub blows: BlowsSheet,
}

impl HammerOnBodySheet {
    pub(super) fn make(
        &self,
        request: &Request<'_>,
        instrument: &InstrumentSheet,
        context: &JobContext<'_>,
    ) -> Result<Made, RodlabError> {
        self.blows.check(&format!("{FIELD}.blows"), instrument, 2)?;
        let place = format!("{FIELD}.body");
        let mut exact = WithoutUncertainty {
            why: "a virtual test has exact values",
        };
        exact.body(&self.body, &place)?;
        let body = self.body.body(request.materials, &place)?;
        let pulse = self.blows.pulse(&format!("{FIELD}.blows"))?;
        let synthesis = instrument.synthesis(FIELD)?;
        context.has_read_all(&[], &[])?;

        context.progress.begins("hits", self.blows.hits);
        let mut force = Vec::new();
        let mut acceleration = Vec::new();
        for s in synthesis.arguments() {
            let transform = pulse.transform(s);
            force.push(transform);
            acceleration.push(s * mobility_at(&body, s, &place)? * transform);
        }
        let force = synthesis.history(&force).in_step(FIELD)?;
        let acceleration = synthesis.history(&acceleration).in_step(FIELD)?;
        let history = History {
            generator: GENERATOR.to_owned(),
            begins: force.start,
            step: force.interval,
            channels: vec![
                Sensed::new(HAMMER, Quantity::Force, force.samples),
                Sensed::new(FACE, Quantity::Acceleration, acceleration.samples),
            ],
        };
        let recorded = self.blows.record(&history, instrument, request, context)?;
        let mut truth = Truth::default();
        if let Some(mass) = body.free_mass() {
            truth.add("mass of the free body", mass, "kg");
        }
        let band = instrument.passes_up_to_hz();
        let records = request.records_of_sheet(&recorded, "    ");
        let highest = 1e-3 * band;
        let frf = format!(
            r#"Frf(
    title: {title:?},
    // each record is a hit
    {records},
    input: "{HAMMER}",
    outputs: ["{FACE}"],
    kind: Mobility,
    // where the filter of the recorder passes everything
    band: (from: "20 Hz", to: "{highest:.3} kHz"),
)
"#,
            title = request.title,
        );
        let support = body
            .free_mass()
            .map(|mass| format!("\n    support: Free(mass: \"{mass} kg\"),"))
            .unwrap_or_default();
        let indented = records.replace('\n', "\n    ");
        let mobility = format!(
            r#"Mobility(
    title: {title:?},
    // each record is a hit
    source: Hits(
        {indented},
        force: "{HAMMER}",
        response: "{FACE}",
    ),
    // where the filter of the recorder passes everything
    up_to: "{highest:.3} kHz",{support}
)
"#,
            title = request.title,
        );
        Ok(Made {
            truth,
            tables: vec![true_mobility(&body, band)?],
            figures: Vec::new(),
            in_words: format!(
                "{} on the face of a body, force and acceleration",
                self.blows.in_words()
            ),
            evaluations: vec![
                Evaluation::new("mobility", "mobility.ron", mobility, GENERATOR),
                Evaluation::new("frf", "frf.ron", frf, GENERATOR),
            ],
            recorded: Some(recorded),
        })
    }
}

/// Returns the mobility at `s` in the right half plane.
fn mobility_at(body: &ComputedBody, s: Complex64, place: &str) -> Result<Complex64, RodlabError> {
    if body.domain() != Domain::RightHalfPlane {
        return Err(RodlabError::request(
            place,
            "of a material whose law is known for real frequencies only",
            "causal laws, because a history is computed",
        ));
    }
    body.mobility_at(s).in_step(place)
}

fn true_mobility(body: &ComputedBody, band: f64) -> Result<Table, RodlabError> {
    let frequency: Vec<f64> = (1..=LINES)
        .map(|line| band * line as f64 / LINES as f64)
        .collect();
    let mobility: Vec<Complex64> = frequency
        .iter()
        .map(|f| body.mobility(*f))
        .collect::<Result<_, _>>()
        .in_step(format!("{FIELD}.body"))?;
    Ok(Table::new("true-mobility", "Mobility of the virtual face")
        .numbers("frequency", "Hz", frequency)
        .numbers("real part", "m/(N s)", mobility.iter().map(|y| y.re))
        .numbers("imaginary part", "m/(N s)", mobility.iter().map(|y| y.im)))
}
