//! Energy and momentum of a line.

/// Balance of energy and momentum of a [`Line`](super::Line) since the start.
///
/// initial + supplied = stored + dissipated + radiated + lost in contact, and initial momentum +
/// impulse = momentum, both to rounding on any grid. The residuals therefore check the solver, not
/// its resolution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Ledger {
    /// Energy at the start \[J\].
    pub initial_energy: f64,
    /// Present kinetic and elastic energy \[J\].
    pub stored: f64,
    /// Work done on the line by its driven ends \[J\].
    pub supplied: f64,
    /// Energy lost to inelastic strain rates \[J\]; never decreases.
    pub dissipated: f64,
    /// Energy absorbed by dashpots and matched ends \[J\]; never decreases.
    pub radiated: f64,
    /// Energy lost by the two half cells that close a gap \[J\]; never decreases, and tends to 0 as
    /// the grid is refined.
    pub lost_in_contact: f64,
    /// Momentum along x at the start [N s].
    pub initial_momentum: f64,
    /// Present momentum along x [N s].
    pub momentum: f64,
    /// Impulse on the line by driven, fixed and damped ends, along x [N s].
    pub impulse: f64,
}

impl Ledger {
    /// Residual of the energy balance \[J\].
    #[must_use]
    pub fn energy_residual(&self) -> f64 {
        self.initial_energy + self.supplied
            - self.stored
            - self.dissipated
            - self.radiated
            - self.lost_in_contact
    }

    /// Residual of the momentum balance [N s].
    #[must_use]
    pub fn momentum_residual(&self) -> f64 {
        self.initial_momentum + self.impulse - self.momentum
    }
}
