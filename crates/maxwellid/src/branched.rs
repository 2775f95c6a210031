//! A nonlinear branch in parallel with a spring, with linear branches, or with both.

use rodwave::InelasticRod;
use rodwave::band_limited::SamplePulses;
use rodwave::characteristics::{BranchedProblem, LinearBranch};

use crate::law::{IdentifiableLaw, Role, Scale, StatedParameter};
use crate::model::{
    DrivenRod, LOG_MODULUS_STEP, LinearisedResponse, MODULUS_BOUNDS, RodModel, cells_of,
    stated_modulus,
};
use crate::special_case::{NO_SHARE, PronySeries, SpecialCase, UNRELAXED};
use crate::specimen::SpecimenSensitivity;

/// Bounds of the logarithm of a ratio of shares.
const SHARE_BOUNDS: (f64, f64) = (-14.0, 14.0);

/// Bounds of the logarithm of a relaxation time in s.
const TIME_BOUNDS: (f64, f64) = (-25.0, 5.0);

/// Relaxation time \[s\] from which a linear branch starts: within a record, and faster than its
/// nonlinear neighbour.
const LINEAR_TIME: f64 = 3e-5;

/// Names of the ratios of shares and of the relaxation times.
const RATIOS: [&str; 3] = ["ln_share_ratio_1", "ln_share_ratio_2", "ln_share_ratio_3"];
const TIMES: [&str; 2] = ["ln_relaxation_time_1", "ln_relaxation_time_2"];

/// A rod whose material is a branch with the law L, in parallel with a spring, with linear Maxwell
/// branches, or with both:
///
/// ```text
/// σ = Σ σᵢ ,    ∂σᵢ/∂t = wᵢE (∂ε/∂t - Fᵢ(σᵢ)) ,    Σ wᵢ = 1
/// ```
///
/// E is the unrelaxed modulus, that of the front. With a spring the material has an equilibrium:
/// w₀E is left when all branches have relaxed. F of the last branch is that of the law L; its
/// reference rate is that at a stress of 10 MPa in this branch.
///
/// # Parameters
/// θ = (ln E, ln(wᵢ/w_first), ln τᵢ of the linear branches, parameters of L), where the first is the
/// spring if there is one, and else the first linear branch.
///
/// # Solver
/// [`BranchedProblem`], with exact derivatives. Tests made by it are refused ([`RodModel::solver`]).
#[derive(Debug, Clone)]
pub struct BranchedRod<L> {
    law: L,
    name: &'static str,
    has_spring: bool,
    linear: usize,
}

/// θ as physical quantities.
struct Material<L> {
    modulus: f64,
    /// w, the spring first and the nonlinear branch last.
    shares: Vec<f64>,
    /// τ of the linear branches \[s\].
    times: Vec<f64>,
    law: L,
}

impl<L: IdentifiableLaw> BranchedRod<L> {
    /// Creates a standard solid whose dashpot is that of `law`: a spring in parallel with one
    /// branch.
    #[must_use]
    pub fn standard_solid(law: L, name: &'static str) -> Self {
        Self {
            law,
            name,
            has_spring: true,
            linear: 0,
        }
    }

    /// Creates a linear Maxwell branch in parallel with one of `law`, without a spring.
    #[must_use]
    pub fn beside_maxwell(law: L, name: &'static str) -> Self {
        Self {
            law,
            name,
            has_spring: false,
            linear: 1,
        }
    }

    /// Adds a linear Maxwell branch, up to two in all: with a spring, the solid of Zhu, Wang and
    /// Tang with one dashpot that is nonlinear.
    #[must_use]
    pub fn with_linear_branch(self) -> Self {
        Self {
            linear: (self.linear + 1).min(TIMES.len()),
            ..self
        }
    }

    /// Number of branches, the spring included.
    fn components(&self) -> usize {
        usize::from(self.has_spring) + self.linear + 1
    }

    /// Number of parameters before those of the law.
    fn before_law(&self) -> usize {
        self.components() + self.linear
    }

    fn material(&self, parameters: &[f64]) -> Option<Material<L>> {
        let (of_branches, of_law) = parameters.split_at_checked(self.before_law())?;
        let (ln_modulus, of_branches) = of_branches.split_first()?;
        let (ratios, ln_times) = of_branches.split_at_checked(self.components() - 1)?;
        let weights = std::iter::once(1.0).chain(ratios.iter().map(|x| x.exp()));
        let sum: f64 = weights.clone().sum();
        Some(Material {
            modulus: ln_modulus.exp(),
            shares: weights.map(|weight| weight / sum).collect(),
            times: ln_times.iter().map(|t| t.exp()).collect(),
            law: self.law.with_parameters(of_law).ok()?,
        })
    }

