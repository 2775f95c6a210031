//! Division of complex numbers whose squares overflow or underflow.

use num_complex::Complex64;

/// Computes a/b.
///
/// The plain quotient computes ab* and |b|², which overflow above 1e154 or so and lose digits below
/// 1e-154. Only in these cases is another form used; all other results are therefore bit-identical
/// to the plain quotient.
#[inline]
pub(crate) fn quotient(a: Complex64, b: Complex64) -> Complex64 {
    let plain = a / b;
    if b.norm_sqr().is_normal() && plain.is_finite() {
        plain
    } else {
        scaled(a, b)
    }
}

#[cold]
fn scaled(a: Complex64, b: Complex64) -> Complex64 {
    let size = b.l1_norm();
    if size.is_normal() {
        (a / size) / (b / size)
    } else {
        // a denormal magnitude has few digits, and its reciprocal overflows; multiplication by
        // 2^1000 preserves all digits
        const UP: f64 = 1.071_508_607_186_267_3e301;
        let size = (b * UP).l1_norm();
        (a * UP / size) / (b * UP / size)
    }
}

/// Returns x ln y for an x that tends to 0 faster than ln y diverges: 0 also if x has underflowed to
/// 0.
pub(crate) fn times_ln(x: Complex64, y: Complex64) -> Complex64 {
    if x == Complex64::ZERO { x } else { x * y.ln() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_cancel() {
        let (a, b) = (Complex64::new(3.0, -2.0), Complex64::new(0.5, 4.0));
        for exponent in [-1000, -540, -510, 0, 510, 540, 1000] {
            // a power of two, so that the scaling does not round
            let scale = 2f64.powi(exponent);
            let found = quotient(a * scale, b * scale);
            assert!(((found - a / b) / (a / b)).norm() < 1e-15, "2^{exponent}");
        }
        let denormal = Complex64::new(0.0, 8.0 * 5e-324);
        assert!((quotient(denormal, denormal) - 1.0).norm() < 1e-15);
        assert!(!quotient(a, Complex64::ZERO).is_finite());
    }
}
