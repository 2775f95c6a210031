//! Maxwell branches in parallel, with or without a spring.

use num_complex::Complex64;

use super::LinearLaw;
use crate::law::StatedParameter;
use crate::special_case::{Branch, NO_SHARE, PronySeries, SpecialCase, UNRELAXED};

/// A Prony series of one to four Maxwell branches.
///
/// ```text
/// E(s)/E = w₀ + Σ wᵢ sτᵢ/(1 + sτᵢ) ,    w₀ + Σ wᵢ = 1
/// ```
///
/// E is the unrelaxed modulus, which gives the front speed. The spring w₀ may be absent. The shares
/// follow from x = ln(wᵢ/w_first), which keeps them positive; the parameters are those x, then ln
/// τ₁ to ln τₙ. (A permutation of branches is the same law.) This is the law of
/// [`rodwave::modulus::GeneralisedMaxwell`] in coordinates whose effects on a response are nearly
/// independent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MaxwellBranches {
    branches: usize,
    has_spring: bool,
    name: &'static str,
}

/// Largest number of branches, for which an evaluation keeps its weights on the stack.
const MOST: usize = 4;

impl MaxwellBranches {
    /// Creates a spring in parallel with one branch: the standard linear solid.
    #[must_use]
    pub fn zener() -> Self {
        Self {
            branches: 1,
            has_spring: true,
            name: "Zener",
        }
    }

    /// Creates a spring in parallel with a fast and a slow branch (Wang, Labibes, Azari &
    /// Pluvinage, *Int. J. Impact Eng.* **15** (1994) 681), with a linear equilibrium.
    #[must_use]
    pub fn zhu_wang_tang() -> Self {
        Self {
            branches: 2,
            has_spring: true,
            name: "Zhu-Wang-Tang",
        }
    }

    /// Creates one branch without a spring: the Maxwell law.
    #[must_use]
    pub fn maxwell() -> Self {
        Self::in_parallel(1, "Maxwell")
    }

    /// Creates two branches without a spring.
    #[must_use]
    pub fn two() -> Self {
        Self::in_parallel(2, "two Maxwell branches")
    }

    /// Creates three branches without a spring.
    #[must_use]
    pub fn three() -> Self {
        Self::in_parallel(3, "three Maxwell branches")
    }

    /// Creates four branches without a spring.
    #[must_use]
    pub fn four() -> Self {
        Self::in_parallel(MOST, "four Maxwell branches")
    }

    fn in_parallel(branches: usize, name: &'static str) -> Self {
        Self {
            branches,
            has_spring: false,
            name,
        }
    }

    /// Number of shares; the share of the spring is the first if there is a spring.
    fn terms(&self) -> usize {
        self.branches + usize::from(self.has_spring)
    }

    fn split<'a>(&self, parameters: &'a [f64]) -> Option<(&'a [f64], &'a [f64])> {
        (parameters.len() == self.terms() - 1 + self.branches)
            .then(|| parameters.split_at(self.terms() - 1))
    }

    /// Shares w of the terms, which sum to 1, and relaxation times τ \[s\] of the branches.
    #[must_use]
    pub fn shares_and_times(&self, parameters: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let (ratios, times) = self.split(parameters)?;
        let weights = shares(ratios);
        Some((
            weights.into_iter().take(self.terms()).collect(),
            times.iter().map(|t| t.exp()).collect(),
        ))
    }
}

