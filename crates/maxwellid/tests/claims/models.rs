//! Claims on models of the driven rod: derivatives compared with differences, and solvers with each
//! other and with d'Alembert's solution.

use maxwellid::linear::{ConstantQ, LinearModel, MaxwellBranches};
use maxwellid::{DrivenRod, IdentifiableLaw, RodModel};
use rodwave::InelasticRod;
use rodwave::band_limited::{SampledHistory, VelocityHistory};
use rodwave::inelastic::{Elastic, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use rodwave::line::{Body, Drive, End, Line, Segment};
use rodwave::lumped::LumpedRod;
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};

use crate::virtual_rod::{RATE, times};
use testbed::claim::{Claims, Ours, Within, missing};
use testbed::difference::largest;
use testbed::hold;

const SAMPLES: usize = 160;
const DENSITY: f64 = 912.0;
const LENGTH: f64 = 0.394;
/// Peak of the pulse, in m/s.
const PEAK: f64 = 8.0;

#[test]
fn claims_hold() {
    let mut claims = Claims::default();
    let claims = &mut claims;
    derivatives(claims);
    solvers(claims);
    hold!(claims);
}

/// Samples of an excitation: a pulse with frequencies up to 12 kHz, then a slow motion of 1.5 m/s
/// that lasts until the end of the record.
fn samples() -> Vec<f64> {
    (0..SAMPLES)
        .map(|k| {
            let t = k as f64 - 30.0;
            PEAK * (-(t / 3.5).powi(2)).exp() + 1.5 / (1.0 + (-(t - 40.0) / 6.0).exp())
        })
        .collect()
}

/// Calls `with` for the driven rod, with cells of length `cell` \[m\].
fn driven<T>(cell: f64, with: impl FnOnce(&DrivenRod<'_>) -> Ours<T>) -> Ours<T> {
    let samples = samples();
    let excitation = SampledHistory::new(&samples, RATE)?;
    let times = times(SAMPLES - SampledHistory::HALF_WIDTH);
    with(&DrivenRod {
        length: LENGTH,
        density: DENSITY,
        sampling_rate_hz: RATE,
        samples: &samples,
        excitation: &excitation,
        times: &times,
        cell,
        temperature: None,
        lateral_inertia: 0.0,
    })
}

fn response(model: &dyn RodModel, rod: &DrivenRod<'_>, parameters: &[f64]) -> Ours<Vec<f64>> {
    model
        .response(rod, parameters)
        .ok_or_else(|| missing("the response"))
}

/// A model and its parameters.
type Model = (Box<dyn RodModel>, Vec<f64>);

fn of_law<L: IdentifiableLaw + 'static>(law: L) -> Model {
    let at = RodModel::parameters(&law, 2.6e9);
    (Box::new(law), at)
}

fn maxwell() -> Ours<Model> {
    Ok(of_law(Maxwell::new(4e6)?))
}

fn norton() -> Ours<Model> {
    Ok(of_law(MaxwellNorton::new(2.108, 7e13)?))
}

fn gurevich_rabinovich() -> Ours<Model> {
    Ok(of_law(MaxwellGurevichRabinovich::new(3.5e6, 7.08e6)?))
}

fn constant_q() -> Ours<Model> {
    let law = LinearModel::new(ConstantQ::default());
    Ok((Box::new(law), vec![2.6e9_f64.ln(), 0.07_f64.ln()]))
}

fn two_branches() -> Ours<Model> {
    let law = LinearModel::new(MaxwellBranches::two());
    let at = vec![2.6e9_f64.ln(), 0.2_f64.ln(), 5e-3_f64.ln(), 1e-4_f64.ln()];
    Ok((Box::new(law), at))
}

fn derivatives(claims: &mut Claims) {
    claims.by("central differences of the response");
    let within = Within(1e-4, "second order of steps of 1e-4, and of the grid in E");
    let laws = [
        ("Maxwell", maxwell()),
        ("Norton", norton()),
        ("Gurevich-Rabinovich", gurevich_rabinovich()),
        ("constant loss factor", constant_q()),
        ("two Maxwell branches", two_branches()),
    ];
    for (name, law) in laws {
        let worst = || -> Ours {
            let (model, at) = law.as_ref().map_err(Clone::clone)?;
            driven(4e-3, |rod| {
                let stated = model
                    .linearised_response(rod, at)
                    .ok_or_else(|| missing("the derivatives"))?;
                let mut worst = 0.0_f64;
                for (index, column) in stated.by_parameter.iter().enumerate() {
                    let moved = |by: f64| {
                        let mut at = at.clone();
                        at[index] += by;
                        response(model.as_ref(), rod, &at)
                    };
                    let step = 1e-4;
                    let (plus, minus) = (moved(step)?, moved(-step)?);
                    let size = largest(column.iter().map(|d| d.abs()));
                    let pairs = plus.iter().zip(&minus).zip(column);
                    worst = worst.max(largest(pairs.map(|((plus, minus), stated)| {
                        ((plus - minus) / (2.0 * step) - stated).abs() / size
                    })));
                }
                Ok(worst)
            })
        };
        claims.deviation(
            format!("{name}: derivatives of the free end's velocity by all parameters"),
            within,
            worst(),
        );
    }
}

