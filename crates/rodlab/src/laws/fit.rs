//! Fits of laws to lines, reported as sentences, numbers, a table and figures.

use cmod::rheology::{Comparison, ErrorScale, Parameter, RheologicalFit, Scale, TransientTest};
use num_complex::Complex64;
use rodfigure::{Axis, Figure, Mark, Panel, Role};

use super::lines::Lines;
use super::{LawsSheet, WHITE, cards};
use crate::context::JobContext;
use crate::digits::{hertz, prefix_for, significant};
use crate::material_file::{self, MaterialFile};
use crate::outcome::{Attachment, Quantity, Rows, Table, Verdict, shown_unit};
use crate::{InStep, Outcome, RodlabError};

/// Fits the laws of a sheet and adds them to `outcome`. Returns the comparison if at least one law
/// could be fitted. In a Monte Carlo draw, it fits only the laws of the draw, and returns `None`.
pub(crate) fn fit(
    outcome: &mut Outcome,
    lines: &Lines<'_>,
    asked: &LawsSheet,
    context: &JobContext<'_>,
) -> Result<Option<Comparison>, RodlabError> {
    let laws = asked.kinds(lines.density.map(|density| density.value))?;
    let options = asked
        .options(lines.error_scale)
        .with_series_profiles(lines.series_profiles);
    if let Some(draw) = &context.draw {
        let options = options.with_profiles(false).with_series_profiles(false);
        let data = lines
            .data
            .clone()
            .with_scatter_of_weights(|| draw.standard());
        for start in &draw.laws.of_modulus {
            if let Ok(fit) = RheologicalFit::from_start(&data, start, &options) {
                parameters(outcome, &fit);
            }
        }
        return Ok(None);
    }
    let comparison = Comparison::new(lines.data, &laws, &options).in_step("laws")?;
    context.check_cancelled()?;
    for (law, error) in &comparison.refused {
        outcome.reject(format!("law: {law}"), error);
    }
    let Some(best) = comparison.best() else {
        return Ok(None);
    };
    outcome.say(format!(
        "Of {}, the data prefer {}, with chi-square {} and {} degrees of freedom, on {} lines.",
        if laws.len() == 1 {
            "1 law".to_owned()
        } else {
            format!("{} laws", laws.len())
        },
        best.law.law(),
        significant(best.chi_squared, 3),
        best.degrees_of_freedom,
        lines.points.len(),
    ));
    let is_open = |parameter: &Parameter| !parameter.verdict.is_identified();
    let open = best.parameters.iter().filter(|one| is_open(one)).count();
    if open > 0 {
        let band = lines.data.band_hz().map(hertz);
        outcome.warn(format!(
            "The data do not determine {open} of the {} parameters of the preferred law ({}): use it only from {} to {}.",
            best.parameters.len(),
            best.law.law(),
            band[0],
            band[1]
        ));
    }
    if !best.whiteness.is_white(WHITE) {
        outcome.warn(format!(
            "The residuals of the preferred law ({}) are not noise: it is not the law of this material over the whole band, and the \
             errors of its parameters are not reliable.",
            best.law.law()
        ));
    }
    if let Some(chance) = lines.chance
        && lines.error_scale == ErrorScale::Stated
        && best.p_value() < chance
    {
        outcome.doubt(unexplained(best));
    }
    for row in &comparison.rows {
        parameters(outcome, &row.fit);
        if row.fit.law.prony_series().is_none() && !row.fit.parameters.iter().any(is_open) {
            outcome.drawn_laws.of_modulus.push(row.fit.law.clone());
        }
    }
    outcome.tables.push(table(&comparison));
    outcome.figures.extend(figures(lines, &comparison, best));
    attach_material(outcome, lines, best);
    if let Some(cards) = &asked.cards {
        cards::attach(outcome, lines, &comparison, cards)?;
    }
    Ok(Some(comparison))
}

/// Returns the clause that no law explains the lines, with the chi-square of the preferred law.
pub(crate) fn unexplained(best: &RheologicalFit) -> String {
    format!(
        "no law explains the moduli within their stated errors: chi-square of the preferred law ({}) is {} with {} degrees of freedom",
        best.law.law(),
        significant(best.chi_squared, 3),
        best.degrees_of_freedom
    )
}

