//! Modulus from three or more gauges anywhere on a uniform part of a rod in any structure.
//!
//! Strain, displacement, velocity and acceleration each consist of two waves (Ödeen 1993, paper B,
//! eq. 4),
//!
//! ```text
//! q̂(x) = P e^{-γx} + N e^{γx} ,
//! ```
//!
//! Three gauges therefore suffice to determine P, N and γ. For three gauges at equal distances
//! there is a closed form, [`ThreePoint`]. For any positions and any number of gauges,
//! [`MultiPoint`] solves by least squares: P and N are eliminated on every line, and γ minimises
//! the residual. Several tests can be evaluated together, each with its own P and N.
//!
//! # Singular lines
//! Gauges that all lie on a grid of spacing a cannot separate the two waves where ka = nπ. Three
//! gauges do not determine γ if a node is at the middle gauge. Unequal distances without a large
//! common divisor, and more gauges, avoid both problems; [`advice`] predicts the errors of a set of
//! positions. Near 0 Hz only a larger distance between the outer gauges reduces the errors.
//!
//! Theory: `docs/theory/multi-point-method.md`.

pub mod advice;
mod calibration;
mod follow;
mod line;
mod other_root;
mod projection;
mod spectra;
mod start;
mod three_point;
mod uncertainty;
mod waves;

pub use calibration::GaugeMethod;
pub use spectra::{GaugeSpectra, GaugedRod};
pub use three_point::{MOST_NOISE_AT_THE_MIDDLE, ThreePoint};
pub use uncertainty::GaugeUncertainty;
pub use waves::{Quantity, WavesAtSection};

use std::f64::consts::{FRAC_PI_4, TAU};
use std::iter;

use num_complex::Complex64;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::branch::BranchDoubt;
use crate::complex_frequency::ComplexFrequency;
use crate::error::{CmodError, check_not_negative};
use crate::estimate::{
    Acceptance, Method, ModulusEstimate, ModulusLine, Refusal, Termination, VarianceFreedom,
};
use crate::self_calibration::continuation;
use crate::validity::{AcceptanceLimits, Violation};
use follow::Expectation;
use line::SolvedLine;
use other_root::{LineOnCourse, Root, decide};
use projection::{Details, Objective, Projection, TestWaves};
use spectra::WhiteLine;
use waves::LineOfWaves;

/// Maximum ratio of noise to signal of a valid line, as root mean squares over all gauges, that is,
/// a signal of 10.5 dB above the noise.
pub const MOST_NOISE: f64 = 0.3;

/// Maximum distance of two roots of a line from the expected root, in radians over the distance
/// over which waves are counted. Farther roots are excluded by the tracking of the wave number
/// alone.
const NEAR: f64 = FRAC_PI_4;

/// Method for three or more gauges at any positions, by least squares.
///
/// ```
/// use cmod::{GaugeSpectra, GaugedRod, MultiPoint};
/// use num_complex::Complex64;
///
/// // two waves in a rod with c = 1700 m/s and a loss factor of 0.1, measured by four gauges
/// let gamma = |f: f64| Complex64::new(0.05, 1.0) * (2.0 * std::f64::consts::PI * f / 1700.0);
/// let frequency_hz: Vec<f64> = (1..=200).map(|j| 50.0 * f64::from(j)).collect();
/// let positions = vec![0.0, 0.07, 0.12, 0.2];
/// let spectra: Vec<Vec<Complex64>> = positions
///     .iter()
///     .map(|x| frequency_hz.iter().map(|&f| (-gamma(f) * x).exp() + 0.5 * (gamma(f) * x).exp()).collect())
///     .collect();
/// let rod = GaugedRod { positions, diameter: 0.016, density: 919.0 };
/// let result = MultiPoint::new(rod)?.estimate(&GaugeSpectra {
///     frequency_hz: &frequency_hz,
///     tests: &[&spectra],
///     noise: &vec![vec![1e-4; 200]; 4],
/// })?;
/// for line in result.modulus().valid() {
///     assert!((line.phase_velocity - 1700.0).abs() < 1e-6);
/// }
/// assert!(result.modulus().valid().count() > 150);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MultiPoint {
    rod: GaugedRod,
    quantity: Quantity,
    settings: GaugeSettings,
    uncertainty: GaugeUncertainty,
    /// True if the last position is that of a free end.
    has_free_end: bool,
    /// Mass on the free end \[kg\].
    end_mass: f64,
    /// Added damping σ [1/s].
    added_damping: f64,
}

