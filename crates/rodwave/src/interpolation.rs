//! Polynomials through equidistant points.

/// Value and slope (per distance of the points) of an interpolating polynomial.
pub(crate) struct Interpolated {
    pub(crate) value: f64,
    pub(crate) slope: f64,
}

/// Cubic through four points at -1, 0, 1, 2, evaluated at `u`.
#[inline]
pub(crate) fn cubic([a, b, c, d]: [f64; 4], u: f64) -> Interpolated {
    let third = (d - a) / 6.0 + (b - c) / 2.0;
    let second = (a + c) / 2.0 - b;
    let first = c - b / 2.0 - a / 3.0 - d / 6.0;
    Interpolated {
        value: b + u * (first + u * (second + u * third)),
        slope: first + u * (2.0 * second + 3.0 * u * third),
    }
}

/// Cubic through the four values of a history around a fractional index.
pub(crate) fn cubic_at(history: &[f64], position: f64) -> Interpolated {
    let base = position.floor();
    cubic(around(history, base, 1), position - base)
}

/// Polynomial of degree five through the six values of a history around a fractional index.
#[expect(clippy::cast_precision_loss, reason = "six points")]
pub(crate) fn quintic_at(history: &[f64], position: f64) -> Interpolated {
    let base = position.floor();
    let u = position - base;
    let points: [f64; 6] = around(history, base, 2);
    // Lagrange's weights and their derivatives on the nodes -2, -1, 0, 1, 2, 3
    let mut value = 0.0;
    let mut slope = 0.0;
    for (j, point) in points.iter().enumerate() {
        let (mut product, mut derivative) = (1.0, 0.0);
        for i in (0..points.len()).filter(|i| *i != j) {
            let gap = j as f64 - i as f64;
            let distance = u - (i as f64 - 2.0);
            derivative = derivative * distance / gap + product / gap;
            product *= distance / gap;
        }
        value += point * product;
        slope += point * derivative;
    }
    Interpolated { value, slope }
}

/// The values of a history from `before` ahead of the index `base` on; zero outside it, as before a rod moves.
#[expect(
    clippy::cast_possible_truncation,
    reason = "positions lie on the history, far below 2^52"
)]
fn around<const N: usize>(history: &[f64], base: f64, before: isize) -> [f64; N] {
    let first = base as isize - before;
    std::array::from_fn(|k| {
        usize::try_from(first + k.cast_signed())
            .ok()
            .and_then(|index| history.get(index))
            .copied()
            .unwrap_or(0.0)
    })
}
