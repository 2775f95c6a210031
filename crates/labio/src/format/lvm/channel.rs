//! A channel of a segment: its header entries and the series of its samples.

use std::collections::HashMap;

use super::{XColumns, malformed};
use crate::format::rounding::{CustomaryRate, Written, WrittenValues, customary_rate};
use crate::format::text::{self, DecimalMark};
use crate::{Abscissa, LabioError, Ordinate, Place, Series, SeriesAxis, SeriesKind};

/// A line of the header, cut at the separators.
pub(super) struct Tag<'a> {
    pub(super) line: u64,
    pub(super) name: &'a str,
    pub(super) values: Vec<&'a str>,
}

/// Relative rounding of `Delta_X` above which a customary rate is proposed: a smaller rounding
/// changes no frequency by more than a relative 1e-6.
const NOTICEABLE_ROUNDING: f64 = 1e-6;

/// Header entries and samples of one channel.
pub(super) struct Channel {
    pub(super) label: String,
    /// Column of the table, from 0.
    pub(super) column: usize,
    pub(super) samples: Option<usize>,
    pub(super) start: Written,
    pub(super) step: Option<Written>,
    /// True if the column of abscissae also applies to this channel.
    pub(super) owns_x: bool,
    pub(super) x: WrittenValues,
    pub(super) values: Vec<f64>,
    pub(super) abscissa_axis: SeriesAxis,
    pub(super) ordinate_axis: SeriesAxis,
    pub(super) kind: SeriesKind,
    pub(super) properties: Vec<(String, String)>,
}

/// The header of a segment and the data needed to interpret it.
pub(super) struct Header<'a> {
    pub(super) tags: HashMap<&'a str, &'a Tag<'a>>,
    pub(super) labels: &'a [&'a str],
    pub(super) mark: DecimalMark,
    pub(super) first_line: u64,
}

impl Header<'_> {
    /// Value of `tag` for the channel whose samples are in `column`.
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
                Place::cell(line, column),
                tag,
                text::quoted(text),
                "a finite number",
            )),
        }
    }

    pub(super) fn channel(&self, index: usize, x_columns: XColumns) -> Result<Channel, LabioError> {
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
                malformed(
                    Place::cell(line, column),
                    "Samples",
                    text::quoted(text),
                    "a count",
                )
            })?),
        };
        let start = self.number("X0", column)?;
        let step = self.number("Delta_X", column)?;
        if step.is_none() && x_columns == XColumns::No {
            return Err(malformed(
                Place::Line(self.first_line),
                "Delta_X",
                "absent".to_owned(),
                "the tag for every channel, since there is no column of X values",
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
                // seconds, by the definition of the format, unless the header gives another unit
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

impl Channel {
    /// Returns one series, or one per block. `x` is the shared column of abscissae, if it applies
    /// to this channel.
    pub(super) fn into_series(
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
        // packets of a file in which only the first one has a header: each has its own start time
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
        #[allow(
            clippy::indexing_slicing,
            reason = "the ranges of blocks end with the values or before"
        )]
        let values = self.values[range].to_vec();
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
            ordinate: Ordinate::Real(values),
            abscissa_axis: self.abscissa_axis.clone(),
            ordinate_axis: self.ordinate_axis.clone(),
            properties,
        }
    }

    /// Returns the customary rate that was probably rounded to give `Delta_X`, if it differs from
    /// the rate of `Delta_X` as written.
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
