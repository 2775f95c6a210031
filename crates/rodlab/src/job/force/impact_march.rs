//! March of an impact in time, repeated with draws of all quantities stated with ±, and its
//! settings in words.

use impulse::{
    BandLimit, DrawnImpact, Impact, ImpactDraws, ImpulseError, SharedBody, Spread,
    UncertainPrediction,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::bodies::FaceBody;
use super::draws::Draws;
use super::impact_sheet::{ImpactSheet, SEED};
use crate::bodies::material_sheet::Materials;
use crate::bodies::replacement::Replacement;
use crate::job::JobContext;
use crate::sheet::plausible;
use crate::{InStep, RodlabError};

/// Maximum number of steps of a march.
const MOST_STEPS: f64 = 1e6;

/// Maximum number of steps of a march that is repeated for draws; its step follows from the band.
const MOST_STEPS_OF_DRAWS: f64 = 1e5;

/// Default number of draws of the march: the standard deviation is then known to 5 %.
pub(super) const DRAWS: usize = 200;

/// Returns the band of the force as stated in the sheet; by default up to 10 kHz as in paper E, or
/// up to half of the highest frequency of a measured body.
pub(super) fn band(sheet: &ImpactSheet, bodies: [&FaceBody; 2]) -> Result<BandLimit, RodlabError> {
    let measured_to = bodies
        .iter()
        .filter_map(|body| body.measured_to_hz())
        .fold(f64::INFINITY, f64::min);
    let band = match &sheet.band {
        Some(stated) if stated.si() > measured_to * (1.0 + 1e-9) => {
            return Err(RodlabError::request(
                "problem.band",
                stated.to_string(),
                format!("at most {measured_to} Hz, the end of the measured lines"),
            ));
        }
        Some(stated) => BandLimit::up_to(stated.si()),
        None => BandLimit::by_default(measured_to),
    };
    band.in_step("problem.band")
}

pub(super) fn march(
    sheet: &ImpactSheet,
    materials: &Materials,
    bodies: [&FaceBody; 2],
    context: &JobContext<'_>,
) -> Result<UncertainPrediction, RodlabError> {
    let [first, second] = [bodies[0].impact_body()?, bodies[1].impact_body()?];
    let duration = sheet.duration.si();
    let mut impact = Impact::between(first.as_ref(), second.as_ref())
        .at_velocity(sheet.velocity.nominal())
        .through(sheet.contact.law()?);
    if let Some(step) = &sheet.time_step {
        let steps = duration / step.si();
        plausible::at_most(steps, MOST_STEPS, "steps", "problem.time_step")?;
        impact = impact.in_steps_of(step.si());
    }
    let draws = SheetDraws::of(sheet, materials, bodies, context)?;
    let band = band(sheet, bodies)?;
    let most = match draws.n_draws {
        0 => MOST_STEPS,
        _ => MOST_STEPS_OF_DRAWS,
    };
    if duration > most * band.time_step() {
        return Err(of_duration(
            sheet,
            format!("at most {:.3} s", most * band.time_step()),
            band,
        ));
    }
    impact
        .with_errors(draws)
        .in_band(band)
        .predict(duration)
        .map_err(|Refused(error)| match too_short(&error) {
            Some(times) => {
                let least = format!("more than {:.2} ms", 1e3 * duration * times);
                of_duration(sheet, least, band)
            }
            None => error,
        })
}

/// Returns the factor by which a history is too short for its band; `None` if the error has another
/// cause.
fn too_short(error: &RodlabError) -> Option<f64> {
    let RodlabError::Step { source, .. } = error else {
        return None;
    };
    match source.downcast_ref()? {
        ImpulseError::TooShort {
            found, expected, ..
        } => Some(*expected as f64 / *found as f64),
        _ => None,
    }
}

/// Returns the error for a duration that does not fit the band.
fn of_duration(sheet: &ImpactSheet, expected: String, band: BandLimit) -> RodlabError {
    RodlabError::request(
        "problem.duration",
        format!("`{}`", sheet.duration),
        format!("{expected} with a band up to {} kHz", khz(band.upper_hz())),
    )
}

/// Error of a march with its place in the sheet.
struct Refused(RodlabError);

impl From<RodlabError> for Refused {
    fn from(error: RodlabError) -> Self {
        Self(error)
    }
}

impl From<ImpulseError> for Refused {
    fn from(error: ImpulseError) -> Self {
        Self(RodlabError::step("problem", error))
    }
}

/// Draws of all quantities of a sheet that are stated with ±.
struct SheetDraws<'a> {
    sheet: &'a ImpactSheet,
    materials: &'a Materials,
    bodies: [&'a FaceBody; 2],
    context: &'a JobContext<'a>,
    random: ChaCha8Rng,
    n_draws: usize,
    n_drawn: usize,
    bodies_differ: bool,
}

impl<'a> SheetDraws<'a> {
    fn of(
        sheet: &'a ImpactSheet,
        materials: &'a Materials,
        bodies: [&'a FaceBody; 2],
        context: &'a JobContext<'a>,
    ) -> Result<Self, RodlabError> {
        let chosen = sheet.uncertainty.clone().unwrap_or_default();
        let mut random = ChaCha8Rng::seed_from_u64(chosen.seed.unwrap_or(SEED));
        // a trial draw counts the uncertain quantities
        let mut of_bodies = Draws::by(&mut random);
        drawn_bodies(sheet, materials, bodies, &mut of_bodies)?;
        let bodies_differ = of_bodies.n_drawn > 0;
        let mut of_rest = Draws::by(&mut random);
        of_rest.contact(&sheet.contact)?;
        of_rest.replace(&mut sheet.velocity.clone(), "problem.velocity")?;
        let is_uncertain = bodies_differ || of_rest.n_drawn > 0;
        let n_draws = chosen.draws.unwrap_or(DRAWS);
        Ok(Self {
            sheet,
            materials,
            bodies,
            context,
            random,
            n_draws: if is_uncertain && context.draw.is_none() {
                n_draws
            } else {
                0
            },
            n_drawn: 0,
            bodies_differ,
        })
    }
}

impl ImpactDraws for SheetDraws<'_> {
    type Error = Refused;

    fn n_draws(&self) -> usize {
        self.n_draws
    }

    fn draw(&mut self, _velocity: f64) -> Result<DrawnImpact, Refused> {
        self.context.check_cancelled()?;
        if self.n_drawn == 0 {
            self.context.progress.begins("draws", self.n_draws);
        }
        self.n_drawn += 1;
        self.context.progress.one_more();
        let mut draws = Draws::by(&mut self.random);
        let law = draws.contact(&self.sheet.contact)?;
        let has_drawn_law = draws.n_drawn > 0;
        let mut velocity = self.sheet.velocity.clone();
        draws.replace(&mut velocity, "problem.velocity")?;
        let bodies = if self.bodies_differ {
            drawn_bodies(self.sheet, self.materials, self.bodies, &mut draws)?
        } else {
            [None, None]
        };
        Ok(DrawnImpact {
            bodies,
            law: has_drawn_law.then(|| law.law()).transpose()?,
            velocity: Some(velocity.nominal()),
        })
    }

    fn check_cancelled(&self) -> Result<(), Refused> {
        Ok(self.context.check_cancelled()?)
    }
}

/// Number of repeated draws without a valid body after which the draw fails.
const MOST_REDRAWS: usize = 100;

/// Returns both drawn bodies, with `None` for a body without uncertain quantities. A draw that
/// gives no valid body, such as a Zener law whose relaxed modulus is above the unrelaxed one, is
/// repeated.
fn drawn_bodies(
    sheet: &ImpactSheet,
    materials: &Materials,
    bodies: [&FaceBody; 2],
    draws: &mut Draws<'_>,
) -> Result<[Option<SharedBody>; 2], RodlabError> {
    let mut drawn = || bodies_of_one_draw(sheet, materials, bodies, draws);
    let first = drawn();
    (0..MOST_REDRAWS).fold(first, |found, _| found.or_else(|_| drawn()))
}

fn bodies_of_one_draw(
    sheet: &ImpactSheet,
    materials: &Materials,
    bodies: [&FaceBody; 2],
    draws: &mut Draws<'_>,
) -> Result<[Option<SharedBody>; 2], RodlabError> {
    let before = draws.n_drawn;
    let materials = draws.materials(materials)?;
    let materials_differ = draws.n_drawn > before;
    let mut drawn = |body: &FaceBody, of_sheet, field| {
        let before = draws.n_drawn;
        let found = body.drawn(of_sheet, &materials, field, draws)?;
        let differs = draws.n_drawn > before || materials_differ && body.measured().is_none();
        Ok::<_, RodlabError>(differs.then_some(found))
    };
    Ok([
        drawn(bodies[0], &sheet.first, "problem.first")?,
        drawn(bodies[1], &sheet.second, "problem.second")?,
    ])
}

/// Describes in words how the errors were computed.
pub(super) fn in_words(spread: Option<&Spread>) -> String {
    match spread {
        Some(spread) => format!(
            "from {} marches with draws of every quantity stated with ±, and from half the step",
            spread.n_draws
        ),
        None => "no quantity is stated with ±".to_owned(),
    }
}

/// Returns a frequency in kHz, rounded to 1 mHz: a line spacing computed from a rounded sampling
/// rate is not more accurate.
pub(super) fn khz(hz: f64) -> f64 {
    (1e3 * hz).round() / 1e6
}

pub(super) fn band_in_words(band: BandLimit) -> String {
    let upper = khz(band.upper_hz());
    format!("up to {upper} kHz, Gaussian, -3 dB at its end")
}
