//! Sensitivities, delays and positions of gauges, determined from the lines.

use num_complex::Complex64;

use super::projection::Projection;
use super::spectra::{GaugeSpectra, GaugedRod, WhiteLine};
use super::uncertainty::{GaugeError, GaugeUncertainty};
use super::{MultiPoint, Quantity, ThreePoint};
use crate::causal::{CausalEstimate, of_experiment};
use crate::complex_frequency::ComplexFrequency;
use crate::error::CmodError;
use crate::estimate::{ErrorSource, ModulusEstimate, ModulusLine, SystematicShift};
use crate::lateral_inertia::LateralInertia;
use crate::median::median;
use crate::self_calibration::{
    Experiment, LinearisedLine, Misfit, SelfCalibration, continuation, found,
};

/// Method that determines the modulus from the spectra of gauges.
pub trait GaugeMethod {
    /// Returns the gauged rod.
    fn rod(&self) -> &GaugedRod;

    /// Returns the uncertainties of the gauged rod.
    fn uncertainty(&self) -> &GaugeUncertainty;

    /// Returns the complex modulus.
    ///
    /// # Errors
    /// The errors of the method that implements the trait.
    fn estimate_modulus(&self, spectra: &GaugeSpectra<'_>) -> Result<ModulusEstimate, CmodError>;

    /// Returns true if the last position of the rod is a free end and the gauges measure a motion.
    /// The slope of a motion is 0 at a free end without mass.
    fn ends_with_slope(&self) -> bool {
        false
    }

    /// Returns the length of rod \[m\] that has the same mass as the mass on the end.
    fn end_length(&self) -> f64 {
        0.0
    }

    /// Returns the damping σ that was added to the records [1/s].
    fn added_damping(&self) -> f64 {
        0.0
    }

    /// Returns the complex modulus from gauges at these `positions` \[m\]: by least squares if the
    /// method itself requires special positions. The result is the modulus on the lines s = σ + iω
    /// of the added damping σ.
    ///
    /// # Errors
    /// The errors of the method and of the positions.
    fn estimate_at(
        &self,
        positions: Vec<f64>,
        spectra: &GaugeSpectra<'_>,
    ) -> Result<ModulusEstimate, CmodError>;
}

impl GaugeMethod for MultiPoint {
    fn rod(&self) -> &GaugedRod {
        &self.rod
    }

    fn uncertainty(&self) -> &GaugeUncertainty {
        &self.uncertainty
    }

    fn estimate_modulus(&self, spectra: &GaugeSpectra<'_>) -> Result<ModulusEstimate, CmodError> {
        Ok(self.estimate(spectra)?.modulus)
    }

    fn ends_with_slope(&self) -> bool {
        self.has_free_end && self.quantity != Quantity::Strain
    }

    fn end_length(&self) -> f64 {
        self.rod.length_of(self.end_mass)
    }

    fn added_damping(&self) -> f64 {
        self.added_damping
    }

    fn estimate_at(
        &self,
        positions: Vec<f64>,
        spectra: &GaugeSpectra<'_>,
    ) -> Result<ModulusEstimate, CmodError> {
        let mut moved = self.clone();
        moved.rod.positions = positions;
        moved.rod.check()?;
        Ok(moved.on_lines(spectra)?.modulus)
    }
}

impl GaugeMethod for ThreePoint {
    fn rod(&self) -> &GaugedRod {
        &self.rod
    }

    fn uncertainty(&self) -> &GaugeUncertainty {
        &self.uncertainty
    }

    fn estimate_modulus(&self, spectra: &GaugeSpectra<'_>) -> Result<ModulusEstimate, CmodError> {
        self.estimate(spectra)
    }