/// Settings of the methods for gauges; each method uses some of them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct GaugeSettings {
    wave_speed: Option<f64>,
    noise_freedom: Option<VarianceFreedom>,
    limits: AcceptanceLimits,
}

setters! { MultiPoint: wave_speed, noise_freedom, limits }

impl MultiPoint {
    /// Creates the method for a `rod` with three or more gauges, which measure strain.
    ///
    /// # Errors
    /// [`CmodError::GaugeCount`], [`CmodError::PositionOrder`] and [`CmodError::NonPhysical`] for
    /// the rod.
    pub fn new(rod: GaugedRod) -> Result<Self, CmodError> {
        rod.check()?;
        Ok(Self {
            rod,
            quantity: Quantity::default(),
            settings: GaugeSettings::default(),
            uncertainty: GaugeUncertainty::default(),
            has_free_end: false,
            end_mass: 0.0,
            added_damping: 0.0,
        })
    }

    /// Creates the method for a `rod` with two or more gauges before its free end at `free_end`
    /// \[m\], where the strain is 0 and the slope of a motion is 0. The method can evaluate a
    /// single shot on a long bar with two gauges, even where the waves overlap:
    ///
    /// ```text
    /// ε̂₁/ε̂₂ = sinh γd₁/sinh γd₂ ,    d = `free_end` - x .
    /// ```
    ///
    /// # Errors
    /// The errors of [`Self::new`]; [`CmodError::NonPhysical`] for an end that is not beyond the
    /// last gauge.
    pub fn before_free_end(mut rod: GaugedRod, free_end: f64) -> Result<Self, CmodError> {
        if rod.positions.len() < 2 {
            return Err(CmodError::GaugeCount {
                found: rod.positions.len(),
                expected: "2 or more before a free end",
            });
        }
        if !rod.positions.iter().all(|x| *x < free_end) {
            return Err(CmodError::NonPhysical {
                quantity: "position of the free end [m]",
                value: free_end,
                expected: "one beyond the last gauge: positions increase towards the free end",
            });
        }
        rod.positions.push(free_end);
        Ok(Self {
            has_free_end: true,
            ..Self::new(rod)?
        })
    }

    /// Sets the `mass` \[kg\] on the free end, for example of an accelerometer. The force at the
    /// end is then the inertia force of the mass, and with ℓ = m/(ρA), the length of rod that has
    /// the same mass,
    ///
    /// ```text
    /// ε̂₁/ε̂₂ = (sinh γd₁ + ℓγ cosh γd₁)/(sinh γd₂ + ℓγ cosh γd₂) .
    /// ```
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless the mass is finite and not negative, and 0 if no free end
    /// is used.
    pub fn with_end_mass(mut self, mass: f64) -> Result<Self, CmodError> {
        const MASS: &str = "mass on the end [kg]";
        self.end_mass = check_not_negative(MASS, mass)?;
        if mass > 0.0 && !self.has_free_end {
            return Err(CmodError::NonPhysical {
                quantity: MASS,
                value: mass,
                expected: "0: no free end is used",
            });
        }
        Ok(self)
    }

