//! Linear part in parallel with the nonlinear branch of a rod: a spring, linear branches, or the
//! spectrum of a flat loss factor.

use std::f64::consts::{FRAC_2_PI, PI};

use rodwave::characteristics::{Direction, LinearBranch};

use crate::law::StatedParameter;
use crate::special_case::NO_SHARE;

/// Bounds of the logarithm of a ratio of shares.
const SHARE_BOUNDS: (f64, f64) = (-14.0, 14.0);

/// Bounds of the logarithm of a relaxation time in s.
const TIME_BOUNDS: (f64, f64) = (-25.0, 5.0);

/// Bounds of the logarithm of a flat loss factor, from a limit without loss to 1.
const LOSS_BOUNDS: (f64, f64) = (-17.0, 0.0);

/// Relaxation time \[s\] from which the fit of a linear branch starts: shorter than a record, and
/// faster than the nonlinear branch.
const LINEAR_TIME: f64 = 3e-5;

/// Flat loss factor from which a fit starts.
const LOSS_FACTOR: f64 = 0.03;

/// Largest number of linear branches whose shares and times are parameters.
const MOST_LINEAR: usize = 2;

/// Names of the ratios of shares and of the relaxation times.
const RATIOS: [&str; 3] = ["ln_share_ratio_1", "ln_share_ratio_2", "ln_share_ratio_3"];
const TIMES: [&str; MOST_LINEAR] = ["ln_relaxation_time_1", "ln_relaxation_time_2"];

/// Relaxation times of the spectrum of a flat loss factor \[s\]: the first and the last, and their
/// number. Seven from 1 us to 5 ms keep the loss factor constant to 1 % from 0.1 to 30 kHz.
const SPECTRUM: (f64, f64, usize) = (1e-6, 5e-3, 7);

/// The linear part of the material, in parallel with the nonlinear branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Neighbours {
    /// A spring, linear Maxwell branches, or both, each with its share. Parameters: the logarithms
    /// of the ratios of all other shares to the first one, with that of the nonlinear branch last,
    /// and of the relaxation times.
    Branches { spring: bool, linear: usize },
    /// A spring and Maxwell branches with a flat loss factor d. Parameters: the logarithm of the
    /// share of the nonlinear branch divided by the share of all others together, and ln d.
    ///
    /// With a = 2/π atan d the relaxation spectrum of (iω)^a is sin(πa)/π τ^(-a) per ln τ. The
    /// Maxwell branches are its sum by the trapezoidal rule. A spring replaces the part of the
    /// spectrum slower than the last branch; the first branch includes the loss of the faster part,
    /// the last branch that of the slower part.
    FlatLoss,
}

/// Shares and times of the branches at some values of the parameters.
pub(super) struct Composition {
    pub(super) spring: f64,
    pub(super) linear: Vec<LinearBranch>,
    /// Share of the nonlinear branch.
    pub(super) of_law: f64,
    /// Derivatives of shares and times with respect to each parameter.
    pub(super) directions: Vec<Direction>,
}

impl Neighbours {
    /// Adds a linear Maxwell branch, up to [`MOST_LINEAR`] in all; a flat loss factor stays
    /// unchanged.
    pub(super) fn with_linear_branch(self) -> Self {
        match self {
            Self::Branches { spring, linear } => Self::Branches {
                spring,
                linear: (linear + 1).min(MOST_LINEAR),
            },
            Self::FlatLoss => self,
        }
    }

    /// Number of ratios of shares.
    fn ratios(self) -> usize {
        match self {
            Self::Branches { spring, linear } => usize::from(spring) + linear,
            Self::FlatLoss => 1,
        }
    }

    /// Number of linear branches whose relaxation times are parameters.
    fn times(self) -> usize {
        match self {
            Self::Branches { linear, .. } => linear,
            Self::FlatLoss => 0,
        }
    }

    /// Number of parameters.
    pub(super) fn count(self) -> usize {
        self.names().len()
    }

    /// Places of the relaxation times among the parameters.
    pub(super) fn places_of_times(self) -> std::ops::Range<usize> {
        self.ratios()..self.ratios() + self.times()
    }

