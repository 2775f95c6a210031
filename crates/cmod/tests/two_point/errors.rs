//! Linear propagation compared with Monte Carlo: noise, specimen, and the variance from the
//! coherence.

use std::f64::consts::TAU;

use cmod::estimate::{ComplexCovariance, coverage_factor};
use cmod::two_point::{AveragedRatio, SpecimenUncertainty, variance_from_coherence};
use cmod::validity::{AcceptanceLimits, Violation};
use cmod::{ModulusLine, Specimen, TwoPoint};
use num_complex::Complex64;
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;

use super::rod::acceleration_ratio;
use crate::materials;
use testbed::noise::Noise;

/// Specimen of Test 2 of paper A.
const SPECIMEN: Specimen = Specimen {
    length: 0.401,
    diameter: 0.0107,
    density: 906.0,
    accelerometer_mass: 2.9e-3,
};

const UNCERTAINTY: SpecimenUncertainty = SpecimenUncertainty {
    length: 1e-3,
    diameter: 1e-4,
    density: 5.0,
    accelerometer_mass: 1e-4,
};

fn polypropylene() -> Medium<ConstantQ> {
    materials::polypropylene(SPECIMEN.density)
}

fn limited(limits: AcceptanceLimits) -> TwoPoint {
    let method = TwoPoint::new(SPECIMEN).unwrap();
    method.with_limits(limits).unwrap()
}

/// Means of products of deviations of α, k, ω/k, E', E'' and E''/E'.
#[derive(Default, Clone, Copy)]
struct Moments {
    modulus: ComplexCovariance,
    gamma: ComplexCovariance,
    velocity: f64,
    loss_factor: f64,
}

impl Moments {
    fn add(&mut self, line: &ModulusLine, clean: &ModulusLine, share: f64) {
        let product = |deviation: Complex64| {
            let deviation = deviation * share.sqrt();
            ComplexCovariance::of_shift(deviation)
        };
        self.modulus = self.modulus + product(line.modulus - clean.modulus);
        let gamma = line.propagation_coefficient - clean.propagation_coefficient;
        self.gamma = self.gamma + product(gamma);
        self.velocity += (line.phase_velocity - clean.phase_velocity).powi(2) * share;
        self.loss_factor += (line.loss_factor - clean.loss_factor).powi(2) * share;
    }

    /// Compares with the stated errors of `line`; tolerance: four times the scatter of a variance
    /// of 4000 values, (2/4000)^½ = 2.2 %.
    fn check(&self, line: &ModulusLine, what: &str) {
        let name = format!("{what}, {} Hz", line.frequency_hz);
        let stated = &line.standard_error;
        let total = line.uncertainty.total_covariance();
        let pairs = [
            (self.modulus.real, stated.storage_modulus.powi(2)),
            (self.modulus.imaginary, stated.loss_modulus.powi(2)),
            (self.gamma.real, stated.damping_coefficient.powi(2)),
            (self.gamma.imaginary, stated.wave_number.powi(2)),
            (self.velocity, stated.phase_velocity.powi(2)),
            (self.loss_factor, stated.loss_factor.powi(2)),
        ];
        for (quantity, (found, stated)) in pairs.into_iter().enumerate() {
            assert!(
                (found / stated - 1.0).abs() < 0.09,
                "{name}, {quantity}: variance {found:e}, stated {stated:e}"
            );
        }
        for (found, stated) in [
            (self.modulus, total.modulus),
            (self.gamma, total.propagation_coefficient),
        ] {
            // tolerance: four times the scatter of a correlation, 1/4000^½ = 1.6 % or less
            let difference = found.correlation() - stated.correlation();
            assert!(difference.abs() < 0.065, "{name}: correlation {difference}");
        }
    }
}

