//! Drop-table shocks, `shock/Test_{001,002,003,017}.lvm`: acceleration of the table and of what stands on it; the last one is a
//! documented failure. And two hits of a hammer in one LabVIEW file, `hammer/long_single_header_multi_ch.lvm`.

use std::path::Path;

use labio::hits::{Criteria, HitLog};
use labio::{AveragedSpectra, Channel, Coherence, LabioError, Quantity, Record, Window, format};

use testbed::claim::{Check, Claim, Claims, NotMeasured, Observation, is_absent, refused};
use testbed::hold;

const SOURCE: &str = "description beside the records";
const TABLE: &str = "Acceleration_0";
const SPECIMEN: &str = "Acceleration_1";
const GOOD: [&str; 3] = ["001", "002", "003"];
const FAILURE: &str = "017";

#[test]
fn claims_hold() {
    let data = testbed::measured::folder();
    hold!(report(data.as_deref()), "measured records");
}

fn report(data: Option<&Path>) -> Claims {
    let folder = data
        .ok_or_else(|| NotMeasured::Absent("no folder given (--data or RODLAB_DATA)".to_owned()));
    let shocks = folder.clone().and_then(Shocks::of);
    let hits = folder.and_then(two_hits);
    let mut checks = Vec::new();
    let mut claim = |what: &str, unit, expected, tolerance, tolerance_from, ours| {
        let claim = Claim {
            what: what.to_owned(),
            source: SOURCE,
            unit,
            expected,
            tolerance,
            tolerance_from,
        };
        checks.push(Check::of(claim, ours));
    };
    let of = |measure: fn(&Shocks) -> f64| shocks.as_ref().map(measure).map_err(Clone::clone);
    claim(
        "shock tests: sampling rate",
        "Hz",
        51_200.0,
        1e-9 * 51_200.0,
        "the step is written in seven exact digits",
        of(|s| s.sampling_rate_hz),
    );
    claim(
        "shock tests 1 to 3: mean coherence to 4 kHz",
        "1",
        1.0,
        0.005,
        "half the last printed digit",
        of(|s| s.mean_coherence),
    );
    claim(
        "shock tests 1 to 3: accepted",
        "1",
        3.0,
        0.5,
        "a count",
        of(|s| s.accepted),
    );
    claim(
        "shock test 17, a failed acquisition: accepted",
        "1",
        0.0,
        0.5,
        "a count",
        of(|s| s.accepted_failure),
    );
    claim(
        "hammer, LabVIEW file: hits in it",
        "1",
        2.0,
        0.5,
        "a count",
        hits.as_ref().map(|h| h.count).map_err(Clone::clone),
    );
    claim(
        "hammer, LabVIEW file: mean coherence, 50 to 450 Hz",
        "1",
        0.999,
        0.001,
        "the claim is a range",
        hits.as_ref()
            .map(|h| h.mean_coherence)
            .map_err(Clone::clone),
    );
    let mut observations = Vec::new();
    if let Ok(shocks) = &shocks {
        observations.push(Observation {
            what: "shock test 17: reasons to reject it".to_owned(),
            unit: "",
            ours: shocks.reasons_against_failure,
        });
        observations.push(Observation {
            what: "shock test 17: level of the table before the shock".to_owned(),
            unit: "m/s^2",
            ours: shocks.level_of_failure,
        });
    }
    if let Ok(hits) = &hits {
        observations.push(Observation {
            what: "hammer, LabVIEW file: smallest coherence, 50 to 450 Hz".to_owned(),
            unit: "1",
            ours: hits.least_coherence,
        });
    }
    Claims {
        checks,
        observations,
        ..Claims::default()
    }
}

struct Shocks {
    sampling_rate_hz: f64,
    mean_coherence: f64,
    accepted: f64,
    /// 1 if the failure passes for a measurement
    accepted_failure: f64,
    reasons_against_failure: f64,
    level_of_failure: f64,
}

