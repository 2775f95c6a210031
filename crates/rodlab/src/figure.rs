//! Figures as data, independent of how they are drawn.
//!
//! A job decides which curves belong together on which axes. The SVG files and the interactive
//! figures of the report are both drawn from these data. Numbers are in the unit of the axis.

mod decimal;
mod draw;
mod palette;
mod span;
mod thinning;
mod ticks;
mod unit;

pub(crate) use decimal::push_decimal;
pub use draw::{Drawn, svg_of};
pub(crate) use thinning::FEW;
pub use thinning::thinned;
pub(crate) use ticks::superscript;
pub(crate) use unit::unit_as_read;

use serde::Serialize;

/// One figure of one or more panels, one above the other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// Name of its file without extension, such as `modulus`.
    pub name: String,
    /// Heading.
    pub title: String,
    /// Description of the figure, in one or two sentences.
    pub caption: String,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
}

/// One pair of axes with its marks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    /// Horizontal axis; the panels of one figure that share its label and unit are zoomed
    /// together.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves, points and bands in the order in which they are drawn.
    pub marks: Vec<Mark>,
    /// Ranges of the horizontal axis shaded grey because the result is not valid there.
    pub greyed: Vec<Greyed>,
    /// Equal scales on both axes (Nyquist, Cole-Cole).
    pub equal_axes: bool,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// Quantity on the axis, such as `frequency`.
    pub label: String,
    /// Unit, such as `kHz`; empty for a pure number.
    pub unit: String,
    /// Scale.
    pub scale: Scale,
    /// Range shown at first; the whole range of the data if absent.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis over all data.
    #[must_use]
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            scale: Scale::Linear,
            range: None,
        }
    }

    /// A logarithmic axis over all data; values that are not positive are left out.
    #[must_use]
    pub fn logarithmic(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            scale: Scale::Logarithmic,
            ..Self::linear(label, unit)
        }
    }

    /// Sets the range shown at first.
    #[must_use]
    pub fn within(self, range: [f64; 2]) -> Self {
        Self {
            range: Some(range),
            ..self
        }
    }
}

/// Scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Linear.
    Linear,
    /// Logarithmic, base 10.
    Logarithmic,
}

/// An element drawn on the axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "mark")]
pub enum Mark {
    /// A line through points; NaN interrupts it.
    Line {
        /// Name in the legend; empty for none.
        name: String,
        /// Colour and dashes: see [`Role`].
        role: Role,
        /// Abscissae.
        x: Vec<f64>,
        /// Ordinates.
        y: Vec<f64>,
    },
    /// Points, with error bars if there are any.
    Points {
        /// Name in the legend; empty for none.
        name: String,
        /// Colour: see [`Role`].
        role: Role,
        /// Abscissae.
        x: Vec<f64>,
        /// Ordinates.
        y: Vec<f64>,
        /// Half the length of the bar through each point; empty for none.
        error: Vec<f64>,
    },
    /// A band between two curves; NaN interrupts it.
    Band {
        /// Name in the legend; empty for none.
        name: String,
        /// Colour: see [`Role`].
        role: Role,
        /// Abscissae.
        x: Vec<f64>,
        /// Lower edge.
        lower: Vec<f64>,
        /// Upper edge.
        upper: Vec<f64>,
    },
    /// A vertical line, such as a trigger or the end of a contact.
    At {
        /// The event at this abscissa.
        name: String,
        /// Abscissa.
        x: f64,
    },
}

/// The meaning of a mark, which decides its colour. Colours are distinguishable with any colour
/// vision, and by their dashes in print.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// The result, or the first of several.
    First,
    /// The second of several.
    Second,
    /// The third.
    Third,
    /// The fourth.
    Fourth,
    /// The fifth.
    Fifth,
    /// A curve to compare with: a model, a printed value, a limit.
    Reference,
    /// Invalid data: invalid lines, rejected hits.
    Faint,
}

impl Role {
    /// The role of the series number `index`, from 0; the roles repeat after the fifth.
    #[must_use]
    pub fn of_series(index: usize) -> Self {
        match index % 5 {
            0 => Self::First,
            1 => Self::Second,
            2 => Self::Third,
            3 => Self::Fourth,
            _ => Self::Fifth,
        }
    }
}

/// A range of the horizontal axis where the result is not valid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Greyed {
    /// Lower end; minus infinity is written as the end of the axis.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// The reason.
    pub because: String,
}
