//! Frame of a panel with its grid, ticks and numbers.

use std::fmt::Write;

use super::mapping::Mapping;
use super::svg::{Anchor, INK, Paint, Svg};
use super::text::{self, SMALL};
use crate::ticks::Ticks;

/// Colour of the grid.
const GRID: &str = "#dddddd";

/// The edges of the axes in pixels.
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

impl Frame {
    /// Returns the upper left corner, the width and the height.
    pub(super) fn sides(&self) -> [f64; 4] {
        let (width, height) = (self.right - self.left, self.bottom - self.top);
        [self.left, self.top, width, height]
    }

    pub(super) fn grid(&self, x: &Mapping, y: &Mapping, on_x: &Ticks, on_y: &Ticks, svg: &mut Svg) {
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
        svg.path(&lines, Paint::line(GRID, 0.8));
    }

    pub(super) fn axes(&self, x: &Mapping, y: &Mapping, on_x: &Ticks, on_y: &Ticks, svg: &mut Svg) {
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
            let half = 0.5 * text::width(label, SMALL);
            // shifted to the left if the number would extend beyond the image
            let middle = pixel.min(super::WIDTH - half - 1.0);
            svg.text(label, [middle, bottom + 17.0], SMALL, Anchor::Middle);
        }
        for (value, label) in &on_y.major {
            let pixel = y.at(*value);
            _ = write!(lines, "M{left:.1} {pixel}h-5");
            svg.text(label, [left - 8.0, pixel + 4.0], SMALL, Anchor::End);
        }
        svg.path(&lines, Paint::line(INK, 1.0));
    }
}
