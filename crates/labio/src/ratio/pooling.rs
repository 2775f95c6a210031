//! Variance of a ratio from few averages, pooled over neighbouring lines.
//!
//! From n averages the variance of a line has 2(n - 1) degrees of freedom. From three hits there
//! are four; forty standard errors are then as improbable as five standard errors of a normal
//! variable. However, the spectrum of the noise is smooth, so that neighbouring lines also contain
//! information about the noise of a line. The variance of the ratio and the coherence are not
//! smooth, since both follow the resonances, but the residual power S of the numerator given Ψ is,
//!
//! ```text
//! S = n G₂₂ E|δΨ|² = N₁ + |Ψ|² N₂
//! ```
//!
//! with the noise powers N₁, N₂ of numerator and denominator. Around every line both are assumed
//! constant and non-negative, and are fitted to the S of enough lines for some 40 degrees of
//! freedom, each weighted by the inverse of its variance, 1/S². With the leverage h of the line in
//! this fit, the S of the line has 2(n - 1)/h degrees of freedom.
//!
//! Neighbours are not used where they do not determine the noise of a line. A line whose S is so
//! large that noise exceeds it with a probability of 0.001, for example at the mains frequency,
//! keeps its S and is not used for other lines. If the scatter of the lines about their fit exceeds
//! the scatter expected from 2(n - 1) degrees of freedom by more than four of its standard
//! deviations, each line keeps its S.

use num_complex::Complex64;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::freedom::DegreesOfFreedom;
use crate::LabioError;
use crate::error::{check_count, non_physical};

/// Number of degrees of freedom required of a pooled variance.
const ENOUGH: f64 = 40.0;
/// Number of parameters of a fit.
const TERMS: f64 = 2.0;
/// Probability below which a line keeps its own noise.
const STRANGE: f64 = 1e-3;
/// Excess of the scatter about a fit, in standard deviations of this scatter, above which the fit
/// does not describe the lines.
const ROUGH: f64 = 4.0;
/// Largest number of repetitions of a fit with the weights from the previous one.
const MOST_ROUNDS: u32 = 30;

/// Ratio of averaged spectra, and the data from which its variance is found. All arrays have one
/// entry per line.
#[derive(Debug, Clone, Copy)]
pub struct AveragedVariance<'a> {
    /// The ratio Ψ.
    pub ratio: &'a [Complex64],
    /// E|δΨ|² from the coherence of the line alone.
    pub variance: &'a [f64],
    /// G₂₂, the averaged auto-spectrum of the denominator, in any unit.
    pub denominator_power: &'a [f64],
    /// Number n of averages, or their effective number.
    pub averages: f64,
    /// Number of lines for each line with independent noise: 1 for spectra of whole records; for a
    /// pulse that was cut out of an otherwise silent record, the ratio of record duration to window
    /// length.
    pub lines_per_independent_line: f64,
}

/// Variance and its degrees of freedom for every line.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PooledVariance {
    /// E|δΨ|².
    pub variance: Vec<f64>,
    /// Degrees of freedom of the variance.
    pub freedom: Vec<DegreesOfFreedom>,
}