fn solvers(claims: &mut Claims) {
    let (modulus, time) = (2.6e9_f64, 1e-3_f64);
    let between =
        |a: &[f64], b: &[f64]| largest(a.iter().zip(b).map(|(a, b)| (a - b).abs() / PEAK));
    let maxwell = |rod: &DrivenRod<'_>| -> Ours<Vec<f64>> {
        let law = LinearModel::new(MaxwellBranches::maxwell());
        response(&law, rod, &[modulus.ln(), time.ln()])
    };
    claims.by("d'Alembert: the excitation doubled, after odd transits, with alternating signs");
    let elastic = |rod: &DrivenRod<'_>| -> Vec<f64> {
        let transit = LENGTH / (modulus / DENSITY).sqrt();
        let echoes = |t: &f64| {
            (0..20)
                .map(|n| {
                    let sign = if n % 2 == 0 { 2.0 } else { -2.0 };
                    sign * rod.excitation.at(t - f64::from(2 * n + 1) * transit)
                })
                .sum()
        };
        rod.times.iter().map(echoes).collect()
    };
    claims.deviation(
        "elastic rod by characteristics",
        Within(
            1e-5,
            "quintic interpolation between steps of 2.4 us, up to 25 kHz",
        ),
        driven(4e-3, |rod| {
            let found = response(&Elastic, rod, &[modulus.ln()])?;
            Ok(between(&found, &elastic(rod)))
        }),
    );
    claims.deviation(
        "rod without relaxation by the Laplace domain",
        Within(
            4e-5,
            "twice the stated error of the interpolation between samples, 2e-5",
        ),
        driven(4e-3, |rod| {
            let law = LinearModel::new(MaxwellBranches::maxwell());
            let found = response(&law, rod, &[modulus.ln(), 30.0])?;
            Ok(between(&found, &elastic(rod)))
        }),
    );
    claims.by("Maxwell rod by characteristics, in the Laplace domain and by the lumped chain");
    claims.deviation(
        "Maxwell rod: characteristics on cells of 0.5 mm against the Laplace domain",
        Within(
            4e-5,
            "twice the stated error of the interpolation between samples, 2e-5",
        ),
        driven(5e-4, |rod| {
            let law = Maxwell::new(modulus * time)?;
            let found = response(&law, rod, &RodModel::parameters(&law, modulus))?;
            Ok(between(&found, &maxwell(rod)?))
        }),
    );
    claims.deviation(
        "Maxwell rod: lumped chain, two grids extrapolated, against the Laplace domain",
        Within(
            2e-4,
            "the fourth-order error of cells of 1 mm, and the interpolation",
        ),
        driven(4e-3, |rod| {
            let lumped =
                InelasticRod::new(LENGTH, DENSITY, modulus, Maxwell::new(modulus * time)?)?;
            let chain = |cells| -> Ours<Vec<f64>> {
                Ok(LumpedRod::new(&lumped, cells, 0.5)?
                    .free_end_velocity(rod.excitation, rod.times)?)
            };
            let (coarse, fine) = (chain(400)?, chain(800)?);
            let pairs = coarse.iter().zip(&fine);
            let extrapolated: Vec<f64> = pairs.map(|(c, f)| f + (f - c) / 3.0).collect();
            Ok(between(&extrapolated, &maxwell(rod)?))
        }),
    );
    claims.by("branches in parallel marched by rodwave::line");
    claims.deviation(
        "three Maxwell branches in the Laplace domain",
        Within(
            8e-5,
            "the interpolation between samples, and the step of 0.5 us",
        ),
        driven(4e-3, |rod| {
            let branches = [(2.2e9, 5e-3), (0.3e9, 2e-4), (0.2e9, 2e-5)];
            let branch = |(modulus, relaxation_time)| MaxwellBranch {
                modulus,
                relaxation_time,
            };
            let material = GeneralisedMaxwell::new(0.0, branches.map(branch).to_vec())?;
            let segment = Segment::prony(LENGTH, 1e-4, DENSITY, &material)?;
            let line = Line::new([Body::new([segment])?])?
                .with_left_end(End::Velocity(Drive::history(rod.excitation.clone())))?;
            let run = line.run(5e-7, (SAMPLES - 2) as f64 / RATE, &[])?;
            // the velocities of the ends are known at dt/2, 3 dt/2, ...
            let dt = run.grid.time_step;
            let end = SampledHistory::new(&run.ends[1].velocity, 1.0 / dt)?;
            let marched: Vec<f64> = rod.times.iter().map(|t| end.at(t - 0.5 * dt)).collect();
            let law = LinearModel::new(MaxwellBranches::three());
            let at = [
                2.7e9_f64.ln(),
                (0.3_f64 / 2.2).ln(),
                (0.2_f64 / 2.2).ln(),
                5e-3_f64.ln(),
                2e-4_f64.ln(),
                2e-5_f64.ln(),
            ];
            Ok(between(&response(&law, rod, &at)?, &marched))
        }),
    );
}