    pub(super) fn names(self) -> Vec<&'static str> {
        let loss = (self == Self::FlatLoss).then_some("ln_loss_factor");
        let ratios = RATIOS.into_iter().take(self.ratios());
        let times = TIMES.into_iter().take(self.times());
        ratios.chain(times).chain(loss).collect()
    }

    pub(super) fn bounds(self) -> Vec<(f64, f64)> {
        let of = |name: &&str| match *name {
            "ln_loss_factor" => LOSS_BOUNDS,
            name if TIMES.contains(&name) => TIME_BOUNDS,
            _ => SHARE_BOUNDS,
        };
        self.names().iter().map(of).collect()
    }

    /// Parameters at which the share of the nonlinear branch is `ratio` times that of the first
    /// component, and the share of the nonlinear branch in the sum. The other components start with
    /// a tenth of the share of the first one.
    pub(super) fn start(self, ratio: f64) -> (Vec<f64>, f64) {
        let others = self.ratios() - 1;
        let parameters = std::iter::repeat_n(0.1_f64.ln(), others)
            .chain([ratio.ln()])
            .chain(std::iter::repeat_n(LINEAR_TIME.ln(), self.times()))
            .chain((self == Self::FlatLoss).then(|| LOSS_FACTOR.ln()));
        let share = ratio / (1.0 + ratio + 0.1 * others as f64);
        (parameters.collect(), share)
    }

    /// Parameters for a nonlinear branch of this `share` in parallel with nothing but a spring of
    /// the share `spring`; `None` if there is no such limit.
    pub(super) fn beside_spring(self, share: f64, spring: f64) -> Option<Vec<f64>> {
        let ratio = (share / spring.max(NO_SHARE)).ln();
        match self {
            Self::Branches {
                spring: true,
                linear: 0,
            } => Some(vec![ratio]),
            Self::Branches { .. } => None,
            Self::FlatLoss => Some(vec![ratio, NO_SHARE.ln()]),
        }
    }

    /// The shares and times at these parameters; `None` for a wrong number of parameters, and where
    /// a share is outside the floating-point range.
    pub(super) fn at(self, parameters: &[f64]) -> Option<Composition> {
        match self {
            Self::Branches { spring, .. } => {
                if parameters.len() != self.count() {
                    return None;
                }
                let (ratios, ln_times) = parameters.split_at_checked(self.ratios())?;
                let weights = std::iter::once(1.0).chain(ratios.iter().map(|x| x.exp()));
                let sum: f64 = weights.clone().sum();
                let mut shares: Vec<f64> = weights.map(|weight| weight / sum).collect();
                let of_spring = if spring { shares.remove(0) } else { 0.0 };
                // the first component has no ratio as a parameter: the other shares are relative to
                // it
                let first = usize::from(!spring);
                let of_shares = (first..shares.len()).map(|k| Direction::Shares(moved(&shares, k)));
                let of_times = (0..ln_times.len()).map(|k| {
                    let own = |i| if i == k { 1.0 } else { 0.0 };
                    Direction::LogTimes((0..ln_times.len()).map(own).collect())
                });
                let directions = of_shares.chain(of_times).collect();
                let of_law = shares.pop()?;
                let linear = shares.into_iter().zip(ln_times);
                let linear = linear.map(|(share, ln_time)| LinearBranch {
                    share,
                    time: ln_time.exp(),
                });
                Some(Composition {
                    spring: of_spring,
                    linear: linear.collect(),
                    of_law,
                    directions,
                })
            }
            Self::FlatLoss => {
                let [ratio, ln_loss_factor] = parameters else {
                    return None;
                };
                let of_law = 1.0 / (1.0 + (-ratio).exp());
                let of_others = 1.0 / (1.0 + ratio.exp());
                let Spectrum {
                    times,
                    weights,
                    growth,
                } = Spectrum::of(ln_loss_factor.exp());
                let sum: f64 = weights.iter().sum();
                let mean = growth.iter().sum::<f64>() / sum;
                let share = |weight: &f64| of_others * weight / sum;
                let linear: Vec<LinearBranch> = weights
                    .iter()
                    .skip(1)
                    .zip(times)
                    .map(|(weight, time)| LinearBranch {
                        share: share(weight),
                        time,
                    })
                    .collect();
                // the share w of the nonlinear branch has dw/dx = w (1 - w); the others decrease by
                // this amount in proportion to their shares
                let by_ratio = linear.iter().map(|branch| -of_law * branch.share);
                let by_ratio = by_ratio.chain([of_law * of_others]).collect();
                let pairs = growth.iter().zip(&weights).skip(1);
                let by_loss =
                    pairs.map(|(growth, weight)| of_others * (growth - mean * weight) / sum);
                Some(Composition {
                    spring: weights.first().map(share)?,
                    of_law,
                    linear,
                    directions: vec![
                        Direction::Shares(by_ratio),
                        Direction::Shares(by_loss.chain([0.0]).collect()),
                    ],
                })
            }
        }
    }

    /// The quantities in the form used in the literature, with gradients with respect to the
    /// parameters of this linear part.
    pub(super) fn stated(
        self,
        composition: &Composition,
        parameters: &[f64],
    ) -> Vec<StatedParameter> {
        let unit = |place: usize| -> Vec<f64> {
            let own = |index| if index == place { 1.0 } else { 0.0 };
            (0..self.count()).map(own).collect()
        };
        let Composition {
            spring,
            linear,
            of_law,
            ..
        } = composition;
        match self {
            Self::Branches {
                spring: has_spring, ..
            } => {
                let shares: Vec<f64> = (has_spring.then_some(*spring).into_iter())
                    .chain(linear.iter().map(|branch| branch.share))
                    .chain([*of_law])
                    .collect();
                let named = [
                    ("share of the spring in the modulus", "w_0"),
                    ("share of the linear branch in the modulus", "w_1"),
                    ("share of the second linear branch in the modulus", "w_2"),
                ];
                let named = named.into_iter().skip(usize::from(!has_spring));
                let of_shares = shares.iter().take(self.ratios()).enumerate().zip(named);
                let of_shares = of_shares.map(|((index, share), (name, symbol))| {
                    // d ln wᵢ/dx_k = δ_ik - w_k
                    let own = |k| if k == index { 1.0 } else { 0.0 };
                    let by_ratios = shares.iter().enumerate().skip(1).map(|(k, w)| own(k) - w);
                    let by_times = std::iter::repeat_n(0.0, self.times());
                    let gradient = by_ratios.chain(by_times).collect();
                    StatedParameter::ratio([name, symbol, "1"], *share, gradient)
                });
                let of_times = linear.iter().zip(self.places_of_times()).zip([
                    ("relaxation time of the linear branch", "tau_1"),
                    ("relaxation time of the second linear branch", "tau_2"),
                ]);
                let of_times = of_times.map(|((branch, place), (name, symbol))| {
                    StatedParameter::ratio([name, symbol, "s"], branch.time, unit(place))
                });
                of_shares.chain(of_times).collect()
            }
            Self::FlatLoss => {
                let share = ["share of the nonlinear branch in the modulus", "w", "1"];
                let loss = ["loss factor of the linear branches", "tan delta", "1"];
                let loss_factor = parameters.last().map_or(f64::NAN, |ln| ln.exp());
                vec![
                    StatedParameter::ratio(share, *of_law, vec![1.0 - of_law, 0.0]),
                    StatedParameter::ratio(loss, loss_factor, unit(1)),
                ]
            }
        }
    }
}

