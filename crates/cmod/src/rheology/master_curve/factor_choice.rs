//! Choice between vertical factors of 1 and those of rubber elasticity, made by the data.
//!
//! A constant factor and a shift of a curve have almost the same effect where the modulus is a
//! power of frequency. Narrow bands and large errors may then leave both b_T = 1 and b_T = T/Tᵣ
//! possible, with shifts and laws that differ by several standard errors. As for the orders of a
//! series, the difference d between the results is an error, with the variance w d², where w is the
//! probability of the factors that were not chosen (Buckland, Burnham & Augustin, *Biometrics*
//! **53** (1997) 603). With the difference Δ of BIC in favour of the choice, w = 1/(1 + exp(Δ/2)).

use num_complex::Complex64;

use super::super::data::CommonError;
use super::super::fit::RheologicalFit;
use super::prepared::Prepared;
use crate::estimate::ErrorSource;

/// Decrease of BIC above which the factors of rubber elasticity are used: positive evidence (Kass &
/// Raftery 1995).
const ENTROPIC: f64 = 2.0;
/// Difference of BIC above which the other factors are excluded: their probability is 5e-5.
const EXCLUDED: f64 = 20.0;

/// Choice between the vertical factors b_T = 1 and b_T = T/Tᵣ, made by the data.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FactorChoice {
    /// True if T/Tᵣ was chosen.
    pub is_entropic: bool,
    /// BIC with the factors that were not chosen, minus BIC with the chosen ones.
    pub evidence: f64,
    /// Square root of the probability of the factors that were not chosen; 0 if they are excluded,
    /// or if the alternative to T/Tᵣ is a fit with estimated factors.
    share: f64,
}

impl FactorChoice {
    /// Chooses by the `fall` of BIC from the fit without the factors of rubber elasticity to the
    /// fit with them; `are_estimated` is true if the fit without them has estimated factors.
    pub(super) fn new(fall: f64, are_estimated: bool) -> Self {
        let is_entropic = fall > ENTROPIC;
        let evidence = if is_entropic { fall } else { -fall };
        let share = if are_estimated || evidence > EXCLUDED {
            0.0
        } else {
            (1.0 + (0.5 * evidence).exp()).recip().sqrt()
        };
        Self {
            is_entropic,
            evidence,
            share,
        }
    }

    /// Returns the error of ln b_T at `temperature`.
    pub(super) fn log_error(&self, temperature: f64, reference: f64) -> f64 {
        self.share * (temperature / reference).ln()
    }

    /// Adds the error due to the choice to the joined lines.
    #[allow(
        clippy::indexing_slicing,
        reason = "`reference` is the index of one of the temperatures"
    )]
    pub(super) fn add_to(&self, prepared: &mut Prepared) {
        if self.share == 0.0 {
            return;
        }
        let temperatures = &prepared.sweep.temperatures;
        let reference = temperatures[prepared.reference];
        let steps = prepared.sweep.data.iter().zip(temperatures);
        let log_errors = steps.flat_map(|(data, temperature)| {
            std::iter::repeat_n(self.log_error(*temperature, reference), data.len())
        });
        let lines = prepared.joined.modulus.iter().zip(log_errors);
        let shift: Vec<Complex64> = lines.map(|(modulus, error)| -modulus * error).collect();
        prepared.joined.common.push(CommonError {
            source: ErrorSource::VerticalFactors,
            shift,
        });
    }

    /// Returns the changes of the parameters of a fit of the master curve, or of a law fitted to
    /// its [reduced lines](super::MasterCurve::reduced), if the other factors were chosen. They are
    /// of first order, and in units of the standard errors without the error of the choice; 0 if
    /// the other factors are excluded.
    #[must_use]
    pub fn changes(&self, fit: &RheologicalFit) -> Vec<f64> {
        let errors = fit.common_errors.iter();
        let mut own = errors.filter(|error| error.source == ErrorSource::VerticalFactors);
        let Some(own) = own.next().filter(|_| self.share > 0.0) else {
            return vec![0.0; fit.parameters.len()];
        };
        let parameters = fit.parameters.iter().zip(&own.shift);
        parameters
            .map(|(parameter, shift)| {
                let rest = parameter.standard_error.powi(2) - shift.powi(2);
                (shift / self.share).abs() / rest.max(0.0).sqrt()
            })
            .collect()
    }
}
