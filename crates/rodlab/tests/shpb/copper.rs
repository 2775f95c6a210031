//! Copper between steel bars, computed with finite elements by other authors: six passages of the
//! pulse, one gauge per bar, and the velocities of both faces.

use std::f64::consts::PI;
use std::fs;

use rodlab::Outcome;
use rodwave::fourier::RealFourier;
use testbed::measured;

use super::{column, quantity, write_columns};
use crate::runs::Folder;

const NAME: &str = "copper/gauge_strain_records.csv";
const GAUGES: [&str; 2] = [
    "gauge1_incident_bar_strain",
    "gauge2_transmission_bar_strain",
];
/// Density [kg/m³] and sqrt(E/rho) [m/s] of the bars.
const STEEL: (f64, f64) = (7850.0, 5122.7);
/// Cross-section of a bar over that of the specimen.
const SECTIONS: f64 = 4.0;
/// Interval of the samples \[s\].
const STEP: f64 = 2.5e-6;
/// Times \[s\] at which the rounding of the authors' clock becomes coarser.
const COARSER: [f64; 2] = [1.0 / 1024.0, 1.0 / 512.0];

/// Columns of the record.
struct Elements {
    head: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Elements {
    /// Reads the record; prints a message and returns `None` if it does not exist.
    fn read() -> Option<Self> {
        let path = measured::folder()?.join("shpb").join(NAME);
        if !path.exists() {
            println!("skipped: {} does not exist", path.display());
            return None;
        }
        let table = fs::read_to_string(path).unwrap();
        let mut lines = table.lines().map(|line| line.split(','));
        Some(Self {
            head: lines.next().unwrap().map(str::to_owned).collect(),
            rows: lines
                .map(|row| row.map(|cell| cell.parse().unwrap()).collect())
                .collect(),
        })
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let at = self.head.iter().position(|head| head == name).unwrap();
        self.rows.iter().map(|row| row[at]).collect()
    }

    /// A column interpolated at `wanted` times \[s\], by polynomials through eight of its samples,
    /// which are at `times`.
    fn interpolated(
        &self,
        name: &str,
        times: &[f64],
        wanted: impl Iterator<Item = f64>,
    ) -> Vec<f64> {
        let values = self.column(name);
        let of_time = |time: f64| {
            let after = times.partition_point(|t| *t < time);
            let first = after.saturating_sub(4).min(times.len() - 8);
            let nodes = &times[first..first + 8];
            let product = |k: usize| -> f64 {
                let others = (0..8).filter(|j| *j != k);
                others
                    .map(|j| (time - nodes[j]) / (nodes[k] - nodes[j]))
                    .product()
            };
            (0..8).map(|k| product(k) * values[first + k]).sum()
        };
        wanted.map(of_time).collect()
    }

    /// A column at multiples of [`STEP`].
    fn at_even_times(&self, name: &str, times: &[f64]) -> Vec<f64> {
        let n = (times.last().unwrap() / STEP) as usize;
        self.interpolated(name, times, (0..n).map(|at| STEP * at as f64))
    }

    /// Times \[s\] with all increments corrected to those between 1/4096 s and 1/2048 s. In the
    /// record an increment is multiplied by 340/339 after 1/1024 s, and by 336/339 after 1/512 s.
    fn mended_times(&self) -> Vec<f64> {
        let [first, second] = COARSER;
        let mend = |t: f64| {
            let (before, between) = (t.min(first), t.clamp(first, second) - first);
            before + between * 339.0 / 340.0 + (t - second).max(0.0) * 339.0 / 336.0
        };
        self.column("time_s").into_iter().map(mend).collect()
    }
}

/// The sheet of the shot, with the samples in a file at even times.
fn evaluated(folder: &Folder, gauges: &[Vec<f64>; 2], poisson_ratio: &str) -> Outcome {
    write_columns(&folder.file("copper.csv"), gauges);
    let bar = |channel: usize, separation: &str| {
        format!(
            r#"(waves: Speed(density: "7850 kg/m3", wave_speed: "5122.7 m/s ± 5 m/s"), diameter: "16 mm", length: "1000 mm",
            {poisson_ratio} gauges: [(channel: "{channel}", at: "250 mm ± 1 mm")], separation: {separation})"#
        )
    };
    let channel = |k: usize| {
        format!(
            r#"(name: "{k}", from: {k}, unit: "strain", inverted: true, sensitivity: "1 ± 1 %")"#
        )
    };
    let text = format!(
        r#"Shpb(title: "copper", loading: Compression, bars: (incident: {}, transmitted: {}),
            specimen: (length: "6 mm", diameter: "8 mm"), records: [(files: ["copper.csv"], sampling_rate: "400 kHz",
            channels: [{}, {}])], silent: "90 us", stress_from: Transmitted)"#,
        bar(1, "Balanced"),
        bar(2, "FreeEnd"),
        channel(1),
        channel(2)
    );
    let outcome = folder.run(&text).unwrap();
    println!("{:?}\n{:?}", outcome.verdict, outcome.summary);
    assert_ne!(
        outcome.verdict.standing().exit_status(),
        1,
        "{:?}",
        outcome.verdict
    );
    outcome
}

