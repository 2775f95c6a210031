//! What to measure next: planned tests by what they would tell.

use maxwellid::design::{Design, Estimated, PlannedTest};
use maxwellid::selection::Candidate;
use maxwellid::{Law, MaxwellidError};
use rodwave::InelasticRod;
use rodwave::band_limited::Recorder;
use rodwave::experiment::Acquisition;
use rodwave::impact::Striker;
use rodwave::inelastic::{Elastic, Eyring, InelasticLaw, MaxwellGurevichRabinovich, MaxwellNorton};
use serde::Deserialize;

use super::{Found, IdentifySheet};
use crate::digits::significant;
use crate::job::JobContext;
use crate::job::simulate::StrikerSheet;
use crate::outcome::{Attachment, Column, Table};
use crate::sheet::{self, Exact, Language, Length, Velocity, plausible};
use crate::{Outcome, RodlabError};

/// Most planned tests: each is fitted by every law that is left.
const MOST_PLANNED: f64 = 60.0;

/// Samples of a planned record before the blow: twice the reach of its filter.
const BEFORE: usize = 48;

/// Cut-off of a planned record over its sampling rate.
const CUTOFF: f64 = 0.3125;

/// Tests that may be made next.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NextSheet {
    /// Impact velocities, such as `["3 m/s", "27 m/s"]`.
    pub velocities: Vec<Exact<Velocity>>,
    /// Rods; by default that of the first test, its excitation in proportion to the velocity.
    #[serde(default)]
    pub rods: Option<NextRodsSheet>,
}

/// Rods that may be struck.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NextRodsSheet {
    /// Lengths, such as `["200 mm", "400 mm"]`.
    pub lengths: Vec<Exact<Length>>,
    /// Distance of the section of excitation from the struck end, such as `"8 mm"`.
    pub gap: Exact<Length>,
    /// Diameter.
    pub diameter: Exact<Length>,
    /// The projectile.
    pub striker: StrikerSheet,
}

impl NextSheet {
    /// Refuses what is wrong for any data.
    pub(super) fn check(&self) -> Result<(), RodlabError> {
        let lengths = self.rods.as_ref().map_or(1, |rods| rods.lengths.len());
        let count = self.velocities.len() * lengths;
        plausible::at_most(count as f64, MOST_PLANNED, "planned tests", "next")?;
        if count == 0 {
            return Err(RodlabError::request(
                "next",
                "no planned test",
                "at least one velocity, and one length where `rods` is stated",
            ));
        }
        let Some(rods) = &self.rods else {
            return Ok(());
        };
        let gap = rods.gap.si();
        let shortest = rods.lengths.iter().map(Exact::si);
        if !(gap > 0.0 && gap < shortest.fold(f64::INFINITY, f64::min)) {
            return Err(RodlabError::request(
                "next.rods.gap",
                rods.gap.to_string(),
                "above 0 and less than every length",
            ));
        }
        Ok(())
    }
}

/// A planned test with what it would tell.
struct Planned {
    name: String,
    /// Length of the rod, if it is not that of the first test.
    length: Option<f64>,
    velocity: f64,
    /// Expected ln of the Bayes factor over each rival.
    separations: Vec<f64>,
    /// Standard errors of the parameters.
    deviations: Vec<f64>,
}

