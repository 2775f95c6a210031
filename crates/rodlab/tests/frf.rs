//! Frequency responses as a user gets them: a sheet and files in, an outcome out, against a body
//! whose response is known.
//!
//! The body is two masses joined by a spring and a dashpot, free in space. Its histories are
//! integrated in time; the accelerance they are compared with is the closed form in the frequency
//! domain.

use testbed::measured;

use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use labio::format::{self, npy::Npy};
use labio::instrument::{Converter, Instrument, NoiseSpectrum};
use labio::{
    Abscissa, Channel, Contents, Ordinate, Provenance, Quantity, Rating, Record, SensorChain,
    Series, SeriesAxis, SeriesKind,
};
use ndarray::Array2;
use num_complex::Complex64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rodlab::job::{self, Silent};
use rodlab::outcome::{Cells, Verdict};
use rodlab::sheet::{self, Sheet};
use rodlab::{Outcome, output};

const RATE: f64 = 8192.0;
const N: usize = 4096;
const ONSET: f64 = 0.05;
const STRUCK: f64 = 1.2;
const OTHER: f64 = 0.8;
const MASS: f64 = STRUCK + OTHER;
/// Of the mode \[rad/s\] and its damping ratio: at the end of a record it has fallen by 25 nepers.
const OMEGA: f64 = TAU * 300.0;
const ZETA: f64 = 0.03;

fn spring() -> (f64, f64) {
    let reduced = STRUCK * OTHER / MASS;
    (reduced * OMEGA * OMEGA, 2.0 * ZETA * OMEGA * reduced)
}

/// Accelerance of the struck mass, closed form.
fn accelerance(s: Complex64) -> Complex64 {
    let (stiffness, damping) = spring();
    let z = stiffness + damping * s;
    (OTHER * s * s + z) / (STRUCK * OTHER * s * s + MASS * z)
}

/// A blow of `peak` N over `duration`, a squared sine.
fn blow(t: f64, peak: f64, duration: f64) -> f64 {
    if (0.0..duration).contains(&t) {
        peak * (PI * t / duration).sin().powi(2)
    } else {
        0.0
    }
}

/// Force and acceleration of the struck mass.
fn history(n: usize, force: impl Fn(f64) -> f64) -> Record {
    history_of(Quantity::Acceleration, n, force)
}

/// Force and a motion of the struck mass: Runge and Kutta, 16 steps a sample.
fn history_of(quantity: Quantity, n: usize, force: impl Fn(f64) -> f64) -> Record {
    const STEPS: usize = 16;
    let h = 1.0 / RATE / STEPS as f64;
    let (stiffness, damping) = spring();
    // elongation and its rate, velocity of the centre of mass
    let rates = |t: f64, [q, p, _]: [f64; 3]| {
        let tension = stiffness * q + damping * p;
        let apart = force(t) / STRUCK - tension * MASS / (STRUCK * OTHER);
        [p, apart, force(t) / MASS]
    };
    let mut state = [0.0; 3];
    let mut samples = Array2::zeros((2, n));
    for k in 0..n {
        let start = k as f64 / RATE;
        samples[[0, k]] = force(start);
        let tension = stiffness * state[0] + damping * state[1];
        samples[[1, k]] = match quantity {
            Quantity::Velocity => state[2] + OTHER / MASS * state[1],
            _ => (force(start) - tension) / STRUCK,
        };
        for step in 0..STEPS {
            let t = start + step as f64 * h;
            let moved = |k: [f64; 3], by: f64| {
                [
                    state[0] + by * k[0],
                    state[1] + by * k[1],
                    state[2] + by * k[2],
                ]
            };
            let k1 = rates(t, state);
            let k2 = rates(t + h / 2.0, moved(k1, h / 2.0));
            let k3 = rates(t + h / 2.0, moved(k2, h / 2.0));
            let k4 = rates(t + h, moved(k3, h));
            for i in 0..3 {
                state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
    }
    let channels = vec![
        Channel::new("force", Quantity::Force).unwrap(),
        Channel::new("acceleration", quantity).unwrap(),
    ];
    Record::new(
        samples,
        RATE,
        0.0,
        channels,
        Provenance::computed("two masses"),
    )
    .unwrap()
}

/// What a recorder of 24 bits and ±10 V makes of it: 2 mV/N, 100 mV/g, noise of `volts`²/Hz on the
/// response and a hundredth of that on the force.
fn recorded(history: &Record, density: f64, seed: u64) -> Record {
    let chain = |value: f64, unit: &str| {
        SensorChain::of_sensitivity(Rating::new(value, unit).unwrap()).unwrap()
    };
    let instrument = Instrument::new()
        .sense("force", chain(2.0, "mV/N"))
        .sense("acceleration", chain(100.0, "mV/g"))
        .noise("force", NoiseSpectrum::white(density / 100.0).unwrap())
        .noise("acceleration", NoiseSpectrum::white(density).unwrap())
        .convert(Converter::new(24, 10.0).unwrap());
    let taken = instrument
        .record(history, &mut ChaCha8Rng::seed_from_u64(seed))
        .unwrap();
    assert!(taken.saturations.is_empty());
    taken.record
}

const NOISE: f64 = 1e-9;

/// Bare volts, as a recorder exports them.
fn write(path: &Path, volts: &Record) {
    let mut contents = Contents::of_format("test");
    for (index, row) in volts.samples().rows().into_iter().enumerate() {
        contents.series.push(Series {
            name: format!("[{index}, :]"),
            kind: SeriesKind::General,
            abscissa: Abscissa::Even {
                start: 0.0,
                step: 1.0,
            },
            ordinate: Ordinate::Real(row.to_vec()),
            abscissa_axis: SeriesAxis {
                label: "index".to_owned(),
                ..SeriesAxis::default()
            },
            ordinate_axis: SeriesAxis::default(),
            properties: Vec::new(),
        });
    }
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    format::write(path, &contents, &Npy).unwrap();
}

fn write_hits(folder: &Path, n_hits: u64, duration: f64, density: f64) {
    write_hits_from(0, folder, n_hits, duration, density);
}

/// With noise of its own for another first seed.
fn write_hits_from(seed: u64, folder: &Path, n_hits: u64, duration: f64, density: f64) {
    for hit in 0..n_hits {
        let peak = 150.0 + 10.0 * hit as f64;
        let history = history(N, |t| blow(t - ONSET, peak, duration));
        write(
            &folder.join(format!("hit_{hit}.npy")),
            &recorded(&history, density, seed + hit),
        );
    }
}

fn records(files: &str) -> String {
    format!(
        r#"(files: ["{files}"], sampling_rate: "8192 Hz", channels: [
            (name: "hammer", from: 1, unit: "V", sensitivity: "2 mV/N ± 1 %"),
            (name: "struck end", from: 2, unit: "V", sensitivity: "100 mV/g ± 2 %"),
        ])"#
    )
}

/// A sheet with these further fields.
fn sheet_of(files: &str, rest: &str) -> String {
    format!(
        r#"Frf(title: "Two masses", records: {}, input: "hammer", {rest})"#,
        records(files)
    )
}

fn run(folder: &Path, text: &str) -> Result<Outcome, String> {
    let path = folder.join("test.ron");
    fs::write(&path, text).unwrap();
    let said = |error: rodlab::RodlabError| {
        let mut text = error.to_string();
        let mut source = std::error::Error::source(&error);
        while let Some(cause) = source {
            if !text.contains(&cause.to_string()) {
                text += &format!(": {cause}");
            }
            source = cause.source();
        }
        text.replace(&folder.display().to_string(), "FOLDER")
    };
    let sheet = Sheet::read(&path).map_err(said)?;
    job::run(&sheet, &Silent, &AtomicBool::new(false)).map_err(said)
}

fn column(outcome: &Outcome, table: &str, column: &str) -> Vec<f64> {
    let table = outcome.tables.iter().find(|t| t.name == table).unwrap();
    let found = table.columns.iter().find(|c| c.name == column);
    let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
    match &found
        .unwrap_or_else(|| panic!("{column} in {names:?}"))
        .cells
    {
        Cells::Numbers(values) => values.clone(),
        _ => panic!("words"),
    }
}

fn words(outcome: &Outcome, table: &str, column: &str) -> Vec<String> {
    let table = outcome.tables.iter().find(|t| t.name == table).unwrap();
    let found = table.columns.iter().find(|c| c.name == column).unwrap();
    match &found.cells {
        Cells::Words(words) | Cells::Validity { words, .. } => words.clone(),
        Cells::Numbers(_) => panic!("numbers"),
    }
}

