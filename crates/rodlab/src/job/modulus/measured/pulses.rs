//! Pulses cut out of the hits, and their ratio.

use cmod::noise_of_cut_pulse;
use labio::{AveragedSpectra, Channel, Record, Window};
use ndarray::Array2;

use super::Ratio;
use super::ratio::averaged_ratio;
use super::shot::{Shot, ShotChannel};
use crate::RodlabError;
use crate::job::modulus::method::WindowSheet;
use crate::sheet::{Exact, Time};

/// Names of the two pulses in the records made of them.
const EARLIER: &str = "earlier pulse";
const LATER: &str = "later pulse";

/// A stretch of a channel.
struct Cut<'a> {
    channel: &'a str,
    from: &'a Exact<Time>,
    to: &'a Exact<Time>,
    field: &'static str,
}

/// One pulse at two sections.
pub(super) fn separate<'a>(
    hits: &[&Record],
    silent: Option<usize>,
    first: &'a WindowSheet,
    second: &'a WindowSheet,
) -> Result<Ratio, RodlabError> {
    let cut = |window: &'a WindowSheet, field| Cut {
        channel: &window.channel,
        from: &window.from,
        to: &window.to,
        field,
    };
    ratio(
        hits,
        silent,
        &[cut(first, "method.first"), cut(second, "method.second")],
    )
}

/// The incident and the reflected pulse at one section.
pub(super) fn reflected(
    hits: &[&Record],
    silent: Option<usize>,
    channel: &str,
    incident: &(Exact<Time>, Exact<Time>),
    reflected: &(Exact<Time>, Exact<Time>),
) -> Result<Ratio, RodlabError> {
    let cut = |(from, to), field| Cut {
        channel,
        from,
        to,
        field,
    };
    let (incident, reflected) = ((&incident.0, &incident.1), (&reflected.0, &reflected.1));
    ratio(
        hits,
        silent,
        &[
            cut(incident, "method.incident"),
            cut(reflected, "method.reflected"),
        ],
    )
}

