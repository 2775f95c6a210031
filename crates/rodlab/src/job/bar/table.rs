//! Table of the propagation coefficient of the bar on each line, with its covariance.

use cmod::ModulusLine;
use cmod::estimate::{ComplexCovariance, coverage_factor};
use num_complex::Complex64;

use super::BarSheet;
use crate::digits::{hertz, with_unit};
use crate::job::modulus::Found;
use crate::outcome::{Rows, Table};
use crate::{InStep, RodlabError};

/// Probability of the bands.
const LEVEL: f64 = 0.95;

/// Propagation of the measured waves on a line. It includes the effect of lateral inertia, for
/// which the modulus is corrected.
pub(super) struct Line {
    pub(super) frequency_hz: f64,
    /// $`\gamma = \alpha + ik`$ [1/m].
    pub(super) gamma: Complex64,
    covariance: ComplexCovariance,
    degrees_of_freedom: Option<f64>,
    pub(super) is_valid: bool,
}

impl Line {
    pub(super) fn omega(&self) -> f64 {
        std::f64::consts::TAU * self.frequency_hz
    }

    pub(super) fn phase_velocity(&self) -> f64 {
        self.omega() / self.gamma.im
    }

    /// Half widths of the 95 % bands of α [1/m], k [rad/m] and c [m/s].
    pub(super) fn half_widths(&self) -> Result<[f64; 3], RodlabError> {
        let factor = coverage_factor(LEVEL, self.degrees_of_freedom)
            .in_step("bands of the propagation coefficient")?;
        let [damping, wave_number] =
            [self.covariance.real, self.covariance.imaginary].map(|v| factor * v.sqrt());
        let speed = self.phase_velocity() * wave_number / self.gamma.im;
        Ok([damping, wave_number, speed])
    }
}

pub(super) fn lines(found: &Found<'_>, sheet: &BarSheet) -> Vec<Line> {
    let density = sheet.bar.density.with_uncertainty().value;
    let corrections = found.corrected.map(|corrected| corrected.corrections());
    let of = |(at, line): (usize, &ModulusLine)| {
        let gamma = line.propagation_coefficient;
        let correction = corrections.and_then(|all| all.get(at));
        // the measured wave: gamma^2 = -rho omega^2/E with the apparent modulus
        let measured = correction.map_or(gamma, |correction| {
            let omega = std::f64::consts::TAU * line.frequency_hz;
            Complex64::new(0.0, omega) * (density / correction.apparent_modulus).sqrt()
        });
        let covariance = line.uncertainty.total_covariance().propagation_coefficient;
        Line {
            frequency_hz: line.frequency_hz,
            gamma: measured,
            covariance: covariance.through(measured / gamma),
            degrees_of_freedom: line.uncertainty.degrees_of_freedom,
            is_valid: line.validity.is_valid(),
        }
    };
    found.estimate.lines().iter().enumerate().map(of).collect()
}

pub(super) fn of(lines: &[Line]) -> Result<Table, RodlabError> {
    let widths = lines.iter().map(Line::half_widths);
    let rows = lines.iter().zip(widths.collect::<Result<Vec<_>, _>>()?);
    let rows: Vec<(&Line, [f64; 3])> = rows.collect();
    let half = |name: &str| format!("95 % half width of the {name}");
    let mixed = "covariance of damping coefficient and wave number";
    let rows = Rows::of(&rows, "propagation", "Propagation coefficient of the bar")
        .number("frequency", "Hz", |(l, _)| l.frequency_hz)
        .number("damping coefficient", "1/m", |(l, _)| l.gamma.re)
        .number(half("damping coefficient"), "1/m", |(_, [of, ..])| *of)
        .number("wave number", "rad/m", |(l, _)| l.gamma.im)
        .number(half("wave number"), "rad/m", |(_, [_, of, _])| *of)
        .number("variance of the damping coefficient", "1/m^2", |(l, _)| {
            l.covariance.real
        })
        .number("variance of the wave number", "1/m^2", |(l, _)| {
            l.covariance.imaginary
        })
        .number(mixed, "1/m^2", |(l, _)| l.covariance.mixed)
        .number("phase velocity", "m/s", |(l, _)| l.phase_velocity())
        .number(half("phase velocity"), "m/s", |(_, [.., of])| *of)
        .validity(
            |(l, _)| l.is_valid,
            |(l, _)| if l.is_valid { "valid" } else { "not valid" }.to_owned(),
        );
    Ok(rows.table)
}

/// Returns a sentence about the line in the middle of the valid lines.
pub(super) fn in_words(lines: &[Line]) -> Result<Option<String>, RodlabError> {
    let valid: Vec<&Line> = lines.iter().filter(|line| line.is_valid).collect();
    let Some(line) = valid.get(valid.len() / 2) else {
        return Ok(None);
    };
    let [damping, _, speed] = line.half_widths()?;
    Ok(Some(format!(
        "Waves at {} travel at {} and have a damping coefficient of {} (95 % intervals).",
        hertz(line.frequency_hz),
        with_unit(line.phase_velocity(), Some(speed), "m/s"),
        with_unit(line.gamma.re, Some(damping), "1/m")
    )))
}
