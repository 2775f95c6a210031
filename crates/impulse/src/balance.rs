//! Balance of momentum and energy of an impact.
//!
//! Theory: `docs/theory/contact.md#balance`.

use std::f64::consts::TAU;

/// Fewest steps without force at the end of a history from which the final motion of a body is
/// found.
const FEWEST_STEPS_AFTER: usize = 64;

/// Momentum and energy of an impact, in the frame in which the second body is at rest before the
/// impact.
///
/// All values follow from the force and the mobilities. The energy of a body is divided into the
/// energy of the motion of its centre of mass and the rest: a mobility does not distinguish
/// vibration from heat.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Balance {
    /// $`J = \int F\,dt`$ \[N s\], the momentum transferred from the first body to the second.
    pub impulse: f64,
    /// Momentum of the first body before the impact, $`M_1V`$ \[N s\]; `None` if it is not free.
    pub momentum_before: Option<f64>,
    /// Velocities of the centres of mass after the impact, $`V - J/M_1`$ and $`J/M_2`$ \[m/s\];
    /// `None` for bodies that are not free.
    pub velocity_after: [Option<f64>; 2],
    /// Coefficient of restitution $`J/(M_{\mathrm{eff}}V) - 1`$, the relative velocity after the
    /// impact divided by that before: $`1/M_{\mathrm{eff}}`$ is $`\sum 1/M_i`$ over the free
    /// bodies. `None` if no body is free.
    pub restitution: Option<f64>,
    /// Energy of the first body before the impact, $`\tfrac12M_1V^2`$ \[J\]; `None` if it is not
    /// free.
    pub energy_before: Option<f64>,
    /// Energy of the motion of the centres of mass after the impact \[J\].
    pub translation_after: [Option<f64>; 2],
    /// Remaining energy of the bodies \[J\]: vibration, outgoing waves, and heat. Not negative for
    /// passive bodies.
    pub inner: [f64; 2],
    /// Energy dissipated in the contact \[J\]: hysteresis, closing of gaps.
    pub dissipated_in_contact: f64,
    /// Energy stored in the contact at the end, which may be released \[J\].
    pub stored_in_contact: f64,
    /// $`(W_1 - W_2 - W_c)/(VJ)`$: the work done by the first body less the work done on the second
    /// body, both from the velocities of the faces, and less the work done on the contact, from its
    /// law.
    pub energy_residual: f64,
    /// $`(M_1\bar v_1 + J - M_1V)/(M_1V)`$ with the velocity of the face of the first body after
    /// the last contact (mean under a Hann window): a momentum balance independent of
    /// $`v_1 = V - J/M_1`$. `None` without time after the contact or if the first body is not free.
    /// The residual is small only if the body rings through several periods in that time, or has
    /// come to rest.
    pub momentum_residual: Option<f64>,
    /// Coefficient of restitution from the velocities of the faces after the last contact,
    /// $`(\bar v_2 - \bar v_1)/V`$.
    pub observed_restitution: Option<f64>,
}

impl Balance {
    /// Returns true if no number has overflowed and the reference work has not underflowed.
    pub(crate) fn is_within_range(&self) -> bool {
        let optional = [
            self.momentum_before,
            self.restitution,
            self.energy_before,
            self.momentum_residual,
            self.observed_restitution,
        ];
        let numbers = [
            self.impulse,
            self.dissipated_in_contact,
            self.stored_in_contact,
            self.energy_residual,
        ];
        optional
            .into_iter()
            .chain(self.velocity_after)
            .chain(self.translation_after)
            .flatten()
            .chain(numbers)
            .chain(self.inner)
            .all(f64::is_finite)
    }
}

/// Momentum and energy of an impact over time, at the ends of the steps, from
/// [`Prediction::energies`](crate::Prediction::energies).
///
/// In the frame used, the second body is at rest before the impact. If the first body is free, all
/// energies at any time add up to its energy before the impact.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct EnergyHistory {
    /// Momentum \[N s\] transferred from the first body to the second.
    pub impulse: Vec<f64>,
    /// Energies of the motion of the centres of mass \[J\]; `None` for bodies that are not free.
    pub translation: [Option<Vec<f64>>; 2],
    /// Remaining energies of the bodies \[J\]: vibration, outgoing waves, and heat.
    pub inner: [Vec<f64>; 2],
    /// Energy in the contact \[J\], stored and dissipated.
    pub in_contact: Vec<f64>,
}

impl EnergyHistory {
    /// Creates the history of bodies with these `masses` that meet at `velocity`.
    pub(crate) fn of(
        (velocity, masses): (f64, [Option<f64>; 2]),
        time_step: f64,
        force: &[f64],
        faces: [&[f64]; 2],
    ) -> Self {
        let running = |powers: &mut dyn Iterator<Item = f64>| -> Vec<f64> {
            let sums = powers.scan(0.0, |sum, power| {
                *sum += time_step * power;
                Some(*sum)
            });
            sums.collect()
        };
        let impulse = running(&mut force.iter().copied());
        let [given, taken] =
            faces.map(|face| running(&mut force.iter().zip(face).map(|(f, v)| f * v)));
        let mut found = Self {
            impulse,
            translation: masses.map(|mass| mass.map(|_| Vec::new())),
            inner: [Vec::new(), Vec::new()],
            in_contact: Vec::new(),
        };
        for ((impulse, given), taken) in found.impulse.iter().zip(given).zip(taken) {
            let moved = translation(masses, velocities_after(velocity, masses, *impulse));
            for (all, moved) in found.translation.iter_mut().zip(moved) {
                if let Some(all) = all {
                    all.extend(moved);
                }
            }
            let inner = inner_energies(velocity, masses, *impulse, [given, taken]);
            for (all, inner) in found.inner.iter_mut().zip(inner) {
                all.push(inner);
            }
            found.in_contact.push(given - taken);
        }
        found
    }
}

