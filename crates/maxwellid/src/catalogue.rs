//! Catalogue of the laws that are identified and compared by name.

use std::sync::{Arc, LazyLock};

use rodwave::inelastic::{
    DEFAULT_REFERENCE_STRESS, Elastic, Eyring, InelasticLaw, Maxwell, MaxwellGurevichRabinovich,
    MaxwellNorton,
};

use crate::branched::BranchedRod;
use crate::law::{IdentifiableLaw, Role, Scale, StatedParameter};
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
/// | Maxwell in parallel with Norton or Gurevich-Rabinovich | share and relaxation time of the linear branch, and the parameters of the nonlinear dashpot |
/// | Zhu-Wang-Tang with Norton's dashpot | shares of the branches, relaxation time of the linear one, and the parameters of the nonlinear dashpot |
/// | flat loss in parallel with Norton or Gurevich-Rabinovich | share of the nonlinear branch, loss factor of the linear ones, and the parameters of the dashpot |
///
/// Maxwell, Norton and Gurevich-Rabinovich are the laws of (Ödeen 1993, paper D, Table 1).
///
/// # Prior ranges
/// The range of κ is 0.25 to 3.75 and that of σ_ref/m is -0.5 to 3.5 (σ_ref = 10 MPa; m down to 2.9
/// MPa); that of Eyring's σ* is 1 to 20 MPa. The share of a nonlinear branch is a fiftieth to five
/// times that of the spring or linear branch in parallel; the relaxation time of a linear branch is
/// 5 us to 1 ms.
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

/// Prior range of the logarithm of the share of a nonlinear branch divided by that of the spring or
/// linear branch in parallel: 0.02 to 5.
const SHARE: Option<(f64, f64)> = Some((-3.912_023, 1.609_438));

/// Prior range of the logarithm of the relaxation time of a linear branch: 5 us to 1 ms.
const TIME: Option<(f64, f64)> = Some(TIME_RANGE);
pub(crate) const TIME_RANGE: (f64, f64) = (-12.206_073, -6.907_755);

/// A model with the shape at which a search for its parameters starts, and its prior.
#[derive(Clone)]
pub(crate) struct Entry {
    pub(crate) model: Arc<dyn RodModel>,
    /// Prior ranges of the parameters except ln E; `None` for a range that follows from the
    /// duration of the record.
    pub(crate) ranges: Vec<Option<(f64, f64)>>,
    /// True for a linear model whose loss factor may be nearly constant over a decade.
    pub(crate) is_flat_loss: bool,
}

impl Entry {
    /// Creates the entry of a model with these prior ranges, without a flat loss factor.
    fn of(model: impl RodModel + 'static, ranges: &[Option<(f64, f64)>]) -> Self {
        Self {
            model: Arc::new(model),
            ranges: ranges.to_vec(),
            is_flat_loss: false,
        }
    }

    /// Creates the entry of a linear law, with the prior ranges that the law states.
    pub(crate) fn linear(law: impl LinearLaw + 'static) -> Self {
        Self {
            ranges: law.ranges().into_iter().map(Some).collect(),
            is_flat_loss: law.is_flat_loss(),
            model: Arc::new(LinearModel::new(law)),
        }
    }
}

/// Refers to an entry that is made at its first use and then kept.
macro_rules! kept {
    ($entry:expr) => {{
        static ENTRY: LazyLock<Entry> = LazyLock::new(|| $entry);
        &*ENTRY
    }};
}

impl Law {
    /// The laws of a standard comparison: those of paper D and their linear competitors, linear
    /// laws first.
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

    /// Nonlinear laws whose stress relaxes to an equilibrium above zero.
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

