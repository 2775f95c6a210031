//! Lateral inertia of a rod of finite diameter.
//!
//! A rod that is compressed widens by Poisson's ratio ν, and the inertia of this motion slows down
//! short waves. In the theory of Love (see [`rodwave::slenderness`]), with the polar radius of
//! gyration k_p of the section,
//!
//! ```text
//! γ² = ρs²/(E(s) + ρr²s²) ,    r = νk_p ,    r² = ν²D²/8 for a round rod ,
//! ```
//!
//! and a rod with a free end has the velocity v̂_r = v̂_e / cosh(γL) there, as without lateral
//! inertia. A [linear](crate::linear) rod is solved with this γ.
//!
//! # Nonlinear laws
//! A nonlinear rod is marched with lateral inertia
//! ([`BranchedProblem::free_end_velocity_with_lateral_inertia`]); the derivatives of its response
//! are differences of such responses. A linear rod with a law of the time domain is marched without
//! lateral inertia, and its response is multiplied by
//!
//! ```text
//! cosh(γ₀L)/cosh(γL) ,    γ₀² = ρs²/E(s)
//! ```
//!
//! on a line Re s = a of the Laplace plane. The derivatives of the response of a nonlinear rod with
//! respect to samples of its excitation are multiplied by the same factor, with the secant modulus
//! in place of E: the modulus of linear branches that relax at the rate F(σ)/σ of the law, at a
//! stress σ of 0.7 ρc max|v_e|, the stress ρc max|v_e| being that behind a front of the largest
//! velocity. These derivatives are used only for the covariance of the noise and for small changes
//! of the excitation.
//!
//! [`BranchedProblem::free_end_velocity_with_lateral_inertia`]:
//!     rodwave::characteristics::BranchedProblem::free_end_velocity_with_lateral_inertia
//!
//! # Validity
//! Love's theory is valid for wavelengths above about three diameters. The sensitivities to length
//! and density of the specimen are those of a thin rod.
//!
//! Theory: `docs/theory/identification.md#lateral-inertia`.

use num_complex::Complex64;
use rodwave::inelastic::InelasticLaw;

use crate::laplace_line::{LaplaceLine, propagation};
use crate::model::{DrivenRod, LinearisedResponse};
use crate::parallel::map_in_order;

/// Change of a parameter to either side, for numerical derivatives.
const DIFFERENCE: f64 = 1e-4;

/// Stress at which a law is replaced by its secant, relative to the stress behind a front of the
/// largest velocity: the stress falls along the rod.
const OF_FRONT: f64 = 0.7;

/// Modulus of the linear material that relaxes as fast as a nonlinear rod behind the front of a
/// wave.
pub(crate) struct SecantModulus {
    /// E \[Pa\].
    modulus: f64,
    /// Stress \[Pa\] at which the law is replaced by its secant.
    stress: f64,
    /// Share of the modulus and rate [1/s] of each branch.
    branches: Vec<(f64, f64)>,
}

impl SecantModulus {
    /// Creates a material of modulus `modulus` \[Pa\] without branches, for the stress behind the
    /// front in `rod`.
    pub(crate) fn behind_front(rod: &DrivenRod<'_>, modulus: f64) -> Self {
        let fastest = rod.samples.iter().fold(0.0_f64, |top, v| top.max(v.abs()));
        Self {
            modulus,
            stress: OF_FRONT * (rod.density * modulus).sqrt() * fastest,
            branches: Vec::new(),
        }
    }

    /// Adds a branch with this `share` of the modulus that relaxes at a constant `rate` [1/s]; a
    /// spring has the rate 0.
    pub(crate) fn with_branch(mut self, share: f64, rate: f64) -> Self {
        self.branches.push((share, rate));
        self
    }

    /// Adds a branch with this `share` of the modulus and the dashpot of `law`.
    pub(crate) fn with_law(self, share: f64, law: &impl InelasticLaw) -> Self {
        let rate = if self.stress > 0.0 {
            self.modulus * law.inelastic_strain_rate(share * self.stress) / self.stress
        } else {
            0.0
        };
        self.with_branch(share, rate)
    }

    /// E_s(s)/E.
    fn shape(&self, s: Complex64) -> Complex64 {
        let branches = self.branches.iter();
        branches.map(|(share, rate)| share * s / (s + rate)).sum()
    }

    /// cosh(γ₀L)/cosh(γL) at each of `arguments`.
    fn factors(&self, rod: &DrivenRod<'_>, arguments: &[Complex64]) -> Vec<Complex64> {
        let square_slowness = rod.density / self.modulus;
        let transit = square_slowness.sqrt() * rod.length;
        let inertia = rod.lateral_inertia * square_slowness;
        let of = |s: &Complex64| {
            let shape = self.shape(*s);
            let thin = propagation(transit, *s, shape);
            let thick = propagation(transit, *s, shape + inertia * s * s);
            let echoes = |gamma_length: Complex64| 1.0 + (-2.0 * gamma_length).exp();
            (thin - thick).exp() * echoes(thin) / echoes(thick)
        };
        arguments.iter().map(of).collect()
    }
}

