//! The mobility in discrete time: motion of a face in each time step after a force in one step.
//!
//! Theory: `docs/theory/stick-force.md#time-marching`.

mod cell_averages;
mod convolution_quadrature;

use num_complex::Complex64;

use crate::error::{check_positive, check_samples};
use crate::{Domain, ImpactBody, ImpulseError};

/// Largest number of time steps.
const MOST_STEPS: usize = 1 << 24;

/// Multiple of the end of the band at which the instantaneous response is evaluated, and again a
/// decade higher.
const BEYOND: f64 = 1e3;

/// Smallest growth of the mobility in proportion to s over the band, as a fraction of the mobility,
/// that shows a massless spring at the face.
const SPRING: f64 = 1e-4;

/// Ratio of the real to the imaginary part of s at which the instantaneous response is evaluated.
const OFF_AXIS: f64 = 0.02;

/// Number of frequencies over which echoes are averaged.
const POINTS_BEYOND: u32 = 256;

/// Discretisation of $`v = G * F`$ to $`v_n = \sum_j w_{n-j}F_j`$.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quadrature {
    /// Force constant in each step, with $`v_n`$ the mean of the velocity over step n:
    ///
    /// ```math
    /// w_n = \int \left(1 - \frac{\lvert t - nh\rvert}{h}\right)_{\!+} G(t)\,dt ,\qquad
    /// \hat w = h\,G(s)\left(\frac{2\sinh(sh/2)}{sh}\right)^{\!2} .
    /// ```
    ///
    /// There is no other approximation: the mobility of the body is exact, work and impulse of the
    /// force are those on the exact body, and a passive body stays passive. The error is of second
    /// order for a smooth force; a jump is smeared over its step.
    CellAverages,
    /// Lubich's convolution quadrature with the backward differences of second order,
    /// $`\delta(z) = \tfrac32 - 2z + \tfrac12z^2`$. The error is of second order for a smooth
    /// force; unresolved frequencies are damped.
    Bdf2,
    /// Lubich's convolution quadrature with the trapezoidal rule, $`\delta(z) = 2(1-z)/(1+z)`$: no
    /// damping, for elastic bodies; jumps ring.
    Trapezoid,
}

/// Time steps of a kernel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeGrid {
    /// Length h of a step \[s\].
    pub time_step: f64,
    /// Number of steps.
    pub n_steps: usize,
}

impl TimeGrid {
    pub(crate) fn check(self) -> Result<Self, ImpulseError> {
        check_positive("time step [s]", self.time_step)?;
        if (2..=MOST_STEPS).contains(&self.n_steps) {
            Ok(self)
        } else {
            Err(ImpulseError::NonPhysical {
                quantity: "number of time steps",
                value: self.n_steps as f64,
                expected: "from 2 to 2^24",
            })
        }
    }
}

/// The weights $`w_n`$ of one body.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    grid: TimeGrid,
    quadrature: Quadrature,
    weights: Vec<f64>,
    face_compliance: f64,
    front: FrontDecade,
    acausal: f64,
    ringing: f64,
    activity: f64,
}

/// The mobility \[m/(N s)\] far above the band, and a decade higher.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FrontDecade {
    pub(crate) near: f64,
    pub(crate) far: f64,
}

impl Kernel {
    /// Computes the weights of `body` for `grid`.
    ///
    /// For a body that is known on lines, or on the frequency axis only, the rigid-body motion
    /// $`1/(sM)`$ and the instantaneous response $`1/Z`$ are exact, and the rest comes from one
    /// period of the Fourier transform, in which it must decay; [`Kernel::acausal`] checks
    /// this.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the grid; [`ImpulseError::OutsideDomain`] for a
    /// convolution quadrature of a body that is not known off the frequency axis;
    /// [`ImpulseError::NoFrontImpedance`] for a measured body without one;
    /// [`ImpulseError::TooShort`] if the lines of a measured body are too far apart for the
    /// duration; [`ImpulseError::InfiniteMobility`]; errors of the body.
    pub fn of<B: ImpactBody + ?Sized>(
        body: &B,
        grid: TimeGrid,
        quadrature: Quadrature,
    ) -> Result<Self, ImpulseError> {
        let grid = grid.check()?;
        let front = Front::of(body, grid)?;
        let made = match quadrature {
            Quadrature::CellAverages => cell_averages::weights(body, grid, front)?,
            Quadrature::Bdf2 | Quadrature::Trapezoid => {
                let weights = convolution_quadrature::weights(body, grid, quadrature, front)?;
                Weights {
                    weights,
                    acausal: 0.0,
                    ringing: 0.0,
                    activity: 0.0,
                }
            }
        };
        check_samples("kernel of a body", &made.weights)?;
        Ok(Self {
            grid,
            quadrature,
            weights: made.weights,
            face_compliance: front.compliance,
            front: front.decade,
            acausal: made.acausal,
            ringing: made.ringing,
            activity: made.activity,
        })
    }

    /// Weights \[m/(N s)\], without the compliance of the face.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The time steps.
    #[must_use]
    pub fn grid(&self) -> TimeGrid {
        self.grid
    }

