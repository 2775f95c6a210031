//! Passivity of a driving point, line by line.
//!
//! Theory: `docs/theory/spectra.md#conversion-and-checks-of-responses`.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::error::{non_physical, too_few_averages};
use crate::{FrequencyResponse, LabioError, LineValidity, ResponseKind};

/// Degrees of freedom above which the normal distribution replaces Student's: they agree to three
/// digits at a tail probability of 1e-6.
const MANY: f64 = 1e5;

/// Assessment of the real part of a driving-point mobility on one line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Passivity {
    /// The real part is not negative: on average over a period the body absorbs energy.
    Passive,
    /// The real part is negative, but within the random error at the stated level.
    WithinError,
    /// The real part is negative by more than the random error: the response is not that of a
    /// passive body. Causes are a wrong sign, a wrong delay between the channels, a point that is
    /// not the driving point, or a systematic error.
    Active,
    /// The line contains no information.
    Unknown,
}

/// The passivity of a driving point, line by line.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct PassivityReport {
    /// Frequencies of the lines \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Real part of the mobility \[m/(N s)\]; NaN on lines without information.
    pub real_part: Vec<f64>,
    /// Standard error of the real part \[m/(N s)\]; NaN on lines without information.
    pub standard_error: Vec<f64>,
    /// Probability that, if the true real part is zero, a value this low is measured by chance; 1
    /// if the measured value is not negative, NaN on lines without information.
    pub probability: Vec<f64>,
    /// Assessments of the lines.
    pub lines: Vec<Passivity>,
}

impl PassivityReport {
    /// Indices of the lines that contradict a passive body.
    pub fn active_lines(&self) -> impl Iterator<Item = usize> + '_ {
        let lines = self.lines.iter().enumerate();
        lines
            .filter(|(_, verdict)| **verdict == Passivity::Active)
            .map(|(line, _)| line)
    }
}

impl FrequencyResponse {
    /// Compares the real part of the mobility with zero. For a body without a source of energy it
    /// is nowhere negative, $`\mathrm{Re}\,Y(i\omega) \ge 0`$, if force and motion have the same
    /// point and direction and a positive force does work on a positive motion; this is also true
    /// on the line $`s = \sigma + i\omega`$ of an exponential window.
    ///
    /// A line is active if, for a true real part of zero, the probability of measuring a value this
    /// low is less than `level`, by Student's distribution with the degrees of freedom of the
    /// variance and the standard error $`\sqrt{\mathrm{Var}/2}`$ of the real part. With a thousand
    /// lines and the level 1e-5, one passive body in a hundred has an active line. The response may
    /// be of any of the six kinds.
    ///
    /// # Errors
    ///
    /// [`LabioError::NoResponseKind`], [`LabioError::TooFewAverages`] for a response without
    /// variance, [`LabioError::NonPhysical`] for a level that is not between 0 and 1.
    pub fn passivity(&self, level: f64) -> Result<PassivityReport, LabioError> {
        if !(level > 0.0 && level < 1.0) {
            return non_physical(
                "probability level of an active line [-]",
                level,
                "between 0 and 1",
            );
        }
        let mobility = self.to_kind(ResponseKind::Mobility)?;
        let Some(variances) = mobility.variance else {
            return too_few_averages("the passivity of a driving point", self.n_averages, 2);
        };
        let real_part: Vec<f64> = mobility.values.iter().map(|value| value.re).collect();
        let standard_error: Vec<f64> = variances.iter().map(|v| (v / 2.0).sqrt()).collect();
        let freedom = mobility.degrees_of_freedom.as_ref();
        let probability: Vec<f64> = real_part
            .iter()
            .zip(&standard_error)
            .enumerate()
            .map(|(line, (real, error))| {
                let freedom = freedom.and_then(|freedom| freedom.get(line));
                below_zero(*real, *error, freedom.copied().unwrap_or(f64::INFINITY))
            })
            .collect();
        let lines = mobility
            .validity
            .iter()
            .zip(real_part.iter().zip(&probability))
            .map(|(validity, (real, probability))| {
                if *validity != LineValidity::Valid || probability.is_nan() {
                    Passivity::Unknown
                } else if *real >= 0.0 {
                    Passivity::Passive
                } else if *probability >= level {
                    Passivity::WithinError
                } else {
                    Passivity::Active
                }
            })
            .collect();
        Ok(PassivityReport {
            frequency_hz: mobility.frequency_hz,
            real_part,
            standard_error,
            probability,
            lines,
        })
    }
}

/// Returns the probability that a true value of zero is measured as low as `value` by chance.
fn below_zero(value: f64, error: f64, freedom: f64) -> f64 {
    let distance = value / error;
    if value >= 0.0 {
        1.0
    } else if distance.is_nan() {
        f64::NAN
    } else if freedom < MANY {
        StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |law| law.cdf(distance))
    } else {
        Normal::standard().cdf(distance)
    }
}
