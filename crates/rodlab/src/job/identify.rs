//! Constitutive law from the motion of two sections of impacted rods (Ödeen 1993, paper D):
//! parameters with errors and verdicts, and the laws that the data support.

mod answer;
mod figures;
mod laws;
mod next;
mod recorder;
mod specimen;
mod tests_of_sheet;
mod words;

pub use next::{NextRodsSheet, NextSheet};
pub use tests_of_sheet::{DifferentiatorSheet, NoiseSheet, TestSheet};

use maxwellid::common_error::with_unstated_transducers;
use maxwellid::profile::Profile;
use maxwellid::recorder::{NarrowedBand, RecorderCheck};
use maxwellid::selection::{
    ADEQUACY_LEVEL, Candidate, ComparedLaw, Comparison, DISTINCT_VELOCITIES, Decision, Selection,
};
use maxwellid::{DEFAULT_CELL, Law, RodModel, RodTest, SpecimenUncertainty};
use serde::Deserialize;

use super::simulate::AntiAliasSheet;
use super::{About, JobContext};
use crate::digits::significant;
use crate::draw::Draw;
use crate::outcome::{LogEntry, Rows, Setting, Table};
use crate::sheet::{Density, Exact, Length, PoissonRatio, Stated, Temperature, plausible};
use crate::{InStep, Outcome, RodlabError};
use answer::Left;
use laws::{FittedLaw, Identified, LawFit, Standing};

/// Maximum number of cells of a rod; the computing time is proportional to the square of this
/// number.
const MOST_CELLS: f64 = 2000.0;

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentifySheet {
    /// Title of the test.
    pub title: String,
    /// Free texts for the report.
    #[serde(default)]
    pub about: About,
    /// Rod of all tests that do not state their own.
    pub specimen: Option<SpecimenSheet>,
    /// Tests that are evaluated together.
    pub tests: Vec<TestSheet>,
    /// Filter of the recorder, for all tests. If it is stated, the recorder is part of the model,
    /// so that nonlinear laws can be compared and identified in spite of it.
    pub recorder: Option<AntiAliasSheet>,
    /// Makes the rates and relaxation times of all laws thermally activated.
    pub arrhenius: Option<ArrheniusSheet>,
    /// Differentiator for displacements.
    #[serde(default)]
    pub differentiator: DifferentiatorSheet,
    /// Laws to be fitted; by default the laws of paper D.
    #[serde(default = "laws_of_paper_d")]
    pub laws: Vec<Law>,
    /// Compares the laws with each other and with linear laws.
    #[serde(default = "yes")]
    pub compare: bool,
    /// Computes profile likelihoods for the law that the comparison names or, if it names none, for
    /// the law with the nearest response; only if the data may determine the damping of this law.
    #[serde(default = "yes")]
    pub profiles: bool,
    /// Cell length of the rod in the direct problem, at most `"4 mm"`; by default as short as the
    /// accuracy requires.
    pub cell: Option<Exact<Length>>,
    /// Tests that may be made next. The job finds the most informative of these tests: to decide
    /// between the remaining laws or, if one law remains, to determine its parameters.
    pub next: Option<NextSheet>,
    /// Number of Monte Carlo draws, such as 200, of the noise and of every quantity stated with ±;
    /// they check the linear errors.
    pub monte_carlo: Option<usize>,
}

impl IdentifySheet {
    /// Returns the candidate, with thermally activated rates if the sheet requests them.
    fn activated(&self, candidate: Candidate) -> Result<Candidate, RodlabError> {
        match &self.arrhenius {
            None => Ok(candidate),
            Some(arrhenius) => candidate
                .with_activation(arrhenius.reference.si())
                .in_step("arrhenius"),
        }
    }

    /// Cell length fixed by the sheet \[m\]; `None` if a fit chooses it. A stated cell longer than
    /// the default is ignored, because the error of such a grid would refute a correct law, or
    /// change its parameters by more than their errors.
    fn fixed_cell(&self) -> Option<f64> {
        let stated = self.cell.as_ref().map(Exact::si);
        stated.filter(|cell| *cell <= DEFAULT_CELL)
    }

