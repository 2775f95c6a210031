//! The branch along a sequence of lines.
//!
//! Not the phase φ of Ψ is unwrapped, which at low losses jumps by almost π from one line to the next, but kL itself,
//! which is nearly proportional to ω. Of all roots ±γL + 2πi m the one is taken that is nearest, in the plane of γL, to
//! what the lines before lead to expect: their mean γL/ω, each weighted by how well its Ψ determines it, with a memory of
//! a quarter wave. At kL = nπ, where ±γL + 2πi m meet and noise could lead the count astray, the lines have almost no
//! weight, and those from the middle of the half wave decide.
//!
//! The roots of negative damping among them are never admissible. But where noise has changed the sign of a small Im Ψ
//! such a root is the continuous one, and the line is lost without taking the next ones with it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use num_complex::Complex64;

use super::{Branch, FreeEndRoot};
use crate::error::{CmodError, check_frequencies, check_length};

/// Why the branch of a line may be wrong.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BranchDoubt {
    /// The lines do not start below the first half wavelength, or too far above 0 to say.
    #[error(
        "extrapolated to 0 Hz the first lines give kL = {intercept:.2}, expected 0: the count of waves may be wrong"
    )]
    Start {
        /// kL at ω = 0 by a straight line through the first lines, in rad.
        intercept: f64,
    },
    /// The root lies far from what the lines before lead to expect.
    #[error("kL = {found:.2}, expected {expected:.2} from the lines before")]
    Leap {
        /// What the lines before lead to expect, in rad.
        expected: f64,
        /// The nearest root, in rad.
        found: f64,
    },
    /// Too much lies between this line and the one before to count the waves by proportion.
    #[error(
        "kL is expected to advance by {advance:.2} from the line before, more than half a wave"
    )]
    Gap {
        /// Expected advance of kL, in rad.
        advance: f64,
    },
    /// The first lines are explained nearly as well by another wave speed.
    #[error(
        "a wave speed of {other:.0} m/s explains the first lines nearly as well as {chosen:.0} m/s"
    )]
    SeveralSpeeds {
        /// The speed taken [m/s].
        chosen: f64,
        /// The other one [m/s].
        other: f64,
    },
    /// There are too few lines to tell one wave speed from another, and there was no guess.
    #[error(
        "{found} lines are too few to find the wave speed, expected {expected} or a guess of it"
    )]
    FewLines {
        /// Number of lines.
        found: usize,
        /// What is needed.
        expected: usize,
    },
    /// Over a quarter wave, here or before, most of the information is in lines of negative damping: the count has turned
    /// back at a multiple of π, or Ψ is the complex conjugate, or the damping is lost in noise.
    #[error(
        "negative damping prevails at kL = {phase:.2}: the count of waves may have turned back there"
    )]
    Turned {
        /// kL where this was first so, in rad.
        phase: f64,
    },
    /// The continuous root has negative damping: Im Ψ has the wrong sign.
    #[error("the continuous root has negative damping, alpha L = {damping_length:.1e}")]
    NegativeDamping {
        /// αL.
        damping_length: f64,
    },
    /// The wave number is lower than on the line before. With noise this happens on any branch.
    #[error("kL falls from {previous:.3} to {found:.3}")]
    Decrease {
        /// kL of the line before, in rad.
        previous: f64,
        /// kL of this line, in rad.
        found: f64,
    },
}

impl BranchDoubt {
    /// Whether the count of waves itself is doubtful, and not just this line noisy.
    #[must_use]
    pub fn is_ambiguous(&self) -> bool {
        matches!(
            self,
            Self::Start { .. }
                | Self::Leap { .. }
                | Self::Gap { .. }
                | Self::SeveralSpeeds { .. }
                | Self::FewLines { .. }
                | Self::Turned { .. }
        )
    }
}

/// The root of a line with its branch.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ResolvedRoot {
    /// γL of a specimen without end mass; the real part is negative under [`BranchDoubt::NegativeDamping`].
    pub gamma_length: Complex64,
    /// The integers s and n of Table 1.
    pub branch: Branch,
    /// The weightiest reason to doubt the branch, if there is one.
    pub doubt: Option<BranchDoubt>,
}

