//! The two travelling waves of a uniform rod.
//!
//! Any quantity q that obeys q'' = γ²q, such as strain, velocity or normal force, is (Ödeen 1993,
//! paper B, eqs. 1 and 4)
//!
//! ```text
//! q(x) = P e^{-γx} + N e^{γx}
//! ```
//!
//! P travels and decays along +x, N along -x. The two waves follow from the state (N, v) of one
//! section, or from q at two or more sections at any positions, whatever the ends of the rod are.
//! If one end is free, they follow from the strain at one section ([`FreeEndWaves`]).
//!
//! ```
//! use num_complex::Complex64;
//! use rodwave::waves::TravellingWaves;
//!
//! // strains of 1 and i at two sections a quarter wave apart: one wave, along -x
//! let gamma = Complex64::new(0.0, 1.0);
//! let strain = [Complex64::ONE, Complex64::I];
//! let found = TravellingWaves::from_sections(gamma, &[0.0, std::f64::consts::FRAC_PI_2], &strain)?;
//! assert!(found.waves.forward_at(0.0).norm() < 1e-15);
//! assert!((found.waves.backward_at(0.0) - 1.0).norm() < 1e-15);
//! # Ok::<(), rodwave::RodwaveError>(())
//! ```
//!
//! # Singular frequencies
//! If the distances between all sections are multiples of half a wavelength, the two waves cannot
//! be separated: q(x) determines only P + N (or P - N). At zero frequency, this is the case for any
//! sections. With damping, the problem remains solvable, but it amplifies errors by up to the
//! condition number, which every result contains. Unequal distances between sections move the
//! singular frequencies apart.
//!
//! Theory: `docs/theory/chains.md#waves`.

mod free_end;

pub use free_end::{FreeEndWaves, IncidentWave, PlaceWaves};

use num_complex::Complex64;

use crate::RodwaveError;
use crate::error::{check_enough_samples, check_finite, check_length, check_not_negative};
use crate::transition::State;

/// Pair of waves in a uniform rod.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TravellingWaves {
    propagation_coefficient: Complex64,
    /// Amplitude and position of each wave, at the place where it enters the sections, so that
    /// neither wave is a growing exponential.
    forward: Amplitude,
    backward: Amplitude,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Amplitude {
    value: Complex64,
    position: f64,
}

/// Waves found from several sections.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WaveSeparation {
    /// The waves; if the sections cannot separate them, the smallest pair that fits the values.
    pub waves: TravellingWaves,
    /// Ratio of the largest to the smallest singular value of the problem with columns of unit
    /// length: the largest amplification of relative errors of the values. It is 1 at best; if it
    /// is infinite, the waves cannot be separated.
    pub condition_number: f64,
    /// Root of the sum of the squared residuals over the root of the sum of the squared values; 0
    /// for two sections.
    pub misfit: f64,
}

impl TravellingWaves {
    /// Returns the waves of the normal force at a section of the given `state`, with x = 0 there
    /// (paper E, eq. A15), from the `propagation_coefficient` γ [1/m] and
    /// `characteristic_impedance` Z [kg/s].
    ///
    /// ```text
    /// N̂ = P + N ,    v̂ = (N - P)/Z
    /// ```
    #[must_use]
    pub fn of_normal_force(
        state: State,
        propagation_coefficient: Complex64,
        characteristic_impedance: Complex64,
    ) -> Self {
        let from_velocity = characteristic_impedance * state.velocity;
        let wave = |twice: Complex64| Amplitude {
            value: 0.5 * twice,
            position: 0.0,
        };
        Self {
            propagation_coefficient,
            forward: wave(state.normal_force - from_velocity),
            backward: wave(state.normal_force + from_velocity),
        }
    }

