//! Checks without known true values: they pass correct records, identify the fault of wrong
//! records, and have the stated rate of false alarms.
//!
//! Spectra and histories are those of chains of impedances; no check uses these chains.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test, a refusal where none is expected is a failure"
)]

mod false_alarms;
mod few_hits;
mod wrong_records;

use std::f64::consts::TAU;

use cmod::checks::{
    Arrivals, Channel, CheckOutcome, CheckVerdict, FreeEndNull, USUAL_LEVEL, kramers_kronig,
    passivity,
};
use cmod::estimate::ModulusEstimate;
use cmod::multi_point::{GaugeSpectra, Quantity};
use cmod::{EndSection, FreeEnd, PulsedRod, RatioOfSpectra, RodWithFreeEnd, SeparatePulses};
use num_complex::Complex64;
use rodwave::chain::{AngularFrequency, Chain, Termination, WaveMedium};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{ComplexModulus, GeneralisedMaxwell};
use testbed::noise::Noise;

use crate::rheology::measured::series;

const LENGTH: f64 = 1.2;
const DIAMETER: f64 = 0.0106;
const DENSITY: f64 = 903.0;
const END_MASS: f64 = 1e-3;
/// Distances of the sections from the free end [m].
const DISTANCES: [f64; 3] = [0.52, 0.25, 0.11];
/// Error of a strain, relative to the root mean square of the spectra on a line.
const NOISE: f64 = 2e-3;

fn rod() -> RodWithFreeEnd {
    RodWithFreeEnd {
        diameter: DIAMETER,
        density: DENSITY,
        end_mass: END_MASS,
    }
}

/// Returns a material with loss factors of about 0.06 between 100 Hz and 20 kHz, whose wave front
/// travels at 1800 m/s.
fn relaxing() -> Medium<GeneralisedMaxwell> {
    let branches: Vec<(f64, f64)> = (0..6).map(|j| (1.3e8, 3e-6 * 4f64.powi(j))).collect();
    Medium::new(DENSITY, series(2.14e9, &branches)).unwrap()
}

/// Returns the speed of the wave front, from the unrelaxed modulus.
fn front_speed() -> f64 {
    (relaxing().law().unrelaxed_modulus() / DENSITY).sqrt()
}

/// Strains at three sections, with noise, and the moduli estimated from them.
struct SpectraOfTest {
    frequency_hz: Vec<f64>,
    strains: Vec<Vec<Complex64>>,
    noise: Vec<Vec<f64>>,
}

impl SpectraOfTest {
    fn of<M>(medium: &M, distances: [f64; 3], random: &mut Noise) -> Self
    where
        M: WaveMedium<AngularFrequency> + Clone + 'static,
    {
        let frequency_hz: Vec<f64> = (1..=120).map(|j| 80.0 * f64::from(j)).collect();
        let chain = Chain::from_impact_face()
            .rod(medium, Circle::of_diameter(DIAMETER).unwrap(), LENGTH)
            .end(Termination::Mass(END_MASS))
            .unwrap();
        let mut strains: Vec<Vec<Complex64>> = distances
            .iter()
            .map(|distance| {
                let section = chain.section(0, LENGTH - distance).unwrap();
                let force = |f: &f64| section.state(TAU * f).unwrap().normal_force;
                frequency_hz.iter().map(force).collect()
            })
            .collect();
        let level: Vec<f64> = (0..frequency_hz.len())
            .map(|line| {
                let power: f64 = strains.iter().map(|strain| strain[line].norm_sqr()).sum();
                NOISE * (power / 3.0).sqrt()
            })
            .collect();
        for strain in &mut strains {
            for (value, level) in strain.iter_mut().zip(&level) {
                *value += random.circular((*level).powi(2));
            }
        }
        Self {
            frequency_hz,
            strains,
            noise: vec![level; 3],
        }
    }

    fn estimate(&self) -> ModulusEstimate {
        let section = |distance| EndSection {
            distance,
            quantity: Quantity::Strain,
        };
        let ratio = RatioOfSpectra::new(
            &[&self.strains[0]],
            &[&self.strains[1]],
            &self.noise[0],
            &self.noise[1],
        )
        .unwrap();
        FreeEnd::new(rod(), section(DISTANCES[0]), section(DISTANCES[1]))
            .unwrap()
            .estimate(&self.frequency_hz, &ratio.ratio, &ratio.variance)
            .unwrap()
    }

    fn free_end_null(&self, level: f64) -> CheckOutcome {
        let estimate = self.estimate();
        let mut gamma = vec![Complex64::new(f64::NAN, 0.0); self.frequency_hz.len()];
        for line in estimate.lines() {
            gamma[line.index] = line.propagation_coefficient;
        }
        let spectra = GaugeSpectra {
            frequency_hz: &self.frequency_hz,
            tests: &[&self.strains],
            noise: &self.noise,
        };
        FreeEndNull::new(rod(), DISTANCES.to_vec(), Quantity::Strain)
            .unwrap()
            .check(&spectra, &gamma, level)
            .unwrap()
    }
}

/// Adds noise of the given standard deviation, in which each sample contains `persistence` times
/// the previous sample, and an offset.
fn noisy(
    clean: impl Iterator<Item = f64>,
    deviation: f64,
    persistence: f64,
    random: &mut Noise,
) -> Vec<f64> {
    let fresh = (1.0 - persistence * persistence).sqrt();
    let mut noise = random.normal();
    clean
        .map(|value| {
            noise = persistence * noise + fresh * random.normal();
            value + deviation * (noise + 3.0)
        })
        .collect()
}

const INTERVAL: f64 = 2e-6;
const BLOW: usize = 600;

fn arrivals(histories: &[Vec<f64>]) -> Arrivals<'_> {
    let channels = histories
        .iter()
        .zip(DISTANCES)
        .map(|(samples, distance)| Channel {
            samples,
            distance: LENGTH - distance,
        });
    Arrivals::new(channels.collect(), INTERVAL, BLOW).unwrap()
}

fn causality(histories: &[Vec<f64>], level: f64) -> CheckOutcome {
    // the assumed speed is 1 % above the speed of the front
    arrivals(histories)
        .causality(1.01 * front_speed(), level)
        .unwrap()
}
