//! The test of paper A: accelerations of the two ends of a struck rod.
//!
//! A rod of length L with accelerometers of mass m on both ends is struck at one end with a known
//! force F. With μ = m/(ρAL), the acceleration a₁ of the struck end and a₂ of the free end obey,
//! for any force (Ödeen 1993, paper A, eq. 1),
//!
//! ```text
//! Ψ = â₁/â₂ = cosh γL + μ γL sinh γL
//! ```
//!
//! The method of paper A inverts this equation. The simulation therefore does not use it: both ends
//! are sections of a [`Chain`] of mass, rod and mass.
//!
//! ```
//! use rodwave::experiment::end_accelerations::{EndAccelerationTest, RaisedCosine, Specimen};
//! use rodwave::element::Circle;
//! use rodwave::medium::Medium;
//! use rodwave::modulus::ConstantQ;
//! use rodwave::synthesis::DampedSynthesis;
//!
//! // test 5 of paper A, 400 mm of polypropylene, hit with 100 N for 0.1 ms
//! let polypropylene = Medium::new(915.0, ConstantQ::new(2.6e9, 0.07, 1e4)?)?;
//! let specimen = Specimen {
//!     section: Circle::of_diameter(0.0158)?.into(),
//!     length: 0.400,
//!     accelerometer_mass: 2.9e-3,
//! };
//! let test = EndAccelerationTest::analytic(&polypropylene, &specimen)?;
//! let record = test.record(&RaisedCosine::new(100.0, 1e-4)?, &DampedSynthesis::new(10e-3, 2e-6)?)?;
//!
//! // the free end is at rest until the wave arrives
//! let peak = |samples: &[f64]| samples.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
//! assert!(peak(&record.free_end[..100]) < 1e-3 * peak(&record.free_end));
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! # Limitations
//! The force is prescribed, not computed: a rigid hammer on a rigid accelerometer would cause an
//! infinite force. The instruments are ideal.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::RodwaveError;
use crate::chain::{
    AngularFrequency, Argument, Chain, ChainBuilder, LaplaceVariable, Section, Termination,
    WaveMedium,
};
use crate::element::CrossSection;
use crate::error::{check_finite, check_positive};
use crate::quotient::quotient;
use crate::synthesis::{DampedSynthesis, FourierSynthesis};

/// Generator name of [`EndAccelerationTest::record`].
pub const DAMPED_GENERATOR: &str = "end accelerations: chain recursion, damped Fourier transform";

/// Generator name of [`EndAccelerationTest::periodic_record`].
pub const PERIODIC_GENERATOR: &str =
    "end accelerations: chain recursion, discrete Fourier transform";

/// Largest late level, relative to the peak, at which a history is judged to have decayed.
const QUIET: f64 = 1e-3;

/// Number of parts of the period, of which the last is compared with the peak.
const PARTS_OF_PERIOD: usize = 16;

/// A force or a velocity of finite duration that begins at time 0, known in time and as a
/// transform.
///
/// # Requirements
/// `transform` is the Laplace transform $`\int_0^\infty p(t) e^{-st} dt`$ of `at`; `at` is 0 before
/// time 0.
pub trait Pulse {
    /// Value at `time` \[s\], in newtons for a force and in metres per second for a velocity.
    fn at(&self, time: f64) -> f64;

    /// Transform at `s` [1/s], Re s >= 0, in the unit of the pulse times seconds.
    fn transform(&self, s: Complex64) -> Complex64;
}

/// Half sine P sin πt/d for 0 < t < d: the force of a rigid mass on a spring. Its slope jumps at
/// both ends, and its transform decays as 1/s².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSine {
    extent: Extent,
}

/// Raised cosine (P/2)(1 - cos 2πt/d) for 0 < t < d: a smooth pulse, whose transform decays as
/// 1/s³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RaisedCosine {
    extent: Extent,
}

/// Peak and duration of a pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Extent {
    peak: f64,
    duration: f64,
}

