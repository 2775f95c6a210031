//! The numbers of a channel.

use super::value::Timestamp;

/// The numbers of one channel from all segments.
#[derive(Debug, Default)]
pub(super) struct Numbers {
    /// The numbers; two per complex number.
    pub(super) values: Vec<f64>,
    pub(super) complex: bool,
    /// The first time, to which the others are relative.
    pub(super) first_time: Option<Timestamp>,
    /// Numbers of DAQmx scalers, each with the scale that uses them as input.
    pub(super) scalers: Vec<(u32, Vec<f64>)>,
    pub(super) has_text: bool,
    pub(super) has_opaque: bool,
}

impl Numbers {
    pub(super) fn of_scale(&mut self, scale: u32) -> &mut Vec<f64> {
        let slot = match self.scalers.iter().position(|(known, _)| *known == scale) {
            Some(slot) => slot,
            None => {
                self.scalers.push((scale, Vec::new()));
                self.scalers.len() - 1
            }
        };
        match self.scalers.get_mut(slot) {
            Some((_, values)) => values,
            None => &mut self.values, // every slot was pushed above
        }
    }
}