    fn names(&self) -> impl Iterator<Item = &'static str> {
        let ratios = RATIOS.into_iter().take(self.components() - 1);
        let times = TIMES.into_iter().take(self.linear);
        std::iter::once("ln_modulus")
            .chain(ratios)
            .chain(times)
            .chain(L::PARAMETERS.iter().copied())
    }
}

impl<L: IdentifiableLaw> BranchedRod<L> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cell count of at most a million"
    )]
    fn problem(&self, rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<BranchedProblem<L>> {
        let Material {
            modulus,
            shares,
            times,
            law,
        } = self.material(parameters)?;
        let cells = cells_of(rod).ok()? as usize;
        let mut of_branches = InelasticRod::new(rod.length, rod.density, modulus, law).ok()?;
        let mut shares = shares.into_iter();
        if self.has_spring {
            of_branches = of_branches.with_spring(shares.next()?).ok()?;
        }
        let linear = times.into_iter().zip(shares);
        let linear = linear.map(|(time, share)| LinearBranch { share, time });
        BranchedProblem::new(of_branches, linear.collect(), cells).ok()
    }
}

impl<L: IdentifiableLaw> RodModel for BranchedRod<L> {
    fn name(&self) -> &str {
        self.name
    }

    fn is_linear(&self) -> bool {
        L::LINEAR
    }

