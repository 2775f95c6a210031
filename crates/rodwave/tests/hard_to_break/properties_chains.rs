//! Properties of linear passive bodies, tested for chains of any elements.

use num_complex::Complex64;
use proptest::prelude::*;
use rodwave::chain::ChainBuilder;
use rodwave::element::CrossSection;
use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, Elastic, KelvinVoigt, Zener};
use rodwave::{Chain, Termination};

use super::cases;

/// An element described by numbers: kind, material, two areas and a length. Masses, stiffnesses and
/// resistances follow from the first area.
type Part = (u8, u8, f64, f64, f64);

fn any_part() -> impl Strategy<Value = Part> {
    (
        0..6_u8,
        0..4_u8,
        -5.0..-3.0_f64,
        -5.0..-3.0_f64,
        0.01..0.4_f64,
    )
        .prop_map(|(kind, material, near, far, length)| {
            (kind, material, 10f64.powf(near), 10f64.powf(far), length)
        })
}

fn any_parts() -> impl Strategy<Value = Vec<Part>> {
    // a row of massless springs and dashpots with a free end has no impedance
    prop::collection::vec(any_part(), 1..8)
        .prop_filter("no mass", |parts| parts.iter().any(|part| part.0 < 4))
}

fn any_omega() -> impl Strategy<Value = f64> {
    (1.0..5.0_f64).prop_map(|exponent| 10f64.powf(exponent))
}

/// Adds a part, or the same part reversed.
fn with(
    builder: ChainBuilder,
    &(kind, material, near, far, length): &Part,
    turned: bool,
) -> ChainBuilder {
    let (near, far) = if turned && (kind == 1 || kind == 2) {
        (far, near)
    } else {
        (near, far)
    };
    let (first, second) = (CrossSection::of_area(near), CrossSection::of_area(far));
    macro_rules! segment {
        ($law:expr) => {{
            let medium = Medium::new(1200.0, $law.unwrap()).unwrap();
            match kind {
                0 => builder.rod(&medium, first, length),
                1 => builder.cone(&medium, first, second, length),
                _ => builder.horn(&medium, first, second, length),
            }
        }};
    }
    match (kind, material) {
        (3, _) => builder.mass(near * 1e3),
        (4, _) => builder.spring(near * 1e10),
        (5, _) => builder.dashpot(near * 1e7),
        (_, 0) => segment!(Elastic::new(3e9)),
        (_, 1) => segment!(Zener::new(1e9, 4e9, 1e-4)),
        (_, 2) => segment!(ConstantQ::new(2e9, 0.2, 1e4)),
        _ => segment!(KelvinVoigt::new(3e9, 1e3)),
    }
}

fn chain(parts: &[Part]) -> Chain {
    let row = parts.iter().fold(Chain::from_impact_face(), |row, part| {
        with(row, part, false)
    });
    row.end(Termination::Free).unwrap()
}

fn reversed(parts: &[Part]) -> Chain {
    let row = parts
        .iter()
        .rev()
        .fold(Chain::from_impact_face(), |row, part| with(row, part, true));
    row.end(Termination::Free).unwrap()
}

/// Factor by which the recursion may lose accuracy: near an antiresonance, the response of an
/// undamped body is the difference of two large numbers, which are bounded by the products of the
/// entries of the plain matrix.
fn loss(chain: &Chain, omega: f64) -> f64 {
    let [[a, b], [c, d]] = chain.transition_matrix(omega).unwrap().entries();
    ((a * d).norm() + (b * c).norm()).max(1.0)
}

