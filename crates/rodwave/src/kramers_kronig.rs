//! Kramers-Kronig test of storage and loss modulus.
//!
//! In a causal material, E' and E'' are not independent: the Kramers-Kronig relations give each
//! from the other, over *all* frequencies. A measurement or a fit covers only a band. The relations
//! can then not be evaluated, but they can be tested. A material whose stress after a step of
//! strain relaxes monotonically, with all derivatives monotonic as in polymers, has the modulus
//!
//! ```text
//! E(ω) = E∞ + iωη + ∫ H(τ) iωτ/(1 + iωτ) d(ln τ) ,    E∞, η, H >= 0
//! ```
//!
//! Such moduli form a convex cone, and every one of them is causal and passive. [`KramersKronig`]
//! finds the modulus in this cone that is nearest to the given values over the band, with H on a
//! grid of [`GRID_PER_DECADE`] relaxation times per decade, from two decades faster to four decades
//! slower than the band. The residual is the least change after which the values belong to a causal
//! material.
//!
//! # Threshold
//! A branch between two points of the grid, h apart in ln τ, is replaced by a mean of its two
//! neighbours. As |∂²/∂(ln τ)² iωτ/(1 + iωτ)| equals its loss part ωτ/(1 + ω²τ²), which varies by
//! less than a factor e^h within the interval, the error is at most (h²/8) e^h times the loss
//! modulus of the branch, and, summed over the branches,
//!
//! ```text
//! |E_grid(ω) - E(ω)| <= ε E''(ω) ,    ε = (h²/8) e^h = 7.0e-4
//! ```
//!
//! at every frequency of the band. (A branch slower than the grid is replaced by the slowest branch
//! of the grid and the spring, a faster one by the fastest branch and the dashpot; the error is at
//! most 1e-4 E''.) Hence, for *every* relaxing material,
//!
//! ```text
//! rms |E - E_causal|/|E| <= ε rms E''/|E|
//! ```
//!
//! and a larger residual proves that no relaxing material has the given values. If the residual is
//! smaller, the nearest material is causal and has the values within the residual. The threshold is
//! a rigorous bound on the grid error, plus the scatter of measured values, if any, and 1e-10 for
//! rounding.
//!
//! # Loss alone
//! Noise in 2n numbers hides an error of a single quantity: with 60 lines and 5 % of noise, doubled
//! losses increase the residual only by a factor of 1.1. The result therefore also contains the
//! size κ of one error that violates causality: all losses too large by the same factor, with E'
//! unchanged. The nearest material is fitted once more with
//!
//! ```text
//! min Σ |E - iκE''_causal - E_material|²/σ² + κ²/18
//! ```
//!
//! For any true material, noise alone lowers the minimum by about half of a chi-square variable
//! with one degree of freedom: in 58 cases (six materials from a spring to strong losses, 3 to 60
//! lines, 1 and 5 % of noise, 200 draws each) the 99 % quantile of twice the decrease was 0.4 to
//! 9.4 (chi-square: 6.6). Values whose decrease is above [`LARGEST_DECREASE`] are not causal. κ
//! cannot be determined if the band does not determine the slope of E', for example from five lines
//! over a decade at 5 % of noise.
//!
//! The optimum of a non-negative least-squares problem is found only to a tolerance; the result
//! contains the residual and a lower bound of the residual by duality, and the verdict is
//! [`Verdict::Undecided`] if the threshold is between the two.
//!
//! # Local relation
//! E'' ≈ (π/2) dE'/d(ln ω) needs no fit, but it is exact only for weak power laws; for a single
//! relaxation it is wrong by the factor π/2 at ωτ = 1. A threshold that accepts a single relaxation
//! accepts nearly everything.
//!
//! ```
//! use rodwave::kramers_kronig::{KramersKronig, Verdict};
//! use rodwave::medium::Medium;
//! use rodwave::modulus::{ConstantQ, PowerLawPropagation};
//!
//! // 0.5 to 10 kHz
//! let omega: Vec<f64> = (0..60).map(|j| 3141.6 * 20f64.powf(f64::from(j) / 59.0)).collect();
//! let fit = Medium::new(1150.0, PowerLawPropagation::new(8.818e-5, 0.894, 8.937e-4, 0.970)?)?;
//! assert_eq!(KramersKronig::of_medium(&fit, &omega)?.verdict(), Verdict::NotCausal);
//! let law = Medium::new(1150.0, ConstantQ::new(2.3e9, 0.095, 1e4)?)?;
//! assert_eq!(KramersKronig::of_medium(&law, &omega)?.verdict(), Verdict::Causal);
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! # Limitations
//! A causal material that resonates is not a relaxing one and is reported as not causal; polymers
//! do not resonate in this way. Over a narrow band, almost any values are those of some causal
//! material, and noise can hide the remaining difference.
//!
//! Theory: `docs/theory/kramers-kronig.md`.

