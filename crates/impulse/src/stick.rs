//! The force between faces that stick, by the Fourier transform.
//!
//! Theory: `docs/theory/stick-force.md`.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use num_complex::Complex64;

use crate::error::{check_enough, check_length, check_not_negative, check_positive};
use crate::{ForceHistory, ImpulseError, fourier};

/// Largest relative level of the quiet part of a settled history.
const SETTLED: f64 = 0.01;

/// Length of the history divided by the length of the part shown before the contact, where the band
/// limit smears the jump. A quiet part of the same length at the end of the history gives the final
/// value of the force.
const PARTS_AHEAD: usize = 16;

/// Largest number of lines of a spectrum with its interpolation, which take one gibibyte.
const MOST_SAMPLES: usize = 1 << 26;

/// Fraction of the magnitude attributed to rounding: a real part counts as passive if it is above
/// minus this fraction.
const PASSIVITY_ROUNDING: f64 = 1e-12;

/// Substitute for the line at 0 Hz, where the mobility of a free body is infinite and the step has
/// no spectrum.
///
/// On the other lines the force spectrum is $`\hat F = V/(i\omega(G_1+G_2))`$. A constant force
/// remains undetermined.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ZeroLine {
    /// Weighed bodies: the total impulse is $`\hat F(0) = V M`$, with $`1/M = \sum 1/M_i`$ over the
    /// free bodies \[kg\]; a long or a fixed body has no term. This value is the limit of the
    /// accelerance form $`(A_1+A_2)\hat F = V`$, $`A_i = i\omega G_i \to 1/M_i`$. At least one body
    /// must be free. Use this choice if possible.
    EffectiveMass(f64),
    /// Unknown masses, with a force that decays within the period: the constant is the one for
    /// which the force is zero before contact.
    QuietBeforeContact,
    /// Two bodies of which neither is free, with a force that tends to a constant. The velocity is
    /// a square wave of period $`1/\Delta f`$, whose spectrum $`2V/(i\omega)`$ has only odd lines:
    /// no line at 0 Hz is needed, but the history is half as long, and transients of the force must
    /// decay within it.
    SquareWave,
}

/// The stick force $`F_s`$ of two bodies that meet with velocity $`V`$, $`[G_1 + G_2] * F_s = V
/// H(t)`$ (Ödeen 1993, paper E, eq. 2).
///
/// | field | shape | unit |
/// |---|---|---|
/// | `first`, `second` | `(n_lines)`, from 0 Hz to $`f_{max}`$ | m/(N s) |
/// | result | `(2 n_lines - 2)` times the interpolation, or half of it for [`ZeroLine::SquareWave`]; a sixteenth of it before the contact at time 0 | N |
///
/// # Validity
///
/// - The force must settle within the period $`T = 1/\Delta f`$; a later force wraps around to the
///   beginning, which [`StickForce::settlement`] detects. The force between two finite elastic
///   bodies does not decay, and their mobilities have poles on the frequency axis: for them the
///   method is not valid.
/// - The spectrum ends at $`f_{max}`$. The force jumps at contact to $`V/(1/Z_1+1/Z_2)`$; without a
///   roll-off the band limit rings there with the amplitude $`F(0)/(\pi n)`$ n samples away, and
///   the first sample is the middle of the jump. With a roll-off from $`f_{max}/2`$ the ringing is
///   below $`0.7\,F(0)/n^3`$.
#[derive(Debug, Clone, Copy)]
pub struct StickProblem<'a> {
    /// Mobility of the first body's impact face. The element at 0 Hz is not read.
    pub first: &'a [Complex64],
    /// Mobility of the second body's impact face. The element at 0 Hz is not read.
    pub second: &'a [Complex64],
    /// Line spacing \[Hz\].
    pub frequency_step_hz: f64,
    /// Relative velocity of the bodies before contact \[m/s\].
    pub impact_velocity: f64,
    /// Substitute for the line at 0 Hz.
    pub zero_line: ZeroLine,
    /// Start of a raised cosine that takes the force spectrum to zero at $`f_{max}`$ \[Hz\];
    /// `None` for no roll-off.
    pub roll_off_from_hz: Option<f64>,
    /// Number of samples within each interval $`1/(2f_{max})`$; 1 gives as many samples as the
    /// lines define. With more samples the history is interpolated from the lines themselves, which
    /// is needed to find peaks and zeros; linear interpolation between samples at these intervals
    /// misses them.
    pub interpolation: usize,
    /// End of the returned history \[s\]; `None` for the whole period, within which the force must
    /// settle in any case.
    pub until: Option<f64>,
}

