//! Causal estimate from measured values, which are linearised about the material.

use num_complex::Complex64;

use super::projection::{Value, Whitened};
use super::{CausalEstimate, FEWEST_LINES};
use crate::complex_frequency::ComplexFrequency;
use crate::error::{CmodError, check_enough_readings};
use crate::estimate::{ErrorSource, ModulusEstimate, ModulusLine};
use crate::lateral_inertia::{CorrectedEstimate, LateralInertia};
use crate::rheology::VarianceScatter;
use crate::self_calibration::{
    Experiment, LinearisedLine, Misfit, found, gamma_of, nearest, shift_of, sources_of, telling,
};
use crate::validity::Violation;

/// Maximum number of linearisations.
const MOST_ROUNDS: u32 = 30;
/// Sum of squares of the changes of all lines, in units of their errors, and of the changes of the
/// sizes of the common errors, below which the iteration has converged. A change of a single line
/// by one standard error gives 1.
const AT_REST: f64 = 1e-3;

/// Line that is part of the estimate.
struct Part<'a> {
    line: &'a ModulusLine,
    place: Complex64,
    /// Factor on the variance of the line, if that variance is an estimate.
    factor: f64,
    inertia: Inertia,
    /// Modulus about which the line is linearised, including the errors of the specimen.
    modulus: Complex64,
}

/// Effect of lateral inertia on a line.
#[derive(Debug, Clone, Copy)]
struct Inertia {
    /// Ratio of the modulus to the apparent modulus of one-dimensional waves.
    factor: Complex64,
    /// Relative change of the modulus due to one standard uncertainty of Poisson's ratio.
    by_poisson_ratio: Complex64,
    /// Relative change of the modulus due to one standard uncertainty of the diameter in the
    /// correction.
    by_diameter: Complex64,
}

const NO_INERTIA: Inertia = Inertia {
    factor: Complex64::ONE,
    by_poisson_ratio: Complex64::ZERO,
    by_diameter: Complex64::ZERO,
};

impl Inertia {
    /// Returns the relative change of the modulus due to one standard uncertainty of `source` in
    /// the correction.
    fn relative_change(&self, source: ErrorSource) -> Complex64 {
        match source {
            ErrorSource::PoissonRatio => self.by_poisson_ratio,
            ErrorSource::Diameter => self.by_diameter,
            _ => Complex64::ZERO,
        }
    }
}

/// Finds the material nearest to the lines of an `experiment` in the band of its valid lines. The
/// experiment removes the errors of the `measured` sources from its data. If a theory of lateral
/// inertia is given, the effect of lateral inertia is removed.
pub(crate) fn of_experiment(
    experiment: &impl Experiment,
    measured: &[ErrorSource],
    lateral_inertia: Option<&LateralInertia>,
) -> Result<CausalEstimate, CmodError> {
    let calibration = found(measured, experiment)?;
    let sizes = calibration.iter().flat_map(|found| found.sources());
    let mut removed: Vec<f64> = sizes
        .map(|source| source.size)
        .take(measured.len())
        .collect();
    removed.resize(measured.len(), 0.0);
    let start = experiment.estimate(&removed)?;
    let judged = calibration
        .as_ref()
        .map_or(&start, |found| found.estimate());
    let corrected = lateral_inertia
        .map(|theory| theory.correct(judged))
        .transpose()?;
    let judged = corrected
        .as_ref()
        .map_or(judged, |corrected| corrected.modulus());
    let inertia: Vec<(usize, Inertia)> = corrected.iter().flat_map(inertia_of_lines).collect();
    let (mut parts, scatter) = parts(experiment, &start, (judged, &inertia))?;
    let mut material = None;
    let mut rounds = 0;
    loop {
        rounds += 1;
        let mut about: Vec<LinearisedLine> = Vec::with_capacity(parts.len());
        parts.retain(|part| {
            let gamma = gamma_of(part.line, part.modulus / part.inertia.factor);
            let linearised = experiment.linearised(part.line, gamma, &removed);
            let is_usable =
                |about: &LinearisedLine| about.modulus.is_finite() && about.variance.is_normal();
            let usable = linearised.filter(is_usable);
            usable.map(|line| about.push(line)).is_some()
        });
        check_enough_readings(parts.len(), FEWEST_LINES)?;
        let mut sources = sources_of(&about, measured);
        if !inertia.is_empty() {
            sources.push(ErrorSource::PoissonRatio);
        }
        let is_uncertain = |theory: &LateralInertia| theory.diameter_uncertainty > 0.0;
        if lateral_inertia.is_some_and(is_uncertain) && !sources.contains(&ErrorSource::Diameter) {
            sources.push(ErrorSource::Diameter);
        }
        let pairs = || parts.iter().zip(&about);
        let shifts: Vec<Vec<Complex64>> = sources
            .iter()
            .map(|source| {
                let shift = |(part, about): (&Part<'_>, &LinearisedLine)| {
                    let of_correction = part.inertia.relative_change(*source) * part.modulus;
                    part.inertia.factor * shift_of(&about.shifts, *source).modulus + of_correction
                };
                pairs().map(shift).collect()
            })
            .collect();
        let mut values: Vec<Value> = pairs()
            .map(|(part, about)| {
                let factor = part.inertia.factor;
                let variance = part.factor * factor.norm_sqr() * about.variance;
                Value::circular(part.place, factor * about.modulus, variance)
            })
            .collect();
        for (size, shift) in removed.iter().zip(&shifts) {
            for (value, shift) in values.iter_mut().zip(shift) {
                value.modulus += *size * shift;
            }
        }
        let beside = Misfit::of(&about, &removed).readings(sources.len());
        let values = Whitened::new(&values, &shifts, &beside);
        let projected = values.project().ok_or(CmodError::NoCausalEstimate)?;
        let moved = material.replace(projected.material.clone()).map(|before| {
            let moved = values.distance(&projected.material, &before);
            let sizes = removed.iter().zip(&projected.sizes);
            moved + sizes.map(|(a, b)| (a - b).powi(2)).sum::<f64>()
        });
        let is_at_rest = moved.is_some_and(|moved| moved <= AT_REST);
        removed = projected
            .sizes
            .iter()
            .copied()
            .take(measured.len())
            .collect();
        for (at, part) in parts.iter_mut().enumerate() {
            // errors of the specimen remain in the modulus about which the next round linearises
            let specimen = shifts.iter().zip(&projected.sizes).skip(measured.len());
            let errors = specimen.filter_map(|(shift, size)| Some(*size * shift.get(at)?));
            part.modulus = projected.material.at(part.place) + errors.sum::<Complex64>();
        }
        if is_at_rest || rounds == MOST_ROUNDS {
            let places = parts
                .iter()
                .map(|part| (part.line.index, part.line.frequency_hz));
            let sources = sources.into_iter();
            let estimate = CausalEstimate::judged(projected, &values, places, sources, scatter)?;
            return Ok(CausalEstimate {
                rounds,
                is_at_rest,
                ..estimate
            });
        }
    }
}

