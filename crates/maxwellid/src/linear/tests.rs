//! Comparison of the linear competitors with the laws of `rodwave` and with finite differences;
//! claims compare them with d'Alembert's solution and three other solvers.

use num_complex::Complex64;
use std::f64::consts::TAU;

use super::{ConstantQ, FreeParameter, LinearLaw, LinearModel, MaxwellBranches, ScaledModulus};
use crate::laplace_line::LaplaceLine;
use crate::model::{DrivenRod, RodModel};
use rodwave::band_limited::{SampledHistory, VelocityHistory};
use rodwave::modulus::{self, GeneralisedMaxwell, LaplaceModulus, MaxwellBranch, Zener};

const RATE: f64 = 51_200.0;
const SAMPLES: usize = 160;
const WANTED: usize = SAMPLES - SampledHistory::HALF_WIDTH;
const DENSITY: f64 = 912.0;
const LENGTH: f64 = 0.394;

/// Samples of an excitation: a pulse of 8 m/s with frequencies up to 12 kHz, then a slow motion of
/// 1.5 m/s that lasts until the end of the record.
fn samples() -> Vec<f64> {
    (0..SAMPLES)
        .map(|k| {
            let t = k as f64 - 30.0;
            8.0 * (-(t / 3.5).powi(2)).exp() + 1.5 / (1.0 + (-(t - 40.0) / 6.0).exp())
        })
        .collect()
}

fn excitation() -> SampledHistory {
    SampledHistory::new(&samples(), RATE).unwrap()
}

/// v_r and its derivatives at the samples.
fn response(
    model: &dyn RodModel,
    history: &SampledHistory,
    parameters: &[f64],
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let samples = samples();
    let times = times();
    let rod = DrivenRod {
        length: LENGTH,
        density: DENSITY,
        sampling_rate_hz: RATE,
        samples: &samples,
        excitation: history,
        times: &times,
        cell: 4e-3,
        temperature: None,
        lateral_inertia: 0.0,
    };
    let linearised = model.linearised_response(&rod, parameters).unwrap();
    let plain = model.response(&rod, parameters).unwrap();
    assert!(largest_difference(&plain, &linearised.velocity) < 1e-12);
    (plain, linearised.by_parameter)
}

fn times() -> Vec<f64> {
    (0..WANTED).map(|k| k as f64 / RATE).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |top, (a, b)| f64::max(top, (a - b).abs()))
}

fn shape(law: &impl LinearLaw, s: Complex64, parameters: &[f64]) -> Complex64 {
    law.shape(s, parameters).unwrap()
}

#[test]
fn laws_are_those_of_rodwave_off_the_axis_too() {
    for s in [
        Complex64::new(3e3, 0.0),
        Complex64::new(3e3, 2e4),
        Complex64::new(2e3, -3e5),
    ] {
        let constant_q = modulus::ConstantQ::new(2.6e9, 0.07, TAU * 4e3).unwrap();
        let zener = Zener::new(2.0e9, 2.5e9, 1e-4).unwrap();
        let prony = GeneralisedMaxwell::new(
            0.0,
            vec![
                MaxwellBranch {
                    modulus: 2e9,
                    relaxation_time: 4e-3,
                },
                MaxwellBranch {
                    modulus: 0.5e9,
                    relaxation_time: 4e-5,
                },
            ],
        )
        .unwrap();
        let pairs = [
            (
                2.6e9 * shape(&ConstantQ::default(), s, &[0.07_f64.ln()]),
                constant_q.at_s(s),
            ),
            (
                2.5e9
                    * shape(
                        &MaxwellBranches::zener(),
                        s,
                        &[0.25_f64.ln(), 1e-4_f64.ln()],
                    ),
                zener.at_s(s),
            ),
            (
                2.5e9
                    * shape(
                        &MaxwellBranches::two(),
                        s,
                        &[0.25_f64.ln(), 4e-3_f64.ln(), 4e-5_f64.ln()],
                    ),
                prony.at_s(s),
            ),
        ];
        for (found, expected) in pairs {
            assert!(
                (found / expected - 1.0).norm() < 1e-12,
                "{s} {found} {expected}"
            );
        }
    }
}

