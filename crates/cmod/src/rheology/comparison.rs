//! Several laws fitted to the same data, side by side.

use std::fmt;

use super::data::ModulusData;
use super::fit::{Criterion, FitOptions, RheologicalFit};
use super::law::Law;
use crate::error::CmodError;

/// Fits of several laws to the same data, the preferred one first.
///
/// A criterion compares laws with each other; whether the best of them is good is told by its χ² and the whiteness of its
/// residuals.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct Comparison {
    /// The fits, in the order of the criterion.
    pub rows: Vec<ComparisonRow>,
    /// Laws that could not be fitted, with the reason.
    pub refused: Vec<(Law, CmodError)>,
    /// The criterion.
    pub criterion: Criterion,
}

/// One law of a [`Comparison`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ComparisonRow {
    /// The fit.
    pub fit: RheologicalFit,
    /// Criterion less that of the preferred law.
    pub difference: f64,
    /// exp(-difference/2), as a share of all: by BIC the probability of the law, if one of them is true and none is more likely
    /// beforehand.
    pub weight: f64,
}

impl Comparison {
    /// Fits all `laws` to `data`.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for a level of confidence out of its range. A law that cannot be fitted is in
    /// [`Self::refused`].
    pub fn new(data: &ModulusData, laws: &[Law], options: &FitOptions) -> Result<Self, CmodError> {
        let options = options.checked()?;
        let mut rows = Vec::with_capacity(laws.len());
        let mut refused = Vec::new();
        for law in laws {
            match RheologicalFit::new(data, *law, &options) {
                Ok(fit) => rows.push(ComparisonRow {
                    fit,
                    difference: 0.0,
                    weight: 0.0,
                }),
                Err(error) => refused.push((*law, error)),
            }
        }
        let score = |row: &ComparisonRow| options.criterion.of(row.fit.aicc, row.fit.bic);
        rows.sort_by(|a, b| score(a).total_cmp(&score(b)));
        let least = rows.first().map_or(0.0, score);
        for row in &mut rows {
            row.difference = score(row) - least;
            row.weight = (-0.5 * row.difference).exp();
        }
        let all: f64 = rows.iter().map(|row| row.weight).sum();
        for row in &mut rows {
            row.weight /= all;
        }
        Ok(Self {
            rows,
            refused,
            criterion: options.criterion,
        })
    }

    /// The preferred law; `None` if none could be fitted.
    #[must_use]
    pub fn best(&self) -> Option<&RheologicalFit> {
        self.rows.first().map(|row| &row.fit)
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.criterion {
            Criterion::Bic => "BIC",
            Criterion::Aicc => "AICc",
        };
        write!(
            f,
            "{:<20} {:>10} {:>10} {:>5} {:>11} {:>9} {:>8} {:>9}",
            "law", "parameters", "chi^2", "dof", name, "less", "weight", "residuals"
        )?;
        for row in &self.rows {
            let fit = &row.fit;
            let score = self.criterion.of(fit.aicc, fit.bic);
            write!(
                f,
                "\n{:<20} {:>10} {:>10.1} {:>5} {:>11.1} {:>9.1} {:>8.3} {:>9}",
                fit.law.law(),
                fit.parameters.len(),
                fit.chi_squared,
                fit.degrees_of_freedom,
                score,
                row.difference,
                row.weight,
                if fit.whiteness.is_white(0.01) {
                    "white"
                } else {
                    "not white"
                }
            )?;
        }
        for (law, error) in &self.refused {
            write!(f, "\n{law:<20} {error}")?;
        }
        Ok(())
    }
}
