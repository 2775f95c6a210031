//! Wrong requests are refused with the reason; none of them yields a force.

use impulse::{
    ContactLaw, Impact, ImpactBody, ImpulseError, Kernel, LineBand, LowFrequency, MeasuredBody,
    MobilityLaw, PredictionFlag, Quadrature, TimeGrid, WeighedMass,
};
use num_complex::Complex64;
use rodwave::chain::{Chain, Termination};

use crate::bodies::{circle, long_rod, mass, nylon_rod, rod, steel, wall};

const DURATION: f64 = 1e-3;

fn refusal(first: &dyn ImpactBody, second: &dyn ImpactBody) -> ImpulseError {
    Impact::between(first, second)
        .at_velocity(1.0)
        .predict(DURATION)
        .unwrap_err()
}

#[test]
fn velocities_times_and_steps() {
    let (first, second) = (mass(0.5), long_rod(1e3));
    let pair = Impact::between(&first, &second);
    for velocity in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
        let impact = pair.at_velocity(velocity);
        let wrong = |error: ImpulseError| {
            matches!(
                error,
                ImpulseError::NonPhysical {
                    quantity: "impact velocity [m/s]",
                    ..
                }
            )
        };
        assert!(wrong(impact.predict(DURATION).unwrap_err()));
        assert!(wrong(impact.stick_force(DURATION).unwrap_err()));
        assert!(wrong(
            impact.stick_force_damped(DURATION, 1e-6).unwrap_err()
        ));
        assert!(wrong(
            impact.stick_force_on_lines(LineBand::PAPER_E).unwrap_err()
        ));
    }
    let impact = pair.at_velocity(1.0);
    for duration in [-1.0, 0.0, f64::NAN] {
        assert!(impact.predict(duration).is_err());
    }
    for step in [-1e-6, 0.0, f64::NAN, 1.0, 1e-12] {
        assert!(
            impact.clone().in_steps_of(step).predict(DURATION).is_err(),
            "{step}"
        );
    }
    let odd = LineBand {
        highest_hz: 1e4,
        n_samples: 2047,
    };
    assert_eq!(
        impact.stick_force_on_lines(odd).unwrap_err().to_string(),
        "number of samples is 2047, expected an even number above 2"
    );
}

#[test]
fn masses_that_contradict_the_mobility() {
    let lighter = MobilityLaw::analytic(|s: Complex64| 1.0 / (0.5 * s))
        .free(0.4)
        .unwrap();
    assert!(matches!(
        refusal(&lighter, &long_rod(1e3)),
        ImpulseError::MassContradictsMobility { body: "first", found, expected }
            if (found - 0.5).abs() < 1e-9 && (expected - 0.4).abs() < 1e-9
    ));
    let unweighed = MobilityLaw::analytic(|s: Complex64| 1.0 / (0.5 * s));
    assert!(matches!(
        refusal(&long_rod(1e3), &unweighed),
        ImpulseError::MassContradictsMobility { body: "second", .. }
    ));
}

#[test]
fn methods_outside_their_domain() {
    let (nylon, rod_of_steel) = (nylon_rod(0.03, 0.3), rod(0.01, 0.3));
    let impact = Impact::between(&nylon, &rod_of_steel).at_velocity(1.0);
    // the power laws of paper E, eq. 7, are known on the frequency axis only
    for error in [
        impact.stick_force_damped(DURATION, 1e-6).unwrap_err(),
        impact
            .clone()
            .by(Quadrature::Bdf2)
            .predict(DURATION)
            .unwrap_err(),
    ] {
        assert!(
            matches!(error, ImpulseError::OutsideDomain { .. }),
            "{error}"
        );
    }
    // a free elastic body on the frequency axis rings longer than any period
    let chain = Chain::from_impact_face()
        .rod(&steel(), circle(0.01), 0.3)
        .end(Termination::Free)
        .unwrap();
    let outcome = Impact::between(&chain, &long_rod(1e3))
        .at_velocity(1.0)
        .predict(DURATION);
    // a line on a pole is refused; if there is none, the lines next to the poles are flagged as
    // acausal
    assert!(
        outcome.is_err()
            || outcome.is_ok_and(|prediction| {
                prediction
                    .flags
                    .iter()
                    .any(|flag| matches!(flag, PredictionFlag::Acausal { body: 0, .. }))
            })
    );
}

