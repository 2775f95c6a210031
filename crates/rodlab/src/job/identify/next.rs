//! Choice of the next test: planned tests are ranked by their expected information.

mod choice;
mod struck;

use maxwellid::design::{Design, Estimated, PlannedTest};
use maxwellid::selection::Candidate;
use maxwellid::{Law, MaxwellidError, RodTest};
use serde::Deserialize;

use self::choice::Choice;
use super::{Found, IdentifySheet};
use crate::digits::significant;
use crate::job::JobContext;
use crate::job::simulate::StrikerSheet;
use crate::outcome::{Attachment, Rows};
use crate::sheet::{self, Exact, Language, Length, Velocity, plausible};
use crate::{Outcome, RodlabError};

/// Maximum number of planned tests, limited because every remaining law is fitted to each of them.
const MOST_PLANNED: f64 = 60.0;

/// Expected ln of the Bayes factor that decides between two laws; it corresponds to odds of 20.
const DECISIVE: f64 = 3.0;

/// Tests that may be made next: one for each combination of impact velocity, rod and number of
/// repeats.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NextSheet {
    /// Impact velocities, such as `["3 m/s", "27 m/s"]`.
    pub velocities: Vec<Exact<Velocity>>,
    /// Numbers of identical tests, such as `[1, 3, 10]`; by default one.
    #[serde(default = "one")]
    pub repeats: Vec<usize>,
    /// Rods; by default the rod of the first test, with its excitation scaled in proportion to the
    /// velocity.
    pub rods: Option<NextRodsSheet>,
    /// Parameter whose error the test should reduce, such as `"exponent"`; this is then the aim
    /// even if several laws remain.
    pub sharpen: Option<String>,
}

fn one() -> Vec<usize> {
    vec![1]
}

/// Rods that may be struck: each length is combined with each gap and each striker.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NextRodsSheet {
    /// Lengths, such as `["200 mm", "400 mm"]`.
    pub lengths: Vec<Exact<Length>>,
    /// Distances of the section of excitation from the struck end, such as `["8 mm", "50 mm"]`.
    pub gaps: Vec<Exact<Length>>,
    /// Diameter.
    pub diameter: Exact<Length>,
    /// The projectiles.
    pub strikers: Vec<StrikerSheet>,
}

impl NextSheet {
    /// Refuses statements that are wrong whatever the data are.
    pub(super) fn check(&self) -> Result<(), RodlabError> {
        if let Some(rods) = &self.rods {
            let shortest = rods.lengths.iter().map(Exact::si);
            let shortest = shortest.fold(f64::INFINITY, f64::min);
            for gap in &rods.gaps {
                if !(gap.si() > 0.0 && gap.si() < shortest) {
                    return Err(RodlabError::request(
                        "next.rods.gaps",
                        gap.to_string(),
                        "above 0 and less than every length",
                    ));
                }
            }
        }
        if self.repeats.contains(&0) {
            return Err(RodlabError::request(
                "next.repeats",
                "0",
                "numbers of equal tests, from 1",
            ));
        }
        let of_rods = self.rods.as_ref().map_or(1, |rods| {
            rods.lengths.len() * rods.gaps.len() * rods.strikers.len()
        });
        let tests: usize = self.repeats.iter().sum();
        let count = self.velocities.len() * tests * of_rods;
        plausible::at_most(count as f64, MOST_PLANNED, "planned tests", "next")?;
        if count == 0 {
            return Err(RodlabError::request(
                "next",
                "no planned test",
                "at least one velocity and one number of `repeats`, and one of `lengths`, `gaps` and `strikers` where `rods` is stated",
            ));
        }
        Ok(())
    }
}

/// Planned tests with their expected information.
struct Planned<'a> {
    name: String,
    /// Planned tests; `None` stands for the existing tests without a further test.
    choice: Option<Choice<'a>>,
    /// Expected ln of the Bayes factor in favour of the leading law, for each rival.
    separations: Vec<f64>,
    /// Standard errors of the parameters.
    deviations: Vec<f64>,
}

/// Purpose of a planned test.
enum Aim {
    /// Enlargement of the smallest separation from a rival law.
    Separate,
    /// Reduction of the error of one parameter.
    Sharpen(usize),
    /// Reduction of the errors of all parameters.
    SharpenAll,
}

