//! Claims on standard errors with noise on both histories: coverage of the intervals, and size of
//! the errors.

use maxwellid::{Fit, IdentifiableLaw, Noise, RodModel, RodTest, Scale};
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};

use crate::virtual_rod::{LENGTH, V0, struck};
use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::difference::largest;
use testbed::hold;

/// Noise of either history, in m/s: 1 % of the impact velocity.
const NOISE: f64 = 0.1;
const SEEDS: u64 = 100;

/// Results, each for the worst parameter: `inside`, the fraction of the intervals that contain the
/// truth, minus 0.95; `mean` of error over standard error; `squares`, the mean of the square of
/// this ratio, minus 1. `to_noise` is the mean ratio of residual to stated noise.
struct Covered {
    inside: f64,
    mean: f64,
    squares: f64,
    to_noise: f64,
}

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    claims.by("100 draws of noise of 1 % of the impact velocity on both histories");
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
        claims.deviation(
            format!("{name}: coverage of the 95 % intervals minus 95 %, worst parameter"),
            Within(0.045, "100 draws: 2.2 %, times two"),
            of(&found, |found| found.inside),
        );
        claims.deviation(
            format!("{name}: mean of errors over standard errors, of each parameter"),
            Within(0.4, "1/sqrt(100) = 10 %, times four"),
            of(&found, |found| found.mean),
        );
        claims.deviation(
            format!("{name}: mean square of errors over standard errors, of each parameter"),
            Within(0.56, "sqrt(2/100) = 14 %, times four"),
            of(&found, |found| found.squares),
        );
        claims.claim(
            format!("{name}: residual over the stated noise"),
            "1",
            1.0,
            Within(0.03, "1/sqrt(2 100 100) = 0.7 %, times four"),
            of(&found, |found| found.to_noise),
        );
    }
    hold!(claims);
}

fn covered<L: IdentifiableLaw>(modulus: f64, truth: &L, start: &L) -> Ours<Covered> {
    let clean = struck(LENGTH, V0, modulus, truth, 88);
    let expected = RodModel::stated(truth, &RodModel::parameters(truth, modulus));
    let mut sums = vec![[0.0; 3]; expected.len()];
    let mut to_noise = 0.0;
    for seed in 0..SEEDS {
        let test = RodTest::new(clean.noisy(NOISE, seed))?.with_noise(NOISE, NOISE)?;
        let fit = Fit::of(start.clone()).with_cell(8e-3).to(&[test])?;
        if !fit.termination().was_successful() {
            return Err(missing("the end of a fit"));
        }
        let judged = fit
            .identifiability(Noise::Stated)
            .ok_or_else(|| missing("the covariance"))?;
        for ((estimate, truth), sums) in judged.estimates.iter().zip(&expected).zip(&mut sums) {
            let (low, high) = estimate.interval_95();
            let error = match estimate.scale {
                Scale::Ratio => (estimate.value / truth.value).ln(),
                Scale::Difference => estimate.value - truth.value,
            } / estimate.standard_error;
            sums[0] += f64::from(u8::from(low <= truth.value && truth.value <= high));
            sums[1] += error;
            sums[2] += error * error;
        }
        to_noise += fit.ratio_to_noise();
    }
    let n = SEEDS as f64;
    let worst = |place: usize, of: f64| largest(sums.iter().map(|sums| sums[place] / n - of));
    Ok(Covered {
        inside: worst(0, 0.95),
        mean: worst(1, 0.0),
        squares: worst(2, 1.0),
        to_noise: to_noise / n,
    })
}
