//! Modulus from spectra by the method of the sheet.

use cmod::causal::CausalEstimate;
use cmod::estimate::VarianceFreedom;
use cmod::free_vibration::Pole;
use cmod::hit_trend;
use cmod::lateral_inertia::CorrectedEstimate;
use cmod::multi_point::{GaugeMethod, Quantity};
use cmod::rheology::ModulusData;
use cmod::section_ratio::{RatioError, RatioLines, RatioMethod};
use cmod::self_calibration::SelfCalibration;
use cmod::two_point::SpecimenUncertainty;
use cmod::{
    CmodError, EndSection, FreeEnd, FreeVibration, GaugeSpectra, GaugeUncertainty, LateralInertia,
    ModulusEstimate, MultiPoint, OneGauge, PulsedRod, Resonances, SeparatePulses, Solver, Specimen,
    ThreePoint, TwoPoint,
};
use labio::{ResponseRatio, SectionSpectra, SensorError};
use num_complex::Complex64;
use rayon::prelude::*;
use rodwave::slenderness::Theory;

use super::gauges::noise_freedom;
use super::measured::{Measured, Spectra};
use super::method::{GaugeSheet, MethodSheet, SectionSheet, SolverSheet};
use super::rod::{
    end_mass, gauged_rod, length, limits, rod_with_free_end, section_uncertainty, uncertainty,
};
use super::{ModulusSheet, TheorySheet};
use crate::RodlabError;

/// An estimate, with the results for the errors of the sensors if such errors are stated.
pub(super) struct Estimated {
    pub(super) modulus: ModulusEstimate,
    pub(super) calibration: Option<SelfCalibration>,
}

pub(super) fn estimate(
    sheet: &ModulusSheet,
    measured: &Measured,
    spectra: &Spectra,
) -> Result<Estimated, RodlabError> {
    let estimated = match spectra {
        Spectra::Ratio(ratio) => calibrated_ratio(sheet, measured, ratio),
        Spectra::Gauges(gauges) => of_gauges(sheet, (measured, gauges), true),
        Spectra::Modes(modes) => return of_modes(sheet, &modes.poles),
    }?;
    Ok(Estimated {
        modulus: estimated.modulus.judged_by_neighbours().map_err(refused)?,
        ..estimated
    })
}

/// Returns the modulus without determining errors of the sensors from the lines.
pub(super) fn plain(
    sheet: &ModulusSheet,
    measured: &Measured,
    spectra: &Spectra,
) -> Result<ModulusEstimate, RodlabError> {
    match spectra {
        Spectra::Ratio(ratio) => {
            let mut ratio = ratio.clone();
            ratio.common = SensorError::default();
            calibrated_ratio(sheet, measured, &ratio).map(|estimated| estimated.modulus)
        }
        Spectra::Gauges(gauges) => {
            of_gauges(sheet, (measured, gauges), false).map(|estimated| estimated.modulus)
        }
        Spectra::Modes(modes) => of_modes(sheet, &modes.poles).map(|estimated| estimated.modulus),
    }
}

/// Returns the modulus from a ratio. Errors of gain ratio and delay, if uncertain, are determined
/// from the lines themselves.
fn calibrated_ratio(
    sheet: &ModulusSheet,
    measured: &Measured,
    ratio: &ResponseRatio,
) -> Result<Estimated, RodlabError> {
    with_ratio(sheet, measured, ratio, |method, lines| {
        let calibration = SelfCalibration::of_ratio(method, lines)?;
        Ok(Estimated {
            modulus: match &calibration {
                Some(found) => found.estimate().clone(),
                None => method.estimate_ratio(lines)?,
            },
            calibration,
        })
    })
}