/// Compares the derivatives with fourth-order differences of the response over h = 1e-3, whose
/// error is about 1e-12 of the fifth derivative.
fn derivatives_are_those_of_differences(law: impl LinearLaw, of_law: &[f64]) {
    let history = excitation();
    let model = LinearModel::new(law);
    let parameters: Vec<f64> = std::iter::once(2.6e9_f64.ln())
        .chain(of_law.iter().copied())
        .collect();
    let (_, columns) = response(&model, &history, &parameters);
    for (index, column) in columns.iter().enumerate() {
        let at = |step: f64| {
            let mut moved = parameters.clone();
            moved[index] += step;
            response(&model, &history, &moved).0
        };
        let h = 1e-3;
        let (a, b, c, d) = (at(h), at(-h), at(2.0 * h), at(-2.0 * h));
        let difference: Vec<f64> = (0..WANTED)
            .map(|k| (8.0 * (a[k] - b[k]) - (c[k] - d[k])) / (12.0 * h))
            .collect();
        let scale = column.iter().fold(0.0_f64, |top, v| top.max(v.abs()));
        assert!(scale > 1e-3, "{} {index} has no effect", model.law().name());
        let error = largest_difference(column, &difference);
        // tolerance: ln E shifts the arrival, so that its fifth derivative is (ωL/2c)^5 = 1e6 times
        // the response
        let tolerance = if index == 0 { 1e-4 } else { 1e-7 };
        assert!(
            error < tolerance * scale,
            "{} {index}: {error} of {scale}",
            model.law().name()
        );
    }
}

#[test]
fn a_law_of_rodwave_is_a_competitor_as_it_is() {
    let zener = Zener::new(2.0e9, 2.5e9, 3e-5).unwrap();
    let ranges = [
        FreeParameter {
            index: 1,
            name: "ln_modulus_increment",
            range: (0.02e9_f64.ln(), 2e9_f64.ln()),
        },
        FreeParameter {
            index: 2,
            name: "ln_relaxation_time",
            range: (1e-6_f64.ln(), 1e-2_f64.ln()),
        },
    ];
    let scaled = ScaledModulus::new("Zener of rodwave", zener, TAU * 4e3, &ranges).unwrap();
    let history = excitation();
    let magnitude = modulus::ComplexModulus::at(&zener, TAU * 4e3).norm();
    let found = response(
        &LinearModel::new(scaled.clone()),
        &history,
        &[magnitude.ln(), 0.5e9_f64.ln(), 3e-5_f64.ln()],
    )
    .0;
    let expected = response(
        &LinearModel::new(MaxwellBranches::zener()),
        &history,
        &[2.5e9_f64.ln(), 0.25_f64.ln(), 3e-5_f64.ln()],
    )
    .0;
    assert!(largest_difference(&found, &expected) < 1e-10);
    derivatives_are_those_of_differences(scaled, &[0.5e9_f64.ln(), 3e-5_f64.ln()]);
    assert!(
        ScaledModulus::new(
            "none",
            zener,
            TAU * 4e3,
            &[FreeParameter {
                index: 3,
                name: "?",
                range: (0.0, 1.0)
            }]
        )
        .is_err()
    );
    assert!(
        ScaledModulus::new(
            "none",
            zener,
            TAU * 4e3,
            &[FreeParameter {
                index: 2,
                name: "?",
                range: (1.0, 0.0)
            }]
        )
        .is_err()
    );
    assert!(ScaledModulus::new("none", zener, 0.0, &[]).is_err());
}

/// Checks that the wrap-around from the next period is small: with a longer period the response is
/// the same.
#[test]
fn wrap_around_is_below_its_level() {
    let history = excitation();
    let nearly_elastic = [2.6e9_f64.ln(), 30.0];
    let short = response(
        &LinearModel::new(MaxwellBranches::maxwell()),
        &history,
        &nearly_elastic,
    )
    .0;
    // the response does not decay, so that a wrap-around would be visible; the excitation ends at
    // the same time as with the short period
    let mut long = LaplaceLine::new(8 * SAMPLES, 2.0 * RATE);
    let at = |n: usize| history.at(n as f64 / (2.0 * RATE));
    let mut lines = long.transform(2 * SAMPLES - 1, at);
    for (value, s) in lines.iter_mut().zip(long.arguments()) {
        let z = s * LENGTH * (DENSITY / 2.6e9).sqrt();
        *value /= z.cosh();
    }
    let fine = long.history(&lines, 2 * WANTED);
    let expected: Vec<f64> = fine.iter().step_by(2).copied().collect();
    let difference = largest_difference(&short, &expected);
    // tolerance: ten times the wrap-around of one period, 1.1e-7 of 16 m/s
    assert!(difference < 2e-5, "{difference}");
}

