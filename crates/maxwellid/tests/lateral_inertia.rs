//! Comparison of rods of finite diameter with a Galerkin solution of Love's equation in the time
//! domain: modes in space, the law evaluated at points, and Runge-Kutta steps. This solution shares
//! neither transforms nor characteristics with the crate.

use maxwellid::linear::{LinearModel, MaxwellBranches};
use maxwellid::{
    BranchedRod, CommonError, DrivenRod, ErrorOf, Fit, Noise, Provenance, RodModel, RodTest,
    RodTestData,
};
use rodwave::band_limited::SampledHistory;
use rodwave::inelastic::{InelasticLaw, Maxwell, MaxwellNorton};

use crate::virtual_rod::{RATE, add_noise, times};

const LENGTH: f64 = 0.3;
const DENSITY: f64 = 910.0;
const MODULUS: f64 = 0.9e9;
/// Lateral inertia ν²D²/8 \[m²\] of a soft polymer, ν = 0.45, with a diameter of 12 mm.
const INERTIA: f64 = 0.45 * 0.45 * 12e-3 * 12e-3 / 8.0;
const VELOCITY: f64 = 8.0;
const SAMPLES: usize = 180;
const WANTED: usize = SAMPLES - SampledHistory::HALF_WIDTH;

/// Velocity of the excitation: a pulse whose spectrum has fallen to 1 % at 18 kHz, followed by a
/// slow motion.
fn excitation(time: f64) -> f64 {
    let samples = time * RATE - 30.0;
    let slow = 1.0 / (1.0 + (-(samples - 30.0) / 5.0).exp());
    VELOCITY * ((-(samples / 2.0).powi(2)).exp() + 0.2 * slow)
}

/// A spring with the share `spring` of the modulus, in parallel with a branch of `law`.
struct Material<'a, L> {
    spring: f64,
    law: &'a L,
}

/// Numbers of modes and of points. The shortest mode has a wavelength of 3.8 mm and nearly the
/// highest possible angular frequency, c/r.
const MODES: usize = 160;
const POINTS: usize = 400;

