//! Numerics that the forward and the inverse crates share.

mod common_errors;
mod jet;

pub use common_errors::CommonErrors;
pub use jet::Jet;
