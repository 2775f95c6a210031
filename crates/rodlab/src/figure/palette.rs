//! Colours, dashes and markers of the roles.
//!
//! The colours are those of the palette of Okabe and Ito, which people with any colour vision tell apart; its purple and sky blue are
//! darker here, so that they stand out from white. Dashes and markers tell curves apart where there are no colours.
//! `report/style.css` has the same colours, and others for dark screens.

use super::Role;

/// How a role looks on white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Look {
    /// Colour.
    pub color: &'static str,
    /// Dashes of lines; none for a full line.
    pub dash: Option<&'static str>,
    /// Width of lines.
    pub width: f64,
    /// Shape of points.
    pub marker: Marker,
}

/// Shape of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    Inverted,
    Cross,
    Dot,
}

impl Marker {
    /// Outline around the origin, as the data of a path; none for what is a circle.
    pub(super) fn outline(self) -> Option<&'static [(f64, f64)]> {
        match self {
            Self::Circle | Self::Dot | Self::Cross => None,
            Self::Square => Some(&[(-2.6, -2.6), (2.6, -2.6), (2.6, 2.6), (-2.6, 2.6)]),
            Self::Triangle => Some(&[(0.0, -3.6), (3.2, 2.2), (-3.2, 2.2)]),
            Self::Diamond => Some(&[(0.0, -3.7), (3.7, 0.0), (0.0, 3.7), (-3.7, 0.0)]),
            Self::Inverted => Some(&[(0.0, 3.6), (3.2, -2.2), (-3.2, -2.2)]),
        }
    }
}

/// How `role` looks.
pub(super) fn look(role: Role) -> Look {
    let (color, dash, width, marker) = match role {
        Role::First => ("#0072b2", None, 1.6, Marker::Circle),
        Role::Second => ("#d55e00", Some("7 3"), 1.6, Marker::Square),
        Role::Third => ("#009e73", Some("2 2.5"), 1.8, Marker::Triangle),
        Role::Fourth => ("#b85c93", Some("9 3 2 3"), 1.6, Marker::Diamond),
        Role::Fifth => ("#3a94cc", Some("9 3 2 3 2 3"), 1.6, Marker::Inverted),
        Role::Reference => ("#444444", Some("4 3"), 1.3, Marker::Cross),
        Role::Faint => ("#9a9a9a", None, 1.0, Marker::Dot),
    };
    Look {
        color,
        dash,
        width,
        marker,
    }
}
