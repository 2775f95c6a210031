//! Refusal of uncertainties of the specimen and its sections that a method does not propagate to
//! the modulus.

use super::ModulusSheet;
use super::method::{MethodSheet, SectionSheet};
use crate::RodlabError;
use crate::sheet::Stated;

/// Refuses an uncertainty that the method of `sheet` does not propagate.
pub(super) fn check(sheet: &ModulusSheet) -> Result<(), RodlabError> {
    let (specimen, method) = (&sheet.specimen, &sheet.method);
    let name = method.words();
    for (section, field) in method.sections() {
        on_the_end(section, &field)?;
    }
    let used = method.use_of_specimen();
    if !used.length {
        let why = format!("it is not used by {name}");
        exact(specimen.length.as_ref(), "specimen.length", &why)?;
    }
    let mass = specimen.accelerometer_mass.as_ref();
    if !used.end_mass {
        let why = format!("it is not propagated by {name}");
        exact(mass, "specimen.accelerometer_mass", &why)?;
    }
    // the diameter matters only for the ratio of the mass on the free end to the mass of the rod,
    // and for the correction of lateral inertia
    let has_mass = mass.is_some_and(|mass| mass.with_uncertainty().value > 0.0);
    let asked = sheet.lateral_inertia.as_ref();
    let is_corrected =
        asked.is_some_and(|asked| asked.poisson_ratio.with_uncertainty().value > 0.0);
    if !((used.end_mass && has_mass) || is_corrected) {
        let why = "with neither a mass on the free end nor a correction of lateral inertia the modulus does not depend on the diameter";
        exact(Some(&specimen.diameter), "specimen.diameter", why)?;
    }
    free_end(method)
}

/// Refuses two gauges without a free end, and an uncertainty of a free end that the method does not
/// use.
fn free_end(method: &MethodSheet) -> Result<(), RodlabError> {
    let MethodSheet::MultiPoint {
        gauges,
        free_end_at,
        ..
    } = method
    else {
        return Ok(());
    };
    let is_used = method.used_free_end().is_some();
    if gauges.len() == 2 && !is_used {
        return Err(RodlabError::request(
            "method.multi_point.gauges",
            "2 gauges",
            "three or more, or two and the position of a free end in `free_end_at`",
        ));
    }
    exact(
        free_end_at.as_ref().filter(|_| !is_used),
        "method.multi_point.free_end_at",
        "three or more gauges are checked against an exact end",
    )
}

fn exact<K>(stated: Option<&Stated<K>>, field: &str, why: &str) -> Result<(), RodlabError> {
    stated.map_or(Ok(()), |stated| stated.exact(field, why).map(|_| ()))
}

/// Refuses an uncertainty of the position of a sensor at the end itself.
fn on_the_end(section: &SectionSheet, field: &str) -> Result<(), RodlabError> {
    if section.from_free_end.with_uncertainty().value > 0.0 {
        return Ok(());
    }
    let why =
        "errors are propagated only for distances above 0, not for a sensor on the end itself";
    exact(
        Some(&section.from_free_end),
        &format!("{field}.from_free_end"),
        why,
    )
}
