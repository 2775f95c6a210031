mod hammer;

use super::*;
use std::f64::consts::{PI, TAU};

const RATE: f64 = 10_000.0;
const N: usize = 2000;
const RADIUS: f64 = 0.98;
const TURN: f64 = 0.2;

/// A resonator, `x[n] = 2 r cos(t) x[n-1] - r^2 x[n-2] + F[n]`, by recursion in time. Its memory
/// after 2000 samples is 0.98^2000 = 3e-18, so that the record contains the whole response.
fn respond(force: &[f64]) -> Vec<f64> {
    ring(RADIUS, force)
}

/// The resonator of [`respond`] with another radius r.
fn ring(radius: f64, force: &[f64]) -> Vec<f64> {
    let mut response: Vec<f64> = Vec::new();
    let past = |response: &[f64], n: usize, lag: usize| {
        n.checked_sub(lag).map_or(0.0, |earlier| response[earlier])
    };
    for (n, f) in force.iter().enumerate() {
        let x = 2.0 * radius * TURN.cos() * past(&response, n, 1)
            - radius * radius * past(&response, n, 2)
            + f;
        response.push(x);
    }
    response
}

/// Frequency response of the resonator in closed form.
fn frequency_response() -> Vec<Complex64> {
    (0..=N / 2)
        .map(|k| {
            let delay = Complex64::cis(-TAU * k as f64 / N as f64);
            1.0 / (1.0 - 2.0 * RADIUS * TURN.cos() * delay + RADIUS * RADIUS * delay * delay)
        })
        .collect()
}

/// Half a sine of 30 samples.
fn half_sine() -> Vec<f64> {
    (0..N)
        .map(|n| match n {
            40..70 => 500.0 * (PI * (n as f64 - 40.0) / 30.0).sin(),
            _ => 0.0,
        })
        .collect()
}

/// Reproducible uniform noise of root mean square 1, from the linear congruential generator of Park
/// and Miller. A sum of many incommensurate sines would not be white.
fn noise(seed: u64) -> Vec<f64> {
    let mut state = seed;
    (0..N)
        .map(|_| {
            state = state * 48_271 % 2_147_483_647;
            12.0_f64.sqrt() * (state as f64 / 2_147_483_647.0 - 0.5)
        })
        .collect()
}

fn tikhonov(lambda: f64) -> Regularisation {
    Regularisation::Tikhonov {
        penalty: Penalty::Size,
        parameter: Parameter::Given(lambda),
    }
}

/// Line k by direct sum.
fn direct(samples: &[f64], k: usize) -> Complex64 {
    let terms = samples.iter().enumerate();
    terms
        .map(|(n, x)| x * Complex64::cis(-TAU * (k * n % N) as f64 / N as f64))
        .sum()
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let n = values.clone().count() as f64;
    (values.map(|x| x * x).sum::<f64>() / n).sqrt()
}

fn error(found: &ReconstructedForce, force: &[f64]) -> f64 {
    let pairs = found.history.force().iter().zip(force);
    rms(pairs.map(|(a, b)| a - b))
}

#[test]
fn the_force_comes_back_from_a_clean_response() {
    let (force, h) = (half_sine(), frequency_response());
    let response = respond(&force);
    let found = Reconstruction::new(&response, RATE, &h)
        .unwrap()
        .solve()
        .unwrap();
    // tolerance: rounding of 500 N, amplified by a condition number of 2500
    assert!(error(&found, &force) < 500.0 * 2500.0 * 1e-15);
    assert!(found.relative_residual < 1e-13);
    assert!(found.excluded.is_empty());
    assert_eq!(found.response_end, ResponseEnd::DiedOut);
}

#[test]
fn noise_is_amplified_by_the_stated_gain() {
    let (force, h) = (half_sine(), frequency_response());
    let level = 0.7;
    for regularisation in [Regularisation::None, tikhonov(4.0)] {
        let mut squares = 0.0;
        let mut stated = 0.0;
        let n_trials = 20;
        let solve = |response: &[f64]| {
            let problem = Reconstruction::new(response, RATE, &h).unwrap();
            problem.with_regularisation(regularisation).solve().unwrap()
        };
        let clean = solve(&respond(&force));
        for seed in 1..=n_trials {
            let noisy: Vec<f64> = respond(&force)
                .iter()
                .zip(noise(seed * 7919))
                .map(|(x, e)| x + level * e)
                .collect();
            let found = solve(&noisy);
            squares += error(&found, clean.history.force()).powi(2);
            stated = found.noise_gain;
        }
        let found = (squares / n_trials as f64).sqrt() / level;
        // tolerance: four times 1/sqrt(2 * 4000), 4.5 %; the 20 trials have 40 000 samples, which
        // the method correlates and which are counted as 4000 independent ones
        assert!((found / stated - 1.0).abs() < 0.045, "{found} {stated}");
    }
}

