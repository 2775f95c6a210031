//! Ranges of the axes, computed from the data drawn. `report/script.js` of `rodlab` uses the same
//! rules.

use super::{Axis, Mark, Panel, Scale};

/// Free margin above and below, as a fraction of the span of the data.
const MARGIN: f64 = 0.05;
/// Limit of the widening of the range by error bars and bands, as a fraction of the span of the
/// points and lines, so that very long error bars do not flatten the curve.
const REACH: f64 = 0.6;

/// Returns the ranges of both axes of every panel.
///
/// Panels with the same horizontal axis share one range, the first one that is stated or, without a
/// stated range, one that shows the data of all these panels. A panel that states its own range
/// keeps it.
pub(super) fn spans(panels: &[Panel]) -> Vec<[[f64; 2]; 2]> {
    let same = |one: &Axis, other: &Axis| {
        one.label == other.label && one.unit == other.unit && one.scale == other.scale
    };
    panels
        .iter()
        .map(|panel| {
            let together = || panels.iter().filter(|other| same(&other.x, &panel.x));
            let x = asked(&panel.x)
                .or_else(|| together().find_map(|other| asked(&other.x)))
                .unwrap_or_else(|| {
                    let mut seen = NOTHING;
                    let mut margin = 0.0_f64;
                    for other in together() {
                        let (here, points) = abscissae(other);
                        seen = [seen[0].min(here[0]), seen[1].max(here[1])];
                        if points || other.equal_axes {
                            margin = MARGIN;
                        }
                    }
                    widened(seen, &panel.x, margin)
                });
            let y =
                asked(&panel.y).unwrap_or_else(|| widened(ordinates(panel, x), &panel.y, MARGIN));
            [x, y]
        })
        .collect()
}

/// Returns the stated range, if it is valid.
fn asked(axis: &Axis) -> Option<[f64; 2]> {
    axis.range
        .filter(|range| range[0] < range[1] && range.iter().all(|end| on(axis, *end)))
}

/// Returns true if an axis can show `value`.
pub(super) fn on(axis: &Axis, value: f64) -> bool {
    value.is_finite() && (axis.scale == Scale::Linear || value > 0.0)
}

/// Returns true if at least one mark is visible on axes with these ranges.
pub(super) fn shows_anything(panel: &Panel, [x, _]: [[f64; 2]; 2]) -> bool {
    let seen = ordinates(panel, x);
    seen[0] <= seen[1]
}

const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

fn with([least, greatest]: [f64; 2], value: f64) -> [f64; 2] {
    [least.min(value), greatest.max(value)]
}

fn abscissae(panel: &Panel) -> ([f64; 2], bool) {
    let mut seen = NOTHING;
    let mut points = false;
    for mark in &panel.marks {
        let x = match mark {
            Mark::Line { x, .. } | Mark::Band { x, .. } => x.as_slice(),
            Mark::Points { x, .. } => {
                points = true;
                x
            }
            Mark::At { x, .. } => std::slice::from_ref(x),
        };
        for &x in x.iter().filter(|&&x| on(&panel.x, x)) {
            seen = with(seen, x);
        }
    }
    (seen, points)
}

fn ordinates(panel: &Panel, shown: [f64; 2]) -> [f64; 2] {
    let mut core = NOTHING;
    let mut reach = NOTHING;
    let inside = |x: &f64| on(&panel.x, *x) && (shown[0]..=shown[1]).contains(x);
    for mark in &panel.marks {
        let (x, rows, to): (&[f64], [&[f64]; 2], &mut [f64; 2]) = match mark {
            Mark::Line { x, y, .. } | Mark::Points { x, y, .. } => (x, [y, &[]], &mut core),
            Mark::Band {
                x, lower, upper, ..
            } => (x, [lower, upper], &mut reach),
            Mark::At { .. } => continue,
        };
        for row in rows {
            for (_, &y) in x
                .iter()
                .zip(row)
                .filter(|(x, y)| inside(x) && on(&panel.y, **y))
            {
                *to = with(*to, y);
            }
        }
        if let Mark::Points { x, y, error, .. } = mark {
            for ((_, y), error) in x.iter().zip(y).zip(error).filter(|((x, _), _)| inside(x)) {
                for end in [y - error, y + error] {
                    if on(&panel.y, end) {
                        reach = with(reach, end);
                    }
                }
            }
        }
    }
    if core[0] > core[1] {
        return reach;
    }
    if reach[0] > reach[1] {
        return core;
    }
    let logarithmic = panel.y.scale == Scale::Logarithmic;
    let to = |value: f64| if logarithmic { value.log10() } else { value };
    let back = |place: f64| {
        if logarithmic {
            10_f64.powf(place)
        } else {
            place
        }
    };
    let span = to(core[1]) - to(core[0]);
    if span <= 0.0 {
        return with(with(core, reach[0]), reach[1]);
    }
    [
        core[0].min(reach[0].max(back(to(core[0]) - REACH * span))),
        core[1].max(reach[1].min(back(to(core[1]) + REACH * span))),
    ]
}

