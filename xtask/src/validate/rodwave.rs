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
mod slenderness;
mod synthesis;

use super::check::Report;

pub(crate) fn report() -> Report {
    mobility::report()
        .and(moduli::report())
        .and(causality::report())
        .and(slenderness::report())
        .and(inelastic::report())
        .and(impact_level::report())
        .and(direct_problem::report())
        .and(line::report())
        .and(synthesis::report())
        .and(experiments::report())
}
