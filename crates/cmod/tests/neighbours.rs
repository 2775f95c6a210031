//! Free end with two sections, separate pulses, one gauge and a free end, resonances. The motion of
//! the rods is computed from the recursion of impedances along a chain, independently of the
//! equations that are inverted.

mod comparison;
mod errors;
mod exactness;
mod few_hits;
mod methods;
mod rod;
mod systematic;