/// Compares with repetitions in which the noise, the specimen or both have random errors.
#[test]
fn linear_propagation_is_that_of_monte_carlo() {
    // from poorly to well determined lines: kL of 0.6, π/2, 0.9 π, 3π/2 and more
    let frequency_hz = [400.0, 1060.0, 1900.0, 3150.0, 6000.0];
    let exact = acceleration_ratio(&polypropylene(), &SPECIMEN, 2.9e-3, &frequency_hz);
    let repetitions = 4000;
    for (what, noise, part) in [
        ("noise", 1e-3, 0.0),
        ("specimen", 0.0, 1.0),
        ("both", 1e-3, 1.0),
    ] {
        let variance: Vec<f64> = exact
            .iter()
            .map(|ratio| noise * noise * ratio.norm_sqr())
            .collect();
        let uncertainty = SpecimenUncertainty {
            length: part * UNCERTAINTY.length,
            diameter: part * UNCERTAINTY.diameter,
            density: part * UNCERTAINTY.density,
            accelerometer_mass: part * UNCERTAINTY.accelerometer_mass,
        };
        let clean = limited(AcceptanceLimits::NONE)
            .with_specimen_uncertainty(uncertainty)
            .and_then(|method| method.estimate(&frequency_hz, &exact, &variance))
            .unwrap();
        let mut random = Noise::seeded(1993);
        let mut moments = [Moments::default(); 5];
        // covariance of the errors of the second and the last line
        let mut together = 0.0;
        for _ in 0..repetitions {
            let ratio = random.on(&exact, &variance);
            let mut draw = |uncertainty: f64| uncertainty * random.normal();
            let believed = Specimen {
                length: SPECIMEN.length + draw(uncertainty.length),
                diameter: SPECIMEN.diameter + draw(uncertainty.diameter),
                density: SPECIMEN.density + draw(uncertainty.density),
                accelerometer_mass: SPECIMEN.accelerometer_mass
                    + draw(uncertainty.accelerometer_mass),
            };
            let estimate = TwoPoint::new(believed)
                .unwrap()
                .estimate(&frequency_hz, &ratio, &variance)
                .unwrap();
            let lines = estimate.lines();
            let share = 1.0 / f64::from(repetitions);
            for ((line, clean), moments) in lines.iter().zip(clean.lines()).zip(&mut moments) {
                moments.add(line, clean, share);
            }
            let deviation = |index: usize| (lines[index].modulus - clean.lines()[index].modulus).re;
            together += deviation(1) * deviation(4) * share;
        }
        for (moments, line) in moments.iter().zip(clean.lines()) {
            moments.check(line, what);
        }
        let [second, last] = [&clean.lines()[1], &clean.lines()[4]];
        let shifts = |line: &ModulusLine| line.uncertainty.systematic.clone();
        let stated: f64 = shifts(second)
            .iter()
            .zip(shifts(last))
            .map(|(a, b)| a.modulus.re * b.modulus.re)
            .sum();
        let size = second.standard_error.storage_modulus * last.standard_error.storage_modulus;
        assert!(
            ((together - stated) / size).abs() < 0.065,
            "{what}: {together:e}, {stated:e}"
        );
        // noise is independent from line to line; the error of a specimen is the same except for
        // the effect of the mass ratio
        match what {
            "noise" => assert!(stated.abs() <= 0.0),
            "specimen" => assert!(stated / size > 0.95, "{}", stated / size),
            _ => {}
        }
    }
}

