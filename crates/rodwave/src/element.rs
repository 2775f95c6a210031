//! Parts of a body between two sections: rods, cones and horns, and the lumped mass, spring and
//! dashpot.
//!
//! Along a rod of density ρ, complex modulus E and cross-section A(x) the state (N, v) obeys (Ödeen
//! 1993, paper E, eqs. A1-A2)
//!
//! ```text
//! dN/dx = sρA v ,    dv/dx = s/(AE) N ,    s = iω
//! ```
//!
//! With x = γL, the ratio r of the radii at the far and the near end, the geometric mean Ā of the
//! two end areas and M = ρĀL, the transition matrix of a [`Segment`] from its near to its far end
//! is
//!
//! | | A(x) | P₁₁ | P₁₂ | P₂₁ | P₂₂ |
//! |---|---|---|---|---|---|
//! | rod (A10) | constant | cosh x | sM S | x²S/(sM) | cosh x |
//! | cone (A3-A4) | quadratic | S + r x²W | sM (S + (r - 1)²/r W) | x²S/(sM) | S + x²W/r |
//! | horn | e^{2μx/L}, μ = ln r | r (cosh X - μT) | sM T | x²T/(sM) | (cosh X + μT)/r |
//!
//! where `S = sinh x/x`, `W = (cosh x - S)/x²`, `X² = x² + μ²`, `T = sinh X/X`. The cone is (A4)
//! with the constants C and D eliminated; in this form nothing cancels as x → 0, where S → 1 and W
//! → 1/3, provided that W is computed as a series there. For the same reason, the difference in the
//! row of the horn is computed as `cosh X - μT = e^{-X} + x²T/(X + μ)`. A joint between two
//! cross-sections or two materials needs no element: N and v are continuous.
//!
//! Every matrix is divided by e^{|Re x|} (horn: e^{|Re X|}), so that it cannot overflow.
//!
//! # Limitations
//! Plane sections remain plane and the stress is uniaxial: lateral inertia and the spreading of
//! waves behind a sudden change of cross-section are neglected. The wavelength must therefore be
//! long compared with the diameter. If a cone is short compared with its diameter, or a joint wide
//! compared with the thinner part, the missing local compliance can be modelled as a spring.
//!
//! Theory: `docs/theory/chains.md#elements`.

mod lumped;
mod scaled;

use num_complex::Complex64;

pub(crate) use lumped::Lumped;
pub(crate) use scaled::ScaledTransition;

use crate::RodwaveError;
use crate::error::{check_finite, check_positive, check_propagation, check_that};

/// Cross-section of any shape, given by its area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossSection {
    area: f64,
}

impl CrossSection {
    /// Creates a cross-section of `area` A \[m²\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the area is finite and above 0.
    pub fn of_area(area: f64) -> Result<Self, RodwaveError> {
        Ok(Self {
            area: check_positive("area of the cross-section [m^2]", area)?,
        })
    }

    /// Area A \[m²\].
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }
}

/// A circular cross-section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    diameter: f64,
    section: CrossSection,
}

impl Circle {
    /// Creates a circle of `diameter` D \[m\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless diameter and area are finite and above 0.
    pub fn of_diameter(diameter: f64) -> Result<Self, RodwaveError> {
        let diameter = check_positive("diameter [m]", diameter)?;
        Ok(Self {
            diameter,
            section: CrossSection::of_area(std::f64::consts::PI / 4.0 * diameter * diameter)?,
        })
    }

    /// Diameter D \[m\].
    #[must_use]
    pub fn diameter(&self) -> f64 {
        self.diameter
    }
}

impl From<Circle> for CrossSection {
    fn from(circle: Circle) -> Self {
        circle.section
    }
}

