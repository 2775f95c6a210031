//! Causal estimates, compared with rods of known material in the presence of noise and sensor
//! errors.

use std::f64::consts::TAU;

use cmod::CmodError;
use cmod::causal::CausalEstimate;
use cmod::estimate::StandardError;
use cmod::rheology::{ModulusData, ModulusPoint};
use cmod::two_point::SpecimenUncertainty;
use num_complex::Complex64;
use testbed::noise::Noise;

use crate::self_calibration::{
    DELAY, GAIN, RINGING, Record, Rod, SOFT, STIFF, root_mean_square, within,
};

fn causal(record: &Record, rod: &Rod) -> CausalEstimate {
    let estimate = record.used(rod, |method, lines| {
        CausalEstimate::of_ratio(method, lines, None)
    });
    estimate.unwrap()
}

/// Returns the standard errors of E' and E''.
fn of_line(error: &StandardError) -> [f64; 2] {
    [error.storage_modulus, error.loss_modulus]
}

fn stated(estimate: &CausalEstimate, frequency_hz: f64) -> [f64; 2] {
    let [[storage, _], [_, loss]] = estimate.at(frequency_hz).unwrap().covariance;
    [storage.sqrt(), loss.sqrt()]
}

/// Checks the coverage of the modulus, of the sizes of the sensor errors and of χ² for records
/// whose sensors are wrong as stated. The stated errors must also be smaller than those of the
/// single lines of the same records, which are calibrated too.
#[test]
fn errors_of_a_causal_estimate_cover_and_are_less_than_those_of_its_lines() {
    const RECORDS: u64 = 40;
    let ringing = Rod {
        // no uncertainty of the end mass: the record would determine an error of 1 % to a
        // twentieth, at which its effect is not linear
        uncertainty: SpecimenUncertainty {
            length: 5e-4,
            density: 2.5,
            ..SpecimenUncertainty::default()
        },
        ..RINGING
    };
    for (name, rod, median) in [
        ("stiff", STIFF, 0.15),
        ("soft", SOFT, 0.6),
        ("ringing", ringing, 0.9),
    ] {
        let (mut z, mut of_sizes, mut shares) = (Vec::new(), Vec::new(), Vec::new());
        let mut contradictions = 0;
        for seed in 0..RECORDS {
            let mut noise = Noise::seeded(900 + seed);
            let drawn = [noise.normal(), noise.normal()];
            let struck = rod.drawn(&mut noise);
            let record = struck.record(GAIN * drawn[0], DELAY * drawn[1], &mut noise);
            let causal = causal(&record, &rod);
            assert!(causal.is_at_rest(), "{name} {seed}");
            contradictions += u32::from(causal.p_value() < 0.05);
            let sources = causal.sources().iter().zip(drawn);
            of_sizes.extend(sources.map(|(own, drawn)| (own.size - drawn) / own.standard_error));
            z.extend(rod.z_of_causal(&causal));
            let [lowest, highest] = causal.band_hz();
            let calibrated = record.calibrated(&rod);
            let lines = calibrated.estimate().lines().iter();
            for line in lines.filter(|line| (lowest..=highest).contains(&line.frequency_hz)) {
                let pairs = stated(&causal, line.frequency_hz);
                let pairs = pairs.into_iter().zip(of_line(&line.standard_error));
                shares.extend(pairs.map(|(own, line)| own / line));
            }
        }
        // root mean square of 80 values; tolerance: four of its standard deviations
        let size = root_mean_square(&of_sizes);
        assert!((0.68..1.32).contains(&size), "{name}: {size}");
        // 68 and 95 % are expected; the errors of the lines of a record are correlated, so the
        // fractions scatter like those of 40 values
        let coverage = [within(&z, 1.0), within(&z, 1.96)];
        assert!((0.58..0.80).contains(&coverage[0]), "{name}: {coverage:?}");
        assert!((0.88..0.998).contains(&coverage[1]), "{name}: {coverage:?}");
        // more than seven of 40 at a level of 5 % have a probability of 0.1 %
        assert!(contradictions <= 7, "{name}: {contradictions}");
        shares.sort_by(f64::total_cmp);
        assert!(
            shares[shares.len() / 2] < median,
            "{name}: {}",
            shares[shares.len() / 2]
        );
        // tolerance: three standard deviations of 4 %, because the errors are from 300 draws
        assert!(
            shares[shares.len() - 1] < 1.12,
            "{name}: {}",
            shares[shares.len() - 1]
        );
    }
}

