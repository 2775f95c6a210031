//! Damped least squares (Levenberg-Marquardt) for laws of up to some tens of parameters.
//!
//! Residuals are whitened, and coordinates are logarithms or of order 1. A step solves the normal
//! equations (JᵀJ + μD) δ = -Jᵀr. With whitened residuals these equations are scaled well enough
//! for the iteration, and they are cheap if there are many more lines than parameters. The
//! evaluation of the minimum uses the singular values of J itself ([`super::information`]).

use num_complex::Complex64;

use super::count;
use super::data::ModulusData;
use super::model::Model;
use super::symmetric::{add_products, factorise, solve};
pub use crate::recovery::fit::Ending;

/// Accuracy to which a minimum is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Effort {
    /// Accuracy at the level of rounding, for a result.
    Full,
    /// Accuracy of 1e-2 in χ², for a comparison of values of χ² that differ by more.
    Comparison,
    /// Accuracy of `Comparison` with fewer iterations. A search that needs more iterations is in a
    /// flat valley.
    Search,
    /// Accuracy of `Comparison` if χ² falls to this value. The iteration ends as soon as χ² is not
    /// predicted to fall to this value in the remaining iterations.
    Below(f64),
}

impl Effort {
    fn most_iterations(self) -> usize {
        match self {
            Self::Full => 300,
            Self::Comparison | Self::Below(_) => 60,
            Self::Search => 25,
        }
    }

    /// Returns the negligible reduction of χ², as a fraction of the effect of one standard
    /// deviation.
    fn negligible(self) -> f64 {
        match self {
            Self::Full => 1e-9,
            Self::Comparison | Self::Search | Self::Below(_) => 1e-2,
        }
    }

    /// Returns the negligible reduction of χ² for a long step.
    fn idle(self) -> f64 {
        match self {
            Self::Full => IDLE,
            Self::Comparison | Self::Search | Self::Below(_) => 3e-2,
        }
    }
}

/// Maximum change of a coordinate in one iteration: a change of a logarithm by 1.5 is a factor of
/// 4.5.
const LONGEST_STEP: f64 = 1.5;
/// Factor by which a component may exceed its limit, in order to follow another component that is
/// held at its limit.
const MOST_EXCESS: f64 = 1.3;
/// Damping in units of χ² per squared unit of an undetermined coordinate.
const FLOOR: f64 = 1e-3;
/// Minimum length of a step that is omitted if its predicted reduction of χ² is at most [`IDLE`].
const IDLE_STEP: f64 = 0.1;
/// Negligible reduction of χ² as a fraction of the effect of one standard deviation. A parameter is
/// then within 0.06 standard errors of the minimum.
const IDLE: f64 = 3e-3;
const LEAST_DAMPING: f64 = 1e-8;

/// End point of an iteration.
#[derive(Debug, Clone)]
pub(super) struct Minimum {
    pub(super) at: Vec<f64>,
    pub(super) chi_squared: f64,
    pub(super) linearised: Linearised,
    pub(super) ending: Ending,
}

/// Whitened residuals (law minus measured; two per line, the second 0 for data over time) and their
/// derivatives by rows.
#[derive(Debug, Clone)]
pub(super) struct Linearised {
    pub(super) residual: Vec<f64>,
    pub(super) jacobian: Vec<f64>,
    modulus: Vec<Complex64>,
    gradient: Vec<Complex64>,
}

impl Linearised {
    pub(super) fn new(lines: usize, parameters: usize) -> Self {
        Self {
            residual: vec![0.0; 2 * lines],
            jacobian: vec![0.0; 2 * lines * parameters],
            modulus: vec![Complex64::ZERO; lines],
            gradient: vec![Complex64::ZERO; lines * parameters],
        }
    }

