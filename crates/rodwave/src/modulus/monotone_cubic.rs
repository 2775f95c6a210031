//! Shape-preserving piecewise cubic interpolation.

/// Interpolation by a cubic in each interval, with a continuous first derivative and without an
/// extremum between two points (Fritsch & Butland, *SIAM J. Sci. Stat. Comput.* **5** (1984) 300).
///
/// It preserves monotonicity and positivity: a loss modulus cannot become negative between two
/// lines of a table, as it can with a spline. The error is of third order for smooth data, and of
/// second order near their extrema.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MonotoneCubic {
    points: Vec<Point>,
}

/// Number of parts into which an interval is divided to compare two cubics.
const PARTS: u32 = 8;

#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    x: f64,
    y: f64,
    slope: f64,
}

impl MonotoneCubic {
    /// Creates the interpolation through at least two points of increasing `x`. The caller must
    /// check the number and the order of the points.
    pub(super) fn through(x: &[f64], y: &[f64]) -> Self {
        let intervals: Vec<Interval> = x
            .windows(2)
            .zip(y.windows(2))
            .filter_map(|pair| match pair {
                ([x0, x1], [y0, y1]) => Some(Interval {
                    width: x1 - x0,
                    slope: (y1 - y0) / (x1 - x0),
                }),
                _ => None,
            })
            .collect();
        let inner = intervals.windows(2).filter_map(|pair| match pair {
            [left, right] => Some(slope_between(*left, *right)),
            _ => None,
        });
        let first = intervals
            .first()
            .map(|end| slope_at_end(*end, intervals.get(1)));
        let last = intervals.last().map(|end| {
            slope_at_end(
                *end,
                intervals
                    .len()
                    .checked_sub(2)
                    .and_then(|i| intervals.get(i)),
            )
        });
        let slopes = first.into_iter().chain(inner).chain(last);
        let points = x
            .iter()
            .zip(y)
            .zip(slopes)
            .map(|((&x, &y), slope)| Point { x, y, slope })
            .collect();
        Self { points }
    }

    /// Value at `x`, which must be between the first and the last point.
    pub(super) fn value(&self, x: f64) -> f64 {
        self.within(x, |left, right, width, t| {
            let (u, v) = (1.0 - t, t);
            u * u * ((1.0 + 2.0 * v) * left.y + v * width * left.slope)
                + v * v * ((1.0 + 2.0 * u) * right.y - u * width * right.slope)
        })
    }

    /// Derivative at `x`, which must be between the first and the last point.
    pub(super) fn slope(&self, x: f64) -> f64 {
        self.within(x, |left, right, width, t| {
            let u = 1.0 - t;
            6.0 * t * u * (right.y - left.y) / width
                + u * (1.0 - 3.0 * t) * left.slope
                + t * (1.0 - 3.0 * u) * right.slope
        })
    }

    /// Largest difference from the cubic through the four nearest points, in the interval that
    /// contains `x`; `None` with fewer than four points.
    pub(super) fn difference_of_cubics(&self, x: f64) -> Option<f64> {
        let last_four = self.points.len().checked_sub(4)?;
        let after = self.points.partition_point(|point| point.x <= x);
        let right = after.clamp(1, self.points.len() - 1);
        let nearest = self
            .points
            .get(right.saturating_sub(2).min(last_four)..)?
            .get(..4)?;
        let cubic = |x: f64| -> f64 {
            let term = |(i, point): (usize, &Point)| {
                let others = nearest.iter().enumerate().filter(|(j, _)| *j != i);
                let basis: f64 = others
                    .map(|(_, other)| (x - other.x) / (point.x - other.x))
                    .product();
                basis * point.y
            };
            nearest.iter().enumerate().map(term).sum()
        };
        let [from, to] = self.points.get(right - 1..=right)? else {
            return None;
        };
        let inside = (1..PARTS).map(|part| {
            let x = from.x + (to.x - from.x) * f64::from(part) / f64::from(PARTS);
            (self.value(x) - cubic(x)).abs()
        });
        Some(inside.fold(0.0, f64::max))
    }

