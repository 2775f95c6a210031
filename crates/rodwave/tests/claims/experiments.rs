//! Virtual tests of papers A and B, and histories between samples, against equations and closed forms.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::band_limited::{SampledHistory, VelocityHistory};
use rodwave::chain::Termination;
use rodwave::experiment::end_accelerations::{
    EndAccelerationTest, HalfSine, Pulse, RaisedCosine, Specimen,
};
use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use rodwave::synthesis::{DampedSynthesis, FourierSynthesis};

use super::bodies::{circle, nylon, steel};
use testbed::claim::{Claim, Claims, Fallible, Found};
use testbed::difference::{largest, largest_difference, worst};
use testbed::hold;

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    end_accelerations(&mut report);
    strains(&mut report);
    sampled(&mut report);
    hold!(report);
}

fn polypropylene() -> Fallible<Medium<ConstantQ>> {
    Ok(Medium::new(915.0, ConstantQ::new(2.6e9, 0.07, 1e4)?)?)
}

/// Test 5 of paper A, Table 2.
fn specimen() -> Fallible<Specimen> {
    Ok(Specimen {
        section: circle(0.0158)?.into(),
        length: 0.400,
        accelerometer_mass: 2.9e-3,
    })
}

/// Right side of paper A, eq. 1.
fn printed_ratio(gamma: Complex64, density: f64) -> Complex64 {
    let mass = density * PI / 4.0 * 0.0158 * 0.0158 * 0.400;
    let x = gamma * 0.400;
    x.cosh() + 2.9e-3 / mass * x * x.sinh()
}

fn hundreds_of_hz() -> impl Iterator<Item = f64> {
    (1..=200).map(|step| TAU * 100.0 * f64::from(step))
}

fn end_accelerations(report: &mut Claims) {
    const SOURCE: &str = "paper A, eq. 1";
    let why = "sums of a few terms of size Ψ, whose phase carries 60 roundings";
    report.check(
        Claim::new(
            "ratio of the end accelerations, polypropylene, 0.1 to 20 kHz",
            SOURCE,
        )
        .within(1e-12, why),
        || {
            let medium = polypropylene()?;
            let test = EndAccelerationTest::new(&medium, &specimen()?)?;
            worst(hundreds_of_hz(), |omega| {
                let expected = printed_ratio(medium.propagation_coefficient(omega), 915.0);
                Ok((test.acceleration_ratio(omega)? - expected).norm() / (1.0 + expected.norm()))
            })
        },
    );
    report.check(
        Claim::new(
            "ratio of the end accelerations, Nylon-6, 0.1 to 20 kHz",
            SOURCE,
        )
        .within(1e-12, why),
        || {
            let medium = nylon()?;
            let test = EndAccelerationTest::new(&medium, &specimen()?)?;
            worst(hundreds_of_hz(), |omega| {
                let expected = printed_ratio(medium.propagation_coefficient(omega), 1150.0);
                Ok((test.acceleration_ratio(omega)? - expected).norm() / (1.0 + expected.norm()))
            })
        },
    );
    report.check(
        Claim::new(
            "ratio from the transforms of the histories, 0.2 to 10 kHz, relative",
            SOURCE,
        )
        .within(
            1e-5,
            "alias e^(-16) and rounding, where the spectrum has fallen to a few per cent",
        ),
        ratio_of_the_histories,
    );
    report.check(
        Claim::new(
            "momentum of the struck rod, at either end, by the impulse",
            "conservation of momentum",
        )
        .within(1e-5, "alias e^(-16) over the whole record, and creep"),
        || {
            let test = EndAccelerationTest::analytic(&polypropylene()?, &specimen()?)?;
            let blow = RaisedCosine::new(100.0, 1e-4)?;
            let record = test.record(&blow, &DampedSynthesis::new(60e-3, 1e-6)?)?;
            let mass = 915.0 * PI / 4.0 * 0.0158 * 0.0158 * 0.400 + 2.0 * 2.9e-3;
            let impulse = 0.5 * 100.0 * 1e-4;
            Ok(largest([&record.impacted_end, &record.free_end].map(
                |end| 1e-6 * end.iter().sum::<f64>() * mass / impulse - 1.0,
            )))
        },
    );
    report.check(
        Claim::new(
            "histories by the damped and by the periodic transform, by the peak",
            "two lines of the Laplace plane",
        )
        .within(1e-5, "what is left of the vibration after 50 ms"),
        || {
            let blow = RaisedCosine::new(100.0, 4e-4)?;
            let test = EndAccelerationTest::analytic(&polypropylene()?, &specimen()?)?;
            let damped = test.record(&blow, &DampedSynthesis::new(50e-3, 1e-6)?)?;
            let periodic = test.periodic_record(&blow, &FourierSynthesis::new(20.0, 25_001)?)?;
            let n = damped.free_end.len().min(periodic.free_end.len());
            Ok(largest([
                largest_difference(&damped.impacted_end[..n], &periodic.impacted_end[..n])
                    / largest(damped.impacted_end.iter().copied()),
                largest_difference(&damped.free_end[..n], &periodic.free_end[..n])
                    / largest(damped.free_end.iter().copied()),
            ]))
        },
    );
    report.check(
        Claim::new(
            "elastic rod: accelerations of both ends with their echoes for 2 ms, by the peak",
            "closed form (d'Alembert)",
        )
        .within(1e-3, "a kink under a band limit: 2Δt/(πd)"),
        elastic_ends,
    );
}

