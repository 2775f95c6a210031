//! One panel: its frame, ticks and labels, and what is drawn on it.

use std::fmt::Write;

use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, TextAnchor};

use super::legend::Legend;
use super::text;
use crate::figure::palette::{Marker, look};
use crate::figure::span::{on, spans};
use crate::figure::ticks::{Ticks, ticks};
use crate::figure::{Axis, Mark, Panel, Role, Scale, push_decimal};

/// Colour of text and axes.
pub(super) const INK: &str = "#1c1c1c";
/// Colour of ranges where the result does not hold.
pub(super) const GREY: &str = "#808080";
pub(super) const GREY_OPACITY: f64 = 0.2;
const GRID: &str = "#dddddd";
/// Size of the numbers at ticks and of the names of vertical lines.
const SMALL: u32 = 11;
/// Size of the labels of axes.
const LABEL: u32 = 12;
/// Height of the axes.
const HEIGHT: f64 = 230.0;
/// Height of axes on which a unit is as long in both directions.
const EQUAL_HEIGHT: f64 = 400.0;
const BELOW: f64 = 40.0;
/// Height of a row of names of vertical lines.
const NAMES: f64 = 14.0;

/// Where a panel is drawn.
pub(super) struct Place {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub clip: String,
}

/// A panel with what its margins depend on.
pub(super) struct Arranged<'a> {
    panel: &'a Panel,
    x: [f64; 2],
    y: [f64; 2],
}

/// Values to pixels.
struct Mapping {
    logarithmic: bool,
    from: f64,
    per_unit: f64,
    start: f64,
}

impl Mapping {
    fn new(axis: &Axis, range: [f64; 2], start: f64, end: f64) -> Self {
        let logarithmic = axis.scale == Scale::Logarithmic;
        let [from, to] = if logarithmic {
            range.map(f64::log10)
        } else {
            range
        };
        Self {
            logarithmic,
            from,
            per_unit: (end - start) / (to - from),
            start,
        }
    }

    /// Pixel of `value`; far outside stays near enough for every viewer, and what the axis cannot show is NaN.
    fn at(&self, value: f64) -> f64 {
        let place = if self.logarithmic {
            value.log10()
        } else {
            value
        };
        if place.is_nan() || self.logarithmic && value <= 0.0 {
            return f64::NAN;
        }
        // tenths of pixels: nobody sees more, and they are shorter
        let pixel = self.start + (place - self.from) * self.per_unit;
        (pixel.clamp(-5000.0, 9000.0) * 10.0).round() / 10.0
    }
}

impl<'a> Arranged<'a> {
    pub(super) fn of(panel: &'a Panel) -> Self {
        let [x, y] = spans(panel);
        Self { panel, x, y }
    }

    fn height(&self) -> f64 {
        if self.panel.equal_axes {
            EQUAL_HEIGHT
        } else {
            HEIGHT
        }
    }

    fn y_ticks(&self, y: [f64; 2]) -> Ticks {
        ticks(&self.panel.y, y, (self.height() / 45.0).floor())
    }

    /// What the numbers and the label of the vertical axis take.
    pub(super) fn left_margin(&self) -> f64 {
        let widest = self
            .y_ticks(self.y)
            .major
            .iter()
            .map(|(_, label)| text::width(label, f64::from(SMALL)))
            .fold(0.0, f64::max);
        widest + 8.0 + 22.0
    }

    /// Draws the panel and returns where it ends.
    pub(super) fn draw(
        &self,
        place: &Place,
        elements: &mut Vec<Primitive>,
        clips: &mut Vec<String>,
    ) -> f64 {
        let legend = Legend::of(self.panel, place.right - place.left);
        legend.draw(place.left, place.top, elements);
        let (x_range, y_range) = self.ranges(place);
        let x = Mapping::new(&self.panel.x, x_range, place.left, place.right);
        let lines = self.names(&x, place);
        let mut names = 0.0;
        for _ in 0..lines.iter().map(|line| line.row + 1).max().unwrap_or(0) {
            names += NAMES;
        }
        let top = (place.top + legend.height() + names + 4.0).round();
        let bottom = top + self.height();
        let y = Mapping::new(&self.panel.y, y_range, bottom, top);
        let frame = Frame {
            left: place.left,
            right: place.right,
            top,
            bottom,
        };
        let on_x = ticks(
            &self.panel.x,
            x_range,
            ((place.right - place.left) / 85.0).floor(),
        );
        let on_y = self.y_ticks(y_range);

        frame.clip(&place.clip, clips, elements);
        for greyed in &self.panel.greyed {
            let end = |value: f64, otherwise: f64| {
                Some(x.at(value))
                    .filter(|pixel| pixel.is_finite())
                    .unwrap_or(otherwise)
            };
            let from = end(greyed.from, frame.left).max(frame.left);
            let to = end(greyed.to, frame.right).min(frame.right);
            if to > from {
                elements.push(Primitive::Rect {
                    x: from,
                    y: top,
                    width: to - from,
                    height: bottom - top,
                    fill: Color::from(GREY),
                    stroke: None,
                    stroke_width: None,
                    opacity: Some(GREY_OPACITY),
                });
            }
        }
        frame.grid(&x, &y, &on_x, &on_y, elements);
        for line in &lines {
            elements.push(stroke(
                &[(line.pixel, top), (line.pixel, bottom)],
                INK,
                1.0,
                Some("5 3"),
            ));
        }
        for mark in &self.panel.marks {
            self.draw_mark(mark, &x, &y, elements);
        }
        elements.push(Primitive::ClipEnd);
        for line in &lines {
            let mut row = 0.0;
            for _ in 0..line.row {
                row += NAMES;
            }
            let baseline = top - 4.0 - row;
            elements.push(stroke(
                &[(line.pixel, top), (line.pixel, top - 3.0 - row)],
                INK,
                1.0,
                None,
            ));
            elements.push(words(
                line.name,
                line.text_from,
                baseline,
                SMALL,
                TextAnchor::Start,
                None,
            ));
        }
        frame.axes(&x, &y, &on_x, &on_y, elements);
        let label_y = bottom + 35.0;
        elements.push(words(
            &title(&self.panel.x),
            0.5 * (frame.left + frame.right),
            label_y,
            LABEL,
            TextAnchor::Middle,
            None,
        ));
        elements.push(words(
            &title(&self.panel.y),
            super::EDGE + 11.0,
            0.5 * (top + bottom),
            LABEL,
            TextAnchor::Middle,
            Some(-90.0),
        ));
        bottom + BELOW
    }

