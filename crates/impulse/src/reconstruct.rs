//! Reconstruction of the force that caused a measured motion of a known body.
//!
//! Theory: `docs/theory/force-reconstruction.md`.

mod blow_span;
mod calibration_scatter;
mod choice;
mod grid;
mod lines;
mod mean_blow;
mod modes;
mod non_negative;
mod options;
mod outcome;
mod path_errors;
mod profile;
mod sensor;
mod shifted;
mod solution;
mod support;
mod supposed;

use num_complex::Complex64;

use self::grid::{Grid, Support};
use self::lines::Transformed;
use self::modes::Filter;
use self::path_errors::PathErrors;
use self::profile::Constrained;
use self::shifted::Shift;
use self::solution::{Gain, Solved};
use self::support::SupportProblem;
use crate::error::{check_interval, check_length, check_positive};
use crate::{ForceHistory, ImpulseError, fourier};

pub use blow_span::BlowSpan;
pub use calibration_scatter::{CalibrationBlow, CalibrationLines, CalibrationScatter};
pub use options::{FrequencyBand, Parameter, Penalty, Regularisation, TimeInterval};
pub use outcome::{
    ChoiceVerdict, ChosenParameter, CurvePoint, ExcludedLine, ExclusionReason, NonNegativity,
    PivotingEnd, ProfileInterval, RandomErrorOfForce, ReconstructedForce, ResponseEnd,
};
pub use sensor::{ResponseNoise, Sensor};

/// Fewest degrees of freedom for an estimate of the noise: its standard deviation is then known to
/// 16 %.
const FEWEST_DEGREES_OF_FREEDOM: f64 = 20.0;

/// Reconstruction of a force from measured responses $`x_r`$ and known frequency responses $`H_r =
/// \hat x_r/\hat F`$: the inverse use of the impulse response.
///
/// The force minimises the following sum over lines k, of both signs of the frequency, and sensors
/// r:
///
/// ```math
/// \sum_k\sum_r w_{rk}\lvert\hat x_{rk} - H_{rk}\hat F_k\rvert^2 + \lambda\sum_k\omega_k^{2p}\lvert\hat F_k\rvert^2 ,
/// \qquad w_{rk} = \frac{1}{\mathrm E\lvert\delta\hat x_{rk}\rvert^2 + \mathrm E\lvert\delta H_{rk}\rvert^2\lvert\hat F_k\rvert^2} ,
/// ```
///
/// with $`w = 1`$ if the noise is not known. The force in the weights is that of a previous pass;
/// the first pass neglects the errors of H or, on a support, assumes a power of the force. Without
/// a support all lines are independent; on a support (at most 2048 samples) the equations are
/// dense.
///
/// # Validity
///
/// The body is linear, and only the force moves it. The record must contain the whole response: the
/// convolution is periodic, and a truncated end appears as a force all over the record
/// ([`ReconstructedForce::response_end`]). A sampled force that passed an anti-alias filter has
/// overshoots before and after it: the support must include them, and their tension must be
/// allowed.
///
/// # Examples
///
/// ```
/// use impulse::Reconstruction;
/// use num_complex::Complex64;
///
/// # fn main() -> Result<(), impulse::ImpulseError> {
/// // a body whose response halves from sample to sample: x_n = x_{n-1}/2 + F_n
/// let force = [0.0, 0.0, 1.0, 3.0, 1.0];
/// let mut response = vec![0.0; 64];
/// for n in 1..response.len() {
///     response[n] = 0.5 * response[n - 1] + force.get(n).unwrap_or(&0.0);
/// }
/// let turn = |k: usize| Complex64::cis(-2.0 * std::f64::consts::PI * k as f64 / 64.0);
/// let frequency_response: Vec<_> = (0..=32).map(|k| 1.0 / (1.0 - 0.5 * turn(k))).collect();
///
/// let found = Reconstruction::new(&response, 1000.0, &frequency_response)?.solve()?;
/// assert!((found.history.peak().force - 3.0).abs() < 1e-12);
/// assert!(found.relative_residual < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Reconstruction<'a> {
    sensors: Vec<Sensor<'a>>,
    sampling_rate_hz: f64,
    regularisation: Regularisation,
    band: Option<FrequencyBand>,
    support: Option<TimeInterval>,
    is_non_negative: bool,
    blows: Option<&'a CalibrationLines>,
    decay_rate: Option<f64>,
}

