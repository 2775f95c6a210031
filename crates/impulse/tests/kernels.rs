//! Mobilities in discrete time: closed forms, and the work of forces on passive bodies, which is
//! never negative.

use std::f64::consts::{FRAC_PI_4, TAU};

use impulse::{ImpactBody, Kernel, MobilityLaw, Quadrature, TimeGrid};
use num_complex::Complex64;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rodwave::chain::{AnalyticChain, Chain, Termination};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use crate::bodies::{circle, impedance, nylon, on_lines, rod, steel, wave_speed};
use testbed::claim::{Claims, Ours, Within};
use testbed::difference::largest;
use testbed::hold;

const GRID: TimeGrid = TimeGrid {
    time_step: 2e-6,
    n_steps: 1000,
};

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    echoes_of_an_elastic_rod(&mut claims);
    a_mass_moves_with_its_momentum(&mut claims);
    no_force_gains_energy(&mut claims);
    hold!(claims);
}

/// The kernel of a free elastic rod: an impulse 1/Z and echoes 2/Z every 2T. Each is divided
/// between the step that contains it and a neighbouring step, as by a hat function (Ödeen 1993,
/// paper E, eq. 1).
fn echoes_of_an_elastic_rod(claims: &mut Claims) {
    claims.by("G = coth(sT)/Z, free elastic rod");
    let to_the_end = 60.3;
    let weights = || -> Ours<Vec<f64>> {
        let body = rod(0.010, to_the_end * GRID.time_step * wave_speed());
        let kernel = Kernel::of(&body, GRID, Quadrature::CellAverages)?;
        let z = impedance(0.010);
        Ok(kernel.weights().iter().map(|weight| weight * z).collect())
    };
    let hat = |distance: f64| (1.0 - distance.abs()).max(0.0);
    let echo = |k: i32| 2.0 * f64::from(k) * to_the_end;
    let weighed = || -> Ours {
        let weights = weights()?;
        Ok(largest(weights.iter().enumerate().map(|(n, weight)| {
            let n = n as f64;
            let echoes: f64 = (1..10).map(|k| 2.0 * hat(n - echo(k))).sum();
            let nearest = (n / echo(1)).round() * echo(1);
            let allowed = match (n - nearest).abs() {
                _ if n < 50.0 => 1e-7,
                distance if distance < 2.0 => 0.07,
                distance if distance < 6.0 => 2e-3,
                _ => 2e-7,
            };
            (weight - hat(n) - echoes) / allowed
        })))
    };
    claims.claim(
        "free elastic rod: error of the kernel over its tolerance of 7 % within two steps of an echo, 2e-3 within six, 2e-7 beyond",
        "1",
        0.0,
        Within(1.0, "residual of the roll-off of the bands at a kink, and the alias of the next period, e^-18 of 2"),
        weighed(),
    );
    let impulses = || -> Ours {
        let weights = weights()?;
        Ok(largest((1..8).map(|k| {
            let near = |n: usize| (n as f64 - echo(k)).abs() < 20.0;
            let near: Vec<usize> = (0..weights.len()).filter(|n| near(*n)).collect();
            let exact: f64 = near.iter().map(|n| 2.0 * hat(*n as f64 - echo(k))).sum();
            near.iter().map(|n| weights[*n]).sum::<f64>() / exact - 1.0
        })))
    };
    claims.deviation(
        "free elastic rod: impulse of the echoes, 2/Z each",
        Within(
            4e-9,
            "residual of the roll-off of the bands next to an echo",
        ),
        impulses(),
    );
}