fn widened([least, greatest]: [f64; 2], axis: &Axis, margin: f64) -> [f64; 2] {
    let logarithmic = axis.scale == Scale::Logarithmic;
    if least > greatest {
        return if logarithmic { [1.0, 10.0] } else { [0.0, 1.0] };
    }
    if logarithmic {
        let factor = (greatest / least).powf(margin);
        return if greatest / least < 1.0 + 1e-9 {
            [least / 2.0, greatest * 2.0]
        } else {
            [least / factor, greatest * factor]
        };
    }
    let span = greatest - least;
    if span <= 1e-12 * greatest.abs().max(least.abs()) {
        let free = if greatest.abs() > 0.0 {
            0.1 * greatest.abs()
        } else {
            1.0
        };
        return [least - free, greatest + free];
    }
    [least - margin * span, greatest + margin * span]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Role;

    fn panel(y: Axis, marks: Vec<Mark>) -> Panel {
        Panel {
            x: Axis::linear("frequency", "kHz"),
            y,
            marks,
            greyed: vec![],
            equal_axes: false,
        }
    }

    fn one(panel: Panel) -> [[f64; 2]; 2] {
        spans(&[panel]).remove(0)
    }

    fn line(x: Vec<f64>, y: Vec<f64>) -> Mark {
        Mark::Line {
            name: String::new(),
            role: Role::First,
            x,
            y,
        }
    }

    #[test]
    fn an_error_of_a_hundred_times_the_value_does_not_flatten_the_curve() {
        let band = Mark::Band {
            name: String::new(),
            role: Role::First,
            x: vec![0.0, 1.0],
            lower: vec![1.9, -300.0],
            upper: vec![2.1, 300.0],
        };
        let [_, [from, to]] = one(panel(
            Axis::linear("E'", "GPa"),
            vec![band, line(vec![0.0, 1.0], vec![2.0, 3.0])],
        ));
        assert!(from < 1.9 && from > 1.0, "from {from}");
        assert!(to > 3.0 && to < 4.0, "to {to}");
    }

    #[test]
    fn only_what_is_shown_sets_the_height() {
        let mut panel = panel(
            Axis::linear("acceleration", "m/s2"),
            vec![line(vec![0.0, 1.0, 2.0], vec![1.0, 2.0, 1000.0])],
        );
        panel.x = panel.x.within([0.0, 1.5]);
        assert!(one(panel.clone())[1][1] < 2.2, "{:?}", one(panel));
    }

    #[test]
    fn zero_is_not_on_a_logarithmic_axis() {
        let [_, [from, to]] = one(panel(
            Axis::logarithmic("mobility", "m/s/N"),
            vec![line(vec![0.0, 1.0, 2.0, 3.0], vec![0.0, -1.0, 1e-13, 1e-9])],
        ));
        assert!(from > 1e-14 && from < 1e-13, "from {from}");
        assert!(to > 1e-9 && to < 1e-8, "to {to}");
    }

    #[test]
    fn nothing_and_a_constant_have_a_range_too() {
        let empty = one(panel(Axis::linear("y", ""), vec![]));
        assert!(empty.iter().all(|[from, to]| from < to), "{empty:?}");
        let flat = line(vec![0.0, 1.0], vec![5.0, 5.0]);
        let [_, [from, to]] = one(panel(Axis::linear("y", ""), vec![flat]));
        assert!(from < 5.0 && to > 5.0, "{from} to {to}");
    }

    #[test]
    fn panels_of_one_axis_have_one_range() {
        let at = |x: Vec<f64>| {
            let y = vec![1.0; x.len()];
            panel(Axis::linear("y", ""), vec![line(x, y)])
        };
        let mut other = at(vec![100.0, 200.0]);
        other.x.unit = "Hz".into();
        let ranges: Vec<[f64; 2]> = spans(&[at(vec![1.0, 4.0]), at(vec![2.0, 9.0]), other])
            .into_iter()
            .map(|[x, _]| x)
            .collect();
        assert_eq!(ranges, [[1.0, 9.0], [1.0, 9.0], [100.0, 200.0]]);

        let mut asked = at(vec![1.0, 4.0]);
        asked.x = asked.x.within([0.0, 5.0]);
        let ranges = spans(&[at(vec![2.0, 9.0]), asked]);
        assert_eq!([ranges[0][0], ranges[1][0]], [[0.0, 5.0]; 2]);
    }
}
