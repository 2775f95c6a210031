//! The force that made a known body move as was measured.

mod options;
mod outcome;

use std::collections::BTreeSet;

use num_complex::Complex64;

use crate::error::{check_interval, check_positive, check_samples};
use crate::{ForceHistory, ImpulseError, fourier};

pub use options::{FrequencyBand, Regularisation, TimeInterval};
pub use outcome::{ExcludedLine, ExclusionReason, ReconstructedForce, ResponseEnd};

/// One part in so many of the record, at its end, tells whether the response has died out.
const PARTS_TO_END: usize = 50;
/// Largest level of the response at its end, relative to its peak, that counts as died out.
const DIED_OUT: f64 = 0.01;

/// Force from a measured response $`x`$ and a known frequency response $`H = \hat x/\hat F`$: the inverse use of the impulse response.
///
/// | input | shape | unit |
/// |---|---|---|
/// | response | `(n_samples)` | unit of x |
/// | frequency response | `(n_samples/2 + 1)`, from 0 Hz, lines $`1/(N\Delta t)`$ apart | unit of x per N |
///
/// # Validity
///
/// The body is linear and nothing but the force moves it. The record holds the whole response: the division is that of one period,
/// and what is cut off at the end appears as a force all over the record ([`ReconstructedForce::response_end`]).
///
/// # Examples
///
/// ```
/// use impulse::Reconstruction;
/// use num_complex::Complex64;
///
/// # fn main() -> Result<(), impulse::ImpulseError> {
/// // a body whose response halves from sample to sample: x_n = x_{n-1}/2 + F_n
/// let force = [0.0, 0.0, 1.0, 3.0, 1.0];
/// let mut response = vec![0.0; 64];
/// for n in 1..response.len() {
///     response[n] = 0.5 * response[n - 1] + force.get(n).unwrap_or(&0.0);
/// }
/// let turn = |k: usize| Complex64::cis(-2.0 * std::f64::consts::PI * k as f64 / 64.0);
/// let frequency_response: Vec<_> = (0..=32).map(|k| 1.0 / (1.0 - 0.5 * turn(k))).collect();
///
/// let found = Reconstruction::new(&response, 1000.0, &frequency_response)?.solve()?;
/// assert!((found.history.peak().force - 3.0).abs() < 1e-12);
/// assert!(found.relative_residual < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Reconstruction<'a> {
    response: &'a [f64],
    sampling_rate_hz: f64,
    frequency_response: &'a [Complex64],
    regularisation: Regularisation,
    band: Option<FrequencyBand>,
    left_out: BTreeSet<usize>,
    support: Option<TimeInterval>,
}

impl<'a> Reconstruction<'a> {
    /// A plain division over all lines, to be narrowed by the methods below.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for the sampling rate, [`ImpulseError::TooShort`] below four samples,
    /// [`ImpulseError::NonFinite`] for a sample, [`ImpulseError::LengthMismatch`] for the frequency response.
    pub fn new(
        response: &'a [f64],
        sampling_rate_hz: f64,
        frequency_response: &'a [Complex64],
    ) -> Result<Self, ImpulseError> {
        check_positive("sampling rate [Hz]", sampling_rate_hz)?;
        if response.len() < 4 {
            return Err(ImpulseError::TooShort {
                what: "response",
                found: response.len(),
                expected: 4,
            });
        }
        check_samples("response", response)?;
        if frequency_response.len() != response.len() / 2 + 1 {
            return Err(ImpulseError::LengthMismatch {
                what: "frequency response",
                found: frequency_response.len(),
                expected: response.len() / 2 + 1,
            });
        }
        Ok(Self {
            response,
            sampling_rate_hz,
            frequency_response,
            regularisation: Regularisation::None,
            band: None,
            left_out: BTreeSet::new(),
            support: None,
        })
    }

    /// Divides with this regularisation.
    #[must_use]
    pub fn with_regularisation(self, regularisation: Regularisation) -> Self {
        Self {
            regularisation,
            ..self
        }
    }

    /// Uses the lines of `band` only.
    #[must_use]
    pub fn within(self, band: FrequencyBand) -> Self {
        Self {
            band: Some(band),
            ..self
        }
    }

