//! Construction of series and access to their parts, for the tests of formats.

use labio::format::Writer;
use labio::{Abscissa, Contents, LabioError, Ordinate, Series, SeriesAxis, SeriesKind, Unit};

pub(crate) fn even(start: f64, step: f64) -> Abscissa {
    Abscissa::Even { start, step }
}

pub(crate) fn axis(label: &str, unit_text: &str) -> SeriesAxis {
    SeriesAxis {
        label: label.to_owned(),
        unit: Unit::parse(unit_text).ok(),
        unit_text: unit_text.to_owned(),
    }
}

pub(crate) fn values(series: &Series) -> &[f64] {
    match &series.ordinate {
        Ordinate::Real(values) => values,
        Ordinate::Complex(_) => panic!("expected real numbers"),
    }
}

pub(crate) fn real(contents: &Contents, index: usize) -> &[f64] {
    values(&contents.series[index])
}

pub(crate) fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

pub(crate) fn property<'a>(properties: &'a [(String, String)], name: &str) -> Option<&'a str> {
    let found = properties.iter().find(|(key, _)| key == name);
    found.map(|(_, value)| value.as_str())
}

/// One line per reading: its error or, if it succeeds, the contents.
pub(crate) fn refusals(read: impl IntoIterator<Item = Result<Contents, LabioError>>) -> String {
    let said = read.into_iter().map(|read| match read {
        Ok(contents) => format!("read {:?}", contents.series),
        Err(error) => error.to_string(),
    });
    said.collect::<Vec<_>>().join("\n")
}

pub(crate) fn defects(contents: &Contents) -> String {
    let said = contents.defects.iter().map(ToString::to_string);
    said.collect::<Vec<_>>().join("\n")
}

/// A general series over its index.
pub(crate) fn bare(name: &str, ordinate: Ordinate) -> Series {
    Series {
        name: name.to_owned(),
        kind: SeriesKind::General,
        abscissa: even(0.0, 1.0),
        ordinate,
        abscissa_axis: axis("index", ""),
        ordinate_axis: SeriesAxis::default(),
        properties: Vec::new(),
    }
}

pub(crate) fn contents_of(series: Vec<Series>) -> Contents {
    let mut contents = Contents::of_format("test");
    contents.series = series;
    contents
}

pub(crate) fn pair(key: &str, value: &str) -> (String, String) {
    (key.to_owned(), value.to_owned())
}

pub(crate) fn written(writer: &dyn Writer, contents: &Contents) -> Result<Vec<u8>, LabioError> {
    let mut bytes = Vec::new();
    writer.write(contents, &mut bytes)?;
    Ok(bytes)
}

/// The cells of the rows of a table of reference values that begin with `file`.
pub(crate) fn rows_of<'a>(table: &'a str, file: &str) -> Vec<Vec<&'a str>> {
    let rows = table.lines().skip(1).map(|line| line.split(',').collect());
    rows.filter(|row: &Vec<&str>| row[0] == file).collect()
}
