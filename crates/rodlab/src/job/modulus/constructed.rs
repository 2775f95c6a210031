//! Methods of `cmod`, constructed from the sheet.

use cmod::multi_point::{GaugeMethod, Quantity};
use cmod::section_ratio::RatioMethod;
use cmod::two_point::SpecimenUncertainty;
use cmod::{
    CmodError, EndSection, FreeEnd, GaugeUncertainty, MultiPoint, OneGauge, PulsedRod, Resonances,
    SeparatePulses, Solver, Specimen, ThreePoint, TwoPoint,
};
use labio::{ResponseRatio, SectionSpectra, SensorError};

use super::ModulusSheet;
use super::gauges::noise_freedom;
use super::measured::Measured;
use super::method::{GaugeSheet, MethodSheet, SectionSheet, SolverSheet};
use super::rod::{
    end_mass, gauged_rod, length, limits, rod_with_free_end, section_uncertainty, uncertainty,
};
use crate::RodlabError;
use crate::sheet::{Exact, Velocity};

/// Returns the method of the sheet for a ratio.
pub(super) fn ratio_method(
    sheet: &ModulusSheet,
    measured: &Measured,
    ratio: &ResponseRatio,
) -> Result<Box<dyn RatioMethod>, RodlabError> {
    let (specimen, limits) = (&sheet.specimen, limits(sheet));
    let diameter = specimen.diameter.with_uncertainty();
    let density = specimen.density.with_uncertainty();
    let at = |one, field| section(measured, one, &sheet.method.field(field));
    match &sheet.method {
        MethodSheet::TwoPoint { solver, .. } => TwoPoint::new(Specimen {
            length: length(sheet)?,
            diameter: diameter.value,
            density: density.value,
            accelerometer_mass: end_mass(sheet),
        })
        .and_then(|method| method.with_limits(limits))
        .and_then(|method| {
            method.with_specimen_uncertainty(SpecimenUncertainty {
                length: uncertainty(specimen.length.as_ref()),
                diameter: diameter.uncertainty(),
                density: density.uncertainty(),
                accelerometer_mass: uncertainty(specimen.accelerometer_mass.as_ref()),
            })
        })
        .map(|method| {
            boxed(method.with_solver(match solver {
                None | Some(SolverSheet::Continuation) => Solver::Continuation,
                Some(SolverSheet::Newton) => Solver::Newton,
                Some(SolverSheet::Series) => Solver::Series,
            }))
        }),
        MethodSheet::Resonances { .. } => {
            let error = uncertainty(specimen.length.as_ref());
            Resonances::new(rod_with_free_end(sheet), length(sheet)?)
                .and_then(|method| method.with_limits(limits))
                .and_then(|method| method.with_uncertainty(section_uncertainty(sheet, error)))
                .map(boxed)
        }
        MethodSheet::FreeEnd {
            first,
            second,
            wave_speed,
        } => {
            let sections = (at(first, "first")?, at(second, "second")?);
            let error = uncertainty(Some(&first.from_free_end))
                .max(uncertainty(Some(&second.from_free_end)));
            FreeEnd::new(rod_with_free_end(sheet), sections.0, sections.1)
                .and_then(|method| method.with_limits(limits))
                .and_then(|method| method.with_uncertainty(section_uncertainty(sheet, error)))
                .and_then(|method| if_some(method, speed(wave_speed), FreeEnd::with_wave_speed))
                .map(boxed)
        }
        MethodSheet::SeparatePulses {
            distance,
            wave_speed,
            ..
        } => {
            let error = uncertainty(Some(distance));
            SeparatePulses::new(PulsedRod {
                distance: distance.with_uncertainty().value,
                diameter: diameter.value,
                density: density.value,
            })
            .and_then(|method| method.with_limits(limits))
            .and_then(|method| method.with_uncertainty(section_uncertainty(sheet, error)))
            .and_then(|method| if_some(method, speed(wave_speed), SeparatePulses::with_wave_speed))
            .and_then(|method| if_some(method, ratio.delay, SeparatePulses::with_delay))
            .map(boxed)
        }
        MethodSheet::OneGauge {
            section,
            wave_speed,
            ..
        } => {
            let error = uncertainty(Some(&section.from_free_end));
            OneGauge::new(rod_with_free_end(sheet), at(section, "section")?)
                .and_then(|method| method.with_limits(limits))
                .and_then(|method| method.with_uncertainty(section_uncertainty(sheet, error)))
                .and_then(|method| if_some(method, speed(wave_speed), OneGauge::with_wave_speed))
                .and_then(|method| if_some(method, ratio.delay, OneGauge::with_delay))
                .map(boxed)
        }
        // for these methods a ratio has been refused before it is read
        MethodSheet::ThreePoint { .. }
        | MethodSheet::MultiPoint { .. }
        | MethodSheet::FreeVibration { .. } => {
            sheet.method.ratio_in_words()?;
            Err(CmodError::NoLines)
        }
    }
    .map_err(refused)
}

