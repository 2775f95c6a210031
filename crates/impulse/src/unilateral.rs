//! Time marching of the contact force: contact, separation and re-contact.
//!
//! Theory: `docs/theory/contact.md#time-step`.

use crate::contact_law::Memory;
use crate::convolution::OnlineConvolution;
use crate::{ContactLaw, Graze, ImpulseError};

/// Largest number of corrections of the approach in a step.
const MOST_ITERATIONS: usize = 60;

/// Relative change of the approach at convergence.
const CONVERGED: f64 = 1e-14;

/// Fraction of the largest force so far below which a force does not count as contact: between
/// faces that move equally the rounding of the kernel leaves small forces. The force itself is not
/// changed.
const PRESSING: f64 = 1e-6;

/// Product of stiffness, mobility and time step above which the force of a stiff contact alternates
/// from step to step.
const RESOLVED: f64 = 2.0;

/// A contact from touch to separation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ContactInterval {
    /// Time of touch \[s\], to a fraction of a step.
    pub begin: f64,
    /// Time of separation \[s\]; `None` if the faces are still in contact at the end of the
    /// history.
    pub end: Option<f64>,
    /// Impulse of this contact \[N s\].
    pub impulse: f64,
    /// Largest force \[N\].
    pub peak: f64,
    /// The lowest minimum of the force within the contact, where the faces came closest to
    /// separating.
    pub closest_to_separation: Option<Graze>,
}

/// Inputs of the time marching.
#[derive(Debug, Clone, Copy)]
pub(crate) struct March<'a> {
    /// Sum of the kernels of both bodies.
    pub(crate) kernel: &'a [f64],
    pub(crate) time_step: f64,
    pub(crate) velocity: f64,
    pub(crate) law: &'a ContactLaw,
}

/// Results of the time marching.
#[derive(Debug, Clone)]
pub(crate) struct Marched {
    pub(crate) force: Vec<f64>,
    /// Approach at the end of each step.
    pub(crate) approach: Vec<f64>,
    pub(crate) contacts: Vec<ContactInterval>,
    /// Work of the force on the contact by its law, including the closing of gaps.
    pub(crate) contact_work: f64,
    /// Part of this work that the contact could return at the end.
    pub(crate) stored: f64,
    /// Largest stiffness times first weight times time step.
    pub(crate) stiffness_number: f64,
    pub(crate) unconverged: usize,
}

impl Marched {
    pub(crate) fn resolves_contact(&self) -> bool {
        self.stiffness_number <= RESOLVED
    }
}

/// Force and approach of a step.
#[derive(Clone, Copy)]
struct Step {
    force: f64,
    approach: f64,
    /// Force that would hold the faces together if they separate.
    pull: f64,
}

impl March<'_> {
    /// Solves 0 <= F, gap >= 0, F gap = 0, or the contact law, at every step.
    pub(crate) fn run(&self) -> Result<Marched, ImpulseError> {
        let first_weight = self.first_weight()?;
        let mut past = OnlineConvolution::new(self.kernel);
        let mut memory = Memory::default();
        let mut marched = Marched {
            force: Vec::new(),
            approach: Vec::with_capacity(self.kernel.len()),
            contacts: Vec::new(),
            contact_work: 0.0,
            stored: 0.0,
            stiffness_number: 0.0,
            unconverged: 0,
        };
        let mut log = ContactLog::default();
        let mut approach = 0.0_f64;
        for index in 0..self.kernel.len() {
            let free = approach + self.time_step * (self.velocity - past.past());
            let step = match self.law {
                ContactLaw::Rigid => self.rigid(free, first_weight),
                _ => self.compliant(approach, free, first_weight, memory, &mut marched),
            };
            if !(step.force.is_finite() && step.approach.is_finite()) {
                return Err(ImpulseError::Diverged {
                    step: index,
                    time: (index as f64 + 0.5) * self.time_step,
                });
            }
            marched.contact_work += match self.law {
                ContactLaw::Rigid => step.force * (step.approach - approach),
                _ => self.law.work(memory, approach, step.approach),
            };
            past.push(step.force);
            memory.reach(step.approach);
            log.enter(self, index, approach, step, self.law.dent(memory));
            approach = step.approach;
            marched.approach.push(approach);
        }
        marched.stored = -self.law.work(memory, approach, 0.0);
        marched.force = past.into_given();
        marched.contacts = log.close();
        Ok(marched)
    }

    /// Computes the force between faces that stick, which may be tensile.
    pub(crate) fn run_sticking(&self) -> Result<Vec<f64>, ImpulseError> {
        let first_weight = self.first_weight()?;
        let mut past = OnlineConvolution::new(self.kernel);
        let mut approach = 0.0_f64;
        for index in 0..self.kernel.len() {
            let closing = self.velocity - past.past();
            let force = match self.law {
                ContactLaw::Linear { stiffness } => {
                    let half = 0.5 * stiffness * self.time_step;
                    let force =
                        (stiffness * approach + half * closing) / (1.0 + half * first_weight);
                    approach += self.time_step * (closing - first_weight * force);
                    force
                }
                _ => closing / first_weight,
            };
            if !force.is_finite() {
                return Err(ImpulseError::Diverged {
                    step: index,
                    time: (index as f64 + 0.5) * self.time_step,
                });
            }
            past.push(force);
        }
        Ok(past.into_given())
    }

    fn first_weight(&self) -> Result<f64, ImpulseError> {
        let weight = self.kernel.first().copied().unwrap_or(0.0);
        if weight.is_finite() && weight > 0.0 {
            Ok(weight)
        } else {
            Err(ImpulseError::ActiveFaces {
                weight,
                time_step: self.time_step,
            })
        }
    }

    fn rigid(&self, free: f64, first_weight: f64) -> Step {
        let force = free / (self.time_step * first_weight);
        if free > 0.0 {
            Step {
                force,
                approach: 0.0,
                pull: 0.0,
            }
        } else {
            Step {
                force: 0.0,
                approach: free,
                pull: force,
            }
        }
    }

    /// Finds the root δ' of δ' + h w_0 F̄(δ → δ') = δ_free, where F̄ is the mean force, work
    /// divided by distance. The left side grows with δ', and the root lies between δ_free less the
    /// largest decrease and δ_free.
    fn compliant(
        &self,
        from: f64,
        free: f64,
        first_weight: f64,
        memory: Memory,
        marched: &mut Marched,
    ) -> Step {
        let reach = self.time_step * first_weight;
        let mean = |to: f64| self.law.mean_force(memory, from, to);
        let highest = mean(free);
        if highest <= 0.0 {
            return Step {
                force: 0.0,
                approach: free,
                pull: 0.0,
            };
        }
        let (mut low, mut high) = (free - reach * highest, free);
        let scale = from.abs().max(free.abs());
        let mut to = high;
        let mut converged = false;
        for _ in 0..MOST_ITERATIONS {
            let force = mean(to);
            let excess = to + reach * force - free;
            if excess > 0.0 {
                high = to;
            } else {
                low = to;
            }
            // slope of the mean force; if both ends coincide it is half the slope of the law,
            // computed by the same formula over a larger distance
            let way = to - from;
            let slope = if way.abs() > 1e-5 * scale {
                (self.law.force(memory, to) - force) / way
            } else {
                let aside = 1e-3 * scale;
                (mean(to + aside) - force) / aside
            };
            let newton = to - excess / (1.0 + reach * slope.max(0.0));
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            let change = (next - to).abs();
            to = next;
            if change <= CONVERGED * scale {
                converged = true;
                break;
            }
        }
        if !converged {
            marched.unconverged += 1;
        }
        // the force follows from the equation of motion, so that the balance of the step is exact
        // for any error of the root
        let force = ((free - to) / reach).max(0.0);
        let stiffness = 2.0 * (self.law.force(memory, to) - force).abs() / (to - from).abs();
        if stiffness.is_finite() {
            marched.stiffness_number = marched.stiffness_number.max(reach * stiffness);
        }
        Step {
            force,
            approach: to,
            pull: 0.0,
        }
    }
}

