//! Standard errors with noise on both histories: do intervals cover, and are errors of the stated size?

use maxwellid::{Fit, IdentifiableLaw, Noise, RodModel, RodTest, Scale};
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};

use super::virtual_rod::{VELOCITY, noisy, struck};
use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::hold;

/// Of either history, in m/s: 1 % of the impact velocity.
const NOISE: f64 = 0.1;
const SEEDS: u64 = 200;

/// Part of the intervals that hold the truth, mean square of errors in standard errors, mean ratio of residual to stated noise.
struct Covered {
    inside: f64,
    squares: f64,
    to_noise: f64,
}

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    claims.by("200 draws of noise of 1 % of the impact velocity on both histories");
    let maxwell = || covered(3.0e9, &Maxwell::new(4e6)?, &Maxwell::new(1e6)?);
    let norton = || {
        let start = MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6)?;
        covered(2.58e9, &MaxwellNorton::new(2.108, 7e13)?, &start)
    };
    let rabinovich = || {
        let start = MaxwellGurevichRabinovich::from_reference_rate(0.2, 1.0, 10e6)?;
        covered(
            2.107e9,
            &MaxwellGurevichRabinovich::new(3.5e6, 7.08e6)?,
            &start,
        )
    };
    for (name, found) in [
        ("Maxwell", maxwell()),
        ("Norton", norton()),
        ("Gurevich-Rabinovich", rabinovich()),
    ] {
        claims.claim(
            format!("{name}: intervals of 95 % that hold the truth"),
            "1",
            0.95,
            Within(
                0.031,
                "200 draws of correlated parameters, 1.5 %; two of it",
            ),
            of(&found, |found| found.inside),
        );
        claims.claim(
            format!("{name}: mean square of errors over standard errors"),
            "1",
            1.0,
            Within(0.3, "sqrt(2/200) = 10 %, three of it"),
            of(&found, |found| found.squares),
        );
        claims.claim(
            format!("{name}: residual over the stated noise"),
            "1",
            1.0,
            Within(0.02, "1/sqrt(2 100 200) = 0.5 %, four of it"),
            of(&found, |found| found.to_noise),
        );
    }
    hold!(claims);
}

fn covered<L: IdentifiableLaw>(modulus: f64, truth: &L, start: &L) -> Ours<Covered> {
    let clean = struck(modulus, truth, VELOCITY, 88)?;
    let expected = RodModel::stated(truth, &RodModel::parameters(truth, modulus));
    let (mut inside, mut squares, mut to_noise, mut count) = (0.0, 0.0, 0.0, 0.0);
    for seed in 0..SEEDS {
        let test = RodTest::new(noisy(&clean, NOISE, seed))?.with_noise(NOISE, NOISE)?;
        let fit = Fit::of(start.clone()).with_cell(8e-3).to(&[test])?;
        let judged = fit
            .identifiability(Noise::Stated)
            .ok_or_else(|| missing("the covariance"))?;
        for (estimate, truth) in judged.estimates.iter().zip(&expected) {
            let (low, high) = estimate.interval_95();
            let error = match estimate.scale {
                Scale::Ratio => (estimate.value / truth.value).ln(),
                Scale::Difference => estimate.value - truth.value,
            };
            inside += f64::from(u8::from(low <= truth.value && truth.value <= high));
            squares += (error / estimate.standard_error).powi(2);
            count += 1.0;
        }
        to_noise += fit.ratio_to_noise();
    }
    Ok(Covered {
        inside: inside / count,
        squares: squares / count,
        to_noise: to_noise / SEEDS as f64,
    })
}