    /// Sets the damping σ [1/s] that was added to the records before their transform, by the same
    /// factor e^{-σt} on all gauges. It is used for records that end while the rod still vibrates.
    /// The spectra, and the modulus that follows from them, are then values on the lines s = σ +
    /// iω,
    ///
    /// ```text
    /// E(s) = ρs²/γ(s)² .
    /// ```
    ///
    /// The modulus is [continued](crate::self_calibration#added-damping) to E(iω) along a smooth
    /// and causal modulus through all lines. The waves are not continued: they are values on the
    /// lines s.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless the damping is finite and not negative.
    pub fn with_added_damping(mut self, added_damping: f64) -> Result<Self, CmodError> {
        self.added_damping = check_not_negative("added damping [1/s]", added_damping)?;
        Ok(self)
    }

    /// Sets the measured `quantity`. It affects only the conversion of the waves, not the modulus.
    #[must_use]
    pub fn with_quantity(mut self, quantity: Quantity) -> Self {
        self.quantity = quantity;
        self
    }

    /// Sets the standard uncertainties of the rod and its gauges, which are common to all lines. By
    /// default all quantities are exact.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for a value that is not finite or below 0;
    /// [`CmodError::GaugeCount`] unless each list is empty or has one value per gauge.
    pub fn with_uncertainty(mut self, uncertainty: GaugeUncertainty) -> Result<Self, CmodError> {
        self.uncertainty = uncertainty.check(self.n_gauges(), self.has_free_end)?;
        Ok(self)
    }

    /// Returns the complex modulus, and the waves of every test.
    ///
    /// On each line V(γ) = Σ|P_perp b|² over the tests is minimised by Gauss-Newton steps from the
    /// value expected from the previous lines. Here b are the values of the gauges, A(γ) =
    /// \[e^{-γx}, e^{γx}\] the two waves at the gauges, c = A⁺b the amplitudes that fit best, and
    /// P_perp = I - A A⁺. The variance is the Cramér-Rao bound of circular Gaussian noise,
    ///
    /// ```text
    /// E|δγ|² = 1/Σ|d|² ,    d = P_perp (dA/dγ) c ,
    /// ```
    ///
    /// where all rows are divided by the noise of their gauge.
    ///
    /// Where the gauges leave two roots near each other, the lines before and after the line decide
    /// between them; if they do not, the line is [doubtful](BranchDoubt::OtherRoot).
    ///
    /// # Errors
    /// Errors of the `spectra` as a whole: [`CmodError::NoLines`], [`CmodError::NoTests`],
    /// [`CmodError::Frequency`], [`CmodError::FrequencyOrder`], [`CmodError::SpectraOfTest`],
    /// [`CmodError::SpectrumLength`], [`CmodError::GaugeCount`], [`CmodError::LengthMismatch`],
    /// [`CmodError::NegativeNoise`]. A line that is not finite does not affect the others: it is
    /// [refused](ModulusEstimate::refused).
    pub fn estimate(&self, spectra: &GaugeSpectra<'_>) -> Result<MultiPointEstimate, CmodError> {
        let mut estimate = self.on_lines(spectra)?;
        if self.added_damping > 0.0 {
            let on_lines = &estimate.modulus;
            let continued = continuation::on_axis(
                on_lines,
                self.added_damping,
                self.rod.diameter,
                self.rod.aperture(),
            )?;
            // the fits and waves of lines without a modulus on the axis are removed together with
            // these lines
            let is_kept = |line: &ModulusLine| {
                let place = continued
                    .lines()
                    .binary_search_by_key(&line.index, |kept| kept.index);
                place.is_ok()
            };
            let kept: Vec<bool> = on_lines.lines().iter().map(is_kept).collect();
            let n_tests = estimate.n_tests;
            let mut of_fits = kept.iter().copied();
            estimate.fits.retain(|_| of_fits.next() == Some(true));
            let mut of_waves = kept.iter().flat_map(|kept| iter::repeat_n(*kept, n_tests));
            estimate
                .amplitudes
                .retain(|_| of_waves.next() == Some(true));
            estimate.modulus = continued;
        }
        Ok(estimate)
    }

    /// Returns the number of gauges, not counting a free end.
    fn n_gauges(&self) -> usize {
        self.rod.positions.len() - usize::from(self.has_free_end)
    }