    /// Returns the waves that best fit the `values` of a quantity at `positions` \[m\] in the
    /// least-squares sense, from the `propagation_coefficient` γ [1/m], Re γ >= 0 (paper B,
    /// eqs. 4-5).
    ///
    /// | argument | shape |
    /// |---|---|
    /// | `positions`, `values` | `(n_sections)`, in any order |
    ///
    /// # Errors
    /// [`RodwaveError::TooFewSamples`] for fewer than two sections,
    /// [`RodwaveError::LengthMismatch`] if the lengths differ, [`RodwaveError::NonFiniteSample`]
    /// for a position or a value that is not finite (the error contains the magnitude of the
    /// value), [`RodwaveError::NonPhysical`] for an invalid γ.
    pub fn from_sections(
        propagation_coefficient: Complex64,
        positions: &[f64],
        values: &[Complex64],
    ) -> Result<WaveSeparation, RodwaveError> {
        let gamma = propagation_coefficient;
        check_sections(positions, values)?;
        let mut columns = Columns::of(positions);
        check_coefficient(gamma, columns.reach())?;
        // very large and very small values are scaled, because their squares would leave the range
        // of a double; the scale cancels in the result
        let size = values.iter().map(Complex64::l1_norm).fold(0.0, f64::max);
        let size = check_finite("size of the values at the sections", size)?;
        let size = if (1e-140..1e140).contains(&size) || size == 0.0 {
            1.0
        } else {
            size
        };
        columns.set(gamma);
        let scaled = || values.iter().map(|value| value / size);
        let [mut forward, mut backward] = [Complex64::ZERO; 2];
        for (value, [p, n]) in scaled().zip(columns.weights()) {
            forward += p * value;
            backward += n * value;
        }
        let left = scaled().zip(&columns.rows);
        let left = left.map(|(q, [f, b])| (q - forward * f - backward * b).norm_sqr());
        let unexplained: f64 = left.sum();
        let total: f64 = scaled().map(|q| q.norm_sqr()).sum();
        check_finite(
            "magnitude of the waves at the sections",
            (forward * size).norm() + (backward * size).norm(),
        )?;
        Ok(WaveSeparation {
            waves: Self {
                propagation_coefficient,
                forward: Amplitude {
                    value: forward * size,
                    position: columns.first,
                },
                backward: Amplitude {
                    value: backward * size,
                    position: columns.last,
                },
            },
            condition_number: columns.condition_number(),
            misfit: if total > 0.0 {
                (unexplained / total).sqrt()
            } else {
                0.0
            },
        })
    }

    /// Wave along +x at `position` x \[m\]: P e^{-γx}.
    #[must_use]
    pub fn forward_at(&self, position: f64) -> Complex64 {
        let way = position - self.forward.position;
        self.forward.value * (-self.propagation_coefficient * way).exp()
    }

    /// Wave along -x at `position` x \[m\]: N e^{γx}.
    #[must_use]
    pub fn backward_at(&self, position: f64) -> Complex64 {
        let way = self.backward.position - position;
        self.backward.value * (-self.propagation_coefficient * way).exp()
    }

    /// Sum of both waves at `position` x \[m\].
    #[must_use]
    pub fn at(&self, position: f64) -> Complex64 {
        self.forward_at(position) + self.backward_at(position)
    }
}

/// Waves at one section from the values at other sections, at many lines at once.
///
/// At every line, the waves at x are $`P(x) = \sum_j p_j q_j`$ and $`N(x) = \sum_j n_j q_j`$ with
/// the values $`q_j`$ at the sections, by least squares as in [`TravellingWaves::from_sections`].
/// The weights depend only on the rod and on the sections. They are computed once; each further
/// record costs a multiplication and an addition per line and section.
///
/// | array | shape |
/// |---|---|
/// | propagation coefficients, waves | `(n_lines)` |
/// | values | one row of `(n_lines)` per section |
///
/// ```
/// use num_complex::Complex64;
/// use rodwave::waves::SectionWaves;
///
/// let gamma: Vec<Complex64> = (1..4).map(|k| Complex64::new(0.1, f64::from(k))).collect();
/// // a wave along +x of amplitude 2 at x = 0
/// let at = |x: f64| gamma.iter().map(|g| 2.0 * (-g * x).exp()).collect::<Vec<_>>();
/// let plan = SectionWaves::new(&gamma, &[0.2, 0.5], 0.0)?;
/// let (mut along, mut against) = (vec![Complex64::ZERO; 3], vec![Complex64::ZERO; 3]);
/// plan.waves(&[&at(0.2), &at(0.5)], &mut along, &mut against)?;
/// assert!(along.iter().all(|p| (p - 2.0).norm() < 1e-14) && against.iter().all(|n| n.norm() < 1e-14));
/// # Ok::<(), rodwave::RodwaveError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SectionWaves {
    /// Weights of each section, one pair per line.
    weights: Vec<Vec<[Complex64; 2]>>,
    n_lines: usize,
}

