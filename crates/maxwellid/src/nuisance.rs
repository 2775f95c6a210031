//! Unknown gain, offset and delay of the transducers, as further unknowns of a fit.
//!
//! For a simulated response S and a gain g, an offset b and a delay d of the response, and a gain
//! g_e and an offset b_e of the excitation, the measured response is v_r(t) = g S(t - d; g_e v_e +
//! b_e) + b. A delay of the excitation is equivalent with the opposite sign, since only the
//! difference of the two clocks is observable. g and b enter linearly and are eliminated at every θ
//! (variable projection: Golub and Pereyra 1973, with Kaufman's derivatives); the others are
//! parameters of the iteration. For a linear rod g_e and g cannot be separated.
//!
//! Theory: `docs/theory/identification.md#unknown-transducers`.

use crate::error::MaxwellidError;
use crate::vectors::dot;

/// Freedom of a nuisance: known, unknown, or known with an uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Freedom {
    /// Known: gain 1, offset 0, delay 0.
    #[default]
    Fixed,
    /// Unknown.
    Free,
    /// Known with the standard deviation of the calibration. It requires tests with stated noise.
    Within(f64),
}

impl Freedom {
    pub(crate) fn is_unknown(self) -> bool {
        !matches!(self, Self::Fixed)
    }

    /// Reciprocal of the standard deviation; `None` if none is stated.
    pub(crate) fn prior_weight(self) -> Option<f64> {
        match self {
            Self::Within(deviation) => Some(1.0 / deviation),
            _ => None,
        }
    }
}

/// Unknowns of the transducers: the same selection for every test, with separate values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Nuisances {
    /// Gain g of the response (1 if fixed).
    pub response_gain: Freedom,
    /// Offset b of the response [m/s].
    pub response_offset: Freedom,
    /// Delay d of the response relative to the excitation \[s\]; at most
    /// [`Nuisances::LARGEST_DELAY`] samples.
    pub delay: Freedom,
    /// Gain g_e of the excitation (1 if fixed).
    pub excitation_gain: Freedom,
    /// Offset b_e of the excitation [m/s].
    pub excitation_offset: Freedom,
}

impl Nuisances {
    /// Largest delay in samples; the excitation is known this far beyond the window.
    pub const LARGEST_DELAY: f64 = 8.0;

    fn all(&self) -> [(&'static str, Freedom); 5] {
        [
            ("response gain", self.response_gain),
            ("response offset [m/s]", self.response_offset),
            ("delay [s]", self.delay),
            ("excitation gain", self.excitation_gain),
            ("excitation offset [m/s]", self.excitation_offset),
        ]
    }

    /// Returns true if any nuisance is unknown.
    #[must_use]
    pub fn any(&self) -> bool {
        self.all().iter().any(|(_, freedom)| freedom.is_unknown())
    }

    pub(crate) fn check(&self, noise_is_known: bool) -> Result<(), MaxwellidError> {
        for (nuisance, freedom) in self.all() {
            if let Freedom::Within(deviation) = freedom {
                if !(deviation.is_finite() && deviation > 0.0) {
                    return Err(MaxwellidError::Calibration {
                        nuisance,
                        value: deviation,
                    });
                }
                if !noise_is_known {
                    return Err(MaxwellidError::CalibrationWithoutNoise { nuisance });
                }
            }
        }
        Ok(())
    }

    /// Names of the eliminated nuisances, with the values at which their coefficients are 0.
    pub(crate) fn linear_names(&self) -> Vec<(&'static str, f64)> {
        [
            ("response gain", 1.0, self.response_gain),
            ("response offset [m/s]", 0.0, self.response_offset),
        ]
        .into_iter()
        .filter(|(_, _, freedom)| freedom.is_unknown())
        .map(|(name, reference, _)| (name, reference))
        .collect()
    }

    /// Nuisances that are parameters of the iteration, in their order.
    pub(crate) fn of_iteration(&self) -> Vec<(IteratedNuisance, Freedom)> {
        [
            (IteratedNuisance::Delay, self.delay),
            (IteratedNuisance::ExcitationGain, self.excitation_gain),
            (IteratedNuisance::ExcitationOffset, self.excitation_offset),
        ]
        .into_iter()
        .filter(|(_, freedom)| freedom.is_unknown())
        .collect()
    }
}

/// A nuisance that enters nonlinearly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum IteratedNuisance {
    Delay,
    ExcitationGain,
    ExcitationOffset,
}