/// Checks that lines next to a resonance, which do not determine their own modulus, obtain their
/// modulus from all other lines.
#[test]
fn singular_lines_come_back() {
    let rod = Rod {
        noise: 8e-3,
        ..STIFF
    };
    let record = rod.record(0.0, 0.0, &mut Noise::seeded(3));
    let causal = causal(&record, &rod);
    let calibrated = record.calibrated(&rod);
    let [lowest, highest] = causal.band_hz();
    let singular: Vec<_> = calibrated
        .estimate()
        .lines()
        .iter()
        .filter(|line| (lowest..=highest).contains(&line.frequency_hz))
        .filter(|line| !line.validity.is_valid())
        .collect();
    assert!(singular.len() > 10, "{}", singular.len());
    for line in singular {
        let truth = (STIFF.modulus)(TAU * line.frequency_hz);
        let found = causal.at(line.frequency_hz).unwrap();
        let error = found.modulus - truth;
        let [storage, loss] = stated(&causal, line.frequency_hz);
        // each of these lines alone is refused, because five of its standard errors exceed the loss
        // factor
        assert!(5.0 * loss < 0.2 * truth.im, "{}", line.frequency_hz);
        assert!(error.re.abs() < 4.0 * storage && error.im.abs() < 4.0 * loss);
    }
}

/// Data with a delay of twelve times the stated uncertainty, and data whose losses rise and fall
/// over a few lines, are reported as contradicting causality.
#[test]
fn data_that_contradict_causality_are_called_so() {
    let rod = STIFF;
    let record = rod.record(0.0, 0.0, &mut Noise::seeded(12));
    let late = rod.record(0.0, 12.0 * DELAY, &mut Noise::seeded(12));
    assert!(causal(&record, &rod).p_value() > 0.01);
    let refuted = causal(&late, &rod);
    assert!(refuted.p_value() < 1e-6, "{}", refuted.p_value());
    // the found size of the delay is twelve standard uncertainties and thus shows the cause
    assert!((refuted.sources()[1].size - 12.0).abs() < 0.1);

    let wavy = points(60, 1e6).into_iter().map(|point| {
        let wave = 4e6 * (point.frequency_hz / 100.0).sin();
        ModulusPoint {
            modulus: point.modulus + Complex64::new(0.0, wave),
            ..point
        }
    });
    let wavy = ModulusData::new(&wavy.collect::<Vec<_>>()).unwrap();
    let refuted = CausalEstimate::new(&wavy).unwrap();
    assert!(refuted.p_value() < 1e-9 && refuted.distance() > 2.0);
}

/// Returns points with a circular error of the same variance in both parts.
fn points(number: u32, error: f64) -> Vec<ModulusPoint> {
    let mut noise = Noise::seeded(2);
    (1..=number)
        .map(|j| {
            let frequency_hz = 40.0 * f64::from(j);
            let modulus = (SOFT.modulus)(TAU * frequency_hz);
            let noise = error * Complex64::new(noise.normal(), noise.normal());
            ModulusPoint::circular(frequency_hz, modulus + noise, error)
        })
        .collect()
}

#[test]
fn covariance_of_a_frequency_with_itself_is_its_covariance() {
    let data = ModulusData::new(&points(60, 1e6)).unwrap();
    let causal = CausalEstimate::new(&data).unwrap();
    let own = causal.at(800.0).unwrap().covariance;
    let between = causal.covariance_between(800.0, 800.0).unwrap();
    let swapped = [
        causal.covariance_between(400.0, 1600.0).unwrap(),
        causal.covariance_between(1600.0, 400.0).unwrap(),
    ];
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        assert!((own[i][j] - between[i][j]).abs() < 1e-12 * own[0][0]);
        assert!((swapped[0][i][j] - swapped[1][j][i]).abs() < 1e-12 * own[0][0]);
    }
    // the errors at neighbouring frequencies are correlated, those at distant frequencies are not
    let near = causal.covariance_between(800.0, 840.0).unwrap()[0][0];
    let far = causal.covariance_between(800.0, 2400.0).unwrap()[0][0];
    assert!(
        near > 0.8 * own[0][0] && far.abs() < 0.5 * own[0][0],
        "{near:e} {far:e}"
    );
    assert_eq!(causal.rounds(), 0);
}

#[test]
fn what_has_no_causal_estimate_is_refused() {
    let data = ModulusData::new(&points(60, 1e6)).unwrap();
    let causal = CausalEstimate::new(&data).unwrap();
    for outside in [39.9, 2400.1, f64::NAN] {
        assert!(matches!(
            causal.at(outside),
            Err(CmodError::NonPhysical { .. })
        ));
    }
    let few = ModulusData::new(&points(2, 1e6)).unwrap();
    assert_eq!(
        CausalEstimate::new(&few).unwrap_err().to_string(),
        "2 data points, expected at least 3"
    );
    let negative: Vec<ModulusPoint> = points(5, 1e6)
        .into_iter()
        .map(|point| ModulusPoint {
            modulus: -point.modulus,
            ..point
        })
        .collect();
    let none = CausalEstimate::new(&ModulusData::new(&negative).unwrap()).unwrap();
    assert!(none.p_value() < 1e-9);
    assert!(matches!(none.series(), Err(CmodError::NoCausalEstimate)));
}