    /// Returns χ² at `at`; `None` if there is no law at `at`, or if a value is not finite.
    #[allow(
        clippy::indexing_slicing,
        reason = "the lists were made for all lines of the data, with as many parameters as `at` has"
    )]
    pub(super) fn evaluate<M: Model + ?Sized>(
        &mut self,
        model: &M,
        data: &ModulusData,
        at: &[f64],
    ) -> Option<f64> {
        if !model.evaluate(at, data.lines(), &mut self.modulus, &mut self.gradient) {
            return None;
        }
        let parameters = at.len();
        let mut chi_squared = 0.0;
        for (line, whitening) in data.whitening.iter().enumerate() {
            let residual = whitening.apply(self.modulus[line] - data.modulus[line]);
            chi_squared += residual[0] * residual[0] + residual[1] * residual[1];
            self.residual[2 * line..2 * line + 2].copy_from_slice(&residual);
            let row = &self.gradient[line * parameters..(line + 1) * parameters];
            let rows = &mut self.jacobian[2 * line * parameters..2 * (line + 1) * parameters];
            let (storage, loss) = rows.split_at_mut(parameters);
            for ((storage, loss), derivative) in storage.iter_mut().zip(loss).zip(row) {
                [*storage, *loss] = whitening.apply(*derivative);
            }
        }
        chi_squared.is_finite().then_some(chi_squared)
    }
}

/// Minimises χ² from `start`; the coordinate `held` keeps its value. Returns `None` if there is no
/// law at the start.
pub(super) fn minimise<M: Model + ?Sized>(
    model: &M,
    data: &ModulusData,
    start: &[f64],
    held: Option<usize>,
    effort: Effort,
) -> Option<Minimum> {
    let parameters = start.len();
    let mut here = Linearised::new(data.len(), parameters);
    let mut there = here.clone();
    let mut at = start.to_vec();
    let mut trial = at.clone();
    let mut chi_squared = here.evaluate(model, data, &at)?;
    let mut normal = Normal::new(parameters);
    normal.form(&here, held);
    let freedom = count(data.values().saturating_sub(parameters).max(1));
    let mut damping: f64 = 1e-3;
    let mut growth = 2.0;
    let mut rejected = 0;
    let mut ending = Ending::OutOfIterations;
    for left in (0..effort.most_iterations()).rev() {
        // a fraction of the effect of one standard deviation, but at least the rounding error of
        // the sum of squares
        let scale = (chi_squared / freedom).min(1.0);
        let negligible = (effort.negligible() * scale).max(1e-13 * chi_squared);
        let Some(promised) = normal.step(damping) else {
            damping = (damping * 10.0).max(LEAST_DAMPING);
            continue;
        };
        let longest = normal.step.iter().fold(0.0, |l: f64, d| l.max(d.abs()));
        // a long step with a negligible reduction means a flat valley, for example of a relaxation
        // that moves out of the band
        let idle = longest >= IDLE_STEP && promised <= effort.idle() * scale;
        if promised <= negligible || longest < 1e-11 || idle {
            if rejected > 0 {
                ending = Ending::NoDescent;
                break;
            }
            if damping <= 1e-2 {
                ending = Ending::Converged;
                break;
            }
            damping = 1e-3;
            continue;
        }
        let is_free = rejected == 0 && damping <= 1e-2 && longest < LONGEST_STEP;
        if let Effort::Below(least) = effort
            && is_free
            && promised * count(left) < chi_squared - least
        {
            break;
        }
        for ((trial, at), step) in trial.iter_mut().zip(&at).zip(&normal.step) {
            *trial = at + step;
        }
        match there.evaluate(model, data, &trial) {
            Some(reached) if reached < chi_squared => {
                let gain = (chi_squared - reached) / promised;
                std::mem::swap(&mut here, &mut there);
                std::mem::swap(&mut at, &mut trial);
                chi_squared = reached;
                normal.form(&here, held);
                damping =
                    (damping * (1.0 - (2.0 * gain - 1.0).powi(3)).max(0.1)).max(LEAST_DAMPING);
                growth = 2.0;
                rejected = 0;
            }
            _ => {
                rejected += 1;
                damping *= growth;
                growth *= 2.0;
                if rejected > 30 {
                    ending = Ending::NoDescent;
                    break;
                }
            }
        }
    }
    Some(Minimum {
        at,
        chi_squared,
        linearised: here,
        ending,
    })
}

