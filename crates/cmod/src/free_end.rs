//! Modulus from overlapping waves at two sections of a rod with a free end (Lundberg and Blanc, as
//! used in Ödeen 1993, papers A and B).
//!
//! Beyond the free end there is no force except the inertia of a mass m that may be attached to it.
//! With the distance d from the end, and the displacement u positive towards the end,
//!
//! ```text
//! û(d) = û(0) [cosh γd + lγ sinh γd] ,    ε̂(d) = -γ û(0) [sinh γd + lγ cosh γd] ,    l = m/(ρA) ,
//! ```
//!
//! Velocity and acceleration are v̂ = iωû and â = -ω²û. The ratio of any two of these quantities at
//! any two distances depends on γ and not on the impact. For two strains without end mass it is
//!
//! ```text
//! Ψ = ε̂₁/ε̂₂ = sinh γd₁/sinh γd₂ ,    and for d₁ = 2d₂    cosh γd₂ = Ψ/2 :
//! ```
//!
//! This is the closed form of Lundberg and Blanc, which paper A uses for its free end (eqs. 3-4)
//! and paper B for its three gauges, with r in place of r/2 (eqs. 8-9). For other distances and end
//! masses the equation is solved by iteration. The two-point method uses the ratio of two
//! accelerations, with d₁ = L and d₂ = 0.
//!
//! The two sections may also be a strain gauge and an accelerometer on the free end.
//! Bacon's method ([`OneGauge`](crate::OneGauge)) requires separate pulses; this method allows
//! overlapping pulses.
//!
//! # Singular lines
//! With Ψ = g(γ), γ is not determined where g' = 0; for d₁ = 2d₂ this is at kd₂ = nπ. Near these
//! points the error is large, and the lines are marked.
//!
//! Theory: `docs/theory/neighbouring-methods.md`.

mod rod;

pub(crate) use rod::FreeEndShape;
pub use rod::RodWithFreeEnd;

use num_complex::Complex64;
use rodwave::numerics::Jet;

use crate::branch::FreeEndRoot;
use crate::error::{CmodError, check_not_negative};
use crate::estimate::{ErrorSource, Method};
use crate::multi_point::Quantity;
use crate::section_ratio::{Changed, RodOfRatio, SectionRatio, Settings};

/// Relative difference up to which d₁ = 2d₂ counts as fulfilled: it covers the rounding of
/// distances in metres.
const EQUAL: f64 = 1e-12;

/// Section with its measured quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndSection {
    /// Distance d from the free end \[m\].
    pub distance: f64,
    /// Measured quantity; a motion is positive along the rod towards the free end, a strain in
    /// tension.
    pub quantity: Quantity,
}

/// Method for the modulus from two sections of a rod with a free end.
///
/// ```
/// use cmod::multi_point::Quantity;
/// use cmod::{EndSection, FreeEnd, RodWithFreeEnd};
/// use rodwave::chain::{Chain, Termination};
/// use rodwave::element::Circle;
/// use rodwave::medium::Medium;
/// use rodwave::modulus::ConstantQ;
///
/// // strain gauges 0.5 m and 0.25 m from the free end of a rod of polypropylene, 0.8 m long
/// let polypropylene = Medium::new(903.0, ConstantQ::new(2.6e9, 0.07, 1e4)?)?;
/// let chain = Chain::from_impact_face()
///     .rod(&polypropylene, Circle::of_diameter(0.0106)?, 0.8)
///     .end(Termination::Free)?;
/// let frequency_hz: Vec<f64> = (1..=200).map(|j| 50.0 * f64::from(j)).collect();
/// let mut ratio = Vec::new();
/// for f in &frequency_hz {
///     let omega = 2.0 * std::f64::consts::PI * f;
///     let force = |distance: f64| Ok::<_, rodwave::RodwaveError>(chain.section(0, 0.8 - distance)?.state(omega)?.normal_force);
///     ratio.push(force(0.5)? / force(0.25)?);
/// }
/// let rod = RodWithFreeEnd { diameter: 0.0106, density: 903.0, end_mass: 0.0 };
/// let gauge = |distance| EndSection { distance, quantity: Quantity::Strain };
/// let estimate = FreeEnd::new(rod, gauge(0.5), gauge(0.25))?.estimate(&frequency_hz, &ratio, &[1e-8; 200])?;
/// for line in estimate.valid() {
///     let exact = polypropylene.modulus(2.0 * std::f64::consts::PI * line.frequency_hz);
///     assert!((line.modulus - exact).norm() < 1e-9 * exact.norm());
/// }
/// assert!(estimate.valid().count() > 150);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeEnd {
    rod: RodWithFreeEnd,
    sections: [EndSection; 2],
    settings: Settings,
}

