//! Bodies joined at points to one body with one impact face.
//!
//! Theory: `docs/theory/assemblies.md`.

mod measured_points;
mod substructure;

use std::fmt;

use faer::Mat;
use faer::linalg::solvers::Solve;
use num_complex::Complex64;

use crate::error::check_not_negative;
use crate::{Domain, ImpactBody, ImpulseError};

pub use measured_points::MeasuredPoints;
pub use substructure::{AtFace, SharedSubstructure, Substructure};

/// A point of a member of an [`Assembly`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Point {
    /// Index of the member.
    pub member: usize,
    /// Index of the point of the member.
    pub point: usize,
}

impl Point {
    /// Creates the point `point` of the member `member`, both counted from 0.
    #[must_use]
    pub fn of(member: usize, point: usize) -> Self {
        Self { member, point }
    }
}

/// A joint between two points, rigid or a spring with a dashpot beside it. It bears pressure and
/// tension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    between: [Point; 2],
    coupling: Coupling,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Coupling {
    Rigid,
    Compliant { stiffness: f64, resistance: f64 },
}

impl Joint {
    /// Creates a rigid joint.
    #[must_use]
    pub fn rigid(one: Point, other: Point) -> Self {
        Self {
            between: [one, other],
            coupling: Coupling::Rigid,
        }
    }

    /// Creates a joint by a massless spring of this `stiffness` [N/m] and, in parallel, a dashpot of
    /// this `resistance` [kg/s]; either may be 0.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NonPhysical`] for a value that is negative or not finite, and if both are 0.
    pub fn compliant(
        one: Point,
        other: Point,
        stiffness: f64,
        resistance: f64,
    ) -> Result<Self, ImpulseError> {
        check_not_negative("stiffness of a joint [N/m]", stiffness)?;
        check_not_negative("resistance of a joint [kg/s]", resistance)?;
        if stiffness + resistance <= 0.0 {
            return Err(ImpulseError::NonPhysical {
                quantity: "stiffness and resistance of a joint",
                value: 0.0,
                expected: "one of them above 0",
            });
        }
        Ok(Self {
            between: [one, other],
            coupling: Coupling::Compliant {
                stiffness,
                resistance,
            },
        })
    }

    /// Relative velocity of the two points over the force of the joint \[m/(N s)\].
    fn mobility(&self, s: Complex64) -> Complex64 {
        match self.coupling {
            Coupling::Rigid => Complex64::ZERO,
            Coupling::Compliant {
                stiffness,
                resistance,
            } => s / (stiffness + s * resistance),
        }
    }

    /// The same at infinite frequency; `None` for a spring alone, which then bears no force.
    fn mobility_of_front(&self) -> Option<f64> {
        match self.coupling {
            Coupling::Rigid => Some(0.0),
            Coupling::Compliant { resistance, .. } if resistance > 0.0 => Some(1.0 / resistance),
            Coupling::Compliant { .. } => None,
        }
    }
}

/// Members joined at their points, seen from one point, which is struck: an [`ImpactBody`].
///
/// With the mobilities Y of all points of all members (block-diagonal) and one row of B per joint,
/// 1 at its first point and -1 at its second,
///
/// ```math
/// Y_\mathrm{joined} = Y - Y B^T \left(B Y B^T + Y_\mathrm{joints}\right)^{-1} B Y
/// ```
///
/// (Jetmundsen, Bielawa & Flannelly 1988; de Klerk, Rixen & de Jong 2006). Forces, velocities and
/// joints are along one axis, that of the impact.
///
/// # Validity
///
/// The joints bear tension. Members, apart from those on lines, are known in their own domains; the
/// assembly is known where all of them are. If a member is on lines, its free vibrations in the
/// assembly must decay within a period of them, and the struck point needs a known front impedance
/// for a march.
///
/// ```
/// use std::sync::Arc;
///
/// use impulse::{Assembly, AtFace, Impact, Joint, MobilityLaw, Point};
/// use rodwave::chain::{AnalyticChain, Termination};
/// use rodwave::element::Circle;
/// use rodwave::medium::Medium;
/// use rodwave::modulus::Elastic;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // a drill rod of 3 m with a bit of 1 kg, pressed on rock of 200 MN/m
/// let steel = Medium::new(7800.0, Elastic::new(206e9)?)?;
/// let circle = Circle::of_diameter(0.032)?;
/// let rod = AnalyticChain::analytic_from_impact_face()
///     .rod(&steel, circle, 3.0)
///     .end(Termination::Free)?;
/// let bit = MobilityLaw::analytic(|s| 1.0 / (1.0 * s)).free(1.0)?;
/// let [end, on_bit, ground] = [Point::of(0, 1), Point::of(1, 0), Point::of(2, 0)];
/// let string = Assembly::of(
///     vec![Arc::new(rod), Arc::new(AtFace::of(bit)), Arc::new(AtFace::ground())],
///     &[Joint::rigid(end, on_bit), Joint::compliant(on_bit, ground, 200e6, 2e4)?],
///     Point::of(0, 0),
/// )?;
/// // struck by 0.5 m of the same rod: Z V/2, until the wave is back from the bit
/// let piston = AnalyticChain::analytic_from_impact_face()
///     .rod(&steel, circle, 0.5)
///     .end(Termination::Free)?;
/// let force = Impact::between(&piston, &string).at_velocity(10.0).predict(1e-3)?;
/// let impedance = (206e9_f64 * 7800.0).sqrt() * 8.0425e-4;
/// assert!((force.peak().force / (0.5 * 10.0 * impedance) - 1.0).abs() < 1e-3);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Assembly {
    members: Vec<SharedSubstructure>,
    /// Row of the first point of each member.
    first_rows: Vec<usize>,
    n_rows: usize,
    joints: Vec<Joint>,
    face: Point,
    domain: Domain,
}