mod non_negative;

use std::f64::consts::{LN_10, SQRT_2};

use num_complex::Complex64;

use crate::RodwaveError;
use crate::error::{
    check_enough_samples, check_finite, check_length, check_not_negative, check_positive,
    check_that,
};
use crate::medium::{Medium, PropagationLaw};
use crate::modulus::MaxwellBranch;
use crate::numerics::CommonErrors;
use non_negative::{NonNegativeProblem, length};

/// Number of relaxation times per decade of the grid.
pub const GRID_PER_DECADE: u32 = 32;

/// Fastest relaxation time of the grid, as a fraction of the period/2π of the highest frequency.
const FASTEST: f64 = 1e-2;

/// Slowest relaxation time of the grid, as a multiple of the period/2π of the lowest frequency.
const SLOWEST: f64 = 1e4;

/// Rounding error of the least-squares problem, relative to |E|, with a margin. The sums have some
/// hundred terms.
const ROUNDING: f64 = 1e-10;

/// Largest [`LossError::decrease`] that is attributed to noise: three standard deviations. The
/// decrease is twice the decrease of the sum of squares when a factor on all losses is also fitted.
pub const LARGEST_DECREASE: f64 = 9.0;

/// Prior standard deviation of a factor on all losses.
const WIDE: f64 = 3.0;

/// Widest band, as the ratio of its ends. The grid of relaxation times grows with the band, and the
/// cost grows as the square of the grid.
const WIDEST: f64 = 1e50;

/// The causal material nearest to given values of a complex modulus, and its distance from them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct KramersKronig {
    /// The lines in the given order.
    pub lines: Vec<ResidualLine>,
    /// Root mean square of |E - E_causal|/|E| over the lines, or of |E - E_causal| over its
    /// standard error if each line has its own standard error.
    pub residual: f64,
    /// Lower bound of the residual of the best causal material.
    pub residual_lower_bound: f64,
    /// The largest residual that a causal material can have; see the [module](self).
    pub threshold: f64,
    /// The part of the threshold due to the grid of relaxation times and to rounding.
    pub grid_error: f64,
    /// The common errors subtracted from the given values, each in units of its standard
    /// uncertainty; empty if none were stated.
    pub common_errors: Vec<f64>,
    /// Result of the fit with an additional factor on all losses; `None` for a law, or if the
    /// nearest material has no loss.
    pub loss_error: Option<LossError>,
    /// E∞ of the nearest causal material \[Pa\].
    pub equilibrium_modulus: f64,
    /// η of the nearest causal material [Pa s].
    pub viscosity: f64,
    /// The relaxation spectrum of the nearest causal material, in the order of increasing
    /// relaxation times.
    pub branches: Vec<MaxwellBranch>,
}

/// Factor on all losses that no causal material has; see the [module](self).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LossError {
    /// Relative error κ of all losses: the given losses are those of some causal material plus κ
    /// times those of the nearest causal material.
    pub factor: f64,
    /// Lower bound of twice the decrease of Σ |δE|²/σ² due to the factor, after subtraction of the
    /// error of the grid.
    pub decrease: f64,
}