    fn within(&self, x: f64, formula: impl Fn(Point, Point, f64, f64) -> f64) -> f64 {
        let after = self.points.partition_point(|point| point.x <= x);
        let right = after.clamp(1, self.points.len().saturating_sub(1).max(1));
        match self.points.get(right - 1..=right) {
            Some([left, right]) => {
                let width = right.x - left.x;
                formula(*left, *right, width, (x - left.x) / width)
            }
            _ => f64::NAN, // fewer than two points, which the callers exclude
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Interval {
    width: f64,
    slope: f64,
}

/// Slope at an inner point: the weighted harmonic mean of the neighbouring slopes, 0 at an
/// extremum.
fn slope_between(left: Interval, right: Interval) -> f64 {
    if left.slope * right.slope <= 0.0 {
        return 0.0;
    }
    let left_weight = left.width + 2.0 * right.width;
    let right_weight = 2.0 * left.width + right.width;
    (left_weight + right_weight) / (left_weight / left.slope + right_weight / right.slope)
}

/// Slope at an end: that of the parabola through three points, limited to the sign of the slope of
/// the interval and to three times its value.
fn slope_at_end(end: Interval, next: Option<&Interval>) -> f64 {
    let Some(next) = next else {
        return end.slope;
    };
    let parabola = end.slope + (end.slope - next.slope) * end.width / (end.width + next.width);
    if parabola * end.slope <= 0.0 {
        0.0
    } else if parabola.abs() > 3.0 * end.slope.abs() {
        3.0 * end.slope
    } else {
        parabola
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares interpolations of an exponential function at two spacings.
    #[test]
    fn error_falls_with_the_third_power_of_the_spacing() {
        let error = |n: u32| -> f64 {
            let x: Vec<f64> = (0..=n).map(|j| f64::from(j) / f64::from(n)).collect();
            let y: Vec<f64> = x.iter().map(|x| x.exp()).collect();
            let cubic = MonotoneCubic::through(&x, &y);
            (0..1000)
                .map(|j| f64::from(j) / 1000.0)
                .map(|x| (cubic.value(x) - x.exp()).abs())
                .fold(0.0, f64::max)
        };
        // Tolerance: slopes of second order give values of third order, and halving the spacing
        // reduces the error by a factor 8, or 16 where errors cancel.
        let (coarse, fine) = (error(20), error(40));
        assert!(
            (7.0..18.0).contains(&(coarse / fine)),
            "{coarse:e} {fine:e}"
        );
    }

    #[test]
    fn slope_is_the_derivative_of_value() {
        let cubic = MonotoneCubic::through(&[0.0, 0.3, 1.0, 1.2, 2.0], &[1.0, 1.1, 3.0, 2.0, 2.0]);
        let h = 1e-5;
        for j in 1..200 {
            let x = 0.01 * f64::from(j) + 1.3e-3; // never within h of a point
            let difference = (cubic.value(x + h) - cubic.value(x - h)) / (2.0 * h);
            // Tolerance: truncation h²/6 times a third derivative below 1e3, 2e-8; rounding 1e-16/h
            // = 1e-11.
            assert!((cubic.slope(x) - difference).abs() < 1e-7, "{x}");
        }
    }

    /// Checks data with steps and plateaux, where a spline overshoots.
    #[test]
    fn nothing_lies_outside_the_two_points_of_an_interval() {
        let x = [0.0, 1.0, 1.1, 2.0, 5.0, 5.5, 7.0];
        let y = [0.0, 0.0, 1.0, 1.0, 1.0, 0.2, 0.1];
        let cubic = MonotoneCubic::through(&x, &y);
        for (x, y) in x.windows(2).zip(y.windows(2)) {
            let (low, high) = (y[0].min(y[1]), y[0].max(y[1]));
            for j in 0..=100 {
                let value = cubic.value(x[0] + 0.01 * f64::from(j) * (x[1] - x[0]));
                // Tolerance: rounding of three products, 4e-16.
                assert!(value >= low - 1e-15 && value <= high + 1e-15, "{value}");
            }
        }
    }
}
