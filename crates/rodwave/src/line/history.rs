//! Observed histories of a line.

use super::gauge::Reading;
use super::grid::Grid;
use super::ledger::Ledger;
use super::march::{EndState, March};
use super::tangent::Parameter;
use crate::RodwaveError;
use crate::interpolation::Quintic;

/// Histories of a [`Line`](super::Line).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct LineHistory {
    /// The grid, with its time step dt.
    pub grid: Grid,
    /// Histories of the gauges.
    pub gauges: Vec<SectionHistory>,
    /// Histories of the contacts, from the left.
    pub contacts: Vec<ContactHistory>,
    /// Histories of the left and the right end of the line.
    pub ends: [EndHistory; 2],
    /// Derivatives with respect to the requested parameters.
    pub derivatives: Vec<Derivatives>,
    /// Energy and momentum at the end.
    pub ledger: Ledger,
}

/// Values at one gauge at the times 0, dt, 2 dt ...
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SectionHistory {
    /// Particle velocity [m/s].
    pub velocity: Vec<f64>,
    /// Stress \[Pa\], positive in tension.
    pub stress: Vec<f64>,
    /// Strain, positive in tension.
    pub strain: Vec<f64>,
}

/// Force and velocity of an end at dt/2, 3 dt/2 ...
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EndHistory {
    /// Force \[N\], positive in compression.
    pub force: Vec<f64>,
    /// Velocity along x [m/s].
    pub velocity: Vec<f64>,
}

/// Force and gap of a contact.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContactHistory {
    /// Force \[N\] at dt/2, 3 dt/2 ..., positive in compression.
    pub force: Vec<f64>,
    /// Gap \[m\] at dt, 2 dt ...
    pub gap: Vec<f64>,
    /// Times \[s\] at which the gap closes, resolved within a step. Faces that touch at rest close
    /// at the start of the step of their first force.
    pub closes: Vec<f64>,
    /// Times \[s\] at which the faces separate: the zero, by linear interpolation, between the last
    /// force and the tension that would hold the faces together. The error is of second order in
    /// the step for a force that falls smoothly, and up to half a step for one that jumps.
    pub opens: Vec<f64>,
}

/// Derivatives of all histories with respect to one parameter.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Derivatives {
    /// The parameter.
    pub parameter: Parameter,
    /// Derivatives at each gauge.
    pub gauges: Vec<SectionHistory>,
    /// Derivatives of the force in each contact.
    pub contact_forces: Vec<Vec<f64>>,
    /// Derivatives at the ends.
    pub ends: [EndHistory; 2],
}

impl SectionHistory {
    fn push(&mut self, reading: Reading) {
        self.velocity.push(reading.velocity);
        self.stress.push(reading.stress);
        self.strain.push(reading.strain);
    }
}

impl EndHistory {
    fn push(&mut self, state: EndState) {
        self.force.push(state.force);
        self.velocity.push(state.velocity);
    }
}

impl EndHistory {
    /// Velocity [m/s] at `times` \[s\] of an end that is at rest in its first steps, by a
    /// polynomial of degree five through its values at intervals of `time_step` \[s\].
    #[must_use]
    pub fn velocity_at(&self, time_step: f64, times: &[f64]) -> Vec<f64> {
        // the first value is at half a step; before that time the end is at rest
        const BEFORE: usize = 3;
        let at_rest = std::iter::repeat_n(&0.0, BEFORE);
        let history: Vec<f64> = at_rest.chain(&self.velocity).copied().collect();
        let place = |time: &f64| time / time_step - 0.5 + BEFORE as f64;
        let points = times.iter().map(|time| Quintic::around(place(time)));
        points.map(|point| point.value(&history)).collect()
    }
}

impl LineHistory {
    /// Runs `march` until `duration` and records everything.
    pub(super) fn record(
        mut march: March,
        duration: f64,
        contacts: usize,
        parameters: &[Parameter],
    ) -> Result<Self, RodwaveError> {
        let steps = march.steps_of(duration)?;
        let mut history = Self {
            grid: march.grid().clone(),
            gauges: vec![SectionHistory::default(); march.gauges.len()],
            contacts: vec![ContactHistory::default(); contacts],
            ends: std::array::from_fn(|_| EndHistory::default()),
            derivatives: parameters
                .iter()
                .map(|parameter| Derivatives {
                    parameter: *parameter,
                    gauges: vec![SectionHistory::default(); march.gauges.len()],
                    contact_forces: vec![Vec::new(); contacts],
                    ends: std::array::from_fn(|_| EndHistory::default()),
                })
                .collect(),
            ledger: march.ledger(),
        };
        history.push_gauges(&march);
        for _ in 0..steps {
            march.advance()?;
            history.push_gauges(&march);
            history.push_ends(&march);
        }
        history.ledger = march.finite_ledger()?;
        Ok(history)
    }

    fn push_gauges(&mut self, march: &March) {
        for (history, gauge) in self.gauges.iter_mut().zip(&march.gauges) {
            history.push(gauge.reading);
        }
        for (parameter, derivatives) in self.derivatives.iter_mut().enumerate() {
            for (history, gauge) in derivatives.gauges.iter_mut().zip(&march.gauges) {
                if let Some(reading) = gauge.by_parameter.get(parameter) {
                    history.push(*reading);
                }
            }
        }
    }

    fn push_ends(&mut self, march: &March) {
        for (history, state) in self.ends.iter_mut().zip(march.ends()) {
            history.push(state);
        }
        for (index, contact) in self.contacts.iter_mut().enumerate() {
            contact.force.push(march.contact_force(index));
            contact.gap.push(march.gap(index));
            match march.turn(index) {
                Some((true, time)) => contact.closes.push(time),
                Some((false, time)) => contact.opens.push(time),
                None => {}
            }
        }
        for (parameter, derivatives) in self.derivatives.iter_mut().enumerate() {
            for (history, state) in derivatives.ends.iter_mut().zip(march.ends_by(parameter)) {
                history.push(state);
            }
            for (index, forces) in derivatives.contact_forces.iter_mut().enumerate() {
                forces.push(march.contact_force_by(index, parameter));
            }
        }
    }
}
