//! Projection of the values of lines onto the cone of relaxing materials.

use num_complex::Complex64;
use rodwave::modulus::MaxwellBranch;
use rodwave::numerics::CommonErrors;

use crate::rheology::non_negative::NonNegative;
use crate::vectors::{dot, subtract, without};

/// Relaxation times per decade of the grid. A branch whose relaxation time is between two grid
/// points is represented by branches at both, with an error of at most 1.7e-4 of its loss modulus
/// (as in [`rodwave::kramers_kronig`]).
const TIMES_A_DECADE: f64 = 64.0;
/// Decades of the grid beyond the band: at this distance a branch equals a spring or a dashpot to
/// 1e-4.
const DECADES_BEYOND: f64 = 2.0;
/// Predicted decrease of the sum of squares up to which no further branch is added, as a fraction
/// of the sum of squares per value, or of 1 if the sum per value exceeds 1.
const TOLERANCE: f64 = 1e-10;

/// Value of a line, with its independent error.
#[derive(Debug, Clone, Copy)]
pub(super) struct Value {
    /// Laplace variable s of the line [1/s]: iω, or σ + iω with added damping.
    pub(super) place: Complex64,
    /// Modulus E \[Pa\].
    pub(super) modulus: Complex64,
    /// Rows of the whitening matrix W [1/Pa], where WᵀW is the inverse of the covariance of (E',
    /// E'').
    pub(super) whitening: [[f64; 2]; 2],
}

impl Value {
    /// Creates a value with the `variance` E|δE|² \[Pa²\], half of it in the real part and half in
    /// the imaginary part.
    pub(super) fn circular(place: Complex64, modulus: Complex64, variance: f64) -> Self {
        let weight = (2.0 / variance).sqrt();
        Self {
            place,
            modulus,
            whitening: [[weight, 0.0], [0.0, weight]],
        }
    }

    fn whitened(&self, modulus: Complex64) -> [f64; 2] {
        let row = |[re, im]: [f64; 2]| re * modulus.re + im * modulus.im;
        self.whitening.map(row)
    }
}

/// Values and their common errors, in units of the total errors of the values.
pub(super) struct Whitened<'a> {
    values: &'a [Value],
    pub(super) common: CommonErrors,
    /// Values, and readings of the sizes of the common errors, in units of their independent
    /// errors.
    plain: Vec<f64>,
    /// Values, and readings of the sizes of the common errors, in units of their total errors.
    target: Vec<f64>,
}

impl<'a> Whitened<'a> {
    /// Creates whitened `values`. Each `common` vector \[Pa\] contains the errors of all values if
    /// one source is wrong by one standard uncertainty. Each of the `readings` is a measured
    /// weighted sum of the sizes of these errors: the weights, and the value of the sum, whose
    /// error has variance 1.
    pub(super) fn new(
        values: &'a [Value],
        common: &[Vec<Complex64>],
        readings: &[(Vec<f64>, f64)],
    ) -> Self {
        let vectors = common.iter().enumerate().map(|(source, of)| {
            let mut vector = whitened(values, of.iter().copied());
            let factor = |(factors, _): &(Vec<f64>, f64)| factors.get(source).copied();
            vector.extend(
                readings
                    .iter()
                    .map(|reading| factor(reading).unwrap_or(0.0)),
            );
            vector
        });
        let common = CommonErrors::new(vectors.collect());
        let mut plain = whitened(values, values.iter().map(|value| value.modulus));
        plain.extend(readings.iter().map(|(_, value)| value));
        let mut target = plain.clone();
        common.whiten(&mut target);
        Self {
            values,
            common,
            plain,
            target,
        }
    }

    /// Returns the number of values and readings.
    pub(super) fn rows(&self) -> usize {
        self.plain.len()
    }

    /// Returns the moduli of a material at the lines, in units of the independent errors.
    fn of_material(&self, material: impl Fn(Complex64) -> Complex64) -> Vec<f64> {
        let mut column = whitened(self.values, self.values.iter().map(|v| material(v.place)));
        column.resize(self.rows(), 0.0);
        column
    }

    /// Returns the columns of a spring and of branches, each of modulus 1, in units of the total
    /// errors.
    pub(super) fn columns(&self, times: &[f64]) -> Vec<Vec<f64>> {
        let whitened = |material: &dyn Fn(Complex64) -> Complex64| {
            let mut column = self.of_material(material);
            self.common.whiten(&mut column);
            column
        };
        let of_time = |time: &f64| whitened(&|place| share(place, *time));
        std::iter::once(whitened(&|_| Complex64::ONE))
            .chain(times.iter().map(of_time))
            .collect()
    }