/// Calls a function with the method of the sheet and the lines of a ratio.
fn with_ratio<T>(
    sheet: &ModulusSheet,
    measured: &Measured,
    ratio: &ResponseRatio,
    take: impl FnOnce(&dyn RatioMethod, &RatioLines<'_>) -> Result<T, CmodError>,
) -> Result<T, RodlabError> {
    let frequency_hz = &ratio.frequency_hz;
    let SensorError { gain, delay } = ratio.common;
    let errors = [
        (gain, RatioError::of_gain_ratio(frequency_hz, gain)),
        (delay, RatioError::of_delay(frequency_hz, delay)),
    ];
    let common = errors
        .into_iter()
        .filter(|(stated, _)| *stated > 0.0)
        .map(|(_, error)| error.map_err(refused))
        .collect::<Result<Vec<_>, _>>()?;
    let freedom = ratio.freedom.as_ref().map(|lines| {
        let lines = lines.iter();
        lines
            .map(|of| VarianceFreedom::new(of.line, of.own))
            .collect()
    });
    let freedom: Option<Vec<VarianceFreedom>> = freedom.transpose().map_err(refused)?;
    let lines = RatioLines {
        frequency_hz,
        ratio: &ratio.values,
        variance: &ratio.variance,
        freedom: freedom.as_deref(),
        coherence: ratio.coherence.as_deref(),
        common: &common,
        lines_per_independent_line: ratio.lines_per_independent_line,
    };
    let method = ratio_method(sheet, measured, ratio)?;
    take(method.as_ref(), &lines).map_err(refused)
}

/// Returns the relative deviations of the modulus of each hit from the modulus of all hits; `None`
/// if the method does not give a modulus for each hit.
pub(super) fn deviations(
    sheet: &ModulusSheet,
    measured: &Measured,
    (spectra, modulus): (&Spectra, &ModulusEstimate),
) -> Result<Option<Vec<f64>>, RodlabError> {
    if let Spectra::Ratio(ratio) = spectra {
        let method = ratio_method(sheet, measured, ratio)?;
        let hits: Option<Vec<&[Complex64]>> = measured.each.iter().map(Spectra::ratios).collect();
        let linear = hits
            .and_then(|hits| hit_trend::deviations(method.as_ref(), modulus, &ratio.values, &hits));
        if linear.is_some() {
            return Ok(linear);
        }
    }
    let all = plain(sheet, measured, spectra)?;
    let each = measured.each.par_iter();
    // a single hit may give no modulus although all hits together give one
    let of_hit = |spectra| hit_trend::deviation(&all, &plain(sheet, measured, spectra).ok()?);
    Ok(each.map(of_hit).collect())
}

/// Returns the causal estimate from all lines or, for methods that give moduli only at single
/// frequencies, from these moduli.
pub(super) fn causal(
    sheet: &ModulusSheet,
    measured: &Measured,
    spectra: &Spectra,
    modulus: &ModulusEstimate,
) -> Result<CausalEstimate, RodlabError> {
    let theory = lateral_inertia(sheet)?;
    let theory = theory.as_ref();
    match (spectra, &sheet.method) {
        (_, MethodSheet::Resonances { .. }) | (Spectra::Modes(_), _) => {
            ModulusData::from_estimate(modulus)
                .and_then(|data| CausalEstimate::new(&data))
                .map_err(refused)
        }
        (Spectra::Ratio(ratio), _) => with_ratio(sheet, measured, ratio, |method, lines| {
            CausalEstimate::of_ratio(method, lines, theory)
        }),
        (Spectra::Gauges(gauges), _) => {
            with_gauges(sheet, (measured, gauges), CausalGauges { theory })
        }
    }
}

fn refused(error: CmodError) -> RodlabError {
    RodlabError::step("finding the modulus", error)
}

fn boxed(method: impl RatioMethod + 'static) -> Box<dyn RatioMethod> {
    Box::new(method)
}

fn ratio_method(
    sheet: &ModulusSheet,
    measured: &Measured,
    ratio: &ResponseRatio,
) -> Result<Box<dyn RatioMethod>, RodlabError> {
    let limits = limits(sheet);
    let specimen = &sheet.specimen;
    let (diameter, density) = (
        specimen.diameter.with_uncertainty(),
        specimen.density.with_uncertainty(),
    );
    match &sheet.method {
        MethodSheet::TwoPoint { solver, .. } => {
            let length = length(sheet)?;
            let method = TwoPoint::new(Specimen {
                length,
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
            .map_err(refused)?
            .with_solver(match solver {
                None | Some(SolverSheet::Continuation) => Solver::Continuation,
                Some(SolverSheet::Newton) => Solver::Newton,
                Some(SolverSheet::Series) => Solver::Series,
            });
            Ok(boxed(method))
        }
        MethodSheet::Resonances { .. } => Resonances::new(rod_with_free_end(sheet), length(sheet)?)
            .and_then(|method| method.with_limits(limits))
            .and_then(|method| {
                let length = uncertainty(specimen.length.as_ref());
                method.with_uncertainty(section_uncertainty(sheet, length))
            })
            .map(boxed),
        MethodSheet::FreeEnd {
            first,
            second,
            wave_speed,
        } => {
            let sections = [
                section(measured, first, "method.free_end.first")?,
                section(measured, second, "method.free_end.second")?,
            ];
            let distance = uncertainty(Some(&first.from_free_end))
                .max(uncertainty(Some(&second.from_free_end)));
            let [first, second] = sections;
            FreeEnd::new(rod_with_free_end(sheet), first, second)
                .and_then(|method| method.with_limits(limits))
                .and_then(|m| m.with_uncertainty(section_uncertainty(sheet, distance)))
                .and_then(|method| match wave_speed {
                    Some(speed) => method.with_wave_speed(speed.si()),
                    None => Ok(method),
                })
                .map(boxed)
        }
        MethodSheet::SeparatePulses {
            distance,
            wave_speed,
            ..
        } => SeparatePulses::new(PulsedRod {
            distance: distance.with_uncertainty().value,
            diameter: diameter.value,
            density: density.value,
        })
        .and_then(|method| method.with_limits(limits))
        .and_then(|m| m.with_uncertainty(section_uncertainty(sheet, uncertainty(Some(distance)))))
        .and_then(|method| match wave_speed {
            Some(speed) => method.with_wave_speed(speed.si()),
            None => Ok(method),
        })
        .and_then(|method| match ratio.delay {
            Some(delay) => method.with_delay(delay),
            None => Ok(method),
        })
        .map(boxed),
        MethodSheet::OneGauge {
            section: at,
            wave_speed,
            ..
        } => {
            let distance = uncertainty(Some(&at.from_free_end));
            OneGauge::new(
                rod_with_free_end(sheet),
                section(measured, at, "method.one_gauge.section")?,
            )
            .and_then(|method| method.with_limits(limits))
            .and_then(|m| m.with_uncertainty(section_uncertainty(sheet, distance)))
            .and_then(|method| match wave_speed {
                Some(speed) => method.with_wave_speed(speed.si()),
                None => Ok(method),
            })
            .and_then(|method| match ratio.delay {
                Some(delay) => method.with_delay(delay),
                None => Ok(method),
            })
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

/// Returns the modulus at the modes; they have no common error of a sensor.
fn of_modes(sheet: &ModulusSheet, poles: &[Pole]) -> Result<Estimated, RodlabError> {
    let MethodSheet::FreeVibration { wave_speed, .. } = &sheet.method else {
        return Err(refused(CmodError::NoLines));
    };
    let length_error = uncertainty(sheet.specimen.length.as_ref());
    let modulus = FreeVibration::new(rod_with_free_end(sheet), length(sheet)?, wave_speed.si())
        .and_then(|method| method.with_limits(limits(sheet)))
        .and_then(|method| method.with_uncertainty(section_uncertainty(sheet, length_error)))
        .and_then(|method| method.estimate(poles))
        .map_err(refused)?;
    Ok(Estimated {
        modulus,
        calibration: None,
    })
}

fn of_gauges(
    sheet: &ModulusSheet,
    gauges: (&Measured, &SectionSpectra),
    finds_errors: bool,
) -> Result<Estimated, RodlabError> {
    with_gauges(sheet, gauges, CalibratedGauges { finds_errors })
}

/// Computation of a result with any of the methods with gauges.
trait OfGauges {
    type Result;

    fn of(
        self,
        method: &impl GaugeMethod,
        spectra: &GaugeSpectra<'_>,
    ) -> Result<Self::Result, CmodError>;
}

/// Modulus, with errors of the gauges determined from the lines themselves if requested.
struct CalibratedGauges {
    finds_errors: bool,
}

impl OfGauges for CalibratedGauges {
    type Result = Estimated;

    fn of(
        self,
        method: &impl GaugeMethod,
        spectra: &GaugeSpectra<'_>,
    ) -> Result<Estimated, CmodError> {
        let calibration = match self.finds_errors {
            true => SelfCalibration::of_gauges(method, spectra)?,
            false => None,
        };
        Ok(Estimated {
            modulus: match &calibration {
                Some(found) => found.estimate().clone(),
                None => method.estimate_modulus(spectra)?,
            },
            calibration,
        })
    }
}

/// Causal estimate of all lines.
struct CausalGauges<'a> {
    theory: Option<&'a LateralInertia>,
}

impl OfGauges for CausalGauges<'_> {
    type Result = CausalEstimate;

    fn of(
        self,
        method: &impl GaugeMethod,
        spectra: &GaugeSpectra<'_>,
    ) -> Result<CausalEstimate, CmodError> {
        CausalEstimate::of_gauges(method, spectra, self.theory)
    }
}

/// Computes the requested result from the method of the sheet and the spectra of its gauges.
fn with_gauges<T: OfGauges>(
    sheet: &ModulusSheet,
    (measured, gauges): (&Measured, &SectionSpectra),
    asked: T,
) -> Result<T::Result, RodlabError> {
    let limits = limits(sheet);
    let noise = noise_freedom(gauges);
    let of_sensors = |value: fn(&SensorError) -> f64| gauges.sensors.iter().map(value).collect();
    let free_end = sheet.method.used_free_end();
    let specimen = &sheet.specimen;
    let on_end = |value: f64| if free_end.is_some() { value } else { 0.0 };
    let uncertain = |gauges: &[GaugeSheet]| GaugeUncertainty {
        free_end: uncertainty(free_end),
        end_mass: on_end(uncertainty(specimen.accelerometer_mass.as_ref())),
        diameter: on_end(uncertainty(Some(&specimen.diameter))),
        density: uncertainty(Some(&sheet.specimen.density)),
        positions: gauges
            .iter()
            .map(|gauge| uncertainty(Some(&gauge.at)))
            .collect(),
        factors: of_sensors(|sensor| sensor.gain),
        delays: of_sensors(|sensor| sensor.delay),
    };
    let decay_rate = gauges.decay_rate();
    with_gauge_spectra(gauges, |spectra| match &sheet.method {
        MethodSheet::ThreePoint { gauges } => ThreePoint::new(gauged_rod(sheet, gauges))
            .and_then(|method| method.with_limits(limits))
            .and_then(|method| method.with_noise_freedom(noise?))
            .and_then(|method| method.with_uncertainty(uncertain(gauges)))
            .and_then(|method| asked.of(&method, spectra)),
        MethodSheet::MultiPoint {
            gauges, wave_speed, ..
        } => multi_point(sheet, gauges)
            .and_then(|method| method.with_limits(limits))
            .and_then(|method| method.with_added_damping(decay_rate))
            .and_then(|method| method.with_uncertainty(uncertain(gauges)))
            .and_then(|method| match wave_speed {
                Some(speed) => method.with_wave_speed(speed.si()),
                None => Ok(method),
            })
            .and_then(|method| method.with_noise_freedom(noise?))
            .and_then(|method| {
                let method = method.with_quantity(gauge_quantity(measured, gauges));
                asked.of(&method, spectra)
            }),
        _ => Err(CmodError::NoLines),
    })
    .map_err(refused)
}

/// Returns the method with gauges at any positions. With two gauges before a free end, the free end
/// is a condition.
fn multi_point(sheet: &ModulusSheet, gauges: &[GaugeSheet]) -> Result<MultiPoint, CmodError> {
    let rod = gauged_rod(sheet, gauges);
    match sheet.method.used_free_end() {
        Some(free_end) => MultiPoint::before_free_end(rod, free_end.with_uncertainty().value)
            .and_then(|method| method.with_end_mass(end_mass(sheet))),
        None => MultiPoint::new(rod),
    }
}

/// Calls a function with the spectra in the form used by the methods with several gauges and by
/// their check.
pub(super) fn with_gauge_spectra<T>(
    gauges: &SectionSpectra,
    take: impl FnOnce(&GaugeSpectra<'_>) -> T,
) -> T {
    let tests: Vec<&[Vec<Complex64>]> = gauges.tests.iter().map(Vec::as_slice).collect();
    take(&GaugeSpectra {
        frequency_hz: &gauges.frequency_hz,
        tests: &tests,
        noise: &gauges.noise,
    })
}

/// Returns the modulus corrected for lateral inertia, if the sheet requests this.
pub(super) fn without_lateral_inertia(
    sheet: &ModulusSheet,
    apparent: &ModulusEstimate,
) -> Result<Option<CorrectedEstimate>, RodlabError> {
    let theory = lateral_inertia(sheet)?;
    let corrected = theory.map(|theory| theory.correct(apparent));
    corrected
        .transpose()
        .map_err(|error| RodlabError::step("lateral_inertia", error))
}

/// Returns the theory of lateral inertia, if the sheet states one.
fn lateral_inertia(sheet: &ModulusSheet) -> Result<Option<LateralInertia>, RodlabError> {
    let Some(asked) = &sheet.lateral_inertia else {
        return Ok(None);
    };
    let ratio = asked.poisson_ratio.with_uncertainty();
    let diameter = sheet.specimen.diameter.with_uncertainty();
    LateralInertia::new(
        diameter.value,
        sheet.specimen.density.with_uncertainty().value,
        ratio.value,
    )
    .and_then(|inertia| inertia.with_poisson_ratio_uncertainty(ratio.uncertainty()))
    .and_then(|inertia| inertia.with_diameter_uncertainty(diameter.uncertainty()))
    .map(|inertia| match asked.theory {
        None => inertia,
        Some(TheorySheet::LoveRayleigh) => inertia.with_theory(Theory::LoveRayleigh),
        Some(TheorySheet::PochhammerChree) => inertia.with_theory(Theory::PochhammerChree),
    })
    .map(Some)
    .map_err(|error| RodlabError::step("lateral_inertia", error))
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
