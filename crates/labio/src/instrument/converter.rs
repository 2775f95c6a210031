//! The analogue-digital converter.

use rand::Rng;
use rand_distr::{Distribution, StandardUniform};

use crate::LabioError;
use crate::error::{check_positive, non_physical};

/// A converter of $`b`$ bits with the range $`\pm R`$: steps of $`q = 2R/2^b`$, numbers
/// $`-2^{b-1} \ldots 2^{b-1}-1`$, rounded to the nearest.
///
/// For a signal that crosses many steps, the rounding is noise of variance $`q^2/12`$. With dither
/// (the difference of two uniform random numbers, each within one step, added before rounding) the
/// variance is $`q^2/4`$ for any signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Converter {
    bits: u32,
    range: f64,
    dither: bool,
}

impl Converter {
    /// Creates a converter of `bits` bits with the range `-range..range`, in the SI unit of the
    /// channel at this stage.
    ///
    /// # Errors
    ///
    /// [`LabioError::NonPhysical`] if the number of bits is not 1 to 32 or the range is not
    /// positive.
    pub fn new(bits: u32, range: f64) -> Result<Self, LabioError> {
        check_positive("range of the converter", range)?;
        if !(1..=32).contains(&bits) {
            return non_physical(
                "bits of the converter",
                bits.into(),
                "a number from 1 to 32",
            );
        }
        let converter = Self {
            bits,
            range,
            dither: false,
        };
        if converter.step().is_normal() {
            Ok(converter)
        } else {
            non_physical(
                "range of the converter",
                range,
                "a range whose step is within the range of numbers",
            )
        }
    }

    /// Adds dither.
    #[must_use]
    pub fn with_dither(mut self) -> Self {
        self.dither = true;
        self
    }

    /// Size of a step.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.range / self.half()
    }

    /// Half the number of steps, 2ᵇ⁻¹.
    fn half(&self) -> f64 {
        f64::from(1_u32 << (self.bits - 1))
    }

    /// Converts in place; returns the number of samples that are clipped to an end of the range.
    pub(super) fn convert<'a, R: Rng + ?Sized>(
        &self,
        samples: impl Iterator<Item = &'a mut f64>,
        rng: &mut R,
    ) -> usize {
        let (half, step) = (self.half(), self.step());
        let mut n_saturated = 0;
        for sample in samples {
            let mut steps = *sample / step;
            if self.dither {
                let uniform = |rng: &mut R| -> f64 { StandardUniform.sample(rng) };
                steps += uniform(rng) - uniform(rng);
            }
            let number = steps.round();
            let held = number.clamp(-half, half - 1.0);
            // rounding to a number past the last one also exceeds the range
            if (number - held).abs() > 0.0 {
                n_saturated += 1;
            }
            *sample = held * step;
        }
        n_saturated
    }

    pub(super) fn name(&self) -> String {
        let dither = if self.dither { " with dither" } else { "" };
        format!("{} bits over ±{}{dither}", self.bits, self.range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn a_converter_has_the_numbers_of_twos_complement() {
        // three bits over ±4: steps of 1 from -4 to 3
        let converter = Converter::new(3, 4.0).unwrap();
        let mut samples = [-9.0, -4.4, -4.6, -0.4, 0.6, 3.4, 3.6, 4.0];
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        let n = converter.convert(samples.iter_mut(), &mut rng);
        assert!(samples.iter().all(|sample| sample.fract() == 0.0));
        assert_eq!(
            samples.map(|s| format!("{s:+.0}")).join(" "),
            "-4 -4 -4 -0 +1 +3 +3 +3"
        );
        assert_eq!(n, 4);
        assert!((Converter::new(1, 2.0).unwrap().step() - 2.0).abs() < 1e-15);
        assert!(Converter::new(0, 2.0).is_err() && Converter::new(33, 2.0).is_err());
        assert!(Converter::new(16, 0.0).is_err());
    }

    /// Variance of the rounding error of a constant signal with dither, in squared steps.
    #[test]
    fn dither_makes_the_variance_of_a_still_signal_a_quarter() {
        let n = 400_000;
        let converter = Converter::new(12, 1.0).unwrap().with_dither();
        let mut samples = vec![0.1234; n];
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        assert_eq!(converter.convert(samples.iter_mut(), &mut rng), 0);
        let errors: Vec<f64> = samples
            .iter()
            .map(|sample| (sample - 0.1234) / converter.step())
            .collect();
        let n = n as f64;
        let mean = errors.iter().sum::<f64>() / n;
        let variance = errors.iter().map(|e| e * e).sum::<f64>() / n;
        // tolerance: four standard errors; the error has a variance of 1/4 and a fourth moment
        // below 1/5
        assert!(
            (variance - 0.25).abs() < 4.0 * (0.2 / n).sqrt(),
            "{variance}"
        );
        assert!(mean.abs() < 4.0 / (4.0 * n).sqrt(), "{mean}");
    }
}
