//! Transition matrices of rods, cones, horns and lumped elements: values at complex s, the horn as
//! the limit of short cones, volumes, and properties of every element, such as its determinant.

use num_complex::Complex64;
use proptest::prelude::*;
use rodwave::element::{CrossSection, Segment};
use rodwave::transition::TransitionMatrix;

use crate::bodies::polymer;

type Entries = [[Complex64; 2]; 2];

fn section(area: f64) -> CrossSection {
    CrossSection::of_area(area).unwrap()
}

/// Characteristic impedance of the polymer per area [Pa s/m], by which all entries are scaled to
/// one order of magnitude.
const SPECIFIC_IMPEDANCE: f64 = 1.4e6;

/// Largest difference between entries, in units in which the impedance of a rod of 1 cm² is 1.
fn distance(a: &Entries, b: &Entries) -> f64 {
    let z = SPECIFIC_IMPEDANCE * 1e-4;
    let unit = [[1.0, z], [1.0 / z, 1.0]];
    let mut largest: f64 = 0.0;
    for row in 0..2 {
        for column in 0..2 {
            largest = largest.max((a[row][column] - b[row][column]).norm() / unit[row][column]);
        }
    }
    largest
}

fn size(a: &Entries) -> f64 {
    distance(a, &[[Complex64::ZERO; 2]; 2])
}

/// Checks that the matrices at s = iω are those at ω, and that the matrices at real s are real.
#[test]
fn matrices_at_complex_s() {
    let (thin, thick) = (section(0.7e-4), section(4.5e-4));
    for segment in [
        Segment::rod(thin, 0.4),
        Segment::cone(thin, thick, 0.4),
        Segment::horn(thick, thin, 0.4),
    ] {
        let segment = segment.unwrap();
        for omega in [0.0, 3e3, 8e4] {
            let on_axis = segment
                .transition_matrix(&polymer(), omega)
                .unwrap()
                .entries();
            let s = Complex64::new(0.0, omega);
            let at_s = segment
                .transition_matrix_at_s(&polymer(), s)
                .unwrap()
                .entries();
            assert!(distance(&at_s, &on_axis) < 1e-12 * size(&on_axis)); // rounding of kL up to 20
        }
        let real = segment
            .transition_matrix_at_s(&polymer(), Complex64::new(5e3, 0.0))
            .unwrap();
        assert!(
            real.entries()
                .iter()
                .flatten()
                .all(|entry| entry.re > 0.0 && entry.im.abs() < 1e-15 * entry.re)
        );
        assert!((real.determinant() - 1.0).norm() < 1e-13); // entries up to 5
        let left = Complex64::new(-1.0, 0.0);
        assert!(segment.transition_matrix_at_s(&polymer(), left).is_err());
    }
}

/// Checks that short cones in series between sections of a horn converge to the horn, with an error
/// proportional to the square of their length.
#[test]
fn a_horn_is_the_limit_of_short_cones() {
    let horn = Segment::horn(section(0.5e-4), section(4e-4), 0.2).unwrap();
    let (medium, omega) = (polymer(), 3e4);
    let expected = horn.transition_matrix(&medium, omega).unwrap().entries();
    let error = |parts: i32| {
        let step = horn.length() / f64::from(parts);
        let mut product = TransitionMatrix::identity();
        for part in 0..parts {
            let area = |k: i32| {
                horn.area_at((f64::from(k) * step).min(horn.length()))
                    .unwrap()
            };
            let cone = Segment::cone(section(area(part)), section(area(part + 1)), step).unwrap();
            product = cone.transition_matrix(&medium, omega).unwrap() * product;
        }
        distance(&product.entries(), &expected) / size(&expected)
    };
    let (coarse, fine) = (error(20), error(40));
    assert!(fine < 1e-3);
    // second order gives a factor of 4; tolerance: the next order of the error
    assert!((coarse / fine - 4.0).abs() < 0.1, "{coarse} {fine}");
}

#[test]
fn volumes_are_those_of_the_shapes() {
    let (near, far, length) = (section(1e-4), section(9e-4), 0.3);
    let steps = 20_000;
    for segment in [
        Segment::rod(near, length),
        Segment::cone(near, far, length),
        Segment::cone(far, near, length),
        Segment::horn(near, far, length),
        Segment::horn(near, near, length),
    ] {
        let segment = segment.unwrap();
        let h = length / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|k| segment.area_at((f64::from(k) + 0.5) * h).unwrap() * h)
            .sum();
        // tolerance: the error of the midpoint rule is h²/24 (A'(L) - A'(0)), at most 1e-10 (ln 9)²
        // of the volume
        assert!((segment.volume() / sum - 1.0).abs() < 1e-8);
    }
}

fn segment(kind: usize, near: f64, far: f64, length: f64) -> Segment {
    match kind {
        0 => Segment::rod(section(near), length),
        1 => Segment::cone(section(near), section(far), length),
        _ => Segment::horn(section(near), section(far), length),
    }
    .unwrap()
}

