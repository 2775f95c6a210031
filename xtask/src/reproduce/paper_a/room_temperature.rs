//! Tests 1 to 10 at room temperature: Figures 3 and 4.

use std::f64::consts::TAU;

use cmod::validity::Violation;
use cmod::{ModulusEstimate, ModulusLine, Solver};
use num_complex::Complex64;
use rayon::prelude::*;
use rodwave::digits::significant;
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use serde::Serialize;

use super::super::coverage::within;
use super::super::{Error, Table, table_of};
use super::rig::{SEED, VirtualTest};
use testbed::papers::paper_a::PaperA;

/// Difference of γL above which the roots of two solvers count as different.
const OTHER_ROOT: f64 = 1e-6;

/// Evaluated test.
#[derive(Debug)]
pub(crate) struct Evaluated {
    pub(crate) row: Row,
    pub(crate) length: f64,
    pub(crate) diameter: f64,
    pub(crate) medium: Medium<ConstantQ>,
    pub(crate) estimate: ModulusEstimate,
}

/// Results of a test, in the order of Table 2.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    pub(crate) test: String,
    pub(crate) mass_ratio: f64,
    /// Number of lines up to 20 kHz.
    lines: usize,
    /// Number of these lines that fulfil conditions (i) to (iii) of the paper.
    admissible: usize,
    /// First and last line that fulfils the conditions, in Hz.
    pub(crate) admissible_hz: [f64; 2],
    pub(crate) valid: usize,
    /// Lowest and highest valid line, in Hz.
    lowest_hz: f64,
    highest_hz: f64,
    /// Greatest relative errors of the valid lines, of E' and of the loss factor.
    #[serde(skip)]
    pub(crate) worst: [f64; 2],
    /// Fraction of the values E' and E'' of valid lines that are within one and within two standard
    /// errors of the material.
    pub(crate) within: [f64; 2],
    /// Number of admissible lines at which eq. 5, started from γ_0 L, gives another root than
    /// continuation.
    pub(crate) wrong_by_newton: usize,
    /// Number of these lines at which the other root also fulfils conditions (i) to (iii).
    pub(crate) unnoticed: usize,
}

pub(crate) fn all(paper: &PaperA) -> Result<Vec<Evaluated>, Error> {
    paper
        .tests
        .par_iter()
        .enumerate()
        .map(|(index, test)| {
            let rig = VirtualTest::new(paper, test, test.law()?)?;
            let ratio = rig.ratio(1.0, SEED + index as u64)?;
            let estimate = rig.estimate(&ratio, Solver::Continuation)?;
            let newton = rig.estimate(&ratio, Solver::Newton)?;
            let (mut wrong, mut unnoticed) = (0, 0);
            for line in estimate.lines().iter().filter(|line| is_admissible(line)) {
                let same = newton
                    .lines()
                    .iter()
                    .find(|other| other.index == line.index);
                let by_newton = same.filter(|other| {
                    let distance = other.propagation_coefficient - line.propagation_coefficient;
                    distance.norm() * rig.specimen.length < OTHER_ROOT
                });
                if by_newton.is_none() {
                    wrong += 1;
                    unnoticed += usize::from(same.is_some_and(is_admissible));
                }
            }
            let exact = |line: &ModulusLine| rig.medium.modulus(TAU * line.frequency_hz);
            let [lowest_hz, highest_hz] = valid_band(&estimate);
            let mut fulfilling = estimate.lines().iter().filter(|line| is_admissible(line));
            let first = fulfilling.next().map_or(f64::NAN, |line| line.frequency_hz);
            let last = fulfilling
                .next_back()
                .map_or(first, |line| line.frequency_hz);
            Ok(Evaluated {
                row: Row {
                    test: test.name.clone(),
                    mass_ratio: rig.specimen.mass_ratio(),
                    lines: estimate.lines().len() + estimate.refused().len(),
                    admissible: estimate.lines().iter().filter(|l| is_admissible(l)).count(),
                    admissible_hz: [first, last],
                    valid: estimate.valid().count(),
                    lowest_hz,
                    highest_hz,
                    worst: worst(&estimate, &exact),
                    within: [1.0, 2.0].map(|limit| within(&estimate, &exact, limit)),
                    wrong_by_newton: wrong,
                    unnoticed,
                },
                length: test.length,
                diameter: test.diameter,
                medium: rig.medium,
                estimate,
            })
        })
        .collect()
}

