//! Shocks of a drop table, `shock/Test_{001,002,003,017}.lvm`: accelerations of the table and of
//! the specimen on it; the last file is documented as a failure. Also two hits of a hammer in one
//! LabVIEW file, `hammer/long_single_header_multi_ch.lvm`.

use std::path::Path;

use labio::hits::{Criteria, Extent, HitLog, Reason, Trigger, find_hits};
use labio::{AveragedSpectra, LabioError, Record, Window, format};

use testbed::claim::{Check, Claim, Claims, NotMeasured, Observation, Ours, of, unread};
use testbed::hold;

const TABLE: &str = "Acceleration_0";
const SPECIMEN: &str = "Acceleration_1";

#[test]
fn claims_hold() {
    let folder = testbed::measured::folder();
    let data = || {
        folder
            .as_deref()
            .ok_or_else(|| NotMeasured::Absent("no folder of records".to_owned()))
    };
    let shocks = data().and_then(shocks);
    let hits = data().and_then(two_hits);
    let mut report = Claims::default();
    let mut claim = |what: &str, unit, expected, (tolerance, why), ours| {
        let claim =
            Claim::new(what, "description supplied with the records").expects(expected, unit);
        report
            .checks
            .push(Check::of(claim.within(tolerance, why), ours));
    };
    claim(
        "shock tests: sampling rate",
        "Hz",
        51_200.0,
        (1e-9 * 51_200.0, "the step is written in seven exact digits"),
        of(&shocks, |s| s.sampling_rate_hz),
    );
    claim(
        "shock tests 1 to 3: mean coherence to 4 kHz",
        "1",
        1.0,
        (0.005, "half the last printed digit"),
        of(&shocks, |s| s.mean_coherence),
    );
    claim(
        "shock tests 1 to 3 and 17, a failed acquisition: all accepted except the last",
        "judgements that differ, of 4",
        0.0,
        (0.0, "exact"),
        of(&shocks, |s| s.wrongly_judged),
    );
    claim(
        "hammer, LabVIEW file: number of hits",
        "1",
        2.0,
        (0.0, "exact"),
        of(&hits, |h| h.count),
    );
    claim(
        "hammer, LabVIEW file: mean coherence, 50 to 450 Hz",
        "1",
        0.999,
        (0.001, "the claim is a range"),
        of(&hits, |h| h.mean_coherence),
    );
    let mut observe = |what: &str, unit, ours: Ours| {
        let what = what.to_owned();
        report
            .observations
            .extend(ours.ok().map(|ours| Observation { what, unit, ours }));
    };
    observe(
        "shock test 17: reasons to reject it",
        "",
        of(&shocks, |s| s.reasons_against_failure),
    );
    observe(
        "shock test 17: level of the table before the shock",
        "m/s^2",
        of(&shocks, |s| s.level_of_failure),
    );
    observe(
        "hammer, LabVIEW file: smallest coherence, 50 to 450 Hz",
        "1",
        of(&hits, |h| h.least_coherence),
    );
    hold!(report, "measured records");
}

struct Shocks {
    sampling_rate_hz: f64,
    mean_coherence: f64,
    wrongly_judged: f64,
    reasons_against_failure: f64,
    level_of_failure: f64,
}

fn shocks(data: &Path) -> Ours<Shocks> {
    let mut found = Vec::new();
    for number in ["001", "002", "003", "017"] {
        let path = data.join("shock").join(format!("Test_{number}.lvm"));
        let record = records(&path)?
            .into_iter()
            .find(|record| record.channel(SPECIMEN).is_ok());
        found.push(record.ok_or_else(|| {
            NotMeasured::Refused(format!("no channel {SPECIMEN} in test {number}"))
        })?);
    }
    let log = HitLog::of_records(found.iter().cloned(), TABLE, &Criteria::default())?;
    let judged = log.hits().iter().zip([true, true, true, false]);
    // both channels fall from 140 000 to 113 000 before the shock
    for name in [TABLE, SPECIMEN] {
        let rests_there = |reason: &Reason| {
            matches!(reason, Reason::StaticOffset { channel, level, .. }
                if channel == name && (110_000.0..145_000.0).contains(level))
        };
        assert!(log.hits()[3].reasons().iter().any(rests_there), "{log}");
    }
    let trigger = Trigger::new(TABLE, 5000.0, Extent::Seconds(0.5))?;
    let untriggered = find_hits(&found[3], &trigger, &Criteria::default())?;
    assert_eq!(untriggered.accepted().count(), 0, "{untriggered}");
    let before = found[3].channel(TABLE)?;
    Ok(Shocks {
        sampling_rate_hz: found[0].sampling_rate_hz(),
        mean_coherence: coherence_over(&found[..3], [TABLE, SPECIMEN], 10.0, 4000.0)?.0,
        wrongly_judged: judged
            .filter(|(hit, expected)| hit.is_accepted() != *expected)
            .count() as f64,
        reasons_against_failure: log.hits()[3].reasons().len() as f64,
        level_of_failure: before.iter().take(1000).sum::<f64>() / 1000.0,
    })
}

fn records(path: &Path) -> Ours<Vec<Record>> {
    let together = format::read_records(path).map_err(|error| unread(path, &error))?;
    Ok(together.records)
}

struct TwoHits {
    count: f64,
    mean_coherence: f64,
    least_coherence: f64,
}

/// The file labels its force as an acceleration in g, which does not affect the coherence.
fn two_hits(data: &Path) -> Ours<TwoHits> {
    let hits = records(&data.join("hammer").join("long_single_header_multi_ch.lvm"))?;
    let (mean_coherence, least_coherence) = coherence_over(&hits, ["F", "m_2"], 50.0, 450.0)?;
    Ok(TwoHits {
        count: hits.len() as f64,
        mean_coherence,
        least_coherence,
    })
}

/// Mean and smallest coherence of the lines in `from_hz..to_hz`.
fn coherence_over(
    hits: &[Record],
    [input, output]: [&str; 2],
    from_hz: f64,
    to_hz: f64,
) -> Result<(f64, f64), LabioError> {
    let coherence = AveragedSpectra::of(hits, Window::Rectangular)?.coherence(input, output)?;
    let lines = coherence.frequency_hz.iter().zip(&coherence.values);
    let band = lines.filter(|(f, _)| (from_hz..to_hz).contains(*f));
    let band: Vec<f64> = band.map(|(_, coherence)| *coherence).collect();
    let mean = band.iter().sum::<f64>() / band.len() as f64;
    Ok((mean, band.into_iter().fold(f64::INFINITY, f64::min)))
}
