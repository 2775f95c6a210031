//! Rod, uncertainties and limits of the sheet, in the form used by the methods of `cmod`.

use cmod::validity::AcceptanceLimits;
use cmod::{GaugedRod, RodWithFreeEnd, SectionUncertainty};

use super::ModulusSheet;
use super::method::{Counted, GaugeSheet};
use crate::RodlabError;
use crate::digits::significant;
use crate::sheet::{Exact, Ratio, Stated, plausible};

/// Refuses a density outside the range of solids, and a diameter that is not below the length of
/// the rod or the distance between its sections.
pub(super) fn check(sheet: &ModulusSheet) -> Result<(), RodlabError> {
    plausible::density(&sheet.specimen.density, "specimen.density")?;
    let extent = match sheet.method.counted() {
        Counted::Gauges(gauges) => {
            let positions = gauges.iter().map(|gauge| gauge.at.with_uncertainty().value);
            let ends = positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                (low.min(at), high.max(at))
            });
            ends.1 - ends.0
        }
        // a missing length is reported where the length is needed
        _ => match distance(sheet) {
            Ok(distance) => distance,
            Err(_) => return Ok(()),
        },
    };
    let diameter = &sheet.specimen.diameter;
    if diameter.with_uncertainty().value < extent || extent.is_nan() || extent <= 0.0 {
        return Ok(());
    }
    Err(RodlabError::request(
        "specimen.diameter",
        format!("`{diameter}`"),
        format!(
            "a rod: a diameter below the {} m of its length or between its sections",
            significant(extent, 4)
        ),
    ))
}

/// Returns the length of the specimen \[m\]; an error if it is not stated.
pub(super) fn length(sheet: &ModulusSheet) -> Result<f64, RodlabError> {
    sheet
        .specimen
        .length
        .as_ref()
        .map(|length| length.with_uncertainty().value)
        .ok_or_else(|| {
            RodlabError::request(
                "specimen.length",
                "missing",
                format!("the length, which {} needs", sheet.method.name()),
            )
        })
}

/// Returns the distance over which wavelengths are counted \[m\].
pub(super) fn distance(sheet: &ModulusSheet) -> Result<f64, RodlabError> {
    match sheet.method.counted() {
        Counted::Length => length(sheet),
        Counted::Between(distance) => Ok(distance),
        Counted::Gauges(gauges) => Ok(gauged_rod(sheet, gauges).least_distance()),
    }
}

pub(super) fn rod_with_free_end(sheet: &ModulusSheet) -> RodWithFreeEnd {
    RodWithFreeEnd {
        diameter: sheet.specimen.diameter.with_uncertainty().value,
        density: sheet.specimen.density.with_uncertainty().value,
        end_mass: end_mass(sheet),
    }
}

pub(super) fn gauged_rod(sheet: &ModulusSheet, gauges: &[GaugeSheet]) -> GaugedRod {
    GaugedRod {
        positions: gauges
            .iter()
            .map(|gauge| gauge.at.with_uncertainty().value)
            .collect(),
        diameter: sheet.specimen.diameter.with_uncertainty().value,
        density: sheet.specimen.density.with_uncertainty().value,
    }
}

/// Returns the mass on the free end \[kg\].
pub(super) fn end_mass(sheet: &ModulusSheet) -> f64 {
    let mass = sheet.specimen.accelerometer_mass.as_ref();
    mass.map_or(0.0, |mass| mass.with_uncertainty().value)
}

pub(super) fn section_uncertainty(sheet: &ModulusSheet, distance: f64) -> SectionUncertainty {
    SectionUncertainty {
        distance,
        diameter: uncertainty(Some(&sheet.specimen.diameter)),
        density: uncertainty(Some(&sheet.specimen.density)),
        end_mass: uncertainty(sheet.specimen.accelerometer_mass.as_ref()),
    }
}

pub(super) fn uncertainty<K>(stated: Option<&Stated<K>>) -> f64 {
    stated.map_or(0.0, |stated| stated.with_uncertainty().uncertainty())
}

pub(super) fn limits(sheet: &ModulusSheet) -> AcceptanceLimits {
    let default = AcceptanceLimits::default();
    let or =
        |stated: &Option<Exact<Ratio>>, default: f64| stated.as_ref().map_or(default, Exact::si);
    AcceptanceLimits {
        storage_modulus: or(&sheet.limits.storage_modulus, default.storage_modulus),
        loss_factor: or(&sheet.limits.loss_factor, default.loss_factor),
        common_storage_modulus: or(
            &sheet.limits.common_storage_modulus,
            default.common_storage_modulus,
        ),
        greatest_poisson_ratio: default.greatest_poisson_ratio,
        error_amplification: or(
            &sheet.limits.error_amplification,
            default.error_amplification,
        ),
        coherence: or(&sheet.limits.coherence, default.coherence),
    }
}