#[test]
fn bodies_that_make_energy() {
    let active = MobilityLaw::analytic(|_| Complex64::from(-2e-3));
    let error = refusal(&mass(0.5), &active);
    assert!(
        matches!(error, ImpulseError::ActiveFaces { weight, .. } if weight < 0.0),
        "{error}"
    );
    // active near its resonance only: the prediction is flagged or stopped, and no force is NaN
    let growing = MobilityLaw::on_axis(|s| 1e-3 - 4.0 * s / (s * s + 800.0 * s + 1e9));
    match Impact::between(&mass(0.5), &growing)
        .at_velocity(1.0)
        .predict(20e-3)
    {
        Ok(prediction) => {
            assert!(
                prediction
                    .flags
                    .iter()
                    .any(|flag| matches!(flag, PredictionFlag::Active { body: 1, .. }))
            );
            assert!(
                prediction
                    .history
                    .force()
                    .iter()
                    .all(|force| force.is_finite())
            );
        }
        Err(error) => assert!(matches!(error, ImpulseError::Diverged { .. }), "{error}"),
    }
    let broken = MobilityLaw::analytic(|_| Complex64::new(f64::NAN, 0.0));
    assert!(matches!(
        refusal(&mass(0.5), &broken),
        ImpulseError::InfiniteMobility { .. }
    ));
    let infinite = MobilityLaw::analytic(|_| Complex64::new(f64::INFINITY, 0.0));
    assert!(matches!(
        refusal(&mass(0.5), &infinite),
        ImpulseError::InfiniteMobility { .. }
    ));
}

#[test]
fn measured_bodies_on_other_grids() {
    let lines = |step_hz: f64| -> MeasuredBody {
        let mobility: Vec<Complex64> = (0..2000)
            .map(|line| {
                let s = Complex64::new(0.0, std::f64::consts::TAU * step_hz * f64::from(line));
                if line == 0 {
                    Complex64::ZERO
                } else {
                    1.0 / (0.5 * s) + 1e-3
                }
            })
            .collect();
        let low = LowFrequency::Free(WeighedMass {
            mass: 0.5,
            standard_error: 1e-4,
        });
        MeasuredBody::from_mobility(&mobility, step_hz, low)
            .unwrap()
            .with_front_impedance(1e3)
            .unwrap()
    };
    let (first, second) = (lines(10.0), lines(12.5));
    let pair = Impact::between(&first, &second).at_velocity(1.0);
    let band = LineBand {
        highest_hz: 1e4,
        n_samples: 2000,
    };
    assert_eq!(
        pair.stick_force_on_lines(band).unwrap_err().to_string(),
        "the lines of the measured body are 12.5 Hz apart, expected 10 Hz as for the other body"
    );
    // the march accepts lines of different spacing, but the period of each body must be a whole
    // number of steps
    assert!(pair.clone().in_steps_of(1e-5).predict(10e-3).is_ok());
    assert!(matches!(
        pair.clone().in_steps_of(3e-5).predict(10e-3),
        Err(ImpulseError::NonPhysical { value, expected: "a whole number", .. })
            if (value - 1e4 / 3.0).abs() < 1e-6
    ));
    // the period must be at least twice the duration: its second half is the time before the
    // impulse
    let long = pair.in_steps_of(1e-5).predict(60e-3).unwrap_err();
    assert_eq!(
        long.to_string(),
        "the period of the measured lines, in time steps, has 10000 elements, expected at least 12000"
    );
}

#[test]
fn a_kernel_knows_what_gives_way_at_its_face() {
    let grid = TimeGrid {
        time_step: 1e-6,
        n_steps: 256,
    };
    let kernel = Kernel::of(&rod(0.01, 0.3), grid, Quadrature::CellAverages).unwrap();
    // before time 0 the kernel of an analytic body contains only the alias of the next period,
    // 1.5e-8
    assert!(kernel.acausal() < 1e-7 * kernel.weights()[0]);
    assert!(kernel.face_compliance().abs() < f64::MIN_POSITIVE);
    let spring = MobilityLaw::analytic(|s| 1e-3 + s / 1e7);
    let kernel = Kernel::of(&spring, grid, Quadrature::CellAverages).unwrap();
    assert!((kernel.face_compliance() * 1e7 - 1.0).abs() < 1e-9);
    let one = TimeGrid { n_steps: 1, ..grid };
    assert!(Kernel::of(&rod(0.01, 0.3), one, Quadrature::Bdf2).is_err());
}

#[test]
fn a_spring_at_a_face_and_a_curved_contact_share_the_approach() {
    // the spring at the face is discretised with an error of first order; the reference contains
    // the same spring exactly, as a part of the contact curve
    let ground = MobilityLaw::analytic(|s: Complex64| s / 1e7);
    let striker = mass(0.2);
    let both = Impact::between(&striker, &ground)
        .at_velocity(1.0)
        .through(ContactLaw::hertz(5e9).unwrap())
        .predict(DURATION)
        .unwrap();
    assert!(
        both.balance().energy_residual.abs() < 1e-6,
        "{:?}",
        both.balance()
    );
    let curve: Vec<(f64, f64)> = (0..=2000)
        .map(|n| {
            let force = 4000.0 * (f64::from(n) / 2000.0).powi(3);
            ((force / 5e9).powf(2.0 / 3.0) + force / 1e7, force)
        })
        .collect();
    let exact = Impact::between(&striker, &wall())
        .at_velocity(1.0)
        .through(ContactLaw::Tabulated(
            impulse::TabulatedContact::new(&curve).unwrap(),
        ))
        .predict(DURATION)
        .unwrap();
    // tolerance: half a step of 0.24 us relative to a contact of half a millisecond, with a margin
    assert!((both.peak().force / exact.peak().force - 1.0).abs() < 2e-3);
    assert!((both.duration() / exact.duration() - 1.0).abs() < 2e-3);
}
