//! Materials and bodies as sheets state them, or as earlier results have them.

pub mod face;
pub mod material;
pub mod material_sheet;
pub mod measured;
pub(crate) mod measured_material;
pub(crate) mod replacement;