#[test]
fn regularisation_shrinks_every_line_as_stated() {
    let (force, h) = (half_sine(), frequency_response());
    let response = respond(&force);
    let lambda = 3.0;
    let found = Reconstruction::new(&response, RATE, &h)
        .unwrap()
        .with_regularisation(tikhonov(lambda))
        .solve()
        .unwrap();
    // one line of both forces by direct sums
    let k = 90;
    let shrunk = h[k].norm_sqr() / (h[k].norm_sqr() + lambda);
    let ratio = direct(found.history.force(), k) / direct(&force, k);
    // tolerance: rounding of sums of 2000 terms
    assert!((ratio - shrunk).norm() < 1e-12, "{ratio} {shrunk}");
    assert!(found.relative_residual > 1e-3);
}

#[test]
fn a_missing_mean_is_recovered_from_where_the_force_is_nothing() {
    let (force, mut h) = (half_sine(), frequency_response());
    let response = respond(&force);
    h[0] = Complex64::new(f64::NAN, f64::NAN); // not known, and left out: not read
    let problem = Reconstruction::new(&response, RATE, &h)
        .unwrap()
        .without_lines([0]);
    let without = problem.clone().solve().unwrap();
    let mean = force.iter().sum::<f64>() / N as f64;
    // without a support the only error is the missing mean
    assert!((error(&without, &force) - mean).abs() < 1e-9);
    assert_eq!(
        without.excluded,
        [ExcludedLine {
            index: 0,
            frequency_hz: 0.0,
            reason: ExclusionReason::LeftOut
        }]
    );
    let support = TimeInterval {
        from: 0.003,
        to: 0.008,
    };
    let with = problem.acting_during(support).solve().unwrap();
    assert!(error(&with, &force) < 1e-9);
    assert_eq!(with.silent_components, 0);
}

#[test]
fn a_band_keeps_its_lines_and_names_the_others() {
    let (force, h) = (half_sine(), frequency_response());
    let response = respond(&force);
    let band = FrequencyBand {
        from_hz: 0.0,
        to_hz: 1000.0,
    };
    let found = Reconstruction::new(&response, RATE, &h)
        .unwrap()
        .within(band)
        .solve()
        .unwrap();
    // lines are 5 Hz apart, and lines 0..=200 are in the band
    assert_eq!(found.excluded.len(), 800);
    assert_eq!(found.excluded[0].index, 201);
    assert!(
        found
            .excluded
            .iter()
            .all(|line| line.reason == ExclusionReason::OutsideBand)
    );
    // the error is the energy of the lines of the force above the band, computed here by direct
    // sums
    let lost: f64 = (201..=N / 2)
        .map(|k| direct(&force, k).norm_sqr() * if k == N / 2 { 1.0 } else { 2.0 })
        .sum();
    let expected = lost.sqrt() / N as f64;
    // tolerance: rounding of 1e-9 N in an error of 3 N
    assert!((error(&found, &force) / expected - 1.0).abs() < 1e-9);
}

#[test]
fn a_record_that_ends_too_early_is_flagged() {
    let force = half_sine();
    let cut = &respond(&force)[..200];
    let h = frequency_response();
    let h: Vec<Complex64> = h.iter().step_by(10).copied().collect();
    let found = Reconstruction::new(cut, RATE, &h).unwrap().solve().unwrap();
    assert!(
        matches!(found.response_end, ResponseEnd::CutOff { relative_level } if relative_level > 0.01)
    );
}

#[test]
fn bad_requests_are_refused_with_the_place() {
    let mut h = frequency_response();
    let response = vec![1.0; N];
    let solve = |problem: Reconstruction<'_>| problem.solve().unwrap_err().to_string();
    let problem = Reconstruction::new(&response, RATE, &h).unwrap();
    let band = |from_hz, to_hz| FrequencyBand { from_hz, to_hz };
    let refusals = [
        solve(problem.clone().within(band(20.0, 10.0))),
        solve(problem.clone().within(band(1.0, 2.0))),
        solve(problem.clone().without_lines([1001])),
        solve(problem.clone().with_regularisation(tikhonov(-1.0))),
        solve(problem.acting_during(TimeInterval { from: 1.0, to: 2.0 })),
    ];
    assert_eq!(
        refusals,
        [
            "the frequency band [Hz] runs from 20 to 10, expected finite and increasing limits",
            "none of the 1001 lines can be used",
            "line 1001 is to be left out, but there are only 1001 lines",
            "regularisation parameter [unit of w |H|^2] is -1, expected a finite value above 0",
            "the support from 1 s to 2 s contains no sample of the response",
        ]
    );
    h[5] = f64::NAN.into();
    let problem = Reconstruction::new(&response, RATE, &h).unwrap();
    assert_eq!(
        solve(problem),
        "element 5 of the frequency response is not finite"
    );
    assert!(Reconstruction::new(&response, RATE, &h[1..]).is_err());
    assert!(Reconstruction::new(&response, f64::INFINITY, &h).is_err());
}

