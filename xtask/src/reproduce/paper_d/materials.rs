//! Tables 4 and 5 on virtual tests with the geometry of Table 2.

use maxwellid::recorder::{RecorderCheck, RecorderFilter};
use maxwellid::{Noise, RodTest, Verdict};
use serde::Serialize;

use super::super::Error;
use super::identify::{Parameter, Settings, identify, influences, one_by_one, stated, value_of};
use super::virtual_test::{self, Conditions, NOISE, Rig, cell_for};
use testbed::papers::paper_d::{
    IdentifiedMaterial, ModelKind, PaperD, RodTestConditions, UnitReading,
};

/// Longest cell of the inversion, in m: the second-order error is 2e-4 of V0, a fortieth of the
/// noise.
pub(crate) const CELL: f64 = 4e-3;

/// Number of cells of the chain per shortest wavelength of the record.
const CELLS_PER_WAVE: f64 = 50.0;

/// Verdict for the parameters of a nonlinear law if the recorder could not follow the excitation.
const BIASED: &str = "biased by the recorder's filter";

/// Relation between the recorded excitation and the motion of the rod.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Excitation {
    /// The rod is driven by the recorded excitation. This represents a contact that is soft enough
    /// for the recorder to follow.
    AsRecorded,
    /// A flat projectile strikes the rod, and the filter of the recorder then rounds both
    /// histories. The identification is that of the paper, which does not model a recorder.
    Struck,
    /// The records are those of `Struck`; the recorder is part of the model.
    ThroughRecorder,
}

/// Result for one material, in one reading of the units.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Material {
    pub(crate) material: String,
    pub(crate) model: &'static str,
    #[serde(skip)]
    pub(crate) reading: UnitReading,
    #[serde(skip)]
    pub(crate) excitation: Excitation,
    #[serde(rename = "reading")]
    pub(crate) reading_in_words: &'static str,
    pub(crate) data: String,
    /// Table 4: the parameters from all four tests.
    pub(crate) lines: Vec<Line>,
    /// Table 5: the error with Q = 1, 2, 3, 4 tests.
    pub(crate) errors: Vec<f64>,
    pub(crate) printed_errors: Vec<f64>,
    /// `None` for the literal reading: its damping is undetermined, and the last digits of a
    /// machine decide whether the search ends at a bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) converged: Option<bool>,
    pub(crate) iterations: usize,
    /// Histories shown in the figure.
    #[serde(skip)]
    pub(crate) histories: Vec<History>,
}

/// Parameter of Table 4.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Line {
    pub(crate) parameter: Parameter,
    /// True value in the data.
    pub(crate) input: f64,
    /// Rms change of the responses due to a change of the true value by ten per cent, as a fraction
    /// of V0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) influence_of_ten_per_cent: Option<f64>,
    /// (output - input) over the standard error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) deviation: Option<f64>,
}

/// Measured and simulated response of one test.
#[derive(Debug, Clone)]
pub(crate) struct History {
    pub(crate) name: String,
    /// Times in s from the first sample
    pub(crate) times: Vec<f64>,
    pub(crate) measured: Vec<f64>,
    pub(crate) simulated: Vec<f64>,
}

/// Material that is to be computed.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    reading: UnitReading,
    excitation: Excitation,
    material: IdentifiedMaterial,
    tests: Vec<RodTestConditions>,
    printed_errors: Vec<f64>,
}

/// Returns the tests from which a material is identified, and its errors of Table 5. These are the
/// second to fifth test; the first test is used for the choice of the model.
pub(crate) fn identified_from(
    paper: &PaperD,
    material: &str,
) -> (Vec<RodTestConditions>, Vec<f64>) {
    let tests = paper.tests.iter().filter(|test| test.material == material);
    let errors = paper.errors.iter();
    let errors = errors.filter(|errors| errors.material == material);
    (
        tests.skip(1).cloned().collect(),
        errors
            .flat_map(|errors| errors.by_number_of_tests.iter().map(|e| e.value))
            .collect(),
    )
}

/// Returns the jobs.
pub(crate) fn jobs(paper: &PaperD) -> Vec<Job> {
    let mut jobs = Vec::new();
    for (reading, excitation) in [
        (UnitReading::Literal, Excitation::AsRecorded),
        (UnitReading::Realistic, Excitation::AsRecorded),
        (UnitReading::Realistic, Excitation::Struck),
        (UnitReading::Realistic, Excitation::ThroughRecorder),
    ] {
        for material in paper.identified(reading) {
            let (tests, printed_errors) = identified_from(paper, &material.material);
            jobs.push(Job {
                reading,
                excitation,
                material: material.clone(),
                tests,
                printed_errors,
            });
        }
    }
    jobs
}

