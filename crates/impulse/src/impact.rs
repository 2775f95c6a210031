//! Impact of two bodies: the bodies, their velocity, the contact law and the numerical method.

mod continuation;
mod discrete;
mod errors;
mod numbers;
mod prediction;
mod spread;
mod uncertain;

use std::fmt;

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::synthesis::DampedSynthesis;

use crate::error::check_positive;
use crate::kernel::Kernel;
use crate::{
    ContactLaw, Domain, ForceHistory, ImpactBody, ImpulseError, Quadrature, StickForce,
    StickProblem, TimeGrid, ZeroLine, lines_of,
};

use continuation::{Continued, Known};
use discrete::Face;

pub use discrete::{DiscreteImpact, FirstForce};
pub use errors::{DrawnImpact, ImpactDraws, ImpactErrors, ImpactSource, SharedBody};
pub use numbers::ImpactNumbers;
pub use prediction::{Prediction, PredictionFlag};
pub use spread::Spread;
pub use uncertain::{PeakForce, UncertainImpact, UncertainPrediction};

/// Default number of steps of a prediction.
const DEFAULT_STEPS: usize = 4096;

/// Standard deviation, in intervals, of the Gaussian that smooths jumps in the damped transform:
/// 3e-14 of the spectrum remains at the Nyquist frequency.
const SMOOTHING: f64 = 2.5;

/// Largest relative difference between the stated mass of a body and the mass that its mobility
/// shows at low frequency.
const MASS_TOLERANCE: f64 = 1e-3;

/// Rate at which the mass is checked, multiplied by the duration.
const AT_REST: f64 = 1e-6;

/// Multiples of the rate of [`AT_REST`] at which the apparent mass of a body that is not free must
/// grow.
const NOT_AT_REST: [f64; 3] = [1.0, 10.0, 100.0];

/// Two bodies, described by their impact faces; created by [`Impact::between`].
#[derive(Clone, Copy)]
pub struct Pair<'a> {
    first: &'a dyn ImpactBody,
    second: &'a dyn ImpactBody,
}

/// An impact of the first body on the second, which is at rest (Ödeen 1993, paper E, Figure 1).
///
/// ```
/// use impulse::Impact;
/// use rodwave::chain::{AnalyticChain, Termination};
/// use rodwave::element::Circle;
/// use rodwave::medium::Medium;
/// use rodwave::modulus::Elastic;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // half a metre of steel rod on a long one of the same kind, 1 m/s
/// let steel = Medium::new(7780.0, Elastic::new(206e9)?)?;
/// let circle = Circle::of_diameter(0.010)?;
/// let striker = AnalyticChain::analytic_from_impact_face()
///     .rod(&steel, circle, 0.5)
///     .end(Termination::Free)?;
/// let long = AnalyticChain::analytic_from_impact_face()
///     .end(Termination::semi_infinite(&steel, circle))?;
///
/// let impact = Impact::between(&striker, &long).at_velocity(1.0).predict(0.5e-3)?;
/// // de Saint-Venant: Z V/2 for one round trip, and the striker stands still
/// assert!((impact.peak().force / 1572.1 - 1.0).abs() < 1e-3);
/// assert!((impact.duration() / 1.943e-4 - 1.0).abs() < 2e-3);
/// assert!(impact.balance().restitution.is_some_and(|e| e.abs() < 1e-3));
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Impact<'a> {
    first: &'a dyn ImpactBody,
    second: &'a dyn ImpactBody,
    velocity: f64,
    law: ContactLaw,
    quadrature: Quadrature,
    time_step: Option<f64>,
}

/// A band of lines for [`Impact::stick_force_on_lines`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineBand {
    /// Upper end \[Hz\].
    pub highest_hz: f64,
    /// Number of samples of the force over a period, an even number.
    pub n_samples: usize,
}

impl LineBand {
    /// The band of paper E: "Frequencies up to 10 kHz were used, and the number of samples was
    /// 2048" (Ödeen 1993, paper E, section 3.2).
    pub const PAPER_E: Self = Self {
        highest_hz: 10e3,
        n_samples: 2048,
    };
}

