//! Identification, with the same type of result for every law.

use maxwellid::{
    Fit, IdentifiableLaw, MaxwellidError, Noise, RodModel, RodTest, Role, Scale, Verdict,
};
use rodwave::RodwaveError;
use rodwave::inelastic::{Maxwell, MaxwellGurevichRabinovich, MaxwellNorton};
use serde::Serialize;

use super::super::Error;
use testbed::papers::paper_d::{LawParameters, ModelKind};

/// Runs `$body` with `$law` bound to the law that `$parameters` describe; each law has another
/// type.
macro_rules! with_law {
    ($parameters:expr, |$law:ident| $body:expr) => {
        match $parameters {
            LawParameters::Maxwell { viscosity, .. } => {
                let $law = rodwave::inelastic::Maxwell::new(viscosity)?;
                $body
            }
            LawParameters::MaxwellNorton {
                exponent,
                coefficient,
                ..
            } => {
                let $law = rodwave::inelastic::MaxwellNorton::new(exponent, coefficient)?;
                $body
            }
            LawParameters::MaxwellGurevichRabinovich {
                viscosity,
                activation_stress,
                ..
            } => {
                let $law = rodwave::inelastic::MaxwellGurevichRabinovich::new(
                    viscosity,
                    activation_stress,
                )?;
                $body
            }
        }
    };
}
pub(crate) use with_law;

/// Returns Young's modulus of a set of parameters \[Pa\].
pub(crate) fn modulus_of(parameters: LawParameters) -> f64 {
    match parameters {
        LawParameters::Maxwell { modulus, .. }
        | LawParameters::MaxwellNorton { modulus, .. }
        | LawParameters::MaxwellGurevichRabinovich { modulus, .. } => modulus,
    }
}

/// Returns the true values of all parameters that are stated, by symbol: those of the paper, and
/// the rate at 10 MPa.
pub(crate) fn stated(parameters: LawParameters) -> Result<Vec<(&'static str, f64)>, RodwaveError> {
    let mut stated = vec![("E", modulus_of(parameters))];
    with_law!(parameters, |law| stated.extend(
        IdentifiableLaw::stated(&law)
            .iter()
            .map(|p| (p.symbol, p.value))
    ));
    Ok(stated)
}

/// Returns the value of the parameter `symbol`.
pub(crate) fn value_of(values: &[(&str, f64)], symbol: &str) -> Option<f64> {
    let mut values = values.iter();
    values
        .find(|(of, _)| *of == symbol)
        .map(|(_, value)| *value)
}

/// Returns the rms change of the responses of `tests` due to a change of each coordinate of the
/// true `parameters` by ten per cent, as a fraction of V0, by symbol. It is the same for all
/// methods of identification, unlike the change computed at the point where an iteration stopped.
pub(crate) fn influences(
    parameters: LawParameters,
    tests: &[RodTest],
    cell: f64,
) -> Result<Vec<(&'static str, f64)>, Error> {
    with_law!(parameters, |law| influences_of(
        &law,
        modulus_of(parameters),
        tests,
        cell
    ))
}

fn influences_of(
    model: &impl RodModel,
    modulus: f64,
    tests: &[RodTest],
    cell: f64,
) -> Result<Vec<(&'static str, f64)>, Error> {
    let truth = model.parameters(modulus);
    let (mut squares, mut samples) = (vec![0.0; truth.len()], 0.0);
    for test in tests {
        let times = test.times();
        let response = model
            .linearised_response(&test.driven_rod(&times, cell), &truth)
            .ok_or("the true parameters have no response")?;
        for (square, by) in squares.iter_mut().zip(&response.by_parameter) {
            *square += by.iter().map(|by| by * by).sum::<f64>() / test.impact_velocity().powi(2);
        }
        samples += u32::try_from(times.len()).map(f64::from)?;
    }
    let coordinates = model.stated(&truth).into_iter();
    Ok(coordinates
        .filter(|stated| stated.role == Role::Coordinate)
        .filter_map(|stated| {
            // a coordinate depends on a single parameter of the fit
            let mut own = stated.gradient.iter().zip(&squares);
            let (gradient, square) = own.find(|(gradient, _)| **gradient != 0.0)?;
            let tenth = match stated.scale {
                Scale::Ratio => 0.1,
                Scale::Difference => 0.1 * stated.value.abs(),
            };
            let rms = (square / samples).sqrt();
            Some((stated.symbol, tenth * rms / gradient.abs()))
        })
        .collect())
}

/// Identified parameter.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Parameter {
    pub(crate) symbol: &'static str,
    pub(crate) unit: &'static str,
    /// Value, if the data determine it, or if it follows from parameters that the data determine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) value: Option<f64>,
    /// Standard error of ln(value), or of the value itself if the parameter is an exponent; `None`
    /// if `value` is `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) standard_error: Option<f64>,
    /// Value at which the iteration stopped, if the data do not determine the parameter. It is not
    /// a property of the material.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) stopped_at: Option<f64>,
    pub(crate) verdict: String,
    #[serde(skip)]
    pub(crate) identified: bool,
    #[serde(skip)]
    pub(crate) scale: Scale,
}

