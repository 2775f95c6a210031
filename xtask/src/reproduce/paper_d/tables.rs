//! Tables: the printed and the computed values, with their interpretation.

use maxwellid::Verdict;

use super::super::Table;
use super::super::number::significant;
use super::appendix::{Row, standard_error};
use super::choice;
use super::flat_loss::FlatLoss;
use super::materials::{Excitation, Material};
use testbed::papers::paper_d::{ModelKind, PaperD, UnitReading};

pub(crate) const TABLE_A1: &str = "Table A1: parameters put in and got back, without noise\n\nRound trip: data of the solver that inverts them, as \
    in the paper's appendix. Otherwise a lumped chain that shares nothing with the inversion.";
pub(crate) const TABLE_3: &str = "Table 3: which model, from the first test of each material\n\nP_i by Robbins-Monro recursions over about sixty \
    standard samples a model and six principal components of |v_e - v_r|, as the paper has it; class-conditional conformal p-values; and the \
    posterior probability with the linear competitors. M_1, M_2, M_3 in this order.";
pub(crate) const TABLE_4: &str = "Table 4: identified parameters, four tests each\n\nThe input is what made the data, in the reading of the units; \
    flat striker: both histories seen through the recorder after a front that it cannot follow, identified as in the paper, and with the recorder as \
    part of the model.";
pub(crate) const TABLE_5: &str = "Table 5: error δ of the response with Q = 1, 2, 3, 4 tests, in per cent of V0\n\nThe paper's errors are those of its \
    measurements; ours are the noise put in, 0.8 % on each history, and what the model cannot follow.";
pub(crate) const FLAT_LOSS: &str = "Tables 4 and 5 on linear rods of constant loss\n\nData: a line with Maxwell branches in parallel that stand for the \
    law E0 (s/w0)^2g; modulus of Table 4 at 3 kHz, loss factors of handbooks, one impact velocity, noise as above.";

/// Returns the headings, each with its table.
pub(crate) fn body(sections: &[(&str, &Table)]) -> String {
    sections
        .iter()
        .map(|(heading, table)| format!("## {heading}\n\n{}\n", table.markdown()))
        .collect()
}

fn per_cent(ratio: f64) -> String {
    if ratio.abs() < 1e-8 {
        "< 1e-6 %".into()
    } else {
        format!("{} %", significant(100.0 * ratio.abs(), 2))
    }
}

fn in_per_cent(errors: &[f64]) -> Vec<String> {
    errors.iter().map(|e| format!("{:.2}", 100.0 * e)).collect()
}

pub(crate) fn introduction(paper: &PaperD) -> String {
    let mut text = format!(
        "I. N. Trendafilova, S. Ödeen and B. Lundberg, Identification of viscoelastic materials from two-point \
         electro-optical displacement measurements on an impacted rod (Ödeen 1993, paper D).\n\n\
         **All tests are virtual**: the measured histories of the paper were never published. The units of Tables 4 and \
         A1 have no consistent reading: {}. Each table names the reading it uses:\n\n",
        paper.no_consistent_reading
    );
    for reading in UnitReading::ALL {
        text.push_str(&format!("- {}\n", reading.description()));
    }
    text
}

pub(crate) fn table_a1(rows: &[Row]) -> Table {
    let mut table = Table::new(&[
        "data",
        "reading",
        "model",
        "",
        "input printed",
        "input SI",
        "paper's output",
        "paper's error",
        "our output SI",
        "our error",
        "standard error",
        "10 % of it moves the response by",
        "verdict without noise",
        "verdict with 2 % noise",
    ]);
    for row in rows {
        let reading = row.reading.split(':').next().unwrap_or_default();
        for line in &row.lines {
            let parameter = &line.parameter;
            table.row([
                if row.at_rounding.is_some() {
                    "round trip".to_owned()
                } else {
                    "lumped chain".into()
                },
                reading.into(),
                row.model.into(),
                parameter.symbol.into(),
                line.printed_input.clone().unwrap_or("-".into()),
                format!("{} {}", significant(line.input, 4), parameter.unit),
                line.printed_output.clone().unwrap_or("-".into()),
                line.printed_relative_error.map_or("-".into(), per_cent),
                parameter.value.map_or("-".into(), |v| significant(v, 5)),
                line.relative_error.map_or("-".into(), per_cent),
                standard_error(parameter),
                line.influence_of_ten_per_cent
                    .map_or("-".into(), |influence| {
                        format!("{} % of V0", significant(100.0 * influence, 2))
                    }),
                parameter.verdict.clone(),
                line.verdict_with_noise.clone(),
            ]);
        }
    }
    table
}

