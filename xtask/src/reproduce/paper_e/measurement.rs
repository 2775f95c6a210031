//! Impulse responses of virtual bodies, measured as in the paper: an impedance head, a light and a
//! heavy hammer, ten tests with each hammer.
//!
//! The blows are computed by the damped Fourier transform of `rodwave::experiment`; the predictions
//! of forces use other methods.

use std::ops::Deref;

use impulse::{FaceMobility, ImpedanceHead, LowFrequency, MeasuredBody, WeighedMass};
use labio::instrument::{AntiAlias, Instrument, NoiseSpectrum};
use labio::{
    AveragedSpectra, Channel, Estimator, MergedResponse, Provenance, Quantity, Record, Window,
};
use ndarray::Array2;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::experiment::impact_of_two_bodies::ImpactOfTwoBodies;

use super::super::Error;
use testbed::papers::paper_e::bodies::Face;
use testbed::papers::paper_e::{Hammer, PaperE};

/// Ratio of the sampling rate of the computed histories to that of the records.
const FINER: usize = 8;
const GRAVITY: f64 = 9.81;
/// Masses of the impedance head above and below its gauge, in kg. These and the constants below are
/// not stated in the paper.
const ABOVE_GAUGE: f64 = 0.028;
const BELOW_GAUGE: f64 = 0.0012;
/// Contact stiffness of the light and the heavy hammer with the head, in N/m.
const STIFFNESS: [f64; 2] = [4e7, 1e7];
/// Standard deviations of the noise of one sample: force in N, acceleration in m/s².
pub(crate) const FORCE_NOISE: f64 = 0.02;
pub(crate) const ACCELERATION_NOISE: f64 = 1.0;
/// Scatter of the blows, because the pendulum is released by hand.
const SCATTER: f64 = 0.05;
/// Standard uncertainty of weighing, in kg.
const WEIGHING: f64 = 1e-4;
pub(crate) const SEED: u64 = 1993;

/// Mobility of a bare face; the results of both hammers are merged by two rules.
#[derive(Debug)]
pub(crate) struct Measurement {
    pub(crate) frequency_step_hz: f64,
    /// Each line from the hammer with the larger force, the rule of the paper.
    pub(crate) larger_force: FaceMobility,
    /// Each line from both hammers, weighted by their variances.
    pub(crate) inverse_variance: FaceMobility,
    /// Fraction of the lines that the rule of the paper takes from the light hammer.
    pub(crate) part_of_light: f64,
    /// Median frequency of the lines at which this rule changes the hammer, in Hz.
    pub(crate) crossover_hz: Option<f64>,
}

/// Laboratory of the paper.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Laboratory<'a>(pub(crate) &'a PaperE);

impl Deref for Laboratory<'_> {
    type Target = PaperE;

    fn deref(&self) -> &PaperE {
        self.0
    }
}

