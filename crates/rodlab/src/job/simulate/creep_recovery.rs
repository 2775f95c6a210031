//! Tests of paper C: the loss factor of a rod that recovers from loads.

use std::f64::consts::TAU;

use cmod::recovery::{LoadHistory, LoadSegment, ThreeElement, ThreeElementParameters};
use labio::instrument::{Instrument, NoiseSpectrum};
use labio::{Channel, Provenance, Quantity, Record};
use ndarray::{Axis as Row, aview1};
use rand_chacha::ChaCha8Rng;
use rodfigure::{Axis, Figure, Mark, Panel, Role};
use serde::Deserialize;

use super::truth::Truth;
use super::{Evaluation, Made, Request};
use crate::job::JobContext;
use crate::outcome::Table;
use crate::sheet::{Duration, Exact, Frequency, Pressure, Ratio};
use crate::{InStep, RodlabError};

const FIELD: &str = "experiment: CreepRecovery";
/// Method of the simulation. The stress of the dashpot is integrated during the load, and the
/// recovery is computed in closed form (paper C, eq. 4). The evaluation uses the same crate, so it
/// tests the effect of noise, not the validity of the model.
const GENERATOR: &str = "cmod::recovery, three-element model";

/// A material of three elements, and loads.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CreepRecoverySheet {
    /// Modulus E1 of the virgin material, such as `"3.1 GPa"`.
    pub series_modulus: Exact<Pressure>,
    /// Modulus E2 of the spring in parallel with the dashpot, such as `"13.1 kPa"`.
    pub parallel_modulus: Exact<Pressure>,
    /// Exponent m of the dashpot, such as `"1.8"`.
    pub exponent: Exact<Ratio>,
    /// Coefficient B of the dashpot, in Pa^-(m+1) s^-1, such as `4.55e-21`.
    pub coefficient: f64,
    /// Loss factor of the virgin material, such as `"0.025"`.
    pub virgin_loss_factor: Exact<Ratio>,
    /// Frequency at which the loss factor is read, such as `"10 kHz"`.
    pub frequency: Exact<Frequency>,
    /// Standard deviation of the error of a reading, such as `"0.0004"`.
    pub error: Exact<Ratio>,
    /// Loads, one test for each load.
    pub loads: Vec<CreepLoadSheet>,
    /// Times after unloading at which the loss factor is read, such as `["1 min", "5 min"]`.
    pub read_at: Vec<Exact<Duration>>,
}

/// A constant stress of limited duration.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CreepLoadSheet {
    /// Stress, such as `"45 MPa"`.
    pub stress: Exact<Pressure>,
    /// Duration, such as `"30 min"`.
    pub duration: Exact<Duration>,
}

/// Loss factors read after a load.
struct Readings<'a> {
    load: &'a CreepLoadSheet,
    exact: Vec<f64>,
    read: Vec<f64>,
}

impl CreepRecoverySheet {
    pub(super) fn make(
        &self,
        request: &Request<'_>,
        context: &JobContext<'_>,
    ) -> Result<Made, RodlabError> {
        for (field, empty) in [
            ("loads", self.loads.is_empty()),
            ("read_at", self.read_at.len() < 2),
        ] {
            if empty {
                return Err(RodlabError::request(
                    format!("{FIELD}.{field}"),
                    "too short",
                    "at least one load and two times",
                ));
            }
        }
        let model = ThreeElement::new(ThreeElementParameters {
            series_modulus: self.series_modulus.si(),
            parallel_modulus: self.parallel_modulus.si(),
            coefficient: self.coefficient,
            exponent: self.exponent.si(),
        })
        .in_step(FIELD)?;
        context.has_read_all(&[], &[])?;

        let omega = TAU * self.frequency.si();
        let mut truth = Truth::default();
        truth.add("modulus E1", self.series_modulus.si(), "Pa");
        truth.add("modulus E2", self.parallel_modulus.si(), "Pa");
        truth.add("exponent m", self.exponent.si(), "");
        truth.add("coefficient B", self.coefficient, "Pa^-(m+1) s^-1");
        let mut tests = Vec::new();
        for (number, load) in self.loads.iter().enumerate() {
            let segment = LoadSegment::Constant {
                stress: load.stress.si(),
                duration: load.duration.si(),
            };
            let history = LoadHistory::new(vec![segment]).in_step(FIELD)?;
            let recovery = model.recovery(&history).in_step(FIELD)?;
            let place = format!("recovery time after {} for {}", load.stress, load.duration);
            truth.add(place, recovery.recovery_time(), "s");
            let virgin = self.virgin_loss_factor.si();
            let exact: Vec<f64> = self
                .read_at
                .iter()
                .map(|at| virgin + recovery.loss_factor_change(omega, at.si()))
                .collect();
            let read = self.with_errors(&exact, &mut request.random(number + 1))?;
            tests.push(Readings { load, exact, read });
            context.check_cancelled()?;
        }
        Ok(Made {
            truth,
            tables: vec![self.table(&tests)],
            figures: vec![self.figure(&tests)],
            in_words: format!(
                "{} loads, loss factor at {} read {} times after each",
                self.loads.len(),
                self.frequency,
                self.read_at.len()
            ),
            evaluations: vec![self.evaluation(request, &tests)],
            recorded: None,
        })
    }

