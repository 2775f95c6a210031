//! The test of paper E: impact and separation of two bodies.
//!
//! The first body arrives at the velocity V; the second is at rest. While their faces stick, the
//! force F_s between them obeys (Ödeen 1993, paper E, eq. 2)
//!
//! ```text
//! [G₁(s) + G₂(s)] F_s(s) = V/s
//! ```
//!
//! which is solved on the line Re s = a of [`DampedSynthesis`]. This is valid for any two bodies of
//! analytic laws, including two finite elastic ones. The contact ends when the force ceases to be
//! compressive (paper E, eq. 3). From then on both faces are free; with the force F up to that
//! time, their velocities are V - G₁ * F and G₂ * F, where * is the convolution.
//!
//! ```
//! use rodwave::chain::{AnalyticChain, Termination};
//! use rodwave::element::Circle;
//! use rodwave::experiment::impact_of_two_bodies::{ContactEnd, ImpactOfTwoBodies};
//! use rodwave::medium::Medium;
//! use rodwave::modulus::Elastic;
//!
//! // a steel rod of 0.5 m hits a long rod of twice its area: the contact ends after one round
//! // trip in the short rod
//! let steel = Medium::new(7780.0, Elastic::new(206e9)?)?;
//! let (thin, wide) = (Circle::of_diameter(0.010)?, Circle::of_diameter(0.014)?);
//! let striker = AnalyticChain::analytic_from_impact_face()
//!     .rod(&steel, thin, 0.5)
//!     .end(Termination::Free)?;
//! let long = AnalyticChain::analytic_from_impact_face()
//!     .end(Termination::semi_infinite(&steel, wide))?;
//! let impact = ImpactOfTwoBodies { first: &striker, second: &long, velocity: 2.0 }.run(1e-3, 1e-6)?;
//! let ContactEnd::Separated { time } = impact.end else { panic!("the rods stay together") };
//! assert!((time - 2.0 * 0.5 / steel.phase_velocity(0.0)).abs() < 5e-6);
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! # Limitations
//! Contacts after the end of the first one are not computed. In one-dimensional theory the wide
//! face of the cone of paper E touches three more times, which adds 0.3 % of the impulse.

use num_complex::Complex64;

use crate::RodwaveError;
use crate::chain::AnalyticChain;
use crate::error::check_positive;
use crate::fourier::RealFourier;
use crate::synthesis::{DampedSynthesis, SynthesizedHistory};

/// Generator name of [`ImpactOfTwoBodies::run`].
pub const GENERATOR: &str = "impact of two bodies: chain recursion, damped Fourier transform";

/// Standard deviation, in intervals, of the Gaussian that smooths the jump at contact. Its
/// transform, 1 at 0 Hz, is 4e-14 at the Nyquist frequency.
const SMOOTHING: f64 = 2.5;

/// Fraction of the peak below which a tension is ignored: the alias of the next period contributes
/// 1e-7, and rounding the rest.
const TENSION: f64 = 1e-6;

/// Two bodies whose impact faces meet.
#[derive(Debug, Clone, Copy)]
pub struct ImpactOfTwoBodies<'a> {
    /// The moving body, from its impact face.
    pub first: &'a AnalyticChain,
    /// The body at rest, from its impact face.
    pub second: &'a AnalyticChain,
    /// Velocity V of the first body before the contact, towards the second [m/s].
    pub velocity: f64,
}

/// End of the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ContactEnd {
    /// The faces separate at this time t₀ \[s\].
    Separated {
        /// Zero crossing of the stick force, by linear interpolation between samples.
        time: f64,
    },
    /// The force is compressive, or zero, to the end of the record.
    InContact,
}

