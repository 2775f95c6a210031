//! The two-point method on the specimens of paper A, its conditions and its errors.

use std::f64::consts::TAU;

use cmod::estimate::coverage_factor;
use cmod::two_point::{SpecimenUncertainty, variance_from_coherence};
use cmod::validity::AcceptanceLimits;
use cmod::{ModulusEstimate, Specimen, TwoPoint};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::difference::largest;
use testbed::hold;
use testbed::papers::paper_a::{self, PaperA};

/// Test 2 of paper A.
const SPECIMEN: Specimen = Specimen {
    length: 0.401,
    diameter: 0.0107,
    density: 906.0,
    accelerometer_mass: 2.9e-3,
};

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    specimens(claims);
    conditions(claims);
    errors(claims);
    blows(claims);
    hold!(claims);
}

/// Polypropylene, with a loss factor of 0.07.
fn polypropylene(_omega: f64) -> Complex64 {
    Complex64::new(2.6e9, 0.07 * 2.6e9)
}

/// Polyamide 6 by paper E, eq. 7, of this density.
fn polyamide(omega: f64, density: f64) -> Complex64 {
    let gamma = Complex64::new(8.818e-5 * omega.powf(0.894), 8.937e-4 * omega.powf(0.970));
    -density * omega * omega / (gamma * gamma)
}

/// γ = iω √(ρ/E)
fn propagation(modulus: Complex64, density: f64, omega: f64) -> Complex64 {
    Complex64::new(0.0, omega) * (density / modulus).sqrt()
}

/// Ψ by integration of paper E, eq. A2, from the free end to the impacted one, by the classical rule of fourth order in steps of |γ|h <
/// 4e-3.
fn integrated_ratio(modulus: Complex64, specimen: &Specimen, omega: f64) -> Complex64 {
    let force_rate = Complex64::new(0.0, omega * specimen.density * specimen.area());
    let velocity_rate = Complex64::new(0.0, omega) / (modulus * specimen.area());
    let derivative = |n: Complex64, v: Complex64| (force_rate * v, velocity_rate * n);
    let phase = propagation(modulus, specimen.density, omega).norm() * specimen.length;
    let mut steps = 64_u32;
    while phase / f64::from(steps) > 4e-3 {
        steps *= 2;
    }
    let h = -specimen.length / f64::from(steps);
    let mut v = Complex64::ONE;
    let mut n = Complex64::new(0.0, -omega * specimen.accelerometer_mass);
    for _ in 0..steps {
        let (n1, v1) = derivative(n, v);
        let (n2, v2) = derivative(n + n1 * (h / 2.0), v + v1 * (h / 2.0));
        let (n3, v3) = derivative(n + n2 * (h / 2.0), v + v2 * (h / 2.0));
        let (n4, v4) = derivative(n + n3 * h, v + v3 * h);
        n += (n1 + 2.0 * n2 + 2.0 * n3 + n4) * (h / 6.0);
        v += (v1 + 2.0 * v2 + 2.0 * v3 + v4) * (h / 6.0);
    }
    v
}

fn lines(step: f64, count: u32) -> Vec<f64> {
    (1..=count).map(|j| step * f64::from(j)).collect()
}

/// The estimate of a rod of `modulus` without noise.
fn estimate(
    specimen: Specimen,
    modulus: &dyn Fn(f64) -> Complex64,
    frequency_hz: &[f64],
) -> Ours<ModulusEstimate> {
    let ratio: Vec<Complex64> = frequency_hz
        .iter()
        .map(|f| integrated_ratio(modulus(TAU * f), &specimen, TAU * f))
        .collect();
    Ok(TwoPoint::new(specimen)?
        .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
        .estimate(frequency_hz, &ratio, &vec![0.0; ratio.len()])?)
}

