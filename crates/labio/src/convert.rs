//! Receptance, mobility, accelerance and their reciprocals.

use std::fmt;

use num_complex::Complex64;

use crate::{Channel, Estimator, FrequencyResponse, LabioError, LineValidity, Quantity};

/// The six frequency responses of a structure between a motion and a force (ISO 7626-1).
///
/// | | motion/force | force/motion |
/// |---|---|---|
/// | displacement | receptance \[m/N\] | dynamic stiffness \[N/m\] |
/// | velocity | mobility \[m/(N s)\] | impedance \[N s/m\] |
/// | acceleration | accelerance \[1/kg\] | dynamic mass \[kg\] |
///
/// The kinds within a column differ by factors $`s = i\omega`$: velocity is s times displacement.
/// The two kinds in a row are reciprocals of each other *line by line*: the force/motion kinds
/// apply to a body that is free at all other points. Blocked force/motion responses are elements of
/// the inverse of the whole matrix and cannot be found from one response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ResponseKind {
    /// Displacement over force.
    Receptance,
    /// Velocity over force.
    Mobility,
    /// Acceleration over force.
    Accelerance,
    /// Force over displacement.
    DynamicStiffness,
    /// Force over velocity.
    Impedance,
    /// Force over acceleration.
    DynamicMass,
}

impl ResponseKind {
    /// All six kinds: motion over force first, then their reciprocals.
    pub const ALL: [Self; 6] = [
        Self::Receptance,
        Self::Mobility,
        Self::Accelerance,
        Self::DynamicStiffness,
        Self::Impedance,
        Self::DynamicMass,
    ];

    /// Returns the kind of a response from the quantity `input` to the quantity `output`; `None`
    /// unless one of them is a force and the other a motion.
    #[must_use]
    pub fn between(input: Quantity, output: Quantity) -> Option<Self> {
        match (input, output) {
            (Quantity::Force, Quantity::Displacement) => Some(Self::Receptance),
            (Quantity::Force, Quantity::Velocity) => Some(Self::Mobility),
            (Quantity::Force, Quantity::Acceleration) => Some(Self::Accelerance),
            (Quantity::Displacement, Quantity::Force) => Some(Self::DynamicStiffness),
            (Quantity::Velocity, Quantity::Force) => Some(Self::Impedance),
            (Quantity::Acceleration, Quantity::Force) => Some(Self::DynamicMass),
            _ => None,
        }
    }

    /// The quantity of the motion.
    #[must_use]
    pub fn motion(self) -> Quantity {
        match self {
            Self::Receptance | Self::DynamicStiffness => Quantity::Displacement,
            Self::Mobility | Self::Impedance => Quantity::Velocity,
            Self::Accelerance | Self::DynamicMass => Quantity::Acceleration,
        }
    }

    /// Returns true if the motion is divided by the force, false for the reciprocal.
    #[must_use]
    pub fn is_motion_over_force(self) -> bool {
        matches!(self, Self::Receptance | Self::Mobility | Self::Accelerance)
    }

    /// Number of time derivatives between the displacement and the motion.
    fn derivatives(self) -> i32 {
        match self {
            Self::Receptance | Self::DynamicStiffness => 0,
            Self::Mobility | Self::Impedance => 1,
            Self::Accelerance | Self::DynamicMass => 2,
        }
    }
}

impl fmt::Display for ResponseKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Receptance => "receptance",
            Self::Mobility => "mobility",
            Self::Accelerance => "accelerance",
            Self::DynamicStiffness => "dynamic stiffness",
            Self::Impedance => "impedance",
            Self::DynamicMass => "dynamic mass",
        })
    }
}

impl FrequencyResponse {
    /// Returns the kind of the response, one of the six of [`ResponseKind`].
    ///
    /// # Errors
    ///
    /// [`LabioError::NoResponseKind`] if the response is not between a force and a motion.
    pub fn kind(&self) -> Result<ResponseKind, LabioError> {
        let (input, output) = (self.input.quantity(), self.output.quantity());
        ResponseKind::between(input, output).ok_or_else(|| LabioError::NoResponseKind {
            input: self.input.to_string(),
            output: self.output.to_string(),
        })
    }