setters! { FreeEnd: wave_speed, uncertainty, limits }

impl FreeEnd {
    /// Creates the method for the ratio of the quantity at `first` to the quantity at `second`.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for the rod, and for a distance that is not finite or below 0;
    /// [`CmodError::NoInformation`] if both sections are at the same distance and measure two
    /// motions or two strains, or if one of them measures the strain of a free end without mass,
    /// which is 0.
    pub fn new(
        rod: RodWithFreeEnd,
        first: EndSection,
        second: EndSection,
    ) -> Result<Self, CmodError> {
        rod.check()?;
        for section in [first, second] {
            check_not_negative("distance from the free end [m]", section.distance)?;
            if section.quantity == Quantity::Strain
                && section.distance == 0.0
                && rod.end_mass == 0.0
            {
                return Err(CmodError::NoInformation {
                    what: "the strain of a free end is 0",
                });
            }
        }
        let one_place = (first.distance - second.distance).abs() <= f64::EPSILON * first.distance;
        let strains = [first, second].map(|section| section.quantity == Quantity::Strain);
        if one_place && strains[0] == strains[1] {
            return Err(CmodError::NoInformation {
                what: "the ratio of motions, or of strains, of one section is the same for every material",
            });
        }
        Ok(Self {
            rod,
            sections: [first, second],
            settings: Settings::default(),
        })
    }

    estimate! {
        /// Returns the complex modulus from the `ratio` Ψ = q̂₁/q̂₂ of the first section to the
        /// second, at the increasing frequencies `frequency_hz` \[Hz\]. All three arrays have one
        /// entry per line.
        ///
        /// `variance` is E|δΨ|², of real and imaginary part together, for an error without
        /// preferred phase, as computed by [`RatioOfSpectra`](crate::RatioOfSpectra); 0 stands for
        /// data without noise. The result has, to first order,
        ///
        /// ```text
        /// E|δγ|² = E|δΨ|²/|g'(γ)|² ,    δE = -2E δγ/γ
        /// ```
        ///
        /// with g(γ) = Ψ; for strains with d₁ = 2d₂, g' = 2d₂ sinh γd₂.
        ///
        /// # Errors
        /// [`CmodError::NoLines`], [`CmodError::LengthMismatch`], [`CmodError::Frequency`],
        /// [`CmodError::FrequencyOrder`], [`CmodError::NegativeVariance`]. A bad line does not
        /// affect the others: it is [refused](crate::ModulusEstimate::refused).
        ratio
    }

    /// Returns û or ε̂ of a section divided by û(0), including the factors iω and -γ that are not
    /// common to both sections.
    fn jet(&self, section: EndSection, gamma: Complex64, omega: f64) -> Jet {
        let [first, second] = &self.sections;
        let shape = FreeEndShape {
            quantity: section.quantity,
            length_of_end_mass: self.rod.length_of_end_mass(),
        }
        .at(section.distance, gamma);
        let (in_space, in_time) = section.quantity.derivatives();
        if in_space == 0 {
            shape * Jet::constant(Complex64::new(0.0, omega).powi(in_time))
        } else if first.quantity == second.quantity {
            shape
        } else {
            shape * Jet::linear(-gamma, -1.0)
        }
    }
}