impl<'a> Reconstruction<'a> {
    /// Creates a reconstruction from one response of unknown noise: a plain division over all
    /// lines, which the methods below restrict.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the sampling rate; the errors of [`Sensor::new`].
    pub fn new(
        response: &'a [f64],
        sampling_rate_hz: f64,
        frequency_response: &'a [Complex64],
    ) -> Result<Self, ImpulseError> {
        Self::of_sensors(
            vec![Sensor::new(response, frequency_response)?],
            sampling_rate_hz,
        )
    }

    /// Creates a reconstruction from several responses to one force, recorded together.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the sampling rate; [`ImpulseError::TooShort`] without a
    /// sensor, [`ImpulseError::LengthMismatch`] for responses of different length;
    /// [`ImpulseError::MixedNoise`] if the noise is known for some sensors, but not for all.
    pub fn of_sensors(
        sensors: Vec<Sensor<'a>>,
        sampling_rate_hz: f64,
    ) -> Result<Self, ImpulseError> {
        check_positive("sampling rate [Hz]", sampling_rate_hz)?;
        let Some(first) = sensors.first() else {
            return Err(ImpulseError::TooShort {
                what: "set of sensors",
                found: 0,
                expected: 1,
            });
        };
        for (index, sensor) in sensors.iter().enumerate() {
            check_length("response", sensor.response.len(), first.response.len())?;
            if sensor.noise_at(0).is_some() != first.noise_at(0).is_some() {
                return Err(ImpulseError::MixedNoise { index });
            }
        }
        Ok(Self {
            sensors,
            sampling_rate_hz,
            regularisation: Regularisation::None,
            band: None,
            support: None,
            is_non_negative: false,
            blows: None,
            decay_rate: None,
        })
    }

    /// Sets the regularisation.
    #[must_use]
    pub fn with_regularisation(self, regularisation: Regularisation) -> Self {
        Self {
            regularisation,
            ..self
        }
    }

    /// Restricts the lines to `band`.
    #[must_use]
    pub fn within(self, band: FrequencyBand) -> Self {
        Self {
            band: Some(band),
            ..self
        }
    }

    /// Excludes lines of all sensors, for example those with unknown frequency response. Their
    /// values are not read.
    #[must_use]
    pub fn without_lines(mut self, lines: impl IntoIterator<Item = usize>) -> Self {
        let lines: Vec<usize> = lines.into_iter().collect();
        for sensor in &mut self.sensors {
            sensor.left_out.extend(&lines);
        }
        self
    }

    /// Restricts the force to `support`: components unknown on some lines, such as the mean, then
    /// follow from the other lines.
    #[must_use]
    pub fn acting_during(self, support: TimeInterval) -> Self {
        Self {
            support: Some(support),
            ..self
        }
    }

    /// Assumes a force like the calibration blows `blows`, with a time and an energy of its own.
    /// The undetermined components are assumed to scatter with the mean power of the blows, on a
    /// support about those of the mean blow, without a support about zero. Without this assumption
    /// a force beyond the band of the hammer is unbounded. The assumption is used only if the noise
    /// is known.
    #[must_use]
    pub fn like_blows(self, blows: &'a CalibrationLines) -> Self {
        Self {
            blows: Some(blows),
            ..self
        }
    }

    /// Sets the exponential window $`e^{-\sigma t}`$ under which the frequency responses were
    /// measured, with `decay_rate` $`\sigma`$ \[1/s\], on force and response from the first sample
    /// on: their lines are $`H(\sigma + i\omega)`$. The responses are given without the window.
    /// Stated noise of lines, variances of frequency responses and calibration lines are those of
    /// windowed histories; white noise is stated for the response as given.
    ///
    /// The method is exact:
    /// $`\hat x(\sigma + i\omega) = H(\sigma + i\omega)\hat F(\sigma + i\omega)`$; the solution
    /// multiplied by $`e^{\sigma t}`$ is the force. Its error grows by the same factor and is
    /// smallest early in the record. A regularised force then needs a support.
    #[must_use]
    pub fn with_added_damping(self, decay_rate: f64) -> Self {
        Self {
            decay_rate: Some(decay_rate),
            ..self
        }
    }

    /// Forbids tension. Needs a support.
    #[must_use]
    pub fn non_negative(self) -> Self {
        Self {
            is_non_negative: true,
            ..self
        }
    }

