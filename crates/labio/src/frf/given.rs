//! Responses that do not come from spectra: read from a file, or computed.

use num_complex::Complex64;

use super::{Estimator, FrequencyResponse, LineValidity};
use crate::error::{
    check_count, check_finite, check_positive, count_mismatch, non_physical, too_few_averages,
};
use crate::{Channel, LabioError, known_part};

/// Fewest lines that a response may have.
const FEWEST_LINES: usize = 3;

impl FrequencyResponse {
    /// Creates a response from `values` \[unit of output / unit of input\] on the lines
    /// $`k\,\Delta f`$ from 0 Hz. The response corresponds to $`2(L-1)`$ samples for L lines,
    /// counts as a single average and has no errors yet. A non-finite value marks a line without
    /// information ([`LineValidity::NotDefined`]), for example a mobility at 0 Hz.
    ///
    /// # Examples
    ///
    /// ```
    /// use labio::{Channel, FrequencyResponse, Quantity, ResponseKind};
    /// use num_complex::Complex64;
    ///
    /// // accelerance of 0.5 kg
    /// let (force, face) = (Channel::new("force", Quantity::Force)?, Channel::new("face", Quantity::Acceleration)?);
    /// let mass = FrequencyResponse::of_lines(force, face, 10.0, vec![Complex64::from(2.0); 5])?;
    /// let mobility = mass.to_kind(ResponseKind::Mobility)?;
    /// assert!((mobility.values[1].im + 2.0 / (2.0 * std::f64::consts::PI * 10.0)).abs() < 1e-15);
    /// # Ok::<(), labio::LabioError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for a spacing that is not above 0 or makes the highest line
    /// infinite, [`LabioError::CountMismatch`] for fewer than three lines.
    pub fn of_lines(
        input: Channel,
        output: Channel,
        line_spacing_hz: f64,
        values: Vec<Complex64>,
    ) -> Result<Self, LabioError> {
        check_positive("line spacing [Hz]", line_spacing_hz)?;
        if values.len() < FEWEST_LINES {
            return count_mismatch("lines of a frequency response", values.len(), FEWEST_LINES);
        }
        check_finite(
            "highest line of a frequency response [Hz]",
            (values.len() - 1) as f64 * line_spacing_hz,
        )?;
        let validity: Vec<LineValidity> = values
            .iter()
            .map(|value| {
                if value.is_finite() {
                    LineValidity::Valid
                } else {
                    LineValidity::NotDefined
                }
            })
            .collect();
        let nothing = Complex64::new(f64::NAN, f64::NAN);
        Ok(Self {
            estimator: Estimator::H1,
            input,
            output,
            n_averages: 1,
            effective_averages: 1.0,
            n_samples: 2 * (values.len() - 1),
            added_damping: None,
            frequency_hz: (0..values.len())
                .map(|line| line as f64 * line_spacing_hz)
                .collect(),
            values: values
                .into_iter()
                .map(|value| if value.is_finite() { value } else { nothing })
                .collect(),
            coherence: None,
            variance: None,
            degrees_of_freedom: None,
            noise_bias: None,
            possible_bias: None,
            common_error: None,
            validity,
        })
    }

    /// Sets the ordinary coherence of `n_averages` independent hits; the variance becomes $`\lvert
    /// H\rvert^2(1-\gamma^2)/((n-1)\gamma^2)`$ with 2(n-1) degrees of freedom. Entries of lines
    /// without information are ignored.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`]; [`LabioError::TooFewAverages`] for fewer than two hits;
    /// [`LabioError::NonPhysical`] for a coherence that is not above 0 and at most 1.
    pub fn with_coherence(
        mut self,
        coherence: Vec<f64>,
        n_averages: usize,
    ) -> Result<Self, LabioError> {
        self.check_lines("lines of the validity", self.validity.len())?;
        self.check_lines("lines of the coherence", coherence.len())?;
        if n_averages < 2 {
            return too_few_averages("a variance from the coherence", n_averages, 2);
        }
        let mut coherence = coherence;
        let mut variance = vec![f64::NAN; coherence.len()];
        let lines = self.values.iter().zip(&self.validity);
        for ((value, validity), (c, slot)) in lines.zip(coherence.iter_mut().zip(&mut variance)) {
            if *validity != LineValidity::Valid {
                *c = f64::NAN;
                continue;
            }
            if !(*c > 0.0 && *c <= 1.0) {
                return non_physical("coherence [-]", *c, "a number above 0 and at most 1");
            }
            *slot = check_finite(
                "variance of a line",
                value.norm_sqr() * (1.0 - *c) / ((n_averages - 1) as f64 * *c),
            )?;
        }
        self.n_averages = n_averages;
        self.effective_averages = n_averages as f64;
        self.coherence = Some(coherence);
        self.possible_bias = self.bias_by_coherence();
        self.variance = Some(variance);
        let freedom = 2.0 * (n_averages - 1) as f64;
        let freedom = vec![freedom; self.values.len()];
        self.with_degrees_of_freedom(&freedom)
    }

