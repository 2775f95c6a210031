//! Complex modulus of a material from impacted rods: the linear inverse problem.
//!
//! # Problem
//! A slender rod of density ρ, length L and diameter D is struck at one end. Longitudinal waves
//! e^{iωt ∓ γx} travel back and forth in it, with the propagation coefficient γ = α + ik, and
//!
//! ```text
//! γ² = -ρω²/E(ω) ,    E = E' + iE''                                   (Ödeen 1993, paper A, eq. 2)
//! ```
//!
//! Given the motion of two sections as functions of frequency, the complex modulus E(ω) is sought.
//! E(ω) is one complex number per line. It is found from one complex equation per line, without any
//! assumption about the form of E(ω).
//!
//! # Method
//! The two-point method of paper A, [`TwoPoint`], uses the two ends of a rod. The accelerations of
//! the impacted end, â₁, and of the free end, â₂, give
//!
//! ```text
//! Ψ = â₁/â₂ = cosh γL + μ γL sinh γL ,    μ = m/(ρAL)                 (paper A, eq. 1)
//! ```
//!
//! with m the mass of the accelerometer at the free end. The equation has infinitely many roots γ.
//! For μ = 0 all roots are known in closed form. The right root is the one whose k is continuous
//! and increases from 0; it is inferred from all lines together ([`branch`]). From this root the
//! mass is increased in steps, and the root is followed ([`two_point`]). The variance of Ψ follows
//! from the coherence of several hits ([`TwoPoint::estimate_averaged`]). Each line has covariances
//! due to noise and due to the specimen ([`estimate`]), and a verdict ([`validity`]): a valid line
//! has E' within 1 % and the loss factor within 5 %, unless other limits are set.
//!
//! [`ThreePoint`] (paper B) evaluates three equidistant gauges on a member of a structure whose
//! ends are unknown. [`MultiPoint`] evaluates three or more gauges at any positions, by least
//! squares over one test or several. Each line also gives the two waves ([`multi_point`]).
//!
//! Further methods allow comparisons on the same rod: two sections and a free end ([`FreeEnd`]),
//! separate pulses ([`SeparatePulses`], [`OneGauge`]), resonances ([`Resonances`]). All methods
//! give the same kind of result ([`estimate`]). [`LateralInertia`] can be removed from it, and
//! [`checks`] detect wrong records without a reference.
//!
//! [`recovery`] treats paper C: the loss factor after a creep load, the model that explains it, and
//! the fit of its parameters.
//!
//! For use in other programs, a modulus is described by a law: [`rheology`] fits laws, determines
//! which of their parameters are identified, shifts moduli at several temperatures to a master
//! curve and writes material cards.
//!
//! # Example
//! Polypropylene rod of Test 6 of paper A. The accelerations of the rod with its accelerometer are
//! computed with transition matrices.
//!
//! ```
//! use cmod::estimate::BudgetedQuantity;
//! use cmod::two_point::SpecimenUncertainty;
//! use cmod::{Specimen, TwoPoint};
//! use rodwave::medium::Medium;
//! use rodwave::modulus::Zener;
//! use rodwave::transition::{State, TransitionMatrix};
//!
//! let specimen = Specimen { length: 0.799, diameter: 0.0158, density: 912.0, accelerometer_mass: 2.9e-3 };
//! let polypropylene = Medium::new(912.0, Zener::new(2.4e9, 2.8e9, 4e-5)?)?;
//! let frequency_hz: Vec<f64> = (1..=400).map(|j| 25.0 * f64::from(j)).collect();
//! let mut acceleration_ratio = Vec::new();
//! for f in &frequency_hz {
//!     let omega = 2.0 * std::f64::consts::PI * f;
//!     let rod = TransitionMatrix::uniform_rod(
//!         polypropylene.propagation_coefficient(omega),
//!         polypropylene.specific_characteristic_impedance(omega) * specimen.area(),
//!         specimen.length,
//!     )?;
//!     let accelerometer = TransitionMatrix::lumped_mass(specimen.accelerometer_mass, omega)?;
//!     let free_end = State { normal_force: 0.0.into(), velocity: 1.0.into() };
//!     let impacted_end = (accelerometer * rod).inverse().transfer(free_end);
//!     acceleration_ratio.push(impacted_end.velocity / free_end.velocity);
//! }
//! let variance = vec![1e-8; frequency_hz.len()]; // an error of 0.01 % for a ratio of 1
//!
//! let estimate = TwoPoint::new(specimen)?.estimate(&frequency_hz, &acceleration_ratio, &variance)?;
//! for line in estimate.valid() {
//!     let omega = 2.0 * std::f64::consts::PI * line.frequency_hz;
//!     let error = line.modulus - polypropylene.modulus(omega);
//!     assert!(error.norm() < 1e-6 * line.modulus.norm());
//! }
//! assert!(estimate.valid().count() > 350); // the rest is below 400 Hz: wavelength above 5 L
//!
//! // with the uncertainties of the specimen, each line has an expanded uncertainty
//! let errors = SpecimenUncertainty { length: 3e-4, density: 0.9, ..Default::default() };
//! let estimate = TwoPoint::new(specimen)?
//!     .with_specimen_uncertainty(errors)?
//!     .estimate(&frequency_hz, &acceleration_ratio, &variance)?;
//! for line in estimate.valid() {
//!     let expanded = line.expanded_uncertainty(BudgetedQuantity::StorageModulus, 0.95)?;
//!     println!("{} Hz: {:.4e} Pa ± {expanded:.1e} Pa", line.frequency_hz, line.modulus.re);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//! Time factor e^{+iωt}, forward transform with e^{-iωt}: E'' >= 0, α >= 0, k > 0 for ω > 0. SI
//! units. Spectra computed with the kernel e^{+iωt} must be conjugated first; otherwise the lines
//! fail with α < 0 and a doubtful branch.
//!
//! # Errata of paper A
//! - **Table 1**: the layout is lost in print. The integers s and n are derived anew, see
//!   [`branch`].
//! - **Equation 5**: Newton's iteration from γ₀L converges to a wrong root where the losses are low
//!   but the mass ratio is not. For a rod of PA6 with a fifth of its real loss, 800 mm long, with μ
//!   = 0.036 and no noise, the iteration does so on 294 of 1572 lines between 362 Hz and 20 kHz, 15
//!   of them undetected by conditions (i)-(iii). Continuation in μ finds no wrong root there, nor
//!   at 0.5 % and 2 % of noise, except for lines where noise brings two roots together, which are
//!   marked. Newton's iteration is kept as [`Solver::Newton`].
//! - **Equation 4**: correct, but the printed differences lose digits for low losses;
//!   [`branch::FreeEndRoot`] evaluates the same numbers without loss of digits.
//! - **Section 3**: noise in a₂ multiplies Ψ, as the ratio of cross-spectrum to auto-spectrum of
//!   a₂, by 1/(1 + noise/signal). The bias is in the ratio given to this crate, not in its
//!   evaluation; the coherence bounds it ([`two_point::variance_from_coherence`]).
//!
//! The errata of paper C are in [`recovery`].
//!
//! # Limits
//! - The crate computes no transforms, averages or coherence: the input is Ψ(ω) and its variance,
//!   or the spectra of gauges and their noise.
//! - The methods neglect lateral inertia: a bound on its effect is part of the common errors and is
//!   used to judge lines. [`lateral_inertia`] removes it from an estimate afterwards.
//! - The errors are propagated to first order. Where the second order matters, near kL = nπ at low
//!   losses and at low frequency, the line is marked, not corrected.
//! - Waves are counted only where a smooth wave number explains the lines. Lines on which they
//!   cannot be counted are marked; see [`branch`] for remedies.
//!
//! Theory: `docs/theory/two-point-method.md`, `docs/theory/branches.md`,
//! `docs/theory/multi-point-method.md`, `docs/theory/neighbouring-methods.md`,
//! `docs/theory/checks-without-truth.md`, `docs/theory/slenderness.md`,
//! `docs/theory/rheological-fits.md`, `docs/theory/creep-recovery.md`.

