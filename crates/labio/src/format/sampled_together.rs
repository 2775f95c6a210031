//! Combination of series on the same time axis into the channels of a record.

use std::collections::{HashMap, HashSet};

use ndarray::Array2;

use super::uff58;
use crate::{
    Abscissa, Channel, Contents, Dimension, LabioError, Ordinate, Provenance, Quantity, Record,
    Series, SeriesKind, Unit,
};

/// The records made from the series of a file, and the series that are in no record.
#[derive(Debug)]
#[non_exhaustive]
#[must_use]
pub struct SampledTogether {
    /// The records, in the order of their first series in the file.
    pub records: Vec<Record>,
    /// Reasons why the other series are in no record.
    pub left_out: Vec<LabioError>,
    /// Name of the channel made from each series of the file; `None` if the series is in no record.
    pub channel_names: Vec<Option<String>>,
}

/// A series that can be a channel of a record, in SI units.
struct Candidate<'a> {
    index: usize,
    series: &'a Series,
    values: &'a [f64],
    unit: &'a Unit,
    quantity: Quantity,
    clock: Clock,
}

/// A time axis.
#[derive(Debug, Clone, Copy)]
struct Clock {
    n: usize,
    start: f64,
    step: f64,
}

/// Number of samples, and the bits of start and step.
type ClockBits = (usize, u64, u64);

impl Clock {
    /// Returns the bits of the time axis: two axes are the same if no bit differs.
    fn bits(self) -> ClockBits {
        (self.n, self.start.to_bits(), self.step.to_bits())
    }
}

impl Contents {
    /// Combines the series into records: time histories of a known quantity on an even time axis.
    /// Series on the same axis, sample for sample, are the channels of one record, in SI units.
    ///
    /// A channel has the name of its series. If the name is empty or common to several channels,
    /// the response's degree of freedom is added, for example `acceleration 3+Z`. A repeated name
    /// belongs to another hit: the series goes into the first record with the same axis that has no
    /// channel of that name yet.
    ///
    /// A unit that is missing in the file can be set before the call: set
    /// [`SeriesAxis::unit`](crate::SeriesAxis::unit) in the
    /// [`ordinate_axis`](Series::ordinate_axis) of the series.
    ///
    /// # Examples
    ///
    /// ```
    /// use labio::{format, Provenance, Quantity};
    ///
    /// # fn main() -> Result<(), labio::LabioError> {
    /// let file = b"Time (ms);end A (g)\n0;1\n0.5;2\n1;-1\n";
    /// let contents = format::read_bytes(file)?;
    /// let found = contents.records(&Provenance::of_bytes(contents.format, file));
    /// assert!(found.left_out.is_empty());
    /// let record = &found.records[0];
    /// assert_eq!(record.channels()[0].quantity(), Quantity::Acceleration);
    /// assert_eq!(record.channel("end A")?[1], 2.0 * 9.80665);
    /// assert_eq!(record.sampling_rate_hz(), 2000.0);
    /// # Ok(())
    /// # }
    /// ```
    #[allow(
        clippy::indexing_slicing,
        reason = "a candidate holds the index of its series, `channel_names` has an entry for every series, and `groups_of_clock` holds indices of `groups`"
    )]
    pub fn records(&self, provenance: &Provenance) -> SampledTogether {
        let mut left_out = Vec::new();
        let mut candidates = Vec::new();
        for (index, series) in self.series.iter().enumerate() {
            match Candidate::of(index, series) {
                Ok(candidate) => candidates.push(candidate),
                Err(error) => left_out.push(error),
            }
        }
        let names = names(&candidates);
        let mut channel_names = vec![None; self.series.len()];
        // the n-th series with a name goes to the n-th record with its time axis, which is the
        // first record without that name
        let mut groups: Vec<Group<'_>> = Vec::new();
        let mut groups_of_clock: HashMap<ClockBits, Vec<usize>> = HashMap::new();
        let mut n_of_name: HashMap<(ClockBits, String), usize> = HashMap::new();
        for (candidate, name) in candidates.into_iter().zip(names) {
            let clock = candidate.clock;
            let n_before = n_of_name.entry((clock.bits(), name.clone())).or_default();
            let of_clock = groups_of_clock.entry(clock.bits()).or_default();
            match of_clock.get(*n_before) {
                Some(&group) => groups[group].members.push((name, candidate)),
                None => {
                    of_clock.push(groups.len());
                    groups.push(Group {
                        clock,
                        members: vec![(name, candidate)],
                    });
                }
            }
            *n_before += 1;
        }
        let mut records = Vec::with_capacity(groups.len());
        for group in groups {
            match group.record(provenance) {
                Ok((record, members)) => {
                    for (index, channel) in members.into_iter().zip(record.channels()) {
                        channel_names[index] = Some(channel.name().to_owned());
                    }
                    records.push(record);
                }
                Err(error) => left_out.push(error),
            }
        }
        SampledTogether {
            records,
            left_out,
            channel_names,
        }
    }
}

