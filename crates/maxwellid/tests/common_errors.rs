//! Tests of common errors of rods and transducers: coverage of the intervals, errors that tests
//! share, and transducers with errors above the stated ones.

use std::f64::consts::TAU;

use maxwellid::common_error::{CommonErrorEstimate, with_unstated_transducers};
use maxwellid::linear::{ConstantQ, LinearModel};
use maxwellid::selection::{Candidate, Decision, Selection};
use maxwellid::{
    CommonError, ErrorOf, Fit, FitFlag, Freedom, Identification, Law, MaxwellidError, Noise,
    Nuisances, Provenance, RodTest, RodTestData,
};
use num_complex::Complex64;
use rodwave::band_limited::{SampledHistory, VelocityHistory};
use rodwave::inelastic::Maxwell;
use testbed::noise::Noise as Draws;

use crate::virtual_rod::{DENSITY, RATE, V0, VirtualRod, add_noise, struck, times};

const MODULUS: f64 = 3e9;
const VISCOSITY: f64 = 4e6;
const NOISE: f64 = 0.05;

fn rod(length: f64, velocity: f64) -> VirtualRod {
    let law = Maxwell::new(VISCOSITY).unwrap();
    struck(length, velocity, MODULUS, &law, 100)
}

/// The records of `rod` with a stated length of `1 + length` times the true one, and with a
/// response that is multiplied by `gain` and delayed by `delay` \[s\].
fn recorded(rod: &VirtualRod, length: f64, (gain, delay): (f64, f64), seed: u64) -> RodTestData {
    let mut data = rod.data.clone();
    let history = SampledHistory::new(&data.response, RATE).unwrap();
    let late = times(data.response.len()).into_iter();
    data.response = late
        .map(|t| gain * history.at((t - delay).max(0.0)))
        .collect();
    data.length *= 1.0 + length;
    let deviation = NOISE * data.impact_velocity / V0;
    add_noise(&mut data, deviation, seed);
    data
}

fn test(data: RodTestData, errors: &[(ErrorOf, &str, f64)]) -> RodTest {
    let noise = NOISE * data.impact_velocity / V0;
    let errors = errors.iter().map(|(of, shared_by, error)| CommonError {
        of: *of,
        shared_by: (*shared_by).to_owned(),
        standard_uncertainty: *error,
    });
    let test = RodTest::new(data)
        .unwrap()
        .with_noise(noise, noise)
        .unwrap();
    test.with_common_errors(errors).unwrap()
}

fn fitted(tests: &[RodTest]) -> Identification<Maxwell> {
    Fit::of(Maxwell::new(1e6).unwrap()).to(tests).unwrap()
}

/// Errors of E and eta divided by their standard errors.
fn scores(found: &Identification<Maxwell>) -> [f64; 2] {
    let estimates = found.identifiability(Noise::Stated).unwrap().estimates;
    let of = |symbol: &str, truth: f64| {
        let mut all = estimates.iter();
        let found = all.find(|estimate| estimate.symbol == symbol).unwrap();
        (found.value / truth).ln() / found.standard_error
    };
    [of("E", MODULUS), of("eta", VISCOSITY)]
}

/// Checks that the mean square of error over standard error is about 1 for three rods, each with
/// its own error of length, and one pair of transducers for all. Tolerance: the mean square of 2 x
/// 24 scores has a standard deviation of 0.2. Without the stated errors the mean square is some
/// hundred.
#[test]
fn intervals_cover_errors_of_lengths_and_transducers() {
    let rods = [0.2, 0.3, 0.4].map(|length| rod(length, V0));
    let (length, gain, delay) = (1.5e-3, 0.01, 3e-6);
    let errors = ["A", "B", "C"].map(|name| {
        [
            (ErrorOf::Length, name, length),
            (ErrorOf::ResponseGain, "free end", gain),
            (ErrorOf::Delay, "both", delay),
        ]
    });
    let seeds = 24;
    let (mut with, mut without) = (0.0, 0.0);
    for seed in 0..seeds {
        let mut random = Draws::seeded(1000 + seed);
        let mut draw = || random.normal();
        let transducers = (1.0 + gain * draw(), delay * draw());
        let records: Vec<RodTestData> = rods
            .iter()
            .zip(0..)
            .map(|(rod, k)| recorded(rod, length * draw(), transducers, 10 * seed + k))
            .collect();
        let each = records.iter().zip(&errors);
        let stated: Vec<RodTest> = each.map(|(data, own)| test(data.clone(), own)).collect();
        let unstated: Vec<RodTest> = records.into_iter().map(|data| test(data, &[])).collect();
        let squares = |scores: [f64; 2]| scores.iter().map(|z| z * z).sum::<f64>();
        with += squares(scores(&fitted(&stated))) / (2 * seeds) as f64;
        without += squares(scores(&fitted(&unstated))) / (2 * seeds) as f64;
    }
    assert!((0.45..1.7).contains(&with), "{with}");
    assert!(without > 10.0, "{without}");
}

