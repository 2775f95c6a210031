//! What the fit needs of a law: coordinates, and the modulus on all lines with its derivatives by them.

use num_complex::Complex64;
use rodwave::modulus::{
    DifferentiableModulus, FractionalZener, HavriliakNegami, KelvinVoigt, Zener,
};

use super::parameter::Scale;

/// A law with coordinates that may take any value.
pub(super) trait Model {
    fn kinds(&self) -> &[ParameterKind];

    /// Writes the moduli at `omega` and, by rows, their derivatives by the coordinates; false where there is no such law.
    fn evaluate(
        &self,
        at: &[f64],
        omega: &[f64],
        modulus: &mut [Complex64],
        gradient: &mut [Complex64],
    ) -> bool;
}

/// What a coordinate is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ParameterKind {
    pub(super) name: String,
    pub(super) unit: &'static str,
    pub(super) scale: Scale,
    /// Coordinate of the relaxation time that the parameter belongs to, if any.
    pub(super) relaxation_time: Option<usize>,
}

impl ParameterKind {
    pub(super) fn new(name: impl Into<String>, unit: &'static str, scale: Scale) -> Self {
        Self {
            name: name.into(),
            unit,
            scale,
            relaxation_time: None,
        }
    }

    pub(super) fn of_relaxation(mut self, index: usize) -> Self {
        self.relaxation_time = Some(index);
        self
    }
}

/// A law of `rodwave` whose exponents are given by coordinates without bounds.
#[derive(Debug, Clone)]
pub(super) struct Linked<L> {
    law: L,
    kinds: Vec<ParameterKind>,
    link: Link,
}

/// From coordinates to the parameters of the law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Link {
    /// All parameters are coordinates.
    Identity,
    /// The last parameter α is 1/(1 + e^{-u}).
    Exponent,
    /// The last two parameters α and β are such that α and αβ are 1/(1 + e^{-u}) of the coordinates.
    TwoExponents,
}

