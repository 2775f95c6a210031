//! One-dimensional waves in viscoelastic rods: the direct problem.
//!
//! # Problem
//! A slender rod obeys ∂σ/∂x = ρ ∂v/∂t and ∂ε/∂t = ∂v/∂x with a constitutive law between σ and ε
//! (Ödeen 1993, survey, eqs. 2.1-2.3). The crate computes the response of a section to an impact at
//! one end, the response of an end to a force, and the contact force between two bodies.
//!
//! Linear laws are complex moduli E(ω): [`modulus`] contains them, [`medium`] their wave
//! propagation, and [`kramers_kronig`] tests whether measured values are causal. [`element`] and
//! [`transition`] transfer the state of a section through rods, cones, horns, masses, springs and
//! dashpots; [`chain`] combines them into bodies, with the mobility of their faces at any
//! frequency; [`synthesis`] converts spectra to histories. [`slenderness`] gives the error of
//! one-dimensional theory and corrects it.
//!
//! Nonlinear laws are inelastic strain rates F(σ), see [`inelastic`]. [`characteristics`] solves
//! the direct problem of paper D; [`line`](mod@line) computes waves in bodies of several parts,
//! with branches and contacts. [`lumped`] is an independent second solver, [`impact`] computes the
//! impact of a striker on a rod, and [`experiment`] simulates the records of instruments.
//! [`digits`] formats numbers for messages.
//!
//! ```
//! use rodwave::inelastic::Maxwell;
//! use rodwave::{DirectProblem, InelasticRod};
//!
//! // one end of a polyamide rod is suddenly set in motion: when does the other end begin to move?
//! let rod = InelasticRod::new(0.4, 1140.0, 3.209e9, Maxwell::new(4e6)?)?;
//! let problem = DirectProblem::new(rod, 400)?;
//! let mut march = problem.march(9.0);
//! while march.free_end_velocity() == 0.0 {
//!     march.advance(9.0);
//! }
//! assert_eq!(march.steps(), 400); // one cell per step: the front travels at (E/ρ)^½
//! let energy = march.energy();
//! assert!(energy.dissipated > 0.0);
//! assert!((energy.supplied - energy.stored - energy.dissipated).abs() < 1e-12 * energy.supplied);
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! # Conventions
//! SI units throughout. Time factor e^{+iωt}, so E'' >= 0 and the propagation coefficient γ = α +
//! ik has α >= 0 and k > 0 for ω > 0. x and the particle velocity v are positive along the rod;
//! stress and normal force are positive in tension, contact forces in compression. The state of a
//! section is (N, v).
//!
//! # Errata of the source
//! The "finite system method" of paper D is not described in public text; the method of
//! characteristics replaces it. The power laws of paper E, eq. 7, are not a causal pair and are
//! valid on the real frequency axis only.
//!
//! # Limitations
//! * One dimension: lateral inertia is included only in [`slenderness`], as a correction for
//!   uniform round rods, and in [`BranchedProblem`](characteristics::BranchedProblem).
//! * No plasticity with memory, damage or heat: the inelastic strain rate depends on the present
//!   stress only.
//! * In the time domain, areas are piecewise constant and laws have a finite number of branches;
//!   cones, horns and fractional laws require [`chain`].
//!
//! Theory: `docs/theory/moduli.md`, `docs/theory/kramers-kronig.md`,
//! `docs/theory/transition-matrices.md`, `docs/theory/chains.md`, `docs/theory/slenderness.md`,
//! `docs/theory/inelastic-laws.md`, `docs/theory/direct-problem.md`, `docs/theory/lines.md`,
//! `docs/theory/virtual-experiments.md`.

pub mod band_limited;
pub mod chain;
pub mod characteristics;
pub mod digits;
pub mod element;
mod error;
pub mod experiment;
pub mod fourier;
pub mod impact;
pub mod inelastic;
mod interpolation;
pub mod kramers_kronig;
pub mod line;
pub mod lumped;
pub mod medium;
pub mod modulus;
pub mod numerics;
mod quotient;
mod rod;
pub mod slenderness;
mod sliding_window;
pub mod synthesis;
pub mod transition;
pub mod waves;

pub use chain::{Chain, Termination};
pub use characteristics::DirectProblem;
pub use error::RodwaveError;
pub use rod::InelasticRod;

// Types that appear in signatures, re-exported so that a program that depends on this crate alone
// uses the matching version.
pub use num_complex;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ExampleOfReadme;
