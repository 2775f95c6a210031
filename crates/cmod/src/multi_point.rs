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
mod fit;
mod follow;
mod line;
mod other_root;
mod projection;
mod roots;
mod spectra;
mod start;
mod three_point;
mod uncertainty;
mod waves;

pub use calibration::GaugeMethod;
pub use fit::{LineFit, MultiPointEstimate};
pub use spectra::{GaugeSpectra, GaugedRod};
pub use three_point::{MOST_NOISE_AT_THE_MIDDLE, ThreePoint};
pub use uncertainty::GaugeUncertainty;
pub use waves::{Quantity, WavesAtSection};

use std::f64::consts::TAU;

use crate::error::{CmodError, check_not_negative, check_that};
use crate::estimate::{Acceptance, Method, ModulusEstimate, Refusal, VarianceFreedom};
use crate::self_calibration::continuation;
use crate::validity::AcceptanceLimits;
use fit::most_misfit;
use follow::Expectation;
use projection::Projection;
use roots::{RootSearch, SolvedRoot};
use spectra::WhiteLine;
use uncertainty::NO_FREE_END;

/// Maximum ratio of noise to signal of a valid line, as root mean squares over all gauges, that is,
/// the signal is at least 10.5 dB above the noise.
pub const MOST_NOISE: f64 = 0.3;

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
    /// \[m\], where the strain is 0, and so is the slope of any motion (displacement, velocity or
    /// acceleration). The method can evaluate a single shot on a long bar with two gauges, even
    /// where the waves overlap:
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
        let is_beyond = rod.positions.iter().all(|x| *x < free_end);
        let expected = "one beyond the last gauge: positions increase towards the free end";
        let quantity = "position of the free end [m]";
        check_that(is_beyond, quantity, free_end, expected)?;
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
        check_that(self.has_free_end || mass <= 0.0, MASS, mass, NO_FREE_END)?;
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
    /// If two roots near each other explain the gauges of a line equally well, the lines before and
    /// after it decide between the roots; if they cannot, the line is
    /// [doubtful](crate::branch::BranchDoubt::OtherRoot).
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
            let continued = continuation::on_axis(
                &estimate.modulus,
                self.added_damping,
                self.rod.diameter,
                self.rod.aperture(),
            )?;
            estimate.continue_to(continued);
        }
        Ok(estimate)
    }

    /// Returns the number of gauges, not counting a free end.
    fn n_gauges(&self) -> usize {
        self.rod.positions.len() - usize::from(self.has_free_end)
    }

    /// Returns the estimate on the lines s = σ + iω.
    fn on_lines(&self, spectra: &GaugeSpectra<'_>) -> Result<MultiPointEstimate, CmodError> {
        spectra.check(self.n_gauges())?;
        let n_rows = self.rod.positions.len();
        let degrees_of_freedom = 2 * (spectra.tests.len() * (n_rows - 2) - 1);
        let noise_freedom = self.settings.noise_freedom;
        let most_misfit = most_misfit(degrees_of_freedom, noise_freedom)?;
        let limits = self.settings.limits;
        let method = Method("several gauges by least squares");
        let mut modulus = ModulusEstimate::empty(method, limits);
        let mut white = WhiteLine::for_spectra(spectra, n_rows);
        let mut usable = Vec::with_capacity(spectra.frequency_hz.len());
        for (index, &frequency_hz) in spectra.frequency_hz.iter().enumerate() {
            match white.load(spectra, index) {
                Ok(()) => usable.push(index),
                Err(reason) => modulus.add(index, frequency_hz, Err(reason)),
            }
        }

        let (is_slope, end_length) = (self.ends_with_slope(), self.end_length());
        let mut projection = Projection::with_last_row(&self.rod.positions, is_slope, end_length);
        let aperture = self.rod.aperture();
        let start = start::wave_speed(
            &mut projection,
            spectra,
            &usable,
            aperture,
            self.settings.wave_speed,
            self.added_damping,
        );
        let frequency_of = |index: usize| spectra.frequency_hz.get(index).copied();
        let first = usable.first().and_then(|index| frequency_of(*index));
        let distance = aperture / (n_rows - 1) as f64;
        let mut search = start.zip(first).map(|(start, first)| RootSearch {
            projection,
            white,
            expectation: Expectation::new(start.slowness, distance, TAU * first),
            doubt: start.doubt,
            added_damping: self.added_damping,
            degrees_of_freedom,
            most_misfit,
            noise_freedom,
            needs_influence: self.uncertainty.is_of_gauges() || self.end_mass > 0.0,
        });
        let mut roots = Vec::with_capacity(usable.len());
        let mut courses = Vec::with_capacity(usable.len());
        for index in usable {
            let Some(frequency_hz) = frequency_of(index) else {
                continue;
            };
            let root = search.as_mut().ok_or(Refusal::Undetermined);
            match root.and_then(|search| search.solve(spectra, (index, frequency_hz))) {
                Ok((root, course)) => {
                    roots.push(root);
                    courses.push(course);
                }
                Err(reason) => modulus.add(index, frequency_hz, Err(reason)),
            }
        }
        if let Some(search) = &mut search {
            search.choose(spectra, &mut roots, &mut courses);
        }

        let mut fits = Vec::with_capacity(roots.len());
        let mut waves = Vec::with_capacity(roots.len());
        for root in roots {
            let SolvedRoot {
                line, fit, freedom, ..
            } = root;
            let (index, frequency_hz) = (line.index, line.frequency.hz());
            let acceptance = Acceptance::of_line(limits, freedom)?;
            let rod = (&self.rod, self.end_mass);
            let judged = line.into_modulus(rod, &self.uncertainty, &acceptance);
            if judged.is_ok() {
                fits.push(fit);
                waves.push(root.waves);
            }
            modulus.add(index, frequency_hz, judged);
        }
        Ok(MultiPointEstimate {
            modulus,
            fits,
            waves,
            first: self.rod.positions.first().copied().unwrap_or_default(),
            aperture,
            quantity: self.quantity,
        })
    }
}
