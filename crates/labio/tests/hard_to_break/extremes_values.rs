//! Extreme numbers for every argument: each is rejected, or its result is finite or flagged.

use labio::hits::{Criteria, Extent, Trigger};
use labio::instrument::{AntiAlias, Converter, Instrument, NoiseSpectrum};
use labio::{
    AddedDamping, AveragedSpectra, BridgeLayout, Channel, DampedMode, ForceWindow,
    FrequencyResponse, LabioError, LineValidity, LowFrequency, Position, Provenance, Quantity,
    Rating, Record, ResponseKind, RestNoise, RigidBand, RigidBody, SensorChain, StrainBridge,
    Window, differentiate, integrate,
};
use ndarray::Array2;
use num_complex::Complex64;
use rand::SeedableRng;

use super::hostile::{self, HOSTILE};
use super::{INPUT, OUTPUT, averaged, channels, record, record_of};

type Made = Result<Vec<f64>, LabioError>;

fn sweep(name: &str, door: impl Fn(f64) -> Made) {
    hostile::sweep(name, door);
}

fn history() -> Vec<f64> {
    (0..64)
        .map(|n| {
            if n < 20 {
                0.0
            } else {
                f64::sin(0.3 * f64::from(n))
            }
        })
        .collect()
}

fn rating(value: f64, unit: &str) -> Rating {
    Rating::new(value, unit).unwrap()
}

#[test]
fn records_and_histories() {
    let samples = history();
    let flat = |record: Record| vec![record.duration(), record.time_at(63)];
    let of = |rate: f64, start: f64| {
        let from = Provenance::computed("t");
        Record::new(Array2::ones((2, 64)), rate, start, channels(), from).map(flat)
    };
    sweep("sampling rate", |x| of(x, 0.0));
    sweep("start time", |x| of(1.0, x));
    sweep("sample", |x| {
        let mut rows = Array2::ones((2, 64));
        rows[(1, 3)] = x;
        Record::new(rows, 1.0, 0.0, channels(), Provenance::computed("t"))
            .map(|r| r.samples().iter().copied().collect())
    });
    for low in [
        LowFrequency::MeanRemoved,
        LowFrequency::AtRest { n_samples: 3 },
    ] {
        sweep("integral at a rate", |x| integrate(&samples, x, low));
        sweep("integral of a number", |x| {
            integrate(&[0.0, 1.0, x, x, -x, 2.0], 10.0, low)
        });
    }
    sweep("cut of an integral", |x| {
        integrate(&samples, 10.0, LowFrequency::CutBelow { frequency_hz: x })
    });
    sweep("derivative at a rate", |x| differentiate(&samples, x));
    sweep("derivative of a number", |x| {
        differentiate(&[0.0, 1.0, x, x, -x, 2.0], 10.0)
    });
}

