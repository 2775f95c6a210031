//! March of an impact and force in its band, with errors from a second step and from draws of all
//! quantities stated with ±.

use std::sync::Arc;

use impulse::{
    BandLimit, ContactLaw, DiscreteImpact, Domain, FirstForce, ForceHistory, Impact, ImpactBody,
    Prediction,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::bodies::FaceBody;
use super::draws::Draws;
use super::impact::ImpactSheet;
use crate::RodlabError;
use crate::job::Surroundings;
use crate::sheet::material::Materials;
use crate::sheet::replacement::Replacement;
use crate::sheet::{Exact, plausible};

/// Fewest steps of a march.
const FEWEST_STEPS: f64 = 4096.0;

/// Most steps of a march whose step is stated.
const MOST_STEPS: f64 = 1e6;

/// Default number of draws of the march: the standard deviation is then known to 5 %.
const DRAWS: usize = 200;
const SEED: u64 = 1;

/// A body in the form used by `impulse`.
type Body = Arc<dyn ImpactBody + Send + Sync>;

/// A march with its force in the band.
pub(super) struct March {
    pub(super) prediction: Prediction,
    pub(super) first_force: FirstForce,
    pub(super) band: BandLimit,
    /// The force in the band.
    pub(super) limited: ForceHistory,
    /// Change of the force in the band with half the step, at its times \[N\].
    pub(super) numerical: Vec<f64>,
    /// Changes of the numbers with half the step.
    pub(super) numerical_numbers: Numbers,
    /// Standard deviations by draws; `None` if nothing is stated with ±.
    pub(super) spread: Option<Spread>,
}

/// Numbers of an impact, in SI; `None` for those that the impact does not define.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers {
    pub(super) peak: Option<f64>,
    pub(super) time_of_peak: Option<f64>,
    pub(super) limited_peak: Option<f64>,
    pub(super) time_of_limited_peak: Option<f64>,
    pub(super) end: Option<f64>,
    pub(super) impulse: Option<f64>,
    pub(super) restitution: Option<f64>,
    pub(super) velocity_after: [Option<f64>; 2],
    pub(super) inner: [Option<f64>; 2],
}

/// Standard deviations over draws.
pub(super) struct Spread {
    pub(super) n_draws: usize,
    pub(super) numbers: Numbers,
    /// Standard deviation of the force in the band, at its times \[N\].
    pub(super) limited: Vec<f64>,
    /// Standard deviation of the force of the march, at its times \[N\].
    pub(super) force: Vec<f64>,
}

impl Numbers {
    fn of(prediction: &Prediction, first_force: FirstForce, limited: &ForceHistory) -> Self {
        let in_band = limited.smooth_peak();
        let sampled = prediction.peak();
        let (peak, time_of_peak) = match first_force {
            FirstForce::Unbounded => (in_band.force, in_band.time),
            FirstForce::Jump(jump) if jump >= sampled.force => (jump, 0.0),
            _ => (sampled.force, sampled.time),
        };
        let balance = prediction.balance();
        Self {
            peak: Some(peak),
            time_of_peak: Some(time_of_peak),
            limited_peak: Some(in_band.force),
            time_of_limited_peak: Some(in_band.time),
            end: Some(prediction.duration()),
            impulse: Some(balance.impulse),
            restitution: balance.restitution,
            velocity_after: balance.velocity_after,
            inner: balance.inner.map(Some),
        }
    }

    fn all(&self) -> [Option<f64>; 11] {
        let ([v1, v2], [w1, w2]) = (self.velocity_after, self.inner);
        [
            self.peak,
            self.time_of_peak,
            self.limited_peak,
            self.time_of_limited_peak,
            self.end,
            self.impulse,
            self.restitution,
            v1,
            v2,
            w1,
            w2,
        ]
    }

    fn from_all(
        [
            peak,
            time_of_peak,
            limited_peak,
            time_of_limited_peak,
            end,
            impulse,
            restitution,
            v1,
            v2,
            w1,
            w2,
        ]: [Option<f64>; 11],
    ) -> Self {
        Self {
            peak,
            time_of_peak,
            limited_peak,
            time_of_limited_peak,
            end,
            impulse,
            restitution,
            velocity_after: [v1, v2],
            inner: [w1, w2],
        }
    }

    /// Combines the numbers one by one; `None` if either is missing.
    fn with(&self, other: &Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        let other = other.all();
        let mut pairs = self.all().into_iter().zip(other);
        Self::from_all(std::array::from_fn(|_| {
            let (a, b) = pairs.next()?;
            Some(combine(a?, b?))
        }))
    }
}

