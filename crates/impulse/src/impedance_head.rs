//! Correction of a mobility measured with an impedance head for the mass of the head.
//!
//! Theory: `docs/theory/force-uncertainty.md#virtual-measurement-of-an-impulse-response`.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::ImpulseError;
use crate::error::{check_length, check_not_negative, check_positive};

/// Accelerometer and force gauge in one housing on the impact face (Ödeen 1993, paper E, section
/// 3.1).
///
/// The mass between the gauge and the body moves with the face and reduces the force on the body to
/// $`F = F_g - ma`$.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImpedanceHead {
    mass_below_gauge: f64,
}

/// A mobility of the face with its variance.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FaceMobility {
    /// Mobility \[m/(N s)\]; `(n_lines)`.
    pub mobility: Vec<Complex64>,
    /// $`\mathrm E\lvert\delta G\rvert^2`$ \[(m/(N s))²\]; `(n_lines)`.
    pub variance: Vec<f64>,
}

impl ImpedanceHead {
    /// Creates a head with the mass `mass_below_gauge` \[kg\] between the gauge and the body,
    /// including the screw.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a mass that is negative or not finite.
    pub fn new(mass_below_gauge: f64) -> Result<Self, ImpulseError> {
        check_not_negative("mass below the force gauge [kg]", mass_below_gauge)?;
        Ok(Self { mass_below_gauge })
    }

    /// Computes the mobility of the bare face from an `accelerance` $`A = \hat a/\hat F_g`$ [1/kg]
    /// at the gauge with its `variance` $`\mathrm E\lvert\delta A\rvert^2`$, on lines
    /// `frequency_step_hz` apart from 0 Hz,
    ///
    /// ```math
    /// G = \frac{1}{i\omega}\,\frac{A}{1 - mA}, \qquad \delta G = \frac{1}{i\omega}\,\frac{\delta A}{(1-mA)^2} .
    /// ```
    ///
    /// Line 0, where a free body has no mobility, is set to 0 and must not be used.
    ///
    /// # Validity
    ///
    /// The part below the gauge is rigid, and the accelerometer measures its motion. Where $`mA`$
    /// is near 1 the gauge signal vanishes, as the body and the mass resonate, and the variance
    /// is large. The error of the mass itself is not propagated: it changes G by $`i\omega
    /// G^2\delta m`$.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the step or a negative variance;
    /// [`ImpulseError::LengthMismatch`]; [`ImpulseError::NonFinite`] for a line above 0 Hz.
    pub fn face_mobility(
        self,
        accelerance: &[Complex64],
        variance: &[f64],
        frequency_step_hz: f64,
    ) -> Result<FaceMobility, ImpulseError> {
        check_positive("frequency step [Hz]", frequency_step_hz)?;
        check_length(
            "variance of the accelerance",
            variance.len(),
            accelerance.len(),
        )?;
        let mut face = FaceMobility {
            mobility: vec![Complex64::ZERO; accelerance.len()],
            variance: vec![0.0; accelerance.len()],
        };
        for &value in variance.iter().skip(1).filter(|value| value.is_finite()) {
            check_not_negative("variance of the accelerance [1/kg^2]", value)?;
        }
        let lines = accelerance.iter().zip(variance);
        let of_face = face.mobility.iter_mut().zip(&mut face.variance);
        for (index, ((measured, variance), of_face)) in lines.zip(of_face).enumerate().skip(1) {
            let omega = TAU * frequency_step_hz * index as f64;
            let without_head = 1.0 - self.mass_below_gauge * measured;
            let mobility = measured / without_head / Complex64::new(0.0, omega);
            let variance = variance / without_head.norm_sqr().powi(2) / (omega * omega);
            if !(mobility.is_finite() && variance.is_finite()) {
                return Err(ImpulseError::NonFinite {
                    what: "accelerance at the force gauge, or its variance,",
                    index,
                });
            }
            (*of_face.0, *of_face.1) = (mobility, variance);
        }
        Ok(face)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the variance with the slope by a finite difference; a claim compares the mobility.
    #[test]
    fn the_variance_is_that_of_the_slope() {
        let (head, step_hz, step) = (ImpedanceHead::new(0.005).unwrap(), 10.0, 1e-6);
        // a rigid body of 0.3 kg and 5 g of the head on a spring
        let loaded: Vec<Complex64> = (0..50)
            .map(|line| {
                let s = Complex64::new(0.0, TAU * step_hz * f64::from(line));
                s * s / (0.305 * s * s + 20.0 * s + 1e5)
            })
            .collect();
        let moved: Vec<Complex64> = loaded.iter().map(|a| a + step).collect();
        let [face, moved] =
            [&loaded, &moved].map(|lines| head.face_mobility(lines, &[1e-6; 50], step_hz).unwrap());
        for line in 1..50 {
            let slope = (moved.mobility[line] - face.mobility[line]).norm() / step;
            let expected = slope * slope * 1e-6;
            assert!(
                (face.variance[line] / expected - 1.0).abs() < 1e-4,
                "{line}"
            );
        }
    }

    #[test]
    fn a_head_without_mass_integrates_only_and_nonsense_is_refused() {
        assert!(ImpedanceHead::new(-1.0).is_err());
        let head = ImpedanceHead::new(0.0).unwrap();
        let lines = vec![Complex64::ONE; 4];
        let face = head.face_mobility(&lines, &[0.0; 4], 1.0).unwrap();
        assert!((face.mobility[2] * Complex64::new(0.0, 2.0 * TAU) - 1.0).norm() < 1e-15);
        assert!(head.face_mobility(&lines, &[0.0; 3], 1.0).is_err());
        let mut lines = lines;
        lines[2].re = f64::NAN;
        assert!(head.face_mobility(&lines, &[0.0; 4], 1.0).is_err());
    }
}
