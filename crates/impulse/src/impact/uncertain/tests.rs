//! Errors of an impact against closed forms.

use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::*;
use crate::impact::ImpactErrors;
use crate::{ContactLaw, ImpactBody, MobilityLaw};

const MASS: f64 = 0.5;
const IMPEDANCE: f64 = 1000.0;
const VELOCITY: f64 = 2.0;
/// Tolerance: three times 9 %, the relative error of a standard deviation from 60 draws.
const OF_DRAWS: f64 = 0.28;

fn mass() -> impl ImpactBody + Send + Sync {
    MobilityLaw::analytic(|s| 1.0 / (MASS * s))
        .free(MASS)
        .unwrap()
}

fn rod(impedance: f64) -> impl ImpactBody + Send + Sync {
    MobilityLaw::analytic(move |_| (1.0 / impedance).into())
}

fn wall() -> impl ImpactBody + Send + Sync {
    MobilityLaw::analytic(|_| 0.0.into())
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{found} for {expected}"
    );
}

/// Without errors the march is that of a plain prediction, and there is no band.
#[test]
fn without_errors_the_march_is_the_plain_one() {
    let (mass, rod) = (mass(), rod(IMPEDANCE));
    let impact = Impact::between(&mass, &rod)
        .at_velocity(VELOCITY)
        .in_steps_of(1e-6);
    let plain = impact.predict(2e-3).unwrap();
    let found = impact
        .with_errors(ImpactErrors::of_velocity(0.0))
        .predict(2e-3)
        .unwrap();
    assert_eq!(found.prediction.history, plain.history);
    assert!(found.spread.is_none() && found.errors().is_none());
    assert!(found.simultaneous(0.95).unwrap().is_none());
    // only the error of the step remains, which is of second order for a smooth force
    let peak = found.peak();
    assert!(peak.standard_error < 1e-3 * peak.force);
    close(
        peak.expanded_uncertainty(0.95).unwrap(),
        1.96 * peak.standard_error,
        1e-4,
    );
    assert!(peak.expanded_uncertainty(1.0).is_err());
}

/// Every force is proportional to the velocity, at all times together: the factor of the band is
/// that of one normal variable, and the restitution has no error.
#[test]
fn an_error_of_the_velocity_scales_the_force() {
    let (mass, rod) = (mass(), rod(IMPEDANCE));
    let found = Impact::between(&mass, &rod)
        .at_velocity(VELOCITY)
        .with_errors(ImpactErrors::of_velocity(0.03 * VELOCITY).in_draws(200, 4))
        .predict(2e-3)
        .unwrap();
    let (numbers, errors) = (found.numbers(), found.errors().unwrap());
    for (value, error) in [
        (numbers.peak, errors.peak),
        (numbers.limited_peak, errors.limited_peak),
        (numbers.impulse, errors.impulse),
    ] {
        // tolerance: three times 5 %, the relative error of a standard deviation from 200 draws
        close(error.unwrap() / value.unwrap(), 0.03, 0.15);
    }
    let spread = found.spread.as_ref().unwrap();
    // tolerance: the 95 % quantile of 200 draws has a standard error of 6 %
    close(spread.simultaneous_factor(0.95), 1.96, 0.18);
    let band = found.simultaneous(0.95).unwrap().unwrap();
    let at = found.limited.index_near(5e-4).unwrap();
    let half = 0.5 * (band.upper[at] - band.lower[at]);
    close(half / found.limited.force()[at], 0.0588, 0.25);
}

