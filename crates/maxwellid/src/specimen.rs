//! Sensitivity of the parameters to length and density of the specimen, and the errors caused by
//! these.
//!
//! For x = Lξ and the stress s = σ/(ρL), the equations of the rod are v̇ = ∂s/∂ξ and ∂v/∂ξ = (ρL²/E)
//! ṡ + L F(ρL s), and the histories at the ends are velocities. Two velocity histories therefore
//! determine only E/(ρL²) and the function L F(ρL s) of s:
//!
//! ```text
//! d ln E = 2 d ln L + d ln ρ ,
//! d ln F(σ) = -d ln L - (d ln F/d ln σ) (d ln L + d ln ρ)   at a given σ
//! ```
//!
//! Stresses such as m are proportional to ρL, viscosities to ρL²; exponents, times and loss factors
//! do not change. The relations hold for any histories, for a fit with or without nuisances, if all
//! tests are of one specimen.

use crate::error::MaxwellidError;
use crate::identifiability::{Estimate, Verdict};
use crate::profile::{Profile, THRESHOLD};

/// Change of a parameter (of its logarithm if its error is a ratio) by the logarithms of length and
/// density of the specimen, at given histories.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpecimenSensitivity {
    /// Derivative by ln L.
    pub length: f64,
    /// Derivative by ln ρ.
    pub density: f64,
}

impl SpecimenSensitivity {
    /// Sensitivity of ln E.
    pub const OF_MODULUS: Self = Self {
        length: 2.0,
        density: 1.0,
    };

    /// Sensitivity of the logarithm of an inelastic strain rate at a given stress, where ln F has
    /// the `slope` d ln F/d ln σ.
    #[must_use]
    pub fn of_rate(slope: f64) -> Self {
        Self {
            length: -(1.0 + slope),
            density: -slope,
        }
    }

    /// Sensitivity of a quantity with this `gradient` by parameters that have the sensitivities
    /// `of`.
    pub(crate) fn through(gradient: &[f64], of: &[Self]) -> Self {
        let parts = || gradient.iter().zip(of);
        Self {
            length: parts().map(|(g, of)| g * of.length).sum(),
            density: parts().map(|(g, of)| g * of.density).sum(),
        }
    }

    /// Standard error due to an uncertain specimen, of the logarithm if the sensitivity is.
    #[must_use]
    pub fn standard_error(&self, specimen: &SpecimenUncertainty) -> f64 {
        (self.length * specimen.length).hypot(self.density * specimen.density)
    }
}

/// Relative standard uncertainties of the specimen, independent of each other and the same in all
/// tests.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpecimenUncertainty {
    length: f64,
    density: f64,
}

impl SpecimenUncertainty {
    /// Creates the relative standard uncertainties of `length` and `density`; 0 for an exact one.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless both are finite and not below 0.
    pub fn relative(length: f64, density: f64) -> Result<Self, MaxwellidError> {
        for (setting, value) in [
            ("relative uncertainty of the length", length),
            ("relative uncertainty of the density", density),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(MaxwellidError::Setting {
                    setting,
                    value,
                    expected: "a finite value, 0 or above",
                });
            }
        }
        Ok(Self { length, density })
    }

    /// Returns true if both are exact.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.length == 0.0 && self.density == 0.0
    }
}

impl Estimate {
    /// Adds the error due to an uncertain specimen to the standard error. The verdict remains that
    /// of the data: a better measurement of the specimen does not change what they determine.
    #[must_use]
    pub fn with_specimen_uncertainty(mut self, specimen: &SpecimenUncertainty) -> Self {
        let error = self.sensitivity.standard_error(specimen);
        self.specimen_error = self.specimen_error.hypot(error);
        self.standard_error = self.standard_error.hypot(error);
        self
    }
}

/// Number of points between two of a profile in the search for an interval.
const FINER: u32 = 64;

