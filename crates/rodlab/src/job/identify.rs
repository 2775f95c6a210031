//! Constitutive law from the motion of two sections of impacted rods (Ödeen 1993, paper D): parameters with errors and verdicts, and
//! which law the data support.

mod figures;
mod laws;
mod tests_of_sheet;
mod words;

pub use tests_of_sheet::{DifferentiatorSheet, NoiseSheet, TestSheet};

use maxwellid::profile::{self, Profile};
use maxwellid::selection::{Candidate, Comparison, Decision, Selection};
use maxwellid::{DEFAULT_CELL, RodTest, SpecimenUncertainty};
use serde::Deserialize;

use super::{About, Surroundings};
use crate::outcome::{Column, Setting, Table, Verdict};
use crate::sheet::{Density, Exact, Length, Stated};
use crate::{Outcome, RodlabError};
use laws::FittedLaw;
use words::Shown;

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentifySheet {
    /// Title of the test.
    pub title: String,
    /// Free texts for the report.
    #[serde(default)]
    pub about: About,
    /// The rod.
    pub specimen: SpecimenSheet,
    /// The tests that are explained together.
    pub tests: Vec<TestSheet>,
    /// How displacements are differentiated.
    #[serde(default)]
    pub differentiator: DifferentiatorSheet,
    /// Laws whose parameters are sought.
    #[serde(default = "all_laws")]
    pub laws: Vec<LawName>,
    /// Whether the laws are compared with each other and with linear competitors.
    #[serde(default = "yes")]
    pub compare: bool,
    /// Whether profile likelihoods are computed for the law that comes out, or else for the one whose response is nearest, if the
    /// data determine its damping.
    #[serde(default = "yes")]
    pub profiles: bool,
    /// Longest cell of the rod in the direct problem, as `"8 mm"` for a rod whose waves are long; 4 mm by default.
    #[serde(default)]
    pub cell: Option<Exact<Length>>,
}

impl IdentifySheet {
    fn cell(&self) -> f64 {
        self.cell.as_ref().map_or(DEFAULT_CELL, Exact::si)
    }
}

/// The rod.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpecimenSheet {
    /// Distance from the section of excitation to the free end, as `"394 mm ± 0.5 mm"`. Twice its relative error is one of E.
    pub length: Stated<Length>,
    /// Density, as `"1140 kg/m3 ± 0.2 %"`. Its relative error is one of E.
    pub density: Stated<Density>,
}

impl SpecimenSheet {
    /// Relative standard uncertainties, the same in all tests.
    fn uncertainty(&self) -> Result<SpecimenUncertainty, RodlabError> {
        let (length, density) = (
            self.length.with_uncertainty(),
            self.density.with_uncertainty(),
        );
        SpecimenUncertainty::relative(length.relative(), density.relative())
            .map_err(|error| RodlabError::step("specimen", error))
    }
}

/// An inelastic law of paper D.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum LawName {
    /// Linear: strain rate proportional to stress.
    Maxwell,
    /// A power of the stress.
    Norton,
    /// An exponential of the stress.
    GurevichRabinovich,
}

fn all_laws() -> Vec<LawName> {
    vec![
        LawName::Maxwell,
        LawName::Norton,
        LawName::GurevichRabinovich,
    ]
}

fn yes() -> bool {
    true
}

/// Everything that was computed.
struct Found {
    tests: Vec<RodTest>,
    /// Of each test [m/s].
    impact_velocities: Vec<f64>,
    laws: Vec<FittedLaw>,
    comparison: Option<Comparison>,
    profiles: Vec<Profile>,
}

