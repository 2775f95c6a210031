//! Histories from spectra: closed forms, and the impact of two finite elastic rods that no plain transform can do.
#![allow(
    clippy::unwrap_used,
    reason = "in a test, a refusal where none is expected is a failure"
)]

use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::{Circle, CrossSection};
use rodwave::medium::Medium;
use rodwave::modulus::Elastic;
use rodwave::synthesis::{DampedSynthesis, FourierSynthesis, SynthesizedHistory};
use rodwave::{Chain, RodwaveError};

fn steel() -> Medium<Elastic> {
    Medium::new(7780.0, Elastic::new(206e9).unwrap()).unwrap()
}

fn face() -> Circle {
    Circle::of_diameter(0.010).unwrap()
}

/// Length of either rod [m], impact velocity [m/s].
const LENGTH: f64 = 1.0;
const VELOCITY: f64 = 2.0;

fn impedance() -> f64 {
    (206e9_f64 * 7780.0).sqrt() * CrossSection::from(face()).area()
}

fn transit_time() -> f64 {
    LENGTH / (206e9_f64 / 7780.0).sqrt()
}

/// Stick force of two equal free rods: ZV/2 for two transit times, then -ZV/2 as long, and so on for ever.
fn square_wave(time: f64) -> f64 {
    let phase = (time / (4.0 * transit_time())).rem_euclid(1.0);
    let plateau = 0.5 * impedance() * VELOCITY;
    if phase < 0.5 { plateau } else { -plateau }
}

/// Largest error, relative to the plateau, at samples from time 0 that are further than `margin` from every jump.
fn largest_error(history: &SynthesizedHistory, margin: f64, end: f64) -> f64 {
    let plateau = 0.5 * impedance() * VELOCITY;
    let half_period = 2.0 * transit_time();
    history
        .samples
        .iter()
        .enumerate()
        .map(|(index, force)| (history.time(index), force))
        .filter(|(time, _)| {
            let from_jump = (time / half_period - (time / half_period).round()).abs() * half_period;
            *time > 0.0 && *time < end && from_jump > margin
        })
        .map(|(time, force)| (force - square_wave(time)).abs() / plateau)
        .fold(0.0, f64::max)
}

#[test]
fn two_free_elastic_rods() {
    let rod = AnalyticChain::analytic_from_impact_face()
        .rod(&steel(), face(), LENGTH)
        .end(Termination::Free)
        .unwrap();
    let (duration, interval) = (2e-3, 0.5e-6);
    let synthesis = DampedSynthesis::new(duration, interval)
        .unwrap()
        .smoothed(3.0 * interval)
        .unwrap();
    let transform: Vec<Complex64> = synthesis
        .arguments()
        .map(|s| VELOCITY / (s * 2.0 * rod.mobility_at_s(s).unwrap()))
        .collect();
    let history = synthesis.history(&transform).unwrap();
    // 6 standard deviations from a jump the Gaussian leaves 1e-9 of it; the next period comes in with e^{-16} = 1.1e-7
    let error = largest_error(&history, 18.0 * interval, duration);
    assert!(error < 1e-6, "damped: {error}");
    let before = history
        .samples
        .iter()
        .enumerate()
        .filter(|(index, _)| history.time(*index) < -18.0 * interval)
        .map(|(_, force)| force.abs())
        .fold(0.0, f64::max);
    assert!(before < 1e-6 * 0.5 * impedance() * VELOCITY);
}

