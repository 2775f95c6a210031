//! Uncertainty of a predicted force, from the errors of the mobilities, of the impact velocity and
//! of the masses.
//!
//! Theory: `docs/theory/force-uncertainty.md`.

mod contact_end;
mod monte_carlo;

pub use contact_end::{EndError, EndVerdict, contact_band};
pub use monte_carlo::MonteCarlo;

use num_complex::Complex64;

use crate::error::{check_length, check_not_negative};
use crate::{ForceError, ImpulseError, StickProblem, ZeroLine};

/// Errors of the inputs of a stick force; zero by default.
///
/// | field | shape | unit |
/// |---|---|---|
/// | variances $`\mathrm E\lvert\delta G\rvert^2`$ | `(n_lines)`, the element at 0 Hz is not read | (m/(N s))² |
/// | standard errors | scalar | as stated |
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StickUncertainty<'a> {
    /// Variance of the first body's mobility: circular, independent between lines, as obtained by
    /// averaging hits.
    pub first_variance: Option<&'a [f64]>,
    /// Variance of the second body's mobility.
    pub second_variance: Option<&'a [f64]>,
    /// Relative standard error of the scale of the first mobility, the same on all lines, for
    /// example of a sensitivity \[1\].
    pub first_scale: f64,
    /// Relative standard error of the scale of the second mobility \[1\].
    pub second_scale: f64,
    /// Standard error of the delay of the response after the force in the first mobility \[s\].
    pub first_delay: f64,
    /// Standard error of the delay in the second mobility \[s\].
    pub second_delay: f64,
    /// Standard error of the impact velocity [m/s].
    pub impact_velocity: f64,
    /// Standard error of the effective mass \[kg\]; used only with [`ZeroLine::EffectiveMass`]. For
    /// one free body it is the standard error of the weighing; for two,
    /// $`\delta M = M^2\sqrt{(\delta M_1/M_1^2)^2 + (\delta M_2/M_2^2)^2}`$.
    pub effective_mass: f64,
}

impl StickProblem<'_> {
    /// Returns the random error of the stick force, to first order. With $`\hat F =
    /// V/(i\omega(G_1+G_2))`$,
    ///
    /// ```math
    /// \delta\hat F = \hat F\left[\frac{\delta V}{V} - \frac{\delta G_1 + \delta G_2}{G_1+G_2}\right], \qquad
    /// \delta\hat F(0) = V\,\delta M + M\,\delta V .
    /// ```
    ///
    /// Circular errors of independent lines give a force error that is as large before the contact
    /// as after it, with the covariance `Δf² Σₖ E|δF̂ₖ|² e^{iωₖτ}`. Errors of the scales, of the
    /// delays ($`\delta G = -i\omega\tau G`$), of the velocity and of the mass affect all times
    /// together.
    ///
    /// # Validity
    ///
    /// Errors of a line must be small compared with $`|G_1+G_2|`$. This may fail near a resonance
    /// of the joined bodies, where the sum is small. [`StickUncertainty::monte_carlo`] does not
    /// linearise. Measured lines corrected by one weighed mass have common errors, which are
    /// treated as independent here.
    ///
    /// # Errors
    ///
    /// The errors of [`StickProblem::solve`]; [`ImpulseError::LengthMismatch`],
    /// [`ImpulseError::NonFinite`], [`ImpulseError::NonPhysical`] for the uncertainty.
    #[allow(
        clippy::indexing_slicing,
        reason = "`force_lines` has checked that both mobilities have the same length, and returns as many lines"
    )]
    pub fn error(&self, uncertainty: &StickUncertainty<'_>) -> Result<ForceError, ImpulseError> {
        let (lines, _) = self.force_lines()?;
        uncertainty.check(self)?;
        let (n_period, n_shown) = self.n_samples();
        let scale = self.frequency_step_hz.powi(2);
        let mobilities = || self.first.iter().zip(self.second);
        let variances: Vec<f64> = lines
            .iter()
            .zip(mobilities())
            .enumerate()
            .map(|(line, (force, (first, second)))| {
                if line == 0 {
                    return 0.0;
                }
                let variance = uncertainty.variance_at(line);
                scale * force.norm_sqr() * variance / (first + second).norm_sqr()
            })
            .collect();
        let variances: Vec<f64> = {
            let lines = variances.into_iter().map(Complex64::from).collect();
            // the amplitude of the last line is halved
            let lines = self.interpolated(lines, 0.25);
            lines.iter().map(|line| line.re).collect()
        };
        let mut error = ForceError::none(n_shown).with_lines(variances, n_period, self.reference());
        let effect = |part: &dyn Fn(usize, Complex64) -> Complex64| {
            let changed = lines.iter().enumerate().map(|(k, f)| part(k, *f));
            let (history, _) = self.history_of(&changed.collect::<Vec<_>>())?;
            Ok::<_, ImpulseError>(history.force().to_vec())
        };
        let share = |line: usize, of: &[Complex64]| {
            if line == 0 {
                Complex64::ZERO
            } else {
                of[line] / (self.first[line] + self.second[line])
            }
        };
        for (scale, delay, mobility) in [
            (uncertainty.first_scale, uncertainty.first_delay, self.first),
            (
                uncertainty.second_scale,
                uncertainty.second_delay,
                self.second,
            ),
        ] {
            if scale > 0.0 {
                error = error.with_common(effect(&|k, f| -scale * f * share(k, mobility))?);
            }
            if delay > 0.0 {
                let phase = |line: usize| Complex64::new(0.0, self.omega(line) * delay);
                error = error.with_common(effect(&|k, f| phase(k) * f * share(k, mobility))?);
            }
        }
        if uncertainty.impact_velocity > 0.0 {
            let relative = uncertainty.impact_velocity / self.impact_velocity;
            error = error.with_common(effect(&|_, f| relative * f)?);
        }
        if uncertainty.effective_mass > 0.0
            && let ZeroLine::EffectiveMass(_) = self.zero_line
        {
            let impulse = self.impact_velocity * uncertainty.effective_mass;
            error = error.with_common(effect(&|k, _| {
                Complex64::from(if k == 0 { impulse } else { 0.0 })
            })?);
        }
        Ok(error)
    }
}

