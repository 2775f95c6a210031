//! What a laboratory does by accident and an adversary on purpose: values and sizes at the ends of the scale, extreme
//! materials and rods, and what must hold for any specimen.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_precision_loss,
    clippy::float_cmp,
    reason = "in a test, a refusal where none is expected is a failure; counts are small; some numbers must be the same to \
              the last bit"
)]

#[path = "../../rodwave/tests/hard_to_break/hostile.rs"]
mod hostile;
mod hostile_estimates;
mod hostile_models;
mod properties_round_trips;
mod specimen;

type Findings = hostile::Findings<cmod::CmodError>;

/// What a function makes of its arguments.
type Numbers = Result<Vec<f64>, cmod::CmodError>;
