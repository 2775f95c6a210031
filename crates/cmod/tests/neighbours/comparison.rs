//! All methods on one virtual rod, in the manner of figure 3 of paper A, which compares two
//! methods.
//!
//! A rod of polypropylene with accelerometers on both ends and strain gauges between them is struck
//! ten times. Every method gets the records that it would get in a laboratory, with white noise in
//! each. The histories are exact transforms of a chain of impedances, and pulses are cut out of
//! them with rectangular windows.

use std::f64::consts::TAU;
use std::ops::Range;

use cmod::multi_point::{GaugeSpectra, GaugedRod, Quantity};
use cmod::validity::AcceptanceLimits;
use cmod::{
    EndSection, FreeEnd, ModulusEstimate, ModulusLine, MultiPoint, OneGauge, PulsedRod,
    RatioOfSpectra, Resonances, SeparatePulses, Specimen, ThreePoint, TwoPoint,
};
use labio::noise_of_cut_pulse;
use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::{Pulse, RaisedCosine};
use rodwave::synthesis::DampedSynthesis;
use testbed::difference::largest;

use super::rod::{DENSITY, DIAMETER, LENGTH, lines, polypropylene, with_end_mass};
use testbed::noise::Noise;

const ACCELEROMETER: f64 = 2.9e-3;
const INTERVAL: f64 = 4e-6;
/// Duration of a record; within it the first mode decays by e^{-13}.
const DURATION: f64 = 60e-3;
const SAMPLES: usize = 15_000;
const HITS: usize = 10;
/// Standard deviation of the noise, relative to the peak of each channel.
const NOISE: f64 = 1e-3;
/// Distances of the strain gauges from the free end [m].
const GAUGES: [f64; 4] = [0.70, 0.50, 0.35, 0.25];

/// Records of all hits in one channel.
struct Channel {
    hits: Vec<Vec<f64>>,
    deviation: f64,
}

/// Spectra of the hits, with the root mean square of their noise.
struct Spectra {
    hits: Vec<Vec<Complex64>>,
    noise: Vec<f64>,
}

impl Channel {
    fn noisy(clean: &[f64], random: &mut Noise) -> Self {
        let deviation = NOISE * largest(clean.iter().copied());
        let mut hit = || {
            clean
                .iter()
                .map(|value| value + deviation * random.normal())
                .collect()
        };
        Self {
            hits: (0..HITS).map(|_| hit()).collect(),
            deviation,
        }
    }

    /// Returns the spectra of the samples of a window.
    fn spectra(&self, frequency_hz: &[f64], range: Range<usize>) -> Spectra {
        let of_hit = |hit: &Vec<f64>| {
            let at = |f: &f64| {
                let turn = Complex64::from_polar(1.0, -TAU * f * INTERVAL);
                let start =
                    Complex64::from_polar(INTERVAL, -TAU * f * INTERVAL * range.start as f64);
                hit[range.clone()]
                    .iter()
                    .fold((Complex64::ZERO, start), |(sum, phase), value| {
                        (sum + value * phase, phase * turn)
                    })
                    .0
            };
            frequency_hz.iter().map(at).collect()
        };
        let noise = self.deviation * INTERVAL * (range.len() as f64).sqrt();
        Spectra {
            hits: self.hits.iter().map(of_hit).collect(),
            noise: vec![noise; frequency_hz.len()],
        }
    }

    /// Returns the spectra of a pulse in a window; the part that is cut off is included in the
    /// noise.
    fn pulse(&self, frequency_hz: &[f64], window: Range<usize>) -> Spectra {
        let edge = |middle: usize| {
            let around = self
                .hits
                .iter()
                .flat_map(|hit| &hit[middle - 5..middle + 5]);
            around.sum::<f64>() / (10 * HITS) as f64
        };
        let edges = [window.start, window.end];
        let whole = self.spectra(frequency_hz, window);
        // The truncation is the same in all hits and is not reduced by averaging, so one mean
        // spectrum is used from here on.
        let mean =
            |line: usize| whole.hits.iter().map(|hit| hit[line]).sum::<Complex64>() / HITS as f64;
        // there is no truncation at the beginning of the record
        let edges = edges.map(|sample| if sample > 0 { edge(sample) } else { 0.0 });
        let noise = whole.noise[0] / (HITS as f64).sqrt();
        Spectra {
            hits: vec![(0..frequency_hz.len()).map(mean).collect()],
            noise: noise_of_cut_pulse(noise, edges, frequency_hz).unwrap(),
        }
    }
}

