//! What `impulse` claims: forces with a closed form, the impacts of paper E, and forces from measured responses.

mod bodies;
mod closed_forms;
mod contact_laws;
mod kernels;
mod lines_in_time;
mod measured_bodies;
mod paper_e;
mod reconstruction;
mod uncertainty;

use super::check::Report;
use super::claims::Claims;

pub(crate) fn report() -> Report {
    let mut claims = Claims::new();
    closed_forms::claims(&mut claims);
    contact_laws::claims(&mut claims);
    kernels::claims(&mut claims);
    paper_e::claims(&mut claims);
    lines_in_time::claims(&mut claims);
    measured_bodies::claims(&mut claims);
    reconstruction::claims(&mut claims);
    uncertainty::claims(&mut claims);
    claims.into_report()
}
