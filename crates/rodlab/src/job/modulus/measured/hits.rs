//! Ratios, spectra of gauges and modes from hits.

use cmod::hit_trend::FEWEST_HITS as FEWEST_HITS_OF_TREND;
use cmod::multi_point::Quantity;
use labio::hits::Reason;
use labio::{AveragedSpectra, Estimator, LabioError, Record, ResponseRatio, Window};

use super::{FirstHit, Measured, Spectra, TailSheet, pulses, vibration};
use crate::RodlabError;
use crate::digits::significant;
use crate::hits::{
    FoundHit, HitKind, HitsSheet, expect_independent, expect_silence, silent_samples, trigger_of,
};
use crate::job::JobContext;
use crate::job::modulus::method::{self, FromHits, MethodSheet, Taken};
use crate::job::modulus::{ModulusSheet, gauges, histories};
use crate::outcome::{Setting, sentence};
use crate::records::{Records, channel_called, expect_motion};
use crate::sheet::{Duration, Exact, plausible};

/// Minimum number of hits for a coherence. The errors of a single hit, and the errors of gauges,
/// are determined from the silence before the hit.
const FEWEST_HITS: usize = 2;

/// Degrees of freedom of a variance below which a warning is given. With 10 degrees of freedom, the
/// interval with the probability of five normal standard errors is 11 standard errors wide on
/// either side.
const FEW_DEGREES_OF_FREEDOM: f64 = 10.0;

