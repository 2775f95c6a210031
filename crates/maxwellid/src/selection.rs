//! Selection of the law that the data support, if they permit a decision.
//!
//! # Problem
//! Several laws M_i are candidates. The comparison finds the probability of each law given the
//! tests, and whether any of the laws explains the data.
//!
//! # Method
//! Each candidate is fitted with its prior, and its evidence is found by importance sampling about
//! the maximum
//!
//! ```text
//! Z_i = ∫ L π dθ ,    P(M_i) = w_i Z_i / Σ w_k Z_k
//! ```
//!
//! with L the likelihood of the residual and w the prior weights of the laws. The covariance C of
//! the residual contains the noise of both histories; the noise of the excitation is propagated
//! through each candidate's rod at its most probable excitation. Excitation and covariance are
//! re-estimated for every candidate until its χ² no longer changes. A parameter that the data do
//! not determine does not reduce ln Z; a parameter that they determine reduces it by the logarithm
//! of the factor by which they narrow the prior (Occam's factor).
//!
//! Grids are refined until the error of the solver is small compared with the noise; a larger error
//! would refute the right law in records of low noise.
//!
//! A law that contains another as a limit is also fitted from this limit, so that its fit is never
//! worse. χ² and adequacy are those of the likeliest parameters, without the prior.
//!
//! For known noise ln L = -½ χ². For noise estimated from q samples at rest, the unknown factor
//! common to all noise levels is marginalised, ln L = -½ (n + q) ln(1 + χ²/q) with n samples. If
//! the residual of the best candidate has further correlation ρ_l at lag l, beyond that in C, n and
//! χ² are divided by 1 + 2 Σ ρ_l.
//!
//! # Decision
//! 1. If χ² of the best candidate has a probability below 0.001 (chi-square, or F with q), the
//!    answer is *none of these*.
//! 2. If no candidate has a probability of 0.95, the answer is *cannot tell*, with the candidates
//!    in question.
//! 3. If a nonlinear law leads and all tests have one impact velocity, the answer is *cannot tell*,
//!    with the advice to repeat at another velocity, unless a linear law with a flat loss is among
//!    the candidates and is refuted by its χ².
//!
//! Both levels can be set. The paper's own procedure (Ödeen 1993, paper D, section 2.2) is in
//! [`crate::adequacy`]; it is of historical interest, and no decision is based on it.
//!
//! # Limitations
//! If a posterior has several separate peaks, the evidence is that of the highest peak found. C
//! contains the errors of the length and of the sensors only if the tests state them; C does not
//! contain the error of the density.
//!
//! Theory: `docs/theory/model-identification.md`.

mod candidate;
mod comparison;
mod conclusion;
mod decision;
mod evidence;
mod posterior;
mod seen_test;
mod verdict;

pub use candidate::Candidate;
pub use comparison::{ComparedLaw, Comparison, Limit};
pub use decision::{Advice, Decision, Doubt};

pub(crate) use candidate::Prior;
pub(crate) use posterior::Contest;

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

use crate::error::{MaxwellidError, check_positive};
use crate::identifiability::correlation_inflation;
use crate::least_squares::LeastSquares;
use crate::model::{DEFAULT_CELL, check_cell};
use crate::noise::quiet_degrees;
use crate::test::{RodTest, check_distinct, check_temperatures, modulus_of_all};
use posterior::{Likeliest, Limiting, Posterior, PosteriorProblem, Searched};