    /// Sets the variance $`\mathrm E\lvert\delta H\rvert^2`$ of the complex lines. Entries of lines
    /// without information are ignored.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`]; [`LabioError::NonPhysical`] for a variance that is negative
    /// or not finite.
    pub fn with_variance(mut self, variance: Vec<f64>) -> Result<Self, LabioError> {
        self.check_lines("lines of the validity", self.validity.len())?;
        self.check_lines("lines of the variance", variance.len())?;
        let mut variance = variance;
        for (value, validity) in variance.iter_mut().zip(&self.validity) {
            if *validity != LineValidity::Valid {
                *value = f64::NAN;
            } else if !(value.is_finite() && *value >= 0.0) {
                return non_physical("variance of a line", *value, "a finite value, not negative");
            }
        }
        self.variance = Some(variance);
        let known = vec![f64::INFINITY; self.values.len()];
        self.with_degrees_of_freedom(&known)
    }

    /// Adds a known variance to that of the complex lines, such as the variance caused by the
    /// truncation of a record. The degrees of freedom follow from those of the random part by the
    /// formula of Welch and Satterthwaite: $`\nu\,(\sigma^2 + \sigma_k^2)^2/\sigma^4`$. The random
    /// variance $`\sigma^2`$ in this formula is that of the line or, if larger, its mean over the
    /// nine nearest lines: an estimate from two averages is often much too small by chance, and
    /// would then count as known.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`]; [`LabioError::NonPhysical`] for a variance that is negative
    /// or not finite; [`LabioError::TooFewAverages`] for a response without a variance.
    pub fn with_known_variance(self, known: &[f64]) -> Result<Self, LabioError> {
        self.check_lines("lines of the variance", known.len())?;
        let Some(random) = self.variance.clone() else {
            return too_few_averages("the addition of a known variance", self.n_averages, 2);
        };
        let sum: Vec<f64> = random.iter().zip(known).map(|(r, k)| r + k).collect();
        let effective = self.degrees_of_freedom.as_ref().map(|freedom| {
            let gains = known_part::gains(&random, known, 1.0);
            let lines = freedom.iter().zip(&gains);
            lines.map(|(nu, gain)| nu * gain).collect::<Vec<_>>()
        });
        let response = self.with_variance(sum)?;
        match effective {
            Some(freedom) => response.with_degrees_of_freedom(&freedom),
            None => Ok(response),
        }
    }

    /// Sets the degrees of freedom of the variance. Entries of lines without information are
    /// ignored.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`]; [`LabioError::NonPhysical`] for degrees of freedom that are
    /// not positive; [`LabioError::TooFewAverages`] for a response without a variance.
    pub fn with_degrees_of_freedom(mut self, freedom: &[f64]) -> Result<Self, LabioError> {
        self.check_lines("lines of the degrees of freedom", freedom.len())?;
        if self.variance.is_none() {
            return too_few_averages("a variance with degrees of freedom", self.n_averages, 2);
        }
        let lines = freedom.iter().zip(&self.validity);
        let line = |(freedom, validity): (&f64, &LineValidity)| {
            if *validity != LineValidity::Valid {
                Ok(f64::NAN)
            } else if *freedom > 0.0 {
                Ok(*freedom)
            } else {
                non_physical("degrees of freedom of a line", *freedom, "a number above 0")
            }
        };
        self.degrees_of_freedom = Some(lines.map(line).collect::<Result<_, _>>()?);
        Ok(self)
    }

