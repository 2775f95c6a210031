//! Choice of a regularisation parameter, and the curve used for it.

use super::modes::{Filter, Modes};
use super::outcome::{ChoiceVerdict, ChosenParameter, CurvePoint};
use super::{Parameter, Regularisation};
use crate::ImpulseError;
use crate::error::check_positive;

/// Number of points of the curve between the weakest and the strongest component, evenly in the
/// logarithm.
const POINTS: usize = 81;
/// Factor by which the curve extends beyond the strongest component.
const BEYOND: f64 = 10.0;
/// Factor by which the curve extends below the weakest component: the regularisation there removes
/// less than a part in a million, which equals none.
const AS_NONE: f64 = 1e-6;
/// Relative difference below which scores count as equal.
const FLAT: f64 = 1e-9;
/// Number of golden-section steps: the relative accuracy of a parameter is 0.618^30 of two
/// intervals of the curve.
const STEPS: usize = 30;

pub(super) fn choose(
    modes: &Modes,
    regularisation: Regularisation,
    noise_is_known: bool,
) -> Result<Option<ChosenParameter>, ImpulseError> {
    let filter = Filter::of(regularisation);
    let parameter = match regularisation {
        Regularisation::None => return Ok(None),
        Regularisation::Tikhonov { parameter, .. } | Regularisation::Truncated { parameter } => {
            parameter
        }
    };
    if let Parameter::Given(value) = parameter {
        check_positive("regularisation parameter [unit of w |H|^2]", value)?;
        return Ok(Some(ChosenParameter {
            value,
            method: parameter,
            curve: Vec::new(),
            verdict: ChoiceVerdict::Given,
        }));
    }
    if parameter == Parameter::Discrepancy && !noise_is_known {
        return Err(ImpulseError::NoiseNotKnown);
    }
    let Some(range) = modes.range() else {
        return Err(ImpulseError::NoUsableLine {
            n_lines: modes.strengths.len(),
        });
    };
    let parameters = grid(range);
    let mut curve: Vec<CurvePoint> = parameters.iter().map(|p| modes.point(filter, *p)).collect();
    let score = |modes: &Modes, point: &CurvePoint| match parameter {
        Parameter::GeneralisedCrossValidation => cross_validation(modes, point),
        Parameter::Discrepancy => {
            modes.sacrificed(filter, point.parameter) / modes.n_dimensions() - 1.0
        }
        _ => -modes.curvature(point.parameter),
    };
    if parameter == Parameter::LCurve && filter == Filter::Truncated {
        score_by_chord(&mut curve);
    } else {
        for point in &mut curve {
            point.score = score(modes, point);
        }
    }
    let (value, verdict) = if parameter == Parameter::Discrepancy {
        crossing(&curve, |p| score(modes, &modes.point(filter, p)))
    } else {
        let at = |p: f64| score(modes, &modes.point(filter, p));
        // a truncated curve has steps: its score is constant between its points
        lowest(&curve, (filter == Filter::Tikhonov).then_some(&at))
    };
    Ok(Some(ChosenParameter {
        value,
        method: parameter,
        curve,
        verdict,
    }))
}

fn grid((smallest, largest): (f64, f64)) -> Vec<f64> {
    let (from, to) = ((smallest * AS_NONE).ln(), (largest * BEYOND).ln());
    (0..POINTS)
        .map(|i| (from + (to - from) * i as f64 / (POINTS - 1) as f64).exp())
        .collect()
}

/// Returns $`n\rho^2/(n-\sum\varphi)^2`$; infinite if no degrees of freedom remain for validation.
fn cross_validation(modes: &Modes, point: &CurvePoint) -> f64 {
    if point.freedom_left > 0.0 {
        modes.n_data * point.squared_residual / point.freedom_left.powi(2)
    } else {
        f64::INFINITY
    }
}

/// Sets the score to minus the distance from the chord, on the side of the corner.
fn score_by_chord(curve: &mut [CurvePoint]) {
    let place = |p: &CurvePoint| [p.squared_residual.ln(), p.squared_norm.ln()];
    let is_on_plane = |p: &CurvePoint| place(p).iter().all(|x| x.is_finite());
    let ends = (
        curve.iter().find(|p| is_on_plane(p)).map(place),
        curve.iter().rfind(|p| is_on_plane(p)).map(place),
    );
    let (Some([x0, y0]), Some([x1, y1])) = ends else {
        return;
    };
    let length = (x1 - x0).hypot(y1 - y0);
    for point in curve {
        let [x, y] = place(point);
        let distance = ((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) / length;
        point.score = if distance.is_finite() {
            distance
        } else {
            f64::INFINITY
        };
    }
}

/// Returns the parameter of the lowest score, refined between its neighbours.
fn lowest(curve: &[CurvePoint], score: Option<&dyn Fn(f64) -> f64>) -> (f64, ChoiceVerdict) {
    let scored = curve
        .iter()
        .enumerate()
        .filter(|(_, p)| p.score.is_finite());
    let least = scored
        .clone()
        .map(|(_, p)| p.score)
        .fold(f64::INFINITY, f64::min);
    // choose the weakest regularisation among those whose scores differ only by rounding
    let best = scored
        .clone()
        .find(|(_, p)| p.score <= least + FLAT * least.abs());
    let Some((index, point)) = best else {
        let first = curve.first().map_or(f64::NAN, |p| p.parameter);
        return (first, ChoiceVerdict::NoCorner);
    };
    let before = index.checked_sub(1).and_then(|before| curve.get(before));
    let (Some(before), Some(after)) = (before, curve.get(index + 1)) else {
        return (point.parameter, ChoiceVerdict::AtEnd);
    };
    let Some(score) = score else {
        return (point.parameter, ChoiceVerdict::Found);
    };
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = (before.parameter.ln(), after.parameter.ln());
    for _ in 0..STEPS {
        let (c, d) = (b - golden * (b - a), a + golden * (b - a));
        if score(c.exp()) < score(d.exp()) {
            b = d;
        } else {
            a = c;
        }
    }
    ((0.5 * (a + b)).exp(), ChoiceVerdict::Found)
}

/// Returns the zero of the score, which increases.
fn crossing(curve: &[CurvePoint], score: impl Fn(f64) -> f64) -> (f64, ChoiceVerdict) {
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else {
        return (f64::NAN, ChoiceVerdict::NoCorner);
    };
    if last.score < 0.0 {
        return (last.parameter, ChoiceVerdict::NotReached);
    }
    if first.score > 0.0 {
        return (first.parameter, ChoiceVerdict::AtEnd);
    }
    let (mut a, mut b) = (first.parameter.ln(), last.parameter.ln());
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if score(middle.exp()) < 0.0 {
            a = middle;
        } else {
            b = middle;
        }
    }
    // the largest parameter that the noise still allows
    (a.exp(), ChoiceVerdict::Found)
}
