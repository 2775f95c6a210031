//! Data of a fit: moduli over frequency or time with their covariances.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::count;
use super::transient::{Lines, Reading};
use crate::error::{CmodError, check_length, check_positive, check_that};
use crate::estimate::{ComplexCovariance, ErrorSource, ModulusEstimate, ModulusLine};

/// Degrees of freedom of an estimated variance at or below which the weight of a line has infinite
/// variance.
const FEWEST_DEGREES_OF_FREEDOM: f64 = 4.0;

/// Measured complex modulus at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModulusPoint {
    /// Frequency \[Hz\], above 0.
    pub frequency_hz: f64,
    /// Complex modulus E = E' + iE'' \[Pa\].
    pub modulus: Complex64,
    /// Covariance of E' and E'' \[Pa²\], for errors that are independent from point to point. It
    /// must be positive definite.
    pub covariance: ComplexCovariance,
}

impl ModulusPoint {
    /// Creates a point with a circular error: the same `standard_error` \[Pa\] for E' and E'',
    /// which are uncorrelated.
    #[must_use]
    pub fn circular(frequency_hz: f64, modulus: Complex64, standard_error: f64) -> Self {
        Self {
            frequency_hz,
            modulus,
            covariance: ComplexCovariance::circular(2.0 * standard_error * standard_error),
        }
    }
}

/// Error of one source that all points share: if the source is wrong by its standard uncertainty,
/// each modulus is wrong by the shift of its point.
#[derive(Debug, Clone, PartialEq)]
pub struct CommonError {
    /// Source of the error.
    pub source: ErrorSource,
    /// Shifts δE \[Pa\], one per point.
    pub shift: Vec<Complex64>,
}

/// Checked points of increasing frequency, or decreasing time, with the matrices that make their
/// errors independent and of unit variance, and with the errors that the points share.
///
/// With δ = E - E_law and C the covariance of a point, the whitened residual is W (Re δ, Im δ) with
/// WᵀW = C⁻¹ and W lower triangular.
#[derive(Debug, Clone, PartialEq)]
pub struct ModulusData {
    /// Angular frequencies [rad/s], or inverse times [1/s].
    pub(super) omega: Vec<f64>,
    pub(super) readings: Vec<Reading>,
    pub(super) modulus: Vec<Complex64>,
    pub(super) whitening: Vec<Whitening>,
    pub(super) common: Vec<CommonError>,
    pub(super) scatter: VarianceScatter,
}

/// Effect of the scatter of estimated variances on a fit that uses them as weights. The factors are
/// means over the lines, and are 1 if the variances are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct VarianceScatter {
    /// Factor of the variance of a line, ν/(ν - 2), which the points already include.
    pub(crate) of_variance: f64,
    /// Factor of the covariance of the parameters, (ν - 2)/(ν - 4).
    pub(crate) of_covariance: f64,
    /// Factor of the variance of χ², ν/(ν - 4).
    pub(crate) of_chi_squared: f64,
}

impl VarianceScatter {
    pub(super) const NONE: Self = Self {
        of_variance: 1.0,
        of_covariance: 1.0,
        of_chi_squared: 1.0,
    };

    /// Returns the factors for a variance with `degrees_of_freedom` ν; `None` for a known variance.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for 4 degrees of freedom or fewer: weighted sums then have no
    /// finite variance.
    pub(crate) fn of(degrees_of_freedom: Option<f64>) -> Result<Self, CmodError> {
        let Some(freedom) = degrees_of_freedom.filter(|freedom| freedom.is_finite()) else {
            return Ok(Self::NONE);
        };
        let is_enough = freedom > FEWEST_DEGREES_OF_FREEDOM;
        let quantity = "degrees of freedom of the variance of a line";
        let expected =
            "more than 4, from four hits or more: a fit weights lines by their variances";
        check_that(is_enough, quantity, freedom, expected)?;
        Ok(Self {
            of_variance: freedom / (freedom - 2.0),
            of_covariance: (freedom - 2.0) / (freedom - 4.0),
            of_chi_squared: freedom / (freedom - 4.0),
        })
    }

