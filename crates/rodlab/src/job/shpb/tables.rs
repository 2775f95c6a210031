//! Tables of the result.

use impulse::hopkinson::{Curve, HopkinsonResult, MeanCurve};

use crate::outcome::Table;
use crate::{InStep, RodlabError};

/// Probability of the bands.
pub(super) const LEVEL: f64 = 0.95;

pub(super) fn all(result: &HopkinsonResult) -> Result<Vec<Table>, RodlabError> {
    Ok(vec![
        stress_strain(result)?,
        faces(result)?,
        waves(result),
        budget(result),
    ])
}

/// Returns the times \[µs\].
pub(super) fn microseconds(result: &HopkinsonResult) -> Vec<f64> {
    (0..result.n_samples())
        .map(|at| 1e6 * result.time_at(at))
        .collect()
}

pub(super) fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|x| factor * x).collect()
}

/// Returns the half width of the 95 % band of a history.
pub(super) fn band(
    result: &HopkinsonResult,
    curve: Curve,
    factor: f64,
) -> Result<Vec<f64>, RodlabError> {
    let band = result.expanded_uncertainty(curve, LEVEL).in_step("bands")?;
    Ok(scaled(&band, factor))
}

fn stress_strain(result: &HopkinsonResult) -> Result<Table, RodlabError> {
    let title = "Stress and strain of the specimen";
    let mut table = Table::new("stress_strain", title).numbers("time", "us", microseconds(result));
    for (name, unit, curve, factor) in [
        ("strain", "", Curve::Strain, 1.0),
        ("stress", "MPa", Curve::Stress, 1e-6),
        ("strain rate", "1/s", Curve::StrainRate, 1.0),
        ("true strain", "", Curve::TrueStrain, 1.0),
        ("true stress", "MPa", Curve::TrueStress, 1e-6),
    ] {
        let common = scaled(&result.common_error(curve), factor);
        let random = scaled(result.random.of(curve), factor);
        let width = band(result, curve, factor)?;
        table = table
            .numbers(name, unit, scaled(result.curves.of(curve), factor))
            .numbers(format!("random standard error of the {name}"), unit, random)
            .numbers(format!("common standard error of the {name}"), unit, common)
            .numbers(format!("95 % half width of the {name}"), unit, width);
    }
    Ok(table)
}

fn faces(result: &HopkinsonResult) -> Result<Table, RodlabError> {
    let title = "Forces and velocities of the faces of the specimen";
    let mut table = Table::new("faces", title).numbers("time", "us", microseconds(result));
    for (name, unit, curve) in [
        ("force of the incident face", "N", Curve::Force1),
        ("force of the transmitted face", "N", Curve::Force2),
        ("difference of the forces", "N", Curve::ForceDifference),
        ("velocity of the incident face", "m/s", Curve::Velocity1),
        ("velocity of the transmitted face", "m/s", Curve::Velocity2),
    ] {
        let width = format!("95 % half width of the {name}");
        table = table.numbers(name, unit, result.curves.of(curve)).numbers(
            width,
            unit,
            band(result, curve, 1.0)?,
        );
    }
    let index = "equilibrium index";
    let equilibrium = &result.equilibrium;
    let error = format!("standard error of the {index}");
    Ok(table
        .numbers(index, "", &equilibrium.index)
        .numbers(error, "", &equilibrium.standard_error))
}

fn waves(result: &HopkinsonResult) -> Table {
    let title = "Strain waves at the faces of the specimen, positive in tension";
    let mut table = Table::new("waves", title).numbers("time", "us", microseconds(result));
    for (name, curve) in [
        ("incident wave", Curve::IncidentWave),
        ("reflected wave", Curve::ReflectedWave),
        ("transmitted wave", Curve::TransmittedWave),
    ] {
        table = table.numbers(name, "", result.curves.of(curve));
    }
    table
}

/// Returns the table of the error due to each source, at the largest stress and as the largest
/// value during loading.
fn budget(result: &HopkinsonResult) -> Table {
    let peak = peak(result);
    let mut names = vec!["noise".to_owned()];
    names.extend(result.common.iter().map(|source| source.source.to_string()));
    let of = |curve: Curve, factor: f64, pick: &dyn Fn(&[f64]) -> f64| -> Vec<f64> {
        let random = std::iter::once(result.random.of(curve));
        random
            .chain(result.common.iter().map(|source| source.on(curve)))
            .map(|effect| factor * pick(effect))
            .collect()
    };
    let at_peak = |effect: &[f64]| effect.get(peak).copied().unwrap_or(f64::NAN);
    let largest = |effect: &[f64]| {
        let loaded = effect.get(result.loaded.clone()).unwrap_or(&[]);
        loaded.iter().fold(0.0_f64, |most, x| most.max(x.abs()))
    };
    let at_stress = of(Curve::Stress, 1e-6, &at_peak);
    let at_strain = of(Curve::Strain, 1.0, &at_peak);
    let of_forces = of(Curve::ForceDifference, 1.0, &largest);
    Table::new("budget", "Standard errors by source")
        .words("source", names)
        .numbers("error of the largest stress", "MPa", at_stress)
        .numbers("error of the strain at this stress", "", at_strain)
        .numbers(
            "largest error of the stress",
            "MPa",
            of(Curve::Stress, 1e-6, &largest),
        )
        .numbers(
            "largest error of the strain",
            "",
            of(Curve::Strain, 1.0, &largest),
        )
        .numbers("largest error of the force difference", "N", of_forces)
}

/// Returns the half width of the 95 % band of the mean stress.
pub(super) fn band_of_mean(mean: &MeanCurve) -> Result<Vec<f64>, RodlabError> {
    mean.expanded_uncertainty(LEVEL).in_step("bands")
}

/// Returns the sample of the largest stress.
pub(super) fn peak(result: &HopkinsonResult) -> usize {
    let mut peak = (0, f64::NEG_INFINITY);
    for (at, stress) in result.curves.of(Curve::Stress).iter().enumerate() {
        if *stress > peak.1 {
            peak = (at, *stress);
        }
    }
    peak.0
}
