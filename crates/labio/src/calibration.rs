//! Conversion of a channel's volts to the quantity that its sensor measured.
//!
//! Theory: `docs/theory/hits.md#sensor-calibration`.

mod blocks;
mod bridge;
mod date;
mod rating;
mod sensor_chain;
mod sensor_error;

pub use blocks::CalibratedBlocks;
pub use bridge::{BridgeLayout, StrainBridge};
pub use date::Date;
pub use rating::Rating;
pub use sensor_chain::{Direction, Polarity, Position, SensorChain, Transducer};
pub use sensor_error::SensorError;