    /// Returns the projection onto the two waves at the gauges and, if a free end is used, with the
    /// condition there.
    fn projection(&self) -> Projection {
        let (is_slope, end_length) = (self.ends_with_slope(), self.end_length());
        Projection::with_last_row(&self.rod.positions, is_slope, end_length)
    }

    /// Returns the estimate on the lines s = σ + iω.
    fn on_lines(&self, spectra: &GaugeSpectra<'_>) -> Result<MultiPointEstimate, CmodError> {
        spectra.check(self.n_gauges())?;
        let n_rows = self.rod.positions.len();
        let redundant = 2 * (spectra.tests.len() * (n_rows - 2) - 1);
        let most_misfit = self.most_misfit(redundant)?;
        let mut white = WhiteLine::for_spectra(spectra, n_rows);
        let mut modulus = ModulusEstimate::empty(
            Method("several gauges by least squares"),
            self.settings.limits,
        );
        let mut usable = Vec::with_capacity(spectra.frequency_hz.len());
        for (index, &frequency_hz) in spectra.frequency_hz.iter().enumerate() {
            match white.load(spectra, index) {
                Ok(()) => usable.push(index),
                Err(reason) => modulus.add(index, frequency_hz, Err(reason)),
            }
        }

        let n_tests = spectra.tests.len();
        let mut fits = Vec::with_capacity(usable.len());
        let mut amplitudes: Vec<TestWaves> = Vec::with_capacity(usable.len() * n_tests);
        let mut projection = self.projection();
        let aperture = self.rod.aperture();
        let start = start::wave_speed(
            &mut projection,
            spectra,
            &usable,
            aperture,
            self.settings.wave_speed,
            self.added_damping,
        );
        let distance = aperture / (n_rows - 1) as f64;
        let mut expectation = None;
        let mut solved: Vec<SolvedRoot> = Vec::with_capacity(usable.len());
        let mut courses: Vec<LineOnCourse> = Vec::with_capacity(usable.len());
        for &index in &usable {
            let Some(&frequency_hz) = spectra.frequency_hz.get(index) else {
                continue;
            };
            let Some(start) = &start else {
                modulus.add(index, frequency_hz, Err(Refusal::Undetermined));
                continue;
            };
            let expectation = expectation.get_or_insert_with(|| {
                Expectation::new(start.slowness, distance, TAU * frequency_hz)
            });
            if let Err(reason) = white.load(spectra, index) {
                modulus.add(index, frequency_hz, Err(reason));
                continue;
            }
            let kept = amplitudes.len();
            let line = self.solve(
                (index, frequency_hz),
                &white,
                (&mut projection, expectation),
                (start.doubt, most_misfit),
                &mut amplitudes,
            );
            match line {
                Ok((line, course)) => {
                    solved.push(line);
                    courses.push(course);
                }
                Err(reason) => {
                    amplitudes.truncate(kept);
                    modulus.add(index, frequency_hz, Err(reason));
                }
            }
        }
        for decision in decide(&mut courses, distance) {
            let place = decision.place;
            let (Some(line), Some(course)) = (solved.get_mut(place), courses.get(place)) else {
                continue;
            };
            if decision.is_other && white.load(spectra, line.line.index).is_ok() {
                let mut waves = Vec::with_capacity(n_tests);
                let root = FoundRoot {
                    gamma: course.root.gamma,
                    evaluated_at: None,
                    termination: line.other.unwrap_or(line.line.termination),
                };
                let doubt = start.as_ref().and_then(|start| start.doubt);
                let frequency = (line.line.index, line.line.frequency);
                let doubts = (doubt, most_misfit);
                let other =
                    self.at_root(frequency, &white, &mut projection, root, doubts, &mut waves);
                if let Ok((other, _)) = other {
                    *line = other;
                    let old = amplitudes.iter_mut().skip(place * n_tests);
                    old.zip(waves).for_each(|(old, new)| *old = new);
                }
            }
            let violations = &mut line.line.violations;
            let is_doubted = violations
                .iter()
                .any(|of| matches!(of, Violation::BranchAmbiguous(_)));
            if let Some(doubt) = decision.doubt.filter(|_| !is_doubted) {
                violations.insert(0, Violation::BranchAmbiguous(doubt));
            }
        }
        let mut kept = Vec::with_capacity(solved.len());
        for SolvedRoot {
            line, fit, freedom, ..
        } in solved
        {
            let (index, frequency_hz) = (line.index, line.frequency.hz());
            let acceptance = Acceptance::of_line(self.settings.limits, freedom)?;
            let rod = (&self.rod, self.end_mass);
            let judged = line.into_modulus(rod, &self.uncertainty, &acceptance);
            kept.push(judged.is_ok());
            if judged.is_ok() {
                fits.push(fit);
            }
            modulus.add(index, frequency_hz, judged);
        }
        let mut of_waves = kept.iter().flat_map(|kept| iter::repeat_n(*kept, n_tests));
        amplitudes.retain(|_| of_waves.next() == Some(true));
        Ok(MultiPointEstimate {
            modulus,
            fits,
            amplitudes,
            n_tests,
            first: self.rod.positions.first().copied().unwrap_or_default(),
            aperture,
            quantity: self.quantity,
        })
    }

