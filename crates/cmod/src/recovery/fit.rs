//! The parameters of the three-element model from recovery tests, and what tests determine them.
//!
//! - [`SingleTestFit`]: equation 4 alone, two numbers a test.
//! - [`paper_procedure`]: E₂ and B from one test, m from the others, as paper C has it.
//! - [`RecoveryFit`]: all tests together by weighted least squares, with standard errors and a verdict for each parameter.
//!
//! # What can be found
//! With k = E₂Bσ_r^m the prediction depends on E₁/E₂, k and m. Hence
//! - **E₁** scales out and is given, with its error, which E₂ and B share;
//! - **one load** gives Δtan δᵢ and t_r, and for every m there are one E₂ and one B that give these;
//! - **readings at t ≪ t_r** only give Δtan δᵢ, readings at t ≫ t_r only the product Δtan δᵢ t_r = E₁(m+1)/(E₂ωm), common to all
//!   loads.
//!
//! The singular values of the Jacobian over the noise say so in numbers; the [`Reason`] says it in words.

mod joint;
mod paper;
mod prediction;
mod single;
mod verdict;

pub use super::least_squares::Ending;
pub use joint::{ErrorScale, PredictedChange, RecoveryFit, SeriesModulus};
pub use paper::{PaperFit, paper_procedure};
pub use single::SingleTestFit;
pub use verdict::{Estimate, IDENTIFIED_BELOW, Reason, Scale, Verdict};
