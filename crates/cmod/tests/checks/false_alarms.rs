//! Rates of false alarms and of undecided checks.

use rodwave::modulus::Elastic;

use super::*;

/// Checks that the passivity of a wave without losses is undecided as often as chance predicts.
#[test]
fn losses_that_are_not_seen_are_undecided() {
    let undecided = (0..40)
        .filter(|seed| {
            let outcome = passivity(&elastic_wave(*seed), USUAL_LEVEL).unwrap();
            outcome.verdict == CheckVerdict::Undecided
        })
        .count();
    // the pooled loss is within one standard error in 68 % of 40 records; tolerance: four standard
    // deviations
    assert!(undecided.abs_diff(27) <= 12, "{undecided}");
}

/// Returns the estimate of a wave without losses at two sections, the limit between passive and
/// active.
fn elastic_wave(seed: u64) -> ModulusEstimate {
    let medium = Medium::new(DENSITY, Elastic::new(2.6e9).unwrap()).unwrap();
    let section = Circle::of_diameter(DIAMETER).unwrap();
    let chain = Chain::from_impact_face()
        .rod(&medium, section, LENGTH)
        .end(Termination::semi_infinite(&medium, section))
        .unwrap();
    let mut random = Noise::seeded(seed);
    let frequency_hz: Vec<f64> = (1..=60).map(|j| 150.0 * f64::from(j)).collect();
    let sections = [0.2, 0.7].map(|x| chain.section(0, x).unwrap());
    let ratio: Vec<Complex64> = frequency_hz
        .iter()
        .map(|f| {
            let [first, second] =
                [&sections[0], &sections[1]].map(|s| s.state(TAU * f).unwrap().normal_force);
            second / first + random.circular(1e-4)
        })
        .collect();
    SeparatePulses::new(PulsedRod {
        distance: 0.5,
        diameter: DIAMETER,
        density: DENSITY,
    })
    .unwrap()
    .estimate(&frequency_hz, &ratio, &[1e-4; 60])
    .unwrap()
}

/// Checks the number of false alarms in 400 records at the level 5 %: 20, with four standard
/// deviations of 4.4 on either side.
fn assert_rate(name: &str, alarms: usize) {
    assert!(alarms.abs_diff(20) <= 17, "{name}: {alarms} of 400");
}

#[test]
fn false_alarms_come_at_the_stated_level() {
    let mut random = Noise::seeded(13);
    let alarms = (0..400)
        .filter(|_| {
            SpectraOfTest::of(&relaxing(), DISTANCES, &mut random)
                .free_end_null(0.05)
                .has_failed()
        })
        .count();
    assert_rate("free-end null", alarms);

    for persistence in [0.0, 0.8] {
        // the histories contain noise only, because samples after the arrival of the wave have no
        // effect
        let alarms = (0..400)
            .filter(|_| {
                let silence: Vec<Vec<f64>> = (0..3)
                    .map(|_| noisy([0.0; 1200].into_iter(), 1.0, persistence, &mut random))
                    .collect();
                causality(&silence, 0.05).has_failed()
            })
            .count();
        assert_rate(&format!("causality, persistence {persistence}"), alarms);
    }

    let alarms = (0..400)
        .filter(|seed| passivity(&elastic_wave(*seed), 0.05).unwrap().has_failed())
        .count();
    assert_rate("passivity", alarms);
}

/// For the Kramers-Kronig check the level is an upper bound, because the nearest of many materials
/// absorbs some of the noise.
#[test]
fn kramers_and_kronig_cry_wolf_less_often_than_stated() {
    let mut random = Noise::seeded(14);
    let (mut alarms, mut sum) = (0, 0.0);
    for _ in 0..60 {
        let estimate = SpectraOfTest::of(&relaxing(), DISTANCES, &mut random).estimate();
        let outcome = kramers_kronig(&estimate, 0.05).unwrap();
        alarms += usize::from(outcome.has_failed());
        sum += outcome.statistic;
    }
    // more than 8 alarms in 60 records have a probability of 0.5 % at a level of 5 %
    assert!(alarms <= 8, "{alarms}");
    // the root mean square residual of some hundred lines is 1, less the part that a dozen
    // parameters absorb, less half of its relative scatter 1/√(2n)
    assert!((sum / 60.0 - 0.97).abs() < 0.06, "{}", sum / 60.0);
}
