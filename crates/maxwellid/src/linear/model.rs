//! The direct problem of a linear rod with its derivatives.

use num_complex::Complex64;
use rodwave::band_limited::{SampledHistory, VelocityHistory};

use super::LinearLaw;
use crate::laplace_line::{LaplaceLine, propagation, secant_and_tangent};
use crate::law::StatedParameter;
use crate::model::{DrivenRod, LinearisedResponse, RodModel, stated_modulus};
use crate::special_case::{PronySeries, SpecialCase};
use crate::specimen::SpecimenSensitivity;

/// Points per sample of the transform. Two suffice, because the interpolation between samples
/// contains no frequency above 0.62 of the sampling rate.
const FINER: usize = 2;

/// A rod with a linear law as a [`RodModel`], solved in the Laplace domain; parameters θ = (ln E,
/// p).
#[derive(Debug, Clone)]
pub struct LinearModel<L> {
    law: L,
}

impl<L: LinearLaw> LinearModel<L> {
    /// Creates the model of this law.
    #[must_use]
    pub fn new(law: L) -> Self {
        Self { law }
    }

    /// The law.
    #[must_use]
    pub fn law(&self) -> &L {
        &self.law
    }
}

impl<L: LinearLaw> RodModel for LinearModel<L> {
    fn name(&self) -> &str {
        self.law.name()
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn parameter_names(&self) -> Vec<&str> {
        std::iter::once("ln_modulus")
            .chain(self.law.parameter_names())
            .collect()
    }

    fn step_limits(&self) -> Vec<f64> {
        // 10 % of E in one iteration: half a period of the waveform at most
        std::iter::once(0.1).chain(self.law.step_limits()).collect()
    }

    fn bounds(&self) -> Vec<(f64, f64)> {
        vec![(f64::NEG_INFINITY, f64::INFINITY); 1 + self.law.ranges().len()]
    }

    fn thermal_orders(&self) -> Vec<(usize, f64)> {
        // ln E precedes the parameters of the law
        let orders = self.law.thermal_orders().into_iter();
        orders.map(|(index, order)| (index + 1, order)).collect()
    }

    fn damping_parameter(&self) -> Option<usize> {
        self.law.damping_parameter().map(|index| index + 1)
    }

    fn parameters(&self, modulus: f64) -> Vec<f64> {
        std::iter::once(modulus.ln())
            .chain(self.law.start())
            .collect()
    }

    fn starts(&self, modulus: f64, _duration: f64) -> Vec<Vec<f64>> {
        vec![self.parameters(modulus)]
    }

    fn stated(&self, parameters: &[f64]) -> Vec<StatedParameter> {
        let of_law = parameters
            .split_first()
            .map(|(ln_modulus, of_law)| self.law.stated(ln_modulus.exp(), of_law));
        std::iter::once(stated_modulus(parameters))
            .chain(of_law.unwrap_or_default())
            .collect()
    }

    fn prony(&self, parameters: &[f64]) -> Option<PronySeries> {
        let (ln_modulus, of_law) = parameters.split_first()?;
        self.law.prony(ln_modulus.exp(), of_law)
    }

    fn special_case(&self, series: &PronySeries) -> Option<SpecialCase> {
        self.law.special_case(series)
    }

    /// Sensitivity to length and density: only that of E is not 0, because the other parameters
    /// describe the dependence on time alone.
    fn specimen_sensitivities(&self, parameters: &[f64]) -> Vec<SpecimenSensitivity> {
        let mut all = vec![SpecimenSensitivity::default(); parameters.len()];
        if let Some(modulus) = all.first_mut() {
            *modulus = SpecimenSensitivity::OF_MODULUS;
        }
        all
    }

    fn response(&self, rod: &DrivenRod<'_>, parameters: &[f64]) -> Option<Vec<f64>> {
        let (ln_modulus, of_law) = parameters.split_first()?;
        let known = rod.samples.len();
        let (mut line, mut lines) = excitation_of(rod);
        let times = Times::of(rod, known, &line)?;
        let arguments: Vec<Complex64> = line.arguments().collect();
        let shapes = self.law.shapes(&arguments, of_law)?;
        let slowness = slowness(rod, *ln_modulus);
        let inertia = rod.lateral_inertia * slowness * slowness;
        for (value, (s, shape)) in lines.iter_mut().zip(arguments.iter().zip(shapes)) {
            let apparent = shape + inertia * s * s;
            *value *= secant_and_tangent(propagation(slowness * rod.length, *s, apparent)).0;
        }
        times.read(&mut line, &mut lines)
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "`k` is the index of a line, and every column has one element per line"
    )]
    fn linearised_response(
        &self,
        rod: &DrivenRod<'_>,
        parameters: &[f64],
    ) -> Option<LinearisedResponse> {
        let (ln_modulus, of_law) = parameters.split_first()?;
        let known = rod.samples.len();
        let (mut line, mut lines) = excitation_of(rod);
        let times = Times::of(rod, known, &line)?;
        let mut derivatives = vec![vec![Complex64::ZERO; lines.len()]; parameters.len()];
        let mut by_law = vec![Complex64::ZERO; of_law.len()];
        let slowness = slowness(rod, *ln_modulus);
        let inertia = rod.lateral_inertia * slowness * slowness;
        for (k, (value, s)) in lines.iter_mut().zip(line.arguments()).enumerate() {
            let shape = self.law.shape_with_derivatives(s, of_law, &mut by_law)?;
            let apparent = shape + inertia * s * s;
            let gamma_length = propagation(slowness * rod.length, s, apparent);
            let (secant, tangent) = secant_and_tangent(gamma_length);
            *value *= secant;
            // ∂(γL)/∂p = -½ γL ∂ln(E + ρr²s²)/∂p
            let by_shape = 0.5 * *value * tangent * gamma_length / apparent;
            let (first, rest) = derivatives.split_first_mut()?;
            first[k] = by_shape * shape;
            for (column, by_parameter) in rest.iter_mut().zip(&by_law) {
                column[k] = by_shape * by_parameter;
            }
        }
        Some(LinearisedResponse {
            velocity: times.read(&mut line, &mut lines)?,
            by_parameter: derivatives
                .iter_mut()
                .map(|column| times.read(&mut line, column))
                .collect::<Option<_>>()?,
        })
    }
}

