//! Sources of draws of an impact: errors of its bodies, contact and velocity.

use std::fmt;
use std::sync::Arc;

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use crate::error::{check_not_negative, check_positive};
use crate::{ContactLaw, ImpactBody, ImpulseError};

/// Default number of draws: the standard deviation is then known to 5 %.
pub(super) const DRAWS: usize = 200;

/// A body that can be shared between threads.
pub type SharedBody = Arc<dyn ImpactBody + Send + Sync>;

/// One draw of an impact. A quantity that is `None` keeps its stated value.
#[derive(Clone, Default)]
pub struct DrawnImpact {
    /// The bodies.
    pub bodies: [Option<SharedBody>; 2],
    /// The contact law.
    pub law: Option<ContactLaw>,
    /// The relative velocity V [m/s].
    pub velocity: Option<f64>,
}

/// Source of the uncertainty of an impact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImpactSource {
    /// The first body.
    FirstBody,
    /// The second body.
    SecondBody,
    /// The contact law.
    Contact,
    /// The velocity.
    Velocity,
}

impl ImpactSource {
    pub(super) const ALL: [Self; 4] = [
        Self::FirstBody,
        Self::SecondBody,
        Self::Contact,
        Self::Velocity,
    ];
}

impl DrawnImpact {
    /// Returns true for a `source` that this draw changes, the velocity from `velocity`.
    pub(super) fn changes(&self, source: ImpactSource, velocity: f64) -> bool {
        let [first, second] = &self.bodies;
        match source {
            ImpactSource::FirstBody => first.is_some(),
            ImpactSource::SecondBody => second.is_some(),
            ImpactSource::Contact => self.law.is_some(),
            ImpactSource::Velocity => {
                let changed = |drawn: f64| (drawn - velocity).abs() > 0.0;
                self.velocity.is_some_and(changed)
            }
        }
    }
}

impl fmt::Debug for DrawnImpact {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let domain = |body: &Option<SharedBody>| body.as_ref().map(|body| body.domain());
        formatter
            .debug_struct("DrawnImpact")
            .field("bodies", &self.bodies.each_ref().map(domain))
            .field("law", &self.law)
            .field("velocity", &self.velocity)
            .finish()
    }
}

/// A source of draws of an uncertain impact; [`ImpactErrors`] is the source for errors that are
/// independent of each other.
pub trait ImpactDraws {
    /// Error of a draw.
    type Error: From<ImpulseError>;

    /// Number of draws; with fewer than 2 no errors are computed.
    fn n_draws(&self) -> usize;

    /// Returns the next draw of an impact that is stated at `velocity` [m/s].
    ///
    /// # Errors
    ///
    /// An error ends the prediction.
    fn draw(&mut self, velocity: f64) -> Result<DrawnImpact, Self::Error>;

    /// Checks whether the prediction is cancelled. It is called between marches; an error ends a
    /// long prediction.
    ///
    /// # Errors
    ///
    /// An error ends the prediction.
    fn check_cancelled(&self) -> Result<(), Self::Error> {
        Ok(())
    }
}

/// A function that draws a body or a contact law.
type Draw<'a, T> = Box<dyn Fn(&mut dyn Rng) -> Result<T, ImpulseError> + 'a>;

/// Errors of an impact that are independent of each other.
///
/// ```
/// use std::sync::Arc;
///
/// use impulse::rand::RngExt;
/// use impulse::{Impact, ImpactErrors, MobilityLaw};
///
/// # fn main() -> Result<(), impulse::ImpulseError> {
/// // a long rod of impedance 1000 kg/s ± 2 % and a mass of 0.5 kg
/// let rod = |impedance: f64| MobilityLaw::analytic(move |_| (1.0 / impedance).into());
/// let mass = MobilityLaw::analytic(|s| 1.0 / (0.5 * s)).free(0.5)?;
/// let long = rod(1000.0);
/// let errors = ImpactErrors::of_velocity(0.01).with_second(move |random| {
///     let standard: f64 = (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
///     Ok(Arc::new(rod(1000.0 + 20.0 * standard)))
/// });
/// let force = Impact::between(&mass, &long).at_velocity(2.0).with_errors(errors).predict(4e-3)?;
/// // near Z V = 2000 N in the band up to 10 kHz, with the errors of both: 2 % and 0.5 %
/// let peak = force.peak();
/// assert!(peak.force > 1800.0 && peak.force < 2000.0);
/// assert!((peak.standard_error / peak.force / 0.0206 - 1.0).abs() < 0.2);
/// # Ok(())
/// # }
/// ```
pub struct ImpactErrors<'a> {
    velocity: f64,
    bodies: [Option<Draw<'a, SharedBody>>; 2],
    law: Option<Draw<'a, ContactLaw>>,
    n_draws: usize,
    random: ChaCha8Rng,
}

