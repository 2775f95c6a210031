//! Errors of a master curve due to errors of the temperatures.

use super::super::parameter::{CommonShift, Interval, Parameter};
use super::super::shift_law::{UNBOUNDED, Wlf};
use super::MasterCurve;
use crate::error::{CmodError, check_positive};
use crate::estimate::ErrorSource;
use crate::vectors::add_square;

/// Beginning of the names of the relaxation times of a series.
const TIMES: &str = "relaxation time";

impl MasterCurve {
    /// Adds the errors due to temperatures that are independent of each other and have the standard
    /// uncertainty `kelvin` \[K\], such as the uncertainty of a reading of a temperature chamber.
    ///
    /// With s = d ln a_T/dT, by WLF through the shifts, a temperature that is wrong by δ changes
    /// its own ln a_T by s δ. An error δ of the reference temperature changes all other ln a_T by
    /// -s δ, and the logarithms of the relaxation times of the series by s δ. The fit of the
    /// reduced lines to each other does not depend on the stated temperatures; an error of the
    /// reference temperature shifts all reduced lines by the same amount.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless `kelvin` is above 0; the errors of [`Self::shift_laws`].
    pub fn with_temperature_uncertainty(mut self, kelvin: f64) -> Result<Self, CmodError> {
        check_positive("standard uncertainty of the temperatures [K]", kelvin)?;
        let wlf = self.law_of_slopes()?;
        let reference = self.reference_temperature;
        let parameters = self.fit.parameters.len();
        let of_reference = kelvin * slope(&wlf, reference)?;
        let is_fitted = |shift: &super::Shift| {
            shift.temperature.total_cmp(&reference).is_ne() && !shift.is_stated
        };
        let mut own = Vec::with_capacity(self.shifts.len());
        for shift in self.shifts.iter_mut().filter(|shift| is_fitted(shift)) {
            let of_shift = kelvin * slope(&wlf, shift.temperature)?;
            let (before, error) = (shift.standard_error, of_shift.hypot(of_reference));
            let end = |side: f64| wider(side, before, error);
            shift.standard_error = before.hypot(error);
            shift.interval = Interval {
                lower: shift.log_shift - end(shift.log_shift - shift.interval.lower),
                upper: shift.log_shift + end(shift.interval.upper - shift.log_shift),
                ..shift.interval
            };
            own.push(of_shift);
        }
        let first = parameters.saturating_sub(own.len());
        let on_series = |parameter: &Parameter| match parameter.name.starts_with(TIMES) {
            true => of_reference,
            false => 0.0,
        };
        let series = self.fit.parameters.iter().take(first);
        let mut by_reference: Vec<f64> = series.map(on_series).collect();
        by_reference.resize(parameters, -of_reference);
        self.add(by_reference);
        for (place, of_shift) in (first..).zip(own) {
            let alone = |index| if index == place { of_shift } else { 0.0 };
            self.add((0..parameters).map(alone).collect());
        }
        Ok(self)
    }

    /// Returns the standard uncertainty of the temperatures \[K\] that would by itself explain the
    /// scatter of the shifts about WLF. It is meaningful only if the shifts differ from WLF by more
    /// than their errors.
    ///
    /// # Errors
    /// The errors of [`Self::shift_laws_by_scatter`].
    pub fn temperature_scatter(&self) -> Result<f64, CmodError> {
        let laws = self.shift_laws_by_scatter()?;
        let reference = slope(&laws.wlf, self.reference_temperature)?;
        let mut squares = (0.0, 0.0);
        for shift in self.shifts.iter().filter(|shift| !shift.is_stated) {
            let (Some((law, _)), true) = (
                laws.wlf.log_shift(shift.temperature),
                shift
                    .temperature
                    .total_cmp(&self.reference_temperature)
                    .is_ne(),
            ) else {
                continue;
            };
            squares.0 += (shift.log_shift - law).powi(2);
            squares.1 += slope(&laws.wlf, shift.temperature)?.powi(2) + reference.powi(2);
        }
        Ok((squares.0 / squares.1).sqrt())
    }