/// Velocities of the centres of mass of free bodies after the `impulse` J: $`V - J/M_1`$ and
/// $`J/M_2`$.
fn velocities_after(
    velocity: f64,
    [first, second]: [Option<f64>; 2],
    impulse: f64,
) -> [Option<f64>; 2] {
    [
        first.map(|mass| velocity - impulse / mass),
        second.map(|mass| impulse / mass),
    ]
}

/// Energies of the motion of the centres of mass.
fn translation(masses: [Option<f64>; 2], velocities: [Option<f64>; 2]) -> [Option<f64>; 2] {
    let kinetic = |mass: Option<f64>, velocity: Option<f64>| Some(0.5 * mass? * velocity?.powi(2));
    [
        kinetic(masses[0], velocities[0]),
        kinetic(masses[1], velocities[1]),
    ]
}

/// Returns the energies of the bodies without the energy of the motion of their centres of mass.
/// The `impulse` J takes $`VJ - J^2/(2M_1)`$ of that energy from the first body and gives
/// $`J^2/(2M_2)`$ of it to the second; a term with a mass is absent for a body that is not free.
/// The work `given` by the first face equals the work `taken` by the second face plus the work on
/// the contact.
fn inner_energies(
    velocity: f64,
    masses: [Option<f64>; 2],
    impulse: f64,
    [given, taken]: [f64; 2],
) -> [f64; 2] {
    let square = |mass: Option<f64>| mass.map_or(0.0, |mass| 0.5 * impulse * impulse / mass);
    [
        velocity * impulse - square(masses[0]) - given,
        taken - square(masses[1]),
    ]
}

/// Inputs of a balance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Account<'a> {
    pub(crate) time_step: f64,
    pub(crate) velocity: f64,
    pub(crate) masses: [Option<f64>; 2],
    pub(crate) force: &'a [f64],
    /// Velocities of the faces along V.
    pub(crate) faces: [&'a [f64]; 2],
    pub(crate) contact_work: f64,
    pub(crate) stored_in_contact: f64,
}

impl Account<'_> {
    pub(crate) fn balance(&self) -> Balance {
        let velocity = self.velocity;
        let [first_mass, _] = self.masses;
        let impulse = self.time_step * self.force.iter().sum::<f64>();
        let work = |face: &[f64]| {
            let power = self
                .force
                .iter()
                .zip(face)
                .map(|(force, face)| force * face);
            self.time_step * power.sum::<f64>()
        };
        let [given, taken] = self.faces.map(work);
        let velocity_after = velocities_after(velocity, self.masses, impulse);
        let translation_after = translation(self.masses, velocity_after);
        let inner = inner_energies(velocity, self.masses, impulse, [given, taken]);
        let inverse_mass: f64 = self.masses.iter().flatten().map(|mass| 1.0 / mass).sum();
        let restitution = (inverse_mass > 0.0).then(|| impulse * inverse_mass / velocity - 1.0);
        let after = self.after();
        let observed = |face: &[f64]| after.and_then(|from| hann_mean(face.get(from..)?));
        let [first_seen, second_seen] = self.faces.map(observed);
        let momentum_before = first_mass.map(|mass| mass * velocity);
        Balance {
            impulse,
            momentum_before,
            velocity_after,
            restitution,
            energy_before: first_mass.map(|mass| 0.5 * mass * velocity * velocity),
            translation_after,
            inner,
            dissipated_in_contact: self.contact_work - self.stored_in_contact,
            stored_in_contact: self.stored_in_contact,
            energy_residual: if impulse > 0.0 {
                (given - taken - self.contact_work) / (velocity * impulse)
            } else {
                0.0
            },
            momentum_residual: momentum_before
                .zip(first_mass)
                .zip(first_seen)
                .map(|((before, mass), seen)| (mass * seen + impulse - before) / before),
            observed_restitution: first_seen
                .zip(second_seen)
                .map(|(first, second)| (second - first) / velocity),
        }
    }

    /// Returns the first step after the last force, if enough steps follow.
    fn after(&self) -> Option<usize> {
        let last = self.force.iter().rposition(|&force| force > 0.0)?;
        (self.force.len() - last > FEWEST_STEPS_AFTER).then_some(last + 1)
    }
}

/// Mean under a Hann window.
fn hann_mean(values: &[f64]) -> Option<f64> {
    let count = values.len() as f64;
    let (sum, weights) = values
        .iter()
        .enumerate()
        .fold((0.0, 0.0), |(sum, all), (n, value)| {
            let weight = 1.0 - (TAU * (n as f64 + 0.5) / count).cos();
            (sum + weight * value, all + weight)
        });
    (weights > 0.0).then(|| sum / weights)
}
