//! Colours, dashes and markers of the roles.
//!
//! The colours are those of the palette of Okabe and Ito, which can be distinguished with any
//! colour vision. Purple and sky blue are darker than in that palette, for contrast with white.
//! Dashes and markers distinguish curves without colours. `report/style.css` of `rodlab` has the
//! same colours for light screens and others for dark screens.

use super::Role;

/// Colour of ranges where the result is not valid.
pub(super) const GREY: &str = "#808080";
pub(super) const GREY_OPACITY: f64 = 0.2;

/// Appearance of a role on white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Look {
    /// Colour.
    pub color: &'static str,
    /// Dashes of lines; `None` for a solid line.
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
    /// Outline around the origin, as the vertices of a path; `None` for a circle.
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

#[cfg(test)]
mod tests {
    use super::*;

    const TOLD_APART: [Role; 6] = [
        Role::First,
        Role::Second,
        Role::Third,
        Role::Fourth,
        Role::Fifth,
        Role::Reference,
    ];

    fn linear(color: &str) -> [f64; 3] {
        [1, 3, 5].map(|at| {
            let part = u8::from_str_radix(&color[at..at + 2], 16).unwrap();
            let part = f64::from(part) / 255.0;
            if part <= 0.04045 {
                part / 12.92
            } else {
                ((part + 0.055) / 1.055).powf(2.4)
            }
        })
    }

    /// CIE 1976 L*, a*, b* of a colour under the illuminant D65.
    fn lab([r, g, b]: [f64; 3]) -> [f64; 3] {
        let f = |t: f64| {
            if t > 0.008856 {
                t.cbrt()
            } else {
                7.787 * t + 16.0 / 116.0
            }
        };
        let x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
        let y = f(0.2126 * r + 0.7152 * g + 0.0722 * b);
        let z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    #[test]
    fn colours_are_told_apart_without_red_and_without_green_receptors() {
        // matrices for linear RGB (Viénot, Brettel and Mollon 1999)
        let eyes = [
            (
                "all receptors",
                [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            ),
            (
                "no red",
                [
                    [0.11238, 0.88762, 0.0],
                    [0.11238, 0.88762, 0.0],
                    [0.00401, -0.00401, 1.0],
                ],
            ),
            (
                "no green",
                [
                    [0.29275, 0.70725, 0.0],
                    [0.29275, 0.70725, 0.0],
                    [-0.02234, 0.02234, 1.0],
                ],
            ),
        ];
        for (eye, matrix) in eyes {
            let seen = |role: Role| {
                let color = linear(look(role).color);
                lab(matrix.map(|row| row.iter().zip(color).map(|(m, c)| m * c).sum()))
            };
            for (index, one) in TOLD_APART.into_iter().enumerate() {
                for other in &TOLD_APART[index + 1..] {
                    let (one_seen, other_seen) = (seen(one), seen(*other));
                    let square = |index: usize| (one_seen[index] - other_seen[index]).powi(2);
                    let distance = (square(0) + square(1) + square(2)).sqrt();
                    // tolerance: a difference of 2.3 is just noticeable side by side, and separate
                    // thin lines need several times as much
                    assert!(
                        distance > 12.0,
                        "{eye}: {one:?} and {other:?} are {distance:.1} apart"
                    );
                }
            }
        }
    }

    #[test]
    fn no_two_roles_share_dashes_and_marker() {
        for (index, one) in TOLD_APART.into_iter().enumerate() {
            for other in &TOLD_APART[index + 1..] {
                assert_ne!(look(one).dash, look(*other).dash, "{one:?} and {other:?}");
                assert_ne!(
                    look(one).marker,
                    look(*other).marker,
                    "{one:?} and {other:?}"
                );
            }
        }
    }
}
