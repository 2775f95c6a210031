//! Averages over overlapped segments of a long record in memory, or of a stream.

use ndarray::Array2;

use super::{AveragedSpectra, Detrend, SpectrumAverager};
use crate::channel::Channel;
use crate::error::{check_enough_samples, count_mismatch, non_finite_sample, too_few_averages};
use crate::stream::read_next;
use crate::{BlockSource, LabioError, Record, Window};

/// Largest number of segments that may contain the same sample.
const MOST_SEGMENTS_OF_A_SAMPLE: usize = 64;

/// Averaging over overlapped segments of a long stationary record (P. D. Welch, IEEE Trans. Audio
/// Electroacoust. 15 (1967) 70-73).
///
/// The first segment begins at the first sample; samples after the last whole segment are not used.
/// The defaults are half overlap, a periodic Hann window, and no trend removed. The number of
/// independent averages used for all errors is
/// [`SampledWindow::independent_averages`](crate::SampledWindow::independent_averages).
///
/// # Examples
///
/// ```
/// use labio::{Channel, Detrend, Provenance, Quantity, Record, Welch};
/// use ndarray::Array2;
///
/// # fn main() -> Result<(), labio::LabioError> {
/// let sine = Array2::from_shape_fn((1, 4096), |(_, n)| 3.0 + 2.0 * (0.25 * std::f64::consts::PI * n as f64).sin());
/// let channels = vec![Channel::new("end A", Quantity::Velocity)?];
/// let record = Record::new(sine, 800.0, 0.0, channels, Provenance::computed("sine"))?;
///
/// let spectra = Welch::new(256)?.with_detrend(Detrend::Mean).spectra(&record)?;
/// assert_eq!(spectra.n_averages(), 31);
/// // amplitude 2 at 100 Hz, which is line 32
/// assert!((spectra.mean_squares("end A")?[32] - 2.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Welch {
    n_samples: usize,
    n_overlap: usize,
    window: Window,
    detrend: Detrend,
}

impl Welch {
    /// Sets segments of `n_samples` samples that overlap by half.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] for fewer than 3 samples.
    pub fn new(n_samples: usize) -> Result<Self, LabioError> {
        check_enough_samples("a segment", n_samples, 3)?;
        Ok(Self {
            n_samples,
            n_overlap: n_samples / 2,
            window: Window::HannPeriodic,
            detrend: Detrend::None,
        })
    }

    /// Sets the number of samples that a segment shares with the next. No sample may be in more
    /// than 64 segments: more segments add no information, and their number would be bounded only
    /// by the length of the record.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`] if `n_overlap` is more than 63/64 of a segment or, for a
    /// segment of fewer than 64 samples, all of it.
    pub fn with_overlap(self, n_overlap: usize) -> Result<Self, LabioError> {
        let most = self.n_samples - self.n_samples.div_ceil(MOST_SEGMENTS_OF_A_SAMPLE);
        if n_overlap > most {
            return count_mismatch("samples of overlap, at most", n_overlap, most);
        }
        Ok(Self { n_overlap, ..self })
    }

    /// Sets the window.
    #[must_use]
    pub fn with_window(self, window: Window) -> Self {
        Self { window, ..self }
    }

    /// Sets the trend that is removed from every segment before the window.
    #[must_use]
    pub fn with_detrend(self, detrend: Detrend) -> Self {
        Self { detrend, ..self }
    }

    /// Number of samples from the start of a segment to the start of the next.
    fn hop(&self) -> usize {
        self.n_samples - self.n_overlap
    }

    /// Returns the averages over the segments of `record`.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] if the record is shorter than a segment; the errors of
    /// [`SpectrumAverager::new`] and [`SpectrumAverager::spectra`].
    pub fn spectra(&self, record: &Record) -> Result<AveragedSpectra, LabioError> {
        self.spectra_of(&[record])
    }

    /// Returns the averages over the segments of several records of one stationary test. If record
    /// r has $`K_r`$ segments, equivalent to $`n_r`$ independent ones, the effective number of
    /// averages is $`n_e = (\sum K_r)^2/\sum(K_r^2/n_r)`$.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewAverages`] without a record; the errors of [`Welch::spectra`] for each
    /// record; [`LabioError::CountMismatch`], [`LabioError::ChannelMismatch`] or
    /// [`LabioError::SamplingRateMismatch`] for a record that differs from the first.
    pub fn spectra_of(&self, records: &[&Record]) -> Result<AveragedSpectra, LabioError> {
        let Some(first) = records.first() else {
            return too_few_averages("an averaged spectrum", 0, 1);
        };
        // checked before memory is allocated for a segment
        for record in records {
            self.check_long_enough(record.n_samples())?;
        }
        let mut averager = self.averager(first.channels(), first.sampling_rate_hz())?;
        let window = self.window.sample(self.n_samples)?;
        let (mut sum, mut scatter) = (0.0, 0.0);
        for record in records {
            let before = averager.n_averages();
            self.add(&mut averager, record)?;
            let count = averager.n_averages() - before;
            let of_record = window.independent_averages(count, self.hop())?;
            sum += count as f64;
            scatter += (count as f64).powi(2) / of_record;
        }
        // for one record, its exact number
        let effective = match records {
            [_] => window.independent_averages(averager.n_averages(), self.hop())?,
            _ => sum * sum / scatter,
        };
        averager.into_averages(effective)
    }

