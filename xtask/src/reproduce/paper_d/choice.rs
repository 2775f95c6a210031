//! Table 3: choice of the model by the measures of adequacy of the paper, and by two other
//! measures.

use maxwellid::RodTest;
use maxwellid::adequacy::{Basis, Correction, RobbinsMonro, Weights};
use maxwellid::conformal::p_values;
use maxwellid::samples::{Pattern, StandardSamples};
use maxwellid::selection::{Candidate, Selection};
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use serde::Serialize;

use super::super::Error;
use super::flat_loss;
use super::identify::modulus_of;
use super::materials::conditions;
use super::verdict::{Verdict, verdict};
use super::virtual_test::{self, Rig};
use testbed::papers::paper_d::{IdentifiedMaterial, PaperD, RodTestConditions, UnitReading};

/// Number of principal components of the pattern that are kept; P_i is a linear function of them.
/// With 60 samples per model, the choice is little better than chance for any number of components.
const COMPONENTS: usize = 6;

/// Row of the table: a material, its data, and the measures of the three models.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    pub(crate) material: String,
    pub(crate) data: &'static str,
    /// Law of the data, if it is one of the three laws of the paper.
    pub(crate) truth: Option<&'static str>,
    pub(crate) printed: Vec<f64>,
    pub(crate) least_mean_square: Vec<f64>,
    pub(crate) increment: Vec<f64>,
    pub(crate) conformal: Vec<f64>,
    pub(crate) selection: Verdict,
}

/// Row that is to be computed.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    material: IdentifiedMaterial,
    test: RodTestConditions,
    /// Linear rod that makes the data; otherwise, they are those of the law of Table 4, with
    /// significant damping.
    constant_loss: Option<flat_loss::Job>,
    printed: Vec<f64>,
    samples: usize,
}

/// Returns the jobs. The first test of each material is used for the choice of the model.
pub(crate) fn jobs(paper: &PaperD) -> Vec<Job> {
    let flat = flat_loss::jobs(paper);
    let mut jobs = Vec::new();
    for material in paper.identified(UnitReading::Realistic) {
        let Some(test) = paper.tests.iter().find(|t| t.material == material.material) else {
            continue;
        };
        let linear = flat
            .iter()
            .find(|job| job.material.material == material.material);
        for constant_loss in std::iter::once(None).chain(linear.map(Some)) {
            jobs.push(Job {
                material: material.clone(),
                test: test.clone(),
                constant_loss: constant_loss.cloned(),
                printed: paper
                    .adequacy
                    .iter()
                    .filter(|row| row.material == material.material)
                    .flat_map(|row| row.measures.iter().map(|measure| measure.value))
                    .collect(),
                samples: paper.standard_samples_per_model as usize,
            });
        }
    }
    jobs
}

pub(crate) fn run(job: &Job, rig: &Rig) -> Result<Row, Error> {
    let conditions = conditions(&job.test, modulus_of(job.material.values));
    let mut noise = rig.noise(&job.test);
    let test = match &job.constant_loss {
        None => rig.driven(&conditions, job.material.values, &mut noise)?,
        Some(flat) => rig.flat_loss(&conditions, &flat.law()?, &mut noise)?,
    };
    let tests = [test];
    let weighed = virtual_test::stating_the_noise(&tests, rig.striker.velocity)?;
    let [least_mean_square, increment, conformal] = of_the_pattern(&tests, job.samples)?;
    let comparison = Selection::new(Candidate::standard())?.compare(&weighed)?;
    Ok(Row {
        material: job.material.material.clone(),
        data: match job.constant_loss {
            None => "the law of Table 4",
            Some(_) => "constant loss",
        },
        truth: (job.constant_loss.is_none()).then(|| job.material.model.symbol()),
        printed: job.printed.clone(),
        least_mean_square,
        increment,
        conformal,
        selection: verdict(&comparison),
    })
}

/// Returns the measures that need only standard samples: P_i by the two recursions, and conformal
/// p-values, for M_1, M_2 and M_3.
fn of_the_pattern(tests: &[RodTest], samples: usize) -> Result<[Vec<f64>; 3], Error> {
    let models = [
        Candidate::inelastic(Maxwell::new(1e7)?, &[])?,
        Candidate::inelastic(
            MaxwellNorton::from_reference_rate(1.5, 1.0, 10e6)?,
            &[(1.3, 3.0)],
        )?,
        Candidate::inelastic(
            MaxwellGurevichRabinovich::from_reference_rate(1.0, 1.0, 10e6)?,
            // m from 4 to 20 MPa, as σ_ref/m
            &[(0.5, 2.5)],
        )?,
    ];
    let samples = StandardSamples::of(&models, tests, samples, Pattern::Absolute)?;
    let projection = samples.projection(COMPONENTS)?;
    let projected: Vec<Vec<f64>> = samples
        .patterns
        .iter()
        .map(|pattern| projection.project(pattern))
        .collect::<Result<_, _>>()?;
    let measured = projection.project(&samples.measured(tests))?;
    let features: Vec<Vec<f64>> = projected.iter().map(|z| Basis::Linear.of(z)).collect();
    let adequacies = |correction| -> Result<Vec<f64>, Error> {
        let settings = RobbinsMonro {
            correction,
            ..RobbinsMonro::default()
        };
        let weights = Weights::robbins_monro(&features, &samples.class_of, &settings)?;
        Ok(weights.adequacies(&Basis::Linear.of(&measured))?)
    };
    Ok([
        adequacies(Correction::LeastMeanSquare)?,
        adequacies(Correction::Increment)?,
        p_values(&projected, &samples.class_of, &measured)?,
    ])
}
