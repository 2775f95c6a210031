//! Design of the next test: to reduce the errors of the parameters, or to discriminate between two
//! laws.
//!
//! For a planned test the excitation is predicted, the response follows from a law, and the noise
//! of the instruments is stated. Then
//!
//! ```text
//! sharpening     cov(θ) = (S⁻² + Σ Jᵀ C⁻¹ J)⁻¹   over the tests made and the planned one
//! separation     E ln(Z_A/Z_B) ≈ ½ min over θ_B of χ²(data of A at θ̂_A)
//! ```
//!
//! The separation is the difference that remains after the second law has been fitted to the
//! response of the first in all tests, those made and the planned one: two laws may differ greatly
//! at fixed parameters and yet fit each other's responses.
//!
//! # Validity
//! The results are expectations at the present estimates, from the linearised problem. The
//! difference of Occam's factors, of order one, is neglected.
//!
//! Theory: `docs/theory/model-identification.md#planning-of-further-tests`.

use rodwave::InelasticRod;
use rodwave::experiment::Acquisition;
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::InelasticLaw;

use crate::common_error::ErrorOf;
use crate::error::{MaxwellidError, check_positive};
use crate::least_squares::{LeastSquares, ScaledDecomposition};
use crate::model::{check_cell, response_of};
use crate::selection::{Candidate, Contest, Ground};
use crate::test::{Provenance, RodTest, RodTestData, check_temperatures};

/// A planned test.
#[derive(Debug, Clone)]
pub struct PlannedTest {
    test: RodTest,
}

impl PlannedTest {
    /// Plans a test of a rod like that of `test`, at another impact velocity [m/s]: the excitation
    /// is scaled, and the noise of the instruments is kept.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless the velocity is finite and above 0.
    pub fn at_velocity(test: &RodTest, velocity: f64) -> Result<Self, MaxwellidError> {
        check_positive("planned impact velocity [m/s]", velocity)?;
        let factor = velocity / test.impact_velocity;
        let excitation: Vec<f64> = test.excitation_samples.iter().map(|v| v * factor).collect();
        Self::with_excitation(
            format!("{} at {velocity} m/s", test.name),
            (test.length, test.density, velocity),
            test.sampling_rate_hz,
            excitation,
        )
        .and_then(|planned| planned.with_instruments_of(test))
    }

    /// Plans a test with this `striker` on `rod`, of `diameter` \[m\], whose excitation is measured
    /// at a section `section_distance` \[m\] from the free end. The excitation is computed for the
    /// rod with its law in one-dimensional theory, as it would be recorded.
    ///
    /// # Errors
    /// [`MaxwellidError::InTest`] for errors of [`ImpactTest::record`] or [`RodTest::new`].
    pub fn of_striker<L: InelasticLaw>(
        striker: Striker,
        rod: InelasticRod<L>,
        diameter: f64,
        section_distance: f64,
        acquisition: &Acquisition,
    ) -> Result<Self, MaxwellidError> {
        let density = rod.density();
        let name = format!(
            "{:.3} m rod, section {section_distance:.3} m from its end, {} m/s",
            rod.length(),
            striker.velocity
        );
        let velocity = striker.velocity;
        let record = ImpactTest {
            striker,
            rod,
            diameter,
            section_distance,
        }
        .record(acquisition, CHAIN_CELL)
        .map_err(|source| MaxwellidError::InTest {
            test: name.clone(),
            source,
        })?;
        Self::with_excitation(
            name,
            (section_distance, density, velocity),
            record.sampling_rate_hz,
            record.excitation,
        )
    }

    fn with_excitation(
        name: String,
        (length, density, impact_velocity): (f64, f64, f64),
        sampling_rate_hz: f64,
        excitation: Vec<f64>,
    ) -> Result<Self, MaxwellidError> {
        let test = RodTest::new(RodTestData {
            name,
            length,
            density,
            impact_velocity,
            sampling_rate_hz,
            response: vec![0.0; excitation.len()],
            excitation,
            provenance: Provenance::Virtual {
                generator: GENERATOR.into(),
            },
        })?;
        Ok(Self { test })
    }

