//! E₂, B and m from virtual tests: by the procedure of the paper, from all tests together, and from
//! a single test.

use cmod::recovery::RecoveryTest;
use cmod::recovery::fit::{
    ErrorScale, Estimate, RecoveryFit, Scale, SeriesModulus, Verdict, paper_procedure,
};
use rodwave::digits::{percent, significant};
use serde::Serialize;

use super::super::{Error, Table, table_of};
use testbed::papers::paper_c::PaperC;

/// Fit by one method.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Fit {
    way: &'static str,
    parameters: Vec<Parameter>,
}

/// Fitted parameter.
#[derive(Debug, Clone, Serialize)]
struct Parameter {
    symbol: &'static str,
    input: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stopped_at: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    standard_error: Option<f64>,
    #[serde(skip)]
    scale: Scale,
    verdict: String,
}

const SYMBOLS: [&str; 3] = ["E2", "B", "m"];

pub(crate) fn all(paper: &PaperC, tests: &[RecoveryTest]) -> Result<Vec<Fit>, Error> {
    let modulus = SeriesModulus {
        value: paper.series_modulus,
        standard_error: 0.0,
    };
    // the second test, the reference of the paper
    let alone = tests
        .get(1..2)
        .ok_or("paper C has fewer than two creep tests")?;
    let by_procedure = paper_procedure(tests, 1, modulus.value, (0.2, 5.0))?.parameters;
    let procedure = [
        by_procedure.parallel_modulus,
        by_procedure.coefficient,
        by_procedure.exponent,
    ];
    Ok(vec![
        Fit {
            way: "procedure of the paper",
            parameters: SYMBOLS
                .into_iter()
                .zip(truth(paper))
                .zip(procedure)
                .map(|((symbol, input), value)| Parameter {
                    symbol,
                    input,
                    value: Some(value),
                    stopped_at: None,
                    standard_error: None,
                    scale: Scale::Ratio,
                    verdict: "the procedure states no error".into(),
                })
                .collect(),
        },
        joint(paper, "five tests together", tests, modulus)?,
        joint(paper, "Test 2 alone", alone, modulus)?,
    ])
}

fn truth(paper: &PaperC) -> [f64; 3] {
    [paper.parallel_modulus, paper.coefficient, paper.exponent]
}

fn joint(
    paper: &PaperC,
    way: &'static str,
    tests: &[RecoveryTest],
    modulus: SeriesModulus,
) -> Result<Fit, Error> {
    let fit = RecoveryFit::new(tests, modulus, ErrorScale::Stated)?;
    let parameters = SYMBOLS
        .into_iter()
        .zip(truth(paper))
        .map(|(symbol, input)| {
            let estimate: &Estimate = fit
                .estimates
                .iter()
                .find(|estimate| estimate.symbol == symbol)
                .ok_or_else(|| format!("the fit has no parameter {symbol}"))?;
            let known = !matches!(estimate.verdict, Verdict::NotIdentifiable(_));
            Ok(Parameter {
                symbol,
                input,
                value: known.then_some(estimate.value),
                stopped_at: (!known).then_some(estimate.value),
                standard_error: known.then_some(estimate.standard_error),
                scale: estimate.scale,
                verdict: estimate.verdict.to_string(),
            })
        })
        .collect::<Result<_, Error>>()?;
    Ok(Fit { way, parameters })
}

pub(crate) fn table(fits: &[Fit]) -> Table {
    let parameters = fits
        .iter()
        .flat_map(|fit| fit.parameters.iter().map(move |one| (fit.way, one)));
    table_of!(parameters, |(way, parameter)|
        "fit" => way,
        "" => parameter.symbol,
        "input" => significant(parameter.input, 4),
        "found" => parameter.value.map_or("-".into(), |v| significant(v, 4)),
        "standard error" => parameter.standard_error.map_or("-".into(), |e| in_scale(e, parameter.scale)),
        "verdict" => parameter.verdict,
    )
}

/// Writes a standard error in per cent for a ratio, or as the difference of an exponent.
fn in_scale(error: f64, scale: Scale) -> String {
    match scale {
        Scale::Ratio => percent(error),
        Scale::Difference => significant(error, 2),
    }
}

pub(crate) fn conclusion(fits: &[Fit]) -> Vec<String> {
    fits.iter()
        .map(|fit| {
            let found: Vec<String> = fit
                .parameters
                .iter()
                .map(|p| match (p.value, p.standard_error) {
                    (Some(value), Some(error)) => {
                        let error = in_scale(error, p.scale);
                        format!("{} = {} ± {error}", p.symbol, significant(value, 3))
                    }
                    (Some(value), None) => format!("{} = {}", p.symbol, significant(value, 3)),
                    (None, _) => format!("{} {}", p.symbol, p.verdict),
                })
                .collect();
            format!("Fit, {}: {}.", fit.way, found.join("; "))
        })
        .collect()
}