impl Extent {
    fn new(peak: f64, duration: f64) -> Result<Self, RodwaveError> {
        Ok(Self {
            peak: check_positive("peak of the pulse", peak)?,
            duration: check_positive("duration of the pulse [s]", duration)?,
        })
    }

    fn contains(&self, time: f64) -> bool {
        (0.0..=self.duration).contains(&time)
    }

    /// Transform of e^{iνt} over the duration; `rotation` is ν times the duration.
    fn oscillation(&self, s: Complex64, rotation: f64) -> Complex64 {
        self.duration * decay_integral(s * self.duration - Complex64::new(0.0, rotation))
    }
}

/// Computes (1 - e^{-z})/z, also near z = 0, where it is 1.
fn decay_integral(z: Complex64) -> Complex64 {
    if z == Complex64::ZERO {
        Complex64::ONE
    } else if z.re.abs() < 1.0 {
        // sinh of a complex number is accurate in both parts, 1 - e^{-z} is not
        let half = 0.5 * z;
        (-half).exp() * half.sinh() / half
    } else {
        (1.0 - (-z).exp()) / z
    }
}

impl HalfSine {
    /// Creates the pulse of `peak` P \[N or m/s\] and `duration` d \[s\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless both are finite and above 0.
    pub fn new(peak: f64, duration: f64) -> Result<Self, RodwaveError> {
        let extent = Extent::new(peak, duration)?;
        Ok(Self { extent })
    }
}

impl Pulse for HalfSine {
    fn at(&self, time: f64) -> f64 {
        if self.extent.contains(time) {
            self.extent.peak * (PI * time / self.extent.duration).sin()
        } else {
            0.0
        }
    }

    fn transform(&self, s: Complex64) -> Complex64 {
        let difference = self.extent.oscillation(s, PI) - self.extent.oscillation(s, -PI);
        difference * Complex64::new(0.0, -0.5 * self.extent.peak)
    }
}

impl RaisedCosine {
    /// Creates the pulse of `peak` P \[N or m/s\] and `duration` d \[s\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless both are finite and above 0.
    pub fn new(peak: f64, duration: f64) -> Result<Self, RodwaveError> {
        let extent = Extent::new(peak, duration)?;
        Ok(Self { extent })
    }
}

impl Pulse for RaisedCosine {
    fn at(&self, time: f64) -> f64 {
        if self.extent.contains(time) {
            self.extent.peak * (PI * time / self.extent.duration).sin().powi(2)
        } else {
            0.0
        }
    }

    fn transform(&self, s: Complex64) -> Complex64 {
        let cosine = self.extent.oscillation(s, TAU) + self.extent.oscillation(s, -TAU);
        0.5 * self.extent.peak * (self.extent.oscillation(s, 0.0) - 0.5 * cosine)
    }
}

/// A rod with accelerometers on both ends, without its material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Specimen {
    /// Cross-section of the rod.
    pub section: CrossSection,
    /// Length L of the rod \[m\].
    pub length: f64,
    /// Mass m of each accelerometer \[kg\]; may be 0.
    pub accelerometer_mass: f64,
}

/// Test of paper A (Ödeen 1993, paper A, Figures 1 and 2). With `V` = [`LaplaceVariable`], the law
/// of the material is analytic and all histories are exact.
#[derive(Debug, Clone)]
pub struct EndAccelerationTest<V: Argument = AngularFrequency> {
    specimen: Specimen,
    chain: Chain<V>,
    mass: f64,
}

/// State of the histories at their end.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Tail {
    /// Histories computed by the damped transform; they may continue beyond the end of the record.
    Free,
    /// Periodic histories that have decayed to `late_level` within the period.
    DiedOut {
        /// Root mean square of the last sixteenth of the period over the peak, for the end of the
        /// rod where this ratio is larger.
        late_level: f64,
    },
    /// Periodic histories that have not decayed. They are not reliable: their beginning contains
    /// the end of the previous period.
    WrappedAround {
        /// Root mean square of the last sixteenth of the period over the peak, for the end of the
        /// rod where this ratio is larger.
        late_level: f64,
    },
}