/// Samples after the low-pass of the evaluation: a raised cosine from 0.75 to 1.25 of `band`
/// \[Hz\], where the amplitude is a half.
fn low_passed(samples: &[f64], band: f64) -> Vec<f64> {
    let n = 4096;
    let mut transform = RealFourier::new(n);
    transform.samples().fill(0.0);
    for (to, from) in transform.samples().iter_mut().zip(samples) {
        *to = *from;
    }
    let mut lines = transform.forward().to_vec();
    for (k, line) in lines.iter_mut().enumerate() {
        let part = k as f64 / (n as f64 * STEP) / band;
        let place = ((part - 0.75) / 0.5).clamp(0.0, 1.0);
        *line *= 0.5 * (1.0 + (PI * place).cos()) / n as f64;
    }
    transform.lines().copy_from_slice(&lines);
    transform.inverse()[..samples.len()].to_vec()
}

/// Comparison of the record of the elements with the result from their gauges.
struct Compared {
    /// Root mean square of the difference divided by that of the velocity.
    off: f64,
    /// Fractions of the samples in the 95 % band, of the first loading and of all passages.
    inside: [f64; 2],
}

/// Compares velocities of a face [m/s] at even times.
fn compared(outcome: &Outcome, face: &str, theirs: &[f64]) -> Compared {
    let ours = column(outcome, "faces", &format!("velocity of the {face} face"));
    let half = column(
        outcome,
        "faces",
        &format!("95 % half width of the velocity of the {face} face"),
    );
    let (mut difference, mut size) = (0.0, 0.0);
    let (mut inside, mut all) = ([0.0; 2], [0.0; 2]);
    let time = column(outcome, "faces", "time");
    for ((time, v), half) in time.iter().zip(ours).zip(half) {
        let exact = theirs[(1e-6 * time / STEP).round() as usize];
        for (at, counted) in [*time < 435.0, true].into_iter().enumerate() {
            if counted {
                all[at] += 1.0;
                inside[at] += f64::from(u8::from((v - exact).abs() <= *half));
            }
        }
        difference += (v - exact).powi(2);
        size += exact.powi(2);
    }
    Compared {
        off: f64::sqrt(difference / size),
        inside: [inside[0] / all[0], inside[1] / all[1]],
    }
}

/// Greatest common divisor of the steps between samples from one time to another \[s\], in units of
/// the last digit of a single-precision number.
fn increment(times: &[f64], from: f64, to: f64) -> u32 {
    let within = times.iter().filter(|t| (from..to).contains(*t));
    let bits: Vec<u32> = within.map(|t| (*t as f32).to_bits()).collect();
    let divisor = |mut a: u32, mut b: u32| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let steps = bits.windows(2).map(|pair| pair[1] - pair[0]);
    steps.fold(0, divisor)
}

/// The times of the record are sums in single precision: the same increment is rounded to 339
/// units, then to 85 units of four times the size, then to 42 units of eight times the size. The
/// period of the pulse in the free bar shows this, too.
#[test]
fn hopkinson_copper_has_a_clock_of_single_precision() {
    let Some(elements) = Elements::read() else {
        return;
    };
    let times = elements.column("time_s");
    assert!(times.iter().all(|t| f64::from(*t as f32) == *t));
    let [first, second] = COARSER;
    let increments = [
        increment(&times, 0.25 * first, 0.5 * first),
        increment(&times, first, second),
        // the last increment is shortened to end at 2 ms
        increment(&times, second, 1.999e-3),
    ];
    assert_eq!(increments, [339, 85, 42]);
    // passages of the pulse at the end of the transmitted bar, which is free except for a moment
    let name = "transmitted_end_mean_v3_mm_per_s";
    for [from, to] in [[1360e-6, 1580e-6], [1750e-6, 1930e-6]] {
        let at = |lag: f64| {
            let samples = ((to - from) / STEP) as usize;
            let wanted = (0..samples).map(|k| from + STEP * k as f64 - lag);
            elements.interpolated(name, &times, wanted)
        };
        let now = at(0.0);
        let unlike = |lag: f64| -> f64 {
            let pairs = now.iter().zip(at(lag));
            pairs.map(|(a, b)| (a - b).powi(2)).sum()
        };
        let lags = (0..140).map(|k| 388e-6 + 0.05e-6 * f64::from(k));
        let period = lags.min_by(|a, b| unlike(*a).total_cmp(&unlike(*b)));
        // expected: the period 2 L/c is 390.42 us, or 391.57 us in the times of the record; the
        // dispersion at 20 kHz adds 0.35 us
        let expected = 2.0 / STEEL.1 * 340.0 / 339.0;
        let off = period.unwrap() - expected;
        println!("{off:e}");
        assert!(off.abs() < 0.3e-6, "{off:e}");
    }
}