    /// Returns the limit of chi-square that noise alone exceeds on one line in a thousand.
    fn most_misfit(&self, degrees_of_freedom: usize) -> Result<f64, CmodError> {
        let Some(noise) = self
            .settings
            .noise_freedom
            .filter(|_| degrees_of_freedom > 0)
        else {
            return Ok(chi_square_limit(degrees_of_freedom));
        };
        let n = degrees_of_freedom as f64;
        let law = FisherSnedecor::new(n, noise.line).map_err(|_| CmodError::NonPhysical {
            quantity: "degrees of freedom of a variance",
            value: noise.line,
            expected: "a finite value above 0",
        })?;
        Ok(n * law.inverse_cdf(0.999))
    }

    /// Solves one line from the value expected from the previous lines, and looks for another root
    /// near the root found.
    fn solve(
        &self,
        (index, frequency_hz): (usize, f64),
        white: &WhiteLine,
        (projection, expectation): (&mut Projection, &mut Expectation),
        (start, most_misfit): (Option<BranchDoubt>, f64),
        amplitudes: &mut Vec<TestWaves>,
    ) -> Result<(SolvedRoot, LineOnCourse), Refusal> {
        let frequency = ComplexFrequency::new(frequency_hz, self.added_damping);
        let omega = frequency.omega();
        let expected = expectation.gamma(omega);
        let minimum = projection
            .minimise(expected, white)
            .ok_or(Refusal::Undetermined)?;
        // γ and -γ describe the same pair of waves.
        let (gamma, evaluated_at) = if minimum.gamma.im < 0.0 {
            (-minimum.gamma, None)
        } else {
            (minimum.gamma, minimum.evaluated_at)
        };
        let root = FoundRoot {
            gamma,
            evaluated_at,
            termination: minimum.termination,
        };
        let doubt = expectation.doubt(omega, gamma);
        let (mut solved, details) = self.at_root(
            (index, frequency),
            white,
            projection,
            root,
            (start.or(doubt), most_misfit),
            amplitudes,
        )?;
        let is_reliable =
            minimum.termination.was_successful() && !doubt.is_some_and(|d| d.is_ambiguous());
        let mut course = LineOnCourse {
            omega,
            root: Root {
                gamma,
                misfit: details.objective.misfit,
                information: details.objective.information,
            },
            other: None,
            is_reliable,
            variance: white.variance,
            power: white.power,
            degrees_of_freedom: solved.fit.degrees_of_freedom,
        };
        if is_reliable {
            let mirrored = details.mirrored(gamma);
            let is_near = |gamma: Complex64| {
                (gamma - expected).norm() * expectation.distance() < NEAR && gamma.im > 0.0
            };
            // the iteration may also return to the first root
            let is_distinct =
                |found: Complex64| (found - gamma).norm() > 0.25 * (mirrored - gamma).norm();
            let other = is_near(mirrored)
                .then(|| projection.minimise(mirrored, white))
                .flatten()
                .filter(|other| other.termination.was_successful())
                .filter(|other| is_near(other.gamma) && is_distinct(other.gamma));
            if let Some((other, objective)) = other.and_then(|other| {
                let objective = projection.evaluate(other.gamma, white)?;
                Some((other, objective))
            }) {
                solved.other = Some(other.termination);
                course.other = Some(Root {
                    gamma: other.gamma,
                    misfit: objective.misfit,
                    information: objective.information,
                });
            }
            // A line that two waves do not explain must not affect the following lines.
            let excess = solved.fit.chi_square.map_or(1.0, |chi| {
                (chi / solved.fit.degrees_of_freedom as f64).max(1.0)
            });
            expectation.update(omega, gamma, details.objective.information / excess);
        }
        Ok((solved, course))
    }

