//! Correct records, wrong records, and records that cannot be checked.

use cmod::checks::Check;
use rodwave::experiment::end_accelerations::RaisedCosine;
use rodwave::experiment::strains_in_a_frame::{Excitation, FrameMember};
use rodwave::synthesis::DampedSynthesis;

use super::*;

/// Modulus with E' and E'' that are both constant over frequency: it is passive, but belongs to no
/// material.
#[derive(Debug, Clone)]
struct ConstantBoth {
    loss_factor: f64,
}

impl ComplexModulus for ConstantBoth {
    fn at(&self, omega: f64) -> Complex64 {
        2.6e9 * Complex64::new(1.0, self.loss_factor * omega.signum())
    }
}

/// Returns histories of the three strains with noise, sampled every 2 µs; 1.2 ms of them are before
/// the hit.
fn histories(random: &mut Noise, persistence: f64) -> Vec<Vec<f64>> {
    let positions = DISTANCES.map(|distance| LENGTH - distance);
    let member = FrameMember::analytic(
        &relaxing(),
        Circle::of_diameter(DIAMETER).unwrap(),
        LENGTH,
        &positions,
        Termination::Mass(END_MASS),
    )
    .unwrap();
    let blow = RaisedCosine::new(100.0, 1e-4).unwrap();
    let synthesis = DampedSynthesis::new(4e-3, INTERVAL).unwrap();
    let record = member
        .record(&Excitation::Force(&blow), &synthesis)
        .unwrap();
    record
        .strains
        .iter()
        .map(|strain| {
            let peak = strain.iter().fold(0.0_f64, |peak, e| peak.max(e.abs()));
            let quiet = vec![0.0; BLOW];
            let clean = quiet.iter().chain(strain).copied();
            noisy(clean, NOISE * peak, persistence, random)
        })
        .collect()
}

/// The reflection reaches the last section 0.13 ms after the first wave.
fn polarity(histories: &[Vec<f64>]) -> CheckOutcome {
    arrivals(histories)
        .polarity(1720.0, 1.1e-4, USUAL_LEVEL)
        .unwrap()
}

fn all(spectra: &SpectraOfTest, histories: &[Vec<f64>]) -> Vec<CheckOutcome> {
    let estimate = spectra.estimate();
    vec![
        spectra.free_end_null(USUAL_LEVEL),
        causality(histories, USUAL_LEVEL),
        polarity(histories),
        passivity(&estimate, USUAL_LEVEL).unwrap(),
        kramers_kronig(&estimate, USUAL_LEVEL).unwrap(),
    ]
}

fn failures(outcomes: &[CheckOutcome]) -> Vec<Check> {
    let failed = outcomes.iter().filter(|outcome| outcome.has_failed());
    failed.map(|outcome| outcome.check).collect()
}

#[test]
fn a_right_record_passes() {
    let mut random = Noise::seeded(5);
    let spectra = SpectraOfTest::of(&relaxing(), DISTANCES, &mut random);
    let outcomes = all(&spectra, &histories(&mut random, 0.0));
    for outcome in outcomes {
        assert_eq!(outcome.verdict, CheckVerdict::Passed, "{outcome}");
    }
}

#[test]
fn a_gauge_out_of_place_leaves_a_force_at_the_free_end() {
    let mut random = Noise::seeded(6);
    let mut distances = DISTANCES;
    distances[2] += 1e-3;
    let spectra = SpectraOfTest::of(&relaxing(), distances, &mut random);
    let outcomes = all(&spectra, &histories(&mut random, 0.0));
    assert_eq!(failures(&outcomes), [Check::FreeEndNull]);
}

#[test]
fn a_gauge_the_wrong_way_round_is_named() {
    let mut random = Noise::seeded(7);
    let mut histories = histories(&mut random, 0.0);
    for value in &mut histories[1] {
        *value = -*value;
    }
    let outcome = polarity(&histories);
    assert_eq!((outcome.check, outcome.worst), (Check::Polarity, Some(1)));
    assert!(outcome.has_failed(), "{outcome}");
    // The free-end check fails too, but does not identify the fault.
    let mut spectra = SpectraOfTest::of(&relaxing(), DISTANCES, &mut random);
    for value in &mut spectra.strains[2] {
        *value = -*value;
    }
    assert!(spectra.free_end_null(USUAL_LEVEL).has_failed());
    // A wave of the wrong sign is neither early nor late.
    assert!(!causality(&histories, USUAL_LEVEL).has_failed());
    // A wave below the noise gives no information about its sign.
    let mut random = Noise::seeded(8);
    let silence: Vec<Vec<f64>> = (0..3)
        .map(|_| noisy([0.0; 2000].into_iter(), 1.0, 0.0, &mut random))
        .collect();
    assert_eq!(polarity(&silence).verdict, CheckVerdict::Undecided);
}

