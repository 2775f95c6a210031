//! Rod, sections, gauges, uncertainties and limits of the sheet, in the form used by the methods of
//! `cmod`.

use cmod::estimate::VarianceFreedom;
use cmod::multi_point::Quantity;
use cmod::validity::AcceptanceLimits;
use cmod::{
    CmodError, EndSection, GaugeUncertainty, GaugedRod, RodWithFreeEnd, SectionUncertainty,
};
use labio::{SectionSpectra, SensorError};

use super::{Counted, GaugeSheet, SectionSheet};
use crate::RodlabError;
use crate::digits::significant;
use crate::job::modulus::ModulusSheet;
use crate::sheet::{Exact, Ratio, Stated, plausible};

/// Refuses a density outside the range of solids, and a diameter that is not below the length of
/// the rod or the distance between its sections.
pub(in crate::job::modulus) fn check(sheet: &ModulusSheet) -> Result<(), RodlabError> {
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
            "a rod: a diameter below {} m, its length or the distance between its sections",
            significant(extent, 4)
        ),
    ))
}

/// Returns the length of the specimen \[m\]; an error if it is not stated.
pub(in crate::job::modulus) fn length(sheet: &ModulusSheet) -> Result<f64, RodlabError> {
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
pub(in crate::job::modulus) fn distance(sheet: &ModulusSheet) -> Result<f64, RodlabError> {
    match sheet.method.counted() {
        Counted::Length => length(sheet),
        Counted::Between(distance) => Ok(distance),
        Counted::Gauges(gauges) => Ok(gauged_rod(sheet, gauges).least_distance()),
    }
}

pub(in crate::job::modulus) fn rod_with_free_end(sheet: &ModulusSheet) -> RodWithFreeEnd {
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

pub(in crate::job::modulus) fn section_uncertainty(
    sheet: &ModulusSheet,
    distance: f64,
) -> SectionUncertainty {
    SectionUncertainty {
        distance,
        diameter: uncertainty(Some(&sheet.specimen.diameter)),
        density: uncertainty(Some(&sheet.specimen.density)),
        end_mass: uncertainty(sheet.specimen.accelerometer_mass.as_ref()),
    }
}

pub(in crate::job::modulus) fn uncertainty<K>(stated: Option<&Stated<K>>) -> f64 {
    stated.map_or(0.0, |stated| stated.with_uncertainty().uncertainty())
}

pub(in crate::job::modulus) fn limits(sheet: &ModulusSheet) -> AcceptanceLimits {
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

pub(in crate::job::modulus) fn noise_freedom(
    gauges: &SectionSpectra,
) -> Result<VarianceFreedom, CmodError> {
    let freedom = gauges.noise_freedom();
    VarianceFreedom::new(freedom.line, freedom.own)
}

/// Returns a section of a rod with a free end. The quantity measured there is stated in the sheet,
/// or that of the channel.
pub(super) fn section(
    quantities: &[(String, Quantity)],
    section: &SectionSheet,
    field: &str,
) -> Result<EndSection, RodlabError> {
    let quantity = section
        .quantity
        .or_else(|| quantity_of(quantities, &section.channel));
    Ok(EndSection {
        distance: section.from_free_end.with_uncertainty().value,
        quantity: quantity.ok_or_else(|| {
            RodlabError::request(
                format!("{field}.quantity"),
                "missing",
                "`strain`, `displacement`, `velocity` or `acceleration` (in RON with a capital letter): a file with a ratio does not state the quantity",
            )
        })?,
    })
}

fn quantity_of(quantities: &[(String, Quantity)], channel: &str) -> Option<Quantity> {
    let found = quantities.iter().find(|(name, _)| name == channel);
    found.map(|(_, quantity)| *quantity)
}

/// Returns the quantity of all gauges, which is that of the first gauge.
pub(in crate::job::modulus) fn gauge_quantity(
    quantities: &[(String, Quantity)],
    gauges: &[GaugeSheet],
) -> Quantity {
    gauges
        .first()
        .and_then(|gauge| quantity_of(quantities, &gauge.channel))
        .unwrap_or_default()
}

/// Returns the uncertainties of the gauges. Those of mass and diameter matter only on a free end
/// that is a condition of the method.
pub(in crate::job::modulus) fn gauge_uncertainty(
    sheet: &ModulusSheet,
    gauges: &[GaugeSheet],
    spectra: &SectionSpectra,
) -> GaugeUncertainty {
    let specimen = &sheet.specimen;
    let free_end = sheet.method.used_free_end();
    let on_end = |value: f64| if free_end.is_some() { value } else { 0.0 };
    let of_sensors = |value: fn(&SensorError) -> f64| spectra.sensors.iter().map(value).collect();
    GaugeUncertainty {
        free_end: uncertainty(free_end),
        end_mass: on_end(uncertainty(specimen.accelerometer_mass.as_ref())),
        diameter: on_end(uncertainty(Some(&specimen.diameter))),
        density: uncertainty(Some(&specimen.density)),
        positions: gauges
            .iter()
            .map(|gauge| uncertainty(Some(&gauge.at)))
            .collect(),
        factors: of_sensors(|sensor| sensor.gain),
        delays: of_sensors(|sensor| sensor.delay),
    }
}
