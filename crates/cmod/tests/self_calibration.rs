//! Errors of sensors determined from the lines, for records whose sensors are wrong by known
//! amounts.

use std::f64::consts::TAU;

use cmod::causal::CausalEstimate;
use cmod::estimate::{ErrorSource, ModulusLine};
use cmod::multi_point::GaugeMethod;
use cmod::section_ratio::{RatioError, RatioLines, RatioMethod};
use cmod::self_calibration::SelfCalibration;
use cmod::two_point::SpecimenUncertainty;
use cmod::validity::AcceptanceLimits;
use cmod::{
    GaugeSpectra, GaugeUncertainty, GaugedRod, ModulusEstimate, MultiPoint, Specimen, ThreePoint,
    TwoPoint,
};
use num_complex::Complex64;
use rodwave::modulus::{ComplexModulus, ConstantQ, FractionalZener};

use testbed::noise::Noise;

pub(crate) const GAIN: f64 = 0.014;
pub(crate) const DELAY: f64 = 3e-6;

/// Simulated waves have no lateral inertia.
pub(crate) const WIDE: AcceptanceLimits = AcceptanceLimits {
    storage_modulus: 0.5,
    loss_factor: 1.0,
    ..AcceptanceLimits::ONE_DIMENSIONAL
};

/// Rod between two accelerometers, with its modulus and the uncertainties of the rod and its ends.
#[derive(Clone, Copy)]
pub(crate) struct Rod {
    pub(crate) specimen: Specimen,
    pub(crate) uncertainty: SpecimenUncertainty,
    pub(crate) modulus: fn(f64) -> Complex64,
    pub(crate) step_hz: f64,
    pub(crate) highest_hz: f64,
    /// Noise of each end, relative to the amplitude of the free end.
    pub(crate) noise: f64,
}

fn constant_loss(modulus: f64, loss_factor: f64, frequency_hz: f64, omega: f64) -> Complex64 {
    let law = ConstantQ::new(modulus, loss_factor, TAU * frequency_hz);
    law.unwrap().at(omega)
}

const EXACT: SpecimenUncertainty = SpecimenUncertainty {
    length: 0.0,
    diameter: 0.0,
    density: 0.0,
    accelerometer_mass: 0.0,
};

/// Rod with a loss factor of 0.07, from the power law of constant loss.
pub(crate) const STIFF: Rod = Rod {
    specimen: Specimen {
        length: 0.8,
        diameter: 0.016,
        density: 912.0,
        accelerometer_mass: 2.9e-3,
    },
    uncertainty: EXACT,
    modulus: |omega| constant_loss(2.6e9, 0.07, 1600.0, omega),
    step_hz: 16.0,
    highest_hz: 15e3,
    noise: 2e-4,
};

/// Rod with loss factors near 1: little more than one wave, with little information on the sensors.
pub(crate) const SOFT: Rod = Rod {
    specimen: Specimen {
        length: 0.2,
        diameter: 0.025,
        density: 1120.0,
        accelerometer_mass: 1.5e-3,
    },
    uncertainty: EXACT,
    modulus: |omega| {
        FractionalZener::new(6e6, 1.2e9, 2e-6, 0.55)
            .unwrap()
            .at(omega)
    },
    step_hz: 8.0,
    highest_hz: 3e3,
    noise: 2e-4,
};

/// Rod with a loss factor of 0.025, and eight wavelengths at the highest line. There 1 % of the
/// density is a third of the width of a resonance.
pub(crate) const RINGING: Rod = Rod {
    specimen: Specimen {
        length: 1.5,
        diameter: 0.02,
        density: 1250.0,
        accelerometer_mass: 2.9e-3,
    },
    uncertainty: SpecimenUncertainty {
        length: 5e-4,
        diameter: 0.0,
        density: 12.5,
        accelerometer_mass: 0.0,
    },
    modulus: |omega| constant_loss(5.2e9, 0.025, 2000.0, omega),
    step_hz: 20.0 / 3.0,
    highest_hz: 12e3,
    noise: 2e-4,
};

impl Rod {
    /// Returns the rod with a specimen drawn within its uncertainty.
    pub(crate) fn drawn(&self, noise: &mut Noise) -> Self {
        let Specimen {
            length, density, ..
        } = self.specimen;
        Self {
            specimen: Specimen {
                length: length + self.uncertainty.length * noise.normal(),
                density: density + self.uncertainty.density * noise.normal(),
                ..self.specimen
            },
            ..*self
        }
    }

