//! Input that chains reject, and their results at zero frequency.

use num_complex::Complex64;
use rodwave::element::CrossSection;
use rodwave::medium::Medium;
use rodwave::modulus::{Maxwell, PowerLawPropagation};
use rodwave::{Chain, RodwaveError, Termination};

use crate::bodies::{aluminium, circle, cone};

#[test]
fn static_limits() {
    let face = circle(0.02);
    let dashpot = Chain::from_impact_face()
        .rod(&aluminium(), face, 0.1)
        .mass(1.0)
        .end(Termination::Dashpot(50.0))
        .unwrap();
    assert!((dashpot.mobility(0.0).unwrap() - 0.02).norm() < 1e-16);
    let long = Chain::from_impact_face()
        .end(Termination::semi_infinite(&aluminium(), face))
        .unwrap();
    let z = (69e9_f64 * 2700.0).sqrt() * CrossSection::from(face).area();
    assert!((long.mobility(0.0).unwrap().re * z - 1.0).abs() < 1e-14);
    let error = |chain: &Chain| chain.mobility(0.0).unwrap_err().to_string();
    // E(0) of the power laws of Nylon-6 is 0, as in a fluid; the mobility of a free body has a pole
    // at ω = 0
    assert_eq!(
        error(&cone(Termination::Dashpot(0.0))),
        "element 0: characteristic impedance per area at 0 Hz [Pa s/m] is 0, expected a finite value above 0"
    );
    let free = Chain::from_impact_face()
        .rod(&aluminium(), face, 0.1)
        .end(Termination::Free)
        .unwrap();
    assert_eq!(
        error(&free),
        "magnitude of the impedance of the face is 0, expected a finite value above 0"
    );
    // the static impedance of a fluid is 0
    let fluid = Medium::new(1000.0, Maxwell::new(1e9, 1e6).unwrap()).unwrap();
    let fluid = Chain::from_impact_face()
        .mass(1.0)
        .rod(&fluid, face, 0.1)
        .end(Termination::Fixed)
        .unwrap();
    assert!(matches!(
        fluid.mobility(0.0),
        Err(RodwaveError::InElement { index: 1, .. })
    ));
}

#[test]
fn laws_and_impedances_without_a_value_are_refused() {
    // a law without a value is reported with its element, the impedance of a termination without a
    // value is reported without an element
    let silent = Termination::impedance(|_| Complex64::new(f64::NAN, 0.0));
    let chain = Chain::from_impact_face().end(silent).unwrap();
    assert!(matches!(
        chain.mobility(1.0),
        Err(RodwaveError::NonPhysical { .. })
    ));
    // wave number 1e308 over 100 m
    let dense = Medium::new(1.0, PowerLawPropagation::new(0.0, 1.0, 1e300, 1.0).unwrap()).unwrap();
    let chain = Chain::from_impact_face()
        .mass(1.0)
        .rod(&dense, circle(0.1), 100.0)
        .end(Termination::Free)
        .unwrap();
    assert!(matches!(
        chain.mobility(1e8),
        Err(RodwaveError::InElement { index: 1, .. })
    ));
}
