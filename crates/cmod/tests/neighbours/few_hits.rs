//! Ratios with variances of few degrees of freedom, and pulses in short records.

use std::f64::consts::TAU;

use cmod::estimate::{ModulusEstimate, VarianceFreedom};
use cmod::multi_point::Quantity;
use cmod::section_ratio::{RatioLines, RatioMethod};
use cmod::{
    EndSection, FreeEnd, GaugeSpectra, GaugedRod, MultiPoint, OneGauge, PulsedRod, Resonances,
    SeparatePulses, Specimen, ThreePoint, TwoPoint,
};
use num_complex::Complex64;

use super::rod::{DENSITY, DIAMETER, lines, polypropylene, with_end_mass};

const PULSED: PulsedRod = PulsedRod {
    distance: 0.4,
    diameter: DIAMETER,
    density: DENSITY,
};

fn gamma(frequency_hz: f64) -> Complex64 {
    polypropylene().propagation_coefficient(TAU * frequency_hz)
}

/// Returns the estimate from a ratio with a relative error of 0.1 % on every line, with four
/// degrees of freedom or with a known variance.
fn estimate(
    frequency_hz: &[f64],
    ratio: impl Fn(Complex64) -> Complex64,
    method: &dyn RatioMethod,
) -> [ModulusEstimate; 2] {
    let ratio: Vec<Complex64> = frequency_hz.iter().map(|f| ratio(gamma(*f))).collect();
    let variance: Vec<f64> = ratio.iter().map(|psi| 1e-6 * psi.norm_sqr()).collect();
    let freedom = vec![VarianceFreedom::of_averages(3.0).unwrap(); ratio.len()];
    let known = RatioLines::of_known_variance(frequency_hz, &ratio, &variance);
    let few = RatioLines {
        freedom: Some(&freedom),
        ..known
    };
    [few, known].map(|lines| method.estimate_ratio(&lines).unwrap())
}

/// The errors are those of the known variance, and their degrees of freedom are stated. The factor
/// of five standard errors becomes forty, so fewer lines are valid.
fn assert_freedom([few, known]: &[ModulusEstimate; 2], expected: f64, method: &str) {
    assert!(known.lines().len() >= 3, "{method}");
    for (line, certain) in few.lines().iter().zip(known.lines()) {
        let freedom = line.uncertainty.degrees_of_freedom.unwrap();
        assert!(
            (freedom / expected - 1.0).abs() < 1e-9,
            "{method}: {freedom}"
        );
        assert!(certain.uncertainty.degrees_of_freedom.is_none());
        let (a, b) = (line.modulus, certain.modulus);
        assert!((a - b).norm() < 1e-3 * b.norm(), "{method}");
        let factor = line.uncertainty.coverage_factor(0.95).unwrap();
        assert!(factor > certain.uncertainty.coverage_factor(0.95).unwrap());
    }
    assert!(few.valid().count() < known.valid().count(), "{method}");
}

#[test]
fn r14_every_method_of_a_ratio_carries_degrees_of_freedom() {
    let strain = |distance| EndSection {
        distance,
        quantity: Quantity::Strain,
    };
    let frequency_hz = lines(300, 30.0);
    let rod = with_end_mass(0.0);
    let free_end = FreeEnd::new(rod, strain(0.5), strain(0.25)).unwrap();
    let found = estimate(
        &frequency_hz,
        |gamma| 2.0 * (0.25 * gamma).cosh(),
        &free_end,
    );
    assert_freedom(&found, 4.0, "free end");
    let pulses = SeparatePulses::new(PULSED).unwrap();
    let found = estimate(&frequency_hz, |gamma| (-0.4 * gamma).exp(), &pulses);
    assert_freedom(&found, 4.0, "separate pulses");
    let gauge = OneGauge::new(rod, strain(0.2)).unwrap();
    let found = estimate(&frequency_hz, |gamma| -(-0.4 * gamma).exp(), &gauge);
    assert_freedom(&found, 4.0, "one gauge");
    let ends = TwoPoint::new(Specimen {
        length: 0.8,
        diameter: DIAMETER,
        density: DENSITY,
        accelerometer_mass: 0.0,
    });
    let ends = ends.unwrap();
    let found = estimate(&frequency_hz, |gamma| (0.8 * gamma).cosh(), &ends);
    assert_freedom(&found, 4.0, "two-point");
}

/// A resonance is determined from several lines. The variance of their polynomial has more degrees
/// of freedom than a line, and at most those of all lines that are used.
#[test]
fn r14_resonances_have_the_degrees_of_freedom_of_their_lines() {
    let method = Resonances::new(with_end_mass(0.0), 0.8).unwrap();
    let [few, known] = estimate(&lines(800, 10.0), |gamma| (0.8 * gamma).cosh(), &method);
    assert!(known.lines().len() >= 6);
    for (line, certain) in few.lines().iter().zip(known.lines()) {
        // each resonance uses some 10 lines, those within 0.3 rad of kL on either side
        let freedom = line.uncertainty.degrees_of_freedom.unwrap();
        assert!((8.0..80.0).contains(&freedom), "{freedom}");
        // the error is larger than with known variances: lines with estimated variances have equal
        // weights, although their errors are fractions of Ψ
        let quotient = line.standard_error.storage_modulus / certain.standard_error.storage_modulus;
        assert!((0.99..3.0).contains(&quotient), "{quotient}");
    }
}

