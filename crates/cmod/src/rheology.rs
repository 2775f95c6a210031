//! Laws of viscoelasticity fitted to a complex modulus.

mod data;
mod fit;
mod information;
mod law;
mod least_squares;
mod model;
mod non_negative;
mod order;
mod parameter;
mod power_law;
mod profile;
mod prony;
mod start;
mod whiteness;

pub use data::{ModulusData, ModulusPoint};
pub use fit::{Criterion, ErrorScale, FitOptions, PredictedModulus, RheologicalFit};
pub use law::{FittedLaw, Law};
pub use least_squares::Ending;
pub use order::{Order, PronyFit};
pub use parameter::{Interval, IntervalMethod, LINEAR_BELOW, Parameter, Reason, Scale, Verdict};
pub use power_law::PowerLaw;
pub use whiteness::Whiteness;