fn quantity(outcome: &Outcome, name: &str) -> (f64, Option<f64>) {
    let found = outcome.quantities.iter().find(|q| q.name == name);
    let names: Vec<&str> = outcome.quantities.iter().map(|q| q.name.as_str()).collect();
    let found = found.unwrap_or_else(|| panic!("{name} in {names:?}"));
    (found.value.unwrap(), found.standard_error)
}

/// Frequencies and values of the response in the table.
fn response(outcome: &Outcome, kind: &str) -> Vec<(f64, Complex64)> {
    let of = |name: String| column(outcome, "response_struck_end", &name);
    let frequency = column(outcome, "response_struck_end", "frequency");
    let real = of(format!("real part of {kind}"));
    let imaginary = of(format!("imaginary part of {kind}"));
    frequency
        .into_iter()
        .zip(real.into_iter().zip(imaginary))
        .map(|(f, (re, im))| (f, Complex64::new(re, im)))
        .collect()
}

fn on_axis(frequency_hz: f64) -> Complex64 {
    Complex64::new(0.0, TAU * frequency_hz)
}

/// Mean of |δH|² over the variance that the table states, and the part of lines beyond two standard
/// deviations.
fn spread(outcome: &Outcome, kind: &str, truth: impl Fn(f64) -> Complex64) -> (f64, f64) {
    let errors = column(
        outcome,
        "response_struck_end",
        "random error of the magnitude",
    );
    let ratios: Vec<f64> = response(outcome, kind)
        .into_iter()
        .zip(errors)
        .map(|((f, value), percent)| {
            // of the complex line: twice that of the magnitude
            let variance = 2.0 * (value.norm() * percent / 100.0).powi(2);
            (value - truth(f)).norm_sqr() / variance
        })
        .collect();
    let n = ratios.len() as f64;
    let beyond = ratios.iter().filter(|ratio| **ratio > 4.0).count() as f64;
    (ratios.iter().sum::<f64>() / n, beyond / n)
}

const BAND: &str = r#"band: (from: "20 Hz", to: "1.2 kHz"),"#;

#[test]
fn the_response_is_that_of_the_body_within_its_stated_errors() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 10, 1e-3, NOISE);
    let outcome = run(folder.path(), &sheet_of("hit_*.npy", BAND)).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered);
    assert!(
        outcome.log.iter().all(|entry| entry.accepted),
        "{:#?}",
        outcome.log
    );
    let (mean, beyond) = spread(&outcome, "accelerance", |f| accelerance(on_axis(f)));
    // 590 lines. Ten hits: |δH|² over its estimate is F(2, 18), mean 1.125 and standard deviation
    // 1.4, so 0.06 of the mean over the lines; 4 of those. Beyond 4 lie (1 + 4/9)^-9 = 3.6 %,
    // standard error 0.8 %; 4 of those.
    assert!((mean - 1.125).abs() < 0.24, "{mean}");
    assert!((beyond - 0.036).abs() < 0.032, "{beyond}");

    let (averages, _) = quantity(&outcome, "averages");
    assert!((averages - 10.0).abs() < 1e-12);
    let (spacing, _) = quantity(&outcome, "distance of lines");
    assert!((spacing - 2.0).abs() < 1e-12);
    // 1 % and 2 %, independent
    let (calibration, _) = quantity(&outcome, "uncertainty of the calibration, struck end");
    assert!((calibration - 5.0_f64.sqrt()).abs() < 1e-9);
    // a squared sine over 1 ms is 20 dB down at 1.65 kHz, where its transform sinc(x)/(1 - x²), x =
    // f T, is a tenth
    let (end, _) = quantity(&outcome, "end of the spectrum of the input");
    assert!((1600.0..1700.0).contains(&end), "{end}");
    let (lowest, _) = quantity(&outcome, "lowest coherence, struck end");
    let coherence = column(&outcome, "response_struck_end", "coherence");
    let least = coherence.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((lowest - least).abs() < 1e-15 && lowest < 1.0);
    let names: Vec<&str> = outcome.figures.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "hits",
            "input_spectra",
            "response_struck_end",
            "nyquist_struck_end"
        ]
    );
    assert_eq!(outcome.inputs.len(), 10);
}

#[test]
fn the_universal_file_holds_the_response_and_its_coherence() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 3, 1e-3, NOISE);
    let outcome = run(
        folder.path(),
        &sheet_of(
            "hit_*.npy",
            "kind: Mobility, band: (from: \"20 Hz\", to: \"1.2 kHz\"),",
        ),
    )
    .unwrap();
    let attachment = &outcome.attachments[0];
    assert_eq!(attachment.name, "frf.uff");
    let contents = format::read_bytes(&attachment.bytes).unwrap();
    assert_eq!(contents.format, "uff58");
    let [mobility, error, freedom, common, coherence] = contents.series.as_slice() else {
        panic!("five series");
    };
    assert_eq!(mobility.kind, SeriesKind::FrequencyResponse);
    assert_eq!(coherence.kind, SeriesKind::Coherence);
    // velocity over force, without the line at 0 Hz, which has no integral
    assert_eq!(
        mobility.ordinate_axis.unit.as_ref().unwrap().dimension(),
        labio::Unit::parse("m/(N s)").unwrap().dimension()
    );
    let (Abscissa::Even { start, step }, Ordinate::Complex(values)) =
        (&mobility.abscissa, &mobility.ordinate)
    else {
        panic!("complex and even");
    };
    assert!((start - 2.0).abs() < 1e-6 && (step - 2.0).abs() < 1e-6);
    let table = response(&outcome, "mobility");
    for (frequency, value) in table {
        let line = ((frequency - start) / step).round() as usize;
        // thirteen digits of text
        assert!((values[line] - value).norm() < 1e-11 * value.norm());
    }
    // three hits have four degrees of freedom, the sensors 1 % and 2 %
    let reals = |series: &Series| match &series.ordinate {
        Ordinate::Real(values) => values.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!(error.name, "struck end, standard error");
    assert!(
        reals(freedom)
            .iter()
            .all(|freedom| (freedom - 4.0).abs() < 1e-9)
    );
    let sensors = 0.01_f64.hypot(0.02);
    assert!(
        reals(common)
            .iter()
            .all(|error| (error / sensors - 1.0).abs() < 1e-9)
    );
    let said = mobility
        .properties
        .iter()
        .find(|(field, _)| field == "uff58.id3");
    assert_eq!(said.unwrap().1, "averages: 3");

    // and a mobility that is read of it knows them all
    fs::write(folder.path().join("frf.uff"), &attachment.bytes).unwrap();
    let read = run(
        folder.path(),
        r#"Mobility(title: "read", source: File(file: "frf.uff"), support: Free(mass: "2 kg ± 1 %"), up_to: "1.2 kHz")"#,
    )
    .unwrap();
    let written = column(
        &outcome,
        "response_struck_end",
        "random error of the magnitude",
    );
    // the first line of the band is the tenth of the mobility, behind 0 Hz
    let again = column(&read, "mobility", "standard error of the magnitude");
    for (there, here) in written.iter().zip(&again[10..]) {
        assert!((there / here - 1.0).abs() < 1e-9);
    }
    let freedom = column(&read, "mobility", "degrees of freedom of the errors");
    assert!(
        freedom[10..]
            .iter()
            .all(|freedom| (freedom - 4.0).abs() < 1e-9)
    );
    let common = column(&read, "mobility", "error that lines share");
    assert!(
        common[10..]
            .iter()
            .all(|error| (error / 100.0 / sensors - 1.0).abs() < 1e-9)
    );
}

/// A second hammer with a sensitivity of its own, 10 % off or right.
fn second_of(sensitivity: &str) -> String {
    let second = records("hard/*.npy").replace("2 mV/N ± 1 %", sensitivity);
    sheet_of(
        "soft/*.npy",
        &format!("{BAND} second_hammer: (records: {second}),"),
    )
}

