//! Histories of the waves in a bar with a free end, from the strain at one gauge.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::RodwaveError;
use crate::error::{
    check_finite, check_length, check_not_negative, check_positive, check_samples, check_that,
};
use crate::fourier::RealFourier;

/// Frequencies between which the spectrum of the waves is reduced to 0, as multiples of the highest
/// frequency of the propagation coefficients.
const FALLS: [f64; 2] = [0.75, 1.25];
/// Smallest ratio of the length of a transform to the length of its record. With this ratio, waves
/// that leave the record at one end when they are propagated do not re-enter it at the other end.
const LONGER: usize = 4;
/// Largest number of samples of a record, whose transforms take some gibibytes.
const MOST_SAMPLES: usize = 1 << 26;
/// Periods of the highest frequency over which the band limit spreads the step at the end of a
/// record.
const PERIODS: f64 = 2.0;

/// Waves in a uniform bar with a free end, whose propagation coefficient γ is known on some lines.
///
/// The strain at the distance d from a free end is the wave P towards the end minus its reflection,
///
/// ```text
/// ε̂(d) = P̂ (1 - e^{-2γd}) ,    P̂ = ε̂ Σₙ e^{-2nγd} ,    n = 0 … N ,
/// ```
///
/// where the N passages of a wave are those within the record. The wave P contains all waves that
/// come from the struck end, so that pulses may overlap. At the distance x from the end, the two
/// waves ([`TravellingWaves`](super::TravellingWaves)) are P̂ e^{-γ(d-x)} and -P̂ e^{-γ(d+x)}.
///
/// # Validity
///
/// Between the lines γ/f is interpolated linearly, and outside them it is that of the nearest line.
/// A raised cosine ends the band, from 0.75 to 1.25 of the highest line. The record must begin at
/// rest.
///
/// ```
/// use num_complex::Complex64;
/// use rodwave::waves::FreeEndWaves;
///
/// // an elastic bar, c = 2000 m/s, with a gauge 0.5 m from the end: a pulse that is still passing
/// // when its reflection arrives 0.5 ms later
/// let omega = |f: f64| 2.0 * std::f64::consts::PI * f;
/// let lines = [100.0, 20e3];
/// let gamma = lines.map(|f| Complex64::new(0.0, omega(f) / 2000.0));
/// let pulse = |t: f64| (-(t - 2e-3_f64).powi(2) / (2.0 * 1e-4_f64.powi(2))).exp();
/// let time = |n: i32| f64::from(n) / 200e3;
/// let strain: Vec<f64> = (0..2000).map(|n| pulse(time(n)) - pulse(time(n) - 0.5e-3)).collect();
/// let mut bar = FreeEndWaves::new(&lines, &gamma, strain.len(), 200e3)?;
/// let incident = bar.incident(&strain, 0.5)?;
/// let at_end = bar.waves_at(&incident, 0.0)?;
/// // 450 samples, 2.25 ms: the peak of the pulse at the end
/// assert!((at_end.towards_end[450] - 1.0).abs() < 1e-6 && (at_end.from_end[450] + 1.0).abs() < 1e-6);
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone)]
pub struct FreeEndWaves {
    transform: RealFourier,
    n_samples: usize,
    rate_hz: f64,
    /// Highest frequency of the propagation coefficients \[Hz\].
    highest_hz: f64,
    /// Lowest phase velocity of the lines [m/s].
    slowest: f64,
    /// Propagation coefficient and weight on each line of the transform.
    gamma: Vec<Complex64>,
    weight: Vec<f64>,
}

/// Wave towards the free end at a gauge.
#[derive(Debug, Clone)]
pub struct IncidentWave {
    /// Spectrum, limited to the band.
    lines: Vec<Complex64>,
    /// Distance of the gauge from the end \[m\].
    distance: f64,
}

