//! Contents of a packed or nested file while it is read.

use crate::format::memory::Budget;
use crate::format::{MemoryLimit, Strictness};
use crate::{Contents, LabioError, Place, Series};

/// Greatest depth of nested structures that is read; laboratory data are not nested deeper.
pub(super) const DEEPEST: usize = 64;

/// Maximum length of a field name, including the names of the enclosing structures. MATLAB allows
/// 63 bytes per level; the limit bounds the memory for a million empty fields with one long prefix.
pub(super) const LONGEST_NAME: usize = 512;

/// Contents read so far, and the memory that they take.
#[derive(Debug)]
pub(super) struct Reading {
    pub(super) contents: Contents,
    pub(super) budget: Budget,
    strictness: Strictness,
}

impl Reading {
    pub(super) fn new(format: &'static str, limit: MemoryLimit, strictness: Strictness) -> Self {
        Self {
            contents: Contents::of_format(format),
            budget: Budget::new(format, limit),
            strictness,
        }
    }

    pub(super) fn property(
        &mut self,
        at: u64,
        key: String,
        value: String,
    ) -> Result<(), LabioError> {
        self.budget.take_property(&key, &value, Place::Byte(at))?;
        self.contents.properties.push((key, value));
        Ok(())
    }

    pub(super) fn series(&mut self, at: u64, series: Series) -> Result<(), LabioError> {
        self.budget.take_series(&series, Place::Byte(at))?;
        self.contents.series.push(series);
        Ok(())
    }

    /// Turns `error` into a defect in a tolerant reading. Contents beyond the memory limit are
    /// rejected in both kinds of reading.
    pub(super) fn pass_over(&mut self, error: LabioError, at: u64) -> Result<(), LabioError> {
        if self.strictness == Strictness::Strict || matches!(error, LabioError::MemoryLimit { .. })
        {
            return Err(error);
        }
        let n_bytes = size_of::<LabioError>() + error.to_string().len();
        self.budget
            .take_text(n_bytes, Place::Byte(at), "a defect")?;
        self.contents.defects.push(error);
        Ok(())
    }
}
