//! Delay and length of a test about which its response is linearised.

use crate::model::DrivenRod;

/// Delay and length of a test about which its response is linearised.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Deviation {
    /// Delay of the response \[s\].
    pub(crate) delay: f64,
    /// Length relative to the stated length, minus 1.
    pub(crate) length: f64,
}

impl Deviation {
    /// The rod with its most likely length.
    pub(crate) fn of_rod<'a>(&self, rod: DrivenRod<'a>) -> DrivenRod<'a> {
        DrivenRod {
            length: rod.length * (1.0 + self.length),
            ..rod
        }
    }
}
