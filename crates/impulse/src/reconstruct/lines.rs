//! The sums over sensors at every spectral line.

use faer::Mat;
use num_complex::Complex64;

use super::grid::{Grid, Support, lags, toeplitz};
use super::modes::{Filter, Modes};
use super::outcome::{ExcludedLine, ExclusionReason};
use super::path_errors::PathErrors;
use super::sensor::Sensor;
use super::shifted::Shift;
use super::{FrequencyBand, Penalty};
use crate::ImpulseError;

/// Smallest square with full precision: smaller squares lose digits near the smallest normal
/// number.
const LEAST_POWER: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// Information of the sensors on the force on every line, with weights w.
pub(super) struct WeightedLines {
    pub(super) grid: Grid,
    /// $`\sum_r w_r|H_r|^2`$; 0 on lines that are not used.
    pub(super) power: Vec<f64>,
    /// $`\sum_r w_r H_r^* \hat x_r`$.
    pub(super) cross: Vec<Complex64>,
    /// $`\sum w_r\lvert\hat x_r\rvert^2`$ over sensors and both sides.
    pub(super) energy: f64,
    /// Number of real data.
    pub(super) n_data: f64,
    pub(super) excluded: Vec<ExcludedLine>,
}

/// The sensors with the transforms of their responses.
pub(super) struct Transformed<'a> {
    pub(super) grid: Grid,
    pub(super) sensors: &'a [Sensor<'a>],
    pub(super) responses: Vec<Vec<Complex64>>,
    pub(super) band: Option<FrequencyBand>,
    /// Errors of the frequency responses, for a force on a support.
    pub(super) errors: Option<PathErrors>,
    /// Inverse of the assumed power of the force on each line, if lines are independent.
    pub(super) prior: Option<Vec<f64>>,
    /// The window of the responses, if the frequency responses were measured under one.
    pub(super) shift: Option<Shift>,
}

