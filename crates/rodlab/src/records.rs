//! Files of a sheet to calibrated records.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use labio::format;
use labio::{
    Channel, Contents, Polarity, Position, Provenance, Quantity, Rating, Record, SensorChain,
    SeriesAxis, StrainBridge, Unit,
};
use ndarray::Array2;
use serde::Deserialize;

use crate::RodlabError;
use crate::outcome::{InputFile, Setting};
use crate::sheet::{self, Coordinate, Frequency, Stated, Time};

/// Which files, and what their channels are.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Records {
    /// Names or patterns (`hits/*.csv`), relative to the sheet; the files of a pattern are taken in order of their names.
    pub files: Vec<String>,
    /// Rate of the samples, where the files do not tell it (NPY).
    #[serde(default)]
    pub sampling_rate: Option<Stated<Frequency>>,
    /// Channels that are used; the others are passed over.
    pub channels: Vec<ChannelSheet>,
}

/// A channel of the files, and the sensor it is of.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelSheet {
    /// Name by which the rest of the sheet calls it.
    pub name: String,
    /// Which channel of the file it is.
    pub from: Selector,
    /// Unit of the samples in the file, where the file does not tell it, as `"V"`.
    #[serde(default)]
    pub unit: Option<String>,
    /// Sensitivity of the sensor, as `"10.2 mV/g"` or `"4 pC/N ± 1 %"`; absent where the file has the quantity itself.
    #[serde(default)]
    pub sensitivity: Option<Sensitivity>,
    /// A bridge of strain gauges, in the place of a sensitivity.
    #[serde(default)]
    pub bridge: Option<StrainBridge>,
    /// Amplifier behind the sensor, as `"100"` or `"10 mV/pC"`.
    #[serde(default)]
    pub gain: Option<Sensitivity>,
    /// Whether the sensor is wired or mounted the other way round.
    #[serde(default)]
    pub inverted: bool,
    /// Reading at rest, in the unit of the file.
    #[serde(default)]
    pub offset: f64,
    /// How much later than the others the channel is sampled.
    #[serde(default)]
    pub time_skew: Option<Stated<Time>>,
    /// Coordinate of the sensor along the rod.
    #[serde(default)]
    pub position: Option<Stated<Coordinate>>,
    /// Serial number of the sensor.
    #[serde(default)]
    pub serial: Option<String>,
}

/// A channel of a file.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub enum Selector {
    /// By its number, from 1.
    Number(usize),
    /// By its name.
    Name(String),
}

/// A sensitivity or a gain: number, unit and standard uncertainty.
#[derive(Debug, Clone, Deserialize)]
#[serde(try_from = "String")]
pub struct Sensitivity(Rating);

impl TryFrom<String> for Sensitivity {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let refused = |why: String| {
            format!(
                "`{text}` {why}, expected a sensitivity or a gain, as \"10.2 mV/g ± 1 %\" or \"100\""
            )
        };
        let (rating, uncertainty) = sheet::value_and_uncertainty(&text);
        let (value, unit) = sheet::number_and_unit(rating).map_err(refused)?;
        let mut rating = Rating::new(value, unit.symbol())
            .map_err(|error| refused(format!("is refused: {error}")))?;
        if let Some(uncertainty) = uncertainty {
            let (percent, unit) = sheet::number_and_unit(uncertainty).map_err(refused)?;
            if unit.symbol() != "%" {
                return Err(refused("has an uncertainty that is not in %".to_owned()));
            }
            rating = rating
                .with_uncertainty(value.abs() * percent / 100.0)
                .map_err(|error| refused(format!("is refused: {error}")))?;
        }
        Ok(Self(rating))
    }
}

/// What was read.
#[derive(Debug)]
pub struct Loaded {
    /// Records with the channels of the sheet, calibrated, in the order of the files.
    pub records: Vec<NamedRecord>,
    /// The files.
    pub inputs: Vec<InputFile>,
    /// What the sheet says of the channels, for the report.
    pub settings: Vec<Setting>,
}

