//! Consistency of E(ω), E(t) and J(t) of a law, and Prony series that replace other laws.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::modulus::{FractionalZener, LaplaceModulus, OmegaBand, PronyStandIn};
use testbed::claim::{Claims, Within};
use testbed::difference::{largest, relative};
use testbed::hold;

use crate::modulus_time_domain::{laws, prony, times};

/// Inverse Laplace transform at time t on Talbot's contour with 20 points (Abate & Valkó, Int. J.
/// Numer. Meth. Engng 60 (2004) 979). Truncation and rounding cause errors of 1e-12 each.
fn inverse_laplace(time: f64, transform: impl Fn(Complex64) -> Complex64) -> f64 {
    const POINTS: u32 = 20;
    let m = f64::from(POINTS);
    let r = 0.4 * m / time;
    let first = 0.5 * (transform(Complex64::from(r)) * (r * time).exp()).re;
    let others: f64 = (1..POINTS)
        .map(|k| {
            let theta = f64::from(k) * PI / m;
            let cot = 1.0 / theta.tan();
            let s = r * theta * Complex64::new(cot, 1.0);
            let sigma = theta + (theta * cot - 1.0) * cot;
            ((s * time).exp() * transform(s) * Complex64::new(1.0, sigma)).re
        })
        .sum();
    r / m * (first + others)
}

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    let (mut relaxations, mut creeps) = (Vec::new(), Vec::new());
    for (_, law) in laws() {
        for time in times() {
            let relaxation = law.relaxation_modulus(time).unwrap();
            let inverse = inverse_laplace(time, |s| law.at_s(s) / s);
            // the rounding of the inversion is relative to the modulus before the relaxation
            relaxations.push((inverse - relaxation) / law.at(1.0 / time).norm());
            let creep = law.creep_compliance(time).unwrap();
            let inverse = inverse_laplace(time, |s| (s * law.at_s(s)).inv());
            creeps.push(inverse / creep - 1.0);
        }
    }
    report.by("numerical inverse Laplace transform (Talbot's contour)");
    report.deviation(
        "sixteen laws: relaxation modulus against E(s)/s, 10 ns to 1 s, relative to |E(1/t)|",
        Within(
            5e-11,
            "1e-12 of the inversion, and cancellation on its contour",
        ),
        Ok(largest(relaxations)),
    );
    report.deviation(
        "sixteen laws: creep compliance against 1/(sE(s)), 10 ns to 1 s",
        Within(5e-12, "1e-12 of the inversion"),
        Ok(largest(creeps)),
    );
    report.by("equivalence of the two chains").deviation(
        "Prony series, fluid to nearly elastic: its chain of Kelvin-Voigt elements has the compliance 1/E(s)",
        Within(1e-13, "the zeros are found to the rounding of their distance to the next pole"),
        Ok(largest([0.0, 1.0, 0.4e9, 1e15].map(retardation_error))),
    );
    report.by("the law itself, at lines between those of the fit").claim(
        "fractional Zener by 4 Maxwell branches per decade, 100 Hz to 20 kHz: error relative to its own estimate of the error",
        "1",
        1.0,
        Within(0.02, "the two maxima of the error are sought on different lines"),
        Ok(stand_in_error()),
    );
    hold!(report);
}

fn retardation_error(equilibrium_modulus: f64) -> f64 {
    let law = prony(equilibrium_modulus);
    let chain = law.retardation_spectrum();
    // four distinct relaxation times; a solid has as many retardation times, a fluid one fewer
    let expected = if equilibrium_modulus > 0.0 { 4 } else { 3 };
    assert_eq!(chain.elements.len(), expected);
    let mut elements = chain.elements.iter();
    assert!(elements.all(|element| element.compliance > 0.0 && element.retardation_time > 0.0));
    largest((-20..=40).flat_map(|j| {
        let omega = 1e4 * 10f64.powf(0.25 * f64::from(j));
        [Complex64::new(0.0, omega), Complex64::new(omega, omega)].map(|s| {
            let elements = chain.elements.iter();
            let elements: Complex64 = elements
                .map(|element| element.compliance / (1.0 + s * element.retardation_time))
                .sum();
            let compliance = elements + chain.instantaneous_compliance + chain.fluidity / s;
            (compliance * law.at_s(s) - 1.0).norm()
        })
    }))
}

/// Largest relative error of a Prony series that replaces a law, divided by the error that the
/// series states.
fn stand_in_error() -> f64 {
    let law = FractionalZener::new(0.5e9, 2.9e9, 1e-4, 0.5).unwrap();
    let band = OmegaBand {
        from: TAU * 100.0,
        to: TAU * 20e3,
    };
    let stand_in = PronyStandIn::new(&law, band, 4.0).unwrap();
    let found = largest((0..=371).map(|j| {
        let s = Complex64::new(0.0, band.from * 200f64.powf(f64::from(j) / 371.0));
        relative(stand_in.law().at_s(s), law.at_s(s))
    }));
    found / stand_in.greatest_error()
}
