//! File formats behind one face: [`read`] finds out by the content what a file is; a [`Reader`] and a [`Writer`] belong to each format.
//!
//! What is read is [`Contents`]: the data sets of the file in the file's own units. What is wrong with a file is a
//! [`LabioError`] that names the file, the place and what was expected there.

use std::fmt::Debug;
use std::io::Write;

use crate::{Contents, LabioError};

pub mod csv;
pub mod lvm;
pub mod mat5;
pub mod npy;
pub mod npz;
pub mod wav;

mod kind;
mod rounding;
mod text;

pub use rounding::{CustomaryRate, RateFamily, customary_rate};
pub use text::DecimalMark;

/// What to do with a part of a file that cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strictness {
    /// Refuse the file.
    #[default]
    Strict,
    /// Return what could be read, and list the rest in [`Contents::defects`].
    Tolerant,
}

/// The reading half of a format.
pub trait Reader: Debug + Sync {
    /// Name of the format, as `uff58`.
    fn name(&self) -> &'static str;

    /// Whether a file that begins with `head` (its first 4096 bytes, or all of it) is of this format.
    fn recognises(&self, head: &[u8]) -> bool;

    /// Reads all of a file. Memory is taken only for bytes that are there, whatever a header announces.
    ///
    /// # Errors
    ///
    /// [`LabioError`] with the place; if `strictness` is tolerant, only when nothing at all can be made of the bytes.
    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError>;
}

/// The writing half of a format.
pub trait Writer: Debug + Sync {
    /// Name of the format.
    fn name(&self) -> &'static str;

    /// Writes `contents`; what the format cannot hold is an error before the first byte.
    ///
    /// # Errors
    ///
    /// [`LabioError`] for contents that the format cannot hold, or [`LabioError::Write`].
    fn write(&self, contents: &Contents, output: &mut dyn Write) -> Result<(), LabioError>;
}