    /// Returns the mean of the factors of several parts, weighted by their numbers of lines.
    pub(crate) fn mean(parts: impl Iterator<Item = (Self, usize)>) -> Self {
        let (mut sum, mut lines) = ([0.0; 3], 0.0);
        for (own, own_lines) in parts {
            sum[0] += own.of_covariance * count(own_lines);
            sum[1] += own.of_chi_squared * count(own_lines);
            sum[2] += own.of_variance * count(own_lines);
            lines += count(own_lines);
        }
        Self {
            of_covariance: sum[0] / lines,
            of_chi_squared: sum[1] / lines,
            of_variance: sum[2] / lines,
        }
    }
}

/// Lower triangular whitening matrix W of one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Whitening {
    pub(super) storage: f64,
    pub(super) mixed: f64,
    pub(super) loss: f64,
}

impl Whitening {
    fn of(point: &ModulusPoint) -> Self {
        let ComplexCovariance {
            real,
            imaginary,
            mixed,
        } = point.covariance;
        let storage = real.sqrt().recip();
        let slope = mixed / real;
        let loss = (imaginary - slope * mixed).sqrt().recip();
        Self {
            storage,
            mixed: -slope * loss,
            loss,
        }
    }

    pub(super) fn apply(&self, delta: Complex64) -> [f64; 2] {
        [
            self.storage * delta.re,
            self.mixed * delta.re + self.loss * delta.im,
        ]
    }

    /// Returns the error whose whitened components are `parts`.
    fn unwhitened(&self, [first, second]: [f64; 2]) -> Complex64 {
        let storage = first / self.storage;
        if self.loss <= 0.0 {
            return storage.into();
        }
        Complex64::new(storage, (second - self.mixed * storage) / self.loss)
    }

    /// Returns the whitening of a real modulus, in which the loss modulus has no weight.
    pub(super) fn of_real(standard_error: f64) -> Self {
        Self {
            storage: standard_error.recip(),
            mixed: 0.0,
            loss: 0.0,
        }
    }

    /// Returns the variance of E', the covariance, and the variance of E'' \[Pa²\]; the last is
    /// infinite if the modulus is real.
    pub(super) fn covariance(self) -> [f64; 3] {
        if self.loss <= 0.0 {
            return [self.storage.powi(-2), 0.0, f64::INFINITY];
        }
        let storage = self.storage.recip();
        // W⁻¹ by rows: (1/s, 0), (-m/(sl), 1/l)
        let mixed = -self.mixed * storage / self.loss;
        let loss = self.loss.recip();
        [
            storage * storage,
            storage * mixed,
            mixed * mixed + loss * loss,
        ]
    }

    /// Returns the whitening for moduli that are `factor` times as large.
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            storage: self.storage / factor,
            mixed: self.mixed / factor,
            loss: self.loss / factor,
        }
    }
}

impl ModulusData {
    /// Creates the data from `points`, and checks them.
    ///
    /// # Errors
    /// [`CmodError::NoLines`]; [`CmodError::ModulusPoint`] unless every frequency is finite and
    /// above 0, every modulus is finite, and every covariance matrix is positive definite;
    /// [`CmodError::FrequencyOrder`] unless the frequencies increase.
    pub fn new(points: &[ModulusPoint]) -> Result<Self, CmodError> {
        if points.is_empty() {
            return Err(CmodError::NoLines);
        }
        let mut previous: Option<f64> = None;
        for (index, point) in points.iter().enumerate() {
            check_point(index, point)?;
            if let Some(previous_hz) = previous
                && point.frequency_hz <= previous_hz
            {
                return Err(CmodError::FrequencyOrder {
                    index,
                    frequency_hz: point.frequency_hz,
                    previous_hz,
                });
            }
            previous = Some(point.frequency_hz);
        }
        Ok(Self {
            omega: points
                .iter()
                .map(|point| TAU * point.frequency_hz)
                .collect(),
            readings: vec![Reading::Oscillation; points.len()],
            modulus: points.iter().map(|point| point.modulus).collect(),
            whitening: points.iter().map(Whitening::of).collect(),
            common: Vec::new(),
            scatter: VarianceScatter::NONE,
        })
    }

