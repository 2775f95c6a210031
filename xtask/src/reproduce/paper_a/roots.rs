//! Choice of the root: Newton's iteration as printed, compared with continuation; the series,
//! compared with the numerical solution.

use std::f64::consts::TAU;

use cmod::two_point::EndMassEquation;
use cmod::validity::{AcceptanceLimits, Violation};
use cmod::{ModulusEstimate, ModulusLine, Solver, Specimen, TwoPoint};
use num_complex::Complex64;
use rodwave::digits::significant;
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::{EndAccelerationTest, Specimen as Rig};
use rodwave::medium::Medium;
use rodwave::modulus::PowerLawPropagation;
use serde::Serialize;

use super::super::{Error, Table, table_of};
use super::rig::SEED;
use testbed::noise::Noise;
use testbed::papers::paper_a::{PaperA, Test};
use testbed::papers::paper_e::PaperE;

/// Rod of low loss: its damping as a fraction of that of paper E, eq. 7, and its mass ratio.
const PART_OF_DAMPING: f64 = 0.2;
const MASS_RATIO: f64 = 0.036;
/// First line of the rod of low loss, in Hz, and the number of its lines.
const FROM_HZ: f64 = 362.0;
const LINES: u32 = 1572;
/// Noise of Ψ relative to its magnitude.
const NOISES: [f64; 3] = [0.0, 0.005, 0.02];
/// Difference of γL above which roots count as different.
const OTHER_ROOT: f64 = 1e-6;
/// Spacing of the lines for the series, in Hz.
const SERIES_STEP_HZ: f64 = 20.0;

/// Numbers of wrong roots of the solvers at one level of noise.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Wrong {
    pub(crate) noise: f64,
    /// Number for Newton's iteration as printed, and for continuation.
    pub(crate) wrong: [usize; 2],
    /// Number of wrong roots that fulfil conditions (i) to (iii).
    pub(crate) unnoticed: [usize; 2],
    /// Number of lines at which noise has merged two roots. No root is correct there, and these
    /// lines are not counted as wrong.
    pub(crate) ambiguous: usize,
}

/// Series for the exact ratio of a test of Table 2.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Series {
    pub(crate) test: String,
    pub(crate) mass_ratio: f64,
    /// Number of lines that fulfil conditions (i) to (iii), and number of these lines that the
    /// criterion of one third accepts.
    pub(crate) lines: usize,
    pub(crate) accepted: usize,
    /// First line that the criterion does not accept, in Hz.
    refused_hz: Option<f64>,
    /// Greatest relative difference between four terms and the numerical solution, over E' and E'':
    /// for the accepted lines, and for all lines.
    pub(crate) of_accepted: [f64; 2],
    pub(crate) of_all: [f64; 2],
}

pub(crate) fn wrong_roots(paper: &PaperA, of_polyamide: &PaperE) -> Result<Vec<Wrong>, Error> {
    let test = super::named(paper, "10")?;
    let without_mass = Specimen {
        accelerometer_mass: 1.0,
        ..test.specimen(paper)
    };
    let specimen = Specimen {
        accelerometer_mass: MASS_RATIO / without_mass.mass_ratio(),
        ..without_mass
    };
    let [damping, damping_exponent, wave_number, wave_number_exponent] = of_polyamide.nylon;
    let medium = Medium::new(
        specimen.density,
        PowerLawPropagation::new(
            PART_OF_DAMPING * damping,
            damping_exponent,
            wave_number,
            wave_number_exponent,
        )?,
    )?;
    let rod = EndAccelerationTest::new(&medium, &rig(&specimen)?)?;
    let frequency_hz: Vec<f64> = (0..LINES)
        .map(|j| FROM_HZ + (paper.highest_hz - FROM_HZ) * f64::from(j) / f64::from(LINES - 1))
        .collect();
    let exact: Vec<Complex64> = frequency_hz
        .iter()
        .map(|f| rod.acceleration_ratio(TAU * f))
        .collect::<Result<_, _>>()?;
    let mut random = Noise::seeded(SEED);
    NOISES
        .into_iter()
        .map(|noise| {
            let ratio: Vec<Complex64> = exact
                .iter()
                .map(|psi| psi + noise * psi.norm() * random.circular(1.0))
                .collect();
            let variance: Vec<f64> = exact
                .iter()
                .map(|psi| noise * noise * psi.norm_sqr())
                .collect();
            let mut result = Wrong {
                noise,
                wrong: [0; 2],
                unnoticed: [0; 2],
                ambiguous: 0,
            };
            // where |δΨ f''| ≤ |f'|²/2 at the true γL, Newton's iteration started there converges
            // to the correct root (Kantorovich)
            let right: Vec<Option<Complex64>> = frequency_hz
                .iter()
                .zip(exact.iter().zip(&ratio))
                .map(|(f, (exact, ratio))| {
                    let truth = medium.propagation_coefficient(TAU * f) * specimen.length;
                    let equation = EndMassEquation {
                        mass_ratio: specimen.mass_ratio(),
                        acceleration_ratio: *ratio,
                    };
                    let first = equation.derivative(truth).norm_sqr();
                    let second = equation.second_derivative(truth).norm();
                    ((ratio - exact).norm() * second <= 0.5 * first)
                        .then(|| equation.newton(truth).gamma_length)
                })
                .collect();
            result.ambiguous = right.iter().filter(|root| root.is_none()).count();
            for (index, solver) in [Solver::Newton, Solver::Continuation]
                .into_iter()
                .enumerate()
            {
                let estimate = TwoPoint::new(specimen)?
                    .with_limits(AcceptanceLimits::NONE)?
                    .with_solver(solver)
                    .estimate(&frequency_hz, &ratio, &variance)?;
                result.wrong[index] += estimate.refused().len();
                for line in estimate.lines() {
                    let Some(right) = right[line.index] else {
                        continue;
                    };
                    let found = line.propagation_coefficient * specimen.length;
                    if (found - right).norm() >= OTHER_ROOT {
                        result.wrong[index] += 1;
                        let admissible = super::room_temperature::is_admissible(line);
                        result.unnoticed[index] += usize::from(admissible);
                    }
                }
            }
            Ok(result)
        })
        .collect()
}

