//! Modulus from the free vibration of a rod: frequency and decay of its longitudinal modes.
//!
//! A rod that hangs free and is struck at one end vibrates in its modes $`e^{s_n t}`$ with $`s_n =
//! -\delta_n + i\omega_n`$. For a rod with a free end and a mass m at the other end,
//!
//! ```text
//! γ(s_n) L = iκ_n ,    tan κ_n = -μκ_n ,    μ = m/(ρAL) ,    κ_n = nπ without a mass,
//! E(s_n) = ρ s_n²/γ² = -ρ (s_n L/κ_n)² :    E' = ρ(L/κ_n)²(ω_n² - δ_n²) ,    E'' = 2ρ(L/κ_n)² ω_n δ_n .
//! ```
//!
//! From the decay, loss factors of 1e-5 can be determined, which the ratio of two sensors cannot
//! resolve. Each mode is fitted on the lines around it ([`Poles`]), without a window, even if the
//! mode has not decayed when the record ends. The modulus is continued from $`s_n`$ to
//! $`i\omega_n`$ as a power of s with the measured loss angle, $`E(i\omega) =
//! E(s)(i\omega/s)^{2\varphi/\pi}`$; the effect is of the order of the square of the loss factor.
//! The method is suited to metals, ceramics and glasses.
//!
//! Any energy that leaves the rod, through supports, cables or sound, is counted as loss of the
//! material.
//!
//! Theory: `docs/theory/neighbouring-methods.md#free-vibration`.

mod poles;

pub use poles::{ChangingDecay, Departure, Missing, Pole, Poles};

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::complex_frequency::ComplexFrequency;
use crate::error::{CmodError, check_positive};
use crate::estimate::{
    Acceptance, ComplexCovariance, ErrorSource, Method, ModulusEstimate, Refusal, Solution,
    SystematicShift, Termination,
};
use crate::free_end::RodWithFreeEnd;
use crate::section_ratio::{Changed, Settings};
use crate::validity::conditions;

/// Method for the modulus from the modes of a rod with free ends, one of which may carry a mass.
///
/// ```
/// use cmod::{FreeVibration, RodWithFreeEnd};
///
/// // a steel bar of 0.5 m, c = 5150 m/s, loss factor 1e-4, that rings for 2 s
/// let rod = RodWithFreeEnd { diameter: 0.012, density: 7800.0, end_mass: 0.0 };
/// let method = FreeVibration::new(rod, 0.5, 5000.0)?;
/// let sample = |n: u32| -> f64 {
///     let t = f64::from(n) / 50e3;
///     (1..4).map(|mode| {
///         let omega = std::f64::consts::TAU * 5150.0 * f64::from(mode);
///         (-0.5e-4 * omega * t).exp() * (omega * t).sin()
///     }).sum()
/// };
/// let record: Vec<f64> = (0..100_000).map(sample).collect();
/// let poles = method.poles(&[&record], 50e3)?;
/// let modulus = method.estimate(&poles.found)?;
/// assert_eq!(modulus.lines().len(), 3);
/// for line in modulus.lines() {
///     assert!((line.modulus.re / (7800.0 * 5150.0_f64.powi(2)) - 1.0).abs() < 1e-6);
///     assert!((line.loss_factor / 1e-4 - 1.0).abs() < 1e-2);
/// }
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeVibration {
    rod: RodWithFreeEnd,
    length: f64,
    wave_speed: f64,
    settings: Settings,
}

setters! { FreeVibration: uncertainty, limits }

impl FreeVibration {
    /// Creates the method for a rod of this `length` L \[m\], with a guess of the wave speed [m/s],
    /// from which the modes are numbered. The guess must be accurate to 20 %.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for the rod, and unless length and wave speed are finite and
    /// above 0.
    pub fn new(rod: RodWithFreeEnd, length: f64, wave_speed: f64) -> Result<Self, CmodError> {
        rod.check()?;
        check_positive("length [m]", length)?;
        check_positive("wave speed [m/s]", wave_speed)?;
        Ok(Self {
            rod,
            length,
            wave_speed,
            settings: Settings::default(),
        })
    }

