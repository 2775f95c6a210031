//! The virtual test of paper A against its equation, closed forms of an elastic rod, and balances.
#![allow(
    clippy::unwrap_used,
    reason = "in a test, a refusal where none is expected is a failure"
)]

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::chain::{LaplaceVariable, WaveMedium};
use rodwave::element::{Circle, CrossSection};
use rodwave::experiment::end_accelerations::{
    DAMPED_GENERATOR, EndAccelerationTest, HalfSine, PERIODIC_GENERATOR, Pulse, RaisedCosine,
    Specimen, Tail,
};
use rodwave::medium::{Medium, PropagationLaw};
use rodwave::modulus::{ConstantQ, Elastic, PowerLawPropagation, Zener};
use rodwave::synthesis::{DampedSynthesis, FourierSynthesis};

/// Test 5 of paper A, table 2.
fn specimen() -> Specimen {
    Specimen {
        section: Circle::of_diameter(0.0158).unwrap().into(),
        length: 0.400,
        accelerometer_mass: 2.9e-3,
    }
}

fn polypropylene() -> Medium<ConstantQ> {
    Medium::new(915.0, ConstantQ::new(2.6e9, 0.07, 1e4).unwrap()).unwrap()
}

/// Paper E, eq. 7.
fn nylon() -> Medium<PowerLawPropagation> {
    let law = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970).unwrap();
    Medium::new(1150.0, law).unwrap()
}

fn blow() -> RaisedCosine {
    RaisedCosine::new(100.0, 1e-4).unwrap()
}

fn rod_mass(density: f64) -> f64 {
    density * specimen().section.area() * specimen().length
}

/// Right side of paper A, eq. 1.
fn printed_ratio<L: PropagationLaw>(medium: &Medium<L>, omega: f64) -> Complex64 {
    let mu = specimen().accelerometer_mass / rod_mass(medium.density());
    let x = medium.propagation_coefficient(omega) * specimen().length;
    x.cosh() + mu * x * x.sinh()
}

/// Transform of samples at `omega`, by direct summation.
fn transform_of(samples: &[f64], start: f64, interval: f64, omega: f64) -> Complex64 {
    let terms = samples
        .iter()
        .enumerate()
        .map(|(n, sample)| sample * Complex64::cis(-omega * (start + n as f64 * interval)));
    interval * terms.sum::<Complex64>()
}

fn largest(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |peak, a| peak.max(a.abs()))
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |peak, (a, b)| peak.max((a - b).abs()))
}

/// The chain computes the ratio from two states, the equation in one step: they share the propagation coefficient only. Sums
/// of a few terms of size |Ψ| up to |x| = 60, whose phase carries 60 ulp; near a zero of Ψ relative to its terms.
#[test]
fn ratio_of_the_ends_is_paper_a_eq_1() {
    fn check<L>(medium: &Medium<L>)
    where
        L: PropagationLaw + Clone + std::fmt::Debug + Send + Sync + 'static,
    {
        let test = EndAccelerationTest::new(medium, &specimen()).unwrap();
        for step in 1..=200 {
            let omega = TAU * 100.0 * f64::from(step);
            let expected = printed_ratio(medium, omega);
            let size = 1.0 + expected.norm();
            let error = (test.acceleration_ratio(omega).unwrap() - expected).norm() / size;
            assert!(error < 1e-12, "{omega}: {error}");
        }
        assert_eq!(test.acceleration_ratio(0.0).unwrap(), Complex64::ONE);
    }
    check(&polypropylene());
    check(&nylon());
    check(&Medium::new(7780.0, Elastic::new(206e9).unwrap()).unwrap());
    check(&Medium::new(915.0, Zener::new(2.0e9, 2.4e9, 1e-4).unwrap()).unwrap());
}

/// The whole walk to time and back. The first mode, at 2.0 kHz, decays as e^{-π 0.07 2000 t}: at 50 ms to 3e-10 of the
/// beginning. The Gaussian, which is the same in both, leaves 3e-14 at the Nyquist frequency, so that the samples contain all
/// there is, and begins the record ahead of the blow. What is left is the alias of the next period, e^{-16} = 1.1e-7 of a tail
/// that has died out, and rounding up to 1e-9 of the peak in each of 5e4 samples, against a spectrum of the free end
/// that at 10 kHz has fallen to a few per cent.
#[test]
fn ratio_from_the_histories() {
    let test = EndAccelerationTest::analytic(&polypropylene(), &specimen()).unwrap();
    let record = test
        .record(
            &blow(),
            &DampedSynthesis::new(50e-3, 1e-6)
                .unwrap()
                .smoothed(2.5e-6)
                .unwrap(),
        )
        .unwrap();
    assert_eq!(record.generator, DAMPED_GENERATOR);
    assert_eq!(record.tail, Tail::Free);
    let mut worst = 0.0_f64;
    for step in 2..=100 {
        let omega = TAU * 100.0 * f64::from(step);
        let at = |samples| transform_of(samples, record.start, record.interval, omega);
        let ratio = at(&record.impacted_end) / at(&record.free_end);
        let expected = printed_ratio(&polypropylene(), omega);
        worst = worst.max((ratio - expected).norm() / expected.norm());
    }
    assert!(worst < 1e-5, "{worst}");
}

