//! Levels of a data set.

use labio::Ordinate;
use serde::Serialize;

/// Levels of a data set in the unit of its file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Levels {
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub greatest: f64,
    /// Mean.
    pub mean: f64,
    /// Root mean square about zero.
    pub rms: f64,
    /// Largest magnitude.
    pub peak: f64,
    /// Position of the peak, from 0.
    pub peak_at: usize,
}

impl Levels {
    /// Returns the levels of the finite values, and the number of values that are not finite. For
    /// complex values the levels are those of the absolute values.
    pub(super) fn of(ordinate: &Ordinate) -> (Option<Self>, usize) {
        match ordinate {
            Ordinate::Real(values) => of_values(values.iter().copied()),
            Ordinate::Complex(values) => of_values(values.iter().map(|value| value.norm())),
        }
    }
}

fn of_values(values: impl Iterator<Item = f64>) -> (Option<Levels>, usize) {
    let mut not_finite = 0;
    let mut n = 0.0;
    let mut levels: Option<Levels> = None;
    let mut squares = 0.0;
    for (index, value) in values.enumerate() {
        if !value.is_finite() {
            not_finite += 1;
            continue;
        }
        let levels = levels.get_or_insert(Levels {
            least: value,
            greatest: value,
            mean: 0.0,
            rms: 0.0,
            peak: value.abs(),
            peak_at: index,
        });
        n += 1.0;
        levels.least = levels.least.min(value);
        levels.greatest = levels.greatest.max(value);
        if value.abs() > levels.peak {
            levels.peak = value.abs();
            levels.peak_at = index;
        }
        // running mean, and running sum of squares about it, whose precision does not depend on an
        // offset
        let step = value - levels.mean;
        levels.mean += step / n;
        squares += step * (value - levels.mean);
    }
    let levels = levels.map(|levels| Levels {
        rms: (squares / n).sqrt().hypot(levels.mean),
        ..levels
    });
    (levels, not_finite)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_on_an_offset_has_the_levels_of_both() {
        let values: Vec<f64> = (0..1000_u32)
            .map(|k| 3.0 + 4.0 * (std::f64::consts::TAU * f64::from(k) / 100.0).sin())
            .chain([f64::NAN])
            .collect();
        let (levels, not_finite) = Levels::of(&Ordinate::Real(values));
        let levels = levels.unwrap();
        assert_eq!((not_finite, levels.peak_at), (1, 25));
        // tolerance: rounding errors of sums of a thousand numbers
        assert!((levels.mean - 3.0).abs() < 1e-12);
        assert!((levels.rms - 17.0_f64.sqrt()).abs() < 1e-12); // 3² + 4²/2
        assert!((levels.greatest - 7.0).abs() < 1e-12 && (levels.least + 1.0).abs() < 1e-12);
        assert_eq!(Levels::of(&Ordinate::Real(vec![f64::NAN])), (None, 1));
    }
}
