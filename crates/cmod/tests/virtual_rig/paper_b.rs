//! Structures I and II of paper B: strains of a bar between two cantilever beams, without and with
//! a lump.

use std::f64::consts::TAU;

use cmod::estimate::coverage_factor;
use cmod::validity::AcceptanceLimits;
use cmod::{GaugeSpectra, GaugedRod, ModulusEstimate, ModulusLine, MultiPoint, ThreePoint};
use labio::{Quantity, Window};
use num_complex::Complex64;
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::RaisedCosine;
use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use rodwave::synthesis::DampedSynthesis;

use super::blows;
use super::coverage::Coverage;
use crate::materials;
use testbed::recorder::{OVERSAMPLING, RATE_HZ, Recorder, after_rest, name};

const SEEDS: u64 = 200;
const N_SAMPLES: usize = 4096;
/// Number of samples before the hit. A quarter of the record before the hit and a quarter at its
/// end are tapered: the waves have decayed by then, and the slow motion of the bar on its beams,
/// which has not decayed, ends without a step.
const LEAD: usize = 1024;
const WINDOW: Window = Window::TukeyPeriodic { taper: 0.5 };
/// Index of the first line. The lines are from 496 Hz to 8 kHz, 64 Hz apart: neighbours within the
/// main lobe of the window are omitted.
const FIRST_LINE: usize = 31;
const STEP: usize = 4;
const COUNT: usize = 118;

/// Three equidistant gauges and five others on the bar of 800 mm [m].
const POSITIONS: [f64; 7] = [0.2, 0.25, 0.27, 0.4, 0.45, 0.55, 0.6];
const THREE: [usize; 3] = [1, 3, 5];
const FIVE: [usize; 5] = [0, 2, 3, 4, 6];

fn polypropylene() -> Medium<ConstantQ> {
    materials::polypropylene(919.0)
}

fn rod(gauges: &[usize]) -> GaugedRod {
    GaugedRod {
        positions: gauges.iter().map(|&gauge| POSITIONS[gauge]).collect(),
        diameter: 0.016,
        density: 919.0,
    }
}

/// Bar with its gauges, and the measured noise of the gauges.
struct Structure {
    recorder: Recorder,
    frequency_hz: Vec<f64>,
    noise: Vec<f64>,
}

impl Structure {
    /// Creates structure I, or structure II with a `lump` [kg].
    fn new(lump: f64) -> Self {
        let beam = EndSupport::PAPER_B_BEAM;
        let section = Circle::of_diameter(0.016).unwrap();
        let right = beam.with_lump(lump).analytic_termination();
        let member = FrameMember::analytic(&polypropylene(), section, 0.8, &POSITIONS, right)
            .unwrap()
            .with_analytic_left_structure(beam.analytic_termination())
            .unwrap();
        let interval = 1.0 / (RATE_HZ * OVERSAMPLING as f64);
        let duration = ((N_SAMPLES - LEAD) * OVERSAMPLING) as f64 * interval;
        let synthesis = DampedSynthesis::new(duration, interval)
            .unwrap()
            .smoothed(2.5 * interval)
            .unwrap();
        let blow = RaisedCosine::new(50.0, 8e-5).unwrap();
        let exact = member
            .record(&Excitation::Force(&blow), &synthesis)
            .unwrap();
        let strains = exact.strains.iter();
        let histories: Vec<_> = strains
            .map(|strain| after_rest(strain, LEAD, N_SAMPLES))
            .collect();
        let recorder = Recorder::new(&histories, Quantity::Strain, 14, WINDOW).unwrap();
        let silence = recorder.blows(1.0, 32, u64::MAX, |_| 0.0).unwrap();
        let silence = recorder.averaged(&silence).unwrap();
        let frequency_hz = thinned(silence.frequency_hz());
        // the noise is white, so the mean over 118 lines of 32 records gives it to 1 %
        let noise = (0..POSITIONS.len())
            .map(|gauge| {
                let power = thinned(&silence.auto(&name(gauge)).unwrap());
                (power.iter().sum::<f64>() / power.len() as f64).sqrt()
            })
            .collect();
        Self {
            recorder,
            frequency_hz,
            noise,
        }
    }