/// One line of [`KramersKronig`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ResidualLine {
    /// Angular frequency [rad/s].
    pub omega: f64,
    /// The given modulus E \[Pa\].
    pub modulus: Complex64,
    /// Modulus of the nearest causal material \[Pa\].
    pub causal_modulus: Complex64,
    /// (E - E_causal)/|E|, after subtraction of the common errors.
    pub residual: Complex64,
}

/// Result of the test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// A causal material has these values within the threshold.
    Causal,
    /// No relaxing material has these values.
    NotCausal,
    /// The optimum was not approached closely enough to decide.
    Undecided,
}

impl KramersKronig {
    /// Tests the modulus of `medium` over the band of `omega` > 0 [rad/s].
    ///
    /// About 20 lines per decade suffice; the cost grows with their number.
    ///
    /// # Errors
    /// The errors of [`Self::of_modulus`].
    pub fn of_medium<L: PropagationLaw>(
        medium: &Medium<L>,
        omega: &[f64],
    ) -> Result<Self, RodwaveError> {
        let modulus: Vec<_> = omega.iter().map(|&omega| medium.modulus(omega)).collect();
        Self::of_modulus(omega, &modulus, 0.0)
    }

    /// Tests values of the complex `modulus` \[Pa\] at `omega` > 0 [rad/s]. Each value has the
    /// relative standard error `relative_error`, ⟨|δE|²⟩^½/|E| of both parts together; 0 for a law.
    ///
    /// The scatter of n lines adds its mean plus three standard deviations to the threshold,
    /// `relative_error` (1 + 3/(2√n)).
    ///
    /// # Errors
    /// [`RodwaveError::LengthMismatch`] if the lengths differ; [`RodwaveError::TooFewSamples`]
    /// below three lines; [`RodwaveError::NonPhysical`] unless all frequencies are finite and above
    /// 0, all moduli finite and not 0, and the error finite and not negative.
    pub fn of_modulus(
        omega: &[f64],
        modulus: &[Complex64],
        relative_error: f64,
    ) -> Result<Self, RodwaveError> {
        check_not_negative("relative standard error of the modulus", relative_error)?;
        let scale: Vec<f64> = modulus.iter().map(|modulus| modulus.norm()).collect();
        Self::nearest(omega, modulus, &scale, relative_error, &[], true)
    }

    /// Tests measured values of the complex `modulus` \[Pa\] at `omega` > 0 [rad/s], each with its
    /// own `standard_error` ⟨|δE|²⟩^½ \[Pa\] of both parts together.
    ///
    /// The nearest causal material minimises the distance in units of these errors, and
    /// [`residual`](Self::residual), [`residual_lower_bound`](Self::residual_lower_bound) and
    /// [`threshold`](Self::threshold) are root mean squares of |E - E_causal| divided by its
    /// standard error. Because the true material is in the cone, the residual is at most 1 on
    /// average; n lines add 1 + 3/(2√n) to the threshold.
    ///
    /// # Errors
    /// The errors of [`Self::of_modulus`]; [`RodwaveError::NonPhysical`] unless all errors are
    /// finite and above 0.
    pub fn of_measured_modulus(
        omega: &[f64],
        modulus: &[Complex64],
        standard_error: &[f64],
    ) -> Result<Self, RodwaveError> {
        Self::of_modulus_with_common_errors(omega, modulus, standard_error, &[])
    }

