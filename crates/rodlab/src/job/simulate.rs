//! Virtual tests, for planning and for trying the other commands. A virtual test produces records
//! like those of a laboratory, and a sheet that evaluates them.

mod blows;
mod creep_recovery;
mod end_accelerations;
mod figures;
mod files;
mod frame_strains;
mod hammer_on_body;
mod hopkinson_bars;
mod impacted_rod;
pub(crate) mod inelastic_law;
mod instrument;
mod level;
mod truth;

pub use blows::{BlowsSheet, ShapeSheet};
pub use creep_recovery::{CreepLoadSheet, CreepRecoverySheet};
pub use end_accelerations::{EndAccelerationsSheet, StatedErrorsSheet};
pub use frame_strains::{StrainsInFrameSheet, SupportSheet};
pub use hammer_on_body::HammerOnBodySheet;
pub use hopkinson_bars::{HopkinsonBarsSheet, VirtualBarSheet, VirtualSpecimenSheet};
pub use impacted_rod::{ImpactedRodSheet, SensorsSheet, StrikerSheet};
pub use inelastic_law::InelasticLawSheet;
pub use instrument::{AntiAliasSheet, ConverterSheet, InstrumentSheet};
pub use level::LevelText;

use std::path::PathBuf;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rodfigure::Figure;
use rodwave::medium::Medium;
use rodwave::modulus::GeneralisedMaxwell;
use serde::Deserialize;

use super::{About, JobContext};
use crate::bodies::material::{AnalyticLaw, Material};
use crate::bodies::material_sheet::{self, Materials, material_called};
use crate::bodies::replacement::{Replacement, WithoutUncertainty};
use crate::digits::hertz;
use crate::outcome::{Attachment, Setting, Table};
use crate::sheet::{self, Exact, Language, Length};
use crate::{Outcome, RodlabError};
use blows::Recorded;
use files::Naming;
use truth::Truth;

/// Default name of the files of records.
const USUAL_OUTPUT: &str = "records.csv";
/// Default seed.
const USUAL_SEED: u64 = 1;

/// Sheet of the job.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimulateSheet {
    /// Title of the test.
    pub title: String,
    /// Free texts for the report.
    #[serde(default)]
    pub about: About,
    /// Materials by their names in the experiment.
    #[serde(default)]
    pub materials: Materials,
    /// The experiment.
    pub experiment: ExperimentSheet,
    /// Sensors, filter, sampling and converter; needed by every experiment except `CreepRecovery`.
    pub instrument: Option<InstrumentSheet>,
    /// Name of the files of the records. The files are numbered: `"hits.csv"` gives `hits-1.csv`,
    /// `hits-2.csv`, ... The extension determines the format: csv, npy, npz, uff or wav.
    /// `"records.csv"` by default.
    pub output: Option<String>,
    /// Seed of scatter and noise; by default 1. The same sheet gives identical files.
    pub seed: Option<u64>,
}

/// An experiment.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ExperimentSheet {
    /// Accelerations of both ends of a rod (paper A).
    EndAccelerations(Box<EndAccelerationsSheet>),
    /// Strains of a member of a structure (paper B).
    StrainsInFrame(Box<StrainsInFrameSheet>),
    /// Loss factors after creep loads (paper C).
    CreepRecovery(Box<CreepRecoverySheet>),
    /// A rod with an inelastic law, struck by a projectile (paper D).
    ImpactedRod(Box<ImpactedRodSheet>),
    /// Hits of a hammer on the face of a body (paper E).
    HammerOnBody(Box<HammerOnBodySheet>),
    /// A specimen between split Hopkinson bars, struck by a projectile.
    HopkinsonBars(Box<HopkinsonBarsSheet>),
}

/// Data of the sheet that all experiments use.
struct Request<'a> {
    title: &'a str,
    materials: &'a Materials,
    seed: u64,
    naming: Naming,
}

impl Request<'_> {
    /// Returns the random numbers of the record `number`, counted from 0.
    fn random(&self, number: usize) -> ChaCha8Rng {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(number as u64);
        random
    }

    /// Returns the duration of the silence at the beginning of a record \[s\]. It ends before the
    /// precursor that the filter produces ahead of the impact.
    fn silent(&self, instrument: &InstrumentSheet) -> f64 {
        instrument.before() - 25.0 / instrument.sampling_rate.si()
    }

    /// Returns density and law of the material called `name`. The law consists of springs and
    /// Maxwell branches, for a march in time.
    fn prony(&self, name: &str, field: &str) -> Result<(f64, GeneralisedMaxwell), RodlabError> {
        // checks the name, the density and the numbers of the law
        material_called(self.materials, name, field)?;
        let of_sheet = self.materials.get(name).map(|sheet| sheet.prony(field));
        of_sheet.transpose()?.flatten().ok_or_else(|| {
            RodlabError::request(
                field,
                format!("`{name}`"),
                "a material whose law is Elastic, Maxwell, Zener or Prony: it is computed by marching in time",
            )
        })
    }

    /// Returns the fields `files`, `sampling_rate` and `channels` of a sheet that evaluates the
    /// records.
    fn records_of_sheet(&self, recorded: &Recorded, indent: &str) -> String {
        self.records_with(recorded, "", indent)
    }

    /// Returns the fields of [`Self::records_of_sheet`], each channel with the further fields
    /// `more`.
    fn records_with(&self, recorded: &Recorded, more: &str, indent: &str) -> String {
        let pattern = self.naming.pattern();
        let first = recorded.records.first();
        first
            .map(|first| {
                self.naming
                    .records_of_sheet((&pattern, first), more, indent)
            })
            .unwrap_or_default()
    }
}

