//! Lines and words as graphic elements.

use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, TextAnchor};

use crate::figure::push_decimal;

/// Colour of text and axes.
pub(super) const INK: &str = "#1c1c1c";
/// Size of the numbers at ticks and of the names of vertical lines.
pub(super) const SMALL: u32 = 11;

/// Lines from the data of a path.
pub(super) fn path(d: String, color: &str, width: f64) -> Primitive {
    Primitive::Path(Box::new(PathData {
        d,
        fill: None,
        stroke: Color::from(color),
        stroke_width: width,
        opacity: None,
        stroke_dasharray: None,
    }))
}

/// A place in pixels, to a tenth.
#[expect(
    clippy::cast_possible_truncation,
    reason = "places are within some thousand pixels"
)]
fn push_pixel(d: &mut String, pixel: f64) {
    push_decimal(d, (10.0 * pixel).round() as i64, 1);
}

/// A line through `points`, in fewer bytes than `Primitive::PolyLine` takes.
pub(super) fn stroke(
    points: &[(f64, f64)],
    color: &str,
    width: f64,
    dash: Option<&str>,
) -> Primitive {
    let mut d = String::with_capacity(12 * points.len());
    for (index, (x, y)) in points.iter().enumerate() {
        d.push(if index == 0 { 'M' } else { ' ' });
        push_pixel(&mut d, *x);
        d.push(' ');
        push_pixel(&mut d, *y);
    }
    Primitive::Path(Box::new(PathData {
        d,
        fill: None,
        stroke: Color::from(color),
        stroke_width: width,
        opacity: None,
        stroke_dasharray: dash.map(ToOwned::to_owned),
    }))
}

/// A point of a line without neighbours.
pub(super) fn dot(x: f64, y: f64, radius: f64, color: &str) -> Primitive {
    Primitive::Circle {
        cx: x,
        cy: y,
        r: radius,
        fill: Color::from(color),
        fill_opacity: None,
        stroke: None,
        stroke_width: None,
    }
}

/// A text element.
pub(super) fn words(
    content: &str,
    x: f64,
    y: f64,
    size: u32,
    anchor: TextAnchor,
    rotate: Option<f64>,
) -> Primitive {
    Primitive::Text {
        x,
        y,
        content: content.to_owned(),
        size,
        anchor,
        rotate,
        bold: false,
        color: Some(Color::from(INK)),
    }
}
