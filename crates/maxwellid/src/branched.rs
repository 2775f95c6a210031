//! A nonlinear branch in parallel with a spring, with linear branches, or with both.

use rodwave::InelasticRod;
use rodwave::band_limited::SamplePulses;
use rodwave::characteristics::{BranchedProblem, Direction};

use crate::law::{IdentifiableLaw, StatedParameter};
use crate::model::{
    DrivenRod, LOG_MODULUS_STEP, LinearisedResponse, MODULUS_BOUNDS, RodModel, cells_of,
    stated_modulus,
};
use crate::special_case::{NO_SHARE, PronySeries, SpecialCase, UNRELAXED};
use crate::specimen::SpecimenSensitivity;

mod neighbours;

use neighbours::{Composition, Neighbours};

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
/// spring if there is one, and else the first linear branch. In parallel with
/// [a flat loss factor](Self::beside_flat_loss) θ = (ln E, ln(w/(1-w)), ln tan δ, parameters of L).
///
/// # Solver
/// [`BranchedProblem`], with exact derivatives. Tests made by it are refused ([`RodModel::solver`]).
#[derive(Debug, Clone)]
pub struct BranchedRod<L> {
    law: L,
    name: &'static str,
    neighbours: Neighbours,
}

impl<L: IdentifiableLaw> BranchedRod<L> {
    /// Creates a standard solid whose dashpot is that of `law`: a spring in parallel with one
    /// branch.
    #[must_use]
    pub fn standard_solid(law: L, name: &'static str) -> Self {
        let neighbours = Neighbours::Branches {
            spring: true,
            linear: 0,
        };
        Self {
            law,
            name,
            neighbours,
        }
    }

    /// Creates a linear Maxwell branch in parallel with one of `law`, without a spring.
    #[must_use]
    pub fn beside_maxwell(law: L, name: &'static str) -> Self {
        let neighbours = Neighbours::Branches {
            spring: false,
            linear: 1,
        };
        Self {
            law,
            name,
            neighbours,
        }
    }

    /// Creates a branch of `law` in parallel with a linear material whose loss factor is constant to
    /// 1 % from 0.1 to 30 kHz.
    ///
    /// The linear material is a spring with seven Maxwell branches of fixed relaxation times. E is
    /// the modulus above all of them.
    #[must_use]
    pub fn beside_flat_loss(law: L, name: &'static str) -> Self {
        Self {
            law,
            name,
            neighbours: Neighbours::FlatLoss,
        }
    }

    /// Adds a linear Maxwell branch, up to two in all: with a spring, the solid of Zhu, Wang and
    /// Tang with one dashpot that is nonlinear. A flat loss factor has no further branch.
    #[must_use]
    pub fn with_linear_branch(self) -> Self {
        Self {
            neighbours: self.neighbours.with_linear_branch(),
            ..self
        }
    }

    /// Number of parameters before those of the law.
    fn before_law(&self) -> usize {
        1 + self.neighbours.count()
    }

    /// Modulus, neighbours and law at θ.
    fn material(&self, parameters: &[f64]) -> Option<(f64, Composition, L)> {
        let (of_branches, of_law) = parameters.split_at_checked(self.before_law())?;
        let (ln_modulus, of_neighbours) = of_branches.split_first()?;
        let composition = self.neighbours.at(of_neighbours)?;
        let law = self.law.with_parameters(of_law).ok()?;
        Some((ln_modulus.exp(), composition, law))
    }

