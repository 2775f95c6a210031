//! The causal estimate of all lines: table, figure, sentences.

use cmod::CmodError;
use cmod::causal::CausalEstimate;
use cmod::rheology::PredictedModulus;
use num_complex::Complex64;
use rodfigure::{Axis, Figure, Mark, Panel, Role};

use super::Found;
use crate::digits::{hertz, percent, significant};
use crate::outcome::{Column, Table};
use crate::{Outcome, RodlabError};

/// Half the width of a band, in standard errors.
const BAND: f64 = 2.0;

/// Modulus of a line with its standard errors \[Pa\].
struct Line {
    frequency_hz: f64,
    modulus: Complex64,
    /// Variances of E' and E'', and their covariance.
    all: [f64; 3],
    /// The same of the random part.
    random: [f64; 3],
    distance: f64,
}

impl Line {
    fn new(frequency_hz: f64, distance: f64, found: &PredictedModulus) -> Self {
        let parts = |[[storage, mixed], [_, loss]]: [[f64; 2]; 2]| [storage, loss, mixed];
        Self {
            frequency_hz,
            modulus: found.modulus,
            all: parts(found.covariance),
            random: parts(found.random_covariance),
            distance,
        }
    }

    fn loss_factor(&self) -> f64 {
        self.modulus.im / self.modulus.re
    }

    /// Returns the standard error of the loss factor, d(E''/E') = (dE'' - E''/E' dE')/E'.
    fn error_of_loss_factor(&self, [storage, loss, mixed]: [f64; 3]) -> f64 {
        let factor = self.loss_factor();
        let square = loss - 2.0 * factor * mixed + factor * factor * storage;
        square.max(0.0).sqrt() / self.modulus.re.abs()
    }
}

/// States the estimate, or why there is none.
pub(super) fn state(
    outcome: &mut Outcome,
    found: &Found<'_>,
    estimate: Result<CausalEstimate, RodlabError>,
) -> Result<(), RodlabError> {
    let estimate = match estimate {
        Ok(estimate) => estimate,
        Err(error) => {
            outcome
                .warnings
                .push(format!("There is no causal estimate: {error}."));
            return Ok(());
        }
    };
    let refused = |error: CmodError| RodlabError::step("finding the causal modulus", error);
    let lines: Vec<Line> = estimate
        .lines()
        .iter()
        .map(|line| {
            let found = estimate.at(line.frequency_hz)?;
            Ok(Line::new(line.frequency_hz, line.distance, &found))
        })
        .collect::<Result<_, _>>()
        .map_err(refused)?;
    outcome.summary.push(in_words(&estimate, &lines));
    let p_value = estimate.p_value();
    if p_value < found.sheet.checks.level()? {
        outcome.doubt(format!(
            "the lines contradict every relaxing material (p = {}), and the causal estimate is not that of the specimen",
            significant(p_value, 2)
        ));
    }
    let left = found.estimate.valid().map(|line| {
        let bound = line.lateral_inertia_bound().storage_modulus;
        bound / line.modulus.re
    });
    let left = left.fold(0.0, f64::max);
    if left > 0.0 {
        outcome.warnings.push(format!(
            "The causal estimate is that of a rod without lateral inertia: its E' is too small by at most {}, which is not in its errors.",
            percent(left)
        ));
    }
    if !estimate.is_at_rest() {
        outcome.warnings.push(format!(
            "The causal estimate was not at rest after {} rounds; its errors are not those of a minimum.",
            estimate.rounds()
        ));
    }
    outcome.tables.push(table(&lines));
    outcome.figures.push(figure(found, &lines));
    Ok(())
}

