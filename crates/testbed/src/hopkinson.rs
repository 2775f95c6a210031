//! A shot on split Hopkinson bars, computed in the order of an experiment: force on the incident
//! bar, waves in bars and specimen, gauges with errors, averaging recorder, noise, converter.
//!
//! The waves are computed along characteristics in time, without transforms and propagation
//! coefficients.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "places in histories of some thousand samples"
)]

use std::error::Error;

use rodwave::RodwaveError;
use rodwave::line::{Body, Drive, End, Gauge, Ledger, Line, Segment};
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};

use crate::noise::Noise;

/// Bars of one material, with their gauges and the pulse.
#[derive(Debug, Clone)]
pub struct HopkinsonRig {
    /// Law of the bars \[Pa\].
    pub law: GeneralisedMaxwell,
    /// Density [kg/m³].
    pub density: f64,
    /// Diameter \[m\].
    pub diameter: f64,
    /// Lengths of the incident and the transmitted bar \[m\].
    pub lengths: [f64; 2],
    /// Distances of the gauges of each bar from the specimen \[m\].
    pub gauges: [Vec<f64>; 2],
    /// Rise, duration and fall \[s\] of the force on the incident bar, whose largest value is
    /// `force` \[N\], positive in compression.
    pub pulse: [f64; 3],
    pub force: f64,
    /// Longest time step \[s\].
    pub step: f64,
    /// Times before and after the start of the pulse \[s\].
    pub before: f64,
    pub after: f64,
}

/// Exact histories of a shot, with samples `step` \[s\] apart from the start of the pulse on.
#[derive(Debug, Clone)]
pub struct HopkinsonTruth {
    pub step: f64,
    /// Strain, positive in tension, of each gauge of each bar.
    pub gauges: [Vec<Vec<f64>>; 2],
    /// Forces at the two faces of the specimen \[N\], positive in compression.
    pub force: [Vec<f64>; 2],
    /// Velocities of the two faces of the specimen [m/s].
    pub velocity: [Vec<f64>; 2],
    /// Time before the pulse \[s\].
    pub before: f64,
    pub ledger: Ledger,
}

/// Errors of gauges and recorder.
#[derive(Debug, Clone)]
pub struct RecorderErrors {
    /// Factor of each gauge of each bar.
    pub gains: [Vec<f64>; 2],
    /// Delay of the channels of each bar \[s\].
    pub delays: [f64; 2],
    /// Standard deviation of the noise in strain.
    pub noise: f64,
    /// Step of the converter in strain, 0 for none.
    pub converter_step: f64,
}

impl HopkinsonRig {
    /// Creates bars of a polyamide with a loss factor of about 4 % at 5 to 20 kHz.
    pub fn nylon() -> Result<Self, RodwaveError> {
        let branch = |modulus: f64, relaxation_time: f64| MaxwellBranch {
            modulus,
            relaxation_time,
        };
        Ok(Self {
            law: GeneralisedMaxwell::new(2.6e9, vec![branch(0.2e9, 8e-6), branch(0.2e9, 60e-6)])?,
            density: 1150.0,
            diameter: 0.02,
            lengths: [1.8, 1.6],
            gauges: [vec![0.7], vec![0.3]],
            pulse: [80e-6, 350e-6, 80e-6],
            force: 4.5e3,
            step: 0.25e-6,
            before: 300e-6,
            after: 2.2e-3,
        })
    }

    fn area(&self) -> f64 {
        0.25 * std::f64::consts::PI * self.diameter * self.diameter
    }

