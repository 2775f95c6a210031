//! Figures as data: what is drawn, apart from how.
//!
//! A job says which curves belong together on which axes. Files of scalable graphics and the interactive figures of the report are
//! both drawn from this. Numbers are in the unit of the axis.

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
    /// Name of its file without extension, as `modulus`.
    pub name: String,
    /// Heading.
    pub title: String,
    /// What it shows, in a sentence or two.
    pub caption: String,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
}

/// One pair of axes and what is drawn on it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    /// Horizontal axis; the panels of one figure that share its label and unit are zoomed together.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves, points and bands in the order in which they are drawn.
    pub marks: Vec<Mark>,
    /// Ranges of the horizontal axis that are greyed, because the result does not hold there.
    pub greyed: Vec<Greyed>,
    /// Whether a unit is as long on one axis as on the other (Nyquist, Cole-Cole).
    pub equal_axes: bool,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// What is on it, as `frequency`.
    pub label: String,
    /// Unit, as `kHz`; empty for a pure number.
    pub unit: String,
    /// Scale.
    pub scale: Scale,
    /// Range that is shown at first; all that is drawn when absent.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis of everything that is drawn.
    #[must_use]
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            scale: Scale::Linear,
            range: None,
        }
    }

    /// A logarithmic axis of everything that is drawn; what is not positive is left out.
    #[must_use]
    pub fn logarithmic(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            scale: Scale::Logarithmic,
            ..Self::linear(label, unit)
        }
    }

    /// Showing this range at first.
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

/// What is drawn.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "mark")]
pub enum Mark {
    /// A line through points; NaN interrupts it.
    Line {
        /// Name in the legend; empty for none.
        name: String,
        /// Which colour and dash: see [`Role`].
        role: Role,
        /// Abscissae.
        x: Vec<f64>,
        /// Ordinates.
        y: Vec<f64>,
    },
    /// Points, with errors where there are any.
    Points {
        /// Name in the legend; empty for none.
        name: String,
        /// Which colour: see [`Role`].
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
        /// Which colour: see [`Role`].
        role: Role,
        /// Abscissae.
        x: Vec<f64>,
        /// Lower edge.
        lower: Vec<f64>,
        /// Upper edge.
        upper: Vec<f64>,
    },
    /// A vertical line, as a trigger or the end of a contact.
    At {
        /// What happens there.
        name: String,
        /// Abscissa.
        x: f64,
    },
}

/// What a mark stands for, which decides its colour. Colours are told apart by people with any colour vision, and by their dashes in
/// print.
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
    /// What does not hold: invalid lines, rejected hits.
    Faint,
}

impl Role {
    /// The role of the series number `index` of several, from 0; the roles come again after the fifth.
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

/// A range of the horizontal axis where the result does not hold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Greyed {
    /// Lower end; minus infinity is written as the end of the axis.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Why.
    pub because: String,
}