#[test]
fn windows_filters_and_sheets() {
    sweep("taper", |taper| {
        let window = Window::TukeyPeriodic { taper };
        Ok(window.sample(16)?.weights)
    });
    sweep("decay rate", |x| AddedDamping::new(x)?.weights(8, 10.0));
    sweep("rate of a decay", |x| AddedDamping::new(1.0)?.weights(8, x));
    sweep("end weight", |x| {
        AddedDamping::to_end_weight(x, 1.0)?.weights(8, 10.0)
    });
    sweep("duration of a window", |x| {
        AddedDamping::to_end_weight(0.1, x)?.weights(8, 10.0)
    });
    let gate = |start, end, taper| ForceWindow::new(start, end, taper)?.weights(8, 10.0);
    for sign in [1.0, -1.0] {
        sweep("start of a gate", |x| gate(sign * x, 2.0, 0.1));
        sweep("end of a gate", |x| gate(0.0, sign * x, 0.1));
    }
    sweep("taper of a gate", |x| gate(0.0, 0.5, x));
    let mode = |natural_omega, damping_ratio| {
        AddedDamping::new(1.0)?
            .remove_from_mode(DampedMode {
                natural_omega,
                damping_ratio,
            })
            .map(|m| vec![m.natural_omega, m.damping_ratio])
    };
    sweep("natural frequency", |x| mode(x, 0.01));
    sweep("damping ratio", |x| mode(10.0, x));
    sweep("rated value", |x| {
        Rating::new(x, "TV").map(|r| vec![r.si()])
    });
    let chain = |x: f64, unit: &str| -> Made {
        let chain = SensorChain::of_sensitivity(Rating::new(x, unit)?)?;
        Ok(vec![chain.si_from(0.0), chain.recorded_from(0.0)])
    };
    sweep("sensitivity", |x| chain(x, "fC/N"));
    let sensor = |unit| SensorChain::of_sensitivity(rating(1.0, unit)).unwrap();
    sweep("gain", |x| {
        let chain = sensor("mV/N").with_gain(Rating::new(x, "uV/V")?)?;
        Ok(vec![chain.si_from(0.0)])
    });
    sweep("offset", |x| {
        Ok(vec![sensor("V/N").with_offset(x)?.si_from(1.0)])
    });
    sweep("skew", |x| {
        Ok(vec![sensor("V/N").with_time_skew(x)?.time_skew()])
    });
    let bridge = |layout, gauge: f64, volts: f64| -> Made {
        let bridge = StrainBridge::new(layout, Rating::new(gauge, "1")?, Rating::new(volts, "V")?)?;
        Ok(vec![SensorChain::of_bridge(bridge).si_from(0.0)])
    };
    sweep("gauge factor", |x| bridge(BridgeLayout::Quarter, x, 5.0));
    sweep("excitation", |x| bridge(BridgeLayout::Quarter, 2.0, x));
    sweep("Poisson's ratio", |x| {
        bridge(BridgeLayout::HalfPoisson { poisson_ratio: x }, 2.0, 5.0)
    });
    let position = |x, standard_uncertainty| {
        let chain = sensor("V/N").with_position(Position {
            x,
            standard_uncertainty,
        })?;
        Ok(chain
            .position()
            .map(|p| vec![p.x, p.standard_uncertainty])
            .unwrap_or_default())
    };
    sweep("position", |x| position(x, 0.0));
    sweep("uncertainty of a position", |x| position(0.0, x));
    let none: fn(Criteria) -> Vec<f64> = |_| Vec::new();
    sweep("full scale", |x| {
        Criteria::default().with_full_scale("a", x).map(none)
    });
    sweep("peak over noise", |x| {
        Criteria::default().with_peak_over_noise(Some(x)).map(none)
    });
    sweep("double hit", |x| {
        Criteria::default().with_double_hit(Some(x)).map(none)
    });
    sweep("static offset", |x| {
        Criteria::default().with_static_offset(Some(x)).map(none)
    });
    sweep("level shift", |x| {
        Criteria::default().with_level_shift(Some(x)).map(none)
    });
    sweep("remainder", |x| {
        Criteria::default().with_remainder(Some(x)).map(none)
    });
    sweep("trigger level", |x| {
        Trigger::new("a", x, Extent::Samples(4)).map(|t| vec![t.level()])
    });
    sweep("hysteresis", |x| {
        let trigger = Trigger::new("a", 1.0, Extent::Samples(4))?;
        Ok(vec![trigger.with_hysteresis(x)?.level()])
    });
    sweep("time of an extent", |x| {
        Ok(vec![Extent::Seconds(x).samples(1e5)? as f64])
    });
}

