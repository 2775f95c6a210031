//! A figure as scalable graphics.
//!
//! Legends are above the axes, where they do not cover the marks. A logarithmic axis extends to any
//! positive value; it need not end at full decades. The names of clipping paths do not depend on
//! other figures drawn in the same process.

mod frame;
mod legend;
mod mapping;
mod marks;
mod panel;
mod svg;
mod text;
mod vertical_lines;

use self::panel::{Arranged, Place};
use self::svg::Svg;
use super::{Figure, thinned};

/// Width of a figure in pixels.
const WIDTH: f64 = 760.0;
/// Free space around the figure.
const EDGE: f64 = 12.0;
/// Size of the heading.
const TITLE: f64 = 15.0;
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

/// Draws `figure` as an SVG file: its title and its panels, one above the other, on a white
/// background.
///
/// Series with many samples are [thinned]. Text is written as text, not as outlines. The same
/// figure gives the same bytes.
#[must_use]
pub fn svg_of(figure: &Figure) -> String {
    svg(&thinned(figure))
}

fn svg(figure: &Figure) -> String {
    let mut svg = Svg::default();
    let mut top = EDGE;
    let line = TITLE * 1.3;
    for words in text::lines(&figure.title, TITLE, WIDTH - 2.0 * EDGE) {
        top += line;
        svg.heading(&words, [EDGE, top - 0.3 * line], TITLE);
    }
    top += 6.0;
    let arranged = Arranged::all_of(&figure.panels);
    // the widest left margin, so that the axes of all panels are aligned
    let left = arranged
        .iter()
        .map(Arranged::left_margin)
        .fold(0.0, f64::max);
    for (index, panel) in arranged.iter().enumerate() {
        let place = Place {
            left: (EDGE + left).ceil(),
            right: WIDTH - EDGE - 6.0,
            top,
            clip: format!("{}-{}", identifier(&figure.name), index + 1),
        };
        top = panel.draw(&place, &mut svg) + BETWEEN;
    }
    svg.finish(WIDTH, (top - BETWEEN + EDGE).ceil())
}

/// Returns `name` with all characters other than letters and digits replaced, for use in an
/// attribute.
fn identifier(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect()
}

#[cfg(test)]
mod tests;