impl Planned {
    /// Merit of the test: the least separation from a rival, or without rivals small errors of all
    /// parameters.
    fn merit(&self) -> f64 {
        if self.separations.is_empty() {
            -self.deviations.iter().map(|error| error.ln()).sum::<f64>()
        } else {
            self.separations
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min)
        }
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
    let (Some(leading), Some(first)) = (laws.first(), found.tests.first()) else {
        outcome.warnings.push(
            "no law is left, so that no test can be planned: `next` needs a law that explains the data"
                .to_owned(),
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
        // no test tells a law from one that contains it
        .filter(|rival| {
            let limit = rival.candidate.at_limit(candidate, leading.parameters);
            limit.is_none()
        })
        .map(|rival| &rival.candidate)
        .collect();
    let design = Design {
        tests: &found.tests,
        cell: sheet.cell(),
    };
    let judged = |name: String, length, velocity, test: Option<&PlannedTest>| {
        let separations = rivals
            .iter()
            .map(|rival| design.separation(estimated, rival, test));
        Ok::<_, MaxwellidError>(Planned {
            name,
            length,
            velocity,
            separations: separations.collect::<Result<_, _>>()?,
            deviations: design.deviations(estimated, test)?,
        })
    };
    let lengths = next.rods.as_ref().map_or(1, |rods| rods.lengths.len());
    context
        .progress
        .begins("planning", next.velocities.len() * lengths);
    let present = match judged("none".to_owned(), None, f64::NAN, None) {
        Ok(present) => present,
        Err(error) => {
            let said = format!("no test can be planned: {error}");
            outcome.warnings.push(said);
            return Ok(());
        }
    };
    let mut planned = Vec::new();
    for velocity in &next.velocities {
        let lengths: Vec<Option<&Exact<Length>>> = match &next.rods {
            None => vec![None],
            Some(rods) => rods.lengths.iter().map(Some).collect(),
        };
        for length in lengths {
            context.progress.one_more();
            context.check_cancelled()?;
            let name = length.map_or_else(
                || format!("{velocity}"),
                |length| format!("{length}, {velocity}"),
            );
            let test = match (&next.rods, length) {
                (Some(rods), Some(length)) => {
                    struck(rods, length.si(), velocity.si(), leading, found)
                        .and_then(|test| test.with_instruments_of(first))
                }
                _ => PlannedTest::at_velocity(first, velocity.si()),
            };
            let length = length.map(Exact::si);
            let told =
                test.and_then(|test| judged(name.clone(), length, velocity.si(), Some(&test)));
            match told {
                Ok(told) => planned.push(told),
                Err(error) => {
                    let said = format!("the test of {name} was not planned: {error}");
                    outcome.warnings.push(said);
                }
            }
        }
    }
    planned.sort_by(|a, b| b.merit().total_cmp(&a.merit()));
    state(candidate, &rivals, &present, &planned, outcome);
    if let (Some(best), Some(rods)) = (planned.first(), &next.rods)
        && let Some(plan) = plan(sheet, rods, best, leading, found)
    {
        let path = std::path::Path::new("next.ron");
        let (name, text) = match context.language {
            Language::Ron => ("next.ron", plan),
            Language::Toml | Language::Json => {
                let toml = sheet::in_toml(path, &plan);
                ("next.toml", toml.map_err(RodlabError::Sheet)?)
            }
        };
        outcome.summary.push(format!(
            "`rodlab simulate {name}` in the folder of this result makes it as a virtual test."
        ));
        outcome.attachments.push(Attachment {
            name: name.to_owned(),
            bytes: text.into_bytes(),
        });
    }
    Ok(())
}

/// A law that is left, with its parameters.
struct LeftLaw<'a> {
    law: Law,
    candidate: Candidate,
    parameters: &'a [f64],
}

/// The laws that the comparison leaves, the most probable first; without a comparison the only one
/// that was fitted.
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

/// A test by the striker on another rod of the material.
fn struck(
    rods: &NextRodsSheet,
    length: f64,
    velocity: f64,
    leading: &LeftLaw<'_>,
    found: &Found,
) -> Result<PlannedTest, MaxwellidError> {
    let refused = |source| MaxwellidError::InTest {
        test: "a planned test".to_owned(),
        source,
    };
    let of_law = leading.parameters.get(1..).unwrap_or_default();
    let modulus = leading
        .parameters
        .first()
        .map_or(f64::NAN, |ln_modulus| ln_modulus.exp());
    let by = Blow {
        rods,
        length,
        velocity,
        modulus,
        found,
    };
    match leading.law {
        Law::Norton => {
            let norton = MaxwellNorton::from_reference_rate(2.0, 1.0, 10e6).map_err(refused)?;
            by.on(norton.with_parameters(of_law).map_err(refused)?)
        }
        Law::GurevichRabinovich => {
            let gurevich = MaxwellGurevichRabinovich::new(1e6, 1e7).map_err(refused)?;
            by.on(gurevich.with_parameters(of_law).map_err(refused)?)
        }
        Law::Eyring => {
            let eyring = Eyring::from_reference_rate(2.0, 1.0, 10e6).map_err(refused)?;
            by.on(eyring.with_parameters(of_law).map_err(refused)?)
        }
        // between section and struck end any other law damps little of its wave
        _ => by.on(Elastic),
    }
}

/// A blow on a rod whose law is one of several types.
struct Blow<'a> {
    rods: &'a NextRodsSheet,
    length: f64,
    velocity: f64,
    modulus: f64,
    found: &'a Found,
}

impl Blow<'_> {
    fn on<L: InelasticLaw>(&self, law: L) -> Result<PlannedTest, MaxwellidError> {
        let first = self.found.tests.first();
        let (rate_hz, samples_after, density) = first.map_or((f64::NAN, 0, f64::NAN), |test| {
            (
                test.sampling_rate_hz(),
                test.response().len(),
                test.density(),
            )
        });
        let rod = InelasticRod::new(self.length, density, self.modulus, law).map_err(|source| {
            MaxwellidError::InTest {
                test: "a planned test".to_owned(),
                source,
            }
        })?;
        let striker = &self.rods.striker;
        let striker = Striker {
            length: striker.length.si(),
            diameter: striker.diameter.si(),
            density: striker.density.si(),
            modulus: striker.modulus.si(),
            velocity: self.velocity,
        };
        let acquisition = Acquisition {
            recorder: Recorder {
                rate_hz,
                cutoff_hz: CUTOFF * rate_hz,
            },
            samples_before: BEFORE,
            samples_after,
            // no displacement of a test comes near
            transducer_range: 1e3,
        };
        let section = self.length - self.rods.gap.si();
        let diameter = self.rods.diameter.si();
        PlannedTest::of_striker(striker, rod, diameter, section, &acquisition)
    }
}

