//! Derivatives of a segment, integrated with its state.

use crate::inelastic::LANES;
use crate::sliding_window::SlidingWindow;

/// Parameter of a line, identified by segment, branch and name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Parameter {
    /// Index of the segment, counted from 0 at the left end of the line through all bodies.
    pub segment: usize,
    /// Index of the branch in the material of the segment, from 0.
    pub branch: usize,
    /// `ln_modulus` for ln Eᵢ, or a name in the `PARAMETERS` of the law of the branch.
    pub name: &'static str,
}

/// Name of ln Eᵢ among the parameters.
pub const LN_MODULUS: &str = "ln_modulus";

/// Role of a parameter in a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// No role: the parameter belongs to another segment.
    Elsewhere,
    /// The modulus of a branch.
    LogModulus(usize),
    /// A parameter of the law of a branch.
    Parameter(usize, usize),
}

/// Derivatives of the state of a segment with respect to one parameter of the line.
#[derive(Debug, Clone)]
pub(super) struct BarTangent {
    pub(super) right: SlidingWindow,
    pub(super) left: SlidingWindow,
    pub(super) excess: Vec<Vec<f64>>,
    pub(super) source: Source,
    /// d ln Z = ½ d ln E, which is also d ln c
    pub(super) impedance_growth: f64,
    /// d(Eᵢ/E) of every branch
    pub(super) fraction_growth: Vec<f64>,
    pub(super) branch_change: Vec<[f64; LANES]>,
}

impl BarTangent {
    #[allow(
        clippy::indexing_slicing,
        reason = "`Line::source` names a branch of the segment of this bar, which has a fraction for each"
    )]
    pub(super) fn new(cells: usize, excess_rows: usize, fractions: &[f64], source: Source) -> Self {
        let share = match source {
            Source::LogModulus(branch) => fractions[branch],
            _ => 0.0,
        };
        let fraction_growth = fractions
            .iter()
            .enumerate()
            .map(|(branch, fraction)| {
                let own = if source == Source::LogModulus(branch) {
                    share
                } else {
                    0.0
                };
                own - share * fraction
            })
            .collect();
        Self {
            right: SlidingWindow::filled(cells, 0.0),
            left: SlidingWindow::filled(cells, 0.0),
            excess: vec![vec![0.0; cells]; excess_rows],
            source,
            impedance_growth: 0.5 * share,
            fraction_growth,
            branch_change: vec![[0.0; LANES]; fractions.len()],
        }
    }
}