pub(crate) fn run(job: &Job, rig: &Rig) -> Result<Material, Error> {
    let parameters = job.material.values;
    let tests: Vec<RodTest> = job
        .tests
        .iter()
        .map(|test| {
            let conditions = conditions(test, super::identify::modulus_of(parameters));
            let mut noise = rig.noise(test);
            match job.excitation {
                Excitation::AsRecorded => rig.driven(&conditions, parameters, &mut noise),
                Excitation::Struck | Excitation::ThroughRecorder => {
                    rig.struck(&conditions, parameters, &mut noise)
                }
            }
        })
        .collect::<Result<_, _>>()?;
    // Table 5 minimises the sum of squares of eq. 12, as in the paper. Table 4 weights the noise of
    // both histories, so that its errors cover the true values.
    let plain = Settings {
        cell: Some(CELL),
        round_trip: false,
        noise: Noise::FromResidual,
        recorder_noise: NOISE,
    };
    let outcomes = one_by_one(job.material.model, &tests, plain)?;
    let mut weighed = virtual_test::stating_the_noise(&tests, rig.striker.velocity)?;
    if job.excitation == Excitation::ThroughRecorder {
        let filter = RecorderFilter::linear_phase(rig.recorder())?;
        let seen = weighed.into_iter().map(|test| test.with_recorder(&filter));
        weighed = seen.collect::<Result<_, _>>()?;
    }
    let mut last = identify(
        job.material.model,
        &weighed,
        Settings {
            noise: Noise::Stated,
            // with the recorder in the model, a sharp front drives the rod, and the cell is chosen
            // for the noise
            cell: plain
                .cell
                .filter(|_| job.excitation != Excitation::ThroughRecorder),
            ..plain
        },
        outcomes.last(),
    )?;
    // a rod driven by the recorded excitation is not checked, because it has no other excitation
    if job.excitation == Excitation::Struck && job.material.model != ModelKind::Maxwell {
        let recorders = weighed
            .iter()
            .map(|test| RecorderCheck::of(test, Some(virtual_test::CUTOFF_HZ)))
            .collect::<Result<Vec<_>, _>>()?;
        if recorders.iter().any(RecorderCheck::is_biased) {
            for parameter in last.parameters.iter_mut().filter(|p| p.identified) {
                parameter.verdict = BIASED.into();
                parameter.identified = false;
            }
        }
    }
    let truth = stated(parameters)?;
    let influences = influences(parameters, &tests, CELL)?;
    let lines = last
        .parameters
        .iter()
        .filter_map(|parameter| {
            let input = value_of(&truth, parameter.symbol)?;
            Some(Line {
                deviation: deviation(parameter, input),
                parameter: parameter.clone(),
                influence_of_ten_per_cent: value_of(&influences, parameter.symbol),
                input,
            })
        })
        .collect();
    let histories = tests
        .iter()
        .zip(&last.residuals)
        .map(|(test, residual)| History {
            name: test.name().to_owned(),
            times: test.times(),
            measured: test.response().to_vec(),
            simulated: test
                .response()
                .iter()
                .zip(residual)
                .map(|(measured, r)| measured + r * rig.striker.velocity)
                .collect(),
        })
        .collect();
    Ok(Material {
        material: job.material.material.clone(),
        model: job.material.model.symbol(),
        reading: job.reading,
        reading_in_words: job.reading.description(),
        excitation: job.excitation,
        data: format!(
            "virtual: {}; white noise of {} % of V0 on both histories (seeds {} + test number)",
            match job.excitation {
                Excitation::AsRecorded => {
                    "the striker's excitation, as the recorder passes it, drives a lumped chain"
                }
                Excitation::Struck => {
                    "a lumped chain struck by a flat striker, both histories low-passed by the recorder afterwards"
                }
                Excitation::ThroughRecorder => {
                    "the data of the flat striker, identified with the recorder as part of the model"
                }
            },
            100.0 * NOISE,
            virtual_test::SEED
        ),
        lines,
        errors: outcomes.iter().map(|o| o.relative_error).collect(),
        printed_errors: job.printed_errors.clone(),
        converged: (job.reading != UnitReading::Literal).then_some(last.converged),
        iterations: last.iterations,
        histories,
    })
}

/// Returns the conditions of a test on a rod of `modulus` \[Pa\].
pub(crate) fn conditions(test: &RodTestConditions, modulus: f64) -> Conditions {
    // in 2.5 ms there are three or more reflections in a plastic rod; waves in rubber are three
    // times slower
    let slow = modulus < 1e9;
    Conditions {
        name: format!("Test {}", test.test),
        density: test.density,
        diameter: test.diameter,
        rod_length: test.rod_length,
        section_distance: test.section_distance,
        transducer_range: test.transducer_range,
        samples_after: if slow { 256 } else { 128 },
        cell: cell_for(modulus, test.density, CELLS_PER_WAVE),
    }
}

fn deviation(parameter: &Parameter, input: f64) -> Option<f64> {
    let (value, error) = (parameter.value?, parameter.standard_error?);
    Some(match parameter.scale {
        maxwellid::Scale::Ratio => (value / input).ln() / error,
        maxwellid::Scale::Difference => (value - input) / error,
    })
}

impl Material {
    /// Returns the number of parameters that the filter of the recorder biases.
    pub(crate) fn biased(&self) -> usize {
        let parameters = self.lines.iter().map(|line| &line.parameter);
        parameters.filter(|p| p.verdict == BIASED).count()
    }

    /// Returns the verdict on the damping, which is that on the rate (or the viscosity).
    pub(crate) fn damping_verdict(&self) -> Verdict {
        let rate = ["F(10 MPa)", "eta"].iter().find_map(|symbol| {
            self.lines
                .iter()
                .map(|line| &line.parameter)
                .find(|p| p.symbol == *symbol && p.verdict != "derived")
        });
        if rate.is_some_and(|p| p.identified) {
            Verdict::Identified
        } else {
            Verdict::NotIdentifiable
        }
    }
}
