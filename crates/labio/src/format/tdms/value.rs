//! Types and values of properties and of raw data.

use super::bytes::Bytes;
use super::malformed;
use crate::LabioError;
use crate::format::number_type::NumberType::{
    self, F32, F64, I8, I16, I32, I64, U8, U16, U32, U64,
};

/// Type of one number of raw data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sample {
    Number(NumberType),
    Boolean,
    Timestamp,
    Complex32,
    Complex64,
    /// Numbers of known size but unknown meaning, which are skipped.
    Opaque(usize),
}

impl Sample {
    /// Returns the raw data type with this code; `None` for text and for types without a size.
    pub(super) fn of_code(code: u32) -> Option<Self> {
        Some(match code {
            1 => Self::Number(I8),
            2 => Self::Number(I16),
            3 => Self::Number(I32),
            4 => Self::Number(I64),
            5 => Self::Number(U8),
            6 => Self::Number(U16),
            7 => Self::Number(U32),
            8 => Self::Number(U64),
            9 | 0x19 => Self::Number(F32),
            10 | 0x1a => Self::Number(F64),
            11 | 0x1b => Self::Opaque(16),
            0x21 => Self::Boolean,
            0x44 => Self::Timestamp,
            0x08_000c => Self::Complex32,
            0x10_000d => Self::Complex64,
            _ => return None,
        })
    }

    /// Returns the type with this code of a DAQmx scaler; these codes have a separate numbering.
    pub(super) fn of_daqmx_code(code: u32) -> Option<Self> {
        Some(match code {
            0 => Self::Number(U8),
            1 => Self::Number(I8),
            2 => Self::Number(U16),
            3 => Self::Number(I16),
            4 => Self::Number(U32),
            5 => Self::Number(I32),
            6 => Self::Number(U64),
            7 => Self::Number(I64),
            8 => Self::Number(F32),
            9 => Self::Number(F64),
            u32::MAX => Self::Timestamp,
            _ => return None,
        })
    }

    /// Number of bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Number(kind) => kind.size(),
            Self::Boolean => 1,
            Self::Complex32 => 8,
            Self::Timestamp | Self::Complex64 => 16,
            Self::Opaque(size) => size,
        }
    }

    /// Number of values per sample.
    pub(super) fn n_numbers(self) -> usize {
        match self {
            Self::Complex32 | Self::Complex64 => 2,
            Self::Opaque(_) => 0,
            _ => 1,
        }
    }
}

/// A point in time: seconds since the beginning of 1904, UTC, and a fraction in units of 2^-64 s.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Timestamp {
    pub(super) seconds: i64,
    pub(super) fraction: u64,
}

impl Timestamp {
    pub(super) fn read(bytes: &mut Bytes<'_>, field: &str) -> Result<Self, LabioError> {
        if bytes.is_big_endian() {
            Ok(Self {
                seconds: bytes.i64(field)?,
                fraction: bytes.u64(field)?,
            })
        } else {
            Ok(Self {
                fraction: bytes.u64(field)?,
                seconds: bytes.i64(field)?,
            })
        }
    }

    /// Seconds from `earlier` to this time.
    pub(super) fn since(self, earlier: Self) -> f64 {
        const PER_FRACTION: f64 = 1.0 / (1_u128 << 64) as f64;
        // whole seconds and fractions separately: their differences may be small where the times
        // themselves are large
        let seconds = i128::from(self.seconds) - i128::from(earlier.seconds);
        let fractions = i128::from(self.fraction) - i128::from(earlier.fraction);
        seconds as f64 + fractions as f64 * PER_FRACTION
    }

    /// Returns the time in ISO 8601, in UTC, to the nanosecond (further digits are cut off).
    pub(super) fn iso(self) -> String {
        const DAYS_1904_TO_1970: i64 = 24_107;
        let days = self.seconds.div_euclid(86_400);
        let second = self.seconds.rem_euclid(86_400);
        let (year, month, day) = civil(days - DAYS_1904_TO_1970);
        let nanoseconds = (u128::from(self.fraction) * 1_000_000_000) >> 64;
        format!(
            "{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}.{nanoseconds:09}Z",
            second / 3600,
            second / 60 % 60,
            second % 60,
        )
    }
}