    /// Computes a shot, with or without a specimen between the bars.
    pub fn shot(&self, specimen: Option<Segment>) -> Result<HopkinsonTruth, Box<dyn Error>> {
        let area = self.area();
        let bar = |length: f64| Segment::prony(length, area, self.density, &self.law);
        let [first, second] = self.lengths;
        let between = specimen.as_ref().map_or(0.0, Segment::length);
        let segments = [Some(bar(first)?), specimen, Some(bar(second)?)];
        let body = Body::new(segments.into_iter().flatten())?;
        let ([rise, duration, fall], peak) = (self.pulse, self.force);
        let force = move |t: f64| {
            // each edge is half a period of a cosine
            let edge = |part: f64| 0.5 - 0.5 * (std::f64::consts::PI * part.clamp(0.0, 1.0)).cos();
            peak * edge(t / rise).min(edge((duration - t) / fall))
        };
        let line = Line::new([body])?
            .with_left_end(End::Force(Drive::of(force)))?
            .with_speed_tolerance(2e-4)?;
        // gauges at the faces, 1 um inside the bars
        let inside = 1e-6;
        let mut places: Vec<f64> = self.gauges[0].iter().map(|d| first - d).collect();
        places.extend(self.gauges[1].iter().map(|d| first + between + d));
        places.extend([first - inside, first + between + inside]);
        let gauges: Vec<Gauge> = places
            .into_iter()
            .map(|position| Gauge { body: 0, position })
            .collect();
        let history = line.run(self.step, self.after, &gauges)?;
        let n_first = self.gauges[0].len();
        let n_gauges = n_first + self.gauges[1].len();
        let mut sections = history.gauges.into_iter();
        let near: Vec<Vec<f64>> = sections.by_ref().take(n_first).map(|s| s.strain).collect();
        let far = sections.by_ref().take(n_gauges - n_first);
        let far: Vec<Vec<f64>> = far.map(|s| s.strain).collect();
        let mut face = || -> Result<(Vec<f64>, Vec<f64>), Box<dyn Error>> {
            let section = sections.next().ok_or("a face is missing")?;
            let force = section.stress.iter().map(|s| -s * area).collect();
            Ok((force, section.velocity))
        };
        let ((f1, v1), (f2, v2)) = (face()?, face()?);
        Ok(HopkinsonTruth {
            step: history.grid.time_step,
            gauges: [near, far],
            force: [f1, f2],
            velocity: [v1, v2],
            before: self.before,
            ledger: history.ledger,
        })
    }
}

impl HopkinsonTruth {
    /// Returns the samples of all gauges at `rate` \[Hz\]. Each sample is a mean over the two
    /// sampling intervals around it, with triangular weights.
    pub fn recorded(&self, rate: f64, errors: &RecorderErrors, seed: u64) -> [Vec<Vec<f64>>; 2] {
        let mut noise = Noise::seeded(seed);
        let mut out = [Vec::new(), Vec::new()];
        let bars = out
            .iter_mut()
            .zip(&self.gauges)
            .zip(errors.gains.iter().zip(errors.delays));
        for ((out, gauges), (gains, delay)) in bars {
            for (gauge, gain) in gauges.iter().zip(gains) {
                let n = ((self.before + self.step * gauge.len() as f64) * rate).floor();
                let samples = (0..n as usize - 2).map(|index| {
                    let time = index as f64 / rate - self.before - delay;
                    let value =
                        gain * self.mean(gauge, time, 1.0 / rate) + errors.noise * noise.normal();
                    if errors.converter_step > 0.0 {
                        (value / errors.converter_step).round() * errors.converter_step
                    } else {
                        value
                    }
                });
                out.push(samples.collect());
            }
        }
        out
    }

    /// Returns the sample of an exact history that the recorder takes at a `time` \[s\] from the
    /// start of the record, without errors.
    pub fn seen(&self, history: &[f64], rate: f64, time: f64) -> f64 {
        self.mean(history, time - self.before, 1.0 / rate)
    }

    /// Returns the engineering strain of a specimen of the given length \[m\], positive in
    /// compression.
    pub fn strain(&self, length: f64) -> Vec<f64> {
        let mut sum = 0.0;
        let pairs = self.velocity[0].iter().zip(&self.velocity[1]);
        pairs
            .map(|(a, b)| {
                sum += self.step * (a - b) / length;
                sum
            })
            .collect()
    }

    fn mean(&self, history: &[f64], time: f64, reach: f64) -> f64 {
        let (mut sum, mut weights) = (0.0, 0.0);
        let n = (reach / self.step).ceil() as i64 + 1;
        let middle = (time / self.step).round() as i64;
        for index in middle - n..=middle + n {
            let weight = (1.0 - (index as f64 * self.step - time).abs() / reach).max(0.0);
            let at = usize::try_from(index).ok();
            let value = at.and_then(|at| history.get(at)).copied().unwrap_or(0.0);
            sum += weight * value;
            weights += weight;
        }
        sum / weights
    }
}
