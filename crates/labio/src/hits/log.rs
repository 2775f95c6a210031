//! Log of hits and decisions.

use std::fmt;

use super::{Criteria, Reason};
use crate::{LabioError, Record};

/// A manual decision, which overrides the checks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ruling {
    /// Accepted, whatever the result of the checks.
    Accepted {
        /// The reason.
        because: String,
    },
    /// Rejected, whatever the result of the checks.
    Rejected {
        /// The reason.
        because: String,
    },
}

/// A hit, or an event that was mistaken for one.
#[derive(Debug, Clone, PartialEq)]
pub struct Hit {
    time: f64,
    record: Option<Record>,
    reasons: Vec<Reason>,
    ruling: Option<Ruling>,
}

impl Hit {
    pub(super) fn new(time: f64, record: Option<Record>, reasons: Vec<Reason>) -> Self {
        Self {
            time,
            record,
            reasons,
            ruling: None,
        }
    }

    /// Time at which the trigger fired, or at which the record begins \[s\].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The samples; `None` if the recording ended within the hit or lost samples.
    #[must_use]
    pub fn record(&self) -> Option<&Record> {
        self.record.as_ref()
    }

    /// Reasons to reject the hit that the checks found.
    #[must_use]
    pub fn reasons(&self) -> &[Reason] {
        &self.reasons
    }

    /// The manual decision, if there is one.
    #[must_use]
    pub fn ruling(&self) -> Option<&Ruling> {
        self.ruling.as_ref()
    }

    /// Returns true if the hit enters the spectra: by manual decision or, without one, if the
    /// checks found no reason against it.
    #[must_use]
    pub fn is_accepted(&self) -> bool {
        match &self.ruling {
            Some(Ruling::Accepted { .. }) => true,
            Some(Ruling::Rejected { .. }) => false,
            None => self.reasons.is_empty(),
        }
    }
}

/// All hits of a test in their order, numbered from 1.
///
/// # Examples
///
/// ```
/// use labio::hits::{Criteria, HitLog, Reason};
/// use labio::{Channel, Provenance, Quantity, Record};
/// use ndarray::Array2;
///
/// # fn main() -> Result<(), labio::LabioError> {
/// // a contact of 100 N and, in the same record, a second contact of 30 N
/// let blow = |t: f64| if (0.0..0.002).contains(&t) { (t * 500.0 * 3.14159).sin() } else { 0.0 };
/// let force = Array2::from_shape_fn((1, 1000), |(_, k)| {
///     let t = k as f64 / 10_000.0;
///     100.0 * blow(t - 0.01) + 30.0 * blow(t - 0.03)
/// });
/// let channels = vec![Channel::new("force", Quantity::Force)?];
/// let record = Record::new(force, 10_000.0, 0.0, channels, Provenance::computed("example"))?;
///
/// let mut log = HitLog::of_records([record], "force", &Criteria::default())?;
/// assert!(matches!(log.hits()[0].reasons(), [Reason::DoubleHit { .. }]));
/// assert_eq!(log.accepted().count(), 0);
///
/// log.accept(1, "the specimen bounces, and both contacts are in the record")?;
/// assert_eq!(log.accepted().count(), 1);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HitLog {
    channel: String,
    hits: Vec<Hit>,
}

