//! Conditions at the ends of segments, half a step after the waves have left the cells.
//!
//! A wave R that arrives at the right end of a segment gives v = N/z - R at that end; a wave L at a
//! left end gives v = L - N/z. N is the normal force, z = AZ. The other side of the junction gives
//! the second equation. A junction stores no energy, and the work and the impulse of N during the
//! step are exactly N v dt and N dt. The balances therefore close to rounding.
#![allow(
    clippy::indexing_slicing,
    reason = "a contact and an end have a tangent for each parameter of the march"
)]

use super::end::{Drive, End};
use crate::RodwaveError;

/// Force \[N\] (positive in tension) and velocity [m/s] of a section.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Meeting {
    pub(super) force: f64,
    pub(super) velocity: f64,
}

/// One side of a junction: the arriving wave, in units of s = σ/Z of its segment, and z.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    pub(super) arriving: f64,
    pub(super) impedance: f64,
}

/// Derivatives of a [`Side`] with respect to one parameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct SideTangent {
    pub(super) arriving: f64,
    /// d ln z
    pub(super) growth: f64,
}

/// Junction between two segments: R arrives from the `left` one, L from the `right` one.
#[derive(Debug, Clone)]
pub(super) enum Junction {
    Bonded,
    Contact(Contact),
}

/// A unilateral contact: force <= 0, gap >= 0, force times gap = 0.
#[derive(Debug, Clone)]
pub(super) struct Contact {
    pub(super) gap: f64,
    pub(super) gap_tangents: Vec<f64>,
    pub(super) closed: bool,
    /// Force of the previous step \[N\], positive in compression.
    pub(super) last: f64,
}

/// Forces and velocities on both sides of a contact, and the energy lost when a gap closes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Encounter {
    pub(super) left: Meeting,
    pub(super) right: Meeting,
    pub(super) lost: f64,
    /// Time at which a contact closes or opens, in steps after the start of the present step.
    pub(super) turn: Option<f64>,
}

impl Junction {
    pub(super) fn meet(&mut self, left: Side, right: Side, step: f64) -> Encounter {
        let compliance = 1.0 / left.impedance + 1.0 / right.impedance;
        // velocity of separation if the faces exert no force
        let separation = right.arriving + left.arriving;
        let mut turn = None;
        let force = match self {
            Self::Bonded => separation / compliance,
            Self::Contact(contact) => {
                let free_gap = contact.gap + step * separation;
                let was_closed = contact.closed;
                contact.closed = free_gap < 0.0;
                turn = match (was_closed, contact.closed) {
                    (false, true) => Some(contact.gap / (contact.gap - free_gap)),
                    // zero, by linear interpolation, between the last force and the tension that
                    // would hold the faces together, both at the middle of their steps
                    (true, false) => {
                        let pull = separation / compliance;
                        Some(contact.last / (contact.last + pull) - 0.5)
                    }
                    _ => None,
                };
                if contact.closed {
                    free_gap / (step * compliance)
                } else {
                    0.0
                }
            }
        };
        let lost = match self {
            Self::Contact(contact) if contact.closed => -force * contact.gap,
            _ => 0.0,
        };
        let encounter = Encounter {
            left: Meeting {
                force,
                velocity: force / left.impedance - left.arriving,
            },
            right: Meeting {
                force,
                velocity: right.arriving - force / right.impedance,
            },
            lost,
            turn,
        };
        if let Self::Contact(contact) = self {
            contact.last = -force;
            contact.gap = if contact.closed {
                0.0
            } else {
                contact.gap + step * separation
            };
        }
        encounter
    }

    /// Computes the derivatives of the encounter with respect to parameter `index` of the tangents.
    /// [`Self::meet`] must have decided before whether the contact is closed.
    pub(super) fn meet_tangent(
        &mut self,
        index: usize,
        encounter: &Encounter,
        sides: [Side; 2],
        tangents: [SideTangent; 2],
        step: f64,
    ) -> [Meeting; 2] {
        let [left, right] = sides;
        let [by_left, by_right] = tangents;
        let force = encounter.left.force;
        let compliance = 1.0 / left.impedance + 1.0 / right.impedance;
        let stiffening =
            force * (by_left.growth / left.impedance + by_right.growth / right.impedance);
        let separation = by_right.arriving + by_left.arriving;
        let by_force = match self {
            Self::Bonded => (separation + stiffening) / compliance,
            Self::Contact(contact) => {
                let by_gap = &mut contact.gap_tangents[index];
                let gap = *by_gap;
                if contact.closed {
                    *by_gap = 0.0;
                    (separation + gap / step + stiffening) / compliance
                } else {
                    *by_gap = gap + step * separation;
                    0.0
                }
            }
        };
        [
            Meeting {
                force: by_force,
                velocity: (by_force - force * by_left.growth) / left.impedance - by_left.arriving,
            },
            Meeting {
                force: by_force,
                velocity: by_right.arriving
                    - (by_force - force * by_right.growth) / right.impedance,
            },
        ]
    }
}

/// Side of the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Hand {
    Left,
    Right,
}