/// An elastic rod without accelerometers, in closed form:
/// v₁ = [F(t) + 2 Σ F(t - 2nT)]/Z, v₂ = 2 Σ F(t - (2n - 1)T)/Z, T = L/c. It rings for ever.
#[test]
fn elastic_rod_in_closed_form() {
    let steel = Medium::new(7780.0, Elastic::new(206e9).unwrap()).unwrap();
    let bare = Specimen {
        accelerometer_mass: 0.0,
        ..specimen()
    };
    let interval = 1e-7;
    let test = EndAccelerationTest::analytic(&steel, &bare).unwrap();
    let record = test
        .record(&blow(), &DampedSynthesis::new(2e-3, interval).unwrap())
        .unwrap();
    let transit = bare.length / (206e9_f64 / 7780.0).sqrt();
    let impedance = bare.section.area() * (206e9_f64 * 7780.0).sqrt();
    // derivative of the blow
    let rate = |t: f64| {
        if (0.0..1e-4).contains(&t) {
            100.0 * PI / 1e-4 * (TAU * t / 1e-4).sin()
        } else {
            0.0
        }
    };
    let echo = |t: f64, n: i32| 2.0 * rate(t - f64::from(n) * transit) / impedance;
    let scale = 2.0 * 100.0 * PI / 1e-4 / impedance;
    let mut worst = 0.0_f64;
    for (n, (a1, a2)) in record.impacted_end.iter().zip(&record.free_end).enumerate() {
        let t = n as f64 * interval;
        let exact_1 = rate(t) / impedance + (1..20).map(|m| echo(t, 2 * m)).sum::<f64>();
        let exact_2 = (1..20).map(|m| echo(t, 2 * m - 1)).sum::<f64>();
        worst = worst.max((a1 - exact_1).abs().max((a2 - exact_2).abs()) / scale);
    }
    // The slope of the acceleration jumps by 2πa/d; what a band limit at 1/(2Δt) makes of such a kink is off by 2Δt/(πd) or
    // less, 6e-4.
    assert!(worst < 1e-3, "{worst}");
}

/// Impulse and work of the blow. When the rod has come to rest in itself, both ends move with the impulse over the mass; and
/// what it then has of kinetic energy is less than the work: the rest has been dissipated.
#[test]
fn momentum_and_energy() {
    let test = EndAccelerationTest::analytic(&polypropylene(), &specimen()).unwrap();
    let interval = 1e-6;
    let record = test
        .record(&blow(), &DampedSynthesis::new(60e-3, interval).unwrap())
        .unwrap();
    let mass = rod_mass(915.0) + 2.0 * 2.9e-3;
    assert!((test.mass() / mass - 1.0).abs() < 1e-14); // rounding
    let impulse = 0.5 * 100.0 * 1e-4;
    for end in [&record.impacted_end, &record.free_end] {
        let velocity = interval * end.iter().sum::<f64>();
        // the alias e^{-16} counts over the whole record; the creep of a law without relaxed modulus is slower than its vibrations
        assert!((velocity * mass / impulse - 1.0).abs() < 1e-5, "{velocity}");
    }
    let mut velocity = 0.0;
    let mut work = 0.0;
    for (n, acceleration) in record.impacted_end.iter().enumerate() {
        velocity += interval * acceleration;
        work += interval * velocity * blow().at(n as f64 * interval);
    }
    let kinetic = 0.5 * impulse * impulse / mass;
    assert!(work > kinetic, "{work} {kinetic}");
}

/// The two ways to time share nothing but the chain, and are on different lines of the s plane.
#[test]
fn periodic_and_damped_records_agree() {
    // four times as long: what the Nyquist frequency cuts off rings, and on the damped line the ringing grows as e^{at}, by e^8
    let long_blow = RaisedCosine::new(100.0, 4e-4).unwrap();
    let test = EndAccelerationTest::analytic(&polypropylene(), &specimen()).unwrap();
    let damped = test
        .record(&long_blow, &DampedSynthesis::new(50e-3, 1e-6).unwrap())
        .unwrap();
    let periodic = test
        .periodic_record(&long_blow, &FourierSynthesis::new(20.0, 25_001).unwrap())
        .unwrap();
    // in the late part is the band limit's echo of the beginning of the blow, (Δt/d)² = 6e-6 in the last sample and falling
    // from there backwards
    assert_eq!(periodic.generator, PERIODIC_GENERATOR);
    assert!((periodic.interval - 1e-6).abs() < 1e-18);
    assert!(
        matches!(periodic.tail, Tail::DiedOut { late_level } if late_level < 2e-5),
        "{:?}",
        periodic.tail
    );
    // the damped one has the alias 1.1e-7 of the peak; the periodic one what is left of the vibration and of the creep
    for (a, b) in [
        (&damped.impacted_end, &periodic.impacted_end),
        (&damped.free_end, &periodic.free_end),
    ] {
        let error = largest_difference(a, b) / largest(a);
        assert!(error < 1e-5, "{error}");
    }
    // ten milliseconds hold 20 vibrations of the first mode, which loses 1 - e^{-0.07π} = 20 % in each
    let short = test
        .periodic_record(&long_blow, &FourierSynthesis::new(100.0, 5001).unwrap())
        .unwrap();
    assert!(
        matches!(short.tail, Tail::WrappedAround { .. }),
        "{:?}",
        short.tail
    );
}

