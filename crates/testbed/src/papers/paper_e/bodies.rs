//! Truncated cone, compound cylinder and long rod, each from its impact face.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Argument, Chain, ChainBuilder, Termination, WaveMedium};
use rodwave::element::{Circle, CrossSection};
use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, Elastic, PowerLawPropagation};

use super::{Case, PaperE};
use crate::claim::Fallible;

/// Frequency at which the causal law has the modulus of eq. 7, in Hz. At this frequency, the
/// printed exponents satisfy the Kramers-Kronig relations.
const LEVEL_HZ: f64 = 3e3;

/// End of a body that meets the rod.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Face {
    ConeA,
    ConeB,
    CylinderA,
    CylinderB,
}

impl Face {
    pub const ALL: [Self; 4] = [Self::ConeA, Self::ConeB, Self::CylinderA, Self::CylinderB];

    /// Returns the abbreviation of the paper.
    pub fn name(self) -> &'static str {
        match self {
            Self::ConeA => "TCA",
            Self::ConeB => "TCB",
            Self::CylinderA => "CCA",
            Self::CylinderB => "CCB",
        }
    }

    pub fn is_of_cone(self) -> bool {
        matches!(self, Self::ConeA | Self::ConeB)
    }

    /// Returns true for the aluminium face, whose impedance does not depend on frequency.
    pub fn is_elastic(self) -> bool {
        self == Self::CylinderB
    }

    fn is_a(self) -> bool {
        matches!(self, Self::ConeA | Self::CylinderA)
    }
}

impl PaperE {
    pub fn case(&self, face: Face) -> Fallible<&Case> {
        let mut cases = self.cases.iter();
        Ok(cases
            .find(|case| case.name == face.name())
            .ok_or_else(|| format!("the transcribed cases of paper E have no {}", face.name()))?)
    }

    pub fn circle(diameter: f64) -> Fallible<Circle> {
        Ok(Circle::of_diameter(diameter)?)
    }

    /// Returns the nylon by eq. 7 as printed, which is defined only on the frequency axis.
    pub fn printed_nylon(&self) -> Fallible<Medium<PowerLawPropagation>> {
        let [damping, damping_exponent, wave_number, wave_number_exponent] = self.nylon;
        Ok(Medium::new(
            self.nylon_density,
            PowerLawPropagation::new(damping, damping_exponent, wave_number, wave_number_exponent)?,
        )?)
    }

    /// Returns the nylon by a causal law with constant loss factor, which has the modulus of eq. 7
    /// at 3 kHz.
    pub fn causal_nylon(&self) -> Fallible<Medium<ConstantQ>> {
        let omega = TAU * LEVEL_HZ;
        let modulus = self.printed_nylon()?.modulus(omega);
        let law = ConstantQ::new(modulus.norm(), modulus.im / modulus.re, omega)?;
        Ok(Medium::new(self.nylon_density, law)?)
    }

    pub fn aluminium(&self) -> Fallible<Medium<Elastic>> {
        Ok(Medium::new(
            self.aluminium_density,
            Elastic::new(self.aluminium_modulus)?,
        )?)
    }

    pub fn steel(&self) -> Fallible<Medium<Elastic>> {
        Ok(Medium::new(
            self.steel_density,
            Elastic::new(self.steel_modulus)?,
        )?)
    }

    /// Appends the elements of the body to `before`, from its face to the free end.
    pub fn body<V, M>(&self, face: Face, before: ChainBuilder<V>, nylon: &M) -> Fallible<Chain<V>>
    where
        V: Argument,
        M: WaveMedium<V> + Clone + 'static,
        Medium<Elastic>: WaveMedium<V>,
    {
        let [a, b] = self.cone_diameter;
        let body = if face.is_of_cone() {
            let [near, far] = if face.is_a() { [a, b] } else { [b, a] };
            before.cone(
                nylon,
                Self::circle(near)?,
                Self::circle(far)?,
                self.cone_length,
            )
        } else {
            let aluminium = self.aluminium()?;
            let section = Self::circle(self.cylinder_diameter)?;
            (0..4).fold(before, |body, number| {
                // the section at the end A is nylon, that at the end B aluminium
                if (number % 2 == 0) == face.is_a() {
                    body.rod(nylon, section, self.section_length)
                } else {
                    body.rod(&aluminium, section, self.section_length)
                }
            })
        };
        Ok(body.end(Termination::Free)?)
    }

    /// Returns the body with the nylon of eq. 7 as printed.
    pub fn printed(&self, face: Face) -> Fallible<Chain> {
        self.body(face, Chain::from_impact_face(), &self.printed_nylon()?)
    }

    /// Returns the body with the causal law of the nylon.
    pub fn causal(&self, face: Face) -> Fallible<AnalyticChain> {
        let before = AnalyticChain::analytic_from_impact_face();
        self.body(face, before, &self.causal_nylon()?)
    }