    /// Values of the parameters between ln E and those of the dashpot in the limit in which only
    /// the nonlinear branch is left, and the name of this limit.
    pub(crate) fn of_branch_alone(self) -> (Vec<f64>, &'static str) {
        let all = -NO_SHARE.ln();
        let middle = |(low, high): (f64, f64)| 0.5 * (low + high);
        match self {
            // the relaxation time of a linear branch without a share has no effect
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

    /// Returns the entry of the law, with the parameters that a fit reports.
    #[expect(
        clippy::expect_used,
        reason = "rates and stresses are positive constants"
    )]
    pub(crate) fn entry(self) -> &'static Entry {
        const RATE: f64 = 1.0;
        const STRESS: f64 = DEFAULT_REFERENCE_STRESS;
        const POSITIVE: &str = "positive constants";
        const LOSS: Option<(f64, f64)> = Some(LOSS_FACTOR);
        fn maxwell() -> Maxwell {
            Maxwell::from_reference_rate(RATE, STRESS).expect(POSITIVE)
        }
        fn norton() -> MaxwellNorton {
            MaxwellNorton::from_reference_rate(1.5, RATE, STRESS).expect(POSITIVE)
        }
        fn gurevich_rabinovich() -> MaxwellGurevichRabinovich {
            MaxwellGurevichRabinovich::from_reference_rate(1.0, RATE, STRESS).expect(POSITIVE)
        }
        fn eyring() -> Eyring {
            Eyring::from_reference_rate(2.0, RATE, STRESS).expect(POSITIVE)
        }
        match self {
            Self::Elastic => kept!(Entry::of(Elastic, &[])),
            Self::Maxwell => kept!(Entry::of(maxwell(), &[None])),
            Self::TwoMaxwellBranches => kept!(Entry::linear(MaxwellBranches::two())),
            Self::ThreeMaxwellBranches => kept!(Entry::linear(MaxwellBranches::three())),
            Self::Zener => kept!(Entry::linear(MaxwellBranches::zener())),
            Self::ConstantQ => kept!(Entry::linear(ConstantQ::default())),
            Self::Norton => kept!(Entry::of(norton(), &[EXPONENT, None])),
            Self::GurevichRabinovich => {
                kept!(Entry::of(gurevich_rabinovich(), &[SHARPNESS, None]))
            }
            Self::Eyring => kept!(Entry::of(eyring(), &[LN_SHARPNESS, None])),
            Self::ZhuWangTang => kept!(Entry::linear(MaxwellBranches::zhu_wang_tang())),
            Self::ZenerNorton => kept!(Entry::of(
                BranchedRod::standard_solid(norton(), "Zener-Norton"),
                &[SHARE, EXPONENT, None]
            )),
            Self::ZenerGurevichRabinovich => kept!(Entry::of(
                BranchedRod::standard_solid(gurevich_rabinovich(), "Zener-Gurevich-Rabinovich"),
                &[SHARE, SHARPNESS, None]
            )),
            Self::ZenerEyring => kept!(Entry::of(
                BranchedRod::standard_solid(eyring(), "Zener-Eyring"),
                &[SHARE, LN_SHARPNESS, None]
            )),
            Self::MaxwellAndNorton => kept!(Entry::of(
                BranchedRod::beside_maxwell(norton(), "Maxwell and Norton branches"),
                &[SHARE, TIME, EXPONENT, None]
            )),
            Self::MaxwellAndGurevichRabinovich => kept!(Entry::of(
                BranchedRod::beside_maxwell(
                    gurevich_rabinovich(),
                    "Maxwell and Gurevich-Rabinovich branches"
                ),
                &[SHARE, TIME, SHARPNESS, None]
            )),
            Self::ZhuWangTangNorton => kept!(Entry::of(
                BranchedRod::standard_solid(norton(), "Zhu-Wang-Tang-Norton").with_linear_branch(),
                &[SHARE, SHARE, TIME, EXPONENT, None]
            )),
            Self::FlatLossAndNorton => kept!(Entry::of(
                BranchedRod::beside_flat_loss(norton(), "flat loss and Norton branch"),
                &[SHARE, LOSS, EXPONENT, None]
            )),
            Self::FlatLossAndGurevichRabinovich => kept!(Entry::of(
                BranchedRod::beside_flat_loss(
                    gurevich_rabinovich(),
                    "flat loss and Gurevich-Rabinovich branch"
                ),
                &[SHARE, LOSS, SHARPNESS, None]
            )),
        }
    }
}

forwarded_rod_model!(Law, this => this.entry().model);

/// Bounds of the logarithm of a rate in 1/s: from the age of the universe to the period of an atom.
const LOG_RATE_BOUNDS: (f64, f64) = (-50.0, 50.0);

fn rate_at_reference(law: &impl InelasticLaw, gradient: Vec<f64>) -> StatedParameter {
    let names = ["inelastic strain rate at 10 MPa", "F(10 MPa)", "1/s"];
    let value = law.inelastic_strain_rate(law.reference_stress());
    StatedParameter::ratio(names, value, gradient)
}

impl IdentifiableLaw for Elastic {
    const NAME: &'static str = "elastic";
    const STEP_LIMITS: &'static [f64] = &[];
    const LINEAR: bool = true;

    fn stated(&self) -> Vec<StatedParameter> {
        Vec::new()
    }

    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity> {
        Vec::new()
    }

    fn at_rate(&self, _rate: f64) -> Option<Self> {
        None
    }

    fn linear_rate(&self) -> Option<f64> {
        Some(0.0)
    }
}

impl IdentifiableLaw for Maxwell {
    const NAME: &'static str = "Maxwell";
    const STEP_LIMITS: &'static [f64] = &[2.0];
    const LINEAR: bool = true;

    fn parameter_bounds(&self) -> Vec<(f64, f64)> {
        vec![LOG_RATE_BOUNDS]
    }

