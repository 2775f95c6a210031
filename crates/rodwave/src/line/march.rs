//! Time integration of a line on its grid.

use super::bar::Bar;
use super::cell_strains::CellStrains;
use super::gauge::GaugeState;
use super::grid::Grid;
use super::junction::{Contact, Encounter, Hand, Junction, Meeting, Side, SideTangent, Terminal};
use super::ledger::Ledger;
use super::tangent::{BarTangent, Parameter, Source};
use super::{Gauge, Line};
use crate::RodwaveError;
use crate::error::{check_finite, check_steps};

/// State of a [`Line`] at one time level.
///
/// Values in cells are at whole steps, k dt; the values of ends and contacts are half a step
/// earlier, at (k - ½) dt.
#[derive(Debug, Clone)]
pub struct March {
    grid: Grid,
    bars: Vec<Bar>,
    junctions: Vec<Junction>,
    encounters: Vec<Encounter>,
    /// Tangents, indexed by parameter, then by junction.
    encounter_tangents: Vec<Vec<[Meeting; 2]>>,
    ends: [Terminal; 2],
    meetings: [Meeting; 2],
    meeting_tangents: Vec<[Meeting; 2]>,
    pub(super) gauges: Vec<GaugeState>,
    /// Strains of the cells of each bar if strains are recorded, empty otherwise.
    cell_strains: Vec<CellStrains>,
    steps: usize,
    initial_energy: f64,
    initial_momentum: f64,
    dissipated: f64,
    lost_in_contact: f64,
}

#[allow(
    clippy::indexing_slicing,
    reason = "a line has at least one segment; for each, the grid has a number of cells and the march a bar; between neighbours is one \
              junction, with one encounter; bars, encounters and ends have a tangent for each parameter, and `locate` names a segment"
)]
impl March {
    pub(super) fn new(
        line: &Line,
        longest_step: f64,
        gauges: &[Gauge],
        parameters: &[Parameter],
    ) -> Result<Self, RodwaveError> {
        let grid = line.grid(longest_step)?;
        let mut bars = Vec::new();
        let mut junctions = Vec::new();
        for (body_index, body) in line.bodies.iter().enumerate() {
            let before = body_index.checked_sub(1);
            if let Some(gap) = before.and_then(|contact| line.gaps.get(contact)) {
                junctions.push(Junction::Contact(Contact {
                    gap: *gap,
                    gap_tangents: vec![0.0; parameters.len()],
                    closed: false,
                    last: 0.0,
                }));
            }
            for (index, segment) in body.segments.iter().enumerate() {
                if index > 0 {
                    junctions.push(Junction::Bonded);
                }
                let cells = grid.cells[bars.len()];
                bars.push(Bar::new(segment, cells, grid.time_step, body.velocity));
            }
        }
        for (index, bar) in bars.iter_mut().enumerate() {
            bar.tangents = parameters
                .iter()
                .map(|parameter| {
                    let source = line.source(index, *parameter)?;
                    let rows = bar.excess.len();
                    Ok(BarTangent::new(bar.cells(), rows, &bar.fractions, source))
                })
                .collect::<Result<_, RodwaveError>>()?;
        }
        let velocity = |body: Option<&super::Body>| body.map_or(0.0, |body| body.velocity);
        let ends = [
            (Hand::Left, &line.left, velocity(line.bodies.first())),
            (Hand::Right, &line.right, velocity(line.bodies.last())),
        ]
        .map(|(hand, end, velocity)| Terminal::new(hand, end, velocity, parameters.len()));
        let gauges = gauges
            .iter()
            .map(|gauge| {
                let (segment, distance) = line.locate(*gauge)?;
                Ok(GaugeState::new(
                    &bars[segment],
                    segment,
                    distance,
                    parameters.len(),
                ))
            })
            .collect::<Result<_, RodwaveError>>()?;
        let mut march = Self {
            encounters: vec![Encounter::default(); junctions.len()],
            encounter_tangents: vec![
                vec![[Meeting::default(); 2]; junctions.len()];
                parameters.len()
            ],
            meetings: [Meeting::default(); 2],
            meeting_tangents: vec![[Meeting::default(); 2]; parameters.len()],
            grid,
            bars,
            junctions,
            ends,
            gauges,
            cell_strains: Vec::new(),
            steps: 0,
            initial_energy: 0.0,
            initial_momentum: 0.0,
            dissipated: 0.0,
            lost_in_contact: 0.0,
        };
        march.initial_energy = march.energy();
        march.initial_momentum = march.momentum();
        march.read_gauges();
        Ok(march)
    }

