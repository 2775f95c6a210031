//! Windows: gains in closed form, the effect of overlap and of exponential windows. The comparison
//! of the weights with SciPy's is in `scipy_reference.rs`.

use std::f64::consts::PI;

use labio::{AddedDamping, DampedMode, Window};

use testbed::claim::{Claim, Claims};
use testbed::difference::{largest, worst};
use testbed::hold;

const ROUNDING: &str = "rounding of a sum of a thousand terms";

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    gains(&mut report);
    overlap(&mut report);
    exponential(&mut report);
    hold!(report);
}

fn gains(report: &mut Claims) {
    let flat_top = [
        0.21557895,
        0.41663158,
        0.277263158,
        0.083578947,
        0.006947368,
    ];
    let windows: [(Window, &[f64]); 4] = [
        (Window::HannPeriodic, &[0.5, 0.5]),
        (Window::HammingPeriodic, &[0.54, 0.46]),
        (
            Window::BlackmanHarrisPeriodic,
            &[0.35875, 0.48829, 0.14128, 0.01168],
        ),
        (Window::FlatTopPeriodic, &flat_top),
    ];
    report.check(
        Claim::new(
            "coherent gain, mean square and noise bandwidth of Hann, Hamming, Blackman-Harris and flat top, relative",
            "closed form: sums of cosines over a period",
        )
        .within(1e-14, ROUNDING),
        || {
            worst(windows, |(window, a)| {
                let mean_square = a[0] * a[0] + a[1..].iter().map(|a| a * a / 2.0).sum::<f64>();
                let sampled = window.sample(1000)?;
                Ok(largest([
                    sampled.coherent_gain / a[0] - 1.0,
                    sampled.power_gain / mean_square - 1.0,
                    sampled.noise_bandwidth_lines / (mean_square / (a[0] * a[0])) - 1.0,
                ]))
            })
        },
    );
    report.check(
        Claim::new(
            "amplitude midway between lines, rectangular and Hann window",
            "closed forms 2/π and 8/(3π)",
        )
        .within(1e-7, "limit of many samples, to 1/N² at N = 4096"),
        || {
            let midway =
                |window: Window| Ok::<_, labio::LabioError>(window.sample(4096)?.scalloping());
            Ok(largest([
                midway(Window::Rectangular)? - 2.0 / PI,
                midway(Window::HannPeriodic)? - 8.0 / (3.0 * PI),
            ]))
        },
    );
}

fn overlap(report: &mut Claims) {
    report.check(
        Claim::new(
            "segments that overlap by half: squared correlation, Hann and rectangular",
            "closed forms 1/36 and 1/4",
        )
        .within(5e-15, ROUNDING),
        || {
            let hann = Window::HannPeriodic.sample(1024)?.overlap_correlation(512);
            let rectangular = Window::Rectangular.sample(100)?.overlap_correlation(50);
            Ok(largest([hann - 1.0 / 36.0, rectangular - 0.25]))
        },
    );
    let k: f64 = 9.0;
    report.check(
        Claim::new(
            "nine Hann segments that overlap by half: effective number",
            "Welch 1967: k/(1 + 2(1 - 1/k)/36)",
        )
        .expects(k / (1.0 + 2.0 * (1.0 - 1.0 / k) / 36.0), "averages")
        .within(1e-13, ROUNDING),
        || {
            Ok(Window::HannPeriodic
                .sample(1024)?
                .independent_averages(9, 512)?)
        },
    );
}

fn exponential(report: &mut Claims) {
    report.check(
        Claim::new(
            "mode under an exponential window: natural frequency and damping ratio of the body, relative",
            "closed form: decay rates add",
        )
        .within(2e-15, "rounding of a difference"),
        || {
            // decay rates of 3 1/s (body) and 4 1/s (window), damped frequency of 24 rad/s: under
            // the window the pole is -7 + 24i, whose modulus is 25
            let mode = AddedDamping::new(4.0)?.remove_from_mode(DampedMode {
                natural_omega: 25.0,
                damping_ratio: 7.0 / 25.0,
            })?;
            let natural = 585.0_f64.sqrt();
            Ok(largest([
                mode.natural_omega / natural - 1.0,
                mode.damping_ratio / (3.0 / natural) - 1.0,
            ]))
        },
    );
    report.check(
        Claim::new(
            "exponential window to 1 % in 2 s: weight after 1 s",
            "closed form: the square root",
        )
        .expects(0.1, "1")
        .within(2e-16, "rounding"),
        || Ok(AddedDamping::to_end_weight(0.01, 2.0)?.weights(201, 100.0)?[100]),
    );
}
