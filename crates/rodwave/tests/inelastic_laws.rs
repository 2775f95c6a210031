//! Extreme steps and unphysical parameters of the inelastic laws.

use rodwave::inelastic::{
    Eyring, InelasticLaw, LANES, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton, RelaxationFlow,
};

const MODULUS: f64 = 2.5e9;

#[test]
fn extreme_steps_neither_overflow_nor_create_stress() {
    // e^{|σ|/m} overflows here; the stress must fall to the solution of E1(y) = q, far below its
    // initial value
    let law = MaxwellGurevichRabinovich::new(1e6, 1e5).unwrap();
    let relaxed = law.flow(MODULUS, 1e-6).relax(5e7);
    assert!(relaxed > 0.0 && relaxed < 1e6, "{relaxed}");
    // a step of zero duration changes nothing
    assert_eq!(law.flow(MODULUS, 0.0).relax(5e6), 5e6);
    // sinh(σ/σ*) overflows here: any such stress relaxes to σ* ln((1 + e^{-q})/(1 - e^{-q}))
    let law = Eyring::new(3.0, 1e5).unwrap();
    let flow = law.flow(MODULUS, 1e-6);
    let q: f64 = MODULUS * 1e-6 / law.viscosity();
    let expected = 1e5 * ((1.0 + (-q).exp()) / -(-q).exp_m1()).ln();
    for stress in [1e8, 1e9] {
        assert!((flow.relax(stress) / expected - 1.0).abs() < 1e-13);
        let mut by_parameter = [0.0; 2];
        let relaxed = flow.relax_with_sensitivity(stress, &mut by_parameter);
        assert!(relaxed.by_stress.abs() < 1e-300 && by_parameter.iter().all(|d| d.is_finite()));
    }
    let still = law.flow(MODULUS, 0.0);
    assert_eq!(still.relax(1e9), 1e9);
    assert_eq!(still.change(&[1e9; LANES]), [0.0; LANES]);
}

#[test]
fn unphysical_parameters_are_refused_by_name() {
    for (error, expected) in [
        (
            Maxwell::new(-1.0).unwrap_err(),
            "viscosity [Pa s] is -1, expected a finite value above 0",
        ),
        (
            MaxwellNorton::new(f64::NAN, 1.0).unwrap_err(),
            "exponent kappa is NaN, expected above 0 and at most 1e6",
        ),
        (
            MaxwellGurevichRabinovich::new(1.0, f64::INFINITY).unwrap_err(),
            "activation stress m [Pa] is inf, expected a finite value above 0",
        ),
        (
            Maxwell::new(1.0).unwrap().with_parameters(&[]).unwrap_err(),
            "parameter array has 0 entries, expected 1",
        ),
    ] {
        assert_eq!(error.to_string(), expected);
    }
}
