//! LabVIEW measurement files (`.lvm`): text tables with a header of tags for the file and one
//! header for each segment.
//!
//! ```text
//! LabVIEW Measurement
//! Separator   Tab
//! X_Columns   No
//! ***End_of_Header***
//!
//! Channels    2
//! Samples     8192      8192
//! Delta_X     1.953125E-5   1.953125E-5
//! ***End_of_Header***
//! X_Value     hammer    end A     Comment
//!             0.052530  0.234571
//! ```
//!
//! # Abscissa
//!
//! The column of X values is printed with six decimals and does not give exact times. If it agrees
//! within its digits with $`X_0 + i\,\Delta_X`$, the tags `X0` and `Delta_X` are used; otherwise
//! the values are uneven and used as written. `Delta_X` itself may be rounded (`0.000977` for
//! 1/1024 s). It is kept as written, and the property `customary rate` of the series names the rate
//! that it may represent ([`customary_rate`](super::customary_rate)).
//!
//! # Blocks
//!
//! A file in which only the first packet has a header (`Multi_Headings No`) continues with the rows
//! of the next packets. If the X values continue evenly, the packets are one series. Otherwise
//! every packet is a series with the property `block`; files with several hits are written in this
//! way. If the packets are single rows, they are one series with an uneven abscissa.
//!
//! # Strictness
//!
//! A strict reading rejects the following faults; a tolerant one reports them as defects: a packet
//! with fewer rows than `Samples` announces (the end of a truncated file), a cell that is missing
//! or not a number (its value is NaN), a filled cell where a channel has no sample, and a header
//! after the first segment that cannot be understood.

mod channel;
mod rows;
mod segment;

use crate::error;
use crate::format::text::{self, DecimalMark};
use crate::format::{Reader, Strictness};
use crate::{Contents, LabioError, Place};

use segment::Segment;

const FORMAT: &str = "lvm";
const END_OF_HEADER: &str = "***End_of_Header***";
const START_SPECIAL: &str = "***Start_Special***";
const END_SPECIAL: &str = "***End_Special***";

/// LabVIEW measurement files, read only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lvm;

