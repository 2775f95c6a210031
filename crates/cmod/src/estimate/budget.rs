//! Uncertainty budget of one line: random error and common errors by their sources.

use super::{ErrorSource, ModulusLine, StandardError};
use crate::error::CmodError;
use crate::uncertainty::{ComplexCovariance, LineCovariance, coverage_factor};

/// Quantity of a line for which there is a budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum BudgetedQuantity {
    /// E' \[Pa\].
    StorageModulus,
    /// E'' \[Pa\].
    LossModulus,
    /// E''/E'.
    LossFactor,
}

impl BudgetedQuantity {
    fn of(self, error: &StandardError) -> f64 {
        match self {
            Self::StorageModulus => error.storage_modulus,
            Self::LossModulus => error.loss_modulus,
            Self::LossFactor => error.loss_factor,
        }
    }
}

/// Uncertainty budget of one quantity of a line (JCGM 100).
///
/// ```
/// # use cmod::estimate::BudgetedQuantity;
/// # use cmod::two_point::SpecimenUncertainty;
/// # use cmod::{Specimen, TwoPoint};
/// # use num_complex::Complex64;
/// # let specimen = Specimen { length: 0.799, diameter: 0.0158, density: 912.0, accelerometer_mass: 2.9e-3 };
/// # let ratio = [Complex64::new(0.0116, 0.1001), Complex64::new(-0.0202, 0.1019)];
/// let method = TwoPoint::new(specimen)?.with_specimen_uncertainty(SpecimenUncertainty {
///     length: 3e-4,
///     density: 5.0,
///     ..SpecimenUncertainty::default()
/// })?;
/// let estimate = method.estimate(&[500.0, 510.0], &ratio, &[1e-6; 2])?;
/// let line = &estimate.lines()[0];
/// let budget = line.budget(BudgetedQuantity::StorageModulus);
/// let squares: f64 = budget.sources().iter().map(|(_, error)| error * error).sum::<f64>() + budget.random().powi(2);
/// assert!((squares.sqrt() / line.standard_error.storage_modulus - 1.0).abs() < 1e-12);
/// let (density, _) = budget.sources()[0];
/// assert_eq!(density.to_string(), "density");
/// // known variances: the factor is that of the normal distribution
/// assert!((budget.expanded_uncertainty(0.95)? / budget.standard_uncertainty() - 1.960).abs() < 1e-3);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    random: f64,
    sources: Vec<(ErrorSource, f64)>,
    degrees_of_freedom: Option<f64>,
}

impl Budget {
    /// Returns the standard error due to noise alone.
    #[must_use]
    pub fn random(&self) -> f64 {
        self.random
    }

    /// Returns the standard uncertainties of the common sources, the largest first. Lateral inertia
    /// that was not removed is not listed; it has a bound ([`ModulusLine::lateral_inertia_bound`]).
    #[must_use]
    pub fn sources(&self) -> &[(ErrorSource, f64)] {
        &self.sources
    }

    /// Returns the root sum of squares of all contributions.
    #[must_use]
    pub fn standard_uncertainty(&self) -> f64 {
        let common = self.sources.iter().map(|(_, error)| *error);
        common.fold(self.random, f64::hypot)
    }

    /// Returns the effective degrees of freedom, (u/u_r)⁴ν by Welch and Satterthwaite, with the
    /// degrees of freedom ν of the variance of the random error u_r. Stated uncertainties have
    /// infinitely many degrees of freedom. Returns `None` if the variance is known.
    ///
    /// # Validity
    /// u_r is itself an estimate. For ν = 4 and a common error of 0.3 to 2 times the random one, the
    /// expanded uncertainty for 95 % covers 94.1 to 94.9 %; for ν = 8 and above, 94.7 % or more.
    fn effective_degrees_of_freedom(&self) -> Option<f64> {
        let freedom = self.degrees_of_freedom?;
        let effective = (self.standard_uncertainty() / self.random).powi(4) * freedom;
        effective.is_finite().then_some(effective)
    }

    /// Returns the standard uncertainty times the coverage factor for this `probability`.
    ///
    /// # Errors
    /// The errors of [`coverage_factor`].
    pub fn expanded_uncertainty(&self, probability: f64) -> Result<f64, CmodError> {
        let factor = coverage_factor(probability, self.effective_degrees_of_freedom())?;
        Ok(factor * self.standard_uncertainty())
    }
}

impl ModulusLine {
    /// Returns the expanded uncertainty of a quantity for a coverage of `probability`, from random
    /// and common errors together ([`Self::budget`]).
    ///
    /// # Errors
    /// The errors of [`coverage_factor`].
    pub fn expanded_uncertainty(
        &self,
        quantity: BudgetedQuantity,
        probability: f64,
    ) -> Result<f64, CmodError> {
        self.budget(quantity).expanded_uncertainty(probability)
    }

    /// Returns the budget of one quantity of the line, to first order.
    #[must_use]
    pub fn budget(&self, quantity: BudgetedQuantity) -> Budget {
        let systematic = self.uncertainty.systematic.iter();
        let mut sources: Vec<(ErrorSource, f64)> = systematic
            .filter(|shift| shift.source != ErrorSource::LateralInertia)
            .map(|shift| {
                let error = self.standard_error_of(&LineCovariance {
                    modulus: ComplexCovariance::of_shift(shift.modulus),
                    propagation_coefficient: ComplexCovariance::of_shift(
                        shift.propagation_coefficient,
                    ),
                });
                (shift.source, quantity.of(&error))
            })
            .collect();
        sources.sort_by(|a, b| b.1.total_cmp(&a.1));
        Budget {
            random: quantity.of(&self.random_error()),
            sources,
            degrees_of_freedom: self.uncertainty.degrees_of_freedom,
        }
    }
}