    /// Sets the relative standard uncertainty common to the lines, with one value per line. Entries
    /// of lines without information are ignored.
    ///
    /// # Errors
    ///
    /// [`LabioError::CountMismatch`]; [`LabioError::NonPhysical`] for an uncertainty that is
    /// negative or not finite.
    pub fn with_common_errors(mut self, relative: &[f64]) -> Result<Self, LabioError> {
        self.check_lines("lines of the common error", relative.len())?;
        let lines = relative.iter().zip(&self.validity);
        let line = |(error, validity): (&f64, &LineValidity)| {
            if *validity != LineValidity::Valid {
                Ok(f64::NAN)
            } else if error.is_finite() && *error >= 0.0 {
                Ok(*error)
            } else {
                non_physical(
                    "relative standard uncertainty of a line",
                    *error,
                    "a finite value, not negative",
                )
            }
        };
        self.common_error = Some(lines.map(line).collect::<Result<_, _>>()?);
        Ok(self)
    }

    /// Adds a relative standard uncertainty common to all lines, such as that of the sensors, which
    /// is independent of those already set. A value of 0 changes nothing.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for an uncertainty that is negative or not finite.
    pub fn with_common_error(mut self, relative: f64) -> Result<Self, LabioError> {
        if !(relative.is_finite() && relative >= 0.0) {
            return non_physical(
                "relative standard uncertainty of all lines",
                relative,
                "a finite value, not negative",
            );
        }
        if relative > 0.0 {
            let n_lines = self.values.len();
            let lines = self.common_error.get_or_insert_with(|| vec![0.0; n_lines]);
            for line in lines {
                *line = line.hypot(relative);
            }
        }
        Ok(self)
    }