pub(super) fn of_hits(
    sheet: &ModulusSheet,
    (records, hits, silent, damping, tail): (
        &Records,
        &HitsSheet,
        Option<&Exact<Duration>>,
        &gauges::Damping,
        TailSheet,
    ),
    context: &JobContext<'_>,
    settings: &mut Vec<Setting>,
) -> Result<Measured, RodlabError> {
    let loaded = records.load(context.folder, "source.hits.records")?;
    if let Some(first) = loaded.records.first() {
        check_channels(&sheet.method, &first.record)?;
        // a band above the Nyquist frequency is refused first, because a wrong sampling rate has
        // many other consequences
        if let Some(band) = &sheet.band {
            plausible::below_nyquist(&band.to, first.record.sampling_rate_hz(), "band.to")?;
        }
    }
    let channels = sheet.method.channels();
    let Some(reference) = channels.first().map(|taken| taken.channel) else {
        return Err(RodlabError::request(
            sheet.method.field("gauges"),
            "empty",
            "at least three gauges",
        ));
    };
    let from_hits = sheet.method.taken_from_hits();
    let kind = match &from_hits {
        FromHits::Pulses { .. } => HitKind::BarPulses,
        FromHits::Gauges { may_ring: true, .. } | FromHits::Modes(_) => HitKind::RingingBar,
        FromHits::Gauges { .. } | FromHits::Ratio(..) => HitKind::Bar,
    };
    let mut found = hits.find_of(kind, loaded.records, reference, "source.hits")?;
    let taken: Vec<&str> = channels.iter().map(|taken| taken.channel).collect();
    // pulses and modes have windows of their own, and hits cut by a trigger have the length that
    // the sheet states
    let is_whole = matches!(from_hits, FromHits::Ratio(..) | FromHits::Gauges { .. });
    if is_whole && tail == TailSheet::LeaveOut && hits.cut.is_none() {
        found.leave_out_tail(&taken, "source.tail")?;
    }
    settings.extend(found.settings().iter().cloned());
    let mut doubts = expect_independent(&[&found], &taken)?;
    if let FromHits::Ratio(numerator, denominator) = &from_hits {
        doubts.extend(found.odd(denominator, &[numerator])?);
    }
    let n_silent = silent_samples(&found, silent, ("source.silent", None), settings)?;
    if let Some((n_silent, stated)) = n_silent.zip(silent) {
        expect_silence(
            &found.accepted(),
            &taken,
            n_silent,
            ("source.hits.silent", stated),
        )?;
    }
    let silent = n_silent;
    let accepted = found.accepted();
    let mut measured = Measured {
        inputs: loaded.inputs,
        log: found.log(),
        figures: match context.draw {
            Some(_) => Vec::new(),
            None => histories::figures(&found, &channels, silent),
        },
        in_words: vec![sentence(&found.in_words())],
        warnings: loaded.warnings,
        quantities: quantities(accepted.first().copied()),
        sampling_rate_hz: accepted.first().map(|hit| hit.sampling_rate_hz()),
        doubts,
        accepted: found
            .hits()
            .enumerate()
            .filter(|(_, hit)| hit.hit.is_accepted())
            .map(|(number, _)| number)
            .collect(),
        n_found: found.n_found(),
        ..Measured::default()
    };
    let is_ratio = matches!(from_hits, FromHits::Ratio(..) | FromHits::Pulses { .. });
    let fewest = if is_ratio && silent.is_none() {
        FEWEST_HITS
    } else {
        1
    };
    if accepted.len() < fewest {
        let all_have = |is: fn(&Reason) -> bool| {
            let has = |hit: FoundHit<'_>| hit.hit.reasons().iter().any(is);
            found.n_found() > 0 && found.hits().all(has)
        };
        let why = if all_have(|reason| matches!(reason, Reason::NotDecayed { .. })) {
            ": the hits end while the rod is still ringing. Record longer, until it is at rest"
        } else if all_have(|reason| matches!(reason, Reason::CutAtStart { .. })) {
            ": the records begin too short a time before the hits. Record with a pre-trigger of about a tenth of the record, or accept a complete hit by hand \
             in `source.hits.hits.accept`"
        } else if fewest == FEWEST_HITS {
            ": the coherence of a single hit is always 1. If the file contains several hits, cut it by `source.hits.hits.cut`. Or state in \
             `source.hits.silent` how long the record is silent before the impact; the errors of one hit are then determined from this silence"
        } else {
            ""
        };
        measured.missing = format!(
            "{} accepted of {} found, expected at least {fewest}{why}",
            if accepted.len() == 1 {
                "1 hit is"
            } else {
                "no hit is"
            },
            found.n_found()
        );
        return Ok(measured);
    }
    let spectra = match from_hits {
        FromHits::Ratio(numerator, denominator) => {
            let ratio = ResponseRatio::of(&accepted, silent, numerator, denominator);
            Spectra::Ratio(ratio.map_err(ratio_refused)?)
        }
        FromHits::Pulses { earlier, later } => {
            let names = [earlier.field.as_str(), later.field.as_str()];
            let earlier = pulses::window(&earlier, &accepted)?;
            let later = pulses::window(&later, &accepted)?;
            let windows = [&earlier, &later];
            let n_rest = pulses::samples_for_level(&accepted, windows, silent)?;
            let other = pulses::between(&accepted, windows, names, n_rest)?;
            measured.doubts.extend(other);
            measured.cut_pulses = pulses::cut(&accepted, windows, names, n_rest)?;
            let ratio = ResponseRatio::of_pulses(&accepted, n_rest, &later, &earlier);
            Spectra::Ratio(ratio.map_err(ratio_refused)?)
        }
        FromHits::Gauges { gauges, .. } => {
            Spectra::Gauges(gauges::of_hits(&accepted, gauges, silent, damping)?)
        }
        FromHits::Modes(vibration) => {
            match vibration::modes(sheet, &vibration, &accepted, &mut measured)? {
                Some(modes) => Spectra::Modes(modes),
                None => return Ok(measured),
            }
        }
    };
    measured.first_hit = found
        .hits()
        .find(|hit| hit.hit.is_accepted())
        .and_then(|hit| {
            let record = hit.hit.record()?;
            Some(FirstHit {
                record: record.clone(),
                silent: silent?,
                trigger: trigger_of(hit.hit, record),
            })
        });
    if !matches!(damping, gauges::Damping::Window(_))
        && let Spectra::Gauges(gauges) = &spectra
        && let Some(window) = gauges.added_damping
    {
        settings.push(Setting::by_default(
            "source.exponential_window",
            format!("time constant {:.4} ms", 1e3 / window.decay_rate()),
        ));
        measured.in_words.push(
            "The records end before the rod is at rest: all gauges were multiplied by the same exponential window, and the modulus was corrected for its damping."
                .to_owned(),
        );
    }
    if let ([_], Spectra::Ratio(ratio)) = (&accepted[..], &spectra)
        && silent.is_some()
    {
        let freedom = ratio.freedom.iter().flatten().map(|freedom| freedom.line);
        let least = freedom.fold(f64::INFINITY, f64::min);
        if least < FEW_DEGREES_OF_FREEDOM {
            measured.warnings.push(format!(
                "The errors of the only hit come from a silence with only {} degrees of freedom per line, so that few lines or none are valid. Record more hits or a longer \
                 pre-trigger.",
                significant(least, 2)
            ));
        }
    }
    let may_have_a_trend = context.draw.is_none() || sheet.temperature.is_some();
    if may_have_a_trend && accepted.len() >= FEWEST_HITS_OF_TREND {
        measured.each = by_hit(&spectra, &accepted, &channels)?;
    }
    measured.spectra = Some(spectra);
    Ok(measured)
}

