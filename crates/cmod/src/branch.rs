//! Selection of the root of cosh(γL) = Ψ that belongs to a travelling wave.
//!
//! For a specimen with a free end the equation is solved in closed form (Ödeen 1993, paper A, eqs.
//! 3-4, after Lundberg and Blanc), up to two integers s and n:
//!
//! ```text
//! αL = arsinh (C - A)^½ ,    kL = s β + nπ ,    β = arcsin (C + A)^½ ,
//! A = (1 - r²)/2 ,    B = r sin φ ,    C = (A² + B²)^½ ,    Ψ = r e^{iφ}
//! ```
//!
//! The integers are chosen such that k(ω) is continuous and increases from k(0) = 0. The quadrant
//! of kL is the quadrant of φ:
//!
//! | kL | 0 ... π/2 | π/2 ... π | π ... 3π/2 | 3π/2 ... 2π | and so on |
//! |---|---|---|---|---|---|
//! | cos φ, sin φ | + + | - + | - - | + - | |
//! | s | +1 | -1 | +1 | -1 | |
//! | n | 0 | 1 | 1 | 2 | |
//!
//! This is Table 1 of paper A, re-derived because its layout is lost in print.
//!
//! The quadrant determines kL up to multiples of 2π. At low losses noise moves φ into the
//! neighbouring quadrant on every line near kL = nπ. Therefore the branch of a line is not
//! determined from its ratio alone: γ(ω) is inferred from all lines together, and on each line the
//! root nearest to γ(ω) is then chosen.
//!
//! # Inference
//! The state consists of γ and dγ/dω, which change smoothly with frequency: dγ/dω varies by 15 %
//! per e-fold of frequency. At the first line dγ/dω equals γ/ω within 5 %, apart from the
//! dispersion that causality couples to damping. The measured Ψ of a line is the Ψ of the state
//! plus noise of known variance; one line in a hundred may be an outlier. Every root of the first
//! well-determined lines starts a course, that is, a possible γ(ω). A Kalman filter follows each
//! course, and the course is weighted by how well it predicts the next lines. After a gap in which
//! the phase is lost, the course branches. The courses that remain at the last line are smoothed
//! back to the first line. The method is that of Viterbi, with forward and backward recursion, but
//! with a normal distribution in place of each discrete state.
//!
//! The result per line is a root and its [confidence](TrackedLine::confidence): the probability
//! that the true γℓ, with ℓ = L for a specimen of length L, is nearer to this root than to any
//! other. Below [`LEAST_CONFIDENCE`] the line is [doubtful](BranchDoubt).
//!
//! # Limits
//! - The number of waves below the first line cannot be determined if 5 % of this number is half a
//!   wave or more. Several speeds are then equally probable, and every line is doubtful unless
//!   there is an anchor: a wave speed, a known branch, or a second specimen of another length
//!   ([`BranchTracker`]).
//! - Waves cannot be counted on lines that are all farther apart than half a wave: kL is assumed to
//!   advance by less than π between the two closest lines. The transit time through the specimen
//!   must therefore be less than half the length of the record.
//! - A stretch of lines that do not lie on a smooth curve is doubtful; if kL advances by more than
//!   half a wave over the stretch, all following lines are also doubtful.
//!
//! [`resolve`] handles one record with a free end; [`BranchTracker`] handles any
//! [`PhaseObservation`], including a specimen with a mass at its end and a wave that has travelled
//! a distance.
//!
//! Theory: `docs/theory/branches.md`.

mod anchor;
mod doubt;
mod forward;
mod noise;
mod observation;
mod path;
mod sequence;
mod tracked;
mod tracker;
mod verdict;
pub(crate) mod wave_speed;

pub use doubt::BranchDoubt;
pub use observation::{EndMass, FreeEnd, PhaseObservation, Travel};
pub(crate) use sequence::resolve_lines;
pub use sequence::{ResolvedRoot, resolve};
pub use tracked::{SpeedHypothesis, TrackedBranches, TrackedLine};
pub use tracker::{BranchTracker, FASTEST_WAVE, PhaseRecord, SLOWEST_WAVE};
pub use verdict::LEAST_CONFIDENCE;

