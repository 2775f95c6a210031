//! Test of the stated sensitivities to length and density of the specimen, by fits of the same
//! histories with another length and density.

use std::sync::Arc;

use maxwellid::linear::{ConstantQ, LinearModel};
use maxwellid::{Estimate, Fit, Noise, RodModel, RodTest, RodTestData, Scale, SpecimenUncertainty};
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};

use crate::virtual_rod::{DENSITY, LENGTH, V0, struck};

const LONGER: f64 = 1.002;
const DENSER: f64 = 1.005;

fn estimates(model: &Arc<dyn RodModel>, data: &RodTestData) -> Vec<Estimate> {
    let test = RodTest::new(data.clone()).unwrap().with_noise(0.05, 0.05);
    // this cell gives the same number of cells for both lengths
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
        // tolerance: the fits end within 0.001 standard errors, and the sensitivities are linear
        let tolerance = 3e-3 * before.standard_error + 0.01 * expected.abs();
        assert!(
            (moved - expected).abs() < tolerance,
            "{} of {}: {moved}, expected {expected}, error {}",
            before.symbol,
            model.name(),
            before.standard_error
        );
    }
    // d ln E = 2 d ln L + d ln rho for every law
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
    let data = struck(LENGTH, V0, 3e9, &law, 100).data;
    let sharp = MaxwellGurevichRabinovich::from_reference_rate(1.0, 8.0, 10e6).unwrap();
    let linear = Maxwell::from_reference_rate(3.0, 10e6).unwrap();
    moves_as_its_sensitivity_says(Arc::new(law), &data);
    moves_as_its_sensitivity_says(Arc::new(sharp), &data);
    moves_as_its_sensitivity_says(Arc::new(linear), &data);
    moves_as_its_sensitivity_says(Arc::new(LinearModel::new(ConstantQ::default())), &data);
}
