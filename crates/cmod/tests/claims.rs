//! Master curves with known shifts.

mod rheology;
