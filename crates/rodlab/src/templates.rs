//! Commented sheets to start from: `rodlab init JOB`.

use std::path::Path;

use clap::ValueEnum;

use crate::sheet::Language;
use crate::{RodlabError, output};

/// Evaluates to the commented sheet with this name, in a given language.
macro_rules! sheets {
    ($language:expr, $name:literal) => {
        match $language {
            Language::Ron => include_str!(concat!("../templates/", $name, ".ron")),
            Language::Toml | Language::Json => {
                include_str!(concat!("../templates/", $name, ".toml"))
            }
        }
    };
}

/// A job that has a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum JobName {
    /// Frequency responses of hits.
    Frf,
    /// Complex modulus of a rod.
    Modulus,
    /// Loss factor from creep recovery.
    Recovery,
    /// Laws and master curve from tables of a modulus.
    Fit,
    /// Constitutive law from two histories of an impacted rod.
    Identify,
    /// Mobility of an impact face.
    Mobility,
    /// Force between two bodies, or from a response.
    Force,
    /// Propagation of waves in a long bar, from one or more shots.
    Bar,
    /// Stress-strain curve from split Hopkinson bars.
    Shpb,
    /// A virtual test.
    Simulate,
}

impl JobName {
    /// All jobs.
    pub const ALL: [Self; 10] = [
        Self::Frf,
        Self::Modulus,
        Self::Recovery,
        Self::Fit,
        Self::Identify,
        Self::Mobility,
        Self::Force,
        Self::Bar,
        Self::Shpb,
        Self::Simulate,
    ];

    /// Returns the name of the command.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Frf => "frf",
            Self::Modulus => "modulus",
            Self::Recovery => "recovery",
            Self::Fit => "fit",
            Self::Identify => "identify",
            Self::Mobility => "mobility",
            Self::Force => "force",
            Self::Bar => "bar",
            Self::Shpb => "shpb",
            Self::Simulate => "simulate",
        }
    }

    /// Returns the commented sheet of the job; in TOML for [`Language::Json`], because JSON has no
    /// comments.
    #[must_use]
    pub fn template(self, language: Language) -> &'static str {
        match self {
            Self::Frf => sheets!(language, "frf"),
            Self::Modulus => sheets!(language, "modulus"),
            Self::Recovery => sheets!(language, "recovery"),
            Self::Fit => sheets!(language, "fit"),
            Self::Identify => sheets!(language, "identify"),
            Self::Mobility => sheets!(language, "mobility"),
            Self::Force => sheets!(language, "force"),
            Self::Bar => sheets!(language, "bar"),
            Self::Shpb => sheets!(language, "shpb"),
            Self::Simulate => sheets!(language, "simulate"),
        }
    }
}

/// Arrangement on the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Rig {
    /// A free rod with an accelerometer on each end.
    TwoAccelerometers,
    /// A member of a structure with strain gauges.
    ThreeGauges,
    /// A long bar with gauges and a free end.
    HopkinsonBar,
    /// A hammer, and a sensor for the motion of a body.
    HammerFrf,
    /// A specimen between two bars.
    Shpb,
    /// Tables of a dynamic mechanical analysis.
    Dma,
}

impl Rig {
    /// All rigs.
    pub const ALL: [Self; 6] = [
        Self::TwoAccelerometers,
        Self::ThreeGauges,
        Self::HopkinsonBar,
        Self::HammerFrf,
        Self::Shpb,
        Self::Dma,
    ];

    /// Returns the name used in commands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::TwoAccelerometers => "two-accelerometers",
            Self::ThreeGauges => "three-gauges",
            Self::HopkinsonBar => "hopkinson-bar",
            Self::HammerFrf => "hammer-frf",
            Self::Shpb => "shpb",
            Self::Dma => "dma",
        }
    }

    /// Returns the job that evaluates the records of the rig.
    #[must_use]
    pub fn job(self) -> JobName {
        match self {
            Self::TwoAccelerometers | Self::ThreeGauges => JobName::Modulus,
            Self::HopkinsonBar => JobName::Bar,
            Self::HammerFrf => JobName::Frf,
            Self::Shpb => JobName::Shpb,
            Self::Dma => JobName::Fit,
        }
    }

    /// Returns the commented sheet of the rig.
    #[must_use]
    pub fn template(self, language: Language) -> &'static str {
        match self {
            Self::TwoAccelerometers => sheets!(language, "two-accelerometers"),
            Self::ThreeGauges => sheets!(language, "three-gauges"),
            Self::HammerFrf => sheets!(language, "hammer-frf"),
            // these jobs have only one arrangement
            Self::HopkinsonBar | Self::Shpb | Self::Dma => self.job().template(language),
        }
    }
}

/// Writes the commented sheet of `job`, or of a `rig` for this job, to the new file `path`. The
/// language is RON if the extension is `ron`, otherwise TOML.
///
/// # Errors
///
/// [`RodlabError::Exists`] if the file exists, because no file is replaced; [`RodlabError::Write`]
/// if it cannot be written; [`RodlabError::Request`] for a rig of another job.
pub fn init(job: JobName, rig: Option<Rig>, path: &Path) -> Result<(), RodlabError> {
    let is_ron = path
        .extension()
        .is_some_and(|ending| ending == Language::Ron.extension());
    let language = if is_ron {
        Language::Ron
    } else {
        Language::Toml
    };
    let sheet = match rig {
        None => job.template(language),
        Some(rig) if rig.job() == job => rig.template(language),
        Some(rig) => {
            let of_rig = rig.job().name();
            return Err(RodlabError::request(
                format!("--rig {}", rig.name()),
                format!("a rig of `{of_rig}`"),
                format!(
                    "a rig of `{}`: run `rodlab init {of_rig} --rig {}`",
                    job.name(),
                    rig.name()
                ),
            ));
        }
    };
    output::write_new(path, sheet.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the sheet of `job` that is parsed from `text`, as debug text.
    fn parsed(job: JobName, text: &str) -> String {
        let sheet = crate::job::parse(Path::new("template"), text).unwrap();
        assert_eq!(sheet.name(), job.name());
        format!("{sheet:#?}")
    }

    #[test]
    fn every_template_is_a_sheet_of_its_job_and_the_same_in_both_languages() {
        for job in JobName::ALL {
            let parsed = |language| parsed(job, job.template(language));
            assert_eq!(parsed(Language::Toml), parsed(Language::Ron));
        }
    }

    #[test]
    fn every_rig_has_a_sheet_of_its_job_in_both_languages() {
        assert_eq!(Rig::ALL, Rig::value_variants());
        for rig in Rig::ALL {
            let of_command = rig.to_possible_value().unwrap();
            assert_eq!(of_command.get_name(), rig.name());
            let parsed = |language| parsed(rig.job(), rig.template(language));
            assert_eq!(parsed(Language::Toml), parsed(Language::Ron));
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sheet.toml");
        let refused = init(JobName::Frf, Some(Rig::Dma), &path).unwrap_err();
        assert!(refused.to_string().contains("rodlab init fit"), "{refused}");
        assert!(!path.exists());
    }
}
