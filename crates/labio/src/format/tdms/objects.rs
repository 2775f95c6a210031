//! The objects of a file (file, groups and channels) as described by the metadata of its segments.

use std::collections::HashMap;

use super::bytes::Bytes;
use super::malformed;
use super::numbers::Numbers;
use super::segment::Segment;
use super::value::{Sample, Value};
use crate::format::number_type::NumberType;
use crate::{LabioError, Place};

const NO_RAW_DATA: u32 = u32::MAX;
const SAME_AS_BEFORE: u32 = 0;
const FORMAT_CHANGING_SCALER: u32 = 0x1269;
/// The code found in files; the published description states 0x1369 instead, which occurs in no
/// known file.
const DIGITAL_LINE_SCALER: u32 = 0x126a;
const TEXT: u32 = 0x20;
const DAQMX_RAW_DATA: u32 = u32::MAX;

/// A number within a row of a DAQmx buffer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Scaler {
    pub(super) sample: Sample,
    pub(super) buffer: usize,
    /// Offset in the row.
    pub(super) byte: usize,
    /// Bit within that byte, if the scaler is a digital line.
    pub(super) bit: Option<u32>,
    /// The scale that uses the number as input.
    pub(super) scale: u32,
}

/// Layout of the raw data of one object in a chunk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum RawIndex {
    Numbers {
        sample: Sample,
        n: u64,
    },
    Text {
        n_bytes: u64,
    },
    Daqmx {
        n: u64,
        scalers: Vec<Scaler>,
        widths: Vec<usize>,
    },
}

/// A property and its place in the file.
#[derive(Debug, Clone)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) value: Value,
    pub(super) place: Place,
}

/// File, group or channel.
#[derive(Debug)]
pub(super) struct Object {
    /// Names of the group and the channel: empty for the file, one name for a group.
    pub(super) path: Vec<String>,
    properties: Vec<Property>,
    by_name: HashMap<String, usize>,
    pub(super) index: Option<RawIndex>,
    pub(super) index_place: Place,
    pub(super) numbers: Numbers,
    /// True if the object has data in the current segment.
    has_data: bool,
    /// True if the object is among [`Objects::with_data`].
    listed: bool,
}

impl Object {
    pub(super) fn properties(&self) -> &[Property] {
        &self.properties
    }

    pub(super) fn property(&self, name: &str) -> Option<&Property> {
        self.by_name
            .get(name)
            .and_then(|&slot| self.properties.get(slot))
    }

    /// Sets a property; later segments repeat properties that have changed, for example the largest
    /// value so far.
    fn set(&mut self, property: Property) {
        match self
            .by_name
            .get(&property.name)
            .and_then(|&slot| self.properties.get_mut(slot))
        {
            Some(known) => *known = property,
            None => {
                self.by_name
                    .insert(property.name.clone(), self.properties.len());
                self.properties.push(property);
            }
        }
    }
}

/// All objects described by the segments so far.
#[derive(Debug, Default)]
pub(super) struct Objects {
    pub(super) all: Vec<Object>,
    by_path: HashMap<String, usize>,
    /// The objects with raw data in the current segment, in the order of the data.
    pub(super) with_data: Vec<usize>,
}

impl Objects {
    /// Applies the metadata of `segment`; without metadata, nothing changes.
    pub(super) fn update(&mut self, segment: &Segment<'_>) -> Result<(), LabioError> {
        if !segment.contains.metadata() {
            return Ok(());
        }
        if segment.contains.new_object_list() {
            for slot in self.with_data.drain(..) {
                if let Some(object) = self.all.get_mut(slot) {
                    object.has_data = false;
                    object.listed = false;
                }
            }
        }
        let mut bytes = segment.metadata;
        let n_objects = bytes.u32("number of objects")?;
        for _ in 0..n_objects {
            self.object(&mut bytes)?;
        }
        self.with_data.retain(|&slot| {
            self.all.get_mut(slot).is_some_and(|object| {
                object.listed = object.has_data;
                object.listed
            })
        });
        Ok(())
    }

    fn object(&mut self, bytes: &mut Bytes<'_>) -> Result<(), LabioError> {
        let place = bytes.place();
        let path = bytes.text("path of an object")?;
        let slot = match self.by_path.get(path) {
            Some(&slot) => slot,
            None => {
                let names = names(path).ok_or_else(|| {
                    malformed(
                        place,
                        "path of an object",
                        format!("`{path}`"),
                        "`/`, `/'group'` or `/'group'/'channel'`",
                    )
                })?;
                self.by_path.insert(path.to_owned(), self.all.len());
                self.all.push(Object {
                    path: names,
                    properties: Vec::new(),
                    by_name: HashMap::new(),
                    index: None,
                    index_place: place,
                    numbers: Numbers::default(),
                    has_data: false,
                    listed: false,
                });
                self.all.len() - 1
            }
        };
        let Some(object) = self.all.get_mut(slot) else {
            return Ok(()); // every slot was pushed above
        };
        let index_place = bytes.place();
        match bytes.u32("raw data index")? {
            NO_RAW_DATA => object.has_data = false,
            SAME_AS_BEFORE => {
                if object.index.is_none() {
                    let expected =
                        format!("an index in this segment or an earlier one, for `{path}`");
                    return Err(malformed(
                        index_place,
                        "raw data index",
                        "the same as before",
                        expected,
                    ));
                }
                object.has_data = true;
            }
            kind => {
                object.index = Some(raw_index(kind, index_place, bytes)?);
                object.index_place = index_place;
                object.has_data = true;
            }
        }
        if object.has_data && !object.listed {
            object.listed = true;
            self.with_data.push(slot);
        }
        let n_properties = bytes.u32("number of properties")?;
        for _ in 0..n_properties {
            let place = bytes.place();
            let name = bytes.text("name of a property")?;
            let value = Value::read(bytes, name)?;
            object.set(Property {
                name: name.to_owned(),
                value,
                place,
            });
        }
        Ok(())
    }
}

