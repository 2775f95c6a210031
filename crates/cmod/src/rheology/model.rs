//! Interface of a law to the fit: coordinates, and the modulus on all lines with its derivatives
//! with respect to the coordinates.

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::modulus::{
    ConstantQ, DifferentiableModulus, Elastic, FractionalMaxwell, FractionalZener, HavriliakNegami,
    KelvinVoigt, Maxwell, SpringPot, Zener,
};

use super::parameter::{Scale, logistic};
use super::transient::{Lines, respond};

/// Law with coordinates that may take any value.
pub(super) trait Model {
    fn kinds(&self) -> &[ParameterKind];

    /// Returns true if the parameters are in the order of their names. A law with interchanged
    /// branches is the same law, so only one order is accepted.
    fn is_in_order(&self, _at: &[f64]) -> bool {
        true
    }

    /// Writes the moduli at `lines` and, by rows, their derivatives with respect to the
    /// coordinates; returns false if there is no law at these coordinates.
    fn evaluate(
        &self,
        at: &[f64],
        lines: Lines<'_>,
        modulus: &mut [Complex64],
        gradient: &mut [Complex64],
    ) -> bool;
}

/// Description of a coordinate and its parameter.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ParameterKind {
    pub(super) name: String,
    pub(super) unit: &'static str,
    pub(super) scale: Scale,
    /// Index of the coordinate of the relaxation time to which the parameter belongs, if there is
    /// one.
    pub(super) relaxation_time: Option<usize>,
    /// Loss that the parameter describes, if there is one.
    pub(super) loss: Option<Loss>,
}

/// Loss that vanishes if a coordinate goes to an end of its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Loss {
    /// Index of the coordinate.
    pub(super) coordinate: usize,
    /// Sign of the direction in which the loss vanishes.
    pub(super) vanishes_towards: f64,
}

impl ParameterKind {
    pub(super) fn new(name: impl Into<String>, unit: &'static str, scale: Scale) -> Self {
        Self {
            name: name.into(),
            unit,
            scale,
            relaxation_time: None,
            loss: None,
        }
    }

    /// Marks the parameter as describing a loss that vanishes if `coordinate` goes to -∞.
    pub(super) fn of_loss(self, coordinate: usize) -> Self {
        self.of_loss_towards(coordinate, -1.0)
    }

    /// Marks the parameter as describing a loss that vanishes if `coordinate` goes to ∞ (1) or to
    /// -∞ (-1).
    pub(super) fn of_loss_towards(mut self, coordinate: usize, vanishes_towards: f64) -> Self {
        self.loss = Some(Loss {
            coordinate,
            vanishes_towards,
        });
        self
    }

    pub(super) fn of_relaxation(mut self, index: usize) -> Self {
        self.relaxation_time = Some(index);
        self
    }
}

/// Model of which only some coordinates are free.
pub(super) struct Partial<'a, M> {
    whole: &'a M,
    /// Coordinates of the whole model; those that are not free keep these values.
    at: Vec<f64>,
    free: Vec<usize>,
    kinds: Vec<ParameterKind>,
}

impl<'a, M: Model> Partial<'a, M> {
    /// Creates the model; `at` has one entry per coordinate of `whole`, and `free` lists the
    /// indices of the free coordinates.
    pub(super) fn new(whole: &'a M, at: Vec<f64>, free: Vec<usize>) -> Self {
        let of = |index: &usize| {
            let kind = whole.kinds().get(*index)?;
            let place = |whole: usize| free.iter().position(|own| *own == whole);
            let loss = kind.loss.and_then(|loss| {
                let coordinate = place(loss.coordinate)?;
                Some(Loss { coordinate, ..loss })
            });
            Some(ParameterKind {
                relaxation_time: kind.relaxation_time.and_then(place),
                loss,
                ..kind.clone()
            })
        };
        Self {
            kinds: free.iter().filter_map(of).collect(),
            whole,
            at,
            free,
        }
    }

    /// Returns all coordinates of the whole model.
    pub(super) fn whole_at(&self, free: &[f64]) -> Vec<f64> {
        let mut at = self.at.clone();
        for (index, value) in self.free.iter().zip(free) {
            if let Some(own) = at.get_mut(*index) {
                *own = *value;
            }
        }
        at
    }
}