    /// The quadrature.
    #[must_use]
    pub fn quadrature(&self) -> Quadrature {
        self.quadrature
    }

    /// Compliance \[m/N\] of a massless spring at the face, $`G \to s\,c`$ for $`s \to \infty`$; 0
    /// without one.
    #[must_use]
    pub fn face_compliance(&self) -> f64 {
        self.face_compliance
    }

    /// Root mean square of the kernel before time 0 \[m/(N s)\]: rounding for an analytic body; for
    /// others also the smearing by the band limit, noise, and the alias of parts that have not
    /// decayed within the period.
    #[must_use]
    pub fn acausal(&self) -> f64 {
        self.acausal
    }

    /// Root mean square velocity that a unit force over all steps still causes about half a period
    /// later \[m/(N s)\]: ringing that wraps round the period. 0 for an analytic body.
    #[must_use]
    pub fn ringing(&self) -> f64 {
        self.ringing
    }

    /// Largest $`-\operatorname{Re} G/\lvert G\rvert`$ over the lines used: 0 for a passive body,
    /// up to 1 for a body that generates energy, and any value in between for a measured body with
    /// noise ([`MeasuredBody::screen`](crate::MeasuredBody::screen) tests it against the variance).
    /// 0 with convolution quadrature, which does not compute it.
    #[must_use]
    pub fn activity(&self) -> f64 {
        self.activity
    }

    pub(crate) fn front(&self) -> FrontDecade {
        self.front
    }
}

/// Weights with their acausal part and activity.
struct Weights {
    weights: Vec<f64>,
    acausal: f64,
    ringing: f64,
    activity: f64,
}

/// Instantaneous response of the face.
#[derive(Debug, Clone, Copy)]
struct Front {
    /// $`y`$ \[m/(N s)\], split off so that the rest decreases with frequency
    conductance: f64,
    /// c \[m/N\]
    compliance: f64,
    decade: FrontDecade,
}

impl Front {
    fn of<B: ImpactBody + ?Sized>(body: &B, grid: TimeGrid) -> Result<Self, ImpulseError> {
        let edge = std::f64::consts::PI / grid.time_step * cell_averages::BANDS as f64;
        if let Some(impedance) = body.front_impedance() {
            let conductance = 1.0 / impedance;
            return Ok(Self {
                conductance,
                compliance: 0.0,
                decade: FrontDecade {
                    near: conductance,
                    far: conductance,
                },
            });
        }
        if matches!(body.domain(), Domain::Lines { .. }) {
            return Err(ImpulseError::NoFrontImpedance);
        }
        let at = |rate: f64| mobility_beyond(body.domain(), rate, |s| body.mobility_at(s));
        let rates = [edge, BEYOND * edge, 10.0 * BEYOND * edge];
        let [here, near, far] = [at(rates[0])?, at(rates[1])?, at(rates[2])?];
        // a spring appears in the imaginary part, G → s c
        let slope = (far.im - near.im) / (rates[2] - rates[1]);
        let compliance = if slope * edge > SPRING * here.norm() {
            slope
        } else {
            0.0
        };
        let without_spring = |mobility: Complex64, rate: f64| {
            mobility - compliance * rate * direction(body.domain())
        };
        Ok(Self {
            conductance: without_spring(here, rates[0]).re,
            compliance,
            decade: FrontDecade {
                near: without_spring(near, rates[1]).norm(),
                far: without_spring(far, rates[2]).norm(),
            },
        })
    }
}

/// Returns the complex number by which a rate [1/s] is multiplied to give the Laplace variable s of
/// an evaluation. It is i for a body that is known only on the frequency axis or on lines; for a
/// body known in the right half-plane it has a real part, with which the echoes decay.
fn direction(domain: Domain) -> Complex64 {
    match domain {
        Domain::RightHalfPlane => Complex64::new(OFF_AXIS, 1.0),
        _ => Complex64::I,
    }
}

/// Returns the mobility without echoes at the `rate` [1/s]: the mobility off the frequency axis for
/// a body known in the right half-plane, and otherwise the mean over frequencies, in which the
/// echoes cancel.
pub(crate) fn mobility_beyond(
    domain: Domain,
    rate: f64,
    mobility_at: impl Fn(Complex64) -> Result<Complex64, ImpulseError>,
) -> Result<Complex64, ImpulseError> {
    let value = |s: Complex64| {
        let mobility = mobility_at(s)?;
        if mobility.is_finite() {
            Ok(mobility)
        } else {
            Err(ImpulseError::InfiniteMobility {
                body: "impacting",
                s,
            })
        }
    };
    if domain == Domain::RightHalfPlane {
        return value(rate * direction(domain));
    }
    let mut sum = Complex64::ZERO;
    for point in 0..POINTS_BEYOND {
        let fraction = f64::from(point) / f64::from(POINTS_BEYOND);
        sum += value(Complex64::new(0.0, rate * (1.0 - 0.1 * fraction)))?;
    }
    Ok(sum / f64::from(POINTS_BEYOND))
}
