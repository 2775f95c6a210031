//! The result of a test, with its errors.

use super::arrival::Arrival;
use super::coarse::Coarse;
use super::curves::{Curve, Curves};
use super::finding::Finding;
use super::plan::WaveSeparation;
use super::source::Source;
use super::specimen::{Loading, TestSpecimen};
use super::student::StudentFactors;
use crate::ImpulseError;

/// Part of the peak above which the specimen counts as loaded.
const LOADED: f64 = 0.1;
/// Largest index that counts as equilibrium, and its largest standard error.
const INDEX_LIMIT: f64 = 0.05;
/// Fraction of the loaded samples after the start of equilibrium that must be in equilibrium.
const MOST: f64 = 0.95;

/// Number of standard errors of the noise in the band that a part above the band must exceed.
const ABOVE_NOISE: f64 = 2.0;

/// Effect of one standard uncertainty of a source on all histories.
#[derive(Debug, Clone)]
pub struct SourceEffect {
    /// The source.
    pub source: Source,
    effect: Curves,
}

impl SourceEffect {
    pub(super) fn half_difference(source: Source, above: &Curves, below: &Curves) -> Self {
        let curves = above.0.iter().zip(&below.0);
        let effect = curves.map(|(above, below)| {
            let samples = above.iter().zip(below);
            samples.map(|(a, b)| 0.5 * (a - b)).collect()
        });
        Self {
            source,
            effect: Curves(effect.collect()),
        }
    }

    /// Returns the effect of the part of the waves above the band, from the same histories in a
    /// `wider` band; `None` if it nowhere exceeds the noise.
    pub(super) fn above_band(wider: &Curves, nominal: &Curves, random: &Curves) -> Option<Self> {
        let curves = wider.0.iter().zip(&nominal.0).zip(&random.0);
        let effect: Vec<Vec<f64>> = curves
            .map(|((wider, nominal), random)| {
                let samples = wider.iter().zip(nominal).zip(random);
                samples
                    .map(|((wider, nominal), error)| {
                        let difference = wider - nominal;
                        if difference.abs() > ABOVE_NOISE * error {
                            difference
                        } else {
                            0.0
                        }
                    })
                    .collect()
            })
            .collect();
        let any = effect.iter().flatten().any(|x| x.abs() > 0.0);
        any.then_some(Self {
            source: Source::AboveBand,
            effect: Curves(effect),
        })
    }

    /// Interpolates the effects from the samples of a coarse record to those of the result.
    pub(super) fn refine(&mut self, coarse: &Coarse) {
        self.effect = coarse.refined(&self.effect);
    }

    /// Adds `times` times the effect.
    pub(super) fn add_to(&self, curves: &mut Curves, times: f64) {
        for (sum, effect) in curves.0.iter_mut().zip(&self.effect.0) {
            for (sum, effect) in sum.iter_mut().zip(effect) {
                *sum += times * effect;
            }
        }
    }

    /// Returns the change of a history, with its sign; `(n_samples)`.
    #[must_use]
    pub fn on(&self, curve: Curve) -> &[f64] {
        self.effect.of(curve)
    }
}

/// Equilibrium of the specimen.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Index $`2(F_1 - F_2)/(F_1 + F_2)`$; NaN where the specimen is not loaded; `(n_samples)`.
    pub index: Vec<f64>,
    /// Standard error of the index; `(n_samples)`.
    pub standard_error: Vec<f64>,
    /// Time from which on 95 % of the loaded samples have an index of at most 0.05 plus two
    /// standard errors, three after the largest strain \[s\].
    pub from: Option<f64>,
    /// Numbers of loaded samples whose index exceeds this limit: up to the largest strain, and
    /// after it.
    pub outside: [usize; 2],
    /// Ratio of the force of the incident face to that of the transmitted face, from their
    /// impulses.
    pub force_ratio: f64,
    /// Standard error of the force ratio.
    pub force_ratio_error: f64,
}

/// Energies at the end of the result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies {
    /// Work of the incident bar on the specimen \[J\].
    pub into_specimen: f64,
    /// Work of the specimen on the transmitted bar \[J\].
    pub out_of_specimen: f64,
    /// Work of the mean force on the deformation, $`A_sL_s\int\bar\sigma\,d\varepsilon`$ \[J\].
    pub deformation: f64,
}

