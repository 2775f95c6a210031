//! Chains of evaluations: a bar is measured with one shot, its law with errors is written to a
//! file, and a specimen is tested between two bars of this material. Striker, waves, gauges,
//! converters and their errors are simulated, so that the true values are known.

use std::fs;
use std::sync::atomic::AtomicBool;

use labio::Ordinate;
use labio::format::read_bytes_at;
use num_complex::Complex64;
use rodlab::job::Silent;
use rodlab::outcome::Verdict;
use rodlab::output::TableFiles;
use rodlab::{Outcome, RodlabError};
use rodwave::inelastic::{Elastic, MaxwellNorton};
use rodwave::line::Segment;
use testbed::hopkinson::{HopkinsonRig, HopkinsonTruth, RecorderErrors};
use testbed::long_bar::LongBar;
use testbed::noise::Noise;

use crate::runs::{Folder, Refused, Words, column, doubts, path_of_example, write_columns};

const RATE: f64 = 1e6;
const LENGTH: f64 = 0.006;
const DIAMETER: f64 = 0.014;
/// Standard uncertainties of the laboratory: of a gauge factor (relative), of a position \[m\], and
/// of a density from a data sheet \[kg/m³\].
const GAUGE_FACTOR: f64 = 0.005;
const POSITION: f64 = 1e-3;
const DENSITY: f64 = 25.0;

/// A valid file of a measured material.
const GOOD: &str = r#"{"format": "rodlab material 1", "title": "bar", "law": "Zener",
    "parameters": [{"name": "relaxed modulus", "unit": "Pa", "value": 2.6e9}, {"name": "relaxation strength", "unit": "Pa", "value": 4e8},
        {"name": "relaxation time", "unit": "s", "value": 2e-5}],
    "density": 1150.0, "band_hz": [500.0, 9000.0], "errors": [{"source": "noise 1", "density": 0.0, "parameters": [1e-3, 0.0, 0.0]}],
    "doubts": [], "inputs": []}"#;

/// Bar whose law is measured; its material is the polyamide of [`HopkinsonRig::nylon`].
fn long_bar() -> LongBar {
    let modulus = |s: Complex64| {
        let branch = |modulus: f64, time: f64| modulus * s * time / (1.0 + s * time);
        2.6e9 + branch(0.2e9, 8e-6) + branch(0.2e9, 60e-6)
    };
    LongBar {
        modulus,
        density: 1150.0,
        pulse: [30e-6, 120e-6, 40e-6],
        ..LongBar::glassy()
    }
}

/// Runs a sheet and writes its attachments to the folder.
fn run(folder: &Folder, text: &str) -> Result<Outcome, RodlabError> {
    folder.run(text).inspect(|outcome| folder.keep(outcome))
}

/// Measures the bar; the stated positions differ from the true ones by random errors of the
/// laboratory.
fn measure_bar(folder: &Folder, density: f64, noise: &mut Noise, seed: u64) -> Outcome {
    write_columns(
        &folder.file("bar.csv"),
        &long_bar().shot(&[1.0, 1.02], seed),
    );
    let mut placed = |x: f64| 1e3 * (x + POSITION * noise.normal());
    let (first, second) = (placed(1.6), placed(2.0));
    let text = format!(
        r#"Modulus(
    title: "Nylon bar",
    specimen: (diameter: "20 mm", density: "{density} kg/m3 ± {DENSITY} kg/m3"),
    lateral_inertia: (poisson_ratio: "0"),
    method: MultiPoint(gauges: [(channel: "g1", at: "{first} mm ± 1 mm"), (channel: "g2", at: "{second} mm ± 1 mm")], free_end_at: "2500 mm"),
    source: Hits(
        records: (files: ["bar.csv"], sampling_rate: "250 kHz", channels: [
            (name: "g1", from: 1, unit: "strain"),
            (name: "g2", from: 2, unit: "strain", sensitivity: "1 ± 3 %"),
        ]),
        silent: "0.9 ms",
    ),
    band: (from: "700 Hz", to: "15 kHz"),
    limits: (loss_factor: "100 %"),
    laws: (laws: [ConstantQ, FractionalZener, GeneralisedMaxwell]),
)"#
    );
    run(folder, &text).unwrap()
}

