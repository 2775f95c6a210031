//! Modulus of Havriliak and Negami: a broad and skew loss peak.

use num_complex::Complex64;

use super::differentiable::{exactly, named, write};
use super::zener::ModulusStep;
use super::{ComplexModulus, DifferentiableModulus, LaplaceModulus, check_exponent};
use crate::RodwaveError;
use crate::error::check_positive;
use crate::quotient::{quotient, times_ln};

/// Empirical law of polymers in their glass transition (Havriliak & Negami, *Polymer* **8** (1967)
/// 161).
///
/// ```text
/// E(s) = E₁ - (E₁ - E₀)/(1 + (sτ)^α)^β ,    0 < α <= 1 ,  0 < αβ <= 1
/// ```
///
/// α determines the breadth of the loss peak and β its skewness: E'' grows as ω^α below the peak
/// and falls as ω^{-αβ} above it. β = 1 is the [`FractionalZener`](super::FractionalZener) model
/// (Cole and Cole), α = 1 the model of Davidson and Cole. Within the bounds, the relaxation modulus
/// decreases monotonically with all derivatives; β itself may exceed 1.
///
/// In the time domain, the law requires the three-parameter Mittag-Leffler function. It is
/// therefore not a [`TimeDomainModulus`](super::TimeDomainModulus).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HavriliakNegami {
    step: ModulusStep,
    relaxation_time: f64,
    breadth_exponent: f64,
    skewness_exponent: f64,
}

impl HavriliakNegami {
    /// Creates a solid of `relaxed_modulus` E₀ \[Pa\], `unrelaxed_modulus` E₁ > E₀ \[Pa\],
    /// `relaxation_time` τ \[s\], `breadth_exponent` α and `skewness_exponent` β.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0, E₁ exceeds E₀, and α and αβ
    /// are at most 1.
    pub fn new(
        relaxed_modulus: f64,
        unrelaxed_modulus: f64,
        relaxation_time: f64,
        breadth_exponent: f64,
        skewness_exponent: f64,
    ) -> Result<Self, RodwaveError> {
        let breadth_exponent = check_exponent("breadth exponent", breadth_exponent)?;
        let skewness_exponent = check_positive("skewness exponent", skewness_exponent)?;
        check_exponent(
            "product of breadth and skewness exponents",
            breadth_exponent * skewness_exponent,
        )?;
        Ok(Self {
            step: ModulusStep::new(relaxed_modulus, unrelaxed_modulus)?,
            relaxation_time: check_positive("relaxation time [s]", relaxation_time)?,
            breadth_exponent,
            skewness_exponent,
        })
    }

    /// Computes (sτ)^α.
    fn power(&self, s: Complex64) -> Complex64 {
        (s * self.relaxation_time).powf(self.breadth_exponent)
    }
}

impl ComplexModulus for HavriliakNegami {
    fn at(&self, omega: f64) -> Complex64 {
        self.at_s(Complex64::new(0.0, omega))
    }

    fn slope(&self, omega: f64) -> Complex64 {
        self.slope_at_s(Complex64::new(0.0, omega))
    }
}

impl HavriliakNegami {
    /// Computes ∂E/∂ln s.
    fn slope_at_s(&self, s: Complex64) -> Complex64 {
        let power = self.power(s);
        let exponents = self.breadth_exponent * self.skewness_exponent;
        let decay = (1.0 + power).powf(-self.skewness_exponent);
        quotient(
            self.step.increment() * exponents * decay * power,
            1.0 + power,
        )
    }
}

impl LaplaceModulus for HavriliakNegami {
    fn at_s(&self, s: Complex64) -> Complex64 {
        let relaxed_share = share(self.power(s), self.skewness_exponent);
        self.step.relaxed + self.step.increment() * relaxed_share
    }
}

/// Computes 1 - (1 + p)^{-β}, accurate also for small p or β.
fn share(power: Complex64, exponent: f64) -> Complex64 {
    let plain = 1.0 - (1.0 + power).powf(-exponent);
    if plain.norm_sqr() > 0.01 {
        return plain;
    }
    let logarithm = if power.norm_sqr() < 0.25 {
        let size = power.re * (2.0 + power.re) + power.im * power.im;
        Complex64::new(0.5 * size.ln_1p(), power.im.atan2(1.0 + power.re))
    } else {
        (1.0 + power).ln()
    };
    // 1 - e^{-z}, computed from the real and the imaginary part of z
    let Complex64 { re, im } = exponent * logarithm;
    let half = (0.5 * im).sin();
    Complex64::new(
        2.0 * half * half - (-re).exp_m1() * im.cos(),
        (-re).exp() * im.sin(),
    )
}

/// Parameters: `ln_relaxed_modulus`, `ln_modulus_increment` (of E₁ - E₀), `ln_relaxation_time`,
/// `breadth_exponent`, `skewness_exponent`.
impl DifferentiableModulus for HavriliakNegami {
    fn parameter_names(&self) -> Vec<String> {
        named(&[
            "ln_relaxed_modulus",
            "ln_modulus_increment",
            "ln_relaxation_time",
            "breadth_exponent",
            "skewness_exponent",
        ])
    }

    fn parameters(&self) -> Vec<f64> {
        vec![
            self.step.relaxed.ln(),
            self.step.increment().ln(),
            self.relaxation_time.ln(),
            self.breadth_exponent,
            self.skewness_exponent,
        ]
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError> {
        let [relaxed, increment, relaxation_time, breadth, skewness] = exactly(parameters)?;
        let (relaxed, increment) = (relaxed.exp(), increment.exp());
        Self::new(
            relaxed,
            relaxed + increment,
            relaxation_time.exp(),
            breadth,
            skewness,
        )
    }

    fn gradient_at_s(
        &self,
        s: Complex64,
        derivatives: &mut [Complex64],
    ) -> Result<Complex64, RodwaveError> {
        let relaxed = Complex64::from(self.step.relaxed);
        let slope = self.slope_at_s(s);
        let by_breadth = times_ln(slope, s * self.relaxation_time) / self.breadth_exponent;
        let base = 1.0 + self.power(s);
        let by_skewness = self.step.increment() * base.powf(-self.skewness_exponent) * base.ln();
        let modulus = self.at_s(s);
        write(
            modulus,
            &[relaxed, modulus - relaxed, slope, by_breadth, by_skewness],
            derivatives,
        )
    }
}
