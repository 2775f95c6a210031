//! Generalised Maxwell model as a function of its coordinates, on lines that may belong to several
//! temperatures.

use num_complex::Complex64;
use rodwave::RodwaveError;
use rodwave::modulus::{GeneralisedMaxwell, MaxwellBranch};

use super::model::{Model, ParameterKind};
use super::parameter::Scale;
use super::transient::{Lines, Reading, left_of_branch, respond};

/// Model E = E∞ + Σ Eᵢ z(ωτᵢ) with z(x) = ix/(1 + ix). Its coordinates are ln E∞ (unless E∞ = 0),
/// ln Eᵢ, ln τᵢ, and the logarithms of the shifts a_T. At a line of temperature T the law is
/// evaluated at ω a_T.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Prony {
    solid: bool,
    branches: usize,
    /// Index of the shift of each line, if the line has one; empty without shifts.
    shift_of_line: Vec<Option<usize>>,
    /// Number of vertical factors, and the index of the factor of each line, if the line has one.
    factors: usize,
    factor_of_line: Vec<Option<usize>>,
    kinds: Vec<ParameterKind>,
}

impl Prony {
    pub(super) fn new(solid: bool, branches: usize) -> Self {
        Self::shifted(solid, branches, Vec::new(), &[])
    }

    /// Creates a model of this number of parameters. It has an equilibrium modulus if the number is
    /// odd.
    pub(super) fn of_parameters(parameters: usize) -> Self {
        Self::new(parameters % 2 == 1, parameters / 2)
    }

    /// Adds a shift for each temperature \[K\] of `shifted`, at the end of the coordinates.
    pub(super) fn shifted(
        solid: bool,
        branches: usize,
        shift_of_line: Vec<Option<usize>>,
        shifted: &[f64],
    ) -> Self {
        let first = usize::from(solid);
        let mut kinds = Vec::with_capacity(first + 2 * branches + shifted.len());
        if solid {
            kinds.push(ParameterKind::new(
                "equilibrium modulus",
                "Pa",
                Scale::Ratio,
            ));
        }
        for i in 0..branches {
            let time = first + 2 * i + 1;
            let modulus = ParameterKind::new(format!("modulus {}", i + 1), "Pa", Scale::Ratio);
            let relaxation =
                ParameterKind::new(format!("relaxation time {}", i + 1), "s", Scale::Ratio);
            let (modulus, relaxation) = if solid || i + 1 < branches {
                (modulus.of_loss(time - 1), relaxation.of_loss(time - 1))
            } else {
                // without a spring the slowest branch acts as a spring if its relaxation time is
                // long
                (modulus, relaxation.of_loss_towards(time, 1.0))
            };
            kinds.push(modulus.of_relaxation(time));
            kinds.push(relaxation.of_relaxation(time));
        }
        for temperature in shifted {
            let name = format!("shift factor at {temperature} K");
            kinds.push(ParameterKind::new(name, "1", Scale::Ratio));
        }
        Self {
            solid,
            branches,
            shift_of_line,
            factors: 0,
            factor_of_line: Vec::new(),
            kinds,
        }
    }

    /// Adds a factor of the modulus for each temperature \[K\] of `factors`, before the shifts.
    pub(super) fn with_factors(
        mut self,
        factor_of_line: Vec<Option<usize>>,
        factors: &[f64],
    ) -> Self {
        let place = self.first() + 2 * self.branches;
        let kind = |temperature: &f64| {
            let name = format!("vertical factor at {temperature} K");
            ParameterKind::new(name, "1", Scale::Ratio)
        };
        self.kinds.splice(place..place, factors.iter().map(kind));
        self.factors = factors.len();
        self.factor_of_line = factor_of_line;
        self
    }

    /// Returns the index of the first coordinate of a branch.
    fn first(&self) -> usize {
        usize::from(self.solid)
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "`at` has the coordinates that `kinds` names: two for each branch behind the first"
    )]
    pub(super) fn law_at(&self, at: &[f64]) -> Result<GeneralisedMaxwell, RodwaveError> {
        let (equilibrium, rest) = at.split_at(self.first());
        let branches = branches_at(&rest[..2 * self.branches]);
        GeneralisedMaxwell::new(equilibrium.first().map_or(0.0, |e| e.exp()), branches)
    }

    /// Returns the coordinates of a series, without shifts; `branches` are in the order of
    /// increasing relaxation times.
    pub(super) fn coordinates(equilibrium_modulus: f64, branches: &[MaxwellBranch]) -> Vec<f64> {
        let mut at = Vec::with_capacity(1 + 2 * branches.len());
        if equilibrium_modulus > 0.0 {
            at.push(equilibrium_modulus.ln());
        }
        for branch in branches {
            at.push(branch.modulus.ln());
            at.push(branch.relaxation_time.ln());
        }
        at
    }
}

