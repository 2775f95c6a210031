//! Student's factors of bands.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::ImpulseError;
use crate::error::check_probability;

/// Student's factors for bands of one probability, for errors whose random part has given degrees
/// of freedom.
///
/// The factor is interpolated linearly between nodes of $`1/\nu`$, 1/1024 apart at most: the
/// probability of a band of 95 % is off by less than $`10^{-5}`$.
pub(super) struct StudentFactors {
    /// Factors at equidistant values of the reciprocal of the degrees of freedom, from 0 to that
    /// of the random part.
    nodes: Vec<f64>,
}

impl StudentFactors {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of nodes from 9 to 1025"
    )]
    pub(super) fn new(freedom: f64, level: f64) -> Result<Self, ImpulseError> {
        check_probability("level of a band", level)?;
        let freedom = freedom.clamp(1.0, 1e6);
        let n_steps = (1024.0 / freedom).ceil().max(8.0) as usize;
        let nodes = (0..=n_steps).map(|node| {
            let probability = 0.5 * (1.0 + level);
            if node == 0 {
                return Normal::standard().inverse_cdf(probability);
            }
            StudentsT::new(0.0, 1.0, freedom * n_steps as f64 / node as f64)
                .map_or(f64::INFINITY, |student| student.inverse_cdf(probability))
        });
        Ok(Self {
            nodes: nodes.collect(),
        })
    }

    /// Returns the half width of the band for a standard `error`, whose random part `random` has
    /// the given degrees of freedom.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the place of a node"
    )]
    pub(super) fn half_width(&self, error: f64, random: f64) -> f64 {
        if error <= 0.0 {
            return 0.0;
        }
        let last = (self.nodes.len() - 1) as f64;
        // Welch and Satterthwaite: 1/ν is that of the random part multiplied by the fourth power of
        // its share
        let place = last * (random / error).powi(4).min(1.0);
        let before = place.min(last - 1.0) as usize;
        let factor = match self.nodes.get(before..before + 2) {
            Some([below, above]) => below + (place - before as f64) * (above - below),
            _ => f64::INFINITY,
        };
        factor * error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_between_nodes_are_those_of_the_distribution() {
        for freedom in [1.0, 2.0, 7.3, 99.0, 1e5] {
            let factors = StudentFactors::new(freedom, 0.95).unwrap();
            for share in [0.05, 0.31, 0.77, 0.93, 1.0_f64] {
                let exact = StudentsT::new(0.0, 1.0, freedom / share.powi(4)).unwrap();
                let found = factors.half_width(1.0, share);
                // probabilities are compared, because the quantiles of `statrs` have errors of
                // about 1e-4
                let off = exact.cdf(found) - 0.975;
                assert!(off.abs() < 5e-6, "{freedom} {share}: {found} {off:e}");
            }
        }
        assert!(StudentFactors::new(9.0, 1.0).is_err());
    }
}