impl AveragedVariance<'_> {
    /// Pools the variance over neighbouring lines; see the [module](self). Lines without noise, and
    /// lines with non-finite values, keep their own values.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for fewer than 2 averages, or unless the lines per independent
    /// line are finite and 1 or more; [`LabioError::CountMismatch`].
    pub fn pooled(&self) -> Result<PooledVariance, LabioError> {
        let alone = DegreesOfFreedom::of_averages(self.averages)?;
        let count = self.ratio.len();
        check_count("variances of a ratio", self.variance.len(), count)?;
        let powers = self.denominator_power.len();
        check_count("powers of the denominator", powers, count)?;
        let repeated = self.lines_per_independent_line;
        if !(repeated.is_finite() && repeated >= 1.0) {
            return non_physical("lines per independent line", repeated, "1 or more");
        }
        let alone = DegreesOfFreedom {
            own: alone.own / repeated,
            ..alone
        };
        let mut pooled = PooledVariance {
            variance: self.variance.to_vec(),
            freedom: vec![alone; count],
        };
        let lines = self.lines();
        // a fit needs two lines more than it has coefficients: otherwise there is no scatter by
        // which it could be judged
        let width = (TERMS * ENOUGH / alone.own).ceil();
        if lines.len() < 4 || alone.line >= ENOUGH {
            return Ok(pooled);
        }
        let Ok(law) = ChiSquared::new(alone.line) else {
            return Ok(pooled);
        };
        let most = law.inverse_cdf(1.0 - STRANGE) / alone.line;
        let window = Window {
            lines: &lines,
            width,
        };
        let all = vec![true; lines.len()];
        let takes_part: Vec<bool> = lines
            .iter()
            .enumerate()
            .map(|(place, line)| {
                let fit = window.fit(place, &all);
                fit.is_none_or(|fit| line.power <= most * fit.power)
            })
            .collect();
        for (place, line) in lines.iter().enumerate() {
            let (Some(true), Some(fit)) = (takes_part.get(place), window.fit(place, &takes_part))
            else {
                continue;
            };
            if fit.roughness(alone.line, repeated) > ROUGH {
                continue;
            }
            let freedom = (alone.own / fit.leverage).max(alone.line);
            if let (Some(variance), Some(of_line)) = (
                pooled.variance.get_mut(line.index),
                pooled.freedom.get_mut(line.index),
            ) {
                *variance = fit.power / line.denominator;
                of_line.line = freedom;
            }
        }
        Ok(pooled)
    }

    /// Returns the lines that have noise.
    fn lines(&self) -> Vec<Line> {
        let values = self.variance.iter().zip(self.denominator_power);
        let lines = self.ratio.iter().zip(values).enumerate();
        let mut lines: Vec<Line> = lines
            .map(|(index, (ratio, (variance, denominator)))| Line {
                index,
                ratio: ratio.norm_sqr(),
                power: variance * denominator,
                denominator: *denominator,
            })
            .filter(|line| line.ratio.is_finite() && line.power.is_finite() && line.power > 0.0)
            .collect();
        // squares of a power in any unit must not overflow
        let unit = lines
            .iter()
            .fold(0.0, |most: f64, line| most.max(line.power));
        for line in &mut lines {
            line.power /= unit;
            line.denominator /= unit;
        }
        lines
    }
}

/// A line with noise.
struct Line {
    index: usize,
    /// |Ψ|².
    ratio: f64,
    /// S/n.
    power: f64,
    /// G₂₂.
    denominator: f64,
}

/// The lines around a line, in a window of fixed width.
struct Window<'a> {
    lines: &'a [Line],
    width: f64,
}

/// The S of one line, fitted to its neighbours.
struct Fit {
    power: f64,
    leverage: f64,
    /// Number of lines that took part, and Σ(s/S - 1)² over these lines.
    count: f64,
    scatter: f64,
}

impl Fit {
    /// Returns the excess scatter of the lines about the fit in standard deviations, for `freedom`
    /// degrees of freedom of each line.
    fn roughness(&self, freedom: f64, repeated: f64) -> f64 {
        // for y = χ²/ν: E(y - 1)² = 2/ν, with the variance 8/ν² + 48/ν³
        let expected = (self.count - TERMS) * 2.0 / freedom;
        let spread = self.count * repeated * (8.0 + 48.0 / freedom) / (freedom * freedom);
        (self.scatter - expected) / spread.sqrt()
    }
}