/// Solves cosh(γL) = Ψ on increasing frequencies, with k continuous from k(0) = 0.
///
/// `frequency_hz` and `acceleration_ratio` have one entry a line. A line at 0 Hz gives γ = 0, whatever its ratio.
///
/// # Validity
/// The first line must lie below the first half wavelength, kL < π, and the lines close enough for kL to advance by less
/// than π from one to the next. [`BranchDoubt`] says where this may not have been so. With fewer than three lines the start
/// cannot be judged, and is trusted.
///
/// ```
/// use num_complex::Complex64;
///
/// // a rod of 5 half waves at 1 kHz with a little damping
/// let gamma_length = |f: f64| Complex64::new(0.3, 5.0 * std::f64::consts::PI) * (f / 1000.0);
/// let frequency_hz: Vec<f64> = (1..=50).map(|j| 20.0 * f64::from(j)).collect();
/// let ratio: Vec<Complex64> = frequency_hz.iter().map(|&f| gamma_length(f).cosh()).collect();
/// let roots = cmod::branch::resolve(&frequency_hz, &ratio)?;
/// assert!((roots[49].gamma_length - gamma_length(1000.0)).norm() < 1e-12);
/// assert!(roots.iter().all(|root| root.doubt.is_none()));
/// # Ok::<(), cmod::CmodError>(())
/// ```
///
/// # Errors
/// [`CmodError::NoLines`], [`CmodError::Frequency`], [`CmodError::FrequencyOrder`], [`CmodError::LengthMismatch`];
/// [`CmodError::NonFiniteRatio`].
pub fn resolve(
    frequency_hz: &[f64],
    acceleration_ratio: &[Complex64],
) -> Result<Vec<ResolvedRoot>, CmodError> {
    check_frequencies(frequency_hz)?;
    check_length(
        "acceleration ratio",
        acceleration_ratio.len(),
        frequency_hz.len(),
    )?;
    let mut roots = Vec::with_capacity(frequency_hz.len());
    let mut start = Start::default();
    let mut expectation: Option<Expectation> = None;
    let mut turned = None;
    for (index, (&frequency_hz, &ratio)) in frequency_hz.iter().zip(acceleration_ratio).enumerate()
    {
        if !ratio.is_finite() {
            return Err(CmodError::NonFiniteRatio { index, ratio });
        }
        if frequency_hz == 0.0 {
            roots.push(ResolvedRoot {
                gamma_length: Complex64::ZERO,
                branch: Branch::at(0.0),
                doubt: None,
            });
            continue;
        }
        let free_end = FreeEndRoot::of(ratio);
        let (gamma_length, doubt) = match &expectation {
            Some(expectation) => expectation.choose(&free_end, frequency_hz),
            None => first_root(&free_end),
        };
        let information = free_end.information();
        start.add(frequency_hz, free_end.principal_phase, information);
        let updated = match expectation {
            Some(expectation) => expectation.updated(frequency_hz, gamma_length, information),
            None => Expectation::from_first(frequency_hz, gamma_length, information),
        };
        if turned.is_none() && updated.has_turned() {
            turned = Some(BranchDoubt::Turned {
                phase: gamma_length.im,
            });
        }
        expectation = Some(updated);
        roots.push(ResolvedRoot {
            gamma_length,
            branch: Branch::at(gamma_length.im),
            doubt: turned.or(doubt),
        });
    }
    if let Some(doubt) = start.doubt() {
        for root in &mut roots {
            root.doubt = Some(doubt);
        }
    }
    Ok(roots)
}

/// The root of the first line, in the first half wave. In the quadrants below it, Im Ψ < 0, it has negative damping.
fn first_root(free_end: &FreeEndRoot) -> (Complex64, Option<BranchDoubt>) {
    let gamma_length = free_end.nearest_to(Complex64::ZERO);
    let gamma_length = with_positive_wave_number(gamma_length);
    (gamma_length, negative_damping(gamma_length))
}

/// γL and -γL are the same root; the one that travels along +x.
fn with_positive_wave_number(gamma_length: Complex64) -> Complex64 {
    if gamma_length.im < 0.0 {
        -gamma_length
    } else {
        gamma_length
    }
}

fn negative_damping(gamma_length: Complex64) -> Option<BranchDoubt> {
    (gamma_length.re < 0.0).then_some(BranchDoubt::NegativeDamping {
        damping_length: gamma_length.re,
    })
}

/// Over this advance of kL, from the middle of a half wave to its end, a line loses 1/e of its weight.
const MEMORY: f64 = FRAC_PI_2;

/// What the lines so far lead to expect: γL in proportion to frequency, near enough over a quarter wave.
struct Expectation {
    /// Weighted mean of γL/f \[s\].
    slowness: Complex64,
    weight: f64,
    /// Part of the weight that belongs to lines of negative damping.
    growing: f64,
    last_hz: f64,
    last_phase: f64,
}

impl Expectation {
    fn from_first(frequency_hz: f64, gamma_length: Complex64, information: f64) -> Self {
        let weight = frequency_hz * frequency_hz * information;
        Self {
            slowness: gamma_length / frequency_hz,
            weight,
            growing: if gamma_length.re < 0.0 { weight } else { 0.0 },
            last_hz: frequency_hz,
            last_phase: gamma_length.im,
        }
    }

    /// Expected advance of kL from the last line.
    fn advance(&self, frequency_hz: f64) -> f64 {
        self.slowness.im * (frequency_hz - self.last_hz)
    }