#[allow(
    clippy::indexing_slicing,
    reason = "`Sensor` accepts only frequency responses with all lines, `line` is an index of these lines, and forces have as many"
)]
impl Transformed<'_> {
    /// Computes the sums, with the errors of the frequency response weighted for a force of this
    /// `power` on every line, if the power is already known.
    pub(super) fn weighted(&self, power: Option<&[f64]>) -> Result<WeightedLines, ImpulseError> {
        let n_lines = self.grid.n_lines();
        let mut lines = WeightedLines {
            grid: self.grid,
            power: vec![0.0; n_lines],
            cross: vec![Complex64::ZERO; n_lines],
            energy: 0.0,
            n_data: 0.0,
            excluded: Vec::new(),
        };
        for line in 0..n_lines {
            if let Some(reason) = self.add(&mut lines, line, power)? {
                lines.excluded.push(ExcludedLine {
                    index: line,
                    frequency_hz: self.grid.frequency_hz(line),
                    reason,
                });
            }
        }
        if lines.excluded.len() == n_lines {
            return Err(ImpulseError::NoUsableLine { n_lines });
        }
        Ok(lines)
    }

    fn add(
        &self,
        lines: &mut WeightedLines,
        line: usize,
        power: Option<&[f64]>,
    ) -> Result<Option<ExclusionReason>, ImpulseError> {
        let is_outside = self.is_outside_band(line);
        let sides = self.grid.sides(line);
        let mut reason = ExclusionReason::LeftOut;
        let mut n_told = 0_usize;
        let sensors = self.sensors.iter().zip(&self.responses);
        for (index, (sensor, response)) in sensors.enumerate() {
            if sensor.is_left_out(line) {
                continue;
            }
            let (h, x) = (sensor.frequency_response[line], response[line]);
            if !h.is_finite() {
                return Err(ImpulseError::NonFinite {
                    what: "frequency response",
                    index: line,
                });
            }
            if is_outside {
                reason = ExclusionReason::OutsideBand;
                continue;
            }
            let weight = weight(sensor, line, power);
            lines.energy += sides * weight * x.norm_sqr();
            lines.n_data += sides;
            let (share, error) = self.errors.as_ref().map_or((1.0, 0.0), |errors| {
                (errors.shares[index][line], sensor.variance_at(line))
            });
            lines.power[line] += weight * share * (h.norm_sqr() - error);
            lines.cross[line] += weight * share * h.conj() * x;
            if share > 0.0 {
                n_told += 1;
            }
            reason = if h.norm_sqr() > 0.0 {
                ExclusionReason::NotResolved
            } else {
                ExclusionReason::VanishingResponse
            };
        }
        if let Some(prior) = &self.prior
            && lines.power[line] > 0.0
        {
            lines.power[line] += prior[line];
        }
        if !(lines.power[line].is_finite() && lines.cross[line].is_finite()) {
            return Err(ImpulseError::SpectrumOverflow { index: line });
        }
        // a significant line is kept even if its own power is small, because the mean over the line
        // and its neighbours is above zero
        let is_told = self.errors.is_some() && n_told > 0;
        if !is_told && lines.power[line] < LEAST_POWER {
            // the digits of the power are lost: the line gives no force
            lines.power[line] = 0.0;
            lines.cross[line] = Complex64::ZERO;
            return Ok(Some(match reason {
                ExclusionReason::NotResolved if self.errors.is_none() => {
                    ExclusionReason::VanishingResponse
                }
                other => other,
            }));
        }
        Ok(None)
    }

    /// Returns the variance of $`\sum_r w_r H_r^*\hat x_r`$ on every line for a force of this
    /// `power`: from the noise of the responses, stated or `unit_noise`, and from the errors of the
    /// frequency responses.
    pub(super) fn cross_variance(
        &self,
        weights_for: Option<&[f64]>,
        power: &[f64],
        unit_noise: f64,
    ) -> Vec<f64> {
        self.cross_variance_of(weights_for, variance_by(power, unit_noise))
    }

    /// Returns the covariance of the sums of [`Self::cross_variance`] over a support, as histories.
    pub(super) fn cross_covariance(
        &self,
        weights_for: Option<&[f64]>,
        power: &[f64],
        unit_noise: f64,
        support: Support,
    ) -> Mat<f64> {
        let Some(shift) = &self.shift else {
            let variance = self.cross_variance(weights_for, power, unit_noise);
            let lags = lags(&variance, self.grid.n_samples, support.length);
            return toeplitz(&lags);
        };
        shift.covariance(&self.noise_filters(weights_for, power, unit_noise), support)
    }

    /// Returns the filters of the errors whose variance is [`Self::cross_variance`].
    pub(super) fn noise_filters(
        &self,
        weights_for: Option<&[f64]>,
        power: &[f64],
        unit_noise: f64,
    ) -> Vec<Vec<Complex64>> {
        self.filters(weights_for, variance_by(power, unit_noise))
    }

    /// Returns for every sensor the filter from white noise of variance N per line to the cross
    /// sums.
    pub(super) fn filters(
        &self,
        weights_for: Option<&[f64]>,
        variance: impl Fn(&Sensor<'_>, usize) -> f64,
    ) -> Vec<Vec<Complex64>> {
        let n_samples = self.grid.n_samples as f64;
        let of_sensor = |(index, sensor): (usize, &Sensor<'_>)| {
            let of_line = |line: usize| {
                let h = sensor.frequency_response[line];
                if !self.uses(sensor, line) || h.norm() == 0.0 {
                    return Complex64::ZERO;
                }
                let gain = self.cross_gain(index, line, weights_for) / h.norm();
                gain * (variance(sensor, line) / n_samples).sqrt() * h.conj()
            };
            (0..self.grid.n_lines()).map(of_line).collect()
        };
        self.sensors.iter().enumerate().map(of_sensor).collect()
    }

    /// Returns the factor from the solution to the force, from sample `first` on: 1 without a
    /// window.
    pub(super) fn growth_from(&self, first: usize) -> impl Iterator<Item = f64> {
        let growth = self.shift.iter().flat_map(move |s| s.growth_from(first));
        let none = self.shift.is_none().then(|| std::iter::repeat(1.0));
        growth.chain(none.into_iter().flatten())
    }

    /// Returns the standard deviation of the cross sums under white noise of standard deviation 1
    /// on all responses, divided by the square root of the number of samples. It is not computed
    /// from squares, which would lose digits for very large or very small weights.
    pub(super) fn white_cross_deviation(&self, weights_for: Option<&[f64]>) -> Vec<f64> {
        let of_line = |line: usize| {
            let gains = self.sensors.iter().enumerate().map(|(index, sensor)| {
                if self.uses(sensor, line) {
                    self.cross_gain(index, line, weights_for)
                } else {
                    0.0
                }
            });
            gains.fold(0.0, f64::hypot)
        };
        (0..self.grid.n_lines()).map(of_line).collect()
    }

    /// Returns the magnitude of the contribution of a unit response of sensor `index` to the cross
    /// sum of a line.
    fn cross_gain(&self, index: usize, line: usize, weights_for: Option<&[f64]>) -> f64 {
        let sensor = &self.sensors[index];
        let errors = self.errors.as_ref();
        let share = errors.map_or(1.0, |errors| errors.shares[index][line]);
        share * weight(sensor, line, weights_for) * sensor.frequency_response[line].norm()
    }

    fn cross_variance_of(
        &self,
        weights_for: Option<&[f64]>,
        variance: impl Fn(&Sensor<'_>, usize) -> f64,
    ) -> Vec<f64> {
        let of_line = |line: usize| -> f64 {
            let used = self.sensors.iter().enumerate();
            used.filter(|(_, sensor)| self.uses(sensor, line))
                .map(|(index, sensor)| {
                    self.cross_gain(index, line, weights_for).powi(2) * variance(sensor, line)
                })
                .sum()
        };
        (0..self.grid.n_lines()).map(of_line).collect()
    }

    /// Returns true if a line of a sensor is used.
    pub(super) fn uses(&self, sensor: &Sensor<'_>, line: usize) -> bool {
        !sensor.is_left_out(line) && !self.is_outside_band(line)
    }

    /// Returns
    /// $`\sum|\hat x - H\hat F|^2/(\mathrm E|\delta\hat x|^2 + \mathrm E|\delta H|^2|\hat F|^2)`$
    /// over the used lines and both sides, with the `power` of the force in the denominator.
    pub(super) fn chi_square(&self, force: &[Complex64], power: &[f64]) -> f64 {
        let sensors = self.sensors.iter().zip(&self.responses);
        let of_sensor = |(sensor, response): (&Sensor<'_>, &Vec<Complex64>)| -> f64 {
            let lines = (0..self.grid.n_lines()).filter(|line| self.uses(sensor, *line));
            lines
                .map(|line| {
                    let missing = response[line] - sensor.frequency_response[line] * force[line];
                    self.grid.sides(line) * weight(sensor, line, Some(power)) * missing.norm_sqr()
                })
                .sum()
        };
        sensors.map(of_sensor).sum()
    }

    /// Returns the power of a force on every line; on a support, the mean over the neighbouring
    /// lines that the support cannot resolve.
    pub(super) fn power_of(&self, force: &[Complex64]) -> Vec<f64> {
        let power: Vec<f64> = force.iter().map(Complex64::norm_sqr).collect();
        match &self.errors {
            Some(errors) => errors.resolved_power(&power),
            None => power,
        }
    }

    fn is_outside_band(&self, line: usize) -> bool {
        let frequency_hz = self.grid.frequency_hz(line);
        self.band.is_some_and(|band| !band.holds(frequency_hz))
    }

    /// Returns ‖x - h*F‖/‖x‖ over all sensors and the included lines of each, by Parseval's
    /// relation.
    pub(super) fn relative_residual(&self, force: &[Complex64]) -> f64 {
        // relative to the largest line, so that no square overflows or underflows
        let lines = self.responses.iter().flatten();
        let largest = lines.fold(0.0_f64, |top, x| top.max(x.norm()));
        let (mut left, mut all) = (0.0, 0.0);
        for (sensor, response) in self.sensors.iter().zip(&self.responses) {
            for (line, x) in response.iter().enumerate() {
                if sensor.is_left_out(line) {
                    continue;
                }
                let missing = x - sensor.frequency_response[line] * force[line];
                left += self.grid.sides(line) * (missing / largest).norm_sqr();
                all += self.grid.sides(line) * (x / largest).norm_sqr();
            }
        }
        if all > 0.0 { (left / all).sqrt() } else { 0.0 }
    }
}

/// Returns the variance of the response of a sensor on a line for a force of this `power`: the
/// noise (`unit_noise` if unknown) plus the effect of the error of H.
#[allow(
    clippy::indexing_slicing,
    reason = "forces have all lines, and `line` is the index of a line"
)]
fn variance_by(power: &[f64], unit_noise: f64) -> impl Fn(&Sensor<'_>, usize) -> f64 {
    move |sensor, line| {
        let noise = sensor.noise_at(line).unwrap_or(unit_noise);
        noise + sensor.variance_at(line) * power[line]
    }
}

