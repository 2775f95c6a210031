//! Special cases: one law as the limit of another.
//!
//! The common form of linear laws is a Prony series, E(s)/E = w₀ + Σ wᵢ sτᵢ/(1 + sτᵢ). A model that
//! has this form for some values of its parameters returns it by [`RodModel::prony`], and one that
//! contains a series as a limit returns its parameters by [`RodModel::special_case`]. A fit of the
//! general law that starts there is never worse than a fit of the special law.
//!
//! [`RodModel::prony`]: crate::RodModel::prony
//! [`RodModel::special_case`]: crate::RodModel::special_case

/// Relaxation time \[s\] that represents no relaxation: it changes a response by a fraction of 1e-5
/// within milliseconds.
pub(crate) const UNRELAXED: f64 = 1e3;

/// Share of the modulus that represents zero.
pub(crate) const NO_SHARE: f64 = 1e-7;

/// A linear law as a Prony series.
///
/// ```text
/// E(s) = E (w₀ + Σ wᵢ sτᵢ/(1 + sτᵢ)) ,    w₀ + Σ wᵢ = 1
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PronySeries {
    /// Unrelaxed modulus E \[Pa\].
    pub modulus: f64,
    /// Share w₀ of the spring; 0 without one.
    pub spring: f64,
    /// Maxwell branches.
    pub branches: Vec<Branch>,
}

/// A Maxwell branch of a [`PronySeries`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Branch {
    /// Share wᵢ of the unrelaxed modulus.
    pub share: f64,
    /// Relaxation time τᵢ \[s\].
    pub time: f64,
}

impl PronySeries {
    /// Creates the elastic rod of modulus E \[Pa\].
    #[must_use]
    pub fn elastic(modulus: f64) -> Self {
        Self {
            modulus,
            spring: 1.0,
            branches: Vec::new(),
        }
    }

    /// Creates one branch without a spring: the Maxwell law of modulus E \[Pa\] and relaxation time
    /// τ \[s\].
    #[must_use]
    pub fn maxwell(modulus: f64, time: f64) -> Self {
        Self {
            modulus,
            spring: 0.0,
            branches: vec![Branch { share: 1.0, time }],
        }
    }

    /// Relaxation time \[s\] of a Maxwell law, or [`UNRELAXED`] for an elastic rod; `None` for any
    /// other series.
    #[must_use]
    pub(crate) fn single_time(&self) -> Option<f64> {
        match self.branches.as_slice() {
            [] => Some(UNRELAXED),
            [branch] if self.spring == 0.0 => Some(branch.time),
            _ => None,
        }
    }
}

/// A law as the limit of a more general one.
#[derive(Debug, Clone, PartialEq)]
pub struct SpecialCase {
    /// Parameters θ of the general model at which it is the special one, within rounding of its
    /// response.
    pub parameters: Vec<f64>,
    /// The limit in words that follow the name of the general law, for example `with kappa = 1`.
    pub limit: String,
}
