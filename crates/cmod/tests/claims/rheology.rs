//! Laws fitted to moduli with known truth, master curves and the laws of their shifts.

use std::f64::consts::TAU;

use cmod::estimate::ComplexCovariance;
use cmod::rheology::{
    FitOptions, Law, MasterCurve, ModulusData, ModulusPoint, PronyFit, RheologicalFit, ShiftLaws,
    TemperatureSweep,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rodwave::modulus::{
    ComplexModulus, FractionalZener, GeneralisedMaxwell, HavriliakNegami, KelvinVoigt,
    MaxwellBranch, Zener,
};

use testbed::claim::{Claims, Ours, Within, missing, of};
use testbed::difference::largest;
use testbed::hold;
use testbed::papers::paper_e;

/// Of the shifts, in K.
const REFERENCE: f64 = 353.15;

/// A modulus over angular frequency, and the parameters of its law in the order of a fit.
type Truth = (Box<dyn Fn(f64) -> Complex64>, Vec<f64>);

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    exact_data(claims);
    nylon(claims);
    scatter(claims);
    shifts(claims);
    hold!(claims);
}

fn logarithmic(from: f64, to: f64, lines: u32) -> Vec<f64> {
    let step = (to / from).ln() / f64::from(lines - 1);
    (0..lines)
        .map(|j| from * (step * f64::from(j)).exp())
        .collect()
}

fn band() -> Vec<f64> {
    logarithmic(50.0, 50e3, 100)
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

/// Errors of 1 % are stated, none is made.
fn without_error(modulus: &dyn Fn(f64) -> Complex64) -> Ours<ModulusData> {
    let points: Vec<ModulusPoint> = band()
        .into_iter()
        .map(|f| {
            let e = modulus(TAU * f);
            ModulusPoint::circular(f, e, 0.01 * e.norm())
        })
        .collect();
    Ok(ModulusData::new(&points)?)
}

/// Noise of E' and E'' in shares of the modulus, and their correlation.
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

fn kelvin_voigt() -> Ours<Truth> {
    let law = KelvinVoigt::new(2.0e9, 1.5e4)?;
    Ok((Box::new(move |omega| law.at(omega)), vec![2.0e9, 1.5e4]))
}

fn zener() -> Ours<Truth> {
    let law = Zener::new(2.0e9, 2.7e9, 4e-5)?;
    let truth = vec![2.0e9, 0.7e9, 4e-5];
    Ok((Box::new(move |omega| law.at(omega)), truth))
}

fn fractional_zener() -> Ours<Truth> {
    let law = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45)?;
    let truth = vec![1.8e9, 1.6e9, 4e-5, 0.45];
    Ok((Box::new(move |omega| law.at(omega)), truth))
}

fn havriliak_negami() -> Ours<Truth> {
    let law = HavriliakNegami::new(1.5e9, 3.6e9, 2e-4, 0.7, 0.5)?;
    let truth = vec![1.5e9, 2.1e9, 2e-4, 0.7, 0.35];
    Ok((Box::new(move |omega| law.at(omega)), truth))
}

fn two_branches() -> Ours<Truth> {
    let law = series(2.0e9, &[(0.4e9, 2e-5), (0.3e9, 1e-3)])?;
    let truth = vec![2.0e9, 0.4e9, 2e-5, 0.3e9, 1e-3];
    Ok((Box::new(move |omega| law.at(omega)), truth))
}

fn exact_data(claims: &mut Claims) {
    claims.by("parameters of the law that has made the modulus");
    let within = Within(1e-4, "a hundredth of the error that the stated 1 % leaves");
    let truths = [
        ("Kelvin and Voigt", Law::KelvinVoigt, kelvin_voigt()),
        ("Zener", Law::Zener, zener()),
        ("fractional Zener", Law::FractionalZener, fractional_zener()),
        (
            "Havriliak and Negami",
            Law::HavriliakNegami,
            havriliak_negami(),
        ),
        (
            "two Maxwell branches and a spring",
            Law::GeneralisedMaxwell,
            two_branches(),
        ),
    ];
    for (name, law, truth) in truths {
        let worst = || -> Ours {
            let (modulus, truth) = truth.as_ref().map_err(Clone::clone)?;
            let data = without_error(modulus)?;
            let options = FitOptions::default();
            let fit = match law {
                Law::GeneralisedMaxwell => PronyFit::with_order(&data, 2, &options)?.fit,
                _ => RheologicalFit::new(&data, law, &options)?,
            };
            if fit.parameters.len() != truth.len() {
                return Err(missing("a parameter"));
            }
            let pairs = fit.parameters.iter().zip(truth);
            Ok(largest(
                pairs.map(|(found, truth)| (found.value / truth - 1.0).abs()),
            ))
        };
        claims.deviation(
            format!("{name}: worst parameter of a fit to exact data"),
            within,
            worst(),
        );
    }
}

