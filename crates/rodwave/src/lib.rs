//! One-dimensional waves in viscoelastic rods: the forward physics.
pub mod band_limited;
pub mod characteristics;
mod error;
pub mod experiment;
pub mod impact;
pub mod inelastic;
pub mod lumped;
pub mod medium;
pub mod modulus;
mod rod;
pub mod transition;
pub use characteristics::DirectProblem;
pub use error::RodwaveError;
pub use rod::InelasticRod;