/// Returns the matrix of an element of this kind at `omega`: 0 rod, 1 cone, 2 horn, 3 mass, 4
/// spring, 5 dashpot.
fn element(kind: usize, near: f64, far: f64, length: f64, omega: f64) -> TransitionMatrix {
    match kind {
        0..3 => {
            let segment = segment(kind, near, far, length);
            segment.transition_matrix(&polymer(), omega).unwrap()
        }
        3 => TransitionMatrix::lumped_mass(near * 1e3, omega).unwrap(),
        4 => TransitionMatrix::spring(near * 1e10, omega).unwrap(),
        _ => TransitionMatrix::dashpot(near * 1e7).unwrap(),
    }
}

fn mirrored(entries: &Entries) -> Entries {
    let [[a, b], [c, d]] = *entries;
    [[d, b], [c, a]]
}

fn any_area() -> impl Strategy<Value = f64> {
    (-5.0..-2.5f64).prop_map(|exponent| 10f64.powf(exponent))
}

fn any_omega() -> impl Strategy<Value = f64> {
    (-3.0..5.2f64).prop_map(|exponent| 10f64.powf(exponent))
}

proptest! {
    /// Checks that det P = 1, which expresses reciprocity, and that P P⁻¹ = 1.
    #[test]
    fn determinant_and_inverse(
        kind in 0..6usize, near in any_area(), far in any_area(), length in 0.01..0.5f64, omega in any_omega(),
    ) {
        let p = element(kind, near, far, length, omega);
        let [[a, b], [c, d]] = p.entries();
        // tolerance: rounding of the products whose difference is the determinant
        let scale = 1.0 + (a * d).norm() + (b * c).norm();
        prop_assert!((p.determinant() - 1.0).norm() < 2e-14 * scale);
        let unity = (p * p.inverse()).entries();
        let bound = 2e-14 * size(&p.entries()) * size(&p.inverse().entries()) + 1e-14;
        let one = TransitionMatrix::identity().entries();
        prop_assert!(distance(&unity, &one) < bound);
    }

    /// Checks that P₁₁ and P₂₂ of the reversed element are exchanged.
    #[test]
    fn mirror_image(
        kind in 0..3usize, near in any_area(), far in any_area(), length in 0.01..0.5f64, omega in any_omega(),
    ) {
        let there = element(kind, near, far, length, omega).entries();
        let far = if kind == 0 { near } else { far };
        let back = element(kind, far, near, length, omega).entries();
        prop_assert!(distance(&mirrored(&there), &back) < 1e-12 * size(&there)); // rounding of kL up to 50
        let turned = segment(kind, near, far, length).turned().transition_matrix(&polymer(), omega).unwrap().entries();
        prop_assert!(distance(&turned, &back) < 1e-12 * size(&back));
    }

    /// Checks that the matrices of the two parts of an element, cut at any section, multiply to the
    /// matrix of the whole (Ödeen 1993, paper E, eq. A9).
    #[test]
    fn composition(
        kind in 0..3usize,
        near in any_area(),
        far in any_area(),
        length in 0.01..0.5f64,
        fraction in 0.001..0.999f64,
        omega in any_omega(),
    ) {
        let medium = polymer();
        let whole = segment(kind, near, far, length);
        let cut = whole.cut(fraction * length).unwrap();
        let first = cut.near.transition_matrix(&medium, omega).unwrap();
        let second = cut.far.transition_matrix(&medium, omega).unwrap();
        let found = (second * first).entries();
        let expected = whole.transition_matrix(&medium, omega).unwrap().entries();
        // tolerance: rounding of the sums in the product, whose terms may be larger than the sums
        let terms = size(&first.entries()) * size(&second.entries());
        prop_assert!(distance(&found, &expected) < 2e-12 * (terms + size(&expected)));
        let volumes = cut.near.volume() + cut.far.volume();
        prop_assert!((volumes / whole.volume() - 1.0).abs() < 1e-12);
    }

    /// Checks the low-frequency limit, in which every segment is a rigid mass: P₁₁ = P₂₂ = 1, P₁₂ =
    /// iωm.
    #[test]
    fn low_frequency(
        kind in 0..3usize, near in any_area(), far in any_area(), length in 0.01..0.5f64,
    ) {
        let omega = 1e-6;
        let [[a, b], [_, d]] = element(kind, near, far, length, omega).entries();
        let volume = segment(kind, near, far, length).volume();
        let mass = Complex64::new(0.0, omega * 910.0 * volume);
        // tolerance: (γL)² times a ratio of areas up to 300 is below 1e-15; ln and exp of the ratio
        // add a few roundings
        prop_assert!((a - 1.0).norm() < 1e-14 && (d - 1.0).norm() < 1e-14);
        prop_assert!((b / mass - 1.0).norm() < 1e-14);
    }
}
