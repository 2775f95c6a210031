//! Units, sensor chains, strain-gauge bridges, and the instruments of virtual experiments.

use std::f64::consts::{PI, TAU};

use labio::instrument::{AntiAlias, Converter, Instrument, NoiseSpectrum};
use labio::{BridgeLayout, Quantity, Rating, Record, SensorChain, StrainBridge, Unit};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::hits::{mean, record};
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::{largest, worst};
use testbed::hold;

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    units(&mut report);
    chains(&mut report);
    bridges(&mut report);
    filters(&mut report);
    recorders(&mut report);
    hold!(report);
}

fn units(report: &mut Claims) {
    // unit, value of one in SI, the SI unit, where it is defined
    let table = [
        (
            "lbf",
            4.4482216152605,
            "N",
            "definition: 0.45359237 kg by 9.80665 m/s²",
        ),
        (
            "psi",
            4.4482216152605 / 0.00064516,
            "Pa",
            "definition: lbf over (0.0254 m)²",
        ),
        ("g", 9.80665, "m/s²", "definition of standard gravity, 1901"),
        ("in/s", 0.0254, "m/s", "definition of the inch, 1959"),
        (
            "mV/g",
            1e-3 / 9.80665,
            "V s²/m",
            "definition of standard gravity, 1901",
        ),
        ("pC/N", 1e-12, "C/N", "definition of the prefix"),
        ("microstrain", 1e-6, "1", "definition of the prefix"),
        (
            "g²/Hz",
            9.80665 * 9.80665,
            "m²/s³",
            "definition of standard gravity, 1901",
        ),
    ];
    for (unit, expected, si, source) in table {
        report.check(
            Claim::new(format!("one {unit}"), source)
                .expects(expected, si)
                .within_part(2.0 * f64::EPSILON, "two roundings"),
            || Ok(Unit::parse(unit)?.to_si(1.0)),
        );
    }
    report.check(
        Claim::new("-40 degrees Fahrenheit", "definition: -40 °C")
            .expects(233.15, "K")
            .within(2e-13, "rounding of a sum near 500"),
        || Ok(Unit::parse("degF")?.to_si(-40.0)),
    );
}

fn accelerometer(sensitivity: f64) -> Fallible<SensorChain> {
    let rating = Rating::new(sensitivity, "mV/g")?.with_uncertainty(0.03 * sensitivity)?;
    let gain = Rating::new(10.0, "1")?.with_uncertainty(0.4)?;
    Ok(SensorChain::of_sensitivity(rating)?.with_gain(gain)?)
}

fn chains(report: &mut Claims) {
    report.check(
        Claim::new(
            "accelerometer of 10 mV/g behind a gain of 10: acceleration at 1 V",
            "definition: ten times standard gravity",
        )
        .expects(98.0665, "m/s²")
        .within_part(1e-14, "rounding"),
        || Ok(accelerometer(10.0)?.si_from(1.0)),
    );
    report.check(
        Claim::new(
            "sensitivity known to 3 %, gain to 4 %: the chain",
            "independent errors add in squares",
        )
        .expects(0.05, "1")
        .within(1e-14, "rounding"),
        || Ok(accelerometer(10.0)?.relative_uncertainty()),
    );
}

/// Voltage between the dividers R4-R3 and R1-R2, each from the bottom of the excitation.
fn divided(arms: [f64; 4]) -> f64 {
    let [r1, r2, r3, r4] = arms;
    5.0 * (r3 / (r3 + r4) - r2 / (r1 + r2))
}

fn bridges(report: &mut Claims) {
    let poisson_ratio = 0.35;
    // changes of the four resistors by the axial strain
    let layouts = [
        ("quarter", BridgeLayout::Quarter, [0.0, 0.0, 1.0, 0.0]),
        (
            "half, opposite arms",
            BridgeLayout::HalfOpposite,
            [1.0, 0.0, 1.0, 0.0],
        ),
        (
            "half, Poisson",
            BridgeLayout::HalfPoisson { poisson_ratio },
            [0.0, 0.0, 1.0, -poisson_ratio],
        ),
        (
            "half, bending",
            BridgeLayout::HalfBending,
            [0.0, 0.0, 1.0, -1.0],
        ),
        (
            "full, Poisson",
            BridgeLayout::FullPoisson { poisson_ratio },
            [1.0, -poisson_ratio, 1.0, -poisson_ratio],
        ),
        (
            "full, bending",
            BridgeLayout::FullBending,
            [1.0, -1.0, 1.0, -1.0],
        ),
    ];
    for (name, layout, arms) in layouts {
        report.check(
            Claim::new(
                format!(
                    "strain from the voltage of a bridge, {name}: relative, to strains of a tenth"
                ),
                "Ohm's law in both dividers",
            )
            .within(1e-12, "differences of dividers near one half"),
            || {
                let bridge =
                    StrainBridge::new(layout, Rating::new(2.1, "1")?, Rating::new(5.0, "V")?)?;
                let chain = SensorChain::of_bridge(bridge);
                worst([0.1, 0.002, -0.03], |strain| {
                    let voltage = divided(arms.map(|arm| 350.0 * (1.0 + arm * 2.1 * strain)));
                    Ok(chain.si_from(voltage) / strain - 1.0)
                })
            },
        );
    }
}

