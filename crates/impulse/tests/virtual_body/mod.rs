//! A rod of a lossy polymer that is struck at one face, with accelerometers on both faces. The
//! responses in time are computed from the Laplace transform of the pulse, in closed form, on a
//! damped line; the frequency responses are computed on the frequency axis.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::chain::{AnalyticChain, Chain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use rodwave::synthesis::DampedSynthesis;
use testbed::noise::Noise;

/// Ratio of the synthesis rate to the sampling rate. With this ratio, content above the Nyquist
/// frequency does not alias into the synthesis.
const FINER: usize = 4;

/// A pulse $`\frac12P(1 - \cos(2\pi (t-t_0)/T))`$.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pulse {
    pub(crate) peak: f64,
    pub(crate) begin: f64,
    pub(crate) duration: f64,
}

impl Pulse {
    pub(crate) fn at(&self, time: f64) -> f64 {
        let phase = (time - self.begin) / self.duration;
        if (0.0..1.0).contains(&phase) {
            0.5 * self.peak * (1.0 - (TAU * phase).cos())
        } else {
            0.0
        }
    }

    fn transform(&self, s: Complex64) -> Complex64 {
        let omega = 2.0 * PI / self.duration;
        let window = (1.0 - (-s * self.duration).exp()) * (-s * self.begin).exp();
        0.5 * self.peak * window * (1.0 / s - s / (s * s + omega * omega))
    }
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct VirtualBody {
    pub(crate) length: f64,
    pub(crate) n_samples: usize,
    pub(crate) sampling_rate_hz: f64,
}

/// Measurements at the struck and at the far face.
#[derive(Debug, Clone)]
pub(crate) struct Faces {
    /// Accelerations \[m/s²\].
    pub(crate) responses: [Vec<f64>; 2],
    /// Accelerances [1/kg].
    pub(crate) frequency_responses: [Vec<Complex64>; 2],
}

impl VirtualBody {
    /// A rod of 20 mm with a loss factor of 0.1.
    fn medium() -> Result<Medium<ConstantQ>, RodwaveError> {
        Medium::new(1150.0, ConstantQ::new(3e9, 0.1, 1e4)?)
    }

    pub(crate) fn struck_by(&self, pulse: Pulse) -> Result<Faces, RodwaveError> {
        let medium = Self::medium()?;
        let section = Circle::of_diameter(0.020)?;
        let analytic = AnalyticChain::analytic_from_impact_face()
            .rod(&medium, section, self.length)
            .end(Termination::Free)?;
        let chain = Chain::from_impact_face()
            .rod(&medium, section, self.length)
            .end(Termination::Free)?;
        let interval = 1.0 / (self.sampling_rate_hz * FINER as f64);
        let synthesis =
            DampedSynthesis::new(self.n_samples as f64 / self.sampling_rate_hz, interval)?;
        let history = |mobility: &dyn Fn(Complex64) -> Result<Complex64, RodwaveError>| {
            let lines = synthesis.arguments();
            let transform: Vec<Complex64> = lines
                .map(|s| Ok(s * mobility(s)? * pulse.transform(s)))
                .collect::<Result<_, RodwaveError>>()?;
            let fine = synthesis.history(&transform)?.samples;
            let samples = fine.iter().step_by(FINER).take(self.n_samples);
            Ok::<Vec<f64>, RodwaveError>(samples.copied().collect())
        };
        let lines = |mobility: &dyn Fn(f64) -> Result<Complex64, RodwaveError>| {
            let above = (1..=self.n_samples / 2).map(|line| {
                let omega = TAU * line as f64 * self.sampling_rate_hz / self.n_samples as f64;
                Ok(Complex64::new(0.0, omega) * mobility(omega)?)
            });
            // the accelerance of a free body at 0 Hz is that of its mass
            let mass = chain.free_mass().unwrap_or(f64::NAN);
            std::iter::once(Ok(Complex64::from(1.0 / mass)))
                .chain(above)
                .collect::<Result<Vec<_>, RodwaveError>>()
        };
        Ok(Faces {
            responses: [
                history(&|s| analytic.mobility_at_s(s))?,
                history(&|s| analytic.far_face_mobility_at_s(s))?,
            ],
            frequency_responses: [
                lines(&|omega| chain.mobility(omega))?,
                lines(&|omega| chain.far_face_mobility(omega))?,
            ],
        })
    }
}

/// Lines with circular Gaussian errors of these variances; at 0 Hz and at the Nyquist frequency the
/// errors are real.
pub(crate) fn noisy_lines(
    lines: &[Complex64],
    variances: &[f64],
    random: &mut Noise,
) -> Vec<Complex64> {
    let last = lines.len() - 1;
    let values = lines.iter().zip(variances).enumerate();
    values
        .map(|(k, (line, variance))| {
            let error = if k == 0 || k == last {
                Complex64::from(random.normal())
            } else {
                random.circular(1.0)
            };
            line + variance.sqrt() * error
        })
        .collect()
}