impl Planned<'_> {
    /// Returns the merit of the tests for an aim; larger is better.
    fn merit(&self, aim: &Aim) -> f64 {
        match aim {
            Aim::Separate => {
                let each = self.separations.iter().copied();
                each.fold(f64::INFINITY, f64::min)
            }
            Aim::Sharpen(place) => {
                let error = self.deviations.get(*place);
                -error.copied().unwrap_or(f64::INFINITY).ln()
            }
            Aim::SharpenAll => {
                let errors = self.deviations.iter();
                -errors.map(|error| error.ln()).sum::<f64>()
            }
        }
    }

    /// Returns the number of tests if they decide between the laws, because fewer tests are then
    /// better; otherwise `usize::MAX`.
    fn number_that_decides(&self, aim: &Aim) -> usize {
        let decides = matches!(aim, Aim::Separate) && self.merit(aim) >= DECISIVE;
        let number = self.choice.as_ref().map(|choice| choice.repeats);
        number.filter(|_| decides).unwrap_or(usize::MAX)
    }
}

pub(super) fn tell(
    sheet: &IdentifySheet,
    next: &NextSheet,
    found: &Found,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    let laws = left(found);
    let Some(leading) = laws.first() else {
        outcome.warn(
            "no law remains, so no test can be planned: `next` needs a law that explains the data",
        );
        return Ok(());
    };
    let candidate = &leading.candidate;
    let estimated = Estimated {
        candidate,
        parameters: leading.parameters,
    };
    let rivals: Vec<&Candidate> = laws
        .iter()
        .skip(1)
        // no test distinguishes a law from a more general law that contains it
        .filter(|rival| {
            let limit = rival.candidate.at_limit(candidate, leading.parameters);
            limit.is_none()
        })
        .map(|rival| &rival.candidate)
        .collect();
    let aim = match &next.sharpen {
        None if rivals.is_empty() => Aim::SharpenAll,
        None => Aim::Separate,
        Some(name) => {
            let names = candidate.model().parameter_names();
            match names.iter().position(|own| own == name) {
                Some(place) => Aim::Sharpen(place),
                None => {
                    outcome.warn(format!(
                        "no test was planned: `next.sharpen` is `{name}`, expected a parameter of the law {}: {}",
                        candidate.name(),
                        names.join(", ")
                    ));
                    return Ok(());
                }
            }
        }
    };
    let design = Design {
        tests: &found.tests,
        cell: sheet.cell(),
    };
    let judged = |name: String, choice, tests: &[PlannedTest]| {
        let separations = rivals
            .iter()
            .map(|rival| design.separation(estimated, rival, tests));
        Ok::<_, MaxwellidError>(Planned {
            name,
            choice,
            separations: separations.collect::<Result<_, _>>()?,
            deviations: design.deviations(estimated, tests)?,
        })
    };
    let choices = choice::all(next);
    context.progress.begins("planning", choices.len());
    let present = match judged("none".to_owned(), None, &[]) {
        Ok(present) => present,
        Err(error) => {
            let said = format!("no test can be planned: {error}");
            outcome.warn(said);
            return Ok(());
        }
    };
    let mut planned = Vec::new();
    for choice in choices {
        context.progress.one_more();
        context.check_cancelled()?;
        let name = choice.name(next);
        let velocity = choice.velocity.si();
        let Some(like) = like(found, velocity) else {
            return Ok(());
        };
        let test = match &choice.rod {
            Some(rod) => struck::planned(rod, velocity, leading, like),
            None => PlannedTest::at_velocity(like, velocity),
        };
        let told = test.and_then(|test| {
            let tests = vec![test; choice.repeats];
            judged(name.clone(), Some(choice), &tests)
        });
        match told {
            Ok(told) => planned.push(told),
            Err(error) => {
                let said = format!("the test of {name} was not planned: {error}");
                outcome.warn(said);
            }
        }
    }
    planned.sort_by(|a, b| {
        let by_number = a
            .number_that_decides(&aim)
            .cmp(&b.number_that_decides(&aim));
        by_number.then(b.merit(&aim).total_cmp(&a.merit(&aim)))
    });
    state(candidate, (&rivals, &aim), &present, &planned, outcome);
    if let Some(best) = planned.first().and_then(|best| best.choice.as_ref())
        && let Some(like) = like(found, best.velocity.si())
        && let Some(plan) = struck::plan(sheet, best, leading, like)
    {
        let path = std::path::Path::new("next.ron");
        let (name, text) = match context.language {
            Language::Ron => ("next.ron", plan),
            Language::Toml | Language::Json => {
                let toml = sheet::in_toml(path, &plan);
                ("next.toml", toml.map_err(RodlabError::Sheet)?)
            }
        };
        outcome.say(format!(
            "`rodlab simulate {name}` in the folder of this result runs it as a virtual test."
        ));
        outcome.attachments.push(Attachment {
            name: name.to_owned(),
            bytes: text.into_bytes(),
        });
    }
    Ok(())
}