/// The ratio of the later pulse to the earlier one. The part cut off by the windows is not a random
/// error, but its size is added to the variance from the coherence, or from the silence before a
/// single hit.
fn ratio(
    hits: &[&Record],
    silent: Option<usize>,
    cuts: &[Cut<'_>; 2],
) -> Result<Ratio, RodlabError> {
    let mut pulses = Vec::with_capacity(hits.len());
    let mut edges = [[0.0; 2]; 2];
    let mut delay = 0.0;
    let mut repeated: f64 = 1.0;
    let mut durations = [0.0; 2];
    for hit in hits {
        let Pulses {
            record: pulse,
            edges: edges_of_hit,
            centres: [earlier, later],
            lengths,
        } = pulses_of(hit, cuts)?;
        durations = lengths.map(|length| length as f64 / hit.sampling_rate_hz());
        let [earlier_length, later_length] = lengths;
        let shortest = earlier_length.min(later_length);
        delay += (later - earlier) / hits.len() as f64;
        // noise over the length of the shorter window, in an otherwise silent record
        repeated = repeated.max(hit.n_samples() as f64 / shortest as f64);
        for (sums, of_hit) in edges.iter_mut().zip(edges_of_hit) {
            for (sum, edge) in sums.iter_mut().zip(of_hit) {
                *sum += edge / hits.len() as f64;
            }
        }
        pulses.push(pulse);
    }
    let mut ratio = match (hits, silent, &pulses[..]) {
        ([hit], Some(silent), [pulse]) => {
            let [earlier, later] = cuts;
            let channel = |name, at_rest, duration| ShotChannel {
                name,
                at_rest,
                duration,
            };
            let [of_earlier, of_later] = durations;
            let shot = Shot {
                hit,
                silent,
                record: pulse,
            };
            shot.ratio(
                &channel(LATER, later.channel, of_later),
                &channel(EARLIER, earlier.channel, of_earlier),
                repeated,
            )?
        }
        _ => averaged_ratio(&pulses, LATER, EARLIER, repeated)?,
    };
    ratio.delay = (delay > 0.0).then_some(delay);
    let cutting = |error| RodlabError::step("the error of cut pulses", error);
    let averaging = |error| RodlabError::step("averaging the pulses", error);
    let spectra = AveragedSpectra::of(&pulses, Window::Rectangular).map_err(averaging)?;
    let lines = ratio.frequency_hz.get(1..).unwrap_or_default();
    for (name, edges) in [EARLIER, LATER].iter().zip(edges) {
        let energy = spectra.auto(name).map_err(averaging)?;
        let noise = noise_of_cut_pulse(0.0, edges, lines).map_err(cutting)?;
        let of_ratio = ratio.variance.iter_mut().zip(&ratio.values);
        let freedom = ratio.freedom.iter_mut().flatten();
        // the line at 0 Hz does not depend on the modulus, and has no such error
        let above_zero = of_ratio.zip(freedom).zip(&energy).skip(1);
        for ((((variance, value), freedom), energy), noise) in above_zero.zip(&noise) {
            // the energy of a one-sided line is twice |q|²
            let relative = 2.0 * noise * noise / energy;
            let cut = value.norm_sqr() * relative;
            *freedom = freedom.with_known_part(*variance, cut);
            *variance += cut;
        }
    }
    Ok(ratio)
}

/// The two pulses of a hit.
struct Pulses {
    /// Both pulses in an otherwise silent record.
    record: Record,
    /// The values at the edges of each.
    edges: [[f64; 2]; 2],
    /// Centre of the energy of each \[s\].
    centres: [f64; 2],
    /// Samples of each.
    lengths: [usize; 2],
}

#[allow(
    clippy::indexing_slicing,
    reason = "the stretch is of three samples or more and ends within the hit; the rows are those of the two pulses"
)]
fn pulses_of(hit: &Record, cuts: &[Cut<'_>; 2]) -> Result<Pulses, RodlabError> {
    let refused = |error| RodlabError::step("cutting a pulse out of a hit", error);
    let mut samples = Array2::zeros((2, hit.n_samples()));
    let mut edges = [[0.0; 2]; 2];
    let mut centres = [0.0; 2];
    let mut lengths = [0; 2];
    let mut channels = Vec::with_capacity(2);
    for (row, (cut, name)) in cuts.iter().zip([EARLIER, LATER]).enumerate() {
        let history = hit.channel(cut.channel).map_err(refused)?;
        let [from, to] = [cut.from, cut.to].map(|time| sample_at(time.si(), hit));
        let range = match (from, to) {
            (Some(from), Some(to)) if from + 2 < to && to < hit.n_samples() => from..to,
            _ => {
                return Err(RodlabError::request(
                    cut.field,
                    format!("\"{}\" to \"{}\"", cut.from, cut.to),
                    format!(
                        "a stretch of the record of a hit, 0 to {:.4} ms",
                        1e3 * hit.duration()
                    ),
                ));
            }
        };
        edges[row] = [history[range.start], history[range.end - 1]];
        lengths[row] = range.len();
        let (mut energy, mut moment) = (0.0, 0.0);
        for index in range {
            samples[[row, index]] = history[index];
            energy += history[index].powi(2);
            moment += index as f64 * history[index].powi(2);
        }
        centres[row] = moment / energy / hit.sampling_rate_hz();
        let quantity = hit
            .channels()
            .iter()
            .find(|channel| channel.name() == cut.channel)
            .map(Channel::quantity);
        if let Some(quantity) = quantity {
            channels.push(Channel::new(name, quantity).map_err(refused)?);
        }
    }
    let record = Record::new(
        samples,
        hit.sampling_rate_hz(),
        hit.start_time(),
        channels,
        hit.provenance().clone(),
    );
    Ok(Pulses {
        record: record.map_err(refused)?,
        edges,
        centres,
        lengths,
    })
}

/// The sample nearest to `time` \[s\] from the beginning of the hit.
fn sample_at(time: f64, hit: &Record) -> Option<usize> {
    labio::hits::Extent::Seconds(time)
        .samples(hit.sampling_rate_hz())
        .ok()
}
