//! Environment of a job: folder, language, progress and interruption.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::RodlabError;
use crate::draw::Draw;
use crate::outcome::InputFile;
use crate::sheet::Language;

/// Environment of a job: the folder of its relative paths, the language of its sheet, its progress
/// display and its interruption.
#[derive(Debug)]
pub struct JobContext<'a> {
    /// The folder of the relative paths in the sheet.
    pub folder: &'a Path,
    /// The language of the sheet.
    pub language: Language,
    /// Receiver of the current step and the number of finished parts.
    pub progress: &'a dyn Progress,
    /// Flag that is set to stop the job.
    pub interrupted: &'a AtomicBool,
    /// True if the job ends when it has read all its files ([`check`](crate::job::check)).
    pub only_reads: bool,
    /// Draw of a Monte Carlo computation; `None` in an ordinary run. In a draw, the job adds drawn
    /// random errors to its data, and produces only the numbers of its result.
    pub draw: Option<Draw>,
}

impl JobContext<'_> {
    /// Returns an error if the job must stop. Long jobs call this between their steps.
    ///
    /// # Errors
    ///
    /// [`RodlabError::Interrupted`] if the job must stop.
    pub fn check_cancelled(&self) -> Result<(), RodlabError> {
        if self.interrupted.load(Ordering::Relaxed) {
            Err(RodlabError::Interrupted)
        } else {
            Ok(())
        }
    }

    /// Ends the job if it is only a check. Each job calls this when it has read all its files, the
    /// `inputs`, and checked its sheet, and before it computes. `warnings` are those found so far.
    pub(crate) fn has_read_all(
        &self,
        inputs: &[InputFile],
        warnings: &[String],
    ) -> Result<(), RodlabError> {
        if self.only_reads {
            Err(RodlabError::ReadOnly {
                inputs: inputs.to_vec(),
                warnings: warnings.to_vec(),
            })
        } else {
            self.check_cancelled()
        }
    }
}

/// Receiver of the progress of a job.
pub trait Progress: std::fmt::Debug + Sync {
    /// Reports the start of `step` with `of` parts; `of` is 0 if their number is unknown.
    fn begins(&self, step: &str, of: usize);
    /// Reports that one part is done.
    fn one_more(&self);
}

/// Progress that is not displayed.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begins(&self, _step: &str, _of: usize) {}
    fn one_more(&self) {}
}