fn specimen() -> Segment {
    let area = 0.25 * std::f64::consts::PI * DIAMETER * DIAMETER;
    let law = MaxwellNorton::from_reference_rate(15.0, 500.0, 15e6).unwrap();
    let specimen = Segment::new(LENGTH, area, 1200.0).unwrap();
    let specimen = specimen.with_branch(2e9, law).unwrap();
    specimen.with_branch(60e6, Elastic).unwrap()
}

/// Tests the specimen with bars of `material`.
fn test_specimen(
    folder: &Folder,
    truth: &HopkinsonTruth,
    material: &str,
    noise: &mut Noise,
    seed: u64,
) -> Result<Outcome, RodlabError> {
    let mut gain = || vec![1.0 + GAUGE_FACTOR * noise.normal()];
    let errors = RecorderErrors {
        gains: [gain(), gain()],
        delays: [0.0; 2],
        noise: 4e-6,
        converter_step: 2e-6,
    };
    let [mut first, mut second] = truth.recorded(RATE, &errors, seed);
    let strains = [first.remove(0), second.remove(0)];
    write_columns(&folder.file("shot.csv"), &strains);
    let mut placed = |x: f64| 1e3 * (x + POSITION * noise.normal());
    let (near, far) = (placed(0.7), placed(0.3));
    let text = format!(
        r#"Shpb(
    title: "Specimen between nylon bars",
    loading: Compression,
    materials: {{"nylon": {material}}},
    bars: (
        incident: (waves: Material("nylon"), diameter: "20 mm", length: "1800 mm", gauges: [(channel: "incident", at: "{near} mm ± 1 mm")]),
        transmitted: (waves: Material("nylon"), diameter: "20 mm", length: "1600 mm", gauges: [(channel: "transmitted", at: "{far} mm ± 1 mm")]),
    ),
    specimen: (length: "6 mm", diameter: "14 mm"),
    records: [(
        files: ["shot.csv"],
        sampling_rate: "1 MHz",
        channels: [
            (name: "incident", from: 1, unit: "strain", sensitivity: "1 ± 0.5 %"),
            (name: "transmitted", from: 2, unit: "strain", sensitivity: "1 ± 0.5 %"),
        ],
    )],
    silent: "250 us",
)"#
    );
    run(folder, &text)
}

/// Numbers of stresses and of strains inside their 95 % bands, and of all compared values, at
/// tenths of the duration of the result.
fn inside(outcome: &Outcome, truth: &HopkinsonTruth) -> [usize; 3] {
    let area = 0.25 * std::f64::consts::PI * DIAMETER * DIAMETER;
    let time = column(outcome, "stress_strain", "time");
    let strain = truth.strain(LENGTH);
    let mut found = [0; 3];
    for at in (1..9).map(|part| part * time.len() / 10) {
        let seen = |history: &[f64]| truth.seen(history, RATE, 1e-6 * time[at]);
        let stress = 0.5e-6 * (seen(&truth.force[0]) + seen(&truth.force[1])) / area;
        found[2] += 1;
        let exact = [("stress", stress), ("strain", seen(&strain))];
        for (inside, (name, exact)) in found.iter_mut().zip(exact) {
            let half = format!("95 % half width of the {name}");
            let off = column(outcome, "stress_strain", name)[at] - exact;
            let half = column(outcome, "stress_strain", &half)[at];
            *inside += usize::from(off.abs() <= half);
        }
    }
    found
}

