//! A segment of a LabVIEW measurement file: its header and the rows that follow.

use std::collections::HashMap;

use super::channel::{Channel, Header, Tag};
use super::rows::{Rows, skip_special};
use super::{END_OF_HEADER, Preamble, START_SPECIAL, Source, XColumns, malformed};
use crate::format::Strictness;
use crate::format::text::{self, DecimalMark};
use crate::{Contents, LabioError, Place, Series};

/// Tags that have a value for each channel.
const OF_CHANNELS: [&str; 9] = [
    "Samples",
    "Date",
    "Time",
    "X0",
    "Delta_X",
    "X_Dimension",
    "X_Unit_Label",
    "Y_Dimension",
    "Y_Unit_Label",
];

/// The channels of a segment with their samples.
pub(super) struct Segment {
    first_line: u64,
    channels: Vec<Channel>,
}

impl Segment {
    pub(super) fn read(
        source: &mut Source<'_>,
        preamble: &Preamble,
        strictness: Strictness,
        contents: &mut Contents,
    ) -> Result<Self, LabioError> {
        let separator = preamble.separator;
        let (tags, first_line) = read_tags(source, separator)?;
        let (label_line, labels) = source.header_line()?;
        let labels: Vec<&str> = labels.split(separator).map(str::trim).collect();
        if labels.first() != Some(&"X_Value") {
            return Err(malformed(
                Place::Line(label_line),
                "row of labels",
                text::quoted(labels.first().unwrap_or(&"")),
                "`X_Value`",
            ));
        }
        let n_channels = n_channels(&tags, first_line)?;
        let width = match preamble.x_columns {
            XColumns::No | XColumns::One => n_channels.checked_add(1),
            XColumns::Multi => n_channels.checked_mul(2),
        };
        // the number of labels limits the memory that is allocated for the announced channels
        let Some(width) = width.filter(|&width| width <= labels.len()) else {
            return Err(malformed(
                Place::Line(label_line),
                "row of labels",
                format!("{} columns", labels.len()),
                &format!("those of the {n_channels} channels stated in the header"),
            ));
        };
        let mark = preamble
            .mark
            .unwrap_or_else(|| mark_by_content(&tags, separator));
        let mut of_channels = HashMap::new();
        for tag in &tags {
            if !OF_CHANNELS.contains(&tag.name) {
                let value = tag.values.first().copied().unwrap_or("");
                if tag.name != "Channels" && !value.is_empty() {
                    let property = (tag.name.to_owned(), value.to_owned());
                    contents.properties.push(property);
                }
            } else if of_channels.insert(tag.name, tag).is_some() {
                return Err(malformed(
                    Place::Line(tag.line),
                    tag.name,
                    "present a second time".to_owned(),
                    "one line with this tag in the header of the segment",
                ));
            }
        }
        let header = Header {
            tags: of_channels,
            labels: &labels,
            mark,
            first_line,
        };
        let mut channels = (0..n_channels)
            .map(|index| header.channel(index, preamble.x_columns))
            .collect::<Result<Vec<_>, _>>()?;
        let mut rows = Rows {
            separator,
            mark,
            width,
            x_columns: preamble.x_columns,
            block: channels
                .iter()
                .map(|channel| channel.samples)
                .max()
                .flatten(),
            n_rows: 0,
        };
        rows.read(source, &mut channels, strictness, contents)?;
        Ok(Self {
            first_line,
            channels,
        })
    }

    /// Returns the series of the segment, block by block.
    pub(super) fn into_series(self, number: usize) -> Result<Vec<Series>, LabioError> {
        let mut blocks: Vec<Vec<Series>> = Vec::new();
        let first = self.channels.first().map(|channel| channel.x.clone());
        for channel in self.channels {
            let shared = first.as_ref().filter(|_| channel.owns_x);
            for (index, mut series) in channel
                .into_series(self.first_line, shared)?
                .into_iter()
                .enumerate()
            {
                if number > 1 {
                    let segment = ("segment".to_owned(), number.to_string());
                    series.properties.push(segment);
                }
                if index == blocks.len() {
                    blocks.push(Vec::new());
                }
                if let Some(block) = blocks.get_mut(index) {
                    block.push(series);
                }
            }
        }
        Ok(blocks.into_iter().flatten().collect())
    }
}

fn read_tags<'a>(
    source: &mut Source<'a>,
    separator: char,
) -> Result<(Vec<Tag<'a>>, u64), LabioError> {
    let mut tags = Vec::new();
    let mut first_line = None;
    loop {
        let (line, text) = source.header_line()?;
        first_line.get_or_insert(line);
        if text.starts_with(END_OF_HEADER) {
            break;
        }
        let mut values = text.split(separator);
        match values.next().map(str::trim) {
            Some("") | None => {}
            Some(START_SPECIAL) => skip_special(source)?,
            Some(name) => tags.push(Tag {
                line,
                name,
                values: values.map(str::trim).collect(),
            }),
        }
    }
    Ok((tags, first_line.unwrap_or(1)))
}

fn n_channels(tags: &[Tag<'_>], first_line: u64) -> Result<usize, LabioError> {
    let Some(tag) = tags.iter().find(|tag| tag.name == "Channels") else {
        return Err(malformed(
            Place::Line(first_line),
            "Channels",
            "absent".to_owned(),
            "the tag in the header of the segment",
        ));
    };
    let text = tag.values.first().unwrap_or(&"");
    text.parse().ok().filter(|&n| n > 0).ok_or_else(|| {
        malformed(
            Place::Line(tag.line),
            "Channels",
            text::quoted(text),
            "a count above 0",
        )
    })
}

/// Returns the decimal mark of a file that does not state it, found from the numbers of its header.
fn mark_by_content(tags: &[Tag<'_>], separator: char) -> DecimalMark {
    let comma = tags
        .iter()
        .filter(|tag| matches!(tag.name, "X0" | "Delta_X"))
        .flat_map(|tag| &tag.values)
        .any(|value| value.contains(','));
    if comma && separator != ',' {
        DecimalMark::Comma
    } else {
        DecimalMark::Point
    }
}
