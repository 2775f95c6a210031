//! Limits of the plain product of transition matrices.

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::transition::TransitionMatrix;
use testbed::difference::relative;

/// Checks the limits for large αL that the module states: the mobility keeps its digits until the
/// matrix overflows; the determinant does not.
#[test]
fn large_damping_spoils_the_determinant_before_the_mobility() {
    let (z_a, z_b) = (Complex64::new(1100.0, 80.0), Complex64::new(900.0, -10.0));
    let product = |alpha_length: f64| {
        let a = TransitionMatrix::uniform_rod(Complex64::new(alpha_length, 3.0), z_a, 1.0);
        let b = TransitionMatrix::uniform_rod(Complex64::new(alpha_length, 2.0), z_b, 1.0);
        b.unwrap() * a.unwrap()
    };
    // Mobility of A backed by B, with B as the load impedance of A, in a form without overflow: 1 -
    // tanh < 1e-15 beyond 18.
    let long = product(20.0).mobility_free_end().unwrap();
    assert!(relative(long, 1.0 / z_a) < 1e-14);
    assert!((product(20.0).determinant() - 1.0).norm() > 1.0);
    // near 300 + 300, a plain quotient of the entries, which exceed 1e250, would overflow
    assert!(relative(product(300.0).mobility_free_end().unwrap(), 1.0 / z_a) < 1e-14);
    assert!(product(400.0).mobility_free_end().is_err());
}

#[test]
fn impossible_elements_are_refused() {
    let one = Complex64::ONE;
    let refused = [
        TransitionMatrix::uniform_rod(one, one, 0.0),
        TransitionMatrix::uniform_rod(one, one, f64::NAN),
        TransitionMatrix::uniform_rod(one, Complex64::ZERO, 1.0),
        TransitionMatrix::uniform_rod(Complex64::new(701.0, 1.0), one, 1.0),
        TransitionMatrix::uniform_rod(Complex64::new(f64::NAN, 1.0), one, 1.0),
        TransitionMatrix::uniform_rod(Complex64::new(1.0, f64::INFINITY), one, 1.0),
        TransitionMatrix::lumped_mass(-1e-3, 1.0),
        TransitionMatrix::lumped_mass(1e-3, f64::NAN),
    ];
    for (case, result) in refused.into_iter().enumerate() {
        assert!(
            matches!(result, Err(RodwaveError::NonPhysical { .. })),
            "case {case}"
        );
    }
    let at_rest = TransitionMatrix::uniform_rod(Complex64::ZERO, one, 1.0).unwrap();
    assert_eq!(at_rest, TransitionMatrix::identity());
    let error = TransitionMatrix::identity()
        .mobility_free_end()
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "magnitude of the entry P12 [kg/s] is 0, expected a finite value above 0"
    );
}
