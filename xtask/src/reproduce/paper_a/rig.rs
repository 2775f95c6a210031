//! Struck rod with its two accelerometers, as the analyser records it.

use cmod::two_point::AveragedRatio;
use cmod::validity::AcceptanceLimits;
use cmod::{ModulusEstimate, Solver, Specimen, TwoPoint};
use labio::{FrequencyResponse, Quantity, Record, Window};
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::Specimen as Rig;
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;

use super::super::Error;
use testbed::papers::paper_a::{PaperA, Test};
pub(crate) use testbed::recorder::{BLOW, NOISE, RATE_HZ};
use testbed::recorder::{Recorder, end_accelerations, name};

/// Resolution of the converter in bits; not stated in the paper.
pub(crate) const BITS: u32 = 14;
pub(crate) const SEED: u64 = 1993;

/// Specimen of a material in the rig, with the signals of its accelerometers before noise and
/// rounding.
#[derive(Debug)]
pub(crate) struct VirtualTest {
    pub(crate) specimen: Specimen,
    pub(crate) medium: Medium<ConstantQ>,
    recorder: Recorder,
    averaged: f64,
    highest_hz: f64,
}

/// Acceleration ratio from several hits, at the lines of the band.
#[derive(Debug, Clone)]
pub(crate) struct Ratio(FrequencyResponse);

impl VirtualTest {
    pub(crate) fn new(paper: &PaperA, test: &Test, law: ConstantQ) -> Result<Self, Error> {
        let specimen = test.specimen(paper);
        let medium = Medium::new(specimen.density, law)?;
        let rig = Rig {
            section: Circle::of_diameter(specimen.diameter)?.into(),
            length: specimen.length,
            accelerometer_mass: specimen.accelerometer_mass,
        };
        // the vibration decays to e^-14 within the record: in 30 ms for a length of 400 mm, in 60
        // ms for 800 mm
        let n_samples = if specimen.length < 0.5 { 2048 } else { 4096 };
        let ends = end_accelerations(&medium, &rig, n_samples)?;
        Ok(Self {
            specimen,
            medium,
            recorder: Recorder::new(&ends, Quantity::Acceleration, BITS, Window::Rectangular)?,
            averaged: paper.averaged,
            highest_hz: paper.highest_hz,
        })
    }

    /// Returns Ψ, estimated by H₁ from as many hits as in the paper (section 3). `strength` is the
    /// strength of the hits relative to that at the usual swing angle. The noise of the sensors is
    /// the same for every strength; the range of the converter is set for this strength.
    pub(crate) fn ratio(&self, strength: f64, seed: u64) -> Result<Ratio, Error> {
        let count = self.averaged as usize;
        let blows = self.recorder.blows(strength, count, seed, |_| strength)?;
        self.ratio_of(&blows)
    }

    /// Returns Ψ without noise and without rounding.
    pub(crate) fn ratio_without_noise(&self, strength: f64) -> Result<Ratio, Error> {
        self.ratio_of(&[self.recorder.exact(strength)?])
    }

    fn ratio_of(&self, records: &[Record]) -> Result<Ratio, Error> {
        let spectra = self.recorder.averaged(records)?;
        Ok(Ratio(spectra.h1(&name(1), &name(0))?))
    }

    pub(crate) fn estimate(&self, ratio: &Ratio, solver: Solver) -> Result<ModulusEstimate, Error> {
        let response = &ratio.0;
        let lines = response
            .frequency_hz
            .partition_point(|f| *f <= self.highest_hz);
        let coherence = response
            .coherence
            .as_ref()
            .ok_or("the coherence of ten hits is missing")?;
        Ok(TwoPoint::new(self.specimen)?
            .with_limits(AcceptanceLimits::ONE_DIMENSIONAL)?
            .with_solver(solver)
            .estimate_averaged(&AveragedRatio {
                frequency_hz: &response.frequency_hz[..lines],
                acceleration_ratio: &response.values[..lines],
                coherence: &coherence[..lines],
                averages: response.effective_averages,
            })?)
    }
}

impl Ratio {
    /// Returns the greatest relative difference from another ratio, up to `highest_hz`.
    pub(crate) fn difference(&self, other: &Self, highest_hz: f64) -> f64 {
        let lines = self.0.frequency_hz.partition_point(|f| *f <= highest_hz);
        self.0.values[..lines]
            .iter()
            .zip(&other.0.values[..lines])
            .map(|(a, b)| (a - b).norm() / a.norm())
            .fold(0.0, f64::max)
    }
}
