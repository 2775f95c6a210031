//! The measurement of an impulse response as in paper E, section 3.1, on virtual bodies: an
//! impedance head on the impact face, a light and a heavy hammer, ten tests with each, spectra
//! averaged and merged, the mass of the head taken off.
//!
//! The blows are made by the Laplace transform on a damped line (`rodwave::experiment`); sensors,
//! filter and noise are those of `labio`. Nylon-6 has a constant loss factor at the level of the
//! paper's eq. 7, which is itself not causal.

use std::error::Error;
use std::f64::consts::TAU;

use impulse::{FaceMobility, ImpedanceHead, StickProblem, StickUncertainty, ZeroLine};
use labio::instrument::{AntiAlias, Instrument, NoiseSpectrum};
use labio::{
    AveragedSpectra, Channel, Estimator, MergedResponse, Provenance, Quantity, Record, Window,
};
use ndarray::Array2;
use num_complex::Complex64;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use rodwave::chain::{
    AnalyticChain, Argument, Chain, ChainBuilder, LaplaceVariable, Termination, WaveMedium,
};
use rodwave::element::Circle;
use rodwave::experiment::impact_of_two_bodies::ImpactOfTwoBodies;
use rodwave::medium::Medium;
use rodwave::modulus::{ConstantQ, Elastic, PowerLawPropagation};

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Sample period and number of samples (paper E, section 3.1).
const SAMPLE_PERIOD: f64 = 28e-6;
const N_SAMPLES: usize = 4096;
/// "Only the low-frequency halves of the spectra were used."
const N_LINES: usize = N_SAMPLES / 4 + 1;
const TESTS: u32 = 10;
/// Ratio of the rate at which the histories are computed to the sampling rate.
const FINER: usize = 8;
/// Length of the pendulum [m].
const PENDULUM: f64 = 0.300;
const GRAVITY: f64 = 9.81;
/// Mass of the impedance head above and below its gauge [kg]; not in the paper.
const ABOVE_GAUGE: f64 = 0.028;
const BELOW_GAUGE: f64 = 0.0012;
/// Noise of the gauge [N] and of the accelerometer [m/s^2], standard deviation; not in the paper.
const FORCE_NOISE: f64 = 0.02;
const ACCELERATION_NOISE: f64 = 1.0;

/// A body with its impact face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Case {
    ConeA,
    ConeB,
    CylinderA,
    CylinderB,
}

/// A steel cylinder on a pendulum.
#[derive(Debug, Clone, Copy)]
struct Hammer {
    length: f64,
    diameter: f64,
    swing_degrees: f64,
    /// Stiffness of its contact with the head [N/m]; not in the paper.
    stiffness: f64,
}

/// Choice of the response among those of the two hammers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Merging {
    /// Response of the larger force (as in the paper).
    LargerForce,
    /// Mean of both responses, weighted by their inverse variances.
    InverseVariance,
}