impl fmt::Debug for Assembly {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let domains: Vec<Domain> = self.members.iter().map(|member| member.domain()).collect();
        formatter
            .debug_struct("Assembly")
            .field("members", &domains)
            .field("joints", &self.joints)
            .field("face", &self.face)
            .finish()
    }
}

impl Assembly {
    /// Joins `members` by `joints`, to be struck at the point `face`.
    ///
    /// # Errors
    ///
    /// [`ImpulseError::NoSuchPoint`], also for a joint of a point with itself;
    /// [`ImpulseError::NotJoined`] for a member that is not joined to the struck one;
    /// [`ImpulseError::GridMismatch`] for members on lines of different spacing.
    pub fn of(
        members: Vec<SharedSubstructure>,
        joints: &[Joint],
        face: Point,
    ) -> Result<Self, ImpulseError> {
        let mut n_rows = 0;
        let first_rows = members.iter().map(|member| {
            let first = n_rows;
            n_rows += member.n_points();
            first
        });
        let first_rows = first_rows.collect();
        let domain = common_domain(&members)?;
        let assembly = Self {
            members,
            first_rows,
            n_rows,
            joints: joints.to_vec(),
            face,
            domain,
        };
        assembly.row(face, "the struck point")?;
        for joint in joints {
            let [one, other] = joint.between;
            assembly.row(one, "one side of a joint")?;
            assembly.row(other, "the other side of a joint")?;
            if one == other {
                return Err(ImpulseError::NoSuchPoint {
                    place: "the other side of a joint",
                    member: other.member,
                    point: other.point,
                    expected: "a point other than that of the first side",
                });
            }
        }
        assembly.check_joined()?;
        Ok(assembly)
    }

    /// Row of a point in the matrix of all mobilities.
    fn row(&self, point: Point, place: &'static str) -> Result<usize, ImpulseError> {
        let member = self.members.get(point.member);
        let first = self.first_rows.get(point.member);
        match (member, first) {
            (Some(member), Some(first)) if point.point < member.n_points() => {
                Ok(first + point.point)
            }
            (found, _) => Err(ImpulseError::NoSuchPoint {
                place,
                member: point.member,
                point: point.point,
                expected: match found {
                    Some(_) => "one of the points of the member",
                    None => "one of the members",
                },
            }),
        }
    }

    /// Every member must be reached from the struck one.
    fn check_joined(&self) -> Result<(), ImpulseError> {
        let mut is_reached = vec![false; self.members.len()];
        let mut found = vec![self.face.member];
        while let Some(member) = found.pop() {
            match is_reached.get_mut(member) {
                Some(reached) if !*reached => *reached = true,
                _ => continue,
            }
            for joint in &self.joints {
                let [one, other] = joint.between.map(|point| point.member);
                if one == member {
                    found.push(other);
                } else if other == member {
                    found.push(one);
                }
            }
        }
        match is_reached.iter().position(|reached| !reached) {
            Some(member) => Err(ImpulseError::NotJoined { member }),
            None => Ok(()),
        }
    }

