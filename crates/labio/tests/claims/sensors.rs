//! Units, sensor chains, strain-gauge bridges, and the instruments of virtual experiments.

use std::f64::consts::{PI, TAU};

use labio::instrument::{Converter, Instrument, NoiseSpectrum};
use labio::{BridgeLayout, Quantity, Rating, Record, SensorChain, StrainBridge, Unit};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::hits::{mean, record};
use crate::units::{TABLE, dimension};
use testbed::claim::{Claim, Claims, Fallible};
use testbed::difference::{largest, worst};
use testbed::hold;

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    units(&mut report);
    sheets(&mut report);
    recorders(&mut report);
    hold!(report);
}

fn units(report: &mut Claims) {
    report.check(
        Claim::new(
            format!("dimension and value in SI of {} units and compounds as instruments write them, relative", TABLE.len()),
            "definitions of inch, foot, pound, bar, standard gravity and the prefixes",
        )
        .within(2.0 * f64::EPSILON, "roundings of a product and a quotient"),
        || {
            worst(TABLE, |(text, exponents, si)| {
                let unit = Unit::parse(text)?;
                if unit.dimension() != dimension(*exponents) {
                    return Err(format!("{text} is of {}", unit.dimension()).into());
                }
                Ok(unit.to_si(1.0) / si - 1.0)
            })
        },
    );
    report.check(
        Claim::new(
            "0 °C, 32 °F, -40 °F in kelvin, and 373.15 K in °F",
            "definitions: 273.15 K, 233.15 K, 212 °F",
        )
        .within(2e-13, "rounding of a sum near 500"),
        || {
            let (celsius, fahrenheit) = (Unit::parse("°C")?, Unit::parse("degF")?);
            assert_eq!(celsius.quantity(), Some(Quantity::Temperature));
            Ok(largest([
                celsius.to_si(0.0) - 273.15,
                fahrenheit.to_si(32.0) - 273.15,
                fahrenheit.to_si(-40.0) - 233.15,
                fahrenheit.of_si(373.15) - 212.0,
            ]))
        },
    );
}

/// Voltage between the taps of the dividers R4-R3 and R1-R2.
fn divided(arms: [f64; 4]) -> f64 {
    let [r1, r2, r3, r4] = arms;
    5.0 * (r3 / (r3 + r4) - r2 / (r1 + r2))
}

fn sheets(report: &mut Claims) {
    report.check(
        Claim::new(
            "sensor of 10 mV/g known to 3 %, amplifier of gain 10 known to 4 %: acceleration at 1 V and its uncertainty, relative",
            "definition of standard gravity; independent errors add in squares",
        )
        .within(1e-15, "rounding"),
        || {
            let sensitivity = Rating::new(10.0, "mV/g")?.with_uncertainty(0.3)?;
            let gain = Rating::new(10.0, "1")?.with_uncertainty(0.4)?;
            let chain = SensorChain::of_sensitivity(sensitivity)?.with_gain(gain)?;
            Ok(largest([
                chain.si_from(1.0) / 98.0665 - 1.0,
                chain.relative_uncertainty() / 0.05 - 1.0,
            ]))
        },
    );
    let poisson_ratio = 0.35;
    // relative changes of the four resistors per axial strain
    let layouts = [
        (BridgeLayout::Quarter, [0.0, 0.0, 1.0, 0.0]),
        (BridgeLayout::HalfOpposite, [1.0, 0.0, 1.0, 0.0]),
        (
            BridgeLayout::HalfPoisson { poisson_ratio },
            [0.0, 0.0, 1.0, -poisson_ratio],
        ),
        (BridgeLayout::HalfBending, [0.0, 0.0, 1.0, -1.0]),
        (
            BridgeLayout::FullPoisson { poisson_ratio },
            [1.0, -poisson_ratio, 1.0, -poisson_ratio],
        ),
        (BridgeLayout::FullBending, [1.0, -1.0, 1.0, -1.0]),
    ];
    report.check(
        Claim::new(
            "strain from the voltage of six layouts of a bridge, relative, up to strains of 0.1",
            "Ohm's law in both dividers",
        )
        .within(
            3e-13,
            "differences of dividers near one half, at a strain of 0.002",
        ),
        || {
            worst(layouts, |(layout, arms)| {
                let (factor, volts) = (Rating::new(2.1, "1")?, Rating::new(5.0, "V")?);
                let chain = SensorChain::of_bridge(StrainBridge::new(layout, factor, volts)?);
                worst([0.1, 0.002, -0.03], |strain| {
                    let voltage = divided(arms.map(|arm| 350.0 * (1.0 + arm * 2.1 * strain)));
                    Ok(chain.si_from(voltage) / strain - 1.0)
                })
            })
        },
    );
}

/// A history of the acceleration `of` time in channel `a`.
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
        .within(
            1e-13,
            "spectrum of the pulse at half the sampling rate, 1e-14 of its maximum",
        ),
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
            "mean of a tone of 30 Hz over an aperture of 7 ms",
            "closed form sin(πfT)/(πfT)",
        )
        .within(1e-13, "transform of 65536 lines"),
        || {
            let history = history(10_000.0, 20_000, crate::instrument::tone(30.0))?;
            let wide = taken(&Instrument::new().sample(1000.0, 0.007)?, &history)?;
            let x = PI * 30.0 * 0.007;
            let exact = |k: usize| x.sin() / x * (TAU * 30.0 * k as f64 / 1000.0).cos();
            Ok(largest((950..1050).map(|k| wide[k] - exact(k))))
        },
    );
    report.check(
        Claim::new(
            "white noise of density 2e-6 up to 5 kHz: mean square",
            "density times bandwidth",
        )
        .expects(0.01, "m²/s⁴")
        .within_part(5.0 * 0.0032, "five standard errors √(2/n)"),
        || {
            let silence = history(10_000.0, 200_000, |_| 0.0)?;
            let noisy = Instrument::new().noise("a", NoiseSpectrum::white(2e-6)?);
            Ok(mean(taken(&noisy, &silence)?.iter().map(|x| x * x)))
        },
    );
    report.check(
        Claim::new(
            "converter of 10 bits without and with dither, busy signal: error of the mean square error",
            "closed forms q²/12 and q²/4",
        )
        .expects(0.0, "standard errors of 100000 squares")
        .within(5.0, "five standard errors"),
        || {
            let busy = |t: f64| 0.9 * (TAU * 17.3 * t).sin() * (TAU * 0.71 * t + 0.3).cos();
            let history = history(10_000.0, 100_000, busy)?;
            let plain = Converter::new(10, 1.0)?;
            let cases = [(plain, 1.0 / 12.0, 0.0028), (plain.with_dither(), 0.25, 0.0038)];
            worst(cases, |(converter, expected, standard_error)| {
                let converted = taken(&Instrument::new().convert(converter), &history)?;
                let exact = history.channel("a")?;
                let pairs = converted.iter().zip(exact.iter());
                let squares = pairs.map(|(a, b)| ((a - b) / converter.step()).powi(2));
                let found = mean(squares);
                Ok((found / expected - 1.0) / standard_error)
            })
        },
    );
}
