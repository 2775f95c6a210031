//! Hits of a hammer on a linear body: one response, scaled to several strengths.

use labio::Record;
use rand::RngExt;
use rodwave::experiment::end_accelerations::{HalfSine, Pulse, RaisedCosine};
use serde::Deserialize;

use super::Request;
use super::files::Naming;
use super::instrument::{History, InstrumentSheet};
use crate::job::JobContext;
use crate::outcome::{Attachment, LogEntry};
use crate::sheet::{Duration, Exact, Force, Ratio, plausible};
use crate::{InStep, RodlabError};

/// Inverse of the fraction of a record, at its end, in which the decay is checked.
const LATE_PART: usize = 16;
/// Level relative to the peak below which the record counts as decayed.
const QUIET: f64 = 5e-4;
/// Default scatter of the strengths of hits, as a fraction of the peak.
const USUAL_SCATTER: f64 = 0.05;

/// Maximum number of samples in all records of a sheet, which are kept in memory.
const MOST_SAMPLES: f64 = 5e7;

/// The hits of a hammer.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlowsSheet {
    /// Number of hits, one record each.
    pub hits: usize,
    /// Largest force, such as `"100 N"`.
    pub peak: Exact<Force>,
    /// Duration of the contact, such as `"80 us"`.
    pub duration: Exact<Duration>,
    /// Shape of the force; by default a raised cosine.
    #[serde(default)]
    pub shape: ShapeSheet,
    /// Largest relative deviation of the strength of a hit from `peak`; the deviations are
    /// distributed uniformly. By default `"5 %"`.
    pub scatter: Option<Exact<Ratio>>,
}

/// Shape of the force of a hit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
pub enum ShapeSheet {
    /// Raised cosine, which is smooth at both ends.
    #[default]
    RaisedCosine,
    /// Half sine, the force of a rigid hammer on a spring.
    HalfSine,
}

impl BlowsSheet {
    fn scatter(&self) -> f64 {
        self.scatter.as_ref().map_or(USUAL_SCATTER, Exact::si)
    }

    /// Checks the hits, and the size of their records with this number of `channels`, before
    /// anything is computed.
    pub(super) fn check(
        &self,
        field: &str,
        instrument: &InstrumentSheet,
        channels: usize,
    ) -> Result<(), RodlabError> {
        if !(1..=999).contains(&self.hits) {
            return Err(RodlabError::request(
                format!("{field}.hits"),
                self.hits.to_string(),
                "1 to 999",
            ));
        }
        if self.scatter() >= 1.0 {
            return Err(RodlabError::request(
                format!("{field}.scatter"),
                self.scatter().to_string(),
                "below 100 %: otherwise the force of a hit could be tensile",
            ));
        }
        let of_channel = instrument.samples_of_record()? as f64;
        plausible::at_most(
            (self.hits * channels) as f64 * of_channel,
            MOST_SAMPLES,
            "samples of all hits",
            "instrument.length",
        )
    }

    pub(super) fn pulse(&self, field: &str) -> Result<Box<dyn Pulse>, RodlabError> {
        let (peak, duration) = (self.peak.si(), self.duration.si());
        Ok(match self.shape {
            ShapeSheet::RaisedCosine => Box::new(RaisedCosine::new(peak, duration).in_step(field)?),
            ShapeSheet::HalfSine => Box::new(HalfSine::new(peak, duration).in_step(field)?),
        })
    }

    /// Returns the records of all hits. `history` is the response to a hit of full strength. Each
    /// hit has a separate random stream.
    pub(super) fn record(
        &self,
        history: &History,
        instrument: &InstrumentSheet,
        request: &Request<'_>,
        context: &JobContext<'_>,
    ) -> Result<Recorded, RodlabError> {
        let sampled = instrument.sampled(history)?;
        let peaks = peaks(&sampled);
        let mut recorded = Recorded::by(&history.generator);
        recorded.warnings.extend(cut_off(&sampled, &peaks));
        for hit in 1..=self.hits {
            let mut random = request.random(hit);
            let strength = 1.0 + self.scatter() * random.random_range(-1.0..=1.0);
            let struck = Record::new(
                &sampled.samples() * strength,
                sampled.sampling_rate_hz(),
                0.0,
                sampled.channels().to_vec(),
                sampled.provenance().clone(),
            )
            .in_step("instrument")?;
            let taken = instrument.recorded(&struck, &peaks, &mut random)?;
            recorded.take(
                taken,
                &request.naming,
                request.naming.file(hit, self.hits),
                format!("a hit of {:.4} N", strength * self.peak.si()),
            )?;
            context.progress.one_more();
            context.check_cancelled()?;
        }
        Ok(recorded)
    }

    pub(super) fn in_words(&self) -> String {
        let shape = match self.shape {
            ShapeSheet::RaisedCosine => "raised cosines",
            ShapeSheet::HalfSine => "half sines",
        };
        let scatter = 100.0 * self.scatter();
        format!(
            "{} hits, {shape} of {} and {}, strengths within {scatter} %",
            self.hits, self.peak, self.duration
        )
    }
}

/// Records of several events.
#[derive(Default)]
pub(super) struct Recorded {
    pub(super) records: Vec<Record>,
    pub(super) files: Vec<Attachment>,
    pub(super) log: Vec<LogEntry>,
    pub(super) warnings: Vec<String>,
    pub(super) generator: String,
}

impl Recorded {
    pub(super) fn by(generator: &str) -> Self {
        Self {
            generator: generator.to_owned(),
            ..Self::default()
        }
    }

    /// Adds one record, as the file `name`.
    pub(super) fn take(
        &mut self,
        taken: labio::instrument::Acquisition,
        naming: &Naming,
        name: String,
        what: String,
    ) -> Result<(), RodlabError> {
        let reasons: Vec<String> = taken
            .saturations
            .iter()
            .map(|over| {
                format!(
                    "{} samples of `{}` are beyond the range of the converter",
                    over.n_samples, over.channel
                )
            })
            .collect();
        for reason in &reasons {
            self.warnings.push(format!("{name}: {reason}"));
        }
        self.log.push(LogEntry {
            what: format!("{name}, {what}"),
            accepted: reasons.is_empty(),
            reasons,
        });
        let file = naming.attachment(&taken.record, name, &self.generator)?;
        self.files.push(file);
        self.records.push(taken.record);
        Ok(())
    }
}

/// Returns the largest absolute value of each channel.
pub(super) fn peaks(record: &Record) -> Vec<f64> {
    let rows = record.samples();
    rows.rows()
        .into_iter()
        .map(|row| {
            row.iter()
                .fold(0.0_f64, |peak, value| peak.max(value.abs()))
        })
        .collect()
}

/// Returns a warning if the record ends before all channels are at rest; otherwise `None`.
fn cut_off(record: &Record, peaks: &[f64]) -> Option<String> {
    let late = record.n_samples() / LATE_PART;
    let part = record
        .part(record.n_samples() - late..record.n_samples())
        .ok()?;
    let (channel, level) = record
        .channels()
        .iter()
        .zip(self::peaks(&part))
        .zip(peaks)
        .map(|((channel, late), peak)| (channel.name(), late / peak))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    (level > QUIET).then(|| {
        format!(
            "the records end while `{channel}` still moves by {:.2} % of its largest value: the rest is missing from their spectra, which affects \
             evaluations",
            100.0 * level
        )
    })
}
