//! Bar in structures I and II and dismounted: strains and end accelerations, with the noise of the
//! instruments.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rodwave::chain::Termination;
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::{EndAccelerationTest, HalfSine, Specimen};
use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use super::super::Error;
use testbed::noise::Noise;
use testbed::papers::paper_b::PaperB;

/// Distance a between the gauges, which the paper does not state. The distance is half a wavelength
/// at a frequency above the range of the paper.
pub(crate) const GAUGE_DISTANCE: f64 = 0.200;

/// Mass of the lump of structure II; the paper does not state it.
const LUMP: f64 = 0.1;

/// Standard error of one strain in one test, relative to the largest strain in the band.
pub(crate) const STRAIN_NOISE: f64 = 0.002;

/// Standard error of one end acceleration in one test, relative to the largest acceleration in the
/// band: smaller than that of a strain, because the paper finds less scatter with accelerometers.
pub(crate) const ACCELERATION_NOISE: f64 = 0.0005;

/// Mass of the accelerometer of paper A.
pub(crate) const ACCELEROMETER: f64 = 2.9e-3;

pub(crate) const SEED: u64 = 1993;

/// Returns polypropylene of 2.6 GPa with a loss factor of 0.07 at all frequencies; the curve of the
/// paper is not published as numbers.
pub(crate) fn polypropylene(paper: &PaperB) -> Result<Medium<ConstantQ>, Error> {
    Ok(Medium::new(
        paper.density,
        ConstantQ::new(2.6e9, 0.07, 1e4)?,
    )?)
}

/// Mounting of the bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mounting {
    /// Two cantilever beams.
    StructureI,
    /// Two cantilever beams, with a lump at the right end.
    StructureII,
    /// Two thin cords.
    Dismounted,
}

impl Mounting {
    pub(crate) const ALL: [Self; 3] = [Self::StructureI, Self::StructureII, Self::Dismounted];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::StructureI => "structure I",
            Self::StructureII => "structure II",
            Self::Dismounted => "dismounted",
        }
    }

    fn ends(self) -> (Termination, Termination) {
        let beam = EndSupport::PAPER_B_BEAM;
        match self {
            Self::StructureI => (beam.termination(), beam.termination()),
            Self::StructureII => (beam.termination(), beam.with_lump(LUMP).termination()),
            Self::Dismounted => (Termination::Free, Termination::Free),
        }
    }
}

/// Returns the force of the pendulum hammer: 50 N for 0.1 ms.
fn blow() -> Result<HalfSine, Error> {
    Ok(HalfSine::new(50.0, 1e-4)?)
}

/// Returns the positions of three gauges, `distance` apart, about the middle of the bar \[m\].
pub(crate) fn positions(paper: &PaperB, distance: f64) -> [f64; 3] {
    let middle = 0.5 * paper.length;
    [middle - distance, middle, middle + distance]
}

/// Returns the strains (n_gauges)(n_lines) without noise.
pub(crate) fn strains(
    paper: &PaperB,
    mounting: Mounting,
    positions: &[f64],
    frequency_hz: &[f64],
) -> Result<Vec<Vec<Complex64>>, Error> {
    let (left, right) = mounting.ends();
    let medium = polypropylene(paper)?;
    let section = Circle::of_diameter(paper.diameter)?;
    let bar = FrameMember::new(&medium, section, paper.length, positions, right)?
        .with_left_structure(left)?;
    let omegas: Vec<f64> = frequency_hz.iter().map(|f| TAU * f).collect();
    Ok(bar.strain_spectra(&Excitation::Force(&blow()?), &omegas)?)
}

/// Returns the ratios of the end accelerations of the dismounted bar from `tests` hits, and their
/// variance.
pub(crate) fn acceleration_ratios(
    paper: &PaperB,
    frequency_hz: &[f64],
    tests: usize,
) -> Result<(Vec<Complex64>, Vec<f64>), Error> {
    let test = EndAccelerationTest::new(
        &polypropylene(paper)?,
        &Specimen {
            section: Circle::of_diameter(paper.diameter)?.into(),
            length: paper.length,
            accelerometer_mass: ACCELEROMETER,
        },
    )?;
    let exact: Vec<Complex64> = frequency_hz
        .iter()
        .map(|f| test.acceleration_ratio(TAU * f))
        .collect::<Result<_, _>>()?;
    let of_mean = ACCELERATION_NOISE / (tests as f64).sqrt();
    // noise of both channels over the acceleration of the free end: δΨ = (δa₁ - Ψ δa₂)/a₂
    let variance: Vec<f64> = exact
        .iter()
        .map(|psi| of_mean * of_mean * (1.0 + psi.norm_sqr()))
        .collect();
    let ratios = Noise::seeded(SEED + 1000).on(&exact, &variance);
    Ok((ratios, variance))
}

/// Returns the spectra of `tests` hits on the bar, with noise of `size` on every strain, as
/// (n_tests)(n_gauges)(n_lines).
pub(crate) fn measured(
    strains: &[Vec<Complex64>],
    size: f64,
    tests: usize,
    seed: u64,
) -> Vec<Vec<Vec<Complex64>>> {
    let mut random = Noise::seeded(seed);
    let variance = vec![size * size; strains.first().map_or(0, Vec::len)];
    let mut one = || {
        strains
            .iter()
            .map(|spectrum| random.on(spectrum, &variance))
            .collect()
    };
    (0..tests).map(|_| one()).collect()
}
