//! Virtual experiment of paper B: a polypropylene bar between two cantilever beams is struck, and
//! its modulus is determined from the strains at three equidistant sections and, for comparison, at
//! five sections.
//!
//! ```text
//! cargo run --release --package cmod --example frame_three_point
//! ```
//!
//! The program writes `target/examples/frame_three_point.svg`.
#![allow(
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "an example prints its results, and may panic on a wrong index"
)]

use std::error::Error;
use std::f64::consts::TAU;

use cmod::validity::AcceptanceLimits;
use cmod::{GaugeSpectra, GaugedRod, ModulusLine, MultiPoint, ThreePoint};
use num_complex::Complex64;
use rodfigure::{Figure, Mark, Panel, Role};
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::HalfSine;
use rodwave::experiment::strains_in_a_frame::{EndSupport, Excitation, FrameMember};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use testbed::noise::Noise;

const DENSITY: f64 = 919.0;
const DIAMETER: f64 = 0.016;
const LENGTH: f64 = 0.800;
/// Number of hits on the bar.
const TESTS: usize = 10;
/// Error of one strain, relative to the root mean square of all strains on its line.
const NOISE: f64 = 0.01;
/// Positions of the gauges. The gauges of paper B are equidistant at a distance that is our choice.
/// The five gauges have no singular lines.
const POSITIONS: [f64; 5] = [0.25, 0.29, 0.40, 0.48, 0.55];
const EQUIDISTANT: [usize; 3] = [0, 2, 4];

fn main() -> Result<(), Box<dyn Error>> {
    let polypropylene = Medium::new(DENSITY, ConstantQ::new(2.6e9, 0.07, 1e4)?)?;
    let frequency_hz: Vec<f64> = (4..=64_u32).map(|j| 125.0 * f64::from(j)).collect();
    let omegas: Vec<f64> = frequency_hz.iter().map(|f| TAU * f).collect();
    let beam = EndSupport::PAPER_B_BEAM;
    let section = Circle::of_diameter(DIAMETER)?;
    let bar = FrameMember::new(
        &polypropylene,
        section,
        LENGTH,
        &POSITIONS,
        beam.termination(),
    )?
    .with_left_structure(beam.termination())?;
    let blow = HalfSine::new(50.0, 1e-4)?;
    let strains = bar.strain_spectra(&Excitation::Force(&blow), &omegas)?;
    let noise: Vec<f64> = (0..omegas.len())
        .map(|line| {
            let power: f64 = strains.iter().map(|strain| strain[line].norm_sqr()).sum();
            NOISE * (power / POSITIONS.len() as f64).sqrt()
        })
        .collect();
    let variance: Vec<f64> = noise.iter().map(|noise| noise * noise).collect();
    let mut random = Noise::seeded(1993);
    let mut measured = |strain: &Vec<Complex64>| random.on(strain, &variance);
    let tests: Vec<Vec<Vec<Complex64>>> = (0..TESTS)
        .map(|_| strains.iter().map(&mut measured).collect())
        .collect();

    let five: Vec<&[Vec<Complex64>]> = tests.iter().map(Vec::as_slice).collect();
    // no line is rejected for a large error, because the figure shows the errors
    let any_error = AcceptanceLimits::NONE;
    let five_gauges = MultiPoint::new(rod(POSITIONS.to_vec()))?
        .with_limits(any_error)?
        .estimate(&GaugeSpectra {
            frequency_hz: &frequency_hz,
            tests: &five,
            noise: &vec![noise.clone(); 5],
        })?;
    let picked: Vec<Vec<Vec<Complex64>>> = tests
        .iter()
        .map(|test| EQUIDISTANT.map(|gauge| test[gauge].clone()).to_vec())
        .collect();
    let three: Vec<&[Vec<Complex64>]> = picked.iter().map(Vec::as_slice).collect();
    let three_gauges = ThreePoint::new(rod(EQUIDISTANT.map(|gauge| POSITIONS[gauge]).to_vec()))?
        .with_limits(any_error)?
        .estimate(&GaugeSpectra {
            frequency_hz: &frequency_hz,
            tests: &three,
            noise: &vec![noise.clone(); 3],
        })?;

    let storage = |line: &ModulusLine| {
        (
            1e-9 * line.modulus.re,
            1e-9 * line.standard_error.storage_modulus,
        )
    };
    let loss = |line: &ModulusLine| (line.loss_factor, line.standard_error.loss_factor);
    let three_lines: Vec<&ModulusLine> = three_gauges.valid().collect();
    let five_lines: Vec<&ModulusLine> = five_gauges.modulus().valid().collect();
    let panel = |axis, exact: fn(Complex64) -> f64, value: fn(&ModulusLine) -> (f64, f64)| {
        let exact = |f: &f64| (1e-3 * f, exact(polypropylene.modulus(TAU * f)));
        let exact = frequency_hz.iter().map(exact);
        let marks = vec![
            Mark::line("material", Role::Reference, exact),
            points("three, closed form", Role::Second, &three_lines, value),
            points("five, least squares", Role::First, &five_lines, value),
        ];
        Panel::new(("frequency", "kHz"), axis, marks)
    };
    let panels = vec![
        panel(("E'", "GPa"), |modulus| 1e-9 * modulus.re, storage),
        panel(("loss factor", ""), |modulus| modulus.im / modulus.re, loss),
    ];
    let title = "Bar of paper B in structure I, ten tests, 1 % noise";
    let path = Figure::new("frame_three_point", title, panels).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    println!(
        "{} lines, {} valid with three gauges and {} with five; figure in {}",
        frequency_hz.len(),
        three_lines.len(),
        five_lines.len(),
        path.display()
    );
    for line in three_gauges.lines() {
        if !line.validity.is_valid() {
            println!("{} Hz, three gauges: {}", line.frequency_hz, line.validity);
        }
    }
    Ok(())
}

fn rod(positions: Vec<f64>) -> GaugedRod {
    GaugedRod {
        positions,
        diameter: DIAMETER,
        density: DENSITY,
    }
}

/// Returns points with error bars of one standard error.
fn points(
    name: &str,
    role: Role,
    lines: &[&ModulusLine],
    value: fn(&ModulusLine) -> (f64, f64),
) -> Mark {
    let points = lines.iter().map(|line| {
        let (value, error) = value(line);
        (1e-3 * line.frequency_hz, value, error)
    });
    Mark::points_with_errors(name, role, points)
}