/// Several laboratories measure their bar and then test a specimen with it.
#[test]
fn chain_from_a_measured_bar_to_a_curve_covers() {
    let truth = HopkinsonRig {
        step: 0.5e-6,
        after: 3.2e-3,
        ..HopkinsonRig::nylon().unwrap()
    }
    .shot(Some(specimen()))
    .unwrap();
    let seeds = testbed::noise::draws(12);
    let (mut sum, mut exact, mut doubts) = ([0; 3], [0; 3], 0);
    for seed in 0..seeds {
        let folder = Folder::new();
        let mut noise = Noise::seeded(700 + seed);
        let density = 1150.0 + DENSITY * noise.normal();
        let bar = measure_bar(&folder, density, &mut noise, seed);
        assert_eq!(bar.verdict, Verdict::Answered, "{:?}", bar.summary);
        // the same file without errors, so that the law is assumed exact
        let text = folder.read("material.json");
        let start = text.find("\"errors\": [").unwrap();
        let end = text.find("\"doubts\"").unwrap();
        let without = format!("{}\"errors\": [], {}", &text[..start], &text[end..]);
        folder.write("exact.json", without);
        for (file, sum) in [("material.json", &mut sum), ("exact.json", &mut exact)] {
            let material = format!("(law: Result({file:?}))");
            let mut noise = Noise::seeded(900 + seed);
            let shot = test_specimen(&folder, &truth, &material, &mut noise, seed).unwrap();
            doubts += usize::from(shot.verdict != Verdict::Answered);
            for (sum, n) in sum.iter_mut().zip(inside(&shot, &truth)) {
                *sum += n;
            }
        }
    }
    println!("covered {sum:?}, without the errors of the law {exact:?}, {doubts} in doubt");
    let part = |n: usize| n as f64 / sum[2] as f64;
    // tolerance: errors are common to all times of a shot, so that the fraction inside scatters by
    // 6 % for 12 laboratories
    assert!(part(sum[0]) > 0.8 && part(sum[1]) > 0.8, "{sum:?}");
    // without the errors of the law, which include that of the density, the band is too narrow and
    // contains the true stress less often
    assert!(part(exact[0]) < part(sum[0]) - 0.05, "{exact:?}");
    assert!(doubts <= 1 + seeds as usize / 10, "{doubts}");
}

/// Force \[N\] at a time \[s\] when a mass of 2 kg strikes a long rod of the true material at 3
/// m/s, after a Gaussian low-pass of 10 kHz: $`m s V - m v_0 = -Z V`$ on the imaginary axis.
fn force_at(time: f64) -> f64 {
    const STEP: f64 = std::f64::consts::TAU * 4.0;
    let area = 0.25 * std::f64::consts::PI * 0.02 * 0.02;
    let lines = (0..15_000).map(|line| {
        let omega = STEP * (f64::from(line) + 0.5);
        let s = Complex64::new(0.0, omega);
        let impedance = area * (1150.0 * (long_bar().modulus)(s)).sqrt();
        let force = 2.0 * 3.0 * impedance / (2.0 * s + impedance);
        let part = omega / (std::f64::consts::TAU * 10e3);
        let low_pass = (-0.5 * std::f64::consts::LN_2 * part * part).exp();
        (low_pass * force * (s * time).exp()).re
    });
    lines.sum::<f64>() * STEP / std::f64::consts::PI
}

/// A striker hits a rod of the measured material: the band of the predicted force contains the true
/// force.
#[test]
fn chain_from_a_measured_bar_to_a_force_covers() {
    let times: Vec<f64> = (1..=8).map(|k| 0.25e-3 * f64::from(k)).collect();
    let exact: Vec<f64> = times.iter().map(|time| force_at(*time)).collect();
    let seeds = testbed::noise::draws(12);
    let (mut inside, mut all, mut worst) = (0, 0, 0.0_f64);
    for seed in 0..seeds {
        let folder = Folder::new();
        let mut noise = Noise::seeded(700 + seed);
        let density = 1150.0 + DENSITY * noise.normal();
        measure_bar(&folder, density, &mut noise, seed);
        let diameter = 20.0 * (1.0 + 2e-3 * noise.normal());
        let text = format!(
            r#"Force(
    title: "Striker on a rod of nylon",
    materials: {{"nylon": (law: Result("material.json"))}},
    problem: Impact(
        first: RigidMass("2 kg"),
        second: LongRod(material: "nylon", diameter: "{diameter} mm ± 0.2 %"),
        velocity: "3 m/s",
        duration: "2.5 ms",
        band: "10 kHz",
        uncertainty: (draws: 60),
    ),
)"#
        );
        let outcome = run(&folder, &text).unwrap();
        let of = |name: &str| column(&outcome, "force_in_band", name);
        let time = of("time");
        for (at, exact) in times.iter().zip(&exact) {
            let after = time.partition_point(|t| t < at);
            let part = (at - time[after - 1]) / (time[after] - time[after - 1]);
            let between =
                |values: &[f64]| values[after - 1] + part * (values[after] - values[after - 1]);
            let z = (between(of("force in the band")) - exact)
                / between(of("standard error of the force"));
            worst = worst.max(z.abs());
            all += 1;
            inside += usize::from(z.abs() <= 1.96);
        }
    }
    println!("force: {inside} of {all} covered, at worst {worst:.2} standard errors");
    assert!(inside as f64 > 0.8 * f64::from(all), "{inside} of {all}");
}

