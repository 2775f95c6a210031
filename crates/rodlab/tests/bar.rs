//! `rodlab bar`: waves of a long bar from virtual shots with a known law, and common mistakes of
//! laboratories.

use std::f64::consts::TAU;
use std::path::Path;

use num_complex::Complex64;
use rodlab::Outcome;
use rodlab::outcome::Verdict;
use rodlab::templates::JobName;
use testbed::long_bar::LongBar;

use crate::runs::{Folder, Words, attachments_of, column, figures_of, words, write_columns};

/// A bar with gauges 900 and 500 mm before the free end and a quiet recorder; a pulse of 2 ms
/// overlaps with its reflections.
fn long_pulse() -> LongBar {
    LongBar {
        noise: 1e-4,
        bits: 16,
        ..LongBar::glassy()
    }
}

/// A bar with one gauge 900 mm before the end: the reflection arrives after 1.27 ms, and the pulse
/// lasts 0.3 ms.
fn short_pulse() -> LongBar {
    LongBar {
        pulse: [60e-6, 150e-6, 90e-6],
        gauges: vec![1.6],
        ..long_pulse()
    }
}

fn write(folder: &Path, rows: &[Vec<f64>]) {
    write_columns(&folder.join("shot.csv"), rows);
}

/// The template adapted to these records: their waves are one-dimensional, and only the gauge
/// factors are uncertain.
fn two_gauges() -> String {
    let text = JobName::Bar.template(rodlab::sheet::Language::Ron);
    let changes = [
        ("shot.npy", "shot.csv"),
        ("500 kHz", "250 kHz"),
        (" ± 0.5 mm", ""),
        (" ± 1 kg/m3", ""),
        ("0.37 ± 0.02", "0"),
        (
            "from: \"500 Hz\", to: \"20 kHz\"",
            "from: \"700 Hz\", to: \"12 kHz\"",
        ),
    ];
    changes
        .iter()
        .fold(text.to_owned(), |text, (from, to)| text.replace(from, to))
}

fn one_gauge() -> String {
    let text = two_gauges().replace("(channel: \"gauge 2\", from_free_end: \"500 mm\"),", "");
    let text = text.replace(
        "(name: \"gauge 2\", from: 2, unit: \"strain\", sensitivity: \"1 ± 3 %\"),",
        "",
    );
    text.replace("// wave_speed", "wave_speed")
        .replace("to: \"12 kHz\"", "to: \"8 kHz\"")
}

fn numbers<'a>(outcome: &'a Outcome, name: &str) -> &'a [f64] {
    column(outcome, "propagation", name)
}

/// Numbers of valid lines, and of those outside the 95 % bands of damping coefficient and phase
/// velocity.
fn outside(outcome: &Outcome, bar: &LongBar) -> [usize; 3] {
    let words = words(outcome, "propagation", "validity");
    let mut found = [0; 3];
    for line in (0..words.len()).filter(|line| words[*line] == "valid") {
        let s = Complex64::new(0.0, TAU * numbers(outcome, "frequency")[line]);
        let exact = s * (bar.density / (bar.modulus)(s)).sqrt();
        let is_outside = |name: &str, exact: f64| {
            let half = numbers(outcome, &format!("95 % half width of the {name}"))[line];
            usize::from((numbers(outcome, name)[line] - exact).abs() > half)
        };
        found[0] += 1;
        found[1] += is_outside("damping coefficient", exact.re);
        found[2] += is_outside("phase velocity", s.im / exact.im);
    }
    found
}

/// Residual of the model at a gauge [%].
fn misfit(outcome: &Outcome) -> f64 {
    let mut quantities = outcome.quantities.iter();
    let found = quantities.find(|q| q.name.contains("that the model does not explain"));
    found.unwrap().value.unwrap()
}

/// The record ends while the bar rings: an exponential window is applied, and the noise of
/// neighbouring lines is correlated. If the residuals were treated as independent, the true law
/// would be rejected in most shots; by chance it is rejected in one of a hundred.
#[test]
fn the_true_law_explains_damped_lines() {
    let bar = LongBar {
        noise: 1e-3,
        ..short_pulse()
    };
    let text = one_gauge();
    let two = LongBar {
        gauges: vec![1.6, 2.0],
        ..bar.clone()
    };
    for (bar, text, gains) in [
        (bar, text, vec![1.0]),
        (two, two_gauges(), vec![1.0, 1.025]),
    ] {
        let rejected = (0..6).filter(|seed| {
            let folder = Folder::new();
            write(folder.path(), &bar.shot(&gains, *seed));
            let warnings = folder.run(&text).unwrap().warnings;
            warnings.join("; ").contains("are not noise")
        });
        assert!(rejected.count() <= 1);
    }
}

