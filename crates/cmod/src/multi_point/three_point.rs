//! Method for three equidistant sections, in closed form (Ödeen 1993, paper B).
//!
//! ```text
//! cosh γa = Ψ ,    Ψ = (q̂₁ + q̂₂)/(2 q̂₀)                              (paper B, eqs. 6-7)
//! ```
//!
//! with q₀ at the middle and q₁, q₂ at the distance a on either side of the middle. This is the
//! equation of a rod of length a with a free end, and it has the same roots and branches (eqs. 8-9,
//! Table 1); see [`crate::branch`].

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::GaugeSettings;
use super::line::SolvedLine;
use super::spectra::{GaugeSpectra, GaugedRod};
use super::uncertainty::{GaugeInfluence, GaugeUncertainty};
use crate::branch::{ResolvedRoot, resolve_lines};
use crate::complex_frequency::ComplexFrequency;
use crate::error::CmodError;
use crate::estimate::{Acceptance, Method, ModulusEstimate, Refusal, Termination};
use crate::validity::Violation;

/// Relative difference up to which the distances count as equal: it covers the rounding of
/// positions in metres.
const EQUAL: f64 = 1e-9;
/// Largest ratio of the noise amplitude to the signal amplitude, at the middle gauge, for which Ψ
/// is valid. At this ratio Ψ is biased by 1 %.
pub const MOST_NOISE_AT_THE_MIDDLE: f64 = 0.1;

/// Three-point method for one rod (paper B).
///
/// ```
/// use cmod::{GaugeSpectra, GaugedRod, ThreePoint};
/// use num_complex::Complex64;
///
/// // one wave along +x in a rod with c = 1700 m/s and a loss factor of 0.1
/// let gamma = |f: f64| Complex64::new(0.05, 1.0) * (2.0 * std::f64::consts::PI * f / 1700.0);
/// let frequency_hz: Vec<f64> = (1..=100).map(|j| 50.0 * f64::from(j)).collect();
/// let at = |x: f64| frequency_hz.iter().map(|&f| (-gamma(f) * x).exp()).collect::<Vec<Complex64>>();
/// let rod = GaugedRod { positions: vec![0.0, 0.2, 0.4], diameter: 0.016, density: 919.0 };
/// let estimate = ThreePoint::new(rod)?.estimate(&GaugeSpectra {
///     frequency_hz: &frequency_hz,
///     tests: &[&[at(0.0), at(0.2), at(0.4)]],
///     noise: &vec![vec![1e-4; 100]; 3],
/// })?;
/// for line in estimate.valid() {
///     assert!((line.phase_velocity - 1700.0).abs() < 1e-6);
/// }
/// assert!(estimate.valid().count() > 50);
/// # Ok::<(), cmod::CmodError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ThreePoint {
    pub(super) rod: GaugedRod,
    distance: f64,
    pub(super) settings: GaugeSettings,
    pub(super) uncertainty: GaugeUncertainty,
}

/// Ratio Ψ of one line.
struct Ratio {
    index: usize,
    frequency_hz: f64,
    value: Complex64,
    variance: f64,
    /// Parts of the variance due to the three gauges.
    parts: [f64; 3],
    /// Error of |Ψ| divided by the relative error of the gauges.
    amplification: f64,
    noise_to_signal: f64,
    /// Sums of q₁q₀*, |q₀|² and q₂q₀* over the tests.
    sums: [Complex64; 3],
}

impl Ratio {
    /// Returns E|δΨ|² due to uncertain sensitivities and delays.
    fn variance_by_sensors(&self, uncertainty: &GaugeUncertainty) -> f64 {
        let [first, middle, last] = self.sums;
        let parts = [0.5 * first / middle, self.value, 0.5 * last / middle];
        let omega = TAU * self.frequency_hz;
        let of = |values: &[f64], gauge: usize| values.get(gauge).copied().unwrap_or(0.0);
        let parts = parts.iter().enumerate();
        parts
            .map(|(gauge, part)| {
                let factor = of(&uncertainty.factors, gauge);
                let delay = omega * of(&uncertainty.delays, gauge);
                part.norm_sqr() * (factor * factor + delay * delay)
            })
            .sum()
    }