pub(crate) fn run(
    sheet: &IdentifySheet,
    around: &Surroundings<'_>,
) -> Result<Outcome, RodlabError> {
    let mut outcome = Outcome::of("identify", sheet.title.as_str());
    sheet.about.tell(&mut outcome);
    settings(sheet, &mut outcome);
    let tests = tests_of_sheet::read(sheet, around, &mut outcome)?;
    if sheet.laws.is_empty() {
        return Err(RodlabError::request("laws", "empty", "at least one law"));
    }
    around.has_read_all()?;

    let steps = sheet.laws.len() + usize::from(sheet.compare) + usize::from(sheet.profiles);
    around.progress.begins("identification", steps);
    let specimen = sheet.specimen.uncertainty()?;
    let mut laws = Vec::with_capacity(sheet.laws.len());
    for law in &sheet.laws {
        let fitted = laws::fit(*law, sheet.cell.as_ref().map(Exact::si), &tests)?;
        laws.push(fitted.with_specimen_uncertainty(&specimen));
        around.progress.one_more();
        around.go_on()?;
    }
    let comparison = sheet
        .compare
        .then(|| {
            Selection::new(Candidate::standard())?
                .with_cell(sheet.cell())?
                .compare(&tests)
        })
        .transpose()
        .map_err(|error| RodlabError::step("comparing the laws", error))?;
    around.progress.one_more();
    around.go_on()?;
    let identified = laws.iter().any(FittedLaw::has_identified_damping);
    let profiles = if sheet.profiles && identified {
        let of_data = profiles(&laws, comparison.as_ref(), &tests, sheet.cell())?;
        let with_specimen = |profile: &Profile| profile.with_specimen_uncertainty(&specimen);
        of_data.iter().map(with_specimen).collect()
    } else {
        Vec::new()
    };
    let velocity = |test: &TestSheet| test.impact_velocity.si();
    let found = Found {
        tests,
        impact_velocities: sheet.tests.iter().map(velocity).collect(),
        laws,
        comparison,
        profiles,
    };
    answer(&found, &mut outcome);
    specimen_in_words(&sheet.specimen, &found, &mut outcome);
    for law in &found.laws {
        law.tell(&mut outcome);
    }
    if let Some(comparison) = &found.comparison {
        outcome.tables.push(table_of(comparison));
    }
    outcome.tables.extend(figures::tables(&found));
    outcome.figures = figures::all(&found);
    Ok(outcome)
}

/// Of the law that is named; else of the one whose response is nearest.
fn profiles(
    laws: &[FittedLaw],
    comparison: Option<&Comparison>,
    tests: &[RodTest],
    cell: f64,
) -> Result<Vec<Profile>, RodlabError> {
    let named = comparison.and_then(Comparison::law).map(|law| &law.name);
    let best = laws
        .iter()
        .min_by(|a, b| a.relative_error.total_cmp(&b.relative_error))
        .map(|law| &law.name);
    let Some(candidate) = Candidate::standard()
        .into_iter()
        .find(|candidate| Some(candidate.name()) == named.or(best).map(String::as_str))
    else {
        return Ok(Vec::new());
    };
    profile::profiles(&candidate, tests, cell)
        .map_err(|error| RodlabError::step("profile likelihoods", error))
}

fn settings(sheet: &IdentifySheet, outcome: &mut Outcome) {
    let mut say = |name: &str, value: String, by_default: bool| {
        outcome.settings.push(Setting {
            name: name.to_owned(),
            value,
            by_default,
        });
    };
    say("specimen.length", sheet.specimen.length.to_string(), false);
    say(
        "specimen.density",
        sheet.specimen.density.to_string(),
        false,
    );
    let laws: Vec<String> = sheet.laws.iter().map(|law| format!("{law:?}")).collect();
    say("laws", laws.join(", "), sheet.laws == all_laws());
    say("compare", sheet.compare.to_string(), sheet.compare);
    say("profiles", sheet.profiles.to_string(), sheet.profiles);
    let usual = || format!("{} mm", 1e3 * DEFAULT_CELL);
    let cell = sheet.cell.as_ref();
    say(
        "cell",
        cell.map_or_else(usual, Exact::to_string),
        cell.is_none(),
    );
    let DifferentiatorSheet { half_width, degree } = sheet.differentiator;
    say(
        "differentiator",
        format!("{} points, degree {degree}", 2 * half_width + 1),
        sheet.differentiator == DifferentiatorSheet::default(),
    );
}