    /// Returns the spectra (n_hits)(n_gauges)(n_lines) of test `seed`, each hit multiplied by the
    /// phase of its first gauge.
    fn spectra(&self, seed: u64) -> Vec<Vec<Vec<Complex64>>> {
        let of_blow = |record| {
            let spectra = self.recorder.averaged(&[record]).unwrap();
            let power = thinned(&spectra.auto(&name(0)).unwrap());
            let of_gauge = |gauge| {
                let cross = thinned(&spectra.cross(&name(0), &name(gauge)).unwrap());
                let lines = cross.iter().zip(&power);
                lines.map(|(cross, power)| cross / power.sqrt()).collect()
            };
            (0..POSITIONS.len()).map(of_gauge).collect()
        };
        blows(&self.recorder, seed)
            .into_iter()
            .map(of_blow)
            .collect()
    }

    /// Returns the estimates from three gauges in closed form and from five gauges.
    fn estimates(&self, seed: u64) -> [ModulusEstimate; 2] {
        let spectra = self.spectra(seed);
        let estimate = |gauges: &[usize], method: &dyn Fn(&GaugeSpectra<'_>) -> ModulusEstimate| {
            let of_blow = |blow: &Vec<Vec<Complex64>>| -> Vec<Vec<Complex64>> {
                gauges.iter().map(|&gauge| blow[gauge].clone()).collect()
            };
            let tests: Vec<_> = spectra.iter().map(of_blow).collect();
            let tests: Vec<&[Vec<Complex64>]> = tests.iter().map(Vec::as_slice).collect();
            let of_gauge = |&gauge: &usize| vec![self.noise[gauge]; COUNT];
            method(&GaugeSpectra {
                frequency_hz: &self.frequency_hz,
                tests: &tests,
                noise: &gauges.iter().map(of_gauge).collect::<Vec<_>>(),
            })
        };
        // the waves of the rig have no lateral inertia
        let limits = AcceptanceLimits::ONE_DIMENSIONAL;
        let three = ThreePoint::new(rod(&THREE)).unwrap();
        let three = three.with_limits(limits).unwrap();
        let five = MultiPoint::new(rod(&FIVE)).unwrap();
        let five = five.with_limits(limits).unwrap();
        [
            estimate(&THREE, &|spectra| three.estimate(spectra).unwrap()),
            estimate(&FIVE, &|spectra| {
                five.estimate(spectra).unwrap().modulus().clone()
            }),
        ]
    }
}

fn thinned<T: Copy>(lines: &[T]) -> Vec<T> {
    let chosen = lines.iter().skip(FIRST_LINE).step_by(STEP).take(COUNT);
    chosen.copied().collect()
}

fn factors() -> [f64; 2] {
    [0.683, 0.95].map(|probability| coverage_factor(probability, None).unwrap())
}

/// Structures of paper B, figures 3 and 4. In both, on every valid line E' must be within 1 % and
/// the loss factor within 5 %, and the stated errors must cover the truth. The two estimates must
/// differ by no more than their errors, although the ends of the bar differ.
#[test]
fn structures_i_and_ii() {
    // the paper gives no mass of the lump
    let structures = [Structure::new(0.0), Structure::new(0.1)];
    let coverage = || [Coverage::default(), Coverage::default()];
    let (mut of_structures, mut of_difference) = ([coverage(), coverage()], coverage());
    for seed in 0..SEEDS {
        // the noise is independent in the two structures
        let [first, second] = [0, 1].map(|lump| structures[lump].estimates(2 * seed + lump as u64));
        for (estimates, coverage) in [&first, &second].into_iter().zip(&mut of_structures) {
            for (estimate, coverage) in estimates.iter().zip(coverage) {
                for line in estimate.valid() {
                    let exact = polypropylene().modulus(TAU * line.frequency_hz);
                    coverage.add_with(line, exact, factors());
                }
            }
        }
        for ((first, second), coverage) in first.iter().zip(&second).zip(&mut of_difference) {
            for line in first.valid() {
                let same = |other: &&ModulusLine| other.index == line.index;
                let Some(other) = second.valid().find(same) else {
                    continue;
                };
                let (one, two) = (&line.standard_error, &other.standard_error);
                let stated = [
                    one.storage_modulus.hypot(two.storage_modulus),
                    one.loss_modulus.hypot(two.loss_modulus),
                ];
                coverage.add_error(line.modulus - other.modulus, stated, factors());
            }
        }
    }
    let methods = ["three gauges", "five gauges"];
    for (coverage, structure) in of_structures.iter().zip(["I", "II"]) {
        for (coverage, method) in coverage.iter().zip(methods) {
            let name = format!("structure {structure}, {method}");
            coverage.check_errors(&name);
            coverage.check(&name);
        }
    }
    for (coverage, method) in of_difference.iter().zip(methods) {
        let name = format!("difference of the structures, {method}");
        coverage.check(&name);
    }
}