/// Accelerations of the ends of the rod.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct EndAccelerationRecord {
    /// Generator of the record: [`DAMPED_GENERATOR`] or [`PERIODIC_GENERATOR`].
    pub generator: &'static str,
    /// Time of the first sample \[s\]; the impact begins at time 0.
    pub start: f64,
    /// Interval between samples \[s\].
    pub interval: f64,
    /// Acceleration a₁ of the struck end [m/s²], along the force; `(n_samples)`.
    pub impacted_end: Vec<f64>,
    /// Acceleration a₂ of the free end [m/s²], along the force; `(n_samples)`.
    pub free_end: Vec<f64>,
    /// State of the histories at their end; shows whether the transform was long enough.
    pub tail: Tail,
}

/// Transforms of the accelerations of the ends.
struct Transforms {
    impacted_end: Vec<Complex64>,
    free_end: Vec<Complex64>,
}

impl EndAccelerationTest {
    /// Creates a test of a `specimen` of any `medium`.
    ///
    /// # Errors
    /// [`RodwaveError::InElement`] or [`RodwaveError::NonPhysical`] for a length that is not above
    /// 0 or a mass below 0.
    pub fn new<M>(medium: &M, specimen: &Specimen) -> Result<Self, RodwaveError>
    where
        M: WaveMedium<AngularFrequency> + Clone + 'static,
    {
        Self::build(Chain::from_impact_face(), medium, specimen)
    }
}

impl EndAccelerationTest<LaplaceVariable> {
    /// Creates a test of a `specimen` of a `medium` whose law is analytic.
    ///
    /// # Errors
    /// The errors of [`EndAccelerationTest::new`].
    pub fn analytic<M>(medium: &M, specimen: &Specimen) -> Result<Self, RodwaveError>
    where
        M: WaveMedium<LaplaceVariable> + Clone + 'static,
    {
        Self::build(Chain::analytic_from_impact_face(), medium, specimen)
    }