    /// Returns `exact` with independent, normally distributed errors.
    fn with_errors(&self, exact: &[f64], random: &mut ChaCha8Rng) -> Result<Vec<f64>, RodlabError> {
        let name = "loss factor";
        let values = aview1(exact).insert_axis(Row(0)).to_owned();
        let channel = Channel::new(name, Quantity::Strain).in_step(FIELD)?;
        let record = Record::new(
            values,
            1.0,
            0.0,
            vec![channel],
            Provenance::computed(GENERATOR),
        )
        .in_step(FIELD)?;
        let spectrum = NoiseSpectrum::white(2.0 * self.error.si().powi(2)).in_step(FIELD)?;
        let taken = Instrument::new()
            .noise(name, spectrum)
            .record(&record, random)
            .in_step(FIELD)?;
        Ok(taken.record.channel(name).in_step(FIELD)?.to_vec())
    }

    fn table(&self, tests: &[Readings<'_>]) -> Table {
        let times = self.read_at.iter().map(Exact::si);
        let mut table = Table::new("readings", "Loss factors after unloading").numbers(
            "time after unloading",
            "s",
            times,
        );
        for test in tests {
            let of = format!("{} for {}", test.load.stress, test.load.duration);
            table = table
                .numbers(format!("read, {of}"), "", &test.read)
                .numbers(format!("exact, {of}"), "", &test.exact);
        }
        table
    }

    fn figure(&self, tests: &[Readings<'_>]) -> Figure {
        let minutes: Vec<f64> = self.read_at.iter().map(|at| at.si() / 60.0).collect();
        let marks = tests
            .iter()
            .enumerate()
            .flat_map(|(index, test)| {
                let role = Role::of_series(index);
                let name = format!("{} for {}", test.load.stress, test.load.duration);
                let readings = minutes.iter().zip(&test.read);
                let readings = readings.map(|(at, read)| (*at, *read, self.error.si()));
                [
                    Mark::curve("", role, &minutes, test.exact.clone()),
                    Mark::points_with_errors(name, role, readings),
                ]
            })
            .collect();
        let time = Axis::logarithmic("time after unloading", "min");
        let panel = Panel::new(time, ("loss factor", ""), marks);
        Figure::new("recovery", "Loss factor after unloading", vec![panel]).with_caption(
            "Readings with their standard deviation, and the law from which they were computed.",
        )
    }

    fn evaluation(&self, request: &Request<'_>, tests: &[Readings<'_>]) -> Evaluation {
        let tests: String = tests
            .iter()
            .map(|test| {
                let CreepLoadSheet { stress, duration } = test.load;
                let readings: String = self
                    .read_at
                    .iter()
                    .zip(&test.read)
                    .map(|(at, value)| {
                        format!("\n                (at: \"{at}\", value: {value:.6}),")
                    })
                    .collect();
                format!(
                    r#"
        (
            name: "{stress} for {duration}",
            load: [Constant(stress: "{stress}", duration: "{duration}")],
            readings: Here([{readings}
            ]),
        ),"#
                )
            })
            .collect();
        let text = format!(
            r#"Recovery(
    title: {title:?},
    series_modulus: "{modulus}",
    frequency: "{frequency}",
    virgin_loss_factor: "{virgin}",
    standard_error: "{error}",
    tests: [{tests}
    ],
)
"#,
            title = request.title,
            modulus = self.series_modulus,
            frequency = self.frequency,
            virgin = self.virgin_loss_factor,
            error = self.error,
        );
        Evaluation::new("recovery", "recovery.ron", text, GENERATOR)
    }
}
