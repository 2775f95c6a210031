//! Linear competitors: rods with linear viscoelastic laws, with which every nonlinear law must be
//! compared.
//!
//! # Problem
//! A Maxwell law whose rate grows with the stress fits a rod whose loss factor hardly depends on
//! the frequency: the high frequencies of an impact coincide with its high stresses, so that an
//! amplitude-dependent rate imitates a frequency-independent loss. Data of a linear polymer are
//! then "identified" as nonlinear, unless linear laws with a flat loss are candidates too.
//!
//! # Method
//! For a linear law the direct problem of (Ödeen 1993, paper D, section 2.1) has the solution
//!
//! ```text
//! v̂_r = v̂_e / cosh(γL) ,    γ² = ρs²/(E(s) + ρr²s²) ,    Re γL >= 0 ,
//! ```
//!
//! which [`LinearModel`] evaluates along a line Re s = a of the Laplace plane by fast Fourier
//! transforms. There is no grid in the rod and no discretisation error. The remaining errors are
//! those of the band-limited interpolation of the excitation, common to all models, and of the
//! wrap-around, which the damping keeps below 1.1e-7 of the response a period later. Derivatives
//! are analytic:
//!
//! ```text
//! ∂v̂_r/∂p = v̂_r tanh(γL) (γL/2) ∂ln E/∂p
//! ```
//!
//! # Laws
//! | law | E(s)/E | parameters besides ln E |
//! |---|---|---|
//! | [`ConstantQ`] | (s/ω₀)^{2g}, g = (1/π) atan tan δ | ln tan δ |
//! | [`MaxwellBranches::zener`] | spring and one Maxwell branch | share, ln τ |
//! | [`MaxwellBranches::maxwell`] to [`four`](MaxwellBranches::four) | 1 to 4 Maxwell branches, E = Σ Eᵢ | shares, ln τ₁ .. ln τₙ |
//! | [`ScaledModulus`] | any law of [`rodwave::modulus`] | the free ones |
//! | user-defined | [`LinearLaw`] | |
//!
//! The one-branch law is the Maxwell law of paper D: its agreement with
//! [`rodwave::characteristics`] is a test of both.
//!
//! Theory: `docs/theory/model-identification.md#linear-competitors`.

mod constant_q;
mod maxwell_branches;
mod model;
mod scaled_modulus;
#[cfg(test)]
mod tests;

pub use constant_q::ConstantQ;
pub(crate) use constant_q::LOSS_FACTOR;
pub use maxwell_branches::MaxwellBranches;
pub use model::LinearModel;
pub use scaled_modulus::{FreeParameter, ScaledModulus};

use std::fmt::Debug;

use num_complex::Complex64;

use crate::law::{Role, Scale, StatedParameter};
use crate::special_case::{PronySeries, SpecialCase};

/// A law of linear viscoelasticity, given by its shape E(s)/E and identified together with ln E.
///
/// ```
/// use maxwellid::linear::{LinearLaw, LinearModel};
/// use num_complex::Complex64;
///
/// /// E(s) = E (1 + s τ): a Kelvin-Voigt rod.
/// #[derive(Debug)]
/// struct KelvinVoigt;
///
/// impl LinearLaw for KelvinVoigt {
///     fn name(&self) -> &str { "Kelvin-Voigt" }
///     fn parameter_names(&self) -> Vec<&'static str> { vec!["ln_time"] }
///     fn start(&self) -> Vec<f64> { vec![(1e-6_f64).ln()] }
///     fn step_limits(&self) -> Vec<f64> { vec![1.0] }
///     fn ranges(&self) -> Vec<(f64, f64)> { vec![((1e-8_f64).ln(), (1e-4_f64).ln())] }
///     fn shape(&self, s: Complex64, parameters: &[f64]) -> Option<Complex64> {
///         Some(1.0 + s * parameters[0].exp())
///     }
/// }
///
/// let model = LinearModel::new(KelvinVoigt);
/// # let _ = model;
/// ```
pub trait LinearLaw: Debug + Send + Sync {
    /// Name of the law.
    fn name(&self) -> &str;

    /// Names of the parameters p, without ln E.
    fn parameter_names(&self) -> Vec<&'static str>;

