//! The checks without truth: they pass on right records, name what is wrong with wrong ones, and
//! cry wolf as often as they say.
//!
//! Spectra and histories are those of chains of impedances; no check uses these.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test, a refusal where none is expected is a failure"
)]

use std::f64::consts::TAU;

use cmod::checks::{
    Arrivals, Channel, Check, CheckOutcome, CheckVerdict, FreeEndNull, USUAL_LEVEL, kramers_kronig,
    passivity,
};
use cmod::estimate::{ModulusEstimate, VarianceFreedom};
use cmod::multi_point::{GaugeSpectra, Quantity};
use cmod::section_ratio::pooling::AveragedVariance;
use cmod::section_ratio::{RatioLines, RatioMethod};
use cmod::two_point::variance_from_coherence;
use cmod::{
    EndSection, FreeEnd, GaugedRod, MultiPoint, PulsedRod, RatioOfSpectra, RodWithFreeEnd,
    SeparatePulses,
};
use num_complex::Complex64;
use rodwave::chain::{AngularFrequency, Chain, Termination, WaveMedium};
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::RaisedCosine;
use rodwave::experiment::strains_in_a_frame::{Excitation, FrameMember};
use rodwave::medium::Medium;
use rodwave::modulus::{ComplexModulus, Elastic, GeneralisedMaxwell, MaxwellBranch};
use rodwave::synthesis::DampedSynthesis;
use testbed::noise::Noise;

const LENGTH: f64 = 1.2;
const DIAMETER: f64 = 0.0106;
const DENSITY: f64 = 903.0;
const END_MASS: f64 = 1e-3;
/// From the free end [m].
const DISTANCES: [f64; 3] = [0.52, 0.25, 0.11];
/// Error of a strain by the root mean square of the spectra of a line.
const NOISE: f64 = 2e-3;

fn rod() -> RodWithFreeEnd {
    RodWithFreeEnd {
        diameter: DIAMETER,
        density: DENSITY,
        end_mass: END_MASS,
    }
}

/// Loss factors of about 0.06 between 100 Hz and 20 kHz, and a front that travels at 1800 m/s.
fn relaxing() -> Medium<GeneralisedMaxwell> {
    let branches: Vec<MaxwellBranch> = (0..6)
        .map(|j| MaxwellBranch {
            modulus: 1.3e8,
            relaxation_time: 3e-6 * 4f64.powi(j),
        })
        .collect();
    Medium::new(DENSITY, GeneralisedMaxwell::new(2.14e9, branches).unwrap()).unwrap()
}

/// The speed of the front, by the unrelaxed modulus.
fn front_speed() -> f64 {
    (relaxing().law().unrelaxed_modulus() / DENSITY).sqrt()
}

/// E' and E'' that are both constant over frequency: passive, but no material.
#[derive(Debug, Clone)]
struct ConstantBoth {
    loss_factor: f64,
}

impl ComplexModulus for ConstantBoth {
    fn at(&self, omega: f64) -> Complex64 {
        2.6e9 * Complex64::new(1.0, self.loss_factor * omega.signum())
    }
}

/// Strains at three sections, with noise, and what they make of the modulus.
struct SpectraOfTest {
    frequency_hz: Vec<f64>,
    strains: Vec<Vec<Complex64>>,
    noise: Vec<Vec<f64>>,
}