#[test]
fn s6_hammers_that_differ_in_gain_are_in_doubt_and_both_sensors_count() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(&folder.path().join("soft"), 5, 2e-3, NOISE);
    write_hits_from(50, &folder.path().join("hard"), 5, 0.7e-3, NOISE);
    let outcome = run(folder.path(), &second_of("2 mV/N ± 3 %")).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.warnings);
    // between what the first and the second pair of sensors give, as the shares are
    let common = column(&outcome, "response_struck_end", "error that lines share");
    let shares = column(&outcome, "response_struck_end", "share of the first hammer");
    for (common, share) in common.iter().zip(shares) {
        let expected =
            100.0 * (share * 0.01_f64.hypot(0.02) + (1.0 - share) * 0.03_f64.hypot(0.02));
        assert!((common / expected - 1.0).abs() < 1e-9);
    }
    let outcome = run(folder.path(), &second_of("2.2 mV/N ± 1 %")).unwrap();
    let Verdict::InDoubt { reasons } = &outcome.verdict else {
        panic!("{:?}", outcome.verdict);
    };
    // a force that is read 10 % too small makes the response 10 % too large
    assert!(
        reasons
            .iter()
            .any(|reason| reason.contains("the second hammer gives 1.10")),
        "{reasons:?}"
    );
    let common = column(&outcome, "response_struck_end", "error that lines share");
    // ln 1.1 over the root of 2, beside the sensors of 2.2 %
    assert!(
        common.iter().all(|error| (error - 7.1).abs() < 0.2),
        "{}",
        common[0]
    );
}

#[test]
fn motions_are_converted_and_a_weighed_mass_carries_the_low_lines() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 10, 1e-3, NOISE);
    let text = sheet_of(
        "hit_*.npy",
        r#"kind: Mobility, band: (from: "2 Hz", to: "1.2 kHz"),
           weighed_mass: (mass: "2 kg ± 1 gram", below: "20 Hz", fitted_to: "80 Hz"),"#,
    );
    let outcome = run(folder.path(), &text).unwrap();
    let (mass, error) = quantity(&outcome, "apparent mass, struck end");
    assert!(
        (mass - MASS).abs() < 4.0 * error.unwrap() + 0.002 * MASS,
        "{mass} {error:?}"
    );
    let validity = words(&outcome, "response_struck_end", "validity");
    for ((frequency, value), validity) in response(&outcome, "mobility").iter().zip(&validity) {
        let s = on_axis(*frequency);
        let truth = accelerance(s) / s;
        if *frequency < 20.0 {
            assert_eq!(validity, "of the weighed mass");
            // 1 gram of 2 kg, and the neglected (ω/ω_0)⁴ of the mode
            assert!((value / truth - 1.0).norm() < 2e-3, "{frequency}");
        } else {
            assert_eq!(validity, "valid");
        }
    }
    assert!(outcome.warnings.is_empty(), "{:?}", outcome.warnings);
    // a mass that was weighed wrong does not agree with the lines
    let wrong = text.replace("2 kg ± 1 gram", "2.5 kg ± 1 gram");
    let outcome = run(folder.path(), &wrong).unwrap();
    let Verdict::InDoubt { reasons } = &outcome.verdict else {
        panic!("{:?}", outcome.summary)
    };
    assert!(
        reasons[0].contains("more apart than their errors explain"),
        "{reasons:?}"
    );
}

#[test]
fn the_exponential_window_gives_the_response_off_the_axis() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 6, 1e-3, 0.01 * NOISE);
    let outcome = run(
        folder.path(),
        &sheet_of(
            "hit_*.npy",
            &format!("{BAND} exponential_window: TimeConstant(time: \"40 ms\"),"),
        ),
    )
    .unwrap();
    let (decay, _) = quantity(&outcome, "damping added by the exponential window");
    assert!((decay - 25.0).abs() < 1e-9);
    assert!(outcome.warnings.iter().any(|w| w.contains("25 1/s")));
    for (frequency, value) in response(&outcome, "accelerance") {
        let truth = accelerance(on_axis(frequency) + decay);
        // noise of a hundredth of the others; on the axis itself the peak is half as high again
        assert!((value / truth - 1.0).norm() < 0.02, "{frequency}");
    }
    let near = response(&outcome, "accelerance")
        .into_iter()
        .find(|(f, _)| (f - 300.0).abs() < 1e-9)
        .unwrap();
    assert!((near.1 / accelerance(on_axis(300.0)) - 1.0).norm() > 0.2);
}

#[test]
fn a_force_window_takes_the_noise_off_the_input() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 6, 1e-3, NOISE);
    let force_window = r#"force_window: (start: "45 ms", end: "55 ms", taper: "2 ms"),"#;
    let with = run(
        folder.path(),
        &sheet_of("hit_*.npy", &format!("{BAND}{force_window}")),
    )
    .unwrap();
    let (mean, _) = spread(&with, "accelerance", |f| accelerance(on_axis(f)));
    // six hits: F(2, 10), mean 1.25; standard deviation 2 over 590 lines
    assert!((mean - 1.25).abs() < 0.33, "{mean}");
    let figure = with.figures.iter().find(|f| f.name == "hits").unwrap();
    let drawn = serde_json::to_string(&figure.panels[0]).unwrap();
    assert!(drawn.contains("force window"));
    // beside a Hann window it has no meaning
    let error = run(
        folder.path(),
        &sheet_of("hit_*.npy", &format!("{force_window} window: Hann,")),
    )
    .unwrap_err();
    insta::assert_snapshot!(error, @"force_window: a force window cannot stand beside HannPeriodic");
}

#[test]
fn two_hammers_are_one_response() {
    let folder = tempfile::tempdir().unwrap();
    // soft and hard: the first ends where the second begins
    write_hits(&folder.path().join("soft"), 8, 4e-3, NOISE);
    write_hits_from(50, &folder.path().join("hard"), 8, 0.7e-3, 10.0 * NOISE);
    let second = |merge: &str| {
        sheet_of(
            "soft/*.npy",
            &format!(
                "{BAND} second_hammer: (records: {}, merge: {merge}),",
                records("hard/*.npy")
            ),
        )
    };
    for merge in ["InverseVariance", "LargerInput"] {
        let outcome = run(folder.path(), &second(merge)).unwrap();
        assert_eq!(outcome.verdict, Verdict::Answered);
        let (mean, _) = spread(&outcome, "accelerance", |f| accelerance(on_axis(f)));
        // the estimates of the variances of 8 hits each, of which the better is believed too much:
        // 8/7 to 1.6 in the mean
        assert!((1.0..1.9).contains(&mean), "{merge} {mean}");
        let shares = column(&outcome, "response_struck_end", "share of the first hammer");
        let frequency = column(&outcome, "response_struck_end", "frequency");
        for (frequency, share) in frequency.iter().zip(shares) {
            match *frequency {
                f if f < 200.0 => assert!(share > 0.8, "{merge} {f} {share}"),
                f if f > 800.0 => assert!(share < 0.5, "{merge} {f} {share}"),
                _ => {}
            }
        }
        assert_eq!(outcome.inputs.len(), 16);
        assert!(outcome.figures.iter().any(|f| f.name == "merge_struck_end"));
        assert!(
            outcome
                .tables
                .iter()
                .any(|t| t.name == "hits_second_hammer")
        );
    }
}

#[test]
fn a_double_hit_is_rejected_with_its_reason_and_a_hand_can_decide_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 4, 1e-3, NOISE);
    let double = history(N, |t| {
        blow(t - ONSET, 150.0, 1e-3) + blow(t - ONSET - 0.02, 40.0, 1e-3)
    });
    write(
        &folder.path().join("hit_4.npy"),
        &recorded(&double, NOISE, 9),
    );
    let by_checks = run(folder.path(), &sheet_of("hit_*.npy", BAND)).unwrap();
    let log: Vec<String> = by_checks
        .log
        .iter()
        .map(|entry| {
            format!(
                "{} {} {}",
                entry.accepted,
                entry.what,
                entry.reasons.join("; ")
            )
        })
        .collect();
    insta::assert_snapshot!(log.join("\n"), @r"
    true hit 1, hit_0.npy 
    true hit 2, hit_1.npy 
    true hit 3, hit_2.npy 
    true hit 4, hit_3.npy 
    false hit 5, hit_4.npy double hit: two contacts in `hammer`, peaks in the ratio 0.261, 20.02 ms apart
    ");
    assert!(
        by_checks
            .summary
            .iter()
            .any(|s| s == "4 of 5 hits accepted, rejected: double hit 1 (hit 5).")
    );

    let by_hand = run(
        folder.path(),
        &sheet_of(
            "hit_*.npy",
            &format!(
                r#"{BAND} hits: (
                    accept: [(hit: 5, because: "the response is linear")],
                    reject: [(hit: 2, because: "the hammer slipped")],
                ),"#
            ),
        ),
    )
    .unwrap();
    let decided: Vec<bool> = by_hand.log.iter().map(|entry| entry.accepted).collect();
    assert_eq!(decided, [true, false, true, true, true]);
    assert_eq!(
        by_hand.log[1].reasons,
        ["rejected by hand: the hammer slipped"]
    );
    assert_eq!(
        by_hand.log[4].reasons[0],
        "accepted by hand: the response is linear"
    );
    // a second blow is no error of a linear system: force and response hold both
    let (mean, _) = spread(&by_hand, "accelerance", |f| accelerance(on_axis(f)));
    assert!(mean < 3.0, "{mean}");
}