/// Returns the lines of `start` between the first and the last line that is valid in `judged`, and
/// the effect of the scatter of their variances. Lines with a coherence below the stated limit are
/// omitted; without a correction of lateral inertia, lines with too short a wavelength are also
/// omitted. The lines are linearised about the material nearest to the informative lines.
fn parts<'a>(
    experiment: &impl Experiment,
    start: &'a ModulusEstimate,
    (judged, inertia): (&ModulusEstimate, &[(usize, Inertia)]),
) -> Result<(Vec<Part<'a>>, VarianceScatter), CmodError> {
    let mut valid = judged.valid().map(|line| line.index);
    let first = valid.next().unwrap_or(usize::MAX);
    let last = valid.last().unwrap_or(first);
    let place = |line: &ModulusLine| {
        ComplexFrequency::new(line.frequency_hz, experiment.added_damping()).laplace()
    };
    let values: Vec<Value> = telling(start)
        .filter(|line| (first..=last).contains(&line.index))
        .map(|line| {
            let variance = line.uncertainty.random.modulus.mean_square();
            let inertia = nearest(inertia, line.index).unwrap_or(NO_INERTIA);
            Value::circular(place(line), inertia.factor * line.modulus, variance)
        })
        .collect();
    check_enough_readings(values.len(), FEWEST_LINES)?;
    let projected = Whitened::new(&values, &[], &[]).project();
    let material = projected.ok_or(CmodError::NoCausalEstimate)?.material;

    let spoils = |violation: &Violation| match violation {
        Violation::WavelengthTooShort { .. } => inertia.is_empty(),
        Violation::CoherenceTooLow { .. } => true,
        _ => false,
    };
    let mut scatters = Vec::new();
    let lines = start.lines().iter();
    let parts = lines
        .filter(|line| (first..=last).contains(&line.index))
        .filter(|line| !line.validity.violations().iter().any(spoils))
        .map(|line| {
            let scatter = VarianceScatter::of(line.uncertainty.degrees_of_freedom)?;
            scatters.push((scatter, 1));
            Ok(Part {
                line,
                place: place(line),
                factor: scatter.of_variance,
                inertia: nearest(inertia, line.index).unwrap_or(NO_INERTIA),
                modulus: material.at(place(line)),
            })
        })
        .collect::<Result<Vec<_>, CmodError>>()?;
    Ok((parts, VarianceScatter::mean(scatters.into_iter())))
}

/// Returns the effect of lateral inertia on the informative lines.
fn inertia_of_lines(corrected: &CorrectedEstimate) -> Vec<(usize, Inertia)> {
    let lines = corrected
        .modulus()
        .lines()
        .iter()
        .zip(corrected.corrections());
    let with_effect = lines.filter(|(line, _)| line.is_informative());
    with_effect
        .map(|(line, correction)| {
            let of_poisson = shift_of(&line.uncertainty.systematic, ErrorSource::PoissonRatio);
            let diameter_uncertainty = corrected.settings().diameter_uncertainty;
            let inertia = Inertia {
                factor: line.modulus / correction.apparent_modulus,
                by_poisson_ratio: of_poisson.modulus / line.modulus,
                by_diameter: correction.by_diameter * diameter_uncertainty / line.modulus,
            };
            (line.index, inertia)
        })
        .collect()
}