const NEAR: TimeInterval = TimeInterval {
    from: 0.0035,
    to: 0.0085,
};

fn noisy(response: &[f64], level: f64, seed: u64) -> Vec<f64> {
    let pairs = response.iter().zip(noise(seed));
    pairs.map(|(x, e)| x + level * e).collect()
}

/// Lines of a response that was integrated twice: it contains little at high frequencies, so that a
/// division needs regularisation.
fn integrated() -> (Vec<f64>, Vec<Complex64>) {
    let leak = 0.97;
    let mut response = respond(&half_sine());
    for _ in 0..2 {
        let mut sum = 0.0;
        for x in &mut response {
            sum = leak * sum + *x;
            *x = sum;
        }
    }
    let lines = frequency_response();
    let lines = lines.iter().enumerate().map(|(k, h)| {
        let delay = Complex64::cis(-TAU * k as f64 / N as f64);
        h / (1.0 - leak * delay).powu(2)
    });
    (response, lines.collect())
}

/// Every method of choice comes near the best parameter for its kind of regularisation; the best
/// parameter is found by comparison with the true force.
#[test]
fn the_chosen_parameter_is_near_the_best() {
    let (clean, h) = integrated();
    let force = half_sine();
    let level = 20.0;
    let response = noisy(&clean, level, 77);
    let white = ResponseNoise::White(level);
    let sensor = Sensor::new(&response, &h).unwrap().with_noise(white);
    let problem = Reconstruction::of_sensors(vec![sensor.unwrap()], RATE).unwrap();
    let kinds: [fn(Parameter) -> Regularisation; 3] = [
        |parameter| Regularisation::Tikhonov {
            penalty: Penalty::Size,
            parameter,
        },
        |parameter| Regularisation::Tikhonov {
            penalty: Penalty::Slope,
            parameter,
        },
        |parameter| Regularisation::Truncated { parameter },
    ];
    for (kind, regularisation) in kinds.into_iter().enumerate() {
        let solve = |parameter| {
            let regularised = problem
                .clone()
                .with_regularisation(regularisation(parameter));
            regularised.solve().unwrap()
        };
        let plain = error(&problem.solve().unwrap(), &force);
        let given = |parameter: f64| error(&solve(Parameter::Given(parameter)), &force);
        let curve = solve(Parameter::GeneralisedCrossValidation)
            .parameter
            .unwrap()
            .curve;
        let best = curve.iter().map(|point| given(point.parameter));
        let best = best.fold(f64::INFINITY, f64::min);
        assert!(best < 0.1 * plain, "{best} {plain}: nothing to choose");
        let chosen = [
            // expected limits: cross validation is nearly best; the discrepancy principle smooths
            // too much; at the corner of the L-curve the noise no longer dominates the norm, but a
            // tenth of its amplitude remains here
            (Parameter::GeneralisedCrossValidation, 1.15),
            (Parameter::Discrepancy, 1.6),
            (Parameter::LCurve, 0.1 * plain / best),
        ]
        .map(|(parameter, price)| (solve(parameter), price));
        for (found, price) in &chosen {
            let parameter = found.parameter.as_ref().unwrap();
            assert_eq!(parameter.verdict, ChoiceVerdict::Found, "{kind}");
            let ratio = error(found, &force) / best;
            assert!(ratio < *price, "{kind} {:?}: {ratio}", parameter.method);
        }
    }
}

