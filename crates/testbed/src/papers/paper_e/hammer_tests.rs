//! The hammer tests of paper E, section 3.1, on virtual bodies: an impedance head on the face, a
//! light and a heavy hammer, averaged and merged spectra.
//!
//! The hits are computed by the damped Fourier transform of `rodwave::experiment`; the sensors,
//! the filter and the noise are those of `labio`. The nylon of the bodies has the causal law.

use labio::instrument::{AntiAlias, Instrument, NoiseSpectrum};
use labio::{
    AveragedSpectra, Channel, Estimator, LabioError, MergedResponse, Provenance, Quantity, Record,
    Window,
};
use ndarray::Array2;
use num_complex::Complex64;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::experiment::impact_of_two_bodies::ImpactOfTwoBodies;

use super::bodies::Face;
use super::{Hammer, PaperE};
use crate::claim::Fallible;

/// Ratio of the sampling rate of the computed histories to that of the records.
const FINER: usize = 8;
const GRAVITY: f64 = 9.81;
/// Masses of the impedance head above and below its gauge, in kg. These and the constants below are
/// not stated in the paper.
const ABOVE_GAUGE: f64 = 0.028;
pub const BELOW_GAUGE: f64 = 0.0012;
/// Contact stiffness of the light and the heavy hammer with the head, in N/m.
const STIFFNESS: [f64; 2] = [4e7, 1e7];
/// Standard deviations of the noise of one sample: force in N, acceleration in m/s².
pub const FORCE_NOISE: f64 = 0.02;
pub const ACCELERATION_NOISE: f64 = 1.0;
/// Relative standard deviation of the strengths of the hits: the pendulum is released by hand.
const SCATTER: f64 = 0.05;

/// Spectra of the tests with the light and with the heavy hammer.
#[derive(Debug)]
pub struct HammerTests([AveragedSpectra; 2]);

impl HammerTests {
    /// Returns each line from the hammer with the larger force, as in the paper.
    pub fn by_larger_force(&self) -> Result<MergedResponse, LabioError> {
        let [light, heavy] = &self.0;
        MergedResponse::by_larger_input(&[light, heavy], Estimator::H1, "force", "acceleration")
    }

    /// Returns each line from both hammers, weighted by their inverse variances.
    pub fn by_inverse_variance(&self) -> Result<MergedResponse, LabioError> {
        let [light, heavy] = &self.0;
        MergedResponse::by_inverse_variance(&[
            light.h1("force", "acceleration")?,
            heavy.h1("force", "acceleration")?,
        ])
    }
}

impl PaperE {
    /// Strikes a face with both hammers.
    pub fn hammer_tests(&self, face: Face, random: &mut impl Rng) -> Fallible<HammerTests> {
        let case = self.case(face)?;
        let [of_light, of_heavy] = STIFFNESS;
        let light = (self.light_hammer, case.light_swing, of_light);
        let heavy = (self.heavy_hammer, case.heavy_swing, of_heavy);
        Ok(HammerTests([
            self.struck_by(face, light, random)?,
            self.struck_by(face, heavy, random)?,
        ]))
    }

    /// Returns the accelerance under the gauge of the head on the lines of the paper, in 1/kg, and
    /// its variance.
    pub fn on_lines(&self, merged: &MergedResponse) -> Fallible<(Vec<Complex64>, Vec<f64>)> {
        let values = merged.response.values.iter().take(self.n_lines());
        let variance = merged.response.variance.as_ref();
        let variance = variance.ok_or("the merged response has no variance")?;
        // the variance estimated from n tests is too small by the factor (n - 1)/n
        let unbiased = self.averaged / (self.averaged - 1.0);
        let variance = variance.iter().take(self.n_lines()).map(|v| v * unbiased);
        Ok((values.copied().collect(), variance.collect()))
    }

    /// Runs the tests with one hammer, given by its dimensions, its swing angle and its contact
    /// stiffness.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::indexing_slicing,
        reason = "ten tests of 4096 samples; the histories are as long as the records"
    )]
    fn struck_by(
        &self,
        face: Face,
        (hammer, swing, stiffness): (Hammer, f64, f64),
        random: &mut impl Rng,
    ) -> Fallible<AveragedSpectra> {
        let striker = AnalyticChain::analytic_from_impact_face()
            .spring(stiffness)
            .rod(
                &self.steel()?,
                Self::circle(hammer.diameter)?,
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
        let records = records.collect::<Fallible<Vec<Record>>>()?;
        Ok(AveragedSpectra::of(&records, Window::Rectangular)?)
    }
}
