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

use super::check::Report;
use super::claims::Claims;

pub(crate) fn report() -> Report {
    let mut claims = Claims::new();
    branches::claims(&mut claims);
    two_point::claims(&mut claims);
    roots::claims(&mut claims);
    gauges::claims(&mut claims);
    gauge_errors::claims(&mut claims);
    neighbours::claims(&mut claims);
    lateral_inertia::claims(&mut claims);
    record_checks::claims(&mut claims);
    recovery::claims(&mut claims);
    rheology::claims(&mut claims);
    cards::claims(&mut claims);
    claims.into_report()
}
