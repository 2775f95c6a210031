//! Text report of an identification.

use std::fmt;

use crate::agreement::FitFlag;
use crate::identifiability::{Estimate, Identifiability, Noise};
use crate::identification::Identification;
use crate::law::{Role, Scale};
use crate::model::RodModel;
use crate::nuisance::NuisanceEstimate;

/// Displays an identification: law, termination, residual, and each parameter with error and
/// verdict.
#[derive(Debug, Clone)]
pub struct Report {
    model: String,
    iterations: usize,
    termination: String,
    relative_error: f64,
    identifiability: Option<Identifiability>,
    nuisances: Vec<Vec<NuisanceEstimate>>,
    flags: Vec<FitFlag>,
}

impl<M: RodModel> Identification<M> {
    /// Returns a text report, with errors for `noise`.
    #[must_use]
    pub fn report(&self, noise: Noise) -> Report {
        Report {
            model: self.model().name().to_owned(),
            iterations: self.iterations(),
            termination: self.termination().to_string(),
            relative_error: self.relative_error(),
            identifiability: self.identifiability(noise),
            nuisances: self.nuisances().to_vec(),
            flags: self.flags().to_vec(),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} law, {} after {} iterations; residual {:.3} % of V0",
            self.model,
            self.termination,
            self.iterations,
            100.0 * self.relative_error
        )?;
        let Some(identifiability) = &self.identifiability else {
            return writeln!(
                f,
                "  the Jacobian could not be decomposed: no errors, no verdicts"
            );
        };
        for estimate in &identifiability.estimates {
            writeln!(f, "  {estimate}")?;
        }
        for (test, nuisances) in self.nuisances.iter().enumerate() {
            for NuisanceEstimate {
                name,
                value,
                standard_error,
            } in nuisances
            {
                writeln!(
                    f,
                    "  test {}: {name} = {value:.4e} ± {standard_error:.1e}",
                    test + 1
                )?;
            }
        }
        for flag in &self.flags {
            writeln!(f, "  warning: {flag}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {:.4e} {}", self.symbol, self.value, self.unit)?;
        match self.scale {
            _ if !self.standard_error.is_finite() => write!(f, ", error unbounded")?,
            Scale::Ratio => write!(f, " ± {:.2} %", 100.0 * self.standard_error)?,
            Scale::Difference => write!(f, " ± {:.3}", self.standard_error)?,
        }
        match (self.role, self.verdict) {
            (Role::Derived, _) => write!(f, " (derived)"),
            (Role::Coordinate, verdict) => write!(f, " ({verdict})"),
        }
    }
}
