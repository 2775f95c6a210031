//! Figures of tests as data, and their drawings as SVG.
//!
//! A [`Figure`] states which curves, points and bands belong together on which axes; its numbers
//! are in the units of the axes. [`svg_of`] draws it: axes, ticks, colours and legend follow from
//! the data. The same figure gives the same bytes.
//!
//! ```
//! use rodfigure::{Axis, Figure, Mark, Panel, Role, svg_of};
//!
//! let decay = (0..100).map(|n| f64::from(n)).map(|t| (t, (-0.05 * t).exp()));
//! let marks = vec![Mark::line("free end", Role::First, decay)];
//! let panel = Panel::new(Axis::linear("time", "ms"), Axis::linear("velocity", "m/s"), marks);
//! let svg = svg_of(&Figure::new("decay", "A rod that rings", vec![panel]));
//! assert!(svg.contains(">velocity, m/s</text>"));
//! ```

mod decimal;
mod draw;
mod palette;
mod span;
mod thinning;
mod ticks;
mod unit;

pub use decimal::push_decimal;
pub use draw::{Drawn, svg_of};
pub use thinning::thinned;
pub use ticks::superscript;
pub use unit::unit_as_read;

use std::path::{Path, PathBuf};
use std::{fs, io};

use serde::Serialize;

/// Figure of one or more panels, one above the other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// Name of the file of the figure without extension, such as `modulus`.
    pub name: String,
    /// Heading.
    pub title: String,
    /// Description of the figure, in one or two sentences.
    pub caption: String,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
}

impl Figure {
    /// Creates a figure without a caption.
    #[must_use]
    pub fn new(name: impl Into<String>, title: impl Into<String>, panels: Vec<Panel>) -> Self {
        Self {
            name: name.into(),
            title: title.into(),
            caption: String::new(),
            panels,
        }
    }

    /// The figure with a caption.
    #[must_use]
    pub fn with_caption(self, caption: impl Into<String>) -> Self {
        let caption = caption.into();
        Self { caption, ..self }
    }

    /// Draws the figure as an SVG file in `folder` and returns the path of the file. The folder is
    /// created if it does not exist.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn write_to(&self, folder: impl AsRef<Path>) -> io::Result<PathBuf> {
        fs::create_dir_all(&folder)?;
        let path = fs::canonicalize(folder)?.join(format!("{}.svg", self.name));
        fs::write(&path, svg_of(self))?;
        Ok(path)
    }
}

/// One pair of axes with its marks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    /// Horizontal axis. The panels of a figure whose horizontal axes have the same label and unit
    /// are zoomed together.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves, points and bands, in the order in which they are drawn.
    pub marks: Vec<Mark>,
    /// Ranges of the horizontal axis that are shaded grey because the result is not valid there.
    pub greyed: Vec<Greyed>,
    /// True for equal scales on both axes (Nyquist, Cole-Cole).
    pub equal_axes: bool,
}

impl Panel {
    /// Creates a panel with independent scales on both axes and without shaded ranges. An axis can
    /// also be given as a pair of label and unit.
    #[must_use]
    pub fn new(x: impl Into<Axis>, y: impl Into<Axis>, marks: Vec<Mark>) -> Self {
        Self {
            x: x.into(),
            y: y.into(),
            marks,
            greyed: Vec::new(),
            equal_axes: false,
        }
    }

    /// Sets the shaded ranges.
    #[must_use]
    pub fn with_greyed(self, greyed: Vec<Greyed>) -> Self {
        Self { greyed, ..self }
    }
}

/// Axis of a panel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// Quantity on the axis, such as `frequency`.
    pub label: String,
    /// Unit, such as `kHz`; empty for a pure number.
    pub unit: String,
    /// Scale.
    pub scale: Scale,
    /// Range shown at first; `None` for the whole range of the data.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// Creates a linear axis that shows all data.
    #[must_use]
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            scale: Scale::Linear,
            range: None,
        }
    }

    /// Creates a logarithmic axis that shows all positive data.
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

impl<L: Into<String>, U: Into<String>> From<(L, U)> for Axis {
    /// Creates a linear axis from a label and a unit.
    fn from((label, unit): (L, U)) -> Self {
        Self::linear(label, unit)
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

/// Element drawn on the axes.
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
    /// Points, with or without error bars.
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
        /// Name of the event, written above the axes.
        name: String,
        /// Abscissa.
        x: f64,
    },
}

impl Mark {
    /// Creates a line through `points`.
    pub fn line(
        name: impl Into<String>,
        role: Role,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        let (x, y) = points.into_iter().unzip();
        let name = name.into();
        Self::Line { name, role, x, y }
    }

    /// Creates a line through the points with the abscissae `x` and the ordinates `y`.
    #[must_use]
    pub fn curve(name: impl Into<String>, role: Role, x: &[f64], y: Vec<f64>) -> Self {
        let (name, x) = (name.into(), x.to_vec());
        Self::Line { name, role, x, y }
    }

    /// Creates points without error bars.
    pub fn points(
        name: impl Into<String>,
        role: Role,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        let (x, y) = points.into_iter().unzip();
        Self::Points {
            name: name.into(),
            role,
            x,
            y,
            error: Vec::new(),
        }
    }

    /// Creates points with error bars: abscissa, ordinate and half the length of the bar.
    pub fn points_with_errors(
        name: impl Into<String>,
        role: Role,
        points: impl IntoIterator<Item = (f64, f64, f64)>,
    ) -> Self {
        let (x, y, error) = points.into_iter().collect();
        Self::Points {
            name: name.into(),
            role,
            x,
            y,
            error,
        }
    }

    /// Creates a band: abscissa, lower and upper edge.
    pub fn band(
        name: impl Into<String>,
        role: Role,
        edges: impl IntoIterator<Item = (f64, f64, f64)>,
    ) -> Self {
        let (x, lower, upper) = edges.into_iter().collect();
        Self::Band {
            name: name.into(),
            role,
            x,
            lower,
            upper,
        }
    }

    /// Creates a vertical line at the abscissa `x`.
    pub fn at(name: impl Into<String>, x: f64) -> Self {
        let name = name.into();
        Self::At { name, x }
    }
}

/// Meaning of a mark, which determines its colour and dashes. Roles can be distinguished by colour
/// with any colour vision, and by their dashes in print.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// The result, or the first of several results.
    First,
    /// The second of several results.
    Second,
    /// The third result.
    Third,
    /// The fourth result.
    Fourth,
    /// The fifth result.
    Fifth,
    /// A curve for comparison: a model, a printed value, a limit.
    Reference,
    /// Invalid data: invalid lines, rejected hits.
    Faint,
}

impl Role {
    /// Returns the role of the series with this `index`, from 0; the roles repeat after the fifth.
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

/// Range of the horizontal axis where the result is not valid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Greyed {
    /// Lower end; minus infinity for the end of the axis.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Reason why the result is not valid.
    pub because: String,
}
