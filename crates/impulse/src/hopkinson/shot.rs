//! A test with split Hopkinson bars, and its evaluation.

use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use rodwave::fourier::RealFourier;

use super::arrival::{Arrival, first_sample};
use super::bar::HopkinsonBar;
use super::coarse::Coarse;
use super::curves::{self, Curve, Curves, Recipe};
use super::finding;
use super::noise::QuietNoise;
use super::pair::{self, Differences, GaugePairs};
use super::plan::{Given, Plan, StressFrom, WaveSeparation};
use super::record::HopkinsonRecord;
use super::result::{HopkinsonResult, Parts, SourceEffect};
use super::separation::{BarLines, noises};
use super::source::{MaterialVariation, Setup, Source};
use super::specimen::{Loading, TestSpecimen};
use crate::ImpulseError;
use crate::error::{check_enough, check_length};

/// Smallest peak of the reflected wave that is attributed to the loading, as a fraction of the
/// largest value of the wave of either sign; the sign of the peak is opposite to that of the
/// incident wave. A specimen that springs back reflects a larger wave of the other sign during
/// unloading.
const LOADS: f64 = 0.25;

/// Number of draws of the noise: the standard deviation is then known to 7 %.
const DRAWS: usize = 100;
/// Fewest draws of all errors together: the standard deviation is then known to 16 %.
const FEWEST_DRAWS: usize = 20;

/// A test: bars, specimen, loading and method of evaluation.
#[derive(Debug, Clone)]
pub struct HopkinsonTest {
    /// Incident and transmitted bar.
    pub bars: [HopkinsonBar; 2],
    /// Specimen.
    pub specimen: TestSpecimen,
    /// Loading.
    pub loading: Loading,
    /// Separation of the waves of each bar.
    pub separation: [WaveSeparation; 2],
    /// Forces from which the stress is computed.
    pub stress: StressFrom,
    /// End of the band \[Hz\], where the amplitude is a half; `None` for the default.
    pub band_hz: Option<f64>,
    /// True to subtract the lag between the arrivals at the two faces from the transmitted bar,
    /// instead of relying on positions and wave speeds.
    pub align_arrivals: bool,
    /// Uncertain properties of the materials.
    pub variations: Vec<MaterialVariation>,
    /// Number of draws of noise and all sources together, which check the linear errors; `None` for
    /// no check.
    pub monte_carlo: Option<usize>,
}

impl HopkinsonTest {
    fn check(&self) -> Result<(), ImpulseError> {
        for bar in &self.bars {
            bar.check()?;
        }
        self.specimen.check(self.loading)?;
        if let Some(n_draws) = self.monte_carlo {
            check_enough("number of draws", n_draws, FEWEST_DRAWS)?;
        }
        let of_length = self.bars.iter().find_map(|bar| bar.poisson_ratio);
        if let (Loading::Torsion, Some(ratio)) = (self.loading, of_length) {
            return Err(ImpulseError::NonPhysical {
                quantity: "Poisson's ratio of a bar in torsion",
                value: ratio.value,
                expected: "none: the first torsional mode has no dispersion",
            });
        }
        for (separation, bar) in self.separation.iter().zip(&self.bars) {
            let expected = if *separation == WaveSeparation::TwoGauges {
                2
            } else {
                1
            };
            check_length(
                "list of gauges of a bar, given its separation of the waves,",
                bar.gauges.len(),
                expected,
            )?;
        }
        match self.separation {
            [WaveSeparation::FreeEnd, _] => Err(ImpulseError::NonPhysical {
                quantity: "separation of the waves of the incident bar by a free end",
                value: f64::NAN,
                expected: "another separation: the striker touches that end",
            }),
            [_, WaveSeparation::Balanced] => Err(ImpulseError::NonPhysical {
                quantity: "separation of the waves of the transmitted bar by the other force",
                value: f64::NAN,
                expected: "another separation: this bar itself provides the force",
            }),
            _ => Ok(()),
        }
    }

