//! Modulus from the free vibration of a rod: frequency and decay of its longitudinal modes.
//!
//! A rod that hangs free and was struck at an end rings in its modes, each $`e^{s_n t}`$ with $`s_n = -\delta_n + i\omega_n`$. Between a free end
//! and one with a mass m,
//!
//! ```text
//! γ(s_n) L = iκ_n ,    tan κ_n = -μκ_n ,    μ = m/(ρAL) ,    κ_n = nπ without a mass,
//! E(s_n) = ρ s_n²/γ² = -ρ (s_n L/κ_n)² :    E' = ρ(L/κ_n)²(ω_n² - δ_n²) ,    E'' = 2ρ(L/κ_n)² ω_n δ_n .
//! ```
//!
//! A loss factor of 1e-5 is read from the decay where a ratio of two sensors has no such digits. Each mode is fitted on the lines around
//! it ([`Poles`]), whether or not it still rings when the record ends; no window touches it. From $`s_n`$ to $`i\omega_n`$ the modulus is
//! continued as a power of s with the loss angle found, $`E(i\omega) = E(s)(i\omega/s)^{2\varphi/\pi}`$: an effect of the square of the
//! loss factor. The method is for metals, ceramics and glasses.
//!
//! Whatever takes energy from the rod is read as its loss: supports, cables, sound.
//!
//! Theory: `docs/theory/neighbouring-methods.md#free-vibration`.

mod poles;

pub use poles::{Missing, Pole, Poles};

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::complex_frequency::ComplexFrequency;
use crate::error::{CmodError, check_positive};
use crate::estimate::{
    ComplexCovariance, ErrorSource, Method, ModulusEstimate, Refusal, RefusedLine, Solution,
    SystematicShift, Termination,
};
use crate::free_end::RodWithFreeEnd;
use crate::section_ratio::{
    self, RatioAbout, RatioLines, RatioMethod, SectionUncertainty, Settings,
};
use crate::validity::{Acceptance, AcceptanceLimits, conditions};

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

impl FreeVibration {
    /// Creates the method for a rod of this `length` L \[m\], with a guess of the wave speed [m/s], from which the modes are numbered: within
    /// a fifth.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for the rod, and unless length and wave speed are finite and above 0.
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

    /// Sets the standard uncertainties of the rod, with its length as distance.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless all are finite and not negative.
    pub fn with_uncertainty(mut self, uncertainty: SectionUncertainty) -> Result<Self, CmodError> {
        self.settings = self.settings.with_uncertainty(uncertainty)?;
        Ok(self)
    }

    /// Sets the error limits that a valid line must meet.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for limits that are NaN or not above 0, and a least coherence not from 0 to 1.
    pub fn with_limits(mut self, limits: AcceptanceLimits) -> Result<Self, CmodError> {
        self.settings = self.settings.with_limits(limits)?;
        Ok(self)
    }

    /// Returns the poles of the modes in records of the free vibration of one or several blows, each of any quantity at any section.
    ///
    /// # Errors
    /// Those of [`Poles::of`].
    pub fn poles(&self, records: &[&[f64]], rate_hz: f64) -> Result<Poles, CmodError> {
        let phases = (1..).map(|order| self.phase(order));
        Poles::of(
            records,
            rate_hz,
            phases,
            self.wave_speed / (TAU * self.length),
        )
    }

    /// Returns the wave speed of elastic theory at a pole [m/s], a better guess than the first.
    #[must_use]
    pub fn wave_speed_of(&self, pole: &Pole) -> f64 {
        pole.s.im * self.length / self.phase(pole.order)
    }