/// Settings of a comparison of candidates.
///
/// ```
/// use maxwellid::selection::{Candidate, Selection};
/// use maxwellid::{Law, Provenance, RodTest, RodTestData};
/// use rodwave::InelasticRod;
/// use rodwave::band_limited::SampledHistory;
/// use rodwave::inelastic::Maxwell;
/// use rodwave::lumped::{self, LumpedRod};
///
/// let rate = 51_200.0;
/// let excitation: Vec<f64> = (0..140)
///     .map(|k| 8.0 * (-((f64::from(k) - 35.0) / 4.0_f64).powi(2)).exp())
///     .collect();
/// let times: Vec<f64> = (0..140).map(|k| f64::from(k) / rate).collect();
/// let rod = InelasticRod::new(0.391, 1140.0, 3.209e9, Maxwell::new(2e6)?)?;
/// let response = LumpedRod::new(&rod, 400, 0.5)?
///     .free_end_velocity(&SampledHistory::new(&excitation, rate)?, &times)?;
/// let test = RodTest::new(RodTestData {
///     name: "virtual".into(),
///     length: 0.391,
///     density: 1140.0,
///     impact_velocity: 10.0,
///     sampling_rate_hz: rate,
///     excitation,
///     response,
///     provenance: Provenance::Virtual { generator: lumped::GENERATOR.into() },
/// })?
/// .with_noise(0.05, 0.05)?;
///
/// let laws = [Law::Elastic, Law::Maxwell, Law::ConstantQ].map(Candidate::of);
/// let comparison = Selection::new(laws.to_vec())?.compare(&[test])?;
/// assert_eq!(comparison.law().and_then(|found| found.law), Some(Law::Maxwell));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Selection {
    candidates: Vec<Candidate>,
    further: Vec<Candidate>,
    noise_samples: Option<f64>,
    cell: f64,
    required_probability: f64,
    adequacy_level: f64,
}

/// Ratio of two impact velocities below which they are treated as one velocity.
pub const DISTINCT_VELOCITIES: f64 = 1.2;

/// Probability of the misfit of a law below which the law is refuted, unless another level is set.
pub const ADEQUACY_LEVEL: f64 = 1e-3;

/// Difference of ln Z (Laplace's method) from the best law beyond which a law is discarded without
/// importance sampling: a probability of e^-40, while ln Z of the two methods differs by a few
/// units at most.
const BEYOND_COMPARISON: f64 = 40.0;

/// Largest permitted sum over all samples of the squared error of the grid, in units of the
/// variance of the noise: χ² of the right law rises by this amount on average.
const GRID_ERROR: f64 = 2.0;

/// Largest number of refinements of the grid, and smallest ratio of a cell to that of the previous
/// grid.
const REFINEMENTS: usize = 3;
const SHORTEST_SHARE: f64 = 0.25;

/// Probability of a misfit, relative to the level of adequacy, below which no finer grid makes a
/// law adequate.
const REFUTED: f64 = 1e-3;

/// Shortest cell of a grid refined because of [`GRID_ERROR`] \[m\].
const SHORTEST_CELL: f64 = 0.5e-3;

impl Selection {
    /// Creates a comparison of these candidates. Noise that the tests state is treated as known;
    /// noise that all tests have estimated from their quiet parts is treated as estimated from the
    /// samples of these parts.
    ///
    /// # Errors
    /// [`MaxwellidError::NoCandidate`].
    pub fn new(candidates: Vec<Candidate>) -> Result<Self, MaxwellidError> {
        if candidates.is_empty() {
            return Err(MaxwellidError::NoCandidate);
        }
        Ok(Self {
            candidates,
            further: Vec::new(),
            noise_samples: None,
            cell: DEFAULT_CELL,
            required_probability: 0.95,
            adequacy_level: ADEQUACY_LEVEL,
        })
    }

    /// Adds candidates that are compared only if the first ones leave a nonlinear law in question,
    /// or if none of the first ones explains the data. They follow the first candidates in the
    /// result, and the probabilities are those among all candidates.
    #[must_use]
    pub fn with_further(self, further: Vec<Candidate>) -> Self {
        Self { further, ..self }
    }

    /// Sets the number of samples at rest from which the noise of the tests was estimated. A factor
    /// common to all noise levels is then uncertain and is marginalised. With 0 only the ratios of
    /// the noise levels are known, and no law can be refuted by its misfit.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless it is finite and not negative.
    pub fn with_noise_of(self, samples: f64) -> Result<Self, MaxwellidError> {
        if !(samples.is_finite() && samples >= 0.0) {
            return Err(MaxwellidError::Setting {
                setting: "number of samples from which the noise was estimated",
                value: samples,
                expected: "a finite value not below 0",
            });
        }
        Ok(Self {
            noise_samples: Some(samples),
            ..self
        })
    }

    /// Sets the longest cell of a grid \[m\]. Cells are shorter, down to 0.5 mm, where the error of
    /// the grid is not small compared with the noise.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless it is finite and above 0.
    pub fn with_cell(self, cell: f64) -> Result<Self, MaxwellidError> {
        check_positive("longest cell [m]", cell)?;
        Ok(Self { cell, ..self })
    }

