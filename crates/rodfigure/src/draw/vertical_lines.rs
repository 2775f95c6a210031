//! Vertical lines and their names above the axes.

use super::mapping::Mapping;
use super::text::{self, SMALL};
use crate::Mark;

/// Vertical line and the place of its name.
pub(super) struct VerticalLine<'a> {
    pub(super) name: &'a str,
    pub(super) pixel: f64,
    pub(super) text_from: f64,
    pub(super) row: usize,
}

/// Returns the vertical lines with the rows of their names. A name begins at its own line and is
/// placed above the top of every other line within its width, so that no line crosses a name.
#[allow(
    clippy::indexing_slicing,
    reason = "`index` is below the number of lines that are placed"
)]
pub(super) fn vertical_lines<'a>(
    marks: &'a [Mark],
    x: &Mapping,
    left: f64,
    right: f64,
) -> Vec<VerticalLine<'a>> {
    let mut lines: Vec<VerticalLine<'a>> = Vec::new();
    for mark in marks {
        let Mark::At { name, x: value } = mark else {
            continue;
        };
        let pixel = x.at(*value);
        if (left..=right).contains(&pixel) {
            let length = text::width(name, SMALL);
            lines.push(VerticalLine {
                name,
                pixel,
                text_from: (pixel + 3.0).min(right - length).max(left),
                row: 0,
            });
        }
    }
    lines.sort_by(|a, b| a.pixel.total_cmp(&b.pixel));
    let end = |line: &VerticalLine<'_>| line.text_from + text::width(line.name, SMALL) + 6.0;
    // names that would extend beyond the right end of the axes are shifted to the left of their
    // lines, and are placed above the lines that they then overlap
    let (pushed, mut placed): (Vec<_>, Vec<_>) = lines
        .into_iter()
        .partition(|line: &VerticalLine<'_>| line.text_from < line.pixel);
    for index in (0..placed.len()).rev() {
        let reaches = end(&placed[index]);
        let above = placed[index + 1..]
            .iter()
            .filter(|line| line.pixel < reaches)
            .map(|line| line.row + 1);
        placed[index].row = above.max().unwrap_or(0);
    }
    for mut line in pushed {
        let above = placed
            .iter()
            .filter(|other| end(other) > line.text_from && other.pixel - 6.0 < end(&line))
            .map(|other| other.row + 1);
        line.row = above.max().unwrap_or(0);
        placed.push(line);
    }
    placed
}