/// Series that will be one record.
struct Group<'a> {
    clock: Clock,
    members: Vec<(String, Candidate<'a>)>,
}

impl Group<'_> {
    /// Returns the record, and the indices of the series that are its channels.
    fn record(self, provenance: &Provenance) -> Result<(Record, Vec<usize>), LabioError> {
        let series = self
            .members
            .iter()
            .map(|(_, member)| member.index)
            .collect();
        let mut samples = Array2::zeros((self.members.len(), self.clock.n));
        let mut channels = Vec::with_capacity(self.members.len());
        for (mut row, (name, member)) in samples.rows_mut().into_iter().zip(self.members) {
            for (sample, &value) in row.iter_mut().zip(member.values) {
                *sample = member.unit.to_si(value);
            }
            channels.push(Channel::new(name, member.quantity)?);
        }
        let Clock { start, step, .. } = self.clock;
        let record = Record::new(samples, 1.0 / step, start, channels, provenance.clone())?;
        Ok((record, series))
    }
}

impl<'a> Candidate<'a> {
    fn of(index: usize, series: &'a Series) -> Result<Self, LabioError> {
        let refused =
            |part: &'static str, found: String, expected: &'static str| LabioError::NoChannel {
                index,
                name: series.name.clone(),
                part,
                found,
                expected,
            };
        if !matches!(series.kind, SeriesKind::TimeResponse | SeriesKind::General) {
            return Err(refused("kind", format!("{:?}", series.kind), "a history"));
        }
        let Ordinate::Real(values) = &series.ordinate else {
            return Err(refused("ordinate", "complex".to_owned(), "real"));
        };
        let Abscissa::Even { start, step } = series.abscissa else {
            return Err(refused("abscissa", "uneven".to_owned(), "even"));
        };
        let told = |text: &str| {
            if text.is_empty() {
                "not stated".to_owned()
            } else {
                format!("`{text}`")
            }
        };
        let time = match &series.abscissa_axis.unit {
            Some(unit) if unit.dimension() == Dimension::TIME => unit,
            _ => {
                let found = told(&series.abscissa_axis.unit_text);
                return Err(refused("unit of the abscissa", found, "a unit of time"));
            }
        };
        let clock = Clock {
            n: values.len(),
            start: time.to_si(start),
            step: time.to_si(step),
        };
        if !(clock.step > 0.0 && clock.step.is_finite() && clock.start.is_finite()) {
            let found = format!("from {} s in steps of {} s", clock.start, clock.step);
            return Err(refused(
                "abscissa",
                found,
                "a finite start and a step above 0",
            ));
        }
        if clock.n < 2 {
            return Err(refused(
                "number of samples",
                clock.n.to_string(),
                "at least 2",
            ));
        }
        let known = series.ordinate_axis.unit.as_ref();
        let Some((unit, quantity)) = known.and_then(|unit| Some((unit, unit.quantity()?))) else {
            let found = told(&series.ordinate_axis.unit_text);
            return Err(refused("unit", found, "the unit of a channel quantity"));
        };
        if let Some((sample, value)) = values
            .iter()
            .enumerate()
            .find(|(_, value)| !unit.to_si(**value).is_finite())
        {
            return Err(refused(
                "ordinate",
                format!("{value} at sample {sample}"),
                "finite",
            ));
        }
        Ok(Self {
            index,
            series,
            values,
            unit,
            quantity,
            clock,
        })
    }
}