/// Returns year, month and day of the Gregorian calendar from the days since 1970-01-01.
fn civil(days: i64) -> (i64, i64, i64) {
    // years are counted from March, so that the leap day is their last day
    const DAYS_IN_400_YEARS: i64 = 146_097;
    const MARCH_0000_TO_1970: i64 = 719_468;
    let days = days + MARCH_0000_TO_1970;
    let (era, day_of_era) = (
        days.div_euclid(DAYS_IN_400_YEARS),
        days.rem_euclid(DAYS_IN_400_YEARS),
    );
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 {
        month_from_march + 3
    } else {
        month_from_march - 9
    };
    let year = 400 * era + year_of_era + i64::from(month <= 2);
    (year, month, day)
}

/// The value of a property.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Integer(i128),
    Real(f64),
    Boolean(bool),
    Text(String),
    Timestamp(Timestamp),
    Complex(f64, f64),
}

impl Value {
    pub(super) fn read(bytes: &mut Bytes<'_>, name: &str) -> Result<Self, LabioError> {
        let place = bytes.place();
        let field = &format!("property `{name}`");
        Ok(match bytes.u32(field)? {
            1 => Self::Integer(bytes.i8(field)?.into()),
            2 => Self::Integer(bytes.i16(field)?.into()),
            3 => Self::Integer(bytes.i32(field)?.into()),
            4 => Self::Integer(bytes.i64(field)?.into()),
            5 => Self::Integer(bytes.u8(field)?.into()),
            6 => Self::Integer(bytes.u16(field)?.into()),
            7 => Self::Integer(bytes.u32(field)?.into()),
            8 => Self::Integer(bytes.u64(field)?.into()),
            9 | 0x19 => Self::Real(bytes.f32(field)?.into()),
            10 | 0x1a => Self::Real(bytes.f64(field)?),
            0x20 => Self::Text(bytes.text(field)?.to_owned()),
            0x21 => Self::Boolean(bytes.u8(field)? != 0),
            0x44 => Self::Timestamp(Timestamp::read(bytes, field)?),
            0x08_000c => Self::Complex(bytes.f32(field)?.into(), bytes.f32(field)?.into()),
            0x10_000d => Self::Complex(bytes.f64(field)?, bytes.f64(field)?),
            code => {
                // the size of the value is unknown, and hence the start of the next property
                let expected =
                    "an integer, a real or complex number, a Boolean value, a text or a time";
                return Err(malformed(
                    place,
                    field,
                    format!("of type 0x{code:x}"),
                    expected,
                ));
            }
        })
    }

    pub(super) fn as_real(&self) -> Option<f64> {
        match self {
            Self::Integer(value) => Some(*value as f64),
            Self::Real(value) => Some(*value),
            _ => None,
        }
    }

    pub(super) fn as_index(&self) -> Option<u32> {
        match self {
            Self::Integer(value) => u32::try_from(*value).ok(),
            _ => None,
        }
    }

    pub(super) fn as_text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Returns the text of the value for the properties of a series: numbers in the shortest form
    /// that reads back to the same bits.
    pub(super) fn to_text(&self) -> String {
        match self {
            Self::Integer(value) => value.to_string(),
            Self::Real(value) => format!("{value:?}"),
            Self::Boolean(value) => value.to_string(),
            Self::Text(text) => text.clone(),
            Self::Timestamp(time) => time.iso(),
            Self::Complex(re, im) => format!("{re:?} {im:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_become_dates() {
        // the day 1970-01-01 itself, century years with and without a leap day, and the ends of a
        // year
        let cases = [
            (0, (1970, 1, 1)),
            (-1, (1969, 12, 31)),
            (11_016, (2000, 2, 29)),
            (11_017, (2000, 3, 1)),
            (-24_107, (1904, 1, 1)),
            (-25_508, (1900, 3, 1)),
            (-25_509, (1900, 2, 28)),
        ];
        for (days, date) in cases {
            assert_eq!(civil(days), date, "{days}");
        }
    }

    #[test]
    fn times_are_told_to_the_nanosecond_and_subtracted_beyond() {
        let first = Timestamp {
            seconds: 3_669_315_043,
            fraction: 1 << 63,
        };
        assert_eq!(first.iso(), "2020-04-09T22:10:43.500000000Z");
        let later = Timestamp {
            seconds: 3_669_315_044,
            fraction: 1,
        };
        // half a second and 2^-64 s: the latter is less than a unit in the last place
        assert_eq!(later.since(first).to_bits(), 0.5_f64.to_bits());
        assert_eq!(first.since(later).to_bits(), (-0.5_f64).to_bits());
    }
}
