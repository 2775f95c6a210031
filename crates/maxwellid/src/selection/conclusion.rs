//! Evidence of each candidate, for the same level and correlation of the noise, and the resulting
//! comparison.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::evidence::{Evidence, evidence};
use super::posterior::Posterior;
use super::{
    BEYOND_COMPARISON, Candidate, ComparedLaw, Comparison, Contest, DISTINCT_VELOCITIES, Found,
    Ground, Limit, Prior, Selection, least,
};
use crate::error::MaxwellidError;
use crate::test::RodTest;

/// Limits between which the sufficient standard error of ln Z is chosen.
const SUFFICIENT: (f64, f64) = (0.1, 0.5);

/// Relative change of level and correlation of the noise up to which the previous values are used
/// for all candidates. The resulting error of ln Z is about a third, the same for all candidates.
const SAME_NOISE: f64 = 1e-3;

/// The fit of a candidate for one level and correlation of the noise, with its evidence if that was
/// computed.
#[derive(Debug, Clone)]
pub(super) struct Weighed {
    /// Factor on the standard deviations of the noise, and divisor of χ² for correlation.
    noise: [f64; 2],
    probable: Posterior,
    /// ln Z by Laplace's method.
    laplace: f64,
    evidence: Option<Evidence>,
}

impl Selection {
    /// Returns the comparison from the results `found` for each candidate. `weighed` contains fits
    /// and evidences from a previous comparison of some candidates, which are reused if the noise
    /// is the same; afterwards it contains those of all candidates.
    pub(super) fn concluded(
        &self,
        tests: &[RodTest],
        ground: &Ground,
        found: &[Option<Found>],
        weighed: &mut Vec<Option<Weighed>>,
    ) -> Result<Comparison, MaxwellidError> {
        let samples: usize = ground.times.iter().map(Vec::len).sum();
        let least = least(found).ok_or(MaxwellidError::NoCandidate)?;
        let (mut inflation, _) = ground.inflation(least);
        let mut scale = self.noise_scale(least.chi_square, samples);
        if let Some([known_scale, known_inflation]) =
            weighed.iter().flatten().map(|w| w.noise).next()
            && (scale / known_scale - 1.0).abs() < SAME_NOISE
            && (inflation / known_inflation - 1.0).abs() < SAME_NOISE
        {
            (scale, inflation) = (known_scale, known_inflation);
        }
        let effective_samples = samples as f64 / inflation;
        // with fewer independent samples or more noise the residuals have less weight relative to
        // the priors
        let weight = 1.0 / (scale * inflation.sqrt());
        // the argument is χ² divided by `scale`² and by `inflation`
        let ln_likelihood =
            |chi_square: f64| self.ln_likelihood(chi_square * scale * scale, effective_samples);
        let priors: Vec<Prior> = self
            .candidates
            .iter()
            .map(|candidate| candidate.prior(ground.modulus, ground.duration))
            .collect();
        weighed.resize(found.len(), None);
        // ln Z from the fits with the previous noise
        let roughly = |found: &Found| {
            let chi_square = found.probable.chi_square * weight * weight;
            found.probable.ln_evidence(ln_likelihood(chi_square))
        };
        let rough_best = found.iter().flatten().map(roughly);
        let rough_best = rough_best.fold(f64::NEG_INFINITY, f64::max);
        let mut contestants = Vec::with_capacity(found.len());
        let each = self.candidates.iter().zip(found).zip(&priors);
        for (((candidate, found), prior), known) in each.zip(weighed.iter_mut()) {
            let Some(found) = found else { continue };
            let noise = [scale, inflation];
            known.take_if(|known| known.noise.map(f64::to_bits) != noise.map(f64::to_bits));
            let contest = Contest {
                weight,
                ..self.contest(candidate, prior, (tests, &ground.times), f64::INFINITY)
            };
            if known.is_none() {
                let rough = roughly(found);
                let is_new = (weight - 1.0).abs() > 1e-12;
                // a law that is excluded already is not fitted again
                let again = is_new && rough >= rough_best - BEYOND_COMPARISON;
                let probable = if again {
                    contest.near_fit(&found.probable)?
                } else {
                    Some(found.probable.clone())
                };
                let of_fit = |fit: &Posterior| fit.ln_evidence(ln_likelihood(fit.chi_square));
                *known = probable.map(|probable| Weighed {
                    noise,
                    laplace: if again { of_fit(&probable) } else { rough },
                    probable,
                    evidence: None,
                });
            }
            let Some(known) = known else { continue };
            contestants.push((candidate, found, contest, known));
        }
        let all_laplace: Vec<f64> = contestants.iter().map(|(.., k)| k.laplace).collect();
        let best = all_laplace.iter().copied();
        let best = best.fold(f64::NEG_INFINITY, f64::max);
        let mut compared = Vec::with_capacity(contestants.len());
        let mut of_compared = Vec::with_capacity(contestants.len());
        for (candidate, found, contest, known) in contestants {
            let (probable, laplace) = (known.probable.clone(), known.laplace);
            let sufficient = sufficient_error(laplace, &all_laplace);
            let evidence = if laplace < best - BEYOND_COMPARISON {
                Evidence {
                    ln: laplace,
                    error: 0.0,
                }
            } else if let Some(evidence) = known.evidence.filter(|known| known.error < sufficient) {
                evidence
            } else {
                let Some(seen) = contest.seen_at(&probable) else {
                    continue;
                };
                let problem = contest.problem(&seen);
                let found = evidence(&problem, &probable, (&ln_likelihood, sufficient)).ok_or(
                    MaxwellidError::Decomposition {
                        iteration: probable.minimum.iterations,
                    },
                )?;
                *known.evidence.insert(found)
            };
            let chi_square = found.likeliest.chi_square / inflation;
            let names = candidate.model.parameter_names();
            of_compared.push(candidate);
            compared.push(ComparedLaw {
                name: candidate.name().to_owned(),
                law: candidate.law(),
                is_linear: candidate.model.is_linear(),
                is_flat_loss: candidate.is_flat_loss(),
                parameter_names: names.iter().map(ToString::to_string).collect(),
                chi_square,
                adequacy: self.adequacy(chi_square, effective_samples - probable.determined),
                ln_evidence: evidence.ln,
                ln_evidence_error: evidence.error,
                probability: 0.0,
                determined: probable.determined,
                termination: probable.minimum.termination,
                is_settled: probable.is_settled && found.likeliest.is_settled,
                parameters: probable.minimum.parameters,
                likeliest: found.likeliest.parameters.clone(),
                limits: Vec::new(),
                weight: candidate.weight(),
            });
        }
        let limits = limits(&of_compared, &compared, scale);
        for (law, limits) in compared.iter_mut().zip(limits) {
            law.limits = limits;
        }
        if compared.is_empty() {
            return Err(MaxwellidError::NoCandidate);
        }
        let velocities = tests.iter().map(|test| test.impact_velocity);
        let (slowest, fastest) = velocities.fold((f64::INFINITY, 0.0), |(low, high), v| {
            (f64::min(low, v), f64::max(high, v))
        });
        Ok(self.decide(
            compared,
            effective_samples,
            inflation,
            slowest,
            fastest >= DISTINCT_VELOCITIES * slowest,
        ))
    }
}

