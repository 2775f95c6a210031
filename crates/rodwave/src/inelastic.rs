//! Inelastic laws: the inelastic part F(σ) of the strain rate.
//!
//! The rod of paper D obeys (Ödeen 1993, paper D, eqs. 3 and 7)
//!
//! ```text
//! ∂ε/∂t = (1/E) ∂σ/∂t + F(σ)
//! ```
//!
//! A law supplies F and the *exact* solution of the relaxation at constant strain, dσ/dt = -E F(σ),
//! over any duration (its sub-flow). With this solution, an operator-splitting solver needs no
//! restriction of the time step, and [`crate::characteristics`] creates no energy. The laws of the
//! paper are [`Maxwell`], [`MaxwellNorton`] and [`MaxwellGurevichRabinovich`]. [`Elastic`] (F = 0)
//! is their null hypothesis, and [`Eyring`] is the law of thermal activation. Other laws implement
//! the two traits of this module.
//!
//! # Parameters
//! All laws are parametrised by the *reference rate* r = F(σ_ref) at a reference stress σ_ref and,
//! if nonlinear, by a dimensionless shape parameter. The printed parameters (η, B, m) are accepted
//! by constructors and returned by getters, but they are poor coordinates for identification: for
//! data of a real rod, the correlation between κ and ln B is 0.9999, but that between κ and ln r is
//! of order 0.5.
//!
//! Theory: `docs/theory/inelastic-laws.md`.

/// Creates an array with one entry for each of the cells that are relaxed together. The counter may
/// index other arrays of length `LANES`. Unlike `std::array::from_fn`, the macro expands to a plain
/// loop, which the compiler vectorises.
macro_rules! lanes {
    (|$i:ident| $value:expr) => {{
        let mut lanes = [0.0_f64; $crate::inelastic::LANES];
        #[allow(
            clippy::indexing_slicing,
            reason = "the counter stays below `LANES`, and lanes are taken only from arrays of that length"
        )]
        for $i in 0..$crate::inelastic::LANES {
            lanes[$i] = $value;
        }
        lanes
    }};
}
pub(crate) use lanes;

#[cfg(test)]
mod battery;
mod elastic;
mod elementary;
mod exponential_integral;
mod eyring;
mod gurevich_rabinovich;
mod maxwell;
mod norton;

pub use elastic::{Elastic, ElasticFlow};
pub use eyring::{Eyring, EyringFlow};
pub use gurevich_rabinovich::{GurevichRabinovichFlow, MaxwellGurevichRabinovich};
pub use maxwell::{Maxwell, MaxwellFlow};
pub use norton::{MaxwellNorton, NortonFlow};

use crate::RodwaveError;

/// Default reference stress of the laws, 10 MPa: the order of the stress behind the front of a
/// polymer rod struck at 10 m/s.
pub const DEFAULT_REFERENCE_STRESS: f64 = 10e6;

/// Largest number of parameters of a law; the sensitivities of one cell then fit on the stack.
pub const MAX_PARAMETERS: usize = 4;

/// An inelastic strain rate F(σ) [1/s] with its exact relaxation.
///
/// # Requirements
/// F is odd, F(σ) σ >= 0 (no energy is created), and the sub-flow solves dσ/dt = -E F(σ) to
/// rounding.
pub trait InelasticLaw: Clone + std::fmt::Debug + Send + Sync {
    /// Names of the parameters, in the order of every parameter array. The last name is
    /// `ln_reference_rate` if the law has a rate.
    const PARAMETERS: &'static [&'static str];

    /// Relaxation over one fixed duration, prepared once and applied to every cell of a rod.
    type Flow: RelaxationFlow + Send + Sync;

    /// Inelastic strain rate F(σ) [1/s] at stress σ \[Pa\].
    fn inelastic_strain_rate(&self, stress: f64) -> f64;

    /// Prepares the relaxation dσ/dt = -E F(σ) over `duration` \[s\] for Young's modulus `modulus`
    /// \[Pa\].
    fn flow(&self, modulus: f64, duration: f64) -> Self::Flow;

    /// The parameters, in the order of [`Self::PARAMETERS`].
    fn parameters(&self) -> Vec<f64>;

    /// Returns the law with other parameters and the same reference stress.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] or [`RodwaveError::NonPhysical`].
    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, RodwaveError>;

    /// Stress \[Pa\] of the reference rate.
    fn reference_stress(&self) -> f64;
}

