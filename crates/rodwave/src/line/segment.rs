//! A uniform piece of a line: length, area, density and a material of branches in parallel.

use std::sync::Arc;

use super::branch::Branch;
use crate::error::check_positive;
use crate::inelastic::{Elastic, InelasticLaw, Maxwell, check_parameters};
use crate::modulus::GeneralisedMaxwell;
use crate::{InelasticRod, RodwaveError};

/// A uniform piece of a [`Body`](super::Body).
///
/// The material consists of branches in parallel. Each branch is a spring of modulus Eᵢ in series
/// with an inelastic law Fᵢ:
///
/// ```text
/// σ = Σ σᵢ ,    ∂σᵢ/∂t = Eᵢ (∂v/∂x - Fᵢ(σᵢ)) ,    E = Σ Eᵢ
/// ```
///
/// A single branch gives the rod of paper D (Ödeen 1993, paper D, eq. 7); a spring and Maxwell
/// branches give a Zener or Prony solid.
///
/// ```
/// use rodwave::inelastic::{Elastic, Maxwell};
/// use rodwave::line::Segment;
///
/// // a Zener solid: equilibrium modulus 2 GPa, and 0.5 GPa that relaxes with a time of 0.1 ms
/// let zener = Segment::new(0.4, 2e-4, 1140.0)?
///     .with_branch(2.0e9, Elastic)?
///     .with_branch(0.5e9, Maxwell::new(0.5e9 * 1e-4)?)?;
/// assert_eq!(zener.modulus(), 2.5e9);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Segment {
    length: f64,
    area: f64,
    density: f64,
    branches: Vec<Branch>,
}

impl Segment {
    /// Creates a piece of `length` \[m\], cross-sectional `area` \[m²\] and `density` [kg/m³],
    /// without branches.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0.
    pub fn new(length: f64, area: f64, density: f64) -> Result<Self, RodwaveError> {
        Ok(Self {
            length: check_positive("length [m]", length)?,
            area: check_positive("cross-sectional area [m^2]", area)?,
            density: check_positive("density [kg/m^3]", density)?,
            branches: Vec::new(),
        })
    }

    /// Creates an elastic piece with the Young's `modulus` \[Pa\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all are finite and above 0.
    pub fn elastic(
        length: f64,
        area: f64,
        density: f64,
        modulus: f64,
    ) -> Result<Self, RodwaveError> {
        Self::new(length, area, density)?.with_branch(modulus, Elastic)
    }

    /// Creates a rod of paper D with the cross-sectional `area` \[m²\]. If the rod has a spring in
    /// parallel with its law, the spring is branch 0.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the area is finite and above 0; the errors of
    /// [`Self::with_branch`].
    pub fn of_rod<L>(rod: &InelasticRod<L>, area: f64) -> Result<Self, RodwaveError>
    where
        L: InelasticLaw + 'static,
        L::Flow: std::fmt::Debug + Clone + 'static,
    {
        let mut segment = Self::new(rod.length(), area, rod.density())?;
        let of_spring = rod.spring() * rod.modulus();
        if of_spring > 0.0 {
            segment = segment.with_branch(of_spring, Elastic)?;
        }
        segment.with_branch(rod.modulus() - of_spring, rod.law().clone())
    }

    /// Creates a piece whose material is a Prony series. The spring of the equilibrium modulus, if
    /// there is one, is branch 0.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless length, area and density are finite and above 0.
    pub fn prony(
        length: f64,
        area: f64,
        density: f64,
        law: &GeneralisedMaxwell,
    ) -> Result<Self, RodwaveError> {
        let mut segment = Self::new(length, area, density)?;
        if law.equilibrium_modulus() > 0.0 {
            segment = segment.with_branch(law.equilibrium_modulus(), Elastic)?;
        }
        for branch in law.branches() {
            let viscosity = branch.modulus * branch.relaxation_time;
            segment = segment.with_branch(branch.modulus, Maxwell::new(viscosity)?)?;
        }
        Ok(segment)
    }

    /// Adds a branch in parallel: a spring of `modulus` \[Pa\] in series with `law`.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the modulus is finite and above 0;
    /// [`RodwaveError::LengthMismatch`] for a law with more than
    /// [`MAX_PARAMETERS`](crate::inelastic::MAX_PARAMETERS) parameters.
    pub fn with_branch<L>(mut self, modulus: f64, law: L) -> Result<Self, RodwaveError>
    where
        L: InelasticLaw + 'static,
        L::Flow: std::fmt::Debug + Clone + 'static,
    {
        check_parameters::<L>()?;
        self.branches.push(Branch {
            modulus: check_positive("modulus of a branch [Pa]", modulus)?,
            law: Arc::new(law),
        });
        Ok(self)
    }

    /// Length \[m\].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Cross-sectional area \[m²\].
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Density [kg/m³].
    #[must_use]
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Mass \[kg\].
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.density * self.area * self.length
    }

    /// Unrelaxed modulus E = Σ Eᵢ \[Pa\]; 0 without a branch.
    #[must_use]
    pub fn modulus(&self) -> f64 {
        self.branches
            .iter()
            .fold(0.0, |sum, branch| sum + branch.modulus)
    }

    /// Speed of fronts (E/ρ)^½ [m/s].
    #[must_use]
    pub fn wave_speed(&self) -> f64 {
        (self.modulus() / self.density).sqrt()
    }

    /// Characteristic impedance A (Eρ)^½ of the front [N s/m].
    #[must_use]
    pub fn impedance(&self) -> f64 {
        self.area * (self.modulus() * self.density).sqrt()
    }

    /// Travel time of a front from end to end \[s\].
    #[must_use]
    pub fn transit_time(&self) -> f64 {
        self.length / self.wave_speed()
    }

    /// Checks that waves can travel in a segment: each of its quantities may overflow or vanish
    /// even if the factors do not.
    pub(super) fn check(&self) -> Result<(), RodwaveError> {
        check_positive("sum of the moduli of the branches [Pa]", self.modulus())?;
        check_positive("mass [kg]", self.mass())?;
        check_positive("wave speed [m/s]", self.wave_speed())?;
        check_positive("impedance [N s/m]", self.impedance())?;
        check_positive("transit time [s]", self.transit_time())?;
        Ok(())
    }

    pub(super) fn branches(&self) -> &[Branch] {
        &self.branches
    }
}
