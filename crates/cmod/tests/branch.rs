//! Branch tracking on virtual records, which are computed from a chain of mass, rod and mass and
//! not from the equation that is inverted.

mod adversary;
mod anchors;
mod hard_records;
mod refusals;
mod reliability;
mod rig;
mod table_1;
mod wrong_roots;