#[test]
fn the_curvature_is_that_of_the_curve() {
    let modes = modes::Modes {
        strengths: vec![9.0, 3.0, 0.5, 0.01, f64::INFINITY],
        energies: vec![30.0, 7.0, 3.0, 1.2, 5.0],
        dimensions: vec![2.0, 2.0, 2.0, 2.0, 1.0],
        unexplained: 0.7,
        n_data: 12.0,
    };
    let place = |log: f64| {
        let point = modes.point(Filter::Tikhonov, log.exp());
        [
            0.5 * point.squared_residual.ln(),
            0.5 * point.squared_norm.ln(),
        ]
    };
    let step = 1e-3;
    for log in [-6.0, -3.0, -1.0, 0.5, 2.0] {
        let [a, b, c] = [log - step, log, log + step].map(place);
        let first = [0, 1].map(|i| (c[i] - a[i]) / (2.0 * step));
        let second = [0, 1].map(|i| (c[i] - 2.0 * b[i] + a[i]) / (step * step));
        let cross = first[0] * second[1] - first[1] * second[0];
        let numerical = cross / first[0].hypot(first[1]).powi(3);
        let found = modes.curvature(log.exp());
        // tolerance: the error of the central differences, in proportion to step^2, and rounding
        // divided by step^2
        let tolerance = 1e-5 * numerical.abs().max(1.0);
        assert!(
            (found - numerical).abs() < tolerance,
            "{log}: {found} {numerical}"
        );
    }
}

#[test]
fn two_sensors_are_weighed_by_their_noise_on_every_line() {
    let force = half_sine();
    let (first, h1) = (respond(&force), frequency_response());
    let (second, h2) = integrated();
    let responses = [noisy(&first, 0.4, 3), noisy(&second, 5.0, 4)];
    let sensor = |index: usize, h, level| {
        let sensor = Sensor::new(&responses[index], h).unwrap();
        sensor.with_noise(ResponseNoise::White(level)).unwrap()
    };
    let sensors = [sensor(0, &h1, 0.4), sensor(1, &h2, 5.0)];
    let both = Reconstruction::of_sensors(sensors.to_vec(), RATE).unwrap();
    let both = both.solve().unwrap();
    for k in [3, 90, 700] {
        // the mean of the forces from either sensor, weighted by their inverse variances, by direct
        // sums
        let quotients = [(0, &h1, 0.4_f64), (1, &h2, 5.0)].map(|(index, h, level)| {
            let quotient = direct(&responses[index], k) / h[k];
            (quotient, h[k].norm_sqr() / (level * level))
        });
        let [(f1, w1), (f2, w2)] = quotients;
        let mean = (f1 * w1 + f2 * w2) / (w1 + w2);
        let found = direct(both.history.force(), k);
        assert!((found - mean).norm() < 1e-9 * mean.norm(), "{k}");
    }
    // tolerance: 2000 degrees of freedom, four times sqrt(2/2000) = 0.13
    let chi_square = both.reduced_chi_square.unwrap();
    assert!((chi_square - 1.0).abs() < 0.13, "{chi_square}");
    let RandomErrorOfForce::Stated(stated) = &both.error else {
        panic!("the noise was stated")
    };
    for one in sensors {
        let one = Reconstruction::of_sensors(vec![one], RATE).unwrap();
        let one = one.solve().unwrap();
        let alone = one.error.known().unwrap().standard_error()[0];
        assert!(stated.standard_error()[0] < alone);
    }
}

/// Compares the force with the conditions of the minimum, checked here with sums in time, and with
/// descent along the gradient.
#[test]
fn a_force_without_tension_is_the_minimum() {
    let (force, h) = (half_sine(), frequency_response());
    let response = noisy(&respond(&force), 30.0, 5);
    let problem = Reconstruction::new(&response, RATE, &h)
        .unwrap()
        .acting_during(NEAR)
        .with_regularisation(tikhonov(0.5));
    let pulling = problem.clone().solve().unwrap();
    assert!(pulling.history.force().iter().any(|f| *f < -1.0));
    let found = problem.non_negative().solve().unwrap();
    let report = found.non_negativity.unwrap();
    assert_eq!(report.end, PivotingEnd::Converged);
    assert!(report.n_at_zero > 5 && report.relative_violation < 1e-10);
    assert!(found.history.force().iter().all(|f| *f >= 0.0));
    assert!(error(&found, &force) < error(&pulling, &force));

    // sum (x - h*F)^2 + lambda sum F^2, the period by the impulse response in time
    let mut impulse = vec![0.0; N];
    impulse[0] = 1.0;
    let impulse = respond(&impulse);
    let on = 35..=85;
    let cost_slope = |force: &[f64]| -> Vec<f64> {
        let misfit: Vec<f64> = (0..N)
            .map(|n| {
                let terms = on.clone().filter(|m| *m <= n);
                terms.map(|m| impulse[n - m] * force[m]).sum::<f64>() - response[n]
            })
            .collect();
        let slope = |m: usize| -> f64 {
            let terms = (m..N).map(|n| impulse[n - m] * misfit[n]);
            terms.sum::<f64>() + 0.5 * force[m]
        };
        (0..N)
            .map(|m| if on.contains(&m) { slope(m) } else { 0.0 })
            .collect()
    };
    let scale = cost_slope(&vec![0.0; N])
        .iter()
        .fold(0.0_f64, |m, s| m.max(s.abs()));
    let slope = cost_slope(found.history.force());
    for (m, (f, s)) in found.history.force().iter().zip(&slope).enumerate() {
        // tolerance: rounding of the sums, and the rest of the vibration at the end of the record
        let bound = 1e-8 * scale;
        assert!(
            *s > -bound && (*f <= 0.0 || s.abs() < bound),
            "{m}: {f} {s}"
        );
    }
}

