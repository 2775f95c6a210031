//! Transition matrices divided by a power of e, so that they do not overflow at any damping.

use num_complex::Complex64;

use crate::quotient::quotient;

/// Matrix `e^{exponent} [p11 p12; p21 p22]` that gives (N, v) on the far side from (N, v) on the
/// near side.
///
/// The determinant, including the factor, is 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScaledTransition {
    pub(crate) p11: Complex64,
    pub(crate) p12: Complex64,
    pub(crate) p21: Complex64,
    pub(crate) p22: Complex64,
    pub(crate) exponent: f64,
}

/// e^{-|a|} cosh x and e^{-|a|} sinh x, a = Re x, to full relative accuracy for small and for large
/// x.
#[derive(Debug, Clone, Copy)]
struct ScaledHyperbolic {
    cosh: Complex64,
    sinh: Complex64,
    exponent: f64,
}

impl ScaledHyperbolic {
    #[inline]
    fn of(x: Complex64) -> Self {
        let (sin, cos) = x.im.sin_cos();
        let exponent = x.re.abs();
        let (even, odd) = if exponent == 0.0 {
            (1.0, 0.0)
        } else {
            let loss = (-2.0 * exponent).exp_m1();
            (1.0 + 0.5 * loss, (-0.5 * loss).copysign(x.re))
        };
        Self {
            cosh: Complex64::new(even * cos, odd * sin),
            sinh: Complex64::new(odd * cos, even * sin),
            exponent,
        }
    }

    /// Returns e^{-|a|} sinh x/x.
    #[inline]
    fn sinh_over(&self, x: Complex64) -> Complex64 {
        if x == Complex64::ZERO {
            Complex64::ONE
        } else {
            quotient(self.sinh, x)
        }
    }
}

/// 2n/(2n + 1)! for n = 1..=9, the coefficients of W in powers of x².
const CONE_SERIES: [f64; 9] = [
    1.0 / 3.0,
    1.0 / 30.0,
    1.0 / 840.0,
    1.0 / 45_360.0,
    1.0 / 3_991_680.0,
    1.0 / 518_918_400.0,
    1.0 / 93_405_312_000.0,
    1.0 / 22_230_464_256_000.0,
    1.0 / 6_758_061_133_824_000.0,
];

/// Computes W = (cosh x - sinh x/x)/x², divided by e^{exponent} like its arguments.
///
/// The difference loses accuracy by a factor 3/|x|². Below |x| = 1 the series is used, with a
/// remainder below 2e-18.
fn cone_function(hyperbolic: &ScaledHyperbolic, x_squared: Complex64, s: Complex64) -> Complex64 {
    if x_squared.norm_sqr() < 1.0 {
        let sum = CONE_SERIES
            .iter()
            .rev()
            .fold(Complex64::ZERO, |sum, coefficient| {
                sum * x_squared + coefficient
            });
        sum * (-hyperbolic.exponent).exp()
    } else {
        (hyperbolic.cosh - s) / x_squared
    }
}

impl ScaledTransition {
    pub(crate) const IDENTITY: Self = Self {
        p11: Complex64::ONE,
        p12: Complex64::ZERO,
        p21: Complex64::ZERO,
        p22: Complex64::ONE,
        exponent: 0.0,
    };

    /// Matrix of a uniform rod from x = γL and `inertia` sM.
    #[inline]
    pub(crate) fn rod(x: Complex64, inertia: Complex64) -> Self {
        let hyperbolic = ScaledHyperbolic::of(x);
        let s = hyperbolic.sinh_over(x);
        Self {
            p11: hyperbolic.cosh,
            p12: inertia * s,
            p21: quotient(hyperbolic.sinh * x, inertia),
            p22: hyperbolic.cosh,
            exponent: hyperbolic.exponent,
        }
    }

