//! Files of records like those of a recorder, and the statements of a sheet that are needed to read
//! them.

use labio::format::Writer;
use labio::format::csv::Csv;
use labio::format::npy::Npy;
use labio::format::npz::Npz;
use labio::format::uff58::{ByteOrder, Encoding, Uff58Writer};
use labio::format::wav::Wav;
use labio::{Abscissa, Contents, Ordinate, Record, Series, SeriesAxis, SeriesKind, Unit};

use crate::RodlabError;
use crate::convert::fitted;
use crate::outcome::Attachment;

/// Name and format of the files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Naming {
    stem: String,
    extension: &'static str,
}

/// Extensions of the files, which determine their formats.
const EXTENSIONS: [&str; 5] = ["csv", "npy", "npz", "uff", "wav"];

impl Naming {
    /// Creates the naming from the name of a file, such as `hits.csv`.
    pub(super) fn of(output: &str) -> Result<Self, RodlabError> {
        let wrong = || {
            let expected = format!(
                "the name of a file in the folder of the result with one of the extensions {}",
                EXTENSIONS.join(", ")
            );
            RodlabError::request("output", format!("`{output}`"), expected)
        };
        let (stem, extension) = output.rsplit_once('.').ok_or_else(wrong)?;
        let mut known = EXTENSIONS.into_iter();
        let extension = known.find(|known| *known == extension).ok_or_else(wrong)?;
        let plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | ' ' | '.');
        if stem.is_empty() || stem.starts_with('.') || !stem.chars().all(plain) {
            return Err(wrong());
        }
        Ok(Self {
            stem: stem.to_owned(),
            extension,
        })
    }

    /// Returns the name of the record `number` of `of`, counted from 1. The alphabetical order of
    /// the names is that of the records.
    pub(super) fn file(&self, number: usize, of: usize) -> String {
        let extension = self.extension;
        let digits = of.to_string().len();
        format!("{}-{number:0digits$}.{extension}", self.stem)
    }

    /// Returns a pattern that matches all files.
    pub(super) fn pattern(&self) -> String {
        format!("{}-*.{}", self.stem, self.extension)
    }

    /// Returns the field `records` of a sheet that reads `files` of records like `record`, indented
    /// by `indent`; every channel gets the further fields `more`.
    pub(super) fn records_of_sheet(
        &self,
        (files, record): (&str, &Record),
        more: &str,
        indent: &str,
    ) -> String {
        let bare = self.extension == "npy";
        let rate = if bare {
            format!(
                "\n{indent}    sampling_rate: \"{} Hz\",",
                record.sampling_rate_hz()
            )
        } else {
            String::new()
        };
        let channels: String = record
            .channels()
            .iter()
            .enumerate()
            .map(|(index, channel)| {
                let name = channel.name();
                let from = if bare {
                    let unit = channel.quantity().unit();
                    format!("from: {}, unit: {unit:?}", index + 1)
                } else {
                    format!("from: {name:?}")
                };
                format!("\n{indent}        (name: {name:?}, {from}{more}),")
            })
            .collect();
        format!(
            "records: (\n{indent}    files: [{files:?}],{rate}\n{indent}    channels: [{channels}\n{indent}    ],\n{indent})"
        )
    }

    /// Returns `record` as a file. The generator is included if the format has a place for it.
    pub(super) fn attachment(
        &self,
        record: &Record,
        name: String,
        generator: &str,
    ) -> Result<Attachment, RodlabError> {
        let refused = |error| RodlabError::step(format!("writing {name}"), error);
        let mut contents = Contents::of_format("computed");
        let property = |name: &str| vec![(name.to_owned(), generator.to_owned())];
        let (of_file, of_series) = match self.extension {
            "csv" | "npz" => (property("generator"), Vec::new()),
            "wav" => (property("ISFT"), Vec::new()),
            "uff" => (Vec::new(), property("uff58.id2")),
            _ => (Vec::new(), Vec::new()),
        };
        contents.properties = of_file;
        let axis = |label: &str, unit: &str| -> Result<SeriesAxis, RodlabError> {
            Ok(SeriesAxis {
                label: match self.extension {
                    "wav" => String::new(),
                    _ => label.to_owned(),
                },
                unit_text: unit.to_owned(),
                unit: Some(Unit::parse(unit).map_err(refused)?),
            })
        };
        for channel in record.channels() {
            let samples = record.channel(channel.name()).map_err(refused)?.to_vec();
            let quantity = channel.quantity();
            contents.series.push(Series {
                name: channel.name().to_owned(),
                kind: SeriesKind::TimeResponse,
                abscissa: Abscissa::Even {
                    start: 0.0,
                    step: 1.0 / record.sampling_rate_hz(),
                },
                ordinate: Ordinate::Real(samples),
                abscissa_axis: axis("time", "s")?,
                ordinate_axis: axis(quantity.name(), quantity.unit())?,
                properties: of_series.clone(),
            });
        }
        if self.extension == "npy" {
            // an `npy` file contains only numbers, with one row per channel
            contents = fitted(&contents, "npy");
        }
        let mut bytes = Vec::new();
        let writer: &dyn Writer = match self.extension {
            "npy" => &Npy,
            "npz" => &Npz,
            // binary numbers are written, because text would round them
            "uff" => &Uff58Writer {
                encoding: Encoding::Binary(ByteOrder::LittleEndian),
                ..Uff58Writer::default()
            },
            "wav" => &Wav,
            _ => &Csv,
        };
        writer.write(&contents, &mut bytes).map_err(refused)?;
        Ok(Attachment { name, bytes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use labio::{Channel, Provenance, Quantity};
    use ndarray::array;

    #[test]
    fn names_are_in_the_order_of_the_records() {
        let naming = Naming::of("hits.csv").unwrap();
        assert_eq!(naming.file(3, 10), "hits-03.csv");
        assert_eq!(naming.pattern(), "hits-*.csv");
        for wrong in ["hits", "hits.xlsx", "../hits.csv", ".csv", "a/b.npy"] {
            assert!(Naming::of(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn every_format_is_read_back() {
        let channels = vec![
            Channel::new("struck end", Quantity::Acceleration).unwrap(),
            Channel::new("gauge", Quantity::Strain).unwrap(),
        ];
        let samples = array![[0.0, 1.5, -2.25, 4.0], [1e-6, 2e-6, -3e-6, 0.0]];
        let made_by = Provenance::computed("a closed form");
        let record = Record::new(samples.clone(), 51_200.0, 0.0, channels, made_by).unwrap();
        for extension in EXTENSIONS {
            let name = format!("one.{extension}");
            let naming = Naming::of(&name).unwrap();
            let file = naming
                .attachment(&record, name.clone(), "a closed form")
                .unwrap();
            let back = labio::format::read_bytes(&file.bytes).unwrap();
            assert_eq!(back.series.len(), 2, "{name}");
            for (series, row) in back.series.iter().zip(samples.rows()) {
                assert_eq!(series.ordinate, Ordinate::Real(row.to_vec()), "{name}");
            }
            let says = |property: &(String, String)| property.1.contains("a closed form");
            assert!(
                extension == "npy"
                    || back.properties.iter().any(says)
                    || back.series[0].properties.iter().any(says),
                "{name}: {:?} {:?}",
                back.properties,
                back.series[0].properties
            );
        }
    }
}
