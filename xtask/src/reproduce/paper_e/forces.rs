//! Force histories of the four impacts: from gauges on the rod; by method (I), one body measured
//! and one predicted; and by method (II), both bodies predicted.

use impulse::{
    ContactEnd, EndVerdict, ForceBand, ForceHistory, Impact, LineBand, Prediction, StickProblem,
    StickUncertainty, ZeroLine, contact_band, lines_of, separate,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rodwave::experiment::impact_of_two_bodies::ImpactOfTwoBodies;
use serde::Serialize;

use super::super::Error;
use super::measurement::{self, Measurement, SEED};
use testbed::papers::paper_e::PaperE;
use testbed::papers::paper_e::bodies::Face;

/// Duration of the histories from the gauges, in s. They end before the echo from the far end of
/// the rod arrives.
const GAUGED: f64 = 2.3e-3;
/// Ratio of the sampling rate of the computed histories to that of the gauges.
const FINER: usize = 4;
/// Standard deviation of the noise of a strain; the paper does not state it.
pub(crate) const STRAIN_NOISE: f64 = 2e-7;
/// Duration of the marches, in s: long enough for the ringing of the bodies to end.
const MARCHED: f64 = 40e-3;
/// Largest tension that counts as ringing or noise, as a fraction of the largest force. A larger
/// tension means that the faces separate.
const THRESHOLD: f64 = 0.02;
/// Probability of the bands.
pub(crate) const LEVEL: f64 = 0.95;
/// Shortest duration of a contact or a separation that is counted, in s.
const SHORTEST: f64 = 20e-6;
/// Start of the comparison with the force from the gauges, in s. It is after the initial jump,
/// which each method smooths differently.
const COMPARED: f64 = 0.1e-3;

/// Force of a face on the long rod by every method.
#[derive(Debug)]
pub(crate) struct Forces {
    pub(crate) face: Face,
    pub(crate) velocity: f64,
    /// History from the gauges, until the contact has ended.
    pub(crate) gauges: ForceHistory,
    /// Force on the lines of (I), before separation is applied: of the virtual body itself, without
    /// the errors of a measurement, and of the measured body.
    pub(crate) truth: ForceHistory,
    pub(crate) stick: ForceHistory,
    pub(crate) stick_band: ForceBand,
    /// Method (I) as in the paper: on the lines of the measurement, until separation.
    pub(crate) measured: ForceHistory,
    pub(crate) band: ForceBand,
    /// Method (II) as in the paper: by eq. 7 on the lines of the paper, until separation.
    pub(crate) predicted: ForceHistory,
    /// Method (II), marched with the causal law: the faces may separate and meet again.
    pub(crate) marched: ForceHistory,
    pub(crate) rows: Vec<Row>,
    pub(crate) uncertainty: Uncertainty,
}

/// Result for one face by one method.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    pub(crate) face: &'static str,
    pub(crate) way: &'static str,
    /// Peak force in N and its time in s.
    pub(crate) peak: f64,
    pub(crate) peak_time: f64,
    /// Time from the start of the contact to the first separation, in s.
    pub(crate) end: Option<f64>,
    /// End of the contact by eq. 3 exactly as printed, in s: the first sample below zero.
    pub(crate) to_the_letter: Option<f64>,
    /// Fractions of the impulse after the first separation, and after the end of the contact by the
    /// gauges, if that is before the first separation.
    pub(crate) missed: Option<[f64; 2]>,
    /// Times at which the later contacts begin and end, in s; `None` if the method gives only one
    /// contact.
    pub(crate) again: Option<Vec<[f64; 2]>>,
    /// Impulse in N s.
    pub(crate) impulse: f64,
    /// Momentum M_1 V in N s.
    pub(crate) momentum: f64,
    pub(crate) restitution: f64,
    /// Root mean square of the difference from the force of the gauges, relative to the peak.
    pub(crate) off_gauges: Option<f64>,
    pub(crate) balance: Option<Residuals>,
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Residuals {
    /// Residual (W_1 - W_2 - W_c)/(VJ) of the energy balance.
    #[serde(rename = "at_rounding")]
    pub(crate) energy: f64,
    /// Residual of the momentum balance relative to M_1 V, with the observed rebound of the face.
    pub(crate) momentum: Option<f64>,
}

/// Uncertainty of method (I).
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Uncertainty {
    pub(crate) face: &'static str,
    /// Standard errors of the force in N, and of the end of the contact in s.
    pub(crate) force: f64,
    pub(crate) end: Option<f64>,
    /// Time of a minimum of the force, and the probability that the faces separate there.
    pub(crate) may_end_earlier: Option<(f64, f64)>,
    /// Standard error of the force in N if both hammers are used on every line.
    pub(crate) force_by_variance: f64,
    /// Fraction of the exact history of the virtual body, on the same lines, that is within the
    /// band.
    pub(crate) inside: f64,
    /// Result of the screening of the measured body.
    pub(crate) screening: Vec<String>,
}

pub(crate) fn of(paper: &PaperE, face: Face, measurement: &Measurement) -> Result<Forces, Error> {
    let velocity = paper.case(face)?.impact_velocity;
    let momentum = paper.mass(face)? * velocity;
    let rod = paper.long_rod()?;
    let (gauges, until) = gauges(paper, face, velocity)?;
    let row = |way, history: &ForceHistory, again: Option<Vec<[f64; 2]>>, end: Option<f64>| {
        let peak = history.peak();
        Row {
            face: face.name(),
            way,
            peak: peak.force,
            peak_time: peak.time,
            end,
            again,
            to_the_letter: None,
            missed: None,
            impulse: history.impulse(),
            momentum,
            restitution: history.impulse() / momentum - 1.0,
            off_gauges: None,
            balance: None,
        }
    };
    let single = |way, stick: &ForceHistory| -> Result<(ForceHistory, Row), Error> {
        let impact = separate(stick, THRESHOLD * stick.peak().force)?;
        let time = |end: ContactEnd| match end {
            ContactEnd::Separated { time } => Some(time),
            _ => None,
        };
        let mut row = row(way, &impact.history, None, time(impact.end));
        row.to_the_letter = time(separate(stick, 0.0)?.end);
        Ok((impact.history, row))
    };
    let gauge_row = row("gauges", &gauges, None, Some(until));
    let compared = |row: Row, history: &ForceHistory| Row {
        off_gauges: Some(difference(&gauges, history, until)),
        ..row
    };
    let marched = |way, prediction: &Prediction| {
        let mut contacts = prediction
            .contacts
            .iter()
            .filter_map(|contact| Some([contact.begin, contact.end?]))
            .filter(|[begin, end]| end - begin > SHORTEST);
        // contacts with a separation shorter than `SHORTEST` between them count as one contact
        let mut merged: Vec<[f64; 2]> = Vec::new();
        for [begin, end] in contacts.by_ref() {
            match merged.last_mut() {
                Some(last) if begin - last[1] < SHORTEST => last[1] = end,
                _ => merged.push([begin, end]),
            }
        }
        let end = merged.first().map(|first| first[1]);
        let again = merged.get(1..).map(<[_]>::to_vec);
        let impulse_after = |time: f64| {
            let history = &prediction.history;
            let late = (0..history.force().len()).filter(|n| history.time_at(*n) > time);
            late.map(|n| history.force()[n]).sum::<f64>() * history.time_step() / history.impulse()
        };
        let mut row = row(way, &prediction.history, again, end);
        row.missed = end.map(|end| [end, until.min(end)].map(impulse_after));
        let balance = prediction.balance();
        row.balance = Some(Residuals {
            energy: balance.energy_residual,
            momentum: balance.momentum_residual,
        });
        compared(row, &prediction.history)
    };

    let n_lines = paper.n_lines();
    let step_hz = measurement.frequency_step_hz;
    let rod_lines = lines_of(&rod, step_hz, n_lines)?;
    let problem = |body| StickProblem {
        first: body,
        second: &rod_lines,
        frequency_step_hz: step_hz,
        impact_velocity: velocity,
        zero_line: ZeroLine::EffectiveMass(momentum / velocity),
        roll_off_from_hz: None,
        interpolation: 1,
        until: None,
    };
    let first = problem(&measurement.larger_force.mobility);
    let error = first.error(&StickUncertainty {
        first_variance: Some(&measurement.larger_force.variance),
        ..StickUncertainty::default()
    })?;
    let by_variance = problem(&measurement.inverse_variance.mobility).error(&StickUncertainty {
        first_variance: Some(&measurement.inverse_variance.variance),
        ..StickUncertainty::default()
    })?;
    let stick = first.solve()?.history;
    let (measured, measured_row) = single("(I) on lines", &stick)?;
    let contact = stick
        .index_near(0.0)
        .ok_or("the history does not contain the contact")?;
    let last = stick
        .index_near(GAUGED)
        .ok_or("the history is shorter than 2.3 ms")?;
    let mut random = ChaCha8Rng::seed_from_u64(SEED + 1);
    let stick_band = error.simultaneous(&stick, LEVEL, contact..last, 1000, &mut random)?;
    let impact = separate(&stick, THRESHOLD * stick.peak().force)?;
    let band = contact_band(&stick_band, &impact);
    // true values of the virtual body, on the same lines and with the same band limit
    let truth = lines_of(&paper.causal(face)?, step_hz, n_lines)?;
    let truth = problem(&truth).solve()?.history;
    let contact_end = error.contact_end(&stick, &impact);

    let body = measurement::on_lines(
        paper,
        face,
        &measurement.larger_force.mobility,
        Some(&measurement.larger_force.variance),
    )?;
    let march_step = paper.sample_period / 8.0;
    let march = |first: &dyn impulse::ImpactBody| {
        Impact::between(first, &rod)
            .at_velocity(velocity)
            .in_steps_of(march_step)
            .predict(MARCHED)
    };
    let measured_march = march(&body)?;
    let printed = paper.printed(face)?;
    let line_band = LineBand {
        highest_hz: paper.predicted_highest_hz,
        n_samples: paper.predicted_samples as usize,
    };
    let predicted = Impact::between(&printed, &rod)
        .at_velocity(velocity)
        .stick_force_on_lines(line_band)?;
    let (predicted, predicted_row) = single("(II) on lines", &predicted.history)?;
    let causal = paper.causal(face)?;
    let causal_march = march(&causal)?;

    let rows = vec![
        gauge_row,
        compared(measured_row, &measured),
        marched("(I) marched", &measured_march),
        compared(predicted_row, &predicted),
        marched("(II) marched", &causal_march),
    ];
    Ok(Forces {
        face,
        velocity,
        uncertainty: Uncertainty {
            face: face.name(),
            force: error.standard_error()[contact],
            end: contact_end.map(|end| end.standard_error),
            may_end_earlier: contact_end.and_then(|end| match end.verdict {
                EndVerdict::MayEndEarlier { time, probability } => Some((time, probability)),
                _ => None,
            }),
            force_by_variance: by_variance.standard_error()[contact],
            inside: stick_band.part_inside(truth.force(), contact..last),
            screening: body
                .screen()
                .flags()
                .iter()
                .map(ToString::to_string)
                .collect(),
        },
        gauges,
        truth,
        stick,
        stick_band,
        measured,
        band,
        predicted,
        marched: causal_march.history,
        rows,
    })
}

/// Returns F(t) = -AEε(t + t_tr) from gauges on the rod, with noise of the strain, and the time at
/// which the contact ends. The impact is computed by the damped Fourier transform; the contact ends
/// at the first zero of the stick force.
fn gauges(paper: &PaperE, face: Face, velocity: f64) -> Result<(ForceHistory, f64), Error> {
    let body = paper.causal(face)?;
    let rod = paper.gauged_rod()?;
    let interval = paper.strain_sample_period / FINER as f64;
    let record = ImpactOfTwoBodies {
        first: &body,
        second: &rod,
        velocity,
    }
    .run(GAUGED, interval)?;
    let force = record.transmitted_force(0, paper.gauge_distance)?;
    let mut random = ChaCha8Rng::seed_from_u64(SEED + 2);
    let axial_stiffness = paper.rod_impedance()?.powi(2)
        / (paper.steel_density * std::f64::consts::PI * (0.5 * paper.rod_diameter).powi(2));
    let sampled = force
        .iter()
        .step_by(FINER)
        .map(|force| {
            let noise: f64 = random.sample(StandardNormal);
            force + axial_stiffness * STRAIN_NOISE * noise
        })
        .collect();
    let transit = paper.gauge_distance / (paper.steel_modulus / paper.steel_density).sqrt();
    let history = ForceHistory::new(record.start - transit, paper.strain_sample_period, sampled)?;
    let end = match record.end {
        rodwave::experiment::impact_of_two_bodies::ContactEnd::Separated { time } => time,
        _ => GAUGED - transit,
    };
    Ok((history, end))
}

/// Returns the root mean square of the difference relative to the peak, from [`COMPARED`] to 95 %
/// of `until`, the end of the contact.
fn difference(gauges: &ForceHistory, other: &ForceHistory, until: f64) -> f64 {
    let squares: Vec<f64> = gauges
        .force()
        .iter()
        .enumerate()
        .map(|(index, force)| (gauges.time_at(index), force))
        .filter(|(time, _)| (COMPARED..0.95 * until).contains(time))
        .filter_map(|(time, force)| Some((force - at(other, time)?).powi(2)))
        .collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    mean.sqrt() / gauges.peak().force
}

/// Returns the value of a history, interpolated linearly between its samples; `None` outside them.
fn at(history: &ForceHistory, time: f64) -> Option<f64> {
    let nearest = history.index_near(time)?;
    let before = if history.time_at(nearest) > time {
        nearest.checked_sub(1)?
    } else {
        nearest
    };
    let fraction = (time - history.time_at(before)) / history.time_step();
    let [low, high] = [
        *history.force().get(before)?,
        *history.force().get(before + 1)?,
    ];
    Some(low + fraction * (high - low))
}
