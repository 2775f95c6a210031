//! 180 standard samples, sixty of each law of paper D, for one test of its size.
#![allow(
    clippy::unwrap_used,
    clippy::missing_docs_in_private_items,
    missing_docs,
    reason = "a benchmark"
)]

use criterion::{Criterion, criterion_group, criterion_main};
use maxwellid::samples::{Pattern, StandardSamples};
use maxwellid::selection::Candidate;
use maxwellid::{Law, Provenance, RodTest, RodTestData};
use rodwave::InelasticRod;
use rodwave::band_limited::SampledHistory;
use rodwave::inelastic::Maxwell;
use rodwave::lumped::{self, LumpedRod};

fn standard_samples(c: &mut Criterion) {
    let rate = 51_200.0;
    let excitation: Vec<f64> = (0..160)
        .map(|k| 8.0 * (-((f64::from(k) - 35.0) / 4.0_f64).powi(2)).exp())
        .collect();
    let times: Vec<f64> = (0..160).map(|k| f64::from(k) / rate).collect();
    let rod = InelasticRod::new(0.394, 912.0, 2.6e9, Maxwell::new(4e6).unwrap()).unwrap();
    let response = LumpedRod::new(&rod, 400, 0.5)
        .unwrap()
        .free_end_velocity(&SampledHistory::new(&excitation, rate).unwrap(), &times)
        .unwrap();
    let test = RodTest::new(RodTestData {
        name: "polypropylene".into(),
        length: 0.394,
        density: 912.0,
        impact_velocity: 10.0,
        sampling_rate_hz: rate,
        excitation,
        response,
        provenance: Provenance::Virtual {
            generator: lumped::GENERATOR.into(),
        },
    })
    .unwrap();
    let laws = [Law::Maxwell, Law::Norton, Law::GurevichRabinovich].map(Candidate::of);
    c.bench_function("180 standard samples", |b| {
        b.iter(|| StandardSamples::of(&laws, std::slice::from_ref(&test), 60, Pattern::Absolute));
    });
}

criterion_group!(benches, standard_samples);
criterion_main!(benches);