proptest! {
    #![proptest_config(cases(128, 1))]

    /// Checks that the far face of a reversed body responds like the impact face of the original.
    #[test]
    fn a_turned_body_has_its_mobilities_exchanged(parts in any_parts(), omega in any_omega()) {
        let (there, back) = (chain(&parts), reversed(&parts));
        let lost = loss(&there, omega);
        prop_assume!(lost < 1e10);
        for (one, other) in [
            (there.mobility(omega), back.far_face_mobility(omega)),
            (there.far_face_mobility(omega), back.mobility(omega)),
        ] {
            let (one, other) = (one.unwrap(), other.unwrap());
            prop_assert!((one - other).norm() < 1e-11 * lost * one.norm(), "{one} {other}");
        }
    }

    /// Checks that the velocity of one face due to a force at the other is the same in both
    /// directions.
    #[test]
    fn transfer_mobilities_are_reciprocal(parts in any_parts(), omega in any_omega()) {
        // a massless last element makes the far face a section that can be evaluated
        let ended = |parts: &[Part], turned: bool| {
            let row = Chain::from_impact_face();
            let row = if turned {
                parts.iter().rev().fold(row, |row, part| with(row, part, true))
            } else {
                parts.iter().fold(row, |row, part| with(row, part, false))
            };
            row.mass(0.0).end(Termination::Free).unwrap()
        };
        let transfer = |chain: &Chain| {
            let last = chain.section(chain.n_elements() - 1, 0.0).unwrap();
            last.state(omega).unwrap().velocity
        };
        let (there, back) = (ended(&parts, false), ended(&parts, true));
        let lost = loss(&there, omega);
        prop_assume!(lost < 1e10);
        let (one, other) = (transfer(&there), transfer(&back));
        prop_assert!((one - other).norm() < 1e-11 * lost * one.norm(), "{one} {other}");
    }

    /// Checks that the flow of power never increases along the body, because no element has a
    /// negative loss, and is never negative.
    #[test]
    fn power_only_dwindles_on_its_way(parts in any_parts(), omega in any_omega()) {
        let chain = chain(&parts);
        let entering = chain.mobility(omega).unwrap();
        prop_assert!(entering.re >= -1e-12 * entering.norm());
        // flow of power over the squared force, -Re(N v*)
        let flow = |element: usize| {
            let state = chain.section(element, 0.0).unwrap().state(omega).unwrap();
            let size = state.normal_force.norm() * state.velocity.norm();
            (-(state.normal_force * state.velocity.conj()).re, size)
        };
        let mut before = entering.re;
        let mut largest = entering.norm();
        for element in 0..chain.n_elements() {
            let (power, size) = flow(element);
            largest = largest.max(size);
            // tolerance: rounding of flows that are almost purely reactive
            prop_assert!(power <= before + 1e-11 * largest, "element {element}: {power} after {before}");
            prop_assert!(power >= -1e-11 * largest);
            before = power;
        }
    }

    /// Checks that the mobility at -ω is the conjugate, because a real force causes a real
    /// velocity.
    #[test]
    fn negative_frequencies_are_conjugate(parts in any_parts(), omega in any_omega()) {
        let chain = chain(&parts);
        let (plus, minus) = (chain.mobility(omega).unwrap(), chain.mobility(-omega).unwrap());
        prop_assert_eq!(plus.conj(), minus);
    }

    /// Checks that the choice of units has no effect. Powers of two scale the input exactly.
    #[test]
    fn units_are_a_matter_of_taste(
        length in 0.01..2.0_f64, area in 1e-6..1e-2_f64, omega in any_omega(), m in -20..20_i32, s in -20..20_i32, kg in -20..20_i32,
    ) {
        let (metre, second, kilogram) = (2f64.powi(m), 2f64.powi(s), 2f64.powi(kg));
        let pascal = kilogram / (metre * second * second);
        let mobility = |metre: f64, second: f64, kilogram: f64, pascal: f64| {
            let law = Zener::new(2e9 * pascal, 3e9 * pascal, 1e-4 * second).unwrap();
            let medium = Medium::new(1200.0 * (kilogram / metre.powi(3)), law).unwrap();
            let section = CrossSection::of_area(area * metre * metre);
            let chain = Chain::from_impact_face()
                .rod(&medium, section, length * metre)
                .mass(0.01 * kilogram)
                .end(Termination::Dashpot(3.0 * kilogram / second))
                .unwrap();
            chain.mobility(omega / second).unwrap()
        };
        let here = mobility(1.0, 1.0, 1.0, 1.0);
        let there: Complex64 = mobility(metre, second, kilogram, pascal) * (kilogram / second);
        // tolerance: γ is computed by a root in polar form, and its rounding error is multiplied by
        // kL
        prop_assert!((here - there).norm() < 1e-11 * here.norm(), "{here} {there}");
    }
}
