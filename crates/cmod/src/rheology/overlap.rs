//! The shift between two curves from where they overlap, without any law.

use num_complex::Complex64;

use super::data::ModulusData;
use super::least_squares::count;

/// Shifts are tried in steps of a quarter of the mean distance of the lines.
const STEPS_A_LINE: f64 = 4.0;
/// Fewer points in the overlap, of both curves together, are none.
const FEWEST: usize = 3;
/// An overlap of few points is good by chance: the mean square is raised by this share over the number of points.
const CHANCE: f64 = 6.0;

/// Mean whitened square of a point, two values, of two curves that are the same but for their noise: 2 of its own, and as much of the
/// other curve.
const OF_NOISE: f64 = 4.0;
/// Accepted excess over [`OF_NOISE`] for one point, in shares; of m points it is less by √m.
const MOST_EXCESS: f64 = 4.0;

/// Where two curves overlap best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Overlap {
    /// The shift s.
    pub(super) log_shift: f64,
    /// ln of the factor b.
    pub(super) log_factor: f64,
    /// Points of both within the band of the other.
    pub(super) points: usize,
    /// Their mean whitened square.
    pub(super) mean_square: f64,
}

impl Overlap {
    /// Whether the curves differ there by no more than noise.
    pub(super) fn agrees(&self) -> bool {
        self.mean_square <= OF_NOISE * (1.0 + MOST_EXCESS / count(self.points).sqrt())
    }
}

/// The shift s for which E_b(ω) = b E_a(ω e^s) holds best, with b = 1 or free; `None` if no shift makes the curves overlap.
///
/// The measure is the mean whitened square of the difference to the other curve, interpolated linearly over ln ω, over all
/// points of both that lie within the band of the other. A mean, so that no overlap is preferred for its length.
pub(super) fn best(a: &ModulusData, b: &ModulusData, free_factor: bool) -> Option<Overlap> {
    let ((a_low, a_high), (b_low, b_high)) = (a.band(), b.band());
    let spacing = (b_high / b_low).ln() / count(b.len() - 1).max(1.0);
    let step = spacing.min((a_high / a_low).ln() / count(a.len() - 1).max(1.0)) / STEPS_A_LINE;
    let (first, last) = ((a_low / b_high).ln(), (a_high / b_low).ln());
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive ratio, limited"
    )]
    let steps = ((last - first) / step).ceil().min(1e5) as u32;
    let at = |k: u32| first + (last - first) * f64::from(k) / f64::from(steps);
    let measure = |s: f64| {
        let log_factor = if free_factor { factor(b, a, s)? } else { 0.0 };
        let (mut sum, mut points) = distance(b, a, s, log_factor);
        let (back, others) = distance(a, b, -s, -log_factor);
        sum += back;
        points += others;
        (points >= FEWEST).then(|| Overlap {
            log_shift: s,
            log_factor,
            points,
            mean_square: sum / count(points),
        })
    };
    let value = |found: &Overlap| found.mean_square * (1.0 + CHANCE / count(found.points));
    let (_, k, found) = (0..=steps)
        .filter_map(|k| measure(at(k)).map(|found| (value(&found), k, found)))
        .min_by(|x, y| x.0.total_cmp(&y.0))?;
    // a parabola through the neighbours
    if k == 0 || k == steps {
        return Some(found);
    }
    let (Some(left), Some(right)) = (measure(at(k - 1)), measure(at(k + 1))) else {
        return Some(found);
    };
    let (left, middle, right) = (value(&left), value(&found), value(&right));
    let curvature = left - 2.0 * middle + right;
    let correction = if curvature > 0.0 {
        (0.5 * (left - right) / curvature).clamp(-0.5, 0.5)
    } else {
        0.0
    };
    Some(Overlap {
        log_shift: found.log_shift + correction * (at(k) - at(k - 1)),
        ..found
    })
}

/// Mean of ln(|E_data|/|E_curve|) over the points of `data` that, shifted by `s`, lie within the band of `curve`.
fn factor(data: &ModulusData, curve: &ModulusData, s: f64) -> Option<f64> {
    let lines = data.omega.iter().zip(&data.modulus);
    let ratios: Vec<f64> = lines
        .filter_map(|(omega, modulus)| {
            let expected = interpolated(curve, omega * s.exp())?;
            Some((modulus.norm() / expected.norm()).ln())
        })
        .collect();
    (!ratios.is_empty()).then(|| ratios.iter().sum::<f64>() / count(ratios.len()))
}

/// Sum of whitened squares over the points of `data` that, shifted by `s`, lie within the band of `curve` times the factor, and their
/// number.
fn distance(data: &ModulusData, curve: &ModulusData, s: f64, log_factor: f64) -> (f64, usize) {
    let (shift, factor) = (s.exp(), log_factor.exp());
    let mut sum = 0.0;
    let mut points = 0;
    for ((omega, modulus), whitening) in data.omega.iter().zip(&data.modulus).zip(&data.whitening) {
        if let Some(expected) = interpolated(curve, omega * shift) {
            let [storage, loss] = whitening.apply(modulus - factor * expected);
            sum += storage * storage + loss * loss;
            points += 1;
        }
    }
    (sum, points)
}

fn interpolated(curve: &ModulusData, omega: f64) -> Option<Complex64> {
    let right = curve.omega.partition_point(|line| *line < omega);
    if right == 0 {
        return None;
    }
    let &[before, after] = curve.omega.get(right - 1..=right)? else {
        return None;
    };
    let &[left, right] = curve.modulus.get(right - 1..=right)? else {
        return None;
    };
    let share = (omega / before).ln() / (after / before).ln();
    Some(left * (1.0 - share) + right * share)
}
