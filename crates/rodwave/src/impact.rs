//! Impact of a striker on a rod, with a contact that opens and closes.
//!
//! Both bodies are chains of [`crate::lumped`]; only the struck rod is inelastic. The contact obeys
//! the unilateral condition 0 <= F, 0 <= gap, F gap = 0: at each step the force is the smallest
//! that prevents penetration. No contact stiffness is assumed. Closing a gap dissipates the
//! relative kinetic energy of two half cells, which vanishes as the grid is refined; energy is
//! never created.
//!
//! Theory: `docs/theory/direct-problem.md#striker`.

use std::f64::consts::PI;

use crate::error::{RodwaveError, check_finite, check_positive, check_steps, check_that};
use crate::inelastic::{Elastic, InelasticLaw};
use crate::lumped::{DEFAULT_COURANT_NUMBER, LumpedRod};
use crate::rod::InelasticRod;

/// A cylindrical elastic striker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Striker {
    /// Length \[m\].
    pub length: f64,
    /// Diameter \[m\].
    pub diameter: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Young's modulus \[Pa\].
    pub modulus: f64,
    /// Velocity before the impact [m/s], towards the rod.
    pub velocity: f64,
}

impl Striker {
    /// The projectile of paper D (Ödeen 1993, paper D, section 3): aluminium, 30 mm x 15.8 mm, 10
    /// m/s. The paper gives neither density nor modulus; those of the aluminium of paper E are
    /// used.
    pub const PAPER_D: Self = Self {
        length: 0.030,
        diameter: 0.0158,
        density: 2700.0,
        modulus: 69e9,
        velocity: 10.0,
    };

    /// Mass \[kg\].
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.density * self.area() * self.length
    }

    /// Cross-sectional area \[m²\].
    #[must_use]
    pub fn area(&self) -> f64 {
        0.25 * PI * self.diameter.powi(2)
    }

    /// Characteristic impedance A (Eρ)^½ [N s/m].
    #[must_use]
    pub fn impedance(&self) -> f64 {
        self.area() * (self.modulus * self.density).sqrt()
    }
}

/// A rod struck at one end; the other end is free (Ödeen 1993, paper D, Figure 1).
#[derive(Debug, Clone)]
pub struct ImpactTest<L> {
    /// The striker.
    pub striker: Striker,
    /// The rod, over its whole length.
    pub rod: InelasticRod<L>,
    /// Diameter of the rod \[m\].
    pub diameter: f64,
    /// Distance of the observed section from the free end \[m\].
    pub section_distance: f64,
}

/// Histories of an [`ImpactTest`]; time 0 is the first contact.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ImpactHistory {
    /// Time step \[s\].
    pub step: f64,
    /// Velocity [m/s] of the observed section at (k + 1/2) `step`.
    pub section_velocity: Vec<f64>,
    /// Velocity [m/s] of the free end at (k + 1/2) `step`.
    pub free_end_velocity: Vec<f64>,
    /// Contact force \[N\], positive in compression, at k `step`.
    pub contact_force: Vec<f64>,
    /// Balances of momentum and energy at the end.
    pub balance: ImpactBalance,
}

/// Momentum and energy at the end of an impact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ImpactBalance {
    /// Relative momentum error: momentum of both bodies over the momentum of the striker before the
    /// impact, minus one; zero to rounding.
    pub momentum_residual: f64,
    /// Energy of the striker before the impact \[J\].
    pub energy_before: f64,
    /// Kinetic and elastic energy of both bodies at the end \[J\].
    pub energy_after: f64,
    /// Energy dissipated by the rod's inelastic law \[J\].
    pub energy_dissipated: f64,
}

/// Ratio of the energies after and before the impact above which a chain is judged unstable. The
/// explicit steps of a chain create energy without bound if a material relaxes faster than the
/// step. The staggered grid alone makes the energy vary by some per cent.
const MOST_GROWTH: f64 = 2.0;

