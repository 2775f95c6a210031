//! Moduli over time. The records are computed from the closed forms of relaxation and creep; the
//! responses to ramps are means of these by Simpson's rule. Nothing in this module inverts a
//! transform.

use std::f64::consts::TAU;

use cmod::CmodError;
use cmod::rheology::{
    FitOptions, Law, MasterCurve, ModulusData, PronyFit, RheologicalFit, TemperatureSweep,
    TransientPoint, TransientTest,
};
use rodwave::modulus::{
    ComplexModulus, FractionalMaxwell, FractionalZener, KelvinVoigt, SpringPot, TimeDomainModulus,
    Zener,
};
use testbed::noise::{Noise, draws};

use super::measured::{logarithmic, series, with_noise};

/// Returns E(t), or 1/J(t), for a load that increases for `ramp` seconds.
fn modulus(law: &dyn TimeDomainModulus, test: TransientTest, ramp: f64, time: f64) -> f64 {
    let at = |time: f64| match test {
        TransientTest::Relaxation => law.relaxation_modulus(time).unwrap(),
        TransientTest::Creep => law.creep_compliance(time).unwrap(),
    };
    let response = if ramp > 0.0 {
        // the variable is the square root of the time since the start of the ramp, so that points
        // are closer where E(t) is steep
        let (first, last) = ((time - ramp).sqrt(), time.sqrt());
        let h = (last - first) / 400.0;
        let value = |k: i32| {
            let u = first + h * f64::from(k);
            2.0 * u * at(u * u)
        };
        let sum: f64 = (0..200)
            .map(|k| value(2 * k) + 4.0 * value(2 * k + 1) + value(2 * k + 2))
            .sum();
        sum * h / 3.0 / ramp
    } else {
        at(time)
    };
    match test {
        TransientTest::Relaxation => response,
        TransientTest::Creep => response.recip(),
    }
}

fn over_time(
    law: &dyn TimeDomainModulus,
    test: TransientTest,
    ramp: f64,
    times: &[f64],
    (noise, seed): (f64, u64),
) -> ModulusData {
    let mut random = Noise::seeded(seed);
    let points: Vec<TransientPoint> = times
        .iter()
        .map(|&time| {
            let exact = modulus(law, test, ramp, time);
            TransientPoint {
                time,
                modulus: exact * (1.0 + noise * random.normal()),
                standard_error: noise * exact,
            }
        })
        .collect();
    ModulusData::over_time(test, ramp, &points).unwrap()
}

const TESTS: [(TransientTest, f64); 4] = [
    (TransientTest::Relaxation, 0.0),
    (TransientTest::Relaxation, 0.4),
    (TransientTest::Creep, 0.0),
    (TransientTest::Creep, 0.4),
];

/// Without noise the true parameters are found, for laws that extend over two decades of modulus.
#[test]
fn laws_are_found_from_relaxation_and_creep() {
    let zener = Zener::new(0.02e9, 2e9, 3.0).unwrap();
    let fractional = FractionalZener::new(0.05e9, 2e9, 3.0, 0.55).unwrap();
    let fluid = FractionalMaxwell::new(2e9, 20.0, 0.7).unwrap();
    let pot = SpringPot::new(1e9, 0.2, TAU).unwrap();
    let voigt = KelvinVoigt::new(0.5e9, 20e9).unwrap();
    let laws: [(Law, &dyn TimeDomainModulus); 5] = [
        (Law::Zener, &zener),
        (Law::FractionalZener, &fractional),
        (Law::FractionalMaxwell, &fluid),
        (Law::SpringPot, &pot),
        (Law::KelvinVoigt, &voigt),
    ];
    let times = logarithmic(0.5, 2000.0, 50);
    for (kind, law) in laws {
        for (test, ramp) in TESTS {
            if kind == Law::KelvinVoigt && test == TransientTest::Relaxation {
                continue;
            }
            let data = over_time(law, test, ramp, &times, (1e-4, 1));
            let fit = RheologicalFit::new(&data, kind, &FitOptions::default()).unwrap();
            assert!(fit.p_value() > 1e-4, "{kind} {test:?} {ramp}: {fit}");
            // with noise of 1e-4, in a band that contains the relaxation, the errors are as stated
            for omega in logarithmic(1e-3, 1.0, 7) {
                let error = fit.law.modulus(omega) / law.at(omega) - 1.0;
                assert!(
                    error.norm() < 2e-3,
                    "{kind} {test:?} {ramp}: {error} at {omega}"
                );
            }
            // over time, for a step: the closed form within the errors of the parameters
            for time in [2.0, 300.0] {
                let predicted = fit.prediction_over_time(test, time).unwrap();
                let error = predicted.modulus.re / modulus(law, test, 0.0, time) - 1.0;
                assert!(
                    error.abs() < 5e-4,
                    "{kind} {test:?} {ramp}: {error} at {time}"
                );
                assert!(predicted.covariance[0][0].sqrt() < 5e-4 * predicted.modulus.re);
            }
            // the lines reported by the fit are the measured lines
            let left = fit.law.response(&data).into_iter().zip(data.modulus());
            let worst = left.map(|(law, own)| (law / own - 1.0).norm());
            assert!(worst.fold(0.0, f64::max) < 5e-4, "{kind} {test:?} {ramp}");
        }
    }
}

