//! Loss factor during creep recovery: the model of paper C, fitted to tests with one or several
//! loads.
//!
//! A rod is loaded for a while and unloaded, and its loss factor is read while it recovers. One
//! model is fitted to the readings of all tests (`cmod::recovery`). It then predicts the recovery
//! from other loads, such as a periodic load.

mod curves;
mod figures;
mod load;
mod readings;
mod statement;

pub use load::LoadSheet;
pub use readings::{Reading, ReadingsSheet};

use cmod::recovery::RecoveryTest;
use cmod::recovery::fit::{
    ErrorScale, PaperFit, RecoveryFit, SeriesModulus, SingleTestFit, paper_procedure,
};
use serde::Deserialize;

use super::About;
use super::JobContext;
use crate::digits::significant;
use crate::draw::NEEDS_ERRORS;
use crate::outcome::Setting;
use crate::outcome::{InputFile, Verdict};
use crate::sheet::{Exact, Frequency, NotFollowed, Pressure, Ratio, Stated, quoted};
use crate::{InStep, Outcome, RodlabError};

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecoverySheet {
    /// Title of the tests.
    pub title: String,
    /// Persons, place, date and object of the tests.
    #[serde(default)]
    pub about: About,
    /// Modulus of the virgin material at the frequency of the tests, E₁ of the model, such as
    /// `"3.1 GPa ± 50 MPa"`. It must be stated because loss factors do not determine it.
    pub series_modulus: Stated<Pressure>,
    /// Frequency at which the loss factor was read, such as `"10 kHz"`.
    pub frequency: NotFollowed<Frequency>,
    /// Loss factor of the virgin material, such as `"0.025 ± 0.0003"`. Its uncertainty is common
    /// to all readings.
    pub virgin_loss_factor: Option<Stated<Ratio>>,
    /// Kind of the readings: loss factors (the default), or changes of the loss factor.
    pub readings_are: Option<ReadingsAre>,
    /// Standard error, such as `"0.0012"`, of readings for which none is stated.
    pub standard_error: Option<Exact<Ratio>>,
    /// Basis of the errors of the result; by default the stated errors.
    pub error_scale: Option<ErrorScale>,
    /// The tests.
    pub tests: Vec<TestSheet>,
    /// Loads whose recovery is predicted.
    #[serde(default)]
    pub predictions: Vec<PredictionSheet>,
    /// Applies the procedure of paper C in addition to the joint fit.
    pub paper_procedure: Option<PaperProcedureSheet>,
    /// Number of Monte Carlo draws, such as 1000, of the readings and of every quantity stated with
    /// ±; they check the linear errors.
    pub monte_carlo: Option<usize>,
}

/// Kind of the readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum ReadingsAre {
    /// Loss factors, from which `virgin_loss_factor` is subtracted.
    LossFactors,
    /// Changes of the loss factor relative to the virgin material.
    Changes,
}

/// One test: a load, and the readings after it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestSheet {
    /// Name, such as `"Test 1"`.
    pub name: String,
    /// Parts of the load in their order, from the virgin specimen to the unloading.
    pub load: Vec<LoadSheet>,
    /// Frequency of this test, if it differs from that of the sheet.
    pub frequency: Option<NotFollowed<Frequency>>,
    /// The readings.
    pub readings: ReadingsSheet,
}

/// A load whose recovery is predicted.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PredictionSheet {
    /// Name, such as `"4 Hz about 32 MPa"`.
    pub name: String,
    /// Parts of the load in their order.
    pub load: Vec<LoadSheet>,
}

/// Procedure of paper C: E₂ and B are determined from one test for every exponent, and the exponent
/// from the other tests.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaperProcedureSheet {
    /// Name of the test that determines E₂ and B.
    pub reference: String,
    /// Search range of exponents; (0.2, 5.0) by default.
    pub exponents: Option<(f64, f64)>,
}

/// Results from which tables, figures and sentences are made.
struct Found<'a> {
    sheet: &'a RecoverySheet,
    tests: Vec<RecoveryTest>,
    /// Standard errors of the readings of each test.
    standard_errors: Vec<Vec<f64>>,
    singles: Vec<Result<SingleTestFit, cmod::CmodError>>,
    fit: RecoveryFit,
    /// √(χ²/ν) if the errors are from the residual, otherwise 1.
    error_factor: f64,
    paper: Option<PaperFit>,
    predictions: Vec<(String, RecoveryTest)>,
}

