//! Interface of a rod model for fits, independent of its physics and solver.

use std::fmt::Debug;
use std::sync::Arc;

use rodwave::band_limited::SampledHistory;

use crate::error::MaxwellidError;
use crate::law::StatedParameter;
use crate::parallel::map_in_order;
use crate::special_case::{PronySeries, SpecialCase};
use crate::specimen::SpecimenSensitivity;

/// Default of the longest cell of the grid \[m\]; the requested accuracy may require a shorter one.
/// The scheme is of second order, with an error below 2e-4 of V0 in a polymer rod struck by the
/// projectile of paper D, a hundredth of the recorder's noise.
pub const DEFAULT_CELL: f64 = 4e-3;

/// The direct problem: a rod at rest, driven at x = -L by v_e, free at x = 0.
#[derive(Debug, Clone, Copy)]
pub struct DrivenRod<'a> {
    /// Distance L from the section of excitation to the free end \[m\].
    pub length: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Sampling rate of the excitation \[Hz\].
    pub sampling_rate_hz: f64,
    /// Samples of v_e [m/s], the first at time 0.
    pub samples: &'a [f64],
    /// The excitation between its samples.
    pub excitation: &'a SampledHistory,
    /// Times \[s\] at which v_r is evaluated: ascending, not below 0, not beyond the excitation,
    /// not necessarily the times of samples.
    pub times: &'a [f64],
    /// Longest cell of a grid \[m\]; ignored by a model without a grid.
    pub cell: f64,
    /// Temperature of the rod \[K\], if it is stated; ignored by a model that does not
    /// [need](RodModel::needs_temperature) it.
    pub temperature: Option<f64>,
    /// Lateral inertia r² = ν²k_p² \[m²\], with Poisson's ratio ν and the polar radius of gyration
    /// k_p of the section: ν²D²/8 for a round rod, 0 for a thin one. If it is above 0, `times` must
    /// be equally spaced, except for leading times of 0.
    pub lateral_inertia: f64,
}

/// Velocity of the free end and its derivatives with respect to the parameters of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearisedResponse {
    /// v_r [m/s], one entry per time (paper D, eq. 11).
    pub velocity: Vec<f64>,
    /// ∂v_r/∂θ [m/s], one column per parameter, each as long as `velocity`.
    pub by_parameter: Vec<Vec<f64>>,
}

/// A model of a rod that can be fitted to tests. Every
/// [`IdentifiableLaw`](crate::IdentifiableLaw) is one, with θ = (ln E, parameters of the law) and
/// the solver [`rodwave::characteristics`]; a linear material solved in the frequency domain is
/// another.
///
/// # Requirements
/// The first component of θ is ln E \[Pa\], where E is the modulus that gives the front speed; a
/// fit starts with E from the time of flight. The derivatives are those of [`Self::response`], to
/// at least three digits. All results are functions of θ: the trait has no state. The numbers of
/// names, step limits, bounds and starting values must equal the number of parameters; a response
/// has one entry per time, and its derivative with respect to each parameter has as many. A
/// response of another length is treated as missing.
pub trait RodModel: Debug + Send + Sync {
    /// Name of the model.
    fn name(&self) -> &str;

    /// Returns true if v_r is proportional to v_e for all θ.
    fn is_linear(&self) -> bool;