impl SpectraOfTest {
    fn of<M>(medium: &M, distances: [f64; 3], random: &mut Noise) -> Self
    where
        M: WaveMedium<AngularFrequency> + Clone + 'static,
    {
        let frequency_hz: Vec<f64> = (1..=120).map(|j| 80.0 * f64::from(j)).collect();
        let chain = Chain::from_impact_face()
            .rod(medium, Circle::of_diameter(DIAMETER).unwrap(), LENGTH)
            .end(Termination::Mass(END_MASS))
            .unwrap();
        let mut strains: Vec<Vec<Complex64>> = distances
            .iter()
            .map(|distance| {
                let section = chain.section(0, LENGTH - distance).unwrap();
                let force = |f: &f64| section.state(TAU * f).unwrap().normal_force;
                frequency_hz.iter().map(force).collect()
            })
            .collect();
        let level: Vec<f64> = (0..frequency_hz.len())
            .map(|line| {
                let power: f64 = strains.iter().map(|strain| strain[line].norm_sqr()).sum();
                NOISE * (power / 3.0).sqrt()
            })
            .collect();
        for strain in &mut strains {
            for (value, level) in strain.iter_mut().zip(&level) {
                *value += random.circular((*level).powi(2));
            }
        }
        Self {
            frequency_hz,
            strains,
            noise: vec![level; 3],
        }
    }

    fn estimate(&self) -> ModulusEstimate {
        let section = |distance| EndSection {
            distance,
            quantity: Quantity::Strain,
        };
        let ratio = RatioOfSpectra::new(
            &[&self.strains[0]],
            &[&self.strains[1]],
            &self.noise[0],
            &self.noise[1],
        )
        .unwrap();
        FreeEnd::new(rod(), section(DISTANCES[0]), section(DISTANCES[1]))
            .unwrap()
            .estimate(&self.frequency_hz, &ratio.ratio, &ratio.variance)
            .unwrap()
    }

    fn free_end_null(&self, level: f64) -> CheckOutcome {
        let estimate = self.estimate();
        let mut gamma = vec![Complex64::new(f64::NAN, 0.0); self.frequency_hz.len()];
        for line in estimate.lines() {
            gamma[line.index] = line.propagation_coefficient;
        }
        let spectra = GaugeSpectra {
            frequency_hz: &self.frequency_hz,
            tests: &[&self.strains],
            noise: &self.noise,
        };
        FreeEndNull::new(rod(), DISTANCES.to_vec(), Quantity::Strain)
            .unwrap()
            .check(&spectra, &gamma, level)
            .unwrap()
    }
}

/// Histories of the three strains with noise, sampled every 2 µs, 1.2 ms of it before the blow.
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

/// Adds noise of this standard deviation, each sample with `persistence` of the one before, and an
/// offset.
fn noisy(
    clean: impl Iterator<Item = f64>,
    deviation: f64,
    persistence: f64,
    random: &mut Noise,
) -> Vec<f64> {
    let fresh = (1.0 - persistence * persistence).sqrt();
    let mut noise = random.normal();
    clean
        .map(|value| {
            noise = persistence * noise + fresh * random.normal();
            value + deviation * (noise + 3.0)
        })
        .collect()
}

const INTERVAL: f64 = 2e-6;
const BLOW: usize = 600;

fn arrivals(histories: &[Vec<f64>]) -> Arrivals<'_> {
    let channels = histories
        .iter()
        .zip(DISTANCES)
        .map(|(samples, distance)| Channel {
            samples,
            distance: LENGTH - distance,
        });
    Arrivals::new(channels.collect(), INTERVAL, BLOW).unwrap()
}

/// The last section sees the reflection 0.13 ms after the first wave.
fn polarity(histories: &[Vec<f64>]) -> CheckOutcome {
    arrivals(histories)
        .polarity(1720.0, 1.1e-4, USUAL_LEVEL)
        .unwrap()
}

fn causality(histories: &[Vec<f64>], level: f64) -> CheckOutcome {
    // 1 % more than the front
    arrivals(histories)
        .causality(1.01 * front_speed(), level)
        .unwrap()
}