impl Case {
    pub(crate) const ALL: [Self; 4] = [Self::ConeA, Self::ConeB, Self::CylinderA, Self::CylinderB];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::ConeA => "TCA",
            Self::ConeB => "TCB",
            Self::CylinderA => "CCA",
            Self::CylinderB => "CCB",
        }
    }

    /// Impact velocity [m/s] (paper E, section 4).
    pub(crate) fn velocity(self) -> f64 {
        match self {
            Self::ConeA => 1.16,
            Self::ConeB => 0.93,
            Self::CylinderA => 0.92,
            Self::CylinderB => 1.01,
        }
    }

    fn hammers(self) -> [Hammer; 2] {
        let (light, heavy) = match self {
            Self::ConeA | Self::ConeB => (6.0, 4.0),
            Self::CylinderA => (4.0, 4.0),
            Self::CylinderB => (4.0, 3.5),
        };
        [
            Hammer {
                length: 0.030,
                diameter: 0.015,
                swing_degrees: light,
                stiffness: 4e7,
            },
            Hammer {
                length: 0.075,
                diameter: 0.020,
                swing_degrees: heavy,
                stiffness: 1e7,
            },
        ]
    }

    fn of<V>(self, before: ChainBuilder<V>) -> Outcome<Chain<V>>
    where
        V: Argument,
        Medium<ConstantQ>: WaveMedium<V>,
        Medium<Elastic>: WaveMedium<V>,
    {
        let nylon = nylon()?;
        let aluminium = Medium::new(2700.0, Elastic::new(69e9)?)?;
        let circle = Circle::of_diameter;
        let body = match self {
            Self::ConeA => before.cone(&nylon, circle(0.030), circle(0.075), 0.400),
            Self::ConeB => before.cone(&nylon, circle(0.075), circle(0.030), 0.400),
            Self::CylinderA => before
                .rod(&nylon, circle(0.032), 0.125)
                .rod(&aluminium, circle(0.032), 0.125)
                .rod(&nylon, circle(0.032), 0.125)
                .rod(&aluminium, circle(0.032), 0.125),
            Self::CylinderB => before
                .rod(&aluminium, circle(0.032), 0.125)
                .rod(&nylon, circle(0.032), 0.125)
                .rod(&aluminium, circle(0.032), 0.125)
                .rod(&nylon, circle(0.032), 0.125),
        };
        Ok(body.end(Termination::Free)?)
    }

    /// The mobility of the bare face, predicted on the lines of the measurement; line 0 is not to
    /// be read.
    pub(crate) fn predicted(self) -> Outcome<Vec<Complex64>> {
        let body = self.of(Chain::from_impact_face())?;
        let lines =
            (1..N_LINES).map(|line| Ok(body.mobility(TAU * frequency_step_hz() * line as f64)?));
        std::iter::once(Ok(Complex64::ZERO)).chain(lines).collect()
    }

    /// Mass by weighing [kg].
    pub(crate) fn mass(self) -> Outcome<f64> {
        let body = self.of(Chain::from_impact_face())?;
        Ok(body.free_mass().ok_or("the body is free")?)
    }

    /// The mobility of the bare face, measured with both hammers.
    pub(crate) fn measured(self, merging: Merging, random: &mut impl Rng) -> Outcome<FaceMobility> {
        let [light, heavy] = self.hammers();
        let light = self.struck_by(light, random)?;
        let heavy = self.struck_by(heavy, random)?;
        let merged = match merging {
            Merging::LargerForce => MergedResponse::by_larger_input(
                &[&light, &heavy],
                Estimator::H1,
                "force",
                "acceleration",
            )?,
            Merging::InverseVariance => MergedResponse::by_inverse_variance(&[
                light.h1("force", "acceleration")?,
                heavy.h1("force", "acceleration")?,
            ])?,
        };
        let response = merged.response;
        let variance = response.variance.ok_or("ten tests have a variance")?;
        // the variance from n tests is too small by (n - 1)/n
        let n = f64::from(TESTS);
        let variance: Vec<f64> = variance.iter().map(|v| v * n / (n - 1.0)).collect();
        let head = ImpedanceHead::new(BELOW_GAUGE)?;
        let lines = (&response.values[..N_LINES], &variance[..N_LINES]);
        Ok(head.face_mobility(lines.0, lines.1, frequency_step_hz())?)
    }

    /// Ten tests with one hammer.
    fn struck_by(self, hammer: Hammer, random: &mut impl Rng) -> Outcome<AveragedSpectra> {
        let steel = Medium::new(7800.0, Elastic::new(206e9)?)?;
        let striker = AnalyticChain::analytic_from_impact_face()
            .spring(hammer.stiffness)
            .rod(&steel, Circle::of_diameter(hammer.diameter), hammer.length)
            .end(Termination::Free)?;
        let target: Chain<LaplaceVariable> = self.of(AnalyticChain::analytic_from_impact_face()
            .mass(ABOVE_GAUGE)
            .mass(BELOW_GAUGE))?;
        let swing = hammer.swing_degrees.to_radians();
        let interval = SAMPLE_PERIOD / FINER as f64;
        let blow = ImpactOfTwoBodies {
            first: &striker,
            second: &target,
            velocity: 2.0 * (0.5 * swing).sin() * (GRAVITY * PENDULUM).sqrt(),
        }
        .run(N_SAMPLES as f64 * SAMPLE_PERIOD, interval)?;
        let force = blow.transmitted_force(1, 0.0)?;
        let acceleration = blow.second_acceleration()?;
        let instrument = Instrument::new()
            .anti_alias(AntiAlias::butterworth(8, 12e3)?)
            .sample(1.0 / SAMPLE_PERIOD, 0.0)?
            .noise("force", white(FORCE_NOISE)?)
            .noise("acceleration", white(ACCELERATION_NOISE)?);
        let records = (0..TESTS).map(|_| {
            // the pendulum is released by hand
            let spread: f64 = random.sample(StandardNormal);
            let strength = 1.0 + 0.05 * spread;
            let samples = Array2::from_shape_fn((2, FINER * N_SAMPLES), |(channel, n)| {
                strength
                    * if channel == 0 {
                        force[n]
                    } else {
                        acceleration[n]
                    }
            });
            let channels = vec![
                Channel::new("force", Quantity::Force)?,
                Channel::new("acceleration", Quantity::Acceleration)?,
            ];
            let provenance = Provenance::computed(blow.generator);
            let history = Record::new(samples, 1.0 / interval, 0.0, channels, provenance)?;
            Ok(instrument.record(&history, random)?.record)
        });
        let records = records.collect::<Outcome<Vec<Record>>>()?;
        Ok(AveragedSpectra::of(&records, Window::Rectangular)?)
    }

    /// The impact on the long steel rod of the paper, with this mobility of the body.
    pub(crate) fn on_long_rod<'a>(
        self,
        body: &'a [Complex64],
        rod: &'a [Complex64],
    ) -> Outcome<StickProblem<'a>> {
        Ok(StickProblem {
            first: body,
            second: rod,
            frequency_step_hz: frequency_step_hz(),
            impact_velocity: self.velocity(),
            zero_line: ZeroLine::EffectiveMass(self.mass()?),
            roll_off_from_hz: None,
            interpolation: 1,
            until: None,
        })
    }
}

