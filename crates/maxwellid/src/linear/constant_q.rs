//! The law with a frequency-independent loss factor.

use std::f64::consts::{FRAC_2_PI, TAU};

use num_complex::Complex64;

use super::LinearLaw;
use crate::law::StatedParameter;
use crate::special_case::{NO_SHARE, PronySeries, SpecialCase};

/// Prior range of the logarithm of a loss factor: 0.005 to 0.5.
pub(crate) const LOSS_FACTOR: (f64, f64) = (-5.298_317_366_548_036, -std::f64::consts::LN_2);

/// Constant loss factor (Kjartansson, *J. Geophys. Res.* **84** (1979) 4737).
///
/// ```text
/// E(s)/E = (s/ω₀)^{2g} ,    g = (1/π) atan tan δ
/// ```
///
/// E is the magnitude of the modulus at the reference frequency ω₀. The parameter is ln tan δ. This
/// is the law of [`rodwave::modulus::ConstantQ`], and the first competitor with which a nonlinear
/// law is to be compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantQ {
    reference_omega: f64,
}

impl Default for ConstantQ {
    /// Returns ω₀ of 4 kHz, in the middle of the band of a polymer rod struck as in paper D: E and
    /// tan δ are then nearly uncorrelated.
    fn default() -> Self {
        Self {
            reference_omega: TAU * 4e3,
        }
    }
}

impl ConstantQ {
    /// Reference frequency ω₀ [rad/s].
    #[must_use]
    pub fn reference_omega(&self) -> f64 {
        self.reference_omega
    }
}

impl LinearLaw for ConstantQ {
    fn name(&self) -> &'static str {
        "constant Q"
    }

    fn parameter_names(&self) -> Vec<&'static str> {
        vec!["ln_loss_factor"]
    }

    fn start(&self) -> Vec<f64> {
        vec![0.05_f64.ln()]
    }

    fn step_limits(&self) -> Vec<f64> {
        vec![1.0]
    }

    fn ranges(&self) -> Vec<(f64, f64)> {
        vec![LOSS_FACTOR]
    }

    fn damping_parameter(&self) -> Option<usize> {
        Some(0)
    }

    fn is_flat_loss(&self) -> bool {
        true
    }

    fn special_case(&self, series: &PronySeries) -> Option<SpecialCase> {
        series.branches.is_empty().then(|| SpecialCase {
            parameters: vec![series.modulus.ln(), NO_SHARE.ln()],
            limit: "without loss".to_owned(),
        })
    }

    fn stated(&self, _modulus: f64, parameters: &[f64]) -> Vec<StatedParameter> {
        let names = ["loss factor", "tan delta", "1"];
        let factors = parameters.iter().map(|ln_loss_factor| ln_loss_factor.exp());
        let stated = factors.map(|factor| StatedParameter::ratio(names, factor, vec![0.0, 1.0]));
        stated.collect()
    }

    fn shape(&self, s: Complex64, parameters: &[f64]) -> Option<Complex64> {
        self.shape_with_derivatives(s, parameters, &mut [Complex64::ZERO])
    }

    fn shape_with_derivatives(
        &self,
        s: Complex64,
        parameters: &[f64],
        derivatives: &mut [Complex64],
    ) -> Option<Complex64> {
        let [ln_loss_factor] = parameters else {
            return None;
        };
        let loss_factor = ln_loss_factor.exp();
        let logarithm = (s / self.reference_omega).ln();
        let shape = (FRAC_2_PI * loss_factor.atan() * logarithm).exp();
        // d(2g)/d ln tan δ = (2/π) tan δ/(1 + tan² δ)
        let growth = FRAC_2_PI * loss_factor / (1.0 + loss_factor * loss_factor);
        *derivatives.first_mut()? = shape * logarithm * growth;
        Some(shape)
    }
}
