//! Branches of the lines of one record, in the form that the methods of this crate use.

use num_complex::Complex64;

use super::observation::{EndMass, FreeEnd};
use super::tracked::TrackedLine;
use super::tracker::{BranchTracker, PhaseRecord};
use super::{Branch, BranchDoubt, FreeEndRoot};
use crate::error::{CmodError, check_frequencies, check_length};

/// Root of a line with its branch.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ResolvedRoot {
    /// γL of a specimen without end mass; the real part is negative under
    /// [`BranchDoubt::NegativeDamping`].
    pub gamma_length: Complex64,
    /// The integers s and n of Table 1.
    pub branch: Branch,
    /// Probability of the branch, see [`TrackedLine::confidence`].
    pub confidence: f64,
    /// γL from this line and the lines around it; with the end mass, if there is one.
    pub expected: Complex64,
    /// Standard error of the real part and of the imaginary part of `expected`.
    pub expected_error: f64,
    /// Root γL of the equation with end mass that is nearest to `expected`, `None` if there is no
    /// root nearby; without end mass it is equal to `gamma_length`.
    pub loaded_gamma_length: Option<Complex64>,
    /// Main reason to doubt the branch, if there is one.
    pub doubt: Option<BranchDoubt>,
}

impl ResolvedRoot {
    /// Returns the doubt, unless only the damping is doubtful.
    pub(crate) fn ambiguity(&self) -> Option<BranchDoubt> {
        self.doubt.filter(BranchDoubt::is_ambiguous)
    }
}

/// Solves cosh(γL) = Ψ on increasing frequencies, with k continuous from k(0) = 0.
///
/// `frequency_hz` and `acceleration_ratio` have one entry per line. A line at 0 Hz gives γ = 0,
/// whatever its ratio. The noise of Ψ is estimated from its scatter. [`BranchTracker`] also accepts
/// a stated noise, gaps, several records and prior knowledge. A wave speed in a [`BranchDoubt`] is
/// in specimen lengths per second, because the function is given no length.
///
/// # Validity
/// The lines must be close enough for kL to advance by less than π per line. A [`BranchDoubt`]
/// marks each line whose branch may be wrong.
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
/// [`CmodError::NoLines`], [`CmodError::Frequency`], [`CmodError::FrequencyOrder`],
/// [`CmodError::LengthMismatch`]; [`CmodError::NonFiniteRatio`].
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
    let bad = acceleration_ratio
        .iter()
        .enumerate()
        .find(|(_, ratio)| !ratio.is_finite());
    if let Some((index, &ratio)) = bad {
        return Err(CmodError::NonFiniteRatio { index, ratio });
    }
    let record = PhaseRecord {
        observation: &FreeEnd,
        length: 1.0,
        frequency_hz,
        observed: acceleration_ratio,
        variance: None,
    };
    roots(record, 0.0, &BranchTracker::new().with_any_wave_speed())
}

/// Assigns every line of one specimen to its branch: lines with frequency, ratio and E|δΨ|², a
/// specimen of `length` L \[m\] (or gauges at this distance), and the mass ratio μ. Without lines
/// the list is empty.
pub(crate) fn resolve_lines(
    length: f64,
    mass_ratio: f64,
    lines: impl Iterator<Item = (f64, Complex64, f64)>,
) -> Result<Vec<ResolvedRoot>, CmodError> {
    let (frequency_hz, ratio, variance): (Vec<_>, Vec<_>, Vec<_>) = lines.collect();
    if frequency_hz.is_empty() {
        return Ok(Vec::new());
    }
    let loaded = EndMass { mass_ratio };
    let record = PhaseRecord {
        observation: if mass_ratio > 0.0 { &loaded } else { &FreeEnd },
        length,
        frequency_hz: &frequency_hz,
        observed: &ratio,
        variance: Some(&variance),
    };
    roots(record, mass_ratio, &BranchTracker::new())
}

/// Tracks the roots of the equation with the end mass, not those of a free end: with a heavy mass
/// |Ψ| exceeds 1 without any damping, and k of the free end would be constant there.
fn roots(
    record: PhaseRecord<'_>,
    mass_ratio: f64,
    tracker: &BranchTracker,
) -> Result<Vec<ResolvedRoot>, CmodError> {
    let tracked = tracker.track(&[record])?;
    let lines = tracked.records.into_iter().next().unwrap_or_default();
    Ok(lines
        .iter()
        .zip(record.observed)
        .map(|(line, ratio)| without_end_mass(line, *ratio, mass_ratio))
        .collect())
}

