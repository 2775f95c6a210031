//! One panel: its frame, ticks, labels and marks.

use super::frame::Frame;
use super::legend::Legend;
use super::mapping::Mapping;
use super::marks::draw_mark;
use super::svg::{Anchor, INK, Paint, Svg};
use super::text::{self, SMALL};
use super::vertical_lines::vertical_lines;
use crate::palette::{GREY, GREY_OPACITY};
use crate::span::{shows_anything, spans};
use crate::ticks::{Ticks, ticks};
use crate::{Axis, Panel, Scale, unit_as_read};

/// Size of the labels of axes.
const LABEL: f64 = 12.0;
/// Line spacing of the labels of axes.
const LABEL_LINE: f64 = 14.0;
/// Height of the axes.
const HEIGHT: f64 = 230.0;
/// Height of axes with equal scales.
const EQUAL_HEIGHT: f64 = 400.0;
const BELOW: f64 = 40.0;
/// Height of a row of names of vertical lines.
const NAMES: f64 = 14.0;

/// Place of a panel in the figure.
pub(super) struct Place {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    /// Name of the clipping path.
    pub(super) clip: String,
}

/// Panel with the ranges of its axes, which determine its margins.
pub(super) struct Arranged<'a> {
    panel: &'a Panel,
    x: [f64; 2],
    y: [f64; 2],
}

impl<'a> Arranged<'a> {
    pub(super) fn all_of(panels: &'a [Panel]) -> Vec<Self> {
        panels
            .iter()
            .zip(spans(panels))
            .map(|(panel, [x, y])| Self { panel, x, y })
            .collect()
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

    /// Returns the width that the numbers and the label of the vertical axis need.
    pub(super) fn left_margin(&self) -> f64 {
        let widest = self
            .y_ticks(self.y)
            .major
            .iter()
            .map(|(_, label)| text::width(label, SMALL))
            .fold(0.0, f64::max);
        widest + 8.0 + 8.0 + self.y_label().iter().map(|_| LABEL_LINE).sum::<f64>()
    }

    /// Returns the label of the vertical axis, broken into lines that are no longer than the axis.
    fn y_label(&self) -> Vec<String> {
        text::lines(&title(&self.panel.y), LABEL, self.height())
    }

    /// Draws the panel and returns its lower end.
    pub(super) fn draw(&self, place: &Place, svg: &mut Svg) -> f64 {
        let legend = Legend::of(self.panel, place.right - place.left);
        legend.draw(place.left, place.top, svg);
        let (x_range, y_range) = self.ranges(place);
        let x = Mapping::new(&self.panel.x, x_range, place.left, place.right);
        let lines = vertical_lines(&self.panel.marks, &x, place.left, place.right);
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

        svg.begin_clip(&place.clip, frame.sides());
        self.grey(&frame, &x, svg);
        frame.grid(&x, &y, &on_x, &on_y, svg);
        for line in &lines {
            let dashed = Paint {
                dash: Some("5 3"),
                ..Paint::line(INK, 1.0)
            };
            svg.line(&[(line.pixel, top), (line.pixel, bottom)], dashed);
        }
        for mark in &self.panel.marks {
            draw_mark(mark, &x, &y, svg);
        }
        svg.end_clip();
        for line in &lines {
            let mut row = 0.0;
            for _ in 0..line.row {
                row += NAMES;
            }
            let baseline = top - 4.0 - row;
            let up = [(line.pixel, top), (line.pixel, top - 3.0 - row)];
            svg.line(&up, Paint::line(INK, 1.0));
            let at = [line.text_from, baseline];
            svg.text(line.name, at, SMALL, Anchor::Start);
        }
        frame.axes(&x, &y, &on_x, &on_y, svg);
        self.label(&frame, svg);
        bottom + BELOW
    }

    /// Shades the ranges where the result is not valid.
    fn grey(&self, frame: &Frame, x: &Mapping, svg: &mut Svg) {
        for greyed in &self.panel.greyed {
            let end = |value: f64, otherwise: f64| {
                Some(x.at(value))
                    .filter(|pixel| pixel.is_finite())
                    .unwrap_or(otherwise)
            };
            let from = end(greyed.from, frame.left).max(frame.left);
            let to = end(greyed.to, frame.right).min(frame.right);
            if to > from {
                let sides = [from, frame.top, to - from, frame.bottom - frame.top];
                svg.rectangle(sides, GREY, GREY_OPACITY);
            }
        }
    }

    /// Writes the labels of the axes, and a note if there is nothing to show.
    fn label(&self, frame: &Frame, svg: &mut Svg) {
        let centre = 0.5 * (frame.left + frame.right);
        let middle = 0.5 * (frame.top + frame.bottom);
        if !shows_anything(self.panel, [self.x, self.y]) {
            svg.text("no data to show", [centre, middle], LABEL, Anchor::Middle);
        }
        let below = [centre, frame.bottom + 35.0];
        svg.text(&title(&self.panel.x), below, LABEL, Anchor::Middle);
        let mut x = super::EDGE + 11.0;
        for line in self.y_label() {
            svg.text(&line, [x, middle], LABEL, Anchor::Upwards);
            x += LABEL_LINE;
        }
    }

    /// Returns the ranges. With equal scales, the shorter range is widened on both sides.
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
}

/// Returns the label of an axis: its quantity and unit.
fn title(axis: &Axis) -> String {
    if axis.unit.is_empty() {
        axis.label.clone()
    } else {
        format!("{}, {}", axis.label, unit_as_read(&axis.unit))
    }
}