    /// Leaves lines out, as those whose frequency response is not known. What stands there is not read.
    #[must_use]
    pub fn without_lines(mut self, lines: impl IntoIterator<Item = usize>) -> Self {
        self.left_out.extend(lines);
        self
    }

    /// The force acts in `support` only: it is set to zero outside, and what was there is reported.
    #[must_use]
    pub fn acting_during(self, support: TimeInterval) -> Self {
        Self {
            support: Some(support),
            ..self
        }
    }

    /// Computes the force.
    ///
    /// # Errors
    ///
    /// - [`ImpulseError::NonPhysical`] for the regularisation; [`ImpulseError::EmptyInterval`] for band or support;
    ///   [`ImpulseError::UnknownLine`] for a line to be left out.
    /// - [`ImpulseError::NonFinite`] for a frequency response that is not left out.
    /// - [`ImpulseError::SpectrumOverflow`]; [`ImpulseError::NoUsableLine`].
    pub fn solve(&self) -> Result<ReconstructedForce, ImpulseError> {
        let lambda = self.checked_lambda()?;
        let n_samples = self.response.len();
        let response = fourier::to_spectrum(self.response);
        let mut force = vec![Complex64::ZERO; response.len()];
        let mut excluded = Vec::new();
        let mut squared_gains = 0.0;
        for (index, (h, x)) in self.frequency_response.iter().zip(&response).enumerate() {
            if let Some(reason) = self.exclusion(index, *h)? {
                excluded.push(ExcludedLine {
                    index,
                    frequency_hz: self.frequency_hz(index),
                    reason,
                });
                continue;
            }
            let magnitude = h.norm();
            // conj(H)/(|H|^2 + lambda), arranged so that no square of a small response underflows
            let gain = (h.conj() / magnitude) / (magnitude + lambda / magnitude);
            let line = gain * x;
            if !line.is_finite() {
                return Err(ImpulseError::SpectrumOverflow { index });
            }
            squared_gains += self.sides(index) * gain.norm_sqr();
            if let Some(slot) = force.get_mut(index) {
                *slot = line;
            }
        }
        if excluded.len() == response.len() {
            return Err(ImpulseError::NoUsableLine {
                n_lines: response.len(),
            });
        }
        let mut samples = fourier::to_samples(&force, n_samples);
        for sample in &mut samples {
            *sample /= n_samples as f64;
        }
        let mean_is_open = excluded.first().is_some_and(|line| line.index == 0);
        let confinement = self.confine(&mut samples, mean_is_open)?;
        let relative_residual = self.relative_residual(&response, &samples);
        Ok(ReconstructedForce {
            history: ForceHistory::new(0.0, 1.0 / self.sampling_rate_hz, samples)?,
            regularisation: self.regularisation,
            relative_residual,
            noise_gain: (squared_gains / n_samples as f64).sqrt(),
            excluded,
            added_constant: confinement.added_constant,
            outside_support: confinement.outside,
            response_end: self.response_end(),
        })
    }

    fn checked_lambda(&self) -> Result<f64, ImpulseError> {
        if let Some(FrequencyBand { from_hz, to_hz }) = self.band {
            check_interval("frequency band [Hz]", from_hz, to_hz)?;
        }
        if let Some(TimeInterval { from, to }) = self.support {
            check_interval("support of the force [s]", from, to)?;
        }
        let n_lines = self.frequency_response.len();
        if let Some(&index) = self.left_out.last()
            && index >= n_lines
        {
            return Err(ImpulseError::UnknownLine { index, n_lines });
        }
        match self.regularisation {
            Regularisation::None => Ok(0.0),
            Regularisation::Tikhonov { lambda } => {
                check_positive("regularisation parameter [unit of |H|^2]", lambda)
            }
        }
    }

    fn exclusion(
        &self,
        index: usize,
        h: Complex64,
    ) -> Result<Option<ExclusionReason>, ImpulseError> {
        if self.left_out.contains(&index) {
            return Ok(Some(ExclusionReason::LeftOut));
        }
        if !h.is_finite() {
            return Err(ImpulseError::NonFinite {
                what: "frequency response",
                index,
            });
        }
        let frequency_hz = self.frequency_hz(index);
        if self
            .band
            .is_some_and(|band| frequency_hz < band.from_hz || frequency_hz > band.to_hz)
        {
            return Ok(Some(ExclusionReason::OutsideBand));
        }
        if h == Complex64::ZERO {
            return Ok(Some(ExclusionReason::VanishingResponse));
        }
        Ok(None)
    }

