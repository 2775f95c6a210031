//! Sampled channels of one test.

use std::ops::Range;
use std::sync::Arc;

use ndarray::{Array2, ArrayView1, ArrayView2, Axis, Slice, Zip};

use crate::channel::{self, Channel};
use crate::error::{
    check_count, check_enough_samples, check_finite, check_positive, check_samples, non_physical,
    too_few_samples,
};
use crate::filter;
use crate::{LabioError, LevelAtRest, Provenance, SensorChain, SensorError};

/// Simultaneously sampled, named channels: finite samples, equally spaced in time.
///
/// | part | shape | unit |
/// |---|---|---|
/// | samples | `(n_channels, n_samples)` | SI unit of the channel's quantity |
/// | sampling rate | scalar | Hz |
/// | start time | scalar | s, time of the first sample |
///
/// [`Record::calibrated`] converts a record of volts to one of physical quantities and keeps the
/// recorded samples: a wrong sensitivity is corrected by calibrating again, without reading the
/// file again.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    samples: Array2<f64>,
    sampling_rate_hz: f64,
    start_time: f64,
    channels: Vec<Channel>,
    provenance: Provenance,
    recorded: Option<Recorded>,
}

/// Samples and channels of a record before calibration.
#[derive(Debug, Clone, PartialEq)]
struct Recorded {
    samples: Arc<Array2<f64>>,
    channels: Vec<Channel>,
    chains: Vec<Option<SensorChain>>,
}

