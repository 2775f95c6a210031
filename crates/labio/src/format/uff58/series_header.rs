//! Conversion between a data set 58 and a [`Series`]: fields without a place in a series become
//! properties of the series.

use std::str::FromStr;

use num_complex::Complex64;

use super::header::{AXES, AxisRecord, BinaryForm, DegreeOfFreedom, Header};
use super::{ByteOrder, Encoding, FORMAT, Precision, binary_block};
use crate::error::{check_count, not_representable};
use crate::format::kind::{function_type, kind_of_number};
use crate::format::text;
use crate::{Abscissa, Dimension, LabioError, Ordinate, Series, SeriesAxis, Unit};

const PREFIX: &str = "uff58.";
const ASCII: &str = "ascii";
const LITTLE_ENDIAN: &str = "binary, little-endian";
const BIG_ENDIAN: &str = "binary, big-endian";
const SINGLE: &str = "single";
const DOUBLE: &str = "double";

/// Codes of specific data types that follow from units.
const TIME: i64 = 17;
const FREQUENCY: i64 = 18;
const BY_DIMENSION: [(i64, Dimension); 6] = [
    (8, dimension(1, 0, 0)),
    (11, dimension(1, 0, -1)),
    (12, dimension(1, 0, -2)),
    (13, dimension(1, 1, -2)),
    (15, dimension(-1, 1, -2)),
    (16, dimension(0, 1, 0)),
];

const fn dimension(length: i8, mass: i8, time: i8) -> Dimension {
    Dimension {
        length,
        mass,
        time,
        current: 0,
        temperature: 0,
    }
}

/// Number of numbers per point.
pub(super) fn numbers_per_point(header: &Header) -> usize {
    usize::from(!header.even) + if header.complex { 2 } else { 1 }
}

/// Creates the series from a header and the numbers after it, with as many points as are complete.
pub(super) fn series(header: Header, binary: Option<BinaryForm>, values: Vec<f64>) -> Series {
    let properties = properties(&header, binary);
    let [abscissa, ordinate, denominator, _] = header.axes;
    let ordinate_unit = match (unit_of(&ordinate), unit_of(&denominator)) {
        (Some(unit), None) if denominator.unit.is_empty() => Some(unit),
        (Some(numerator), Some(denominator)) => numerator.per(&denominator).ok(),
        _ => None,
    };
    let abscissa_axis = SeriesAxis {
        unit: unit_of(&abscissa),
        label: abscissa.label,
        unit_text: abscissa.unit,
    };
    let ordinate_axis = SeriesAxis {
        unit: ordinate_unit,
        label: ordinate.label,
        unit_text: ordinate.unit,
    };
    let even = Abscissa::Even {
        start: header.start,
        step: header.step,
    };
    let (abscissa, ordinate) = match (header.even, header.complex) {
        (true, false) => (even, Ordinate::Real(values)),
        (true, true) => {
            let points = values.as_chunks::<2>().0.iter();
            let ordinates = points.map(|&[re, im]| Complex64::new(re, im));
            (even, Ordinate::Complex(ordinates.collect()))
        }
        (false, false) => {
            let points = values.as_chunks::<2>().0.iter();
            let (abscissae, ordinates) = points.map(|&[x, y]| (x, y)).unzip();
            (Abscissa::Uneven(abscissae), Ordinate::Real(ordinates))
        }
        (false, true) => {
            let points = values.as_chunks::<3>().0.iter();
            let points = points.map(|&[x, re, im]| (x, Complex64::new(re, im)));
            let (abscissae, ordinates) = points.unzip();
            (Abscissa::Uneven(abscissae), Ordinate::Complex(ordinates))
        }
    };
    let [name, ..] = header.id_lines;
    Series {
        name,
        kind: kind_of_number(header.function_type),
        abscissa,
        ordinate,
        abscissa_axis,
        ordinate_axis,
        properties,
    }
}

/// Returns the unit of an axis. Times and frequencies need no text: they are in seconds and hertz
/// in every unit system of universal files.
fn unit_of(axis: &AxisRecord) -> Option<Unit> {
    text::known_unit(match (axis.unit.as_str(), axis.data_type) {
        ("", TIME) => "s",
        ("", FREQUENCY) => "Hz",
        (text, _) => text,
    })
}

