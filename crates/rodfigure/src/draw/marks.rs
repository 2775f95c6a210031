//! Drawing of lines, points with error bars, and bands.

use std::fmt::Write;

use super::mapping::Mapping;
use super::svg::{Paint, Svg};
use crate::palette::{Marker, look};
use crate::{Mark, Role};

pub(super) fn draw_mark(mark: &Mark, x: &Mapping, y: &Mapping, svg: &mut Svg) {
    let at = |pair: (&f64, &f64)| (x.at(*pair.0), y.at(*pair.1));
    match mark {
        Mark::Line {
            role,
            x: abscissae,
            y: ordinates,
            ..
        } => {
            let look = look(*role);
            for points in pieces(abscissae.iter().zip(ordinates).map(at)) {
                // a single point between two gaps is drawn as a dot
                if let [(x, y)] = points[..] {
                    svg.circle([x, y], 0.8 * look.width, look.color);
                } else {
                    svg.line(&points, line(*role));
                }
            }
        }
        Mark::Points {
            role,
            x: abscissae,
            y: ordinates,
            error,
            ..
        } => {
            let mut bars = String::new();
            let mut outline = String::new();
            for (index, pair) in abscissae.iter().zip(ordinates).enumerate() {
                let (px, py) = at(pair);
                if !px.is_finite() || !py.is_finite() {
                    continue;
                }
                marker(&mut outline, *role, px, py);
                let Some(error) = error.get(index).filter(|error| error.is_finite()) else {
                    continue;
                };
                let low = y.at_or_below(pair.1 - error);
                let high = y.at_or_below(pair.1 + error);
                _ = write!(bars, "M{px} {low}V{high}m-2.5 0h5M{} {low}h5", px - 2.5);
            }
            if !bars.is_empty() {
                svg.path(&bars, Paint::line(look(*role).color, 1.0));
            }
            if !outline.is_empty() {
                svg.path(&outline, outlined(*role));
            }
        }
        Mark::Band {
            role,
            x: abscissae,
            lower,
            upper,
            ..
        } => {
            let edges =
                abscissae
                    .iter()
                    .zip(lower.iter().zip(upper))
                    .map(|(value, (lower, upper))| {
                        (x.at(*value), [y.at_or_below(*lower), y.at_or_below(*upper)])
                    });
            let outline = outline_of(edges);
            if !outline.is_empty() {
                svg.path(&outline, area(*role));
            }
        }
        Mark::At { .. } => {}
    }
}

/// Splits the points at NaN.
fn pieces(points: impl Iterator<Item = (f64, f64)>) -> Vec<Vec<(f64, f64)>> {
    let mut pieces = Vec::new();
    let mut piece = Vec::new();
    for (x, y) in points {
        if x.is_finite() && y.is_finite() {
            piece.push((x, y));
        } else if !piece.is_empty() {
            pieces.push(std::mem::take(&mut piece));
        }
    }
    if !piece.is_empty() {
        pieces.push(piece);
    }
    pieces
}

/// Returns the outline of the band between two edges, in pieces separated by NaN.
fn outline_of(edges: impl Iterator<Item = (f64, [f64; 2])>) -> String {
    let mut d = String::new();
    let mut piece: Vec<(f64, [f64; 2])> = Vec::new();
    let end = |d: &mut String, piece: &mut Vec<(f64, [f64; 2])>| {
        for (index, (x, edge)) in piece.iter().enumerate() {
            _ = write!(d, "{}{x} {}", if index == 0 { 'M' } else { ' ' }, edge[1]);
        }
        for (x, edge) in piece.iter().rev() {
            _ = write!(d, " {x} {}", edge[0]);
        }
        if !piece.is_empty() {
            d.push('z');
        }
        piece.clear();
    };
    for (x, edge) in edges {
        if x.is_finite() && edge.iter().all(|edge| edge.is_finite()) {
            piece.push((x, edge));
        } else {
            end(&mut d, &mut piece);
        }
    }
    end(&mut d, &mut piece);
    d
}

/// Appends the marker of `role`, at (`x`, `y`), to the data of a path.
pub(super) fn marker(d: &mut String, role: Role, x: f64, y: f64) {
    let shape = look(role).marker;
    if let Some(outline) = shape.outline() {
        for (index, (dx, dy)) in outline.iter().enumerate() {
            let command = if index == 0 { 'M' } else { 'L' };
            _ = write!(d, "{command}{:.1} {:.1}", x + dx, y + dy);
        }
        d.push('z');
        return;
    }
    _ = match shape {
        Marker::Cross => write!(d, "M{:.1} {:.1}l6 6m-6 0l6 -6", x - 3.0, y - 3.0),
        Marker::Dot => write!(d, "M{:.1} {y:.1}a2 2 0 1 0 4 0a2 2 0 1 0 -4 0z", x - 2.0),
        _ => write!(
            d,
            "M{:.1} {y:.1}a2.8 2.8 0 1 0 5.6 0a2.8 2.8 0 1 0 -5.6 0z",
            x - 2.8
        ),
    };
}

pub(super) fn line(role: Role) -> Paint {
    let look = look(role);
    Paint {
        dash: look.dash,
        ..Paint::line(look.color, look.width)
    }
}

pub(super) fn area(role: Role) -> Paint {
    Paint::area(look(role).color, 0.22)
}

pub(super) fn outlined(role: Role) -> Paint {
    let look = look(role);
    match look.marker {
        Marker::Cross => Paint::line(look.color, 1.3),
        Marker::Dot => Paint {
            fill: look.color,
            ..Paint::line(look.color, 0.0)
        },
        _ => Paint {
            fill: look.color,
            ..Paint::line("#ffffff", 0.5)
        },
    }
}