    /// Applies the support.
    fn confine(
        &self,
        samples: &mut [f64],
        mean_is_open: bool,
    ) -> Result<Confinement, ImpulseError> {
        let Some(support) = self.support else {
            return Ok(Confinement::default());
        };
        let rate = self.sampling_rate_hz;
        let outside = |index: usize| {
            let time = index as f64 / rate;
            time < support.from || time > support.to
        };
        let beyond: Vec<f64> = samples
            .iter()
            .enumerate()
            .filter(|(index, _)| outside(*index))
            .map(|(_, force)| *force)
            .collect();
        let n_beyond = beyond.len().max(1) as f64;
        if beyond.len() == samples.len() {
            return Err(ImpulseError::SupportOutsideRecord {
                from: support.from,
                to: support.to,
            });
        }
        let added_constant = if mean_is_open {
            -beyond.iter().sum::<f64>() / n_beyond
        } else {
            0.0
        };
        let squares: f64 = beyond.iter().map(|f| (f + added_constant).powi(2)).sum();
        for (index, sample) in samples.iter_mut().enumerate() {
            *sample = if outside(index) {
                0.0
            } else {
                *sample + added_constant
            };
        }
        Ok(Confinement {
            added_constant,
            outside: Some((squares / n_beyond).sqrt()),
        })
    }

    /// ‖x - h*F‖/‖x‖ by Parseval's relation.
    fn relative_residual(&self, response: &[Complex64], force: &[f64]) -> f64 {
        let force = fourier::to_spectrum(force);
        let lines = response.iter().zip(self.frequency_response).zip(&force);
        let (mut left, mut all) = (0.0, 0.0);
        for (index, ((x, h), f)) in lines.enumerate() {
            if self.left_out.contains(&index) {
                continue;
            }
            left += self.sides(index) * (x - h * f).norm_sqr();
            all += self.sides(index) * x.norm_sqr();
        }
        if all > 0.0 { (left / all).sqrt() } else { 0.0 }
    }

    fn response_end(&self) -> ResponseEnd {
        let n = self.response.len();
        let n_end = n.div_ceil(PARTS_TO_END);
        let end = self.response.get(n - n_end..).unwrap_or_default();
        let mean_square = end.iter().map(|x| x * x).sum::<f64>() / n_end as f64;
        let peak = self
            .response
            .iter()
            .fold(0.0, |peak: f64, x| peak.max(x.abs()));
        let relative_level = mean_square.sqrt() / peak;
        if relative_level > DIED_OUT {
            ResponseEnd::CutOff { relative_level }
        } else {
            ResponseEnd::DiedOut
        }
    }

    fn frequency_hz(&self, index: usize) -> f64 {
        index as f64 * self.sampling_rate_hz / self.response.len() as f64
    }

    /// 2 for the lines that stand for two sides, 1 at 0 Hz and at the Nyquist frequency.
    fn sides(&self, index: usize) -> f64 {
        if index == 0 || 2 * index == self.response.len() {
            1.0
        } else {
            2.0
        }
    }
}

/// What the support did.
#[derive(Default)]
struct Confinement {
    added_constant: f64,
    outside: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    const RATE: f64 = 10_000.0;
    const N: usize = 2000;
    const RADIUS: f64 = 0.98;
    const TURN: f64 = 0.2;

    /// A resonator, `x[n] = 2 r cos(t) x[n-1] - r^2 x[n-2] + F[n]`, by recursion in time. Its memory after 2000 samples is 0.98^2000 =
    /// 3e-18, so that the record holds the whole response.
    fn respond(force: &[f64]) -> Vec<f64> {
        let mut response: Vec<f64> = Vec::new();
        let past = |response: &[f64], n: usize, lag: usize| {
            n.checked_sub(lag).map_or(0.0, |earlier| response[earlier])
        };
        for (n, f) in force.iter().enumerate() {
            let x = 2.0 * RADIUS * TURN.cos() * past(&response, n, 1)
                - RADIUS * RADIUS * past(&response, n, 2)
                + f;
            response.push(x);
        }
        response
    }

