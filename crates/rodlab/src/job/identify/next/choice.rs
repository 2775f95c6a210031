//! Tests among which the next test is chosen.

use super::NextSheet;
use crate::job::simulate::StrikerSheet;
use crate::sheet::{Exact, Length, Velocity};

/// One or several identical tests that may be made next.
pub(super) struct Choice<'a> {
    pub(super) velocity: &'a Exact<Velocity>,
    pub(super) repeats: usize,
    /// Rod; `None` for the rod of the first existing test.
    pub(super) rod: Option<StruckRod<'a>>,
}

/// A rod that a striker hits.
#[derive(Clone, Copy)]
pub(super) struct StruckRod<'a> {
    pub(super) length: &'a Exact<Length>,
    /// Distance of the section of excitation from the struck end.
    pub(super) gap: &'a Exact<Length>,
    pub(super) diameter: &'a Exact<Length>,
    pub(super) striker: &'a StrikerSheet,
    /// Number of the striker in the sheet, from 1.
    number: usize,
}

pub(super) fn all(next: &NextSheet) -> Vec<Choice<'_>> {
    let rods: Vec<Option<StruckRod<'_>>> = match &next.rods {
        None => vec![None],
        Some(rods) => {
            let mut all = Vec::new();
            for length in &rods.lengths {
                for gap in &rods.gaps {
                    let strikers = rods.strikers.iter().zip(1..);
                    all.extend(strikers.map(|(striker, number)| {
                        Some(StruckRod {
                            length,
                            gap,
                            diameter: &rods.diameter,
                            striker,
                            number,
                        })
                    }));
                }
            }
            all
        }
    };
    let mut choices = Vec::new();
    for velocity in &next.velocities {
        for rod in &rods {
            choices.extend(next.repeats.iter().map(|repeats| Choice {
                velocity,
                repeats: *repeats,
                rod: *rod,
            }));
        }
    }
    choices
}

impl Choice<'_> {
    /// Returns the choice in words, without the quantities that are equal in all choices of `next`.
    pub(super) fn name(&self, next: &NextSheet) -> String {
        let mut parts = Vec::new();
        if let (Some(rod), Some(rods)) = (&self.rod, &next.rods) {
            parts.push(rod.length.to_string());
            if rods.gaps.len() > 1 {
                parts.push(format!("section {} from the struck end", rod.gap));
            }
            if rods.strikers.len() > 1 {
                parts.push(format!("striker {}", rod.number));
            }
        }
        parts.push(self.velocity.to_string());
        let name = parts.join(", ");
        if next.repeats.len() > 1 || self.repeats > 1 {
            format!("{} x {name}", self.repeats)
        } else {
            name
        }
    }
}
