//! Random errors of lines, drawn for a Monte Carlo computation.

use num_complex::Complex64;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::check_count;
use crate::LabioError;
use crate::error::non_physical;

/// Adds a drawn error $`e`$ to each of the `values` on neighbouring lines, with
/// $`\mathrm{E}|e|^2`$ from `mean_squares`, in the square of the unit of the values. The errors
/// have no preferred phase.
///
/// | argument | shape |
/// |---|---|
/// | `values`, `mean_squares` | `(n_lines)` |
///
/// Of $`m`$ = `lines_per_independent_line` neighbouring lines only one has independent noise
/// ([`ResponseRatio::lines_per_independent_line`](crate::ResponseRatio::lines_per_independent_line)):
/// an independent error is drawn every $`m`$ lines, and the errors $`a`$, $`b`$ of two such places
/// are interpolated with their variance kept,
///
/// ```math
/// e = \frac{(1-p)\,a + p\,b}{\sqrt{(1-p)^2 + p^2}} , \qquad 0 \le p < 1 .
/// ```
///
/// A line whose mean square is infinite or NaN contains no information and is left as it is. With
/// $`m`$ below 1 all lines are independent.
///
/// # Errors
///
/// [`LabioError::CountMismatch`] unless there is a mean square for each value;
/// [`LabioError::NonPhysical`] for a negative mean square.
pub fn add_random_errors(
    values: &mut [Complex64],
    mean_squares: &[f64],
    lines_per_independent_line: f64,
    random: &mut impl Rng,
) -> Result<(), LabioError> {
    check_count("mean squares of errors", mean_squares.len(), values.len())?;
    if let Some(negative) = mean_squares.iter().find(|square| **square < 0.0) {
        return non_physical("mean square of an error", *negative, "0 or more");
    }
    let mut normal = || -> f64 { random.sample(StandardNormal) };
    let mut independent = || Complex64::new(normal(), normal());
    let spacing = lines_per_independent_line.max(1.0);
    let (mut last, mut next) = (independent(), independent());
    let mut part = 0.0;
    for (value, mean_square) in values.iter_mut().zip(mean_squares) {
        let error = (last * (1.0 - part) + next * part) / f64::hypot(1.0 - part, part);
        if mean_square.is_finite() {
            *value += error * (0.5 * mean_square).sqrt();
        }
        part += 1.0 / spacing;
        if part >= 1.0 {
            (last, next) = (next, independent());
            part -= 1.0;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Compares the means of |e|² and of the products of errors on lines of some distance with the
    /// stated |e|²: lines within the distance of independent noise are correlated, others are not.
    #[test]
    fn errors_have_their_size_and_only_near_lines_share_them() {
        let n = 40_000;
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut values = vec![Complex64::ZERO; n];
        add_random_errors(&mut values, &vec![4.0; n], 5.0, &mut random).unwrap();
        let mean = |apart: usize| {
            let pairs = values.iter().zip(values.iter().skip(apart));
            pairs.map(|(a, b)| (a * b.conj()).re).sum::<f64>() / (4.0 * (n - apart) as f64)
        };
        // 8000 independent errors: four standard errors of 1.1 %
        assert!((mean(0) - 1.0).abs() < 0.045, "{}", mean(0));
        assert!(mean(1) > 0.8, "{}", mean(1));
        assert!(mean(10).abs() < 0.045, "{}", mean(10));
    }

    #[test]
    fn lines_without_information_keep_their_values_and_wrong_sizes_are_refused() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut values = [Complex64::ONE; 3];
        let squares = [f64::INFINITY, f64::NAN, 0.0];
        add_random_errors(&mut values, &squares, f64::NAN, &mut random).unwrap();
        assert_eq!(values, [Complex64::ONE; 3]);
        let mut refused = |squares: &[f64]| {
            add_random_errors(&mut values, squares, 1.0, &mut random)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            refused(&[1.0]),
            "mean squares of errors: found 1, expected 3"
        );
        assert_eq!(
            refused(&[1.0, -1.0, 1.0]),
            "mean square of an error is -1, expected 0 or more"
        );
    }
}