fn ratio_of_the_histories() -> Found {
    let medium = polypropylene()?;
    let test = EndAccelerationTest::analytic(&medium, &specimen()?)?;
    let synthesis = DampedSynthesis::new(50e-3, 1e-6)?.smoothed(2.5e-6)?;
    let record = test.record(&RaisedCosine::new(100.0, 1e-4)?, &synthesis)?;
    worst((2..=100).step_by(7), |step| {
        let omega = TAU * 100.0 * f64::from(step);
        let at = |samples: &[f64]| -> Complex64 {
            let terms = samples.iter().enumerate().map(|(n, sample)| {
                let time = record.start + n as f64 * record.interval;
                sample * Complex64::cis(-omega * time)
            });
            terms.sum()
        };
        let expected = printed_ratio(medium.propagation_coefficient(omega), 915.0);
        let ratio = at(&record.impacted_end) / at(&record.free_end);
        Ok((ratio - expected).norm() / expected.norm())
    })
}

/// a₁ = [F'(t) + 2 Σ F'(t - 2nT)]/Z, a₂ = 2 Σ F'(t - (2n - 1)T)/Z.
fn elastic_ends() -> Found {
    let bare = Specimen {
        accelerometer_mass: 0.0,
        ..specimen()?
    };
    let test = EndAccelerationTest::analytic(&steel()?, &bare)?;
    let blow = RaisedCosine::new(100.0, 1e-4)?;
    let record = test.record(&blow, &DampedSynthesis::new(2e-3, 1e-7)?)?;
    let transit = 0.400 / (206e9_f64 / 7780.0).sqrt();
    // in units of the largest echo
    let rate = |t: f64| {
        if (0.0..1e-4).contains(&t) {
            0.5 * (TAU * t / 1e-4).sin()
        } else {
            0.0
        }
    };
    let z = PI / 4.0 * 0.0158 * 0.0158 * (206e9_f64 * 7780.0).sqrt();
    let scale = 2.0 * 100.0 * PI / 1e-4 / z;
    let ends = record.impacted_end.iter().zip(&record.free_end);
    Ok(largest(ends.enumerate().flat_map(
        |(n, (first, second))| {
            let t = n as f64 * 1e-7;
            let echoes = |odd: i32| -> f64 {
                (1..20)
                    .map(|m| 2.0 * rate(t - f64::from(2 * m - odd) * transit))
                    .sum()
            };
            [
                first / scale - rate(t) - echoes(0),
                second / scale - echoes(1),
            ]
        },
    )))
}

