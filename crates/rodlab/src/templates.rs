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

/// Declares choices on the command line, each with its name in commands.
macro_rules! choices {
    ($(#[$doc:meta])* $choice:ident: $($(#[$doc_of_one:meta])* $one:ident = $name:literal,)+) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
        pub enum $choice {
            $($(#[$doc_of_one])* $one,)+
        }

        impl $choice {
            /// All choices.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$one),+];

            /// Returns the name used in commands.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$one => $name,)+
                }
            }
        }
    };
}

choices! {
    /// A job that has a sheet.
    JobName:
    /// Frequency responses of hits.
    Frf = "frf",
    /// Complex modulus of a rod.
    Modulus = "modulus",
    /// Loss factor from creep recovery.
    Recovery = "recovery",
    /// Laws and master curve from tables of a modulus.
    Fit = "fit",
    /// Constitutive law from two histories of an impacted rod.
    Identify = "identify",
    /// Mobility of an impact face.
    Mobility = "mobility",
    /// Force between two bodies, or from a response.
    Force = "force",
    /// Propagation of waves in a long bar, from one or more shots.
    Bar = "bar",
    /// Stress-strain curve from split Hopkinson bars.
    Shpb = "shpb",
    /// A virtual test.
    Simulate = "simulate",
}

impl JobName {
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

choices! {
    /// Arrangement on the bench.
    Rig:
    /// A free rod with an accelerometer on each end.
    TwoAccelerometers = "two-accelerometers",
    /// A member of a structure with strain gauges.
    ThreeGauges = "three-gauges",
    /// A long bar with gauges and a free end.
    HopkinsonBar = "hopkinson-bar",
    /// A hammer, and a sensor for the motion of a body.
    HammerFrf = "hammer-frf",
    /// A specimen between two bars.
    Shpb = "shpb",
    /// Tables of a dynamic mechanical analysis.
    Dma = "dma",
}

impl Rig {
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
