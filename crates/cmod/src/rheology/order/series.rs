//! Generalised Maxwell model as a list of branches, and the best model on a grid of relaxation
//! times.

use rodwave::modulus::MaxwellBranch;

use super::super::data::ModulusData;
use super::super::non_negative::NonNegative;
use super::super::prony::{Prony, branches_at, share_of};

/// Relaxation times per decade of the grid.
const TIMES_A_DECADE: f64 = 6.0;
/// Decades of the grid beyond the band. The part of a relaxation that lies within the band has the
/// same shape for all relaxation times farther away.
const DECADES_BEYOND: f64 = 1.5;

/// Equilibrium modulus E∞ and branches in order of increasing relaxation time.
#[derive(Debug, Clone)]
pub(in super::super) struct Series {
    pub(in super::super) equilibrium: f64,
    pub(in super::super) branches: Vec<MaxwellBranch>,
}

impl Series {
    /// Returns the best spectrum on a grid of relaxation times, with neighbouring spectral lines
    /// merged into branches.
    pub(super) fn best(data: &ModulusData) -> Self {
        let times = grid(data);
        let mut columns = vec![constant(data)];
        columns.extend(times.iter().map(|time| column(data, *time)));
        let optimum = NonNegative::new(&columns, &target(data)).solve();
        let (equilibrium, moduli) = optimum.coefficients.split_at(1);
        let mut branches: Vec<MaxwellBranch> = Vec::new();
        let mut previous = false;
        for (relaxation_time, modulus) in times.iter().zip(moduli) {
            if *modulus > 0.0 {
                let line = MaxwellBranch {
                    modulus: *modulus,
                    relaxation_time: *relaxation_time,
                };
                match branches.last_mut() {
                    Some(last) if previous => *last = merged(last, &line),
                    _ => branches.push(line),
                }
            }
            previous = *modulus > 0.0;
        }
        Self {
            equilibrium: equilibrium.first().copied().unwrap_or(0.0),
            branches,
        }
    }

    pub(in super::super) fn coordinates(&self) -> Vec<f64> {
        Prony::coordinates(self.equilibrium, &self.branches)
    }

    pub(in super::super) fn of_coordinates(at: &[f64], solid: bool) -> Self {
        let (equilibrium, rest) = at.split_at(usize::from(solid));
        Self {
            equilibrium: equilibrium.first().map_or(0.0, |e| e.exp()),
            branches: branches_at(rest),
        }
    }

    pub(in super::super) fn model(&self) -> Prony {
        Prony::new(self.equilibrium > 0.0, self.branches.len())
    }

    /// Returns starting points with the same number of parameters, in other regions in which the
    /// law may fit as well: the spring replaced by a slow relaxation, and the first or the last
    /// branch moved out of the band.
    pub(super) fn elsewhere(&self, data: &ModulusData) -> Vec<Vec<f64>> {
        const FAR: f64 = 30.0;
        let (lowest, highest) = data.band();
        let mut all = Vec::new();
        let mut with = |change: &dyn Fn(&mut Self) -> Option<()>| {
            let mut other = self.clone();
            if change(&mut other).is_some() {
                all.push(other.coordinates());
            }
        };
        if self.equilibrium > 0.0 {
            with(&|other| {
                let slowest = other.branches.last_mut()?;
                slowest.modulus += other.equilibrium;
                slowest.relaxation_time = FAR / lowest;
                other.equilibrium *= 1e-3;
                Some(())
            });
        }
        with(&|other| {
            let slowest = other.branches.last_mut()?;
            slowest.relaxation_time = slowest.relaxation_time.max(FAR / lowest);
            Some(())
        });
        with(&|other| {
            let fastest = other.branches.first_mut()?;
            let time = fastest.relaxation_time.min((FAR * highest).recip());
            fastest.modulus *= fastest.relaxation_time / time;
            fastest.relaxation_time = time;
            Some(())
        });
        all
    }