    /// Returns the ratio of the ends as the sensors measure it: too large by `gain`, and late by
    /// `delay`.
    pub(crate) fn record(&self, gain: f64, delay: f64, noise: &mut Noise) -> Record {
        let Specimen {
            length, density, ..
        } = self.specimen;
        let lines = 1..=(self.highest_hz / self.step_hz) as u32;
        let frequency_hz: Vec<f64> = lines.map(|line| self.step_hz * f64::from(line)).collect();
        let mut ratio = Vec::new();
        let mut variance = Vec::new();
        for f in &frequency_hz {
            let omega = TAU * f;
            let wave =
                Complex64::new(0.0, omega) * (density / (self.modulus)(omega)).sqrt() * length;
            let right = wave.cosh() + self.specimen.mass_ratio() * wave * wave.sinh();
            let read = right * gain.exp() * Complex64::new(0.0, -omega * delay).exp();
            let square = self.noise.powi(2) * (1.0 + read.norm_sqr());
            ratio.push(read + noise.circular(square));
            variance.push(square);
        }
        Record {
            frequency_hz,
            ratio,
            variance,
        }
    }

    /// Returns the errors of E' and E'' of a causal estimate divided by their standard errors, on
    /// every fifth of its lines.
    pub(crate) fn z_of_causal(&self, causal: &CausalEstimate) -> Vec<f64> {
        let lines = causal.lines().iter().step_by(5);
        lines
            .flat_map(|line| {
                let found = causal.at(line.frequency_hz).unwrap();
                let error = found.modulus - (self.modulus)(TAU * line.frequency_hz);
                let [[storage, _], [_, loss]] = found.covariance;
                [error.re / storage.sqrt(), error.im / loss.sqrt()]
            })
            .collect()
    }

    /// Returns the errors of E' and E'' divided by their standard errors, on every fifth valid
    /// line.
    fn z_of_modulus(&self, estimate: &ModulusEstimate) -> Vec<f64> {
        let lines = estimate.valid().step_by(5);
        lines
            .flat_map(|line| {
                let error = line.modulus - (self.modulus)(TAU * line.frequency_hz);
                let stated = line.standard_error;
                [
                    error.re / stated.storage_modulus,
                    error.im / stated.loss_modulus,
                ]
            })
            .collect()
    }
}

pub(crate) struct Record {
    frequency_hz: Vec<f64>,
    ratio: Vec<Complex64>,
    variance: Vec<f64>,
}

impl Record {
    fn lines<'a>(&'a self, common: &'a [RatioError]) -> RatioLines<'a> {
        RatioLines {
            common,
            ..RatioLines::of_known_variance(&self.frequency_hz, &self.ratio, &self.variance)
        }
    }

    /// Calls a function with the method of the rod and the lines, including the stated errors of
    /// the sensors.
    pub(crate) fn used<T>(
        &self,
        rod: &Rod,
        take: impl FnOnce(&TwoPoint, &RatioLines<'_>) -> T,
    ) -> T {
        let common = [
            RatioError::of_gain_ratio(&self.frequency_hz, GAIN).unwrap(),
            RatioError::of_delay(&self.frequency_hz, DELAY).unwrap(),
        ];
        let lines = self.lines(&common);
        let method = TwoPoint::new(rod.specimen)
            .and_then(|method| method.with_specimen_uncertainty(rod.uncertainty))
            .and_then(|method| method.with_limits(WIDE))
            .unwrap();
        take(&method, &lines)
    }

    pub(crate) fn calibrated(&self, rod: &Rod) -> SelfCalibration {
        self.used(rod, |method, lines| {
            SelfCalibration::of_ratio(method, lines).unwrap().unwrap()
        })
    }
}

pub(crate) fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|z| z * z).sum::<f64>() / values.len() as f64).sqrt()
}

pub(crate) fn within(values: &[f64], limit: f64) -> f64 {
    values.iter().filter(|z| z.abs() <= limit).count() as f64 / values.len() as f64
}

