//! A uniform rod of an inelastic material.

use crate::RodwaveError;
use crate::error::{check_positive, check_that};
use crate::inelastic::InelasticLaw;

/// Straight uniform rod that obeys the equations of paper D (Ödeen 1993, paper D, eqs. 1, 2, 7).
///
/// ```
/// use rodwave::{InelasticRod, inelastic::Maxwell};
///
/// let rod = InelasticRod::new(0.391, 1140.0, 3.209e9, Maxwell::new(4e6)?)?;
/// assert!((rod.wave_speed() - 1678.0).abs() < 1.0);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct InelasticRod<L> {
    length: f64,
    density: f64,
    modulus: f64,
    law: L,
    spring: f64,
}

impl<L: InelasticLaw> InelasticRod<L> {
    /// Creates a rod of `length` \[m\], `density` [kg/m³], Young's modulus `modulus` \[Pa\] and
    /// inelastic `law`.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless all three are finite and above 0.
    pub fn new(length: f64, density: f64, modulus: f64, law: L) -> Result<Self, RodwaveError> {
        let rod = Self {
            length: check_positive("length [m]", length)?,
            density: check_positive("density [kg/m^3]", density)?,
            modulus: check_positive("Young's modulus [Pa]", modulus)?,
            law,
            spring: 0.0,
        };
        check_positive("wave speed [m/s]", rod.wave_speed())?;
        check_positive("specific impedance [Pa s/m]", rod.specific_impedance())?;
        check_positive("transit time [s]", rod.transit_time())?;
        Ok(rod)
    }

    /// Puts the law into a branch in parallel with a spring. The spring has the share w of the
    /// modulus; the material is then a standard solid:
    ///
    /// ```text
    /// σ = wEε + σ_b ,    ∂σ_b/∂t = (1 - w) E (∂ε/∂t - F(σ_b))
    /// ```
    ///
    /// [`lumped`](crate::lumped), [`impact`](crate::impact), [`line`](crate::line) and
    /// [`BranchedProblem`](crate::characteristics::BranchedProblem) include the spring.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the share is between 0 and 1.
    pub fn with_spring(self, share: f64) -> Result<Self, RodwaveError> {
        check_that(
            share > 0.0 && share < 1.0,
            "share of a spring in the modulus",
            share,
            "between 0 and 1",
        )?;
        Ok(Self {
            spring: share,
            ..self
        })
    }

    /// Share of the modulus that belongs to a spring in parallel with the law; 0 without a spring.
    #[must_use]
    pub fn spring(&self) -> f64 {
        self.spring
    }

    /// Length \[m\].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Density [kg/m³].
    #[must_use]
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Young's modulus E \[Pa\] of the elastic part of the strain rate.
    #[must_use]
    pub fn modulus(&self) -> f64 {
        self.modulus
    }

    /// The inelastic law.
    #[must_use]
    pub fn law(&self) -> &L {
        &self.law
    }

    /// Speed of the fronts c = (E/ρ)^½ [m/s].
    #[must_use]
    pub fn wave_speed(&self) -> f64 {
        (self.modulus / self.density).sqrt()
    }

    /// Characteristic impedance per unit area ρc [Pa s/m].
    #[must_use]
    pub fn specific_impedance(&self) -> f64 {
        self.density * self.wave_speed()
    }

    /// Transit time of a front L/c \[s\].
    #[must_use]
    pub fn transit_time(&self) -> f64 {
        self.length / self.wave_speed()
    }
}