impl Energies {
    /// Returns the work that goes neither into the transmitted bar nor into the deformation: the
    /// work of moving the specimen \[J\].
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.into_specimen - self.out_of_specimen - self.deformation
    }
}

/// A stress-strain curve with all histories, errors and findings of its shot.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct HopkinsonResult {
    /// Time of the first sample, the arrival at the specimen minus a guard time \[s\].
    pub start_time: f64,
    /// Time between samples \[s\].
    pub time_step: f64,
    /// All histories.
    pub curves: Curves,
    /// Standard deviation of all histories due to noise.
    pub random: Curves,
    /// Effects of common errors, by source.
    pub common: Vec<SourceEffect>,
    /// Standard deviation of all histories over draws of noise and all sources together, if
    /// requested.
    pub monte_carlo: Option<Curves>,
    /// Degrees of freedom of the random error.
    pub degrees_of_freedom: f64,
    /// Arrivals of the incident, the reflected and the transmitted wave at the specimen.
    pub arrivals: [Option<Arrival>; 3],
    /// Lag that was subtracted from the transmitted bar \[s\].
    pub lag_taken: f64,
    /// End of the band \[Hz\].
    pub band_hz: f64,
    /// Largest amplification of a wave that is propagated back to its face.
    pub amplification: f64,
    /// Windows of incident, reflected and transmitted pulse in the record \[s\].
    pub windows: [[f64; 2]; 3],
    /// Equilibrium of the specimen.
    pub equilibrium: Equilibrium,
    /// Energies.
    pub energies: Energies,
    /// Samples at which the specimen is loaded.
    pub loaded: std::ops::Range<usize>,
    /// Problems of the result and remarks on it.
    pub findings: Vec<Finding>,
}

/// Parts of a result.
pub(super) struct Parts {
    pub(super) start_time: f64,
    pub(super) time_step: f64,
    pub(super) curves: Curves,
    pub(super) random: Curves,
    pub(super) common: Vec<SourceEffect>,
    pub(super) monte_carlo: Option<Curves>,
    pub(super) freedom: f64,
    pub(super) arrivals: [Option<Arrival>; 3],
    pub(super) lag_taken: f64,
    pub(super) band_hz: f64,
    pub(super) amplification: f64,
    pub(super) windows: [[f64; 2]; 3],
    pub(super) separation: [WaveSeparation; 2],
    pub(super) volume_per: TestSpecimen,
    pub(super) loading: Loading,
}

impl HopkinsonResult {
    pub(super) fn of(parts: Parts) -> Self {
        let loaded = loaded(&parts.curves);
        let energies = energies(&parts);
        let mut result = Self {
            start_time: parts.start_time,
            time_step: parts.time_step,
            curves: parts.curves,
            random: parts.random,
            common: parts.common,
            monte_carlo: parts.monte_carlo,
            degrees_of_freedom: parts.freedom,
            arrivals: parts.arrivals,
            lag_taken: parts.lag_taken,
            band_hz: parts.band_hz,
            amplification: parts.amplification,
            windows: parts.windows,
            equilibrium: Equilibrium {
                index: Vec::new(),
                standard_error: Vec::new(),
                from: None,
                outside: [0; 2],
                force_ratio: f64::NAN,
                force_ratio_error: f64::NAN,
            },
            energies,
            loaded,
            findings: Vec::new(),
        };
        result.equilibrium = result.judged(parts.separation[0]);
        result
    }

