//! Part of the residual of a law that the common errors of the data do not explain.
//!
//! An error that all lines share, such as an error of the mass on the end of a rod, may distort the
//! modulus by far more than noise does, and no law of the material describes this distortion. If
//! the residual were compared with noise alone, the right law would be refused. Let the whitened
//! shifts g_s of the common errors be the columns of G, and let r be the residual at the minimum.
//! The common errors ξ that explain a part of r, and the unexplained part, follow from
//!
//! ```text
//! min_ξ |r - G⊥ξ|² + |ξ|² ,   G⊥ = G - JJ⁺G ,
//! ```
//!
//! This minimum is the least χ² of the law with the covariance I + GGᵀ, linearised in the
//! parameters and errors.

use super::data::ModulusData;
use super::fit::ErrorScale;
use super::least_squares::Linearised;
use crate::directions::Directions;
use crate::vectors::{dot, without};
use rodwave::numerics::CommonErrors;

/// Residual without the part that common errors explain.
#[derive(Debug, Clone)]
pub(super) struct Explained {
    pub(super) residual: Vec<f64>,
    /// Sum of squares of the residual, plus the sum of squares of the common errors in units of
    /// their standard uncertainties.
    pub(super) chi_squared: f64,
}

impl Explained {
    /// Returns true if the data have common errors that may explain a part of a residual.
    pub(super) fn can_explain(data: &ModulusData, scale: ErrorScale) -> bool {
        scale != ErrorScale::FromResidual && !data.common.is_empty()
    }

    /// Separates the explained part from the whitened residual of a minimum, which is given with
    /// its derivatives. If the errors of the lines are derived from the residual, the explained
    /// part is 0.
    pub(super) fn of(
        data: &ModulusData,
        linearised: &Linearised,
        information: &Directions,
        scale: ErrorScale,
    ) -> Self {
        let sources = if Self::can_explain(data, scale) {
            data.common.len()
        } else {
            0
        };
        let columns: Vec<Vec<f64>> = (0..sources)
            .map(|source| beside_the_law(&data.whitened_shift(source), linearised, information))
            .collect();
        // shifts that are not finite are omitted
        let is_finite = |column: &Vec<f64>| column.iter().all(|entry| entry.is_finite());
        let columns = columns.into_iter().filter(is_finite).collect();
        let common = CommonErrors::new(columns);
        let sizes = common.sizes(&linearised.residual);
        let residual = without(&linearised.residual, common.vectors(), &sizes);
        Self {
            chi_squared: dot(&residual, &residual) + dot(&sizes, &sizes),
            residual,
        }
    }
}

/// Returns a whitened shift without the part that a change of the parameters of the law can
/// reproduce.
fn beside_the_law(shift: &[f64], linearised: &Linearised, information: &Directions) -> Vec<f64> {
    let change = information.change(linearised, shift);
    let rows = linearised.jacobian.chunks_exact(change.len().max(1));
    let followed = rows.map(|row| dot(row, &change));
    shift
        .iter()
        .zip(followed)
        .map(|(own, law)| own - law)
        .collect()
}
