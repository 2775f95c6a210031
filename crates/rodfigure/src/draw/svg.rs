//! Writing of SVG, element by element.

use std::fmt::Write;

use crate::push_decimal;

/// Colour of text and axes.
pub(super) const INK: &str = "#1c1c1c";
const FONTS: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// Elements of a file in the order in which they are drawn.
#[derive(Debug, Default)]
pub(super) struct Svg {
    clips: String,
    elements: String,
}

/// Colours of a path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paint {
    pub(super) stroke: &'static str,
    pub(super) width: f64,
    pub(super) dash: Option<&'static str>,
    pub(super) fill: &'static str,
    pub(super) opacity: f64,
}

impl Paint {
    /// Creates the paint of a line without dashes.
    pub(super) fn line(stroke: &'static str, width: f64) -> Self {
        Self {
            stroke,
            width,
            dash: None,
            fill: "none",
            opacity: 1.0,
        }
    }

    /// Creates the paint of an area without an edge.
    pub(super) fn area(fill: &'static str, opacity: f64) -> Self {
        Self {
            fill,
            opacity,
            ..Self::line("none", 0.0)
        }
    }
}

/// Position of a text relative to its coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
    /// Middle of a text that is written upwards.
    Upwards,
}

impl Svg {
    /// Adds a path from its data.
    pub(super) fn path(&mut self, d: &str, paint: Paint) {
        let (stroke, width) = (paint.stroke, paint.width);
        _ = write!(
            self.elements,
            r#"<path d="{d}" stroke="{stroke}" stroke-width="{width}" fill="{}""#,
            paint.fill
        );
        if paint.opacity < 1.0 {
            _ = write!(self.elements, r#" fill-opacity="{}""#, paint.opacity);
        }
        if let Some(dash) = paint.dash {
            _ = write!(self.elements, r#" stroke-dasharray="{dash}""#);
        }
        self.elements.push_str("/>");
    }

    /// Adds a line through `points`.
    pub(super) fn line(&mut self, points: &[(f64, f64)], paint: Paint) {
        let mut d = String::with_capacity(12 * points.len());
        for (index, (x, y)) in points.iter().enumerate() {
            d.push(if index == 0 { 'M' } else { ' ' });
            push_pixel(&mut d, *x);
            d.push(' ');
            push_pixel(&mut d, *y);
        }
        self.path(&d, paint);
    }

    /// Adds a dot.
    pub(super) fn circle(&mut self, [x, y]: [f64; 2], radius: f64, fill: &str) {
        let [x, y, radius] = [x, y, radius].map(rounded);
        _ = write!(
            self.elements,
            r#"<circle cx="{x}" cy="{y}" r="{radius}" fill="{fill}"/>"#
        );
    }

    /// Adds a rectangle, given by its upper left corner, width and height.
    pub(super) fn rectangle(&mut self, sides: [f64; 4], fill: &str, opacity: f64) {
        let sides = place(sides);
        _ = write!(
            self.elements,
            r#"<rect {sides} fill="{fill}" fill-opacity="{opacity}"/>"#
        );
    }

    /// Adds the heading of the figure.
    pub(super) fn heading(&mut self, words: &str, at: [f64; 2], size: f64) {
        self.words(words, at, size, r#"text-anchor="start" font-weight="bold""#);
    }

    pub(super) fn text(&mut self, words: &str, at: [f64; 2], size: f64, anchor: Anchor) {
        let [x, y] = at.map(rounded);
        let upwards = format!(r#"text-anchor="middle" transform="rotate(-90,{x},{y})""#);
        let attributes = match anchor {
            Anchor::Start => r#"text-anchor="start""#,
            Anchor::Middle => r#"text-anchor="middle""#,
            Anchor::End => r#"text-anchor="end""#,
            Anchor::Upwards => &upwards,
        };
        self.words(words, at, size, attributes);
    }

    fn words(&mut self, words: &str, at: [f64; 2], size: f64, attributes: &str) {
        let ([x, y], words) = (at.map(rounded), escaped(words));
        _ = write!(
            self.elements,
            r#"<text x="{x}" y="{y}" font-size="{size}" {attributes} fill="{INK}">{words}</text>"#
        );
    }

    /// Clips the elements that follow to a rectangle.
    pub(super) fn begin_clip(&mut self, name: &str, sides: [f64; 4]) {
        let (name, sides) = (escaped(name), place(sides));
        _ = write!(
            self.clips,
            r#"<clipPath id="{name}"><rect {sides}/></clipPath>"#
        );
        _ = write!(self.elements, r#"<g clip-path="url(#{name})">"#);
    }

    pub(super) fn end_clip(&mut self) {
        self.elements.push_str("</g>");
    }

    /// Returns the text of the file, with a white background. The view box lets a viewer reduce the
    /// figure instead of cutting it off.
    pub(super) fn finish(self, width: f64, height: f64) -> String {
        let Self { clips, elements } = self;
        format!(
            r#"<svg viewBox="0 0 {width} {height}" xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="{FONTS}"><rect width="100%" height="100%" fill="white"/><defs>{clips}</defs>{elements}</svg>"#
        )
    }
}

/// Appends a coordinate in pixels, rounded to a tenth, faster than [`Display`](std::fmt::Display).
#[expect(
    clippy::cast_possible_truncation,
    reason = "places are within some thousand pixels"
)]
fn push_pixel(d: &mut String, pixel: f64) {
    push_decimal(d, (10.0 * pixel).round() as i64, 1);
}

/// Rounds a length to a hundredth of a pixel; zero has no sign.
fn rounded(value: f64) -> f64 {
    (100.0 * value).round() / 100.0 + 0.0
}

/// Returns the attributes of a rectangle.
fn place(sides: [f64; 4]) -> String {
    let [x, y, width, height] = sides.map(rounded);
    format!(r#"x="{x}" y="{y}" width="{width}" height="{height}""#)
}

/// Escapes the characters of `text` that have a meaning in XML.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
