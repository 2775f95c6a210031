//! The impulse response obtained from a measured frequency response, and its acausal part.
//!
//! Theory: `docs/theory/spectra.md#conversion-and-checks-of-responses`.

use num_complex::Complex64;

use crate::dft;
use crate::error::{check_samples, count_mismatch};
use crate::{AddedDamping, Channel, FrequencyResponse, LabioError};

/// Impulse response $`h(t_n) = \frac{1}{N\Delta t}\sum_k H_k e^{2\pi i kn/N}`$, with the sum over
/// the two-sided spectrum: the response to a unit impulse \[unit of the response / s\], at N lags.
///
/// The lags are periodic in N samples. Lags up to $`(N-1)/2`$ count as times after the impulse; the
/// others are times *before* it or, if the body still rings after half the record, late times that
/// are wrapped around. The response of a body is causal: values before the impulse are caused by
/// noise, leakage, a delay between the channels, or wrapped ringing.
///
/// The lines at 0 Hz and at the Nyquist frequency occur once, and only their real parts are used. A
/// mobility converted from an accelerance has an imaginary line at the Nyquist frequency, which
/// real samples cannot represent.
#[derive(Debug, Clone)]
pub struct ImpulseResponse {
    input: Channel,
    output: Channel,
    sampling_rate_hz: f64,
    added_damping: Option<AddedDamping>,
    values: Vec<f64>,
}

impl FrequencyResponse {
    /// Returns the impulse response at as many lags as the hits had samples.
    ///
    /// Under an exponential window it is $`h(t)e^{-\sigma t}`$; see
    /// [`ImpulseResponse::without_added_damping`].
    ///
    /// # Errors
    ///
    /// [`LabioError::MissingLines`] if a line contains no information: any value for it would be
    /// arbitrary. [`LabioError::CountMismatch`] if the lists of the response differ in length, or
    /// if the number of lines does not match the number of samples.
    pub fn impulse_response(&self) -> Result<ImpulseResponse, LabioError> {
        self.check_lengths()?;
        self.check_complete("an impulse response")?;
        let n_lines = self.n_samples / 2 + 1;
        let (Some(spacing_hz), true) = (self.frequency_hz.get(1), self.values.len() == n_lines)
        else {
            return count_mismatch(
                "lines of the frequency response",
                self.values.len(),
                n_lines.max(2),
            );
        };
        let sampling_rate_hz = spacing_hz * self.n_samples as f64;
        let mut values = dft::inverse(&self.values, self.n_samples);
        for value in &mut values {
            *value *= sampling_rate_hz;
        }
        check_samples("impulse response", &values)?;
        Ok(ImpulseResponse {
            input: self.input.clone(),
            output: self.output.clone(),
            sampling_rate_hz,
            added_damping: self.added_damping,
            values,
        })
    }
}

impl ImpulseResponse {
    /// The channel of the impulse.
    #[must_use]
    pub fn input(&self) -> &Channel {
        &self.input
    }

    /// The channel of the response.
    #[must_use]
    pub fn output(&self) -> &Channel {
        &self.output
    }

    /// Sampling rate \[Hz\].
    #[must_use]
    pub fn sampling_rate_hz(&self) -> f64 {
        self.sampling_rate_hz
    }

    /// The exponential window still contained in the values, if any.
    #[must_use]
    pub fn added_damping(&self) -> Option<AddedDamping> {
        self.added_damping
    }

    /// Values at all N lags; the lags before the impulse are at the end.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Values at the lags 0, 1, ... that count as times after the impulse.
    #[must_use]
    pub fn causal_values(&self) -> &[f64] {
        self.halves().0
    }

    /// Fraction of the energy at lags before the impulse, $`\sum_{t<0}h^2/\sum h^2`$: 0 for a
    /// causal response that decays within half a record, 1/2 for noise. (With an even number of
    /// samples, the ambiguous lag of half a record counts as before the impulse.)
    #[must_use]
    pub fn acausal_part(&self) -> f64 {
        // relative to the largest value, so that no square overflows or underflows
        let largest = self.values.iter().fold(0.0_f64, |top, h| top.max(h.abs()));
        if largest == 0.0 {
            return 0.0;
        }
        let energy = |values: &[f64]| values.iter().map(|h| (h / largest).powi(2)).sum::<f64>();
        let (after, before) = self.halves();
        let (after, before) = (energy(after), energy(before));
        if before > 0.0 {
            before / (before + after)
        } else {
            0.0
        }
    }

    /// Returns the response with zeros at the lags before the impulse.
    #[must_use]
    pub fn causal(&self) -> Self {
        let mut causal = self.clone();
        for value in causal.values.iter_mut().skip(self.n_causal()) {
            *value = 0.0;
        }
        causal
    }

    /// Returns the response without the exponential window: each value is multiplied by
    /// $`e^{\sigma t}`$ with its lag t, which is negative before the impulse. Without a window, the
    /// response is unchanged.
    ///
    /// # Validity
    ///
    /// Exact for a body whose response under the window decays within half a record. Noise is
    /// amplified increasingly with the lag, by the factor [`ImpulseResponse::noise_growth`] at the
    /// last lag.
    #[must_use]
    pub fn without_added_damping(&self) -> Self {
        let Some(window) = self.added_damping else {
            return self.clone();
        };
        let n_causal = self.n_causal();
        let n = self.values.len();
        let mut free = self.clone();
        free.added_damping = None;
        for (index, value) in free.values.iter_mut().enumerate() {
            let lag = if index < n_causal {
                index as f64
            } else {
                -((n - index) as f64)
            };
            *value *= (window.decay_rate() * lag / self.sampling_rate_hz).exp();
        }
        free
    }