    /// Computes the force.
    ///
    /// # Errors
    ///
    /// - [`ImpulseError::NonPhysical`] for a given parameter, or the decay rate of an exponential
    ///   window; [`ImpulseError::EmptyInterval`] for band or support;
    ///   [`ImpulseError::SupportOutsideRecord`], [`ImpulseError::SupportTooLong`];
    ///   [`ImpulseError::UnknownLine`] for an excluded line.
    /// - [`ImpulseError::NoiseNotKnown`] for the discrepancy principle without noise;
    ///   [`ImpulseError::NoSupport`] and [`ImpulseError::TruncatedWithoutTension`] for a force
    ///   without tension.
    /// - [`ImpulseError::NonFinite`] for a frequency response that is not excluded.
    /// - [`ImpulseError::SpectrumOverflow`]; [`ImpulseError::NoUsableLine`];
    ///   [`ImpulseError::NoDecomposition`].
    pub fn solve(&self) -> Result<ReconstructedForce, ImpulseError> {
        self.check()?;
        let grid = self.grid();
        let Some(decay_rate) = self.decay_rate else {
            return self.solve_on(grid, None);
        };
        let shift = Shift::of(decay_rate, grid)?;
        let sensors = self.sensors.iter();
        let windowed: Vec<Vec<f64>> = sensors
            .map(|sensor| shift.windowed(sensor.response))
            .collect();
        let sensors = self.sensors.iter().zip(&windowed);
        let sensors = sensors.map(|(sensor, response)| sensor.windowed(response, &shift));
        let on_line = Reconstruction {
            sensors: sensors.collect(),
            ..self.clone()
        };
        on_line.solve_on(grid, Some(shift))
    }

    fn grid(&self) -> Grid {
        Grid {
            n_samples: self.sensors.first().map_or(0, |s| s.response.len()),
            sampling_rate_hz: self.sampling_rate_hz,
        }
    }

    /// Computes the force from responses that already have the window of `shift`.
    fn solve_on(
        &self,
        grid: Grid,
        shift: Option<Shift>,
    ) -> Result<ReconstructedForce, ImpulseError> {
        let n_samples = grid.n_samples;
        let support = self
            .support
            .map(|interval| Support::of(interval, n_samples, self.sampling_rate_hz))
            .transpose()?;
        let responses = self.sensors.iter();
        let mut transformed = Transformed {
            grid,
            sensors: &self.sensors,
            responses: responses
                .map(|sensor| fourier::to_spectrum(sensor.response))
                .collect(),
            band: self.band,
            errors: None,
            prior: None,
            shift,
        };
        let has_variance = self.sensors.iter().any(|s| s.variance.is_some());
        let noise_is_known = self.noise_is_known();
        match (support, self.blows) {
            (Some(support), blows) => {
                transformed.errors = PathErrors::of(
                    &transformed,
                    support.length,
                    blows.map(|blows| blows.power.as_slice()),
                );
            }
            (None, Some(blows)) if noise_is_known => {
                transformed.prior = Some(path_errors::of_lines(&transformed, &blows.power));
            }
            _ => {}
        }
        let passes = match (has_variance && noise_is_known, &transformed.errors) {
            (false, _) => 0,
            (true, None) => 1,
            // the weights of the first pass are too large where there is force
            (true, Some(_)) => 2,
        };
        let mut weights_for = transformed.errors.as_ref().map(PathErrors::assumed_power);
        let mut solved = self.solve_weighted(&transformed, support, weights_for.as_deref())?;
        for _ in 0..passes {
            let power = transformed.power_of(&fourier::to_spectrum(&solved.samples));
            solved = self.solve_weighted(&transformed, support, Some(&power))?;
            weights_for = Some(power);
        }
        self.report(&transformed, solved, weights_for.as_deref())
    }

    fn noise_is_known(&self) -> bool {
        self.sensors.iter().all(|s| s.noise_at(0).is_some())
    }