/// Adds lateral inertia to histories of the free end of a rod at θ; `secant` is the secant modulus
/// at some θ. `None` unless the times are equally spaced and the histories remain finite.
pub(crate) fn of_columns(
    rod: &DrivenRod<'_>,
    parameters: &[f64],
    secant: impl Fn(&[f64]) -> Option<SecantModulus>,
    columns: Vec<Vec<f64>>,
) -> Option<Vec<Vec<f64>>> {
    if rod.lateral_inertia <= 0.0 {
        return Some(columns);
    }
    let mut line = line_of(rod)?;
    let arguments: Vec<Complex64> = line.arguments().collect();
    let factors = secant(parameters)?.factors(rod, &arguments);
    let columns = columns.iter();
    columns
        .map(|column| {
            let lines = transformed(&mut line, column);
            multiplied(&mut line, &lines, &factors, column.len())
        })
        .collect()
}

/// Response at `parameters` with its derivatives, by central differences of `at`, the response as a
/// function of θ.
pub(crate) fn by_differences(
    parameters: &[f64],
    at: impl Fn(&[f64]) -> Option<Vec<f64>> + Sync,
) -> Option<LinearisedResponse> {
    let moved = (0..parameters.len()).flat_map(|index| [(index, DIFFERENCE), (index, -DIFFERENCE)]);
    let changes: Vec<(usize, f64)> = std::iter::once((0, 0.0)).chain(moved).collect();
    let responses = map_in_order(&changes, |(index, change)| {
        let mut moved = parameters.to_vec();
        *moved.get_mut(*index)? += change;
        at(&moved)
    });
    let mut responses = responses.into_iter();
    let velocity = responses.next()??;
    let mut by_parameter = Vec::with_capacity(parameters.len());
    while let Some(more) = responses.next() {
        let (more, less) = (more?, responses.next()??);
        let pairs = more.iter().zip(&less);
        by_parameter.push(pairs.map(|(m, l)| (m - l) / (2.0 * DIFFERENCE)).collect());
    }
    Some(LinearisedResponse {
        velocity,
        by_parameter,
    })
}

/// Adds lateral inertia to the response of a linear rod with its derivatives, as [`of_columns`]
/// does.
pub(crate) fn of_linearised(
    rod: &DrivenRod<'_>,
    parameters: &[f64],
    secant: impl Fn(&[f64]) -> Option<SecantModulus>,
    thin: LinearisedResponse,
) -> Option<LinearisedResponse> {
    if rod.lateral_inertia <= 0.0 {
        return Some(thin);
    }
    let mut line = line_of(rod)?;
    let arguments: Vec<Complex64> = line.arguments().collect();
    let factors = |parameters: &[f64]| Some(secant(parameters)?.factors(rod, &arguments));
    let points = thin.velocity.len();
    let of_thin = transformed(&mut line, &thin.velocity);
    let own = factors(parameters)?;
    let by_parameter = thin.by_parameter.iter().enumerate();
    let by_parameter = by_parameter
        .map(|(index, column)| {
            let mut moved = parameters.to_vec();
            let mut at = |change: f64| {
                *moved.get_mut(index)? = parameters.get(index)? + change;
                factors(&moved)
            };
            let (more, less) = (at(DIFFERENCE)?, at(-DIFFERENCE)?);
            let mut lines = transformed(&mut line, column);
            let changes = more.iter().zip(&less).zip(&of_thin);
            for ((value, factor), ((more, less), thin)) in lines.iter_mut().zip(&own).zip(changes) {
                *value = *value * factor + thin * (more - less) / (2.0 * DIFFERENCE);
            }
            read(&mut line, &lines, points)
        })
        .collect::<Option<_>>()?;
    Some(LinearisedResponse {
        velocity: multiplied(&mut line, &of_thin, &own, points)?,
        by_parameter,
    })
}

/// The Laplace line of histories at the times of `rod`; `None` unless the times are equally spaced,
/// except for leading times of 0.
fn line_of(rod: &DrivenRod<'_>) -> Option<LaplaceLine> {
    let at_rest = rod.times.iter().take_while(|t| **t == 0.0).count();
    let moving = rod.times.get(at_rest..)?;
    let spacing = match moving {
        [first, .., last] => (last - first) / (moving.len() - 1) as f64,
        _ => 1.0 / rod.sampling_rate_hz,
    };
    let first = moving.first().copied().unwrap_or(0.0);
    let mut each = moving.iter().enumerate();
    let is_uniform = each.all(|(k, t)| (t - first - k as f64 * spacing).abs() < 1e-6 * spacing);
    is_uniform.then(|| LaplaceLine::new(rod.times.len(), 1.0 / spacing))
}

fn transformed(line: &mut LaplaceLine, history: &[f64]) -> Vec<Complex64> {
    line.transform(history.len(), |n| history.get(n).copied().unwrap_or(0.0))
}

fn multiplied(
    line: &mut LaplaceLine,
    lines: &[Complex64],
    factors: &[Complex64],
    points: usize,
) -> Option<Vec<f64>> {
    let lines = lines.iter().zip(factors);
    let lines: Vec<Complex64> = lines.map(|(value, factor)| value * factor).collect();
    read(line, &lines, points)
}

/// The history of `lines`; `None` unless it is finite.
fn read(line: &mut LaplaceLine, lines: &[Complex64], points: usize) -> Option<Vec<f64>> {
    let history = line.history(lines, points);
    history.iter().all(|v| v.is_finite()).then_some(history)
}
