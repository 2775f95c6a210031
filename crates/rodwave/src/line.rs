//! Bodies in a line, in the time domain: segments of any material and area, ends of any kind, and
//! unilateral contacts.
//!
//! # Problem
//! Each [`Segment`] obeys ∂σ/∂x = ρ ∂v/∂t and, for every branch of its material, ∂σᵢ/∂t = Eᵢ
//! (∂v/∂x - Fᵢ(σᵢ)), σ = Σ σᵢ. A [`Body`] is a chain of bonded segments, a [`Line`] a series of
//! bodies with contacts between them; both [`End`]s of the line are free, fixed, driven, loaded by
//! a mass or damped. The results are histories at gauges, which may be at any section.
//!
//! # Method
//! The waves R = s - v and L = s + v, s = σ/Z, travel one cell per step (Courant number 1) in every
//! segment: the time step is common, but each material has its own cell length, so that fast
//! neighbours do not increase the cost of slow materials ([`Grid`]). Values are at the centres of
//! cells; ends and contacts are half a cell from the nearest centre, and are solved half a step
//! later with the arriving waves. Relaxation is split off symmetrically (Strang) and is exact for
//! each branch. The scheme is stable for any law, and [`Ledger`] balances to rounding on any grid.
//!
//! # Accuracy
//! If all segments have whole numbers of cells, the scheme is exact for elastic lines, second order
//! for smooth histories, and first order after jumps. In other lines, the wave speeds are rounded
//! by at most [`Grid::largest_rounding`]; this is at most 1e-3 unless
//! [`Line::with_speed_tolerance`] sets another limit. Rounding adds errors of 2e-4 to 9e-4 of the
//! largest value; they decrease with the tolerance but not with the step. A smaller tolerance needs
//! more cells, up to 64 times as many; if these do not suffice, it is rejected. The force of a
//! contact is given per whole step; [`ContactHistory::opens`] gives the end of the contact within a
//! step.
//!
//! The grid differs from that of [`crate::characteristics`], which has nodes at the ends. The two
//! solvers therefore verify each other.
//!
//! # Derivatives
//! The tangent-linear model is integrated in the same sweep: derivatives of every gauge, end and
//! contact with respect to ln Eᵢ and all parameters of all laws ([`Line::parameters`]). A modulus
//! changes impedances, shares of branches, relaxation, and the wave speed. On a fixed grid, the
//! change of the wave speed shifts the waves by ∓½ c dt ∂/∂x per step, which is computed by
//! differences of second order in the cell length. The derivative with respect to ln E is therefore
//! accurate to second order; the derivatives with respect to the parameters of the law are the
//! exact derivatives of the scheme. Where a contact opens or closes, the derivative assumes a fixed
//! sequence of open and closed states.
//!
//! ```
//! use rodwave::line::{Body, End, Gauge, Line, Segment};
//! use rodwave::inelastic::Maxwell;
//!
//! // a steel striker, 5 m/s, on a polyamide rod; strain and velocity 0.3 m from the face
//! let area = 2e-4;
//! let striker = Body::new([Segment::elastic(0.10, area, 7780.0, 206e9)?])?.moving_at(5.0)?;
//! let rod = Body::new([Segment::new(0.8, area, 1140.0)?.with_branch(3.2e9, Maxwell::new(4e6)?)?])?;
//! let history = Line::new([striker, rod])?.run(1e-6, 0.6e-3, &[Gauge { body: 1, position: 0.3 }])?;
//! assert!(history.contacts[0].force[0] > 0.0);
//! let ledger = history.ledger;
//! assert!(ledger.energy_residual().abs() < 1e-12 * ledger.initial_energy);
//! assert!(ledger.momentum_residual().abs() < 1e-12 * ledger.initial_momentum);
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! Theory: `docs/theory/lines.md`.

mod bar;
mod branch;
mod cell_strains;
mod diagram;
mod end;
mod gauge;
mod grid;
mod history;
mod junction;
mod ledger;
mod march;
mod segment;
mod tangent;

pub use diagram::Diagram;
pub use end::{Drive, End};
pub use gauge::{Gauge, Reading};
pub use grid::Grid;
pub use history::{ContactHistory, Derivatives, EndHistory, LineHistory, SectionHistory};
pub use ledger::Ledger;
pub use march::{EndState, March};
pub use segment::Segment;
pub use tangent::{LN_MODULUS, Parameter};

use crate::RodwaveError;
use crate::error::{check_finite, check_length, check_not_negative, check_positive};

/// Name of this solver in the provenance of virtual records.
pub const GENERATOR: &str = "rodwave::line";

/// Body of bonded segments, from left to right.
#[derive(Debug, Clone)]
pub struct Body {
    segments: Vec<Segment>,
    velocity: f64,
}