/// Returns the spectra of each hit alone, with the noise of a single hit; none for pulses and
/// modes.
fn by_hit(
    all: &Spectra,
    hits: &[&Record],
    channels: &[Taken<'_>],
) -> Result<Vec<Spectra>, RodlabError> {
    match (all, channels) {
        (Spectra::Ratio(all), [numerator, denominator]) if all.delay.is_none() => {
            let of = |hit: &&Record| {
                let spectra = AveragedSpectra::of([*hit], Window::Rectangular)?;
                let ratio =
                    spectra.response(Estimator::H1, denominator.channel, numerator.channel)?;
                let n = hits.len() as f64;
                let mut one = all.clone();
                let first = ratio.frequency_hz.len().saturating_sub(all.values.len());
                one.values = ratio.values.into_iter().skip(first).collect();
                for variance in &mut one.variance {
                    *variance *= n;
                }
                Ok(Spectra::Ratio(one))
            };
            let each: Result<Vec<Spectra>, LabioError> = hits.iter().map(of).collect();
            each.map_err(ratio_refused)
        }
        (Spectra::Gauges(all), _) => Ok(all
            .tests
            .iter()
            .map(|test| {
                let mut one = all.clone();
                one.tests = vec![test.clone()];
                Spectra::Gauges(one)
            })
            .collect()),
        _ => Ok(Vec::new()),
    }
}

fn ratio_refused(error: LabioError) -> RodlabError {
    match error {
        LabioError::NoNoise {
            input,
            output,
            hits,
        } => RodlabError::NoNoise {
            place: "source".to_owned(),
            input,
            output,
            hits,
        },
        error @ LabioError::TooFewSamples { .. } => RodlabError::step("source.hits.silent", error),
        error => RodlabError::step("averaging the spectra of the hits", error),
    }
}

/// Checks that the channels of the method exist and have quantities that the method accepts.
fn check_channels(method: &MethodSheet, record: &Record) -> Result<(), RodlabError> {
    let mut first: Option<(&str, labio::Quantity)> = None;
    for taken in method.channels() {
        let channel = channel_called(record.channels(), taken.channel, &taken.field)?;
        let quantity = channel.quantity();
        let is = || format!("`{}`, a channel of {}", taken.channel, quantity.name());
        if taken.motion {
            expect_motion(record, taken.channel, &taken.field)?;
        }
        if method::of_channel(quantity).is_none() {
            let expected = "a channel of strain or of what is proportional to it (force, stress, volts), of acceleration, velocity or displacement";
            return Err(RodlabError::request(taken.field, is(), expected));
        }
        match first {
            Some((name, wanted)) if method.one_quantity() && wanted != quantity => {
                return Err(RodlabError::request(
                    taken.field,
                    is(),
                    format!("{}, like `{name}`", wanted.name()),
                ));
            }
            Some(_) => {}
            None => first = Some((taken.channel, quantity)),
        }
    }
    Ok(())
}

fn quantities(record: Option<&Record>) -> Vec<(String, Quantity)> {
    let channels = record.map(Record::channels).unwrap_or_default();
    channels
        .iter()
        .filter_map(|channel| {
            let quantity = method::of_channel(channel.quantity())?;
            Some((channel.name().to_owned(), quantity))
        })
        .collect()
}