#[test]
fn instruments() {
    let samples = history();
    let taken = |instrument: Instrument| -> Made {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let taken = instrument.record(&record([&samples, &samples], 64.0), &mut random)?;
        Ok(taken.record.samples().iter().copied().collect())
    };
    sweep("gain", |x| taken(Instrument::new().gain(INPUT, x)?));
    sweep("offset", |x| taken(Instrument::new().offset(INPUT, x)?));
    sweep("delay", |x| taken(Instrument::new().delay(INPUT, x)?));
    sweep("resolution", |x| {
        taken(Instrument::new().resolution(INPUT, x)?)
    });
    sweep("cross-talk", |x| {
        taken(Instrument::new().cross_talk(Array2::from_elem((2, 2), x))?)
    });
    sweep("rate", |x| taken(Instrument::new().sample(x, 0.0)?));
    sweep("aperture", |x| taken(Instrument::new().sample(32.0, x)?));
    sweep("range", |x| {
        taken(Instrument::new().convert(Converter::new(24, x)?))
    });
    sweep("white noise", |x| {
        taken(Instrument::new().noise(INPUT, NoiseSpectrum::white(x)?))
    });
    sweep("noise density", |x| {
        taken(Instrument::new().noise(INPUT, NoiseSpectrum::power_law(x, 1.0, 1.0, 1.0)?))
    });
    sweep("noise frequency", |x| {
        taken(Instrument::new().noise(INPUT, NoiseSpectrum::power_law(1.0, x, 4.0, 1.0)?))
    });
    sweep("noise corner", |x| {
        taken(Instrument::new().noise(INPUT, NoiseSpectrum::power_law(1.0, 1.0, -4.0, x)?))
    });
    sweep("noise table", |x| {
        taken(Instrument::new().noise(INPUT, NoiseSpectrum::table(&[[1.0, 1.0], [20.0, x]])?))
    });
    for order in [1, 7, 20] {
        sweep("Butterworth", |x| {
            taken(Instrument::new().anti_alias(AntiAlias::butterworth(order, x)?))
        });
        sweep("Bessel", |x| {
            taken(Instrument::new().anti_alias(AntiAlias::bessel(order, x)?))
        });
        for f in HOSTILE.into_iter().filter(|f| f.is_finite()) {
            let filters = [
                AntiAlias::butterworth(order, 10.0).unwrap(),
                AntiAlias::bessel(order, 10.0).unwrap(),
            ];
            for filter in filters {
                let response = filter.response(f);
                assert!(
                    response.norm() <= 1.0 + 1e-12,
                    "{filter:?} at {f} Hz: {response}"
                );
            }
        }
    }
}

/// Whatever the magnitude of the numbers, a line is right or is flagged as without information.
#[test]
fn spectra_of_tiny_and_huge_samples_are_right_or_flagged() {
    let plain = history();
    let other: Vec<f64> = plain.iter().map(|x| 2.0 * x + 0.1).collect();
    let exact = averaged(&[
        record([&plain, &other], 64.0),
        record([&other, &plain], 64.0),
    ]);
    let exact = exact.h1(INPUT, OUTPUT).unwrap();
    for power in (-1070..=1020).step_by(10) {
        let unit = 2.0_f64.powi(power / 2) * 2.0_f64.powi(power - power / 2);
        let scaled: Vec<f64> = plain.iter().map(|x| x * unit).collect();
        let response: Vec<f64> = other.iter().map(|x| x * unit).collect();
        let hits = [
            record([&scaled, &response], 64.0),
            record([&response, &scaled], 64.0),
        ];
        let Ok(spectra) = AveragedSpectra::of(&hits, Window::Rectangular) else {
            assert!(power > 400, "2^{power} overflows");
            continue;
        };
        let response = spectra.h1(INPUT, OUTPUT).unwrap();
        for (line, value) in response.values.iter().enumerate() {
            if response.validity[line] == LineValidity::Valid {
                assert!(
                    (value / exact.values[line] - 1.0).norm() < 1e-9,
                    "2^{power}, line {line}: {value}"
                );
            } else {
                assert!(value.re.is_nan());
            }
        }
        let is_ordinary = (-400..400).contains(&power);
        assert!(
            !is_ordinary || response.invalid_lines().count() == exact.invalid_lines().count(),
            "2^{power}"
        );
    }
    let rate = [1e-200, 1e200]
        .map(|rate| AveragedSpectra::of(&[record([&plain, &other], rate)], Window::Rectangular));
    for refused in rate {
        assert!(matches!(
            refused,
            Err(LabioError::NonPhysical {
                quantity: "sampling rate [Hz]",
                ..
            })
        ));
    }
}

