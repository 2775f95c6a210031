//! Stress against strain, of one shot or as the mean of several.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::curves::Curve;
use super::result::{HopkinsonResult, with_half_width};
use super::source::Source;
use super::student::StudentFactors;
use crate::ImpulseError;
use crate::error::{check_enough, check_probability};

/// Number of strains of a mean curve.
const PLACES: usize = 200;
/// Fraction of the largest strain rate below which a specimen no longer deforms: its stress then
/// falls at constant strain.
const SLOW: f64 = 0.2;
/// Fewest samples of a shot from the start of its loading to its largest strain.
const FEWEST: usize = 8;

/// Stress against strain of a shot, or the mean of several shots with the same bars on specimens of
/// the same kind.
///
/// Each curve is read at the same strains. At a given strain, an error of the strain acts as an
/// error of the stress,
///
/// ```math
/// \delta\sigma\big|_\varepsilon = \delta\sigma - \frac{d\sigma}{d\varepsilon}\,\delta\varepsilon .
/// ```
///
/// Noise, the measured size of each specimen and the specimens themselves differ from shot to shot:
/// together they are the scatter $`s`$. The other sources move all shots alike. The mean of $`n`$
/// shots has the variance $`s^2/n`$, with $`n - 1`$ degrees of freedom, plus the variance of the
/// mean effect of each shared source. For one shot the scatter is that of its noise and size.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MeanCurve {
    /// Engineering strain; `(n_places)`, like all other arrays.
    pub strain: Vec<f64>,
    /// Mean engineering stress \[Pa\].
    pub stress: Vec<f64>,
    /// Mean engineering strain rate [1/s].
    pub strain_rate: Vec<f64>,
    /// Standard deviation of the stress between shots \[Pa\].
    pub scatter: Vec<f64>,
    /// Standard deviation between shots that their own stated errors explain \[Pa\].
    pub explained: Vec<f64>,
    /// Standard error of the stress from the sources that all shots share \[Pa\].
    pub common: Vec<f64>,
    /// Number of shots.
    pub n_shots: usize,
    /// Degrees of freedom of the scatter.
    freedom: f64,
}

/// Stress and strain rate of a shot at given strains, with the effects of noise and sources on the
/// stress.
struct Read {
    stress: Vec<f64>,
    rate: Vec<f64>,
    own_variance: Vec<f64>,
    shared: Vec<(Source, Vec<f64>)>,
}

impl MeanCurve {
    /// Averages shots, up to the largest strain that all of them reach at a fifth of their largest
    /// strain rate or more.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::TooShort`] for no shot, or for a shot with fewer than eight samples of
    /// rising strain.
    pub fn of(shots: &[HopkinsonResult]) -> Result<Self, ImpulseError> {
        let freedom = match shots {
            [] => {
                return Err(ImpulseError::TooShort {
                    what: "list of shots",
                    found: 0,
                    expected: 1,
                });
            }
            [one] => one.degrees_of_freedom,
            several => (several.len() - 1) as f64,
        };
        let rising = shots.iter().map(rising).collect::<Result<Vec<_>, _>>()?;
        let edge = |samples: &[(f64, f64)], last: bool| {
            let sample = if last {
                samples.last()
            } else {
                samples.first()
            };
            sample.map_or(f64::NAN, |sample| sample.1)
        };
        let from = rising.iter().map(|samples| edge(samples, false));
        let from = from.fold(0.0_f64, f64::max);
        let to = rising.iter().map(|samples| edge(samples, true));
        let to = to.fold(f64::INFINITY, f64::min);
        let strain: Vec<f64> = (0..PLACES)
            .map(|at| from + (to - from) * at as f64 / (PLACES - 1) as f64)
            .collect();
        let read: Vec<Read> = shots
            .iter()
            .zip(&rising)
            .map(|(shot, samples)| Read::at(&strain, shot, samples))
            .collect();
        let n = shots.len() as f64;
        let mean = |of: &dyn Fn(&Read) -> f64| read.iter().map(of).sum::<f64>() / n;
        let mut curve = Self {
            n_shots: shots.len(),
            freedom,
            stress: Vec::with_capacity(PLACES),
            strain_rate: Vec::with_capacity(PLACES),
            scatter: Vec::with_capacity(PLACES),
            explained: Vec::with_capacity(PLACES),
            common: Vec::with_capacity(PLACES),
            strain: Vec::new(),
        };
        let mut shared: Vec<&Source> = Vec::new();
        for (source, _) in read.iter().flat_map(|read| &read.shared) {
            if !shared.contains(&source) {
                shared.push(source);
            }
        }
        for at in 0..PLACES {
            let value = |values: &[f64]| values.get(at).copied().unwrap_or(f64::NAN);
            let stress = mean(&|read| value(&read.stress));
            let squares = mean(&|read| (value(&read.stress) - stress).powi(2));
            let by = |source: &Source| {
                mean(&|read| {
                    let found = read.shared.iter().find(|(own, _)| own == source);
                    found.map_or(0.0, |(_, effect)| value(effect))
                })
            };
            let common: f64 = shared.iter().map(|source| by(source).powi(2)).sum();
            curve.stress.push(stress);
            curve.strain_rate.push(mean(&|read| value(&read.rate)));
            let explained = mean(&|read| value(&read.own_variance));
            curve.explained.push(explained.sqrt());
            let scatter = if shots.len() > 1 {
                squares * n / (n - 1.0)
            } else {
                explained
            };
            curve.scatter.push(scatter.sqrt());
            curve.common.push(common.sqrt());
        }
        curve.strain = strain;
        Ok(curve)
    }

