//! Interface of a law to the fit: coordinates, and the modulus on all lines with its derivatives
//! with respect to the coordinates.

use num_complex::Complex64;

use super::parameter::Scale;
use super::transient::Lines;

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

    /// Returns the free coordinates of the point that was given.
    pub(super) fn start(&self) -> Vec<f64> {
        let of = |index: &usize| self.at.get(*index).copied();
        self.free.iter().filter_map(of).collect()
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

#[cfg(test)]
mod tests {
    use super::super::law::Law;
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
                // tolerance: the truncation error is h⁴/30 = 3e-18 times the fifth derivative, (2
                // ln ω)⁵ = 6e6 for a power law; the rounding error of e^21 is 4e-15/h
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

    /// Coordinates of a law with its relaxation in the band of [`OMEGA`].
    fn coordinates(kinds: &[ParameterKind]) -> Vec<f64> {
        let at = kinds.iter().enumerate().map(|(j, kind)| {
            let place = j as f64;
            match (kind.unit, kind.scale) {
                ("Pa", _) => 21.4 - 1.3 * place,
                ("Pa s", _) => 10.2,
                ("s", _) => -8.6,
                ("s^p/m", _) => -9.3,
                ("s^q/m", _) => -7.0,
                (_, Scale::Ratio) => -2.3,
                (_, Scale::LogOdds) => 0.3 - (place - 3.0),
                (_, Scale::Difference) => 0.85 + 0.04 * place,
            }
        });
        at.collect()
    }

    #[test]
    fn derivatives_of_every_law() {
        for law in Law::all(1150.0) {
            // 5 coordinates for a series of two branches and a spring; the other laws have a fixed
            // number of coordinates
            let model = law.model(5, Some(3e3)).unwrap();
            check(&*model, &coordinates(model.kinds()), &OMEGA);
        }
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
        use rodwave::modulus::{ComplexModulus, HavriliakNegami};
        let (alpha, product): (f64, f64) = (0.7, 0.35);
        let log_odds = |p: f64| (p / (1.0 - p)).ln();
        let at = [21.0, 20.0, -8.0, log_odds(alpha), log_odds(product)];
        let found = Law::HavriliakNegami.at_coordinates(&at, None).unwrap();
        let e0 = 21.0_f64.exp();
        let direct = HavriliakNegami::new(
            e0,
            e0 + 20.0_f64.exp(),
            (-8.0_f64).exp(),
            alpha,
            product / alpha,
        );
        let (found, direct) = (found.modulus(4e3), direct.unwrap().at(4e3));
        // the tolerance covers the rounding of e^21
        assert!((found - direct).norm() < 1e-13 * direct.norm());
    }
}
