//! Two or more gauges before a free end, and records that end while the bar still vibrates.

use std::f64::consts::TAU;
use std::ops::Range;

use cmod::estimate::{ErrorSource, Refusal};
use cmod::multi_point::Quantity;
use cmod::self_calibration::SelfCalibration;
use cmod::{
    CmodError, GaugeSpectra, GaugeUncertainty, GaugedRod, ModulusEstimate, MultiPoint,
    MultiPointEstimate,
};
use num_complex::Complex64;
use testbed::claim::{Claims, Within};
use testbed::hold;
use testbed::long_bar::LongBar;

use crate::self_calibration::WIDE;

/// Number of samples before the hit.
const SILENT: usize = 225;

fn rod(positions: &[f64]) -> GaugedRod {
    GaugedRod {
        positions: positions.to_vec(),
        diameter: 0.02,
        density: 1190.0,
    }
}

/// Returns E of the glassy bar on the axis s = iω.
fn exact(frequency_hz: f64) -> Complex64 {
    (LongBar::glassy().modulus)(Complex64::new(0.0, TAU * frequency_hz))
}

/// Returns the largest relative error over the valid lines, and checks that there are at least
/// `least` of them.
fn largest_error(estimate: &ModulusEstimate, least: usize) -> f64 {
    assert!(
        estimate.valid().count() >= least,
        "{}",
        estimate.valid().count()
    );
    let errors = estimate.valid().map(|line| {
        let exact = exact(line.frequency_hz);
        (line.modulus - exact).norm() / exact.norm()
    });
    errors.fold(0.0, f64::max)
}

/// Returns the waves on the line s before a mass [kg] on the end at 2.5 m, of strain or of
/// displacement; factors common to the gauges are omitted. The force of the mass is m s² times its
/// displacement. The waves are the sum of the waves before a free end and before a fixed end, in
/// the ratio of this force to the impedance.
fn waves(
    mass: f64,
    positions: &[f64],
    frequency_hz: &[f64],
    damping: f64,
    quantity: Quantity,
) -> Vec<Vec<Complex64>> {
    let area = 0.25 * std::f64::consts::PI * 0.02 * 0.02;
    let at = |x: &f64| {
        let value = |f: &f64| {
            let s = Complex64::new(damping, TAU * f);
            let modulus = (LongBar::glassy().modulus)(s);
            let gamma = s * (1190.0 / modulus).sqrt();
            let way = gamma * (2.5 - x);
            let held = mass * s * s / (area * modulus * gamma);
            if quantity == Quantity::Strain {
                way.sinh() + held * way.cosh()
            } else {
                way.cosh() + held * way.sinh()
            }
        };
        frequency_hz.iter().map(value).collect()
    };
    positions.iter().map(at).collect()
}

/// Evaluates one test with the same noise on all lines of all gauges.
fn estimated(
    method: Result<MultiPoint, CmodError>,
    frequency_hz: &[f64],
    spectra: &[Vec<Complex64>],
    noise: f64,
) -> MultiPointEstimate {
    let spectra = GaugeSpectra {
        frequency_hz,
        tests: &[spectra],
        noise: &vec![vec![noise; frequency_hz.len()]; spectra.len()],
    };
    method.unwrap().estimate(&spectra).unwrap()
}

#[test]
fn lines_before_a_free_end_give_the_modulus() {
    let mut claims = Claims::default();
    exact_lines(&mut claims);
    added_damping(&mut claims);
    hold!(claims);
}

fn exact_lines(claims: &mut Claims) {
    let frequency_hz: Vec<f64> = (5..250).map(|j| 50.0 * f64::from(j)).collect();
    for (what, positions, mass, quantity) in [
        (
            "two strain gauges and a free end: |dE|/|E|",
            &[1.6, 2.0][..],
            0.0,
            Quantity::Strain,
        ),
        (
            "two sensors of motion and a free end: |dE|/|E|",
            &[1.6, 2.0],
            0.0,
            Quantity::Velocity,
        ),
        (
            "four strain gauges and a free end: |dE|/|E|",
            &[1.0, 1.3, 1.7, 2.0],
            0.0,
            Quantity::Strain,
        ),
        (
            "two strain gauges and 60 g on the end: |dE|/|E|",
            &[1.6, 2.0],
            0.06,
            Quantity::Strain,
        ),
        (
            "two sensors of motion and 60 g on the end: |dE|/|E|",
            &[1.6, 2.0],
            0.06,
            Quantity::Velocity,
        ),
    ] {
        let spectra = waves(mass, positions, &frequency_hz, 0.0, quantity);
        let method = MultiPoint::before_free_end(rod(positions), 2.5)
            .and_then(|method| method.with_end_mass(mass))
            .map(|method| method.with_quantity(quantity));
        // the noise level determines the weights of lines and marks those near singular ones
        let estimate = estimated(method, &frequency_hz, &spectra, 1e-7);
        claims.by("sinh γd₁/sinh γd₂, cosh γd₁/cosh γd₂").claim(
            what,
            "1",
            0.0,
            Within(
                3e-13,
                "rounding, amplified a thousandfold by the weight of the condition at the end",
            ),
            Ok(largest_error(estimate.modulus(), 100)),
        );
    }
}

