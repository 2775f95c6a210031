//! Function of one complex variable with its first two derivatives.

use std::ops::{Add, Div, Mul, Sub};

use num_complex::Complex64;

/// Values of f, f' and f'' at one point.
///
/// ```
/// use rodwave::num_complex::Complex64;
/// use rodwave::numerics::Jet;
///
/// // f = (1 + 2γ) cosh 3γ, f' = 2 cosh 3γ + 3 (1 + 2γ) sinh 3γ
/// let gamma = Complex64::new(0.1, 0.7);
/// let f = Jet::linear(1.0 + 2.0 * gamma, 2.0) * Jet::cosh(3.0, gamma);
/// let (cosh, sinh) = ((3.0 * gamma).cosh(), (3.0 * gamma).sinh());
/// assert!((f.first - (2.0 * cosh + 3.0 * (1.0 + 2.0 * gamma) * sinh)).norm() < 1e-14);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet {
    /// f
    pub value: Complex64,
    /// f'
    pub first: Complex64,
    /// f''
    pub second: Complex64,
}

impl Jet {
    /// Returns a constant.
    #[must_use]
    pub fn constant(value: Complex64) -> Self {
        Self::linear(value, 0.0)
    }

    /// Returns a linear function with the given value at the point and the given slope.
    #[must_use]
    pub fn linear(value: Complex64, slope: f64) -> Self {
        Self {
            value,
            first: slope.into(),
            second: Complex64::ZERO,
        }
    }

    /// cosh γd as a function of γ.
    #[must_use]
    pub fn cosh(distance: f64, gamma: Complex64) -> Self {
        let (cosh, sinh) = ((gamma * distance).cosh(), (gamma * distance).sinh());
        Self {
            value: cosh,
            first: distance * sinh,
            second: distance * distance * cosh,
        }
    }

    /// sinh γd as a function of γ.
    #[must_use]
    pub fn sinh(distance: f64, gamma: Complex64) -> Self {
        let (cosh, sinh) = ((gamma * distance).cosh(), (gamma * distance).sinh());
        Self {
            value: sinh,
            first: distance * cosh,
            second: distance * distance * sinh,
        }
    }

    /// e^{-γd} as a function of γ.
    #[must_use]
    pub fn decay(distance: f64, gamma: Complex64) -> Self {
        let value = (-gamma * distance).exp();
        Self {
            value,
            first: -distance * value,
            second: distance * distance * value,
        }
    }

    /// Returns the composition g(f), from g, g' and g'' at the value of f.
    #[must_use]
    pub fn compose(self, [value, first, second]: [Complex64; 3]) -> Self {
        Self {
            value,
            first: first * self.first,
            second: first * self.second + second * self.first * self.first,
        }
    }
}

impl Add for Jet {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }
}

impl Sub for Jet {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul for Jet {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            first: self.first * other.value + self.value * other.first,
            second: self.second * other.value
                + 2.0 * self.first * other.first
                + self.value * other.second,
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            value: factor * self.value,
            first: factor * self.first,
            second: factor * self.second,
        }
    }
}

impl Div for Jet {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let first = (self.first - value * other.first) / other.value;
        Self {
            value,
            first,
            second: (self.second - 2.0 * first * other.first - value * other.second) / other.value,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares all rules at once with central differences of the values.
    #[test]
    fn derivatives_are_those_of_the_value() {
        let f = |gamma: Complex64| {
            let upper = Jet::sinh(0.3, gamma) * Jet::linear(0.2 - 1.1 * gamma, -1.1)
                + Jet::cosh(0.5, gamma) * Jet::constant(Complex64::new(0.1, 2.0));
            let lower = Jet::decay(0.7, gamma) + Jet::linear(1.0 + 0.4 * gamma, 0.4);
            (upper - lower * 0.5) / lower
        };
        let gamma = Complex64::new(0.4, 3.0);
        let jet = f(gamma);
        let h = 1e-5;
        let (plus, minus) = (f(gamma + h), f(gamma - h));
        // Tolerance: truncation h²/6 times a third derivative of less than 100; rounding 1e-15/h.
        assert!(((plus.value - minus.value) / (2.0 * h) - jet.first).norm() < 3e-9);
        assert!(((plus.first - minus.first) / (2.0 * h) - jet.second).norm() < 3e-9);

        // the square, as a function of the jet and as a product
        let square = jet.compose([jet.value.powi(2), 2.0 * jet.value, 2.0.into()]);
        let product = jet * jet;
        assert!((square.value - product.value).norm() < 1e-12 * product.value.norm());
        assert!((square.first - product.first).norm() < 1e-12 * product.first.norm());
        assert!((square.second - product.second).norm() < 1e-12 * product.second.norm());
    }
}
