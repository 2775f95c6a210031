//! Identification of nonlinear Maxwell laws from two velocity histories of an impacted rod.
//!
//! # Problem
//! A rod is struck at one end. The velocity v_e(t) at a section near that end and the velocity
//! v_r(t) of the free end, a distance L away, are known. The crate finds Young's modulus E and the
//! inelastic law F(σ) in ∂ε/∂t = (1/E) ∂σ/∂t + F(σ) that reproduce v_r from v_e (Ödeen 1993, paper
//! D), and states how well the data determine them.
//!
//! # Method
//! Each evaluation solves the direct problem of [`rodwave::characteristics`] with v_e prescribed;
//! the sum of squares of simulated minus measured v_r over all tests (paper D, eq. 12) is minimised
//! over (ln E, shape of the law, ln of its rate at 10 MPa) by damped least squares with exact
//! derivatives. At the minimum the singular values of the Jacobian, the covariance and a
//! [`Verdict`] for each parameter show what the data determine. If the noise of both histories is
//! stated, the residual is whitened with it and the excitation is estimated too; gain, offset and
//! delay of the transducers can be unknowns ([`Nuisances`]).
//!
//! # Choice of the law
//! [`selection`] compares the laws of paper D with linear competitors ([`linear`]); its result may
//! be that the data do not decide, or that none of the laws is adequate. [`profile`] bounds
//! parameters that are not identified; [`design`] plans the next test. The paper's own classifier
//! is in [`samples`] and [`adequacy`].
//!
//! # Errata of the source
//! * Eq. (14), a recursion with gain 1/m on the printed parameters, diverges or stagnates: in Pa
//!   the Hessian has the eigenvalues 3e-29, 2e-14 and 4.5e4 (m/s)². It is replaced.
//! * The units of Tables 4 and A1 have no physically consistent interpretation; taken literally,
//!   the rods are elastic over the record and their damping cannot be identified from data with 2 %
//!   noise, which this crate reports.
//!
//! # Limitations
//! * [`Fit`] does not choose between laws; [`selection`] does. A nonlinear law also fits data of a
//!   *linear* material with constant loss factor well, because amplitude and frequency content
//!   decrease together along the rod. A fit to one impact velocity does not prove the nonlinearity
//!   of a law.
//! * Errors are those of the linearised problem at the minimum.
//!
//! Theory: `docs/theory/identification.md`, `docs/theory/model-identification.md`,
//! `docs/theory/adequacy.md`.

pub mod adequacy;
mod agreement;
mod arrhenius;
mod branched;
mod catalogue;
pub mod common_error;
pub mod conformal;
pub mod design;
mod deviation;
mod displacement;
mod error;
mod fit;
mod historical;
mod identifiability;
mod identification;
mod laplace_line;
mod lateral_inertia;
mod law;
mod least_squares;
pub mod linear;
mod model;
mod noise;
mod nuisance;
mod parallel;
pub mod profile;
pub mod recorder;
mod report;
mod residual;
pub mod samples;
pub mod selection;
mod single_branch;
mod special_case;
mod specimen;
mod start;
mod test;
mod vectors;
mod velocity;
mod whitening;

pub use agreement::FitFlag;
pub use arrhenius::Arrhenius;
pub use branched::BranchedRod;
pub use catalogue::Law;
pub use common_error::{CommonError, ErrorOf};
pub use displacement::DisplacementTransducers;
pub use error::MaxwellidError;
pub use fit::{DEFAULT_ACCURACY, Fit, Method};
pub use identifiability::{Estimate, IDENTIFIED_BELOW, Identifiability, Noise, Verdict};
pub use identification::Identification;
pub use law::{IdentifiableLaw, Role, Scale, StatedParameter};
pub use least_squares::{Evaluations, Termination};
pub use model::{DEFAULT_CELL, DrivenRod, LinearisedResponse, RodModel, stated_modulus};
pub use noise::{HistoryNoise, TestNoise};
pub use nuisance::{Freedom, NuisanceEstimate, Nuisances};
pub use report::Report;
pub use special_case::{Branch, PronySeries, SpecialCase};
pub use specimen::{SpecimenSensitivity, SpecimenUncertainty};
pub use start::StartOutcome;
pub use test::{Provenance, RodTest, RodTestData, TestFlag};
pub use velocity::Differentiator;

// Types that appear in signatures, re-exported so that a program that depends on this crate alone
// uses the matching version.
pub use {num_complex, rodwave};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ExampleOfReadme;
