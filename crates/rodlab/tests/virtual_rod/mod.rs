//! Virtual records of the rod of paper A with instrument noise, written as files of a recorder.

use std::f64::consts::TAU;
use std::path::Path;

use labio::instrument::{AntiAlias, Converter, Instrument, NoiseSpectrum};
use labio::{Channel, Provenance, Quantity, Record};
use ndarray::Array2;
use num_complex::Complex64;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rodwave::chain::Termination;
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::{EndAccelerationTest, RaisedCosine, Specimen};
use rodwave::experiment::strains_in_a_frame::{Excitation, FrameMember};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use rodwave::synthesis::DampedSynthesis;

use crate::runs::write_npy;

pub(crate) const RATE_HZ: f64 = 65_536.0;
/// Number of samples per hit.
pub(crate) const SAMPLES: usize = 4096;
const OVERSAMPLING: usize = 8;
/// Number of samples before a hit.
const LEAD: usize = 128;
/// Sensitivity of 0.5 mV/g in V/(m/s²).
const VOLTS: f64 = 0.5e-3 / 9.80665;

fn medium() -> Medium<ConstantQ> {
    medium_of(2.6e9)
}

fn medium_of(modulus: f64) -> Medium<ConstantQ> {
    Medium::new(912.0, ConstantQ::new(modulus, 0.07, 1e4).unwrap()).unwrap()
}

/// The modulus of the rod as a function of the frequency \[Hz\].
pub(crate) fn polypropylene() -> impl Fn(f64) -> Complex64 {
    let medium = medium();
    move |f| medium.modulus(TAU * f)
}

/// Accelerations of the ends after a hit of 100 N and 80 µs, filtered and sampled, without noise.
fn filtered(medium: &Medium<ConstantQ>, random: &mut ChaCha8Rng) -> Record {
    let rig = Specimen {
        section: Circle::of_diameter(0.0158).unwrap().into(),
        length: 0.799,
        accelerometer_mass: 2.9e-3,
    };
    let synthesis = synthesis();
    let exact = EndAccelerationTest::analytic(medium, &rig)
        .unwrap()
        .record(&RaisedCosine::new(100.0, 8e-5).unwrap(), &synthesis)
        .unwrap();
    let ends = [exact.impacted_end, exact.free_end];
    let channels = ["struck end", "free end"].map(|name| (name, Quantity::Acceleration));
    sampled(&channels, &ends, exact.generator, random)
}

fn synthesis() -> DampedSynthesis {
    let interval = 1.0 / (RATE_HZ * OVERSAMPLING as f64);
    let count = (SAMPLES + LEAD) * OVERSAMPLING;
    DampedSynthesis::new(count as f64 * interval, interval)
        .unwrap()
        .smoothed(2.5 * interval)
        .unwrap()
}

/// Histories of these channels after a time of rest, filtered and sampled.
fn sampled(
    channels: &[(&str, Quantity)],
    histories: &[Vec<f64>],
    generator: &'static str,
    random: &mut ChaCha8Rng,
) -> Record {
    let shape = (channels.len(), (SAMPLES + LEAD) * OVERSAMPLING);
    let samples = Array2::from_shape_fn(shape, |(channel, sample)| {
        let after = sample.checked_sub(LEAD * OVERSAMPLING);
        after.map_or(0.0, |after| histories[channel][after])
    });
    let channels = channels.iter();
    let channels = channels.map(|(name, quantity)| Channel::new(*name, *quantity).unwrap());
    let rate = RATE_HZ * OVERSAMPLING as f64;
    let provenance = Provenance::computed(generator);
    let history = Record::new(samples, rate, 0.0, channels.collect(), provenance).unwrap();
    Instrument::new()
        .anti_alias(AntiAlias::butterworth(8, 22e3).unwrap())
        .sample(RATE_HZ, 0.0)
        .unwrap()
        .record(&history, random)
        .unwrap()
        .record
}

/// Writes `hits.npy`: `count` hits, one after the other, in one recording of two channels \[V\],
/// with noise and 16 bits.
pub(crate) fn write_hits(folder: &Path, count: usize, seed: u64) {
    write_changing_hits(folder, &vec![0.0; count], seed);
}

/// Writes hits as [`write_hits`] does, of a rod whose modulus has changed by these fractions.
pub(crate) fn write_changing_hits(folder: &Path, changes: &[f64], seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let one = filtered(&medium(), &mut random);
    let mut instrument = Instrument::new();
    for name in ["struck end", "free end"] {
        let peak = one
            .channel(name)
            .unwrap()
            .iter()
            .fold(0.0_f64, |p, a| p.max(a.abs()));
        // noise of 2e-4 of the peak over the band
        let density = (2e-4 * peak).powi(2) / (0.5 * RATE_HZ);
        instrument = instrument
            .noise(name, NoiseSpectrum::white(density).unwrap())
            .convert_channel(name, Converter::new(16, 1.25 * peak).unwrap());
    }
    let mut rows = [Vec::new(), Vec::new()];
    for change in changes {
        let changed =
            (*change != 0.0).then(|| filtered(&medium_of(2.6e9 * (1.0 + change)), &mut random));
        let hit = instrument.record(changed.as_ref().unwrap_or(&one), &mut random);
        let hit = hit.unwrap().record;
        for (row, samples) in rows.iter_mut().zip(hit.samples().rows()) {
            row.extend(samples.iter().map(|a| VOLTS * a));
        }
    }
    write_npy(&folder.join("hits.npy"), &rows);
}