/// Returns $`1/(\mathrm{E}|\delta x|^2 + \mathrm{E}|\delta H|^2|F|^2)`$, or 1 if the noise is not
/// known.
#[allow(
    clippy::indexing_slicing,
    reason = "a force has all lines of the grid, and `line` is the index of a line"
)]
pub(super) fn weight(sensor: &Sensor<'_>, line: usize, power: Option<&[f64]>) -> f64 {
    sensor.noise_at(line).map_or(1.0, |noise| {
        let power = power.map_or(0.0, |power| power[line]);
        1.0 / (noise + sensor.variance_at(line) * power)
    })
}

impl WeightedLines {
    /// Returns the modes, with every used line as a component.
    pub(super) fn modes(&self, penalty: Penalty) -> Modes {
        let mut modes = Modes {
            strengths: Vec::new(),
            energies: Vec::new(),
            dimensions: Vec::new(),
            unexplained: 0.0,
            n_data: self.n_data,
        };
        let mut explained = 0.0;
        for (line, (power, cross)) in self.power.iter().zip(&self.cross).enumerate() {
            if *power > 0.0 {
                let sides = self.grid.sides(line);
                let energy = sides * cross.norm_sqr() / power;
                explained += energy;
                modes
                    .strengths
                    .push(power / penalty.weight(self.grid.omega(line)));
                modes.energies.push(energy);
                modes.dimensions.push(sides);
            }
        }
        modes.unexplained = self.unexplained(explained);
        modes
    }

