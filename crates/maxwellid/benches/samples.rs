//! 180 standard samples, sixty of each law of paper D, for one test of the size used there.
#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use criterion::{Criterion, criterion_group, criterion_main};
use maxwellid::samples::{Pattern, StandardSamples};
use maxwellid::selection::Candidate;
use maxwellid::{Law, Provenance, RodTest, RodTestData};
use rodwave::InelasticRod;
use rodwave::inelastic::Maxwell;
use rodwave::lumped;
use testbed::struck_rod::{driven_by_samples, pulse};

fn standard_samples(c: &mut Criterion) {
    let rate = 51_200.0;
    let excitation = pulse(160, 35.0, 4.0);
    let rod = InelasticRod::new(0.394, 912.0, 2.6e9, Maxwell::new(4e6).unwrap()).unwrap();
    let response = driven_by_samples(&rod, 400, &excitation, rate).unwrap();
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
