//! Catalogue of the laws that are identified and compared by name.

use std::sync::LazyLock;

use rodwave::inelastic::{
    DEFAULT_REFERENCE_STRESS, Elastic, Eyring, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};

use crate::branched::BranchedRod;
use crate::law::StatedParameter;
use crate::linear::{ConstantQ, LinearModel, MaxwellBranches};
use crate::model::{DrivenRod, LinearisedResponse, RodModel, forwarded_rod_model};
use crate::special_case::{PronySeries, SpecialCase};
use crate::specimen::SpecimenSensitivity;

/// A law of the rod with its parameters, their starts and their bounds: a [`RodModel`].
///
/// | law | parameters besides E |
/// |---|---|
/// | elastic | |
/// | Maxwell | viscosity η |
/// | two, three Maxwell branches | shares, relaxation times |
/// | Zener | share of the branch, relaxation time |
/// | constant Q | loss factor |
/// | Norton | exponent κ, rate at 10 MPa |
/// | Gurevich-Rabinovich | activation stress m, rate at 10 MPa |
/// | Eyring | activation stress σ*, rate at 10 MPa |
/// | Zhu-Wang-Tang | shares and relaxation times of two branches |
/// | Zener with a nonlinear dashpot | share of the spring, and those of the dashpot |
/// | Maxwell beside Norton or Gurevich-Rabinovich | share and relaxation time of the linear branch, and those of the other |
///
/// (Ödeen 1993, paper D, Table 1) has Maxwell, Norton and Gurevich-Rabinovich.
///
/// ```
/// use maxwellid::{Law, RodModel};
///
/// assert_eq!(Law::Norton.name(), "Maxwell-Norton");
/// assert_eq!(Law::Norton.parameter_names(), ["ln_modulus", "exponent", "ln_reference_rate"]);
/// assert!(Law::Zener.is_linear() && !Law::GurevichRabinovich.is_linear());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[non_exhaustive]
pub enum Law {
    /// The elastic rod, the null hypothesis.
    Elastic,
    /// A spring and a linear dashpot in series.
    Maxwell,
    /// Two Maxwell branches in parallel.
    TwoMaxwellBranches,
    /// Three Maxwell branches in parallel.
    ThreeMaxwellBranches,
    /// A spring in parallel with a Maxwell branch, the standard linear solid.
    Zener,
    /// A loss factor that does not depend on frequency.
    ConstantQ,
    /// A spring and the dashpot of Norton, F = (σ/B)^κ, in series.
    Norton,
    /// A spring and the dashpot of Gurevich and Rabinovich, F = σ exp(σ/m)/η, in series.
    GurevichRabinovich,
    /// A spring and the dashpot of Eyring, F = ε̇₀ sinh(σ/σ*), in series.
    Eyring,
    /// A spring in parallel with a fast and a slow Maxwell branch, the law of Zhu, Wang and Tang at
    /// strains at which its equilibrium is linear.
    ZhuWangTang,
    /// A spring in parallel with a branch of Norton's dashpot.
    ZenerNorton,
    /// A spring in parallel with a branch of the dashpot of Gurevich and Rabinovich.
    ZenerGurevichRabinovich,
    /// A spring in parallel with a branch of Eyring's dashpot.
    ZenerEyring,
    /// A linear Maxwell branch in parallel with one of Norton's dashpot.
    MaxwellAndNorton,
    /// A linear Maxwell branch in parallel with one of the dashpot of Gurevich and Rabinovich.
    MaxwellAndGurevichRabinovich,
}

impl Law {
    /// The laws of a usual comparison: those of paper D and their linear competitors, simple ones
    /// first and nonlinear ones last.
    pub const STANDARD: [Self; 8] = [
        Self::Elastic,
        Self::Maxwell,
        Self::TwoMaxwellBranches,
        Self::ThreeMaxwellBranches,
        Self::Zener,
        Self::ConstantQ,
        Self::Norton,
        Self::GurevichRabinovich,
    ];

    /// Nonlinear laws with an equilibrium.
    pub const WITH_EQUILIBRIUM: [Self; 2] = [Self::ZenerNorton, Self::ZenerGurevichRabinovich];

    /// Nonlinear laws with a linear branch beside.
    pub const WITH_LINEAR_BRANCH: [Self; 2] =
        [Self::MaxwellAndNorton, Self::MaxwellAndGurevichRabinovich];