    /// Longest cell of the comparison \[m\].
    fn cell(&self) -> f64 {
        self.fixed_cell().unwrap_or(DEFAULT_CELL)
    }

    /// Returns the rod of `test`; `field` is the place of the test in the sheet.
    fn specimen_of<'a>(
        &'a self,
        test: &'a TestSheet,
        field: &str,
    ) -> Result<&'a SpecimenSheet, RodlabError> {
        let own = test.specimen.as_ref().or(self.specimen.as_ref());
        let specimen = own.ok_or_else(|| {
            RodlabError::request(
                format!("{field}.specimen"),
                "absent",
                "the rod of this test, here or as `specimen` of all tests",
            )
        })?;
        let place = match test.specimen {
            Some(_) => format!("{field}.specimen"),
            None => "specimen".to_owned(),
        };
        plausible::density(&specimen.density, format!("{place}.density"))?;
        let [absent, stated] = match (&specimen.diameter, &specimen.poisson_ratio) {
            (Some(_), None) => ["poisson_ratio", "diameter"],
            (None, Some(_)) => ["diameter", "poisson_ratio"],
            _ => return Ok(specimen),
        };
        Err(RodlabError::request(
            format!("{place}.{absent}"),
            format!("absent, and `{stated}` is stated"),
            "both or neither: lateral inertia depends on both",
        ))
    }

    /// Returns the rods of the tests.
    fn specimens(&self) -> impl Iterator<Item = &SpecimenSheet> {
        let own = |test: &'_ TestSheet| test.specimen.is_some();
        let of_all = self.specimen.iter();
        let used = of_all.filter(move |_| self.tests.iter().any(|test| !own(test)));
        used.chain(self.tests.iter().filter_map(|test| test.specimen.as_ref()))
    }

    /// Returns the rod, if all tests are made on the same rod.
    fn single_specimen(&self) -> Option<&SpecimenSheet> {
        let mut all = self.specimens();
        let first = all.next()?;
        all.all(|other| other.is_stated_as(first)).then_some(first)
    }

    /// Returns the relative errors of length and density that all tests share. Several rods share
    /// only the error of the density, because they are of one material; the largest stated error is
    /// used.
    fn specimen_uncertainty(&self) -> Result<SpecimenUncertainty, RodlabError> {
        let length = self.single_specimen().map_or(0.0, |specimen| {
            specimen.length.with_uncertainty().relative()
        });
        let densities = self.specimens().map(|specimen| &specimen.density);
        let density = densities
            .map(|density| density.with_uncertainty().relative())
            .fold(0.0, f64::max);
        SpecimenUncertainty::relative(length, density).in_step("specimen")
    }
}

/// Rates and relaxation times that depend on the temperature through one activation energy.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArrheniusSheet {
    /// Temperature at which the parameters of the laws are stated, such as `"23 degC"`.
    pub reference: Exact<Temperature>,
}

/// The rod.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpecimenSheet {
    /// Distance from the section of excitation to the free end, such as `"394 mm ± 0.5 mm"`. Its
    /// relative error contributes twice its amount to the relative error of E.
    pub length: Stated<Length>,
    /// Density, such as `"1140 kg/m3 ± 0.2 %"`. Its relative error contributes the same amount to
    /// the relative error of E.
    pub density: Stated<Density>,
    /// Diameter of a round rod, such as `"16 mm ± 0.05 mm"`. If diameter and Poisson's ratio are
    /// stated, lateral inertia is part of the model, with their errors.
    pub diameter: Option<Stated<Length>>,
    /// Poisson's ratio, such as `"0.40 ± 0.02"`.
    pub poisson_ratio: Option<Stated<PoissonRatio>>,
}

impl SpecimenSheet {
    fn is_stated_as(&self, other: &Self) -> bool {
        let shown = |specimen: &Self| {
            let diameter = specimen.diameter.as_ref().map(ToString::to_string);
            let ratio = specimen.poisson_ratio.as_ref().map(ToString::to_string);
            let rod = [specimen.length.to_string(), specimen.density.to_string()];
            (rod, diameter, ratio)
        };
        shown(self) == shown(other)
    }
}