impl Window<'_> {
    /// Fits N₁ and N₂ to the lines around `place` that take part, and returns the resulting S.
    fn fit(&self, place: usize, takes_part: &[bool]) -> Option<Fit> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a width is above 0, and the cast saturates"
        )]
        let width = (self.width as usize | 1).max(5).min(self.lines.len());
        let first = place
            .saturating_sub(width / 2)
            .min(self.lines.len() - width);
        let around = || {
            let lines = self.lines.iter().zip(takes_part);
            let within = lines.skip(first).take(width);
            within.filter(|(_, part)| **part).map(|(line, _)| line)
        };
        let centre = self.lines.get(place)?;
        let count = around().count();
        if count < 4 {
            return None;
        }
        let mean = around().map(|line| line.power).sum::<f64>() / count as f64;
        let mut noise = Noise {
            of_numerator: mean,
            of_denominator: 0.0,
        };
        let mut sums = Sums::default();
        for _ in 0..MOST_ROUNDS {
            sums = Sums::default();
            for line in around() {
                // the fit must not give a line without noise, whose weight would be infinite
                let expected = noise.power(line.ratio).max(1e-3 * mean);
                sums.add(line, expected);
            }
            let next = sums.noise();
            let moved = (next.power(centre.ratio) - noise.power(centre.ratio)).abs();
            noise = next;
            if moved <= 1e-6 * noise.power(centre.ratio) {
                break;
            }
        }
        let power = noise.power(centre.ratio);
        let scatter = around()
            .map(|line| (line.power / noise.power(line.ratio) - 1.0).powi(2))
            .sum();
        let leverage = sums.variance_at(centre.ratio, &noise) / (power * power);
        (power > 0.0 && leverage.is_finite()).then_some(Fit {
            power,
            leverage,
            count: count as f64,
            scatter,
        })
    }
}

/// N₁ and N₂, divided by n.
struct Noise {
    of_numerator: f64,
    of_denominator: f64,
}

impl Noise {
    /// Returns S/n where |Ψ|² is `ratio`.
    fn power(&self, ratio: f64) -> f64 {
        self.of_numerator + ratio * self.of_denominator
    }
}

/// Sums for the normal equations of a straight line as a function of |Ψ|².
#[derive(Default)]
struct Sums {
    weight: f64,
    abscissa: f64,
    square: f64,
    value: f64,
    product: f64,
}

impl Sums {
    fn add(&mut self, line: &Line, expected: f64) {
        let weight = (expected * expected).recip();
        self.weight += weight;
        self.abscissa += weight * line.ratio;
        self.square += weight * line.ratio * line.ratio;
        self.value += weight * line.power;
        self.product += weight * line.ratio * line.power;
    }

    fn determinant(&self) -> f64 {
        self.weight * self.square - self.abscissa * self.abscissa
    }

    /// Returns the minimum under the condition that no noise is negative.
    fn noise(&self) -> Noise {
        let determinant = self.determinant();
        let of_numerator = (self.square * self.value - self.abscissa * self.product) / determinant;
        let of_denominator =
            (self.weight * self.product - self.abscissa * self.value) / determinant;
        if of_numerator > 0.0 && of_denominator > 0.0 {
            return Noise {
                of_numerator,
                of_denominator,
            };
        }
        // one of the noises is 0: the choice with the smaller residual
        let numerator = self.value / self.weight;
        let denominator = self.product / self.square;
        if self.value * numerator >= self.product * denominator || !denominator.is_finite() {
            Noise {
                of_numerator: numerator,
                of_denominator: 0.0,
            }
        } else {
            Noise {
                of_numerator: 0.0,
                of_denominator: denominator,
            }
        }
    }

    /// Returns the variance of the fitted S at |Ψ|² = `ratio`, if the S of a line has the variance
    /// S².
    fn variance_at(&self, ratio: f64, noise: &Noise) -> f64 {
        if noise.of_denominator == 0.0 {
            self.weight.recip()
        } else if noise.of_numerator == 0.0 {
            ratio * ratio / self.square
        } else {
            (self.square - 2.0 * ratio * self.abscissa + ratio * ratio * self.weight)
                / self.determinant()
        }
    }
}

#[cfg(test)]
mod tests;
