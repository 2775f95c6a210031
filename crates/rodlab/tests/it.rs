//! Integration tests of rodlab: one program, a module for each subject.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::float_cmp,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a failing test may panic"
)]

mod bad_input;
mod bar;
mod bodies;
mod campaign;
mod campaign_sheets;
mod chain;
mod command;
mod convert;
mod examples;
mod faults;
mod fit;
mod force;
mod force_from_response;
mod force_measured;
mod frf;
mod fuzz_corpus;
mod hits;
mod identify;
mod inspect;
mod languages;
mod mobility;
mod modulus;
mod monte_carlo;
mod outputs;
mod records;
mod recovery;
mod report_in_browser;
mod rich;
mod runge_kutta;
mod runs;
mod shpb;
mod simulate;
mod single_shot;
mod stated_uncertainty;
mod struck_rods;
mod tour;
mod two_masses;
mod view;
mod virtual_rod;