fn in_words(estimate: &CausalEstimate, lines: &[Line]) -> String {
    let [lowest, highest] = estimate.band_hz();
    let middle = (lowest * highest).sqrt();
    let near = lines.iter().min_by(|a, b| {
        let away = |line: &Line| (line.frequency_hz / middle).ln().abs();
        away(a).total_cmp(&away(b))
    });
    let of_middle = near.map_or_else(String::new, |line| {
        format!(
            ": at {} E' ± {} and loss factor {} ± {}",
            hertz(line.frequency_hz),
            percent(line.all[0].sqrt() / line.modulus.re),
            significant(line.loss_factor(), 3),
            percent(line.error_of_loss_factor(line.all) / line.loss_factor()),
        )
    });
    let sizes = estimate
        .sources()
        .iter()
        .filter(|source| source.standard_error < 0.5);
    let told: Vec<String> = sizes
        .map(|source| {
            format!(
                "{} {} ± {}",
                source.source,
                significant(source.size, 2),
                significant(source.standard_error, 2)
            )
        })
        .collect();
    let told = if told.is_empty() {
        String::new()
    } else {
        format!(
            " The lines find, in stated standard uncertainties: {}.",
            told.join(", ")
        )
    };
    format!(
        "Causal estimate of {} lines from {} to {}{of_middle}. The lines lie {} of their standard errors from it (p = {}).{told}",
        lines.len(),
        hertz(lowest),
        hertz(highest),
        significant(estimate.distance(), 2),
        significant(estimate.p_value(), 2),
    )
}

fn table(lines: &[Line]) -> Table {
    let numbers = |name: &str, unit: &str, value: &dyn Fn(&Line) -> f64| {
        Column::numbers(name, unit, lines.iter().map(value).collect())
    };
    let giga = 1e-9;
    Table {
        name: "causal".to_owned(),
        title: "Causal modulus of all lines together".to_owned(),
        columns: vec![
            numbers("frequency", "Hz", &|l| l.frequency_hz),
            numbers("E'", "GPa", &|l| giga * l.modulus.re),
            numbers("standard error of E'", "GPa", &|l| giga * l.all[0].sqrt()),
            numbers("E''", "GPa", &|l| giga * l.modulus.im),
            numbers("standard error of E''", "GPa", &|l| giga * l.all[1].sqrt()),
            numbers("covariance of E' and E''", "GPa^2", &|l| {
                giga * giga * l.all[2]
            }),
            numbers("loss factor", "", &Line::loss_factor),
            numbers("standard error of the loss factor", "", &|l| {
                l.error_of_loss_factor(l.all)
            }),
            numbers("random error of E'", "GPa", &|l| giga * l.random[0].sqrt()),
            numbers("random error of the loss factor", "", &|l| {
                l.error_of_loss_factor(l.random)
            }),
            numbers("distance of the line", "standard errors", &|l| l.distance),
        ],
    }
}

/// The material with its band over the lines.
fn figure(found: &Found<'_>, lines: &[Line]) -> Figure {
    let measured = found.estimate.valid();
    let points: Vec<(f64, Complex64)> = measured
        .map(|line| (1e-3 * line.frequency_hz, line.modulus))
        .collect();
    let panel = |axis: Axis, value: &dyn Fn(Complex64) -> f64, error: &dyn Fn(&Line) -> f64| {
        let curve = lines
            .iter()
            .map(|l| (1e-3 * l.frequency_hz, value(l.modulus)));
        let band = lines.iter().map(|l| {
            let (value, error) = (value(l.modulus), BAND * error(l));
            (1e-3 * l.frequency_hz, value - error, value + error)
        });
        let marks = vec![
            Mark::points(
                "valid lines",
                Role::Faint,
                points.iter().map(|(f, e)| (*f, value(*e))),
            ),
            Mark::band("two standard errors", Role::First, band),
            Mark::line("causal", Role::First, curve),
        ];
        Panel::new(("frequency", "kHz"), axis, marks)
    };
    let storage = panel(
        Axis::linear("E'", "GPa"),
        &|modulus| 1e-9 * modulus.re,
        &|line| 1e-9 * line.all[0].sqrt(),
    );
    let loss = panel(
        Axis::linear("loss factor", ""),
        &|modulus| modulus.im / modulus.re,
        &|line| line.error_of_loss_factor(line.all),
    );
    Figure {
        caption: "The relaxing material nearest to all lines together, with a band of two standard errors that its frequencies share."
            .to_owned(),
        ..Figure::new("causal", "Causal modulus", vec![storage, loss])
    }
}
