//! The force of a blow from the accelerations of both faces of the struck rod, found by dividing
//! spectra and by least squares. The least squares use both sensors, restrict the force to the time
//! when it acts, exclude tension, and give a band that contains the whole history.
//!
//! ```text
//! cargo run --release --package impulse --example force_from_response
//! ```
//!
//! writes `target/examples/force_from_response.svg`.
#![allow(
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "an example prints its results, and may panic on a wrong index"
)]

#[path = "../tests/virtual_body/mod.rs"]
mod virtual_body;

use std::error::Error;

use impulse::{
    Parameter, Penalty, Reconstruction, Regularisation, ResponseNoise, Sensor, TimeInterval,
};
use rodfigure::{Figure, Mark, Panel, Role};
use testbed::noise::Noise;
use virtual_body::{Pulse, VirtualBody, noisy_lines};

/// Noise of the accelerometers at the struck and at the far face [m/s^2].
const NOISE: [f64; 2] = [80.0, 160.0];
/// Relative standard deviation of a line of a frequency response.
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
    let mut noise = Noise::seeded(7);
    let variances = faces.frequency_responses.clone().map(|lines| -> Vec<f64> {
        lines
            .iter()
            .map(|h| (RESPONSE_ERROR * h.norm()).powi(2))
            .collect()
    });
    let responses = [0, 1].map(|face| noise.added_to(&faces.responses[face], NOISE[face]));
    let lines = [0, 1].map(|face| {
        noisy_lines(
            &faces.frequency_responses[face],
            &variances[face],
            &mut noise,
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
        .simultaneous(&found.history, 0.95, window.clone(), 2000, &mut noise.0)?
        .compressive();

    let truth: Vec<f64> = (0..body.n_samples)
        .map(|n| pulse.at(n as f64 / body.sampling_rate_hz))
        .collect();
    let times = || (0..90_u32).map(|n| 1e3 * f64::from(n) / body.sampling_rate_hz);
    let line = |name: &str, role, values: &[f64]| {
        Mark::line(name, role, times().zip(values.iter().copied()))
    };
    let edges = times().zip(&band.lower).zip(&band.upper);
    let edges = edges.map(|((time, lower), upper)| (time, *lower, *upper));
    let marks = vec![
        line(
            "division, struck face",
            Role::Faint,
            divided.history.force(),
        ),
        Mark::band("95 % of whole histories", Role::First, edges),
        line(
            "both faces, least squares",
            Role::First,
            found.history.force(),
        ),
        line("true force", Role::Reference, &truth),
    ];
    let panel = Panel::new(("time", "ms"), ("force", "N"), marks);
    let title = "Force on a nylon rod from its accelerations";
    let path = Figure::new("force_from_response", title, vec![panel]).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;

    let parameter = found
        .parameter
        .as_ref()
        .ok_or("the force has no regularisation parameter")?;
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