/// The plain transform of the same impact adds up all repetitions of a force that does not die out. Half a period of the
/// force left over is the best case: plateaus of alternating sign, 1 - 1 + 1 - ... = 1/2, half of the force. Any other
/// period is worse, and a whole number of periods of the force meets a pole.
#[test]
fn two_free_elastic_rods_by_the_plain_transform() {
    let rod = Chain::from_impact_face()
        .rod(&steel(), face(), LENGTH)
        .end(Termination::Free)
        .unwrap();
    let error = |periods_of_force: f64| {
        let period = periods_of_force * 4.0 * transit_time();
        let plain = FourierSynthesis::new(1.0 / period, 4001).unwrap();
        let interval = period / 8000.0;
        let spectrum: Vec<Complex64> = plain
            .omegas()
            .map(|omega| {
                if omega == 0.0 {
                    // the accelerance of a free body is 1/M: total impulse V M/2
                    return (0.5 * VELOCITY * rod.free_mass().unwrap()).into();
                }
                let sum = 2.0 * rod.mobility(omega).unwrap();
                let force = VELOCITY / (Complex64::new(0.0, omega) * sum);
                force * (-0.5 * (omega * 3.0 * interval).powi(2)).exp()
            })
            .collect();
        let history = plain.history(&spectrum).unwrap();
        largest_error(&history, 18.0 * interval, 2.0 * transit_time())
    };
    assert!((error(5.5) - 0.5).abs() < 1e-6); // 1e-9 of the Gaussian; poles on the axis magnify rounding
    for periods in [4.9, 5.2, 5.3, 5.7] {
        assert!(error(periods) > 0.6, "{periods}");
    }
}

/// The plain transform is right where the history dies out: 1/(1 + iωτ) is e^{-t/τ}/τ.
#[test]
fn plain_transform_of_a_decaying_history() {
    let tau = 1e-3;
    let plain = FourierSynthesis::new(1.0 / 0.040, 20_001).unwrap();
    let omegas: Vec<f64> = plain.omegas().collect();
    let sigma: f64 = 5e-6;
    let spectrum: Vec<Complex64> = omegas
        .iter()
        .map(|omega| {
            let smoothing = (-0.5 * (omega * sigma).powi(2)).exp();
            smoothing / Complex64::new(1.0, omega * tau)
        })
        .collect();
    let history = plain.history(&spectrum).unwrap();
    assert_eq!(history.samples.len(), 40_000);
    assert!((history.interval - 1e-6).abs() < 1e-18);
    for index in [100, 1000, 5000, 20_000] {
        let time = history.time(index);
        // The Gaussian multiplies an exponential by e^{σ²/2τ²}; e^{-40} comes from the period before.
        let expected = (-time / tau + 0.5 * (sigma / tau).powi(2)).exp() / tau;
        assert!((history.samples[index] - expected).abs() < 1e-9 / tau);
    }
    // Scaling: the line at 0 Hz is the integral.
    let integral: f64 = history.samples.iter().sum::<f64>() * history.interval;
    assert!((integral - 1.0).abs() < 1e-12); // rounding
}

/// Laplace pairs: a ramp, an undamped oscillation, a delayed and smoothed step.
#[test]
fn damped_transform_of_known_pairs() {
    let synthesis = DampedSynthesis::new(1.0, 1e-4).unwrap();
    let history = |f: &dyn Fn(Complex64) -> Complex64| {
        let transform: Vec<Complex64> = synthesis.arguments().map(f).collect();
        synthesis.history(&transform).unwrap()
    };
    let ramp = history(&|s| 1.0 / (s * s * s));
    let oscillation = history(&|s| 50.0 / (s * s + 2500.0));
    for index in [100, 3000, 9999] {
        let t = ramp.time(index);
        // t²/2 and what comes from the next period, e^{-16} (t + 2)²/2, which is known; beyond it e^{-32} and the band limit:
        // 1/s³ is cut at ω = 3e4, which leaves about 1/(ω³ T)
        let wrapped = 0.5 * (-16.0_f64).exp() * (t + 2.0).powi(2);
        assert!((ramp.samples[index] - 0.5 * t * t - wrapped).abs() < 1e-11);
        let wrapped = (-16.0_f64).exp() * (50.0 * (t + 2.0)).sin();
        // cut at ω = 3e4: 50/ω² = 5e-8 in the last line, alternating in sign from sample to sample
        assert!((oscillation.samples[index] - (50.0 * t).sin() - wrapped).abs() < 1e-7);
    }
    let (sigma, arrival) = (4e-4, 0.25);
    let smooth = synthesis.smoothed(sigma).unwrap();
    let transform: Vec<Complex64> = smooth
        .arguments()
        .map(|s| (-s * arrival).exp() / s)
        .collect();
    let step = smooth.history(&transform).unwrap();
    for index in 0..step.samples.len() {
        let x = (step.time(index) - arrival) / sigma;
        if x.abs() > 6.0 {
            let expected = if x > 0.0 { 1.0 } else { 0.0 };
            // e^{-16} from the next period, 1e-9 of the Gaussian, and rounding times e^{8}
            assert!((step.samples[index] - expected).abs() < 2e-7, "{x}");
        }
    }
    // half of the jump at the instant itself
    let (at, _) = step
        .samples
        .iter()
        .enumerate()
        .find(|(index, _)| (step.time(*index) - arrival).abs() < 1e-9)
        .unwrap();
    assert!((step.samples[at] - 0.5).abs() < 2e-7);
}

