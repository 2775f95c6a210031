//! A body of which only the lower half of its measured lines is known.

use num_complex::Complex64;

use crate::{Domain, ImpactBody, ImpulseError};

/// A body with half of its lines; a computed one as it is. By what changes then, the force is as
/// uncertain as the lines above the last one are unknown.
pub(super) struct HalfLines<'a>(pub(super) &'a dyn ImpactBody);

impl ImpactBody for HalfLines<'_> {
    fn domain(&self) -> Domain {
        match self.0.domain() {
            Domain::Lines {
                frequency_step_hz,
                n_lines,
            } => Domain::Lines {
                frequency_step_hz,
                n_lines: n_lines.div_ceil(2),
            },
            known => known,
        }
    }

    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError> {
        self.0.mobility_at(s)
    }

    fn free_mass(&self) -> Option<f64> {
        self.0.free_mass()
    }

    fn front_impedance(&self) -> Option<f64> {
        self.0.front_impedance()
    }
}
