//! The extension module `rodlab._rodlab`: jobs, records and spectra of the workspace for the Python
//! package `rodlab`.
//!
//! This module contains no numerics, only the code that passes data between Rust and Python. The
//! functions that a user calls are written in Python, in `python/rodlab`, and documented there; the
//! functions of this module are private and are listed in `_rodlab.pyi`.
//!
//! | module | content |
//! |---|---|
//! | `background` | work on a separate thread: interruptions, progress, panics |
//! | `errors` | errors of the crates as the exceptions of the package |
//! | `outcome` | the result of a job |
//! | `jobs` | sheets run from files or from memory; check, inspect, convert, init |
//! | `campaign` | campaigns of many sheets, single tests of a campaign |
//! | `records` | calibrated hits from files |
//! | `rods` | mobilities, transition matrices, propagation of waves |
//! | `spectra` | frequency responses of arrays |

mod background;
mod campaign;
mod errors;
mod jobs;
mod outcome;
mod records;
mod rods;
mod spectra;

/// Extension module `rodlab._rodlab`.
#[pyo3::pymodule]
mod _rodlab {
    #[pymodule_export]
    use crate::campaign::{batch, one_test, tests_of};
    #[pymodule_export]
    use crate::jobs::{check, command, convert, init, inspect, run_sheet, run_text};
    #[pymodule_export]
    use crate::outcome::Outcome;
    #[pymodule_export]
    use crate::records::{Hit, load};
    #[pymodule_export]
    use crate::rods::{mobility, propagation_coefficient, transition_matrix};
    #[pymodule_export]
    use crate::spectra::frequency_response;
}