/// Derivatives dwᵢ/dx_k = wᵢ (δ_ik - w_k) of the shares wᵢ with respect to ln-ratio k.
fn moved(shares: &[f64], k: usize) -> Vec<f64> {
    let of = shares.get(k).copied().unwrap_or(0.0);
    let each = shares.iter().enumerate();
    each.map(|(index, share)| share * (if index == k { 1.0 } else { 0.0 } - of))
        .collect()
}

/// Relaxation times of the branches of a flat loss factor, their weights with that of the spring
/// first, and the derivatives of the weights with respect to the logarithm of the loss factor.
struct Spectrum {
    times: Vec<f64>,
    weights: Vec<f64>,
    growth: Vec<f64>,
}

impl Spectrum {
    fn of(loss_factor: f64) -> Self {
        let (first, last, count) = SPECTRUM;
        let step = (last / first).ln() / (count - 1) as f64;
        let a = FRAC_2_PI * loss_factor.atan();
        let by_ln_loss = FRAC_2_PI * loss_factor / (1.0 + loss_factor * loss_factor);
        let scale = (PI * a).sin() / PI;
        let of_scale = PI / (PI * a).tan();
        let times: Vec<f64> = (0..count)
            .map(|index| first * (step * index as f64).exp())
            .collect();
        // each branch as its weight, for times relative to the last one, and the derivative of the
        // logarithm of the weight with respect to a
        let relative = |time: f64| (time / last).ln();
        let edge = 0.5 * step;
        let mut branches: Vec<(f64, f64)> = times
            .iter()
            .map(|time| {
                let log = relative(*time);
                (step * scale * (-a * log).exp(), of_scale - log)
            })
            .collect();
        let mut add = |index: usize, weight: f64, by_a: f64| {
            if let Some((own, own_by_a)) = branches.get_mut(index) {
                let sum = *own + weight;
                *own_by_a = (*own * *own_by_a + weight * by_a) / sum;
                *own = sum;
            }
        };
        // the part of the spectrum faster than the first branch acts as a dashpot, whose loss the
        // first branch includes
        let log = relative(first) - edge;
        let faster = scale * ((1.0 - a) * log - relative(first)).exp() / (1.0 - a);
        add(0, faster, of_scale - log + 1.0 / (1.0 - a));
        // the part of the spectrum slower than the last branch acts as a spring with some loss,
        // which the last branch includes
        let slower = scale * (-(1.0 + a) * edge).exp() / (1.0 + a);
        let slower_by_a = of_scale - edge - 1.0 / (1.0 + a);
        add(count - 1, slower, slower_by_a);
        let tail = scale / a * (-a * edge).exp();
        let tail_by_a = of_scale - 1.0 / a - edge;
        let spring = tail - slower;
        let spring_by_a = (tail * tail_by_a - slower * slower_by_a) / spring;
        let (weights, growth) = std::iter::once((spring, spring_by_a))
            .chain(branches)
            .map(|(weight, by_a)| (weight, weight * by_a * by_ln_loss))
            .unzip();
        Self {
            times,
            weights,
            growth,
        }
    }
}
