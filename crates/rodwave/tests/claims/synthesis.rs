//! Histories from transforms: known pairs, and the impact of two elastic rods, which a plain
//! transform cannot compute.

use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::synthesis::{DampedSynthesis, FourierSynthesis, SynthesizedHistory};

use testbed::claim::{Claims, Within};
use testbed::difference::largest;
use testbed::hold;

use crate::bodies::{circle, steel};

const WRAP: &str = "the next period contributes e^(-16)";

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    square_wave(&mut report);
    known_pairs(&mut report);
    decaying(&mut report);
    hold!(report);
}

fn of(
    synthesis: &DampedSynthesis,
    transform: impl Fn(Complex64) -> Complex64,
) -> SynthesizedHistory {
    let transform: Vec<Complex64> = synthesis.arguments().map(transform).collect();
    synthesis.history(&transform).unwrap()
}

fn timed(history: &SynthesizedHistory) -> impl Iterator<Item = (f64, f64)> {
    let samples = history.samples.iter().enumerate();
    samples.map(|(index, sample)| (history.time(index), *sample))
}

fn square_wave(report: &mut Claims) {
    const INTERVAL: f64 = 0.5e-6;
    /// Six standard deviations of the smoothing.
    const MARGIN: f64 = 18.0 * INTERVAL;
    let half_period = 2.0 / (206e9_f64 / 7780.0).sqrt();
    let rod = AnalyticChain::analytic_from_impact_face()
        .rod(&steel(), circle(0.010), 1.0)
        .end(Termination::Free)
        .unwrap();
    let plateau = 0.5 * (206e9_f64 * 7780.0).sqrt() * std::f64::consts::PI / 4.0 * 1e-4;
    let synthesis = DampedSynthesis::new(2e-3, INTERVAL).unwrap();
    let synthesis = synthesis.smoothed(3.0 * INTERVAL).unwrap();
    // force over zV/2: 0 before the contact, then 1 for two transit times, -1 for as long, and so
    // on
    let force = of(&synthesis, |s| {
        1.0 / (s * 2.0 * rod.mobility_at_s(s).unwrap() * plateau)
    });
    let errors = timed(&force).filter_map(|(time, force)| {
        let turns = time / half_period;
        let away = (turns - turns.round()).abs() * half_period > MARGIN;
        let even = turns.floor().rem_euclid(2.0) < 0.5;
        let expected = if even { 1.0 } else { -1.0 };
        match away {
            true if time < 0.0 => Some(force),
            true => Some(force - expected),
            false => None,
        }
    });
    report.by("closed form (de Saint-Venant)").deviation(
        "two equal free rods that stick: no force before the contact, then a square wave for 2 ms, relative to zV/2",
        Within(1e-6, WRAP),
        Ok(largest(errors)),
    );
}

fn known_pairs(report: &mut Claims) {
    let synthesis = DampedSynthesis::new(1.0, 1e-4).unwrap();
    let error = |history: &SynthesizedHistory, expected: &dyn Fn(f64) -> f64| {
        // including the alias of the next period
        largest([100, 3000, 9999].map(|index| {
            let t = history.time(index);
            let wrapped = (-16.0_f64).exp() * expected(t + 2.0);
            history.samples[index] - expected(t) - wrapped
        }))
    };
    report.by("Laplace pairs");
    report.deviation(
        "1/s³ is t²/2, with the known part of the next period",
        Within(
            1e-11,
            "rounding of sums of 10000 lines, amplified e^8-fold by the damping",
        ),
        Ok(error(&of(&synthesis, |s| 1.0 / (s * s * s)), &|t| {
            0.5 * t * t
        })),
    );
    let oscillation = of(&synthesis, |s| 50.0 / (s * s + 2500.0));
    report.deviation(
        "50/(s² + 2500) is sin 50t, with the known part of the next period",
        Within(1e-7, "the part above ω = 3e4, 50/ω²"),
        Ok(error(&oscillation, &|t| (50.0 * t).sin())),
    );
    let (sigma, arrival) = (4e-4, 0.25);
    let smooth = synthesis.smoothed(sigma).unwrap();
    let step = of(&smooth, |s| (-s * arrival).exp() / s);
    let errors = timed(&step).filter_map(|(time, value)| {
        let x = (time - arrival) / sigma;
        // the value at the instant of the jump is half of the jump
        let expected = if x.abs() < 1e-5 {
            0.5
        } else {
            f64::from(u8::from(x > 0.0))
        };
        (x.abs() > 6.0 || x.abs() < 1e-5).then_some(value - expected)
    });
    report.deviation(
        "e^(-0.25 s)/s is a step at 0.25 s, at its middle and six standard deviations of its smoothing away",
        Within(2e-7, WRAP),
        Ok(largest(errors)),
    );
}

fn decaying(report: &mut Claims) {
    const TAU: f64 = 1e-3;
    const SIGMA: f64 = 5e-6;
    let plain = FourierSynthesis::new(1.0 / 0.040, 20_001).unwrap();
    let spectrum: Vec<Complex64> = plain
        .omegas()
        .map(|omega| (-0.5 * (omega * SIGMA).powi(2)).exp() / Complex64::new(1.0, omega * TAU))
        .collect();
    let history = plain.history(&spectrum).unwrap();
    assert_eq!(history.samples.len(), 40_000);
    report
        .by("Fourier pair, smoothed: e^(σ²/2τ²); its line at 0 Hz is the integral")
        .deviation(
            "1/(1 + iωτ) is e^(-t/τ)/τ by the plain transform, relative to 1/τ, and its integral 1",
            Within(2e-13, "rounding of 40000 lines"),
            Ok(largest(
                [100, 1000, 5000, 20_000]
                    .map(|index| {
                        let t = history.time(index);
                        let exact = (-t / TAU + 0.5 * (SIGMA / TAU).powi(2)).exp();
                        history.samples[index] * TAU - exact
                    })
                    .into_iter()
                    .chain([history.samples.iter().sum::<f64>() * history.interval - 1.0]),
            )),
        );
}
