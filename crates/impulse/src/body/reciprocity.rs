//! Reciprocity of two points.

use num_complex::Complex64;

use crate::error::{check_length, check_not_negative, check_samples, check_spacing};
use crate::{ImpulseError, MeasuredBody};

/// Number of standard errors attributed to chance.
const COVERAGE: f64 = 4.0;

/// Comparison of the two transfer mobilities between two points, which must be equal: $`G_{12} =
/// G_{21}`$.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Reciprocity {
    /// `Σ|G₁₂ - G₂₁|² / Σ|G₁₂||G₂₁|` over the lines above 0 Hz.
    pub relative_difference: f64,
    /// Lines that differ by more than four standard errors.
    pub contradicting_lines: usize,
    /// The line that differs most, and its difference in standard errors.
    pub worst: Option<(usize, f64)>,
}

impl Reciprocity {
    /// Compares `forward` and `backward` \[m/(N s)\] with their `variances` \[(m/(N s))²\], all
    /// `(n_lines)` from 0 Hz.
    ///
    /// At each line, the variance of the difference is the sum of the two variances. For reciprocal
    /// lines the squared magnitude of the difference, divided by this sum, is exponentially
    /// distributed; it exceeds 4² once in nine million.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::LengthMismatch`], [`ImpulseError::NonFinite`].
    pub fn between(
        forward: &[Complex64],
        backward: &[Complex64],
        variances: [&[f64]; 2],
    ) -> Result<Self, ImpulseError> {
        for (what, found) in [
            ("backward mobility", backward.len()),
            ("variance of the forward mobility", variances[0].len()),
            ("variance of the backward mobility", variances[1].len()),
        ] {
            check_length(what, found, forward.len())?;
        }
        check_samples("variance of the forward mobility", variances[0])?;
        check_samples("variance of the backward mobility", variances[1])?;
        for &variance in variances[0].iter().chain(variances[1]) {
            check_not_negative("variance of a mobility [(m/(N s))^2]", variance)?;
        }
        // relative to the largest line, so that no square overflows or underflows
        let lines = forward.iter().chain(backward);
        let largest = lines
            .filter(|line| line.is_finite())
            .fold(f64::MIN_POSITIVE, |top, line| top.max(line.norm()));
        let mut found = Self {
            relative_difference: 0.0,
            contradicting_lines: 0,
            worst: None,
        };
        let (mut difference, mut scale) = (0.0, 0.0);
        let pairs = forward.iter().zip(backward);
        let errors = variances[0].iter().zip(variances[1]);
        for (line, ((there, back), (first, second))) in pairs.zip(errors).enumerate().skip(1) {
            if !(there.is_finite() && back.is_finite()) {
                return Err(ImpulseError::NonFinite {
                    what: "transfer mobility",
                    index: line,
                });
            }
            let apart = (there - back).norm();
            difference += (apart / largest).powi(2);
            scale += there.norm() / largest * (back.norm() / largest);
            let error = first.sqrt().hypot(second.sqrt());
            let distance = if apart > 0.0 { apart / error } else { 0.0 };
            if distance > COVERAGE {
                found.contradicting_lines += 1;
            }
            if found.worst.is_none_or(|(_, worst)| distance > worst) {
                found.worst = Some((line, distance));
            }
        }
        found.relative_difference = if difference > 0.0 {
            difference / scale
        } else {
            0.0
        };
        Ok(found)
    }
}

impl MeasuredBody {
    /// Compares this transfer mobility with the `backward` one, for which the points of the force
    /// and of the response are exchanged. Returns the mean of both with their comparison. Without
    /// variances no line counts as contradicting.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::GridMismatch`] and [`ImpulseError::LengthMismatch`] for lines of another
    /// spacing or number.
    pub fn mean_of_directions(&self, backward: &Self) -> Result<(Self, Reciprocity), ImpulseError> {
        check_spacing(
            "backward mobility",
            backward.frequency_step_hz(),
            self.frequency_step_hz(),
        )?;
        let none = vec![0.0; self.mobility().len()];
        let variances = [self, backward].map(|body| body.variance().unwrap_or(&none));
        let mut found = Reciprocity::between(self.mobility(), backward.mobility(), variances)?;
        let pairs = self.mobility().iter().zip(backward.mobility());
        let mobility: Vec<Complex64> = pairs.map(|(a, b)| 0.5 * (a + b)).collect();
        let mean = self.clone().with_mobility(mobility);
        if self.variance().is_none() && backward.variance().is_none() {
            found.contradicting_lines = 0;
            found.worst = None;
            return Ok((mean, found));
        }
        let sums = variances[0].iter().zip(variances[1]);
        let variance: Vec<f64> = sums.clone().map(|(a, b)| 0.25 * (a + b)).collect();
        let freedoms = self.freedom().iter().zip(backward.freedom());
        let freedom: Vec<f64> = sums
            .zip(freedoms)
            .map(|((a, b), (of_a, of_b))| {
                let part = if *b > 0.0 { a / (a + b) } else { 1.0 };
                1.0 / (part * part / of_a + (1.0 - part).powi(2) / of_b)
            })
            .collect();
        let mean = mean.with_variance(&variance)?;
        Ok((mean.with_degrees_of_freedom(&freedom)?, found))
    }
}
