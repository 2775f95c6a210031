//! What `maxwellid` claims: laws from two velocity histories, of virtual rods that another solver has made.

mod errors;
mod identification;
mod models;
mod selection;
mod table_a1;
mod transducers;
mod virtual_rod;

use super::check::Report;
use super::claims::Claims;

pub(crate) fn report() -> Report {
    let mut claims = Claims::new();
    models::claims(&mut claims);
    table_a1::claims(&mut claims);
    identification::claims(&mut claims);
    errors::claims(&mut claims);
    transducers::claims(&mut claims);
    selection::claims(&mut claims);
    claims.into_report()
}
