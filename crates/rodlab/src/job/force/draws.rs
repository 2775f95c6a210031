//! Draws of quantities stated with ±: bodies, their materials and the contact.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::impact_sheet::ContactSheet;
use crate::RodlabError;
use crate::bodies::replacement::Replacement;
use crate::sheet::{Kind, Stated};

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
        let mut drawn = contact.clone();
        match &mut drawn {
            ContactSheet::Rigid => {}
            ContactSheet::Linear(stiffness) => self.replace(stiffness, field)?,
            ContactSheet::FlatPunch {
                radius,
                modulus,
                poisson_ratio,
            } => {
                self.replace(radius, field)?;
                self.replace(modulus, field)?;
                self.replace(poisson_ratio, field)?;
            }
            ContactSheet::Sphere {
                radius,
                moduli,
                poisson_ratios,
            } => {
                self.replace(radius, field)?;
                self.replace(&mut moduli.0, field)?;
                self.replace(&mut moduli.1, field)?;
                self.replace(&mut poisson_ratios.0, field)?;
                self.replace(&mut poisson_ratios.1, field)?;
            }
            ContactSheet::Table(points) => {
                for (approach, force) in points {
                    self.replace(approach, field)?;
                    self.replace(force, field)?;
                }
            }
        }
        Ok(drawn)
    }
}

impl Replacement for Draws<'_> {
    fn standard(&mut self, _source: &str) -> Result<f64, RodlabError> {
        self.n_drawn += 1;
        Ok(self.random.sample(StandardNormal))
    }

    fn replace<K: Kind>(&mut self, stated: &mut Stated<K>, field: &str) -> Result<(), RodlabError> {
        if stated.with_uncertainty().uncertainty() > 0.0 {
            self.n_drawn += 1;
            let standard: f64 = self.random.sample(StandardNormal);
            *stated = stated.moved(standard, field, "for which a draw is out of range")?;
        }
        Ok(())
    }
}
