//! Power laws for damping coefficient and wave number: the fit of paper E to measured waves in
//! Nylon-6.

use num_complex::Complex64;

use super::PropagationLaw;
use crate::RodwaveError;
use crate::error::{check_not_negative, check_positive};

/// Power laws α = a ω^p and k = b ω^q for ω > 0 (Ödeen 1993, paper E, eq. 7).
///
/// For ω < 0 γ is the complex conjugate, γ(-ω) = conj γ(ω): α is even and k is odd (paper E, below
/// eq. 5). At ω = 0, γ = 0, and the modulus -ρω²/γ² is the limit: 0 unless q = 1 and p >= 1.
///
/// # Validity
/// The fit is valid in its band: for Nylon-6 up to 10 kHz. Two independent power laws are not a
/// causal pair. The law can therefore not be continued to complex frequencies and is not a
/// [`LaplaceModulus`](crate::modulus::LaplaceModulus). For p < q there is a (very low) frequency
/// below which α > k, that is E' < 0. According to [`kramers_kronig`](crate::kramers_kronig) no
/// relaxing material has the power laws of Nylon-6 from 0.5 to 10 kHz; the nearest material differs
/// by 0.03 % of |E|, which is 0.4 % of its loss. [`ConstantQ`](crate::modulus::ConstantQ) is a
/// causal law with p = q.
///
/// ```
/// use rodwave::medium::Medium;
/// use rodwave::modulus::PowerLawPropagation;
///
/// let nylon = Medium::new(1150.0, PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?)?;
/// let modulus = nylon.modulus(2.0 * std::f64::consts::PI * 1000.0);
/// assert!((modulus.im / modulus.re - 0.102).abs() < 0.001);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLawPropagation {
    damping_factor: f64,
    damping_exponent: f64,
    wave_number_factor: f64,
    wave_number_exponent: f64,
}

impl PowerLawPropagation {
    /// Creates the law with `damping_factor` a [s^p/m], `damping_exponent` p, `wave_number_factor`
    /// b [s^q/m] and `wave_number_exponent` q, in the order of the printed equation.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless a >= 0, b > 0, p > 0 and 0 < q <= 1, all finite. With
    /// q > 1 the stiffness would decrease with the frequency.
    pub fn new(
        damping_factor: f64,
        damping_exponent: f64,
        wave_number_factor: f64,
        wave_number_exponent: f64,
    ) -> Result<Self, RodwaveError> {
        check_not_negative("factor of the damping coefficient [s^p/m]", damping_factor)?;
        if wave_number_exponent > 1.0 {
            return Err(RodwaveError::NonPhysical {
                quantity: "exponent of the wave number",
                value: wave_number_exponent,
                expected: "above 0 and at most 1",
            });
        }
        Ok(Self {
            damping_factor,
            damping_exponent: check_positive(
                "exponent of the damping coefficient",
                damping_exponent,
            )?,
            wave_number_factor: check_positive(
                "factor of the wave number [s^q/m]",
                wave_number_factor,
            )?,
            wave_number_exponent: check_positive(
                "exponent of the wave number",
                wave_number_exponent,
            )?,
        })
    }

    /// Returns α and ik [1/m].
    fn parts(&self, omega: f64) -> (Complex64, Complex64) {
        let magnitude = omega.abs();
        let alpha = self.damping_factor * magnitude.powf(self.damping_exponent);
        let k = self.wave_number_factor * magnitude.powf(self.wave_number_exponent);
        (
            Complex64::from(alpha),
            Complex64::new(0.0, k.copysign(omega)),
        )
    }

    /// Returns γ/(iω) [s/m] for `omega` >= 0, including its limit at 0, where it may be infinite.
    fn slowness(&self, omega: f64) -> Complex64 {
        let k = self.wave_number_factor * omega.powf(self.wave_number_exponent - 1.0);
        let alpha = if self.damping_factor > 0.0 {
            self.damping_factor * omega.powf(self.damping_exponent - 1.0)
        } else {
            0.0
        };
        Complex64::new(k, -alpha)
    }
}

impl PropagationLaw for PowerLawPropagation {
    fn propagation_coefficient(&self, omega: f64, _density: f64) -> Complex64 {
        let (alpha, ik) = self.parts(omega);
        alpha + ik
    }

    fn propagation_derivative(&self, omega: f64, _density: f64) -> Complex64 {
        let (alpha, ik) = self.parts(omega);
        (self.damping_exponent * alpha + self.wave_number_exponent * ik) / omega
    }

    fn modulus(&self, omega: f64, density: f64) -> Complex64 {
        let slowness = self.slowness(omega.abs());
        if slowness.re.is_infinite() || slowness.im.is_infinite() {
            return Complex64::ZERO;
        }
        let modulus = density / (slowness * slowness);
        if omega < 0.0 { modulus.conj() } else { modulus }
    }
}