    /// Number of samples.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        self.curves.of(Curve::Stress).len()
    }

    /// Time of a sample \[s\].
    #[must_use]
    pub fn time_at(&self, index: usize) -> f64 {
        self.start_time + index as f64 * self.time_step
    }

    /// Returns the standard error of a history from all common sources together; `(n_samples)`.
    #[must_use]
    pub fn common_error(&self, curve: Curve) -> Vec<f64> {
        let mut squares = vec![0.0; self.n_samples()];
        for source in &self.common {
            for (sum, effect) in squares.iter_mut().zip(source.on(curve)) {
                *sum += effect * effect;
            }
        }
        squares.into_iter().map(f64::sqrt).collect()
    }

    /// Returns the standard error of a history from noise and common sources; `(n_samples)`.
    #[must_use]
    pub fn standard_error(&self, curve: Curve) -> Vec<f64> {
        let common = self.common_error(curve);
        let both = common.iter().zip(self.random.of(curve));
        both.map(|(common, random)| common.hypot(*random)).collect()
    }

    /// Returns the half width of the band in which a single sample lies with the probability
    /// `level`; `(n_samples)`.
    ///
    /// Student's factor has $`\nu u^4/u_r^4`$ degrees of freedom: the random error $`u_r`$ has
    /// $`\nu`$, and stated uncertainties are exact (JCGM 100, annex G).
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a level that is not between 0 and 1.
    pub fn expanded_uncertainty(&self, curve: Curve, level: f64) -> Result<Vec<f64>, ImpulseError> {
        let errors = self.standard_error(curve);
        let factors = StudentFactors::new(self.degrees_of_freedom, level)?;
        let widths = errors.iter().zip(self.random.of(curve));
        Ok(widths
            .map(|(error, random)| factors.half_width(*error, *random))
            .collect())
    }

    /// Returns the largest stress and the half width of the interval in which the largest stress of
    /// the specimen lies with the probability `level`: it contains the largest values of both edges
    /// of the band of single samples. If the stress rises until the unloading, the sample of the
    /// largest stress is hardly uncertain, but the samples after it are.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a level that is not between 0 and 1.
    pub fn largest_stress(&self, level: f64) -> Result<(f64, f64), ImpulseError> {
        let stress = self.curves.of(Curve::Stress);
        let widths = self.expanded_uncertainty(Curve::Stress, level)?;
        Ok(with_half_width(stress, &widths))
    }

    /// Returns true if the forces of the two faces are known to be equal at a sample: the index is
    /// at most 0.05 plus two standard errors, and its standard error at most 0.05.
    #[must_use]
    pub fn is_in_equilibrium(&self, sample: usize) -> bool {
        let equilibrium = &self.equilibrium;
        let index = equilibrium.index.get(sample);
        index
            .zip(equilibrium.standard_error.get(sample))
            .is_some_and(|(index, error)| {
                *error <= INDEX_LIMIT && index.abs() <= INDEX_LIMIT + 2.0 * error
            })
    }

    /// Returns the sample of the largest stress before the unloading at which the specimen [is in
    /// equilibrium](Self::is_in_equilibrium), from the start of equilibrium on; `None` if there is
    /// none. Where the unloading begins, an error of a position makes the forces uncertain.
    #[must_use]
    pub fn largest_in_equilibrium(&self) -> Option<usize> {
        let from = self.equilibrium.from?;
        let stress = self.curves.of(Curve::Stress).iter();
        let rates = self.curves.of(Curve::StrainRate);
        let samples = stress.zip(rates).enumerate().take(self.loaded.end);
        samples
            .filter(|(at, (_, rate))| {
                **rate > 0.0 && self.time_at(*at) >= from && self.is_in_equilibrium(*at)
            })
            .max_by(|(_, (a, _)), (_, (b, _))| a.total_cmp(b))
            .map(|(at, _)| at)
    }

    /// Index of the first sample after the largest strain of the loaded samples.
    fn unloading(&self) -> usize {
        let strain = self.curves.of(Curve::Strain).iter().enumerate();
        let loaded = strain.take(self.loaded.end).skip(self.loaded.start);
        let largest = loaded.max_by(|(_, a), (_, b)| a.total_cmp(b));
        largest.map_or(self.loaded.end, |(at, _)| at + 1)
    }

    fn judged(&self, separation: WaveSeparation) -> Equilibrium {
        let (f1, f2) = (self.curves.of(Curve::Force1), self.curves.of(Curve::Force2));
        let difference = self.curves.of(Curve::ForceDifference);
        let errors = self.standard_error(Curve::ForceDifference);
        let mut index = vec![f64::NAN; f1.len()];
        let mut standard_error = vec![f64::NAN; f1.len()];
        let mut held = vec![false; f1.len()];
        let mut outside = [0; 2];
        let unloading = self.unloading();
        let samples = f1.iter().zip(f2).zip(difference.iter().zip(&errors));
        let outputs = index.iter_mut().zip(&mut standard_error).zip(&mut held);
        for (at, (((f1, f2), (difference, error)), ((index, own), held))) in samples
            .zip(outputs)
            .enumerate()
            .take(self.loaded.end)
            .skip(self.loaded.start)
        {
            let mean = 0.5 * (f1 + f2);
            *index = difference / mean;
            *own = (error / mean).abs();
            // during unloading the main error of the difference is an error of time, which is
            // common to all samples: with a limit of two standard errors, one correct shot in
            // twenty would fail
            let (part, errors) = if at < unloading { (0, 2.0) } else { (1, 3.0) };
            *held = index.abs() <= INDEX_LIMIT + errors * *own;
            if !*held && let Some(count) = outside.get_mut(part) {
                *count += 1;
            }
        }
        let (mut holding, mut all, mut start) = (0.0, 0.0, None);
        for (at, held) in held
            .iter()
            .enumerate()
            .take(self.loaded.end)
            .skip(self.loaded.start)
            .rev()
        {
            all += 1.0;
            holding += f64::from(u8::from(*held));
            if *held && holding >= MOST * all {
                start = Some(at);
            }
        }
        // equilibrium that begins in the last fifth of the loaded samples does not count
        let enough = |at: &usize| {
            (self.loaded.end - at) as f64 >= 0.2 * self.loaded.len() as f64
                && separation != WaveSeparation::Balanced
        };
        let of_loaded =
            |values: &[f64]| -> f64 { values.get(self.loaded.clone()).unwrap_or(&[]).iter().sum() };
        let [sum_1, sum_2] = [of_loaded(f1), of_loaded(f2)];
        // errors of sources are common to all samples and add up; those of noise nearly average out
        let by_sources: f64 = self
            .common
            .iter()
            .map(|source| of_loaded(source.on(Curve::ForceDifference)).powi(2))
            .sum();
        let by_noise = of_loaded(self.random.of(Curve::ForceDifference))
            / (self.loaded.len().max(1) as f64).sqrt();
        Equilibrium {
            index,
            standard_error,
            from: start.filter(enough).map(|at| self.time_at(at)),
            outside,
            force_ratio: sum_1 / sum_2,
            force_ratio_error: (by_sources.sqrt().hypot(by_noise) / sum_2).abs(),
        }
    }
}

