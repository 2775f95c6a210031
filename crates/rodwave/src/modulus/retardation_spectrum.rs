//! Creep of a generalised Maxwell law: its retardation times and compliances.

use super::time_domain::{after_step, finite_compliance};
use super::{GeneralisedMaxwell, MaxwellBranch};
use crate::RodwaveError;

/// One Kelvin-Voigt model of a [`RetardationSpectrum`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KelvinVoigtElement {
    /// Compliance Jⱼ [1/Pa].
    pub compliance: f64,
    /// Retardation time λⱼ \[s\].
    pub retardation_time: f64,
}

/// Generalised Kelvin-Voigt chain that is equivalent to a [`GeneralisedMaxwell`] law.
///
/// ```text
/// J(t) = J₀ + t/η + Σ Jⱼ (1 - e^{-t/λⱼ})
/// ```
///
/// The values -1/λⱼ are the zeros of E(s). All are real: one between any two neighbouring poles
/// -1/τᵢ and, for a solid, one more beyond the slowest pole. The residues of 1/(s E(s)) give
///
/// ```text
/// 1/Jⱼ = λⱼ Σ Eᵢτᵢ/(λⱼ - τᵢ)² ,    J₀ = 1/(E∞ + Σ Eᵢ) ,    η = Σ Eᵢτᵢ for a fluid
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RetardationSpectrum {
    /// Instantaneous compliance J₀ [1/Pa].
    pub instantaneous_compliance: f64,
    /// Fluidity 1/η [1/(Pa s)], 0 for a solid.
    pub fluidity: f64,
    /// Kelvin-Voigt models, in the order of increasing retardation times.
    pub elements: Vec<KelvinVoigtElement>,
}

impl GeneralisedMaxwell {
    /// Returns the same material as instantaneous compliance, Kelvin-Voigt models and, for a fluid,
    /// a dashpot in series.
    #[must_use]
    pub fn retardation_spectrum(&self) -> RetardationSpectrum {
        RetardationSpectrum::of(self)
    }
}

impl RetardationSpectrum {
    pub(super) fn of(law: &GeneralisedMaxwell) -> Self {
        let branches = distinct(law.branches());
        let viscosity: f64 = branches.iter().map(MaxwellBranch::viscosity).sum();
        let solid = law.equilibrium_modulus() > 0.0;
        // Each zero is between its pole and the next; the last zero of a solid is below the bound
        // that follows from E∞.
        let above_slowest = solid.then(|| viscosity / law.equilibrium_modulus());
        let gaps = branches
            .windows(2)
            .map(|pair| match pair {
                [left, right] => right.relaxation_time - left.relaxation_time,
                _ => 0.0,
            })
            .chain(above_slowest);
        let elements = branches
            .iter()
            .zip(gaps)
            .map(|(branch, gap)| element(law, &branches, branch.relaxation_time, gap))
            .collect();
        Self {
            instantaneous_compliance: 1.0 / law.unrelaxed_modulus(),
            fluidity: if solid { 0.0 } else { 1.0 / viscosity },
            elements,
        }
    }

    /// Creep compliance J(t) [1/Pa] at `time` t > 0 \[s\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the time is finite and above 0.
    pub fn creep_compliance(&self, time: f64) -> Result<f64, RodwaveError> {
        let time = after_step(time)?;
        let retarded: f64 = self
            .elements
            .iter()
            .map(|element| -element.compliance * (-time / element.retardation_time).exp_m1())
            .sum();
        finite_compliance(self.instantaneous_compliance + self.fluidity * time + retarded)
    }
}

impl MaxwellBranch {
    fn viscosity(&self) -> f64 {
        self.modulus * self.relaxation_time
    }
}

/// Returns the branches in the order of their relaxation times; branches with equal times are
/// added.
fn distinct(branches: &[MaxwellBranch]) -> Vec<MaxwellBranch> {
    let mut sorted = branches.to_vec();
    sorted.sort_by(|a, b| a.relaxation_time.total_cmp(&b.relaxation_time));
    sorted.dedup_by(|later, kept| {
        let same = later.relaxation_time <= kept.relaxation_time;
        if same {
            kept.modulus += later.modulus;
        }
        same
    });
    sorted
}

/// Finds the zero λ = τ + δ of E(-1/λ) = E∞ - Σ Eᵢτᵢ/(λ - τᵢ) with 0 < δ <= gap, where the function
/// increases from -∞, by bisection.
///
/// The distance to the pole is bisected because a weak branch has its zero within rounding of its
/// pole.
fn element(
    law: &GeneralisedMaxwell,
    branches: &[MaxwellBranch],
    pole: f64,
    gap: f64,
) -> KelvinVoigtElement {
    let (mut low, mut high) = (0.0, gap);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        let modulus: f64 = branches
            .iter()
            .map(|branch| -branch.viscosity() / (pole - branch.relaxation_time + middle))
            .sum();
        if law.equilibrium_modulus() + modulus < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let retardation_time = pole + high;
    let stiffness: f64 = branches
        .iter()
        .map(|branch| branch.viscosity() / (pole - branch.relaxation_time + high).powi(2))
        .sum();
    KelvinVoigtElement {
        compliance: 1.0 / (retardation_time * stiffness),
        retardation_time,
    }
}
