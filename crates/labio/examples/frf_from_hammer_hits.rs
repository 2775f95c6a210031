//! Computes an accelerance with its errors from hammer hits on a virtual body whose accelerance is
//! known.
//!
//! ```text
//! cargo run --release --package labio --example frf_from_hammer_hits [table.csv]
//! ```
//!
//! The program writes the lines to a table, by default `target/examples/frf_from_hammer_hits.csv`,
//! and a figure next to it.
#![allow(
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "an example prints its results, and may panic on a wrong index"
)]

mod free_body;

use std::error::Error;
use std::fmt::Write as _;
use std::fs;

use free_body::{Hammer, MASS};
use labio::{
    Estimator, ForceWindow, FrequencyResponse, ResponseKind, RigidBand, RigidBody,
    SpectrumAverager, Window,
};
use rodfigure::{Axis, Figure, Mark, Panel, Role, svg_of};

fn main() -> Result<(), Box<dyn Error>> {
    let hammer = Hammer {
        peak_force: 80.0,
        contact: 3e-4,
        force_noise: 0.05,
        acceleration_noise: 0.5,
    };
    let hits = hammer.strike(5, 1)?;

    // the hammer touches the body from sample 100 on for 0.3 ms; the rest of its channel is noise
    let contact = ForceWindow::new(1.8e-3, 2.5e-3, 2e-4)?;
    let mut averager = SpectrumAverager::for_records_like(&hits[0], Window::Rectangular)?
        .with_force_window("hammer", contact)?;
    for hit in &hits {
        averager.add(hit)?;
    }
    let spectra = averager.spectra()?;
    let accelerance = spectra.response(Estimator::H1, "hammer", "face")?;

    let coherence = accelerance.coherence.as_ref().ok_or("one hit only")?;
    let errors = accelerance.random_error().ok_or("one hit only")?;
    println!("     f, Hz   |A|, 1/kg      exact   random error   coherence");
    for wanted_hz in [50.0, 200.0, 500.0, 900.0, 1500.0, 2640.0, 4000.0, 6000.0] {
        let line = accelerance.frequency_hz.partition_point(|f| *f < wanted_hz);
        let f = accelerance.frequency_hz[line];
        println!(
            "{f:10.1} {:11.4} {:10.4} {:11.2} % {:13.5}",
            accelerance.values[line].norm(),
            free_body::accelerance(f).norm(),
            100.0 * errors[line].magnitude,
            coherence[line]
        );
    }
    println!(
        "squared error divided by its estimated variance, mean from 20 to 5000 Hz: {:.2}; n/(n - 2) is expected for n = 5 hits",
        reduced_error(&accelerance).ok_or("one hit only")?
    );

    let completed = RigidBody::new(MASS, 0.001)?.complete(
        &accelerance,
        RigidBand {
            from_hz: 40.0,
            to_hz: 200.0,
        },
    )?;
    println!(
        "weighed mass {MASS} kg; mass from the lines of 40 to 200 Hz {:.3} kg, standard error {:.3} kg",
        completed.apparent_mass, completed.apparent_mass_standard_error
    );
    let mobility = completed.response.to_kind(ResponseKind::Mobility)?;
    let passivity = mobility.passivity(1e-3)?;
    let excited = passivity.frequency_hz.partition_point(|f| *f < 5000.0);
    println!(
        "{} of the {excited} lines below 5 kHz are active at a level of 0.1 %",
        passivity
            .active_lines()
            .filter(|line| *line < excited)
            .count(),
    );

    let table = free_body::table_path("frf_from_hammer_hits.csv")?;
    fs::write(&table, csv(&accelerance)?)?;
    let figure = table.with_extension("svg");
    fs::write(&figure, svg(&accelerance))?;
    println!("{} and {}", table.display(), figure.display());
    Ok(())
}

/// Mean of |measured - exact|^2/variance.
fn reduced_error(accelerance: &FrequencyResponse) -> Option<f64> {
    let variances = accelerance.variance.as_ref()?;
    let lines = accelerance.frequency_hz.iter().zip(&accelerance.values);
    let ratios: Vec<f64> = lines
        .zip(variances)
        .filter(|((f, _), _)| (20.0..5000.0).contains(*f))
        .map(|((f, value), variance)| (value - free_body::accelerance(*f)).norm_sqr() / variance)
        .collect();
    Some(ratios.iter().sum::<f64>() / ratios.len() as f64)
}

fn csv(accelerance: &FrequencyResponse) -> Result<String, Box<dyn Error>> {
    let coherence = accelerance.coherence.as_ref().ok_or("one hit only")?;
    let variance = accelerance.variance.as_ref().ok_or("one hit only")?;
    let mut text =
        "frequency [Hz],real [1/kg],imaginary [1/kg],standard error [1/kg],coherence\n".to_owned();
    for (line, f) in accelerance.frequency_hz.iter().enumerate() {
        let value = accelerance.values[line];
        let error = variance[line].sqrt();
        writeln!(
            text,
            "{f},{},{},{error},{}",
            value.re, value.im, coherence[line]
        )?;
    }
    Ok(text)
}

fn svg(accelerance: &FrequencyResponse) -> String {
    let shown = || {
        let lines = accelerance.frequency_hz.iter().zip(&accelerance.values);
        lines.filter(|(f, _)| (20.0..6000.0).contains(*f))
    };
    let measured = shown().map(|(f, value)| (1e-3 * f, value.norm()));
    let exact = shown().map(|(f, _)| (1e-3 * f, free_body::accelerance(*f).norm()));
    let marks = vec![
        Mark::line("H1 of five hits", Role::Second, measured),
        Mark::line("exact", Role::First, exact),
    ];
    let magnitude = Axis::logarithmic("accelerance", "1/kg");
    let panel = Panel::new(("frequency", "kHz"), magnitude, marks);
    let title = "Accelerance of a free body with two modes";
    svg_of(&Figure::new("frf_from_hammer_hits", title, vec![panel]))
}
