//! The two bodies of an impact, computed or measured.

use std::sync::Arc;

use impulse::{ImpactBody, MeasuredBody, lines_of};
use num_complex::Complex64;

use super::draws::Draws;
use crate::bodies::face::{BodySheet, ComputedBody};
use crate::bodies::material_sheet::Materials;
use crate::bodies::measured::MeasuredBodySheet;
use crate::bodies::replacement::Replacement;
use crate::job::JobContext;
use crate::job::mobility::screening;
use crate::responses::{cut, measured_body};
use crate::sheet::Exact;
use crate::{Outcome, RodlabError};

/// A body of an impact.
pub(super) enum FaceBody {
    Computed(ComputedBody),
    Measured {
        body: MeasuredBody,
        /// Relative standard error of the scale.
        scale: f64,
        /// Standard error of the delay \[s\].
        delay: f64,
        /// Standard error of the mass \[kg\].
        mass_error: f64,
    },
}

impl FaceBody {
    /// The body of the sheet; for a measured one, the file and the result of screening are entered
    /// in `outcome`.
    pub(super) fn read(
        sheet: &BodySheet,
        materials: &Materials,
        field: &str,
        context: &JobContext<'_>,
        outcome: &mut Outcome,
    ) -> Result<Self, RodlabError> {
        match sheet {
            BodySheet::Measured(measured) => read_measured(measured, field, context, outcome),
            computed => computed.body(materials, field).map(Self::Computed),
        }
    }

    pub(super) fn impact_body(&self) -> Result<Arc<dyn ImpactBody + Send + Sync>, RodlabError> {
        match self {
            Self::Computed(body) => body.impact_body(),
            Self::Measured { body, .. } => Ok(Arc::new(body.clone())),
        }
    }

    /// The body drawn at random within the stated uncertainties; `sheet` is that of this body.
    pub(super) fn drawn(
        &self,
        sheet: &BodySheet,
        materials: &Materials,
        field: &str,
        draws: &mut Draws<'_>,
    ) -> Result<Arc<dyn ImpactBody + Send + Sync>, RodlabError> {
        match self {
            Self::Computed(_) => draws
                .body(sheet, field)?
                .body(materials, field)?
                .impact_body(),
            Self::Measured {
                body,
                scale,
                delay,
                mass_error,
            } => {
                let common = [*scale, *delay, *mass_error];
                if body.variance().is_some() || common.iter().any(|error| *error > 0.0) {
                    draws.n_drawn += 1;
                }
                let drawn = body.drawn(*scale, *delay, draws.random);
                Ok(Arc::new(
                    drawn.map_err(|error| RodlabError::step(field, error))?,
                ))
            }
        }
    }

    /// Returns true if the force can be found by marching: for a measured body, the impedance of
    /// its face is stated.
    pub(super) fn can_be_marched(&self) -> bool {
        self.measured()
            .is_none_or(|body| body.front_impedance().is_some())
    }

    /// The measurement, if there is one.
    pub(super) fn measured(&self) -> Option<&MeasuredBody> {
        match self {
            Self::Computed(_) => None,
            Self::Measured { body, .. } => Some(body),
        }
    }

    /// Relative standard error of the scale.
    pub(super) fn scale(&self) -> f64 {
        match self {
            Self::Computed(_) => 0.0,
            Self::Measured { scale, .. } => *scale,
        }
    }

    /// Standard error of the delay \[s\].
    pub(super) fn delay(&self) -> f64 {
        match self {
            Self::Computed(_) => 0.0,
            Self::Measured { delay, .. } => *delay,
        }
    }

    /// Mass of a free body and its standard error \[kg\].
    pub(super) fn mass(&self) -> Option<(f64, f64)> {
        match self {
            Self::Computed(body) => body.free_mass().map(|mass| (mass, 0.0)),
            Self::Measured {
                body, mass_error, ..
            } => body.free_mass().map(|mass| (mass, *mass_error)),
        }
    }

    /// Variance of the mobility on the first `n_lines` lines.
    pub(super) fn variance(&self, n_lines: usize) -> Option<&[f64]> {
        self.measured()
            .and_then(MeasuredBody::variance)
            .and_then(|variance| variance.get(..n_lines))
    }

