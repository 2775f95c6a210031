//! Data of relaxation and creep: lines over time, alone or together with lines over frequency.

use std::borrow::Cow;
use std::f64::consts::PI;

use num_complex::Complex64;

use super::data::{ModulusData, VarianceScatter, Whitening};
use super::straight_line;
use super::transient::{Reading, respond};
use crate::error::{CmodError, check_that};

/// Distance in ln ω from a line, within which the lines determine the slope of the creep modulus at
/// that line.
const SLOPE_WITHIN: f64 = 1.2;

/// Modulus measured at one time after the start of the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransientPoint {
    /// Time since the load began to rise \[s\], longer than the rise.
    pub time: f64,
    /// Stress divided by strain \[Pa\]: E(t) for relaxation, 1/J(t) for creep.
    pub modulus: f64,
    /// Standard error of the modulus \[Pa\], independent from point to point.
    pub standard_error: f64,
}

/// Quantity that is kept constant in a test over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransientTest {
    /// The strain is constant, and the stress relaxes.
    Relaxation,
    /// The stress is constant, and the strain creeps.
    Creep,
}

impl TransientTest {
    /// Returns the quantity of a line of this test if the ramp took the fraction `ramp` of the time
    /// of the line.
    pub(super) fn reading(self, ramp: f64) -> Reading {
        match self {
            Self::Relaxation => Reading::Relaxation { ramp },
            Self::Creep => Reading::Creep { ramp },
        }
    }
}

impl ModulusData {
    /// Creates the data from moduli over time of a test whose load rose in proportion to time
    /// during the first `ramp` \[s\] and was held from then on; `ramp` is 0 for a step load.
    ///
    /// The response of a law is E(t), or 1/J(t), for this load, without approximation, so points
    /// shortly after the ramp have their full weight. Predictions of the laws remain functions of
    /// frequency; the band of the data is the range of the inverse times, ω = 1/t.
    ///
    /// # Errors
    /// [`CmodError::NoLines`]; [`CmodError::NonPhysical`] unless the ramp is finite and not below
    /// 0; [`CmodError::ModulusPoint`] unless the times increase and are longer than the ramp, and
    /// the moduli and standard errors are finite and above 0.
    ///
    /// ```
    /// use cmod::rheology::{ModulusData, FitOptions, Law, RheologicalFit, TransientPoint, TransientTest};
    ///
    /// // a standard linear solid of 1 GPa + 0.5 GPa with a relaxation time of 10 s, strained in 1 s
    /// let mean = 10.0 * (0.1_f64.exp() - 1.0);
    /// let points: Vec<TransientPoint> = (0..20)
    ///     .map(|i| 1.2_f64.powi(i) * 1.5)
    ///     .map(|time| TransientPoint {
    ///         time,
    ///         modulus: 1e9 + 0.5e9 * mean * (-time / 10.0_f64).exp(),
    ///         standard_error: 1e6,
    ///     })
    ///     .collect();
    /// let data = ModulusData::over_time(TransientTest::Relaxation, 1.0, &points)?;
    /// let fit = RheologicalFit::new(&data, Law::Zener, &FitOptions::default())?;
    /// let time = fit.parameter("relaxation time").unwrap();
    /// assert!((time.value - 10.0).abs() < 1e-4);
    /// # Ok::<(), cmod::CmodError>(())
    /// ```
    pub fn over_time(
        test: TransientTest,
        ramp: f64,
        points: &[TransientPoint],
    ) -> Result<Self, CmodError> {
        if points.is_empty() {
            return Err(CmodError::NoLines);
        }
        let is_right = ramp.is_finite() && ramp >= 0.0;
        let expected = "a finite value, 0 for a step";
        let quantity = "duration of the ramp of a load [s]";
        check_that(is_right, quantity, ramp, expected)?;
        let mut previous = ramp;
        for (index, point) in points.iter().enumerate() {
            let refused = |quantity, value, expected| {
                Err(CmodError::ModulusPoint {
                    index,
                    quantity,
                    value,
                    expected,
                })
            };
            let (quantity, time) = ("time since the start of the load [s]", point.time);
            // a comparison with NaN is false, so a NaN is refused
            if !(time > previous && time.is_finite() && time.recip().is_finite()) {
                let expected = if index == 0 {
                    "a finite value above the duration of the ramp"
                } else {
                    "a finite value above that of the previous point"
                };
                return refused(quantity, time, expected);
            }
            previous = time;
            for (quantity, value) in [
                ("modulus [Pa]", point.modulus),
                ("standard error of the modulus [Pa]", point.standard_error),
            ] {
                if !(value > 0.0 && value.is_finite() && value.recip().is_finite()) {
                    return refused(quantity, value, "a finite value above 0");
                }
            }
        }
        let reading = |point: &TransientPoint| test.reading(ramp / point.time);
        let points = || points.iter().rev();
        Ok(Self {
            omega: points().map(|point| point.time.recip()).collect(),
            readings: points().map(reading).collect(),
            modulus: points().map(|point| point.modulus.into()).collect(),
            whitening: points()
                .map(|point| Whitening::of_real(point.standard_error))
                .collect(),
            common: Vec::new(),
            scatter: VarianceScatter::NONE,
        })
    }