    /// Converts the measurement to another kind: multiplies the values by a power of
    /// $`s = \sigma+i\omega`$ ($`\sigma`$ of the exponential window, or 0), and takes the
    /// reciprocal if force and motion are exchanged.
    ///
    /// Coherence and relative random error of a line are unchanged. The reciprocal of H1 is exactly
    /// H2 of the exchanged channels, and vice versa.
    ///
    /// # Low frequencies
    ///
    /// Nothing is filtered. An integration divides by $`i\omega`$, which amplifies the absolute
    /// errors of low lines as much as the values; relative errors are unchanged. The line at 0
    /// Hz has no integral and is flagged [`LineValidity::NotDefined`], as is the reciprocal of
    /// zero. [`RigidBody`](crate::RigidBody) can replace low lines of a free body.
    ///
    /// # Errors
    ///
    /// The errors of [`FrequencyResponse::kind`]; [`LabioError::CountMismatch`] if the lists of the
    /// response differ in length.
    #[allow(
        clippy::indexing_slicing,
        reason = "`check_lengths` has found one element for each value in every list"
    )]
    pub fn to_kind(&self, kind: ResponseKind) -> Result<Self, LabioError> {
        let from = self.kind()?;
        self.check_lengths()?;
        let exchange = from.is_motion_over_force() != kind.is_motion_over_force();
        let motion_over_force = kind.derivatives() - from.derivatives();
        let power = if from.is_motion_over_force() {
            motion_over_force
        } else {
            -motion_over_force
        };
        let mut converted = self.clone();
        for line in 0..self.values.len() {
            let factor = self.laplace_variable(line).powi(power);
            let multiplied = self.values[line] * factor;
            let value = if exchange {
                multiplied.finv() // does not square the magnitude, which could overflow
            } else {
                multiplied
            };
            if self.validity[line] != LineValidity::Valid {
                continue;
            }
            // the reciprocal of a finite response is zero only if it underflows
            if !value.is_finite() || exchange && value == Complex64::ZERO {
                converted.invalidate(line, LineValidity::NotDefined);
                continue;
            }
            converted.values[line] = value;
            if let Some(variance) = &mut converted.variance {
                // the variance is multiplied by |f|² under H → f H, and by |1/H²|² under H → 1/H;
                // that of a value that is zero at 0 Hz stays zero
                let scale = if exchange {
                    (value / self.values[line]).norm_sqr()
                } else {
                    factor.norm_sqr()
                };
                variance[line] *= scale;
            }
            let variance = converted.variance.as_ref().map_or(0.0, |v| v[line]);
            if !variance.is_finite() {
                converted.invalidate(line, LineValidity::NotDefined);
            }
        }
        let motion = |channel: &Channel| Channel::new(channel.name(), kind.motion());
        let (force, moving) = if from.is_motion_over_force() {
            (&self.input, &self.output)
        } else {
            (&self.output, &self.input)
        };
        (converted.input, converted.output) = if kind.is_motion_over_force() {
            (force.clone(), motion(moving)?)
        } else {
            (motion(moving)?, force.clone())
        };
        if exchange {
            converted.estimator = match self.estimator {
                Estimator::H1 => Estimator::H2,
                Estimator::H2 => Estimator::H1,
                Estimator::Hv => Estimator::Hv,
                Estimator::Hs => Estimator::Hs,
            };
            for bias in [&mut converted.noise_bias, &mut converted.possible_bias] {
                for bias in bias.iter_mut().flatten() {
                    *bias = 1.0 / (1.0 + *bias) - 1.0;
                }
            }
        }
        Ok(converted)
    }

    /// Discards all information of a line.
    #[allow(
        clippy::indexing_slicing,
        reason = "`line` is the index of a value, and `check_lengths` has found one element per value in every list"
    )]
    pub(crate) fn invalidate(&mut self, line: usize, reason: LineValidity) {
        let none = f64::NAN;
        self.validity[line] = reason;
        self.values[line] = Complex64::new(none, none);
        for lines in self.lists_mut() {
            lines[line] = none;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AddedDamping, AveragedSpectra, Record, SpectrumAverager, Window};
    use ndarray::Array2;
    use std::f64::consts::TAU;

    /// Three hits with a force and a motion whose samples vary irregularly.
    fn spectra(output: Quantity) -> AveragedSpectra {
        let channels = [("f", Quantity::Force), ("x", output)];
        let hits: Vec<Record> = (1..4_u8)
            .map(|hit| {
                let samples = Array2::from_shape_fn((2, 33), |(c, n)| {
                    (f64::from(hit) * (1.3 + c as f64) * (n * n) as f64).sin()
                });
                Record::of_test(samples, 330.0, &channels)
            })
            .collect();
        AveragedSpectra::of(&hits, Window::Rectangular).unwrap()
    }

    #[test]
    fn every_kind_is_reached_from_every_other_on_every_way() {
        let receptance = spectra(Quantity::Displacement).h1("f", "x").unwrap();
        for first in ResponseKind::ALL {
            for second in ResponseKind::ALL {
                let there = receptance.to_kind(first).unwrap().to_kind(second).unwrap();
                let direct = receptance.to_kind(second).unwrap();
                assert_eq!(there.kind().unwrap(), second);
                assert_eq!(there.estimator, direct.estimator);
                assert_eq!(
                    (&there.input, &there.output),
                    (&direct.input, &direct.output)
                );
                for line in 1..direct.values.len() {
                    // tolerance: rounding errors of a few products and reciprocals
                    let relative = (there.values[line] / direct.values[line] - 1.0).norm();
                    assert!(relative < 1e-14);
                    let variance = |r: &FrequencyResponse| r.variance.as_ref().unwrap()[line];
                    assert!((variance(&there) / variance(&direct) - 1.0).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn mobility_is_i_omega_times_receptance_and_impedance_its_reciprocal() {
        let receptance = spectra(Quantity::Displacement).h1("f", "x").unwrap();
        let mobility = receptance.to_kind(ResponseKind::Mobility).unwrap();
        let impedance = receptance.to_kind(ResponseKind::Impedance).unwrap();
        let (line, omega) = (7, TAU * 70.0);
        let expected = Complex64::i() * omega * receptance.values[line];
        assert!((mobility.values[line] / expected - 1.0).norm() < 1e-14);
        assert!((impedance.values[line] * expected - 1.0).norm() < 1e-14);
        assert_eq!(mobility.output.to_string(), "`x` [m/s]");
        assert_eq!(impedance.input.to_string(), "`x` [m/s]");
        // the value is exactly zero at zero frequency and has no reciprocal
        assert_eq!(mobility.values[0], Complex64::ZERO);
        assert_eq!(impedance.validity[0], LineValidity::NotDefined);
        assert!(impedance.values[0].is_nan());
    }

    #[test]
    fn the_reciprocal_of_h1_is_h2_the_other_way_round() {
        let spectra = spectra(Quantity::Velocity);
        let reciprocal = spectra
            .h1("f", "x")
            .unwrap()
            .to_kind(ResponseKind::Impedance)
            .unwrap();
        let direct = spectra.h2("x", "f").unwrap();
        assert_eq!(reciprocal.estimator, direct.estimator);
        let variances = |r: &FrequencyResponse| r.variance.clone().unwrap();
        for line in 0..direct.values.len() {
            assert!((reciprocal.values[line] / direct.values[line] - 1.0).norm() < 1e-14);
            let ratio = variances(&reciprocal)[line] / variances(&direct)[line];
            // 1 - coherence loses digits on lines that are nearly coherent
            assert!((ratio - 1.0).abs() < 1e-10, "{ratio}");
        }
    }

    #[test]
    fn an_integral_at_zero_frequency_is_flagged_unless_the_window_moved_it() {
        let accelerance = spectra(Quantity::Acceleration).h1("f", "x").unwrap();
        let mobility = accelerance.to_kind(ResponseKind::Mobility).unwrap();
        assert_eq!(mobility.validity[0], LineValidity::NotDefined);
        assert!(mobility.random_error().unwrap()[0].magnitude.is_nan());
        assert_eq!(mobility.invalid_lines().count(), 1);

        // with an exponential window the line at 0 Hz is at s = sigma
        let samples = ndarray::array![[1.0, 0.0, 0.0, 0.0], [3.0, 0.0, 0.0, 0.0]];
        let channels = [("f", Quantity::Force), ("x", Quantity::Acceleration)];
        let hit = Record::of_test(samples, 10.0, &channels);
        let mut averager = SpectrumAverager::new(hit.channels(), 4, 10.0, Window::Rectangular)
            .unwrap()
            .with_exponential_window(AddedDamping::new(2.0).unwrap())
            .unwrap();
        averager.add(&hit).unwrap();
        let response = averager.spectra().unwrap().h1("f", "x").unwrap();
        let mobility = response.to_kind(ResponseKind::Mobility).unwrap();
        // the accelerance is 3 on every line
        assert!((mobility.values[0] - 1.5).norm() < 1e-15);
        let s = Complex64::new(2.0, TAU * 2.5);
        assert!((mobility.values[1] - 3.0 / s).norm() < 1e-15);
    }

    #[test]
    fn a_ratio_of_two_motions_is_no_such_kind() {
        let spectra = spectra(Quantity::Strain);
        let error = spectra.h1("f", "x").unwrap().kind().unwrap_err();
        assert_eq!(
            error.to_string(),
            "a response from `f` [N] to `x` [1] is not between a force and a motion"
        );
    }
}
