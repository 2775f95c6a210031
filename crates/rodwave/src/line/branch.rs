//! One spring in series with any inelastic law.

use std::any::TypeId;
use std::fmt::Debug;
use std::sync::Arc;

use crate::inelastic::{Elastic, InelasticLaw, LANES, RelaxationFlow, StressChange, lanes};

/// A modulus with a law behind a pointer, so that a line may mix laws.
#[derive(Debug, Clone)]
pub(super) struct Branch {
    pub(super) modulus: f64,
    pub(super) law: Arc<dyn BranchLaw>,
}

/// Type-erased [`InelasticLaw`].
pub(super) trait BranchLaw: Debug + Send + Sync {
    fn parameters(&self) -> &'static [&'static str];
    fn flow(&self, modulus: f64, duration: f64) -> Box<dyn BranchFlow>;
}

impl<L: InelasticLaw + 'static> BranchLaw for L
where
    L::Flow: Debug + Clone + 'static,
{
    fn parameters(&self) -> &'static [&'static str] {
        L::PARAMETERS
    }

    fn flow(&self, modulus: f64, duration: f64) -> Box<dyn BranchFlow> {
        Box::new(Flow {
            flow: InelasticLaw::flow(self, modulus, duration),
            parameters: L::PARAMETERS.len(),
            // a law without parameters is not necessarily elastic
            is_elastic: TypeId::of::<L>() == TypeId::of::<Elastic>(),
        })
    }
}

/// Waves of one material, R = s - v and L = s + v [m/s] with s = σ/Z, in whole blocks padded with
/// cells at rest.
pub(super) struct Waves<'a> {
    pub(super) right: &'a mut [[f64; LANES]],
    pub(super) left: &'a mut [[f64; LANES]],
    pub(super) impedance: f64,
}

/// Type-erased [`RelaxationFlow`]. One call serves many cells, which makes the cost of the
/// indirection negligible.
pub(super) trait BranchFlow: Debug + Send + Sync {
    /// Returns true if the branch does not relax.
    fn is_elastic(&self) -> bool;

    /// Relaxes a material that consists of this branch alone; returns Σ (σ0² - σ1²).
    fn relax_waves(&self, waves: Waves<'_>) -> f64;

    /// Replaces each stress by its change; returns Σ (σ0² - σ1²).
    fn change(&self, stress: &mut [f64]) -> f64;

    /// Returns the change of several cells with its derivatives.
    fn change_with_sensitivity(&self, stress: &[f64; LANES]) -> StressChange;

    fn boxed_clone(&self) -> Box<dyn BranchFlow>;
}

impl Clone for Box<dyn BranchFlow> {
    fn clone(&self) -> Self {
        self.boxed_clone()
    }
}

#[derive(Debug, Clone)]
struct Flow<F> {
    flow: F,
    parameters: usize,
    is_elastic: bool,
}

impl<F: RelaxationFlow + Debug + Clone + Send + Sync + 'static> BranchFlow for Flow<F> {
    fn is_elastic(&self) -> bool {
        self.is_elastic
    }

    fn relax_waves(&self, waves: Waves<'_>) -> f64 {
        pulp::Arch::new().dispatch(RelaxWaves {
            flow: &self.flow,
            waves,
        })
    }

    fn change(&self, stress: &mut [f64]) -> f64 {
        pulp::Arch::new().dispatch(Change {
            flow: &self.flow,
            stress,
        })
    }

    fn change_with_sensitivity(&self, stress: &[f64; LANES]) -> StressChange {
        pulp::Arch::new().dispatch(ChangeWithSensitivity {
            flow: &self.flow,
            stress,
            parameters: self.parameters,
        })
    }

    fn boxed_clone(&self) -> Box<dyn BranchFlow> {
        Box::new(self.clone())
    }
}

struct RelaxWaves<'a, F> {
    flow: &'a F,
    waves: Waves<'a>,
}

impl<F: RelaxationFlow> pulp::NullaryFnOnce for RelaxWaves<'_, F> {
    type Output = f64;

    #[inline(always)]
    #[allow(
        clippy::indexing_slicing,
        reason = "the counter stays below `LANES`, the length of all five arrays"
    )]
    fn call(self) -> f64 {
        let Waves {
            right,
            left,
            impedance,
        } = self.waves;
        let inverse = 1.0 / impedance;
        let mut loss = [0.0; LANES];
        for (right, left) in right.iter_mut().zip(left) {
            let stress = lanes!(|i| 0.5 * impedance * (right[i] + left[i]));
            let change = self.flow.change(&stress);
            for i in 0..LANES {
                loss[i] -= change[i] * (2.0 * stress[i] + change[i]);
                right[i] += change[i] * inverse;
                left[i] += change[i] * inverse;
            }
        }
        loss.iter().sum()
    }
}

struct Change<'a, F> {
    flow: &'a F,
    stress: &'a mut [f64],
}

impl<F: RelaxationFlow> pulp::NullaryFnOnce for Change<'_, F> {
    type Output = f64;

    #[inline(always)]
    #[allow(
        clippy::indexing_slicing,
        reason = "a chunk of `LANES` is no longer than an array of `LANES`"
    )]
    fn call(self) -> f64 {
        let mut loss = [0.0; LANES];
        for block in self.stress.chunks_mut(LANES) {
            let mut stress = [0.0; LANES];
            stress[..block.len()].copy_from_slice(block);
            let change = self.flow.change(&stress);
            for ((loss, stress), change) in loss.iter_mut().zip(stress).zip(change) {
                *loss -= change * (2.0 * stress + change);
            }
            block.copy_from_slice(&change[..block.len()]);
        }
        loss.iter().sum()
    }
}

struct ChangeWithSensitivity<'a, F> {
    flow: &'a F,
    stress: &'a [f64; LANES],
    parameters: usize,
}

impl<F: RelaxationFlow> pulp::NullaryFnOnce for ChangeWithSensitivity<'_, F> {
    type Output = StressChange;

    #[inline(always)]
    fn call(self) -> StressChange {
        self.flow
            .change_with_sensitivity(self.stress, self.parameters)
    }
}
