//! Laws whose rates depend on the temperature (Arrhenius).
//!
//! A thermally activated rate at the temperature T is the rate at a reference temperature T₀ times
//!
//! ```text
//! exp(-(Q/R) (1/T - 1/T₀)) ,
//! ```
//!
//! with the activation energy Q and the gas constant R; a relaxation time has the inverse factor.
//! Tests at several temperatures then determine Q in addition to the parameters of the law at T₀.
//!
//! # Validity
//! The model is valid for one mechanism and a temperature-independent modulus, for example over
//! some tens of kelvin at temperatures away from a transition.
//!
//! Theory: `docs/theory/model-identification.md#tests-at-several-temperatures`.

use std::sync::Arc;

use crate::error::{MaxwellidError, check_positive};
use crate::law::StatedParameter;
use crate::model::{DrivenRod, LinearisedResponse, RodModel};
use crate::special_case::{PronySeries, SpecialCase};
use crate::specimen::SpecimenSensitivity;

/// Gas constant R [J/(mol K)].
const GAS_CONSTANT: f64 = 8.314_462_618;

/// Bounds of the activation energy [J/mol].
const BOUNDS: (f64, f64) = (-1e6, 1e6);

/// Largest change of the activation energy in one iteration [J/mol]; it changes the ratio of the
/// rates at two temperatures 10 K apart by a factor of e² at room temperature.
const STEP_LIMIT: f64 = 150e3;

/// Prior range of the activation energy [J/mol]: from a secondary transition of a polymer to its
/// glass transition.
pub(crate) const RANGE: (f64, f64) = (20e3, 300e3);

/// A model with thermally activated rates and times; its last parameter is the activation energy Q
/// [J/mol], the others are the parameters at the reference temperature.
#[derive(Debug, Clone)]
pub struct Arrhenius {
    model: Arc<dyn RodModel>,
    reference: f64,
    orders: Vec<(usize, f64)>,
}

impl Arrhenius {
    /// Creates the model with the parameters of `model` at `reference_temperature` \[K\].
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless the temperature is finite and above 0;
    /// [`MaxwellidError::NotActivated`] for a model without rates and times.
    pub fn of(
        model: Arc<dyn RodModel>,
        reference_temperature: f64,
    ) -> Result<Self, MaxwellidError> {
        check_positive("reference temperature [K]", reference_temperature)?;
        let orders = model.thermal_orders();
        if orders.is_empty() {
            return Err(MaxwellidError::NotActivated {
                model: model.name().to_owned(),
            });
        }
        Ok(Self {
            model,
            reference: reference_temperature,
            orders,
        })
    }

    /// The model at the reference temperature.
    #[must_use]
    pub fn at_reference(&self) -> &Arc<dyn RodModel> {
        &self.model
    }

    /// (1/T - 1/T₀)/R [mol/J].
    fn inverse_temperature(&self, rod: &DrivenRod<'_>) -> Option<f64> {
        let temperature = rod.temperature.filter(|t| *t > 0.0)?;
        Some((temperature.recip() - self.reference.recip()) / GAS_CONSTANT)
    }

    /// The parameters of the model at the temperature of `rod`.
    fn at_temperature(&self, rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<Vec<f64>> {
        let inverse = self.inverse_temperature(rod)?;
        let (energy, at_reference) = parameters.split_last()?;
        let mut own = at_reference.to_vec();
        for (index, order) in &self.orders {
            *own.get_mut(*index)? -= order * energy * inverse;
        }
        Some(own)
    }
}

/// The parameters without the activation energy.
fn at_reference(parameters: &[f64]) -> &[f64] {
    parameters.split_last().map_or(&[], |(_, others)| others)
}

impl RodModel for Arrhenius {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn is_linear(&self) -> bool {
        self.model.is_linear()
    }

    fn solver(&self) -> &'static str {
        self.model.solver()
    }

    fn parameter_names(&self) -> Vec<&str> {
        let names = self.model.parameter_names().into_iter();
        names.chain(std::iter::once("activation_energy")).collect()
    }

    fn step_limits(&self) -> Vec<f64> {
        let limits = self.model.step_limits().into_iter();
        limits.chain(std::iter::once(STEP_LIMIT)).collect()
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        let bounds = self.model.bounds().into_iter();
        bounds.chain(std::iter::once(BOUNDS)).collect()
    }

    fn damping_parameter(&self) -> Option<usize> {
        self.model.damping_parameter()
    }

    fn needs_temperature(&self) -> bool {
        true
    }

    fn parameters(&self, modulus: f64) -> Vec<f64> {
        let own = self.model.parameters(modulus).into_iter();
        own.chain(std::iter::once(middle(RANGE))).collect()
    }

    fn starts(&self, modulus: f64, duration: f64) -> Vec<Vec<f64>> {
        let of_model = self.model.starts(modulus, duration);
        let with = |start: &Vec<f64>, energy: f64| {
            let mut start = start.clone();
            start.push(energy);
            start
        };
        let each = of_model.iter();
        each.flat_map(|start| [0.0, middle(RANGE)].map(|energy| with(start, energy)))
            .collect()
    }

    fn stated(&self, parameters: &[f64]) -> Vec<StatedParameter> {
        let mut stated = self.model.stated(at_reference(parameters));
        for parameter in &mut stated {
            parameter.gradient.push(0.0);
        }
        let energy = parameters.last().copied().unwrap_or(f64::NAN);
        let mut gradient = vec![0.0; parameters.len()];
        if let Some(own) = gradient.last_mut() {
            *own = energy.recip();
        }
        let names = ["activation energy", "Q", "J/mol"];
        stated.push(StatedParameter::ratio(names, energy, gradient));
        stated
    }

