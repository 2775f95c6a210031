//! Common settings of the methods that evaluate a ratio: guess of the wave speed, uncertainties,
//! limits.

use crate::error::{CmodError, check_not_negative};
use crate::estimate::{ErrorSource, SystematicShift};
use crate::validity::AcceptanceLimits;
use num_complex::Complex64;

use super::{SectionRatio, slope};

/// Standard uncertainties of a rod and its sections, each in the unit of its quantity. The value is
/// 0, the default, for exact quantities. The errors are independent of each other and the same on
/// all lines.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SectionUncertainty {
    /// Uncertainty of each distance of a section \[m\]: from the free end, or from the other
    /// section. It does not apply to a sensor on the end itself.
    pub distance: f64,
    /// Uncertainty of the diameter \[m\]. It acts only through the mass on the end.
    pub diameter: f64,
    /// Uncertainty of the density [kg/m³].
    pub density: f64,
    /// Uncertainty of the mass on the end \[kg\].
    pub end_mass: f64,
}

impl SectionUncertainty {
    pub(crate) fn check(self) -> Result<Self, CmodError> {
        check_not_negative("uncertainty of a distance [m]", self.distance)?;
        check_not_negative("uncertainty of the diameter [m]", self.diameter)?;
        check_not_negative("uncertainty of the density [kg/m^3]", self.density)?;
        check_not_negative("uncertainty of the mass on the end [kg]", self.end_mass)?;
        Ok(self)
    }
}

/// Settings of a method that evaluates a ratio; each method uses only some of them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Settings {
    pub(crate) wave_speed: Option<f64>,
    /// Delay of the numerator relative to the denominator [s].
    pub(crate) delay: Option<f64>,
    pub(crate) uncertainty: SectionUncertainty,
    pub(crate) limits: AcceptanceLimits,
}

/// Two copies of an arrangement, with one quantity increased and decreased by its standard
/// uncertainty.
pub(crate) struct Changed<T> {
    pub(crate) source: ErrorSource,
    pub(crate) larger: T,
    pub(crate) smaller: T,
}

impl<T> Changed<T> {
    /// Creates the two arrangements that `by` returns for a change of the quantity by plus and
    /// minus its `uncertainty`; `None` if the quantity is exact.
    pub(crate) fn of(source: ErrorSource, uncertainty: f64, by: impl Fn(f64) -> T) -> Option<Self> {
        (uncertainty > 0.0).then(|| Self {
            source,
            larger: by(uncertainty),
            smaller: by(-uncertainty),
        })
    }
}

/// Returns the changes of γ and E due to each uncertain quantity p at constant Ψ: δγ = -(∂g/∂p)
/// δp/g'.
pub(super) fn shifts<T: SectionRatio>(
    equation: &T,
    (gamma, modulus): (Complex64, Complex64),
    omega: f64,
    relative_density: f64,
) -> Vec<SystematicShift> {
    let slope_of = |equation: &T| slope(equation, gamma, omega);
    let first = slope_of(equation).first;
    let changed = equation.changed();
    let through_ratio = changed.iter().map(|changed| {
        let difference = slope_of(&changed.larger).value - slope_of(&changed.smaller).value;
        (changed.source, -0.5 * difference / first)
    });
    // The density affects E = -ρω²/γ², whether or not it affects γ.
    let mut moves: Vec<(ErrorSource, Complex64)> = through_ratio.collect();
    let is_density = |(source, _): &(ErrorSource, Complex64)| *source == ErrorSource::Density;
    if relative_density > 0.0 && !moves.iter().any(is_density) {
        moves.push((ErrorSource::Density, Complex64::ZERO));
    }
    moves
        .into_iter()
        .map(|(source, of_gamma)| {
            let of_density = if source == ErrorSource::Density {
                relative_density
            } else {
                0.0
            };
            SystematicShift::new(
                source,
                modulus * (of_density - 2.0 * of_gamma / gamma),
                of_gamma,
            )
        })
        .collect()
}