/// Returns the degree of freedom of the response of a series read from a file, for example
/// `rig:1+X`; `None` if the file does not state it.
#[must_use]
pub fn response(series: &Series) -> Option<String> {
    const DIRECTIONS: [&str; 7] = ["", "X", "Y", "Z", "RX", "RY", "RZ"];
    let said = Properties(&series.properties);
    let dof = said.degree_of_freedom("response").ok()?;
    if dof == DegreeOfFreedom::default() {
        return None;
    }
    let axis = usize::try_from(dof.direction.unsigned_abs())
        .ok()
        .and_then(|axis| DIRECTIONS.get(axis));
    let direction = match axis {
        Some(&"") => String::new(),
        Some(axis) => format!("{}{axis}", if dof.direction < 0 { '-' } else { '+' }),
        None => format!("({})", dof.direction),
    };
    let separator = if dof.entity.is_empty() { "" } else { ":" };
    Some(format!("{}{separator}{}{direction}", dof.entity, dof.node))
}

/// Returns the header fields without a place in a series. Empty fields (0 or no text) are left out,
/// except the specific data types: a missing one would be derived from the unit when the series is
/// written.
fn properties(header: &Header, binary: Option<BinaryForm>) -> Vec<(String, String)> {
    let exponents =
        |[length, force, temperature]: [i64; 3]| format!("{length} {force} {temperature}");
    let number = |value: i64| (value != 0).then(|| value.to_string());
    let text = |value: &String| (!value.is_empty()).then(|| value.clone());
    let mut fields: Vec<(String, Option<String>)> = Vec::with_capacity(32);
    for (index, line) in (1..).zip(&header.id_lines).skip(1) {
        fields.push((format!("id{index}"), text(line)));
    }
    fields.push(("function_id".to_owned(), number(header.function_id)));
    fields.push(("version".to_owned(), number(header.version)));
    fields.push(("load_case".to_owned(), number(header.load_case)));
    for (what, dof) in [
        ("response", &header.response),
        ("reference", &header.reference),
    ] {
        fields.push((format!("{what}_entity"), text(&dof.entity)));
        fields.push((format!("{what}_node"), number(dof.node)));
        fields.push((format!("{what}_direction"), number(dof.direction)));
    }
    let half_unit = header.even.then(|| format!("{:?}", header.step_half_unit));
    fields.push(("step_half_unit".to_owned(), half_unit));
    // compared by bits, so that minus zero is preserved
    let z_value = (header.z_value.to_bits() != 0).then(|| format!("{:?}", header.z_value));
    fields.push(("z_value".to_owned(), z_value));
    for (index, (axis, name)) in header.axes.iter().zip(AXES).enumerate() {
        // the first two axes are those of the series
        let of_series = index < 2;
        let data_type = if of_series {
            Some(axis.data_type.to_string())
        } else {
            number(axis.data_type)
        };
        fields.push((format!("{name}_type"), data_type));
        let has_exponents = axis.exponents != [0; 3];
        fields.push((
            format!("{name}_exponents"),
            has_exponents.then(|| exponents(axis.exponents)),
        ));
        if !of_series {
            fields.push((format!("{name}_label"), text(&axis.label)));
            fields.push((format!("{name}_unit"), text(&axis.unit)));
        }
    }
    let encoding = match binary.map(|form| form.byte_order) {
        None => ASCII,
        Some(ByteOrder::LittleEndian) => LITTLE_ENDIAN,
        Some(ByteOrder::BigEndian) => BIG_ENDIAN,
    };
    fields.push(("encoding".to_owned(), Some(encoding.to_owned())));
    let precision = if header.double { DOUBLE } else { SINGLE };
    fields.push(("precision".to_owned(), Some(precision.to_owned())));
    let said = fields
        .into_iter()
        .filter_map(|(key, value)| Some((format!("{PREFIX}{key}"), value?)));
    said.collect()
}

/// The properties of a series, read from a file or set by the caller.
struct Properties<'a>(&'a [(String, String)]);

