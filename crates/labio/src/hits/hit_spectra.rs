//! Spectra of hits that are compared with each other.

use num_complex::Complex64;

use crate::error::check_count;
use crate::spectra::ending::{Completion, Ending, tail_length};
use crate::{LabioError, LevelAtRest, Record, channel, dft};

/// Fewest hits that are compared.
pub(super) const FEWEST_HITS: usize = 4;

/// Lines of one channel of a hit.
pub(super) type Lines = Vec<Complex64>;

/// Spectra of an input and of outputs in several hits, for [`find_odd_hits`](super::find_odd_hits)
/// and [`find_trends`](super::find_trends).
///
/// The level at rest is subtracted from each channel, and the motion after the end of the record is
/// added to its spectrum. The line at 0 Hz is left out. Fewer than four hits are not transformed:
/// nothing is found in them.
#[derive(Debug, Clone, Default)]
pub struct HitSpectra {
    pub(super) n_samples: usize,
    pub(super) sampling_rate_hz: f64,
    /// Largest deviation of the input from its level at rest, in each hit.
    pub(super) peaks: Vec<f64>,
    /// Input of each hit.
    pub(super) inputs: Vec<Lines>,
    /// Each output in each hit, with the name of the output.
    pub(super) outputs: Vec<(String, Vec<Lines>)>,
}

impl HitSpectra {
    /// Transforms `input` and `outputs` of the `hits`, which are at rest in the first `n_rest`
    /// samples ([`samples_at_rest`](super::samples_at_rest)).
    ///
    /// # Errors
    ///
    /// [`LabioError::UnknownChannel`]; [`LabioError::CountMismatch`] for hits that differ in length
    /// from the first.
    pub fn of(
        hits: &[&Record],
        input: &str,
        outputs: &[&str],
        n_rest: Option<usize>,
    ) -> Result<Self, LabioError> {
        let Some(first) = hits.first().filter(|_| hits.len() >= FEWEST_HITS) else {
            return Ok(Self::default());
        };
        let n_samples = first.n_samples();
        let completion = Completion::new(n_samples, 1.0);
        let motions = |name: &str| -> Result<Vec<Motion>, LabioError> {
            let motion = |hit: &&Record| Motion::of(hit, name, n_samples, n_rest);
            hits.iter().map(motion).collect()
        };
        let lines = |motion: &Motion| motion.lines(&completion);
        let of_input = motions(input)?;
        let mut spectra = Self {
            n_samples,
            sampling_rate_hz: first.sampling_rate_hz(),
            peaks: of_input.iter().map(Motion::peak).collect(),
            inputs: of_input.iter().map(lines).collect(),
            outputs: Vec::with_capacity(outputs.len()),
        };
        for output in outputs {
            let of_output = motions(output)?.iter().map(lines).collect();
            spectra.outputs.push(((*output).to_owned(), of_output));
        }
        Ok(spectra)
    }
}

/// A channel of a hit relative to its level at rest.
struct Motion {
    samples: Vec<f64>,
    ending: Ending,
}

impl Motion {
    fn of(
        hit: &Record,
        name: &str,
        n_samples: usize,
        n_rest: Option<usize>,
    ) -> Result<Self, LabioError> {
        check_count("samples of a hit", hit.n_samples(), n_samples)?;
        let mut samples = hit.channel(name)?.to_vec();
        let rest = LevelAtRest::of(samples.iter().copied().take(n_rest.unwrap_or(0)));
        let level = rest.map_or(0.0, |rest| rest.level);
        samples.iter_mut().for_each(|x| *x -= level);
        let (_, known) = channel::find(hit.channels(), name)?;
        Ok(Self {
            samples,
            ending: Ending::of(known.quantity()),
        })
    }

    /// Returns the largest deviation from the level at rest.
    fn peak(&self) -> f64 {
        self.samples.iter().fold(0.0, |top, x| top.max(x.abs()))
    }

    /// Returns the transform, completed by the motion after the record and without the line at
    /// 0 Hz.
    fn lines(&self, completion: &Completion) -> Lines {
        let n_samples = self.samples.len();
        let (_, tail) = self.samples.split_at(n_samples - tail_length(n_samples));
        let end = self.ending.fit(tail);
        let mut lines = dft::forward(&self.samples);
        completion.complete(self.ending, end, &mut lines);
        lines.iter_mut().take(1).for_each(|x| *x = Complex64::ZERO);
        lines
    }
}