impl Body {
    /// Creates a body at rest.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] if there is no segment; [`RodwaveError::InElement`] for a
    /// segment without a branch.
    pub fn new(segments: impl IntoIterator<Item = Segment>) -> Result<Self, RodwaveError> {
        let segments: Vec<Segment> = segments.into_iter().collect();
        check_length("list of segments of a body", segments.len().min(1), 1)?;
        for (index, segment) in segments.iter().enumerate() {
            segment.check().map_err(|error| error.in_element(index))?;
        }
        Ok(Self {
            segments,
            velocity: 0.0,
        })
    }

    /// Sets the velocity [m/s] along x at time 0.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless it is finite.
    pub fn moving_at(self, velocity: f64) -> Result<Self, RodwaveError> {
        Ok(Self {
            velocity: check_finite("velocity of a body [m/s]", velocity)?,
            ..self
        })
    }

    /// Segments of the body.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Length \[m\].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.segments.iter().map(Segment::length).sum()
    }

    /// Mass \[kg\].
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.segments.iter().map(Segment::mass).sum()
    }
}

/// Bodies in series along x, with unilateral contacts between neighbours.
#[derive(Debug, Clone)]
pub struct Line {
    bodies: Vec<Body>,
    gaps: Vec<f64>,
    left: End,
    right: End,
    speed_tolerance: f64,
}

