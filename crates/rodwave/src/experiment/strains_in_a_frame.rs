//! The test of paper B: strains at sections of a rod that is a member of a structure.
//!
//! The method of paper B needs no knowledge of the ends of the rod. At the left end, where the
//! structure is struck, another body may be attached in parallel to the rod; the right end has a
//! [`Termination`]:
//!
//! ```text
//!  left structure --+
//!                   |
//!      force F --> node ===== rod, sections at x₁, x₂, ... ===== termination
//! ```
//!
//! The velocity of the node is v̂ = F̂/(1/Ĝ_left + 1/Ĝ_rod); the fraction Ĝ_left/(Ĝ_left + Ĝ_rod)
//! of the force therefore acts on the rod. For three sections a distance a apart and for any ends
//! (Ödeen 1993, paper B, eqs. 6-7),
//!
//! ```text
//! cosh γa = Ψ = (ε̂₁ + ε̂₂)/(2ε̂₀)
//! ```
//!
//! In structure I of the paper, the bar ends at two cantilever beams; in structure II, a steel lump
//! is added at the right end. [`EndSupport`] models a beam by its lowest mode; the paper gives
//! neither the damping of the steel nor the mass of the lump.
//!
//! ```
//! use num_complex::Complex64;
//! use rodwave::element::Circle;
//! use rodwave::experiment::end_accelerations::HalfSine;
//! use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember};
//! use rodwave::medium::Medium;
//! use rodwave::modulus::ConstantQ;
//!
//! let polypropylene = Medium::new(919.0, ConstantQ::new(2.6e9, 0.07, 1e4)?)?;
//! let section = Circle::of_diameter(0.016)?;
//! let beam = EndSupport::PAPER_B_BEAM;
//! let member = FrameMember::new(&polypropylene, section, 0.800, &[0.3, 0.4, 0.5], beam.termination())?
//!     .with_left_structure(beam.termination())?;
//! let omega = 1e4;
//! let blow = HalfSine::new(50.0, 2e-4)?;
//! let strains = member.strain_spectra(&Excitation::Force(&blow), &[omega])?;
//! let psi = 0.5 * (strains[0][0] + strains[2][0]) / strains[1][0];
//! let expected = (polypropylene.propagation_coefficient(omega) * 0.1).cosh();
//! assert!((psi - expected).norm() < 1e-12);
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! # Limitations
//! Bending and the higher modes of the beams are neglected: a beam is represented by the impedance
//! of its tip to the axial motion of the rod. Any measured impedance can be used in its place. The
//! instruments are ideal.

use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;

use super::end_accelerations::Pulse;
use crate::RodwaveError;
use crate::chain::{
    AngularFrequency, Argument, Chain, ChainBuilder, LaplaceVariable, Section, Termination,
    WaveMedium,
};
use crate::element::CrossSection;
use crate::error::{check_enough_samples, check_finite, check_positive};
use crate::synthesis::{DampedSynthesis, SynthesizedHistory};
use crate::transition::State;

/// Generator name of [`FrameMember::record`].
pub const GENERATOR: &str = "strains in a frame: chain recursion, damped Fourier transform";

/// Excitation of the left end.
#[derive(Clone, Copy)]
pub enum Excitation<'a> {
    /// A force \[N\] on the node of rod and left structure, along +x.
    Force(&'a dyn Pulse),
    /// A velocity [m/s] of the left end along +x, with the force that it requires.
    Velocity(&'a dyn Pulse),
}

impl fmt::Debug for Excitation<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self {
            Self::Force(_) => "Force",
            Self::Velocity(_) => "Velocity",
        };
        formatter.debug_tuple(name).finish_non_exhaustive()
    }
}

/// A spring and a dashpot to the ground and a mass, in parallel: Z(s) = k/s + q + sm (Ödeen 1993,
/// paper B, Figure 3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndSupport {
    /// Stiffness k [N/m].
    pub stiffness: f64,
    /// Resistance q [kg/s].
    pub resistance: f64,
    /// Mass m \[kg\].
    pub mass: f64,
}

impl EndSupport {
    /// The steel cantilever beams of paper B, 280 mm x 30 mm x 1 mm, represented by their lowest
    /// mode: k = 3EI/l³ and m = (33/140) ρbhl (Rayleigh's quotient with the static deflection),
    /// with E and ρ of the steel of paper E. The resistance, 1 % of critical, is an assumption.
    pub const PAPER_B_BEAM: Self = Self {
        stiffness: 3.0 * 206e9 * (0.030 * 0.001 * 0.001 * 0.001 / 12.0) / (0.280 * 0.280 * 0.280),
        resistance: 0.0208,
        mass: 33.0 / 140.0 * 7780.0 * 0.030 * 0.001 * 0.280,
    };

