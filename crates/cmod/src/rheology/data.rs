//! What a law is fitted to: moduli over frequency with their covariances.

use num_complex::Complex64;

use crate::error::{CmodError, check_length, check_positive};
use crate::estimate::{ComplexCovariance, ErrorSource, ModulusEstimate, ModulusLine};

/// A measured complex modulus at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModulusPoint {
    /// Frequency \[Hz\], above 0.
    pub frequency_hz: f64,
    /// Complex modulus E = E' + iE'' \[Pa\].
    pub modulus: Complex64,
    /// Covariance of E' and E'' \[Pa²\], positive definite, of errors that are independent from point to point.
    pub covariance: ComplexCovariance,
}

impl ModulusPoint {
    /// A point whose error is circular: `standard_error` \[Pa\] of E' and of E'' each, without correlation.
    #[must_use]
    pub fn circular(frequency_hz: f64, modulus: Complex64, standard_error: f64) -> Self {
        Self {
            frequency_hz,
            modulus,
            covariance: ComplexCovariance::circular(2.0 * standard_error * standard_error),
        }
    }
}

/// An error of one source that all points share: if the source is wrong by its standard uncertainty, every modulus is wrong by its
/// shift.
#[derive(Debug, Clone, PartialEq)]
pub struct CommonError {
    /// The source.
    pub source: ErrorSource,
    /// δE \[Pa\], one for each point.
    pub shift: Vec<Complex64>,
}

/// Points of increasing frequency, checked, with the matrices that make their errors independent and of unit variance, and the
/// errors that the points share.
///
/// With δ = E - E_law and C the covariance of a point, the whitened residual is W (Re δ, Im δ) with WᵀW = C⁻¹, W lower
/// triangular.
#[derive(Debug, Clone, PartialEq)]
pub struct ModulusData {
    pub(super) omega: Vec<f64>,
    pub(super) modulus: Vec<Complex64>,
    pub(super) whitening: Vec<Whitening>,
    pub(super) common: Vec<CommonError>,
}

/// Lower triangular W of one point.
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

    /// The same for moduli that are `factor` times as large.
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            storage: self.storage / factor,
            mixed: self.mixed / factor,
            loss: self.loss / factor,
        }
    }
}

impl ModulusData {
    /// Checks `points`.
    ///
    /// # Errors
    /// [`CmodError::NoLines`]; [`CmodError::ModulusPoint`] unless every frequency is finite and above 0, every modulus
    /// finite, and every covariance matrix positive definite; [`CmodError::FrequencyOrder`] unless the frequencies increase.
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
                .map(|point| std::f64::consts::TAU * point.frequency_hz)
                .collect(),
            modulus: points.iter().map(|point| point.modulus).collect(),
            whitening: points.iter().map(Whitening::of).collect(),
            common: Vec::new(),
        })
    }

    /// Adds the errors that the points share, independent of each other and one for each source.
    ///
    /// They have no influence on the weights of a fit, on the law at the minimum and on χ²: the covariance of the parameters is
    /// `C_random + Σ_s g_s g_sᵀ` with g_s the change of the parameters by the shift of source s.
    ///
    /// # Errors
    /// [`CmodError::LengthMismatch`] unless there is a shift for each point; [`CmodError::ModulusPoint`] unless all are finite.
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

    /// The valid lines of an estimate, with the covariance of their random errors and their common errors.
    ///
    /// # Errors
    /// As [`Self::from_lines`]; [`CmodError::NoLines`] if no line is valid.
    pub fn from_estimate(estimate: &ModulusEstimate) -> Result<Self, CmodError> {
        Self::from_lines(estimate.valid())
    }

    /// Lines of an estimate, with the covariance of their random errors and their common errors. A density that is wrong by 1 %
    /// makes every line wrong by 1 %: it is no weight of a line, but an error of the law.
    ///
    /// # Errors
    /// As [`Self::new`]. Lines without a random error would have infinite weight and are refused.
    pub fn from_lines<'a>(
        lines: impl IntoIterator<Item = &'a ModulusLine>,
    ) -> Result<Self, CmodError> {
        let lines: Vec<&ModulusLine> = lines.into_iter().collect();
        let points: Vec<_> = lines
            .iter()
            .map(|line| ModulusPoint {
                frequency_hz: line.frequency_hz,
                modulus: line.modulus,
                covariance: line.uncertainty.random.modulus,
            })
            .collect();
        let mut common: Vec<CommonError> = Vec::new();
        for (index, line) in lines.iter().enumerate() {
            for shift in &line.uncertainty.systematic {
                add_shift(
                    &mut common,
                    shift.source,
                    lines.len(),
                    index,
                    shift.modulus,
                );
            }
        }
        Self::new(&points)?.with_common_errors(common)
    }

    /// The errors that the points share.
    #[must_use]
    pub fn common_errors(&self) -> &[CommonError] {
        &self.common
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.omega.len()
    }

    /// Always false: data without points are an error.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.omega.is_empty()
    }

    /// Angular frequencies [rad/s].
    #[must_use]
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Moduli \[Pa\].
    #[must_use]
    pub fn modulus(&self) -> &[Complex64] {
        &self.modulus
    }

    /// Lowest and highest angular frequency [rad/s].
    pub(super) fn band(&self) -> (f64, f64) {
        let fold = |start, pick: fn(f64, f64) -> f64| self.omega.iter().copied().fold(start, pick);
        (fold(f64::INFINITY, f64::min), fold(0.0, f64::max))
    }

    /// All lines of several data one after the other, in units where their moduli are divided by `factors`. One source is one error
    /// for all of them: it is the same specimen.
    pub(super) fn joined<'a>(parts: impl Iterator<Item = (&'a Self, f64)>) -> Self {
        let mut all = Self {
            omega: Vec::new(),
            modulus: Vec::new(),
            whitening: Vec::new(),
            common: Vec::new(),
        };
        let parts: Vec<(&Self, f64)> = parts.collect();
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
            let moduli = part.modulus.iter().map(|modulus| modulus / factor);
            all.modulus.extend(moduli);
            let whitening = part.whitening.iter().map(|w| w.scaled(factor.recip()));
            all.whitening.extend(whitening);
        }
        all
    }
}

/// Adds the `shift` of one of so many `lines` to the error of its `source`, which begins with none on all lines.
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
    let omega = std::f64::consts::TAU * point.frequency_hz;
    // a relaxation time is of the size of the inverse
    if !(omega.is_finite() && omega.recip().is_finite()) {
        return refused(
            "frequency [Hz]",
            point.frequency_hz,
            "a value whose angular frequency is finite, and its inverse too",
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
        // the reciprocal of a root is the weight
        if !(value.is_finite() && value > 0.0 && value.sqrt().recip().is_finite()) {
            return refused(quantity, value, "a finite value above 0");
        }
    }
    let correlation = mixed / real.sqrt() / imaginary.sqrt();
    let whitening = Whitening::of(point);
    let has_weights = whitening.mixed.is_finite() && whitening.loss.is_finite();
    // of a correlation within rounding of 1 nothing is left that could be a weight
    if !(correlation.is_finite() && correlation.abs() < 1.0 && has_weights) {
        return refused(
            "correlation of storage and loss modulus",
            correlation,
            "a value between -1 and 1",
        );
    }
    Ok(())
}