impl SectionWaves {
    /// Prepares the computation of the waves at `section` \[m\] from the values at `positions`
    /// \[m\], for a rod with the propagation coefficients `gamma` [1/m].
    ///
    /// # Errors
    ///
    /// The errors of [`TravellingWaves::from_sections`].
    pub fn new(gamma: &[Complex64], positions: &[f64], section: f64) -> Result<Self, RodwaveError> {
        check_finite("position of a section [m]", section)?;
        check_sections(positions, &vec![Complex64::ZERO; positions.len()])?;
        let mut weights = vec![Vec::with_capacity(gamma.len()); positions.len()];
        let mut columns = Columns::of(positions);
        for gamma in gamma {
            check_coefficient(*gamma, columns.reach())?;
            columns.set(*gamma);
            let to_section = columns.at(*gamma, section);
            for (of_section, weights) in columns.weights().zip(&mut weights) {
                let [forward, backward] = of_section;
                let own = [forward * to_section[0], backward * to_section[1]];
                check_finite(
                    "magnitude of the waves at the sections",
                    own[0].l1_norm() + own[1].l1_norm(),
                )?;
                weights.push(own);
            }
        }
        Ok(Self {
            weights,
            n_lines: gamma.len(),
        })
    }

    /// Writes the waves along and against +x of `values`, which has one row per section.
    ///
    /// # Errors
    ///
    /// [`RodwaveError::LengthMismatch`] if the number of rows or lines differs from that of the
    /// plan.
    pub fn waves(
        &self,
        values: &[&[Complex64]],
        along: &mut [Complex64],
        against: &mut [Complex64],
    ) -> Result<(), RodwaveError> {
        check_length(
            "the list of rows of values at the sections",
            values.len(),
            self.weights.len(),
        )?;
        check_length("the list of lines of the waves", along.len(), self.n_lines)?;
        check_length(
            "the list of lines of the waves",
            against.len(),
            self.n_lines,
        )?;
        along.fill(Complex64::ZERO);
        against.fill(Complex64::ZERO);
        for (weights, values) in self.weights.iter().zip(values) {
            check_length("the list of lines of a section", values.len(), self.n_lines)?;
            let sums = along.iter_mut().zip(against.iter_mut());
            for (([p, n], value), (along, against)) in weights.iter().zip(*values).zip(sums) {
                *along += p * value;
                *against += n * value;
            }
        }
        Ok(())
    }
}

/// Smallest square of a wave by which the product of both waves is divided: with smaller ones, the
/// quotient may leave the range of a double.
const SMALL: f64 = 1e-280;

/// The two waves at each section for one γ: e^{-γ(x - x₁)} and e^{-γ(x_n - x)}, both at most 1.
struct Columns<'a> {
    positions: &'a [f64],
    /// Smallest and largest position, x₁ and x_n.
    first: f64,
    last: f64,
    rows: Vec<[Complex64; 2]>,
    /// Coefficient of the projection of the second column on the first.
    shared: Complex64,
    /// Squares of both columns, and of the part of the second column that is orthogonal to the
    /// first.
    squares: [f64; 2],
    beyond: f64,
}