    /// Returns the support with a lump of `mass` \[kg\] attached, as at the right end of structure
    /// II.
    #[must_use]
    pub fn with_lump(self, mass: f64) -> Self {
        Self {
            mass: self.mass + mass,
            ..self
        }
    }

    /// Impedance k/s + q + sm [kg/s] at `s` [1/s]; infinite at s = 0 if there is a spring.
    #[must_use]
    pub fn impedance(&self, s: Complex64) -> Complex64 {
        let spring = if self.stiffness == 0.0 {
            Complex64::ZERO
        } else {
            self.stiffness / s
        };
        spring + self.resistance + s * self.mass
    }

    /// Returns the support as the termination of an analytic chain; for other chains see
    /// [`EndSupport::termination`].
    #[must_use]
    pub fn analytic_termination(self) -> Termination<LaplaceVariable> {
        Termination::impedance_at_s(move |s| self.impedance(s))
    }

    /// Returns the support as the termination of a chain.
    #[must_use]
    pub fn termination(self) -> Termination {
        Termination::impedance(move |omega| self.impedance(Complex64::new(0.0, omega)))
    }
}

/// A rod between two structures, with sections where the strain is observed. With `V` =
/// [`LaplaceVariable`], all laws are analytic and histories are available; otherwise only spectra
/// are.
#[derive(Debug, Clone)]
pub struct FrameMember<V: Argument = AngularFrequency> {
    medium: Arc<dyn WaveMedium<V>>,
    section: CrossSection,
    positions: Vec<f64>,
    rod: Chain<V>,
    /// The body parallel to the rod at the left end, if there is one.
    left: Option<Chain<V>>,
}

/// Strain histories of the sections.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct StrainRecord {
    /// Generator of the record: [`GENERATOR`].
    pub generator: &'static str,
    /// Time of the first sample \[s\]; the excitation begins at time 0.
    pub start: f64,
    /// Interval between samples \[s\].
    pub interval: f64,
    /// Strains, positive in tension; `(n_sections)(n_samples)`.
    pub strains: Vec<Vec<f64>>,
}

impl FrameMember {
    /// Creates a rod of any `medium` with this `section` and `length` \[m\], observed at
    /// `positions` x \[m\] from its left end. It has no left structure; the termination `right` is
    /// at its right end.
    ///
    /// # Errors
    /// [`RodwaveError::InElement`] or [`RodwaveError::NonPhysical`] if the rod or its right end is
    /// invalid, or a position is outside the rod.
    pub fn new<M>(
        medium: &M,
        section: impl Into<CrossSection>,
        length: f64,
        positions: &[f64],
        right: Termination,
    ) -> Result<Self, RodwaveError>
    where
        M: WaveMedium<AngularFrequency> + Clone + 'static,
    {
        let section = section.into();
        let rod = Chain::from_impact_face()
            .rod(medium, section, length)
            .end(right)?;
        Self::build(Arc::new(medium.clone()), section, positions, rod)
    }

    /// Adds a structure parallel to the rod at the left end.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] if the structure is invalid.
    pub fn with_left_structure(self, left: Termination) -> Result<Self, RodwaveError> {
        self.beside(Chain::from_impact_face(), left)
    }
}

impl FrameMember<LaplaceVariable> {
    /// Creates a rod as [`FrameMember::new`] does, of a `medium` whose law is analytic.
    ///
    /// # Errors
    /// The errors of [`FrameMember::new`].
    pub fn analytic<M>(
        medium: &M,
        section: impl Into<CrossSection>,
        length: f64,
        positions: &[f64],
        right: Termination<LaplaceVariable>,
    ) -> Result<Self, RodwaveError>
    where
        M: WaveMedium<LaplaceVariable> + Clone + 'static,
    {
        let section = section.into();
        let rod = Chain::analytic_from_impact_face()
            .rod(medium, section, length)
            .end(right)?;
        Self::build(Arc::new(medium.clone()), section, positions, rod)
    }

    /// Adds a structure parallel to the rod at the left end.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] if the structure is invalid.
    pub fn with_analytic_left_structure(
        self,
        left: Termination<LaplaceVariable>,
    ) -> Result<Self, RodwaveError> {
        self.beside(Chain::analytic_from_impact_face(), left)
    }

