//! Outcome of every point at which a fault was injected, and the counts that are kept in the
//! repository.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Outcome of one point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Came {
    /// Status 1 or 2 with a reason; the earlier files are complete.
    Refused,
    /// The result is the same as without the fault.
    Right,
    /// There is a result that names the fault of its input.
    Said,
    /// The input is complete in its format, but shorter.
    Shorter,
    /// The fault ended the program; the existing files are complete, and the next run gives the
    /// right result.
    Stopped,
    /// Something is missing, mixed or wrong, and is not reported.
    Lost(String),
    /// The program panicked, ended with an unknown status, or did not end.
    Broke(String),
}

/// The counts of one fault.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(crate) struct Row {
    /// The fault and its target.
    pub(crate) fault: String,
    /// Points at which it was injected.
    pub(crate) injected: String,
    /// Number of points that were tried.
    pub(crate) tried: usize,
    pub(crate) refused: usize,
    pub(crate) right: usize,
    pub(crate) said: usize,
    pub(crate) shorter: usize,
    pub(crate) stopped: usize,
    pub(crate) lost: usize,
    pub(crate) broke: usize,
    /// Reason why no point was tried.
    pub(crate) skipped: Option<String>,
}

/// Selection of the points that are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    Few,
    All,
}

impl Extent {
    /// Selects all points if the environment variable `RODLAB_FAULTS` requests them.
    pub(crate) fn asked() -> Self {
        match std::env::var("RODLAB_FAULTS") {
            Ok(extent) if extent == "all" => Self::All,
            Ok(other) => panic!("RODLAB_FAULTS is `{other}`, expected `all` or nothing"),
            Err(_) => Self::Few,
        }
    }

    /// Returns all of `points`, or `few` of them including the first and the last.
    pub(crate) fn of<T: Clone>(self, points: &[T], few: usize) -> Vec<T> {
        if self == Self::All || points.len() <= few {
            return points.to_vec();
        }
        let last = points.len() - 1;
        (0..few)
            .map(|number| points[number * last / (few - 1)].clone())
            .collect()
    }
}

impl Row {
    /// Tries `points` in parallel. Losses and defects are printed.
    pub(crate) fn of<T: Sync>(
        fault: impl Into<String>,
        injected: impl Into<String>,
        points: &[T],
        attempt: impl Fn(&T) -> Came + Sync + Send,
    ) -> Self {
        let came: Vec<Came> = points.par_iter().map(attempt).collect();
        let mut row = Self {
            fault: fault.into(),
            injected: injected.into(),
            tried: points.len(),
            ..Self::default()
        };
        let mut told = 0;
        for came in came {
            match &came {
                Came::Refused => row.refused += 1,
                Came::Right => row.right += 1,
                Came::Said => row.said += 1,
                Came::Shorter => row.shorter += 1,
                Came::Stopped => row.stopped += 1,
                Came::Lost(_) => row.lost += 1,
                Came::Broke(_) => row.broke += 1,
            }
            if let Came::Lost(what) | Came::Broke(what) = &came
                && told < 5
            {
                println!("{}: {what}", row.fault);
                told += 1;
            }
        }
        row
    }

    pub(crate) fn skipped(
        fault: impl Into<String>,
        injected: impl Into<String>,
        why: impl Into<String>,
    ) -> Self {
        Self {
            fault: fault.into(),
            injected: injected.into(),
            skipped: Some(why.into()),
            ..Self::default()
        }
    }
}

/// The counts of all groups of faults, as kept in `docs/faults.ron`.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Campaign(BTreeMap<String, Vec<Row>>);

static KEPT: Mutex<()> = Mutex::new(());

fn place() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/faults.ron")
}

/// Fails if data were lost or a run broke. Writes the counts if all points were tried; otherwise
/// fails if the faults are not those of `docs/faults.ron`.
pub(crate) fn compared(group: &str, rows: Vec<Row>) {
    for row in &rows {
        println!("{row:?}");
    }
    for row in &rows {
        assert_eq!(
            (row.lost, row.broke),
            (0, 0),
            "{}: {}",
            row.fault,
            row.injected
        );
        let sum = row.refused + row.right + row.said + row.shorter + row.stopped;
        assert_eq!(sum, row.tried, "{}", row.fault);
    }
    let _one_at_a_time = KEPT.lock();
    let mut campaign: Campaign = match fs::read_to_string(place()) {
        Ok(text) => ron::from_str(&text).unwrap(),
        Err(_) => Campaign::default(),
    };
    if Extent::asked() == Extent::All {
        campaign.0.insert(group.to_owned(), rows);
        let pretty = ron::ser::PrettyConfig::new().depth_limit(3);
        let text = ron::ser::to_string_pretty(&campaign, pretty).unwrap();
        fs::write(place(), text + "\n").unwrap();
        return;
    }
    let names = |rows: &[Row]| -> Vec<(String, String)> {
        let names = rows
            .iter()
            .map(|row| (row.fault.clone(), row.injected.clone()));
        names.collect()
    };
    let kept = campaign
        .0
        .get(group)
        .map(|rows| names(rows))
        .unwrap_or_default();
    assert_eq!(
        names(&rows),
        kept,
        "docs/faults.ron is not current: try all points, as the head of tests/faults.rs says"
    );
}