    /// Evaluates a record.
    ///
    /// The random error is the standard deviation of 100 draws of the noise before the pulse
    /// through the whole evaluation; the effect of each common source is half the difference of
    /// two evaluations with that source one standard uncertainty above and below. Both are found at
    /// the sampling rate that the band needs.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`], [`ImpulseError::LengthMismatch`], [`ImpulseError::NonFinite`]
    /// for impossible values; [`ImpulseError::SilenceEnds`] for a silence with a pulse in it;
    /// [`ImpulseError::TooShort`] for a silence or a record that is too short;
    /// [`ImpulseError::NoPulse`] for a gauge without a pulse; [`ImpulseError::TransmittedFirst`] if
    /// the transmitted bar responds before the incident one; [`ImpulseError::NoBarWave`] for a band
    /// beyond the waves of a bar.
    pub fn evaluate(
        &self,
        record: &HopkinsonRecord,
        random_numbers: &mut impl Rng,
    ) -> Result<HopkinsonResult, ImpulseError> {
        self.check()?;
        let n_samples = record.check(&self.bars)?;
        let noises = noises(record)?;
        let first = self.first_samples(record, &noises)?;
        let incident = self.farthest(0);
        let seen = gauge(record, 0, incident);
        let level = noise_of(&noises, 0, incident).map_or(0.0, |noise| noise.level);
        let seen: Vec<f64> = seen.iter().map(|x| x - level).collect();
        let plan = Plan::of(&Given {
            bars: [&self.bars[0], &self.bars[1]],
            separation: self.separation,
            band_hz: self.band_hz,
            rate_hz: record.rate_hz,
            n_samples,
            silent: record.silent,
            first_sample: first,
            incident: &seen,
        })?;
        let recipe = Recipe {
            loading: self.loading,
            separation: self.separation,
            stress: self.stress,
        };
        let mut setup = Setup::new(&self.bars, self.specimen, plan.incident_tail);
        let mut lines = curves::lines_of(&setup, &plan, self.loading)?;
        let mut nominal = curves::evaluate(&setup, &lines, record, &plan, recipe);
        let coarse = Coarse::of(record, &plan);
        let quiet = Quiet {
            noises: coarse.noises(&noises),
            coarse: &coarse,
            recipe,
        };
        let mut noise = quiet.noise_effects(&setup, random_numbers)?;
        let step = 1.0 / record.rate_hz;
        let start = plan.time(plan.result.start);
        let arrivals = |nominal: &Curves, random: &Curves| {
            let of = |wave: Curve, samples: &[f64]| {
                let noise = random.of(wave).iter().fold(0.0_f64, |a, x| a.max(*x));
                Arrival::of(samples, start, step, noise)
            };
            let [incident, reflected, transmitted] = [
                Curve::IncidentWave,
                Curve::ReflectedWave,
                Curve::TransmittedWave,
            ]
            .map(|wave| of(wave, nominal.of(wave)));
            let loading = incident.zip(reflected).and_then(|(incident, whole)| {
                let samples = nominal.of(Curve::ReflectedWave).iter();
                let opposite = |x: &f64| if x * incident.peak < 0.0 { *x } else { 0.0 };
                let opposite: Vec<f64> = samples.map(opposite).collect();
                let found = of(Curve::ReflectedWave, &opposite);
                found.filter(|found| found.peak.abs() > LOADS * whole.peak.abs())
            });
            [incident, loading.or(reflected), transmitted]
        };
        let mut arrived = arrivals(&nominal, &noise.deviations);
        let mut lag_taken = 0.0;
        if self.align_arrivals
            && let [Some(first), _, Some(second)] = arrived
        {
            lag_taken = second.time - first.time;
            setup.advance_transmitted(lag_taken);
            lines = curves::lines_of(&setup, &plan, self.loading)?;
            nominal = curves::evaluate(&setup, &lines, record, &plan, recipe);
            noise = quiet.noise_effects(&setup, random_numbers)?;
            arrived = arrivals(&nominal, &noise.deviations);
        }
        let NoiseEffects {
            nominal: of_coarse,
            deviations: random,
            mut pairs,
        } = noise;
        let mut common = Vec::new();
        for source in setup.sources(&self.variations) {
            let at = |standard: f64| quiet.at(&setup.moved(&source, standard, &self.variations));
            let ((_, above, pairs_above), (_, below, pairs_below)) = (at(1.0)?, at(-1.0)?);
            pairs.add(&pairs_above, &pairs_below, 0.25);
            common.push(SourceEffect::half_difference(source, &above, &below));
        }
        let monte_carlo = self
            .monte_carlo
            .map(|n| {
                let sources = (&common[..], &self.variations[..]);
                quiet.scatter_of_all(&setup, &of_coarse, sources, n, random_numbers)
            })
            .transpose()?;
        for source in &mut common {
            source.refine(&coarse);
        }
        if let Some(wider) = plan.wider([&setup.bars[0], &setup.bars[1]])
            && let Ok(lines) = curves::lines_of(&setup, &wider, self.loading)
        {
            let wider = curves::evaluate(&setup, &lines, record, &wider, recipe);
            common.extend(SourceEffect::above_band(&wider, &nominal, &random));
        }
        let noise_freedom = noises
            .iter()
            .flatten()
            .map(|noise| noise.degrees_of_freedom)
            .fold(f64::INFINITY, f64::min);
        let mut result = HopkinsonResult::of(Parts {
            start_time: start,
            time_step: step,
            curves: nominal,
            random,
            common,
            monte_carlo,
            freedom: noise_freedom.min(DRAWS as f64 - 1.0),
            arrivals: arrived,
            lag_taken,
            band_hz: plan.band_hz,
            amplification: plan.amplification,
            windows: plan
                .windows
                .clone()
                .map(|window| [plan.time(window.start), plan.time(window.end)]),
            separation: self.separation,
            volume_per: self.specimen,
            loading: self.loading,
        });
        result.findings = finding::of(&result, self, record, &plan, &pairs);
        Ok(result)
    }