#[test]
fn a_channel_that_is_early_is_not_causal() {
    let mut random = Noise::seeded(9);
    let mut histories = histories(&mut random, 0.0);
    // The channel is 80 µs early. The wave needs 0.63 ms to reach this section, 5 % more than the
    // front, and rises slowly: a shift of less than some 40 µs does not contradict causality.
    histories[2].rotate_left(40);
    let outcome = causality(&histories, USUAL_LEVEL);
    assert!(outcome.has_failed(), "{outcome}");
    assert_eq!((outcome.check, outcome.worst), (Check::Causality, Some(2)));
    assert!(!polarity(&histories).has_failed());
}

/// A delay of a microsecond, of either sign, is too short for the arrival checks, but the free-end
/// check detects it.
#[test]
fn a_delay_between_channels_leaves_a_force_at_the_free_end() {
    for delay in [-1e-6, 1e-6] {
        let mut random = Noise::seeded(10);
        let mut spectra = SpectraOfTest::of(&relaxing(), DISTANCES, &mut random);
        for (value, f) in spectra.strains[2].iter_mut().zip(&spectra.frequency_hz) {
            *value *= Complex64::from_polar(1.0, -TAU * f * delay);
        }
        let outcome = spectra.free_end_null(USUAL_LEVEL);
        assert!(outcome.has_failed(), "{outcome}");
    }
}

#[test]
fn a_modulus_that_is_not_causal_fails_kramers_and_kronig_only() {
    let mut random = Noise::seeded(11);
    let law = Medium::new(DENSITY, ConstantBoth { loss_factor: 0.07 }).unwrap();
    let spectra = SpectraOfTest::of(&law, DISTANCES, &mut random);
    let outcomes = all(&spectra, &histories(&mut random, 0.0));
    assert_eq!(failures(&outcomes), [Check::KramersKronig]);
}

/// Spectra computed with the other kernel: the material appears to generate energy.
#[test]
fn negative_losses_are_not_passive() {
    let mut random = Noise::seeded(12);
    let mut spectra = SpectraOfTest::of(&relaxing(), DISTANCES, &mut random);
    for value in spectra.strains.iter_mut().flatten() {
        *value = value.conj();
    }
    let outcome = passivity(&spectra.estimate(), USUAL_LEVEL).unwrap();
    assert!(outcome.has_failed(), "{outcome}");
    assert_eq!(outcome.check, Check::Passivity);
}

#[test]
fn records_that_cannot_be_checked_are_refused() {
    let quiet = vec![0.0; 100];
    let channel = |samples| Channel {
        samples,
        distance: 0.5,
    };
    let text = |result: Result<Arrivals<'_>, cmod::CmodError>| result.unwrap_err().to_string();
    assert_eq!(
        text(Arrivals::new(vec![channel(&quiet)], 1e-6, 50)),
        "1 gauges, expected 2 or more"
    );
    assert_eq!(
        text(Arrivals::new(
            vec![channel(&quiet), channel(&quiet)],
            1e-6,
            3
        )),
        "the record before the hit, or after it, has 3 samples, expected at least 8"
    );
    let bad = vec![f64::NAN; 100];
    assert_eq!(
        text(Arrivals::new(
            vec![channel(&quiet), channel(&bad)],
            1e-6,
            50
        )),
        "sample 0 of channel 1 is NaN, expected a finite value"
    );
    let silent = Arrivals::new(vec![channel(&quiet), channel(&quiet)], 1e-6, 50).unwrap();
    assert_eq!(
        silent.causality(2000.0, 0.01).unwrap_err().to_string(),
        "the noise before the hit in channel 0 is 0, expected noise to compare with"
    );
    assert_eq!(
        FreeEndNull::new(rod(), vec![0.1, 0.2], Quantity::Strain)
            .unwrap_err()
            .to_string(),
        "2 gauges, expected 3 or more"
    );
}