use std::f64::consts::{FRAC_PI_2, LN_2, PI, TAU};

use num_complex::Complex64;

/// Ratio above which cosh x equals e^x/2 with an error far below rounding.
const HUGE: f64 = 1e100;

/// Closed-form solution of cosh(γL) = Ψ, except for the integers s and n (paper A, eqs. 3-4; paper
/// B, eqs. 8-9); symbols as in the [module](self).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeEndRoot {
    damping_length: f64,
    angle: f64,
    principal_phase: f64,
}

impl FreeEndRoot {
    /// Solves the equation for the acceleration ratio Ψ = â₁/â₂.
    ///
    /// C - A and C + A are sinh² αL and sin² kL. The smaller of the two is computed from their
    /// product B², so that neither loses digits. β is computed from its sine and cosine, so that it
    /// keeps its digits near π/2.
    #[must_use]
    pub fn of(acceleration_ratio: Complex64) -> Self {
        if acceleration_ratio.l1_norm() > HUGE {
            return Self::of_huge(acceleration_ratio);
        }
        let Complex64 { re, im } = acceleration_ratio;
        let a = 0.5 * ((1.0 - re) * (1.0 + re) - im * im);
        let c = a.hypot(im);
        let larger = c + a.abs();
        let smaller = if larger > 0.0 { im * im / larger } else { 0.0 };
        let (sinh_squared, sine_squared) = if a >= 0.0 {
            (smaller, larger)
        } else {
            (larger, smaller)
        };
        let sine = sine_squared.sqrt();
        let cosine = re / (1.0 + sinh_squared).sqrt();
        let angle = sine.atan2(cosine.abs());
        let phase = if cosine < 0.0 { PI - angle } else { angle };
        Self {
            damping_length: sinh_squared.sqrt().asinh(),
            angle,
            principal_phase: phase.copysign(im),
        }
    }

    /// Solves e^x/2 = Ψ, which replaces cosh x = Ψ for a ratio above [`HUGE`]: the squares of
    /// larger ratios would overflow.
    fn of_huge(acceleration_ratio: Complex64) -> Self {
        let phase = acceleration_ratio.arg();
        Self {
            // the factor 0.25 prevents overflow of the magnitude itself
            damping_length: (0.25 * acceleration_ratio).norm().ln() + 3.0 * LN_2,
            angle: phase.abs().min(PI - phase.abs()),
            principal_phase: phase,
        }
    }

    /// Returns γL on a `branch`.
    #[must_use]
    pub fn on(&self, branch: Branch) -> Complex64 {
        let phase = f64::from(branch.sign) * self.angle + f64::from(branch.half_waves) * PI;
        Complex64::new(self.damping_length, phase)
    }

    /// Returns the root nearest to `expected` among ±γL + 2πi m.
    pub(crate) fn nearest_to(&self, expected: Complex64) -> Complex64 {
        let [nearest, _] = self.nearest_roots(expected);
        nearest
    }

    /// Returns the roots nearest to `expected` among γL + 2πi m and among -γL + 2πi m, the nearer
    /// of the two first.
    fn nearest_roots(&self, expected: Complex64) -> [Complex64; 2] {
        let near = |root: Complex64| {
            root + Complex64::new(0.0, TAU * ((expected.im - root.im) / TAU).round())
        };
        let (decaying, growing) = (near(self.principal()), near(-self.principal()));
        if (decaying - expected).norm_sqr() <= (growing - expected).norm_sqr() {
            [decaying, growing]
        } else {
            [growing, decaying]
        }
    }

    /// Returns γL with a phase between -π and π.
    fn principal(&self) -> Complex64 {
        Complex64::new(self.damping_length, self.principal_phase)
    }
}

/// Integers s and n of kL = sβ + nπ (paper A, eq. 3 and Table 1; paper B, Table 1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Branch {
    sign: i8,
    half_waves: u32,
}

