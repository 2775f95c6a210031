//! Virtual tests: geometry, striker and recorder as in the paper, data from the lumped chain.

use maxwellid::{Provenance, RodTest, RodTestData};
use rodwave::band_limited::{Recorder, SampledHistory, VelocityHistory};
use rodwave::experiment::{Acquisition, VelocityRecord};
use rodwave::impact::Striker;
use rodwave::inelastic::{InelasticLaw, Maxwell};
use rodwave::line::{self, Body, Drive, End, Line, Segment};
use rodwave::lumped;
use rodwave::modulus::{ConstantQ, OmegaBand, PronyStandIn};
use rodwave::{DirectProblem, InelasticRod, characteristics};

use super::super::Error;
use super::identify::{modulus_of, with_law};
use testbed::papers::paper_d::{self, LawParameters};
use testbed::struck_rod::{self, StruckRod};

/// Standard deviation of the noise added to each of the two histories, as a fraction of V0. The
/// difference between a simulation from one noisy history and the other history is then about the
/// error of Table 5.
pub(crate) const NOISE: f64 = 0.008;

/// Seed of the noise of a test, to which the number of the test is added.
pub(crate) const SEED: u64 = 1993;

/// Noise for the second verdict on the noise-free data of the appendix, as a fraction of V0.
pub(crate) const NOISE_OF_TABLE_5: f64 = 0.02;

/// Cut-off of the virtual recorder. The paper states a sampling frequency of 51.2 kHz but no
/// filter; this filter passes nothing above 20 kHz.
pub(crate) const CUTOFF_HZ: f64 = 16_000.0;

/// Band in which the series for constant loss is accurate: 50 Hz to 20 kHz.
pub(crate) const FLAT_LOSS_BAND: OmegaBand = OmegaBand {
    from: 314.0,
    to: 1.26e5,
};

/// Number of time steps of the line model, which computes constant loss, per time step of the
/// lumped chain.
const FLAT_LOSS_REFINEMENT: f64 = 4.0;

/// Number of Maxwell branches of the line model per decade of relaxation times.
pub(crate) const FLAT_LOSS_BRANCHES: f64 = 2.0;

/// Number of samples before the impact: the filter reaches 24 samples ahead.
const SAMPLES_BEFORE: usize = 32;

/// White noise of the recorder, and its standard deviation in m/s; `None` for noise-free data.
#[derive(Debug)]
pub(crate) struct Noise(Option<(testbed::noise::Noise, f64)>);

impl Noise {
    pub(crate) fn none() -> Self {
        Self(None)
    }

    fn added_to(&mut self, history: &[f64]) -> Vec<f64> {
        match &mut self.0 {
            Some((noise, deviation)) => noise.added_to(history, *deviation),
            None => history.to_vec(),
        }
    }
}

/// Returns the tests with the noise of the recorder stated for both histories. An identification
/// then weights this noise; otherwise it minimises the sum of squares of paper D, eq. 12.
pub(crate) fn stating_the_noise(
    tests: &[RodTest],
    impact_velocity: f64,
) -> Result<Vec<RodTest>, Error> {
    let level = NOISE * impact_velocity;
    Ok(tests
        .iter()
        .map(|test| test.clone().with_noise(level, level))
        .collect::<Result<_, _>>()?)
}

/// Rod and its test conditions.
#[derive(Debug, Clone)]
pub(crate) struct Conditions {
    pub(crate) name: String,
    pub(crate) density: f64,
    pub(crate) diameter: f64,
    pub(crate) rod_length: f64,
    pub(crate) section_distance: f64,
    pub(crate) transducer_range: f64,
    pub(crate) samples_after: usize,
    /// Longest cell of the chain that generates the data.
    pub(crate) cell: f64,
}

/// Returns the length of a cell of the chain for a rod with wave speed c = (E/ρ)^½: a fraction of
/// the shortest wavelength that the recorder passes.
pub(crate) fn cell_for(modulus: f64, density: f64, cells_per_wave: f64) -> f64 {
    (modulus / density).sqrt() / CUTOFF_HZ / cells_per_wave
}

