//! Sampled channels of one test.

use std::path::{Path, PathBuf};

use ndarray::{Array2, ArrayView1, ArrayView2};

use crate::LabioError;
use crate::channel::{self, Channel};
use crate::error::check_positive;

/// Where the samples of a record come from.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Provenance {
    /// Read from a file.
    File {
        /// Path as it was given.
        path: PathBuf,
        /// Name of the format, as `npy`.
        format: &'static str,
    },
    /// Read from bytes without a name.
    Bytes {
        /// Name of the format.
        format: &'static str,
    },
    /// Computed.
    Computed {
        /// Name of the generator, which no method may share that inverts the record.
        generator: String,
    },
}

impl Provenance {
    /// A computed record and the name of its generator.
    #[must_use]
    pub fn computed(generator: impl Into<String>) -> Self {
        Self::Computed {
            generator: generator.into(),
        }
    }

    pub(crate) fn file(path: &Path, format: &'static str) -> Self {
        Self::File {
            path: path.to_path_buf(),
            format,
        }
    }
}

/// Simultaneously sampled channels: finite samples, equally spaced in time, each channel named.
///
/// | part | shape | unit |
/// |---|---|---|
/// | samples | `(n_channels, n_samples)` | SI unit of the channel's quantity |
/// | sampling rate | scalar | Hz |
/// | start time | scalar | s, time of the first sample |
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    samples: Array2<f64>,
    sampling_rate_hz: f64,
    start_time: f64,
    channels: Vec<Channel>,
    provenance: Provenance,
}

impl Record {
    /// A record of `samples`, shape `(n_channels, n_samples)`, with `start_time` \[s\] the time of the first sample.
    ///
    /// # Errors
    ///
    /// - [`LabioError::NonPhysical`]: the sampling rate is not positive, or the start time is not finite.
    /// - [`LabioError::CountMismatch`]: there is not one channel per row.
    /// - [`LabioError::TooFewSamples`]: there is no channel with at least two samples.
    /// - [`LabioError::DuplicateChannel`]: two channels have the same name.
    /// - [`LabioError::NonFiniteSample`]: a sample is NaN or infinite.
    pub fn new(
        samples: Array2<f64>,
        sampling_rate_hz: f64,
        start_time: f64,
        channels: Vec<Channel>,
        provenance: Provenance,
    ) -> Result<Self, LabioError> {
        check_positive("sampling rate [Hz]", sampling_rate_hz)?;
        if !start_time.is_finite() {
            return Err(LabioError::NonPhysical {
                quantity: "start time [s]",
                value: start_time,
                expected: "a finite value",
            });
        }
        if channels.len() != samples.nrows() {
            return Err(LabioError::CountMismatch {
                what: "channels named for the rows of samples",
                found: channels.len(),
                expected: samples.nrows(),
            });
        }
        if samples.is_empty() || samples.ncols() < 2 {
            return Err(LabioError::TooFewSamples {
                what: "the record",
                found: samples.len(),
                expected: 2,
            });
        }
        channel::check_distinct(&channels)?;
        for (row, channel) in samples.rows().into_iter().zip(&channels) {
            if let Some((index, &value)) = row.iter().enumerate().find(|(_, s)| !s.is_finite()) {
                return Err(LabioError::NonFiniteSample {
                    channel: channel.name().to_owned(),
                    index,
                    value,
                });
            }
        }
        Ok(Self {
            samples,
            sampling_rate_hz,
            start_time,
            channels,
            provenance,
        })
    }

    /// All samples, shape `(n_channels, n_samples)`.
    #[must_use]
    pub fn samples(&self) -> ArrayView2<'_, f64> {
        self.samples.view()
    }

    /// The samples of the channel called `name`.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`] if there is none of that name.
    pub fn channel(&self, name: &str) -> Result<ArrayView1<'_, f64>, LabioError> {
        let (index, _) = channel::find(&self.channels, name)?;
        Ok(self.samples.row(index))
    }

    /// The channels, in the order of the rows.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Number of samples of every channel.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        self.samples.ncols()
    }

    /// Sampling rate \[Hz\].
    #[must_use]
    pub fn sampling_rate_hz(&self) -> f64 {
        self.sampling_rate_hz
    }

    /// Time of the first sample \[s\].
    #[must_use]
    pub fn start_time(&self) -> f64 {
        self.start_time
    }

    /// The time the samples stand for \[s\]: number of samples over sampling rate.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.n_samples() as f64 / self.sampling_rate_hz
    }

    /// Time of sample `index` \[s\].
    #[must_use]
    pub fn time_at(&self, index: usize) -> f64 {
        self.start_time + index as f64 / self.sampling_rate_hz
    }

    /// Where the samples come from.
    #[must_use]
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    pub(crate) fn with_provenance(self, provenance: Provenance) -> Self {
        Self { provenance, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quantity;
    use ndarray::array;

    fn channels() -> Vec<Channel> {
        vec![
            Channel::new("force", Quantity::Force).unwrap(),
            Channel::new("response", Quantity::Acceleration).unwrap(),
        ]
    }

    fn record(samples: Array2<f64>, sampling_rate_hz: f64) -> Result<Record, LabioError> {
        Record::new(
            samples,
            sampling_rate_hz,
            0.25,
            channels(),
            Provenance::computed("test"),
        )
    }

    #[test]
    fn a_record_knows_its_time_axis_and_finds_channels_by_name() {
        let record = record(array![[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]], 8.0).unwrap();
        assert_eq!(record.n_samples(), 4);
        // sums of powers of two: exact
        assert_eq!(record.time_at(2).to_bits(), 0.5_f64.to_bits());
        assert_eq!(record.duration().to_bits(), 0.5_f64.to_bits());
        assert_eq!(
            record.channel("response").unwrap(),
            array![5.0, 6.0, 7.0, 8.0]
        );
    }

    #[test]
    fn bad_records_are_refused_with_the_place_and_the_value() {
        let refusals = [
            record(array![[1.0, 2.0, 3.0], [4.0, f64::NAN, 6.0]], 8.0),
            record(array![[1.0, f64::INFINITY], [4.0, 5.0]], 8.0),
            record(array![[1.0, 2.0], [4.0, 5.0]], 0.0),
            record(array![[1.0, 2.0]], 8.0),
            record(array![[1.0], [2.0]], 8.0),
        ]
        .map(|result| result.unwrap_err().to_string())
        .join("\n");
        insta::assert_snapshot!(refusals, @r"
        sample 1 of channel `response` is NaN, expected a finite value
        sample 1 of channel `force` is inf, expected a finite value
        sampling rate [Hz] is 0, expected a finite value above 0
        channels named for the rows of samples: found 2, expected 1
        the record has 2 samples, expected at least 2
        ");
    }

    #[test]
    fn a_name_can_be_given_once() {
        let twice = vec![channels()[0].clone(), channels()[0].clone()];
        let error = Record::new(
            array![[1.0, 2.0], [3.0, 4.0]],
            8.0,
            0.0,
            twice,
            Provenance::computed("test"),
        )
        .unwrap_err();
        assert_eq!(error.to_string(), "channels 0 and 1 are both named `force`");
    }
}