    fn specimen_sensitivities(&self, parameters: &[f64]) -> Vec<SpecimenSensitivity> {
        let own = self.model.specimen_sensitivities(at_reference(parameters));
        // errors of length and density change the rates at all temperatures by the same factor
        own.into_iter()
            .chain(std::iter::once(SpecimenSensitivity::default()))
            .collect()
    }

    fn response(&self, rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<Vec<f64>> {
        let own = self.at_temperature(rod, parameters)?;
        self.model.response(rod, &own)
    }

    fn linearised_response(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
    ) -> Option<LinearisedResponse> {
        let own = self.at_temperature(rod, parameters)?;
        let inverse = self.inverse_temperature(rod)?;
        let mut response = self.model.linearised_response(rod, &own)?;
        let mut by_energy = vec![0.0; response.velocity.len()];
        for (index, order) in &self.orders {
            let by = response.by_parameter.get(*index)?;
            let factor = -order * inverse;
            let pairs = by_energy.iter_mut().zip(by);
            pairs.for_each(|(sum, by)| *sum += factor * by);
        }
        response.by_parameter.push(by_energy);
        Some(response)
    }

    fn by_samples(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
        samples: &[usize],
        change: f64,
    ) -> Option<Vec<Vec<f64>>> {
        let own = self.at_temperature(rod, parameters)?;
        self.model.by_samples(rod, &own, samples, change)
    }

    /// The Prony series at the reference temperature.
    fn prony(&self, parameters: &[f64]) -> Option<PronySeries> {
        self.model.prony(at_reference(parameters))
    }

    /// The special case at the reference temperature, with an activation energy in the middle of
    /// its range, because a Prony series has none.
    fn special_case(&self, series: &PronySeries) -> Option<SpecialCase> {
        let mut case = self.model.special_case(series)?;
        case.parameters.push(middle(RANGE));
        Some(case)
    }
}

fn middle((low, high): (f64, f64)) -> f64 {
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use rodwave::band_limited::SampledHistory;
    use testbed::struck_rod::pulse;

    use super::*;
    use crate::catalogue::Law;

    const RATE: f64 = 51_200.0;

    fn with_rod(temperature: Option<f64>, ask: impl FnOnce(&DrivenRod<'_>)) {
        let samples = pulse(120, 35.0, 4.0);
        let times: Vec<f64> = (0..100).map(|k| f64::from(k) / RATE).collect();
        ask(&DrivenRod {
            length: 0.3,
            density: 1140.0,
            sampling_rate_hz: RATE,
            samples: &samples,
            excitation: &SampledHistory::new(&samples, RATE).unwrap(),
            times: &times,
            cell: 4e-3,
            temperature,
            lateral_inertia: 0.0,
        });
    }

    /// The response is that of the law with the rate at the temperature, and its derivatives agree
    /// with difference quotients.
    #[test]
    fn rates_and_times_follow_the_temperature() {
        let energy = 90e3;
        // exp(-Q/R (1/313.15 - 1/293.15)), to ten digits
        let faster = 10.572_787_280_f64;
        for law in [
            Law::Norton,
            Law::Maxwell,
            Law::ZenerNorton,
            Law::MaxwellAndNorton,
            Law::TwoMaxwellBranches,
        ] {
            let model = Arrhenius::of(Arc::new(law), 293.15).unwrap();
            let mut cold = law.parameters(3e9);
            let names: Vec<String> = law
                .parameter_names()
                .iter()
                .map(|n| (*n).to_owned())
                .collect();
            let mut warm = cold.clone();
            for (name, value) in names.iter().zip(&mut warm) {
                match name.as_str() {
                    "ln_reference_rate" => *value += faster.ln(),
                    name if name.contains("time") => *value -= faster.ln(),
                    _ => {}
                }
            }
            assert_ne!(cold, warm, "{law:?}");
            cold.push(energy);
            with_rod(Some(313.15), |rod| {
                let found = model.linearised_response(rod, &cold).unwrap();
                let expected = law.linearised_response(rod, &warm).unwrap();
                let pairs = found.velocity.iter().zip(&expected.velocity);
                // the rate is stated with ten digits
                assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-8), "{law:?}");
                let of = |energy: f64| {
                    let mut at = cold.clone();
                    *at.last_mut().unwrap() = energy;
                    model.response(rod, &at).unwrap()
                };
                let (below, above) = (of(energy - 50.0), of(energy + 50.0));
                let largest = found
                    .velocity
                    .iter()
                    .fold(0.0_f64, |top, v| top.max(v.abs()));
                let by_energy = found.by_parameter.last().unwrap();
                for ((above, below), by) in above.iter().zip(&below).zip(by_energy) {
                    // difference quotient over 100 J/mol, for the derivative per 1 J/mol
                    assert!(
                        ((above - below) / 100.0 - by).abs() < 1e-9 * largest,
                        "{law:?}"
                    );
                }
                assert!(
                    by_energy.iter().any(|by| by.abs() > 1e-7 * largest),
                    "{law:?}"
                );
            });
            with_rod(None, |rod| assert!(model.response(rod, &cold).is_none()));
        }
    }

    #[test]
    fn laws_without_rates_are_refused() {
        for law in [Law::Elastic, Law::ConstantQ] {
            let refused = Arrhenius::of(Arc::new(law), 293.15).unwrap_err();
            assert!(
                matches!(refused, MaxwellidError::NotActivated { .. }),
                "{refused}"
            );
        }
        assert!(Arrhenius::of(Arc::new(Law::Norton), 0.0).is_err());
        assert!(Arrhenius::of(Arc::new(Law::Norton), f64::NAN).is_err());
    }
}