/// Returns the root for a free end, on the same branch as the root with end mass. As μ goes to 0,
/// the phases at which dΨ/d(γL) vanishes, i.e. γL + artanh(μγL/(1 + μ)) = iπn, approach iπn, and γL
/// stays between them.
fn without_end_mass(line: &TrackedLine, ratio: Complex64, mass_ratio: f64) -> ResolvedRoot {
    let loaded = line.root.unwrap_or(line.expected);
    let load = loaded * mass_ratio / (1.0 + mass_ratio);
    let gamma_length = if line.root == Some(Complex64::ZERO) {
        Complex64::ZERO
    } else if mass_ratio > 0.0 {
        let expected = loaded + 0.5 * ((1.0 + load) / (1.0 - load)).ln();
        FreeEndRoot::of(ratio).nearest_to(expected)
    } else {
        loaded
    };
    ResolvedRoot {
        gamma_length,
        branch: Branch::at(gamma_length.im),
        confidence: line.confidence,
        expected: line.expected,
        expected_error: line.expected_error,
        loaded_gamma_length: line.root,
        doubt: line.doubt,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    fn lines(count: u32, step_hz: f64) -> Vec<f64> {
        (1..=count).map(|j| step_hz * f64::from(j)).collect()
    }

    /// 40 half waves of a nearly elastic rod: φ jumps by almost π at every zero of cos kL, but kL
    /// is continuous.
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
                // tolerance: at kL = nπ - 1e-5 without losses, half of the digits of γL are lost in
                // Ψ
                assert!(
                    (root.gamma_length - exact(*f)).norm() < 1e-7,
                    "{f} Hz, loss {loss}: {root:?}"
                );
                assert_eq!(root.doubt, None, "{f} Hz, loss {loss}");
                let closed_form = FreeEndRoot::of(exact(*f).cosh()).on(root.branch);
                assert!((closed_form.im - root.gamma_length.im).abs() < 1e-12);
            }
        }
    }

    /// A line on which noise has changed the sign of Im Ψ is doubtful; the other lines are not.
    #[test]
    fn a_wrong_sign_costs_one_line() {
        let frequency_hz = lines(100, 100.0);
        let exact = |f: f64| Complex64::new(0.01, 1.0) * (PI * 6.0 * f / 10_000.0);
        let mut ratio: Vec<_> = frequency_hz.iter().map(|&f| exact(f).cosh()).collect();
        ratio[70] = ratio[70].conj();
        let roots = resolve(&frequency_hz, &ratio).unwrap();
        assert!(matches!(roots[70].doubt, Some(BranchDoubt::Leap { .. })));
        assert!(roots[70].confidence < 0.5 && roots[70].gamma_length.re < 0.0);
        for index in (0..100).filter(|index| *index != 70) {
            assert_eq!(roots[index].doubt, None, "{index}");
            assert!((roots[index].gamma_length - exact(frequency_hz[index])).norm() < 1e-12);
        }
    }

    /// For lines that begin above the first half wave, the slope gives the number of half waves
    /// below the first line.
    #[test]
    fn a_late_start_is_found_from_the_slope() {
        let exact = |f: f64| Complex64::new(0.02, 1.0) * (PI * 6.0 * f / 10_000.0);
        for first in [19, 38, 60] {
            let frequency_hz: Vec<f64> = lines(100, 100.0).split_off(first);
            let ratio: Vec<_> = frequency_hz.iter().map(|&f| exact(f).cosh()).collect();
            for (f, root) in frequency_hz
                .iter()
                .zip(resolve(&frequency_hz, &ratio).unwrap())
            {
                assert_eq!(root.doubt, None, "{f} Hz from line {first}");
                assert!((root.gamma_length - exact(*f)).norm() < 1e-12);
            }
        }
    }

    /// Every line of a record that begins above 100 half waves is doubtful: a dispersion of a few
    /// per cent then exceeds one half wave, and the count of waves is undetermined.
    #[test]
    fn a_start_behind_very_many_waves_is_doubted_on_every_line() {
        let exact = |f: f64| Complex64::new(0.001, 1.0) * (PI * 100.3 * f / 10_000.0);
        let frequency_hz: Vec<f64> = (0..60).map(|j| 10_000.0 + 2.0 * f64::from(j)).collect();
        let ratio: Vec<_> = frequency_hz.iter().map(|&f| exact(f).cosh()).collect();
        for root in resolve(&frequency_hz, &ratio).unwrap() {
            assert!(
                matches!(root.doubt, Some(BranchDoubt::SeveralSpeeds { .. })),
                "{root:?}"
            );
        }
    }

    /// Spectra with the time factor e^{-iωt} give negative damping in the first quarter wave and a
    /// doubt on every line above.
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
            assert!(
                doubted || (root.gamma_length.re < 0.0 && root.gamma_length.im < FRAC_PI_2),
                "{root:?}"
            );
        }
    }

    #[test]
    fn bad_lines_are_errors() {
        let ratio = [Complex64::ONE; 2];
        let nan = [Complex64::ONE, Complex64::new(f64::NAN, 0.0)];
        assert!(matches!(
            resolve(&[1.0, 2.0], &nan),
            Err(CmodError::NonFiniteRatio { index: 1, .. })
        ));
        let at_rest = resolve(&[0.0, 1.0], &ratio).unwrap();
        assert_eq!(at_rest[0].gamma_length, Complex64::ZERO);
    }
}
