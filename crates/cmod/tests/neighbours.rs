//! Methods with other arrangements of sensors: two sections before a free end, separate pulses, one
//! gauge before a free end, and resonances. The motion of the rods is computed from the recursion
//! of impedances along a chain, independently of the equations that are inverted.

mod comparison;
mod errors;
mod exactness;
mod few_hits;
mod methods;
mod rod;
mod systematic;
