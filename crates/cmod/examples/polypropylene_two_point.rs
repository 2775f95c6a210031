//! Virtual test 6 of paper A: a polypropylene rod is struck ten times, the accelerations of its
//! ends are recorded with noise and twelve bits, and its modulus is determined with error bands.
//!
//! ```text
//! cargo run --release --package cmod --example polypropylene_two_point
//! ```
//!
//! The program writes `target/examples/polypropylene_two_point.svg`.
#![allow(
    clippy::print_stdout,
    clippy::indexing_slicing,
    reason = "an example prints its results, and may panic on a wrong index"
)]

use std::error::Error;
use std::f64::consts::TAU;

use cmod::estimate::{Curve, PlottedQuantity};
use cmod::two_point::{AveragedRatio, SpecimenUncertainty};
use cmod::{ModulusEstimate, Specimen, TwoPoint};
use labio::instrument::{AntiAlias, Converter, Instrument, NoiseSpectrum};
use labio::{Channel, FrequencyResponse, Provenance, Quantity, Record, SpectrumAverager, Window};
use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rodfigure::{Axis, Figure, Mark, Panel, Role};
use rodwave::element::Circle;
use rodwave::experiment::end_accelerations::{self, EndAccelerationTest, RaisedCosine};
use rodwave::medium::Medium;
use rodwave::modulus::ConstantQ;
use rodwave::synthesis::DampedSynthesis;

/// Specimen according to paper A, Table 2 and section 3.
const SPECIMEN: Specimen = Specimen {
    length: 0.799,
    diameter: 0.0158,
    density: 912.0,
    accelerometer_mass: 2.9e-3,
};
/// Standard uncertainties of values that are printed with few digits: uniform distributions over
/// half a unit of the last digit to either side.
const UNCERTAINTY: SpecimenUncertainty = SpecimenUncertainty {
    length: 0.29e-3,
    diameter: 0.029e-3,
    density: 0.29,
    accelerometer_mass: 0.029e-3,
};
const BLOWS: usize = 10;
const RATE_HZ: f64 = 65_536.0;
const SAMPLES: usize = 4096;
const OVERSAMPLING: usize = 8;
const HIGHEST_HZ: f64 = 20e3;

fn main() -> Result<(), Box<dyn Error>> {
    let polypropylene = Medium::new(SPECIMEN.density, ConstantQ::new(2.6e9, 0.07, 1e4)?)?;
    let response = recorded(&polypropylene)?;
    let lines = response.frequency_hz.partition_point(|f| *f <= HIGHEST_HZ);
    let coherence = response
        .coherence
        .as_ref()
        .ok_or("no coherence of ten hits")?;
    let estimate = TwoPoint::new(SPECIMEN)?
        .with_specimen_uncertainty(UNCERTAINTY)?
        .estimate_averaged(&AveragedRatio {
            frequency_hz: &response.frequency_hz[..lines],
            acceleration_ratio: &response.values[..lines],
            coherence: &coherence[..lines],
            averages: response.effective_averages,
        })?;

    let exact = |f: f64| polypropylene.modulus(TAU * f);
    let panels = vec![
        panel(
            Axis::linear("E'", "GPa").within([2.3, 3.0]),
            &estimate.curve(PlottedQuantity::StorageModulus, 2.0),
            1e-9,
            &|f| exact(f).re,
        ),
        panel(
            Axis::linear("loss factor", "").within([0.06, 0.08]),
            &estimate.curve(PlottedQuantity::LossFactor, 2.0),
            1.0,
            &|f| exact(f).im / exact(f).re,
        ),
    ];
    let title = "Test 6 of paper A, ten hits, 12 bits; bands of two standard errors";
    let path = Figure::new("polypropylene_two_point", title, panels).write_to(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/examples"
    ))?;
    report(&estimate);
    println!("figure in {}", path.display());
    Ok(())
}