    /// The ranges; with equal axes the shorter one is widened on both sides.
    fn ranges(&self, place: &Place) -> ([f64; 2], [f64; 2]) {
        let linear = self.panel.x.scale == Scale::Linear && self.panel.y.scale == Scale::Linear;
        if !self.panel.equal_axes || !linear {
            return (self.x, self.y);
        }
        let per_pixel = |range: [f64; 2], pixels: f64| (range[1] - range[0]) / pixels;
        let (width, height) = (place.right - place.left, self.height());
        let scale = per_pixel(self.x, width).max(per_pixel(self.y, height));
        let widened = |range: [f64; 2], pixels: f64| {
            let middle = 0.5 * (range[0] + range[1]);
            [middle - 0.5 * scale * pixels, middle + 0.5 * scale * pixels]
        };
        (widened(self.x, width), widened(self.y, height))
    }

    /// Vertical lines with the rows of their names. A name begins at its line and stands above every line that it reaches to, so
    /// that no line runs through a name.
    fn names(&self, x: &Mapping, place: &Place) -> Vec<VerticalLine<'a>> {
        let mut lines: Vec<VerticalLine<'a>> = Vec::new();
        for mark in &self.panel.marks {
            let Mark::At { name, x: value } = mark else {
                continue;
            };
            let pixel = x.at(*value);
            if (place.left..=place.right).contains(&pixel) {
                let length = text::width(name, f64::from(SMALL));
                lines.push(VerticalLine {
                    name,
                    pixel,
                    text_from: (pixel + 3.0).min(place.right - length).max(place.left),
                    row: 0,
                });
            }
        }
        lines.sort_by(|a, b| a.pixel.total_cmp(&b.pixel));
        for index in (0..lines.len()).rev() {
            let reaches =
                lines[index].text_from + text::width(lines[index].name, f64::from(SMALL)) + 6.0;
            let above = lines[index + 1..]
                .iter()
                .filter(|line| line.pixel.min(line.text_from) < reaches)
                .map(|line| line.row + 1);
            lines[index].row = above.max().unwrap_or(0);
        }
        lines
    }

    fn draw_mark(&self, mark: &Mark, x: &Mapping, y: &Mapping, elements: &mut Vec<Primitive>) {
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
                    // a point between two gaps is a dot
                    if let [(x, y)] = points[..] {
                        elements.push(dot(x, y, 0.8 * look.width, look.color));
                    } else {
                        elements.push(stroke(&points, look.color, look.width, look.dash));
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
                let look = look(*role);
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
                    let end = |value: f64| {
                        Some(value)
                            .filter(|value| on(&self.panel.y, *value))
                            .map_or(9000.0, |value| y.at(value))
                    };
                    let (low, high) = (end(pair.1 - error), end(pair.1 + error));
                    _ = write!(bars, "M{px} {low}V{high}m-2.5 0h5M{} {low}h5", px - 2.5);
                }
                if !bars.is_empty() {
                    elements.push(Primitive::Path(Box::new(PathData {
                        d: bars,
                        fill: None,
                        stroke: Color::from(look.color),
                        stroke_width: 1.0,
                        opacity: None,
                        stroke_dasharray: None,
                    })));
                }
                if !outline.is_empty() {
                    elements.push(outlined(outline, *role));
                }
            }
            Mark::Band {
                role,
                x: abscissae,
                lower,
                upper,
                ..
            } => {
                // below all that a logarithmic axis shows is its lower end
                let edge = |value: f64| {
                    if value <= 0.0 && y.logarithmic {
                        9000.0
                    } else {
                        y.at(value)
                    }
                };
                let edges = abscissae
                    .iter()
                    .zip(lower.iter().zip(upper))
                    .map(|(value, (lower, upper))| (x.at(*value), [edge(*lower), edge(*upper)]));
                if let Some(band) = band(edges, look(*role).color) {
                    elements.push(band);
                }
            }
            Mark::At { .. } => {}
        }
    }
}