fn ratio(numerator: &Spectra, denominator: &Spectra) -> RatioOfSpectra {
    RatioOfSpectra::new(
        &numerator.hits.iter().map(Vec::as_slice).collect::<Vec<_>>(),
        &denominator
            .hits
            .iter()
            .map(Vec::as_slice)
            .collect::<Vec<_>>(),
        &numerator.noise,
        &denominator.noise,
    )
    .unwrap()
}

/// Returns the accelerations of the struck and the free end, and the strains.
fn histories() -> ([Vec<f64>; 2], Vec<Vec<f64>>) {
    let medium = polypropylene();
    let section = Circle::of_diameter(DIAMETER).unwrap();
    let chain = AnalyticChain::analytic_from_impact_face()
        .mass(ACCELEROMETER)
        .rod(&medium, section, LENGTH)
        .end(Termination::Mass(ACCELEROMETER))
        .unwrap();
    let blow = RaisedCosine::new(100.0, 1e-4).unwrap();
    let synthesis = DampedSynthesis::new(DURATION, INTERVAL).unwrap();
    let history = |transform: &dyn Fn(Complex64) -> Complex64| {
        let lines: Vec<Complex64> = synthesis
            .arguments()
            .map(|s| transform(s) * blow.transform(s))
            .collect();
        synthesis.history(&lines).unwrap().samples
    };
    let accelerations = [0.0, LENGTH].map(|x| {
        let section = chain.section(1, x).unwrap();
        history(&|s| s * section.state_at_s(s).unwrap().velocity)
    });
    let area = 0.25 * std::f64::consts::PI * DIAMETER * DIAMETER;
    let strains = GAUGES
        .iter()
        .map(|distance| {
            let section = chain.section(1, LENGTH - distance).unwrap();
            history(&|s| {
                let slowness = medium.propagation_coefficient_at_s(s) / s;
                section.state_at_s(s).unwrap().normal_force * slowness * slowness / (DENSITY * area)
            })
        })
        .collect();
    (accelerations, strains)
}

/// Returns the root mean square of the errors of E' and E'' of the valid lines, divided by the
/// stated errors.
fn deviations(name: &str, least_count: usize, estimate: &ModulusEstimate) -> (f64, f64) {
    let medium = polypropylene();
    let valid: Vec<&ModulusLine> = estimate.valid().collect();
    assert!(valid.len() >= least_count, "{name}: {}", valid.len());
    let deviations: Vec<f64> = valid
        .iter()
        .flat_map(|line| {
            let error = line.modulus - medium.modulus(TAU * line.frequency_hz);
            let stated = line.standard_error;
            [
                error.re / stated.storage_modulus,
                error.im / stated.loss_modulus,
            ]
        })
        .collect();
    // a normal variable exceeds this limit with a probability of 1e-5
    let largest = largest(deviations.iter().copied());
    assert!(largest < 4.4, "{name}: {largest}");
    let n = deviations.len() as f64;
    (
        (deviations.iter().map(|z| z * z).sum::<f64>() / n).sqrt(),
        n,
    )
}

fn assert_within_stated_errors(name: &str, least_count: usize, estimate: &ModulusEstimate) {
    let (root_mean_square, n) = deviations(name, least_count, estimate);
    // tolerance: four standard deviations of the root mean square of n independent values
    assert!(
        (root_mean_square - 1.0).abs() < 4.0 / (2.0 * n).sqrt(),
        "{name}: {root_mean_square}"
    );
}

/// Checks estimates from pulses that are cut out. The error due to the cut has the stated size, but
/// its phase turns slowly with frequency: the root mean square over few turns may differ from 1.
fn assert_not_beyond_stated_errors(name: &str, least_count: usize, estimate: &ModulusEstimate) {
    let (root_mean_square, _) = deviations(name, least_count, estimate);
    assert!(
        (0.3..1.5).contains(&root_mean_square),
        "{name}: {root_mean_square}"
    );
}