    /// Adds the errors that the points share, one per source. The sources are independent of each
    /// other.
    ///
    /// These errors do not affect the weights of a fit, the fitted parameters or χ². The covariance
    /// of the parameters becomes `C_random + Σ_s g_s g_sᵀ`, where g_s is the change of the
    /// parameters due to the shift of source s.
    ///
    /// # Errors
    /// [`CmodError::LengthMismatch`] unless there is one shift per point;
    /// [`CmodError::ModulusPoint`] unless all shifts are finite.
    pub fn with_common_errors(mut self, common: Vec<CommonError>) -> Result<Self, CmodError> {
        for error in &common {
            check_length("common error", error.shift.len(), self.len())?;
            if let Some((index, shift)) = error
                .shift
                .iter()
                .enumerate()
                .find(|(_, shift)| !shift.is_finite())
            {
                return Err(CmodError::ModulusPoint {
                    index,
                    quantity: "common error of the modulus [Pa]",
                    value: if shift.re.is_finite() {
                        shift.im
                    } else {
                        shift.re
                    },
                    expected: "a finite value",
                });
            }
        }
        self.common = common;
        Ok(self)
    }

    /// Creates the data from the valid lines of an estimate, with the covariance of their random
    /// errors and their common errors.
    ///
    /// # Errors
    /// The errors of [`Self::from_lines`]; [`CmodError::NoLines`] if no line is valid.
    pub fn from_estimate(estimate: &ModulusEstimate) -> Result<Self, CmodError> {
        Self::from_lines(estimate.valid())
    }

