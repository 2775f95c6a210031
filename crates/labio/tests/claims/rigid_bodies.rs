//! Lines at low frequency from a weighed mass: their errors, and what is refused.

use std::f64::consts::TAU;

use labio::{LineValidity, ResponseKind, RigidBand, RigidBody};
use num_complex::Complex64;

use super::histories::{MASS, measured};

const BAND: RigidBand = RigidBand {
    from_hz: 60.0,
    to_hz: 250.0,
};

#[test]
fn low_lines_have_the_error_of_the_weighing() {
    let accelerance = measured(1.0, 0.0).unwrap();
    let body = RigidBody::new(MASS, 0.001).unwrap();
    let completed = body.complete(&accelerance, BAND).unwrap();
    assert_eq!(completed.first_measured, 6);
    for line in 0..6 {
        let variance = completed.response.variance.as_ref().unwrap()[line];
        // relative error of the weighing, 0.001/3.79; tolerance: the error of the elastic term,
        // which is far smaller
        assert!(((variance / 2.0).sqrt() * MASS * MASS / 0.001 - 1.0).abs() < 0.02);
        assert!(completed.response.coherence.as_ref().unwrap()[line].is_nan());
        assert_eq!(completed.response.validity[line], LineValidity::Valid);
    }
    assert_eq!(completed.response.values[6..], accelerance.values[6..]);
    // tolerance: the term of fourth order, a few 1e-6
    assert!((completed.apparent_mass / MASS - 1.0).abs() < 2e-5);
}

#[test]
fn mobility_tends_to_one_over_i_omega_m_and_has_no_value_at_zero() {
    let mobility = measured(1.0, 0.0)
        .unwrap()
        .to_kind(ResponseKind::Mobility)
        .unwrap();
    let body = RigidBody::new(MASS, 0.0).unwrap();
    let completed = body.complete(&mobility, BAND).unwrap().response;
    assert_eq!(completed.kind().unwrap(), ResponseKind::Mobility);
    assert_eq!(completed.validity[0], LineValidity::NotDefined);
    let rigid = 1.0 / Complex64::new(0.0, TAU * 10.0 * MASS);
    // tolerance: the elastic part, (omega L/c)^2/3 = 1.3e-5 at 10 Hz
    assert!((completed.values[1] / rigid - 1.0).norm() < 2e-5);
    assert_eq!(completed.values[6..], mobility.values[6..]);
}

#[test]
fn the_apparent_mass_of_a_wide_band_has_the_terms_of_higher_order() {
    let body = RigidBody::new(MASS, 0.001).unwrap();
    // up to half the first antiresonance: there (omega L/c)^4/45 is 8e-3, and the next term, 2
    // (omega L/c)^6/945, is 5e-4
    let wide = RigidBand {
        to_hz: 1250.0,
        ..BAND
    };
    let completed = body.complete(&measured(1.0, 1e-4).unwrap(), wide).unwrap();
    let off = completed.apparent_mass / MASS - 1.0;
    assert!(off.abs() < 2e-4, "{off}");
}

#[test]
fn a_band_without_lines_and_a_body_without_mass_are_refused() {
    let response = measured(1.0, 0.0).unwrap();
    let body = RigidBody::new(MASS, 0.0).unwrap();
    let band = |from_hz, to_hz| RigidBand { from_hz, to_hz };
    let refusals = [
        RigidBody::new(0.0, 0.0).map(|_| ()),
        RigidBody::new(1.0, f64::NAN).map(|_| ()),
        body.complete(&response, band(60.0, 75.0)).map(|_| ()),
        body.complete(&response, band(60.0, 60.0)).map(|_| ()),
    ]
    .map(|result| result.unwrap_err().to_string())
    .join("\n");
    insta::assert_snapshot!(refusals, @r"
    mass [kg] is 0, expected a finite value above 0
    standard error of the mass [kg] is NaN, expected a finite value, not negative
    the band of a nearly rigid body has 2 samples, expected at least 4
    end of the band of a nearly rigid body [Hz] is 60, expected a finite frequency above its start
    ");
}
