//! Merges the accelerances from two hammers into one: each line from the hammer with the larger
//! force (Ödeen 1993, paper E), or both hammers weighted by inverse variances.
//!
//! ```text
//! cargo run --release --package labio --example merge_two_hammers [table.csv]
//! ```
//!
//! The program writes the merged lines with the share of each hammer, by default to
//! `target/examples/merge_two_hammers.csv`.
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
    AveragedSpectra, Estimator, FrequencyResponse, MergedResponse, RigidBand, RigidBody, Window,
};

fn main() -> Result<(), Box<dyn Error>> {
    // a heavy hammer with a soft tip for low frequencies, a small one with a hard tip for high
    // frequencies; the noise of a channel is proportional to the range of its amplifier, which is
    // adjusted to the peak
    let heavy = Hammer {
        peak_force: 200.0,
        contact: 1.2e-3,
        force_noise: 0.02,
        acceleration_noise: 2.0,
    };
    let light = Hammer {
        peak_force: 80.0,
        contact: 2e-4,
        force_noise: 0.02,
        acceleration_noise: 1.0,
    };
    let heavy = AveragedSpectra::of(&heavy.strike(10, 1)?, Window::Rectangular)?;
    let light = AveragedSpectra::of(&light.strike(10, 2)?, Window::Rectangular)?;
    let tests = [&heavy, &light];
    let responses = [heavy.h1("hammer", "face")?, light.h1("hammer", "face")?];
    let chosen = MergedResponse::by_larger_input(&tests, Estimator::H1, "hammer", "face")?;
    let weighed = MergedResponse::by_inverse_variance(&responses)?;

    println!("root mean square of the relative error, %");
    println!(
        "       band, Hz      heavy      light   larger force   inverse variance   discrepancy"
    );
    for (from_hz, to_hz) in [
        (20.0, 100.0),
        (100.0, 300.0),
        (300.0, 800.0),
        (800.0, 1600.0),
        (1600.0, 3000.0),
        (3000.0, 5000.0),
    ] {
        let band = Band { from_hz, to_hz };
        println!(
            "{from_hz:7} to {to_hz:5} {:10.3} {:10.3} {:14.3} {:18.3} {:13.2}",
            band.error(&responses[0]),
            band.error(&responses[1]),
            band.error(&chosen.response),
            band.error(&weighed.response),
            band.mean(&weighed.response, |line| weighed.discrepancy[line])
        );
    }

    let band = RigidBand {
        from_hz: 40.0,
        to_hz: 200.0,
    };
    let body = RigidBody::new(MASS, 0.001)?;
    let completed = body.complete(&weighed.response, band)?;
    println!(
        "weighed mass {MASS} kg; mass from the lines of 40 to 200 Hz {:.4} kg, standard error {:.4} kg",
        completed.apparent_mass, completed.apparent_mass_standard_error
    );

    let table = free_body::table_path("merge_two_hammers.csv")?;
    fs::write(&table, csv(&chosen, &weighed)?)?;
    println!("{}", table.display());
    Ok(())
}

struct Band {
    from_hz: f64,
    to_hz: f64,
}

impl Band {
    fn mean(&self, response: &FrequencyResponse, of_line: impl Fn(usize) -> f64) -> f64 {
        let lines = response.frequency_hz.iter().enumerate();
        let values: Vec<f64> = lines
            .filter(|(_, f)| (self.from_hz..self.to_hz).contains(*f))
            .map(|(line, _)| of_line(line))
            .collect();
        values.iter().sum::<f64>() / values.len() as f64
    }

    /// Error of a response, in percent of the exact accelerance.
    fn error(&self, response: &FrequencyResponse) -> f64 {
        let square = |line: usize| {
            let exact = free_body::accelerance(response.frequency_hz[line]);
            (response.values[line] / exact - 1.0).norm_sqr()
        };
        100.0 * self.mean(response, square).sqrt()
    }
}

fn csv(chosen: &MergedResponse, weighed: &MergedResponse) -> Result<String, Box<dyn Error>> {
    let variance = weighed.response.variance.as_ref().ok_or("one hit only")?;
    let mut text = "frequency [Hz],larger force: heavy (1) or light (0),real [1/kg],imaginary [1/kg],\
                    inverse variance: share of heavy,real [1/kg],imaginary [1/kg],standard error [1/kg]\n"
        .to_owned();
    for (line, f) in chosen.response.frequency_hz.iter().enumerate() {
        let (a, b) = (chosen.response.values[line], weighed.response.values[line]);
        let shares = (chosen.shares[(0, line)], weighed.shares[(0, line)]);
        let error = variance[line].sqrt();
        writeln!(
            text,
            "{f},{},{},{},{},{},{},{error}",
            shares.0, a.re, a.im, shares.1, b.re, b.im
        )?;
    }
    Ok(text)
}
