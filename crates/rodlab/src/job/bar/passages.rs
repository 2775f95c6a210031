//! Passages of the pulse in the first shot: its first sample at each gauge and, for a single gauge,
//! the windows of the incident and the reflected pulse.

use std::ops::Range;

use labio::LabioError;
use labio::hits::Extent;
use labio::ratio::Pulse;

use super::{BarGaugeSheet, BarSheet};
use crate::job::JobContext;
use crate::records::channel_called;
use crate::sheet::{Exact, Time};
use crate::{InStep, RodlabError};

/// Start and end, measured from the beginning of a record.
pub(super) type Window = (Exact<Time>, Exact<Time>);

/// The first shot, and the pulse in it.
pub(super) struct Passages {
    pub(super) rate_hz: f64,
    /// The pulse at each gauge.
    pub(super) pulses: Vec<Pulse>,
    /// Samples of the incident and of the reflected pulse, for a single gauge.
    pub(super) windows: Option<[Range<usize>; 2]>,
}

impl Passages {
    pub(super) fn of(sheet: &BarSheet, context: &JobContext<'_>) -> Result<Self, RodlabError> {
        let loaded = sheet.records.load(context.folder, "records")?;
        let Some(named) = loaded.records.first() else {
            return Err(RodlabError::request(
                "records",
                "no record",
                "a record of a shot",
            ));
        };
        let record = &named.record;
        let rate_hz = record.sampling_rate_hz();
        let silence = Extent::Seconds(sheet.silent.si()).samples(rate_hz);
        let silence = silence.unwrap_or(usize::MAX);
        let mut pulses: Vec<Pulse> = Vec::new();
        for (at, gauge) in sheet.gauges.iter().enumerate() {
            let field = format!("gauges[{at}].channel");
            channel_called(record.channels(), &gauge.channel, &field)?;
            let pulse = Pulse::after_silence(record, &gauge.channel, silence)
                .map_err(|error| no_pulse(error, sheet, at, [silence, record.n_samples()]))?;
            let first = pulse.first_sample;
            if pulses
                .last()
                .is_some_and(|before| before.first_sample >= first)
            {
                return Err(RodlabError::request(
                    format!("gauges[{at}]"),
                    format!(
                        "`{}`, which the pulse reaches after {:.4} ms, earlier than the gauge stated before it",
                        gauge.channel,
                        1e3 * first as f64 / rate_hz
                    ),
                    "gauges in the order in which the pulse passes them: are two channels interchanged, or are the distances measured from the struck end?",
                ));
            }
            pulses.push(pulse);
        }
        let windows = match (pulses.as_slice(), sheet.gauges.as_slice()) {
            ([pulse], [gauge]) => Some(windows_of(pulse, gauge, sheet)?),
            _ => None,
        };
        Ok(Self {
            rate_hz,
            pulses,
            windows,
        })
    }

    /// Returns the windows of a single gauge in the form of a sheet.
    pub(super) fn stated_windows(&self) -> Result<Option<[Window; 2]>, RodlabError> {
        let stated = |window: &Range<usize>| -> Result<Window, RodlabError> {
            Ok((self.time(window.start)?, self.time(window.end)?))
        };
        match &self.windows {
            Some([incident, reflected]) => Ok(Some([stated(incident)?, stated(reflected)?])),
            None => Ok(None),
        }
    }

    /// Returns the time of a sample in the form of a sheet.
    fn time(&self, sample: usize) -> Result<Exact<Time>, RodlabError> {
        let text = format!("{} us", 1e6 * sample as f64 / self.rate_hz);
        text.parse().in_step("the window of a pulse")
    }
}

/// Returns the error for a gauge whose record shows no pulse after the silence; `silence` and `all`
/// are the numbers of samples of the silence and of the record.
fn no_pulse(
    error: LabioError,
    sheet: &BarSheet,
    at: usize,
    [silence, all]: [usize; 2],
) -> RodlabError {
    let silent = &sheet.silent;
    let (found, expected) = match error {
        LabioError::TooFewSamples { .. } => (
            format!("`{silent}`, {silence} samples of {all}"),
            "16 samples or more before the pulse, and a pulse after them: record with a longer pre-trigger",
        ),
        LabioError::SilenceEnds { found, .. } => (
            format!(
                "`{silent}`, but the pulse begins at gauges[{at}] after {:.4} ms",
                1e3 * found
            ),
            "a silence that ends before the pulse, because noise and level at rest are determined in it; if there is no silence, record with a longer pre-trigger",
        ),
        LabioError::NoisySilence { noise, peak } => (
            if peak > 0.0 {
                let part = noise / peak;
                format!(
                    "`{silent}`, in which gauges[{at}] varies by {part:.2} times its largest sample"
                )
            } else {
                format!("`{silent}`, and gauges[{at}], whose samples are all equal")
            },
            "a silence before the pulse, and a pulse of at least 50 times the noise in this silence: record with a longer pre-trigger, or with more gain",
        ),
        error => return RodlabError::step(format!("gauges[{at}].channel"), error),
    };
    RodlabError::request("silent", found, expected)
}

/// Returns the windows of the incident and of the reflected pulse at the only gauge.
fn windows_of(
    pulse: &Pulse,
    gauge: &BarGaugeSheet,
    sheet: &BarSheet,
) -> Result<[Range<usize>; 2], RodlabError> {
    let Some(speed) = &sheet.wave_speed else {
        return Err(RodlabError::request(
            "wave_speed",
            "missing",
            "a guess within 25 %: with one gauge, the reflection is recognised by its travel time",
        ));
    };
    let way = 2.0 * gauge.distance() / speed.si();
    // the next wave after the reflected pulse comes from the struck end
    let behind = sheet.bar.length.si() - gauge.distance();
    let windows = pulse.echo_windows(way, behind / gauge.distance());
    windows.map_err(|error| {
        let found = match error {
            LabioError::NoEcho { .. } => {
                "at which no pulse of the opposite sign returns".to_owned()
            }
            LabioError::EchoOverlaps { pulse, delay, .. } => format!(
                "at which the pulse lasts {:.3} ms and changes sign {:.3} ms after its front",
                1e3 * pulse,
                1e3 * delay
            ),
            LabioError::EchoOvertaken { pulse, next } => format!(
                "at which the wave from the struck end arrives {:.3} ms after the reflected front, before the reflected pulse of {:.3} ms has passed",
                1e3 * next,
                1e3 * pulse
            ),
            LabioError::EchoCut { found, expected } => {
                return RodlabError::request(
                    "records",
                    format!("a record of {:.3} ms", 1e3 * found),
                    format!(
                        "a record up to the end of the reflected pulse, {:.3} ms",
                        1e3 * expected
                    ),
                );
            }
            error => return RodlabError::step("gauges", error),
        };
        RodlabError::request(
            "gauges",
            format!("one gauge, {} from the free end, {found}", gauge.from_free_end),
            format!(
                "a pulse that has passed the gauge before its reflection returns from the free end after about {:.3} ms: add a second gauge to separate overlapping waves, \
                 or use a shorter striker or a gauge farther from the end",
                1e3 * way
            ),
        )
    })
}