/// Compares every shift with differences of estimates with a changed specimen.
#[test]
fn shifts_are_the_derivatives_by_the_specimen() {
    let frequency_hz = [700.0, 1500.0, 2300.0, 9000.0];
    let ratio = acceleration_ratio(&polypropylene(), &SPECIMEN, 0.0, &frequency_hz);
    let estimate = |specimen: Specimen| {
        TwoPoint::new(specimen)
            .unwrap()
            .with_specimen_uncertainty(UNCERTAINTY)
            .unwrap()
            .estimate(&frequency_hz, &ratio, &[0.0; 4])
            .unwrap()
    };
    let stated = estimate(SPECIMEN);
    let step = 1e-3;
    type Change = fn(&mut Specimen, f64);
    let changes: [Change; 4] = [
        |specimen, part| specimen.length += part * UNCERTAINTY.length,
        |specimen, part| specimen.diameter += part * UNCERTAINTY.diameter,
        |specimen, part| specimen.density += part * UNCERTAINTY.density,
        |specimen, part| specimen.accelerometer_mass += part * UNCERTAINTY.accelerometer_mass,
    ];
    for (source, change) in changes.into_iter().enumerate() {
        let changed = |part: f64| {
            let mut specimen = SPECIMEN;
            change(&mut specimen, part);
            estimate(specimen)
        };
        let (plus, minus) = (changed(step), changed(-step));
        for ((line, plus), minus) in stated.lines().iter().zip(plus.lines()).zip(minus.lines()) {
            let shift = line.uncertainty.systematic[source];
            let modulus = (plus.modulus - minus.modulus) / (2.0 * step);
            let gamma =
                (plus.propagation_coefficient - minus.propagation_coefficient) / (2.0 * step);
            // tolerance: for relative changes of 1e-5 or less the second order is 1e-8, and the
            // rounding error is an amplified 1e-15/1e-5 of E
            let name = format!("{}, {} Hz", shift.source, line.frequency_hz);
            assert!(
                (modulus - shift.modulus).norm() < 1e-6 * shift.modulus.norm(),
                "{name}"
            );
            let of_gamma = shift.propagation_coefficient;
            assert!((gamma - of_gamma).norm() < 1e-6 * of_gamma.norm(), "{name}");
        }
    }
}

#[test]
fn errors_of_known_size() {
    let mut claims = Claims::default();
    of_noise(&mut claims);
    of_ten_blows(&mut claims);
    hold!(claims);
}

fn of_noise(claims: &mut Claims) {
    let frequency_hz = [400.0, 1060.0, 1900.0, 3150.0, 6000.0];
    let ratio = acceleration_ratio(&polypropylene(), &SPECIMEN, 0.0, &frequency_hz);
    let variance: Vec<f64> = ratio.iter().map(|psi| 1e-6 * psi.norm_sqr()).collect();
    let method = limited(AcceptanceLimits::NONE);
    let estimate = method.estimate(&frequency_hz, &ratio, &variance).unwrap();
    assert_eq!(estimate.lines().len(), 5);
    let mu = SPECIMEN.mass_ratio();
    let error = |line: &ModulusLine| {
        let omega = TAU * line.frequency_hz;
        let x = polypropylene().propagation_coefficient(omega) * SPECIMEN.length;
        let slope = x.sinh() + mu * (x.sinh() + x * x.cosh());
        let expected = 2.0 * polypropylene().modulus(omega).norm() / (x * slope).norm()
            * (0.5 * variance[line.index]).sqrt();
        line.standard_error.storage_modulus / expected - 1.0
    };
    claims.by("dE/E = -2 dPsi/(x f'), f' = sinh x + mu (sinh x + x cosh x), x = gamma L");
    claims.deviation(
        "Test 2: standard error of E' from noise of Psi",
        Within(4e-11, "the root is accurate to 1e-12 before amplification"),
        Ok(largest(estimate.lines().iter().map(error))),
    );
}

