//! The force between impacting bodies, from the response of each body to a force on its impact
//! face.
//!
//! # The problem
//!
//! Two linear bodies meet with the velocity $`V`$. Each is known only by its impulse response
//! $`G_i(t)`$, the velocity of its impact face after a unit impulse of force there, measured or
//! computed (Ödeen 1993, paper E, eq. 1). As long as the faces stick, their velocities are the
//! same,
//!
//! ```math
//! [G_1(t) + G_2(t)] * F_s(t) = V\,H(t),
//! ```
//!
//! with Heaviside's step $`H`$ (paper E, eq. 2). Faces do not stick: they separate where the force
//! would be tensile, and may touch again. With the approach $`\delta`$ of the faces, where
//! $`-\delta`$ is their gap,
//!
//! ```math
//! \dot\delta = V - [G_1 + G_2] * F ,\qquad 0 \le F \perp -\delta \ge 0 ,
//! ```
//!
//! or $`F = f(\delta)`$ for a compliant contact. [`Impact::predict`] solves this by time marching,
//! with the balance of momentum and energy. Bodies are [chains of `rodwave`](rodwave::chain),
//! [formulas](MobilityLaw), [measurements](MeasuredBody), which are
//! [screened](MeasuredBody::screen) first, or [assemblies](Assembly) of several of them.
//!
//! ```
//! use impulse::Impact;
//! use rodwave::chain::{AnalyticChain, Termination};
//! use rodwave::element::Circle;
//! use rodwave::medium::Medium;
//! use rodwave::modulus::{ConstantQ, Elastic};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // the wide end of a nylon cone on a long steel rod: it touches more than once
//! let nylon = Medium::new(1150.0, ConstantQ::new(2.6e9, 0.094, 18.8e3)?)?;
//! let steel = Medium::new(7780.0, Elastic::new(206e9)?)?;
//! let cone = AnalyticChain::analytic_from_impact_face()
//!     .cone(&nylon, Circle::of_diameter(0.075)?, Circle::of_diameter(0.030)?, 0.400)
//!     .end(Termination::Free)?;
//! let long_rod = AnalyticChain::analytic_from_impact_face()
//!     .end(Termination::semi_infinite(&steel, Circle::of_diameter(0.010)?))?;
//! let force = Impact::between(&cone, &long_rod).at_velocity(0.93).predict(4e-3)?;
//! assert!(force.contacts.len() >= 4);
//! let balance = force.balance();
//! assert!(balance.energy_residual.abs() < 1e-12);
//! assert!(balance.restitution.is_some_and(|e| e.abs() < 0.01));
//! # Ok(())
//! # }
//! ```
//!
//! # The stick force in three ways
//!
//! | | method | bodies | limitation |
//! |---|---|---|---|
//! | [`Impact::stick_force_on_lines`], [`StickProblem`] | Fourier transform, as in the paper | any, on common lines; the force must decay | a band limit |
//! | [`Impact::stick_force_damped`] | Fourier transform on $`\operatorname{Re} s = a`$ | analytic laws, including two finite elastic bodies | jumps are smoothed |
//! | [`Impact::stick_force`] | [march in time](Quadrature) | any; convolution quadrature needs analytic laws | jumps smear over a step |
//!
//! A method that is not applicable to a body gives a typed error ([`ImpulseError::OutsideDomain`])
//! or a flag. [`separate`] ends a stick force where it ceases to be compressive (paper E, eq. 3),
//! without the contacts that may follow.
//!
//! The division of spectra also solves the inverse problem: [`Reconstruction`] finds the force that
//! caused the measured motion of a body with a known frequency response, with its error.
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
//!     interpolation: 1,
//!     until: None,
//! }
//! .solve()?;
//! // F = Z V exp(-Z t / M); at one time constant
//! let history = &stick.history;
//! if let Some(sample) = history.index_near(mass / impedance) {
//!     let exact = impedance * velocity * (-impedance / mass * history.time_at(sample)).exp();
//!     assert!((history.force()[sample] / exact - 1.0).abs() < 1e-6);
//! }
//!
//! // ringing below 1 % of the peak is not a separation: the mass stays on the rod until it has
//! // no momentum left
//! let impact = separate(history, 0.01 * impedance * velocity)?;
//! assert_eq!(impact.end, ContactEnd::InContact);
//! assert!((impact.history.impulse() / (mass * velocity) - 1.0).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```
//!
//! # Split Hopkinson bars
//!
//! [`hopkinson`] evaluates the strains of two bars on both sides of a specimen: forces and
//! velocities of its faces, stress and strain, with bands.
//!
//! # Conventions
//!
//! - Forces are positive in compression. Mobility $`G = v/F`$ \[m/(N s)\] has the velocity of the
//!   face along the force: a free body of mass $`M`$ tends to $`1/(i\omega M)`$, a long rod has
//!   $`1/Z`$, and passive bodies have $`\operatorname{Re} G \ge 0`$.
//! - Time factor $`e^{+i\omega t}`$. Spectra are one-sided, their lines $`k\,\Delta f`$ start at 0
//!   Hz; $`L`$ lines correspond to $`2(L-1)`$ samples.
//! - SI units throughout.
//!
//! # Limitations
//!
//! - The bodies are linear, there is no friction, and the interface has one velocity (Ödeen 1993,
//!   paper E, section 2). If the contact area grows with the force, the contact law is nonlinear,
//!   not the bodies.
//! - The plain transform finds the force on a period $`1/\Delta f`$ within which the force must
//!   decay or become constant. For two finite elastic bodies its result is flagged as unreliable;
//!   use the damped transform or time marching for them.
//! - A band limit causes ringing at jumps of the force; time marching smears them over one step.
//! - If elastic bodies separate without a force, as rods of the same section do, a jump within a
//!   step leaves spurious contacts of one step.
//! - The mobility of a body does not distinguish energy that remains as vibration from energy that
//!   has become heat.
//! - The error of a stick force on lines is computed up to the end of the first contact
//!   ([`StickUncertainty`]); the error of a force by time marching ([`Impact::with_errors`]) comes
//!   from random draws and covers all contacts.
//!
//! Theory: `docs/theory/stick-force.md`, `docs/theory/contact.md`,
//! `docs/theory/force-uncertainty.md`, `docs/theory/force-reconstruction.md`,
//! `docs/theory/hopkinson-bars.md`.