    /// Adopts the lateral inertia, the temperature and the instruments of an existing `test`: the
    /// noise, the errors of the transducers and the recorder. The errors of the rod are adopted
    /// too; the error of the length is shared with `test` only if both rods have the same length.
    ///
    /// # Errors
    /// The errors of [`RodTest::with_recorder`].
    pub fn with_instruments_of(mut self, test: &RodTest) -> Result<Self, MaxwellidError> {
        self.test.noise.clone_from(&test.noise);
        self.test.common_errors.clone_from(&test.common_errors);
        self.test.temperature = test.temperature;
        self.test.lateral_inertia = test.lateral_inertia;
        if (self.test.length - test.length).abs() > 0.0 {
            for error in &mut self.test.common_errors {
                if error.of == ErrorOf::Length {
                    error.shared_by.clone_from(&self.test.name);
                }
            }
        }
        if let Some(unfiltered) = test.unfiltered_excitation() {
            self.test = self.test.with_recorder(unfiltered.filter())?;
        }
        Ok(self)
    }

    /// Sets the noise [m/s] of the instruments.
    ///
    /// # Errors
    /// The errors of [`RodTest::with_noise`].
    pub fn with_noise(self, excitation: f64, response: f64) -> Result<Self, MaxwellidError> {
        Ok(Self {
            test: self.test.with_noise(excitation, response)?,
        })
    }

    /// Name of the test.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.test.name
    }
}

/// Cell size of the chain that predicts excitations \[m\].
const CHAIN_CELL: f64 = 1e-3;

/// Provenance of predicted responses.
const GENERATOR: &str = "maxwellid::design";

/// A law with its present estimate.
#[derive(Debug, Clone, Copy)]
pub struct Estimated<'a> {
    /// The law.
    pub candidate: &'a Candidate,
    /// Parameters, ln E first, as [`crate::selection::ComparedLaw::parameters`].
    pub parameters: &'a [f64],
}

impl Estimated<'_> {
    fn check(&self, ground: &Ground) -> Result<(), MaxwellidError> {
        self.candidate.check(ground)?;
        let expected = self.candidate.model().parameter_names().len();
        if self.parameters.len() != expected {
            return Err(MaxwellidError::InconsistentModel {
                model: self.candidate.name().to_owned(),
                what: "estimates",
                found: self.parameters.len(),
                expected,
            });
        }
        Ok(())
    }
}

/// The existing tests and the grid.
#[derive(Debug, Clone, Copy)]
pub struct Design<'a> {
    /// Existing tests.
    pub tests: &'a [RodTest],
    /// Longest cell of grids \[m\].
    pub cell: f64,
}

