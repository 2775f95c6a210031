//! The force assumed for undetermined components, from calibration blows.

use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, Side};
use num_complex::Complex64;

use super::grid::Support;
use super::mean_blow::MeanBlow;

/// Positions tried per sample.
const PLACES: i32 = 8;
/// Samples on either side of the best correlation in which positions are tried.
const REACH: i32 = 2;
/// Step of the derivatives with respect to the position, in samples.
const PLACE_STEP: f64 = 0.125;
/// Start values of the logarithm of the stretch.
const STRETCHES: [f64; 7] = [-0.36, -0.24, -0.12, 0.0, 0.12, 0.24, 0.36];
/// Step of the derivatives with respect to the logarithm of the stretch.
const STRETCH_STEP: f64 = 0.04;
/// Prior standard deviations of the logarithm of the size, of the position in samples, and of the
/// logarithm of the stretch. The first two are determined by any blow; durations of blows by one
/// hammer with different tips, hands and places differ by a third.
const SPREADS: [f64; 3] = [1.0, 4.0, 0.3];
/// Prior standard deviations of the exponent and of the skewness of a blow: from half sines over
/// triangles to versed sines the exponent changes by factors of 0.7 to 1.3; rise and fall differ by
/// a fifth of the half duration.
const DEFORMATIONS: [f64; 2] = [0.25, 0.2];
/// Part of the shape of a blow that neither calibration blows nor deformations describe, as a
/// fraction of the part that the deformations describe.
const REMAINDER: f64 = 0.4;
/// Number of variances s² of the shape that are tried, in half powers of ten from 1 down.
const VARIANCES: u8 = 15;
/// Number of alternating fits of blow and variance.
const ROUNDS: usize = 3;
/// Largest number of Gauss-Newton steps, and the change below which they end.
const STEPS: usize = 8;
const SETTLED: f64 = 1e-4;

/// Information of the responses on a component of the force.
pub(super) struct Told {
    pub(super) index: usize,
    pub(super) value: f64,
    /// Inverse of the variance of the value.
    pub(super) information: f64,
}

/// The shape of the calibration blows: their mean, the difference of each from the mean, and the
/// deformations by which blows of other tips, hands and places differ.
pub(super) struct CalibrationShape {
    mean: MeanBlow,
    differences: Vec<MeanBlow>,
    deformations: [MeanBlow; 2],
}

impl CalibrationShape {
    /// Creates the shape from the spectra of the mean and of the differences, for records of
    /// `n_samples` samples.
    pub(super) fn of(mean: &[Complex64], differences: &[Vec<Complex64>], n_samples: usize) -> Self {
        let mean = MeanBlow::of(mean, n_samples);
        let differences = differences.iter();
        Self {
            differences: differences.map(|one| mean.difference(one)).collect(),
            deformations: mean.deformations(),
            mean,
        }
    }
}

/// A blow like the calibration blows, and the precision with which it is assumed.
///
/// The force is $`f = a\,m((t-t_0)/T) + \sum_i c_i\,a\,d_i((t-t_0)/T) + d`$, with the mean
/// calibration blow m, the differences $`d_i`$ of the calibration blows from it, and its
/// derivatives with respect to exponent and skewness. The response determines size a, position t₀
/// and stretch T within wide priors; the $`c_i`$ of differences have the variance of one more blow,
/// those of the derivatives that of blows by other tips and hands. The remaining deviation d has
/// the covariance $`s^2 C`$, where C is the covariance of a force with the spectrum of the blows at
/// any of their durations. s² is its posterior mean given the components that the responses
/// determine, with a prior of ln s² that is flat from 10⁻⁷ to 1. If
/// the known part of a force is a calibration blow, the force is assumed to be such a blow beyond
/// the band too; if it has another shape, its part beyond the band is as uncertain as its shape is
/// different. The precision of all that is assumed,
///
/// ```math
/// (s^2 C + J B J^T)^{-1} = s^{-2}\left(C^{-1} - C^{-1}J\,(s^2 B^{-1} + J^T C^{-1} J)^{-1} J^T C^{-1}\right) ,
/// ```
///
/// with the derivatives J with respect to a, t₀, T and $`c_i`$ and the prior variances B of these
/// parameters, leaves the parameters to be determined by the responses.
pub(super) struct Supposed {
    pub(super) mean: Vec<f64>,
    pub(super) precision: Mat<f64>,
}

#[derive(Clone, Copy)]
struct Blow {
    size: f64,
    /// Position of the largest value in samples of the support.
    place: f64,
    /// Logarithm of the ratio of its duration to that of the mean blow.
    stretch: f64,
}

