//! Date of a report. Unless it is set by an environment variable, it is the date of the newest
//! input, not the current time, so that the same files give the same report.

use std::env;
use std::fs;
use std::path::PathBuf;
use std::time::UNIX_EPOCH;

use crate::RodlabError;

/// Environment variable that sets the date, in seconds since 1970
/// (<https://reproducible-builds.org/specs/source-date-epoch/>).
const VARIABLE: &str = "SOURCE_DATE_EPOCH";

/// Last second of the year 9999.
const LATEST: u64 = 253_402_300_799;
const SECONDS_PER_DAY: u64 = 86_400;

/// Returns the date of `SOURCE_DATE_EPOCH` if this is set, otherwise the date of the newest input
/// file; `None` if neither is known.
pub(super) fn of(reads: &[PathBuf]) -> Result<Option<String>, RodlabError> {
    if let Some(text) = env::var_os(VARIABLE) {
        return of_variable(&text.to_string_lossy()).map(Some);
    }
    let modified = |path: &PathBuf| {
        let modified = fs::metadata(path).ok()?.modified().ok()?;
        Some(modified.duration_since(UNIX_EPOCH).ok()?.as_secs())
    };
    let newest = reads.iter().filter_map(modified).max();
    Ok(newest.filter(|seconds| *seconds <= LATEST).map(in_words))
}

fn of_variable(text: &str) -> Result<String, RodlabError> {
    let seconds = text.parse().ok().filter(|seconds| *seconds <= LATEST);
    seconds.map(in_words).ok_or_else(|| {
        RodlabError::request(
            VARIABLE,
            format!("`{text}`"),
            format!("a whole number of seconds since 1970, from 0 to {LATEST}"),
        )
    })
}

/// Returns a time in seconds since 1970 in the form `2026-11-22 12:24:59 UTC`.
fn in_words(seconds: u64) -> String {
    let (days, second) = (seconds / SECONDS_PER_DAY, seconds % SECONDS_PER_DAY);
    // the Gregorian calendar has 146097 days in 400 years; a year that begins in March has its leap
    // day at the end
    let from_march = days + 719_468;
    let (era, day_of_era) = (from_march / 146_097, from_march % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = (month_from_march + 2) % 12 + 1;
    let year = 400 * era + year_of_era + u64::from(month <= 2);
    format!(
        "{year:04}-{month:02}-{day:02} {:02}:{:02}:{:02} UTC",
        second / 3600,
        second / 60 % 60,
        second % 60
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r19_a_date_is_that_of_the_calendar() {
        for (seconds, date) in [
            (0, "1970-01-01 00:00:00 UTC"),
            (951_782_399, "2000-02-28 23:59:59 UTC"),
            (951_782_400, "2000-02-29 00:00:00 UTC"),
            (1_709_251_199, "2024-02-29 23:59:59 UTC"),
            (1_709_251_200, "2024-03-01 00:00:00 UTC"),
            (4_107_542_400, "2100-03-01 00:00:00 UTC"),
            (LATEST, "9999-12-31 23:59:59 UTC"),
        ] {
            assert_eq!(in_words(seconds), date);
        }
    }

    #[test]
    fn r19_a_variable_that_is_no_number_of_seconds_is_refused() {
        assert_eq!(of_variable("1").unwrap(), "1970-01-01 00:00:01 UTC");
        for wrong in ["", "today", "-1", "1.5", "999999999999"] {
            let said = of_variable(wrong).unwrap_err().to_string();
            assert!(said.contains("seconds since 1970"), "{said}");
        }
    }
}
