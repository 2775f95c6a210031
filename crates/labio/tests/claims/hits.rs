//! Hits made from given samples.

use std::borrow::Borrow;

use labio::{Channel, Provenance, Quantity, Record};
use ndarray::Array2;

use testbed::claim::Fallible;

/// A record of channels of equal length.
pub(super) fn record(channels: &[(&str, Quantity, &[f64])], rate_hz: f64) -> Fallible<Record> {
    let n = channels.first().map_or(0, |(_, _, samples)| samples.len());
    let samples = Array2::from_shape_fn((channels.len(), n), |(row, n)| channels[row].2[n]);
    let names = channels
        .iter()
        .map(|(name, quantity, _)| Channel::new(*name, *quantity))
        .collect::<Result<Vec<_>, _>>()?;
    let provenance = Provenance::computed("closed form");
    Ok(Record::new(samples, rate_hz, 0.0, names, provenance)?)
}

/// A force `x` and a velocity `y`.
pub(super) fn hit(force: &[f64], velocity: &[f64], rate_hz: f64) -> Fallible<Record> {
    record(
        &[
            ("x", Quantity::Force, force),
            ("y", Quantity::Velocity, velocity),
        ],
        rate_hz,
    )
}

pub(super) fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

pub(super) fn mean(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    let add = |(sum, n): (f64, f64), x: f64| (sum + x, n + 1.0);
    let values = values.into_iter().map(|x| *x.borrow());
    let (sum, n) = values.fold((0.0, 0.0), add);
    sum / n
}