/// Checks the coverage of the sizes found and of the modulus, over records whose sensors are wrong
/// as stated.
#[test]
fn gain_ratio_and_delay_are_found_within_their_errors() {
    const RECORDS: u64 = 40;
    for (name, rod, [gain_error, delay_error]) in [
        ("stiff", STIFF, [0.0..0.02, 0.0..0.01]),
        ("soft", SOFT, [0.02..0.5, 0.02..0.6]),
        ("ringing", RINGING, [0.0..0.03, 0.0..0.01]),
    ] {
        let mut of_sizes = [Vec::new(), Vec::new()];
        let mut of_modulus = Vec::new();
        for seed in 0..RECORDS {
            let mut noise = Noise::seeded(300 + seed);
            let drawn = [noise.normal(), noise.normal()];
            let struck = rod.drawn(&mut noise);
            let record = struck.record(GAIN * drawn[0], DELAY * drawn[1], &mut noise);
            let found = record.calibrated(&rod);
            assert_eq!(found.sources()[0].source, ErrorSource::GainRatio);
            assert_eq!(found.sources()[1].source, ErrorSource::Delay);
            for (source, (drawn, z)) in found.sources().iter().zip(drawn.iter().zip(&mut of_sizes))
            {
                z.push((source.size - drawn) / source.standard_error);
            }
            assert!(
                gain_error.contains(&found.sources()[0].standard_error),
                "{name}"
            );
            assert!(
                delay_error.contains(&found.sources()[1].standard_error),
                "{name}"
            );
            of_modulus.extend(rod.z_of_modulus(found.estimate()));
        }
        for z in &of_sizes {
            let mean = z.iter().sum::<f64>() / z.len() as f64;
            // mean of 40 values; tolerance: four of its standard deviations
            assert!(mean.abs() < 0.64, "{name}: mean {mean}");
            let size = root_mean_square(z);
            assert!((0.55..1.45).contains(&size), "{name}: {size}");
        }
        // 68 and 95 % are expected; the errors of the lines of a record are correlated, so the
        // fractions scatter like those of 40 values
        let coverage = [within(&of_modulus, 1.0), within(&of_modulus, 1.96)];
        assert!((0.58..0.80).contains(&coverage[0]), "{name}: {coverage:?}");
        assert!((0.88..0.995).contains(&coverage[1]), "{name}: {coverage:?}");
    }
}