    fn estimate_at(
        &self,
        positions: Vec<f64>,
        spectra: &GaugeSpectra<'_>,
    ) -> Result<ModulusEstimate, CmodError> {
        if positions == self.rod.positions {
            return self.estimate(spectra);
        }
        let moved = GaugedRod {
            positions,
            ..self.rod.clone()
        };
        let mut method = MultiPoint::new(moved)?.with_uncertainty(self.uncertainty.clone())?;
        method.settings = self.settings;
        // the measured positions are accurate enough for the closed form to count the waves
        method.settings.wave_speed = speed_of_first_lines(&self.estimate(spectra)?);
        method.estimate_modulus(spectra)
    }
}

/// Returns the median of the phase velocities of the first informative lines.
fn speed_of_first_lines(estimate: &ModulusEstimate) -> Option<f64> {
    const FIRST: usize = 21;
    let lines = estimate.telling().take(FIRST);
    let mut speeds: Vec<f64> = lines.map(|line| line.phase_velocity).collect();
    median(&mut speeds).filter(|speed| *speed > 0.0)
}

impl SelfCalibration {
    /// Returns the estimate of a `method` for gauges, in which the [uncertain](GaugeUncertainty)
    /// sensitivities, delays and positions of the gauges are determined from the lines. If there
    /// are more gauges than the two waves need, the residuals also contribute.
    ///
    /// Returns `None` if the gauges have no uncertainty, or if there are too few lines to determine
    /// these quantities.
    ///
    /// # Errors
    /// The errors of the `method`.
    pub fn of_gauges(
        method: &(impl GaugeMethod + ?Sized),
        spectra: &GaugeSpectra<'_>,
    ) -> Result<Option<Self>, CmodError> {
        let experiment = GaugeExperiment::new(method, spectra);
        let mut found = found(&experiment.measured(), &experiment)?;
        if let Some(found) = &mut found
            && method.added_damping() > 0.0
        {
            found.estimate = continuation::on_axis(
                &found.estimate,
                method.added_damping(),
                method.rod().diameter,
                method.rod().aperture(),
            )?;
        }
        Ok(found)
    }
}

impl CausalEstimate {
    /// Projects the gauge lines of a `method` onto the cone of relaxing materials, with all
    /// uncertainties of the method. With [added damping](MultiPoint::with_added_damping), the
    /// estimated material also gives the modulus on the axis s = iω.
    ///
    /// # Errors
    /// The errors of [`CausalEstimate::of_ratio`].
    pub fn of_gauges(
        method: &(impl GaugeMethod + ?Sized),
        spectra: &GaugeSpectra<'_>,
        lateral_inertia: Option<&LateralInertia>,
    ) -> Result<Self, CmodError> {
        let experiment = GaugeExperiment::new(method, spectra);
        of_experiment(&experiment, &experiment.measured(), lateral_inertia)
    }
}

struct GaugeExperiment<'a, M: ?Sized> {
    method: &'a M,
    spectra: &'a GaugeSpectra<'a>,
    /// Uncertain sources with their standard uncertainties.
    sources: Vec<(ErrorSource, f64)>,
}

impl<'a, M: GaugeMethod + ?Sized> GaugeExperiment<'a, M> {
    fn new(method: &'a M, spectra: &'a GaugeSpectra<'a>) -> Self {
        Self {
            method,
            spectra,
            sources: method.uncertainty().of_gauges().collect(),
        }
    }

    /// Returns the sources whose errors are removed from the spectra.
    fn measured(&self) -> Vec<ErrorSource> {
        self.sources.iter().map(|(source, _)| *source).collect()
    }

    /// Returns the error due to one standard uncertainty of each source, at s = σ + iω.
    fn errors(&self, s: Complex64) -> impl Iterator<Item = GaugeError> {
        let sources = self.sources.iter();
        let rod = self.method.rod();
        sources
            .filter_map(move |(source, uncertainty)| GaugeError::of(*source, *uncertainty, s, rod))
    }

    /// Returns the factor on the spectra of `gauge` that removes errors of the sizes `removed` from
    /// these spectra.
    fn factor(&self, gauge: usize, s: Complex64, removed: &[f64]) -> Complex64 {
        let own = self.errors(s).zip(removed);
        let own = own.filter(|(error, _)| error.gauge == gauge);
        own.map(|(error, size)| -*size * error.by_value)
            .sum::<Complex64>()
            .exp()
    }

    fn frequency(&self, hz: f64) -> ComplexFrequency {
        ComplexFrequency::new(hz, self.method.added_damping())
    }