    /// The root of the next line.
    fn choose(
        &self,
        free_end: &FreeEndRoot,
        frequency_hz: f64,
    ) -> (Complex64, Option<BranchDoubt>) {
        let expected = Complex64::new(self.slowness.re.max(0.0), self.slowness.im) * frequency_hz;
        let gamma_length = with_positive_wave_number(free_end.nearest_to(expected));
        let advance = self.advance(frequency_hz);
        let found = gamma_length.im;
        let doubt = if advance > PI {
            Some(BranchDoubt::Gap { advance })
        } else if (found - expected.im).abs() > FRAC_PI_2 {
            Some(BranchDoubt::Leap {
                expected: expected.im,
                found,
            })
        } else {
            negative_damping(gamma_length).or_else(|| {
                (found < self.last_phase).then_some(BranchDoubt::Decrease {
                    previous: self.last_phase,
                    found,
                })
            })
        };
        (gamma_length, doubt)
    }

    /// Whether negative damping prevails; below the first quarter wave a few lost lines may do that.
    fn has_turned(&self) -> bool {
        self.last_phase > FRAC_PI_2 && self.growing > 0.5 * self.weight
    }

    /// With one more line. The weight of γL/f is inverse to its variance for a given error of Ψ.
    fn updated(self, frequency_hz: f64, gamma_length: Complex64, information: f64) -> Self {
        let memory = (-self.advance(frequency_hz) / MEMORY).exp();
        let kept = self.weight * memory;
        let new = frequency_hz * frequency_hz * information;
        let weight = kept + new;
        let growing = if gamma_length.re < 0.0 { new } else { 0.0 };
        let slowness = if weight > 0.0 {
            (kept * self.slowness + new * (gamma_length / frequency_hz)) / weight
        } else {
            gamma_length / frequency_hz
        };
        Self {
            slowness,
            weight,
            growing: self.growing * memory + growing,
            last_hz: frequency_hz,
            last_phase: gamma_length.im,
        }
    }
}

/// Sums of a weighted straight line through kL on the lines of the first half wave, three at least.
///
/// It judges the start and must not depend on it: the phases are those of positive damping, unwrapped from line to line.
/// A start in the first half wave shows as an intercept of a few per cent of kL at ω = 0, a later one as -2π or more.
#[derive(Default)]
struct Start {
    first_phase: Option<f64>,
    last_phase: f64,
    count: u32,
    complete: bool,
    weight: f64,
    f: f64,
    k: f64,
    ff: f64,
    fk: f64,
}

impl Start {
    fn add(&mut self, frequency_hz: f64, principal_phase: f64, information: f64) {
        let turns = ((self.last_phase - principal_phase) / TAU).round();
        let phase = principal_phase + turns * TAU;
        let first_phase = *self.first_phase.get_or_insert(phase);
        self.last_phase = phase;
        self.complete |= self.count >= 3 && (phase - first_phase).abs() > PI;
        if self.complete {
            return;
        }
        self.count += 1;
        self.weight += information;
        self.f += information * frequency_hz;
        self.k += information * phase;
        self.ff += information * frequency_hz * frequency_hz;
        self.fk += information * frequency_hz * phase;
    }

