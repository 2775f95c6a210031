//! Tests of properties that every struck rod has, and of arguments at the ends of the
//! floating-point range.

mod extremes_values;
#[path = "../../rodwave/tests/hard_to_break/hostile.rs"]
mod hostile;
mod properties_differentiators;
mod properties_fits;
mod properties_models;

use maxwellid::{Provenance, RodModel, RodTest, RodTestData};

pub(crate) const LENGTH: f64 = 0.4;
pub(crate) const DENSITY: f64 = 1100.0;
pub(crate) const MODULUS: f64 = 2.6e9;
pub(crate) const RATE: f64 = 51_200.0;
pub(crate) const V0: f64 = 10.0;

/// Returns an excitation that rises over eight samples after 32 samples at rest, and then varies
/// slowly by 10 %.
pub(crate) fn excitation(velocity: f64) -> Vec<f64> {
    (0..176)
        .map(|k| {
            let since = f64::from(k) - 32.0;
            let rise = 0.5 - 0.5 * (std::f64::consts::PI * (since / 8.0).clamp(0.0, 1.0)).cos();
            velocity * rise * (1.0 + 0.1 * (0.08 * since.max(0.0)).sin())
        })
        .collect()
}

pub(crate) fn data(velocity: f64, response: Vec<f64>) -> RodTestData {
    RodTestData {
        name: format!("{velocity} m/s"),
        length: LENGTH,
        density: DENSITY,
        impact_velocity: velocity,
        sampling_rate_hz: RATE,
        excitation: excitation(velocity),
        response,
        provenance: Provenance::Virtual {
            generator: "tests".into(),
        },
    }
}

/// Returns a test whose response is computed by the model itself, with cells of 3 mm that no fit
/// uses.
pub(crate) fn test_of(model: &impl RodModel, parameters: &[f64], velocity: f64) -> RodTest {
    let excitation = excitation(velocity);
    let frame = RodTest::new(data(velocity, vec![0.0; excitation.len()])).unwrap();
    let times = frame.times();
    let mut response = model
        .response(&frame.driven_rod(&times, 3e-3), parameters)
        .unwrap();
    response.resize(excitation.len(), *response.last().unwrap());
    RodTest::new(data(velocity, response)).unwrap()
}
