//! Writing of an archive of arrays.

use std::collections::HashSet;
use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::about::{self, ABOUT, SUFFIXES};
use super::{FORMAT, Npz};
use crate::error::{not_representable, not_written};
use crate::format::Writer;
use crate::format::npy::array::{self, member_name};
use crate::format::npy::file::{header_of, is_bare};
use crate::format::npy::header::{Element, Header, Kind};
use crate::{Abscissa, Contents, LabioError, Series};

fn cannot_hold(what: impl Into<String>) -> LabioError {
    not_representable(FORMAT, what.into())
}

impl Writer for Npz {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn write(&self, contents: &Contents, output: &mut dyn Write) -> Result<(), LabioError> {
        let members = members(contents)?;
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        let failed = |error: zip::result::ZipError| LabioError::Write {
            source: std::io::Error::other(error),
        };
        for (name, bytes) in members {
            // members have the earliest possible date, so that equal contents give equal files
            let options = SimpleFileOptions::default()
                .compression_method(CompressionMethod::Stored)
                .last_modified_time(zip::DateTime::default())
                .large_file(bytes.len() > 1 << 30);
            archive
                .start_file(format!("{name}.npy"), options)
                .map_err(failed)?;
            archive.write_all(&bytes).map_err(not_written)?;
        }
        let bytes = archive.finish().map_err(failed)?.into_inner();
        output.write_all(&bytes).map_err(not_written)
    }
}

/// Returns names and bytes of all arrays.
fn members(contents: &Contents) -> Result<Vec<(String, Vec<u8>)>, LabioError> {
    let mut members: Vec<(String, Vec<u8>)> = Vec::new();
    if !contents.properties.is_empty() {
        members.push((ABOUT.to_owned(), texts(ABOUT, &contents.properties)?));
    }
    let array_of = |series: &Series| {
        let found = series.properties.iter().find(|(key, _)| key == "array");
        found.map(|(_, name)| name.clone())
    };
    let mut rest = contents.series.as_slice();
    while let Some(first) = rest.first() {
        let array = array_of(first);
        let n = match &array {
            Some(_) => rest
                .iter()
                .take_while(|series| array_of(series) == array)
                .count(),
            None => 1,
        };
        let (group, after) = rest.split_at(n);
        rest = after;
        match array {
            Some(name) => members.push((name.clone(), of_two_axes(&name, group)?)),
            None => of_one_axis(first, &mut members)?,
        }
    }
    if contents.series.is_empty() && members.is_empty() {
        return Err(cannot_hold("contents without a series"));
    }
    let mut names = HashSet::new();
    for (name, _) in &members {
        let odd = name.is_empty() || name.contains(['/', '\\', '\0']) || name.starts_with("..");
        let twice = !names.insert(name);
        if odd || twice {
            let why = if twice {
                "twice"
            } else {
                "as the name of a member"
            };
            return Err(cannot_hold(format!("`{name}` {why}")));
        }
    }
    Ok(members)
}

fn of_two_axes(name: &str, group: &[Series]) -> Result<Vec<u8>, LabioError> {
    let series: Vec<&Series> = group.iter().collect();
    let header = header_of(&series, name, FORMAT)?;
    for (index, one) in series.iter().enumerate() {
        let as_read =
            header.shape.len() == 2 && one.name == member_name(name, &header.shape, index);
        if !as_read || !is_bare(one) {
            return Err(cannot_hold(format!(
                "`{}` in the array `{name}` with a name, an abscissa or units of its own; remove its properties to write it as a separate array",
                one.name
            )));
        }
    }
    check_name(name, false)?;
    array::write(&series, &header)
        .ok_or_else(|| cannot_hold(format!("the numbers of `{name}` as {}", header.element)))
}

fn of_one_axis(series: &Series, members: &mut Vec<(String, Vec<u8>)>) -> Result<(), LabioError> {
    let name = &series.name;
    check_name(name, true)?;
    let bare = Series {
        properties: series
            .properties
            .iter()
            .filter(|(key, _)| key == "descr")
            .cloned()
            .collect(),
        ..series.clone()
    };
    let header = header_of(&[&bare], name, FORMAT)?;
    let bytes = array::write(&[&bare], &header)
        .ok_or_else(|| cannot_hold(format!("the numbers of `{name}` as {}", header.element)))?;
    members.push((name.clone(), bytes));
    let numbers = |values: &[f64]| {
        let header = Header {
            element: Element::F64,
            fortran_order: false,
            shape: vec![values.len()],
            data_start: 0,
        };
        let mut bytes = header.write();
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        bytes
    };
    match &series.abscissa {
        Abscissa::Even { start, step }
            if start.to_bits() == 0 && step.to_bits() == 1.0_f64.to_bits() => {}
        Abscissa::Even { start, step } => {
            members.push((format!("{name}.start_step"), numbers(&[*start, *step])));
        }
        Abscissa::Uneven(values) if values.len() == series.ordinate.len() => {
            members.push((format!("{name}.abscissa"), numbers(values)));
        }
        Abscissa::Uneven(values) => {
            return Err(cannot_hold(format!(
                "`{name}`, which has {} abscissae for {} samples",
                values.len(),
                series.ordinate.len()
            )));
        }
    }
    let rows = about::rows(series);
    if !rows.is_empty() {
        let about = format!("{name}.about");
        let bytes = texts(&about, &rows)?;
        members.push((about, bytes));
    }
    Ok(())
}

/// Rejects names that have a special meaning to the reader.
fn check_name(name: &str, one_axis: bool) -> Result<(), LabioError> {
    let reserved = name == ABOUT || SUFFIXES.iter().any(|suffix| name.ends_with(suffix));
    if reserved || (one_axis && name.is_empty()) {
        return Err(cannot_hold(format!("a series called `{name}`")));
    }
    Ok(())
}

/// Returns an array of texts of shape `(n, 2)`.
fn texts(name: &str, rows: &[(String, String)]) -> Result<Vec<u8>, LabioError> {
    let all = || rows.iter().flat_map(|(key, value)| [key, value]);
    let widest = all()
        .map(|text| text.chars().count())
        .max()
        .unwrap_or(0)
        .max(1);
    if let Some(text) = all().find(|text| text.ends_with('\0')) {
        return Err(cannot_hold(format!(
            "the text {text:?} in `{name}`, which ends with a NUL character"
        )));
    }
    let header = Header {
        element: Element {
            kind: Kind::Wide,
            bytes: 4 * widest,
            big_endian: false,
        },
        fortran_order: false,
        shape: vec![rows.len(), 2],
        data_start: 0,
    };
    let mut bytes = header.write();
    for text in all() {
        let characters = text.chars().chain(std::iter::repeat('\0')).take(widest);
        bytes.extend(characters.flat_map(|c| u32::from(c).to_le_bytes()));
    }
    Ok(bytes)
}