    /// Factor $`e^{\sigma t}`$ by which removing the exponential window multiplies the value at the
    /// last lag; 1 without a window.
    #[must_use]
    pub fn noise_growth(&self) -> f64 {
        let last = (self.n_causal() - 1) as f64 / self.sampling_rate_hz;
        self.added_damping
            .map_or(1.0, |window| (window.decay_rate() * last).exp())
    }

    /// Returns the frequency response of these values, $`H_k = \Delta t\sum_n h_n e^{-2\pi i
    /// kn/N}`$ for the lines from 0 Hz; `(N/2 + 1)`.
    #[must_use]
    pub fn lines(&self) -> Vec<Complex64> {
        let mut lines = dft::forward(&self.values);
        for line in &mut lines {
            *line /= self.sampling_rate_hz;
        }
        lines
    }

    fn n_causal(&self) -> usize {
        self.values.len().div_ceil(2)
    }

    /// Returns the values at the lags after the impulse, and those at the lags before it.
    fn halves(&self) -> (&[f64], &[f64]) {
        self.values.split_at(self.n_causal())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Provenance, Quantity, Record, ResponseKind, SpectrumAverager, Window};
    use ndarray::Array2;

    const RATE: f64 = 1000.0;

    /// Two decaying modes: the impulse response is the sum of the imaginary parts of powers of
    /// these numbers.
    fn modes() -> [(f64, Complex64); 2] {
        [
            (3.0, Complex64::new(-60.0, 700.0)),
            (-1.0, Complex64::new(-90.0, 1500.0)),
        ]
    }

    fn exact(n: usize) -> f64 {
        let t = n as f64 / RATE;
        modes()
            .iter()
            .map(|(amplitude, pole)| amplitude * ((pole * t).exp()).im)
            .sum()
    }

    /// Returns an averager and a hit: the response to a unit impulse (one sample of force 1/dt) at
    /// sample `at`.
    fn averager(n: usize, at: usize) -> (SpectrumAverager, Record) {
        let channels = vec![
            Channel::new("force", Quantity::Force).unwrap(),
            Channel::new("velocity", Quantity::Velocity).unwrap(),
        ];
        let mut samples = Array2::zeros((2, n));
        samples[(0, at)] = RATE;
        for i in at..n {
            samples[(1, i)] = exact(i - at);
        }
        let hit = Record::new(
            samples,
            RATE,
            0.0,
            channels.clone(),
            Provenance::computed("two modes"),
        )
        .unwrap();
        let averager = SpectrumAverager::new(&channels, n, RATE, Window::Rectangular).unwrap();
        (averager, hit)
    }

    fn response(n: usize, at: usize) -> FrequencyResponse {
        let (mut averager, hit) = averager(n, at);
        averager.add(&hit).unwrap();
        averager.spectra().unwrap().h1("force", "velocity").unwrap()
    }

    #[test]
    fn the_history_of_two_modes_is_found_for_even_and_odd_lengths() {
        for n in [600, 601] {
            let response = response(n, 0);
            let impulse = response.impulse_response().unwrap();
            for (i, value) in impulse.values().iter().enumerate() {
                assert!((value - exact(i)).abs() < 1e-13); // two transforms of numbers of order one
            }
            // relative energy after half the record: e^{-60·0.3·2}
            assert!(impulse.acausal_part() < 1e-14);
            for (there, back) in response.values.iter().zip(impulse.lines()) {
                assert!((there - back).norm() < 1e-15);
            }
        }
    }

    #[test]
    fn what_comes_before_its_cause_is_measured_and_cut() {
        let mut late = response(600, 0);
        // the input is late by 20 samples: the body seems to respond before it is hit
        for (line, value) in late.values.iter_mut().enumerate() {
            let angle = std::f64::consts::TAU * (line * 20) as f64 / 600.0;
            *value *= Complex64::cis(angle);
        }
        let impulse = late.impulse_response().unwrap();
        // a claim compares this fraction with the energy of the first 20 samples
        assert!(impulse.acausal_part() > 0.0);
        let causal = impulse.causal();
        assert!(causal.acausal_part() <= 0.0);
        assert_eq!(causal.causal_values(), impulse.causal_values());
        assert_eq!(causal.causal_values().len(), 300);
    }

    #[test]
    fn an_exponential_window_is_taken_off_exactly() {
        let window = AddedDamping::new(40.0).unwrap();
        for at in [0, 7] {
            let (averager, hit) = averager(400, at);
            let mut averager = averager.with_exponential_window(window).unwrap();
            averager.add(&hit).unwrap();
            let response = averager.spectra().unwrap().h1("force", "velocity").unwrap();
            let impulse = response.impulse_response().unwrap();
            // the response is H(sigma + i omega) for an impulse at any sample of the record
            let damped = |i: usize| exact(i) * (-40.0 * i as f64 / RATE).exp();
            let free = impulse.without_added_damping();
            for i in 0..200 {
                assert!((impulse.values()[i] - damped(i)).abs() < 1e-13);
                // rounding errors times the growth of noise
                assert!((free.values()[i] - exact(i)).abs() < 1e-13 * impulse.noise_growth());
            }
            assert!((impulse.noise_growth() / (40.0_f64 * 0.199).exp() - 1.0).abs() < 1e-14);
            assert!(free.added_damping().is_none());
        }
    }

    #[test]
    fn a_missing_line_is_an_error_and_not_a_zero() {
        let receptance = response(600, 0).to_kind(ResponseKind::Receptance).unwrap();
        assert_eq!(
            receptance.impulse_response().unwrap_err().to_string(),
            "an impulse response needs every line, but 1 carry no information, the first at 0 Hz"
        );
    }
}
