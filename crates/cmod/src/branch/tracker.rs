//! Branch of every line of one or several records.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use super::Branch;
use super::anchor::{Anchors, KnownWaveNumber};
use super::forward::{Courses, LineAt};
use super::noise::{NoiseLevel, assumed_variance, least_variance};
use super::observation::PhaseObservation;
use super::path::Sight;
use super::tracked::{Place, TrackedBranches, TrackedLine};
use super::verdict::Verdict;
use crate::error::{
    CmodError, check_frequencies, check_length, check_not_negative, check_positive,
};

/// Lower limit of the possible wave speeds [m/s]: soft rubber.
pub const SLOWEST_WAVE: f64 = 20.0;
/// Upper limit of the possible wave speeds [m/s], above that of any solid rod.
pub const FASTEST_WAVE: f64 = 20e3;
/// Half width of the search range around a guess of the wave speed, in standard deviations.
const WITHIN: f64 = 5.0;
/// Maximum number of noise adjustments.
const ADJUSTMENTS: usize = 6;

/// Lines of one record whose branches are sought.
#[derive(Clone, Copy)]
pub struct PhaseRecord<'a> {
    /// Function Ψ(γℓ) of the record.
    pub observation: &'a dyn PhaseObservation,
    /// Length ℓ \[m\] by which γ is multiplied.
    pub length: f64,
    /// Increasing frequencies \[Hz\].
    pub frequency_hz: &'a [f64],
    /// Ratios Ψ, one per line. A line that is not finite, or at 0 Hz, is skipped.
    pub observed: &'a [Complex64],
    /// Variances E|δΨ|², one per line, of real and imaginary part together; `None` if unknown.
    pub variance: Option<&'a [f64]>,
}

impl std::fmt::Debug for PhaseRecord<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("PhaseRecord")
            .field("length", &self.length)
            .field("frequency_hz", &self.frequency_hz)
            .field("observed", &self.observed)
            .field("variance", &self.variance)
            .finish_non_exhaustive()
    }
}

/// Determines the branch of every line from the smoothness of γ(ω).
///
/// ```
/// use cmod::branch::{BranchTracker, FreeEnd, PhaseRecord};
/// use num_complex::Complex64;
///
/// // 0.8 m of a rod with c = 1700 m/s and a loss factor of 0.1; the first line is in the sixth half wave
/// let gamma = |f: f64| Complex64::new(0.05, 1.0) * (2.0 * std::f64::consts::PI * f / 1700.0);
/// let frequency_hz: Vec<f64> = (0..300).map(|j| 6000.0 + 20.0 * f64::from(j)).collect();
/// let mut observed: Vec<Complex64> = frequency_hz.iter().map(|&f| (0.8 * gamma(f)).cosh()).collect();
/// observed[100..150].fill(Complex64::new(f64::NAN, 0.0));
/// let variance: Vec<f64> = observed.iter().map(|ratio| 1e-4 * ratio.norm_sqr()).collect();
///
/// let tracked = BranchTracker::new().with_wave_speed(1600.0, 0.1)?.track(&[PhaseRecord {
///     observation: &FreeEnd,
///     length: 0.8,
///     frequency_hz: &frequency_hz,
///     observed: &observed,
///     variance: Some(&variance),
/// }])?;
/// let last = &tracked.records[0][299];
/// assert!((last.root.unwrap() - 0.8 * gamma(11_980.0)).norm() < 1e-12);
/// assert!(last.confidence > 0.999 && last.doubt.is_none());
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BranchTracker {
    speed: Option<(f64, f64)>,
    slowest: f64,
    fastest: f64,
    known: Vec<KnownWaveNumber>,
}

impl Default for BranchTracker {
    fn default() -> Self {
        Self::new()
    }
}

impl BranchTracker {
    /// Creates a tracker that assumes only a wave speed between [`SLOWEST_WAVE`] and
    /// [`FASTEST_WAVE`].
    #[must_use]
    pub fn new() -> Self {
        Self {
            speed: None,
            slowest: SLOWEST_WAVE,
            fastest: FASTEST_WAVE,
            known: Vec::new(),
        }
    }

    /// Sets a guess of the wave speed [m/s] at the first lines, and its `relative_error`, a
    /// standard deviation. The search covers five standard deviations.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless both are finite and above 0.
    pub fn with_wave_speed(
        mut self,
        wave_speed: f64,
        relative_error: f64,
    ) -> Result<Self, CmodError> {
        self.speed = Some((
            check_positive("wave speed [m/s]", wave_speed)?,
            check_positive("relative error of the wave speed", relative_error)?,
        ));
        let range = (WITHIN * relative_error).exp();
        self.slowest = wave_speed / range;
        self.fastest = wave_speed * range;
        Ok(self)
    }

    /// Removes the limits of the wave speed, for lengths that are not in metres.
    pub(super) fn with_any_wave_speed(mut self) -> Self {
        self.slowest = f64::MIN_POSITIVE;
        self.fastest = f64::INFINITY;
        self
    }