/// Histories of the two waves at one place; `(n_samples)`.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PlaceWaves {
    /// Wave towards the free end.
    pub towards_end: Vec<f64>,
    /// Time \[s\] from the beginning of the record up to which the wave towards the end is known: a
    /// later wave reaches the gauge after the end of the record.
    pub known_until: f64,
    /// Wave from the free end.
    pub from_end: Vec<f64>,
}

impl FreeEndWaves {
    /// Prepares the waves for records of `n_samples` at `rate_hz` \[Hz\], in a bar with the
    /// propagation coefficients `gamma` [1/m] at the increasing frequencies `frequency_hz` \[Hz\].
    /// Measured coefficients may have a negative real part within their errors.
    ///
    /// | argument | shape |
    /// |---|---|
    /// | `frequency_hz`, `gamma` | `(n_lines)` |
    ///
    /// # Errors
    /// [`RodwaveError::TooFewSamples`] without a line, [`RodwaveError::LengthMismatch`],
    /// [`RodwaveError::NonPhysical`] for records without a sample or of more than 2^26, a rate or a
    /// frequency that is not above 0, a frequency that is not above the previous one, and a
    /// coefficient that is not finite or whose imaginary part is not above 0.
    pub fn new(
        frequency_hz: &[f64],
        gamma: &[Complex64],
        n_samples: usize,
        rate_hz: f64,
    ) -> Result<Self, RodwaveError> {
        check_positive("sampling rate [Hz]", rate_hz)?;
        check_length(
            "the list of propagation coefficients",
            gamma.len(),
            frequency_hz.len(),
        )?;
        check_that(
            (1..=MOST_SAMPLES).contains(&n_samples),
            "number of samples of a record",
            n_samples as f64,
            "from 1 to 2^26",
        )?;
        let mut below = 0.0;
        let mut slowest = f64::INFINITY;
        // γ/f on the lines
        let mut lines = Vec::with_capacity(gamma.len());
        for (f, gamma) in frequency_hz.iter().zip(gamma) {
            check_positive("frequency of a propagation coefficient [Hz]", *f)?;
            check_that(
                *f > below,
                "frequency of a propagation coefficient [Hz]",
                *f,
                "more than that of the previous line",
            )?;
            check_finite("damping coefficient [1/m]", gamma.re)?;
            check_positive("wave number [rad/m]", gamma.im)?;
            below = *f;
            slowest = slowest.min(TAU * f / gamma.im);
            lines.push((*f, gamma / f));
        }
        let (Some(first), Some(last)) = (lines.first(), lines.last()) else {
            return Err(RodwaveError::TooFewSamples {
                history: "the list of propagation coefficients",
                found: 0,
                expected: 1,
            });
        };
        let highest_hz = last.0;
        let n_transform = (LONGER * n_samples).next_power_of_two();
        let frequency = |line: usize| line as f64 * rate_hz / n_transform as f64;
        let at = |line: usize| {
            let f = frequency(line);
            let after = lines.partition_point(|(of_line, _)| *of_line < f);
            let below = after.checked_sub(1).and_then(|below| lines.get(below));
            match (below, lines.get(after)) {
                (Some(below), Some(above)) => {
                    let part = (f - below.0) / (above.0 - below.0);
                    f * (below.1 * (1.0 - part) + above.1 * part)
                }
                (None, _) => f * first.1,
                (_, None) => f * last.1,
            }
        };
        let weight = |line: usize| {
            let [from, to] = FALLS;
            let place = ((frequency(line) / highest_hz - from) / (to - from)).clamp(0.0, 1.0);
            0.5 * (1.0 + (PI * place).cos())
        };
        let n_lines = n_transform / 2 + 1;
        Ok(Self {
            transform: RealFourier::new(n_transform),
            n_samples,
            rate_hz,
            highest_hz,
            slowest,
            gamma: (0..n_lines).map(at).collect(),
            weight: (0..n_lines).map(weight).collect(),
        })
    }

