//! Termination after the last element.

use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;

use super::face::Face;
use super::{AngularFrequency, Argument, LaplaceVariable, WaveMedium};
use crate::RodwaveError;
use crate::element::{CrossSection, check_static_impedance};
use crate::error::{check_not_negative, check_positive, check_propagation};
use crate::quotient::quotient;

/// Termination after the last element of a chain: a relation between N and v on its far face.
///
/// `V` is inferred from the chain.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Termination<V: Argument = AngularFrequency> {
    /// A free end: N = 0.
    Free,
    /// A rigid wall: v = 0.
    Fixed,
    /// A rigid mass \[kg\], for example an accelerometer: N = -iωm v.
    Mass(f64),
    /// A dashpot of this resistance q [kg/s] to the ground: N = -q v (Ödeen 1993, paper E, eqs. A6
    /// and A12).
    Dashpot(f64),
    /// Any impedance; created by [`Termination::impedance`] or [`Termination::impedance_at_s`].
    Impedance(Impedance<V>),
    /// A semi-infinite rod, N = -Z v; created by [`Termination::semi_infinite`].
    SemiInfinite {
        /// Material of the rod.
        medium: Arc<dyn WaveMedium<V>>,
        /// Cross-section of the rod.
        section: CrossSection,
    },
}

/// An impedance F/v [kg/s] as a function of the frequency.
#[derive(Clone)]
pub struct Impedance<V>(Arc<dyn Fn(V) -> Complex64 + Send + Sync>);

impl<V> fmt::Debug for Impedance<V> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Impedance").finish_non_exhaustive()
    }
}

impl Termination<AngularFrequency> {
    /// Creates a termination of impedance Ẑ = F̂/v̂ [kg/s], a function of ω [rad/s], measured or
    /// computed.
    ///
    /// A passive impedance has Re Ẑ >= 0, which is not checked.
    #[must_use]
    pub fn impedance(law: impl Fn(f64) -> Complex64 + Send + Sync + 'static) -> Self {
        Self::Impedance(Impedance(Arc::new(move |argument: AngularFrequency| {
            law(argument.omega())
        })))
    }
}

impl Termination<LaplaceVariable> {
    /// Creates a termination of impedance Z(s) = F/v [kg/s], a function of the Laplace variable s
    /// [1/s], analytic for Re s > 0.
    #[must_use]
    pub fn impedance_at_s(law: impl Fn(Complex64) -> Complex64 + Send + Sync + 'static) -> Self {
        Self::Impedance(Impedance(Arc::new(move |argument: LaplaceVariable| {
            law(argument.s())
        })))
    }
}

impl<V: Argument> Termination<V> {
    /// Creates a semi-infinite rod of this `medium` and `section`, whose far end returns no wave,
    /// like the long cylindrical rod of paper E (eqs. 10 and A16).
    #[must_use]
    pub fn semi_infinite<M>(medium: &M, section: impl Into<CrossSection>) -> Self
    where
        M: WaveMedium<V> + Clone + 'static,
    {
        Self::SemiInfinite {
            medium: Arc::new(medium.clone()),
            section: section.into(),
        }
    }

    /// Checks that masses and resistances are finite and not negative, and that a density is
    /// above 0.
    pub(super) fn check(&self) -> Result<(), RodwaveError> {
        match self {
            Self::Mass(mass) => check_not_negative("mass of the termination [kg]", *mass),
            Self::Dashpot(resistance) => {
                check_not_negative("resistance of the termination [kg/s]", *resistance)
            }
            Self::SemiInfinite { medium, .. } => {
                check_positive("density of the termination [kg/m^3]", medium.density())
            }
            _ => return Ok(()),
        }
        .map(drop)
    }

    /// Force and velocity of the face at the termination.
    pub(super) fn face(&self, argument: V) -> Result<Face, RodwaveError> {
        match self {
            Self::Free => Ok(Face::FREE),
            Self::Fixed => Ok(Face::FIXED),
            Self::Mass(mass) => Face::of_impedance(argument.s() * mass),
            Self::Dashpot(resistance) => Face::of_impedance((*resistance).into()),
            Self::Impedance(Impedance(law)) => Face::of_impedance(law(argument)),
            Self::SemiInfinite { medium, section } => {
                let s = argument.s();
                if s == Complex64::ZERO {
                    let static_impedance = medium.static_impedance();
                    check_static_impedance(static_impedance)?;
                    return Face::of_impedance(static_impedance * section.area());
                }
                // Z = sρA/γ (paper E, eq. 6)
                let gamma = check_propagation(medium.propagation_coefficient(argument), s)?;
                Face::of_impedance(quotient(s * (medium.density() * section.area()), gamma))
            }
        }
    }
}
