//! File formats, each with the same face: `read` from a path, `read_from` any source of bytes.
//!
//! What is read is a [`Record`](crate::Record); what is wrong with a file is a [`LabioError`](crate::LabioError) that names
//! the file, the place and what was expected there.

pub mod npy;
