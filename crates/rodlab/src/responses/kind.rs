//! Quantities and dimensions of the kinds of response between a force and a motion.

use labio::{Dimension, Quantity, ResponseKind};

/// Returns the quantities of input and output.
pub(super) fn quantities(kind: ResponseKind) -> [Quantity; 2] {
    if kind.is_motion_over_force() {
        [Quantity::Force, kind.motion()]
    } else {
        [kind.motion(), Quantity::Force]
    }
}

pub(super) fn dimension(kind: ResponseKind) -> Option<Dimension> {
    let [input, output] = quantities(kind);
    output.dimension().quotient(input.dimension())
}
