//! Gauges on a member of a structure. The strains are computed from a chain of rod, beams and lump
//! by impedances, independently of the two waves that the methods determine.

mod advice;
mod coverage;
mod exact;
mod frame;
mod free_end;
mod refusals;
mod two_roots;
