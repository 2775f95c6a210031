//! Starting points for the laws with one relaxation: the best points of a grid. At each point of
//! the grid the law is linear in its moduli.

use std::f64::consts::FRAC_PI_2;

use num_complex::Complex64;

use super::data::ModulusData;
use super::{count, straight_line};

/// Maximum number of lines on which the grid is evaluated.
const MOST_LINES: usize = 32;
/// Values of τ per decade, over the band and a factor of ten on either side.
const TIMES_A_DECADE: f64 = 3.0;

/// Shape of the relaxation, that is, of the increase of the modulus with frequency.
pub(super) struct Shape {
    /// Number of exponents that are coordinates: none, αβ, or α and αβ.
    pub(super) exponents: usize,
    /// Exponents α and αβ of the grid.
    pub(super) grid: &'static [(f64, f64)],
    /// Exponents α and αβ of a relaxation outside the band.
    pub(super) at_the_limits: (f64, f64),
}

impl Shape {
    /// Returns the coordinates of a relaxation.
    fn at(&self, moduli: (f64, f64), log_time: f64, (alpha, product): (f64, f64)) -> Vec<f64> {
        let (relaxed, increment) = moduli;
        let exponents = [alpha, product].into_iter().skip(2 - self.exponents);
        let log_odds = exponents.map(|p| (p / (1.0 - p)).ln());
        [relaxed.ln(), increment.ln(), log_time]
            .into_iter()
            .chain(log_odds)
            .collect()
    }
}

/// Returns coordinates to start from, the best first, `most` of them.
pub(super) fn of_one_relaxation(data: &ModulusData, shape: &Shape, most: usize) -> Vec<Vec<f64>> {
    let lines = some_lines(data);
    let moduli = data.linear_moduli();
    let (lowest, highest) = data.band();
    let decade = std::f64::consts::LN_10;
    let (first, last) = (-highest.ln() - decade, -lowest.ln() + decade);
    let mut best: Vec<(f64, Vec<f64>)> = Vec::new();
    for &(alpha, product) in shape.grid {
        let symmetric = product >= alpha;
        let mut best_of_shape: Option<(f64, Vec<f64>)> = None;
        let mut log_time = first;
        while log_time <= last {
            let law = |s: Complex64| {
                let s_tau = s * log_time.exp();
                let power = if alpha < 1.0 {
                    s_tau.powf(alpha)
                } else {
                    s_tau
                };
                if symmetric {
                    power / (1.0 + power)
                } else {
                    1.0 - (1.0 + power).powf(-product / alpha)
                }
            };
            let (chi_squared, relaxed, increment) = two_moduli(data, &moduli, &lines, law);
            if best_of_shape
                .as_ref()
                .is_none_or(|(least, _)| chi_squared < *least)
            {
                let at = shape.at((relaxed, increment), log_time, (alpha, product));
                best_of_shape = Some((chi_squared, at));
            }
            log_time += decade / TIMES_A_DECADE;
        }
        best.extend(best_of_shape);
    }
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    best.into_iter().take(most).map(|(_, at)| at).collect()
}

/// Returns starting coordinates with a relaxation outside the band, where it has no effect on the
/// data: slower than the band, with and without a parallel spring, and faster than the band.
pub(super) fn at_the_limits(data: &ModulusData, shape: &Shape) -> Vec<Vec<f64>> {
    const FAR: f64 = 30.0;
    let lines = some_lines(data);
    let (lowest, highest) = data.band();
    let measured = data.linear_moduli();
    let moduli = |log_time: f64| {
        let law = |s: Complex64| {
            let s_tau = s * log_time.exp();
            s_tau / (1.0 + s_tau)
        };
        let (_, relaxed, increment) = two_moduli(data, &measured, &lines, law);
        (relaxed, increment)
    };
    let (slow, fast) = ((FAR / lowest).ln(), -(FAR * highest).ln());
    let (relaxed, increment) = moduli(slow);
    let (own, of_fast) = moduli(fast);
    let all = relaxed + increment;
    [
        (relaxed, increment, slow),
        (1e-3 * all, all, slow),
        (own, of_fast, fast),
    ]
    .into_iter()
    .map(|(relaxed, increment, time)| shape.at((relaxed, increment), time, shape.at_the_limits))
    .collect()
}

/// Returns the best ln E of the elastic law, which is linear in E.
pub(super) fn of_elastic(data: &ModulusData) -> Vec<Vec<f64>> {
    let (_, modulus) = one_modulus(data, &data.linear_moduli(), |_| Complex64::ONE);
    vec![vec![modulus.ln()]]
}

/// Returns the mean of ln |E| and the mean of the logarithm of the loss factor. If there are lines
/// over time, the loss factor is computed from the slope of the modulus.
pub(super) fn of_constant_q(data: &ModulusData) -> Vec<f64> {
    let n = count(data.len());
    let size: f64 = data.modulus.iter().map(|e| e.norm().ln() / n).sum();
    let loss: f64 = if data.has_times() {
        let lines = data.omega.iter().zip(&data.modulus);
        let points: Vec<(f64, f64)> = lines.map(|(w, e)| (w.ln(), e.norm().ln())).collect();
        let exponent = straight_line(&points).map_or(0.0, |(_, slope)| slope);
        (FRAC_PI_2 * exponent.clamp(0.0, 0.9)).tan()
    } else {
        data.modulus.iter().map(|e| e.im / e.re / n).sum()
    };
    vec![size, loss.max(1e-3).ln()]
}

