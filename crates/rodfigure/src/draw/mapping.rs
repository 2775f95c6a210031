//! Mapping of values to pixels.

use crate::{Axis, Scale};

/// A mapping of values to pixels.
pub(super) struct Mapping {
    logarithmic: bool,
    from: f64,
    per_unit: f64,
    start: f64,
}

impl Mapping {
    pub(super) fn new(axis: &Axis, range: [f64; 2], start: f64, end: f64) -> Self {
        let logarithmic = axis.scale == Scale::Logarithmic;
        let [from, to] = if logarithmic {
            range.map(f64::log10)
        } else {
            range
        };
        Self {
            logarithmic,
            from,
            per_unit: (end - start) / (to - from),
            start,
        }
    }

    /// Returns the pixel of `value`, limited to a distance that every viewer can draw; NaN for a
    /// value that the axis cannot show.
    pub(super) fn at(&self, value: f64) -> f64 {
        let place = if self.logarithmic {
            value.log10()
        } else {
            value
        };
        if place.is_nan() || self.logarithmic && value <= 0.0 {
            return f64::NAN;
        }
        // rounding to a tenth of a pixel keeps the file small
        let pixel = self.start + (place - self.from) * self.per_unit;
        (pixel.clamp(-5000.0, 9000.0) * 10.0).round() / 10.0
    }

    /// Returns the pixel of `value`; a value that a logarithmic axis cannot show is placed below
    /// its lower end.
    pub(super) fn at_or_below(&self, value: f64) -> f64 {
        if self.logarithmic && value <= 0.0 {
            9000.0
        } else {
            self.at(value)
        }
    }
}
