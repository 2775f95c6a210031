//! Five hits of one impact-hammer test, `hammer/measurements_{1..5}.npy`: force and acceleration,
//! one second each.
//!
//! The checks cover the whole chain: file, record, averaged spectra, H1 and coherence, and the
//! reconstruction of a force from its response.

use std::ops::Range;
use std::path::Path;

use impulse::{
    BlowSpan, CalibrationBlow, CalibrationLines, CalibrationScatter, ForceHistory, ImpulseError,
    Reconstruction, ResponseNoise, Sensor,
};
use labio::format::npy;
use labio::{AveragedSpectra, Channel, FrequencyResponse, LabioError, Quantity, Record, Window};

use testbed::claim::{Check, Claim, Claims, NotMeasured, Observation, is_absent, of, refused};
use testbed::difference::largest;
use testbed::hold;

const FORCE: &str = "force";
const ACCELERATION: &str = "acceleration";
const SOURCE: &str = "description supplied with the records";
const TARGET: &str = "target of the software: every hit from the other four";
/// The hit whose force is predicted from the others.
const PREDICTED: usize = 4;
/// Level of the band around a predicted force.
const BAND_LEVEL: f64 = 0.95;
/// Lines searched on either side of a resonance; the nearest two are 459 Hz apart.
const SEARCH_HZ: f64 = 50.0;

#[test]
fn claims_hold() {
    let data = testbed::measured::folder();
    hold!(report(data.as_deref()), "measured records");
}

/// All checks of this test, each with the computed value or the reason why there is none.
fn report(data: Option<&Path>) -> Claims {
    let measured = data
        .ok_or_else(|| NotMeasured::Absent("no folder given (--data or RODLAB_DATA)".to_owned()))
        .and_then(read)
        .and_then(|hits| Measured::of(hits).map_err(|error| refused(&error)));
    let mut checks = Vec::new();
    let mut check =
        |what: &str, (source, unit), expected, (tolerance, why), measure: fn(&Measured) -> f64| {
            let claim = Claim::new(what, source).expects(expected, unit);
            checks.push(Check::of(
                claim.within(tolerance, why),
                of(&measured, measure),
            ));
        };
    check(
        "samples per hit",
        (SOURCE, "1"),
        25_600.0,
        (0.0, "exact"),
        |m| m.n_samples,
    );
    check(
        "sampling rate",
        (SOURCE, "Hz"),
        25_600.0,
        (0.0256, "the times in the file are rounded"),
        |m| m.sampling_rate_hz,
    );
    let digit = "half the last printed digit";
    check(
        "smallest peak force of a hit",
        (SOURCE, "N"),
        69.0,
        (0.5, digit),
        |m| least(&m.peak_forces),
    );
    check(
        "largest peak force of a hit",
        (SOURCE, "N"),
        89.0,
        (0.5, digit),
        |m| greatest(&m.peak_forces),
    );
    check(
        "smallest mean of a response",
        (SOURCE, "m/s^2"),
        0.25,
        (0.005, digit),
        |m| least(&m.response_means),
    );
    check(
        "largest mean of a response",
        (SOURCE, "m/s^2"),
        0.32,
        (0.005, digit),
        |m| greatest(&m.response_means),
    );
    check(
        "mean coherence less that stated, in six bands from 10 Hz to 8 kHz",
        (SOURCE, "1"),
        0.0,
        (0.003, "the lines at the edges of the band"),
        |m| {
            let bands = [
                (10.0, 100.0, 0.988),
                (100.0, 500.0, 0.998),
                (500.0, 1000.0, 0.9996),
                (1000.0, 2000.0, 0.999),
                (2000.0, 4000.0, 0.984),
                (4000.0, 8000.0, 0.988),
            ];
            largest(bands.map(|(from_hz, to_hz, stated)| m.mean_coherence(from_hz, to_hz) - stated))
        },
    );
    check(
        "resonances near 900, 2640, 3669 and 4128 Hz: largest difference",
        (SOURCE, "Hz"),
        0.0,
        (1.0, "one spectral line"),
        |m| {
            largest(
                [900.0, 2640.0, 3669.0, 4128.0]
                    .map(|stated| m.largest_response_near(stated) - stated),
            )
        },
    );
    check(
        "force of hit 5 by division: error of the peak",
        (SOURCE, "% of peak"),
        0.0,
        (0.7, "the claim is an upper limit"),
        |m| m.predictions[PREDICTED].by_division.of_peak,
    );
    check(
        "force of hit 5 by division: rms error",
        (SOURCE, "% of peak"),
        0.2,
        (0.05, digit),
        |m| m.predictions[PREDICTED].by_division.rms,
    );
    check(
        "forces of five hits: error of the peak over the half width of its band of 95 %",
        (TARGET, "1"),
        0.0,
        (
            1.0,
            "the width of the band, from Student's distribution for four hits",
        ),
        |m| largest(m.predictions.each_ref().map(|p| p.peak_over_band)),
    );
    check(
        "forces of five hits on their supports: rms error",
        (TARGET, "% of peak"),
        0.0,
        (0.3, "the claim is an upper limit"),
        |m| largest(m.predictions.each_ref().map(|p| p.on_support.rms)),
    );
    check(
        "forces of five hits: samples inside the band of their hit",
        (TARGET, "%"),
        100.0,
        (100.0 * (1.0 - BAND_LEVEL), "the probability of the band"),
        |m| 100.0 - largest(m.predictions.each_ref().map(|p| 100.0 - p.covered_percent)),
    );
    Claims {
        checks,
        observations: measured.map_or_else(|_| Vec::new(), |m| m.observations()),
        ..Claims::default()
    }
}