#[test]
fn a_long_record_is_cut_by_a_trigger() {
    let folder = tempfile::tempdir().unwrap();
    // a blow every 0.6 s, the last one cut
    let long = history(5 * N + 800, |t| {
        (0..5)
            .map(|hit| {
                blow(
                    t - 0.1 - 0.6 * f64::from(hit),
                    150.0 + 10.0 * f64::from(hit),
                    1e-3,
                )
            })
            .sum()
    });
    write(&folder.path().join("long.npy"), &recorded(&long, NOISE, 3));
    let cut = |rest: &str| {
        format!(
            r#"{BAND} hits: (cut: Trigger(level: "20 N", pre_trigger: "50 ms", length: "4096 samples"{rest})),"#
        )
    };
    let outcome = run(folder.path(), &sheet_of("long.npy", &cut(""))).unwrap();
    let said: Vec<String> = outcome
        .log
        .iter()
        .map(|entry| {
            format!(
                "{} {} {}",
                entry.accepted,
                entry.what,
                entry.reasons.join("; ")
            )
        })
        .collect();
    insta::assert_snapshot!(said.join("\n"), @r"
    true hit 1, long.npy at 0.1002 s 
    true hit 2, long.npy at 0.7002 s 
    true hit 3, long.npy at 1.3002 s 
    true hit 4, long.npy at 1.9001 s 
    false hit 5, long.npy at 2.5001 s cut at the end: 2887 samples are missing after it
    ");
    let (mean, _) = spread(&outcome, "accelerance", |f| accelerance(on_axis(f)));
    // four hits: F(2, 6), mean 1.5, whose variance is large
    assert!((1.0..4.0).contains(&mean), "{mean}");
    let silent = run(
        folder.path(),
        &sheet_of("long.npy", &cut("").replace("20 N", "2 kN")),
    )
    .unwrap();
    let Verdict::NotAllowed { reason } = &silent.verdict else {
        panic!("{:?}", silent.verdict);
    };
    insta::assert_snapshot!(reason, @r"no hit is found, as hit 1, long.npy: not triggered: `hammer` never passes 2000, it lies between -0.376 and 189.7");
    let wrong = run(
        folder.path(),
        &sheet_of("long.npy", &cut("").replace("20 N", "20 g")),
    );
    insta::assert_snapshot!(wrong.unwrap_err(), @r"hits.cut.level is `20 g`, expected a level of `hammer`, which is force [N]");
}

#[test]
fn r10_a_hit_in_two_files_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 3, 1e-3, NOISE);
    let mut files: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|file| file.unwrap().path())
        .collect();
    files.sort();
    let copy = folder.path().join("hit_copy.npy");
    fs::copy(&files[1], &copy).unwrap();
    let error = run(folder.path(), &sheet_of("hit_*.npy", BAND)).unwrap_err();
    assert!(
        error.contains("hit_copy.npy have the same content"),
        "{error}"
    );
}

#[test]
fn r24_a_single_hit_has_no_valid_line_and_no_hit_has_no_response() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 1, 1e-3, NOISE);
    let single = run(folder.path(), &sheet_of("hit_*.npy", BAND)).unwrap();
    let Verdict::InDoubt { reasons } = &single.verdict else {
        panic!("{:?}", single.verdict)
    };
    insta::assert_snapshot!(reasons.join("\n"), @"only one hit is accepted: there is no coherence, and the error of its lines is not known");
    let table = single
        .tables
        .iter()
        .find(|t| t.name == "response_struck_end")
        .unwrap();
    let Cells::Validity {
        words: validity, ..
    } = &table.columns.last().unwrap().cells
    else {
        panic!("words")
    };
    assert!(
        validity
            .iter()
            .all(|word| word == "error not known from one hit"),
        "{validity:?}"
    );
    let valid = single
        .quantities
        .iter()
        .find(|q| q.name == "valid lines, struck end")
        .unwrap();
    assert!(!valid.valid && valid.value == Some(0.0), "{valid:?}");
    insta::assert_snapshot!([single.summary, single.warnings].concat().join("\n"), @r"
    Do not use this result until the failed checks are explained: only one hit is accepted: there is no coherence, and the error of its lines is not known.
    Accelerance of `struck end` over `hammer` between 20 Hz and 1.2 kHz: a single hit has no coherence and gives no random error; the calibration adds 2.236 % to all lines together.
    The only hit is accepted.
    ");
    let figure = single
        .figures
        .iter()
        .find(|f| f.name == "response_struck_end")
        .unwrap();
    assert_eq!(figure.panels.len(), 2); // no panel of a coherence that there is not

    let rejected = run(
        folder.path(),
        &sheet_of(
            "hit_*.npy",
            r#"hits: (reject: [(hit: 1, because: "the rod was held")]),"#,
        ),
    )
    .unwrap();
    let Verdict::NotAllowed { reason } = &rejected.verdict else {
        panic!("{:?}", rejected.verdict);
    };
    insta::assert_snapshot!(reason, @r"the only hit is rejected, as hit 1, hit_0.npy: rejected by hand: the rod was held");
    // what could be found out is there
    assert_eq!(rejected.log.len(), 1);
    assert!(rejected.figures.iter().any(|f| f.name == "hits"));
}

#[test]
fn noise_alone_has_no_response() {
    let folder = tempfile::tempdir().unwrap();
    for hit in 0..4 {
        // the sensor of the response is not connected
        let mut volts = recorded(&history(N, |t| blow(t - ONSET, 150.0, 1e-3)), NOISE, hit);
        let still = recorded(&history(N, |_| 0.0), NOISE, 100 + hit);
        let mut samples = volts.samples().to_owned();
        samples.row_mut(1).assign(&still.samples().row(1));
        volts = Record::new(
            samples,
            RATE,
            0.0,
            volts.channels().to_vec(),
            volts.provenance().clone(),
        )
        .unwrap();
        write(&folder.path().join(format!("hit_{hit}.npy")), &volts);
    }
    let unchecked =
        r#"hits: (criteria: (level_shift: None, remainder: None, static_offset: None)),"#;
    let outcome = run(
        folder.path(),
        &sheet_of("hit_*.npy", &format!("{BAND} {unchecked}")),
    )
    .unwrap();
    let (valid, _) = quantity(&outcome, "valid lines, struck end");
    // chance passes one in twenty: 590 lines, standard error 0.9 %
    assert!((valid - 5.0).abs() < 3.6, "{valid}");
    let Verdict::NotAllowed { reason } = &outcome.verdict else {
        panic!("{:?}", outcome.verdict);
    };
    insta::assert_snapshot!(reason, @r"no more lines between 20 Hz and 1.2 kHz are coherent with `hammer` than noise alone would be");
    assert!(outcome.summary[0].contains(reason));
}

#[test]
fn the_same_sheet_gives_the_same_outcome() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 3, 1e-3, NOISE);
    let text = sheet_of("hit_*.npy", BAND);
    let [first, second] = [(); 2].map(|()| run(folder.path(), &text).unwrap());
    assert_eq!(
        output::json_of(&first, &identity()).unwrap(),
        output::json_of(&second, &identity()).unwrap()
    );
    assert_eq!(first.attachments, second.attachments);
    assert!(
        !output::json_of(&first, &identity())
            .unwrap()
            .contains(&folder.path().display().to_string())
    );
}