impl fmt::Debug for ImpactErrors<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let drawn = self.bodies.each_ref().map(Option::is_some);
        formatter
            .debug_struct("ImpactErrors")
            .field("velocity", &self.velocity)
            .field("bodies_drawn", &drawn)
            .field("law_drawn", &self.law.is_some())
            .field("n_draws", &self.n_draws)
            .finish_non_exhaustive()
    }
}

impl<'a> ImpactErrors<'a> {
    /// Creates the errors of an impact with an uncertain velocity alone, with this `standard_error`
    /// [m/s].
    #[must_use]
    pub fn of_velocity(standard_error: f64) -> Self {
        Self {
            velocity: standard_error,
            bodies: [None, None],
            law: None,
            n_draws: DRAWS,
            random: ChaCha8Rng::seed_from_u64(1),
        }
    }

    /// Sets the draws of the first body, for example by
    /// [`MeasuredBody::drawn`](crate::MeasuredBody::drawn).
    #[must_use]
    pub fn with_first(
        mut self,
        draw: impl Fn(&mut dyn Rng) -> Result<SharedBody, ImpulseError> + 'a,
    ) -> Self {
        self.bodies[0] = Some(Box::new(draw));
        self
    }

    /// Sets the draws of the second body.
    #[must_use]
    pub fn with_second(
        mut self,
        draw: impl Fn(&mut dyn Rng) -> Result<SharedBody, ImpulseError> + 'a,
    ) -> Self {
        self.bodies[1] = Some(Box::new(draw));
        self
    }

    /// Sets the draws of the contact law.
    #[must_use]
    pub fn with_contact(
        mut self,
        draw: impl Fn(&mut dyn Rng) -> Result<ContactLaw, ImpulseError> + 'a,
    ) -> Self {
        self.law = Some(Box::new(draw));
        self
    }

    /// Sets the number of draws, 200 by default, and their seed, 1 by default.
    #[must_use]
    pub fn in_draws(self, n_draws: usize, seed: u64) -> Self {
        Self {
            n_draws,
            random: ChaCha8Rng::seed_from_u64(seed),
            ..self
        }
    }
}

impl ImpactDraws for ImpactErrors<'_> {
    type Error = ImpulseError;

    fn n_draws(&self) -> usize {
        let is_exact = self.velocity.abs() <= 0.0 && self.bodies.iter().all(Option::is_none);
        if is_exact && self.law.is_none() {
            0
        } else {
            self.n_draws
        }
    }

    fn draw(&mut self, velocity: f64) -> Result<DrawnImpact, ImpulseError> {
        let error =
            check_not_negative("standard error of the impact velocity [m/s]", self.velocity)?;
        let [first, second] = &self.bodies;
        let random = &mut self.random;
        let mut body = |draw: &Option<Draw<'_, SharedBody>>| {
            draw.as_ref().map(|draw| draw(random)).transpose()
        };
        let bodies = [body(first)?, body(second)?];
        let law = self.law.as_ref().map(|draw| draw(random)).transpose()?;
        let standard: f64 = random.sample(StandardNormal);
        let drawn = velocity + error * standard;
        Ok(DrawnImpact {
            bodies,
            law,
            velocity: Some(check_positive("drawn impact velocity [m/s]", drawn)?),
        })
    }
}
