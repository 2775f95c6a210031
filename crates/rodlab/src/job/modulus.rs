//! Complex modulus of a rod by any of the methods of `cmod`, from hits, or from a ratio of spectra
//! that another program computed.

mod calibration;
mod causal;
mod checked_band;
mod checks;
mod drift;
mod estimate;
mod figures;
mod fitted_laws;
mod followed;
mod gauges;
mod histories;
mod lines;
mod measured;
mod method;
mod mistaken;
mod reasons;
mod statement;
mod universal;

pub use crate::laws::{CardsSheet, LawsSheet, ProgramSheet};
pub use checks::ChecksSheet;
pub use drift::TemperatureSheet;
pub use measured::{RatioErrors, RatioSheet, RatioValues, SourceSheet, TailSheet};
pub use method::{GaugeSheet, MethodSheet, SectionSheet, WindowSheet};

use std::f64::consts::PI;

use cmod::ModulusEstimate;
use cmod::lateral_inertia::CorrectedEstimate;
use cmod::self_calibration::SelfCalibration;
use labio::ResponseRatio;
use serde::Deserialize;

use super::About;
use super::JobContext;
use crate::digits::short;
use crate::outcome::Setting;
use crate::sheet::{
    AddedMass, BandSheet, Density, Exact, Frequency, Length, PoissonRatio, Ratio, Stated, plausible,
};
use crate::{Outcome, RodlabError};
use measured::{Measured, Spectra};
use method::rod;

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModulusSheet {
    /// Title of the test.
    pub title: String,
    /// Persons, place, date and object of the test.
    #[serde(default)]
    pub about: About,
    /// The rod.
    pub specimen: SpecimenSheet,
    /// The method for the modulus.
    pub method: MethodSheet,
    /// The measured data.
    pub source: SourceSheet,
    /// Lines used, such as `(from: "200 Hz", to: "16 kHz")`; by default all lines above 0 Hz.
    pub band: Option<BandSheet>,
    /// Requirements of a valid line.
    #[serde(default)]
    pub limits: LimitsSheet,
    /// Correction of the modulus for lateral inertia; by default none. Without it Poisson's ratio
    /// is assumed to be any value up to 0.5. The resulting error is one of the common errors, and a
    /// line is not valid if this error exceeds the limit of E'.
    pub lateral_inertia: Option<LateralInertiaSheet>,
    /// Checks that need no reference values.
    #[serde(default)]
    pub checks: ChecksSheet,
    /// Computes in addition the causal estimate, that is the relaxing material nearest to all lines
    /// together, with its errors; off by default.
    #[serde(default)]
    pub causal: bool,
    /// Laws fitted to the valid lines; none by default.
    pub laws: Option<LawsSheet>,
    /// Frequencies whose results are reported individually, such as `["1 kHz", "5 kHz"]`; by
    /// default 1, 2 and 5 of each decade with valid lines.
    pub report_at: Option<Vec<Exact<Frequency>>>,
    /// Temperatures of the hits, and the temperature to which the modulus is referred.
    pub temperature: Option<TemperatureSheet>,
    /// Number of Monte Carlo draws, such as 1000, of the noise and of every quantity stated with ±;
    /// they check the linear errors.
    pub monte_carlo: Option<usize>,
}

/// The rod.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpecimenSheet {
    /// Length, such as `"799 mm ± 0.3 mm"`; needed by the methods that use both ends.
    pub length: Option<Stated<Length>>,
    /// Diameter, such as `"15.8 mm"`.
    pub diameter: Stated<Length>,
    /// Density, such as `"912 kg/m3 ± 0.1 %"`. Its relative error causes the same relative error of
    /// the modulus.
    pub density: Stated<Density>,
    /// Mass on the free end, that is the accelerometer with its connector, such as `"2.9 gram"`;
    /// none by default.
    pub accelerometer_mass: Option<Stated<AddedMass>>,
}

impl SpecimenSheet {
    /// Mass of the rod \[kg\], if its length is stated.
    fn mass(&self) -> Option<f64> {
        let value = |stated: &Stated<Length>| stated.with_uncertainty().value;
        let section = 0.25 * PI * value(&self.diameter).powi(2);
        let length = value(self.length.as_ref()?);
        Some(self.density.with_uncertainty().value * section * length)
    }

    /// Refuses a mass on the end that is larger than the mass of the rod, if the length of the rod
    /// is stated.
    fn check_end_mass(&self) -> Result<(), RodlabError> {
        let (Some(rod), Some(mass)) = (self.mass(), &self.accelerometer_mass) else {
            return Ok(());
        };
        let of_end = mass.with_uncertainty().value;
        plausible::end_mass(mass, of_end, rod, "specimen.accelerometer_mass")
    }
}

