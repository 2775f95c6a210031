//! Temperature dependence of shift factors.
//!
//! With d = T - Tᵣ both laws are
//!
//! ```text
//! ln a_T = -β d/(1 + κ d)
//! ```
//!
//! WLF has C₁ = β/(κ ln 10) and C₂ = 1/κ; Arrhenius, ln a_T = (E_a/R)(1/T - 1/Tᵣ), is the case κ =
//! 1/Tᵣ with β = E_a/(R Tᵣ²), because T = Tᵣ + d. The laws are therefore nested, and the value of κ
//! decides between them. If the shifts are a straight line, β and κ remain finite, whereas C₁ and
//! C₂ are infinite.

use std::fmt;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::count;
use super::parameter::{Interval, IntervalMethod};
use crate::error::{CmodError, check_enough_readings};
use crate::vectors::dot;

/// Gas constant R [J/(mol K)], exact since 2019 (CODATA 2018).
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;

/// WLF law log₁₀ a_T = -C₁ (T - Tᵣ)/(C₂ + T - Tᵣ) (Williams, Landel & Ferry, *J. Am. Chem. Soc.*
/// **77**
/// (1955) 3701).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Wlf {
    /// Reference temperature Tᵣ \[K\].
    pub reference_temperature: f64,
    /// Constant C₁; infinite if the shifts are a straight line (κ = 0), and negative for the
    /// opposite curvature.
    pub c1: f64,
    /// Constant C₂ \[K\].
    pub c2: f64,
    /// Standard error of C₁, to first order in the error of κ.
    pub c1_standard_error: f64,
    /// Standard error of C₂ \[K\], to first order in the error of κ.
    pub c2_standard_error: f64,
    /// Confidence interval of C₁ at the level of the fit of the master curve, computed as for the
    /// ratio β/κ. Unlike the standard error it is also right for a large error of κ; an end is
    /// infinite if the shifts do not exclude a straight line.
    pub c1_interval: Interval,
    /// Confidence interval of C₂ \[K\], computed as for the ratio 1/κ.
    pub c2_interval: Interval,
    /// Parameter β [1/K], the slope of -ln a_T at Tᵣ.
    pub slope: f64,
    /// Parameter κ [1/K].
    pub curvature: f64,
    /// Covariance of (β, κ), by rows.
    pub covariance: [[f64; 2]; 2],
    /// χ² of the shifts with their covariance.
    pub chi_squared: f64,
    /// Number of shifts minus 2.
    pub degrees_of_freedom: usize,
}

impl Wlf {
    /// Returns ln a_T at `temperature` \[K\] with its standard error; `None` at and beyond the
    /// pole, that is, for 1 + κ(T - Tᵣ) <= 0.
    #[must_use]
    pub fn log_shift(&self, temperature: f64) -> Option<(f64, f64)> {
        let d = temperature - self.reference_temperature;
        let (value, gradient) = evaluate(self.slope, self.curvature, d)?;
        let variance = quadratic(&self.covariance, gradient);
        Some((value, variance.sqrt()))
    }

    /// Returns true if the shifts determine C₁ and C₂ separately, that is, if the interval of κ is
    /// above 0, so that the intervals of both are bounded. Otherwise only the ratio C₁/C₂ = β/ln 10
    /// is determined.
    #[must_use]
    pub fn constants_are_identified(&self) -> bool {
        self.curvature > 0.0 && self.c2_interval.upper.is_finite()
    }
}

/// Arrhenius law ln a_T = (E_a/R)(1/T - 1/Tᵣ).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Arrhenius {
    /// Reference temperature Tᵣ \[K\].
    pub reference_temperature: f64,
    /// Activation energy E_a [J/mol].
    pub activation_energy: f64,
    /// Standard error of E_a [J/mol].
    pub standard_error: f64,
    /// χ² of the shifts with their covariance.
    pub chi_squared: f64,
    /// Number of shifts minus 1.
    pub degrees_of_freedom: usize,
}

impl Arrhenius {
    /// Returns ln a_T at `temperature` \[K\] with its standard error; `None` unless the temperature
    /// is above 0.
    #[must_use]
    pub fn log_shift(&self, temperature: f64) -> Option<(f64, f64)> {
        (temperature > 0.0).then(|| {
            let x = (temperature.recip() - self.reference_temperature.recip()) / GAS_CONSTANT;
            (self.activation_energy * x, (self.standard_error * x).abs())
        })
    }
}

/// Laws of Williams, Landel & Ferry and of Arrhenius, fitted to the same shifts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct ShiftLaws {
    /// Law of Williams, Landel and Ferry.
    pub wlf: Wlf,
    /// Law of Arrhenius.
    pub arrhenius: Arrhenius,
    /// Probability of a decrease of χ² from Arrhenius to WLF at least as large as found, if the
    /// Arrhenius law is true (χ² of one degree of freedom).
    pub arrhenius_p_value: f64,
}

