//! Master curves and the laws of their shifts.

use std::f64::consts::TAU;

use cmod::estimate::ComplexCovariance;
use cmod::rheology::{
    FitOptions, MasterCurve, ModulusData, ModulusPoint, ShiftLaws, TemperatureSweep,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rodwave::modulus::{ComplexModulus, GeneralisedMaxwell, MaxwellBranch};

use testbed::claim::{Claims, Ours, Within, of};
use testbed::difference::largest;
use testbed::hold;

/// Reference temperature of the shifts, in K.
const REFERENCE: f64 = 353.15;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    shifts(claims);
    hold!(claims);
}

fn logarithmic(from: f64, to: f64, lines: u32) -> Vec<f64> {
    let step = (to / from).ln() / f64::from(lines - 1);
    (0..lines)
        .map(|j| from * (step * f64::from(j)).exp())
        .collect()
}

fn series(spring: f64, branches: &[(f64, f64)]) -> Ours<GeneralisedMaxwell> {
    let branch = |&(modulus, relaxation_time): &(f64, f64)| MaxwellBranch {
        modulus,
        relaxation_time,
    };
    Ok(GeneralisedMaxwell::new(
        spring,
        branches.iter().map(branch).collect(),
    )?)
}

/// Returns moduli with noise of E' and E'', relative to the modulus, and with the given
/// correlation.
fn with_noise(
    modulus: &dyn Fn(f64) -> Complex64,
    frequency_hz: &[f64],
    [storage, loss, correlation]: [f64; 3],
    seed: u64,
) -> Ours<ModulusData> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let points: Vec<ModulusPoint> = frequency_hz
        .iter()
        .map(|&frequency_hz| {
            let exact = modulus(TAU * frequency_hz);
            let (a, b, r) = (storage * exact.norm(), loss * exact.norm(), correlation);
            let (x, y) = (normal(), normal());
            let error = Complex64::new(a * x, b * (r * x + (1.0 - r * r).sqrt() * y));
            ModulusPoint {
                frequency_hz,
                modulus: exact + error,
                covariance: ComplexCovariance {
                    real: a * a,
                    imaginary: b * b,
                    mixed: r * a * b,
                },
            }
        })
        .collect();
    Ok(ModulusData::new(&points)?)
}

/// Returns ln a_T by Williams, Landel and Ferry.
fn wlf(temperature: f64) -> f64 {
    let d = temperature - REFERENCE;
    -std::f64::consts::LN_10 * 8.0 * d / (180.0 + d)
}

fn arrhenius(temperature: f64) -> f64 {
    120e3 / 8.314_462_618 * (1.0 / temperature - 1.0 / REFERENCE)
}

fn curve(log_shift: fn(f64) -> f64) -> Ours<(MasterCurve, ShiftLaws)> {
    let branches = [(0.5e9, 1e-6), (0.6e9, 2e-5), (0.5e9, 5e-4), (0.4e9, 2e-2)];
    let law = series(0.4e9, &branches)?;
    let mut steps = Vec::new();
    for k in 0..13_u32 {
        let temperature = 293.15 + 10.0 * f64::from(k);
        let a = log_shift(temperature).exp();
        let modulus = |omega: f64| law.at(omega * a);
        let frequency_hz = logarithmic(400.0, 10e3, 16);
        let data = with_noise(&modulus, &frequency_hz, [0.01, 0.01, 0.0], u64::from(k))?;
        steps.push((temperature, data));
    }
    let curve = MasterCurve::new(&TemperatureSweep::new(steps)?, 6, &FitOptions::default())?;
    let laws = curve.shift_laws()?;
    Ok((curve, laws))
}

fn shifts(claims: &mut Claims) {
    claims
        .by("Williams, Landel and Ferry with C_1 = 8, C_2 = 180 K; 13 temperatures, noise of 1 %");
    let by_wlf = curve(wlf);
    claims.claim(
        "master curve: root mean square of errors of shifts by their standard errors",
        "1",
        1.0,
        Within(
            0.7,
            "12 shifts whose errors are correlated: worth some five",
        ),
        of(&by_wlf, |(curve, _)| {
            let errors = curve
                .shifts
                .iter()
                .filter(|shift| shift.standard_error > 0.0);
            let squares = errors.map(|shift| {
                ((shift.log_shift - wlf(shift.temperature)) / shift.standard_error).powi(2)
            });
            (squares.sum::<f64>() / 12.0).sqrt()
        }),
    );
    claims.claim(
        "master curve: largest error of the logarithm of an identified shift",
        "1",
        0.0,
        Within(0.3, "some standard errors of shifts of up to 6"),
        of(&by_wlf, |(curve, _)| {
            largest(
                curve
                    .shifts
                    .iter()
                    .filter(|shift| shift.verdict.is_identified())
                    .map(|shift| (shift.log_shift - wlf(shift.temperature)).abs()),
            )
        }),
    );
    claims.claim(
        "master curve: C_1 less its value, in standard errors",
        "1",
        0.0,
        Within(3.0, "three standard errors"),
        of(&by_wlf, |(_, laws)| {
            (laws.wlf.c1 - 8.0) / laws.wlf.c1_standard_error
        }),
    );
    claims.claim(
        "master curve: C_2 less its value, in standard errors",
        "1",
        0.0,
        Within(3.0, "three standard errors"),
        of(&by_wlf, |(_, laws)| {
            (laws.wlf.c2 - 180.0) / laws.wlf.c2_standard_error
        }),
    );
    claims.claim(
        "master curve of a WLF material: probability of an Arrhenius law",
        "1",
        0.0,
        Within(0.01, "the level at which it is refused"),
        of(&by_wlf, |(_, laws)| laws.arrhenius_p_value),
    );
    claims.by("Arrhenius with 120 kJ/mol; 13 temperatures, noise of 1 %");
    let by_arrhenius = curve(arrhenius);
    claims.claim(
        "master curve: activation energy less its value, in standard errors",
        "1",
        0.0,
        Within(3.0, "three standard errors"),
        of(&by_arrhenius, |(_, laws)| {
            (laws.arrhenius.activation_energy - 120e3) / laws.arrhenius.standard_error
        }),
    );
    claims.claim(
        "master curve: activation energy",
        "J/mol",
        120e3,
        Within(2.4e3, "2 %, from moduli of 1 %"),
        of(&by_arrhenius, |(_, laws)| laws.arrhenius.activation_energy),
    );
}
