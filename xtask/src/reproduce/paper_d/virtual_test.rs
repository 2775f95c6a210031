//! The virtual tests: geometry of the paper, striker and recorder of the paper, data of the lumped chain.

use maxwellid::{Provenance, RodTest, RodTestData};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use rodwave::band_limited::{Recorder, SampledHistory};
use rodwave::experiment::{Acquisition, VelocityRecord};
use rodwave::impact::{ImpactTest, Striker};
use rodwave::inelastic::InelasticLaw;
use rodwave::lumped::{self, LumpedRod};
use rodwave::{DirectProblem, InelasticRod, characteristics};

use super::identify::{modulus_of, with_law};
use crate::fixtures::paper_d::{self, LawParameters};

type Error = Box<dyn std::error::Error + Send + Sync>;

/// Standard deviation of the noise added to the response, as a share of V0: the level of the errors in Table 5.
pub(crate) const NOISE: f64 = 0.02;

/// Cut-off of the virtual recorder. The paper gives a sampling frequency, 51.2 kHz, and no filter; this one leaves
/// nothing above 20 kHz.
const CUTOFF_HZ: f64 = 16_000.0;

/// Samples before the impact: the filter reaches 24 ahead.
const SAMPLES_BEFORE: usize = 32;

/// White noise of the recorder, from a seed.
#[derive(Debug)]
pub(crate) struct Noise {
    generator: ChaCha8Rng,
    /// [m/s]; `None` for noise-free data
    distribution: Option<Normal<f64>>,
}

impl Noise {
    pub(crate) fn none() -> Self {
        Self {
            generator: ChaCha8Rng::seed_from_u64(0),
            distribution: None,
        }
    }

    /// White noise of [`NOISE`] times the velocity `impact_velocity` [m/s].
    pub(crate) fn of_the_recorder(impact_velocity: f64, seed: u64) -> Result<Self, Error> {
        Ok(Self {
            generator: ChaCha8Rng::seed_from_u64(seed),
            distribution: Some(Normal::new(0.0, NOISE * impact_velocity)?),
        })
    }

    fn added_to(&mut self, history: &[f64]) -> Vec<f64> {
        history
            .iter()
            .map(|v| {
                v + self
                    .distribution
                    .map_or(0.0, |distribution| distribution.sample(&mut self.generator))
            })
            .collect()
    }
}

/// A rod and how it is tested.
#[derive(Debug, Clone)]
pub(crate) struct Conditions {
    pub(crate) name: String,
    pub(crate) density: f64,
    pub(crate) diameter: f64,
    pub(crate) rod_length: f64,
    pub(crate) section_distance: f64,
    pub(crate) transducer_range: f64,
    pub(crate) samples_after: usize,
    /// Longest cell of the chain that makes the data.
    pub(crate) cell: f64,
}

/// A cell for data of a rod with wave speed c = (E/ρ)^½: a share of the shortest wave that the recorder passes.
pub(crate) fn cell_for(parameters: LawParameters, density: f64, cells_per_wave: f64) -> f64 {
    (modulus_of(parameters) / density).sqrt() / CUTOFF_HZ / cells_per_wave
}

/// The striker and the recorder, the same in all tests.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rig {
    pub(crate) striker: Striker,
    pub(crate) sampling_rate: f64,
}

impl Rig {
    pub(crate) fn of(paper: &paper_d::PaperD) -> Self {
        let striker = paper.striker;
        Self {
            striker: Striker {
                length: striker.length,
                diameter: striker.diameter,
                density: striker.density,
                modulus: striker.modulus,
                velocity: striker.velocity,
            },
            sampling_rate: paper.sampling_rate,
        }
    }

    fn record<L: InelasticLaw>(
        &self,
        conditions: &Conditions,
        modulus: f64,
        law: &L,
    ) -> Result<VelocityRecord, Error> {
        let test = ImpactTest {
            striker: self.striker,
            rod: InelasticRod::new(
                conditions.rod_length,
                conditions.density,
                modulus,
                law.clone(),
            )?,
            diameter: conditions.diameter,
            section_distance: conditions.section_distance,
        };
        let acquisition = Acquisition {
            recorder: Recorder {
                rate_hz: self.sampling_rate,
                cutoff_hz: CUTOFF_HZ,
            },
            samples_before: SAMPLES_BEFORE,
            samples_after: conditions.samples_after,
            transducer_range: conditions.transducer_range,
        };
        Ok(test.record(&acquisition, conditions.cell)?)
    }