    fn positions(&self, removed: &[f64]) -> Vec<f64> {
        let mut positions = self.method.rod().positions.clone();
        // errors of the positions do not depend on s, so any value of s will do
        for (error, size) in self.errors(Complex64::ZERO).zip(removed) {
            if let Some(position) = positions.get_mut(error.gauge) {
                *position += size * error.by_slope;
            }
        }
        positions
    }
}

impl<M: GaugeMethod + ?Sized> Experiment for GaugeExperiment<'_, M> {
    fn added_damping(&self) -> f64 {
        self.method.added_damping()
    }

    fn estimate(&self, removed: &[f64]) -> Result<ModulusEstimate, CmodError> {
        let corrected = |spectrum: &Vec<Complex64>, gauge: usize| -> Vec<Complex64> {
            let lines = spectrum.iter().zip(self.spectra.frequency_hz);
            lines
                .map(|(value, f)| value * self.factor(gauge, self.frequency(*f).laplace(), removed))
                .collect()
        };
        let tests: Vec<Vec<Vec<Complex64>>> = self
            .spectra
            .tests
            .iter()
            .map(|test| {
                let gauges = test.iter().enumerate();
                gauges
                    .map(|(gauge, spectrum)| corrected(spectrum, gauge))
                    .collect()
            })
            .collect();
        let tests: Vec<&[Vec<Complex64>]> = tests.iter().map(Vec::as_slice).collect();
        let spectra = GaugeSpectra {
            tests: &tests,
            ..*self.spectra
        };
        self.method.estimate_at(self.positions(removed), &spectra)
    }

    fn linearised(
        &self,
        line: &ModulusLine,
        gamma: Complex64,
        removed: &[f64],
    ) -> Option<LinearisedLine> {
        let frequency = self.frequency(line.frequency_hz);
        let s = frequency.laplace();
        let n_rows = self.method.rod().positions.len();
        let mut white = WhiteLine::for_spectra(self.spectra, n_rows);
        white.load(self.spectra, line.index).ok()?;
        let factors: Vec<Complex64> = (0..n_rows)
            .map(|gauge| self.factor(gauge, s, removed))
            .collect();
        for (value, factor) in white.values.iter_mut().zip(factors.iter().cycle()) {
            *value *= factor;
        }
        let errors: Vec<GaugeError> = self.errors(s).collect();
        let (is_slope, end_length) = (self.method.ends_with_slope(), self.method.end_length());
        let positions = self.positions(removed);
        let mut projection = Projection::with_last_row(&positions, is_slope, end_length);
        let about = projection.about(gamma, &white, &errors)?;
        let density = self.method.rod().density;
        let modulus = frequency.modulus(gamma, density).ok()?;
        let by_gamma = -2.0 * modulus / gamma;
        let of_gauges = self.sources.iter().zip(&about.moves);
        let mut shifts: Vec<SystematicShift> = of_gauges
            .map(|((source, _), moves)| SystematicShift::new(*source, by_gamma * moves, *moves))
            .collect();
        let others = line.uncertainty.systematic.iter().filter(|shift| {
            let mut sources = self.sources.iter();
            !sources.any(|(source, _)| *source == shift.source)
        });
        // the shifts are scaled to the smooth modulus; if they were scaled to the modulus of the
        // line, they would contain its noise
        let (of_modulus, of_gamma) = (modulus / line.modulus, gamma / line.propagation_coefficient);
        shifts.extend(others.map(|shift| {
            SystematicShift::new(
                shift.source,
                of_modulus * shift.modulus,
                of_gamma * shift.propagation_coefficient,
            )
        }));
        // correlated lines carry less information than the same number of independent lines
        let correlated = continuation::lines_per_independent_line(
            self.spectra.frequency_hz,
            self.method.added_damping(),
        );
        let independent = |sum: f64| sum / correlated;
        Some(LinearisedLine {
            modulus: modulus + by_gamma * about.step,
            variance: correlated * white.variance * by_gamma.norm_sqr() / about.information,
            shifts,
            misfit: Some(Misfit {
                normal: about.normal.into_iter().map(independent).collect(),
                gradient: about.gradient.into_iter().map(independent).collect(),
                square: independent(about.square),
                degrees_of_freedom: independent((2 * (white.n_tests() * (n_rows - 2) - 1)) as f64),
            }),
        })
    }
}