/// Three gauges with noise from a silence of ten segments; the sum over the gauges has between one
/// and three times the degrees of freedom of a gauge.
#[test]
fn r14_noise_of_gauges_carries_degrees_of_freedom() {
    let frequency_hz = lines(200, 40.0);
    let positions = vec![0.0, 0.15, 0.3];
    let spectra: Vec<Vec<Complex64>> = positions
        .iter()
        .map(|x| {
            let waves = |f: &f64| (-gamma(*f) * x).exp() + 0.4 * (gamma(*f) * x).exp();
            frequency_hz.iter().map(waves).collect()
        })
        .collect();
    let rod = GaugedRod {
        positions,
        diameter: DIAMETER,
        density: DENSITY,
    };
    let noise = vec![vec![3e-4; frequency_hz.len()]; 3];
    let measured = GaugeSpectra {
        frequency_hz: &frequency_hz,
        tests: &[&spectra],
        noise: &noise,
    };
    let freedom = VarianceFreedom::new(20.0, 5.0).unwrap();
    let three = ThreePoint::new(rod.clone()).unwrap();
    let three = three.with_noise_freedom(freedom).unwrap();
    let multi = MultiPoint::new(rod).unwrap();
    let multi = multi.with_noise_freedom(freedom).unwrap();
    let (three, multi) = (
        three.estimate(&measured).unwrap(),
        multi.estimate(&measured).unwrap(),
    );
    let multi = multi.modulus();
    assert!(three.valid().count() > 50 && multi.valid().count() > 50);
    for (a, b) in three.lines().iter().zip(multi.lines()) {
        let of = |line: &cmod::ModulusLine| line.uncertainty.degrees_of_freedom.unwrap();
        assert!((20.0..60.001).contains(&of(a)), "{}", of(a));
        // with three gauges the weights have no effect, so both methods are the same
        assert!((of(a) / of(b) - 1.0).abs() < 1e-6, "{} {}", of(a), of(b));
        let own = a.uncertainty.own_degrees_of_freedom.unwrap();
        assert!((own / of(a) - 0.25).abs() < 1e-9);
    }
}

/// Records between 1.2 and 2.2 delays long: the phase turns by up to 1.7 π from line to line. With
/// the delay between the pulses the waves are counted correctly, and the lines give the modulus of
/// the material.
#[test]
fn r16_pulses_in_records_of_two_delays_keep_their_branch() {
    // delay of the centre of energy of a pulse of some kilohertz, over 0.4 m at 1700 m/s
    let delay = 0.4 * gamma(3000.0).im / (TAU * 3000.0);
    let one_dimensional = cmod::validity::AcceptanceLimits::ONE_DIMENSIONAL;
    for of_delay in [1.2, 1.6, 2.0, 2.2] {
        let frequency_hz = lines(40, 1.0 / (of_delay * delay));
        let ratio: Vec<Complex64> = frequency_hz
            .iter()
            .map(|f| (-0.4 * gamma(*f)).exp())
            .collect();
        let variance = vec![1e-8; ratio.len()];
        // the delay may be wrong by 15 %
        for error in [-0.15, 0.0, 0.15] {
            let method = SeparatePulses::new(PULSED).unwrap();
            let method = method.with_limits(one_dimensional).unwrap();
            let method = method.with_delay(delay * (1.0 + error)).unwrap();
            let gauge = OneGauge::new(
                with_end_mass(0.0),
                EndSection {
                    distance: 0.2,
                    quantity: Quantity::Velocity,
                },
            );
            let gauge = gauge.unwrap().with_limits(one_dimensional).unwrap();
            let gauge = gauge.with_delay(delay * (1.0 + error)).unwrap();
            let found = [
                method.estimate(&frequency_hz, &ratio, &variance).unwrap(),
                gauge.estimate(&frequency_hz, &ratio, &variance).unwrap(),
            ];
            for estimate in found {
                let right = estimate
                    .valid()
                    .filter(|line| {
                        let expected = gamma(line.frequency_hz);
                        (line.propagation_coefficient - expected).norm() < 1e-9 * expected.norm()
                    })
                    .count();
                assert_eq!(right, estimate.valid().count(), "{of_delay}, {error}");
                // all lines except those with wavelengths above five distances and below five
                // diameters, 0.9 to 31 kHz, and one line at each end
                let within = frequency_hz.iter().filter(|f| (900.0..31e3).contains(*f));
                let expected = within.count();
                assert!(
                    expected > 7 && right + 2 >= expected,
                    "{of_delay}, {error}: {right}"
                );
            }
        }
    }
    let refused = SeparatePulses::new(PULSED).unwrap().with_delay(0.0);
    assert_eq!(
        refused.unwrap_err().to_string(),
        "delay of the later pulse [s] is 0, expected a finite value above 0"
    );
}
