//! Trend of the modulus over the hits, and correction of the modulus to a reference temperature.

use cmod::ModulusEstimate;
use cmod::estimate::BudgetedQuantity;
use cmod::hit_trend::{FEWEST_HITS, HitTrend};
use serde::Deserialize;

use super::estimate::deviations;
use super::measured::{Measured, Spectra};
use super::{Found, ModulusSheet};
use crate::digits::{short, significant, with_error};
use crate::median::upper_median;
use crate::outcome::{CHECK, Quantity};
use crate::sheet::{Exact, PerKelvin, Stated, Temperature};
use crate::{InStep, Outcome, RodlabError};

/// Probability below which a trend is reported.
const LEVEL: f64 = 0.01;

/// Temperatures of the hits, and the reference temperature of the modulus.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TemperatureSheet {
    /// Temperatures of all hits in the order in which they are found, including rejected hits, such
    /// as `["23.1 degC", "23.4 degC"]`; or one temperature for all hits.
    pub of_hits: Vec<Exact<Temperature>>,
    /// Temperature to which the modulus is referred, such as `"20 degC"`; by default the
    /// temperature of the test.
    pub reference: Option<Exact<Temperature>>,
    /// Relative change of the modulus per kelvin, such as `"-0.004 1/K ± 0.001 1/K"`; by default
    /// the change determined from the hits.
    pub slope: Option<Stated<PerKelvin>>,
}

/// Trend over the numbers of the hits, or over their temperatures.
pub(super) struct Trend {
    trend: HitTrend,
    over_temperature: bool,
    /// Difference between the numbers of the last and the first hit, or between the highest and the
    /// lowest temperature.
    range: f64,
}

/// Returns the temperatures of the accepted hits \[K\]; `None` if the sheet states none.
fn temperatures(
    sheet: &ModulusSheet,
    measured: &Measured,
) -> Result<Option<Vec<f64>>, RodlabError> {
    let Some(stated) = &sheet.temperature else {
        return Ok(None);
    };
    let all: Vec<f64> = stated.of_hits.iter().map(Exact::si).collect();
    let (numbers, found) = (measured.accepted.iter(), measured.n_found);
    match all.as_slice() {
        [one] => Ok(Some(vec![*one; measured.accepted.len().max(1)])),
        several if several.len() == found && found > 0 => Ok(Some(
            numbers
                .filter_map(|number| several.get(*number).copied())
                .collect(),
        )),
        several => Err(RodlabError::request(
            "temperature.of_hits",
            format!("{} temperatures", several.len()),
            format!("one temperature for each of the {found} hits found, or one for all hits"),
        )),
    }
}

/// Returns the trend; `None` if there are too few hits, or if the method does not give a modulus
/// for each hit.
pub(super) fn trend(
    sheet: &ModulusSheet,
    measured: &Measured,
    (spectra, modulus): (&Spectra, &ModulusEstimate),
) -> Result<Option<Trend>, RodlabError> {
    let temperatures = temperatures(sheet, measured)?;
    if measured.each.len() < FEWEST_HITS {
        return Ok(None);
    }
    let Some(deviations) = deviations(sheet, measured, (spectra, modulus))? else {
        return Ok(None);
    };
    let numbers = || {
        measured
            .accepted
            .iter()
            .map(|number| *number as f64)
            .collect()
    };
    let varies = |values: &Vec<f64>| {
        values
            .windows(2)
            .any(|pair| matches!(pair, [a, b] if a.total_cmp(b).is_ne()))
    };
    let temperatures = temperatures.filter(varies);
    let over_temperature = temperatures.is_some();
    let over: Vec<f64> = temperatures.unwrap_or_else(numbers);
    let trend = HitTrend::of(deviations, &over).in_step("the trend over the hits")?;
    let ends = over
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(*x), high.max(*x))
        });
    Ok(trend.map(|trend| Trend {
        trend,
        over_temperature,
        range: ends.1 - ends.0,
    }))
}

/// Difference, in standard errors, between the stated change with temperature and the change
/// determined from the hits beyond which the two contradict each other. By chance this happens once
/// in a thousand times.
const APART: f64 = 3.3;