/// Returns the names of the channels: those of the series, with the degree of freedom where the
/// name alone is ambiguous.
fn names(candidates: &[Candidate<'_>]) -> Vec<String> {
    let mut first = HashMap::new();
    let mut ambiguous = HashSet::new();
    let responses: Vec<Option<String>> = candidates
        .iter()
        .map(|candidate| uff58::response(candidate.series))
        .collect();
    for (candidate, response) in candidates.iter().zip(&responses) {
        let name = candidate.series.name.trim();
        if *first.entry(name).or_insert(response) != response {
            ambiguous.insert(name);
        }
    }
    let names = candidates
        .iter()
        .zip(&responses)
        .map(|(candidate, response)| {
            let name = candidate.series.name.trim();
            match (name.is_empty(), response) {
                (true, Some(response)) => response.clone(),
                (true, None) => format!("series {}", candidate.index),
                (false, Some(response)) if ambiguous.contains(name) => format!("{name} {response}"),
                (false, _) => name.to_owned(),
            }
        });
    names.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SeriesAxis;

    fn axis(unit: &str) -> SeriesAxis {
        SeriesAxis {
            label: String::new(),
            unit_text: unit.to_owned(),
            unit: Unit::parse(unit).ok(),
        }
    }

    fn history(name: &str, unit: &str, values: &[f64]) -> Series {
        Series {
            name: name.to_owned(),
            kind: SeriesKind::TimeResponse,
            abscissa: Abscissa::Even {
                start: 250.0,
                step: 0.5,
            },
            ordinate: Ordinate::Real(values.to_vec()),
            abscissa_axis: axis("ms"),
            ordinate_axis: axis(unit),
            properties: Vec::new(),
        }
    }

    fn grouped(series: Vec<Series>) -> SampledTogether {
        let mut contents = Contents::of_format("test");
        contents.series = series;
        contents.records(&Provenance::computed("test"))
    }

    fn channel_names(record: &Record) -> Vec<&str> {
        record.channels().iter().map(Channel::name).collect()
    }

    #[test]
    fn series_on_one_axis_are_one_record_in_si() {
        let found = grouped(vec![
            history("hammer", "kN", &[0.0, 2.0]),
            history("end A", "g", &[0.0, 1.0]),
        ]);
        let [record] = found.records.as_slice() else {
            panic!("expected one record");
        };
        assert_eq!(channel_names(record), ["hammer", "end A"]);
        assert_eq!(record.channel("hammer").unwrap().to_vec(), [0.0, 2000.0]);
        assert_eq!(record.channel("end A").unwrap().to_vec(), [0.0, 9.80665]);
        // tolerance: the times are exact in milliseconds, and the factor 1/1000 rounds them once
        assert!((record.sampling_rate_hz() - 2000.0).abs() < 1e-12 * 2000.0);
        assert!((record.start_time() - 0.25).abs() < 1e-16);
    }

    #[test]
    fn other_axes_and_repeated_names_are_other_records() {
        let mut longer = history("end A", "g", &[0.0, 1.0, 2.0]);
        let hit = || {
            [
                history("hammer", "N", &[1.0, 2.0]),
                history("end A", "m/s^2", &[3.0, 4.0]),
            ]
        };
        let series = [hit(), hit()].concat();
        let found = grouped([series, vec![longer.clone()]].concat());
        let names: Vec<_> = found.records.iter().map(channel_names).collect();
        assert_eq!(
            names,
            [
                vec!["hammer", "end A"],
                vec!["hammer", "end A"],
                vec!["end A"]
            ]
        );

        // the same name for several degrees of freedom
        let node = |node: &str| ("uff58.response_node".to_owned(), node.to_owned());
        let direction =
            |direction: &str| ("uff58.response_direction".to_owned(), direction.to_owned());
        let mut other = longer.clone();
        longer.properties = vec![node("1"), direction("3")];
        other.properties = vec![node("2"), direction("-4")];
        let mut nameless = other.clone();
        nameless.name.clear();
        let found = grouped(vec![longer, other, nameless]);
        assert_eq!(
            channel_names(&found.records[0]),
            ["end A 1+Z", "end A 2-RX", "2-RX"]
        );
        let names: Vec<_> = found.channel_names.iter().map(Option::as_deref).collect();
        assert_eq!(names, [Some("end A 1+Z"), Some("end A 2-RX"), Some("2-RX")]);
    }

    #[test]
    fn what_is_left_out_says_why() {
        let good = || history("x", "N", &[1.0, 2.0]);
        let with = |change: fn(&mut Series)| {
            let mut series = good();
            change(&mut series);
            series
        };
        let found = grouped(vec![
            with(|series| series.kind = SeriesKind::Coherence),
            with(|series| series.ordinate = Ordinate::Complex(vec![])),
            with(|series| series.abscissa = Abscissa::Uneven(vec![0.0, 1.0])),
            with(|series| {
                series.abscissa = Abscissa::Even {
                    start: 0.0,
                    step: 0.0,
                }
            }),
            with(|series| series.abscissa_axis = axis("Hz")),
            with(|series| series.abscissa_axis = SeriesAxis::default()),
            with(|series| series.ordinate_axis = axis("furlong")),
            with(|series| series.ordinate_axis = axis("m^3")),
            with(|series| series.ordinate = Ordinate::Real(vec![1.0])),
            with(|series| series.ordinate = Ordinate::Real(vec![1.0, f64::NAN])),
        ]);
        assert!(found.records.is_empty());
        assert!(found.channel_names.iter().all(Option::is_none));
        let reasons: String = found
            .left_out
            .iter()
            .map(|reason| format!("{reason}\n"))
            .collect();
        insta::assert_snapshot!(reasons, @r"
        series 0 (`x`) is not a channel of a record: its kind is Coherence, expected a history
        series 1 (`x`) is not a channel of a record: its ordinate is complex, expected real
        series 2 (`x`) is not a channel of a record: its abscissa is uneven, expected even
        series 3 (`x`) is not a channel of a record: its abscissa is from 0 s in steps of 0 s, expected a finite start and a step above 0
        series 4 (`x`) is not a channel of a record: its unit of the abscissa is `Hz`, expected a unit of time
        series 5 (`x`) is not a channel of a record: its unit of the abscissa is not stated, expected a unit of time
        series 6 (`x`) is not a channel of a record: its unit is `furlong`, expected the unit of a channel quantity
        series 7 (`x`) is not a channel of a record: its unit is `m^3`, expected the unit of a channel quantity
        series 8 (`x`) is not a channel of a record: its number of samples is 1, expected at least 2
        series 9 (`x`) is not a channel of a record: its ordinate is NaN at sample 1, expected finite
        ");
    }
}