/// Settlement of the force within the period, without wrap-around.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Settlement {
    /// Settled: late in the history, the root mean square difference between the force and its
    /// final value is at most 1 % of the peak.
    Settled,
    /// Unsettled: the period $`1/\Delta f`$ is too short, or the bodies have no damping.
    Unsettled {
        /// Root mean square of the late force about its final value, divided by the peak.
        relative_level: f64,
    },
}

/// The stick force and its quality.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct StickForce {
    /// The force, with the contact at time 0; it is tensile where negative. Before contact it
    /// would be zero without a band limit.
    pub history: ForceHistory,
    /// Settlement of the force within the period.
    pub settlement: Settlement,
    /// The constant \[N\] that was added to replace the line at 0 Hz.
    pub added_constant: f64,
    /// Number of lines where the sum of the mobilities generates energy,
    /// $`\operatorname{Re}(G_1+G_2) < 0`$: zero for computed bodies; for measured bodies a sign of
    /// noise or phase errors.
    pub nonpassive_lines: usize,
}

impl StickProblem<'_> {
    /// ω [rad/s] of a line.
    pub(crate) fn omega(&self, line: usize) -> f64 {
        TAU * self.frequency_step_hz * line as f64
    }

    /// Solves for the stick force.
    ///
    /// # Errors
    ///
    /// - [`ImpulseError::TooShort`] or [`ImpulseError::LengthMismatch`] for the mobilities, which
    ///   need at least three lines and the same number of lines.
    /// - [`ImpulseError::NonPhysical`] for the frequency step, the velocity, the mass or the
    ///   roll-off.
    /// - [`ImpulseError::NonFinite`] for a mobility above 0 Hz: a pole of an undamped body lies on
    ///   the line.
    /// - [`ImpulseError::VanishingMobility`], [`ImpulseError::SpectrumOverflow`].
    pub fn solve(&self) -> Result<StickForce, ImpulseError> {
        let (lines, nonpassive_lines) = self.force_lines()?;
        let (history, added_constant) = self.whole_history_of(&lines)?;
        Ok(StickForce {
            settlement: self.settlement(&history),
            history: self.shown(history)?,
            added_constant,
            nonpassive_lines,
        })
    }

    /// Returns the spectrum $`\hat F`$ \[N s\] of the stick force, and the number of lines that
    /// generate energy.
    pub(crate) fn force_lines(&self) -> Result<(Vec<Complex64>, usize), ImpulseError> {
        let n_lines = self.checked_n_lines()?;
        let roll_off = self.roll_off(n_lines)?;
        let mut nonpassive_lines = 0;
        let mut spectrum = vec![Complex64::ZERO; n_lines];
        let bodies = self.first.iter().zip(self.second);
        for (index, (line, (first, second))) in spectrum.iter_mut().zip(bodies).enumerate() {
            if index == 0 {
                if let ZeroLine::EffectiveMass(mass) = self.zero_line {
                    *line = (self.impact_velocity * mass).into();
                }
                continue;
            }
            let mobility = first + second;
            if mobility.re < -PASSIVITY_ROUNDING * mobility.norm() {
                nonpassive_lines += 1;
            }
            if mobility == Complex64::ZERO {
                return Err(ImpulseError::VanishingMobility { index });
            }
            let frequency_hz = index as f64 * self.frequency_step_hz;
            let accelerance = Complex64::new(0.0, TAU * frequency_hz) * mobility;
            let velocity = self.velocity_amplitude(index) * roll_off.at(frequency_hz);
            *line = velocity / accelerance;
            if !line.is_finite() {
                return Err(ImpulseError::SpectrumOverflow { index });
            }
        }
        Ok((spectrum, nonpassive_lines))
    }

    /// Number of samples of a period and of the history before it is cut.
    fn n_whole(&self) -> (usize, usize) {
        let n_samples = 2 * (self.first.len() - 1) * self.interpolation;
        match self.zero_line {
            ZeroLine::EffectiveMass(_) | ZeroLine::QuietBeforeContact => (n_samples, n_samples),
            ZeroLine::SquareWave => (n_samples, n_samples / 2),
        }
    }

    /// Number of samples of a period and of the returned history.
    pub(crate) fn n_samples(&self) -> (usize, usize) {
        let (n_samples, n_whole) = self.n_whole();
        let step = 1.0 / (n_samples as f64 * self.frequency_step_hz);
        let ahead = (n_whole / PARTS_AHEAD) as f64;
        let n_shown = self.until.map_or(n_whole, |until| {
            (0..n_whole)
                .take_while(|index| (*index as f64 - ahead) * step <= until)
                .count()
        });
        (n_samples, n_shown)
    }

    /// Returns the spectrum of the interpolated history: the last line of the band, if it is inside
    /// the new spectrum, is divided between both sides.
    pub(crate) fn interpolated(&self, mut lines: Vec<Complex64>, share: f64) -> Vec<Complex64> {
        if self.interpolation > 1
            && let Some(last) = lines.last_mut()
        {
            *last = Complex64::from(share * last.re);
        }
        lines
    }

    /// Returns the history of a force with these lines, and the constant that was added to it: both
    /// are linear in the lines.
    pub(crate) fn history_of(
        &self,
        lines: &[Complex64],
    ) -> Result<(ForceHistory, f64), ImpulseError> {
        let (history, added_constant) = self.whole_history_of(lines)?;
        Ok((self.shown(history)?, added_constant))
    }

    /// Returns the part of the history until [`StickProblem::until`].
    fn shown(&self, history: ForceHistory) -> Result<ForceHistory, ImpulseError> {
        let (_, n_shown) = self.n_samples();
        if n_shown == history.force().len() {
            return Ok(history);
        }
        let force = history.force().iter().take(n_shown).copied().collect();
        ForceHistory::new(history.time_at(0), history.time_step(), force)
    }

    fn whole_history_of(&self, lines: &[Complex64]) -> Result<(ForceHistory, f64), ImpulseError> {
        let (n_samples, n_shown) = self.n_whole();
        let lines = self.interpolated(lines.to_vec(), 0.5);
        let period: Vec<f64> = fourier::to_samples(&lines, n_samples)
            .iter()
            .map(|sample| sample * self.frequency_step_hz)
            .collect();
        // the end of the period is the time before contact
        let n_ahead = n_shown / PARTS_AHEAD;
        let mut force: Vec<f64> = period
            .iter()
            .cycle()
            .skip(n_samples - n_ahead)
            .take(n_shown)
            .copied()
            .collect();
        let added_constant = match self.reference() {
            None => 0.0,
            Some((_, sign)) => sign * mean(quiet_part(&force)),
        };
        for sample in &mut force {
            *sample += added_constant;
        }
        let time_step = 1.0 / (n_samples as f64 * self.frequency_step_hz);
        let start_time = -(n_ahead as f64) * time_step;
        let history = ForceHistory::new(start_time, time_step, force)?;
        Ok((history, added_constant))
    }

    fn checked_n_lines(&self) -> Result<usize, ImpulseError> {
        check_positive("frequency step [Hz]", self.frequency_step_hz)?;
        check_positive("impact velocity [m/s]", self.impact_velocity)?;
        let n_samples = self.first.len().saturating_mul(self.interpolation);
        if !(1..=MOST_SAMPLES).contains(&n_samples) {
            return Err(ImpulseError::NonPhysical {
                quantity: "number of lines times interpolation",
                value: n_samples as f64,
                expected: "from 1 to 2^26",
            });
        }
        if let Some(until) = self.until {
            check_positive("end of the history [s]", until)?;
        }
        if let ZeroLine::EffectiveMass(mass) = self.zero_line {
            check_positive("effective mass [kg]", mass)?;
        }
        let n_lines = self.first.len();
        check_enough("first mobility", n_lines, 3)?;
        check_length("second mobility", self.second.len(), n_lines)?;
        for (what, mobility) in [
            ("first mobility", self.first),
            ("second mobility", self.second),
        ] {
            let mut lines = mobility.iter().enumerate().skip(1);
            if let Some((index, _)) = lines.find(|(_, value)| !value.is_finite()) {
                return Err(ImpulseError::NonFinite { what, index });
            }
        }
        Ok(n_lines)
    }

    fn roll_off(&self, n_lines: usize) -> Result<RollOff, ImpulseError> {
        let highest_hz = (n_lines - 1) as f64 * self.frequency_step_hz;
        let from_hz = match self.roll_off_from_hz {
            None => highest_hz,
            Some(from_hz) => check_not_negative("start of the roll-off [Hz]", from_hz)?,
        };
        Ok(RollOff {
            from_hz,
            highest_hz,
        })
    }

    /// Factor of 1/(i omega): V for a step, 2V on the odd lines for a square wave of half height.
    fn velocity_amplitude(&self, index: usize) -> f64 {
        match self.zero_line {
            ZeroLine::EffectiveMass(_) | ZeroLine::QuietBeforeContact => self.impact_velocity,
            ZeroLine::SquareWave if index % 2 == 1 => 2.0 * self.impact_velocity,
            ZeroLine::SquareWave => 0.0,
        }
    }

    /// Range of the samples whose mean is added to the force, with the sign of this mean, so that
    /// the force is zero before contact. A decayed period ends with the value before the contact;
    /// half a period of the square wave ends with minus that value.
    pub(crate) fn reference(&self) -> Option<(Range<usize>, f64)> {
        let (_, n_shown) = self.n_whole();
        let quiet = n_shown - n_quiet(n_shown)..n_shown;
        match self.zero_line {
            ZeroLine::EffectiveMass(_) => None,
            ZeroLine::QuietBeforeContact => Some((quiet, -1.0)),
            ZeroLine::SquareWave => Some((quiet, 1.0)),
        }
    }

    fn settlement(&self, history: &ForceHistory) -> Settlement {
        let quiet = quiet_part(history.force());
        let end = match self.zero_line {
            ZeroLine::EffectiveMass(_) | ZeroLine::QuietBeforeContact => 0.0,
            ZeroLine::SquareWave => mean(quiet),
        };
        // relative to the peak, so that no square overflows or underflows
        let peak = history.peak().force.abs();
        let squares: Vec<f64> = quiet
            .iter()
            .map(|force| ((force - end) / peak).powi(2))
            .collect();
        let relative_level = mean(&squares).sqrt();
        if relative_level <= SETTLED {
            Settlement::Settled
        } else {
            Settlement::Unsettled { relative_level }
        }
    }
}

