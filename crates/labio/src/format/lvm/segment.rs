//! A segment of a LabVIEW measurement file: its header and the rows that follow.

use std::collections::HashMap;

use super::{END_OF_HEADER, END_SPECIAL, Preamble, START_SPECIAL, Source, XColumns, malformed};
use crate::format::Strictness;
use crate::format::rounding::{CustomaryRate, Written, WrittenValues, customary_rate};
use crate::format::text::{self, DecimalMark};
use crate::{Abscissa, Contents, LabioError, Ordinate, Place, Series, SeriesAxis, SeriesKind};

/// Relative rounding of `Delta_X` from which on a customary rate is proposed: below it, the error of a frequency is less than
/// a hundredth of a line in ten thousand lines.
const NOTICEABLE_ROUNDING: f64 = 1e-6;

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

/// A line of the header, cut at the separators.
struct Tag<'a> {
    line: u64,
    name: &'a str,
    values: Vec<&'a str>,
}

/// What the header and the rows say of one channel.
struct Channel {
    label: String,
    /// Column of the table.
    column: usize,
    samples: Option<usize>,
    start: Written,
    step: Option<Written>,
    /// Whether the column of abscissae is this channel's.
    owns_x: bool,
    x: WrittenValues,
    values: Vec<f64>,
    abscissa_axis: SeriesAxis,
    ordinate_axis: SeriesAxis,
    kind: SeriesKind,
    properties: Vec<(String, String)>,
}

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
        // the labels bound what is allocated for the channels that are announced
        let Some(width) = width.filter(|&width| width <= labels.len()) else {
            return Err(malformed(
                Place::Line(label_line),
                "row of labels",
                format!("{} columns", labels.len()),
                &format!("those of the {n_channels} channels announced"),
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
                    "there a second time".to_owned(),
                    "one line of it in the header of the segment",
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

    /// The series of the segment, those of the first block first.
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

/// Passes over a block whose meaning only its writer knows.
fn skip_special(source: &mut Source<'_>) -> Result<(), LabioError> {
    loop {
        if source.header_line()?.1.starts_with(END_SPECIAL) {
            return Ok(());
        }
    }
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

/// The decimal mark of a file that names none, by the numbers of its header.
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

/// The header of a segment with what is needed to understand it.
struct Header<'a> {
    tags: HashMap<&'a str, &'a Tag<'a>>,
    labels: &'a [&'a str],
    mark: DecimalMark,
    first_line: u64,
}

impl Header<'_> {
    /// The value of `tag` for the channel whose samples stand in `column`.
    fn value(&self, tag: &str, column: usize) -> Option<(u64, &str)> {
        let tag = self.tags.get(tag)?;
        let value = tag.values.get(column.checked_sub(1)?)?;
        (!value.is_empty()).then_some((tag.line, value))
    }

    fn number(&self, tag: &str, column: usize) -> Result<Option<Written>, LabioError> {
        let Some((line, text)) = self.value(tag, column) else {
            return Ok(None);
        };
        match text::real(text, self.mark).filter(|value| value.is_finite()) {
            Some(value) => Ok(Some(Written {
                value,
                half_unit: text::half_unit(text, self.mark),
            })),
            None => Err(malformed(
                cell(line, column),
                tag,
                text::quoted(text),
                "a finite number",
            )),
        }
    }

    fn channel(&self, index: usize, x_columns: XColumns) -> Result<Channel, LabioError> {
        let column = match x_columns {
            XColumns::No | XColumns::One => index + 1,
            XColumns::Multi => 2 * index + 1,
        };
        let text_of = |tag| {
            self.value(tag, column)
                .map_or("", |(_, text)| text)
                .to_owned()
        };
        let samples = match self.value("Samples", column) {
            None => None,
            Some((line, text)) => Some(text.parse().map_err(|_| {
                malformed(cell(line, column), "Samples", text::quoted(text), "a count")
            })?),
        };
        let start = self.number("X0", column)?;
        let step = self.number("Delta_X", column)?;
        if step.is_none() && x_columns == XColumns::No {
            return Err(malformed(
                Place::Line(self.first_line),
                "Delta_X",
                "absent".to_owned(),
                "the tag for every channel where there is no column of X values",
            ));
        }
        let same_x = |tag| {
            self.value(tag, 1).map(|(_, text)| text)
                == self.value(tag, column).map(|(_, text)| text)
        };
        let owns_x = match x_columns {
            XColumns::No => false,
            XColumns::One => same_x("X0") && same_x("Delta_X"),
            XColumns::Multi => true,
        };
        let (dimension, unit_text) = (text_of("X_Dimension"), text_of("X_Unit_Label"));
        let time = dimension.is_empty() || dimension == "Time";
        let properties = ["Samples", "Date", "Time", "X0", "Delta_X"]
            .into_iter()
            .filter_map(|tag| {
                let (_, value) = self.value(tag, column)?;
                Some((tag.to_owned(), value.to_owned()))
            })
            .collect();
        Ok(Channel {
            label: self.labels.get(column).unwrap_or(&"").to_string(),
            column,
            samples,
            start: start.unwrap_or(Written::exactly(0.0)),
            step,
            owns_x,
            x: WrittenValues::default(),
            values: Vec::new(),
            abscissa_axis: SeriesAxis {
                // seconds, by the definition of the format, if nothing else is said
                unit: text::known_unit(match unit_text.as_str() {
                    "" if time => "s",
                    unit => unit,
                }),
                label: match dimension.as_str() {
                    "" => "Time".to_owned(),
                    _ => dimension,
                },
                unit_text,
            },
            ordinate_axis: text::axis(text_of("Y_Dimension"), text_of("Y_Unit_Label")),
            kind: if time {
                SeriesKind::TimeResponse
            } else {
                SeriesKind::General
            },
            properties,
        })
    }
}

/// Place of a value in the table; columns are counted from 0 within and from 1 without.
fn cell(line: u64, column: usize) -> Place {
    Place::Cell {
        line,
        column: column as u64 + 1,
    }
}

/// The rows of a segment.
struct Rows {
    separator: char,
    mark: DecimalMark,
    /// Number of columns before the comment.
    width: usize,
    x_columns: XColumns,
    /// Number of rows of a packet, if it is announced.
    block: Option<usize>,
    n_rows: usize,
}

impl Rows {
    fn read(
        &mut self,
        source: &mut Source<'_>,
        channels: &mut [Channel],
        strictness: Strictness,
        contents: &mut Contents,
    ) -> Result<(), LabioError> {
        let mut defect = |error: LabioError| match strictness {
            Strictness::Strict => Err(error),
            Strictness::Tolerant => {
                contents.defects.push(error);
                Ok(())
            }
        };
        while let Some((line, text)) = source.skip_blank(self.separator) {
            let first = text.split(self.separator).next().unwrap_or("").trim();
            if first.starts_with(START_SPECIAL) {
                source.take();
                skip_special(source)?;
                continue;
            }
            if begins_header(first) {
                break;
            }
            source.take();
            let comment = self.row(line, text, channels, &mut defect)?;
            if let Some(comment) = comment {
                let place = format!("comment in line {line}");
                contents.properties.push((place, comment));
            }
            self.n_rows += 1;
        }
        let Some(block) = self.block.filter(|&block| block > 0) else {
            return Ok(());
        };
        if self.n_rows == 0 || !self.n_rows.is_multiple_of(block) {
            defect(malformed(
                Place::Line(source.last_line),
                "Samples",
                format!("{} rows", self.n_rows),
                &format!("{block} rows or a multiple, as announced"),
            ))?;
        }
        Ok(())
    }

    /// Takes one row; a cell that is empty where a sample should be, or full where none should be, is a defect.
    fn row(
        &self,
        line: u64,
        text: &str,
        channels: &mut [Channel],
        defect: &mut dyn FnMut(LabioError) -> Result<(), LabioError>,
    ) -> Result<Option<String>, LabioError> {
        let row_of_block = match self.block {
            Some(block) if block > 0 => self.n_rows % block,
            _ => self.n_rows,
        };
        let mut cells = text.split(self.separator).map(str::trim);
        let mut column = 0;
        let mut x = None;
        for channel in channels {
            let mut value = "";
            while column <= channel.column {
                value = cells.next().unwrap_or("");
                let is_x = match self.x_columns {
                    XColumns::No => false,
                    XColumns::One => column == 0,
                    XColumns::Multi => column.is_multiple_of(2),
                };
                if is_x {
                    x = Some((column, value));
                } else if column == 0 && !value.is_empty() {
                    let expected = "an empty cell, as `X_Columns` is `No`";
                    defect(malformed(
                        cell(line, 0),
                        "X_Value",
                        text::quoted(value),
                        expected,
                    ))?;
                }
                column += 1;
            }
            let awaited = channel.samples.is_none_or(|samples| row_of_block < samples);
            if value.is_empty() && (!awaited || channel.samples.is_none()) {
                continue;
            }
            if !awaited {
                let samples = channel.samples.unwrap_or(0);
                let expected = format!("an empty cell after {samples} samples");
                defect(malformed(
                    cell(line, channel.column),
                    &channel.label,
                    text::quoted(value),
                    &expected,
                ))?;
                continue;
            }
            let number = text::real(value, self.mark);
            if number.is_none() {
                let place = cell(line, channel.column);
                let found = text::quoted(value);
                defect(malformed(place, &channel.label, found, "a number"))?;
            }
            channel.values.push(number.unwrap_or(f64::NAN));
            if (channel.column == 1 || self.x_columns == XColumns::Multi)
                && let Some((column, text)) = x
            {
                let value = text::real(text, self.mark).filter(|value| value.is_finite());
                if value.is_none() {
                    let found = text::quoted(text);
                    defect(malformed(
                        cell(line, column),
                        "X_Value",
                        found,
                        "a finite number",
                    ))?;
                }
                let half_unit = text::half_unit(text, self.mark);
                channel.x.push(value.unwrap_or(f64::NAN), half_unit);
            }
        }
        while column < self.width {
            cells.next();
            column += 1;
        }
        let comment = cells.next().unwrap_or("");
        if let Some(extra) = cells.find(|cell| !cell.is_empty()) {
            let expected = "no column after that of the comments";
            defect(malformed(
                Place::Line(line),
                "row",
                text::quoted(extra),
                expected,
            ))?;
        }
        Ok((!comment.is_empty()).then(|| comment.to_owned()))
    }
}

/// Whether a row whose first cell is `first` is a tag.
fn begins_header(first: &str) -> bool {
    const TAGS: [&str; 19] = [
        "Channels",
        "Date",
        "Delta_X",
        "Notes",
        "Samples",
        "Test_Name",
        "Test_Numbers",
        "Test_Series",
        "Time",
        "UUT_M/N",
        "UUT_Name",
        "UUT_S/N",
        "X0",
        "X_Dimension",
        "X_Unit_Label",
        "Y_Dimension",
        "Y_Unit_Label",
        "Description",
        END_OF_HEADER,
    ];
    TAGS.contains(&first)
}

impl Channel {
    /// One series, or one for each block. `x` is the column of abscissae, if it is this channel's.
    fn into_series(
        self,
        first_line: u64,
        x: Option<&WrittenValues>,
    ) -> Result<Vec<Series>, LabioError> {
        let n = self.values.len();
        let x = match x {
            Some(_) if self.x.len() == n && n > 0 => Some(&self.x),
            Some(x) if x.len() == n && n > 0 => Some(x),
            _ => None,
        };
        let block = self.samples.filter(|&samples| samples > 0).unwrap_or(n);
        let even = |start: f64, step: f64| Abscissa::Even { start, step };
        let whole = |abscissa| Ok(vec![self.series(0..n, abscissa, None)]);
        let Some(step) = self.step else {
            return match x.map(|x| (x, x.even_spacing())) {
                Some((_, Some((start, step))))
                    if step.half_unit <= NOTICEABLE_ROUNDING * step.value.abs() =>
                {
                    whole(even(start, step.value))
                }
                Some((x, _)) => whole(Abscissa::Uneven(x.values.clone())),
                None => Err(malformed(
                    Place::Line(first_line),
                    "Delta_X",
                    "absent".to_owned(),
                    &format!(
                        "the tag for channel `{}`, which has no X values",
                        self.label
                    ),
                )),
            };
        };
        let Some(x) = x else {
            let blocks = n.div_ceil(block.max(1)).max(1);
            return Ok((0..blocks)
                .map(|b| {
                    let range = b * block..n.min((b + 1) * block);
                    self.series(
                        range,
                        even(self.start.value, step.value),
                        (blocks > 1).then_some(b + 1),
                    )
                })
                .collect());
        };
        if x.first_off(self.start, step).is_none() {
            return whole(even(self.start.value, step.value));
        }
        // the packets of a file with one header: each starts at a time of its own
        let starts: Option<Vec<Written>> = (block > 1)
            .then(|| {
                (0..n)
                    .step_by(block)
                    .map(|from| {
                        let part = x.part(from..n.min(from + block));
                        let start = part.get(0)?;
                        part.first_off(start, step).is_none().then_some(start)
                    })
                    .collect()
            })
            .flatten();
        match starts {
            Some(starts) => {
                let several = starts.len() > 1;
                Ok(starts
                    .iter()
                    .enumerate()
                    .map(|(b, start)| {
                        let range = b * block..n.min((b + 1) * block);
                        self.series(
                            range,
                            even(start.value, step.value),
                            several.then_some(b + 1),
                        )
                    })
                    .collect())
            }
            None => whole(Abscissa::Uneven(x.values.clone())),
        }
    }

    fn series(
        &self,
        range: std::ops::Range<usize>,
        abscissa: Abscissa,
        block: Option<usize>,
    ) -> Series {
        let mut properties = self.properties.clone();
        if let Some(block) = block {
            properties.push(("block".to_owned(), block.to_string()));
        }
        if let (Abscissa::Even { .. }, Some(rate)) = (&abscissa, self.rate_behind_rounding()) {
            let text = format!("{} Hz, {}", rate.rate_hz, rate.family);
            properties.push(("customary rate".to_owned(), text));
        }
        Series {
            name: self.label.clone(),
            kind: self.kind,
            abscissa,
            ordinate: Ordinate::Real(self.values.get(range).unwrap_or(&[]).to_vec()),
            abscissa_axis: self.abscissa_axis.clone(),
            ordinate_axis: self.ordinate_axis.clone(),
            properties,
        }
    }

    /// The customary rate that `Delta_X` was rounded from, if it is not that of `Delta_X` as written.
    fn rate_behind_rounding(&self) -> Option<CustomaryRate> {
        let step = self.step?;
        let noticeable =
            |rate: &CustomaryRate| (rate.rate_hz * step.value - 1.0).abs() > NOTICEABLE_ROUNDING;
        (self.kind == SeriesKind::TimeResponse)
            .then(|| customary_rate(step.value, step.half_unit))
            .flatten()
            .filter(noticeable)
    }
}
