//! Input that is invalid as a whole, and lines that are invalid.

use cmod::estimate::Refusal;
use cmod::validity::Violation;
use cmod::{CmodError, GaugeSpectra, GaugedRod, MultiPoint, ThreePoint};
use num_complex::Complex64;

use super::frame::{Structure, clean, flat, lines, noisy, rod, size, strains};

#[test]
fn impossible_rods_are_refused() {
    let text = |positions: &[f64]| MultiPoint::new(rod(positions)).unwrap_err().to_string();
    assert_eq!(text(&[0.0, 0.1]), "2 gauges, expected 3 or more");
    assert_eq!(
        text(&[0.0, 0.2, 0.1]),
        "position of gauge 3 is 0.1 m, expected more than the 0.2 m of the previous gauge"
    );
    assert_eq!(
        text(&[0.0, 0.1, f64::NAN]),
        "position of a gauge [m] is NaN, expected a finite value"
    );
    let heavy = GaugedRod {
        density: f64::INFINITY,
        ..rod(&[0.0, 0.1, 0.2])
    };
    assert!(MultiPoint::new(heavy).is_err());
    assert_eq!(
        ThreePoint::new(rod(&[0.0, 0.1, 0.25]))
            .unwrap_err()
            .to_string(),
        "distances of the outer gauges from the middle one are 0.1000 m and 0.1500 m, expected equal distances, or the method for gauges at any positions"
    );
    assert!(matches!(
        ThreePoint::new(rod(&[0.0, 0.1, 0.2, 0.3])),
        Err(CmodError::GaugeCount { found: 4, .. })
    ));
    let guess = MultiPoint::new(rod(&[0.0, 0.1, 0.2])).unwrap();
    assert!(guess.with_wave_speed(0.0).is_err());
}

#[test]
fn spectra_that_do_not_fit_are_refused() {
    let three = rod(&[0.0, 0.1, 0.2]);
    let squares = MultiPoint::new(three.clone()).unwrap();
    let closed = ThreePoint::new(three).unwrap();
    let text = |spectra: &GaugeSpectra<'_>| {
        let error = squares.estimate(spectra).unwrap_err();
        assert_eq!(closed.estimate(spectra).unwrap_err(), error);
        error.to_string()
    };
    let f = [1.0, 2.0];
    let good = vec![vec![Complex64::ONE; 2]; 3];
    let noise = flat(&[0.0; 3], 2);
    assert_eq!(text(&clean(&[], &[&good], &noise)), "no line to evaluate");
    assert_eq!(text(&clean(&f, &[], &noise)), "no test to evaluate");
    assert_eq!(
        text(&clean(&[2.0, 2.0], &[&good], &noise)),
        "frequency of line 1 is 2 Hz, expected more than the 2 Hz of the previous line"
    );
    assert_eq!(
        text(&clean(&f, &[&good, &good[..2]], &noise)),
        "test 1 has spectra of 2 gauges, expected 3, one per position"
    );
    let mut short = good.clone();
    short[2].pop();
    assert_eq!(
        text(&clean(&f, &[&short], &noise)),
        "spectrum of gauge 2 in test 0 has 1 lines, expected 2, one per frequency"
    );
    assert_eq!(
        text(&clean(&f, &[&good], &noise[..2])),
        "2 gauges, expected noise of one gauge per position"
    );
    assert_eq!(
        text(&clean(&f, &[&good], &flat(&[0.0; 3], 1))),
        "noise of a gauge has 1 lines, expected 2, one per frequency"
    );
    assert_eq!(
        text(&clean(&f, &[&good], &flat(&[0.0, 0.0, -0.5], 2))),
        "noise of gauge 2 at line 0 is -0.5, expected 0 or above"
    );
}

