//! The tests of papers A and B as a laboratory would have made them: exact histories at the sensors, anti-alias filter, noise,
//! converter, ten blows, averaged spectra, modulus. The truth is known.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "in a test, a refusal where none is expected is a failure"
)]

mod coverage;
mod instrument_chain;
mod paper_a;
mod paper_b;
