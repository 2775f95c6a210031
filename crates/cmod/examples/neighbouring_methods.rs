//! Figure 3 of paper A for a virtual rod: the modulus of one rod of polypropylene by the two-point
//! method and by related methods, each with its standard errors, and the outcome of the checks.
//!
//! ```text
//! cargo run --release --package cmod --example neighbouring_methods
//! ```
//!
//! The program writes `target/examples/neighbouring_methods.svg`.
#![allow(
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "an example prints its results, and may panic on a wrong index"
)]

use std::error::Error;
use std::f64::consts::TAU;

use cmod::checks::{FreeEndNull, USUAL_LEVEL, kramers_kronig, passivity};
use cmod::estimate::ModulusEstimate;
use cmod::multi_point::{GaugeSpectra, Quantity};
use cmod::{
    EndSection, FreeEnd, ModulusLine, OneGauge, PulsedRod, RatioOfSpectra, Resonances,
    RodWithFreeEnd, SeparatePulses, Specimen, TwoPoint,
};
use num_complex::Complex64;
use rodfigure::{Figure, Mark, Panel, Role};
use rodwave::chain::{Chain, Termination};
use rodwave::element::Circle;
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use testbed::noise::Noise;

const LENGTH: f64 = 0.801;
const DIAMETER: f64 = 0.0106;
const DENSITY: f64 = 903.0;
const ACCELEROMETER: f64 = 2.9e-3;
/// Distances of three strain gauges from the free end.
const GAUGES: [f64; 3] = [0.5, 0.35, 0.22];
/// Error of a spectrum, relative to its magnitude.
const NOISE: f64 = 2e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let polypropylene = Medium::new(DENSITY, ConstantQ::new(2.6e9, 0.07, TAU * 1e3)?)?;
    let chain = Chain::from_impact_face()
        .rod(&polypropylene, Circle::of_diameter(DIAMETER)?, LENGTH)
        .end(Termination::Mass(ACCELEROMETER))?;
    let frequency_hz: Vec<f64> = (1..=500_u32).map(|j| 20.0 * f64::from(j)).collect();
    let mut random = Noise::seeded(1993);

    // measured spectra: accelerations of the ends, forces at the gauges (proportional to the
    // strains), and waves at the gauges
    let mut ends: [Spectrum; 2] = Default::default();
    let mut gauges: [Spectrum; 3] = Default::default();
    let mut waves: [Spectrum; 3] = Default::default();
    for f in &frequency_hz {
        let omega = TAU * f;
        for (end, x) in ends.iter_mut().zip([0.0, LENGTH]) {
            let velocity = chain.section(0, x)?.state(omega)?.velocity;
            end.add(Complex64::new(0.0, omega) * velocity, &mut random);
        }
        for (gauge, distance) in gauges.iter_mut().zip(GAUGES) {
            let state = chain.section(0, LENGTH - distance)?.state(omega)?;
            gauge.add(state.normal_force, &mut random);
        }
        let at = |distance: f64| chain.section(0, LENGTH - distance)?.waves(omega);
        let (far, near) = (at(GAUGES[0])?, at(GAUGES[2])?);
        let passing = [
            far.forward_at(0.0),
            near.forward_at(0.0),
            near.backward_at(0.0),
        ];
        for (wave, value) in waves.iter_mut().zip(passing) {
            wave.add(value, &mut random);
        }
    }

    let rod = RodWithFreeEnd {
        diameter: DIAMETER,
        density: DENSITY,
        end_mass: ACCELEROMETER,
    };
    let gauge = |index: usize| EndSection {
        distance: GAUGES[index],
        quantity: Quantity::Strain,
    };
    let specimen = Specimen {
        length: LENGTH,
        diameter: DIAMETER,
        density: DENSITY,
        accelerometer_mass: ACCELEROMETER,
    };
    let psi = ends[0].over(&ends[1])?;
    let two_point = TwoPoint::new(specimen)?.estimate(&frequency_hz, &psi.ratio, &psi.variance)?;
    let resonances =
        Resonances::new(rod, LENGTH)?.estimate(&frequency_hz, &psi.ratio, &psi.variance)?;
    let psi = gauges[0].over(&gauges[2])?;
    let free_end = FreeEnd::new(rod, gauge(0), gauge(2))?.estimate(
        &frequency_hz,
        &psi.ratio,
        &psi.variance,
    )?;
    let psi = waves[1].over(&waves[0])?;
    let pulses = SeparatePulses::new(PulsedRod {
        distance: GAUGES[0] - GAUGES[2],
        diameter: DIAMETER,
        density: DENSITY,
    })?
    .estimate(&frequency_hz, &psi.ratio, &psi.variance)?;
    let psi = waves[2].over(&waves[1])?;
    let one_gauge =
        OneGauge::new(rod, gauge(2))?.estimate(&frequency_hz, &psi.ratio, &psi.variance)?;

    let methods = [&two_point, &free_end, &pulses, &one_gauge, &resonances];
    for estimate in methods {
        let (valid, all) = (estimate.valid().count(), estimate.lines().len());
        println!("{}: {valid} of {all} lines valid", estimate.method());
    }
    let mut gamma = vec![Complex64::new(f64::NAN, 0.0); frequency_hz.len()];
    for line in free_end.lines() {
        gamma[line.index] = line.propagation_coefficient;
    }
    let null = FreeEndNull::new(rod, GAUGES.to_vec(), Quantity::Strain)?.check(
        &GaugeSpectra {
            frequency_hz: &frequency_hz,
            tests: &[&gauges.clone().map(|gauge| gauge.values)],
            noise: &gauges.map(|gauge| gauge.noise),
        },
        &gamma,
        USUAL_LEVEL,
    )?;
    println!("{null}");
    println!("{}", passivity(&two_point, USUAL_LEVEL)?);
    println!("{}", kramers_kronig(&two_point, USUAL_LEVEL)?);

    let storage = |line: &ModulusLine| {
        (
            1e-9 * line.modulus.re,
            1e-9 * line.standard_error.storage_modulus,
        )
    };
    let loss = |line: &ModulusLine| (line.loss_factor, line.standard_error.loss_factor);
    let panel = |axis, exact: fn(Complex64) -> f64, value: fn(&ModulusLine) -> (f64, f64)| {
        let exact = |f: &f64| (1e-3 * f, exact(polypropylene.modulus(TAU * f)));
        let exact = frequency_hz.iter().map(exact);
        let mut marks = vec![Mark::line("material", Role::Reference, exact)];
        for (index, estimate) in methods.into_iter().enumerate() {
            marks.push(points(estimate, Role::of_series(index), value));
        }
        Panel::new(("frequency", "kHz"), axis, marks)
    };
    let panels = vec![
        panel(("E'", "GPa"), |modulus| 1e-9 * modulus.re, storage),
        panel(("loss factor", ""), |modulus| modulus.im / modulus.re, loss),
    ];
    let title = "Rod of Test 3 of paper A by five methods, 0.2 % noise, valid lines";
    let path = Figure::new("neighbouring_methods", title, panels).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    println!("figure in {}", path.display());
    Ok(())
}

/// Measured spectrum and its noise.
#[derive(Clone, Default)]
struct Spectrum {
    values: Vec<Complex64>,
    noise: Vec<f64>,
}

impl Spectrum {
    /// Adds a line with a random error, which has no preferred phase.
    fn add(&mut self, value: Complex64, random: &mut Noise) {
        let noise = NOISE * value.norm();
        self.values.push(value + random.circular(noise * noise));
        self.noise.push(noise);
    }

    fn over(&self, other: &Self) -> Result<RatioOfSpectra, cmod::CmodError> {
        RatioOfSpectra::new(&[&self.values], &[&other.values], &self.noise, &other.noise)
    }
}

/// Returns the valid lines of a method, with an error bar of one standard error on every fourth
/// line.
fn points(estimate: &ModulusEstimate, role: Role, value: fn(&ModulusLine) -> (f64, f64)) -> Mark {
    let stride = if estimate.lines().len() > 50 { 4 } else { 1 };
    let points = estimate.valid().step_by(stride).map(|line| {
        let (value, error) = value(line);
        (1e-3 * line.frequency_hz, value, error)
    });
    Mark::points_with_errors(estimate.method().to_string(), role, points)
}