#[test]
fn truncation_on_a_support_cuts_what_the_response_does_not_tell() {
    let (clean, h) = integrated();
    let force = half_sine();
    let level = 60.0;
    let response = noisy(&clean, level, 6);
    let problem = Reconstruction::new(&response, RATE, &h)
        .unwrap()
        .acting_during(NEAR);
    let cut = Regularisation::Truncated {
        parameter: Parameter::GeneralisedCrossValidation,
    };
    let plain = problem.clone().solve().unwrap();
    let found = problem.with_regularisation(cut).solve().unwrap();
    let (plain, cut) = (error(&plain, &force), error(&found, &force));
    assert!(cut < 0.3 * plain, "{cut} {plain}");
    // tolerance: the noise is estimated from at least 1949 degrees of freedom, four times
    // 1/sqrt(2*1949)
    let RandomErrorOfForce::Estimated {
        standard_deviation, ..
    } = found.error
    else {
        panic!("the noise was not stated")
    };
    let ratio = standard_deviation / level;
    assert!((ratio - 1.0).abs() < 0.065, "{ratio}");
}

#[test]
fn the_bias_of_a_shrunk_force_is_what_is_missing_to_first_order() {
    let (force, h) = (half_sine(), frequency_response());
    let response = respond(&force);
    for support in [None, Some(NEAR)] {
        let problem = Reconstruction::new(&response, RATE, &h).unwrap();
        let problem = match support {
            None => problem,
            Some(support) => problem.acting_during(support),
        };
        let found = problem.with_regularisation(tikhonov(1e-3)).solve().unwrap();
        let missing: Vec<f64> = found
            .history
            .force()
            .iter()
            .zip(&force)
            .map(|(found, truth)| found - truth)
            .collect();
        let left = found.regularisation_bias.iter().zip(&missing);
        let left = rms(left.map(|(estimate, missing)| estimate - missing));
        // tolerance: |H|^2 is at least 0.06, so that a fraction lambda/0.06 of the bias is of
        // second order
        let all = rms(missing.iter().copied());
        assert!(all > 1e-6 && left < 0.02 * all, "{left} {all}");
    }
}

#[test]
fn impossible_requests_are_refused() {
    let h = frequency_response();
    let response = respond(&half_sine());
    let problem = Reconstruction::new(&response, RATE, &h).unwrap();
    let sensor = Sensor::new(&response, &h).unwrap();
    let stated = sensor
        .clone()
        .with_noise(ResponseNoise::White(1.0))
        .unwrap();
    let cut = Regularisation::Truncated {
        parameter: Parameter::Discrepancy,
    };
    let whole = TimeInterval { from: 0.0, to: 1.0 };
    let record = vec![0.0; 5000];
    let lines = vec![Complex64::ONE; 2501];
    let long = Reconstruction::new(&record, RATE, &lines).unwrap();
    let refusals = [
        problem.clone().non_negative().solve().unwrap_err(),
        problem
            .clone()
            .acting_during(NEAR)
            .non_negative()
            .with_regularisation(cut)
            .solve()
            .unwrap_err(),
        problem.with_regularisation(cut).solve().unwrap_err(),
        long.acting_during(whole).solve().unwrap_err(),
        Reconstruction::of_sensors(vec![sensor, stated], RATE).unwrap_err(),
    ];
    assert_eq!(
        refusals.map(|error| error.to_string()),
        [
            "a force without tension needs a support, but none is given",
            "a force without tension cannot be regularised by truncation, expected Tikhonov regularisation or none",
            "the discrepancy principle needs the noise of the response, which is not known",
            "the support of the force contains 5000 samples, expected at most 2048",
            "the noise is known for only one of sensor 1 and sensor 0, expected both or neither",
        ]
    );
}