    /// Returns the line with its errors at a root, and appends its waves to `amplitudes`.
    fn at_root(
        &self,
        (index, frequency): (usize, ComplexFrequency),
        white: &WhiteLine,
        projection: &mut Projection,
        FoundRoot {
            gamma,
            evaluated_at,
            termination,
        }: FoundRoot,
        (doubt, most_misfit): (Option<BranchDoubt>, f64),
        amplitudes: &mut Vec<TestWaves>,
    ) -> Result<(SolvedRoot, Details), Refusal> {
        let details = projection
            .details(gamma, evaluated_at, white, amplitudes)
            .ok_or(Refusal::Undetermined)?;
        let degrees_of_freedom = 2 * (white.n_tests() * (white.weights.len() - 2) - 1);
        let chi_square = (white.variance > 0.0 && degrees_of_freedom > 0)
            .then_some(2.0 * details.objective.misfit);
        let influence = if self.uncertainty.is_of_gauges() || self.end_mass > 0.0 {
            projection
                .influence(gamma, white)
                .ok_or(Refusal::Undetermined)?
        } else {
            Vec::new()
        };
        let variance = white.variance / details.objective.information;
        let freedom = self.settings.noise_freedom.map(|freedom| {
            let shares = projection.shares(gamma, white);
            shares.map_or(freedom, |shares| freedom.of_sum(shares.into_iter()))
        });
        let mut violations = Vec::new();
        violations.extend(doubt.map(Violation::BranchAmbiguous));
        if let Some(chi_square) = chi_square
            && chi_square > most_misfit
        {
            violations.push(Violation::Misfit {
                chi_square,
                degrees_of_freedom,
                limit: most_misfit,
            });
        }
        let noise_to_signal = white.noise_to_signal();
        if noise_to_signal > MOST_NOISE {
            violations.push(Violation::SignalTooWeak {
                noise_to_signal,
                limit: MOST_NOISE,
            });
        }
        let line = SolvedLine {
            index,
            frequency,
            gamma,
            variance,
            influence,
            curvature: details.curvature,
            amplification: (white.mean_power() / details.objective.information).sqrt(),
            closed_form: None,
            termination,
            violations,
        };
        let (forward, backward, shared) = details.waves_covariance;
        let fit = LineFit {
            propagation_variance: variance,
            chi_square,
            degrees_of_freedom,
            second_order: details.curvature * variance.sqrt(),
            waves: LineOfWaves {
                frequency,
                gamma,
                gamma_variance: variance,
                covariance: (
                    white.variance * forward,
                    white.variance * backward,
                    white.variance * shared,
                ),
            },
        };
        let solved = SolvedRoot {
            line,
            fit,
            freedom,
            other: None,
        };
        Ok((solved, details))
    }
}