mod assembly;
mod balance;
mod band_limit;
mod body;
mod contact;
mod contact_impulse;
mod contact_law;
mod convolution;
mod error;
mod force_error;
mod fourier;
mod history;
pub mod hopkinson;
mod impact;
mod impedance_head;
mod interpolation;
mod kernel;
mod parallel;
mod reconstruct;
mod stick;
mod uncertainty;
mod unilateral;

pub use assembly::{
    Assembly, AtFace, Joint, MeasuredPoints, Point, SharedSubstructure, Substructure,
};
pub use balance::{Balance, EnergyHistory};
pub use band_limit::BandLimit;
pub use body::{
    Causality, DelayCheck, Domain, FrontLimit, ImpactBody, LineChange, LowFrequency, MassCheck,
    MeasuredBody, MobilityLaw, Passivity, Projection, Reciprocity, Screening, ScreeningFlag,
    WeighedMass, lines_of,
};
pub use contact::{ContactEnd, Graze, ImpactForce, separate};
pub use contact_impulse::ContactImpulse;
pub use contact_law::{ContactLaw, ElasticMaterial, TabulatedContact};
pub use error::ImpulseError;
pub use force_error::{Coverage, ForceBand, ForceError};
pub use history::{ForceHistory, ForcePeak};
pub use impact::{
    DiscreteImpact, DrawnImpact, FirstForce, Impact, ImpactDraws, ImpactErrors, ImpactNumbers,
    ImpactSource, LineBand, Pair, PeakForce, Prediction, PredictionFlag, SharedBody, Spread,
    UncertainImpact, UncertainPrediction,
};
pub use impedance_head::{FaceMobility, ImpedanceHead};
pub use kernel::{Kernel, Quadrature, TimeGrid};
pub use reconstruct::{
    BlowSpan, CalibrationBlow, CalibrationLines, CalibrationScatter, ChoiceVerdict,
    ChosenParameter, CurvePoint, ExcludedLine, ExclusionReason, FrequencyBand, NonNegativity,
    Parameter, Penalty, PivotingEnd, ProfileInterval, RandomErrorOfForce, ReconstructedForce,
    Reconstruction, Regularisation, ResponseEnd, ResponseNoise, Sensor, TimeInterval,
};
pub use stick::{Settlement, StickForce, StickProblem, ZeroLine};
pub use uncertainty::{EndError, EndVerdict, MonteCarlo, StickUncertainty, contact_band};
pub use unilateral::ContactInterval;

// Crates whose types appear in signatures, re-exported so that a dependent of this crate can use
// the matching version.
pub use {num_complex, rand, rodwave};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ExampleOfReadme;