impl Laboratory<'_> {
    /// Returns a mobility of a weighed body on the lines of the measurement.
    pub(crate) fn on_lines(
        &self,
        face: Face,
        mobility: &[num_complex::Complex64],
        variance: Option<&[f64]>,
    ) -> Result<MeasuredBody, Error> {
        let weighed = LowFrequency::Free(WeighedMass {
            mass: self.mass(face)?,
            standard_error: WEIGHING,
        });
        // the band ends at 8.9 kHz; above it, the response of the face is that of its material
        let body = MeasuredBody::from_mobility(mobility, self.frequency_step_hz(), weighed)?
            .with_front_impedance(self.front_impedance(face)?)?;
        Ok(match variance {
            Some(variance) => body.with_variance(variance)?,
            None => body,
        })
    }

    pub(crate) fn measure(&self, face: Face) -> Result<Measurement, Error> {
        let position = Face::ALL.iter().position(|other| *other == face);
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        random.set_stream(position.unwrap_or_default() as u64);
        let case = self.case(face)?;
        let [of_light, of_heavy] = STIFFNESS;
        let light = (self.light_hammer, case.light_swing, of_light);
        let heavy = (self.heavy_hammer, case.heavy_swing, of_heavy);
        let light = self.struck_by(face, light, &mut random)?;
        let heavy = self.struck_by(face, heavy, &mut random)?;
        let (input, output) = ("force", "acceleration");
        let by_force =
            MergedResponse::by_larger_input(&[&light, &heavy], Estimator::H1, input, output)?;
        let by_variance = MergedResponse::by_inverse_variance(&[
            light.h1(input, output)?,
            heavy.h1(input, output)?,
        ])?;
        let n_lines = self.n_lines();
        let from_light: Vec<bool> = (1..n_lines)
            .map(|line| by_force.shares[(0, line)] > 0.5)
            .collect();
        let changes: Vec<usize> = (1..from_light.len())
            .filter(|&line| from_light[line] != from_light[line - 1])
            .collect();
        let step = self.frequency_step_hz();
        #[expect(clippy::cast_precision_loss, reason = "a thousand lines")]
        Ok(Measurement {
            frequency_step_hz: step,
            part_of_light: from_light.iter().filter(|light| **light).count() as f64
                / from_light.len() as f64,
            crossover_hz: changes
                .get(changes.len() / 2)
                .map(|line| (*line as f64 + 1.0) * step),
            larger_force: self.bare_face(&by_force)?,
            inverse_variance: self.bare_face(&by_variance)?,
        })
    }

    /// Returns the mobility of the face after subtraction of the mass of the head.
    fn bare_face(&self, merged: &MergedResponse) -> Result<FaceMobility, Error> {
        let variance = merged
            .response
            .variance
            .as_ref()
            .ok_or("ten tests have a variance")?;
        let n_lines = self.n_lines();
        // the variance from n tests is too small by the factor (n - 1)/n
        let unbiased = self.averaged / (self.averaged - 1.0);
        let variance: Vec<f64> = variance[..n_lines].iter().map(|v| v * unbiased).collect();
        Ok(ImpedanceHead::new(BELOW_GAUGE)?.face_mobility(
            &merged.response.values[..n_lines],
            &variance,
            self.frequency_step_hz(),
        )?)
    }

    /// Runs the tests with one hammer, for its properties, its swing angle and the stiffness of its
    /// contact.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "ten tests of 4096 samples"
    )]
    fn struck_by(
        &self,
        face: Face,
        (hammer, swing, stiffness): (Hammer, f64, f64),
        random: &mut impl Rng,
    ) -> Result<AveragedSpectra, Error> {
        let striker = AnalyticChain::analytic_from_impact_face()
            .spring(stiffness)
            .rod(
                &self.steel()?,
                PaperE::circle(hammer.diameter)?,
                hammer.length,
            )
            .end(Termination::Free)?;
        let head = AnalyticChain::analytic_from_impact_face()
            .mass(ABOVE_GAUGE)
            .mass(BELOW_GAUGE);
        let target = self.body(face, head, &self.causal_nylon()?)?;
        let interval = self.sample_period / FINER as f64;
        let blow = ImpactOfTwoBodies {
            first: &striker,
            second: &target,
            velocity: 2.0 * (0.5 * swing).sin() * (GRAVITY * self.pendulum_length).sqrt(),
        }
        .run(self.samples * self.sample_period, interval)?;
        let force = blow.transmitted_force(1, 0.0)?;
        let acceleration = blow.second_acceleration()?;
        let white =
            |deviation: f64| NoiseSpectrum::white(deviation * deviation * 2.0 * self.sample_period);
        let instrument = Instrument::new()
            .anti_alias(AntiAlias::butterworth(8, 12e3)?)
            .sample(1.0 / self.sample_period, 0.0)?
            .noise("force", white(FORCE_NOISE)?)
            .noise("acceleration", white(ACCELERATION_NOISE)?);
        let records = (0..self.averaged as usize).map(|_| {
            let spread: f64 = random.sample(StandardNormal);
            let strength = 1.0 + SCATTER * spread;
            let samples = Array2::from_shape_fn((2, FINER * self.n_samples()), |(channel, n)| {
                let history = if channel == 0 { &force } else { &acceleration };
                strength * history[n]
            });
            let channels = vec![
                Channel::new("force", Quantity::Force)?,
                Channel::new("acceleration", Quantity::Acceleration)?,
            ];
            let provenance = Provenance::computed(blow.generator);
            let history = Record::new(samples, 1.0 / interval, 0.0, channels, provenance)?;
            Ok(instrument.record(&history, random)?.record)
        });
        let records = records.collect::<Result<Vec<Record>, Error>>()?;
        Ok(AveragedSpectra::of(&records, Window::Rectangular)?)
    }
}
