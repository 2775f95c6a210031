//! Parallel pair of a spring and a power-law dashpot under a stress, with derivatives with respect
//! to the parameters of the pair.
//!
//! With the stress v = E₂ε_d of the spring and the stress s = σ - v of the dashpot,
//!
//! ```text
//! dv/dt = k |s/σ_r|^m s ,    k = E₂ B σ_r^m
//! ```
//!
//! Therefore v depends only on the two parameters k \[1/s\] and m; E₂ and B do not enter
//! separately. At constant σ
//! ```text
//! s(t) = s(0) e^(-L) ,    L = ln(1 + m λ t)/m ,    λ = k |s(0)/σ_r|^m
//! ```

use super::integrator::{Interval, Unknowns, integrate};

/// Error of the integrated stress relative to the largest stress of the load.
const INTEGRATION_ERROR: f64 = 1e-9;

/// Spring and dashpot in parallel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dashpot {
    /// Rate k = E₂ B σ_r^m \[1/s\].
    pub(super) rate: f64,
    /// Exponent m.
    pub(super) exponent: f64,
    /// Reference stress σ_r \[Pa\].
    pub(super) reference_stress: f64,
}

/// Stress of the spring and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct SpringStress {
    /// Stress v \[Pa\].
    pub(super) value: f64,
    /// Derivative ∂v/∂ln k \[Pa\].
    pub(super) by_log_rate: f64,
    /// Derivative ∂v/∂m \[Pa\].
    pub(super) by_exponent: f64,
}

/// Returns L, ∂L/∂ln λ and ∂L/∂m at constant λ, for z = λt.
pub(super) fn relaxed_logarithm(z: f64, m: f64) -> (f64, f64, f64) {
    let a = m * z;
    let logarithm = if a == 0.0 { z } else { a.ln_1p() / m };
    let by_log_rate = z / (1.0 + a);
    // (a/(1+a) - ln(1+a))/a² loses its digits for small a
    let by_exponent = if a < 1e-2 {
        let mut sum = 0.0;
        for (numerator, denominator) in [
            (8.0, 9.0),
            (-7.0, 8.0),
            (6.0, 7.0),
            (-5.0, 6.0),
            (4.0, 5.0),
            (-3.0, 4.0),
            (2.0, 3.0),
            (-1.0, 2.0),
        ] {
            sum = sum * a + numerator / denominator;
        }
        z * z * sum
    } else {
        (by_log_rate - logarithm) / m
    };
    (logarithm, by_log_rate, by_exponent)
}

impl Dashpot {
    /// Returns λ = k |s/σ_r|^m and ln |s/σ_r|. The logarithm is set to 0 at s = 0, where it is
    /// always multiplied by 0.
    pub(super) fn local_rate(&self, dashpot_stress: f64) -> (f64, f64) {
        let ratio = dashpot_stress.abs() / self.reference_stress;
        let logarithm = if ratio > 0.0 { ratio.ln() } else { 0.0 };
        (self.rate * ratio.powf(self.exponent), logarithm)
    }

    /// Returns the stress after `duration` \[s\] under the constant `stress` \[Pa\], in closed
    /// form.
    pub(super) fn hold(&self, from: SpringStress, stress: f64, duration: f64) -> SpringStress {
        let s = stress - from.value;
        let (rate, logarithm) = self.local_rate(s);
        let (l, by_log_rate, by_exponent) = relaxed_logarithm(rate * duration, self.exponent);
        let left = (-l).exp();
        // ds₁ = e^(-L) (ds - s dL), dL = by_log_rate (d ln k + m ds/s + ln|s/σ_r| dm) + by_exponent
        // dm
        let own = 1.0 - self.exponent * by_log_rate;
        SpringStress {
            value: from.value - s * (-l).exp_m1(),
            by_log_rate: left * (from.by_log_rate * own + s * by_log_rate),
            by_exponent: left
                * (from.by_exponent * own + s * (by_log_rate * logarithm + by_exponent)),
        }
    }

