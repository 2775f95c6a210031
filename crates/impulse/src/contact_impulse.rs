//! Impulse of the first contact, extrapolated to a force without a band limit.

use crate::{ContactEnd, ImpulseError, StickProblem, separate};

/// Time ahead of the contact, in periods of the last line, over which the band limit spreads the
/// force.
const AHEAD: f64 = 10.0;

/// Impulse of the first contact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ContactImpulse {
    /// The impulse without a band limit \[N s\]; that in the band if the extrapolation is unknown.
    pub impulse: f64,
    /// Standard error of the extrapolation \[N s\]; `None` if there are fewer than five lines, or
    /// the faces do not part in half of the band.
    pub by_band: Option<f64>,
}

impl StickProblem<'_> {
    /// Returns the impulse of the first contact, $`\int F_s\,dt`$ until the stick force falls to
    /// zero at $`t_0`$ ([`separate`] with `threshold` \[N\]); `None` if the faces do not part.
    ///
    /// With the impulses $`J_1`$ in the band and $`J_{1/2}`$ in its lower half, the error of
    /// $`J_1`$ decreases with the first power of the width of the band if the force jumps at
    /// $`t_0`$, and with the second power if its slope does:
    ///
    /// ```math
    /// J = J_1 + (J_1 - J_{1/2}) \quad\text{or}\quad J = J_1 + \tfrac13(J_1 - J_{1/2}) .
    /// ```
    ///
    /// All values between the two are taken as equally probable: the result is their mean, and its
    /// standard error their difference divided by $`\sqrt{12}`$.
    ///
    /// # Validity
    ///
    /// The impulse contains the part of the force that the band limit spreads ahead of the contact,
    /// up to ten periods of the last line. If the force is smooth at $`t_0`$, $`J_1`$ is nearer to
    /// the impulse than the extrapolation is. If the spectrum is rolled off, the roll-off of the
    /// lower half of the band begins at half of the frequency.
    ///
    /// # Errors
    ///
    /// The errors of [`StickProblem::solve`] and [`separate`].
    #[allow(
        clippy::indexing_slicing,
        reason = "`solve` refuses fewer than three lines, and mobilities of different lengths"
    )]
    pub fn contact_impulse(&self, threshold: f64) -> Result<Option<ContactImpulse>, ImpulseError> {
        let Some(all) = self.impulse_in_band(threshold)? else {
            return Ok(None);
        };
        let half = self.first.len() / 2 + 1;
        let narrower = StickProblem {
            first: &self.first[..half],
            second: &self.second[..half],
            roll_off_from_hz: self.roll_off_from_hz.map(|from| 0.5 * from),
            ..*self
        };
        let in_half = if half > 2 {
            narrower.impulse_in_band(threshold)?
        } else {
            None
        };
        Ok(Some(match in_half {
            Some(half) => without_band_limit(all, half),
            None => ContactImpulse {
                impulse: all,
                by_band: None,
            },
        }))
    }

    /// Returns the impulse of the first contact \[N s\] in the band; `None` if the faces do not
    /// part.
    fn impulse_in_band(&self, threshold: f64) -> Result<Option<f64>, ImpulseError> {
        let stick = self.solve()?.history;
        let ContactEnd::Separated { time: end } = separate(&stick, threshold)?.end else {
            return Ok(None);
        };
        let last_line = self.first.len().saturating_sub(1) as f64;
        let period = 1.0 / (last_line * self.frequency_step_hz);
        let begin = -AHEAD * period;
        let samples = stick.force().iter().enumerate();
        let inside = samples
            .map(|(index, force)| (stick.time_at(index), force))
            .filter(|(time, _)| *time >= begin && *time <= end);
        Ok(Some(
            stick.time_step() * inside.map(|(_, force)| force).sum::<f64>(),
        ))
    }
}

/// Returns the impulse without a band limit from the impulses in a band and in half of this band.
fn without_band_limit(all: f64, half: f64) -> ContactImpulse {
    let change = all - half;
    let [first, second] = [change, change / 3.0].map(|further| all + further);
    ContactImpulse {
        impulse: 0.5 * (first + second),
        by_band: Some((first - second).abs() / 12.0_f64.sqrt()),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use num_complex::Complex64;

    use super::*;
    use crate::ZeroLine;

    /// Errors 1/B and 1/B² in a band B = 10 and in half of it: the two ends of the interval, which
    /// are √3 standard errors from its middle.
    #[test]
    fn errors_of_the_first_and_of_the_second_power_are_the_ends() {
        for (power, side) in [(1, -1.0), (2, 1.0)] {
            let error = |band: f64| 7.0 + band.powi(-power);
            let found = without_band_limit(error(10.0), error(5.0));
            let end = found.impulse + side * 3.0_f64.sqrt() * found.by_band.unwrap();
            assert!((end - 7.0).abs() < 1e-14, "{found:?}");
        }
    }

    /// A mass m on a fixed spring k with a dashpot c in parallel: x'' + 2βx' + ω₀²x = 0 with x' = V
    /// at the start. The force cx' + kx is 0 at tan ωt₀ = -cω/(k - cβ), and its impulse until then
    /// is m (V - x'(t₀)).
    #[test]
    fn a_mass_on_a_damped_spring_leaves_with_its_momentum() {
        let (mass, omega_0) = (2.0, TAU * 500.0);
        let (stiffness, beta) = (mass * omega_0 * omega_0, 0.1 * omega_0);
        let dashpot = 2.0 * mass * beta;
        let lines = |mobility: &dyn Fn(Complex64) -> Complex64| -> Vec<Complex64> {
            (0..257)
                .map(|k| mobility(Complex64::new(0.0, TAU * 25.0 * f64::from(k))))
                .collect()
        };
        let first = lines(&|s| 1.0 / (s * mass));
        let second = lines(&|s| s / (dashpot * s + stiffness));
        let problem = StickProblem {
            first: &first,
            second: &second,
            frequency_step_hz: 25.0,
            impact_velocity: 3.0,
            zero_line: ZeroLine::EffectiveMass(mass),
            roll_off_from_hz: None,
            interpolation: 16,
            until: None,
        };
        let omega = (omega_0 * omega_0 - beta * beta).sqrt();
        let parts = TAU / 2.0 - (dashpot * omega / (stiffness - dashpot * beta)).atan();
        let last = (-beta * parts / omega).exp() * (parts.cos() - beta / omega * parts.sin());
        let expected = mass * 3.0 * (1.0 - last);
        let found = problem.contact_impulse(100.0).unwrap().unwrap();
        let error = found.by_band.unwrap();
        // the force is smooth where it ends, so that the extrapolation goes too far
        assert!(
            (found.impulse - expected).abs() < 3.0 * error,
            "{found:?} {expected}"
        );
        assert!(error < 1e-4 * expected);
        // no force exceeds the threshold; a band of three lines is accepted
        assert_eq!(problem.contact_impulse(1e9).unwrap(), None);
        let few = StickProblem {
            first: &first[..3],
            second: &second[..3],
            ..problem
        };
        assert!(few.contact_impulse(0.0).is_ok());
        assert!(problem.contact_impulse(-1.0).is_err());
        let empty = StickProblem {
            first: &[],
            second: &[],
            ..problem
        };
        assert!(empty.contact_impulse(0.0).is_err());
    }
}
