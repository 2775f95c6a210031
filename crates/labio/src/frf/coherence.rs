//! Ordinary coherence, its bias, its random error, and the level that it reaches by chance.

use super::LineValidity;
use crate::error::{non_physical, too_few_averages};
use crate::{AveragedSpectra, LabioError};

/// Ordinary coherence $`\gamma^2 = |G_{xy}|^2/(G_{xx}G_{yy})`$: the share of the output's power
/// that is linear in the input.
///
/// With noise-to-signal ratios $`N_x/S_x`$ and $`N_y/S_y`$ it tends to
/// $`1/((1+N_x/S_x)(1+N_y/S_y))`$. Nonlinearity, leakage and a second input also reduce it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Coherence {
    /// Frequencies of the lines \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Coherence; NaN on invalid lines.
    pub values: Vec<f64>,
    /// Number of hits or segments averaged.
    pub n_averages: usize,
    /// Number of independent hits or segments that would give the same variance.
    pub effective_averages: f64,
    /// Validity of each line.
    pub validity: Vec<LineValidity>,
}

impl Coherence {
    /// Returns the expected bias of each line, to first order $`(1-\gamma^2)^2/n_e`$: with few
    /// hits, an estimate of the coherence is too high, and n hits of pure noise give 1/n.
    #[must_use]
    pub fn bias(&self) -> Vec<f64> {
        self.values
            .iter()
            .map(|coherence| (1.0 - coherence).powi(2) / self.effective_averages)
            .collect()
    }

    /// Returns the standard error of each line, to first order
    /// $`\sqrt2\,(1-\gamma^2)\gamma/\sqrt{n_e}`$ (Bendat and Piersol).
    #[must_use]
    pub fn random_error(&self) -> Vec<f64> {
        let factor = (2.0 / self.effective_averages).sqrt();
        self.values
            .iter()
            .map(|coherence| factor * (1.0 - coherence) * coherence.sqrt())
            .collect()
    }

    /// Returns the coherence that lines of independent noise exceed with probability `probability`:
    /// $`1 - p^{1/(n_e-1)}`$, exact for independent Gaussian averages.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] for a probability that is not between 0 and 1.
    pub fn chance_level(&self, probability: f64) -> Result<f64, LabioError> {
        if !(probability > 0.0 && probability < 1.0) {
            return non_physical("probability [-]", probability, "between 0 and 1");
        }
        Ok(chance_level(probability, self.effective_averages))
    }

    /// Probability that noise alone reaches the coherence below which a line is treated as noise.
    pub const CHANCE: f64 = 0.05;
}

/// Returns the coherence that noise exceeds with probability `probability`.
pub(crate) fn chance_level(probability: f64, effective_averages: f64) -> f64 {
    1.0 - probability.powf(1.0 / (effective_averages - 1.0))
}

/// Largest difference from 1 caused by rounding of samples and transforms: the noise of a 24-bit
/// converter leaves a larger difference.
const ROUNDING_OF_ONE: f64 = 1e-12;

impl Coherence {
    /// Returns true if the coherence is 1 within rounding on more than half of the valid lines: no
    /// measurement is free of noise, so several hits are copies of one hit, or were computed.
    #[must_use]
    pub fn is_one_to_rounding(&self) -> bool {
        let known = self.values.iter().filter(|value| value.is_finite());
        let mut missing: Vec<f64> = known.map(|value| 1.0 - value).collect();
        let middle = missing.len() / 2;
        if missing.is_empty() {
            return false;
        }
        let (_, median, _) = missing.select_nth_unstable_by(middle, f64::total_cmp);
        *median <= ROUNDING_OF_ONE
    }
}

impl AveragedSpectra {
    /// Returns the ordinary coherence between two channels.
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`]; [`LabioError::TooFewAverages`] for a single hit, whose
    /// coherence is 1 by construction, and for overlapped segments with an effective number of
    /// averages below 1.5.
    pub fn coherence(&self, input: &str, output: &str) -> Result<Coherence, LabioError> {
        self.check_coherence("the coherence")?;
        let pair = self.pair(input, output)?;
        Ok(Coherence {
            frequency_hz: self.frequency_hz().to_vec(),
            values: pair.coherences(),
            n_averages: self.n_averages(),
            effective_averages: self.effective_averages(),
            validity: pair.validity(),
        })
    }

    /// Rejects averages whose coherence would be 1 by construction.
    pub(crate) fn check_coherence(&self, estimate: &'static str) -> Result<(), LabioError> {
        if self.can_have_coherence() {
            Ok(())
        } else {
            too_few_averages(estimate, self.n_averages().min(1), 2)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Quantity, Record, Welch};
    use ndarray::Array2;
    use testbed::noise::Noise;

    fn noise(n_samples: usize, common: f64, rng: &mut Noise) -> Record {
        let mut samples = Array2::from_shape_simple_fn((2, n_samples), || rng.normal());
        for n in 0..n_samples {
            samples[(1, n)] += common * samples[(0, n)];
        }
        Record::of_test(
            samples,
            1.0,
            &[("x", Quantity::Force), ("y", Quantity::Velocity)],
        )
    }

    /// Compares with √(2/n) (1 - γ²) γ (Bendat and Piersol).
    #[test]
    fn the_random_error_is_that_of_the_effective_averages() {
        let coherence = Coherence {
            frequency_hz: vec![1.0],
            values: vec![0.5],
            n_averages: 60,
            effective_averages: 60.0,
            validity: vec![LineValidity::Valid],
        };
        let expected = (2.0_f64 / 60.0).sqrt() * 0.5 * 0.5_f64.sqrt();
        assert!((coherence.random_error()[0] - expected).abs() < 1e-15);
        assert!(coherence.chance_level(0.0).is_err() && coherence.chance_level(1.0).is_err());
    }

    #[test]
    fn segments_that_are_almost_one_have_no_coherence() {
        let mut rng = Noise::seeded(5);
        for (n_samples, n_segments) in [(70, 4), (66, 2)] {
            let welch = Welch::new(64).unwrap().with_overlap(62).unwrap();
            let spectra = welch.spectra(&noise(n_samples, 1.0, &mut rng)).unwrap();
            assert_eq!(spectra.n_averages(), n_segments);
            assert!(matches!(
                spectra.coherence("x", "y").unwrap_err(),
                LabioError::TooFewAverages { found: 1, .. }
            ));
            let response = spectra.h1("x", "y").unwrap();
            assert!(response.coherence.is_none() && response.variance.is_none());
        }
    }

    /// The coherence of copies of one hit is 1 within rounding on most lines, whatever it is on the
    /// other lines.
    #[test]
    fn a_coherence_of_copies_is_one_to_rounding() {
        let of = |values: &[f64]| Coherence {
            frequency_hz: vec![0.0; values.len()],
            values: values.to_vec(),
            n_averages: 5,
            effective_averages: 5.0,
            validity: vec![LineValidity::Valid; values.len()],
        };
        let (one, less, none) = (1.0 - 1e-13, 1.0 - 1e-9, f64::NAN);
        assert!(of(&[one, less, one, less, one]).is_one_to_rounding());
        assert!(of(&[one, one, none, none, less]).is_one_to_rounding());
        assert!(!of(&[one, less, less, less, one]).is_one_to_rounding());
        assert!(!of(&[one, less, none, none, less]).is_one_to_rounding());
        assert!(!of(&[none, none]).is_one_to_rounding());
        assert!(!of(&[]).is_one_to_rounding());
        // a coherence of 1 - 1e-7 can be measured
        assert!(!of(&[1.0 - 1e-7; 3]).is_one_to_rounding());
    }
}