    /// Computes the accelerations under this `force` \[N\] to the accuracy of the `synthesis`, also
    /// for elastic rods.
    ///
    /// At frequencies where the inertia of the accelerometer exceeds the impedance of the rod, the
    /// transform of a₁ decays like that of the force; without accelerometers it decays like s times
    /// that of the force. Content above the Nyquist frequency causes ringing, which grows as e^{at}
    /// during the record (a: damping of the synthesis). Choose an interval much shorter than the
    /// force, or a smoothed synthesis.
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`] and [`DampedSynthesis::history`].
    pub fn record(
        &self,
        force: &(impl Pulse + ?Sized),
        synthesis: &DampedSynthesis,
    ) -> Result<EndAccelerationRecord, RodwaveError> {
        let [impacted, free] = self.ends()?;
        let mut transforms = Transforms::with_capacity(synthesis.arguments().len());
        for s in synthesis.arguments() {
            let rate_of_force = s * force.transform(s);
            let ends = [impacted.state_at_s(s)?, free.state_at_s(s)?];
            transforms.push(ends.map(|state| rate_of_force * state.velocity));
        }
        let impacted_end = synthesis.history(&transforms.impacted_end)?;
        let free_end = synthesis.history(&transforms.free_end)?;
        Ok(EndAccelerationRecord {
            generator: DAMPED_GENERATOR,
            start: impacted_end.start,
            interval: impacted_end.interval,
            impacted_end: impacted_end.samples,
            free_end: free_end.samples,
            tail: Tail::Free,
        })
    }
}

impl<V: Argument> EndAccelerationTest<V> {
    fn build<M>(
        builder: ChainBuilder<V>,
        medium: &M,
        specimen: &Specimen,
    ) -> Result<Self, RodwaveError>
    where
        M: WaveMedium<V> + Clone + 'static,
    {
        let Specimen {
            section,
            length,
            accelerometer_mass,
        } = *specimen;
        let chain = builder
            .mass(accelerometer_mass)
            .rod(medium, section, length)
            .end(Termination::Mass(accelerometer_mass))?;
        Ok(Self {
            specimen: *specimen,
            chain,
            mass: medium.density() * section.area() * length + 2.0 * accelerometer_mass,
        })
    }

    /// Mass of rod and accelerometers \[kg\].
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Ratio Ψ = â₁/â₂ at `omega` [rad/s] (paper A, eq. 1); 1 at ω = 0.
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`]; [`RodwaveError::NonPhysical`] where no wave reaches the
    /// free end.
    pub fn acceleration_ratio(&self, omega: f64) -> Result<Complex64, RodwaveError> {
        if omega == 0.0 {
            return Ok(Complex64::ONE);
        }
        let [impacted, free] = self.ends()?;
        let arriving = free.state(omega)?.velocity;
        check_positive(
            "velocity of the free end per unit impulse [1/kg]",
            arriving.norm(),
        )?;
        let ratio = quotient(impacted.state(omega)?.velocity, arriving);
        check_finite("magnitude of the acceleration ratio", ratio.norm())?;
        Ok(ratio)
    }

    /// Computes the accelerations under a periodic `force` \[N\], for laws that are known only on
    /// the real axis.
    ///
    /// At 0 Hz, both accelerations are F̂(0) over the mass. The [`Tail`] of the record shows
    /// whether one period represents a single impact.
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`] and [`FourierSynthesis::history`].
    pub fn periodic_record(
        &self,
        force: &(impl Pulse + ?Sized),
        synthesis: &FourierSynthesis,
    ) -> Result<EndAccelerationRecord, RodwaveError> {
        let [impacted, free] = self.ends()?;
        let mut transforms = Transforms::with_capacity(synthesis.omegas().len());
        for omega in synthesis.omegas() {
            let s = Complex64::new(0.0, omega);
            let force = force.transform(s);
            if omega == 0.0 {
                transforms.push([force / self.mass; 2]);
                continue;
            }
            let ends = [impacted.state(omega)?, free.state(omega)?];
            transforms.push(ends.map(|state| s * force * state.velocity));
        }
        let impacted_end = synthesis.history(&transforms.impacted_end)?;
        let free_end = synthesis.history(&transforms.free_end)?;
        let late_level = late_level(&impacted_end.samples).max(late_level(&free_end.samples));
        Ok(EndAccelerationRecord {
            generator: PERIODIC_GENERATOR,
            start: impacted_end.start,
            interval: impacted_end.interval,
            impacted_end: impacted_end.samples,
            free_end: free_end.samples,
            tail: if late_level <= QUIET {
                Tail::DiedOut { late_level }
            } else {
                Tail::WrappedAround { late_level }
            },
        })
    }

    /// Sections at the struck and the free end.
    fn ends(&self) -> Result<[Section<'_, V>; 2], RodwaveError> {
        Ok([
            self.chain.section(1, 0.0)?,
            self.chain.section(1, self.specimen.length)?,
        ])
    }
}

impl Transforms {
    fn with_capacity(n_lines: usize) -> Self {
        Self {
            impacted_end: Vec::with_capacity(n_lines),
            free_end: Vec::with_capacity(n_lines),
        }
    }

    fn push(&mut self, [impacted_end, free_end]: [Complex64; 2]) {
        self.impacted_end.push(impacted_end);
        self.free_end.push(free_end);
    }
}

/// Root mean square of the last sixteenth of the period over the peak.
fn late_level(samples: &[f64]) -> f64 {
    let n_late = (samples.len() / PARTS_OF_PERIOD).max(1);
    let peak = samples.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
    let late = samples
        .iter()
        .rev()
        .take(n_late)
        .map(|a| a * a)
        .sum::<f64>();
    (late / n_late as f64).sqrt() / peak.max(f64::MIN_POSITIVE)
}
