//! Requests that exceed any memory, bodies from a millimetre to a kilometre, and bands at their
//! limits.

use std::ops::Range;

use impulse::{
    CalibrationBlow, CalibrationScatter, ForceHistory, Impact, ImpulseError, Kernel, LineBand,
    LowFrequency, MeasuredBody, Quadrature, StickProblem, StickUncertainty, TimeGrid, ZeroLine,
    lines_of,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::lossy_rod;
use crate::bodies::{impedance, long_rod, mass, rod, wave_speed};

#[test]
fn requests_that_no_memory_holds_are_refused() {
    let (first, second) = (mass(0.5), long_rod(1e3));
    let impact = Impact::between(&first, &second).at_velocity(1.0);
    for n in [usize::MAX, usize::MAX - 1, 1 << 50] {
        assert!(matches!(
            lines_of(&first, 1.0, n),
            Err(ImpulseError::NonPhysical { .. })
        ));
        let band = LineBand {
            highest_hz: 1e4,
            n_samples: n & !1,
        };
        assert!(matches!(
            impact.stick_force_on_lines(band),
            Err(ImpulseError::NonPhysical { .. })
        ));
        let grid = TimeGrid {
            time_step: 1e-6,
            n_steps: n,
        };
        assert!(Kernel::of(&first, grid, Quadrature::Bdf2).is_err());
    }
    assert!(impact.clone().in_steps_of(1e-6).predict(1e12).is_err());
    assert!(impact.stick_force_damped(1e12, 1e-6).is_err());
    // a period of a second in steps of a nanosecond
    let measured = MeasuredBody::from_mobility(
        &vec![Complex64::from(1e-3); 64],
        1.0,
        LowFrequency::Measured,
    )
    .unwrap()
    .with_front_impedance(1e3)
    .unwrap();
    let fine = Impact::between(&first, &measured)
        .at_velocity(1.0)
        .in_steps_of(1e-9)
        .predict(1e-6);
    assert!(
        matches!(
            fine,
            Err(ImpulseError::NonPhysical {
                expected: "at most 2^27",
                ..
            })
        ),
        "{fine:?}"
    );
}

#[test]
fn draws_that_no_memory_holds_are_refused() {
    let lines = vec![Complex64::from(1e-3); 33];
    let problem = StickProblem {
        first: &lines,
        second: &lines,
        frequency_step_hz: 10.0,
        impact_velocity: 1.0,
        zero_line: ZeroLine::EffectiveMass(1.0),
        roll_off_from_hz: None,
        interpolation: 1,
        until: None,
    };
    let uncertainty = StickUncertainty {
        first_scale: 0.01,
        ..StickUncertainty::default()
    };
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (stick, error) = (
        problem.solve().unwrap(),
        problem.error(&uncertainty).unwrap(),
    );
    for n in [usize::MAX, 1 << 40] {
        assert!(
            uncertainty
                .monte_carlo(&problem, 0.0, n, &mut random)
                .is_err()
        );
        assert!(
            error
                .simultaneous(&stick.history, 0.95, 0..10, n, &mut random)
                .is_err()
        );
    }
    // the last level below 1 in floating point has no finite limits
    assert!(error.pointwise(&stick.history, 1.0 - 1e-16).is_err());
    assert!(error.pointwise(&stick.history, 0.999).is_ok());
    assert!(
        error
            .simultaneous(
                &stick.history,
                0.95,
                usize::MAX - 1..usize::MAX,
                200,
                &mut random
            )
            .is_err()
    );
}

/// A steel rod of a length from a millimetre to a kilometre transfers its momentum to a
/// semi-infinite rod in one round trip.
#[test]
fn rods_from_a_millimetre_to_a_kilometre() {
    let impedance = impedance(0.01);
    for length in [1e-3, 1.0, 1e3] {
        let round_trip = 2.0 * length / wave_speed();
        let found = Impact::between(&rod(0.01, length), &long_rod(impedance))
            .at_velocity(1.0)
            .predict(2.5 * round_trip)
            .unwrap();
        let exact = 0.5 * impedance * round_trip;
        assert!(
            // the remaining front returns after another round trip: a separate contact
            (found.contacts[0].impulse / exact - 1.0).abs() < 1e-6,
            "{length}"
        );
        let last = found.contacts.first().unwrap().end.unwrap();
        // the contact ends between one step, 6e-4 of the round trip, before the round trip and
        // several steps after it, because the rest of the front travels to and fro
        assert!(
            (-6e-4..5e-3).contains(&(last / round_trip - 1.0)),
            "{length}: {:?}",
            found.contacts
        );
    }
}

/// Impact of a nylon rod with a loss factor from 1e-9 to 10: the force is finite and compressive,
/// and the rod is passive.
#[test]
fn loss_factors_from_nothing_to_ten() {
    for loss_factor in [1e-9, 1e-3, 0.5, 10.0] {
        let found = Impact::between(&lossy_rod(0.02, 0.3, loss_factor), &long_rod(1e3))
            .at_velocity(1.0)
            .predict(2e-3)
            .unwrap();
        assert!(
            found
                .history
                .force()
                .iter()
                .all(|f| f.is_finite() && *f >= 0.0),
            "{loss_factor}"
        );
        assert!(
            found.balance().energy_residual.abs() < 1e-9,
            "{loss_factor}"
        );
        assert!(
            found.balance().inner[0] >= 0.0,
            "{loss_factor}: {:?}",
            found.balance()
        );
    }
}

/// A window that extends beyond the record has the errors of its part inside the record.
#[test]
fn a_window_beyond_the_record_keeps_its_errors() {
    let force: Vec<f64> = (0..60).map(|n| if n < 20 { 0.0 } else { 500.0 }).collect();
    let history = ForceHistory::new(0.0, 1e-3, force.clone()).unwrap();
    let measured: Vec<f64> = force.iter().map(|f| 1.02 * f + 1.0).collect();
    let blow = CalibrationBlow {
        reconstructed: &history,
        measured: &measured,
        standard_error: None,
    };
    let scatter = CalibrationScatter::of(&[blow; 3], 0..60).unwrap();
    let errors = |window: Range<usize>| {
        scatter
            .error(&history, window, None)
            .standard_error()
            .to_vec()
    };
    assert_eq!(errors(10..60), errors(10..usize::MAX));
    assert!(errors(10..1000)[30] > 1.0);
    assert!(errors(100..1000).iter().all(|e| *e == 0.0));
    let huge = ForceHistory::new(0.0, 1e-3, force.iter().map(|f| f * 1e300).collect()).unwrap();
    let blow = CalibrationBlow {
        reconstructed: &huge,
        measured: &measured,
        standard_error: None,
    };
    assert!(matches!(
        CalibrationScatter::of(&[blow; 3], 0..60),
        Err(ImpulseError::OutOfRange { .. })
    ));
}