/// Records of a thin rod of constant Q, by the closed form 1/cosh(γL) on the line s = σ + iω. The
/// impact rises within 60 us, so that its spectrum is negligible above half of the sampling rate.
fn closed_form(length: f64) -> RodTestData {
    const PERIOD: usize = 1024;
    const SAMPLES: usize = 220;
    const SHIFT: f64 = 700.0;
    let blow = |t: f64| {
        let since = t - 1.5e-3;
        10.0 * 0.5 * statrs::function::erf::erfc(-since / 30e-6) * (-since / 400e-6).exp()
    };
    let exponent = std::f64::consts::FRAC_2_PI * f64::atan(0.02);
    let time = |k: usize| k as f64 / RATE;
    let excitation: Vec<f64> = (0..PERIOD).map(|k| blow(time(k))).collect();
    let mut response = vec![0.0; SAMPLES];
    for line in 0..PERIOD {
        let signed = if line < PERIOD / 2 {
            line as f64
        } else {
            line as f64 - PERIOD as f64
        };
        let s = Complex64::new(SHIFT, TAU * signed * RATE / PERIOD as f64);
        let damped = |(k, v): (usize, &f64)| v * (-s * time(k)).exp();
        let sent: Complex64 = excitation.iter().enumerate().map(damped).sum();
        let modulus = MODULUS * (s / (TAU * 4e3)).powf(exponent);
        let arrived = sent / (s * (DENSITY / modulus).sqrt() * length).cosh();
        for (k, sum) in response.iter_mut().enumerate() {
            *sum += (arrived * (s * time(k)).exp()).re / PERIOD as f64;
        }
    }
    RodTestData {
        name: format!("{length} m"),
        length,
        density: DENSITY,
        impact_velocity: V0,
        sampling_rate_hz: RATE,
        excitation: excitation.into_iter().take(SAMPLES).collect(),
        response,
        provenance: Provenance::Measured,
    }
}

/// Checks that the fit converges for rods whose lengths have errors far above the noise, and finds
/// the lengths relative to each other. A fit linearised about the stated lengths would alternate
/// between two minima.
#[test]
fn errors_of_lengths_far_above_the_noise_are_followed() {
    let (noise, stated) = (0.02, 2e-3);
    let errors = [1.5e-3, -2.5e-3, 2e-3, -1e-3];
    let rods = [("A", 0.2), ("B", 0.3), ("C", 0.4), ("D", 0.6)];
    let each = rods.iter().zip(errors).zip(0..);
    let tests: Vec<RodTest> = each
        .map(|(((name, length), error), seed)| {
            let mut data = closed_form(*length);
            data.length *= 1.0 + error;
            add_noise(&mut data, noise, seed);
            let test = RodTest::new(data)
                .unwrap()
                .with_noise(noise, noise)
                .unwrap();
            test.with_common_errors([CommonError {
                of: ErrorOf::Length,
                shared_by: (*name).to_owned(),
                standard_uncertainty: stated,
            }])
            .unwrap()
        })
        .collect();
    let found = Fit::of(LinearModel::new(ConstantQ::default()))
        .to(&tests)
        .unwrap();
    assert!(!found.flags().contains(&FitFlag::Unsettled));
    let values: Vec<f64> = found.common_errors().iter().map(|e| e.value).collect();
    for (pair, truth) in values.windows(2).zip(errors.windows(2)) {
        // tolerance: five times the error due to noise, about 3e-5
        let (found, truth) = (pair[0] - pair[1], truth[1] - truth[0]);
        assert!((found - truth).abs() < 1.5e-4, "{found} for {truth}");
    }
}

