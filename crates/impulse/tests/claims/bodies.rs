//! Bodies whose mobilities have a closed form.

use std::f64::consts::FRAC_PI_4;

use impulse::{MobilityLaw, Prediction};
use num_complex::Complex64;
use rodwave::chain::{AnalyticChain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::Elastic;

use testbed::claim::Ours;
use testbed::difference::largest;

pub(super) const STEEL_MODULUS: f64 = 206e9;
pub(super) const STEEL_DENSITY: f64 = 7780.0;

pub(super) fn steel() -> Ours<Medium<Elastic>> {
    Ok(Medium::new(STEEL_DENSITY, Elastic::new(STEEL_MODULUS)?)?)
}

/// A √(Eρ) of a steel rod.
pub(super) fn impedance(diameter: f64) -> f64 {
    FRAC_PI_4 * diameter * diameter * (STEEL_MODULUS * STEEL_DENSITY).sqrt()
}

pub(super) fn wave_speed() -> f64 {
    (STEEL_MODULUS / STEEL_DENSITY).sqrt()
}

/// A free rod of steel.
pub(super) fn rod(diameter: f64, length: f64) -> Ours<AnalyticChain> {
    let section = Circle::of_diameter(diameter)?;
    Ok(AnalyticChain::analytic_from_impact_face()
        .rod(&steel()?, section, length)
        .end(Termination::Free)?)
}

/// A semi-infinite rod of steel.
pub(super) fn endless_rod(diameter: f64) -> Ours<AnalyticChain> {
    let section = Circle::of_diameter(diameter)?;
    Ok(AnalyticChain::analytic_from_impact_face()
        .end(Termination::semi_infinite(&steel()?, section))?)
}

/// A rigid body that is free to move.
pub(super) fn mass(kilograms: f64) -> Ours<MobilityLaw<impl Fn(Complex64) -> Complex64>> {
    Ok(MobilityLaw::analytic(move |s| 1.0 / (kilograms * s)).free(kilograms)?)
}

/// Largest deviation of the force from `exact` \[N\], more than `away` steps from every one of
/// `jumps`.
pub(super) fn deviation(
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