/// The variance s² of the shape given a blow, and the logarithm of the probability of both.
struct Shape {
    variance: f64,
    ln_probability: f64,
}

/// The determined values minus those of a blow, their derivatives with respect to its parameters,
/// and the prior precisions of the parameters.
struct Linearised {
    residual: Vec<f64>,
    columns: Vec<Vec<f64>>,
    precisions: Vec<f64>,
}

/// The determined components, and the transform from samples to components.
struct Problem<'a> {
    shape: &'a CalibrationShape,
    support: Support,
    dual: &'a Mat<f64>,
    told: &'a [Told],
}

/// Finds the blow that explains the values `told` best. `components` transforms components of a
/// force with the spectrum of the blows, of variance 1 each, to samples, and `dual` samples to
/// components; `spectrum` is the precision $`C^{-1}`$ of such a force. `None` if no blow explains
/// anything.
#[allow(
    clippy::indexing_slicing,
    reason = "components, derivatives and precision have an element for each sample of the support"
)]
pub(super) fn blow(
    shape: &CalibrationShape,
    support: Support,
    (components, dual): (&Mat<f64>, &Mat<f64>),
    told: &[Told],
    spectrum: &Mat<f64>,
) -> Option<Supposed> {
    let problem = Problem {
        shape,
        support,
        dual,
        told,
    };
    let (blow, variance) = problem.most_probable(components)?;
    let length = support.length;
    let derivatives = problem.derivatives(blow);
    let variance = variance.max(problem.beyond_deformation(blow, variance, &derivatives)?);
    let moved: Vec<Vec<f64>> = derivatives
        .iter()
        .map(|d| {
            let row = |i: usize| (0..length).map(move |j| spectrum[(i, j)] * d[j]).sum();
            (0..length).map(row).collect()
        })
        .collect();
    let precisions = problem.precisions();
    let count = precisions.len();
    let inner = Mat::from_fn(count, count, |i, j| {
        let pairs = derivatives[i].iter().zip(&moved[j]);
        let prior = if i == j {
            variance * precisions[i]
        } else {
            0.0
        };
        pairs.map(|(a, b)| a * b).sum::<f64>() + prior
    });
    let inverse = inner.llt(Side::Lower).ok()?.inverse();
    let moved = Mat::from_fn(length, count, |i, j| moved[j][i]);
    let open = &moved * inverse * moved.transpose();
    let precision = Mat::from_fn(length, length, |i, j| {
        (spectrum[(i, j)] - open[(i, j)]) / variance
    });
    Some(Supposed {
        mean: problem.samples(blow),
        precision,
    })
}