impl HitLog {
    pub(super) fn new(channel: &str) -> Self {
        Self {
            channel: channel.to_owned(),
            hits: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, hit: Hit) {
        self.hits.push(hit);
    }

    /// Checks records with one hit each; `channel` is the channel that triggered them.
    ///
    /// # Errors
    ///
    /// The errors of [`Criteria::judge`].
    pub fn of_records(
        records: impl IntoIterator<Item = Record>,
        channel: &str,
        criteria: &Criteria,
    ) -> Result<Self, LabioError> {
        let mut log = Self::new(channel);
        for record in records {
            let reasons = criteria.judge(&record, channel, None)?;
            log.push(Hit::new(record.start_time(), Some(record), reasons));
        }
        Ok(log)
    }

    /// The hits in the order of the test.
    #[must_use]
    pub fn hits(&self) -> &[Hit] {
        &self.hits
    }

    /// The records of the accepted hits, as required by
    /// [`AveragedSpectra::of`](crate::AveragedSpectra::of).
    pub fn accepted(&self) -> impl Iterator<Item = &Record> {
        self.hits
            .iter()
            .filter(|hit| hit.is_accepted())
            .filter_map(Hit::record)
    }

    /// Accepts hit `number`, whatever the result of the checks.
    ///
    /// # Errors
    ///
    /// [`LabioError::NoSuchHit`] if no hit has that number, or if it has no samples.
    pub fn accept(&mut self, number: usize, because: impl Into<String>) -> Result<(), LabioError> {
        let hit = self.hit_mut(number)?;
        if hit.record.is_none() {
            return Err(no_such_hit(number, "has no samples"));
        }
        hit.ruling = Some(Ruling::Accepted {
            because: because.into(),
        });
        Ok(())
    }

    /// Rejects hit `number`, whatever the result of the checks.
    ///
    /// # Errors
    ///
    /// [`LabioError::NoSuchHit`] if no hit has that number.
    pub fn reject(&mut self, number: usize, because: impl Into<String>) -> Result<(), LabioError> {
        self.hit_mut(number)?.ruling = Some(Ruling::Rejected {
            because: because.into(),
        });
        Ok(())
    }

    /// Adds a reason against hit `number`, found by comparison with other hits, to the reasons
    /// found by the checks.
    ///
    /// # Errors
    ///
    /// [`LabioError::NoSuchHit`] if no hit has that number.
    pub fn object(&mut self, number: usize, reason: Reason) -> Result<(), LabioError> {
        self.hit_mut(number)?.reasons.push(reason);
        Ok(())
    }

    /// Pads hit `number` to `n_samples` samples with its level at rest ([`padded`](super::padded)).
    ///
    /// # Errors
    ///
    /// [`LabioError::NoSuchHit`] if no hit has that number, or if it has no samples;
    /// [`LabioError::NotAtRest`].
    pub fn pad(&mut self, number: usize, n_samples: usize) -> Result<(), LabioError> {
        self.change(number, |record| super::padded(record, n_samples))
    }

    /// Shortens hit `number` to its first `n_samples` samples.
    ///
    /// # Errors
    ///
    /// [`LabioError::NoSuchHit`] if no hit has that number, or if it has no samples;
    /// [`LabioError::TooFewSamples`].
    pub fn shorten(&mut self, number: usize, n_samples: usize) -> Result<(), LabioError> {
        self.change(number, |record| record.part(0..n_samples))
    }

    fn change(
        &mut self,
        number: usize,
        changed: impl FnOnce(&Record) -> Result<Record, LabioError>,
    ) -> Result<(), LabioError> {
        let hit = self.hit_mut(number)?;
        let Some(record) = &hit.record else {
            return Err(no_such_hit(number, "has no samples"));
        };
        hit.record = Some(changed(record)?);
        Ok(())
    }

    fn hit_mut(&mut self, number: usize) -> Result<&mut Hit, LabioError> {
        number
            .checked_sub(1)
            .and_then(|index| self.hits.get_mut(index))
            .ok_or(no_such_hit(number, "does not exist"))
    }
}

fn no_such_hit(number: usize, reason: &'static str) -> LabioError {
    LabioError::NoSuchHit { number, reason }
}

impl fmt::Display for HitLog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "hits in `{}`: {} found, {} accepted",
            self.channel,
            self.hits.len(),
            self.accepted().count()
        )?;
        for (index, hit) in self.hits.iter().enumerate() {
            let verdict = match &hit.ruling {
                Some(Ruling::Accepted { because }) => format!("accepted by hand ({because})"),
                Some(Ruling::Rejected { because }) => format!("rejected by hand ({because})"),
                None if hit.reasons.is_empty() => "accepted".to_owned(),
                None => "rejected".to_owned(),
            };
            write!(f, "\n{:>5}  {:>10.4} s  {verdict}", index + 1, hit.time)?;
            for reason in &hit.reasons {
                write!(f, "\n                      {reason}")?;
            }
        }
        Ok(())
    }
}