    /// The direct problem at θ, with the directions of all parameters.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cell count of at most a million"
    )]
    fn problem(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
    ) -> Option<(BranchedProblem<L>, Vec<Direction>)> {
        let (modulus, composition, law) = self.material(parameters)?;
        let cells = cells_of(rod).ok()? as usize;
        let mut of_branches = InelasticRod::new(rod.length, rod.density, modulus, law).ok()?;
        if composition.spring > 0.0 {
            of_branches = of_branches.with_spring(composition.spring).ok()?;
        }
        let problem = BranchedProblem::new(of_branches, composition.linear, cells).ok()?;
        let directions = std::iter::once(Direction::LogModulus)
            .chain(composition.directions)
            .chain((0..L::PARAMETERS.len()).map(Direction::Parameter));
        Some((problem, directions.collect()))
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
        std::iter::once("ln_modulus")
            .chain(self.neighbours.names())
            .chain(L::PARAMETERS.iter().copied())
            .collect()
    }

    fn step_limits(&self) -> Vec<f64> {
        std::iter::once(LOG_MODULUS_STEP)
            .chain(std::iter::repeat_n(1.0, self.neighbours.count()))
            .chain(L::STEP_LIMITS.iter().copied())
            .collect()
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        std::iter::once((MODULUS_BOUNDS.0.ln(), MODULUS_BOUNDS.1.ln()))
            .chain(self.neighbours.bounds())
            .chain(self.law.parameter_bounds())
            .collect()
    }

    fn thermal_orders(&self) -> Vec<(usize, f64)> {
        let times = self.neighbours.places_of_times();
        let rate = self.damping_parameter().map(|rate| (rate, 1.0));
        times.map(|place| (1 + place, -1.0)).chain(rate).collect()
    }

    fn damping_parameter(&self) -> Option<usize> {
        (!L::PARAMETERS.is_empty()).then_some(self.before_law() + L::PARAMETERS.len() - 1)
    }

    fn parameters(&self, modulus: f64) -> Vec<f64> {
        let (of_neighbours, _) = self.neighbours.start(1.0);
        std::iter::once(modulus.ln())
            .chain(of_neighbours)
            .chain(rodwave::inelastic::InelasticLaw::parameters(&self.law))
            .collect()
    }

    /// Returns rates in steps of a decade, as for the law alone, each with several shares of its
    /// branch.
    fn starts(&self, modulus: f64, duration: f64) -> Vec<Vec<f64>> {
        let mut starts = Vec::new();
        for ratio in [0.1_f64, 0.5, 2.0] {
            let (of_neighbours, share) = self.neighbours.start(ratio);
            for decade in -2..=4 {
                let time = duration * 10.0_f64.powi(decade);
                let rate = self.law.reference_stress() / (share * modulus * time);
                let Some(law) = self.law.at_rate(rate) else {
                    continue;
                };
                starts.push(
                    std::iter::once(modulus.ln())
                        .chain(of_neighbours.iter().copied())
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
        let of_neighbours = parameters.get(1..self.before_law());
        let material = self.material(parameters).zip(of_neighbours);
        let Some(((_, composition, law), of_neighbours)) = material else {
            return stated;
        };
        let count = parameters.len();
        let of_neighbours = self.neighbours.stated(&composition, of_neighbours);
        let placed = |mut quantity: StatedParameter, before: usize| {
            let zeros = std::iter::repeat_n(0.0, before);
            quantity.gradient.splice(0..0, zeros);
            quantity.gradient.resize(count, 0.0);
            quantity
        };
        stated.extend(
            of_neighbours
                .into_iter()
                .map(|quantity| placed(quantity, 1)),
        );
        let before = self.before_law();
        let of_law = law.stated().into_iter();
        stated.extend(of_law.map(|quantity| placed(quantity, before)));
        stated
    }

    fn specimen_sensitivities(&self, parameters: &[f64]) -> Vec<SpecimenSensitivity> {
        let of_law = self
            .material(parameters)
            .map(|(_, _, law)| law.specimen_sensitivities());
        let unmoved = std::iter::repeat_n(SpecimenSensitivity::default(), self.before_law() - 1);
        std::iter::once(SpecimenSensitivity::OF_MODULUS)
            .chain(unmoved)
            .chain(of_law.unwrap_or_default())
            .collect()
    }

    fn response(&self, rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<Vec<f64>> {
        let (problem, _) = self.problem(rod, parameters)?;
        problem.free_end_velocity(rod.excitation, rod.times).ok()
    }

    fn linearised_response(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
    ) -> Option<LinearisedResponse> {
        let (problem, directions) = self.problem(rod, parameters)?;
        let (velocity, by_parameter) = problem
            .free_end_velocity_with_sensitivities(rod.excitation, rod.times, &directions)
            .ok()?;
        Some(LinearisedResponse {
            velocity,
            by_parameter,
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
        let (problem, _) = self.problem(rod, parameters)?;
        problem
            .free_end_velocity_by_samples(rod.excitation, &pulses, rod.times, change)
            .ok()
    }

    /// A standard solid contains the linear one, Maxwell's law and the elastic rod; a rod of flat
    /// loss the last two.
    fn special_case(&self, series: &PronySeries) -> Option<SpecialCase> {
        let (share, time) = match series.branches.as_slice() {
            [] => (NO_SHARE, UNRELAXED),
            [branch] => (branch.share.max(NO_SHARE), branch.time),
            _ => return None,
        };
        let of_neighbours = self.neighbours.beside_spring(share, series.spring)?;
        let rate = self.law.reference_stress() / (share * series.modulus * time);
        let (law, limit) = self.law.at_linear_limit(rate)?;
        let limit = if series.branches.is_empty() {
            "without damping"
        } else {
            limit
        };
        Some(SpecialCase {
            parameters: std::iter::once(series.modulus.ln())
                .chain(of_neighbours)
                .chain(rodwave::inelastic::InelasticLaw::parameters(&law))
                .collect(),
            limit: limit.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests;
