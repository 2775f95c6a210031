//! Variances from few hits, and noise from a short silence before the hit.

use cmod::estimate::VarianceFreedom;
use cmod::section_ratio::{RatioLines, RatioMethod};
use cmod::two_point::variance_from_coherence;
use cmod::{GaugedRod, MultiPoint};
use labio::ratio::pooling::AveragedVariance;

use super::*;

const DISTANCE: f64 = 0.4;

fn of_pulses(
    frequency_hz: &[f64],
    ratio: &[Complex64],
    variance: &[f64],
    freedom: &[VarianceFreedom],
) -> ModulusEstimate {
    let rod = PulsedRod {
        distance: DISTANCE,
        diameter: DIAMETER,
        density: DENSITY,
    };
    let lines = RatioLines {
        freedom: Some(freedom),
        ..RatioLines::of_known_variance(frequency_hz, ratio, variance)
    };
    let method = SeparatePulses::new(rod).unwrap();
    method.estimate_ratio(&lines).unwrap()
}

/// Returns the estimate from spectra of few hits, which are drawn directly: a pulse at two sections
/// with noise in both. The variances are estimated from the hits of each line alone or pooled with
/// neighbouring lines.
fn of_few_hits(random: &mut Noise, hits: usize, pooled: bool) -> ModulusEstimate {
    let medium = relaxing();
    let frequency_hz: Vec<f64> = (1..=150).map(|j| 60.0 * f64::from(j)).collect();
    let (mut ratio, mut coherence, mut power) = (Vec::new(), Vec::new(), Vec::new());
    for f in &frequency_hz {
        let passage = (-medium.propagation_coefficient(TAU * f) * DISTANCE).exp();
        let (mut cross, mut first, mut second) = (Complex64::new(0.0, 0.0), 0.0, 0.0);
        for _ in 0..hits {
            let pulse = 1.0 + random.circular(0.09);
            let (later, earlier) = (
                passage * pulse + random.circular(NOISE.powi(2)),
                pulse + random.circular(NOISE.powi(2)),
            );
            cross += later * earlier.conj();
            first += later.norm_sqr();
            second += earlier.norm_sqr();
        }
        ratio.push(cross / second);
        coherence.push(cross.norm_sqr() / (first * second));
        power.push(second);
    }
    let averages = f64::from(u32::try_from(hits).unwrap());
    let variance = variance_from_coherence(&ratio, &coherence, averages).unwrap();
    let alone = vec![VarianceFreedom::of_averages(averages).unwrap(); ratio.len()];
    let shared = AveragedVariance {
        ratio: &ratio,
        variance: &variance,
        denominator_power: &power,
        averages,
        lines_per_independent_line: 1.0,
    }
    .pooled()
    .unwrap();
    let (variance, freedom) = if pooled {
        let freedom = shared.freedom.iter();
        let freedom = freedom.map(|of| VarianceFreedom::new(of.line, of.own).unwrap());
        (shared.variance, freedom.collect())
    } else {
        (variance, alone)
    };
    of_pulses(&frequency_hz, &ratio, &variance, &freedom)
}

/// At a level of 5 %, at most 6 of 40 correct records may fail: more failures have a probability of
/// 1 in 300, or less if the check fails less often than its level.
#[test]
fn r14_variances_of_few_hits_fail_no_right_record() {
    for (hits, pooled) in [(2, false), (3, false), (3, true), (5, true)] {
        let (mut kramers, mut passive) = (0, 0);
        for seed in 0..40 {
            let mut random = Noise::seeded(900 + seed);
            let estimate = of_few_hits(&mut random, hits, pooled);
            kramers += u32::from(kramers_kronig(&estimate, 0.05).unwrap().has_failed());
            passive += u32::from(passivity(&estimate, 0.05).unwrap().has_failed());
        }
        assert!(kramers <= 6 && passive <= 6, "{hits}: {kramers} {passive}");
    }
}

/// Checks that few hits also detect a modulus that no relaxing material has.
#[test]
fn r14_few_hits_still_see_a_modulus_that_is_none() {
    let mut random = Noise::seeded(17);
    let estimate = of_few_hits(&mut random, 3, true);
    assert!(!kramers_kronig(&estimate, 0.01).unwrap().has_failed());
    // no relaxing material stiffens and softens by 2 % every kilohertz
    let frequency_hz: Vec<f64> = estimate.lines().iter().map(|l| l.frequency_hz).collect();
    let ratio: Vec<Complex64> = estimate
        .lines()
        .iter()
        .map(|line| {
            let wave = 1.0 + 0.01 * (line.frequency_hz / 160.0).sin();
            (-line.propagation_coefficient * DISTANCE * wave).exp()
        })
        .collect();
    let freedom = vec![VarianceFreedom::new(40.0, 4.0).unwrap(); ratio.len()];
    let wavy = of_pulses(
        &frequency_hz,
        &ratio,
        &vec![NOISE * NOISE; ratio.len()],
        &freedom,
    );
    assert!(kramers_kronig(&wavy, 0.01).unwrap().has_failed());
}

