//! Claims of the crate `maxwellid`: laws identified from two velocity histories of virtual rods,
//! simulated by another solver.

mod errors;
mod identification;
mod models;
mod selection;
mod table_a1;
mod transducers;