    fn stated(&self) -> Vec<StatedParameter> {
        vec![StatedParameter::ratio(
            ["viscosity", "eta", "Pa s"],
            self.viscosity(),
            vec![-1.0],
        )]
    }

    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity> {
        vec![SpecimenSensitivity::of_rate(1.0)]
    }

    fn at_rate(&self, rate: f64) -> Option<Self> {
        Self::from_reference_rate(rate, self.reference_stress()).ok()
    }

    fn linear_rate(&self) -> Option<f64> {
        Some(self.reference_stress() / self.viscosity())
    }

    fn at_linear_limit(&self, rate: f64) -> Option<(Self, &'static str)> {
        Some((self.at_rate(rate)?, "of the same viscosity"))
    }
}

/// Prior range of Norton's exponent.
const EXPONENT: Option<(f64, f64)> = Some((0.25, 3.75));

impl IdentifiableLaw for MaxwellNorton {
    const NAME: &'static str = "Maxwell-Norton";
    const STEP_LIMITS: &'static [f64] = &[0.5, 2.0];

    /// Returns the bounds of κ, from 0.05 (inelastic strain rate nearly independent of the stress)
    /// to 50 (nearly perfect plasticity), and of ln r. The linear law, κ = 1, is inside.
    fn parameter_bounds(&self) -> Vec<(f64, f64)> {
        vec![(0.05, 50.0), LOG_RATE_BOUNDS]
    }

    fn stated(&self) -> Vec<StatedParameter> {
        vec![
            StatedParameter {
                name: "exponent",
                symbol: "kappa",
                unit: "1",
                value: self.exponent(),
                scale: Scale::Difference,
                gradient: vec![1.0, 0.0],
                role: Role::Coordinate,
            },
            rate_at_reference(self, vec![0.0, 1.0]),
            // ln B = κ ln σ_ref - ln r
            StatedParameter::ratio(
                ["coefficient", "B", "Pa^kappa s"],
                self.coefficient(),
                vec![self.reference_stress().ln(), -1.0],
            )
            .derived(),
        ]
    }

    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity> {
        vec![
            SpecimenSensitivity::default(),
            SpecimenSensitivity::of_rate(self.exponent()),
        ]
    }

    fn at_rate(&self, rate: f64) -> Option<Self> {
        Self::from_reference_rate(self.exponent(), rate, self.reference_stress()).ok()
    }

    fn at_linear_limit(&self, rate: f64) -> Option<(Self, &'static str)> {
        let law = Self::from_reference_rate(1.0, rate, self.reference_stress()).ok()?;
        Some((law, "with kappa = 1"))
    }
}

/// Prior range of σ_ref/m of the dashpot of Gurevich and Rabinovich: m down to 2.9 MPa.
const SHARPNESS: Option<(f64, f64)> = Some((-0.5, 3.5));

/// Returns β = σ_ref/m.
#[allow(clippy::indexing_slicing, reason = "the law has two parameters")]
fn sharpness(law: &MaxwellGurevichRabinovich) -> f64 {
    InelasticLaw::parameters(law)[0]
}

impl IdentifiableLaw for MaxwellGurevichRabinovich {
    const NAME: &'static str = "Maxwell-Gurevich-Rabinovich";
    const STEP_LIMITS: &'static [f64] = &[0.5, 2.0];

    /// Returns β from -50 to 50; the linear law β = 0 is inside.
    fn parameter_bounds(&self) -> Vec<(f64, f64)> {
        vec![(-50.0, 50.0), LOG_RATE_BOUNDS]
    }

    fn stated(&self) -> Vec<StatedParameter> {
        let sharpness = sharpness(self);
        vec![
            rate_at_reference(self, vec![0.0, 1.0]),
            // ln m = ln σ_ref - ln β
            StatedParameter::ratio(
                ["activation stress", "m", "Pa"],
                self.activation_stress(),
                vec![-1.0 / sharpness, 0.0],
            ),
            // ln η = ln σ_ref + β - ln r
            StatedParameter::ratio(
                ["viscosity", "eta", "Pa s"],
                self.viscosity(),
                vec![1.0, -1.0],
            )
            .derived(),
        ]
    }

    /// ln F = ln r + ln(σ/σ_ref) + β (σ/σ_ref - 1) has the slope 1 + β at σ_ref, and β = σ_ref/m.
    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity> {
        let sharpness = sharpness(self);
        vec![
            SpecimenSensitivity {
                length: -sharpness,
                density: -sharpness,
            },
            SpecimenSensitivity::of_rate(1.0 + sharpness),
        ]
    }

    fn at_rate(&self, rate: f64) -> Option<Self> {
        Self::from_reference_rate(sharpness(self), rate, self.reference_stress()).ok()
    }