    /// Returns the series with its largest branch split into two, or with a first branch if it has
    /// no branch.
    pub(super) fn split(&self, data: &ModulusData) -> Self {
        let mut longer = self.clone();
        let branches = self.branches.iter().enumerate();
        let largest = branches.max_by(|(_, a), (_, b)| a.modulus.total_cmp(&b.modulus));
        if let Some((at, whole)) = largest {
            let half = |factor: f64| MaxwellBranch {
                modulus: 0.5 * whole.modulus,
                relaxation_time: whole.relaxation_time * factor,
            };
            longer.branches.splice(at..=at, [half(0.7), half(1.4)]);
        } else {
            let (lowest, highest) = data.band();
            longer.branches.push(MaxwellBranch {
                modulus: 0.01 * self.equilibrium,
                relaxation_time: (lowest * highest).sqrt().recip(),
            });
        }
        longer
    }

    /// Returns the same relaxation times with the best moduli, and χ²; branches whose modulus
    /// becomes 0 are removed.
    pub(in super::super) fn with_best_moduli(mut self, data: &ModulusData) -> (f64, Self) {
        let solid = self.equilibrium > 0.0;
        let mut columns: Vec<Vec<f64>> = Vec::with_capacity(1 + self.branches.len());
        if solid {
            columns.push(constant(data));
        }
        columns.extend(
            self.branches
                .iter()
                .map(|b| column(data, b.relaxation_time)),
        );
        let optimum = NonNegative::new(&columns, &target(data)).solve();
        let (equilibrium, moduli) = optimum.coefficients.split_at(usize::from(solid));
        self.equilibrium = equilibrium.first().copied().unwrap_or(0.0);
        for (branch, modulus) in self.branches.iter_mut().zip(moduli) {
            branch.modulus = *modulus;
        }
        self.branches.retain(|branch| branch.modulus > 0.0);
        (optimum.square, self)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.branches.is_empty() && self.equilibrium <= 0.0
    }
}

/// Merges two branches into one. Its modulus is the sum of the moduli; the logarithm of its
/// relaxation time is the mean of the logarithms, with the moduli as weights.
pub(super) fn merged(a: &MaxwellBranch, b: &MaxwellBranch) -> MaxwellBranch {
    let modulus = a.modulus + b.modulus;
    let share = b.modulus / modulus;
    MaxwellBranch {
        modulus,
        relaxation_time: a.relaxation_time * (b.relaxation_time / a.relaxation_time).powf(share),
    }
}

/// Returns a grid of relaxation times over the band and [`DECADES_BEYOND`] on either side.
pub(super) fn grid(data: &ModulusData) -> Vec<f64> {
    let (lowest, highest) = data.band();
    let decade = std::f64::consts::LN_10;
    let first = -highest.ln() - DECADES_BEYOND * decade;
    let span = (highest / lowest).ln() + 2.0 * DECADES_BEYOND * decade;
    let spacing = decade / TIMES_A_DECADE;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive, and the decades of a float times six are few"
    )]
    let steps = (span / spacing).ceil() as u32;
    (0..=steps)
        .map(|step| (first + f64::from(step) * spacing).exp())
        .collect()
}

/// Returns the whitened values of a spring of modulus 1.
pub(super) fn constant(data: &ModulusData) -> Vec<f64> {
    data.whitening
        .iter()
        .flat_map(|w| w.apply(1.0.into()))
        .collect()
}

/// Returns the whitened values of a branch of modulus 1.
pub(super) fn column(data: &ModulusData, relaxation_time: f64) -> Vec<f64> {
    data.lines()
        .iter()
        .zip(&data.whitening)
        .flat_map(|((omega, reading), w)| w.apply(share_of(reading, omega * relaxation_time).0))
        .collect()
}

/// Returns the whitened measured moduli, converted such that they are linear in the moduli of the
/// branches.
pub(super) fn target(data: &ModulusData) -> Vec<f64> {
    data.linear_moduli()
        .iter()
        .zip(&data.whitening)
        .flat_map(|(modulus, w)| w.apply(*modulus))
        .collect()
}