/// Material files with mistakes are refused, and so are jobs that cannot use a material file.
#[test]
fn chain_names_what_is_wrong() {
    let folder = Folder::new();
    let with = |material: &str| {
        let text = format!(
            r#"Force(title: "x", materials: {{"nylon": {material}}}, problem: Impact(
                first: RigidMass("2 kg"), second: LongRod(material: "nylon", diameter: "20 mm"), velocity: "3 m/s", duration: "1 ms",
                uncertainty: (draws: 30)))"#
        );
        run(&folder, &text)
    };
    let file = |text: &str| {
        folder.write("material.json", text);
        with(r#"(law: Result("material.json"))"#)
    };
    assert_eq!(file(GOOD).unwrap().verdict, Verdict::Answered);
    let doubt = GOOD.replace(
        r#""doubts": []"#,
        r#""doubts": ["the residuals are no noise"]"#,
    );
    doubts(&file(&doubt).unwrap())[0].must_say("the residuals are no noise");
    for (found, expected, said) in [
        (
            "rodlab material 1",
            "rodlab material 7",
            "format `rodlab material 7`",
        ),
        ("Zener", "Zenner", "one of `elastic`"),
        ("2.6e9", "-2.6e9", "-2600000000"),
        ("1150.0", "-1150.0", "density -1150"),
        ("[500.0, 9000.0]", "[9000.0, 500.0]", "an increasing band"),
        ("[1e-3, 0.0, 0.0]", "[1e-3, 0.0]", "2"),
        ("\"title\": \"bar\",", "", "missing field `title`"),
        ("2e-5}", "2e-5", "line 3"),
    ] {
        let refused = file(&GOOD.replace(found, expected)).refused();
        refused.must_say(said);
    }
    let other = with(r#"(law: Result("other.json"))"#);
    other.refused().must_say("other.json");
    folder.write("material.json", GOOD);
    for (material, said) in [
        (
            r#"(density: "1150 kg/m3", law: Result("material.json"))"#,
            "no density",
        ),
        (r#"(law: Elastic(modulus: "3 GPa"))"#, "no density"),
    ] {
        with(material).refused().must_say(said);
    }
    let computed = r#"Mobility(title: "x", materials: {"nylon": (law: Result("material.json"))},
        source: Computed(body: LongRod(material: "nylon", diameter: "20 mm"), up_to: "10 kHz", lines: 100))"#;
    let refused = run(&folder, computed).refused();
    refused.must_say("does not propagate the errors of a result");
}

/// A virtual test of a measured material equals that of the same law stated in the sheet, computed
/// in the frequency domain or by time marching; its report states that the errors of the material
/// are not included.
#[test]
fn chain_material_in_a_virtual_test_is_its_law() {
    let folder = Folder::new();
    folder.write("material.json", GOOD);
    let by_lines = r#"EndAccelerations(material: "nylon", length: "0.4 m", diameter: "16 mm",
        blows: (hits: 1, peak: "100 N", duration: "80 us"))"#;
    let by_march = r#"HopkinsonBars(
        striker: (length: "350 mm", diameter: "20 mm", density: "1150 kg/m3", modulus: "2.9 GPa"), velocity: "12 m/s",
        incident: (material: "nylon", diameter: "20 mm", length: "1800 mm", gauges: ["900 mm"]),
        transmitted: (material: "nylon", diameter: "20 mm", length: "1600 mm", gauges: ["400 mm"]),
        specimen: (length: "6 mm", diameter: "14 mm", density: "1100 kg/m3", modulus: "1.2 GPa",
            law: Norton(exponent: "4", rate_at_10_mpa: "8 1/s")))"#;
    let records = |outcome: &Outcome| -> Vec<f64> {
        let files = outcome.attachments.iter();
        let shots = files.filter(|file| file.name.ends_with(".npy"));
        let series = shots.flat_map(|file| read_bytes_at(&file.bytes, 65536.0).unwrap().series);
        let numbers = series.flat_map(|series| match series.ordinate {
            Ordinate::Real(values) => values,
            Ordinate::Complex(_) => panic!("a history"),
        });
        numbers.collect()
    };
    for experiment in [by_lines, by_march] {
        let made = |material: &str| {
            let text = format!(
                r#"Simulate(title: "x", materials: {{"nylon": {material}}}, experiment: {experiment},
                    output: "shot.npy", instrument: (sampling_rate: "65536 Hz", length: "31.25 ms"))"#
            );
            run(&folder, &text).unwrap()
        };
        let measured = made(r#"(law: Result("material.json"))"#);
        let stated = made(
            r#"(density: "1150 kg/m3", law: Zener(relaxed: "2.6 GPa", unrelaxed: "3 GPa", relaxation_time: "20 us"))"#,
        );
        let said = "measured from 500 Hz to 9 kHz: the virtual test does not include its errors";
        measured.summary.must_say(said);
        assert_eq!(measured.inputs.len(), 1);
        let (measured, stated) = (records(&measured), records(&stated));
        let largest = stated.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(largest > 0.0 && measured.len() == stated.len());
        for (a, b) in measured.iter().zip(&stated) {
            // the parameters are converted to logarithms and back
            assert!((a - b).abs() < 1e-9 * largest, "{a} {b}");
        }
    }
}

