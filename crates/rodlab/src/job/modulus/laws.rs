//! Laws fitted to the valid lines, and cards for programs that use material models.

use cmod::ModulusLine;
use cmod::rheology::{
    Comparison, Criterion, ErrorScale, FitOptions, Law, ModulusData, Parameter, RheologicalFit,
    Scale,
};
use serde::Deserialize;

use super::{Found, cards};
use crate::chosen::Chosen;
use crate::digits::significant;
use crate::figure::{Axis, Figure, Mark, Panel, Role};
use crate::job::Surroundings;
use crate::material_file::{self, MaterialFile};
use crate::outcome::{Attachment, Column, LogEntry, Quantity, Table, Verdict};
use crate::sheet::{Exact, Frequency, PoissonRatio, Ratio, Stated, Temperature};
use crate::{Outcome, RodlabError};

/// Default of the largest number of fitted lines.
const MOST_LINES: usize = 400;
/// Probability below which residuals are not considered noise.
const WHITE: f64 = 0.01;

/// Laws to be fitted.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LawsSheet {
    /// The laws, such as `[Zener, FractionalZener, GeneralisedMaxwell]`.
    pub laws: Vec<LawSheet>,
    /// Criterion for comparing laws and numbers of branches; `Bic` by default.
    #[serde(default)]
    pub criterion: Option<CriterionSheet>,
    /// Confidence of the intervals, such as `"95 %"`, which is the default.
    #[serde(default)]
    pub confidence: Option<Exact<Ratio>>,
    /// Most fitted lines, evenly chosen among the valid ones; 400 by default.
    #[serde(default)]
    pub most_lines: Option<usize>,
    /// Cards of the generalised Maxwell model for other programs.
    #[serde(default)]
    pub cards: Option<CardsSheet>,
}

/// A law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum LawSheet {
    /// A spring.
    Elastic,
    /// Spring and dashpot in series.
    Maxwell,
    /// Spring and spring-pot in series.
    FractionalMaxwell,
    /// Constant loss factor.
    ConstantQ,
    /// Constant loss factor, parametrised by the exponent.
    SpringPot,
    /// Spring and dashpot in parallel.
    KelvinVoigt,
    /// The standard linear solid.
    Zener,
    /// The standard linear solid with a spring-pot.
    FractionalZener,
    /// A broad and asymmetric relaxation.
    HavriliakNegami,
    /// A Prony series with the number of branches chosen by the criterion.
    GeneralisedMaxwell,
    /// Powers of the frequency for damping coefficient and wave number.
    PowerLaw,
}

/// Criterion for comparing laws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum CriterionSheet {
    /// The Bayesian information criterion.
    Bic,
    /// Akaike's, corrected.
    Aicc,
}

/// Cards for other programs.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CardsSheet {
    /// Name of the material, a letter followed by letters, digits, `-` or `_`.
    pub name: String,
    /// Poisson's ratio, such as `"0.40 ± 0.02"`.
    pub poisson_ratio: Stated<PoissonRatio>,
    /// The frequency of this ratio, such as `"1 kHz"`; the middle of the fitted lines by default.
    #[serde(default)]
    pub poisson_ratio_at: Option<Exact<Frequency>>,
    /// Temperature of the specimen, such as `"23 degC"`: a comment of the card.
    #[serde(default)]
    pub temperature: Option<Exact<Temperature>>,
    /// The programs, such as `[Abaqus, Ansys, LsDyna]`.
    pub programs: Vec<ProgramSheet>,
}

/// A program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum ProgramSheet {
    /// Abaqus, long-term moduli, elastic bulk.
    Abaqus,
    /// ANSYS, elastic bulk.
    Ansys,
    /// LS-DYNA, elastic bulk.
    LsDyna,
}

impl LawsSheet {
    pub(super) fn list(&self, chosen: &mut Chosen) {
        chosen.stated("laws.laws", format!("{:?}", self.laws));
        let name = |criterion: CriterionSheet| match criterion {
            CriterionSheet::Bic => "Bayesian information criterion",
            CriterionSheet::Aicc => "Akaike's information criterion, corrected",
        };
        let criterion = self.criterion.map(name);
        chosen.either(
            "laws.criterion",
            criterion.as_ref(),
            name(CriterionSheet::Bic),
        );
        chosen.either("laws.confidence", self.confidence.as_ref(), "95 %");
        chosen.either("laws.most_lines", self.most_lines.as_ref(), MOST_LINES);
        if let Some(cards) = &self.cards {
            chosen.stated("laws.cards.name", &cards.name);
            chosen.stated("laws.cards.poisson_ratio", &cards.poisson_ratio);
            chosen.either(
                "laws.cards.poisson_ratio_at",
                cards.poisson_ratio_at.as_ref(),
                "geometric mean of the lowest and the highest line",
            );
            chosen.either(
                "laws.cards.temperature",
                cards.temperature.as_ref(),
                "not stated",
            );
            chosen.stated("laws.cards.programs", format!("{:?}", cards.programs));
        }
    }