/// The predicted mobility of the long rod, which is taken as semi-infinite.
pub(crate) fn long_rod() -> Outcome<Vec<Complex64>> {
    let steel = Medium::new(7780.0, Elastic::new(206e9)?)?;
    let rod = Chain::from_impact_face().end(Termination::semi_infinite(
        &steel,
        Circle::of_diameter(0.010)?,
    ))?;
    let lines = (1..N_LINES).map(|line| Ok(rod.mobility(TAU * frequency_step_hz() * line as f64)?));
    std::iter::once(Ok(Complex64::ZERO)).chain(lines).collect()
}

/// The errors of a prediction from this measurement.
pub(crate) fn uncertainty(measured: &FaceMobility) -> StickUncertainty<'_> {
    StickUncertainty {
        first_variance: Some(&measured.variance),
        ..StickUncertainty::default()
    }
}

fn frequency_step_hz() -> f64 {
    1.0 / (N_SAMPLES as f64 * SAMPLE_PERIOD)
}

/// The law of constant loss that has the modulus of eq. 7 at 3 kHz.
fn nylon() -> Outcome<Medium<ConstantQ>> {
    const DENSITY: f64 = 1150.0;
    let omega = TAU * 3e3;
    let printed = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?;
    let modulus = Medium::new(DENSITY, printed)?.modulus(omega);
    let law = ConstantQ::new(modulus.norm(), modulus.im / modulus.re, omega)?;
    Ok(Medium::new(DENSITY, law)?)
}

/// Noise of this standard deviation up to half the sampling rate.
fn white(deviation: f64) -> Outcome<NoiseSpectrum> {
    Ok(NoiseSpectrum::white(
        deviation * deviation * 2.0 * SAMPLE_PERIOD,
    )?)
}