/// Without noise, the continuation from E(s) to E(iω) depends only on the smooth modulus; the law
/// is the same for σ of 0, 300 and 1500 per second.
fn added_damping(claims: &mut Claims) {
    let frequency_hz: Vec<f64> = (10..300).map(|j| 50.0 * f64::from(j)).collect();
    for (what, damping, within) in [
        ("σ = 300 1/s, 0.5 to 15 kHz: |dE|/|E|", 300.0, 2e-6),
        ("σ = 1500 1/s, 0.5 to 15 kHz: |dE|/|E|", 1500.0, 2e-5),
    ] {
        let spectra = waves(0.0, &[1.6, 2.0], &frequency_hz, damping, Quantity::Strain);
        let method = MultiPoint::before_free_end(rod(&[1.6, 2.0]), 2.5)
            .and_then(|method| method.with_limits(WIDE))
            .and_then(|method| method.with_added_damping(damping));
        let estimate = estimated(method, &frequency_hz, &spectra, 1e-6);
        // without the continuation the loss factor is 0.0127 σ/ω too small, 0.006 at 500 Hz
        claims.by("E(s) of constant loss").claim(
            what,
            "1",
            0.0,
            Within(
                within,
                "residual effect of the prior of the smooth modulus at its lower end",
            ),
            Ok(largest_error(estimate.modulus(), 200)),
        );
    }
}

/// Spectra of a shot on the line s. They begin at the end of the silence before the wave, which
/// gives the noise.
pub(super) struct Shot {
    pub(super) frequency_hz: Vec<f64>,
    pub(super) spectra: Vec<Vec<Complex64>>,
    pub(super) noise: Vec<Vec<f64>>,
}

impl Shot {
    /// Transforms the histories `rows` of a bar, which are silent for `n_silent` samples.
    pub(super) fn of(
        bar: &LongBar,
        rows: &[Vec<f64>],
        n_silent: usize,
        lines: Range<u32>,
        damping: f64,
    ) -> Self {
        let duration = (bar.n_samples - n_silent) as f64 / bar.rate;
        let frequency_hz: Vec<f64> = lines.map(|line| f64::from(line) / duration).collect();
        let transform = |row: &Vec<f64>, f: &f64| -> Complex64 {
            let turn = (-Complex64::new(damping, TAU * f) / bar.rate).exp();
            // Horner's rule
            let samples = row[n_silent..].iter().rev();
            samples.fold(Complex64::ZERO, |sum, x| sum * turn + x) / bar.rate
        };
        let spectra = rows
            .iter()
            .map(|row| frequency_hz.iter().map(|f| transform(row, f)).collect());
        let amplitude = |row: &Vec<f64>| {
            let silence = &row[..n_silent];
            let power = silence.iter().map(|x| x * x).sum::<f64>() / silence.len() as f64;
            (power / bar.rate / (2.0 * damping)).sqrt()
        };
        Self {
            spectra: spectra.collect(),
            noise: rows
                .iter()
                .map(|row| vec![amplitude(row); frequency_hz.len()])
                .collect(),
            frequency_hz,
        }
    }