/// Root of one line.
#[derive(Debug, Clone, Copy)]
struct FoundRoot {
    gamma: Complex64,
    /// Objective at γ, or at a negligible distance from it; `None` if another γ was evaluated
    /// later.
    evaluated_at: Option<Objective>,
    termination: Termination,
}

/// Line at its root.
struct SolvedRoot {
    line: SolvedLine,
    fit: LineFit,
    freedom: Option<VarianceFreedom>,
    /// Termination of the iteration to another root near the root found.
    other: Option<Termination>,
}

/// Returns the value of chi-square that noise alone exceeds on one line in a thousand, by the
/// cube-root approximation of Wilson and Hilferty. It is up to 2.4 % too high at 2 degrees of
/// freedom, and less at more degrees of freedom.
fn chi_square_limit(degrees_of_freedom: usize) -> f64 {
    const NORMAL_QUANTILE: f64 = 3.0902;
    let n = degrees_of_freedom as f64;
    let spread = 2.0 / (9.0 * n);
    n * (1.0 - spread + NORMAL_QUANTILE * spread.sqrt()).powi(3)
}

/// Result of [`MultiPoint`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MultiPointEstimate {
    modulus: ModulusEstimate,
    fits: Vec<LineFit>,
    amplitudes: Vec<TestWaves>,
    n_tests: usize,
    first: f64,
    aperture: f64,
    quantity: Quantity,
}

impl MultiPointEstimate {
    /// Returns the modulus per line.
    #[must_use]
    pub fn modulus(&self) -> &ModulusEstimate {
        &self.modulus
    }

    /// Returns the goodness of fit of each of the [lines](ModulusEstimate::lines) of the modulus,
    /// in their order.
    #[must_use]
    pub fn fits(&self) -> &[LineFit] {
        &self.fits
    }

    /// Returns the waves of `quantity` at `section` x \[m\], on the line `line` of
    /// [`ModulusEstimate::lines`] in test `test`, both from 0; `None` if there is no such line
    /// or test.
    ///
    /// The section may be outside the range of the gauges, provided that the rod is uniform up to
    /// the section.
    #[must_use]
    pub fn waves(
        &self,
        line: usize,
        test: usize,
        section: f64,
        quantity: Quantity,
    ) -> Option<WavesAtSection> {
        if test >= self.n_tests {
            return None;
        }
        let fit = self.fits.get(line)?;
        let test = self.amplitudes.get(line * self.n_tests + test)?;
        let way = section - self.first;
        Some(waves::waves_at(
            &fit.waves,
            test,
            way,
            self.aperture - way,
            self.quantity,
            quantity,
        ))
    }
}

/// Goodness of fit of two waves on a line.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct LineFit {
    /// Variance E|δγ|² [1/m²]. Half of it is due to α and half to k, which are uncorrelated.
    pub propagation_variance: f64,
    /// Twice the sum of squares of the residuals divided by the noise, which has the chi-square
    /// distribution; `None` if the noise is 0 or the gauges have no redundancy.
    pub chi_square: Option<f64>,
    /// Degrees of freedom of chi-square: 2(M(n - 2) - 1) for M tests with n gauges, where a free
    /// end that is used counts as a gauge.
    pub degrees_of_freedom: usize,
    /// Ratio of the second-order error of γ to its standard error.
    pub second_order: f64,
    waves: LineOfWaves,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of 99.9 % from tables of the chi-square distribution; for 2 degrees of freedom the
    /// quantile is 2 ln 1000.
    #[test]
    fn one_line_in_a_thousand_exceeds_the_limit() {
        for (degrees_of_freedom, quantile) in [
            (2, 13.816),
            (4, 18.467),
            (10, 29.588),
            (40, 73.402),
            (100, 149.449),
        ] {
            let limit = chi_square_limit(degrees_of_freedom);
            assert!(
                (-1e-3..0.024).contains(&(limit / quantile - 1.0)),
                "{limit} for {quantile}"
            );
        }
    }
}