/// Verification of a force on a measured bar names the changed files of its result and of the
/// result for the bar.
#[test]
fn chain_of_results_is_verified() {
    let folder = Folder::new();
    for file in ["modulus.ron", "striker.ron", "shot-1.npy"] {
        let example = path_of_example("polymer_bar");
        fs::copy(example.join(file), folder.file(file)).unwrap();
    }
    let results = ["modulus", "striker"].map(|name| {
        let result = folder.file(format!("{name}-result"));
        let sheet = folder.file(format!("{name}.ron"));
        let go_on = AtomicBool::new(false);
        rodlab::finished::finish(
            &sheet,
            None,
            &result,
            TableFiles::default(),
            &Silent,
            &go_on,
        )
        .unwrap();
        result
    });
    let verify = || rodlab::verify::verify(&results[1], None).unwrap();
    let found = verify();
    assert!(found.is_as_it_was(), "{:?}", found.in_words());
    assert!(found.compared > 5 && found.ancestors[0].compared > 8);
    let all = rodlab::verify::verify_all(folder.path(), Some(folder.path())).unwrap();
    assert!(all.len() == 2 && all.iter().all(|one| one.is_as_it_was()));
    // the record of the bar was edited, one result was edited by hand, and a sheet is gone
    let mut bytes = folder.bytes("shot-1.npy");
    *bytes.last_mut().unwrap() ^= 1;
    folder.write("shot-1.npy", bytes);
    let found = verify();
    assert!(!found.is_as_it_was() && found.changed.is_empty());
    let edited = "the input shot-1.npy has changed";
    assert_eq!(found.ancestors[0].changed, [edited]);
    fs::write(results[1].join("force.csv"), "0,0").unwrap();
    fs::remove_file(folder.file("striker.ron")).unwrap();
    assert_eq!(
        verify().changed,
        [
            "the sheet striker.ron is missing (if it is in another folder, state `--sheets FOLDER`)",
            "its file force.csv has changed"
        ]
    );
    assert!(rodlab::verify::verify(folder.path(), None).is_err());
}
