//! Bodies joined at points into one body with one impact face.
//!
//! Theory: `docs/theory/assemblies.md`.

mod incidence;
mod measured_points;
mod substructure;

use std::fmt;

use num_complex::Complex64;

use self::incidence::{Incidence, schur_complement};
use crate::error::{check_not_negative, check_spacing};
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

/// A joint between two points: rigid, or a spring and a dashpot in parallel. It transmits
/// compression and tension.
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

    /// Creates a joint by a massless spring of this `stiffness` [N/m] and, in parallel, a dashpot
    /// of this `resistance` [kg/s]; either may be 0.
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
}

impl Coupling {
    /// Relative velocity of the two points over the force of the joint \[m/(N s)\].
    fn mobility(&self, s: Complex64) -> Complex64 {
        match *self {
            Self::Rigid => Complex64::ZERO,
            Self::Compliant {
                stiffness,
                resistance,
            } => s / (stiffness + s * resistance),
        }
    }

    /// Returns the mobility at infinite frequency; `None` for a spring without a dashpot, which
    /// transmits no force there.
    fn mobility_of_front(&self) -> Option<f64> {
        match *self {
            Self::Rigid => Some(0.0),
            Self::Compliant { resistance, .. } if resistance > 0.0 => Some(1.0 / resistance),
            Self::Compliant { .. } => None,
        }
    }
}

/// Members joined at their points, as an [`ImpactBody`] that is struck at one of the points.
///
/// With the mobilities Y of all points of all members (block-diagonal) and one row of B per joint,
/// 1 at its first point and -1 at its second,
///
/// ```math
/// Y_\mathrm{joined} = Y - Y B^T \left(B Y B^T + Y_\mathrm{joints}\right)^{-1} B Y
/// ```
///
/// (Jetmundsen, Bielawa & Flannelly 1988; de Klerk, Rixen & de Jong 2006). Forces, velocities and
/// joints are along one axis, the axis of the impact.
///
/// # Validity
///
/// The joints transmit tension. The mobility of the assembly is known where the mobilities of all
/// members are known. If a member is known on lines, the free vibrations of the assembly must decay
/// within a period of the lines, and time marching needs a known front impedance at the struck
/// point.
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
    /// Rows of the two points of each joint.
    joints: Vec<([usize; 2], Coupling)>,
    /// Row of the struck point.
    face: usize,
    incidence: Incidence,
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
        let domain = common_domain(&members)?;
        let row = |point, place| row(&members, point, place);
        let struck = row(face, "the struck point")?;
        let mut placed = Vec::with_capacity(joints.len());
        for joint in joints {
            let [one, other] = joint.between;
            let rows = [
                row(one, "one side of a joint")?,
                row(other, "the other side of a joint")?,
            ];
            if one == other {
                return Err(ImpulseError::NoSuchPoint {
                    place: "the other side of a joint",
                    member: other.member,
                    point: other.point,
                    expected: "a point other than that of the first side",
                });
            }
            placed.push((rows, joint.coupling));
        }
        check_joined(members.len(), joints, face.member)?;
        let rows: Vec<[usize; 2]> = placed.iter().map(|(rows, _)| *rows).collect();
        let n_points: Vec<usize> = members.iter().map(|member| member.n_points()).collect();
        Ok(Self {
            members,
            joints: placed,
            face: struck,
            incidence: Incidence::of(&n_points, &rows, struck),
            domain,
        })
    }

    /// Returns the mobility of the struck point, from the mobilities of the members, which
    /// `of_member` writes, and of the joints; a joint with `None` has no force.
    #[allow(
        clippy::indexing_slicing,
        reason = "the mobilities are those of `Incidence`, and the matrix has one row per joint and one more"
    )]
    fn joined(
        &self,
        mut of_member: impl FnMut(&SharedSubstructure, &mut [Complex64]) -> Result<(), ImpulseError>,
        of_joint: impl Fn(&[usize; 2], &Coupling) -> Option<Complex64>,
    ) -> Result<Complex64, ImpulseError> {
        let size = self.joints.len() + 1;
        let mut workspace = vec![Complex64::ZERO; self.incidence.n_entries + size * size];
        let (mobilities, bordered) = workspace.split_at_mut(self.incidence.n_entries);
        let mut rest = &mut *mobilities;
        for member in &self.members {
            let (own, others) = std::mem::take(&mut rest).split_at_mut(member.n_points().pow(2));
            of_member(member, own)?;
            rest = others;
        }
        for (value, terms) in bordered.iter_mut().zip(&self.incidence.terms) {
            let terms = terms.iter();
            *value = terms.map(|(entry, sign)| mobilities[*entry] * sign).sum();
        }
        for (row, (rows, coupling)) in self.joints.iter().enumerate() {
            if let Some(mobility) = of_joint(rows, coupling) {
                bordered[row * size + row] += mobility;
            } else {
                for other in 0..size {
                    bordered[row * size + other] = Complex64::ZERO;
                    bordered[other * size + row] = Complex64::ZERO;
                }
                bordered[row * size + row] = Complex64::ONE;
            }
        }
        Ok(schur_complement(bordered, size))
    }

    /// Returns 1/Z of the struck point, if it is known for all members that share the point.
    fn front_conductance(&self) -> Option<f64> {
        let of_member = |member: &SharedSubstructure, own: &mut [Complex64]| {
            let points = member.n_points();
            for (point, entry) in own.iter_mut().step_by(points + 1).enumerate() {
                // no wave has arrived from the other points; NaN where the conductance is unknown
                *entry = member.front_conductance(point).unwrap_or(f64::NAN).into();
            }
            Ok(())
        };
        // only joints at the struck point change its front impedance
        let at_face = |rows: &[usize; 2], coupling: &Coupling| {
            let mobility = coupling.mobility_of_front()?;
            rows.contains(&self.face).then_some(mobility.into())
        };
        let value = self.joined(of_member, at_face).ok()?.re;
        value.is_finite().then_some(value.max(0.0))
    }
}