/// F = Z V exp(-Zt/M): an error of the velocity scales it, and an error of the impedance changes it
/// by the relative amount 1 - Zt/M. The squares of the errors from the sources add up to the square
/// of the whole error.
#[test]
fn the_sources_of_a_band_are_those_of_the_closed_form() {
    let (mass, long) = (mass(), rod(IMPEDANCE));
    let errors = ImpactErrors::of_velocity(0.02 * VELOCITY).with_second(|random| {
        let standard: f64 = random.sample(StandardNormal);
        Ok(Arc::new(rod(IMPEDANCE * (1.0 + 0.03 * standard))))
    });
    let found = Impact::between(&mass, &long)
        .at_velocity(VELOCITY)
        .with_errors(errors)
        .predict(4e-3)
        .unwrap();
    let spread = found.spread.as_ref().unwrap();
    let of: Vec<ImpactSource> = spread.parts.iter().map(|(source, _)| *source).collect();
    assert_eq!(of, [ImpactSource::SecondBody, ImpactSource::Velocity]);
    for time in [0.2e-3, 0.5e-3, 1.5e-3] {
        let at = found.limited.index_near(time).unwrap();
        let force = IMPEDANCE * VELOCITY * (-IMPEDANCE * time / MASS).exp();
        let exact = [0.03 * (1.0 - IMPEDANCE * time / MASS).abs(), 0.02];
        for ((_, part), exact) in spread.parts.iter().zip(exact) {
            // tolerance: three times 10 %, the relative error of a standard deviation from 48
            // draws; near t = M/Z the effects of second order remain
            assert!(
                (part[at] / force - exact).abs() < 0.3 * exact + 1e-3,
                "{time}: {exact}"
            );
        }
        let sum = spread.parts[0].1[at].hypot(spread.parts[1].1[at]);
        close(sum, spread.limited[at], 0.35);
    }
}

/// A mass on a spring before a wall: the peak is V √(kM), and the contact lasts π √(M/k), even if
/// the step that resolves the band is as long as the contact.
#[test]
fn an_error_of_the_contact_is_that_of_its_closed_form() {
    for highest_hz in [10e3, 80.0] {
        contact_with_an_error(BandLimit::up_to(highest_hz).unwrap());
    }
}

fn contact_with_an_error(band: BandLimit) {
    let (mass, wall) = (mass(), wall());
    let stiffness = 2e6;
    let errors = ImpactErrors::of_velocity(0.0)
        .with_contact(|random| {
            let standard: f64 = random.sample(StandardNormal);
            ContactLaw::linear(stiffness * (1.0 + 0.04 * standard))
        })
        .in_draws(60, 7);
    let found = Impact::between(&mass, &wall)
        .at_velocity(VELOCITY)
        .through(ContactLaw::linear(stiffness).unwrap())
        .with_errors(errors)
        .in_band(band)
        .predict(4e-3)
        .unwrap();
    let (numbers, errors) = (found.numbers(), found.errors().unwrap());
    let peak = VELOCITY * f64::sqrt(stiffness * MASS);
    close(numbers.peak.unwrap(), peak, 1e-3);
    close(errors.peak.unwrap(), 0.02 * peak, OF_DRAWS);
    let end = std::f64::consts::PI * f64::sqrt(MASS / stiffness);
    close(numbers.end.unwrap(), end, 1e-3);
    close(errors.end.unwrap(), 0.02 * end, OF_DRAWS);
    // the mass returns with its velocity, whatever the spring
    assert!(errors.restitution.unwrap() < 1e-3, "{errors:?}");
}

/// The force of a rigid mass on a semi-infinite rod fades without separation; a mass on a spring
/// before a wall separates.
#[test]
fn a_force_that_fades_has_no_end() {
    let (mass, rod, wall) = (mass(), rod(IMPEDANCE), wall());
    let on_rod = Impact::between(&mass, &rod).at_velocity(VELOCITY);
    assert!(on_rod.predict(10e-3).unwrap().fades());
    let before_wall = Impact::between(&mass, &wall)
        .at_velocity(VELOCITY)
        .through(ContactLaw::linear(2e6).unwrap());
    assert!(!before_wall.predict(4e-3).unwrap().fades());
}

