//! Judgement of the lines of a response, and columns of their errors.

use labio::{Coherence, FrequencyResponse, MergedResponse};

use super::MOST_FREEDOM;
use crate::median::upper_median;
use crate::outcome::Table;
use crate::{InStep, RodlabError};

/// Findings about a line.
pub(crate) struct JudgedLine {
    /// True if the coherence is higher than noise alone would reach, or if there is none.
    pub(crate) is_coherent: bool,
    /// True if the bias due to the noise at rest exceeds the random error.
    pub(crate) is_biased: bool,
    /// True if the magnitude is below [`LEAST_SIGNAL`] times the median standard error of this line
    /// and its neighbours. If such a line is coherent by its own error, noise has probably reduced
    /// the error or increased the magnitude, which is then too large on average.
    pub(crate) is_weak: bool,
}

/// Least magnitude in standard errors of the complex value.
const LEAST_SIGNAL: f64 = 4.0;
/// Number of neighbouring lines on each side of a line.
const NEIGHBOURS: usize = 8;

/// Judges every line of `response` by the `coherences` of its tests, and by the noise at rest.
pub(crate) fn judged_lines(
    response: &FrequencyResponse,
    coherences: &[Coherence],
    merged: Option<&MergedResponse>,
) -> Result<Vec<JudgedLine>, RodlabError> {
    let levels = coherences
        .iter()
        .map(|coherence| coherence.chance_level(Coherence::CHANCE))
        .collect::<Result<Vec<_>, _>>()
        .in_step("the level of chance")?;
    let errors = response.random_error();
    let is_weak = |line: usize| {
        let variance = response.variance.as_ref()?;
        let around = variance.get(line.saturating_sub(NEIGHBOURS)..)?;
        let around = around.iter().take(2 * NEIGHBOURS + 1).copied();
        let noise = upper_median(around.filter(|variance| variance.is_finite()))?;
        let value = response.values.get(line)?;
        Some(value.norm_sqr() < LEAST_SIGNAL.powi(2) * noise)
    };
    let of_line = |line: usize| {
        let above = |(coherence, level): (&Coherence, &f64)| {
            let value = coherence.values.get(line);
            value.is_some_and(|value| value > level)
        };
        let bias = response.noise_bias.as_ref().and_then(|b| b.get(line));
        let error = errors.as_ref().and_then(|errors| errors.get(line));
        JudgedLine {
            is_coherent: match merged {
                Some(merged) => merged.coherent.get(line).copied().unwrap_or(false),
                None => coherences.is_empty() || coherences.iter().zip(&levels).any(above),
            },
            is_biased: bias
                .zip(error)
                // the bias is NaN on a line that contains only noise
                .is_some_and(|(bias, error)| bias.is_nan() || bias.abs() > error.magnitude),
            is_weak: is_weak(line).unwrap_or(false),
        }
    };
    Ok((0..response.validity.len()).map(of_line).collect())
}

/// The table with the degrees of freedom, the biases and the common error of `lines`, as far as
/// these are known.
pub(crate) fn with_errors(
    mut table: Table,
    response: &FrequencyResponse,
    lines: impl Iterator<Item = usize> + Clone,
) -> Table {
    let of = |list: &[f64], value: fn(&f64) -> f64| -> Vec<f64> {
        let values = lines.clone().filter_map(|line| list.get(line));
        values.map(value).collect()
    };
    if let Some(freedom) = &response.degrees_of_freedom {
        let freedom = of(freedom, |freedom| freedom.clamp(0.0, MOST_FREEDOM));
        table = table.numbers("degrees of freedom of the errors", "", freedom);
    }
    let by_noise = "possible bias of the magnitude by noise";
    for (name, list) in [
        (
            "bias of the magnitude by noise at rest",
            &response.noise_bias,
        ),
        (by_noise, &response.possible_bias),
        ("error that lines share", &response.common_error),
    ] {
        if let Some(list) = list {
            table = table.numbers(name, "%", of(list, |value| 100.0 * value));
        }
    }
    table
}