impl<'a> Columns<'a> {
    fn of(positions: &'a [f64]) -> Self {
        let first = positions.iter().copied().fold(f64::INFINITY, f64::min);
        let last = positions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self {
            positions,
            first,
            last,
            rows: Vec::with_capacity(positions.len()),
            shared: Complex64::ZERO,
            squares: [0.0; 2],
            beyond: 0.0,
        }
    }

    fn reach(&self) -> f64 {
        self.last - self.first
    }

    /// Computes both waves at `section`: the forward wave is 1 at x₁, the backward wave at x_n.
    fn at(&self, gamma: Complex64, section: f64) -> [Complex64; 2] {
        let whole = match self.rows.first() {
            Some([f, b]) => f * b,
            None => Complex64::ONE,
        };
        both_ways(gamma, whole, [section - self.first, self.last - section])
    }

    fn set(&mut self, gamma: Complex64) {
        let whole = (-gamma * self.reach()).exp();
        self.rows.clear();
        for x in self.positions {
            self.rows
                .push(both_ways(gamma, whole, [x - self.first, self.last - x]));
        }
        let rows = || self.rows.iter();
        let forward: f64 = rows().map(|[f, _]| f.norm_sqr()).sum();
        self.squares = [forward, rows().map(|[_, b]| b.norm_sqr()).sum()];
        let shared = rows().map(|[f, b]| f.conj() * b).sum::<Complex64>() / forward;
        self.beyond = rows().map(|[f, b]| (b - shared * f).norm_sqr()).sum();
        self.shared = shared;
    }

    /// Sine of the angle between the columns.
    fn sine(&self) -> f64 {
        (self.beyond / self.squares[1]).sqrt()
    }

    fn are_distinguishable(&self) -> bool {
        self.sine() > f64::EPSILON * self.positions.len() as f64
    }

    fn condition_number(&self) -> f64 {
        if !self.are_distinguishable() {
            return f64::INFINITY;
        }
        let [forward, backward] = self.squares;
        (1.0 + self.shared.norm() * (forward / backward).sqrt()) / self.sine()
    }

    /// Returns the weights of the value at each section in both waves, forward at x₁ and backward
    /// at x_n. If the waves cannot be separated, these are the smallest of the weights that fit
    /// equally well.
    fn weights(&self) -> impl Iterator<Item = [Complex64; 2]> {
        let shared = self.shared;
        let are_distinguishable = self.are_distinguishable();
        self.rows.iter().map(move |[f, b]| {
            let onto_forward = f.conj() / self.squares[0];
            if are_distinguishable {
                let backward = (b - shared * f).conj() / self.beyond;
                [onto_forward - shared * backward, backward]
            } else {
                let forward = onto_forward / (1.0 + shared.norm_sqr());
                [forward, shared.conj() * forward]
            }
        })
    }
}

/// Computes e^{-γx} for two distances x, from the product `whole` of both. Only one exponential is
/// evaluated, unless its square is too small or too large.
fn both_ways(gamma: Complex64, whole: Complex64, [first, second]: [f64; 2]) -> [Complex64; 2] {
    if first == 0.0 {
        return [Complex64::ONE, whole];
    }
    if second == 0.0 {
        return [whole, Complex64::ONE];
    }
    let along = (-gamma * first).exp();
    let square = along.norm_sqr();
    if (SMALL..SMALL.recip()).contains(&square) {
        [along, whole * along.conj() / square]
    } else {
        [along, (-gamma * second).exp()]
    }
}

fn check_coefficient(gamma: Complex64, reach: f64) -> Result<(), RodwaveError> {
    check_finite("wave number [rad/m]", gamma.im)?;
    check_not_negative("damping coefficient [1/m]", gamma.re)?;
    check_finite("distance between the sections [m]", reach)?;
    check_finite("phase between the sections [rad]", gamma.im * reach)?;
    Ok(())
}

