//! A body with a measured frequency response of the impact face.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::{Domain, ImpactBody};
use crate::ImpulseError;
use crate::error::{
    check_enough, check_length, check_lines_finite, check_not_negative, check_positive,
    check_samples,
};

/// A weighed mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeighedMass {
    /// Mass \[kg\].
    pub mass: f64,
    /// Standard error of the mass \[kg\].
    pub standard_error: f64,
}

/// Behaviour of the body below the measured lines.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum LowFrequency {
    /// Free body that was weighed: $`G \to 1/(i\omega M)`$. The line at 0 Hz is not read.
    Free(WeighedMass),
    /// Body on a rigid support: $`G(0) = 0`$. The line at 0 Hz is not read.
    Fixed,
    /// Valid measurement at 0 Hz, as for a long rod.
    Measured,
}

/// An averaged frequency response of the impact face, $`v/F`$ on equidistant lines from 0 Hz.
///
/// | array | shape | unit |
/// |---|---|---|
/// | mobility | `(n_lines)` | m/(N s) |
/// | variance | `(n_lines)`, $`E\lvert\delta G\rvert^2`$ of the average | (m/(N s))² |
///
/// ```
/// use impulse::{LowFrequency, MeasuredBody, ScreeningFlag, WeighedMass};
/// use num_complex::Complex64;
///
/// # fn main() -> Result<(), impulse::ImpulseError> {
/// // 2 kg that ring a little: a free body with one mode
/// let mobility: Vec<_> = (0..400)
///     .map(|k| {
///         let s = Complex64::new(0.0, 2.0 * std::f64::consts::PI * 10.0 * k as f64);
///         if k == 0 { Complex64::ZERO } else { 0.5 / s + 0.3 * s / (s * s + 400.0 * s + 4e6) }
///     })
///     .collect();
/// // and were weighed wrongly
/// let weighed = LowFrequency::Free(WeighedMass { mass: 2.3, standard_error: 0.001 });
/// let body = MeasuredBody::from_mobility(&mobility, 10.0, weighed)?;
/// let flags = body.screen().flags();
/// assert!(flags.iter().any(|flag| matches!(flag, ScreeningFlag::MassContradicted { .. })));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct MeasuredBody {
    frequency_step_hz: f64,
    /// Line 0: the static limit, 0 for a free body.
    mobility: Vec<Complex64>,
    variance: Option<Vec<f64>>,
    /// Degrees of freedom of the variance, one entry per line.
    freedom: Vec<f64>,
    low: LowFrequency,
    given_front: Option<f64>,
    /// Standard uncertainty of the front impedance [kg/s].
    front_error: f64,
    /// Relative standard uncertainty common to all lines.
    scale_error: f64,
    /// Standard uncertainty of the delay of the motion after the force \[s\].
    delay_error: f64,
    /// Index of the first measured line.
    first_measured: usize,
}

/// Drawn errors that all lines of a body have in common.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CommonErrors {
    /// Behaviour at low frequency, with a drawn mass.
    low: LowFrequency,
    scale: f64,
    delay: f64,
}

impl MeasuredBody {
    /// Creates a body with this `mobility` \[m/(N s)\] on lines `frequency_step_hz` apart.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the step or the mass, [`ImpulseError::TooShort`] for fewer
    /// than eight lines, [`ImpulseError::NonFinite`] for a line above 0 Hz,
    /// [`ImpulseError::MissingZeroLine`].
    pub fn from_mobility(
        mobility: &[Complex64],
        frequency_step_hz: f64,
        low: LowFrequency,
    ) -> Result<Self, ImpulseError> {
        const WHAT: &str = "measured mobility";
        check_positive("frequency step [Hz]", frequency_step_hz)?;
        check_enough(WHAT, mobility.len(), 8)?;
        if let LowFrequency::Free(weighed) = low {
            check_positive("weighed mass [kg]", weighed.mass)?;
            check_not_negative(
                "standard error of the weighed mass [kg]",
                weighed.standard_error,
            )?;
        }
        let mut mobility = mobility.to_vec();
        if let Some(first) = mobility.first_mut() {
            match low {
                LowFrequency::Free(_) | LowFrequency::Fixed => *first = Complex64::ZERO,
                LowFrequency::Measured if first.is_finite() => first.im = 0.0,
                LowFrequency::Measured => return Err(ImpulseError::MissingZeroLine { what: WHAT }),
            }
        }
        check_lines_finite(WHAT, &mobility)?;
        Ok(Self {
            frequency_step_hz,
            freedom: vec![f64::INFINITY; mobility.len()],
            mobility,
            variance: None,
            low,
            given_front: None,
            front_error: 0.0,
            scale_error: 0.0,
            delay_error: 0.0,
            first_measured: 1,
        })
    }

