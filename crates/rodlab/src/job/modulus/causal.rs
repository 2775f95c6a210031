//! Causal estimate from the lines of a rod.

use cmod::causal::CausalEstimate;
use rodfigure::Axis;

use super::Found;
use crate::digits::percent;
use crate::laws::Drawn;
use crate::laws::causal::{self, Shown};
use crate::{Outcome, RodlabError};

/// Reports the estimate, or the reason why there is none.
pub(super) fn state(
    outcome: &mut Outcome,
    found: &Found<'_>,
    estimate: Result<CausalEstimate, RodlabError>,
) -> Result<(), RodlabError> {
    let points = found.estimate.valid();
    let shown = Shown {
        symbol: "E",
        frequency: "frequency",
        points: points
            .map(|line| (line.frequency_hz, line.modulus))
            .collect(),
        drawn: Drawn {
            frequency: (Axis::linear("frequency", "kHz"), 1e-3),
            storage: (Axis::linear("E'", "GPa"), 1e-9),
            caption: String::new(),
        },
        pascal: ("GPa", 1e9),
        level: Some(found.sheet.checks.level()?),
    };
    let is_found = estimate.is_ok();
    causal::state(outcome, &shown, estimate)?;
    let left = found.estimate.valid().map(|line| {
        let bound = line.lateral_inertia_bound().storage_modulus;
        bound / line.modulus.re
    });
    let left = left.fold(0.0, f64::max);
    if is_found && left > 0.0 {
        outcome.warn(format!(
            "The causal estimate neglects lateral inertia: its E' is too small by at most {}, which its errors do not include.",
            percent(left)
        ));
    }
    Ok(())
}