    /// Tests measured values that also have `common_errors`, which all lines share: if one of them
    /// is wrong by its standard uncertainty, all values are wrong by its vector δE(ω) \[Pa\]. An
    /// example is a length that is known to a tenth of a per cent.
    ///
    /// The nearest material and the sizes ξ of the common errors are fitted together,
    ///
    /// ```text
    /// min Σ |E - Σ ξ_s δE_s - E_causal|²/σ² + ½ Σ ξ_s²
    /// ```
    ///
    /// and the residual is the square root of the minimum divided by the number n of lines. For the
    /// true material and the true errors, the mean of its square is 1 + S/(2n), where S is the
    /// number of common errors; the threshold includes this.
    ///
    /// # Errors
    /// The errors of [`Self::of_measured_modulus`]; [`RodwaveError::LengthMismatch`] and
    /// [`RodwaveError::NonPhysical`] for a vector whose length differs, or that is not finite.
    pub fn of_modulus_with_common_errors(
        omega: &[f64],
        modulus: &[Complex64],
        standard_error: &[f64],
        common_errors: &[Vec<Complex64>],
    ) -> Result<Self, RodwaveError> {
        Self::checked(omega, modulus, standard_error, common_errors, true)
    }

    /// Tests as [`Self::of_modulus_with_common_errors`] does, but without the fit of a factor on
    /// all losses, for iterations that only need the nearest material.
    ///
    /// # Errors
    /// The errors of [`Self::of_modulus_with_common_errors`].
    pub fn without_loss_error(
        omega: &[f64],
        modulus: &[Complex64],
        standard_error: &[f64],
        common_errors: &[Vec<Complex64>],
    ) -> Result<Self, RodwaveError> {
        Self::checked(omega, modulus, standard_error, common_errors, false)
    }

    fn checked(
        omega: &[f64],
        modulus: &[Complex64],
        standard_error: &[f64],
        common_errors: &[Vec<Complex64>],
        with_loss_error: bool,
    ) -> Result<Self, RodwaveError> {
        check_length(
            "array of standard errors",
            standard_error.len(),
            modulus.len(),
        )?;
        for &error in standard_error {
            check_positive("standard error of the modulus [Pa]", error)?;
        }
        for common in common_errors {
            check_length("array of a common error", common.len(), modulus.len())?;
            for error in common {
                check_finite("common error of the modulus [Pa]", error.norm())?;
            }
        }
        Self::nearest(
            omega,
            modulus,
            standard_error,
            1.0,
            common_errors,
            with_loss_error,
        )
    }

