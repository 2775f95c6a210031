//! Parameters of the three-element model from recovery tests, and their identifiability.
//!
//! - [`SingleTestFit`]: equation 4 alone, with two numbers per test.
//! - [`paper_procedure`]: E₂ and B from one test, and m from the other tests, as in paper C.
//! - [`RecoveryFit`]: all tests together by weighted least squares, with standard errors and a
//!   verdict for each parameter.
//!
//! # Identifiability
//! With k = E₂Bσ_r^m the prediction depends on E₁/E₂, k and m. Hence
//! - **E₁** cannot be determined, because only E₁/E₂ enters; it is given with its error, which E₂
//!   and B share;
//! - **one load** gives Δtan δᵢ and t_r, and for every m one pair of E₂ and B gives the same two
//!   numbers;
//! - **readings at t ≪ t_r** only give Δtan δᵢ; readings at t ≫ t_r only give the product Δtan δᵢ
//!   t_r = E₁(m+1)/(E₂ωm), which is the same for all loads.
//!
//! The singular values of the Jacobian relative to the noise measure the identifiability; the
//! [`Reason`] states why a parameter is not identifiable.
//!
//! # Example
//! Fit of readings after 45 MPa and after 19 MPa, each applied for half an hour.
//!
//! ```
//! use cmod::recovery::fit::{ErrorScale, Reason, RecoveryFit, SeriesModulus, Verdict};
//! use cmod::recovery::{LoadHistory, LossFactorReadings, RecoveryTest};
//!
//! let time = [60.0, 300.0, 600.0, 1800.0, 3600.0];
//! let test = |name: &str, stress, change: [f64; 5]| {
//!     let readings = LossFactorReadings {
//!         time: &time,
//!         change: &change,
//!         standard_error: &[2e-4; 5],
//!         virgin_standard_error: 1e-4,
//!     };
//!     RecoveryTest::new(name, LoadHistory::creep(stress, 1800.0)?, 10e3, readings)
//! };
//! let tests = [
//!     test("45 MPa", 45e6, [0.0184, 0.0104, 0.0069, 0.0027, 0.0016])?,
//!     test("19 MPa", 19e6, [0.0021, 0.0021, 0.0018, 0.0013, 0.0009])?,
//! ];
//! let modulus = SeriesModulus { value: 3100e6, standard_error: 50e6 };
//! let fit = RecoveryFit::new(&tests, modulus, ErrorScale::Stated)?;
//! let [_, _, _, exponent, _] = fit.estimates;
//! assert_eq!(exponent.verdict, Verdict::Identified);
//! assert!((exponent.value - 1.8).abs() < 3.0 * exponent.standard_error);
//!
//! // one of the tests alone does not determine the exponent
//! let alone = RecoveryFit::new(&tests[..1], modulus, ErrorScale::Stated)?;
//! assert_eq!(alone.estimates[3].verdict, Verdict::NotIdentifiable(Reason::OneLoad));
//! # Ok::<(), cmod::CmodError>(())
//! ```

mod joint;
mod paper;
mod prediction;
mod single;
mod verdict;

pub use super::least_squares::Ending;
pub use joint::{Disagreement, ErrorScale, PredictedChange, RecoveryFit, SeriesModulus};
pub use paper::{PaperFit, paper_procedure};
pub use single::SingleTestFit;
pub use verdict::{Estimate, IDENTIFIED_BELOW, Reason, Scale, Verdict};