fn rig(specimen: &Specimen) -> Result<Rig, Error> {
    Ok(Rig {
        section: Circle::of_diameter(specimen.diameter)?.into(),
        length: specimen.length,
        accelerometer_mass: specimen.accelerometer_mass,
    })
}

pub(crate) fn series(paper: &PaperA) -> Result<Vec<Series>, Error> {
    paper
        .tests
        .iter()
        .map(|test| series_of(paper, test))
        .collect()
}

fn series_of(paper: &PaperA, test: &Test) -> Result<Series, Error> {
    let specimen = test.specimen(paper);
    let medium = Medium::new(specimen.density, test.law()?)?;
    let rod = EndAccelerationTest::new(&medium, &rig(&specimen)?)?;
    let count = (paper.highest_hz / SERIES_STEP_HZ).round() as u32;
    let frequency_hz: Vec<f64> = (1..=count).map(|j| SERIES_STEP_HZ * f64::from(j)).collect();
    let ratio: Vec<Complex64> = frequency_hz
        .iter()
        .map(|f| rod.acceleration_ratio(TAU * f))
        .collect::<Result<_, _>>()?;
    let by = |solver: Solver| -> Result<ModulusEstimate, Error> {
        Ok(TwoPoint::new(specimen)?
            .with_limits(AcceptanceLimits::NONE)?
            .with_solver(solver)
            .estimate(&frequency_hz, &ratio, &vec![0.0; ratio.len()])?)
    };
    let (numerical, series) = (by(Solver::Continuation)?, by(Solver::Series)?);
    let refused = |line: &ModulusLine| {
        let mut violations = line.validity.violations().iter();
        violations.any(|violation| matches!(violation, Violation::SeriesTruncated { .. }))
    };
    let mut result = Series {
        test: test.name.clone(),
        mass_ratio: specimen.mass_ratio(),
        lines: 0,
        accepted: 0,
        refused_hz: None,
        of_accepted: [0.0; 2],
        of_all: [0.0; 2],
    };
    for line in numerical.lines() {
        if !super::room_temperature::is_admissible(line) {
            continue;
        }
        result.lines += 1;
        let Some(other) = series
            .lines()
            .iter()
            .find(|other| other.index == line.index)
        else {
            continue;
        };
        let differences = [
            other.modulus.re / line.modulus.re - 1.0,
            other.modulus.im / line.modulus.im - 1.0,
        ];
        let raise = |worst: &mut [f64; 2]| {
            for (worst, difference) in worst.iter_mut().zip(differences) {
                *worst = worst.max(difference.abs());
            }
        };
        raise(&mut result.of_all);
        if refused(other) {
            result.refused_hz.get_or_insert(line.frequency_hz);
        } else {
            result.accepted += 1;
            raise(&mut result.of_accepted);
        }
    }
    Ok(result)
}

pub(crate) fn wrong_table(rows: &[Wrong]) -> Table {
    table_of!(rows, |row|
        "noise of Ψ, %" => 100.0 * row.noise,
        "wrong root by eq. 5, lines" => row.wrong[0],
        "of these, unnoticed by (i) to (iii)" => row.unnoticed[0],
        "wrong root by continuation, lines" => row.wrong[1],
        "of these, unnoticed" => row.unnoticed[1],
        "lines with two roots merged by noise" => row.ambiguous,
    )
}

pub(crate) fn series_table(rows: &[Series]) -> Table {
    table_of!(rows, |row|
        "test" => row.test,
        "μ" => significant(row.mass_ratio, 2),
        "lines that fulfil (i) to (iii)" => row.lines,
        "accepted by the criterion of one third" => row.accepted,
        "first rejected line, Hz" => row.refused_hz.map_or("none".into(), |f| format!("{f:.0}")),
        "difference of E' on accepted lines, %" => significant(100.0 * row.of_accepted[0], 2),
        "of E'', %" => significant(100.0 * row.of_accepted[1], 2),
        "difference of E' on all lines, %" => significant(100.0 * row.of_all[0], 2),
        "of E'' on all lines, %" => significant(100.0 * row.of_all[1], 2),
    )
}