/// Requirements of a valid line.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsSheet {
    /// Largest relative error of E', such as `"1 %"`, which is the default. Five standard errors of
    /// the random part, and uncorrected lateral inertia, must be within it.
    pub storage_modulus: Option<Exact<Ratio>>,
    /// Largest relative error of the loss factor, defined in the same way; `"5 %"` by default.
    pub loss_factor: Option<Exact<Ratio>>,
    /// Largest relative common error of E'. Two standard errors of all common sources must be
    /// within it; not required by default.
    pub common_storage_modulus: Option<Exact<Ratio>>,
    /// Largest amplification of a relative error; `"10"` by default.
    pub error_amplification: Option<Exact<Ratio>>,
    /// Smallest coherence, for the two-point method with several hits; not required by default.
    pub coherence: Option<Exact<Ratio>>,
}

/// Largest limit of a relative error that is stated without `%`.
const LARGEST_LIMIT: f64 = 2.0;

impl LimitsSheet {
    /// Refuses limits of relative errors above [`LARGEST_LIMIT`], in which a `%` is probably
    /// missing.
    fn check(&self) -> Result<(), RodlabError> {
        for (name, limit) in [
            ("storage_modulus", &self.storage_modulus),
            ("loss_factor", &self.loss_factor),
            ("common_storage_modulus", &self.common_storage_modulus),
        ] {
            if let Some(limit) = limit {
                plausible::limit(limit, LARGEST_LIMIT, format!("limits.{name}"))?;
            }
        }
        Ok(())
    }
}

impl ModulusSheet {
    /// Returns the defaults of optional fields, except those of the source.
    fn defaults(&self) -> Vec<Setting> {
        let mut defaults = Vec::new();
        let mut open = |name: &str, value: &str| defaults.push(Setting::by_default(name, value));
        open("specimen.accelerometer_mass", "0 kg");
        if let Some((field, by_default)) = self.method.left_open() {
            open(field, by_default);
        }
        open("band", "all lines above 0 Hz");
        let limits = cmod::validity::AcceptanceLimits::default();
        let percent = |value: f64| format!("{} %", short(100.0 * value));
        open("limits.storage_modulus", &percent(limits.storage_modulus));
        open("limits.loss_factor", &percent(limits.loss_factor));
        open("limits.common_storage_modulus", "not required");
        open(
            "limits.error_amplification",
            &limits.error_amplification.to_string(),
        );
        open("limits.coherence", "not required");
        match &self.lateral_inertia {
            None => open(
                "lateral_inertia",
                "not corrected; counted as an error for Poisson's ratios up to 0.5",
            ),
            Some(_) => open(
                "lateral_inertia.theory",
                "Pochhammer and Chree at all wavelengths",
            ),
        }
        open("checks.level", &ChecksSheet::usual_level());
        open("report_at", "1, 2 and 5 of each decade with valid lines");
        defaults.extend(self.laws.iter().flat_map(LawsSheet::defaults));
        defaults
    }
}

/// Correction for lateral inertia.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LateralInertiaSheet {
    /// Poisson's ratio, such as `"0.40 ± 0.02"`; `"0"` for simulated one-dimensional waves.
    pub poisson_ratio: Stated<PoissonRatio>,
    /// Theory; by default that of Pochhammer and Chree at all wavelengths.
    pub theory: Option<TheorySheet>,
}

/// A theory of rods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum TheorySheet {
    /// Theory of Love and Rayleigh. Its remaining error, 1 % of E' at three diameters per
    /// wavelength, is one of the common errors.
    LoveRayleigh,
    /// Theory of Pochhammer and Chree, exact for a round rod.
    PochhammerChree,
}

/// Results from which tables, figures and sentences are made.
#[derive(Clone, Copy)]
pub(super) struct Found<'a> {
    sheet: &'a ModulusSheet,
    measured: &'a Measured,
    /// The estimate, corrected for lateral inertia if requested.
    pub(super) estimate: &'a ModulusEstimate,
    pub(super) corrected: Option<&'a CorrectedEstimate>,
    /// Results for the errors of the sensors, if such errors are stated.
    calibration: Option<&'a SelfCalibration>,
    /// Distance between the sections or ends over which wavelengths are counted \[m\].
    distance: f64,
}

pub(crate) fn run(sheet: &ModulusSheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    run_with(sheet, context, |_, _| Ok(()))
}