/// Returns ln |E| and the exponent (2/π) atan tan δ.
pub(super) fn of_spring_pot(data: &ModulusData) -> Vec<f64> {
    let mut at = of_constant_q(data);
    if let Some(loss) = at.last_mut() {
        let exponent = (std::f64::consts::FRAC_2_PI * loss.exp().atan()).min(0.999);
        *loss = (exponent / (1.0 - exponent)).ln();
    }
    at
}

/// Returns the two best starting points for a law without a spring: ln E₁, ln τ and, for exponents
/// below 1, the log odds of the exponent. They are selected from the best point of a grid for each
/// of the `exponents`.
pub(super) fn of_fluid(data: &ModulusData, exponents: &[f64]) -> Vec<Vec<f64>> {
    let (lowest, highest) = data.band();
    let decade = std::f64::consts::LN_10;
    let moduli = data.linear_moduli();
    let mut best = Vec::new();
    for alpha in exponents {
        let mut of_shape: Option<(f64, Vec<f64>)> = None;
        let mut log_time = -highest.ln() - 3.0 * decade;
        while log_time <= -lowest.ln() + 3.0 * decade {
            let law = |s: Complex64| {
                let power = (s * log_time.exp()).powf(*alpha);
                power / (1.0 + power)
            };
            let (chi_squared, modulus) = one_modulus(data, &moduli, law);
            if modulus > 0.0
                && of_shape
                    .as_ref()
                    .is_none_or(|(least, _)| chi_squared < *least)
            {
                let mut at = vec![modulus.ln(), log_time];
                if *alpha < 1.0 {
                    at.push((alpha / (1.0 - alpha)).ln());
                }
                of_shape = Some((chi_squared, at));
            }
            log_time += decade / TIMES_A_DECADE;
        }
        best.extend(of_shape);
    }
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    best.into_iter().take(2).map(|(_, at)| at).collect()
}

/// Returns χ² and the best modulus E of the law E · `law`(s).
fn one_modulus(
    data: &ModulusData,
    moduli: &[Complex64],
    law: impl Fn(Complex64) -> Complex64,
) -> (f64, f64) {
    let (mut own, mut mixed, mut square) = (0.0, 0.0, 0.0);
    for (line, (whitening, modulus)) in data.whitening.iter().zip(moduli).enumerate() {
        let column = whitening.apply(data.linear_response(line, &law));
        let target = whitening.apply(*modulus);
        for (column, target) in column.into_iter().zip(target) {
            own += column * column;
            mixed += column * target;
            square += target * target;
        }
    }
    (square - mixed * mixed / own, mixed / own)
}

/// Returns the best ln E and ln η of the Kelvin-Voigt model, which is linear in E and η over
/// frequency. For data over time, E is the least modulus and η/E is the geometric mean of the
/// shortest and the longest time.
pub(super) fn of_kelvin_voigt(data: &ModulusData) -> Vec<f64> {
    if data.has_times() {
        let moduli = data.modulus.iter().map(|modulus| modulus.norm());
        let least = moduli.fold(f64::INFINITY, f64::min).ln();
        let (lowest, highest) = data.band();
        return vec![least, least - 0.5 * (lowest.ln() + highest.ln())];
    }
    let lines: Vec<usize> = (0..data.len()).collect();
    let highest = data.band().1;
    let law = |s| s / highest;
    let (_, modulus, viscosity) = two_moduli(data, &data.linear_moduli(), &lines, law);
    vec![modulus.ln(), (viscosity / highest).ln()]
}

/// Returns the indices of evenly spaced lines, at most [`MOST_LINES`] of them.
fn some_lines(data: &ModulusData) -> Vec<usize> {
    let stride = data.len().div_ceil(MOST_LINES);
    (0..data.len()).step_by(stride.max(1)).collect()
}

/// Returns χ² and the best E₀ and ΔE >= 0 of E₀ + ΔE `law`(s). A value below a thousandth of the
/// modulus is set to a thousandth of the modulus, so that the iteration can change it.
#[allow(
    clippy::indexing_slicing,
    reason = "`lines` are numbers of lines of `data`"
)]
fn two_moduli(
    data: &ModulusData,
    moduli: &[Complex64],
    lines: &[usize],
    law: impl Fn(Complex64) -> Complex64,
) -> (f64, f64, f64) {
    let (mut aa, mut ab, mut bb, mut ay, mut by, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let mut magnitude = 0.0;
    for line in lines {
        let whitening = &data.whitening[*line];
        let a = whitening.apply(Complex64::ONE);
        let b = whitening.apply(data.linear_response(*line, &law));
        let y = whitening.apply(moduli[*line]);
        for ((a, b), y) in a.into_iter().zip(b).zip(y) {
            aa += a * a;
            ab += a * b;
            bb += b * b;
            ay += a * y;
            by += b * y;
            yy += y * y;
        }
        magnitude += moduli[*line].norm() / count(lines.len());
    }
    let determinant = aa * bb - ab * ab;
    let least = 1e-3 * magnitude;
    let mut relaxed = (bb * ay - ab * by) / determinant;
    let mut increment = (aa * by - ab * ay) / determinant;
    if increment.is_nan() || increment <= least {
        increment = least;
        relaxed = (ay - ab * increment) / aa;
    }
    if relaxed.is_nan() || relaxed <= least {
        relaxed = least;
        increment = ((by - ab * relaxed) / bb).max(least);
    }
    let chi_squared = yy - 2.0 * (relaxed * ay + increment * by)
        + relaxed * relaxed * aa
        + 2.0 * relaxed * increment * ab
        + increment * increment * bb;
    (chi_squared, relaxed, increment)
}
