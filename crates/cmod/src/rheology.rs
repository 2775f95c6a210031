//! Laws of viscoelasticity fitted to a complex modulus.
//!
//! # Problem
//! A measurement gives a complex modulus per line with the covariance of its random error, and, for
//! each source of a common error, a vector with one entry per line ([`ModulusData`]). Material
//! models of simulation programs need a law with a few parameters. This module finds the law, its
//! parameters and their identifiability.
//!
//! # Method
//! χ² = Σ δᵀC⁻¹δ is minimised, where δ is (Re, Im) of the law minus the measured modulus and C is
//! the covariance of the random error of the line. [`RheologicalFit`] does this for a law with a
//! fixed number of parameters, [`PronyFit`] for a generalised Maxwell model of unknown order, and
//! [`Comparison`] for several laws. Each parameter has an error, an interval, and a [`Verdict`]
//! with the [`Reason`] if the data do not determine it. χ² and the [`Whiteness`] of the residuals
//! test whether the law describes the material.
//!
//! Moduli at several temperatures are shifted to one [`MasterCurve`], and the shifts are fitted by
//! [`ShiftLaws`]. The resulting series is written as a [`card`] of a finite-element program; any
//! fitted law with its errors is a [`MeasuredLaw`].
//!
//! # Example
//! The data are moduli of a fractional Zener model with deviations of some tenths of a per cent.
//! The comparison selects the fractional Zener model; the residuals of Zener's model are not white.
//!
//! ```
//! use cmod::rheology::{Comparison, FitOptions, Law, ModulusData, ModulusPoint};
//! use num_complex::Complex64;
//! use rodwave::modulus::{ComplexModulus, FractionalZener};
//!
//! let material = FractionalZener::new(1.8e9, 3.4e9, 4e-5, 0.45)?;
//! let points: Vec<ModulusPoint> = (0..40)
//!     .map(|j| {
//!         let frequency_hz = 100.0 * 1.12_f64.powi(j);
//!         let modulus = material.at(2.0 * std::f64::consts::PI * frequency_hz);
//!         let error = 5e6 * Complex64::from_polar(1.0, 2.4 * f64::from(j * j)); // stands for noise
//!         ModulusPoint::circular(frequency_hz, modulus + error, 5e6)
//!     })
//!     .collect();
//! let data = ModulusData::new(&points)?;
//!
//! let laws = [Law::Zener, Law::FractionalZener, Law::GeneralisedMaxwell];
//! let comparison = Comparison::new(&data, &laws, &FitOptions::default())?;
//! let best = comparison.best().ok_or("three laws were fitted")?;
//! assert_eq!(best.law.law(), Law::FractionalZener);
//! let exponent = best.parameter("exponent").ok_or("a parameter of this law")?;
//! assert!(exponent.verdict.is_identified() && exponent.interval.contains(0.45));
//!
//! let zener = &comparison.rows[2].fit;
//! assert!(zener.law.law() == Law::Zener && !zener.whiteness.is_white(0.01));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//! - The random errors of the lines are assumed to be independent of each other. Common errors,
//!   such as an error of the density, are propagated to the parameters to first order; they do not
//!   change the fitted parameters.
//! - A change of temperature is assumed only to shift the law. A material whose law has another
//!   form at another temperature has no master curve; χ² detects this.
//! - No continuous relaxation spectrum is determined, because this is an ill-posed problem; the
//!   data support a Prony series with few branches.
//!
//! Theory: `docs/theory/rheological-fits.md`.

pub mod card;
mod closed_law;
mod comparison;
mod data;
mod explained;
mod fit;
mod fitted_law;
mod fitting;
mod information;
mod judgement;
mod law;
mod least_squares;
mod master_curve;
mod measured_law;
mod model;
pub(crate) mod non_negative;
mod order;
mod over_time;
mod overlap;
mod parameter;
mod polar_scatter;
mod power_law;
mod profile;
mod prony;
mod shift_law;
mod start;
mod support;
mod sweep;
pub(crate) mod symmetric;
mod transient;
mod whiteness;

pub use comparison::{Comparison, ComparisonRow};
pub(crate) use data::VarianceScatter;
pub use data::{CommonError, ModulusData, ModulusPoint};
pub use fit::{Criterion, ErrorScale, FitOptions, PredictedModulus, RheologicalFit};
pub use law::{FittedLaw, Law};
pub use least_squares::Ending;
pub use master_curve::{FactorChoice, MasterCurve, MasterPoint, ReferenceDeparture, Shift};
pub use measured_law::{LawError, MeasuredLaw};
pub use order::{Order, PronyFit};
pub use over_time::{TransientPoint, TransientTest};
pub use parameter::{
    CommonShift, Interval, IntervalMethod, LINEAR_BELOW, Parameter, Reason, Scale, Verdict, WIDEST,
};
pub use polar_scatter::PolarScatter;
pub use power_law::PowerLaw;
pub use shift_law::{Arrhenius, GAS_CONSTANT, ShiftLaws, Wlf};
pub use sweep::TemperatureSweep;
pub use whiteness::Whiteness;

/// Returns the intercept and the slope of the straight line fitted to points; `None` for fewer than
/// two different abscissas.
fn straight_line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let n = count(points.len());
    let x: f64 = points.iter().map(|(x, _)| x / n).sum();
    let y: f64 = points.iter().map(|(_, y)| y / n).sum();
    let xx: f64 = points.iter().map(|(px, _)| (px - x).powi(2)).sum();
    let xy: f64 = points.iter().map(|(px, py)| (px - x) * (py - y)).sum();
    (points.len() >= 2 && xx > 0.0).then(|| (y - x * xy / xx, xy / xx))
}

/// Converts a number of items to a floating-point number.
fn count(number: usize) -> f64 {
    number as f64
}
