//! Windows: their gains in closed form, their weights by SciPy, what overlap and exponential windows do.

use std::f64::consts::PI;

use labio::{AddedDamping, DampedMode, Window};

use super::spectra::reference;
use testbed::claim::{Claim, Claims};
use testbed::difference::largest;
use testbed::hold;

const CLOSED: &str = "closed form: sums of cosines over a period";
const ROUNDING: &str = "rounding of a sum of a thousand terms";

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    gains(&mut report);
    weights(&mut report);
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
    let windows: [(&str, Window, &[f64]); 4] = [
        ("Hann", Window::HannPeriodic, &[0.5, 0.5]),
        ("Hamming", Window::HammingPeriodic, &[0.54, 0.46]),
        (
            "Blackman-Harris",
            Window::BlackmanHarrisPeriodic,
            &[0.35875, 0.48829, 0.14128, 0.01168],
        ),
        ("flat top", Window::FlatTopPeriodic, &flat_top),
    ];
    for (name, window, a) in windows {
        let mean_square = a[0] * a[0] + a[1..].iter().map(|a| a * a / 2.0).sum::<f64>();
        report.check(
            Claim::new(format!("{name} window: coherent gain"), CLOSED)
                .expects(a[0], "1")
                .within(1e-12, ROUNDING),
            || Ok(window.sample(1000)?.coherent_gain),
        );
        report.check(
            Claim::new(format!("{name} window: mean square"), CLOSED)
                .expects(mean_square, "1")
                .within(1e-12, ROUNDING),
            || Ok(window.sample(1000)?.power_gain),
        );
        report.check(
            Claim::new(format!("{name} window: noise bandwidth"), CLOSED)
                .expects(mean_square / (a[0] * a[0]), "lines")
                .within(1e-12, ROUNDING),
            || Ok(window.sample(1000)?.noise_bandwidth_lines),
        );
    }
    let scalloping = [
        (
            "rectangular",
            Window::Rectangular,
            2.0 / PI,
            "closed form 2/π",
        ),
        (
            "Hann",
            Window::HannPeriodic,
            8.0 / (3.0 * PI),
            "closed form 8/(3π)",
        ),
    ];
    for (name, window, expected, source) in scalloping {
        report.check(
            Claim::new(
                format!("{name} window: amplitude midway between lines"),
                source,
            )
            .expects(expected, "1")
            .within(1e-6, "limit of many samples, to 1/N² at N = 4096"),
            || Ok(window.sample(4096)?.scalloping()),
        );
    }
}

fn weights(report: &mut Claims) {
    let taper = 0.3;
    let windows = [
        ("hann_periodic", Window::HannPeriodic),
        ("hann_symmetric", Window::HannSymmetric),
        ("hamming_periodic", Window::HammingPeriodic),
        ("hamming_symmetric", Window::HammingSymmetric),
        ("blackman_harris_periodic", Window::BlackmanHarrisPeriodic),
        ("blackman_harris_symmetric", Window::BlackmanHarrisSymmetric),
        ("flat_top_periodic", Window::FlatTopPeriodic),
        ("flat_top_symmetric", Window::FlatTopSymmetric),
        ("tukey_periodic", Window::TukeyPeriodic { taper }),
        ("tukey_symmetric", Window::TukeySymmetric { taper }),
    ];
    for (case, window) in windows {
        report.check(
            Claim::new(
                format!("weights of {}, 16 and 15 samples", case.replace('_', " ")),
                "SciPy, fixtures/reference/scipy",
            )
            .within(1e-14, "some roundings of five cosines at most"),
            || {
                let mut errors = Vec::new();
                for n in [16, 15] {
                    let expected = reference(case, &format!("weights_{n}"))?;
                    let weights = window.sample(n)?.weights;
                    errors.push(weights.len() as f64 - expected.len() as f64);
                    errors.extend(weights.iter().zip(&expected).map(|(w, e)| w - e.re));
                }
                Ok(largest(errors))
            },
        );
    }
}

fn overlap(report: &mut Claims) {
    report.check(
        Claim::new(
            "Hann segments overlapped by half: squared correlation",
            "closed form 1/36",
        )
        .expects(1.0 / 36.0, "1")
        .within(1e-12, ROUNDING),
        || Ok(Window::HannPeriodic.sample(1024)?.overlap_correlation(512)),
    );
    report.check(
        Claim::new(
            "rectangular segments overlapped by half: squared correlation",
            "closed form 1/4",
        )
        .expects(0.25, "1")
        .within(1e-14, "one ratio of integers"),
        || Ok(Window::Rectangular.sample(100)?.overlap_correlation(50)),
    );
    let k: f64 = 9.0;
    report.check(
        Claim::new(
            "nine Hann segments overlapped by half count as",
            "Welch 1967: k/(1 + 2(1 - 1/k)/36)",
        )
        .expects(k / (1.0 + 2.0 * (1.0 - 1.0 / k) / 36.0), "averages")
        .within(1e-11, ROUNDING),
        || {
            Ok(Window::HannPeriodic
                .sample(1024)?
                .independent_averages(9, 512)?)
        },
    );
}

fn exponential(report: &mut Claims) {
    // decay of the body 3 1/s, of the window 4 1/s, damped frequency 24 rad/s: 7-24-25 under the window
    let mode = || {
        AddedDamping::new(4.0)?.remove_from_mode(DampedMode {
            natural_omega: 25.0,
            damping_ratio: 7.0 / 25.0,
        })
    };
    let natural = 585.0_f64.sqrt();
    report.check(
        Claim::new(
            "mode under an exponential window: natural frequency of the body",
            "closed form: decay rates add",
        )
        .expects(natural, "rad/s")
        .within_part(1e-14, "rounding"),
        || Ok(mode()?.natural_omega),
    );
    report.check(
        Claim::new(
            "mode under an exponential window: damping ratio of the body",
            "closed form: decay rates add",
        )
        .expects(3.0 / natural, "1")
        .within_part(1e-13, "rounding of a difference"),
        || Ok(mode()?.damping_ratio),
    );
    report.check(
        Claim::new(
            "exponential window to 1 % in 2 s: weight after 1 s",
            "closed form: the square root",
        )
        .expects(0.1, "1")
        .within(1e-14, "rounding"),
        || Ok(AddedDamping::to_end_weight(0.01, 2.0)?.weights(201, 100.0)?[100]),
    );
}
