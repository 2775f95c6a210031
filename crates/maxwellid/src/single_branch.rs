//! A rod whose material is a spring in series with one inelastic law, as a [`RodModel`].

use rodwave::band_limited::SamplePulses;
use rodwave::characteristics::BranchedProblem;
use rodwave::{DirectProblem, InelasticRod};

use crate::lateral_inertia::{self, SecantModulus};
use crate::law::{IdentifiableLaw, StatedParameter};
use crate::model::{
    DrivenRod, LOG_MODULUS_STEP, LinearisedResponse, MODULUS_BOUNDS, RodModel, cells_of,
    stated_modulus,
};
use crate::special_case::{PronySeries, SpecialCase};
use crate::specimen::SpecimenSensitivity;

fn rod_of<L: IdentifiableLaw>(
    law: &L,
    rod: &DrivenRod<'_>,
    parameters: &[f64],
) -> Option<InelasticRod<L>> {
    let (log_modulus, of_law) = parameters.split_first()?;
    let law = law.with_parameters(of_law).ok()?;
    InelasticRod::new(rod.length, rod.density, log_modulus.exp(), law).ok()
}

fn direct_problem<L: IdentifiableLaw>(
    law: &L,
    rod: &DrivenRod<'_>,
    parameters: &[f64],
) -> Option<DirectProblem<L>> {
    let cells = cells_of(rod).ok()?;
    DirectProblem::new(rod_of(law, rod, parameters)?, cells).ok()
}

