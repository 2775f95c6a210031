//! A figure as scalable graphics.
//!
//! The elements are those of kuva, which writes them. The arrangement is made here: legends are
//! above the axes, where they hide nothing; a logarithmic axis extends to any positive value and
//! need not end at full decades; the names of clipping paths do not depend on other figures drawn
//! in the same process.

mod frame;
mod ink;
mod legend;
mod mapping;
mod marks;
mod panel;
mod text;
mod vertical_lines;

use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene, TextAnchor};

use self::panel::{Arranged, Place};
use super::{Figure, thinned};

/// Width of a figure in pixels.
const WIDTH: f64 = 760.0;
/// Free space around the figure.
const EDGE: f64 = 12.0;
/// Size of the heading.
const TITLE: u32 = 15;
/// Free space between panels.
const BETWEEN: f64 = 14.0;

/// A drawn figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// The figure as drawn, with its series [thinned].
    pub figure: Figure,
    /// The text of the SVG file.
    pub svg: String,
}

impl Drawn {
    /// Draws `figure`.
    #[must_use]
    pub fn of(figure: &Figure) -> Self {
        let figure = thinned(figure);
        let svg = svg(&figure);
        Self { figure, svg }
    }
}

/// `figure` as an SVG file: its title, and its panels one above the other, on white.
///
/// Series of many samples are [thinned]. Text is kept as text. The same figure gives the same
/// bytes.
#[must_use]
pub fn svg_of(figure: &Figure) -> String {
    svg(&thinned(figure))
}

fn svg(figure: &Figure) -> String {
    let mut elements = Vec::new();
    let mut top = EDGE;
    let line = f64::from(TITLE) * 1.3;
    for words in text::lines(&figure.title, f64::from(TITLE), WIDTH - 2.0 * EDGE) {
        top += line;
        elements.push(Primitive::Text {
            x: EDGE,
            y: top - 0.3 * line,
            content: words,
            size: TITLE,
            anchor: TextAnchor::Start,
            rotate: None,
            bold: true,
            color: Some(Color::from(ink::INK)),
        });
    }
    top += 6.0;
    let arranged = Arranged::all_of(&figure.panels);
    // axes of all panels are aligned
    let left = arranged
        .iter()
        .map(Arranged::left_margin)
        .fold(0.0, f64::max);
    let mut clips = Vec::new();
    for (index, panel) in arranged.iter().enumerate() {
        let place = Place {
            left: (EDGE + left).ceil(),
            right: WIDTH - EDGE - 6.0,
            top,
            clip: format!("{}-{}", identifier(&figure.name), index + 1),
        };
        top = panel.draw(&place, &mut elements, &mut clips) + BETWEEN;
    }
    let mut scene = Scene::new(WIDTH, (top - BETWEEN + EDGE).ceil());
    scene.font_family =
        Some("Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif".into());
    scene.elements = elements;
    scene.defs = clips;
    let written = SvgBackend::new().render_scene(&scene);
    // without a view box the figure is cut off instead of shrunk
    let frame = format!(r#"<svg viewBox="0 0 {} {}" "#, scene.width, scene.height);
    written.replacen("<svg ", &frame, 1)
}

/// A name that is valid in an attribute.
fn identifier(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect()
}

#[cfg(test)]
mod tests;
