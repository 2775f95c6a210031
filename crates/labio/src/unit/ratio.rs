//! Scales as fractions, so that `9 mm` becomes the double nearest to 0.009 and not nine times the
//! rounded value of 0.001.

/// A positive factor, numerator divided by denominator. Definitions of units are fractions of
/// integers below 2⁵³, which are exact in `f64`; only angles are rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ratio {
    numerator: f64,
    denominator: f64,
}

/// Limit below which every integer is exact as `f64`, and so is every product of integers.
pub(crate) const EXACT_INTEGERS: f64 = 9_007_199_254_740_992.0;

impl Ratio {
    pub(super) const ONE: Self = Self::of(1.0, 1.0);

    pub(super) const fn of(numerator: f64, denominator: f64) -> Self {
        Self {
            numerator,
            denominator,
        }
    }

    /// Multiplies two ratios; common factors are removed first, so that they cost no digits.
    pub(super) fn times(self, other: Self) -> Self {
        let (a, d) = reduced(self.numerator, other.denominator);
        let (c, b) = reduced(other.numerator, self.denominator);
        let (numerator, denominator) = reduced(a * c, b * d);
        Self::of(numerator, denominator)
    }

    pub(super) fn inverse(self) -> Self {
        Self::of(self.denominator, self.numerator)
    }

    pub(super) fn power(self, exponent: i8) -> Self {
        let base = if exponent < 0 { self.inverse() } else { self };
        (0..exponent.unsigned_abs()).fold(Self::ONE, |product, _| product.times(base))
    }

    pub(super) fn value(self) -> f64 {
        self.numerator / self.denominator
    }

    /// Returns true if the factor is finite and above zero, which is not guaranteed for long
    /// products.
    pub(super) fn is_usable(self) -> bool {
        self.value().is_finite() && self.value() > 0.0
    }

    pub(super) fn scale(self, value: f64) -> f64 {
        value * self.numerator / self.denominator
    }
}

/// Removes common divisors, if both parts are integers that are exact as `f64`.
fn reduced(numerator: f64, denominator: f64) -> (f64, f64) {
    let is_integer = |x: f64| x < EXACT_INTEGERS && x.fract() == 0.0;
    if !(is_integer(numerator) && is_integer(denominator)) {
        return (numerator, denominator);
    }
    // Euclid on doubles: remainders of integers are exact
    let (mut a, mut b) = (numerator, denominator);
    while b > 0.0 {
        (a, b) = (b, a % b);
    }
    (numerator / a, denominator / a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_factors_cancel() {
        let milli = Ratio::of(1.0, 1000.0);
        assert_eq!(milli.times(milli.inverse()), Ratio::ONE);
        assert_eq!(milli.power(-2), Ratio::of(1e6, 1.0));
        assert_eq!(
            Ratio::of(254.0, 10_000.0).times(Ratio::of(10.0, 127.0)),
            Ratio::of(1.0, 500.0)
        );
    }
}
