//! Modulus from a pulse that passes two sections before its reflection (Blanc; the reference of
//! Ödeen 1993, paper A, figure 3).
//!
//! A rod is struck, and the pulse in one direction is cut out of the records of two sections a
//! distance L apart, each with a window that ends before the reflected pulse. For this single wave
//!
//! ```text
//! H = q̂₂/q̂₁ = e^{-γL} ,    α = -ln|H|/L ,    k = -arg H/L
//! ```
//!
//! with the phase continued from 0 Hz. There is no singular line and no boundary condition, so the
//! method is a good reference for the other methods. The rod must be long compared with the pulse.
//!
//! # Errors
//! With noise of variance σ₁² and σ₂² in the two spectra,
//!
//! ```text
//! E|δγ|² = E|δH|²/(L²|H|²) = (σ₁²/|q̂₁|² + σ₂²/|q̂₂|²)/L²
//! ```
//!
//! This variance is independent of k, so the relative error of E decreases as 1/(kL). For equal
//! noise and a fixed first section, the error is least for αL = 1 + e^{-2αL}, αL = 1.11.
//!
//! A window that cuts off a tail, or begins on the tail of another pulse, causes an error of about
//! the value at the cut divided by ω, the first term of the integral over the missing part. This
//! error must be added to the noise of the spectrum. It exceeds the noise at low frequency in
//! materials with losses, whose pulses have long tails.
//!
//! Theory: `docs/theory/neighbouring-methods.md`.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::numerics::Jet;

use crate::error::{CmodError, check_positive};
use crate::estimate::{ErrorSource, Method};
use crate::section_ratio::{Changed, RodOfRatio, SectionRatio, Settings};

/// Round rod with two sections that a pulse passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulsedRod {
    /// Distance L between the sections \[m\].
    pub distance: f64,
    /// Diameter D \[m\].
    pub diameter: f64,
    /// Density ρ [kg/m³].
    pub density: f64,
}

/// Method for the modulus from a pulse at two sections.
///
/// ```
/// use cmod::{PulsedRod, SeparatePulses};
/// use num_complex::Complex64;
///
/// // a wave with c = 1700 m/s and a loss factor of 0.1 at two sections 0.4 m apart
/// let frequency_hz: Vec<f64> = (1..=100).map(|j| 100.0 * f64::from(j)).collect();
/// let gamma = |f: f64| Complex64::new(0.05, 1.0) * (2.0 * std::f64::consts::PI * f / 1700.0);
/// let ratio: Vec<Complex64> = frequency_hz.iter().map(|&f| (-0.4 * gamma(f)).exp()).collect();
/// let rod = PulsedRod { distance: 0.4, diameter: 0.0106, density: 903.0 };
/// let estimate = SeparatePulses::new(rod)?.estimate(&frequency_hz, &ratio, &[1e-8; 100])?;
/// for line in estimate.valid() {
///     assert!((line.phase_velocity - 1700.0).abs() < 1e-9);
/// }
/// assert!(estimate.valid().count() > 90);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeparatePulses {
    rod: PulsedRod,
    settings: Settings,
}

setters! { SeparatePulses: wave_speed, delay, uncertainty, limits }

impl SeparatePulses {
    /// Creates the method for one rod.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless distance, diameter and density are finite and above 0.
    pub fn new(rod: PulsedRod) -> Result<Self, CmodError> {
        check_positive("distance of the sections [m]", rod.distance)?;
        check_positive("diameter [m]", rod.diameter)?;
        check_positive("density [kg/m^3]", rod.density)?;
        Ok(Self {
            rod,
            settings: Settings::default(),
        })
    }

    estimate! {
        /// Returns the complex modulus from the `ratio` H = q̂₂/q̂₁ and its `variance` E|δH|², at
        /// the increasing frequencies `frequency_hz` \[Hz\]. The pulse passes section 2 after
        /// section 1. All arrays have one entry per line.
        ///
        /// # Errors
        /// [`CmodError::NoLines`], [`CmodError::LengthMismatch`], [`CmodError::Frequency`],
        /// [`CmodError::FrequencyOrder`], [`CmodError::NegativeVariance`]. A single bad line is not
        /// an error: it is [refused](crate::ModulusEstimate::refused).
        ratio
    }
}

impl SectionRatio for SeparatePulses {
    const METHOD: Method = Method("separate pulses at two sections");

    fn jets(&self, gamma: Complex64, _omega: f64) -> [Jet; 2] {
        [
            Jet::decay(self.rod.distance, gamma),
            Jet::constant(Complex64::ONE),
        ]
    }

    fn distance(&self) -> f64 {
        self.rod.distance
    }

    fn rod(&self) -> RodOfRatio {
        RodOfRatio {
            diameter: self.rod.diameter,
            density: self.rod.density,
        }
    }

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn changed(&self) -> Vec<Changed<Self>> {
        let distance = self.settings.uncertainty.distance;
        let section = Changed::of(ErrorSource::Section(0), distance, |by| {
            let mut changed = *self;
            changed.rod.distance += by;
            changed
        });
        section.into_iter().collect()
    }

