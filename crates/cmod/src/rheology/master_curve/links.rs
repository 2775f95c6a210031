//! Connections between neighbouring temperatures of a sweep, and the initial shifts.

use std::ops::RangeInclusive;

use super::super::data::ModulusData;
use super::super::overlap::{self, Overlap};
use super::super::sweep::TemperatureSweep;
use crate::error::CmodError;

/// Maximum logarithm of the factor of the modulus between neighbouring temperatures; the factor is
/// between e^-0.2 and e^0.2.
const MOST_LOG_FACTOR: f64 = 0.2;
/// Minimum number of common points for which a factor is determined; a shift and a factor together
/// fit fewer points by chance.
const FEWEST_FOR_FACTOR: usize = 8;

/// Connection of a temperature with the previous temperature.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    /// Logarithm of the ratio of the shifts, if the curves overlap.
    pub(super) overlap: Option<f64>,
    /// Logarithm of the ratio of the factors in the overlap; 0 if there is no overlap.
    pub(super) log_factor: f64,
}

/// Returns the link of each temperature to the previous one; `None` if there is no link, as for the
/// first temperature.
pub(super) fn links(sweep: &TemperatureSweep, factors: &[f64]) -> Vec<Option<Link>> {
    let reduced: Vec<ModulusData> = sweep
        .data
        .iter()
        .zip(factors)
        .map(|(data, factor)| ModulusData::joined(std::iter::once((data, *factor))))
        .collect();
    let between = |pair: &[ModulusData]| {
        let [colder, warmer] = pair else {
            return None;
        };
        let plain = overlap::best(colder, warmer, false).filter(Overlap::agrees);
        let found = plain.or_else(|| {
            let free = (!sweep.vertical_is_stated).then(|| overlap::best(colder, warmer, true));
            let plausible = |found: &Overlap| {
                found.log_factor.abs() <= MOST_LOG_FACTOR && found.points >= FEWEST_FOR_FACTOR
            };
            free.flatten().filter(Overlap::agrees).filter(plausible)
        });
        let of_overlap = found.map(|found| Link {
            overlap: Some(found.log_shift),
            log_factor: found.log_factor,
        });
        of_overlap.or_else(|| {
            sweep.stated_shifts.is_some().then_some(Link {
                overlap: None,
                log_factor: 0.0,
            })
        })
    };
    std::iter::once(None)
        .chain(reduced.windows(2).map(between))
        .collect()
}

/// Returns the temperatures that links connect with the reference.
pub(super) fn connected(links: &[Option<Link>], reference: usize) -> RangeInclusive<usize> {
    let is_linked = |step: &usize| links.get(*step).is_some_and(Option::is_some);
    let below = (1..=reference).rev().take_while(is_linked).count();
    let above = (reference + 1..links.len()).take_while(is_linked).count();
    reference - below..=reference + above
}

impl TemperatureSweep {
    /// Returns the temperatures that overlaps or stated shifts connect with the temperature of
    /// index `reference`.
    ///
    /// # Errors
    /// [`CmodError::ReferenceTest`] for an index beyond the temperatures.
    pub fn connected(&self, reference: usize) -> Result<&[f64], CmodError> {
        let count = self.temperatures.len();
        let beyond = CmodError::ReferenceTest {
            index: reference,
            count,
        };
        if reference >= count {
            return Err(beyond);
        }
        let links = links(self, &self.factors(reference));
        self.temperatures
            .get(connected(&links, reference))
            .ok_or(beyond)
    }
}

/// Initial shifts and factors.
pub(super) struct Starts {
    /// Logarithms ln a_T of the shift factors; 0 at the reference.
    pub(super) log_shifts: Vec<f64>,
    pub(super) log_factors: Vec<f64>,
    /// True if ln a_T is the stated value.
    pub(super) is_stated: Vec<bool>,
}

#[allow(
    clippy::indexing_slicing,
    reason = "there is one entry for each temperature, and `reference` is below their number"
)]
impl Starts {
    /// Determines the initial values, step by step from the reference towards lower and higher
    /// temperatures.
    pub(super) fn of(sweep: &TemperatureSweep, links: &[Option<Link>], reference: usize) -> Self {
        let count = links.len();
        let mut starts = Self {
            log_shifts: vec![0.0; count],
            log_factors: vec![0.0; count],
            is_stated: vec![false; count],
        };
        let mut go = |from: usize, to: usize, link: Option<Link>, sign: f64| {
            let Some(link) = link else {
                return;
            };
            starts.log_factors[to] = starts.log_factors[from] + sign * link.log_factor;
            match (link.overlap, &sweep.stated_shifts) {
                (Some(relative), _) => {
                    starts.log_shifts[to] = starts.log_shifts[from] + sign * relative;
                }
                (None, Some(stated)) => {
                    starts.log_shifts[to] = stated[to] - stated[reference];
                    starts.is_stated[to] = true;
                }
                (None, None) => {}
            }
        };
        for (to, link) in links.iter().enumerate().take(count).skip(reference + 1) {
            go(to - 1, to, *link, 1.0);
        }
        for to in (0..reference).rev() {
            go(to + 1, to, links[to + 1], -1.0);
        }
        starts
    }

    pub(super) fn demand_factors(&self) -> bool {
        self.log_factors.iter().any(|factor| *factor != 0.0)
    }
}