/// Stored result of an identification.
#[derive(Debug, Clone)]
pub(crate) struct Outcome {
    pub(crate) parameters: Vec<Parameter>,
    /// Verdicts by symbol, when the noise of the recorder is stated.
    pub(crate) verdict_with_noise: Vec<(&'static str, Verdict)>,
    /// δ, the error used in the paper
    pub(crate) relative_error: f64,
    pub(crate) iterations: usize,
    /// True if the fit converged. The criterion that ends the iteration is not stored, because it
    /// depends on the last digits of a machine.
    pub(crate) converged: bool,
    /// Simulated minus measured response over V0, for each test.
    pub(crate) residuals: Vec<Vec<f64>>,
    /// (ln E, parameters of the law)
    pub(crate) solution: Vec<f64>,
}

/// Identifies from the first test, then from the first two, and so on up to all.
pub(crate) fn one_by_one(
    model: ModelKind,
    tests: &[RodTest],
    settings: Settings,
) -> Result<Vec<Outcome>, Error> {
    let mut outcomes: Vec<Outcome> = Vec::new();
    for count in 1..=tests.len() {
        let outcome = identify(model, &tests[..count], settings, outcomes.last())?;
        outcomes.push(outcome);
    }
    Ok(outcomes)
}

/// Settings of the identification.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settings {
    /// Longest cell of the grid in m; if `None`, the cell is chosen for the noise.
    pub(crate) cell: Option<f64>,
    pub(crate) round_trip: bool,
    /// Noise from which the errors of the values follow.
    pub(crate) noise: Noise,
    /// Noise of the recorder, for the second verdict.
    pub(crate) recorder_noise: f64,
}

/// Identifies the law of kind `model` from `tests`. The iteration starts without knowledge of the
/// true values: E from the time of flight, the rate from a scan, and a weak nonlinearity. If
/// `before`, the result of fewer tests, is given, the iteration starts at its parameters.
pub(crate) fn identify(
    model: ModelKind,
    tests: &[RodTest],
    settings: Settings,
    before: Option<&Outcome>,
) -> Result<Outcome, Error> {
    let outcome = match model {
        ModelKind::Maxwell => run(Maxwell::new(1e7)?, tests, settings, before),
        ModelKind::MaxwellNorton => run(
            MaxwellNorton::from_reference_rate(1.2, 1.0, 10e6)?,
            tests,
            settings,
            before,
        ),
        ModelKind::MaxwellGurevichRabinovich => run(
            MaxwellGurevichRabinovich::from_reference_rate(0.2, 1.0, 10e6)?,
            tests,
            settings,
            before,
        ),
    };
    Ok(outcome?)
}

fn run<L: IdentifiableLaw>(
    start: L,
    tests: &[RodTest],
    settings: Settings,
    before: Option<&Outcome>,
) -> Result<Outcome, MaxwellidError> {
    let mut fit = match before.map(|outcome| outcome.solution.split_first()) {
        Some(Some((log_modulus, of_law))) => {
            let law = start
                .with_parameters(of_law)
                .map_err(|source| MaxwellidError::Start { source })?;
            Fit::of(law).starting_from(log_modulus.exp())
        }
        _ => Fit::of(start),
    };
    if let Some(cell) = settings.cell {
        fit = fit.with_cell(cell);
    }
    if settings.round_trip {
        fit = fit.round_trip();
    }
    let identification = fit.to(tests)?;
    let estimates = |noise| {
        identification
            .identifiability(noise)
            .map(|i| i.estimates)
            .unwrap_or_default()
    };
    let judged = estimates(settings.noise);
    let law_is_identified = judged
        .iter()
        .filter(|estimate| estimate.role == Role::Coordinate)
        .all(|estimate| estimate.verdict == Verdict::Identified);
    Ok(Outcome {
        parameters: judged
            .into_iter()
            .map(|estimate| {
                let identified = estimate.verdict == Verdict::Identified;
                // a derived parameter counts as determined if all coordinates of the law are
                // identified and its standard error is below 2
                let determined = identified
                    || law_is_identified
                        && estimate.role == Role::Derived
                        && estimate.standard_error < 2.0;
                Parameter {
                    symbol: estimate.symbol,
                    unit: estimate.unit,
                    value: determined.then_some(estimate.value),
                    standard_error: determined.then_some(estimate.standard_error),
                    stopped_at: (!determined).then_some(estimate.value),
                    verdict: match estimate.role {
                        Role::Coordinate => estimate.verdict.to_string(),
                        Role::Derived => "derived".into(),
                    },
                    identified,
                    scale: estimate.scale,
                }
            })
            .collect(),
        verdict_with_noise: estimates(Noise::Known(settings.recorder_noise))
            .iter()
            .map(|estimate| (estimate.symbol, estimate.verdict))
            .collect(),
        relative_error: identification.relative_error(),
        iterations: identification.iterations(),
        converged: identification.termination().was_successful(),
        residuals: identification.residuals().map(<[f64]>::to_vec).collect(),
        solution: identification.parameters().to_vec(),
    })
}