/// Checks that tests share the error of the length of one rod. E is proportional to the square of
/// the length: ±0.4 % in length is ±0.8 % in E for four tests of one rod, and half as much for one
/// test of each of four rods.
#[test]
fn tests_of_one_rod_share_the_error_of_its_length() {
    let rod = rod(0.3, V0);
    let error_of = |rods: [&str; 4]| {
        let tests: Vec<RodTest> = rods
            .iter()
            .zip(0..)
            .map(|(name, seed)| {
                let data = recorded(&rod, 0.0, (1.0, 0.0), seed);
                test(data, &[(ErrorOf::Length, name, 4e-3)])
            })
            .collect();
        let found = fitted(&tests).identifiability(Noise::Stated).unwrap();
        found.estimates[0].standard_error
    };
    let (one, four) = (error_of(["A"; 4]), error_of(["A", "B", "C", "D"]));
    // tolerance: the noise adds about 0.05 % to the standard errors, as squares
    assert!((one - 8e-3).abs() < 1e-4, "{one}");
    assert!((four - 4e-3).abs() < 1e-4, "{four}");
}

#[test]
fn transducers_that_err_beyond_what_is_stated_are_found() {
    let tests: Vec<RodTest> = [3.0, 27.0]
        .into_iter()
        .zip(0..)
        .map(|(velocity, seed)| test(recorded(&rod(0.4, velocity), 0.0, (1.02, 5e-6), seed), &[]))
        .collect();
    let selection = Selection::new(vec![
        Candidate::of(Law::Elastic),
        Candidate::of(Law::Maxwell),
        Candidate::of(Law::ConstantQ),
    ])
    .unwrap();
    let as_stated = selection.compare(&tests).unwrap();
    let none = matches!(as_stated.decision, Decision::NoneOfThese { .. });
    assert!(none, "{:?}", as_stated.decision);
    let allowed = with_unstated_transducers(&tests).unwrap();
    let comparison = selection.compare(&allowed).unwrap();
    assert_eq!(
        comparison.law().map(|law| law.name.as_str()),
        Some("Maxwell"),
        "{:?}",
        comparison.decision
    );
    let found = fitted(&allowed);
    let errors = found.common_errors();
    let of = |wanted: ErrorOf| -> &CommonErrorEstimate {
        let mut all = errors.iter();
        all.find(|found| found.error.of == wanted).unwrap()
    };
    let (gain, delay) = (of(ErrorOf::ResponseGain), of(ErrorOf::Delay));
    for (found, truth, largest) in [(gain, 0.02, 3e-3), (delay, 5e-6, 3e-7)] {
        assert!(
            (found.value - truth).abs() < 3.0 * found.standard_error,
            "{found:?}"
        );
        assert!(found.standard_error < largest, "{found:?}");
    }
    assert!(scores(&found).iter().all(|z| z.abs() < 3.0));
    // no error is added to tests that state errors of their transducers
    assert!(with_unstated_transducers(&allowed).is_none());
}

#[test]
fn errors_that_cannot_be_followed_are_refused() {
    let data = recorded(&rod(0.3, V0), 0.0, (1.0, 0.0), 1);
    let error = |standard_uncertainty| CommonError {
        of: ErrorOf::Length,
        shared_by: "A".into(),
        standard_uncertainty,
    };
    for value in [-1e-3, f64::NAN, f64::INFINITY] {
        let refused = RodTest::new(data.clone())
            .unwrap()
            .with_common_errors([error(value)]);
        assert!(matches!(refused, Err(MaxwellidError::Setting { .. })));
    }
    let without_noise = RodTest::new(data.clone())
        .unwrap()
        .with_common_errors([error(1e-3)])
        .unwrap();
    let fit = Fit::of(Maxwell::new(1e6).unwrap());
    let refused = fit.to(&[without_noise]).unwrap_err();
    assert!(refused.to_string().contains("stated noise"), "{refused}");
    let nuisances = Nuisances {
        response_gain: Freedom::Free,
        ..Nuisances::default()
    };
    let with_both = test(data, &[(ErrorOf::Length, "A", 1e-3)]);
    let refused = fit.with_nuisances(nuisances).to(&[with_both]).unwrap_err();
    assert!(
        refused.to_string().contains("unknown transducers"),
        "{refused}"
    );
}