/// Velocity of the free end at the samples. With v = v_e + Σ aₙ sin kₙx, kₙ = (n + 1/2)π/L,
///
/// ```text
/// ρ (L/2) (1 + r²kₙ²) daₙ/dt + ρ/kₙ dv_e/dt = -kₙ ∫ σ cos kₙx dx ,    ∂σ/∂t = E (∂v/∂x - F(σ)) .
/// ```
fn integrated<L: InelasticLaw>(material: &Material<'_, L>) -> Vec<f64> {
    const STEPS_PER_SAMPLE: usize = 16;
    let share = 1.0 - material.spring;
    let numbers: Vec<f64> = (0..MODES)
        .map(|n| (n as f64 + 0.5) * std::f64::consts::PI / LENGTH)
        .collect();
    let masses: Vec<f64> = numbers
        .iter()
        .map(|k| 0.5 * LENGTH * (1.0 + INERTIA * k * k))
        .collect();
    let cosines: Vec<Vec<f64>> = (0..POINTS)
        .map(|j| (j as f64 + 0.5) * LENGTH / POINTS as f64)
        .map(|x| numbers.iter().map(|k| (k * x).cos()).collect())
        .collect();
    let amplitudes = |moved: &[f64], time: f64| -> Vec<f64> {
        let v = excitation(time);
        let each = moved.iter().zip(&numbers).zip(&masses);
        each.map(|((u, k), mass)| u - v / (k * mass)).collect()
    };
    // the state contains aₙ + v_e/(kₙmₙ) of each mode, and the stresses of spring and branch at
    // each point
    let rates = |state: &[f64], time: f64| -> Vec<f64> {
        let (moved, stresses) = state.split_at(MODES);
        let (spring, branch) = stresses.split_at(POINTS);
        let slopes: Vec<f64> = amplitudes(moved, time)
            .iter()
            .zip(&numbers)
            .map(|(a, k)| a * k)
            .collect();
        let mut forces = vec![0.0; MODES];
        let mut of_spring = Vec::with_capacity(POINTS);
        let mut of_branch = Vec::with_capacity(POINTS);
        for ((row, spring), branch) in cosines.iter().zip(spring).zip(branch) {
            let strained: f64 = row.iter().zip(&slopes).map(|(c, s)| c * s).sum();
            let flow = material.law.inelastic_strain_rate(*branch);
            of_spring.push(material.spring * MODULUS * strained);
            of_branch.push(share * MODULUS * (strained - flow));
            let weight = (spring + branch) * LENGTH / POINTS as f64 / DENSITY;
            for (force, c) in forces.iter_mut().zip(row) {
                *force += weight * c;
            }
        }
        let each = forces.iter().zip(&numbers).zip(&masses);
        each.map(|((force, k), mass)| -k * force / mass)
            .chain(of_spring)
            .chain(of_branch)
            .collect()
    };
    let plus = |state: &[f64], rate: &[f64], step: f64| -> Vec<f64> {
        let pairs = state.iter().zip(rate);
        pairs.map(|(s, r)| s + step * r).collect()
    };
    let step = 1.0 / (RATE * STEPS_PER_SAMPLE as f64);
    let mut state = vec![0.0; MODES + 2 * POINTS];
    let mut history = Vec::with_capacity(WANTED);
    for n in 0..WANTED * STEPS_PER_SAMPLE {
        let time = n as f64 * step;
        if n % STEPS_PER_SAMPLE == 0 {
            let signs = [1.0, -1.0].into_iter().cycle();
            let modes = amplitudes(&state[..MODES], time);
            let sum: f64 = modes.iter().zip(signs).map(|(a, sign)| sign * a).sum();
            history.push(excitation(time) + sum);
        }
        let first = rates(&state, time);
        let second = rates(&plus(&state, &first, 0.5 * step), time + 0.5 * step);
        let third = rates(&plus(&state, &second, 0.5 * step), time + 0.5 * step);
        let fourth = rates(&plus(&state, &third, step), time + step);
        for (index, s) in state.iter_mut().enumerate() {
            let middle = second[index] + third[index];
            *s += step / 6.0 * (first[index] + 2.0 * middle + fourth[index]);
        }
    }
    history
}

fn modelled(model: &dyn RodModel, parameters: &[f64], lateral_inertia: f64) -> Vec<f64> {
    let samples: Vec<f64> = times(SAMPLES).into_iter().map(excitation).collect();
    let rod = DrivenRod {
        length: LENGTH,
        density: DENSITY,
        sampling_rate_hz: RATE,
        samples: &samples,
        excitation: &SampledHistory::new(&samples, RATE).unwrap(),
        times: &times(WANTED),
        cell: 0.5e-3,
        temperature: None,
        lateral_inertia,
    };
    model.response(&rod, parameters).unwrap()
}

/// Root mean square of the difference, divided by [`VELOCITY`].
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / a.len() as f64).sqrt() / VELOCITY
}

fn maxwell() -> Maxwell {
    Maxwell::new(1.5e6).unwrap()
}

fn norton() -> MaxwellNorton {
    MaxwellNorton::from_reference_rate(2.0, 70.0, 10e6).unwrap()
}

/// Compares linear rods. Lateral inertia changes the response by more than 1 % of the velocity;
/// tolerance: the errors of the modes and of the interpolation between samples are 0.03 %.
#[test]
fn linear_rods_are_those_of_loves_equation() {
    let thick = integrated(&Material {
        spring: 0.0,
        law: &maxwell(),
    });
    let law = LinearModel::new(MaxwellBranches::maxwell());
    let branch = [MODULUS.ln(), (1.5e6 / MODULUS).ln()];
    let of_branch = modelled(&law, &branch, INERTIA);
    let inelastic = RodModel::parameters(&maxwell(), MODULUS);
    let of_inelastic = modelled(&maxwell(), &inelastic, INERTIA);
    let thin = modelled(&law, &branch, 0.0);
    assert!(apart(&thin, &thick) > 0.01, "{}", apart(&thin, &thick));
    for found in [of_branch, of_inelastic] {
        assert!(apart(&found, &thick) < 5e-4, "{}", apart(&found, &thick));
    }
}

