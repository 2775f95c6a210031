//! Scatter of the factors of the modulus, and departure of the sweep at the reference temperature
//! from the other temperatures.

use statrs::statistics::{Data, OrderStatistics};

use super::MasterCurve;
use crate::error::{CmodError, check_not_negative};

/// Fewest temperatures for a statement about the factors.
const FEWEST: usize = 5;
/// Smallest scatter that is stated, relative to the errors of the factors.
const BEYOND_ERRORS: f64 = 2.0;
/// Smallest scatter and smallest departure of ln b_T that are stated.
const LEAST: f64 = 2e-3;
/// Number of standard errors above which a departure of the reference is significant.
const DEPARTS: f64 = 4.0;
/// Standard deviation of normal deviations, as a multiple of the median of their absolute values.
const OF_MEDIAN: f64 = 1.4826;

/// Departure of the sweep at the reference temperature from the other temperatures.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ReferenceDeparture {
    /// ln b, where b is the factor that the other temperatures give at the reference; b = 1 is
    /// expected.
    pub log_factor: f64,
    /// Standard error of ln b.
    pub standard_error: f64,
}

impl MasterCurve {
    /// Returns the root mean square of the residuals of the series, each divided by the magnitude
    /// of its modulus.
    #[must_use]
    pub fn relative_residual(&self) -> f64 {
        let squares = self.points.iter().filter_map(|point| {
            let relative = (point.modulus - point.fitted).norm() / point.modulus.norm();
            relative.is_finite().then_some(relative * relative)
        });
        let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| {
            (sum + square, count + 1.0)
        });
        (sum / count).sqrt()
    }

    /// Returns the standard deviation of ln b_T about its straight line over temperature, with n -
    /// 2 degrees of freedom, if it exceeds both 0.002 and twice the root mean square of the errors
    /// of ln b_T. The factor 1 of the reference is included. `None` for fewer than five
    /// temperatures.
    ///
    /// Samples that are clamped again for every temperature cause such a scatter. The modulus at
    /// the reference then has this error, which the errors of the curve do not include.
    #[must_use]
    pub fn factor_scatter(&self) -> Option<f64> {
        let shifts = self.shifts.iter();
        let points = shifts.map(|shift| (shift.temperature, shift.vertical.ln()));
        let scatter = scatter_about_line(&points.collect::<Vec<_>>())?;
        let errors = self.shifts.iter().map(|s| s.vertical_standard_error);
        let square = errors.map(|error| error * error).sum::<f64>();
        let error = (square / self.shifts.len() as f64).sqrt();
        (scatter > BEYOND_ERRORS * error && scatter > LEAST).then_some(scatter)
    }

    /// Returns the departure of the sweep at the reference from the other temperatures, if it
    /// exceeds both 0.002 and four of its standard errors; `scale_uncertainty` is the relative
    /// standard uncertainty of the scale of one sweep, 0 if none is stated. `None` for fewer than
    /// four other temperatures with fitted factors.
    ///
    /// The factors of the other temperatures share the error of the sweep at the reference, so
    /// their mean is no more accurate than the best of them. The straight line of ln b_T over
    /// temperature without the reference gives the factor expected at the reference. The slope of
    /// this line is the median of the slopes between all pairs, and its level is the median of the
    /// levels with this slope (Theil 1950, Sen 1968); a single wrong sweep hardly changes them. The
    /// standard error is the root of the sum of the squares of three parts: the smallest error of a
    /// factor, the scatter of the levels (1.4826 times their median absolute deviation), and
    /// `scale_uncertainty`.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for a `scale_uncertainty` that is negative or not finite.
    pub fn departure_of_reference(
        &self,
        scale_uncertainty: f64,
    ) -> Result<Option<ReferenceDeparture>, CmodError> {
        check_not_negative("relative uncertainty of the scale", scale_uncertainty)?;
        let shifts = self.shifts.iter();
        let fitted = shifts.filter(|shift| shift.vertical_standard_error > 0.0);
        let others: Vec<(f64, f64, f64)> = fitted
            .map(|shift| {
                let from_reference = shift.temperature - self.reference_temperature;
                let log_factor = shift.vertical.ln();
                (from_reference, log_factor, shift.vertical_standard_error)
            })
            .collect();
        Ok(departure(&others, scale_uncertainty))
    }
}

