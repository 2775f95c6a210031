//! Virtual tests of papers A and B, and histories between samples, compared with equations and
//! closed forms.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::band_limited::{SampledHistory, VelocityHistory};
use rodwave::chain::Termination;
use rodwave::experiment::end_accelerations::{
    EndAccelerationTest, HalfSine, Pulse, RaisedCosine, Specimen,
};
use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember};
use rodwave::medium::{Medium, PropagationLaw};
use rodwave::modulus::ConstantQ;
use rodwave::synthesis::{DampedSynthesis, FourierSynthesis};
use testbed::claim::{Claims, Within};
use testbed::difference::{largest, largest_difference};
use testbed::hold;

use crate::bodies::{circle, nylon, polymer, polypropylene, steel};

#[test]
fn claims_hold() {
    let mut report = Claims::default();
    end_accelerations(&mut report);
    strains(&mut report);
    sampled(&mut report);
    hold!(report);
}

/// Test 5 of paper A, Table 2.
pub(crate) fn specimen() -> Specimen {
    Specimen {
        section: circle(0.0158).into(),
        length: 0.400,
        accelerometer_mass: 2.9e-3,
    }
}

pub(crate) fn blow() -> RaisedCosine {
    RaisedCosine::new(100.0, 1e-4).unwrap()
}

fn damped(duration: f64, interval: f64) -> DampedSynthesis {
    DampedSynthesis::new(duration, interval).unwrap()
}

/// Right side of paper A, eq. 1.
pub(crate) fn printed_ratio<L: PropagationLaw>(medium: &Medium<L>, omega: f64) -> Complex64 {
    let mass = medium.density() * PI / 4.0 * 0.0158 * 0.0158 * 0.400;
    let x = medium.propagation_coefficient(omega) * 0.400;
    x.cosh() + 2.9e-3 / mass * x * x.sinh()
}

/// Error of the ratio relative to its terms, from 0.1 to 20 kHz.
fn ratio_error<L>(medium: &Medium<L>) -> f64
where
    L: PropagationLaw + Clone + std::fmt::Debug + Send + Sync + 'static,
{
    let test = EndAccelerationTest::new(medium, &specimen()).unwrap();
    assert_eq!(test.acceleration_ratio(0.0).unwrap(), Complex64::ONE);
    largest((1..=200).map(|step| {
        let omega = TAU * 100.0 * f64::from(step);
        let expected = printed_ratio(medium, omega);
        (test.acceleration_ratio(omega).unwrap() - expected).norm() / (1.0 + expected.norm())
    }))
}

fn end_accelerations(report: &mut Claims) {
    report.by("paper A, eq. 1").deviation(
        "ratio of the end accelerations, polypropylene, Nylon-6, steel and a Zener material, 0.1 to 20 kHz",
        Within(2e-14, "rounding of a few terms of size Ψ, whose phase has some 60 rounding errors"),
        Ok(largest([
            ratio_error(&polypropylene()),
            ratio_error(&nylon()),
            ratio_error(&steel()),
            ratio_error(&polymer()),
        ])),
    );
    report.deviation(
        "ratio from the transforms of the histories, 0.2 to 10 kHz, relative",
        Within(
            2e-7,
            "aliasing of e^(-16) and rounding, relative to a spectrum that has fallen to a few per cent",
        ),
        Ok(ratio_of_the_histories()),
    );
    let test = EndAccelerationTest::analytic(&polypropylene(), &specimen()).unwrap();
    let mass = 915.0 * PI / 4.0 * 0.0158 * 0.0158 * 0.400 + 2.0 * 2.9e-3;
    let impulse = 0.5 * 100.0 * 1e-4;
    let record = test.record(&blow(), &damped(60e-3, 1e-6)).unwrap();
    let ends = [&record.impacted_end, &record.free_end];
    report.by("conservation of momentum").deviation(
        "momentum of the struck rod, at either end, relative to the impulse",
        Within(1e-5, "aliasing of e^(-16) over the whole record, and creep"),
        Ok(largest(ends.map(|end| {
            1e-6 * end.iter().sum::<f64>() * mass / impulse - 1.0
        }))),
    );
    let long = RaisedCosine::new(100.0, 4e-4).unwrap();
    let one = test.record(&long, &damped(50e-3, 1e-6)).unwrap();
    let periodic = FourierSynthesis::new(20.0, 25_001).unwrap();
    let other = test.periodic_record(&long, &periodic).unwrap();
    let ends = [
        (&one.impacted_end, &other.impacted_end),
        (&one.free_end, &other.free_end),
    ];
    report.by("two lines of the Laplace plane").deviation(
        "histories by the damped and by the periodic transform, relative to the peak",
        Within(1e-5, "vibration that remains after 50 ms"),
        Ok(largest(ends.map(|(a, b)| {
            let n = a.len().min(b.len());
            largest_difference(&a[..n], &b[..n]) / largest(a.iter().copied())
        }))),
    );
    report.by("closed form (d'Alembert)").deviation(
        "elastic rod: accelerations of both ends with their echoes for 2 ms, relative to the peak",
        Within(1e-3, "error of a kink in a limited band, 2Δt/(πd)"),
        Ok(elastic_ends()),
    );
}

