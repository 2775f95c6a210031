//! Bar of paper B in its structures.

use std::f64::consts::TAU;

use cmod::{GaugeSpectra, GaugedRod};
use num_complex::Complex64;
use rodwave::chain::Termination;
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::HalfSine;
use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use crate::materials;
use testbed::noise::Noise;

pub(crate) const DENSITY: f64 = 919.0;
pub(crate) const DIAMETER: f64 = 0.016;

pub(crate) fn polypropylene() -> Medium<ConstantQ> {
    materials::polypropylene(DENSITY)
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Structure {
    /// Bar between two cantilever beams.
    I,
    /// Structure I with a lump of 0.1 kg at the right end; the paper gives no mass.
    II,
    /// Dismounted bar with free ends.
    Free,
}

pub(crate) const STRUCTURES: [Structure; 3] = [Structure::I, Structure::II, Structure::Free];

/// Returns the strains (n_gauges)(n_lines) of the bar, 800 mm long, struck by a half sine of 50 N
/// and 0.1 ms.
pub(crate) fn strains(
    structure: Structure,
    positions: &[f64],
    frequency_hz: &[f64],
) -> Vec<Vec<Complex64>> {
    let beam = EndSupport::PAPER_B_BEAM;
    let (left, right) = match structure {
        Structure::I => (beam.termination(), beam.termination()),
        Structure::II => (beam.termination(), beam.with_lump(0.1).termination()),
        Structure::Free => (Termination::Free, Termination::Free),
    };
    let section = Circle::of_diameter(DIAMETER).unwrap();
    let member = FrameMember::new(&polypropylene(), section, 0.8, positions, right)
        .unwrap()
        .with_left_structure(left)
        .unwrap();
    let blow = HalfSine::new(50.0, 1e-4).unwrap();
    let omegas: Vec<f64> = frequency_hz.iter().map(|f| TAU * f).collect();
    member
        .strain_spectra(&Excitation::Force(&blow), &omegas)
        .unwrap()
}

pub(crate) fn rod(positions: &[f64]) -> GaugedRod {
    GaugedRod {
        positions: positions.to_vec(),
        diameter: DIAMETER,
        density: DENSITY,
    }
}

/// Returns `count` frequencies from `first` in steps of `step` [Hz].
pub(crate) fn lines(first: f64, step: f64, count: u32) -> Vec<f64> {
    (0..count).map(|j| first + step * f64::from(j)).collect()
}

/// Returns the root mean square of all values.
pub(crate) fn size(spectra: &[Vec<Complex64>]) -> f64 {
    let power: f64 = spectra.iter().flatten().map(Complex64::norm_sqr).sum();
    let count = spectra.iter().map(Vec::len).sum::<usize>();
    (power / count as f64).sqrt()
}

/// Returns the noise of each gauge, the same on all lines.
pub(crate) fn flat(noise: &[f64], n_lines: usize) -> Vec<Vec<f64>> {
    noise.iter().map(|&noise| vec![noise; n_lines]).collect()
}

/// Returns `clean` spectra with circular Gaussian noise of the size `noise` (n_gauges)(n_lines).
pub(crate) fn noisy(
    clean: &[Vec<Complex64>],
    noise: &[Vec<f64>],
    seed: u64,
) -> Vec<Vec<Complex64>> {
    let mut random = Noise::seeded(seed);
    let spectra = clean.iter().zip(noise);
    spectra
        .map(|(clean, noise)| {
            let variance: Vec<f64> = noise.iter().map(|noise| noise * noise).collect();
            random.on(clean, &variance)
        })
        .collect()
}

/// Returns the spectra of `tests` with the noise of the gauges.
pub(crate) fn clean<'a>(
    frequency_hz: &'a [f64],
    tests: &'a [&'a [Vec<Complex64>]],
    noise: &'a [Vec<f64>],
) -> GaugeSpectra<'a> {
    GaugeSpectra {
        frequency_hz,
        tests,
        noise,
    }
}