/// Replacing one drawn body keeps the kernel of the other; the march equals that of a newly created
/// impact.
#[test]
fn a_drawn_body_replaces_its_own_kernel_only() {
    let (mass, stated) = (mass(), rod(IMPEDANCE));
    let other: Arc<dyn ImpactBody + Send + Sync> = Arc::new(rod(1.1 * IMPEDANCE));
    let impact = Impact::between(&mass, &stated).at_velocity(VELOCITY);
    let drawn = DrawnImpact {
        bodies: [None, Some(Arc::clone(&other))],
        ..Default::default()
    };
    let replaced = impact.discretised(1e-3).unwrap().replaced(&drawn).unwrap();
    let fresh = Impact::between(&mass, other.as_ref()).at_velocity(VELOCITY);
    let fresh = fresh.predict(1e-3).unwrap();
    assert_eq!(replaced.predict().unwrap().history, fresh.history);
}

/// Coverage of the 95 % interval of the peak: in 100 cases the velocity and the impedance of the
/// rod are measured with the stated errors, and the interval must contain the true jump Z V.
#[test]
fn the_interval_of_the_peak_covers() {
    let mass = mass();
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut normal = || -> f64 { random.sample(StandardNormal) };
    let cases = 100;
    let inside = (0..cases).filter(|case| {
        let impedance = IMPEDANCE * (1.0 + 0.02 * normal());
        let velocity = VELOCITY * (1.0 + 0.01 * normal());
        let measured = rod(impedance);
        let errors = ImpactErrors::of_velocity(0.01 * VELOCITY)
            .with_second(move |random| {
                let standard: f64 = random.sample(StandardNormal);
                Ok(Arc::new(rod(impedance + 0.02 * IMPEDANCE * standard)))
            })
            .in_draws(60, *case);
        let found = Impact::between(&mass, &measured)
            .at_velocity(velocity)
            .in_steps_of(4e-6)
            .with_errors(errors)
            .in_band(BandLimit::up_to(5e3).unwrap())
            .predict(1e-3)
            .unwrap();
        let jump = found.numbers().peak.unwrap();
        let error = found.errors().unwrap().peak.unwrap();
        let interval = PeakForce {
            force: jump,
            standard_error: error,
            ..found.peak()
        };
        let half = interval.expanded_uncertainty(0.95).unwrap();
        (jump - IMPEDANCE * VELOCITY).abs() < half
    });
    let inside = inside.count();
    // tolerance: three standard deviations of a binomial count
    assert!((89..=100).contains(&inside), "{inside} of {cases}");
}

/// Draws that end after the first march, like those of an interrupted job.
struct Interrupted;

impl ImpactDraws for Interrupted {
    type Error = ImpulseError;

    fn n_draws(&self) -> usize {
        10
    }

    fn draw(&mut self, _velocity: f64) -> Result<DrawnImpact, ImpulseError> {
        Ok(DrawnImpact::default())
    }

    fn check_cancelled(&self) -> Result<(), ImpulseError> {
        Err(ImpulseError::OutOfRange {
            what: "an interruption",
        })
    }
}

#[test]
fn what_cannot_be_drawn_ends_the_prediction() {
    let (mass, rod) = (mass(), rod(IMPEDANCE));
    let impact = || Impact::between(&mass, &rod).at_velocity(VELOCITY);
    let text = |errors: ImpactErrors<'_>| {
        let refused = impact().with_errors(errors).predict(1e-3);
        refused.unwrap_err().to_string()
    };
    assert_eq!(
        text(ImpactErrors::of_velocity(-0.1)),
        "standard error of the impact velocity [m/s] is -0.1, expected a finite value, 0 or above"
    );
    let wide = text(ImpactErrors::of_velocity(10.0 * VELOCITY));
    assert!(
        wide.starts_with("drawn impact velocity [m/s] is -"),
        "{wide}"
    );
    let interrupted = impact().with_errors(Interrupted).predict(1e-3);
    assert_eq!(
        interrupted.unwrap_err().to_string(),
        ImpulseError::OutOfRange {
            what: "an interruption"
        }
        .to_string()
    );
}