    /// Finds the material that is nearest to the values in units of `scale`. In these units the
    /// standard error of each value is `scatter`.
    #[allow(
        clippy::indexing_slicing,
        reason = "the vector of a common error has been refused unless it has one entry per line"
    )]
    fn nearest(
        omega: &[f64],
        modulus: &[Complex64],
        scale: &[f64],
        scatter: f64,
        common_errors: &[Vec<Complex64>],
        with_loss_error: bool,
    ) -> Result<Self, RodwaveError> {
        let band = check(omega, modulus)?;
        let elements = elements(band);
        let by_scale = |values: &mut dyn Iterator<Item = Complex64>| -> Vec<f64> {
            let weighted = values.zip(scale).map(|(value, scale)| value / scale);
            weighted.flat_map(|value| [value.re, value.im]).collect()
        };
        let target = by_scale(&mut modulus.iter().copied());
        // each of the two parts has half of the variance of the complex value
        let common = CommonErrors::new(
            common_errors
                .iter()
                .map(|common| by_scale(&mut common.iter().map(|error| SQRT_2 * error)))
                .collect(),
        );
        let columns = || -> Vec<Vec<f64>> {
            elements
                .iter()
                .map(|element| by_scale(&mut omega.iter().map(|&omega| element.at(omega))))
                .collect()
        };
        let grid_error = grid_error(modulus, scale);
        let n = omega.len() as f64;
        let expected = (1.0 + 0.5 * common_errors.len() as f64 / n).sqrt();
        let threshold = grid_error + scatter * (expected + 1.5 / n.sqrt());
        check_finite("threshold of the residual", threshold)?;
        // Far below the threshold the verdict is certain, and a closer fit is not needed.
        let enough = 0.1 * threshold * n.sqrt();
        let solution = whitened_problem(&common, columns(), &target).solve(enough);
        let material: Vec<(Element, f64)> = elements
            .iter()
            .copied()
            .zip(solution.coefficients)
            .filter(|(_, amount)| *amount > 0.0)
            .collect();
        let mut lines = lines(omega, modulus, &material);
        let rest = by_scale(&mut lines.iter().map(|line| line.modulus - line.causal_modulus));
        let sizes: Vec<f64> = common
            .sizes(&rest)
            .iter()
            .map(|size| SQRT_2 * size)
            .collect();
        for (index, line) in lines.iter_mut().enumerate() {
            let size = line.modulus.norm();
            for (common, number) in common_errors.iter().zip(&sizes) {
                line.residual -= common[index] * number / size;
            }
        }
        let loss: Vec<f64> = by_scale(
            &mut lines
                .iter()
                .map(|line| Complex64::new(0.0, SQRT_2 * WIDE * line.causal_modulus.im)),
        );
        let has_loss = loss.iter().any(|loss| *loss > 0.0);
        let loss_error = (with_loss_error && scatter > 0.0 && has_loss).then(|| {
            // in units of the noise; with a standard error for each line, the scale is the noise
            // and `scatter` is 1
            let by_noise = |values: &[f64]| values.iter().map(|v| v / scatter).collect::<Vec<_>>();
            let mut vectors = common.vectors().to_vec();
            vectors.push(by_noise(&loss));
            let common = CommonErrors::new(vectors);
            let columns = columns().iter().map(|column| by_noise(column)).collect();
            let with = whitened_problem(&common, columns, &by_noise(&target)).solve(0.0);
            let amounts = elements.iter().copied().zip(with.coefficients);
            let rest = self::lines(omega, modulus, &amounts.collect::<Vec<_>>());
            let rest = by_scale(&mut rest.iter().map(|line| line.modulus - line.causal_modulus));
            let beyond_grid = solution.residual_lower_bound - grid_error * n.sqrt();
            let without = (beyond_grid / scatter).max(0.0);
            LossError {
                factor: SQRT_2 * WIDE * common.sizes(&by_noise(&rest)).pop().unwrap_or(0.0),
                decrease: (2.0 * (without.powi(2) - with.residual.powi(2))).max(0.0),
            }
        });
        Ok(Self {
            lines,
            loss_error,
            grid_error,
            common_errors: sizes,
            residual: solution.residual / n.sqrt(),
            residual_lower_bound: solution.residual_lower_bound / n.sqrt(),
            threshold,
            equilibrium_modulus: amount_of(&material, Element::Spring),
            viscosity: amount_of(&material, Element::Dashpot),
            branches: material
                .iter()
                .filter_map(|(element, amount)| match element {
                    Element::Branch { relaxation_time } => Some(MaxwellBranch {
                        modulus: *amount,
                        relaxation_time: *relaxation_time,
                    }),
                    _ => None,
                })
                .collect(),
        })
    }

    /// Verdict that follows from the residual.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let loss_is_wrong = self
            .loss_error
            .is_some_and(|error| error.decrease > LARGEST_DECREASE);
        if loss_is_wrong {
            Verdict::NotCausal
        } else if self.residual <= self.threshold {
            Verdict::Causal
        } else if self.residual_lower_bound > self.threshold {
            Verdict::NotCausal
        } else {
            Verdict::Undecided
        }
    }
}

/// Whitened problem of finding the sum of `columns` that is nearest to `target`.
fn whitened_problem(
    common: &CommonErrors,
    mut columns: Vec<Vec<f64>>,
    target: &[f64],
) -> NonNegativeProblem {
    let mut whitened = target.to_vec();
    common.whiten(&mut whitened);
    for column in &mut columns {
        common.whiten(column);
    }
    // By optimality, the sum of columns A x* has |C^{-1/2} A x*| <= |C^{-1/2} b|. Columns without
    // negative entries have a sum of at least their length: |x*|₁ <= |A x*|₁ <= √m |A x*|.
    let largest_sum = (target.len() as f64).sqrt() * length(&whitened) * common.shortening();
    NonNegativeProblem::new(columns, whitened, largest_sum)
}