    /// Calibrates with a standard uncertainty of the density [kg/m³].
    fn calibrated(&self, factor: f64, damping: f64, density: f64) -> SelfCalibration {
        let method = MultiPoint::before_free_end(rod(&[1.6, 2.0]), 2.5)
            .and_then(|method| method.with_limits(WIDE))
            .and_then(|method| method.with_added_damping(damping))
            .and_then(|method| {
                method.with_uncertainty(GaugeUncertainty {
                    factors: vec![0.0, factor],
                    density,
                    ..GaugeUncertainty::default()
                })
            })
            .unwrap();
        let spectra = GaugeSpectra {
            frequency_hz: &self.frequency_hz,
            tests: &[&self.spectra],
            noise: &self.noise,
        };
        SelfCalibration::of_gauges(&method, &spectra)
            .unwrap()
            .unwrap()
    }
}

/// Evaluates one shot on a bar that still vibrates at the end of its record, with 14 bits and the
/// second gauge calibrated to 3 %.
#[test]
fn one_shot_on_a_ringing_bar_is_covered() {
    let bar = LongBar::glassy();
    let damping = 1100.0;
    let (mut within, mut gains) = ([[0.0; 2]; 2], Vec::new());
    let mut count = 0.0;
    for seed in 0..40 {
        let gain = 0.03 * (f64::from(seed) / 13.0 - 1.5);
        let shot = Shot::of(
            &bar,
            &bar.shot(&[1.0, 1.0 + gain], u64::from(seed as u32)),
            SILENT,
            5..110,
            damping,
        );
        let found = shot.calibrated(0.03, damping, 0.0);
        let of_gain = found.sources()[0];
        assert_eq!(of_gain.source, ErrorSource::GaugeFactor(1));
        gains.push((0.03 * of_gain.size - gain.ln_1p()) / (0.03 * of_gain.standard_error));
        for line in found.estimate().valid() {
            let exact = exact(line.frequency_hz);
            let storage = (line.modulus.re - exact.re) / line.standard_error.storage_modulus;
            let loss = (line.loss_factor - exact.im / exact.re) / line.standard_error.loss_factor;
            for (of_quantity, z) in within.iter_mut().zip([storage, loss]) {
                of_quantity[0] += f64::from(z.abs() <= 1.0);
                of_quantity[1] += f64::from(z.abs() <= 1.96);
            }
            count += 1.0;
        }
    }
    assert!(count > 2500.0, "{count} lines");
    // tolerance: three standard deviations, 2.7 % and 1.3 % for 300 independent values, because
    // some 12 neighbouring lines of each of the 40 shots share their noise; at the lower end of the
    // band the stated errors are too large
    for [one, two] in within {
        assert!((0.60..0.80).contains(&(one / count)), "{}", one / count);
        assert!((0.91..0.99).contains(&(two / count)), "{}", two / count);
    }
    let outside = gains.iter().filter(|z: &&f64| z.abs() > 1.96).count();
    assert!(outside <= 6, "{gains:?}");
}

/// No record determines the density: its uncertainty increases the error and does not change the
/// modulus.
#[test]
fn uncertain_density_does_not_move_the_modulus() {
    let damping = 1100.0;
    let bar = LongBar::glassy();
    let shot = Shot::of(&bar, &bar.shot(&[1.0, 1.02], 3), SILENT, 5..110, damping);
    let exact = shot.calibrated(0.03, damping, 0.0);
    let uncertain = shot.calibrated(0.03, damping, 35.0);
    let mut sources = uncertain.sources().iter();
    let density = sources
        .find(|of| of.source == ErrorSource::Density)
        .unwrap();
    assert!(
        density.size.abs() < 0.01 && density.standard_error > 0.999,
        "{density:?}"
    );
    let pairs = exact
        .estimate()
        .lines()
        .iter()
        .zip(uncertain.estimate().lines());
    let mut n_lines = 0;
    for (exact, uncertain) in pairs.filter(|(exact, _)| exact.validity.is_valid()) {
        let off = (uncertain.modulus - exact.modulus).norm() / exact.modulus.norm();
        // the limit is far below the effect of an error of 3 % of the density
        assert!(off < 1e-3, "{} Hz: {off:e}", exact.frequency_hz);
        n_lines += 1;
    }
    assert!(n_lines > 30, "{n_lines}");
}

/// An error of the mass on the end, of the diameter or of the density changes the modulus by the
/// stated shift; for the mass this is so even if the stated mass is 0.
#[test]
fn errors_of_an_end_mass_are_those_of_the_changed_rod() {
    use ErrorSource::{AccelerometerMass, Density, Diameter};
    errors_are_those_of_the_changed_rod(0.06, &[AccelerometerMass, Diameter, Density]);
    errors_are_those_of_the_changed_rod(0.0, &[AccelerometerMass, Density]);
}