    /// Returns the influence of each gauge: dγ = dΨ/(a sinh γa), where the change of Ψ is dΨ =
    /// Σ(dq₁ + dq₂)q₀*/(2Σ|q₀|²) - Ψ Σ dq₀ q₀*/Σ|q₀|². Here dq is q' dx for a position and q for a
    /// sensitivity, with q = q₀ cosh γx + (q₂ - q₁) sinh γx/(2 sinh γa) and x from the middle.
    fn influence(&self, gamma: Complex64, a: f64) -> Vec<GaugeInfluence> {
        let [first, middle, last] = self.sums;
        let (sinh, cosh) = ((gamma * a).sinh(), (gamma * a).cosh());
        let odd = (last - first) / (2.0 * sinh);
        let slopes = [
            odd * cosh - middle * sinh,
            odd * (-2.0 * self.value),
            odd * cosh + middle * sinh,
        ];
        let values = [first, -2.0 * self.value * middle, last];
        let scale = (2.0 * middle * a * sinh).inv();
        let of_gauge = |(slope, value): (&Complex64, &Complex64)| GaugeInfluence {
            position: gamma * slope * scale,
            scale: value * scale,
            end_length: Complex64::ZERO,
        };
        slopes.iter().zip(&values).map(of_gauge).collect()
    }
}

setters! { ThreePoint: noise_freedom, limits }

impl ThreePoint {
    /// Creates the method for a `rod` with three equidistant gauges.
    ///
    /// # Errors
    /// [`CmodError::GaugeCount`], [`CmodError::NotEquidistant`], [`CmodError::PositionOrder`] and
    /// [`CmodError::NonPhysical`] for the rod.
    pub fn new(rod: GaugedRod) -> Result<Self, CmodError> {
        rod.check()?;
        let [first, middle, last] = rod.positions[..] else {
            return Err(CmodError::GaugeCount {
                found: rod.positions.len(),
                expected: "3",
            });
        };
        let (before, behind) = (middle - first, last - middle);
        let size = first.abs().max(last.abs());
        if (before - behind).abs() > EQUAL * size.max(before) {
            return Err(CmodError::NotEquidistant {
                first: before,
                second: behind,
            });
        }
        Ok(Self {
            distance: 0.5 * (last - first),
            rod,
            settings: GaugeSettings::default(),
            uncertainty: GaugeUncertainty::default(),
        })
    }

    /// Sets the standard uncertainties of the rod and its gauges, which are common to all lines. By
    /// default all quantities are exact.
    ///
    /// # Errors
    /// [`CmodError::NonPhysical`] for a value that is not finite or below 0;
    /// [`CmodError::GaugeCount`] unless each list is empty or has one value per gauge.
    pub fn with_uncertainty(mut self, uncertainty: GaugeUncertainty) -> Result<Self, CmodError> {
        self.uncertainty = uncertainty.check(self.rod.positions.len(), false)?;
        Ok(self)
    }

    /// Returns the distance a between neighbouring gauges \[m\].
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Returns the complex modulus.
    ///
    /// For several tests, Ψ is the ratio of the summed cross-spectra of (q₁ + q₂)/2 and q₀ to the
    /// summed auto-spectra of q₀ (paper B, section 3). Half waves are counted as in
    /// [`crate::branch`]. The variance of γ is
    ///
    /// ```text
    /// E|δγ|² = [(σ₁² + σ₂²)/4 + |Ψ|² σ₀²] / (a² |sinh γa|² Σ|q̂₀|²)
    /// ```
    ///
    /// It grows without bound near ka = nπ and where a node is at the middle gauge. Such lines are
    /// marked.
    ///
    /// # Errors
    /// Errors of the `spectra` as a whole: [`CmodError::NoLines`], [`CmodError::NoTests`],
    /// [`CmodError::Frequency`], [`CmodError::FrequencyOrder`], [`CmodError::SpectraOfTest`],
    /// [`CmodError::SpectrumLength`], [`CmodError::GaugeCount`], [`CmodError::LengthMismatch`],
    /// [`CmodError::NegativeNoise`].
    pub fn estimate(&self, spectra: &GaugeSpectra<'_>) -> Result<ModulusEstimate, CmodError> {
        spectra.check(3)?;
        let mut estimate =
            ModulusEstimate::empty(Method("three-point method"), self.settings.limits);
        let mut ratios = Vec::with_capacity(spectra.frequency_hz.len());
        for (index, &frequency_hz) in spectra.frequency_hz.iter().enumerate() {
            match ratio(spectra, index, frequency_hz) {
                Ok(ratio) => ratios.push(ratio),
                Err(reason) => estimate.add(index, frequency_hz, Err(reason)),
            }
        }
        let line = |ratio: &Ratio| {
            // waves are counted where neither noise nor sensor errors prevent counting
            let whole = ratio.variance + ratio.variance_by_sensors(&self.uncertainty);
            (ratio.frequency_hz, ratio.value, whole)
        };
        let roots = resolve_lines(self.distance, 0.0, ratios.iter().map(line))?;
        for (ratio, root) in ratios.iter().zip(roots) {
            let freedom = self.settings.noise_freedom;
            let freedom = freedom.map(|freedom| freedom.of_sum(ratio.parts.into_iter()));
            let acceptance = Acceptance::of_line(self.settings.limits, freedom)?;
            let solved = self.solved(ratio, root);
            let judged = solved.into_modulus((&self.rod, 0.0), &self.uncertainty, &acceptance);
            estimate.add(ratio.index, ratio.frequency_hz, judged);
        }
        Ok(estimate)
    }

