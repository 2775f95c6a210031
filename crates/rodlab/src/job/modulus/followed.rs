//! Uncertainties of the specimen and its sections that a method propagates to the modulus, and
//! refusal of the others.

use super::method::{MethodSheet, SectionSheet};
use super::{ModulusSheet, SpecimenSheet};
use crate::RodlabError;
use crate::sheet::Stated;

/// Refuses an uncertainty that the method of `sheet` does not propagate.
pub(super) fn check(sheet: &ModulusSheet) -> Result<(), RodlabError> {
    let specimen = &sheet.specimen;
    let unused = |method: &str| format!("{method} does not use it");
    let name = sheet.method.name();
    match &sheet.method {
        MethodSheet::TwoPoint { .. }
        | MethodSheet::Resonances { .. }
        | MethodSheet::FreeVibration { .. } => diameter(specimen, name),
        MethodSheet::FreeEnd { first, second, .. } => {
            on_the_end(first, "method.first")?;
            on_the_end(second, "method.second")?;
            diameter(specimen, name)?;
            exact(specimen.length.as_ref(), "specimen.length", &unused(name))
        }
        MethodSheet::OneGauge { section, .. } => {
            on_the_end(section, "method.section")?;
            diameter(specimen, name)?;
            exact(specimen.length.as_ref(), "specimen.length", &unused(name))
        }
        MethodSheet::SeparatePulses { .. }
        | MethodSheet::ThreePoint { .. }
        | MethodSheet::MultiPoint { .. } => {
            exact(specimen.length.as_ref(), "specimen.length", &unused(name))?;
            let mass = specimen.accelerometer_mass.as_ref();
            let is_used = sheet.method.used_free_end().is_some();
            if !is_used {
                exact(
                    mass,
                    "specimen.accelerometer_mass",
                    &format!("{name} does not follow it"),
                )?;
            }
            // the diameter acts through that mass alone
            if !(is_used && mass.is_some_and(|mass| mass.with_uncertainty().value > 0.0)) {
                exact(
                    Some(&specimen.diameter),
                    "specimen.diameter",
                    &format!(
                        "{name} does not follow it: the modulus of a thin rod does not depend on it, and of lateral inertia only Poisson's ratio is followed"
                    ),
                )?;
            }
            let MethodSheet::MultiPoint {
                gauges,
                free_end_at,
                ..
            } = &sheet.method
            else {
                return Ok(());
            };
            if gauges.len() == 2 && !is_used {
                return Err(RodlabError::request(
                    "method.gauges",
                    "2 gauges",
                    "three or more, or two and the position of a free end in `free_end_at`",
                ));
            }
            exact(
                free_end_at.as_ref().filter(|_| !is_used),
                "method.free_end_at",
                "three or more gauges are checked against an exact end",
            )
        }
    }
}

fn exact<K>(stated: Option<&Stated<K>>, field: &str, why: &str) -> Result<(), RodlabError> {
    stated.map_or(Ok(()), |stated| stated.exact(field, why).map(|_| ()))
}

/// Checks the diameter, which acts only through the mass on the end.
fn diameter(specimen: &SpecimenSheet, method: &str) -> Result<(), RodlabError> {
    let mass = specimen.accelerometer_mass.as_ref();
    if mass.is_some_and(|mass| mass.with_uncertainty().value > 0.0) {
        return Ok(());
    }
    let why = format!("without a mass on the end {method} does not follow it");
    exact(Some(&specimen.diameter), "specimen.diameter", &why)
}

/// Checks a sensor on the end itself.
fn on_the_end(section: &SectionSheet, field: &str) -> Result<(), RodlabError> {
    if section.from_free_end.with_uncertainty().value > 0.0 {
        return Ok(());
    }
    let why =
        "the errors are followed of distances above 0 alone, not of a sensor on the end itself";
    exact(
        Some(&section.from_free_end),
        &format!("{field}.from_free_end"),
        why,
    )
}
