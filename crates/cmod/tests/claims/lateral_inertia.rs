//! Lateral inertia taken out of estimates of waves that the exact theory of cylinders has made.

use std::f64::consts::TAU;

use cmod::estimate::ModulusEstimate;
use cmod::validity::AcceptanceLimits;
use cmod::{LateralInertia, PulsedRod, SeparatePulses};
use rodwave::modulus::{ComplexModulus, ConstantQ};
use rodwave::slenderness::{PochhammerChree, RodTheory, RoundRod, Theory};

use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::difference::largest;
use testbed::hold;

const DENSITY: f64 = 912.0;
const DIAMETER: f64 = 0.0158;
const DISTANCE: f64 = 0.1;
const POISSON_RATIO: f64 = 0.40;

/// E' and E''/E' over those of the material, at a wavelength.
type Ratios = [f64; 2];

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    claims
        .by("frequency equation of Pochhammer and Chree in 30 digits, nu = 0.4, loss factor 0.08");
    let apparent = apparent();
    let by_love = || -> Ours<ModulusEstimate> {
        let apparent = apparent.as_ref().map_err(Clone::clone)?;
        let inertia = LateralInertia::new(DIAMETER, DENSITY, POISSON_RATIO)?;
        let corrected = inertia
            .with_theory(Theory::LoveRayleigh)
            .correct(apparent)?;
        Ok(corrected.modulus().clone())
    };
    let by_love = by_love();
    let within = Within(1e-4, "the interpolation between lines 1 kHz apart");
    for (name, estimate, diameters, expected) in [
        (
            "apparent, wavelength of 5 D",
            &apparent,
            5.0,
            [0.967_576, 1.035_389],
        ),
        (
            "after Love, wavelength of 5 D",
            &by_love,
            5.0,
            [0.998_292, 1.003_532],
        ),
        (
            "after Love, wavelength of 3 D",
            &by_love,
            3.0,
            [0.987_143, 1.028_256],
        ),
    ] {
        let found = estimate
            .as_ref()
            .map_err(Clone::clone)
            .and_then(|estimate| at_wavelength(estimate, diameters));
        for (index, quantity) in ["E'", "loss factor"].into_iter().enumerate() {
            claims.claim(
                format!("{name}: {quantity} over that of the material"),
                "1",
                expected[index],
                within,
                of(&found, |found| found[index]),
            );
        }
    }
    claims.by("Pochhammer and Chree, solved for the wave and for the modulus");
    let exact = || -> Ours {
        let apparent = apparent.as_ref().map_err(Clone::clone)?;
        let inertia = LateralInertia::new(DIAMETER, DENSITY, POISSON_RATIO)?;
        let corrected = inertia
            .with_theory(Theory::PochhammerChree)
            .correct(apparent)?;
        let material = material()?;
        Ok(largest(corrected.modulus().lines().iter().map(|line| {
            let exact = material.at(TAU * line.frequency_hz);
            (line.modulus - exact).norm() / exact.norm()
        })))
    };
    claims.deviation(
        "modulus after the exact theory, wavelengths of 50 D to 2 D",
        Within(1e-8, "the convergence of two secants"),
        exact(),
    );
    hold!(claims);
}

fn material() -> Ours<ConstantQ> {
    Ok(ConstantQ::new(2.6e9, 0.08, TAU * 1e4)?)
}

/// From waves over 0.1 m, 2 to 48 kHz.
fn apparent() -> Ours<ModulusEstimate> {
    let material = material()?;
    let theory = PochhammerChree::new(RoundRod {
        density: DENSITY,
        diameter: DIAMETER,
        poisson_ratio: POISSON_RATIO,
    })?;
    let frequency_hz: Vec<f64> = (1..=48).map(|j| 1e3 * f64::from(j)).collect();
    let ratio = frequency_hz
        .iter()
        .map(|f| {
            let omega = TAU * f;
            let gamma = theory.propagation_coefficient(material.at(omega), omega)?;
            let gamma = gamma.found().ok_or_else(|| missing("the first branch"))?;
            Ok((-gamma * DISTANCE).exp())
        })
        .collect::<Ours<Vec<_>>>()?;
    Ok(SeparatePulses::new(PulsedRod {
        distance: DISTANCE,
        diameter: DIAMETER,
        density: DENSITY,
    })?
    .with_limits(AcceptanceLimits::NONE)?
    .estimate(&frequency_hz, &ratio, &[0.0; 48])?)
}

/// Between the two lines beside it.
fn at_wavelength(estimate: &ModulusEstimate, diameters: f64) -> Ours<Ratios> {
    let material = material()?;
    let near: Vec<(f64, Ratios)> = estimate
        .lines()
        .iter()
        .map(|line| {
            let exact = material.at(TAU * line.frequency_hz);
            let ratios = [
                line.modulus.re / exact.re,
                line.loss_factor / (exact.im / exact.re),
            ];
            (line.wavelength() / DIAMETER - diameters, ratios)
        })
        .collect();
    let pair = near
        .windows(2)
        .find(|pair| pair[0].0 >= 0.0 && pair[1].0 < 0.0)
        .ok_or_else(|| missing("a line on either side"))?;
    let share = pair[0].0 / (pair[0].0 - pair[1].0);
    Ok([0, 1].map(|i| pair[0].1[i] + share * (pair[1].1[i] - pair[0].1[i])))
}