    /// Returns the gauge of a bar that is farthest from the specimen.
    fn farthest(&self, bar: usize) -> usize {
        let gauges = self
            .bars
            .get(bar)
            .map_or(&[][..], |bar| bar.gauges.as_slice());
        let mut farthest = (0, 0.0);
        for (at, gauge) in gauges.iter().enumerate() {
            if gauge.distance.value > farthest.1 {
                farthest = (at, gauge.distance.value);
            }
        }
        farthest.0
    }

    /// Returns the first sample of the pulse on the incident bar, after a check of the order of the
    /// bars.
    fn first_samples(
        &self,
        record: &HopkinsonRecord,
        noises: &[Vec<QuietNoise>; 2],
    ) -> Result<usize, ImpulseError> {
        let mut first = [0; 2];
        for (bar, (first, side)) in first
            .iter_mut()
            .zip(["incident bar", "transmitted bar"])
            .enumerate()
        {
            let at = if bar == 0 { self.farthest(0) } else { 0 };
            let none = |largest: f64, noise: f64| ImpulseError::NoPulse {
                bar: side,
                largest,
                noise,
            };
            let Some(noise) = noise_of(noises, bar, at) else {
                return Err(none(f64::NAN, f64::NAN));
            };
            let samples: Vec<f64> = gauge(record, bar, at)
                .iter()
                .map(|x| x - noise.level)
                .collect();
            let largest = samples.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
            *first = first_sample(&samples, noise.standard_deviation)
                .ok_or_else(|| none(largest, noise.standard_deviation))?;
        }
        let [incident, transmitted] = first;
        if transmitted < incident {
            return Err(ImpulseError::TransmittedFirst {
                incident: incident as f64 / record.rate_hz,
                transmitted: transmitted as f64 / record.rate_hz,
            });
        }
        if incident < record.silent {
            return Err(ImpulseError::NonPhysical {
                quantity: "silence before the pulse [samples]",
                value: record.silent as f64,
                expected: "one that ends before the first sample of the pulse",
            });
        }
        Ok(incident)
    }
}

fn gauge(record: &HopkinsonRecord, bar: usize, at: usize) -> &[f64] {
    let gauges = record.gauges.get(bar);
    gauges
        .and_then(|gauges| gauges.get(at))
        .map_or(&[], Vec::as_slice)
}

fn noise_of(noises: &[Vec<QuietNoise>; 2], bar: usize, at: usize) -> Option<&QuietNoise> {
    noises.get(bar).and_then(|gauges| gauges.get(at))
}

/// A record with its noise.
struct Quiet<'a> {
    coarse: &'a Coarse,
    noises: [Vec<QuietNoise>; 2],
    recipe: Recipe,
}

/// An evaluation of the coarse record, and the effects of the noise on it.
struct NoiseEffects {
    /// Histories without draws.
    nominal: Curves,
    /// Standard deviations of all histories, at all samples of the result.
    deviations: Curves,
    pairs: GaugePairs,
}

