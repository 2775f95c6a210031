//! Estimate as curves for a figure: segments of valid lines, segments of invalid lines, error
//! bands.

use super::{ModulusEstimate, ModulusLine};

/// Quantity plotted over frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum PlottedQuantity {
    /// E' \[Pa\].
    StorageModulus,
    /// E'' \[Pa\].
    LossModulus,
    /// E''/E'.
    LossFactor,
    /// α [1/m].
    DampingCoefficient,
    /// k [rad/m].
    WaveNumber,
    /// ω/k [m/s].
    PhaseVelocity,
}

impl PlottedQuantity {
    /// Returns the value of a line and its standard error.
    #[must_use]
    pub fn of(self, line: &ModulusLine) -> (f64, f64) {
        let error = &line.standard_error;
        match self {
            Self::StorageModulus => (line.modulus.re, error.storage_modulus),
            Self::LossModulus => (line.modulus.im, error.loss_modulus),
            Self::LossFactor => (line.loss_factor, error.loss_factor),
            Self::DampingCoefficient => (line.damping_coefficient(), error.damping_coefficient),
            Self::WaveNumber => (line.wave_number(), error.wave_number),
            Self::PhaseVelocity => (line.phase_velocity, error.phase_velocity),
        }
    }

    /// Returns the unit, `1` if there is none.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::StorageModulus | Self::LossModulus => "Pa",
            Self::LossFactor => "1",
            Self::DampingCoefficient => "1/m",
            Self::WaveNumber => "rad/m",
            Self::PhaseVelocity => "m/s",
        }
    }
}

/// Quantity over frequency, in segments of valid or invalid lines.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Curve {
    /// Plotted quantity.
    pub quantity: PlottedQuantity,
    /// Half the width of the bands, in standard errors.
    pub standard_errors: f64,
    /// Segments in order of frequency.
    pub segments: Vec<CurveSegment>,
}

/// Neighbouring lines that are all valid, or all invalid. All arrays have one entry per line.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct CurveSegment {
    /// True if the lines are valid; the other segments are meant to be drawn in grey.
    pub valid: bool,
    /// Frequencies \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Values of the quantity.
    pub values: Vec<f64>,
    /// Lower edge of the band.
    pub lower: Vec<f64>,
    /// Upper edge of the band.
    pub upper: Vec<f64>,
}

impl ModulusEstimate {
    /// Returns `quantity` over frequency with bands of ± `standard_errors` σ, in segments of lines
    /// that are all valid or all invalid. A refused line also ends a segment: nothing is drawn
    /// across it.
    ///
    /// ```
    /// # use cmod::{Specimen, TwoPoint};
    /// # use num_complex::Complex64;
    /// use cmod::estimate::PlottedQuantity;
    /// # let specimen = Specimen { length: 0.799, diameter: 0.0158, density: 912.0, accelerometer_mass: 2.9e-3 };
    /// # let ratio = [Complex64::new(0.0116, 0.1001), Complex64::new(-0.0202, 0.1019)];
    /// let estimate = TwoPoint::new(specimen)?.estimate(&[500.0, 510.0], &ratio, &[1e-6; 2])?;
    /// let curve = estimate.curve(PlottedQuantity::LossFactor, 2.0);
    /// for segment in &curve.segments {
    ///     let (colour, count) = (if segment.valid { "black" } else { "grey" }, segment.values.len());
    ///     println!("{count} lines in {colour}, from {} Hz", segment.frequency_hz[0]);
    /// }
    /// # assert_eq!(curve.segments.iter().map(|s| s.upper.len()).sum::<usize>(), 2);
    /// # Ok::<(), cmod::CmodError>(())
    /// ```
    #[must_use]
    pub fn curve(&self, quantity: PlottedQuantity, standard_errors: f64) -> Curve {
        let mut segments: Vec<CurveSegment> = Vec::new();
        let mut next = None;
        for line in self.lines() {
            let valid = line.validity.is_valid();
            let continues = next == Some((line.index, valid));
            next = Some((line.index + 1, valid));
            if !continues {
                segments.push(CurveSegment {
                    valid,
                    frequency_hz: Vec::new(),
                    values: Vec::new(),
                    lower: Vec::new(),
                    upper: Vec::new(),
                });
            }
            if let Some(segment) = segments.last_mut() {
                let (value, error) = quantity.of(line);
                segment.frequency_hz.push(line.frequency_hz);
                segment.values.push(value);
                segment.lower.push(value - standard_errors * error);
                segment.upper.push(value + standard_errors * error);
            }
        }
        Curve {
            quantity,
            standard_errors,
            segments,
        }
    }
}