impl<M: Model> Model for Partial<'_, M> {
    fn kinds(&self) -> &[ParameterKind] {
        &self.kinds
    }

    fn is_in_order(&self, at: &[f64]) -> bool {
        self.whole.is_in_order(&self.whole_at(at))
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "a row has one element for each coordinate of the whole model, and `free` contains indices of coordinates"
    )]
    fn evaluate(
        &self,
        at: &[f64],
        lines: Lines<'_>,
        modulus: &mut [Complex64],
        gradient: &mut [Complex64],
    ) -> bool {
        let whole_at = self.whole_at(at);
        let mut rows = vec![Complex64::ZERO; whole_at.len() * lines.len()];
        if !self.whole.evaluate(&whole_at, lines, modulus, &mut rows) {
            return false;
        }
        let rows = rows.chunks_exact(whole_at.len());
        for (own, row) in gradient.chunks_exact_mut(at.len()).zip(rows) {
            for (entry, index) in own.iter_mut().zip(&self.free) {
                *entry = row[*index];
            }
        }
        true
    }
}

/// Law of `rodwave` as a model, with coordinates without bounds for its exponents.
#[derive(Debug, Clone)]
pub(super) struct Linked<L> {
    law: L,
    kinds: Vec<ParameterKind>,
    link: Link,
}

/// Mapping from coordinates to the parameters of the law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Link {
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

impl<L: DifferentiableModulus> Model for Linked<L> {
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
        self.link.parameters(at, &mut parameters);
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
            self.link.chain(&parameters, row);
        }
        true
    }
}

impl<L: DifferentiableModulus> Linked<L> {
    /// Creates a model of this type of law; only the type is used, not the parameters.
    fn new(
        law: Result<L, RodwaveError>,
        kinds: Vec<ParameterKind>,
        link: Link,
    ) -> Result<Self, RodwaveError> {
        let law = law?;
        Ok(Self { law, kinds, link })
    }

    /// Returns the law at the coordinates `at`.
    pub(super) fn law_at(&self, at: &[f64]) -> Result<L, RodwaveError> {
        let mut parameters = Vec::with_capacity(at.len());
        self.link.parameters(at, &mut parameters);
        self.law.with_parameters(&parameters)
    }

    /// Returns the coordinates of a law.
    pub(super) fn coordinates_of(&self, law: &L) -> Vec<f64> {
        self.link.coordinates(law.parameters())
    }
}

pub(super) fn kelvin_voigt() -> Result<Linked<KelvinVoigt>, RodwaveError> {
    Linked::new(
        KelvinVoigt::new(1.0, 1.0),
        vec![
            ParameterKind::new("modulus", "Pa", Scale::Ratio),
            ParameterKind::new("viscosity", "Pa s", Scale::Ratio).of_loss(1),
        ],
        Link::Identity,
    )
}

pub(super) fn elastic() -> Result<Linked<Elastic>, RodwaveError> {
    Linked::new(
        Elastic::new(1.0),
        vec![ParameterKind::new("modulus", "Pa", Scale::Ratio)],
        Link::Identity,
    )
}

/// Returns the model of constant Q with |E| at the angular frequency `reference` and the loss
/// factor.
pub(super) fn constant_q(reference: f64) -> Result<Linked<ConstantQ>, RodwaveError> {
    Linked::new(
        ConstantQ::new(1.0, 0.1, reference),
        vec![
            ParameterKind::new("modulus in the middle of the band", "Pa", Scale::Ratio),
            ParameterKind::new("loss factor", "1", Scale::Ratio).of_loss(1),
        ],
        Link::Identity,
    )
}

/// Returns the model of the spring-pot with |E| at the angular frequency `reference` and the
/// exponent.
pub(super) fn spring_pot(reference: f64) -> Result<Linked<SpringPot>, RodwaveError> {
    Linked::new(
        SpringPot::new(1.0, 0.5, reference),
        vec![
            ParameterKind::new("modulus in the middle of the band", "Pa", Scale::Ratio),
            ParameterKind::new("exponent", "1", Scale::LogOdds).of_loss(1),
        ],
        Link::Exponent,
    )
}

fn fluid_kinds() -> Vec<ParameterKind> {
    vec![
        ParameterKind::new("unrelaxed modulus", "Pa", Scale::Ratio),
        ParameterKind::new("relaxation time", "s", Scale::Ratio)
            .of_relaxation(1)
            .of_loss_towards(1, 1.0),
    ]
}

