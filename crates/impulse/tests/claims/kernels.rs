//! Mobilities in discrete time.

use impulse::{ImpactBody, Kernel, MobilityLaw, Quadrature, TimeGrid};
use num_complex::Complex64;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use super::bodies::{impedance, rod, steel, wave_speed};
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
    let claims = &mut claims;
    echoes(claims);
    drift_of_a_mass(claims);
    no_energy_from_a_passive_body(claims);
    hold!(claims);
}

/// G = (1/Z) coth(sT): an impulse 1/Z and echoes 2/Z every 2T, each as a hat over the steps beside it.
fn echoes(claims: &mut Claims) {
    claims.by("G = coth(sT)/Z, free elastic rod");
    let to_the_end = 60.3;
    let weights = || -> Ours<Vec<f64>> {
        let body = rod(0.010, to_the_end * GRID.time_step * wave_speed())?;
        Ok(Kernel::of(&body, GRID, Quadrature::CellAverages)?
            .weights()
            .to_vec())
    };
    let weights = weights();
    let z = impedance(0.010);
    let hat = |distance: f64| (1.0 - distance.abs()).max(0.0);
    let nearest = |n: f64| 2.0 * to_the_end * (n / (2.0 * to_the_end)).round();
    claims.deviation(
        "free elastic rod: kernel between the echoes",
        Within(2e-7, "the alias of the next period, e^-18, of echoes of 2"),
        weights.as_ref().map_err(Clone::clone).map(|weights| {
            let samples = weights.iter().enumerate();
            largest(
                samples
                    .map(|(n, weight)| (n as f64, weight * z))
                    .filter(|(n, _)| *n > 0.0 && (n - nearest(*n)).abs() >= 6.0)
                    .map(|(_, weight)| weight.abs()),
            )
        }),
    );
    claims.deviation(
        "free elastic rod: first weight 1/Z",
        Within(1e-7, "the alias of the next period"),
        weights
            .as_ref()
            .map_err(Clone::clone)
            .map(|weights| (weights[0] * z - 1.0).abs()),
    );
    claims.deviation(
        "free elastic rod: impulse of the echoes, 2/Z each",
        Within(1e-3, "what the roll-off of the bands leaves beside an echo"),
        weights.as_ref().map_err(Clone::clone).map(|weights| {
            largest((1..8).map(|k| {
                let at = 2.0 * f64::from(k) * to_the_end;
                let sums =
                    weights
                        .iter()
                        .enumerate()
                        .fold([0.0; 2], |[found, exact], (n, weight)| {
                            let distance = n as f64 - at;
                            if distance.abs() < 20.0 {
                                [found + weight * z, exact + 2.0 * hat(distance)]
                            } else {
                                [found, exact]
                            }
                        });
                (sums[0] / sums[1] - 1.0).abs()
            }))
        }),
    );
}

fn drift_of_a_mass(claims: &mut Claims) {
    claims.by("G = 1/(sM): a unit impulse leaves the velocity 1/M");
    let kilograms = 0.4;
    let law = move |s: Complex64| 1.0 / (kilograms * s);
    let error = |body: &dyn ImpactBody| -> Ours {
        let kernel = Kernel::of(body, GRID, Quadrature::CellAverages)?;
        let drift = GRID.time_step / kilograms;
        let exact = |n: usize| if n == 0 { 0.5 * drift } else { drift };
        let weights = kernel.weights().iter().enumerate();
        Ok(largest(
            weights.map(|(n, weight)| (weight - exact(n)).abs() / drift),
        ))
    };
    let within = Within(
        1e-4,
        "the part of 1/Z that is taken off where there is none, and the next period",
    );
    claims.deviation(
        "rigid mass, formula in the right half plane: kernel",
        within,
        MobilityLaw::analytic(law)
            .free(kilograms)
            .map_err(Into::into)
            .and_then(|body| error(&body)),
    );
    claims.deviation(
        "rigid mass, formula on the frequency axis only: kernel",
        within,
        MobilityLaw::on_axis(law)
            .free(kilograms)
            .map_err(Into::into)
            .and_then(|body| error(&body)),
    );
}

/// Work of a force on a body, h Σ Fₙ (w*F)ₙ, by the size of its terms.
fn no_energy_from_a_passive_body(claims: &mut Claims) {
    claims.by("a passive body gives no energy: sum F_n (w*F)_n >= 0");
    let nylon = || -> Ours<Medium<ConstantQ>> {
        Ok(Medium::new(1150.0, ConstantQ::new(2.6e9, 0.094, 18.8e3)?)?)
    };
    let cone = || -> Ours<AnalyticChain> {
        let (wide, narrow) = (Circle::of_diameter(0.075)?, Circle::of_diameter(0.030)?);
        Ok(AnalyticChain::analytic_from_impact_face()
            .cone(&nylon()?, wide, narrow, 0.400)
            .end(Termination::Free)?)
    };
    let stack = || -> Ours<AnalyticChain> {
        Ok(AnalyticChain::analytic_from_impact_face()
            .rod(&nylon()?, Circle::of_diameter(0.032)?, 0.125)
            .rod(&steel()?, Circle::of_diameter(0.020)?, 0.125)
            .end(Termination::Free)?)
    };
    let gained = |body: Ours<AnalyticChain>, quadrature| -> Ours {
        let body = body?;
        let kernel = Kernel::of(&body, GRID, quadrature)?;
        let weights = kernel.weights();
        let mut most = 0.0_f64;
        for seed in 0..6 {
            let force = forces(seed);
            let (mut work, mut size) = (0.0, 0.0);
            for n in 0..force.len() {
                let velocity: f64 = (0..=n).map(|j| weights[n - j] * force[j]).sum();
                work += force[n] * velocity;
                size += (force[n] * velocity).abs();
            }
            most = most.max(-work / size);
        }
        Ok(most)
    };
    let within = Within(1e-6, "the alias of the next period, 1.5e-8 of each weight");
    for (name, body, quadrature) in [
        ("cone, means over steps", cone(), Quadrature::CellAverages),
        ("cone, BDF2", cone(), Quadrature::Bdf2),
        (
            "stack of two materials, means over steps",
            stack(),
            Quadrature::CellAverages,
        ),
        (
            "stack of two materials, trapezium",
            stack(),
            Quadrature::Trapezoid,
        ),
    ] {
        claims.deviation(
            format!("energy gained from a body, {name}"),
            within,
            gained(body, quadrature),
        );
    }
}

/// White, slow and alternating forces.
fn forces(seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..GRID.n_steps)
        .map(|n| {
            let noise: f64 = random.random_range(-1.0..1.0);
            let n = n as f64;
            match seed % 3 {
                0 => noise,
                1 => (0.01 * seed as f64 * n).sin(),
                _ => noise + (3.1 * n).cos(),
            }
        })
        .collect()
}