pub(crate) fn table_3(rows: &[choice::Row]) -> Table {
    let mut table = Table::new(&[
        "material",
        "data",
        "P_i printed",
        "their sum",
        "P_i, least mean square",
        "their sum",
        "P_i, increments",
        "conformal p",
        "posterior of M_1, M_2, M_3",
        "posterior of linear competitors",
        "decision",
    ]);
    let list = |values: &[f64]| {
        let values: Vec<String> = values.iter().map(|v| format!("{v:.2}")).collect();
        values.join(", ")
    };
    for row in rows {
        let probability = |name: &str| {
            row.selection
                .probabilities
                .iter()
                .find(|(law, _)| law == name)
                .map_or(0.0, |(_, probability)| *probability)
        };
        let of_models = MODELS.map(|model| probability(name_of_model(model.symbol())));
        table.row([
            row.material.clone(),
            row.truth.map_or(row.data.to_owned(), |model| {
                format!("{model}, {}", row.data)
            }),
            list(&row.printed),
            format!("{:.2}", row.printed.iter().sum::<f64>()),
            list(&row.least_mean_square),
            format!("{:.2}", row.least_mean_square.iter().sum::<f64>()),
            list(&row.increment),
            list(&row.conformal),
            list(&of_models),
            format!("{:.2}", 1.0 - of_models.iter().sum::<f64>()),
            row.selection.decision.clone(),
        ]);
    }
    table
}

pub(crate) fn table_4(materials: &[Material]) -> Table {
    let mut table = Table::new(&[
        "reading",
        "material",
        "model",
        "",
        "input SI",
        "identified SI",
        "standard error",
        "deviation / standard error",
        "verdict",
    ]);
    for material in materials {
        for line in &material.lines {
            let parameter = &line.parameter;
            table.row([
                name_of(material),
                material.material.clone(),
                material.model.into(),
                parameter.symbol.into(),
                format!("{} {}", significant(line.input, 4), parameter.unit),
                parameter.value.map_or("-".into(), |v| significant(v, 4)),
                standard_error(parameter),
                line.deviation.map_or("-".into(), |d| format!("{d:+.1}")),
                parameter.verdict.clone(),
            ]);
        }
    }
    table
}

pub(crate) fn table_5(materials: &[Material]) -> Table {
    let mut table = Table::new(&[
        "material", "model", "reading", "Q = 1", "Q = 2", "Q = 3", "Q = 4", "paper",
    ]);
    for material in materials {
        let mut cells = vec![
            material.material.clone(),
            material.model.into(),
            name_of(material),
        ];
        cells.extend(in_per_cent(&material.errors));
        cells.push(in_per_cent(&material.printed_errors).join(", "));
        table.row(cells);
    }
    table
}

pub(crate) fn flat_loss(rows: &[FlatLoss]) -> Table {
    let mut table = Table::new(&[
        "material",
        "loss factor put in",
        "model of the paper",
        "becomes",
        "Q = 1",
        "Q = 2",
        "Q = 3",
        "Q = 4",
        "paper",
        "elastic",
        "constant loss",
        "loss factor found",
        "decision",
    ]);
    for row in rows {
        let mut cells = vec![
            row.material.clone(),
            format!("{}", row.loss_factor),
            row.model.into(),
            row.shape().unwrap_or("-".into()),
        ];
        cells.extend(in_per_cent(&row.errors));
        cells.extend([
            in_per_cent(&row.printed_errors).join(", "),
            format!("{:.2}", 100.0 * row.elastic_error),
            format!("{:.2}", 100.0 * row.flat_loss_error),
            format!(
                "{} ± {} %",
                significant(row.loss_factor_found, 3),
                significant(100.0 * row.standard_error, 2)
            ),
            row.selection.decision.clone(),
        ]);
        table.row(cells);
    }
    table
}

/// Returns the reading of the units and the kind of data in two or three words.
fn name_of(material: &Material) -> String {
    let reading = material
        .reading_in_words
        .split(':')
        .next()
        .unwrap_or_default();
    match material.excitation {
        Excitation::AsRecorded => reading.into(),
        Excitation::Struck => format!("{reading}, flat striker"),
        Excitation::ThroughRecorder => format!("{reading}, flat striker, recorder in the model"),
    }
}