impl Record {
    /// Creates a record of `samples`, shape `(n_channels, n_samples)`, with `start_time` \[s\] the
    /// time of the first sample.
    ///
    /// # Errors
    ///
    /// - [`LabioError::NonPhysical`]: the sampling rate is not positive, or the start time is not
    ///   finite.
    /// - [`LabioError::CountMismatch`]: the number of channels differs from the number of rows.
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
        check_finite("start time [s]", start_time)?;
        check_count(
            "channels for the rows of samples",
            channels.len(),
            samples.nrows(),
        )?;
        if samples.is_empty() || samples.ncols() < 2 {
            return too_few_samples("the record", samples.len(), 2);
        }
        check_finite(
            "end of the record [s]",
            start_time + samples.ncols() as f64 / sampling_rate_hz,
        )?;
        channel::check_distinct(&channels)?;
        for (row, channel) in samples.rows().into_iter().zip(&channels) {
            check_samples(channel.name(), row)?;
        }
        Ok(Self {
            samples,
            sampling_rate_hz,
            start_time,
            channels,
            provenance,
            recorded: None,
        })
    }

    /// Converts the channel called `name` to the quantity that its sensor measures. The recorded
    /// samples are kept, and an earlier chain of the channel is replaced.
    ///
    /// # Errors
    ///
    /// - [`LabioError::UnknownChannel`]: no channel has that name.
    /// - [`LabioError::UnitMismatch`]: the chain does not fit the unit in which the channel was
    ///   recorded.
    /// - [`LabioError::NonFiniteSample`]: the chain gives no finite value for a recorded sample,
    ///   for example for a voltage that no strain produces.
    ///
    /// # Examples
    ///
    /// ```
    /// use labio::{Channel, Provenance, Quantity, Rating, Record, SensorChain};
    /// use ndarray::array;
    ///
    /// # fn main() -> Result<(), labio::LabioError> {
    /// let channels = vec![Channel::new("hammer", Quantity::Voltage)?];
    /// let volts = array![[0.0, 0.5, 0.25]];
    /// let record = Record::new(volts, 8000.0, 0.0, channels, Provenance::computed("example"))?;
    ///
    /// let sheet = SensorChain::of_sensitivity(Rating::new(2.0, "mV/N")?)?;
    /// let record = record.calibrated("hammer", sheet)?;
    /// assert_eq!(record.channel("hammer")?[1], 250.0);
    ///
    /// let certificate = SensorChain::of_sensitivity(Rating::new(2.5, "mV/N")?)?;
    /// let record = record.calibrated("hammer", certificate)?;
    /// assert_eq!(record.channel("hammer")?[1], 200.0);
    /// # Ok(())
    /// # }
    /// ```
    pub fn calibrated(mut self, name: &str, chain: SensorChain) -> Result<Self, LabioError> {
        let (index, _) = channel::find(&self.channels, name)?;
        let recorded = self.recorded.get_or_insert_with(|| Recorded {
            samples: Arc::new(self.samples.clone()),
            channels: self.channels.clone(),
            chains: vec![None; self.channels.len()],
        });
        let (_, channel) = channel::find(&recorded.channels, name)?;
        let felt = Channel::new(name, chain.quantity_from(channel.quantity())?)?;
        let mut row = self.samples.row_mut(index);
        Zip::from(&mut row)
            .and(recorded.samples.row(index))
            .for_each(|sample, &number| *sample = chain.si_from(number));
        check_samples(name, self.samples.row(index))?;
        if let Some(slot) = recorded.chains.get_mut(index) {
            *slot = Some(chain);
        }
        if let Some(slot) = self.channels.get_mut(index) {
            *slot = felt;
        }
        Ok(self)
    }

    /// Returns the sensor chain of the channel called `name`, if it was calibrated.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`] if no channel has that name.
    pub fn chain(&self, name: &str) -> Result<Option<&SensorChain>, LabioError> {
        let (index, _) = channel::find(&self.channels, name)?;
        let recorded = self.recorded.as_ref();
        Ok(recorded
            .and_then(|recorded| recorded.chains.get(index))
            .and_then(Option::as_ref))
    }

    /// Converts several channels as [`Self::calibrated`] does; `chains` lists their names and
    /// chains.
    ///
    /// # Errors
    ///
    /// The errors of [`Self::calibrated`].
    pub fn calibrate<'a>(
        self,
        chains: impl IntoIterator<Item = (&'a str, SensorChain)>,
    ) -> Result<Self, LabioError> {
        let mut chains = chains.into_iter();
        chains.try_fold(self, |record, (name, chain)| record.calibrated(name, chain))
    }

    /// Returns the errors of the sensor of the channel called `name`; zero for a channel without a
    /// [`SensorChain`].
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`].
    pub fn sensor_error(&self, name: &str) -> Result<SensorError, LabioError> {
        let chain = self.chain(name)?;
        Ok(
            chain.map_or_else(SensorError::default, |chain| SensorError {
                gain: chain.relative_uncertainty(),
                delay: chain.time_skew_uncertainty(),
            }),
        )
    }

    /// Returns the recorded samples of the channel called `name`, in the SI unit of
    /// [`Self::recorded_channels`]; the samples of the record itself if nothing was calibrated.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`] if no channel has that name.
    pub fn recorded(&self, name: &str) -> Result<ArrayView1<'_, f64>, LabioError> {
        let (index, _) = channel::find(&self.channels, name)?;
        Ok(match &self.recorded {
            Some(recorded) => recorded.samples.row(index),
            None => self.samples.row(index),
        })
    }

    /// The channels as recorded, before any calibration.
    #[must_use]
    pub fn recorded_channels(&self) -> &[Channel] {
        self.recorded
            .as_ref()
            .map_or(&self.channels, |recorded| &recorded.channels)
    }

    /// Returns the samples `range` of every channel as a separate record on the same time axis.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] if the range has fewer than two samples, or extends beyond the
    /// record.
    pub fn part(&self, range: Range<usize>) -> Result<Self, LabioError> {
        check_enough_samples(
            "the record that contains the part",
            self.n_samples(),
            range.end,
        )?;
        check_enough_samples("the part of a record", range.len(), 2)?;
        let of = |samples: &Array2<f64>| {
            samples
                .slice_axis(Axis(1), Slice::from(range.clone()))
                .to_owned()
        };
        Ok(Self {
            samples: of(&self.samples),
            sampling_rate_hz: self.sampling_rate_hz,
            start_time: self.time_at(range.start),
            channels: self.channels.clone(),
            provenance: self.provenance.clone(),
            recorded: self.recorded.as_ref().map(|recorded| Recorded {
                samples: Arc::new(of(&recorded.samples)),
                ..recorded.clone()
            }),
        })
    }

    /// Pads the record to `n_samples` samples, each channel with its mean in the first `n_rest`
    /// samples, or with 0 if `n_rest` is `None`.
    pub(crate) fn continued(
        &self,
        n_samples: usize,
        n_rest: Option<usize>,
    ) -> Result<Self, LabioError> {
        check_enough_samples("the padded hit", n_samples, self.n_samples())?;
        let of = |samples: &Array2<f64>| {
            let mut longer = Array2::zeros((samples.nrows(), n_samples));
            for (mut to, from) in longer.rows_mut().into_iter().zip(samples.rows()) {
                let rest = LevelAtRest::of(from.iter().copied().take(n_rest.unwrap_or(0)));
                to.fill(rest.map_or(0.0, |rest| rest.level));
                for (to, from) in to.iter_mut().zip(from) {
                    *to = *from;
                }
            }
            longer
        };
        Ok(Self {
            samples: of(&self.samples),
            recorded: self.recorded.as_ref().map(|recorded| Recorded {
                samples: Arc::new(of(&recorded.samples)),
                ..recorded.clone()
            }),
            ..self.clone()
        })
    }

    /// Moves every channel to the common time axis: the time skew of its chain is corrected by
    /// band-limited interpolation of the recorded samples. The chains of the result have no
    /// skew.
    ///
    /// # Validity
    ///
    /// Valid for signals that have no content near half the sampling rate and are at rest at both
    /// ends; otherwise the first and last samples ring.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonFiniteSample`] if the sensor chain gives no finite value for an
    /// interpolated sample, [`LabioError::NonPhysical`] for a skew longer than the record.
    pub fn aligned(self) -> Result<Self, LabioError> {
        let Some(recorded) = &self.recorded else {
            return Ok(self);
        };
        let mut samples = recorded.samples.as_ref().clone();
        let mut chains = Vec::new();
        for (mut row, (channel, chain)) in samples
            .rows_mut()
            .into_iter()
            .zip(self.channels.iter().zip(&recorded.chains))
        {
            let skew = chain.as_ref().map_or(0.0, SensorChain::time_skew);
            if skew != 0.0 {
                if skew.abs() >= self.duration() {
                    return non_physical(
                        "time skew [s]",
                        skew,
                        "less than the duration of the record",
                    );
                }
                let in_place = filter::delayed(&row.to_vec(), skew * self.sampling_rate_hz);
                for (slot, sample) in row.iter_mut().zip(in_place) {
                    *slot = sample;
                }
            }
            if let Some(chain) = chain {
                chains.push((
                    channel.name().to_owned(),
                    chain.clone().with_time_skew(0.0)?,
                ));
            }
        }
        let mut aligned = Self::new(
            samples,
            self.sampling_rate_hz,
            self.start_time,
            recorded.channels.clone(),
            self.provenance.clone(),
        )?;
        for (name, chain) in chains {
            aligned = aligned.calibrated(&name, chain)?;
        }
        Ok(aligned)
    }

    /// All samples, shape `(n_channels, n_samples)`.
    #[must_use]
    pub fn samples(&self) -> ArrayView2<'_, f64> {
        self.samples.view()
    }

    /// Returns the samples of the channel called `name`.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`] if no channel has that name.
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

    /// Duration \[s\]: number of samples divided by sampling rate.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.n_samples() as f64 / self.sampling_rate_hz
    }

    /// Time of sample `index` \[s\].
    #[must_use]
    pub fn time_at(&self, index: usize) -> f64 {
        self.start_time + index as f64 / self.sampling_rate_hz
    }

    /// Origin of the samples.
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
    use crate::{BridgeLayout, Quantity, Rating, StrainBridge};
    use ndarray::array;

    impl Record {
        /// A record for tests, which begins at time 0 and has these channels.
        pub(crate) fn of_test(
            samples: Array2<f64>,
            rate_hz: f64,
            channels: &[(&str, Quantity)],
        ) -> Self {
            let named = channels
                .iter()
                .map(|(name, quantity)| Channel::new(*name, *quantity).unwrap());
            let from = Provenance::computed("test");
            Self::new(samples, rate_hz, 0.0, named.collect(), from).unwrap()
        }
    }

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
        channels for the rows of samples: found 2, expected 1
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

    fn volts() -> Record {
        let channels = ["force", "response"]
            .map(|name| Channel::new(name, Quantity::Voltage).unwrap())
            .to_vec();
        Record::new(
            array![[0.0, 0.5, 0.25, -0.5], [1.0, 2.0, 3.0, 4.0]],
            8.0,
            0.25,
            channels,
            Provenance::computed("test"),
        )
        .unwrap()
    }

    fn chain(sensitivity: f64, unit: &str) -> SensorChain {
        SensorChain::of_sensitivity(Rating::new(sensitivity, unit).unwrap()).unwrap()
    }

    #[test]
    fn calibrating_again_starts_from_what_was_recorded() {
        let once = volts().calibrated("force", chain(3.0, "mV/N")).unwrap();
        assert_eq!(once.channels()[0].quantity(), Quantity::Force);
        assert_eq!(once.channels()[1].quantity(), Quantity::Voltage);
        let direct = volts().calibrated("force", chain(0.7, "mV/lbf")).unwrap();
        let again = once.calibrated("force", chain(0.7, "mV/lbf")).unwrap();
        assert_eq!(again, direct, "not a bit of the first chain is left");
        assert_eq!(
            again.recorded("force").unwrap(),
            array![0.0, 0.5, 0.25, -0.5]
        );
        assert_eq!(again.recorded_channels(), volts().channels());
        assert_eq!(
            again.chain("force").unwrap().unwrap(),
            &chain(0.7, "mV/lbf")
        );
        assert_eq!(again.chain("response").unwrap(), None);
    }

    #[test]
    fn a_chain_that_does_not_fit_is_refused_with_the_channel() {
        let wrong = volts().calibrated("force", chain(1.0, "pC/N")).unwrap_err();
        assert!(matches!(wrong, LabioError::UnitMismatch { .. }));
        let bridge = StrainBridge::new(
            BridgeLayout::Quarter,
            Rating::new(2.0, "1").unwrap(),
            Rating::new(5.0, "V").unwrap(),
        );
        let beyond = volts()
            .calibrated("response", SensorChain::of_bridge(bridge.unwrap()))
            .unwrap_err();
        assert_eq!(
            beyond.to_string(),
            "sample 2 of channel `response` is NaN, expected a finite value"
        );
    }

    #[test]
    fn a_part_stays_on_the_time_axis_and_can_be_calibrated() {
        let whole = volts().calibrated("force", chain(2.0, "mV/N")).unwrap();
        let part = whole.part(1..3).unwrap();
        assert_eq!(part.start_time().to_bits(), 0.375_f64.to_bits());
        assert_eq!(part.channel("force").unwrap(), array![250.0, 125.0]);
        let part = part.calibrated("force", chain(1.0, "mV/N")).unwrap();
        assert_eq!(part.channel("force").unwrap(), array![500.0, 250.0]);
        assert!(whole.part(2..3).is_err());
        assert!(whole.part(2..5).is_err());
    }

    #[test]
    fn a_time_skew_is_taken_back_only_when_asked_for() {
        let rate = 1000.0;
        let skew = 0.0123;
        let pulse = |t: f64| (-((t - 0.5) / 0.01).powi(2)).exp();
        let n = 1000;
        let samples = Array2::from_shape_fn((2, n), |(c, k)| {
            let t = k as f64 / rate;
            pulse(if c == 0 { t } else { t + skew }) // sampled later than the axis states
        });
        let channels = volts().channels().to_vec();
        let record = Record::new(samples, rate, 0.0, channels, Provenance::computed("test"))
            .unwrap()
            .calibrated("force", chain(1.0, "V/N"))
            .unwrap()
            .calibrated("response", chain(2.0, "V/N").with_time_skew(skew).unwrap())
            .unwrap();
        let as_recorded = record.channel("response").unwrap();
        assert!((as_recorded[488] - pulse(0.5003) / 2.0).abs() < 1e-12);
        let aligned = record.aligned().unwrap();
        let force = aligned.channel("force").unwrap();
        let response = aligned.channel("response").unwrap();
        for (f, r) in force.iter().zip(response) {
            // at half the sampling rate the spectrum of the pulse has fallen to
            // exp(-(π·500·0.01)²): only rounding errors are left
            assert!((f / 2.0 - r).abs() < 1e-14);
        }
        let chain = aligned.chain("response").unwrap().unwrap();
        assert!(chain.time_skew() == 0.0);
    }
}
