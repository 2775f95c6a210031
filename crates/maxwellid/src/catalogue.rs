//! Catalogue of the laws that are identified and compared by name.

use std::sync::{Arc, LazyLock};

use rodwave::inelastic::{
    DEFAULT_REFERENCE_STRESS, Elastic, Eyring, Maxwell, MaxwellGurevichRabinovich, MaxwellNorton,
};

use crate::branched::BranchedRod;
use crate::law::StatedParameter;
use crate::linear::{ConstantQ, LOSS_FACTOR, LinearLaw, LinearModel, MaxwellBranches};
use crate::model::{DrivenRod, LinearisedResponse, RodModel, forwarded_rod_model};
use crate::special_case::{NO_SHARE, PronySeries, SpecialCase};
use crate::specimen::SpecimenSensitivity;

/// A law of the rod with its parameters, starting values and bounds: a [`RodModel`].
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
/// | Zener with a nonlinear dashpot | share of the spring, and the parameters of the dashpot |
/// | Maxwell beside Norton or Gurevich-Rabinovich | share and relaxation time of the linear branch, and the parameters of the nonlinear dashpot |
/// | Zhu-Wang-Tang with Norton's dashpot | shares of the branches, relaxation time of the linear one, and the parameters of the nonlinear dashpot |
/// | flat loss beside Norton or Gurevich-Rabinovich | share of the nonlinear branch, loss factor of the linear ones, and the parameters of the dashpot |
///
/// Maxwell, Norton and Gurevich-Rabinovich are the laws of (Ödeen 1993, paper D, Table 1).
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
    /// strains where its equilibrium is linear.
    ZhuWangTang,
    /// A spring in parallel with a branch of Norton's dashpot.
    ZenerNorton,
    /// A spring in parallel with a branch of the dashpot of Gurevich and Rabinovich.
    ZenerGurevichRabinovich,
    /// A spring in parallel with a branch of Eyring's dashpot.
    ZenerEyring,
    /// A linear Maxwell branch in parallel with a branch of Norton's dashpot.
    MaxwellAndNorton,
    /// A linear Maxwell branch in parallel with a branch of the dashpot of Gurevich and Rabinovich.
    MaxwellAndGurevichRabinovich,
    /// A spring in parallel with a linear Maxwell branch and a branch of Norton's dashpot.
    ZhuWangTangNorton,
    /// A branch of Norton's dashpot in parallel with a linear material of constant loss factor.
    FlatLossAndNorton,
    /// A branch of the dashpot of Gurevich and Rabinovich in parallel with a linear material of
    /// constant loss factor.
    FlatLossAndGurevichRabinovich,
}

/// Prior range of the logarithm of the share of a nonlinear branch divided by that of its
/// neighbour: 0.02 to 5.
const SHARE: Option<(f64, f64)> = Some((-3.912_023, 1.609_438));

/// Prior range of ln(σ_ref/σ*) of Eyring's dashpot: σ* from 20 to 1 MPa.
const LN_SHARPNESS: Option<(f64, f64)> = Some((-std::f64::consts::LN_2, std::f64::consts::LN_10));

/// Prior range of the logarithm of the relaxation time of a linear branch: 5 us to 1 ms.
const TIME: Option<(f64, f64)> = Some(TIME_RANGE);
pub(crate) const TIME_RANGE: (f64, f64) = (-12.206_073, -6.907_755);

/// Prior range of Norton's exponent.
const EXPONENT: Option<(f64, f64)> = Some((0.25, 3.75));

/// Prior range of σ_ref/m of the dashpot of Gurevich and Rabinovich: m down to 2.9 MPa.
const SHARPNESS: Option<(f64, f64)> = Some((-0.5, 3.5));

/// A model as used in a comparison.
pub(crate) struct Compared {
    pub(crate) model: Arc<dyn RodModel>,
    /// Prior ranges of the parameters except ln E; `None` for a range that follows from the
    /// duration of the record.
    pub(crate) ranges: Vec<Option<(f64, f64)>>,
    /// True for a linear model whose loss factor may be nearly constant over a decade.
    pub(crate) is_flat_loss: bool,
}

impl Compared {
    /// Returns the model of the catalogue itself, with these ranges.
    pub(crate) fn itself(law: Law, ranges: Vec<Option<(f64, f64)>>) -> Self {
        Self {
            model: Arc::new(law),
            ranges,
            is_flat_loss: false,
        }
    }

    /// Returns a linear law with its own ranges.
    pub(crate) fn linear(law: impl LinearLaw + 'static) -> Self {
        Self {
            ranges: law.ranges().into_iter().map(Some).collect(),
            is_flat_loss: law.is_flat_loss(),
            model: Arc::new(LinearModel::new(law)),
        }
    }
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

