//! Records from samples with names and quantities.

use labio::{Channel, Provenance, Quantity, Record};
use ndarray::Array2;

pub(crate) fn record_of(
    samples: Array2<f64>,
    rate_hz: f64,
    channels: &[(&str, Quantity)],
) -> Record {
    let channels = channels.iter();
    let channels = channels.map(|(name, quantity)| Channel::new(*name, *quantity).unwrap());
    let from = Provenance::computed("test");
    Record::new(samples, rate_hz, 0.0, channels.collect(), from).unwrap()
}
