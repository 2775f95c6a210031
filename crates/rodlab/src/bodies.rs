//! Materials and bodies that a sheet states or takes from earlier results.

pub mod face;
pub mod material;
pub mod material_sheet;
pub mod measured;
pub(crate) mod measured_material;
pub(crate) mod replacement;