impl Branch {
    /// Returns the branch of quadrant `quadrant` = 0, 1, 2, ... of kL, each π/2 wide (paper A,
    /// Table 1).
    ///
    /// ```
    /// use cmod::branch::Branch;
    ///
    /// let branches: Vec<_> = (0..4).map(Branch::in_quadrant).map(|b| (b.sign(), b.half_waves())).collect();
    /// assert_eq!(branches, [(1, 0), (-1, 1), (1, 1), (-1, 2)]);
    /// ```
    #[must_use]
    pub fn in_quadrant(quadrant: u32) -> Self {
        Self {
            sign: if quadrant.is_multiple_of(2) { 1 } else { -1 },
            half_waves: quadrant / 2 + quadrant % 2,
        }
    }

    /// Returns the branch on which `phase` kL >= 0 lies.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the cast saturates, and no specimen is 2^32 quarter waves long"
    )]
    fn at(phase: f64) -> Self {
        Self::in_quadrant((phase / FRAC_PI_2) as u32)
    }

    /// Returns s, +1 or -1.
    #[must_use]
    pub fn sign(&self) -> i8 {
        self.sign
    }

    /// Returns n, the number of half waves in the specimen, rounded to the nearest.
    #[must_use]
    pub fn half_waves(&self) -> u32 {
        self.half_waves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the root for |Ψ| = 1e150: cosh x is then e^x/2, so that αL = ln 2|Ψ| and kL is the
    /// phase of Ψ.
    #[test]
    fn a_ratio_whose_squares_overflow_has_the_root_of_the_exponential() {
        for phase in [2.5_f64, -0.5] {
            let root = FreeEndRoot::of(Complex64::from_polar(1e150, phase));
            assert!((root.damping_length - (LN_2 + 150.0 * 10.0_f64.ln())).abs() < 1e-12);
            assert!((root.principal_phase - phase).abs() < 1e-15);
            let angle = phase.abs().min(PI - phase.abs());
            assert!((root.angle - angle).abs() < 1e-15);
        }
    }

    /// Compares with equations 3 and 4 as printed (Ödeen 1993, paper B, eqs. 8 and 9).
    #[test]
    fn closed_form_is_that_of_paper_a() {
        for (r, phi) in [
            (0.3_f64, 0.4_f64),
            (1.7, 2.0),
            (0.9, 4.0),
            (2.5, 6.0),
            (1.0, 1.0),
        ] {
            let a = 0.5 * (1.0 - r * r);
            let b = r * phi.sin();
            let c = a.hypot(b);
            let root = FreeEndRoot::of(Complex64::from_polar(r, phi));
            // tolerance: the differences in the printed equations lose up to two digits
            assert!((root.damping_length - (c - a).sqrt().asinh()).abs() < 1e-13);
            assert!((root.angle - (c + a).sqrt().asin()).abs() < 1e-13);
        }
    }

    /// Checks the solution near Ψ = 1 and near the imaginary axis, where the printed arcsine loses
    /// half of its digits.
    #[test]
    fn closed_form_keeps_its_digits_at_the_quadrant_borders() {
        for phase in [1e-9, FRAC_PI_2 - 1e-9, FRAC_PI_2 + 1e-9] {
            let gamma_length = Complex64::new(1e-9, phase);
            let root = FreeEndRoot::of(gamma_length.cosh());
            if phase < 1.0 {
                // the real part of cosh γL rounds to 1, which leaves γL uncertain by the root of
                // the rounding error
                assert!(root.angle < 2e-8 && root.damping_length < 2e-8);
            } else {
                assert!((root.principal_phase - phase).abs() < 1e-15);
                assert!((root.damping_length - 1e-9).abs() < 1e-15);
            }
        }
        assert!(FreeEndRoot::of(Complex64::ONE).angle < f64::MIN_POSITIVE);
        assert!((FreeEndRoot::of(Complex64::ZERO).angle - FRAC_PI_2).abs() < 1e-16);
    }
}