    /// Adds a known wave number k [rad/m] at a frequency \[Hz\], inside or outside of the record,
    /// with its standard error.
    ///
    /// A known wave number only distinguishes between possible counts of waves; it does not change
    /// γ on any line.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless frequency and standard error are finite and above 0 and k
    /// is finite, 0 or above.
    pub fn with_wave_number(
        mut self,
        frequency_hz: f64,
        wave_number: f64,
        standard_error: f64,
    ) -> Result<Self, CmodError> {
        let anchor = KnownWaveNumber {
            omega: TAU * check_positive("frequency of the known wave number [Hz]", frequency_hz)?,
            wave_number: check_not_negative("known wave number [rad/m]", wave_number)?,
            standard_error: check_positive(
                "standard error of the wave number [rad/m]",
                standard_error,
            )?,
        };
        let behind = self
            .known
            .partition_point(|other| other.omega <= anchor.omega);
        self.known.insert(behind, anchor);
        Ok(self)
    }

    /// Adds a known branch at a frequency \[Hz\], for a specimen of `length` \[m\]: kL is the
    /// middle of the quadrant of the branch, with half the width of the quadrant as its standard
    /// error.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] unless frequency and length are finite and above 0.
    pub fn with_branch(
        self,
        frequency_hz: f64,
        branch: Branch,
        length: f64,
    ) -> Result<Self, CmodError> {
        let length = check_positive("length [m]", length)?;
        let middle = PI * f64::from(branch.half_waves()) + f64::from(branch.sign()) * 0.25 * PI;
        self.with_wave_number(frequency_hz, middle / length, 0.25 * PI / length)
    }

    /// Assigns each line of all `records` to its branch. All records must be of one material, so
    /// that they share γ(ω).
    ///
    /// # Errors
    /// [`CmodError::NoLines`] without a record, or a record without lines;
    /// [`CmodError::NonPhysical`] for a length that is not above 0; [`CmodError::Frequency`],
    /// [`CmodError::FrequencyOrder`], [`CmodError::LengthMismatch`];
    /// [`CmodError::NegativeVariance`].
    pub fn track(&self, records: &[PhaseRecord<'_>]) -> Result<TrackedBranches, CmodError> {
        if records.is_empty() {
            return Err(CmodError::NoLines);
        }
        for record in records {
            record.check()?;
        }
        let (mut lines, places) = lines_in_order(records);
        let stated = records.iter().all(|record| record.variance.is_some());
        let anchors = Anchors {
            slowest: self.slowest,
            fastest: self.fastest,
            speed: self.speed,
            known: &self.known,
        };
        let mut courses = Courses::default();
        let mut noise = NoiseLevel::of(&lines, &places, stated);
        for adjustment in 0..=ADJUSTMENTS {
            noise.apply(&mut lines);
            courses.follow(&lines, &anchors);
            if adjustment == ADJUSTMENTS || !noise.adjust(courses.excess()) {
                break;
            }
        }

        let mut tracked: Vec<Vec<TrackedLine>> = records
            .iter()
            .map(|record| vec![TrackedLine::AT_REST; record.frequency_hz.len()])
            .collect();
        let verdict = Verdict::of(&courses, &lines);
        for (index, (line, place)) in lines.iter().zip(&places).enumerate() {
            let entry = tracked
                .get_mut(place.record)
                .and_then(|record| record.get_mut(place.line));
            if let Some(entry) = entry {
                *entry = verdict.line(index, line);
            }
        }
        Ok(TrackedBranches {
            records: tracked,
            hypotheses: verdict.hypotheses(&lines),
            noise_factor: noise.factor(),
        })
    }
}

impl<'a> PhaseRecord<'a> {
    fn check(&self) -> Result<(), CmodError> {
        check_positive("length [m]", self.length)?;
        check_frequencies(self.frequency_hz)?;
        let count = self.frequency_hz.len();
        check_length("observed ratio", self.observed.len(), count)?;
        if let Some(variance) = self.variance {
            check_length("variance", variance.len(), count)?;
            if let Some((index, &variance)) = variance.iter().enumerate().find(|(_, v)| **v < 0.0) {
                return Err(CmodError::NegativeVariance { index, variance });
            }
        }
        Ok(())
    }

    fn line(&self, index: usize) -> Option<LineAt<'a>> {
        let omega = TAU * self.frequency_hz.get(index)?;
        let observed = *self.observed.get(index)?;
        let variance = match self.variance {
            Some(variance) => *variance.get(index)?,
            None => assumed_variance(observed),
        };
        let variance = variance.max(least_variance(observed));
        Some(LineAt {
            omega,
            missing: !(observed.is_finite() && variance.is_finite()),
            sight: Sight {
                observation: self.observation,
                length: self.length,
                observed,
                variance,
            },
        })
    }
}

/// Returns the lines of all records above 0 Hz in order of frequency, with their origin.
fn lines_in_order<'a>(records: &[PhaseRecord<'a>]) -> (Vec<LineAt<'a>>, Vec<Place>) {
    let count = records.iter().map(|record| record.frequency_hz.len()).sum();
    let mut lines = Vec::with_capacity(count);
    let mut places = Vec::with_capacity(count);
    for (index, record) in records.iter().enumerate() {
        for line in 0..record.frequency_hz.len() {
            if let Some(entry) = record.line(line).filter(|line| line.omega > 0.0) {
                lines.push(entry);
                places.push(Place {
                    record: index,
                    line,
                });
            }
        }
    }
    if records.len() == 1 {
        return (lines, places);
    }
    let mut all: Vec<_> = lines.into_iter().zip(places).collect();
    all.sort_by(|a, b| a.0.omega.total_cmp(&b.0.omega));
    all.into_iter().unzip()
}