#[test]
fn impossible_syntheses_are_refused() {
    let text = |error: RodwaveError| error.to_string();
    assert_eq!(
        text(FourierSynthesis::new(0.0, 8).unwrap_err()),
        "frequency step [Hz] is 0, expected a finite value above 0"
    );
    assert_eq!(
        text(FourierSynthesis::new(1.0, 1).unwrap_err()),
        "the spectrum has 1 samples, expected at least 2"
    );
    assert_eq!(
        text(DampedSynthesis::new(1.0, f64::NAN).unwrap_err()),
        "interval between samples [s] is NaN, expected a finite value above 0"
    );
    assert_eq!(
        text(DampedSynthesis::new(1.0, 1e-9).unwrap_err()),
        "number of intervals is 1000000000, expected between 1 and 2^25"
    );
    let synthesis = DampedSynthesis::new(1.0, 0.1).unwrap();
    assert!(synthesis.smoothed(0.5).is_err());
    assert_eq!(
        text(synthesis.history(&[Complex64::ONE; 3]).unwrap_err()),
        "transform has 3 entries, expected 11"
    );
    let mut lines = [Complex64::ONE; 11];
    lines[4].im = f64::INFINITY;
    assert!(matches!(
        synthesis.history(&lines),
        Err(RodwaveError::NonFiniteSample { index: 4, .. })
    ));
}

/// A raised cosine of 80 us in steps of an eighth of a sample at 51.2 kHz, with its closed form beside it.
#[test]
fn f2_a_flat_smoothing_leaves_a_short_blow_as_it_is() {
    let (length, interval) = (80e-6, 1.0 / (8.0 * 51_200.0));
    let omega = std::f64::consts::TAU / length;
    let synthesis = DampedSynthesis::new(2e-3, interval).unwrap();
    let smoothed = synthesis.smoothed(2.5 * interval).unwrap();
    let largest_error = |synthesis: &DampedSynthesis| {
        let lines: Vec<Complex64> = synthesis
            .arguments()
            .map(|s| {
                (1.0 - (-s * length).exp()) * omega * omega / (2.0 * s * (s * s + omega * omega))
            })
            .collect();
        let history = synthesis.history(&lines).unwrap();
        let samples = history.samples.iter().enumerate();
        samples
            .map(|(n, found)| {
                let time = history.start + interval * n as f64;
                let exact = if (0.0..length).contains(&time) {
                    0.5 * (1.0 - (omega * time).cos())
                } else {
                    0.0
                };
                (found - exact).abs()
            })
            .fold(0.0, f64::max)
    };
    // sigma^2/2 times the curvature at the peak, 2 pi^2/T^2: 5.7 %
    assert!(largest_error(&smoothed) > 0.05);
    // what the pulse has beyond the smoothing, where its curvature jumps at the ends: sigma^2/2 times half the jump, by the sidelobes of the kernel less than a tenth of it
    assert!(largest_error(&smoothed.flat()) < 0.006);
    let peak = |synthesis: &DampedSynthesis| {
        let lines: Vec<Complex64> = synthesis
            .arguments()
            .map(|s| {
                (1.0 - (-s * length).exp()) * omega * omega / (2.0 * s * (s * s + omega * omega))
            })
            .collect();
        let history = synthesis.history(&lines).unwrap();
        history.samples.iter().fold(0.0_f64, |top, f| top.max(*f))
    };
    // the peak is 6.5 sigma from either end; a step of an eighth of a sample may miss it by (pi/32)^2/4
    assert!(
        (peak(&smoothed.flat()) - 1.0).abs() < 3e-3,
        "{}",
        peak(&smoothed.flat())
    );
}
