//! Input that is wrong by accident or on purpose: values and sizes at the ends of the range,
//! extreme materials and rods, and properties that estimates must have for any specimen.

#[path = "../../rodwave/tests/hard_to_break/hostile.rs"]
mod hostile;
mod hostile_estimates;
mod hostile_models;
mod properties_round_trips;
mod specimen;

type Findings = hostile::Findings<cmod::CmodError>;

/// Numbers that a function returns for its arguments.
type Numbers = Result<Vec<f64>, cmod::CmodError>;