/// An end of the line with its accumulated balances.
#[derive(Debug, Clone)]
pub(super) struct Terminal {
    hand: Hand,
    end: End,
    /// Velocity of an attached mass, at whole steps.
    velocity: f64,
    velocity_tangents: Vec<f64>,
    /// Work done on the line by driven or fixed ends \[J\].
    pub(super) supplied: f64,
    /// Energy absorbed by a dashpot \[J\].
    pub(super) radiated: f64,
    /// Impulse on the line, along x [N s].
    pub(super) impulse: f64,
}

impl Terminal {
    pub(super) fn new(hand: Hand, end: &End, velocity: f64, tangents: usize) -> Self {
        Self {
            hand,
            end: end.clone(),
            velocity,
            velocity_tangents: vec![0.0; tangents],
            supplied: 0.0,
            radiated: 0.0,
            impulse: 0.0,
        }
    }

    /// Sign of the force on the end of the line: +1 if it acts along x in tension.
    fn outward(&self) -> f64 {
        match self.hand {
            Hand::Left => -1.0,
            Hand::Right => 1.0,
        }
    }

    /// Computes the force and the velocity of the end at `time`. With the outward velocity u, both
    /// ends obey u = N/z - a, where a is the arriving wave: R at the right end, L at the left end.
    pub(super) fn meet(
        &mut self,
        side: Side,
        time: f64,
        step: f64,
    ) -> Result<Meeting, RodwaveError> {
        let outward = self.outward();
        let Side {
            arriving,
            impedance,
        } = side;
        let force = match &self.end {
            End::Free => 0.0,
            End::Fixed => impedance * arriving,
            End::Velocity(drive) => {
                let velocity = drive.at(time, velocity_quantity(self.hand))?;
                impedance * (arriving + outward * velocity)
            }
            End::Force(drive) => -drive.at(time, force_quantity(self.hand))?,
            End::Matched => 0.5 * impedance * arriving,
            End::Dashpot(resistance) => arriving / (1.0 / impedance + 1.0 / resistance),
            End::Mass(mass) => {
                (arriving + outward * self.velocity) / (1.0 / impedance + 0.5 * step / mass)
            }
        };
        let outward_velocity = force / impedance - arriving;
        let work = force * outward_velocity * step;
        match &self.end {
            End::Matched | End::Dashpot(_) => {
                self.radiated -= work;
                self.impulse += outward * force * step;
            }
            End::Mass(mass) => self.velocity -= outward * force * step / mass,
            End::Free => {}
            End::Fixed | End::Velocity(_) | End::Force(_) => {
                self.supplied += work;
                self.impulse += outward * force * step;
            }
        }
        Ok(Meeting {
            force,
            velocity: outward * outward_velocity,
        })
    }

    /// Computes the derivatives of force and velocity of the end with respect to parameter `index`.
    pub(super) fn meet_tangent(
        &mut self,
        index: usize,
        meeting: Meeting,
        side: Side,
        by: SideTangent,
        step: f64,
    ) -> Meeting {
        let outward = self.outward();
        let impedance = side.impedance;
        // d(N/z) = (dN - N d ln z)/z
        let stiffening = meeting.force * by.growth / impedance;
        let by_force = match &self.end {
            End::Free | End::Force(_) => 0.0,
            End::Fixed | End::Velocity(_) => impedance * (by.arriving + stiffening),
            End::Matched => 0.5 * impedance * by.arriving + meeting.force * by.growth,
            End::Dashpot(resistance) => {
                (by.arriving + stiffening) / (1.0 / impedance + 1.0 / resistance)
            }
            End::Mass(mass) => {
                let velocity = &mut self.velocity_tangents[index];
                let force = (by.arriving + outward * *velocity + stiffening)
                    / (1.0 / impedance + 0.5 * step / mass);
                *velocity -= outward * force * step / mass;
                force
            }
        };
        let outward_velocity = by_force / impedance - stiffening - by.arriving;
        Meeting {
            force: by_force,
            velocity: outward * outward_velocity,
        }
    }

    /// Kinetic energy of an attached mass \[J\].
    pub(super) fn energy(&self) -> f64 {
        match self.end {
            End::Mass(mass) => 0.5 * mass * self.velocity * self.velocity,
            _ => 0.0,
        }
    }

    /// Momentum of an attached mass along x [N s].
    pub(super) fn momentum(&self) -> f64 {
        match self.end {
            End::Mass(mass) => mass * self.velocity,
            _ => 0.0,
        }
    }

    pub(super) fn drive(&self) -> Option<&Drive> {
        match &self.end {
            End::Velocity(drive) | End::Force(drive) => Some(drive),
            _ => None,
        }
    }
}

fn velocity_quantity(hand: Hand) -> &'static str {
    match hand {
        Hand::Left => "velocity prescribed at the left end [m/s]",
        Hand::Right => "velocity prescribed at the right end [m/s]",
    }
}

fn force_quantity(hand: Hand) -> &'static str {
    match hand {
        Hand::Left => "force prescribed at the left end [N]",
        Hand::Right => "force prescribed at the right end [N]",
    }
}
