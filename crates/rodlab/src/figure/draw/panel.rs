//! One panel: its frame, ticks, labels and marks.

use kuva::render::color::Color;
use kuva::render::render::{Primitive, TextAnchor};

use super::frame::Frame;
use super::ink::{INK, SMALL, stroke, words};
use super::legend::Legend;
use super::mapping::Mapping;
use super::marks::draw_mark;
use super::text;
use super::vertical_lines::vertical_lines;
use crate::figure::span::{shows_anything, spans};
use crate::figure::ticks::{Ticks, ticks};
use crate::figure::{Axis, Panel, Scale, unit_as_read};

/// Colour of ranges where the result is not valid.
pub(super) const GREY: &str = "#808080";
pub(super) const GREY_OPACITY: f64 = 0.2;
/// Size of the labels of axes.
const LABEL: u32 = 12;
/// Line spacing of these labels.
const LABEL_LINE: f64 = 14.0;
/// Height of the axes.
const HEIGHT: f64 = 230.0;
/// Height of axes with equal scales.
const EQUAL_HEIGHT: f64 = 400.0;
const BELOW: f64 = 40.0;
/// Height of a row of names of vertical lines.
const NAMES: f64 = 14.0;

/// The place of a panel.
pub(super) struct Place {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    /// Name of the clipping path.
    pub(super) clip: String,
}

/// A panel with the data that its margins depend on.
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

    /// The width of the numbers and the label of the vertical axis.
    pub(super) fn left_margin(&self) -> f64 {
        let widest = self
            .y_ticks(self.y)
            .major
            .iter()
            .map(|(_, label)| text::width(label, f64::from(SMALL)))
            .fold(0.0, f64::max);
        widest + 8.0 + 8.0 + self.y_label().iter().map(|_| LABEL_LINE).sum::<f64>()
    }

    /// The label of the vertical axis, in lines that are no longer than the axis.
    fn y_label(&self) -> Vec<String> {
        text::lines(&title(&self.panel.y), f64::from(LABEL), self.height())
    }

    /// Draws the panel and returns its lower end.
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

        frame.clip(&place.clip, clips, elements);
        self.grey(&frame, &x, elements);
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
            draw_mark(mark, &x, &y, elements);
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
        self.label(&frame, elements);
        bottom + BELOW
    }

    /// Shades the ranges where the result is not valid.
    fn grey(&self, frame: &Frame, x: &Mapping, elements: &mut Vec<Primitive>) {
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
                    y: frame.top,
                    width: to - from,
                    height: frame.bottom - frame.top,
                    fill: Color::from(GREY),
                    stroke: None,
                    stroke_width: None,
                    opacity: Some(GREY_OPACITY),
                });
            }
        }
    }

    /// Writes the labels of the axes, and a note if there are no data.
    fn label(&self, frame: &Frame, elements: &mut Vec<Primitive>) {
        if !shows_anything(self.panel, [self.x, self.y]) {
            elements.push(words(
                "no data to show",
                0.5 * (frame.left + frame.right),
                0.5 * (frame.top + frame.bottom),
                LABEL,
                TextAnchor::Middle,
                None,
            ));
        }
        elements.push(words(
            &title(&self.panel.x),
            0.5 * (frame.left + frame.right),
            frame.bottom + 35.0,
            LABEL,
            TextAnchor::Middle,
            None,
        ));
        let mut x = super::EDGE + 11.0;
        for line in self.y_label() {
            elements.push(words(
                &line,
                x,
                0.5 * (frame.top + frame.bottom),
                LABEL,
                TextAnchor::Middle,
                Some(-90.0),
            ));
            x += LABEL_LINE;
        }
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
}

/// Label of an axis: its quantity and unit.
fn title(axis: &Axis) -> String {
    if axis.unit.is_empty() {
        axis.label.clone()
    } else {
        format!("{}, {}", axis.label, unit_as_read(&axis.unit))
    }
}