impl<'a> Pair<'a> {
    /// Sets the relative `velocity` V \[m/s\], which must be above 0.
    #[must_use]
    pub fn at_velocity(self, velocity: f64) -> Impact<'a> {
        Impact {
            first: self.first,
            second: self.second,
            velocity,
            law: ContactLaw::Rigid,
            quadrature: Quadrature::CellAverages,
            time_step: None,
        }
    }
}

impl fmt::Debug for Pair<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("Pair")
            .field("first", &self.first.domain())
            .field("second", &self.second.domain())
            .finish()
    }
}

impl fmt::Debug for Impact<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("Impact")
            .field("first", &self.first.domain())
            .field("second", &self.second.domain())
            .field("velocity", &self.velocity)
            .field("law", &self.law)
            .field("quadrature", &self.quadrature)
            .field("time_step", &self.time_step)
            .finish()
    }
}

impl<'a> Impact<'a> {
    /// Creates a pair of bodies, described by their impact faces.
    #[must_use]
    pub fn between(first: &'a dyn ImpactBody, second: &'a dyn ImpactBody) -> Pair<'a> {
        Pair { first, second }
    }

    /// Sets the contact law between the faces, which is rigid by default.
    #[must_use]
    pub fn through(self, law: ContactLaw) -> Self {
        Self { law, ..self }
    }

    /// Sets the discretisation of time.
    #[must_use]
    pub fn by(self, quadrature: Quadrature) -> Self {
        Self { quadrature, ..self }
    }

    /// Sets the length of the time steps \[s\]. The default is a 4096th of the duration or, with a
    /// measured body, the longest step below it that divides the period of the body.
    #[must_use]
    pub fn in_steps_of(self, time_step: f64) -> Self {
        Self {
            time_step: Some(time_step),
            ..self
        }
    }

    /// Computes the force between faces that stick (Ödeen 1993, paper E, eq. 2) by time marching.
    /// With a rigid contact, the force $`F_n`$ of step n is the solution of a discrete Volterra
    /// equation, $`w_0F_n = V - \sum_{j<n}w_{n-j}F_j`$, where $`w_n`$ is the sum of the weights of
    /// both bodies in their [`Kernel`]s. With a linear contact, the faces stick to the ends of its
    /// spring, and the compression of the spring is integrated as well.
    ///
    /// # Validity
    ///
    /// Valid for any two bodies. Contact laws other than rigid and linear ones are replaced by the
    /// rigid contact.
    ///
    /// # Errors
    ///
    /// The errors of [`Impact::predict`].
    pub fn stick_force(&self, duration: f64) -> Result<ForceHistory, ImpulseError> {
        self.discretised(duration)?.stick_force()
    }

    /// Computes the stick force on a line $`\operatorname{Re} s = a`$: $`\hat F = V/(s(G_1+G_2))`$
    /// by the damped Fourier transform, at intervals of `interval` \[s\]. Jumps are smoothed by
    /// a Gaussian with a standard deviation of 2.5 intervals; the history begins 20 intervals
    /// before the contact at time 0.
    ///
    /// # Validity
    ///
    /// Valid for bodies that are known off the frequency axis, including two finite elastic bodies.
    /// The error away from jumps is $`1.1\cdot10^{-7}`$ of the force one period later, where the
    /// period is twice the duration. A linear contact is included in the mobilities.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::OutsideDomain`] for a body on lines or on the frequency axis;
    /// [`ImpulseError::NonPhysical`]; [`ImpulseError::VanishingMobility`]; errors of the
    /// bodies.
    pub fn stick_force_damped(
        &self,
        duration: f64,
        interval: f64,
    ) -> Result<ForceHistory, ImpulseError> {
        let synthesis_error = |source: RodwaveError| ImpulseError::Body {
            s: Complex64::ZERO,
            source,
        };
        check_positive("impact velocity [m/s]", self.velocity)?;
        self.law.check()?;
        check_positive("interval [s]", interval)?;
        let synthesis = DampedSynthesis::new(duration, interval)
            .and_then(|synthesis| synthesis.smoothed(SMOOTHING * interval))
            .map_err(synthesis_error)?;
        let compliance = match self.law {
            ContactLaw::Linear { stiffness } => 1.0 / stiffness,
            _ => 0.0,
        };
        let mut transform = Vec::new();
        for (index, s) in synthesis.arguments().enumerate() {
            let mobility =
                self.first.mobility_at(s)? + self.second.mobility_at(s)? + s * compliance;
            let force = self.velocity / (s * mobility);
            if !force.is_finite() {
                return Err(ImpulseError::VanishingMobility { index });
            }
            transform.push(force);
        }
        let history = synthesis.history(&transform).map_err(synthesis_error)?;
        ForceHistory::new(history.start, history.interval, history.samples)
    }

    /// Computes the stick force by the plain Fourier transform, as in paper E: see [`StickProblem`]
    /// for its validity.
    ///
    /// The line at 0 Hz follows from the masses of the free bodies; if none is free, the velocity
    /// is a square wave. The upper end of the spectrum is not rolled off.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::GridMismatch`] or [`ImpulseError::LengthMismatch`] for a measured body with
    /// other lines; the errors of [`StickProblem::solve`].
    pub fn stick_force_on_lines(&self, band: LineBand) -> Result<StickForce, ImpulseError> {
        check_positive("upper end of the band [Hz]", band.highest_hz)?;
        let n_lines = band.n_samples / 2 + 1;
        if n_lines < 3 || !band.n_samples.is_multiple_of(2) {
            return Err(ImpulseError::NonPhysical {
                quantity: "number of samples",
                value: band.n_samples as f64,
                expected: "an even number above 2",
            });
        }
        let frequency_step_hz = band.highest_hz / (n_lines - 1) as f64;
        let inverse: f64 = self.masses().iter().flatten().map(|mass| 1.0 / mass).sum();
        let zero_line = if inverse > 0.0 {
            ZeroLine::EffectiveMass(1.0 / inverse)
        } else {
            ZeroLine::SquareWave
        };
        StickProblem {
            first: &lines_of(self.first, frequency_step_hz, n_lines)?,
            second: &lines_of(self.second, frequency_step_hz, n_lines)?,
            frequency_step_hz,
            impact_velocity: self.velocity,
            zero_line,
            roll_off_from_hz: None,
            interpolation: 1,
            until: None,
        }
        .solve()
    }

    /// Computes the impact for `duration` \[s\]: contact, separation and re-contact, with the
    /// balance of momentum and energy.
    ///
    /// Time 0 is the first touch. Cost: $`O(N\log^2 N)`$ for N steps and, with the default
    /// quadrature, 8N evaluations of a mobility that is known in the right half-plane, or 32N of
    /// one that is known on the frequency axis.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the duration; [`ImpulseError::MassContradictsMobility`];
    /// [`ImpulseError::RigidFaces`] if two masses meet without compliance between them;
    /// [`ImpulseError::NoDecomposition`] if the echoes of a measured body are not found;
    /// [`ImpulseError::ActiveFaces`] and [`ImpulseError::Diverged`] for mobilities that generate
    /// energy; [`ImpulseError::OutOfRange`]; the errors of [`Kernel::of`].
    pub fn predict(&self, duration: f64) -> Result<Prediction, ImpulseError> {
        self.discretised(duration)?.predict()
    }

    fn masses(&self) -> [Option<f64>; 2] {
        [self.first.free_mass(), self.second.free_mass()]
    }

    /// Discretises the impact: computes both kernels, which takes longer than the time marching.
    /// Use the result for several impacts of the same bodies at different velocities.
    ///
    /// # Errors
    ///
    /// The errors of [`Impact::predict`].
    pub fn discretised(&self, duration: f64) -> Result<DiscreteImpact, ImpulseError> {
        check_positive("impact velocity [m/s]", self.velocity)?;
        self.law.check()?;
        let grid = self.grid(duration)?;
        for (name, body) in [("first", self.first), ("second", self.second)] {
            check_mass(name, body, duration)?;
        }
        let kernels = [
            kernel_of(self.first, grid, self.quadrature, Known::All)?,
            kernel_of(self.second, grid, self.quadrature, Known::All)?,
        ];
        DiscreteImpact::new(
            self.velocity,
            [self.first, self.second].map(Face::of),
            kernels,
            &self.law,
        )
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts follow from checked positive times, and too large ones saturate and are refused"
    )]
    fn grid(&self, duration: f64) -> Result<TimeGrid, ImpulseError> {
        check_positive("duration [s]", duration)?;
        let measured = self.lines().map(|(step_hz, _)| 1.0 / step_hz).next();
        let time_step = match (self.time_step, measured) {
            (Some(time_step), _) => time_step,
            (None, None) => duration / DEFAULT_STEPS as f64,
            (None, Some(period)) => period / (DEFAULT_STEPS as f64 * period / duration).ceil(),
        };
        TimeGrid {
            time_step,
            n_steps: (duration / time_step * (1.0 - 1e-12)).ceil() as usize,
        }
        .check()
    }
}