/// A bad line is refused with its reason, and the other lines are not affected.
#[test]
fn a_line_without_information_is_refused_alone() {
    let positions = [0.3, 0.4, 0.5];
    let mut frequency_hz = lines(500.0, 100.0, 40);
    frequency_hz[0] = 0.0;
    let mut spectra = strains(Structure::I, &positions, &frequency_hz[1..]);
    let mut noise = flat(&[1e-3 * size(&spectra); 3], 40);
    for spectrum in &mut spectra {
        spectrum.insert(0, Complex64::ONE);
    }
    spectra[1][7] = Complex64::new(f64::NAN, 0.0);
    for spectrum in &mut spectra {
        spectrum[9] = Complex64::ZERO;
    }
    noise[2][11] = f64::INFINITY;
    noise[1][13] = 0.0;
    let tests: [&[Vec<Complex64>]; 1] = [&spectra];
    let input = clean(&frequency_hz, &tests, &noise);

    let squares = MultiPoint::new(rod(&positions)).unwrap();
    let squares = squares.estimate(&input).unwrap();
    let reasons = |refused: &[cmod::estimate::RefusedLine]| -> Vec<_> {
        refused
            .iter()
            .map(|line| (line.index, line.reason))
            .collect()
    };
    assert_eq!(
        reasons(squares.modulus().refused()),
        [
            (0, Refusal::ZeroFrequency),
            (7, Refusal::SpectrumNotFinite),
            (9, Refusal::Undetermined),
            (11, Refusal::SpectrumNotFinite),
            (13, Refusal::NoiseOfSomeGauges),
        ]
    );
    assert_eq!(squares.modulus().lines().len(), 35);
    assert_eq!(squares.fits().len(), 35);

    let closed = ThreePoint::new(rod(&positions)).unwrap();
    let closed = closed.estimate(&input).unwrap();
    assert_eq!(
        reasons(closed.refused()),
        [
            (0, Refusal::ZeroFrequency),
            (7, Refusal::SpectrumNotFinite),
            (9, Refusal::Undetermined),
            (11, Refusal::SpectrumNotFinite),
        ]
    );
}

/// Half a wave between the gauges: the errors grow and the line is marked by both methods. Unequal
/// distances and more gauges do not have this singular line.
#[test]
fn singular_lines_are_marked_and_can_be_avoided() {
    // c = 1680 m/s at 10 krad/s: half a wave of 0.1 m near 8.5 kHz
    let frequency_hz = lines(5000.0, 20.0, 300);
    let marked = |positions: &[f64]| {
        let spectra = strains(Structure::I, positions, &frequency_hz);
        let noise = flat(&vec![5e-2 * size(&spectra); positions.len()], 300);
        let spectra = noisy(&spectra, &noise, 5);
        let result = MultiPoint::new(rod(positions))
            .unwrap()
            .with_wave_speed(1700.0)
            .unwrap()
            .estimate(&clean(&frequency_hz, &[&spectra], &noise))
            .unwrap();
        let is_near = |violation: &Violation| matches!(violation, Violation::NearSingular { half_waves, .. } if (half_waves - 1.0).abs() < 0.2);
        let count = |line: &&cmod::ModulusLine| line.validity.violations().iter().any(is_near);
        let closed = ThreePoint::new(rod(positions)).ok().map(|method| {
            let estimate = method.estimate(&clean(&frequency_hz, &[&spectra], &noise));
            estimate.unwrap().lines().iter().filter(count).count()
        });
        (
            result.modulus().lines().iter().filter(count).count(),
            closed,
        )
    };
    let (squares, closed) = marked(&[0.3, 0.4, 0.5]);
    assert!(squares > 10, "{squares}");
    assert!(closed.is_some_and(|closed| closed > 10), "{closed:?}");
    let (squares, _) = marked(&[0.3, 0.33, 0.41, 0.46, 0.5]);
    assert_eq!(squares, 0);
}

/// With noise alone, at most one line in fifty may look like waves by chance.
#[test]
fn noise_alone_gives_no_modulus() {
    let positions = [0.2, 0.27, 0.4, 0.45, 0.6];
    let frequency_hz = lines(100.0, 50.0, 100);
    let nothing = vec![vec![Complex64::ZERO; 100]; 5];
    let noise = flat(&[1.0; 5], 100);
    let method = MultiPoint::new(rod(&positions)).unwrap();
    let of_seed = |seed| {
        let spectra = noisy(&nothing, &noise, seed);
        let result = method.estimate(&clean(&frequency_hz, &[&spectra], &noise));
        result.unwrap().modulus().valid().count()
    };
    let valid: usize = (0..20).map(of_seed).sum();
    assert!(valid <= 40, "{valid} valid lines of 2000");
}

/// Two waves do not explain a gauge with the wrong sign: the misfit shows it on every line.
#[test]
fn a_gauge_with_the_wrong_sign_is_noticed() {
    let positions = [0.2, 0.27, 0.4, 0.45, 0.6];
    let frequency_hz = lines(1000.0, 50.0, 100);
    let mut spectra = strains(Structure::II, &positions, &frequency_hz);
    let noise = flat(&[1e-3 * size(&spectra); 5], 100);
    spectra[3].iter_mut().for_each(|value| *value = -*value);
    let result = MultiPoint::new(rod(&positions))
        .unwrap()
        .estimate(&clean(&frequency_hz, &[&spectra], &noise))
        .unwrap();
    let misfits = result.modulus().lines().iter().filter(|line| {
        let violations = line.validity.violations();
        violations
            .iter()
            .any(|violation| matches!(violation, Violation::Misfit { .. }))
    });
    assert!(misfits.count() >= 95);
    assert!(result.modulus().valid().count() <= 5);
}