/// A cross-section, or the `Result` of creating one. The elements of a [chain](crate::chain) accept
/// either; the chain reports an error together with the position of the element.
///
/// ```
/// use rodwave::element::Circle;
/// use rodwave::medium::Medium;
/// use rodwave::modulus::Elastic;
/// use rodwave::{Chain, Termination};
///
/// let steel = Medium::new(7780.0, Elastic::new(206e9)?)?;
/// let diameters = [0.010, 0.0, 0.012];
/// let mut builder = Chain::from_impact_face();
/// for diameter in diameters {
///     builder = builder.rod(&steel, Circle::of_diameter(diameter), 0.3);
/// }
/// assert_eq!(
///     builder.end(Termination::Free).unwrap_err().to_string(),
///     "element 1: diameter [m] is 0, expected a finite value above 0"
/// );
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
pub trait IntoCrossSection {
    /// Returns the cross-section.
    ///
    /// # Errors
    /// The error of the construction of the cross-section.
    fn into_cross_section(self) -> Result<CrossSection, RodwaveError>;
}

impl<S: Into<CrossSection>> IntoCrossSection for S {
    fn into_cross_section(self) -> Result<CrossSection, RodwaveError> {
        Ok(self.into())
    }
}

impl<S: Into<CrossSection>> IntoCrossSection for Result<S, RodwaveError> {
    fn into_cross_section(self) -> Result<CrossSection, RodwaveError> {
        self.map(Into::into)
    }
}

/// Variation of the cross-section along a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Profile {
    Uniform,
    Conical,
    Exponential,
}

/// A rod, cone or horn: the geometry of a continuous part of a body, without its material.
///
/// ```
/// use rodwave::element::{Circle, Segment};
///
/// // the truncated cone of paper E
/// let (a, b) = (Circle::of_diameter(0.030)?, Circle::of_diameter(0.075)?);
/// let cone = Segment::cone(a, b, 0.400)?;
/// assert!((cone.volume() * 1150.0 - 1.056).abs() < 1e-3); // kg of Nylon-6
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    profile: Profile,
    length: f64,
    near_area: f64,
    /// Ā = (A_near A_far)^½
    mean_area: f64,
    /// r = (A_far/A_near)^½
    radius_ratio: f64,
    /// μ = ln r
    log_ratio: f64,
}

impl Segment {
    /// Creates a part of constant `section` over `length` L \[m\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the length is finite and above 0.
    pub fn rod(section: impl Into<CrossSection>, length: f64) -> Result<Self, RodwaveError> {
        let section = section.into();
        Self::new(Profile::Uniform, section, section, length)
    }

    /// Creates a truncated cone, or any part whose cross-section keeps its shape and grows as the
    /// square of the distance from an apex, from `near` to `far` over `length` L \[m\] (paper
    /// E, eq. A3).
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the length and the ratio of the areas are finite and
    /// above 0.
    pub fn cone(
        near: impl Into<CrossSection>,
        far: impl Into<CrossSection>,
        length: f64,
    ) -> Result<Self, RodwaveError> {
        Self::new(Profile::Conical, near.into(), far.into(), length)
    }

    /// Creates an exponential horn, A(x) = A_near (A_far/A_near)^{x/L}, from `near` to `far` over
    /// `length` L \[m\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the length and the ratio of the areas are finite and
    /// above 0.
    pub fn horn(
        near: impl Into<CrossSection>,
        far: impl Into<CrossSection>,
        length: f64,
    ) -> Result<Self, RodwaveError> {
        Self::new(Profile::Exponential, near.into(), far.into(), length)
    }

    fn new(
        profile: Profile,
        near: CrossSection,
        far: CrossSection,
        length: f64,
    ) -> Result<Self, RodwaveError> {
        let length = check_positive("length [m]", length)?;
        let area_ratio = check_positive("ratio of the end areas", far.area / near.area)?;
        let segment = Self::between(profile, near.area, area_ratio.sqrt(), length);
        check_positive("volume [m^3]", segment.volume())?;
        Ok(segment)
    }

    fn between(profile: Profile, near_area: f64, radius_ratio: f64, length: f64) -> Self {
        Self {
            profile,
            length,
            near_area,
            mean_area: near_area * radius_ratio,
            radius_ratio,
            log_ratio: radius_ratio.ln(),
        }
    }

