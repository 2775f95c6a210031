//! Conversion of a propagation coefficient and its variance to a line of the result.

use num_complex::Complex64;

use super::spectra::GaugedRod;
use super::uncertainty::{GaugeInfluence, GaugeUncertainty};
use crate::branch::ResolvedRoot;
use crate::complex_frequency::ComplexFrequency;
use crate::estimate::{Acceptance, ComplexCovariance, ModulusLine, Refusal, Solution, Termination};
use crate::validity::{Violation, conditions};

/// Propagation coefficient γ of one line with its errors.
pub(super) struct SolvedLine {
    pub(super) index: usize,
    pub(super) frequency: ComplexFrequency,
    pub(super) gamma: Complex64,
    /// Variance E|δγ|² [1/m²].
    pub(super) variance: f64,
    /// Influence of each gauge, if any property of a gauge is uncertain or the end has a mass;
    /// otherwise empty.
    pub(super) influence: Vec<GaugeInfluence>,
    /// Second-order error of γ divided by |δγ|² \[m\].
    pub(super) curvature: f64,
    /// Amplification: |dγ| divided by the relative error of the gauges [1/m].
    pub(super) amplification: f64,
    pub(super) closed_form: Option<ResolvedRoot>,
    pub(super) termination: Termination,
    pub(super) violations: Vec<Violation>,
}

impl SolvedLine {
    pub(super) fn into_modulus(
        self,
        (rod, end_mass): (&GaugedRod, f64),
        uncertainty: &GaugeUncertainty,
        acceptance: &Acceptance,
    ) -> Result<ModulusLine, Refusal> {
        let gamma = self.gamma;
        let modulus = self
            .frequency
            .modulus(gamma, rod.density)
            .map_err(|_| Refusal::NoRoot)?;
        let s = self.frequency.laplace();
        let rod_and_mass = (rod, end_mass);
        let systematic = uncertainty.shifts(s, (gamma, modulus), rod_and_mass, &self.influence);
        let mut violations = self.violations;
        if self.frequency.is_on_axis() {
            violations.splice(0..0, conditions(gamma, rod.diameter, rod.aperture()));
        }
        Solution {
            index: self.index,
            frequency: self.frequency,
            gamma,
            density: rod.density,
            diameter: rod.diameter,
            random: ComplexCovariance::circular(self.variance),
            systematic,
            error_amplification: 2.0 * self.amplification / gamma.norm(),
            second_order: self.curvature * self.variance.sqrt(),
            distance: rod.least_distance(),
            closed_form: self.closed_form,
            termination: self.termination,
            violations,
        }
        .into_line(acceptance)
    }
}
