//! Degrees of freedom of the sum of an estimated and a known variance.

/// Number of independent lines on either side of a line over which its variance is averaged.
const NEIGHBOURS: f64 = 4.0;

/// Returns for every line the factor by which a known variance c increases the degrees of freedom
/// of an estimated `variance` v (Welch and Satterthwaite):
///
/// ```math
/// (1 + c/\bar v)^2 ,
/// ```
///
/// infinite where $`\bar v`$ is not above 0. Here $`\bar v`$ is the variance of the line or, if
/// larger, the mean of the finite variances of nine independent lines around it: an estimate from
/// few averages is often much too small by chance, and the sum would then count as known.
/// `lines_per_independent_line` is the number of lines for each line with independent noise.
pub(crate) fn gains(variance: &[f64], known: &[f64], lines_per_independent_line: f64) -> Vec<f64> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of lines, above 0; the cast saturates"
    )]
    let side = (NEIGHBOURS * lines_per_independent_line).ceil() as usize;
    let lines = variance.iter().zip(known).enumerate();
    lines
        .map(|(line, (own, known))| {
            let near = variance.iter().skip(line.saturating_sub(side));
            let near = near.take(line.min(side) + side + 1);
            let finite = near.filter(|variance| variance.is_finite());
            let (sum, count) = finite.fold((0.0, 0.0), |(sum, count), variance| {
                (sum + variance, count + 1.0)
            });
            let mean = sum / count;
            let expected = if *own < mean { mean } else { *own };
            if expected > 0.0 {
                (1.0 + known / expected).powi(2)
            } else {
                f64::INFINITY
            }
        })
        .collect()
}
