//! Test that every permitted filter differentiates all polynomials up to its degree.

use maxwellid::Differentiator;

/// Compares the slope in the middle of the window with that of Legendre polynomials, which are
/// bounded over the window.
#[test]
fn all_polynomials_of_the_degree_are_differentiated() {
    for half_width in [1_usize, 2, 3, 7, 20, 47, 100] {
        let degrees =
            (1..=2 * half_width).filter(|d| *d < 12 || d % 17 == 0 || *d == 2 * half_width);
        for degree in degrees {
            let filter = Differentiator::new(half_width, degree).unwrap();
            let weights = filter.weights();
            let size = weights.iter().map(|w| w.abs()).sum::<f64>();
            for order in 0..=degree {
                let m = half_width as f64;
                let (values, slope) = legendre(order, half_width);
                let found: f64 = weights.iter().zip(&values).map(|(w, p)| w * p).sum();
                // tolerance: rounding of a sum of numbers up to 1 with weights of this size
                let allowed = 1e-12 * size.max(slope.abs() / m);
                assert!(
                    (found - slope / m).abs() < allowed,
                    "{half_width} {degree} {order}: {found} {}",
                    slope / m
                );
            }
            for (low, high) in weights.iter().zip(weights.iter().rev()) {
                assert!(
                    (low + high).abs() < 1e-13 * size,
                    "{half_width} {degree}: not odd"
                );
            }
        }
    }
}

/// Legendre polynomial `P_n` at the points, and its slope `P_n'(0)`.
fn legendre(order: usize, half_width: usize) -> (Vec<f64>, f64) {
    let points = 2 * half_width + 1;
    let x = |i: usize| (i as f64 - half_width as f64) / half_width as f64;
    let (mut before, mut now) = (vec![0.0; points], vec![1.0; points]);
    let (mut slope_before, mut slope) = (0.0, 0.0);
    for n in 0..order {
        let n = n as f64;
        let next = (0..points)
            .map(|i| ((2.0 * n + 1.0) * x(i) * now[i] - n * before[i]) / (n + 1.0))
            .collect();
        let next_slope = ((2.0 * n + 1.0) * now[half_width] - n * slope_before) / (n + 1.0);
        (before, now) = (now, next);
        (slope_before, slope) = (slope, next_slope);
    }
    (now, slope)
}
