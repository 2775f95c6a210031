//! Recovery after a load: equations 4 and 5 of paper C.

use num_complex::Complex64;

use super::dashpot::relaxed_logarithm;
use super::{LoadHistory, ThreeElement};
use crate::error::{CmodError, check_finite};

/// Recovery of the model without load, at the time t \[s\] after unloading.
///
/// The parallel spring retains its stress at unloading and drives the dashpot back:
///
/// ```text
/// |σ_d(t)|^(-m) = |σ_d(0)|^(-m) + m E₂ B t
/// Δtan δ(t) = Δtan δᵢ/(1 + t/t_r) ,   t_r = 1/(m E₂ B |σ_d(0)|^m) ,   Δtan δᵢ = E₁(m+1)/(E₂ ω m t_r)   (eqs. 4, 5)
/// ```
///
/// For a Newtonian dashpot, m = 0, t_r is infinite: the stress decays exponentially and the loss
/// factor does not change.
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use]
pub struct Recovery {
    model: ThreeElement,
    /// Stress of the dashpot right after unloading \[Pa\].
    initial_dashpot_stress: f64,
}

impl Recovery {
    pub(super) fn after(model: ThreeElement, load: &LoadHistory) -> Result<Self, CmodError> {
        let largest = load.largest_stress();
        let initial_dashpot_stress = if largest > 0.0 {
            -load.response(&model.dashpot(largest))?.value
        } else {
            0.0
        };
        let recovery = Self {
            model,
            initial_dashpot_stress,
        };
        // a load or a rate may overflow for finite parameters
        for (quantity, value) in [
            (
                "stress of the dashpot after the load [Pa]",
                initial_dashpot_stress,
            ),
            ("initial rate of recovery [1/s]", recovery.initial_rate()),
        ] {
            check_finite(quantity, value)?;
        }
        Ok(recovery)
    }

    /// Returns the stress of the dashpot right after unloading \[Pa\]; its sign is opposite to the
    /// sign of the load.
    #[must_use]
    pub fn initial_dashpot_stress(&self) -> f64 {
        self.initial_dashpot_stress
    }

    /// Returns t_r \[s\], the time in which the change of the loss factor falls to one half (paper
    /// C, eq. 5, corrected); infinite for m = 0 or zero load.
    #[must_use]
    pub fn recovery_time(&self) -> f64 {
        1.0 / (self.model.parameters.exponent * self.initial_rate())
    }

    /// Returns Δtan δᵢ at angular frequency `omega` \[rad/s\], right after unloading (paper C, eq.
    /// 5).
    #[must_use]
    pub fn initial_loss_factor_change(&self, omega: f64) -> f64 {
        self.model
            .loss_factor_change(omega, self.initial_dashpot_stress)
    }

    /// Returns Δtan δ at angular frequency `omega` \[rad/s\] and time `t` \[s\] after unloading
    /// (paper C, eq. 4).
    #[must_use]
    pub fn loss_factor_change(&self, omega: f64, t: f64) -> f64 {
        self.initial_loss_factor_change(omega)
            / (1.0 + self.model.parameters.exponent * self.initial_rate() * t)
    }

    /// Returns the stress of the dashpot \[Pa\] at time `t` \[s\] after unloading.
    #[must_use]
    pub fn dashpot_stress(&self, t: f64) -> f64 {
        let (logarithm, ..) =
            relaxed_logarithm(self.initial_rate() * t, self.model.parameters.exponent);
        self.initial_dashpot_stress * (-logarithm).exp()
    }

    /// Returns the differential modulus \[Pa\] at angular frequency `omega` \[rad/s\] and time `t`
    /// \[s\] after unloading. The equation is exact; the loss of the virgin material is not
    /// included.
    #[must_use]
    pub fn complex_modulus(&self, omega: f64, t: f64) -> Complex64 {
        self.model.complex_modulus(omega, self.dashpot_stress(t))
    }

    /// Returns |E*|/E₁ - 1 at angular frequency `omega` \[rad/s\] and time `t` \[s\] after
    /// unloading.
    #[must_use]
    pub fn modulus_change(&self, omega: f64, t: f64) -> f64 {
        self.model.modulus_change(omega, self.dashpot_stress(t))
    }

    /// Returns E₂ B |σ_d(0)|^m \[1/s\].
    fn initial_rate(&self) -> f64 {
        self.model.dashpot(self.initial_dashpot_stress.abs()).rate
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::PRINTED;
    use super::super::{LoadSegment, ThreeElementParameters};
    use super::*;

    const OMEGA: f64 = std::f64::consts::TAU * 10e3;

    fn after(model: &ThreeElement, load: Result<LoadHistory, CmodError>) -> Recovery {
        model.recovery(&load.unwrap()).unwrap()
    }

    /// Compares equation 4 with the integrated model: if 600 s of rest are counted as part of the
    /// load, the recovery starts 600 s later.
    #[test]
    fn recovery_continues_a_rest_after_the_load() {
        let model = ThreeElement::new(PRINTED).unwrap();
        let creep = LoadSegment::Constant {
            stress: 45e6,
            duration: 1800.0,
        };
        let now = after(&model, LoadHistory::new(vec![creep]));
        let rest = LoadSegment::Ramp {
            from: 0.0,
            to: 0.0,
            duration: 600.0,
        };
        let later = after(&model, LoadHistory::new(vec![creep, rest]));
        for t in [0.0, 60.0, 7200.0] {
            let (a, b) = (now.dashpot_stress(600.0 + t), later.dashpot_stress(t));
            // the integration error is 1e-9 of 45 MPa, and the stress is a third of 45 MPa
            assert!((a / b - 1.0).abs() < 3e-9, "{t}: {a} {b}");
            let (a, b) = (
                now.loss_factor_change(OMEGA, 600.0 + t),
                model.loss_factor_change(OMEGA, b),
            );
            // the error above, multiplied by m
            assert!((a / b - 1.0).abs() < 6e-9, "{t}: {a} {b}");
        }
    }

    #[test]
    fn a_newtonian_dashpot_recovers_without_change_of_loss() {
        let model = ThreeElement::new(ThreeElementParameters {
            exponent: 0.0,
            coefficient: 1e-7,
            ..PRINTED
        })
        .unwrap();
        let recovery = after(&model, LoadHistory::creep(10e6, 100.0));
        let k: f64 = 13100.0 * 1e-7;
        let initial = -10e6 * (1.0 - (-100.0 * k).exp());
        assert!((recovery.initial_dashpot_stress() / initial - 1.0).abs() < 1e-14);
        assert!(
            (recovery.dashpot_stress(50.0) / (initial * (-50.0 * k).exp()) - 1.0).abs() < 1e-14
        );
        assert_eq!(recovery.recovery_time().to_bits(), f64::INFINITY.to_bits());
        let ratio =
            recovery.loss_factor_change(OMEGA, 1e5) / recovery.initial_loss_factor_change(OMEGA);
        assert!((ratio - 1.0).abs() < 1e-15);
    }

    #[test]
    fn without_load_nothing_recovers() {
        let model = ThreeElement::new(PRINTED).unwrap();
        let recovery = after(&model, LoadHistory::creep(0.0, 1800.0));
        assert!(recovery.loss_factor_change(OMEGA, 60.0).abs() < 1e-300);
        assert!(recovery.dashpot_stress(60.0).abs() < 1e-300);
    }
}