    /// The mobility of the struck point, from the mobilities `y` of all points and those of the
    /// `joints`, of which those that are `None` bear no force.
    fn joined(
        &self,
        y: &Mat<Complex64>,
        joints: impl Fn(&Joint) -> Option<Complex64>,
    ) -> Result<Complex64, ImpulseError> {
        let face = self.row(self.face, "the struck point")?;
        let mut bearing = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            if let Some(mobility) = joints(joint) {
                let [one, other] = joint.between;
                let rows = [self.row(one, "a joint")?, self.row(other, "a joint")?];
                bearing.push((rows, mobility));
            }
        }
        if bearing.is_empty() {
            return Ok(y[(face, face)]);
        }
        // B Y e of the struck point, and B Y Bᵀ with the joints
        let across =
            |[one, other]: [usize; 2], column: usize| y[(one, column)] - y[(other, column)];
        let opened = Mat::from_fn(bearing.len(), 1, |i, _| {
            bearing
                .get(i)
                .map_or(Complex64::ZERO, |(rows, _)| across(*rows, face))
        });
        let matrix = Mat::from_fn(bearing.len(), bearing.len(), |i, k| {
            let (Some((rows, mobility)), Some((columns, _))) = (bearing.get(i), bearing.get(k))
            else {
                return Complex64::ZERO;
            };
            let of_members = across(*rows, columns[0]) - across(*rows, columns[1]);
            if i == k {
                of_members + mobility
            } else {
                of_members
            }
        });
        let forces = matrix.partial_piv_lu().solve(&opened);
        // Y is symmetric: e Y Bᵀ is (B Y e)ᵀ
        let relief: Complex64 = (0..bearing.len())
            .map(|i| opened[(i, 0)] * forces[(i, 0)])
            .sum();
        Ok(y[(face, face)] - relief)
    }

    /// Mobilities of all points.
    fn mobilities(
        &self,
        of_member: impl Fn(&SharedSubstructure) -> Result<Mat<Complex64>, ImpulseError>,
    ) -> Result<Mat<Complex64>, ImpulseError> {
        let mut all = Mat::zeros(self.n_rows, self.n_rows);
        for (member, first) in self.members.iter().zip(&self.first_rows) {
            let own = of_member(member)?;
            for k in 0..own.ncols() {
                for i in 0..own.nrows() {
                    all[(first + i, first + k)] = own[(i, k)];
                }
            }
        }
        Ok(all)
    }

    /// 1/Z of the struck point, if it is known of all members that share it.
    fn front_conductance(&self) -> Option<f64> {
        let fronts = self.mobilities(|member| {
            let points = member.n_points();
            let mut own = Mat::zeros(points, points);
            for point in 0..points {
                // no wave has come from the other points; NaN where it is unknown
                let known = member.front_conductance(point).unwrap_or(f64::NAN);
                own[(point, point)] = known.into();
            }
            Ok(own)
        });
        let fronts = fronts.ok()?;
        // only joints at the struck point share its front
        let at_face = |joint: &Joint| {
            let mobility = joint.mobility_of_front()?;
            joint
                .between
                .contains(&self.face)
                .then_some(mobility.into())
        };
        let value = self.joined(&fronts, at_face).ok()?.re;
        value.is_finite().then_some(value.max(0.0))
    }
}

/// Laplace variable [1/s] in place of 0: far below the rate at which any dashpot stops a mass.
const NEAR_REST: Complex64 = Complex64::new(1e-3, 0.0);

/// The domain in which all members are known.
fn common_domain(members: &[SharedSubstructure]) -> Result<Domain, ImpulseError> {
    let mut common = Domain::RightHalfPlane;
    for member in members {
        common = match (common, member.domain()) {
            (
                Domain::Lines {
                    frequency_step_hz: expected_hz,
                    n_lines: one,
                },
                Domain::Lines {
                    frequency_step_hz: found_hz,
                    n_lines: other,
                },
            ) => {
                // precision of a step computed from a sampling rate
                if (found_hz / expected_hz - 1.0).abs() > 1e-9 {
                    return Err(ImpulseError::GridMismatch {
                        what: "measured member",
                        found_hz,
                        expected_hz,
                    });
                }
                Domain::Lines {
                    frequency_step_hz: expected_hz,
                    n_lines: one.min(other),
                }
            }
            (lines @ Domain::Lines { .. }, _) | (_, lines @ Domain::Lines { .. }) => lines,
            (Domain::FrequencyAxis, _) | (_, Domain::FrequencyAxis) => Domain::FrequencyAxis,
            _ => Domain::RightHalfPlane,
        };
    }
    Ok(common)
}

impl ImpactBody for Assembly {
    fn domain(&self) -> Domain {
        self.domain
    }

    fn mobility_at(&self, s: Complex64) -> Result<Complex64, ImpulseError> {
        // at 0 Hz a free member is a rigid mass, whose mobility has no limit: near by it has
        let at = if s == Complex64::ZERO && self.free_mass().is_none() {
            NEAR_REST
        } else {
            s
        };
        let y = self.mobilities(|member| match member.free_mass() {
            Some(mass) if at != s => {
                let points = member.n_points();
                Ok(Mat::from_fn(points, points, |_, _| 1.0 / (at * mass)))
            }
            _ => member.mobilities_at(s),
        })?;
        let mobility = self.joined(&y, |joint| Some(joint.mobility(at)))?;
        if mobility.is_finite() {
            Ok(mobility)
        } else {
            Err(ImpulseError::InfiniteMobility {
                body: "assembled",
                s,
            })
        }
    }

    /// The sum of the masses, if all members are free.
    fn free_mass(&self) -> Option<f64> {
        self.members.iter().map(|member| member.free_mass()).sum()
    }

    fn front_impedance(&self) -> Option<f64> {
        match self.domain {
            Domain::Lines { .. } => Some(1.0 / self.front_conductance()?),
            _ => None,
        }
    }
}
