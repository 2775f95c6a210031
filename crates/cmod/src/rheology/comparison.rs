//! Comparison of several laws fitted to the same data.

use std::fmt;

use super::data::ModulusData;
use super::fit::{Criterion, FitOptions, PredictedModulus, RheologicalFit, mean_of};
use super::law::Law;
use crate::error::CmodError;

/// Fits of several laws to the same data, the preferred law first.
///
/// A criterion compares laws with each other; χ² of the best law and the whiteness of its residuals
/// test whether it is adequate.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct Comparison {
    /// Fits, in order of the criterion.
    pub rows: Vec<ComparisonRow>,
    /// Laws that could not be fitted, with the reason.
    pub refused: Vec<(Law, CmodError)>,
    /// Criterion by which the laws are compared.
    pub criterion: Criterion,
}

/// Row of a [`Comparison`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ComparisonRow {
    /// Fit of the law.
    pub fit: RheologicalFit,
    /// Criterion of this law minus the criterion of the preferred law.
    pub difference: f64,
    /// Weight exp(-difference/2), divided by the sum over all laws. For BIC it is the probability
    /// of the law, if one of the laws is true and all laws are equally probable a priori. It is 0
    /// for a law that is the same function as a preceding law.
    pub weight: f64,
    /// Preceding law that is the same function, for example Zener's model for a generalised Maxwell
    /// model with one branch. The two laws are counted as one.
    pub same_as: Option<Law>,
}

impl Comparison {
    /// Fits all `laws` to `data`.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for a confidence level that is not between 0 and 1. A law that
    /// cannot be fitted is listed in [`Self::refused`].
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
                    same_as: None,
                }),
                Err(error) => refused.push((*law, error)),
            }
        }
        let score = |row: &ComparisonRow| options.criterion.of(row.fit.aicc, row.fit.bic);
        // laws that are the same function share one value of the criterion; the law of simplest
        // form comes first
        let own = |row: &ComparisonRow| (row.fit.law.simplest(), row.fit.parameters.len());
        let scores: Vec<f64> = rows
            .iter()
            .map(|row| {
                let same = rows.iter().filter(|other| own(other) == own(row));
                same.map(score).fold(f64::INFINITY, f64::min)
            })
            .collect();
        let mut ranked: Vec<(f64, ComparisonRow)> = scores.into_iter().zip(rows).collect();
        ranked.sort_by(|(a, x), (b, y)| {
            let is_other = |row: &ComparisonRow| row.fit.law.law() != row.fit.law.simplest();
            a.total_cmp(b).then(is_other(x).cmp(&is_other(y)))
        });
        let least = ranked.first().map_or(0.0, |(score, _)| *score);
        let mut seen: Vec<((Law, usize), Law)> = Vec::new();
        let mut rows = Vec::with_capacity(ranked.len());
        for (score, mut row) in ranked {
            // scores are infinite if there are too few values
            row.difference = if score > least { score - least } else { 0.0 };
            let function = own(&row);
            row.same_as = seen
                .iter()
                .find_map(|(other, law)| (*other == function).then_some(*law));
            if row.same_as.is_none() {
                row.weight = (-0.5 * row.difference).exp();
                seen.push((function, row.fit.law.law()));
            }
            rows.push(row);
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

    /// Returns the modulus at `omega` > 0 [rad/s] as the mean of the laws with their
    /// [weights](ComparisonRow::weight). Its covariance includes the scatter between the laws.
    /// Returns `None` if no law could be fitted.
    ///
    /// # Errors
    /// The errors of [`RheologicalFit::prediction`].
    pub fn prediction(&self, omega: f64) -> Result<Option<PredictedModulus>, CmodError> {
        let mut all = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            all.push((row.weight, row.fit.prediction(omega)?));
        }
        let of = |pick: fn(&PredictedModulus) -> [[f64; 2]; 2]| {
            mean_of(
                all.iter()
                    // a law of weight 0 contributes nothing, even if its variance is infinite
                    .filter(|(weight, _)| *weight > 0.0)
                    .map(|(weight, one)| (*weight, one.modulus, pick(one))),
            )
        };
        let (modulus, covariance) = of(|one| one.covariance);
        let (_, random_covariance) = of(|one| one.random_covariance);
        Ok(all.first().map(|(_, first)| PredictedModulus {
            modulus,
            covariance,
            random_covariance,
            within_band: first.within_band,
        }))
    }

    /// Returns the preferred law; `None` if no law could be fitted.
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
            if let Some(same) = row.same_as {
                write!(f, "  the same function as {same}")?;
            }
        }
        for (law, error) in &self.refused {
            write!(f, "\n{law:<20} {error}")?;
        }
        Ok(())
    }
}
