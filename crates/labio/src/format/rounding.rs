//! Even spacing of numbers that were rounded when they were written.
//!
//! Instruments print an abscissa with few digits. A printed value $`x_i`$ represents any value
//! within half a unit $`u_i`$ of its last digit. A column is compatible with an even spacing if a
//! start $`x`$ and a step $`d`$ exist with
//!
//! ```math
//! |x_i - (x + i d)| \le u_i
//! ```

use std::fmt;

/// Allowance for the rounding of the arithmetic itself, relative to its largest number: a few units
/// in the last place.
const ARITHMETIC: f64 = 8.0 * f64::EPSILON;

/// Number of neighbours on each side of a value whose half units are compared with that of the
/// value.
const NEIGHBOURS: usize = 4;

/// Values of an abscissa as they are written, each with half a unit of its last digit.
#[derive(Debug, Clone, Default)]
pub(crate) struct WrittenValues {
    pub(crate) values: Vec<f64>,
    pub(crate) half_units: Vec<f64>,
}

/// A number as it is written, with half a unit of its last digit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Written {
    pub(crate) value: f64,
    pub(crate) half_unit: f64,
}

impl Written {
    /// An exact number.
    pub(crate) fn exactly(value: f64) -> Self {
        Self {
            value,
            half_unit: 0.0,
        }
    }
}

impl WrittenValues {
    pub(crate) fn push(&mut self, value: f64, half_unit: f64) {
        self.values.push(value);
        self.half_units.push(half_unit);
    }

    pub(crate) fn len(&self) -> usize {
        self.values.len()
    }

    /// The value at `index` with its rounding.
    pub(crate) fn get(&self, index: usize) -> Option<Written> {
        Some(Written {
            value: *self.values.get(index)?,
            half_unit: *self.half_units.get(index)?,
        })
    }

    /// Returns the values in `range`, which must be within the bounds.
    #[allow(
        clippy::indexing_slicing,
        reason = "a value is pushed together with its half unit, and the caller's range ends with the values or before"
    )]
    pub(crate) fn part(&self, range: std::ops::Range<usize>) -> Self {
        Self {
            values: self.values[range.clone()].to_vec(),
            half_units: self.half_units[range].to_vec(),
        }
    }

    /// Limits each half unit to ten times the median of the half units around it: a value such as
    /// `0` among `0.0000152588` was written without its trailing zeros, and was not rounded to its
    /// last digit.
    pub(crate) fn restore_trailing_zeros(&mut self) {
        let same = self.half_units.windows(2).all(|pair| match pair {
            [a, b] => a.to_bits() == b.to_bits(),
            _ => true,
        });
        if same {
            return;
        }
        let limited = |at: usize| {
            let first = at.saturating_sub(NEIGHBOURS);
            let around = self.half_units.iter().skip(first);
            let mut around: Vec<f64> = around.take(2 * NEIGHBOURS + 1).copied().collect();
            around.sort_by(f64::total_cmp);
            around.get(around.len() / 2).map(|median| 10.0 * median)
        };
        let own = self.half_units.iter().enumerate();
        let units = own.map(|(at, own)| limited(at).map_or(*own, |limit| own.min(limit)));
        self.half_units = units.collect();
    }

    /// Returns the first index at which a value differs from `start + index * step` by more than
    /// the rounding of value, start and step.
    pub(crate) fn first_off(&self, start: Written, step: Written) -> Option<usize> {
        self.values
            .iter()
            .zip(&self.half_units)
            .enumerate()
            .position(|(i, (value, half_unit))| {
                let expected = start.value + i as f64 * step.value;
                let allowed = half_unit
                    + start.half_unit
                    + i as f64 * step.half_unit
                    + ARITHMETIC * (start.value.abs() + expected.abs());
                let off = (value - expected).abs();
                off > allowed || off.is_nan()
            })
    }

    /// Returns the first index at which a value is not exactly `start + index * step`.
    pub(crate) fn first_not_exactly(&self, start: f64, step: f64) -> Option<usize> {
        self.values
            .iter()
            .enumerate()
            .position(|(i, value)| (start + i as f64 * step).to_bits() != value.to_bits())
    }

    /// Returns start and step of an even spacing that agrees with all values within their rounding,
    /// with the uncertainty of the step due to the rounding of the first and last value; `None` if
    /// the spacing is not even.
    pub(crate) fn even_spacing(&self) -> Option<(f64, Written)> {
        let n = self.values.len();
        let (first, last) = (self.get(0)?, self.get(n.checked_sub(1)?)?);
        if n < 2 {
            return None;
        }
        let steps = (n - 1) as f64;
        let step = (last.value - first.value) / steps;
        let half_unit = (last.half_unit + first.half_unit) / steps;
        if !step.is_finite() || step.abs() < f64::MIN_POSITIVE {
            return None;
        }
        // the line of an even spacing differs from the chord between the first and last value most
        // at one of the ends
        let start = Written {
            value: first.value,
            half_unit: first.half_unit.max(last.half_unit),
        };
        if self.first_off(start, Written::exactly(step)).is_some() {
            return None;
        }
        Some((
            first.value,
            Written {
                value: self.plain(first.value, step),
                half_unit,
            },
        ))
    }

    /// Returns true if the values are `start + index * step` within arithmetic rounding errors.
    pub(crate) fn is_even(&self, start: f64, step: f64) -> bool {
        self.values.iter().enumerate().all(|(i, value)| {
            let expected = start + i as f64 * step;
            (value - expected).abs() <= ARITHMETIC * (start.abs() + expected.abs())
        })
    }

    /// Returns the step with the fewest digits that reproduces every value within arithmetic
    /// rounding errors, or `step` if there is none.
    fn plain(&self, start: f64, step: f64) -> f64 {
        (0..17)
            .filter_map(|digits| format!("{step:.digits$e}").parse::<f64>().ok())
            .find(|candidate| self.is_even(start, *candidate))
            .unwrap_or(step)
    }
}

