//! Table, figure and sentences of the causal estimate of all lines.

use cmod::causal::CausalEstimate;
use cmod::rheology::PredictedModulus;
use num_complex::Complex64;
use rodfigure::{Axis, Figure, Mark, Panel, Role};

use super::lines::Drawn;
use crate::digits::{hertz, percent, significant};
use crate::outcome::{Rows, Table};
use crate::{InStep, Outcome, RodlabError};

/// Half width of a band, in standard errors.
const BAND: f64 = 2.0;

/// Lines and axes for the figure and the table of the estimate.
pub(crate) struct Shown<'a> {
    /// Symbol of the modulus.
    pub(crate) symbol: &'a str,
    /// Name of the frequency.
    pub(crate) frequency: &'a str,
    /// Frequency \[Hz\] and modulus \[Pa\] of each valid line.
    pub(crate) points: Vec<(f64, Complex64)>,
    /// Axes, and the unit of moduli in the table.
    pub(crate) drawn: Drawn,
    pub(crate) pascal: (&'a str, f64),
    /// Probability below which the lines contradict causality; `None` if their errors are not
    /// known.
    pub(crate) level: Option<f64>,
}

/// Modulus of a line with its standard errors \[Pa\].
struct Line {
    frequency_hz: f64,
    modulus: Complex64,
    /// Variances of E' and E'', and their covariance.
    all: [f64; 3],
    /// Variances and covariance of the random part.
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

/// Reports the estimate, or the reason why there is none.
pub(crate) fn state(
    outcome: &mut Outcome,
    shown: &Shown<'_>,
    estimate: Result<CausalEstimate, RodlabError>,
) -> Result<(), RodlabError> {
    let estimate = match estimate {
        Ok(estimate) => estimate,
        Err(error) => {
            outcome.warn(format!("There is no causal estimate: {error}."));
            return Ok(());
        }
    };
    let lines: Vec<Line> = estimate
        .lines()
        .iter()
        .map(|line| {
            let found = estimate.at(line.frequency_hz);
            let found = found.in_step("finding the causal modulus")?;
            Ok(Line::new(line.frequency_hz, line.distance, &found))
        })
        .collect::<Result<_, RodlabError>>()?;
    outcome.say(in_words(&estimate, &lines, shown));
    let p_value = estimate.p_value();
    if shown.level.is_some_and(|level| p_value < level) {
        outcome.doubt(format!(
            "the lines contradict every relaxing material (p = {}), so the causal estimate does not describe the specimen",
            significant(p_value, 2)
        ));
    }
    if !estimate.is_at_rest() {
        outcome.warn(format!(
            "The causal estimate had not converged after {} iterations; its errors are not valid.",
            estimate.rounds()
        ));
    }
    outcome.tables.push(table(&lines, shown));
    outcome.figures.push(figure(&lines, shown));
    Ok(())
}

fn in_words(estimate: &CausalEstimate, lines: &[Line], shown: &Shown<'_>) -> String {
    let [lowest, highest] = estimate.band_hz();
    let middle = (lowest * highest).sqrt();
    let near = lines.iter().min_by(|a, b| {
        let away = |line: &Line| (line.frequency_hz / middle).ln().abs();
        away(a).total_cmp(&away(b))
    });
    let of_middle = near.map_or_else(String::new, |line| {
        format!(
            ": at {} {}' ± {} and loss factor {} ± {}",
            hertz(line.frequency_hz),
            shown.symbol,
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
            " Errors found from the lines, in units of their stated standard uncertainties: {}.",
            told.join(", ")
        )
    };
    let probability = if shown.level.is_some() {
        format!(" (p = {})", significant(estimate.p_value(), 2))
    } else {
        String::new()
    };
    format!(
        "Causal estimate of {} lines from {} to {}{of_middle}. The lines deviate from it by {} of their standard errors{probability}.{told}",
        lines.len(),
        hertz(lowest),
        hertz(highest),
        significant(estimate.distance(), 2),
    )
}

fn table(lines: &[Line], shown: &Shown<'_>) -> Table {
    let (unit, pascal) = shown.pascal;
    let (storage, loss) = (format!("{}'", shown.symbol), format!("{}''", shown.symbol));
    let error_of = |symbol: &str| format!("standard error of {symbol}");
    let covariance = format!("covariance of {storage} and {loss}");
    Rows::of(lines, "causal", "Causal modulus of all lines together")
        .number(shown.frequency, "Hz", |l| l.frequency_hz)
        .number(&storage, unit, |l| l.modulus.re / pascal)
        .number(error_of(&storage), unit, |l| l.all[0].sqrt() / pascal)
        .number(&loss, unit, |l| l.modulus.im / pascal)
        .number(error_of(&loss), unit, |l| l.all[1].sqrt() / pascal)
        .number(covariance, format!("{unit}^2"), |l| {
            l.all[2] / pascal.powi(2)
        })
        .number("loss factor", "", Line::loss_factor)
        .number(error_of("the loss factor"), "", |l| {
            l.error_of_loss_factor(l.all)
        })
        .number(format!("random error of {storage}"), unit, |l| {
            l.random[0].sqrt() / pascal
        })
        .number("random error of the loss factor", "", |l| {
            l.error_of_loss_factor(l.random)
        })
        .number("distance of the line", "standard errors", |l| l.distance)
        .table
}

/// Figure of the causal modulus with its band, and of the lines.
fn figure(lines: &[Line], shown: &Shown<'_>) -> Figure {
    let (frequency, hertz) = &shown.drawn.frequency;
    let (storage, pascal) = &shown.drawn.storage;
    let panel = |axis: Axis, value: &dyn Fn(Complex64) -> f64, error: &dyn Fn(&Line) -> f64| {
        let at = |l: &Line| hertz * l.frequency_hz;
        let curve = lines.iter().map(|l| (at(l), value(l.modulus)));
        let band = lines.iter().map(|l| {
            let (value, error) = (value(l.modulus), BAND * error(l));
            (at(l), value - error, value + error)
        });
        let points = shown.points.iter().map(|(f, e)| (hertz * f, value(*e)));
        let marks = vec![
            Mark::points("valid lines", Role::Faint, points),
            Mark::band("two standard errors", Role::First, band),
            Mark::line("causal", Role::First, curve),
        ];
        Panel::new(frequency.clone(), axis, marks)
    };
    let panels = vec![
        panel(storage.clone(), &|modulus| pascal * modulus.re, &|line| {
            pascal * line.all[0].sqrt()
        }),
        panel(
            Axis::linear("loss factor", ""),
            &|modulus| modulus.im / modulus.re,
            &|line| line.error_of_loss_factor(line.all),
        ),
    ];
    let caption = format!(
        "The relaxing material nearest to all lines together, with a band of two standard errors, which are correlated between frequencies. {}",
        shown.drawn.caption
    );
    Figure::new("causal", "Causal modulus", panels).with_caption(caption.trim_end())
}
