//! Effect of the distance between the gauges on the error.

use cmod::multi_point::advice::singular_frequencies;
use rodwave::digits::significant;
use serde::Serialize;

use super::super::{Error, Table, table_of};
use super::estimates::in_situ;
use super::rig::{Mounting, SEED, polypropylene, positions};
use testbed::papers::paper_b::PaperB;

/// Distances a between neighbouring gauges, in m.
const DISTANCES: [f64; 4] = [0.050, 0.100, 0.150, 0.200];

/// Upper limit of the search for singular frequencies, in Hz.
const HIGHEST_HZ: f64 = 40e3;

/// Result for one distance.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Distance {
    pub(crate) distance: f64,
    /// Median over the lines of the standard error of E' relative to |E|.
    pub(crate) deviation: f64,
    pub(crate) valid: usize,
    /// First frequency at which ka = π, in Hz.
    pub(crate) singular_hz: f64,
}

pub(crate) fn all(paper: &PaperB) -> Result<Vec<Distance>, Error> {
    let medium = polypropylene(paper)?;
    DISTANCES
        .iter()
        .map(|&distance| {
            let estimate = in_situ(paper, Mounting::StructureI, distance, SEED)?;
            let mut errors: Vec<f64> = estimate
                .lines()
                .iter()
                .map(|line| line.standard_error.storage_modulus / line.modulus.norm())
                .collect();
            errors.sort_by(f64::total_cmp);
            let singular =
                singular_frequencies(&medium, &positions(paper, distance), 1e-4, HIGHEST_HZ)?;
            Ok(Distance {
                distance,
                deviation: errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN),
                valid: estimate.valid().count(),
                singular_hz: singular.first().copied().unwrap_or(f64::INFINITY),
            })
        })
        .collect()
}

pub(crate) fn table(distances: &[Distance]) -> Table {
    table_of!(distances, |row|
        "a, mm" => format!("{:.0}", 1e3 * row.distance),
        "median standard error of E', %" => significant(100.0 * row.deviation, 2),
        "valid lines" => row.valid,
        "ka = π at, Hz" => format!("{:.0}", row.singular_hz),
    )
}