impl Profile {
    /// Adds the error due to an uncertain specimen to the profile.
    ///
    /// The parameter is θ + gδ with the profile PL(θ) of the data, the sensitivity g and a relative
    /// error δ of known standard deviation. Elimination of δ gives the least of PL(y) + (θ -
    /// y)²/u² over y, with u the standard error due to the specimen. An end of the interval is
    /// the outermost y ± u (3.84 - PL(y))^(1/2).
    #[must_use]
    pub fn with_specimen_uncertainty(&self, specimen: &SpecimenUncertainty) -> Self {
        let error = self.sensitivity.standard_error(specimen);
        if error == 0.0 {
            return self.clone();
        }
        let fine = self.smooth_curve();
        let end = |sign: f64| {
            let inside = fine.iter().filter(|(_, rise)| *rise <= THRESHOLD);
            inside
                .map(|(at, rise)| sign * at + error * (THRESHOLD - rise).sqrt())
                .reduce(f64::max)
                .map(|end| sign * end)
        };
        let lower = self.lower.and_then(|_| end(-1.0));
        let upper = self.upper.and_then(|_| end(1.0));
        let ends = lower.iter().chain(&upper).copied();
        let mut curve: Vec<(f64, f64)> = self
            .curve
            .iter()
            .map(|(at, _)| *at)
            .chain(ends)
            .map(|at| {
                let rises = fine
                    .iter()
                    .map(|(y, rise)| rise + ((at - y) / error).powi(2));
                (at, rises.fold(f64::INFINITY, f64::min))
            })
            .collect();
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            lower,
            upper,
            curve,
            verdict: match (self.verdict, lower, upper) {
                (Verdict::BoundedBelow(_), Some(lower), _) => Verdict::BoundedBelow(lower),
                (Verdict::BoundedAbove(_), _, Some(upper)) => Verdict::BoundedAbove(upper),
                (verdict, ..) => verdict,
            },
            ..self.clone()
        }
    }

    /// The curve with intermediate points, 64 for each, its root interpolated linearly: exact for a
    /// linear problem on either side of the minimum.
    #[must_use]
    pub fn smooth_curve(&self) -> Vec<(f64, f64)> {
        let root = |rise: f64| if rise > 0.0 { rise.sqrt() } else { 0.0 };
        let mut fine: Vec<(f64, f64)> = self
            .curve
            .iter()
            .zip(self.curve.iter().skip(1))
            .filter(|((_, from), (_, to))| from.is_finite() && to.is_finite())
            .flat_map(|((x, from), (y, to))| {
                (0..FINER).map(move |step| {
                    let share = f64::from(step) / f64::from(FINER);
                    let between = root(*from) + share * (root(*to) - root(*from));
                    (x + share * (y - x), between * between)
                })
            })
            .collect();
        fine.extend(self.curve.last());
        fine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear problem: PL = ((θ - 3)/s)², and the errors of data and specimen add as squares.
    #[test]
    fn the_profile_of_a_linear_problem_widens_as_its_errors_add() {
        let (value, data, by_specimen) = (3.0, 0.02, 0.05);
        let rise = |at: f64| ((at - value) / data).powi(2);
        let half = data * THRESHOLD.sqrt();
        let profile = Profile {
            parameter: "ln_modulus".to_owned(),
            value,
            lower: Some(value - half),
            upper: Some(value + half),
            range: (0.0, 6.0),
            verdict: Verdict::Identified,
            curve: (-6..=6)
                .map(|step| value + 0.2 * f64::from(step) * half)
                .map(|at| (at, rise(at)))
                .collect(),
            sensitivity: SpecimenSensitivity::OF_MODULUS,
        };
        let specimen = SpecimenUncertainty::relative(0.02, 0.03).unwrap();
        assert!((profile.sensitivity.standard_error(&specimen) - by_specimen).abs() < 1e-15);
        let wide = profile.with_specimen_uncertainty(&specimen);
        let expected = THRESHOLD.sqrt() * data.hypot(by_specimen);
        // ends are looked for on 64 points a fifth of the interval: the maximum is flat
        assert!((wide.upper.unwrap() - value - expected).abs() < 1e-5);
        assert!((value - wide.lower.unwrap() - expected).abs() < 1e-5);
        for (at, rise) in &wide.curve {
            let expected = (at - value).powi(2) / (data.powi(2) + by_specimen.powi(2));
            assert!((rise - expected).abs() < 1e-3, "{at} {rise} {expected}");
        }
        let same = profile.with_specimen_uncertainty(&SpecimenUncertainty::default());
        assert_eq!(same, profile);
    }
}