pub(super) fn logistic(coordinate: f64) -> f64 {
    (1.0 + (-coordinate).exp()).recip()
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

    /// The inverse of [`Self::parameters`].
    fn coordinates(self, mut parameters: Vec<f64>) -> Vec<f64> {
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

    /// Turns derivatives by parameters to derivatives by coordinates.
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

impl<L: DifferentiableModulus> Model for Linked<L> {
    fn kinds(&self) -> &[ParameterKind] {
        &self.kinds
    }

    fn evaluate(
        &self,
        at: &[f64],
        omega: &[f64],
        modulus: &mut [Complex64],
        gradient: &mut [Complex64],
    ) -> bool {
        let mut parameters = Vec::with_capacity(at.len());
        self.link.parameters(at, &mut parameters);
        let Ok(law) = self.law.with_parameters(&parameters) else {
            return false;
        };
        let rows = gradient.chunks_exact_mut(at.len());
        for ((omega, modulus), row) in omega.iter().zip(modulus).zip(rows) {
            *modulus = law.at(*omega);
            if law.gradient(*omega, row).is_err() {
                return false;
            }
            self.link.chain(&parameters, row);
        }
        true
    }
}

impl<L: DifferentiableModulus> Linked<L> {
    /// The law at the coordinates.
    pub(super) fn law_at(&self, at: &[f64]) -> Result<L, rodwave::RodwaveError> {
        let mut parameters = Vec::with_capacity(at.len());
        self.link.parameters(at, &mut parameters);
        self.law.with_parameters(&parameters)
    }

    /// The coordinates of a law.
    pub(super) fn coordinates_of(&self, law: &L) -> Vec<f64> {
        self.link.coordinates(law.parameters())
    }
}

/// Any law of the kind; only its type matters.
pub(super) fn kelvin_voigt() -> Result<Linked<KelvinVoigt>, rodwave::RodwaveError> {
    Ok(Linked {
        law: KelvinVoigt::new(1.0, 1.0)?,
        kinds: vec![
            ParameterKind::new("modulus", "Pa", Scale::Ratio),
            ParameterKind::new("viscosity", "Pa s", Scale::Ratio),
        ],
        link: Link::Identity,
    })
}

fn step_kinds() -> Vec<ParameterKind> {
    vec![
        ParameterKind::new("relaxed modulus", "Pa", Scale::Ratio),
        ParameterKind::new("modulus increment", "Pa", Scale::Ratio).of_relaxation(2),
        ParameterKind::new("relaxation time", "s", Scale::Ratio).of_relaxation(2),
    ]
}

pub(super) fn zener() -> Result<Linked<Zener>, rodwave::RodwaveError> {
    Ok(Linked {
        law: Zener::new(1.0, 2.0, 1.0)?,
        kinds: step_kinds(),
        link: Link::Identity,
    })
}

pub(super) fn fractional_zener() -> Result<Linked<FractionalZener>, rodwave::RodwaveError> {
    let mut kinds = step_kinds();
    kinds.push(ParameterKind::new("exponent", "1", Scale::LogOdds));
    Ok(Linked {
        law: FractionalZener::new(1.0, 2.0, 1.0, 0.5)?,
        kinds,
        link: Link::Exponent,
    })
}

pub(super) fn havriliak_negami() -> Result<Linked<HavriliakNegami>, rodwave::RodwaveError> {
    let mut kinds = step_kinds();
    kinds.push(ParameterKind::new(
        "low-frequency exponent",
        "1",
        Scale::LogOdds,
    ));
    kinds.push(ParameterKind::new(
        "high-frequency exponent",
        "1",
        Scale::LogOdds,
    ));
    Ok(Linked {
        law: HavriliakNegami::new(1.0, 2.0, 1.0, 0.5, 0.5)?,
        kinds,
        link: Link::TwoExponents,
    })
}

#[cfg(test)]
mod tests {
    use super::super::power_law::PowerLawModel;
    use super::super::prony::Prony;
    use super::*;

    /// Derivatives by differences of fourth order at three frequencies.
    fn check(model: &dyn Model, at: &[f64], omega: &[f64]) {
        let p = at.len();
        assert_eq!(model.kinds().len(), p);
        let evaluate = |at: &[f64]| {
            let mut modulus = vec![Complex64::ZERO; omega.len()];
            let mut gradient = vec![Complex64::ZERO; p * omega.len()];
            assert!(model.evaluate(at, omega, &mut modulus, &mut gradient));
            (modulus, gradient)
        };
        let (modulus, gradient) = evaluate(at);
        let h = 1e-4;
        for j in 0..p {
            let odd = |step: f64, line: usize| {
                let moved = |step: f64| {
                    let mut at = at.to_vec();
                    at[j] += step;
                    evaluate(&at).0[line]
                };
                moved(step) - moved(-step)
            };
            for line in 0..omega.len() {
                let difference = (8.0 * odd(h, line) - odd(2.0 * h, line)) / (12.0 * h);
                let error = (difference - gradient[line * p + j]).norm();
                // truncation h⁴/30 = 3e-18 times the fifth derivative, (2 ln ω)⁵ = 6e6 of a power law; rounding of e^21, 4e-15/h
                assert!(
                    error < 3e-10 * modulus[line].norm(),
                    "{} at {}: {difference} {}",
                    model.kinds()[j].name,
                    omega[line],
                    gradient[line * p + j]
                );
            }
        }
    }

    const OMEGA: [f64; 3] = [2e2, 5e3, 1e5];

    #[test]
    fn derivatives_of_closed_laws() {
        let step = [21.4, 20.1, -8.6];
        check(&kelvin_voigt().unwrap(), &[21.4, 10.2], &OMEGA);
        check(&zener().unwrap(), &step, &OMEGA);
        let with = |more: &[f64]| [step.as_slice(), more].concat();
        check(&fractional_zener().unwrap(), &with(&[0.3]), &OMEGA);
        check(&havriliak_negami().unwrap(), &with(&[0.3, -0.7]), &OMEGA);
        check(
            &PowerLawModel::new(1150.0),
            &[-9.3, 0.89, -7.0, 0.97],
            &OMEGA,
        );
    }

    #[test]
    fn derivatives_of_a_shifted_series() {
        let at = [21.4, 19.0, -9.0, 20.0, -7.0, 0.4, -1.1];
        let shifts = vec![None, Some(0), Some(1)];
        check(
            &Prony::shifted(true, 2, shifts, &[300.0, 310.0]),
            &at,
            &OMEGA,
        );
        check(&Prony::new(false, 2), &at[1..5], &OMEGA);
    }

    /// At half of the maximum of the log-odds both exponents are away from their ends.
    #[test]
    fn coordinates_of_two_exponents_are_those_of_the_law() {
        use rodwave::modulus::ComplexModulus;
        let (alpha, product): (f64, f64) = (0.7, 0.35);
        let log_odds = |p: f64| (p / (1.0 - p)).ln();
        let at = [21.0, 20.0, -8.0, log_odds(alpha), log_odds(product)];
        let law = havriliak_negami().unwrap().law_at(&at).unwrap();
        let e0 = 21.0_f64.exp();
        let direct = HavriliakNegami::new(
            e0,
            e0 + 20.0_f64.exp(),
            (-8.0_f64).exp(),
            alpha,
            product / alpha,
        );
        let error = law.at(4e3) - direct.unwrap().at(4e3);
        // rounding of exponentials of 21
        assert!(error.norm() < 1e-13 * law.at(4e3).norm());
    }
}