    fn doubt(&self) -> Option<BranchDoubt> {
        let determinant = self.weight * self.ff - self.f * self.f;
        if self.count < 3 || determinant <= 0.0 {
            return None;
        }
        let intercept = (self.ff * self.k - self.f * self.fk) / determinant;
        (intercept.abs() > FRAC_PI_2).then_some(BranchDoubt::Start { intercept })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(count: u32, step_hz: f64) -> Vec<f64> {
        (1..=count).map(|j| step_hz * f64::from(j)).collect()
    }

    /// 40 half waves of a rod that is nearly elastic: φ jumps by almost π at every quarter wave, kL does not.
    #[test]
    fn branch_is_followed_at_losses_near_zero_and_in_none_at_all() {
        for loss in [0.0, 1e-6, 1e-2] {
            let frequency_hz = lines(400, 50.0);
            let exact = |f: f64| Complex64::new(0.5 * loss, 1.0) * (PI * 40.0 * f / 20_000.3);
            let ratio: Vec<_> = frequency_hz.iter().map(|&f| exact(f).cosh()).collect();
            for (f, root) in frequency_hz
                .iter()
                .zip(resolve(&frequency_hz, &ratio).unwrap())
            {
                // At kL = nπ - 1e-5 without losses half of the digits of γL are lost in Ψ.
                assert!(
                    (root.gamma_length - exact(*f)).norm() < 1e-7,
                    "{f} Hz, loss {loss}"
                );
                assert_eq!(root.doubt, None, "{f} Hz, loss {loss}");
                let closed_form = FreeEndRoot::of(exact(*f).cosh()).on(root.branch);
                assert!((closed_form.im - root.gamma_length.im).abs() < 1e-12);
            }
        }
    }

    /// A line whose noise turned the sign of Im Ψ is lost, the next ones are not.
    #[test]
    fn a_wrong_sign_costs_one_line() {
        let frequency_hz = lines(100, 100.0);
        let exact = |f: f64| Complex64::new(0.01, 1.0) * (PI * 6.0 * f / 10_000.0);
        let mut ratio: Vec<_> = frequency_hz.iter().map(|&f| exact(f).cosh()).collect();
        ratio[70] = ratio[70].conj();
        let roots = resolve(&frequency_hz, &ratio).unwrap();
        assert!(matches!(
            roots[70].doubt,
            Some(BranchDoubt::NegativeDamping { .. })
        ));
        for index in (0..100).filter(|index| *index != 70) {
            assert_eq!(roots[index].doubt, None, "{index}");
            assert!((roots[index].gamma_length - exact(frequency_hz[index])).norm() < 1e-12);
        }
    }

    /// Lines that begin above the first half wave cannot be counted, and every line says so.
    #[test]
    fn a_late_start_is_doubted_on_every_line() {
        let exact = |f: f64| Complex64::new(0.02, 1.0) * (PI * 6.0 * f / 10_000.0);
        for first in [19, 38, 60] {
            let frequency_hz: Vec<f64> = lines(100, 100.0).split_off(first);
            let ratio: Vec<_> = frequency_hz.iter().map(|&f| exact(f).cosh()).collect();
            let roots = resolve(&frequency_hz, &ratio).unwrap();
            assert!(
                roots
                    .iter()
                    .all(|root| root.doubt.is_some_and(|d| d.is_ambiguous())),
                "from line {first}"
            );
        }
    }

    /// A line that does not belong to the record, and lines so far apart that the waves between them cannot be counted.
    #[test]
    fn leaps_and_gaps_are_doubted() {
        // kL = 0.3 a line, and one more at the frequency of line `last_line` with kL off by `shift`
        let last_doubt = |last_line: f64, shift: f64| {
            let mut frequency_hz = lines(10, 1.0);
            frequency_hz.push(last_line);
            let ratio: Vec<_> = frequency_hz
                .iter()
                .map(|f| {
                    let shift = if *f > 10.0 { shift } else { 0.0 };
                    Complex64::new(0.02 * f, 0.3 * f + shift).cosh()
                })
                .collect();
            resolve(&frequency_hz, &ratio).unwrap()[10].doubt
        };
        assert_eq!(last_doubt(11.0, 0.0), None);
        assert!(matches!(
            last_doubt(11.0, 1.9),
            Some(BranchDoubt::Leap { .. })
        ));
        assert_eq!(last_doubt(20.0, 0.0), None);
        assert!(matches!(
            last_doubt(21.0, 0.0),
            Some(BranchDoubt::Gap { .. })
        ));
    }

    /// Spectra of the other time factor: negative damping in the first quarter wave, doubt on every line above.
    #[test]
    fn conjugate_data_are_found_out() {
        let frequency_hz = lines(100, 100.0);
        let ratio: Vec<_> = frequency_hz
            .iter()
            .map(|f| {
                (Complex64::new(0.01, 1.0) * (PI * 6.0 * f / 10_000.0))
                    .cosh()
                    .conj()
            })
            .collect();
        for root in resolve(&frequency_hz, &ratio).unwrap() {
            let doubted = root.doubt.is_some_and(|doubt| doubt.is_ambiguous());
            assert!(doubted || (root.gamma_length.re < 0.0 && root.gamma_length.im < FRAC_PI_2));
        }
    }

    #[test]
    fn bad_lines_are_errors() {
        let ratio = [Complex64::ONE; 2];
        assert_eq!(resolve(&[], &[]), Err(CmodError::NoLines));
        assert!(matches!(
            resolve(&[2.0, 1.0], &ratio),
            Err(CmodError::FrequencyOrder { index: 1, .. })
        ));
        assert!(matches!(
            resolve(&[1.0], &ratio),
            Err(CmodError::LengthMismatch {
                found: 2,
                expected: 1,
                ..
            })
        ));
        assert!(matches!(
            resolve(&[f64::NAN, 1.0], &ratio),
            Err(CmodError::Frequency { index: 0, .. })
        ));
        let nan = [Complex64::ONE, Complex64::new(f64::NAN, 0.0)];
        assert!(matches!(
            resolve(&[1.0, 2.0], &nan),
            Err(CmodError::NonFiniteRatio { index: 1, .. })
        ));
        let at_rest = resolve(&[0.0, 1.0], &ratio).unwrap();
        assert_eq!(at_rest[0].gamma_length, Complex64::ZERO);
    }
}