/// Attaches the preferred law with its errors, for the sheets of later jobs.
fn attach_material(outcome: &mut Outcome, lines: &Lines<'_>, best: &RheologicalFit) {
    let Some(density) = lines.density.filter(|_| lines.is_youngs) else {
        return;
    };
    let mut doubts = Vec::new();
    if !best.whiteness.is_white(WHITE) {
        doubts.push("the residuals of the law are not noise".to_owned());
    }
    if let Verdict::InDoubt { reasons } = &outcome.verdict {
        doubts.extend(reasons.iter().cloned());
    }
    let band_hz = lines.data.band_hz();
    let (title, inputs) = (&outcome.title, &outcome.inputs);
    let file = MaterialFile::of(title, best, density, band_hz, doubts, inputs);
    match file.and_then(|file| file.text()) {
        Ok(bytes) => outcome.attachments.push(Attachment {
            name: material_file::NAME.to_owned(),
            bytes,
        }),
        Err(error) => {
            let said = format!("The material file is not written: {error}.");
            outcome.warn(said);
        }
    }
}

/// Converts an `error` on the scale of the parameter to an error of its value; `None` if the
/// standard error of the parameter is too large for this.
pub(crate) fn of_value(parameter: &Parameter, error: f64) -> Option<f64> {
    match parameter.scale {
        Scale::Ratio if parameter.standard_error < 0.5 => Some(parameter.value * error),
        Scale::Difference => Some(error),
        // the derivative of α with respect to its log odds is α(1 - α)
        Scale::LogOdds if parameter.standard_error < 0.5 => {
            Some(parameter.value * (1.0 - parameter.value) * error)
        }
        _ => None,
    }
    .filter(|error| error.is_finite())
}

fn parameters(outcome: &mut Outcome, fit: &RheologicalFit) {
    let white = fit.whiteness.is_white(WHITE);
    if let Some(limit) = fit.equilibrium_limit {
        let name = format!("{}, equilibrium modulus", fit.law.law());
        let verdict = format!(
            "the series has no equilibrium modulus; up to {} is not excluded",
            significant(limit, 3)
        );
        let quantity = Quantity::of(name, "Pa", None::<f64>, verdict);
        outcome.quantities.push(quantity);
    }
    for parameter in &fit.parameters {
        let identified = parameter.verdict.is_identified();
        let error = of_value(parameter, parameter.standard_error);
        let unit = shown_unit(parameter.unit);
        let (size, prefix) = prefix_for(parameter.value, unit);
        let scaled = |value: f64, digits| significant(value / size, digits);
        let (lower, upper) = (parameter.interval.lower, parameter.interval.upper);
        let within = if lower.is_finite() && upper.is_finite() {
            let range = format!(
                "{} to {} {prefix}{unit}",
                scaled(lower, 4),
                scaled(upper, 4)
            );
            format!("; interval {}", range.trim_end())
        } else {
            String::new()
        };
        let parts = of_value(parameter, parameter.random_error)
            .zip(of_value(parameter, parameter.common_error))
            .filter(|(_, common)| *common > 0.0)
            .map_or_else(String::new, |(random, common)| {
                format!(
                    "; random ± {}, common ± {}",
                    scaled(random, 2),
                    scaled(common, 2)
                )
            });
        let against = match white {
            true => "",
            false => "the law does not fit: the residuals are not noise; ",
        };
        let name = format!("{}, {}", fit.law.law(), parameter.name);
        let verdict = format!("{against}{}{within}{parts}", parameter.verdict);
        let quantity = Quantity::of(name, unit, parameter.value, verdict);
        let quantity = quantity.with_error(error).valid_if(identified && white);
        outcome.quantities.push(quantity);
    }
}

