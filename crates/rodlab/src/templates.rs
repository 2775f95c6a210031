//! Commented sheets to begin with: `rodlab init JOB`.

use std::path::Path;

use clap::ValueEnum;

use crate::sheet::Language;
use crate::{RodlabError, output};

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
    /// Propagation of waves in a long bar, from one shot on it.
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

    /// Name of the command.
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

    /// The commented sheet of the job; in TOML for [`Language::Json`], which has no comments.
    #[must_use]
    pub fn template(self, language: Language) -> &'static str {
        macro_rules! both {
            ($name:literal) => {
                match language {
                    Language::Ron => include_str!(concat!("../templates/", $name, ".ron")),
                    Language::Toml | Language::Json => {
                        include_str!(concat!("../templates/", $name, ".toml"))
                    }
                }
            };
        }
        match self {
            Self::Frf => both!("frf"),
            Self::Modulus => both!("modulus"),
            Self::Recovery => both!("recovery"),
            Self::Fit => both!("fit"),
            Self::Identify => both!("identify"),
            Self::Mobility => both!("mobility"),
            Self::Force => both!("force"),
            Self::Bar => both!("bar"),
            Self::Shpb => both!("shpb"),
            Self::Simulate => both!("simulate"),
        }
    }
}

/// Writes the commented sheet of `job` to the new file `path`: in RON with the extension `ron`,
/// else in TOML.
///
/// # Errors
///
/// [`RodlabError::Write`]; an existing file is never replaced.
pub fn init(job: JobName, path: &Path) -> Result<(), RodlabError> {
    let is_ron = path
        .extension()
        .is_some_and(|ending| ending == Language::Ron.extension());
    let language = if is_ron {
        Language::Ron
    } else {
        Language::Toml
    };
    output::write_new(path, job.template(language).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_template_is_a_sheet_of_its_job_and_the_same_in_both_languages() {
        for job in JobName::ALL {
            let parsed = |language| {
                let sheet =
                    crate::job::parse(Path::new("template"), job.template(language)).unwrap();
                assert_eq!(sheet.name(), job.name());
                format!("{sheet:#?}") // every field, quantities as they are written
            };
            assert_eq!(parsed(Language::Toml), parsed(Language::Ron));
        }
    }
}