/// The first sentences, the verdict and the warnings.
#[allow(
    clippy::indexing_slicing,
    reason = "a decision names the laws by their places in the comparison that it is of"
)]
fn answer(found: &Found, outcome: &mut Outcome) {
    let identified = found.laws.iter().any(FittedLaw::has_identified_damping);
    match &found.comparison {
        Some(comparison) => {
            let name = |index: usize| comparison.laws[index].name.clone();
            outcome.summary.push(match &comparison.decision {
                Decision::Law {
                    candidate,
                    probability,
                } => format!(
                    "The data support the law {} with a probability of {probability:.3}.",
                    name(*candidate)
                ),
                Decision::CannotTell { between, reason } => {
                    let names: Vec<String> = between.iter().map(|index| name(*index)).collect();
                    format!(
                        "The data cannot tell the laws {} apart: {reason}.",
                        names.join(", ")
                    )
                }
                Decision::NoneOfThese { best, adequacy } => format!(
                    "None of the laws explains the data; the misfit of the best, {}, would have a probability of {adequacy:.1e}.",
                    name(*best)
                ),
                other => format!("The comparison ended with {other:?}."),
            });
            for advice in &comparison.advice {
                outcome.warnings.push(advice.to_string());
            }
        }
        None => outcome.warnings.push(
            "the laws were not compared: a good fit of one of them does not show that it is the law of the material"
                .to_owned(),
        ),
    }
    for law in &found.laws {
        outcome.summary.push(law.in_words());
        for flag in &law.flags {
            outcome.warnings.push(format!("{}: {flag}", law.name));
        }
    }
    for profile in &found.profiles {
        outcome.summary.push(Shown::of(profile).in_words(profile));
    }
    if !identified {
        outcome.verdict = Verdict::NotAllowed {
            reason: "no law has a damping that these data determine: within their noise the rod may be elastic".to_owned(),
        };
    }
}

/// How much of the errors is the specimen's; or that nothing of it is in them.
fn specimen_in_words(specimen: &SpecimenSheet, found: &Found, outcome: &mut Outcome) {
    let missing: Vec<&str> = [
        ("length", specimen.length.with_uncertainty()),
        ("density", specimen.density.with_uncertainty()),
    ]
    .iter()
    .filter(|(_, stated)| stated.standard_uncertainty.is_none())
    .map(|(name, _)| *name)
    .collect();
    if !missing.is_empty() {
        outcome.warnings.push(format!(
            "no uncertainty is stated of the {} of the specimen: the errors do not contain it; a relative error of the length is doubled in \
             E, one of the density is the same in E",
            missing.join(" and of the ")
        ));
    }
    let modulus = found.laws.iter().find_map(|law| law.estimates.first());
    if let Some(modulus) = modulus.filter(|modulus| modulus.specimen_error > 0.0) {
        outcome.summary.push(format!(
            "Length and density of the specimen contribute {:.2} % to the standard error of E, and to those of the other parameters as they \
             go with E; that part is the same for all tests, and more tests do not lessen it.",
            100.0 * modulus.specimen_error
        ));
    }
}

fn table_of(comparison: &Comparison) -> Table {
    let laws = &comparison.laws;
    let numbers = |name: &str, of: &dyn Fn(&maxwellid::selection::ComparedLaw) -> f64| {
        Column::numbers(name, "", laws.iter().map(of).collect())
    };
    Table {
        name: "laws".to_owned(),
        title: "Laws compared".to_owned(),
        columns: vec![
            Column::words("law", laws.iter().map(|law| law.name.clone()).collect()),
            Column::words(
                "kind",
                laws.iter()
                    .map(|law| if law.is_linear { "linear" } else { "nonlinear" }.to_owned())
                    .collect(),
            ),
            numbers("probability", &|law| law.probability),
            numbers("chi-square", &|law| law.chi_square),
            numbers("independent samples", &|_| comparison.effective_samples),
            numbers("adequacy", &|law| law.adequacy.unwrap_or(f64::NAN)),
            numbers("parameters that the data determine", &|law| law.determined),
        ],
    }
}
