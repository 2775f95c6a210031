//! Histories from spectra: the impact of two elastic rods, which a plain transform cannot compute,
//! smoothing, rejected input.
use num_complex::Complex64;
use rodwave::element::CrossSection;
use rodwave::synthesis::{DampedSynthesis, FourierSynthesis, SynthesizedHistory};
use rodwave::{Chain, RodwaveError, Termination};

use crate::bodies::{circle, steel};

/// Length of each rod [m], and impact velocity [m/s].
const LENGTH: f64 = 1.0;
const VELOCITY: f64 = 2.0;

fn impedance() -> f64 {
    (206e9_f64 * 7780.0).sqrt() * CrossSection::from(circle(0.010)).area()
}

fn transit_time() -> f64 {
    LENGTH / (206e9_f64 / 7780.0).sqrt()
}

/// Stick force of two equal free rods: ZV/2 for two transit times, then -ZV/2 for as long, and so
/// on without end.
fn square_wave(time: f64) -> f64 {
    let phase = (time / (4.0 * transit_time())).rem_euclid(1.0);
    let plateau = 0.5 * impedance() * VELOCITY;
    if phase < 0.5 { plateau } else { -plateau }
}

/// Largest error, relative to the plateau, at samples between time 0 and `end` that are further
/// than `margin` from every jump.
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

/// Checks that the plain transform gives a wrong force, because it sums the undamped force over all
/// periods. In the best case, half a period of the force remains: plateaus of alternating sign, 1 -
/// 1 + 1 - ... = 1/2, half of the force. With a whole number of periods of the force, a line
/// coincides with a pole.
#[test]
fn two_free_elastic_rods_by_the_plain_transform() {
    let rod = Chain::from_impact_face()
        .rod(&steel(), circle(0.010), LENGTH)
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
                    // the accelerance of a free body is 1/M: the total impulse is V M/2
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
        text(DampedSynthesis::new(1.0, 1e-9).unwrap_err()),
        "number of intervals is 1000000000, expected between 1 and 2^25"
    );
}

/// Compares a smoothed raised cosine of 80 µs, in steps of an eighth of the sampling interval at
/// 51.2 kHz, with its closed form.
#[test]
fn f2_a_flat_smoothing_leaves_a_short_blow_as_it_is() {
    let (length, interval) = (80e-6, 1.0 / (8.0 * 51_200.0));
    let omega = std::f64::consts::TAU / length;
    let synthesis = DampedSynthesis::new(2e-3, interval).unwrap();
    let smoothed = synthesis.smoothed(2.5 * interval).unwrap();
    let blow = |synthesis: &DampedSynthesis| {
        let lines: Vec<Complex64> = synthesis
            .arguments()
            .map(|s| {
                (1.0 - (-s * length).exp()) * omega * omega / (2.0 * s * (s * s + omega * omega))
            })
            .collect();
        synthesis.history(&lines).unwrap()
    };
    let largest_error = |synthesis: &DampedSynthesis| {
        let history = blow(synthesis);
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
    // tolerance: the pulse has content beyond the smoothing, because its curvature jumps at the
    // ends: sigma^2/2 times half the jump, which the sidelobes of the kernel reduce to less than a
    // tenth
    assert!(largest_error(&smoothed.flat()) < 0.006);
    let samples = blow(&smoothed.flat()).samples;
    let peak = samples.into_iter().fold(0.0_f64, f64::max);
    // tolerance: the peak is 6.5 sigma from either end; a step of an eighth of a sample may miss it
    // by (pi/32)^2/4
    assert!((peak - 1.0).abs() < 3e-3, "{peak}");
}
