//! Coverage of the truth by stated errors.

use std::fmt;

use cmod::ModulusLine;
use num_complex::Complex64;

/// Errors of E' and E'' divided by their standard errors, counted within the factors of 68.3 % and
/// 95 %, and the largest relative errors.
#[derive(Default)]
pub(crate) struct Coverage {
    one: f64,
    two: f64,
    count: f64,
    pub(crate) lines: usize,
    pub(crate) worst_storage: f64,
    pub(crate) worst_loss_factor: f64,
}

impl Coverage {
    /// Adds one line, with the coverage factors of 68.3 % and 95 %.
    pub(crate) fn add_with(&mut self, line: &ModulusLine, exact: Complex64, [one, two]: [f64; 2]) {
        let error = line.modulus - exact;
        let stated = &line.standard_error;
        self.add_error(
            error,
            [stated.storage_modulus, stated.loss_modulus],
            [one, two],
        );
        let storage = (error.re / exact.re).abs();
        let loss_factor = (line.loss_factor * exact.re / exact.im - 1.0).abs();
        self.worst_storage = self.worst_storage.max(storage);
        self.worst_loss_factor = self.worst_loss_factor.max(loss_factor);
    }

    /// Adds one complex error with the standard errors of its parts.
    pub(crate) fn add_error(&mut self, error: Complex64, stated: [f64; 2], [one, two]: [f64; 2]) {
        for (error, stated) in [error.re, error.im].into_iter().zip(stated) {
            let ratio = error.abs() / stated;
            self.one += f64::from(ratio <= one);
            self.two += f64::from(ratio <= two);
            self.count += 1.0;
        }
        self.lines += 1;
    }

    /// Returns the fractions of the values within the two factors.
    pub(crate) fn parts(&self) -> (f64, f64) {
        (self.one / self.count, self.two / self.count)
    }

    /// Checks for 68 % ± 5 % and 95 % ± 2 %, the required accuracy of stated errors. The sampling
    /// error of 4000 or more independent values is below 0.8 %.
    pub(crate) fn check(&self, name: &str) {
        self.check_within(name, [(0.683, 0.05), (0.95, 0.02)]);
    }

    /// Checks for two expected fractions with their tolerances.
    pub(crate) fn check_within(&self, name: &str, expected: [(f64, f64); 2]) {
        assert!(self.count > 4000.0, "{name}: {} values", self.count);
        let (one, two) = self.parts();
        for (part, (expected, tolerance)) in [one, two].into_iter().zip(expected) {
            let error = (part - expected).abs();
            assert!(error < tolerance, "{name}: {part:.4} for {expected}");
        }
    }

    /// Checks that E' is within 1 % and the loss factor within 5 %.
    pub(crate) fn check_errors(&self, name: &str) {
        let (storage, loss) = (self.worst_storage, self.worst_loss_factor);
        assert!(storage < 0.01, "{name}: E' off by {storage:.2e}");
        assert!(loss < 0.05, "{name}: loss factor off by {loss:.2e}");
    }
}

impl fmt::Display for Coverage {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (one, two) = self.parts();
        write!(
            formatter,
            "{} lines, {one:.3} and {two:.3} covered, E' off by up to {:.1e}, the loss factor by {:.1e}",
            self.lines, self.worst_storage, self.worst_loss_factor
        )
    }
}
