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
        let (after, before) = self.values.split_at(self.n_causal());
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Quantity, ResponseKind};

    /// A mobility of 301 lines whose impulse response has its peak 20 samples of 1 ms before the
    /// impulse.
    fn late() -> FrequencyResponse {
        let force = Channel::new("force", Quantity::Force).unwrap();
        let velocity = Channel::new("velocity", Quantity::Velocity).unwrap();
        let angle = |line: u32| std::f64::consts::TAU * f64::from(line * 20) / 600.0;
        let values = (0..301).map(|line| Complex64::new(0.5, 0.0) + Complex64::cis(angle(line)));
        FrequencyResponse::of_lines(force, velocity, 1.0 / 0.6, values.collect()).unwrap()
    }

    #[test]
    fn what_comes_before_its_cause_is_cut() {
        let impulse = late().impulse_response().unwrap();
        assert!(impulse.acausal_part() > 0.0);
        let causal = impulse.causal();
        assert!(causal.acausal_part() <= 0.0);
        assert_eq!(causal.values()[..300], impulse.values()[..300]);
    }

    #[test]
    fn a_missing_line_is_an_error_and_not_a_zero() {
        let receptance = late().to_kind(ResponseKind::Receptance).unwrap();
        assert_eq!(
            receptance.impulse_response().unwrap_err().to_string(),
            "an impulse response needs every line, but 1 carry no information, the first at 0 Hz"
        );
    }
}