fn table(comparison: &Comparison) -> Table {
    Rows::of(&comparison.rows, "laws", "Laws, the preferred one first")
        .word("law", |row| match row.same_as {
            Some(same) => format!("{} (the same as {same})", row.fit.law.law()),
            None => row.fit.law.law().to_string(),
        })
        .number("parameters", "", |row| row.fit.parameters.len() as f64)
        .number("chi-square", "", |row| row.fit.chi_squared)
        .number("degrees of freedom", "", |row| {
            row.fit.degrees_of_freedom as f64
        })
        .number("BIC", "", |row| row.fit.bic)
        .number("AICc", "", |row| row.fit.aicc)
        .number("weight", "", |row| row.weight)
        .word("residuals", |row| {
            let white = row.fit.whiteness.is_white(WHITE);
            if white { "noise" } else { "not noise" }
        })
        .table
}

/// Figures of the laws over frequency, and over time after a step. A figure without lines is left
/// out.
fn figures(lines: &Lines<'_>, comparison: &Comparison, best: &RheologicalFit) -> Vec<Figure> {
    let (frequency, hertz) = &lines.drawn.frequency;
    let (storage, pascal) = &lines.drawn.storage;
    let all = || 0..lines.data.len();
    let held = |test: TransientTest| -> Vec<(usize, f64)> {
        all()
            .filter(|line| lines.data.test(*line) == Some(test))
            .filter_map(|line| Some((line, lines.data.time(line)?)))
            .collect()
    };
    let swept: Vec<(usize, f64)> = all()
        .filter(|line| lines.data.time(*line).is_none())
        .filter_map(|line| Some((line, hertz * lines.points.get(line)?.0)))
        .collect();
    let rows = comparison.rows.iter();
    // steps instead of ramps, because in reduced time the ramps at different temperatures differ in
    // length
    let steps = lines.data.clone().with_steps();
    let responses: Vec<(String, Vec<Complex64>)> = rows
        .map(|row| (row.fit.law.law().to_string(), row.fit.law.response(&steps)))
        .collect();
    let panel = |x: Axis, y: Axis, places: &[(usize, f64)], of: &dyn Fn(Complex64) -> f64| {
        let at = |moduli: &[Complex64]| -> Vec<f64> {
            let value = |(line, _): &(usize, f64)| moduli.get(*line).map(|modulus| of(*modulus));
            places.iter().filter_map(value).collect()
        };
        let along: Vec<f64> = places.iter().map(|(_, x)| *x).collect();
        let measured = along.iter().copied().zip(at(lines.data.modulus()));
        let mut marks = vec![Mark::points("measured", Role::Faint, measured)];
        for (index, (name, moduli)) in responses.iter().enumerate() {
            let role = Role::of_series(index);
            marks.push(Mark::curve(name.clone(), role, &along, at(moduli)));
        }
        Panel::new(x, y, marks)
    };
    let caption = format!(
        "The preferred law: {}. {}",
        best.law.law(),
        lines.drawn.caption
    );
    let figure = |name: &str, title: &str, panels| {
        Figure::new(name, title, panels).with_caption(caption.clone())
    };
    let mut figures = Vec::new();
    let of_tests: Vec<Panel> = [
        (TransientTest::Relaxation, " of relaxation"),
        (TransientTest::Creep, " of creep"),
    ]
    .into_iter()
    .map(|(test, name)| (held(test), name))
    .filter(|(places, _)| !places.is_empty())
    .map(|(places, name)| {
        let time = Axis {
            label: frequency.label.replace("frequency", "time"),
            unit: "s".to_owned(),
            ..frequency.clone()
        };
        let modulus = Axis {
            label: storage.label.replace('\'', name),
            ..storage.clone()
        };
        panel(time, modulus, &places, &|modulus| pascal * modulus.re)
    })
    .collect();
    if !of_tests.is_empty() {
        let title = "Laws fitted to the modulus over time";
        let own = figure("laws_over_time", title, of_tests);
        figures.push(Figure {
            caption: format!(
                "{} The laws are drawn for a step of the load; points just after a ramp deviate from them.",
                own.caption
            ),
            ..own
        });
    }
    if !swept.is_empty() {
        let factor = Axis::linear("loss factor", "");
        let panels = vec![
            panel(frequency.clone(), storage.clone(), &swept, &|modulus| {
                pascal * modulus.re
            }),
            panel(frequency.clone(), factor, &swept, &|modulus| {
                modulus.im / modulus.re
            }),
        ];
        figures.push(figure("laws", "Laws fitted to the modulus", panels));
    }
    figures
}