/// Ten hits on one line, drawn as complex numbers: errors divided by the root of their estimated
/// variance follow Student's distribution, not the normal distribution.
fn of_ten_blows(claims: &mut Claims) {
    let (blows, repetitions) = (10_u32, 40_000_u32);
    let ratio = Complex64::new(0.4, -1.1);
    let noise = 0.05;
    let mut random = Noise::seeded(7);
    let (mut mean, mut true_variance, mut within) = (0.0, 0.0, [0.0; 3]);
    let [one, two] = [0.683, 0.95].map(|p| coverage_factor(p, Some(18.0)).unwrap());
    for _ in 0..repetitions {
        let (mut cross, mut input, mut output) = (Complex64::ZERO, 0.0, 0.0);
        for _ in 0..blows {
            let free = 1.0 + random.circular(0.04);
            let impacted = ratio * free + random.circular(noise * noise);
            cross += impacted * free.conj();
            input += free.norm_sqr();
            output += impacted.norm_sqr();
        }
        let found = cross / input;
        let coherence = cross.norm_sqr() / (input * output);
        let variance =
            variance_from_coherence(&[found], &[coherence], f64::from(blows)).unwrap()[0];
        let error = found - ratio;
        mean += variance;
        true_variance += error.norm_sqr();
        let sigma = (0.5 * variance).sqrt();
        for part in [error.re, error.im] {
            for (within, factor) in within.iter_mut().zip([one, two, 1.959_964]) {
                *within += f64::from(part.abs() <= factor * sigma) / f64::from(2 * repetitions);
            }
        }
    }
    claims.by("40 000 sets of ten hits: variance of Psi by (1 - coherence)/((n - 1) coherence), Student's t");
    claims.claim(
        "variance of Psi from the coherence of ten hits, divided by the true variance",
        "1",
        1.0,
        Within(
            0.02,
            "means of 40 000 scatter by 0.5 %, times four; n in place of n - 1 would give 0.9",
        ),
        Ok(mean / true_variance),
    );
    for (name, expected, within, found) in [
        (
            "the 68.3 % factor of 18 degrees of freedom",
            0.683,
            Within(0.0065, "80 000 values scatter by 0.16 %, times four"),
            within[0],
        ),
        (
            "the 95 % factor of 18 degrees of freedom",
            0.95,
            Within(0.0032, "80 000 values scatter by 0.08 %, times four"),
            within[1],
        ),
        (
            "the normal factor of 95 %",
            0.9343,
            Within(0.0035, "80 000 values scatter by 0.09 %, times four"),
            within[2],
        ),
    ] {
        let what = format!("ten hits: errors of Psi within {name}");
        claims.claim(what, "1", expected, within, Ok(found));
    }
}

/// Lines whose error of Ψ is so large that E is nonlinear in it, near kL = π and at low frequency,
/// are marked. The nonlinearity is the second difference of E in Ψ.
#[test]
fn lines_whose_error_bends_are_marked() {
    let frequency_hz: Vec<f64> = (10..=120).map(|j| 20.0 * f64::from(j)).collect();
    let ratio = acceleration_ratio(&polypropylene(), &SPECIMEN, 0.0, &frequency_hz);
    let noise = 0.02;
    let variance: Vec<f64> = ratio.iter().map(|r| (noise * r.norm()).powi(2)).collect();
    let method = limited(AcceptanceLimits::NONE);
    let estimate = method.estimate(&frequency_hz, &ratio, &variance).unwrap();
    let bends = |line: &&ModulusLine| {
        let is_near = |v: &Violation| matches!(v, Violation::NearSingular { .. });
        line.validity.violations().iter().any(is_near)
    };
    let marked: Vec<&ModulusLine> = estimate.lines().iter().filter(bends).collect();
    let half_waves =
        |line: &ModulusLine| line.wave_number() * SPECIMEN.length / std::f64::consts::PI;
    assert!(marked.iter().any(|line| half_waves(line) < 0.25));
    assert!(
        marked
            .iter()
            .any(|line| (half_waves(line) - 1.0).abs() < 0.03)
    );
    assert!(
        !marked
            .iter()
            .any(|line| (half_waves(line) - 0.5).abs() < 0.15)
    );

    let step = 1e-4;
    let shifted = |by: Complex64| {
        let ratio: Vec<Complex64> = ratio.iter().map(|r| r + by * r.norm()).collect();
        method.estimate(&frequency_hz, &ratio, &variance).unwrap()
    };
    let (plus, minus) = (shifted(step.into()), shifted((-step).into()));
    for ((line, plus), minus) in estimate.lines().iter().zip(plus.lines()).zip(minus.lines()) {
        // lines below 0.15 half waves are omitted, because a step of 1e-4 is itself nonlinear there
        if half_waves(line) < 0.15 {
            continue;
        }
        let first = (plus.modulus - minus.modulus) / (2.0 * step);
        let second = (plus.modulus - 2.0 * line.modulus + minus.modulus) / (step * step);
        let bend = 0.5 * noise * (second / first).norm();
        assert!(
            (line.second_order / bend - 1.0).abs() < 0.01,
            "{} Hz: {} and {bend}",
            line.frequency_hz,
            line.second_order
        );
    }
}

