//! Figures 5 and 6 of paper E on the virtual bodies of `testbed`: the mobility of a face, measured
//! and predicted, and its impact on the long rod.

use impulse::{FaceMobility, ImpedanceHead, StickProblem, StickUncertainty, ZeroLine, lines_of};
use labio::MergedResponse;
use num_complex::Complex64;
use testbed::claim::Fallible;
use testbed::papers::paper_e::PaperE;
use testbed::papers::paper_e::bodies::Face;
use testbed::papers::paper_e::hammer_tests::BELOW_GAUGE;

/// Returns the mobility of the face after subtraction of the mass of the head.
pub(crate) fn bare_face(paper: &PaperE, merged: &MergedResponse) -> Fallible<FaceMobility> {
    let (accelerance, variance) = paper.on_lines(merged)?;
    let head = ImpedanceHead::new(BELOW_GAUGE)?;
    Ok(head.face_mobility(&accelerance, &variance, paper.frequency_step_hz())?)
}

/// Returns the mobility of the bare face, predicted on the lines of the measurement.
pub(crate) fn predicted(paper: &PaperE, face: Face) -> Fallible<Vec<Complex64>> {
    let body = paper.causal(face)?;
    Ok(lines_of(&body, paper.frequency_step_hz(), paper.n_lines())?)
}

/// Returns the predicted mobility of the long rod, which is taken as semi-infinite.
pub(crate) fn long_rod(paper: &PaperE) -> Fallible<Vec<Complex64>> {
    let rod = paper.long_rod()?;
    Ok(lines_of(&rod, paper.frequency_step_hz(), paper.n_lines())?)
}

/// Returns the impact on the long rod, for this mobility of the face.
pub(crate) fn on_long_rod<'a>(
    paper: &PaperE,
    face: Face,
    body: &'a [Complex64],
    rod: &'a [Complex64],
) -> Fallible<StickProblem<'a>> {
    Ok(StickProblem {
        first: body,
        second: rod,
        frequency_step_hz: paper.frequency_step_hz(),
        impact_velocity: paper.case(face)?.impact_velocity,
        zero_line: ZeroLine::EffectiveMass(paper.mass(face)?),
        roll_off_from_hz: None,
        interpolation: 1,
        until: None,
    })
}

/// Returns the errors of a prediction from this measurement.
pub(crate) fn uncertainty(measured: &FaceMobility) -> StickUncertainty<'_> {
    StickUncertainty {
        first_variance: Some(&measured.variance),
        ..StickUncertainty::default()
    }
}