    /// Returns the poles of the modes in records of the free vibration after one or several hits,
    /// each record of any quantity at any section.
    ///
    /// # Errors
    /// The errors of [`Poles::of`].
    pub fn poles(&self, records: &[&[f64]], rate_hz: f64) -> Result<Poles, CmodError> {
        let phases = (1..).map(|order| self.phase(order));
        Poles::of(
            records,
            rate_hz,
            phases,
            self.wave_speed / (TAU * self.length),
        )
    }

    /// Returns the complex modulus of each pole at the frequency of its vibration.
    ///
    /// # Errors
    /// [`CmodError`] for impossible limits or degrees of freedom.
    pub fn estimate(&self, poles: &[Pole]) -> Result<ModulusEstimate, CmodError> {
        let mut estimate = ModulusEstimate::empty(Method("free vibration"), self.settings.limits);
        for (index, pole) in poles.iter().enumerate() {
            let acceptance = Acceptance::of_line(self.settings.limits, Some(pole.freedom))?;
            let solution = self.solution(index, pole).ok_or(Refusal::NoRoot);
            let line = solution.and_then(|solution| solution.into_line(&acceptance));
            estimate.add(index, pole.s.im / TAU, line);
        }
        Ok(estimate)
    }

    /// Returns κ of the mode `order`: the solution of tan κ = -μκ between (n - ½)π and nπ, by
    /// Newton's iteration.
    fn phase(&self, order: u32) -> f64 {
        let free = f64::from(order) * PI;
        let mass = self.rod.length_of_end_mass() / self.length;
        let mut phase = free - (mass * free).atan();
        for _ in 0..50 {
            // the equation is solved in the form sin κ + μκ cos κ = 0, which has no pole
            let (sin, cos) = phase.sin_cos();
            let slope = cos + mass * (cos - phase * sin);
            let step = (sin + mass * phase * cos) / slope;
            phase -= step;
            if step.abs() <= 1e-15 * phase {
                break;
            }
        }
        phase
    }

    /// Returns γ at the frequency ω of the vibration, such that -ρω²/γ² is the modulus at iω,
    /// extrapolated from the pole.
    fn gamma(&self, pole: &Pole) -> Complex64 {
        let gamma = Complex64::new(0.0, self.phase(pole.order) / self.length);
        // E = ρs²/γ²: at iω the same modulus belongs to γ iω/s
        let turn = Complex64::new(0.0, pole.s.im) / pole.s;
        let loss_angle = -2.0 * turn.arg();
        gamma * turn * turn.powf(-loss_angle / PI)
    }

    fn solution(&self, index: usize, pole: &Pole) -> Option<Solution> {
        let gamma = self.gamma(pole);
        let omega = pole.s.im;
        let modulus = -self.rod.density * (omega / gamma).powi(2);
        let is_finite = gamma.is_finite() && modulus.is_finite() && omega > 0.0;
        is_finite.then(|| Solution {
            index,
            frequency: ComplexFrequency::new(omega / TAU, 0.0),
            gamma,
            density: self.rod.density,
            diameter: self.rod.diameter,
            random: ComplexCovariance::circular(pole.variance).through(gamma / pole.s),
            systematic: self.shifts(pole, gamma, modulus),
            // this is |dE/E| divided by the relative error of the pole
            error_amplification: 2.0,
            second_order: pole.variance / pole.s.norm_sqr(),
            distance: self.length,
            closed_form: None,
            termination: Termination::ClosedForm,
            violations: conditions(gamma, self.rod.diameter, self.length),
        })
    }

    /// Returns the shifts due to one standard uncertainty of each source.
    fn shifts(&self, pole: &Pole, gamma: Complex64, modulus: Complex64) -> Vec<SystematicShift> {
        let uncertainty = &self.settings.uncertainty;
        let longer = Changed::of(ErrorSource::Length, uncertainty.distance, |by| Self {
            length: self.length + by,
            ..*self
        });
        let rods = self.rod.changed(uncertainty, |rod| Self { rod, ..*self });
        longer
            .into_iter()
            .chain(rods)
            .map(|changed| {
                let Changed {
                    source,
                    larger,
                    smaller,
                } = changed;
                let of_gamma = 0.5 * (larger.gamma(pole) - smaller.gamma(pole));
                let of_density =
                    0.5 * (larger.rod.density - smaller.rod.density) / self.rod.density;
                let of_modulus = modulus * (of_density - 2.0 * of_gamma / gamma);
                SystematicShift::new(source, of_modulus, of_gamma)
            })
            .collect()
    }
}