    fn closed_form(&self, ratio: Complex64, expected: Complex64) -> Option<Complex64> {
        Some(nearest_logarithm(ratio, self.rod.distance, expected))
    }
}

/// Returns the root γ of e^{-γd} = H that is nearest to `expected`; it is infinite for H = 0.
pub(crate) fn nearest_logarithm(ratio: Complex64, distance: f64, expected: Complex64) -> Complex64 {
    let principal = -ratio.ln();
    let turns = ((expected.im * distance - principal.im) / TAU).round();
    (principal + Complex64::new(0.0, turns * TAU)) / distance
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROD: PulsedRod = PulsedRod {
        distance: 0.4,
        diameter: 0.0106,
        density: 903.0,
    };

    #[test]
    fn impossible_rods_are_refused() {
        let wrong = PulsedRod {
            distance: -0.4,
            ..ROD
        };
        assert_eq!(
            SeparatePulses::new(wrong).unwrap_err().to_string(),
            "distance of the sections [m] is -0.4, expected a finite value above 0"
        );
        let guess = SeparatePulses::new(ROD).unwrap().with_wave_speed(f64::NAN);
        assert_eq!(
            guess.unwrap_err().to_string(),
            "wave speed [m/s] is NaN, expected a finite value above 0"
        );
    }

    #[test]
    fn arrays_that_do_not_fit_are_refused() {
        let method = SeparatePulses::new(ROD).unwrap();
        let ratio = [Complex64::ONE; 2];
        let text = |f: &[f64], r: &[Complex64], v: &[f64]| {
            method.estimate(f, r, v).unwrap_err().to_string()
        };
        assert_eq!(text(&[], &[], &[]), "no line to evaluate");
        assert_eq!(
            text(&[1.0, 2.0, 3.0], &ratio, &[0.0; 3]),
            "ratio has 2 lines, expected 3, one per frequency"
        );
        assert_eq!(
            text(&[1.0, 2.0], &ratio, &[0.0]),
            "variance has 1 lines, expected 2, one per frequency"
        );
        assert_eq!(
            text(&[2.0, 1.0], &ratio, &[0.0; 2]),
            "frequency of line 1 is 1 Hz, expected more than the 2 Hz of the previous line"
        );
        assert_eq!(
            text(&[1.0, 2.0], &ratio, &[0.0, -1.0]),
            "variance of line 1 is -1, expected 0 or above"
        );
        let wrong = crate::SectionUncertainty {
            distance: -1.0,
            ..Default::default()
        };
        assert_eq!(
            method.with_uncertainty(wrong).unwrap_err().to_string(),
            "uncertainty of a distance [m] is -1, expected a finite value, 0 or above"
        );
    }

    /// Several speeds agree with four lines far above 0 Hz, so all lines are in doubt unless the
    /// speed is approximately known.
    #[test]
    fn few_lines_need_a_guess_of_the_speed() {
        let frequency_hz = [9000.0, 9500.0, 10000.0, 10500.0];
        let gamma = |f: f64| Complex64::new(0.05, 1.0) * (TAU * f / 1700.0);
        let ratio = frequency_hz.map(|f| (-0.4 * gamma(f)).exp());
        let method = SeparatePulses::new(ROD).unwrap();
        let alone = method.estimate(&frequency_hz, &ratio, &[1e-8; 4]).unwrap();
        assert_eq!(alone.valid().count(), 0);
        let reason = alone.lines()[0].validity.to_string();
        assert_eq!(
            reason,
            "branch: 4 lines are too few to find the wave speed, expected 8 or a guess of the wave speed"
        );
        let guided = method.with_wave_speed(1600.0).unwrap();
        let guided = guided.estimate(&frequency_hz, &ratio, &[1e-8; 4]).unwrap();
        assert_eq!(guided.valid().count(), 4);
        // tolerance: a relative error of 1e-13 of |γ|, which is below 40 rad/m
        assert!((guided.lines()[0].propagation_coefficient - gamma(9000.0)).norm() < 1e-13 * 40.0);
    }

    #[test]
    fn a_line_without_a_pulse_is_refused_alone() {
        use crate::estimate::Refusal;

        let frequency_hz: Vec<f64> = (0..20).map(|j| 100.0 * f64::from(j)).collect();
        let mut ratio: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| (-0.4 * Complex64::new(0.05, 1.0) * (TAU * f / 1700.0)).exp())
            .collect();
        ratio[7] = Complex64::ZERO;
        ratio[9] = Complex64::new(f64::NAN, 0.0);
        let method = SeparatePulses::new(ROD).unwrap();
        let estimate = method.estimate(&frequency_hz, &ratio, &[0.0; 20]).unwrap();
        let refused: Vec<_> = estimate
            .refused()
            .iter()
            .map(|line| (line.index, line.reason))
            .collect();
        assert_eq!(
            refused,
            [
                (0, Refusal::ZeroFrequency),
                (7, Refusal::NoRoot),
                (9, Refusal::NotFinite)
            ]
        );
        assert_eq!(estimate.lines().len(), 17);
    }
}
