//! Draws of quantities stated with ±: bodies, their materials and the contact.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::impact_sheet::ContactSheet;
use crate::RodlabError;
use crate::bodies::replacement::Replacement;
use crate::sheet::{Kind, Stated, Written};

/// Gaussian draws of stated quantities, each with its own standard uncertainty; exact quantities
/// are kept.
pub(super) struct Draws<'r> {
    pub(super) random: &'r mut ChaCha8Rng,
    /// Number of drawn quantities with an uncertainty.
    pub(super) n_drawn: usize,
}

impl<'r> Draws<'r> {
    pub(super) fn by(random: &'r mut ChaCha8Rng) -> Self {
        Self { random, n_drawn: 0 }
    }

    pub(super) fn contact(&mut self, contact: &ContactSheet) -> Result<ContactSheet, RodlabError> {
        let field = "problem.contact";
        Ok(match contact {
            ContactSheet::Rigid => ContactSheet::Rigid,
            ContactSheet::Linear(stiffness) => ContactSheet::Linear(self.stated(stiffness, field)?),
            ContactSheet::FlatPunch {
                radius,
                modulus,
                poisson_ratio,
            } => ContactSheet::FlatPunch {
                radius: self.stated(radius, field)?,
                modulus: self.stated(modulus, field)?,
                poisson_ratio: self.stated(poisson_ratio, field)?,
            },
            ContactSheet::Sphere {
                radius,
                moduli,
                poisson_ratios,
            } => ContactSheet::Sphere {
                radius: self.stated(radius, field)?,
                moduli: (
                    self.stated(&moduli.0, field)?,
                    self.stated(&moduli.1, field)?,
                ),
                poisson_ratios: (
                    self.stated(&poisson_ratios.0, field)?,
                    self.stated(&poisson_ratios.1, field)?,
                ),
            },
            ContactSheet::Table(points) => ContactSheet::Table(
                points
                    .iter()
                    .map(|(approach, force)| {
                        Ok((self.stated(approach, field)?, self.stated(force, field)?))
                    })
                    .collect::<Result<_, RodlabError>>()?,
            ),
        })
    }
}

impl Replacement for Draws<'_> {
    fn standard(&mut self, _source: &str) -> Result<f64, RodlabError> {
        self.n_drawn += 1;
        Ok(self.random.sample(StandardNormal))
    }

    fn stated<K: Kind>(
        &mut self,
        stated: &Stated<K>,
        field: &str,
    ) -> Result<Stated<K>, RodlabError> {
        let uncertainty = stated.with_uncertainty().uncertainty();
        if uncertainty <= 0.0 {
            return Ok(stated.clone());
        }
        self.n_drawn += 1;
        let standard: f64 = self.random.sample(StandardNormal);
        let drawn = stated.nominal() + standard * uncertainty;
        format!("{drawn:e} {}", K::DIMENSION)
            .parse()
            .map_err(|error: Written| {
                RodlabError::request(
                    field,
                    format!("{stated}, for which a draw is out of range: {error}"),
                    "an uncertainty that is small compared with the value",
                )
            })
    }
}
