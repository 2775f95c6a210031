//! Estimate as columns and as curves.

use cmod::estimate::PlottedQuantity;
use cmod::two_point::SpecimenUncertainty;
use cmod::{ModulusEstimate, TwoPoint};
use num_complex::Complex64;

use super::rod::{SPECIMEN, acceleration_ratio};
use crate::materials::polypropylene;

/// Returns an estimate on lines from 100 Hz to 4 kHz. The first lines have too long a wavelength,
/// one line is bad, and the lines near half a wave scatter.
fn estimate() -> ModulusEstimate {
    let medium = polypropylene(SPECIMEN.density);
    let frequency_hz: Vec<f64> = (1..=40).map(|j| 100.0 * f64::from(j)).collect();
    let mut ratio = acceleration_ratio(&medium, &SPECIMEN, 0.0, &frequency_hz);
    ratio[14] = Complex64::new(f64::NAN, 0.0);
    let variance: Vec<f64> = ratio.iter().map(|r| 1e-6 * r.norm_sqr()).collect();
    TwoPoint::new(SPECIMEN)
        .unwrap()
        .with_specimen_uncertainty(SpecimenUncertainty {
            length: 2e-4,
            ..SpecimenUncertainty::default()
        })
        .unwrap()
        .estimate(&frequency_hz, &ratio, &variance)
        .unwrap()
}

#[test]
fn columns_hold_what_the_lines_do() {
    let estimate = estimate();
    let columns = estimate.columns();
    assert_eq!(columns.verdicts.len(), 39);
    assert!(columns.iter().all(|column| column.values.len() == 39));
    let values = |name: &str| columns.values(name).unwrap();
    for (row, line) in estimate.lines().iter().enumerate() {
        let exact = |name: &str, value: f64| {
            assert!(
                (values(name)[row] - value).abs() <= 0.0,
                "{name} of row {row}"
            );
        };
        exact("line", line.index as f64);
        exact("frequency", line.frequency_hz);
        exact("storage_modulus", line.modulus.re);
        exact("loss_modulus", line.modulus.im);
        exact("modulus_covariance", line.covariance().mixed);
        exact("phase_velocity_error", line.standard_error.phase_velocity);
        exact("valid", f64::from(u8::from(line.validity.is_valid())));
        // the random and the systematic part add up to the total
        let total = values("storage_modulus_random_error")[row]
            .hypot(values("storage_modulus_systematic_error")[row]);
        assert!((total / values("storage_modulus_error")[row] - 1.0).abs() < 1e-12);
    }
    let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
    let unique: std::collections::BTreeSet<&str> = names.iter().copied().collect();
    assert_eq!(unique.len(), names.len());
    assert!(columns.values("no such column").is_none());
    assert!(columns.verdicts[0].contains("length over which waves are counted"));
}

#[test]
fn curves_are_in_pieces_of_one_verdict() {
    let estimate = estimate();
    let curve = estimate.curve(PlottedQuantity::LossFactor, 2.0);
    let total: usize = curve.segments.iter().map(|s| s.values.len()).sum();
    assert_eq!(total, 39);
    assert!(!curve.segments[0].valid);
    for segment in &curve.segments {
        for (j, frequency_hz) in segment.frequency_hz.iter().enumerate() {
            let line = estimate
                .lines()
                .iter()
                .find(|line| line.frequency_hz.total_cmp(frequency_hz).is_eq());
            let line = line.unwrap();
            assert_eq!(line.validity.is_valid(), segment.valid);
            let half = 0.5 * (segment.upper[j] - segment.lower[j]);
            assert!((half / (2.0 * line.standard_error.loss_factor) - 1.0).abs() < 1e-10);
        }
        // nothing is drawn across the refused line at 1500 Hz
        let (first, last) = (
            segment.frequency_hz[0],
            segment.frequency_hz[segment.frequency_hz.len() - 1],
        );
        assert!(last < 1500.0 || first > 1500.0);
    }
    let neighbours = curve.segments.windows(2);
    for pair in neighbours {
        let gap = pair[1].frequency_hz[0] - pair[0].frequency_hz[pair[0].frequency_hz.len() - 1];
        assert!(pair[0].valid != pair[1].valid || gap > 150.0);
    }
    assert_eq!(curve.quantity.unit(), "1");
}