    /// Sets the `variance` of the mobility \[(m/(N s))²\], one entry per line; the entry at 0 Hz is
    /// not read.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::LengthMismatch`]; [`ImpulseError::NonFinite`]; [`ImpulseError::NonPhysical`]
    /// for a negative variance.
    pub fn with_variance(self, variance: &[f64]) -> Result<Self, ImpulseError> {
        const WHAT: &str = "variance of the mobility";
        check_length(WHAT, variance.len(), self.mobility.len())?;
        let mut variance = variance.to_vec();
        if let Some(first) = variance.first_mut() {
            *first = 0.0;
        }
        check_samples(WHAT, &variance)?;
        for &value in &variance {
            check_not_negative("variance of the mobility [(m/(N s))^2]", value)?;
        }
        Ok(Self {
            variance: Some(variance),
            ..self
        })
    }

    /// Sets the degrees of freedom of the variances, one entry per line; the default is infinite.
    /// [`MeasuredBody::screen`] computes its probabilities from Student's distribution with them.
    /// The entry at 0 Hz is not read.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::LengthMismatch`]; [`ImpulseError::NonPhysical`] for an entry that is not
    /// positive.
    pub fn with_degrees_of_freedom(self, freedom: &[f64]) -> Result<Self, ImpulseError> {
        check_length(
            "degrees of freedom of the mobility",
            freedom.len(),
            self.mobility.len(),
        )?;
        let mut freedom = freedom.to_vec();
        if let Some(first) = freedom.first_mut() {
            *first = f64::INFINITY;
        }
        if let Some(&wrong) = freedom
            .iter()
            .find(|value| value.is_nan() || **value <= 0.0)
        {
            return Err(ImpulseError::NonPhysical {
                quantity: "degrees of freedom of the mobility",
                value: wrong,
                expected: "a number above 0",
            });
        }
        Ok(Self { freedom, ..self })
    }

    /// Sets the relative standard uncertainty common to all lines, such as that of the sensors; it
    /// also applies to the mass that is found from the lines.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a value that is negative or not finite.
    pub fn with_scale_error(self, relative: f64) -> Result<Self, ImpulseError> {
        Ok(Self {
            scale_error: check_not_negative("relative uncertainty of the scale", relative)?,
            ..self
        })
    }

    /// Sets the standard uncertainty \[s\] of the delay of the motion after the force, such as that
    /// of the channels. Screening allows for it.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a value that is negative or not finite.
    pub fn with_delay_error(self, delay: f64) -> Result<Self, ImpulseError> {
        Ok(Self {
            delay_error: check_not_negative("standard uncertainty of the delay [s]", delay)?,
            ..self
        })
    }

    /// Sets the first measured line; the lines below it were computed from the weighed mass and
    /// cannot check it.
    #[must_use]
    pub fn with_first_measured(self, line: usize) -> Self {
        Self {
            first_measured: line,
            ..self
        }
    }

    /// Sets the front impedance $`Z = A\sqrt{E\rho}`$ [kg/s] of the material at the face, which
    /// determines the mobility above the measured lines. Time marching needs it. A mean over
    /// measured lines cannot replace it, because the lines between two resonances differ from
    /// $`1/Z`$ by arbitrarily large factors.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] unless it is finite and above 0.
    pub fn with_front_impedance(self, impedance: f64) -> Result<Self, ImpulseError> {
        Ok(Self {
            given_front: Some(check_positive("front impedance [kg/s]", impedance)?),
            ..self
        })
    }

    /// Sets the standard uncertainty of the front impedance [kg/s].
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a value that is negative or not finite.
    pub fn with_front_error(self, standard_error: f64) -> Result<Self, ImpulseError> {
        const WHAT: &str = "standard uncertainty of the front impedance [kg/s]";
        Ok(Self {
            front_error: check_not_negative(WHAT, standard_error)?,
            ..self
        })
    }

    /// Replaces the lines; their number stays the same.
    pub(super) fn with_mobility(self, mobility: Vec<Complex64>) -> Self {
        Self { mobility, ..self }
    }

    /// Line spacing \[Hz\].
    #[must_use]
    pub fn frequency_step_hz(&self) -> f64 {
        self.frequency_step_hz
    }

    /// Mobility \[m/(N s)\]; 0 on line 0 for a free or a fixed body.
    #[must_use]
    pub fn mobility(&self) -> &[Complex64] {
        &self.mobility
    }

    /// Variance of the mobility \[(m/(N s))²\], if known; 0 on line 0.
    #[must_use]
    pub fn variance(&self) -> Option<&[f64]> {
        self.variance.as_deref()
    }

    /// Behaviour of the body at low frequency.
    #[must_use]
    pub fn low_frequency(&self) -> LowFrequency {
        self.low
    }

    /// Degrees of freedom of the variances, one entry per line.
    pub(super) fn freedom(&self) -> &[f64] {
        &self.freedom
    }

    /// Relative standard uncertainty common to all lines.
    pub(super) fn scale_error(&self) -> f64 {
        self.scale_error
    }

    pub(super) fn delay_error(&self) -> f64 {
        self.delay_error
    }

    /// Index of the first measured line.
    pub(super) fn first_measured(&self) -> usize {
        self.first_measured
    }

    /// Returns true if the lines, the mass or the front impedance are uncertain.
    #[must_use]
    pub fn is_uncertain(&self) -> bool {
        let of_mass = match self.low {
            LowFrequency::Free(weighed) => weighed.standard_error,
            _ => 0.0,
        };
        self.variance.is_some() || of_mass > 0.0 || self.front_error > 0.0
    }