impl Quiet<'_> {
    /// Returns lines, histories and differences of gauges of the coarse record.
    fn at(&self, setup: &Setup) -> Result<([BarLines; 2], Curves, Differences), ImpulseError> {
        let Coarse { plan, record, .. } = self.coarse;
        let lines = curves::lines_of(setup, plan, self.recipe.loading)?;
        let curves = curves::evaluate(setup, &lines, record, plan, self.recipe);
        let differences = pair::differences(setup, &lines, record, plan);
        Ok((lines, curves, differences))
    }

    /// Returns the effects of the noise on histories and gauges, over the same draws.
    fn noise_effects(
        &self,
        setup: &Setup,
        random: &mut impl Rng,
    ) -> Result<NoiseEffects, ImpulseError> {
        let plan = &self.coarse.plan;
        let (lines, nominal, found) = self.at(setup)?;
        let mut pairs = GaugePairs::new(found);
        let deviations = self.scatter(&nominal, DRAWS, random, |drawn, _| {
            let differences = pair::differences(setup, &lines, drawn, plan);
            pairs.add(&differences, &found, 1.0 / DRAWS as f64);
            Ok(curves::evaluate(setup, &lines, drawn, plan, self.recipe))
        })?;
        Ok(NoiseEffects {
            nominal,
            deviations,
            pairs,
        })
    }

    /// Returns the standard deviation of all histories over draws of the noise and of all sources
    /// with their coarse effects.
    ///
    /// The effect of a material property is assumed linear, because its materials are given only at
    /// one standard uncertainty above and below.
    fn scatter_of_all(
        &self,
        setup: &Setup,
        nominal: &Curves,
        (sources, variations): (&[SourceEffect], &[MaterialVariation]),
        n_draws: usize,
        random: &mut impl Rng,
    ) -> Result<Curves, ImpulseError> {
        let plan = &self.coarse.plan;
        self.scatter(nominal, n_draws, random, |drawn, random| {
            let mut moved = setup.clone();
            let mut linear = Vec::new();
            for source in sources {
                let standard: f64 = random.sample(StandardNormal);
                if matches!(source.source, Source::Material(_)) {
                    linear.push((standard, source));
                } else {
                    moved = moved.moved(&source.source, standard, variations);
                }
            }
            let lines = curves::lines_of(&moved, plan, self.recipe.loading)?;
            let mut one = curves::evaluate(&moved, &lines, drawn, plan, self.recipe);
            for (standard, source) in linear {
                source.add_to(&mut one, standard);
            }
            Ok(one)
        })
    }

    /// Returns the standard deviation about `nominal` of the histories that `evaluate` returns for
    /// draws of the noise, at all samples of the result.
    fn scatter<R: Rng>(
        &self,
        nominal: &Curves,
        n_draws: usize,
        random: &mut R,
        mut evaluate: impl FnMut(&HopkinsonRecord, &mut R) -> Result<Curves, ImpulseError>,
    ) -> Result<Curves, ImpulseError> {
        let Coarse { plan, record, .. } = self.coarse;
        let mut transform = RealFourier::new(plan.n_transform);
        let zeros = |curve: &Vec<f64>| vec![0.0; curve.len()];
        let mut squares: Vec<Vec<f64>> = nominal.0.iter().map(zeros).collect();
        let mut drawn = record.clone();
        for _ in 0..n_draws {
            self.draw(&mut drawn, &mut transform, random);
            let one = evaluate(&drawn, random)?;
            for ((sums, one), nominal) in squares.iter_mut().zip(&one.0).zip(&nominal.0) {
                for ((sum, x), mean) in sums.iter_mut().zip(one).zip(nominal) {
                    *sum += (x - mean).powi(2) / n_draws as f64;
                }
            }
        }
        for square in squares.iter_mut().flatten() {
            *square = square.sqrt();
        }
        Ok(self.coarse.refined(&Curves(squares)))
    }

    /// Replaces the samples of `drawn` by those of the record with a draw of its noise.
    fn draw(
        &self,
        drawn: &mut HopkinsonRecord,
        transform: &mut RealFourier,
        random: &mut impl Rng,
    ) {
        let bars = drawn.gauges.iter_mut().zip(&self.coarse.record.gauges);
        for ((drawn, measured), noises) in bars.zip(&self.noises) {
            for ((drawn, measured), noise) in drawn.iter_mut().zip(measured).zip(noises) {
                drawn.copy_from_slice(measured);
                noise.add_draw(drawn, transform, random);
            }
        }
    }
}