/// Returns the standard deviation of the second values of `points` about the straight line fitted
/// to them over the first values.
fn scatter_about_line(points: &[(f64, f64)]) -> Option<f64> {
    if points.len() < FEWEST {
        return None;
    }
    let n = points.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (t, b) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - t) * (p.1 - b)) / mean(&|p| (p.0 - t).powi(2));
    let squares = mean(&|p| (p.1 - b - slope * (p.0 - t)).powi(2));
    Some((squares * n / (n - 2.0)).sqrt())
}

/// Returns the departure of the point (0, 0) from the straight line of the `others` (place, value
/// and standard error), if it is significant.
fn departure(others: &[(f64, f64, f64)], scale_uncertainty: f64) -> Option<ReferenceDeparture> {
    if others.len() + 1 < FEWEST {
        return None;
    }
    let slopes = others.iter().enumerate().flat_map(|(at, a)| {
        let later = others.iter().skip(at + 1);
        later.map(move |b| (b.1 - a.1) / (b.0 - a.0))
    });
    let median = |values: Vec<f64>| Data::new(values).median();
    let slope = median(slopes.collect());
    let levels: Vec<f64> = others.iter().map(|(t, b, _)| b - slope * t).collect();
    let level = median(levels.clone());
    let scatter = OF_MEDIAN * median(levels.iter().map(|b| (b - level).abs()).collect());
    let own = others.iter().map(|(_, _, error)| *error);
    let error = own
        .fold(f64::INFINITY, f64::min)
        .hypot(scatter)
        .hypot(scale_uncertainty);
    (level.abs() > DEPARTS * error && level.abs() > LEAST).then_some(ReferenceDeparture {
        log_factor: level,
        standard_error: error,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The points are a straight line plus 0.01 times the orthogonal polynomial 2, -1, -2, -1, 2 of
    /// second order, whose sum of squares is 14. Only the polynomial contributes to the scatter.
    #[test]
    fn the_scatter_does_not_contain_the_straight_line() {
        let of = [2.0, -1.0, -2.0, -1.0, 2.0].into_iter().zip(290_u32..);
        let points: Vec<(f64, f64)> = of
            .map(|(p, t)| (f64::from(t), 0.3 - 0.02 * f64::from(t) + 0.01 * p))
            .collect();
        let scatter = scatter_about_line(&points).unwrap();
        assert!((scatter - 0.01 * (14.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(scatter_about_line(&points[..4]), None);
    }

    /// Returns the factors of eight temperatures around a reference. Without scatter, their
    /// straight line has the value `at_reference` at the reference.
    fn factors(at_reference: f64, slope: f64, scatter: f64) -> Vec<(f64, f64, f64)> {
        let steps = (-4..=4).filter(|step| *step != 0);
        let factor = |step: i32| {
            let t = 5.0 * f64::from(step);
            let sign = if step.rem_euclid(2) == 0 { 1.0 } else { -1.0 };
            (t, at_reference.ln() + slope * t + sign * scatter, 0.015)
        };
        steps.map(factor).collect()
    }

    #[test]
    fn a_reference_that_departs_from_its_neighbours_is_told() {
        let ReferenceDeparture {
            log_factor: level,
            standard_error: error,
        } = departure(&factors(1.174, -1e-3, 0.003), 0.0).unwrap();
        assert!((level.exp() - 1.174).abs() < 0.005, "{level}");
        assert!((0.015..0.02).contains(&error), "{error}");
        // no departure is reported if it is within the errors or within a stated scale, if the
        // others scatter as much, if the reference is on their straight line, if one of them is
        // wrong, or if there are too few of them
        assert_eq!(departure(&factors(1.04, 0.0, 0.003), 0.0), None);
        assert_eq!(departure(&factors(1.174, 0.0, 0.003), 0.1), None);
        assert_eq!(departure(&factors(1.174, 0.0, 0.1), 0.0), None);
        assert_eq!(departure(&factors(1.0, 0.02, 0.003), 0.0), None);
        let mut one = factors(1.0, 0.0, 0.003);
        one[5].1 = -0.19;
        assert_eq!(departure(&one, 0.0), None);
        assert_eq!(departure(&one[..3], 0.0), None);
    }
}
