//! Displacements of paper D: two sections of a struck rod, measured by optical transducers (Ödeen
//! 1993, paper D, section 3).

use crate::error::{RodwaveError, check_positive};
use crate::impact::{ImpactBalance, ImpactHistory, ImpactTest};
use crate::inelastic::InelasticLaw;

/// Displacement histories of a struck rod from the first contact on. They are exact at the sensors:
/// neither filtered nor sampled at the rate of a recorder (Ödeen 1993, paper D, Figure 2).
///
/// A displacement is the sum of velocity times step in the chain that computes it. The
/// displacements are therefore as accurate as the velocities.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DisplacementPair {
    /// Time step \[s\]; entry k is at k `step`.
    pub step: f64,
    /// Displacement of the section near the struck end \[m\], positive away from the striker.
    pub section: Vec<f64>,
    /// Displacement of the free end \[m\].
    pub free_end: Vec<f64>,
    /// Balances of momentum and energy of the impact.
    pub balance: ImpactBalance,
}

impl DisplacementPair {
    pub(super) fn of(history: &ImpactHistory) -> Self {
        let summed = |velocity: &[f64]| -> Vec<f64> {
            let mut displacement = 0.0;
            let steps = velocity.iter().map(|v| {
                displacement += v * history.step;
                displacement
            });
            std::iter::once(0.0).chain(steps).collect()
        };
        Self {
            step: history.step,
            section: summed(&history.section_velocity),
            free_end: summed(&history.free_end_velocity),
            balance: history.balance,
        }
    }

    /// Time \[s\] until which both displacements are within `range` \[m\]; the end of the histories
    /// if they never leave the range.
    #[must_use]
    pub fn in_range_until(&self, range: f64) -> f64 {
        let pairs = self.section.iter().zip(&self.free_end);
        let within =
            pairs.take_while(|(section, end)| section.abs() <= range && end.abs() <= range);
        within.count().saturating_sub(1) as f64 * self.step
    }
}

impl<L: InelasticLaw> ImpactTest<L> {
    /// Runs the test for `duration` \[s\] with cells of the rod no longer than `cell` \[m\] and
    /// returns the displacements at the transducers.
    ///
    /// ```
    /// use rodwave::InelasticRod;
    /// use rodwave::impact::{ImpactTest, Striker};
    /// use rodwave::inelastic::Maxwell;
    ///
    /// let test = ImpactTest {
    ///     striker: Striker::PAPER_D,
    ///     rod: InelasticRod::new(0.8, 912.0, 2.6e9, Maxwell::new(4e6)?)?,
    ///     diameter: 0.0158,
    ///     section_distance: 0.394,
    /// };
    /// let pair = test.displacements(2e-3, 1e-3)?;
    /// // the free end leaves the range of a 0.5 mm transducer within the first millisecond
    /// assert!(pair.in_range_until(0.5e-3) < 1e-3);
    /// # Ok::<(), rodwave::RodwaveError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`ImpactTest::run`].
    pub fn displacements(
        &self,
        cell: f64,
        duration: f64,
    ) -> Result<DisplacementPair, RodwaveError> {
        check_positive("duration [s]", duration)?;
        Ok(DisplacementPair::of(&self.run(cell, duration)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InelasticRod;
    use crate::impact::Striker;
    use crate::inelastic::Elastic;

    /// Checks the displacements caused by a striker of the same material as the rod, which sends a
    /// pulse of velocity V/2 and duration 2 Lₛ/c. The pulse moves a section by V Lₛ/c, the free end
    /// by twice that, and the section once more when the pulse comes back (Ödeen 1993, paper D,
    /// Figure 2).
    #[test]
    fn displacements_are_those_of_de_saint_venant() {
        let striker = Striker {
            length: 0.05,
            diameter: 0.0158,
            density: 912.0,
            modulus: 2.6e9,
            velocity: 10.0,
        };
        let rod = InelasticRod::new(0.8, 912.0, 2.6e9, Elastic).unwrap();
        let c = rod.wave_speed();
        let test = ImpactTest {
            striker,
            rod,
            diameter: 0.0158,
            section_distance: 0.4,
        };
        let pair = test.displacements(0.5e-3, 1.35 / c).unwrap();
        let once = 10.0 * 0.05 / c;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a time within the history"
        )]
        let at = |of: &[f64], time: f64| of[(time / pair.step) as usize];
        // tolerance: at the edges of the pulse, which is 200 cells long, the velocity of the chain
        // oscillates by some hundredths over a few cells
        for (found, expected) in [
            (at(&pair.section, 0.39 / c), 0.0),
            (at(&pair.section, 0.7 / c), once),
            (at(&pair.free_end, 0.78 / c), 0.0),
            (at(&pair.free_end, 1.1 / c), 2.0 * once),
            (at(&pair.section, 1.34 / c), 2.0 * once),
        ] {
            assert!((found - expected).abs() < 5e-3 * once, "{found} {expected}");
        }
        // the free end moves by 2 `once`; it has moved by 1.2 `once` when 0.6 of the pulse has
        // arrived
        let until = pair.in_range_until(1.2 * once);
        assert!((until - 0.86 / c).abs() < 2e-3 / c, "{until}");
    }
}
