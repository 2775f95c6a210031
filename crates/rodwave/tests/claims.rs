//! Claims of the crate `rodwave`.

mod bodies;
mod causality;
mod direct_problem;
mod experiments;
mod impact_level;
mod inelastic;
mod line;
mod mobility;
mod moduli;
mod paper_e;
mod projectile;
mod relaxation;
mod slenderness;
mod synthesis;
mod two_bodies;