/// Runs the job; `add` completes the outcome before the checks.
pub(super) fn run_with(
    sheet: &ModulusSheet,
    context: &JobContext<'_>,
    add: impl FnOnce(&mut Outcome, &Found<'_>) -> Result<(), RodlabError>,
) -> Result<Outcome, RodlabError> {
    let mut outcome = Outcome::of("modulus", sheet.title.as_str());
    followed::check(sheet)?;
    rod::check(sheet)?;
    sheet.specimen.check_end_mass()?;
    sheet.limits.check()?;
    sheet.checks.level()?;
    if let Some(laws) = &sheet.laws {
        laws.check()?;
    }
    outcome.settings = sheet.defaults();
    context.progress.begins("reading", 0);
    let mut measured = measured::of(sheet, context, &mut outcome.settings)?;
    outcome.inputs = std::mem::take(&mut measured.inputs);
    outcome.log = std::mem::take(&mut measured.log);
    outcome.figures = std::mem::take(&mut measured.figures);
    outcome.summary.extend(measured.in_words.clone());
    outcome.warnings = std::mem::take(&mut measured.warnings);
    // faults of single hits are named first, because they may cause the doubts that follow
    outcome.doubt_all(&measured.doubts);
    context.has_read_all(&outcome.inputs, &outcome.warnings)?;
    let Some(spectra) = &measured.spectra else {
        outcome.deny("There is no modulus", measured.missing.as_str());
        return Ok(outcome);
    };

    context.progress.begins("finding the modulus", 0);
    let estimate::Estimated {
        modulus: apparent,
        calibration,
    } = estimate::estimate(sheet, &measured, spectra)?;
    let corrected = estimate::without_lateral_inertia(sheet, &apparent)?;
    let found = Found {
        sheet,
        measured: &measured,
        estimate: corrected.as_ref().map_or(&apparent, |c| c.modulus()),
        corrected: corrected.as_ref(),
        calibration: calibration.as_ref(),
        distance: rod::distance(sheet)?,
    };
    context.check_cancelled()?;
    let trend = if context.draw.is_none() || sheet.temperature.is_some() {
        drift::trend(sheet, &measured, (spectra, &apparent))?
    } else {
        None
    };
    let referred = drift::referred(
        sheet,
        (found.estimate, &measured),
        trend.as_ref(),
        &mut outcome,
    )?;
    let as_measured = found;
    let found = Found {
        estimate: referred.as_ref().unwrap_or(found.estimate),
        ..found
    };

    match found.calibration {
        // a Monte Carlo draw does not report the errors of the sensors, because its errors are
        // drawn
        _ if context.draw.is_some() => {}
        Some(calibrated) => calibration::state(&mut outcome, sheet, &measured, calibrated),
        None => calibration::state_none(&mut outcome, sheet, &measured),
    }
    if let Some(trend) = &trend {
        drift::state(&mut outcome, &found, trend)?;
    }
    let reasons = reasons::of(found.estimate, &measured.cut_pulses);
    statement::state(&mut outcome, &found, &reasons);
    if context.draw.is_none() {
        let mistake = mistaken::sensors(sheet, &measured, spectra, found.estimate);
        outcome.warnings.extend(mistake);
    }
    outcome.log.extend(reasons.log(found.estimate));
    outcome.tables.push(lines::table(&found, &reasons));
    if context.draw.is_some() {
        add(&mut outcome, &found)?;
        if let Some(laws) = &sheet.laws {
            fitted_laws::fit(&mut outcome, &found, laws, context)?;
        }
        return Ok(outcome);
    }
    outcome.tables.extend(lines::budget(&found)?);
    if let Some(table) = measured::table(spectra) {
        outcome.tables.push(table);
    }
    outcome.attachments.extend(universal::attachment(&found)?);
    // the figures of the modulus come before the figures of the records
    let answer = figures::figures(&found, &reasons);
    outcome.figures.splice(0..0, answer);
    add(&mut outcome, &found)?;
    context.check_cancelled()?;

    context.progress.begins("checking", 0);
    checks::check(&mut outcome, &as_measured)?;
    context.check_cancelled()?;
    let is_known = found.estimate.valid().next().is_some();
    if sheet.causal && is_known {
        context.progress.begins("finding the causal modulus", 0);
        let estimate = estimate::causal(sheet, &measured, spectra, found.estimate);
        causal::state(&mut outcome, &found, estimate)?;
        context.check_cancelled()?;
    }
    if let Some(laws) = &sheet.laws
        && is_known
    {
        context.progress.begins("fitting laws", laws.laws.len());
        fitted_laws::fit(&mut outcome, &found, laws, context)?;
    }
    Ok(outcome)
}

impl Found<'_> {
    /// Ratio of spectra with its coherence, if the method has one.
    fn ratio(&self) -> Option<&ResponseRatio> {
        match &self.measured.spectra {
            Some(Spectra::Ratio(ratio)) => Some(ratio),
            _ => None,
        }
    }
}
