//! Gain ratio and delay of two sensors, determined from the lines of their ratio.

use num_complex::Complex64;

use super::{RatioLines, RatioMethod, ratio_error};
use crate::causal::{CausalEstimate, of_experiment};
use crate::error::CmodError;
use crate::estimate::{ErrorSource, ModulusEstimate, ModulusLine};
use crate::lateral_inertia::LateralInertia;
use crate::self_calibration::{Experiment, LinearisedLine, SelfCalibration, found};

impl SelfCalibration {
    /// Returns the estimate of a `method` for a ratio, in which the [common
    /// errors](RatioLines::common) of the ratio are determined from its lines.
    ///
    /// Returns `None` if there are no common errors, or if there are too few lines to determine
    /// them.
    ///
    /// ```
    /// use cmod::estimate::ErrorSource;
    /// use cmod::section_ratio::{RatioError, RatioLines};
    /// use cmod::self_calibration::SelfCalibration;
    /// use cmod::{Specimen, TwoPoint};
    /// use num_complex::Complex64;
    ///
    /// // a rod without end mass, 0.8 m, c = 1500 m/s, loss factor 0.05; the sensor at the struck
    /// // end reads 2 % too high
    /// let frequency_hz: Vec<f64> = (1..=400).map(|j| 25.0 * f64::from(j)).collect();
    /// let ratio: Vec<Complex64> = frequency_hz
    ///     .iter()
    ///     .map(|f| {
    ///         let gamma = std::f64::consts::TAU * f * Complex64::I / (1500.0 * Complex64::new(1.0, 0.05).sqrt());
    ///         1.02 * (0.8 * gamma).cosh()
    ///     })
    ///     .collect();
    /// let variance = vec![1e-6; ratio.len()];
    /// let known_to_three_percent = [RatioError::of_gain_ratio(&frequency_hz, 0.03)?];
    /// let lines = RatioLines {
    ///     common: &known_to_three_percent,
    ///     ..RatioLines::of_known_variance(&frequency_hz, &ratio, &variance)
    /// };
    /// let method = TwoPoint::new(Specimen { length: 0.8, diameter: 0.016, density: 912.0, accelerometer_mass: 0.0 })?;
    /// let calibrated = SelfCalibration::of_ratio(&method, &lines)?.unwrap();
    /// let gain = calibrated.sources()[0];
    /// assert_eq!(gain.source, ErrorSource::GainRatio);
    /// assert!((0.03 * gain.size - 0.02_f64.ln_1p()).abs() < 4.0 * 0.03 * gain.standard_error);
    /// assert!(gain.standard_error < 0.05);
    /// # Ok::<(), cmod::CmodError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of the `method`.
    pub fn of_ratio(
        method: &(impl RatioMethod + ?Sized),
        lines: &RatioLines<'_>,
    ) -> Result<Option<Self>, CmodError> {
        let experiment = RatioExperiment {
            method,
            lines: *lines,
        };
        found(&experiment.measured(), &experiment)
    }
}

impl CausalEstimate {
    /// Projects the lines of a measured ratio, evaluated by a `method`, onto the relaxing
    /// materials, with the [common errors](RatioLines::common) of the ratio and of the rod. If a
    /// theory of lateral inertia is given, the effect of lateral inertia is removed.
    ///
    /// The lines between the first and the last valid line are used. They include lines that are
    /// not valid, except where the wave is not one-dimensional or the coherence is below its limit.
    /// For a method without a ratio between its lines, such as [`Resonances`](crate::Resonances),
    /// there is no such estimate; project its [moduli](CausalEstimate::new) instead.
    ///
    /// # Errors
    /// The errors of the `method`; [`CmodError::TooFewReadings`] for fewer than three lines;
    /// [`CmodError::NonPhysical`] for variances with 4 degrees of freedom or fewer.
    pub fn of_ratio(
        method: &(impl RatioMethod + ?Sized),
        lines: &RatioLines<'_>,
        lateral_inertia: Option<&LateralInertia>,
    ) -> Result<Self, CmodError> {
        let experiment = RatioExperiment {
            method,
            lines: *lines,
        };
        of_experiment(&experiment, &experiment.measured(), lateral_inertia)
    }
}

struct RatioExperiment<'a, M: ?Sized> {
    method: &'a M,
    lines: RatioLines<'a>,
}

impl<M: RatioMethod + ?Sized> RatioExperiment<'_, M> {
    /// Returns the sources whose errors are removed from the ratio.
    fn measured(&self) -> Vec<ErrorSource> {
        let errors = self.lines.common.iter();
        let mut measured: Vec<ErrorSource> = errors.map(|error| error.source()).collect();
        // an error of the mass changes the ratio like an error of a sensor, but not linearly if it
        // is large
        if !measured.is_empty() && self.method.without_error_of_mass(0.0).is_some() {
            measured.push(ErrorSource::AccelerometerMass);
        }
        measured
    }

    /// Returns the size of the error of the mass in `removed`; this entry follows the errors of the
    /// ratio.
    fn error_of_mass(&self, removed: &[f64]) -> Option<f64> {
        removed.get(self.lines.common.len()).copied()
    }
}

impl<M: RatioMethod + ?Sized> Experiment for RatioExperiment<'_, M> {
    fn added_damping(&self) -> f64 {
        0.0
    }

    fn estimate(&self, removed: &[f64]) -> Result<ModulusEstimate, CmodError> {
        let mut ratio = self.lines.ratio.to_vec();
        for (error, size) in self.lines.common.iter().zip(removed) {
            error.removed(&mut ratio, *size);
        }
        let lines = RatioLines {
            ratio: &ratio,
            ..self.lines
        };
        match self.error_of_mass(removed) {
            None => self.method.estimate_ratio(&lines),
            Some(size) => match self.method.without_error_of_mass(size) {
                Some(method) => method.estimate_ratio(&lines),
                None => Err(CmodError::NonPhysical {
                    quantity: "error of the mass on the free end in standard uncertainties",
                    value: size,
                    expected: "an error no larger than the mass",
                }),
            },
        }
    }

    fn linearised(
        &self,
        line: &ModulusLine,
        gamma: Complex64,
        removed: &[f64],
    ) -> Option<LinearisedLine> {
        let errors = || self.lines.common.iter();
        let factor: Complex64 = errors()
            .zip(removed)
            .filter_map(|(error, size)| Some(-*size * error.relative().get(line.index)?))
            .sum();
        let factor = factor.exp();
        let measured = self.lines.ratio.get(line.index)? * factor;
        let about = match self.error_of_mass(removed) {
            None => self.method.ratio_about(line.frequency_hz, gamma),
            Some(size) => {
                let method = self.method.without_error_of_mass(size)?;
                method.ratio_about(line.frequency_hz, gamma)
            }
        }?;
        let by_ratio = -2.0 * about.modulus / gamma * about.by_ratio;
        let mut shifts = about.shifts;
        shifts.extend(ratio_error::shifts(
            self.lines.common,
            line.index,
            (gamma, about.modulus),
            (about.ratio, about.by_ratio),
        ));
        Some(LinearisedLine {
            modulus: about.modulus + by_ratio * (measured - about.ratio),
            // the variance of the ratio after removal of its common errors; correlated lines carry
            // less information than the same number of independent lines
            variance: self.lines.variance.get(line.index)?
                * factor.norm_sqr()
                * self.lines.lines_per_independent_line.max(1.0)
                * by_ratio.norm_sqr(),
            shifts,
            misfit: None,
        })
    }
}
