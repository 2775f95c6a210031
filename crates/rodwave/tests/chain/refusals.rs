//! What chains refuse, and what they answer at zero frequency.

use super::bodies::{aluminium, circle, cone, cylinder, nylon};
use num_complex::Complex64;
use rodwave::chain::AnalyticChain;
use rodwave::element::{Circle, CrossSection};
use rodwave::medium::Medium;
use rodwave::modulus::{Maxwell, PowerLawPropagation};
use rodwave::{Chain, RodwaveError, Termination};

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
    // a free body has a pole
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
    // a fluid flows
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
fn impossible_bodies_are_refused() {
    let (nylon, face) = (nylon(), circle(0.02));
    let builder = || Chain::from_impact_face().rod(&nylon, face, 0.1);
    let cases = [
        (
            builder().rod(&nylon, face, 0.0),
            "element 1: length [m] is 0, expected a finite value above 0",
        ),
        (
            builder().cone(&nylon, face, face, -0.5),
            "element 1: length [m] is -0.5, expected a finite value above 0",
        ),
        (
            builder().horn(&nylon, face, face, f64::NAN),
            "element 1: length [m] is NaN, expected a finite value above 0",
        ),
        (
            builder().mass(-0.1),
            "element 1: mass [kg] is -0.1, expected a finite value, 0 or above",
        ),
        (
            builder().spring(0.0),
            "element 1: stiffness [N/m] is 0, expected a finite value above 0",
        ),
        (
            builder()
                .mass(1.0)
                .dashpot(f64::INFINITY)
                .rod(&nylon, face, -1.0)
                .mass(1.0),
            "element 2: resistance of the dashpot [kg/s] is inf, expected a finite value above 0",
        ),
    ];
    for (builder, expected) in cases {
        assert_eq!(
            builder.end(Termination::Free).unwrap_err().to_string(),
            expected
        );
    }
    assert_eq!(
        builder()
            .end(Termination::Mass(-1.0))
            .unwrap_err()
            .to_string(),
        "mass of the termination [kg] is -1, expected a finite value, 0 or above"
    );
    assert_eq!(
        Circle::of_diameter(-0.02).unwrap_err().to_string(),
        "diameter [m] is -0.02, expected a finite value above 0"
    );
    assert_eq!(
        CrossSection::of_area(0.0).unwrap_err().to_string(),
        "area of the cross-section [m^2] is 0, expected a finite value above 0"
    );
    let chain = builder().mass(0.1).end(Termination::Free).unwrap();
    for (element, distance, expected) in [
        (
            2,
            0.0,
            "the row of elements up to the section has 3 entries, expected 2",
        ),
        (
            0,
            0.2,
            "element 0: distance of the section [m] is 0.2, expected between 0 and the length of the element",
        ),
        (
            1,
            0.1,
            "element 1: distance of the section [m] is 0.1, expected 0 in an element without length",
        ),
    ] {
        assert_eq!(
            chain.section(element, distance).unwrap_err().to_string(),
            expected
        );
    }
    assert!(chain.section(0, f64::NAN).is_err());
}

#[test]
fn impossible_frequencies_are_refused() {
    let chain = cylinder(Termination::Free);
    for omega in [f64::NAN, f64::INFINITY] {
        for result in [chain.mobility(omega), chain.far_face_mobility(omega)] {
            assert!(matches!(
                result,
                Err(RodwaveError::NonPhysical {
                    quantity: "angular frequency [rad/s]",
                    ..
                })
            ));
        }
    }
    let analytic = AnalyticChain::analytic_from_impact_face()
        .rod(&aluminium(), circle(0.02), 0.1)
        .end(Termination::Free)
        .unwrap();
    for s in [
        Complex64::new(-1.0, 5.0),
        Complex64::new(f64::NAN, 0.0),
        Complex64::new(1.0, f64::INFINITY),
    ] {
        assert!(matches!(
            analytic.mobility_at_s(s),
            Err(RodwaveError::NonPhysical { .. })
        ));
    }
    // A law that has no value is reported with its element, an impedance that has none as such
    let silent = Termination::impedance(|_| Complex64::new(f64::NAN, 0.0));
    let chain = Chain::from_impact_face().end(silent).unwrap();
    assert!(matches!(
        chain.mobility(1.0),
        Err(RodwaveError::NonPhysical { .. })
    ));
    // k = 1e308 over 100 m
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