    fn check(&self) -> Result<(), ImpulseError> {
        if let Some(FrequencyBand { from_hz, to_hz }) = self.band {
            check_interval("frequency band [Hz]", from_hz, to_hz)?;
        }
        if let Some(TimeInterval { from, to }) = self.support {
            check_interval("support of the force [s]", from, to)?;
        }
        for sensor in &self.sensors {
            let n_lines = sensor.frequency_response.len();
            if let Some(blows) = self.blows {
                for (what, found) in [
                    ("power of calibration blows", blows.power.len()),
                    ("mean calibration blow", blows.mean_blow.len()),
                ] {
                    check_length(what, found, n_lines)?;
                }
                crate::error::check_samples("power of calibration blows", &blows.power)?;
            }
            if let Some(&index) = sensor.left_out.last()
                && index >= n_lines
            {
                return Err(ImpulseError::UnknownLine { index, n_lines });
            }
        }
        if let Regularisation::Tikhonov { penalty, .. } = self.regularisation {
            let grid = self.grid();
            let last = grid.n_lines() - 1;
            if ![1, last]
                .map(|line| penalty.weight(grid.omega(line)))
                .iter()
                .all(|w| w.is_normal())
            {
                return Err(ImpulseError::OutOfRange {
                    what: "penalty, a power of the sampling rate,",
                });
            }
        }
        if self.decay_rate.is_some()
            && self.support.is_none()
            && self.regularisation != Regularisation::None
        {
            return Err(ImpulseError::NoSupport {
                what: "a regularised force from a response under an exponential window",
            });
        }
        if self.is_non_negative {
            if self.support.is_none() {
                return Err(ImpulseError::NoSupport {
                    what: "a force without tension",
                });
            }
            if let Regularisation::Truncated { .. } = self.regularisation {
                return Err(ImpulseError::TruncatedWithoutTension);
            }
        }
        Ok(())
    }

    fn penalty(&self) -> Penalty {
        match self.regularisation {
            Regularisation::Tikhonov { penalty, .. } => penalty,
            Regularisation::None | Regularisation::Truncated { .. } => Penalty::Size,
        }
    }

    fn solve_weighted(
        &self,
        transformed: &Transformed<'_>,
        support: Option<Support>,
        weights_for: Option<&[f64]>,
    ) -> Result<Solved, ImpulseError> {
        let lines = transformed.weighted(weights_for)?;
        let filter = Filter::of(self.regularisation);
        let n_samples = lines.grid.n_samples;
        let time_step = 1.0 / self.sampling_rate_hz;
        let Some(support) = support else {
            let modes = lines.modes(self.penalty());
            let parameter = choice::choose(&modes, self.regularisation, self.noise_is_known())?;
            let value = parameter.as_ref().map_or(0.0, |p| p.value);
            let gains = lines.gains(filter, self.penalty(), value);
            let force: Vec<Complex64> = gains
                .iter()
                .zip(&lines.cross)
                .map(|(gain, cross)| *gain * cross / n_samples as f64)
                .collect();
            if let Some(index) = force.iter().position(|f| !f.is_finite()) {
                return Err(ImpulseError::SpectrumOverflow { index });
            }
            let lost = lines.lost(filter, self.penalty(), value);
            let mean = lines.power.first().zip(force.first());
            return Ok(Solved {
                // not computed under a window: the impulse would depend on all lines, and on the
                // noise at the end of the record, which is amplified when the window is undone
                impulse: mean
                    .filter(|(power, _)| **power > 0.0 && transformed.shift.is_none())
                    .map(|(_, mean)| mean.re * n_samples as f64 * time_step),
                bias: None,
                samples: fourier::to_samples(&force, n_samples),
                parameter,
                modes,
                lines,
                gain: Gain::Lines { gains, lost },
                non_negativity: None,
                constrained: None,
                n_silent: 0,
            });
        };
        // errors of the frequency responses require an assumed force
        let errors = transformed.errors.as_ref().zip(weights_for);
        let covariance = errors.map(|(errors, power)| {
            (
                errors,
                transformed.cross_covariance(weights_for, power, 0.0, support),
            )
        });
        let errors = covariance.as_ref().map(|(errors, v)| (*errors, v));
        let mut problem = SupportProblem::new(&lines, support, self.penalty(), errors, self.blows)?;
        let in_record = |on_support: &[f64]| {
            let mut samples = vec![0.0; n_samples];
            for (sample, force) in samples.iter_mut().skip(support.first).zip(on_support) {
                *sample = *force;
            }
            samples
        };
        let by = |problem: &SupportProblem, gain: &faer::Mat<f64>| -> Vec<f64> {
            let row = |i: usize| {
                problem
                    .right_side
                    .iter()
                    .enumerate()
                    .map(move |(j, b)| gain[(i, j)] * b)
            };
            (0..support.length).map(|i| row(i).sum()).collect()
        };
        let inverse = problem
            .informed
            .is_some()
            .then(|| problem.inverse(Filter::None, 0.0));
        let plain = inverse.as_ref().map(|inverse| by(&problem, inverse));
        if let Some(plain) = &plain {
            // the informed sums are not sums of squares of the responses: the unexplained part is
            // computed from the force without regularisation
            let force = fourier::to_spectrum(&in_record(plain));
            problem.modes.unexplained =
                transformed.chi_square(&force, &transformed.power_of(&force));
        }
        let parameter = choice::choose(&problem.modes, self.regularisation, self.noise_is_known())?;
        let value = parameter.as_ref().map_or(0.0, |p| p.value);
        let gain = problem.inverse(filter, value);
        let on_support = by(&problem, &gain);
        let growth = transformed.growth_from(support.first);
        let grown = on_support.iter().zip(growth).map(|(f, growth)| f * growth);
        let impulse = time_step * grown.sum::<f64>();
        let bias = plain.map(|plain| {
            let pairs = on_support.iter().zip(&plain);
            in_record(&pairs.map(|(with, plain)| with - plain).collect::<Vec<_>>())
        });
        let mut constrained = None;
        let (on_support, non_negativity) = if self.is_non_negative {
            let matrix = problem.regularised(filter, value);
            let (force, report) = non_negative::minimise(&matrix, &problem.right_side, &on_support);
            if report.end == PivotingEnd::Converged {
                constrained = Some(Constrained {
                    matrix,
                    right_side: problem.right_side.clone(),
                    force: force.clone(),
                });
            }
            (force, Some(report))
        } else {
            (on_support, None)
        };
        Ok(Solved {
            impulse: Some(impulse),
            bias,
            samples: in_record(&on_support),
            parameter,
            n_silent: problem.n_silent(),
            gain: Gain::Support {
                support,
                gain,
                plain: inverse,
                lost: problem.lost(filter, value),
                quadratic: problem.quadratic,
                informed: problem.informed,
            },
            modes: problem.modes,
            lines,
            non_negativity,
            constrained,
        })
    }

