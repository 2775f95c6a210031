//! Kinds of response between a force and a motion, with their names in a sheet.

use labio::{Dimension, Quantity, ResponseKind};
use serde::Deserialize;

/// One of the six responses between a force and a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum KindSheet {
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

impl KindSheet {
    /// Returns the kind in the form of `labio`.
    #[must_use]
    pub fn kind(self) -> ResponseKind {
        match self {
            Self::Receptance => ResponseKind::Receptance,
            Self::Mobility => ResponseKind::Mobility,
            Self::Accelerance => ResponseKind::Accelerance,
            Self::DynamicStiffness => ResponseKind::DynamicStiffness,
            Self::Impedance => ResponseKind::Impedance,
            Self::DynamicMass => ResponseKind::DynamicMass,
        }
    }
}

/// Returns the quantities of input and output.
pub(super) fn quantities(kind: ResponseKind) -> [Quantity; 2] {
    if kind.is_motion_over_force() {
        [Quantity::Force, kind.motion()]
    } else {
        [kind.motion(), Quantity::Force]
    }
}

/// Returns the dimension of the values.
pub(super) fn dimension(kind: ResponseKind) -> Option<Dimension> {
    let [input, output] = quantities(kind);
    output.dimension().quotient(input.dimension())
}
