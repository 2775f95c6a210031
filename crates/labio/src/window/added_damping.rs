//! Damping added by an exponential window, and its removal.

use num_complex::Complex64;

use crate::LabioError;
use crate::error::{check_positive, non_physical};

/// The exponential window $`e^{-\sigma t}`$ on *all* channels of a hit, for bodies that ring longer
/// than the record.
///
/// The Fourier transform of $`e^{-\sigma t}x(t)`$ is the Laplace transform of x on the line
/// $`s = \sigma + i\omega`$. With the same window on input and output, the ratio of their spectra
/// is exactly the transfer function on that line, $`H(\sigma + i\omega)`$. A window on the response
/// only does not give a transfer function.
///
/// # Exact removal
///
/// - from a pole, which is displaced by $`-\sigma`$, equally for every mode
///   ([`AddedDamping::remove_from_pole`]);
/// - from an impulse response, which is multiplied by $`e^{-\sigma t}`$
///   ([`ImpulseResponse::without_added_damping`](crate::ImpulseResponse::without_added_damping));
/// - from a conversion between motions: the factor is $`s = \sigma + i\omega`$, as in
///   [`FrequencyResponse::to_kind`](crate::FrequencyResponse::to_kind).
///
/// # Limits
///
/// One line of $`H(\sigma+i\omega)`$ does not determine $`H(i\omega)`$: that requires the whole
/// impulse response, with noise amplified by $`e^{\sigma T}`$ at its end, and ringing beyond the
/// record is lost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AddedDamping {
    decay_rate: f64,
}

/// Natural frequency and damping of a mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampedMode {
    /// Undamped natural frequency, the modulus of the pole \[rad/s\].
    pub natural_omega: f64,
    /// Damping ratio, the fraction of critical damping \[-\]; negative for a mode that grows.
    pub damping_ratio: f64,
}

impl AddedDamping {
    /// Creates the window with the decay rate `decay_rate` \[1/s\].
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the decay rate is not finite and above zero.
    pub fn new(decay_rate: f64) -> Result<Self, LabioError> {
        check_positive("decay rate of the exponential window [1/s]", decay_rate)?;
        Ok(Self { decay_rate })
    }

    /// Creates the window that falls to `end_weight` after the `duration` T \[s\], $`\sigma =
    /// -\ln(\mathrm{end\ weight})/T`$.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the weight is not between 0 and 1, or the duration is not
    /// above 0.
    pub fn to_end_weight(end_weight: f64, duration: f64) -> Result<Self, LabioError> {
        if !(end_weight > 0.0 && end_weight < 1.0) {
            return non_physical(
                "end weight of the exponential window [-]",
                end_weight,
                "a weight between 0 and 1",
            );
        }
        check_positive("duration of the exponential window [s]", duration)?;
        Self::new(-end_weight.ln() / duration)
    }

    /// Decay rate $`\sigma`$ \[1/s\].
    #[must_use]
    pub fn decay_rate(&self) -> f64 {
        self.decay_rate
    }

    /// Computes the weights of `n_samples` samples at `sampling_rate_hz` \[Hz\]; the first weight
    /// is 1.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for the sampling rate.
    pub fn weights(&self, n_samples: usize, sampling_rate_hz: f64) -> Result<Vec<f64>, LabioError> {
        check_positive("sampling rate [Hz]", sampling_rate_hz)?;
        super::check_length(n_samples)?;
        Ok((0..n_samples)
            .map(|n| (-self.decay_rate * n as f64 / sampling_rate_hz).exp())
            .collect())
    }

    /// Returns the pole of the body from the pole found under the window: $`p = p' + \sigma`$.
    ///
    /// # Examples
    ///
    /// ```
    /// use labio::AddedDamping;
    /// use num_complex::Complex64;
    ///
    /// let window = AddedDamping::new(5.0)?;
    /// let pole = window.remove_from_pole(Complex64::new(-8.0, 600.0));
    /// assert!((pole - Complex64::new(-3.0, 600.0)).norm() < 1e-12);
    /// # Ok::<(), labio::LabioError>(())
    /// ```
    #[must_use]
    pub fn remove_from_pole(&self, apparent: Complex64) -> Complex64 {
        apparent + self.decay_rate
    }

    /// Returns the mode of the body from the natural frequency and damping ratio found under the
    /// window.
    ///
    /// The pole is $`-\zeta\omega_0 + i\omega_0\sqrt{1-\zeta^2}`$; its imaginary part, the damped
    /// frequency, is not changed by the window. The resulting damping ratio is negative if the
    /// window added more damping than was found.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the mode does not oscillate: the natural frequency is not
    /// positive, or the damping ratio is not between -1 and 1.
    pub fn remove_from_mode(&self, apparent: DampedMode) -> Result<DampedMode, LabioError> {
        let DampedMode {
            natural_omega,
            damping_ratio,
        } = apparent;
        check_positive("natural frequency [rad/s]", natural_omega)?;
        if !(damping_ratio > -1.0 && damping_ratio < 1.0) {
            return non_physical("damping ratio [-]", damping_ratio, "between -1 and 1");
        }
        let damped_omega = natural_omega * (1.0 - damping_ratio * damping_ratio).sqrt();
        let pole =
            self.remove_from_pole(Complex64::new(-damping_ratio * natural_omega, damped_omega));
        Ok(DampedMode {
            natural_omega: pole.norm(),
            damping_ratio: -pole.re / pole.norm(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_that_do_not_decay_are_refused() {
        assert!(AddedDamping::new(0.0).is_err() && AddedDamping::new(f64::NAN).is_err());
        assert!(AddedDamping::to_end_weight(1.0, 1.0).is_err());
        assert!(AddedDamping::to_end_weight(0.1, 0.0).is_err());
        assert!(AddedDamping::new(1.0).unwrap().weights(3, 0.0).is_err());
        let overdamped = DampedMode {
            natural_omega: 1.0,
            damping_ratio: 1.5,
        };
        let window = AddedDamping::new(1.0).unwrap();
        assert!(window.remove_from_mode(overdamped).is_err());
    }
}