    /// Sets the probability required to name a law, and the adequacy below which a law is refuted.
    ///
    /// # Errors
    /// [`MaxwellidError::Setting`] unless the first is at least one half and both are below 1 and
    /// above 0.
    pub fn with_levels(
        self,
        required_probability: f64,
        adequacy_level: f64,
    ) -> Result<Self, MaxwellidError> {
        for (setting, value, least) in [
            ("required probability", required_probability, 0.5),
            ("level of adequacy", adequacy_level, 0.0),
        ] {
            if !(value >= least && value > 0.0 && value < 1.0) {
                return Err(MaxwellidError::Setting {
                    setting,
                    value,
                    expected: "below 1 and above 0, a required probability not below 0.5",
                });
            }
        }
        Ok(Self {
            required_probability,
            adequacy_level,
            ..self
        })
    }

    /// The candidates, in the order of all results.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    /// Compares the candidates on all `tests` together.
    ///
    /// # Errors
    /// [`MaxwellidError`] if there is no test, no arrival to start from, no noise stated, too few
    /// samples, an inconsistent model, or if no candidate exists at any start.
    pub fn compare(&self, tests: &[RodTest]) -> Result<Comparison, MaxwellidError> {
        match quiet_degrees(tests) {
            Some(samples) if self.noise_samples.is_none() => Self {
                noise_samples: Some(samples),
                ..self.clone()
            }
            .compared(tests),
            _ => self.compared(tests),
        }
    }

    fn compared(&self, tests: &[RodTest]) -> Result<Comparison, MaxwellidError> {
        for test in tests {
            check_cell(self.cell, test.length)?;
        }
        check_distinct(tests)?;
        let ground = Ground::of(tests)?;
        for candidate in self.candidates.iter().chain(&self.further) {
            candidate.check(&ground)?;
            check_temperatures(candidate.model.as_ref(), tests)?;
        }
        let samples: usize = ground.times.iter().map(Vec::len).sum();
        let most = self
            .candidates
            .iter()
            .map(|c| c.model.parameter_names().len());
        let parameters = most.max().unwrap_or(0);
        if samples <= parameters {
            return Err(MaxwellidError::TooFewSamples {
                samples,
                parameters,
            });
        }
        let (resolved, found) = self.resolved(tests, &ground, Vec::new())?;
        let mut weighed = Vec::new();
        let first = resolved.concluded(tests, &ground, &found, &mut weighed)?;
        if self.further.is_empty() || !first.asks_for_nonlinear_laws() {
            return Ok(first);
        }
        let all = Self {
            candidates: [self.candidates.as_slice(), &self.further].concat(),
            further: Vec::new(),
            ..resolved.clone()
        };
        let (all, found) = all.resolved(tests, &ground, found)?;
        if all.cell < resolved.cell {
            weighed.clear();
        }
        all.concluded(tests, &ground, &found, &mut weighed)
    }

    /// Returns the comparison with a cell that is short enough for the noise, and the result of
    /// [`Self::found`] with this cell.
    fn resolved(
        &self,
        tests: &[RodTest],
        ground: &Ground,
        known: Vec<Option<Found>>,
    ) -> Result<(Self, Vec<Option<Found>>), MaxwellidError> {
        let mut resolved = self.clone();
        let mut found = resolved.found(tests, ground, known)?;
        for _ in 0..REFINEMENTS {
            let Some(cell) = resolved.finer_cell(tests, ground, &found) else {
                break;
            };
            resolved.cell = cell;
            found = resolved.found(tests, ground, Vec::new())?;
        }
        Ok((resolved, found))
    }

    /// Returns a shorter cell \[m\] if the error of the present grid is not small compared with the
    /// noise for a nonlinear law that, without this error, may explain the data about as well as
    /// the best law. The grid is not refined for a law that is refuted even without the error of
    /// the grid.
    fn finer_cell(
        &self,
        tests: &[RodTest],
        ground: &Ground,
        found: &[Option<Found>],
    ) -> Option<f64> {
        let least = least(found)?;
        let best = least.chi_square;
        let (inflation, effective) = ground.inflation(least);
        let is_refuted = |chi_square: f64| {
            self.adequacy(chi_square / inflation, effective)
                .is_some_and(|probability| probability < REFUTED * self.adequacy_level)
        };
        let nonlinear = self.candidates.iter().zip(found);
        let nonlinear = nonlinear.filter(|(candidate, _)| !candidate.model.is_linear());
        let error = nonlinear
            .filter_map(|(candidate, found)| {
                let found = found.as_ref()?;
                let error = self.grid_error(candidate, (tests, ground), found)?;
                // the residual without the error of the grid is no smaller than this
                let rest = (found.likeliest.chi_square.sqrt() - error.sqrt()).max(0.0);
                let rest = rest * rest;
                (rest <= best + 2.0 * BEYOND_COMPARISON && !is_refuted(rest)).then_some(error)
            })
            .fold(0.0, f64::max);
        let cell = self.cell * (GRID_ERROR / error).powf(0.25).max(SHORTEST_SHARE);
        let cell = cell.max(SHORTEST_CELL);
        (error > GRID_ERROR && cell < 0.9 * self.cell).then_some(cell)
    }

