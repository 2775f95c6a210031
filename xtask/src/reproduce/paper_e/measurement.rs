//! Impulse responses of virtual bodies, measured as in the paper: an impedance head, a light and a
//! heavy hammer, ten tests with each hammer.
//!
//! The hammer impacts are computed by the damped Fourier transform of `rodwave::experiment`; the
//! predictions of forces use other methods.

use impulse::{FaceMobility, ImpedanceHead, LowFrequency, MeasuredBody, WeighedMass};
use labio::MergedResponse;
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::super::Error;
use testbed::papers::paper_e::PaperE;
use testbed::papers::paper_e::bodies::Face;
use testbed::papers::paper_e::hammer_tests::BELOW_GAUGE;

/// Standard uncertainty of weighing, in kg.
const WEIGHING: f64 = 1e-4;
pub(crate) const SEED: u64 = 1993;

/// Mobility of a bare face, with the results of both hammers merged by two rules.
#[derive(Debug)]
pub(crate) struct Measurement {
    pub(crate) frequency_step_hz: f64,
    /// Rule of the paper: each line from the hammer with the larger force.
    pub(crate) larger_force: FaceMobility,
    /// Second rule: each line from both hammers, weighted by their variances.
    pub(crate) inverse_variance: FaceMobility,
    /// Fraction of the lines that the rule of the paper takes from the light hammer.
    pub(crate) part_of_light: f64,
    /// Median frequency of the lines at which the rule of the paper changes the hammer, in Hz.
    pub(crate) crossover_hz: Option<f64>,
}

/// Returns a mobility of a weighed body on the lines of the measurement.
pub(crate) fn on_lines(
    paper: &PaperE,
    face: Face,
    mobility: &[Complex64],
    variance: Option<&[f64]>,
) -> Result<MeasuredBody, Error> {
    let weighed = LowFrequency::Free(WeighedMass {
        mass: paper.mass(face)?,
        standard_error: WEIGHING,
    });
    // the band ends at 8.9 kHz; above it, the response of the face is that of its material
    let body = MeasuredBody::from_mobility(mobility, paper.frequency_step_hz(), weighed)?
        .with_front_impedance(paper.front_impedance(face)?)?;
    Ok(match variance {
        Some(variance) => body.with_variance(variance)?,
        None => body,
    })
}

pub(crate) fn measure(paper: &PaperE, face: Face) -> Result<Measurement, Error> {
    let position = Face::ALL.iter().position(|other| *other == face);
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    random.set_stream(position.unwrap_or_default() as u64);
    let tests = paper.hammer_tests(face, &mut random)?;
    let by_force = tests.by_larger_force()?;
    let from_light: Vec<bool> = (1..paper.n_lines())
        .map(|line| by_force.shares[(0, line)] > 0.5)
        .collect();
    let changes: Vec<usize> = (1..from_light.len())
        .filter(|&line| from_light[line] != from_light[line - 1])
        .collect();
    let step = paper.frequency_step_hz();
    Ok(Measurement {
        frequency_step_hz: step,
        part_of_light: from_light.iter().filter(|light| **light).count() as f64
            / from_light.len() as f64,
        crossover_hz: changes
            .get(changes.len() / 2)
            .map(|line| (*line as f64 + 1.0) * step),
        larger_force: bare_face(paper, &by_force)?,
        inverse_variance: bare_face(paper, &tests.by_inverse_variance()?)?,
    })
}

/// Returns the mobility of the face after subtraction of the mass of the head.
fn bare_face(paper: &PaperE, merged: &MergedResponse) -> Result<FaceMobility, Error> {
    let (accelerance, variance) = paper.on_lines(merged)?;
    let head = ImpedanceHead::new(BELOW_GAUGE)?;
    Ok(head.face_mobility(&accelerance, &variance, paper.frequency_step_hz())?)
}
