//! Averaged spectra: Parseval's theorem, closed forms and the distribution of their scatter. The
//! comparison with SciPy is in `scipy_reference.rs`.

use std::f64::consts::TAU;

use labio::{AddedDamping, AveragedSpectra, Channel, Quantity, Record, SpectrumAverager, Window};
use num_complex::Complex64;
use testbed::noise::Noise;

use super::hits::{hit, mean, record};
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::{largest, worst};
use testbed::hold;

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    closed_forms(&mut report);
    analyser(&mut report);
    scatter(&mut report);
    hold!(report);
}

fn closed_forms(report: &mut Claims) {
    report.check(
        Claim::new(
            "energy of 200 and 201 random samples, summed over the lines, relative",
            "Parseval's theorem",
        )
        .within(5e-15, "rounding of 200 terms of one sign"),
        || {
            worst([200, 201], |n| {
                let rate = 1234.0;
                let mut rng = Noise::seeded(1);
                let x = rng.white(n, 1.0);
                let energy: f64 = x.iter().map(|x| x * x).sum::<f64>() / rate;
                let spectra = AveragedSpectra::of([&hit(&x, &x, rate)?], Window::Rectangular)?;
                let lines: f64 = spectra.auto("x")?.iter().sum();
                Ok(lines * spectra.line_spacing_hz() / energy - 1.0)
            })
        },
    );
    report.check(
        Claim::new(
            "amplitude of a sine of 3 through the coherent gain, rectangular and Hann window",
            "closed form",
        )
        .within(4e-15, "rounding"),
        || {
            worst([Window::Rectangular, Window::HannPeriodic], |window| {
                let (n, rate, line) = (64, 32.0, 5);
                let turn = |i: usize| TAU * (line * i) as f64 / n as f64 + 0.4;
                let sine: Vec<f64> = (0..n).map(|i| 3.0 * turn(i).sin()).collect();
                let spectra = AveragedSpectra::of([&hit(&sine, &sine, rate)?], window)?;
                let sampled = window.sample(n)?;
                let peak = spectra.auto("y")?[line];
                let duration = n as f64 / rate;
                let amplitude =
                    (2.0 * peak * sampled.power_gain).sqrt() / (duration * sampled.coherent_gain);
                Ok(amplitude - 3.0)
            })
        },
    );
    report.check(
        Claim::new(
            "exponential window: spectrum on the line σ + iω, relative to its largest",
            "direct sum of the damped transform",
        )
        .within(1e-14, "rounding of forty terms"),
        || {
            let (n, rate, sigma) = (40, 10.0, 1.5);
            let mut rng = Noise::seeded(22);
            let x = rng.white(n, 1.0);
            let hit = record(&[("x", Quantity::Velocity, &x)], rate)?;
            let mut averager = SpectrumAverager::for_records_like(&hit, Window::Rectangular)?
                .with_exponential_window(AddedDamping::new(sigma)?)?;
            averager.add(&hit)?;
            let spectra = averager.spectra()?;
            assert_eq!(spectra.added_damping(), Some(AddedDamping::new(sigma)?));
            let auto = spectra.auto("x")?;
            let peak = largest(auto.iter().copied());
            let lines = spectra.frequency_hz().iter().zip(&auto);
            Ok(largest(lines.map(|(f, g)| {
                let s = Complex64::new(sigma, TAU * f);
                let laplace: Complex64 = (0..n)
                    .map(|i| x[i] * (-s * i as f64 / rate).exp() / rate)
                    .sum();
                let both = *f > 0.0 && *f < rate / 2.0;
                (g - if both { 2.0 } else { 1.0 } * laplace.norm_sqr()) / peak
            })))
        },
    );
}

/// The analyser of paper E, section 3.1: 4096 samples at an interval of 28 µs (printed as 28 ms).
fn analyser(report: &mut Claims) {
    const SOURCE: &str = "paper E, section 3.1, with the erratum 28 µs for 28 ms";
    let silence = || -> Fallible<Record> {
        let mut impulse = vec![0.0; 4096];
        impulse[0] = 1.0;
        hit(&impulse, &impulse, 1.0 / 28e-6)
    };
    report.check(
        Claim::new("record of the mobility tests: duration", SOURCE)
            .expects(0.115, "s")
            .within(5e-4, "half the last printed digit"),
        || Ok(silence()?.duration()),
    );
    report.check(
        Claim::new(
            "record of the mobility tests: end of the lower half of the lines",
            SOURCE,
        )
        .expects(8900.0, "Hz")
        .within(50.0, "half the last printed digit"),
        || {
            let spectra = AveragedSpectra::of([&silence()?], Window::Rectangular)?;
            Ok(0.5 * spectra.frequency_hz().last().copied().unwrap_or(f64::NAN))
        },
    );
}

fn scatter(report: &mut Claims) {
    const HITS: u32 = 10;
    // 2nG/E[G] is χ² with 2n degrees of freedom; 4095 independent lines, four standard errors of
    // each moment
    let relative = || -> Fallible<Vec<f64>> {
        let (n, rate) = (8192, 1000.0);
        let mut rng = Noise::seeded(7);
        let channels = [Channel::new("x", Quantity::Velocity)?];
        let mut averager = SpectrumAverager::new(&channels, n, rate, Window::Rectangular)?;
        for _ in 0..HITS {
            let x = rng.white(n, 1.0);
            averager.add(&record(&[("x", Quantity::Velocity, &x)], rate)?)?;
        }
        let spectra = averager.spectra()?;
        let expected = 2.0 / rate * n as f64 / rate;
        let auto = spectra.auto("x")?;
        Ok(auto[1..n / 2].iter().map(|g| g / expected).collect())
    };
    report.check(
        Claim::new(
            "white noise, ten hits: mean of the spectrum relative to its density",
            "χ² with 20 degrees of freedom",
        )
        .expects(1.0, "1")
        .within(4.0 * 0.0049, "four standard errors over 4095 lines"),
        || Ok(mean(&relative()?)),
    );
    report.check(
        Claim::new(
            "white noise, ten hits: relative variance of a line",
            "χ² with 20 degrees of freedom: 1/n, which is stated",
        )
        .expects(0.1, "1")
        .within(4.0 * 0.0025, "four standard errors over 4095 lines"),
        || Ok(mean(relative()?.iter().map(|g| (g - 1.0).powi(2)))),
    );
}