/// Table of the planned tests, the best first, and the best in words.
fn state(
    candidate: &Candidate,
    rivals: &[&Candidate],
    present: &Planned,
    planned: &[Planned],
    outcome: &mut Outcome,
) {
    let rows = || std::iter::once(present).chain(planned);
    let mut columns = vec![
        Column::words("planned test", rows().map(|row| row.name.clone()).collect()),
        Column::numbers(
            "impact velocity",
            "m/s",
            rows().map(|row| row.velocity).collect(),
        ),
    ];
    let or_nan = |value: Option<&f64>| value.copied().unwrap_or(f64::NAN);
    for (place, rival) in rivals.iter().enumerate() {
        columns.push(Column::numbers(
            format!("expected ln of the Bayes factor over {}", rival.name()),
            "",
            rows()
                .map(|row| or_nan(row.separations.get(place)))
                .collect(),
        ));
    }
    for (place, name) in candidate.model().parameter_names().iter().enumerate() {
        columns.push(Column::numbers(
            format!("standard error of {name}"),
            "",
            rows()
                .map(|row| or_nan(row.deviations.get(place)))
                .collect(),
        ));
    }
    outcome.tables.push(Table {
        name: "next_tests".to_owned(),
        title: format!(
            "Planned tests with those made, if the law is {}",
            candidate.name()
        ),
        columns,
    });
    let Some(best) = planned.first() else { return };
    let told = match rivals.first() {
        Some(_) => format!(
            "the expected ln of the Bayes factor of {} over its nearest rival is then {}, now {}",
            candidate.name(),
            significant(best.merit(), 2),
            significant(present.merit(), 2)
        ),
        None => {
            let names = candidate.model().parameter_names();
            let errors = names
                .iter()
                .zip(best.deviations.iter().zip(&present.deviations));
            let errors: Vec<String> = errors
                .map(|(name, (then, now))| {
                    format!(
                        "{name} {}, now {}",
                        significant(*then, 2),
                        significant(*now, 2)
                    )
                })
                .collect();
            format!("the standard errors are then: {}", errors.join("; "))
        }
    };
    outcome.summary.push(format!(
        "Of the {} planned tests that of {} tells most: {told}.",
        planned.len(),
        best.name
    ));
}

/// The sheet of a virtual test like `best`; `None` for a law that no virtual rod has.
fn plan(
    sheet: &IdentifySheet,
    rods: &NextRodsSheet,
    best: &Planned,
    leading: &LeftLaw<'_>,
    found: &Found,
) -> Option<String> {
    let stated = leading.candidate.model().stated(leading.parameters);
    let value = |name: &str| {
        let mut stated = stated.iter();
        stated.find(|one| one.name == name).map(|one| one.value)
    };
    let law = match leading.law {
        Law::Elastic => "Elastic".to_owned(),
        Law::Norton => format!(
            "Norton(exponent: \"{}\", rate_at_10_mpa: \"{} 1/s\")",
            value("exponent")?,
            value("inelastic strain rate at 10 MPa")?
        ),
        Law::GurevichRabinovich => format!(
            "GurevichRabinovich(viscosity: \"{} Pa s\", activation_stress: \"{} Pa\")",
            value("viscosity")?,
            value("activation stress")?
        ),
        Law::Eyring => format!(
            "Eyring(activation_stress: \"{} Pa\", rate_at_10_mpa: \"{} 1/s\")",
            value("activation stress")?,
            value("inelastic strain rate at 10 MPa")?
        ),
        _ => return None,
    };
    let first = found.tests.first()?;
    let length = best.length?;
    let rate_hz = first.sampling_rate_hz();
    let samples = first.response().len() + BEFORE;
    let striker = &rods.striker;
    let [excitation, response] = first.noise_deviations()?;
    Some(format!(
        r#"Simulate(
    title: {title:?},
    experiment: ImpactedRod(
        length: "{length} m", diameter: "{diameter}", density: "{density} kg/m3", modulus: "{modulus} Pa",
        law: {law},
        section_distance: "{section} m",
        striker: (length: "{s_length}", diameter: "{s_diameter}", density: "{s_density}", modulus: "{s_modulus}"),
        velocities: ["{velocity} m/s"],
    ),
    instrument: (
        sampling_rate: "{rate_hz} Hz", length: "{duration} s", before: "{before} s",
        noise_of: {{"near end": "{excitation} m/s", "free end": "{response} m/s"}},
    ),
)
"#,
        title = format!("{}: planned test", sheet.title),
        diameter = rods.diameter,
        density = first.density(),
        modulus = value("Young's modulus")?,
        section = length - rods.gap.si(),
        s_length = striker.length,
        s_diameter = striker.diameter,
        s_density = striker.density,
        s_modulus = striker.modulus,
        velocity = best.velocity,
        duration = samples as f64 / rate_hz,
        before = BEFORE as f64 / rate_hz,
    ))
}