impl ShiftLaws {
    /// Fits both laws to `log_shifts` at `differences` T - Tᵣ \[K\] with their `covariance`. An
    /// interval extends over `quantile` standard errors of β and κ.
    pub(super) fn new(
        reference_temperature: f64,
        differences: &[f64],
        log_shifts: &[f64],
        covariance: &[Vec<f64>],
        quantile: f64,
    ) -> Result<Self, CmodError> {
        check_enough_readings(differences.len() + 1, 3)?;
        let factor = Cholesky::of(covariance).ok_or(CmodError::ShiftsUndetermined)?;
        let problem = Problem {
            differences,
            log_shifts,
            factor,
        };
        let arrhenius = problem.arrhenius(reference_temperature);
        let wlf = problem.wlf(reference_temperature, &arrhenius, quantile);
        let gain = (arrhenius.chi_squared - wlf.chi_squared).max(0.0);
        Ok(Self {
            wlf,
            arrhenius,
            arrhenius_p_value: ChiSquared::new(1.0).map_or(f64::NAN, |one| one.sf(gain)),
        })
    }

    /// Returns the probability of a χ² at least as large if the WLF law is true.
    #[must_use]
    pub fn wlf_p_value(&self) -> f64 {
        if self.wlf.degrees_of_freedom == 0 {
            return 1.0;
        }
        ChiSquared::new(count(self.wlf.degrees_of_freedom))
            .map_or(f64::NAN, |chi| chi.sf(self.wlf.chi_squared))
    }
}

impl fmt::Display for ShiftLaws {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (wlf, arrhenius) = (&self.wlf, &self.arrhenius);
        writeln!(
            f,
            "WLF: C1 = {:.2} +- {:.2}, C2 = {:.1} +- {:.1} K, chi-squared {:.1} with {} degrees of freedom",
            wlf.c1,
            wlf.c1_standard_error,
            wlf.c2,
            wlf.c2_standard_error,
            wlf.chi_squared,
            wlf.degrees_of_freedom
        )?;
        write!(
            f,
            "Arrhenius: {:.1} +- {:.1} kJ/mol, chi-squared {:.1} with {} degrees of freedom; p = {:.2e} against WLF",
            1e-3 * arrhenius.activation_energy,
            1e-3 * arrhenius.standard_error,
            arrhenius.chi_squared,
            arrhenius.degrees_of_freedom,
            self.arrhenius_p_value
        )
    }
}

/// Returns -βd/(1 + κd) and its derivatives with respect to β and κ; `None` beyond the pole.
fn evaluate(slope: f64, curvature: f64, d: f64) -> Option<(f64, [f64; 2])> {
    let pole = 1.0 + curvature * d;
    (pole > 0.0).then(|| {
        let by_slope = -d / pole;
        let by_curvature = -slope * by_slope * d / pole;
        (slope * by_slope, [by_slope, by_curvature])
    })
}

fn quadratic(matrix: &[[f64; 2]; 2], g: [f64; 2]) -> f64 {
    g[0] * (matrix[0][0] * g[0] + 2.0 * matrix[0][1] * g[1]) + matrix[1][1] * g[1] * g[1]
}

/// Interval without ends.
pub(super) const UNBOUNDED: Interval = Interval {
    lower: f64::NEG_INFINITY,
    upper: f64::INFINITY,
    method: IntervalMethod::Linear,
};

/// Returns the interval of the ratio R = p/q of two values with the variance of p, the covariance
/// and the variance of q: all R for which p - Rq is within `quantile` of its standard errors from 0
/// (Fieller, *J. R. Stat. Soc. B* **16** (1954) 175).
fn of_ratio([p, q]: [f64; 2], [of_p, mixed, of_q]: [f64; 3], quantile: f64) -> Interval {
    let square = quantile * quantile;
    let a = q * q - square * of_q;
    let b = p * q - square * mixed;
    let c = p * p - square * of_p;
    let root = (b * b - a * c).sqrt();
    let (lower, upper) = if a > 0.0 {
        ((b - root) / a, (b + root) / a)
    } else if c > 0.0 {
        // q = 0 is not excluded: the values of R form two branches, of which the one with R > 0 is
        // returned
        (c / (b + root), f64::INFINITY)
    } else {
        return UNBOUNDED;
    };
    Interval {
        lower,
        upper,
        ..UNBOUNDED
    }
}

struct Problem<'a> {
    differences: &'a [f64],
    log_shifts: &'a [f64],
    factor: Cholesky,
}