/// Largest of `values`, and the larger distance from it to the largest values of the edges of a
/// band of these half `widths`.
pub(super) fn with_half_width(values: &[f64], widths: &[f64]) -> (f64, f64) {
    let edge = |side: f64| {
        let edge = values.iter().zip(widths).map(|(v, w)| v + side * w);
        edge.fold(f64::NEG_INFINITY, f64::max)
    };
    let largest = edge(0.0);
    (largest, (edge(1.0) - largest).max(largest - edge(-1.0)))
}

/// Samples from the first to the last with more than a tenth of the largest force of the
/// transmitted bar.
fn loaded(curves: &Curves) -> std::ops::Range<usize> {
    let force = curves.of(Curve::Force2);
    let largest = force.iter().copied().fold(0.0_f64, f64::max);
    let above = |f: &f64| largest > 0.0 && *f > LOADED * largest;
    let first = force.iter().position(above).unwrap_or(0);
    let last = force.iter().rposition(above).map_or(0, |last| last + 1);
    first..last.max(first)
}

fn energies(parts: &Parts) -> Energies {
    let curves = &parts.curves;
    let sign = -parts.loading.sign();
    // forces are positive in the sense of the loading: the incident bar pushes along x in
    // compression
    let work = |force: Curve, velocity: Curve| -> f64 {
        let power = curves.of(force).iter().zip(curves.of(velocity));
        sign * parts.time_step * power.map(|(f, v)| f * v).sum::<f64>()
    };
    let mean_work: f64 = curves
        .of(Curve::Force1)
        .iter()
        .zip(curves.of(Curve::Force2))
        .zip(curves.of(Curve::StrainRate))
        .map(|((f1, f2), rate)| 0.5 * (f1 + f2) * rate)
        .sum();
    Energies {
        into_specimen: work(Curve::Force1, Curve::Velocity1),
        out_of_specimen: work(Curve::Force2, Curve::Velocity2),
        deformation: parts.time_step * mean_work / parts.volume_per.rate_per_velocity(),
    }
}
