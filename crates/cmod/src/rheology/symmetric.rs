//! Sums of products and Cholesky factors, which take most of the computing time of a fit.
//!
//! Both are vectorised over columns. Each sum therefore adds its terms in the same order, and all
//! processors give the same digits.

/// Number of rows, or columns of a factor, that are added to the sums together.
const ROWS: usize = 4;

/// Adds AᵀA to `sums`, `columns` by `columns`; `rows` contains A by rows. Entries below the
/// diagonal are not valid.
pub(crate) fn add_products(sums: &mut [f64], rows: &[f64], columns: usize) {
    if columns > 0 {
        pulp::Arch::new().dispatch(Products {
            sums,
            rows,
            columns,
        });
    }
}

/// [`add_products`] as a task that can be run with the vector instructions of the processor.
struct Products<'a> {
    sums: &'a mut [f64],
    rows: &'a [f64],
    columns: usize,
}

impl pulp::NullaryFnOnce for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        add_products_vectorised(self.sums, self.rows, self.columns);
    }
}

#[inline(always)]
#[allow(
    clippy::indexing_slicing,
    reason = "rows and rows of `sums` have `columns` elements, and `i` and `first` are below this number"
)]
fn add_products_vectorised(sums: &mut [f64], rows: &[f64], columns: usize) {
    let mut blocks = rows.chunks_exact(ROWS * columns);
    for block in &mut blocks {
        let (a, b) = block.split_at(2 * columns);
        let ((a, b), (c, d)) = (a.split_at(columns), b.split_at(columns));
        for (i, sums) in sums.chunks_exact_mut(columns).enumerate() {
            // the range starts at a whole vector; the elements below the diagonal are never read
            let first = i - i % 4;
            let factors = [a[i], b[i], c[i], d[i]];
            let rest = a[first..]
                .iter()
                .zip(&b[first..])
                .zip(&c[first..])
                .zip(&d[first..]);
            for (sum, (((a, b), c), d)) in sums[first..].iter_mut().zip(rest) {
                *sum = *sum + factors[0] * a + factors[1] * b + factors[2] * c + factors[3] * d;
            }
        }
    }
    for row in blocks.remainder().chunks_exact(columns) {
        for (i, sums) in sums.chunks_exact_mut(columns).enumerate() {
            let first = i - i % 4;
            for (sum, other) in sums[first..].iter_mut().zip(&row[first..]) {
                *sum += row[i] * other;
            }
        }
    }
}

/// Computes L of a symmetric matrix M = LLᵀ, by columns: `factor[j * size + i]` is L of row i >= j
/// and column j.
///
/// `factor` contains M by columns on entry, of which only the lower triangle is read. Returns false
/// if a pivot is not above `least_pivot`.
pub(crate) fn factorise(factor: &mut [f64], size: usize, least_pivot: f64) -> bool {
    pulp::Arch::new().dispatch(Factorisation {
        factor,
        size,
        least_pivot,
    })
}

/// [`factorise`] as a task that can be run with the vector instructions of the processor.
struct Factorisation<'a> {
    factor: &'a mut [f64],
    size: usize,
    least_pivot: f64,
}

impl pulp::NullaryFnOnce for Factorisation<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        factorise_vectorised(self.factor, self.size, self.least_pivot)
    }
}

