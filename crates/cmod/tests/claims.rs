//! What `cmod` claims: the moduli that each method finds of virtual rods, their errors, and what is made of them.

mod branches;
mod cards;
mod gauge_errors;
mod gauges;
mod lateral_inertia;
mod neighbours;
mod record_checks;
mod recovery;
mod rheology;
mod roots;
mod two_point;