/// All outcomes of one record.
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
    // The free end sees it, too, but cannot say what it is.
    let mut spectra = SpectraOfTest::of(&relaxing(), DISTANCES, &mut random);
    for value in &mut spectra.strains[2] {
        *value = -*value;
    }
    assert!(spectra.free_end_null(USUAL_LEVEL).has_failed());
    // An early or a late wave is another matter.
    assert!(!causality(&histories, USUAL_LEVEL).has_failed());
    // A wave below the noise says nothing.
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
    // 80 µs. The wave needs 0.63 ms to this section, 5 % more than the front, and rises slowly:
    // earlier by less than some 40 µs it is not impossible.
    histories[2].rotate_left(40);
    let outcome = causality(&histories, USUAL_LEVEL);
    assert!(outcome.has_failed(), "{outcome}");
    assert_eq!((outcome.check, outcome.worst), (Check::Causality, Some(2)));
    assert!(!polarity(&histories).has_failed());
}

/// A delay of a microsecond, whatever its sign, is too little to be seen as an arrival, but not for
/// the free end.
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

/// Spectra that were made with the other kernel: the material seems to give energy.
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

/// Losses within their errors are neither positive nor negative.
#[test]
fn losses_that_are_not_seen_are_undecided() {
    let undecided = (0..40)
        .filter(|seed| {
            let outcome = passivity(&elastic_wave(*seed), USUAL_LEVEL).unwrap();
            outcome.verdict == CheckVerdict::Undecided
        })
        .count();
    // |z| < 1 of the pooled losses: 68 %; four standard deviations of 40.
    assert!(undecided.abs_diff(27) <= 12, "{undecided}");
}

/// A wave without losses at two sections: the border between passive and active.
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

/// Number of false alarms of 400 at the level 5 %: 20, four standard deviations of 4.4 to either
/// side.
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
        // The records differ in their noise only; what comes after the wave does not matter.
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

/// For Kramers and Kronig the level is an upper bound, as the nearest of many materials takes up
/// some of the noise.
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
    // P(more than 8 of 60 at 5 %) is 0.5 %.
    assert!(alarms <= 8, "{alarms}");
    // Some hundred lines: 1 less what a dozen parameters take up, less half of the relative scatter
    // 1/√(2n).
    assert!((sum / 60.0 - 0.97).abs() < 0.06, "{}", sum / 60.0);
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
        "the record before the blow, or after it, has 3 samples, expected at least 8"
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
        "the record before the blow of channel 0 is 0, expected noise to compare with"
    );
    assert_eq!(
        FreeEndNull::new(rod(), vec![0.1, 0.2], Quantity::Strain)
            .unwrap_err()
            .to_string(),
        "2 gauges, expected 3 or more"
    );
}

/// Spectra of few hits, drawn directly: a pulse at two sections with noise in both, what it makes
/// of the modulus by its own lines or with neighbours.
fn of_few_hits(random: &mut Noise, hits: usize, pooled: bool) -> ModulusEstimate {
    let (medium, distance) = (relaxing(), 0.4);
    let frequency_hz: Vec<f64> = (1..=150).map(|j| 60.0 * f64::from(j)).collect();
    let (mut ratio, mut coherence, mut power) = (Vec::new(), Vec::new(), Vec::new());
    for f in &frequency_hz {
        let passage = (-medium.propagation_coefficient(TAU * f) * distance).exp();
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
        (&shared.variance, &shared.freedom)
    } else {
        (&variance, &alone)
    };
    let rod = PulsedRod {
        distance,
        diameter: DIAMETER,
        density: DENSITY,
    };
    SeparatePulses::new(rod)
        .unwrap()
        .estimate_ratio(&RatioLines {
            frequency_hz: &frequency_hz,
            ratio: &ratio,
            variance,
            freedom: Some(freedom),
            coherence: None,
            common: &[],
            lines_per_independent_line: 1.0,
        })
        .unwrap()
}

/// At a level of 5 % at most 6 of 40 right records fail: more happens once in 300 times at the
/// level, and rarer below it.
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

