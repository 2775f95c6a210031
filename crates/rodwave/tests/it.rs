//! Integration tests of rodwave: one program, with a module for each subject.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::float_cmp,
    reason = "a failing test may panic"
)]

mod bad_input;
mod bodies;
mod chain;
mod claims;
mod direct_problem;
mod experiment_end_accelerations;
mod experiment_impact;
mod experiment_strains;
mod golden;
mod hard_to_break;
mod impact;
mod inelastic_laws;
mod line;
mod linear_laws;
mod linear_transition;
mod modulus_causality;
mod modulus_derivatives;
mod modulus_tabulated;
mod modulus_time_domain;
mod no_allocation;
mod reference_mpmath;
mod reference_solve_ivp;
mod slenderness;
mod synthesis_impact;
