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

use super::check::Report;

pub(crate) fn report() -> Report {
    paper_e::report()
        .and(mobility::report())
        .and(relaxation::report())
        .and(moduli::report())
        .and(causality::report())
        .and(slenderness::report())
        .and(inelastic::report())
        .and(impact_level::report())
        .and(direct_problem::report())
        .and(line::report())
        .and(projectile::report())
        .and(synthesis::report())
        .and(experiments::report())
        .and(two_bodies::report())
}
