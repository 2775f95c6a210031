//! A rod struck as in paper D, in the order of an experiment (striker, rod, filter, sampling), and
//! responses computed by the lumped chain, which is independent of the solver used for the
//! identification.

use rodwave::band_limited::{SampledHistory, VelocityHistory};
use rodwave::experiment::{Acquisition, VelocityRecord};
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::InelasticLaw;
use rodwave::line::{Body, Drive, End, Line, Segment};
use rodwave::lumped::LumpedRod;
use rodwave::{InelasticRod, RodwaveError};

/// Rod with its striker and recorder.
#[derive(Debug, Clone)]
pub struct StruckRod<L> {
    pub striker: Striker,
    /// Length of the rod and distance from the section where the excitation is measured to the free
    /// end \[m\].
    pub rod_length: f64,
    pub section_distance: f64,
    pub diameter: f64,
    pub density: f64,
    pub modulus: f64,
    pub law: L,
    pub acquisition: Acquisition,
    /// Longest cell in the solver of striker and rod \[m\].
    pub cell: f64,
    /// Time step of the chain, in travel times of a wave through a cell of the chain.
    pub courant_number: f64,
}

impl<L: InelasticLaw> StruckRod<L> {
    /// Creates a rod with a diameter of 16 mm that the striker of paper D hits at `velocity` [m/s].
    /// The excitation is measured 8 mm from the struck end and `length` \[m\] from the free end.
    pub fn of_16_mm(
        law: &L,
        velocity: f64,
        length: f64,
        density: f64,
        modulus: f64,
        acquisition: Acquisition,
    ) -> Self {
        Self {
            striker: Striker {
                velocity,
                ..Striker::PAPER_D
            },
            rod_length: length + 0.008,
            section_distance: length,
            diameter: 0.016,
            density,
            modulus,
            law: law.clone(),
            acquisition,
            cell: 1e-3,
            courant_number: 0.5,
        }
    }

    fn rod(&self, length: f64) -> Result<InelasticRod<L>, RodwaveError> {
        InelasticRod::new(length, self.density, self.modulus, self.law.clone())
    }

    pub fn test(&self) -> Result<ImpactTest<L>, RodwaveError> {
        Ok(ImpactTest {
            striker: self.striker,
            rod: self.rod(self.rod_length)?,
            diameter: self.diameter,
            section_distance: self.section_distance,
        })
    }

    /// Returns both velocities as filtered and sampled by the recorder.
    pub fn record(&self) -> Result<VelocityRecord, RodwaveError> {
        self.test()?.record(&self.acquisition, self.cell)
    }

    /// Returns the velocity of the free end at `times` \[s\] under an `excitation`, computed with a
    /// chain of `cells` cells.
    ///
    /// If the excitation has passed the filter of a recorder, the response must not be filtered
    /// too, because the filter does not commute with a nonlinear rod.
    pub fn by_chain(
        &self,
        cells: usize,
        excitation: &dyn VelocityHistory,
        times: &[f64],
    ) -> Result<Vec<f64>, RodwaveError> {
        let rod = self.rod(self.section_distance)?;
        LumpedRod::new(&rod, cells, self.courant_number)?.free_end_velocity(excitation, times)
    }

    /// Returns the velocity of the free end, extrapolated from chains of `cells` and of twice as
    /// many cells; the extrapolation removes the leading error.
    pub fn by_two_chains(
        &self,
        cells: usize,
        excitation: &dyn VelocityHistory,
        times: &[f64],
    ) -> Result<Vec<f64>, RodwaveError> {
        let coarse = self.by_chain(cells, excitation, times)?;
        let fine = self.by_chain(2 * cells, excitation, times)?;
        let pairs = coarse.iter().zip(fine);
        Ok(pairs
            .map(|(coarse, fine)| fine + (fine - coarse) / 3.0)
            .collect())
    }
}

/// Returns `count` samples of a Gaussian pulse of 8 m/s with its crest at sample `crest`. The pulse
/// falls to 1/e within `width` samples.
pub fn pulse(count: u32, crest: f64, width: f64) -> Vec<f64> {
    let at = |k| 8.0 * (-((f64::from(k) - crest) / width).powi(2)).exp();
    (0..count).map(at).collect()
}

/// Returns the velocity of the free end of `rod` at the samples of its excitation, computed with a
/// chain of `cells` cells.
pub fn driven_by_samples<L: InelasticLaw>(
    rod: &InelasticRod<L>,
    cells: usize,
    excitation: &[f64],
    rate_hz: f64,
) -> Result<Vec<f64>, RodwaveError> {
    let history = SampledHistory::new(excitation, rate_hz)?;
    let times = times(excitation.len(), rate_hz);
    LumpedRod::new(rod, cells, 0.5)?.free_end_velocity(&history, &times)
}

/// Returns the velocity of the free end of a driven `segment` at `times` \[s\], computed by
/// `rodwave::line` in steps of `step` \[s\]. The last three samples, which no window contains, are
/// set to an earlier value.
pub fn by_line(
    segment: Segment,
    excitation: &SampledHistory,
    times: &[f64],
    step: f64,
) -> Result<Vec<f64>, RodwaveError> {
    let drive = Drive::history(excitation.clone());
    let line = Line::new([Body::new([segment])?])?.with_left_end(End::Velocity(drive))?;
    let duration = times.iter().rev().nth(3).copied().unwrap_or_default();
    let run = line.run(step, duration, &[])?;
    // `ends` contains the velocities at the middle of the steps
    let step = run.grid.time_step;
    let [_, free] = &run.ends;
    let end = SampledHistory::new(&free.velocity, 1.0 / step)?;
    let at = times.iter().map(|t| end.at((t - 0.5 * step).min(duration)));
    Ok(at.collect())
}

/// Returns the times of `count` samples \[s\].
pub fn times(count: usize, rate_hz: f64) -> Vec<f64> {
    (0..count).map(|k| k as f64 / rate_hz).collect()
}

/// Returns the excitation by a striker with a rounded end at `times`: the excitation `flat` by a
/// striker with a flat end, smoothed by a normal density with the standard deviation `deviation`
/// \[s\].
pub fn rounded(flat: &SampledHistory, times: &[f64], deviation: f64) -> Vec<f64> {
    let end = times.last().copied().unwrap_or_default();
    let places: Vec<f64> = (-40..=40).map(|k| 0.1 * f64::from(k)).collect();
    let weights: Vec<f64> = places.iter().map(|z| (-0.5 * z * z).exp()).collect();
    let sum: f64 = weights.iter().sum();
    let smooth = |t: &f64| {
        let pairs = places.iter().zip(&weights);
        let values = pairs.map(|(z, w)| w * flat.at((t + deviation * z).clamp(0.0, end)));
        values.sum::<f64>() / sum
    };
    times.iter().map(smooth).collect()
}