    /// Refuses settings that are wrong for any data.
    pub(super) fn check(&self) -> Result<(), RodlabError> {
        if self.laws.is_empty() {
            return Err(RodlabError::request(
                "laws.laws",
                "empty",
                "at least one law",
            ));
        }
        if self.most_lines == Some(0) {
            return Err(RodlabError::request("laws.most_lines", "0", "at least 1"));
        }
        if self.cards.is_some() && !self.laws.contains(&LawSheet::GeneralisedMaxwell) {
            return Err(RodlabError::request(
                "laws.cards",
                "asked for",
                "`GeneralisedMaxwell` among `laws.laws`, of which cards are made",
            ));
        }
        Ok(())
    }

    fn options(&self) -> FitOptions {
        let options = FitOptions::default()
            .with_error_scale(ErrorScale::Stated)
            .with_criterion(match self.criterion {
                Some(CriterionSheet::Aicc) => Criterion::Aicc,
                _ => Criterion::Bic,
            });
        match &self.confidence {
            Some(confidence) => options.with_confidence(confidence.si()),
            None => options,
        }
    }
}

pub(super) fn fit(
    outcome: &mut Outcome,
    found: &Found<'_>,
    asked: &LawsSheet,
    around: &Surroundings<'_>,
) -> Result<(), RodlabError> {
    let density = found.sheet.specimen.density.with_uncertainty().value;
    let laws: Vec<Law> = asked
        .laws
        .iter()
        .map(|law| match law {
            LawSheet::Elastic => Law::Elastic,
            LawSheet::Maxwell => Law::Maxwell,
            LawSheet::FractionalMaxwell => Law::FractionalMaxwell,
            LawSheet::ConstantQ => Law::ConstantQ,
            LawSheet::SpringPot => Law::SpringPot,
            LawSheet::KelvinVoigt => Law::KelvinVoigt,
            LawSheet::Zener => Law::Zener,
            LawSheet::FractionalZener => Law::FractionalZener,
            LawSheet::HavriliakNegami => Law::HavriliakNegami,
            LawSheet::GeneralisedMaxwell => Law::GeneralisedMaxwell,
            LawSheet::PowerLaw => Law::PowerLaw { density },
        })
        .collect();
    let points = points(
        found,
        super::checks::most_lines(found, asked.most_lines.unwrap_or(MOST_LINES)),
    );
    let data = match ModulusData::from_lines(points.iter().copied()) {
        Ok(data) => data,
        Err(error) => {
            outcome.log.push(LogEntry {
                what: "laws".to_owned(),
                accepted: false,
                reasons: vec![error.to_string()],
            });
            return Ok(());
        }
    };
    let comparison = Comparison::new(&data, &laws, &asked.options())
        .map_err(|error| RodlabError::step("laws", error))?;
    around.go_on()?;
    for (law, error) in &comparison.refused {
        outcome.log.push(LogEntry {
            what: format!("law: {law}"),
            accepted: false,
            reasons: vec![error.to_string()],
        });
    }
    let Some(best) = comparison.best() else {
        return Ok(());
    };
    outcome.summary.push(format!(
        "Of {} the data prefer: {}, with chi-square {} for {} degrees of freedom on {} lines.",
        if laws.len() == 1 {
            "1 law".to_owned()
        } else {
            format!("{} laws", laws.len())
        },
        best.law.law(),
        significant(best.chi_squared, 3),
        best.degrees_of_freedom,
        points.len(),
    ));
    if !best.whiteness.is_white(WHITE) {
        outcome.warnings.push(format!(
            "What the preferred law ({}) leaves over is no noise: it is not the law of this material over the whole band, and the \
             errors of its parameters mean little.",
            best.law.law()
        ));
    }
    for row in &comparison.rows {
        parameters(outcome, &row.fit);
    }
    outcome.tables.push(table(&comparison));
    outcome
        .figures
        .push(figure(found, &points, &comparison, best));
    attach_material(outcome, found, best, &data);
    if let Some(cards) = &asked.cards {
        cards::attach(outcome, found, &comparison, &data, cards)?;
    }
    Ok(())
}

/// The preferred law with its errors, for the sheets of later jobs.
fn attach_material(
    outcome: &mut Outcome,
    found: &Found<'_>,
    best: &RheologicalFit,
    data: &ModulusData,
) {
    let mut doubts = Vec::new();
    if !best.whiteness.is_white(WHITE) {
        doubts.push("what the law leaves over is no noise".to_owned());
    }
    if let Verdict::InDoubt { reasons, .. } = &outcome.verdict {
        doubts.extend(reasons.iter().cloned());
    }
    let density = found.sheet.specimen.density.with_uncertainty();
    let inputs = outcome.inputs.clone();
    let file = MaterialFile::of(
        &found.sheet.title,
        best,
        density,
        data.band_hz(),
        doubts,
        &inputs,
    );
    match file.and_then(|file| file.text()) {
        Ok(bytes) => outcome.attachments.push(Attachment {
            name: material_file::NAME.to_owned(),
            bytes,
        }),
        Err(error) => outcome
            .warnings
            .push(format!("No {} is written: {error}.", material_file::NAME)),
    }
}