/// Striker and recorder, the same in all tests.
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

    /// Creates the white noise of a test, with a standard deviation of [`NOISE`] times V0.
    pub(crate) fn noise(&self, test: &paper_d::RodTestConditions) -> Noise {
        let noise = testbed::noise::Noise::seeded(SEED + u64::from(test.test));
        Noise(Some((noise, NOISE * self.striker.velocity)))
    }

    pub(crate) fn recorder(&self) -> Recorder {
        Recorder {
            rate_hz: self.sampling_rate,
            cutoff_hz: CUTOFF_HZ,
        }
    }

    fn rod<L: InelasticLaw>(&self, conditions: &Conditions, modulus: f64, law: &L) -> StruckRod<L> {
        StruckRod {
            striker: self.striker,
            rod_length: conditions.rod_length,
            section_distance: conditions.section_distance,
            diameter: conditions.diameter,
            density: conditions.density,
            modulus,
            law: law.clone(),
            acquisition: Acquisition {
                recorder: self.recorder(),
                samples_before: SAMPLES_BEFORE,
                samples_after: conditions.samples_after,
                transducer_range: conditions.transducer_range,
            },
            cell: conditions.cell,
            courant_number: lumped::DEFAULT_COURANT_NUMBER,
        }
    }

    /// Creates a test of the recorded excitation and the `response`, with noise on both. The noise
    /// is not stated in the test; see [`stating_the_noise`].
    fn test(
        &self,
        conditions: &Conditions,
        record: &VelocityRecord,
        response: &[f64],
        generator: &str,
        noise: &mut Noise,
    ) -> Result<RodTest, Error> {
        let test = RodTest::new(RodTestData {
            name: conditions.name.clone(),
            length: conditions.section_distance,
            density: conditions.density,
            impact_velocity: self.striker.velocity,
            sampling_rate_hz: self.sampling_rate,
            excitation: noise.added_to(&record.excitation),
            response: noise.added_to(response),
            provenance: Provenance::Virtual {
                generator: generator.into(),
            },
        })?;
        // the comparison ends where the excitation ends, or where a section leaves the range of its
        // transducer
        let known = test.times().last().copied().unwrap_or(0.0);
        Ok(test.with_window(known.min(record.in_range_until))?)
    }

    /// Returns a test with an impact of the projectile. The recorder filters and samples both
    /// histories, and white noise is added to both.
    ///
    /// The filter of the recorder acts after the rod. It does not commute with a nonlinear rod: the
    /// recorded excitation would not cause the recorded response.
    pub(crate) fn struck(
        &self,
        conditions: &Conditions,
        parameters: LawParameters,
        noise: &mut Noise,
    ) -> Result<RodTest, Error> {
        let modulus = modulus_of(parameters);
        let record = with_law!(parameters, |law| self
            .rod(conditions, modulus, &law)
            .record()?);
        self.test(
            conditions,
            &record,
            &record.response,
            lumped::GENERATOR,
            noise,
        )
    }

    /// Returns a test with the response of the lumped chain to the excitation that has passed the
    /// filter of the recorder, before sampling.
    ///
    /// The response is extrapolated from two grids; the extrapolation removes the leading error of
    /// the chain.
    pub(crate) fn driven(
        &self,
        conditions: &Conditions,
        parameters: LawParameters,
        noise: &mut Noise,
    ) -> Result<RodTest, Error> {
        let modulus = modulus_of(parameters);
        with_law!(parameters, |law| {
            let rod = self.rod(conditions, modulus, &law);
            let record = rod.record()?;
            let response = rod.by_two_chains(
                cells(conditions),
                &record.excitation_before_sampling,
                &self.times(&record),
            )?;
            self.test(conditions, &record, &response, lumped::GENERATOR, noise)
        })
    }

    /// Returns a test with the response of a linear rod of constant loss to the recorded
    /// excitation, computed by a line model with one branch per relaxation time.
    ///
    /// The excitation is that of a Maxwell rod with the same loss factor at the reference
    /// frequency.
    pub(crate) fn flat_loss(
        &self,
        conditions: &Conditions,
        law: &ConstantQ,
        noise: &mut Noise,
    ) -> Result<RodTest, Error> {
        let spring_pot = law.spring_pot();
        let modulus = spring_pot.reference_modulus();
        let viscosity = modulus / (spring_pot.reference_omega() * law.loss_factor());
        let rod = self.rod(conditions, modulus, &Maxwell::new(viscosity)?);
        let record = rod.record()?;
        let stand_in = PronyStandIn::new(law, FLAT_LOSS_BAND, FLAT_LOSS_BRANCHES)?;
        let segment = Segment::prony(
            conditions.section_distance,
            1e-4, // an area; the response does not depend on it
            conditions.density,
            stand_in.law(),
        )?;
        let drive = Drive::history(record.excitation_before_sampling.clone());
        let line = Line::new([Body::new([segment])?])?.with_left_end(End::Velocity(drive))?;
        let times = self.times(&record);
        // the fastest branches relax within a step of the size used for the chain, which would
        // reduce the order of the splitting
        let step = conditions.cell / (modulus / conditions.density).sqrt() / FLAT_LOSS_REFINEMENT;
        let duration = times.last().copied().unwrap_or(0.0);
        // the last step of the grid may end later than requested, by at most a step, but the
        // excitation is known only to the last sample
        let run = line.run(step, duration - 2.0 * step, &[])?;
        let step = run.grid.time_step;
        // the velocities of the end are those at the middle of the steps
        let end = SampledHistory::new(&run.ends[1].velocity, 1.0 / step)?;
        let response: Vec<f64> = times
            .iter()
            // the interpolation has no neighbours for the last samples, which are outside every
            // window
            .map(|t| end.at((t - 0.5 * step).max(0.0)))
            .collect();
        self.test(conditions, &record, &response, line::GENERATOR, noise)
    }

    /// Returns a test with the noise-free response computed by the solver that the inversion also
    /// uses, as in the appendix of the paper.
    pub(crate) fn round_trip(
        &self,
        conditions: &Conditions,
        parameters: LawParameters,
        cell: f64,
    ) -> Result<RodTest, Error> {
        let modulus = modulus_of(parameters);
        with_law!(parameters, |law| {
            let record = self.rod(conditions, modulus, &law).record()?;
            let excitation = SampledHistory::new(&record.excitation, self.sampling_rate)?;
            let of_inversion = Conditions {
                cell,
                ..conditions.clone()
            };
            let (length, density) = (conditions.section_distance, conditions.density);
            let rod = InelasticRod::new(length, density, modulus, law)?;
            let response = DirectProblem::new(rod, cells(&of_inversion))?
                .free_end_velocity(&excitation, &self.times(&record))?;
            self.test(
                conditions,
                &record,
                &response,
                characteristics::GENERATOR,
                &mut Noise::none(),
            )
        })
    }

    fn times(&self, record: &VelocityRecord) -> Vec<f64> {
        struck_rod::times(record.excitation.len(), self.sampling_rate)
    }
}

fn cells(conditions: &Conditions) -> usize {
    (conditions.section_distance / conditions.cell).ceil() as usize
}