impl Shocks {
    fn of(data: &Path) -> Result<Self, NotMeasured> {
        let mut records = Vec::new();
        for number in GOOD.into_iter().chain([FAILURE]) {
            records.push(shock(data, number)?);
        }
        Self::measured(&records).map_err(|error| refused(&error))
    }

    fn measured(records: &[Record]) -> Result<Self, LabioError> {
        let good = &records[..GOOD.len()];
        let coherence =
            AveragedSpectra::of(good, Window::Rectangular)?.coherence(TABLE, SPECIMEN)?;
        let log = HitLog::of_records(records.iter().cloned(), TABLE, &Criteria::default())?;
        let accepted = log.hits()[..GOOD.len()]
            .iter()
            .filter(|hit| hit.is_accepted());
        let failure = &log.hits()[GOOD.len()];
        let before = records[GOOD.len()].channel(TABLE)?;
        Ok(Self {
            sampling_rate_hz: records[0].sampling_rate_hz(),
            mean_coherence: over_band(&coherence, 10.0, 4000.0).0,
            accepted: accepted.count() as f64,
            accepted_failure: f64::from(u8::from(failure.is_accepted())),
            reasons_against_failure: failure.reasons().len() as f64,
            level_of_failure: before.iter().take(1000).sum::<f64>() / 1000.0,
        })
    }
}

fn shock(data: &Path, number: &str) -> Result<Record, NotMeasured> {
    let path = data.join("shock").join(format!("Test_{number}.lvm"));
    records(&path)?
        .into_iter()
        .find(|record| record.channel(SPECIMEN).is_ok())
        .ok_or_else(|| NotMeasured::Refused(format!("no channel {SPECIMEN} in test {number}")))
}

fn records(path: &Path) -> Result<Vec<Record>, NotMeasured> {
    match format::read_records(path) {
        Ok(together) => Ok(together.records),
        Err(error) if is_absent(&error) => Err(NotMeasured::Absent(format!(
            "{} does not exist",
            path.display()
        ))),
        Err(error) => Err(refused(&error)),
    }
}

struct TwoHits {
    count: f64,
    mean_coherence: f64,
    least_coherence: f64,
}

/// The file calls its force an acceleration in g; coherence does not mind.
fn two_hits(data: &Path) -> Result<TwoHits, NotMeasured> {
    let path = data.join("hammer").join("long_single_header_multi_ch.lvm");
    let hits = records(&path)?;
    let measured = || -> Result<TwoHits, LabioError> {
        // said here, so that a file with other channels is refused by name
        let [force, response] = [
            Channel::new("F", Quantity::Acceleration)?,
            Channel::new("m_2", Quantity::Acceleration)?,
        ];
        let coherence = AveragedSpectra::of(&hits, Window::Rectangular)?
            .coherence(force.name(), response.name())?;
        let (mean_coherence, least_coherence) = over_band(&coherence, 50.0, 450.0);
        Ok(TwoHits {
            count: hits.len() as f64,
            mean_coherence,
            least_coherence,
        })
    };
    measured().map_err(|error| refused(&error))
}

/// Mean and least coherence over lines in `from_hz..to_hz`.
fn over_band(coherence: &Coherence, from_hz: f64, to_hz: f64) -> (f64, f64) {
    let lines = coherence.frequency_hz.iter().zip(&coherence.values);
    let band: Vec<f64> = lines
        .filter(|(f, _)| (from_hz..to_hz).contains(*f))
        .map(|(_, coherence)| *coherence)
        .collect();
    let mean = band.iter().sum::<f64>() / band.len() as f64;
    (mean, band.into_iter().fold(f64::INFINITY, f64::min))
}

#[cfg(test)]
mod tests {
    use super::*;
    use testbed::claim::Verdict;

    #[test]
    fn without_records_every_check_is_skipped_and_listed() {
        for data in [None, Some(Path::new("no such folder"))] {
            let report = report(data);
            assert_eq!(
                (report.checks.len(), report.count(Verdict::Skipped)),
                (6, 6)
            );
        }
    }
}