    /// The nonlinear law that remains of this one without its spring or linear branch.
    #[must_use]
    pub fn of_branch(self) -> Option<Self> {
        match self {
            Self::ZenerNorton | Self::MaxwellAndNorton => Some(Self::Norton),
            Self::ZenerGurevichRabinovich | Self::MaxwellAndGurevichRabinovich => {
                Some(Self::GurevichRabinovich)
            }
            Self::ZenerEyring => Some(Self::Eyring),
            _ => None,
        }
    }

    /// The model at the shape from which its parameters start.
    #[expect(
        clippy::expect_used,
        reason = "rates and stresses are positive constants"
    )]
    fn model(self) -> &'static dyn RodModel {
        type Branches = LazyLock<LinearModel<MaxwellBranches>>;
        const RATE: f64 = 1.0;
        const STRESS: f64 = DEFAULT_REFERENCE_STRESS;
        const POSITIVE: &str = "positive constants";
        fn norton() -> MaxwellNorton {
            MaxwellNorton::from_reference_rate(1.5, RATE, STRESS).expect(POSITIVE)
        }
        fn gurevich_rabinovich() -> MaxwellGurevichRabinovich {
            MaxwellGurevichRabinovich::from_reference_rate(1.0, RATE, STRESS).expect(POSITIVE)
        }
        fn eyring() -> Eyring {
            Eyring::from_reference_rate(2.0, RATE, STRESS).expect(POSITIVE)
        }
        static MAXWELL: LazyLock<Maxwell> =
            LazyLock::new(|| Maxwell::from_reference_rate(RATE, STRESS).expect(POSITIVE));
        static TWO: Branches = LazyLock::new(|| LinearModel::new(MaxwellBranches::two()));
        static THREE: Branches = LazyLock::new(|| LinearModel::new(MaxwellBranches::three()));
        static ZENER: Branches = LazyLock::new(|| LinearModel::new(MaxwellBranches::zener()));
        static CONSTANT_Q: LazyLock<LinearModel<ConstantQ>> =
            LazyLock::new(|| LinearModel::new(ConstantQ::default()));
        static NORTON: LazyLock<MaxwellNorton> = LazyLock::new(norton);
        static GUREVICH_RABINOVICH: LazyLock<MaxwellGurevichRabinovich> =
            LazyLock::new(gurevich_rabinovich);
        static EYRING: LazyLock<Eyring> = LazyLock::new(eyring);
        static ZHU_WANG_TANG: Branches =
            LazyLock::new(|| LinearModel::new(MaxwellBranches::zhu_wang_tang()));
        static ZENER_EYRING: LazyLock<BranchedRod<Eyring>> =
            LazyLock::new(|| BranchedRod::standard_solid(eyring(), "Zener-Eyring"));
        static ZENER_NORTON: LazyLock<BranchedRod<MaxwellNorton>> =
            LazyLock::new(|| BranchedRod::standard_solid(norton(), "Zener-Norton"));
        static ZENER_GUREVICH: LazyLock<BranchedRod<MaxwellGurevichRabinovich>> =
            LazyLock::new(|| {
                let law = gurevich_rabinovich();
                BranchedRod::standard_solid(law, "Zener-Gurevich-Rabinovich")
            });
        static MAXWELL_NORTON: LazyLock<BranchedRod<MaxwellNorton>> =
            LazyLock::new(|| BranchedRod::beside_maxwell(norton(), "Maxwell and Norton branches"));
        static MAXWELL_GUREVICH: LazyLock<BranchedRod<MaxwellGurevichRabinovich>> =
            LazyLock::new(|| {
                let law = gurevich_rabinovich();
                BranchedRod::beside_maxwell(law, "Maxwell and Gurevich-Rabinovich branches")
            });
        match self {
            Self::Elastic => &Elastic,
            Self::Maxwell => &*MAXWELL,
            Self::TwoMaxwellBranches => &*TWO,
            Self::ThreeMaxwellBranches => &*THREE,
            Self::Zener => &*ZENER,
            Self::ConstantQ => &*CONSTANT_Q,
            Self::Norton => &*NORTON,
            Self::GurevichRabinovich => &*GUREVICH_RABINOVICH,
            Self::Eyring => &*EYRING,
            Self::ZhuWangTang => &*ZHU_WANG_TANG,
            Self::ZenerEyring => &*ZENER_EYRING,
            Self::ZenerNorton => &*ZENER_NORTON,
            Self::ZenerGurevichRabinovich => &*ZENER_GUREVICH,
            Self::MaxwellAndNorton => &*MAXWELL_NORTON,
            Self::MaxwellAndGurevichRabinovich => &*MAXWELL_GUREVICH,
        }
    }
}

forwarded_rod_model!(Law, this => this.model());