fn filters(report: &mut Claims) {
    let frequencies = [100.0, 400.0, 700.0];
    let s = |f: f64| Complex64::new(0.0, f / 400.0);
    report.check(
        Claim::new(
            "Butterworth filter of fourth order at 400 Hz, 100 to 700 Hz",
            "its quadratics, 2 sin π/8 and 2 sin 3π/8",
        )
        .within(1e-14, "rounding"),
        || {
            let filter = AntiAlias::butterworth(4, 400.0)?;
            Ok(largest(frequencies.map(|f| {
                let quadratic = |b: f64| 1.0 / (1.0 + b * s(f) + s(f) * s(f));
                let exact =
                    quadratic(2.0 * (PI / 8.0).sin()) * quadratic(2.0 * (3.0 * PI / 8.0).sin());
                (filter.response(f) - exact).norm()
            })))
        },
    );
    report.check(
        Claim::new(
            "Bessel filter of fourth order at 400 Hz, 100 to 700 Hz",
            "its polynomial, 105/(s⁴ + 10s³ + 45s² + 105s + 105)",
        )
        .within(1e-13, "rounding, and the half-power frequency to 16 digits"),
        || {
            let filter = AntiAlias::bessel(4, 400.0)?;
            Ok(largest(frequencies.map(|f| {
                let p = s(f) * 2.113_917_674_904_216;
                let exact = 105.0 / ((((p + 10.0) * p + 45.0) * p + 105.0) * p + 105.0);
                (filter.response(f) - exact).norm()
            })))
        },
    );
    for (name, filter) in [
        ("Butterworth", AntiAlias::butterworth as fn(u32, f64) -> _),
        ("Bessel", AntiAlias::bessel as fn(u32, f64) -> _),
    ] {
        report.check(
            Claim::new(
                format!("{name} filters of orders 1 to 12 at their frequency: power"),
                "definition: one half",
            )
            .within(1e-12, "rounding of the polynomial"),
            || {
                worst(1..=12, |order| {
                    let filter: AntiAlias = filter(order, 1234.0)?;
                    Ok(filter.response(1234.0).norm_sqr() - 0.5)
                })
            },
        );
    }
}

/// Acceleration `of` time in channel `a`.
fn history(rate_hz: f64, n: u32, of: impl Fn(f64) -> f64) -> Fallible<Record> {
    let samples: Vec<f64> = (0..n).map(|k| of(f64::from(k) / rate_hz)).collect();
    record(&[("a", Quantity::Acceleration, &samples)], rate_hz)
}

fn taken(instrument: &Instrument, history: &Record) -> Fallible<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let record = instrument.record(history, &mut rng)?.record;
    Ok(record.channel("a")?.to_vec())
}

fn recorders(report: &mut Claims) {
    report.check(
        Claim::new(
            "pulse delayed by 0.37 ms, 42.1 ms and -13.13 ms between samples of 1 kHz",
            "the pulse at an earlier time",
        )
        .within(1e-12, "its spectrum at half the rate, 1e-14"),
        || {
            let pulse = |t: f64| (-((t - 0.5) / 0.004).powi(2)).exp() * (TAU * 50.0 * t).sin();
            let history = history(1000.0, 1000, pulse)?;
            worst([0.000_37, 0.0421, -0.013_13], |delay| {
                let late = taken(&Instrument::new().delay("a", delay)?, &history)?;
                let samples = late.iter().enumerate();
                Ok(largest(
                    samples.map(|(k, a)| a - pulse(k as f64 / 1000.0 - delay)),
                ))
            })
        },
    );
    report.check(
        Claim::new(
            "tone of 30 Hz through an aperture of 7 ms: mean over it",
            "closed form sin(πfT)/(πfT)",
        )
        .within(1e-12, "transform of 65536 lines"),
        || {
            let tone = |t: f64| {
                let fade = (t.min(2.0 - t) / 0.5).clamp(0.0, 1.0);
                (PI * fade / 2.0).sin().powi(2) * (TAU * 30.0 * t).cos()
            };
            let history = history(10_000.0, 20_000, tone)?;
            let wide = taken(&Instrument::new().sample(1000.0, 0.007)?, &history)?;
            let x = PI * 30.0 * 0.007;
            Ok(largest((950..1050).map(|k| {
                wide[k] - x.sin() / x * (TAU * 30.0 * k as f64 / 1000.0).cos()
            })))
        },
    );
    report.check(
        Claim::new(
            "white noise of 2e-6 per Hz to 5 kHz: mean square",
            "density by band",
        )
        .expects(0.01, "m²/s⁴")
        .within_part(5.0 * 0.0032, "five standard errors √(2/n)"),
        || {
            let silence = history(10_000.0, 200_000, |_| 0.0)?;
            let noisy = Instrument::new().noise("a", NoiseSpectrum::white(2e-6)?);
            let squares: Vec<f64> = taken(&noisy, &silence)?.iter().map(|x| x * x).collect();
            Ok(mean(&squares))
        },
    );
    let busy = |t: f64| 0.9 * (TAU * 17.3 * t).sin() * (TAU * 0.71 * t + 0.3).cos();
    let error = move |converter: Converter| -> Fallible<f64> {
        let history = history(10_000.0, 100_000, busy)?;
        let converted = taken(&Instrument::new().convert(converter), &history)?;
        let exact = history.channel("a")?;
        let squares: Vec<f64> = converted
            .iter()
            .zip(exact.iter())
            .map(|(a, b)| ((a - b) / converter.step()).powi(2))
            .collect();
        Ok(mean(&squares))
    };
    let spread = "five standard errors of 100000 squares";
    report.check(
        Claim::new(
            "converter of 10 bits, busy signal: mean square error",
            "closed form q²/12",
        )
        .expects(1.0 / 12.0, "q²")
        .within_part(5.0 * 0.0028, spread),
        || error(Converter::new(10, 1.0)?),
    );
    report.check(
        Claim::new(
            "converter of 10 bits with dither, busy signal: mean square error",
            "closed form q²/4",
        )
        .expects(0.25, "q²")
        .within_part(5.0 * 0.0038, spread),
        || error(Converter::new(10, 1.0)?.with_dither()),
    );
}