fn laws_of_paper_d() -> Vec<Law> {
    vec![Law::Maxwell, Law::Norton, Law::GurevichRabinovich]
}

fn yes() -> bool {
    true
}

/// Results of the computation.
struct Found {
    tests: Vec<RodTest>,
    /// Impact velocity of each test \[m/s\].
    impact_velocities: Vec<f64>,
    /// True if the tests have distinct impact velocities.
    several_velocities: bool,
    /// True if the sheet states the temperature of every test.
    temperatures_are_stated: bool,
    laws: Vec<FittedLaw>,
    left: Left,
    comparison: Option<Comparison>,
    recorders: Vec<RecorderCheck>,
    /// Estimates of nonlinear laws on a narrower band. They are made only if the excitation alone
    /// does not already show that the recorder biases these laws.
    bands: Vec<NarrowedBand>,
    /// Errors of the transducers that must be assumed for a law to explain the data.
    transducers: Option<answer::SuspectTransducers>,
    /// The law whose profiles were computed.
    profiled: Option<Law>,
    profiles: Vec<Profile>,
}

impl Found {
    /// Returns the estimates that change on a narrower band.
    fn sensitive(&self) -> impl Iterator<Item = &NarrowedBand> {
        let laws = self.bands.len();
        self.bands
            .iter()
            .filter(move |band| band.is_sensitive(laws))
    }

    /// Returns the evidence, in words, that the recorder biases nonlinear laws.
    fn why_biased(&self) -> String {
        let of_excitation = || {
            "the excitation has a significant part above 0.6 of the recorder's cut-off".to_owned()
        };
        self.sensitive()
            .next()
            .map_or_else(of_excitation, NarrowedBand::to_string)
    }

    /// Returns true if the fit of the inelastic law at `place` of the comparison converged without
    /// determining the damping, and the comparison does not refute an elastic rod.
    fn is_without_damping(&self, place: usize) -> bool {
        let comparison = self.comparison.as_ref();
        let law = comparison.and_then(|found| found.laws.get(place)?.law);
        let mut fitted = self.laws.iter().filter(|fitted| Some(fitted.law) == law);
        let lacks = |fitted: &FittedLaw| !fitted.has_identified_damping() && !fitted.is_unsettled();
        law != Some(Law::Elastic) && fitted.any(lacks) && self.may_be_elastic()
    }

    /// Returns true unless the comparison refutes an elastic rod, by the misfit of that rod or by
    /// comparison with the best law.
    fn may_be_elastic(&self) -> bool {
        let compared = self.comparison.iter().flat_map(|found| &found.laws);
        let least = compared.clone().map(|law| law.chi_square);
        let least = least.fold(f64::INFINITY, f64::min);
        let is_refuted = |elastic: &ComparedLaw| {
            elastic.chi_square > least + REFUTED
                || elastic
                    .adequacy
                    .is_some_and(|adequacy| adequacy < ADEQUACY_LEVEL)
        };
        let mut elastic = compared.filter(|law| law.law == Some(Law::Elastic));
        !elastic.any(is_refuted)
    }
}

/// Excess of the χ² of an elastic rod over the χ² of the best law that refutes the elastic rod. For
/// a law with up to five more parameters, such an excess has a probability of 0.001 if the rod is
/// elastic.
const REFUTED: f64 = 20.5;

/// Returns true if the fastest test is distinctly faster than the slowest, by the criterion of the
/// comparison.
fn have_several_velocities(tests: &[TestSheet]) -> bool {
    let velocities = || tests.iter().map(|test| test.impact_velocity.si());
    let fastest = velocities().fold(0.0, f64::max);
    let slowest = velocities().fold(f64::INFINITY, f64::min);
    fastest >= DISTINCT_VELOCITIES * slowest
}