    /// Front impedance, if given.
    pub(super) fn given_front(&self) -> Option<f64> {
        self.given_front
    }

    /// Draws a body with random errors: independent circular errors of the lines, from their
    /// variances; an error of the scale of all lines, with the relative standard error `scale`; of
    /// the delay of the response after the force, with the standard error `delay` \[s\]; of a
    /// weighed mass and of the front impedance, with their standard errors.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a negative `scale` or `delay`, or a mass or an impedance
    /// so uncertain that a draw of it is not above zero.
    pub fn drawn(
        &self,
        scale: f64,
        delay: f64,
        random: &mut impl Rng,
    ) -> Result<Self, ImpulseError> {
        let common = self.common_errors(scale, delay, random)?;
        self.with_errors(common, random)
    }

    /// Draws the errors that all lines have in common.
    pub(crate) fn common_errors(
        &self,
        scale: f64,
        delay: f64,
        random: &mut impl Rng,
    ) -> Result<CommonErrors, ImpulseError> {
        check_not_negative("relative standard error of the scale", scale)?;
        check_not_negative("standard error of the delay [s]", delay)?;
        let mut normal = || -> f64 { random.sample(StandardNormal) };
        let mut low = self.low;
        if let LowFrequency::Free(weighed) = &mut low {
            let mass = weighed.mass + weighed.standard_error * normal();
            weighed.mass = check_positive("drawn mass [kg]", mass)?;
        }
        Ok(CommonErrors {
            low,
            scale: 1.0 + scale * normal(),
            delay: if delay > 0.0 { delay * normal() } else { 0.0 },
        })
    }

    /// Returns the body with drawn errors of its lines and its front, and with the `common` errors.
    pub(crate) fn with_errors(
        &self,
        common: CommonErrors,
        random: &mut impl Rng,
    ) -> Result<Self, ImpulseError> {
        let mut normal = || -> f64 { random.sample(StandardNormal) };
        let mut drawn = self.clone();
        drawn.low = common.low;
        let no_variance = Vec::new();
        let variances = self.variance.as_ref().unwrap_or(&no_variance);
        for (line, value) in drawn.mobility.iter_mut().enumerate() {
            if let (1.., Some(variance)) = (line, variances.get(line)) {
                let error = Complex64::new(normal(), normal()) * (0.5 * variance).sqrt();
                *value += error;
            }
            let turn = Complex64::from_polar(1.0, -self.omega(line) * common.delay);
            *value *= common.scale * turn;
        }
        if let Some(front) = drawn.given_front.filter(|_| self.front_error > 0.0) {
            let front = front + self.front_error * normal();
            drawn.given_front = Some(check_positive("drawn front impedance [kg/s]", front)?);
        }
        Ok(drawn)
    }

    /// Returns $`G - 1/(i\omega M) - 1/Z`$, the decaying part, line by line. For a free body it
    /// vanishes in proportion to $`\omega`$, apart from the term $`-1/Z`$.
    pub(crate) fn remainder(&self, conductance: f64) -> Vec<Complex64> {
        let lines = self.mobility.iter().enumerate();
        lines
            .map(|(line, value)| value - self.rigid(line) - conductance)
            .collect()
    }

    /// Returns $`1/(i\omega M)`$ of a free body; 0 on line 0 and for other bodies.
    pub(super) fn rigid(&self, line: usize) -> Complex64 {
        match (self.low, line) {
            (LowFrequency::Free(weighed), 1..) => {
                1.0 / Complex64::new(0.0, self.omega(line) * weighed.mass)
            }
            _ => Complex64::ZERO,
        }
    }

    /// ω [rad/s] of a line.
    pub(super) fn omega(&self, line: usize) -> f64 {
        TAU * self.frequency_step_hz * line as f64
    }

    /// Front conductance $`1/Z`$, 0 if not given: a constant on all lines is an impulse at time 0,
    /// which causality does not exclude.
    pub(super) fn conductance(&self) -> f64 {
        self.given_front.map_or(0.0, |impedance| 1.0 / impedance)
    }
}

impl ImpactBody for MeasuredBody {
    fn domain(&self) -> Domain {
        Domain::Lines {
            frequency_step_hz: self.frequency_step_hz,
            n_lines: self.mobility.len(),
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the line is checked to be a line of the body"
    )]
    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError> {
        let position = s.im / (TAU * self.frequency_step_hz);
        let line = position.round();
        let outside = s.re != 0.0
            || (position - line).abs() > 1e-6
            || !(0.0..self.mobility.len() as f64).contains(&line);
        let value = self.mobility.get(line as usize);
        match value {
            Some(value) if !outside => Ok(*value),
            _ => Err(ImpulseError::OutsideDomain {
                s,
                expected: "a line of the measurement",
            }),
        }
    }

    fn free_mass(&self) -> Option<f64> {
        match self.low {
            LowFrequency::Free(weighed) => Some(weighed.mass),
            _ => None,
        }
    }

    fn front_impedance(&self) -> Option<f64> {
        self.given_front
    }
}