    /// The nonlinear law that remains without the spring or linear branch of this law.
    #[must_use]
    pub fn of_branch(self) -> Option<Self> {
        match self {
            Self::ZenerNorton
            | Self::MaxwellAndNorton
            | Self::ZhuWangTangNorton
            | Self::FlatLossAndNorton => Some(Self::Norton),
            Self::ZenerGurevichRabinovich
            | Self::MaxwellAndGurevichRabinovich
            | Self::FlatLossAndGurevichRabinovich => Some(Self::GurevichRabinovich),
            Self::ZenerEyring => Some(Self::Eyring),
            _ => None,
        }
    }

    /// Parameters between ln E and those of the dashpot at which only the nonlinear branch is left,
    /// and this limit in words.
    pub(crate) fn of_branch_alone(self) -> (Vec<f64>, &'static str) {
        let all = -NO_SHARE.ln();
        let middle = |(low, high): (f64, f64)| 0.5 * (low + high);
        match self {
            // a linear branch with a share of zero may have any relaxation time
            Self::MaxwellAndNorton | Self::MaxwellAndGurevichRabinovich => {
                (vec![all, middle(TIME_RANGE)], "without its linear branch")
            }
            Self::ZhuWangTangNorton => (
                vec![0.0, all, middle(TIME_RANGE)],
                "without its spring and its linear branch",
            ),
            Self::FlatLossAndNorton | Self::FlatLossAndGurevichRabinovich => {
                (vec![all, middle(LOSS_FACTOR)], "without its flat loss")
            }
            _ => (vec![all], "without its spring"),
        }
    }

    /// Returns the law as it is compared with others.
    pub(crate) fn compared(self) -> Compared {
        let ranges = match self {
            Self::Maxwell => return Compared::linear(MaxwellBranches::maxwell()),
            Self::TwoMaxwellBranches => return Compared::linear(MaxwellBranches::two()),
            Self::ThreeMaxwellBranches => return Compared::linear(MaxwellBranches::three()),
            Self::Zener => return Compared::linear(MaxwellBranches::zener()),
            Self::ConstantQ => return Compared::linear(ConstantQ::default()),
            Self::ZhuWangTang => return Compared::linear(MaxwellBranches::zhu_wang_tang()),
            Self::Elastic => Vec::new(),
            Self::Norton => vec![EXPONENT, None],
            Self::GurevichRabinovich => vec![SHARPNESS, None],
            Self::Eyring => vec![LN_SHARPNESS, None],
            Self::ZenerEyring => vec![SHARE, LN_SHARPNESS, None],
            Self::ZenerNorton => vec![SHARE, EXPONENT, None],
            Self::ZenerGurevichRabinovich => vec![SHARE, SHARPNESS, None],
            Self::MaxwellAndNorton => vec![SHARE, TIME, EXPONENT, None],
            Self::MaxwellAndGurevichRabinovich => vec![SHARE, TIME, SHARPNESS, None],
            Self::ZhuWangTangNorton => vec![SHARE, SHARE, TIME, EXPONENT, None],
            Self::FlatLossAndNorton => vec![SHARE, Some(LOSS_FACTOR), EXPONENT, None],
            Self::FlatLossAndGurevichRabinovich => {
                vec![SHARE, Some(LOSS_FACTOR), SHARPNESS, None]
            }
        };
        Compared::itself(self, ranges)
    }

    /// Returns the model with the shape at which a search for its parameters starts.
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
        static ZHU_WANG_TANG_NORTON: LazyLock<BranchedRod<MaxwellNorton>> = LazyLock::new(|| {
            BranchedRod::standard_solid(norton(), "Zhu-Wang-Tang-Norton").with_linear_branch()
        });
        static FLAT_NORTON: LazyLock<BranchedRod<MaxwellNorton>> = LazyLock::new(|| {
            BranchedRod::beside_flat_loss(norton(), "flat loss and Norton branch")
        });
        static FLAT_GUREVICH: LazyLock<BranchedRod<MaxwellGurevichRabinovich>> =
            LazyLock::new(|| {
                let law = gurevich_rabinovich();
                BranchedRod::beside_flat_loss(law, "flat loss and Gurevich-Rabinovich branch")
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
            Self::ZhuWangTangNorton => &*ZHU_WANG_TANG_NORTON,
            Self::FlatLossAndNorton => &*FLAT_NORTON,
            Self::FlatLossAndGurevichRabinovich => &*FLAT_GUREVICH,
        }
    }
}

forwarded_rod_model!(Law, this => this.model());
