//! The frame of a panel with its grid, ticks and numbers.

use std::fmt::Write;

use kuva::render::render::{Primitive, TextAnchor};

use super::ink::{INK, SMALL, path, words};
use super::mapping::Mapping;
use super::text;
use crate::figure::ticks::Ticks;

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
    pub(super) fn clip(&self, name: &str, clips: &mut Vec<String>, elements: &mut Vec<Primitive>) {
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

    pub(super) fn grid(
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

    pub(super) fn axes(
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
                // the last one stays inside the image
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