/// Histories of an impact; all have the same times.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ImpactRecord<'a> {
    /// Generator of the record: [`GENERATOR`].
    pub generator: &'static str,
    /// Time of the first sample \[s\]: 20 intervals before the contact at time 0, because the jump
    /// is smoothed over ±15 intervals.
    pub start: f64,
    /// Interval between samples \[s\].
    pub interval: f64,
    /// Force between faces that stick \[N\], positive in compression; `(n_samples)`.
    pub stick_force: Vec<f64>,
    /// End of the contact.
    pub end: ContactEnd,
    /// Impact force \[N\]: the stick force until the end of the contact, 0 afterwards;
    /// `(n_samples)`.
    pub force: Vec<f64>,
    /// Velocity of the face of the first body [m/s], along V; `(n_samples)`.
    pub first_velocity: Vec<f64>,
    /// Velocity of the face of the second body [m/s], along V; `(n_samples)`.
    pub second_velocity: Vec<f64>,
    second: &'a AnalyticChain,
    synthesis: DampedSynthesis,
    /// Transform of the impact force, with time 0 at the first sample.
    force_transform: Vec<Complex64>,
}

impl<'a> ImpactOfTwoBodies<'a> {
    /// Computes the impact over `duration` \[s\] in steps of `interval` \[s\], starting 20
    /// intervals before the contact.
    ///
    /// All histories are convolved with a Gaussian of standard deviation 2.5 intervals: impulses
    /// are conserved, a jump is spread over ±15 intervals, and constant or linear parts are
    /// unchanged.
    ///
    /// # Validity
    /// Until the end of the contact, the error is that of [`DampedSynthesis`]. If the stick force
    /// passes through zero with a slope, the velocities after the contact have an error of the
    /// order of the interval squared. If the stick force jumps to tension, the end of the contact
    /// is known to ±2 standard deviations of the Gaussian, and the impulse to the jump times one
    /// standard deviation. With a massless spring at an impact face, the velocity of that face
    /// jumps at the end of the contact, and rings there.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] for a velocity or a time that is not positive, or a duration
    /// of 20 intervals or less; the errors of [`AnalyticChain::mobility_at_s`].
    pub fn run(&self, duration: f64, interval: f64) -> Result<ImpactRecord<'a>, RodwaveError> {
        check_positive("impact velocity [m/s]", self.velocity)?;
        let synthesis = DampedSynthesis::new(duration, interval)?;
        let smoothed = synthesis.smoothed(SMOOTHING * interval)?;
        let arguments: Vec<Complex64> = synthesis.arguments().collect();
        let mobility = |body: &AnalyticChain| -> Result<Vec<Complex64>, RodwaveError> {
            arguments.iter().map(|&s| body.mobility_at_s(s)).collect()
        };
        let (first, second) = (mobility(self.first)?, mobility(self.second)?);
        let stick_transform: Vec<Complex64> = arguments
            .iter()
            .zip(first.iter().zip(&second))
            .map(|(s, (first, second))| self.velocity / (s * (first + second)))
            .collect();
        let stick = smoothed.history(&stick_transform)?;
        let (force, end) = compressive_part(&stick);
        let force_transform = match end {
            ContactEnd::InContact => {
                let rounded = |s: &Complex64| {
                    (s * stick.start + 0.5 * (s * SMOOTHING * interval).powu(2)).exp()
                };
                let lines = arguments.iter().zip(&stick_transform);
                lines.map(|(s, force)| force * rounded(s)).collect()
            }
            ContactEnd::Separated { .. } => {
                transform_of_samples(&force, interval, synthesis.damping())
            }
        };
        let answer = |mobility: &[Complex64]| -> Result<Vec<f64>, RodwaveError> {
            let lines = force_transform.iter().zip(mobility);
            let transform: Vec<Complex64> =
                lines.map(|(force, mobility)| force * mobility).collect();
            Ok(synthesis.history(&transform)?.samples)
        };
        let first_velocity = answer(&first)?.iter().map(|v| self.velocity - v).collect();
        let second_velocity = answer(&second)?;
        Ok(ImpactRecord {
            generator: GENERATOR,
            start: stick.start,
            interval,
            stick_force: stick.samples,
            end,
            force,
            first_velocity,
            second_velocity,
            second: self.second,
            synthesis,
            force_transform,
        })
    }
}