    /// Joins data of one material at one temperature, such as data over frequency and data over
    /// time. Common errors of the same source are treated as the same error in all parts.
    ///
    /// # Errors
    /// [`CmodError::NoLines`] without data.
    pub fn together(parts: &[Self]) -> Result<Self, CmodError> {
        if parts.is_empty() {
            return Err(CmodError::NoLines);
        }
        Ok(Self::joined(parts.iter().map(|part| (part, 1.0))).in_order())
    }

    /// Returns the time since the start of the load \[s\] of a line over time; `None` for a line
    /// over frequency.
    #[must_use]
    pub fn time(&self, line: usize) -> Option<f64> {
        let reading = self.readings.get(line)?;
        reading
            .is_real()
            .then(|| self.omega.get(line).copied())?
            .map(f64::recip)
    }

    /// Returns the test of a line over time; `None` for a line over frequency.
    #[must_use]
    pub fn test(&self, line: usize) -> Option<TransientTest> {
        match self.readings.get(line)? {
            Reading::Oscillation => None,
            Reading::Relaxation { .. } => Some(TransientTest::Relaxation),
            Reading::Creep { .. } => Some(TransientTest::Creep),
        }
    }

    /// Returns the data as if all loads had been steps, for example to draw a law without the
    /// ramps.
    #[must_use]
    pub fn with_steps(mut self) -> Self {
        for reading in &mut self.readings {
            if let Reading::Relaxation { ramp } | Reading::Creep { ramp } = reading {
                *ramp = 0.0;
            }
        }
        self
    }

    /// Returns true if there are lines over time.
    #[must_use]
    pub fn has_times(&self) -> bool {
        self.readings.iter().any(|reading| reading.is_real())
    }

    /// Returns moduli that are linear in the moduli of the springs of a law, for the starting
    /// points of fits. Where ln(1/J) has the slope m with respect to ln ω, the creep modulus 1/J(t)
    /// is E(t) πm/sin πm; this is exact for a power of time.
    #[allow(
        clippy::indexing_slicing,
        reason = "every line has a frequency, a reading and a modulus"
    )]
    pub(super) fn linear_moduli(&self) -> Cow<'_, [Complex64]> {
        let is_creep = |line: &usize| matches!(self.readings[*line], Reading::Creep { .. });
        let creep: Vec<usize> = (0..self.len()).filter(is_creep).collect();
        if creep.is_empty() {
            return Cow::Borrowed(&self.modulus);
        }
        let logarithms = |line: usize| (self.omega[line].ln(), self.modulus[line].re.ln());
        let mut moduli = self.modulus.clone();
        for line in &creep {
            let own = self.omega[*line].ln();
            let near = |of: &(f64, f64)| (of.0 - own).abs() <= SLOPE_WITHIN;
            let near: Vec<(f64, f64)> = creep.iter().map(|k| logarithms(*k)).filter(near).collect();
            let m = straight_line(&near).map_or(0.0, |(_, slope)| slope.clamp(0.0, 0.9));
            if m > 0.0 {
                moduli[*line] *= (PI * m).sin() / (PI * m);
            }
        }
        Cow::Owned(moduli)
    }

    /// Returns the response at a line that is linear in the springs of a law; for a line of creep,
    /// this is the response of relaxation.
    pub(super) fn linear_response(
        &self,
        line: usize,
        law: impl Fn(Complex64) -> Complex64,
    ) -> Complex64 {
        let place = self.omega.get(line).zip(self.readings.get(line));
        let of = |(omega, reading): (&f64, &Reading)| {
            let at_s = |s, _: &mut [Complex64]| Some(law(s));
            respond((*omega, reading.as_linear()), &mut [], &mut [], at_s)
        };
        place.and_then(of).unwrap_or(Complex64::ZERO)
    }

    /// Returns the lines with the same quantity as `reading`, with any ramp. For tests over time,
    /// the times are counted from the middle of the ramp. A smooth modulus is then nearly the
    /// modulus after a step (Zapas & Phillips, *J. Res. Natl. Bur. Stand.* **75A** (1971) 33).
    pub(super) fn as_steps(&self, reading: Reading) -> Self {
        let is_own = |line: &usize| {
            self.readings
                .get(*line)
                .is_some_and(|own| own.is_like(reading))
        };
        let mut own = self.picked(&(0..self.len()).filter(is_own).collect::<Vec<usize>>());
        for (omega, reading) in own.omega.iter_mut().zip(&own.readings) {
            *omega /= 1.0 - 0.5 * reading.ramp();
        }
        own
    }
}