fn a_mass_moves_with_its_momentum(claims: &mut Claims) {
    claims.by("G = 1/(sM): a unit impulse leaves the velocity 1/M");
    let kilograms = 0.4;
    let law = move |s: Complex64| 1.0 / (kilograms * s);
    let error = || -> Ours {
        let plane = MobilityLaw::analytic(law).free(kilograms)?;
        let axis = MobilityLaw::on_axis(law).free(kilograms)?;
        let drift = GRID.time_step / kilograms;
        let mut errors = Vec::new();
        for body in [&plane as &dyn ImpactBody, &axis] {
            let kernel = Kernel::of(body, GRID, Quadrature::CellAverages)?;
            errors.extend(kernel.weights().iter().map(|weight| weight / drift - 1.0));
            let first = errors.len() - kernel.weights().len();
            errors[first] += 0.5;
        }
        Ok(largest(errors))
    };
    claims.deviation(
        "rigid mass, formula in the right half plane and on the frequency axis only: kernel",
        Within(
            1e-4,
            "a part 1/Z is subtracted that the mass does not have; and the effect of the next period",
        ),
        error(),
    );
}

/// Work of a force on a body, h Σ Fₙ (w*F)ₙ, relative to the size of its terms: the work on the
/// body itself for a force that is constant in each step.
fn no_force_gains_energy(claims: &mut Claims) {
    claims.by("a passive body generates no energy: sum F_n (w*F)_n >= 0");
    let gained = |body: &dyn ImpactBody, quadratures: &[Quadrature]| -> Ours {
        let mut gains = Vec::new();
        for quadrature in quadratures {
            let kernel = Kernel::of(body, GRID, *quadrature)?;
            let weights = kernel.weights();
            for seed in 0..20 {
                let force = force(seed);
                let (mut work, mut size) = (0.0, 0.0);
                for n in 0..force.len() {
                    let velocity: f64 = (0..=n).map(|j| weights[n - j] * force[j]).sum();
                    work += force[n] * velocity;
                    size += (force[n] * velocity).abs();
                }
                gains.push(if work < 0.0 || work.is_nan() {
                    work / size
                } else {
                    0.0
                });
            }
        }
        Ok(largest(gains))
    };
    let (wide, narrow) = (circle(0.075), circle(0.030));
    let printed = || -> Ours<Chain> {
        let cone = Chain::from_impact_face().cone(&nylon(), narrow, wide, 0.400);
        Ok(cone.end(Termination::Free)?)
    };
    let computed = || -> Ours {
        let nylon = Medium::new(1150.0, ConstantQ::new(2.6e9, 0.094, 18.8e3)?)?;
        let cone = AnalyticChain::analytic_from_impact_face()
            .cone(&nylon, wide, narrow, 0.400)
            .end(Termination::Free)?;
        let stack = AnalyticChain::analytic_from_impact_face()
            .rod(&nylon, circle(0.032), 0.125)
            .rod(&steel(), circle(0.020), 0.125)
            .end(Termination::Free)?;
        let (means, bdf2) = (Quadrature::CellAverages, Quadrature::Bdf2);
        Ok(largest([
            gained(&cone, &[means, bdf2])?,
            gained(&stack, &[means, bdf2, Quadrature::Trapezoid])?,
            gained(&printed()?, &[means])?,
        ]))
    };
    claims.deviation(
        "energy gained by 20 forces from a cone, a stack of two materials, a cone known on the axis only, by three quadratures",
        Within(1e-6, "the alias of the next period, 1.5e-8 of each weight"),
        computed(),
    );
    let measured = || -> Ours {
        // lines up to 20 kHz, a whole number of steps to the period
        let front = nylon().specific_characteristic_impedance(TAU * 20e3).re;
        let front = front * FRAC_PI_4 * 0.030_f64.powi(2);
        let body = on_lines(&printed()?, front, 10.0, 2001);
        gained(&body, &[Quadrature::CellAverages])
    };
    claims.deviation(
        "energy gained by 20 forces from a body known on lines up to 20 kHz",
        Within(1e-4, "the band limit is not a property of the body"),
        measured(),
    );
}

/// A force of one of three kinds: white noise, a slow sine, and noise with a fast cosine.
fn force(seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..GRID.n_steps)
        .map(|n| {
            let noise: f64 = random.random_range(-1.0..1.0);
            match seed % 3 {
                0 => noise,
                1 => (0.01 * seed as f64 * n as f64).sin(),
                _ => noise * if n % 2 == 0 { 1.0 } else { -1.0 } + 0.5 * (3.1 * n as f64).cos(),
            }
        })
        .collect()
}