/// v_r of a rod of a nonlinear `law` with lateral inertia.
fn thick<L: IdentifiableLaw>(law: &L, rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<Vec<f64>> {
    let cells = cells_of(rod).ok()?;
    BranchedProblem::new(rod_of(law, rod, parameters)?, Vec::new(), cells)
        .and_then(|problem| {
            problem.free_end_velocity_with_lateral_inertia(
                rod.lateral_inertia,
                rod.excitation,
                rod.times,
            )
        })
        .ok()
}

/// Returns a function of θ, the secant modulus of a rod of this law.
fn secant_of<L: IdentifiableLaw>(
    law: &L,
    rod: &DrivenRod<'_>,
) -> impl Fn(&[f64]) -> Option<SecantModulus> {
    move |parameters| {
        let (log_modulus, of_law) = parameters.split_first()?;
        let law = law.with_parameters(of_law).ok()?;
        Some(SecantModulus::behind_front(rod, log_modulus.exp()).with_law(1.0, &law))
    }
}

impl<L: IdentifiableLaw> RodModel for L {
    fn name(&self) -> &str {
        L::NAME
    }

    fn is_linear(&self) -> bool {
        L::LINEAR
    }

    fn parameter_names(&self) -> Vec<&str> {
        std::iter::once("ln_modulus")
            .chain(L::PARAMETERS.iter().copied())
            .collect()
    }

    fn step_limits(&self) -> Vec<f64> {
        std::iter::once(LOG_MODULUS_STEP)
            .chain(L::STEP_LIMITS.iter().copied())
            .collect()
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        std::iter::once((MODULUS_BOUNDS.0.ln(), MODULUS_BOUNDS.1.ln()))
            .chain(self.parameter_bounds())
            .collect()
    }

    fn damping_parameter(&self) -> Option<usize> {
        // the last parameter of a law is its rate
        (!L::PARAMETERS.is_empty()).then_some(L::PARAMETERS.len())
    }

    fn thermal_orders(&self) -> Vec<(usize, f64)> {
        let rate = self.damping_parameter();
        rate.map(|rate| (rate, 1.0)).into_iter().collect()
    }

    fn parameters(&self, modulus: f64) -> Vec<f64> {
        std::iter::once(modulus.ln())
            .chain(rodwave::inelastic::InelasticLaw::parameters(self))
            .collect()
    }

    /// Returns rates of the law in steps of half a decade, from a relaxation time of a hundredth of
    /// the record, with complete decay, to one of ten thousand records, without visible decay.
    fn starts(&self, modulus: f64, duration: f64) -> Vec<Vec<f64>> {
        let mut starts: Vec<Vec<f64>> = (-4_i32..=8)
            .filter_map(|half_decades| {
                let relaxation_time = duration * 10.0_f64.powf(0.5 * f64::from(half_decades));
                self.at_rate(self.reference_stress() / (modulus * relaxation_time))
            })
            .map(|law| RodModel::parameters(&law, modulus))
            .collect();
        if starts.is_empty() {
            starts.push(RodModel::parameters(self, modulus));
        }
        starts
    }

    fn stated(&self, parameters: &[f64]) -> Vec<StatedParameter> {
        let law = parameters
            .get(1..)
            .and_then(|of_law| self.with_parameters(of_law).ok());
        let of_law = law.map(|law| IdentifiableLaw::stated(&law));
        std::iter::once(stated_modulus(parameters))
            .chain(of_law.unwrap_or_default().into_iter().map(|mut stated| {
                // the parameters of a law do not depend on E
                stated.gradient.insert(0, 0.0);
                stated
            }))
            .collect()
    }

    fn specimen_sensitivities(&self, parameters: &[f64]) -> Vec<SpecimenSensitivity> {
        let law = parameters
            .get(1..)
            .and_then(|of_law| self.with_parameters(of_law).ok());
        let of_law = law.map(|law| IdentifiableLaw::specimen_sensitivities(&law));
        std::iter::once(SpecimenSensitivity::OF_MODULUS)
            .chain(of_law.unwrap_or_default())
            .collect()
    }

    fn response(&self, rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<Vec<f64>> {
        if rod.lateral_inertia > 0.0 && !L::LINEAR {
            return thick(self, rod, parameters);
        }
        let velocity = direct_problem(self, rod, parameters)?
            .free_end_velocity(rod.excitation, rod.times)
            .ok()
            .filter(|velocity| velocity.iter().all(|v| v.is_finite()))?;
        let secant = secant_of(self, rod);
        let columns = lateral_inertia::of_columns(rod, parameters, secant, vec![velocity]);
        columns?.into_iter().next()
    }

    fn linearised_response(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
    ) -> Option<LinearisedResponse> {
        if rod.lateral_inertia > 0.0 && !L::LINEAR {
            let at = |parameters: &[f64]| thick(self, rod, parameters);
            return lateral_inertia::by_differences(parameters, at);
        }
        let response = direct_problem(self, rod, parameters)?
            .free_end_velocity_with_sensitivities(rod.excitation, rod.times)
            .ok()?;
        let linearised = LinearisedResponse {
            velocity: response.velocity,
            by_parameter: std::iter::once(response.by_log_modulus)
                .chain(response.by_parameter)
                .collect(),
        };
        lateral_inertia::of_linearised(rod, parameters, secant_of(self, rod), linearised)
    }

    fn by_samples(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
        samples: &[usize],
        change: f64,
    ) -> Option<Vec<Vec<f64>>> {
        let pulses = SamplePulses::new(samples, rod.sampling_rate_hz).ok()?;
        let columns = direct_problem(self, rod, parameters)?
            .free_end_velocity_by_samples(rod.excitation, &pulses, rod.times, change)
            .ok()?;
        lateral_inertia::of_columns(rod, parameters, secant_of(self, rod), columns)
    }

    fn prony(&self, parameters: &[f64]) -> Option<PronySeries> {
        let (log_modulus, of_law) = parameters.split_first()?;
        let law = self.with_parameters(of_law).ok()?;
        let modulus = log_modulus.exp();
        let rate = law.linear_rate()?;
        Some(if rate > 0.0 {
            PronySeries::maxwell(modulus, law.reference_stress() / (modulus * rate))
        } else {
            PronySeries::elastic(modulus)
        })
    }

    fn special_case(&self, series: &PronySeries) -> Option<SpecialCase> {
        let rate = self.reference_stress() / (series.modulus * series.single_time()?);
        let (law, limit) = self.at_linear_limit(rate)?;
        let limit = if series.branches.is_empty() {
            "without damping"
        } else {
            limit
        };
        Some(SpecialCase {
            parameters: RodModel::parameters(&law, series.modulus),
            limit: limit.to_owned(),
        })
    }
}