/// Valid lines, evenly chosen.
fn points<'a>(found: &Found<'a>, most: usize) -> Vec<&'a ModulusLine> {
    let count = found.estimate.valid().count();
    let stride = count.div_ceil(most).max(1);
    found.estimate.valid().step_by(stride).collect()
}

/// An `error` on the scale of the parameter as an error of its value; `None` if it is not small.
fn of_value(parameter: &Parameter, error: f64) -> Option<f64> {
    match parameter.scale {
        Scale::Ratio if parameter.standard_error < 0.5 => Some(parameter.value * error),
        Scale::Difference => Some(error),
        // on the odds of α its derivative is α(1 - α)
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
        outcome.quantities.push(Quantity {
            name: format!("{}, equilibrium modulus", fit.law.law()),
            unit: "Pa".to_owned(),
            value: None,
            standard_error: None,
            valid: false,
            verdict: format!(
                "the series has none; up to {} is not excluded",
                significant(limit, 3)
            ),
        });
    }
    for parameter in &fit.parameters {
        let identified = parameter.verdict.is_identified();
        let error = of_value(parameter, parameter.standard_error);
        let parts = of_value(parameter, parameter.random_error)
            .zip(of_value(parameter, parameter.common_error))
            .filter(|(_, common)| *common > 0.0)
            .map_or_else(String::new, |(random, common)| {
                format!(
                    ", ± {} random ± {} common",
                    significant(random, 2),
                    significant(common, 2)
                )
            });
        outcome.quantities.push(Quantity {
            name: format!("{}, {}", fit.law.law(), parameter.name),
            unit: match parameter.unit {
                "1" => String::new(),
                unit => unit.to_owned(),
            },
            value: Some(parameter.value),
            standard_error: error,
            valid: identified && white,
            verdict: format!(
                "{}; between {} and {}{parts}{}",
                parameter.verdict,
                significant(parameter.interval.lower, 4),
                significant(parameter.interval.upper, 4),
                if white {
                    ""
                } else {
                    "; the law leaves more than noise"
                }
            ),
        });
    }
}

fn table(comparison: &Comparison) -> Table {
    let rows = &comparison.rows;
    let numbers = |name: &str, of: &dyn Fn(&RheologicalFit) -> f64| {
        Column::numbers(name, "", rows.iter().map(|row| of(&row.fit)).collect())
    };
    Table {
        name: "laws".to_owned(),
        title: "Laws, the preferred one first".to_owned(),
        columns: vec![
            Column::words(
                "law",
                rows.iter()
                    .map(|row| match row.same_as {
                        Some(same) => format!("{} (the same as {same})", row.fit.law.law()),
                        None => row.fit.law.law().to_string(),
                    })
                    .collect(),
            ),
            numbers("parameters", &|fit| fit.parameters.len() as f64),
            numbers("chi-square", &|fit| fit.chi_squared),
            numbers("degrees of freedom", &|fit| fit.degrees_of_freedom as f64),
            numbers("BIC", &|fit| fit.bic),
            numbers("AICc", &|fit| fit.aicc),
            Column::numbers("weight", "", rows.iter().map(|row| row.weight).collect()),
            Column::words(
                "residuals",
                rows.iter()
                    .map(|row| {
                        let white = row.fit.whiteness.is_white(WHITE);
                        if white { "noise" } else { "not noise" }.to_owned()
                    })
                    .collect(),
            ),
        ],
    }
}

fn figure(
    found: &Found<'_>,
    points: &[&ModulusLine],
    comparison: &Comparison,
    best: &RheologicalFit,
) -> Figure {
    let x: Vec<f64> = points
        .iter()
        .map(|point| 1e-3 * point.frequency_hz)
        .collect();
    let panel = |label: &str, unit: &str, of: &dyn Fn(num_complex::Complex64) -> f64| {
        let mut marks = vec![Mark::Points {
            name: "measured".to_owned(),
            role: Role::Faint,
            x: x.clone(),
            y: points.iter().map(|point| of(point.modulus)).collect(),
            error: Vec::new(),
        }];
        for (index, row) in comparison.rows.iter().enumerate() {
            let law = &row.fit.law;
            let at =
                |point: &&ModulusLine| of(law.modulus(std::f64::consts::TAU * point.frequency_hz));
            marks.push(Mark::Line {
                name: law.law().to_string(),
                role: Role::of_series(index),
                x: x.clone(),
                y: points.iter().map(at).collect(),
            });
        }
        Panel {
            x: Axis::logarithmic("frequency", "kHz"),
            y: Axis::linear(label, unit),
            marks,
            greyed: Vec::new(),
            equal_axes: false,
        }
    };
    Figure {
        name: "laws".to_owned(),
        title: "Laws fitted to the modulus".to_owned(),
        caption: format!(
            "The preferred law: {}. Drawn are the {} lines that were fitted, of {} valid ones.",
            best.law.law(),
            points.len(),
            found.estimate.valid().count()
        ),
        panels: vec![
            panel("E'", "GPa", &|modulus| 1e-9 * modulus.re),
            panel("loss factor", "", &|modulus| modulus.im / modulus.re),
        ],
    }
}