    /// Name of the solver of the direct problem, as in the provenance of the virtual tests that it
    /// generates: a model is not fitted to tests of its own solver.
    fn solver(&self) -> &'static str {
        rodwave::characteristics::GENERATOR
    }

    /// Names of θ, the first being `ln_modulus`.
    fn parameter_names(&self) -> Vec<&str>;

    /// Largest change of each parameter in one iteration: about the range over which the response
    /// is nearly linear in it.
    fn step_limits(&self) -> Vec<f64>;

    /// Lower and upper bound of each parameter; infinite for none.
    fn bounds(&self) -> Vec<(f64, f64)>;

    /// Index of the parameter that scales the damping, if there is one. If the data do not
    /// determine it, they do not determine its shape either.
    fn damping_parameter(&self) -> Option<usize>;

    /// Parameters that are logarithms of thermally activated quantities, as index and order n of
    /// the factor exp(-n Q/R (1/T - 1/T₀)): 1 for a rate, -1 for a time. See [`crate::Arrhenius`].
    fn thermal_orders(&self) -> Vec<(usize, f64)> {
        Vec::new()
    }

    /// Returns true if the response depends on the temperature of the rod, which then must be
    /// stated.
    fn needs_temperature(&self) -> bool {
        false
    }

    /// θ of the model at its present parameters, with Young's modulus `modulus` \[Pa\].
    fn parameters(&self, modulus: f64) -> Vec<f64>;

    /// Candidates for starting values of θ if only `modulus` \[Pa\] and the duration of the record
    /// \[s\] are known, preferably spread over the decades of the damping. Not empty.
    fn starts(&self, modulus: f64, duration: f64) -> Vec<Vec<f64>>;

    /// The parameters as stated in the literature at θ, E first; gradients are with respect to all
    /// of θ.
    fn stated(&self, parameters: &[f64]) -> Vec<StatedParameter>;

    /// Sensitivity of each component of θ to length and density of the specimen; for ln E it is
    /// [`SpecimenSensitivity::OF_MODULUS`].
    fn specimen_sensitivities(&self, parameters: &[f64]) -> Vec<SpecimenSensitivity>;

    /// v_r [m/s] at the times of `rod`; `None` where θ is outside the model.
    fn response(&self, rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<Vec<f64>>;

    /// v_r with its derivatives; `None` where θ is outside the model.
    fn linearised_response(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
    ) -> Option<LinearisedResponse>;

    /// ∂v_r/∂v_e at the times of `rod` with respect to the samples with these indices, one column
    /// per sample, for changes of the order of `change` [m/s]; `None` where θ is outside the model.
    /// By default, they come from differences of [`Self::response`].
    fn by_samples(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
        samples: &[usize],
        change: f64,
    ) -> Option<Vec<Vec<f64>>> {
        differences_by_samples(self, rod, parameters, samples, change)
    }

    /// The equivalent Prony series at θ, if there is one.
    fn prony(&self, _parameters: &[f64]) -> Option<PronySeries> {
        None
    }

    /// The position of `series` among the limits of this model; `None` if the model does not
    /// contain it.
    fn special_case(&self, _series: &PronySeries) -> Option<SpecialCase> {
        None
    }
}

/// [`RodModel::by_samples`] from differences of the response.
pub(crate) fn differences_by_samples<M: RodModel + ?Sized>(
    model: &M,
    rod: &DrivenRod<'_>,
    parameters: &[f64],
    samples: &[usize],
    step: f64,
) -> Option<Vec<Vec<f64>>> {
    let base = response_of(model, rod, parameters)?;
    map_in_order(samples, |at| {
        let mut changed = rod.samples.to_vec();
        *changed.get_mut(*at)? += step;
        let excitation = SampledHistory::new(&changed, rod.sampling_rate_hz).ok()?;
        let moved = DrivenRod {
            samples: &changed,
            excitation: &excitation,
            ..*rod
        };
        let response = response_of(model, &moved, parameters)?;
        let pairs = response.iter().zip(&base);
        Some(pairs.map(|(m, b)| (m - b) / step).collect())
    })
    .into_iter()
    .collect()
}

/// Times minus a delay \[s\]. Before time 0 the free end is at rest, as at time 0.
pub(crate) fn delayed(times: &[f64], delay: f64) -> Vec<f64> {
    times.iter().map(|t| (t - delay).max(0.0)).collect()
}

/// [`RodModel::response`] if it has the requested length.
pub(crate) fn response_of(
    model: &(impl RodModel + ?Sized),
    rod: &DrivenRod<'_>,
    parameters: &[f64],
) -> Option<Vec<f64>> {
    let response = model.response(rod, parameters)?;
    (response.len() == rod.times.len()).then_some(response)
}

/// [`RodModel::linearised_response`] if it has the requested lengths.
pub(crate) fn linearised_response_of(
    model: &(impl RodModel + ?Sized),
    rod: &DrivenRod<'_>,
    parameters: &[f64],
) -> Option<LinearisedResponse> {
    let response = model.linearised_response(rod, parameters)?;
    let times = rod.times.len();
    let fits = response.velocity.len() == times
        && response.by_parameter.len() == parameters.len()
        && response.by_parameter.iter().all(|by| by.len() == times);
    fits.then_some(response)
}

/// Accepts a model with equal numbers of limits, bounds, starting values and parameter names, and
/// bounds in ascending order.
pub(crate) fn check_counts(
    model: &dyn RodModel,
    modulus: f64,
    duration: f64,
) -> Result<(), MaxwellidError> {
    let names = model.parameter_names();
    let expected = names.len();
    let bounds = model.bounds();
    let counts = [
        ("step limits", model.step_limits().len()),
        ("bounds", bounds.len()),
        ("starting values", model.parameters(modulus).len()),
    ];
    let starts = model.starts(modulus, duration);
    let of_starts = starts.iter().map(|start| ("starting values", start.len()));
    let inconsistent = |(what, found)| MaxwellidError::InconsistentModel {
        model: model.name().to_owned(),
        what,
        found,
        expected,
    };
    if let Some(wrong) = counts
        .into_iter()
        .chain(of_starts)
        .find(|(_, found)| *found != expected)
    {
        return Err(inconsistent(wrong));
    }
    if let Some(index) = model.damping_parameter().filter(|index| *index >= expected) {
        return Err(inconsistent(("as index of the damping", index)));
    }
    match names
        .iter()
        .zip(bounds)
        .find(|(_, (low, high))| low.is_nan() || high.is_nan() || low > high)
    {
        None => Ok(()),
        Some((name, (low, high))) => Err(MaxwellidError::InvalidRange {
            parameter: (*name).to_owned(),
            low,
            high,
        }),
    }
}

