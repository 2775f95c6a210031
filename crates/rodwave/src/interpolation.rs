//! Polynomials through equidistant points.

/// Value and slope (per spacing of the points) of an interpolating polynomial.
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

/// Polynomial of degree five through the six values of a history around one fractional index. Its
/// weights are the same for every history at that index.
pub(crate) struct Quintic {
    base: f64,
    value: [f64; 6],
    slope: [f64; 6],
}

impl Quintic {
    /// Computes Lagrange's weights and their derivatives on the nodes -2, -1, 0, 1, 2, 3 around
    /// `position`.
    pub(crate) fn around(position: f64) -> Self {
        // 1/Π_{i != j} (j - i)
        const INVERSE_GAPS: [f64; 6] = [
            -1.0 / 120.0,
            1.0 / 24.0,
            -1.0 / 12.0,
            1.0 / 12.0,
            -1.0 / 24.0,
            1.0 / 120.0,
        ];
        let base = position.floor();
        let u = position - base;
        let distances = [u + 2.0, u + 1.0, u, u - 1.0, u - 2.0, u - 3.0];
        let (mut value, mut slope) = ([0.0; 6], [0.0; 6]);
        let weights = value.iter_mut().zip(&mut slope).zip(&INVERSE_GAPS);
        for (j, ((value, slope), inverse_gaps)) in weights.enumerate() {
            let (mut product, mut derivative) = (*inverse_gaps, 0.0);
            for (i, distance) in distances.iter().enumerate() {
                if i != j {
                    derivative = derivative * distance + product;
                    product *= distance;
                }
            }
            *value = product;
            *slope = derivative;
        }
        Self { base, value, slope }
    }

    pub(crate) fn value(&self, history: &[f64]) -> f64 {
        self.sum(&self.value, history)
    }

    /// Returns the derivative with respect to the index.
    pub(crate) fn slope(&self, history: &[f64]) -> f64 {
        self.sum(&self.slope, history)
    }

    fn sum(&self, weights: &[f64; 6], history: &[f64]) -> f64 {
        let points = around::<6>(history, self.base, 2);
        points.iter().zip(weights).map(|(p, w)| p * w).sum()
    }
}

/// Returns the values of a history, starting `before` indices before `base`; they are zero outside
/// the history, as for a rod that does not move yet.
#[expect(
    clippy::cast_possible_truncation,
    reason = "positions on the history are far below 2^52, and positions outside it contribute nothing"
)]
fn around<const N: usize>(history: &[f64], base: f64, before: isize) -> [f64; N] {
    let first = (base as isize).saturating_sub(before);
    std::array::from_fn(|k| {
        usize::try_from(first.saturating_add(k.cast_signed()))
            .ok()
            .and_then(|index| history.get(index))
            .copied()
            .unwrap_or(0.0)
    })
}
