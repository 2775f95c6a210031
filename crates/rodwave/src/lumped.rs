//! A chain of lumped masses and Maxwell elements: the second solver, used to generate and verify
//! responses but never for inversion.
//!
//! Velocities are at nodes at half time steps, stresses in the cells between them at whole steps
//! (leapfrog). The source term is the rate F(σ) itself, evaluated at mid-step. The chain therefore
//! shares neither the travelling waves nor the exact flows of the laws with
//! [`crate::characteristics`]. At Courant number 1 and F = 0 the two schemes would be equivalent;
//! the chain therefore runs well below Courant number 1. It is second order, slightly dispersive,
//! and rings at the grid scale after a jump.
//!
//! Theory: `docs/theory/direct-problem.md#the-independent-solver`.

use crate::band_limited::{VelocityHistory, check_times};
use crate::error::{
    RodwaveError, check_cells, check_positive, check_samples, check_steps, check_that,
};
use crate::inelastic::InelasticLaw;
use crate::interpolation::{cubic, cubic_at};
use crate::rod::InelasticRod;

/// Name of this solver in the provenance of virtual records.
pub const GENERATOR: &str = "rodwave::lumped";

/// Default Courant number c dt/dx of the chain.
pub const DEFAULT_COURANT_NUMBER: f64 = 0.8;

/// A rod as a chain; node 0 is the loaded face, the last node is free.
///
/// ```
/// use rodwave::InelasticRod;
/// use rodwave::band_limited::SampledHistory;
/// use rodwave::inelastic::Maxwell;
/// use rodwave::lumped::LumpedRod;
///
/// let rod = InelasticRod::new(0.4, 1100.0, 3.056e9, Maxwell::new(11.12e6)?)?;
/// let pulse: Vec<f64> = (0..60)
///     .map(|k| (-((f64::from(k) - 20.0) / 4.0_f64).powi(2)).exp())
///     .collect();
/// let history = SampledHistory::new(&pulse, 51_200.0)?;
/// let times = [0.3e-3, 0.6e-3, 0.7e-3];
/// let response = LumpedRod::new(&rod, 400, 0.5)?.free_end_velocity(&history, &times)?;
/// assert!(response[1] > 1.5); // the front, doubled at the free end
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LumpedRod<L> {
    law: L,
    modulus: f64,
    density: f64,
    dx: f64,
    dt: f64,
    velocity: Vec<f64>,
    stress: Vec<f64>,
    /// F at the last mid-step, the prediction for the next one
    inelastic_rate: Vec<f64>,
    /// Share of the branch of the law in the modulus, and the stress in it; `None` without a spring
    /// in parallel.
    branch: Option<(f64, Vec<f64>)>,
    dissipated: f64,
}

#[allow(
    clippy::indexing_slicing,
    reason = "`new` makes four cells or more, with a stress each and one velocity more; nothing changes their number"
)]
impl<L: InelasticLaw> LumpedRod<L> {
    /// Divides `rod` into `cells` cells; the time step is `courant_number` dx/c.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] for fewer than 4 cells, more than 2^27, or a Courant number
    /// outside ]0, 0.95].
    pub fn new(
        rod: &InelasticRod<L>,
        cells: usize,
        courant_number: f64,
    ) -> Result<Self, RodwaveError> {
        check_cells(cells, 4, "from 4 to 2^27")?;
        check_that(
            courant_number > 0.0 && courant_number <= 0.95,
            "Courant number",
            courant_number,
            "above 0 and at most 0.95",
        )?;
        let dx = check_positive("cell length [m]", rod.length() / cells as f64)?;
        let dt = check_positive("time step [s]", courant_number * dx / rod.wave_speed())?;
        check_positive("mass of a cell over its area [kg/m^2]", rod.density() * dx)?;
        Ok(Self {
            law: rod.law().clone(),
            modulus: rod.modulus(),
            density: rod.density(),
            dx,
            dt,
            velocity: vec![0.0; cells + 1],
            stress: vec![0.0; cells],
            inelastic_rate: vec![0.0; cells],
            branch: (rod.spring() > 0.0).then(|| (1.0 - rod.spring(), vec![0.0; cells])),
            dissipated: 0.0,
        })
    }

    /// Sets all nodes in motion with the same velocity [m/s].
    #[must_use]
    pub fn moving_at(mut self, velocity: f64) -> Self {
        self.velocity.fill(velocity);
        self
    }

    /// Time step \[s\].
    #[must_use]
    pub fn time_step(&self) -> f64 {
        self.dt
    }

    /// Mass per unit area of the half cell at an end [kg/m²].
    #[must_use]
    pub fn end_mass(&self) -> f64 {
        0.5 * self.density * self.dx
    }

    /// Velocities of the nodes [m/s] at the last half step.
    #[must_use]
    pub fn velocities(&self) -> &[f64] {
        &self.velocity
    }