    /// Sum over all samples of the squared error of the grid, in units of the variance of the
    /// noise. The error, of second order in the cell, follows from the response on a grid of half
    /// the cell.
    fn grid_error(
        &self,
        candidate: &Candidate,
        (tests, ground): (&[RodTest], &Ground),
        found: &Found,
    ) -> Option<f64> {
        let prior = candidate.prior(ground.modulus, ground.duration);
        let contest = self.contest(candidate, &prior, (tests, &ground.times), f64::INFINITY);
        let seen = contest.seen_at(&found.probable)?;
        let parameters = &found.probable.minimum.parameters;
        let problem = contest.problem(&seen);
        let here = problem.residual(parameters)?;
        let finer = PosteriorProblem {
            cell: 0.5 * self.cell,
            ..problem
        };
        let there = finer.residual(parameters)?;
        let pairs = here.iter().zip(&there);
        let square: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
        Some((4.0_f64 / 3.0).powi(2) * square)
    }

    /// Finds the most probable and the likeliest parameters of each candidate, in their order;
    /// `known` are the results of the first candidates.
    ///
    /// Candidates are processed by their number of parameters, so that a special case is known
    /// before the law that contains it. Linear laws come first, because the best linear law
    /// provides the nonlinear laws with a start for E.
    #[allow(
        clippy::indexing_slicing,
        reason = "`order` contains indices of candidates, and `found` has one entry per candidate"
    )]
    fn found(
        &self,
        tests: &[RodTest],
        ground: &Ground,
        known: Vec<Option<Found>>,
    ) -> Result<Vec<Option<Found>>, MaxwellidError> {
        let size = |candidate: &Candidate| candidate.model.parameter_names().len();
        let mut modulus = ground.modulus;
        let first = known.len();
        let mut found = known;
        found.resize(self.candidates.len(), None);
        for linear in [true, false] {
            let mut order: Vec<usize> = (first..self.candidates.len()).collect();
            order.retain(|index| self.candidates[*index].model.is_linear() == linear);
            // the order of processing does not depend on the order in which the candidates are
            // stated
            order.sort_by_key(|index| {
                let candidate = &self.candidates[*index];
                (size(candidate), candidate.name())
            });
            for index in order {
                let candidate = &self.candidates[index];
                let prior = candidate.prior(ground.modulus, ground.duration);
                let hopeless = self.hopeless(&found, ground);
                let contest = self.contest(candidate, &prior, (tests, &ground.times), hopeless);
                let special_cases: Vec<Limiting<'_>> = self
                    .candidates
                    .iter()
                    .zip(&found)
                    .filter(|(special, _)| size(special) < size(candidate))
                    .filter_map(|(special, found)| {
                        let Found {
                            probable,
                            likeliest,
                        } = found.as_ref()?;
                        let case = candidate.at_limit(special, &likeliest.parameters)?;
                        Some(Limiting {
                            parameters: case.parameters,
                            chi_square: likeliest.chi_square,
                            probable: (special.model.is_linear() == linear).then_some(probable),
                        })
                    })
                    .collect();
                let searched = contest.search(modulus, ground.duration, &special_cases)?;
                let Some(Searched { probable, of_case }) = searched else {
                    continue;
                };
                let Some(likeliest) = contest.likeliest(&probable, &special_cases)? else {
                    continue;
                };
                // the best fit may be near another maximum of the probability
                let other = if likeliest.of_case.is_some() && likeliest.of_case != of_case {
                    contest.from(&likeliest.parameters)?
                } else {
                    None
                };
                found[index] = Posterior::better(Some(probable), other).map(|probable| Found {
                    probable,
                    likeliest,
                });
            }
            let best = found
                .iter()
                .flatten()
                .min_by(|a, b| a.likeliest.chi_square.total_cmp(&b.likeliest.chi_square));
            if let Some(first) = best.and_then(|best| best.likeliest.parameters.first()) {
                modulus = first.exp();
            }
        }
        Ok(found)
    }

    fn contest<'a>(
        &self,
        candidate: &'a Candidate,
        prior: &'a Prior,
        (tests, times): (&'a [RodTest], &'a [Vec<f64>]),
        hopeless: f64,
    ) -> Contest<'a> {
        Contest {
            hopeless,
            ..Contest::of(candidate, prior, (tests, times), self.cell)
        }
    }

    /// χ² beyond which excitation and covariance of a candidate are not re-estimated again, given
    /// the candidates `found`: ln L is below the best one by twice [`BEYOND_COMPARISON`].
    fn hopeless(&self, found: &[Option<Found>], ground: &Ground) -> f64 {
        let Some(least) = least(found) else {
            return f64::INFINITY;
        };
        let (inflation, effective) = ground.inflation(least);
        let fall = 4.0 * BEYOND_COMPARISON;
        match self.noise_samples {
            None => least.chi_square + fall * inflation,
            // 1 + χ²/q is multiplied by this exponential
            Some(q) => (q + least.chi_square) * (fall / (effective + q)).exp() - q,
        }
    }

    /// Factor on the standard deviations of the noise, from quiet samples and residual together; 1
    /// if the noise is known.
    fn noise_scale(&self, chi_square: f64, samples: usize) -> f64 {
        self.noise_samples
            .map_or(1.0, |q| ((q + chi_square) / (q + samples as f64)).sqrt())
    }

    fn ln_likelihood(&self, chi_square: f64, samples: f64) -> f64 {
        match self.noise_samples {
            None => -0.5 * chi_square,
            Some(q) if q > 0.0 => -0.5 * (samples + q) * (chi_square / q).ln_1p(),
            // only the ratios of the noise levels are known
            Some(_) => -0.5 * samples * chi_square.ln(),
        }
    }

    /// Probability of a misfit at least this large if the candidate were true; `None` if the level
    /// of the noise is not known.
    fn adequacy(&self, chi_square: f64, degrees: f64) -> Option<f64> {
        match self.noise_samples {
            None => Some(ChiSquared::new(degrees).ok()?.sf(chi_square)),
            Some(q) if q > 0.0 => Some(
                FisherSnedecor::new(degrees, q)
                    .ok()?
                    .sf(chi_square / degrees),
            ),
            Some(_) => None,
        }
    }
}