#[inline(always)]
#[allow(
    clippy::indexing_slicing,
    reason = "`factor` has `size` columns of `size` elements, and `j` is below `size`"
)]
fn factorise_vectorised(factor: &mut [f64], size: usize, least_pivot: f64) -> bool {
    let mut known = vec![0.0; size];
    for j in 0..size {
        let known = &mut known[j..];
        known.fill(0.0);
        let (before, rest) = factor.split_at_mut(j * size);
        let mut blocks = before.chunks_exact(ROWS * size);
        for block in &mut blocks {
            let (a, b) = block.split_at(2 * size);
            let ((a, b), (c, d)) = (a.split_at(size), b.split_at(size));
            let factors = [a[j], b[j], c[j], d[j]];
            let rest = a[j..].iter().zip(&b[j..]).zip(&c[j..]).zip(&d[j..]);
            for (known, (((a, b), c), d)) in known.iter_mut().zip(rest) {
                *known = *known + factors[0] * a + factors[1] * b + factors[2] * c + factors[3] * d;
            }
        }
        for column in blocks.remainder().chunks_exact(size) {
            let own = column[j];
            for (known, entry) in known.iter_mut().zip(&column[j..]) {
                *known += own * entry;
            }
        }
        let column = &mut rest[j..size];
        let pivot = column[0] - known[0];
        if !(pivot > least_pivot && pivot.is_finite()) {
            return false;
        }
        let pivot = pivot.sqrt();
        column[0] = pivot;
        for (entry, known) in column.iter_mut().zip(known.iter()).skip(1) {
            *entry = (*entry - known) / pivot;
        }
    }
    true
}

/// Solves LLᵀz = b with the `factor` of [`factorise`]; `z` contains b on entry.
#[allow(
    clippy::indexing_slicing,
    reason = "the factor has `size` columns of `size` elements, `z` has `size` elements, and every index is below `size`"
)]
pub(crate) fn solve(factor: &[f64], z: &mut [f64]) {
    let size = z.len();
    let mut known = vec![0.0; size];
    for (j, column) in factor.chunks_exact(size.max(1)).enumerate() {
        z[j] = (z[j] - known[j]) / column[j];
        let own = z[j];
        for (known, entry) in known[j + 1..].iter_mut().zip(&column[j + 1..]) {
            *known += entry * own;
        }
    }
    for (i, column) in factor.chunks_exact(size.max(1)).enumerate().rev() {
        let known: f64 = column[i + 1..]
            .iter()
            .zip(&z[i + 1..])
            .map(|(l, z)| l * z)
            .sum();
        z[i] = (z[i] - known) / column[i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns irregular numbers between -1 and 1.
    fn numbers(count: u32) -> Vec<f64> {
        (0..count)
            .map(|k| (1e4 * f64::from(k + 1).sin()).fract())
            .collect()
    }

    #[test]
    fn sums_of_products_have_the_digits_of_one_row_after_the_other() {
        for (rows, columns) in [
            (0_u32, 3_u32),
            (1, 1),
            (3, 2),
            (4, 5),
            (9, 7),
            (18, 16),
            (21, 33),
        ] {
            let matrix = numbers(rows * columns);
            let columns = columns as usize;
            let mut sums = vec![0.0; columns * columns];
            add_products(&mut sums, &matrix, columns);
            for i in 0..columns {
                for j in i..columns {
                    let mut sum = 0.0;
                    for row in matrix.chunks_exact(columns) {
                        sum += row[i] * row[j];
                    }
                    let found: f64 = sums[i * columns + j];
                    assert_eq!(
                        found.to_bits(),
                        sum.to_bits(),
                        "{rows} x {columns}: {i}, {j}"
                    );
                }
            }
        }
    }

    #[test]
    fn factors_solve_and_an_indefinite_matrix_has_none() {
        for size in [1_u32, 2, 5, 12] {
            let entries = numbers((size + 3) * size);
            let size = size as usize;
            let mut matrix = vec![0.0; size * size];
            add_products(&mut matrix, &entries, size);
            for i in 0..size {
                for j in 0..i {
                    matrix[i * size + j] = matrix[j * size + i];
                }
            }
            let mut z: Vec<f64> = (0..size)
                .map(|i| matrix[i * size..(i + 1) * size].iter().sum())
                .collect();
            let mut factor = matrix.clone();
            assert!(factorise(&mut factor, size, 0.0));
            solve(&factor, &mut z);
            // the right side is M times a vector of ones, so the solution is 1 within rounding
            // times a condition number of some thousands
            assert!(z.iter().all(|z| (z - 1.0).abs() < 1e-11), "{z:?}");
            matrix[size * size - 1] = -1.0;
            assert!(!factorise(&mut matrix, size, 0.0));
        }
    }
}