    fn at_linear_limit(&self, rate: f64) -> Option<(Self, &'static str)> {
        let law = Self::from_reference_rate(0.0, rate, self.reference_stress()).ok()?;
        Some((law, "with 1/m = 0"))
    }
}

/// Prior range of ln(σ_ref/σ*) of Eyring's dashpot: σ* from 20 to 1 MPa.
const LN_SHARPNESS: Option<(f64, f64)> = Some((-std::f64::consts::LN_2, std::f64::consts::LN_10));

/// Sharpness β = σ_ref/σ* at which Eyring's law is treated as linear: its rate differs from that of
/// the linear law by the fraction β²/6 (σ²/σ_ref² - 1), 1e-5 at a stress of 8 σ_ref.
const LINEAR_SHARPNESS: f64 = 1e-3;

impl IdentifiableLaw for Eyring {
    const NAME: &'static str = "Maxwell-Eyring";
    const STEP_LIMITS: &'static [f64] = &[0.5, 2.0];

    /// Returns bounds of ln β, for β from 1e-3 (the linear law) to 50, and of ln r.
    fn parameter_bounds(&self) -> Vec<(f64, f64)> {
        vec![(LINEAR_SHARPNESS.ln(), 50_f64.ln()), LOG_RATE_BOUNDS]
    }

    fn stated(&self) -> Vec<StatedParameter> {
        vec![
            rate_at_reference(self, vec![0.0, 1.0]),
            // ln σ* = ln σ_ref - ln β
            StatedParameter::ratio(
                ["activation stress", "sigma*", "Pa"],
                self.activation_stress(),
                vec![-1.0, 0.0],
            ),
            // ln ε̇₀ = ln r - ln sinh β
            StatedParameter::ratio(
                ["rate factor", "rate_0", "1/s"],
                self.rate_factor(),
                vec![-self.exponent_at_reference(), 1.0],
            )
            .derived(),
        ]
    }

    /// ln F has the slope β coth β at σ_ref, and β = σ_ref/σ*.
    fn specimen_sensitivities(&self) -> Vec<SpecimenSensitivity> {
        vec![
            SpecimenSensitivity {
                length: -1.0,
                density: -1.0,
            },
            SpecimenSensitivity::of_rate(self.exponent_at_reference()),
        ]
    }

    fn at_rate(&self, rate: f64) -> Option<Self> {
        let sharpness = self.reference_stress() / self.activation_stress();
        Self::from_reference_rate(sharpness, rate, self.reference_stress()).ok()
    }

    fn at_linear_limit(&self, rate: f64) -> Option<(Self, &'static str)> {
        let law =
            Self::from_reference_rate(LINEAR_SHARPNESS, rate, self.reference_stress()).ok()?;
        Some((law, "with 1/sigma* = 0"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_prior_ranges_are_those_of_the_documentation() {
        let ranges_of = |law: Law| law.entry().ranges.clone();
        assert_eq!(ranges_of(Law::Norton), [Some((0.25, 3.75)), None]);
        let gurevich = ranges_of(Law::GurevichRabinovich);
        assert_eq!(gurevich, [Some((-0.5, 3.5)), None]);
        // logarithms of 0.02 and 5, of 5 us and 1 ms
        let share = [0.02_f64.ln(), 5_f64.ln()];
        let time = [5e-6_f64.ln(), 1e-3_f64.ln()];
        let loss = [0.005_f64.ln(), 0.5_f64.ln()];
        let (kappa, ratio) = ([0.25, 3.75], [-0.5, 3.5]);
        // σ_ref/σ* of 20 and 1 MPa
        let sharpness = [0.5_f64.ln(), 10_f64.ln()];
        for (law, expected) in [
            (Law::Eyring, vec![sharpness]),
            (Law::ZenerEyring, vec![share, sharpness]),
            (Law::ZenerNorton, vec![share, kappa]),
            (Law::ZenerGurevichRabinovich, vec![share, ratio]),
            (Law::MaxwellAndNorton, vec![share, time, kappa]),
            (Law::MaxwellAndGurevichRabinovich, vec![share, time, ratio]),
            (Law::ZhuWangTangNorton, vec![share, share, time, kappa]),
            (Law::FlatLossAndNorton, vec![share, loss, kappa]),
            (Law::FlatLossAndGurevichRabinovich, vec![share, loss, ratio]),
        ] {
            let ranges = ranges_of(law);
            assert_eq!(ranges.len(), expected.len() + 1, "{law:?}");
            for (range, [low, high]) in ranges.iter().zip(expected) {
                let (from, to) = range.unwrap();
                assert!(
                    (from - low).abs() < 1e-6 && (to - high).abs() < 1e-6,
                    "{law:?}"
                );
            }
            assert_eq!(ranges.last(), Some(&None), "{law:?}");
        }
    }
}
