//! Virtual temperature sweep in the range of Test 6 of paper A, 20 to 140 °C. Moduli from 400 Hz to
//! 10 kHz with 1 % noise are shifted to one curve, shift laws are fitted, laws are compared at one
//! temperature, and the series is written as cards.
//!
//! ```text
//! cargo run --release --package cmod --example prony_master_curve
//! ```
//!
//! The program writes `target/examples/prony_master_curve.svg`. The paper prints no numbers; the
//! material, a fractional Zener model with shifts by the law of Williams, Landel and Ferry, is our
//! choice.
#![allow(
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "an example prints its results, and may panic on a wrong index"
)]

use std::error::Error;
use std::f64::consts::{LN_10, TAU};

use cmod::rheology::card::{BulkBehaviour, MaterialCard, Moduli};
use cmod::rheology::{
    Comparison, FitOptions, Law, MasterCurve, ModulusData, ModulusPoint, TemperatureSweep,
};
use num_complex::Complex64;
use rodfigure::{Axis, Figure, Mark, Panel, Role};
use rodwave::modulus::{ComplexModulus, FractionalZener};
use testbed::noise::Noise;

/// Number of temperatures, from 20 to 140 °C.
const TEMPERATURES: u32 = 13;
/// Index of the reference temperature, 80 °C.
const REFERENCE: usize = 6;
const C1: f64 = 9.0;
const C2: f64 = 190.0;
const NOISE: f64 = 0.01;

fn main() -> Result<(), Box<dyn Error>> {
    let material = FractionalZener::new(0.15e9, 3.6e9, 1.2e-5, 0.32)?;
    let temperature = |step: u32| 293.15 + 10.0 * f64::from(step);
    let log_shift = |kelvin: f64| {
        let d = kelvin - 353.15;
        -LN_10 * C1 * d / (C2 + d)
    };
    let mut random = Noise::seeded(1993);
    let mut steps = Vec::new();
    for step in 0..TEMPERATURES {
        let kelvin = temperature(step);
        let a = log_shift(kelvin).exp();
        let points: Vec<ModulusPoint> = (0..16)
            .map(|line| {
                let frequency_hz = 400.0 * 25.0_f64.powf(f64::from(line) / 15.0);
                let modulus = material.at(TAU * frequency_hz * a);
                let sigma = NOISE * modulus.norm();
                let noise = random.circular(2.0 * sigma * sigma);
                ModulusPoint::circular(frequency_hz, modulus + noise, sigma)
            })
            .collect();
        steps.push((kelvin, ModulusData::new(&points)?));
    }
    let laws = [
        Law::KelvinVoigt,
        Law::Zener,
        Law::FractionalZener,
        Law::GeneralisedMaxwell,
        Law::PowerLaw { density: 912.0 },
    ];
    let options = FitOptions::default();
    println!(
        "at 80 C alone:\n{}\n",
        Comparison::new(&steps[REFERENCE].1, &laws, &options)?
    );

    let curve = MasterCurve::new(&TemperatureSweep::new(steps)?, REFERENCE, &options)?;
    let shift_laws = curve.shift_laws()?;
    println!("{curve}\n{shift_laws}\n");
    let series = curve.series().ok_or("a master curve is a Prony series")?;
    let card = MaterialCard::new("PP-80C", 912.0, 0.38, series)?;
    println!("{}", card.abaqus(Moduli::LongTerm, BulkBehaviour::Elastic)?);
    println!("{}", card.ls_dyna(1)?);

    let panel = |axis, part: fn(Complex64) -> f64| {
        let points = curve.points.iter();
        let points = points.map(|point| (point.reduced_frequency_hz, part(point.modulus)));
        let line = |name, role, modulus: &dyn Fn(f64) -> Complex64| {
            let frequencies = (-20..=90_i32).map(|tenth| 10.0_f64.powf(0.1 * f64::from(tenth)));
            let moduli = frequencies.map(|f| (f, part(modulus(TAU * f))));
            Mark::line(name, role, moduli)
        };
        let marks = vec![
            Mark::points("shifted lines", Role::Second, points),
            line("material", Role::Reference, &|omega| material.at(omega)),
            line("Prony series", Role::First, &|omega| series.at(omega)),
        ];
        Panel::new(Axis::logarithmic("reduced frequency", "Hz"), axis, marks)
    };
    let shifts = curve.shifts.iter().map(|shift| {
        let (log, error) = (shift.log_shift / LN_10, shift.standard_error / LN_10);
        (shift.temperature - 273.15, log, error)
    });
    let law = |value: &dyn Fn(f64) -> Option<f64>| -> Vec<(f64, f64)> {
        (20..=140_u32)
            .filter_map(|celsius| {
                let celsius = f64::from(celsius);
                value(celsius + 273.15).map(|log| (celsius, log / LN_10))
            })
            .collect()
    };
    let wlf = law(&|t| shift_laws.wlf.log_shift(t).map(|(log, _)| log));
    let arrhenius = law(&|t| shift_laws.arrhenius.log_shift(t).map(|(log, _)| log));
    let shifts = vec![
        Mark::points_with_errors("shifts", Role::Second, shifts),
        Mark::line("WLF", Role::First, wlf),
        Mark::line("Arrhenius", Role::Reference, arrhenius),
    ];
    let panels = vec![
        panel(("E'", "GPa"), |modulus| 1e-9 * modulus.re),
        panel(("loss factor", ""), |modulus| modulus.im / modulus.re),
        Panel::new(("temperature", "°C"), ("log10 a", ""), shifts),
    ];
    let title = "Sweep from 20 to 140 °C, reference 80 °C";
    let path = Figure::new("prony_master_curve", title, panels).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    println!("figure in {}", path.display());
    Ok(())
}