    /// Returns the wave towards the end at a gauge at the `distance` d \[m\] from the end, from the
    /// complete record of its `strain`.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the distance is above 0,
    /// [`RodwaveError::LengthMismatch`] and [`RodwaveError::NonFiniteSample`] for the record.
    pub fn incident(
        &mut self,
        strain: &[f64],
        distance: f64,
    ) -> Result<IncidentWave, RodwaveError> {
        check_positive("distance of a gauge from the free end [m]", distance)?;
        let mut lines = self.spectrum(strain)?;
        let passages = (self.duration() * self.slowest / (2.0 * distance)).ceil();
        for (line, gamma) in lines.iter_mut().zip(&self.gamma) {
            let once = 2.0 * distance * gamma;
            *line *= if once == Complex64::ZERO {
                passages.into()
            } else {
                one_minus_decay(once * passages) / one_minus_decay(once)
            };
        }
        // after the end of the record, the wave is wrong because later reflections are missing: the
        // history is cut there
        let along = self.history(&lines, |_| Complex64::ONE)?;
        let lines = self.transformed(&along);
        Ok(IncidentWave { lines, distance })
    }

    /// Returns the wave towards the end from `pulse`, its record at a gauge at the `distance` \[m\]
    /// from the end. The record must contain the whole pulse and no reflection.
    ///
    /// # Errors
    /// The errors of [`Self::incident`]; the distance may be 0.
    pub fn incident_pulse(
        &mut self,
        pulse: &[f64],
        distance: f64,
    ) -> Result<IncidentWave, RodwaveError> {
        check_not_negative("distance of a gauge from the free end [m]", distance)?;
        let lines = self.spectrum(pulse)?;
        Ok(IncidentWave { lines, distance })
    }

    /// Returns the waves at the distance `from_end` \[m\] from the free end. Beyond the gauge, the
    /// wave towards the end is traced back, which amplifies it. Both waves are limited to the band
    /// once more.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] for a negative distance, [`RodwaveError::NonFiniteSample`] if
    /// a wave that is traced back overflows.
    pub fn waves_at(
        &mut self,
        wave: &IncidentWave,
        from_end: f64,
    ) -> Result<PlaceWaves, RodwaveError> {
        check_not_negative("distance from the free end [m]", from_end)?;
        let lines: Vec<Complex64> = self.weighted(&wave.lines);
        let (way, back) = (wave.distance - from_end, wave.distance + from_end);
        let towards_end = self.history(&lines, |gamma| (-gamma * way).exp())?;
        let from_end = self.history(&lines, |gamma| -(-gamma * back).exp())?;
        let missing = (-way).max(0.0) / self.slowest + PERIODS / self.highest_hz;
        Ok(PlaceWaves {
            towards_end,
            known_until: self.duration() - missing,
            from_end,
        })
    }

    /// Returns the strain at the distance `from_end` \[m\] from the free end, the sum of both waves;
    /// `(n_samples)`.
    ///
    /// # Errors
    /// The errors of [`Self::waves_at`].
    pub fn strain_at(
        &mut self,
        wave: &IncidentWave,
        from_end: f64,
    ) -> Result<Vec<f64>, RodwaveError> {
        check_not_negative("distance from the free end [m]", from_end)?;
        let (way, back) = (wave.distance - from_end, wave.distance + from_end);
        self.history(&wave.lines, |gamma| {
            (-gamma * way).exp() - (-gamma * back).exp()
        })
    }

    /// Returns a record in the band of the waves.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] and [`RodwaveError::NonFiniteSample`] for the record.
    pub fn in_band(&mut self, record: &[f64]) -> Result<Vec<f64>, RodwaveError> {
        let lines = self.spectrum(record)?;
        self.history(&lines, |_| Complex64::ONE)
    }

    fn duration(&self) -> f64 {
        self.n_samples as f64 / self.rate_hz
    }

    /// Returns the spectrum of a record, limited to the band.
    fn spectrum(&mut self, record: &[f64]) -> Result<Vec<Complex64>, RodwaveError> {
        check_length("the record of a gauge", record.len(), self.n_samples)?;
        check_samples("the record of a gauge", record)?;
        let lines = self.transformed(record);
        Ok(self.weighted(&lines))
    }

