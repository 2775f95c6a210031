//! Split Hopkinson bars: virtual shots by characteristics in time, evaluated by
//! `impulse::hopkinson`.

mod closed_form;
mod coverage;
mod findings;
mod overlapping;
mod rig;