/// Splits a path into names, each after a slash and in quotation marks (doubled within a name). A
/// path has at most two names.
fn names(path: &str) -> Option<Vec<String>> {
    let mut names = Vec::new();
    let mut rest = path;
    if path == "/" {
        return Some(names);
    }
    while !rest.is_empty() {
        rest = rest.strip_prefix("/'")?;
        let mut name = String::new();
        loop {
            let (before, after) = rest.split_once('\'')?;
            name.push_str(before);
            match after.strip_prefix('\'') {
                Some(more) => {
                    name.push('\'');
                    rest = more;
                }
                None => {
                    rest = after;
                    break;
                }
            }
        }
        names.push(name);
    }
    (1..=2).contains(&names.len()).then_some(names)
}

fn raw_index(kind: u32, place: Place, bytes: &mut Bytes<'_>) -> Result<RawIndex, LabioError> {
    const FIELD: &str = "raw data index";
    let code = bytes.u32(FIELD)?;
    let at = bytes.place();
    let dimension = bytes.u32("array dimension")?;
    if dimension != 1 {
        return Err(malformed(at, "array dimension", dimension.to_string(), "1"));
    }
    let n = bytes.u64("number of values")?;
    let unknown_type = || {
        malformed(
            place,
            "data type of raw data",
            format!("0x{code:x}"),
            "a type whose size is known",
        )
    };
    match kind {
        FORMAT_CHANGING_SCALER | DIGITAL_LINE_SCALER => {
            if code != DAQMX_RAW_DATA && Sample::of_code(code).is_none() {
                return Err(unknown_type());
            }
            daqmx_index(kind == DIGITAL_LINE_SCALER, n, bytes)
        }
        20 => {
            let sample = Sample::of_code(code).ok_or_else(unknown_type)?;
            Ok(RawIndex::Numbers { sample, n })
        }
        28 if code == TEXT => Ok(RawIndex::Text {
            n_bytes: bytes.u64("number of bytes of texts")?,
        }),
        other => Err(malformed(
            place,
            FIELD,
            format!("0x{other:x}"),
            "its length (20, or 28 for texts), 0, 0x1269, 0x126a or 0xffffffff",
        )),
    }
}

fn daqmx_index(digital: bool, n: u64, bytes: &mut Bytes<'_>) -> Result<RawIndex, LabioError> {
    const FIELD: &str = "DAQmx scaler";
    let n_scalers = bytes.u32("number of DAQmx scalers")?;
    let mut scalers = Vec::new();
    let mut places = Vec::new();
    for _ in 0..n_scalers {
        let place = bytes.place();
        let code = bytes.u32(FIELD)?;
        let sample = Sample::of_daqmx_code(code).ok_or_else(|| {
            malformed(
                place,
                "data type of a DAQmx scaler",
                code.to_string(),
                "0 to 9",
            )
        })?;
        let buffer = index(bytes.u32(FIELD)?);
        let offset = bytes.u32(FIELD)?;
        // the sample format is always 0, and its meaning is unknown
        if digital {
            bytes.u8(FIELD)?;
        } else {
            bytes.u32(FIELD)?;
        }
        let scale = bytes.u32(FIELD)?;
        scalers.push(Scaler {
            sample: if digital {
                Sample::Number(NumberType::U8)
            } else {
                sample
            },
            buffer,
            byte: index(if digital { offset / 8 } else { offset }),
            bit: digital.then_some(offset % 8),
            scale,
        });
        places.push(place);
    }
    let n_widths = bytes.u32("number of DAQmx buffers")?;
    let mut widths = Vec::new();
    for _ in 0..n_widths {
        widths.push(index(bytes.u32("width of a DAQmx buffer")?));
    }
    for (scaler, place) in scalers.iter().zip(places) {
        let width = widths.get(scaler.buffer).copied().unwrap_or(0);
        if scaler.byte.saturating_add(scaler.sample.size()) > width {
            return Err(malformed(
                place,
                FIELD,
                format!(
                    "byte {} of buffer {}, {} bytes long",
                    scaler.byte,
                    scaler.buffer,
                    scaler.sample.size()
                ),
                format!(
                    "a position within one of the buffers, whose rows are {widths:?} bytes wide"
                ),
            ));
        }
    }
    Ok(RawIndex::Daqmx { n, scalers, widths })
}

/// Converts a 32-bit number to an index; a number too large for the machine becomes an index beyond
/// every end.
fn index(number: u32) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}

#[cfg(test)]
mod tests {
    use super::names;

    #[test]
    fn paths_have_names_in_quotation_marks() {
        let found = |path: &str| names(path).map(|names| names.join("|"));
        assert_eq!(found("/"), Some(String::new()));
        assert_eq!(found("/'Measured Data'"), Some("Measured Data".to_owned()));
        assert_eq!(
            found("/'Dr. T''s Events'/'Time'"),
            Some("Dr. T's Events|Time".to_owned())
        );
        assert_eq!(found("/'a/b'/''''"), Some("a/b|'".to_owned()));
        for path in ["", "x", "/'open", "/'a'x", "/'a'/'b'/'c'", "//"] {
            assert_eq!(found(path), None, "{path}");
        }
    }
}