fn errors_are_those_of_the_changed_rod(mass: f64, sources: &[ErrorSource]) {
    let frequency_hz: Vec<f64> = (20..120).map(|j| 50.0 * f64::from(j)).collect();
    let spectra = waves(mass, &[1.6, 2.0], &frequency_hz, 0.0, Quantity::Strain);
    let relative = 1e-5;
    let estimate = |of_mass: f64, of_diameter: f64, of_density: f64| {
        let mut rod = rod(&[1.6, 2.0]);
        let uncertainty = GaugeUncertainty {
            end_mass: relative * 0.06,
            diameter: relative * rod.diameter,
            density: relative * rod.density,
            ..GaugeUncertainty::default()
        };
        rod.diameter *= 1.0 + of_diameter;
        rod.density *= 1.0 + of_density;
        let method = MultiPoint::before_free_end(rod, 2.5)
            .and_then(|method| method.with_end_mass(mass + 0.06 * of_mass))
            .and_then(|method| method.with_uncertainty(uncertainty));
        let estimate = estimated(method, &frequency_hz, &spectra, 1e-7);
        estimate.modulus().clone()
    };
    let stated = estimate(0.0, 0.0, 0.0);
    for source in sources {
        let changed = match source {
            ErrorSource::AccelerometerMass => estimate(relative, 0.0, 0.0),
            ErrorSource::Diameter => estimate(0.0, relative, 0.0),
            _ => estimate(0.0, 0.0, relative),
        };
        let mut compared = 0;
        for line in stated.valid() {
            let mut shifts = line.uncertainty.systematic.iter();
            let shift = shifts.find(|shift| shift.source == *source).unwrap();
            let index = line.index;
            let Some(other) = changed.lines().iter().find(|other| other.index == index) else {
                continue;
            };
            let found = other.modulus - line.modulus;
            // tolerance: the second order in 1e-5, amplified some hundred times near singular lines
            assert!(
                (found - shift.modulus).norm() < 3e-3 * found.norm() + 1e-10 * line.modulus.norm(),
                "{source:?} {} Hz: {found} {}",
                line.frequency_hz,
                shift.modulus
            );
            compared += 1;
        }
        assert!(compared > 50, "{compared}");
    }
}

#[test]
fn bars_that_cannot_be_evaluated_are_refused() {
    let text = |positions: &[f64], end| {
        MultiPoint::before_free_end(rod(positions), end)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        text(&[1.6], 2.5),
        "1 gauges, expected 2 or more before a free end"
    );
    assert_eq!(
        text(&[1.6, 2.0], 1.8),
        "position of the free end [m] is 1.8, expected one beyond the last gauge: positions increase towards the free end"
    );
    assert!(matches!(
        MultiPoint::before_free_end(rod(&[1.6, 2.0]), 2.5)
            .unwrap()
            .with_added_damping(-1.0),
        Err(CmodError::NonPhysical { .. })
    ));
    let three = MultiPoint::new(rod(&[1.0, 1.6, 2.0])).unwrap();
    for refused in [
        three.clone().with_end_mass(0.01),
        three.with_uncertainty(GaugeUncertainty {
            end_mass: 1e-4,
            ..GaugeUncertainty::default()
        }),
    ] {
        let text = refused.unwrap_err().to_string();
        assert!(text.ends_with("expected 0: no free end is used"), "{text}");
    }
    // six lines do not determine the variation of the modulus
    let frequency_hz: Vec<f64> = (20..26).map(|j| 50.0 * f64::from(j)).collect();
    let spectra = waves(0.0, &[1.6, 2.0], &frequency_hz, 500.0, Quantity::Strain);
    let method = MultiPoint::before_free_end(rod(&[1.6, 2.0]), 2.5)
        .and_then(|method| method.with_added_damping(500.0))
        .and_then(|method| method.with_wave_speed(1400.0));
    let estimate = estimated(method, &frequency_hz, &spectra, 1e-6);
    let refused = estimate.modulus().refused();
    assert_eq!(refused.len(), 6);
    assert!(
        refused
            .iter()
            .all(|line| line.reason == Refusal::NotContinued)
    );
    assert!(estimate.fits().is_empty() && estimate.waves(0, 0, 1.8, Quantity::Strain).is_none());
}