/// Shares w from ln(wᵢ/w_first), followed by zeros.
fn shares(ratios: &[f64]) -> [f64; MOST + 1] {
    let largest = ratios.iter().copied().fold(0.0, f64::max);
    let mut weights = [0.0; MOST + 1];
    weights[0] = (-largest).exp();
    for (weight, ratio) in weights[1..].iter_mut().zip(ratios) {
        *weight = (ratio - largest).exp();
    }
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

impl LinearLaw for MaxwellBranches {
    fn name(&self) -> &'static str {
        self.name
    }

    fn parameter_names(&self) -> Vec<&'static str> {
        const SHARES: [&str; MOST] = [
            "ln_share_ratio_1",
            "ln_share_ratio_2",
            "ln_share_ratio_3",
            "ln_share_ratio_4",
        ];
        const TIMES: [&str; MOST] = [
            "ln_relaxation_time_1",
            "ln_relaxation_time_2",
            "ln_relaxation_time_3",
            "ln_relaxation_time_4",
        ];
        let shares = SHARES.iter().take(self.terms() - 1);
        shares
            .chain(TIMES.iter().take(self.branches))
            .copied()
            .collect()
    }

    fn start(&self) -> Vec<f64> {
        // a spring or a slow branch with most of the modulus, and weaker branches with times a
        // decade or more apart
        let (slowest, factor) = match (self.has_spring, self.branches) {
            (true, _) => (5e-5, 0.1),
            (false, 1) => (2e-3, 0.1),
            (false, _) => (5e-3, 0.03),
        };
        let shares = (1..self.terms()).map(|_| 0.07_f64.ln());
        let times = (0..self.branches).map(|i| f64::ln(slowest) + f64::ln(factor) * i as f64);
        shares.chain(times).collect()
    }

    fn step_limits(&self) -> Vec<f64> {
        vec![1.0; self.terms() - 1 + self.branches]
    }

    fn thermal_orders(&self) -> Vec<(usize, f64)> {
        let first = self.terms() - 1;
        (first..first + self.branches)
            .map(|time| (time, -1.0))
            .collect()
    }

    fn ranges(&self) -> Vec<(f64, f64)> {
        let shares = (1..self.terms()).map(|_| (0.005_f64.ln(), 1.0_f64.ln()));
        let times = (0..self.branches).map(|i| match (self.has_spring, i) {
            (false, 0) => (3e-5_f64.ln(), 30_f64.ln()),
            (_, 0 | 1) => (5e-6_f64.ln(), 1e-3_f64.ln()),
            _ => (1e-6_f64.ln(), 1e-4_f64.ln()),
        });
        shares.chain(times).collect()
    }

    fn is_flat_loss(&self) -> bool {
        // two relaxation times are enough for a nearly constant loss factor over a decade, with a
        // spring or a third, slow branch
        self.terms() >= 3
    }

    fn prony(&self, modulus: f64, parameters: &[f64]) -> Option<PronySeries> {
        let (shares, times) = self.shares_and_times(parameters)?;
        let (spring, of_branches) = if self.has_spring {
            let (spring, rest) = shares.split_first()?;
            (*spring, rest)
        } else {
            (0.0, shares.as_slice())
        };
        let pairs = of_branches.iter().zip(times);
        Some(PronySeries {
            modulus,
            spring,
            branches: pairs
                .map(|(share, time)| Branch {
                    share: *share,
                    time,
                })
                .collect(),
        })
    }

    fn special_case(&self, series: &PronySeries) -> Option<SpecialCase> {
        let mut branches = series.branches.clone();
        let takes_the_spring = series.spring > 0.0 && !self.has_spring;
        if takes_the_spring {
            branches.push(Branch {
                share: series.spring,
                time: UNRELAXED,
            });
        }
        let missing = self.branches.checked_sub(branches.len())?;
        let usual = self.start();
        let usual_times = usual.iter().rev().take(missing);
        branches.extend(usual_times.map(|ln_time| Branch {
            share: NO_SHARE,
            time: ln_time.exp(),
        }));
        // slowest branch first, as in `ranges`
        branches.sort_by(|a, b| b.time.total_cmp(&a.time));
        let spring = self.has_spring.then_some(series.spring.max(NO_SHARE));
        let shares: Vec<f64> = spring
            .into_iter()
            .chain(branches.iter().map(|branch| branch.share))
            .collect();
        let (first, others) = shares.split_first()?;
        let ratios = others.iter().map(|share| (share / first).ln());
        let parameters = std::iter::once(series.modulus.ln())
            .chain(ratios)
            .chain(branches.iter().map(|branch| branch.time.ln()))
            .collect();
        let no_spring = self.has_spring && series.spring == 0.0;
        let have = |count: usize| match count {
            1 => "one has".to_owned(),
            more => format!("{more} have"),
        };
        let limit = match (takes_the_spring, missing, no_spring) {
            _ if series.branches.is_empty() => "without relaxation".to_owned(),
            (true, 0, _) => "of which one has an unbounded relaxation time".to_owned(),
            (true, n, _) => format!(
                "of which one has an unbounded relaxation time and {} no share",
                have(n)
            ),
            (false, 0, true) => "whose spring has no share".to_owned(),
            (false, n, true) => format!(
                "whose spring has no share and of which {} no share either",
                have(n)
            ),
            (false, n, false) => format!("of which {} no share", have(n)),
        };
        Some(SpecialCase { parameters, limit })
    }

    /// The relaxation times, and the moduli Eᵢ = E wᵢ of spring and branches, which follow from E
    /// and the shares.
    fn stated(&self, modulus: f64, parameters: &[f64]) -> Vec<StatedParameter> {
        const TIMES: [(&str, &str); MOST] = [
            ("relaxation time of branch 1", "tau_1"),
            ("relaxation time of branch 2", "tau_2"),
            ("relaxation time of branch 3", "tau_3"),
            ("relaxation time of branch 4", "tau_4"),
        ];
        const MODULI: [(&str, &str); MOST + 1] = [
            ("modulus of the spring", "E_0"),
            ("modulus of branch 1", "E_1"),
            ("modulus of branch 2", "E_2"),
            ("modulus of branch 3", "E_3"),
            ("modulus of branch 4", "E_4"),
        ];
        let Some((weights, times)) = self.shares_and_times(parameters) else {
            return Vec::new();
        };
        let terms = self.terms();
        let unit_vector = |index: usize| -> Vec<f64> {
            (0..=parameters.len())
                .map(|k| if k == index { 1.0 } else { 0.0 })
                .collect()
        };
        let of_times = TIMES.iter().zip(&times).enumerate();
        let times = of_times.map(|(branch, ((name, symbol), time))| {
            StatedParameter::ratio([name, symbol, "s"], *time, unit_vector(terms + branch))
        });
        let names = MODULI.iter().skip(usize::from(!self.has_spring));
        let moduli = names
            .zip(&weights)
            .enumerate()
            // the modulus of a single term is E
            .filter(|_| terms > 1)
            .map(|(term, ((name, symbol), weight))| {
                // d ln wᵢ/dxⱼ = δᵢⱼ - wⱼ, x₀ being fixed
                let mut gradient = vec![0.0; parameters.len() + 1];
                for (k, slope) in gradient.iter_mut().enumerate().take(terms) {
                    *slope = match (k, weights.get(k)) {
                        (0, _) => 1.0,
                        (k, Some(other)) => f64::from(u8::from(k == term)) - other,
                        (_, None) => 0.0,
                    };
                }
                StatedParameter::ratio([name, symbol, "Pa"], modulus * weight, gradient).derived()
            });
        times.chain(moduli).collect()
    }

    fn shape(&self, s: Complex64, parameters: &[f64]) -> Option<Complex64> {
        self.shapes(&[s], parameters)?.pop()
    }

    fn shapes(&self, arguments: &[Complex64], parameters: &[f64]) -> Option<Vec<Complex64>> {
        let (ratios, ln_times) = self.split(parameters)?;
        let weights = shares(ratios);
        let of_branches = weights.iter().skip(usize::from(self.has_spring));
        let mut terms = [(0.0, 0.0); MOST];
        for (term, (weight, ln_time)) in terms.iter_mut().zip(of_branches.zip(ln_times)) {
            *term = (*weight, ln_time.exp());
        }
        let spring = Complex64::from(if self.has_spring { weights[0] } else { 0.0 });
        let shape = |s: &Complex64| {
            let branches = terms.iter().take(self.branches);
            branches.fold(spring, |sum, (weight, time)| {
                let s_tau = s * time;
                sum + weight * s_tau / (1.0 + s_tau)
            })
        };
        Some(arguments.iter().map(shape).collect())
    }

    fn shape_with_derivatives(
        &self,
        s: Complex64,
        parameters: &[f64],
        derivatives: &mut [Complex64],
    ) -> Option<Complex64> {
        let (ratios, times) = self.split(parameters)?;
        if derivatives.len() != parameters.len() {
            return None;
        }
        let weights = shares(ratios);
        let (terms, spring) = (self.terms(), usize::from(self.has_spring));
        // φ of each term: 1 for the spring, sτ/(1 + sτ) for a branch
        let mut phi = [Complex64::ONE; MOST + 1];
        for (value, ln_time) in phi.iter_mut().skip(spring).zip(times) {
            let s_tau = s * ln_time.exp();
            *value = s_tau / (1.0 + s_tau);
        }
        let pairs = || weights.iter().zip(&phi);
        let sum: Complex64 = pairs().take(terms).map(|(weight, phi)| weight * phi).sum();
        let (by_ratio, by_time) = derivatives.split_at_mut_checked(terms - 1)?;
        // dwᵢ/dxⱼ = wᵢ (δᵢⱼ - wⱼ)
        for (derivative, (weight, phi)) in by_ratio.iter_mut().zip(pairs().skip(1)) {
            *derivative = weight * (phi - sum);
        }
        // dφ/d ln τ = φ (1 - φ)
        for (derivative, (weight, own)) in by_time.iter_mut().zip(pairs().skip(spring)) {
            *derivative = weight * own * (1.0 - own);
        }
        Some(sum)
    }
}
