//! Printed results of the thesis, computed from its printed numbers: `fixtures/golden`.

mod paper_a;
mod paper_d;
mod paper_e;
mod table;

pub(crate) use paper_e::{Bodies, bodies};