    /// The grid.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Number of steps made.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Present time \[s\].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.grid.time_step
    }

    /// Advances one time step without allocating memory.
    ///
    /// # Errors
    /// [`RodwaveError::ExcitationTooShort`] or [`RodwaveError::NonPhysical`] if the drive of an end
    /// is undefined or not finite; the march then cannot continue.
    pub fn advance(&mut self) -> Result<(), RodwaveError> {
        let step = self.grid.time_step;
        let half_way = self.time() + 0.5 * step;
        for end in &self.ends {
            end.drive()
                .map_or(Ok(()), |drive| drive.check_until(half_way))?;
        }
        for bar in &mut self.bars {
            self.dissipated += bar.relax();
        }
        for gauge in &mut self.gauges {
            gauge.before_shift(&self.bars[gauge.segment]);
        }
        for (strains, bar) in self.cell_strains.iter_mut().zip(&self.bars) {
            strains.before_shift(bar);
        }
        for bar in &mut self.bars {
            bar.drag_tangents();
        }
        self.meet(half_way, step)?;
        self.shift();
        for bar in &mut self.bars {
            bar.drag_tangents();
        }
        for gauge in &mut self.gauges {
            gauge.after_shift(&self.bars[gauge.segment]);
        }
        for (strains, bar) in self.cell_strains.iter_mut().zip(&self.bars) {
            strains.after_shift(bar);
        }
        self.steps += 1;
        self.read_gauges();
        Ok(())
    }

    /// Starts to record the strain of every cell.
    pub(super) fn watch_cells(&mut self) {
        self.cell_strains = self.bars.iter().map(CellStrains::of).collect();
    }

    /// Returns the bars with the strains of their cells, if strains are recorded.
    pub(super) fn cells_mut(&mut self) -> impl Iterator<Item = (&mut Bar, &CellStrains)> {
        self.bars.iter_mut().zip(&self.cell_strains)
    }

    fn read_gauges(&mut self) {
        for gauge in &mut self.gauges {
            gauge.read(&mut self.bars[gauge.segment]);
        }
    }

    /// Solves all junctions with the arriving waves.
    fn meet(&mut self, time: f64, step: f64) -> Result<(), RodwaveError> {
        for (index, junction) in self.junctions.iter_mut().enumerate() {
            let (left, right) = (&self.bars[index], &self.bars[index + 1]);
            let sides = [leaving_right(left), leaving_left(right)];
            let encounter = junction.meet(sides[0], sides[1], step);
            self.lost_in_contact += encounter.lost;
            for (parameter, tangents) in self.encounter_tangents.iter_mut().enumerate() {
                let by = [
                    tangent_leaving_right(&left.tangents[parameter]),
                    tangent_leaving_left(&right.tangents[parameter]),
                ];
                tangents[index] = junction.meet_tangent(parameter, &encounter, sides, by, step);
            }
            self.encounters[index] = encounter;
        }
        let (Some(first), Some(last)) = (self.bars.first(), self.bars.last()) else {
            return Ok(()); // not reached: a line has segments
        };
        let sides = [leaving_left(first), leaving_right(last)];
        for (hand, end) in self.ends.iter_mut().enumerate() {
            self.meetings[hand] = end.meet(sides[hand], time, step)?;
            for (parameter, tangents) in self.meeting_tangents.iter_mut().enumerate() {
                let by = if hand == 0 {
                    tangent_leaving_left(&first.tangents[parameter])
                } else {
                    tangent_leaving_right(&last.tangents[parameter])
                };
                tangents[hand] =
                    end.meet_tangent(parameter, self.meetings[hand], sides[hand], by, step);
            }
        }
        Ok(())
    }

    /// Shifts all waves by one cell and inserts those that leave the junctions.
    fn shift(&mut self) {
        let last = self.bars.len() - 1;
        for (index, bar) in self.bars.iter_mut().enumerate() {
            let at_left = match index.checked_sub(1) {
                Some(junction) => self.encounters[junction].right,
                None => self.meetings[0],
            };
            let at_right = if index == last {
                self.meetings[1]
            } else {
                self.encounters[index].left
            };
            let impedance = bar.impedance;
            bar.right.slide_towards_end();
            bar.left.slide_towards_start();
            bar.right
                .set_first(at_left.force / impedance - at_left.velocity);
            bar.left
                .set_last(at_right.force / impedance + at_right.velocity);
            for (parameter, tangent) in bar.tangents.iter_mut().enumerate() {
                let by_left = match index.checked_sub(1) {
                    Some(junction) => self.encounter_tangents[parameter][junction][1],
                    None => self.meeting_tangents[parameter][0],
                };
                let by_right = if index == last {
                    self.meeting_tangents[parameter][1]
                } else {
                    self.encounter_tangents[parameter][index][0]
                };
                let growth = tangent.impedance_growth;
                let scaled = |by: Meeting, at: Meeting| (by.force - at.force * growth) / impedance;
                tangent.right.slide_towards_end();
                tangent.left.slide_towards_start();
                tangent
                    .right
                    .set_first(scaled(by_left, at_left) - by_left.velocity);
                tangent
                    .left
                    .set_last(scaled(by_right, at_right) + by_right.velocity);
            }
        }
    }

    /// Force in contact `index` (after body `index`) at (k - ½) dt \[N\], positive in compression.
    #[must_use]
    pub fn contact_force(&self, index: usize) -> f64 {
        self.contact(index)
            .map_or(0.0, |(at, _)| -self.encounters[at].left.force)
    }

    /// Gap of contact `index` at the present time \[m\].
    #[must_use]
    pub fn gap(&self, index: usize) -> f64 {
        self.contact(index).map_or(0.0, |(_, contact)| contact.gap)
    }

    /// Change of contact `index` in the last step: the new state (true: closed) and the time \[s\];
    /// `None` if the state has not changed.
    pub(super) fn turn(&self, index: usize) -> Option<(bool, f64)> {
        let (at, contact) = self.contact(index)?;
        let steps = self.encounters[at].turn?;
        Some((
            contact.closed,
            self.time() + (steps - 1.0) * self.grid.time_step,
        ))
    }

    fn contact(&self, index: usize) -> Option<(usize, &Contact)> {
        let contacts = self.junctions.iter().enumerate();
        contacts
            .filter_map(|(at, junction)| match junction {
                Junction::Contact(contact) => Some((at, contact)),
                Junction::Bonded => None,
            })
            .nth(index)
    }

    pub(super) fn contact_force_by(&self, index: usize, parameter: usize) -> f64 {
        self.contact(index).map_or(0.0, |(at, _)| {
            -self.encounter_tangents[parameter][at][0].force
        })
    }

    /// Force \[N\] (positive in compression) and velocity [m/s] of the left and the right end at
    /// (k - ½) dt.
    #[must_use]
    pub fn ends(&self) -> [EndState; 2] {
        self.meetings.map(|at| EndState {
            force: -at.force,
            velocity: at.velocity,
        })
    }

    pub(super) fn ends_by(&self, parameter: usize) -> [EndState; 2] {
        self.meeting_tangents[parameter].map(|by| EndState {
            force: -by.force,
            velocity: by.velocity,
        })
    }

    fn energy(&self) -> f64 {
        let bars: f64 = self.bars.iter().map(Bar::energy).sum();
        bars + self.ends.iter().map(Terminal::energy).sum::<f64>()
    }

    fn momentum(&self) -> f64 {
        let bars: f64 = self.bars.iter().map(Bar::momentum).sum();
        bars + self.ends.iter().map(Terminal::momentum).sum::<f64>()
    }

    /// Number of steps that reach `duration`, which must be within the limit of a history.
    pub(super) fn steps_of(&self, duration: f64) -> Result<usize, RodwaveError> {
        // rounding may put the quotient above a whole number of steps
        check_steps((duration / self.grid.time_step * (1.0 - 1e-12)).ceil())
    }

    /// The ledger, after a check that its energy is finite: an overflow anywhere in the line soon
    /// shows in its energy.
    pub(super) fn finite_ledger(&self) -> Result<Ledger, RodwaveError> {
        let ledger = self.ledger();
        check_finite("energy of the line [J]", ledger.stored)?;
        Ok(ledger)
    }

    /// Energy and momentum since the start.
    #[must_use]
    pub fn ledger(&self) -> Ledger {
        let sum = |of: fn(&Terminal) -> f64| self.ends.iter().map(of).sum::<f64>();
        Ledger {
            initial_energy: self.initial_energy,
            stored: self.energy(),
            supplied: sum(|end| end.supplied),
            dissipated: self.dissipated,
            radiated: sum(|end| end.radiated),
            lost_in_contact: self.lost_in_contact,
            initial_momentum: self.initial_momentum,
            momentum: self.momentum(),
            impulse: sum(|end| end.impulse),
        }
    }
}