/// Writes strains at `positions` \[m\] of the same rod, free at both ends, with each hit in its own
/// file `gauges_N.npy` \[µε\].
pub(crate) fn write_gauges(folder: &Path, positions: &[f64], count: usize, seed: u64) {
    let synthesis = synthesis();
    let member = FrameMember::analytic(
        &medium(),
        Circle::of_diameter(0.0158).unwrap(),
        0.8,
        positions,
        Termination::Free,
    )
    .unwrap();
    let blow = RaisedCosine::new(100.0, 8e-5).unwrap();
    let exact = member
        .record(&Excitation::Force(&blow), &synthesis)
        .unwrap();
    let names: Vec<String> = (1..=positions.len())
        .map(|n| format!("gauge {n}"))
        .collect();
    let channels: Vec<_> = names
        .iter()
        .map(|name| (name.as_str(), Quantity::Strain))
        .collect();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let one = sampled(&channels, &exact.strains, exact.generator, &mut random);
    let mut instrument = Instrument::new();
    for name in &names {
        // noise of 0.01 microstrain over the band, with a peak of about 190 microstrain
        let density = 0.01e-6_f64.powi(2) / (0.5 * RATE_HZ);
        instrument = instrument.noise(name, NoiseSpectrum::white(density).unwrap());
    }
    for number in 1..=count {
        let hit = instrument.record(&one, &mut random).unwrap().record;
        let rows: Vec<Vec<f64>> = hit
            .samples()
            .rows()
            .into_iter()
            .map(|row| row.iter().map(|strain| 1e6 * strain).collect())
            .collect();
        write_npy(&folder.join(format!("gauges_{number:02}.npy")), &rows);
    }
}

/// A long rod of masses, springs and parallel dashpots, struck at one end and integrated explicitly
/// in time, with strains at two sections.
///
/// Its modulus is E + iωη. With masses at a distance dx the relative error of E is (k dx)²/12: 5e-4
/// at 8 kHz.
pub(crate) struct LongRod {
    pub(crate) length: f64,
    pub(crate) stiffness: f64,
    pub(crate) viscosity: f64,
    pub(crate) density: f64,
}

/// Sampling rate of the records of a [`LongRod`].
pub(crate) const FAST_RATE_HZ: f64 = 200e3;

impl LongRod {
    /// Writes `count` hits to files `pulses_N.npy` [µε], 5 ms long with 1 ms of silence, with
    /// noise.
    pub(crate) fn write_pulses(&self, folder: &Path, sections: [f64; 2], count: usize, seed: u64) {
        let dx = 2.5e-3;
        let cells = (self.length / dx).round() as usize;
        let dt = 5e-7;
        let every = (1.0 / (FAST_RATE_HZ * dt)).round() as usize;
        let (lead, n_samples) = (200, 1000);
        let mut displacement = vec![0.0; cells + 1];
        let mut velocity = vec![0.0; cells + 1];
        let mut stress = vec![0.0; cells];
        let mut rows = [vec![0.0; lead], vec![0.0; lead]];
        let gauges = sections.map(|x| (x / dx).round() as usize);
        // stress on the struck end, up to 0.5 MPa during 100 µs
        let blow = |t: f64| {
            let phase = TAU * t / 1e-4;
            if t < 1e-4 {
                0.25e6 * (1.0 - phase.cos())
            } else {
                0.0
            }
        };
        for step in 0..(n_samples - lead) * every {
            if step % every == 0 {
                for (row, gauge) in rows.iter_mut().zip(gauges) {
                    // the strain at a mass is the mean of those of the springs on both sides
                    let strain = displacement[gauge + 1] - displacement[gauge - 1];
                    row.push(1e6 * strain / (2.0 * dx));
                }
            }
            for cell in 0..cells {
                let strain = displacement[cell + 1] - displacement[cell];
                let rate = velocity[cell + 1] - velocity[cell];
                stress[cell] = (self.stiffness * strain + self.viscosity * rate) / dx;
            }
            let inertia = self.density * dx;
            velocity[0] += dt * (stress[0] + blow(step as f64 * dt)) / (0.5 * inertia);
            for node in 1..cells {
                velocity[node] += dt * (stress[node] - stress[node - 1]) / inertia;
            }
            velocity[cells] -= dt * stress[cells - 1] / (0.5 * inertia);
            for (u, v) in displacement.iter_mut().zip(&velocity) {
                *u += dt * v;
            }
        }
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        for number in 1..=count {
            let noisy: Vec<Vec<f64>> = rows
                .iter()
                .map(|row| {
                    let noise = |strain: &f64| strain + 0.1 * (random.random::<f64>() - 0.5);
                    row.iter().map(noise).collect()
                })
                .collect();
            write_npy(&folder.join(format!("pulses_{number:02}.npy")), &noisy);
        }
    }
}
