//! Modulus from spectra by the method of the sheet.

use cmod::causal::CausalEstimate;
use cmod::estimate::VarianceFreedom;
use cmod::free_vibration::Pole;
use cmod::hit_trend;
use cmod::lateral_inertia::CorrectedEstimate;
use cmod::multi_point::GaugeMethod;
use cmod::rheology::ModulusData;
use cmod::section_ratio::{RatioError, RatioLines, RatioMethod};
use cmod::self_calibration::SelfCalibration;
use cmod::{CmodError, FreeVibration, GaugeSpectra, LateralInertia, ModulusEstimate};
use labio::{ResponseRatio, SectionSpectra, SensorError};
use num_complex::Complex64;
use rayon::prelude::*;
use rodwave::slenderness::Theory;

use super::measured::{Measured, Spectra};
use super::method::rod::{length, limits, rod_with_free_end, section_uncertainty, uncertainty};
use super::method::{MethodSheet, gauge_method, ratio_method, refused};
use super::{ModulusSheet, TheorySheet};
use crate::{InStep, RodlabError};

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
    let method = ratio_method(sheet, &measured.quantities, ratio)?;
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
        let method = ratio_method(sheet, &measured.quantities, ratio)?;
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
    let of_moduli = || {
        let data = ModulusData::from_estimate(modulus)?;
        CausalEstimate::new(&data)
    };
    match spectra {
        Spectra::Ratio(ratio) => with_ratio(sheet, measured, ratio, |method, lines| {
            if method.has_all_lines() {
                CausalEstimate::of_ratio(method, lines, theory)
            } else {
                of_moduli()
            }
        }),
        Spectra::Gauges(gauges) => with_gauges(sheet, (measured, gauges), |method, spectra| {
            CausalEstimate::of_gauges(method, spectra, theory)
        }),
        Spectra::Modes(_) => of_moduli().map_err(refused),
    }
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

/// Returns the modulus from the spectra of gauges. Errors of the gauges are determined from the
/// lines themselves if `finds_errors` is true.
fn of_gauges(
    sheet: &ModulusSheet,
    gauges: (&Measured, &SectionSpectra),
    finds_errors: bool,
) -> Result<Estimated, RodlabError> {
    with_gauges(sheet, gauges, |method, spectra| {
        let calibration = match finds_errors {
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
    })
}

/// Calls a function with the method of the sheet and the spectra of its gauges.
fn with_gauges<T>(
    sheet: &ModulusSheet,
    (measured, gauges): (&Measured, &SectionSpectra),
    take: impl FnOnce(&dyn GaugeMethod, &GaugeSpectra<'_>) -> Result<T, CmodError>,
) -> Result<T, RodlabError> {
    gauge_method(sheet, &measured.quantities, gauges)
        .and_then(|method| with_gauge_spectra(gauges, |spectra| take(method.as_ref(), spectra)))
        .map_err(refused)
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
    corrected.transpose().in_step("lateral_inertia")
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
    .in_step("lateral_inertia")
}