#[allow(
    clippy::indexing_slicing,
    reason = "columns of derivatives have an element for each of three parameters and each component"
)]
impl Problem<'_> {
    /// Returns the most probable blow of all starts, and the variance of its shape.
    fn most_probable(&self, components: &Mat<f64>) -> Option<(Blow, f64)> {
        let weights = self.weights(1.0);
        let force: Vec<f64> = (0..self.support.length)
            .map(|i| {
                let terms = self.told.iter().zip(&weights);
                terms
                    .map(|(told, w)| w * told.value * components[(i, told.index)])
                    .sum()
            })
            .collect();
        let of_unit = |place: f64, stretch: f64| Blow {
            size: 1.0,
            place,
            stretch,
        };
        let correlation = |place: f64| -> f64 {
            let samples = self.samples(of_unit(place, 0.0));
            samples.iter().zip(&force).map(|(m, f)| m * f).sum()
        };
        let last = i32::try_from(self.support.length).unwrap_or(i32::MAX / PLACES) * PLACES;
        let (_, about) = (0..last)
            .map(|n| f64::from(n) / f64::from(PLACES))
            .map(|place| (correlation(place), place))
            .max_by(|(a, _), (b, _)| a.total_cmp(b))?;
        let near = -REACH * PLACES..=REACH * PLACES;
        let near = near.map(|n| about + f64::from(n) / f64::from(PLACES));
        let from = |stretch: f64| -> Option<(Blow, Shape)> {
            let sized = near
                .clone()
                .map(|place| self.sized(of_unit(place, stretch), &weights));
            let (_, start) = sized.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
            let mut blow = Some(start).filter(Blow::is_blow)?;
            for _ in 0..ROUNDS {
                let Shape { variance, .. } = self.shape(blow)?;
                blow = self.refined(blow, variance).filter(Blow::is_blow)?;
            }
            let shape = self.shape(blow)?;
            shape.ln_probability.is_finite().then_some((blow, shape))
        };
        let all = STRETCHES.into_iter().filter_map(from);
        let (blow, shape) =
            all.max_by(|(_, a), (_, b)| a.ln_probability.total_cmp(&b.ln_probability))?;
        Some((blow, shape.variance))
    }

    /// Returns the least variance of the shape of a blow that differs from the calibration blows as
    /// far as the determined components show: a blow that differs to first order also differs
    /// beyond first order.
    fn beyond_deformation(
        &self,
        blow: Blow,
        variance: f64,
        derivatives: &[Vec<f64>],
    ) -> Option<f64> {
        let (matrix, side) = self
            .linearised(blow)
            .normal_equations(&self.weights(variance));
        let parts = matrix.llt(Side::Lower).ok()?.solve(&side);
        let of_shape = || derivatives.iter().enumerate().skip(SPREADS.len());
        let deformed = (0..self.support.length)
            .map(|at| of_shape().map(|(k, d)| parts[(k, 0)] * d[at]).sum::<f64>());
        let square: f64 = deformed.map(|x| x * x).sum();
        let whole: f64 = self.samples(blow).iter().map(|x| x * x).sum();
        Some(REMAINDER.powi(2) * square / whole)
    }

    fn samples(&self, blow: Blow) -> Vec<f64> {
        self.samples_of(&self.shape.mean, blow)
    }

    fn samples_of(&self, shape: &MeanBlow, blow: Blow) -> Vec<f64> {
        let Support { first, length } = self.support;
        let peak = first as f64 + blow.place;
        let mut samples = shape.samples((first, length), peak, blow.stretch.exp());
        samples.iter_mut().for_each(|m| *m *= blow.size);
        samples
    }

    fn components(&self, samples: &[f64]) -> Vec<f64> {
        let of = |told: &Told| {
            let terms = samples.iter().enumerate();
            terms.map(|(i, m)| self.dual[(i, told.index)] * m).sum()
        };
        self.told.iter().map(of).collect()
    }

    /// Returns the determined values minus those of a blow.
    fn residual(&self, blow: Blow) -> Vec<f64> {
        let told = self.told.iter().zip(self.components(&self.samples(blow)));
        told.map(|(told, own)| told.value - own).collect()
    }

    /// Returns the precisions of the values for a variance of the shape.
    fn weights(&self, variance: f64) -> Vec<f64> {
        let of = |told: &Told| told.information / (1.0 + variance * told.information);
        self.told.iter().map(of).collect()
    }

    /// Returns the reduction of the sum of squares by the `unit` blow at its best size, and this
    /// blow.
    fn sized(&self, unit: Blow, weights: &[f64]) -> (f64, Blow) {
        let (mut along, mut square) = (0.0, 0.0);
        let components = self.components(&self.samples(unit));
        for ((told, m), w) in self.told.iter().zip(components).zip(weights) {
            along += w * m * told.value;
            square += w * m * m;
        }
        let size = along / square;
        (along * along.max(0.0) / square, Blow { size, ..unit })
    }

    /// Returns the derivatives of the samples with respect to the logarithm of the size, the place,
    /// the logarithm of the stretch, the parts of the differences of the shape, and its
    /// deformations.
    fn derivatives(&self, blow: Blow) -> Vec<Vec<f64>> {
        let by = |step: f64, change: &dyn Fn(f64) -> Blow| -> Vec<f64> {
            let (ahead, behind) = (self.samples(change(step)), self.samples(change(-step)));
            let pairs = ahead.iter().zip(&behind);
            pairs.map(|(a, b)| (a - b) / (2.0 * step)).collect()
        };
        let of_blow = [
            self.samples(blow),
            by(PLACE_STEP, &|step| Blow {
                place: blow.place + step,
                ..blow
            }),
            by(STRETCH_STEP, &|step| Blow {
                stretch: blow.stretch + step,
                ..blow
            }),
        ];
        let CalibrationShape {
            differences,
            deformations,
            ..
        } = self.shape;
        let of_shape = differences.iter().chain(deformations);
        let of_shape = of_shape.map(|shape| self.samples_of(shape, blow));
        of_blow.into_iter().chain(of_shape).collect()
    }

    /// Returns the inverse prior variances of the parameters of [`Self::derivatives`]. The
    /// covariance of `n` differences is known with n - 1 degrees of freedom.
    fn precisions(&self) -> Vec<f64> {
        let n = self.shape.differences.len() as f64;
        let of_difference = (n - 3.0).max(1.0) * n / (n + 1.0);
        let of_blow = SPREADS.map(|spread| spread.powi(-2));
        let of_shape = self.shape.differences.iter().map(|_| of_difference);
        let of_deformation = DEFORMATIONS.map(|spread| spread.powi(-2));
        let all = of_blow.into_iter().chain(of_shape);
        all.chain(of_deformation).collect()
    }

    /// Linearises the determined components about a blow.
    fn linearised(&self, blow: Blow) -> Linearised {
        let derivatives = self.derivatives(blow);
        Linearised {
            residual: self.residual(blow),
            columns: derivatives.iter().map(|d| self.components(d)).collect(),
            precisions: self.precisions(),
        }
    }

    /// Finds the most probable blow near `start` for a variance of the shape, by Gauss-Newton
    /// steps.
    fn refined(&self, start: Blow, variance: f64) -> Option<Blow> {
        let weights = self.weights(variance);
        let mut blow = start;
        for _ in 0..STEPS {
            let (matrix, mut side) = self.linearised(blow).normal_equations(&weights);
            side[(2, 0)] -= blow.stretch * SPREADS[2].powi(-2);
            let step = matrix.llt(Side::Lower).ok()?.solve(&side);
            let [size, place, stretch] = [(0, 0.5), (1, 0.5), (2, 0.1)]
                .map(|(i, most): (usize, f64)| step[(i, 0)].clamp(-most, most));
            blow = Blow {
                size: blow.size * (1.0 + size),
                place: blow.place + place,
                stretch: blow.stretch + stretch,
            };
            if [size, place, stretch].iter().all(|s| s.abs() < SETTLED) {
                break;
            }
        }
        Some(blow)
    }

    /// Finds the shape given a blow, from the likelihood of the determined components with
    /// covariance $`s^2 + 1/\kappa + J B J^T`$ for every s².
    fn shape(&self, blow: Blow) -> Option<Shape> {
        let linearised = self.linearised(blow);
        let of_stretch = 0.5 * (blow.stretch / SPREADS[2]).powi(2);
        let mut all = Vec::with_capacity(usize::from(VARIANCES));
        for step in 0..VARIANCES {
            let variance = 10.0_f64.powf(-0.5 * f64::from(step));
            let weights = self.weights(variance);
            let (matrix, side) = linearised.normal_equations(&weights);
            let factor = matrix.llt(Side::Lower).ok()?;
            let solved = factor.solve(&side);
            let count = side.nrows();
            let explained: f64 = (0..count).map(|i| side[(i, 0)] * solved[(i, 0)]).sum();
            let pairs = linearised.residual.iter().zip(&weights);
            let square: f64 = pairs.map(|(r, w)| w * r * r).sum();
            // determined components have information: their precisions are above zero
            let ln_determinant = (0..count)
                .map(|i| 2.0 * factor.L()[(i, i)].ln())
                .sum::<f64>()
                - weights.iter().map(|w| w.ln()).sum::<f64>();
            let ln = -0.5 * (square - explained + ln_determinant) - of_stretch;
            all.push((variance, ln));
        }
        let largest = all
            .iter()
            .fold(f64::NEG_INFINITY, |top, (_, ln)| top.max(*ln));
        let (mut sum, mut weighted) = (0.0, 0.0);
        for (variance, ln) in all {
            let weight = (ln - largest).exp();
            sum += weight;
            weighted += weight * variance;
        }
        Some(Shape {
            variance: weighted / sum,
            ln_probability: largest + sum.ln(),
        })
    }
}

#[allow(
    clippy::indexing_slicing,
    reason = "there is a precision for each column, and `i` and `j` are indices of columns"
)]
impl Linearised {
    /// Returns $`J^T W J + B^{-1}`$ and $`J^T W r`$ of the determined components.
    fn normal_equations(&self, weights: &[f64]) -> (Mat<f64>, Mat<f64>) {
        let columns = &self.columns;
        let sum = |a: &[f64], b: &[f64]| -> f64 {
            let terms = a.iter().zip(b).zip(weights);
            terms.map(|((a, b), w)| w * a * b).sum()
        };
        let count = columns.len();
        let matrix = Mat::from_fn(count, count, |i, j| {
            let prior = if i == j { self.precisions[i] } else { 0.0 };
            sum(&columns[i], &columns[j]) + prior
        });
        let side = Mat::from_fn(count, 1, |i, _| sum(&columns[i], &self.residual));
        (matrix, side)
    }
}

impl Blow {
    fn is_blow(&self) -> bool {
        self.size.is_finite() && self.size > 0.0
    }
}
