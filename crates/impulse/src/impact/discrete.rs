//! An impact in discrete time.

use super::continuation::{EverySecond, Known};
use super::{DrawnImpact, ImpactSource, Prediction, check_mass, kernel_of};
use crate::error::check_positive;
use crate::unilateral::March;
use crate::{ContactLaw, Domain, ForceHistory, ImpactBody, ImpulseError, Kernel};

/// Ratio of the mobilities over a decade below which two faces count as masses.
const RIGID: f64 = 0.2;

/// Relative change over a decade of frequency below which the mobility of a face counts as that of
/// a plane wave, $`1/Z`$.
const PLANE: f64 = 1e-4;

/// Start of the force without a band limit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum FirstForce {
    /// Continuous from zero: the contact or a face is compliant.
    Continuous,
    /// Jump to the plane-wave value $`V/(1/Z_1 + 1/Z_2)`$ \[N\].
    Jump(f64),
    /// Unbounded: the impedance of a face grows with frequency without limit, as for a constant
    /// loss factor, and the largest force depends on the time step. Only the force in a band is
    /// defined.
    Unbounded,
}

/// Part of the lines of measured bodies that is left out to find its effect.
#[derive(Debug, Clone, Copy)]
pub(super) enum Less {
    /// The echoes above the lines.
    Echoes,
    /// The upper third of the lines, which is replaced by the continuation of the echoes.
    UpperLines,
    EverySecondLine,
}

/// Properties of a face of a body, other than its kernel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    /// Mass of a free body \[kg\].
    mass: Option<f64>,
    is_measured: bool,
}

impl Face {
    pub(super) fn of(body: &dyn ImpactBody) -> Self {
        Self {
            mass: body.free_mass(),
            is_measured: matches!(body.domain(), Domain::Lines { .. }),
        }
    }
}

/// The kernels of two bodies and their contact law; created by
/// [`Impact::discretised`](crate::Impact::discretised).
///
/// ```
/// use impulse::{Impact, MobilityLaw};
///
/// # fn main() -> Result<(), impulse::ImpulseError> {
/// let mass = MobilityLaw::analytic(|s| 1.0 / (0.5 * s)).free(0.5)?;
/// let rod = MobilityLaw::analytic(|_| num_complex::Complex64::from(1e-3));
/// let at_one = Impact::between(&mass, &rod).at_velocity(1.0).discretised(1e-3)?;
/// let slow = at_one.predict()?;
/// let fast = at_one.at_velocity(2.0).predict()?;
/// assert!((fast.peak().force / slow.peak().force - 2.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct DiscreteImpact {
    velocity: f64,
    faces: [Face; 2],
    kernels: [Kernel; 2],
    /// Sum of both kernels.
    kernel: Vec<f64>,
    law: ContactLaw,
    /// The contact law as it was given, without springs at the faces.
    given_law: ContactLaw,
    /// Compliance \[m/N\] of springs at the faces, which are part of `kernel` and not of the law.
    springs: f64,
    /// Mobility \[m/(N s)\] of both faces far above the band, and a decade higher.
    beyond: [f64; 2],
}

impl DiscreteImpact {
    /// Creates the impact from the kernels of both bodies on one grid.
    pub(super) fn new(
        velocity: f64,
        faces: [Face; 2],
        kernels: [Kernel; 2],
        law: &ContactLaw,
    ) -> Result<Self, ImpulseError> {
        let [near, far] = [
            kernels[0].front().near + kernels[1].front().near,
            kernels[0].front().far + kernels[1].front().far,
        ];
        let compliance = kernels[0].face_compliance() + kernels[1].face_compliance();
        let mut kernel: Vec<f64> = kernels[0]
            .weights()
            .iter()
            .zip(kernels[1].weights())
            .map(|(first, second)| first + second)
            .collect();
        let mut springs = 0.0;
        let given_law = law.clone();
        let law = match law {
            law if compliance <= 0.0 => law.clone(),
            ContactLaw::Rigid => ContactLaw::linear(1.0 / compliance)?,
            ContactLaw::Linear { stiffness } => {
                ContactLaw::linear(1.0 / (compliance + 1.0 / stiffness))?
            }
            law => {
                // the spring in series is discretised by backward differences, which is the only
                // part of the scheme of first order
                let jump = compliance / kernels[0].grid().time_step;
                for (weight, change) in kernel.iter_mut().zip([jump, -jump]) {
                    *weight += change;
                }
                springs = compliance;
                law.clone()
            }
        };
        if law == ContactLaw::Rigid && far < RIGID * near {
            return Err(ImpulseError::RigidFaces { ratio: far / near });
        }
        Ok(Self {
            velocity,
            faces,
            kernels,
            kernel,
            law,
            given_law,
            springs,
            beyond: [near, far],
        })
    }

    /// Sets another relative `velocity` V \[m/s\], which must be above 0.
    #[must_use]
    pub fn at_velocity(&self, velocity: f64) -> Self {
        Self {
            velocity,
            ..self.clone()
        }
    }

    /// Replaces the `source` by that of the `other` impact, which is on the same grid.
    pub(super) fn with_source_of(
        &self,
        other: &Self,
        source: ImpactSource,
    ) -> Result<Self, ImpulseError> {
        let (mut faces, mut kernels, mut law) = (self.faces, self.kernels.clone(), &self.given_law);
        match source {
            ImpactSource::FirstBody => {
                faces[0] = other.faces[0];
                kernels[0].clone_from(&other.kernels[0]);
            }
            ImpactSource::SecondBody => {
                faces[1] = other.faces[1];
                kernels[1].clone_from(&other.kernels[1]);
            }
            ImpactSource::Contact => law = &other.given_law,
            ImpactSource::Velocity => return Ok(self.at_velocity(other.velocity)),
        }
        Self::new(self.velocity, faces, kernels, law)
    }

