//! Function of γ with its first two derivatives.

use std::ops::{Add, Mul};

use num_complex::Complex64;

/// f, f' and f'' at one γ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Jet {
    pub(crate) value: Complex64,
    pub(crate) first: Complex64,
    pub(crate) second: Complex64,
}

impl Jet {
    pub(crate) fn constant(value: Complex64) -> Self {
        Self {
            value,
            first: Complex64::ZERO,
            second: Complex64::ZERO,
        }
    }

    /// a + bγ.
    pub(crate) fn linear(a: f64, b: f64, gamma: Complex64) -> Self {
        Self {
            value: a + b * gamma,
            first: b.into(),
            second: Complex64::ZERO,
        }
    }

    /// cosh γd.
    pub(crate) fn cosh(distance: f64, gamma: Complex64) -> Self {
        let (cosh, sinh) = ((gamma * distance).cosh(), (gamma * distance).sinh());
        Self {
            value: cosh,
            first: distance * sinh,
            second: distance * distance * cosh,
        }
    }

    /// sinh γd.
    pub(crate) fn sinh(distance: f64, gamma: Complex64) -> Self {
        let (cosh, sinh) = ((gamma * distance).cosh(), (gamma * distance).sinh());
        Self {
            value: sinh,
            first: distance * cosh,
            second: distance * distance * sinh,
        }
    }

    /// e^{-γd}.
    pub(crate) fn decay(distance: f64, gamma: Complex64) -> Self {
        let value = (-gamma * distance).exp();
        Self {
            value,
            first: -distance * value,
            second: distance * distance * value,
        }
    }

    /// Returns the quotient: from g f₂ = f₁ and its derivatives.
    pub(crate) fn over(&self, other: &Self) -> Self {
        let value = self.value / other.value;
        let first = (self.first - value * other.first) / other.value;
        let second = (self.second - 2.0 * first * other.first - value * other.second) / other.value;
        Self {
            value,
            first,
            second,
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares all rules at once with central differences of the values.
    #[test]
    fn derivatives_are_those_of_the_value() {
        let f = |gamma: Complex64| {
            let upper = Jet::sinh(0.3, gamma) * Jet::linear(0.2, -1.1, gamma)
                + Jet::cosh(0.5, gamma) * Jet::constant(Complex64::new(0.1, 2.0));
            let lower = Jet::decay(0.7, gamma) + Jet::linear(1.0, 0.4, gamma);
            upper.over(&lower)
        };
        let gamma = Complex64::new(0.4, 3.0);
        let jet = f(gamma);
        let h = 1e-5;
        let (plus, minus) = (f(gamma + h), f(gamma - h));
        // Truncation: h²/6 of a third derivative of less than 100; rounding 1e-15/h.
        assert!(((plus.value - minus.value) / (2.0 * h) - jet.first).norm() < 3e-9);
        assert!(((plus.first - minus.first) / (2.0 * h) - jet.second).norm() < 3e-9);
    }
}
