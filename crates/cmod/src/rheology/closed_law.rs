//! Models of the laws of `rodwave`, whose exponents get coordinates without bounds.

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::modulus::DifferentiableModulus;

use super::data::ModulusData;
use super::model::{Model, ParameterKind};
use super::parameter::logistic;
use super::transient::{Lines, respond};
use crate::error::CmodError;

/// Law of `rodwave` that can be fitted: its coordinates and starting points.
pub(super) trait ClosedLaw: DifferentiableModulus + Sized {
    /// Mapping from coordinates to the parameters of the law.
    const LINK: Link = Link::Identity;

    /// Returns a law of this type with arbitrary parameters. The reference frequency of a law that
    /// has one is `reference_omega`.
    fn any(reference_omega: Option<f64>) -> Result<Self, CmodError>;

    /// Describes the coordinates.
    fn kinds() -> Vec<ParameterKind>;

    /// Returns coordinates to start from.
    fn starts(data: &ModulusData) -> Vec<Vec<f64>>;

    /// Returns coordinates at limits of the law, near which profiles look for lower minima.
    fn limits(_data: &ModulusData) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// Returns the angular frequency [rad/s] to which the parameters refer, if there is one.
    fn reference(&self) -> Option<f64> {
        None
    }
}

/// Model of a law, with coordinates without bounds for its exponents.
#[derive(Debug, Clone)]
pub(super) struct Linked<L> {
    law: L,
    kinds: Vec<ParameterKind>,
}

/// Mapping from coordinates to the parameters of the law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Link {
    /// All parameters are coordinates.
    Identity,
    /// The last parameter α is 1/(1 + e^{-u}).
    Exponent,
    /// The last two parameters are α and β. Both α and αβ are 1/(1 + e^{-u}) of their coordinates
    /// u.
    TwoExponents,
}

impl Link {
    fn parameters(self, at: &[f64], parameters: &mut Vec<f64>) {
        parameters.clear();
        parameters.extend_from_slice(at);
        match (self, parameters.as_mut_slice()) {
            (Self::Exponent, [.., alpha]) => *alpha = logistic(*alpha),
            (Self::TwoExponents, [.., alpha, beta]) => {
                *alpha = logistic(*alpha);
                *beta = logistic(*beta) / *alpha;
            }
            _ => {}
        }
    }

    /// Inverts [`Self::parameters`].
    pub(super) fn coordinates(self, mut parameters: Vec<f64>) -> Vec<f64> {
        let log_odds = |p: f64| (p / (1.0 - p)).ln();
        match (self, parameters.as_mut_slice()) {
            (Self::Exponent, [.., alpha]) => *alpha = log_odds(*alpha),
            (Self::TwoExponents, [.., alpha, beta]) => {
                *beta = log_odds(*alpha * *beta);
                *alpha = log_odds(*alpha);
            }
            _ => {}
        }
        parameters
    }

    /// Converts derivatives with respect to parameters to derivatives with respect to coordinates.
    fn chain(self, parameters: &[f64], row: &mut [Complex64]) {
        match (self, parameters, row) {
            (Self::Exponent, [.., alpha], [.., by_alpha]) => *by_alpha *= alpha * (1.0 - alpha),
            (Self::TwoExponents, [.., alpha, beta], [.., by_alpha, by_beta]) => {
                // β = γ/α with γ = αβ: dα = α(1-α) du, dβ = -β(1-α) du + β(1-γ) dv
                *by_alpha = (*by_alpha * alpha - *by_beta * beta) * (1.0 - alpha);
                *by_beta *= beta * (1.0 - alpha * beta);
            }
            _ => {}
        }
    }
}

impl<L: ClosedLaw> Model for Linked<L> {
    fn kinds(&self) -> &[ParameterKind] {
        &self.kinds
    }

    fn evaluate(
        &self,
        at: &[f64],
        lines: Lines<'_>,
        modulus: &mut [Complex64],
        gradient: &mut [Complex64],
    ) -> bool {
        let mut parameters = Vec::with_capacity(at.len());
        L::LINK.parameters(at, &mut parameters);
        let Ok(law) = self.law.with_parameters(&parameters) else {
            return false;
        };
        let rows = gradient.chunks_exact_mut(at.len());
        let mut scratch = vec![Complex64::ZERO; at.len()];
        let at_s = |s, row: &mut [Complex64]| law.gradient_at_s(s, row).ok();
        for ((line, modulus), row) in lines.iter().zip(modulus).zip(rows) {
            let Some(found) = respond(line, row, &mut scratch, at_s) else {
                return false;
            };
            *modulus = found;
            L::LINK.chain(&parameters, row);
        }
        true
    }
}

impl<L: ClosedLaw> Linked<L> {
    /// Creates the model; `reference_omega` [rad/s] is needed by laws that refer to a frequency.
    pub(super) fn new(reference_omega: Option<f64>) -> Result<Self, CmodError> {
        Ok(Self {
            law: L::any(reference_omega)?,
            kinds: L::kinds(),
        })
    }

    /// Returns the law at the coordinates `at`.
    pub(super) fn law_at(&self, at: &[f64]) -> Result<L, RodwaveError> {
        let mut parameters = Vec::with_capacity(at.len());
        L::LINK.parameters(at, &mut parameters);
        self.law.with_parameters(&parameters)
    }
}