impl Problem<'_> {
    /// Returns χ² and the normal equations of a Gauss-Newton step.
    fn linearised(&self, slope: f64, curvature: f64) -> Option<(f64, [[f64; 2]; 2], [f64; 2])> {
        let n = self.differences.len();
        let mut residual = Vec::with_capacity(n);
        let mut columns = [Vec::with_capacity(n), Vec::with_capacity(n)];
        for (d, log_shift) in self.differences.iter().zip(self.log_shifts) {
            let (value, gradient) = evaluate(slope, curvature, *d)?;
            residual.push(value - log_shift);
            columns[0].push(gradient[0]);
            columns[1].push(gradient[1]);
        }
        self.factor.solve(&mut residual);
        for column in &mut columns {
            self.factor.solve(column);
        }
        let [a, b] = &columns;
        let mixed = dot(a, b);
        Some((
            dot(&residual, &residual),
            [[dot(a, a), mixed], [mixed, dot(b, b)]],
            [dot(a, &residual), dot(b, &residual)],
        ))
    }

    fn arrhenius(&self, reference: f64) -> Arrhenius {
        // at κ = 1/Tᵣ the problem is linear in β
        let curvature = reference.recip();
        let to_energy = GAS_CONSTANT * reference * reference;
        let (chi_squared, slope, variance) = self
            .linearised(0.0, curvature)
            .and_then(|(_, normal, gradient)| {
                let slope = -gradient[0] / normal[0][0];
                let (chi_squared, ..) = self.linearised(slope, curvature)?;
                Some((chi_squared, slope, normal[0][0].recip()))
            })
            .unwrap_or((f64::NAN, f64::NAN, f64::NAN));
        Arrhenius {
            reference_temperature: reference,
            activation_energy: to_energy * slope,
            standard_error: to_energy * variance.sqrt(),
            chi_squared,
            degrees_of_freedom: self.differences.len() - 1,
        }
    }

    /// Fits the WLF law by Gauss-Newton steps with halving, starting from the Arrhenius law, which
    /// has the same form.
    fn wlf(&self, reference: f64, arrhenius: &Arrhenius, quantile: f64) -> Wlf {
        let mut slope = arrhenius.activation_energy / (GAS_CONSTANT * reference * reference);
        let mut curvature = reference.recip();
        let mut covariance = [[f64::NAN; 2]; 2];
        let mut chi_squared = f64::NAN;
        if let Some(mut here) = self.linearised(slope, curvature) {
            for _ in 0..200 {
                let (value, normal, gradient) = here;
                let inverse = inverse(&normal);
                covariance = inverse;
                chi_squared = value;
                let step = [
                    -(inverse[0][0] * gradient[0] + inverse[0][1] * gradient[1]),
                    -(inverse[1][0] * gradient[0] + inverse[1][1] * gradient[1]),
                ];
                let promised = -(step[0] * gradient[0] + step[1] * gradient[1]);
                if promised.is_nan() || promised <= 1e-12 + 1e-14 * value {
                    break;
                }
                let mut share = 1.0;
                let next = loop {
                    let trial = (slope + share * step[0], curvature + share * step[1]);
                    match self.linearised(trial.0, trial.1) {
                        Some(next) if next.0 < value => break Some((next, trial)),
                        _ if share < 1e-6 => break None,
                        _ => share *= 0.5,
                    }
                };
                let Some((next, trial)) = next else {
                    break;
                };
                here = next;
                (slope, curvature) = trial;
            }
        }
        // C₁ = β/(κ ln 10), C₂ = 1/κ
        let log_ten = std::f64::consts::LN_10;
        let by = [
            (log_ten * curvature).recip(),
            -slope / (log_ten * curvature * curvature),
        ];
        Wlf {
            reference_temperature: reference,
            c1: slope / (curvature * log_ten),
            c2: curvature.recip(),
            c1_standard_error: quadratic(&covariance, by).sqrt(),
            c2_standard_error: covariance[1][1].sqrt() / (curvature * curvature),
            c1_interval: of_ratio(
                [slope / log_ten, curvature],
                [
                    covariance[0][0] / (log_ten * log_ten),
                    covariance[0][1] / log_ten,
                    covariance[1][1],
                ],
                quantile,
            ),
            c2_interval: of_ratio([1.0, curvature], [0.0, 0.0, covariance[1][1]], quantile),
            slope,
            curvature,
            covariance,
            chi_squared,
            degrees_of_freedom: self.differences.len() - 2,
        }
    }
}

fn inverse(m: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    [
        [m[1][1] / determinant, -m[0][1] / determinant],
        [-m[1][0] / determinant, m[0][0] / determinant],
    ]
}

/// Cholesky factor of the covariance of the shifts: the lower triangular L with LLᵀ equal to the
/// covariance.
struct Cholesky {
    rows: Vec<Vec<f64>>,
}

