//! Members of an assembly, described by the mobilities of their points.

use std::sync::Arc;

use num_complex::Complex64;
use rodwave::Chain;
use rodwave::chain::{AnalyticChain, FaceMobilities};

use crate::kernel::mobility_beyond;
use crate::{Domain, ImpactBody, ImpulseError, MobilityLaw};

/// A member of an [`Assembly`](super::Assembly), described by the mobilities of its points.
///
/// Implemented by [`rodwave::Chain`] and [`rodwave::chain::AnalyticChain`], whose point 0 is the
/// impact face and whose point 1 is the far face, by [`AtFace`] for any body that is joined at its
/// impact face, and by [`MeasuredPoints`](super::MeasuredPoints).
pub trait Substructure {
    /// Domain in which the mobilities are known.
    fn domain(&self) -> Domain;

    /// Number of points.
    fn n_points(&self) -> usize;

    /// Writes the mobilities \[m/(N s)\] of the points at `s` [1/s] to `mobilities`,
    /// `(n_points, n_points)` by rows: entry (i, k) is the velocity of point i divided by the force
    /// on point k, in the same direction for all points. The matrix is symmetric.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::OutsideDomain`]; errors of the member.
    fn write_mobilities(
        &self,
        s: Complex64,
        mobilities: &mut [Complex64],
    ) -> Result<(), ImpulseError>;

    /// Mass \[kg\] of a free member; `None` if it is held or semi-infinite.
    fn free_mass(&self) -> Option<f64>;

    /// $`1/Z`$ \[m/(N s)\] of a point at high frequency, if known.
    fn front_conductance(&self, point: usize) -> Option<f64>;
}

/// A member that can be shared between threads.
pub type SharedSubstructure = Arc<dyn Substructure + Send + Sync>;

/// A member with one point: a body that is joined at its impact face alone.
#[derive(Debug, Clone)]
pub struct AtFace<B>(B);

impl<B: ImpactBody> AtFace<B> {
    /// Creates a member from `body`.
    #[must_use]
    pub fn of(body: B) -> Self {
        Self(body)
    }
}

impl AtFace<MobilityLaw<fn(Complex64) -> Complex64>> {
    /// Creates the ground, which does not move.
    #[must_use]
    pub fn ground() -> Self {
        Self(MobilityLaw::analytic(|_| Complex64::ZERO))
    }
}

impl<B: ImpactBody> Substructure for AtFace<B> {
    fn domain(&self) -> Domain {
        self.0.domain()
    }

    fn n_points(&self) -> usize {
        1
    }

    fn write_mobilities(
        &self,
        s: Complex64,
        mobilities: &mut [Complex64],
    ) -> Result<(), ImpulseError> {
        mobilities.fill(self.0.mobility_at(s)?);
        Ok(())
    }

    fn free_mass(&self) -> Option<f64> {
        self.0.free_mass()
    }

    fn front_conductance(&self, _point: usize) -> Option<f64> {
        if let Some(impedance) = self.0.front_impedance() {
            return Some(1.0 / impedance);
        }
        conductance(self.0.domain(), |s| self.0.mobility_at(s))
    }
}

impl Substructure for AnalyticChain {
    fn domain(&self) -> Domain {
        ImpactBody::domain(self)
    }

    fn n_points(&self) -> usize {
        2
    }

    fn write_mobilities(
        &self,
        s: Complex64,
        mobilities: &mut [Complex64],
    ) -> Result<(), ImpulseError> {
        let faces = self.face_mobilities_at_s(s);
        mobilities.copy_from_slice(&of_faces(faces, s)?);
        Ok(())
    }

    fn free_mass(&self) -> Option<f64> {
        Self::free_mass(self)
    }

    fn front_conductance(&self, point: usize) -> Option<f64> {
        conductance(Domain::RightHalfPlane, |s| {
            let faces = of_faces(self.face_mobilities_at_s(s), s)?;
            Ok(if point == 0 { faces[0] } else { faces[3] })
        })
    }
}

impl Substructure for Chain {
    fn domain(&self) -> Domain {
        ImpactBody::domain(self)
    }

    fn n_points(&self) -> usize {
        2
    }

    fn write_mobilities(
        &self,
        s: Complex64,
        mobilities: &mut [Complex64],
    ) -> Result<(), ImpulseError> {
        mobilities.copy_from_slice(&on_axis(self, s)?);
        Ok(())
    }

    fn free_mass(&self) -> Option<f64> {
        Self::free_mass(self)
    }

    fn front_conductance(&self, point: usize) -> Option<f64> {
        conductance(Domain::FrequencyAxis, |s| {
            let faces = on_axis(self, s)?;
            Ok(if point == 0 { faces[0] } else { faces[3] })
        })
    }
}

/// Returns the mobilities of the two faces, by rows.
fn of_faces(
    faces: Result<FaceMobilities, rodwave::RodwaveError>,
    s: Complex64,
) -> Result<[Complex64; 4], ImpulseError> {
    let faces = faces.map_err(|source| ImpulseError::Body { s, source })?;
    Ok([faces.near, faces.transfer, faces.transfer, faces.far])
}

/// Returns the mobilities of the two faces of a chain that is known on the frequency axis.
fn on_axis(chain: &Chain, s: Complex64) -> Result<[Complex64; 4], ImpulseError> {
    if s.re != 0.0 {
        return Err(ImpulseError::OutsideDomain {
            s,
            expected: "an imaginary s: a law of the member is known on the frequency axis only",
        });
    }
    of_faces(chain.face_mobilities(s.im), s)
}

/// Rate [1/s] at which the front of a computed member is evaluated: in a member one centimetre long
/// the waves decay before they return.
const FRONT: f64 = 1e8;

/// Growth of the mobility over a decade above which the front counts as a massless spring.
const SPRING: f64 = 3.0;

/// Returns the front conductance of a point that is known at high frequency; `None` on lines, and
/// for a massless spring at the point.
fn conductance(
    domain: Domain,
    mobility_at: impl Fn(Complex64) -> Result<Complex64, ImpulseError>,
) -> Option<f64> {
    if matches!(domain, Domain::Lines { .. }) {
        return None;
    }
    let near = mobility_beyond(domain, FRONT, &mobility_at).ok()?;
    let far = mobility_beyond(domain, 10.0 * FRONT, &mobility_at).ok()?;
    (far.norm() <= SPRING * near.norm()).then_some(near.re)
}
