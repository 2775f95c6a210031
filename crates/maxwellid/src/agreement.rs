//! Agreement of the tests of a joint fit, and other remarks on a fit.

use crate::least_squares::Linearisation;

/// A remark on a fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitFlag {
    /// One test alone would give another value of a parameter than all tests together: length,
    /// density, sampling rate or material differ from the stated ones, or the model is wrong in a
    /// way that depends on the test.
    #[error(
        "test `{test}` alone would change {} by {change:.3}, {deviations:.1} standard deviations",
        in_words(.parameter)
    )]
    TestDisagrees {
        /// Name of the test.
        test: String,
        /// Name of the parameter.
        parameter: String,
        /// Change of the parameter if this test alone were fitted, with the other parameters fixed.
        change: f64,
        /// The change in standard deviations.
        deviations: f64,
    },
    /// The simulated front of a test does not arrive when the measured one does: the fit may be in
    /// a minimum that belongs to another period of the waveform.
    #[error(
        "test `{test}`: the measured front arrives {:.1} us after the simulated one",
        1e6 * .lag
    )]
    ArrivalOff {
        /// Name of the test.
        test: String,
        /// Measured minus simulated arrival \[s\].
        lag: f64,
    },
    /// The residual exceeds the stated noise. The standard errors are multiplied by `ratio`.
    #[error("the residual is {ratio:.2} times as large as the stated noise")]
    ResidualAboveNoise {
        /// Standard deviation of the whitened residual; 1 if it contains only the stated noise.
        ratio: f64,
    },
    /// The alternating estimation of parameters and excitation has not converged. No parameter gets
    /// the verdict [`crate::Verdict::Identified`].
    #[error(
        "the fit has not converged: each new estimate of the excitation still changes the parameters"
    )]
    Unsettled,
    /// The rise of χ² near the minimum differs from the rise that the standard error implies. The
    /// standard error therefore does not describe the values that the data exclude, and the
    /// parameter does not get the verdict [`crate::Verdict::Identified`]. Its profile
    /// ([`crate::profile`]) gives the excluded values.
    #[error(
        "the limits of {} from the data differ from those implied by its standard error",
        in_words(.parameter)
    )]
    Curved {
        /// Name of the parameter.
        parameter: String,
    },
    /// The finest grid permitted does not reach the requested accuracy.
    #[error(
        "halving the cells of the grid changes the response by {:.3} % of V0, requested at most {:.3} %",
        100.0 * .difference,
        100.0 * .requested
    )]
    GridTooCoarse {
        /// Rms difference from a grid with half the cell length, as a fraction of V0.
        difference: f64,
        /// Requested accuracy.
        requested: f64,
    },
}

/// Returns the words for the name of a parameter, such as `the logarithm of the modulus` for
/// `ln_modulus`.
fn in_words(name: &str) -> String {
    match name.strip_prefix("ln_") {
        Some(of) => format!("the logarithm of the {}", of.replace('_', " ")),
        None => format!("the {}", name.replace('_', " ")),
    }
}

/// Number of standard deviations above which a test is flagged as disagreeing with the others.
const DISAGREES: f64 = 5.0;

/// Flags of the tests that disagree with the joint minimum, from the score of each test for each
/// parameter, z = -Jᵀr/(s |J|) over the samples of the test. The variance of z is at most 1 if the
/// tests agree and the residual has the standard deviation s = `noise`.
pub(crate) fn disagreements(
    linearisation: &Linearisation,
    row_lengths: &[usize],
    noise: f64,
    names: &[&str],
    tests: &[String],
) -> Vec<FitFlag> {
    let mut flags = Vec::new();
    if row_lengths.len() < 2 || noise.is_nan() || noise <= 0.0 {
        return flags;
    }
    let mut start = 0;
    for (test, length) in tests.iter().zip(row_lengths) {
        let rows = start..start + length;
        start += length;
        let Some(residual) = linearisation.residual.get(rows.clone()) else {
            return flags;
        };
        for (name, column) in names.iter().zip(&linearisation.jacobian) {
            let Some(column) = column.get(rows.clone()) else {
                return flags;
            };
            let square: f64 = column.iter().map(|j| j * j).sum();
            let product: f64 = column.iter().zip(residual).map(|(j, r)| j * r).sum();
            let deviations = product.abs() / (noise * square.sqrt());
            if deviations > DISAGREES {
                flags.push(FitFlag::TestDisagrees {
                    test: test.clone(),
                    parameter: (*name).to_owned(),
                    change: -product / square,
                    deviations,
                });
            }
        }
    }
    flags
}
