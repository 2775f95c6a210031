//! One line of several inputs, solved by conditioning each input on those before it.

use num_complex::Complex64;

/// Smallest fraction of an input's power that must be independent of the other inputs; below it,
/// fewer than three digits of a response would be left in double precision.
const OWN_POWER: f64 = 1e-12;

/// Solution of one line by Cholesky factorisation, R = L L*.
pub(super) struct ConditionedLine {
    q: usize,
    /// L, row by row.
    factor: Vec<Complex64>,
    /// A column of L^-1.
    column: Vec<Complex64>,
    /// L^-1 r: contribution of each input beyond those of the inputs before it.
    pub(super) ordered: Vec<Complex64>,
    /// R^-1 r.
    pub(super) responses: Vec<Complex64>,
    /// Diagonal of R^-1.
    pub(super) inverse_diagonal: Vec<f64>,
    pub(super) multiple: f64,
}

#[allow(
    clippy::indexing_slicing,
    reason = "the factor has q rows of q elements, the lists have q elements, and every index is below q"
)]
impl ConditionedLine {
    pub(super) fn new(q: usize) -> Self {
        Self {
            q,
            factor: vec![Complex64::ZERO; q * q],
            column: vec![Complex64::ZERO; q],
            ordered: vec![Complex64::ZERO; q],
            responses: vec![Complex64::ZERO; q],
            inverse_diagonal: vec![0.0; q],
            multiple: f64::NAN,
        }
    }

    /// Solves the scaled spectra of inputs 0 .. q-1 and the output q; returns false if inputs are
    /// linearly dependent.
    pub(super) fn solve(&mut self, scaled: impl Fn(usize, usize) -> Complex64) -> bool {
        let q = self.q;
        for i in 0..q {
            for j in 0..=i {
                let (row_i, row_j) = (&self.factor[i * q..][..j], &self.factor[j * q..][..j]);
                let products = row_i.iter().zip(row_j).map(|(a, b)| a * b.conj());
                let rest = scaled(i, j) - products.sum::<Complex64>();
                self.factor[i * q + j] = if i > j {
                    rest / self.factor[j * q + j]
                } else if rest.re > OWN_POWER {
                    rest.re.sqrt().into()
                } else {
                    return false;
                };
            }
        }
        self.ordered = self.forward((0..q).map(|i| scaled(i, q)).collect());
        self.responses = self.backward(self.ordered.clone());
        for j in 0..q {
            self.column.fill(Complex64::ZERO);
            let mut squares = 0.0;
            for i in j..q {
                let known = self.factor[i * q..][..i].iter().zip(&self.column);
                let known: Complex64 = known.map(|(l, c)| l * c).sum();
                let unit = if i == j { 1.0 } else { 0.0 };
                self.column[i] = (unit - known) / self.factor[i * q + i];
                squares += self.column[i].norm_sqr();
            }
            self.inverse_diagonal[j] = squares;
        }
        let explained: f64 = self.ordered.iter().map(Complex64::norm_sqr).sum();
        // at most 1 within rounding, like the ordinary coherence
        self.multiple = explained.min(1.0);
        true
    }

    /// Returns L^-1 times a column, computed in place.
    fn forward(&self, mut column: Vec<Complex64>) -> Vec<Complex64> {
        for i in 0..self.q {
            let known = self.factor[i * self.q..][..i].iter().zip(&column);
            let known: Complex64 = known.map(|(l, c)| l * c).sum();
            column[i] = (column[i] - known) / self.factor[i * self.q + i];
        }
        column
    }

    /// Returns L*^-1 times a column, computed in place.
    fn backward(&self, mut column: Vec<Complex64>) -> Vec<Complex64> {
        let q = self.q;
        for i in (0..q).rev() {
            let later = (i + 1..q).map(|k| self.factor[k * q + i].conj() * column[k]);
            let later: Complex64 = later.sum();
            column[i] = (column[i] - later) / self.factor[i * q + i].conj();
        }
        column
    }

    /// Returns R^-1 times a column, for the line that was solved.
    pub(super) fn inverse_times(&self, column: Vec<Complex64>) -> Vec<Complex64> {
        self.backward(self.forward(column))
    }
}