/// Returns the first of `times` if all of them are within half a step of the evenly spaced times
/// that begin there and have this `step`.
pub(crate) fn start_at_step(times: &[f64], step: f64) -> Option<f64> {
    let start = *times.first()?;
    let within = |(i, time): (usize, &f64)| (time - (start + i as f64 * step)).abs() <= 0.5 * step;
    times.iter().enumerate().all(within).then_some(start)
}

/// A sampling rate that instruments offer and that is compatible with a rounded time step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CustomaryRate {
    /// The rate \[Hz\].
    pub rate_hz: f64,
    /// The family that the rate belongs to.
    pub family: RateFamily,
}

/// Family of sampling rates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RateFamily {
    /// 1, 2, 2.5 or 5 times a power of ten.
    Decimal,
    /// A power of two.
    PowerOfTwo,
    /// 51 200 Hz halved or doubled: 2.56 times the bandwidth of an analyser.
    Analyser,
    /// 48 000 Hz halved or doubled.
    Audio48,
    /// 44 100 Hz halved or doubled.
    Audio44,
}

impl fmt::Display for RateFamily {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Decimal => "a round decimal rate",
            Self::PowerOfTwo => "a power of two",
            Self::Analyser => "51200 Hz halved or doubled, the clock of vibration analysers",
            Self::Audio48 => "48000 Hz halved or doubled, an audio clock",
            Self::Audio44 => "44100 Hz halved or doubled, an audio clock",
        })
    }
}

