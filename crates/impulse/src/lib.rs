//! The force between impacting bodies, from what each body answers to a force on its impact face.
//!
//! # The problem
//!
//! Two linear bodies meet with the velocity $`V`$. Each is known only by its impulse response $`G_i(t)`$, the velocity of its
//! impact face after a unit impulse of force there, measured or computed (Ödeen 1993, paper E, eq. 1). As long as the faces
//! stick, their velocities are the same,
//!
//! ```math
//! [G_1(t) + G_2(t)] * F_s(t) = V\,H(t),
//! ```
//!
//! with Heaviside's step $`H`$ (paper E, eq. 2). [`StickProblem`] solves this in the frequency domain as the paper does;
//! [`separate`] ends the contact where $`F_s`$ ceases to be compressive (paper E, eq. 3).
//!
//! The same division answers another question: which force made a body with a known frequency response move as was
//! measured? [`Reconstruction`] gives it, with what the answer is worth.
//!
//! ```
//! use impulse::{ContactEnd, StickProblem, ZeroLine, separate};
//! use num_complex::Complex64;
//!
//! # fn main() -> Result<(), impulse::ImpulseError> {
//! // a rigid mass of 0.5 kg strikes a long rod of characteristic impedance 1000 kg/s at 2 m/s
//! let (mass, impedance, velocity) = (0.5, 1000.0, 2.0);
//! let frequency_step_hz = 50.0;
//! let omega = |line: usize| 2.0 * std::f64::consts::PI * frequency_step_hz * line as f64;
//! let striker: Vec<_> = (0..=4096).map(|k| 1.0 / Complex64::new(0.0, omega(k) * mass)).collect();
//! let rod = vec![Complex64::from(1.0 / impedance); striker.len()];
//!
//! let stick = StickProblem {
//!     first: &striker,
//!     second: &rod,
//!     frequency_step_hz,
//!     impact_velocity: velocity,
//!     zero_line: ZeroLine::EffectiveMass(mass),
//!     roll_off_from_hz: Some(100e3), // half the band: no ringing at the jump
//! }
//! .solve()?;
//! // F = Z V exp(-Z t / M); at one time constant
//! let history = &stick.history;
//! if let Some(sample) = history.index_near(mass / impedance) {
//!     let exact = impedance * velocity * (-impedance / mass * history.time_at(sample)).exp();
//!     assert!((history.force()[sample] / exact - 1.0).abs() < 1e-6);
//! }
//!
//! // what rings below 1 % of the peak is no sign of separation: the mass stays on the rod until its momentum has gone
//! let impact = separate(history, 0.01 * impedance * velocity)?;
//! assert_eq!(impact.end, ContactEnd::InContact);
//! assert!((impact.history.impulse() / (mass * velocity) - 1.0).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```
//!
//! # Conventions
//!
//! - Forces are positive in compression. Mobility $`G = v/F`$ \[m/(N s)\] has the velocity of the face along the force: a free body
//!   of mass $`M`$ tends to $`1/(i\omega M)`$, a long rod has $`1/Z`$, and passive bodies have $`\operatorname{Re} G \ge 0`$.
//! - Time factor $`e^{+i\omega t}`$. Spectra are one-sided, their lines $`k\,\Delta f`$ start at 0 Hz; $`L`$ lines stand for
//!   $`2(L-1)`$ samples.
//! - SI units throughout.
//!
//! # What this does not do
//!
//! - The bodies are linear, the contact area is constant, there is no friction, and the interface has one velocity (Ödeen 1993,
//!   paper E, section 2). Hertzian contact is outside.
//! - The force is found on a period of time $`1/\Delta f`$: it must have died out, or become constant, within it. Two finite
//!   elastic bodies never come to rest as long as they stick; for them the result is flagged, not trusted.
//! - The band limit rings at jumps of the force. A roll-off removes the ringing and rounds the jump.
//! - After the first separation the bodies are taken not to touch again, as in the paper; eq. 3 is then the whole history.
//! - No uncertainty of the force is computed from that of the mobilities, and nothing is screened for causality.

mod balance;
mod body;
mod contact;
mod contact_law;
mod convolution;
mod error;
mod force_error;
mod fourier;
mod history;
mod impact;
mod kernel;
mod reconstruct;
mod stick;
mod uncertainty;
mod unilateral;

pub use balance::Balance;
pub use body::{
    Causality, Domain, FrontLimit, ImpactBody, LowFrequency, MassCheck, MeasuredBody, MobilityLaw,
    Passivity, Reciprocity, Screening, ScreeningFlag, WeighedMass, lines_of,
};
pub use contact::{ContactEnd, Graze, ImpactForce, separate};
pub use contact_law::{ContactLaw, ElasticMaterial, TabulatedContact};
pub use error::ImpulseError;
pub use force_error::{Coverage, ForceBand, ForceError};
pub use history::{ForceHistory, ForcePeak};
pub use impact::{Impact, LineBand, Pair, Prediction, PredictionFlag};
pub use kernel::{Kernel, Quadrature, TimeGrid};
pub use reconstruct::{
    CalibrationBlow, CalibrationScatter, ChoiceVerdict, ChosenParameter, CurvePoint, ExcludedLine,
    ExclusionReason, FrequencyBand, NonNegativity, Parameter, Penalty, PivotingEnd,
    RandomErrorOfForce, ReconstructedForce, Reconstruction, Regularisation, ResponseEnd,
    ResponseNoise, Sensor, TimeInterval,
};
pub use stick::{Settlement, StickForce, StickProblem, ZeroLine};
pub use uncertainty::{EndError, EndVerdict, MonteCarlo, StickUncertainty, contact_band};
pub use unilateral::ContactInterval;