    fn solver(&self) -> &'static str {
        rodwave::characteristics::GENERATOR
    }

    fn parameter_names(&self) -> Vec<&str> {
        self.names().collect()
    }

    fn step_limits(&self) -> Vec<f64> {
        let of_branches = std::iter::repeat_n(1.0, self.before_law() - 1);
        std::iter::once(LOG_MODULUS_STEP)
            .chain(of_branches)
            .chain(L::STEP_LIMITS.iter().copied())
            .collect()
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        std::iter::once((MODULUS_BOUNDS.0.ln(), MODULUS_BOUNDS.1.ln()))
            .chain(std::iter::repeat_n(SHARE_BOUNDS, self.components() - 1))
            .chain(std::iter::repeat_n(TIME_BOUNDS, self.linear))
            .chain(self.law.parameter_bounds())
            .collect()
    }

    fn thermal_orders(&self) -> Vec<(usize, f64)> {
        let times = self.before_law() - self.linear..self.before_law();
        let rate = self.damping_parameter().map(|rate| (rate, 1.0));
        times.map(|time| (time, -1.0)).chain(rate).collect()
    }

    fn damping_parameter(&self) -> Option<usize> {
        (!L::PARAMETERS.is_empty()).then_some(self.before_law() + L::PARAMETERS.len() - 1)
    }

    fn parameters(&self, modulus: f64) -> Vec<f64> {
        std::iter::once(modulus.ln())
            .chain(std::iter::repeat_n(0.0, self.components() - 1))
            .chain(std::iter::repeat_n(LINEAR_TIME.ln(), self.linear))
            .chain(rodwave::inelastic::InelasticLaw::parameters(&self.law))
            .collect()
    }

    /// Returns rates in steps of a decade, as for the law alone, each with several shares of its
    /// branch.
    fn starts(&self, modulus: f64, duration: f64) -> Vec<Vec<f64>> {
        let mut starts = Vec::new();
        for ratio in [0.1_f64, 0.5, 2.0] {
            let linear = self.linear as f64;
            // linear branches start with a tenth of the first component
            let of_linear = if self.has_spring {
                linear
            } else {
                linear - 1.0
            };
            let share = ratio / (1.0 + ratio + 0.1 * of_linear);
            for decade in -2..=4 {
                let time = duration * 10.0_f64.powi(decade);
                let rate = self.law.reference_stress() / (share * modulus * time);
                let Some(law) = self.law.at_rate(rate) else {
                    continue;
                };
                let others = std::iter::repeat_n(0.1_f64.ln(), self.components() - 2);
                starts.push(
                    std::iter::once(modulus.ln())
                        .chain(others)
                        .chain([ratio.ln()])
                        .chain(std::iter::repeat_n(LINEAR_TIME.ln(), self.linear))
                        .chain(rodwave::inelastic::InelasticLaw::parameters(&law))
                        .collect(),
                );
            }
        }
        if starts.is_empty() {
            starts.push(RodModel::parameters(self, modulus));
        }
        starts
    }

    fn stated(&self, parameters: &[f64]) -> Vec<StatedParameter> {
        let mut stated = vec![stated_modulus(parameters)];
        let Some(material) = self.material(parameters) else {
            return stated;
        };
        let components = self.components();
        // d ln wᵢ/dx_k = δ_ik - w_k
        let of_share = |index: usize| -> Vec<f64> {
            let mut gradient = vec![0.0; parameters.len()];
            let places = gradient
                .iter_mut()
                .skip(1)
                .zip(material.shares.iter().skip(1));
            for ((value, share), other) in places.zip(1..) {
                *value = if other == index { 1.0 } else { 0.0 } - share;
            }
            gradient
        };
        let named = [
            ("share of the spring in the modulus", "w_0"),
            ("share of the linear branch in the modulus", "w_1"),
            ("share of the second linear branch in the modulus", "w_2"),
        ];
        let named = named.into_iter().skip(usize::from(!self.has_spring));
        let shares = material.shares.iter().take(components - 1).enumerate();
        for ((index, share), (name, symbol)) in shares.zip(named) {
            stated.push(StatedParameter {
                name,
                symbol,
                unit: "1",
                value: *share,
                scale: Scale::Ratio,
                gradient: of_share(index),
                role: Role::Coordinate,
            });
        }
        let times = material.times.iter().zip([
            ("relaxation time of the linear branch", "tau_1"),
            ("relaxation time of the second linear branch", "tau_2"),
        ]);
        for ((time, (name, symbol)), place) in times.zip(components..) {
            let mut gradient = vec![0.0; parameters.len()];
            if let Some(own) = gradient.get_mut(place) {
                *own = 1.0;
            }
            stated.push(StatedParameter {
                name,
                symbol,
                unit: "s",
                value: *time,
                scale: Scale::Ratio,
                gradient,
                role: Role::Coordinate,
            });
        }
        let before = self.before_law();
        stated.extend(material.law.stated().into_iter().map(|mut of_law| {
            of_law
                .gradient
                .splice(0..0, std::iter::repeat_n(0.0, before));
            of_law
        }));
        stated
    }

    fn specimen_sensitivities(&self, parameters: &[f64]) -> Vec<SpecimenSensitivity> {
        let of_law = self
            .material(parameters)
            .map(|material| material.law.specimen_sensitivities());
        let unmoved = std::iter::repeat_n(SpecimenSensitivity::default(), self.before_law() - 1);
        std::iter::once(SpecimenSensitivity::OF_MODULUS)
            .chain(unmoved)
            .chain(of_law.unwrap_or_default())
            .collect()
    }

    fn response(&self, rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<Vec<f64>> {
        let problem = self.problem(rod, parameters)?;
        problem.free_end_velocity(rod.excitation, rod.times).ok()
    }

    fn linearised_response(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
    ) -> Option<LinearisedResponse> {
        let response = self
            .problem(rod, parameters)?
            .free_end_velocity_with_sensitivities(rod.excitation, rod.times)
            .ok()?;
        Some(LinearisedResponse {
            velocity: response.velocity,
            by_parameter: std::iter::once(response.by_log_modulus)
                .chain(response.by_log_ratio)
                .chain(response.by_log_time)
                .chain(response.by_parameter)
                .collect(),
        })
    }

    fn by_samples(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
        samples: &[usize],
        change: f64,
    ) -> Option<Vec<Vec<f64>>> {
        let pulses = SamplePulses::new(samples, rod.sampling_rate_hz).ok()?;
        self.problem(rod, parameters)?
            .free_end_velocity_by_samples(rod.excitation, &pulses, rod.times, change)
            .ok()
    }

    /// A standard solid contains the linear one, Maxwell's law and the elastic rod.
    fn special_case(&self, series: &PronySeries) -> Option<SpecialCase> {
        if !(self.has_spring && self.linear == 0) {
            return None;
        }
        let (share, time) = match series.branches.as_slice() {
            [] => (NO_SHARE, UNRELAXED),
            [branch] => (branch.share.max(NO_SHARE), branch.time),
            _ => return None,
        };
        let rate = self.law.reference_stress() / (share * series.modulus * time);
        let (law, limit) = self.law.at_linear_limit(rate)?;
        let limit = if series.branches.is_empty() {
            "without damping"
        } else {
            limit
        };
        Some(SpecialCase {
            parameters: [
                series.modulus.ln(),
                (share / series.spring.max(NO_SHARE)).ln(),
            ]
            .into_iter()
            .chain(rodwave::inelastic::InelasticLaw::parameters(&law))
            .collect(),
            limit: limit.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests;
