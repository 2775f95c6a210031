//! Properties of results for random records of any content, and for numbers at the ends of the
//! range of `f64`.

mod extremes_sizes;
mod extremes_values;
#[path = "../../rodwave/tests/hard_to_break/hostile.rs"]
mod hostile;
mod hostile_files;
mod properties_histories;
mod properties_responses;
mod properties_spectra;
mod spoilt_files;

use labio::{AveragedSpectra, Channel, Quantity, Record, Window};
use ndarray::Array2;
use proptest::prelude::*;

use crate::records::record_of;

pub(crate) const INPUT: &str = "force";
pub(crate) const OUTPUT: &str = "response";

pub(crate) fn channels() -> Vec<Channel> {
    vec![
        Channel::new(INPUT, Quantity::Force).unwrap(),
        Channel::new(OUTPUT, Quantity::Acceleration).unwrap(),
    ]
}

pub(crate) fn record(rows: [&[f64]; 2], rate_hz: f64) -> Record {
    let samples = Array2::from_shape_fn((2, rows[0].len()), |(row, n)| rows[row][n]);
    record_of(
        samples,
        rate_hz,
        &[(INPUT, Quantity::Force), (OUTPUT, Quantity::Acceleration)],
    )
}

/// Hits of equal length with arbitrary samples.
pub(crate) fn any_hits(least: usize) -> impl Strategy<Value = (Vec<Record>, f64)> {
    let rate = prop_oneof![1e-3..1e7_f64, Just(51_200.0), Just(1.0 / 3.0)];
    (4..90_usize, least..7, rate).prop_flat_map(|(n, hits, rate)| {
        let row = || prop::collection::vec(-1e3..1e3_f64, n);
        prop::collection::vec((row(), row()), hits).prop_map(move |hits| {
            let hits = hits.iter().map(|(x, y)| record([x, y], rate)).collect();
            (hits, rate)
        })
    })
}

pub(crate) fn averaged(hits: &[Record]) -> AveragedSpectra {
    AveragedSpectra::of(hits, Window::Rectangular).unwrap()
}
