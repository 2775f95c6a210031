//! Reader of TDMS, the file format of `LabVIEW` and of DAQmx devices.
//!
//! # The format
//!
//! A file is a sequence of segments. Each segment has a lead-in, metadata with changes of the
//! objects (the file, groups, channels) and raw data of channels, in chunks: one channel after the
//! other, or interleaved, or as delivered by a DAQmx device. Objects that the metadata do not
//! mention are as in the previous segment. Either byte order is read; numbers in the first eight
//! bytes of the lead-in are always little-endian.
//!
//! # Series
//!
//! A series is one channel and has its name. The property `tdms.group` is the group of the channel;
//! all properties of the channel follow. The abscissa begins at `wf_start_offset` and has the step
//! `wf_increment`, in seconds unless `wf_xunit_string` states another unit; without these
//! properties it is the sample index. The unit of the ordinate is `unit_string`. Properties of the
//! file become properties of the contents; the names of group properties are preceded by the name
//! of the group and a slash.
//!
//! Numbers are converted to doubles; 64-bit integers are rounded to 53 bits. Times become seconds
//! since the first time, which is stored in the property `tdms.first_time`. Text channels are
//! skipped and named in the property `tdms.text_channel` of the contents; channels without raw data
//! are named in `tdms.empty_channel`.
//!
//! Scales (`NI_Scale[..]`) are applied unless `NI_Scaling_Status` is `scaled`: linear, polynomial,
//! table (constant beyond its ends), sum and difference, strain gauges in a bridge, resistance
//! thermometers and thermocouples. Any other kind of scale causes an error that names it: raw
//! numbers are never returned as scaled ones.
//!
//! # Limits
//!
//! Numbers in extended precision (80 bits) are rejected. Index files (`.tdms_index`) are not used.
//!
//! A tolerant reading returns the samples that exist in a truncated file and leaves out channels
//! that cannot be scaled; both faults are listed as defects.

use std::collections::HashMap;

use num_complex::Complex64;

use self::objects::{Object, Objects, Property};
use self::raw_data::Layout;
use self::segment::Segment;
use super::text::axis;
use super::{Reader, Strictness};
use crate::error;
use crate::{Abscissa, Contents, LabioError, Ordinate, Place, Series, SeriesKind};

mod bytes;
mod numbers;
mod objects;
mod raw_data;
mod scaling;
mod segment;
mod sensors;
mod thermocouples;
mod value;

const FORMAT: &str = "tdms";

/// Property of a series: the group of its channel.
pub const GROUP: &str = "tdms.group";
/// Property of a series of times: the first time, in UTC.
pub const FIRST_TIME: &str = "tdms.first_time";
/// Property of the file: path of a channel of texts, which was skipped.
pub const TEXT_CHANNEL: &str = "tdms.text_channel";
/// Property of the file: path of a channel without raw data.
pub const EMPTY_CHANNEL: &str = "tdms.empty_channel";

/// Reads TDMS files; see the [module](self).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tdms;