pub(crate) fn conclusion(
    rows: &[Row],
    choices: &[choice::Row],
    materials: &[Material],
    flat_losses: &[FlatLoss],
) -> Vec<String> {
    let mut sentences = Vec::new();
    let worst = |data: fn(&Row) -> bool, symbol: &str| {
        rows.iter()
            .filter(|row| data(row))
            .flat_map(|row| &row.lines)
            .filter(|line| line.parameter.symbol == symbol)
            .filter_map(|line| line.relative_error)
            .fold(0.0_f64, |worst, error| worst.max(error.abs()))
    };
    for (way, round_trip) in [
        ("as the paper did it", true),
        ("with data of another solver", false),
    ] {
        let printed: Vec<_> = rows
            .iter()
            .filter(|row| row.at_rounding.is_some() == round_trip)
            .flat_map(|row| &row.lines)
            .filter_map(|line| Some((line.relative_error, line.printed_relative_error?)))
            .collect();
        let within = printed
            .iter()
            .filter(|(ours, paper)| ours.is_some_and(|ours| ours.abs() <= *paper))
            .count();
        sentences.push(format!("Table A1, {way}: {within} of {} printed parameters come back within the paper's own relative error.",
            printed.len()
        ));
    }
    sentences.push(format!("With data of another solver E is off by {} at most. What is left of B and m there is what the two solvers differ by, \
         a few parts in a million of V0: neither parameter would be seen in a record with noise.",
        per_cent(worst(|row| row.relative_error.is_some(), "E"))
    ));
    let mut groups: Vec<Vec<&Material>> = Vec::new();
    for material in materials {
        match groups.last_mut() {
            Some(group) if name_of(group[0]) == name_of(material) => group.push(material),
            _ => groups.push(vec![material]),
        }
    }
    for group in groups {
        let identified = group
            .iter()
            .filter(|m| m.damping_verdict() == Verdict::Identified)
            .count();
        let biased = group.iter().filter(|m| m.biased() > 0).count();
        let of_biased = if biased > 0 {
            let off = group
                .iter()
                .filter(|m| m.biased() > 0)
                .flat_map(|m| &m.lines)
                .filter_map(|line| line.deviation)
                .fold(0.0_f64, |worst, d| worst.max(d.abs()));
            format!(
                "; the excitations of {biased} hold more than their recorder passes, and what the paper's procedure concludes from them, which \
                 knows no recorder, is up to {off:.0} of its standard errors off"
            )
        } else {
            String::new()
        };
        let deviations: Vec<f64> = group
            .iter()
            .filter(|m| m.biased() == 0)
            .flat_map(|m| &m.lines)
            .filter(|line| line.parameter.verdict != "derived")
            .filter_map(|line| line.deviation)
            .collect();
        let within = deviations.iter().filter(|d| d.abs() < 2.0).count();
        sentences.push(format!("Table 4, {}: the damping of {identified} of {} materials is identified; {within} of {} identified \
             parameters lie within two standard errors of the value put in{of_biased}.",
            name_of(group[0]),
            group.len(),
            deviations.len()
        ));
    }
    sentences.push(String::from("A flat striker makes a front that the recorder's filter rounds. A linear rod commutes with that filter; a \
         nonlinear one does not, and its parameters come out biased by many standard errors although the residual hardly \
         grows. An excitation that the recorder can follow (a rounded or padded striker) removes the bias, and so does the \
         recorder as part of the model."
    ));
    sentences.extend(of_choice(choices));
    sentences.extend(of_flat_loss(flat_losses));
    sentences.push(
        "Not reproduced: the digits of Table 3, which do not follow from what the paper states, and the measured histories, which were \
         not published."
            .into(),
    );
    sentences
}

