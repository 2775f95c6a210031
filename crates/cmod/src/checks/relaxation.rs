//! Check of relaxation: a modulus over time does not rise.

use super::{Check, CheckOutcome, check_level, student_tail_below};
use crate::error::{CmodError, check_positive, check_values};

/// Minimum number of points that have a scatter about their regression line.
const FEWEST: usize = 3;

/// Checks that a modulus over time, E(t) of a relaxation test or 1/J(t) of a creep test, does not
/// rise by more than its scatter allows: in a relaxing material both decrease. `level` is the
/// largest probability of a false alarm.
///
/// A straight line ln E = a + b ln t is fitted to the n points. The statistic is b over its
/// standard error s,
///
/// ```text
/// s² = Σ(ln Eᵢ - a - b ln tᵢ)² / ((n - 2) Σ(ln tᵢ - mean)²) ,
/// ```
///
/// which is compared with Student's distribution of n - 2 degrees of freedom.
///
/// | argument | shape | unit |
/// |---|---|---|
/// | `time` | `(n_points)`, in any order | s |
/// | `modulus` | `(n_points)` | Pa |
///
/// # Validity
/// The p-value is valid for a modulus that does not change and has independent errors; if the
/// modulus decreases, a false alarm is rarer. A change that is not a power of the time counts as
/// scatter. The check is undecided for fewer than three points, or if all times are equal.
///
/// # Errors
/// [`CmodError::NonPhysical`] for the level, a time or a modulus; [`CmodError::ReadingCount`].
///
/// ```
/// use cmod::checks::relaxation;
///
/// let time = [1.0, 2.0, 4.0, 8.0, 16.0];
/// let rising = time.map(|t: f64| 2e9 * t.powf(0.02));
/// let falling = rising.map(|modulus| 4e18 / modulus);
/// assert!(relaxation(&time, &rising, 0.01)?.has_failed());
/// assert!(!relaxation(&time, &falling, 0.01)?.has_failed());
/// # Ok::<(), cmod::CmodError>(())
/// ```
pub fn relaxation(time: &[f64], modulus: &[f64], level: f64) -> Result<CheckOutcome, CmodError> {
    let level = check_level(level)?;
    check_values("modulus over time", modulus.len(), time.len(), "time")?;
    for (time, modulus) in time.iter().zip(modulus) {
        check_positive("time [s]", *time)?;
        check_positive("modulus over time [Pa]", *modulus)?;
    }
    let n = time.len() as f64;
    let mean = |values: &[f64]| values.iter().map(|value| value.ln()).sum::<f64>() / n;
    let (x, y) = (mean(time), mean(modulus));
    let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
        let points = time.iter().zip(modulus);
        points.map(|(t, e)| of(t.ln() - x, e.ln() - y)).sum()
    };
    let square = sum(&|x, _| x * x);
    let slope = sum(&|x, y| x * y) / square;
    let freedom = n - 2.0;
    let left = sum(&|x, y| (y - slope * x).powi(2)) / freedom;
    let statistic = slope / (left / square).sqrt();
    let p_value = student_tail_below(-statistic, Some(freedom));
    let outcome = CheckOutcome::judged(Check::Relaxation, (statistic, 0.0), p_value, level);
    let is_known = time.len() >= FEWEST && p_value.is_finite();
    Ok(outcome.undecided_if(!is_known))
}

#[cfg(test)]
mod tests {
    use super::super::CheckVerdict;
    use super::*;

    /// The line through ln E = 0, 1, 1, 2 at ln t = 0, 1, 2, 3 has the slope 0.6, and the squares
    /// of its residuals add up to 0.2: s² = 0.2/(2 · 5), so that b/s = 4.2426. With 2 degrees of
    /// freedom P(t > x) = (1 - x/√(2 + x²))/2.
    #[test]
    fn the_slope_is_judged_by_students_distribution() {
        let time = [0.0, 1.0, 2.0, 3.0].map(f64::exp);
        let modulus = [0.0, 1.0, 1.0, 2.0].map(f64::exp);
        let found = relaxation(&time, &modulus, 0.03).unwrap();
        let expected = 0.6 / 0.02_f64.sqrt();
        assert!((found.statistic - expected).abs() < 1e-12, "{found}");
        let p = 0.5 * (1.0 - expected / (2.0 + expected * expected).sqrt());
        assert!((found.p_value - p).abs() < 1e-12, "{found}");
        assert!(found.has_failed());
        // with three points, noise alone gives a slope of four standard errors or more with a
        // probability of 1/13
        let three = relaxation(&time[..3], &[1.0, 1.3, 1.9], 3e-5).unwrap();
        assert!(three.statistic > 4.0 && !three.has_failed(), "{three}");
    }

    #[test]
    fn too_few_points_are_undecided_and_wrong_ones_refused() {
        let verdict = |time: &[f64], modulus: &[f64]| relaxation(time, modulus, 0.01);
        for n in 0..3 {
            let few = verdict(&[1.0, 2.0][..n], &[1.0, 3.0][..n]);
            assert_eq!(few.unwrap().verdict, CheckVerdict::Undecided);
        }
        let together = verdict(&[2.0; 4], &[1.0, 3.0, 2.0, 1.0]).unwrap();
        assert_eq!(together.verdict, CheckVerdict::Undecided);
        assert!(verdict(&[1.0, 2.0], &[1.0]).is_err());
        assert!(verdict(&[1.0, f64::NAN, 2.0], &[1.0; 3]).is_err());
        assert!(verdict(&[1.0, 2.0, 3.0], &[1.0, 0.0, 1.0]).is_err());
    }
}
