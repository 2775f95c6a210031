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

/// The shift s for which E_b(ω) = E_a(ω e^s) holds best; `None` if no shift makes the curves overlap.
///
/// The measure is the mean whitened square of the difference to the other curve, interpolated linearly over ln ω, over all
/// points of both that lie within the band of the other. A mean, so that no overlap is preferred for its length.
pub(super) fn shift(a: &ModulusData, b: &ModulusData) -> Option<f64> {
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
    let value = |s: f64| {
        let (mut sum, mut points) = distance(b, a, s);
        let (back, others) = distance(a, b, -s);
        sum += back;
        points += others;
        (points >= FEWEST).then(|| sum / count(points) * (1.0 + CHANCE / count(points)))
    };
    let (_, best) = (0..=steps)
        .filter_map(|k| value(at(k)).map(|value| (value, k)))
        .min_by(|x, y| x.0.total_cmp(&y.0))?;
    // a parabola through the neighbours
    let s = at(best);
    if best == 0 || best == steps {
        return Some(s);
    }
    let (Some(left), Some(middle), Some(right)) =
        (value(at(best - 1)), value(s), value(at(best + 1)))
    else {
        return Some(s);
    };
    let curvature = left - 2.0 * middle + right;
    let correction = if curvature > 0.0 {
        (0.5 * (left - right) / curvature).clamp(-0.5, 0.5)
    } else {
        0.0
    };
    Some(s + correction * (at(best) - at(best - 1)))
}

/// Sum of whitened squares over the points of `data` that, shifted by `s`, lie within the band of `curve`, and their number.
fn distance(data: &ModulusData, curve: &ModulusData, s: f64) -> (f64, usize) {
    let factor = s.exp();
    let mut sum = 0.0;
    let mut points = 0;
    for ((omega, modulus), whitening) in data.omega.iter().zip(&data.modulus).zip(&data.whitening) {
        if let Some(expected) = interpolated(curve, omega * factor) {
            let [storage, loss] = whitening.apply(modulus - expected);
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
