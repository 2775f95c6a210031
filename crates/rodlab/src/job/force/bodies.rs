//! The two bodies of an impact: computed, measured, or assembled from computed and measured
//! members.

use std::sync::Arc;

use impulse::{
    Assembly, Domain, ImpactBody, LineChange, MeasuredBody, MeasuredPoints, Projection,
    SharedSubstructure, lines_of,
};
use num_complex::Complex64;

use super::draws::Draws;
use crate::bodies::face::assembly::{AssemblySheet, MeasuredPointsSheet};
use crate::bodies::face::{BodySheet, ComputedBody};
use crate::bodies::material_sheet::Materials;
use crate::bodies::measured::MeasuredBodySheet;
use crate::bodies::replacement::Replacement;
use crate::job::JobContext;
use crate::job::mobility::screening;
use crate::outcome::Quantity;
use crate::responses::{cut, measured_body};
use crate::sheet::{Exact, Stated};
use crate::{InStep, Outcome, RodlabError};

/// A body of an impact.
pub(super) enum FaceBody {
    Computed(ComputedBody),
    Measured(MeasuredFace),
    /// Bodies joined at points, some of them measured.
    Assembly {
        body: Arc<Assembly>,
        /// Measured members by their index; `None` for a computed member.
        measured: Vec<Option<MeasuredMember>>,
    },
}

/// A measured body.
pub(super) struct MeasuredFace {
    body: MeasuredBody,
    /// Relative standard error of the scale.
    scale: f64,
    /// Standard error of the delay \[s\].
    delay: f64,
    /// Standard error of the mass \[kg\].
    mass_error: f64,
}

pub(super) struct MeasuredMember {
    points: MeasuredPoints,
    /// Relative standard error of the scale.
    scale: f64,
    /// Standard error of the delay \[s\].
    delay: f64,
}

impl FaceBody {
    /// Reads the body of the sheet. For a measured body, the file and the result of the screening
    /// are entered in `outcome`.
    pub(super) fn read(
        sheet: &BodySheet,
        materials: &Materials,
        field: &str,
        context: &JobContext<'_>,
        outcome: &mut Outcome,
    ) -> Result<Self, RodlabError> {
        match sheet {
            BodySheet::Measured(measured) => {
                read_measured((measured, Place::Face), field, context, outcome).map(Self::Measured)
            }
            BodySheet::Assembly(assembly) if has_measured(assembly) => {
                read_assembly(assembly, materials, field, context, outcome)
            }
            computed => computed.body(materials, field).map(Self::Computed),
        }
    }

    pub(super) fn impact_body(&self) -> Result<Arc<dyn ImpactBody + Send + Sync>, RodlabError> {
        match self {
            Self::Computed(body) => body.impact_body(),
            Self::Measured(measured) => Ok(Arc::new(measured.body.clone())),
            Self::Assembly { body, .. } => Ok(Arc::clone(body) as Arc<_>),
        }
    }

    /// Returns a body drawn at random within the stated uncertainties; `sheet` describes the body.
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
            Self::Measured(MeasuredFace {
                body, scale, delay, ..
            }) => {
                if body.is_uncertain() || *scale > 0.0 || *delay > 0.0 {
                    draws.n_drawn += 1;
                }
                let drawn = body.drawn(*scale, *delay, draws.random);
                Ok(Arc::new(drawn.in_step(field)?))
            }
            Self::Assembly { measured, .. } => {
                let BodySheet::Assembly(drawn) = draws.body(sheet, field)? else {
                    return self.impact_body();
                };
                let member = |at: usize| match measured.get(at).and_then(Option::as_ref) {
                    Some(member) => member.drawn(field, draws),
                    None => drawn.computed_member(at, materials, field),
                };
                Ok(Arc::new(drawn.assembled(field, member)?))
            }
        }
    }

    /// Returns true if the force can be computed by marching in time. A measured body needs a
    /// stated front impedance for this.
    pub(super) fn can_be_marched(&self) -> bool {
        match self {
            Self::Computed(_) => true,
            Self::Measured(measured) => measured.body.front_impedance().is_some(),
            Self::Assembly { body, .. } => body.front_impedance().is_some(),
        }
    }

    /// Highest frequency of the measured lines \[Hz\], if there are any.
    pub(super) fn measured_to_hz(&self) -> Option<f64> {
        let domain = match self {
            Self::Computed(body) => body.domain(),
            Self::Measured(measured) => measured.body.domain(),
            Self::Assembly { body, .. } => body.domain(),
        };
        match domain {
            Domain::Lines {
                frequency_step_hz,
                n_lines,
            } => Some((n_lines - 1) as f64 * frequency_step_hz),
            _ => None,
        }
    }

    pub(super) fn measured(&self) -> Option<&MeasuredBody> {
        match self {
            Self::Measured(measured) => Some(&measured.body),
            _ => None,
        }
    }

    /// Relative standard error of the scale.
    pub(super) fn scale(&self) -> f64 {
        match self {
            Self::Measured(measured) => measured.scale,
            _ => 0.0,
        }
    }

    /// Standard error of the delay \[s\].
    pub(super) fn delay(&self) -> f64 {
        match self {
            Self::Measured(measured) => measured.delay,
            _ => 0.0,
        }
    }

    /// Mass of the body and its standard error \[kg\]; `None` if the body is not free.
    pub(super) fn mass(&self) -> Option<(f64, f64)> {
        match self {
            Self::Computed(body) => body.free_mass().map(|mass| (mass, 0.0)),
            Self::Measured(measured) => {
                let mass = measured.body.free_mass();
                mass.map(|mass| (mass, measured.mass_error))
            }
            Self::Assembly { body, .. } => body.free_mass().map(|mass| (mass, 0.0)),
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
        lines_of(&*self.impact_body()?, frequency_step_hz, n_lines).in_step(field)
    }

    /// Frequencies and mobilities: at `frequencies_hz` or, for a body that is known on lines only,
    /// on its lines between the first and the last of `frequencies_hz`.
    pub(super) fn curve(
        &self,
        frequencies_hz: &[f64],
        field: &str,
    ) -> Result<(Vec<f64>, Vec<Complex64>), RodlabError> {
        let body = self.impact_body()?;
        let frequencies_hz: Vec<f64> = match (body.domain(), frequencies_hz) {
            (
                Domain::Lines {
                    frequency_step_hz,
                    n_lines,
                },
                [from, .., to],
            ) => {
                let lines = (1..n_lines).map(|line| line as f64 * frequency_step_hz);
                lines.filter(|f| f >= from && f <= to).collect()
            }
            _ => frequencies_hz.to_vec(),
        };
        let at = |f: &f64| body.mobility_at(Complex64::new(0.0, std::f64::consts::TAU * f));
        let values = frequencies_hz.iter().map(at).collect::<Result<Vec<_>, _>>();
        let values = values.in_step(field)?;
        Ok((frequencies_hz, values))
    }
}

