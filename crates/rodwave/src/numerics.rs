//! Numerics that the forward and the inverse crates share.

mod jet;

pub use jet::Jet;