    /// Standard error of the mean stress \[Pa\]; `(n_places)`.
    #[must_use]
    pub fn standard_error(&self) -> Vec<f64> {
        let root = (self.n_shots as f64).sqrt();
        let both = self.scatter.iter().zip(&self.common);
        both.map(|(scatter, common)| (scatter / root).hypot(*common))
            .collect()
    }

    /// Returns the half width of the band in which the mean stress lies with the probability
    /// `level`; `(n_places)`.
    ///
    /// Student's factor has $`(n - 1)\,u^4/(s^2/n)^2`$ degrees of freedom.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a level that is not between 0 and 1.
    pub fn expanded_uncertainty(&self, level: f64) -> Result<Vec<f64>, ImpulseError> {
        let root = (self.n_shots as f64).sqrt();
        let errors = self.standard_error();
        let factors = StudentFactors::new(self.freedom, level)?;
        let parts = errors.iter().zip(&self.scatter);
        Ok(parts
            .map(|(error, scatter)| factors.half_width(*error, scatter / root))
            .collect())
    }

    /// Returns the largest mean stress and the half width of its interval, as
    /// [`HopkinsonResult::largest_stress`] does.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a level that is not between 0 and 1.
    pub fn largest_stress(&self, level: f64) -> Result<(f64, f64), ImpulseError> {
        let widths = self.expanded_uncertainty(level)?;
        Ok(with_half_width(&self.stress, &widths))
    }

    /// Ratio of the variance between shots to that explained by their own errors, both averaged
    /// over strain.
    #[must_use]
    pub fn scatter_ratio(&self) -> f64 {
        let sum = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>();
        sum(&self.scatter) / sum(&self.explained)
    }

    /// Returns true if the probability that equal specimens scatter this much is below `chance`.
    ///
    /// The ratio of [variances](Self::scatter_ratio) multiplied by $`n - 1`$ is assumed to be
    /// distributed as $`\chi^2`$ with $`n - 1`$ degrees of freedom. This is valid if the shots
    /// differ by one number each, such as a diameter. If curves cross, they differ by more numbers,
    /// and the probability of a false result is lower than stated.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a probability that is not between 0 and 1.
    pub fn specimens_differ(&self, chance: f64) -> Result<bool, ImpulseError> {
        check_probability("probability of a scatter by chance", chance)?;
        if self.n_shots == 1 {
            return Ok(false);
        }
        let freedom = self.freedom;
        let limit = ChiSquared::new(freedom)
            .map_or(f64::INFINITY, |law| law.inverse_cdf(1.0 - chance) / freedom);
        Ok(self.scatter_ratio() > limit)
    }
}