    /// Creates the data from lines of an estimate, with the covariance of their random errors and
    /// their common errors. A density that is wrong by 1 % makes every line wrong by 1 %. Such an
    /// error does not affect the weight of a line, but is an error of the law.
    ///
    /// A variance estimated with ν degrees of freedom scatters, and so does the weight of its line.
    /// The mean of 1/s² is ν/(ν - 2) times 1/σ². The variances are multiplied by this factor, so
    /// that the mean of χ² is the same as for known variances. The effect of the scatter of the
    /// weights is included in the errors of the parameters and in the distribution of χ²
    /// ([`RheologicalFit`](super::RheologicalFit)).
    ///
    /// # Errors
    /// The errors of [`Self::new`]. Lines without a random error are refused, because they would
    /// have infinite weight. [`CmodError::NonPhysical`] if a variance has 4 degrees of freedom or
    /// fewer, for example from three hits: weighted sums then have no finite variance.
    pub fn from_lines<'a>(
        lines: impl IntoIterator<Item = &'a ModulusLine>,
    ) -> Result<Self, CmodError> {
        let lines: Vec<&ModulusLine> = lines.into_iter().collect();
        let scatter: Vec<VarianceScatter> = lines
            .iter()
            .map(|line| VarianceScatter::of(line.uncertainty.degrees_of_freedom))
            .collect::<Result<_, _>>()?;
        let points: Vec<ModulusPoint> = lines
            .iter()
            .zip(&scatter)
            .map(|(line, scatter)| {
                let covariance = line.uncertainty.random.modulus;
                let inflation = scatter.of_variance;
                ModulusPoint {
                    frequency_hz: line.frequency_hz,
                    modulus: line.modulus,
                    covariance: ComplexCovariance {
                        real: inflation * covariance.real,
                        imaginary: inflation * covariance.imaginary,
                        mixed: inflation * covariance.mixed,
                    },
                }
            })
            .collect();
        let mut common: Vec<CommonError> = Vec::new();
        for (index, line) in lines.iter().enumerate() {
            for shift in &line.uncertainty.systematic {
                add_shift(&mut common, shift.source, lines.len(), index, shift.modulus);
            }
        }
        let mut data = Self::new(&points)?;
        data.scatter = VarianceScatter::mean(scatter.into_iter().map(|scatter| (scatter, 1)));
        data.with_common_errors(common)
    }

    /// Adds a further random error to moduli that already contain a random error drawn from their
    /// estimated variances; `normal` supplies standard normal numbers. Laws fitted to the resulting
    /// moduli scatter by their stated random errors, which include the effect of the scatter of the
    /// estimated variances.
    #[must_use]
    pub fn with_scatter_of_weights(mut self, mut normal: impl FnMut() -> f64) -> Self {
        let part = self.scatter.of_covariance - 1.0 / self.scatter.of_variance;
        let factor = part.max(0.0).sqrt();
        for (modulus, whitening) in self.modulus.iter_mut().zip(&self.whitening) {
            *modulus += factor * whitening.unwhitened([normal(), normal()]);
        }
        self
    }

    /// Returns the whitened shift due to one of the common errors.
    pub(super) fn whitened_shift(&self, source: usize) -> Vec<f64> {
        let shift = self
            .common
            .get(source)
            .map_or(&[][..], |error| &error.shift);
        let lines = self.whitening.iter().zip(shift);
        lines
            .flat_map(|(whitening, shift)| whitening.apply(*shift))
            .collect()
    }

    /// Returns the errors that the points share.
    #[must_use]
    pub fn common_errors(&self) -> &[CommonError] {
        &self.common
    }

    /// Returns the rows of the whitening matrix W of every point.
    pub(crate) fn whitening_rows(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        let rows = |w: &Whitening| [[w.storage, 0.0], [w.mixed, w.loss]];
        self.whitening.iter().map(rows)
    }

    /// Returns the effect of the scatter of estimated variances.
    pub(crate) fn scatter(&self) -> VarianceScatter {
        self.scatter
    }

    /// Returns the number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.omega.len()
    }

    /// Returns false, because [`Self::new`] refuses data without points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.omega.is_empty()
    }

    /// Returns the number of measured values: two per line for data over frequency, one per point
    /// for data over time.
    pub(super) fn values(&self) -> usize {
        let real = self.readings.iter().filter(|reading| reading.is_real());
        2 * self.len() - real.count()
    }

    /// Returns the lines at which laws are evaluated.
    pub(super) fn lines(&self) -> Lines<'_> {
        Lines::new(&self.omega, &self.readings)
    }

    /// Returns the angular frequencies [rad/s], or the inverse times of data
    /// [over time](Self::over_time) [1/s].
    #[must_use]
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Returns the moduli \[Pa\].
    #[must_use]
    pub fn modulus(&self) -> &[Complex64] {
        &self.modulus
    }

    /// Returns the geometric mean of the lowest and the highest frequency \[Hz\].
    #[must_use]
    pub fn middle_frequency_hz(&self) -> f64 {
        let (lowest, highest) = self.band();
        (lowest * highest).sqrt() / TAU
    }

    /// Returns the lowest and the highest frequency \[Hz\].
    #[must_use]
    pub fn band_hz(&self) -> [f64; 2] {
        let (lowest, highest) = self.band();
        [lowest / TAU, highest / TAU]
    }

    pub(super) fn band(&self) -> (f64, f64) {
        let fold = |start, pick: fn(f64, f64) -> f64| self.omega.iter().copied().fold(start, pick);
        (fold(f64::INFINITY, f64::min), fold(0.0, f64::max))
    }

    /// Sorts the lines by frequency.
    pub(super) fn in_order(self) -> Self {
        let mut order: Vec<usize> = (0..self.len()).collect();
        let omega = |line: &usize| self.omega.get(*line).copied().unwrap_or(0.0);
        order.sort_by(|a, b| omega(a).total_cmp(&omega(b)));
        self.picked(&order)
    }

    /// Returns the lines with the indices in `order`, in this order.
    pub(super) fn picked(&self, order: &[usize]) -> Self {
        fn picked<T: Copy>(values: &[T], order: &[usize]) -> Vec<T> {
            let of = |line: &usize| values.get(*line).copied();
            order.iter().filter_map(of).collect()
        }
        let common = self.common.iter().map(|error| CommonError {
            source: error.source,
            shift: picked(&error.shift, order),
        });
        Self {
            omega: picked(&self.omega, order),
            readings: picked(&self.readings, order),
            modulus: picked(&self.modulus, order),
            whitening: picked(&self.whitening, order),
            common: common.collect(),
            scatter: self.scatter,
        }
    }

    /// Concatenates the lines of several data sets, with the moduli of each set divided by its
    /// factor. A source is treated as the same error in all sets, because the specimen is the same.
    pub(super) fn joined<'a>(parts: impl Iterator<Item = (&'a Self, f64)>) -> Self {
        let mut all = Self {
            omega: Vec::new(),
            readings: Vec::new(),
            modulus: Vec::new(),
            whitening: Vec::new(),
            common: Vec::new(),
            scatter: VarianceScatter::NONE,
        };
        let parts: Vec<(&Self, f64)> = parts.collect();
        all.scatter =
            VarianceScatter::mean(parts.iter().map(|(part, _)| (part.scatter, part.len())));
        let lines = parts.iter().map(|(part, _)| part.len()).sum();
        for (part, factor) in parts {
            let first = all.len();
            for error in &part.common {
                for (line, shift) in error.shift.iter().enumerate() {
                    add_shift(
                        &mut all.common,
                        error.source,
                        lines,
                        first + line,
                        shift / factor,
                    );
                }
            }
            all.omega.extend_from_slice(&part.omega);
            all.readings.extend_from_slice(&part.readings);
            let moduli = part.modulus.iter().map(|modulus| modulus / factor);
            all.modulus.extend(moduli);
            let whitening = part.whitening.iter().map(|w| w.scaled(factor.recip()));
            all.whitening.extend(whitening);
        }
        all
    }
}

