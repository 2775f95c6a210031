//! Mobilities in discrete time: closed forms, and the energy that no force can get out of a passive body.

use impulse::{
    ImpactBody, Kernel, LowFrequency, MeasuredBody, MobilityLaw, Quadrature, TimeGrid, WeighedMass,
    lines_of,
};
use num_complex::Complex64;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rodwave::chain::{AnalyticChain, Chain, Termination};
use rodwave::element::{Circle, CrossSection};
use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, Elastic, PowerLawPropagation};

const GRID: TimeGrid = TimeGrid {
    time_step: 2e-6,
    n_steps: 1000,
};

fn circle(diameter_mm: f64) -> Circle {
    Circle::of_diameter(1e-3 * diameter_mm).unwrap()
}

fn steel() -> Medium<Elastic> {
    Medium::new(7780.0, Elastic::new(206e9).unwrap()).unwrap()
}

/// Free elastic rod: G = (1/Z) coth(sT), an impulse 1/Z and echoes 2/Z every 2T. A hat over each, in the step that holds it and its
/// neighbour.
#[test]
fn echoes_of_an_elastic_rod() {
    let steps_to_the_end = 60.3;
    let speed = (206e9_f64 / 7780.0).sqrt();
    let body = AnalyticChain::analytic_from_impact_face()
        .rod(
            &steel(),
            circle(10.0),
            steps_to_the_end * GRID.time_step * speed,
        )
        .end(Termination::Free)
        .unwrap();
    let impedance = CrossSection::from(circle(10.0)).area() * (206e9_f64 * 7780.0).sqrt();
    let hat = |distance: f64| (1.0 - distance.abs()).max(0.0);
    let kernel = Kernel::of(&body, GRID, Quadrature::CellAverages).unwrap();
    for (n, weight) in kernel.weights().iter().enumerate() {
        let echoes = (1..10).map(|k| 2.0 * hat(n as f64 - 2.0 * f64::from(k) * steps_to_the_end));
        let exact = hat(n as f64) + echoes.sum::<f64>();
        let nearest = (n as f64 / (2.0 * steps_to_the_end)).round() * 2.0 * steps_to_the_end;
        // what the roll-off of the bands leaves of a kink, and the next period, e^{-18} = 1.5e-8 of 2
        let tolerance = match (n as f64 - nearest).abs() {
            _ if n < 50 => 1e-7,
            distance if distance < 2.0 => 0.07,
            distance if distance < 6.0 => 2e-3,
            _ => 2e-7,
        };
        assert!(
            (weight * impedance - exact).abs() < tolerance,
            "{n} {} {exact}",
            weight * impedance
        );
    }
}

#[test]
fn a_mass_moves_with_its_momentum() {
    let body = MobilityLaw::analytic(|s: Complex64| 1.0 / (0.4 * s))
        .free(0.4)
        .unwrap();
    let on_axis = MobilityLaw::on_axis(|s: Complex64| 1.0 / (0.4 * s))
        .free(0.4)
        .unwrap();
    let bodies: [&dyn ImpactBody; 2] = [&body, &on_axis];
    for body in bodies {
        let kernel = Kernel::of(body, GRID, Quadrature::CellAverages).unwrap();
        let drift = GRID.time_step / 0.4;
        for (n, weight) in kernel.weights().iter().enumerate() {
            let exact = if n == 0 { 0.5 * drift } else { drift };
            // the part of 1/Z that is taken off where there is none: 1e-5 of the first weight; the next period
            assert!(
                (weight - exact).abs() < 1e-4 * drift,
                "{n} {weight} {exact}"
            );
        }
    }
}

/// Work of a force on a body, $`h\sum F_n (w*F)_n`$: of the body itself for a force that is constant in each step, so never negative.
#[test]
fn no_force_gains_energy() {
    let power = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970).unwrap();
    let printed = Medium::new(1150.0, power).unwrap();
    let analytic = Medium::new(1150.0, ConstantQ::new(2.6e9, 0.094, 18.8e3).unwrap()).unwrap();
    let cone = AnalyticChain::analytic_from_impact_face()
        .cone(&analytic, circle(75.0), circle(30.0), 0.400)
        .end(Termination::Free)
        .unwrap();
    let stack = AnalyticChain::analytic_from_impact_face()
        .rod(&analytic, circle(32.0), 0.125)
        .rod(&steel(), circle(20.0), 0.125)
        .end(Termination::Free)
        .unwrap();
    let on_axis = Chain::from_impact_face()
        .cone(&printed, circle(30.0), circle(75.0), 0.400)
        .end(Termination::Free)
        .unwrap();
    // lines up to 20 kHz, a whole number of steps to the period
    let measured = MeasuredBody::from_mobility(
        &lines_of(&on_axis, 10.0, 2001).unwrap(),
        10.0,
        LowFrequency::Free(WeighedMass {
            mass: on_axis.free_mass().unwrap(),
            standard_error: 1e-4,
        }),
    )
    .unwrap()
    .with_front_impedance(
        printed
            .specific_characteristic_impedance(std::f64::consts::TAU * 20e3)
            .re
            * CrossSection::from(circle(30.0)).area(),
    )
    .unwrap();
    let bodies: [(&dyn ImpactBody, Quadrature); 7] = [
        (&cone, Quadrature::CellAverages),
        (&stack, Quadrature::CellAverages),
        (&on_axis, Quadrature::CellAverages),
        (&measured, Quadrature::CellAverages),
        (&cone, Quadrature::Bdf2),
        (&stack, Quadrature::Trapezoid),
        (&stack, Quadrature::Bdf2),
    ];
    for (index, (body, quadrature)) in bodies.into_iter().enumerate() {
        let kernel = Kernel::of(body, GRID, quadrature).unwrap();
        for seed in 0..20 {
            let force = force(&mut ChaCha8Rng::seed_from_u64(seed), seed);
            let (mut work, mut size) = (0.0, 0.0);
            for n in 0..force.len() {
                let velocity: f64 = (0..=n).map(|j| kernel.weights()[n - j] * force[j]).sum();
                work += force[n] * velocity;
                size += (force[n] * velocity).abs();
            }
            // the alias of the next period, 1.5e-8 of each weight; a band limit that is not one of the body, 1e-4
            let tolerance = if index == 3 { 1e-4 } else { 1e-6 };
            assert!(work > -tolerance * size, "{index} {seed} {work} {size}");
        }
    }
}

/// White noise, and slow and alternating forces that look for a weakness.
fn force(random: &mut impl Rng, seed: u64) -> Vec<f64> {
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
