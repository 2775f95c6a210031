//! Specimens of paper A, materials, noise and gaps, and a test for the right root of a noisy line.

use std::f64::consts::{PI, TAU};

use cmod::branch::{
    BranchTracker, EndMass, PhaseObservation, PhaseRecord, TrackedBranches, TrackedLine,
};
use num_complex::Complex64;
use rand::RngExt;
use rodwave::chain::{AngularFrequency, WaveMedium};
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::{EndAccelerationTest, Specimen};
use rodwave::medium::{Medium, PropagationLaw};

use crate::golden::{Row, golden};
use testbed::noise::Noise;

/// Mass of the accelerometers of paper A with their connectors [kg].
pub(crate) const ACCELEROMETER: f64 = 2.9e-3;

/// Rod with its accelerometer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rod {
    pub(crate) length: f64,
    pub(crate) diameter: f64,
    pub(crate) density: f64,
    pub(crate) accelerometer: f64,
}

impl Rod {
    pub(crate) fn mass_ratio(&self) -> f64 {
        self.accelerometer / (self.density * 0.25 * PI * self.diameter.powi(2) * self.length)
    }

    pub(crate) fn observation(&self) -> EndMass {
        EndMass {
            mass_ratio: self.mass_ratio(),
        }
    }
}

/// Returns the rods of Tests 1 to 10 (paper A, Table 2).
pub(crate) fn rods_of_paper_a() -> Vec<Rod> {
    let rows = golden("paper_a_table_2.ron");
    assert_eq!(rows.len(), 10);
    let of = |row: &Row| Rod {
        length: row.value("length"),
        diameter: row.value("diameter"),
        density: row.value("density"),
        accelerometer: ACCELEROMETER,
    };
    rows.iter().map(of).collect()
}

/// Record without noise.
pub(crate) struct Clean {
    pub(crate) rod: Rod,
    pub(crate) frequency_hz: Vec<f64>,
    pub(crate) ratio: Vec<Complex64>,
    /// Exact γL of the material.
    pub(crate) exact: Vec<Complex64>,
}

impl Clean {
    pub(crate) fn of<L>(medium: &Medium<L>, rod: Rod, frequency_hz: Vec<f64>) -> Self
    where
        L: PropagationLaw,
        Medium<L>: WaveMedium<AngularFrequency> + Clone + 'static,
    {
        let specimen = Specimen {
            section: Circle::of_diameter(rod.diameter).unwrap().into(),
            length: rod.length,
            accelerometer_mass: rod.accelerometer,
        };
        let test = EndAccelerationTest::new(medium, &specimen).unwrap();
        let ratio = |f: &f64| test.acceleration_ratio(TAU * f).unwrap();
        let exact = |f: &f64| medium.propagation_coefficient(TAU * f) * rod.length;
        Self {
            rod,
            ratio: frequency_hz.iter().map(ratio).collect(),
            exact: frequency_hz.iter().map(exact).collect(),
            frequency_hz,
        }
    }

    /// Adds noise of `noise` times |Ψ|, and replaces the fraction `missing` of the lines by NaN.
    pub(crate) fn measured(&self, noise: f64, missing: f64, seed: u64) -> Measured {
        let mut random = Noise::seeded(seed);
        let mut observed = Vec::with_capacity(self.ratio.len());
        for ratio in &self.ratio {
            let gap = random.0.random::<f64>() < missing;
            let error = random.circular((noise * ratio.norm()).powi(2));
            observed.push(if gap {
                Complex64::new(f64::NAN, f64::NAN)
            } else {
                ratio + error
            });
        }
        let variance = observed
            .iter()
            .map(|ratio| noise * noise * ratio.norm_sqr())
            .collect();
        Measured { observed, variance }
    }

    /// Returns true if a line fulfils conditions (i) and (ii) of paper A with the exact wave
    /// number.
    pub(crate) fn is_inside(&self, line: usize) -> bool {
        let wavelength = TAU * self.rod.length / self.exact[line].im;
        wavelength > 5.0 * self.rod.diameter && wavelength < 5.0 * self.rod.length
    }
}

/// Ratios as an analyser would return them, with their variances.
pub(crate) struct Measured {
    pub(crate) observed: Vec<Complex64>,
    pub(crate) variance: Vec<f64>,
}

impl Measured {
    pub(crate) fn record<'a>(
        &'a self,
        clean: &'a Clean,
        observation: &'a EndMass,
    ) -> PhaseRecord<'a> {
        PhaseRecord {
            observation,
            length: clean.rod.length,
            frequency_hz: &clean.frequency_hz,
            observed: &self.observed,
            variance: Some(&self.variance),
        }
    }

    /// Tracks the record alone.
    pub(crate) fn tracked(&self, tracker: &BranchTracker, clean: &Clean) -> TrackedBranches {
        let observation = clean.rod.observation();
        tracker.track(&[self.record(clean, &observation)]).unwrap()
    }

    /// Describes the first line that is wrong and not doubted.
    pub(crate) fn silently_wrong(&self, clean: &Clean, lines: &[TrackedLine]) -> Option<String> {
        let observation = clean.rod.observation();
        let known = clean.exact.iter().zip(&self.observed);
        lines
            .iter()
            .zip(known)
            .find_map(|(line, (exact, observed))| {
                let right = is_right(&observation, line.root?, *exact, *observed);
                (!right && !is_doubted(line)).then(|| format!("{line:?} instead of {exact}"))
            })
    }
}

pub(crate) fn is_doubted(line: &TrackedLine) -> bool {
    line.doubt.is_some_and(|doubt| doubt.is_ambiguous())
}

/// Returns true if a root is the root nearest to the exact γL.
///
/// Where two roots meet, Ψ is a parabola, and the other root is the reflection of the first; all
/// further roots are at a distance of π or more. Roots within 0.005 of each other count as one
/// root, as in the tracker.
pub(crate) fn is_right(
    observation: &EndMass,
    root: Complex64,
    exact: Complex64,
    observed: Complex64,
) -> bool {
    let [value, slope, curvature] = observation.expand(root);
    assert!(
        (value - observed).norm() < 1e-7 * (1.0 + observed.norm()),
        "{root} is no root"
    );
    // the parabola is accurate near the point where the roots meet; Newton's iteration refines the
    // other root, unless it returns to the first root
    let mut reflected = root - 2.0 * slope / curvature;
    if (reflected - root).norm() < 2.0 {
        let mut refined = reflected;
        for _ in 0..6 {
            let [value, slope, _] = observation.expand(refined);
            refined += (observed - value) / slope;
        }
        if (refined - reflected).norm() < 0.5 * (refined - root).norm() {
            reflected = refined;
        }
    }
    let (here, there) = ((root - exact).norm(), (reflected - exact).norm());
    here < 1.5 && (here <= there || (root - reflected).norm() < 0.005)
}