fn specimens(claims: &mut Claims) {
    claims.by("paper A, Table 2; accelerations by integration of paper E, eq. A2, along the rod");
    let frequency_hz = lines(100.0, 200);
    let paper: Ours<PaperA> = paper_a::load().map_err(Into::into);
    for index in 0..10 {
        let worst = || -> Ours {
            let paper = paper.as_ref().map_err(Clone::clone)?;
            let test = paper.tests.get(index).ok_or_else(|| missing("the test"))?;
            let specimen = test.specimen(paper);
            let density = test.density;
            let modulus: &dyn Fn(f64) -> Complex64 = if test.material == "Polyamide 6" {
                &move |omega| polyamide(omega, density)
            } else {
                &polypropylene
            };
            let estimate = estimate(specimen, modulus, &frequency_hz)?;
            Ok(largest(estimate.valid().map(|line| {
                let exact = modulus(TAU * line.frequency_hz);
                (line.modulus - exact).norm() / exact.norm()
            })))
        };
        claims.deviation(
            format!("Test {}: modulus on valid lines up to 20 kHz", index + 1),
            Within(1e-11, "the integration of the rod, 4e-12"),
            worst(),
        );
    }
}

/// Conditions (i) to (iii); a constant modulus has a constant speed.
fn conditions(claims: &mut Claims) {
    let specimen = Specimen {
        length: 0.799,
        diameter: 0.0158,
        density: 912.0,
        accelerometer_mass: 2.9e-3,
    };
    let speed = 1.0 / (912.0 / polypropylene(1.0)).sqrt().re;
    let frequency_hz = lines(50.0, 480);
    let found = estimate(specimen, &polypropylene, &frequency_hz);
    claims.by("paper A, condition (i): wavelength above 5 D");
    claims.claim(
        "Test 6: highest valid frequency, c/(5D)",
        "Hz",
        speed / (5.0 * specimen.diameter),
        Within(50.0, "the distance of lines"),
        of(&found, |found| {
            found
                .valid()
                .map(|line| line.frequency_hz)
                .fold(f64::NAN, f64::max)
        }),
    );
    claims.by("paper A, condition (ii): wavelength below 5 L");
    claims.claim(
        "Test 6: lowest valid frequency, c/(5L)",
        "Hz",
        speed / (5.0 * specimen.length),
        Within(50.0, "the distance of lines"),
        of(&found, |found| {
            found
                .valid()
                .map(|line| line.frequency_hz)
                .fold(f64::NAN, f64::min)
        }),
    );
    claims.by("paper A, condition (iii): damping above 0");
    let conjugated = || -> Ours {
        let ratio: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| integrated_ratio(polypropylene(TAU * f), &specimen, TAU * f).conj())
            .collect();
        let estimate = TwoPoint::new(specimen)?
            .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
            .estimate(&frequency_hz, &ratio, &vec![0.0; ratio.len()])?;
        Ok(estimate.valid().count() as f64)
    };
    claims.claim(
        "spectra made with the other sign of time: valid lines",
        "1",
        0.0,
        Within(0.5, "a count"),
        conjugated(),
    );
}

fn circular(random: &mut ChaCha8Rng, mean_square: f64) -> Complex64 {
    let re: f64 = StandardNormal.sample(random);
    let im: f64 = StandardNormal.sample(random);
    Complex64::new(re, im) * (0.5 * mean_square).sqrt()
}