    fn check_lines(&self, what: &'static str, found: usize) -> Result<(), LabioError> {
        check_count(what, found, self.values.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        AveragedSpectra, MergedResponse, Quantity, Record, ResponseKind, RigidBand, RigidBody,
        Window,
    };
    use ndarray::Array2;

    const CHANNELS: [(&str, Quantity); 2] =
        [("force", Quantity::Force), ("velocity", Quantity::Velocity)];

    fn channels() -> [Channel; 2] {
        CHANNELS.map(|(name, quantity)| Channel::new(name, quantity).unwrap())
    }

    fn averaged() -> FrequencyResponse {
        let hits = [1.0, -2.0, 0.5].map(|disturbance: f64| {
            let mut samples = Array2::zeros((2, 16));
            samples[(0, 2)] = 1.0;
            samples[(1, 2)] = 3.0;
            samples[(1, 5)] = 0.1 * disturbance;
            Record::of_test(samples, 160.0, &CHANNELS)
        });
        let spectra = AveragedSpectra::of(&hits, Window::Rectangular).unwrap();
        spectra.h1("force", "velocity").unwrap()
    }

    #[test]
    fn lines_and_coherence_say_what_the_spectra_said() {
        let measured = averaged();
        let [force, velocity] = channels();
        let coherence = measured.coherence.clone().unwrap();
        let given = FrequencyResponse::of_lines(force, velocity, 10.0, measured.values.clone())
            .unwrap()
            .with_coherence(coherence, 3)
            .unwrap();
        assert_eq!(given.frequency_hz, measured.frequency_hz);
        assert_eq!(given.n_samples, 16);
        assert_eq!(given.kind().unwrap(), ResponseKind::Mobility);
        let pairs = given.variance.as_ref().unwrap().iter();
        for (found, expected) in pairs.zip(measured.variance.as_ref().unwrap()) {
            // tolerance: the rounding error of c divided by 1 - c, which is above 1e-3 here
            assert!((found / expected - 1.0).abs() < 1e-12);
        }
        let (there, here) = (
            measured.impulse_response().unwrap(),
            given.impulse_response().unwrap(),
        );
        for (a, b) in there.values().iter().zip(here.values()) {
            assert!((a - b).abs() < 1e-12 * 480.0); // 480 is the impulse of the damper
        }
    }

    #[test]
    fn a_hole_is_flagged_and_nonsense_is_refused() {
        let [force, velocity] = channels();
        let of = |values: Vec<Complex64>| {
            FrequencyResponse::of_lines(force.clone(), velocity.clone(), 1.0, values)
        };
        let mut values = vec![Complex64::ONE; 5];
        values[0].im = f64::INFINITY;
        let response = of(values).unwrap();
        assert_eq!(response.invalid_lines().collect::<Vec<_>>(), [0]);
        let with = response
            .clone()
            .with_variance(vec![f64::NAN, 1.0, 1.0, 1.0, 1.0]);
        assert!(with.unwrap().variance.unwrap()[0].is_nan());
        let refusals = [
            of(vec![Complex64::ONE; 2]),
            response.clone().with_variance(vec![0.0; 4]),
            response.clone().with_variance(vec![-1.0; 5]),
            response.clone().with_coherence(vec![1.1; 5], 4),
            response.with_coherence(vec![0.9; 5], 1),
        ]
        .map(|answer| answer.unwrap_err().to_string());
        assert_eq!(
            refusals,
            [
                "lines of a frequency response: found 2, expected 3",
                "lines of the variance: found 4, expected 5",
                "variance of a line is -1, expected a finite value, not negative",
                "coherence [-] is 1.1, expected a number above 0 and at most 1",
                "a variance from the coherence needs at least 2 averages, found 1",
            ]
        );
    }

    /// A caller may change the lists, for example to drop the lines above a frequency; all lists
    /// must then change together.
    #[test]
    fn lists_of_unlike_lengths_are_refused() {
        let cut = |change: fn(&mut FrequencyResponse)| {
            let mut response = averaged();
            change(&mut response);
            response
        };
        let variants = [
            cut(|response| response.frequency_hz.truncate(4)),
            cut(|response| response.coherence.iter_mut().for_each(|c| c.truncate(4))),
            cut(|response| response.variance.iter_mut().for_each(|v| v.truncate(4))),
            cut(|response| response.validity.truncate(4)),
            cut(|response| response.values.truncate(4)),
        ];
        let mass = RigidBody::new(1.0, 0.0).unwrap();
        let band = RigidBand {
            from_hz: 10.0,
            to_hz: 80.0,
        };
        for response in &variants {
            let answers = [
                response.to_kind(ResponseKind::Accelerance).map(|_| ()),
                response.passivity(0.02).map(|_| ()),
                response.impulse_response().map(|_| ()),
                mass.complete(response, band).map(|_| ()),
                MergedResponse::by_inverse_variance(&[averaged(), response.clone()]).map(|_| ()),
                MergedResponse::by_inverse_variance(&[response.clone(), averaged()]).map(|_| ()),
            ];
            for answer in answers {
                let refused = matches!(answer, Err(LabioError::CountMismatch { .. }));
                assert!(refused, "{answer:?}");
            }
        }
        assert!(variants[3].clone().with_variance(vec![0.5; 9]).is_err());
        let coherence = variants.map(|response| {
            let lines = response.values.len();
            match response.with_coherence(vec![0.5; lines], 3) {
                Ok(response) => response.to_kind(ResponseKind::Impedance).map(|_| ()),
                Err(error) => Err(error),
            }
        });
        // `with_coherence` and `with_variance` replace a list of the wrong length; all others
        // reject it
        assert_eq!(
            coherence.map(|answer| answer.map_err(|error| error.to_string())),
            [
                Err("frequencies of the response: found 4, expected 9".to_owned()),
                Ok(()),
                Ok(()),
                Err("lines of the validity: found 4, expected 9".to_owned()),
                Err("lines of the validity: found 9, expected 4".to_owned()),
            ]
        );
        let mut shorter = averaged();
        shorter.frequency_hz.truncate(4);
        shorter.values.truncate(4);
        shorter.validity.truncate(4);
        for lines in [
            &mut shorter.coherence,
            &mut shorter.variance,
            &mut shorter.degrees_of_freedom,
            &mut shorter.possible_bias,
        ] {
            lines.iter_mut().for_each(|lines| lines.truncate(4));
        }
        for tests in [[averaged(), shorter.clone()], [shorter, averaged()]] {
            let error = MergedResponse::by_inverse_variance(&tests).unwrap_err();
            assert!(error.to_string().contains("number of lines"), "{error}");
        }
    }

    fn of(values: &[f64]) -> FrequencyResponse {
        let [force, velocity] = channels();
        let lines = values.iter().map(|value| Complex64::from(*value));
        FrequencyResponse::of_lines(force, velocity, 10.0, lines.collect()).unwrap()
    }

    /// |H|² (1 - γ²)/((n - 1) γ²) with 2(n - 1) degrees of freedom (Bendat and Piersol), for |H| =
    /// 2, γ² = 0.8 and n = 11.
    #[test]
    fn a_coherence_gives_variance_and_degrees_of_freedom() {
        let found = of(&[2.0, f64::NAN, 2.0]).with_coherence(vec![0.8; 3], 11);
        let found = found.unwrap();
        let (variance, freedom) = (found.variance.unwrap(), found.degrees_of_freedom.unwrap());
        assert!((variance[2] - 0.1).abs() < 1e-15 && variance[1].is_nan());
        assert!((freedom[2] - 20.0).abs() < 1e-15 && freedom[1].is_nan());
        assert!(of(&[2.0; 3]).with_coherence(vec![1.0; 3], 2).is_ok());
        assert!(of(&[2.0; 3]).with_coherence(vec![0.0; 3], 2).is_err());
        assert!(of(&[2.0; 3]).with_coherence(vec![1.0; 3], 1).is_err());
    }

    /// A random variance of 0.04 with ten degrees of freedom and a known variance of 0.12: 10 · 4²
    /// degrees of freedom. The second line has a random variance of 0 by chance; the mean over its
    /// neighbours is used instead.
    #[test]
    fn a_known_variance_adds_degrees_of_freedom() {
        let random = of(&[2.0; 3]).with_variance(vec![0.04, 0.0, 0.04]).unwrap();
        let random = random.with_degrees_of_freedom(&[10.0; 3]).unwrap();
        let found = random.with_known_variance(&[0.12, 0.12, 0.0]).unwrap();
        let (variance, freedom) = (found.variance.unwrap(), found.degrees_of_freedom.unwrap());
        assert!((variance[0] - 0.16).abs() < 1e-15 && (freedom[0] - 160.0).abs() < 1e-12);
        assert!((variance[1] - 0.12).abs() < 1e-15 && (freedom[1] - 302.5).abs() < 1e-9);
        assert!((variance[2] - 0.04).abs() < 1e-15 && (freedom[2] - 10.0).abs() < 1e-12);
        let zero = of(&[2.0; 3]).with_variance(vec![0.1; 3]).unwrap();
        assert!(zero.with_degrees_of_freedom(&[0.0; 3]).is_err());
    }

    #[test]
    fn common_errors_of_lines_and_of_all_add_as_squares() {
        let of_lines = of(&[2.0, f64::NAN, 2.0]).with_common_errors(&[0.03, f64::NAN, 0.0]);
        let all = of_lines.unwrap().with_common_error(0.04).unwrap();
        let found = all.common_error.unwrap();
        assert!((found[0] - 0.05).abs() < 1e-15 && (found[2] - 0.04).abs() < 1e-15);
        assert!(found[1].is_nan());
        for wrong in [-0.01, f64::NAN, f64::INFINITY] {
            assert!(of(&[2.0; 3]).with_common_errors(&[wrong; 3]).is_err());
            assert!(of(&[2.0; 3]).with_common_error(wrong).is_err());
        }
        let none = of(&[2.0; 3]).with_common_error(0.0).unwrap();
        assert_eq!(none.common_error, None);
    }

    /// Truncation of 9 lines, which belong to 16 samples, to 5 lines, which belong to 8.
    #[test]
    fn truncated_lines_are_those_of_fewer_samples() {
        let mut response = of(&[2.0; 9]).with_coherence(vec![0.8; 9], 5).unwrap();
        let whole = response.clone();
        for lines in [9, 20] {
            response.truncate(lines);
            assert_eq!((response.n_samples, response.values.len()), (16, 9));
        }
        response.truncate(5);
        assert_eq!(response.n_samples, 8);
        assert_eq!(response.values, whole.values[..5]);
        assert_eq!(response.coherence.as_ref().map(Vec::len), Some(5));
        assert!(response.check_lengths().is_ok());
    }
}
