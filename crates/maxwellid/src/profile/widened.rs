//! Profiles widened by the uncertainty of the specimen.

use super::{Profile, ProfilePoint, THRESHOLD};
use crate::identifiability::Verdict;
use crate::specimen::SpecimenUncertainty;

/// Number of points between two points of a profile in the search for an interval.
const FINER: u32 = 64;

impl Profile {
    /// Adds the error due to an uncertain specimen to the profile.
    ///
    /// The true parameter is y + gδ, where y has the profile PL(y) of the data, g is the
    /// sensitivity and δ a relative error of known standard deviation. Elimination of δ gives the
    /// profile of the parameter θ: the minimum of PL(y) + (θ - y)²/u² over y, with u the standard
    /// error due to the specimen. An end of the interval is the outermost y ± u (3.84 -
    /// PL(y))^(1/2).
    #[must_use]
    pub fn with_specimen_uncertainty(&self, specimen: &SpecimenUncertainty) -> Self {
        let error = self.sensitivity.standard_error(specimen);
        if error == 0.0 {
            return self.clone();
        }
        let fine = self.smooth_curve();
        let end = |sign: f64| {
            let inside = fine.iter().filter(|(_, rise)| *rise <= THRESHOLD);
            inside
                .map(|(at, rise)| sign * at + error * (THRESHOLD - rise).sqrt())
                .reduce(f64::max)
                .map(|end| sign * end)
        };
        let lower = self.lower.and_then(|_| end(-1.0));
        let upper = self.upper.and_then(|_| end(1.0));
        let ends = lower.iter().chain(&upper).copied();
        let values = self.curve.iter().map(|point| point.value).chain(ends);
        let mut curve: Vec<ProfilePoint> = values
            .map(|value| {
                let each = fine.iter().map(|(y, rise)| {
                    let off = (value - y) / error;
                    (rise + off * off, 2.0 * off / error)
                });
                // the derivative of the minimum over y is the derivative at constant y
                let (rise, slope) = each
                    .min_by(|a, b| a.0.total_cmp(&b.0))
                    .unwrap_or((f64::INFINITY, f64::NAN));
                ProfilePoint { value, rise, slope }
            })
            .collect();
        curve.sort_by(|a, b| a.value.total_cmp(&b.value));
        Self {
            lower,
            upper,
            curve,
            verdict: match (self.verdict, lower, upper) {
                (Verdict::BoundedBelow(_), Some(lower), _) => Verdict::BoundedBelow(lower),
                (Verdict::BoundedAbove(_), _, Some(upper)) => Verdict::BoundedAbove(upper),
                (verdict, ..) => verdict,
            },
            ..self.clone()
        }
    }

    /// The curve as points (θ_j, PL - χ²_min), with 64 points per interval between two points of
    /// the profile, by the cubic with their values and derivatives: exact for a linear problem.
    #[must_use]
    pub fn smooth_curve(&self) -> Vec<(f64, f64)> {
        let mut fine: Vec<(f64, f64)> = self
            .curve
            .iter()
            .zip(self.curve.iter().skip(1))
            .filter(|(from, to)| from.rise.is_finite() && to.rise.is_finite())
            .flat_map(|(from, to)| {
                (0..FINER).map(|step| between(from, to, f64::from(step) / f64::from(FINER)))
            })
            .collect();
        fine.extend(self.curve.last().map(|last| (last.value, last.rise)));
        fine
    }
}

/// The point at a `share` of the way between two points, by Hermite's cubic; not below the lower of
/// them where the profile has no minimum between them.
fn between(from: &ProfilePoint, to: &ProfilePoint, share: f64) -> (f64, f64) {
    let width = to.value - from.value;
    let rest = 1.0 - share;
    let cubic = rest * rest * ((1.0 + 2.0 * share) * from.rise + share * width * from.slope)
        + share * share * ((1.0 + 2.0 * rest) * to.rise - rest * width * to.slope);
    let has_minimum = from.slope < 0.0 && to.slope > 0.0;
    let least = if has_minimum {
        f64::NEG_INFINITY
    } else {
        from.rise.min(to.rise)
    };
    (from.value + share * width, cubic.max(least))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::SpecimenSensitivity;

    /// Checks that in a linear problem, PL = ((θ - 3)/s)², the errors of data and specimen add as
    /// squares.
    #[test]
    fn the_profile_of_a_linear_problem_widens_as_its_errors_add() {
        let (value, data, by_specimen) = (3.0, 0.02, 0.05);
        let rise = |at: f64| ((at - value) / data).powi(2);
        let half = data * THRESHOLD.sqrt();
        let profile = Profile {
            parameter: "ln_modulus".to_owned(),
            value,
            lower: Some(value - half),
            upper: Some(value + half),
            range: (0.0, 6.0),
            verdict: Verdict::Identified,
            curve: (-6..=6)
                .map(|step| value + 0.2 * f64::from(step) * half)
                .map(|value| ProfilePoint {
                    value,
                    rise: rise(value),
                    slope: 2.0 * (value - 3.0) / (data * data),
                })
                .collect(),
            sensitivity: SpecimenSensitivity::OF_MODULUS,
        };
        let specimen = SpecimenUncertainty::relative(0.02, 0.03).unwrap();
        assert!((profile.sensitivity.standard_error(&specimen) - by_specimen).abs() < 1e-15);
        let wide = profile.with_specimen_uncertainty(&specimen);
        let expected = THRESHOLD.sqrt() * data.hypot(by_specimen);
        for (at, found) in profile.smooth_curve() {
            // a parabola; tolerance: rounding of values up to 6 by the cubic
            assert!((found - rise(at)).abs() < 1e-10, "{at} {found}");
        }
        // tolerance: an end is the maximum over 64 points per tenth of the interval, and a maximum
        // is flat
        assert!((wide.upper.unwrap() - value - expected).abs() < 1e-5);
        assert!((value - wide.lower.unwrap() - expected).abs() < 1e-5);
        for point in &wide.curve {
            let off = (point.value - value) / data.hypot(by_specimen);
            assert!((point.rise - off * off).abs() < 1e-3, "{point:?}");
            // tolerance: the minimum is found on 64 points per tenth of the interval
            let slope = 2.0 * off / data.hypot(by_specimen);
            assert!((point.slope - slope).abs() < 0.2, "{point:?} {slope}");
        }
        let same = profile.with_specimen_uncertainty(&SpecimenUncertainty::default());
        assert_eq!(same, profile);
    }
}
