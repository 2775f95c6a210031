//! Waves at the faces of the specimen from the records of the gauges.

use std::ops::Range;

use num_complex::Complex64;
use rodwave::fourier::RealFourier;

use super::bar::HopkinsonBar;
use super::noise::{QuietNoise, first_disturbed};
use super::plan::{Plan, WaveSeparation};
use super::record::HopkinsonRecord;
use super::source::Setup;
use crate::ImpulseError;

/// Propagation, stiffness and velocity of a bar on each line of a plan.
#[derive(Debug, Clone)]
pub(super) struct BarLines {
    /// Propagation coefficient [1/m].
    gamma: Vec<Complex64>,
    /// Force, or torque, per strain.
    pub(super) stiffness: Vec<Complex64>,
    /// Velocity of the face, or angular velocity, per strain.
    pub(super) speed: Vec<Complex64>,
}

impl BarLines {
    /// Computes propagation, stiffness and velocity of `bar` on each line of `plan`. In `torsion`,
    /// force is the torque, velocity the angular velocity, and strain the shear strain at the
    /// surface.
    pub(super) fn of(bar: &HopkinsonBar, plan: &Plan, torsion: bool) -> Result<Self, ImpulseError> {
        let radius = 0.5 * bar.diameter.value;
        let area = std::f64::consts::PI * radius * radius;
        // the torque is M = G J/R times the strain at the surface, with J/R = A R/2
        let (section, per_velocity) = if torsion {
            (0.5 * area * radius, 1.0 / radius)
        } else {
            (area, 1.0)
        };
        let density = bar.material.density();
        let mut lines = Self {
            gamma: Vec::with_capacity(plan.weight.len()),
            stiffness: Vec::with_capacity(plan.weight.len()),
            speed: Vec::with_capacity(plan.weight.len()),
        };
        for line in 0..plan.weight.len() {
            let (gamma, speed) = if line == 0 {
                // line 0 represents the frequencies up to halfway to the next line
                let omega = 0.5 * plan.omega(1);
                let speed = Complex64::new(0.0, omega) / bar.propagation(omega)?;
                (Complex64::ZERO, Complex64::from((speed * speed).re.sqrt()))
            } else {
                let omega = plan.omega(line);
                let gamma = bar.propagation(omega)?;
                (gamma, Complex64::new(0.0, omega) / gamma)
            };
            lines.gamma.push(gamma);
            lines.stiffness.push(section * density * speed * speed);
            lines.speed.push(speed * per_velocity);
        }
        Ok(lines)
    }

    fn carried(&self, line: usize, distance: f64) -> Complex64 {
        let gamma = self.gamma.get(line).copied().unwrap_or_default();
        (-gamma * distance).exp()
    }

    /// Returns $`\sum_{n=0}^{N} e^{-2n\gamma d}`$ on a line.
    fn passages(&self, line: usize, distance: f64, terms: usize) -> Complex64 {
        let once = self.carried(line, 2.0 * distance);
        (0..terms).fold(Complex64::ONE, |sum, _| 1.0 + once * sum)
    }
}

/// Strain waves at a face, on the lines of a plan, in its band.
#[derive(Debug, Clone, Default)]
pub(super) struct FaceWaves {
    /// Along x.
    pub(super) along: Vec<Complex64>,
    /// Against x.
    pub(super) against: Vec<Complex64>,
}

/// Spectra of records.
pub(super) struct Spectra<'a> {
    pub(super) plan: &'a Plan,
    pub(super) setup: &'a Setup,
    pub(super) record: &'a HopkinsonRecord,
    pub(super) transform: RealFourier,
}

