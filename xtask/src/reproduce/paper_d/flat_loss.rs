//! Laws of the paper fitted to linear rods with a loss factor that does not depend on frequency, as
//! is nearly the case for polymers.

use std::f64::consts::TAU;

use maxwellid::linear::{self, LinearModel};
use maxwellid::selection::{Candidate, Selection};
use maxwellid::{Fit, Noise, RodTest};
use rodwave::inelastic::Elastic;
use rodwave::modulus::{ConstantQ, PronyStandIn};
use serde::Serialize;

use super::super::Error;
use super::identify::{Parameter, Settings, modulus_of, one_by_one};
use super::materials::{CELL, conditions, identified_from};
use super::verdict::{Verdict, verdict};
use super::virtual_test::{self, FLAT_LOSS_BAND, FLAT_LOSS_BRANCHES, Rig};
use testbed::papers::paper_d::{
    IdentifiedMaterial, ModelKind, PaperD, RodTestConditions, UnitReading,
};

/// Loss factors at some kHz: of the plastics, from handbooks and papers C and E; of the rubber,
/// that of natural rubber with carbon black.
const LOSS_FACTORS: [(&str, f64); 5] = [
    ("Polypropylene", 0.07),
    ("Polyamide 6", 0.03),
    ("Polyoximethylene", 0.025),
    ("Polyethylene", 0.08),
    ("Rubber", 0.3),
];

/// Frequency to which the modulus of Table 4 is assigned, in Hz.
const REFERENCE_HZ: f64 = 3e3;

/// Result for one material.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FlatLoss {
    pub(crate) material: String,
    pub(crate) model: &'static str,
    pub(crate) loss_factor: f64,
    /// Greatest error of the series that represents constant loss in the data.
    pub(crate) stand_in_error: f64,
    /// Parameters of the law of the paper, from four tests.
    pub(crate) parameters: Vec<Parameter>,
    /// δ of the law of the paper, with Q = 1, 2, 3, 4 tests.
    pub(crate) errors: Vec<f64>,
    pub(crate) printed_errors: Vec<f64>,
    /// δ of an elastic rod and of a rod of constant loss, from four tests.
    pub(crate) elastic_error: f64,
    pub(crate) flat_loss_error: f64,
    /// Loss factor found by the fit of constant loss, and the standard error of its logarithm.
    pub(crate) loss_factor_found: f64,
    pub(crate) standard_error: f64,
    pub(crate) selection: Verdict,
}

/// Material that is to be computed.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    pub(crate) material: IdentifiedMaterial,
    pub(crate) loss_factor: f64,
    tests: Vec<RodTestConditions>,
    printed_errors: Vec<f64>,
}

pub(crate) fn jobs(paper: &PaperD) -> Vec<Job> {
    paper
        .identified(UnitReading::Realistic)
        .iter()
        .filter_map(|material| {
            let (_, loss_factor) = LOSS_FACTORS
                .iter()
                .find(|(name, _)| *name == material.material)?;
            let (tests, printed_errors) = identified_from(paper, &material.material);
            Some(Job {
                material: material.clone(),
                loss_factor: *loss_factor,
                tests,
                printed_errors,
            })
        })
        .collect()
}

impl Job {
    /// Returns the law of the data.
    pub(crate) fn law(&self) -> Result<ConstantQ, Error> {
        Ok(ConstantQ::new(
            modulus_of(self.material.values),
            self.loss_factor,
            TAU * REFERENCE_HZ,
        )?)
    }
}

pub(crate) fn run(job: &Job, rig: &Rig) -> Result<FlatLoss, Error> {
    let law = job.law()?;
    let modulus = modulus_of(job.material.values);
    let tests: Vec<RodTest> = job
        .tests
        .iter()
        .map(|test| rig.flat_loss(&conditions(test, modulus), &law, &mut rig.noise(test)))
        .collect::<Result<_, Error>>()?;
    let settings = Settings {
        cell: Some(CELL),
        round_trip: false,
        noise: Noise::FromResidual,
        recorder_noise: virtual_test::NOISE_OF_TABLE_5,
    };
    let outcomes = one_by_one(job.material.model, &tests, settings)?;
    let weighed = virtual_test::stating_the_noise(&tests, rig.striker.velocity)?;
    let elastic = Fit::of(Elastic).with_cell(CELL).to(&tests)?;
    let flat = Fit::of(LinearModel::new(linear::ConstantQ::default())).to(&weighed)?;
    let loss_factor = flat
        .identifiability(Noise::Stated)
        .and_then(|found| found.estimates.into_iter().nth(1))
        .ok_or("the fit with constant loss has no loss factor")?;
    let comparison = Selection::new(Candidate::standard())?.compare(&weighed)?;
    Ok(FlatLoss {
        material: job.material.material.clone(),
        model: job.material.model.symbol(),
        loss_factor: job.loss_factor,
        stand_in_error: PronyStandIn::new(&law, FLAT_LOSS_BAND, FLAT_LOSS_BRANCHES)?
            .greatest_error(),
        parameters: outcomes
            .last()
            .map(|outcome| outcome.parameters.clone())
            .unwrap_or_default(),
        errors: outcomes.iter().map(|o| o.relative_error).collect(),
        printed_errors: job.printed_errors.clone(),
        elastic_error: elastic.relative_error(),
        flat_loss_error: flat.relative_error(),
        loss_factor_found: loss_factor.value.exp(),
        standard_error: loss_factor.standard_error,
        selection: verdict(&comparison),
    })
}

impl FlatLoss {
    /// Returns the shape parameter of the law of the paper: κ, or m in MPa.
    pub(crate) fn shape(&self) -> Option<String> {
        let of = |symbol: &str| {
            self.parameters
                .iter()
                .find(|p| p.symbol == symbol && p.identified)
                .and_then(|p| p.value)
        };
        if self.model == ModelKind::MaxwellNorton.symbol() {
            return of("kappa").map(|kappa| format!("kappa = {kappa:.2}"));
        }
        of("m").map(|m| format!("m = {:.1} MPa", 1e-6 * m))
    }
}