/// And they see what is wrong: a modulus that is no relaxing one.
#[test]
fn r14_few_hits_still_see_a_modulus_that_is_none() {
    let mut random = Noise::seeded(17);
    let estimate = of_few_hits(&mut random, 3, true);
    assert!(!kramers_kronig(&estimate, 0.01).unwrap().has_failed());
    // nothing that relaxes stiffens and softens by 2 % every kilohertz
    let frequency_hz: Vec<f64> = estimate.lines().iter().map(|l| l.frequency_hz).collect();
    let ratio: Vec<Complex64> = estimate
        .lines()
        .iter()
        .map(|line| {
            let wave = 1.0 + 0.01 * (line.frequency_hz / 160.0).sin();
            (-line.propagation_coefficient * 0.4 * wave).exp()
        })
        .collect();
    let freedom = vec![VarianceFreedom::new(40.0, 4.0).unwrap(); ratio.len()];
    let rod = PulsedRod {
        distance: 0.4,
        diameter: DIAMETER,
        density: DENSITY,
    };
    let wavy = SeparatePulses::new(rod)
        .unwrap()
        .estimate_ratio(&RatioLines {
            frequency_hz: &frequency_hz,
            ratio: &ratio,
            variance: &vec![NOISE * NOISE; ratio.len()],
            freedom: Some(&freedom),
            coherence: None,
            common: &[],
            lines_per_independent_line: 1.0,
        })
        .unwrap();
    assert!(kramers_kronig(&wavy, 0.01).unwrap().has_failed());
}

/// A noise of which each sensor and line has an estimate of its own, of 10 degrees of freedom:
/// right records pass.
#[test]
fn r14_noise_from_a_short_silence_fails_no_right_record() {
    let (mut kept, mut taken) = (0, 0);
    for seed in 0..30 {
        let mut random = Noise::seeded(300 + seed);
        let mut spectra = SpectraOfTest::of(&relaxing(), DISTANCES, &mut random);
        for noise in spectra.noise.iter_mut().flatten() {
            let chi_square: f64 = (0..10).map(|_| random.normal().powi(2)).sum();
            *noise *= (chi_square / 10.0).sqrt();
        }
        let gamma: Vec<Complex64> = spectra
            .frequency_hz
            .iter()
            .map(|f| relaxing().propagation_coefficient(TAU * f))
            .collect();
        let measured = GaugeSpectra {
            frequency_hz: &spectra.frequency_hz,
            tests: &[&spectra.strains],
            noise: &spectra.noise,
        };
        let check = FreeEndNull::new(rod(), DISTANCES.to_vec(), Quantity::Strain).unwrap();
        let known = check.check(&measured, &gamma, 0.01).unwrap();
        let freedom = VarianceFreedom::new(10.0, 10.0).unwrap();
        let estimated = check.with_noise_freedom(freedom).unwrap();
        let estimated = estimated.check(&measured, &gamma, 0.01).unwrap();
        kept += u32::from(known.has_failed());
        taken += u32::from(estimated.has_failed());
    }
    // taken as known, the noise fails several: 4 of 30 at the level of 1 % is once in 4000 times,
    // and 3 once in 300
    assert!(kept >= 4 && taken <= 2, "{kept} {taken}");
}

/// Three gauges with a noise that is known by a silence of a few segments: ten degrees of freedom
/// for fifteen lines.
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

/// The nearest of all materials takes up noise, a degree of freedom for each of its parameters:
/// without these the statistic is 1 on the average, and the level is kept. A dozen of 300 that are
/// not counted make it 0.98 and a false alarm at 5 % one of a hundred.
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
    // 150 records: 0.04 each
    let mean = (few.iter().map(|(mean, ..)| mean).sum::<f64>() + mean) / 5.0;
    assert!((mean - 1.0).abs() < 0.013, "{mean}");
    // 5 % of 150 and four standard deviations
    let below = few.iter().map(|(_, below, _)| below).sum::<u32>() + below;
    assert!(u64::from(below) * 25 <= 3 * 5 * seeds, "{below}");
}