    /// Returns the unexplained energy of the responses; a difference at the rounding of its terms
    /// counts as zero.
    pub(super) fn unexplained(&self, explained: f64) -> f64 {
        let rest = self.energy - explained;
        if rest > self.n_data.sqrt() * f64::EPSILON * self.energy {
            rest
        } else {
            0.0
        }
    }

    /// Gain $`\varphi/\sum w|H|^2`$ from the cross sums to the force, on every line.
    pub(super) fn gains(&self, filter: Filter, penalty: Penalty, parameter: f64) -> Vec<f64> {
        let lines = self.power.iter().enumerate();
        lines
            .map(|(line, power)| {
                if *power > 0.0 {
                    let strength = power / penalty.weight(self.grid.omega(line));
                    filter.kept(strength, parameter) / power
                } else {
                    0.0
                }
            })
            .collect()
    }

    /// $`(1-\varphi)^2/(\lambda\omega^{2p})`$ of every line: variance of the part lost by
    /// regularisation, for noise of weighted variance 1.
    pub(super) fn lost(&self, filter: Filter, penalty: Penalty, parameter: f64) -> Vec<f64> {
        let lines = self.power.iter().enumerate();
        lines
            .map(|(line, power)| {
                let weight = penalty.weight(self.grid.omega(line));
                if *power > 0.0 && weight > 0.0 && filter != Filter::None {
                    filter.lost(power / weight, parameter).powi(2) / (parameter * weight)
                } else {
                    0.0
                }
            })
            .collect()
    }
}