/// A rubber of three branches over four decades of time: the order is chosen from the data, and the
/// predicted modulus over frequency has the nominal coverage.
#[test]
fn series_from_relaxation_and_creep_cover() {
    let branches = [(0.6e6, 0.3), (0.5e6, 7.0), (0.4e6, 150.0)];
    let law = series(1.2e6, &branches);
    let options = FitOptions::default().with_profiles(false);
    let times = logarithmic(0.5, 3000.0, 70);
    let seeds = draws(20);
    for (test, ramp) in TESTS {
        let (mut inside, mut checked, mut chi) = ([0.0; 2], 0.0, 0.0);
        for seed in 0..seeds {
            let data = over_time(&law, test, ramp, &times, (0.005, seed));
            let fit = PronyFit::new(&data, &options).unwrap().fit;
            chi += fit.chi_squared / fit.degrees_of_freedom as f64 / seeds as f64;
            for omega in logarithmic(2e-3, 1.0, 6) {
                let predicted = fit.prediction(omega).unwrap();
                let error = predicted.modulus - law.at(omega);
                let [[storage, _], [_, loss]] = predicted.covariance;
                checked += 1.0;
                inside[0] += f64::from(u8::from(error.re.abs() < 1.96 * storage.sqrt()));
                inside[1] += f64::from(u8::from(error.im.abs() < 1.96 * loss.sqrt()));
            }
        }
        let share = inside.map(|inside| inside / checked);
        println!(
            "{test:?}, ramp {ramp} s: E' {:.3}, E'' {:.3}, chi {chi:.3}",
            share[0], share[1]
        );
        // tolerance: three standard errors for 20 seeds with some three independent frequencies
        // each, 0.085
        assert!(
            share.iter().all(|share| *share > 0.86),
            "{test:?} {ramp} {share:?}"
        );
        assert!((chi - 1.0).abs() < 0.15, "{test:?} {ramp} {chi}");
    }
}

/// Moduli over frequency, from 0.1 to 50 Hz, and a relaxation test from 1 to 3000 s are fitted by
/// one law, with smaller errors than from either of them alone.
#[test]
fn moduli_over_frequency_and_over_time_are_fitted_together() {
    let law = series(1.2e6, &[(0.6e6, 0.03), (0.5e6, 2.0), (0.4e6, 150.0)]);
    let dma = with_noise(&law, &logarithmic(0.1, 50.0, 30), 0.005, 1);
    let times = logarithmic(1.0, 3000.0, 40);
    let relaxation = over_time(&law, TransientTest::Relaxation, 0.3, &times, (0.005, 2));
    let both = ModulusData::together(&[dma.clone(), relaxation.clone()]).unwrap();
    assert_eq!(both.len(), 70);
    let options = FitOptions::default();
    let fit = |data: &ModulusData| PronyFit::with_order(data, 3, &options).unwrap().fit;
    let [joint, alone, slow] = [&both, &dma, &relaxation].map(fit);
    // 60 values over frequency, 40 over time, seven parameters
    assert_eq!(joint.degrees_of_freedom, 93);
    assert!(joint.p_value() > 1e-3, "{joint}");
    for (index, omega) in [(0, 1e-3), (1, 100.0)] {
        let error = |fit: &RheologicalFit| {
            let [[storage, _], _] = fit.prediction(omega).unwrap().covariance;
            storage.sqrt()
        };
        let of_one = error([&alone, &slow][index]);
        assert!(
            error(&joint) < 0.5 * of_one || of_one.is_nan(),
            "{omega}: {of_one}"
        );
        let off = joint.law.modulus(omega) - law.at(omega);
        assert!(off.re.abs() < 4.0 * error(&joint), "{omega}: {off}");
    }
}