/// Measured quantities that the checks require.
struct Measured {
    n_samples: f64,
    sampling_rate_hz: f64,
    peak_forces: Vec<f64>,
    response_means: Vec<f64>,
    frequency_hz: Vec<f64>,
    coherence: Vec<f64>,
    response: FrequencyResponse,
    /// Predictions of every hit from the four others.
    predictions: [Prediction; 5],
}

/// A force reconstructed from its response and the frequency response of other hits, against the
/// measured force.
struct Prediction {
    /// Errors of the division line by line, over the whole record.
    by_division: Errors,
    /// Errors of least squares on the samples where the force acts, weighted by the noise of the
    /// lines.
    on_support: Errors,
    /// Percentage of the samples of the support at which the measured force is in the band.
    covered_percent: f64,
    /// Half width of the band at the peak, in percent of the peak.
    half_width_at_peak: f64,
    /// Error of the peak divided by the half width of the band there.
    peak_over_band: f64,
}

/// Errors in percent of the peak.
struct Errors {
    of_peak: f64,
    rms: f64,
}

impl Errors {
    fn between(found: &ForceHistory, measured: &[f64]) -> Self {
        let peak = greatest(measured);
        let squares: f64 = measured
            .iter()
            .zip(found.force())
            .map(|(measured, found)| (found - measured).powi(2))
            .sum();
        Self {
            of_peak: 100.0 * (found.peak().force / peak - 1.0),
            rms: 100.0 * (squares / measured.len() as f64).sqrt() / peak,
        }
    }
}

fn read(data: &Path) -> Result<[Record; 5], NotMeasured> {
    let channels = [
        Channel::new(FORCE, Quantity::Force),
        Channel::new(ACCELERATION, Quantity::Acceleration),
    ];
    let [force, acceleration] = channels.map(|channel| channel.map_err(|e| refused(&e)));
    let channels = [force?, acceleration?];
    let hit = |number: usize| {
        let path = data
            .join("hammer")
            .join(format!("measurements_{number}.npy"));
        npy::read(&path, &channels).map_err(|error| {
            if is_absent(&error) {
                NotMeasured::Absent(format!("hammer/measurements_{number}.npy does not exist"))
            } else {
                refused(&error)
            }
        })
    };
    Ok([hit(1)?, hit(2)?, hit(3)?, hit(4)?, hit(5)?])
}