pub(super) fn maxwell() -> Result<Linked<Maxwell>, RodwaveError> {
    Linked::new(Maxwell::new(1.0, 1.0), fluid_kinds(), Link::Identity)
}

pub(super) fn fractional_maxwell() -> Result<Linked<FractionalMaxwell>, RodwaveError> {
    let mut kinds = fluid_kinds();
    kinds.push(ParameterKind::new("exponent", "1", Scale::LogOdds).of_loss_towards(1, 1.0));
    Linked::new(FractionalMaxwell::new(1.0, 1.0, 0.5), kinds, Link::Exponent)
}

fn step_kinds() -> Vec<ParameterKind> {
    vec![
        ParameterKind::new("relaxed modulus", "Pa", Scale::Ratio),
        ParameterKind::new("modulus increment", "Pa", Scale::Ratio)
            .of_relaxation(2)
            .of_loss(1),
        ParameterKind::new("relaxation time", "s", Scale::Ratio)
            .of_relaxation(2)
            .of_loss(1),
    ]
}

pub(super) fn zener() -> Result<Linked<Zener>, RodwaveError> {
    Linked::new(Zener::new(1.0, 2.0, 1.0), step_kinds(), Link::Identity)
}

pub(super) fn fractional_zener() -> Result<Linked<FractionalZener>, RodwaveError> {
    let mut kinds = step_kinds();
    kinds.push(ParameterKind::new("exponent", "1", Scale::LogOdds).of_loss(1));
    Linked::new(
        FractionalZener::new(1.0, 2.0, 1.0, 0.5),
        kinds,
        Link::Exponent,
    )
}

pub(super) fn havriliak_negami() -> Result<Linked<HavriliakNegami>, RodwaveError> {
    let mut kinds = step_kinds();
    for name in ["low-frequency exponent", "high-frequency exponent"] {
        kinds.push(ParameterKind::new(name, "1", Scale::LogOdds).of_loss(1));
    }
    Linked::new(
        HavriliakNegami::new(1.0, 2.0, 1.0, 0.5, 0.5),
        kinds,
        Link::TwoExponents,
    )
}

#[cfg(test)]
mod tests {
    use super::super::power_law::PowerLawModel;
    use super::super::prony::Prony;
    use super::*;

    /// Compares the derivatives with finite differences of fourth order at the frequencies `omega`.
    fn check(model: &dyn Model, at: &[f64], omega: &[f64]) {
        let p = at.len();
        assert_eq!(model.kinds().len(), p);
        let evaluate = |at: &[f64]| {
            let mut modulus = vec![Complex64::ZERO; omega.len()];
            let mut gradient = vec![Complex64::ZERO; p * omega.len()];
            let lines = Lines::oscillating(omega);
            assert!(model.evaluate(at, lines, &mut modulus, &mut gradient));
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
                // the truncation error is h⁴/30 = 3e-18 times the fifth derivative, (2 ln ω)⁵ = 6e6
                // for a power law; the rounding error of e^21 is 4e-15/h
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
        check(&elastic().unwrap(), &[21.4], &OMEGA);
        check(&constant_q(3e3).unwrap(), &[21.4, -2.3], &OMEGA);
        check(&spring_pot(3e3).unwrap(), &[21.4, -2.3], &OMEGA);
        check(&maxwell().unwrap(), &[21.4, -8.6], &OMEGA);
        check(&fractional_maxwell().unwrap(), &[21.4, -8.6, 0.3], &OMEGA);
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
        let shifted = Prony::shifted(true, 2, shifts, &[300.0, 310.0]);
        check(&shifted, &at, &OMEGA);
        let with_factor = shifted.with_factors(vec![None, Some(0), None], &[300.0]);
        let at = [&at[..5], &[0.2], &at[5..]].concat();
        check(&with_factor, &at, &OMEGA);
        let at = &at[..5];
        check(&Prony::new(false, 2), &at[1..], &OMEGA);
    }

    /// Compares the law at its coordinates with the law itself, for two exponents away from their
    /// limits.
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
        // the tolerance covers the rounding of e^21
        assert!(error.norm() < 1e-13 * law.at(4e3).norm());
    }
}
