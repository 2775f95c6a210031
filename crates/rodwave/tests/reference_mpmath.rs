//! Chains, lateral inertia, fractional relaxation and the nonlinear laws, compared with results of
//! mpmath with 50 digits: `fixtures/reference/mpmath`.

use num_complex::Complex64;
use rodwave::inelastic::{InelasticLaw, MaxwellGurevichRabinovich, MaxwellNorton, RelaxationFlow};
use rodwave::modulus::{FractionalZener, TimeDomainModulus};
use rodwave::slenderness::{PochhammerChree, RodTheory, RoundRod};
use testbed::difference::{largest, relative};

use crate::golden::Bodies;

const CHAINS: &str = include_str!("../../../fixtures/reference/mpmath/chains.csv");
const POCHHAMMER: &str = include_str!("../../../fixtures/reference/mpmath/pochhammer.csv");
const FRACTIONAL: &str = include_str!("../../../fixtures/reference/mpmath/fractional_zener.csv");
const RELAXATION: &str = include_str!("../../../fixtures/reference/mpmath/relaxation.csv");

/// Returns the first cell of each row (empty if there is no name) and the numbers after it.
fn rows(table: &str, count: usize) -> Vec<(&str, Vec<f64>)> {
    let rows = table.lines().skip(1).map(|line| {
        let (name, rest) = match line.split_once(',') {
            Some((name, rest)) if name.parse::<f64>().is_err() => (name, rest),
            _ => ("", line),
        };
        let numbers = rest.split(',').map(|cell| cell.parse().unwrap());
        (name, numbers.collect())
    });
    let rows: Vec<_> = rows.collect();
    assert_eq!(rows.len(), count);
    rows
}

/// Returns the largest error of the mobilities of cone and cylinder, and the largest error of the
/// mobility of the long rod and of γ and the impedance of Nylon-6.
pub(crate) fn errors_of_chains(bodies: &Bodies) -> [f64; 2] {
    let (mut chains, mut medium) = (Vec::new(), Vec::new());
    for (quantity, row) in rows(CHAINS, 91) {
        let (omega, expected) = (row[0], Complex64::new(row[1], row[2]));
        let nylon = &bodies.nylon;
        let (found, errors) = match quantity {
            "TCA" => (bodies.cone.mobility(omega).unwrap(), &mut chains),
            "TCB" => (bodies.cone.far_face_mobility(omega).unwrap(), &mut chains),
            "CCA" => (bodies.cylinder.mobility(omega).unwrap(), &mut chains),
            "CCB" => (
                bodies.cylinder.far_face_mobility(omega).unwrap(),
                &mut chains,
            ),
            "LCR" => (bodies.long_rod.mobility(omega).unwrap(), &mut medium),
            "nylon gamma" => (nylon.propagation_coefficient(omega), &mut medium),
            "nylon specific impedance" => {
                let impedance = nylon.specific_characteristic_impedance(omega);
                (impedance, &mut medium)
            }
            other => panic!("no such quantity: {other}"),
        };
        errors.push(relative(found, expected));
    }
    [chains, medium].map(largest)
}

/// Returns the error of the first branch for elastic and lossy rods, λ from 50 D to 1.4 D, in both
/// directions.
fn error_of_lateral_inertia() -> f64 {
    let (density, diameter, bar) = (1200.0, 0.016, 2.5e9);
    let radius = 0.5 * diameter;
    let rows = rows(POCHHAMMER, 43).into_iter();
    largest(rows.flat_map(|(_, row)| {
        let [poisson_ratio, _, loss_factor, frequency, re, im] = row[..] else {
            panic!("six numbers");
        };
        let rod = RoundRod {
            density,
            diameter,
            poisson_ratio,
        };
        let theory = PochhammerChree::new(rod).unwrap();
        let omega = frequency * (bar / density).sqrt() / radius;
        let modulus = Complex64::new(bar, bar * loss_factor);
        let expected = Complex64::new(re, im) / radius;
        let gamma = theory.propagation_coefficient(modulus, omega).unwrap();
        let found = theory.modulus(expected, omega).unwrap().found().unwrap();
        [
            relative(gamma.found().unwrap(), expected),
            relative(found.modulus, modulus),
        ]
    }))
}

/// Returns the error of relaxation and creep over twelve decades around the relaxation time, for
/// orders from 0.1 to 1.
fn error_of_fractional_relaxation() -> f64 {
    let rows = rows(FRACTIONAL, 78).into_iter();
    largest(rows.flat_map(|(_, row)| {
        let [relaxed, unrelaxed, tau, exponent, time, relaxation, creep] = row[..] else {
            panic!("seven numbers");
        };
        let law = FractionalZener::new(relaxed, unrelaxed, tau, exponent).unwrap();
        [
            (law.relaxation_modulus(time).unwrap() - relaxation) / unrelaxed,
            (law.creep_compliance(time).unwrap() - creep) * relaxed,
        ]
    }))
}

/// Returns the error of the exact flows of Norton's law and of the law of Gurevich and Rabinovich,
/// for steps from 1e-7 to 30 relaxation times.
fn error_of_flows() -> f64 {
    let rows = rows(RELAXATION, 40).into_iter();
    largest(rows.map(|(law, row)| {
        let [first, second, modulus, stress, duration, expected] = row[..] else {
            panic!("six numbers");
        };
        let found = match law {
            "gurevich" => MaxwellGurevichRabinovich::new(first, second)
                .unwrap()
                .flow(modulus, duration)
                .relax(stress),
            "norton" => MaxwellNorton::new(first, second)
                .unwrap()
                .flow(modulus, duration)
                .relax(stress),
            other => panic!("no such law: {other}"),
        };
        found / expected - 1.0
    }))
}

mod claims {
    use testbed::claim::{Claims, Within};
    use testbed::hold;

    #[test]
    fn hold() {
        let mut report = Claims::default();
        let [chains, medium] = super::errors_of_chains(&crate::golden::bodies());
        report.by("paper E, eqs. 5-10, by mpmath, 50 digits");
        report.deviation(
            "mobilities of faces TCA, TCB, CCA, CCB, 50 Hz to 10 kHz",
            Within(
                2e-14,
                "rounding of γL by 1e-15, amplified at a sharp resonance",
            ),
            Ok(chains),
        );
        report.deviation(
            "mobility of the long rod; propagation coefficient and specific impedance of Nylon-6, 50 Hz to 10 kHz",
            Within(
                4e-15,
                "powers of a number of order 1e4, which lose a digit because the logarithm of the number is about 10",
            ),
            Ok(medium),
        );
        report.by("frequency equation of Pochhammer and Chree by mpmath, 50 digits");
        report.deviation(
            "modulus to wave and wave to modulus, elastic and lossy rods, λ from 50 D to 1.4 D",
            Within(5e-15, "some roundings"),
            Ok(super::error_of_lateral_inertia()),
        );
        report.by("Mittag-Leffler function by mpmath, 50 digits");
        report.deviation(
            "fractional Zener: relaxation and creep over twelve decades, orders 0.1 to 1, relative to E₁ and 1/E₀",
            Within(5e-15, "a few roundings of E₁ - E₀"),
            Ok(super::error_of_fractional_relaxation()),
        );
        report.by("flow of paper D, Table 1, models 2 and 3, by mpmath, 50 digits");
        report.deviation(
            "Norton, Gurevich and Rabinovich: relaxed stress, steps of 1e-7 to 30 relaxation times",
            Within(
                2e-14,
                "powers and exponentials with arguments of up to 30, each with about thirty rounding errors",
            ),
            Ok(super::error_of_flows()),
        );
        hold!(report);
    }
}