/// Returns the customary rate closest to `1 / step` among those compatible with a step \[s\]
/// written to `± half_unit` \[s\].
///
/// A step of 1/1024 s is printed as `0.000977` with six decimals; taken literally, this is a rate
/// of 1023.5 Hz. The result is only a proposal: the file does not contain the clock rate of the
/// instrument.
///
/// `None` if no customary rate is possible, or if the step is not a positive number.
///
/// # Examples
///
/// ```
/// use labio::format::{RateFamily, customary_rate};
///
/// let rate = customary_rate(0.000977, 0.5e-6).unwrap();
/// assert_eq!(rate.rate_hz, 1024.0);
/// assert_eq!(rate.family, RateFamily::PowerOfTwo);
/// assert!(customary_rate(0.000977, 0.5e-9).is_none());
/// ```
#[must_use]
pub fn customary_rate(step: f64, half_unit: f64) -> Option<CustomaryRate> {
    use RateFamily::{Analyser, Audio44, Audio48, Decimal, PowerOfTwo};
    if !(step.is_finite() && step > 0.0 && half_unit.is_finite() && half_unit >= 0.0) {
        return None;
    }
    let decimal = [1.0, 2.0, 2.5, 5.0]
        .into_iter()
        .flat_map(|digit| (-4..10).map(move |e| (digit * 10_f64.powi(e), Decimal)));
    let doubled = [
        (1.0, PowerOfTwo),
        (51200.0, Analyser),
        (48000.0, Audio48),
        (44100.0, Audio44),
    ]
    .into_iter()
    .flat_map(|(base, family)| (-10..31).map(move |e| (base * 2_f64.powi(e), family)));
    decimal
        .chain(doubled)
        .map(|(rate_hz, family)| {
            (
                ((1.0 / rate_hz) - step).abs(),
                CustomaryRate { rate_hz, family },
            )
        })
        .filter(|(distance, _)| *distance <= half_unit + ARITHMETIC * step)
        .min_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, rate)| rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(texts: &[&str]) -> WrittenValues {
        let mut all = WrittenValues::default();
        for text in texts {
            let half_unit =
                crate::format::text::half_unit(text, crate::format::text::DecimalMark::Point);
            all.push(text.parse().unwrap(), half_unit);
        }
        all
    }

    #[test]
    fn a_rounded_column_is_even_as_far_as_it_says() {
        // 1/51200 s printed with six decimals
        let column = written(&[
            "0.000000", "0.000020", "0.000039", "0.000059", "0.000078", "0.000098",
        ]);
        let (start, step) = column.even_spacing().unwrap();
        assert_eq!(start.to_bits(), 0.0_f64.to_bits());
        assert!((step.value - 1.0 / 51200.0).abs() <= step.half_unit);
        // half a unit for each of the first and the last value, divided by five steps
        assert!((step.half_unit / 0.2e-6 - 1.0).abs() < 1e-12);
        let truth = Written::exactly(1.0 / 51200.0);
        assert_eq!(column.first_off(Written::exactly(0.0), truth), None);
        assert_eq!(
            column.first_off(Written::exactly(0.0), Written::exactly(2.0e-5)),
            Some(2)
        );
    }

    /// A time axis at 65 536 Hz printed with `%.9g` begins with `0`: this value without decimals
    /// must not make every rate compatible.
    #[test]
    fn values_without_their_trailing_zeros_have_the_rounding_of_their_neighbours() {
        let texts = [
            "0",
            "1.52587891e-05",
            "3.05175781e-05",
            "4.57763672e-05",
            "6.10351562e-05",
            "7.62939453e-05",
            "9.15527344e-05",
            "0.000106811523",
            "0.000122070312",
            "0.000137329102",
        ];
        let mut column = written(&texts);
        let other = Written::exactly(1.0 / 48000.0);
        let start = column.get(0).unwrap();
        assert_eq!(column.first_off(start, other), None);
        column.restore_trailing_zeros();
        let start = column.get(0).unwrap();
        assert_eq!(column.first_off(start, other), Some(1));
        let (_, step) = column.even_spacing().unwrap();
        assert!((step.value * 65536.0 - 1.0).abs() < 1e-7, "{step:?}");
        assert!(step.half_unit < 1e-6 * step.value, "{step:?}");
        // a deviation of half a step in the middle is not due to rounding
        let mut texts = texts;
        texts[6] = "9.9e-05";
        let mut jump = written(&texts);
        jump.restore_trailing_zeros();
        assert!(jump.even_spacing().is_none());
    }

    #[test]
    fn what_is_uneven_beyond_its_digits_is_uneven() {
        assert!(written(&["0.0", "0.1", "0.5"]).even_spacing().is_none());
        assert!(written(&["1.0", "1.0", "1.0"]).even_spacing().is_none());
        assert!(written(&["1.0"]).even_spacing().is_none());
        let mut broken = written(&["0", "1", "2"]);
        broken.values[1] = f64::NAN;
        assert!(broken.even_spacing().is_none());
    }

    #[test]
    fn the_step_is_the_plain_number_that_gives_every_value() {
        let texts: Vec<String> = (0..50)
            .map(|i| format!("{:?}", 0.3 + f64::from(i) * 0.1))
            .collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let (_, step) = written(&texts).even_spacing().unwrap();
        assert_eq!(step.value.to_bits(), 0.1_f64.to_bits());
    }

    #[test]
    fn a_rate_is_proposed_only_within_the_rounding() {
        let rate = |step, half_unit| customary_rate(step, half_unit).map(|rate| rate.rate_hz);
        assert_eq!(rate(0.000977, 0.5e-6), Some(1024.0));
        assert_eq!(rate(1.953125e-5, 0.5e-11), Some(51200.0));
        assert_eq!(rate(0.0000227, 0.5e-7), Some(44100.0));
        assert_eq!(rate(0.0123, 1e-7), None);
        assert_eq!(rate(f64::NAN, 1.0), None);
        assert_eq!(rate(0.0, 1.0), None);
    }
}
