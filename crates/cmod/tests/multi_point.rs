//! Gauges on a member of a structure. The strains come from a chain of rod, beams and lump by its
//! impedances, which shares nothing with the two waves that the methods look for.

mod advice;
mod coverage;
mod exact;
mod frame;
mod free_end;
mod refusals;
