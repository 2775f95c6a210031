//! Ratio of two channels of hits, with its random and common errors.
//!
//! Averages of several hits, one shot with the silence before it, pulses cut out of the hits, and
//! ratios computed by other programs are all represented by one type, [`ResponseRatio`].
//!
//! Theory: `docs/theory/one-shot.md`, `docs/theory/neighbouring-methods.md#small-numbers-of-hits`.

mod drawn;
mod echo;
mod freedom;
mod one_shot;
pub mod pooling;
mod pulse_windows;
mod pulses;
mod rounding;

pub use drawn::add_random_errors;
pub use echo::Pulse;
pub use freedom::DegreesOfFreedom;
pub use pulse_windows::{find_cut_edges, find_other_pulse};
pub use pulses::{PulseWindow, noise_of_cut_pulse};

use num_complex::Complex64;

use crate::error::{check_count, non_physical, too_few_averages};
use crate::frf::chance_level;
use crate::{AveragedSpectra, LabioError, Record, RestNoise, SensorError, Window};
use freedom::check_averages;
use one_shot::ChannelAtRest;
use pooling::AveragedVariance;

/// Allowance by which rounding may raise a coherence above 1.
const ROUNDING: f64 = 1e-12;

/// A ratio of spectra, numerator divided by denominator, with its errors. All lists have one entry
/// per line.
///
/// | field | unit |
/// |---|---|
/// | `frequency_hz` | Hz |
/// | `values` | unit of numerator / unit of denominator |
/// | `variance` | square of the unit of `values` |
/// | `freedom`, `coherence` | 1 |
///
/// ```
/// use labio::{Channel, Provenance, Quantity, Record, ResponseRatio};
/// use ndarray::Array2;
///
/// # fn main() -> Result<(), labio::LabioError> {
/// let channels = ["struck", "free"].map(|name| Channel::new(name, Quantity::Acceleration));
/// let [struck, free] = channels;
/// let channels = vec![struck?, free?];
/// // the free end moves twice as much, three samples later, with a noise of a thousandth
/// let hit = |seed: usize| {
///     let pulse = |n: usize| if (8..24).contains(&n) { (n as f64 - 16.0).cos() } else { 0.0 };
///     let noise = |n: usize| 1e-3 * ((n * n + 7 * seed * n) as f64).sin();
///     let samples = Array2::from_shape_fn((2, 64), |(channel, n)| match channel {
///         0 => pulse(n),
///         _ => 2.0 * pulse(n.saturating_sub(3)) + noise(n),
///     });
///     Record::new(samples, 1e4, 0.0, channels.clone(), Provenance::computed("example"))
/// };
/// let hits = [hit(1)?, hit(2)?, hit(3)?];
/// let hits: Vec<&Record> = hits.iter().collect();
/// let ratio = ResponseRatio::of_hits(&hits, "free", "struck")?;
/// assert!((ratio.values[10].norm() - 2.0).abs() < 5.0 * ratio.variance[10].sqrt());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ResponseRatio {
    /// Frequencies \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Numerator divided by denominator.
    pub values: Vec<Complex64>,
    /// E|δΨ|², the random error of real and imaginary part together; infinite where the value is
    /// unknown.
    pub variance: Vec<f64>,
    /// Degrees of freedom of the variances; `None` if the variances are known.
    pub freedom: Option<Vec<DegreesOfFreedom>>,
    /// Ordinary coherence; `None` for one hit.
    pub coherence: Option<Vec<f64>>,
    /// Effective number of averages from which the coherence was computed.
    pub averages: Option<f64>,
    /// Number of lines for each line with independent noise; see [`pooling::AveragedVariance`].
    pub lines_per_independent_line: f64,
    /// Delay \[s\] of the numerator relative to the denominator, if both are pulses.
    pub delay: Option<f64>,
    /// Errors that all lines share: those of the ratio of the sensitivities and of the delay
    /// between the channels. Zero for the ratio of two parts of one channel.
    pub common: SensorError,
}

impl ResponseRatio {
    /// Returns the ratio of `numerator` to `denominator` from several hits, or from one hit whose
    /// first `n_silent` samples are before the impact.
    ///
    /// # Errors
    ///
    /// The errors of [`Self::of_hits`] and [`Self::of_shot`].
    pub fn of(
        hits: &[&Record],
        n_silent: Option<usize>,
        numerator: &str,
        denominator: &str,
    ) -> Result<Self, LabioError> {
        match (hits, n_silent) {
            ([hit], Some(n_silent)) => Self::of_shot(hit, n_silent, numerator, denominator),
            _ => Self::of_hits_at_rest(hits, n_silent, numerator, denominator),
        }
    }