/// Returns the estimate from three gauges whose noise is known from a silence of a few segments,
/// with ten degrees of freedom for fifteen lines.
fn of_gauges(random: &mut Noise, loss: f64) -> ModulusEstimate {
    let positions = [0.0, 0.15, 0.35];
    let frequency_hz: Vec<f64> = (1..=120).map(|j| 60.0 * f64::from(j) + 800.0).collect();
    let mut strains = vec![Vec::new(); positions.len()];
    for f in &frequency_hz {
        let modulus = relaxing().law().at(TAU * f);
        let modulus = Complex64::new(modulus.re, loss * modulus.im);
        let gamma = Complex64::I * TAU * *f * (DENSITY / modulus).sqrt();
        for (strain, x) in strains.iter_mut().zip(positions) {
            let waves = (-gamma * x).exp() + 0.5 * (gamma * (x - 1.3)).exp();
            strain.push(waves + random.circular(NOISE.powi(2)));
        }
    }
    let noise: Vec<Vec<f64>> = positions
        .iter()
        .map(|_| {
            let mut of_segment = || {
                let chi_square: f64 = (0..10).map(|_| random.normal().powi(2)).sum();
                NOISE * (chi_square / 10.0).sqrt()
            };
            (0..8).flat_map(|_| [of_segment(); 15]).collect()
        })
        .collect();
    let rod = GaugedRod {
        positions: positions.to_vec(),
        diameter: DIAMETER,
        density: DENSITY,
    };
    let freedom = VarianceFreedom::new(10.0, 10.0 / 15.0).unwrap();
    let method = MultiPoint::new(rod).unwrap();
    let method = method.with_noise_freedom(freedom).unwrap();
    let measured = GaugeSpectra {
        frequency_hz: &frequency_hz,
        tests: &[&strains],
        noise: &noise,
    };
    method.estimate(&measured).unwrap().modulus().clone()
}

/// The fit of the nearest material absorbs one degree of freedom of the noise per parameter. If
/// these are subtracted, the statistic is 1 on average, and the level is kept. If a dozen of 300
/// are not subtracted, the statistic is 0.98, and the rate of false alarms at 5 % is one in a
/// hundred.
#[test]
fn r14_kramers_and_kronig_alarm_at_their_level() {
    let seeds: u64 = testbed::noise::draws(30);
    let case = |name: &str, of: &dyn Fn(&mut Noise, f64) -> ModulusEstimate| {
        let (mut sum, mut below, mut seen) = (0.0, [0; 4], 0);
        for seed in 0..seeds {
            let mut random = Noise::seeded(7000 + seed);
            let outcome = kramers_kronig(&of(&mut random, 1.0), 0.05).unwrap();
            sum += outcome.statistic;
            for (below, level) in below.iter_mut().zip([0.01, 0.05, 0.2, 0.5]) {
                *below += u32::from(outcome.p_value < level);
            }
            if seed < 10 {
                let doubled = kramers_kronig(&of(&mut random, 2.0), 0.01).unwrap();
                seen += u32::from(doubled.has_failed());
            }
        }
        let mean = sum / seeds as f64;
        println!("{name}: {below:?} of {seeds} below 1, 5, 20, 50 %, {mean:.3}, {seen}");
        (mean, below[1], seen)
    };
    let few = [3, 4, 5, 10].map(|hits| {
        case(&format!("{hits} hits"), &|random, _| {
            of_few_hits(random, hits, true)
        })
    });
    let (mean, below, seen) = case("3 gauges", &|random, loss| of_gauges(random, loss));
    assert_eq!(seen, 10, "a doubled loss");
    // mean of 150 values with a standard deviation of 0.04 each; tolerance: four standard
    // deviations of the mean
    let mean = (few.iter().map(|(mean, ..)| mean).sum::<f64>() + mean) / 5.0;
    assert!((mean - 1.0).abs() < 0.013, "{mean}");
    // at most 5 % of 150 plus four standard deviations
    let below = few.iter().map(|(_, below, _)| below).sum::<u32>() + below;
    assert!(u64::from(below) * 25 <= 3 * 5 * seeds, "{below}");
}
