//! Shear and bulk relaxation of an isotropic solid from the relaxation of a rod.

use rodwave::modulus::GeneralisedMaxwell;

use super::BulkBehaviour;
use crate::error::{CmodError, check_not_negative, check_positive, check_that};

/// Relaxation of an isotropic solid: G(t) = G(0) - Σ Gᵢ (1 - e^{-t/τᵢ}), and K(t) in the same form.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Isotropic {
    pub(super) instantaneous_shear: f64,
    pub(super) instantaneous_bulk: f64,
    pub(super) terms: Vec<Term>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Term {
    pub(super) shear: f64,
    pub(super) bulk: f64,
    pub(super) relaxation_time: f64,
}

/// Returns Young's modulus \[Pa\] and Poisson's ratio of a solid with the given shear and bulk
/// modulus \[Pa\].
pub(super) fn young_and_poisson(shear: f64, bulk: f64) -> (f64, f64) {
    (
        9.0 * bulk * shear / (3.0 * bulk + shear),
        0.5 * (3.0 * bulk - 2.0 * shear) / (3.0 * bulk + shear),
    )
}

impl Isotropic {
    /// Creates the solid with the instantaneous `poisson_ratio`.
    pub(super) fn of(
        law: &GeneralisedMaxwell,
        poisson_ratio: f64,
        behaviour: BulkBehaviour,
    ) -> Result<Self, CmodError> {
        let young = law.unrelaxed_modulus();
        let instantaneous_shear = 0.5 * young / (1.0 + poisson_ratio);
        let instantaneous_bulk = young / (3.0 * (1.0 - 2.0 * poisson_ratio));
        let terms = match behaviour {
            BulkBehaviour::ConstantPoissonRatio => law
                .branches()
                .iter()
                .map(|branch| Term {
                    shear: instantaneous_shear * branch.modulus / young,
                    bulk: instantaneous_bulk * branch.modulus / young,
                    relaxation_time: branch.relaxation_time,
                })
                .collect(),
            BulkBehaviour::Elastic => shear_terms(law, instantaneous_bulk)?,
        };
        let solid = Self {
            instantaneous_shear,
            instantaneous_bulk,
            terms,
        };
        check_positive("instantaneous shear modulus [Pa]", instantaneous_shear)?;
        // the products of two moduli in a card must be finite
        check_positive(
            "square of the instantaneous bulk modulus [Pa^2]",
            instantaneous_bulk * instantaneous_bulk,
        )?;
        for term in &solid.terms {
            check_not_negative("shear modulus of a term [Pa]", term.shear)?;
            check_not_negative("bulk modulus of a term [Pa]", term.bulk)?;
            check_positive("relaxation time of a term [s]", term.relaxation_time)?;
            check_positive("rate of a term [1/s]", term.relaxation_time.recip())?;
        }
        Ok(solid)
    }

    pub(super) fn long_term_shear(&self) -> f64 {
        self.instantaneous_shear - self.terms.iter().map(|term| term.shear).sum::<f64>()
    }

    pub(super) fn long_term_bulk(&self) -> f64 {
        self.instantaneous_bulk - self.terms.iter().map(|term| term.bulk).sum::<f64>()
    }
}

/// Returns the branches of G = 3KE/(9K - E) with K constant.
///
/// At s = -x, E = E∞ + Σ Eᵢ x/(x - λᵢ), λᵢ = 1/τᵢ, decreases from +∞ to -∞ between two neighbouring
/// λᵢ, and from +∞ to E(∞) < 9K above the last λᵢ. Therefore E = 9K has one root μ in each
/// interval. At x = μ, G has a pole, whose branch has the modulus Gμ = 27K²/(μ E'(s)). This modulus
/// is positive because E'(s) = Σ Eᵢλᵢ/(s + λᵢ)² is positive.
fn shear_terms(law: &GeneralisedMaxwell, bulk: f64) -> Result<Vec<Term>, CmodError> {
    let mut rates: Vec<(f64, f64)> = law
        .branches()
        .iter()
        .map(|branch| (branch.relaxation_time.recip(), branch.modulus))
        .collect();
    rates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let young = |x: f64| {
        law.equilibrium_modulus()
            + rates
                .iter()
                .map(|(rate, modulus)| modulus * x / (x - rate))
                .sum::<f64>()
    };
    let mut terms = Vec::with_capacity(rates.len());
    for (place, (rate, _)) in rates.iter().enumerate() {
        let mut low = *rate;
        let mut high = match rates.get(place + 1) {
            Some((next, _)) => *next,
            None => {
                let mut beyond = 2.0 * rate;
                while young(beyond) > 9.0 * bulk {
                    beyond *= 2.0;
                }
                beyond
            }
        };
        // bisect until the two bounds are neighbouring floating-point numbers
        loop {
            let middle = 0.5 * (low + high);
            if !(middle > low && middle < high) {
                break;
            }
            if young(middle) > 9.0 * bulk {
                low = middle;
            } else {
                high = middle;
            }
        }
        let slope: f64 = rates
            .iter()
            .map(|(rate, modulus)| modulus * rate / (rate - high).powi(2))
            .sum();
        let shear = 27.0 * bulk * bulk / (high * slope);
        let is_right = shear.is_finite() && shear > 0.0;
        let expected = "a finite value above 0: relaxation times must differ";
        check_that(is_right, "shear modulus of a branch [Pa]", shear, expected)?;
        terms.push(Term {
            shear,
            bulk: 0.0,
            relaxation_time: high.recip(),
        });
    }
    terms.sort_by(|a, b| a.relaxation_time.total_cmp(&b.relaxation_time));
    Ok(terms)
}