    /// Replaces the drawn bodies, law and velocity; the kernel of a body that is not drawn is kept.
    pub(super) fn replaced(&self, drawn: &DrawnImpact) -> Result<Self, ImpulseError> {
        let velocity = drawn.velocity.unwrap_or(self.velocity);
        if drawn.bodies.iter().all(Option::is_none) && drawn.law.is_none() {
            return Ok(self.at_velocity(velocity));
        }
        let law = drawn.law.as_ref().unwrap_or(&self.given_law);
        law.check()?;
        let (mut faces, mut kernels) = (self.faces, self.kernels.clone());
        let of_bodies = faces.iter_mut().zip(&mut kernels);
        let drawn = drawn.bodies.iter().zip(["first", "second"]);
        for ((face, kernel), (body, name)) in of_bodies.zip(drawn) {
            if let Some(body) = body {
                let (grid, quadrature) = (kernel.grid(), kernel.quadrature());
                check_mass(name, body.as_ref(), grid.time_step * grid.n_steps as f64)?;
                *face = Face::of(body.as_ref());
                *kernel = kernel_of(body.as_ref(), grid, quadrature, Known::All)?;
            }
        }
        Self::new(velocity, faces, kernels, law)
    }

    /// Returns the impact of the same `bodies` with a part of the lines of measured bodies left
    /// out; `None` if no body is measured.
    pub(super) fn with_less(
        &self,
        bodies: [&dyn ImpactBody; 2],
        less: Less,
    ) -> Result<Option<Self>, ImpulseError> {
        if self.faces.iter().all(|face| !face.is_measured) {
            return Ok(None);
        }
        let mut kernels = self.kernels.clone();
        for (kernel, (body, face)) in kernels.iter_mut().zip(bodies.into_iter().zip(self.faces)) {
            if face.is_measured {
                let (grid, quadrature) = (kernel.grid(), kernel.quadrature());
                *kernel = match less {
                    Less::Echoes => Kernel::of(body, grid, quadrature)?,
                    Less::UpperLines => kernel_of(body, grid, quadrature, Known::Lower)?,
                    Less::EverySecondLine => {
                        kernel_of(&EverySecond(body), grid, quadrature, Known::All)?
                    }
                };
            }
        }
        Self::new(self.velocity, self.faces, kernels, &self.given_law).map(Some)
    }

    /// Computes force, contacts and balance; see [`Impact::predict`](crate::Impact::predict).
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the velocity; [`ImpulseError::ActiveFaces`];
    /// [`ImpulseError::Diverged`].
    pub fn predict(&self) -> Result<Prediction, ImpulseError> {
        let marched = self.march()?.run()?;
        Prediction::new(self, marched)
    }

    /// Computes the force between faces that stick; see
    /// [`Impact::stick_force`](crate::Impact::stick_force).
    ///
    /// # Errors
    ///
    /// The errors of [`DiscreteImpact::predict`].
    pub fn stick_force(&self) -> Result<ForceHistory, ImpulseError> {
        let force = self.march()?.run_sticking()?;
        self.history(force)
    }

    /// Start of the force without a band limit.
    #[must_use]
    pub fn first_force(&self) -> FirstForce {
        let [near, far] = self.beyond;
        match self.law {
            ContactLaw::Rigid if far < near * (1.0 - PLANE) => FirstForce::Unbounded,
            ContactLaw::Rigid if far > near * (1.0 + PLANE) => FirstForce::Continuous,
            ContactLaw::Rigid => FirstForce::Jump(self.velocity / near),
            _ => FirstForce::Continuous,
        }
    }

    /// The kernels of the first and of the second body.
    #[must_use]
    pub fn kernels(&self) -> &[Kernel; 2] {
        &self.kernels
    }

    pub(super) fn velocity(&self) -> f64 {
        self.velocity
    }

    pub(super) fn masses(&self) -> [Option<f64>; 2] {
        self.faces.map(|face| face.mass)
    }

    /// True for each body that is measured.
    pub(super) fn measured(&self) -> [bool; 2] {
        self.faces.map(|face| face.is_measured)
    }

    pub(super) fn springs(&self) -> f64 {
        self.springs
    }

    /// Response of both faces in the first step [m/(N s)].
    pub(super) fn first_weight(&self) -> f64 {
        self.kernel.first().copied().unwrap_or(0.0)
    }

    fn march(&self) -> Result<March<'_>, ImpulseError> {
        Ok(March {
            kernel: &self.kernel,
            time_step: self.kernels[0].grid().time_step,
            velocity: check_positive("impact velocity [m/s]", self.velocity)?,
            law: &self.law,
        })
    }

    /// Creates a history with forces at the middle of their steps. This also applies to convolution
    /// quadrature, in whose rules the velocity step of time 0 acts half a step earlier.
    pub(super) fn history(&self, force: Vec<f64>) -> Result<ForceHistory, ImpulseError> {
        let time_step = self.kernels[0].grid().time_step;
        ForceHistory::new(0.5 * time_step, time_step, force)
    }
}