impl<L: InelasticLaw> ImpactTest<L> {
    /// Runs the test for `duration` \[s\] with cells of the rod no longer than `cell` \[m\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] for a quantity that is not finite and positive, for a section
    /// outside the rod, for more than 2^27 cells or 1e9 steps, and if the energy grows because the
    /// cells are too long for a material that relaxes within a time step.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts follow from checked positive lengths"
    )]
    #[allow(
        clippy::indexing_slicing,
        reason = "either chain has a node 0, and that of the rod one node more than `cells`"
    )]
    pub fn run(&self, cell: f64, duration: f64) -> Result<ImpactHistory, RodwaveError> {
        let striker = self.check()?;
        check_positive("cell length [m]", cell)?;
        check_positive("duration [s]", duration)?;
        // the chain rejects a count beyond the memory limit
        let cells = (self.rod.length() / cell).ceil().max(4.0) as usize;
        let mut struck = LumpedRod::new(&self.rod, cells, DEFAULT_COURANT_NUMBER)?;
        let step = struck.time_step();
        // the striker has the same time step; its cells are as short as the Courant number allows
        let distance_per_step = striker.wave_speed() * step;
        let striker_cells = (DEFAULT_COURANT_NUMBER * self.striker.length / distance_per_step)
            .floor()
            .max(4.0);
        let courant = distance_per_step * striker_cells / self.striker.length;
        // the striker is mirrored, so that its face is also node 0: on its own axis, a velocity
        // towards the rod is negative
        let mut striker = LumpedRod::new(&striker, striker_cells as usize, courant)?
            .moving_at(-self.striker.velocity);

        let striker_area = self.striker.area();
        let rod_area = 0.25 * PI * self.diameter.powi(2);
        let mobility =
            1.0 / (striker_area * striker.end_mass()) + 1.0 / (rod_area * struck.end_mass());
        check_positive("mobility of the faces [s/kg]", mobility)?;
        let energy = |striker: &LumpedRod<Elastic>, struck: &LumpedRod<L>| {
            striker_area * striker.stored_energy() + rod_area * struck.stored_energy()
        };
        let energy_before = energy(&striker, &struck);
        let momentum_before = -striker_area * striker.momentum();

        let section = self.rod.length() - self.section_distance;
        let steps = check_steps((duration / step).ceil())?;
        let mut section_velocity = Vec::with_capacity(steps);
        let mut free_end_velocity = Vec::with_capacity(steps);
        let mut contact_force = Vec::with_capacity(steps);
        let mut gap = 0.0_f64;
        for _ in 0..steps {
            striker.accelerate();
            struck.accelerate();
            striker.release_face();
            struck.release_face();
            // relative velocity of separation, and gap, if the force were zero
            let separation = struck.velocities()[0] + striker.velocities()[0];
            let free_gap = gap + step * separation;
            let force = if free_gap >= 0.0 {
                gap = free_gap;
                0.0
            } else {
                gap = 0.0;
                -free_gap / (step * step * mobility)
            };
            striker.push_face(force / striker_area);
            struck.push_face(force / rod_area);
            striker.strain();
            struck.strain();
            contact_force.push(force);
            section_velocity.push(struck.velocity_at(section));
            free_end_velocity.push(struck.velocities()[cells]);
        }
        let momentum = rod_area * struck.momentum() - striker_area * striker.momentum();
        let energy_after = energy(&striker, &struck);
        let growth = energy_after / energy_before;
        // an overflow anywhere in a body soon shows in its energy
        check_that(
            growth <= MOST_GROWTH,
            "energy after the impact over the energy before it",
            growth,
            "at most 1; use shorter cells for a material that relaxes within a time step",
        )?;
        let momentum_residual = check_finite(
            "relative change of momentum",
            momentum / momentum_before - 1.0,
        )?;
        Ok(ImpactHistory {
            step,
            section_velocity,
            free_end_velocity,
            contact_force,
            balance: ImpactBalance {
                momentum_residual,
                energy_before,
                energy_after,
                energy_dissipated: rod_area * struck.dissipated_energy(),
            },
        })
    }

    /// Checks every quantity and returns the striker as a rod.
    fn check(&self) -> Result<InelasticRod<Elastic>, RodwaveError> {
        check_positive("striker diameter [m]", self.striker.diameter)?;
        check_positive("striker velocity [m/s]", self.striker.velocity)?;
        check_positive("rod diameter [m]", self.diameter)?;
        check_finite("section distance [m]", self.section_distance)?;
        check_that(
            self.section_distance > 0.0 && self.section_distance <= self.rod.length(),
            "distance of the section from the free end [m]",
            self.section_distance,
            "above 0 and at most the length of the rod",
        )?;
        InelasticRod::new(
            self.striker.length,
            self.striker.density,
            self.striker.modulus,
            Elastic,
        )
    }
}
