//! Detection of hits in a long record, and their assessment.
//!
//! A [`Trigger`] cuts a record or a stream into hits; [`Criteria`] check each hit; the [`HitLog`]
//! lists the hits with the reasons for every rejection and the user's final decisions. Only
//! [`HitLog::accepted`] hits enter the spectra.
//!
//! Theory: `docs/theory/hits.md`.

mod copies;
mod criteria;
mod cut_force;
mod double_hit;
mod hit_spectra;
mod hum;
mod judgement;
mod limits;
mod log;
mod odd;
mod reason;
mod rest;
mod segment;
mod settled;
mod trend;
mod trigger;
mod undershoot;
mod windowed;

pub use copies::{Copy, NearCopy, find_copy, find_near_copies};
pub use criteria::Criteria;
pub use cut_force::{CutForce, find_cut_forces};
pub use hit_spectra::HitSpectra;
pub use hum::{Hum, find_hum};
pub use limits::repeated_extreme;
pub use log::{Hit, HitLog, Ruling};
pub use odd::find_odd_hits;
pub use reason::Reason;
pub use rest::{padded, samples_at_rest};
pub use segment::{find_hits, find_hits_in_blocks};
pub use settled::samples_of_motion;
pub use trend::{Trend, find_trends};
pub use trigger::{Extent, Slope, Trigger};
pub use undershoot::{Undershoot, find_undershoot};
pub use windowed::{FallingNoise, find_falling_noise};