/// The power laws of paper E, eq. 7, on the frequency axis, the only place where they are defined.
#[test]
fn law_that_is_known_on_the_axis_only() {
    let test = EndAccelerationTest::new(&nylon(), &specimen()).unwrap();
    let record = test
        .periodic_record(&blow(), &FourierSynthesis::new(20.0, 12_501).unwrap())
        .unwrap();
    assert!(
        matches!(record.tail, Tail::DiedOut { .. }),
        "{:?}",
        record.tail
    );
    // The laws are no causal pair: something is ahead of the front, at most at the level of their defect, 3e-4 of the
    // modulus. The wave of 100 kHz, above all that the blow contains, takes 0.18 ms.
    let ahead = largest(&record.free_end[..50]) / largest(&record.free_end);
    assert!(ahead < 1e-3, "{ahead}");
    for step in [5, 20, 50] {
        let omega = TAU * 200.0 * f64::from(step);
        let at = |samples| transform_of(samples, 0.0, record.interval, omega);
        let ratio = at(&record.impacted_end) / at(&record.free_end);
        let expected = printed_ratio(&nylon(), omega);
        // a line of the grid of a discrete transform comes back with rounding alone
        assert!(
            (ratio - expected).norm() < 1e-9 * (1.0 + expected.norm()),
            "{omega}"
        );
    }
}

/// Simpson's rule with 2000 intervals: (|s|d)⁴/(180 · 2000⁴) < 1e-9 for |s|d up to 40.
#[test]
fn transforms_of_the_pulses() {
    fn check(pulse: &impl Pulse) {
        let duration = 3e-4;
        let step = duration / 2000.0;
        for s in [
            Complex64::ZERO,
            Complex64::new(0.0, PI / duration),
            Complex64::new(0.0, -TAU / duration),
            Complex64::new(1e-3, TAU / duration + 1e-3),
            Complex64::new(8e3, 1e4),
            Complex64::new(2e4, -1e5),
        ] {
            let value = |n: i32| {
                let t = f64::from(n) * step;
                pulse.at(t) * (-s * t).exp()
            };
            let pairs = (0..1000).map(|n| value(2 * n) + 4.0 * value(2 * n + 1) + value(2 * n + 2));
            let expected = pairs.sum::<Complex64>() * (step / 3.0);
            let error = (pulse.transform(s) - expected).norm();
            assert!(error < 1e-8 * 5.0 * duration, "{s}: {error}");
        }
    }
    check(&HalfSine::new(5.0, 3e-4).unwrap());
    check(&RaisedCosine::new(5.0, 3e-4).unwrap());
}

#[test]
fn impossible_tests_are_refused() {
    fn error<M>(medium: &M, specimen: Specimen) -> String
    where
        M: WaveMedium<LaplaceVariable> + Clone + 'static,
    {
        EndAccelerationTest::analytic(medium, &specimen)
            .unwrap_err()
            .to_string()
    }
    let medium = polypropylene();
    assert_eq!(
        error(
            &medium,
            Specimen {
                length: 0.0,
                ..specimen()
            }
        ),
        "element 1: length [m] is 0, expected a finite value above 0"
    );
    assert_eq!(
        error(
            &medium,
            Specimen {
                accelerometer_mass: -1.0,
                ..specimen()
            }
        ),
        "element 0: mass [kg] is -1, expected a finite value, 0 or above"
    );
    assert!(CrossSection::of_area(f64::NAN).is_err());
    assert_eq!(
        HalfSine::new(1.0, 0.0).unwrap_err().to_string(),
        "duration of the pulse [s] is 0, expected a finite value above 0"
    );
    // no force, no answer, and no division by it
    struct Nothing;
    impl Pulse for Nothing {
        fn at(&self, _time: f64) -> f64 {
            0.0
        }
        fn transform(&self, _s: Complex64) -> Complex64 {
            Complex64::ZERO
        }
    }
    let test = EndAccelerationTest::analytic(&medium, &specimen()).unwrap();
    let silence = test
        .periodic_record(&Nothing, &FourierSynthesis::new(20.0, 65).unwrap())
        .unwrap();
    assert_eq!(silence.tail, Tail::DiedOut { late_level: 0.0 });
}