    /// Returns H1 of several hits with the denominator as input. Its variance follows from the
    /// coherence, pooled over neighbouring lines if there are few hits ([`pooling`]). If the step
    /// of a converter exceeds the noise, the part of its rounding errors that all hits share is
    /// added.
    ///
    /// # Errors
    ///
    /// [`LabioError::TooFewAverages`] for fewer than two hits, for which the coherence contains no
    /// information; [`LabioError::NoNoise`] for hits whose coherence is 1 to rounding;
    /// [`LabioError::UnknownChannel`]; the errors of [`AveragedSpectra::of`].
    pub fn of_hits(
        hits: &[&Record],
        numerator: &str,
        denominator: &str,
    ) -> Result<Self, LabioError> {
        Self::of_hits_at_rest(hits, None, numerator, denominator)
    }

    fn of_hits_at_rest(
        hits: &[&Record],
        n_silent: Option<usize>,
        numerator: &str,
        denominator: &str,
    ) -> Result<Self, LabioError> {
        let names = [numerator, denominator];
        let spectra = AveragedSpectra::of(hits.iter().copied(), Window::Rectangular)?;
        let mut ratio = Self::averaged(&spectra, numerator, denominator, 1.0)?;
        if let Some(shared) = rounding::shared_variance(hits, n_silent, &ratio.values, names)? {
            for (variance, shared) in ratio.variance.iter_mut().zip(shared) {
                *variance += shared;
            }
        }
        ratio.with_sensors_of(hits, names)
    }

    /// Returns the ratio from one shot, with a variance found from the first `n_silent` samples,
    /// before the impact.
    ///
    /// ```math
    /// \mathrm{E}|\delta r|^2 = \frac{S_y + |r|^2S_x}{|x|^2},
    /// ```
    ///
    /// where S are the energies of the noise predicted from the silence before the impact. The
    /// coherence of one hit is 1 and contains no information.
    ///
    /// # Validity
    ///
    /// Valid for noise that is stationary and independent of the signal, but not for the rounding
    /// of a converter whose output hardly changes at rest, nor for a disturbance that begins with
    /// the impact.
    ///
    /// # Errors
    ///
    /// The errors of [`RestNoise::before`] and [`AveragedSpectra::of`].
    pub fn of_shot(
        hit: &Record,
        n_silent: usize,
        numerator: &str,
        denominator: &str,
    ) -> Result<Self, LabioError> {
        let noises = [numerator, denominator].map(|name| RestNoise::before(&[hit], name, n_silent));
        let [of_numerator, of_denominator] = noises;
        let (of_numerator, of_denominator) = (of_numerator?, of_denominator?);
        let at_rest = |channel, noise| ChannelAtRest {
            channel,
            noise,
            duration: hit.duration(),
        };
        let spectra = AveragedSpectra::of([hit], Window::Rectangular)?;
        let ratio = one_shot::ratio(
            &spectra,
            at_rest(numerator, &of_numerator),
            at_rest(denominator, &of_denominator),
        )?;
        ratio.with_sensors_of(&[hit], [numerator, denominator])
    }

    /// Creates a ratio computed by another program, with the ordinary `coherence` of its
    /// `averages`: E|δΨ|² = |Ψ|² (1 - γ²)/((n - 1) γ²), infinite where the coherence is 0 or NaN.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for fewer than two averages, or for a coherence outside 0 to 1;
    /// [`LabioError::CountMismatch`].
    pub fn from_coherence(
        frequency_hz: Vec<f64>,
        values: Vec<Complex64>,
        coherence: Vec<f64>,
        averages: f64,
    ) -> Result<Self, LabioError> {
        let freedom = DegreesOfFreedom::of_averages(averages)?;
        let variance = variance_from_coherence(&values, &coherence, averages)?;
        Ok(Self {
            freedom: Some(vec![freedom; values.len()]),
            coherence: Some(coherence),
            averages: Some(averages),
            ..Self::from_variance(frequency_hz, values, variance)?
        })
    }

