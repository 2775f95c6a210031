//! The day of a calibration.

use std::fmt;
use std::str::FromStr;

use crate::LabioError;

/// A day of the Gregorian calendar, written `2026-11-21`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "String", into = "String"))]
pub struct Date {
    year: u16,
    month: u8,
    day: u8,
}

impl Date {
    /// Creates the day `day` of `month` of `year`.
    ///
    /// # Errors
    ///
    /// [`LabioError::NoDate`] if the calendar has no such day, or the year does not have four
    /// digits.
    pub fn new(year: u16, month: u8, day: u8) -> Result<Self, LabioError> {
        if (1000..=9999).contains(&year) && (1..=days_of(year, month)).contains(&day) {
            Ok(Self { year, month, day })
        } else {
            Err(LabioError::NoDate {
                found: format!("{year:04}-{month:02}-{day:02}"),
            })
        }
    }

    /// Year, month from 1 and day from 1.
    #[must_use]
    pub fn parts(self) -> (u16, u8, u8) {
        (self.year, self.month, self.day)
    }
}

fn days_of(year: u16, month: u8) -> u8 {
    let leap = year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400);
    match month {
        1 | 3 | 5 | 7 | 8 | 10 | 12 => 31,
        4 | 6 | 9 | 11 => 30,
        2 if leap => 29,
        2 => 28,
        _ => 0,
    }
}

impl FromStr for Date {
    type Err = LabioError;

    fn from_str(text: &str) -> Result<Self, LabioError> {
        let mut parts = text.trim().split('-').map(|part| {
            // `+1` is a number to the parser but not a part of a date
            part.bytes().all(|c| c.is_ascii_digit()).then_some(part)
        });
        let mut next = || parts.next().flatten();
        let date = (next(), next(), next());
        if let ((Some(year), Some(month), Some(day)), None) = (date, parts.next())
            && let (Ok(year), Ok(month), Ok(day)) = (year.parse(), month.parse(), day.parse())
        {
            return Self::new(year, month, day);
        }
        Err(LabioError::NoDate {
            found: text.to_owned(),
        })
    }
}

impl TryFrom<String> for Date {
    type Error = LabioError;

    fn try_from(text: String) -> Result<Self, LabioError> {
        text.parse()
    }
}

impl From<Date> for String {
    fn from(date: Date) -> Self {
        date.to_string()
    }
}

impl fmt::Display for Date {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}-{:02}", self.year, self.month, self.day)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_days_of_the_calendar_are_days() {
        for good in ["2026-11-21", "2024-02-29", "2000-02-29", "1993-04-30"] {
            assert_eq!(good.parse::<Date>().unwrap().to_string(), good);
        }
        for bad in [
            "2026-13-01",
            "2023-02-29",
            "1900-02-29",
            "2026-04-31",
            "2026-00-10",
            "26-11-21",
            "21.11.2026",
            "2026-11",
            "2026-11-21-3",
            "2026-+1-21",
            "",
            "2026-11-300",
        ] {
            assert!(bad.parse::<Date>().is_err(), "{bad}");
        }
    }
}
