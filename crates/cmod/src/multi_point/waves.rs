//! Waves at a section, with their covariance.

use num_complex::Complex64;

use super::projection::TestWaves;
use crate::complex_frequency::ComplexFrequency;

/// Quantity measured by the gauges. All quantities obey the same equation (paper B, after eq. 7);
/// the choice only determines the conversion of waves from one quantity to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Quantity {
    /// Strain ε = ∂u/∂x, positive in tension.
    #[default]
    Strain,
    /// Displacement u \[m\], positive along +x.
    Displacement,
    /// Velocity v = ∂u/∂t [m/s].
    Velocity,
    /// Acceleration a = ∂²u/∂t² [m/s²].
    Acceleration,
}

impl Quantity {
    /// Returns the powers of ∂/∂x and ∂/∂t that convert u into the quantity.
    pub(crate) fn derivatives(self) -> (i32, i32) {
        match self {
            Self::Strain => (1, 0),
            Self::Displacement => (0, 0),
            Self::Velocity => (0, 1),
            Self::Acceleration => (0, 2),
        }
    }
}

/// Waves of a quantity at one section.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct WavesAtSection {
    /// Wave P e^{-γx} along +x.
    pub forward: Complex64,
    /// Wave N e^{γx} along -x.
    pub backward: Complex64,
    /// Variance E|δP|². The real and the imaginary part are uncorrelated and contribute half each.
    pub forward_variance: f64,
    /// Variance E|δN|².
    pub backward_variance: f64,
    /// Covariance E δP δN*.
    pub covariance: Complex64,
}

impl WavesAtSection {
    /// Returns P + N, which is the quantity at the section.
    #[must_use]
    pub fn sum(&self) -> Complex64 {
        self.forward + self.backward
    }

    /// Returns E|δ(P + N)|².
    #[must_use]
    pub fn sum_variance(&self) -> f64 {
        self.forward_variance + self.backward_variance + 2.0 * self.covariance.re
    }
}

/// Data of a line from which its waves are computed.
#[derive(Debug, Clone, Copy)]
pub(super) struct LineOfWaves {
    pub(super) frequency: ComplexFrequency,
    pub(super) gamma: Complex64,
    /// Variance E|δγ|² [1/m²].
    pub(super) gamma_variance: f64,
    /// Covariance of the waves, (A^H A)⁻¹ times the variance of a value: its two diagonal elements
    /// and its element (1, 2).
    pub(super) covariance: (f64, f64, Complex64),
}

/// Returns the waves `from_first` \[m\] beyond the first gauge and `to_last` \[m\] before the last
/// gauge, converted from the quantity `measured` to the quantity `wanted`.
///
/// With δc = A⁺e - A⁺A'c δγ and δγ uncorrelated with A⁺e, a wave P = c₁ e^{-γx} changes by δP =
/// e^{-γx} (A⁺e)₁ + (-e^{-γx}(A⁺A'c)₁ - xP + (dF/dγ) P/F) δγ, where F is the factor between the two
/// quantities.
pub(super) fn waves_at(
    line: &LineOfWaves,
    test: &TestWaves,
    from_first: f64,
    to_last: f64,
    measured: Quantity,
    wanted: Quantity,
) -> WavesAtSection {
    let (x_measured, t_measured) = measured.derivatives();
    let (x_wanted, t_wanted) = wanted.derivatives();
    let order = x_wanted - x_measured;
    let in_time = line.frequency.laplace().powi(t_wanted - t_measured);
    let wave = |(amplitude, drift): (Complex64, Complex64), way: f64, sign: f64| {
        let factor = in_time * (sign * line.gamma).powi(order) * (-line.gamma * way).exp();
        let by_gamma = -drift + amplitude * (f64::from(order) / line.gamma - way);
        (factor, factor * amplitude, factor * by_gamma)
    };
    let ([p, n], [p_drift, n_drift]) = (test.amplitudes, test.drift);
    let (forward_factor, forward, forward_slope) = wave((p, p_drift), from_first, -1.0);
    let (backward_factor, backward, backward_slope) = wave((n, n_drift), to_last, 1.0);
    let (first, second, shared) = line.covariance;
    let variance = line.gamma_variance;
    WavesAtSection {
        forward,
        backward,
        forward_variance: forward_factor.norm_sqr() * first + forward_slope.norm_sqr() * variance,
        backward_variance: backward_factor.norm_sqr() * second
            + backward_slope.norm_sqr() * variance,
        covariance: forward_factor * shared * backward_factor.conj()
            + forward_slope * backward_slope.conj() * variance,
    }
}
