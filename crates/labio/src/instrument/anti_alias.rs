//! Analogue low-pass filters, described by their exact frequency response.

use num_complex::Complex64;

use crate::LabioError;
use crate::error::{check_positive, non_physical};

/// Highest order accepted, higher than that of any real filter.
const HIGHEST_ORDER: u32 = 20;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Butterworth,
    Bessel,
}

/// An analogue low-pass filter of order $`n`$, specified by the frequency $`f_c`$ of 3 dB
/// attenuation (half the power).
///
/// - Butterworth: $`|H|^2 = 1/(1+(f/f_c)^{2n})`$, poles at $`e^{i\pi(2k+n-1)/2n}`$, $`k = 1 \ldots
///   n`$.
/// - Bessel: $`H = \theta_n(0)/\theta_n(i\Omega f/f_c)`$ with the reverse Bessel polynomial
///   $`\theta_n(s) = \sum_k \frac{(2n-k)!}{2^{n-k}\,k!\,(n-k)!}\,s^k`$ and $`\Omega`$ such that
///   $`|H(f_c)|^2 = 1/2`$.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AntiAlias {
    kind: Kind,
    order: u32,
    cutoff_hz: f64,
    /// Ω of a Bessel filter.
    scale: f64,
}

impl AntiAlias {
    /// Creates a Butterworth filter: flattest in magnitude.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the order is not 1 to 20 or the frequency not positive.
    pub fn butterworth(order: u32, cutoff_hz: f64) -> Result<Self, LabioError> {
        Self::new(Kind::Butterworth, order, cutoff_hz)
    }

    /// Creates a Bessel filter: flattest in group delay, so that pulses keep their shape.
    ///
    /// # Errors
    ///
    /// The errors of [`AntiAlias::butterworth`].
    pub fn bessel(order: u32, cutoff_hz: f64) -> Result<Self, LabioError> {
        Self::new(Kind::Bessel, order, cutoff_hz)
    }

    fn new(kind: Kind, order: u32, cutoff_hz: f64) -> Result<Self, LabioError> {
        check_positive("cut-off frequency [Hz]", cutoff_hz)?;
        if !(1..=HIGHEST_ORDER).contains(&order) {
            return non_physical(
                "order of the anti-alias filter",
                order.into(),
                "a number from 1 to 20",
            );
        }
        let scale = match kind {
            Kind::Butterworth => 1.0,
            Kind::Bessel => half_power(order),
        };
        Ok(Self {
            kind,
            order,
            cutoff_hz,
            scale,
        })
    }

    /// Returns $`H`$ at a frequency \[Hz\].
    #[must_use]
    pub fn response(&self, frequency_hz: f64) -> Complex64 {
        let s = Complex64::new(0.0, self.scale * frequency_hz / self.cutoff_hz);
        match self.kind {
            Kind::Butterworth => butterworth(self.order, s),
            Kind::Bessel => bessel(self.order, s),
        }
    }

    pub(super) fn name(&self) -> String {
        let kind = match self.kind {
            Kind::Butterworth => "Butterworth",
            Kind::Bessel => "Bessel",
        };
        format!(
            "{kind} low-pass of order {} at {} Hz",
            self.order, self.cutoff_hz
        )
    }
}

/// Returns the product of 1/(1 - s/p) over the poles p, which are all on the unit circle.
fn butterworth(order: u32, s: Complex64) -> Complex64 {
    (1..=order).fold(Complex64::ONE, |response, k| {
        let angle = std::f64::consts::PI * f64::from(2 * k + order - 1) / f64::from(2 * order);
        response / (1.0 - s * Complex64::cis(-angle))
    })
}

/// Returns θₙ(0)/θₙ(s) by the recursion θₙ = (2n-1) θₙ₋₁ + s² θₙ₋₂, with both sides divided by
/// their value at 0.
fn bessel(order: u32, s: Complex64) -> Complex64 {
    // with φₙ = θₙ/θₙ(0) and θₙ(0) = (2n-1) θₙ₋₁(0): φₙ = φₙ₋₁ + s² φₙ₋₂ / ((2n-1)(2n-3))
    let (mut before, mut phi) = (Complex64::ONE, Complex64::ONE + s);
    for n in 2..=order {
        let n = f64::from(n);
        let next = phi + s * s * before / ((2.0 * n - 1.0) * (2.0 * n - 3.0));
        (before, phi) = (phi, next);
    }
    if !s.is_nan() && !phi.is_finite() {
        return Complex64::ZERO; // so far above the cut-off that the polynomial overflows
    }
    phi.inv()
}

/// Returns the angular frequency at which the Bessel filter of unit delay has lost half the power.
fn half_power(order: u32) -> f64 {
    // |H| decreases monotonically; √(ln 2 (2n-1)) is the limit for high orders, and 1 the value for
    // order 1
    let (mut below, mut above) = (0.5, 10.0);
    while above - below > f64::EPSILON * above {
        let middle = 0.5 * (below + above);
        if middle <= below || middle >= above {
            break;
        }
        if bessel(order, Complex64::new(0.0, middle)).norm_sqr() > 0.5 {
            below = middle;
        } else {
            above = middle;
        }
    }
    0.5 * (below + above)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A claim compares the responses up to order 12 with SciPy's.
    #[test]
    fn butterworth_has_its_magnitude_at_every_order() {
        for order in 1..=HIGHEST_ORDER {
            let filter = AntiAlias::butterworth(order, 1000.0).unwrap();
            for f in [0.0, 100.0, 999.0, 1000.0, 3000.0] {
                let power = 1.0 / (1.0 + f64::powi(f / 1000.0, 2 * order as i32));
                // rounding errors of a product of 20 factors, and of the square of its magnitude
                let error = (filter.response(f).norm_sqr() / power - 1.0).abs();
                assert!(error < 1e-13, "order {order} at {f}: {error}");
            }
        }
    }

    #[test]
    fn impossible_filters_are_refused() {
        assert!(AntiAlias::butterworth(0, 10.0).is_err());
        assert!(AntiAlias::bessel(21, 10.0).is_err());
        assert!(AntiAlias::bessel(4, -10.0).is_err());
    }
}
