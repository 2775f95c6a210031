//! Struck rod with its two accelerometers, as recorded by the analyser.

use cmod::two_point::AveragedRatio;
use cmod::validity::AcceptanceLimits;
use cmod::{ModulusEstimate, Solver, Specimen, TwoPoint};
use labio::instrument::{AntiAlias, Converter, Instrument, NoiseSpectrum};
use labio::{Channel, FrequencyResponse, Provenance, Quantity, Record, SpectrumAverager, Window};
use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::{EndAccelerationTest, RaisedCosine, Specimen as Rig};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use rodwave::synthesis::DampedSynthesis;

use super::super::Error;
use testbed::papers::paper_a::{PaperA, Test};

/// Sampling rate of the analyser, in Hz; not in the paper, like the following constants.
pub(crate) const RATE_HZ: f64 = 65_536.0;
/// Factor by which histories are finer.
const FINER: usize = 8;
/// Corner frequency of the anti-aliasing filter, in Hz.
const CORNER_HZ: f64 = 22e3;
/// Noise of a sample relative to the peak of its channel, at the swing angle of the tests.
pub(crate) const NOISE: f64 = 2e-4;
/// Resolution of the converter.
pub(crate) const BITS: u32 = 14;
/// Range of the converter relative to the peak.
const RANGE: f64 = 1.25;
/// Blow at the swing angle of the tests: greatest force in N, duration in s.
pub(crate) const BLOW: (f64, f64) = (100.0, 8e-5);
pub(crate) const SEED: u64 = 1993;

const STRUCK: &str = "struck end";
const FREE: &str = "free end";

/// Specimen of a material in the rig, with the signals of its accelerometers before noise and rounding.
#[derive(Debug)]
pub(crate) struct VirtualTest {
    pub(crate) specimen: Specimen,
    pub(crate) medium: Medium<ConstantQ>,
    filtered: Record,
    averaged: f64,
    highest_hz: f64,
}

/// Acceleration ratio of several blows on the lines of the band.
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
        // a length of 400 mm rings down by e^-14 in 30 ms, one of 800 mm in 60 ms
        let samples: usize = if specimen.length < 0.5 { 2048 } else { 4096 };
        let count = samples * FINER;
        #[expect(clippy::cast_precision_loss, reason = "some thousand samples")]
        let (interval, duration) = {
            let interval = 1.0 / (RATE_HZ * FINER as f64);
            (interval, count as f64 * interval)
        };
        let synthesis = DampedSynthesis::new(duration, interval)?.smoothed(2.5 * interval)?;
        let exact = EndAccelerationTest::analytic(&medium, &rig)?
            .record(&RaisedCosine::new(BLOW.0, BLOW.1)?, &synthesis)?;
        // the recorder starts a millisecond before the blow
        let lead = 64 * FINER;
        let samples = Array2::from_shape_fn((2, count), |(channel, sample)| {
            let history = if channel == 0 {
                &exact.impacted_end
            } else {
                &exact.free_end
            };
            sample.checked_sub(lead).map_or(0.0, |after| history[after])
        });
        let channels = vec![
            Channel::new(STRUCK, Quantity::Acceleration)?,
            Channel::new(FREE, Quantity::Acceleration)?,
        ];
        let provenance = Provenance::computed(exact.generator);
        let history = Record::new(samples, 1.0 / interval, 0.0, channels, provenance)?;
        let front_end = Instrument::new()
            .anti_alias(AntiAlias::butterworth(8, CORNER_HZ)?)
            .sample(RATE_HZ, 0.0)?;
        // filter and sampler use no random numbers
        let mut random = ChaCha8Rng::seed_from_u64(0);
        Ok(Self {
            specimen,
            medium,
            filtered: front_end.record(&history, &mut random)?.record,
            averaged: paper.averaged,
            highest_hz: paper.highest_hz,
        })
    }

    /// Returns Ψ of the tests of the paper, H₁ of section 3, for blows of this strength relative to that of its
    /// swing angle. The noise is that of the sensors; the range of the converter is adapted to the blow.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a transcribed whole number, ten"
    )]
    pub(crate) fn ratio(&self, strength: f64, seed: u64) -> Result<Ratio, Error> {
        let mut instrument = Instrument::new();
        for name in [STRUCK, FREE] {
            let peak = self
                .filtered
                .channel(name)?
                .iter()
                .fold(0.0_f64, |peak, a| peak.max(a.abs()));
            let density = (NOISE * peak).powi(2) / (0.5 * RATE_HZ);
            instrument = instrument
                .noise(name, NoiseSpectrum::white(density)?)
                .convert_channel(name, Converter::new(BITS, RANGE * strength * peak)?);
        }
        let blow = self.of_strength(strength)?;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut averager = SpectrumAverager::for_records_like(&blow, Window::Rectangular)?;
        for _ in 0..self.averaged as usize {
            averager.add(&instrument.record(&blow, &mut random)?.record)?;
        }
        Ok(Ratio(averager.spectra()?.h1(FREE, STRUCK)?))
    }

    /// Returns Ψ without noise and rounding.
    pub(crate) fn ratio_without_noise(&self, strength: f64) -> Result<Ratio, Error> {
        let blow = self.of_strength(strength)?;
        let mut averager = SpectrumAverager::for_records_like(&blow, Window::Rectangular)?;
        averager.add(&blow)?;
        Ok(Ratio(averager.spectra()?.h1(FREE, STRUCK)?))
    }

    fn of_strength(&self, strength: f64) -> Result<Record, Error> {
        Ok(Record::new(
            &self.filtered.samples() * strength,
            RATE_HZ,
            0.0,
            self.filtered.channels().to_vec(),
            Provenance::computed("blow"),
        )?)
    }

    pub(crate) fn estimate(&self, ratio: &Ratio, solver: Solver) -> Result<ModulusEstimate, Error> {
        let response = &ratio.0;
        let lines = response
            .frequency_hz
            .partition_point(|f| *f <= self.highest_hz);
        let coherence = response.coherence.as_ref().ok_or("ten blows have one")?;
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