/// Results for one candidate.
#[derive(Debug, Clone)]
struct Found {
    probable: Posterior,
    likeliest: Likeliest,
}

/// The best fit of all candidates.
fn least(found: &[Option<Found>]) -> Option<&Likeliest> {
    let fits = found.iter().flatten().map(|found| &found.likeliest);
    fits.min_by(|a, b| a.chi_square.total_cmp(&b.chi_square))
}

/// Quantities of the tests that are needed before a model is fitted.
pub(crate) struct Ground {
    pub(crate) times: Vec<Vec<f64>>,
    /// Modulus from the time of flight \[Pa\].
    pub(crate) modulus: f64,
    /// Duration of the longest window \[s\].
    pub(crate) duration: f64,
}

impl Ground {
    /// Factor by which autocorrelation reduces the number of independent samples of the residual of
    /// a fit, and the reduced number.
    fn inflation(&self, fit: &Likeliest) -> (f64, f64) {
        let lengths: Vec<usize> = self.times.iter().map(Vec::len).collect();
        let inflation = correlation_inflation(&fit.residual, &lengths);
        (inflation, lengths.iter().sum::<usize>() as f64 / inflation)
    }

    pub(crate) fn of(tests: &[RodTest]) -> Result<Self, MaxwellidError> {
        let modulus = modulus_of_all(tests)?;
        let times: Vec<Vec<f64>> = tests.iter().map(RodTest::times).collect();
        Ok(Self {
            modulus,
            duration: times
                .iter()
                .filter_map(|times| times.last().copied())
                .fold(0.0, f64::max),
            times,
        })
    }
}

#[cfg(test)]
mod tests;