/// The printed numbers come back from a curve that was made with them.
fn nylon(claims: &mut Claims) {
    claims.by("paper E, eq. 7, Nylon-6");
    let paper = paper_e::load();
    let printed = paper.as_ref().map_or([f64::NAN; 4], |paper| paper.nylon);
    let fit = || -> Ours<Vec<f64>> {
        let density = paper_e::load()?.nylon_density;
        let [a, p, b, q] = printed;
        // E = -ρω²/γ², γ = aω^p + i bω^q
        let modulus = move |omega: f64| {
            let gamma = Complex64::new(a * omega.powf(p), b * omega.powf(q));
            -density * omega * omega / (gamma * gamma)
        };
        let data = without_error(&modulus)?;
        let fit = RheologicalFit::new(&data, Law::PowerLaw { density }, &FitOptions::default())?;
        Ok(fit
            .parameters
            .iter()
            .map(|parameter| parameter.value)
            .collect())
    };
    let fit = fit();
    let half = "half of the last printed digit";
    for (index, (name, unit, digit)) in [
        ("coefficient of the damping", "1/m (rad/s)^-0.894", 0.5e-8),
        ("exponent of the damping", "1", 5e-4),
        (
            "coefficient of the wave number",
            "1/m (rad/s)^-0.970",
            0.5e-7,
        ),
        ("exponent of the wave number", "1", 5e-4),
    ]
    .into_iter()
    .enumerate()
    {
        claims.claim(
            format!("power laws fitted to the modulus of Nylon-6: {name}"),
            unit,
            printed[index],
            Within(digit, half),
            of(&fit, |fit| fit.get(index).copied().unwrap_or(f64::NAN)),
        );
    }
}

fn scatter(claims: &mut Claims) {
    let draws = 40;
    for (name, law) in [
        ("Zener", Law::Zener),
        ("fractional Zener", Law::FractionalZener),
    ] {
        claims.by("40 draws of correlated noise of 1 % of E' and 0.4 % of E''");
        let found = || -> Ours<[f64; 3]> {
            let (modulus, truth) = if law == Law::Zener {
                zener()?
            } else {
                fractional_zener()?
            };
            let (mut covered, mut chi_squared, mut refused) = (0.0, 0.0, 0.0);
            for seed in 0..draws {
                let data = with_noise(&modulus, &band(), [0.01, 0.004, 0.6], seed)?;
                let fit = RheologicalFit::new(&data, law, &FitOptions::default())?;
                chi_squared += fit.chi_squared / fit.degrees_of_freedom as f64;
                refused += f64::from(u8::from(!fit.whiteness.is_white(0.05)));
                let pairs = fit.parameters.iter().zip(&truth);
                covered += pairs
                    .map(|(found, truth)| f64::from(u8::from(found.interval.contains(*truth))))
                    .sum::<f64>()
                    / truth.len() as f64;
            }
            Ok([covered, chi_squared, refused].map(|sum| sum / draws as f64))
        };
        let found = found();
        claims.claim(
            format!("{name}: intervals of 95 % that hold the truth"),
            "1",
            0.95,
            Within(
                0.069,
                "40 draws of correlated parameters, at most 3.4 %; two of it",
            ),
            of(&found, |found| found[0]),
        );
        claims.claim(
            format!("{name}: chi-square by its degrees of freedom"),
            "1",
            1.0,
            Within(0.064, "sqrt(2/196/40) = 1.6 %, four of it"),
            of(&found, |found| found[1]),
        );
        claims.claim(
            format!("{name}: residuals of the right law called not white at 0.05"),
            "1",
            0.05,
            Within(0.11, "sqrt(0.05 0.95/40) = 3.4 %, three of it"),
            of(&found, |found| found[2]),
        );
    }
}

/// ln a_T by Williams, Landel and Ferry, and by Arrhenius.
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