/// The data of a march.
struct Setup {
    bodies: [Body; 2],
    law: ContactLaw,
    velocity: f64,
    duration: f64,
    band: BandLimit,
    /// Period 1/Δf of a measured body, a whole number of steps \[s\].
    period: Option<f64>,
}

/// One march and its force in the band.
struct Run {
    prediction: Prediction,
    first_force: FirstForce,
    limited: ForceHistory,
}

impl Setup {
    fn discretised(&self, step: f64, duration: f64) -> Result<DiscreteImpact, RodlabError> {
        Impact::between(&*self.bodies[0], &*self.bodies[1])
            .at_velocity(self.velocity)
            .through(self.law.clone())
            .in_steps_of(step)
            .discretised(duration)
            .map_err(|error| RodlabError::step("problem", error))
    }

    fn run(&self, discrete: &DiscreteImpact) -> Result<Run, RodlabError> {
        let refused = |error| RodlabError::step("problem", error);
        let prediction = discrete.predict().map_err(refused)?;
        let limited = prediction
            .band_limited(self.band)
            .map_err(|error| RodlabError::step("problem.band", error))?;
        Ok(Run {
            first_force: discrete.first_force(),
            prediction,
            limited,
        })
    }

    /// A step of at most `longest` that fills the period of a measured body.
    fn step(&self, longest: f64) -> f64 {
        self.period
            .map_or(longest, |period| period / (period / longest).ceil())
    }
}

/// The band of the force: that of the sheet, or 10 kHz as in paper E, or up to the highest
/// frequency of a measured body.
pub(super) fn band(sheet: &ImpactSheet, bodies: [&FaceBody; 2]) -> Result<BandLimit, RodlabError> {
    let measured_to = bodies
        .iter()
        .filter_map(|body| body.measured())
        .map(|body| (body.mobility().len() - 1) as f64 * body.frequency_step_hz())
        .fold(f64::INFINITY, f64::min);
    let upper_hz = match &sheet.band {
        Some(stated) if stated.si() > measured_to * (1.0 + 1e-9) => {
            return Err(RodlabError::request(
                "problem.band",
                stated.to_string(),
                format!("at most {measured_to} Hz, up to which the bodies were measured"),
            ));
        }
        Some(stated) => stated.si(),
        None => BandLimit::PAPER_E.upper_hz().min(measured_to),
    };
    BandLimit::up_to(upper_hz).map_err(|error| RodlabError::step("problem.band", error))
}

pub(super) fn march(
    sheet: &ImpactSheet,
    materials: &Materials,
    bodies: [&FaceBody; 2],
    around: &Surroundings<'_>,
) -> Result<March, RodlabError> {
    let setup = Setup {
        bodies: [bodies[0].impact_body()?, bodies[1].impact_body()?],
        law: sheet.contact.law()?,
        velocity: sheet.velocity.nominal(),
        duration: sheet.duration.si(),
        band: band(sheet, bodies)?,
        period: bodies
            .iter()
            .find_map(|body| body.measured())
            .map(|body| 1.0 / body.frequency_step_hz()),
    };
    let resolved = setup.band.time_step();
    let step = match &sheet.time_step {
        Some(step) => {
            plausible::at_most(
                setup.duration / step.si(),
                MOST_STEPS,
                "steps",
                "problem.time_step",
            )?;
            step.si()
        }
        None => setup.step(resolved.min(setup.duration / FEWEST_STEPS)),
    };
    let Run {
        prediction,
        first_force,
        limited,
    } = setup.run(&setup.discretised(step, setup.duration)?)?;
    around.go_on()?;
    // ringing of a body known only on the frequency axis must die out within a period that depends
    // on the duration
    let longer = setup
        .bodies
        .iter()
        .any(|body| body.domain() == Domain::FrequencyAxis);
    let check_for = if longer { 2.0 } else { 1.0 } * setup.duration;
    let check = setup.run(&setup.discretised(0.5 * step, check_for)?)?;
    around.go_on()?;
    let numbers = Numbers::of(&prediction, first_force, &limited);
    let of_check = Numbers::of(&check.prediction, check.first_force, &check.limited);
    // for first order the finer step leaves the same error as the difference, for second order a
    // third of it
    let numerical = deviations(&limited, &check.limited, |a, b| 2.0 * (a - b).abs());
    let numerical_numbers = numbers.with(&of_check, |a, b| 2.0 * (a - b).abs());
    let spread =
        spread(sheet, materials, bodies, &setup, step, around)?.map(|(spread, coarse)| Spread {
            limited: resampled(&coarse.limited, &spread.limited, &limited),
            force: resampled(
                &coarse.prediction.history,
                &spread.force,
                &prediction.history,
            ),
            ..spread
        });
    Ok(March {
        prediction,
        first_force,
        band: setup.band,
        limited,
        numerical,
        numerical_numbers,
        spread,
    })
}