/// Returns the method of the sheet for the spectra of gauges.
pub(super) fn gauge_method(
    sheet: &ModulusSheet,
    measured: &Measured,
    spectra: &SectionSpectra,
) -> Result<Box<dyn GaugeMethod>, CmodError> {
    let limits = limits(sheet);
    match &sheet.method {
        MethodSheet::ThreePoint { gauges } => ThreePoint::new(gauged_rod(sheet, gauges))?
            .with_limits(limits)?
            .with_noise_freedom(noise_freedom(spectra)?)?
            .with_uncertainty(gauge_uncertainty(sheet, gauges, spectra))
            .map(|method| Box::new(method) as Box<dyn GaugeMethod>),
        MethodSheet::MultiPoint {
            gauges, wave_speed, ..
        } => {
            let rod = gauged_rod(sheet, gauges);
            let method = match sheet.method.used_free_end() {
                Some(end) => MultiPoint::before_free_end(rod, end.with_uncertainty().value)?
                    .with_end_mass(end_mass(sheet))?,
                None => MultiPoint::new(rod)?,
            }
            .with_limits(limits)?
            .with_added_damping(spectra.decay_rate())?
            .with_uncertainty(gauge_uncertainty(sheet, gauges, spectra))?;
            let method = if_some(method, speed(wave_speed), MultiPoint::with_wave_speed)?
                .with_noise_freedom(noise_freedom(spectra)?)?;
            Ok(Box::new(
                method.with_quantity(gauge_quantity(measured, gauges)),
            ))
        }
        MethodSheet::TwoPoint { .. }
        | MethodSheet::Resonances { .. }
        | MethodSheet::FreeVibration { .. }
        | MethodSheet::FreeEnd { .. }
        | MethodSheet::SeparatePulses { .. }
        | MethodSheet::OneGauge { .. } => Err(CmodError::NoLines),
    }
}

fn boxed(method: impl RatioMethod + 'static) -> Box<dyn RatioMethod> {
    Box::new(method)
}

fn speed(stated: &Option<Exact<Velocity>>) -> Option<f64> {
    stated.as_ref().map(Exact::si)
}

/// Returns the method with a setting, if there is a value for it.
fn if_some<M>(
    method: M,
    value: Option<f64>,
    set: impl FnOnce(M, f64) -> Result<M, CmodError>,
) -> Result<M, CmodError> {
    match value {
        Some(value) => set(method, value),
        None => Ok(method),
    }
}

pub(super) fn refused(error: CmodError) -> RodlabError {
    RodlabError::step("finding the modulus", error)
}

/// Returns a section of a rod with a free end. The quantity measured there is stated in the sheet,
/// or that of the channel.
fn section(
    measured: &Measured,
    section: &SectionSheet,
    field: &str,
) -> Result<EndSection, RodlabError> {
    let quantity = section
        .quantity
        .map(Quantity::from)
        .or_else(|| measured.quantity_of(&section.channel));
    Ok(EndSection {
        distance: section.from_free_end.with_uncertainty().value,
        quantity: quantity.ok_or_else(|| {
            RodlabError::request(
                format!("{field}.quantity"),
                "missing",
                "`strain`, `displacement`, `velocity` or `acceleration` (in RON with a capital letter): a ratio in a file does not state it",
            )
        })?,
    })
}

/// Returns the quantity of all gauges, which is that of the first gauge.
pub(super) fn gauge_quantity(measured: &Measured, gauges: &[GaugeSheet]) -> Quantity {
    gauges
        .first()
        .and_then(|gauge| measured.quantity_of(&gauge.channel))
        .unwrap_or_default()
}

/// Returns the uncertainties of the gauges. Those of mass and diameter matter only on a free end
/// that is a condition of the method.
pub(super) fn gauge_uncertainty(
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
