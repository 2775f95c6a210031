//! Virtual tests simulated by the lumped chain or by `rodwave::line`, and by striker, rod and
//! recorder in physical order.

use maxwellid::selection::{Candidate, Comparison, Decision, Selection};
use maxwellid::{Provenance, RodTest, RodTestData};
use rodwave::InelasticRod;
use rodwave::band_limited::{Recorder, SampledHistory};
use rodwave::experiment::{Acquisition, VelocityRecord};
use rodwave::inelastic::{InelasticLaw, Maxwell, MaxwellNorton};
use rodwave::line::{self, Segment};
use rodwave::lumped::{self, LumpedRod};
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};
use testbed::noise::Noise;
use testbed::struck_rod::{self, StruckRod, by_line};

pub(crate) const DENSITY: f64 = 912.0;
pub(crate) const MODULUS: f64 = 2.6e9;
pub(crate) const LENGTH: f64 = 0.394;
const REFERENCE_OMEGA: f64 = std::f64::consts::TAU * 4e3;

const ACQUISITION: Acquisition = Acquisition {
    recorder: Recorder {
        rate_hz: 51_200.0,
        cutoff_hz: 16_000.0,
    },
    samples_before: 32,
    samples_after: 128,
    transducer_range: 0.020,
};

/// A test without noise.
#[derive(Clone)]
pub(crate) struct Exact {
    pub(crate) velocity: f64,
    pub(crate) excitation: Vec<f64>,
    pub(crate) response: Vec<f64>,
    pub(crate) generator: &'static str,
    rate_hz: f64,
}

impl Exact {
    fn by_the_chain(velocity: f64, excitation: Vec<f64>, response: Vec<f64>) -> Self {
        Self {
            velocity,
            excitation,
            response,
            generator: lumped::GENERATOR,
            rate_hz: ACQUISITION.recorder.rate_hz,
        }
    }

    /// Returns both histories as recorded.
    fn in_order(velocity: f64, record: VelocityRecord) -> Self {
        Self {
            velocity,
            excitation: record.excitation,
            response: record.response,
            generator: "characteristics of striker and rod",
            rate_hz: record.sampling_rate_hz,
        }
    }
}

fn rod<L: InelasticLaw>(law: &L, velocity: f64) -> StruckRod<L> {
    StruckRod::of_16_mm(law, velocity, LENGTH, DENSITY, MODULUS, ACQUISITION)
}

/// A test sampled four times as fast as the filter of the recorder requires, so that three quarters
/// of the frequencies have no signal, with noise of `level` V0.
pub(crate) fn sampled_fast<L: InelasticLaw>(law: &L, level: f64, seed: u64) -> RodTest {
    let velocity = 10.0;
    let rod = StruckRod {
        acquisition: Acquisition {
            recorder: Recorder {
                rate_hz: 204_800.0,
                ..ACQUISITION.recorder
            },
            samples_before: 80,
            samples_after: 400,
            ..ACQUISITION
        },
        ..rod(law, velocity)
    };
    let exact = Exact::in_order(velocity, rod.record().unwrap());
    noisy(&exact, level, seed)
}

fn times(record: &VelocityRecord) -> Vec<f64> {
    struck_rod::times(record.excitation.len(), record.sampling_rate_hz)
}

/// A test with the lumped chain's response to the filtered excitation, because the filter of a
/// recorder does not commute with a nonlinear rod.
pub(crate) fn by_the_chain<L: InelasticLaw>(law: &L, velocity: f64) -> Exact {
    let rod = rod(law, velocity);
    let record = rod.record().unwrap();
    let response = rod.by_chain(400, &record.excitation_before_sampling, &times(&record));
    Exact::by_the_chain(velocity, record.excitation, response.unwrap())
}

/// A test like that of [`by_the_chain`], of a standard solid: a branch of `law` in parallel with a
/// spring that has the fraction `share` of the modulus.
pub(crate) fn with_spring<L: InelasticLaw>(law: &L, share: f64, velocity: f64) -> Exact {
    let mut test = rod(law, velocity).test().unwrap();
    test.rod = test.rod.with_spring(share).unwrap();
    let record = test.record(&ACQUISITION, 1e-3).unwrap();
    let driven = InelasticRod::new(LENGTH, DENSITY, MODULUS, law.clone()).unwrap();
    let driven = driven.with_spring(share).unwrap();
    let response = LumpedRod::new(&driven, 400, 0.5)
        .unwrap()
        .free_end_velocity(&record.excitation_before_sampling, &times(&record));
    Exact::by_the_chain(velocity, record.excitation, response.unwrap())
}

/// A Prony series with the relaxation spectrum of the spring-pot in steps of a third of a decade.
/// Its loss factor is `loss_factor` within 1 % of itself from 0.2 to 20 kHz, and its modulus has
/// the magnitude [`MODULUS`] at 4 kHz.
pub(crate) fn constant_q_stack(loss_factor: f64) -> GeneralisedMaxwell {
    let exponent = std::f64::consts::FRAC_2_PI * f64::atan(loss_factor);
    let pi = std::f64::consts::PI;
    let step = 10.0_f64.ln() / 3.0;
    let strength = MODULUS * (pi * exponent).sin() / pi;
    let times: Vec<f64> = (0..22)
        .map(|k| 1e-8 * (step * f64::from(k)).exp())
        .collect();
    let slowest = times[times.len() - 1] * (0.5 * step).exp();
    let branches = times
        .into_iter()
        .map(|relaxation_time| MaxwellBranch {
            modulus: strength * step * (REFERENCE_OMEGA * relaxation_time).powf(-exponent),
            relaxation_time,
        })
        .collect();
    // the spring represents slower branches, which do not relax within the record
    let spring = strength / exponent * (REFERENCE_OMEGA * slowest).powf(-exponent);
    GeneralisedMaxwell::new(spring, branches).unwrap()
}