impl March {
    pub(super) fn numbers(&self) -> Numbers {
        Numbers::of(&self.prediction, self.first_force, &self.limited)
    }

    /// Standard errors of the numbers, including the error of the step; `None` without draws.
    pub(super) fn errors(&self) -> Option<Numbers> {
        let spread = self.spread.as_ref()?;
        Some(spread.numbers.with(&self.numerical_numbers, f64::hypot))
    }

    /// Standard errors of the force in the band \[N\].
    pub(super) fn limited_errors(&self) -> Option<Vec<f64>> {
        let spread = self.spread.as_ref()?;
        let pairs = spread.limited.iter().zip(&self.numerical);
        Some(pairs.map(|(a, b)| a.hypot(*b)).collect())
    }
}

/// Standard deviations over draws of all quantities stated with ±, from marches with a step that
/// resolves the band; and one march with the stated values.
fn spread(
    sheet: &ImpactSheet,
    materials: &Materials,
    bodies: [&FaceBody; 2],
    setup: &Setup,
    step: f64,
    around: &Surroundings<'_>,
) -> Result<Option<(Spread, Run)>, RodlabError> {
    let chosen = sheet.uncertainty.clone().unwrap_or_default();
    let n_draws = chosen.draws.unwrap_or(DRAWS);
    let mut random = ChaCha8Rng::seed_from_u64(chosen.seed.unwrap_or(SEED));
    // find out which of them are uncertain
    let mut of_bodies = Draws::by(&mut random);
    drawn_bodies(sheet, materials, bodies, &mut of_bodies)?;
    let bodies_differ = of_bodies.n_drawn > 0;
    let mut of_rest = Draws::by(&mut random);
    of_rest.contact(&sheet.contact)?;
    of_rest.stated(&sheet.velocity, "problem.velocity")?;
    if (!bodies_differ && of_rest.n_drawn == 0) || n_draws < 2 {
        return Ok(None);
    }
    let coarse = setup.step(step.max(setup.band.time_step()));
    let stated = setup.discretised(coarse, setup.duration)?;
    let nominal = setup.run(&stated)?;
    around.progress.begins("draws", n_draws);
    let mut numbers = Vec::with_capacity(n_draws);
    let mut limited = Moments::of(nominal.limited.force().len());
    let mut force = Moments::of(nominal.prediction.history.force().len());
    for _ in 0..n_draws {
        around.go_on()?;
        let mut draws = Draws::by(&mut random);
        let law = draws.contact(&sheet.contact)?;
        let same_law = draws.n_drawn == 0;
        let velocity = draws.stated(&sheet.velocity, "problem.velocity")?.nominal();
        let discrete = if bodies_differ || !same_law {
            let bodies = if bodies_differ {
                drawn_bodies(sheet, materials, bodies, &mut draws)?
            } else {
                setup.bodies.clone()
            };
            Setup {
                bodies,
                law: law.law()?,
                velocity,
                ..*setup
            }
            .discretised(coarse, setup.duration)?
        } else {
            // the kernels do not depend on the velocity
            stated.at_velocity(velocity)
        };
        let run = setup.run(&discrete)?;
        numbers.push((
            Numbers::of(&run.prediction, run.first_force, &run.limited),
            counting(&run.prediction),
        ));
        limited.add(run.limited.force());
        force.add(run.prediction.history.force());
        around.progress.one_more();
    }
    let mut deviations = Numbers::from_all(std::array::from_fn(|at| {
        let values: Option<Vec<f64>> = numbers
            .iter()
            .map(|(numbers, _)| numbers.all().get(at).copied().flatten())
            .collect();
        values.map(|values| deviation(&values))
    }));
    // an end that sometimes belongs to another contact has no standard error
    let contacts = counting(&nominal.prediction);
    if numbers.iter().any(|(_, found)| *found != contacts) {
        deviations.end = None;
    }
    let spread = Spread {
        n_draws,
        numbers: deviations,
        limited: limited.deviations(),
        force: force.deviations(),
    };
    Ok(Some((spread, nominal)))
}