impl Spectra<'_> {
    /// Returns the spectrum of a part of the record of a gauge, in strain, without its level at
    /// rest.
    fn of(&mut self, bar: usize, gauge: usize, from: usize, to: usize) -> Vec<Complex64> {
        self.of_both(bar, gauge, from..to, (0..0, 0.0))
    }

    /// Returns the spectrum of the samples `cut` with a constant strain added to the samples
    /// `added`.
    fn of_both(
        &mut self,
        bar: usize,
        gauge: usize,
        cut: Range<usize>,
        (added, strain): (Range<usize>, f64),
    ) -> Vec<Complex64> {
        let samples = self
            .record
            .gauges
            .get(bar)
            .and_then(|gauges| gauges.get(gauge))
            .map_or(&[][..], Vec::as_slice);
        let rest = samples.get(..self.record.silent).unwrap_or(samples);
        let level = rest.iter().sum::<f64>() / rest.len().max(1) as f64;
        let (gain, delay) = self.setup.of_gauge(bar, gauge);
        self.transform.samples().fill(0.0);
        let input = self.transform.samples().iter_mut().zip(samples);
        for (sample, x) in input.take(cut.end).skip(cut.start) {
            *sample = gain * (x - level);
        }
        if let Some(samples) = self.transform.samples().get_mut(added) {
            samples.iter_mut().for_each(|sample| *sample += strain);
        }
        let plan = self.plan;
        let lines = self.transform.forward().iter().zip(&plan.weight);
        lines
            .enumerate()
            .map(|(k, (line, weight))| *weight * line * Complex64::cis(plan.omega(k) * delay))
            .collect()
    }

    /// Removes the part of the sums of passages after the end of the record, where the next
    /// reflections are missing.
    fn end_with_record(&mut self, lines: &mut [Complex64]) {
        self.transform.lines().fill(Complex64::ZERO);
        for (to, from) in self.transform.lines().iter_mut().zip(lines.iter()) {
            *to = *from;
        }
        let scale = 1.0 / self.plan.n_transform as f64;
        let samples = self.transform.inverse().iter_mut().enumerate();
        for (at, sample) in samples {
            *sample *= if at < self.plan.n_samples { scale } else { 0.0 };
        }
        for (to, from) in lines.iter_mut().zip(self.transform.forward().iter()) {
            *to = *from;
        }
    }

    fn whole(&mut self, bar: usize, gauge: usize) -> Vec<Complex64> {
        let n = self.plan.n_samples;
        self.of(bar, gauge, 0, n)
    }

    /// Distances of the gauges of a bar from its face.
    fn distances(&self, bar: usize) -> Vec<f64> {
        let bar = self.setup.bars.get(bar);
        let gauges = bar.map_or(&[][..], |bar| bar.gauges.as_slice());
        gauges.iter().map(|gauge| gauge.distance.value).collect()
    }

    pub(super) fn transmitted(&mut self, separation: WaveSeparation, bar: &BarLines) -> FaceWaves {
        let distances = self.distances(1);
        let near = distances.first().copied().unwrap_or(0.0);
        let terms = self.plan.terms[1];
        match separation {
            WaveSeparation::TwoGauges => self.two_gauges(1, bar),
            WaveSeparation::FreeEnd => {
                let length = self.setup.bars[1].length.value;
                let behind = length - near;
                let strain = self.whole(1, 0);
                let mut along: Vec<Complex64> = strain
                    .iter()
                    .enumerate()
                    .map(|(line, strain)| strain * bar.passages(line, behind, terms))
                    .collect();
                self.end_with_record(&mut along);
                // without a passage within the record no reflection returns
                let returns = if terms == 0 { 0.0 } else { -1.0 };
                let mut waves = FaceWaves::default();
                for (line, along) in along.iter().enumerate() {
                    let back = returns * along * bar.carried(line, 2.0 * behind);
                    waves.along.push(along * bar.carried(line, -near));
                    waves.against.push(back * bar.carried(line, near));
                }
                waves
            }
            WaveSeparation::Windows | WaveSeparation::Balanced => {
                let window = self.plan.windows[2].clone();
                let strain = self.of(1, 0, window.start, window.end);
                let at_face = strain.iter().enumerate();
                FaceWaves {
                    along: at_face
                        .map(|(line, strain)| strain * bar.carried(line, -near))
                        .collect(),
                    against: vec![Complex64::ZERO; strain.len()],
                }
            }
        }
    }

    /// Computes the waves at the face of the incident bar. The `force` of the other face is used if
    /// the two forces are assumed equal.
    pub(super) fn incident(
        &mut self,
        separation: WaveSeparation,
        bar: &BarLines,
        force: &[Complex64],
    ) -> FaceWaves {
        let distances = self.distances(0);
        let near = distances.first().copied().unwrap_or(0.0);
        let terms = self.plan.terms[0];
        match separation {
            WaveSeparation::TwoGauges => self.two_gauges(0, bar),
            WaveSeparation::Balanced => {
                let strain = self.whole(0, 0);
                let mut waves = FaceWaves::default();
                for (line, (strain, force)) in strain.iter().zip(force).enumerate() {
                    let stiffness = bar.stiffness.get(line).copied().unwrap_or(Complex64::ONE);
                    let both = force / stiffness;
                    let once = bar.carried(line, near);
                    let along = (strain - both * once) * once * bar.passages(line, near, terms);
                    waves.along.push(along);
                    waves.against.push(both - along);
                }
                waves
            }
            WaveSeparation::Windows | WaveSeparation::FreeEnd => {
                let [first, second, _] = self.plan.windows.clone();
                let (tail, level) = (self.setup.tail, self.setup.level);
                let incident = self.of_both(0, 0, first, (second.clone(), tail));
                let reflected = self.of_both(0, 0, second.clone(), (second, -level));
                let carried = |waves: &[Complex64], distance: f64| -> Vec<Complex64> {
                    let lines = waves.iter().enumerate();
                    lines
                        .map(|(line, wave)| wave * bar.carried(line, distance))
                        .collect()
                };
                FaceWaves {
                    along: carried(&incident, near),
                    against: carried(&reflected, -near),
                }
            }
        }
    }

    /// Returns the two gauges of a bar in the order along x, each with its x from the face; `None`
    /// for another number of gauges.
    fn along_x(&self, bar: usize) -> Option<[(usize, f64); 2]> {
        let distances = self.distances(bar);
        let [one, other] = distances.as_slice() else {
            return None;
        };
        let sign = if bar == 0 { -1.0 } else { 1.0 };
        let (one, other) = ((0, sign * one), (1, sign * other));
        Some(if one.1 < other.1 {
            [one, other]
        } else {
            [other, one]
        })
    }

    /// Returns the strain at the second of two gauges along x, as expected from the first gauge for
    /// waves along x alone, and the recorded strain minus the expected one, which is
    /// $`N_b(1 - e^{-2\gamma d})`$.
    pub(super) fn one_way(&mut self, bar: usize, lines: &BarLines) -> Option<[Vec<Complex64>; 2]> {
        let [(a, x_a), (b, x_b)] = self.along_x(bar)?;
        let (first, second) = (self.whole(bar, a), self.whole(bar, b));
        let carried = first.iter().enumerate();
        let expected: Vec<Complex64> = carried
            .map(|(line, first)| first * lines.carried(line, x_b - x_a))
            .collect();
        let rest = second.iter().zip(&expected).map(|(b, e)| b - e).collect();
        Some([expected, rest])
    }

    /// Computes the waves from two gauges. With the strain $`\varepsilon_a`$ of the first gauge
    /// along x and $`\varepsilon_b`$ at a distance $`d`$ after it,
    /// $`P_a(1 - e^{-2\gamma d}) = \varepsilon_a - \varepsilon_b e^{-\gamma d}`$ and
    /// $`N_b(1 - e^{-2\gamma d}) = \varepsilon_b - \varepsilon_a e^{-\gamma d}`$.
    fn two_gauges(&mut self, bar: usize, lines: &BarLines) -> FaceWaves {
        let Some([(a, x_a), (b, x_b)]) = self.along_x(bar) else {
            return FaceWaves::default();
        };
        let apart = x_b - x_a;
        let terms = self.plan.terms.get(bar).copied().unwrap_or(0);
        let (first, second) = (self.whole(bar, a), self.whole(bar, b));
        let mut waves = FaceWaves::default();
        for (line, (first, second)) in first.iter().zip(&second).enumerate() {
            let across = lines.carried(line, apart);
            let sum = lines.passages(line, apart, terms);
            let along = (first - second * across) * sum;
            let against = (second - first * across) * sum;
            waves.along.push(along * lines.carried(line, -x_a));
            waves.against.push(against * lines.carried(line, x_b));
        }
        waves
    }
}

/// Returns level and noise of each gauge, after a check that there is no pulse in the silence.
pub(super) fn noises(record: &HopkinsonRecord) -> Result<[Vec<QuietNoise>; 2], ImpulseError> {
    let of = |gauges: &Vec<Vec<f64>>, bar: &'static str| {
        let noise = |samples: &Vec<f64>| match first_disturbed(samples, record.silent) {
            Some(at) => Err(ImpulseError::SilenceEnds {
                bar,
                found: at as f64 / record.rate_hz,
                stated: record.silent as f64 / record.rate_hz,
            }),
            None => QuietNoise::before_pulse(samples, record.silent),
        };
        gauges.iter().map(noise).collect::<Result<Vec<_>, _>>()
    };
    let [first, second] = &record.gauges;
    Ok([of(first, "incident bar")?, of(second, "transmitted bar")?])
}
