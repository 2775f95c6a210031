//! What an impact does.

use std::fmt;

use super::DiscreteImpact;
use crate::balance::{Account, Balance};
use crate::convolution::causal_convolution;
use crate::unilateral::{ContactInterval, Marched};
use crate::{BandLimit, ForceHistory, ForcePeak, ImpulseError};

/// What a kernel may have ahead of the impulse, over the first weight of both.
const ACAUSAL: f64 = 1e-3;

/// A law is passive above minus this part of its magnitude (rounding).
const ROUNDING: f64 = 1e-9;

/// Part of the impulse from which a contact counts for the duration.
const COUNTS: f64 = 1e-3;

/// Inner energy below minus this part of the work is a body that makes energy.
const ACTIVE: f64 = 1e-3;

/// Force, contacts and balance of an impact; made by [`Impact::predict`](crate::Impact::predict).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Prediction {
    /// The force \[N\]; for [`Quadrature::CellAverages`](crate::Quadrature) the mean over a step at the middle of it.
    pub history: ForceHistory,
    /// Every contact, in the order of time. Contacts a few steps long are common where faces graze.
    pub contacts: Vec<ContactInterval>,
    /// Velocities of the faces of both bodies along V \[m/s\], at the times of the force; `(n_steps)`.
    pub face_velocity: [Vec<f64>; 2],
    /// Approach of the faces at the end of each step \[m\], negative for a gap; `(n_steps)`.
    pub approach: Vec<f64>,
    /// What speaks against the prediction; empty if nothing does.
    pub flags: Vec<PredictionFlag>,
    balance: Balance,
}

/// What speaks against a prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum PredictionFlag {
    /// The faces still press at the end: the balance is that of an unfinished impact.
    StillInContact,
    /// A body answers ahead of the impulse, or its ringing did not die out in the period: [`Kernel::acausal`](crate::Kernel::acausal).
    Acausal {
        /// 0 or 1.
        body: usize,
        /// Root mean square ahead of the impulse, over what both faces answer in the first step.
        level: f64,
    },
    /// The real part of a mobility is negative on some line: [`Kernel::activity`](crate::Kernel::activity) is above rounding. Not for measured
    /// bodies.
    Active {
        /// 0 or 1.
        body: usize,
        /// The largest $`-\operatorname{Re} G/\lvert G\rvert`$.
        activity: f64,
    },
    /// The time step is too long for the stiffness of the contact: its force alternates from step to step.
    UnresolvedContact {
        /// Stiffness times mobility times time step, above 2.
        number: f64,
    },
    /// The approach was not found to rounding in some steps.
    Unconverged {
        /// How many.
        steps: usize,
    },
    /// A body has given more energy than it had: it is not passive in the band that matters.
    MakesEnergy {
        /// 0 or 1.
        body: usize,
        /// Its inner energy \[J\], negative.
        inner: f64,
    },
}

impl fmt::Display for PredictionFlag {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StillInContact => write!(formatter, "the faces still press at the end"),
            Self::Acausal { body, level } => write!(
                formatter,
                "body {body} answers ahead of the impulse, or rings longer than its period: {level:.1e} of the first answer"
            ),
            Self::Active { body, activity } => write!(
                formatter,
                "body {body} generates energy: the real part of its mobility comes down to {:.2e} of the magnitude",
                -activity
            ),
            Self::UnresolvedContact { number } => write!(
                formatter,
                "the time step is too long for the contact: stiffness times mobility times step is {number:.2}, expected below 2"
            ),
            Self::Unconverged { steps } => {
                write!(formatter, "the approach did not converge in {steps} steps")
            }
            Self::MakesEnergy { body, inner } => {
                write!(formatter, "body {body} has made {:.2e} J", -inner)
            }
        }
    }
}