/// A struck rod, for which a sheet evaluates the modulus from the hits.
struct StruckRod<'a> {
    /// Length, with its standard uncertainty if one is stated.
    length: String,
    diameter: &'a Exact<Length>,
    density: f64,
    /// Standard uncertainty of the density as the end of its text; empty if none is stated.
    density_error: String,
    /// Further fields of the specimen.
    more: &'a str,
    /// Further fields of each channel.
    of_channel: String,
    method: &'a str,
    /// Comment on the silence before a hit.
    silence: &'a str,
}

impl StruckRod<'_> {
    fn evaluation(
        &self,
        request: &Request<'_>,
        recorded: &Recorded,
        instrument: &InstrumentSheet,
    ) -> Evaluation {
        let text = format!(
            r#"Modulus(
    title: {title:?},
    specimen: (
        length: "{length}",
        diameter: "{diameter}",
        density: "{density} kg/m3{density_error}",{more}
    ),
    method: {method},
    // each record is a hit
    source: Hits(
        {records},
        // {silence}
        silent: "{silent:.4} ms",
    ),
    // where the filter of the recorder passes everything
    band: (from: "100 Hz", to: "{highest:.3} kHz"),
    // simulated waves are one-dimensional
    lateral_inertia: (poisson_ratio: "0"),
)
"#,
            title = request.title,
            length = self.length,
            diameter = self.diameter,
            density = self.density,
            density_error = self.density_error,
            more = self.more,
            method = self.method,
            records = request.records_with(recorded, &self.of_channel, "        "),
            silence = self.silence,
            silent = 1e3 * request.silent(instrument),
            highest = 1e-3 * instrument.passes_up_to_hz(),
        );
        Evaluation::new("modulus", "modulus.ron", text, &recorded.generator)
    }
}

/// Results of an experiment.
struct Made {
    recorded: Option<Recorded>,
    truth: Truth,
    tables: Vec<Table>,
    figures: Vec<Figure>,
    in_words: String,
    /// Sheets that evaluate the records; the first one is recommended.
    evaluations: Vec<Evaluation>,
}

impl Made {
    /// Converts the evaluation sheets, which are in RON, to the language of the sheet of the test.
    fn in_the_language(mut self, language: Language) -> Result<Self, RodlabError> {
        if language != Language::Ron {
            for evaluation in &mut self.evaluations {
                let path = PathBuf::from(&evaluation.file);
                evaluation.text = sheet::in_toml(&path, &evaluation.text)?;
                evaluation.file = path
                    .with_extension(Language::Toml.extension())
                    .to_string_lossy()
                    .into_owned();
            }
        }
        Ok(self)
    }
}

/// A sheet that evaluates the records.
struct Evaluation {
    job: &'static str,
    file: String,
    text: String,
}

impl Evaluation {
    fn new(job: &'static str, file: &'static str, sheet: String, generator: &str) -> Self {
        let text = format!(
            "// Evaluates virtual records with `rodlab {job}`. The true values are in truth.csv next to this sheet.\n\
             // They were made by: {generator}.\n{sheet}"
        );
        Self {
            job,
            file: file.to_owned(),
            text,
        }
    }
}

/// Returns the material called `name`. Its law must be known in the right half plane, because
/// histories are computed.
fn analytic(
    request: &Request<'_>,
    name: &str,
    field: &str,
) -> Result<Medium<AnalyticLaw>, RodlabError> {
    match material_called(request.materials, name, field)? {
        Material::Analytic(medium) => Ok(medium),
        Material::OnAxis(_) => Err(RodlabError::request(
            field,
            format!("`{name}`, whose law is known for real frequencies only"),
            "a material with a causal law, because a history is computed",
        )),
    }
}