fn errors(claims: &mut Claims) {
    let noise = 1e-3_f64;
    // kL = 0.6, π/2, 0.9 π, 3π/2 and beyond
    let frequency_hz = [400.0, 1060.0, 1900.0, 3150.0, 6000.0];
    let exact: Vec<Complex64> = frequency_hz
        .iter()
        .map(|f| integrated_ratio(polypropylene(TAU * f), &SPECIMEN, TAU * f))
        .collect();
    let variance: Vec<f64> = exact
        .iter()
        .map(|ratio| noise * noise * ratio.norm_sqr())
        .collect();
    let by = |ratio: &[Complex64]| -> Ours<ModulusEstimate> {
        Ok(TwoPoint::new(SPECIMEN)?
            .with_limits(AcceptanceLimits::NONE)?
            .estimate(&frequency_hz, ratio, &variance)?)
    };
    let stated = by(&exact);
    claims.by("dE/E = -2 dPsi/(x f'), f' = sinh x + mu (sinh x + x cosh x), x = gamma L");
    claims.deviation(
        "Test 2: standard error of E' from noise of Psi",
        Within(1e-8, "the root is followed to 1e-12, and amplified"),
        of(&stated, |stated| {
            let mu = SPECIMEN.mass_ratio();
            largest(stated.lines().iter().map(|line| {
                let omega = TAU * line.frequency_hz;
                let modulus = polypropylene(omega);
                let x = propagation(modulus, SPECIMEN.density, omega) * SPECIMEN.length;
                let slope = x.sinh() + mu * (x.sinh() + x * x.cosh());
                let expected =
                    2.0 * modulus.norm() / (x * slope).norm() * (0.5 * variance[line.index]).sqrt();
                (line.standard_error.storage_modulus / expected - 1.0).abs()
            }))
        }),
    );
    claims.by("1500 draws of noise of 0.1 % on Psi, five lines");
    let repetitions = 1500;
    let drawn = || -> Ours<[f64; 3]> {
        let stated = stated.as_ref().map_err(Clone::clone)?;
        let mut random = ChaCha8Rng::seed_from_u64(1993);
        let mut squares = [[0.0; 3]; 5];
        for _ in 0..repetitions {
            let ratio: Vec<Complex64> = exact
                .iter()
                .zip(&variance)
                .map(|(ratio, variance)| ratio + circular(&mut random, *variance))
                .collect();
            let noisy = by(&ratio)?;
            for ((line, clean), squares) in
                noisy.lines().iter().zip(stated.lines()).zip(&mut squares)
            {
                let error = line.modulus - clean.modulus;
                let loss_factor = line.loss_factor - clean.loss_factor;
                for (square, error) in squares.iter_mut().zip([error.re, error.im, loss_factor]) {
                    *square += error * error / f64::from(repetitions);
                }
            }
        }
        let mut worst = [0.0_f64; 3];
        for (squares, line) in squares.iter().zip(stated.lines()) {
            let error = &line.standard_error;
            let stated = [error.storage_modulus, error.loss_modulus, error.loss_factor];
            for ((worst, square), stated) in worst.iter_mut().zip(squares).zip(stated) {
                *worst = worst.max((square.sqrt() / stated - 1.0).abs());
            }
        }
        Ok(worst)
    };
    let drawn = drawn();
    for (index, name) in ["E'", "E''", "loss factor"].into_iter().enumerate() {
        claims.deviation(
            format!("Test 2: scatter of {name} over its standard error, worst of five lines"),
            Within(0.073, "four of 1/sqrt(3000)"),
            of(&drawn, |drawn| drawn[index]),
        );
    }
    shifts(claims);
}