    fn solved(&self, ratio: &Ratio, root: ResolvedRoot) -> SolvedLine {
        let a = self.distance;
        let gamma_a = root.gamma_length;
        let sinh = gamma_a.sinh();
        let ambiguity = root.ambiguity().map(Violation::BranchAmbiguous);
        let mut violations: Vec<Violation> = ambiguity.into_iter().collect();
        if ratio.noise_to_signal > MOST_NOISE_AT_THE_MIDDLE {
            violations.push(Violation::NodeAtMiddleGauge {
                noise_to_signal: ratio.noise_to_signal,
                limit: MOST_NOISE_AT_THE_MIDDLE,
            });
        }
        SolvedLine {
            index: ratio.index,
            frequency: ComplexFrequency::on_axis(ratio.frequency_hz),
            gamma: gamma_a / a,
            variance: ratio.variance / (a * a * sinh.norm_sqr()),
            influence: ratio.influence(gamma_a / a, a),
            // from δΨ = a sinh γa δγ + a² cosh γa δγ²/2
            curvature: 0.5 * a * gamma_a.cosh().norm() / sinh.norm(),
            amplification: ratio.amplification / (a * sinh.norm()),
            closed_form: Some(root),
            termination: Termination::ClosedForm,
            violations,
        }
    }
}

fn ratio(spectra: &GaugeSpectra<'_>, index: usize, frequency_hz: f64) -> Result<Ratio, Refusal> {
    if frequency_hz == 0.0 {
        return Err(Refusal::ZeroFrequency);
    }
    let mut cross = Complex64::ZERO;
    let mut sums = [Complex64::ZERO; 3];
    let mut auto = 0.0;
    let mut power = 0.0;
    let mut count = 0.0;
    for test in spectra.tests {
        let value = |gauge: usize| test.get(gauge)?.get(index).copied();
        let (Some(first), Some(middle), Some(last)) = (value(0), value(1), value(2)) else {
            return Err(Refusal::SpectrumNotFinite);
        };
        cross += 0.5 * (first + last) * middle.conj();
        for (sum, value) in sums.iter_mut().zip([first, middle, last]) {
            *sum += value * middle.conj();
        }
        auto += middle.norm_sqr();
        power += first.norm_sqr() + middle.norm_sqr() + last.norm_sqr();
        count += 1.0;
    }
    let variance_of = |gauge: usize| {
        let noise = spectra.noise.get(gauge).and_then(|noise| noise.get(index));
        noise.map_or(f64::NAN, |noise| noise * noise)
    };
    let (first, middle, last) = (variance_of(0), variance_of(1), variance_of(2));
    if !(power.is_finite() && first.is_finite() && middle.is_finite() && last.is_finite()) {
        return Err(Refusal::SpectrumNotFinite);
    }
    let value = cross / auto;
    if auto == 0.0 || !value.is_finite() {
        return Err(Refusal::Undetermined);
    }
    let parts_of =
        |s1: f64, s0: f64, s2: f64| [0.25 * s1, value.norm_sqr() * s0, 0.25 * s2].map(|s| s / auto);
    let parts = parts_of(first, middle, last);
    let relative = power / (3.0 * count);
    Ok(Ratio {
        index,
        frequency_hz,
        value,
        variance: parts.iter().sum(),
        parts,
        amplification: parts_of(relative, relative, relative)
            .iter()
            .sum::<f64>()
            .sqrt(),
        noise_to_signal: (middle * count / auto).sqrt(),
        sums,
    })
}