fn malformed(
    place: Place,
    field: impl Into<String>,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> LabioError {
    error::malformed(FORMAT, place, field, found, expected)
}

impl Reader for Tdms {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn recognises(&self, head: &[u8]) -> bool {
        head.starts_with(b"TDSm")
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        let mut contents = Contents::of_format(FORMAT);
        let mut pass_over = |error: LabioError| strictness.pass_over(error, &mut contents.defects);
        let mut objects = Objects::default();
        if let Err(error) = segments(bytes, &mut objects, &mut pass_over) {
            // the start of the part that follows an unreadable one is unknown
            pass_over(error)?;
        }
        let mut series = Vec::new();
        let mut properties = Vec::new();
        let upper = objects.all.iter().filter(|object| object.path.len() < 2);
        let upper: Upper<'_> = upper
            .map(|object| (object.path.as_slice(), object))
            .collect();
        for object in &objects.all {
            match object.path.as_slice() {
                [] => properties.extend(told(object, "")),
                [group] => properties.extend(told(object, &format!("{group}/"))),
                [group, channel] => {
                    let path = format!("{group}/{channel}");
                    if object.numbers.has_text {
                        properties.push((TEXT_CHANNEL.to_owned(), path));
                    } else if object.index.is_none() {
                        properties.push((EMPTY_CHANNEL.to_owned(), path));
                    } else {
                        match self::series(object, &upper) {
                            Ok(channel) => series.push(channel),
                            Err(error) => pass_over(error)?,
                        }
                    }
                }
                _ => {}
            }
        }
        if objects.all.is_empty()
            && let Some(defect) = contents.defects.pop()
        {
            return Err(defect);
        }
        contents.series = series;
        contents.properties = properties;
        Ok(contents)
    }
}

/// Reads all segments into `objects`.
fn segments(
    bytes: &[u8],
    objects: &mut Objects,
    pass_over: &mut dyn FnMut(LabioError) -> Result<(), LabioError>,
) -> Result<(), LabioError> {
    let mut offset = 0;
    let mut layout = Layout::default();
    let mut interleaved = false;
    loop {
        let mut segment = Segment::at(offset, bytes)?;
        if let Some(overrun) = segment.overrun.take() {
            pass_over(overrun)?;
        }
        objects.update(&segment)?;
        if segment.contains.metadata() || segment.contains.interleaved() != interleaved {
            interleaved = segment.contains.interleaved();
            layout = Layout::of(&segment, objects)?;
        }
        if segment.contains.raw_data() {
            // the offset of the next segment is known even if this one is broken
            layout.read(&segment, objects).or_else(&mut *pass_over)?;
        }
        offset = segment.end;
        if offset >= bytes.len() {
            return Ok(());
        }
    }
}

fn told(object: &Object, prefix: &str) -> impl Iterator<Item = (String, String)> {
    object.properties().iter().map(move |property| {
        (
            format!("{prefix}{}", property.name),
            property.value.to_text(),
        )
    })
}

/// The file and its groups, by their paths.
type Upper<'a> = HashMap<&'a [String], &'a Object>;

fn series(channel: &Object, upper: &Upper<'_>) -> Result<Series, LabioError> {
    let numbers = &channel.numbers;
    if numbers.has_opaque {
        let expected = "numbers of at most 64 bits";
        return Err(malformed(
            channel.index_place,
            "data type of raw data",
            "extended precision",
            expected,
        ));
    }
    let mut properties = Vec::new();
    let [group, name] = channel.path.as_slice() else {
        return Err(malformed(
            channel.index_place,
            "path of an object",
            channel.path.join("/"),
            "a group and a channel",
        ));
    };
    properties.push((GROUP.to_owned(), group.clone()));
    if let Some(time) = numbers.first_time {
        properties.push((FIRST_TIME.to_owned(), time.iso()));
    }
    properties.extend(told(channel, ""));

    let ordinate = if numbers.complex {
        let (pairs, _) = numbers.values.as_chunks::<2>();
        Ordinate::Complex(
            pairs
                .iter()
                .map(|&[re, im]| Complex64::new(re, im))
                .collect(),
        )
    } else if numbers.first_time.is_some() && numbers.scalers.is_empty() {
        Ordinate::Real(numbers.values.clone())
    } else {
        let owners = [
            Some(&channel),
            upper.get([group.clone()].as_slice()),
            upper.get([].as_slice()),
        ];
        let owners: Vec<&Object> = owners.into_iter().flatten().copied().collect();
        Ordinate::Real(scaling::scaled(&owners, numbers)?)
    };
    let text = |name: &str| {
        channel
            .property(name)
            .and_then(|property| property.value.as_text())
    };
    let (start, step) = (
        real(channel, "wf_start_offset")?,
        real(channel, "wf_increment")?,
    );
    let x_unit = text("wf_xunit_string");
    let (kind, abscissa_axis) = match step {
        None => (SeriesKind::General, axis("Sample", "")),
        Some(_) => {
            let unit = x_unit.unwrap_or("s");
            let kind = if unit == "s" {
                SeriesKind::TimeResponse
            } else {
                SeriesKind::General
            };
            (
                kind,
                axis(
                    text("wf_xname").unwrap_or(if unit == "s" { "Time" } else { "" }),
                    unit,
                ),
            )
        }
    };
    let unit = match numbers.first_time {
        Some(_) => "s",
        None => text("unit_string").unwrap_or_default(),
    };
    Ok(Series {
        name: name.clone(),
        kind,
        abscissa: Abscissa::Even {
            start: start.unwrap_or(0.0),
            step: step.unwrap_or(1.0),
        },
        ordinate,
        abscissa_axis,
        ordinate_axis: axis(
            text("NI_UnitDescription")
                .filter(|said| *said != unit)
                .unwrap_or_default(),
            unit,
        ),
        properties,
    })
}

/// Returns the property called `name`, if there is one; it must be a finite number.
fn real(channel: &Object, name: &str) -> Result<Option<f64>, LabioError> {
    let Some(Property { value, place, .. }) = channel.property(name) else {
        return Ok(None);
    };
    match value.as_real().filter(|number| number.is_finite()) {
        Some(number) => Ok(Some(number)),
        None => Err(malformed(
            *place,
            format!("property `{name}`"),
            value.to_text(),
            "a finite number",
        )),
    }
}