impl Line {
    /// Creates a line of bodies that touch without force, with free ends.
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] if there is no body.
    pub fn new(bodies: impl IntoIterator<Item = Body>) -> Result<Self, RodwaveError> {
        let bodies: Vec<Body> = bodies.into_iter().collect();
        check_length("list of bodies of a line", bodies.len().min(1), 1)?;
        Ok(Self {
            gaps: vec![0.0; bodies.len() - 1],
            bodies,
            left: End::Free,
            right: End::Free,
            speed_tolerance: grid::DEFAULT_SPEED_TOLERANCE,
        })
    }

    /// Sets the initial `gap` \[m\] after body `index`.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless the gap is finite and not negative;
    /// [`RodwaveError::LengthMismatch`] if there is no such contact.
    pub fn with_gap(mut self, index: usize, gap: f64) -> Result<Self, RodwaveError> {
        check_not_negative("gap [m]", gap)?;
        let contacts = self.gaps.len();
        match self.gaps.get_mut(index) {
            Some(slot) => *slot = gap,
            None => {
                return Err(RodwaveError::LengthMismatch {
                    what: "list of contacts",
                    found: contacts,
                    expected: index.saturating_add(1),
                });
            }
        }
        Ok(self)
    }

    /// Sets the condition at the left end.
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] for a mass or a resistance that is not finite and above 0.
    pub fn with_left_end(self, left: End) -> Result<Self, RodwaveError> {
        left.check()?;
        Ok(Self { left, ..self })
    }

    /// Sets the condition at the right end.
    ///
    /// # Errors
    /// The errors of [`Self::with_left_end`].
    pub fn with_right_end(self, right: End) -> Result<Self, RodwaveError> {
        right.check()?;
        Ok(Self { right, ..self })
    }

    /// Sets the largest relative change of a wave speed that is allowed in order to make numbers of
    /// cells whole (default 1e-3).
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] unless it is finite and above 0.
    pub fn with_speed_tolerance(self, tolerance: f64) -> Result<Self, RodwaveError> {
        Ok(Self {
            speed_tolerance: check_positive("tolerance of wave speeds", tolerance)?,
            ..self
        })
    }

    /// All segments from the left end.
    pub fn segments(&self) -> impl Iterator<Item = &Segment> {
        self.bodies.iter().flat_map(|body| &body.segments)
    }

    /// Returns all parameters for which derivatives are available: ln Eᵢ and the parameters of the
    /// law of each branch of each segment.
    #[must_use]
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = Vec::new();
        for (segment, of) in self.segments().enumerate() {
            for (branch, of) in of.branches().iter().enumerate() {
                let names = std::iter::once(&LN_MODULUS).chain(of.law.parameters());
                parameters.extend(names.map(|name| Parameter {
                    segment,
                    branch,
                    name,
                }));
            }
        }
        parameters
    }

    /// Returns a grid whose time step is at most `longest_step` \[s\].
    ///
    /// # Errors
    /// [`RodwaveError::NonPhysical`] for a step that is not finite and positive, or if no step
    /// gives whole numbers of cells within the tolerance; [`RodwaveError::InElement`] for a
    /// segment whose transit time is 0 or infinite in floating point.
    pub fn grid(&self, longest_step: f64) -> Result<Grid, RodwaveError> {
        check_positive("time step [s]", longest_step)?;
        let times: Vec<f64> = self.segments().map(Segment::transit_time).collect();
        Grid::of(&times, longest_step, self.speed_tolerance)
    }

    /// Starts the march at time 0 on a grid whose time step is at most `longest_step` \[s\].
    ///
    /// # Errors
    /// The errors of [`Self::grid`].
    pub fn march(&self, longest_step: f64) -> Result<March, RodwaveError> {
        March::new(self, longest_step, &[], &[])
    }

    /// Computes the histories at `gauges` until `duration` \[s\], on a grid whose time step is at
    /// most `longest_step` \[s\].
    ///
    /// # Errors
    /// The errors of [`Self::grid`] and [`March::advance`]; [`RodwaveError::OutsideBody`] for a
    /// gauge outside its body, [`RodwaveError::NonPhysical`] for more than 1e9 steps.
    pub fn run(
        &self,
        longest_step: f64,
        duration: f64,
        gauges: &[Gauge],
    ) -> Result<LineHistory, RodwaveError> {
        self.run_with_derivatives(longest_step, duration, gauges, &[])
    }

    /// [`Self::run`] with the derivatives of all histories with respect to `parameters`, in one
    /// sweep.
    ///
    /// # Errors
    /// The errors of [`Self::run`]; [`RodwaveError::UnknownParameter`] for a parameter that is not
    /// among [`Self::parameters`].
    pub fn run_with_derivatives(
        &self,
        longest_step: f64,
        duration: f64,
        gauges: &[Gauge],
        parameters: &[Parameter],
    ) -> Result<LineHistory, RodwaveError> {
        check_positive("duration [s]", duration)?;
        let march = March::new(self, longest_step, gauges, parameters)?;
        LineHistory::record(march, duration, self.gaps.len(), parameters)
    }

    /// Computes the histories of every cell until `duration` \[s\], at every `stride`-th time
    /// level, on a grid whose time step is at most `longest_step` \[s\].
    ///
    /// # Errors
    /// The errors of [`Self::run`]; [`RodwaveError::NonPhysical`] for a stride of 0 or more than
    /// 2^27 values of a quantity.
    ///
    /// ```
    /// use rodwave::line::{Body, Line, Segment};
    ///
    /// // one of two equal bars moves and hits the other; a wave then crosses half of each bar
    /// let bar = || Body::new([Segment::elastic(0.5, 2e-4, 7800.0, 206e9)?]);
    /// let line = Line::new([bar()?.moving_at(4.0)?, bar()?])?;
    /// let crossing = 0.5 / (206e9_f64 / 7800.0).sqrt();
    /// let diagram = line.diagram(0.01 * crossing, 0.5 * crossing, 10)?;
    /// let last = diagram.at(&diagram.velocity, diagram.times.len() - 1);
    /// let at = |x: f64| diagram.positions.iter().position(|p| *p > x).map(|cell| last[cell]);
    /// assert_eq!(at(0.2), Some(4.0)); // the wave has not arrived here
    /// assert!(at(0.45).is_some_and(|v| (v - 2.0).abs() < 1e-12)); // half the velocity of the striker
    /// # Ok::<(), rodwave::RodwaveError>(())
    /// ```
    pub fn diagram(
        &self,
        longest_step: f64,
        duration: f64,
        stride: usize,
    ) -> Result<Diagram, RodwaveError> {
        check_positive("duration [s]", duration)?;
        let march = self.march(longest_step)?;
        let places = self.places(march.grid());
        Diagram::record(march, places, duration, stride)
    }

    /// Returns the body of every cell and the position \[m\] of its centre, with the gaps at the
    /// start.
    fn places(&self, grid: &Grid) -> Vec<(usize, f64)> {
        let mut places = Vec::with_capacity(grid.cells.iter().sum());
        let mut counts = grid.cells.iter();
        let mut begin = 0.0;
        for (index, body) in self.bodies.iter().enumerate() {
            for (segment, cells) in body.segments.iter().zip(&mut counts) {
                let length = segment.length() / *cells as f64;
                let centres = (0..*cells).map(|cell| begin + (cell as f64 + 0.5) * length);
                places.extend(centres.map(|centre| (index, centre)));
                begin += segment.length();
            }
            begin += self.gaps.get(index).copied().unwrap_or(0.0);
        }
        places
    }

    /// Returns the segment of a gauge, counted from the left end of the line, and the distance of
    /// the gauge from the left end of that segment.
    fn locate(&self, gauge: Gauge) -> Result<(usize, f64), RodwaveError> {
        let Some(body) = self.bodies.get(gauge.body) else {
            return Err(RodwaveError::LengthMismatch {
                what: "list of bodies of a line",
                found: self.bodies.len(),
                expected: gauge.body.saturating_add(1),
            });
        };
        let length = body.length();
        // rounding of a sum of lengths may put the gauge beyond the end of a body
        if !(gauge.position >= 0.0 && gauge.position <= length * (1.0 + 1e-12)) {
            return Err(RodwaveError::OutsideBody {
                what: "a gauge",
                position: gauge.position,
                length,
            });
        }
        let before: usize = self
            .bodies
            .iter()
            .take(gauge.body)
            .map(|b| b.segments.len())
            .sum();
        let last = body.segments.len() - 1;
        let mut left = gauge.position;
        for (index, segment) in body.segments.iter().enumerate() {
            if left < segment.length() || index == last {
                return Ok((before + index, left));
            }
            left -= segment.length();
        }
        Ok((before + last, left))
    }
}