/// Compares nonlinear rods. With cells of 0.5 mm, a hundredth of the shortest wavelength, the error
/// is less than 3 % of the effect of lateral inertia.
#[test]
fn nonlinear_rods_are_those_of_loves_equation() {
    let single = RodModel::parameters(&norton(), MODULUS);
    let solid = BranchedRod::standard_solid(norton(), "solid");
    // half of the modulus in the spring, half in the branch
    let branched = [&[MODULUS.ln(), 0.0], &single[1..]].concat();
    let cases: [(&dyn RodModel, &[f64], f64); 2] =
        [(&norton(), &single, 0.0), (&solid, &branched, 0.5)];
    for (model, parameters, spring) in cases {
        let law = norton();
        let thick = integrated(&Material { spring, law: &law });
        let effect = apart(&modelled(model, parameters, 0.0), &thick);
        let left = apart(&modelled(model, parameters, INERTIA), &thick);
        assert!(effect > 0.01 && left < 0.03 * effect, "{effect} {left}");
    }
}

/// True over stated lateral inertia minus 1, for a stated Poisson's ratio that is 8 % too large.
const TOO_LARGE: f64 = 1.0 / (1.08 * 1.08) - 1.0;

/// Checks that the fit to records of a thick rod is right within its errors if the stated Poisson's
/// ratio is 8 % too large and has an uncertainty of 5 %, and that E of a fit with a thin rod is off
/// by more than five standard errors.
#[test]
fn a_fit_allows_for_lateral_inertia_and_its_error() {
    let law = norton();
    let response = integrated(&Material {
        spring: 0.0,
        law: &law,
    });
    let noise = 0.003 * VELOCITY;
    let fitted = |inertia: f64, error: f64, seed: u64| {
        let mut data = RodTestData {
            name: "thick".into(),
            length: LENGTH,
            density: DENSITY,
            impact_velocity: VELOCITY,
            sampling_rate_hz: RATE,
            excitation: times(WANTED).into_iter().map(excitation).collect(),
            response: response.clone(),
            provenance: Provenance::Measured,
        };
        add_noise(&mut data, noise, seed);
        let test = RodTest::new(data)
            .and_then(|test| test.with_noise(noise, noise))
            .and_then(|test| test.with_lateral_inertia(inertia))
            .and_then(|test| {
                test.with_common_errors([CommonError {
                    of: ErrorOf::LateralInertia,
                    shared_by: "the rod".into(),
                    standard_uncertainty: error,
                }])
            })
            .unwrap();
        let found = Fit::of(law).to(&[test]).unwrap();
        let estimates = found.identifiability(Noise::Stated).unwrap().estimates;
        let modulus = &estimates[0];
        let inertia = found.common_errors().first();
        let of_inertia = inertia.map(|e| (e.value - TOO_LARGE) / e.standard_error);
        (
            (modulus.value / MODULUS).ln() / modulus.standard_error,
            of_inertia.unwrap_or(f64::NAN),
        )
    };
    let mut squares = 0.0;
    for seed in 0..6 {
        let (score, inertia) = fitted(1.08 * 1.08 * INERTIA, 0.1, seed);
        squares += score * score;
        assert!(inertia.abs() < 3.0, "{inertia}");
    }
    // tolerance: chi-square with 6 degrees of freedom exceeds 18.5 with a probability of 0.5 %
    assert!(squares < 18.5, "{squares}");
    let (score, _) = fitted(0.0, 0.0, 0);
    assert!(score.abs() > 5.0, "{score}");
}
