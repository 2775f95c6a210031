//! Measured mobilities with faults of known size, screened and corrected.

use std::f64::consts::TAU;

use impulse::{ImpedanceHead, MeasuredBody, Projection, ScreeningFlag};
use num_complex::Complex64;

use crate::measured_body::{N_LINES, STEP_HZ, exact, front_impedance, mass, measured, noisy};
use testbed::claim::{Claims, Ours, Within, missing};
use testbed::difference::largest;
use testbed::hold;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    claims.by("a free body at low frequency: G = 1/(i omega M)");
    claims.deviation(
        "rod of nylon, five draws of 2 % noise: mass from its lines over its true mass, minus 1",
        Within(0.02, "2 % of noise on some dozen lines"),
        apparent_mass(),
    );
    claims.claim(
        "rod of nylon: mass from its lines, sensitivity 5 % too high",
        "kg",
        mass() / 1.05,
        Within(
            1e-3 * mass(),
            "the fitted law leaves out the sixth order, 2e-4",
        ),
        contradicted_mass(1.05),
    );
    claims.by("a causal response has half of the power of white noise");
    claims.claim(
        "causal projection: fraction of the noise that remains",
        "1",
        0.5,
        Within(0.1, "780 lines scatter by 5 %, times two"),
        noise_after_projection(),
    );
    claims.by("paper E, section 3.1: F = F_g - m a below the force gauge");
    claims.deviation(
        "impedance head: mobility of the bare face",
        Within(5e-15, "rounding of 1/(1 - mA)"),
        bare_face(),
    );
    hold!(claims);
}

fn apparent_mass() -> Ours {
    let mut errors = Vec::new();
    for seed in 0..5 {
        let (mobility, variance) = noisy(&exact(), 0.02, seed);
        let body = measured(&mobility).with_variance(&variance)?;
        let screening = body.with_front_impedance(front_impedance())?.screen();
        assert_eq!(screening.flags(), [], "{screening:?}");
        let found = screening.mass.ok_or_else(|| missing("the apparent mass"))?;
        errors.push(found.apparent / mass() - 1.0);
    }
    Ok(largest(errors))
}

fn contradicted_mass(scale: f64) -> Ours {
    let scaled: Vec<Complex64> = exact().iter().map(|line| scale * line).collect();
    let flags = measured(&scaled).screen().flags();
    let apparent = flags.iter().find_map(|flag| match flag {
        ScreeningFlag::MassContradicted { apparent, .. } => Some(*apparent),
        _ => None,
    });
    apparent.ok_or_else(|| missing("the flag of the mass"))
}

fn noise_after_projection() -> Ours {
    let exact = exact();
    let (mobility, _) = noisy(&exact, 0.05, 3);
    let of = |lines: &[Complex64]| -> Ours<MeasuredBody> {
        Ok(measured(lines).with_front_impedance(front_impedance())?)
    };
    let clean = of(&exact)?.projected(Projection::Causal);
    let before = of(&mobility)?;
    let after = before.projected(Projection::Causal);
    // the lines near the ends of the band are excluded
    let power = |from: &[Complex64], to: &[Complex64]| -> f64 {
        (20..800)
            .map(|line| (from[line] - to[line]).norm_sqr())
            .sum()
    };
    // the projection changes the lines of a causal body little, by the smearing of the band limit
    let size: f64 = exact[20..800].iter().map(Complex64::norm_sqr).sum();
    assert!(power(clean.mobility(), &exact) < 1e-3 * size);
    Ok(power(after.mobility(), clean.mobility()) / power(before.mobility(), &exact))
}

/// A gauge measures the force on the body and on 5 g below the gauge.
fn bare_face() -> Ours {
    let exact = exact();
    let below = 5e-3;
    let accelerance: Vec<Complex64> = exact
        .iter()
        .enumerate()
        .map(|(line, mobility)| {
            if line == 0 {
                return Complex64::from(1.0 / (mass() + below));
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