/// A record and where it is from.
#[derive(Debug, Clone)]
pub struct NamedRecord {
    /// As `hits.uff` or `hits.uff, record 3`.
    pub name: String,
    /// The calibrated record; its channels have the names of the sheet.
    pub record: Record,
}

impl Records {
    /// Reads and calibrates everything; `field` is the place of these records in the sheet.
    ///
    /// # Errors
    ///
    /// [`RodlabError`] with the file, and the field of the sheet that does not suit it.
    pub fn load(&self, folder: &Path, field: &str) -> Result<Loaded, RodlabError> {
        let mut records = Vec::new();
        let mut inputs = Vec::new();
        for path in self.paths(folder, field)? {
            let shown = relative(&path, folder);
            let bytes = fs::read(&path).map_err(|source| RodlabError::Read {
                path: path.clone(),
                source,
            })?;
            let reading = |error| RodlabError::step(format!("reading {shown}"), error);
            let mut contents = format::read_bytes(&bytes).map_err(reading)?;
            self.complete(&mut contents, field)?;
            let provenance = Provenance::of_file(Path::new(&shown), contents.format, &bytes);
            inputs.push(InputFile {
                path: shown.clone(),
                format: contents.format.to_owned(),
                bytes: bytes.len() as u64,
                sha256: labio::ContentHash::of(&bytes).to_string(),
            });
            let found = contents.records(&provenance);
            if found.records.is_empty() {
                let why: Vec<String> = found.left_out.iter().map(ToString::to_string).collect();
                return Err(RodlabError::request(
                    format!("{field}.files: {shown}"),
                    format!("a file without histories ({})", why.join("; ")),
                    "histories with known units: state `sampling_rate`, and `unit` of each channel",
                ));
            }
            let several = found.records.len() > 1;
            for (number, record) in found.records.into_iter().enumerate() {
                let name = if several {
                    format!("{shown}, record {}", number + 1)
                } else {
                    shown.clone()
                };
                let record = self.calibrated(&record, &name, field)?;
                records.push(NamedRecord { name, record });
            }
        }
        Ok(Loaded {
            records,
            inputs,
            settings: self.settings(field),
        })
    }

    /// The files of all patterns, each once.
    fn paths(&self, folder: &Path, field: &str) -> Result<Vec<PathBuf>, RodlabError> {
        if self.files.is_empty() {
            return Err(RodlabError::request(
                format!("{field}.files"),
                "empty",
                "the name of at least one file",
            ));
        }
        let mut seen = BTreeSet::new();
        let mut paths = Vec::new();
        for pattern in &self.files {
            let plain = folder.join(pattern);
            let found = if plain.exists() {
                vec![plain]
            } else {
                let escaped = glob::Pattern::escape(&folder.to_string_lossy());
                let wanted = Path::new(&escaped).join(pattern);
                let listed = glob::glob(&wanted.to_string_lossy()).map_err(|error| {
                    RodlabError::request(
                        format!("{field}.files"),
                        format!("`{pattern}`, {error}"),
                        "a name or a pattern",
                    )
                })?;
                let mut found: Vec<PathBuf> =
                    listed
                        .collect::<Result<_, _>>()
                        .map_err(|error| RodlabError::Read {
                            path: error.path().to_path_buf(),
                            source: error.into(),
                        })?;
                found.sort();
                found
            };
            if found.is_empty() {
                return Err(RodlabError::NoFile {
                    pattern: pattern.clone(),
                    folder: folder.to_path_buf(),
                });
            }
            paths.extend(found.into_iter().filter(|path| seen.insert(path.clone())));
        }
        Ok(paths)
    }

