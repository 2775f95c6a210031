//! Commented sheets to begin with: `rodlab init JOB`.

use std::path::Path;

use clap::ValueEnum;

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

    /// The commented sheet of the job.
    #[must_use]
    pub fn template(self) -> &'static str {
        match self {
            Self::Frf => include_str!("../templates/frf.ron"),
            Self::Modulus => include_str!("../templates/modulus.ron"),
            Self::Recovery => include_str!("../templates/recovery.ron"),
            Self::Fit => include_str!("../templates/fit.ron"),
            Self::Identify => include_str!("../templates/identify.ron"),
            Self::Mobility => include_str!("../templates/mobility.ron"),
            Self::Force => include_str!("../templates/force.ron"),
            Self::Bar => include_str!("../templates/bar.ron"),
            Self::Shpb => include_str!("../templates/shpb.ron"),
            Self::Simulate => include_str!("../templates/simulate.ron"),
        }
    }
}

/// Writes the commented sheet of `job` to the new file `path`.
///
/// # Errors
///
/// [`RodlabError::Write`]; an existing file is never replaced.
pub fn init(job: JobName, path: &Path) -> Result<(), RodlabError> {
    output::write_new(path, job.template().as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sheet;

    #[test]
    fn every_template_is_a_sheet_of_its_job() {
        for job in JobName::ALL {
            let parsed = sheet::parse(Path::new("template.ron"), job.template());
            assert_eq!(parsed.unwrap().name(), job.name());
        }
    }
}
