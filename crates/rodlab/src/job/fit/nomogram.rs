//! Nomogram of a master curve: from a frequency and a temperature to storage modulus and loss
//! factor (ISO 10112).

use cmod::rheology::{MasterCurve, PredictedModulus};
use rodfigure::{Axis, Figure, Mark, Panel, Role};

use super::Found;
use super::steps::celsius;

/// Maximum number of temperature lines: more curves in a figure are hard to distinguish.
const MOST_LINES: usize = 5;
/// Decades of frequency shown below and above the measured frequencies. A master curve is used at
/// frequencies at which nothing was measured, and usually these are higher.
const DECADES_BELOW: i32 = 2;
const DECADES_ABOVE: i32 = 4;

/// Figure with the curves of the fitted `series` over reduced frequency f a(T) and, below them, the
/// lines
///
/// ```text
/// f = f_reduced / a(T)
/// ```
///
/// of up to five measured temperatures T, with the fitted shifts.
pub(super) fn nomogram(
    found: &Found<'_>,
    curve: &MasterCurve,
    series: &[(f64, PredictedModulus)],
) -> Figure {
    let (unit, pascal) = found.pascal;
    // a band of two standard errors about the curve, and the curve
    let with_band = |name: &str, role, of: &dyn Fn(&PredictedModulus) -> (f64, f64)| {
        let values = || series.iter().map(|(f, point)| (*f, of(point)));
        let edges =
            values().map(|(f, (value, error))| (f, value - 2.0 * error, value + 2.0 * error));
        let curve = values().map(|(f, (value, _))| (f, value));
        [Mark::band(name, role, edges), Mark::line(name, role, curve)]
    };
    let symbol = found.symbol();
    let storage = with_band(&format!("{symbol}'"), Role::First, &|point| {
        (
            point.modulus.re / pascal,
            point.covariance[0][0].sqrt() / pascal,
        )
    });
    let factor = with_band("loss factor", Role::Second, &PredictedModulus::loss_factor);
    let moduli = Panel::new(
        reduced_frequency(),
        Axis::logarithmic(format!("{symbol}' in {unit}, loss factor"), ""),
        [storage, factor].concat(),
    );
    let measured = found.steps.iter().flat_map(|step| &step.rows);
    let measured = measured.filter(|row| row.over_time.is_none());
    let measured = measured.map(|row| row.frequency_hz);
    let range = [
        measured.clone().fold(f64::INFINITY, f64::min) / 10.0_f64.powi(DECADES_BELOW),
        measured.fold(0.0, f64::max) * 10.0_f64.powi(DECADES_ABOVE),
    ];
    let shifts = &curve.shifts;
    let lines = evenly(shifts.len())
        .enumerate()
        .filter_map(|(line, index)| {
            let shift = shifts.get(index)?;
            let name = celsius(shift.temperature);
            let points = series.iter().map(|(f, _)| (*f, f / shift.log_shift.exp()));
            Some(Mark::line(name, Role::of_series(line), points))
        });
    let frequency = Axis::logarithmic("frequency", "Hz").within(range);
    let temperatures = Panel::new(reduced_frequency(), frequency, lines.collect());
    let is_one = shifts
        .iter()
        .all(|shift| (shift.vertical - 1.0).abs() < 1e-12);
    Figure::new(
        "nomogram",
        format!(
            "Nomogram, reduced to {}",
            celsius(curve.reference_temperature)
        ),
        vec![moduli, temperatures],
    )
    .with_caption(format!(
        "From a frequency across to the line of a temperature, and from there straight up to {symbol}' and the loss factor, each with \
         two standard errors of the series.{}",
        if is_one {
            ""
        } else {
            " The modulus applies at the reference temperature; for another temperature, multiply it by the factor of that temperature."
        }
    ))
}

fn reduced_frequency() -> Axis {
    Axis::logarithmic("reduced frequency", "Hz")
}

/// Returns up to [`MOST_LINES`] evenly spaced indices below `count`, including the first and the
/// last.
fn evenly(count: usize) -> impl Iterator<Item = usize> {
    let lines = count.min(MOST_LINES);
    (0..lines).map(move |line| line * (count - 1) / (lines - 1).max(1))
}

#[cfg(test)]
mod tests {
    use super::evenly;

    #[test]
    fn lines_are_of_temperatures_from_the_lowest_to_the_highest() {
        let places = |count| evenly(count).collect::<Vec<_>>();
        assert!(places(0).is_empty());
        assert_eq!(places(1), [0]);
        assert_eq!(places(3), [0, 1, 2]);
        assert_eq!(places(11), [0, 2, 5, 7, 10]);
    }
}
