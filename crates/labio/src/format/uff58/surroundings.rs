//! Data sets of a universal file that contain more information about its functions: units (164) and
//! nodes (15).
//!
//! Data set 164 names a unit system and the factors by which a length and a force in that system
//! are divided to convert them to m and N. A function without unit texts has the units of its
//! specific data types in this system, provided that name and factors agree. Data set 15 contains
//! the coordinates of nodes.

use std::collections::BTreeMap;

use super::header::Columns;
use super::lines::{Lines, decode};
use crate::{Contents, Series, Unit};

/// Property of the file: code and name of its unit system.
pub const UNITS: &str = "uff58.units";
/// Property of a series: coordinates of the node of its response, in m if the file states its
/// units.
pub const POSITION: &str = "uff58.response_position";
/// Property of a series: coordinates of the node of its reference.
pub const REFERENCE_POSITION: &str = "uff58.reference_position";

/// Units of length and force for each code.
const SYSTEMS: [(i64, &str, &str); 7] = [
    (1, "m", "N"),
    (2, "ft", "lbf"),
    (3, "m", "kgf"),
    (5, "mm", "mN"),
    (7, "in", "lbf"),
    (8, "mm", "kgf"),
    (10, "mm", "N"),
];

/// Largest relative difference between a stated factor and that of the named unit: factors are
/// written with ten or more digits, and programs use different factors for the pound.
const SAME: f64 = 1e-5;

/// Units and nodes of a file, from data sets other than 58.
#[derive(Debug, Default)]
pub(super) struct Surroundings {
    /// Units of length and force.
    units: Option<[Unit; 2]>,
    /// Factor by which a length is divided to convert it to m.
    length: Option<f64>,
    nodes: BTreeMap<i64, [f64; 3]>,
}

impl Surroundings {
    /// Reads a data set 164 with its closing separator; `None` if the lines are not such a data
    /// set.
    pub(super) fn read_units(
        &mut self,
        lines: &mut Lines<'_>,
        contents: &mut Contents,
    ) -> Option<()> {
        let first = lines.next_line().filter(|line| !line.is_separator())?;
        let text = decode(first.bytes);
        let columns = Columns::of(1, first.place, &text);
        let code = columns.integer(0, 10, "code of units").ok()?;
        let name = columns.text(10, 20);
        let second = lines.next_line().filter(|line| !line.is_separator())?;
        let text = decode(second.bytes);
        let columns = Columns::of(2, second.place, &text);
        let factor = |first: usize| {
            let factor = columns.real(first, 25, "factor of a unit").ok()?;
            (factor > 0.0).then_some(factor)
        };
        let (length, force) = (factor(0)?, factor(25)?);
        if !lines.skip_past_separator() {
            return None;
        }
        let known = SYSTEMS.iter().find(|(own, ..)| *own == code);
        self.units = known.and_then(|(_, of_length, of_force)| {
            let unit = |text: &str, factor: f64| {
                let unit = Unit::parse(text).ok()?;
                ((unit.scale() * factor - 1.0).abs() < SAME).then_some(unit)
            };
            Some([unit(of_length, length)?, unit(of_force, force)?])
        });
        self.length = Some(length);
        let said = format!("{code} {name}");
        contents
            .properties
            .push((UNITS.to_owned(), said.trim_end().to_owned()));
        Some(())
    }

    /// Reads a data set 15 with its closing separator; `None` if the lines are not such a data set.
    pub(super) fn read_nodes(&mut self, lines: &mut Lines<'_>) -> Option<()> {
        let mut nodes = BTreeMap::new();
        for record in 1.. {
            let line = lines.next_line()?;
            if line.is_separator() {
                break;
            }
            let text = decode(line.bytes);
            let columns = Columns::of(record, line.place, &text);
            let node = columns.integer(0, 10, "node").ok()?;
            let coordinate = |axis: usize| columns.real(40 + 13 * axis, 13, "coordinate").ok();
            nodes.insert(node, [coordinate(0)?, coordinate(1)?, coordinate(2)?]);
        }
        self.nodes.append(&mut nodes);
        Some(())
    }

    /// Adds units and positions to the series of `contents` that do not state them.
    pub(super) fn complete(&self, contents: &mut Contents) {
        for series in &mut contents.series {
            if let Some([length, force]) = &self.units
                && series.ordinate_axis.unit.is_none()
                && series.ordinate_axis.unit_text.is_empty()
            {
                series.ordinate_axis.unit = of_types(series, length, force);
            }
            for (node, property) in [
                ("uff58.response_node", POSITION),
                ("uff58.reference_node", REFERENCE_POSITION),
            ] {
                let found = number(series, node).and_then(|node| self.nodes.get(&node));
                if let Some(position) = found {
                    let said = self.in_words(position);
                    series.properties.push((property.to_owned(), said));
                }
            }
        }
    }

    fn in_words(&self, [x, y, z]: &[f64; 3]) -> String {
        match self.length {
            Some(length) => format!("{} {} {} m", x / length, y / length, z / length),
            None => format!("{x} {y} {z}"),
        }
    }
}

fn number(series: &Series, property: &str) -> Option<i64> {
    let mut properties = series.properties.iter();
    let (_, value) = properties.find(|(name, _)| name == property)?;
    value.parse().ok()
}

/// Returns the unit of the ordinate from its specific data type, divided by that of its denominator
/// if the file has one.
fn of_types(series: &Series, length: &Unit, force: &Unit) -> Option<Unit> {
    let of = |data_type: i64| -> Option<Unit> {
        let second = Unit::parse("s").ok()?;
        let squared = |unit: &Unit| unit.times(unit).ok();
        match data_type {
            8 => Some(length.clone()),
            9 | 13 => Some(force.clone()),
            11 => length.per(&second).ok(),
            12 => length.per(&squared(&second)?).ok(),
            2 | 15 => force.per(&squared(length)?).ok(),
            _ => None,
        }
    };
    let properties = &series.properties;
    let says = |name: &str| properties.iter().any(|(own, _)| own == name);
    let ordinate = of(number(series, "uff58.ordinate_type")?)?;
    if says("uff58.denominator_unit") {
        return None;
    }
    match number(series, "uff58.denominator_type") {
        None | Some(0) => Some(ordinate),
        Some(denominator) => ordinate.per(&of(denominator)?).ok(),
    }
}