impl IteratedNuisance {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Delay => "delay [s]",
            Self::ExcitationGain => "excitation gain",
            Self::ExcitationOffset => "excitation offset [m/s]",
        }
    }

    /// Value at which the parameter of the iteration is 0.
    pub(crate) fn reference(self) -> f64 {
        match self {
            Self::ExcitationGain => 1.0,
            Self::Delay | Self::ExcitationOffset => 0.0,
        }
    }
}

/// A nuisance with its standard error.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct NuisanceEstimate {
    /// Name, with its unit.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// Standard error; infinite where the data (and the calibration) do not determine it.
    pub standard_error: f64,
}

/// Orthonormal columns by the Gram-Schmidt process, applied twice for accuracy, with its triangular
/// matrix.
pub(crate) struct Orthonormal {
    columns: Vec<Vec<f64>>,
    /// R, upper triangle by columns.
    triangle: Vec<Vec<f64>>,
}

/// Fraction of the length of a column below which its remainder is treated as zero, so that the
/// column is a combination of the others.
const DEPENDENT: f64 = 1e-10;

impl Orthonormal {
    pub(crate) fn of(columns: &[Vec<f64>]) -> Self {
        let mut orthonormal = Self {
            columns: Vec::new(),
            triangle: Vec::new(),
        };
        for column in columns {
            let mut rest = column.clone();
            let mut entries = vec![0.0; orthonormal.columns.len()];
            for _ in 0..2 {
                for (q, entry) in orthonormal.columns.iter().zip(&mut entries) {
                    let product = dot(q, &rest);
                    *entry += product;
                    for (r, q) in rest.iter_mut().zip(q) {
                        *r -= product * q;
                    }
                }
            }
            let length = dot(&rest, &rest).sqrt();
            if length > DEPENDENT * dot(column, column).sqrt() {
                rest.iter_mut().for_each(|r| *r /= length);
                entries.push(length);
            } else {
                // an all-zero column removes nothing, and its coefficient is 0
                rest.fill(0.0);
                entries.push(f64::INFINITY);
            }
            orthonormal.columns.push(rest);
            orthonormal.triangle.push(entries);
        }
        orthonormal
    }

    /// Removes from `vector` its projection on the columns, and returns the coefficients of the
    /// original columns in this projection.
    #[allow(
        clippy::indexing_slicing,
        reason = "`triangle` has a row for each column, that of column k with k + 1 entries"
    )]
    pub(crate) fn take_from(&self, vector: &mut [f64]) -> Vec<f64> {
        let mut coefficients: Vec<f64> = self
            .columns
            .iter()
            .map(|q| {
                let product = dot(q, vector);
                for (v, q) in vector.iter_mut().zip(q) {
                    *v -= product * q;
                }
                product
            })
            .collect();
        for k in (0..coefficients.len()).rev() {
            let entries = &self.triangle[k];
            coefficients[k] /= entries[k];
            let value = coefficients[k];
            for (c, entry) in coefficients.iter_mut().zip(&entries[..k]) {
                *c -= value * entry;
            }
        }
        coefficients
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_and_remainder_are_those_of_least_squares() {
        // y = 2 + 3 x + (a vector orthogonal to 1 and x)
        let ones = vec![1.0; 4];
        let x = vec![-3.0, -1.0, 1.0, 3.0];
        let orthogonal = [1.0, -1.0, -1.0, 1.0];
        let mut y: Vec<f64> = x
            .iter()
            .zip(orthogonal)
            .map(|(x, o)| 2.0 + 3.0 * x + o)
            .collect();
        let coefficients = Orthonormal::of(&[ones, x]).take_from(&mut y);
        assert!((coefficients[0] - 2.0).abs() < 1e-14 && (coefficients[1] - 3.0).abs() < 1e-14);
        for (rest, o) in y.iter().zip(orthogonal) {
            assert!((rest - o).abs() < 1e-14);
        }
    }

    #[test]
    fn a_column_that_depends_on_others_gets_nothing() {
        let mut y = vec![1.0, 2.0, 3.0];
        let found = Orthonormal::of(&[vec![1.0, 0.0, 0.0], vec![2.0, 0.0, 0.0]]).take_from(&mut y);
        assert_eq!((found[1].to_bits(), y[0].to_bits()), (0, 0));
        assert!((found[0] - 1.0).abs() < 1e-15);
    }
}