impl Measured {
    fn of(hits: [Record; 5]) -> Result<Self, MeasureError> {
        let spectra = AveragedSpectra::of(&hits, Window::Rectangular)?;
        let coherence = spectra.coherence(FORCE, ACCELERATION)?;
        let mut peak_forces = Vec::new();
        let mut response_means = Vec::new();
        for hit in &hits {
            peak_forces.push(greatest(&hit.channel(FORCE)?.to_vec()));
            response_means.push(hit.channel(ACCELERATION)?.mean().unwrap_or(f64::NAN));
        }
        let [first, ..] = &hits;
        Ok(Self {
            n_samples: first.n_samples() as f64,
            sampling_rate_hz: first.sampling_rate_hz(),
            peak_forces,
            response_means,
            frequency_hz: coherence.frequency_hz,
            coherence: coherence.values,
            response: spectra.h1(FORCE, ACCELERATION)?,
            predictions: [
                Prediction::of(&hits, 0)?,
                Prediction::of(&hits, 1)?,
                Prediction::of(&hits, 2)?,
                Prediction::of(&hits, 3)?,
                Prediction::of(&hits, 4)?,
            ],
        })
    }

    /// Mean over lines in `from_hz..to_hz`.
    fn mean_coherence(&self, from_hz: f64, to_hz: f64) -> f64 {
        let lines = self.frequency_hz.iter().zip(&self.coherence);
        let band: Vec<f64> = lines
            .filter(|(f, _)| (from_hz..to_hz).contains(*f))
            .map(|(_, coherence)| *coherence)
            .collect();
        band.iter().sum::<f64>() / band.len() as f64
    }

    /// Frequency of the line with the largest magnitude of H1.
    fn largest_response_near(&self, frequency_hz: f64) -> f64 {
        self.frequency_hz
            .iter()
            .zip(&self.response.values)
            .filter(|(f, _)| (*f - frequency_hz).abs() <= SEARCH_HZ)
            .max_by(|(_, a), (_, b)| a.norm().total_cmp(&b.norm()))
            .map_or(f64::NAN, |(f, _)| *f)
    }

    /// Observations of the predicted forces that are not claims.
    fn observations(&self) -> Vec<Observation> {
        let mut observations = Vec::new();
        let mut observe = |what: String, ours| {
            observations.push(Observation {
                what,
                unit: "% of peak",
                ours,
            });
        };
        for (index, prediction) in self.predictions.iter().enumerate() {
            let number = index + 1;
            if index != PREDICTED {
                let Errors { of_peak, rms } = prediction.by_division;
                observe(
                    format!("force of hit {number} by division: error of the peak"),
                    of_peak,
                );
                observe(format!("force of hit {number} by division: rms error"), rms);
            }
            observe(
                format!("force of hit {number} on its support: error of the peak"),
                prediction.on_support.of_peak,
            );
            observe(
                format!("force of hit {number} on its support: half width of the band at the peak"),
                prediction.half_width_at_peak,
            );
        }
        observations
    }
}