    /// Mobility on `n_lines` lines.
    pub(super) fn lines(
        &self,
        frequency_step_hz: f64,
        n_lines: usize,
        field: &str,
    ) -> Result<Vec<Complex64>, RodlabError> {
        lines_of(&*self.impact_body()?, frequency_step_hz, n_lines)
            .map_err(|error| RodlabError::step(field, error))
    }

    /// Mobility at `frequencies_hz`, or on the measured lines among them.
    pub(super) fn curve(
        &self,
        frequencies_hz: &[f64],
        field: &str,
    ) -> Result<(Vec<f64>, Vec<Complex64>), RodlabError> {
        let ends = frequencies_hz.first().zip(frequencies_hz.last());
        match (self, ends) {
            (Self::Measured { body, .. }, Some((from, to))) => Ok(body
                .mobility()
                .iter()
                .enumerate()
                .skip(1)
                .map(|(line, value)| (line as f64 * body.frequency_step_hz(), *value))
                .filter(|(frequency, _)| frequency >= from && frequency <= to)
                .unzip()),
            (Self::Computed(body), Some(_)) => {
                let values = frequencies_hz
                    .iter()
                    .map(|f| body.mobility(*f))
                    .collect::<Result<Vec<_>, _>>()
                    .map_err(|error| RodlabError::step(field, error))?;
                Ok((frequencies_hz.to_vec(), values))
            }
            (_, None) => Ok((Vec::new(), Vec::new())),
        }
    }
}

fn read_measured(
    sheet: &MeasuredBodySheet,
    field: &str,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<FaceBody, RodlabError> {
    let mut response = sheet.response().read(context.folder, field, outcome)?;
    if let Some(up_to) = &sheet.up_to {
        cut(&mut response, up_to, &format!("{field}.up_to"))?;
    }
    if let Some(scale) = &sheet.scale_uncertainty {
        response = response
            .with_common_error(scale.si())
            .map_err(|error| RodlabError::step(format!("{field}.scale_uncertainty"), error))?;
    }
    let mut first_measured = 1;
    if let Some(completion) = &sheet.complete {
        let place = format!("{field}.complete");
        (response, first_measured) = completion.complete(&response, &sheet.support, &place)?;
    }
    let scale = sheet.scale_uncertainty.as_ref().map_or(0.0, Exact::si);
    let delay = sheet.delay_uncertainty.as_ref().map_or(0.0, Exact::si);
    let mut body = measured_body(
        &response,
        &sheet.support,
        sheet.front_impedance.as_ref(),
        field,
    )?
    .with_first_measured(first_measured)
    .with_delay_error(delay)
    .map_err(|error| RodlabError::step(format!("{field}.delay_uncertainty"), error))?;
    outcome.by_default(format!("{field}.support"), sheet.support.in_words());
    outcome.by_default(format!("{field}.scale_uncertainty"), "none");
    outcome.by_default(format!("{field}.delay_uncertainty"), "none");
    outcome.by_default(
        format!("{field}.causal"),
        "what stands ahead of the impulse is left",
    );
    let before = outcome.summary.len();
    let (quantities, warnings) = (outcome.quantities.len(), outcome.warnings.len());
    let failed = screening::tell(&body.screen(), outcome);
    // names distinguish the two bodies
    outcome.summary.truncate(before);
    for quantity in outcome.quantities.iter_mut().skip(quantities) {
        quantity.name = format!("{field}: {}", quantity.name);
    }
    for warning in outcome.warnings.iter_mut().skip(warnings) {
        *warning = format!("{field}: {warning}");
    }
    for check in failed {
        outcome.doubt(format!("{field}: {check}"));
    }
    if sheet.causal {
        body = body.causally_projected();
    }
    if let Some(draw) = &context.draw {
        body = draw
            .with_random(|random| body.drawn(scale, delay, random))
            .map_err(|error| RodlabError::step(field, error))?;
    }
    let weighed = sheet.support.weighed();
    Ok(FaceBody::Measured {
        body,
        scale,
        delay,
        mass_error: weighed.map_or(0.0, |weighed| weighed.standard_error),
    })
}
