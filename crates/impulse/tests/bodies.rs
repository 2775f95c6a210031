//! Bodies whose mobilities have a closed form, the nylon of paper E, and comparisons of forces.

use std::f64::consts::FRAC_PI_4;

use impulse::{
    ForceHistory, ImpactBody, LowFrequency, MeasuredBody, MobilityLaw, Prediction, WeighedMass,
    lines_of,
};
use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Chain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::{Elastic, PowerLawPropagation};
use testbed::difference::largest;

pub(crate) const STEEL_MODULUS: f64 = 206e9;
pub(crate) const STEEL_DENSITY: f64 = 7780.0;

pub(crate) fn steel() -> Medium<Elastic> {
    Medium::new(STEEL_DENSITY, Elastic::new(STEEL_MODULUS).unwrap()).unwrap()
}

/// Nylon by the power laws of paper E, eq. 7, which are known on the frequency axis only.
pub(crate) fn nylon() -> Medium<PowerLawPropagation> {
    let law = PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970).unwrap();
    Medium::new(1150.0, law).unwrap()
}

pub(crate) fn circle(diameter: f64) -> Circle {
    Circle::of_diameter(diameter).unwrap()
}

/// A √(Eρ) of a steel rod.
pub(crate) fn impedance(diameter: f64) -> f64 {
    FRAC_PI_4 * diameter * diameter * (STEEL_MODULUS * STEEL_DENSITY).sqrt()
}

pub(crate) fn wave_speed() -> f64 {
    (STEEL_MODULUS / STEEL_DENSITY).sqrt()
}

/// A free rod of steel.
pub(crate) fn rod(diameter: f64, length: f64) -> AnalyticChain {
    AnalyticChain::analytic_from_impact_face()
        .rod(&steel(), circle(diameter), length)
        .end(Termination::Free)
        .unwrap()
}

/// A semi-infinite rod of steel.
pub(crate) fn endless_rod(diameter: f64) -> AnalyticChain {
    AnalyticChain::analytic_from_impact_face()
        .end(Termination::semi_infinite(&steel(), circle(diameter)))
        .unwrap()
}

/// A free rod of nylon.
pub(crate) fn nylon_rod(diameter: f64, length: f64) -> Chain {
    Chain::from_impact_face()
        .rod(&nylon(), circle(diameter), length)
        .end(Termination::Free)
        .unwrap()
}

/// A semi-infinite rod of this impedance.
pub(crate) fn long_rod(impedance: f64) -> MobilityLaw<impl Fn(Complex64) -> Complex64> {
    MobilityLaw::analytic(move |_| Complex64::from(1.0 / impedance))
}

/// A rigid body that is free to move.
pub(crate) fn mass(kilograms: f64) -> MobilityLaw<impl Fn(Complex64) -> Complex64> {
    MobilityLaw::analytic(move |s| 1.0 / (kilograms * s))
        .free(kilograms)
        .unwrap()
}

/// A body that does not move.
pub(crate) fn wall() -> MobilityLaw<impl Fn(Complex64) -> Complex64> {
    MobilityLaw::analytic(|_| Complex64::ZERO)
}

/// A free body given by its exact lines, with its mass and its front impedance.
pub(crate) fn on_lines(
    body: &dyn ImpactBody,
    front: f64,
    step_hz: f64,
    n_lines: usize,
) -> MeasuredBody {
    let weighed = LowFrequency::Free(WeighedMass {
        mass: body.free_mass().unwrap(),
        standard_error: 0.0,
    });
    let lines = lines_of(body, step_hz, n_lines).unwrap();
    let body = MeasuredBody::from_mobility(&lines, step_hz, weighed).unwrap();
    body.with_front_impedance(front).unwrap()
}

/// The force at `time` by linear interpolation between samples; `None` after the last sample.
pub(crate) fn between_samples(history: &ForceHistory, time: f64) -> Option<f64> {
    let position = (time - history.time_at(0)) / history.time_step();
    let before = position.floor() as usize;
    match history.force().get(before..before + 2)? {
        [from, to] => Some(from + (position - before as f64) * (to - from)),
        _ => None,
    }
}

/// Largest deviation of the force from `exact` \[N\], more than `away` steps from every one of
/// `jumps`.
pub(crate) fn deviation(
    prediction: &Prediction,
    jumps: &[f64],
    away: f64,
    exact: impl Fn(f64) -> f64,
) -> f64 {
    let history = &prediction.history;
    let step = history.time_step();
    let far = |time: f64| jumps.iter().all(|jump| (time - jump).abs() > away * step);
    let samples = history.force().iter().enumerate();
    largest(
        samples
            .map(|(index, force)| (history.time_at(index), force))
            .filter(|(time, _)| far(*time))
            .map(|(time, force)| (force - exact(time)).abs()),
    )
}