/// Returns the existing test whose velocity is nearest to `velocity` \[m/s\] by ratio. The ranges
/// of the instruments, and therefore their noise, depend on the velocity.
fn like(found: &Found, velocity: f64) -> Option<&RodTest> {
    let far = |test: &RodTest| (test.impact_velocity() / velocity).ln().abs();
    let tests = found.tests.iter();
    tests.min_by(|a, b| far(a).total_cmp(&far(b)))
}

/// A remaining law, with its parameters.
struct LeftLaw<'a> {
    law: Law,
    candidate: Candidate,
    parameters: &'a [f64],
}

/// Returns the laws that the comparison leaves, the most probable first. Without a comparison,
/// returns the fitted law if there is only one.
fn left(found: &Found) -> Vec<LeftLaw<'_>> {
    if let (None, [only]) = (&found.comparison, found.laws.as_slice()) {
        return vec![LeftLaw {
            law: only.law,
            candidate: Candidate::of_fit(only.law),
            parameters: only.parameters(),
        }];
    }
    let compared = |place: &usize| found.comparison.as_ref()?.laws.get(*place);
    let places = found.left.places().iter();
    places
        .filter_map(compared)
        .filter_map(|compared| {
            let law = compared.law?;
            Some(LeftLaw {
                law,
                candidate: Candidate::of(law),
                parameters: &compared.parameters,
            })
        })
        .collect()
}

/// Adds a table of the planned tests, the best first, and a sentence about the best test.
fn state(
    candidate: &Candidate,
    (rivals, aim): (&[&Candidate], &Aim),
    present: &Planned<'_>,
    planned: &[Planned<'_>],
    outcome: &mut Outcome,
) {
    let rows: Vec<&Planned<'_>> = std::iter::once(present).chain(planned).collect();
    let title = format!(
        "Planned tests, each together with the tests already made, if the law is {}",
        candidate.name()
    );
    let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let mut table = Rows::of(&rows, "next_tests", title)
        .word("planned test", |row| &row.name)
        .number("number of tests", "", |row| {
            or_nan(row.choice.as_ref().map(|choice| choice.repeats as f64))
        })
        .number("impact velocity", "m/s", |row| {
            or_nan(row.choice.as_ref().map(|choice| choice.velocity.si()))
        });
    for (place, rival) in rivals.iter().enumerate() {
        let name = format!("expected ln of the Bayes factor over {}", rival.name());
        table = table.number(name, "", |row| or_nan(row.separations.get(place).copied()));
    }
    let names = candidate.model().parameter_names();
    for (place, name) in names.iter().enumerate() {
        table = table.number(format!("standard error of {name}"), "", |row| {
            or_nan(row.deviations.get(place).copied())
        });
    }
    outcome.tables.push(table.table);
    let Some(best) = planned.first() else { return };
    let told = if let Aim::Separate = aim {
        format!(
            "the expected ln of the Bayes factor of {} over its nearest rival is then {}, now {}",
            candidate.name(),
            significant(best.merit(aim), 2),
            significant(present.merit(aim), 2)
        )
    } else {
        let errors = best.deviations.iter().zip(&present.deviations);
        let each = names.iter().zip(errors).enumerate();
        let errors: Vec<String> = each
            .filter(|(place, _)| match aim {
                Aim::Sharpen(chosen) => chosen == place,
                _ => true,
            })
            .map(|(_, (name, (then, now)))| {
                format!(
                    "{name} {}, now {}",
                    significant(*then, 2),
                    significant(*now, 2)
                )
            })
            .collect();
        format!("the standard errors are then: {}", errors.join("; "))
    };
    let decides = best.number_that_decides(aim) < usize::MAX;
    outcome.say(format!(
        "Of the {} planned tests, the test `{}` {}: {told}.",
        planned.len(),
        best.name,
        if decides && planned.iter().any(|one| one.merit(aim) > best.merit(aim)) {
            "is decisive with the fewest repeats"
        } else {
            "is the most informative"
        }
    ));
}