/// Generator of the cone of moduli.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Element {
    /// 1 Pa.
    Spring,
    /// 1 Pa s.
    Dashpot,
    /// 1 Pa with a relaxation time \[s\].
    Branch { relaxation_time: f64 },
}

impl Element {
    fn at(self, omega: f64) -> Complex64 {
        match self {
            Self::Spring => Complex64::ONE,
            Self::Dashpot => Complex64::new(0.0, omega),
            Self::Branch { relaxation_time } => {
                let s_tau = Complex64::new(0.0, omega * relaxation_time);
                s_tau / (1.0 + s_tau)
            }
        }
    }
}

/// Lowest and highest frequency.
#[derive(Debug, Clone, Copy)]
struct Band {
    lowest: f64,
    highest: f64,
}

fn check(omega: &[f64], modulus: &[Complex64]) -> Result<Band, RodwaveError> {
    check_length("array of moduli", modulus.len(), omega.len())?;
    check_enough_samples("array of moduli", omega.len(), 3)?;
    let mut band = Band {
        lowest: f64::INFINITY,
        highest: 0.0,
    };
    for (&omega, modulus) in omega.iter().zip(modulus) {
        check_positive("angular frequency of a line [rad/s]", omega)?;
        check_positive("magnitude of the complex modulus [Pa]", modulus.norm())?;
        band = Band {
            lowest: band.lowest.min(omega),
            highest: band.highest.max(omega),
        };
    }
    check_positive(
        "slowest relaxation time of the grid [s]",
        SLOWEST / band.lowest,
    )?;
    let width = band.highest / band.lowest;
    let quantity = "ratio of the highest to the lowest frequency";
    check_that(width <= WIDEST, quantity, width, "at most 1e50")?;
    Ok(band)
}

/// Distance in ln τ between neighbouring relaxation times of the grid.
fn grid_step() -> f64 {
    LN_10 / f64::from(GRID_PER_DECADE)
}

fn elements(band: Band) -> Vec<Element> {
    let (fastest, slowest) = (FASTEST / band.highest, SLOWEST / band.lowest);
    let times = std::iter::successors(Some(fastest), |time| Some(time * grid_step().exp()))
        .take_while(|time| *time < slowest)
        .chain([slowest])
        .map(|relaxation_time| Element::Branch { relaxation_time });
    [Element::Spring, Element::Dashpot]
        .into_iter()
        .chain(times)
        .collect()
}

/// Error of the modulus of a causal material due to the grid and to rounding, as the root mean
/// square relative to `scale`.
fn grid_error(modulus: &[Complex64], scale: &[f64]) -> f64 {
    let n = modulus.len() as f64;
    let mean_square = |part: fn(&Complex64) -> f64| -> f64 {
        let scaled = modulus.iter().zip(scale);
        scaled
            .map(|(m, scale)| (part(m) / scale).powi(2))
            .sum::<f64>()
            / n
    };
    let grid = grid_step().powi(2) / 8.0 * grid_step().exp();
    grid * mean_square(|modulus| modulus.im.max(0.0)).sqrt()
        + ROUNDING * mean_square(|modulus| modulus.norm()).sqrt()
}

fn lines(omega: &[f64], modulus: &[Complex64], material: &[(Element, f64)]) -> Vec<ResidualLine> {
    omega
        .iter()
        .zip(modulus)
        .map(|(&omega, &modulus)| {
            let causal_modulus: Complex64 = material
                .iter()
                .map(|(element, amount)| element.at(omega) * amount)
                .sum();
            ResidualLine {
                omega,
                modulus,
                causal_modulus,
                residual: (modulus - causal_modulus) / modulus.norm(),
            }
        })
        .collect()
}

fn amount_of(material: &[(Element, f64)], wanted: Element) -> f64 {
    let of_kind = material.iter().filter(|(element, _)| *element == wanted);
    of_kind.map(|(_, amount)| amount).sum()
}