/// Roll-off: 1 up to a frequency, then half a period of a cosine down to 0 at the highest line.
struct RollOff {
    from_hz: f64,
    highest_hz: f64,
}

impl RollOff {
    fn at(&self, frequency_hz: f64) -> f64 {
        if frequency_hz <= self.from_hz {
            1.0
        } else {
            let fraction = (frequency_hz - self.from_hz) / (self.highest_hz - self.from_hz);
            0.5 + 0.5 * (PI * fraction).cos()
        }
    }
}

/// End of the history, as long as the part shown before the contact.
fn quiet_part(force: &[f64]) -> &[f64] {
    force
        .get(force.len().saturating_sub(n_quiet(force.len()))..)
        .unwrap_or(force)
}

fn n_quiet(n_samples: usize) -> usize {
    (n_samples / PARTS_AHEAD).max(1)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ContactEnd, separate};

    const FREQUENCY_STEP_HZ: f64 = 50.0;
    const N_LINES: usize = 4097;
    const HIGHEST_HZ: f64 = FREQUENCY_STEP_HZ * (N_LINES as f64 - 1.0);
    const VELOCITY: f64 = 2.0;

    fn spectrum(mobility: impl Fn(Complex64) -> Complex64) -> Vec<Complex64> {
        (0..N_LINES)
            .map(|k| mobility(Complex64::new(0.0, TAU * FREQUENCY_STEP_HZ * k as f64)))
            .collect()
    }

    fn rod(impedance: f64) -> Vec<Complex64> {
        spectrum(|_| (1.0 / impedance).into())
    }

    fn mass(mass: f64) -> Vec<Complex64> {
        spectrum(|s| 1.0 / (s * mass))
    }

    fn free_elastic_rod(impedance: f64, transit_time: f64) -> Vec<Complex64> {
        spectrum(|s| 1.0 / (impedance * (s * transit_time).tanh()))
    }

    fn problem<'a>(
        first: &'a [Complex64],
        second: &'a [Complex64],
        zero_line: ZeroLine,
        roll_off_from_hz: Option<f64>,
    ) -> StickProblem<'a> {
        StickProblem {
            first,
            second,
            frequency_step_hz: FREQUENCY_STEP_HZ,
            impact_velocity: VELOCITY,
            zero_line,
            roll_off_from_hz,
            interpolation: 1,
            until: None,
        }
    }

    /// Largest deviation from `exact`, and from zero before contact, relative to `scale`, at least
    /// `away` samples from contact.
    fn deviation(
        history: &ForceHistory,
        away: usize,
        scale: f64,
        exact: impl Fn(f64) -> f64,
    ) -> f64 {
        let contact = history.index_near(0.0).unwrap();
        let samples = history.force().iter().enumerate();
        samples
            .filter(|(index, _)| index.abs_diff(contact) >= away)
            .map(|(index, force)| match index {
                _ if index < contact => force.abs() / scale,
                _ => (force - exact(history.time_at(index))).abs() / scale,
            })
            .fold(0.0, f64::max)
    }

    /// Ringing n samples from a unit jump with the raised cosine from half the band: the second
    /// derivative of the cosine jumps by 2/pi^2 (in units of samples^2) at half the band and at
    /// its end, and each jump d at theta leaves d pi/(theta n^3): (0.41 + 0.20)/n^3. Two jumps
    /// per period, one sample of margin.
    fn rolled_ringing(n: usize) -> f64 {
        2.0 * 0.61 / (n as f64 - 1.0).powi(3)
    }

    /// Ringing of the plain band limit, 1/(pi n), for two jumps.
    fn plain_ringing(n: usize) -> f64 {
        2.0 / (PI * n as f64)
    }

    #[test]
    fn two_long_rods_press_with_a_constant_force() {
        let (z1, z2) = (400.0, 1000.0);
        let (first, second) = (rod(z1), rod(z2));
        let exact = VELOCITY / (1.0 / z1 + 1.0 / z2);
        for (roll_off, tolerance) in [
            (None, plain_ringing(20)),
            (Some(HIGHEST_HZ / 2.0), rolled_ringing(20)),
        ] {
            let stick = problem(&first, &second, ZeroLine::SquareWave, roll_off);
            let stick = stick.solve().unwrap();
            assert_eq!(stick.settlement, Settlement::Settled);
            assert_eq!(stick.nonpassive_lines, 0);
            assert_eq!(stick.history.force().len(), N_LINES - 1);
            let found = deviation(&stick.history, 20, exact, |_| exact);
            assert!(found < tolerance, "{found} {tolerance}");
            // the first sample is the middle of the jump, by symmetry; the ringing of the plain
            // limit shifts the constant by at most its size in the quiet part
            let middle = stick.history.force()[stick.history.index_near(0.0).unwrap()];
            assert!((middle / exact - 0.5).abs() < plain_ringing(N_LINES / 16));
        }
    }

    #[test]
    fn a_force_that_lasts_is_flagged_where_it_cannot_be_had() {
        let (first, second) = (rod(400.0), rod(1000.0));
        let stick = problem(&first, &second, ZeroLine::QuietBeforeContact, None);
        let stick = stick.solve().unwrap();
        // the result is a ramp (1 - t/T) F shifted so that it is zero at its end
        assert!(matches!(stick.settlement, Settlement::Unsettled { .. }));
    }

    #[test]
    fn a_rigid_mass_on_a_long_rod_gives_the_exponential_of_theory() {
        let (impedance, mass_kg) = (1000.0, 0.8);
        let (first, second) = (mass(mass_kg), rod(impedance));
        let peak = impedance * VELOCITY;
        let exact = |t: f64| peak * (-impedance * t / mass_kg).exp();
        // time constant 0.8 ms, period 20 ms: 1.4e-11 of the peak wraps around, 3.7e-6 in half a
        // period
        for (zero_line, wrapped) in [
            (ZeroLine::EffectiveMass(mass_kg), 1.4e-11),
            (ZeroLine::QuietBeforeContact, 1.4e-11),
            (ZeroLine::SquareWave, 3.7e-6),
        ] {
            for (roll_off, ringing) in [
                (None, plain_ringing(40)),
                (Some(HIGHEST_HZ / 2.0), rolled_ringing(40)),
            ] {
                let stick = problem(&first, &second, zero_line, roll_off);
                let stick = stick.solve().unwrap();
                assert_eq!(stick.settlement, Settlement::Settled);
                // the constant makes the force zero in the quiet part, where it is exp(-17.5) or
                // exp(-10.9) of the peak
                let constant = match zero_line {
                    ZeroLine::EffectiveMass(_) => 0.0,
                    ZeroLine::QuietBeforeContact => 2.6e-8,
                    ZeroLine::SquareWave => 1.8e-5,
                };
                let found = deviation(&stick.history, 40, peak, exact);
                let tolerance = ringing + wrapped + constant;
                assert!(found < tolerance, "{zero_line:?}: {found} {tolerance}");
            }
        }
    }

    #[test]
    fn the_impulse_stops_the_mass() {
        let (impedance, mass_kg) = (1000.0, 0.8);
        let (first, second) = (mass(mass_kg), rod(impedance));
        let momentum = mass_kg * VELOCITY;
        let weighed = problem(&first, &second, ZeroLine::EffectiveMass(mass_kg), None);
        let weighed = weighed.solve().unwrap().history.impulse();
        // the line at 0 Hz determines the impulse; the rounding of the sum of 8192 samples remains
        assert!((weighed / momentum - 1.0).abs() < 1e-12);
        let roll_off = Some(HIGHEST_HZ / 2.0);
        let unweighed = problem(&first, &second, ZeroLine::QuietBeforeContact, roll_off);
        let unweighed = unweighed.solve().unwrap().history.impulse();
        // the constant is off by exp(-17.5) = 2.6e-8 of the peak over 25 time constants, and by the
        // ringing 512 samples from the jump, 0.61/512^3 = 5e-9, over the same time
        assert!((unweighed / momentum - 1.0).abs() < 25.0 * (2.6e-8 + 5e-9));
    }

    #[test]
    fn a_mass_on_a_damped_spring_separates_when_theory_says() {
        let (mass_kg, stiffness, damping) = (0.5, 5e6, 600.0_f64);
        let first = mass(mass_kg);
        let second = spectrum(|s| s / (stiffness + s * damping));
        let stick = problem(&first, &second, ZeroLine::EffectiveMass(mass_kg), None);
        let stick = stick.solve().unwrap();
        assert_eq!(stick.settlement, Settlement::Settled);
        // x = V exp(-a t) sin(w t)/w with F = k x + c dx/dt
        let a = damping / (2.0 * mass_kg);
        let w = (stiffness / mass_kg - a * a).sqrt();
        let exact = |t: f64| {
            let sine = (stiffness - damping * a) / w * (w * t).sin();
            VELOCITY * (-a * t).exp() * (sine + damping * (w * t).cos())
        };
        // the force jumps to c V at contact
        let jump = damping * VELOCITY;
        let found = deviation(&stick.history, 40, jump, exact);
        // and 3400/1200 exp(-a T) = 1.8e-5 of the jump wraps around
        assert!(found < plain_ringing(40) + 1.8e-5, "{found}");

        let zero = (PI - (damping * w / (stiffness - damping * a)).atan()) / w;
        let impact = separate(&stick.history, 0.0).unwrap();
        let ContactEnd::Separated { time } = impact.end else {
            panic!("expected separation")
        };
        // ringing of one jump at that sample, divided by the slope of the force
        let samples_to_zero = zero / stick.history.time_step();
        let slope = (exact(zero - 1e-7) - exact(zero + 1e-7)) / 2e-7;
        let tolerance = jump / (PI * samples_to_zero) / slope;
        assert!((time - zero).abs() < tolerance, "{time} {zero} {tolerance}");
        assert!(
            impact
                .closest_to_separation
                .is_none_or(|graze| graze.time < 0.1 * zero)
        );
    }

    #[test]
    fn an_elastic_striker_leaves_a_pulse_of_twice_its_length() {
        // same impedance as the long rod: F = Z V/2 while the wave travels to the end and back,
        // then zero: the momentum M V has been transferred
        let (impedance, transit_time) = (1000.0, 1.037e-3);
        let (first, second) = (free_elastic_rod(impedance, transit_time), rod(impedance));
        let mass_kg = impedance * transit_time;
        let stick = problem(
            &first,
            &second,
            ZeroLine::EffectiveMass(mass_kg),
            Some(HIGHEST_HZ / 2.0),
        );
        let stick = stick.solve().unwrap();
        assert_eq!(stick.settlement, Settlement::Settled);
        let plateau = impedance * VELOCITY / 2.0;
        let history = &stick.history;
        let away = 20;
        for (index, force) in history.force().iter().enumerate() {
            let since_begin = history.time_at(index) / history.time_step();
            let since_end = since_begin - 2.0 * transit_time / history.time_step();
            if since_begin.abs().min(since_end.abs()) >= away as f64 {
                let pressed = since_begin > 0.0 && since_end < 0.0;
                let exact = if pressed { plateau } else { 0.0 };
                // jumps at both ends of the pulse
                assert!(
                    (force - exact).abs() < 2.0 * rolled_ringing(away) * plateau,
                    "{index}"
                );
            }
        }
    }

    #[test]
    fn two_finite_elastic_bodies_are_flagged() {
        let first = free_elastic_rod(1000.0, 1.037e-3);
        let mass_kg = 1.037;
        let stick = problem(&first, &first, ZeroLine::EffectiveMass(mass_kg / 2.0), None);
        assert!(matches!(
            stick.solve().unwrap().settlement,
            Settlement::Unsettled { relative_level } if relative_level > 0.1
        ));
    }

    #[test]
    fn mobilities_that_generate_energy_are_counted() {
        let mut first = rod(400.0);
        first[7] = Complex64::new(-1.0, 0.5);
        first[9] = Complex64::new(-2.0, 0.0);
        let second = rod(1000.0);
        let stick = problem(&first, &second, ZeroLine::SquareWave, None);
        assert_eq!(stick.solve().unwrap().nonpassive_lines, 2);
    }

    #[test]
    fn bad_requests_are_refused_with_the_place() {
        let good = rod(400.0);
        let minus: Vec<Complex64> = good.iter().map(|g| -g).collect();
        let mut pole = good.clone();
        pole[3].im = f64::INFINITY;
        pole[0].re = f64::NAN; // not read
        let request = problem(&good, &good, ZeroLine::SquareWave, None);
        let refusal = |request: StickProblem<'_>| request.solve().unwrap_err().to_string();
        let second = |second| StickProblem { second, ..request };
        assert_eq!(
            refusal(second(&minus)),
            "the sum of the mobilities vanishes at line 1"
        );
        assert_eq!(
            refusal(second(&pole)),
            "element 3 of the second mobility is not finite"
        );
        assert_eq!(
            refusal(second(&good[1..])),
            "the second mobility has 4096 elements, expected 4097"
        );
        assert_eq!(
            refusal(StickProblem {
                zero_line: ZeroLine::EffectiveMass(0.0),
                ..request
            }),
            "effective mass [kg] is 0, expected a finite value above 0"
        );
        assert_eq!(
            refusal(StickProblem {
                impact_velocity: f64::NAN,
                ..request
            }),
            "impact velocity [m/s] is NaN, expected a finite value above 0"
        );
    }
}
