//! Claims of the crate `rodwave`.

mod causality;
mod direct_problem;
pub(crate) mod experiments;
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