/// Number of cells that a [`RelaxationFlow`] relaxes together.
pub const LANES: usize = 16;

/// Exact relaxation of one law over one duration.
///
/// [`RelaxationFlow::change`] and [`RelaxationFlow::change_with_sensitivity`] have defaults; a law
/// whose flow needs transcendental functions may override them for speed.
pub trait RelaxationFlow {
    /// Stress \[Pa\] after the relaxation, from the stress before.
    ///
    /// |result| <= |stress|, and the sign is kept.
    fn relax(&self, stress: f64) -> f64;

    /// Stress after the relaxation, with its derivatives. The derivatives with respect to the
    /// parameters of the law are written to `by_parameter`, which has one entry per parameter. If
    /// the slice has another length, only the entries that fit are written.
    fn relax_with_sensitivity(&self, stress: f64, by_parameter: &mut [f64]) -> RelaxedStress;

    /// Stress after minus stress before \[Pa\], for several cells.
    #[inline]
    fn change(&self, stress: &[f64; LANES]) -> [f64; LANES] {
        stress.map(|stress| self.relax(stress) - stress)
    }

    /// [`RelaxationFlow::change`] with its derivatives, for several cells. `parameters` is the
    /// number of parameters of the law; derivatives are computed for [`MAX_PARAMETERS`] of them at
    /// most.
    #[inline]
    fn change_with_sensitivity(&self, stress: &[f64; LANES], parameters: usize) -> StressChange {
        cell_by_cell(self, stress, parameters)
    }
}

/// Computes the changes of several cells with their derivatives, one cell after the other.
#[allow(
    clippy::indexing_slicing,
    reason = "lanes are counted along `stress`, an array of `LANES` as those of the result, and no more than `MAX_PARAMETERS` \
              parameters are read"
)]
fn cell_by_cell<F: RelaxationFlow + ?Sized>(
    flow: &F,
    stress: &[f64; LANES],
    parameters: usize,
) -> StressChange {
    let mut result = StressChange::default();
    let mut by_parameter = [0.0; MAX_PARAMETERS];
    let parameters = parameters.min(MAX_PARAMETERS);
    for (lane, &stress) in stress.iter().enumerate() {
        let relaxed = flow.relax_with_sensitivity(stress, &mut by_parameter[..parameters]);
        result.stress[lane] = relaxed.stress - stress;
        result.by_stress[lane] = relaxed.by_stress - 1.0;
        result.by_log_modulus[lane] = relaxed.by_log_modulus;
        for (column, value) in result
            .by_parameter
            .iter_mut()
            .zip(&by_parameter[..parameters])
        {
            column[lane] = *value;
        }
    }
    result
}

/// Result of [`RelaxationFlow::relax_with_sensitivity`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxedStress {
    /// σ1, the stress after the relaxation \[Pa\].
    pub stress: f64,
    /// dσ1/dσ0, the derivative with respect to the stress before.
    pub by_stress: f64,
    /// dσ1/d ln(E h) \[Pa\]: modulus E and duration h enter only through their product.
    pub by_log_modulus: f64,
}

/// Result of [`RelaxationFlow::change_with_sensitivity`]: the change σ1 - σ0 of several cells, and
/// its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StressChange {
    /// σ1 - σ0 \[Pa\].
    pub stress: [f64; LANES],
    /// dσ1/dσ0 - 1.
    pub by_stress: [f64; LANES],
    /// dσ1/d ln(E h) \[Pa\].
    pub by_log_modulus: [f64; LANES],
    /// dσ1/dp \[Pa\] for each parameter p of the law.
    pub by_parameter: [[f64; LANES]; MAX_PARAMETERS],
}

/// Checks that a law has no more than [`MAX_PARAMETERS`] parameters.
pub(crate) fn check_parameters<L: InelasticLaw>() -> Result<(), RodwaveError> {
    if L::PARAMETERS.len() <= MAX_PARAMETERS {
        Ok(())
    } else {
        Err(RodwaveError::LengthMismatch {
            what: "list of parameters of the law",
            found: L::PARAMETERS.len(),
            expected: MAX_PARAMETERS,
        })
    }
}