/// List of contacts during the marching.
#[derive(Default)]
struct ContactLog {
    done: Vec<ContactInterval>,
    now: Option<ContactInterval>,
    /// Forces of the two previous steps.
    last: [f64; 2],
    highest: f64,
    /// Time within the last step at which the approach fell to the dent, where a compliant contact
    /// no longer presses; `None` if it did not.
    parted: Option<f64>,
}

impl ContactLog {
    /// Adds a step from the approach `before`; the force of a compliant contact is zero up to the
    /// approach `dent`.
    fn enter(&mut self, march: &March<'_>, index: usize, before: f64, step: Step, dent: f64) {
        let time_step = march.time_step;
        let begin_of_step = index as f64 * time_step;
        self.highest = self.highest.max(step.force);
        let parts = (before > dent && step.approach <= dent)
            .then(|| begin_of_step + (before - dent) / (before - step.approach) * time_step);
        if step.force > PRESSING * self.highest {
            let contact = self.now.get_or_insert_with(|| {
                // part of the step after which the gap closes if no force acts in the step
                let closing = if before < 0.0 {
                    let free = before + time_step * march.velocity_against(step, before);
                    before / (before - free)
                } else {
                    0.0
                };
                ContactInterval {
                    begin: begin_of_step + closing.clamp(0.0, 1.0) * time_step,
                    end: None,
                    impulse: 0.0,
                    peak: 0.0,
                    closest_to_separation: None,
                }
            });
            contact.impulse += step.force * time_step;
            contact.peak = contact.peak.max(step.force);
            let [older, last] = self.last;
            if older > 0.0 && last < older && last <= step.force && last > 0.0 {
                let graze = Graze {
                    time: begin_of_step - 0.5 * time_step,
                    force: last,
                };
                if contact
                    .closest_to_separation
                    .is_none_or(|lowest| last < lowest.force)
                {
                    contact.closest_to_separation = Some(graze);
                }
            }
        } else if let Some(mut contact) = self.now.take() {
            let last = self.last[1];
            let end = match march.law {
                ContactLaw::Rigid => {
                    // the zero between the last force and the tension that would hold the faces
                    // together
                    let pull = step.pull.min(0.0);
                    begin_of_step + (last / (last - pull) - 0.5) * time_step
                }
                // the force of the step in which the faces separate may be below the threshold
                _ => parts.or(self.parted).unwrap_or(begin_of_step),
            };
            contact.end = Some(end);
            self.done.push(contact);
        }
        self.parted = parts;
        self.last = [self.last[1], step.force];
    }

    fn close(mut self) -> Vec<ContactInterval> {
        self.done.extend(self.now);
        self.done
    }
}

impl March<'_> {
    /// Mean closing velocity that a step would have without its force.
    fn velocity_against(&self, step: Step, before: f64) -> f64 {
        let first_weight = self.kernel.first().copied().unwrap_or(0.0);
        (step.approach - before) / self.time_step + first_weight * step.force
    }
}
