//! One draw of a Monte Carlo computation: random numbers for the errors of the data.

use std::sync::{Mutex, PoisonError};

use cmod::rheology::FittedLaw;
use maxwellid::Law;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Text after "expected" in the error message about data without errors.
pub(crate) const NEEDS_ERRORS: &str =
    "standard errors of the data: without them the draws have no scatter to be compared with";

/// Random numbers of one draw, and the laws that are fitted to the drawn data.
#[derive(Debug)]
pub struct Draw {
    random: Mutex<ChaCha8Rng>,
    pub(crate) laws: DrawnLaws,
}

/// Laws of a result that are fitted to each draw.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct DrawnLaws {
    /// Laws of a modulus whose parameters are all identifiable; fits to the drawn data start from
    /// them. A Prony series is excluded, because its errors include the uncertainty of the number
    /// of its branches.
    pub(crate) of_modulus: Vec<FittedLaw>,
    /// Laws of an impacted rod.
    pub(crate) of_rod: Vec<Law>,
}

impl Draw {
    pub(crate) fn new(random: ChaCha8Rng, laws: DrawnLaws) -> Self {
        Self {
            random: Mutex::new(random),
            laws,
        }
    }

    /// Draws a number from the standard normal distribution.
    pub(crate) fn standard(&self) -> f64 {
        self.with_random(|random| random.sample(StandardNormal))
    }

    /// Calls `of` with the random number generator, and returns its result.
    pub(crate) fn with_random<T>(&self, of: impl FnOnce(&mut ChaCha8Rng) -> T) -> T {
        let mut random = self.random.lock().unwrap_or_else(PoisonError::into_inner);
        of(&mut random)
    }
}