#[test]
fn what_is_wrong_with_a_sheet_is_said_with_its_field() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 2, 1e-3, NOISE);
    let of = |rest: &str| run(folder.path(), &sheet_of("hit_*.npy", rest)).unwrap_err();
    let mut said = vec![
        of(r#"outputs: ["struck ent"],"#),
        of(r#"outputs: ["hammer"],"#),
        of(r#"outputs: ["struck end", "struck end"],"#),
        of("outputs: [],"),
        of(r#"band: (from: "2 kHz", to: "1 kHz"),"#),
        of(r#"band: (from: "2 kHz", to: "5 kHz"),"#),
        of(r#"band: (from: "20.5 Hz", to: "21.5 Hz"),"#),
        of(r#"exponential_window: EndWeight(weight: "120 %"),"#),
        of(r#"hits: (reject: [(hit: 7, because: "double")]),"#),
        of(r#"hits: (reject: [(hit: 1, because: " ")]),"#),
        of(r#"hits: (reject: [(hit: 1, because: "a")], accept: [(hit: 1, because: "b")]),"#),
        of(r#"hits: (channel: "hamer"),"#),
        of(r#"hits: (criteria: (double_hit: -1.0)),"#),
        of(r#"hits: (criteria: (full_scales: {"hammer": "10 N"})),"#),
        of("estimator: H3,"),
        of("window: Hanning,"),
        of(r#"weighed_mass: (mass: "2 kg", below: "20 Hz", fitted_to: "10 Hz"),"#),
        of("colour: 3,"),
    ];
    let text = sheet_of("hit_*.npy", "").replace(r#"input: "hammer""#, r#"input: "force""#);
    said.push(run(folder.path(), &text).unwrap_err());
    let text = sheet_of("hit_*.npy", "kind: Mobility,").replace("100 mV/g", "100 mV/Pa");
    said.push(run(folder.path(), &text).unwrap_err());
    insta::assert_snapshot!(said.join("\n"), @r"
    outputs[0] is `struck ent`, expected one of records.channels: `hammer`, `struck end`
    outputs[0] is `hammer`, expected another channel than the input
    outputs[1] is `struck end`, expected every output once
    outputs is empty, expected at least one channel besides the input
    band is from 2 kHz to 1 kHz, expected a band of lines between 2 Hz and 4.096 kHz
    band is from 2 kHz to 5 kHz, expected a band of lines between 2 Hz and 4.096 kHz
    band is from 20.5 Hz to 21.5 Hz, where no line is, expected a band of lines between 2 Hz and 4.096 kHz, 2 Hz apart
    exponential_window: end weight of the exponential window [-] is 1.2, expected a weight between 0 and 1
    hits.reject[0].hit is 7, expected the number of one of the 2 hits that were found, from 1
    hits.reject[0].because is empty, expected the reason of the decision, in a few words
    hits.accept[0].hit is 1, on which hits.reject[0] decides already, expected one decision on each hit
    hits.channel is `hamer`, expected one of the channels `hammer`, `struck end`
    hits.criteria: ratio of two contacts is -1, expected a finite value above 0
    hits.criteria.full_scales.hammer is `10 N`, expected a level of `hammer`, which is voltage [V]
    FOLDER/test.ron:4:41: Frf.estimator: found `H3`, expected one of `H1`, `H2`, `Hv`, `Hs`
    FOLDER/test.ron:4:38: Frf.window: found `Hanning`, expected one of `Rectangular`, `Hann`, `Hamming`, `BlackmanHarris`, `FlatTop`, `Tukey`
    weighed_mass: end of the band of a nearly rigid body [Hz] is 10, expected a finite frequency above its begin
    FOLDER/test.ron:4:30: Frf.colour: there is no field `colour`, only `title`, `about`, `records`, `hits`, `segments`, `input`, `further_inputs`, `outputs`, `estimator`, `window`, `force_window`, `exponential_window`, `detrend`, `silent`, `band`, `kind`, `second_hammer`, `weighed_mass`
    input is `force`, expected one of records.channels: `hammer`, `struck end`
    kind is mobility, expected a response between a force and a motion, which `struck end` [Pa] over `hammer` [N] is not
    ");
}

#[test]
fn the_template_is_a_sheet() {
    let text = include_str!("../templates/frf.ron");
    assert_eq!(
        sheet::parse(Path::new("frf.ron"), text).unwrap().name(),
        "frf"
    );
    // and with all that is commented out but the alternatives and the second hammer's ellipsis
    let mut all = String::new();
    for line in text.lines() {
        let bare = line.trim_start();
        let field = bare.strip_prefix("// ").filter(|rest| {
            let name: String = rest
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            rest[name.len()..].starts_with(": ")
                && !name.is_empty()
                && !["cut", "records", "hits", "merge", "second_hammer"].contains(&name.as_str())
                && rest.ends_with(',')
        });
        all += field.unwrap_or(line);
        all.push('\n');
    }
    assert_ne!(all, text);
    if let Err(error) = sheet::parse(Path::new("frf.ron"), &all) {
        panic!("{error}\n{all}");
    }
}

#[test]
fn the_measured_hits_have_the_coherence_that_is_known_of_them() {
    let Some(data) = measured::folder() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for hit in 1..=5 {
        let name = format!("measurements_{hit}.npy");
        fs::copy(data.join("hammer").join(&name), folder.path().join(&name)).unwrap();
    }
    let outcome = run(
        folder.path(),
        r#"Frf(
            title: "Measured hits",
            records: (files: ["measurements_*.npy"], sampling_rate: "25.6 kHz", channels: [
                (name: "force", from: 2, unit: "N"),
                (name: "acceleration", from: 3, unit: "m/s^2"),
            ]),
            hits: (criteria: (remainder: None, level_shift: None)),
            input: "force",
            band: (from: "100 Hz", to: "2 kHz"),
        )"#,
    )
    .unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:#?}", outcome.log);
    let coherence = column(&outcome, "response_acceleration", "coherence");
    let mean = coherence.iter().sum::<f64>() / coherence.len() as f64;
    // 0.998 to 0.9996 in the parts of this band, from all five hits
    assert!((0.997..1.0).contains(&mean), "{mean}");
}

/// Of a sheet that is not on disk.
fn identity() -> output::SheetIdentity {
    output::SheetIdentity {
        file: "sheet.ron".to_owned(),
        sha256: String::new(),
    }
}

/// So many hits in N and the unit of `quantity`, in records of `n` samples, with `noise` over the
/// peak on the motion and a tenth of that on the force; `change` does something to a hit.
fn write_motions(
    folder: &Path,
    quantity: Quantity,
    (count, n, noise): (u64, usize, f64),
    change: impl Fn(u64, &mut Array2<f64>),
) {
    for hit in 0..count {
        let peak = 150.0 + 10.0 * hit as f64;
        let history = history_of(quantity, n, |t| blow(t - ONSET, peak, 1e-3));
        let mut random = ChaCha8Rng::seed_from_u64(hit);
        let mut samples = history.samples().to_owned();
        for (mut row, part) in samples.rows_mut().into_iter().zip([0.1 * noise, noise]) {
            let peak = row.iter().fold(0.0_f64, |p, x| p.max(x.abs()));
            for x in &mut row {
                let unit: f64 = StandardNormal.sample(&mut random);
                *x += part * peak * unit;
            }
        }
        change(hit, &mut samples);
        let channels = history.channels().to_vec();
        let from = Provenance::computed("two masses");
        let record = Record::new(samples, RATE, 0.0, channels, from).unwrap();
        write(&folder.join(format!("hit_{hit:02}.npy")), &record);
    }
}

fn sheet_in(unit: &str, rest: &str) -> String {
    format!(
        r#"Frf(title: "Two masses", records: (files: ["hit_*.npy"], sampling_rate: "8192 Hz", channels: [
            (name: "hammer", from: 1, unit: "N"), (name: "struck end", from: 2, unit: "{unit}"),
        ]), input: "hammer", {BAND} {rest})"#
    )
}

#[test]
fn s1_the_velocity_of_a_free_body_gives_its_mobility() {
    let folder = tempfile::tempdir().unwrap();
    write_motions(folder.path(), Quantity::Velocity, (10, N, 2e-3), |_, _| {});
    let outcome = run(folder.path(), &sheet_in("m/s", "")).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.log);
    let (mean, beyond) = spread(&outcome, "mobility", |f| {
        accelerance(on_axis(f)) / on_axis(f)
    });
    // noise of 0.2 %, above the aliasing of a blow that no filter has seen; as of an acceleration:
    // 1.25 ± 0.3 and 4.8 % ± 3.6 %
    assert!((mean - 1.25).abs() < 0.3, "{mean}");
    assert!((beyond - 0.048).abs() < 0.036, "{beyond}");
}

#[test]
fn s1_a_force_comes_back_from_the_velocity_of_a_free_body() {
    let folder = tempfile::tempdir().unwrap();
    write_motions(folder.path(), Quantity::Velocity, (9, N, 1e-3), |_, _| {});
    // the last of them is the blow, 230 N
    fs::rename(
        folder.path().join("hit_08.npy"),
        folder.path().join("blow.npy"),
    )
    .unwrap();
    let channels = r#"sampling_rate: "8192 Hz", channels: [(name: "hammer", from: 1, unit: "N"), (name: "struck end", from: 2, unit: "m/s")]"#;
    let text = format!(
        r#"Force(title: "blow", problem: Response(
            path: Hits(records: (files: ["hit_*.npy"], {channels}), force: "hammer", response: "struck end"),
            record: (files: ["blow.npy"], {channels}), response: "struck end",
            regularisation: Tikhonov(penalty: Curvature, parameter: GeneralisedCrossValidation),
            acting: (from: "48 ms", to: "53 ms")))"#
    );
    let outcome = run(folder.path(), &text).unwrap();
    // a squared sine has half its peak in the mean of its millisecond
    let (impulse, error) = quantity(&outcome, "impulse");
    // a truncated step on one side only, of 0.45 s in 0.5 s, would leave a tenth out
    assert!((impulse / 0.115 - 1.0).abs() < 0.02, "{impulse} {error:?}");
}

#[test]
fn s7_a_body_that_rings_on_is_taken_under_its_window_or_with_its_error() {
    let folder = tempfile::tempdir().unwrap();
    // 44 ms after the blow the mode has fallen to 8 %
    write_motions(
        folder.path(),
        Quantity::Acceleration,
        (6, 768, 1e-4),
        |_, _| {},
    );
    let refused = run(folder.path(), &sheet_in("m/s^2", "")).unwrap();
    assert!(
        refused.summary[0].contains("not decayed"),
        "{:?}",
        refused.summary
    );
    let window = r#"exponential_window: EndWeight(weight: "1 %"),"#;
    let taken = run(folder.path(), &sheet_in("m/s^2", window)).unwrap();
    assert_eq!(taken.verdict, Verdict::Answered, "{:?}", taken.summary);
    let (decay, _) = quantity(&taken, "damping added by the exponential window");
    let of = |name: &str| column(&taken, "response_struck_end", name);
    let random = of("random error of the magnitude");
    let leaks = of("systematic error by the end of the record");
    let lines = response(&taken, "accelerance");
    for ((f, value), (random, leak)) in lines.into_iter().zip(random.iter().zip(leaks)) {
        let truth = accelerance(on_axis(f) + decay);
        // 8 % of the mode under 12 % of the weight of the blow: 0.01 1/kg at 250 Hz, which is
        // stated. The noise before the blow has twelve times its weight; of 110 lines of
        // six hits none is beyond 8 errors (probability 1e-4 a line)
        let errors = (0.08 * std::f64::consts::SQRT_2 * random).hypot(0.02 * leak);
        let error = (value - truth).norm();
        assert!(error < 0.002 + errors * value.norm(), "{f} {error}");
    }

    let folder = tempfile::tempdir().unwrap();
    // 75 ms: 1.4 %, of a mode that is a fraction of the peak
    write_motions(
        folder.path(),
        Quantity::Acceleration,
        (6, 1024, 1e-4),
        |_, _| {},
    );
    let stated = run(folder.path(), &sheet_in("m/s^2", "")).unwrap();
    let warned = |text: &&String| text.contains("still moves at the end of the records");
    assert!(
        stated.warnings.iter().any(|w| warned(&w)),
        "{:?}",
        stated.warnings
    );
    let of = |name: &str| column(&stated, "response_struck_end", name);
    let leaks = of("systematic error by the end of the record");
    let random = of("random error of the magnitude");
    let mut held = 0.0;
    let lines = response(&stated, "accelerance");
    for ((f, value), (leak, random)) in lines.iter().zip(leaks.iter().zip(&random)) {
        let error = 100.0 * (value / accelerance(on_axis(*f)) - 1.0).norm();
        held += f64::from(u8::from(error < 2.0 * leak.hypot(1.41 * random)));
    }
    // twice both errors: 98 % of the lines for noise, and the leakage is told to a part of itself
    assert!(
        held > 0.95 * lines.len() as f64,
        "{held} of {}",
        lines.len()
    );
}

#[test]
fn s8_an_offset_is_taken_off_by_the_rest_and_a_line_is_not_without_a_word() {
    let folder = tempfile::tempdir().unwrap();
    write_motions(
        folder.path(),
        Quantity::Acceleration,
        (8, N, 2e-3),
        |_, samples| {
            for (mut row, offset) in samples.rows_mut().into_iter().zip([3.0, 2.0]) {
                row += offset;
            }
        },
    );
    let windows = r#"force_window: (start: "45 ms", end: "55 ms", taper: "2 ms"), exponential_window: EndWeight(weight: "10 %"),"#;
    let off_axis = |outcome: &Outcome| {
        let (decay, _) = quantity(outcome, "damping added by the exponential window");
        spread(outcome, "accelerance", |f| accelerance(on_axis(f) + decay)).0
    };
    let outcome = run(folder.path(), &sheet_in("m/s^2", windows)).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
    // 8/7 F(2, 14): 1.33, with the level at rest of 300 samples beside
    let mean = off_axis(&outcome);
    assert!(mean < 2.0, "{mean}");
    // what was the default shows what it does, and puts the result in doubt
    let nothing = format!("{windows} detrend: Nothing,");
    let outcome = run(folder.path(), &sheet_in("m/s^2", &nothing)).unwrap();
    assert!(off_axis(&outcome) > 10.0);
    assert!(
        matches!(outcome.verdict, Verdict::InDoubt { .. }),
        "{:?}",
        outcome.summary
    );
    let line = run(folder.path(), &sheet_in("m/s^2", "detrend: Line,")).unwrap();
    assert!(
        line.warnings
            .iter()
            .any(|w| w.contains("line of least squares"))
    );
}

#[test]
fn s9_windows_that_cut_the_hit_put_the_result_in_doubt() {
    let folder = tempfile::tempdir().unwrap();
    write_motions(
        folder.path(),
        Quantity::Acceleration,
        (8, N, 1e-4),
        |_, _| {},
    );
    // a third of the blow of 1 ms from 50 ms on
    let cut = r#"force_window: (start: "45 ms", end: "50.3 ms", taper: "0.1 ms"),"#;
    for choice in [cut, "window: Hann,"] {
        let outcome = run(folder.path(), &sheet_in("m/s^2", choice)).unwrap();
        let Verdict::InDoubt { reasons } = &outcome.verdict else {
            panic!("{choice}: {:?}", outcome.summary)
        };
        assert!(reasons[0].contains("change the response"), "{reasons:?}");
    }
    let wide = r#"force_window: (start: "45 ms", end: "55 ms", taper: "1 ms"),"#;
    let outcome = run(folder.path(), &sheet_in("m/s^2", wide)).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
}

#[test]
fn s11_the_odd_hit_is_named_and_left_out_by_choice() {
    let folder = tempfile::tempdir().unwrap();
    write_motions(
        folder.path(),
        Quantity::Acceleration,
        (10, N, 2e-3),
        |hit, samples| {
            if hit == 3 {
                samples.row_mut(1).mapv_inplace(|x| -x);
            }
        },
    );
    let doubted = run(folder.path(), &sheet_in("m/s^2", "")).unwrap();
    let Verdict::InDoubt { reasons } = &doubted.verdict else {
        panic!("{:?}", doubted.summary)
    };
    let [reason] = reasons.as_slice() else {
        panic!("{reasons:?}")
    };
    assert!(
        reason
            .starts_with("hit 4, hit_03.npy departs from the others: `struck end` departs by 2.00")
            && reason.contains("-1.00"),
        "{reason}"
    );
    let left_out = run(folder.path(), &sheet_in("m/s^2", "hits: (odd: LeaveOut),")).unwrap();
    assert_eq!(
        left_out.verdict,
        Verdict::Answered,
        "{:?}",
        left_out.summary
    );
    assert!((quantity(&left_out, "averages").0 - 9.0).abs() < 1e-12);
    assert!(
        left_out.log[3].reasons[0].contains("departs"),
        "{:?}",
        left_out.log[3]
    );
    let (mean, _) = spread(&left_out, "accelerance", |f| accelerance(on_axis(f)));
    // 9/8 F(2, 16), mean 1.29; the inverted hit makes some thousands
    assert!(mean < 2.5, "{mean}");
}

#[test]
fn s4_the_added_damping_goes_with_the_response_through_files_into_a_force() {
    let folder = tempfile::tempdir().unwrap();
    write_motions(
        folder.path(),
        Quantity::Acceleration,
        (6, N, 1e-4),
        |_, _| {},
    );
    let window = r#"kind: Mobility, exponential_window: TimeConstant(time: "80 ms"),"#;
    let outcome = run(folder.path(), &sheet_in("m/s^2", window)).unwrap();
    let rates = column(
        &outcome,
        "response_struck_end",
        "decay rate of the exponential window",
    );
    assert!(rates.iter().all(|rate| (rate - 12.5).abs() < 1e-12));
    fs::write(folder.path().join("frf.uff"), &outcome.attachments[0].bytes).unwrap();
    // a data set of a universal file has the rate as its z-axis
    let contents = format::read_bytes(&outcome.attachments[0].bytes).unwrap();
    let said = |field: &str| {
        let found = contents.series[0]
            .properties
            .iter()
            .find(|(name, _)| name == field);
        found
            .map(|(_, text)| text.trim().to_owned())
            .unwrap_or_default()
    };
    assert_eq!(said("uff58.z_value").parse::<f64>().unwrap(), 12.5);
    assert_eq!(said("uff58.z_label"), "decay of exp. window");
    let read = r#"Mobility(title: "again", source: File(file: "frf.uff", data_set: 1))"#;
    let again = run(folder.path(), read).unwrap();
    assert!(
        again
            .warnings
            .iter()
            .any(|w| w.contains("12.5000 1/s beside")),
        "{:?}",
        again.warnings
    );
    fs::write(
        folder.path().join("mobility.uff"),
        &again.attachments[0].bytes,
    )
    .unwrap();
    // the table as CSV, without the lines at 0 Hz
    let table = outcome
        .tables
        .iter()
        .find(|t| t.name == "response_struck_end")
        .unwrap();
    let lines = response(&outcome, "mobility");
    let mut text = "frequency [Hz],real part of mobility [m/(N s)],imaginary part of mobility [m/(N s)],decay rate of the exponential window [1/s]\n".to_owned();
    for (f, value) in lines {
        text += &format!("{f},{},{},12.5\n", value.re, value.im);
    }
    assert!(
        table
            .columns
            .iter()
            .any(|c| c.name == "decay rate of the exponential window")
    );
    fs::write(folder.path().join("table.csv"), text).unwrap();
    for file in [
        r#"file: "mobility.uff", data_set: 1"#,
        r#"file: "frf.uff", data_set: 1"#,
        r#"file: "table.csv", data_set: "real part of mobility", imaginary: "imaginary part of mobility""#,
    ] {
        let force = |rest: &str| {
            format!(
                r#"Force(title: "blow", problem: Response(path: File({file}), response: "struck end", {rest}
                record: (files: ["hit_00.npy"], sampling_rate: "8192 Hz", channels: [(name: "struck end", from: 2, unit: "m/s^2")])))"#
            )
        };
        let error = run(folder.path(), &force("")).unwrap_err();
        assert!(error.contains("grows by 12.5 1/s"), "{file}: {error}");
        let rest = r#"regularisation: Tikhonov(penalty: Curvature, parameter: GeneralisedCrossValidation), acting: (from: "48 ms", to: "53 ms"),"#;
        let outcome = run(folder.path(), &force(rest)).unwrap();
        let (impulse, error) = quantity(&outcome, "impulse");
        // a squared sine of 150 N has half its peak in the mean of its millisecond; by the lines as
        // those of the frequency axis it would be 0.089
        assert!(
            (impulse / 0.075 - 1.0).abs() < 0.02,
            "{file}: {impulse} {error:?}"
        );
    }
    // the same from the hits, the first of which is the blow, whose response is that of a velocity
    let folder = tempfile::tempdir().unwrap();
    write_motions(folder.path(), Quantity::Velocity, (7, N, 1e-3), |_, _| {});
    fs::rename(
        folder.path().join("hit_00.npy"),
        folder.path().join("blow.npy"),
    )
    .unwrap();
    let channels = r#"sampling_rate: "8192 Hz", channels: [(name: "hammer", from: 1, unit: "N"), (name: "struck end", from: 2, unit: "m/s")]"#;
    let text = format!(
        r#"Force(title: "blow", problem: Response(
            path: Hits(records: (files: ["hit_*.npy"], {channels}), force: "hammer", response: "struck end", exponential_window: "1 %"),
            record: (files: ["blow.npy"], {channels}), response: "struck end", compare_with: "hammer"))"#
    );
    let outcome = run(folder.path(), &text).unwrap();
    let (impulse, error) = quantity(&outcome, "impulse");
    assert!((impulse / 0.075 - 1.0).abs() < 0.02, "{impulse} {error:?}");
}

/// Forces on both masses and the acceleration of the struck one, in volts of 2 mV/N and 100 mV/g
/// with noise of 30 mV, of the forces a tenth of that; the forces rest in the first `silent`
/// samples, and the second is `other` times its own. The forces are random cubic splines with a
/// knot every eighth sample: their power above half the sampling rate, which no recorder would let
/// in, is below 1e-9 of that in the band (forces linear between knots leave 1e-5, and an error of
/// 0.3 % in |H| that no stated error contains).
fn shaken(path: &Path, n: usize, silent: usize, other: f64, seed: u64) {
    const KNOTS: usize = 8;
    const STEPS: usize = 8;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut numbers = [0, 1].map(|_| {
        (0..n / KNOTS + 5)
            .map(|_| 60.0 * normal())
            .collect::<Vec<f64>>()
    });
    for numbers in &mut numbers {
        numbers[..silent.div_ceil(KNOTS) + 3].fill(0.0);
    }
    // the shakers hear each other
    let forces = |t: f64| {
        let place = t * RATE / KNOTS as f64;
        let (knot, u) = (place as usize, place.fract());
        let weights = [
            (1.0 - u).powi(3),
            4.0 - 6.0 * u * u + 3.0 * u.powi(3),
            1.0 + 3.0 * (u + u * u - u.powi(3)),
            u.powi(3),
        ];
        let at = |k: usize| {
            let knots = weights.iter().zip(&numbers[k][knot..]);
            knots
                .map(|(weight, number)| weight * number / 6.0)
                .sum::<f64>()
        };
        [at(0), other * (at(1) + 0.5 * at(0))]
    };
    let (stiffness, damping) = spring();
    let rates = |t: f64, [q, p]: [f64; 2]| {
        let [one, two] = forces(t);
        let tension = stiffness * q + damping * p;
        [
            p,
            one / STRUCK - two / OTHER - tension * MASS / (STRUCK * OTHER),
        ]
    };
    let h = 1.0 / RATE / STEPS as f64;
    let mut state = [0.0; 2];
    let mut volts = Array2::zeros((3, n));
    for k in 0..n {
        let start = k as f64 / RATE;
        let tension = stiffness * state[0] + damping * state[1];
        let [one, two] = forces(start);
        let acceleration = (one - tension) / STRUCK;
        for (row, value) in [2e-3 * one, 2e-3 * two, 0.1 / 9.80665 * acceleration]
            .into_iter()
            .enumerate()
        {
            volts[[row, k]] = value + 3e-2 * if row == 2 { normal() } else { 0.1 * normal() };
        }
        for step in 0..STEPS {
            let t = start + step as f64 * h;
            let moved = |k: [f64; 2], by: f64| [state[0] + by * k[0], state[1] + by * k[1]];
            let k1 = rates(t, state);
            let k2 = rates(t + h / 2.0, moved(k1, h / 2.0));
            let k3 = rates(t + h / 2.0, moved(k2, h / 2.0));
            let k4 = rates(t + h, moved(k3, h));
            for i in 0..2 {
                state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
    }
    let channels =
        ["one", "two", "acceleration"].map(|name| Channel::new(name, Quantity::Voltage).unwrap());
    let record = Record::new(
        volts,
        RATE,
        0.0,
        channels.to_vec(),
        Provenance::computed("shakers"),
    );
    write(path, &record.unwrap());
}

fn shaken_sheet(rest: &str) -> String {
    format!(
        r#"Frf(title: "Shakers", records: (files: ["*.npy"], sampling_rate: "8192 Hz", channels: [
            (name: "shaker", from: 1, unit: "V", sensitivity: "2 mV/N"),
            (name: "other shaker", from: 2, unit: "V", sensitivity: "2 mV/N"),
            (name: "struck end", from: 3, unit: "V", sensitivity: "100 mV/g"),
        ]), input: "shaker", outputs: ["struck end"], band: (from: "50 Hz", to: "450 Hz"), {rest})"#
    )
}

/// Lines of the table within two standard errors of the truth, that by the width of the lines
/// included, in magnitude and phase, and the number of lines.
fn within_two(
    outcome: &Outcome,
    table: &str,
    truth: impl Fn(Complex64) -> Complex64,
) -> [usize; 3] {
    let of = |name: &str| column(outcome, table, name);
    let (frequency, magnitude, phase) =
        (of("frequency"), of("magnitude of accelerance"), of("phase"));
    let errors = [
        of("random error of the magnitude"),
        of("random error of the phase"),
    ];
    let width = of("systematic error by the width of the lines");
    let mut found = [0, 0, frequency.len()];
    for line in 0..frequency.len() {
        let truth = truth(Complex64::new(0.0, TAU * frequency[line]));
        let off = (Complex64::from_polar(magnitude[line], phase[line].to_radians()) / truth).ln();
        let width = width[line] / 100.0;
        let limits =
            [errors[0][line] / 100.0, errors[1][line].to_radians()].map(|e| 2.0 * e.hypot(width));
        found[0] += usize::from(off.re.abs() < limits[0]);
        found[1] += usize::from(off.im.abs() < limits[1]);
    }
    found
}

/// Accelerance of the struck mass for a force on the other one, closed form.
fn across(s: Complex64) -> Complex64 {
    let (stiffness, damping) = spring();
    let z = stiffness + damping * s;
    z / (STRUCK * OTHER * s * s + MASS * z)
}

#[test]
fn s14_long_random_records_give_the_response_of_the_body() {
    let folder = tempfile::tempdir().unwrap();
    let silent = 4096;
    for (name, seed) in [("a.npy", 1), ("b.npy", 2)] {
        shaken(
            &folder.path().join(name),
            10 * 8192 + silent,
            silent,
            0.0,
            seed,
        );
    }
    let sheet = shaken_sheet(r#"segments: (length: "1 s"), silent: "0.49 s","#);
    let outcome = run(folder.path(), &sheet).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.warnings);
    let table = "response_struck_end";
    let [magnitude, phase, lines] = within_two(&outcome, table, accelerance);
    println!("{magnitude} {phase} of {lines}");
    // 95.45 % for so many averages: 401 lines, of which a third are independent under a Hann
    // window, three standard errors of 1.8 %
    assert!(magnitude as f64 > 0.90 * lines as f64 && phase as f64 > 0.90 * lines as f64);
    // of 19 half-overlapped segments in each record, and two degrees for each independent one but
    // the first
    let (averages, _) = quantity(&outcome, "averages");
    assert!((averages - 38.0).abs() < 1e-12, "{averages}");
    let freedom = column(&outcome, table, "degrees of freedom of the errors");
    assert!((60.0..74.0).contains(&freedom[0]), "{}", freedom[0]);
    // (3 mV)^2 over 4096 Hz against (65 mV)^2 over some 500 Hz: 0.026 %, several times that where
    // the force happens to have less
    let bias = column(&outcome, table, "bias of the magnitude by noise at rest");
    assert!(bias.iter().all(|b| (-0.3..0.0).contains(b)), "{bias:?}");
    let mean = bias.iter().sum::<f64>() / bias.len() as f64;
    assert!((-0.05..-0.015).contains(&mean), "{mean}");
    let width = column(
        &outcome,
        table,
        "systematic error by the width of the lines",
    );
    assert!(width.iter().all(|e| e.is_finite()));
    assert!(
        words(&outcome, table, "validity")
            .iter()
            .filter(|w| *w == "valid")
            .count()
            > 390
    );
}

#[test]
fn s14_inputs_that_act_together_have_a_response_each() {
    let folder = tempfile::tempdir().unwrap();
    shaken(&folder.path().join("a.npy"), 20 * 8192, 0, 1.0, 3);
    let both =
        r#"segments: (length: "8192 samples", overlap: "60 %"), further_inputs: ["other shaker"],"#;
    let outcome = run(folder.path(), &shaken_sheet(both)).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.warnings);
    for (table, truth) in [
        (
            "response_struck_end_over_shaker",
            accelerance as fn(Complex64) -> Complex64,
        ),
        ("response_struck_end_over_other_shaker", across),
    ] {
        let [magnitude, phase, lines] = within_two(&outcome, table, truth);
        println!("{table}: {magnitude} {phase} of {lines}");
        assert!(
            magnitude as f64 > 0.90 * lines as f64 && phase as f64 > 0.90 * lines as f64,
            "{table}"
        );
        let multiple = column(&outcome, table, "multiple coherence");
        let partial = column(&outcome, table, "partial coherence");
        assert!(
            multiple
                .iter()
                .zip(&partial)
                .all(|(all, one)| *all >= one - 1e-12)
        );
        assert!(multiple.iter().sum::<f64>() > 0.9 * lines as f64);
    }
    // without the second the first carries its part: not coherent, and wrong
    let alone = run(
        folder.path(),
        &shaken_sheet(r#"segments: (length: "8192 samples"),"#),
    )
    .unwrap();
    let coherence = column(&alone, "response_struck_end", "coherence");
    assert!(coherence.iter().sum::<f64>() < 0.9 * coherence.len() as f64);
    for (rest, expected) in [
        (
            r#"further_inputs: ["other shaker"],"#,
            "further_inputs is other shaker, expected none with hits",
        ),
        (
            r#"segments: (length: "1 s"), further_inputs: ["shaker"],"#,
            "further_inputs[0] is `shaker`, expected every input once",
        ),
        (
            r#"segments: (length: "1 s"), further_inputs: ["other shaker"], estimator: H2,"#,
            "estimator is H2, expected H1",
        ),
        (
            r#"segments: (length: "1001 samples"),"#,
            "segments.length is 1001 samples, expected an even number",
        ),
        (
            r#"segments: (length: "1 s", overlap: "100 %"),"#,
            "segments.overlap is 100 %, expected a part",
        ),
        (
            r#"segments: (length: "1 s"), hits: (odd: LeaveOut),"#,
            "hits is stated beside `segments`",
        ),
        (
            r#"segments: (length: "21 s"),"#,
            "the record to be cut into segments has 163840 samples, expected at least 172032",
        ),
    ] {
        let said = run(folder.path(), &shaken_sheet(rest)).unwrap_err();
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn s14_hits_of_unequal_length_are_continued_by_rest() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 4, 1e-3, NOISE);
    let cut = |n: usize, name: &str, seed: u64| {
        let history = history(n, |t| blow(t - ONSET, 180.0, 1e-3));
        write(&folder.path().join(name), &recorded(&history, NOISE, seed));
    };
    cut(3000, "hit_8.npy", 18);
    let outcome = run(folder.path(), &sheet_of("*.npy", BAND)).unwrap();
    assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.warnings);
    let said: Vec<_> = outcome
        .settings
        .iter()
        .filter(|s| s.name.contains("continued by rest"))
        .collect();
    assert_eq!(said.len(), 1);
    assert_eq!(
        (said[0].name.as_str(), said[0].value.as_str()),
        ("hits: hits continued by rest to 4096 samples", "5")
    );
    let (mean, _) = spread(&outcome, "accelerance", |f| accelerance(on_axis(f)));
    // five hits: F(2, 8), mean 4/3
    assert!((0.9..2.0).contains(&mean), "{mean}");
    // at sample 1100 the mode has fallen to a hundredth, three thousandths of the peak: the checks
    // pass, rest it is not
    cut(1100, "hit_9.npy", 19);
    let moving = run(folder.path(), &sheet_of("*.npy", BAND)).unwrap_err();
    assert!(
        moving.contains("hits: hit 6, hit_9.npy is 1100 samples, and `struck end` is")
            && moving.contains("expected 4096 samples as the longest hit, or a hit that has come to rest and is continued so"),
        "{moving}"
    );
}

#[test]
fn s14_a_hysteresis_beyond_the_signal_is_told() {
    let folder = tempfile::tempdir().unwrap();
    write_hits(folder.path(), 1, 1e-3, NOISE);
    let sheet = sheet_of(
        "*.npy",
        r#"hits: (cut: Trigger(level: "20 N", hysteresis: "300 N", pre_trigger: "10 ms", length: "2048 samples")),"#,
    );
    let Verdict::NotAllowed { reason } = run(folder.path(), &sheet).unwrap().verdict else {
        panic!("a hit without a trigger");
    };
    insta::assert_snapshot!(reason, @"no hit is found, as hit 1, hit_0.npy: not triggered: `hammer` is never on the other side of 20.00 by the hysteresis of 300.0 before it passes, it lies between -0.334 and 147.9");
}