    fn test(
        &self,
        conditions: &Conditions,
        record: &VelocityRecord,
        response: Vec<f64>,
        generator: &str,
    ) -> Result<RodTest, Error> {
        let test = RodTest::new(RodTestData {
            name: conditions.name.clone(),
            length: conditions.section_distance,
            density: conditions.density,
            impact_velocity: self.striker.velocity,
            sampling_rate_hz: self.sampling_rate,
            excitation: record.excitation.clone(),
            response,
            provenance: Provenance::Virtual {
                generator: generator.into(),
            },
        })?;
        // the comparison ends where the excitation is known, or where a transducer loses its section
        let known = test.times().last().copied().unwrap_or(0.0);
        Ok(test.with_window(known.min(record.in_range_until))?)
    }

    /// Struck by the projectile, both histories seen through the recorder; white noise on the response.
    ///
    /// The recorder's filter acts after the rod. A nonlinear rod does not commute with it, so the recorded excitation is
    /// not the one that made the recorded response.
    pub(crate) fn struck(
        &self,
        conditions: &Conditions,
        parameters: LawParameters,
        noise: &mut Noise,
    ) -> Result<RodTest, Error> {
        let record = with_law!(parameters, |law| self.record(
            conditions,
            modulus_of(parameters),
            &law
        )?);
        let response = noise.added_to(&record.response);
        self.test(conditions, &record, response, lumped::GENERATOR)
    }

    /// Response of the lumped chain to the excitation as the recorder passes it, before sampling.
    ///
    /// The response is extrapolated from two grids, which removes the leading error of the chain.
    pub(crate) fn driven(
        &self,
        conditions: &Conditions,
        parameters: LawParameters,
        noise: &mut Noise,
    ) -> Result<RodTest, Error> {
        let modulus = modulus_of(parameters);
        with_law!(parameters, |law| {
            let record = self.record(conditions, modulus, &law)?;
            let rod = rod(conditions, modulus, law)?;
            let times = self.times(&record);
            let chain = |cells| -> Result<Vec<f64>, Error> {
                let chain = LumpedRod::new(&rod, cells, lumped::DEFAULT_COURANT_NUMBER)?;
                Ok(chain.free_end_velocity(&record.excitation_before_sampling, &times)?)
            };
            let cells = cells(conditions);
            let response: Vec<f64> = chain(cells)?
                .iter()
                .zip(chain(2 * cells)?)
                .map(|(coarse, fine)| fine + (fine - coarse) / 3.0)
                .collect();
            self.test(
                conditions,
                &record,
                noise.added_to(&response),
                lumped::GENERATOR,
            )
        })
    }

    /// Noise-free response of the solver that will invert it, as in the paper's appendix.
    pub(crate) fn round_trip(
        &self,
        conditions: &Conditions,
        parameters: LawParameters,
        cell: f64,
    ) -> Result<RodTest, Error> {
        let modulus = modulus_of(parameters);
        with_law!(parameters, |law| {
            let record = self.record(conditions, modulus, &law)?;
            let excitation = SampledHistory::new(&record.excitation, self.sampling_rate)?;
            let of_inversion = Conditions {
                cell,
                ..conditions.clone()
            };
            let response =
                DirectProblem::new(rod(conditions, modulus, law)?, cells(&of_inversion))?
                    .free_end_velocity(&excitation, &self.times(&record))?;
            self.test(conditions, &record, response, characteristics::GENERATOR)
        })
    }

    #[expect(
        clippy::cast_precision_loss,
        reason = "sample counts are far below 2^52"
    )]
    fn times(&self, record: &VelocityRecord) -> Vec<f64> {
        (0..record.excitation.len())
            .map(|k| k as f64 / self.sampling_rate)
            .collect()
    }
}

fn rod<L: InelasticLaw>(
    conditions: &Conditions,
    modulus: f64,
    law: L,
) -> Result<InelasticRod<L>, Error> {
    Ok(InelasticRod::new(
        conditions.section_distance,
        conditions.density,
        modulus,
        law,
    )?)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "lengths are positive; the ratio is a cell count"
)]
fn cells(conditions: &Conditions) -> usize {
    (conditions.section_distance / conditions.cell).ceil() as usize
}