/// Adds the `shift` of the line `index` to the error of `source`, which is created with 0 on all
/// `lines` lines if it is not in the list.
fn add_shift(
    common: &mut Vec<CommonError>,
    source: ErrorSource,
    lines: usize,
    index: usize,
    shift: Complex64,
) {
    if !common.iter().any(|error| error.source == source) {
        common.push(CommonError {
            source,
            shift: vec![Complex64::ZERO; lines],
        });
    }
    let own = common.iter_mut().find(|error| error.source == source);
    if let Some(sum) = own.and_then(|error| error.shift.get_mut(index)) {
        *sum += shift;
    }
}

fn check_point(index: usize, point: &ModulusPoint) -> Result<(), CmodError> {
    let refused = |quantity, value, expected| {
        Err(CmodError::ModulusPoint {
            index,
            quantity,
            value,
            expected,
        })
    };
    if check_positive("frequency [Hz]", point.frequency_hz).is_err() {
        return refused(
            "frequency [Hz]",
            point.frequency_hz,
            "a finite value above 0",
        );
    }
    let omega = TAU * point.frequency_hz;
    // relaxation times are of the order of the inverse of the angular frequency
    if !(omega.is_finite() && omega.recip().is_finite()) {
        return refused(
            "frequency [Hz]",
            point.frequency_hz,
            "a value whose angular frequency and its inverse are finite",
        );
    }
    for (quantity, value) in [
        ("storage modulus [Pa]", point.modulus.re),
        ("loss modulus [Pa]", point.modulus.im),
    ] {
        if !value.is_finite() {
            return refused(quantity, value, "a finite value");
        }
    }
    let ComplexCovariance {
        real,
        imaginary,
        mixed,
    } = point.covariance;
    for (quantity, value) in [
        ("variance of the storage modulus [Pa^2]", real),
        ("variance of the loss modulus [Pa^2]", imaginary),
    ] {
        // the weight is the reciprocal of the square root
        if !(value.is_finite() && value > 0.0 && value.sqrt().recip().is_finite()) {
            return refused(quantity, value, "a finite value above 0");
        }
    }
    let correlation = mixed / real.sqrt() / imaginary.sqrt();
    let whitening = Whitening::of(point);
    let has_weights = whitening.mixed.is_finite() && whitening.loss.is_finite();
    // if the correlation equals 1 within rounding, the weight is not finite
    if !(correlation.is_finite() && correlation.abs() < 1.0 && has_weights) {
        return refused(
            "correlation of storage and loss modulus",
            correlation,
            "a value between -1 and 1",
        );
    }
    Ok(())
}