    /// Matrix of a cone from x = γL, `inertia` sM (M with the geometric mean of the areas) and r =
    /// `radius_ratio`.
    pub(crate) fn cone(x: Complex64, inertia: Complex64, radius_ratio: f64) -> Self {
        let hyperbolic = ScaledHyperbolic::of(x);
        let x_squared = x * x;
        let s = hyperbolic.sinh_over(x);
        let w = cone_function(&hyperbolic, x_squared, s);
        let bend = x_squared * w;
        let taper = (radius_ratio - 1.0) * (radius_ratio - 1.0) / radius_ratio;
        Self {
            p11: s + radius_ratio * bend,
            p12: inertia * (s + taper * w),
            p21: quotient(hyperbolic.sinh * x, inertia),
            p22: s + bend / radius_ratio,
            exponent: hyperbolic.exponent,
        }
    }

    /// Matrix of a horn from x = γL, `inertia` sM (M as for the cone), r = `radius_ratio` and μ =
    /// `log_ratio` = ln r.
    pub(crate) fn horn(
        x: Complex64,
        inertia: Complex64,
        radius_ratio: f64,
        log_ratio: f64,
    ) -> Self {
        let steepness = log_ratio.abs();
        let x_squared = x * x;
        // principal root: Re X >= 0
        let root = (x_squared + steepness * steepness).sqrt();
        let hyperbolic = ScaledHyperbolic::of(root);
        let t = hyperbolic.sinh_over(root);
        let decaying = Complex64::from_polar((-2.0 * hyperbolic.exponent).exp(), -root.im);
        let x_squared_t = x_squared * t;
        // the entry of the wide end is cosh X - |μ|T, that of the narrow end cosh X + |μ|T
        let wide = decaying + x_squared_t / (root + steepness);
        let thin = hyperbolic.cosh + steepness * t;
        let (p11, p22) = if log_ratio >= 0.0 {
            (wide, thin)
        } else {
            (thin, wide)
        };
        Self {
            p11: p11 * radius_ratio,
            p12: inertia * t,
            p21: quotient(x_squared_t, inertia),
            p22: p22 / radius_ratio,
            exponent: hyperbolic.exponent,
        }
    }

    /// Returns the same element with its ends exchanged.
    pub(crate) fn turned(self) -> Self {
        Self {
            p11: self.p22,
            p22: self.p11,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with the functions of `Complex64` where these neither cancel nor overflow.
    #[test]
    fn scaled_functions_are_the_hyperbolic_ones() {
        for (re, im) in [
            (0.0, 0.3),
            (1e-9, 2e-9),
            (0.7, -2.0),
            (-3.0, 40.0),
            (20.0, 1.0),
        ] {
            let x = Complex64::new(re, im);
            let scaled = ScaledHyperbolic::of(x);
            let growth = scaled.exponent.exp();
            // tolerance: a few roundings of factors of order 1
            assert!((scaled.cosh * growth - x.cosh()).norm() < 1e-15 * 4.0 * x.cosh().norm());
            assert!((scaled.sinh * growth - x.sinh()).norm() < 1e-15 * 4.0 * x.sinh().norm());
        }
    }

    /// Compares the series and the difference at the limit |x| = 1 between them.
    #[test]
    fn cone_function_is_continuous_where_its_forms_meet() {
        for angle in [0.0, 0.6, 1.2, std::f64::consts::FRAC_PI_2] {
            let value = |radius: f64| {
                let x = Complex64::from_polar(radius, angle);
                let hyperbolic = ScaledHyperbolic::of(x);
                let s = hyperbolic.sinh_over(x);
                cone_function(&hyperbolic, x * x, s) * hyperbolic.exponent.exp()
            };
            let (below, above) = (value(1.0 - 1e-15), value(1.0 + 1e-15));
            // tolerance: the slope of W, 1/15, times 2e-15, and roundings that the difference
            // magnifies 3 to 5 times
            assert!((below - above).norm() < 4e-15, "{below} {above}");
        }
    }
}