/// Returns the recorder check of each test; none if the recorder is part of the model.
fn recorders(sheet: &IdentifySheet, tests: &[RodTest]) -> Result<Vec<RecorderCheck>, RodlabError> {
    if sheet.recorder.is_some() {
        return Ok(Vec::new());
    }
    tests
        .iter()
        .zip(&sheet.tests)
        .enumerate()
        .map(|(number, (test, of_sheet))| {
            RecorderCheck::of(test, of_sheet.cutoff.as_ref().map(Exact::si))
                .in_step(format!("tests[{number}].cutoff"))
        })
        .collect()
}

/// Returns the standard candidates, and the `laws` of the sheet that are not among them.
fn candidates(sheet: &IdentifySheet) -> Result<Vec<Candidate>, RodlabError> {
    let mut all = Candidate::standard();
    for law in &sheet.laws {
        if !all.iter().any(|known| known.law() == Some(*law)) {
            all.push(Candidate::of(*law));
        }
    }
    all.into_iter().map(|one| sheet.activated(one)).collect()
}

/// Returns the laws of the sheet and, of the laws left by the comparison, the linear laws and the
/// laws with an equilibrium.
fn laws_to_fit(sheet: &IdentifySheet, left: &Left, comparison: Option<&Comparison>) -> Vec<Law> {
    let mut laws = sheet.laws.clone();
    let compared = |place: &usize| comparison?.laws.get(*place)?.law;
    for law in left.places().iter().filter_map(compared) {
        let has_equilibrium = Law::WITH_EQUILIBRIUM.contains(&law);
        if (law.is_linear() || has_equilibrium) && !laws.contains(&law) {
            laws.push(law);
        }
    }
    laws
}