/// With μ = 0, E ∝ ρL²; the mass by differences.
fn shifts(claims: &mut Claims) {
    let frequency_hz = [700.0, 1500.0, 2300.0, 9000.0];
    let uncertainty = SpecimenUncertainty {
        length: 1e-3,
        diameter: 1e-4,
        density: 5.0,
        accelerometer_mass: 1e-4,
    };
    let by = |specimen: Specimen, made_with: Specimen| -> Ours<ModulusEstimate> {
        let ratio: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| integrated_ratio(polypropylene(TAU * f), &made_with, TAU * f))
            .collect();
        Ok(TwoPoint::new(specimen)?
            .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
            .with_specimen_uncertainty(uncertainty)?
            .estimate(&frequency_hz, &ratio, &[0.0; 4])?)
    };
    let massless = Specimen {
        accelerometer_mass: 0.0,
        ..SPECIMEN
    };
    claims.by("E = -rho omega^2/gamma^2 and gamma L known: E goes as rho L^2");
    let free = by(massless, massless);
    for (source, name, expected) in [
        (0, "length", 2.0 * uncertainty.length / SPECIMEN.length),
        (2, "density", uncertainty.density / SPECIMEN.density),
    ] {
        claims.claim(
            format!("Test 2 without mass: relative shift of E by the {name}"),
            "1",
            expected,
            Within(1e-9, "the integration of the rod, amplified"),
            of(&free, |free| {
                let shift = |line: &cmod::ModulusLine| {
                    (line.uncertainty.systematic[source].modulus / line.modulus).norm()
                };
                // the line that is furthest off
                free.lines()
                    .iter()
                    .map(shift)
                    .fold(expected, |worst, found| {
                        if (found - expected).abs() > (worst - expected).abs() {
                            found
                        } else {
                            worst
                        }
                    })
            }),
        );
    }
    claims.by("difference of two estimates");
    let by_mass = || -> Ours {
        let stated = by(SPECIMEN, SPECIMEN)?;
        let part = 1e-3;
        let changed = |sign: f64| {
            let mass = SPECIMEN.accelerometer_mass + sign * part * uncertainty.accelerometer_mass;
            by(
                Specimen {
                    accelerometer_mass: mass,
                    ..SPECIMEN
                },
                SPECIMEN,
            )
        };
        let (plus, minus) = (changed(1.0)?, changed(-1.0)?);
        let pairs = plus.lines().iter().zip(minus.lines());
        Ok(largest(stated.lines().iter().zip(pairs).map(
            |(line, (plus, minus))| {
                let difference = (plus.modulus - minus.modulus) / (2.0 * part);
                let shift = line.uncertainty.systematic[3].modulus;
                (difference - shift).norm() / shift.norm()
            },
        )))
    };
    claims.deviation(
        "Test 2: shift of E by the mass of the accelerometer",
        Within(1e-6, "second order of a step of 3e-5, and rounding over it"),
        by_mass(),
    );
}

/// Ten blows on one line, as complex numbers.
fn blows(claims: &mut Claims) {
    claims.by("20 000 sets of ten blows: variance of Psi by (1 - coherence)/((n - 1) coherence), Student's t");
    let ratio = Complex64::new(0.4, -1.1);
    let (blows, repetitions) = (10_u32, 20_000_u32);
    let drawn = || -> Ours<[f64; 2]> {
        let factor = coverage_factor(0.95, Some(18.0))?;
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let (mut mean, mut true_variance, mut within) = (0.0, 0.0, 0.0);
        for _ in 0..repetitions {
            let (mut cross, mut input, mut output) = (Complex64::ZERO, 0.0, 0.0);
            for _ in 0..blows {
                let free = 1.0 + circular(&mut random, 0.04);
                let impacted = ratio * free + circular(&mut random, 0.0025);
                cross += impacted * free.conj();
                input += free.norm_sqr();
                output += impacted.norm_sqr();
            }
            let found = cross / input;
            let coherence = cross.norm_sqr() / (input * output);
            let variance = variance_from_coherence(&[found], &[coherence], f64::from(blows))?[0];
            let error = found - ratio;
            mean += variance;
            true_variance += error.norm_sqr();
            let sigma = (0.5 * variance).sqrt();
            for part in [error.re, error.im] {
                within += f64::from(u8::from(part.abs() <= factor * sigma));
            }
        }
        Ok([mean / true_variance, within / f64::from(2 * repetitions)])
    };
    let drawn = drawn();
    claims.claim(
        "variance of Psi from the coherence of ten blows over the true one",
        "1",
        1.0,
        Within(0.03, "means of 20 000 scatter by 0.7 %, four of it"),
        of(&drawn, |drawn| drawn[0]),
    );
    claims.claim(
        "errors of Psi within the 95 % factor of 18 degrees of freedom",
        "1",
        0.95,
        Within(0.0045, "40 000 values scatter by 0.11 %, four of it"),
        of(&drawn, |drawn| drawn[1]),
    );
}