    /// Finds the material nearest to the values; `None` without values, or if a number is not
    /// finite.
    pub(super) fn project(&self) -> Option<Projection> {
        let times = self.grid(TIMES_A_DECADE)?;
        let problem = NonNegative::new(&self.columns(&times), &self.target);
        let material = Material::of(&times, &solved(&problem));
        let mut rest = self.plain.clone();
        subtract(
            &mut rest,
            1.0,
            &self.of_material(|place| material.at(place)),
        );
        let sizes = self.common.sizes(&rest);
        let left = without(&rest, self.common.vectors(), &sizes);
        self.common.whiten(&mut rest);
        let chi_squared = dot(&rest, &rest);
        chi_squared.is_finite().then(|| Projection {
            material,
            sizes,
            chi_squared,
            residuals: left
                .as_chunks()
                .0
                .iter()
                .take(self.values.len())
                .copied()
                .collect(),
        })
    }

    /// Returns the sum of squares of the difference of two materials, in units of the total errors.
    pub(super) fn distance(&self, one: &Material, other: &Material) -> f64 {
        let mut difference = self.of_material(|place| one.at(place) - other.at(place));
        self.common.whiten(&mut difference);
        dot(&difference, &difference)
    }

    /// Returns relaxation times that cover the band and [`DECADES_BEYOND`] decades on either side
    /// of it.
    pub(super) fn grid(&self, times_a_decade: f64) -> Option<Vec<f64>> {
        let sizes = || self.values.iter().map(|value| value.place.norm());
        let lowest = sizes().min_by(f64::total_cmp)?;
        let highest = sizes().max_by(f64::total_cmp)?;
        let beyond = DECADES_BEYOND * std::f64::consts::LN_10;
        let (first, last) = (-highest.ln() - beyond, -lowest.ln() + beyond);
        if !(first.is_finite() && last.is_finite()) {
            return None;
        }
        let step = std::f64::consts::LN_10 / times_a_decade;
        let times = std::iter::successors(Some(first), |log| Some(log + step));
        let times = times.take_while(|log| *log < last).chain([last]);
        Some(times.map(f64::exp).collect())
    }
}

/// Solves a problem and returns the coefficients of its columns.
pub(super) fn solved(problem: &NonNegative) -> Vec<f64> {
    problem.solve_to(TOLERANCE).coefficients
}

/// Relaxing material nearest to the values, with its distance from them.
#[derive(Debug, Clone)]
pub(super) struct Projection {
    pub(super) material: Material,
    /// Sizes of the common errors, in standard uncertainties.
    pub(super) sizes: Vec<f64>,
    /// Sum of squares of the residual in units of the total errors.
    pub(super) chi_squared: f64,
    /// Residual of each line after subtraction of the common errors, in units of the errors of that
    /// line.
    pub(super) residuals: Vec<[f64; 2]>,
}

/// Material of a spring and Maxwell branches in parallel.
#[derive(Debug, Clone)]
pub(super) struct Material {
    pub(super) equilibrium: f64,
    pub(super) branches: Vec<MaxwellBranch>,
}

impl Material {
    /// Creates a material from the coefficients of a spring and of branches with these `times`;
    /// branches with the coefficient 0 are omitted.
    pub(super) fn of(times: &[f64], coefficients: &[f64]) -> Self {
        let (equilibrium, moduli) = coefficients.split_at(coefficients.len().min(1));
        let branches = times
            .iter()
            .zip(moduli)
            .filter(|(_, modulus)| **modulus != 0.0);
        Self {
            equilibrium: equilibrium.first().copied().unwrap_or(0.0),
            branches: branches
                .map(|(time, modulus)| MaxwellBranch {
                    modulus: *modulus,
                    relaxation_time: *time,
                })
                .collect(),
        }
    }

    /// Returns the modulus at s = `place`.
    pub(super) fn at(&self, place: Complex64) -> Complex64 {
        let branches = self.branches.iter();
        let shares = branches.map(|own| own.modulus * share(place, own.relaxation_time));
        self.equilibrium + shares.sum::<Complex64>()
    }
}

/// Returns the modulus of a branch of modulus 1 at s = `place`.
pub(super) fn share(place: Complex64, relaxation_time: f64) -> Complex64 {
    let x = place * relaxation_time;
    x / (1.0 + x)
}

fn whitened(values: &[Value], moduli: impl Iterator<Item = Complex64>) -> Vec<f64> {
    let pairs = values.iter().zip(moduli);
    pairs.flat_map(|(value, own)| value.whitened(own)).collect()
}