#[test]
fn waves_of_a_bar_are_found_by_two_gauges_or_one() {
    for (bar, text, gains) in [
        (long_pulse(), two_gauges(), vec![1.0, 1.025]),
        (short_pulse(), one_gauge(), vec![1.0]),
    ] {
        let mut counts = [0; 3];
        for seed in 0..6 {
            let folder = Folder::new();
            write(folder.path(), &bar.shot(&gains, seed));
            let outcome = folder.run(&text).unwrap();
            assert_eq!(outcome.job, "bar");
            if seed == 0 {
                assert_eq!(outcome.verdict, Verdict::Answered, "{:?}", outcome.summary);
                outcome.summary[1].must_begin("Waves at ");
                // settings are named as in a sheet for `bar`, and each occurs once
                let speeds = outcome.settings.iter().filter(|s| s.name == "wave_speed");
                let speeds: Vec<&str> = speeds.map(|s| s.value.as_str()).collect();
                let stated = gains.len() == 1;
                assert_eq!(speeds, [if stated { "1400 m/s" } else { "searched" }]);
                for setting in &outcome.settings {
                    let of_a_modulus = ["method", "source", "specimen", "lateral_inertia"];
                    let first = setting.name.split('.').next();
                    assert!(!of_a_modulus.contains(&first.unwrap()), "{setting:?}");
                }
                attachments_of(&outcome).must_say("material.json");
                let figures = ["propagation", "passages", "separated_waves", "model"];
                figures_of(&outcome).must_say_all(&figures);
            }
            // tolerance: the residual contains noise of 0.01 % of the peak and the invalid lines
            // between valid ones
            let left = misfit(&outcome);
            println!("{left}");
            assert!(left < 2.0, "{left}");
            for (sum, found) in counts.iter_mut().zip(outside(&outcome, &bar)) {
                *sum += found;
            }
        }
        println!("{counts:?}");
        let [lines, damping, speed] = counts;
        // tolerance: one line in twenty is expected outside, and the noise of some lines is
        // correlated
        assert!(lines > 100, "{counts:?}");
        assert!(damping < lines / 8 && speed < lines / 8, "{counts:?}");
    }
}

/// A later sheet accepts the material that `rodlab bar` writes, and lists its file as an input.
#[test]
fn the_material_of_a_bar_goes_into_a_later_sheet() {
    let folder = Folder::new();
    write(folder.path(), &long_pulse().shot(&[1.0, 0.98], 3));
    let outcome = folder.run(&two_gauges()).unwrap();
    folder.keep(&outcome);
    let force = r#"Force(title: "striker", materials: {"bar": (law: Result("material.json"))},
        problem: Impact(first: RigidMass("1.2 kg"), second: LongRod(material: "bar", diameter: "20 mm"), velocity: "3 m/s", duration: "3 ms",
            band: "6 kHz"))"#;
    let mut inputs = folder.run(force).unwrap().inputs.into_iter();
    assert!(inputs.any(|input| input.path.ends_with("material.json")));
}

#[test]
fn mistakes_on_a_bar_are_named() {
    let folder = Folder::new();
    let two = long_pulse().shot(&[1.0, 1.0], 1);
    let one = short_pulse().shot(&[1.0], 1);
    let most = 0.6 * one[0].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let clipped: Vec<f64> = one[0].iter().map(|x| x.clamp(-most, most)).collect();
    let cases = [
        (
            "silence too long",
            &two,
            two_gauges().replace("0.9 ms", "4 ms"),
            "a silence that ends before the pulse",
        ),
        (
            "no silence",
            &vec![two[0][600..].to_vec(), two[1][600..].to_vec()],
            two_gauges(),
            "a silence before the pulse",
        ),
        (
            "gauges exchanged",
            &vec![two[1].clone(), two[0].clone()],
            two_gauges(),
            "are two channels interchanged",
        ),
        (
            "order in the sheet",
            &two,
            two_gauges().replace("\"900 mm\"", "\"400 mm\""),
            "in which the pulse passes them",
        ),
        (
            "gauge beyond the bar",
            &two,
            two_gauges().replace("\"900 mm\"", "\"2600 mm\""),
            "less than the length of the bar",
        ),
        (
            "pulse too long for one gauge",
            &vec![two[0].clone()],
            one_gauge(),
            "add a second gauge to separate overlapping waves",
        ),
        (
            "one gauge without a guess",
            &one,
            one_gauge().replace("wave_speed: \"1400 m/s\",", ""),
            "a guess within 25 %",
        ),
        (
            "gauge near the struck end",
            &one,
            one_gauge().replace("\"2500 mm\"", "\"950 mm\""),
            "the wave from the struck end",
        ),
        (
            "record too short",
            &vec![one[0][..700].to_vec()],
            one_gauge(),
            "a record up to the end of the reflected pulse",
        ),
        (
            "record cut in the reflection",
            &vec![one[0][..900].to_vec()],
            one_gauge(),
            "a record up to the end of the reflected pulse",
        ),
        (
            "another channel",
            &one,
            one_gauge().replace("(channel: \"gauge 1\"", "(channel: \"gauge 3\""),
            "one of the channels `gauge 1`",
        ),
        (
            "nothing recorded",
            &vec![two[0].iter().map(|x| 1e-6 * x.signum()).collect()],
            one_gauge(),
            "a pulse of at least 50 times the noise in this silence",
        ),
        (
            "saturated",
            &vec![clipped],
            one_gauge(),
            "clipped: `gauge 1`",
        ),
    ];
    let mut wrong = Vec::new();
    for (name, rows, text, words) in cases {
        write(folder.path(), rows);
        let said = match folder.run(&text) {
            Err(error) => error.to_string(),
            Ok(outcome) => format!(
                "{:?} {:?} {:?}",
                outcome.verdict, outcome.summary, outcome.log
            ),
        };
        println!("{name}: {}", said.chars().take(400).collect::<String>());
        if !said.contains(words) {
            wrong.push(format!("{name}: {said}, expected {words}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
