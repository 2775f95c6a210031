//! Linear laws: cases in which one law contains another, and the printed relations between a wave
//! and its modulus.

use std::f64::consts::{FRAC_PI_2, TAU};

use num_complex::Complex64;
use rodwave::medium::modulus_from_propagation;
use rodwave::modulus::{
    ComplexModulus, ConstantQ, FractionalZener, HavriliakNegami, LaplaceModulus, Maxwell,
    SpringPot, Zener,
};
use testbed::claim::{Claims, Within};
use testbed::difference::{largest, relative};
use testbed::hold;

use crate::bodies::{nylon, prony};
use crate::linear_laws::frequencies;

/// Claims on linear laws (Ödeen 1993, paper A, eq. 2).
#[test]
fn claims_hold() {
    let mut report = Claims::default();
    report
        .by("limits of the laws, on the axis and in the right half plane")
        .deviation(
            "Prony series, fractional Zener, Havriliak-Negami and constant Q contain Zener, Maxwell, fractional Zener and spring-pot",
            Within(5e-15, "rounding of ten operations"),
            Ok(largest(laws_in_laws())),
        );
    let errors = [1e-12, 1e-3, 0.07, 0.5, 10.0, 1e6]
        .into_iter()
        .flat_map(|loss_factor| {
            let law = ConstantQ::new(2.6e9, loss_factor, 6283.0).unwrap();
            let lost = loss_factor.max(1.0);
            let size = law.at(6283.0).norm() / 2.6e9 - 1.0;
            let losses = frequencies().map(move |omega| {
                let modulus = law.at(omega);
                (modulus.im / modulus.re / loss_factor - 1.0) / lost
            });
            losses.chain([size])
        });
    report.by("Kjartansson's definition").deviation(
        "constant Q, tan δ from 1e-12 to 1e6: one loss factor over nine decades, relative to the larger of 1 and tan δ, and |E| at the reference frequency",
        Within(4e-15, "rounding of the exponent, whose angle is amplified by tan δ"),
        Ok(largest(errors)),
    );
    let loss_factor = |frequency_hz: f64| {
        let modulus = nylon().modulus(TAU * frequency_hz);
        modulus.im / modulus.re
    };
    report
        .by("paper E, eq. 7, computed elsewhere to three digits")
        .deviation(
            "Nylon-6: loss factor minus 0.107 at 500 Hz, and minus 0.085 at 10 kHz",
            Within(5e-4, "half the last printed digit"),
            Ok(largest([
                loss_factor(500.0) - 0.107,
                loss_factor(1e4) - 0.085,
            ])),
        );
    let (density, alpha, k, omega) = (1150.0, 0.21_f64, 4.1_f64, 6e3_f64);
    let modulus = modulus_from_propagation(Complex64::new(alpha, k), omega, density).unwrap();
    let common = density * omega * omega / (k * k + alpha * alpha).powi(2);
    report.by("paper A, eq. 2; paper B, eq. 3").deviation(
        "E' and E'' from α and k in the printed real form",
        Within(2e-15, "a dozen roundings"),
        Ok(largest([
            modulus.re / (common * (k * k - alpha * alpha)) - 1.0,
            modulus.im / (common * 2.0 * k * alpha) - 1.0,
        ])),
    );
    hold!(report);
}

fn laws_in_laws() -> Vec<f64> {
    let zener = Zener::new(2.5e9, 2.9e9, 1e-4).unwrap();
    let fractional = |alpha| FractionalZener::new(2.5e9, 2.9e9, 1e-4, alpha).unwrap();
    let skew = |alpha| HavriliakNegami::new(2.5e9, 2.9e9, 1e-4, alpha, 1.0).unwrap();
    let spring_pot = SpringPot::new(2.7e9, 0.2_f64.atan() / FRAC_PI_2, 1e4);
    let pairs: [[Box<dyn LaplaceModulus>; 2]; 6] = [
        [Box::new(prony(2.5e9, &[(0.4e9, 1e-4)])), Box::new(zener)],
        [
            Box::new(prony(0.0, &[(2.7e9, 1e-4)])),
            Box::new(Maxwell::new(2.7e9, 2.7e5).unwrap()),
        ],
        [Box::new(fractional(1.0)), Box::new(zener)],
        [Box::new(skew(1.0)), Box::new(zener)],
        [Box::new(skew(0.3)), Box::new(fractional(0.3))],
        [
            Box::new(ConstantQ::new(2.7e9, 0.2, 1e4).unwrap()),
            Box::new(spring_pot.unwrap()),
        ],
    ];
    let errors = pairs.iter().flat_map(|[special, general]| {
        frequencies().flat_map(move |omega| {
            [0.0, 0.3].map(|part| {
                let s = Complex64::new(part * omega, omega);
                relative(special.at_s(s), general.at_s(s))
            })
        })
    });
    errors.collect()
}
