//! Profiles that an uncertain specimen widens.

use super::{Profile, THRESHOLD};
use crate::identifiability::Verdict;
use crate::specimen::SpecimenUncertainty;

/// Number of points between two of a profile in the search for an interval.
const FINER: u32 = 64;

impl Profile {
    /// Adds the error due to an uncertain specimen to the profile.
    ///
    /// The parameter is θ + gδ with the profile PL(θ) of the data, the sensitivity g and a relative
    /// error δ of known standard deviation. Elimination of δ gives the least of PL(y) + (θ -
    /// y)²/u² over y, with u the standard error due to the specimen. An end of the interval is
    /// the outermost y ± u (3.84 - PL(y))^(1/2).
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
        let mut curve: Vec<(f64, f64)> = self
            .curve
            .iter()
            .map(|(at, _)| *at)
            .chain(ends)
            .map(|at| {
                let rises = fine
                    .iter()
                    .map(|(y, rise)| rise + ((at - y) / error).powi(2));
                (at, rises.fold(f64::INFINITY, f64::min))
            })
            .collect();
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
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

    /// The curve with intermediate points, 64 for each, its root interpolated linearly: exact for a
    /// linear problem on either side of the minimum.
    #[must_use]
    pub fn smooth_curve(&self) -> Vec<(f64, f64)> {
        let root = |rise: f64| if rise > 0.0 { rise.sqrt() } else { 0.0 };
        let mut fine: Vec<(f64, f64)> = self
            .curve
            .iter()
            .zip(self.curve.iter().skip(1))
            .filter(|((_, from), (_, to))| from.is_finite() && to.is_finite())
            .flat_map(|((x, from), (y, to))| {
                (0..FINER).map(move |step| {
                    let share = f64::from(step) / f64::from(FINER);
                    let between = root(*from) + share * (root(*to) - root(*from));
                    (x + share * (y - x), between * between)
                })
            })
            .collect();
        fine.extend(self.curve.last());
        fine
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::SpecimenSensitivity;

    /// A linear problem: PL = ((θ - 3)/s)², and the errors of data and specimen add as squares.
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
                .map(|at| (at, rise(at)))
                .collect(),
            sensitivity: SpecimenSensitivity::OF_MODULUS,
        };
        let specimen = SpecimenUncertainty::relative(0.02, 0.03).unwrap();
        assert!((profile.sensitivity.standard_error(&specimen) - by_specimen).abs() < 1e-15);
        let wide = profile.with_specimen_uncertainty(&specimen);
        let expected = THRESHOLD.sqrt() * data.hypot(by_specimen);
        // ends are looked for on 64 points a fifth of the interval: the maximum is flat
        assert!((wide.upper.unwrap() - value - expected).abs() < 1e-5);
        assert!((value - wide.lower.unwrap() - expected).abs() < 1e-5);
        for (at, rise) in &wide.curve {
            let expected = (at - value).powi(2) / (data.powi(2) + by_specimen.powi(2));
            assert!((rise - expected).abs() < 1e-3, "{at} {rise} {expected}");
        }
        let same = profile.with_specimen_uncertainty(&SpecimenUncertainty::default());
        assert_eq!(same, profile);
    }
}