    /// Returns the stress after `duration` \[s\] under a `stress` \[Pa\] that is a function of time
    /// \[s\], integrated with steps of at most `longest_step`. If the integration fails, the error
    /// is the time at which it failed. `largest` is the largest stress \[Pa\] of the whole load.
    pub(super) fn drive(
        &self,
        from: SpringStress,
        stress: impl Fn(f64) -> f64,
        duration: f64,
        longest_step: f64,
        largest: f64,
    ) -> Result<SpringStress, f64> {
        let interval = Interval {
            duration,
            longest_step,
            tolerance: INTEGRATION_ERROR,
        };
        // the integration is in units of the largest stress
        let start = [from.value, from.by_log_rate, from.by_exponent].map(|value| value / largest);
        let [value, by_log_rate, by_exponent] = integrate(start, &interval, |t, y: &Unknowns| {
            let s = stress(t) / largest - y[0];
            let (rate, logarithm) = self.local_rate(s * largest);
            let own = (self.exponent + 1.0) * rate;
            [
                rate * s,
                rate * s - own * y[1],
                rate * s * logarithm - own * y[2],
            ]
        })?
        .map(|value| value * largest);
        Ok(SpringStress {
            value,
            by_log_rate,
            by_exponent,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dashpot(exponent: f64) -> Dashpot {
        Dashpot {
            rate: 2e-3,
            exponent,
            reference_stress: 30e6,
        }
    }

    /// The closed form and the integration must agree within the stated error of the integration,
    /// for any exponent and any initial state.
    #[test]
    fn closed_form_agrees_with_the_differential_equation() {
        for exponent in [0.0, 1e-6, 0.3, 1.0, 1.8, 5.0] {
            let pair = dashpot(exponent);
            let before = SpringStress {
                value: 7e6,
                by_log_rate: 3e6,
                by_exponent: -2e6,
            };
            for (stress, duration) in [(45e6, 900.0), (-20e6, 60.0), (0.0, 5000.0)] {
                let held = pair.hold(before, stress, duration);
                let driven = pair
                    .drive(before, |_| stress, duration, duration, 45e6)
                    .unwrap();
                for (a, b) in [
                    (held.value, driven.value),
                    (held.by_log_rate, driven.by_log_rate),
                    (held.by_exponent, driven.by_exponent),
                ] {
                    assert!((a - b).abs() < 1e-9 * 45e6, "{exponent} {stress}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_closed_form() {
        for exponent in [1e-3, 0.7, 1.8] {
            let pair = dashpot(exponent);
            let at = |pair: Dashpot| {
                let loaded = pair.hold(SpringStress::default(), 32e6, 1800.0);
                pair.hold(loaded, -5e6, 300.0)
            };
            let h = 1e-5;
            let by_log_rate = (at(Dashpot {
                rate: pair.rate * f64::exp(h),
                ..pair
            })
            .value
                - at(Dashpot {
                    rate: pair.rate * f64::exp(-h),
                    ..pair
                })
                .value)
                / (2.0 * h);
            let by_exponent = (at(Dashpot {
                exponent: exponent + h,
                ..pair
            })
            .value
                - at(Dashpot {
                    exponent: exponent - h,
                    ..pair
                })
                .value)
                / (2.0 * h);
            let found = at(pair);
            // tolerance: the central difference has errors of h² = 1e-10 times the third
            // derivative, and of 1e-16/h = 1e-11 due to rounding
            assert!((found.by_log_rate - by_log_rate).abs() < 1e-8 * 32e6);
            assert!((found.by_exponent - by_exponent).abs() < 1e-8 * 32e6);
        }
    }

    /// A Newtonian dashpot is linear: under σ₀ + σ₁ sin pt from rest, v = k∫σ e^(-k(t-τ)) dτ in
    /// closed form.
    #[test]
    fn a_linear_pair_follows_a_sine_as_its_exponential_does() {
        let pair = dashpot(0.0);
        let (mean, amplitude, p, k) = (32e6, 13e6, std::f64::consts::TAU * 4.0, pair.rate);
        let duration = 100.3;
        let found = pair
            .drive(
                SpringStress::default(),
                |t| mean + amplitude * (p * t).sin(),
                duration,
                1.0 / 32.0,
                45e6,
            )
            .unwrap();
        let decayed = (-k * duration).exp();
        let sine = (k * (p * duration).sin() - p * (p * duration).cos() + p * decayed)
            * (amplitude * k / (k * k + p * p));
        let exact = mean * (1.0 - decayed) + sine;
        assert!(
            (found.value - exact).abs() < 1e-9 * 45e6,
            "{} {exact}",
            found.value
        );
    }

    #[test]
    fn at_rest_nothing_moves() {
        let held = dashpot(1.8).hold(SpringStress::default(), 0.0, 1e6);
        assert_eq!(held, SpringStress::default());
    }
}