#[test]
fn all_methods_agree_on_one_rod_within_their_stated_errors() {
    let (accelerations, strains) = histories();
    let mut random = Noise::seeded(1993);
    let [struck, free] = accelerations.map(|history| Channel::noisy(&history, &mut random));
    let gauges: Vec<Channel> = strains
        .iter()
        .map(|history| Channel::noisy(history, &mut random))
        .collect();
    let frequency_hz = lines(80, 100.0);
    let whole = || 0..SAMPLES;
    let rod = with_end_mass(ACCELEROMETER);
    let strain = |gauge: usize| EndSection {
        distance: GAUGES[gauge],
        quantity: Quantity::Strain,
    };
    let all: Vec<Spectra> = gauges
        .iter()
        .map(|gauge| gauge.spectra(&frequency_hz, whole()))
        .collect();
    let ends = [&struck, &free].map(|end| end.spectra(&frequency_hz, whole()));

    let limits = AcceptanceLimits::NONE;

    let psi = ratio(&ends[0], &ends[1]);
    let specimen = Specimen {
        length: LENGTH,
        diameter: DIAMETER,
        density: DENSITY,
        accelerometer_mass: ACCELEROMETER,
    };
    let estimate = TwoPoint::new(specimen)
        .and_then(|method| method.with_limits(limits))
        .and_then(|method| method.estimate(&frequency_hz, &psi.ratio, &psi.variance));
    assert_within_stated_errors("two-point", 60, &estimate.unwrap());

    // two gauges, and one gauge with the free end, for pulses that overlap
    let end = EndSection {
        distance: 0.0,
        quantity: Quantity::Acceleration,
    };
    for (name, psi, [first, second]) in [
        ("free end", ratio(&all[1], &all[3]), [strain(1), strain(3)]),
        ("gauge and end", ratio(&all[2], &ends[1]), [strain(2), end]),
    ] {
        let estimate = FreeEnd::new(rod, first, second)
            .and_then(|method| method.with_limits(limits))
            .and_then(|method| method.estimate(&frequency_hz, &psi.ratio, &psi.variance));
        assert_within_stated_errors(name, 60, &estimate.unwrap());
    }

    // The wave reaches the gauge 0.35 m from the end after 0.26 ms, returns after 0.67 ms and again
    // after 1.2 ms; at 20 kHz it is 6 % faster. The windows contain one period or more above 2 kHz.
    let high_hz: Vec<f64> = frequency_hz.iter().copied().filter(|f| *f >= 2e3).collect();
    let incident = gauges[2].pulse(&high_hz, 0..150);
    let reflected = gauges[2].pulse(&high_hz, 150..275);
    let psi = ratio(&reflected, &incident);
    let estimate = OneGauge::new(rod, strain(2))
        .and_then(|method| method.with_limits(limits))
        .and_then(|method| method.with_wave_speed(1700.0))
        .and_then(|method| method.estimate(&high_hz, &psi.ratio, &psi.variance));
    assert_not_beyond_stated_errors("one gauge", 50, &estimate.unwrap());

    let first = gauges[0].pulse(&high_hz, 0..200);
    let psi = ratio(&incident, &first);
    let pulsed = PulsedRod {
        distance: GAUGES[0] - GAUGES[2],
        diameter: DIAMETER,
        density: DENSITY,
    };
    let estimate = SeparatePulses::new(pulsed)
        .and_then(|method| method.with_limits(limits))
        .and_then(|method| method.with_wave_speed(1700.0))
        .and_then(|method| method.estimate(&high_hz, &psi.ratio, &psi.variance));
    assert_not_beyond_stated_errors("pulses", 50, &estimate.unwrap());

    let positions = |which: &[usize]| GaugedRod {
        positions: which.iter().map(|gauge| LENGTH - GAUGES[*gauge]).collect(),
        diameter: DIAMETER,
        density: DENSITY,
    };
    for (name, which, least) in [
        ("several gauges", &[0, 1, 2, 3][..], 50),
        ("three gauges", &[0, 1, 3], 40),
    ] {
        let of_hit = |hit: usize| -> Vec<Vec<Complex64>> {
            which
                .iter()
                .map(|gauge| all[*gauge].hits[hit].clone())
                .collect()
        };
        let tests: Vec<_> = (0..HITS).map(of_hit).collect();
        let noise: Vec<_> = which
            .iter()
            .map(|gauge| all[*gauge].noise.clone())
            .collect();
        let spectra = GaugeSpectra {
            frequency_hz: &frequency_hz,
            tests: &tests.iter().map(Vec::as_slice).collect::<Vec<_>>(),
            noise: &noise,
        };
        let estimate = MultiPoint::new(positions(which))
            .and_then(|method| method.with_limits(limits))
            .and_then(|method| method.estimate(&spectra));
        assert_within_stated_errors(name, least, estimate.unwrap().modulus());
    }
    assert!(ThreePoint::new(positions(&[0, 1, 3])).is_err());

    let dense = lines(350, 10.0);
    let [struck, free] = [&struck, &free].map(|end| end.spectra(&dense, whole()));
    let psi = ratio(&struck, &free);
    let estimate = Resonances::new(rod, LENGTH)
        .and_then(|method| method.with_limits(limits))
        .and_then(|method| method.estimate(&dense, &psi.ratio, &psi.variance));
    assert_within_stated_errors("resonances", 3, &estimate.unwrap());
}
