//! What a laboratory does by accident and an adversary on purpose: values, sizes and materials at the ends of the scale, and
//! laws of physics that must hold for any body.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_precision_loss,
    clippy::float_cmp,
    reason = "in a test, a refusal where none is expected is a failure; counts are small; some numbers must be the same to \
              the last bit"
)]

mod extremes_media;
mod hostile;
mod hostile_bodies;
mod hostile_histories;
mod hostile_laws;
mod properties_chains;
mod properties_marches;

type Findings = hostile::Findings<rodwave::RodwaveError>;

/// What a function makes of its arguments.
type Numbers = Result<Vec<f64>, rodwave::RodwaveError>;