    /// Length L \[m\].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Radius at `fraction` of the length over the radius at the near end.
    fn relative_radius(&self, fraction: f64) -> f64 {
        match self.profile {
            Profile::Uniform => 1.0,
            Profile::Conical => 1.0 + (self.radius_ratio - 1.0) * fraction,
            Profile::Exponential => (self.log_ratio * fraction).exp(),
        }
    }

    /// Cross-section \[m²\] at `distance` \[m\] from the near end.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the distance is between 0 and the length.
    pub fn area_at(&self, distance: f64) -> Result<f64, RodwaveError> {
        let fraction = self.check_distance(distance)? / self.length;
        Ok(self.near_area * self.relative_radius(fraction).powi(2))
    }

    /// Volume \[m³\].
    #[must_use]
    pub fn volume(&self) -> f64 {
        let shape = match self.profile {
            Profile::Uniform => 1.0,
            Profile::Conical => (self.radius_ratio + 1.0 + self.radius_ratio.recip()) / 3.0,
            Profile::Exponential if self.log_ratio == 0.0 => 1.0,
            Profile::Exponential => self.log_ratio.sinh() / self.log_ratio,
        };
        self.mean_area * self.length * shape
    }

    /// Cuts the segment at `distance` \[m\] from the near end.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the distance is above 0 and below the length.
    pub fn cut(&self, distance: f64) -> Result<Cut, RodwaveError> {
        let distance = check_positive("distance of the section [m]", distance)?;
        let rest = check_positive("length beyond the section [m]", self.length - distance)?;
        let here = self.relative_radius(distance / self.length);
        Ok(Cut {
            near: Self::between(self.profile, self.near_area, here, distance),
            far: Self::between(
                self.profile,
                self.near_area * here * here,
                self.radius_ratio / here,
                rest,
            ),
        })
    }

    /// Returns the same part with its ends exchanged.
    #[must_use]
    pub fn turned(&self) -> Self {
        Self::between(
            self.profile,
            self.mean_area * self.radius_ratio,
            self.radius_ratio.recip(),
            self.length,
        )
    }

    /// Returns the matrix divided by a power of e, for the propagation coefficient γ of the
    /// material; the identity at s = 0.
    pub(crate) fn scaled_transition(
        &self,
        gamma: Complex64,
        s: Complex64,
        density: f64,
    ) -> Result<ScaledTransition, RodwaveError> {
        if s == Complex64::ZERO {
            return Ok(ScaledTransition::IDENTITY);
        }
        let x = check_propagation(gamma, s)? * self.length;
        check_finite("damping over the segment alpha L", x.re)?;
        check_finite("phase over the segment kL [rad]", x.im)?;
        let inertia = s * (density * self.mean_area * self.length);
        Ok(match self.profile {
            Profile::Uniform => ScaledTransition::rod(x, inertia),
            Profile::Conical => ScaledTransition::cone(x, inertia, self.radius_ratio),
            Profile::Exponential => {
                ScaledTransition::horn(x, inertia, self.radius_ratio, self.log_ratio)
            }
        })
    }

    /// Checks that a distance from the near end is on the segment.
    pub(crate) fn check_distance(&self, distance: f64) -> Result<f64, RodwaveError> {
        let holds = (0.0..=self.length).contains(&distance);
        let expected = "between 0 and the length of the element";
        check_that(holds, "distance of the section [m]", distance, expected)
    }
}

/// The two parts of a [`Segment`] on either side of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// The part before the section.
    pub near: Segment,
    /// The part after the section.
    pub far: Segment,
}

/// Checks that a static impedance is that of a solid. A fluid flows: its matrix at ω = 0 is not the
/// identity.
pub(crate) fn check_static_impedance(specific_impedance: Complex64) -> Result<(), RodwaveError> {
    check_positive(
        "characteristic impedance per area at 0 Hz [Pa s/m]",
        specific_impedance.norm(),
    )
    .map(|_| ())
}