/// A vertical line and where its name stands.
struct VerticalLine<'a> {
    name: &'a str,
    pixel: f64,
    text_from: f64,
    row: usize,
}

struct Frame {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Frame {
    fn clip(&self, name: &str, clips: &mut Vec<String>, elements: &mut Vec<Primitive>) {
        let (x, y) = (self.left, self.top);
        let (width, height) = (self.right - self.left, self.bottom - self.top);
        clips.push(format!(
            r#"<clipPath id="{name}"><rect x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}"/></clipPath>"#
        ));
        elements.push(Primitive::ClipStart {
            x,
            y,
            width,
            height,
            id: name.to_owned(),
        });
    }

    fn grid(
        &self,
        x: &Mapping,
        y: &Mapping,
        on_x: &Ticks,
        on_y: &Ticks,
        elements: &mut Vec<Primitive>,
    ) {
        let mut lines = String::new();
        for (value, _) in &on_x.major {
            _ = write!(
                lines,
                "M{} {:.1}V{:.1}",
                x.at(*value),
                self.top,
                self.bottom
            );
        }
        for (value, _) in &on_y.major {
            _ = write!(
                lines,
                "M{:.1} {}H{:.1}",
                self.left,
                y.at(*value),
                self.right
            );
        }
        elements.push(path(lines, GRID, 0.8));
    }

    fn axes(
        &self,
        x: &Mapping,
        y: &Mapping,
        on_x: &Ticks,
        on_y: &Ticks,
        elements: &mut Vec<Primitive>,
    ) {
        let Self {
            left,
            right,
            top,
            bottom,
        } = *self;
        let mut lines = format!("M{left:.1} {top:.1}H{right:.1}V{bottom:.1}H{left:.1}z");
        for value in &on_x.minor {
            _ = write!(lines, "M{} {bottom:.1}v3", x.at(*value));
        }
        for value in &on_y.minor {
            _ = write!(lines, "M{left:.1} {}h-3", y.at(*value));
        }
        for (value, label) in &on_x.major {
            let pixel = x.at(*value);
            _ = write!(lines, "M{pixel} {bottom:.1}v5");
            let half = 0.5 * text::width(label, f64::from(SMALL));
            elements.push(words(
                label,
                // the last one stays on the paper
                pixel.min(super::WIDTH - half - 1.0),
                bottom + 17.0,
                SMALL,
                TextAnchor::Middle,
                None,
            ));
        }
        for (value, label) in &on_y.major {
            let pixel = y.at(*value);
            _ = write!(lines, "M{left:.1} {pixel}h-5");
            elements.push(words(
                label,
                left - 8.0,
                pixel + 4.0,
                SMALL,
                TextAnchor::End,
                None,
            ));
        }
        elements.push(path(lines, INK, 1.0));
    }
}

/// Label of an axis: what is on it and its unit.
fn title(axis: &Axis) -> String {
    if axis.unit.is_empty() {
        axis.label.clone()
    } else {
        format!("{}, {}", axis.label, axis.unit)
    }
}

/// Splits where a coordinate is none.
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

fn band(edges: impl Iterator<Item = (f64, [f64; 2])>, color: &str) -> Option<Primitive> {
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
    (!d.is_empty()).then(|| {
        Primitive::Path(Box::new(PathData {
            d,
            fill: Some(Color::from(color)),
            stroke: Color::None,
            stroke_width: 0.0,
            opacity: Some(0.22),
            stroke_dasharray: None,
        }))
    })
}

/// Adds the marker of `role` at a place to the data of a path.
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

/// The path of markers in the colours of `role`.
pub(super) fn outlined(d: String, role: Role) -> Primitive {
    let look = look(role);
    let crossed = look.marker == Marker::Cross;
    let edged = !crossed && look.marker != Marker::Dot;
    Primitive::Path(Box::new(PathData {
        d,
        fill: (!crossed).then(|| Color::from(look.color)),
        stroke: Color::from(if edged { "#ffffff" } else { look.color }),
        stroke_width: match look.marker {
            Marker::Cross => 1.3,
            Marker::Dot => 0.0,
            _ => 0.5,
        },
        opacity: None,
        stroke_dasharray: None,
    }))
}

fn path(d: String, color: &str, width: f64) -> Primitive {
    Primitive::Path(Box::new(PathData {
        d,
        fill: None,
        stroke: Color::from(color),
        stroke_width: width,
        opacity: None,
        stroke_dasharray: None,
    }))
}

/// A place in pixels, with tenths.
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

fn dot(x: f64, y: f64, radius: f64, color: &str) -> Primitive {
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

fn words(
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
