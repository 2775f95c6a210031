//! Method of paper E: the stick force from lines of the mobilities (Ödeen 1993, paper E, eq. 2),
//! with its errors.

use impulse::{
    ContactEnd, ContactImpulse, EndError, EndVerdict, ForceBand, ForceError, ForcePeak,
    ImpactForce, MonteCarlo, StickForce, StickProblem, StickUncertainty, ZeroLine, separate,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::bodies::FaceBody;
use super::draws::Draws;
use super::histories::{times, with_band};
use super::impact_march::khz;
use super::impact_sheet::{ContactSheet, ImpactSheet, SEED};
use crate::bodies::material_sheet::Materials;
use crate::bodies::replacement::Replacement;
use crate::digits::with_unit;
use crate::job::JobContext;
use crate::outcome::{Quantity, Table};
use crate::sheet::Exact;
use crate::{InStep, Outcome, RodlabError};

/// Fraction of the peak below which the force counts as ringing of the band limit, not as
/// separation.
const THRESHOLD: f64 = 0.01;

/// Samples of the history per time step of the inverse Fourier transform of the lines. Linear
/// interpolation over whole steps would miss peaks and zeros.
const INTERPOLATION: usize = 16;

const DRAWS: usize = 400;
/// Number of draws for the band of the whole contact; its width is a quantile of the largest
/// deviation.
const DRAWS_OF_BAND: usize = 1000;

/// The stick force with its errors.
pub(super) struct OnLines {
    pub(super) stick: StickForce,
    pub(super) bands: Option<Bands>,
    /// Highest frequency, and beginning of the roll-off \[Hz\].
    highest_hz: f64,
    roll_off_from_hz: Option<f64>,
    /// The force until the faces part.
    pub(super) impact: ImpactForce,
    /// Impulse of the first contact.
    impulse: Option<ContactImpulse>,
    /// Reason why there are no bands, or the errors that the bands contain.
    about_errors: &'static str,
}

/// Errors of a stick force and of the impact force.
pub(super) struct Bands {
    pub(super) level: f64,
    pub(super) error: ForceError,
    pub(super) pointwise: ForceBand,
    pub(super) simultaneous: ForceBand,
    pub(super) end: Option<EndError>,
    pub(super) draws: MonteCarlo,
    /// Limits of the end of the first contact \[s\], from the draws.
    limits_of_end: Option<[f64; 2]>,
    /// Band of the impact force, from draws.
    pub(super) contact: ForceBand,
}

/// Computes the stick force if the sheet requests it or a body is measured; otherwise returns
/// `None`.
pub(super) fn on_lines(
    sheet: &ImpactSheet,
    materials: &Materials,
    bodies: [&FaceBody; 2],
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<Option<OnLines>, RodlabError> {
    let Some((step_hz, n_lines)) = grid(sheet, bodies)? else {
        return Ok(None);
    };
    let first = bodies[0].lines(step_hz, n_lines, "problem.first")?;
    let second = bodies[1].lines(step_hz, n_lines, "problem.second")?;
    let highest_hz = (n_lines - 1) as f64 * step_hz;
    let marched = bodies.iter().all(|body| body.can_be_marched());
    let roll_off_from_hz = sheet
        .lines
        .as_ref()
        .and_then(|lines| lines.roll_off_from.as_ref())
        .map(Exact::si)
        .or((!marched && sheet.lines.is_none()).then_some(0.5 * highest_hz));
    let masses = bodies.map(FaceBody::mass);
    let inverse: f64 = masses.iter().flatten().map(|(mass, _)| 1.0 / mass).sum();
    let effective = 1.0 / inverse;
    let problem = StickProblem {
        first: &first,
        second: &second,
        frequency_step_hz: step_hz,
        impact_velocity: sheet.velocity.with_uncertainty().value,
        zero_line: if inverse > 0.0 {
            ZeroLine::EffectiveMass(effective)
        } else {
            ZeroLine::SquareWave
        },
        roll_off_from_hz,
        interpolation: INTERPOLATION,
        until: Some(sheet.duration.si()),
    };
    let stick = problem.solve().in_step("problem.lines")?;
    if let impulse::Settlement::Unsettled { relative_level } = stick.settlement {
        outcome.warn(format!(
            "The stick force on lines has not died out within its period: {relative_level:.2e} of the peak remains and has wrapped around."
        ));
    }
    let uncertainty = StickUncertainty {
        first_variance: bodies[0].variance(n_lines),
        second_variance: bodies[1].variance(n_lines),
        first_scale: bodies[0].scale(),
        second_scale: bodies[1].scale(),
        first_delay: bodies[0].delay(),
        second_delay: bodies[1].delay(),
        impact_velocity: sheet.velocity.with_uncertainty().uncertainty(),
        // error of the effective mass: dM = M^2 ((dM1/M1^2)^2 + (dM2/M2^2)^2)^(1/2)
        effective_mass: if inverse > 0.0 {
            let parts = masses.iter().flatten();
            let square: f64 = parts
                .map(|(mass, error)| (error / mass.powi(2)).powi(2))
                .sum();
            effective.powi(2) * square.sqrt()
        } else {
            0.0
        },
    };
    let anything = !uncertainty.is_zero();
    let history = &stick.history;
    let threshold = THRESHOLD * history.peak().force.abs();
    let impact = separate(history, threshold).in_step("problem.lines")?;
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut draws = Draws::by(&mut random);
    let materials = draws.materials(materials)?;
    for (body, sheet) in bodies.iter().zip([&sheet.first, &sheet.second]) {
        if body.measured().is_none() {
            body.drawn(sheet, &materials, "problem", &mut draws)?;
        }
    }
    let about_errors = if !matches!(sheet.contact, ContactSheet::Rigid) {
        "no error: the contact is compliant, and the stick force is that of a rigid contact"
    } else if draws.n_drawn > 0 {
        "no error: the ± of a computed body is not propagated to the force on lines"
    } else if !anything {
        "no error: no quantity is stated with ±"
    } else {
        "errors of mobilities, scales, delays, masses and velocity"
    };
    let has_bands = anything && draws.n_drawn == 0 && context.draw.is_none();
    let bands = if has_bands && matches!(sheet.contact, ContactSheet::Rigid) {
        Some(bands(
            sheet,
            &problem,
            &uncertainty,
            (&stick, &impact),
            outcome,
        )?)
    } else {
        None
    };
    let impulse = problem
        .contact_impulse(threshold)
        .in_step("problem.lines")?;
    Ok(Some(OnLines {
        impulse,
        stick,
        bands,
        highest_hz,
        roll_off_from_hz,
        impact,
        about_errors,
    }))
}

/// Returns spacing \[Hz\] and number of the lines; `None` if the sheet requests no lines and no
/// body is measured.
fn grid(sheet: &ImpactSheet, bodies: [&FaceBody; 2]) -> Result<Option<(f64, usize)>, RodlabError> {
    let mut measured = bodies.iter().filter_map(|body| body.measured());
    let field = "problem.lines.samples";
    let Some(first) = measured.next() else {
        let Some(lines) = &sheet.lines else {
            return Ok(None);
        };
        let samples = match lines.samples {
            Some(samples) if samples >= 4 && samples.is_multiple_of(2) => samples,
            other => {
                return Err(RodlabError::request(
                    field,
                    other.map_or("not stated".to_owned(), |n| n.to_string()),
                    "an even number of at least 4, such as 2048",
                ));
            }
        };
        let n_lines = samples / 2 + 1;
        return Ok(Some((lines.up_to.si() / (n_lines - 1) as f64, n_lines)));
    };
    if let Some(samples) = sheet.lines.as_ref().and_then(|lines| lines.samples) {
        return Err(RodlabError::request(
            field,
            samples.to_string(),
            "no value: the lines are those of the measured body",
        ));
    }
    let step_hz = first.frequency_step_hz();
    let mut n_lines = first.mobility().len();
    if let Some(second) = measured.next() {
        n_lines = n_lines.min(second.mobility().len());
    }
    let lines = sheet.lines.as_ref().map(|lines| &lines.up_to);
    if let Some(up_to) = lines.or(sheet.band.as_ref()) {
        let limit = up_to.si() / step_hz + 1e-6;
        n_lines = (0..n_lines)
            .take_while(|line| *line as f64 <= limit)
            .count();
    }
    Ok(Some((step_hz, n_lines)))
}

fn bands(
    sheet: &ImpactSheet,
    problem: &StickProblem<'_>,
    uncertainty: &StickUncertainty<'_>,
    (stick, impact): (&StickForce, &ImpactForce),
    outcome: &mut Outcome,
) -> Result<Bands, RodlabError> {
    let chosen = sheet.uncertainty.clone().unwrap_or_default();
    let (draws, level, mut random) = chosen.settled(DRAWS, outcome);
    let history = &stick.history;
    let error = problem.error(uncertainty).in_step("problem.uncertainty")?;
    let threshold = THRESHOLD * history.peak().force.abs();
    let drawn = uncertainty
        .monte_carlo(problem, threshold, draws, &mut random)
        .in_step("problem.uncertainty")?;
    let last_line = (problem.first.len() - 1) as f64;
    let period = 1.0 / (problem.frequency_step_hz * last_line);
    Ok(Bands {
        level,
        pointwise: error
            .pointwise(history, level)
            .in_step("problem.uncertainty")?,
        simultaneous: error
            .simultaneous(
                history,
                level,
                impact.span(period),
                DRAWS_OF_BAND,
                &mut random,
            )
            .in_step("problem.uncertainty")?,
        end: error.contact_end(history, impact),
        contact: drawn.contact_band(level).in_step("problem.uncertainty")?,
        limits_of_end: drawn
            .contact_end_limits(level)
            .in_step("problem.uncertainty")?,
        draws: drawn,
        error,
    })
}

impl OnLines {
    /// Returns the standard error of the stick force at `time`, if it is known.
    fn error_at(&self, time: f64) -> Option<f64> {
        let index = self.stick.history.index_near(time)?;
        let bands = self.bands.as_ref()?;
        bands.error.standard_error().get(index).copied()
    }

    /// Returns the time \[s\] at which the faces part, and its standard error.
    fn end(&self) -> (Option<f64>, Option<f64>) {
        let end = match self.impact.end {
            ContactEnd::Separated { time } => Some(time),
            _ => None,
        };
        let error = self.bands.as_ref().and_then(|bands| bands.end);
        let linear = error.filter(|end| end.verdict == EndVerdict::Linear);
        (end, linear.map(|end| end.standard_error))
    }

    /// Returns the largest force of the first contact. Later, the force on lines is that of faces
    /// that stick together.
    fn peak(&self) -> ForcePeak {
        self.impact.history.smooth_peak()
    }

    /// Returns the standard error of the impulse of the first contact \[N s\], from the draws and
    /// the extrapolation to a force without a band limit; `None` if there is a draw in which the
    /// faces do not part.
    fn impulse_error(&self) -> Option<f64> {
        let deviation = self.bands.as_ref()?.draws.impulse_deviation()?;
        Some(deviation.hypot(self.impulse?.by_band?))
    }

    /// Returns the table of the force until the faces part.
    pub(super) fn until_the_faces_part(&self) -> Table {
        let history = &self.impact.history;
        let title = format!(
            "Force on lines up to {} kHz until the faces part",
            khz(self.highest_hz)
        );
        let table = Table::new("force", title)
            .numbers("time", "s", times(history))
            .numbers("force on lines", "N", history.force());
        match &self.bands {
            Some(bands) => {
                let errors = bands.error.standard_error();
                table.numbers("standard error of the stick force", "N", errors)
            }
            None => table,
        }
    }

    /// Returns sentences about the force on lines, for a result without a march.
    pub(super) fn answer(&self, sheet: &ImpactSheet) -> Vec<String> {
        let peak = self.peak();
        let roll_off = self.roll_off_from_hz.map_or_else(String::new, |from| {
            format!(", rolled off from {} kHz", khz(from))
        });
        let (end, end_error) = self.end();
        let parted = end.map_or_else(
            || "The faces do not part within the history".to_owned(),
            |end| format!("The faces part at {}", with_unit(end, end_error, "s")),
        );
        let impulse = self.impulse.map_or_else(String::new, |impulse| {
            format!(
                "; the impulse until then is {}",
                with_unit(impulse.impulse, self.impulse_error(), "N s")
            )
        });
        vec![
            format!(
                "On lines up to {} kHz{roll_off} the peak force is {} at {:.4} ms, at an impact velocity of {}.",
                khz(self.highest_hz),
                with_unit(peak.force, self.error_at(peak.time), "N"),
                1e3 * peak.time,
                sheet.velocity,
            ),
            format!("{parted}{impulse}."),
        ]
    }

    /// Returns the numbers of the force on lines. The impulse is included if the force on lines is
    /// `alone`, that is without a march.
    pub(super) fn quantities(&self, alone: bool) -> Vec<Quantity> {
        let peak = self.peak();
        let settled = matches!(self.stick.settlement, impulse::Settlement::Settled);
        let in_words = |about: &str| {
            let died_out = if settled {
                "the force has died out within its period"
            } else {
                "the force has not died out within its period"
            };
            format!("{about}; {died_out}; {}", self.about_errors)
        };
        let band = format!("up to {} kHz", khz(self.highest_hz));
        let name = "peak of the stick force on lines";
        let of_peak = Quantity::of(name, "N", peak.force, in_words(&band));
        let of_peak = of_peak.with_error(self.error_at(peak.time));
        let mut found = vec![of_peak.valid_if(settled)];
        if alone {
            let impulse = self.impulse.map(|impulse| impulse.impulse);
            let verdict = in_words(
                "of the first contact, from the force on lines, extrapolated from half the band and the whole band to a band without a limit",
            );
            let quantity = Quantity::of("impulse", "N s", impulse, verdict);
            let quantity = quantity.with_error(self.impulse_error());
            found.push(quantity.valid_if(settled && impulse.is_some()));
        }
        let (end, end_error) = self.end();
        let verdict = match (end, self.bands.as_ref().and_then(|bands| bands.end)) {
            (None, _) => "the faces do not part".to_owned(),
            (_, None) => self.about_errors.to_owned(),
            (_, Some(end)) => match end.verdict {
                EndVerdict::Linear => {
                    "zero of the force on lines; within two standard errors of the zero, the force is linear in time"
                        .to_owned()
                }
                EndVerdict::Curved { deviation } => format!(
                    "the force deviates from a straight line by {deviation:.1} standard errors near its zero: see the limits by draws"
                ),
                EndVerdict::MayEndEarlier { time, probability } => format!(
                    "the faces may have parted at {:.4} ms already, with a probability of {probability:.3}",
                    1e3 * time
                ),
                _ => "not known".to_owned(),
            },
        };
        let [end, error] = [end, end_error].map(|time| time.map(|time| 1e3 * time));
        let end = Quantity::of("end of the first contact on lines", "ms", end, verdict);
        found.push(end.with_error(error).valid_if(error.is_some()));
        let Some(bands) = &self.bands else {
            return found;
        };
        let limits = bands
            .limits_of_end
            .map_or([None; 2], |limits| limits.map(Some));
        for (name, limit) in ["lower", "upper"].into_iter().zip(limits) {
            let without_end = bands.draws.without_end;
            let verdict = format!(
                "from {} draws, in {without_end} of which the faces do not part",
                bands.draws.contact_ends.len() + without_end,
            );
            let name = format!("{name} limit of the end of the first contact");
            let limit = Quantity::of(name, "ms", limit.map(|time| 1e3 * time), verdict);
            let is_known = limit.valid && without_end == 0;
            found.push(limit.valid_if(is_known));
        }
        found
    }

    pub(super) fn table(&self) -> Table {
        let history = &self.stick.history;
        let mut table = Table::new("stick_force", "Stick force on lines")
            .numbers("time", "s", times(history))
            .numbers("stick force", "N", history.force());
        if let Some(bands) = &self.bands {
            let parting = self.impact.history.force();
            table = table.numbers("standard error", "N", bands.error.standard_error());
            table = with_band(table, "pointwise band", &bands.pointwise);
            table = with_band(table, "band of the whole contact", &bands.simultaneous);
            table = table.numbers("force until the faces part", "N", parting);
            table = with_band(table, "band by draws", &bands.contact);
        }
        table
    }
}