/// The velocities of the faces agree with those of the elements in the same band and with corrected
/// times; the elements have the dispersion of a round bar.
#[test]
fn hopkinson_copper_has_the_velocities_of_its_faces() {
    let Some(elements) = Elements::read() else {
        return;
    };
    let folder = Folder::new();
    let velocities = |times: &[f64]| {
        ["incident", "transmitted"].map(|face| {
            let name = format!("{face}_end_mean_v3_mm_per_s");
            let values = elements.at_even_times(&name, times);
            values.iter().map(|v| 1e-3 * v).collect::<Vec<_>>()
        })
    };
    let of = |times: &[f64], poisson_ratio: &str| {
        let gauges = GAUGES.map(|name| elements.at_even_times(name, times));
        evaluated(&folder, &gauges, poisson_ratio)
    };
    let (theirs, mended) = (elements.column("time_s"), elements.mended_times());
    let ratio = r#"poisson_ratio: "0.3","#;
    let (as_it_is, right, long_waves) = (of(&theirs, ratio), of(&mended, ratio), of(&mended, ""));
    let band = 1e3 * quantity(&right, "end of the band").value.unwrap();
    let (as_sampled, true_times) = (velocities(&theirs), velocities(&mended));
    let [incident, transmitted] = [0, 1].map(|at| {
        let face = ["incident", "transmitted"][at];
        let in_band = low_passed(&true_times[at], band);
        let found = [
            compared(&as_it_is, face, &as_sampled[at]),
            compared(&as_it_is, face, &low_passed(&as_sampled[at], band)),
            compared(&right, face, &in_band),
            compared(&long_waves, face, &in_band),
        ];
        for found in &found {
            println!("{face}: {:.4} {:?}", found.off, found.inside);
        }
        found
    });
    // 2 % of the elements' velocity is above the band, mostly excited when the specimen hits the
    // end at 1190 us and 1610 us; the next largest difference is that of the times
    let [unfiltered, their_clock, found, long_waves] = transmitted;
    assert!(unfiltered.inside[1] < 0.85 && unfiltered.off > 0.02);
    assert!(their_clock.inside[1] > 0.95 && their_clock.off > 0.009);
    // the gauges of the elements have no error, but the sheet states 1 %, so that fractions above
    // 0.95 are expected
    assert!(found.inside[0] > 0.95 && found.inside[1] > 0.97);
    assert!(found.off < 0.007, "{}", found.off);
    // without the dispersion of Pochhammer and Chree the difference is four times as large
    assert!(long_waves.off > 3.0 * found.off);
    // tolerance: the waves of the incident bar are separated by equating its force to that of the
    // transmitted bar (`Balanced`), which is right only while the specimen transmits the force
    let [.., found, _] = incident;
    assert!(found.inside[0] > 0.95 && found.inside[1] > 0.95);
    assert!(found.off < 0.07, "{}", found.off);
}

/// Stress of the specimen from four sources: the evaluation, rho c v of the transmitted end, the
/// gauge there, and the mean stress of the elements on the enlarged section. The stress that the
/// authors call the reference is smaller by a tenth.
#[test]
fn hopkinson_copper_has_another_stress_than_its_reference() {
    let Some(elements) = Elements::read() else {
        return;
    };
    let folder = Folder::new();
    let times = elements.column("time_s");
    let gauges = GAUGES.map(|name| elements.at_even_times(name, &times));
    let outcome = evaluated(&folder, &gauges, r#"poisson_ratio: "0.3","#);
    let (time, stress) = (
        column(&outcome, "stress_strain", "time"),
        column(&outcome, "stress_strain", "stress"),
    );
    let theirs = |name: &str, at: f64| elements.interpolated(name, &times, [at].into_iter())[0];
    let (density, speed) = STEEL;
    // while only the first wave is in the transmitted bar
    for micros in [280.0, 320.0, 340.0] {
        let at = 1e-6 * micros;
        let ours = time.iter().position(|t| (t - micros).abs() < 1e-6).unwrap();
        let velocity = 1e-3 * theirs("transmitted_end_mean_v3_mm_per_s", at);
        let strain = -theirs(GAUGES[1], at + 0.25 / speed);
        let grown = theirs("specimen_mean_compressive_le33", at).exp();
        let ways = [
            stress[ours],
            1e-6 * density * speed * velocity * SECTIONS,
            -1e-6 * density * speed * speed * strain * SECTIONS,
            theirs("specimen_mean_compressive_s33_MPa", at) * grown,
        ];
        let mean = 0.25 * ways.iter().sum::<f64>();
        let reference = theirs("reference_transmitted_end_stress_MPa", at);
        println!("{micros} us: {ways:?}, {reference}");
        // friction and inertia of 6 mm of copper are less than 1 %
        assert!(ways.iter().all(|way| (way / mean - 1.0).abs() < 0.01));
        let ratio = reference / mean;
        assert!((0.89..0.92).contains(&ratio), "{ratio}");
    }
}