/// Returns the averaged frequency response of ten hits of 100 N and 80 µs on the rod, recorded with
/// filter, noise and converter.
fn recorded(polypropylene: &Medium<ConstantQ>) -> Result<FrequencyResponse, Box<dyn Error>> {
    let rig = end_accelerations::Specimen {
        section: Circle::of_diameter(SPECIMEN.diameter)?.into(),
        length: SPECIMEN.length,
        accelerometer_mass: SPECIMEN.accelerometer_mass,
    };
    let interval = 1.0 / (RATE_HZ * OVERSAMPLING as f64);
    let count = SAMPLES * OVERSAMPLING;
    let synthesis =
        DampedSynthesis::new(count as f64 * interval, interval)?.smoothed(2.5 * interval)?;
    let exact = EndAccelerationTest::analytic(polypropylene, &rig)?
        .record(&RaisedCosine::new(100.0, 8e-5)?, &synthesis)?;

    let ends = [
        ("struck end", exact.impacted_end),
        ("free end", exact.free_end),
    ];
    // the record begins a millisecond before the hit
    let lead = count / 64;
    let samples = Array2::from_shape_fn((2, count), |(channel, sample)| {
        let history = &ends[channel].1;
        sample.checked_sub(lead).map_or(0.0, |after| history[after])
    });
    let channels = ends
        .iter()
        .map(|(name, _)| Channel::new(*name, Quantity::Acceleration))
        .collect::<Result<Vec<_>, _>>()?;
    let provenance = Provenance::computed(exact.generator);
    let history = Record::new(samples, 1.0 / interval, 0.0, channels, provenance)?;

    let mut instrument = Instrument::new();
    for (name, samples) in &ends {
        let peak = samples.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
        // noise of 2e-4 of the peak over the band of the history
        let density = (2e-4 * peak).powi(2) / (0.5 * RATE_HZ);
        instrument = instrument
            .noise(*name, NoiseSpectrum::white(density)?)
            .convert_channel(*name, Converter::new(12, 1.25 * peak)?);
    }
    let front_end = Instrument::new()
        .anti_alias(AntiAlias::butterworth(8, 22e3)?)
        .sample(RATE_HZ, 0.0)?;
    let mut random = ChaCha8Rng::seed_from_u64(1993);
    let filtered = front_end.record(&history, &mut random)?.record;
    let mut averager = SpectrumAverager::for_records_like(&filtered, Window::Rectangular)?;
    for _ in 0..BLOWS {
        averager.add(&instrument.record(&filtered, &mut random)?.record)?;
    }
    Ok(averager.spectra()?.h1("free end", "struck end")?)
}

/// Draws the exact material as a curve, the valid lines with their band, and the other lines in
/// grey; `scale` converts from SI units to the axis.
fn panel(axis: Axis, curve: &Curve, scale: f64, exact: &dyn Fn(f64) -> f64) -> Panel {
    let mut marks = Vec::new();
    for segment in &curve.segments {
        let over_frequency = |values: &[f64]| -> Vec<(f64, f64)> {
            let values = segment.frequency_hz.iter().zip(values);
            values.map(|(f, value)| (1e-3 * f, scale * value)).collect()
        };
        let (name, role) = if segment.valid {
            let upper = segment.upper.iter().map(|upper| scale * upper);
            let edges = over_frequency(&segment.lower).into_iter().zip(upper);
            let edges = edges.map(|((f, lower), upper)| (f, lower, upper));
            marks.push(Mark::band("", Role::First, edges));
            ("valid", Role::First)
        } else {
            ("not valid", Role::Faint)
        };
        marks.push(Mark::line(name, role, over_frequency(&segment.values)));
    }
    let material = (1..=100).map(|j| 0.01 * f64::from(j) * HIGHEST_HZ);
    let material = material.map(|f| (1e-3 * f, scale * exact(f)));
    marks.push(Mark::line("material", Role::Reference, material));
    Panel::new(("frequency", "kHz"), axis, marks)
}

/// Prints the number of valid lines, and the violations of some of the invalid lines.
fn report(estimate: &ModulusEstimate) {
    let valid = estimate.valid().count();
    println!(
        "{}: {} lines, {valid} of them valid",
        estimate.method(),
        estimate.lines().len()
    );
    let invalid = estimate
        .lines()
        .iter()
        .filter(|line| !line.validity.is_valid());
    for line in invalid.step_by(20) {
        println!("{:.0} Hz: {}", line.frequency_hz, line.validity);
    }
    if let Some(line) = estimate.valid().nth(valid / 2) {
        println!(
            "{:.0} Hz: E = {:.4e} Pa, standard errors {:.1e} due to noise and {:.1e} due to the specimen",
            line.frequency_hz,
            line.modulus,
            line.random_error(),
            line.systematic_error()
        );
    }
}