/// Returns true if the iteration converged and the line fulfils conditions (i) to (iii) of the
/// paper.
pub(crate) fn is_admissible(line: &ModulusLine) -> bool {
    !line.validity.violations().iter().any(|violation| {
        matches!(
            violation,
            Violation::WavelengthTooShort { .. }
                | Violation::WavelengthTooLong { .. }
                | Violation::DampingNotPositive { .. }
                | Violation::WaveNumberNotPositive { .. }
                | Violation::NotConverged { .. }
        )
    })
}

/// Returns the first and the last valid line, in Hz; NaN if there is none.
pub(crate) fn valid_band(estimate: &ModulusEstimate) -> [f64; 2] {
    let frequency = |line: Option<&ModulusLine>| line.map_or(f64::NAN, |line| line.frequency_hz);
    [
        frequency(estimate.valid().next()),
        frequency(estimate.valid().last()),
    ]
}

/// Returns the greatest relative errors of E' and of the loss factor on the valid lines.
fn worst(estimate: &ModulusEstimate, exact: &dyn Fn(&ModulusLine) -> Complex64) -> [f64; 2] {
    estimate.valid().fold([0.0, 0.0], |[storage, loss], line| {
        let exact = exact(line);
        let exact_loss = exact.im / exact.re;
        [
            storage.max((line.modulus.re / exact.re - 1.0).abs()),
            loss.max((line.loss_factor / exact_loss - 1.0).abs()),
        ]
    })
}

pub(crate) fn table(tests: &[Evaluated]) -> Table {
    table_of!(tests, |Evaluated { row, length, diameter, .. }|
        "test" => row.test,
        "D, mm" => format!("{:.1}", 1e3 * diameter),
        "L, mm" => format!("{:.0}", 1e3 * length),
        "μ" => significant(row.mass_ratio, 2),
        "lines" => row.lines,
        "(i) to (iii)" => row.admissible,
        "from, to, Hz" => format!("{:.0} to {:.0}", row.admissible_hz[0], row.admissible_hz[1]),
        "of these, valid" => row.valid,
        "from, Hz" => format!("{:.0}", row.lowest_hz),
        "to, Hz" => format!("{:.0}", row.highest_hz),
        "greatest error of E', %" => significant(100.0 * row.worst[0], 2),
        "of E''/E', %" => significant(100.0 * row.worst[1], 2),
        "within 1 s.e., %" => format!("{:.0}", 100.0 * row.within[0]),
        "within 2 s.e., %" => format!("{:.0}", 100.0 * row.within[1]),
        "other root by eq. 5, lines" => row.wrong_by_newton,
        "unnoticed" => row.unnoticed,
    )
}

/// Returns E' and E'' of every valid line.
pub(crate) fn curves(tests: &[Evaluated]) -> Table {
    let lines = tests
        .iter()
        .flat_map(|one| one.estimate.valid().map(move |line| (&one.row.test, line)));
    table_of!(lines, |(test, line)|
        "test" => test,
        "frequency, Hz" => format!("{:.1}", line.frequency_hz),
        "E', GPa" => format!("{:.5}", 1e-9 * line.modulus.re),
        "standard error, GPa" => significant(1e-9 * line.standard_error.storage_modulus, 2),
        "E'', GPa" => format!("{:.5}", 1e-9 * line.modulus.im),
        "standard error of E'', GPa" => significant(1e-9 * line.standard_error.loss_modulus, 2),
    )
}