/// Force and velocity of an end of a line.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EndState {
    /// Force \[N\], positive in compression.
    pub force: f64,
    /// Velocity along x [m/s].
    pub velocity: f64,
}

fn leaving_right(bar: &Bar) -> Side {
    Side {
        arriving: bar.right.last(),
        impedance: bar.impedance,
    }
}

fn leaving_left(bar: &Bar) -> Side {
    Side {
        arriving: bar.left.first(),
        impedance: bar.impedance,
    }
}

fn tangent_leaving_right(tangent: &BarTangent) -> SideTangent {
    SideTangent {
        arriving: tangent.right.last(),
        growth: tangent.impedance_growth,
    }
}

fn tangent_leaving_left(tangent: &BarTangent) -> SideTangent {
    SideTangent {
        arriving: tangent.left.first(),
        growth: tangent.impedance_growth,
    }
}

impl Line {
    /// Returns the role of `parameter` in segment `index`.
    fn source(&self, index: usize, parameter: Parameter) -> Result<Source, RodwaveError> {
        let known = self.parameters();
        if !known.contains(&parameter) {
            return Err(RodwaveError::UnknownParameter {
                segment: parameter.segment,
                branch: parameter.branch,
                name: parameter.name,
            });
        }
        if parameter.segment != index {
            return Ok(Source::Elsewhere);
        }
        if parameter.name == super::LN_MODULUS {
            return Ok(Source::LogModulus(parameter.branch));
        }
        let position = self
            .segments()
            .nth(index)
            .and_then(|segment| segment.branches().get(parameter.branch))
            .and_then(|branch| {
                let names = branch.law.parameters();
                names.iter().position(|name| *name == parameter.name)
            });
        Ok(position.map_or(Source::Elsewhere, |position| {
            Source::Parameter(parameter.branch, position)
        }))
    }
}
