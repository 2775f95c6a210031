//! The mobilities of members in the system of equations of their joints.

use num_complex::Complex64;

/// Places of the mobilities of the members in the bordered matrix
///
/// ```math
/// \begin{pmatrix} B Y B^T & B Y e \\ e^T Y B^T & e^T Y e \end{pmatrix}
/// ```
///
/// of an assembly that is struck at the point e. The mobilities Y are stored by members, each by
/// rows.
#[derive(Debug, Clone)]
pub(super) struct Incidence {
    /// Number of stored mobilities.
    pub(super) n_entries: usize,
    /// The stored mobilities, with their signs, whose sum is an entry of the matrix; the entries by
    /// rows.
    pub(super) terms: Vec<Vec<(usize, f64)>>,
}

impl Incidence {
    /// Finds the places for members with these numbers of points. The points are counted over all
    /// members; `joints` are pairs of points.
    pub(super) fn of(n_points: &[usize], joints: &[[usize; 2]], struck: usize) -> Self {
        // first stored mobility of the member of a point, its number of points, and the point
        let mut places = Vec::new();
        let mut n_entries = 0;
        for &points in n_points {
            places.extend((0..points).map(|point| (n_entries, points, point)));
            n_entries += points * points;
        }
        let entry = |row: usize, column: usize| {
            let (&(first, points, row), &(other, _, column)) =
                places.get(row).zip(places.get(column))?;
            (first == other).then_some(first + row * points + column)
        };
        let across = joints
            .iter()
            .map(|&[one, other]| vec![(one, 1.0), (other, -1.0)]);
        let rows: Vec<Vec<(usize, f64)>> = across.chain([vec![(struck, 1.0)]]).collect();
        let mut terms = Vec::with_capacity(rows.len() * rows.len());
        for row in &rows {
            for column in &rows {
                let products = row.iter().flat_map(|&(i, of_i)| {
                    let columns = column.iter();
                    columns.filter_map(move |&(k, of_k)| Some((entry(i, k)?, of_i * of_k)))
                });
                terms.push(products.collect());
            }
        }
        Self { n_entries, terms }
    }
}

/// Eliminates all but the last row and column of the `bordered` matrix, `(size, size)` by rows, and
/// returns the entry that is left,
///
/// ```math
/// \begin{pmatrix} M & b \\ c^T & d \end{pmatrix} \to d - c^T M^{-1} b ,
/// ```
///
/// by Gaussian elimination with partial pivoting within M. It is not finite for a singular M.
///
/// The matrix has one row per joint, and is eliminated on every line of every draw: the general
/// factorisation of a library, which allocates, takes longer than the elimination itself.
#[allow(
    clippy::indexing_slicing,
    reason = "row and column are below the size of the matrix"
)]
pub(super) fn schur_complement(bordered: &mut [Complex64], size: usize) -> Complex64 {
    let mut rest = bordered;
    for column in 0..size.saturating_sub(1) {
        let (pivot_row, below) = std::mem::take(&mut rest).split_at_mut(size);
        let rows = below.chunks_exact(size).take(size - column - 2);
        let largest = rows
            .enumerate()
            .max_by(|(_, a), (_, b)| a[column].l1_norm().total_cmp(&b[column].l1_norm()));
        if let Some((row, entries)) = largest
            && entries[column].l1_norm() > pivot_row[column].l1_norm()
        {
            pivot_row.swap_with_slice(&mut below[row * size..(row + 1) * size]);
        }
        let inverse = pivot_row[column].inv();
        for row in below.chunks_exact_mut(size) {
            let factor = row[column] * inverse;
            for (entry, pivot) in row.iter_mut().zip(&*pivot_row).skip(column + 1) {
                *entry -= factor * pivot;
            }
        }
        rest = below;
    }
    rest.last()
        .copied()
        .unwrap_or(Complex64::new(f64::NAN, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inverse of [[0, 2], [i, 0]] is [[0, -i], [1/2, 0]]: the first pivot is zero.
    #[test]
    fn rows_are_exchanged_at_a_zero_pivot() {
        let c = Complex64::new;
        let [zero, one, two, three] = [0.0, 1.0, 2.0, 3.0].map(|re| c(re, 0.0));
        let mut bordered = [zero, two, one, c(0.0, 1.0), zero, three, one, one, two];
        let left = schur_complement(&mut bordered, 3);
        // d - (1, 1) M⁻¹ (1, 3) = 2 + 3i - 1/2
        assert!((left - c(1.5, 3.0)).norm() < 1e-15, "{left}");
        assert_eq!(schur_complement(&mut [two], 1), two);
        let mut singular = [zero, one, one, one];
        assert!(!schur_complement(&mut singular, 2).is_finite());
    }
}