impl SectionRatio for FreeEnd {
    const METHOD: Method = Method("two sections and a free end");

    fn jets(&self, gamma: Complex64, omega: f64) -> [Jet; 2] {
        self.sections.map(|section| self.jet(section, gamma, omega))
    }

    fn distance(&self) -> f64 {
        let [first, second] = &self.sections;
        first.distance.max(second.distance)
    }

    fn rod(&self) -> RodOfRatio {
        RodOfRatio {
            diameter: self.rod.diameter,
            density: self.rod.density,
        }
    }

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn changed(&self) -> Vec<Changed<Self>> {
        let uncertainty = &self.settings.uncertainty;
        let mut changed = self.rod.changed(uncertainty, |rod| Self { rod, ..*self });
        for (index, section) in self.sections.iter().enumerate() {
            // a sensor on the end itself has no error of distance
            let uncertainty = if section.distance > 0.0 {
                uncertainty.distance
            } else {
                0.0
            };
            changed.extend(Changed::of(
                ErrorSource::Section(index),
                uncertainty,
                |by| {
                    let mut changed = *self;
                    if let Some(section) = changed.sections.get_mut(index) {
                        section.distance += by;
                    }
                    changed
                },
            ));
        }
        changed
    }

    fn closed_form(&self, ratio: Complex64, expected: Complex64) -> Option<Complex64> {
        let [first, second] = self.sections;
        if self.rod.end_mass != 0.0 || first.quantity != second.quantity {
            return None;
        }
        let (cosh, distance) = if first.quantity == Quantity::Strain {
            let double = (first.distance - 2.0 * second.distance).abs() <= EQUAL * first.distance;
            double.then_some((0.5 * ratio, second.distance))
        } else {
            (second.distance == 0.0).then_some((ratio, first.distance))
        }?;
        let root = FreeEndRoot::of(cosh).nearest_to(expected * distance);
        // γ and -γ are equivalent roots; the root of the forward wave is chosen
        let root = if root.im < 0.0 { -root } else { root };
        Some(root / distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROD: RodWithFreeEnd = RodWithFreeEnd {
        diameter: 0.0106,
        density: 903.0,
        end_mass: 0.0,
    };

    fn section(distance: f64, quantity: Quantity) -> EndSection {
        EndSection { distance, quantity }
    }

    #[test]
    fn sections_that_say_nothing_are_refused() {
        let text = |rod, first, second| FreeEnd::new(rod, first, second).unwrap_err().to_string();
        let strain = |d| section(d, Quantity::Strain);
        assert_eq!(
            text(ROD, strain(0.5), strain(0.0)),
            "the strain of a free end is 0, expected sections whose ratio depends on the material"
        );
        assert_eq!(
            text(ROD, strain(0.5), strain(0.5)),
            "the ratio of motions, or of strains, of one section is the same for every material, \
             expected sections whose ratio depends on the material"
        );
        assert_eq!(
            text(
                ROD,
                section(0.5, Quantity::Velocity),
                section(0.5, Quantity::Acceleration)
            ),
            "the ratio of motions, or of strains, of one section is the same for every material, \
             expected sections whose ratio depends on the material"
        );
        assert_eq!(
            text(ROD, strain(-0.1), strain(0.5)),
            "distance from the free end [m] is -0.1, expected a finite value, 0 or above"
        );
        let heavy = RodWithFreeEnd {
            end_mass: f64::NAN,
            ..ROD
        };
        assert_eq!(
            text(heavy, strain(0.1), strain(0.5)),
            "mass on the free end [kg] is NaN, expected a finite value, 0 or above"
        );
        assert!(FreeEnd::new(ROD, strain(0.5), section(0.5, Quantity::Velocity)).is_ok());
    }
}