/// Checks that there are two or more sections, with finite positions and values.
fn check_sections(positions: &[f64], values: &[Complex64]) -> Result<(), RodwaveError> {
    check_enough_samples("the list of sections", positions.len(), 2)?;
    check_length(
        "the list of values at the sections",
        values.len(),
        positions.len(),
    )?;
    crate::error::check_samples("the list of positions", positions)?;
    match values.iter().enumerate().find(|(_, v)| !v.is_finite()) {
        None => Ok(()),
        Some((index, value)) => Err(RodwaveError::NonFiniteSample {
            history: "the list of values at the sections",
            index,
            value: value.norm(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAMMA: Complex64 = Complex64::new(0.7, 12.0);

    /// Waves P = 2 - i and N = 0.3i at x = 0.
    fn known(x: f64) -> Complex64 {
        Complex64::new(2.0, -1.0) * (-GAMMA * x).exp()
            + Complex64::new(0.0, 0.3) * (GAMMA * x).exp()
    }

    #[test]
    fn known_waves_are_found_from_any_number_of_sections() {
        for positions in [
            vec![0.1, 0.2],
            vec![0.5, -0.3, 0.13],
            vec![-1.0, -0.2, 0.03, 0.4, 0.9],
        ] {
            let values: Vec<Complex64> = positions.iter().map(|x| known(*x)).collect();
            let found = TravellingWaves::from_sections(GAMMA, &positions, &values).unwrap();
            for x in [-1.0, 0.0, 0.37] {
                // tolerance: a few dozen roundings
                assert!((found.waves.at(x) - known(x)).norm() < 1e-13);
            }
            assert!((found.waves.forward_at(0.0) - Complex64::new(2.0, -1.0)).norm() < 1e-13);
            assert!(found.misfit < 1e-14 && found.condition_number < 5.0);
        }
    }

    /// Compares the planned waves with those computed for single lines, for irregular values, and
    /// checks that the plan rejects arrays of other sizes.
    #[test]
    fn planned_waves_are_those_of_single_lines() {
        let gamma: Vec<Complex64> = (0..40)
            .map(|k| Complex64::new(0.02, 1.0) * (0.7 * f64::from(k)))
            .collect();
        let positions = [0.5, -0.3, 0.13];
        let rows: Vec<Vec<Complex64>> = (0..3)
            .map(|j| {
                let value = |k: usize| Complex64::cis((7 * k + 3 * j * k + j) as f64);
                (0..gamma.len()).map(value).collect()
            })
            .collect();
        let plan = SectionWaves::new(&gamma, &positions, 0.9).unwrap();
        let mut found = [vec![Complex64::ONE; 40], vec![Complex64::ONE; 40]];
        let [along, against] = &mut found;
        let values: Vec<&[Complex64]> = rows.iter().map(Vec::as_slice).collect();
        plan.waves(&values, along, against).unwrap();
        for (k, gamma) in gamma.iter().enumerate() {
            let values: Vec<Complex64> = rows.iter().map(|row| row[k]).collect();
            let one = TravellingWaves::from_sections(*gamma, &positions, &values).unwrap();
            let size = 1e-12 * one.condition_number.min(1e3);
            assert!(
                (found[0][k] - one.waves.forward_at(0.9)).norm() < size,
                "{k}"
            );
            assert!(
                (found[1][k] - one.waves.backward_at(0.9)).norm() < size,
                "{k}"
            );
        }
        let [along, against] = &mut found;
        assert!(plan.waves(&values[..2], along, against).is_err());
        assert!(plan.waves(&values, &mut along[..39], against).is_err());
        assert!(SectionWaves::new(&gamma, &[0.1], 0.0).is_err());
        assert!(SectionWaves::new(&gamma, &positions, f64::NAN).is_err());
        assert!(SectionWaves::new(&[], &[], 0.0).is_err());
    }

    /// Checks that the residual of the fit is orthogonal to both waves.
    #[test]
    fn the_misfit_is_smallest() {
        let positions = [0.0, 0.11, 0.27, 0.31];
        let values: Vec<Complex64> = positions
            .iter()
            .map(|x| known(*x) + Complex64::new(0.0, 5.0 * x * x))
            .collect();
        let found = TravellingWaves::from_sections(GAMMA, &positions, &values).unwrap();
        assert!(found.misfit > 0.01);
        for wave in [-GAMMA, GAMMA] {
            let product: Complex64 = positions
                .iter()
                .zip(&values)
                .map(|(x, value)| (wave * x).exp().conj() * (value - found.waves.at(*x)))
                .sum();
            assert!(product.norm() < 1e-13);
        }
    }

    /// Checks sections half a wavelength apart on an undamped rod: only the sum of the waves is
    /// determined, and the condition number is infinite.
    #[test]
    fn sections_that_see_both_waves_alike() {
        let gamma = Complex64::new(0.0, std::f64::consts::PI);
        let one = Complex64::ONE;
        let found = TravellingWaves::from_sections(gamma, &[0.0, 1.0], &[one, -one]).unwrap();
        assert!(found.condition_number.is_infinite());
        assert!((found.waves.forward_at(0.0) - 0.5).norm() < 1e-15);
        assert!((found.waves.at(1.0) + 1.0).norm() < 1e-15);
        let at_rest = TravellingWaves::from_sections(Complex64::ZERO, &[0.0, 1.0], &[one, one]);
        assert!(at_rest.unwrap().condition_number.is_infinite());
        // next to this frequency, the condition number is twice the inverse of |sin kΔx| = 1e-6
        let near = Complex64::new(0.0, std::f64::consts::PI - 1e-6);
        let found = TravellingWaves::from_sections(near, &[0.0, 1.0], &[one, -one]).unwrap();
        assert!((found.condition_number * 0.5e-6 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn strong_damping_does_not_overflow() {
        let gamma = Complex64::new(2000.0, 1e4);
        let values = [Complex64::ONE, Complex64::I];
        let found = TravellingWaves::from_sections(gamma, &[0.0, 1.0], &values).unwrap();
        // at each section, the wave that enters there is found
        assert!((found.waves.forward_at(0.0) - 1.0).norm() < 1e-15);
        assert!((found.waves.backward_at(1.0) - Complex64::I).norm() < 1e-15);
    }

    /// Compares both directions of the conversion (Ödeen 1993, paper E, eq. A15).
    #[test]
    fn waves_and_state_are_the_same() {
        let state = State {
            normal_force: Complex64::new(3.0, 1.0),
            velocity: Complex64::new(-0.01, 0.02),
        };
        let z = Complex64::new(200.0, 15.0);
        let waves = TravellingWaves::of_normal_force(state, GAMMA, z);
        let (p, n) = (waves.forward_at(0.0), waves.backward_at(0.0));
        assert!((p + n - state.normal_force).norm() < 1e-14);
        assert!(((n - p) / z - state.velocity).norm() < 1e-16);
    }

    #[test]
    fn impossible_sections_are_refused() {
        let one = Complex64::ONE;
        let text = |gamma, positions: &[f64], values: &[Complex64]| {
            TravellingWaves::from_sections(gamma, positions, values)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            text(GAMMA, &[0.0], &[one]),
            "the list of sections has 1 samples, expected at least 2"
        );
        assert_eq!(
            text(GAMMA, &[0.0, 1.0], &[one]),
            "the list of values at the sections has 1 entries, expected 2"
        );
        assert_eq!(
            text(GAMMA, &[0.0, f64::NAN], &[one, one]),
            "sample 1 of the list of positions is NaN, expected a finite value"
        );
        assert_eq!(
            text(
                GAMMA,
                &[0.0, 1.0],
                &[one, Complex64::new(0.0, f64::NEG_INFINITY)]
            ),
            "sample 1 of the list of values at the sections is inf, expected a finite value"
        );
        assert_eq!(
            text(-GAMMA, &[0.0, 1.0], &[one, one]),
            "damping coefficient [1/m] is -0.7, expected a finite value, 0 or above"
        );
    }
}