    /// Puts in what the file does not tell and the sheet does: the sampling rate, units.
    fn complete(&self, contents: &mut Contents, field: &str) -> Result<(), RodlabError> {
        let second =
            Unit::parse("s").map_err(|error| RodlabError::step("the unit of time", error))?;
        for (index, series) in contents.series.iter_mut().enumerate() {
            if let Some(rate) = &self.sampling_rate
                && series.abscissa_axis.unit.is_none()
            {
                series.abscissa_axis.unit = Some(second.clone());
                series.abscissa = labio::Abscissa::Even {
                    start: 0.0,
                    step: 1.0 / rate.si(),
                };
            }
            let chosen =
                self.channels
                    .iter()
                    .enumerate()
                    .find(|(_, channel)| match &channel.from {
                        Selector::Number(number) => *number == index + 1,
                        Selector::Name(name) => *name == series.name,
                    });
            if let Some((at, channel)) = chosen
                && let Some(text) = &channel.unit
            {
                let unit = Unit::parse(text).map_err(|error| {
                    RodlabError::step(format!("{field}.channels[{at}].unit"), error)
                })?;
                series.ordinate_axis = SeriesAxis {
                    unit_text: text.clone(),
                    unit: Some(unit),
                    ..series.ordinate_axis.clone()
                };
            }
        }
        Ok(())
    }

    /// The channels of the sheet, under its names, with their sensors.
    fn calibrated(&self, record: &Record, name: &str, field: &str) -> Result<Record, RodlabError> {
        let mut picked = Vec::with_capacity(self.channels.len());
        for (at, channel) in self.channels.iter().enumerate() {
            let known = record.channels();
            let index = match &channel.from {
                Selector::Number(number) => number.checked_sub(1).filter(|i| *i < known.len()),
                Selector::Name(wanted) => known.iter().position(|c| c.name() == wanted.as_str()),
            };
            let index = index.ok_or_else(|| {
                let names: Vec<String> = known.iter().map(|c| format!("`{}`", c.name())).collect();
                let found = match &channel.from {
                    Selector::Number(number) => number.to_string(),
                    Selector::Name(name) => format!("`{name}`"),
                };
                RodlabError::request(
                    format!("{field}.channels[{at}].from"),
                    found,
                    format!("one of {} ({name})", names.join(", ")),
                )
            })?;
            picked.push((index, channel.name.as_str()));
        }
        let refused = |error| RodlabError::step(format!("{field}, {name}"), error);
        let samples = Array2::from_shape_fn((picked.len(), record.n_samples()), |(row, sample)| {
            record.samples()[[picked[row].0, sample]]
        });
        let channels = picked
            .iter()
            .map(|(index, name)| Channel::new(*name, record.channels()[*index].quantity()))
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?;
        let (rate, start) = (record.sampling_rate_hz(), record.start_time());
        let mut record = Record::new(samples, rate, start, channels, record.provenance().clone())
            .map_err(refused)?;
        for (at, channel) in self.channels.iter().enumerate() {
            if let Some(chain) = channel.chain(&format!("{field}.channels[{at}]"))? {
                record = record
                    .calibrated(&channel.name, chain)
                    .map_err(|error| RodlabError::step(format!("{field}.channels[{at}]"), error))?;
            }
        }
        record.aligned().map_err(refused)
    }

    fn settings(&self, field: &str) -> Vec<Setting> {
        let mut settings = Vec::new();
        let mut say = |name: String, value: String| {
            settings.push(Setting {
                name,
                value,
                by_default: false,
            });
        };
        if let Some(rate) = &self.sampling_rate {
            say(format!("{field}.sampling_rate"), rate.to_string());
        }
        for channel in &self.channels {
            say(
                format!("{field}.channels: {}", channel.name),
                channel.in_words(),
            );
        }
        settings
    }
}