#[test]
fn times_between_samples_are_answered_either_way() {
    let history = excitation();
    let samples = samples();
    let model = LinearModel::new(ConstantQ::default());
    let parameters = [2.6e9_f64.ln(), 0.07_f64.ln()];
    let delay = 0.37 / RATE;
    let at = |times: &[f64]| {
        let rod = DrivenRod {
            length: LENGTH,
            density: DENSITY,
            sampling_rate_hz: RATE,
            samples: &samples,
            excitation: &history,
            times,
            cell: 4e-3,
            temperature: None,
            lateral_inertia: 0.0,
        };
        model.response(&rod, &parameters)
    };
    let shifted: Vec<f64> = times().iter().map(|t| t + delay).collect();
    let mut uneven = shifted.clone();
    uneven.remove(0);
    uneven.insert(0, 0.1 / RATE);
    let (by_shift, by_interpolation) = (at(&shifted).unwrap(), at(&uneven).unwrap());
    let difference = largest_difference(&by_shift[1..], &by_interpolation[1..]);
    // tolerance: error of the interpolation between points at twice the sampling rate
    assert!(difference < 1e-4, "{difference}");
    // times earlier by three samples less a fraction of a sample; the first three are set to 0,
    // when the rod is at rest
    let late: Vec<f64> = times()
        .iter()
        .map(|t| (t - 3.0 / RATE + delay).max(0.0))
        .collect();
    let late = at(&late).unwrap();
    assert_eq!(late[..3], [0.0; 3]);
    // tolerance: rounding, because both are computed from the same lines with the same advance
    let difference = largest_difference(&late[3..], &by_shift[..by_shift.len() - 3]);
    assert!(difference < 1e-12, "{difference}");
    assert!(at(&[1.0]).is_none());
    assert!(at(&[-1e-6]).is_none());
}

/// Checks that `shape_with_derivatives` returns `None` unless there is one derivative per
/// parameter.
#[test]
fn derivatives_of_another_number_are_none() {
    let s = Complex64::new(2e3, 1e4);
    let zener = Zener::new(2.0e9, 2.5e9, 1e-4).unwrap();
    let name = "ln_relaxation_time";
    let range = (-12.0, -4.0);
    let scaled = ScaledModulus::new(
        "Zener",
        zener,
        1e4,
        &[FreeParameter {
            index: 2,
            name,
            range,
        }],
    );
    let laws: [(Box<dyn LinearLaw>, usize); 2] = [
        (Box::new(MaxwellBranches::two()), 3),
        (Box::new(scaled.unwrap()), 1),
    ];
    for (law, count) in laws {
        let parameters = law.start();
        assert_eq!(parameters.len(), count);
        let derived = |number: usize| {
            let mut derivatives = vec![Complex64::ZERO; number];
            law.shape_with_derivatives(s, &parameters, &mut derivatives)
        };
        assert!(derived(count).is_some());
        assert!(derived(count + 1).is_none() && derived(count + 9).is_none());
    }
}

/// Checks that a rod has no response if its sampling rate is not that of its excitation.
#[test]
fn a_rod_that_contradicts_itself_has_no_response() {
    let (samples, excitation) = (samples(), excitation());
    let times = [1e-3];
    let at_rate = |sampling_rate_hz: f64| {
        let rod = DrivenRod {
            length: LENGTH,
            density: DENSITY,
            sampling_rate_hz,
            samples: &samples,
            excitation: &excitation,
            times: &times,
            cell: 4e-3,
            temperature: None,
            lateral_inertia: 0.0,
        };
        let model = LinearModel::new(ConstantQ::default());
        model.response(&rod, &[2.6e9_f64.ln(), 0.05_f64.ln()])
    };
    assert!(at_rate(RATE).is_some());
    for rate in [1e300, 0.0, f64::NAN] {
        assert!(at_rate(rate).is_none(), "{rate}");
    }
}