pub(crate) fn run(sheet: &RecoverySheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    let mut outcome = Outcome::of("recovery", sheet.title.as_str());
    outcome.settings = defaults(sheet);
    RodlabError::refuse_empty(&sheet.tests, "tests", "at least one test")?;
    if sheet.monte_carlo.is_some() && sheet.error_scale == Some(ErrorScale::FromResidual) {
        return Err(RodlabError::request(
            "monte_carlo",
            "requested together with an `error_scale` from the residual",
            NEEDS_ERRORS,
        ));
    }
    let mut tests = Vec::with_capacity(sheet.tests.len());
    let mut standard_errors = Vec::with_capacity(sheet.tests.len());
    let virgin = sheet.virgin_loss_factor.as_ref();
    let mut largest = virgin.map_or(0.0, |virgin| virgin.with_uncertainty().value);
    for (index, test) in sheet.tests.iter().enumerate() {
        let read = readings::test(sheet, test, &format!("tests[{index}]"), context)?;
        let readings = read.standard_error.len();
        outcome.accept(format!("{}, {readings} readings", test.name), [""; 0]);
        largest = largest.max(read.largest);
        outcome.inputs.extend(read.input);
        outcome.warnings.extend(read.warning);
        standard_errors.push(read.standard_error);
        tests.push(read.test);
    }
    if largest > MOST_LOSS {
        outcome.warn(format!(
            "The largest loss factor of the sheet is {}, expected at most {MOST_LOSS} for a material of a rod: loss factors and their errors are pure \
             numbers; if these are in per cent, divide all of them by 100.",
            significant(largest, 3)
        ));
    }
    outcome.inputs.sort();
    outcome
        .inputs
        .dedup_by(|a: &mut InputFile, b| a.path == b.path);
    context.has_read_all(&outcome.inputs, &outcome.warnings)?;

    let stated = sheet.series_modulus.with_uncertainty();
    let series_modulus = SeriesModulus {
        value: stated.value,
        standard_error: stated.uncertainty(),
    };
    let scale = sheet.error_scale.unwrap_or_default();
    context
        .progress
        .begins("fitting all tests together", tests.len());
    let singles: Vec<_> = tests.iter().map(SingleTestFit::new).collect();
    let fit = match RecoveryFit::new(&tests, series_modulus, scale) {
        Ok(fit) => fit,
        Err(error @ (cmod::CmodError::TooFewReadings { .. } | cmod::CmodError::NoStart)) => {
            statement::without_fit(&mut outcome, sheet, (&tests, &singles), &error);
            return Ok(outcome);
        }
        Err(error) => return Err(RodlabError::step("fitting the tests", error)),
    };
    context.check_cancelled()?;
    let error_factor = if scale == ErrorScale::FromResidual {
        // a fit with errors from the residual exists only if it has degrees of freedom
        (fit.chi_squared / fit.degrees_of_freedom as f64).sqrt()
    } else {
        1.0
    };
    let mut found = Found {
        paper: paper(sheet, &tests)?,
        predictions: predictions(sheet, &tests)?,
        sheet,
        singles,
        fit,
        error_factor,
        standard_errors,
        tests,
    };
    statement::state(&mut outcome, &found);
    if matches!(outcome.verdict, Verdict::NotAllowed { .. }) {
        // predictions require a model whose parameters are all identified
        found.predictions.clear();
    }
    outcome.tables = curves::tables(&found).in_step("predicting a recovery")?;
    outcome.figures = figures::figures(&found).in_step("predicting a recovery")?;
    context.check_cancelled()?;
    statement::predict(&mut outcome, &found).in_step("predicting a recovery")?;
    Ok(outcome)
}

fn defaults(sheet: &RecoverySheet) -> Vec<Setting> {
    let mut defaults = vec![
        Setting::by_default("readings_are", "loss factors"),
        Setting::by_default("error_scale", "the standard errors of the readings"),
    ];
    if sheet.paper_procedure.is_some() {
        let (from, to) = EXPONENTS;
        let range = format!("{from} to {to}");
        defaults.push(Setting::by_default("paper_procedure.exponents", range));
    }
    defaults
}

/// Loss factor above which all loss factors are probably in per cent.
const MOST_LOSS: f64 = 1.0;

/// Default search range of exponents in the procedure of paper C.
const EXPONENTS: (f64, f64) = (0.2, 5.0);

fn paper(sheet: &RecoverySheet, tests: &[RecoveryTest]) -> Result<Option<PaperFit>, RodlabError> {
    let Some(asked) = &sheet.paper_procedure else {
        return Ok(None);
    };
    let Some(reference) = tests.iter().position(|test| test.name() == asked.reference) else {
        let names = quoted(tests.iter().map(RecoveryTest::name));
        return Err(RodlabError::request(
            "paper_procedure.reference",
            format!("`{}`", asked.reference),
            format!("one of the tests {names}"),
        ));
    };
    paper_procedure(
        tests,
        reference,
        sheet.series_modulus.with_uncertainty().value,
        asked.exponents.unwrap_or(EXPONENTS),
    )
    .map(Some)
    .in_step("paper_procedure")
}

/// Returns the loads to be predicted, as tests without readings at the times of the curves.
fn predictions(
    sheet: &RecoverySheet,
    tests: &[RecoveryTest],
) -> Result<Vec<(String, RecoveryTest)>, RodlabError> {
    let times = curves::times(tests);
    let made = |(index, asked): (usize, &PredictionSheet)| {
        let field = format!("predictions[{index}].load");
        let load = load::history(&asked.load, &field)?;
        let test =
            curves::at_times(&asked.name, load, sheet.frequency.si(), &times).in_step(field)?;
        Ok((asked.name.clone(), test))
    };
    sheet.predictions.iter().enumerate().map(made).collect()
}
