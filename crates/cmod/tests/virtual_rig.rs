//! The tests of papers A and B as a laboratory would have made them: exact histories at the sensors, anti-alias filter, noise,
//! converter, ten blows, averaged spectra, modulus. The truth is known.

mod coverage;
mod instrument_chain;
mod paper_a;
mod paper_b;
