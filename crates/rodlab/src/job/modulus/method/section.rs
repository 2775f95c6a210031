//! Sections and gauges of a rod, and the quantities measured there.

use cmod::multi_point::Quantity;
use serde::Deserialize;

use crate::sheet::{Coordinate, Exact, Stated, Time};

/// Section of a rod with a free end.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionSheet {
    /// Channel.
    pub channel: String,
    /// Distance from the free end, such as `"350 mm ± 0.5 mm"`, or `"0 mm"` for the end itself.
    pub from_free_end: Stated<Coordinate>,
    /// Quantity measured there; by default the quantity of the channel. A ratio from a file has no
    /// channels: state the quantity here.
    #[serde(default)]
    pub quantity: Option<Quantity>,
}

/// Pulse at a section.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WindowSheet {
    /// Channel.
    pub channel: String,
    /// Beginning of the pulse, measured from the beginning of a hit's record, such as `"1.2 ms"`.
    pub from: Exact<Time>,
    /// End of the pulse.
    pub to: Exact<Time>,
}

/// A gauge.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GaugeSheet {
    /// Channel.
    pub channel: String,
    /// Position along the rod, such as `"250 mm ± 0.5 mm"`.
    pub at: Stated<Coordinate>,
}

/// Returns the quantity of a channel in the form of `cmod`: strain for quantities that are
/// proportional to strain; `None` for quantities that no gauge on a rod measures.
pub(in crate::job::modulus) fn of_channel(quantity: labio::Quantity) -> Option<Quantity> {
    match quantity {
        // in a uniform bar these quantities are proportional to the strain, and the factor cancels
        labio::Quantity::Strain
        | labio::Quantity::Force
        | labio::Quantity::Pressure
        | labio::Quantity::Voltage => Some(Quantity::Strain),
        labio::Quantity::Displacement => Some(Quantity::Displacement),
        labio::Quantity::Velocity => Some(Quantity::Velocity),
        labio::Quantity::Acceleration => Some(Quantity::Acceleration),
        _ => None,
    }
}
