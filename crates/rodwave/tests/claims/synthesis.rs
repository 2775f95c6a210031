//! Histories from transforms: known pairs, and the impact of two elastic rods that no plain transform can do.

use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::synthesis::{DampedSynthesis, FourierSynthesis, SynthesizedHistory};

use super::bodies::{circle, steel};
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::largest;
use testbed::hold;

const WRAP: &str = "the next period comes in with e^(-16)";

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
) -> Fallible<SynthesizedHistory> {
    let transform: Vec<Complex64> = synthesis.arguments().map(transform).collect();
    Ok(synthesis.history(&transform)?)
}

fn square_wave(report: &mut Claims) {
    const INTERVAL: f64 = 0.5e-6;
    /// Six standard deviations of the smoothing.
    const MARGIN: f64 = 18.0 * INTERVAL;
    let transit = 1.0 / (206e9_f64 / 7780.0).sqrt();
    // force by zV/2: 1 for two transit times, then -1 as long, and so on
    let force = || -> Fallible<SynthesizedHistory> {
        let rod = AnalyticChain::analytic_from_impact_face()
            .rod(&steel()?, circle(0.010)?, 1.0)
            .end(Termination::Free)?;
        let plateau = 0.5 * (206e9_f64 * 7780.0).sqrt() * std::f64::consts::PI / 4.0 * 1e-4;
        let synthesis = DampedSynthesis::new(2e-3, INTERVAL)?.smoothed(3.0 * INTERVAL)?;
        let transform: Result<Vec<Complex64>, _> = synthesis
            .arguments()
            .map(|s| {
                rod.mobility_at_s(s)
                    .map(|mobility| 1.0 / (s * 2.0 * mobility * plateau))
            })
            .collect();
        Ok(synthesis.history(&transform?)?)
    };
    report.check(
        Claim::new(
            "two equal free rods held together: square wave of the force for 2 ms, by zV/2",
            "closed form (de Saint-Venant)",
        )
        .within(1e-6, WRAP),
        || {
            let history = force()?;
            let half_period = 2.0 * transit;
            Ok(largest(history.samples.iter().enumerate().filter_map(
                |(index, force)| {
                    let turns = history.time(index) / half_period;
                    let inside =
                        turns > 0.0 && (turns - turns.round()).abs() * half_period > MARGIN;
                    let even = turns.floor().rem_euclid(2.0) < 0.5;
                    inside.then_some(force - if even { 1.0 } else { -1.0 })
                },
            )))
        },
    );
    report.check(
        Claim::new(
            "two equal free rods: force before they meet, by zV/2",
            "causality",
        )
        .within(1e-6, WRAP),
        || {
            let history = force()?;
            Ok(largest(history.samples.iter().enumerate().filter_map(
                |(index, force)| (history.time(index) < -MARGIN).then_some(*force),
            )))
        },
    );
}

fn known_pairs(report: &mut Claims) {
    let synthesis = || DampedSynthesis::new(1.0, 1e-4);
    report.check(
        Claim::new(
            "1/s³ is t²/2, with the known part of the next period",
            "Laplace pair",
        )
        .within(
            5e-11,
            "rounding, which the damping magnifies by e^8, from sums of 10000 lines",
        ),
        || {
            let history = of(&synthesis()?, |s| 1.0 / (s * s * s))?;
            Ok(largest([100, 3000, 9999].map(|index| {
                let t = history.time(index);
                let wrapped = 0.5 * (-16.0_f64).exp() * (t + 2.0).powi(2);
                history.samples[index] - 0.5 * t * t - wrapped
            })))
        },
    );
    report.check(
        Claim::new(
            "50/(s² + 2500) is sin 50t, with the known part of the next period",
            "Laplace pair",
        )
        .within(1e-7, "cut at ω = 3e4: 50/ω²"),
        || {
            let history = of(&synthesis()?, |s| 50.0 / (s * s + 2500.0))?;
            Ok(largest([100, 3000, 9999].map(|index| {
                let t = history.time(index);
                let wrapped = (-16.0_f64).exp() * (50.0 * (t + 2.0)).sin();
                history.samples[index] - (50.0 * t).sin() - wrapped
            })))
        },
    );
    report.check(
        Claim::new(
            "smoothed step at 0.25 s, six standard deviations away",
            "Laplace pair e^(-0.25s)/s",
        )
        .within(2e-7, WRAP),
        || {
            let (sigma, arrival) = (4e-4, 0.25);
            let history = of(&synthesis()?.smoothed(sigma)?, |s| (-s * arrival).exp() / s)?;
            Ok(largest(history.samples.iter().enumerate().filter_map(
                |(index, value)| {
                    let x = (history.time(index) - arrival) / sigma;
                    let step = if x > 0.0 { 1.0 } else { 0.0 };
                    (x.abs() > 6.0).then_some(value - step)
                },
            )))
        },
    );
}

fn decaying(report: &mut Claims) {
    const TAU: f64 = 1e-3;
    const SIGMA: f64 = 5e-6;
    let history = || -> Fallible<SynthesizedHistory> {
        let plain = FourierSynthesis::new(1.0 / 0.040, 20_001)?;
        let spectrum: Vec<Complex64> = plain
            .omegas()
            .map(|omega| (-0.5 * (omega * SIGMA).powi(2)).exp() / Complex64::new(1.0, omega * TAU))
            .collect();
        Ok(plain.history(&spectrum)?)
    };
    report.check(
        Claim::new(
            "1/(1 + iωτ) is e^(-t/τ)/τ by the plain transform, by 1/τ",
            "Fourier pair, smoothed: e^(σ²/2τ²)",
        )
        .within(1e-9, "rounding of 40000 lines"),
        || {
            let history = history()?;
            Ok(largest([100, 1000, 5000, 20_000].map(|index| {
                let t = history.time(index);
                history.samples[index] * TAU - (-t / TAU + 0.5 * (SIGMA / TAU).powi(2)).exp()
            })))
        },
    );
    report.check(
        Claim::new(
            "plain transform: the line at 0 Hz is the integral",
            "definition of the transform",
        )
        .expects(1.0, "1")
        .within(1e-12, "rounding"),
        || {
            let history = history()?;
            Ok(history.samples.iter().sum::<f64>() * history.interval)
        },
    );
}