/// Relaxation at seven temperatures, with a different ramp at each: the shifts follow WLF within
/// their errors.
#[test]
fn master_curve_of_relaxation() {
    let branches = [
        (0.3e9, 1e-3),
        (0.4e9, 0.05),
        (0.5e9, 2.0),
        (0.4e9, 50.0),
        (0.2e9, 2e3),
    ];
    let reference = series(0.1e9, &branches);
    let shift = |kelvin: f64| -23.0 * (kelvin - 313.15) / (80.0 + kelvin - 313.15);
    for test in [TransientTest::Relaxation, TransientTest::Creep] {
        let seeds = draws(6);
        let (mut square, mut number) = (0.0, 0.0);
        for seed in 0..seeds {
            let step = |k: u64| {
                let kelvin = 298.15 + 5.0 * k as f64;
                let a = shift(kelvin).exp();
                let slower = branches.map(|(modulus, time)| (modulus, a * time));
                let law = series(0.1e9, &slower);
                let times = logarithmic(0.6, 300.0, 25);
                (
                    kelvin,
                    over_time(&law, test, 0.5, &times, (0.005, 100 * seed + k)),
                )
            };
            let sweep = TemperatureSweep::new((0..7).map(step).collect()).unwrap();
            let curve = MasterCurve::new(&sweep, 3, &FitOptions::default()).unwrap();
            assert!(curve.unconnected.is_empty(), "{curve}");
            assert!(curve.fit.p_value() > 1e-4, "{curve}");
            for own in curve.shifts.iter().filter(|own| own.standard_error > 0.0) {
                let error = own.log_shift - shift(own.temperature);
                square += (error / own.standard_error).powi(2);
                number += 1.0;
            }
            // reduced lines include the errors of the shifts, so the true law fits them
            let reduced = curve.reduced(&sweep).unwrap();
            let fit =
                PronyFit::with_order(&reduced, 5, &FitOptions::default().with_profiles(false));
            let predicted = fit.unwrap().fit.prediction(0.1).unwrap();
            let error = predicted.modulus.re - reference.at(0.1).re;
            assert!(error.abs() < 4.0 * predicted.covariance[0][0].sqrt());
        }
        // wide tolerance: mean of 36 shifts, which are correlated between neighbours
        let mean = square / number;
        println!("{test:?}: mean square of the shifts in their errors {mean:.2}");
        assert!((0.3..2.5).contains(&mean), "{test:?} {mean}");
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let point = |time, modulus, standard_error| TransientPoint {
        time,
        modulus,
        standard_error,
    };
    let (relaxation, creep) = (TransientTest::Relaxation, TransientTest::Creep);
    let of = |ramp, points: &[TransientPoint]| ModulusData::over_time(relaxation, ramp, points);
    assert_eq!(of(0.0, &[]), Err(CmodError::NoLines));
    assert_eq!(ModulusData::together(&[]), Err(CmodError::NoLines));
    let good = point(1.0, 1e9, 1e7);
    for ramp in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = of(ramp, &[good]);
        assert!(
            matches!(refused, Err(CmodError::NonPhysical { .. })),
            "{ramp}"
        );
    }
    for (ramp, points) in [
        (1.0, vec![good]),
        (0.0, vec![good, point(1.0, 1e9, 1e7)]),
        (0.0, vec![point(f64::NAN, 1e9, 1e7)]),
        (0.0, vec![point(5e-324, 1e9, 1e7)]),
        (0.0, vec![point(1.0, 0.0, 1e7)]),
        (0.0, vec![point(1.0, f64::INFINITY, 1e7)]),
        (0.0, vec![point(1.0, 1e9, 0.0)]),
    ] {
        let refused = of(ramp, &points);
        assert!(
            matches!(refused, Err(CmodError::ModulusPoint { .. })),
            "{points:?}"
        );
    }
    let points: Vec<TransientPoint> = (1..9).map(|k| point(f64::from(k), 1e9, 1e7)).collect();
    let data = of(0.0, &points).unwrap();
    let options = FitOptions::default();
    for law in [Law::KelvinVoigt, Law::PowerLaw { density: 1000.0 }] {
        let refused = RheologicalFit::new(&data, law, &options);
        assert!(
            matches!(refused, Err(CmodError::LawOverTime { .. })),
            "{law}"
        );
    }
    let creep = ModulusData::over_time(creep, 0.0, &points).unwrap();
    assert!(RheologicalFit::new(&creep, Law::KelvinVoigt, &options).is_ok());
    // errors of the weights have no effect if the variances are known
    let drawn = data.clone().with_scatter_of_weights(|| 1.0);
    assert_eq!(drawn.modulus(), data.modulus());
    assert!(matches!(
        cmod::causal::CausalEstimate::new(&data),
        Err(CmodError::MustOscillate { .. })
    ));
}
