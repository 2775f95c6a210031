//! Change of the parameters with length and density of the specimen: by fits of the same histories
//! to another specimen.

use std::sync::Arc;

use maxwellid::linear::{ConstantQ, LinearModel};
use maxwellid::{
    Estimate, Fit, Noise, Provenance, RodModel, RodTest, RodTestData, Scale, SpecimenUncertainty,
};
use rodwave::InelasticRod;
use rodwave::band_limited::Recorder;
use rodwave::experiment::Acquisition;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::{InelasticLaw, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::lumped::{self, LumpedRod};

const LENGTH: f64 = 0.4;
const DENSITY: f64 = 1100.0;
const MODULUS: f64 = 3e9;
const LONGER: f64 = 1.002;
const DENSER: f64 = 1.005;

/// Histories of a struck rod by the lumped chain.
fn histories<L: InelasticLaw>(law: &L) -> RodTestData {
    let rod = |length| InelasticRod::new(length, DENSITY, MODULUS, law.clone()).unwrap();
    let record = ImpactTest {
        striker: Striker::PAPER_D,
        rod: rod(LENGTH + 0.008),
        diameter: 0.016,
        section_distance: LENGTH,
    }
    .record(
        &Acquisition {
            recorder: Recorder {
                rate_hz: 51_200.0,
                cutoff_hz: 16_000.0,
            },
            samples_before: 32,
            samples_after: 100,
            transducer_range: 0.020,
        },
        1e-3,
    )
    .unwrap();
    let times: Vec<f64> = (0..record.excitation.len())
        .map(|k| f64::from(u32::try_from(k).unwrap()) / record.sampling_rate_hz)
        .collect();
    let response = LumpedRod::new(&rod(LENGTH), 200, 0.5)
        .unwrap()
        .free_end_velocity(&record.excitation_before_sampling, &times)
        .unwrap();
    RodTestData {
        name: "virtual rod".into(),
        length: LENGTH,
        density: DENSITY,
        impact_velocity: 10.0,
        sampling_rate_hz: record.sampling_rate_hz,
        excitation: record.excitation,
        response,
        provenance: Provenance::Virtual {
            generator: lumped::GENERATOR.into(),
        },
    }
}

fn estimates(model: &Arc<dyn RodModel>, data: &RodTestData) -> Vec<Estimate> {
    let test = RodTest::new(data.clone()).unwrap().with_noise(0.05, 0.05);
    // the number of cells is the same for both lengths
    Fit::of(model.clone())
        .with_cell(LENGTH / 39.5)
        .to(&[test.unwrap()])
        .unwrap()
        .identifiability(Noise::Stated)
        .unwrap()
        .estimates
}

fn moves_as_its_sensitivity_says(model: Arc<dyn RodModel>, data: &RodTestData) {
    let before = estimates(&model, data);
    let after = estimates(
        &model,
        &RodTestData {
            length: LONGER * LENGTH,
            density: DENSER * DENSITY,
            ..data.clone()
        },
    );
    for (before, after) in before.iter().zip(&after) {
        let moved = match before.scale {
            Scale::Ratio => (after.value / before.value).ln(),
            Scale::Difference => after.value - before.value,
        };
        let expected =
            before.sensitivity.length * LONGER.ln() + before.sensitivity.density * DENSER.ln();
        // the fits end within a thousandth of a standard error
        let tolerance = 3e-3 * before.standard_error + 0.01 * expected.abs();
        assert!(
            (moved - expected).abs() < tolerance,
            "{} of {}: {moved}, expected {expected}, error {}",
            before.symbol,
            model.name(),
            before.standard_error
        );
    }
    // d ln E = 2 d ln L + d ln rho, whatever the law
    let modulus = before.first().unwrap().clone();
    let random = modulus.standard_error;
    let specimen = SpecimenUncertainty::relative(0.00125, 0.005).unwrap();
    let modulus = modulus.with_specimen_uncertainty(&specimen);
    let by_specimen = 0.0025_f64.hypot(0.005);
    assert!((modulus.specimen_error / by_specimen - 1.0).abs() < 1e-12);
    assert!((modulus.standard_error / random.hypot(by_specimen) - 1.0).abs() < 1e-12);
}

#[test]
fn r08_parameters_move_with_the_specimen_as_their_sensitivities_say() {
    let law = MaxwellNorton::from_reference_rate(2.0, 8.0, 10e6).unwrap();
    let data = histories(&law);
    let sharp = MaxwellGurevichRabinovich::from_reference_rate(1.0, 8.0, 10e6).unwrap();
    let linear = Maxwell::from_reference_rate(3.0, 10e6).unwrap();
    moves_as_its_sensitivity_says(Arc::new(law), &data);
    moves_as_its_sensitivity_says(Arc::new(sharp), &data);
    moves_as_its_sensitivity_says(Arc::new(linear), &data);
    moves_as_its_sensitivity_says(Arc::new(LinearModel::new(ConstantQ::default())), &data);
}