impl StickUncertainty<'_> {
    /// Returns true if no input has an error.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.first_variance.is_none()
            && self.second_variance.is_none()
            && self
                .standard_errors()
                .iter()
                .all(|(_, error)| *error == 0.0)
    }

    /// Returns the standard errors with their names.
    fn standard_errors(&self) -> [(&'static str, f64); 6] {
        [
            ("standard error of the first scale", self.first_scale),
            ("standard error of the second scale", self.second_scale),
            ("standard error of the first delay [s]", self.first_delay),
            ("standard error of the second delay [s]", self.second_delay),
            (
                "standard error of the impact velocity [m/s]",
                self.impact_velocity,
            ),
            (
                "standard error of the effective mass [kg]",
                self.effective_mass,
            ),
        ]
    }

    fn check(&self, problem: &StickProblem<'_>) -> Result<(), ImpulseError> {
        for (what, variance) in [
            ("variance of the first mobility", self.first_variance),
            ("variance of the second mobility", self.second_variance),
        ] {
            let Some(variance) = variance else { continue };
            check_length(what, variance.len(), problem.first.len())?;
            let mut lines = variance.iter().enumerate().skip(1);
            if let Some((index, value)) = lines.find(|(_, v)| !(v.is_finite() && **v >= 0.0)) {
                if value.is_finite() {
                    check_not_negative("variance of a mobility [(m/(N s))^2]", *value)?;
                }
                return Err(ImpulseError::NonFinite { what, index });
            }
        }
        for (quantity, value) in self.standard_errors() {
            check_not_negative(quantity, value)?;
        }
        Ok(())
    }

    /// Returns the variance of the sum of the mobilities.
    #[allow(
        clippy::indexing_slicing,
        reason = "`check` has found a variance for each line of the mobilities"
    )]
    fn variance_at(&self, line: usize) -> f64 {
        [self.first_variance, self.second_variance]
            .into_iter()
            .flatten()
            .map(|variance| variance[line])
            .sum()
    }
}

#[cfg(test)]
mod tests;