impl Design<'_> {
    /// Returns the standard errors of all parameters of a law, ln E first, including the tests
    /// `planned`; without planned tests, the present errors.
    ///
    /// # Errors
    /// [`MaxwellidError::NoCandidate`] if the law does not exist at its parameters;
    /// [`MaxwellidError::InconsistentModel`] if the number of parameters is not that of the law;
    /// [`MaxwellidError::NoTest`], [`MaxwellidError::NoArrival`] without an existing test.
    #[allow(
        clippy::indexing_slicing,
        reason = "a right singular vector has an entry for each deviation of the prior"
    )]
    pub fn deviations(
        &self,
        law: Estimated<'_>,
        planned: &[PlannedTest],
    ) -> Result<Vec<f64>, MaxwellidError> {
        let ground = Ground::of(self.tests)?;
        law.check(&ground)?;
        let tests = self.of_law(law, planned)?;
        let times: Vec<Vec<f64>> = tests.iter().map(RodTest::times).collect();
        let prior = law.candidate.prior(ground.modulus, ground.duration);
        let contest = Contest::of(law.candidate, &prior, (&tests, &times), self.cell);
        let seen = contest
            .seen(law.parameters)
            .ok_or(MaxwellidError::NoCandidate)?;
        let linearisation = contest
            .problem(&seen)
            .linearisation(law.parameters)
            .ok_or(MaxwellidError::NoCandidate)?;
        let svd = ScaledDecomposition::new(&linearisation, &prior.deviation)
            .ok_or(MaxwellidError::Decomposition { iteration: 0 })?;
        Ok(prior
            .deviation
            .iter()
            .enumerate()
            .map(|(index, deviation)| {
                let pairs = svd.right.iter().zip(&svd.singular_values);
                let variance: f64 = pairs.map(|(v, s)| (v[index] / s).powi(2)).sum();
                deviation * variance.sqrt()
            })
            .collect())
    }

    /// Returns the expected ln of the Bayes factor of `truth` over `rival`, including the tests
    /// `planned`; without planned tests, for the existing tests alone.
    ///
    /// # Errors
    /// The errors of [`Self::deviations`].
    pub fn separation(
        &self,
        truth: Estimated<'_>,
        rival: &Candidate,
        planned: &[PlannedTest],
    ) -> Result<f64, MaxwellidError> {
        let ground = Ground::of(self.tests)?;
        truth.check(&ground)?;
        rival.check(&ground)?;
        let tests = self.of_law(truth, planned)?;
        let times: Vec<Vec<f64>> = tests.iter().map(RodTest::times).collect();
        let prior = rival.prior(ground.modulus, ground.duration);
        let contest = Contest::of(rival, &prior, (&tests, &times), self.cell);
        let modulus = truth.parameters.first().map_or(ground.modulus, |t| t.exp());
        let found = contest
            .search(modulus, ground.duration, &[])?
            .ok_or(MaxwellidError::NoCandidate)?
            .probable;
        Ok(0.5 * found.chi_square)
    }

    /// Returns the misfit matrix: entry (i, j) is the separation of law i, assumed to be true, from
    /// law j, for the existing tests. Check it before you choose a law: laws with an off-diagonal
    /// entry near 0 cannot be distinguished.
    ///
    /// # Errors
    /// The errors of [`Self::separation`].
    pub fn separations(&self, laws: &[Estimated<'_>]) -> Result<Vec<Vec<f64>>, MaxwellidError> {
        laws.iter()
            .map(|truth| {
                laws.iter()
                    .map(|rival| self.separation(*truth, rival.candidate, &[]))
                    .collect()
            })
            .collect()
    }

    /// Ranks the planned tests by their separation of two laws, the best first.
    ///
    /// # Errors
    /// The errors of [`Self::separation`].
    pub fn rank(
        &self,
        truth: Estimated<'_>,
        rival: &Candidate,
        planned: &[PlannedTest],
    ) -> Result<Vec<(usize, f64)>, MaxwellidError> {
        let mut ranked = planned
            .iter()
            .enumerate()
            .map(|(index, test)| {
                let one = std::slice::from_ref(test);
                Ok((index, self.separation(truth, rival, one)?))
            })
            .collect::<Result<Vec<_>, MaxwellidError>>()?;
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(ranked)
    }

    /// Existing and planned tests, with the responses of a law.
    fn of_law(
        &self,
        law: Estimated<'_>,
        planned: &[PlannedTest],
    ) -> Result<Vec<RodTest>, MaxwellidError> {
        if self.tests.is_empty() {
            return Err(MaxwellidError::NoTest);
        }
        let all = || {
            self.tests
                .iter()
                .chain(planned.iter().map(|plan| &plan.test))
        };
        for test in all() {
            check_cell(self.cell, test.length)?;
        }
        all()
            .map(|test| {
                check_temperatures(law.candidate.model(), std::slice::from_ref(test))?;
                let times = test.times();
                let model = law.candidate.model();
                let rod = test.driven_rod(&times, self.cell);
                let response =
                    response_of(model, &rod, law.parameters).ok_or(MaxwellidError::NoCandidate)?;
                let mut of_law = test.clone();
                for (value, simulated) in of_law.response.iter_mut().zip(response) {
                    *value = simulated;
                }
                Ok(of_law)
            })
            .collect()
    }
}