    /// Returns the long rod as a semi-infinite rod.
    pub fn long_rod(&self) -> Fallible<AnalyticChain> {
        let section = Self::circle(self.rod_diameter)?;
        Ok(AnalyticChain::analytic_from_impact_face()
            .end(Termination::semi_infinite(&self.steel()?, section))?)
    }

    /// Returns the long rod as a finite section before a semi-infinite rod. The finite section is
    /// long enough to contain the gauges.
    pub fn gauged_rod(&self) -> Fallible<AnalyticChain> {
        let section = Self::circle(self.rod_diameter)?;
        let steel = self.steel()?;
        Ok(AnalyticChain::analytic_from_impact_face()
            .rod(&steel, section, 2.0 * self.gauge_distance)
            .end(Termination::semi_infinite(&steel, section))?)
    }

    /// Returns the impedance Z of the rod, in kg/s.
    pub fn rod_impedance(&self) -> Fallible<f64> {
        let area = CrossSection::from(Self::circle(self.rod_diameter)?).area();
        Ok(area * (self.steel_modulus * self.steel_density).sqrt())
    }

    /// Returns |Z| of the face in kg/s; for a nylon face, at 10 kHz by eq. 7.
    pub fn front_impedance(&self, face: Face) -> Fallible<f64> {
        let diameter = match face {
            Face::ConeA => self.cone_diameter[0],
            Face::ConeB => self.cone_diameter[1],
            Face::CylinderA | Face::CylinderB => self.cylinder_diameter,
        };
        let omega = TAU * self.predicted_highest_hz;
        let specific = if face.is_elastic() {
            self.aluminium()?.specific_characteristic_impedance(omega)
        } else {
            self.printed_nylon()?
                .specific_characteristic_impedance(omega)
        };
        Ok(CrossSection::from(Self::circle(diameter)?).area() * specific.norm())
    }

    /// Returns the time in s, from the contact, at which the echo from the far end of the rod
    /// arrives at the gauges.
    pub fn echo_at_gauges(&self) -> f64 {
        (2.0 * self.rod_length - self.gauge_distance)
            / (self.steel_modulus / self.steel_density).sqrt()
    }

    /// Returns the mass of the body, in kg.
    pub fn mass(&self, face: Face) -> Fallible<f64> {
        Ok(self
            .printed(face)?
            .free_mass()
            .ok_or("the body is not free")?)
    }

    /// Returns the mobility of the face by eqs. 8 and 9 as printed, in s/kg.
    pub fn closed_form(&self, face: Face, omega: f64) -> Fallible<Complex64> {
        let nylon = self.printed_nylon()?;
        let impedance = |diameter: f64, specific: Complex64| -> Fallible<Complex64> {
            Ok(specific * CrossSection::from(Self::circle(diameter)?).area())
        };
        let gamma = nylon.propagation_coefficient(omega);
        let of_nylon = nylon.specific_characteristic_impedance(omega);
        if face.is_of_cone() {
            let [near, far] = self.cone_diameter;
            // distances from the apex
            let near_end = self.cone_length * near / (far - near);
            let ends = [near_end, near_end + self.cone_length];
            let (own, other, diameter, sign) = if face.is_a() {
                (ends[0], ends[1], near, 1.0)
            } else {
                (ends[1], ends[0], far, -1.0)
            };
            let (a, b) = (gamma * own, gamma * other);
            let coth = 1.0 / (b - a).tanh();
            let fraction = (1.0 - b * coth) / (1.0 - a * b - (b - a) * coth);
            return Ok(sign * a / impedance(diameter, of_nylon)? * fraction);
        }
        let aluminium = self.aluminium()?;
        let of_aluminium = aluminium.specific_characteristic_impedance(omega);
        let coth = |gamma: Complex64| 1.0 / (gamma * self.section_length).tanh();
        let (of_a, of_b) = (coth(gamma), coth(aluminium.propagation_coefficient(omega)));
        let (a, b, own, phi) = if face.is_a() {
            (of_a, of_b, of_nylon, of_aluminium / of_nylon)
        } else {
            (of_b, of_a, of_aluminium, of_nylon / of_aluminium)
        };
        let (a2, b2) = (a * a, b * b);
        let (phi2, phi3) = (phi * phi, phi * phi * phi);
        let numerator = phi3 + 3.0 * a * b * phi2 + (a2 * b2 + a2 + b2) * phi + a * b;
        let denominator = a * phi3 + b * (2.0 * a2 + 1.0) * phi2 + a * (2.0 * b2 + 1.0) * phi + b;
        Ok(numerator / denominator / impedance(self.cylinder_diameter, own)?)
    }
}
