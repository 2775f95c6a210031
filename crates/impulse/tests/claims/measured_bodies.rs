//! Measured mobilities with faults of known size, screened and corrected.

use std::f64::consts::{FRAC_PI_4, TAU};

use impulse::{
    ImpedanceHead, LowFrequency, MeasuredBody, Reciprocity, ScreeningFlag, WeighedMass, lines_of,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rodwave::chain::{Chain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::PowerLawPropagation;

use testbed::claim::{Claims, Ours, Within, missing};
use testbed::difference::largest;
use testbed::hold;

const STEP_HZ: f64 = 10.0;
const N_LINES: usize = 1025;
const DIAMETER: f64 = 0.040;
const LENGTH: f64 = 0.300;
const DENSITY: f64 = 1150.0;
const MASS: f64 = FRAC_PI_4 * DIAMETER * DIAMETER * LENGTH * DENSITY;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    claims.by("a free body at low frequency: G = 1/(i omega M)");
    claims.claim(
        "rod of nylon: mass by its lines, 2 % of noise",
        "kg",
        MASS,
        Within(0.02 * MASS, "2 % of noise on some dozen lines"),
        apparent_mass(1.0),
    );
    claims.claim(
        "rod of nylon: mass by its lines, sensitivity 5 % too high",
        "kg",
        MASS / 1.05,
        Within(0.01 * MASS, "the fitted law leaves out the fourth order"),
        contradicted_mass(1.05),
    );
    claims.deviation(
        "rod of nylon: lines below 100 Hz from the weighed mass",
        Within(1e-3, "the fourth order, and the loss that a mass has not"),
        completed_lines(),
    );
    claims.by("a driving point takes energy: Re G >= 0");
    claims.claim(
        "reversed sensor: active lines",
        "1",
        (N_LINES - 1) as f64,
        Within(0.5, "a count"),
        active_lines(|exact| exact.iter().map(|line| -line).collect()),
    );
    claims.claim(
        "right sensor: active lines",
        "1",
        0.0,
        Within(0.5, "a count"),
        active_lines(<[Complex64]>::to_vec),
    );
    claims.by("a causal response has half of the power of white noise");
    claims.claim(
        "causal projection: part of the noise that is left",
        "1",
        0.5,
        Within(0.1, "780 lines scatter by 5 %; two of these"),
        noise_after_projection(),
    );
    claims.by("reciprocity, G_12 = G_21");
    claims.claim(
        "two mobilities 3 % of noise apart: contradicting lines",
        "1",
        0.0,
        Within(0.5, "a count"),
        contradicting_lines(1.0),
    );
    claims.by("paper E, section 3.1: F = F_g - m a below the force gauge");
    claims.deviation(
        "impedance head: mobility of the bare face",
        Within(1e-12, "rounding of 1/(1 - mA)"),
        bare_face(),
    );
    hold!(claims);
}

fn rod() -> Ours<Chain> {
    let law = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?;
    let nylon = Medium::new(DENSITY, law)?;
    Ok(Chain::from_impact_face()
        .rod(&nylon, Circle::of_diameter(DIAMETER)?, LENGTH)
        .end(Termination::Free)?)
}

fn exact() -> Ours<Vec<Complex64>> {
    Ok(lines_of(&rod()?, STEP_HZ, N_LINES)?)
}

fn measured(mobility: &[Complex64]) -> Ours<MeasuredBody> {
    let weighed = WeighedMass {
        mass: MASS,
        standard_error: 1e-4 * MASS,
    };
    Ok(MeasuredBody::from_mobility(
        mobility,
        STEP_HZ,
        LowFrequency::Free(weighed),
    )?)
}

/// Circular noise of `relative` size on every line, and its variance.
fn noisy(mobility: &[Complex64], relative: f64, seed: u64) -> (Vec<Complex64>, Vec<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    mobility
        .iter()
        .map(|line| {
            let size = relative * line.norm();
            let noise = Complex64::new(normal(), normal()) * (0.5_f64.sqrt() * size);
            (line + noise, size * size)
        })
        .unzip()
}

fn apparent_mass(scale: f64) -> Ours {
    let (mobility, variance) = noisy(&exact()?, 0.02, 0);
    let scaled: Vec<Complex64> = mobility.iter().map(|line| scale * line).collect();
    let body = measured(&scaled)?.with_variance(&variance)?;
    let mass = body.screen().mass;
    Ok(mass.ok_or_else(|| missing("the apparent mass"))?.apparent)
}

fn contradicted_mass(scale: f64) -> Ours {
    let scaled: Vec<Complex64> = exact()?.iter().map(|line| scale * line).collect();
    let flags = measured(&scaled)?.screen().flags();
    let apparent = flags.iter().find_map(|flag| match flag {
        ScreeningFlag::MassContradicted { apparent, .. } => Some(*apparent),
        _ => None,
    });
    apparent.ok_or_else(|| missing("the flag of the mass"))
}

fn completed_lines() -> Ours {
    let exact = exact()?;
    let mut spoilt = exact.clone();
    for line in spoilt.iter_mut().take(10) {
        *line *= Complex64::new(0.6, 0.3);
    }
    let completed = measured(&spoilt)?.completed_below(100.0, 400.0)?;
    let pairs = completed.mobility().iter().zip(&exact).skip(1);
    Ok(largest(pairs.map(|(found, exact)| {
        (found - exact).norm() / exact.norm()
    })))
}

fn active_lines(change: impl Fn(&[Complex64]) -> Vec<Complex64>) -> Ours {
    let body = measured(&change(&exact()?))?;
    Ok(body.screen().passivity.active_lines as f64)
}

fn noise_after_projection() -> Ours {
    let exact = exact()?;
    let (mobility, _) = noisy(&exact, 0.05, 3);
    let law = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?;
    let impedance = Medium::new(DENSITY, law)?
        .specific_characteristic_impedance(TAU * 10e3)
        .re
        * FRAC_PI_4
        * DIAMETER.powi(2);
    let of = |lines: &[Complex64]| -> Ours<MeasuredBody> {
        Ok(measured(lines)?.with_front_impedance(impedance)?)
    };
    let clean = of(&exact)?.causally_projected();
    let before = of(&mobility)?;
    let after = before.causally_projected();
    let power = |from: &[Complex64], to: &[Complex64]| -> f64 {
        // away from the edge of the band
        (20..800)
            .map(|line| (from[line] - to[line]).norm_sqr())
            .sum()
    };
    Ok(power(after.mobility(), clean.mobility()) / power(before.mobility(), &exact))
}

fn contradicting_lines(scale: f64) -> Ours {
    let exact = exact()?;
    let ((forward, first), (backward, second)) = (noisy(&exact, 0.03, 5), noisy(&exact, 0.03, 6));
    let backward: Vec<Complex64> = backward.iter().map(|line| scale * line).collect();
    let found = Reciprocity::between(&forward, &backward, [&first, &second])?;
    Ok(found.contradicting_lines as f64)
}

/// The gauge feels the body and 5 g below it.
fn bare_face() -> Ours {
    let exact = exact()?;
    let below = 5e-3;
    let accelerance: Vec<Complex64> = exact
        .iter()
        .enumerate()
        .map(|(line, mobility)| {
            if line == 0 {
                return Complex64::from(1.0 / (MASS + below));
            }
            let s = Complex64::new(0.0, TAU * STEP_HZ * line as f64);
            1.0 / (1.0 / (s * mobility) + below)
        })
        .collect();
    let face = ImpedanceHead::new(below)?.face_mobility(&accelerance, &[0.0; N_LINES], STEP_HZ)?;
    let pairs = face.mobility.iter().zip(&exact).skip(1);
    Ok(largest(pairs.map(|(found, exact)| {
        (found - exact).norm() / exact.norm()
    })))
}