/// Returns the kernel of a body, continued above its lines if it is measured.
fn kernel_of(
    body: &dyn ImpactBody,
    grid: TimeGrid,
    quadrature: Quadrature,
    known: Known,
) -> Result<Kernel, ImpulseError> {
    match Continued::of(body, known)? {
        Some(continued) => Kernel::of(&continued, grid, quadrature),
        None => Kernel::of(body, grid, quadrature),
    }
}

/// Returns true if the apparent mass is larger at a tenth of one of the frequencies in
/// [`NOT_AT_REST`] times `rate`. Several frequencies are tried, because the mobility of a chain on
/// a support is lost in rounding if the frequency is too low.
fn grows(
    inertia: &impl Fn(f64) -> Result<Option<f64>, ImpulseError>,
    rate: f64,
) -> Result<bool, ImpulseError> {
    for times in NOT_AT_REST {
        let (Some(faster), Some(slower)) = (inertia(times * rate)?, inertia(0.1 * times * rate)?)
        else {
            return Ok(true);
        };
        if slower / faster >= 1.0 + MASS_TOLERANCE {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Checks that a free body behaves as its mass at low frequency, and that a body that is not free
/// does not behave as a mass. [`MeasuredBody::screen`](crate::MeasuredBody::screen) checks this for
/// a measured body, within its errors.
fn check_mass(
    name: &'static str,
    body: &dyn ImpactBody,
    duration: f64,
) -> Result<(), ImpulseError> {
    let rate = AT_REST / duration;
    let inertia = |rate: f64| -> Result<Option<f64>, ImpulseError> {
        let s = match body.domain() {
            Domain::RightHalfPlane => Complex64::new(rate, 0.0),
            Domain::FrequencyAxis => Complex64::new(0.0, rate),
            Domain::Lines { .. } => return Ok(None),
        };
        let mobility = body.mobility_at(s)?;
        if !mobility.is_finite() {
            return Err(ImpulseError::InfiniteMobility { body: name, s });
        }
        Ok(Some(1.0 / (s * mobility).norm()))
    };
    let Some(found) = inertia(rate)? else {
        return Ok(());
    };
    let agrees = match body.free_mass() {
        Some(mass) => (found / mass - 1.0).abs() < MASS_TOLERANCE,
        // the apparent mass of a rod, a spring or a damper grows without limit at low frequency
        None if found.is_infinite() => true,
        None => grows(&inertia, rate)?,
    };
    if agrees {
        Ok(())
    } else {
        Err(ImpulseError::MassContradictsMobility {
            body: name,
            found,
            expected: body.free_mass().unwrap_or(f64::INFINITY),
        })
    }
}