impl Prediction {
    fn of(hits: &[Record; 5], predicted: usize) -> Result<Self, MeasureError> {
        let others: Vec<&Record> = hits
            .iter()
            .enumerate()
            .filter(|(index, _)| *index != predicted)
            .map(|(_, hit)| hit)
            .collect();
        let (window, found) = force_of(&hits[predicted], &others)?;
        // each of the other hits predicted from the remaining three: the error of such a prediction
        // on the samples where the force acts
        let blows = (0..others.len())
            .map(|index| {
                let mut remaining = others.clone();
                let blow = remaining.remove(index);
                let (window, force) = force_of(blow, &remaining)?;
                let inside =
                    |samples: &[f64]| samples.get(window.clone()).unwrap_or_default().to_vec();
                let reconstructed =
                    ForceHistory::new(0.0, force.time_step(), inside(force.force()))?;
                Ok((reconstructed, inside(&blow.channel(FORCE)?.to_vec())))
            })
            .collect::<Result<Vec<_>, MeasureError>>()?;
        let longest = blows.iter().map(|(_, measured)| measured.len()).max();
        let blows: Vec<CalibrationBlow<'_>> = blows
            .iter()
            .map(|(reconstructed, measured)| CalibrationBlow {
                reconstructed,
                measured,
                standard_error: None,
            })
            .collect();
        let scatter = CalibrationScatter::of(&blows, 0..longest.unwrap_or(0))?;
        let band = scatter
            .error(&found, window.clone(), None)
            .pointwise(&found, BAND_LEVEL)?;

        let force = hits[predicted].channel(FORCE)?.to_vec();
        let at_peak = (0..force.len())
            .max_by(|a, b| force[*a].total_cmp(&force[*b]))
            .unwrap_or(0);
        let response = hits[predicted].channel(ACCELERATION)?.to_vec();
        let spectra = AveragedSpectra::of(others, Window::Rectangular)?;
        let h1 = spectra.h1(FORCE, ACCELERATION)?;
        let divided =
            Reconstruction::new(&response, hits[predicted].sampling_rate_hz(), &h1.values)?
                .without_lines(h1.invalid_lines())
                .solve()?;
        let half_width_at_peak =
            50.0 * (band.upper[at_peak] - band.lower[at_peak]) / greatest(&force);
        let on_support = Errors::between(&found, &force);
        Ok(Self {
            peak_over_band: on_support.of_peak / half_width_at_peak,
            by_division: Errors::between(&divided.history, &force),
            on_support,
            covered_percent: 100.0 * band.part_inside(&force, window),
            half_width_at_peak,
        })
    }
}

/// Reconstructs the force of `hit` from its response and the other hits, as `rodlab force` does by
/// default: their average is the frequency response, their scatter is the noise of each line, and
/// the force acts as long as theirs, around the peak found by division. Returns the samples of that
/// support, and the force.
fn force_of(
    hit: &Record,
    others: &[&Record],
) -> Result<(Range<usize>, ForceHistory), MeasureError> {
    let h1 = AveragedSpectra::of(others.iter().copied(), Window::Rectangular)?
        .h1(FORCE, ACCELERATION)?;
    let response = hit.channel(ACCELERATION)?.to_vec();
    let rate_hz = hit.sampling_rate_hz();
    let divided = Reconstruction::new(&response, rate_hz, &h1.values)?
        .without_lines(h1.invalid_lines())
        .solve()?
        .history;
    let mut forces = Vec::new();
    for other in others {
        forces.push(other.channel(FORCE)?.to_vec());
    }
    let forces: Vec<&[f64]> = forces.iter().map(Vec::as_slice).collect();
    let at_peak = divided.index_near(divided.peak().time).unwrap_or(0);
    let window = BlowSpan::of(&forces)?.map_or(0..response.len(), |span| {
        span.about(at_peak, response.len())
    });
    let variance = h1.variance.as_deref().unwrap_or_default();
    let lines = CalibrationLines::of(variance, &forces)?;
    let sensor = Sensor::new(&response, &h1.values)?
        .with_noise(ResponseNoise::Lines(&lines.noise))?
        .with_variance(&lines.variance)?
        .without_lines(h1.invalid_lines());
    let found = Reconstruction::of_sensors(vec![sensor], rate_hz)?
        .acting_during(BlowSpan::interval(&window, rate_hz))
        .like_blows(&lines)
        .solve()?;
    Ok((window, found.history))
}

#[derive(Debug, thiserror::Error)]
enum MeasureError {
    #[error("spectra of the hits")]
    Spectra {
        #[from]
        source: LabioError,
    },
    #[error("force from the response")]
    Force {
        #[from]
        source: ImpulseError,
    },
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use testbed::claim::Verdict;

    #[test]
    fn without_records_every_check_is_skipped_and_listed() {
        for data in [None, Some(Path::new("no such folder"))] {
            let report = report(data);
            assert_eq!(
                (report.checks.len(), report.count(Verdict::Skipped)),
                (13, 13)
            );
        }
    }

    #[test]
    fn a_record_that_cannot_be_read_fails_every_check() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hammer");
        std::fs::create_dir(&path).unwrap();
        std::fs::write(path.join("measurements_1.npy"), b"not an array").unwrap();
        assert_eq!(report(Some(folder.path())).count(Verdict::Fail), 13);
    }
}