/// Describes the result of Table 3 in words.
fn of_choice(choices: &[choice::Row]) -> Vec<String> {
    let sums: Vec<f64> = choices.iter().map(|row| row.printed.iter().sum()).collect();
    let (least, most) = extent(&sums);
    let ours: Vec<f64> = choices
        .iter()
        .map(|row| row.least_mean_square.iter().sum())
        .collect();
    let (our_least, our_most) = extent(&ours);
    let hits = |measures: fn(&choice::Row) -> &[f64]| {
        let of_law: Vec<_> = choices.iter().filter(|row| row.truth.is_some()).collect();
        let right = of_law
            .iter()
            .filter(|row| largest(measures(row)).map(symbol_of) == row.truth)
            // the increments tend to the median of a variable that is 0 or 1, so all measures may
            // vanish
            .filter(|row| extent(measures(row)).1 > 0.05)
            .count();
        format!("{right} of {}", of_law.len())
    };
    let right = choices
        .iter()
        .filter(|row| row.truth.is_some())
        .filter(|row| row.selection.named.as_deref() == row.truth.map(name_of_model))
        .count();
    let wrong = choices
        .iter()
        .filter(|row| row.truth.is_some())
        .filter(|row| {
            row.selection.named.is_some()
                && row.selection.named.as_deref() != row.truth.map(name_of_model)
        })
        .count();
    let of_law = choices.iter().filter(|row| row.truth.is_some()).count();
    let flat = choices.iter().filter(|row| row.truth.is_none());
    let trapped = flat
        .clone()
        .filter(|row| row.selection.names_a_nonlinear_law)
        .count();
    vec![
        format!(
            "Table 3: the printed measures of a material sum to {least:.2} to {most:.2}. Estimates of all classes by least mean square from the \
             same samples sum to one at the limit, ours to {our_least:.2} to {our_most:.2}, so the paper's are another thing: separate \
             problems, corrections by sign, or iterations that were ended early. Nothing was tuned to them."
        ),
        format!(
            "Table 3, data of the law of Table 4: the largest P_i names it in {} cases by least mean square, {} by increments; the largest \
             conformal p-value in {}. The posterior names it in {right} of {of_law} and another law in {wrong}; for the rest one test of one \
             velocity cannot tell.",
            hits(|row| &row.least_mean_square),
            hits(|row| &row.increment),
            hits(|row| &row.conformal),
        ),
        format!(
            "Table 3, data of constant loss: every P_i names one of three wrong laws; the selection names a nonlinear law in {trapped} of {} cases.",
            flat.count()
        ),
    ]
}

/// Describes the tables for constant loss in words.
fn of_flat_loss(flat_losses: &[FlatLoss]) -> Vec<String> {
    let per_cent_of = |values: Vec<f64>| {
        let (least, most) = extent(&values);
        format!("{:.1} to {:.1} %", 100.0 * least, 100.0 * most)
    };
    let last = |row: &FlatLoss| row.errors.last().copied().unwrap_or(f64::NAN);
    let shapes: Vec<String> = flat_losses
        .iter()
        .filter_map(|row| Some(format!("{}: {}", row.material, row.shape()?)))
        .collect();
    let printed = flat_losses
        .iter()
        .filter_map(|row| row.printed_errors.last().copied())
        .collect();
    let alike: Vec<String> = flat_losses
        .iter()
        .filter(|row| last(row) < 2.0 * row.printed_errors.last().copied().unwrap_or(f64::NAN))
        .map(|row| row.material.clone())
        .collect();
    let trapped = flat_losses
        .iter()
        .filter(|row| row.selection.names_a_nonlinear_law)
        .count();
    vec![
        format!(
            "Linear rods of constant loss: the law of the paper leaves {} of V0 with four tests, an elastic rod {}, constant loss {}. A Maxwell law \
             cannot follow a loss that is flat over frequency. What it leaves is within a factor of two of the printed errors ({}) for {}; the \
             others would have to be less lossy, or their records to hold less of the high frequencies.",
            per_cent_of(flat_losses.iter().map(last).collect()),
            per_cent_of(flat_losses.iter().map(|row| row.elastic_error).collect()),
            per_cent_of(flat_losses.iter().map(|row| row.flat_loss_error).collect()),
            per_cent_of(printed),
            if alike.is_empty() {
                "none of the materials".to_owned()
            } else {
                alike.join(", ")
            },
        ),
        format!(
            "The nonlinear laws fitted to these linear rods come out with {}: shapes of a nonlinearity that is not there, and the errors \
             of the fit do not say so. The selection names a nonlinear law in {trapped} of {} cases.",
            if shapes.is_empty() {
                "no identified shape".to_owned()
            } else {
                shapes.join(", ")
            },
            flat_losses.len(),
        ),
    ]
}

fn extent(values: &[f64]) -> (f64, f64) {
    values.iter().fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, most), value| (least.min(*value), most.max(*value)),
    )
}

fn largest(values: &[f64]) -> Option<usize> {
    (0..values.len()).max_by(|a, b| values[*a].total_cmp(&values[*b]))
}

const MODELS: [ModelKind; 3] = [
    ModelKind::Maxwell,
    ModelKind::MaxwellNorton,
    ModelKind::MaxwellGurevichRabinovich,
];

fn symbol_of(index: usize) -> &'static str {
    MODELS[index].symbol()
}

/// Returns the name that the law of a printed model symbol has among the candidates of a selection.
fn name_of_model(symbol: &str) -> &'static str {
    match MODELS.iter().find(|model| model.symbol() == symbol) {
        Some(ModelKind::MaxwellNorton) => "Maxwell-Norton",
        Some(ModelKind::MaxwellGurevichRabinovich) => "Maxwell-Gurevich-Rabinovich",
        _ => "Maxwell",
    }
}
