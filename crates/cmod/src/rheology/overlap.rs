//! Shift between two curves from their overlap, without any law.

use num_complex::Complex64;

use super::count;
use super::data::ModulusData;

/// Number of steps of the shift per mean distance between the lines.
const STEPS_A_LINE: f64 = 4.0;
/// Number of golden-section steps on an interval of two steps of the shift; they determine the
/// shift to a hundredth of a step.
const REFINEMENTS: u32 = 12;
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Minimum number of points in the overlap, of both curves together.
const FEWEST: usize = 3;
/// Correction for an overlap of few points, which may fit well by chance: the mean square is
/// increased by the fraction `CHANCE` divided by the number of points.
const CHANCE: f64 = 6.0;

/// Mean square of a point, which has two values, relative to the covariances of both curves, if the
/// curves differ by noise only.
const OF_NOISE: f64 = 2.0;
/// Accepted excess over [`OF_NOISE`]. `UNDERSTATED` allows for true errors up to 1.6 times the
/// stated errors; `MOST_EXCESS` divided by √m, as a fraction of [`OF_NOISE`], allows for the
/// scatter of a mean over m points.
const UNDERSTATED: f64 = 3.0;
const MOST_EXCESS: f64 = 4.0;

/// Best overlap of two curves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Overlap {
    /// Logarithmic shift s.
    pub(super) log_shift: f64,
    /// Logarithm of the factor b.
    pub(super) log_factor: f64,
    /// Number of points of both curves within the band of the other curve.
    pub(super) points: usize,
    /// Mean whitened square of these points.
    pub(super) mean_square: f64,
}

impl Overlap {
    /// Returns true if the curves differ in the overlap by no more than noise.
    pub(super) fn agrees(&self) -> bool {
        let chance = OF_NOISE * (1.0 + MOST_EXCESS / count(self.points).sqrt());
        self.mean_square <= chance + UNDERSTATED
    }
}

/// Returns the shift s for which E_b(ω) = b E_a(ω e^s) fits best, with b = 1 or b fitted; `None` if
/// no shift makes the curves overlap.
///
/// The measure is the mean square of the difference between a point and the other curve,
/// interpolated over ln ω, relative to the covariance of both. The mean is taken over all points of
/// both curves within the band of the other curve. A mean is used, and not a sum, so that the
/// length of the overlap has no influence.
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
    // only lines of the same kind are compared with each other
    let mut pairs: Vec<(ModulusData, ModulusData)> = Vec::new();
    for reading in &a.readings {
        let is_new = |(own, _): &(ModulusData, ModulusData)| {
            !own.readings
                .first()
                .is_some_and(|own| own.is_like(*reading))
        };
        if pairs.iter().all(is_new) {
            pairs.push((a.as_steps(*reading), b.as_steps(*reading)));
        }
    }
    let measure = |s: f64| {
        let log_factor = if free_factor { factor(&pairs, s)? } else { 0.0 };
        let (mut sum, mut points) = (0.0, 0);
        for (a, b) in &pairs {
            for (of_pair, own) in [
                distance(b, a, s, log_factor),
                distance(a, b, -s, -log_factor),
            ] {
                sum += of_pair;
                points += own;
            }
        }
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
    // if there are few lines, a step is many standard errors of the shift, so the least value
    // between the neighbouring steps is determined
    let (mut low, mut high) = (at(k.saturating_sub(1)), at((k + 1).min(steps)));
    let mut least = (value(&found), found);
    for _ in 0..REFINEMENTS {
        let inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        let [left, right] = inner.map(|s| measure(s).map(|found| (value(&found), found)));
        let of = |side: &Option<(f64, Overlap)>| side.map_or(f64::INFINITY, |(value, _)| value);
        if of(&left) <= of(&right) {
            high = inner[1];
        } else {
            low = inner[0];
        }
        for (value, found) in [left, right].into_iter().flatten() {
            if value < least.0 {
                least = (value, found);
            }
        }
    }
    Some(least.1)
}

/// Returns the mean of ln(|E_data|/|E_curve|) over the points of the data that are within the band
/// of the curve after the shift by `s`. Each pair is a curve and its data.
fn factor(pairs: &[(ModulusData, ModulusData)], s: f64) -> Option<f64> {
    let lines = pairs.iter().flat_map(|(curve, data)| {
        let lines = data.omega.iter().zip(&data.modulus);
        lines.map(move |line| (curve, line))
    });
    let ratios: Vec<f64> = lines
        .filter_map(|(curve, (omega, modulus))| {
            let (expected, _) = interpolated(curve, omega * s.exp())?;
            Some((modulus.norm() / expected.norm()).ln())
        })
        .collect();
    (!ratios.is_empty()).then(|| ratios.iter().sum::<f64>() / count(ratios.len()))
}

/// Returns the sum of squares of the differences between `data` and `curve` times the factor,
/// relative to the covariance of both, and the number of points in the sum. The sum is over the
/// points of `data` that are within the band of `curve` after the shift by `s`.
fn distance(data: &ModulusData, curve: &ModulusData, s: f64, log_factor: f64) -> (f64, usize) {
    let (shift, factor) = (s.exp(), log_factor.exp());
    let mut sum = 0.0;
    let mut points = 0;
    for ((omega, modulus), whitening) in data.omega.iter().zip(&data.modulus).zip(&data.whitening) {
        if let Some((expected, own)) = interpolated(curve, omega * shift) {
            let delta = modulus - factor * expected;
            let mut covariance = whitening.covariance();
            for (sum, other) in covariance.iter_mut().zip(own) {
                *sum += factor * factor * other;
            }
            let [storage, mixed, loss] = covariance;
            let determinant = storage * loss - mixed * mixed;
            sum += if loss.is_finite() {
                (loss * delta.re * delta.re - 2.0 * mixed * delta.re * delta.im
                    + storage * delta.im * delta.im)
                    / determinant
            } else {
                delta.re * delta.re / storage
            };
            points += 1;
        }
    }
    (sum, points)
}

/// Returns the modulus at `omega` within the band, with its covariance as in
/// [`Whitening::covariance`]. It is interpolated by the polynomial in ln ω through two points on
/// either side, of which the outer ones may be missing.
///
/// A straight line is not sufficient: with two points per decade, its error at the peak of the loss
/// is some per cent, which is more than the noise of an instrument.
fn interpolated(curve: &ModulusData, omega: f64) -> Option<(Complex64, [f64; 3])> {
    let after = curve.omega.partition_point(|line| *line < omega);
    let inside = after > 0 && after < curve.omega.len();
    let places = inside.then(|| after.saturating_sub(2)..(after + 2).min(curve.omega.len()))?;
    let nodes = curve.omega.get(places.clone())?;
    let moduli = curve.modulus.get(places.clone())?;
    let whitenings = curve.whitening.get(places)?;
    let mut value = Complex64::ZERO;
    let mut covariance = [0.0; 3];
    for (at, ((node, modulus), whitening)) in nodes.iter().zip(moduli).zip(whitenings).enumerate() {
        let others = nodes.iter().enumerate().filter(|(other, _)| *other != at);
        let weight: f64 = others
            .map(|(_, other)| (omega / other).ln() / (node / other).ln())
            .product();
        value += modulus * weight;
        for (sum, own) in covariance.iter_mut().zip(whitening.covariance()) {
            *sum += weight * weight * own;
        }
    }
    Some((value, covariance))
}