/// Largest change of ln E in one iteration: half a period of the waveform at most.
pub(crate) const LOG_MODULUS_STEP: f64 = 0.1;

/// Bounds of E \[Pa\]: from softer than any gel to stiffer than diamond.
pub(crate) const MODULUS_BOUNDS: (f64, f64) = (1e3, 1e13);

/// Largest number of cells of a grid, a million.
const MOST_CELLS: f64 = 1_048_576.0;

/// Rejects a cell that is not a length, or so short that the grid of a rod of `length` \[m\]
/// exceeds the memory.
pub(crate) fn check_cell(cell: f64, length: f64) -> Result<(), MaxwellidError> {
    if cell.is_finite() && cell > 0.0 && length / cell <= MOST_CELLS {
        Ok(())
    } else {
        Err(MaxwellidError::Setting {
            setting: "cell of the grid [m]",
            value: cell,
            expected: "a finite value above 0, not below a millionth of the rod",
        })
    }
}

/// Relative rounding error of a number of cells.
const ROUNDING: f64 = 1e-12;

const FEWEST_CELLS: f64 = 16.0;

/// ln E as the first parameter of a model with `parameters` parameters.
#[must_use]
pub fn stated_modulus(parameters: &[f64]) -> StatedParameter {
    let mut gradient = vec![0.0; parameters.len()];
    if let Some(first) = gradient.first_mut() {
        *first = 1.0;
    }
    let modulus = parameters.first().map_or(f64::NAN, |t| t.exp());
    StatedParameter::ratio(["Young's modulus", "E", "Pa"], modulus, gradient)
}

/// Number of cells of the grid of a rod.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "lengths and cells are positive, and there are at most a million cells"
)]
pub(crate) fn cells_of(rod: &DrivenRod<'_>) -> Result<usize, MaxwellidError> {
    check_cell(rod.cell, rod.length)?;
    let cells = rod.length / rod.cell * (1.0 - ROUNDING);
    Ok(cells.ceil().max(FEWEST_CELLS) as usize)
}

/// Implements [`RodModel`] for a type by forwarding to the model that it contains.
macro_rules! forwarded_rod_model {
    ($type:ty, $this:ident => $to:expr) => {
        impl RodModel for $type {
            $crate::model::forwarded_rod_model! { $this => $to;
                name() -> &str;
                is_linear() -> bool;
                solver() -> &'static str;
                parameter_names() -> Vec<&str>;
                step_limits() -> Vec<f64>;
                bounds() -> Vec<(f64, f64)>;
                damping_parameter() -> Option<usize>;
                thermal_orders() -> Vec<(usize, f64)>;
                needs_temperature() -> bool;
                parameters(modulus: f64) -> Vec<f64>;
                starts(modulus: f64, duration: f64) -> Vec<Vec<f64>>;
                stated(parameters: &[f64]) -> Vec<StatedParameter>;
                specimen_sensitivities(parameters: &[f64]) -> Vec<SpecimenSensitivity>;
                response(rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<Vec<f64>>;
                linearised_response(
                    rod: &DrivenRod<'_>,
                    parameters: &[f64]
                ) -> Option<LinearisedResponse>;
                by_samples(
                    rod: &DrivenRod<'_>,
                    parameters: &[f64],
                    samples: &[usize],
                    change: f64
                ) -> Option<Vec<Vec<f64>>>;
                prony(parameters: &[f64]) -> Option<PronySeries>;
                special_case(series: &PronySeries) -> Option<SpecialCase>;
            }
        }
    };
    ($this:ident => $to:expr; $($method:ident($($argument:ident: $kind:ty),*) -> $out:ty;)*) => {$(
        fn $method(&self, $($argument: $kind),*) -> $out {
            let $this = self;
            $to.$method($($argument),*)
        }
    )*};
}
pub(crate) use forwarded_rod_model;

// a model chosen at run time
forwarded_rod_model!(Arc<dyn RodModel>, this => this.as_ref());

#[cfg(test)]
mod tests;
