//! Conditions at the two ends of a line.

use std::fmt;
use std::sync::Arc;

use crate::RodwaveError;
use crate::band_limited::VelocityHistory;
use crate::error::{check_finite, check_positive};

/// Condition at an end of a line.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub enum End {
    /// A free end, without force.
    #[default]
    Free,
    /// A fixed end, without velocity.
    Fixed,
    /// A rigid mass \[kg\] that is bonded to the end and has its initial velocity.
    Mass(f64),
    /// A dashpot to ground: force = resistance [N s/m] times velocity.
    Dashpot(f64),
    /// A dashpot with the front impedance of the end: no reflections from an elastic line, almost
    /// none from an inelastic one.
    Matched,
    /// A given velocity [m/s] along x.
    Velocity(Drive),
    /// A given force \[N\], positive in compression.
    Force(Drive),
}

impl End {
    pub(super) fn check(&self) -> Result<(), RodwaveError> {
        match self {
            Self::Mass(mass) => check_positive("mass at an end [kg]", *mass).map(drop),
            Self::Dashpot(resistance) => {
                check_positive("resistance at an end [N s/m]", *resistance).map(drop)
            }
            _ => Ok(()),
        }
    }
}

/// A quantity prescribed as a function of time.
#[derive(Clone)]
pub struct Drive {
    value: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
    end: f64,
}

impl Drive {
    /// Creates a drive from the function `value` of time \[s\], defined at all times.
    #[must_use]
    pub fn of(value: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        Self {
            value: Arc::new(value),
            end: f64::INFINITY,
        }
    }

    /// Creates a drive from a sampled history, defined until its end.
    #[must_use]
    pub fn history(history: impl VelocityHistory + Send + 'static) -> Self {
        Self {
            end: history.end(),
            value: Arc::new(move |time| history.at(time)),
        }
    }

    /// Returns the value at `time` \[s\].
    pub(super) fn at(&self, time: f64, quantity: &'static str) -> Result<f64, RodwaveError> {
        check_finite(quantity, (self.value)(time))
    }

    /// Checks that the drive is defined until `needed`.
    pub(super) fn check_until(&self, needed: f64) -> Result<(), RodwaveError> {
        // rounding may put `needed` above a whole number of sampling intervals
        if needed > self.end * (1.0 + 1e-12) {
            return Err(RodwaveError::ExcitationTooShort {
                needed,
                found: self.end,
            });
        }
        Ok(())
    }
}

impl fmt::Debug for Drive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Drive")
            .field("end", &self.end)
            .finish_non_exhaustive()
    }
}