    /// Adds the segments of one record.
    #[allow(
        clippy::indexing_slicing,
        reason = "a record has a row for each channel, and a segment ends with the samples of the record or before"
    )]
    fn add(&self, averager: &mut SpectrumAverager, record: &Record) -> Result<(), LabioError> {
        averager.check_channels(record)?;
        let samples = record.samples();
        let samples = samples.as_standard_layout();
        let rows: Vec<&[f64]> = samples
            .as_slice()
            .unwrap_or_default()
            .chunks_exact(record.n_samples())
            .collect();
        let mut start = 0;
        while start + self.n_samples <= record.n_samples() {
            averager.add_segment(|channel| &rows[channel][start..start + self.n_samples]);
            start += self.hop();
        }
        Ok(())
    }

    /// Returns the averages over the segments of a stream, read to its end. Memory: five segments
    /// per channel and the sums, independent of the length of the stream. The results are identical
    /// to those of [`Welch::spectra`] for the same samples.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewSamples`] if the stream is shorter than a segment;
    /// [`LabioError::NonFiniteSample`]; [`LabioError::CountMismatch`] if the source replaces the
    /// block that it should fill; any error of the source; the errors of [`SpectrumAverager::new`]
    /// and [`SpectrumAverager::spectra`].
    #[allow(
        clippy::indexing_slicing,
        reason = "every channel holds the samples of the first, and a segment ends with these or before"
    )]
    pub fn spectra_of_stream(
        &self,
        source: &mut dyn BlockSource,
    ) -> Result<AveragedSpectra, LabioError> {
        let channels = source.channels().to_vec();
        let mut averager = self.averager(&channels, source.sampling_rate_hz())?;
        let mut block = Array2::zeros((channels.len(), 2 * self.n_samples));
        // room for a part of a segment and a block
        let mut held: Vec<Vec<f64>> = channels
            .iter()
            .map(|_| Vec::with_capacity(3 * self.n_samples))
            .collect();
        let mut n_read = 0;
        loop {
            let n_new = read_next(source, &mut block)?;
            if n_new == 0 {
                break;
            }
            for ((row, held), channel) in block.rows().into_iter().zip(&mut held).zip(&channels) {
                let n_before = held.len();
                held.extend(row.iter().take(n_new));
                let mut new = held.iter().skip(n_before).enumerate();
                if let Some((position, value)) = new.find(|(_, sample)| !sample.is_finite()) {
                    return non_finite_sample(channel.name().to_owned(), n_read + position, *value);
                }
            }
            n_read += n_new;
            let n_held = held.first().map_or(0, Vec::len);
            let mut start = 0;
            while start + self.n_samples <= n_held {
                averager.add_segment(|channel| &held[channel][start..start + self.n_samples]);
                start += self.hop();
            }
            for held in &mut held {
                held.drain(..start);
            }
        }
        if averager.n_averages() == 0 {
            self.check_long_enough(n_read)?;
        }
        let window = self.window.sample(self.n_samples)?;
        let effective = window.independent_averages(averager.n_averages(), self.hop())?;
        averager.into_averages(effective)
    }

    fn averager(
        &self,
        channels: &[Channel],
        sampling_rate_hz: f64,
    ) -> Result<SpectrumAverager, LabioError> {
        SpectrumAverager::new(channels, self.n_samples, sampling_rate_hz, self.window)
            .map(|averager| averager.with_detrend(self.detrend))
    }

    fn check_long_enough(&self, n_available: usize) -> Result<(), LabioError> {
        let what = "the record to be cut into segments";
        check_enough_samples(what, n_available, self.n_samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quantity;
    use crate::stream::tests::Played;
    use proptest::prelude::*;
    use testbed::noise::Noise;

    fn noise(n_samples: usize, seed: u64) -> Record {
        let mut rng = Noise::seeded(seed);
        let samples = Array2::from_shape_simple_fn((2, n_samples), || rng.normal());
        Record::of_test(
            samples,
            100.0,
            &[("x", Quantity::Force), ("y", Quantity::Velocity)],
        )
    }

    fn bits(spectra: &AveragedSpectra) -> Vec<u64> {
        let cross = spectra.cross("x", "y").unwrap();
        let autos = ["x", "y"].map(|name| spectra.auto(name).unwrap()).concat();
        let cross = cross.iter().flat_map(|g| [g.re, g.im]);
        autos.into_iter().chain(cross).map(f64::to_bits).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        /// Results do not depend on the division of a stream into blocks.
        #[test]
        fn a_stream_gives_the_numbers_of_the_record(
            n_samples in 3_usize..400,
            segment in 3_usize..64,
            overlap in 0.0..1.0_f64,
            at_most in 1_usize..200,
        ) {
            let n_overlap = (0..segment).rev().find(|n| *n as f64 <= overlap * segment as f64).unwrap();
            let welch = Welch::new(segment).unwrap().with_overlap(n_overlap).unwrap().with_detrend(Detrend::Linear);
            let record = noise(n_samples, 5);
            let mut stream = Played::new(record.channels(), record.samples().to_owned(), at_most);
            match (welch.spectra(&record), welch.spectra_of_stream(&mut stream)) {
                (Ok(whole), Ok(streamed)) => {
                    prop_assert_eq!(whole.n_averages(), 1 + (n_samples - segment) / (segment - n_overlap));
                    prop_assert_eq!(whole.n_averages(), streamed.n_averages());
                    prop_assert_eq!(bits(&whole), bits(&streamed));
                }
                (Err(whole), Err(streamed)) => {
                    prop_assert!(n_samples < segment);
                    prop_assert_eq!(whole.to_string(), streamed.to_string());
                }
                other => prop_assert!(false, "{:?}", other),
            }
        }
    }

    #[test]
    fn the_variance_of_overlapped_averages_is_that_of_the_effective_number() {
        // variance of the lines over many records of white noise, each with 8 segments of 64
        // samples that overlap by 75 %
        let welch = Welch::new(64).unwrap().with_overlap(48).unwrap();
        let n_records = 800;
        let mut squares = 0.0;
        let mut n_lines = 0.0;
        let mut effective = 0.0;
        for seed in 0..n_records {
            let spectra = welch.spectra(&noise(64 + 7 * 16, 1000 + seed)).unwrap();
            assert_eq!(spectra.n_averages(), 8);
            effective = spectra.effective_averages();
            // the lines at 0 Hz and at the Nyquist frequency have one component instead of two; the
            // window spreads this effect to the neighbouring lines
            for g in &spectra.power_density("x").unwrap()[2..31] {
                squares += (g / 0.02 - 1.0).powi(2);
                n_lines += 1.0;
            }
        }
        let variance = squares / n_lines;
        // for a gamma distribution of shape 4.3, the relative variance of a squared deviation is
        // 2 + 6/4.3 = 3.4; neighbouring lines of a Hann window are correlated, and 0.44 of their
        // number, 10 200 lines, is independent: a standard error of 2 %
        assert!(
            (variance * effective - 1.0).abs() < 0.08,
            "variance {variance}, effective number {effective}"
        );
        assert!(effective < 5.0); // far fewer than the 8 that were counted
    }

    #[test]
    fn what_cannot_be_cut_is_refused() {
        let record = noise(20, 1);
        let mut infinite = Played::new(record.channels(), record.samples().to_owned(), 7);
        let refusals = [
            Welch::new(2).map(|_| ()),
            Welch::new(8).unwrap().with_overlap(8).map(|_| ()),
            Welch::new(21).unwrap().spectra(&record).map(|_| ()),
            Welch::new(usize::MAX).unwrap().spectra(&record).map(|_| ()),
            Welch::new(21)
                .unwrap()
                .spectra_of_stream(&mut infinite)
                .map(|_| ()),
        ]
        .map(|result| result.unwrap_err().to_string())
        .join("\n");
        insta::assert_snapshot!(refusals, @r"
        a segment has 2 samples, expected at least 3
        samples of overlap, at most: found 8, expected 7
        the record to be cut into segments has 20 samples, expected at least 21
        the record to be cut into segments has 20 samples, expected at least 18446744073709551615
        the record to be cut into segments has 20 samples, expected at least 21
        ");
    }

    #[test]
    fn a_bad_sample_of_a_stream_is_named_by_its_place_in_the_stream() {
        let channel = Channel::new("a", Quantity::Force).unwrap();
        let mut samples = Array2::ones((1, 40));
        samples[(0, 23)] = f64::NAN;
        let error = Welch::new(8)
            .unwrap()
            .spectra_of_stream(&mut Played::new(&[channel], samples, 10))
            .unwrap_err();
        assert_eq!(
            error.to_string(),
            "sample 23 of channel `a` is NaN, expected a finite value"
        );
    }
}