/// Returns the branches at the logarithms of their moduli and relaxation times.
pub(super) fn branches_at(at: &[f64]) -> Vec<MaxwellBranch> {
    let branches = at.as_chunks().0.iter();
    branches
        .map(|[modulus, time]| MaxwellBranch {
            modulus: modulus.exp(),
            relaxation_time: time.exp(),
        })
        .collect()
}

/// Returns z = ix/(1 + ix), the fraction of the modulus of a branch that is active at x = ωτ. It
/// never overflows.
pub(super) fn share(x: f64) -> Complex64 {
    if x < 1e150 {
        let d = (1.0 + x * x).recip();
        Complex64::new(x * x * d, x * d)
    } else {
        Complex64::new(1.0, x.recip())
    }
}

/// Returns the part of the modulus of a branch that is active at x = ωτ, and its derivative with
/// respect to ln x; for creep, the values of relaxation are returned.
pub(super) fn share_of(reading: Reading, x: f64) -> (Complex64, Complex64) {
    match reading {
        Reading::Oscillation => {
            let z = share(x);
            (z, z * (1.0 - z))
        }
        Reading::Relaxation { ramp } | Reading::Creep { ramp } => {
            let (left, slope) = left_of_branch(x.recip(), ramp);
            (left.into(), slope.into())
        }
    }
}

impl Model for Prony {
    fn kinds(&self) -> &[ParameterKind] {
        &self.kinds
    }

    fn is_in_order(&self, at: &[f64]) -> bool {
        let times = at.iter().skip(self.first() + 1).step_by(2);
        times.take(self.branches).is_sorted()
    }

    #[allow(
        clippy::indexing_slicing,
        reason = "`at`, and with it every row, has the coordinates that `kinds` names"
    )]
    fn evaluate(
        &self,
        at: &[f64],
        lines: Lines<'_>,
        modulus: &mut [Complex64],
        gradient: &mut [Complex64],
    ) -> bool {
        // within e^±230 = 1e±100 products neither overflow nor underflow
        if at.iter().any(|coordinate| coordinate.abs() > 230.0) {
            return false;
        }
        let first = self.first();
        let factors = first + 2 * self.branches;
        let shifts = factors + self.factors;
        let values: Vec<f64> = at.iter().map(|coordinate| coordinate.exp()).collect();
        let equilibrium = if self.solid { values[0] } else { 0.0 };
        if at.is_empty() {
            return false;
        }
        let mut scratch = vec![Complex64::ZERO; at.len()];
        let rows = gradient.chunks_exact_mut(at.len());
        for (line, (((omega, reading), modulus), row)) in
            lines.iter().zip(modulus).zip(rows).enumerate()
        {
            let shift = self.shift_of_line.get(line).copied().flatten();
            let shifted = shift.map_or(omega, |k| omega * values[shifts + k]);
            // sums the branches; `share` is a function of the relaxation time
            let series = |share: &dyn Fn(f64) -> (Complex64, Complex64), row: &mut [Complex64]| {
                let mut sum = Complex64::from(equilibrium);
                let mut slope = Complex64::ZERO;
                for entry in &mut row[..first] {
                    *entry = Complex64::from(equilibrium);
                }
                let branches = row[first..factors].as_chunks_mut().0;
                for ([by_modulus, by_time], [e, tau]) in branches
                    .iter_mut()
                    .zip(values[first..factors].as_chunks().0)
                {
                    let (z, by_log) = share(*tau);
                    *by_modulus = e * z;
                    *by_time = e * by_log;
                    sum += *by_modulus;
                    slope += *by_time;
                }
                row[factors..].fill(Complex64::ZERO);
                if let Some(k) = shift {
                    row[shifts + k] = slope;
                }
                sum
            };
            let mut sum = if let Reading::Creep { .. } = reading {
                let at_s = |s: Complex64, row: &mut [Complex64]| {
                    let share = |tau: f64| {
                        let x = s * tau;
                        let z = x / (1.0 + x);
                        (z, z / (1.0 + x))
                    };
                    Some(series(&share, row))
                };
                let Some(found) = respond((shifted, reading), row, &mut scratch, at_s) else {
                    return false;
                };
                found
            } else {
                series(&|tau| share_of(reading, shifted * tau), row)
            };
            if let Some(k) = self.factor_of_line.get(line).copied().flatten() {
                row[factors + k] = sum;
                for entry in row.iter_mut() {
                    *entry *= values[factors + k];
                }
                sum *= values[factors + k];
            }
            *modulus = sum;
        }
        true
    }
}