/// Normal equations of one linearisation.
struct Normal {
    parameters: usize,
    /// JᵀJ by rows; the elements below the diagonal are not used.
    matrix: Vec<f64>,
    /// Jᵀr.
    gradient: Vec<f64>,
    factor: Vec<f64>,
    target: Vec<f64>,
    step: Vec<f64>,
    /// Marks of the components of the step that are at their limit.
    held: Vec<bool>,
}

#[allow(
    clippy::indexing_slicing,
    reason = "the matrices have p rows of p elements, the lists have p elements, and every index is below p"
)]
impl Normal {
    fn new(parameters: usize) -> Self {
        Self {
            parameters,
            matrix: vec![0.0; parameters * parameters],
            gradient: vec![0.0; parameters],
            factor: vec![0.0; parameters * parameters],
            target: vec![0.0; parameters],
            step: vec![0.0; parameters],
            held: vec![false; parameters],
        }
    }

    fn form(&mut self, linearised: &Linearised, held: Option<usize>) {
        let p = self.parameters;
        self.matrix.fill(0.0);
        self.gradient.fill(0.0);
        for (row, residual) in linearised
            .jacobian
            .chunks_exact(p.max(1))
            .zip(&linearised.residual)
        {
            for (sum, entry) in self.gradient.iter_mut().zip(row) {
                *sum += entry * residual;
            }
        }
        add_products(&mut self.matrix, &linearised.jacobian, p);
        if let Some(held) = held {
            self.gradient[held] = 0.0;
            for i in 0..p {
                self.matrix[held.min(i) * p + held.max(i)] = f64::from(u8::from(i == held));
            }
        }
    }

    /// Finds the step for `damping` and returns the reduction of χ² predicted by the linear model;
    /// `None` if rounding makes the matrix indefinite.
    ///
    /// A component that would be too long is held at its limit, and all other components are
    /// determined again. If it were only truncated, the other components would move away from the
    /// bottom of the valley.
    fn step(&mut self, damping: f64) -> Option<f64> {
        self.held.fill(false);
        loop {
            self.solve(damping)?;
            let longest = (0..self.parameters)
                .filter(|i| !self.held[*i])
                .max_by(|a, b| self.step[*a].abs().total_cmp(&self.step[*b].abs()))
                .filter(|i| self.step[*i].abs() > MOST_EXCESS * LONGEST_STEP);
            let Some(longest) = longest else {
                break;
            };
            self.held[longest] = true;
            self.step[longest] = LONGEST_STEP.copysign(self.step[longest]);
        }
        let mut promised = 0.0;
        for i in 0..self.parameters {
            let own = 0.5 * self.entry(i, i) * self.step[i];
            let others = (i + 1..self.parameters).map(|j| self.entry(i, j) * self.step[j]);
            let half: f64 = own + others.sum::<f64>();
            promised -= 2.0 * self.step[i] * (self.gradient[i] + half);
        }
        Some(promised)
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.matrix[i.min(j) * self.parameters + i.max(j)]
    }

    /// Determines the components of the step that are not held.
    fn solve(&mut self, damping: f64) -> Option<()> {
        let p = self.parameters;
        for j in 0..p {
            let own = self.matrix[j * p + j];
            self.factor[j * p + j] = own + damping * (own + FLOOR);
            for i in j + 1..p {
                self.factor[j * p + i] = if self.held[i] || self.held[j] {
                    0.0
                } else {
                    self.matrix[j * p + i]
                };
            }
        }
        if !factorise(&mut self.factor, p, 0.0) {
            return None;
        }
        for i in 0..p {
            self.target[i] = if self.held[i] {
                0.0
            } else {
                let held = (0..p).filter(|j| self.held[*j]);
                -self.gradient[i] - held.map(|j| self.entry(i, j) * self.step[j]).sum::<f64>()
            };
        }
        solve(&self.factor, &mut self.target);
        for ((step, target), held) in self.step.iter_mut().zip(&self.target).zip(&self.held) {
            if !held {
                *step = *target;
            }
        }
        self.step.iter().all(|step| step.is_finite()).then_some(())
    }
}