#[allow(
    clippy::indexing_slicing,
    reason = "the matrix is square, row i of its factor has i + 1 elements, and x has one for each row"
)]
impl Cholesky {
    fn of(matrix: &[Vec<f64>]) -> Option<Self> {
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(matrix.len());
        for (i, entries) in matrix.iter().enumerate() {
            let mut row: Vec<f64> = Vec::with_capacity(i + 1);
            for j in 0..i {
                let known: f64 = dot(&row, &rows[j]);
                row.push((entries[j] - known) / rows[j][j]);
            }
            let pivot = entries.get(i)? - row.iter().map(|l| l * l).sum::<f64>();
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            row.push(pivot.sqrt());
            rows.push(row);
        }
        Some(Self { rows })
    }

    /// Replaces x by L⁻¹ x.
    fn solve(&self, x: &mut [f64]) {
        for (i, row) in self.rows.iter().enumerate() {
            let known: f64 = row[..i].iter().zip(x.iter()).map(|(l, x)| l * x).sum();
            x[i] = (x[i] - known) / row[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use testbed::noise::Noise;

    use super::*;

    /// Fits the shifts of eight temperatures relative to a ninth, for C₁ = 8 and C₂ = 180 K, with
    /// independent errors of a quarter of a decade; the median of κ divided by its standard error
    /// is 2.8. In a numpy model of 4000 draws, 95.1 % of the intervals contain C₁ and C₂, but only
    /// 91 % of the values are within 1.96 standard errors.
    #[test]
    fn intervals_of_the_constants_cover_them() {
        let (c1, c2) = (8.0, 180.0);
        let differences = [-40.0, -30.0, -20.0, -10.0, 10.0, 20.0, 30.0, 40.0];
        let error = 0.25 * std::f64::consts::LN_10;
        let covariance: Vec<Vec<f64>> = (0..differences.len())
            .map(|row| {
                let own = |column| if row == column { error * error } else { 0.0 };
                (0..differences.len()).map(own).collect()
            })
            .collect();
        let draws = 4000;
        let mut random = Noise::seeded(1);
        let (mut covered, mut by_errors, mut identified) = ([0.0; 2], [0.0; 2], 0.0);
        for _ in 0..draws {
            let log_shifts = differences
                .map(|d| -std::f64::consts::LN_10 * c1 * d / (c2 + d) + error * random.normal());
            let wlf = ShiftLaws::new(353.15, &differences, &log_shifts, &covariance, 1.959_964)
                .unwrap()
                .wlf;
            let share = f64::from(draws).recip();
            let constants = [
                (c1, wlf.c1, wlf.c1_standard_error, wlf.c1_interval),
                (c2, wlf.c2, wlf.c2_standard_error, wlf.c2_interval),
            ];
            for (k, (truth, value, error, interval)) in constants.into_iter().enumerate() {
                covered[k] += f64::from(interval.contains(truth)) * share;
                by_errors[k] += f64::from((value - truth).abs() <= 1.959_964 * error) * share;
                assert!(
                    !interval.upper.is_finite() || interval.contains(value),
                    "{wlf:?}"
                );
            }
            identified += f64::from(wlf.constants_are_identified()) * share;
        }
        // a fraction of 95 % of 4000 draws has the standard deviation 0.34 %; the tolerance is four
        // times this value
        assert!(
            covered.iter().all(|c| (c - 0.95).abs() < 0.014),
            "{covered:?}"
        );
        // the coverage by standard errors, which are of first order, is below this range
        assert!(by_errors.iter().all(|c| *c < 0.936), "{by_errors:?}");
        assert!((0.6..0.95).contains(&identified), "{identified}");
    }

    /// The interval of 1/q is the reciprocal of the interval of q.
    #[test]
    fn interval_of_a_reciprocal() {
        let bounded = of_ratio([1.0, 0.5], [0.0, 0.0, 0.01], 2.0);
        assert!((bounded.lower - 1.0 / 0.7).abs() < 1e-14, "{bounded:?}");
        assert!((bounded.upper - 1.0 / 0.3).abs() < 1e-14, "{bounded:?}");
        let open = of_ratio([1.0, 0.1], [0.0, 0.0, 0.01], 2.0);
        assert!(
            (open.lower - 1.0 / 0.3).abs() < 1e-14 && open.upper == f64::INFINITY,
            "{open:?}"
        );
        let straight = of_ratio([1.0, 0.0], [0.0, 0.0, 0.01], 2.0);
        assert!((straight.lower - 5.0).abs() < 1e-14, "{straight:?}");
        assert_eq!(of_ratio([0.1, 0.1], [0.01, 0.0, 0.01], 2.0), UNBOUNDED);
    }
}