/// Row of a point in the matrix of the mobilities of all points.
fn row(
    members: &[SharedSubstructure],
    point: Point,
    place: &'static str,
) -> Result<usize, ImpulseError> {
    let before = members.iter().take(point.member);
    let before: usize = before.map(|member| member.n_points()).sum();
    let expected = match members.get(point.member) {
        Some(member) if point.point < member.n_points() => return Ok(before + point.point),
        Some(_) => "one of the points of the member",
        None => "one of the members",
    };
    Err(ImpulseError::NoSuchPoint {
        place,
        member: point.member,
        point: point.point,
        expected,
    })
}

/// Accepts joints that connect every member to the `struck` one.
fn check_joined(n_members: usize, joints: &[Joint], struck: usize) -> Result<(), ImpulseError> {
    let mut is_reached = vec![false; n_members];
    let mut found = vec![struck];
    while let Some(member) = found.pop() {
        match is_reached.get_mut(member) {
            Some(reached) if !*reached => *reached = true,
            _ => continue,
        }
        for joint in joints {
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

/// Laplace variable [1/s] used instead of 0: far below the rate at which any dashpot stops a mass.
const NEAR_REST: Complex64 = Complex64::new(1e-3, 0.0);

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
                check_spacing("measured member", found_hz, expected_hz)?;
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
        // at 0 Hz the mobility of a free member is infinite; near 0 it is that of a rigid mass
        let at = if s == Complex64::ZERO && self.free_mass().is_none() {
            NEAR_REST
        } else {
            s
        };
        let of_member = |member: &SharedSubstructure, own: &mut [Complex64]| {
            if at != s
                && let Some(mass) = member.free_mass()
            {
                own.fill(1.0 / (at * mass));
                return Ok(());
            }
            member.write_mobilities(s, own)
        };
        let mobility = self.joined(of_member, |_, coupling| Some(coupling.mobility(at)))?;
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