impl SimulateSheet {
    /// Returns the defaults of optional fields.
    fn defaults(&self) -> Vec<Setting> {
        let of_experiment: &[(&str, &str)] = match &self.experiment {
            ExperimentSheet::EndAccelerations(_) => &[
                ("accelerometer_mass", "none"),
                ("blows.shape", "RaisedCosine"),
                ("blows.scatter", "5 %"),
            ],
            ExperimentSheet::StrainsInFrame(_) => &[
                ("struck_end", "nothing"),
                ("other_end", "nothing"),
                ("blows.shape", "RaisedCosine"),
                ("blows.scatter", "5 %"),
            ],
            ExperimentSheet::CreepRecovery(_) => &[],
            ExperimentSheet::ImpactedRod(_) => &[
                ("spring", "none"),
                ("sensors", "velocities"),
                (
                    "cell",
                    "a hundredth of the shortest wave that the recorder passes",
                ),
            ],
            ExperimentSheet::HammerOnBody(_) => {
                &[("blows.shape", "RaisedCosine"), ("blows.scatter", "5 %")]
            }
            ExperimentSheet::HopkinsonBars(_) => &[("specimen.hardening", "none")],
        };
        let mut defaults: Vec<Setting> = of_experiment
            .iter()
            .map(|(name, value)| Setting::by_default(format!("experiment.{name}"), value))
            .collect();
        defaults.push(Setting::by_default("output", USUAL_OUTPUT));
        defaults.push(Setting::by_default("seed", USUAL_SEED));
        defaults.extend(self.instrument.iter().flat_map(|i| i.defaults()));
        defaults
    }
}

pub(crate) fn run(sheet: &SimulateSheet, context: &JobContext<'_>) -> Result<Outcome, RodlabError> {
    let mut outcome = Outcome::of("simulate", sheet.title.as_str());
    outcome.settings = sheet.defaults();
    let mut exact = WithoutUncertainty {
        why: "a virtual test has exact values",
    };
    exact.materials(&sheet.materials)?;
    let materials = material_sheet::read(&sheet.materials, context.folder, &mut outcome)?;
    let measured = materials.iter().filter_map(|(name, material)| {
        let [from, to] = material.measured_band_hz()?;
        Some(format!(
            "The material `{name}` is the law of a result as it was found, measured from {} to {}: the virtual test does not include its errors.",
            hertz(from),
            hertz(to)
        ))
    });
    outcome.summary.extend(measured);
    let request = Request {
        title: &sheet.title,
        materials: &materials,
        seed: sheet.seed.unwrap_or(USUAL_SEED),
        naming: Naming::of(sheet.output.as_deref().unwrap_or(USUAL_OUTPUT))?,
    };
    let needed = || {
        RodlabError::request(
            "instrument",
            "missing",
            "at least its fields `sampling_rate` and `length`: this experiment is recorded",
        )
    };
    let instrument = sheet.instrument.as_ref();
    if let Some(instrument) = instrument {
        instrument.check()?;
    }
    let instrument_or = || instrument.ok_or_else(needed);
    let made = match &sheet.experiment {
        ExperimentSheet::EndAccelerations(test) => {
            test.make(&request, instrument_or()?, context)?
        }
        ExperimentSheet::StrainsInFrame(test) => test.make(&request, instrument_or()?, context)?,
        ExperimentSheet::CreepRecovery(test) => test.make(&request, context)?,
        ExperimentSheet::ImpactedRod(test) => test.make(&request, instrument_or()?, context)?,
        ExperimentSheet::HammerOnBody(test) => test.make(&request, instrument_or()?, context)?,
        ExperimentSheet::HopkinsonBars(test) => test.make(&request, instrument_or()?, context)?,
    };
    let made = made.in_the_language(context.language)?;
    tell(made, instrument, &mut outcome)?;
    Ok(outcome)
}

fn tell(
    made: Made,
    instrument: Option<&InstrumentSheet>,
    outcome: &mut Outcome,
) -> Result<(), RodlabError> {
    outcome.say(format!("{}.", made.in_words));
    for evaluation in &made.evaluations {
        outcome.say(format!(
            "The sheet `{}` evaluates the virtual test: `rodlab {} {}` in the folder of this result.",
            evaluation.file, evaluation.job, evaluation.file
        ));
    }
    made.truth.tell(outcome);
    outcome.tables.extend(made.tables);
    outcome.figures.extend(made.figures);
    if let Some(recorded) = made.recorded {
        let records = match recorded.records.len() {
            1 => "1 record".to_owned(),
            n => format!("{n} records"),
        };
        // the name of a generator is left out if it is the path of a module
        outcome.say(if recorded.generator.contains("::") {
            format!("{records}.")
        } else {
            format!("{records}, made by the generator `{}`.", recorded.generator)
        });
        outcome.log.extend(recorded.log);
        outcome.warnings.extend(recorded.warnings);
        let names: Vec<String> = recorded
            .files
            .iter()
            .map(|file| file.name.clone())
            .collect();
        outcome
            .figures
            .extend(figures::histories(&recorded.records, &names));
        if let Some(instrument) = instrument {
            let cutoff = instrument.cutoff_hz();
            outcome
                .figures
                .extend(figures::spectra(&recorded.records, cutoff)?);
        }
        outcome.tables.extend(figures::table(&recorded.records));
        outcome.attachments.extend(recorded.files);
    }
    for evaluation in made.evaluations {
        outcome.attachments.push(Attachment {
            name: evaluation.file,
            bytes: evaluation.text.into_bytes(),
        });
    }
    Ok(())
}