fn drawn_bodies(
    sheet: &ImpactSheet,
    materials: &Materials,
    bodies: [&FaceBody; 2],
    draws: &mut Draws<'_>,
) -> Result<[Body; 2], RodlabError> {
    let materials = draws.materials(materials)?;
    let first = bodies[0].drawn(&sheet.first, &materials, "problem.first", draws)?;
    let second = bodies[1].drawn(&sheet.second, &materials, "problem.second", draws)?;
    Ok([first, second])
}

/// Number of contacts with more than a thousandth of the impulse.
pub(super) fn counting(prediction: &Prediction) -> usize {
    let least = 1e-3 * prediction.balance().impulse;
    let contacts = prediction.contacts.iter();
    contacts.filter(|contact| contact.impulse > least).count()
}

/// Running means and sums of squares of samples.
struct Moments {
    count: f64,
    mean: Vec<f64>,
    squares: Vec<f64>,
}

impl Moments {
    fn of(n_samples: usize) -> Self {
        Self {
            count: 0.0,
            mean: vec![0.0; n_samples],
            squares: vec![0.0; n_samples],
        }
    }

    fn add(&mut self, samples: &[f64]) {
        self.count += 1.0;
        let moments = self.mean.iter_mut().zip(&mut self.squares);
        for ((mean, squares), sample) in moments.zip(samples) {
            let away = sample - *mean;
            *mean += away / self.count;
            *squares += away * (sample - *mean);
        }
    }

    fn deviations(&self) -> Vec<f64> {
        let squares = self.squares.iter();
        squares.map(|s| (s / (self.count - 1.0)).sqrt()).collect()
    }
}

fn deviation(values: &[f64]) -> f64 {
    let mut moments = Moments::of(1);
    for value in values {
        moments.add(&[*value]);
    }
    moments.deviations().first().copied().unwrap_or(f64::NAN)
}

/// `combine` of the forces of both histories at the times of the first.
fn deviations(
    history: &ForceHistory,
    other: &ForceHistory,
    combine: impl Fn(f64, f64) -> f64,
) -> Vec<f64> {
    let at_times = resampled(other, other.force(), history);
    let pairs = history.force().iter().zip(at_times);
    pairs.map(|(a, b)| combine(*a, b)).collect()
}

/// `values` at the times of `of`, interpolated linearly to the times of `to`.
fn resampled(of: &ForceHistory, values: &[f64], to: &ForceHistory) -> Vec<f64> {
    let (start, step) = (of.time_at(0), of.time_step());
    let mut pairs = values.windows(2).enumerate().peekable();
    (0..to.force().len())
        .map(|index| {
            let position = (to.time_at(index) - start) / step;
            while pairs
                .peek()
                .is_some_and(|(at, _)| *at as f64 + 1.0 < position)
                && pairs.len() > 1
            {
                pairs.next();
            }
            match pairs.peek() {
                Some((at, [a, b])) => {
                    let fraction = (position - *at as f64).clamp(0.0, 1.0);
                    a + fraction * (b - a)
                }
                _ => values.first().copied().unwrap_or(0.0),
            }
        })
        .collect()
}

/// A description of the drawn quantities, in words.
pub(super) fn in_words(spread: Option<&Spread>) -> String {
    match spread {
        Some(spread) => format!(
            "by {} marches with everything drawn that is stated with ±, and with half the step",
            spread.n_draws
        ),
        None => "nothing is stated with ±".to_owned(),
    }
}

/// A frequency in kHz to a mHz, the resolution of a spacing from a rounded sampling rate.
pub(super) fn khz(hz: f64) -> f64 {
    (1e3 * hz).round() / 1e6
}

/// Draws and seed of the sheet.
pub(super) fn settings(sheet: &ImpactSheet) -> [(&'static str, String, bool); 2] {
    let chosen = sheet.uncertainty.clone().unwrap_or_default();
    [
        (
            "draws_of_march",
            chosen.draws.unwrap_or(DRAWS).to_string(),
            chosen.draws.is_none(),
        ),
        (
            "seed",
            chosen.seed.unwrap_or(SEED).to_string(),
            chosen.seed.is_none(),
        ),
    ]
}

/// Band of the sheet, in words.
pub(super) fn band_in_words(sheet: &ImpactSheet, band: BandLimit) -> (String, bool) {
    let text = sheet
        .band
        .as_ref()
        .map_or_else(|| format!("{} kHz", khz(band.upper_hz())), Exact::to_string);
    (
        format!("up to {text}, Gaussian, -3 dB at its end"),
        sheet.band.is_none(),
    )
}