impl ChannelSheet {
    /// The sensor of the channel; `None` where the file has the quantity itself and nothing is to be corrected.
    fn chain(&self, field: &str) -> Result<Option<SensorChain>, RodlabError> {
        let refused = |error| RodlabError::step(field, error);
        let mut chain = match (&self.sensitivity, &self.bridge) {
            (Some(_), Some(_)) => {
                return Err(RodlabError::request(
                    format!("{field}.bridge"),
                    "beside a sensitivity",
                    "one of the two",
                ));
            }
            (Some(sensitivity), None) => {
                SensorChain::of_sensitivity(sensitivity.0.clone()).map_err(refused)?
            }
            (None, Some(bridge)) => SensorChain::of_bridge(bridge.clone()),
            (None, None) => {
                let plain = self.gain.is_none() && !self.inverted && self.offset == 0.0;
                if plain && self.time_skew.is_none() && self.position.is_none() {
                    return Ok(None);
                }
                let one = Rating::new(1.0, "1").map_err(refused)?;
                SensorChain::of_sensitivity(one).map_err(refused)?
            }
        };
        if let Some(gain) = &self.gain {
            chain = chain.with_gain(gain.0.clone()).map_err(refused)?;
        }
        if let Some(position) = &self.position {
            let position = Position {
                x: position.si(),
                standard_uncertainty: position.standard_uncertainty().unwrap_or(0.0),
            };
            chain = chain.with_position(position).map_err(refused)?;
        }
        if let Some(serial) = &self.serial {
            chain = chain.with_serial(serial);
        }
        let polarity = if self.inverted {
            Polarity::Inverted
        } else {
            Polarity::default()
        };
        let chain = chain
            .with_polarity(polarity)
            .with_offset(self.offset)
            .and_then(|chain| {
                chain.with_time_skew(self.time_skew.as_ref().map_or(0.0, Stated::si))
            });
        chain.map(Some).map_err(refused)
    }

    fn in_words(&self) -> String {
        let mut words = vec![match &self.from {
            Selector::Number(number) => format!("channel {number}"),
            Selector::Name(name) => format!("`{name}`"),
        }];
        if let Some(unit) = &self.unit {
            words.push(format!("in {unit}"));
        }
        let rating = |r: &Rating| format!("{} {}", r.value(), r.unit().symbol());
        if let Some(Sensitivity(sensitivity)) = &self.sensitivity {
            words.push(format!("sensitivity {}", rating(sensitivity)));
        }
        if let Some(bridge) = &self.bridge {
            words.push(format!("strain bridge {:?}", bridge.layout()));
        }
        if let Some(Sensitivity(gain)) = &self.gain {
            words.push(format!("gain {}", rating(gain)));
        }
        if self.inverted {
            words.push("inverted".to_owned());
        }
        if let Some(position) = &self.position {
            words.push(format!("at {position}"));
        }
        if let Some(serial) = &self.serial {
            words.push(format!("serial {serial}"));
        }
        words.join(", ")
    }
}

/// `path` as seen from `folder`, with slashes.
fn relative(path: &Path, folder: &Path) -> String {
    let short = path.strip_prefix(folder).unwrap_or(path);
    short.to_string_lossy().replace('\\', "/")
}

/// The channel called `name` has the quantity `wanted`, or an error that says what it has; `field` names it in the sheet.
///
/// # Errors
///
/// [`RodlabError::Request`].
pub fn expect_quantity(
    record: &Record,
    name: &str,
    wanted: Quantity,
    field: &str,
) -> Result<(), RodlabError> {
    let known = record.channels();
    match known.iter().find(|channel| channel.name() == name) {
        Some(channel) if channel.quantity() == wanted => Ok(()),
        Some(channel) => Err(RodlabError::request(
            field,
            format!("`{name}`, a channel of {}", channel.quantity().name()),
            format!("a channel of {} [{}]", wanted.name(), wanted.unit()),
        )),
        None => {
            let names: Vec<String> = known.iter().map(|c| format!("`{}`", c.name())).collect();
            Err(RodlabError::request(
                field,
                format!("`{name}`"),
                format!("one of the channels {}", names.join(", ")),
            ))
        }
    }
}