#[test]
fn responses_from_lines() {
    let force = Channel::new(INPUT, Quantity::Force).unwrap();
    let motion = Channel::new(OUTPUT, Quantity::Acceleration).unwrap();
    let of = |spacing: f64, value: Complex64| {
        FrequencyResponse::of_lines(force.clone(), motion.clone(), spacing, vec![value; 9])
    };
    sweep("line spacing", |x| Ok(of(x, Complex64::ONE)?.frequency_hz));
    let one = || of(1.0, Complex64::ONE).unwrap();
    sweep("coherence", |x| {
        let response = one().with_coherence(vec![x; 9], 3)?;
        Ok(response.variance.unwrap())
    });
    sweep("variance", |x| {
        Ok(one().with_variance(vec![x; 9])?.variance.unwrap())
    });
    sweep("level", |x| {
        let report = one().with_variance(vec![0.1; 9])?.passivity(x)?;
        Ok(report.standard_error[1..].to_vec())
    });
    for value in HOSTILE {
        let response = of(1.0, Complex64::new(value, value)).unwrap();
        let with_variance = response.clone().with_variance(vec![1.0; 9]).unwrap();
        for kind in [
            ResponseKind::Mobility,
            ResponseKind::DynamicMass,
            ResponseKind::DynamicStiffness,
        ] {
            let other = with_variance.to_kind(kind).unwrap();
            for line in 0..9 {
                let is_finite = other.values[line].is_finite()
                    && other.variance.as_ref().unwrap()[line].is_finite();
                assert_eq!(
                    is_finite,
                    other.validity[line] == LineValidity::Valid,
                    "{value} {kind} {line}"
                );
            }
        }
        // 1/(z (1 + i)) is the expected value for every z that has an inverse
        let inverse = response.to_kind(ResponseKind::DynamicMass).unwrap();
        if inverse.validity[1] == LineValidity::Valid {
            let expected = 0.5 / value;
            assert!(
                (inverse.values[1].re / expected - 1.0).abs() < 1e-12,
                "{value}: {}",
                inverse.values[1]
            );
        }
        if let Ok(impulse) = response.impulse_response() {
            assert!(
                impulse.values().iter().all(|h| h.is_finite())
                    && impulse.acausal_part().is_finite()
            );
        }
    }
    let body = |mass: f64, error: f64, from_hz: f64, to_hz: f64| -> Made {
        let completed = RigidBody::new(mass, error)?.complete(
            &of(1.0, Complex64::from(2.0))?,
            RigidBand { from_hz, to_hz },
        )?;
        let valid = |line: &usize| completed.response.validity[*line] == LineValidity::Valid;
        Ok((0..9)
            .filter(valid)
            .map(|line| completed.response.values[line].re)
            .collect())
    };
    sweep("begin of a rigid band", |x| body(0.5, 0.0, x, 7.0));
    sweep("end of a rigid band", |x| body(0.5, 0.0, 2.0, x));
    sweep("error of a mass", |x| body(0.5, x, 2.0, 7.0));
    assert!((body(0.5, 0.0, 2.0, 1e200).unwrap()[0] - 2.0).abs() < 1e-12);
}

#[test]
fn silence_of_hits_that_are_not_alike_is_refused() {
    let samples = history();
    let (slow, fast) = (
        record([&samples, &samples], 64.0),
        record([&samples, &samples], 128.0),
    );
    assert!(matches!(
        RestNoise::before(&[&slow, &fast], INPUT, 20),
        Err(LabioError::SamplingRateMismatch { .. })
    ));
    let named = [(INPUT, Quantity::Voltage), (OUTPUT, Quantity::Acceleration)];
    let renamed = record_of(slow.samples().to_owned(), 64.0, &named);
    assert!(matches!(
        RestNoise::before(&[&slow, &renamed], INPUT, 20),
        Err(LabioError::ChannelMismatch { index: 1, .. })
    ));
    let noise = RestNoise::before(&[&slow], OUTPUT, 20).unwrap();
    assert!(noise.density_at(f64::NAN).is_nan());
}
