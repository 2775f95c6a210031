//! `cargo xtask reproduce-paper-d`.
use crate::Outcome;
pub(crate) fn run(_check: bool, _accept: bool) -> Outcome {
    Err("not written yet".into())
}