    /// Velocity [m/s] at distance `x` \[m\] from node 0, by cubic interpolation between the nodes;
    /// NaN if `x` is NaN.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the nodes before the cast"
    )]
    pub fn velocity_at(&self, x: f64) -> f64 {
        let position = x / self.dx;
        if position.is_nan() {
            return f64::NAN;
        }
        let base = position
            .floor()
            .clamp(1.0, (self.velocity.len() - 3) as f64);
        let first = (base as usize).max(1) - 1;
        let around = std::array::from_fn(|k| self.velocity[first + k]);
        cubic(around, position - base).value
    }

    /// Momentum per unit area [kg/(m s)].
    #[must_use]
    pub fn momentum(&self) -> f64 {
        let last = self.velocity.len() - 1;
        let sum: f64 = self.velocity.iter().sum();
        self.density * self.dx * (sum - 0.5 * (self.velocity[0] + self.velocity[last]))
    }

    /// Kinetic plus elastic energy per unit area [J/m²], with velocities half a step before the
    /// stresses.
    #[must_use]
    pub fn stored_energy(&self) -> f64 {
        let last = self.velocity.len() - 1;
        let squares: f64 = self.velocity.iter().map(|v| v * v).sum();
        let ends = self.velocity[0].powi(2) + self.velocity[last].powi(2);
        let kinetic = 0.5 * self.density * self.dx * (squares - 0.5 * ends);
        let elastic: f64 = match &self.branch {
            None => self.stress.iter().map(|s| s * s).sum(),
            Some((share, branch)) => {
                let cells = self.stress.iter().zip(branch);
                let energies = cells.map(|(s, b)| (s - b).powi(2) / (1.0 - share) + b * b / share);
                energies.sum()
            }
        };
        kinetic + elastic * 0.5 * self.dx / self.modulus
    }

    /// Energy per unit area [J/m²] dissipated by the inelastic strain rate.
    #[must_use]
    pub fn dissipated_energy(&self) -> f64 {
        self.dissipated
    }

    /// Advances the velocities of all nodes except node 0 over one step; the last node is free.
    pub fn accelerate(&mut self) {
        let factor = self.dt / (self.density * self.dx);
        let last = self.velocity.len() - 1;
        for (v, pair) in self.velocity[1..last]
            .iter_mut()
            .zip(self.stress.windows(2))
        {
            *v += factor * (pair[1] - pair[0]);
        }
        self.velocity[last] -= 2.0 * factor * self.stress[last - 1];
    }

    /// Sets the velocity of node 0 [m/s].
    pub fn set_face_velocity(&mut self, velocity: f64) {
        self.velocity[0] = velocity;
    }

    /// Advances the velocity of node 0 over one step, as that of a free face.
    pub fn release_face(&mut self) {
        self.velocity[0] += self.dt / self.end_mass() * self.stress[0];
    }

    /// Adds to the velocity of node 0 the change due to a `pressure` \[Pa\] on the face, positive
    /// in compression, over one step.
    pub fn push_face(&mut self, pressure: f64) {
        self.velocity[0] += self.dt / self.end_mass() * pressure;
    }

    /// Advances the stresses to the next whole step.
    pub fn strain(&mut self) {
        let rate_of_strain = 1.0 / self.dx;
        let half = 0.5 * self.modulus * self.dt;
        let mut dissipated = 0.0;
        if let Some((share, branch)) = &mut self.branch {
            let cells = self.stress.iter_mut().zip(branch);
            let cells = cells.zip(&mut self.inelastic_rate);
            for (((s, b), f), pair) in cells.zip(self.velocity.windows(2)) {
                let total = (pair[1] - pair[0]) * rate_of_strain;
                let middle = *b + *share * half * (total - *f);
                *f = self.law.inelastic_strain_rate(middle);
                *b += 2.0 * *share * half * (total - *f);
                *s += 2.0 * half * (total - *share * *f);
                dissipated += middle * *f;
            }
            self.dissipated += dissipated * self.dx * self.dt;
            return;
        }
        for ((s, pair), f) in self
            .stress
            .iter_mut()
            .zip(self.velocity.windows(2))
            .zip(self.inelastic_rate.iter_mut())
        {
            let total = (pair[1] - pair[0]) * rate_of_strain;
            let middle = *s + half * (total - *f);
            *f = self.law.inelastic_strain_rate(middle);
            *s += 2.0 * half * (total - *f);
            dissipated += middle * *f;
        }
        self.dissipated += dissipated * self.dx * self.dt;
    }

    /// Computes the velocity of the last node [m/s] at `times` \[s\] when node 0 follows
    /// `excitation` from rest.
    ///
    /// # Errors
    /// [`RodwaveError::ExcitationTooShort`] if a time is after the end of the excitation,
    /// [`RodwaveError::NonPhysical`] if a time is not finite or is later than 1e9 time steps.
    pub fn free_end_velocity(
        mut self,
        excitation: &dyn VelocityHistory,
        times: &[f64],
    ) -> Result<Vec<f64>, RodwaveError> {
        let end = check_times(times, excitation)?;
        check_steps(end / self.dt)?;
        // velocities at (n + 1/2) dt
        let mut history = Vec::new();
        let mut time = 0.5 * self.dt;
        while time < end + 3.0 * self.dt {
            self.accelerate();
            self.set_face_velocity(excitation.at(time));
            self.strain();
            history.push(self.velocity[self.velocity.len() - 1]);
            time += self.dt;
        }
        let velocity: Vec<f64> = times
            .iter()
            .map(|t| cubic_at(&history, t / self.dt - 0.5).value)
            .collect();
        check_samples("velocity of the free end", &velocity)?;
        Ok(velocity)
    }
}