    /// Creates a ratio computed by another program, with its known variance E|δΨ|².
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`]; [`LabioError::NonPhysical`] for a negative variance.
    pub fn from_variance(
        frequency_hz: Vec<f64>,
        values: Vec<Complex64>,
        variance: Vec<f64>,
    ) -> Result<Self, LabioError> {
        check_count("frequencies of a ratio", frequency_hz.len(), values.len())?;
        check_count("variances of a ratio", variance.len(), values.len())?;
        if let Some(negative) = variance.iter().find(|variance| **variance < 0.0) {
            return non_physical("variance of a ratio", *negative, "0 or more");
        }
        Ok(Self {
            frequency_hz,
            values,
            variance,
            freedom: None,
            coherence: None,
            averages: None,
            lines_per_independent_line: 1.0,
            delay: None,
            common: SensorError::default(),
        })
    }

    /// Keeps the lines `from..to`.
    pub fn keep(&mut self, from: usize, to: usize) {
        keep(&mut self.frequency_hz, from, to);
        keep(&mut self.values, from, to);
        keep(&mut self.variance, from, to);
        if let Some(coherence) = &mut self.coherence {
            keep(coherence, from, to);
        }
        if let Some(freedom) = &mut self.freedom {
            keep(freedom, from, to);
        }
    }

    /// Returns for each line whether its coherence is so high that noise alone reaches it with a
    /// probability below `probability`; `None` without coherence.
    #[must_use]
    pub fn above_chance(&self, probability: f64) -> Option<Vec<bool>> {
        let averages = self.averages.filter(|averages| *averages > 1.0)?;
        let level = chance_level(probability, averages);
        let coherence = self.coherence.as_ref()?;
        Some(coherence.iter().map(|value| *value > level).collect())
    }

    /// Returns H1 of averaged spectra with its pooled variance, without the errors of the sensors.
    fn averaged(
        spectra: &AveragedSpectra,
        numerator: &str,
        denominator: &str,
        lines_per_independent_line: f64,
    ) -> Result<Self, LabioError> {
        let response = spectra.h1(denominator, numerator)?;
        let Some(coherence) = response.coherence else {
            return too_few_averages(
                "the error of a ratio from its coherence",
                response.n_averages,
                2,
            );
        };
        if spectra
            .coherence(denominator, numerator)?
            .is_one_to_rounding()
        {
            return Err(LabioError::NoNoise {
                input: denominator.to_owned(),
                output: numerator.to_owned(),
                hits: spectra.n_averages(),
            });
        }
        let averages = response.effective_averages;
        let variance = variance_from_coherence(&response.values, &coherence, averages)?;
        let pooled = AveragedVariance {
            ratio: &response.values,
            variance: &variance,
            denominator_power: &spectra.auto(denominator)?,
            averages,
            lines_per_independent_line,
        }
        .pooled()?;
        Ok(Self {
            freedom: Some(pooled.freedom),
            coherence: Some(coherence),
            averages: Some(averages),
            lines_per_independent_line,
            ..Self::from_variance(response.frequency_hz, response.values, pooled.variance)?
        })
    }

    /// Adds the errors of the sensors of two channels of the first hit; adds none if both channels
    /// are the same.
    fn with_sensors_of(
        mut self,
        hits: &[&Record],
        [numerator, denominator]: [&str; 2],
    ) -> Result<Self, LabioError> {
        if let Some(hit) = hits.first().filter(|_| numerator != denominator) {
            let of_denominator = hit.sensor_error(denominator)?;
            self.common = hit.sensor_error(numerator)?.combined(of_denominator);
        }
        Ok(self)
    }
}

/// Returns E|δΨ|² of every line from its coherence.
fn variance_from_coherence(
    values: &[Complex64],
    coherence: &[f64],
    averages: f64,
) -> Result<Vec<f64>, LabioError> {
    check_count("coherences of a ratio", coherence.len(), values.len())?;
    let averages = check_averages(averages)?;
    let of_line = |(value, coherence): (&Complex64, &f64)| {
        if coherence.is_nan() {
            return Ok(f64::INFINITY);
        }
        if !(0.0..=1.0 + ROUNDING).contains(coherence) {
            return non_physical("coherence", *coherence, "from 0 to 1");
        }
        let incoherent = (1.0 - coherence).max(0.0);
        Ok(if *coherence <= 0.0 {
            f64::INFINITY
        } else if incoherent <= 0.0 {
            0.0 // also where the square of the ratio overflows
        } else {
            value.norm_sqr() * incoherent / ((averages - 1.0) * coherence)
        })
    };
    values.iter().zip(coherence).map(of_line).collect()
}

/// Keeps the entries `from..to`.
pub(crate) fn keep<T>(values: &mut Vec<T>, from: usize, to: usize) {
    values.truncate(to);
    values.drain(..from.min(values.len()));
}

#[cfg(test)]
mod tests;