    fn report(
        &self,
        transformed: &Transformed<'_>,
        mut solved: Solved,
        weights_for: Option<&[f64]>,
    ) -> Result<ReconstructedForce, ImpulseError> {
        let n_samples = transformed.grid.n_samples;
        let force = fourier::to_spectrum(&solved.samples);
        let power = transformed.power_of(&force);
        let filter = Filter::of(self.regularisation);
        let value = solved.parameter.as_ref().map_or(0.0, |p| p.value);
        let point = solved.modes.point(filter, value);
        let freedom_left = solved
            .freedom_left(transformed, (weights_for, &power))
            .unwrap_or(point.freedom_left);
        let per_freedom = (freedom_left >= FEWEST_DEGREES_OF_FREEDOM)
            .then(|| point.squared_residual / freedom_left);
        let bias = solved.bias.take().unwrap_or_else(|| solved.bias());
        let error_for =
            |unit_noise: f64| solved.error(transformed, (weights_for, &power), unit_noise, &bias);
        let error = match (self.noise_is_known(), per_freedom) {
            (true, _) => RandomErrorOfForce::Stated(error_for(0.0)?),
            (false, Some(noise)) if noise > 0.0 => RandomErrorOfForce::Estimated {
                error: error_for(noise)?,
                standard_deviation: (noise
                    / transformed.shift.as_ref().map_or(1.0, Shift::mean_square)
                    / n_samples as f64)
                    .sqrt(),
            },
            (false, _) => RandomErrorOfForce::NoiseNotKnown,
        };
        let noise = match (self.noise_is_known(), per_freedom) {
            (true, _) => Some(1.0),
            (false, noise) => noise.filter(|noise| *noise > 0.0),
        };
        let peak_interval = noise.and_then(|noise| solved.peak_interval(transformed, noise, &bias));
        let noise_gain = solved.noise_gain(transformed, weights_for);
        let response_end = self
            .sensors
            .iter()
            .map(|sensor| ResponseEnd::of(sensor.response))
            .fold(ResponseEnd::DiedOut, ResponseEnd::worse);
        let grown = |samples: &[f64]| -> Vec<f64> {
            let pairs = samples.iter().zip(transformed.growth_from(0));
            pairs.map(|(x, growth)| x * growth).collect()
        };
        Ok(ReconstructedForce {
            regularisation: self.regularisation,
            impulse: solved.impulse,
            regularisation_bias: grown(&bias),
            relative_residual: transformed.relative_residual(&force),
            reduced_chi_square: per_freedom.filter(|_| self.noise_is_known()),
            noise_gain,
            error,
            history: ForceHistory::new(0.0, 1.0 / self.sampling_rate_hz, grown(&solved.samples))?,
            parameter: solved.parameter,
            excluded: solved.lines.excluded,
            silent_components: solved.n_silent,
            non_negativity: solved.non_negativity,
            peak_interval,
            response_end,
        })
    }
}

#[cfg(test)]
mod tests;
