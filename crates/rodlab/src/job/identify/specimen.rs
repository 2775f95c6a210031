//! Messages about the rods: contributions of their errors, and missing data in their description.

use maxwellid::{CommonError, RodTest};

use super::{Found, IdentifySheet, SpecimenSheet};
use crate::Outcome;
use crate::digits::significant;
use crate::sheet::ValueWithUncertainty;

/// Reports the contribution of the specimen to the errors, or that the errors do not include it.
pub(super) fn tell(sheet: &IdentifySheet, found: &Found, outcome: &mut Outcome) {
    let is_unstated = |of: &dyn Fn(&SpecimenSheet) -> ValueWithUncertainty| {
        let mut all = sheet.specimens();
        all.any(|specimen| of(specimen).standard_uncertainty.is_none())
    };
    let missing: Vec<&str> = [
        (
            "length",
            is_unstated(&|specimen| specimen.length.with_uncertainty()),
        ),
        (
            "density",
            is_unstated(&|specimen| specimen.density.with_uncertainty()),
        ),
    ]
    .into_iter()
    .filter_map(|(name, is_unstated)| is_unstated.then_some(name))
    .collect();
    if !missing.is_empty() {
        outcome.warn(format!(
            "no uncertainty is stated for the {} of the specimen: the errors do not include it; a relative error of the length enters E doubled, a relative error of the density unchanged",
            missing.join(" and the ")
        ));
    }
    let of_transducers = |error: &CommonError| error.of.is_of_transducer();
    let mut errors = found.tests.iter().flat_map(RodTest::common_errors);
    if !errors.any(of_transducers) {
        outcome.warn(
            "no uncertainty is stated for gain and delay of the transducers: neither the errors nor the choice of a law include it; a response \
             that reads a few per cent too low looks like relaxation",
        );
    }
    let modulus = found.laws.iter().find_map(|law| law.estimates.first());
    tell_lateral_inertia(sheet, found, modulus.map(|modulus| modulus.value), outcome);
    if let Some(modulus) = modulus.filter(|modulus| modulus.specimen_error > 0.0) {
        let source = match sheet.single_specimen() {
            Some(_) => "Length and density of the specimen contribute",
            None => "The density, with one error for all rods, contributes",
        };
        outcome.say(format!(
            "{source} {:.2} % to the standard error of E, and to those of the other parameters as far as they \
             depend on E; this contribution is the same for all tests, and more tests do not reduce it.",
            100.0 * modulus.specimen_error
        ));
    }
}

/// Poisson's ratio in the warning about lateral inertia.
const USUAL_POISSON_RATIO: f64 = 0.4;

/// Shortest wavelength, in diameters, for which the theory of lateral inertia is valid.
const SHORTEST_WAVE: f64 = 3.0;

/// Warns of a measured test that is evaluated without lateral inertia, and states the diameter from
/// which on lateral inertia matters. Warns also of waves that are too short for the theory of
/// lateral inertia. `modulus` is Young's modulus \[Pa\].
fn tell_lateral_inertia(
    sheet: &IdentifySheet,
    found: &Found,
    modulus: Option<f64>,
    outcome: &mut Outcome,
) {
    let Some(modulus) = modulus else { return };
    for (test, of_sheet) in found.tests.iter().zip(&sheet.tests) {
        let filter = test.unfiltered_excitation().map(|u| u.filter().cutoff_hz());
        let mut checks = found.recorders.iter();
        let of_check = checks.find(|check| check.test == of_sheet.name);
        let specimen = of_sheet.specimen.as_ref().or(sheet.specimen.as_ref());
        let Some((cutoff, specimen)) = filter.or(of_check.map(|c| c.cutoff_hz)).zip(specimen)
        else {
            continue;
        };
        let wavelength = (modulus / test.density()).sqrt() / cutoff;
        let kilohertz = significant(1e-3 * cutoff, 3);
        let warning = match &specimen.diameter {
            None if of_sheet.generator.is_none() => {
                // Love's theory slows waves down by ν²k²D²/16
                let wave_number = std::f64::consts::TAU / wavelength;
                let diameter = 0.001_f64.sqrt() * 4.0 / (USUAL_POISSON_RATIO * wave_number);
                format!(
                    "lateral inertia is not part of the model. It slows waves of {kilohertz} kHz by 0.1 % in a rod of {} mm diameter with Poisson's ratio {USUAL_POISSON_RATIO}, \
                     and by more in a thicker one: state `diameter` and `poisson_ratio` of the specimen",
                    significant(1e3 * diameter, 2),
                )
            }
            Some(diameter) if wavelength < SHORTEST_WAVE * diameter.with_uncertainty().value => {
                format!(
                    "waves of {kilohertz} kHz, the cut-off of the recorder, are {} mm long. The theory of lateral inertia is valid from {SHORTEST_WAVE} diameters on: \
                     use a thinner rod or a softer impact",
                    significant(1e3 * wavelength, 2),
                )
            }
            _ => continue,
        };
        outcome.warn(warning);
        return;
    }
}