    fn transformed(&mut self, record: &[f64]) -> Vec<Complex64> {
        self.transform.samples().fill(0.0);
        for (to, from) in self.transform.samples().iter_mut().zip(record) {
            *to = *from;
        }
        self.transform.forward().to_vec()
    }

    fn weighted(&self, lines: &[Complex64]) -> Vec<Complex64> {
        let weighted = lines.iter().zip(&self.weight);
        weighted.map(|(line, weight)| line * weight).collect()
    }

    /// Returns a history from its lines, each multiplied by a function of γ.
    fn history(
        &mut self,
        lines: &[Complex64],
        of: impl Fn(Complex64) -> Complex64,
    ) -> Result<Vec<f64>, RodwaveError> {
        let factors = self.gamma.iter().map(|gamma| of(*gamma));
        for ((to, from), factor) in self.transform.lines().iter_mut().zip(lines).zip(factors) {
            *to = from * factor;
        }
        let scale = 1.0 / self.transform.samples().len() as f64;
        let samples = self.transform.inverse().iter().take(self.n_samples);
        let history: Vec<f64> = samples.map(|x| scale * x).collect();
        check_samples("a wave in the bar", &history)?;
        Ok(history)
    }
}

/// Returns 1 - e^{-z}, without the loss of digits near z = 0.
fn one_minus_decay(z: Complex64) -> Complex64 {
    let half = (0.5 * z.im).sin();
    Complex64::new(
        2.0 * half * half - (-z.re).exp_m1() * z.im.cos(),
        (-z.re).exp() * z.im.sin(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 200e3;
    const SPEED: f64 = 2000.0;
    const N: usize = 2000;

    fn gamma(f: f64) -> Complex64 {
        Complex64::new(0.0, TAU * f / SPEED)
    }

    /// Two Gaussian pulses of 0.1 ms, 0.4 ms apart; the reflection of the first arrives during the
    /// second.
    fn pulses(time: f64) -> f64 {
        let pulse = |at: f64| (-0.5 * ((time - at) / 1e-4).powi(2)).exp();
        pulse(2e-3) - 0.5 * pulse(2.4e-3)
    }

    fn history(of: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..N).map(|n| of(n as f64 / RATE_HZ)).collect()
    }

    #[test]
    fn elastic_waves_are_those_of_dalembert() {
        // the spacing of the lines is uneven, and γ/f is the same on all
        let frequency_hz = [300.0, 700.0, 20e3];
        let gamma = frequency_hz.map(gamma);
        let mut bar = FreeEndWaves::new(&frequency_hz, &gamma, N, RATE_HZ).unwrap();
        // the second gauge is so near the end that waves pass it 2000 times within the record
        for distance in [0.5, 0.005] {
            let late = 2.0 * distance / SPEED;
            let strain = history(|t| pulses(t) - pulses(t - late));
            let wave = bar.incident(&strain, distance).unwrap();
            for from_end in [0.0, 0.3, 1.7] {
                let waves = bar.waves_at(&wave, from_end).unwrap();
                let (way, back) = (distance - from_end, distance + from_end);
                let sum = bar.strain_at(&wave, from_end).unwrap();
                let known = RATE_HZ * waves.known_until;
                let until = 10e-3 - (-way).max(0.0) / SPEED - 2.0 / 20e3;
                assert!((waves.known_until - until).abs() < 1e-12);
                for n in (0..N).filter(|n| (*n as f64) < known) {
                    let at = |way: f64| pulses(n as f64 / RATE_HZ - way / SPEED);
                    // tolerance: rounding only, because the spectrum of the pulses is e^{-44} where
                    // the weight of the band begins to decrease; at a gauge near the end, the
                    // strain is a small difference of two waves
                    let tolerance = 1e-14 * (1.0 + 1.0 / distance);
                    assert!((waves.towards_end[n] - at(way)).abs() < tolerance, "{n}");
                    assert!((waves.from_end[n] + at(back)).abs() < tolerance, "{n}");
                    assert!((sum[n] - at(way) + at(back)).abs() < 2.0 * tolerance, "{n}");
                }
            }
        }
    }

    #[test]
    fn a_pulse_that_was_cut_out_returns_with_the_other_sign() {
        let lines = [100.0, 20e3];
        let mut bar = FreeEndWaves::new(&lines, &lines.map(gamma), N, RATE_HZ).unwrap();
        let pulse = history(pulses);
        let wave = bar.incident_pulse(&pulse, 1.0).unwrap();
        let strain = bar.strain_at(&wave, 1.0).unwrap();
        let expected = history(|t| pulses(t) - pulses(t - 1e-3));
        let in_band = bar.in_band(&expected).unwrap();
        // tolerance: rounding
        for (found, (expected, in_band)) in strain.iter().zip(expected.iter().zip(in_band)) {
            assert!((found - expected).abs() < 3e-14 && (in_band - expected).abs() < 3e-14);
        }
    }

    #[test]
    fn wrong_lines_records_and_places_are_refused() {
        let lines = [100.0, 200.0];
        let good = lines.map(gamma);
        let refused = |lines: &[f64], gamma: &[Complex64], n: usize, rate: f64| {
            let made = FreeEndWaves::new(lines, gamma, n, rate);
            made.unwrap_err().to_string()
        };
        for (found, expected) in [
            (
                refused(&[], &[], N, RATE_HZ),
                "the list of propagation coefficients has 0 samples, expected at least 1",
            ),
            (
                refused(&lines, &good, 0, RATE_HZ),
                "number of samples of a record is 0, expected from 1 to 2^26",
            ),
            (
                refused(&lines, &good, usize::MAX, RATE_HZ),
                "number of samples of a record is 18446744073709552000, expected from 1 to 2^26",
            ),
            (
                refused(&lines, &good[..1], N, RATE_HZ),
                "the list of propagation coefficients has 1 entries, expected 2",
            ),
            (
                refused(&[200.0, 100.0], &good, N, RATE_HZ),
                "frequency of a propagation coefficient [Hz] is 100, expected more than that of the previous line",
            ),
            (
                refused(&lines, &[good[0], Complex64::new(f64::NAN, 1.0)], N, 1.0),
                "damping coefficient [1/m] is NaN, expected a finite value",
            ),
            (
                refused(&lines, &[good[0], -good[1]], N, RATE_HZ),
                "wave number [rad/m] is -0.6283185307179586, expected a finite value above 0",
            ),
            (
                refused(&lines, &good, N, f64::NAN),
                "sampling rate [Hz] is NaN, expected a finite value above 0",
            ),
        ] {
            assert_eq!(found, expected);
        }
        // one line is enough
        let mut bar = FreeEndWaves::new(&lines[1..], &good[1..], N, RATE_HZ).unwrap();
        assert!(bar.incident(&[0.0; N - 1], 1.0).is_err());
        assert!(bar.incident(&[f64::NAN; N], 1.0).is_err());
        assert!(bar.incident(&[0.0; N], 0.0).is_err());
        let wave = bar.incident(&[0.0; N], 1.0).unwrap();
        assert!(bar.waves_at(&wave, -1.0).is_err());
        assert!(bar.strain_at(&wave, f64::NAN).is_err());
    }

    #[test]
    fn small_decays_keep_their_digits() {
        let z = Complex64::new(1e-9, 2e-9);
        // the first two terms of the series
        let expected = z - 0.5 * z * z;
        assert!((one_minus_decay(z) - expected).norm() < 1e-15 * z.norm());
        let z = Complex64::new(0.7, 2.0);
        assert!((one_minus_decay(z) - (1.0 - (-z).exp())).norm() < 1e-15);
    }
}