    /// Returns the complex modulus at the poles, each at the frequency of its vibration.
    ///
    /// # Errors
    /// [`CmodError`] for limits or degrees of freedom that are not possible.
    pub fn estimate(&self, poles: &[Pole]) -> Result<ModulusEstimate, CmodError> {
        let (mut lines, mut refused) = (Vec::new(), Vec::new());
        for (index, pole) in poles.iter().enumerate() {
            let frequency_hz = pole.s.im / TAU;
            let acceptance = Acceptance::of_line(*self.settings.limits(), Some(pole.freedom))?;
            let line = self
                .solution(index, pole)
                .ok_or(Refusal::NoRoot)
                .and_then(|solution| solution.into_line(&acceptance));
            match line {
                Ok(line) => lines.push(line),
                Err(reason) => refused.push(RefusedLine {
                    index,
                    frequency_hz,
                    reason,
                }),
            }
        }
        Ok(ModulusEstimate::new(
            Method::FreeVibration(*self),
            *self.settings.limits(),
            lines,
            refused,
        ))
    }

    /// Returns κ of the mode `order`: tan κ = -μκ in the quarter period below nπ, by Newton's iteration.
    fn phase(&self, order: u32) -> f64 {
        let free = f64::from(order) * PI;
        let mass = self.rod.length_of_end_mass() / self.length;
        let mut phase = free - (mass * free).atan();
        for _ in 0..50 {
            // sin κ + μκ cos κ, which has no pole
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

    /// Returns γ at the frequency of the vibration such that E = -ρω²/γ² is that at the pole.
    fn gamma(&self, pole: &Pole) -> Complex64 {
        let gamma = Complex64::new(0.0, self.phase(pole.order) / self.length);
        // E = ρs²/γ²: that of iω has γ iω/s
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
            // |dE/E| of the relative error of the pole
            error_amplification: 2.0,
            second_order: pole.variance / pole.s.norm_sqr(),
            distance: self.length,
            closed_form: None,
            termination: Termination::ClosedForm,
            violations: conditions(gamma, self.rod.diameter, self.length),
        })
    }

    /// Returns the shifts by one standard uncertainty of each source.
    fn shifts(&self, pole: &Pole, gamma: Complex64, modulus: Complex64) -> Vec<SystematicShift> {
        let uncertainty = self.settings.uncertainty();
        let longer = |by: f64| Self {
            length: self.length + by,
            ..*self
        };
        let mut changed = vec![(
            ErrorSource::Length,
            [longer(uncertainty.distance), longer(-uncertainty.distance)],
        )];
        changed.retain(|_| uncertainty.distance > 0.0);
        let rods = self.rod.changed(uncertainty);
        changed.extend(rods.into_iter().map(|(source, rods)| {
            let of = |rod| Self { rod, ..*self };
            (source, rods.map(of))
        }));
        changed
            .into_iter()
            .map(|(source, [above, below])| {
                let of_gamma = 0.5 * (above.gamma(pole) - below.gamma(pole));
                let of_density = 0.5 * (above.rod.density - below.rod.density) / self.rod.density;
                let of_modulus = modulus * (of_density - 2.0 * of_gamma / gamma);
                SystematicShift::new(source, of_modulus, of_gamma)
            })
            .collect()
    }
}

impl RatioMethod for FreeVibration {
    /// Takes s/iω of each mode as its ratio.
    fn estimate_ratio(&self, lines: &RatioLines<'_>) -> Result<ModulusEstimate, CmodError> {
        let (measured, _) = section_ratio::usable(lines)?;
        let mut poles: Vec<Pole> = Vec::with_capacity(measured.len());
        let mut speed = self.wave_speed;
        for line in &measured {
            let omega = TAU * line.frequency_hz;
            let after = poles.last().map_or(0, |pole| pole.order);
            // the mode nearest to the wave speed of the one before
            let orders = after + 1..after + 1000;
            let apart = |order: &u32| (self.phase(*order) * speed / self.length - omega).abs();
            let order = orders.min_by(|a, b| apart(a).total_cmp(&apart(b)));
            let order = order.unwrap_or(after + 1);
            speed = omega * self.length / self.phase(order);
            let Some(freedom) = line.freedom else {
                continue;
            };
            poles.push(Pole {
                order,
                s: line.ratio * Complex64::new(0.0, omega),
                variance: line.variance * omega * omega,
                freedom,
            });
        }
        self.estimate(&poles)
    }

    /// Returns `None`: a pole has no common errors of sensors.
    fn ratio_about(&self, _frequency_hz: f64, _gamma: Complex64) -> Option<RatioAbout> {
        None
    }
}