/// Returns the samples and strains of a shot from its first load until it no longer deforms; each
/// strain is above all strains before it.
fn rising(shot: &HopkinsonResult) -> Result<Vec<(f64, f64)>, ImpulseError> {
    let strain = shot.curves.of(Curve::Strain);
    let rate = shot.curves.of(Curve::StrainRate);
    let rate = rate.get(shot.loaded.clone()).unwrap_or(&[]);
    let most = rate.iter().copied().fold(0.0_f64, f64::max);
    let fastest = rate.iter().position(|rate| *rate >= most).unwrap_or(0);
    let slow = |rate: &f64| *rate < SLOW * most;
    let end = rate.iter().skip(fastest).position(slow);
    let n_samples = end.map_or(rate.len(), |end| fastest + end);
    let mut found: Vec<(f64, f64)> = Vec::new();
    for at in shot.loaded.clone().take(n_samples) {
        let strain = strain.get(at).copied().unwrap_or(f64::NAN);
        if strain > found.last().map_or(0.0, |last| last.1) {
            found.push((at as f64, strain));
        }
    }
    check_enough("part of a shot with rising strain", found.len(), FEWEST)?;
    Ok(found)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "places are those of samples"
)]
fn between(values: &[f64], place: f64) -> f64 {
    let below = place.floor() as usize;
    let at = |index: usize| values.get(index).or(values.last()).copied();
    let (low, high) = (at(below), at(below + 1));
    low.zip(high).map_or(f64::NAN, |(low, high)| {
        low + (high - low) * (place - below as f64)
    })
}

impl Read {
    fn at(strains: &[f64], shot: &HopkinsonResult, rising: &[(f64, f64)]) -> Self {
        let places: Vec<f64> = strains
            .iter()
            .map(|strain| {
                let after = rising.partition_point(|(_, own)| own < strain);
                let after = after.clamp(1, rising.len().saturating_sub(1).max(1));
                match rising.get(after - 1..=after) {
                    Some([(a, low), (b, high)]) => {
                        a + (b - a) * ((strain - low) / (high - low)).clamp(0.0, 1.0)
                    }
                    _ => f64::NAN,
                }
            })
            .collect();
        let read = |values: &[f64]| -> Vec<f64> {
            places.iter().map(|place| between(values, *place)).collect()
        };
        let stress = read(shot.curves.of(Curve::Stress));
        // slope over ten intervals of the strains, to suppress the noise of single samples
        let slope: Vec<f64> = (0..strains.len())
            .map(|at| {
                let (low, high) = (at.saturating_sub(5), (at + 5).min(strains.len() - 1));
                let over = |values: &[f64]| Some((*values.get(high)?, *values.get(low)?));
                let ends = over(&stress).zip(over(strains));
                ends.map_or(0.0, |((s1, s0), (e1, e0))| (s1 - s0) / (e1 - e0))
            })
            .collect();
        let effect = |on_stress: &[f64], on_strain: &[f64]| -> Vec<f64> {
            let both = read(on_stress).into_iter().zip(read(on_strain));
            both.zip(&slope)
                .map(|((stress, strain), slope)| stress - slope * strain)
                .collect()
        };
        let random = [Curve::Stress, Curve::Strain].map(|curve| read(shot.random.of(curve)));
        let mut own_variance: Vec<f64> = random[0]
            .iter()
            .zip(&random[1])
            .zip(&slope)
            .map(|((stress, strain), slope)| stress.powi(2) + (slope * strain).powi(2))
            .collect();
        let mut shared = Vec::new();
        for source in &shot.common {
            let effect = effect(source.on(Curve::Stress), source.on(Curve::Strain));
            if source.source.is_of_one_shot() {
                for (sum, effect) in own_variance.iter_mut().zip(effect) {
                    *sum += effect * effect;
                }
            } else {
                shared.push((source.source.clone(), effect));
            }
        }
        Self {
            stress,
            rate: read(shot.curves.of(Curve::StrainRate)),
            own_variance,
            shared,
        }
    }
}