/// The Laplace line of the excitation of a rod, with the transform of the excitation on it.
fn excitation_of(rod: &DrivenRod<'_>) -> (LaplaceLine, Vec<Complex64>) {
    let rate = FINER as f64 * rod.sampling_rate_hz;
    let points = FINER * rod.samples.len();
    let mut line = LaplaceLine::new(points, rate);
    let known = points.saturating_sub(FINER) + 1;
    let lines = line.transform(known, |n| rod.excitation.at(n as f64 / rate));
    (line, lines)
}

/// (ρ/E)^½ [s/m]
fn slowness(rod: &DrivenRod<'_>, ln_modulus: f64) -> f64 {
    (rod.density * (-ln_modulus).exp()).sqrt()
}

/// Times at which a history is evaluated.
enum Times<'a> {
    /// Zero at the first `rest` times, then `count` samples from sample `first` on, each evaluated
    /// a fraction δ of an interval after the sample. This is exact: `advance` is the factor e^{sδ}
    /// of each line, empty for δ = 0.
    AtSamples {
        rest: usize,
        first: usize,
        count: usize,
        advance: Vec<Complex64>,
    },
    /// Arbitrary times, which require an interpolation.
    Anywhere { times: &'a [f64], known: usize },
}

impl<'a> Times<'a> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "times are checked to be within the record, and the first sample against its length"
    )]
    fn of(rod: &DrivenRod<'a>, known: usize, line: &LaplaceLine) -> Option<Self> {
        let times = rod.times;
        let end = rod.excitation.end() * (1.0 + 1e-12);
        if !times.iter().all(|t| (0.0..=end).contains(t)) {
            return None;
        }
        // tolerance: 1e-9 of the record, far above rounding and far below the distance of two
        // samples
        let uniform = |times: &[f64]| {
            let first = times.first()? * rod.sampling_rate_hz;
            let mut each = times.iter().enumerate();
            let is_next = |(k, t): (usize, &f64)| {
                (t * rod.sampling_rate_hz - first - k as f64).abs() < 1e-9 * known as f64
            };
            each.all(is_next).then_some(first)
        };
        let at_rest = times.iter().take_while(|t| **t == 0.0).count();
        let moving = times.get(at_rest..).unwrap_or_default();
        let found = uniform(times).map(|first| (0, first));
        let found = found.or_else(|| Some((at_rest, uniform(moving)?)));
        let Some((rest, first)) = found else {
            return Some(Self::Anywhere { times, known });
        };
        let count = times.len() - rest;
        // here the sampling rate or the samples of the rod differ from those of its excitation
        if first.floor() + count as f64 > known as f64 {
            return None;
        }
        let part = (first - first.floor()) / rod.sampling_rate_hz;
        let advance = line.arguments().map(|s| (s * part).exp());
        Some(Self::AtSamples {
            rest,
            first: first.floor() as usize,
            count,
            advance: advance.take_while(|_| part > 0.0).collect(),
        })
    }

    /// The history of `lines` at these times; `None` unless it is finite.
    fn read(&self, line: &mut LaplaceLine, lines: &mut [Complex64]) -> Option<Vec<f64>> {
        let history = match self {
            Self::AtSamples {
                rest,
                first,
                count,
                advance,
            } => {
                let pairs = lines.iter_mut().zip(advance);
                pairs.for_each(|(value, factor)| *value *= factor);
                let fine = line.history(lines, FINER * (first + count));
                let samples = fine.chunks(FINER).skip(*first);
                let moving = samples.filter_map(|own| own.first().copied());
                std::iter::repeat_n(0.0, *rest).chain(moving).collect()
            }
            Self::Anywhere { times, known } => {
                let fine = line.history(lines, FINER * known);
                let between = SampledHistory::new(&fine, line.rate_hz()).ok()?;
                times.iter().map(|t| between.at(*t)).collect::<Vec<f64>>()
            }
        };
        history.iter().all(|v| v.is_finite()).then_some(history)
    }
}
