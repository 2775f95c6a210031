//! Starts for the laws with one relaxation: the best points of a grid, on which the moduli are linear.

use num_complex::Complex64;

use super::data::ModulusData;
use super::least_squares::count;
use super::power_law::PowerLawModel;

/// The grid is evaluated on at most this many lines.
const MOST_LINES: usize = 32;
/// Values of ln τ a factor of ten, over the band and a factor of ten to either side.
const TIMES_A_DECADE: f64 = 3.0;

/// How the increment of the modulus is spread over the frequencies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Zener,
    FractionalZener,
    HavriliakNegami,
}

impl Shape {
    /// Exponents α and αβ of the grid.
    fn exponents(self) -> &'static [(f64, f64)] {
        match self {
            Self::Zener => &[(1.0, 1.0)],
            Self::FractionalZener => &[(0.2, 0.2), (0.4, 0.4), (0.6, 0.6), (0.85, 0.85)],
            Self::HavriliakNegami => &[
                (0.2, 0.2),
                (0.4, 0.4),
                (0.4, 0.15),
                (0.7, 0.7),
                (0.7, 0.3),
                (0.7, 0.1),
                (0.95, 0.9),
                (0.95, 0.3),
            ],
        }
    }
}

/// Coordinates to start from, the best first.
#[allow(
    clippy::indexing_slicing,
    reason = "`lines` are numbers of lines of `data`"
)]
pub(super) fn of_one_relaxation(data: &ModulusData, shape: Shape) -> Vec<Vec<f64>> {
    let lines = some_lines(data);
    let (lowest, highest) = data.band();
    let decade = std::f64::consts::LN_10;
    let (first, last) = (-highest.ln() - decade, -lowest.ln() + decade);
    let mut best: Vec<(f64, Vec<f64>)> = Vec::new();
    for &(alpha, product) in shape.exponents() {
        let symmetric = product >= alpha;
        let mut best_of_shape: Option<(f64, Vec<f64>)> = None;
        let mut log_time = first;
        while log_time <= last {
            let spread: Vec<Complex64> = lines
                .iter()
                .map(|line| {
                    let s_tau = Complex64::new(0.0, data.omega[*line] * log_time.exp());
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
                })
                .collect();
            let (chi_squared, relaxed, increment) = two_moduli(data, &lines, &spread);
            if best_of_shape
                .as_ref()
                .is_none_or(|(least, _)| chi_squared < *least)
            {
                let mut at = vec![relaxed.ln(), increment.ln(), log_time];
                let log_odds = |p: f64| (p / (1.0 - p)).ln();
                match shape {
                    Shape::Zener => {}
                    Shape::FractionalZener => at.push(log_odds(alpha)),
                    Shape::HavriliakNegami => at.extend([log_odds(alpha), log_odds(product)]),
                }
                best_of_shape = Some((chi_squared, at));
            }
            log_time += decade / TIMES_A_DECADE;
        }
        best.extend(best_of_shape);
    }
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    best.into_iter().map(|(_, at)| at).collect()
}

/// ln E and ln η of the Kelvin-Voigt model, which is linear in E and η.
pub(super) fn of_kelvin_voigt(data: &ModulusData) -> Vec<f64> {
    let lines: Vec<usize> = (0..data.len()).collect();
    let highest = data.band().1;
    let spread: Vec<Complex64> = data
        .omega
        .iter()
        .map(|omega| Complex64::new(0.0, omega / highest))
        .collect();
    let (_, modulus, viscosity) = two_moduli(data, &lines, &spread);
    vec![modulus.ln(), (viscosity / highest).ln()]
}

pub(super) fn of_power_law(data: &ModulusData, model: &PowerLawModel) -> Option<Vec<f64>> {
    model.start(data)
}

/// Evenly chosen lines.
fn some_lines(data: &ModulusData) -> Vec<usize> {
    let stride = data.len().div_ceil(MOST_LINES);
    (0..data.len()).step_by(stride.max(1)).collect()
}

/// The best E₀ and ΔE >= 0 of E₀ + ΔE `spread`, and χ². Where one would be 0 or less it is a thousandth of the modulus, which
/// the iteration can leave.
#[allow(
    clippy::indexing_slicing,
    reason = "`lines` are numbers of lines of `data`"
)]
fn two_moduli(data: &ModulusData, lines: &[usize], spread: &[Complex64]) -> (f64, f64, f64) {
    let (mut aa, mut ab, mut bb, mut ay, mut by, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let mut magnitude = 0.0;
    for (line, spread) in lines.iter().zip(spread) {
        let whitening = &data.whitening[*line];
        let a = whitening.apply(Complex64::ONE);
        let b = whitening.apply(*spread);
        let y = whitening.apply(data.modulus[*line]);
        for ((a, b), y) in a.into_iter().zip(b).zip(y) {
            aa += a * a;
            ab += a * b;
            bb += b * b;
            ay += a * y;
            by += b * y;
            yy += y * y;
        }
        magnitude += data.modulus[*line].norm() / count(lines.len());
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
