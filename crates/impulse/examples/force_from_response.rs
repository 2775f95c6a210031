//! The force of a blow from the accelerations of both faces of the rod that was struck: by dividing
//! spectra, and by least squares on the time when the force acts, with both sensors, without
//! tension, with a band that holds the whole history.
//!
//! ```text
//! cargo run --release --package impulse --example force_from_response
//! ```
//!
//! writes `target/examples/force_from_response.svg`.
#![allow(
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "an example talks to the one who runs it, who sees an index that fails at once"
)]

#[path = "../tests/virtual_body/mod.rs"]
mod virtual_body;

mod figure;

use std::error::Error;

use impulse::{
    Parameter, Penalty, Reconstruction, Regularisation, ResponseNoise, Sensor, TimeInterval,
};
use kuva::plot::LinePlot;
use kuva::render::figure::Figure;
use kuva::render::plots::Plot;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use virtual_body::{Pulse, VirtualBody, noisy, noisy_lines};

/// Noise of the accelerometers at the struck and at the far face [m/s^2].
const NOISE: [f64; 2] = [80.0, 160.0];
/// Standard deviation of a line of a frequency response, in parts of it.
const RESPONSE_ERROR: f64 = 0.03;

fn main() -> Result<(), Box<dyn Error>> {
    let body = VirtualBody {
        length: 0.4,
        n_samples: 2048,
        sampling_rate_hz: 50e3,
    };
    let pulse = Pulse {
        peak: 800.0,
        begin: 0.4e-3,
        duration: 0.8e-3,
    };
    let faces = body.struck_by(pulse)?;
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let variances = faces.frequency_responses.clone().map(|lines| -> Vec<f64> {
        lines
            .iter()
            .map(|h| (RESPONSE_ERROR * h.norm()).powi(2))
            .collect()
    });
    let responses = [0, 1].map(|face| noisy(&faces.responses[face], NOISE[face], &mut random));
    let lines = [0, 1].map(|face| {
        noisy_lines(
            &faces.frequency_responses[face],
            &variances[face],
            &mut random,
        )
    });
    let sensors = (0..2)
        .map(|face| {
            Sensor::new(&responses[face], &lines[face])?
                .with_noise(ResponseNoise::White(NOISE[face]))?
                .with_variance(&variances[face])
        })
        .collect::<Result<Vec<_>, _>>()?;

    let divided = Reconstruction::new(&responses[0], body.sampling_rate_hz, &lines[0])?.solve()?;
    let found = Reconstruction::of_sensors(sensors, body.sampling_rate_hz)?
        .acting_during(TimeInterval {
            from: 0.2e-3,
            to: 1.4e-3,
        })
        .with_regularisation(Regularisation::Tikhonov {
            penalty: Penalty::Curvature,
            parameter: Parameter::GeneralisedCrossValidation,
        })
        .non_negative()
        .solve()?;
    let error = found.error.known().ok_or("the noise was stated")?;
    let window = 10..70;
    let band = error
        .simultaneous(&found.history, 0.95, window.clone(), 2000, &mut random)?
        .compressive();

    let points = |values: &[f64]| -> Vec<(f64, f64)> {
        let shown = values.iter().enumerate().take(90);
        shown
            .map(|(n, f)| (1e3 * n as f64 / body.sampling_rate_hz, *f))
            .collect()
    };
    let line =
        |values: &[f64], colour: &str| LinePlot::new().with_data(points(values)).with_color(colour);
    let truth: Vec<f64> = (0..body.n_samples)
        .map(|n| pulse.at(n as f64 / body.sampling_rate_hz))
        .collect();
    let plots = vec![
        Plot::Line(line(divided.history.force(), "#d6b49a").with_legend("division, struck face")),
        Plot::Line(line(&band.lower, "#93b4f5").with_legend("95 % of whole histories")),
        Plot::Line(line(&band.upper, "#93b4f5")),
        Plot::Line(line(found.history.force(), "#1d4ed8").with_legend("both faces, least squares")),
        Plot::Line(line(&truth, "#111111").with_legend("true force")),
    ];
    let layout = figure::layout(
        &plots,
        "Force on a nylon rod from its accelerations",
        ["time, ms", "force, N"],
    );
    let figure = Figure::new(1, 1)
        .with_plots(vec![plots])
        .with_layouts(vec![layout])
        .with_cell_size(760.0, 420.0);
    let path = figure::written(figure, "force_from_response.svg")?;

    let parameter = found
        .parameter
        .as_ref()
        .ok_or("a regularisation was asked for")?;
    println!(
        "peak {:.1} N (true: {} N), {:.1} N by division; parameter {:.3e}, {:?}",
        found.history.peak().force,
        pulse.peak,
        divided.history.peak().force,
        parameter.value,
        parameter.verdict
    );
    println!(
        "chi-square per degree of freedom {:.3}; the regularisation takes off up to {:.1} N, which the band does not know of; \
         {:.0} % of the true force in the band of {} standard errors; {}",
        found.reduced_chi_square.ok_or("the noise was stated")?,
        found
            .regularisation_bias
            .iter()
            .fold(0.0_f64, |largest, bias| largest.max(-bias)),
        100.0 * band.part_inside(&truth, window),
        (10.0 * band.factor).round() / 10.0,
        path.display()
    );
    Ok(())
}
