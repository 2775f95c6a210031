//! Names, kinds, axes and abscissae of series, which the writer puts into separate variables.

use std::collections::HashSet;

use crate::format::kind::kind_of_name;
use crate::format::text;
use crate::{Abscissa, Contents, Ordinate, Series, SeriesKind};

/// Start of the description of files that [`Mat5`](super::Mat5) has written.
pub(super) const OF_WRITER: &str = "MATLAB 5.0 MAT-file, written by labio";

/// Endings of the names of the variables that accompany a series.
pub(super) const BESIDE: [&str; 9] = [
    "start", "step", "x", "name", "kind", "label", "unit", "x_label", "x_unit",
];

/// Gives each series the information in the variables that accompany it: its name and kind
/// (`NAME_name`, `NAME_kind`), its abscissa (`NAME_start` and `NAME_step`, or `NAME_x`), and the
/// labels and units of both axes (`NAME_label`, `NAME_unit`, `NAME_x_label`, `NAME_x_unit`).
/// Removes these variables from the contents.
pub(super) fn join(contents: &mut Contents) {
    let found: Vec<Beside> = contents
        .series
        .iter()
        .map(|series| Beside::of(series, contents))
        .collect();
    let used: HashSet<String> = found
        .iter()
        .flat_map(|beside| beside.used.iter().cloned())
        .collect();
    let variables = std::mem::take(&mut contents.series);
    for (mut series, beside) in variables.into_iter().zip(found) {
        if !used.contains(&series.name) {
            beside.describe(&mut series);
            contents.series.push(series);
        }
    }
    contents.properties.retain(|(key, _)| !used.contains(key));
}

/// The variables that accompany one series.
struct Beside {
    abscissa: Option<Abscissa>,
    name: Option<String>,
    kind: Option<SeriesKind>,
    /// Labels of the values and of the abscissae.
    labels: [Option<String>; 2],
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
        let name = stated("name");
        let kind = stated("kind").and_then(|kind| kind_of_name(&kind));
        let labels = [stated("label"), stated("x_label")];
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
            name,
            kind,
            labels,
            units,
            used,
        }
    }

    /// Enters the information in the series.
    fn describe(self, series: &mut Series) {
        if let Some(abscissa) = self.abscissa {
            series.abscissa = abscissa;
        }
        if self.units[1].is_some() {
            // the present label is `index`, the default; an abscissa with a unit is not an index
            series.abscissa_axis.label.clear();
        }
        if let Some(name) = self.name {
            series.name = name;
        }
        if let Some(kind) = self.kind {
            series.kind = kind;
        }
        let axes = [&mut series.ordinate_axis, &mut series.abscissa_axis];
        for ((axis, label), unit) in axes.into_iter().zip(self.labels).zip(self.units) {
            if let Some(label) = label {
                axis.label = label;
            }
            if let Some(unit) = unit {
                axis.unit = text::known_unit(&unit);
                axis.unit_text = unit;
            }
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
