//! Lines of the data near a frequency, which limit the stated accuracy of a series at that
//! frequency if its order was chosen from the data.

use super::data::ModulusData;
use super::transient::Reading;

/// Range of a line on both sides, as a factor of the frequency. The loss of a branch falls to a
/// fifth within a decade, so a series cannot follow the lines more closely than this.
const REACH: f64 = 10.0;

/// Lines to which a series was fitted whose order was chosen from the data.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Support {
    lines: Vec<Line>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    omega: f64,
    reading: Reading,
    /// Variance of the real part \[Pa²\].
    real: f64,
    /// Variance of the imaginary part \[Pa²\].
    imaginary: f64,
}

impl Support {
    pub(super) fn of(data: &ModulusData) -> Self {
        let lines = data.omega.iter().zip(&data.readings).zip(&data.whitening);
        let line = |((omega, reading), whitening): ((&f64, &Reading), &super::data::Whitening)| {
            let [real, _, imaginary] = whitening.covariance();
            Line {
                omega: *omega,
                reading: *reading,
                real,
                imaginary,
            }
        };
        Self {
            lines: lines.map(line).collect(),
        }
    }

    /// Returns the variances of the real and the imaginary part \[Pa²\] of the mean of the lines
    /// within a decade of `omega`; 0 if there is no line of this kind.
    pub(super) fn variances_about(&self, omega: f64, reading: Reading) -> [f64; 2] {
        let is_near = |line: &&Line| {
            line.reading.is_like(reading) && (omega / REACH..=omega * REACH).contains(&line.omega)
        };
        let of_mean = |variance: fn(&Line) -> f64| {
            let near = self.lines.iter().filter(is_near);
            let weight: f64 = near.map(|line| variance(line).recip()).sum();
            if weight > 0.0 { weight.recip() } else { 0.0 }
        };
        [of_mean(|line| line.real), of_mean(|line| line.imaginary)]
    }
}