/// Errors of the loss factor of the same record are ten times as large if its sensors are not
/// calibrated.
#[test]
fn the_loss_factor_is_nearly_as_good_as_with_exact_sensors() {
    let record = STIFF.record(0.3 * GAIN, 0.3 * DELAY, &mut Noise::seeded(7));
    let growth = |estimate: &ModulusEstimate| {
        let of_line =
            |line: &ModulusLine| line.standard_error.loss_factor / line.random_error().loss_factor;
        let mut all: Vec<f64> = estimate.lines().iter().map(of_line).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let found = growth(record.calibrated(&STIFF).estimate());
    assert!(found < 1.1, "{found}");
    let common = [RatioError::of_delay(&record.frequency_hz, DELAY).unwrap()];
    let lines = record.lines(&common);
    let method = TwoPoint::new(STIFF.specimen).unwrap();
    let stated = growth(&method.estimate_ratio(&lines).unwrap());
    assert!(stated > 10.0, "{stated}");
}

/// With low losses, delays of some standard uncertainties make the number of waves uncertain on
/// every line.
#[test]
fn a_delay_that_hides_the_number_of_waves_is_found() {
    let rod = Rod {
        modulus: |omega| constant_loss(3e9, 0.02, 2000.0, omega),
        highest_hz: 18e3,
        ..STIFF
    };
    for size in [-2.2, 2.2] {
        let record = rod.record(0.0, size * DELAY, &mut Noise::seeded(5));
        let found = record.calibrated(&rod);
        let delay = found.sources()[1];
        assert!((delay.size - size).abs() < 0.1, "{delay:?}");
        assert!(2 * found.estimate().valid().count() > record.frequency_hz.len());
    }
}

/// Compares the shifts with an estimate from a ratio that is wrong by the same amount.
#[test]
fn an_error_of_a_ratio_moves_a_line_by_its_shift() {
    let record = STIFF.record(0.0, 0.0, &mut Noise::seeded(1));
    let method = TwoPoint::new(STIFF.specimen).unwrap();
    let common = [
        RatioError::of_gain_ratio(&record.frequency_hz, 1e-6).unwrap(),
        RatioError::of_delay(&record.frequency_hz, 1e-10).unwrap(),
    ];
    let lines = record.lines(&common);
    let right = method.estimate_ratio(&lines).unwrap();
    for error in &common {
        let pairs = record.ratio.iter().zip(error.relative());
        let ratio: Vec<Complex64> = pairs.map(|(ratio, error)| ratio * (1.0 + error)).collect();
        let wrong = method
            .estimate(&record.frequency_hz, &ratio, &record.variance)
            .unwrap();
        for (right, wrong) in right.lines().iter().zip(wrong.lines()) {
            let mut shifts = right.uncertainty.systematic.iter();
            let shift = shifts.find(|shift| shift.source == error.source()).unwrap();
            let moved = wrong.modulus - right.modulus;
            // tolerance: the second order, which is the shift times the amplified error
            assert!((moved - shift.modulus).norm() < 1e-3 * shift.modulus.norm());
        }
    }
}

/// Strains at gauges of a rod with a mass at each end, in tests with hits at either end.
struct Gauged {
    positions: Vec<f64>,
    noise: f64,
}

impl Gauged {
    /// Calibrates gauges whose positions are wrong by `off` \[m\], and whose measured values are
    /// too large by the factors e^`gains`.
    fn calibrated(
        &self,
        (off, gains): (&[f64], &[f64]),
        uncertainty: GaugeUncertainty,
        noise: &mut Noise,
    ) -> (SelfCalibration, CausalEstimate) {
        let frequency_hz: Vec<f64> = (20..=500).map(|line| 20.0 * f64::from(line)).collect();
        let gamma = |f: &f64| {
            let omega = TAU * f;
            Complex64::new(0.0, omega) * (919.0 / (STIFF.modulus)(omega)).sqrt()
        };
        let tests: Vec<Vec<Vec<Complex64>>> = (0..4)
            .map(|test| {
                let reflected = Complex64::from_polar(0.7, f64::from(test));
                (self.positions.iter().zip(off).zip(gains))
                    .map(|((x, off), gain)| {
                        let strain = |f: &f64| {
                            let x = x + off;
                            let waves =
                                (-gamma(f) * x).exp() + reflected * (gamma(f) * (x - 1.4)).exp();
                            waves * gain.exp() + noise.circular(self.noise.powi(2))
                        };
                        frequency_hz.iter().map(strain).collect()
                    })
                    .collect()
            })
            .collect();
        let tests: Vec<&[Vec<Complex64>]> = tests.iter().map(Vec::as_slice).collect();
        let spectra = GaugeSpectra {
            frequency_hz: &frequency_hz,
            tests: &tests,
            noise: &vec![vec![self.noise; frequency_hz.len()]; self.positions.len()],
        };
        let rod = GaugedRod {
            positions: self.positions.clone(),
            diameter: 0.01,
            density: 919.0,
        };
        if self.positions.len() == 3 {
            let method = ThreePoint::new(rod)
                .and_then(|method| method.with_limits(WIDE))
                .and_then(|method| method.with_uncertainty(uncertainty));
            both(&method.unwrap(), &spectra)
        } else {
            let method = MultiPoint::new(rod)
                .and_then(|method| method.with_limits(WIDE))
                .and_then(|method| method.with_uncertainty(uncertainty));
            both(&method.unwrap(), &spectra)
        }
    }
}

fn both(
    method: &impl GaugeMethod,
    spectra: &GaugeSpectra<'_>,
) -> (SelfCalibration, CausalEstimate) {
    let calibrated = SelfCalibration::of_gauges(method, spectra)
        .unwrap()
        .unwrap();
    (
        calibrated,
        CausalEstimate::of_gauges(method, spectra, None).unwrap(),
    )
}

/// Errors that are common to all gauges remain as uncertain as stated, and the modulus is covered.
#[test]
fn errors_of_gauges_are_found_within_their_errors() {
    const RECORDS: u64 = 20;
    for positions in [vec![0.3, 0.45, 0.6], vec![0.2, 0.31, 0.45, 0.52, 0.7]] {
        let n = positions.len();
        let gauged = Gauged {
            positions,
            noise: 1e-3,
        };
        let mut of_sizes = [Vec::new(), Vec::new()];
        let mut of_modulus = [Vec::new(), Vec::new()];
        for seed in 0..RECORDS {
            let mut noise = Noise::seeded(900 + seed);
            let drawn: Vec<f64> = (0..2 * n).map(|_| noise.normal()).collect();
            let off: Vec<f64> = drawn[..n].iter().map(|z| 0.5e-3 * z).collect();
            let gains: Vec<f64> = drawn[n..].iter().map(|z| 0.01 * z).collect();
            let uncertainty = GaugeUncertainty {
                positions: vec![0.5e-3; n],
                factors: vec![0.01; n],
                ..GaugeUncertainty::default()
            };
            let (found, causal) = gauged.calibrated((&off, &gains), uncertainty, &mut noise);
            for (z, sources) in of_sizes.iter_mut().zip([found.sources(), causal.sources()]) {
                let errors = sources.iter().zip(&drawn);
                z.extend(errors.map(|(own, drawn)| (own.size - drawn) / own.standard_error));
            }
            of_modulus[0].extend(STIFF.z_of_modulus(found.estimate()));
            of_modulus[1].extend(STIFF.z_of_causal(&causal));
        }
        for (of_sizes, of_modulus) in of_sizes.iter().zip(&of_modulus) {
            // wide tolerances: 120 sizes and 200 moduli, which are correlated within a record
            let size = root_mean_square(of_sizes);
            let coverage = [within(of_modulus, 1.0), within(of_modulus, 1.96)];
            assert!((0.75..1.3).contains(&size), "{n} gauges: {size}");
            assert!((0.55..0.82).contains(&coverage[0]), "{n}: {coverage:?}");
            assert!((0.87..0.998).contains(&coverage[1]), "{n}: {coverage:?}");
        }
    }
}

#[test]
fn errors_that_are_none_are_refused() {
    let text = |uncertainty: f64| {
        RatioError::of_delay(&[1.0, 2.0], uncertainty)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        text(-1e-6),
        "uncertainty of the delay [s] is -0.000001, expected a finite value, 0 or above"
    );
    let method = TwoPoint::new(STIFF.specimen).unwrap();
    let short = [RatioError::of_gain_ratio(&[1.0, 2.0], 0.01).unwrap()];
    let lines = RatioLines {
        common: &short,
        ..RatioLines::of_known_variance(&[1.0, 2.0, 3.0], &[Complex64::ONE; 3], &[1e-6; 3])
    };
    assert_eq!(
        method.estimate_ratio(&lines).unwrap_err().to_string(),
        "common error of the ratio has 2 lines, expected 3, one per frequency"
    );
    // without uncertain quantities there is nothing to calibrate
    let exact = RatioLines {
        common: &[],
        ..lines
    };
    assert!(
        SelfCalibration::of_ratio(&method, &exact)
            .unwrap()
            .is_none()
    );
}

/// A rod of aluminium with a loss factor of 0.003, which is hidden in noise on every line. Noise
/// makes the loss factor of some lines five times as large as its error; these lines must become
/// invalid by the comparison with their neighbours.
#[test]
fn a_loss_factor_that_is_only_noise_is_not_valid() {
    let rod = Rod {
        specimen: Specimen {
            length: 1.5,
            diameter: 0.02,
            density: 2700.0,
            accelerometer_mass: 2.9e-3,
        },
        uncertainty: EXACT,
        modulus: |_| 70e9 * Complex64::new(1.0, 0.003),
        step_hz: 1.25,
        highest_hz: 10e3,
        noise: 4e-3,
    };
    let (mut by_chance, mut left) = (0, 0);
    for seed in 0..6 {
        let record = rod.record(0.0, 0.0, &mut Noise::seeded(seed));
        let estimate = record.used(&rod, |method, lines| method.estimate_ratio(lines).unwrap());
        let high = |line: &&ModulusLine| line.loss_factor > 1.5 * 0.003;
        by_chance += estimate.valid().filter(high).count();
        let judged = estimate.judged_by_neighbours().unwrap();
        left += judged.valid().filter(high).count();
    }
    // some of these lines remain valid, because the mean of their sixteen neighbours has noise too
    assert!(
        by_chance >= 100 && left * 10 < by_chance,
        "{left} of {by_chance}"
    );
    // if the loss factor is well determined, all lines remain valid
    let record = STIFF.record(0.0, 0.0, &mut Noise::seeded(3));
    let estimate = record.used(&STIFF, |method, lines| {
        method.estimate_ratio(lines).unwrap()
    });
    let judged = estimate.judged_by_neighbours().unwrap();
    let (before, after) = (estimate.valid().count(), judged.valid().count());
    assert!(
        after * 100 >= before * 99 && before > 500,
        "{after} of {before}"
    );
}