/// Transform of samples at `omega`, by direct summation.
pub(crate) fn transform_of(samples: &[f64], start: f64, interval: f64, omega: f64) -> Complex64 {
    let terms = samples.iter().enumerate();
    let sum: Complex64 = terms
        .map(|(n, sample)| sample * Complex64::cis(-omega * (start + n as f64 * interval)))
        .sum();
    interval * sum
}

fn ratio_of_the_histories() -> f64 {
    let medium = polypropylene();
    let test = EndAccelerationTest::analytic(&medium, &specimen()).unwrap();
    let synthesis = damped(50e-3, 1e-6).smoothed(2.5e-6).unwrap();
    let record = test.record(&blow(), &synthesis).unwrap();
    largest((2..=100).step_by(7).map(|step| {
        let omega = TAU * 100.0 * f64::from(step);
        let at = |samples| transform_of(samples, record.start, record.interval, omega);
        let expected = printed_ratio(&medium, omega);
        (at(&record.impacted_end) / at(&record.free_end) - expected).norm() / expected.norm()
    }))
}

/// a₁ = [F'(t) + 2 Σ F'(t - 2nT)]/Z, a₂ = 2 Σ F'(t - (2n - 1)T)/Z.
fn elastic_ends() -> f64 {
    let bare = Specimen {
        accelerometer_mass: 0.0,
        ..specimen()
    };
    let test = EndAccelerationTest::analytic(&steel(), &bare).unwrap();
    let record = test.record(&blow(), &damped(2e-3, 1e-7)).unwrap();
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
    largest(ends.enumerate().flat_map(|(n, (first, second))| {
        let t = n as f64 * 1e-7;
        let echoes = |odd: i32| -> f64 {
            let echo = |m: i32| 2.0 * rate(t - f64::from(2 * m - odd) * transit);
            (1..20).map(echo).sum()
        };
        [
            first / scale - rate(t) - echoes(0),
            second / scale - echoes(1),
        ]
    }))
}