    /// Returns the law from which slopes are computed: WLF fitted by the scatter of the shifts; if
    /// there are too few shifts for this, WLF fitted with the errors of the shifts, or, if there
    /// are only two shifts, the straight line through them.
    fn law_of_slopes(&self) -> Result<Wlf, CmodError> {
        let laws = self.shift_laws_by_scatter().or_else(|_| self.shift_laws());
        match (laws, self.shifts.as_slice()) {
            (Ok(laws), _) => Ok(laws.wlf),
            (Err(_), [a, b]) => Ok(Wlf {
                reference_temperature: self.reference_temperature,
                c1: f64::INFINITY,
                c2: f64::INFINITY,
                c1_standard_error: f64::INFINITY,
                c2_standard_error: f64::INFINITY,
                c1_interval: UNBOUNDED,
                c2_interval: UNBOUNDED,
                slope: -(b.log_shift - a.log_shift) / (b.temperature - a.temperature),
                curvature: 0.0,
                covariance: [[f64::INFINITY; 2]; 2],
                chi_squared: 0.0,
                degrees_of_freedom: 0,
            }),
            (Err(error), _) => Err(error),
        }
    }

    /// Adds the changes of all parameters due to an error of one temperature to the common errors.
    fn add(&mut self, shift: Vec<f64>) {
        for (parameter, change) in self.fit.parameters.iter_mut().zip(&shift) {
            let before = parameter.standard_error;
            parameter.common_error = parameter.common_error.hypot(*change);
            parameter.standard_error = before.hypot(*change);
            if *change == 0.0 {
                continue;
            }
            let at = parameter.scale.coordinate(parameter.value);
            let below = at - parameter.scale.coordinate(parameter.interval.lower);
            let above = parameter.scale.coordinate(parameter.interval.upper) - at;
            parameter.interval = Interval {
                lower: parameter.scale.value(at - wider(below, before, *change)),
                upper: parameter.scale.value(at + wider(above, before, *change)),
                ..parameter.interval
            };
        }
        if let Some(covariance) = &mut self.fit.covariance {
            add_square(covariance, 1.0, &shift);
        }
        self.fit.common_errors.push(CommonShift {
            source: ErrorSource::Temperature,
            shift,
        });
    }

    /// Returns the change of ln ω of all reduced lines if the reference temperature is wrong by its
    /// uncertainty.
    pub(super) fn change_by_reference(&self) -> f64 {
        let times = self.fit.parameters.iter();
        let time = times
            .enumerate()
            .find(|(_, parameter)| parameter.name.starts_with(TIMES));
        let of_time = |(index, _): (usize, _)| {
            let errors = self.fit.common_errors.iter();
            let errors = errors.filter(|error| error.source == ErrorSource::Temperature);
            let squares = errors.filter_map(|error| error.shift.get(index));
            squares.map(|change| change * change).sum::<f64>().sqrt()
        };
        time.map_or(0.0, of_time)
    }
}

/// Returns d ln a_T/dT at `temperature`.
fn slope(wlf: &Wlf, temperature: f64) -> Result<f64, CmodError> {
    let pole = 1.0 + wlf.curvature * (temperature - wlf.reference_temperature);
    let slope = -wlf.slope / (pole * pole);
    if pole > 0.0 && slope.is_finite() {
        Ok(slope)
    } else {
        Err(CmodError::ShiftsUndetermined)
    }
}

/// Returns one side of an interval after a `further` standard error has been added to the standard
/// error `before`.
fn wider(side: f64, before: f64, further: f64) -> f64 {
    // if there was no standard error before, the quantile of the normal distribution is used
    let quantile = if before > 0.0 { side / before } else { 1.96 };
    side.hypot(quantile * further)
}