impl Reader for Lvm {
    fn name(&self) -> &'static str {
        FORMAT
    }

    fn recognises(&self, head: &[u8]) -> bool {
        let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
        head.starts_with(b"LabVIEW Measurement")
    }

    fn read(&self, bytes: &[u8], strictness: Strictness) -> Result<Contents, LabioError> {
        let (text, encoding) = text::decode(bytes, FORMAT)?;
        let mut source = Source::of(&text);
        let preamble = Preamble::read(&mut source)?;
        let mut contents = Contents::of_format(FORMAT);
        contents.properties = preamble.tags.clone();
        contents
            .properties
            .push(("encoding".to_owned(), encoding.name().to_owned()));
        let mut number = 0;
        while source.skip_blank(preamble.separator).is_some() {
            number += 1;
            match Segment::read(&mut source, &preamble, strictness, &mut contents) {
                Ok(segment) => contents.series.extend(segment.into_series(number)?),
                Err(error) if strictness == Strictness::Tolerant && number > 1 => {
                    contents.defects.push(error);
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        if number == 0 {
            return Err(LabioError::NoData { format: FORMAT });
        }
        Ok(contents)
    }

    fn states_length(&self) -> bool {
        false
    }

    fn reads_tables(&self) -> bool {
        true
    }
}

/// The lines that are still to be read.
struct Source<'a> {
    lines: Box<dyn Iterator<Item = (u64, &'a str)> + 'a>,
    next: Option<(u64, &'a str)>,
    last_line: u64,
}

impl<'a> Source<'a> {
    fn of(text: &'a str) -> Self {
        let mut lines = text::lines(text);
        let next = lines.next();
        Self {
            lines: Box::new(lines),
            next,
            last_line: 0,
        }
    }

    fn peek(&self) -> Option<(u64, &'a str)> {
        self.next
    }

    fn take(&mut self) -> Option<(u64, &'a str)> {
        let taken = self.next.take()?;
        self.last_line = taken.0;
        self.next = self.lines.next();
        Some(taken)
    }

    /// Returns the next line that contains more than separators, without consuming it.
    fn skip_blank(&mut self, separator: char) -> Option<(u64, &'a str)> {
        while let Some((number, line)) = self.peek() {
            if !line.chars().all(|c| c == separator || c.is_whitespace()) {
                return Some((number, line));
            }
            self.take();
        }
        None
    }

    /// Returns the next line, which belongs to a header.
    fn header_line(&mut self) -> Result<(u64, &'a str), LabioError> {
        self.take().ok_or_else(|| {
            malformed(
                Place::Line(self.last_line),
                "header",
                "the end of the file".to_owned(),
                END_OF_HEADER,
            )
        })
    }
}

fn malformed(place: Place, field: &str, found: String, expected: &str) -> LabioError {
    error::malformed(FORMAT, place, field, found, expected)
}

/// The columns that contain abscissae.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum XColumns {
    /// No abscissa; the first column is present but empty.
    No,
    /// The first column, for the first channel.
    One,
    /// One abscissa column before each channel.
    Multi,
}

/// The header of the file.
#[derive(Debug)]
struct Preamble {
    separator: char,
    mark: Option<DecimalMark>,
    x_columns: XColumns,
    tags: Vec<(String, String)>,
}

impl Preamble {
    fn read(source: &mut Source<'_>) -> Result<Self, LabioError> {
        match source.take() {
            Some((_, line)) if line.starts_with("LabVIEW Measurement") => {}
            other => {
                return Err(malformed(
                    Place::Line(1),
                    "first line",
                    text::quoted(other.map_or("", |(_, line)| line)),
                    "`LabVIEW Measurement`",
                ));
            }
        }
        let mut separator = None;
        let (mut mark, mut x_columns) = (None, None);
        let mut tags = Vec::new();
        loop {
            let (number, line) = source.header_line()?;
            if line.starts_with(END_OF_HEADER) {
                break;
            }
            let Some(at) = line.find(['\t', ',', ';']) else {
                if line.trim().is_empty() {
                    continue;
                }
                return Err(malformed(
                    Place::Line(number),
                    "tag",
                    text::quoted(line),
                    "a tag, a separator and a value",
                ));
            };
            let (tag, rest) = line.split_at(at);
            let found = rest.chars().next().unwrap_or('\t');
            let sign = *separator.get_or_insert(found);
            if sign != found {
                return Err(malformed(
                    Place::Line(number),
                    tag,
                    format!("the separator {found:?}"),
                    &format!("{sign:?} as in the previous lines"),
                ));
            }
            let value = match rest.get(1..) {
                Some(",") if tag == "Decimal_Separator" => ",",
                Some(value) => value.split(sign).next().unwrap_or(""),
                None => "",
            };
            let wrong = |expected: &str| {
                Err(malformed(
                    Place::Line(number),
                    tag,
                    text::quoted(value),
                    expected,
                ))
            };
            match (tag, value) {
                ("Separator", "Tab") if sign == '\t' => {}
                ("Separator", "Comma") if sign == ',' => {}
                ("Separator", "Semicolon") if sign == ';' => {}
                ("Separator", _) => {
                    return wrong(&format!(
                        "the name of the character after the tag, {sign:?}"
                    ));
                }
                ("Decimal_Separator", ".") => mark = Some(DecimalMark::Point),
                ("Decimal_Separator", ",") if sign != ',' => mark = Some(DecimalMark::Comma),
                ("Decimal_Separator", _) => {
                    return wrong("`.` or, unless it separates columns, `,`");
                }
                ("X_Columns", "No") => x_columns = Some(XColumns::No),
                ("X_Columns", "One") => x_columns = Some(XColumns::One),
                ("X_Columns", "Multi") => x_columns = Some(XColumns::Multi),
                ("X_Columns", _) => return wrong("`No`, `One` or `Multi`"),
                _ => {}
            }
            tags.push((tag.to_owned(), value.to_owned()));
        }
        let absent = |tag| {
            malformed(
                Place::Line(source.last_line),
                tag,
                "absent".to_owned(),
                "the tag before the end of the header",
            )
        };
        Ok(Self {
            separator: separator.ok_or_else(|| absent("Separator"))?,
            mark,
            x_columns: x_columns.ok_or_else(|| absent("X_Columns"))?,
            tags,
        })
    }
}