/// Standard error of ln Z that is sufficient for a law whose ln Z by Laplace's method is `laplace`,
/// among `all` laws: within [`SUFFICIENT`], a tenth of the distance of the law from the best one,
/// or of the distance of the best one from the second if that is larger.
fn sufficient_error(laplace: f64, all: &[f64]) -> f64 {
    let mut sorted = all.to_vec();
    sorted.sort_by(|a, b| b.total_cmp(a));
    let best = sorted.first().copied().unwrap_or(laplace);
    let next = sorted.get(1).copied().unwrap_or(f64::NEG_INFINITY);
    let distance = (best - laplace).max(best - next);
    (0.1 * distance).clamp(SUFFICIENT.0, SUFFICIENT.1)
}

/// Special cases of each law that the data do not distinguish from the law, those with the fewest
/// parameters first. The standard deviation of the noise is `scale` times the assumed one.
fn limits(candidates: &[&Candidate], laws: &[ComparedLaw], scale: f64) -> Vec<Vec<Limit>> {
    candidates
        .iter()
        .zip(laws)
        .map(|(candidate, general)| {
            let specials = candidates.iter().zip(laws);
            let mut limits: Vec<(usize, Limit)> = specials
                .filter(|(_, special)| special.likeliest.len() < general.likeliest.len())
                .filter_map(|(of_special, special)| {
                    let case = candidate.at_limit(of_special, &special.likeliest)?;
                    let dropped = general.likeliest.len() - special.likeliest.len();
                    let quantile = ChiSquared::new(dropped as f64).ok()?.inverse_cdf(0.95);
                    let rise = special.chi_square - general.chi_square;
                    (rise <= quantile * scale * scale).then(|| {
                        (
                            special.likeliest.len(),
                            Limit {
                                special: special.name.clone(),
                                limit: case.limit,
                            },
                        )
                    })
                })
                .collect();
            limits.sort_by_key(|(parameters, _)| *parameters);
            limits.into_iter().map(|(_, limit)| limit).collect()
        })
        .collect()
}
