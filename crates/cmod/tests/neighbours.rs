//! Free end with two sections, separate pulses, one gauge and a free end, resonances: on rods whose
//! motion comes from the recursion of impedances along a chain, which shares nothing with the
//! equations that are inverted.

mod comparison;
mod errors;
mod exactness;
mod few_hits;
mod methods;
mod rod;
mod systematic;