    /// Computes the strain histories under this `excitation` to the accuracy of the `synthesis`,
    /// also for undamped structures.
    ///
    /// The transforms of the strains decay like the transform of the prescribed force or velocity.
    /// Content above the Nyquist frequency causes ringing.
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`] and [`DampedSynthesis::history`].
    pub fn record(
        &self,
        excitation: &Excitation<'_>,
        synthesis: &DampedSynthesis,
    ) -> Result<StrainRecord, RodwaveError> {
        let mut transforms =
            vec![Vec::with_capacity(synthesis.arguments().len()); self.n_sections()];
        let sections = self.sections()?;
        for s in synthesis.arguments() {
            let argument = LaplaceVariable::new(s)?;
            let rod = self.rod.mobility_at_s(s)?;
            let left = self.left.as_ref().map(|left| left.mobility_at_s(s));
            let force = force_on_rod(excitation, s, rod, left.transpose()?);
            for (section, transform) in sections.iter().zip(&mut transforms) {
                transform.push(force * self.strain(argument, section.state_at_s(s)?));
            }
        }
        let histories: Vec<SynthesizedHistory> = transforms
            .iter()
            .map(|transform| synthesis.history(transform))
            .collect::<Result<_, _>>()?;
        let (start, interval) = histories
            .first()
            .map_or((0.0, 0.0), |history| (history.start, history.interval));
        Ok(StrainRecord {
            generator: GENERATOR,
            start,
            interval,
            strains: histories
                .into_iter()
                .map(|history| history.samples)
                .collect(),
        })
    }
}

impl<V: Argument> FrameMember<V> {
    fn build(
        medium: Arc<dyn WaveMedium<V>>,
        section: CrossSection,
        positions: &[f64],
        rod: Chain<V>,
    ) -> Result<Self, RodwaveError> {
        check_enough_samples("the list of positions", positions.len(), 1)?;
        for &position in positions {
            rod.section(0, position)?;
        }
        Ok(Self {
            medium,
            section,
            positions: positions.to_vec(),
            rod,
            left: None,
        })
    }

    fn beside(self, builder: ChainBuilder<V>, left: Termination<V>) -> Result<Self, RodwaveError> {
        Ok(Self {
            left: match left {
                Termination::Free => None,
                other => Some(builder.end(other)?),
            },
            ..self
        })
    }

    /// Number of sections observed.
    #[must_use]
    pub fn n_sections(&self) -> usize {
        self.positions.len()
    }

    /// Returns the strain spectra \[s\] of the sections at `omegas` [rad/s] under this `excitation`
    /// (paper B, eq. 5); `(n_sections)(n_frequencies)`.
    ///
    /// # Errors
    /// The errors of [`Chain::mobility`]; [`RodwaveError::NonPhysical`] at ω = 0, where the strain
    /// of a law that creeps is infinite.
    pub fn strain_spectra(
        &self,
        excitation: &Excitation<'_>,
        omegas: &[f64],
    ) -> Result<Vec<Vec<Complex64>>, RodwaveError> {
        let mut spectra = vec![Vec::with_capacity(omegas.len()); self.n_sections()];
        let sections = self.sections()?;
        for &omega in omegas {
            check_finite("angular frequency [rad/s]", omega)?;
            check_positive("magnitude of the angular frequency [rad/s]", omega.abs())?;
            let rod = self.rod.mobility(omega)?;
            let left = self.left.as_ref().map(|left| left.mobility(omega));
            let s = Complex64::new(0.0, omega);
            let force = force_on_rod(excitation, s, rod, left.transpose()?);
            for (section, spectrum) in sections.iter().zip(&mut spectra) {
                let strain = self.strain(V::on_axis(omega)?, section.state(omega)?);
                let strain = force * strain;
                check_finite("magnitude of the strain", strain.norm())?;
                spectrum.push(strain);
            }
        }
        Ok(spectra)
    }

    fn sections(&self) -> Result<Vec<Section<'_, V>>, RodwaveError> {
        let positions = self.positions.iter();
        positions
            .map(|&position| self.rod.section(0, position))
            .collect()
    }

    /// Strain ε = N/(AE), with E = ρs²/γ².
    fn strain(&self, argument: V, state: State) -> Complex64 {
        let slowness = self.medium.propagation_coefficient(argument) / argument.s();
        state.normal_force * slowness * slowness / (self.medium.density() * self.section.area())
    }
}

/// Force on the rod, from the mobilities of the rod and of the left structure.
fn force_on_rod(
    excitation: &Excitation<'_>,
    s: Complex64,
    rod: Complex64,
    left: Option<Complex64>,
) -> Complex64 {
    match (excitation, left) {
        (Excitation::Force(force), None) => force.transform(s),
        (Excitation::Force(force), Some(left)) => force.transform(s) * left / (left + rod),
        (Excitation::Velocity(velocity), _) => velocity.transform(s) / rod,
    }
}
