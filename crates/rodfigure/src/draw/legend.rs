//! Legend: the names of the marks, in rows above the axes.

use super::marks::{area, line, marker, outlined};
use super::svg::{Anchor, Paint, Svg};
use super::text;
use crate::palette::{GREY, GREY_OPACITY};
use crate::{Mark, Panel, Role};

/// Size of the names.
const SIZE: f64 = 12.0;
/// Height of a row.
pub(super) const ROW: f64 = 18.0;
const SWATCH: f64 = 26.0;
const AFTER_SWATCH: f64 = 6.0;
const BETWEEN: f64 = 16.0;

/// Symbol of a mark next to its name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Swatch {
    Line(Role),
    Points(Role),
    Band(Role),
    Grey,
}

/// Names, arranged in rows.
#[derive(Debug)]
pub(super) struct Legend {
    rows: Vec<Vec<(Swatch, String)>>,
}

impl Legend {
    /// Creates the legend of `panel` in rows of `width`.
    pub(super) fn of(panel: &Panel, width: f64) -> Self {
        let mut entries: Vec<(Swatch, String)> = Vec::new();
        let mut add = |swatch: Swatch, name: &String| {
            let entry = (swatch, name.clone());
            if !name.is_empty() && !entries.contains(&entry) {
                entries.push(entry);
            }
        };
        for mark in &panel.marks {
            match mark {
                Mark::Line { name, role, .. } => add(Swatch::Line(*role), name),
                Mark::Points { name, role, .. } => add(Swatch::Points(*role), name),
                Mark::Band { name, role, .. } => add(Swatch::Band(*role), name),
                Mark::At { .. } => {}
            }
        }
        for greyed in &panel.greyed {
            add(Swatch::Grey, &greyed.because);
        }
        let mut rows: Vec<Vec<(Swatch, String)>> = Vec::new();
        let mut used = f64::INFINITY;
        for entry in entries {
            let needs = length(&entry.1);
            if used + needs > width + BETWEEN {
                rows.push(Vec::new());
                used = 0.0;
            }
            used += needs;
            if let Some(row) = rows.last_mut() {
                row.push(entry);
            }
        }
        Self { rows }
    }

    pub(super) fn height(&self) -> f64 {
        let mut rows = 0.0;
        for _ in &self.rows {
            rows += ROW;
        }
        rows
    }

    /// Draws the legend with its upper left corner at `left`, `top`.
    pub(super) fn draw(&self, left: f64, top: f64, svg: &mut Svg) {
        let mut middle = (top + 0.5 * ROW).round();
        for row in &self.rows {
            let mut x = left.round();
            for (swatch, name) in row {
                draw_swatch(*swatch, x, middle, svg);
                let at = [x + SWATCH + AFTER_SWATCH, middle + 4.0];
                svg.text(name, at, SIZE, Anchor::Start);
                x += length(name);
            }
            middle += ROW;
        }
    }
}

fn length(name: &str) -> f64 {
    (SWATCH + AFTER_SWATCH + text::width(name, SIZE) + BETWEEN).ceil()
}

fn draw_swatch(swatch: Swatch, x: f64, middle: f64, svg: &mut Svg) {
    match swatch {
        Swatch::Line(role) => svg.line(&[(x, middle), (x + SWATCH, middle)], line(role)),
        Swatch::Points(role) => {
            let mut outline = String::new();
            marker(&mut outline, role, x + 0.5 * SWATCH, middle);
            svg.path(&outline, outlined(role));
        }
        Swatch::Band(role) => svg.path(&rectangle(x, middle), area(role)),
        Swatch::Grey => svg.path(&rectangle(x, middle), Paint::area(GREY, GREY_OPACITY)),
    }
}

fn rectangle(x: f64, middle: f64) -> String {
    format!("M{x} {}h{SWATCH}v11h-{SWATCH}z", middle - 5.5)
}