    /// Its frequency response in closed form.
    fn frequency_response() -> Vec<Complex64> {
        (0..=N / 2)
            .map(|k| {
                let delay = Complex64::cis(-TAU * k as f64 / N as f64);
                1.0 / (1.0 - 2.0 * RADIUS * TURN.cos() * delay + RADIUS * RADIUS * delay * delay)
            })
            .collect()
    }

    /// Half a sine of 30 samples.
    fn half_sine() -> Vec<f64> {
        (0..N)
            .map(|n| match n {
                40..70 => 500.0 * (PI * (n as f64 - 40.0) / 30.0).sin(),
                _ => 0.0,
            })
            .collect()
    }

    /// Reproducible noise of root mean square 1: the sum of many incommensurate turns would not be white, so this is the
    /// linear congruential generator of Park and Miller, made uniform.
    fn noise(seed: u64) -> Vec<f64> {
        let mut state = seed;
        (0..N)
            .map(|_| {
                state = state * 48_271 % 2_147_483_647;
                12.0_f64.sqrt() * (state as f64 / 2_147_483_647.0 - 0.5)
            })
            .collect()
    }

    /// Line k by direct sum.
    fn direct(samples: &[f64], k: usize) -> Complex64 {
        let terms = samples.iter().enumerate();
        terms
            .map(|(n, x)| x * Complex64::cis(-TAU * (k * n % N) as f64 / N as f64))
            .sum()
    }

    fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
        let n = values.clone().count() as f64;
        (values.map(|x| x * x).sum::<f64>() / n).sqrt()
    }

    fn error(found: &ReconstructedForce, force: &[f64]) -> f64 {
        let pairs = found.history.force().iter().zip(force);
        rms(pairs.map(|(a, b)| a - b))
    }

    #[test]
    fn the_force_comes_back_from_a_clean_response() {
        let (force, h) = (half_sine(), frequency_response());
        let response = respond(&force);
        let found = Reconstruction::new(&response, RATE, &h)
            .unwrap()
            .solve()
            .unwrap();
        // rounding of 500 N through a condition number of 2500
        assert!(error(&found, &force) < 500.0 * 2500.0 * 1e-15);
        assert!(found.relative_residual < 1e-13);
        assert!(found.excluded.is_empty());
        assert_eq!(found.response_end, ResponseEnd::DiedOut);
    }

    #[test]
    fn noise_is_amplified_by_the_stated_gain() {
        let (force, h) = (half_sine(), frequency_response());
        let level = 0.7;
        for regularisation in [
            Regularisation::None,
            Regularisation::Tikhonov { lambda: 4.0 },
        ] {
            let mut squares = 0.0;
            let mut stated = 0.0;
            let n_trials = 20;
            let solve = |response: &[f64]| {
                let problem = Reconstruction::new(response, RATE, &h).unwrap();
                problem.with_regularisation(regularisation).solve().unwrap()
            };
            let clean = solve(&respond(&force));
            for seed in 1..=n_trials {
                let noisy: Vec<f64> = respond(&force)
                    .iter()
                    .zip(noise(seed * 7919))
                    .map(|(x, e)| x + level * e)
                    .collect();
                let found = solve(&noisy);
                squares += error(&found, clean.history.force()).powi(2);
                stated = found.noise_gain;
            }
            let found = (squares / n_trials as f64).sqrt() / level;
            // 20 trials of 2000 samples, coloured by the gain to no fewer than a tenth of independent ones: four times
            // 1/sqrt(2 * 4000) is 4.5 %
            assert!((found / stated - 1.0).abs() < 0.045, "{found} {stated}");
        }
    }

    #[test]
    fn regularisation_shrinks_every_line_as_stated() {
        let (force, h) = (half_sine(), frequency_response());
        let response = respond(&force);
        let lambda = 3.0;
        let found = Reconstruction::new(&response, RATE, &h)
            .unwrap()
            .with_regularisation(Regularisation::Tikhonov { lambda })
            .solve()
            .unwrap();
        // a line by direct sums, as a second method
        let k = 90;
        let shrunk = h[k].norm_sqr() / (h[k].norm_sqr() + lambda);
        let ratio = direct(found.history.force(), k) / direct(&force, k);
        // rounding of sums of 2000 terms
        assert!((ratio - shrunk).norm() < 1e-12, "{ratio} {shrunk}");
        assert!(found.relative_residual > 1e-3);
    }

    #[test]
    fn a_missing_mean_is_recovered_from_where_the_force_is_nothing() {
        let (force, mut h) = (half_sine(), frequency_response());
        let response = respond(&force);
        h[0] = Complex64::new(f64::NAN, f64::NAN); // not known, and left out: not read
        let problem = Reconstruction::new(&response, RATE, &h)
            .unwrap()
            .without_lines([0]);
        let without = problem.clone().solve().unwrap();
        let mean = force.iter().sum::<f64>() / N as f64;
        // without a support the mean is missing, no more and no less
        assert!((error(&without, &force) - mean).abs() < 1e-9);
        assert_eq!(
            without.excluded,
            [ExcludedLine {
                index: 0,
                frequency_hz: 0.0,
                reason: ExclusionReason::LeftOut
            }]
        );
        let support = TimeInterval {
            from: 0.003,
            to: 0.008,
        };
        let with = problem.acting_during(support).solve().unwrap();
        assert!((with.added_constant - mean).abs() < 1e-9);
        assert!(error(&with, &force) < 1e-9);
        assert!(with.outside_support.unwrap() < 1e-9);
    }

    #[test]
    fn a_band_keeps_its_lines_and_names_the_others() {
        let (force, h) = (half_sine(), frequency_response());
        let response = respond(&force);
        let band = FrequencyBand {
            from_hz: 0.0,
            to_hz: 1000.0,
        };
        let found = Reconstruction::new(&response, RATE, &h)
            .unwrap()
            .within(band)
            .solve()
            .unwrap();
        // lines are 5 Hz apart, 0..=200 are in
        assert_eq!(found.excluded.len(), 800);
        assert_eq!(found.excluded[0].index, 201);
        assert!(
            found
                .excluded
                .iter()
                .all(|line| line.reason == ExclusionReason::OutsideBand)
        );
        // what is lost is the energy of the force's lines above the band, here by direct sums
        let lost: f64 = (201..=N / 2)
            .map(|k| direct(&force, k).norm_sqr() * if k == N / 2 { 1.0 } else { 2.0 })
            .sum();
        let expected = lost.sqrt() / N as f64;
        // 3 N of error against rounding of 1e-9 N
        assert!((error(&found, &force) / expected - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_record_that_ends_too_early_is_flagged() {
        let force = half_sine();
        let cut = &respond(&force)[..200];
        let h = frequency_response();
        let h: Vec<Complex64> = h.iter().step_by(10).copied().collect();
        let found = Reconstruction::new(cut, RATE, &h).unwrap().solve().unwrap();
        assert!(
            matches!(found.response_end, ResponseEnd::CutOff { relative_level } if relative_level > 0.01)
        );
    }

    #[test]
    fn bad_requests_are_refused_with_the_place() {
        let mut h = frequency_response();
        let response = vec![1.0; N];
        let solve = |problem: Reconstruction<'_>| problem.solve().unwrap_err().to_string();
        let problem = Reconstruction::new(&response, RATE, &h).unwrap();
        let band = |from_hz, to_hz| FrequencyBand { from_hz, to_hz };
        let refusals = [
            solve(problem.clone().within(band(20.0, 10.0))),
            solve(problem.clone().within(band(1.0, 2.0))),
            solve(problem.clone().without_lines([1001])),
            solve(
                problem
                    .clone()
                    .with_regularisation(Regularisation::Tikhonov { lambda: -1.0 }),
            ),
            solve(problem.acting_during(TimeInterval { from: 1.0, to: 2.0 })),
        ];
        assert_eq!(
            refusals,
            [
                "the frequency band [Hz] runs from 20 to 10, expected finite and increasing limits",
                "none of the 1001 lines can be used",
                "line 1001 is to be left out, but there are only 1001 lines",
                "regularisation parameter [unit of |H|^2] is -1, expected a finite value above 0",
                "the support from 1 s to 2 s holds no sample of the response",
            ]
        );
        h[5] = f64::NAN.into();
        let problem = Reconstruction::new(&response, RATE, &h).unwrap();
        assert_eq!(
            solve(problem),
            "element 5 of the frequency response is not finite"
        );
        assert!(Reconstruction::new(&response, RATE, &h[1..]).is_err());
        assert!(Reconstruction::new(&response, f64::INFINITY, &h).is_err());
    }
}