#[macro_use]
mod setters;

pub mod branch;
pub mod causal;
pub mod checks;
mod complex_frequency;
mod directions;
mod error;
pub mod estimate;
pub mod free_end;
pub mod free_vibration;
pub mod hit_trend;
pub mod lateral_inertia;
mod median;
pub mod multi_point;
pub mod one_gauge;
pub mod pulses;
pub mod recovery;
pub mod resonance;
pub mod rheology;
pub mod section_ratio;
pub mod self_calibration;
pub mod two_point;
mod uncertainty;
pub mod validity;
mod vectors;

pub use error::CmodError;
pub use estimate::{ModulusEstimate, ModulusLine};
pub use free_end::{EndSection, FreeEnd, RodWithFreeEnd};
pub use free_vibration::FreeVibration;
pub use lateral_inertia::LateralInertia;
pub use multi_point::{
    GaugeSpectra, GaugeUncertainty, GaugedRod, MultiPoint, MultiPointEstimate, ThreePoint,
};
pub use one_gauge::OneGauge;
pub use pulses::{PulsedRod, SeparatePulses};
pub use resonance::Resonances;
pub use section_ratio::{RatioMethod, RatioOfSpectra, SectionUncertainty};
pub use two_point::{Solver, Specimen, TwoPoint};

// These crates occur in public signatures; users of this crate find the matching versions here.
pub use {num_complex, rand, rodwave};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ExampleOfReadme;