pub(crate) fn run(sheet: &IdentifySheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    let mut outcome = Outcome::of("identify", sheet.title.as_str());
    outcome.settings = defaults();
    let mut tests = tests_of_sheet::read(sheet, context, &mut outcome)?;
    RodlabError::refuse_empty(&sheet.laws, "laws", "at least one law")?;
    if let Some(next) = &sheet.next {
        if sheet.arrhenius.is_some() {
            return Err(RodlabError::request(
                "next",
                "requested together with `arrhenius`",
                "only one of the two: tests are planned at one temperature",
            ));
        }
        next.check()?;
    }
    let lengths = sheet
        .specimens()
        .map(|specimen| specimen.length.with_uncertainty().value);
    let cells = lengths.fold(0.0, f64::max) / sheet.cell();
    if let Some(stated) = &sheet.cell {
        plausible::at_most(cells, MOST_CELLS, "cells", "cell")?;
        if sheet.fixed_cell().is_none() {
            outcome.warn(format!(
                "A cell of {stated} is too long to judge laws and their parameters: cells of {} mm are used, or shorter ones where the accuracy requires them.",
                1e3 * DEFAULT_CELL
            ));
        }
    }
    context.has_read_all(&outcome.inputs, &outcome.warnings)?;

    if let Some(draw) = &context.draw {
        return drawn(sheet, &tests, draw, outcome);
    }
    let recorders = recorders(sheet, &tests)?;
    let mut is_biased = recorders.iter().any(RecorderCheck::is_biased);
    let steps = sheet.laws.len() + usize::from(sheet.compare) + usize::from(sheet.profiles);
    context.progress.begins("identification", steps);
    let compared = |tests: &[RodTest]| {
        let further = Candidate::with_equilibrium().into_iter();
        let is_named = |one: &Candidate| one.law().is_some_and(|law| sheet.laws.contains(&law));
        let further: Vec<Candidate> = further
            .filter(|one| !is_named(one))
            .map(|one| sheet.activated(one))
            .collect::<Result<_, _>>()?;
        Selection::new(candidates(sheet)?)
            .map(|selection| selection.with_further(further))
            .and_then(|selection| selection.with_cell(sheet.cell())?.compare(tests))
            .in_step("comparing the laws")
    };
    let mut comparison = None;
    // misfit of the best law with the errors of the transducers as stated; set if a law explains
    // the data only with additional errors of the transducers
    let mut misfit_as_stated = None;
    if sheet.compare {
        let as_stated = compared(&tests)?;
        comparison = Some(as_stated.clone());
        if let Decision::NoneOfThese { adequacy, .. } = as_stated.decision
            && let Some(allowed) = with_unstated_transducers(&tests)
        {
            context.check_cancelled()?;
            let allowing = compared(&allowed)?;
            if !matches!(allowing.decision, Decision::NoneOfThese { .. }) {
                comparison = Some(allowing);
                tests = allowed;
                misfit_as_stated = Some(adequacy);
            }
        }
    }
    if let Some(comparison) = &comparison
        && let Some(cell) = outcome
            .settings
            .iter_mut()
            .find(|s| s.name == "cell" && s.by_default)
    {
        cell.value = format!(
            "{} mm, chosen from the noise",
            significant(1e3 * comparison.cell, 3)
        );
    }
    context.progress.one_more();
    context.check_cancelled()?;
    let several_velocities = have_several_velocities(&sheet.tests);
    let mut left = Left::of(comparison.as_ref(), is_biased, several_velocities);
    let cell = sheet.fixed_cell();
    let fits: Vec<LawFit> = laws_to_fit(sheet, &left, comparison.as_ref())
        .into_iter()
        .map(|law| {
            let is_rejected = left.excluded(law, comparison.as_ref()).is_some();
            LawFit::of((law, sheet), cell, comparison.as_ref(), is_rejected)
        })
        .collect::<Result<_, _>>()?;
    let mut laws = Vec::with_capacity(fits.len());
    let mut all_identified: Vec<Identified> = Vec::with_capacity(fits.len());
    let mut bands = Vec::new();
    let mut transducers = None;
    let first = left.places().first().and_then(|first| {
        let comparison = comparison.as_ref()?;
        comparison.laws.get(*first)?.law
    });
    for fit in &fits {
        let identified = fit.fitted(&tests)?;
        if let Some(misfit) = misfit_as_stated
            && (transducers.is_none() || first == Some(fit.law()))
        {
            transducers = Some(answer::SuspectTransducers {
                law: fit.law(),
                misfit,
                errors: identified.common_errors().to_vec(),
            });
        }
        let mut law = FittedLaw::of(fit.law(), &identified);
        law.standing = left.standing(&law, comparison.as_ref(), is_biased);
        if law.is_stated_nonlinear() {
            match fit.on_narrowed_band(&identified, &tests, &recorders) {
                Ok(band) => bands.push(band),
                Err(error) => outcome.warn(format!(
                    "the estimate was not compared with one on a narrower band: {error}"
                )),
            }
        }
        laws.push(law);
        all_identified.push(identified);
        context.progress.one_more();
        context.check_cancelled()?;
    }
    if bands.iter().any(|band| band.is_sensitive(bands.len())) {
        is_biased = true;
        left = Left::of(comparison.as_ref(), is_biased, several_velocities);
        for law in &mut laws {
            law.standing = left.standing(law, comparison.as_ref(), is_biased);
        }
    }
    let profiled = sheet
        .profiles
        .then(|| law_to_profile(&laws, &left, comparison.as_ref()))
        .flatten();
    let mut profiles: Vec<Profile> = Vec::new();
    for ((fit, identified), law) in fits.iter().zip(&all_identified).zip(&mut laws) {
        if Some(law.law) == profiled {
            let (mut lowest, found) = fit.with_profiles(identified, &tests)?;
            lowest.standing = law.standing.clone();
            *law = lowest;
            profiles = found;
        }
    }
    // the verdicts are based on the data alone; the uncertainty of the specimen is added to the
    // errors afterwards
    let specimen = sheet.specimen_uncertainty()?;
    let laws = laws
        .into_iter()
        .map(|law| law.with_specimen_uncertainty(&specimen))
        .collect();
    let with_specimen = |profile: &Profile| profile.with_specimen_uncertainty(&specimen);
    let profiles = profiles.iter().map(with_specimen).collect();
    let velocity = |test: &TestSheet| test.impact_velocity.si();
    let found = Found {
        tests,
        several_velocities,
        temperatures_are_stated: sheet.tests.iter().all(|test| test.temperature.is_some()),
        impact_velocities: sheet.tests.iter().map(velocity).collect(),
        laws,
        left,
        comparison,
        recorders,
        bands,
        transducers,
        profiled,
        profiles,
    };
    answer::tell(&found, &mut outcome);
    specimen::tell(sheet, &found, &mut outcome);
    for law in &found.laws {
        law.tell(&mut outcome);
        outcome.drawn_laws.of_rod.push(law.law);
    }
    for test in &found.tests {
        if let Some(unfiltered) = test.unfiltered_excitation() {
            outcome.accept(format!("recorder of test `{}`", test.name()), [unfiltered]);
        }
    }
    for check in &found.recorders {
        outcome.log.push(LogEntry {
            what: format!("recorder of test `{}`", check.test),
            accepted: !check.is_biased(),
            reasons: vec![check.to_string()],
        });
    }
    for band in &found.bands {
        outcome.log.push(LogEntry {
            what: format!("estimate of {} on a narrower band", band.model),
            accepted: !band.is_sensitive(found.bands.len()),
            reasons: vec![band.to_string()],
        });
    }
    if let Some(comparison) = &found.comparison {
        outcome.tables.push(table_of(comparison));
    }
    outcome.tables.extend(figures::tables(&found));
    outcome.figures = figures::all(&found);
    if let Some(next) = &sheet.next {
        next::tell(sheet, next, &found, context, &mut outcome)?;
    }
    Ok(outcome)
}

