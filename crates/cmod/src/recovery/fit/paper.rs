//! Procedure of the paper: E₂ and B from one test for a given m, and m from the other tests.

use super::super::{RecoveryTest, ThreeElementParameters};
use super::prediction::{Coordinates, linearise, reference_stress};
use super::single::SingleTestFit;
use crate::error::{CmodError, check_enough_readings, check_positive};

/// Number of points of the scan over m before the minimum is refined.
const SCAN: u32 = 32;
/// Accuracy to which m is determined.
const EXPONENT_ACCURACY: f64 = 1e-6;

/// Outcome of [`paper_procedure`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct PaperFit {
    /// Fitted parameters.
    pub parameters: ThreeElementParameters,
    /// Fit of equation 4 to the reference test.
    pub reference: SingleTestFit,
    /// χ² of the readings of the other tests.
    pub others_chi_squared: f64,
    /// Exponents tried in the scan, with the χ² of the other tests for each.
    pub scan: Vec<(f64, f64)>,
    /// True if m is at an end of the range, so that no minimum was found inside the range.
    pub at_end_of_range: bool,
}

/// Fits `tests` by the procedure of paper C, section 3. For each m, E₂ and B follow uniquely from
/// test number `reference` (the paper uses Test 2, whose load is in the middle of the loads); m is
/// varied between the two `exponents` until the other tests match best.
///
/// `series_modulus` is E₁ \[Pa\]. The reference test determines E₂ and B, but not m. Therefore the
/// result scatters more than the result of a [joint fit](super::RecoveryFit). The procedure gives
/// no standard errors.
///
/// # Errors
/// [`CmodError::ReferenceTest`] if there is no such test; [`CmodError::TooFewReadings`] if there is
/// no other test; [`CmodError::NonPhysical`] unless 0 < lower < upper exponent; the errors of
/// [`SingleTestFit`].
pub fn paper_procedure(
    tests: &[RecoveryTest],
    reference: usize,
    series_modulus: f64,
    exponents: (f64, f64),
) -> Result<PaperFit, CmodError> {
    let (lower, upper) = exponents;
    check_positive("lower end of the exponents", lower)?;
    check_positive("range of the exponents", upper - lower)?;
    let count = tests.len();
    let test = tests.get(reference).ok_or(CmodError::ReferenceTest {
        index: reference,
        count,
    })?;
    let others: Vec<RecoveryTest> = tests
        .iter()
        .enumerate()
        .filter(|(index, _)| *index != reference)
        .map(|(_, test)| test.clone())
        .collect();
    check_enough_readings(others.len(), 1)?;
    let curve = SingleTestFit::new(test)?;
    let stress = reference_stress(&others);
    let misfit = |m: f64| -> Result<f64, CmodError> {
        let parameters = curve.parameters_for(test, m, series_modulus)?;
        let log_parallel_modulus = parameters.parallel_modulus.ln();
        let at = Coordinates {
            series_modulus,
            reference_stress: stress,
            log_parallel_modulus,
            log_rate: log_parallel_modulus + parameters.coefficient.ln() + m * stress.ln(),
            exponent: m,
        };
        Ok(linearise(&others, &at)?.sum_of_squares())
    };
    let width = (upper - lower) / f64::from(SCAN);
    let mut scan = Vec::new();
    for i in 0..=SCAN {
        let m = lower + width * f64::from(i);
        scan.push((m, misfit(m)?));
    }
    let (mut best, mut least) = (lower, f64::INFINITY);
    for (m, value) in &scan {
        if *value < least {
            (best, least) = (*m, *value);
        }
    }
    // golden-section search about the best point of the scan
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = ((best - width).max(lower), (best + width).min(upper));
    let (mut c, mut d) = (b - golden * (b - a), a + golden * (b - a));
    let (mut at_c, mut at_d) = (misfit(c)?, misfit(d)?);
    while b - a > EXPONENT_ACCURACY {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - golden * (b - a);
            at_c = misfit(c)?;
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + golden * (b - a);
            at_d = misfit(d)?;
        }
    }
    let exponent = 0.5 * (a + b);
    Ok(PaperFit {
        parameters: curve.parameters_for(test, exponent, series_modulus)?,
        reference: curve,
        others_chi_squared: misfit(exponent)?,
        scan,
        at_end_of_range: exponent - lower < 2.0 * EXPONENT_ACCURACY
            || upper - exponent < 2.0 * EXPONENT_ACCURACY,
    })
}