    /// Starting values of p.
    fn start(&self) -> Vec<f64>;

    /// Largest change of each parameter in one iteration.
    fn step_limits(&self) -> Vec<f64>;

    /// Search range of each parameter, from which standard samples are drawn: about ±2 standard
    /// deviations of the prior.
    fn ranges(&self) -> Vec<(f64, f64)>;

    /// Index of the parameter that scales the damping, if there is one.
    fn damping_parameter(&self) -> Option<usize> {
        None
    }

    /// Parameters that are logarithms of thermally activated quantities, as in
    /// [`crate::RodModel::thermal_orders`], counted among the parameters of the law.
    fn thermal_orders(&self) -> Vec<(usize, f64)> {
        Vec::new()
    }

    /// Returns true if the loss factor can be nearly constant over a decade of frequency, so that
    /// the law can distinguish flat loss from a nonlinearity.
    fn is_flat_loss(&self) -> bool {
        false
    }

    /// The equivalent Prony series of modulus E \[Pa\] at p, if there is one.
    fn prony(&self, _modulus: f64, _parameters: &[f64]) -> Option<PronySeries> {
        None
    }

    /// The position of `series` among the limits of this law, with its θ = (ln E, p); `None` if the
    /// law does not contain it.
    fn special_case(&self, _series: &PronySeries) -> Option<SpecialCase> {
        None
    }

    /// The parameters p as stated in the literature, for a modulus E \[Pa\]; gradients are with
    /// respect to θ = (ln E, p).
    ///
    /// By default `ln_x` is stated as x with an error as a ratio; other parameters are unchanged.
    fn stated(&self, _modulus: f64, parameters: &[f64]) -> Vec<StatedParameter> {
        let names = self.parameter_names().into_iter().zip(parameters);
        names
            .enumerate()
            .map(|(index, (name, value))| {
                let mut gradient = vec![0.0; parameters.len() + 1];
                if let Some(own) = gradient.get_mut(index + 1) {
                    *own = 1.0;
                }
                let logarithm = name.strip_prefix("ln_");
                StatedParameter {
                    name: logarithm.unwrap_or(name),
                    symbol: logarithm.unwrap_or(name),
                    unit: if name.contains("time") { "s" } else { "1" },
                    value: if logarithm.is_some() {
                        value.exp()
                    } else {
                        *value
                    },
                    scale: if logarithm.is_some() {
                        Scale::Ratio
                    } else {
                        Scale::Difference
                    },
                    gradient,
                    role: Role::Coordinate,
                }
            })
            .collect()
    }

    /// E(s)/E for Re s > 0 \[1\]; `None` where the law does not exist.
    ///
    /// It must be real for real s and analytic for Re s > 0.
    fn shape(&self, s: Complex64, parameters: &[f64]) -> Option<Complex64>;

    /// E(s)/E at each of `arguments`, for one p; `None` where the law does not exist. By default,
    /// the values come from [`Self::shape`].
    fn shapes(&self, arguments: &[Complex64], parameters: &[f64]) -> Option<Vec<Complex64>> {
        let each = arguments.iter().map(|s| self.shape(*s, parameters));
        each.collect()
    }

    /// E(s)/E with its derivatives with respect to p, written to `derivatives`, one for each
    /// parameter; `None` where the law does not exist.
    ///
    /// The default is a fourth-order finite difference over ±1e-3 and ±2e-3 of each parameter, with
    /// an error of about 1e-12 of its fifth derivative.
    fn shape_with_derivatives(
        &self,
        s: Complex64,
        parameters: &[f64],
        derivatives: &mut [Complex64],
    ) -> Option<Complex64> {
        const STEP: f64 = 1e-3;
        let mut moved = parameters.to_vec();
        for (index, derivative) in derivatives.iter_mut().enumerate() {
            let present = *parameters.get(index)?;
            let mut at = |step: f64| {
                *moved.get_mut(index)? = present + step;
                let value = self.shape(s, &moved);
                *moved.get_mut(index)? = present;
                value
            };
            let near = at(STEP)? - at(-STEP)?;
            let far = at(2.0 * STEP)? - at(-2.0 * STEP)?;
            *derivative = (8.0 * near - far) / (12.0 * STEP);
        }
        self.shape(s, parameters)
    }
}