fn strains(report: &mut Claims) {
    let beam = EndSupport::PAPER_B_BEAM;
    let lumps = [
        ("beam on both ends", 0.0),
        ("beam, and beam with a lump of 0.5 kg", 0.5),
    ];
    for (name, lump) in lumps {
        report.check(
            Claim::new(
                format!("ε₁ + ε₂ = 2ε₀ cosh γa in a frame, {name}, 0.5 to 3 kHz, by its terms"),
                "paper B, eqs. 6 and 7",
            )
            .within(
                1e-11,
                "cancelling terms of sizes up to e^(αL) of each other",
            ),
            || {
                let bar = Medium::new(919.0, ConstantQ::new(2.6e9, 0.07, 1e4)?)?;
                let right = if lump > 0.0 {
                    beam.with_lump(lump)
                } else {
                    beam
                };
                let positions = [0.3, 0.4, 0.5];
                let member =
                    FrameMember::new(&bar, circle(0.016)?, 0.8, &positions, right.termination())?
                        .with_left_structure(beam.termination())?;
                let pulse = HalfSine::new(1.0, 2e-4)?;
                worst((10..=60).map(|k| TAU * 50.0 * f64::from(k)), |omega| {
                    let strains = member.strain_spectra(&Excitation::Force(&pulse), &[omega])?;
                    let [first, middle, last] = [strains[0][0], strains[1][0], strains[2][0]];
                    let cosh = (bar.propagation_coefficient(omega) * 0.1).cosh();
                    let size = first.norm() + last.norm() + 2.0 * (middle * cosh).norm();
                    Ok((first + last - 2.0 * middle * cosh).norm() / size)
                })
            },
        );
    }
    report.check(
        Claim::new(
            "cantilever beam of paper B as mass and spring: own frequency",
            "Euler's beam of 280 × 30 × 1 mm: 1.8751²(EI/ρA)^(1/2)/2πl²",
        )
        .expects(
            1.875_104_068_711_961_f64.powi(2) / TAU * 0.001 / 12.0_f64.sqrt()
                * (206e9_f64 / 7780.0).sqrt()
                / (0.280 * 0.280),
            "Hz",
        )
        .within_part(
            0.015,
            "Rayleigh's quotient with the static deflection is 1.5 % high",
        ),
        || Ok((beam.stiffness / beam.mass).sqrt() / TAU),
    );
    for (name, forced) in [("force", true), ("velocity", false)] {
        for (end, echo) in [("a long rod behind", 0.0), ("a wall behind", 1.0)] {
            report.check(
                Claim::new(
                    format!("strains at three sections of an elastic rod under a {name}, {end}, by the peak"),
                    "closed form: -F/(AE) or -v/c, delayed, and the echo of a wall",
                )
                .within(2e-6, "the curvature of the pulse jumps: (Δt/d)²"),
                || elastic_strains(forced, echo),
            );
        }
    }
}

fn elastic_strains(forced: bool, echo: f64) -> Found {
    let (steel, section) = (steel()?, circle(0.016)?);
    let speed = (206e9_f64 / 7780.0).sqrt();
    let pulse = RaisedCosine::new(100.0, 1e-4)?;
    let positions = [0.0, 0.2, 0.8];
    let end = if echo > 0.0 {
        Termination::Fixed
    } else {
        Termination::semi_infinite(&steel, section)
    };
    let member = FrameMember::analytic(&steel, section, 0.8, &positions, end)?;
    let (excitation, divisor) = if forced {
        let area = PI / 4.0 * 0.016 * 0.016;
        (Excitation::Force(&pulse), area * 206e9)
    } else {
        (Excitation::Velocity(&pulse), speed)
    };
    let record = member.record(&excitation, &DampedSynthesis::new(4e-4, 1e-7)?)?;
    let mut errors = Vec::new();
    for (x, strains) in positions.iter().zip(&record.strains) {
        // until the echo comes back from the struck end, 0.31 ms
        for (n, strain) in strains.iter().enumerate().take(3000) {
            let t = n as f64 * 1e-7;
            let away = pulse.at(t - x / speed);
            let back = pulse.at(t - (1.6 - x) / speed);
            errors.push((strain * divisor + away + echo * back) / 100.0);
        }
    }
    Ok(largest(errors))
}

fn sampled(report: &mut Claims) {
    const RATE: f64 = 51_200.0;
    let fractions = [0.05, 0.1, 0.2, 0.25, 0.3, 0.35, 0.38];
    let sampled = |omega: f64| -> Fallible<SampledHistory> {
        let samples: Vec<f64> = (0..400)
            .map(|k| (omega * f64::from(k) / RATE).sin())
            .collect();
        Ok(SampledHistory::new(&samples, RATE)?)
    };
    // away from the two ends, where the record is continued and not known
    let times = || (0..5000).map(|k| (40.0 + f64::from(k) * 0.06137) / RATE);
    report.check(
        Claim::new(
            "sinusoids between their samples, to 0.38 of the rate, by the amplitude",
            "the sinusoid itself",
        )
        .within(2e-5, "stated error of the window"),
        || {
            worst(fractions, |fraction| {
                let omega = TAU * fraction * RATE;
                let history = sampled(omega)?;
                Ok(largest(times().map(|t| history.at(t) - (omega * t).sin())))
            })
        },
    );
    report.check(
        Claim::new(
            "slopes of sinusoids between their samples, to 0.38 of the rate, by the largest",
            "the sinusoid itself",
        )
        .within(2e-4, "the cubic through the fine points loses one order"),
        || {
            worst(fractions, |fraction| {
                let omega = TAU * fraction * RATE;
                let history = sampled(omega)?;
                Ok(largest(
                    times().map(|t| history.slope(t) / omega - (omega * t).cos()),
                ))
            })
        },
    );
}