/// Reports the trend. A trend from hit to hit that changes E' in total by more than the median
/// standard uncertainty of the valid lines puts the result in doubt.
pub(super) fn state(
    outcome: &mut Outcome,
    found: &Found<'_>,
    trend: &Trend,
) -> Result<(), RodlabError> {
    let HitTrend {
        slope,
        standard_error,
        p_value,
        ..
    } = trend.trend;
    let percent = |value: f64| significant(100.0 * value, 3);
    let of_slope = format!(
        "{} %",
        with_error(Some(100.0 * slope), Some(100.0 * standard_error)).replace('−', "-")
    );
    let is_trend = p_value < LEVEL;
    if trend.over_temperature {
        let name = "change of E' with temperature, by the hits";
        let chance = short(p_value);
        let verdict = format!("probability of such a value without a change: {chance}");
        let quantity = Quantity::of(name, "1/K", slope, verdict);
        outcome.quantities.push(quantity.with_error(standard_error));
        if is_trend {
            let said = format!("E' changes by {of_slope} per kelvin over the hits.");
            outcome.say(said);
        }
        return Ok(());
    }
    let name = format!("{CHECK}no trend of E' from hit to hit, p-value");
    let check = Quantity::of(name, "", p_value, format!("{of_slope} from hit to hit"));
    outcome.quantities.push(check.valid_if(!is_trend));
    if !is_trend {
        return Ok(());
    }
    let whole = slope * trend.range;
    let said = format!(
        "E' changes by {of_slope} from hit to hit, {} % from the first to the last: the temperature changes, or a mounting works loose",
        percent(whole)
    );
    let errors = found.estimate.valid().map(|line| {
        let budget = line.budget(BudgetedQuantity::StorageModulus);
        budget.standard_uncertainty() / line.modulus.re.abs()
    });
    match upper_median(errors) {
        Some(median) if whole.abs() > median => outcome.doubt(said),
        _ => outcome.warn(format!("{said}.")),
    }
    Ok(())
}

/// Returns the modulus at the reference temperature; `None` if the sheet states no reference.
pub(super) fn referred(
    sheet: &ModulusSheet,
    (found, measured): (&ModulusEstimate, &Measured),
    trend: Option<&Trend>,
    outcome: &mut Outcome,
) -> Result<Option<ModulusEstimate>, RodlabError> {
    let Some((stated, reference)) = sheet
        .temperature
        .as_ref()
        .and_then(|stated| Some((stated, stated.reference.as_ref()?)))
    else {
        return Ok(None);
    };
    let temperatures = temperatures(sheet, measured)?.unwrap_or_default();
    let mean = temperatures.iter().sum::<f64>() / temperatures.len() as f64;
    let (slope, error, source) = match (&stated.slope, trend) {
        (Some(slope), trend) => {
            let slope = slope.with_uncertainty();
            let (value, error) = (slope.value, slope.uncertainty());
            if let Some(Trend {
                trend,
                over_temperature: true,
                ..
            }) = trend
                && (value - trend.slope).abs() > APART * error.hypot(trend.standard_error)
            {
                outcome.doubt(format!(
                    "the stated change of the modulus with temperature, {} % per kelvin, contradicts that of the hits, {} %",
                    significant(100.0 * value, 3),
                    with_error(
                        Some(100.0 * trend.slope),
                        Some(100.0 * trend.standard_error)
                    )
                    .replace('−', "-")
                ));
            }
            (value, error, "stated")
        }
        (
            None,
            Some(Trend {
                trend,
                over_temperature: true,
                ..
            }),
        ) => (trend.slope, trend.standard_error, "found from the hits"),
        (None, _) => {
            return Err(RodlabError::request(
                "temperature.slope",
                "missing",
                "the change of the modulus with temperature: only four or more hits at different temperatures determine it",
            ));
        }
    };
    let step = reference.si() - mean;
    let referred = found
        .changed_by(slope * step, (error * step).abs())
        .in_step("temperature.reference")?;
    outcome.say(format!(
        "The modulus is referred to {reference}, {} K from the mean of the test, with the change {source}: {} % ± {} % of E'.",
        significant(step, 3),
        significant(100.0 * slope * step, 3),
        significant(100.0 * (error * step).abs(), 2),
    ));
    Ok(Some(referred))
}