/// Fits the laws of the result to drawn tests, and reports their parameters.
fn drawn(
    sheet: &IdentifySheet,
    tests: &[RodTest],
    draw: &Draw,
    mut outcome: Outcome,
) -> Result<Outcome, RodlabError> {
    let cell = sheet.fixed_cell();
    for law in &draw.laws.of_rod {
        let identified = LawFit::of((*law, sheet), cell, None, false)?.fitted(tests)?;
        FittedLaw::of(*law, &identified).tell(&mut outcome);
    }
    Ok(outcome)
}

/// Returns the law whose profiles are computed. It is the most probable of the remaining fitted
/// laws whose damping the data may determine; without a comparison, or if no law remains, it is the
/// law with the nearest response.
fn law_to_profile(laws: &[FittedLaw], left: &Left, comparison: Option<&Comparison>) -> Option<Law> {
    let named = left.places().iter().filter_map(|index| {
        let named = comparison?.laws.get(*index)?.law;
        laws.iter().find(|law| Some(law.law) == named)
    });
    let nearest = || {
        laws.iter()
            .filter(|_| left.places().is_empty())
            .min_by(|a, b| a.relative_error.total_cmp(&b.relative_error))
    };
    named
        .filter(|law| law.standing == Standing::Possible)
        .find(|law| law.is_worth_profiles())
        .or_else(|| nearest().filter(|law| law.is_worth_profiles()))
        .map(|law| law.law)
}

/// Returns the defaults of optional fields.
fn defaults() -> Vec<Setting> {
    let laws: Vec<String> = laws_of_paper_d()
        .iter()
        .map(|law| format!("{law:?}"))
        .collect();
    let DifferentiatorSheet { half_width, degree } = DifferentiatorSheet::default();
    let differentiator = format!("{} points, degree {degree}", 2 * half_width + 1);
    vec![
        Setting::by_default("laws", laws.join(", ")),
        Setting::by_default("compare", true),
        Setting::by_default("profiles", true),
        Setting::by_default(
            "cell",
            format!(
                "{} mm or less, as short as the accuracy requires",
                1e3 * DEFAULT_CELL
            ),
        ),
        Setting::by_default("differentiator", differentiator),
    ]
}

fn table_of(comparison: &Comparison) -> Table {
    Rows::of(&comparison.laws, "laws", "Laws compared")
        .word("law", |law| &law.name)
        .word(
            "kind",
            |law| {
                if law.is_linear { "linear" } else { "nonlinear" }
            },
        )
        .number("probability", "", |law| law.probability)
        .number("chi-square", "", |law| law.chi_square)
        .number("independent samples", "", |_| comparison.effective_samples)
        .number("adequacy", "", |law| law.adequacy.unwrap_or(f64::NAN))
        .number("parameters that the data determine", "", |law| {
            law.determined
        })
        .table
}