impl ImpactRecord<'_> {
    /// Impulse ∫F dt of the impact force until the end of the record \[N s\], as the sum of the
    /// samples.
    #[must_use]
    pub fn impulse(&self) -> f64 {
        self.interval * self.force.iter().sum::<f64>()
    }

    /// Work ∫Fv dt \[J\] of the impact force on the second body until the end of the record, as the
    /// sum of the samples.
    #[must_use]
    pub fn work_on_second(&self) -> f64 {
        let power = self.force.iter().zip(&self.second_velocity);
        self.interval * power.map(|(force, velocity)| force * velocity).sum::<f64>()
    }

    /// Acceleration of the face of the second body [m/s²], along V; `(n_samples)`.
    ///
    /// # Validity
    /// A jump of the force causes a jump of the face velocity of an elastic body: only the Gaussian
    /// then limits the acceleration. With a spring or a mass at one of the faces, the acceleration
    /// is as accurate as the other histories.
    ///
    /// # Errors
    /// The errors of [`AnalyticChain::mobility_at_s`].
    pub fn second_acceleration(&self) -> Result<Vec<f64>, RodwaveError> {
        let lines = self.synthesis.arguments().zip(&self.force_transform);
        let transform: Vec<Complex64> = lines
            .map(|(s, force)| Ok(s * force * self.second.mobility_at_s(s)?))
            .collect::<Result<_, RodwaveError>>()?;
        Ok(self.synthesis.history(&transform)?.samples)
    }

    /// Returns the force -N \[N\], positive in compression, in a section of the second body, at
    /// `distance` \[m\] from the near face of its `element` (Ödeen 1993, paper E, Figure 4);
    /// `(n_samples)`.
    ///
    /// # Errors
    /// The errors of [`AnalyticChain::section`](crate::Chain::section) and
    /// [`Section::state_at_s`](crate::chain::Section::state_at_s).
    pub fn transmitted_force(
        &self,
        element: usize,
        distance: f64,
    ) -> Result<Vec<f64>, RodwaveError> {
        let section = self.second.section(element, distance)?;
        let lines = self.synthesis.arguments().zip(&self.force_transform);
        let transform: Vec<Complex64> = lines
            .map(|(s, force)| Ok(-force * section.state_at_s(s)?.normal_force))
            .collect::<Result<_, RodwaveError>>()?;
        Ok(self.synthesis.history(&transform)?.samples)
    }
}

/// Cuts the stick force where it ceases to be compressive, and returns that time (paper E, eq. 3).
#[allow(
    clippy::indexing_slicing,
    reason = "`begin` is the index of a sample, and the sample at `tension` follows one above zero"
)]
fn compressive_part(stick: &SynthesizedHistory) -> (Vec<f64>, ContactEnd) {
    let peak = stick.samples.iter().copied().fold(0.0, f64::max);
    let noise = TENSION * peak;
    // the contact begins where the force exceeds the noise
    let begin = stick.samples.iter().position(|&force| force > noise);
    let crossing = begin.and_then(|begin| {
        let pressed = &stick.samples[begin..];
        let tension = begin + pressed.iter().position(|&force| force < -noise)?;
        let before = &stick.samples[..tension];
        before.iter().rposition(|&force| force >= 0.0)
    });
    let Some(last) = crossing else {
        return (stick.samples.clone(), ContactEnd::InContact);
    };
    let (before, after) = (stick.samples[last], stick.samples[last + 1]);
    let fraction = before / (before - after);
    let time = stick.time(last) + fraction * stick.interval;
    let mut force = stick.samples.clone();
    for sample in force.iter_mut().skip(last + 1) {
        *sample = 0.0;
    }
    (force, ContactEnd::Separated { time })
}

/// Computes Σ Δt f_n e^{-s t_n} at the arguments of the synthesis, with t_n from the first sample:
/// the transform of a history without content above the Nyquist frequency.
fn transform_of_samples(samples: &[f64], interval: f64, damping: f64) -> Vec<Complex64> {
    // the samples fill half a period and its end point: a period has 2 (n - 1) samples
    let mut fourier = RealFourier::new(2 * (samples.len() - 1));
    let damped = fourier.samples().iter_mut().zip(samples);
    for (index, (damped, sample)) in damped.enumerate() {
        *damped = interval * sample * (-damping * interval * index as f64).exp();
    }
    fourier.forward().to_vec()
}
