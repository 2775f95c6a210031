//! Estimate as plain columns, for a file or another program.

use super::{ModulusEstimate, ModulusLine};

/// One quantity on all lines.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Column {
    /// Name in the form of an identifier.
    pub name: &'static str,
    /// Unit, `1` if there is none.
    pub unit: &'static str,
    /// One value per line.
    pub values: Vec<f64>,
}

/// Estimate as a table: one row per line that has a modulus, valid or not, in order of frequency.
///
/// ```
/// # use cmod::{Specimen, TwoPoint};
/// # use num_complex::Complex64;
/// # let specimen = Specimen { length: 0.799, diameter: 0.0158, density: 912.0, accelerometer_mass: 2.9e-3 };
/// # let ratio = [Complex64::new(0.0116, 0.1001), Complex64::new(-0.0202, 0.1019)];
/// let estimate = TwoPoint::new(specimen)?.estimate(&[500.0, 510.0], &ratio, &[1e-6; 2])?;
/// let columns = estimate.columns();
/// let header: Vec<String> = columns.iter().map(|c| format!("{} [{}]", c.name, c.unit)).collect();
/// assert_eq!(header[..3], ["line [1]", "frequency [Hz]", "storage_modulus [Pa]"]);
/// assert_eq!(columns.values("frequency"), Some(&[500.0, 510.0][..]));
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Columns {
    /// Name of the estimation method.
    pub method: String,
    /// Columns, all of equal length.
    pub columns: Vec<Column>,
    /// One verdict per line: `valid`, or the violated conditions.
    pub verdicts: Vec<String>,
}

impl Columns {
    /// Iterates over the columns in their order.
    pub fn iter(&self) -> impl Iterator<Item = &Column> {
        self.columns.iter()
    }

    /// Returns the values of the column with this `name`.
    #[must_use]
    pub fn values(&self, name: &str) -> Option<&[f64]> {
        let column = self.columns.iter().find(|column| column.name == name)?;
        Some(&column.values)
    }
}

type Quantity = (&'static str, &'static str, fn(&ModulusLine) -> f64);

/// Name, unit and value of the columns. Line numbers are exact as `f64` up to 2^53.
const QUANTITIES: [Quantity; 23] = [
    ("line", "1", |line| line.index as f64),
    ("frequency", "Hz", |line| line.frequency_hz),
    ("storage_modulus", "Pa", |line| line.modulus.re),
    ("loss_modulus", "Pa", |line| line.modulus.im),
    ("loss_factor", "1", |line| line.loss_factor),
    ("damping_coefficient", "1/m", |line| {
        line.damping_coefficient()
    }),
    ("wave_number", "rad/m", |line| line.wave_number()),
    ("phase_velocity", "m/s", |line| line.phase_velocity),
    ("storage_modulus_error", "Pa", |line| {
        line.standard_error.storage_modulus
    }),
    ("loss_modulus_error", "Pa", |line| {
        line.standard_error.loss_modulus
    }),
    ("modulus_covariance", "Pa^2", |line| line.covariance().mixed),
    ("loss_factor_error", "1", |line| {
        line.standard_error.loss_factor
    }),
    ("damping_coefficient_error", "1/m", |line| {
        line.standard_error.damping_coefficient
    }),
    ("wave_number_error", "rad/m", |line| {
        line.standard_error.wave_number
    }),
    ("phase_velocity_error", "m/s", |line| {
        line.standard_error.phase_velocity
    }),
    ("storage_modulus_random_error", "Pa", |line| {
        line.random_error().storage_modulus
    }),
    ("loss_modulus_random_error", "Pa", |line| {
        line.random_error().loss_modulus
    }),
    ("storage_modulus_systematic_error", "Pa", |line| {
        line.systematic_error().storage_modulus
    }),
    ("loss_modulus_systematic_error", "Pa", |line| {
        line.systematic_error().loss_modulus
    }),
    ("degrees_of_freedom", "1", |line| {
        line.uncertainty.degrees_of_freedom.unwrap_or(f64::INFINITY)
    }),
    ("error_amplification", "1", |line| line.error_amplification),
    ("second_order", "1", |line| line.second_order),
    ("valid", "1", |line| {
        f64::from(u8::from(line.validity.is_valid()))
    }),
];

impl ModulusEstimate {
    /// Returns the estimate as a table. Degrees of freedom of a known variance are infinite;
    /// `valid` is 1 or 0.
    #[must_use]
    pub fn columns(&self) -> Columns {
        let column = |&(name, unit, value): &Quantity| Column {
            name,
            unit,
            values: self.lines().iter().map(value).collect(),
        };
        Columns {
            method: self.method().to_string(),
            columns: QUANTITIES.iter().map(column).collect(),
            verdicts: self
                .lines()
                .iter()
                .map(|line| line.validity.to_string())
                .collect(),
        }
    }
}