fn strains(report: &mut Claims) {
    let beam = EndSupport::PAPER_B_BEAM;
    let bar = Medium::new(919.0, ConstantQ::new(2.6e9, 0.07, 1e4).unwrap()).unwrap();
    let pulse = HalfSine::new(1.0, 2e-4).unwrap();
    let errors = [beam, beam.with_lump(0.5)].into_iter().flat_map(|right| {
        let member = FrameMember::new(
            &bar,
            circle(0.016),
            0.8,
            &[0.3, 0.4, 0.5],
            right.termination(),
        )
        .unwrap()
        .with_left_structure(beam.termination())
        .unwrap();
        let error = |k: i32| {
            let omega = TAU * 50.0 * f64::from(k);
            let strains = member.strain_spectra(&Excitation::Force(&pulse), &[omega]);
            let [first, middle, last] = [0, 1, 2].map(|n: usize| strains.as_ref().unwrap()[n][0]);
            let cosh = (bar.propagation_coefficient(omega) * 0.1).cosh();
            let size = first.norm() + last.norm() + 2.0 * (middle * cosh).norm();
            (first + last - 2.0 * middle * cosh).norm() / size
        };
        (10..=60).map(error).collect::<Vec<_>>()
    });
    report.by("paper B, eqs. 6 and 7").deviation(
        "ε₁ + ε₂ = 2ε₀ cosh γa in a frame, beams on both ends with and without a lumped mass of 0.5 kg, 0.5 to 3 kHz, relative to its terms",
        Within(1e-14, "cancellation of terms that differ by factors of up to e^(αL)"),
        Ok(largest(errors)),
    );
    let euler = 1.875_104_068_711_961_f64.powi(2) / TAU * 0.001 / 12.0_f64.sqrt()
        * (206e9_f64 / 7780.0).sqrt()
        / (0.280 * 0.280);
    report
        .by("Euler's beam of 280 × 30 × 1 mm: 1.8751²(EI/ρA)^(1/2)/2πl²")
        .claim(
            "cantilever beam of paper B as mass and spring: natural frequency",
            "Hz",
            euler,
            Within(
                0.015 * euler,
                "Rayleigh's quotient with the static deflection is 1.5 % high",
            ),
            Ok((beam.stiffness / beam.mass).sqrt() / TAU),
        );
    report
        .by("closed form: -F/(AE) or -v/c, delayed, and the echo of a wall")
        .deviation(
            "strains at three sections of an elastic rod driven by a force or a velocity and ended by a long rod or a wall, relative to the peak",
            Within(2e-6, "error of (Δt/d)² due to the jumps of the curvature of the pulse"),
            Ok(largest([
                elastic_strains(true, 0.0),
                elastic_strains(true, 1.0),
                elastic_strains(false, 0.0),
                elastic_strains(false, 1.0),
            ])),
        );
}

fn elastic_strains(forced: bool, echo: f64) -> f64 {
    let (steel, section) = (steel(), circle(0.016));
    let speed = (206e9_f64 / 7780.0).sqrt();
    let pulse = blow();
    let positions = [0.0, 0.2, 0.8];
    let end = if echo > 0.0 {
        Termination::Fixed
    } else {
        Termination::semi_infinite(&steel, section)
    };
    let member = FrameMember::analytic(&steel, section, 0.8, &positions, end).unwrap();
    let (excitation, divisor) = if forced {
        let area = PI / 4.0 * 0.016 * 0.016;
        (Excitation::Force(&pulse), area * 206e9)
    } else {
        (Excitation::Velocity(&pulse), speed)
    };
    let record = member.record(&excitation, &damped(4e-4, 1e-7)).unwrap();
    let sections = positions.iter().zip(&record.strains);
    largest(sections.flat_map(|(x, strains)| {
        // until the echo returns from the struck end, at 0.31 ms
        let strains = strains.iter().enumerate().take(3000);
        let pulse = &pulse;
        strains.map(move |(n, strain)| {
            let t = n as f64 * 1e-7;
            let away = pulse.at(t - x / speed);
            let back = pulse.at(t - (1.6 - x) / speed);
            (strain * divisor + away + echo * back) / 100.0
        })
    }))
}

fn sampled(report: &mut Claims) {
    const RATE: f64 = 51_200.0;
    // away from the two ends: beyond them the history is a continuation, not the sinusoid
    let times = || (0..5000).map(|k| (40.0 + f64::from(k) * 0.06137) / RATE);
    let errors = [0.05, 0.1, 0.2, 0.25, 0.3, 0.35, 0.38].map(|fraction| {
        let omega = TAU * fraction * RATE;
        let samples: Vec<f64> = (0..400)
            .map(|k| (omega * f64::from(k) / RATE).sin())
            .collect();
        let history = SampledHistory::new(&samples, RATE).unwrap();
        [
            largest(times().map(|t| history.at(t) - (omega * t).sin())),
            largest(times().map(|t| history.slope(t) / omega - (omega * t).cos())),
        ]
    });
    report.by("the sinusoid itself");
    report.deviation(
        "sinusoids between their samples, to 0.38 of the rate, relative to the amplitude",
        Within(2e-5, "stated error of the window"),
        Ok(largest(errors.map(|[value, _]| value))),
    );
    report.deviation(
        "slopes of sinusoids between their samples, to 0.38 of the rate, relative to the largest",
        Within(2e-4, "the slope of the cubic through the fine points is one order less accurate than its values"),
        Ok(largest(errors.map(|[_, slope]| slope))),
    );
}
