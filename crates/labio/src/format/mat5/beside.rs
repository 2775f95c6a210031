//! Abscissae and units of series, which the writer puts into separate variables.

use std::collections::HashSet;

use crate::format::text;
use crate::{Abscissa, Contents, Ordinate, Series};

/// Start of the description of files that [`Mat5`](super::Mat5) has written.
pub(super) const OF_WRITER: &str = "MATLAB 5.0 MAT-file, written by labio";

/// Endings of the names of the variables that accompany a series.
pub(super) const BESIDE: [&str; 5] = ["start", "step", "x", "unit", "x_unit"];

/// Gives each series the abscissa and the units in the variables that accompany it (`NAME_start`
/// and `NAME_step`, or `NAME_x`; `NAME_unit`, `NAME_x_unit`), and removes these variables from the
/// contents.
pub(super) fn join(contents: &mut Contents) {
    let found: Vec<Beside> = contents
        .series
        .iter()
        .map(|series| Beside::of(series, contents))
        .collect();
    let mut used = HashSet::new();
    for (series, beside) in contents.series.iter_mut().zip(found) {
        if let Some(abscissa) = beside.abscissa {
            series.abscissa = abscissa;
        }
        let axes = [&mut series.ordinate_axis, &mut series.abscissa_axis];
        for (axis, unit) in axes.into_iter().zip(beside.units) {
            if let Some(unit) = unit {
                axis.unit = text::known_unit(&unit);
                axis.unit_text = unit;
            }
        }
        used.extend(beside.used);
    }
    contents
        .series
        .retain(|series| !used.contains(&series.name));
    contents.properties.retain(|(key, _)| !used.contains(key));
}

/// The variables that accompany one series.
struct Beside {
    abscissa: Option<Abscissa>,
    /// Units of the values and of the abscissae.
    units: [Option<String>; 2],
    /// Names of the variables.
    used: Vec<String>,
}

impl Beside {
    fn of(series: &Series, contents: &Contents) -> Self {
        let mut used = Vec::new();
        let mut stated = |of: &str| {
            let name = format!("{}_{of}", series.name);
            let (_, value) = contents.properties.iter().find(|(key, _)| *key == name)?;
            used.push(name);
            Some(value.clone())
        };
        let units = [stated("unit"), stated("x_unit")];
        let [start, step] = ["start", "step"].map(|of| stated(of)?.parse::<f64>().ok());
        let abscissa = match start.zip(step) {
            Some((start, step)) => Some(Abscissa::Even { start, step }),
            None => {
                let name = format!("{}_x", series.name);
                let values = uneven(&contents.series, &name, series.ordinate.len());
                used.extend(values.is_some().then_some(name));
                values.map(Abscissa::Uneven)
            }
        };
        Self {
            abscissa,
            units,
            used,
        }
    }
}

/// The values of the series called `name`, if there are `length` of them.
fn uneven(series: &[Series], name: &str, length: usize) -> Option<Vec<f64>> {
    let found = series.iter().find(|other| other.name == name)?;
    match &found.ordinate {
        Ordinate::Real(values) if values.len() == length => Some(values.clone()),
        _ => None,
    }
}