/// A test with the response of `rodwave::line`, with parallel branches, to the filtered excitation.
pub(crate) fn by_the_line(material: &GeneralisedMaxwell, velocity: f64) -> Exact {
    of_segment(
        Segment::prony(LENGTH, 1e-4, DENSITY, material).unwrap(),
        velocity,
        1.5e-6,
    )
}

/// A test like that of [`by_the_line`], of a linear `material` in parallel with a branch of
/// Norton's `law` with the modulus `modulus` \[Pa\]. The step is short, because linear branches
/// that relax within a step of the line dissipate too much: with steps of 1.5 us loss factor and
/// rate would be off by 9 and 40 standard errors.
pub(crate) fn beside_a_branch(
    material: &GeneralisedMaxwell,
    (modulus, law): (f64, MaxwellNorton),
    velocity: f64,
) -> Exact {
    let segment = Segment::prony(LENGTH, 1e-4, DENSITY, material).unwrap();
    of_segment(segment.with_branch(modulus, law).unwrap(), velocity, 1e-7)
}

fn of_segment(segment: Segment, velocity: f64, step: f64) -> Exact {
    // the excitation of a rod of nearly the same damping
    let rod = rod(&Maxwell::new(4e6).unwrap(), velocity);
    let record = rod.record().unwrap();
    let excitation = &record.excitation_before_sampling;
    Exact {
        response: by_line(segment, excitation, &times(&record), step).unwrap(),
        generator: line::GENERATOR,
        ..Exact::in_order(velocity, record)
    }
}

fn with_white_noise(exact: &Exact, level: f64, seed: u64) -> RodTest {
    let mut noise = Noise::seeded(seed);
    let mut with_noise = |samples: &[f64]| noise.added_to(samples, level * exact.velocity);
    RodTest::new(RodTestData {
        name: format!("{} m/s", exact.velocity),
        length: LENGTH,
        density: DENSITY,
        impact_velocity: exact.velocity,
        sampling_rate_hz: exact.rate_hz,
        excitation: with_noise(&exact.excitation),
        response: with_noise(&exact.response),
        provenance: Provenance::Virtual {
            generator: exact.generator.into(),
        },
    })
    .unwrap()
}

/// Adds white noise of `level` V0 to both histories, and states it.
pub(crate) fn noisy(exact: &Exact, level: f64, seed: u64) -> RodTest {
    with_white_noise(exact, level, seed)
        .with_noise(level * exact.velocity, level * exact.velocity)
        .unwrap()
}

pub(crate) fn without_stated_noise(exact: &Exact) -> RodTest {
    with_white_noise(exact, 0.01, 1)
}

/// Compares the candidates on tests with noise of 1 % of V0 on both histories. With cells of 8 mm
/// the error of the scheme is less than 1e-3 of V0, a tenth of the noise.
pub(crate) fn compare(candidates: Vec<Candidate>, exact: &[Exact], seed: u64) -> Comparison {
    let count = u64::try_from(exact.len()).unwrap();
    let tests: Vec<_> = exact
        .iter()
        .zip(0..)
        .map(|(exact, k)| noisy(exact, 0.01, count * seed + k))
        .collect();
    Selection::new(candidates)
        .unwrap()
        .with_cell(8e-3)
        .unwrap()
        .compare(&tests)
        .unwrap()
}

/// The law that is named, `cannot tell` or `none`.
pub(crate) fn named(comparison: &Comparison) -> String {
    match &comparison.decision {
        Decision::Law { candidate, .. } => comparison.laws[*candidate].name.clone(),
        Decision::NoneOfThese { .. } => "none".into(),
        _ => "cannot tell".into(),
    }
}

/// Returns the results of `of` for all cases, in their order, computed on two threads.
pub(crate) fn in_parallel<T: Sync, R: Send>(cases: &[T], of: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let half = cases.len().div_ceil(2).max(1);
    std::thread::scope(|scope| {
        let parts: Vec<_> = cases
            .chunks(half)
            .map(|part| scope.spawn(|| part.iter().map(&of).collect::<Vec<R>>()))
            .collect();
        parts
            .into_iter()
            .flat_map(|part| part.join().unwrap())
            .collect()
    })
}

/// A test in physical order: striker, rod, filter, sampling. Both histories pass through the
/// recorder.
pub(crate) fn in_order<L: InelasticLaw>(law: &L, velocity: f64) -> Exact {
    Exact::in_order(velocity, rod(law, velocity).record().unwrap())
}

/// A test with a rounded striker: the excitation is that of a flat striker, smoothed by a normal
/// density of `deviation` \[s\]. The lumped chain is driven by these samples, so that no filter
/// acts on the excitation.
pub(crate) fn rounded<L: InelasticLaw>(law: &L, velocity: f64, deviation: f64) -> Exact {
    let rod = rod(law, velocity);
    let record = rod.record().unwrap();
    let times = times(&record);
    let excitation = struck_rod::rounded(&record.excitation_before_sampling, &times, deviation);
    let driven = SampledHistory::new(&excitation, record.sampling_rate_hz).unwrap();
    let response = rod.by_chain(400, &driven, &times).unwrap();
    Exact::by_the_chain(velocity, excitation, response)
}
