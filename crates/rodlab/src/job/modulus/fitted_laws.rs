//! Laws fitted to the valid lines.

use cmod::ModulusLine;
use cmod::rheology::{ErrorScale, ModulusData};
use cmod::self_calibration::stride_of_independent_lines;
use rodfigure::Axis;

use super::Found;
use super::checks::lines_per_independent_line;
use crate::job::JobContext;
use crate::laws::{self, Drawn, LawsSheet, Lines, MOST_LINES};
use crate::{Outcome, RodlabError};

pub(super) fn fit(
    outcome: &mut Outcome,
    found: &Found<'_>,
    asked: &LawsSheet,
    context: &JobContext<'_>,
) -> Result<(), RodlabError> {
    let points = points(found, asked.most_lines.unwrap_or(MOST_LINES));
    let data = match ModulusData::from_lines(points.iter().copied()) {
        Ok(data) => data,
        Err(error) => {
            outcome.reject("laws", error);
            return Ok(());
        }
    };
    let lines = Lines {
        data: &data,
        points: points
            .iter()
            .map(|line| (line.frequency_hz, line.modulus))
            .collect(),
        error_scale: ErrorScale::Stated,
        chance: None,
        series_profiles: true,
        density: Some(found.sheet.specimen.density.with_uncertainty()),
        is_youngs: true,
        temperature: None,
        drawn: Drawn {
            frequency: (Axis::logarithmic("frequency", "kHz"), 1e-3),
            storage: (Axis::linear("E'", "GPa"), 1e-9),
            caption: format!(
                "The {} lines that were fitted, of {} valid ones, are drawn.",
                points.len(),
                found.estimate.valid().count()
            ),
        },
    };
    laws::fit(outcome, &lines, asked, context).map(|_| ())
}

/// Returns up to `most` evenly distributed valid lines with independent noise.
fn points<'a>(found: &Found<'a>, most: usize) -> Vec<&'a ModulusLine> {
    let count = found.estimate.valid().count();
    let stride = stride_of_independent_lines(count, most, lines_per_independent_line(found));
    found.estimate.valid().step_by(stride).collect()
}