impl Properties<'_> {
    fn get(&self, key: &str) -> Option<&str> {
        let mut values = self
            .0
            .iter()
            .filter(|(found, _)| found.strip_prefix(PREFIX) == Some(key));
        values.next().map(|(_, value)| value.as_str())
    }

    fn text(&self, key: &str) -> String {
        self.get(key).unwrap_or_default().to_owned()
    }

    fn number<T: FromStr + Default>(&self, key: &str) -> Result<T, LabioError> {
        let Some(text) = self.get(key) else {
            return Ok(T::default());
        };
        text.trim().parse().map_err(|_| cannot(key, text))
    }

    fn degree_of_freedom(&self, what: &str) -> Result<DegreeOfFreedom, LabioError> {
        Ok(DegreeOfFreedom {
            entity: self.text(&format!("{what}_entity")),
            node: self.number(&format!("{what}_node"))?,
            direction: self.number(&format!("{what}_direction"))?,
        })
    }

    fn axis(&self, name: &str) -> Result<AxisRecord, LabioError> {
        let exponents = match self.get(&format!("{name}_exponents")) {
            None => [0; 3],
            Some(text) => {
                let numbers: Result<Vec<i64>, _> =
                    text.split_whitespace().map(str::parse).collect();
                numbers
                    .ok()
                    .and_then(|numbers| numbers.try_into().ok())
                    .ok_or_else(|| cannot(&format!("{name}_exponents"), text))?
            }
        };
        Ok(AxisRecord {
            data_type: self.number(&format!("{name}_type"))?,
            exponents,
            label: self.text(&format!("{name}_label")),
            unit: self.text(&format!("{name}_unit")),
        })
    }
}

fn cannot(key: &str, value: &str) -> LabioError {
    not_representable(FORMAT, format!("`{value}` as {PREFIX}{key}"))
}

/// Creates the header of `series` and, for a 58b, the fields of the identifier line.
///
/// # Errors
///
/// [`LabioError::CountMismatch`] if there are not as many abscissae as ordinates;
/// [`LabioError::NotRepresentable`] for a property that would not read back unchanged.
pub(super) fn header(
    series: &Series,
    encoding: Encoding,
    precision: Precision,
) -> Result<(Header, Option<BinaryForm>), LabioError> {
    let said = Properties(&series.properties);
    let n_points = series.ordinate.len();
    let (even, start, step) = match &series.abscissa {
        Abscissa::Even { start, step } => (true, *start, *step),
        Abscissa::Uneven(values) => {
            check_count("abscissa values of a series", values.len(), n_points)?;
            (false, 0.0, 0.0)
        }
    };
    let mut axes = [
        said.axis("abscissa")?,
        said.axis("ordinate")?,
        said.axis("denominator")?,
        said.axis("z")?,
    ];
    let [abscissa, ordinate, ..] = &mut axes;
    for (record, axis, name) in [
        (abscissa, &series.abscissa_axis, "abscissa"),
        (ordinate, &series.ordinate_axis, "ordinate"),
    ] {
        record.label.clone_from(&axis.label);
        record.unit.clone_from(&axis.unit_text);
        if said.get(&format!("{name}_type")).is_none()
            && let Some(unit) = &axis.unit
        {
            record.data_type = specific_data_type(unit.dimension());
        }
    }
    let double = match precision {
        Precision::Single => false,
        Precision::Double => true,
        Precision::AsRead => match said.get("precision") {
            None | Some(DOUBLE) => true,
            Some(SINGLE) => false,
            Some(other) => return Err(cannot("precision", other)),
        },
    };
    let header = Header {
        id_lines: [
            series.name.clone(),
            said.text("id2"),
            said.text("id3"),
            said.text("id4"),
            said.text("id5"),
        ],
        function_type: function_type(series.kind),
        function_id: said.number("function_id")?,
        version: said.number("version")?,
        load_case: said.number("load_case")?,
        response: said.degree_of_freedom("response")?,
        reference: said.degree_of_freedom("reference")?,
        double,
        complex: matches!(series.ordinate, Ordinate::Complex(_)),
        n_points,
        even,
        start,
        step,
        step_half_unit: said.number("step_half_unit")?,
        z_value: said.number("z_value")?,
        axes,
    };
    let byte_order = match encoding {
        Encoding::Ascii => None,
        Encoding::Binary(order) => Some(order),
        Encoding::AsRead => match said.get("encoding") {
            None | Some(ASCII) => None,
            Some(LITTLE_ENDIAN) => Some(ByteOrder::LittleEndian),
            Some(BIG_ENDIAN) => Some(ByteOrder::BigEndian),
            Some(other) => return Err(cannot("encoding", other)),
        },
    };
    let binary = match byte_order {
        None => None,
        Some(byte_order) => Some(BinaryForm {
            byte_order,
            n_bytes: binary_block::n_bytes(&header)
                .ok_or_else(|| cannot("encoding", "a block of more bytes than can be counted"))?,
        }),
    };
    Ok((header, binary))
}

fn specific_data_type(found: Dimension) -> i64 {
    if found == dimension(0, 0, 1) {
        TIME
    } else if found == dimension(0, 0, -1) {
        FREQUENCY
    } else {
        let mut types = BY_DIMENSION
            .iter()
            .filter(|(_, dimension)| *dimension == found);
        types.next().map_or(0, |(number, _)| *number)
    }
}
