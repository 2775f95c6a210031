//! Results that can be checked without statistics.

use std::sync::Arc;

use impulse::hopkinson::{BarMaterial, Curve, Finding};
use rodwave::line::Segment;
use rodwave::modulus::Elastic;

use super::rig::{self, RATE};

/// A bar directly on a bar: F1 = F2 inside the band, and nothing is reflected.
#[test]
fn hopkinson_bars_without_a_specimen_have_equal_forces() {
    let rig = rig::nylon();
    let truth = rig.shot(None).unwrap();
    let record = rig::record(&truth, &rig::quiet(&rig, 3e-6), 5);
    // there is no specimen: the stated length has no meaning
    let result = rig::evaluated(&rig::test_of(&rig, 0.01, rig.diameter), &record);
    let band = result
        .expanded_uncertainty(Curve::ForceDifference, 0.99)
        .unwrap();
    let difference = result.curves.of(Curve::ForceDifference);
    let outside = difference
        .iter()
        .zip(&band)
        .filter(|(d, band)| d.abs() > **band)
        .count();
    // tolerance: 1 % of the samples are expected outside the 99 % band, in groups because the band
    // limit correlates them; 5 % are allowed
    assert!(
        outside * 20 < difference.len(),
        "{outside} of {}",
        difference.len()
    );
    assert!(
        (result.equilibrium.force_ratio - 1.0).abs() < 0.004,
        "{:?}",
        result.equilibrium.force_ratio
    );
    assert!(
        result
            .findings
            .iter()
            .any(|f| matches!(f, Finding::StrongerThanBars { .. })),
        "{:?}",
        result.findings
    );

    // the same bars, assumed elastic with the static modulus, are found to be viscoelastic
    let mut elastic = rig::test_of(&rig, 0.01, rig.diameter);
    for bar in &mut elastic.bars {
        bar.material =
            BarMaterial::new(rig.density, Arc::new(Elastic::new(2.6e9).unwrap())).unwrap();
    }
    let wrong = rig::evaluated(&elastic, &record);
    let most = |result: &impulse::hopkinson::HopkinsonResult| {
        let samples = result.curves.of(Curve::ForceDifference).iter();
        samples.fold(0.0_f64, |most, x| most.max(x.abs()))
    };
    assert!(
        most(&wrong) > 10.0 * most(&result),
        "{} {}",
        most(&wrong),
        most(&result)
    );
}

/// An elastic specimen between elastic bars: momentum and energy balance, and the stress is the
/// modulus times the strain.
#[test]
fn hopkinson_elastic_specimen_has_its_modulus() {
    let rig = rig::steel();
    let (modulus, length, diameter) = (20e9, 0.006, 0.012);
    let specimen = Segment::elastic(length, rig::area(diameter), 1200.0, modulus).unwrap();
    let truth = rig.shot(Some(specimen)).unwrap();
    let record = rig::record(&truth, &rig::quiet(&rig, 1e-8), 2);
    let result = rig::evaluated(&rig::test_of(&rig, length, diameter), &record);
    let (stress, strain) = (
        result.curves.of(Curve::Stress),
        result.curves.of(Curve::Strain),
    );
    let middle = rig::middle(&result);
    let found = stress[middle] / strain[middle];
    // tolerance: the march rounds the wave speeds between the gauges by 2e-4, and the small strain
    // is a difference of nearly equal waves
    assert!((found / modulus - 1.0).abs() < 0.02, "{found:e}");
    // both faces transmit the same impulse
    let impulse =
        |curve: Curve| -> f64 { result.curves.of(curve).iter().sum::<f64>() * result.time_step };
    let exact: f64 = truth.force[0].iter().sum::<f64>() * truth.step;
    let (first, second) = (impulse(Curve::Force1), impulse(Curve::Force2));
    assert!(
        (first / second - 1.0).abs() < 2e-3,
        "{first} {second} {exact}"
    );
    let energies = result.energies;
    assert!(
        energies.residual().abs() < 2e-3 * energies.into_specimen,
        "{energies:?}"
    );
    let ledger = truth.ledger;
    assert!(ledger.energy_residual().abs() < 1e-9 * ledger.supplied.abs());
    // the transmitted force on the plateau is the true one
    let time = result.time_at(middle);
    let [f1, f2] = [0, 1].map(|face| truth.seen(&truth.force[face], RATE, time));
    let found = result.curves.of(Curve::Force2)[middle];
    assert!((found / f2 - 1.0).abs() < 2e-3, "{found} {f1} {f2}");
}

/// Stress and strain of the specimens from nearly noise-free records, compared sample by sample.
#[test]
fn hopkinson_curves_are_those_of_the_specimen() {
    for (name, rig, specimen, diameter) in [
        ("nylon", rig::nylon(), rig::norton(), 0.014),
        ("steel", rig::steel(), rig::hardening(), 0.010),
    ] {
        let length = specimen.length();
        let truth = rig.shot(Some(specimen)).unwrap();
        let record = rig::record(&truth, &rig::quiet(&rig, 1e-9), 2);
        let result = rig::evaluated(&rig::test_of(&rig, length, diameter), &record);
        let worst = rig::worst(&truth, &result, length, diameter);
        // tolerance: the band limit rounds the yield of the metal, and the march rounds wave speeds
        // by 2e-4
        assert!(worst[0] < 0.02 && worst[1] < 0.02, "{name}: {worst:?}");
        assert!(result.findings.is_empty(), "{name}: {:?}", result.findings);
    }
}