impl MeasuredMember {
    /// Creates the member. In a draw of the whole job, the member is drawn too.
    fn of(
        mut points: MeasuredPoints,
        (scale, delay): (f64, f64),
        field: &str,
        context: &JobContext<'_>,
    ) -> Result<Self, RodlabError> {
        if let Some(draw) = &context.draw {
            points = draw
                .with_random(|random| points.drawn(scale, delay, random))
                .in_step(field)?;
        }
        Ok(Self {
            points,
            scale,
            delay,
        })
    }

    fn drawn(&self, field: &str, draws: &mut Draws<'_>) -> Result<SharedSubstructure, RodlabError> {
        let mut entries = self.points.entries().iter();
        if entries.any(MeasuredBody::is_uncertain) || self.scale > 0.0 || self.delay > 0.0 {
            draws.n_drawn += 1;
        }
        let drawn = self.points.drawn(self.scale, self.delay, draws.random);
        Ok(Arc::new(drawn.in_step(field)?))
    }
}

fn has_measured(assembly: &AssemblySheet) -> bool {
    assembly.members.iter().any(|member| {
        member.measured.is_some() || matches!(member.body, Some(BodySheet::Measured(_)))
    })
}

fn read_assembly(
    sheet: &AssemblySheet,
    materials: &Materials,
    field: &str,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<FaceBody, RodlabError> {
    let mut measured = Vec::with_capacity(sheet.members.len());
    for (at, member) in sheet.members.iter().enumerate() {
        let place = format!("{field}.members[{at}]");
        measured.push(match (&member.measured, &member.body) {
            (Some(points), _) => Some(read_points(points, &place, context, outcome)?),
            (None, Some(BodySheet::Measured(body))) => {
                let face = read_measured((body, Place::Point), &place, context, outcome)?;
                let points = MeasuredPoints::of(1, vec![face.body]).in_step(&place)?;
                let errors = (face.scale, face.delay);
                Some(MeasuredMember::of(points, errors, &place, context)?)
            }
            _ => None,
        });
    }
    let body = sheet.assembled(field, |at| {
        match measured.get(at).and_then(Option::as_ref) {
            Some(member) => Ok(Arc::new(member.points.clone()) as Arc<_>),
            None => sheet.computed_member(at, materials, field),
        }
    })?;
    if body.front_impedance().is_none() {
        return Err(RodlabError::request(
            field,
            format!("without the front impedance of \"{}\"", sheet.face),
            "a computed struck member, or its `front_impedance`",
        ));
    }
    Ok(FaceBody::Assembly {
        body: Arc::new(body),
        measured,
    })
}

fn read_points(
    sheet: &MeasuredPointsSheet,
    field: &str,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<MeasuredMember, RodlabError> {
    let (points, compared) = sheet.read(field, |pair, is_one_point| {
        let place = if is_one_point {
            Place::Point
        } else {
            Place::Transfer
        };
        Ok(read_measured((pair, place), field, context, outcome)?.body)
    })?;
    for directions in compared {
        directions.tell(field, outcome);
    }
    let scale = sheet.scale_uncertainty.as_ref().map_or(0.0, Exact::si);
    let delay = sheet.delay_uncertainty.as_ref().map_or(0.0, Exact::si);
    MeasuredMember::of(points, (scale, delay), field, context)
}

/// Place at which a mobility was measured.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// At the face of a body.
    Face,
    /// At a point of a member; all points of the member are drawn together.
    Point,
    /// Between two points.
    Transfer,
}

fn read_measured(
    (sheet, place): (&MeasuredBodySheet, Place),
    field: &str,
    context: &JobContext<'_>,
    outcome: &mut Outcome,
) -> Result<MeasuredFace, RodlabError> {
    let mut response = sheet.response().read(context.folder, field, outcome)?;
    if let Some(up_to) = &sheet.up_to {
        cut(&mut response, up_to, &format!("{field}.up_to"))?;
    }
    if let Some(scale) = &sheet.scale_uncertainty {
        response = response
            .with_common_error(scale.si())
            .in_step(format!("{field}.scale_uncertainty"))?;
    }
    let mut first_measured = 1;
    if let Some(completion) = &sheet.complete {
        let field = format!("{field}.complete");
        (response, first_measured) = completion.complete(&response, &sheet.support, &field)?;
    }
    let scale = sheet.scale_uncertainty.as_ref().map_or(0.0, Exact::si);
    let delay = sheet.delay_uncertainty.as_ref().map_or(0.0, Exact::si);
    let mut body = measured_body(
        &response,
        &sheet.support,
        sheet.front_impedance.as_ref().map(Stated::with_uncertainty),
        field,
    )?
    .with_first_measured(first_measured)
    .with_delay_error(delay)
    .in_step(format!("{field}.delay_uncertainty"))?;
    outcome.by_default(format!("{field}.support"), sheet.support.in_words());
    outcome.by_default(format!("{field}.scale_uncertainty"), "none");
    outcome.by_default(format!("{field}.delay_uncertainty"), "none");
    outcome.by_default(
        format!("{field}.causal"),
        "the part before the impulse is kept",
    );
    outcome.by_default(format!("{field}.passive"), "real parts below 0 are kept");
    if place != Place::Transfer {
        let before = outcome.summary.len();
        let (quantities, warnings) = (outcome.quantities.len(), outcome.warnings.len());
        let failed = screening::tell(&body.screen(), outcome);
        // the names of quantities and warnings must distinguish the two bodies
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
    }
    let onto = match (sheet.causal, sheet.passive) {
        (true, true) => Some(Projection::CausalAndPassive),
        (true, false) => Some(Projection::Causal),
        (false, true) => Some(Projection::Passive),
        (false, false) => None,
    };
    if let Some(onto) = onto {
        let projected = body.projected(onto);
        tell_change(&projected.change_from(&body), onto, field, outcome);
        body = projected;
    }
    if let (Some(draw), Place::Face) = (&context.draw, place) {
        body = draw
            .with_random(|random| body.drawn(scale, delay, random))
            .in_step(field)?;
    }
    let weighed = sheet.support.weighed();
    Ok(MeasuredFace {
        body,
        scale,
        delay,
        mass_error: weighed.map_or(0.0, |weighed| weighed.standard_error),
    })
}

/// Root mean square change by a projection, in standard errors of the lines, above which no body of
/// the required kind agrees with the lines.
const MOVED: f64 = 2.0;

/// Reports how much a projection onto causal or passive bodies has changed the lines.
fn tell_change(change: &LineChange, onto: Projection, field: &str, outcome: &mut Outcome) {
    let lines = format!(
        "{} lines changed, by {:.2} % of the mobility in total",
        change.n_lines,
        100.0 * change.relative
    );
    // because the lines end at a finite frequency, jumps of the impulse response are spread ahead
    // of the impulse: a change to a causal body therefore does not show that the lines are wrong
    let by_end = onto != Projection::Passive;
    let onto = match onto {
        Projection::Passive => "passive",
        Projection::Causal => "causal",
        _ => "causal and passive",
    };
    let holds = by_end || change.in_errors.is_none_or(|moved| moved <= MOVED);
    let mut verdict = match change.largest {
        None => {
            format!("{lines}; the lines have no standard errors, so the change cannot be tested")
        }
        Some((_, most)) => format!("{lines}; one line by as much as {most:.1} standard errors"),
    };
    if by_end {
        verdict.push_str(
            "; the change includes the response ahead of the impulse that arises because the lines end",
        );
    }
    if !holds {
        outcome.doubt(format!(
            "{field}: no {onto} body agrees with the lines within their errors: {verdict}"
        ));
    }
    let name = format!("{field}: change to the nearest {onto} body, in standard errors");
    let quantity = Quantity::of(name, "", change.in_errors, verdict);
    outcome.quantities.push(quantity.valid_if(holds));
}