impl Prediction {
    pub(super) fn new(discrete: &DiscreteImpact, marched: Marched) -> Result<Self, ImpulseError> {
        let velocity = discrete.velocity();
        let kernels = discrete.kernels();
        let [first, second] = kernels
            .each_ref()
            .map(|kernel| causal_convolution(kernel.weights(), &marched.force));
        let first: Vec<f64> = first.iter().map(|own| velocity - own).collect();
        let mut contact_work = marched.contact_work;
        let grid = kernels[0].grid();
        // a spring at a face that is not part of the law has its work in the kernel
        let springs = discrete.springs();
        if springs > 0.0 {
            let mut before = 0.0;
            for &force in &marched.force {
                contact_work += springs * force * (force - before);
                before = force;
            }
        }
        let balance = Account {
            time_step: grid.time_step,
            velocity,
            masses: discrete.masses(),
            force: &marched.force,
            faces: [&first, &second],
            contact_work,
            stored_in_contact: marched.stored,
        }
        .balance();
        if !balance.is_within_range() {
            return Err(ImpulseError::OutOfRange {
                what: "balance of momentum and energy",
            });
        }
        let mut flags = Vec::new();
        if marched
            .contacts
            .last()
            .is_some_and(|last| last.end.is_none())
        {
            flags.push(PredictionFlag::StillInContact);
        }
        for (body, kernel) in kernels.iter().enumerate() {
            let level = kernel.acausal() / discrete.first_weight().abs();
            if level > ACAUSAL {
                flags.push(PredictionFlag::Acausal { body, level });
            }
        }
        for (body, (kernel, measured)) in kernels.iter().zip(discrete.measured()).enumerate() {
            if kernel.activity() > ROUNDING && !measured {
                flags.push(PredictionFlag::Active {
                    body,
                    activity: kernel.activity(),
                });
            }
        }
        if !marched.resolves_contact() {
            flags.push(PredictionFlag::UnresolvedContact {
                number: marched.stiffness_number,
            });
        }
        if marched.unconverged > 0 {
            flags.push(PredictionFlag::Unconverged {
                steps: marched.unconverged,
            });
        }
        for (body, &inner) in balance.inner.iter().enumerate() {
            if inner < -ACTIVE * velocity * balance.impulse.abs() {
                flags.push(PredictionFlag::MakesEnergy { body, inner });
            }
        }
        Ok(Self {
            history: discrete.history(marched.force)?,
            contacts: marched.contacts,
            face_velocity: [first, second],
            approach: marched.approach,
            flags,
            balance,
        })
    }

    /// The force in a band, with the time ahead of the contact into which the band limit rounds a jump. It ends $`5\sigma`$ before a history in which the faces
    /// still press at the end.
    ///
    /// # Errors
    ///
    /// As [`BandLimit::apply`]; [`ImpulseError::TooShort`] if nothing is left of the history.
    pub fn band_limited(&self, band: BandLimit) -> Result<ForceHistory, ImpulseError> {
        let limited = band.apply(&self.history)?;
        let unfinished = self.contacts.last().is_some_and(|last| last.end.is_none());
        if !unfinished {
            return Ok(limited);
        }
        // the band limit has added 5σ at either end, and the last 5σ of the history are not known
        let n_samples = self.history.force().len();
        let added = limited.force().len() - n_samples;
        if n_samples <= added {
            return Err(ImpulseError::TooShort {
                what: "force history in a band",
                found: n_samples,
                expected: added + 1,
            });
        }
        let known = limited.force().iter().take(n_samples).copied();
        ForceHistory::new(limited.time_at(0), limited.time_step(), known.collect())
    }

    /// The largest force, as sampled.
    #[must_use]
    pub fn peak(&self) -> ForcePeak {
        self.history.peak()
    }

    /// From the first touch to the last parting, or to the end of the history if the faces still press \[s\].
    ///
    /// Contacts that carry less than a thousandth of the impulse do not count: a jump within a step leaves some of one step where elastic
    /// bodies part without a force. [`Prediction::contacts`] has them all.
    #[must_use]
    pub fn duration(&self) -> f64 {
        let least = COUNTS * self.balance.impulse;
        let mut counting = self
            .contacts
            .iter()
            .filter(|contact| contact.impulse >= least);
        let Some(first) = counting.next() else {
            return 0.0;
        };
        let last = counting.next_back().unwrap_or(first);
        let samples = self.history.force().len();
        last.end
            .unwrap_or(self.history.time_at(samples.saturating_sub(1)))
            - first.begin
    }

    /// Momentum, energy and restitution.
    #[must_use]
    pub fn balance(&self) -> &Balance {
        &self.balance
    }
}