/// Checks a coherence below the limit, and too few averages.
#[test]
fn coherence_is_asked_if_wished() {
    let frequency_hz = [1000.0, 1060.0, 1120.0];
    let ratio = acceleration_ratio(&polypropylene(), &SPECIMEN, 0.0, &frequency_hz);
    let limits = AcceptanceLimits {
        coherence: 0.999,
        ..AcceptanceLimits::NONE
    };
    let method = limited(limits);
    let averaged = |coherence: &[f64], averages: f64| {
        method.estimate_averaged(&AveragedRatio {
            frequency_hz: &frequency_hz,
            acceleration_ratio: &ratio,
            coherence,
            averages,
        })
    };
    let estimate = averaged(&[0.9995, 0.998, f64::NAN], 10.0).unwrap();
    let verdicts: Vec<String> = estimate
        .lines()
        .iter()
        .map(|line| line.validity.to_string())
        .collect();
    assert_eq!(
        verdicts,
        ["valid", "coherence 0.9980, expected at least 0.9990"]
    );
    assert_eq!(estimate.refused().len(), 1);
    let line = &estimate.lines()[0];
    assert_eq!(line.uncertainty.degrees_of_freedom, Some(18.0));
    let variance = 5e-4 / 0.9995 / 9.0 * ratio[0].norm_sqr();
    let known = method
        .estimate(&frequency_hz, &ratio, &[variance; 3])
        .unwrap();
    let by_variance = known.lines()[0].standard_error.storage_modulus;
    assert!((line.standard_error.storage_modulus / by_variance - 1.0).abs() < 1e-10);
    assert!(averaged(&[1.0; 3], 1.0).is_err());
}

/// The error of a density known to 1 % is part of the stated error. Only a limit on common errors
/// makes the lines invalid, and the report then names the density. Large noise makes all lines
/// invalid.
#[test]
fn r15_common_errors_stand_beside_and_judge_no_line() {
    let frequency_hz: Vec<f64> = (1..=60).map(|j| 100.0 * f64::from(j)).collect();
    let ratio = acceleration_ratio(&polypropylene(), &SPECIMEN, 0.0, &frequency_hz);
    let estimate = |density: f64, variance: f64, limits: AcceptanceLimits| {
        limited(limits)
            .with_specimen_uncertainty(SpecimenUncertainty {
                density,
                ..SpecimenUncertainty::default()
            })
            .and_then(|method| method.estimate(&frequency_hz, &ratio, &[variance; 60]))
            .unwrap()
    };
    let usual = AcceptanceLimits::ONE_DIMENSIONAL;
    let (without, with) = (
        estimate(0.0, 1e-8, usual),
        estimate(0.01 * SPECIMEN.density, 1e-8, usual),
    );
    let count = without.valid().count();
    assert!(count > 40, "{count}");
    assert_eq!(with.valid().count(), count);
    for line in with.valid() {
        let random = line.random_error().storage_modulus / line.modulus.re;
        assert!(random < 0.002, "{random}");
        // 1 % for dE/E = dρ/ρ, changed by the effect of the density on the mass ratio
        let common = line.systematic_error().storage_modulus / line.modulus.re;
        assert!((0.006..0.0125).contains(&common), "{common}");
        let total = line.standard_error.storage_modulus / line.modulus.re;
        assert!((total / random.hypot(common) - 1.0).abs() < 1e-12);
    }
    // five standard errors due to noise are above 1 %
    assert_eq!(estimate(0.0, 1e-2, usual).valid().count(), 0);

    let asked = AcceptanceLimits {
        common_storage_modulus: 0.01,
        ..usual
    };
    let judged = estimate(0.01 * SPECIMEN.density, 1e-8, asked);
    assert_eq!(judged.valid().count(), 0);
    for line in judged.lines() {
        let by_density = |violation: &Violation| {
            violation
                .to_string()
                .ends_with("expected at most 1.0 %; largest contribution: density")
        };
        assert!(line.validity.violations().iter().any(by_density));
    }
}
